//! What is believed of the numbers in a graph or an edit.

/// Farthest from the anchor that anything of a city may lie, east or north; metres. Plan positions as stored keep within
/// ±2³⁰ steps of the grid, 1,048 km, and the origin of a cell stays 131 km away from that, so that all of the cell does too.
pub const FARTHEST_M: f64 = 900_000.0;
/// Streets and watercourses are not wider; metres.
pub const WIDEST_M: f64 = 400.0;
/// Nothing is higher above its ground; metres.
pub const HIGHEST_M: f64 = 1_000.0;
/// No house has more storeys.
pub const MOST_LEVELS: f64 = 200.0;
