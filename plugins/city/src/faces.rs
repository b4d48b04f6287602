use std::collections::HashMap;

use crate::holes::adopt_all;
use crate::{GridPolygon, GridPos, GridRing};

/// A directed piece of an area's border: the area lies on its left.
pub type BorderEdge = (GridPos, GridPos);

/// Polygons with connected interiors (as OGC's simple features ask) from the borders of an area: directed edges with the inside on
/// their left, which may meet at vertices, but not cross. Outer rings run counter-clockwise, holes clockwise; holes may touch their
/// outer ring at single vertices. Rings without area are left out.
///
/// Touching is known by vertices alone: where a border touches another in the middle of an edge, that edge needs a vertex there.
/// A hole outside all outer rings is left out, too. Where borders have gaps, each loose end is joined to the nearest loose
/// beginning. Vertices in the middle of straight lines go, unless they are to be kept.
///
/// The work grows a little faster than the number of edges; it ends for any edges.
#[must_use]
pub fn connected_faces(mut edges: Vec<BorderEdge>, keep_collinear: bool) -> Vec<GridPolygon> {
    edges.retain(|(a, b)| a != b);
    let mut ways = Ways::of(&edges);
    let with_gaps_closed;
    if ways.have_gaps() {
        with_gaps_closed = gaps_closed(&edges);
        ways = Ways::of(&with_gaps_closed);
    }
    let mut faces: Vec<GridPolygon> = Vec::new();
    let mut lone: Vec<GridRing> = Vec::new();
    for walk in ways.walks() {
        let mut rings = simple_rings(walk);
        if !keep_collinear {
            rings.iter_mut().for_each(straighten);
        }
        let (outers, holes): (Vec<_>, Vec<_>) = rings.into_iter().partition(|ring| twice_area(ring) > 0);
        let first = faces.len();
        faces.extend(outers.into_iter().map(GridPolygon::simple));
        let own = &mut faces[first..];
        for hole in holes {
            match own {
                [] => lone.push(hole),
                [face] => face.holes.push(hole),
                _ => adopt(own, hole),
            }
        }
    }
    adopt_all(&mut faces, lone);
    faces
}

/// Gives a hole to the smallest of a few faces around it.
fn adopt(faces: &mut [GridPolygon], hole: GridRing) {
    let around = |face: &GridPolygon| {
        let outer = &face.outer;
        let loose = hole.iter().find(|p| !outer.contains(p)).or(hole.first());
        loose.is_some_and(|&p| GridPolygon::simple(outer.clone()).contains(p))
    };
    let smallest = faces.iter_mut().filter(|face| around(face)).min_by_key(|face| twice_area(&face.outer));
    if let Some(face) = smallest {
        face.holes.push(hole);
    }
}

/// A position as a number: greater ones are farther east, or farther north.
fn key(p: GridPos) -> u64 {
    let [x, y] = [p.0, p.1].map(|c| u64::from(c.cast_unsigned() ^ 1 << 31));
    x << 32 | y
}

/// Edges, and those that go on from each.
struct Ways<'a> {
    edges: &'a [BorderEdge],
    /// Where edges begin, and their numbers.
    order: Vec<(u64, usize)>,
    /// Where in that order those that go on from each edge come.
    next: Vec<usize>,
}

impl<'a> Ways<'a> {
    fn of(edges: &'a [BorderEdge]) -> Self {
        let mut order: Vec<(u64, usize)> = edges.iter().map(|edge| key(edge.0)).zip(0..).collect();
        order.sort_unstable();
        let place = |end: u64| order.partition_point(|begin| begin.0 < end);
        let next = edges.iter().map(|edge| place(key(edge.1))).collect();
        Self { edges, order, next }
    }

    /// Whether edges begin elsewhere than they end.
    fn have_gaps(&self) -> bool {
        let mut ends = vec![0; self.order.len()];
        for (&next, edge) in self.next.iter().zip(self.edges) {
            match self.order.get(next) {
                Some(begin) if begin.0 == key(edge.1) => ends[next] += 1,
                _ => return true,
            }
        }
        let mut first = 0;
        self.order.chunk_by(|a, b| a.0 == b.0).any(|same| {
            let has_gap = ends[first] != same.len();
            first += same.len();
            has_gap
        })
    }

    /// The edges that go on from one.
    fn onward(&self, edge: usize) -> impl Iterator<Item = usize> {
        let end = key(self.edges[edge].1);
        self.order[self.next[edge]..].iter().take_while(move |begin| begin.0 == end).map(|begin| begin.1)
    }

    /// Closed walks along all edges that keep the inside on their left and turn as sharply as it allows at each vertex, so that a walk
    /// never leads from one side of a touching to the other.
    fn walks(&self) -> Vec<Walk> {
        let mut is_walked = vec![false; self.edges.len()];
        let mut walks = Vec::new();
        for start in 0..self.edges.len() {
            let mut walk = Walk { ring: GridRing::new(), has_choice: false };
            let mut at = Some(start);
            while let Some(edge) = at.filter(|&edge| !core::mem::replace(&mut is_walked[edge], true)) {
                let (from, to) = self.edges[edge];
                walk.ring.push(from);
                at = self.onward(edge).reduce(|best, way| {
                    walk.has_choice = true;
                    if is_sooner(from, to, self.edges[way].1, self.edges[best].1) { way } else { best }
                });
            }
            if walk.ring.len() > 2 {
                walks.push(walk);
            }
        }
        walks
    }
}

/// A closed walk.
struct Walk {
    ring: GridRing,
    /// Whether more than one edge went on somewhere: where none did, it comes by no vertex twice.
    has_choice: bool,
}

/// The edges, and one from each loose end to the nearest loose beginning: engines that round crossings to the grid may judge a
/// sliver's edge wrongly.
fn gaps_closed(edges: &[BorderEdge]) -> Vec<BorderEdge> {
    let mut ends: Vec<(GridPos, i32)> = edges.iter().flat_map(|&(a, b)| [(a, 1), (b, -1)]).collect();
    ends.sort_unstable_by_key(|end| end.0);
    let mut beginnings = Vec::new();
    let mut loose = Vec::new();
    for same in ends.chunk_by(|a, b| a.0 == b.0) {
        let surplus: i32 = same.iter().map(|end| end.1).sum();
        let list = if surplus > 0 { &mut beginnings } else { &mut loose };
        list.extend(core::iter::repeat_n(same[0].0, surplus.unsigned_abs() as usize));
    }
    let mut closed = edges.to_vec();
    for end in loose {
        let nearest = (0..beginnings.len()).min_by_key(|&i| (dot(end, beginnings[i], beginnings[i]), beginnings[i]));
        if let Some(i) = nearest {
            closed.push((end, beginnings.swap_remove(i)));
        }
    }
    closed
}

/// Whether, turning clockwise about `pivot` from the direction of `from`, one comes by `a` before `b`.
fn is_sooner(from: GridPos, pivot: GridPos, a: GridPos, b: GridPos) -> bool {
    let half = |p: GridPos| {
        let side = cross(pivot, from, p);
        // Just before, on or past half a turn; straight back comes last.
        if side < 0 || (side == 0 && dot(pivot, from, p) < 0) { u8::from(side == 0) } else { 2 + u8::from(side == 0) }
    };
    let (half_a, half_b) = (half(a), half(b));
    if half_a == half_b { cross(pivot, a, b) < 0 } else { half_a < half_b }
}

/// One position as seen from another.
fn off(o: GridPos, p: GridPos) -> (i64, i64) {
    (i64::from(p.0) - i64::from(o.0), i64::from(p.1) - i64::from(o.1))
}

fn product(a: i64, b: i64) -> i128 {
    i128::from(a) * i128::from(b)
}

fn cross(o: GridPos, a: GridPos, b: GridPos) -> i128 {
    let (a, b) = (off(o, a), off(o, b));
    product(a.0, b.1) - product(a.1, b.0)
}

fn dot(o: GridPos, a: GridPos, b: GridPos) -> i128 {
    let (a, b) = (off(o, a), off(o, b));
    product(a.0, b.0) + product(a.1, b.1)
}

fn twice_area(ring: &[GridPos]) -> i128 {
    let Some(&first) = ring.first() else { return 0 };
    ring.windows(2).map(|pair| cross(first, pair[0], pair[1])).sum()
}

/// Whether a walk comes by no vertex twice.
fn is_simple(walk: &[GridPos]) -> bool {
    if walk.len() <= 16 {
        return (1..walk.len()).all(|i| !walk[..i].contains(&walk[i]));
    }
    let mut sorted = walk.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).all(|pair| pair[0] != pair[1])
}

/// Cuts a walk where it comes by a vertex again; leaves out what has no area.
fn simple_rings(Walk { ring: walk, has_choice }: Walk) -> Vec<GridRing> {
    let mut done = Vec::new();
    if !has_choice || is_simple(&walk) {
        done.extend((twice_area(&walk) != 0).then_some(walk));
        return done;
    }
    let mut open = GridRing::new();
    let mut at: HashMap<GridPos, usize> = HashMap::new();
    for p in walk {
        if let Some(&first) = at.get(&p) {
            let loop_: GridRing = open.drain(first..).collect();
            for p in &loop_ {
                at.remove(p);
            }
            done.push(loop_);
        }
        at.insert(p, open.len());
        open.push(p);
    }
    done.push(open);
    done.retain(|ring| twice_area(ring) != 0);
    done
}

/// Drops the vertices of a ring with area in the middle of straight lines.
fn straighten(ring: &mut GridRing) {
    let mut kept = GridRing::new();
    for &p in ring.iter() {
        while let [.., a, b] = kept.as_slice()
            && cross(*a, *b, p) == 0
        {
            kept.pop();
        }
        kept.push(p);
    }
    // The seam between last and first.
    while let [first, second, .., before, last] = *kept.as_slice() {
        if cross(before, last, first) == 0 {
            kept.pop();
        } else if cross(last, first, second) == 0 {
            kept.remove(0);
        } else {
            break;
        }
    }
    *ring = kept;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[(i32, i32)]) -> GridRing {
        points.iter().map(|&(x, y)| GridPos(x, y)).collect()
    }

    /// The faces of rings with the inside on their left.
    fn faces_of(rings: &[GridRing], keep_collinear: bool) -> Vec<GridPolygon> {
        connected_faces(rings.iter().flat_map(|r| crate::ring_edges(r)).collect(), keep_collinear)
    }

    fn areas(faces: &[GridPolygon]) -> Vec<i128> {
        let mut areas: Vec<i128> = faces.iter().map(|f| f.rings().map(|r| twice_area(r)).sum::<i128>() / 2).collect();
        areas.sort_unstable();
        areas
    }

    #[test]
    fn holes_that_touch_each_other_at_their_western_ends_are_both_kept() {
        let rings = [
            ring(&[(0, 0), (11, 0), (11, 11), (0, 11)]),
            ring(&[(1, 1), (1, 2), (8, 3)]),
            ring(&[(1, 2), (1, 6), (2, 10)]),
            ring(&[(1, 2), (5, 5), (6, 5)]),
        ];
        let faces = faces_of(&rings, true);
        assert_eq!(faces.len(), 1);
        assert_eq!(faces[0].holes.len(), 3);
    }

    #[test]
    fn what_does_not_touch_stays_as_it_is() {
        let rings =
            [ring(&[(0, 0), (9, 0), (9, 9), (0, 9)]), ring(&[(2, 2), (2, 4), (4, 4), (4, 2)]), ring(&[(5, 5), (5, 6), (6, 6)])];
        let faces = faces_of(&rings, true);
        assert_eq!((faces.len(), faces[0].holes.len()), (1, 2));
        assert_eq!(faces[0].outer, rings[0]);
    }

    #[test]
    fn squares_that_touch_at_a_corner_are_two_however_they_are_drawn() {
        let apart = [ring(&[(0, 0), (4, 0), (4, 4), (0, 4)]), ring(&[(4, 4), (8, 4), (8, 8), (4, 8)])];
        let in_one = [ring(&[(0, 0), (4, 0), (4, 4), (8, 4), (8, 8), (4, 8), (4, 4), (0, 4)])];
        assert_eq!(areas(&faces_of(&apart, true)), [16, 16]);
        assert_eq!(areas(&faces_of(&in_one, true)), [16, 16]);
    }

    #[test]
    fn a_hole_that_touches_the_outer_ring_once_is_a_hole_however_it_is_drawn() {
        let apart = [ring(&[(0, 0), (8, 0), (8, 8), (0, 8)]), ring(&[(0, 0), (2, 4), (4, 2)])];
        let in_one = [ring(&[(0, 0), (8, 0), (8, 8), (0, 8), (0, 0), (2, 4), (4, 2)])];
        for rings in [&apart[..], &in_one[..]] {
            let faces = faces_of(rings, true);
            assert_eq!((faces.len(), faces[0].holes.len(), areas(&faces)), (1, 1, vec![58]));
        }
    }

    #[test]
    fn holes_in_a_chain_from_side_to_side_cut_the_area_in_two() {
        // Two diamonds that touch each other and the two sides.
        let rings = [
            ring(&[(0, 0), (8, 0), (8, 4), (8, 8), (0, 8), (0, 4)]),
            ring(&[(0, 4), (2, 5), (4, 4), (2, 3)]),
            ring(&[(4, 4), (6, 5), (8, 4), (6, 3)]),
        ];
        let faces = faces_of(&rings, true);
        assert_eq!((areas(&faces), faces.iter().map(|f| f.holes.len()).sum::<usize>()), (vec![28, 28], 0));
    }

    #[test]
    fn an_island_in_a_hole_takes_its_own_hole() {
        let square = |a: i32, b: i32| [(a, a), (b, a), (b, b), (a, b)];
        let hole = |a: i32, b: i32| [(a, a), (a, b), (b, b), (b, a)];
        let rings = [ring(&square(0, 20)), ring(&hole(2, 18)), ring(&square(4, 16)), ring(&hole(6, 14))];
        assert_eq!(areas(&faces_of(&rings, true)), [12 * 12 - 8 * 8, 20 * 20 - 16 * 16]);
    }

    #[test]
    fn straight_lines_lose_their_inner_vertices_if_asked() {
        let rings = [ring(&[(4, 0), (8, 0), (8, 8), (8, 9), (0, 9), (0, 0), (2, 0)])];
        assert_eq!(faces_of(&rings, false)[0].outer.len(), 4);
        assert_eq!(faces_of(&rings, true)[0].outer.len(), 7);
    }

    #[test]
    fn broken_rings_come_to_an_end() {
        let rings = [ring(&[(0, 0), (4, 4), (4, 0), (0, 4), (0, 0), (4, 4)]), ring(&[(1, 1)]), ring(&[])];
        assert!(faces_of(&rings, true).len() < 4);
    }

    #[test]
    fn a_gap_is_closed_where_it_is() {
        let rings = [ring(&[(0, 0), (90, 0), (90, 90), (0, 90)]), ring(&[(20, 20), (20, 40), (40, 40), (40, 20)])];
        let edges: Vec<BorderEdge> = rings.iter().flat_map(|r| crate::ring_edges(r)).collect();
        let whole = areas(&connected_faces(edges.clone(), true));
        for lost in 0..edges.len() {
            let mut edges = edges.clone();
            edges.remove(lost);
            assert_eq!(areas(&connected_faces(edges, true)), whole);
        }
    }

    #[test]
    fn each_of_many_holes_finds_the_face_around_it() {
        // A chessboard of rooms, each with four pillars, the last of which has a room of its own with a pillar.
        let mut rings = Vec::new();
        let mut add = |x: i32, y: i32, side: i32, is_hole: bool| {
            let mut r = ring(&[(x, y), (x + side, y), (x + side, y + side), (x, y + side)]);
            if is_hole {
                r.reverse();
            }
            rings.push(r);
        };
        for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x * 200, y * 200))) {
            add(x, y, 150, false);
            for (dx, dy) in [(10, 10), (60, 10), (10, 60), (60, 60)] {
                add(x + dx, y + dy, 40, true);
            }
            add(x + 65, y + 65, 30, false);
            add(x + 75, y + 75, 10, true);
        }
        let faces = faces_of(&rings, true);
        assert_eq!(faces.len(), 800);
        let holes = |outer: i32| {
            let of = faces.iter().filter(|f| f.outer[0].0 % 200 == outer || f.outer[0].1 % 200 == outer);
            of.map(|f| f.holes.len()).collect::<Vec<_>>()
        };
        assert_eq!((holes(0), holes(65)), (vec![4; 400], vec![1; 400]));
        assert!(areas(&faces).iter().all(|&a| a == 150 * 150 - 4 * 1600 || a == 900 - 100));
    }
}
