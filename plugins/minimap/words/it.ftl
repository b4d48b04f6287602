map-open = Clic per la mappa grande
map-hint = clic: vai lì · Maiusc+clic: vai a piedi · trascina, rotella: sposta, ingrandisci · { $key }: indietro
map-close = Chiudi la mappa
control-map-open = mappa: apri e chiudi
control-map-north = mappa: nord in alto, o la direzione dello sguardo
control-map-nearer = mappa: più vicino
control-map-wider = mappa: più lontano
