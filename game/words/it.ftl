# La barra
bar-close = Chiudi
bar-narrow = Vista stretta, 40°
bar-normal = Vista naturale, 55°
bar-wide = Vista ampia, 75°
bar-lower = Occhi più in basso
bar-higher = Occhi più in alto
bar-tour = Comincia la visita guidata
bar-pause = Ferma la visita
bar-resume = Torna alla visita
bar-map = Mappa
bar-search = Cerca
bar-settings = Impostazioni
bar-reconnect = Ricollega
bar-help = Aiuto

# Aiuto
help-title = A che serve ogni comando
help-walk = cammina
help-look = guardati intorno
help-run = corri
help-fly = vola; sali e scendi
help-view = campo visivo: 40°, 55°, 75°
help-eye = altezza degli occhi, da 1,6 a 3 m
help-search = cerca e fatti accompagnare
help-map = mappa; clic per andarci, Maiusc+clic per farti accompagnare
help-map-up = mappa: nord in alto; ingrandimento
help-tour = visita: comincia, ferma, riprendi
help-tour-time = visita: dieci secondi indietro, avanti
help-tour-speed = visita: più lenta, più veloce
help-hour = ora del giorno: prima, dopo
help-season = la stagione seguente
help-still = salva un'immagine
help-settings = impostazioni
help-help = questa pagina
help-expert = come arriva la città: celle, linea, diario
help-quit = esci
help-again = Mostra di nuovo il primo minuto
key-mouse = tasto destro del mouse, ⬅ ➡
key-space = Spazio, C

# Il primo minuto
first-title = Il primo minuto
first-walk = Tieni premuto W, o ⬆, e fai qualche passo.
first-look = Tieni premuto il tasto destro e muovi il mouse per guardarti intorno.
first-search = Premi / e scrivi dove vuoi andare, per esempio «tyn».
first-map = Premi M per la mappa. Un clic ti porta lì.
first-tour = Premi T per la visita guidata. La lasci quando vuoi toccando i comandi.
first-done = Non serve altro. F1 mostra il resto.
first-skip = Salta
first-step = { $n } di { $all }

# Suggerimenti
hint-stuck = Qualcosa sbarra la via. Gira di lato, o premi F e passaci sopra in volo.
hint-idle = W cammina, / cerca, T visita guidata, F1 tutti i comandi.
still-taken = Immagine salvata: { $path }
map-saved = Mappa salvata: { $path }
map-not-saved = Non è stato possibile salvare la mappa: { $why }
tour-ended = La visita è finita. T la ricomincia.
walk-arrived = Eccoci: { $name }.

# Impostazioni
settings-title = Impostazioni
settings-language = Lingua
settings-language-system = quella del sistema
settings-quality = Qualità
settings-quality-fitting = secondo la scheda grafica
quality-low = bassa
quality-medium = media
quality-high = alta
quality-ultra = massima
settings-level = Facciate, livello più alto
settings-level-1 = 1, sagome colorate
settings-level-2 = 2, finestre e porte
settings-level-3 = 3, texture completa
settings-level-4 = 4, rilievo
settings-hold = Mantieni tanti fotogrammi al secondo
settings-limit = Limita lo scaricamento, kB al secondo
settings-text = Dimensione dei caratteri
settings-contrast = Alto contrasto
settings-motion = Meno movimento
settings-minimap = Mappa piccola
settings-minimap-size = Dimensione della mappa piccola
settings-north = Nord in alto
settings-colour-blind = Mappa: colori distinguibili da tutti
settings-map-names = Mappa: nomi
settings-map-symbols = Mappa: cose da vedere e case
settings-map-views = Mappa: vedute
settings-map-landmarks = Mappa: monumenti come figurine
settings-map-route = Mappa: il percorso
settings-map-trail = Mappa: dove siete stati
settings-map-tour = Mappa: dove porta la visita
settings-without-steps = Percorsi senza scale
settings-panel = Che cosa c'è vicino
settings-captions = Didascalie delle visite
settings-bar = La barra resta
settings-reset = Come all'inizio
settings-tiles = La finezza dei muri dipinti cambia al prossimo avvio.

# Ciò che si può chiedere per nome
offer-tour = Visita: { $title }
offer-quality-low = Qualità: { quality-low }
offer-quality-medium = Qualità: { quality-medium }
offer-quality-high = Qualità: { quality-high }
offer-quality-ultra = Qualità: { quality-ultra }
offer-noon = Mezzogiorno
offer-dusk = Tramonto
offer-night = Notte
offer-rain = Pioggia
offer-dry = Tempo asciutto
offer-spring = Primavera
offer-summer = Estate
offer-autumn = Autunno
offer-winter = Inverno
offer-map = Mappa
offer-settings = Impostazioni
offer-help = Aiuto
