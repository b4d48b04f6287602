# Místa
place-fold = Ukázat jen jméno
place-unfold = Povědět víc
place-hours = Otevřeno: { $hours }
place-link = Více na { $site }
place-picture = Obrázek: { $what } ({ $site })
place-listen = Poslechnout
place-silence = Přestat poslouchat
certainty-documented = podoba doložená
certainty-typical = podrobnosti podle obvyklého vzoru
certainty-invented = jak to mohlo vypadat

# Hledání
search-name = Hledání
search-hint = Kam? Místo, ulice, prohlídka …
search-nothing = Takové jméno tu nic nemá. Méně písmen najde víc.
search-walk = Dojít tam
search-jump = Být tam hned
search-show = Ukázat na mapě
search-do = Provést
search-close = Zavřít
search-without-steps = Beze schodů
search-keys = ⬆ ⬇ výběr · Enter dojít tam · Shift+Enter být tam · Ctrl+Enter ukázat na mapě · Esc zavřít
search-street = ulice
search-offer = příkaz
search-metres = { $metres } m
search-kilometres = { $kilometres } km
kind-viewpoint = vyhlídka
kind-house = dům
kind-shop = obchod
kind-monument = památka
kind-square = náměstí
kind-street = ulice
kind-other = místo

# Na cestě
lead-to = Cíl: { $name }
lead-to-spot = Tam, kam jste klikli
lead-left = { $metres } m, { $minutes ->
    [0] méně než minuta
    [one] asi minuta
    [few] asi { $minutes } minuty
   *[other] asi { $minutes } minut
}
lead-stop = Zastavit tady
lead-waits = Ulice před vámi je na cestě …
lead-no-way = K cíli { $name } nevede žádná cesta pro pěší.
lead-over-steps = K cíli { $name } vedou jen schody. Hledání najde i cesty po schodech, když mu to dovolíte.

# What controls do
control-search-open = hledat a nechat se dovést
