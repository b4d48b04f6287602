//! Veduta: a city you can walk through, as Bevy plugins.
