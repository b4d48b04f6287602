map-open = Kliknutím velká mapa
map-hint = kliknutí: být tam · Shift+kliknutí: dojít tam · tažení, kolečko: posun, zvětšení · M: zpět
map-close = Zavřít mapu
