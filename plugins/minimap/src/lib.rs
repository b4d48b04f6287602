//! Plugin: minimap HUD and full map.
