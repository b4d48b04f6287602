//! What covers the ground of a cell, as it is told from afar.

use std::collections::BTreeMap;

use veduta_city::{CellShell, GridRing, GroundPatch, SurfaceKind};

use crate::overlay::{Keep, combine, turned_rings};

/// Pieces that are one from afar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    /// Carriageways, pavements, squares: kerbs are not seen.
    Paved,
    /// The same kind at the same height.
    Kind(SurfaceKind, i32),
}

impl Class {
    const fn of(patch: &GroundPatch) -> Self {
        if patch.surface.is_public() { Self::Paved } else { Self::Kind(patch.surface, patch.z) }
    }
}

/// The ground of a cell's shell in few pieces, in the city's own coordinates: what is paved as one, by the surface and at the height of
/// most of it; else what is equal as one. Pieces are apart from each other and cover the same ground.
#[must_use]
pub fn ground_from_afar(shell: &CellShell) -> Vec<GroundPatch> {
    let mut classes: BTreeMap<Class, Vec<&GroundPatch>> = BTreeMap::new();
    for patch in &shell.ground {
        classes.entry(Class::of(patch)).or_default().push(patch);
    }
    let mut afar = Vec::new();
    for patches in classes.values() {
        let (surface, z) = most(patches);
        let rings: Vec<GridRing> = patches.iter().flat_map(|patch| turned_rings(&patch.outline)).collect();
        let pieces = combine(Keep::First, rings, [], false).into_iter();
        afar.extend(pieces.map(|piece| GroundPatch {
            surface,
            outline: piece.map(|pos| pos.wrapping_add(shell.origin)),
            z,
            course: None,
        }));
    }
    afar
}

/// Surface and height of most of the ground of some patches.
fn most(patches: &[&GroundPatch]) -> (SurfaceKind, i32) {
    let mut areas: BTreeMap<(SurfaceKind, i32), f64> = BTreeMap::new();
    for patch in patches {
        *areas.entry((patch.surface, patch.z)).or_default() += patch.outline.area_m2();
    }
    areas.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or((SurfaceKind::Yard, 0), |(most, _)| most)
}

#[cfg(test)]
mod tests {
    use veduta_city::{GridPolygon, GridPos};

    use super::*;

    #[test]
    fn a_street_is_one_piece_and_a_lawn_another() {
        let m = 1024;
        let strip = |from: i32, to: i32, surface, z| GroundPatch {
            surface,
            outline: GridPolygon::simple(vec![
                GridPos(0, from * m),
                GridPos(9 * m, from * m),
                GridPos(9 * m, to * m),
                GridPos(0, to * m),
            ]),
            z,
            course: Some(0),
        };
        let ground = vec![
            strip(0, 2, SurfaceKind::Mosaic, 150),
            strip(2, 8, SurfaceKind::Cobbles, 0),
            strip(8, 10, SurfaceKind::Mosaic, 150),
            strip(10, 15, SurfaceKind::Grass, 0),
            strip(15, 16, SurfaceKind::Grass, 0),
            strip(16, 17, SurfaceKind::Yard, 0),
            strip(17, 18, SurfaceKind::Grass, 0),
        ];
        let afar = ground_from_afar(&CellShell { origin: GridPos(m, 0), ground, ..CellShell::default() });
        let told = |patch: &GroundPatch| (patch.surface, patch.z, patch.outline.area_m2(), patch.outline.outer.len());
        let expected = [
            (SurfaceKind::Cobbles, 0, 90.0, 4),
            (SurfaceKind::Grass, 0, 54.0, 4),
            (SurfaceKind::Grass, 0, 9.0, 4),
            (SurfaceKind::Yard, 0, 9.0, 4),
        ]
        .to_vec();
        assert_eq!(afar.iter().map(told).collect::<Vec<_>>(), expected);
        assert_eq!(afar[0].outline.bounds(), Some((GridPos(m, 0), GridPos(10 * m, 10 * m))));
        assert!(afar.iter().all(|patch| patch.course.is_none()));
    }
}
