map-open = Click for the large map
map-hint = click: go there · Shift+click: walk there · drag, wheel: move, zoom · { $key }: back
map-close = Close the map
control-map-open = map: open and close
control-map-north = map: north up, or heading up
control-map-nearer = map: nearer
control-map-wider = map: wider
