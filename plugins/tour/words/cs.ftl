tour-waiting = Prohlídka začne, jakmile dorazí její ulice …
tour-wandering = Opustili jste prohlídku. Klávesa T vás vrátí.
tour-pause = Zastavit prohlídku
tour-play = Pokračovat v prohlídce
tour-stop = Ukončit prohlídku
tour-time = Čas v prohlídce
