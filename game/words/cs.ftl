# Lišta
bar-close = Zavřít
bar-narrow = Úzký pohled, 40°
bar-normal = Přirozený pohled, 55°
bar-wide = Široký pohled, 75°
bar-lower = Oči níž
bar-higher = Oči výš
bar-tour = Vydat se na prohlídku
bar-pause = Zastavit prohlídku
bar-resume = Zpět k prohlídce
bar-map = Mapa
bar-search = Hledání
bar-settings = Nastavení
bar-reconnect = Znovu připojit
bar-help = Nápověda

# Nápověda
help-title = Co které ovládání dělá
help-walk = chůze
help-look = rozhlížení
help-run = běh
help-fly = let; stoupání a klesání
help-view = zorné pole: 40°, 55°, 75°
help-eye = výška očí, 1,6 až 3 m
help-search = hledání a doprovod k cíli
help-map = mapa; kliknutím být tam, Shift+kliknutím dojít
help-map-up = mapa: sever nahoře; zvětšení
help-tour = prohlídka: začít, zastavit, pokračovat
help-tour-time = prohlídka: o deset sekund zpět, vpřed
help-tour-speed = prohlídka: pomaleji, rychleji
help-hour = denní doba: dřív, později
help-season = další roční období
help-still = uložit snímek
help-settings = nastavení
help-help = tato stránka
help-expert = jak město přichází: buňky, linka, deník
help-quit = konec
help-again = Znovu ukázat první minutu
key-mouse = pravé tlačítko myši, ⬅ ➡
key-space = mezerník, C

# První minuta
first-title = Vaše první minuta
first-walk = Podržte W nebo ⬆ a popojděte pár kroků.
first-look = Podržte pravé tlačítko myši a pohybem myši se rozhlédněte.
first-search = Stiskněte / a napište, kam chcete, třeba „tyn“.
first-map = Stiskněte M a otevře se mapa. Kliknutí vás tam přenese.
first-tour = Stiskněte T a začne prohlídka. Kdykoli ji opustíte tím, že se dotknete ovládání.
first-done = Víc nepotřebujete. F1 ukáže ostatní.
first-skip = Přeskočit
first-step = { $n } z { $all }

# Rady
hint-stuck = Něco stojí v cestě. Zabočte, nebo stiskněte F a přeleťte to.
hint-idle = W chůze, / hledání, T prohlídka, F1 celé ovládání.
still-taken = Snímek uložen: { $path }
map-saved = Mapa uložena: { $path }
map-not-saved = Mapu se nepodařilo uložit: { $why }
tour-ended = Prohlídka skončila. T ji začne znovu.
walk-arrived = Jste na místě: { $name }.

# Nastavení
settings-title = Nastavení
settings-language = Jazyk
settings-language-system = podle systému
settings-quality = Kvalita
settings-quality-fitting = podle grafické karty
quality-low = nízká
quality-medium = střední
quality-high = vysoká
quality-ultra = nejvyšší
settings-level = Nejvyšší úroveň průčelí
settings-level-1 = 1, barevné obrysy
settings-level-2 = 2, okna a dveře
settings-level-3 = 3, plná textura
settings-level-4 = 4, reliéf
settings-hold = Držet tolik snímků za sekundu
settings-limit = Omezit stahování, kB za sekundu
settings-text = Velikost písma
settings-contrast = Vysoký kontrast
settings-motion = Méně pohybu
settings-minimap = Mapka
settings-minimap-size = Velikost mapky
settings-north = Sever nahoře
settings-colour-blind = Mapa: barvy, které rozliší každý
settings-map-names = Mapa: názvy
settings-map-symbols = Mapa: pamětihodnosti a domy
settings-map-views = Mapa: vyhlídky
settings-map-landmarks = Mapa: význačné stavby jako obrázky
settings-map-route = Mapa: cesta
settings-map-trail = Mapa: kudy jste šli
settings-map-tour = Mapa: kudy vede prohlídka
settings-without-steps = Cesty beze schodů
settings-panel = Co stojí poblíž
settings-captions = Titulky prohlídek
settings-bar = Lišta zůstává
settings-reset = Jako na začátku
settings-tiles = Jemnost malby zdí se změní při příštím spuštění.

# Co lze žádat jménem
offer-tour = Prohlídka: { $title }
offer-quality-low = Kvalita: { quality-low }
offer-quality-medium = Kvalita: { quality-medium }
offer-quality-high = Kvalita: { quality-high }
offer-quality-ultra = Kvalita: { quality-ultra }
offer-noon = Poledne
offer-dusk = Soumrak
offer-night = Noc
offer-rain = Déšť
offer-dry = Sucho
offer-spring = Jaro
offer-summer = Léto
offer-autumn = Podzim
offer-winter = Zima
offer-map = Mapa
offer-settings = Nastavení
offer-help = Nápověda
