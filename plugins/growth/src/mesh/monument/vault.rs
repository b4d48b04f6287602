use glam::{DVec2, DVec3};
use veduta_city::monument::Head;

use super::Mason;
use super::path::{chords, head_curve};

impl Mason<'_> {
    /// The underside of a vault about the origin: one barrel along y, or two that cross.
    pub(super) fn vault(&mut self, [width, length]: [f64; 2], rise: f64, head: Head, cross: bool) {
        let (half, reach) = (width / 2.0, length / 2.0);
        if half < 1e-6 || reach < 1e-6 {
            return;
        }
        let n = chords(half.max(rise), self.detail.within_m).clamp(8, 32) / 4 * 4;
        let shares: Vec<f64> = (0..=n).map(|i| -libm::cos(core::f64::consts::PI * i as f64 / n as f64)).collect();
        if cross {
            // Each web spans from the middle to one side.
            self.web(&shares, DVec2::X, half, reach, rise, head);
            self.web(&shares, DVec2::Y, reach, half, rise, head);
            self.web(&shares, -DVec2::X, half, reach, rise, head);
            self.web(&shares, -DVec2::Y, reach, half, rise, head);
            return;
        }
        let mut index = Vec::with_capacity(2 * shares.len());
        for end in [reach, -reach] {
            for (i, &t) in shares.iter().enumerate() {
                let normal = slope(&shares, i, head) * DVec2::new(rise, half);
                let up = along_curve(&shares, i, half, rise, head);
                let at = DVec3::new(half * t, end, rise * head_curve(head, t));
                index.push(self.vertex(at, DVec3::new(normal.x, 0.0, -normal.y), DVec2::new(end, -up)));
            }
        }
        self.mend(shares.len(), &index);
    }

    /// A quarter of a cross vault: the part on the side of `out`, which reaches `far` that way and `wide` to either side.
    fn web(&mut self, shares: &[f64], out: DVec2, far: f64, wide: f64, rise: f64, head: Head) {
        let across = out.perp();
        let mut index = Vec::with_capacity(2 * shares.len());
        for is_wall in [false, true] {
            for (i, &t) in shares.iter().enumerate() {
                let plan = across * (wide * t) + out * (far * if is_wall { 1.0 } else { t.abs() });
                let normal = slope(shares, i, head) * DVec2::new(rise, wide);
                let lean = across * normal.x;
                let up = along_curve(shares, i, wide, rise, head);
                let uv = DVec2::new(plan.dot(out), -up);
                index.push(self.vertex(plan.extend(rise * head_curve(head, t)), lean.extend(-normal.y), uv));
            }
        }
        self.mend(shares.len(), &index);
    }
}

/// Length of the curve up to a sample.
fn along_curve(shares: &[f64], i: usize, half: f64, rise: f64, head: Head) -> f64 {
    let at = |t: f64| DVec2::new(half * t, rise * head_curve(head, t));
    shares[..=i].windows(2).map(|w| at(w[0]).distance(at(w[1]))).sum()
}

/// Inward normal of the unit curve at a sample: across towards the middle where it is steep, and how much downwards.
fn slope(shares: &[f64], i: usize, head: Head) -> DVec2 {
    let (a, b) = (shares[i.saturating_sub(1)], shares[(i + 1).min(shares.len() - 1)]);
    let way = DVec2::new(b - a, head_curve(head, b) - head_curve(head, a)).normalize_or(DVec2::X);
    DVec2::new(way.y, way.x)
}
