map-open = Clic per la mappa grande
map-hint = clic: vai lì · Maiusc+clic: vai a piedi · trascina, rotella: sposta, ingrandisci · M: indietro
map-close = Chiudi la mappa
