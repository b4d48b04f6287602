//! What street fronts carry besides their openings: see [`Ornament`].
//!
//! Packets may tell of bays and storeys that a wall does not have; what they tell of these is not drawn.

use glam::DVec2;
use veduta_city::{Articulation, Balconies, Niche, Opening, Oriel, Ornament, Parapet, Rgb, Storey, Tile, VolumeShell, Wall};

use super::data::{MeshData, Paint};
use super::moulding::{End, Section, is_open_to_ground, sweep};
use super::outline::{Edge, engine};
use super::roof_detail::mitre;
use super::shape::{Block, Sculptor};
use super::wall::Front;

/// Half the breadth of a pilaster, how far its base and capital reach beyond that, and their heights; metres.
const PILASTER_M: f64 = 0.23;
const REACH_M: f64 = 0.06;
const BASE_M: f64 = 0.34;
const CAPITAL_M: f64 = 0.4;
/// Articulation ends so far below the eaves, under the crown cornice, and pilasters begin so far above the floor; metres.
const UNDER_CROWN_M: f64 = 0.42;
const OVER_STRING_M: f64 = 0.17;
/// Height of a quoin with its joint, and of the joint; metres.
const QUOIN_M: f64 = 0.46;
const JOINT_M: f64 = 0.05;
/// Lengths of the long and the short ones as shares of a bay, the widest bay that counts, and the shortest quoin; metres.
const QUOIN_SHARES: [f64; 2] = [0.21, 0.14];
const WIDEST_QUOIN_BAY_M: f64 = 3.5;
const LEAST_QUOIN_M: f64 = 0.22;
/// Share of its bay that an oriel fills, its most breadth, how far it stands out, and how much narrower its front is; metres.
const ORIEL_SHARE: f64 = 0.84;
const ORIEL_MOST_M: f64 = 2.7;
const ORIEL_OUT_M: f64 = 0.85;
const ORIEL_SIDE_M: f64 = 0.42;
/// Heights of the corbel below an oriel and of the roof on it; metres.
const CORBEL_M: f64 = 0.62;
const ORIEL_ROOF_M: f64 = 0.95;
/// How far balconies reach, how far they stay within their bays, and the heights of slab and parapet; metres.
const BALCONY_OUT_M: f64 = 1.0;
const WITHIN_M: f64 = 0.34;
const SLAB_M: f64 = 0.16;
const PARAPET_M: f64 = 1.0;

/// A cell's walls and what they carry are drawn up to so many vertices: packets come from anywhere.
pub(super) const MOST_VERTICES: usize = 1 << 22;
/// Lower storeys have no balconies, and longer balconies are not drawn; metres.
const LEAST_STOREY_M: f64 = 1.5;
const LONGEST_M: f64 = 40.0;

const IRON: Rgb = Rgb(0x33, 0x38, 0x36);
pub(super) const SANDSTONE: Rgb = Rgb(0xC2, 0xB2, 0x94);

/// Adds a front's ornaments; `stands`: whether its volume stands on the ground.
pub(super) fn adorn(
    front: &Front,
    plan: &Wall,
    ornament: &Ornament,
    ends: [End; 2],
    (volume, stands): (&VolumeShell, bool),
    mesh: &mut MeshData,
) {
    let Some(levels) = levels(front, plan).filter(|_| mesh.positions.len() <= MOST_VERTICES) else { return };
    let trim = front.plaster.with_tile(Tile::Carved);
    let dresser = Dresser { front, plan, levels, volume, stands, trim };
    match ornament.articulation {
        Articulation::Plain => {}
        Articulation::Quoins => dresser.quoins(ends, mesh),
        Articulation::Pilasters => dresser.pilasters(ornament.oriel, mesh),
    }
    if let Some(oriel) = ornament.oriel {
        dresser.oriel(oriel, mesh);
    }
    if let Some(balconies) = ornament.balconies {
        dresser.balconies(balconies, mesh);
    }
    if let Some(niche) = ornament.niche {
        dresser.niche(niche, mesh);
    }
}

/// Heights of a wall's floors and of its eaves; `None` where it has no storeys or no bays.
fn levels(front: &Front, plan: &Wall) -> Option<Vec<f64>> {
    let risen = plan.storeys.iter().scan(0_i64, |risen, storey| {
        *risen += i64::from(storey.height.max(0));
        Some(*risen)
    });
    let risen: Vec<i64> = core::iter::once(0).chain(risen).collect();
    let total = *risen.last().filter(|&&total| total > 0)?;
    let stretch = (front.eaves - front.bottom) / total as f64;
    (plan.bays > 0).then(|| risen.iter().map(|&steps| front.bottom + steps as f64 * stretch).collect())
}

struct Dresser<'a> {
    front: &'a Front,
    plan: &'a Wall,
    /// Floors of the storeys, and the eaves.
    levels: Vec<f64>,
    volume: &'a VolumeShell,
    /// Whether its lowest storey is on the ground.
    stands: bool,
    trim: Paint,
}

impl Dresser<'_> {
    /// Where a bay begins, metres along the wall.
    fn bay_m(&self, bay: u8) -> f64 {
        self.front.edge.length * f64::from(bay) / f64::from(self.plan.bays)
    }

    /// A stretch of the wall.
    fn stretch(&self, from: f64, to: f64) -> Option<Edge> {
        let edge = &self.front.edge;
        Edge::new(edge.a + edge.along * from, edge.a + edge.along * to)
    }

    /// Floor of the lowest storey and ceiling of the highest, if the wall has them.
    fn span(&self, (low, high): (u8, u8)) -> Option<(f64, f64)> {
        let at = |storey: usize| self.levels.get(storey).copied();
        (low <= high).then_some((at(low.into())?, at(usize::from(high) + 1)?))
    }

    /// Between all bays but those beside an oriel.
    fn pilasters(&self, oriel: Option<Oriel>, mesh: &mut MeshData) {
        // Over an arcade, the wall begins with its first floor.
        let Some(&first) = self.levels.get(usize::from(self.stands)) else { return };
        let (low, high) = (first + OVER_STRING_M, self.front.eaves - UNDER_CROWN_M);
        let (length, widest) = (self.front.edge.length, PILASTER_M + 1.5 * REACH_M);
        if high - low < 3.0 * (BASE_M + CAPITAL_M) || length < 4.0 * widest {
            return;
        }
        let shaft = high - low - BASE_M - CAPITAL_M;
        let parts: [(f64, f64, &Section); 3] = [
            (REACH_M, low, &[(0.0, 0.0), (0.19, 0.0), (0.19, 0.2), (0.14, BASE_M), (0.0, BASE_M)]),
            (0.0, low + BASE_M, &[(0.12, 0.0), (0.12, shaft), (0.0, shaft)]),
            (1.5 * REACH_M, high - CAPITAL_M, &[(0.0, 0.0), (0.15, 0.06), (0.22, 0.26), (0.22, CAPITAL_M), (0.0, CAPITAL_M)]),
        ];
        let is_beside = |bay: &u8| oriel.is_some_and(|oriel| (oriel.bay..=oriel.bay.saturating_add(1)).contains(bay));
        for bay in (0..=self.plan.bays).filter(|bay| !is_beside(bay)) {
            let middle = self.bay_m(bay).clamp(widest + 0.02, length - widest - 0.02);
            for (reach, foot, section) in parts {
                let half = PILASTER_M + reach;
                let Some(edge) = self.stretch(middle - half, middle + half) else { continue };
                sweep(&edge, [End::Square; 2], section, foot, self.trim, mesh);
            }
        }
    }

    fn quoins(&self, ends: [End; 2], mesh: &mut MeshData) {
        let high = self.front.eaves - UNDER_CROWN_M;
        let count = ((high - self.front.bottom) / QUOIN_M).clamp(0.0, 200.0) as usize;
        let length = self.front.edge.length;
        // Windows begin behind the longest.
        let lengths = QUOIN_SHARES.map(|share| share * (length / f64::from(self.plan.bays)).min(WIDEST_QUOIN_BAY_M));
        if lengths[1] < LEAST_QUOIN_M {
            return;
        }
        let block = QUOIN_M - JOINT_M;
        let section: &Section = &[(0.0, 0.0), (0.07, 0.02), (0.07, block - 0.02), (0.0, block)];
        // They begin above what is open down to the ground.
        let is_open = |bay: u8| is_open_to_ground(self.plan.opening(0, bay));
        let first = |bay: u8| self.levels.get(1).copied().filter(|_| is_open(bay)).unwrap_or(self.front.bottom);
        let [left, right] = [first(0), first(self.plan.bays - 1)];
        for i in 0..count {
            let (reach, foot) = (lengths[i % 2], self.front.bottom + i as f64 * QUOIN_M);
            let sides = [(left, (0.0, reach), [ends[0], End::Square]), (right, (length - reach, length), [End::Square, ends[1]])];
            for (first, (from, to), ends) in sides {
                if let Some(edge) = self.stretch(from, to).filter(|_| foot >= first - 0.01) {
                    sweep(&edge, ends, section, foot, self.trim, mesh);
                }
            }
        }
    }

    fn oriel(&self, oriel: Oriel, mesh: &mut MeshData) {
        let Some((low, high)) = self.span(oriel.storeys).filter(|_| oriel.bay < self.plan.bays) else { return };
        let (from, to) = (self.bay_m(oriel.bay), self.bay_m(oriel.bay + 1));
        let (middle, half) = ((from + to) / 2.0, ((to - from) * ORIEL_SHARE).min(ORIEL_MOST_M) / 2.0);
        let top = (high + ORIEL_ROOF_M).min(self.front.eaves - UNDER_CROWN_M);
        if half < ORIEL_SIDE_M + 0.25 || high - low < 1.5 || top < high + 0.2 {
            return;
        }
        // Four corners: on the wall, out, out, on the wall.
        let outline = |breadth: f64, out: f64| {
            let place = |along: f64, out: f64| {
                let edge = &self.front.edge;
                edge.a + edge.along * (middle + along) + edge.out * out
            };
            let front = (breadth - ORIEL_SIDE_M * out / ORIEL_OUT_M).max(0.1);
            [place(-breadth, 0.0), place(-front, out), place(front, out), place(breadth, 0.0)]
        };
        let corners = outline(half, ORIEL_OUT_M);
        let mut sides = Vec::with_capacity(3);
        for (i, pair) in corners.windows(2).enumerate() {
            let Some(edge) = Edge::new(pair[0], pair[1]) else { return };
            // Narrow windows look to the sides.
            let storey = |storey: &Storey| Storey { opening: if i == 1 { storey.opening } else { Opening::Window }, ..*storey };
            let storeys = &self.plan.storeys[usize::from(oriel.storeys.0)..=usize::from(oriel.storeys.1)];
            let wall = Wall { bays: 1, storeys: storeys.iter().map(storey).collect(), ..Wall::default() };
            let plaster = Paint::new(self.front.plaster.centre, self.volume.colour, Tile::Plaster);
            Front { edge, bottom: low, eaves: high, plaster, trade: 0 }.bays(&wall, Front::flat, mesh);
            sides.push(edge);
        }
        // Below it a corbel, above it a roof: both lean back to the wall.
        let room = if self.stands { (low - self.levels[0]) * 0.5 } else { CORBEL_M };
        let foot = low - CORBEL_M.min(room);
        let belly = outline(half * 0.86, ORIEL_OUT_M * 0.66);
        let tip = outline(half * 0.62, 0.06);
        let roof = Paint::new(self.front.plaster.centre, self.volume.roof.colour, Tile::Metal);
        let eaves = outline(half + 0.12, ORIEL_OUT_M + 0.12);
        let ridge = outline(half * 0.55, 0.0);
        let belly_y = low - (low - foot) * 0.3;
        for (below, above, low, high, paint) in [
            (&tip, &belly, foot, belly_y, self.trim),
            (&belly, &corners, belly_y, low, self.trim),
            (&eaves, &ridge, high, top, roof),
        ] {
            for i in 0..3 {
                let face = [engine(below[i], low), engine(below[i + 1], low), engine(above[i + 1], high), engine(above[i], high)];
                mesh.polygon(&face, paint);
            }
        }
        mesh.polygon(&[3, 2, 1, 0].map(|i| engine(tip[i], foot)), self.trim);
        mesh.polygon(&[3, 2, 1, 0].map(|i| engine(eaves[i], high)), self.trim);
        let floors = self.levels.iter().copied().filter(|&y| y > low + 0.1 && y < high - 0.5);
        let bands = core::iter::once(low - 0.02).chain(floors).chain([high - 0.24]);
        let section: &Section = &[(0.0, 0.0), (0.08, 0.05), (0.08, 0.18), (0.0, 0.22)];
        for y in bands {
            for (i, edge) in sides.iter().enumerate() {
                let joint = |a: usize, b: usize| {
                    let edges = sides.get(a).zip(sides.get(b));
                    edges.and_then(|(a, b)| mitre(a, b)).map_or(End::Square, End::Mitre)
                };
                let ends = [if i == 0 { End::Square } else { joint(i - 1, i) }, if i == 2 { End::Square } else { joint(i, i + 1) }];
                sweep(edge, ends, section, y, self.trim, mesh);
            }
        }
    }

    fn balconies(&self, balconies: Balconies, mesh: &mut MeshData) {
        let (first, last) = balconies.storeys;
        let known = 1_u32.checked_shl(self.plan.bays.into()).map_or(u32::MAX, |next| next - 1);
        let balconies = Balconies { bays: balconies.bays & known, ..balconies };
        for storey in first..=last {
            let Some((floor, ceiling)) = self.span((storey, storey)) else { return };
            let is_drawn = ceiling - floor >= LEAST_STOREY_M && mesh.positions.len() <= MOST_VERTICES;
            for (from, to) in balconies.runs().filter(|_| is_drawn) {
                self.balcony((self.bay_m(from) + WITHIN_M, self.bay_m(to + 1) - WITHIN_M), floor, balconies.parapet, mesh);
            }
        }
    }

    fn balcony(&self, (from, to): (f64, f64), floor: f64, parapet: Parapet, mesh: &mut MeshData) {
        let Some(edge) = self.stretch(from, to).filter(|edge| (1.0..LONGEST_M).contains(&edge.length)) else { return };
        let stone = Paint::new(self.front.plaster.centre, self.volume.trim, Tile::Carved);
        let slab: &Section =
            &[(0.0, -SLAB_M), (BALCONY_OUT_M - 0.06, -SLAB_M), (BALCONY_OUT_M, -0.04), (BALCONY_OUT_M, 0.0), (0.0, 0.0)];
        sweep(&edge, [End::Square; 2], slab, floor, stone, mesh);
        if parapet != Parapet::Panels {
            let console: &Section = &[(0.0, -0.8), (0.2, -0.62), (0.62, -SLAB_M), (0.0, -SLAB_M)];
            for middle in [0.3, edge.length - 0.3] {
                let along = |at: f64| edge.a + edge.along * at;
                if let Some(edge) = Edge::new(along(middle - 0.11), along(middle + 0.11)) {
                    sweep(&edge, [End::Square; 2], console, floor, stone, mesh);
                }
            }
        }
        // The way that its parapet takes: out, along, and back to the wall.
        let out = edge.out * (BALCONY_OUT_M - 0.08);
        let (start, end) = (edge.a + edge.along * 0.07, edge.b - edge.along * 0.07);
        let way = [start, start + out, end + out, end];
        for pair in way.windows(2) {
            let Some(side) = Edge::new(pair[0], pair[1]) else { continue };
            let paints = (stone, Paint::new(stone.centre, IRON, Tile::Metal));
            rail(&side, floor, parapet, paints, mesh);
        }
    }

    /// A figure on a console under a canopy, before a panel.
    fn niche(&self, niche: Niche, mesh: &mut MeshData) {
        let Some((floor, ceiling)) = self.span((niche.storey, niche.storey)) else { return };
        if niche.bay == 0 || niche.bay >= self.plan.bays || ceiling - floor < 2.6 {
            return;
        }
        let middle = self.bay_m(niche.bay);
        let Some(edge) = self.stretch(middle - 0.34, middle + 0.34) else { return };
        let foot = floor + 0.75;
        let panel = Paint::new(self.front.plaster.centre, self.volume.colour.scaled(0.72), Tile::Plaster);
        let stone = Paint::new(panel.centre, SANDSTONE, Tile::Carved);
        let arch = (0..=6).map(|i| {
            let angle = core::f64::consts::PI * f64::from(i) / 6.0;
            (0.5 + 0.5 * libm::cos(angle), 1.15 + 0.3 * libm::sin(angle))
        });
        let outline = [(0.0, 0.0), (1.0, 0.0)].into_iter().chain(arch);
        let outline: Vec<_> = outline.map(|(share, y)| engine(edge.at(share) + edge.out * 0.015, foot + y)).collect();
        mesh.polygon(&outline, panel);
        sweep(&edge, [End::Square; 2], &[(0.0, -0.45), (0.14, -0.34), (0.34, -0.1), (0.34, 0.0), (0.0, 0.0)], foot, stone, mesh);
        sweep(&edge, [End::Square; 2], &[(0.0, 0.0), (0.3, 0.03), (0.3, 0.1), (0.0, 0.34)], foot + 1.5, stone, mesh);
        let plan = edge.at(0.5) + edge.out * 0.17;
        let mut sculptor = Sculptor { mesh, foot: engine(plan, foot), front: edge.out, scale: 1.0 };
        let robe = [
            (0.15, 0.0),
            (0.14, 0.2),
            (0.1, 0.6),
            (0.13, 0.82),
            (0.15, 0.94),
            (0.05, 1.04),
            (0.08, 1.13),
            (0.08, 1.22),
            (0.0, 1.3),
        ];
        sculptor.turned((0.0, 0.0), 8, &robe, stone);
        sculptor.turned((0.13, 0.06), 4, &[(0.03, 0.55), (0.045, 0.75), (0.04, 0.95)], stone);
    }
}

/// One side of a parapet.
fn rail(side: &Edge, floor: f64, parapet: Parapet, (stone, iron): (Paint, Paint), mesh: &mut MeshData) {
    let beam = |half: f64| Block { middle: side.at(0.5), along: side.along, half: DVec2::new(side.length / 2.0 + half, half) };
    let bar = |half: f64, low: f64, high: f64, paint: Paint, mesh: &mut MeshData| {
        beam(half).walls(mesh, floor + low, floor + high, paint);
        beam(half).cap(mesh, floor + high, paint);
        beam(half).floor(mesh, floor + low, paint);
    };
    let posts = |apart: f64| {
        let count = (side.length / apart).round().clamp(1.0, 200.0) as usize;
        (0..=count).map(move |i| side.at(i as f64 / count as f64))
    };
    match parapet {
        Parapet::Panels => bar(0.05, 0.0, PARAPET_M, stone, mesh),
        Parapet::Balusters => {
            bar(0.09, 0.0, 0.1, stone, mesh);
            bar(0.09, PARAPET_M - 0.14, PARAPET_M, stone, mesh);
            for middle in posts(0.26) {
                Block { middle, along: side.along, half: DVec2::splat(0.06) }.walls(
                    mesh,
                    floor + 0.1,
                    floor + PARAPET_M - 0.14,
                    stone,
                );
            }
        }
        Parapet::Iron => {
            bar(0.022, PARAPET_M - 0.05, PARAPET_M, iron, mesh);
            bar(0.016, 0.08, 0.11, iron, mesh);
            for middle in posts(0.15) {
                // Seen from both sides, thin as it is.
                let (a, b) = (middle - side.along * 0.015, middle + side.along * 0.015);
                let (low, high) = (floor, floor + PARAPET_M - 0.05);
                mesh.polygon(&[engine(a, low), engine(b, low), engine(b, high), engine(a, high)], iron);
                mesh.polygon(&[engine(b, low), engine(a, low), engine(a, high), engine(b, high)], iron);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;
    use veduta_city::{
        CellShell, FacadeSheet, Gable, GridPolygon, GridPos, HouseShell, PlanRoof, RoofShape, VolumeShell, WallKind,
    };

    use super::super::moulding::mouldings;
    use super::*;

    const EAVES_M: i32 = 14;
    const LENGTH_M: i32 = 13;

    /// A house whose first wall runs 13 m eastwards and looks south, with five bays and four storeys.
    fn cell() -> CellShell {
        let m = 1024;
        let corners = [(0, 0), (LENGTH_M * m, 0), (LENGTH_M * m, 11 * m), (0, 11 * m)].map(|(x, y)| GridPos(x, y));
        let volume = VolumeShell {
            footprint: GridPolygon::simple(corners.to_vec()),
            bottom: 0,
            eaves: EAVES_M * m,
            colour: Rgb(0xD9, 0xB3, 0x6C),
            trim: Rgb(0xEF, 0xE3, 0xC8),
            roof: PlanRoof { shape: RoofShape::Hipped, height: 4 * m, direction: 0, colour: Rgb(0xA2, 0x4B, 0x33) },
            gable: Gable::Plain,
            has_roof: true,
            walls: vec![0],
            arcades: Vec::new(),
        };
        let house = HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false };
        CellShell { houses: vec![house], ..CellShell::default() }
    }

    fn dressed(ornament: Option<Ornament>) -> MeshData {
        let storey = |height: i32| Storey { height: height * 1024, opening: Opening::FramedWindow };
        let wall = Wall {
            kind: WallKind::Street,
            bays: 5,
            storeys: [4, 4, 3, 3].map(storey).to_vec(),
            ornament: ornament.map(Box::new),
            ..Wall::default()
        };
        mouldings(&cell(), &FacadeSheet::of(vec![wall])).expect("a sheet of one wall")
    }

    /// What an ornament adds to a front: how much, and its box: metres along the wall, up, and out of it.
    fn added(ornament: Ornament) -> (usize, DVec3, DVec3) {
        let (bare, mesh) = (dressed(None), dressed(Some(ornament)));
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.positions[..bare.positions.len()], bare.positions, "mouldings come first");
        let new = mesh.positions[bare.positions.len()..].iter().map(|p| DVec3::from_array(p.map(f64::from)));
        let (low, high) = new.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        (mesh.triangle_count() - bare.triangle_count(), low, high)
    }

    fn oriel(bay: u8, storeys: (u8, u8)) -> Ornament {
        Ornament { oriel: Some(Oriel { bay, storeys }), ..Ornament::default() }
    }

    fn balconies(bays: u32, storeys: (u8, u8), parapet: Parapet) -> Ornament {
        Ornament { balconies: Some(Balconies { bays, storeys, parapet }), ..Ornament::default() }
    }

    #[test]
    fn an_oriel_stands_out_of_its_bay_between_its_storeys() {
        let (count, low, high) = added(oriel(2, (1, 2)));
        assert!(count > 30, "{count}");
        let bay = f64::from(LENGTH_M) / 5.0;
        assert!(low.x > 2.0 * bay - 0.1 && high.x < 3.0 * bay + 0.1, "{low} {high}");
        // From a corbel in the upper half of the ground floor to a roof below the eaves.
        assert!(low.y > 2.0 && low.y < 4.0 && high.y > 11.0 && high.y < f64::from(EAVES_M), "{low} {high}");
        assert!(low.z > -1e-3 && high.z > ORIEL_OUT_M && high.z < 1.1, "{low} {high}");
    }

    #[test]
    fn balconies_hang_before_their_bays_at_their_floors() {
        for parapet in [Parapet::Balusters, Parapet::Iron, Parapet::Panels] {
            let (one, low, high) = added(balconies(0b00010, (2, 2), parapet));
            let bay = f64::from(LENGTH_M) / 5.0;
            assert!(low.x > bay && high.x < 2.0 * bay, "{low} {high}");
            assert!(low.y > 7.0 && (high.y - 9.0).abs() < 0.01 && high.z > 0.9 && high.z < 1.1, "{low} {high}");
            // Two apart, on two floors; two neighbouring bays share one.
            assert_eq!(added(balconies(0b01010, (2, 3), parapet)).0, 4 * one);
            let (joined, ..) = added(balconies(0b00110, (2, 2), parapet));
            assert!(joined < 2 * one && (parapet == Parapet::Panels || joined > one), "{joined} for {one}");
        }
    }

    #[test]
    fn pilasters_stand_at_every_bay_from_the_string_course_to_the_cornice() {
        let pilasters = Ornament { articulation: Articulation::Pilasters, ..Ornament::default() };
        let (count, low, high) = added(pilasters);
        assert!(count > 60 && count.is_multiple_of(6), "six alike: {count}");
        assert!(low.x < 0.3 && high.x > f64::from(LENGTH_M) - 0.3, "from corner to corner: {low} {high}");
        assert!(low.x > 0.0 && high.x < f64::from(LENGTH_M) && low.y > 4.0 && high.y < f64::from(EAVES_M), "{low} {high}");
        let with_oriel = added(Ornament { articulation: Articulation::Pilasters, ..oriel(2, (1, 2)) }).0;
        assert_eq!(with_oriel - added(oriel(2, (1, 2))).0, count / 6 * 4, "none beside an oriel");
        let (count, low, high) = added(Ornament { articulation: Articulation::Quoins, ..Ornament::default() });
        assert!(count > 200 && low.y < 0.1 && low.x > -0.01 && high.y > 13.0 && high.z < 0.1, "{count}: {low} {high}");
    }

    #[test]
    fn a_statue_stands_before_its_pier() {
        let (count, low, high) = added(Ornament { niche: Some(Niche { bay: 2, storey: 1 }), ..Ornament::default() });
        let pier = 2.0 * f64::from(LENGTH_M) / 5.0;
        assert!(count > 60 && ((low.x + high.x) / 2.0 - pier).abs() < 0.02, "{count}: {low} {high}");
        assert!(low.y > 4.0 && high.y < 8.0 && high.z < 0.4, "{low} {high}");
    }

    #[test]
    fn what_a_wall_does_not_have_is_not_drawn() {
        for ornament in [
            oriel(5, (1, 1)),
            oriel(2, (1, 4)),
            oriel(2, (1, 3)),
            oriel(2, (2, 1)),
            balconies(1 << 5, (1, 1), Parapet::Iron),
            balconies(1, (4, 200), Parapet::Iron),
            Ornament { niche: Some(Niche { bay: 0, storey: 1 }), ..Ornament::default() },
            Ornament { niche: Some(Niche { bay: 2, storey: 4 }), ..Ornament::default() },
        ] {
            assert_eq!(dressed(Some(ornament)), dressed(None), "{ornament:?}");
        }
    }

    #[test]
    fn a_packet_cannot_claim_the_memory() {
        // Walls of a kilometre and a thousand storeys, told once and listed two thousand times.
        let mut shell = cell();
        let volume = &mut shell.houses[0].volumes[0];
        volume.footprint.outer[1].0 = 1_024_000;
        (volume.eaves, volume.walls) = (1_024_000, vec![0; 2_000]);
        let balconies = Balconies { bays: 0x5555_5555, storeys: (0, 255), parapet: Parapet::Iron };
        let wall = Wall {
            kind: WallKind::Street,
            bays: 32,
            storeys: vec![Storey { height: 1024, opening: Opening::Window }; 1000],
            ornament: Some(Box::new(Ornament { balconies: Some(balconies), ..Ornament::default() })),
            ..Wall::default()
        };
        let mesh = mouldings(&shell, &FacadeSheet::of(vec![wall; 2_000])).expect("a sheet of the walls");
        assert!(mesh.positions.len() < 2 * MOST_VERTICES, "{}", mesh.positions.len());
    }

    proptest! {
        #[test]
        fn whatever_a_packet_tells_the_mesh_is_sound(
            bays in any::<u8>(),
            heights in prop::collection::vec(-3000..9000_i32, 0..6),
            oriel in any::<(u8, (u8, u8))>(),
            (bits, storeys) in any::<(u32, (u8, u8))>(),
            niche in any::<(u8, u8)>(),
            kind in 0..3_usize,
        ) {
            let small = |n: u8| n % 8;
            let ornament = Ornament {
                articulation: [Articulation::Plain, Articulation::Quoins, Articulation::Pilasters][kind],
                oriel: Some(Oriel { bay: small(oriel.0), storeys: (small(oriel.1.0), small(oriel.1.1)) }),
                balconies: Some(Balconies { bays: bits, storeys, parapet: [Parapet::Balusters, Parapet::Iron, Parapet::Panels][kind] }),
                niche: Some(Niche { bay: small(niche.0), storey: small(niche.1) }),
            };
            let wall = Wall {
                kind: WallKind::Street,
                bays,
                storeys: heights.into_iter().map(|height| Storey { height, opening: Opening::Window }).collect(),
                ornament: Some(Box::new(ornament)),
                ..Wall::default()
            };
            let mesh = mouldings(&cell(), &FacadeSheet::of(vec![wall])).expect("a sheet of one wall");
            prop_assert_eq!(mesh.validate(), Ok(()));
            for p in &mesh.positions {
                prop_assert!(p[0] > -1.0 && p[0] < 14.0 && p[1] > -1.5 && p[1] < 16.0 && p[2] > -0.01 && p[2] < 1.3, "{:?}", p);
            }
        }
    }
}
