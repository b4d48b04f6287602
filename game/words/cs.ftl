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
bar-record = Nahrát procházku
bar-record-end = Ukončit nahrávání
bar-edit = Upravit prohlídku
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
help-examine = prohlédnout si, na co se díváte: obejít to, a jít dál
help-view = zorné pole: 40°, 55°, 75°
help-view-next = další zorné pole
help-eye = výška očí, 1,6 až 3 m
help-search = hledání a doprovod k cíli
help-map = mapa; kliknutím být tam, Shift+kliknutím dojít
help-map-up = mapa: sever nahoře; zvětšení
help-tour = prohlídka: začít, zastavit, pokračovat
help-tour-time = prohlídka: o deset sekund zpět, vpřed
help-tour-next = prohlídka: další kapitola
help-tour-speed = prohlídka: pomaleji, rychleji
help-record = nahrát procházku jako prohlídku; ukončit
help-editor = editor prohlídek; přidat pohled
help-hour = denní doba: dřív, později
help-season = další roční období
help-mute = vypnout zvuk
help-still = uložit snímek
help-settings = nastavení
help-help = tato stránka
help-expert = jak město přichází: buňky, linka, deník
help-close = zavřít, co se otevřelo naposled
help-quit = konec
help-again = Znovu ukázat první minutu

# První minuta
first-title = Vaše první minuta
first-walk = Podržte { $walk } a popojděte pár kroků.
first-walk-pad = Zatlačte { $walk } a popojděte pár kroků.
first-walk-touch = Položte prst na levou polovinu obrazu a tažením vzhůru popojděte pár kroků.
first-look = Podržte { $look } a pohybem myši se rozhlédněte.
first-look-pad = Pravou páčkou se rozhlédněte.
first-look-touch = Tažením prstu po pravé polovině obrazu se rozhlédněte.
first-search = Stiskněte { $find } a napište, kam chcete, třeba „tyn“.
first-map = Stiskněte { $map } a otevře se mapa. Kliknutí vás tam přenese.
first-tour = Stiskněte { $tour } a začne prohlídka. Kdykoli ji opustíte tím, že se dotknete ovládání.
first-done = Víc nepotřebujete. { $help } ukáže ostatní.
first-skip = Přeskočit
first-step = { $n } z { $all }

# Rady
hint-stuck = Něco stojí v cestě. Zabočte, nebo stiskněte { $fly } a přeleťte to.
hint-idle = { $walk } chůze, { $find } hledání, { $tour } prohlídka, { $help } celé ovládání.
still-taken = Snímek uložen: { $path }
map-saved = Mapa uložena: { $path }
map-not-saved = Mapu se nepodařilo uložit: { $why }
tour-ended = Prohlídka skončila. { $tour } ji začne znovu.
walk-arrived = Jste na místě: { $name }.
sound-off = Zvuk je vypnutý. Klávesa U ho zapne.
sound-on = Zvuk je zapnutý.

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
settings-minimap-left = Mapka vlevo
settings-minimap-top = Mapka nahoře
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
settings-panel-right = Co stojí poblíž, vpravo
settings-captions = Titulky prohlídek
settings-life = Život: holubi, vlajky, voda, hodiny
settings-mute = Vypnout zvuk
settings-volume = Hlasitost
settings-volume-city = Hlasitost: město
settings-volume-steps = Hlasitost: kroky
settings-volume-bells = Hlasitost: zvony
settings-volume-narration = Hlasitost: výklad
settings-silent-behind = Ticho, když okno není vpředu
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
offer-record = Nahrát procházku
offer-edit = Upravit prohlídku
offer-new = Nová prohlídka

# Co dělá ovládání
control-help-open = ovládání: ukázat a zavřít
control-settings-open = nastavení: otevřít a zavřít
control-expert-open = jak město přichází: buňky, linka, deník
control-still-take = uložit snímek
control-hour-earlier = denní doba: dřív
control-hour-later = denní doba: později
control-season-next = další roční období
control-sound-mute = zvuk vypnout, zapnout
control-quit = konec

# Klávesy
settings-general = Obecné
settings-keys = Klávesy
keys-hint = Stiskněte, co chcete změnit; + přidá další.
keys-waits = Stiskněte klávesu či tlačítko, nebo zatlačte páčku. Esc nechá, jak je, Delete odebere.
keys-press = stiskněte …
keys-change = { $what }: { $input }
keys-add = Další: { $what }
keys-reset = Jako na začátku: { $what }
keys-reset-all = Vše jako na začátku
keys-conflict = { $input } dělá také: { $others }
keys-dropped = Z kláves vynecháno: { $what }

# Jak město přichází
expert-title = Jak město přichází
expert-cells = Buňky: načteno { $loaded } z { $all }. Oblasti: známo { $told } z { $regions }.
expert-figures = Obsah: { $content }, přijato: { $received }. Požadavky: { $requests }, na cestě: { $flying }, nezdařené: { $failed }.
expert-memory = Paměť: { $cells } v buňkách, { $afar } zdálky, z { $cap }.
expert-made = Vyrobeno zde: { $made } sítí z { $sent } za { $seconds } s na vlákně. Poslány hotové, tak jak leží v paměti, by přišly dřív po linkách nad { $megabits } Mbit/s.
expert-pace = Když se na něco čeká, přichází { $bytes } za sekundu.
expert-pace-unknown = Na nic se nečekalo dost dlouho, aby byla známa rychlost linky.
expert-latency = zpoždění, s
expert-bandwidth = za sekundu
expert-no-limit = bez omezení
expert-loss = ztráty
expert-down = server neodpovídá
expert-pause = pozastavit
expert-ask = požádat hned znovu
expert-aloft = z ptačí perspektivy: výšku nastaví kolečko nad plánem
expert-reach = dosah úrovní
expert-reach-auto = dosah sám, při { $frames ->
    [one] { $frames } snímku
   *[other] { $frames } snímcích
} za sekundu
expert-downloaded = staženo { $bytes } za { $seconds } s
expert-of-maps = rejstřík, domy, mapy, průvodce { $bytes }
expert-of-level = úroveň { $level }: { $bytes }
expert-by-cell = { $n ->
    [one] v poslední buňce; nejvýš { $bytes }
   *[other] v každé z posledních { $n } buněk; nejvýš { $bytes }
}
expert-plan = Plán buněk
expert-across = { $metres } m napříč; kolečko mění měřítko, ukažte na buňku a dozvíte se proč
expert-cell = buňka { $cell }, { $name }: { $houses ->
    [one] { $houses } dům
    [few] { $houses } domy
   *[other] { $houses } domů
}, { $level }; { $why }
expert-nameless = beze jména
expert-level = načtena úroveň { $level }
expert-level-none = nenačtena
expert-why-none = nikdo ji nepotřebuje
expert-why-kept = teď ji nikdo nepotřebuje; chvíli zůstane, kdybyste se vrátili
expert-why-seen = je vidět z buňky { $from }
expert-why-ahead = je vidět z vedlejší buňky { $from }
expert-why-on-the-way = poblíž místa, kam vede prohlídka
expert-why-skyline = ční nad střechy
expert-why-near = poblíž toho, kdo letí nebo není v žádné buňce
expert-journal = Deník
expert-index = rejstřík města
expert-leaf = list { $n } rejstříku
expert-region = oblast { $n } rejstříku
expert-overview = přehled oblasti { $n }
expert-houses = domy oblasti { $n }
expert-file = soubor { $n } města
expert-packet = buňka { $cell }, úroveň { $level }
expert-opened = otevřeno: { $place }
expert-entered = vstup do buňky { $cell }
expert-left = mimo všechny buňky
expert-asked = vyžádáno: { $what }, { $bytes }
expert-arrived = přišlo: { $what }, { $bytes }
expert-failed = nezdařilo se: { $what }, znovu za { $seconds } s
expert-failed-for-good = nezdařilo se nadobro: { $what }
expert-cancelled = odvoláno: { $what }
expert-released = uvolněna buňka { $cell } od úrovně { $level }, { $why }
expert-released-idle = nikdo ji nepotřeboval
expert-released-cap = došlo místo v paměti
