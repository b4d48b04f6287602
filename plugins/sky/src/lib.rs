//! Plugin: sun, sky, fog and night.
