//! The pipeline from map to city, and the veduta-bake program.
