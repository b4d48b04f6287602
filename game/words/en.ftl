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
bar-record = Record a walk
bar-record-end = End the recording
bar-edit = Edit the tour
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
help-examine = examine what you look at: go round it, and walk on
help-view = field of view: 40°, 55°, 75°
help-view-next = the next field of view
help-eye = eye height, 1.6 to 3 m
help-search = search, and be led there
help-map = map; click to be there, Shift+click to be led
help-map-up = map: north up; zoom
help-tour = tour: begin, pause, go on
help-tour-time = tour: ten seconds back, ahead
help-tour-next = tour: the next chapter
help-tour-speed = tour: slower, faster
help-record = record a walk as a tour; end it
help-editor = tour editor; add the present view
help-hour = hour of the day: earlier, later
help-season = the next season
help-mute = mute
help-still = take a still
help-settings = settings
help-help = this page
help-expert = how the city streams: cells, line, journal
help-close = close what was opened last
help-quit = quit
help-again = Show the first minute again

# The first minute
first-title = Your first minute
first-walk = Hold { $walk } to walk a few steps.
first-walk-pad = Push { $walk } to walk a few steps.
first-walk-touch = Put a finger on the left half of the picture and push it up to walk a few steps.
first-look = Hold { $look } and move the mouse to look around.
first-look-pad = Push the right stick to look around.
first-look-touch = Drag a finger on the right half of the picture to look around.
first-search = Press { $find } and type where you want to go, such as “tyn”.
first-map = Press { $map } for the map. A click takes you there.
first-tour = Press { $tour } for a guided tour. Touch the controls to leave it whenever you like.
first-done = That is all you need. { $help } shows the rest.
first-skip = Skip
first-step = { $n } of { $all }

# Hints
hint-stuck = Something stands in the way. Turn aside, or press { $fly } and fly over it.
hint-idle = { $walk } walks, { $find } finds, { $tour } takes the tour, { $help } shows all controls.
still-taken = Still saved: { $path }
map-saved = Map saved: { $path }
map-not-saved = The map could not be saved: { $why }
tour-ended = The tour has ended. { $tour } begins it again.
walk-arrived = Here you are: { $name }.
sound-off = Sound off. U brings it back.
sound-on = Sound on.

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
settings-minimap-left = Minimap at the left
settings-minimap-top = Minimap at the top
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
settings-panel-right = What stands near at the right
settings-captions = Captions of tours
settings-life = Life: pigeons, flags, water, clocks
settings-mute = Mute
settings-volume = Volume
settings-volume-city = Volume: the city
settings-volume-steps = Volume: steps
settings-volume-bells = Volume: bells
settings-volume-narration = Volume: narration
settings-silent-behind = Silent while the window is not in front
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
offer-record = Record a tour
offer-edit = Edit the tour
offer-new = New tour

# What controls do
control-help-open = controls: show, and close
control-settings-open = settings: open, and close
control-expert-open = how the city streams: cells, line, journal
control-still-take = take a still
control-hour-earlier = hour of the day: earlier
control-hour-later = hour of the day: later
control-season-next = the next season
control-sound-mute = sound off, sound on
control-quit = quit

# Keys
settings-general = General
settings-keys = Keys
keys-hint = Press one to change it, + to add another.
keys-waits = Press a key or a button, or push a stick. Esc leaves it, Delete takes it away.
keys-press = press …
keys-change = { $what }: { $input }
keys-add = Another input: { $what }
keys-reset = As at first: { $what }
keys-reset-all = All as at first
keys-conflict = { $input } is also: { $others }
keys-dropped = Left out of the keys: { $what }

# How the city streams
expert-title = How the city streams
expert-cells = Cells: { $loaded } of { $all } loaded. Regions: { $told } of { $regions } told of.
expert-figures = In content: { $content }, received: { $received }. Requests: { $requests }, on their way: { $flying }, failed: { $failed }.
expert-memory = Memory: { $cells } in cells, { $afar } from afar, of { $cap }.
expert-made = Made here: { $made } of meshes of { $sent } in { $seconds } s on a thread. Sent ready, just as they lie in memory, they would come sooner on lines above { $megabits } Mbit/s.
expert-pace = When something is awaited, { $bytes } a second come.
expert-pace-unknown = Nothing was awaited long enough to tell the line's pace.
expert-latency = latency, s
expert-bandwidth = a second
expert-no-limit = no limit
expert-loss = lost
expert-down = server gone
expert-pause = pause
expert-ask = ask again now
expert-aloft = bird's eye: the wheel on the plan sets how high
expert-reach = reach of levels
expert-reach-auto = reach as far as { $frames } frames a second allow
expert-downloaded = { $bytes } downloaded in { $seconds } s
expert-of-maps = index, houses, maps, guide { $bytes }
expert-of-level = level { $level }: { $bytes }
expert-by-cell = { $n ->
    [one] in the last cell; at most { $bytes }
   *[other] in each of the last { $n } cells; at most { $bytes }
}
expert-plan = Plan of cells
expert-across = { $metres } m across; wheel to zoom, point at a cell to ask why
expert-cell = cell { $cell }, { $name }: { $houses ->
    [one] { $houses } house
   *[other] { $houses } houses
}, { $level }; { $why }
expert-nameless = without a name
expert-level = level { $level } loaded
expert-level-none = not loaded
expert-why-none = nobody wants it
expert-why-kept = nobody needs it now; kept for a while, should you turn back
expert-why-seen = seen from cell { $from }
expert-why-ahead = seen from cell { $from }, next door
expert-why-on-the-way = near a place that the tour leads to
expert-why-skyline = it rises above the roofs
expert-why-near = near who flies or is in no cell
expert-journal = Journal
expert-index = the city's index
expert-leaf = leaf { $n } of the index
expert-region = region { $n } of the index
expert-overview = the overview of region { $n }
expert-houses = the houses of region { $n }
expert-file = file { $n } of the city
expert-packet = cell { $cell }, level { $level }
expert-opened = opened { $place }
expert-entered = entered cell { $cell }
expert-left = left all cells
expert-asked = asked for { $what }, { $bytes }
expert-arrived = arrived: { $what }, { $bytes }
expert-failed = failed: { $what }, again in { $seconds } s
expert-failed-for-good = failed for good: { $what }
expert-cancelled = taken back: { $what }
expert-released = released cell { $cell } from level { $level }, { $why }
expert-released-idle = unwanted
expert-released-cap = over the cap
