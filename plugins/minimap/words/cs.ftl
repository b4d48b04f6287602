map-open = Kliknutím velká mapa
map-hint = kliknutí: být tam · Shift+kliknutí: dojít tam · tažení, kolečko: posun, zvětšení · { $key }: zpět
map-close = Zavřít mapu
control-map-open = mapa: otevřít a zavřít
control-map-north = mapa: sever nahoře, nebo směr pohledu
control-map-nearer = mapa: blíž
control-map-wider = mapa: z větší dálky
