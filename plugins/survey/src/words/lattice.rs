//! Parallel lines at uneven distances, two ways.

use glam::DVec2;
use veduta_city::Id;
use veduta_city::draw::Draw;

use super::turn;

/// Two sets of parallel lines at right angles.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    centre: DVec2,
    /// Direction of the first set's lines.
    dir: DVec2,
    /// Distances of the first set's lines from the centre, to the left of `dir`, and whether each is an avenue.
    first: Vec<(f64, bool)>,
    /// The same of the second set, whose direction is `dir` turned left.
    second: Vec<(f64, bool)>,
}

/// A line of a lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub through: DVec2,
    pub dir: DVec2,
    pub is_avenue: bool,
}

impl Lattice {
    /// A lattice about a centre to a distance. `gaps_m`: least and greatest distance between lines of the first set and of the
    /// second; `avenue_every` of `u32::MAX`: no avenues.
    pub fn new(centre: DVec2, angle: f64, reach_m: f64, gaps_m: [(f64, f64); 2], avenue_every: u32, draw: Draw) -> Self {
        let set = |which: u64, gaps: (f64, f64)| {
            let draw = draw.part(which);
            let every = i64::from(avenue_every.max(1));
            let mut lines: Vec<(f64, bool)> = Vec::new();
            // From the middle outwards, either way: an avenue through the middle.
            for side in [1.0, -1.0] {
                let (mut at, mut n) = (0.0, 0_i64);
                while at <= reach_m {
                    if n > 0 || side > 0.0 {
                        lines.push((side * at, n % every == 0 && avenue_every < u32::MAX));
                    }
                    let gap = draw.part((n * 2 + i64::from(side > 0.0)).unsigned_abs()).between("gap", gaps.0, gaps.1);
                    at += libm::round(gap * 2.0) / 2.0;
                    n += 1;
                }
            }
            lines.sort_by(|a, b| a.0.total_cmp(&b.0));
            lines
        };
        Self { centre, dir: turn(DVec2::X, angle), first: set(1, gaps_m[0]), second: set(2, gaps_m[1]) }
    }

    /// The lines that cross an outline, first set first.
    pub fn across(&self, outline: &[DVec2]) -> Vec<Line> {
        let mut out = Vec::new();
        for (dir, set) in [(self.dir, &self.first), (self.dir.perp(), &self.second)] {
            let normal = dir.perp();
            let (low, high) = outline
                .iter()
                .map(|p| (*p - self.centre).dot(normal))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
            let within = set.iter().filter(|(s, _)| *s > low && *s < high);
            out.extend(within.map(|&(s, is_avenue)| Line { through: self.centre + normal * s, dir, is_avenue }));
        }
        out
    }

    /// Direction of the first set's lines.
    pub fn dir(&self) -> DVec2 {
        self.dir
    }

    /// A draw of its own for each stage.
    pub fn draw(seed: u64) -> Draw {
        Draw::new(seed, Id(1), "words: lattice")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_their_distances_and_every_third_is_an_avenue() {
        let lattice = Lattice::new(DVec2::ZERO, 0.3, 600.0, [(60.0, 90.0), (100.0, 100.0)], 3, Lattice::draw(5));
        for (set, low, high) in [(&lattice.first, 60.0, 90.0), (&lattice.second, 100.0, 100.0)] {
            assert!(set.windows(2).all(|w| (low..=high + 1e-9).contains(&(w[1].0 - w[0].0))), "{set:?}");
            assert!(set.iter().filter(|l| l.1).count() * 3 >= set.len() - 2);
            assert!(set.contains(&(0.0, true)));
        }
        assert_ne!(lattice.first[1].0 - lattice.first[0].0, lattice.first[2].0 - lattice.first[1].0, "uneven");
    }
}
