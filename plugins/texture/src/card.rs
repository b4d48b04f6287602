//! Cards: pictures of trees, taken of the very bodies that are seen near by.
//!
//! ```text
//!  tree::build ──► triangles ──► from the front, from half above, from above ──► rims frayed into leaves ──► mips that keep trunks
//! ```

use glam::{DVec3, Vec2, Vec3};
use veduta_city::draw::Draw;
use veduta_city::tree::{self, Skin, TreeBuilder, TreeCard};
use veduta_city::{ObjectKind, Season};

use crate::canvas::Texel;
use crate::mips::{Encoder, share, signed};
use crate::noise::{Fractal, Pebbles, floor, mix, smoothstep, word};

/// A pixel is looked at in so many places across and down, while the layer is no larger than so many pixels: larger ones have enough.
const SAMPLES: usize = 2;
const FINE: u32 = 256;
/// Meridians and parallels of a lump, and sides of a bough.
const LUMP: (usize, usize) = (28, 16);
const BOUGH: usize = 5;
/// From so many trees the one is chosen that is shown.
const TREES: u64 = 9;
/// Boughs and trunks are at least so thick, as a share of the card's height: what no pixel holds would vanish.
const LEAST_TWIG: f64 = 0.0025;
const LEAST_TRUNK: f64 = 0.014;
/// Lumps are larger by so much, for what is frayed of them.
const FRAYED: f64 = 1.07;
/// On smaller pictures trunks are no longer told from crowns, pixels.
const LEAST_SIDE: usize = 16;
/// What covers less of a row of pixels is too thin to be a trunk.
const LEAST_COVER: f32 = 0.15;
/// Pictures go on so far beyond their edges, as a share of the layer.
const BEYOND: f64 = 1.0 / 128.0;
/// Patterns repeat after so many metres.
const PATTERN_M: f32 = 4.0;

/// A pixel of a card.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dot {
    /// The parts of its colour that stand as they are and that are tinted: see [`Texel`]. Meaningless where nothing covers it.
    own: Vec3,
    tint: Vec3,
    /// Towards the viewer; shorter where averaged.
    normal: Vec3,
    /// Share that is covered.
    cover: f32,
}

const NOTHING: Dot = Dot { own: Vec3::ZERO, tint: Vec3::ZERO, normal: Vec3::ZERO, cover: 0.0 };

impl Dot {
    /// The mean, each in proportion to what it covers.
    fn mean(dots: &[Self]) -> Self {
        let cover: f32 = dots.iter().map(|dot| dot.cover).sum();
        if cover <= 0.0 {
            return NOTHING;
        }
        let sum = |of: fn(&Self) -> Vec3| dots.iter().map(|dot| of(dot) * dot.cover).sum::<Vec3>() / cover;
        let cover_a_dot = cover / dots.len() as f32;
        Self { own: sum(|dot| dot.own), tint: sum(|dot| dot.tint), normal: sum(|dot| dot.normal), cover: cover_a_dot }
    }

    /// Colour, and normal with the cover, in bytes.
    pub(crate) fn bytes(&self, encoder: &Encoder) -> [[u8; 4]; 2] {
        let n = self.normal.normalize_or(Vec3::Z);
        let texel = Texel { tint: self.tint, ..Texel::solid(self.own, 0.0) };
        [encoder.colour(&texel), [signed(n.x), signed(n.y), signed(n.y), share(self.cover)]]
    }
}

/// A card and its smaller selves.
pub(crate) struct Card {
    /// From the largest down to one pixel, rows from the top.
    pub(crate) mips: Vec<Vec<Dot>>,
}

impl Card {
    /// A tree in leaf, or bare.
    pub(crate) fn of_tree(kind: ObjectKind, is_bare: bool, size: u32, draw: Draw, leaf: &Leaf) -> Self {
        let draw = Bodies::typical(kind, draw);
        let bodies = Bodies::of(kind, if is_bare { Season::Winter } else { Season::Summer }, draw);
        let (n, samples_a_pixel) = (size as usize, if size > FINE { 1 } else { SAMPLES });
        let fine = n * samples_a_pixel;
        let mut samples = vec![NOTHING; fine * fine];
        let card = TreeCard::of(kind);
        let (half, height) = (card.half_m as f32, card.height_m as f32);
        // From the front, from half above and from above, turned so that the viewer looks along −z.
        let side = View::new(TreeCard::SIDE, [(-half, half), (height, 0.0)], |p| p);
        bodies.take(&mut samples, fine, leaf, &side);
        let (sin, cos) = (libm::sin(TreeCard::LEAN) as f32, libm::cos(TreeCard::LEAN) as f32);
        let (middle, reach) = (height / 2.0 * cos, card.slant_m() as f32 / 2.0);
        let slant = View::new(TreeCard::SLANT, [(-half, half), (middle + reach, middle - reach)], |p| {
            Vec3::new(p.x, p.y * cos - p.z * sin, p.y * sin + p.z * cos)
        });
        bodies.take(&mut samples, fine, leaf, &slant);
        let top = View::new(TreeCard::TOP, [(-half, half), (half, -half)], |p| Vec3::new(p.x, -p.z, p.y));
        bodies.take(&mut samples, fine, leaf, &top);
        Self::with_mips(if fine > n { halved(fine, &samples) } else { samples }, n)
    }

    fn with_mips(largest: Vec<Dot>, size: usize) -> Self {
        let mut mips = vec![largest];
        let mut side = size;
        while side > 1 {
            mips.push(halved(side, &mips[mips.len() - 1]));
            side /= 2;
        }
        for (i, mip) in mips.iter_mut().enumerate().skip(1).take_while(|(i, _)| size >> i >= LEAST_SIDE) {
            mip.chunks_exact_mut((size >> i) / 2).for_each(keep_trunk);
        }
        // What is not covered takes its colour from the next smaller picture, so that nothing bleeds into edges.
        for i in (0..mips.len() - 1).rev() {
            let (larger, smaller) = mips.split_at_mut(i + 1);
            let side = size >> i;
            for (at, dot) in larger[i].iter_mut().enumerate().filter(|(_, dot)| dot.cover <= 0.0) {
                let under = smaller[0][(at / side / 2) * (side / 2).max(1) + (at % side) / 2];
                (dot.own, dot.tint, dot.normal) = (under.own, under.tint, under.normal);
            }
        }
        Self { mips }
    }
}

fn halved(side: usize, from: &[Dot]) -> Vec<Dot> {
    crate::mips::halve(side, from, |four| Dot::mean(&four))
}

/// Where half a row is covered by one thing that is thinner than two pixels, that covers a whole one: thinned out, a trunk would be
/// but dots.
fn keep_trunk(row: &mut [Dot]) {
    let sum: f32 = row.iter().map(|dot| dot.cover).sum();
    let Some(i) = (0..row.len()).max_by(|&i, &k| row[i].cover.total_cmp(&row[k].cover)) else { return };
    let beside = |k: usize| row.get(k).map_or(0.0, |dot| dot.cover);
    let k = if beside(i.wrapping_sub(1)) > beside(i + 1) { i - 1 } else { i + 1 };
    if (LEAST_COVER..2.0).contains(&sum) && row[i].cover + beside(k) > 0.9 * sum {
        row[i].cover = 1.0;
        if let Some(dot) = row.get_mut(k) {
            dot.cover = (sum - 1.0).max(0.0);
        }
    }
}

/// The pattern of leaves, the same on every card: how bright they are at a place, about 1, and how far they stand out there, about −1
/// to 1.
pub(crate) struct Leaf(Vec<(f32, f32)>);

impl Leaf {
    /// Places of the pattern, across and down.
    const SIDE: i32 = 192;

    pub(crate) fn new(draw: Draw) -> Self {
        let clumps = [Pebbles::new(draw.bits("clumps a"), 15, 15, 0.95), Pebbles::new(draw.bits("clumps b"), 26, 26, 0.95)];
        let frays = Fractal::new(draw.bits("frays"), 11, 11, 3, 0.7);
        let at = |u: f32, v: f32| {
            let fray = frays.at(u, v);
            let [large, small] = [0, 1].map(|i: usize| clumps[i].at(u + 0.02 * fray, v + 0.013 * fray));
            let [round, dot] = [&large, &small].map(|clump| smoothstep(0.8, 0.1, clump.near));
            let light = mix(0.62, 1.14, 0.55 * round + 0.45 * dot) * (0.88 + 0.24 * word(small.bits, 0));
            let high = 0.2 * (large.offset.1 + small.offset.1);
            (light * (1.0 + high), (1.2 * round + 0.8 * dot - 1.0) * 0.7 + 0.5 * fray)
        };
        let share = |i: i32| (i as f32 + 0.5) / Self::SIDE as f32;
        Self((0..Self::SIDE * Self::SIDE).map(|i| at(share(i % Self::SIDE), share(i / Self::SIDE))).collect())
    }

    fn at(&self, p: Vec2) -> (f32, f32) {
        let [x, y] = (p * (Self::SIDE as f32 / PATTERN_M)).to_array().map(|at| floor(at).rem_euclid(Self::SIDE));
        self.0[(y * Self::SIDE + x) as usize]
    }
}

/// A corner of a triangle.
#[derive(Clone, Copy)]
struct Corner {
    place: Vec3,
    normal: Vec3,
    /// Where on a ball it would lie: near the rim for who looks across it.
    round: Vec3,
}

impl Corner {
    fn new(place: DVec3, normal: DVec3) -> Self {
        Self { place: place.as_vec3(), normal: normal.as_vec3(), round: normal.as_vec3() }
    }
}

/// A tree as triangles.
struct Bodies {
    triangles: Vec<([Corner; 3], Skin, bool)>,
    height_m: f64,
}

/// Where on its layer a picture lies, what of the tree it shows, and how that is turned to be looked at along −z.
struct View<F> {
    layer: [(f64, f64); 2],
    shown: [(f32, f32); 2],
    turn: F,
}

impl<F: Fn(Vec3) -> Vec3> View<F> {
    fn new(layer: [(f64, f64); 2], shown: [(f32, f32); 2], turn: F) -> Self {
        Self { layer, shown, turn }
    }

    /// Pixels a metre, and the pixel of the origin, along u and v.
    fn scale(&self, fine: usize) -> (Vec2, Vec2) {
        let along = |i: usize| {
            let ((from, to), (first, last)) = (self.layer[i], self.shown[i]);
            let scale = (to - from) as f32 * fine as f32 / (last - first);
            (scale, from as f32 * fine as f32 - first * scale)
        };
        let ((x, x0), (y, y0)) = (along(0), along(1));
        (Vec2::new(x, y), Vec2::new(x0, y0))
    }
}

impl Bodies {
    fn of(kind: ObjectKind, season: Season, draw: Draw) -> Self {
        let mut bodies = Self { triangles: Vec::new(), height_m: TreeCard::of(kind).height_m };
        tree::build(kind, season, draw, &mut bodies);
        bodies
    }

    /// Of some trees in leaf, the one that is nearest to being as broad from the front, and as high, as is usual.
    fn typical(kind: ObjectKind, draw: Draw) -> Draw {
        let size = |draw: Draw| {
            let bodies = Self::of(kind, Season::Summer, draw);
            let places = || bodies.triangles.iter().flat_map(|(corners, ..)| corners).map(|corner| corner.place);
            places().fold(Vec3::MIN, Vec3::max) - places().fold(Vec3::MAX, Vec3::min)
        };
        let trees: Vec<(Draw, Vec3)> = (0..TREES).map(|i| draw.part(i)).map(|draw| (draw, size(draw))).collect();
        let usual = trees.iter().map(|(_, size)| *size).sum::<Vec3>() / trees.len() as f32;
        let off = |size: Vec3| (size / usual - 1.0).abs().truncate().element_sum();
        trees.iter().min_by(|a, b| off(a.1).total_cmp(&off(b.1))).map_or(draw, |tree| tree.0)
    }

    /// A net of corners, row by row, as triangles; rows end where they begin.
    fn net(&mut self, rows: &[Vec<Corner>], skin: Skin, is_round: bool) {
        for pair in rows.windows(2) {
            for i in 0..pair[0].len() - 1 {
                let (a, b, c, d) = (pair[0][i], pair[0][i + 1], pair[1][i + 1], pair[1][i]);
                self.triangles.extend([([a, b, c], skin, is_round), ([a, c, d], skin, is_round)]);
            }
        }
    }

    /// Draws what is nearest into the samples of a layer.
    fn take<F: Fn(Vec3) -> Vec3>(&self, samples: &mut [Dot], fine: usize, leaf: &Leaf, view: &View<F>) {
        let (scale, origin) = view.scale(fine);
        let mut depths = vec![f32::NEG_INFINITY; samples.len()];
        // Somewhat beyond the picture, for the sake of what is blended at its foot.
        let within = |i: usize, (low, high): (f32, f32)| -> (usize, usize) {
            let edge = |at: f64| (at * fine as f64) as usize;
            let (first, last) = (edge(view.layer[i].0 - BEYOND), edge(view.layer[i].1 + BEYOND));
            ((low.max(0.0) as usize).max(first), (high.max(0.0) as usize + 1).min(last))
        };
        for (corners, skin, is_round) in &self.triangles {
            let turned = corners.map(|corner| [corner.place, corner.normal, corner.round].map(&view.turn));
            let at = turned.map(|[place, ..]| place.truncate() * scale + origin);
            let area = (at[1] - at[0]).perp_dot(at[2] - at[0]);
            if area.abs() < 1e-9 {
                continue;
            }
            let [low, high] = [at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2])];
            let ((left, right), (top, bottom)) = (within(0, (low.x, high.x)), within(1, (low.y, high.y)));
            for (row, column) in (top..bottom).flat_map(|row| (left..right).map(move |column| (row, column))) {
                let p = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let share = |i: usize| (at[(i + 1) % 3] - p).perp_dot(at[(i + 2) % 3] - p) / area;
                let shares = [share(0), share(1), share(2)];
                if shares.iter().any(|&s| s < 0.0) {
                    continue;
                }
                let [place, normal, round] = [0, 1, 2].map(|k| (0..3).map(|i| turned[i][k] * shares[i]).sum::<Vec3>());
                let index = row * fine + column;
                if place.z <= depths[index] {
                    continue;
                }
                let normal = normal.normalize_or(Vec3::Z);
                let normal = if *is_round { normal } else { normal * normal.z.signum() };
                let facing = if *is_round { round.z } else { 1.0 };
                if normal.z <= 0.0 {
                    continue;
                }
                let Some(texel) = covered(*skin, place, facing, leaf) else { continue };
                depths[index] = place.z;
                samples[index] = Dot { own: texel.own, tint: texel.tint, normal, cover: 1.0 };
            }
        }
    }
}

/// What is seen at a place of a tree that faces the viewer so far, 0 to 1; `None` where its rim is frayed.
fn covered(skin: Skin, place: Vec3, facing: f32, leaf: &Leaf) -> Option<Texel> {
    match skin {
        Skin::Bark(colour) => Some(Texel::solid(Vec3::from_array(colour.to_linear()) * (0.75 + 0.25 * facing), 0.9)),
        Skin::Leaves(shade) => {
            let (light, stands_out) = leaf.at(Vec2::new(place.x + 0.3 * place.z, place.y));
            // Leaves at the rim stand apart; those that lie deeper see less of the sky, and all lie in the shade of others.
            let sky = mix(0.6, 0.97, smoothstep(-0.1, 0.8, facing));
            (facing > 0.42 - 0.4 * stands_out).then(|| Texel::tinted(shade as f32 * light * sky, 0.8))
        }
    }
}

impl TreeBuilder for Bodies {
    fn lump(&mut self, middle: DVec3, radii: DVec3, rough: f64, draw: Draw, skin: Skin) {
        let skinned = Fractal::new(draw.bits("skin"), 6, 6, 2, 0.6);
        let corner = |i: usize, j: usize| {
            let (turn, rise) = (i as f64 / LUMP.0 as f64, j as f64 / LUMP.1 as f64);
            let (angle, up) = (turn * core::f64::consts::TAU, (rise - 0.5) * core::f64::consts::PI);
            let p = DVec3::new(libm::cos(up) * libm::cos(angle), libm::sin(up), libm::cos(up) * libm::sin(angle));
            let swell = 1.0 + rough * f64::from(skinned.at(turn as f32, rise as f32)) * libm::cos(up);
            Corner { round: p.as_vec3(), ..Corner::new(middle + p * radii * (FRAYED * swell), (p / radii).normalize()) }
        };
        let rows: Vec<Vec<Corner>> = (0..=LUMP.1).map(|j| (0..=LUMP.0).map(|i| corner(i, j)).collect()).collect();
        self.net(&rows, skin, true);
    }

    fn turned(&mut self, axis: (f64, f64), sides: usize, rings: &[(f64, f64)], skin: Skin) {
        let (sides, least) = (sides * 4, self.height_m * LEAST_TRUNK);
        for pair in rings.windows(2) {
            let ((low, y0), (high, y1)) = (pair[0], pair[1]);
            let corner = |i: usize, radius: f64, y: f64| {
                let angle = core::f64::consts::TAU * i as f64 / sides as f64;
                let spoke = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
                let normal = (spoke * (y1 - y0) + DVec3::Y * (low - high)).normalize_or(spoke);
                // What stands on the ground goes on below it.
                let y = if y <= 0.0 { y - 1.0 } else { y };
                // Needles and hanging boughs end in tips.
                let radius = match skin {
                    Skin::Leaves(_) => radius * if i % 2 == 1 { 0.7 } else { 1.05 },
                    Skin::Bark(_) => radius.max(least),
                };
                Corner::new(DVec3::new(axis.0, y, axis.1) + spoke * radius, normal)
            };
            let rows = [(low, y0), (high, y1)].map(|(radius, y)| (0..=sides).map(|i| corner(i, radius, y)).collect::<Vec<_>>());
            self.net(&rows, skin, true);
        }
    }

    fn limb(&mut self, from: DVec3, to: DVec3, radii: (f64, f64), skin: Skin) {
        let Some(way) = (to - from).try_normalize() else { return };
        let x = way.cross(if way.y.abs() < 0.9 { DVec3::Y } else { DVec3::X }).normalize();
        let z = x.cross(way);
        let least = self.height_m * LEAST_TWIG;
        let row = |at: DVec3, radius: f64| -> Vec<Corner> {
            let corner = |i: usize| {
                let angle = core::f64::consts::TAU * i as f64 / BOUGH as f64;
                let spoke = x * libm::cos(angle) + z * libm::sin(angle);
                Corner::new(at + spoke * radius.max(least), spoke)
            };
            (0..=BOUGH).map(corner).collect()
        };
        let rows = [row(from, radii.0), row(to, radii.1)];
        self.net(&rows, skin, true);
    }

    fn blade(&mut self, corners: &[DVec3], skin: Skin) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(DVec3::Y);
        let corners: Vec<Corner> = corners.iter().map(|&p| Corner::new(p, normal)).collect();
        for i in 1..corners.len() - 1 {
            self.triangles.push(([corners[0], corners[i], corners[i + 1]], skin, false));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::{Id, Tile};

    /// Their z is not written down: see [`unpacked`](crate::unpacked).
    #[test]
    fn normals_of_cards_face_the_viewer() {
        let draw = |tile: Tile| Draw::new(7, Id(tile.index() as u64), "texture");
        let leaf = Leaf::new(draw(Tile::Leaves));
        for kind in ObjectKind::TREES {
            let card = Card::of_tree(kind, false, 64, draw(Tile::LeafyTree(kind)), &leaf);
            for dot in card.mips.iter().flatten().filter(|dot| dot.cover > 0.0) {
                assert!(dot.normal.normalize_or(Vec3::Z).z > -0.01, "{kind:?} shows its back: {}", dot.normal);
            }
        }
    }
}
