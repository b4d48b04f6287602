//! Faces of the plane that lines cut it into: what streets enclose.
//!
//! Lines are cut where they cross (also without a common node), loose ends are trimmed off, and every half-edge is followed
//! to the next one to the left (de Berg et al., *Computational Geometry*, 2.2). Vertices lie on a grid of millimetres, so that
//! turning orders are exact.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line as TreeLine};
use rstar::{AABB, RTree};
use veduta_city::Ring;

use crate::polygon::{Polygon, even_odd, signed_area};

/// A vertex in millimetres.
type Spot = (i64, i64);

fn spot(p: DVec2) -> Spot {
    (libm::round(p.x * 1000.0) as i64, libm::round(p.y * 1000.0) as i64)
}

fn metres(s: Spot) -> DVec2 {
    DVec2::new(s.0 as f64, s.1 as f64) / 1000.0
}

/// An enclosed face.
#[derive(Debug, Clone)]
pub(crate) struct Face {
    pub polygon: Polygon,
    /// Share of the border that is made of lines marked as streets, 0 to 1.
    pub street_share: f64,
}

/// A straight piece of a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub from: DVec2,
    pub to: DVec2,
    /// Whether houses stand along it.
    pub is_street: bool,
}

/// All bounded faces, without the outer one, from west to east.
pub(crate) fn faces(pieces: &[Piece]) -> Vec<Face> {
    let mut edges: BTreeMap<(Spot, Spot), bool> = BTreeMap::new();
    for (a, b, is_street) in cut_at_crossings(pieces) {
        if a != b {
            *edges.entry((a.min(b), a.max(b))).or_default() |= is_street;
        }
    }
    trim(&mut edges);
    let around = turning_orders(&edges);
    let mut visited: BTreeSet<(Spot, Spot)> = BTreeSet::new();
    let (mut inner, mut outer) = (Vec::new(), Vec::new());
    for &(a, b) in edges.keys() {
        for start in [(a, b), (b, a)] {
            if visited.contains(&start) {
                continue;
            }
            let cycle = walk(start, &around, &mut visited);
            let ring: Ring = cycle.iter().map(|s| metres(*s)).collect();
            if signed_area(&ring) > 0.0 { inner.push((cycle, ring)) } else { outer.push(ring) }
        }
    }
    with_islands(inner, &outer, &edges)
}

/// Pieces cut wherever they cross or touch.
fn cut_at_crossings(pieces: &[Piece]) -> Vec<(Spot, Spot, bool)> {
    let lines: Vec<_> =
        pieces.iter().enumerate().map(|(i, p)| GeomWithData::new(TreeLine::new(p.from.to_array(), p.to.to_array()), i)).collect();
    let tree = RTree::bulk_load(lines);
    let mut out = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let (low, high) = (piece.from.min(piece.to), piece.from.max(piece.to));
        let search = AABB::from_corners((low - 0.01).to_array(), (high + 0.01).to_array());
        let mut cuts: Vec<f64> = vec![0.0, 1.0];
        for other in tree.locate_in_envelope_intersecting(&search) {
            if let Some(other) = pieces.get(other.data) {
                cuts.extend(cuts_by(piece, other));
            }
        }
        cuts.sort_by(f64::total_cmp);
        let spots: Vec<Spot> = cuts.iter().map(|&t| spot(piece.from.lerp(piece.to, t))).collect();
        out.extend(spots.windows(2).filter(|w| w[0] != w[1]).map(|w| (w[0], w[1], piece.is_street)));
    }
    out
}

/// Where another piece cuts this one, as fractions of its length.
fn cuts_by(piece: &Piece, other: &Piece) -> Vec<f64> {
    const NEAR_M: f64 = 2e-3;
    let d = piece.to - piece.from;
    let length = d.length();
    if length < NEAR_M {
        return Vec::new();
    }
    let mut out = Vec::new();
    // Ends of the other that lie on this one.
    for end in [other.from, other.to] {
        let t = (end - piece.from).dot(d) / (length * length);
        if t > 0.0 && t < 1.0 && (end - piece.from).perp_dot(d).abs() / length < NEAR_M {
            out.push(t);
        }
    }
    let e = other.to - other.from;
    let cross = d.perp_dot(e);
    if out.is_empty() && cross.abs() > 1e-9 * length * e.length() {
        let (t, u) = ((other.from - piece.from).perp_dot(e) / cross, (other.from - piece.from).perp_dot(d) / cross);
        if t > 0.0 && t < 1.0 && (0.0..=1.0).contains(&u) {
            out.push(t);
        }
    }
    out
}

/// Takes off edges that end nowhere, again and again.
fn trim(edges: &mut BTreeMap<(Spot, Spot), bool>) {
    let mut at: BTreeMap<Spot, BTreeSet<Spot>> = BTreeMap::new();
    for &(a, b) in edges.keys() {
        at.entry(a).or_default().insert(b);
        at.entry(b).or_default().insert(a);
    }
    let mut loose: Vec<Spot> = at.iter().filter(|(_, n)| n.len() == 1).map(|(s, _)| *s).collect();
    while let Some(end) = loose.pop() {
        let Some(next) = at.get(&end).and_then(|n| n.first().copied()) else { continue };
        at.remove(&end);
        edges.remove(&(end.min(next), end.max(next)));
        if let Some(neighbours) = at.get_mut(&next) {
            neighbours.remove(&end);
            if neighbours.len() == 1 {
                loose.push(next);
            }
        }
    }
}

/// Neighbours of every vertex, counter-clockwise.
fn turning_orders(edges: &BTreeMap<(Spot, Spot), bool>) -> BTreeMap<Spot, Vec<Spot>> {
    let mut around: BTreeMap<Spot, Vec<Spot>> = BTreeMap::new();
    for &(a, b) in edges.keys() {
        around.entry(a).or_default().push(b);
        around.entry(b).or_default().push(a);
    }
    for (&(x, y), neighbours) in &mut around {
        let half = |d: (i64, i64)| u8::from(d.1 < 0 || (d.1 == 0 && d.0 < 0));
        neighbours.sort_by(|p, q| {
            let (a, b) = ((p.0 - x, p.1 - y), (q.0 - x, q.1 - y));
            let cross = i128::from(a.0) * i128::from(b.1) - i128::from(a.1) * i128::from(b.0);
            half(a).cmp(&half(b)).then(0.cmp(&cross))
        });
    }
    around
}

/// Follows half-edges, always taking the next one clockwise from where it came: the face lies to the left.
fn walk(start: (Spot, Spot), around: &BTreeMap<Spot, Vec<Spot>>, visited: &mut BTreeSet<(Spot, Spot)>) -> Vec<Spot> {
    let (mut cycle, mut edge) = (Vec::new(), start);
    while visited.insert(edge) {
        cycle.push(edge.0);
        let (from, at) = edge;
        let Some(neighbours) = around.get(&at) else { break };
        let Some(i) = neighbours.iter().position(|&n| n == from) else { break };
        let Some(&next) = neighbours.get((i + neighbours.len() - 1) % neighbours.len()) else { break };
        edge = (at, next);
    }
    cycle
}

/// Turns cycles into faces; what lies loose inside a face becomes its hole.
fn with_islands(inner: Vec<(Vec<Spot>, Ring)>, outer: &[Ring], edges: &BTreeMap<(Spot, Spot), bool>) -> Vec<Face> {
    let mut whole: Vec<Polygon> = inner.iter().map(|(_, r)| Polygon { outer: r.clone(), holes: Vec::new() }).collect();
    let index = crate::buildings::Index::new(whole.iter());
    for ring in outer {
        let Some(&first) = ring.first() else { continue };
        let size = -signed_area(ring);
        // The smallest face that holds the island and is not made of the island's own edges.
        let home = index
            .near(first, first)
            .into_iter()
            .filter_map(|i| whole.get(i).map(|p| (i, signed_area(&p.outer), p)))
            .filter(|(_, area, p)| {
                *area > size && !p.outer.contains(&first) && Polygon { outer: p.outer.clone(), holes: vec![] }.contains(first)
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, ..)) = home
            && let Some(polygon) = whole.get_mut(i)
        {
            polygon.holes.push(ring.clone());
        }
    }
    let mut out = Vec::new();
    for ((cycle, _), polygon) in inner.iter().zip(whole) {
        let street_share = street_share(cycle, edges);
        let rings: Vec<Ring> = core::iter::once(polygon.outer).chain(polygon.holes).collect();
        out.extend(even_odd(&rings).0.into_iter().map(|polygon| Face { polygon, street_share }));
    }
    out
}

fn street_share(cycle: &[Spot], edges: &BTreeMap<(Spot, Spot), bool>) -> f64 {
    let (mut street, mut all) = (0.0, 0.0);
    for (&a, &b) in cycle.iter().zip(cycle.iter().cycle().skip(1)) {
        let length = metres(a).distance(metres(b));
        all += length;
        if edges.get(&(a.min(b), a.max(b))).copied().unwrap_or(false) {
            street += length;
        }
    }
    if all > 0.0 { street / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(x0: f64, y0: f64, x1: f64, y1: f64) -> Piece {
        Piece { from: DVec2::new(x0, y0), to: DVec2::new(x1, y1), is_street: true }
    }

    fn frame(x: f64, y: f64, side: f64) -> Vec<Piece> {
        vec![
            piece(x, y, x + side, y),
            piece(x + side, y, x + side, y + side),
            piece(x + side, y + side, x, y + side),
            piece(x, y + side, x, y),
        ]
    }

    fn areas(pieces: &[Piece]) -> Vec<f64> {
        faces(pieces).iter().map(|f| f.polygon.area_m2().round()).collect()
    }

    #[test]
    fn lines_that_cross_without_a_node_still_enclose() {
        let pieces = [
            piece(-1.0, 0.0, 11.0, 0.0),
            piece(-1.0, 10.0, 11.0, 10.0),
            piece(0.0, -1.0, 0.0, 11.0),
            piece(10.0, -1.0, 10.0, 11.0),
        ];
        assert_eq!(areas(&pieces), [100.0]);
    }

    #[test]
    fn a_grid_has_its_cells_and_not_the_outside() {
        let mut pieces: Vec<Piece> = (0..4).map(|i| piece(0.0, f64::from(i) * 10.0, 30.0, f64::from(i) * 10.0)).collect();
        pieces.extend((0..4).map(|i| piece(f64::from(i) * 10.0, 0.0, f64::from(i) * 10.0, 30.0)));
        assert_eq!(areas(&pieces), [100.0; 9]);
    }

    #[test]
    fn blind_alleys_do_not_matter() {
        let mut pieces = frame(0.0, 0.0, 10.0);
        pieces.extend([piece(5.0, 0.0, 5.0, 6.0), piece(5.0, 6.0, 7.0, 6.0), piece(0.0, 0.0, -5.0, -5.0)]);
        assert_eq!(areas(&pieces), [100.0]);
    }

    #[test]
    fn an_island_is_a_hole_of_what_surrounds_it() {
        let mut pieces = frame(0.0, 0.0, 20.0);
        pieces.extend(frame(5.0, 5.0, 4.0));
        assert_eq!(areas(&pieces), [384.0, 16.0]);
    }

    #[test]
    fn two_frames_joined_by_a_bridge_are_two_faces() {
        let mut pieces = frame(0.0, 0.0, 10.0);
        pieces.extend(frame(20.0, 0.0, 10.0));
        pieces.push(piece(10.0, 5.0, 20.0, 5.0));
        assert_eq!(areas(&pieces), [100.0, 100.0]);
    }

    #[test]
    fn the_share_of_streets_is_by_length() {
        let mut pieces = frame(0.0, 0.0, 10.0);
        pieces[0].is_street = false;
        assert!((faces(&pieces)[0].street_share - 0.75).abs() < 1e-9);
    }
}
