//! Partition of free space into cells and portals, and visible sets.
