//! Arcades: arches between piers under a wall, and the vaulted walk behind them. See [`Arcade`].

use core::f64::consts::PI;

use glam::{DAffine3, DMat3, DVec2, DVec3};
use veduta_city::{Arcade, Rgb, SurfaceKind, Tile, VolumeShell, metres};

use super::data::{MeshData, Paint};
use super::monument::cross_vault;
use super::ornament::{MOST_VERTICES, SANDSTONE};
use super::outline::{Edge, centre_of, engine, wall_edge};
use super::shape::Block;

/// Thickness of piers and of the wall over them, and half the breadth of a pier; metres.
const THICK_M: f64 = 0.55;
const HALF_PIER_M: f64 = 0.36;
/// Most of the distance between two piers' middles that half a pier takes.
const MOST_OF_PITCH: f64 = 0.2;
/// Wall over the crown of an arch, and least height of a springing above the paving; metres.
const OVER_CROWN_M: f64 = 0.4;
const LEAST_SPRINGING_M: f64 = 1.6;
/// Chords of an arch.
const CHORDS: usize = 12;
/// Breadth of the moulding about an arch, and how far mouldings stand out; metres.
const ARCHIVOLT_M: f64 = 0.2;
const OUT_M: f64 = 0.05;
/// Heights of a pier's base and of the impost that an arch springs from; metres.
const BASE_M: f64 = 0.4;
const IMPOST_M: f64 = 0.16;
/// How far piers and paving reach below the paving's top; metres.
const FOOTING_M: f64 = 0.7;
/// How dark a walk looks from afar.
const SHADE: f64 = 0.32;

/// An arcade in metres.
pub(super) struct Walk {
    /// The part of the wall that it lies under.
    edge: Edge,
    /// Of the wall.
    centre: [f32; 2],
    arches: u32,
    pub(super) floor: f64,
    /// The foot of the wall above.
    top: f64,
    depth: f64,
}

/// The arcades under those walls of a volume that a cell draws.
pub(super) fn walks(volume: &VolumeShell) -> impl Iterator<Item = Walk> + '_ {
    let listed = volume.arcades.iter().filter(|arcade| volume.walls.binary_search(&arcade.wall).is_ok());
    listed.filter_map(|arcade| Walk::new(volume, arcade))
}

impl Walk {
    /// `None` if there is no such part of the wall, or no room under it.
    fn new(volume: &VolumeShell, arcade: &Arcade) -> Option<Self> {
        let wall = wall_edge(&volume.footprint, arcade.wall.into())?;
        let at = |steps: i32| wall.a + wall.along * metres(steps).clamp(0.0, wall.length);
        let edge = Edge::new(at(arcade.span.0), at(arcade.span.1)).filter(|edge| edge.along.dot(wall.along) > 0.0)?;
        let (floor, top) = (metres(arcade.floor), metres(volume.bottom));
        let is_high = top - floor > LEAST_SPRINGING_M + OVER_CROWN_M;
        let centre = centre_of((wall.a + wall.b) / 2.0);
        (is_high && arcade.arches > 0).then_some(Self {
            edge,
            centre,
            arches: arcade.arches.into(),
            floor,
            top,
            depth: metres(arcade.depth),
        })
    }

    fn pitch(&self) -> f64 {
        self.edge.length / f64::from(self.arches)
    }

    fn half_pier(&self) -> f64 {
        HALF_PIER_M.min(self.pitch() * MOST_OF_PITCH)
    }

    /// Where its piers begin and end, metres along it: half ones at both ends.
    fn piers(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let half = self.half_pier();
        (0..=self.arches).map(move |i| {
            let middle = f64::from(i) * self.pitch();
            ((middle - half).max(0.0), (middle + half).min(self.edge.length))
        })
    }

    /// A place so far along it and behind its plane.
    fn place(&self, along: f64, behind: f64) -> DVec2 {
        self.edge.a + self.edge.along * along - self.edge.out * behind
    }

    fn at(&self, along: f64, behind: f64, y: f64) -> DVec3 {
        engine(self.place(along, behind), y)
    }

    /// Springing and crown of its arches.
    fn arch(&self) -> (f64, f64) {
        let crown = self.top - OVER_CROWN_M;
        ((crown - self.half_opening()).max(self.floor + LEAST_SPRINGING_M), crown)
    }

    fn half_opening(&self) -> f64 {
        self.pitch() / 2.0 - self.half_pier()
    }

    /// The outlines of its piers on the ground, which nobody walks through, from a wall's start to its end.
    pub(super) fn pier_sides(&self) -> impl Iterator<Item = (Edge, f64)> + '_ {
        let sides = |(from, to): (f64, f64)| {
            let corners = [(from, 0.0), (to, 0.0), (to, THICK_M), (from, THICK_M)].map(|(along, behind)| self.place(along, behind));
            (0..4).filter_map(move |i| Edge::new(corners[i], corners[(i + 1) % 4]))
        };
        self.piers().flat_map(sides).map(|edge| (edge, self.top))
    }

    /// The corners of its paving, counter-clockwise from above; none where it has arches alone.
    pub(super) fn paving(&self) -> Option<[DVec3; 4]> {
        let corners = [(0.0, 0.0), (self.edge.length, 0.0), (self.edge.length, self.depth), (0.0, self.depth)];
        (self.depth > 0.0).then(|| corners.map(|(along, behind)| self.at(along, behind, self.floor)))
    }

    /// A flat face of its own plane, or of one behind it, turned to the street or away from it.
    fn upright(&self, corners: &[(f64, f64)], behind: f64, paint: Paint, mesh: &mut MeshData) {
        let place = |&(along, y): &(f64, f64)| self.at(along, behind, y);
        let placed: Vec<DVec3> =
            if behind > 0.0 { corners.iter().rev().map(place).collect() } else { corners.iter().map(place).collect() };
        mesh.polygon(&placed, paint);
    }
}

/// What is seen of a volume's arcades from afar: piers, and the dark behind them.
pub(super) fn coarse(volume: &VolumeShell, mesh: &mut MeshData) {
    for walk in walks(volume) {
        if mesh.positions.len() > MOST_VERTICES {
            return;
        }
        let centre = walk.centre;
        let paint = |colour: Rgb| Paint::new(centre, colour, Tile::Plaster);
        let (wall, dark) = (paint(volume.colour), paint(volume.colour.scaled(SHADE)));
        let (springing, crown) = walk.arch();
        let (low, above) = (walk.floor - FOOTING_M, (springing + 2.0 * crown) / 3.0);
        let mut rectangle = |from: f64, to: f64, low: f64, high: f64, paint: Paint| {
            walk.upright(&[(from, low), (to, low), (to, high), (from, high)], 0.0, paint, mesh);
        };
        rectangle(0.0, walk.edge.length, above, walk.top, wall);
        let mut last = 0.0;
        for (from, to) in walk.piers() {
            if from > last {
                rectangle(last, from, low, above, dark);
            }
            rectangle(from, to, low, above, wall);
            last = to;
        }
    }
}

/// A volume's arcades with all that is seen from near by.
pub(super) fn fine(volume: &VolumeShell, mesh: &mut MeshData) {
    for walk in walks(volume) {
        if mesh.positions.len() > MOST_VERTICES {
            return;
        }
        let centre = walk.centre;
        let builder = Builder {
            walk: &walk,
            plaster: Paint::new(centre, volume.colour, Tile::Plaster),
            stone: Paint::new(centre, weathered(volume.trim), Tile::Stone),
        };
        builder.piers(mesh);
        for i in 0..walk.arches {
            builder.arch((f64::from(i) + 0.5) * walk.pitch(), mesh);
        }
        builder.ground(mesh);
    }
}

/// Sandstone under many coats of a colour.
fn weathered(Rgb(r, g, b): Rgb) -> Rgb {
    let mix = |a: u8, b: u8| ((u16::from(a) + u16::from(b)) / 2) as u8;
    Rgb(mix(r, SANDSTONE.0), mix(g, SANDSTONE.1), mix(b, SANDSTONE.2))
}

struct Builder<'a> {
    walk: &'a Walk,
    plaster: Paint,
    stone: Paint,
}

impl Builder<'_> {
    fn piers(&self, mesh: &mut MeshData) {
        let walk = self.walk;
        let (springing, _) = walk.arch();
        for (from, to) in walk.piers() {
            let block = |reach: f64| {
                let half = DVec2::new((to - from) / 2.0 + reach, THICK_M / 2.0 + reach);
                Block { middle: walk.place((from + to) / 2.0, THICK_M / 2.0), along: walk.edge.along, half }
            };
            block(0.0).walls(mesh, walk.floor - FOOTING_M, springing, self.stone);
            let base = block(OUT_M);
            base.walls(mesh, walk.floor - FOOTING_M, walk.floor + BASE_M, self.stone);
            base.cap(mesh, walk.floor + BASE_M, self.stone);
            let impost = block(OUT_M);
            impost.floor(mesh, springing - IMPOST_M, self.stone);
            impost.walls(mesh, springing - IMPOST_M, springing, self.stone);
            impost.cap(mesh, springing, self.stone);
            // The wall over it.
            for behind in [0.0, THICK_M] {
                walk.upright(&[(from, springing), (to, springing), (to, walk.top), (from, walk.top)], behind, self.plaster, mesh);
            }
        }
        // Where the row ends.
        for (along, back) in [(0.0, THICK_M), (walk.edge.length, 0.0)] {
            let front = THICK_M - back;
            let corners = [(back, springing), (front, springing), (front, walk.top), (back, walk.top)];
            mesh.polygon(&corners.map(|(behind, y)| walk.at(along, behind, y)), self.plaster);
        }
    }

    /// The arch about a place along the walk: its underside, the wall over it, its moulding and the vault behind it.
    fn arch(&self, middle: f64, mesh: &mut MeshData) {
        let walk = self.walk;
        let (springing, crown) = walk.arch();
        let (half, rise) = (walk.half_opening(), crown - springing);
        // From left to right; of an outer one, so much beyond it.
        let curve = |beyond: f64| {
            (0..=CHORDS).map(move |i| {
                let angle = PI * i as f64 / CHORDS as f64;
                (middle - (half + beyond) * libm::cos(angle), springing + (rise + beyond) * libm::sin(angle))
            })
        };
        let inner: Vec<(f64, f64)> = curve(0.0).collect();
        let outer: Vec<(f64, f64)> = curve(ARCHIVOLT_M.min(OVER_CROWN_M / 2.0)).collect();
        for (a, b) in inner.windows(2).zip(outer.windows(2)) {
            let ([a, b], [c, d]) = ([a[0], a[1]], [b[0], b[1]]);
            for behind in [0.0, THICK_M] {
                walk.upright(&[a, b, (b.0, walk.top), (a.0, walk.top)], behind, self.plaster, mesh);
            }
            let [front, back] = [-OUT_M, THICK_M];
            let ring = |(along, y): (f64, f64), behind: f64| walk.at(along, behind, y);
            mesh.polygon(&[ring(a, back), ring(b, back), ring(b, front), ring(a, front)], self.stone);
            mesh.polygon(&[ring(a, front), ring(b, front), ring(d, front), ring(c, front)], self.stone);
            mesh.polygon(&[ring(c, front), ring(d, front), ring(d, 0.0), ring(c, 0.0)], self.stone);
        }
        let deep = walk.depth - THICK_M;
        if deep > 0.5 {
            let axes = DMat3::from_cols(engine(walk.edge.along, 0.0), engine(-walk.edge.out, 0.0), DVec3::Y);
            let frame = DAffine3::from_mat3_translation(axes, walk.at(middle, THICK_M + deep / 2.0, springing));
            cross_vault(frame, [walk.pitch(), deep], rise, self.plaster, mesh);
        }
    }

    /// The paving, laid along the walk, and its edge to the street.
    fn ground(&self, mesh: &mut MeshData) {
        let walk = self.walk;
        let Some(corners) = walk.paving() else { return };
        let flags = Paint::new(self.stone.centre, Rgb(255, 255, 255), Tile::Ground(SurfaceKind::Flagstones));
        let length = walk.edge.length;
        let charted = [(0.0, 0.0), (length, 0.0), (length, walk.depth), (0.0, walk.depth)];
        mesh.polygon_as(&corners, &charted.map(|(along, behind)| engine(DVec2::new(along, behind), 0.0)), flags);
        let (low, high) = (walk.floor - FOOTING_M, walk.floor);
        walk.upright(&[(0.0, low), (length, low), (length, high), (0.0, high)], 0.0, self.stone, mesh);
        for (along, back) in [(0.0, walk.depth), (length, 0.0)] {
            let front = walk.depth - back;
            let corners = [(back, low), (front, low), (front, high), (back, high)];
            mesh.polygon(&corners.map(|(behind, y)| walk.at(along, behind, y)), self.stone);
        }
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::{Gable, GridPolygon, GridPos, PlanRoof, RoofShape};

    use super::*;

    /// A house of 12 by 10 m whose south front hangs over a walk of four arches, open to the east.
    fn volume() -> VolumeShell {
        let m = 1024;
        let footprint = GridPolygon::simple(vec![GridPos(0, 0), GridPos(12 * m, 0), GridPos(12 * m, 10 * m), GridPos(0, 10 * m)]);
        let walk = Arcade { wall: 0, span: (0, 12 * m), arches: 4, floor: 150, depth: 3686 };
        let end = Arcade { wall: 1, span: (0, 3686), arches: 1, floor: 150, depth: 0 };
        VolumeShell {
            footprint,
            bottom: 4 * m,
            eaves: 12 * m,
            colour: Rgb(0xD9, 0xB3, 0x6C),
            trim: Rgb(0xEF, 0xE3, 0xC8),
            roof: PlanRoof { shape: RoofShape::Gabled, height: 4 * m, direction: 90, colour: Rgb(0xA2, 0x4B, 0x33) },
            gable: Gable::Plain,
            has_roof: true,
            walls: vec![0, 1, 2, 3],
            arcades: vec![walk, end],
        }
    }

    fn made(make: impl Fn(&VolumeShell, &mut MeshData), volume: &VolumeShell) -> MeshData {
        let mut mesh = MeshData::default();
        make(volume, &mut mesh);
        mesh.validate().unwrap_or_else(|e| panic!("{e}"));
        mesh
    }

    /// Where a ray hits the front of a mesh first, as its distance.
    fn hit(mesh: &MeshData, from: DVec3, way: DVec3) -> Option<f64> {
        let at = |i: u32| glam::Vec3::from_array(mesh.positions[i as usize]).as_dvec3();
        let of = |t: &[u32]| {
            let (a, b, c) = (at(t[0]), at(t[1]), at(t[2]));
            let normal = (b - a).cross(c - a);
            let against = normal.dot(way);
            let far = normal.dot(a - from) / against;
            let p = from + way * far;
            let is_in = [(a, b), (b, c), (c, a)].into_iter().all(|(a, b)| (b - a).cross(p - a).dot(normal) >= 0.0);
            (against < 0.0 && far > 0.0 && is_in).then_some(far)
        };
        mesh.indices.chunks_exact(3).filter_map(of).min_by(f64::total_cmp)
    }

    #[test]
    fn one_walks_through_arches_and_not_through_piers() {
        let mesh = made(fine, &volume());
        let (level, paving) = (1.7, 150.0 / 1024.0);
        for i in 0..4 {
            let middle = 1.5 + 3.0 * f64::from(i);
            assert_eq!(hit(&mesh, DVec3::new(middle, level, 3.0), DVec3::NEG_Z), None, "arch {i} is open");
            // Above lies the vault, at its crown as high as the arch; below the paving.
            let up = hit(&mesh, DVec3::new(middle, level, -2.0), DVec3::Y).expect("a vault");
            assert!((level + up - 3.6).abs() < 0.02, "{}", level + up);
            let down = hit(&mesh, DVec3::new(middle, level, -2.0), DVec3::NEG_Y).expect("paving");
            assert!((level - down - paving).abs() < 1e-6);
        }
        for i in 0..=4 {
            let middle = (3.0 * f64::from(i)).clamp(0.2, 11.8);
            let far = hit(&mesh, DVec3::new(middle, level, 3.0), DVec3::NEG_Z).expect("a pier");
            assert!((far - 3.0).abs() < 0.06, "pier {i}: {far}");
            let back = hit(&mesh, DVec3::new(middle, level, -3.0), DVec3::Z).expect("its back");
            assert!((back - 3.0 + THICK_M).abs() < 0.06, "pier {i}: {back}");
        }
        // Along it: out of the open end, through that one's arch.
        assert_eq!(hit(&mesh, DVec3::new(6.0, level, -1.8), DVec3::X), None);
        let walls = |y: f64| hit(&mesh, DVec3::new(1.5, y, 3.0), DVec3::NEG_Z);
        assert!(walls(3.75).is_some_and(|far| (far - 3.0).abs() < 0.06), "wall over the crown");
        assert!(mesh.positions.iter().all(|p| p[1] <= 4.0 + 1e-6), "nothing reaches above the wall's foot");
    }

    #[test]
    fn from_afar_it_is_shut_and_from_within_one_sees_out() {
        let mesh = made(coarse, &volume());
        for x in 0..24 {
            let x = 0.25 + 0.5 * f64::from(x);
            for y in [0.5, 2.0, 3.9] {
                assert!(hit(&mesh, DVec3::new(x, y, 3.0), DVec3::NEG_Z).is_some(), "{x} {y}");
                assert_eq!(hit(&mesh, DVec3::new(x, y, -1.0), DVec3::Z), None, "{x} {y}");
            }
        }
        assert!(mesh.triangle_count() < 50);
    }

    #[test]
    fn walks_of_any_packet_are_drawn_or_left_out() {
        let m = 1024;
        let walks = [
            Arcade { wall: 7, span: (0, m), arches: 1, floor: 0, depth: m },
            Arcade { wall: 0, span: (5 * m, 5 * m), arches: 3, floor: 0, depth: m },
            Arcade { wall: 0, span: (-i32::MAX, i32::MAX), arches: 255, floor: 0, depth: i32::MAX },
            Arcade { wall: 0, span: (0, 9 * m), arches: 0, floor: 0, depth: m },
            Arcade { wall: 0, span: (0, 9 * m), arches: 3, floor: 4 * m, depth: m },
            Arcade { wall: 0, span: (0, 9 * m), arches: 3, floor: i32::MIN, depth: -m },
        ];
        for (i, walk) in walks.into_iter().enumerate() {
            let volume = VolumeShell { arcades: vec![walk], walls: vec![0, 1, 2, 3, 7], ..volume() };
            let drawn = (!made(coarse, &volume).is_empty(), !made(fine, &volume).is_empty());
            assert_eq!(drawn, if [2, 5].contains(&i) { (true, true) } else { (false, false) }, "{walk:?}");
        }
        let elsewhere = VolumeShell { walls: vec![2, 3], ..volume() };
        assert!(made(fine, &elsewhere).is_empty(), "another cell draws what lies under its walls");
    }
}
