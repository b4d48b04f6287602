//! The pipeline from map to city, and the `veduta-bake` program.
//!
//! ```text
//!  OSM, GeoJSON, Shapefile, picture ─survey─► graph ─overrides─► grow ─► plan ─► partition ─► cells ─► packets ─► DIR.city
//!                    *.graph.ron ──┘      ▲           *.plan.ron ──┤        ▲
//!                                         │                        │        └── edits of cells
//!                                         │                        └─► X.glb, X.svg, X.png
//!                                         └── models, edits ◄── adopt ◄── X.glb, changed in a modeller
//! ```
//!
//! Each arrow is a pure function of its input, a seed and the overrides; each value can be written to a file, looked at,
//! edited and fed to the next step. No GPU and no engine are needed.
//!
//! ```no_run
//! use std::path::Path;
//! use veduta_bake::{bake, BakeSettings};
//!
//! let baked = bake(Path::new("town.osm.pbf"), Path::new("town.city"), &BakeSettings::default(), &mut |stage| println!("{stage}"))?;
//! println!("{}, {} findings", baked.stats, baked.findings.len());
//! # Ok::<(), veduta_bake::BakeError>(())
//! ```
//!
//! # Limits
//! One input at a time; the whole plan is in memory while it is baked: some 2 kB a house at the peak, beside 30 MB.
//!
//! # Rejected
//! A task graph with cached stages: every stage takes well under a second for a town.

mod adopt;
mod companions;
mod enlarge;
mod error;
mod export;
mod facade;
mod input;
mod model;
mod pipeline;
mod proof;
mod raster_map;
mod scene;
mod terrain;
mod vector_map;

pub use adopt::{Adopted, adopt};
pub use enlarge::enlarged;
pub use error::BakeError;
pub use export::{ExportError, ExportSettings, export_cells, export_glb, export_monuments};
pub use facade::{files_of_overrides, read_facade, read_facades};
pub use input::{Heights, Input, InputKind};
pub use model::read_models;
pub use pipeline::{BakeSettings, Baked, Planned, Stage, bake, bake_input, cell_edits, cut, plan, survey, survey_bare};
pub use proof::{Missing, Proof, ProofSettings, prove};
pub use raster_map::{RasterMap, RasterSurvey};
pub use scene::{Astray, below, cells_overrides_beside, overrides_beside};
pub use terrain::lay_on_ground;
pub use vector_map::{LayerFile, VectorMap};
pub use veduta_cells::PARTITION_VERSION;
pub use veduta_growth::mesh::monument_bounds;
pub use veduta_growth::plan::{GROWTH_VERSION, Stock, StockError};
