map-scale = 1 : { $n }
map-north = N
map-metres = { $n } m
map-kilometres = { $n } km
map-index = Streets and places
map-index-more = { $n ->
    [one] one more name has no room here
   *[other] { $n } more names have no room here
}
map-credit = Data: { $credit }
map-drawn = Drawn by Veduta
legend-house-any = houses
legend-notable = houses with a name
legend-monument = monuments
legend-park = parks, lawns
legend-water = water
legend-steps = stairs
legend-arcade = arcades
legend-railway = railways
legend-sight = sights
legend-house = houses of note
legend-view = views
legend-end = end of the way
legend-led = way
legend-tour = tour
legend-trail = where you have been
