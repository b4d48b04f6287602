//! The shapes of trees, by kind and season: meshes are made from them and pictures painted, so that a tree near by and the card that
//! stands for it afar are one tree.

use glam::DVec3;

use crate::draw::Draw;
use crate::{ObjectKind, Rgb, Season};

/// What a part of a tree is covered with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Skin {
    /// Bark of its own colour.
    Bark(Rgb),
    /// Leaves or needles, so many times as bright as [`leaves`] tells.
    Leaves(f64),
}

/// Puts a tree together from parts. Their frame: x right, y up, z to the front, from the foot of the tree, in metres of
/// [`nominal_m`].
pub trait TreeBuilder {
    /// A lump of foliage: an ellipsoid with an uneven skin, in and out by such a share of its radii.
    fn lump(&mut self, middle: DVec3, radii: DVec3, rough: f64, draw: Draw, skin: Skin);
    /// A body turned about an upright axis at (x, z): rings of (radius, height) from the lowest up.
    fn turned(&mut self, axis: (f64, f64), sides: usize, rings: &[(f64, f64)], skin: Skin);
    /// A bough from one place to another, with its radii at both.
    fn limb(&mut self, from: DVec3, to: DVec3, radii: (f64, f64), skin: Skin);
    /// A leaf that is seen from both sides, by its corners.
    fn blade(&mut self, corners: &[DVec3], skin: Skin);
}

/// Height that a kind is modelled in, metres; 0 for what is no tree.
#[must_use]
pub const fn nominal_m(kind: ObjectKind) -> f64 {
    match kind {
        ObjectKind::Tree => 9.0,
        ObjectKind::Conifer => 11.0,
        ObjectKind::Poplar => 11.8,
        ObjectKind::Birch => 9.6,
        ObjectKind::Willow => 7.2,
        ObjectKind::FruitTree => 4.6,
        ObjectKind::Palm => 8.2,
        _ => 0.0,
    }
}

/// What cards that stand for a tree afar show, in metres of its nominal height: upright ones a picture from the front, slanting ones a
/// picture from half above, and one the crown from above. All lie on one layer of the texture array, within [`TreeCard::SIDE`],
/// [`TreeCard::SLANT`] and [`TreeCard::TOP`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeCard {
    /// Half the width of all, and half the height of that from above.
    pub half_m: f64,
    /// Height of the upright ones.
    pub height_m: f64,
    /// How high the one from above lies.
    pub crown_m: f64,
}

impl TreeCard {
    /// Directions that upright and slanting cards look in, at even angles.
    pub const DIRECTIONS: u32 = 8;
    /// How far slanting cards lean back, radians.
    pub const LEAN: f64 = core::f64::consts::FRAC_PI_4;
    /// Kept free about the pictures, so that none shows at the edge of another; as a share of the layer.
    const MARGIN: f64 = 1.0 / 64.0;
    /// Where the upright picture lies: u from its left to its right, v from its top to its foot.
    pub const SIDE: [(f64, f64); 2] = [(Self::MARGIN, 0.5 - Self::MARGIN), (Self::MARGIN, 1.0 - Self::MARGIN)];
    /// Where the picture from above lies: u from its left to its right, v from behind to the front.
    pub const TOP: [(f64, f64); 2] = [(0.5 + Self::MARGIN, 1.0 - Self::MARGIN), (Self::MARGIN, 0.5 - Self::MARGIN)];

    /// Where the picture from half above lies, in the same way as the upright one.
    pub const SLANT: [(f64, f64); 2] = [(0.5 + Self::MARGIN, 1.0 - Self::MARGIN), (0.5 + Self::MARGIN, 1.0 - Self::MARGIN)];

    /// The cards of a kind of tree.
    #[must_use]
    pub const fn of(kind: ObjectKind) -> Self {
        let (half_m, height_m, crown_m) = match kind {
            ObjectKind::Conifer => (2.6, 11.2, 2.4),
            ObjectKind::Poplar => (1.7, 12.2, 5.5),
            ObjectKind::Birch => (2.5, 10.0, 5.6),
            ObjectKind::Willow => (3.6, 8.0, 4.6),
            ObjectKind::FruitTree => (2.15, 4.7, 3.0),
            ObjectKind::Palm => (2.95, 9.0, 7.2),
            _ => (3.7, 9.8, 5.8),
        };
        Self { half_m, height_m, crown_m }
    }

    /// Height of slanting cards along their lean. They pass through the middle of the tree, which is the middle of their picture too.
    #[must_use]
    pub fn slant_m(&self) -> f64 {
        self.height_m * libm::cos(Self::LEAN) + 2.0 * self.half_m * libm::sin(Self::LEAN)
    }
}

/// Whether a kind sheds its leaves.
#[must_use]
pub const fn sheds(kind: ObjectKind) -> bool {
    kind.is_tree() && !matches!(kind, ObjectKind::Conifer | ObjectKind::Palm)
}

/// The colour of a tree's leaves in a season; `None` when it is bare.
#[must_use]
pub fn leaves(kind: ObjectKind, season: Season, draw: Draw) -> Option<Rgb> {
    let of: &[Rgb] = match kind {
        ObjectKind::Conifer => &NEEDLES,
        ObjectKind::Palm => &FRONDS,
        _ => match season {
            Season::Spring => species(kind).leaves[0],
            Season::Summer => species(kind).leaves[1],
            Season::Autumn => species(kind).leaves[2],
            Season::Winter => return None,
        },
    };
    draw.pick("leaves", of).copied()
}

/// Puts a tree of a kind together as it is in a season; nothing of what is no tree.
pub fn build(kind: ObjectKind, season: Season, draw: Draw, into: &mut impl TreeBuilder) {
    match kind {
        ObjectKind::Conifer => conifer(draw, into),
        ObjectKind::Palm => palm(draw, into),
        _ if kind.is_tree() => broadleaved(species(kind), season == Season::Winter, draw, into),
        _ => {}
    }
}

const BARK: Rgb = Rgb(0x5F, 0x51, 0x44);
const NEEDLES: [Rgb; 1] = [Rgb(0x3E, 0x58, 0x43)];
const PALM_BARK: Rgb = Rgb(0x8A, 0x78, 0x62);
/// Greens of summer, of shrubs and hedges too.
pub const GREENS: [Rgb; 4] = [Rgb(0x6C, 0x86, 0x4A), Rgb(0x5D, 0x7A, 0x45), Rgb(0x7E, 0x93, 0x52), Rgb(0x55, 0x71, 0x48)];
const FRONDS: [Rgb; 3] = [Rgb(0x6A, 0x86, 0x48), Rgb(0x5C, 0x7A, 0x4A), Rgb(0x78, 0x8C, 0x50)];

/// A lump of a crown: how far from the trunk, at what angle about it, how high, and its half width; metres and radians.
type Lump = (f64, f64, f64, f64);

/// A broad-leaved tree in the metres of its nominal height.
struct Species {
    bark: Rgb,
    /// Rings of the trunk (radius, height), from the ground up.
    trunk: &'static [(f64, f64)],
    /// Height at which boughs leave the trunk.
    fork: f64,
    crown: &'static [Lump],
    /// Boughs that hang about it: how far from the trunk, at what angle, down to which height, and half their width.
    curtain: &'static [Lump],
    /// Height of the lumps against their width.
    tall: f64,
    /// How uneven their skin is.
    rough: f64,
    /// Colours of leaves in spring, summer and autumn: a tree has one of each.
    leaves: [&'static [Rgb]; 3],
}

const BROADLEAVED: Species = Species {
    bark: BARK,
    trunk: &[(0.3, 0.0), (0.19, 0.5), (0.15, 2.8), (0.08, 5.2)],
    fork: 2.8,
    crown: &[(0.0, 0.0, 6.9, 2.3), (1.25, 0.0, 5.6, 1.65), (1.2, 2.2, 5.1, 1.75), (1.3, 4.1, 5.9, 1.6)],
    curtain: &[],
    tall: 0.88,
    rough: 0.17,
    leaves: [
        &[Rgb(0x8E, 0xA8, 0x52), Rgb(0x82, 0x9E, 0x4E), Rgb(0x98, 0xAE, 0x5C)],
        &GREENS,
        &[Rgb(0xC0, 0x8A, 0x35), Rgb(0xA9, 0x62, 0x33), Rgb(0xB9, 0x9C, 0x45), Rgb(0x93, 0x4F, 0x35), Rgb(0x8C, 0x86, 0x44)],
    ],
};

const POPLAR: Species = Species {
    bark: Rgb(0x6C, 0x62, 0x54),
    trunk: &[(0.32, 0.0), (0.2, 0.5), (0.16, 3.0), (0.05, 9.5)],
    fork: 1.4,
    crown: &[(0.0, 0.0, 6.6, 1.2), (0.3, 0.5, 4.7, 0.95), (0.3, 3.2, 5.6, 0.95), (0.0, 0.0, 9.4, 0.62)],
    curtain: &[],
    tall: 3.6,
    rough: 0.14,
    leaves: [
        &[Rgb(0x8A, 0xA6, 0x50), Rgb(0x7E, 0x9C, 0x4E)],
        &[Rgb(0x56, 0x74, 0x44), Rgb(0x62, 0x7E, 0x48)],
        &[Rgb(0xC6, 0xA2, 0x3C), Rgb(0xB8, 0x92, 0x3A)],
    ],
};

const BIRCH: Species = Species {
    bark: Rgb(0xD4, 0xD0, 0xC6),
    trunk: &[(0.2, 0.0), (0.13, 0.4), (0.1, 4.0), (0.04, 8.6)],
    fork: 3.0,
    crown: &[(0.0, 0.0, 7.5, 1.4), (0.45, 0.6, 6.0, 1.5), (0.6, 2.9, 5.2, 1.4), (0.35, 4.9, 4.2, 1.1)],
    curtain: &[],
    tall: 1.2,
    rough: 0.24,
    leaves: [
        &[Rgb(0x9E, 0xB4, 0x5C), Rgb(0x92, 0xAC, 0x56)],
        &[Rgb(0x7C, 0x98, 0x52), Rgb(0x86, 0xA0, 0x58)],
        &[Rgb(0xD2, 0xAE, 0x42), Rgb(0xC8, 0x9E, 0x3A), Rgb(0xBE, 0xA8, 0x4C)],
    ],
};

const WILLOW: Species = Species {
    bark: Rgb(0x66, 0x5A, 0x4A),
    trunk: &[(0.46, 0.0), (0.34, 0.5), (0.28, 2.6), (0.1, 4.8)],
    fork: 2.4,
    crown: &[(0.0, 0.0, 5.6, 2.45), (0.9, 1.2, 5.2, 1.9)],
    curtain: &[
        (1.7, 0.0, 1.8, 1.2),
        (1.95, 0.9, 1.2, 1.15),
        (1.7, 1.8, 2.0, 1.2),
        (2.0, 2.7, 1.4, 1.15),
        (1.7, 3.6, 1.7, 1.2),
        (1.95, 4.5, 1.2, 1.15),
        (1.75, 5.4, 1.6, 1.2),
    ],
    tall: 0.8,
    rough: 0.2,
    leaves: [
        &[Rgb(0xA6, 0xB4, 0x5E), Rgb(0x9C, 0xAE, 0x58)],
        &[Rgb(0x80, 0x96, 0x54), Rgb(0x76, 0x90, 0x50)],
        &[Rgb(0xB6, 0xAC, 0x4E), Rgb(0xA8, 0xA2, 0x48)],
    ],
};

const FRUIT_TREE: Species = Species {
    bark: Rgb(0x58, 0x48, 0x3E),
    trunk: &[(0.17, 0.0), (0.12, 0.3), (0.1, 1.6), (0.05, 2.6)],
    fork: 1.5,
    crown: &[(0.0, 0.0, 3.6, 1.15), (0.75, 0.3, 2.9, 0.95), (0.75, 2.4, 2.7, 0.95), (0.7, 4.4, 3.0, 0.95)],
    curtain: &[],
    tall: 0.85,
    rough: 0.2,
    leaves: [
        // In blossom.
        &[Rgb(0xE6, 0xD4, 0xD2), Rgb(0xE2, 0xB8, 0xC0), Rgb(0xEA, 0xE2, 0xDA)],
        &[Rgb(0x6A, 0x84, 0x48), Rgb(0x74, 0x8C, 0x4C)],
        &[Rgb(0xB4, 0x5A, 0x36), Rgb(0xC2, 0x86, 0x3A), Rgb(0x9E, 0x46, 0x3A)],
    ],
};

/// Twigs in every lump of a bare crown.
const TWIGS: usize = 11;
/// Turn between neighbours that spreads any number of them evenly, radians.
const GOLDEN_ANGLE: f64 = 2.399_963;
/// Number of a palm's fronds.
const FRONDS_A_PALM: usize = 12;

const fn species(kind: ObjectKind) -> &'static Species {
    match kind {
        ObjectKind::Poplar => &POPLAR,
        ObjectKind::Birch => &BIRCH,
        ObjectKind::Willow => &WILLOW,
        ObjectKind::FruitTree => &FRUIT_TREE,
        _ => &BROADLEAVED,
    }
}

fn broadleaved(species: &Species, is_bare: bool, draw: Draw, into: &mut impl TreeBuilder) {
    let lean = draw.between("lean", -0.2, 0.2);
    into.turned((0.0, 0.0), 7, species.trunk, Skin::Bark(species.bark));
    let turn = draw.between("turn", 0.0, core::f64::consts::TAU);
    for (k, &(off, angle, y, radius)) in species.crown.iter().enumerate() {
        let part = draw.part(k as u64);
        let angle = angle + turn + part.between("angle", -0.4, 0.4);
        let size = radius * part.between("size", 0.88, 1.12);
        let middle = DVec3::new(off * libm::sin(angle) + lean, y + part.between("rise", -0.3, 0.3), off * libm::cos(angle));
        let radii = DVec3::new(size, size * species.tall, size);
        if is_bare {
            boughs(species, middle, radii, part, into);
        } else {
            into.lump(middle, radii, species.rough, part, Skin::Leaves(part.between("shade", 0.86, 1.1)));
        }
    }
    for (k, &(off, angle, low, half)) in species.curtain.iter().enumerate() {
        let part = draw.part(50 + k as u64);
        let angle = angle + turn + part.between("angle", -0.2, 0.2);
        let foot = DVec3::new(off * libm::sin(angle) + lean, low + part.between("low", -0.3, 0.3), off * libm::cos(angle));
        if is_bare {
            withes(species, foot, into);
        } else {
            let rings = [(0.6, foot.y), (1.0, 3.7), (0.8, 5.3), (0.0, 6.4)];
            let skin = Skin::Leaves(part.between("shade", 0.8, 1.06));
            into.turned((foot.x, foot.z), 5, &rings.map(|(share, y)| (share * half, y)), skin);
        }
    }
}

/// The bare twigs of a bough that hangs down to a place.
fn withes(species: &Species, foot: DVec3, into: &mut impl TreeBuilder) {
    let bark = Skin::Bark(species.bark.scaled(0.92));
    let fork = DVec3::new(0.0, species.fork + 1.6, 0.0);
    for aside in [-0.35, 0.05, 0.4] {
        let knee = DVec3::new(foot.x - aside * foot.z, 6.0 + aside, foot.z + aside * foot.x) * DVec3::new(0.85, 1.0, 0.85);
        into.limb(fork, knee, (0.06, 0.03), bark);
        into.limb(knee, DVec3::new(1.25 * knee.x, foot.y, 1.25 * knee.z), (0.03, 0.0), bark);
    }
}

/// A bough from the trunk into a lump of the crown, and its twigs, which end about where the leaves would.
fn boughs(species: &Species, middle: DVec3, radii: DVec3, draw: Draw, into: &mut impl TreeBuilder) {
    let bark = Skin::Bark(species.bark.scaled(0.92));
    let foot = DVec3::new(0.0, species.fork.max(middle.y - 2.2 * radii.y).min(middle.y), 0.0);
    let knee = foot.lerp(middle, 0.55) + DVec3::Y * (0.12 * radii.y);
    into.limb(foot, knee, (0.11, 0.08), bark);
    into.limb(knee, middle, (0.08, 0.05), bark);
    for i in 0..TWIGS {
        let twig = draw.part(100 + i as u64);
        // Spread evenly over the upper part of a ball.
        let up = 1.0 - 1.45 * (i as f64 + 0.5) / TWIGS as f64;
        let angle = GOLDEN_ANGLE * i as f64 + twig.between("turn", -0.4, 0.4);
        let level = libm::sqrt(1.0 - up * up);
        let way = DVec3::new(level * libm::sin(angle), up, level * libm::cos(angle)) * radii * twig.between("reach", 0.85, 1.05);
        let (from, to) = (knee.lerp(middle, twig.between("from", 0.3, 1.0)), middle + way);
        into.limb(from, to, (0.05, 0.0), bark);
        let aside = DVec3::new(way.z, 0.4 * way.y, -way.x) * if i % 2 == 0 { 0.42 } else { -0.42 };
        into.limb(from.lerp(to, 0.4), from.lerp(to, 0.85) + aside, (0.036, 0.0), bark);
    }
}

fn conifer(draw: Draw, into: &mut impl TreeBuilder) {
    into.turned((0.0, 0.0), 6, &[(0.24, 0.0), (0.16, 2.0)], Skin::Bark(BARK));
    let tiers = [(2.3, 1.3, 4.2), (1.95, 3.2, 6.2), (1.5, 5.2, 8.2), (1.05, 7.2, 9.9), (0.6, 9.0, 11.0)];
    for (k, (radius, low, high)) in tiers.into_iter().enumerate() {
        let part = draw.part(k as u64);
        let skin = Skin::Leaves(part.between("shade", 0.85, 1.15));
        let radius = radius * part.between("radius", 0.9, 1.1);
        let rings = [(0.1, low + 0.45), (radius, low), (0.55 * radius, low + 0.35 * (high - low)), (0.0, high)];
        into.turned((0.0, 0.0), 9, &rings, skin);
    }
}

/// A ringed stem and a crown of fronds that rise and bend down.
fn palm(draw: Draw, into: &mut impl TreeBuilder) {
    let stem = [(0.3, 0.0), (0.18, 0.4), (0.14, 2.4), (0.17, 2.5), (0.13, 4.6), (0.16, 4.7), (0.13, 6.6), (0.24, 6.9), (0.0, 7.3)];
    into.turned((0.0, 0.0), 6, &stem, Skin::Bark(PALM_BARK));
    let turn = draw.between("turn", 0.0, core::f64::consts::TAU);
    for i in 0..FRONDS_A_PALM {
        let part = draw.part(i as u64);
        let skin = Skin::Leaves(part.between("shade", 0.82, 1.12));
        let angle = turn + GOLDEN_ANGLE * i as f64;
        let (out, side) =
            (DVec3::new(libm::sin(angle), 0.0, libm::cos(angle)), DVec3::new(libm::cos(angle), 0.0, -libm::sin(angle)));
        // The upper ones rise, the lower ones hang.
        let lift = 1.3 - 2.0 * i as f64 / (FRONDS_A_PALM - 1) as f64 + part.between("lift", -0.15, 0.15);
        let along = [(0.1, 0.0, 0.05), (0.9, 0.6, 0.38), (1.9, 0.45, 0.36), (2.8, -0.55, 0.0)];
        let ribs = along.map(|(reach, rise, half)| (out * reach + DVec3::Y * (6.95 + rise + lift * reach * 0.42), half));
        for pair in ribs.windows(2) {
            let ((a, wide), (b, narrow)) = (pair[0], pair[1]);
            // Two halves that hang from the rib like a roof.
            for side in [side, -side] {
                let sag = DVec3::Y * -0.5;
                let rim = [a + (side + sag) * wide, b + (side + sag) * narrow];
                let corners = [rim[0], a, b, rim[1]];
                // Its tip is a point.
                let count = if narrow > 0.0 { 4 } else { 3 };
                into.blade(&corners[..count], skin);
            }
        }
    }
}
