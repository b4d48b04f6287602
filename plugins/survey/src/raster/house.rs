//! Footprints of single houses, where the map shows them in a colour of their own.
//!
//! ```text
//!  region ─► outline along the pixels' edges ─► simplified ─► nearly all of it along two directions square to each other?
//!                                                             yes ─► each wall is put where the edge runs on the mean
//!                                                             no  ─► as it is
//! ```

use glam::DVec2;

use super::classify::Classes;
use super::clean::{Labels, is_rare};
use super::filter::crowded;
use super::outline::{Corners, Outline, holders, outlines};
use crate::polygon::{is_simple, signed_area};

/// Smallest house, square metres and pixels …
const LEAST_M2: f64 = 12.0;
const LEAST_PX: i64 = 6;
/// … and smallest court in one.
const LEAST_COURT_M2: f64 = 9.0;
/// How far an outline may be from the pixels' edges: in metres, or in pixels where these are larger.
const SIMPLE_M: f64 = 0.4;
const SIMPLE_PX: f64 = 1.0;
/// The same for an outline that is put square, the first that does: steps of a wall at a slant are deeper than a pixel.
const WALLS_PX: [f64; 3] = [2.0, 1.5, 1.0];
/// How much of an outline runs along two directions square to each other, if its house is right-angled: from 0 to 1.
const LEAST_SQUARE: f64 = 0.8;
/// Tangent of the angle by which a wall of such a house may be off: 20° …
const MOST_OFF: f64 = 0.364;
/// … unless it is no longer than this, pixels: a step of the grid, or a corner that was cut off.
const STEP_PX: f64 = 7.0;
/// A right-angled outline has the area of the pixels to this share, and so many more pixels for each of its walls.
const AREA_SHARE: f64 = 0.06;
const AREA_PX: f64 = 1.5;

/// A house as found: rings in pixels, y down; what is house lies to the left as one goes, seen with y down.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Footprint {
    pub outline: Vec<DVec2>,
    /// Inner courts.
    pub courts: Vec<Vec<DVec2>>,
}

impl Footprint {
    /// Its outline and those of its courts.
    pub fn rings_mut(&mut self) -> impl Iterator<Item = &mut Vec<DVec2>> {
        core::iter::once(&mut self.outline).chain(&mut self.courts)
    }
}

/// The footprints of a map's houses; none where the map does not show single ones.
pub(super) fn houses(classes: &Classes, labels: &Labels<'_>, mpp: f64) -> Vec<Footprint> {
    if classes.house.is_blank() {
        return Vec::new();
    }
    let mut house = classes.house.clone();
    if !is_rare(&classes.ink) {
        house = labels.seen_through(&house);
    }
    // Less strict than a median: that takes corners off, and small houses away.
    let steady = crowded(&house);
    house.keep(&steady);
    let px = |area_m2: f64| ((area_m2 / (mpp * mpp)) as i64).max(LEAST_PX);
    let (least, least_court) = (px(LEAST_M2), px(LEAST_COURT_M2));
    let tolerance = (SIMPLE_M / mpp).max(SIMPLE_PX);
    let (courts, walls): (Vec<Outline>, Vec<Outline>) = outlines(&house, Corners::Part).into_iter().partition(Outline::is_hole);
    let walls: Vec<Outline> = walls.into_iter().filter(|o| o.area_px >= least).collect();
    let courts: Vec<Outline> = courts.into_iter().filter(|o| -o.area_px >= least_court).collect();
    let mut found: Vec<Footprint> =
        walls.iter().map(|o| Footprint { outline: outline_of(o, tolerance), courts: Vec::new() }).collect();
    for (court, holder) in courts.iter().zip(holders(&walls, &courts)) {
        if let Some(house) = holder.and_then(|i| found.get_mut(i)) {
            house.courts.push(outline_of(court, tolerance));
        }
    }
    found.retain(|house| house.outline.len() > 2);
    found
}

/// An outline with few corners: right ones where the house has such; as many as it takes for it not to cross itself.
fn outline_of(outline: &Outline, tolerance: f64) -> Vec<DVec2> {
    let edges: Vec<DVec2> = outline.corners.iter().map(|c| c.as_dvec2()).collect();
    let area = outline.area_px.abs() as f64;
    let is_true = |right: &Vec<DVec2>| {
        let off = (signed_area(right).abs() - area).abs();
        off < AREA_SHARE * area + AREA_PX * right.len() as f64 && is_simple(right)
    };
    let right = WALLS_PX.iter().find_map(|&t| squared(&edges, &outline.simplified(t.max(tolerance))).filter(is_true));
    right.unwrap_or_else(|| {
        let finer = [tolerance, tolerance / 2.0].iter().map(|&t| outline.simplified(t)).find(|ring| is_simple(ring));
        finer.unwrap_or(edges)
    })
}

/// A wall while it is put square: the stretch of the outline from one of its corners to another, and its direction.
#[derive(Debug, Clone, Copy)]
struct Wall {
    from: usize,
    to: usize,
    /// Along the first of the two directions, or along the second.
    is_first: bool,
}

/// An outline of right corners, if what it simplifies to nearly has such.
fn squared(edges: &[DVec2], simple: &[DVec2]) -> Option<Vec<DVec2>> {
    let [along, across] = directions(simple)?;
    let mut walls = walls(edges, simple, along)?;
    // Walls that go on in the same direction are one; the first may go on from the last.
    let turn = (1..walls.len()).find(|&i| walls[i].is_first != walls[i - 1].is_first)?;
    walls[..turn].iter_mut().for_each(|wall| (wall.from, wall.to) = (wall.from + edges.len(), wall.to + edges.len()));
    walls.rotate_left(turn);
    let mut merged: Vec<Wall> = Vec::new();
    for wall in walls {
        match merged.last_mut() {
            Some(last) if last.is_first == wall.is_first => last.to = wall.to,
            _ => merged.push(wall),
        }
    }
    if merged.len() < 4 || merged.len() % 2 == 1 {
        return None;
    }
    let offset = |wall: &Wall| offset(edges, wall, if wall.is_first { across } else { along });
    let offsets: Option<Vec<f64>> = merged.iter().map(offset).collect();
    let offsets = offsets?;
    let corner = |i: usize| {
        let (own, next) = (offsets[i], offsets[(i + 1) % offsets.len()]);
        let (off_across, off_along) = if merged[i].is_first { (own, next) } else { (next, own) };
        across * off_across + along * off_along
    };
    Some((0..merged.len()).map(corner).collect())
}

/// The two directions, square to each other, that most of a ring runs along; nothing if too little of it does.
fn directions(ring: &[DVec2]) -> Option<[DVec2; 2]> {
    // Turned by four times its angle, every edge along either of the two, to and fro, points the same way.
    let (mut sum, mut length) = (DVec2::ZERO, 0.0);
    for (i, &a) in ring.iter().enumerate() {
        let edge = ring[(i + 1) % ring.len()] - a;
        if let Some(way) = edge.try_normalize() {
            let twice = way.rotate(way);
            sum += twice.rotate(twice) * edge.length();
            length += edge.length();
        }
    }
    if sum.length() < LEAST_SQUARE * length || length == 0.0 {
        return None;
    }
    let angle = libm::atan2(sum.y, sum.x) / 4.0;
    let along = DVec2::new(libm::cos(angle), libm::sin(angle));
    Some([along, along.perp()])
}

/// The walls of a simplified ring, or nothing if one runs at a slant.
fn walls(edges: &[DVec2], simple: &[DVec2], along: DVec2) -> Option<Vec<Wall>> {
    // Simplifying keeps corners, in order but from another one on.
    let first = edges.iter().position(|p| Some(p) == simple.first())?;
    let mut at = first;
    let mut walls = Vec::with_capacity(simple.len());
    for (i, &a) in simple.iter().enumerate() {
        let b = simple[(i + 1) % simple.len()];
        let from = at;
        while edges[at % edges.len()] != b || at == from {
            at += 1;
            if at > first + edges.len() {
                return None;
            }
        }
        let edge = b - a;
        let (u, v) = (edge.dot(along).abs(), edge.perp_dot(along).abs());
        if edge.length() > STEP_PX && u.min(v) > MOST_OFF * u.max(v) {
            return None;
        }
        walls.push(Wall { from, to: at, is_first: u >= v });
    }
    Some(walls)
}

/// How far along a normal a wall lies, on the mean of the pixels' edges that run along it.
fn offset(edges: &[DVec2], wall: &Wall, normal: DVec2) -> Option<f64> {
    let (mut sum, mut weight) = (0.0, 0.0);
    for i in wall.from..wall.to {
        let (a, b) = (edges[i % edges.len()], edges[(i + 1) % edges.len()]);
        let along = (b - a).perp_dot(normal).abs();
        sum += along * ((a + b) / 2.0).dot(normal);
        weight += along;
    }
    (weight > 0.0).then(|| sum / weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::bitmap::Bitmap;
    use proptest::prelude::*;

    fn found(side: usize, is_house: impl Fn(DVec2) -> bool, mpp: f64) -> Vec<Footprint> {
        let blank = || Bitmap::new(side, side);
        let house = Bitmap::from_fn(side, side, |x, y| is_house(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)));
        let classes =
            Classes { street: blank(), park: blank(), water: blank(), railway: blank(), ink: blank(), house, square: blank() };
        houses(&classes, &Labels::of(&classes.ink), mpp)
    }

    /// An L of two boxes of 60 × 20 and 20 × 50, with its corner at the origin.
    fn is_l(p: DVec2) -> bool {
        p.min_element() > 0.0 && (p.x < 60.0 && p.y < 20.0 || p.x < 20.0 && p.y < 50.0)
    }

    proptest! {
        #[test]
        fn a_house_turned_by_any_angle_is_put_square(angle in 0.0..core::f64::consts::TAU, dx in 0.0..1.0f64, dy in 0.0..1.0f64) {
            let (east, middle) = (DVec2::from_angle(angle), DVec2::new(100.0 + dx, 100.0 + dy));
            let houses = found(200, |p| is_l(east.rotate(DVec2::new(1.0, -1.0) * (p - middle)) + DVec2::new(30.0, 20.0)), 0.5);
            prop_assert_eq!(houses.len(), 1);
            let ring = &houses[0].outline;
            prop_assert_eq!(ring.len(), 6, "{:?}", ring);
            for i in 0..6 {
                let (a, b, c) = (ring[i], ring[(i + 1) % 6], ring[(i + 2) % 6]);
                prop_assert!((b - a).normalize().dot((c - b).normalize()).abs() < 1e-6, "a corner is no right one: {:?}", ring);
            }
            let area = signed_area(ring).abs();
            prop_assert!((area - 1800.0).abs() < 40.0, "{}", area);
        }

        #[test]
        fn whatever_is_house_has_simple_rings_or_those_of_its_pixels(density in 4u64..14, cell in 2usize..5, seed: u64) {
            let is_set = |x: usize, y: usize| {
                let n = ((x / cell) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / cell) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < density
            };
            let houses = found(48, |p| is_set(p.x as usize, p.y as usize), 1.0);
            for house in &houses {
                for ring in core::iter::once(&house.outline).chain(&house.courts) {
                    // A region that touches itself by a corner has no simple ring.
                    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
                    let is_of_pixels = edges.clone().all(|(a, b)| (a.x == b.x || a.y == b.y) && *a == a.round());
                    let meets = (0..ring.len()).any(|i| ring[..i].contains(&ring[i]));
                    prop_assert!(is_simple(ring) || is_of_pixels && meets, "{:?}", ring);
                }
            }
        }
    }

    #[test]
    fn a_round_house_stays_round_and_a_court_is_one() {
        let round = found(100, |p| p.distance(DVec2::splat(50.0)) < 30.0, 0.5);
        assert!(round.len() == 1 && round[0].outline.len() > 8, "{round:?}");
        let courts =
            |side: f64| found(100, |p| (p - 50.0).abs().max_element() < 30.0 && (p - 50.0).abs().max_element() > side, 0.5);
        let house = courts(10.0);
        assert_eq!((house.len(), house[0].courts.len()), (1, 1));
        assert!((signed_area(&house[0].courts[0]).abs() - 400.0).abs() < 1.0, "{house:?}");
        assert!(signed_area(&house[0].outline) * signed_area(&house[0].courts[0]) < 0.0, "a court runs the other way round");
        assert_eq!(courts(2.0)[0].courts.len(), 0, "4 m² are none");
    }

    #[test]
    fn specks_are_no_houses() {
        assert_eq!(found(50, |p| (p - 25.0).abs().max_element() < 3.0, 0.5), [], "9 m²");
        assert_eq!(found(50, |p| (p - 25.0).abs().max_element() < 4.0, 0.5).len(), 1, "16 m²");
        assert_eq!(found(50, |p| (p.x - 25.5).abs() < 0.6, 0.5), [], "a line");
    }
}
