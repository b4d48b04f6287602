//! The city plan from the city graph.
