//! Walks through parks, where a map draws none: from gates at the corners and along long sides to a round place in the middle, and, in
//! large parks, a round walk about that.

use core::f64::consts::{FRAC_PI_6, TAU};

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{BlockKind, CityGraph, GridPolygon, GridPos, Link, LinkKind, StreetClass};

use super::band::band_of;
use super::inradius::largest_disc;
use super::streets::in_park;
use super::{Area, boolean, outline, relation};

/// Half the width of a walk, metres.
const HALF_M: f64 = 1.3;
/// Parks in which no disc of this radius lies are lawns; metres.
const LEAST_RADIUS_M: f64 = 8.0;
/// A round walk goes about the middle of parks in which a disc of this radius lies, …
const ROUND_M: f64 = 26.0;
/// … this share of it away from the middle.
const ROUND_SHARE: f64 = 0.62;
/// Radius of the place in the middle as a share of the disc's, and the least and most of it, metres.
const PLACE: (f64, f64, f64) = (0.2, 2.6, 8.0);
/// Turns of more than this are corners with a gate.
const CORNER: f64 = FRAC_PI_6;
/// Sides longer than this have a gate in the middle, metres.
const LONG_SIDE_M: f64 = 90.0;
/// Gates closer than this to one another are one, metres.
const APART_M: f64 = 22.0;
/// How far walks reach out of their gates before they are cut off at the border, metres.
const OUT_M: f64 = 1.5;
/// Winding walks leave the straight way by this share of it at most.
const SWAY: f64 = 0.14;
/// The largest disc about a centroid that is about as large as any, as a share of that.
const ROOMY: f64 = 0.85;
/// Corners of circles.
const CORNERS: u32 = 32;
/// Pieces of a winding walk.
const PIECES: u32 = 8;

/// The walks of all parks; none if the graph draws a footway in any.
pub(super) fn walks(graph: &CityGraph, areas: &[Area<'_>]) -> Vec<GridPolygon> {
    let parks: Vec<&Area<'_>> = areas.iter().filter(|area| area.block.kind == BlockKind::Park).collect();
    let at = graph.node_positions();
    let is_footway = |kind: LinkKind| matches!(kind, LinkKind::Street(StreetClass::Path | StreetClass::Steps));
    let is_walk = |link: &Link| is_footway(link.kind) && graph.polyline(link, &at).is_some_and(|line| in_park(&line, areas));
    if graph.links.par_iter().any(is_walk) {
        return Vec::new();
    }
    let of_park = |park: &&Area<'_>| {
        let draw = Draw::new(graph.seed, park.block.id, "walks");
        park.polygons.iter().flat_map(move |polygon| of_lawn(polygon, draw)).collect::<Vec<_>>()
    };
    parks.par_iter().flat_map_iter(of_park).collect()
}

/// The walks of one piece of a park.
fn of_lawn(lawn: &GridPolygon, draw: Draw) -> Vec<GridPolygon> {
    let Some((middle, radius)) = heart(lawn).filter(|disc| disc.1 >= LEAST_RADIUS_M) else { return Vec::new() };
    let place_m = (radius * PLACE.0).clamp(PLACE.1, PLACE.2);
    let winds = radius > 1.5 * LEAST_RADIUS_M && draw.chance("winds", 0.5);
    let mut out: Vec<GridPolygon> = Vec::new();
    for (i, gate) in (0..).zip(gates(lawn)) {
        let sway = if winds { draw.part(i).between("sway", -SWAY, SWAY) } else { 0.0 };
        let ways = [sway, 0.0].into_iter().map(|sway| way(gate, middle, sway));
        let fit = ways.into_iter().find(|way| is_inside(lawn, way));
        out.extend(fit.and_then(|way| band_of(&way, HALF_M)));
    }
    if out.is_empty() {
        return out;
    }
    out.push(GridPolygon::simple(circle(middle, place_m)));
    if radius >= ROUND_M {
        let [outer, mut inner] = [HALF_M, -HALF_M].map(|off| circle(middle, radius * ROUND_SHARE + off));
        inner.reverse();
        out.push(GridPolygon { outer, holes: vec![inner] });
    }
    boolean::intersection(&boolean::rings(&out), &boolean::rings([lawn]))
}

/// The middle of a park and the radius of a disc about it: its centroid, if there is about as much room as anywhere.
pub(super) fn heart(lawn: &GridPolygon) -> Option<(DVec2, f64)> {
    let (middle, radius) = largest_disc(lawn, f64::INFINITY)?;
    let centroid = lawn.centroid();
    let borders = lawn.edges().map(|(a, b)| outline::distance_to_edge(centroid, a.to_metres(), b.to_metres()));
    let room = borders.fold(f64::INFINITY, f64::min);
    let is_roomy = room >= ROOMY * radius && lawn.contains(GridPos::from_metres(centroid));
    Some(if is_roomy { (centroid, room) } else { (middle, radius) })
}

/// Gates at the corners of an outline and in the middle of its long sides, in order round it.
fn gates(lawn: &GridPolygon) -> Vec<DVec2> {
    let straight = outline::straightened(lawn);
    let Some(ring) = straight.first().map(|lawn| &lawn.outer) else { return Vec::new() };
    let ring: Vec<DVec2> = ring.iter().map(|p| p.to_metres()).collect();
    let n = ring.len();
    let (mut corners, mut sides) = (Vec::new(), Vec::new());
    for i in 0..n {
        let (before, here, next) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
        let (a, b) = (here - before, next - here);
        if libm::atan2(a.perp_dot(b), a.dot(b)) > CORNER {
            corners.push(here);
        }
        if b.length() > LONG_SIDE_M {
            sides.push((here + next) / 2.0);
        }
    }
    // Corners first: people come from crossroads.
    let mut out: Vec<DVec2> = Vec::new();
    for gate in corners.into_iter().chain(sides) {
        if out.iter().all(|other| other.distance(gate) > APART_M) {
            out.push(gate);
        }
    }
    out
}

/// The way to the middle through a gate, which is its second vertex.
fn way(gate: DVec2, middle: DVec2, sway: f64) -> Vec<DVec2> {
    let along = middle - gate;
    let control = gate + along / 2.0 + along.perp() * sway;
    let curve = |i: u32| {
        let share = f64::from(i) / f64::from(PIECES);
        gate.lerp(control, share).lerp(control.lerp(middle, share), share)
    };
    let outside = gate - (control - gate).normalize_or_zero() * OUT_M;
    let pieces = if sway == 0.0 { vec![gate, middle] } else { (0..=PIECES).map(curve).collect() };
    core::iter::once(outside).chain(pieces).collect()
}

/// Whether a way stays within a park from its gate on.
fn is_inside(lawn: &GridPolygon, way: &[DVec2]) -> bool {
    let &[_, gate, next, ref rest @ ..] = way else { return false };
    let begin = gate + (next - gate).clamp_length_max(0.5);
    let line: Vec<GridPos> = [begin, next].iter().chain(rest).map(|&p| GridPos::from_metres(p)).collect();
    let is_clear = |piece: &[GridPos]| !lawn.edges().any(|edge| relation::do_touch((piece[0], piece[1]), edge));
    lawn.contains(line[0]) && line.windows(2).all(is_clear)
}

/// A ring of corners about a centre, counter-clockwise.
fn circle(middle: DVec2, radius_m: f64) -> Vec<GridPos> {
    let corner = |i: u32| {
        let angle = TAU * f64::from(i) / f64::from(CORNERS);
        GridPos::on_plan(middle + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius_m)
    };
    (0..CORNERS).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lawn(corners: &[(f64, f64)]) -> GridPolygon {
        GridPolygon::simple(corners.iter().map(|&(x, y)| GridPos::from_metres(DVec2::new(x, y))).collect())
    }

    fn draw(i: u64) -> Draw {
        Draw::new(i, veduta_city::Id(3), "walks")
    }

    #[test]
    fn walks_lead_from_every_corner_and_hang_together() {
        let corners = [(0.0, 0.0), (70.0, 0.0), (70.0, 60.0), (0.0, 60.0)];
        for i in 0..20 {
            let walks = of_lawn(&lawn(&corners), draw(i));
            assert!(walks.len() == 1 && walks[0].holes.len() > 3, "{} pieces", walks.len());
            for corner in corners.map(DVec2::from) {
                let inside = corner.lerp(DVec2::new(35.0, 30.0), 0.01);
                assert!(walks[0].contains(GridPos::from_metres(inside)), "{corner}");
            }
        }
    }

    #[test]
    fn walks_stay_in_their_park() {
        let ell = lawn(&[(0.0, 0.0), (80.0, 0.0), (80.0, 24.0), (24.0, 24.0), (24.0, 80.0), (0.0, 80.0)]);
        let court = GridPolygon {
            holes: vec![lawn(&[(30.0, 30.0), (30.0, 50.0), (60.0, 50.0), (60.0, 30.0)]).outer],
            ..lawn(&[(0.0, 0.0), (110.0, 0.0), (110.0, 90.0), (0.0, 90.0)])
        };
        for (park, least_m2) in [(&ell, 300.0), (&court, 400.0)] {
            for i in 0..20 {
                let walks = of_lawn(park, draw(i));
                assert_eq!(boolean::difference(&boolean::rings(&walks), &boolean::rings([park])), []);
                let area: f64 = walks.iter().map(GridPolygon::area_m2).sum();
                assert!(walks.len() == 1 && area > least_m2, "{} pieces of {area} m²", walks.len());
            }
        }
    }

    #[test]
    fn slips_of_green_are_lawns() {
        assert_eq!(of_lawn(&lawn(&[(0.0, 0.0), (90.0, 0.0), (90.0, 12.0), (0.0, 12.0)]), draw(1)), []);
    }
}
