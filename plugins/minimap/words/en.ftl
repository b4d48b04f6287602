map-open = Click for the large map
map-hint = click: go there · Shift+click: walk there · drag, wheel: move, zoom · M: back
map-close = Close the map
