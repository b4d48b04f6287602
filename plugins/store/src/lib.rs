//! A city on disk or behind HTTP: index, packets and checksums.
