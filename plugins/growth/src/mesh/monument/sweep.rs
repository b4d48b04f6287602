use glam::{DVec2, DVec3};
use veduta_city::monument::PathPoint;

use super::Mason;
use super::path::line;
use crate::mesh::outline::area;

/// A mitre reaches at most this much farther than its section.
const LONGEST_MITRE: f64 = 4.0;
/// Bends of the line by less than this are drawn round; cosine.
const SMOOTH: f64 = 0.88;

/// A place along a swept line.
struct Station {
    at: DVec2,
    /// Where a metre of reach leads to.
    mitre: DVec2,
    /// Unit normals of the edges before and after, the same where they meet smoothly.
    out: [DVec2; 2],
    along: f64,
}

impl Mason<'_> {
    /// A section of (out, up) along a line in plan, with mitres at its corners.
    pub(super) fn sweep(&mut self, section: &[PathPoint<i32>], along: &[PathPoint<i32>], closed: bool) {
        let section = line(section, false, self.detail.within_m);
        let stations = stations(&line(along, closed, self.detail.within_m), closed);
        if section.len() < 2 || stations.len() < 2 {
            return;
        }
        let place = |s: &Station, p: DVec2| (s.at + s.mitre * p.x).extend(p.y);
        let count = if closed { stations.len() } else { stations.len() - 1 };
        let whole = stations.last().map_or(0.0, |s| s.along);
        for i in 0..count {
            let (a, b) = (&stations[i], &stations[(i + 1) % stations.len()]);
            let end = if b.along > a.along { b.along } else { whole + a.at.distance(b.at) };
            let mut up = 0.0;
            for piece in section.windows(2) {
                let (low, high) = (piece[0], piece[1]);
                let step = (high - low).normalize_or_zero();
                let corners = [place(a, low), place(b, low), place(b, high), place(a, high)];
                if a.out[1].dot(b.out[0]) > 1.0 - 1e-9 {
                    self.face(&corners);
                } else {
                    let normal = |out: DVec2| (out * step.y).extend(-step.x);
                    let uvs = [(a.along, up), (end, up), (end, up + low.distance(high)), (a.along, up + low.distance(high))];
                    let index = [0, 1, 3, 2].map(|k| {
                        let out = if k == 1 || k == 2 { b.out[0] } else { a.out[1] };
                        self.vertex(corners[k], normal(out), DVec2::new(uvs[k].0, -uvs[k].1))
                    });
                    self.mend(2, &index);
                }
                up += low.distance(high);
            }
        }
        if !closed && section.len() > 2 {
            self.ends(&section, &stations);
        }
    }

    fn ends(&mut self, section: &[DVec2], stations: &[Station]) {
        let mut ring: Vec<DVec2> = section.to_vec();
        let is_left = area(&ring) > 0.0;
        if !is_left {
            ring.reverse();
        }
        let mut triangulator = core::mem::take(&mut self.triangulator);
        let ends = [(&stations[0], true), (&stations[stations.len() - 1], false)];
        for (station, is_start) in ends {
            let at = |p: DVec2| (station.at + station.mitre * p.x).extend(p.y);
            triangulator.each(&[ring.clone()], |_, [a, b, c]| {
                let corners: [DVec3; 3] = [a, b, c].map(at);
                self.face(&if is_start { corners } else { [corners[0], corners[2], corners[1]] });
            });
        }
        self.triangulator = triangulator;
    }
}

fn stations(line: &[DVec2], closed: bool) -> Vec<Station> {
    let n = line.len();
    if n < 2 {
        return Vec::new();
    }
    let out = |i: usize| {
        let way = (line[(i + 1) % n] - line[i % n]).normalize_or_zero();
        DVec2::new(way.y, -way.x)
    };
    let mut along = 0.0;
    (0..n)
        .map(|i| {
            along += if i > 0 { line[i].distance(line[i - 1]) } else { 0.0 };
            let (before, after) = match (closed, i) {
                (true, _) => (out(i + n - 1), out(i)),
                (false, 0) => (out(0), out(0)),
                (false, _) if i == n - 1 => (out(n - 2), out(n - 2)),
                (false, _) => (out(i - 1), out(i)),
            };
            let sum = before + after;
            let mitre = sum * (2.0 / sum.length_squared().max(4.0 / (LONGEST_MITRE * LONGEST_MITRE)));
            let out = if before.dot(after) > SMOOTH { [sum.normalize_or(after); 2] } else { [before, after] };
            Station { at: line[i], mitre, out, along }
        })
        .collect()
}
