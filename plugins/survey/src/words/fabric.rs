//! The town as a plane cut into faces. It begins with one face, and grows by one thing alone: a line from border to border of
//! a face, which becomes two. So lines never cross without a common vertex, and every face is known at any time.

use std::collections::BTreeMap;

use glam::DVec2;
pub(super) use veduta_city::ring_edges;
use veduta_city::{Ring, StreetClass};

use crate::polygon::{centroid, edges, signed_area};

/// Index of a vertex.
pub(super) type Spot = u32;
/// Index of a face.
pub(super) type FaceId = usize;
/// Index of a way.
pub(super) type WayId = usize;

/// What an edge of the plane is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// A street.
    Street(StreetClass),
    /// A street over water.
    Bridge(StreetClass),
    /// House fronts on a square: no street of its own.
    Front,
    /// The border of the modelled ground: nothing lies there.
    Edge,
}

/// A line that was laid in one go, or continues one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    pub role: Role,
    /// Full width, metres.
    pub width_m: f64,
    /// Whether it leads out of the town.
    pub is_main: bool,
}

/// What the ground of a face is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    Land,
    Water,
    Square,
    Park,
    /// A church or the like stands there.
    Monument,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Face {
    /// Vertices, counter-clockwise; none twice.
    pub ring: Vec<Spot>,
    pub use_: Use,
    /// Whether it lies within the older part of the town.
    pub is_core: bool,
}

/// An end of a line that is to be laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// At a vertex.
    At(Spot),
    /// On the edge from the first to the second.
    On(Spot, Spot, DVec2),
}

/// Vertices, edges, faces and ways.
#[derive(Debug, Clone, Default)]
pub(super) struct Fabric {
    pub spots: Vec<DVec2>,
    pub faces: Vec<Face>,
    pub ways: Vec<Way>,
    /// Neighbours of every vertex.
    around: Vec<Vec<Spot>>,
    /// The face to the left of each directed edge; none beyond the border.
    left: BTreeMap<(Spot, Spot), FaceId>,
    /// The way of each edge, lesser vertex first.
    way_of: BTreeMap<(Spot, Spot), WayId>,
}

fn key(a: Spot, b: Spot) -> (Spot, Spot) {
    (a.min(b), a.max(b))
}

/// On the centimetre, so that files are short.
pub(super) fn rounded(p: DVec2) -> DVec2 {
    // Adding nought makes of -0 a 0.
    DVec2::new(libm::round(p.x * 100.0) / 100.0 + 0.0, libm::round(p.y * 100.0) / 100.0 + 0.0)
}

impl Fabric {
    /// One face within a counter-clockwise border of one way.
    pub fn new(border: &[DVec2], way: Way) -> Self {
        let mut fabric = Self { ways: vec![way], ..Self::default() };
        let ring: Vec<Spot> = border.iter().map(|&p| fabric.spot(p)).collect();
        fabric.faces.push(Face { ring: ring.clone(), use_: Use::Land, is_core: false });
        for (a, b) in ring_edges(&ring) {
            fabric.join(a, b, 0);
            fabric.left.insert((a, b), 0);
        }
        fabric
    }

    pub fn add_way(&mut self, role: Role, width_m: f64, is_main: bool) -> WayId {
        self.ways.push(Way { role, width_m, is_main });
        self.ways.len() - 1
    }

    pub fn pos(&self, spot: Spot) -> DVec2 {
        self.spots.get(spot as usize).copied().unwrap_or_default()
    }

    pub fn neighbours(&self, spot: Spot) -> &[Spot] {
        self.around.get(spot as usize).map_or(&[], Vec::as_slice)
    }

    pub fn way_id(&self, a: Spot, b: Spot) -> Option<WayId> {
        self.way_of.get(&key(a, b)).copied()
    }

    pub fn way(&self, a: Spot, b: Spot) -> Option<Way> {
        self.way_id(a, b).and_then(|id| self.ways.get(id).copied())
    }

    pub fn set_way(&mut self, a: Spot, b: Spot, way: WayId) {
        if let Some(slot) = self.way_of.get_mut(&key(a, b)) {
            *slot = way;
        }
    }

    /// The face to the left of a directed edge.
    pub fn face_left(&self, a: Spot, b: Spot) -> Option<FaceId> {
        self.left.get(&(a, b)).copied()
    }

    /// Every edge, lesser vertex first, with its way.
    pub fn all_edges(&self) -> impl Iterator<Item = (Spot, Spot, WayId)> + '_ {
        self.way_of.iter().map(|(&(a, b), &way)| (a, b, way))
    }

    pub fn ring(&self, face: FaceId) -> &[Spot] {
        self.faces.get(face).map_or(&[], |f| f.ring.as_slice())
    }

    pub fn outline(&self, face: FaceId) -> Ring {
        self.ring(face).iter().map(|&s| self.pos(s)).collect()
    }

    pub fn area_m2(&self, face: FaceId) -> f64 {
        signed_area(&self.outline(face))
    }

    pub fn middle(&self, face: FaceId) -> DVec2 {
        centroid(&self.outline(face))
    }

    /// Whether three or more edges meet there, or two ways.
    pub fn is_junction(&self, spot: Spot) -> bool {
        match self.neighbours(spot) {
            [a, b] => self.way_id(spot, *a) != self.way_id(spot, *b),
            _ => true,
        }
    }

    /// The vertex of an end, put into its edge where it has none yet.
    pub fn place(&mut self, end: End) -> Spot {
        match end {
            End::At(spot) => spot,
            End::On(a, b, pos) => self.insert(a, b, pos),
        }
    }

    fn spot(&mut self, pos: DVec2) -> Spot {
        self.spots.push(rounded(pos));
        self.around.push(Vec::new());
        (self.spots.len() - 1) as Spot
    }

    fn join(&mut self, a: Spot, b: Spot, way: WayId) {
        self.way_of.insert(key(a, b), way);
        for (from, to) in [(a, b), (b, a)] {
            if let Some(list) = self.around.get_mut(from as usize) {
                list.push(to);
            }
        }
    }

    /// Puts a vertex into an edge. An edge that is not there stays away, and its first end is given back.
    fn insert(&mut self, a: Spot, b: Spot, pos: DVec2) -> Spot {
        let Some(way) = self.way_of.remove(&key(a, b)) else { return a };
        let spot = self.spot(pos);
        for (from, to) in [(a, b), (b, a)] {
            if let Some(list) = self.around.get_mut(from as usize) {
                list.retain(|&n| n != to);
            }
            if let Some(face) = self.left.remove(&(from, to)) {
                self.left.insert((from, spot), face);
                self.left.insert((spot, to), face);
                if let Some(face) = self.faces.get_mut(face)
                    && let Some(i) = face.ring.iter().position(|&s| s == from)
                {
                    face.ring.insert(i + 1, spot);
                }
            }
        }
        self.join(a, spot, way);
        self.join(spot, b, way);
        spot
    }

    /// Cuts a face in two along a line between two vertices of its ring. Each inner vertex comes with the way of the edge that
    /// leads to it; `last` is the way of the last edge. Gives back the new face, to the right of the line; the old one keeps
    /// what lies to its left. Nothing happens where an end is not on the ring.
    pub fn split(&mut self, face: FaceId, from: Spot, inner: &[(DVec2, WayId)], to: Spot, last: WayId) -> Option<FaceId> {
        let old = self.faces.get(face)?.clone();
        let start = old.ring.iter().position(|&s| s == from)?;
        let end = old.ring.iter().position(|&s| s == to).filter(|&end| end != start)?;
        let n = old.ring.len();
        if inner.is_empty() && self.way_of.contains_key(&key(from, to)) {
            return None;
        }
        let arc = |i: usize, j: usize| -> Vec<Spot> {
            let count = (j + n - i) % n;
            (0..=count).filter_map(|k| old.ring.get((i + k) % n).copied()).collect()
        };
        let (ahead, behind) = (arc(start, end), arc(end, start));
        let line: Vec<Spot> = inner.iter().map(|&(p, _)| self.spot(p)).collect();
        let mut before = from;
        for (&spot, &(_, way)) in line.iter().zip(inner) {
            self.join(before, spot, way);
            before = spot;
        }
        self.join(before, to, last);
        // The line's left is the arc from its end back to its beginning.
        let mut left = behind;
        left.extend(&line);
        let mut right = ahead;
        right.extend(line.iter().rev());
        let new = self.faces.len();
        for (a, b) in ring_edges(&left) {
            self.left.insert((a, b), face);
        }
        for (a, b) in ring_edges(&right) {
            self.left.insert((a, b), new);
        }
        if let Some(slot) = self.faces.get_mut(face) {
            slot.ring = left;
        }
        self.faces.push(Face { ring: right, ..old });
        Some(new)
    }
}

/// Points at which a straight line through `through` crosses a ring, in order along `dir`: the index of the edge, and the
/// point.
pub(super) fn crossings(ring: &[DVec2], through: DVec2, dir: DVec2) -> Vec<(usize, DVec2)> {
    let side = |p: DVec2| dir.perp_dot(p - through) > 0.0;
    let mut found: Vec<(usize, DVec2)> = edges(ring)
        .enumerate()
        .filter(|(_, (a, b))| side(*a) != side(*b))
        .map(|(i, (a, b))| {
            let (da, db) = (dir.perp_dot(a - through), dir.perp_dot(b - through));
            (i, a + (b - a) * (da / (da - db)))
        })
        .collect();
    found.sort_by(|a, b| dir.dot(a.1).total_cmp(&dir.dot(b.1)).then(a.0.cmp(&b.0)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Fabric {
        let border = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)].map(|(x, y)| DVec2::new(x, y));
        Fabric::new(&border, Way { role: Role::Edge, width_m: 0.0, is_main: false })
    }

    #[test]
    fn a_line_makes_two_faces_and_keeps_the_neighbours() {
        let mut fabric = square();
        let way = fabric.add_way(Role::Street(StreetClass::Lane), 6.0, false);
        let west = fabric.place(End::On(3, 0, DVec2::new(0.0, 40.0)));
        let east = fabric.place(End::On(1, 2, DVec2::new(100.0, 60.0)));
        let new = fabric.split(0, west, &[(DVec2::new(50.0, 45.0), way)], east, way).expect("both lie on the ring");
        assert!(fabric.middle(0).y > fabric.middle(new).y, "left of the line lies north");
        assert!((fabric.area_m2(0) + fabric.area_m2(new) - 10_000.0).abs() < 1e-6);
        // A vertex in the line stands in both rings.
        let inner = fabric.neighbours(west).iter().copied().max().expect("the line");
        let mid = fabric.place(End::On(west, inner, DVec2::new(25.0, 42.5)));
        assert!(fabric.ring(0).contains(&mid) && fabric.ring(new).contains(&mid));
        let south = fabric.place(End::On(0, 1, DVec2::new(30.0, 0.0)));
        assert!(fabric.split(new, mid, &[], south, way).is_some());
        assert_eq!(fabric.neighbours(mid).len(), 3);
        for face in 0..fabric.faces.len() {
            for (a, b) in ring_edges(fabric.ring(face)) {
                assert_eq!(fabric.face_left(a, b), Some(face));
            }
        }
    }

    #[test]
    fn crossings_come_in_order_and_in_pairs() {
        let ring: Ring = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 2.0), (0.0, 10.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
        let found = crossings(&ring, DVec2::new(0.0, 5.0), DVec2::X);
        let xs: Vec<f64> = found.iter().map(|c| c.1.x).collect();
        assert_eq!(xs.len(), 4);
        assert!(xs.is_sorted() && xs[0] == 0.0 && xs[3] == 10.0, "{xs:?}");
    }
}
