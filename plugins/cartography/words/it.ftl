map-scale = 1 : { $n }
map-north = N
map-metres = { $n } m
map-kilometres = { $n } km
map-index = Vie e luoghi
map-index-more = { $n ->
    [one] un altro nome non trova posto qui
   *[other] altri { $n } nomi non trovano posto qui
}
map-credit = Dati: { $credit }
map-drawn = Disegnata da Veduta
legend-house-any = case
legend-notable = case con un nome
legend-monument = monumenti
legend-park = parchi, prati
legend-water = acqua
legend-steps = scale
legend-arcade = portici
legend-railway = ferrovie
legend-sight = cose da vedere
legend-house = case notevoli
legend-view = vedute
legend-end = fine del percorso
legend-led = percorso
legend-tour = visita
legend-trail = dove siete stati
