tour-waiting = La visita comincia appena arrivano le sue vie …
tour-wandering = Avete lasciato la visita. Il tasto T vi riporta indietro.
tour-pause = Ferma la visita
tour-play = Riprendi la visita
tour-stop = Termina la visita
tour-time = Tempo nella visita
