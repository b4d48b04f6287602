//! Ways along streets and through cells, and the poses of a tour over time.
