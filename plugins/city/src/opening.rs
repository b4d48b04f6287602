//! The bodies of openings: how deep windows and doors lie in their walls, and what stands out about them. Reliefs are built by these
//! figures, and the holes in pictures of openings are painted by them, so that one lies on the other. What is painted about a hole has
//! figures of its own; a test of the workshop holds it to be deep and proud where it is so here.
//!
//! Places are metres in a bay of [`BAY_M`]: x to the right from its left edge, y up from its foot. A wall stretches its bays to its own
//! grid, and the openings with them; depths stay.

use glam::DVec2;

use crate::Opening;

/// Width and height of the bay that openings are designed for, metres.
pub const BAY_M: (f64, f64) = (2.8, 3.4);
/// Middle of a bay.
const MIDDLE: f64 = BAY_M.0 / 2.0;
/// Straight pieces of half an arch.
const HALF_ARC: usize = 4;

/// How an opening ends at the top. Lengths are metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Head {
    /// Straight lintel.
    Flat,
    /// Arc of a circle of a rise.
    Segment(f64),
    /// Half circle.
    Round,
    /// Two arcs whose centres lie so far outside of the opposite feet; 0 is the equilateral Gothic arch.
    Pointed(f64),
}

/// A moulded band about an opening, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// How broad it is.
    pub width_m: f64,
    /// How far it stands out of the wall.
    pub proud_m: f64,
}

/// The hole of an opening in its wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recess {
    /// Lower left corner of the rectangle about it.
    pub low: DVec2,
    /// Upper right corner.
    pub high: DVec2,
    /// How it ends at the top.
    pub head: Head,
    /// How broad its jambs are seen from the front.
    pub jamb_m: f64,
    /// How deep window or door lies behind the wall.
    pub depth_m: f64,
    /// What is laid about it.
    pub surround: Option<Band>,
}

/// Something flat that stands out of the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Its convex outline, counter-clockwise.
    pub outline: &'static [(f64, f64)],
    /// How far it stands out.
    pub proud_m: f64,
}

impl Recess {
    /// Points of the outline from its lower left corner counter-clockwise, moved outwards by so many metres (inwards if negative), but for
    /// the foot, which stays. As many and in the same order for any such distance.
    #[must_use]
    pub fn outline(&self, out_m: f64) -> Vec<DVec2> {
        let (left, right) = (self.low.x - out_m, self.high.x + out_m);
        let (width, cx) = (right - left, (left + right) / 2.0);
        let mut points = vec![DVec2::new(left, self.low.y), DVec2::new(right, self.low.y)];
        let mut arc = |centre: DVec2, radius: f64, from: f64, to: f64, pieces: usize, skip: usize| {
            points.extend((skip..=pieces).map(|i| {
                let angle = from + (to - from) * i as f64 / pieces as f64;
                centre + radius * DVec2::new(libm::cos(angle), libm::sin(angle))
            }));
        };
        use core::f64::consts::{FRAC_PI_2, PI};
        match self.head {
            Head::Flat => points.extend([DVec2::new(right, self.high.y + out_m), DVec2::new(left, self.high.y + out_m)]),
            Head::Segment(rise) => {
                // The circle through the springings and the crown of the opening itself; the band about it keeps its centre.
                let half = (self.high.x - self.low.x) / 2.0;
                let radius = (half * half + rise * rise) / (2.0 * rise);
                let centre = DVec2::new(cx, self.high.y - radius);
                let spread = libm::asin(((width / 2.0) / (radius + out_m)).min(1.0));
                arc(centre, radius + out_m, FRAC_PI_2 - spread, FRAC_PI_2 + spread, 2 * HALF_ARC, 0);
            }
            Head::Round => {
                let springing = self.high.y - (self.high.x - self.low.x) / 2.0;
                arc(DVec2::new(cx, springing), width / 2.0, 0.0, PI, 2 * HALF_ARC, 0);
            }
            Head::Pointed(outside) => {
                let own = self.high.x - self.low.x;
                let run = own / 2.0 + outside;
                let springing = self.high.y - libm::sqrt(((own + outside) * (own + outside) - run * run).max(0.0));
                let radius = own + outside + out_m;
                let crown = libm::acos((run / radius).min(1.0));
                arc(DVec2::new(self.low.x - outside, springing), radius, 0.0, crown, HALF_ARC, 0);
                arc(DVec2::new(self.high.x + outside, springing), radius, PI - crown, PI, HALF_ARC, 1);
            }
        }
        points
    }
}

/// A hole of a width and height whose foot stands at `y`, in the middle of its bay.
const fn hole(y: f64, (width, height): (f64, f64), head: Head, jamb_m: f64, depth_m: f64, surround: Option<Band>) -> Recess {
    let (low, high) = (DVec2::new(MIDDLE - width / 2.0, y), DVec2::new(MIDDLE + width / 2.0, y + height));
    Recess { low, high, head, jamb_m, depth_m, surround }
}

const fn band(width_m: f64, proud_m: f64) -> Option<Band> {
    Some(Band { width_m, proud_m })
}

/// A slab between two heights, in the middle of its bay.
macro_rules! slab {
    ($low:expr, $high:expr, $width:expr, $proud:expr) => {
        Slab {
            outline: &[
                (MIDDLE - $width / 2.0, $low),
                (MIDDLE + $width / 2.0, $low),
                (MIDDLE + $width / 2.0, $high),
                (MIDDLE - $width / 2.0, $high),
            ],
            proud_m: $proud,
        }
    };
}

/// A window's sill.
macro_rules! sill {
    ($top:expr, $width:expr) => {
        slab!($top - 0.085, $top, $width, 0.1)
    };
}

impl Opening {
    /// Its hole in the wall; none where nothing opens.
    #[must_use]
    pub const fn recess(self) -> Option<Recess> {
        use Head::{Flat, Pointed, Round, Segment};
        Some(match self {
            Self::Blank | Self::Clock => return None,
            Self::Window => hole(0.9, (1.1, 1.9), Flat, 0.05, 0.2, band(0.1, 0.02)),
            Self::FramedWindow => hole(0.9, (1.1, 1.88), Flat, 0.05, 0.2, band(0.18, 0.05)),
            Self::CorniceWindow => hole(0.9, (1.1, 1.8), Flat, 0.05, 0.2, band(0.17, 0.05)),
            Self::PedimentWindow => hole(0.9, (1.1, 1.68), Flat, 0.05, 0.2, band(0.17, 0.05)),
            Self::ArchedWindow => hole(0.9, (1.16, 2.02), Round, 0.05, 0.22, band(0.18, 0.05)),
            Self::LancetWindow => hole(0.36, (1.08, 2.5), Pointed(0.0), 0.07, 0.3, band(0.13, 0.03)),
            Self::AtticWindow => hole(1.2, (0.84, 1.16), Flat, 0.05, 0.18, band(0.13, 0.025)),
            Self::WideWindow => hole(0.9, (2.05, 1.65), Flat, 0.035, 0.12, None),
            Self::Slit => hole(0.95, (0.42, 1.5), Flat, 0.13, 0.3, None),
            Self::Portal => hole(0.0, (1.72, 2.88), Round, 0.06, 0.3, band(0.34, 0.07)),
            Self::Door => hole(0.0, (1.16, 2.82), Flat, 0.045, 0.24, band(0.19, 0.05)),
            Self::Shop => hole(0.66, (2.06, 1.76), Flat, 0.02, 0.1, None),
            Self::Arcade => hole(0.0, (1.96, 2.86), Round, 0.05, 0.5, band(0.3, 0.04)),
            Self::Gate => hole(0.0, (2.14, 2.95), Segment(0.42), 0.06, 0.32, band(0.25, 0.05)),
            Self::Belfry => hole(0.55, (1.9, 2.36), Segment(0.46), 0.03, 0.12, None),
        })
    }

    /// What stands out about it besides its surround.
    #[must_use]
    pub const fn slabs(self) -> &'static [Slab] {
        match self {
            Self::Window => &[sill!(0.9, 1.4)],
            Self::FramedWindow => &[sill!(0.9, 1.6)],
            Self::CorniceWindow => &[sill!(0.9, 1.6), slab!(3.05, 3.22, 1.76, 0.18)],
            Self::PedimentWindow => &[
                sill!(0.9, 1.6),
                slab!(2.75, 2.86, 1.78, 0.1),
                Slab { outline: &[(MIDDLE - 0.9, 2.88), (MIDDLE + 0.9, 2.88), (MIDDLE, 3.31)], proud_m: 0.08 },
            ],
            Self::ArchedWindow => &[sill!(0.9, 1.6)],
            Self::LancetWindow => &[sill!(0.36, 1.5)],
            Self::AtticWindow => &[sill!(1.2, 1.14)],
            Self::WideWindow => &[slab!(0.86, 0.91, 2.17, 0.05)],
            Self::Door => &[slab!(3.0, 3.15, 1.72, 0.15)],
            Self::Shop => &[slab!(2.46, 2.93, 2.5, 0.08), slab!(2.94, 3.08, 2.58, 0.14), slab!(0.58, 0.655, 2.22, 0.08)],
            Self::Belfry => &[sill!(0.55, 2.2)],
            Self::Blank | Self::Clock | Self::Slit | Self::Portal | Self::Arcade | Self::Gate => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> impl Iterator<Item = (Opening, Recess)> {
        crate::Tile::all().filter_map(|tile| match tile {
            crate::Tile::Bay(opening) => Some((opening, opening.recess()?)),
            _ => None,
        })
    }

    fn area(points: &[DVec2]) -> f64 {
        (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum::<f64>() / 2.0
    }

    #[test]
    fn outlines_are_convex_and_grow_evenly() {
        for (opening, recess) in all() {
            let rings: Vec<Vec<DVec2>> = [-recess.jamb_m, 0.0, 0.1].iter().map(|&out| recess.outline(out)).collect();
            for ring in &rings {
                let n = ring.len();
                assert_eq!(n, rings[0].len(), "{opening:?}");
                let turns = |i: usize| (ring[(i + 1) % n] - ring[i]).perp_dot(ring[(i + 2) % n] - ring[(i + 1) % n]);
                assert!((0..n).all(|i| turns(i) > -1e-9), "{opening:?} turns right: {ring:?}");
            }
            assert!(area(&rings[0]) < area(&rings[1]) && area(&rings[1]) < area(&rings[2]), "{opening:?}");
            let top = rings[1].iter().map(|p| p.y).fold(0.0, f64::max);
            assert!((top - recess.high.y).abs() < 0.02, "{opening:?} ends at {top}");
        }
    }

    #[test]
    fn all_that_opens_and_stands_out_lies_in_its_bay() {
        for (opening, recess) in all() {
            let reach = recess.outline(recess.surround.map_or(0.0, |band| band.width_m));
            let slabs = opening.slabs().iter().flat_map(|slab| slab.outline).map(|&(x, y)| DVec2::new(x, y));
            for p in reach.into_iter().chain(slabs) {
                assert!((0.0..=BAY_M.0).contains(&p.x) && (0.0..=BAY_M.1).contains(&p.y), "{opening:?} at {p}");
            }
        }
    }
}
