map-scale = 1 : { $n }
map-north = S
map-metres = { $n } m
map-kilometres = { $n } km
map-index = Ulice a místa
map-index-more = { $n ->
    [one] jedno další jméno se sem nevešlo
    [few] { $n } další jména se sem nevešla
   *[other] { $n } dalších jmen se sem nevešlo
}
map-credit = Data: { $credit }
map-drawn = Nakreslila Veduta
legend-house-any = domy
legend-notable = domy se jménem
legend-monument = památky
legend-park = parky, trávníky
legend-water = voda
legend-steps = schody
legend-arcade = podloubí
legend-railway = železnice
legend-sight = pamětihodnosti
legend-house = význačné domy
legend-view = vyhlídky
legend-end = konec cesty
legend-led = cesta
legend-tour = prohlídka
legend-trail = kudy jste šli
