# Luoghi
place-fold = Mostra solo il nome
place-unfold = Dimmi di più
place-hours = Orario: { $hours }
place-link = Per saperne di più: { $site }
place-picture = Immagine: { $what } ({ $site })
place-listen = Ascolta
place-silence = Smetti di ascoltare
certainty-documented = aspetto documentato
certainty-typical = dettagli tipici del genere
certainty-invented = come poteva essere

# Ricerca
search-name = Cerca
search-hint = Dove andiamo? Un luogo, una via, una visita …
search-nothing = Niente ha un nome simile. Con meno lettere si trova di più.
search-walk = Vacci a piedi
search-jump = Vacci subito
search-show = Mostra sulla mappa
search-do = Esegui
search-close = Chiudi
search-without-steps = Senza scale
search-keys = ⬆ ⬇ scegli · Invio a piedi · Maiusc+Invio subito · Ctrl+Invio sulla mappa · Esc chiudi
search-street = via
search-offer = comando
search-metres = { $metres } m
search-kilometres = { $kilometres } km
kind-viewpoint = veduta
kind-house = casa
kind-shop = negozio
kind-monument = monumento
kind-square = piazza
kind-street = via
kind-other = luogo

# In cammino
lead-to = Verso { $name }
lead-to-spot = Dove hai fatto clic
lead-left = { $metres } m, { $minutes ->
    [0] meno di un minuto
    [one] circa un minuto
   *[other] circa { $minutes } minuti
}
lead-stop = Fermati qui
lead-waits = La via davanti è in arrivo …
lead-no-way = Nessuna strada a piedi porta a { $name }.
lead-over-steps = Solo una scala porta a { $name }. La ricerca trova anche percorsi con scale, se lo permetti.

# What controls do
control-search-open = cerca, e fatti guidare
