use serde::{Deserialize, Serialize};

use crate::{GridPolygon, GridPos, Id, ObjectKind, PlanStreet, SurfaceKind};

/// The whole city in outline: what maps, search and routes need. Loaded once, whatever the walker sees.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Overview {
    /// Centre lines of streets, with names.
    pub streets: Vec<PlanStreet>,
    /// Streets' surfaces, squares, parks, water.
    pub areas: Vec<(SurfaceKind, GridPolygon)>,
    /// Houses: id, footprint of each volume, highest point in grid steps.
    pub houses: Vec<(Id, GridPolygon, i32)>,
    /// Standing objects that a map shows.
    pub objects: Vec<(ObjectKind, GridPos)>,
}
