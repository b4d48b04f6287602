//! Plugin: guided tours scripted in RON.
