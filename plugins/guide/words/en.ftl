# Places
place-fold = Show the name alone
place-unfold = Tell me more
place-hours = Open: { $hours }
place-link = Read more at { $site }
place-picture = Picture: { $what } ({ $site })
place-listen = Listen
place-silence = Stop listening
certainty-documented = shown as documented
certainty-typical = detail typical of its kind
certainty-invented = as it may have been

# Search
search-name = Search
search-hint = Where to? A place, a street, a tour …
search-nothing = Nothing has a name like that. Fewer letters find more.
search-walk = Walk there
search-jump = Be there
search-show = Show on the map
search-do = Do it
search-close = Close
search-without-steps = Without stairs
search-keys = ⬆ ⬇ choose · Enter walk there · Shift+Enter be there · Ctrl+Enter show on the map · Esc close
search-street = street
search-offer = command
search-metres = { $metres } m
search-kilometres = { $kilometres } km
kind-viewpoint = view
kind-house = house
kind-shop = shop
kind-monument = sight
kind-square = square
kind-street = street
kind-other = place

# On the way
lead-to = To { $name }
lead-to-spot = To where you clicked
lead-left = { $metres } m, { $minutes ->
    [0] less than a minute
    [one] about a minute
   *[other] about { $minutes } minutes
}
lead-stop = Stop here
lead-waits = The street ahead is on its way …
lead-no-way = No way on foot leads to { $name }.
lead-over-steps = Only stairs lead to { $name }. Search finds ways with them too, if you let it.

# What controls do
control-search-open = search, and be led there
