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
bar-record = Registra una passeggiata
bar-record-end = Termina la registrazione
bar-edit = Modifica la visita
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
help-examine = esamina ciò che guardi: giraci intorno, e riprendi a camminare
help-view = campo visivo: 40°, 55°, 75°
help-view-next = il campo visivo successivo
help-eye = altezza degli occhi, da 1,6 a 3 m
help-search = cerca e fatti accompagnare
help-map = mappa; clic per andarci, Maiusc+clic per farti accompagnare
help-map-up = mappa: nord in alto; ingrandimento
help-tour = visita: comincia, ferma, riprendi
help-tour-time = visita: dieci secondi indietro, avanti
help-tour-next = visita: il capitolo successivo
help-tour-speed = visita: più lenta, più veloce
help-record = registra una passeggiata come visita; termina
help-editor = editor delle visite; aggiungi la vista
help-hour = ora del giorno: prima, dopo
help-season = la stagione seguente
help-mute = togli l'audio
help-still = salva un'immagine
help-settings = impostazioni
help-help = questa pagina
help-expert = come arriva la città: celle, linea, diario
help-close = chiudi l’ultima cosa aperta
help-quit = esci
help-again = Mostra di nuovo il primo minuto

# Il primo minuto
first-title = Il primo minuto
first-walk = Tieni premuto { $walk } e fai qualche passo.
first-walk-pad = Spingi { $walk } e fai qualche passo.
first-walk-touch = Metti un dito sulla metà sinistra dell’immagine e spingilo in su per fare qualche passo.
first-look = Tieni premuto { $look } e muovi il mouse per guardarti intorno.
first-look-pad = Spingi la levetta destra per guardarti intorno.
first-look-touch = Trascina un dito sulla metà destra dell’immagine per guardarti intorno.
first-search = Premi { $find } e scrivi dove vuoi andare, per esempio «tyn».
first-map = Premi { $map } per la mappa. Un clic ti porta lì.
first-tour = Premi { $tour } per la visita guidata. La lasci quando vuoi toccando i comandi.
first-done = Non serve altro. { $help } mostra il resto.
first-skip = Salta
first-step = { $n } di { $all }

# Suggerimenti
hint-stuck = Qualcosa sbarra la via. Gira di lato, o premi { $fly } e passaci sopra in volo.
hint-idle = { $walk } cammina, { $find } cerca, { $tour } visita guidata, { $help } tutti i comandi.
still-taken = Immagine salvata: { $path }
map-saved = Mappa salvata: { $path }
map-not-saved = Non è stato possibile salvare la mappa: { $why }
tour-ended = La visita è finita. { $tour } la ricomincia.
walk-arrived = Eccoci: { $name }.
sound-off = Audio spento. U lo riaccende.
sound-on = Audio acceso.

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
settings-minimap-left = Mappa piccola a sinistra
settings-minimap-top = Mappa piccola in alto
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
settings-panel-right = Che cosa c'è vicino, a destra
settings-captions = Didascalie delle visite
settings-life = Vita: piccioni, bandiere, acqua, orologi
settings-mute = Senza audio
settings-volume = Volume
settings-volume-city = Volume: la città
settings-volume-steps = Volume: passi
settings-volume-bells = Volume: campane
settings-volume-narration = Volume: racconto
settings-silent-behind = Silenzio quando la finestra non è davanti
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
offer-record = Registra una visita
offer-edit = Modifica la visita
offer-new = Nuova visita

# Che cosa fanno i comandi
control-help-open = comandi: mostra e chiudi
control-settings-open = impostazioni: apri e chiudi
control-expert-open = come arriva la città: celle, linea, diario
control-still-take = salva un'immagine
control-hour-earlier = ora del giorno: prima
control-hour-later = ora del giorno: dopo
control-season-next = la stagione seguente
control-sound-mute = audio spento, acceso
control-quit = esci

# Tasti
settings-general = Generali
settings-keys = Tasti
keys-hint = Premi quello che vuoi cambiare; + ne aggiunge un altro.
keys-waits = Premi un tasto o un pulsante, o spingi una levetta. Esc lascia com’è, Canc lo toglie.
keys-press = premi …
keys-change = { $what }: { $input }
keys-add = Un altro: { $what }
keys-reset = Come all’inizio: { $what }
keys-reset-all = Tutto come all’inizio
keys-conflict = { $input } fa anche: { $others }
keys-dropped = Lasciato fuori dai tasti: { $what }

# Come arriva la città
expert-title = Come arriva la città
expert-cells = Celle: { $loaded } di { $all } caricate. Regioni: { $told } di { $regions } note.
expert-figures = Contenuto: { $content }, ricevuti: { $received }. Richieste: { $requests }, in arrivo: { $flying }, fallite: { $failed }.
expert-memory = Memoria: { $cells } nelle celle, { $afar } da lontano, di { $cap }.
expert-made = Fatti qui: { $made } di mesh da { $sent } in { $seconds } s su un thread. Inviati pronti, così come stanno in memoria, arriverebbero prima su linee oltre { $megabits } Mbit/s.
expert-pace = Quando si attende qualcosa, arrivano { $bytes } al secondo.
expert-pace-unknown = Non si è ancora atteso abbastanza per conoscere la velocità della linea.
expert-latency = latenza, s
expert-bandwidth = al secondo
expert-no-limit = senza limite
expert-loss = perdite
expert-down = server irraggiungibile
expert-pause = pausa
expert-ask = richiedi subito
expert-aloft = a volo d’uccello: la rotella sulla pianta ne regola l’altezza
expert-reach = portata dei livelli
expert-reach-auto = portata automatica, a { $frames } fotogrammi al secondo
expert-downloaded = scaricati { $bytes } in { $seconds } s
expert-of-maps = indice, case, mappe, guida { $bytes }
expert-of-level = livello { $level }: { $bytes }
expert-by-cell = { $n ->
    [one] nell’ultima cella; al massimo { $bytes }
   *[other] in ognuna delle ultime { $n } celle; al massimo { $bytes }
}
expert-plan = Pianta delle celle
expert-across = { $metres } m di lato; rotella per ingrandire, indica una cella per sapere perché
expert-cell = cella { $cell }, { $name }: { $houses ->
    [one] { $houses } casa
   *[other] { $houses } case
}, { $level }; { $why }
expert-nameless = senza nome
expert-level = caricata al livello { $level }
expert-level-none = non caricata
expert-why-none = non serve a nessuno
expert-why-kept = ora non serve; tenuta ancora un poco, se si torna indietro
expert-why-seen = si vede dalla cella { $from }
expert-why-ahead = si vede dalla cella { $from }, qui accanto
expert-why-on-the-way = vicina a un luogo dove porta la visita
expert-why-skyline = svetta sopra i tetti
expert-why-near = vicina a chi vola o non è in nessuna cella
expert-journal = Diario
expert-index = l’indice della città
expert-leaf = foglio { $n } dell’indice
expert-region = regione { $n } dell’indice
expert-overview = panoramica della regione { $n }
expert-houses = le case della regione { $n }
expert-file = file { $n } della città
expert-packet = cella { $cell }, livello { $level }
expert-opened = aperto: { $place }
expert-entered = ingresso nella cella { $cell }
expert-left = fuori da ogni cella
expert-asked = richiesto: { $what }, { $bytes }
expert-arrived = arrivato: { $what }, { $bytes }
expert-failed = fallito: { $what }, di nuovo tra { $seconds } s
expert-failed-for-good = fallito per sempre: { $what }
expert-cancelled = annullato: { $what }
expert-released = liberata la cella { $cell } dal livello { $level }, { $why }
expert-released-idle = non serviva a nessuno
expert-released-cap = memoria piena
