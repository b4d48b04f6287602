//! Plugin: places, information and search.
