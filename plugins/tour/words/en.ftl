tour-waiting = The tour begins as soon as its streets have arrived …
tour-wandering = You have left the tour. T takes you back.
tour-pause = Pause the tour
tour-play = Play the tour
tour-stop = End the tour
tour-time = Time in the tour
