//! Below the ground: ramps between retaining walls, bores with their vaults, and portals.

use glam::{DVec2, DVec3};
use veduta_city::{BoreEnd, Rgb, SurfaceKind, Tile, metres};

use super::bridge::Deck;
use super::data::{MeshData, Paint, newell};
use super::drape::Drape;
use super::outline::engine;

/// Retaining walls are so thick, stand so high above the ground, and reach so far below the way; metres.
pub(crate) const WALL_M: f64 = 0.4;
const PARAPET_M: f64 = 1.0;
const DEEP_M: f64 = 0.5;
/// The ground is looked at so far along a wall from each station, more than half the way to the next; metres.
const NEAR_M: f64 = 4.0;
/// How far copings reach beyond walls, and their height; metres.
const COPING_M: (f64, f64) = (0.06, 0.16);
/// A vault rises by this share of its height, at most by half its breadth; its pieces.
const RISE: f64 = 0.45;
const PIECES: u32 = 12;
/// Height of the stones about a portal's arch, and how far they stand out; metres.
const VOUSSOIR_M: (f64, f64) = (0.5, 0.06);
/// A portal reaches so far beyond the walls before it, and the wall above it begins so far above its crown; metres.
const BESIDE_M: f64 = 0.6;
const ABOVE_M: f64 = 0.25;
/// Distance of lamps under a crown, and their length, breadth and height; metres.
const LAMP_STEP_M: f64 = 9.0;
const LAMP_M: [f64; 3] = [1.2, 0.3, 0.08];

/// Daylight reaches so far into a bore, metres, and beyond that things are so bright.
const DAYLIGHT_M: f64 = 12.0;
const DARKEST: f64 = 0.45;

const GRANITE: Rgb = Rgb(0xB0, 0xAA, 0x9E);
const VOUSSOIRS: Rgb = Rgb(0xD6, 0xCF, 0xC0);
const LINING: Rgb = Rgb(0x9C, 0x99, 0x92);
const BRICK: Rgb = Rgb(0x8A, 0x6A, 0x58);
const LAMPS: Rgb = Rgb(0xFF, 0xF4, 0xD6);

/// A vault's cross-section: places from the foot of its left wall over its crown to the foot of the right one. How far to the left, as a
/// share of half its breadth, and how high above the way, metres.
struct Vault(Vec<(f64, f64)>);

impl Vault {
    fn of(deck: &Deck<'_>, crown: f64) -> Self {
        let rise = (crown * RISE).min(deck.half_m);
        let arc = (0..=PIECES).map(|i| {
            let angle = core::f64::consts::PI * f64::from(i) / f64::from(PIECES);
            (libm::cos(angle), crown - rise + rise * libm::sin(angle))
        });
        let foot = |x: f64| (x, -DEEP_M);
        Self(core::iter::once(foot(1.0)).chain(arc).chain([foot(-1.0)]).collect())
    }
}

impl Deck<'_> {
    /// The walls of a ramp, and what closes the ground at its ends.
    pub(super) fn ramp(&self, drape: &Drape<'_>, mesh: &mut MeshData) {
        let (wall, coping) = (self.paint(GRANITE, Tile::Stone), self.paint(VOUSSOIRS, Tile::Stone));
        let (left, right) = self.span.parapets;
        for side in [(1.0, left), (-1.0, right)].into_iter().filter_map(|(side, is_there)| is_there.then_some(side)) {
            let tops = self.tops(side, drape);
            let place = |i: usize, out: f64, y: f64| self.at(self.lengths[i], side, side * out, y);
            let feet = self.feet(side, drape);
            let mut face = |corners: [DVec3; 4], out: DVec2| turned(corners, engine(out, 0.0), wall, mesh);
            for i in 1..self.lengths.len() {
                let (a, b) = (i - 1, i);
                let across = self.across(self.lengths[a]) * side;
                for (out, normal) in [(0.0, -across), (WALL_M, across)] {
                    face([place(a, out, feet[a]), place(b, out, feet[b]), place(b, out, tops[b]), place(a, out, tops[a])], normal);
                }
            }
            let last = self.lengths.len() - 1;
            for (i, way) in [(0, -self.along(0.0)), (last, self.along(self.length_m()))] {
                face([place(i, 0.0, feet[i]), place(i, WALL_M, feet[i]), place(i, WALL_M, tops[i]), place(i, 0.0, tops[i])], way);
            }
            self.coping(side, &tops, coping, mesh);
        }
        // Where the ground ends it is seen from the side.
        for s in [0.0, self.length_m()] {
            let corner = |side: f64, down: f64| self.at(s, side, side * WALL_M, self.y(s) - down);
            let sill = [corner(-1.0, DEEP_M), corner(1.0, DEEP_M), corner(1.0, 0.0), corner(-1.0, 0.0)];
            for way in [self.along(s), -self.along(s)] {
                turned(sill, engine(way, 0.0), wall, mesh);
            }
        }
    }

    /// How high a retaining wall's top is at each station, above the city's zero: so far above all ground about.
    fn tops(&self, side: f64, drape: &Drape<'_>) -> Vec<f64> {
        self.beside(side, f64::max, |a, b| drape.highest(a, b)).map(|ground| ground + PARAPET_M).collect()
    }

    /// How low its foot is: below the way, and below all ground about.
    fn feet(&self, side: f64, drape: &Drape<'_>) -> Vec<f64> {
        self.beside(side, f64::min, |a, b| drape.lowest(a, b)).map(|ground| ground - DEEP_M).collect()
    }

    /// Of the way and the ground outside of a wall, the highest or lowest about each station: the same for both spans that share it.
    fn beside(&self, side: f64, of: fn(f64, f64) -> f64, ground: impl Fn(DVec2, DVec2) -> f64) -> impl Iterator<Item = f64> {
        self.lengths.iter().zip(&self.span.stations).map(move |(&s, station)| {
            let across = (station.at(1.0) - station.at(0.0)) * side;
            let (p, ahead) = (station.at(0.0) + across * (station.half_m() + WALL_M), across.perp() * NEAR_M);
            of(self.y(s), ground(p - ahead, p + ahead))
        })
    }

    fn coping(&self, side: f64, tops: &[f64], paint: Paint, mesh: &mut MeshData) {
        let (out, high) = COPING_M;
        let ring = [(-out, 0.0), (WALL_M + out, 0.0), (WALL_M + out, high), (-out, high)];
        let place = |i: usize, (out, up): (f64, f64)| self.at(self.lengths[i], side, side * out, tops[i] + up);
        for i in 1..tops.len() {
            let across = self.across(self.lengths[i - 1]) * side;
            let normals = [DVec3::NEG_Y, engine(across, 0.0), DVec3::Y, engine(-across, 0.0)];
            for (k, normal) in normals.into_iter().enumerate() {
                let (a, b) = (ring[k], ring[(k + 1) % 4]);
                turned([place(i - 1, a), place(i, a), place(i, b), place(i - 1, b)], normal, paint, mesh);
            }
        }
        let last = tops.len() - 1;
        for (i, way) in [(0, -self.along(0.0)), (last, self.along(self.length_m()))] {
            turned(ring.map(|at| place(i, at)), engine(way, 0.0), paint, mesh);
        }
    }

    /// The lining of a bore, its lamps, and what is at its ends. What it holds was drawn from a vertex on.
    pub(super) fn bore(&self, (crown, ends): (i32, (BoreEnd, BoreEnd)), first: usize, drape: &Drape<'_>, mesh: &mut MeshData) {
        let crown = metres(crown);
        let vault = Vault::of(self, crown);
        let is_railway = self.span.surface == SurfaceKind::Ballast;
        let lining = if is_railway { self.paint(BRICK, Tile::Stone) } else { self.paint(LINING, Tile::Plaster) };
        let place = |s: f64, (x, up): (f64, f64)| self.at(s, x, 0.0, self.y(s) + up);
        for pair in self.lengths.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            for edge in vault.0.windows(2) {
                mesh.polygon(&[place(a, edge[0]), place(b, edge[0]), place(b, edge[1]), place(a, edge[1])], lining);
            }
        }
        let both = [(0.0, ends.0, self.along(0.0)), (self.length_m(), ends.1, -self.along(self.length_m()))];
        for (s, _, inward) in both.into_iter().filter(|(_, end, _)| *end == BoreEnd::Wall) {
            let mut face: Vec<DVec3> = vault.0.iter().map(|&at| place(s, at)).collect();
            if newell(&face).is_some_and(|normal| normal.dot(engine(inward, 0.0)) < 0.0) {
                face.reverse();
            }
            mesh.polygon(&face, lining);
        }
        self.darken(first, ends, mesh);
        if !is_railway {
            self.lamps(crown, mesh);
        }
        for (s, _, inward) in both.into_iter().filter(|(_, end, _)| *end == BoreEnd::Portal) {
            self.portal(s, -inward, &vault, drape, mesh);
        }
    }

    /// Darkens what was drawn from a vertex on, the farther from the portals the more: no light is looked for in there.
    fn darken(&self, first: usize, ends: (BoreEnd, BoreEnd), mesh: &mut MeshData) {
        let mouths =
            [(0.0, ends.0), (self.length_m(), ends.1)].map(|(s, end)| (end == BoreEnd::Portal).then(|| self.plan(s, 0.0, 0.0)));
        for (position, colour) in mesh.positions.iter().zip(&mut mesh.colours).skip(first) {
            let p = DVec2::new(f64::from(position[0]), -f64::from(position[2]));
            let far = mouths.iter().flatten().map(|mouth| p.distance(*mouth)).fold(DAYLIGHT_M, f64::min);
            let shade = 1.0 - (1.0 - DARKEST) * far / DAYLIGHT_M;
            colour[..3].iter_mut().for_each(|channel| *channel *= shade as f32);
        }
    }

    fn lamps(&self, crown: f64, mesh: &mut MeshData) {
        let paint = self.paint(LAMPS, Tile::Plaster);
        let [long, broad, high] = LAMP_M;
        let count = (self.length_m() / LAMP_STEP_M).floor() as u32;
        for i in 0..count {
            let s = self.length_m() * (f64::from(i) + 0.5) / f64::from(count);
            let (p, way) = (self.plan(s, 0.0, 0.0), self.along(s));
            let top = self.y(s) + crown;
            let frame = Frame { foot: p, across: way.perp(), out: way };
            frame.block((-broad / 2.0, broad / 2.0), (top - 2.0 * high, top), (-long / 2.0, long / 2.0), paint, mesh);
        }
    }

    /// The wall about the mouth of a bore, with a parapet above.
    fn portal(&self, s: f64, out: DVec2, vault: &Vault, drape: &Drape<'_>, mesh: &mut MeshData) {
        let (wall, stones) = (self.paint(GRANITE, Tile::Stone), self.paint(VOUSSOIRS, Tile::Stone));
        let frame = Frame { foot: self.plan(s, 0.0, 0.0), across: self.across(s), out };
        let half = self.half_at(s);
        let (side, y) = (half + WALL_M + BESIDE_M, self.y(s));
        let crown = vault.0.iter().fold(0.0, |crown: f64, at| crown.max(at.1));
        let ground = drape.highest(frame.place(-side, 0.0), frame.place(side, 0.0));
        let (above, top) = (y + crown + ABOVE_M, ground.max(y + crown + ABOVE_M) + PARAPET_M);
        let normal = engine(out, 0.0);
        for edge in vault.0.windows(2) {
            let [a, b] = [edge[0], edge[1]].map(|(x, up)| (x * half, y + up));
            let face = |[low, high]: [f64; 2], out: f64| {
                [(a.0, a.1 + low, out), (b.0, b.1 + low, out), (b.0, b.1 + high, out), (a.0, a.1 + high, out)]
            };
            // The feet are upright: beside them stands the rest of the wall.
            if a.0 == b.0 {
                continue;
            }
            turned([(a.0, a.1), (b.0, b.1), (b.0, above), (a.0, above)].map(|(x, y)| frame.at(x, y, 0.0)), normal, wall, mesh);
            let (high, stand) = VOUSSOIR_M;
            let high = high.min(above - a.1.max(b.1));
            turned(face([0.0, high], stand).map(|(x, y, out)| frame.at(x, y, out)), normal, stones, mesh);
            for (up, seen) in [(0.0, DVec3::NEG_Y), (high, DVec3::Y)] {
                let edge = [(a.0, a.1 + up, 0.0), (b.0, b.1 + up, 0.0), (b.0, b.1 + up, stand), (a.0, a.1 + up, stand)];
                turned(edge.map(|(x, y, out)| frame.at(x, y, out)), seen, stones, mesh);
            }
        }
        for x in [(-side, -half), (half, side)] {
            let corners = [(x.0, y - DEEP_M), (x.1, y - DEEP_M), (x.1, above), (x.0, above)];
            turned(corners.map(|(x, y)| frame.at(x, y, 0.0)), normal, wall, mesh);
        }
        frame.block((-side, side), (above, top), (-WALL_M, 0.0), wall, mesh);
        let (beyond, high) = COPING_M;
        frame.block((-side - beyond, side + beyond), (top, top + high), (-WALL_M - beyond, beyond), stones, mesh);
    }

    /// Unit vectors in plan at a distance along the span: along it, and to the left.
    fn along(&self, s: f64) -> DVec2 {
        -self.across(s).perp()
    }

    fn across(&self, s: f64) -> DVec2 {
        (self.plan(s, 1.0, 0.0) - self.plan(s, -1.0, 0.0)).normalize_or_zero()
    }

    fn half_at(&self, s: f64) -> f64 {
        self.plan(s, 1.0, 0.0).distance(self.plan(s, -1.0, 0.0)) / 2.0
    }
}

/// A place in plan with two directions, as unit vectors.
struct Frame {
    foot: DVec2,
    across: DVec2,
    out: DVec2,
}

impl Frame {
    fn place(&self, across: f64, out: f64) -> DVec2 {
        self.foot + self.across * across + self.out * out
    }

    fn at(&self, across: f64, y: f64, out: f64) -> DVec3 {
        engine(self.place(across, out), y)
    }

    /// A block between distances across, heights above the city's zero, and distances outwards.
    fn block(&self, x: (f64, f64), y: (f64, f64), out: (f64, f64), paint: Paint, mesh: &mut MeshData) {
        let (across, ahead) = (engine(self.across, 0.0), engine(self.out, 0.0));
        for (y, normal) in [(y.0, DVec3::NEG_Y), (y.1, DVec3::Y)] {
            turned(
                [(x.0, out.0), (x.1, out.0), (x.1, out.1), (x.0, out.1)].map(|(x, out)| self.at(x, y, out)),
                normal,
                paint,
                mesh,
            );
        }
        for (x, normal) in [(x.0, -across), (x.1, across)] {
            turned(
                [(y.0, out.0), (y.1, out.0), (y.1, out.1), (y.0, out.1)].map(|(y, out)| self.at(x, y, out)),
                normal,
                paint,
                mesh,
            );
        }
        for (out, normal) in [(out.0, -ahead), (out.1, ahead)] {
            turned([(x.0, y.0), (x.1, y.0), (x.1, y.1), (x.0, y.1)].map(|(x, y)| self.at(x, y, out)), normal, paint, mesh);
        }
    }
}

/// A face whose normal lies on the side of another.
fn turned(mut corners: [DVec3; 4], seen_from: DVec3, paint: Paint, mesh: &mut MeshData) {
    if newell(&corners).is_some_and(|normal| normal.dot(seen_from) < 0.0) {
        corners.reverse();
    }
    mesh.polygon(&corners, paint);
}
