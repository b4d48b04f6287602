//! What cells look like from afar, made of an overview.

use veduta_city::{
    CellShell, District, GRID_PER_METRE, Gable, GridPolygon, GridPos, GroundPatch, HouseShell, Massing, Overview, SpanStation,
    VolumeShell, WaySpan,
};

use super::data::MeshData;
use super::{ground, level1, roof_coverings, spans};

/// How far walls go on below the lowest ground at their corners, grid steps.
const INTO_GROUND: i32 = GRID_PER_METRE;

/// The cells that an overview tells of, as shells of what is seen of them from afar: their ground, houses as outlines raised to their
/// eaves under plain roofs, and bridges. Where its districts name more than it has, they end.
pub fn districts(overview: &Overview) -> impl Iterator<Item = (u32, CellShell)> {
    let mut ground = overview.ground.iter();
    let mut houses = overview.houses.iter();
    let mut spans = overview.spans.iter();
    overview.districts.iter().map(move |&District { cell, ground: patches, houses: massings, spans: ways }| {
        let parts = Parts {
            ground: ground.by_ref().take(patches as usize).collect(),
            houses: houses.by_ref().take(massings as usize).collect(),
            // What leads below the ground is not seen from afar.
            spans: spans.by_ref().take(ways as usize).filter(|span| span.is_bridge()).collect(),
        };
        (cell, parts.shell(overview))
    })
}

/// The mesh of such a shell. Centres are as those of the parts that it is made of.
#[must_use]
pub fn afar(shell: &CellShell) -> MeshData {
    let mut mesh = ground(shell);
    mesh.append(&level1(shell));
    mesh.append(&roof_coverings(shell));
    mesh.append(&spans(shell));
    mesh
}

/// What of an overview belongs to one district.
struct Parts<'a> {
    ground: Vec<&'a GroundPatch>,
    houses: Vec<&'a Massing>,
    spans: Vec<&'a WaySpan>,
}

impl Parts<'_> {
    fn bounds(&self) -> Option<(GridPos, GridPos)> {
        let outlines = self.ground.iter().map(|patch| &patch.outline).chain(self.houses.iter().map(|massing| &massing.outline));
        let stations = self.spans.iter().flat_map(|span| &span.stations).flat_map(|station| [station.left, station.right]);
        let all = outlines.filter_map(GridPolygon::bounds).chain(stations.map(|pos| (pos, pos)));
        all.reduce(|(lo, hi), (l, h)| (GridPos(lo.0.min(l.0), lo.1.min(l.1)), GridPos(hi.0.max(h.0), hi.1.max(h.1))))
    }

    fn shell(&self, overview: &Overview) -> CellShell {
        let Some(bounds) = self.bounds() else { return CellShell::default() };
        let middle = bounds.0.midpoint(bounds.1);
        let whole = |steps: i32| steps.div_euclid(GRID_PER_METRE) * GRID_PER_METRE;
        let origin = GridPos(whole(middle.0), whole(middle.1));
        let local = |pos: GridPos| pos.wrapping_sub(origin);
        let moved = |of: &GridPolygon| of.map(local);
        let patch = |patch: &&GroundPatch| GroundPatch { outline: moved(&patch.outline), ..(*patch).clone() };
        let station = |station: &SpanStation| SpanStation { left: local(station.left), right: local(station.right), ..*station };
        let span = |span: &&WaySpan| WaySpan { stations: span.stations.iter().map(station).collect(), ..(*span).clone() };
        let house = |massing: &&Massing| house(massing, overview, moved(&massing.outline));
        CellShell {
            origin,
            terrain: overview.terrain.crop(bounds, origin),
            ground: self.ground.iter().map(patch).collect(),
            houses: self.houses.iter().map(house).collect(),
            spans: self.spans.iter().map(span).collect(),
            drawn_spans: self.spans.len() as u32,
            ..CellShell::default()
        }
    }
}

fn house(massing: &Massing, overview: &Overview, footprint: GridPolygon) -> HouseShell {
    let elevation = |&pos: &GridPos| overview.terrain.height(pos);
    let first = massing.outline.outer.first().map_or(0, elevation);
    let lowest = massing.outline.outer.iter().map(elevation).fold(first, i32::min);
    let eaves = first.saturating_add(massing.height).saturating_sub(massing.roof.height);
    let edges: usize = footprint.rings().map(Vec::len).sum();
    let volume = VolumeShell {
        footprint,
        bottom: lowest.saturating_sub(INTO_GROUND),
        eaves,
        colour: massing.colour,
        trim: massing.colour,
        roof: massing.roof,
        gable: Gable::Plain,
        has_roof: true,
        walls: (0..=u16::MAX).take(edges).collect(),
        arcades: Vec::new(),
    };
    HouseShell { style: 0, floor: lowest, volumes: vec![volume], is_monument: false }
}

#[cfg(test)]
mod tests {
    use veduta_city::{PlanRoof, PlanTerrain, Rgb, RoofShape, SurfaceKind};

    use super::*;

    const M: i32 = GRID_PER_METRE;

    fn square(x: i32, side: i32) -> GridPolygon {
        let at = |x: i32, y: i32| GridPos(x * M, y * M);
        GridPolygon::simple(vec![at(x, 0), at(x + side, 0), at(x + side, side), at(x, side)])
    }

    fn overview() -> Overview {
        let roof = PlanRoof { shape: RoofShape::Gabled, height: 4 * M, direction: 90, colour: Rgb(170, 68, 51) };
        let massing = |x: i32| Massing { outline: square(x, 10), height: 14 * M, roof, colour: Rgb(204, 187, 153) };
        let patch = |x: i32| GroundPatch { surface: SurfaceKind::Cobbles, outline: square(x, 30), z: 0, course: None };
        let district = |cell: u32, ground: u32, houses: u32| District { cell, ground, houses, spans: 0 };
        Overview {
            // Rises by a metre every four to the east.
            terrain: PlanTerrain {
                origin: GridPos(-4 * M, -4 * M),
                step: 4 * M,
                columns: 40,
                heights: (0..800).map(|i| i % 40 * M).collect(),
            },
            ground: vec![patch(0), patch(30)],
            houses: vec![massing(0), massing(40), massing(60)],
            districts: vec![district(7, 1, 1), district(9, 1, 2), district(11, 1, 5)],
            ..Overview::default()
        }
    }

    #[test]
    fn each_cell_has_its_own_ground_and_houses() {
        let overview = overview();
        let shells: Vec<(u32, CellShell)> = districts(&overview).collect();
        let told: Vec<(u32, usize, usize)> = shells.iter().map(|(cell, s)| (*cell, s.ground.len(), s.houses.len())).collect();
        assert_eq!(told, [(7, 1, 1), (9, 1, 2), (11, 0, 0)], "the last names more than there is");
        for (cell, shell) in &shells {
            let mesh = afar(shell);
            mesh.validate().expect("sound");
            assert_eq!(mesh.is_empty(), *cell == 11);
        }
    }

    #[test]
    fn houses_stand_in_the_slope_and_reach_as_high_as_they_are() {
        let overview = overview();
        let (_, shell) = districts(&overview).next().expect("one");
        let volume = &shell.houses[0].volumes[0];
        // The ground at the first corner (0, 0) lies a metre high, the lowest at its foot.
        assert_eq!((volume.eaves, volume.bottom), (11 * M, 0));
        let mesh = afar(&shell);
        let top = mesh.positions.iter().map(|p| p[1]).fold(f32::MIN, f32::max);
        assert!((top - 15.0).abs() < 1e-3, "{top}");
        let east = mesh.positions.iter().map(|p| p[0] + shell.origin.to_metres().x as f32).fold(f32::MIN, f32::max);
        assert!((east - 30.0).abs() < 1e-3, "positions are relative to the shell's origin: {east}");
    }
}
