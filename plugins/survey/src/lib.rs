//! Maps to city graph: OpenStreetMap extracts today, raster maps to come.
