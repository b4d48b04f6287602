//! The shape of the town's ground.

use core::f64::consts::TAU;

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Id, Ring};

use super::turn;

/// What the border of the ground looks like.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    /// About a circle: radius in metres, and how far it goes in and out with two, three and five lobes.
    Round { radius_m: f64, lobes: [(f64, f64); 3] },
    /// A rectangle: direction of its sides, and half of each.
    Oblong { dir: DVec2, half_m: DVec2 },
}

impl Shape {
    /// About a circle; `uneven` 0 to 1.
    pub fn round(seed: u64, radius_m: f64, uneven: f64) -> Self {
        let draw = Draw::new(seed, Id(2), "words: border");
        let lobe =
            |n: u64, most: f64| (draw.part(n).between("size", 0.3, 1.0) * most * uneven, draw.part(n).between("phase", 0.0, TAU));
        Self::Round { radius_m, lobes: [lobe(2, 0.07), lobe(3, 0.05), lobe(5, 0.025)] }
    }

    /// Distance of the border from the middle in a direction, metres.
    pub fn radius_m(&self, dir: DVec2) -> f64 {
        match *self {
            Self::Round { radius_m, lobes } => {
                let angle = libm::atan2(dir.y, dir.x);
                let bump: f64 =
                    lobes.iter().zip([2.0, 3.0, 5.0]).map(|(&(size, phase), k)| size * libm::cos(k * angle + phase)).sum();
                radius_m * (1.0 + bump)
            }
            Self::Oblong { dir: side, half_m } => {
                let unit = dir.normalize_or(DVec2::X);
                let (u, v) = (unit.dot(side).abs(), unit.dot(side.perp()).abs());
                (half_m.x / u.max(1e-9)).min(half_m.y / v.max(1e-9))
            }
        }
    }

    /// Where a spot lies between the middle (0) and the border (1).
    pub fn share(&self, p: DVec2) -> f64 {
        p.length() / self.radius_m(p).max(1e-9)
    }

    /// Distance of the farthest point of the border from the middle, metres.
    pub fn reach_m(&self) -> f64 {
        self.border().iter().map(|p| p.length()).fold(0.0, f64::max)
    }

    /// The border, counter-clockwise.
    pub fn border(&self) -> Ring {
        match *self {
            Self::Round { radius_m, .. } => {
                let count = libm::round(TAU * radius_m / 28.0).clamp(20.0, 160.0) as usize;
                (0..count)
                    .map(|i| {
                        let dir = turn(DVec2::X, TAU * i as f64 / count as f64);
                        dir * self.radius_m(dir)
                    })
                    .collect()
            }
            Self::Oblong { dir, half_m } => {
                let corner = |x: f64, y: f64| dir * (half_m.x * x) + dir.perp() * (half_m.y * y);
                vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
            }
        }
    }
}
