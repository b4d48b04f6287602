//! Plugin: streams a city cell by cell around the viewers.
