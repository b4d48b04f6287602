//! The example game: walk, film and look at a city.
