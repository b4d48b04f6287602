//! Convex quadrilaterals, which most houses stand on: two edges shrink to nothing, one after the other, and there is no third event to
//! wait for.

use glam::DVec2;

use super::wavefront::{SAME_M, Wavefront};

impl Wavefront {
    /// What [`Wavefront::shrink`] finds of a convex quadrilateral's corners, counter-clockwise; false where what happens first is not clear,
    /// or they are none.
    pub fn shrink_quad(&mut self, points: &[DVec2; 4]) -> bool {
        self.lay(points, &[4], None);
        let inwards = [0, 1, 2, 3].map(|edge| self.lines.inwards(edge));
        // The edges before and after a corner.
        let pair = |corner: usize| (inwards[(corner + 3) % 4], inwards[corner]);
        let is_convex = (0..4).all(|corner| {
            let (before, after) = pair(corner);
            before.perp_dot(after) > LEAST_TURN
        });
        if !is_convex {
            return false;
        }
        let velocity = [0, 1, 2, 3].map(|corner| {
            let (before, after) = pair(corner);
            (before + after) / (1.0 + before.dot(after))
        });
        let place = [0, 1, 2, 3].map(|corner| self.node_at(corner).truncate());
        let time = [0, 1, 2, 3].map(|edge| {
            let (along, next) = (-inwards[edge].perp(), (edge + 1) % 4);
            let closing = (velocity[edge] - velocity[next]).dot(along);
            if closing > 1e-12 { (place[next] - place[edge]).dot(along) / closing } else { f64::INFINITY }
        });
        let first = (1..4).fold(0, |first, edge| if time[edge] < time[first] { edge } else { first });
        let [second, third, fourth] = [1, 2, 3].map(|more| (first + more) % 4);
        if time[second].min(time[fourth]) - time[first] < SAME_M || !time[third].is_finite() {
            return false;
        }
        // The slower of the two corners of an edge is where it is more surely.
        let closed = |edge: usize| {
            let next = (edge + 1) % 4;
            let slower = if velocity[edge].length_squared() < velocity[next].length_squared() { edge } else { next };
            (place[slower] + velocity[slower] * time[edge]).extend(time[edge])
        };
        let nodes = [closed(first), closed(third)];
        if nodes[0].distance(nodes[1]) < SAME_M {
            return false;
        }
        let (p, q) = (4, 5);
        let number = |edge: usize| edge as u32;
        let (a, b, c, d) = (number(first), number(second), number(third), number(fourth));
        let skeleton = &mut self.skeleton;
        skeleton.nodes.extend(nodes);
        skeleton.corners.clear();
        skeleton.ends.clear();
        for edge in 0..4 {
            match (edge + 4 - first) % 4 {
                0 => skeleton.corners.extend([a, b, p]),
                1 => skeleton.corners.extend([b, c, q, p]),
                2 => skeleton.corners.extend([c, d, q]),
                _ => skeleton.corners.extend([d, a, p, q]),
            }
            skeleton.ends.push(skeleton.corners.len() as u32);
        }
        true
    }
}

/// Sine of the least angle by which its corners turn.
const LEAST_TURN: f64 = 1e-6;
