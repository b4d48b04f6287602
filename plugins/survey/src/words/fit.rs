//! Whether a line may be laid through a face: it must lie within it, leave room beside it, and meet other streets at wide
//! angles.

use glam::DVec2;

use super::fabric::{End, Fabric, FaceId, Spot, ring_edges};
use crate::polygon::{edges, perimeter_m, signed_area};

/// What a line has to keep to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// Width of the street, metres; with half of it, it keeps off half the width of streets that it does not meet.
    pub width_m: f64,
    /// Least distance to other lines but near its ends, metres.
    pub clear_m: f64,
    /// Least area on each side, square metres.
    pub least_m2: f64,
    /// Least width of what lies on each side (twice the area by the perimeter), metres.
    pub least_width_m: f64,
    /// Least angle to other edges at its ends, radians.
    pub least_angle: f64,
    /// Least distance of a new vertex from other junctions, metres.
    pub gap_m: f64,
}

/// How a line divides a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Division {
    pub length_m: f64,
    /// How much larger one side is, as a share of the whole.
    pub uneven: f64,
}

/// A clear distance grows with the distance from the ends at this rate: the sine of the least angle, about.
const OPENING: f64 = 0.5;
/// Lines are looked at every so often; metres.
const STEP_M: f64 = 6.0;
/// An end this close to an inner vertex of a line takes that vertex; metres.
const WELD_M: f64 = 3.0;
/// Most edges at one vertex.
const MOST_EDGES: usize = 5;

impl Fabric {
    /// Where a line that comes to an edge of a face's ring at `pos` should end: at a junction if there is one within the gap.
    pub fn end_near(&self, face: FaceId, edge: usize, pos: DVec2, gap_m: f64) -> Option<End> {
        let ring = self.ring(face);
        let (&a, &b) = (ring.get(edge)?, ring.get((edge + 1) % ring.len().max(1))?);
        let near = |within: f64, is_candidate: &dyn Fn(u32) -> bool| {
            ring.iter()
                .copied()
                .filter(|&s| is_candidate(s))
                .map(|s| (self.pos(s).distance(pos), s))
                .filter(|&(d, _)| d < within)
                .min_by(|x, y| x.0.total_cmp(&y.0))
                .map(|(_, s)| s)
        };
        let junction = near(gap_m, &|s| self.is_junction(s));
        Some(junction.or_else(|| near(WELD_M, &|s| s == a || s == b)).map_or(End::On(a, b, pos), End::At))
    }

    pub fn end_pos(&self, end: End) -> DVec2 {
        match end {
            End::At(spot) => self.pos(spot),
            End::On(_, _, pos) => pos,
        }
    }

    /// Whether a line between two ends on a face's ring fits, and how it divides the face.
    pub fn division(&self, face: FaceId, from: End, inner: &[DVec2], to: End, fit: &Fit) -> Option<Division> {
        if let (End::On(a, b, _), End::On(c, d, _)) = (from, to)
            && (a, b) == (c, d)
        {
            return None;
        }
        let line: Vec<DVec2> = [self.end_pos(from)].into_iter().chain(inner.iter().copied()).chain([self.end_pos(to)]).collect();
        let (first, last) = (line.first().copied()?, line.last().copied()?);
        let (second, before) = (line.get(1).copied()?, line.get(line.len() - 2).copied()?);
        if !self.opens_wide(from, second - first, fit.least_angle) || !self.opens_wide(to, before - last, fit.least_angle) {
            return None;
        }
        let length_m: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
        let (left, right) = self.sides(face, from, inner, to)?;
        for side in [&left, &right] {
            let area = signed_area(side);
            if area < fit.least_m2 || 2.0 * area / perimeter_m(side) < fit.least_width_m {
                return None;
            }
        }
        let outline = self.outline(face);
        if self_crosses(&line) || !has_room(&line, length_m, &outline, fit.clear_m) || !self.keeps_off(face, from, to, &line, fit) {
            return None;
        }
        let (a, b) = (signed_area(&left), signed_area(&right));
        Some(Division { length_m, uneven: (a - b).abs() / (a + b) })
    }

    /// Whether a direction from an end keeps the least angle to every edge there, on both sides of the line it ends at.
    fn opens_wide(&self, end: End, dir: DVec2, least_angle: f64) -> bool {
        let most = libm::cos(least_angle) * dir.length();
        let keeps = |to: DVec2| dir.dot(to) <= most * to.length();
        match end {
            End::On(a, b, pos) => keeps(self.pos(a) - pos) && keeps(self.pos(b) - pos),
            End::At(spot) => {
                let around = self.neighbours(spot);
                around.len() < MOST_EDGES && around.iter().all(|&n| keeps(self.pos(n) - self.pos(spot)))
            }
        }
    }

    /// Whether a line keeps its own width off all streets round the face but those it ends on.
    fn keeps_off(&self, face: FaceId, from: End, to: End, line: &[DVec2], fit: &Fit) -> bool {
        let ring = self.ring(face);
        let met: Vec<bool> = [from, to].into_iter().fold(vec![false; ring.len()], |mut met, end| {
            self.mark_met(ring, end, &mut met);
            met
        });
        ring_edges(ring).zip(met).filter(|(_, met)| !met).all(|((a, b), _)| {
            let width = self.way(a, b).map_or(0.0, |w| w.width_m);
            let need = (fit.width_m + width) / 2.0 + 0.5;
            let edge = (self.pos(a), self.pos(b));
            line.windows(2).all(|w| distance((w[0], w[1]), edge) >= need)
        })
    }

    /// Marks the edges of a ring, by their first vertices, that belong to a street on which a line ends: from its end to the next
    /// junction either way.
    fn mark_met(&self, ring: &[Spot], end: End, met: &mut [bool]) {
        let n = ring.len();
        let (first, last) = match end {
            End::At(spot) => {
                let Some(i) = ring.iter().position(|&s| s == spot) else { return };
                (i, (i + n - 1) % n)
            }
            End::On(a, ..) => {
                let Some(i) = ring.iter().position(|&s| s == a) else { return };
                (i, i)
            }
        };
        for k in 0..n {
            met[(first + k) % n] = true;
            if self.is_junction(ring[(first + k + 1) % n]) {
                break;
            }
        }
        for k in 0..n {
            met[(last + n - k) % n] = true;
            if self.is_junction(ring[(last + n - k) % n]) {
                break;
            }
        }
    }

    /// The rings to the left and right of a line through a face.
    fn sides(&self, face: FaceId, from: End, inner: &[DVec2], to: End) -> Option<(Vec<DVec2>, Vec<DVec2>)> {
        let ring = self.ring(face);
        let mut whole: Vec<(Option<u8>, DVec2)> = Vec::with_capacity(ring.len() + 2);
        let mark = |end: End, spot: u32| matches!(end, End::At(s) if s == spot);
        for &spot in ring {
            let which = if mark(from, spot) { Some(0) } else { mark(to, spot).then_some(1) };
            whole.push((which, self.pos(spot)));
            for (which, end) in [(0, from), (1, to)] {
                if let End::On(a, _, pos) = end
                    && a == spot
                {
                    whole.push((Some(which), pos));
                }
            }
        }
        let at = |which: u8| whole.iter().position(|w| w.0 == Some(which));
        let (start, end, n) = (at(0)?, at(1)?, whole.len());
        let arc = |i: usize, j: usize| -> Vec<DVec2> {
            (0..=(j + n - i) % n).filter_map(|k| whole.get((i + k) % n).map(|w| w.1)).collect()
        };
        let (mut left, mut right) = (arc(end, start), arc(start, end));
        left.extend(inner);
        right.extend(inner.iter().rev());
        Some((left, right))
    }
}

fn self_crosses(line: &[DVec2]) -> bool {
    let pieces: Vec<(DVec2, DVec2)> = line.windows(2).map(|w| (w[0], w[1])).collect();
    pieces.iter().enumerate().any(|(i, &a)| pieces.iter().skip(i + 2).any(|&b| distance(a, b) < STEP_M))
}

/// Whether a line lies within an outline and keeps clear of it: near its ends a share of the distance to the end.
fn has_room(line: &[DVec2], length_m: f64, outline: &[DVec2], clear_m: f64) -> bool {
    let mut gone = 0.0;
    let is_inside = |p: DVec2| {
        let crosses = |&(a, b): &(DVec2, DVec2)| (a.y > p.y) != (b.y > p.y) && ((b - a).perp_dot(p - a) > 0.0) == (b.y > a.y);
        edges(outline).filter(crosses).count() % 2 == 1
    };
    for pair in line.windows(2) {
        let &[a, b] = pair else { continue };
        let piece = a.distance(b);
        let steps = libm::ceil(piece / STEP_M).max(1.0) as usize;
        for step in 0..=steps {
            let t = step as f64 / steps as f64;
            let (p, s) = (a.lerp(b, t), gone + piece * t);
            let need = clear_m.min(OPENING * s.min(length_m - s));
            if s.min(length_m - s) < 1.0 {
                continue;
            }
            let free = edges(outline).map(|(c, d)| distance_to(p, c, d)).fold(f64::INFINITY, f64::min);
            if free < need || !is_inside(p) {
                return false;
            }
        }
        gone += piece;
    }
    true
}

/// Distance of a point from a piece.
pub(super) fn distance_to(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t))
}

/// Distance between two pieces; 0 where they cross.
pub(super) fn distance((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> f64 {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    if side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
        return 0.0;
    }
    distance_to(a, c, d).min(distance_to(b, c, d)).min(distance_to(c, a, b)).min(distance_to(d, a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::fabric::{Role, Way};

    const FIT: Fit = Fit { width_m: 6.0, clear_m: 20.0, least_m2: 500.0, least_width_m: 12.0, least_angle: 0.9, gap_m: 15.0 };

    fn room() -> Fabric {
        let border = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)].map(|(x, y)| DVec2::new(x, y));
        Fabric::new(&border, Way { role: Role::Edge, width_m: 0.0, is_main: false })
    }

    fn on(a: u32, b: u32, x: f64, y: f64) -> End {
        End::On(a, b, DVec2::new(x, y))
    }

    #[test]
    fn a_line_through_the_middle_fits_and_halves() {
        let fabric = room();
        let half = fabric.division(0, on(0, 1, 50.0, 0.0), &[], on(2, 3, 50.0, 100.0), &FIT).expect("there is room");
        assert!(half.uneven < 1e-9 && half.length_m == 100.0);
    }

    #[test]
    fn lines_that_leave_no_room_or_meet_at_a_sharp_angle_do_not_fit() {
        let fabric = room();
        let fits = |from, inner: &[DVec2], to| fabric.division(0, from, inner, to, &FIT).is_some();
        assert!(!fits(on(0, 1, 12.0, 0.0), &[], on(2, 3, 12.0, 100.0)), "too near the west side");
        assert!(!fits(on(0, 1, 90.0, 0.0), &[], on(2, 3, 10.0, 100.0)), "a sharp angle");
        assert!(!fits(on(0, 1, 40.0, 0.0), &[], on(0, 1, 60.0, 0.0)), "both ends on one edge");
        assert!(!fits(on(0, 1, 50.0, 0.0), &[DVec2::new(50.0, 130.0)], on(2, 3, 50.0, 100.0)), "outside");
        assert!(!fits(End::At(0), &[], on(1, 2, 100.0, 30.0)), "a sharp angle at a corner");
    }

    #[test]
    fn an_end_near_a_junction_is_the_junction() {
        let mut fabric = room();
        let way = fabric.add_way(Role::Front, 0.0, false);
        let (a, b) = (fabric.place(on(0, 1, 50.0, 0.0)), fabric.place(on(2, 3, 50.0, 100.0)));
        fabric.split(0, a, &[], b, way);
        let face = fabric.face_left(0, a).expect("west of the line");
        let edge = fabric.ring(face).iter().position(|&s| s == 0).expect("on the ring");
        assert_eq!(fabric.end_near(face, edge, DVec2::new(40.0, 0.0), 15.0), Some(End::At(a)));
        assert_eq!(fabric.end_near(face, edge, DVec2::new(30.0, 0.0), 15.0), Some(End::On(0, a, DVec2::new(30.0, 0.0))));
    }
}
