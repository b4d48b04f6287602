//! Ground patches by place.

use rstar::{
    AABB, RTree,
    primitives::{GeomWithData, Rectangle},
};
use veduta_city::{CityPlan, GridPolygon, GridPos, GroundPatch, PlanTerrain};

use crate::overlay::{Bounds, clip_patch};

/// Finds ground patches by their bounds.
pub(crate) struct Patches<'a> {
    ground: &'a [GroundPatch],
    terrain: &'a PlanTerrain,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
}

pub(crate) fn corner(p: GridPos) -> [f64; 2] {
    [f64::from(p.0), f64::from(p.1)]
}

impl<'a> Patches<'a> {
    pub(crate) fn new(plan: &'a CityPlan) -> Self {
        let (ground, terrain) = (plan.ground.as_slice(), &plan.terrain);
        let rectangles = ground.iter().enumerate().filter_map(|(i, patch)| {
            let (lo, hi) = patch.outline.bounds()?;
            Some(GeomWithData::new(Rectangle::from_corners(corner(lo), corner(hi)), i))
        });
        Self { ground, terrain, tree: RTree::bulk_load(rectangles.collect()) }
    }

    /// Patches whose bounds touch a box, in the plan's order.
    pub(crate) fn near(&self, (lo, hi): Bounds) -> Vec<&'a GroundPatch> {
        let envelope = AABB::from_corners(corner(lo), corner(hi));
        let mut found: Vec<usize> = self.tree.locate_in_envelope_intersecting(&envelope).map(|r| r.data).collect();
        found.sort_unstable();
        found.into_iter().map(|i| &self.ground[i]).collect()
    }

    /// Height of the ground at a position above the city's zero, where there is a patch.
    pub(crate) fn z_at(&self, pos: GridPos) -> Option<i32> {
        let patch = self.near((pos, pos)).into_iter().find(|patch| patch.outline.contains(pos))?;
        Some(patch.z.saturating_add(self.terrain.height(pos)))
    }

    /// No ground about a box is lower than this; `None` if there is none.
    pub(crate) fn lowest(&self, bounds: Bounds) -> Option<i32> {
        let patch = self.near(bounds).iter().map(|patch| patch.z).min()?;
        Some(patch.saturating_add(self.terrain.range(bounds).0))
    }

    /// Whether a position lies on public ground.
    pub(crate) fn is_public_at(&self, pos: GridPos) -> bool {
        self.near((pos, pos)).into_iter().any(|patch| patch.surface.is_public() && patch.outline.contains(pos))
    }

    /// The pieces of ground within a window: (patch, piece).
    pub(crate) fn clipped(&self, window: &GridPolygon) -> Vec<(&'a GroundPatch, GridPolygon)> {
        let Some(bounds) = window.bounds() else { return Vec::new() };
        let near = self.near(bounds).into_iter();
        near.flat_map(|patch| clip_patch(&patch.outline, window, bounds).into_iter().map(move |piece| (patch, piece))).collect()
    }

    /// Lowest and highest ground within a window, by the posts of the terrain about it; `None` if there is none.
    pub(crate) fn heights(&self, window: &GridPolygon) -> Option<(i32, i32)> {
        let ((lowest, highest), (low, high)) = (self.lifts(window)?, self.terrain.range(window.bounds()?));
        Some((lowest.saturating_add(low), highest.saturating_add(high)))
    }

    /// Least and greatest height of patches above the terrain within a window.
    fn lifts(&self, window: &GridPolygon) -> Option<(i32, i32)> {
        let bounds = window.bounds()?;
        let near = self.near(bounds);
        let (lowest, highest) = (near.iter().map(|p| p.z).min()?, near.iter().map(|p| p.z).max()?);
        if lowest == highest {
            return Some((lowest, highest));
        }
        let mut found: Option<(i32, i32)> = None;
        for patch in near {
            let is_known = found.is_some_and(|(lo, hi)| lo <= patch.z && patch.z <= hi);
            if !is_known && !clip_patch(&patch.outline, window, bounds).is_empty() {
                let (lo, hi) = found.unwrap_or((patch.z, patch.z));
                found = Some((lo.min(patch.z), hi.max(patch.z)));
            }
        }
        found
    }
}
