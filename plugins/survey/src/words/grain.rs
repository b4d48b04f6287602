//! Faces cut into blocks, again and again, by the street that divides each best.

use core::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Id, StreetClass};

use super::fabric::{End, Fabric, FaceId, Role, WayId, crossings};
use super::fit::Fit;
use super::lattice::Lattice;
use super::turn;

/// How the streets of a part of the town lie.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pattern<'a> {
    /// Across the block, bent by so much (0 to 1).
    Bent(f64),
    /// On the lines of a lattice.
    Lattice(&'a Lattice),
}

/// The grain of a spot of the town.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grain<'a> {
    /// Area of a block from middle to middle of its streets, square metres.
    pub block_m2: f64,
    pub pattern: Pattern<'a>,
    /// Width and class of streets that part large grounds, and of those that part two blocks.
    pub streets: [(StreetClass, f64); 2],
}

/// A street that might be laid.
struct Candidate {
    from: End,
    inner: Vec<DVec2>,
    to: End,
    class: StreetClass,
    width_m: f64,
    cost: f64,
}

/// Streets that are tried for a face.
const TRIES: u64 = 10;
/// Grounds this many times a block are parted by the wider streets.
const LARGE: f64 = 7.0;
/// Streets that meet at an angle with less than this cosine go on under one name (145°).
const STRAIGHT_ON: f64 = -0.82;
/// Largest ground that stays whole where no street fits, as blocks; larger ones are tried with less room.
const MOST_BLOCKS: f64 = 2.6;
/// Ground this large, as blocks, that no line of a lattice divides is divided by a street of its own.
const ODD_BLOCKS: f64 = 1.7;

/// Cuts every face of land into blocks by the grain at its middle.
pub(super) fn cut_to_blocks<'a>(fabric: &mut Fabric, seed: u64, grain_at: &dyn Fn(DVec2) -> Grain<'a>) {
    let mut open: Vec<FaceId> = (0..fabric.faces.len()).rev().collect();
    while let Some(face) = open.pop() {
        if !fabric.faces.get(face).is_some_and(|f| f.use_ == super::fabric::Use::Land) {
            continue;
        }
        let (middle, area) = (fabric.middle(face), fabric.area_m2(face));
        let grain = grain_at(middle);
        let draw = Draw::new(seed, Id::from_place("ground", middle), "words: blocks");
        if area < grain.block_m2 * draw.between("size", 0.95, 1.7) {
            continue;
        }
        let strict = fit(&grain, 1.0);
        let loose = fit(&grain, 0.75);
        let across = Grain { pattern: Pattern::Bent(0.0), ..grain };
        // Where no street fits: any that is straight, then with less room, the larger the ground the sooner.
        let tries =
            [(0.0, &grain, &strict), (ODD_BLOCKS, &across, &strict), (MOST_BLOCKS, &grain, &loose), (MOST_BLOCKS, &across, &loose)];
        let tries = tries.iter().zip(0..).filter(|((least, ..), _)| area > least * grain.block_m2);
        let street = tries.map(|(&(_, grain, fit), n)| best(fabric, face, grain, fit, draw.part(100 + n))).find_map(|found| found);
        if let Some(new) = street.and_then(|street| lay(fabric, face, &street)) {
            open.push(new);
            open.push(face);
        }
    }
}

/// What a street of this grain keeps to; `room` below 1 for where nothing fits.
fn fit(grain: &Grain<'_>, room: f64) -> Fit {
    let side = libm::sqrt(grain.block_m2);
    let (wide, narrow) = (grain.streets[0].1, grain.streets[1].1);
    Fit {
        width_m: wide * 1.14,
        clear_m: (side * 0.48 * room).max((wide + narrow) / 2.0 + 12.0),
        least_m2: (grain.block_m2 * 0.42 * room).max(450.0),
        least_width_m: (side * 0.4 * room).max(wide + 10.0),
        least_angle: if matches!(grain.pattern, Pattern::Lattice(_)) { 0.75 * room } else { 0.92 * room },
        gap_m: match grain.pattern {
            Pattern::Bent(bend) => (side * (0.4 - 0.14 * bend)).clamp(wide + 7.0, 40.0),
            Pattern::Lattice(_) => (side * 0.4).clamp(wide + 12.0, 44.0),
        },
    }
}

fn best(fabric: &Fabric, face: FaceId, grain: &Grain<'_>, fit: &Fit, draw: Draw) -> Option<Candidate> {
    let candidates: Vec<Candidate> = match grain.pattern {
        Pattern::Bent(bend) => (0..TRIES).filter_map(|n| bent(fabric, face, grain, bend, fit, draw.part(n))).collect(),
        Pattern::Lattice(lattice) => on_lattice(fabric, face, grain, lattice, fit),
    };
    candidates.into_iter().reduce(|best, c| if c.cost < best.cost { c } else { best })
}

/// Class and width of a street through a ground of so many blocks.
fn street_for(fabric: &Fabric, face: FaceId, grain: &Grain<'_>, draw: Draw) -> (StreetClass, f64) {
    let is_large = fabric.area_m2(face) > LARGE * grain.block_m2;
    let (class, width) = grain.streets[usize::from(!is_large)];
    (class, libm::round(width * draw.between("width", 0.88, 1.14) * 2.0) / 2.0)
}

/// A street across a face's longer extent, which leaves both its sides at right angles.
fn bent(fabric: &Fabric, face: FaceId, grain: &Grain<'_>, bend: f64, fit: &Fit, draw: Draw) -> Option<Candidate> {
    let outline = fabric.outline(face);
    let (long, along) = long_axis(&outline);
    let (low, high) = along;
    let t = draw.between("where", 0.34, 0.66);
    let tilt = draw.between("tilt", -0.45, 0.45) * bend.max(0.1);
    let across = turn(long.perp(), tilt);
    let through = long * (low + (high - low) * t);
    let hits = crossings(&outline, through, across);
    // The longest stretch inside.
    let (a, b) = hits
        .as_chunks::<2>()
        .0
        .iter()
        .map(|&[a, b]| (a, b))
        .max_by(|x, y| x.0.1.distance(x.1.1).total_cmp(&y.0.1.distance(y.1.1)))?;
    let (from, to) = (fabric.end_near(face, a.0, a.1, fit.gap_m)?, fabric.end_near(face, b.0, b.1, fit.gap_m)?);
    let (p, q) = (fabric.end_pos(from), fabric.end_pos(to));
    let length = p.distance(q);
    let inner = if bend > 0.0 {
        let (leave, arrive) = (square_to(fabric, from, q - p), square_to(fabric, to, p - q));
        let sway = (q - p).perp() * draw.between("sway", -0.17, 0.17) * bend;
        curve([p, p + leave * length * 0.38 + sway, q + arrive * length * 0.38 + sway, q], 14.0)
    } else {
        Vec::new()
    };
    let division = fabric.division(face, from, &inner, to, fit)?;
    let (class, width_m) = street_for(fabric, face, grain, draw);
    let new_ends = [from, to].iter().filter(|e| matches!(e, End::On(..))).count() as f64;
    let cost = division.uneven
        + 0.6 * division.length_m / libm::sqrt(grain.block_m2) / (1.0 + (high - low) / length.max(1.0))
        + 0.08 * new_ends;
    Some(Candidate { from, inner, to, class, width_m, cost })
}

/// Streets along the lines of a lattice that cross a face.
fn on_lattice(fabric: &Fabric, face: FaceId, grain: &Grain<'_>, lattice: &Lattice, fit: &Fit) -> Vec<Candidate> {
    let outline = fabric.outline(face);
    let mut out = Vec::new();
    for line in lattice.across(&outline) {
        for [a, b] in crossings(&outline, line.through, line.dir).as_chunks::<2>().0 {
            let snap = fit.gap_m;
            let (Some(from), Some(to)) = (fabric.end_near(face, a.0, a.1, snap), fabric.end_near(face, b.0, b.1, snap)) else {
                continue;
            };
            let Some(division) = fabric.division(face, from, &[], to, fit) else { continue };
            let (class, width_m) = if line.is_avenue { (StreetClass::Main, 19.0) } else { grain.streets[1] };
            let askew = (fabric.end_pos(to) - fabric.end_pos(from)).perp_dot(line.dir).abs() / division.length_m;
            // Avenues first; then what parts the ground most evenly by the shortest street.
            let cost = if line.is_avenue { 0.0 } else { 2.0 } + division.uneven + 4.0 * askew + division.length_m * 1e-3;
            out.push(Candidate { from, inner: Vec::new(), to, class, width_m, cost });
        }
    }
    out
}

fn lay(fabric: &mut Fabric, face: FaceId, street: &Candidate) -> Option<FaceId> {
    let (from, to) = (fabric.place(street.from), fabric.place(street.to));
    let first = street.inner.first().copied().unwrap_or(fabric.pos(to));
    let last = street.inner.last().copied().unwrap_or(fabric.pos(from));
    let role = Role::Street(street.class);
    let way = continued(fabric, from, first, street)
        .or_else(|| continued(fabric, to, last, street))
        .unwrap_or_else(|| fabric.add_way(role, street.width_m, false));
    let inner: Vec<(DVec2, WayId)> = street.inner.iter().map(|&p| (p, way)).collect();
    fabric.split(face, from, &inner, to, way)
}

/// The way of the same class that a street from a vertex towards a point goes on.
fn continued(fabric: &Fabric, spot: u32, towards: DVec2, street: &Candidate) -> Option<WayId> {
    let here = fabric.pos(spot);
    let ways = fabric.neighbours(spot).iter().filter(|&&n| {
        let back = fabric.pos(n) - here;
        back.dot(towards - here) < STRAIGHT_ON * back.length() * towards.distance(here)
    });
    ways.filter_map(|&n| fabric.way_id(spot, n)).find(|&way| {
        fabric.ways.get(way).is_some_and(|w| w.role == Role::Street(street.class) && (w.width_m - street.width_m).abs() < 4.0)
    })
}

/// Direction from an end that stands square on its edge, on the side of `towards`; straight on from a vertex.
fn square_to(fabric: &Fabric, end: End, towards: DVec2) -> DVec2 {
    match end {
        End::On(a, b, _) => {
            let square = (fabric.pos(b) - fabric.pos(a)).perp().normalize_or_zero();
            if square.dot(towards) < 0.0 { -square } else { square }
        }
        End::At(_) => towards.normalize_or_zero(),
    }
}

/// Inner points of a Bézier curve, about so far apart.
pub(super) fn curve([a, b, c, d]: [DVec2; 4], step_m: f64) -> Vec<DVec2> {
    let count = libm::round(a.distance(d) / step_m).clamp(2.0, 40.0) as usize;
    (1..count)
        .map(|i| {
            let t = i as f64 / count as f64;
            let s = 1.0 - t;
            a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t)
        })
        .collect()
}

/// Direction of the longer side of the least box about an outline, among 24 directions, and the extent along it.
pub(super) fn long_axis(outline: &[DVec2]) -> (DVec2, (f64, f64)) {
    let extent =
        |dir: DVec2| outline.iter().map(|p| p.dot(dir)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
    let size = |(low, high): (f64, f64)| high - low;
    let best = (0..24)
        .map(|i| turn(DVec2::X, PI * f64::from(i) / 48.0))
        .min_by(|a, b| {
            let area = |d: DVec2| size(extent(d)) * size(extent(d.perp()));
            area(*a).total_cmp(&area(*b))
        })
        .unwrap_or(DVec2::X);
    let long = if size(extent(best)) >= size(extent(best.perp())) { best } else { turn(best, FRAC_PI_2) };
    (long, extent(long))
}
