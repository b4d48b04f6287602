//! Partition of a city's free space into cells and portals, what belongs to each cell, and what can be seen from it.
//!
//! ```text
//!  CityPlan ─ free space ─► shapes ─ triangulate ─► triangles ─ reach, merge ─► cells, portals ─┬─ assign ─► walls, roofs,
//!             extent less           constrained                 cut at                          │            objects
//!             houses                Delaunay                    narrow places                   └─ visible sets, skyline
//!
//!  CityPlan + Cells ─► cell_shells (level-1 packets) · facade_sheets (level-2 packets) · check (invariants)
//! ```
//!
//! # Use
//! ```
//! use veduta_cells::{PartitionSettings, cell_shells, check, facade_sheets, partition};
//! use veduta_city::{CityPlan, GridPolygon, GridPos, GroundPatch, SurfaceKind};
//!
//! // A bare square of 100 m × 100 m.
//! let side = GridPos::steps(100.0);
//! let square = GridPolygon::simple(vec![GridPos(0, 0), GridPos(side, 0), GridPos(side, side), GridPos(0, side)]);
//! let plan = CityPlan {
//!     extent: square.clone(),
//!     ground: vec![GroundPatch { surface: SurfaceKind::Cobbles, outline: square, z: 0, course: None }],
//!     ..CityPlan::default()
//! };
//!
//! let partition = partition(&plan, &[], &PartitionSettings::default());
//! assert!(partition.findings.is_empty() && check(&plan, &partition.cells).is_empty());
//! let area: f64 = partition.cells.cells.iter().map(|cell| cell.outline.area_m2()).sum();
//! assert!((area - 10_000.0).abs() < 1e-6);
//! // Nothing hides anything on a bare square.
//! assert!(partition.cells.visible.iter().all(|seen| seen.len() == partition.cells.cells.len()));
//! assert_eq!(cell_shells(&plan, &partition.cells).len(), facade_sheets(&plan, &partition.cells).len());
//! ```
//!
//! # Method
//! * Free space is the extent less the footprints of all volumes that stand on the ground, in integers: in steps of the plan, where all
//!   of it lies on them.
//! * It is triangulated (constrained Delaunay; a sparse lattice of points keeps triangles in the open small) and the triangles
//!   are joined across their longest edges first while the union stays small and nearly convex, so that the short edges, the
//!   narrow places, are left as portals. Pieces without public ground that is wide enough to walk to (courtyards behind a slit
//!   between houses, too) are left out of the cells; their ground goes to the nearest cell's packet.
//! * A person's edits ([`veduta_city::CellsOverrides`]) come after: cells joined, cut along a line, named. They change no other cell.
//! * Visible sets follow Teller and Séquin, *Visibility preprocessing for interactive walkthroughs* (1991), in plan: a cell is
//!   visible if some straight line stabs a sequence of portals that leads to it. The set of stabbing lines is kept as a convex
//!   polygon in the dual plane, where each portal's end is one half-plane; see [`PartitionSettings::line_sets`]. Lines go on through
//!   yards and slits that nobody walks to, and reach what stands at the border of a cell and is drawn with another one: walls that face
//!   two cells, roofs of corner houses, crowns of trees.
//! * A shell tells its ground as it is seen, not as it was cut: what is alike is one piece, vertices at which nothing ends or turns are dropped from
//!   all pieces at once, and yards run on under the houses about them.
//! * What a plan's change does to the cut stays near it: of 2,000 changes of a house or block within two towns none reached a cell farther than 174 m
//!   away; the outlines, ids and names of all others are the same. Where a house is built across the city's edge, though, corners move all
//!   along that side, for it is cut in equal pieces. [`Recut`] makes a partition again with what it knows of the one before.
//!
//! # Limits
//! * One floor: passages under hanging volumes are free space, and so is what lies under bridges: a span belongs to the cell that its
//!   middle lies over, and whoever is on it is in the cell below. Tunnels' spans belong to the cells above them; who sees a
//!   ramp's sees them all.
//! * Visibility is in plan: what rises above the roofs is told by [`veduta_city::Cells::skyline`], everything lower is taken to be hidden by
//!   any house, and seen as a district where it is not. Visible sets reach as far as [`PartitionSettings::sight_m`]; what is seen along the
//!   ground beyond is told in squares ([`veduta_city::Cells::far`]), by directions alone, as far as [`PartitionSettings::far_m`].
//!   Where the ground is hilly, so is what is seen over the roofs from 500 m on; eyes in the middles of cells and portals look for it,
//!   which is a sample. `veduta-bake inspect --prove` tells what all of them lack. Walls inside one cell hide nothing. All this only
//!   matters to what is loaded, never to what is drawn.
//! * Water is free space (one looks across it); its ground patches tell the walker where it is.
//! * The extent may span 260 km and lie within 1,000 km of the anchor.
//!
//! # Rejected
//! * *Straight skeletons or a grid of tiles* for the cut: the first is fragile on real footprints, the second cuts streets at
//!   random and makes portals that hide nothing.
//! * *Rays from sample points* for visible sets: fast, but they miss cells seen through a slit, and a missed cell is a hole.
//! * *Rays over a field of heights* (squares of 4 m, a horizon kept along each line from where it enters a cell) for what rises behind the
//!   roofs: 125,000 of them take more than twice as long as all the rest in the sample city, add a quarter to the sets, and still miss
//!   one in sixteen of the pairs that 40 million random rays find. Districts of the overview stand there instead, as far as it reaches.
//! * *Enumerating portal sequences*: exact, but exponential on open ground; sets of lines are merged instead, which may add a
//!   cell that cannot quite be seen and never loses one.
//! * *Boolean operations on floats* (geo's front of the same engine): rounding back to the grid would open cracks.

mod afar;
mod assign;
mod buckets;
mod check;
mod chord;
mod directions;
mod edit;
mod far;
mod free;
mod ground;
mod guests;
mod hull;
mod lines;
mod locate;
mod merge;
mod name;
mod outline;
mod over;
mod overlay;
mod partition;
mod patches;
mod reach;
mod recut;
mod rooms;
mod shell;
mod skyline;
mod triangulate;
mod tunnels;
mod visible;
mod widen;

/// Version of the partition: the same plan gives the same cells, portals and visible sets by one version; another may differ.
pub const PARTITION_VERSION: u32 = 7;

pub use afar::ground_from_afar;
pub use check::{CellsError, check};
pub use partition::{Partition, PartitionSettings, partition};
pub use recut::Recut;
pub use shell::{Contents, cell_shells, facade_sheets};
pub use visible::{Seen, visible_sets};
