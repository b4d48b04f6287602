# The bar
bar-close = Close
bar-narrow = Narrow view, 40°
bar-normal = Natural view, 55°
bar-wide = Wide view, 75°
bar-lower = Eyes lower
bar-higher = Eyes higher
bar-tour = Take the tour
bar-pause = Pause the tour
bar-resume = Back to the tour
bar-map = Map
bar-search = Search
bar-settings = Settings
bar-reconnect = Connect again
bar-help = Help

# Help
help-title = What each control does
help-walk = walk
help-look = look around
help-run = run
help-fly = fly; rise and sink
help-view = field of view: 40°, 55°, 75°
help-eye = eye height, 1.6 to 3 m
help-search = search, and be led there
help-map = map; click to be there, Shift+click to be led
help-map-up = map: north up; zoom
help-tour = tour: begin, pause, go on
help-tour-time = tour: ten seconds back, ahead
help-tour-speed = tour: slower, faster
help-hour = hour of the day: earlier, later
help-season = the next season
help-still = take a still
help-settings = settings
help-help = this page
help-expert = how the city streams: cells, line, journal
help-quit = quit
help-again = Show the first minute again
key-mouse = right mouse button, ⬅ ➡
key-space = Space, C

# The first minute
first-title = Your first minute
first-walk = Hold W, or ⬆, to walk a few steps.
first-look = Hold the right mouse button and move the mouse to look around.
first-search = Press / and type where you want to go, such as “tyn”.
first-map = Press M for the map. A click takes you there.
first-tour = Press T for a guided tour. Touch the controls to leave it whenever you like.
first-done = That is all you need. F1 shows the rest.
first-skip = Skip
first-step = { $n } of { $all }

# Hints
hint-stuck = Something stands in the way. Turn aside, or press F and fly over it.
hint-idle = W walks, / finds, T takes the tour, F1 shows all controls.
still-taken = Still saved: { $path }
map-saved = Map saved: { $path }
map-not-saved = The map could not be saved: { $why }
tour-ended = The tour has ended. T begins it again.
walk-arrived = Here you are: { $name }.

# Settings
settings-title = Settings
settings-language = Language
settings-language-system = the system's
settings-quality = Quality
settings-quality-fitting = as the graphics card allows
quality-low = low
quality-medium = medium
quality-high = high
quality-ultra = ultra
settings-level = Façades, highest level of detail
settings-level-1 = 1, coloured outlines
settings-level-2 = 2, windows and doors
settings-level-3 = 3, full texture
settings-level-4 = 4, relief
settings-hold = Keep so many frames a second
settings-limit = Limit streaming to, kB a second
settings-text = Size of letters
settings-contrast = High contrast
settings-motion = Less motion
settings-minimap = Minimap
settings-minimap-size = Size of the minimap
settings-north = North up
settings-colour-blind = Map: colours told apart by everybody
settings-map-names = Map: names
settings-map-symbols = Map: sights and houses
settings-map-views = Map: views
settings-map-landmarks = Map: landmarks as pictures
settings-map-route = Map: the way
settings-map-trail = Map: where you have been
settings-map-tour = Map: where the tour leads
settings-without-steps = Ways without stairs
settings-panel = What stands near
settings-captions = Captions of tours
settings-bar = The bar stays
settings-reset = As at first
settings-tiles = How finely walls are painted changes at the next start.

# What can be asked for by name
offer-tour = Tour: { $title }
offer-quality-low = Quality: { quality-low }
offer-quality-medium = Quality: { quality-medium }
offer-quality-high = Quality: { quality-high }
offer-quality-ultra = Quality: { quality-ultra }
offer-noon = Noon
offer-dusk = Dusk
offer-night = Night
offer-rain = Rain
offer-dry = Dry weather
offer-spring = Spring
offer-summer = Summer
offer-autumn = Autumn
offer-winter = Winter
offer-map = Map
offer-settings = Settings
offer-help = Help
