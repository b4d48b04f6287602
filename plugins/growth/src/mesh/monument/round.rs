use core::f64::consts::PI;

use glam::{DVec2, DVec3};
use veduta_city::metres;

use super::Mason;
use super::path::{chords, unit};

/// Bodies of no more sides than this have edges between them.
const EDGED_TO: usize = 10;
/// Bends of a line by more than this are edges; cosine.
const SHARP: f64 = 0.77;

impl Mason<'_> {
    /// A profile of (radius, height) turned about the upright axis, closed at both ends.
    pub(super) fn turned(&mut self, profile: &[DVec2], sides: Option<i32>) {
        let radius = profile.iter().map(|p| p.x).fold(0.0, f64::max) * self.widest_scale();
        if profile.len() < 2 || radius < 1e-6 {
            return;
        }
        let sides = match sides {
            Some(told) if told >= 3 => told as usize,
            _ => chords(radius, self.detail.within_m).max(EDGED_TO + 2),
        };
        let is_edged = sides <= EDGED_TO;
        // Radii are those of the circle within the sides.
        let reach = if is_edged { 1.0 / libm::cos(PI / sides as f64) } else { 1.0 };
        // From the left end of the side that looks to the front (−y) on, counter-clockwise seen from above.
        let spoke = |i: usize| unit(-PI / 2.0 + 2.0 * PI * ((i % sides) as f64 - 0.5) / sides as f64) * reach;
        let spokes: Vec<DVec2> = (0..=sides).map(spoke).collect();
        for (i, piece) in profile.windows(2).enumerate() {
            let way = (piece[1] - piece[0]).normalize_or_zero();
            if way == DVec2::ZERO || piece.iter().all(|p| p.x < 1e-6) {
                continue;
            }
            let at = |spoke: DVec2, p: DVec2| (spoke * p.x).extend(p.y);
            if is_edged {
                for side in spokes.windows(2) {
                    let corners = [at(side[0], piece[0]), at(side[1], piece[0]), at(side[1], piece[1]), at(side[0], piece[1])];
                    match (piece[0].x < 1e-6, piece[1].x < 1e-6) {
                        (true, _) => self.face(&corners[1..]),
                        (_, true) => self.face(&corners[..3]),
                        _ => self.face(&corners),
                    }
                }
                continue;
            }
            // Smooth where the profile bends little.
            let neighbour = |j: Option<usize>| {
                let other = j.and_then(|j| profile.get(j..j + 2)).map_or(way, |w| (w[1] - w[0]).normalize_or_zero());
                let way = if other.dot(way) > SHARP { (other + way).normalize_or(way) } else { way };
                DVec2::new(way.y, -way.x)
            };
            let normals = [neighbour(i.checked_sub(1)), neighbour(Some(i + 1))];
            let widest = piece[0].x.max(piece[1].x);
            let mut index = Vec::with_capacity(2 * spokes.len());
            for (end, p) in piece.iter().enumerate() {
                for (k, &spoke) in spokes.iter().enumerate() {
                    let normal = (spoke * normals[end].x).extend(normals[end].y);
                    let uv = DVec2::new(2.0 * PI * widest * k as f64 / sides as f64, -(p.y + 0.5 * p.x));
                    index.push(self.vertex(at(spoke, *p), normal, uv));
                }
            }
            self.mend(spokes.len(), &index);
        }
        let ends = [(profile[0], false), (profile[profile.len() - 1], true)];
        for (end, is_up) in ends.into_iter().filter(|(end, _)| end.x > 1e-6) {
            let mut cap: Vec<DVec3> = spokes.iter().take(sides).map(|&s| (s * end.x).extend(end.y)).collect();
            if !is_up {
                cap.reverse();
            }
            self.face(&cap);
        }
    }

    fn widest_scale(&self) -> f64 {
        self.frame.x_axis.length().max(self.frame.y_axis.length())
    }

    /// A ball that lies on the origin.
    pub(super) fn sphere(&mut self, radius: f64) {
        let rings = chords(radius * self.widest_scale(), self.detail.within_m).max(EDGED_TO) / 2;
        let profile: Vec<DVec2> = (0..=rings)
            .map(|i| {
                let angle = PI * i as f64 / rings as f64;
                DVec2::new(radius * libm::sin(angle), radius * (1.0 - libm::cos(angle)))
            })
            .collect();
        self.turned(&profile, None);
    }

    /// A round bar along a line of (x, y, z, radius).
    pub(super) fn tube(&mut self, path: &[[i32; 4]], sides: Option<i32>) {
        let mut points: Vec<(DVec3, f64)> = Vec::with_capacity(path.len());
        for p in path {
            let [x, y, z, radius] = p.map(metres);
            let at = DVec3::new(x, y, z);
            if points.last().is_none_or(|(last, _)| last.distance_squared(at) > 1e-8) {
                points.push((at, radius.max(0.0)));
            }
        }
        let thickest = points.iter().map(|p| p.1).fold(0.0, f64::max) * self.widest_scale();
        if points.len() < 2 || thickest < 1e-6 {
            return;
        }
        let sides = match sides {
            Some(told) if told >= 3 => told as usize,
            _ => chords(thickest, self.detail.within_m).clamp(5, 16),
        };
        let last = points.len() - 1;
        let way = |i: usize| (points[(i + 1).min(last)].0 - points[i.saturating_sub(1)].0).normalize_or(DVec3::Z);
        let mut side = way(0).any_orthonormal_vector();
        let mut index = Vec::with_capacity((sides + 1) * points.len());
        let (mut along, mut rings) = (0.0, Vec::with_capacity(points.len()));
        for (i, &(at, radius)) in points.iter().enumerate() {
            let way = way(i);
            side = (side - way * side.dot(way)).normalize_or(way.any_orthonormal_vector());
            let other = way.cross(side);
            along += if i > 0 { at.distance(points[i - 1].0) } else { 0.0 };
            let spoke = |k: usize| {
                let turned = unit(2.0 * PI * (k % sides) as f64 / sides as f64);
                side * turned.x + other * turned.y
            };
            rings.push((0..sides).map(|k| at + spoke(k) * radius).collect::<Vec<DVec3>>());
            for k in 0..=sides {
                let uv = DVec2::new(2.0 * PI * radius * k as f64 / sides as f64, -along);
                index.push(self.vertex(at + spoke(k) * radius, spoke(k), uv));
            }
        }
        self.mend(sides + 1, &index);
        if points[0].1 > 1e-6 {
            rings[0].reverse();
            self.face(&rings[0]);
        }
        if points[last].1 > 1e-6 {
            self.face(&rings[last]);
        }
    }
}
