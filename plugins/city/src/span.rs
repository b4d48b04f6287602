use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{GridPolygon, GridPos, Id, MarkingKind, SurfaceKind, metres};

/// What holds a way that leaves the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum SpanForm {
    /// A bridge: stone vaults on piers, with stone parapets.
    #[default]
    Arches,
    /// A bridge: beams on slender piers, with railings.
    Girder,
    /// A cutting between retaining walls, open to the sky, that leads down to a tunnel. Its walls stand beyond its stations.
    Ramp,
    /// A vault below the ground.
    Bore {
        /// From the carriageway to the vault's crown, grid steps.
        crown: i32,
        /// What is at its start and at its end.
        ends: (BoreEnd, BoreEnd),
    },
}

/// What is at an end of a bore.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum BoreEnd {
    /// The next bore.
    #[default]
    Bore,
    /// A portal, at the lower end of a ramp.
    Portal,
    /// A wall: nothing is known of how it goes on.
    Wall,
}

/// A stretch of a way that is off the ground: on a bridge, from one of its piers, the land or where
/// another bridge begins or ceases to lie beside it, to the next; or below the ground. The spans of
/// a way share their end stations.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaySpan {
    /// Id of the link that it carries.
    pub id: Id,
    /// What holds it.
    pub form: SpanForm,
    /// What the carriageway is covered with, or all of it where there is no pavement.
    pub surface: SurfaceKind,
    /// Widths of the pavements on its left and on its right, grid steps; 0 where there is none.
    pub pavements: (i32, i32),
    /// Whether it has a parapet, railing or wall on its left and on its right: not where another bridge lies beside it.
    pub parapets: (bool, bool),
    /// Cross-sections along it: two or more.
    pub stations: Vec<SpanStation>,
    /// Arches: where they spring from above the city's zero, grid steps.
    pub springing: i32,
    /// Bridges: feet of the piers under its start and its end above the city's zero, grid steps; none where that is on land or within a span. The pier
    /// between two spans is drawn with the one that ends there.
    pub piers: (Option<i32>, Option<i32>),
    /// Paint and rails on it.
    #[serde(default)]
    pub markings: Vec<SpanMarking>,
}

/// A cross-section of a way: level across.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpanStation {
    /// Its left end, seen along the way: parapets stand beyond it.
    pub left: GridPos,
    /// Its right end.
    pub right: GridPos,
    /// Height of the carriageway above the city's zero, grid steps.
    pub z: i32,
}

impl SpanStation {
    /// A place so far to the left of its middle, metres.
    #[must_use]
    pub fn at(&self, left_m: f64) -> DVec2 {
        let (left, right) = (self.left.to_metres(), self.right.to_metres());
        (left + right) / 2.0 + (left - right).normalize_or_zero() * left_m
    }

    /// Half the width of the way, metres.
    #[must_use]
    pub fn half_m(&self) -> f64 {
        self.left.to_metres().distance(self.right.to_metres()) / 2.0
    }
}

/// Paint or rails along a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpanMarking {
    /// What it is: not a zebra.
    pub kind: MarkingKind,
    /// How far to the left of the middle it begins and ends, grid steps.
    pub left: (i32, i32),
    /// As [`Marking::width`](crate::Marking::width).
    pub width: i32,
}

impl WaySpan {
    /// Whether it lies above the ground.
    #[must_use]
    pub const fn is_bridge(&self) -> bool {
        matches!(self.form, SpanForm::Arches | SpanForm::Girder)
    }

    /// Whether it lies below the ground with a roof of earth.
    #[must_use]
    pub const fn is_bore(&self) -> bool {
        matches!(self.form, SpanForm::Bore { .. })
    }

    /// Whether it lies below the ground and the ground is open above it.
    #[must_use]
    pub const fn is_ramp(&self) -> bool {
        matches!(self.form, SpanForm::Ramp)
    }

    /// The way's outline in plan, counter-clockwise.
    #[must_use]
    pub fn outline(&self) -> GridPolygon {
        let right = self.stations.iter().map(|station| station.right);
        let mut ring: Vec<GridPos> = right.chain(self.stations.iter().rev().map(|station| station.left)).collect();
        ring.dedup();
        GridPolygon::simple(ring)
    }

    /// The middle of the span, half-way between its first station and its last; `None` if it has none.
    #[must_use]
    pub fn middle(&self) -> Option<GridPos> {
        let (first, last) = (self.stations.first()?, self.stations.last()?);
        Some(GridPos::from_metres((first.at(0.0) + last.at(0.0)) / 2.0))
    }

    /// Height of its carriageway above the city's zero at a place in plan, metres; `None` where it does not lead.
    #[must_use]
    pub fn height_m(&self, p: DVec2) -> Option<f64> {
        self.stations.windows(2).find_map(|pair| {
            let [a, b] = [pair[0], pair[1]];
            let corners = [a.right, b.right, b.left, a.left].map(GridPos::to_metres);
            // How far it is inside of each side.
            let inside = |i: usize| {
                let (from, to) = (corners[i], corners[(i + 1) % 4]);
                (to - from).normalize_or_zero().perp_dot(p - from)
            };
            let [right, end, left, start] = [0, 1, 2, 3].map(inside);
            let is_here = [right, end, left, start].iter().all(|&d| d >= -NEAR_M);
            is_here.then(|| {
                let (start, end) = (start.max(0.0), end.max(0.0));
                let share = if start + end > 0.0 { start / (start + end) } else { 0.0 };
                metres(a.z) + (metres(b.z) - metres(a.z)) * share
            })
        })
    }
}

/// Nearer to an edge than this is on it, metres.
const NEAR_M: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    fn span() -> WaySpan {
        let station = |x: f64, y: f64, z: f64| SpanStation {
            left: GridPos::from_metres(DVec2::new(x, y + 3.0)),
            right: GridPos::from_metres(DVec2::new(x, y - 3.0)),
            z: GridPos::steps(z),
        };
        WaySpan {
            id: Id(1),
            form: SpanForm::Arches,
            surface: SurfaceKind::Cobbles,
            pavements: (0, 0),
            parapets: (true, true),
            stations: vec![station(0.0, 0.0, 1.0), station(10.0, 0.0, 2.0), station(20.0, 4.0, 2.0)],
            springing: 0,
            piers: (None, None),
            markings: Vec::new(),
        }
    }

    #[test]
    fn a_span_is_as_high_as_its_stations_and_leads_no_farther() {
        let span = span();
        let at = |x, y| span.height_m(DVec2::new(x, y));
        assert_eq!([at(0.0, 0.0), at(5.0, 2.9), at(15.0, 2.0)], [Some(1.0), Some(1.5), Some(2.0)]);
        assert_eq!([at(-0.1, 0.0), at(5.0, 3.1), at(20.1, 4.0)], [None; 3]);
        let outline = span.outline();
        assert!((outline.area_m2() - 120.0).abs() < 1e-9 && outline.outer.len() == 6);
        assert_eq!(span.middle(), Some(GridPos(10 * 1024, 2 * 1024)));
    }
}
