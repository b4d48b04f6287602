//! What a clock shows at an hour, and how its dial and hands are cut. Angles are radians, clockwise from the top.

use core::f64::consts::{FRAC_PI_2, TAU};

use bevy::math::{Vec2, Vec3};
use veduta_city::{Dial, Rgb};
use veduta_ecs::CityClock;

use crate::sculpt::{Paint, Sculpt};

/// Obliquity of the ecliptic, degrees.
const OBLIQUITY_DEG: f64 = 23.44;
/// Share of a dial's radius within which its plate of the sky lies.
const PLATE: f64 = 0.66;
/// The sun this far below the horizon leaves night behind, degrees.
const NIGHT_DEG: f64 = -18.0;

/// Where a hand, a ring or the sun stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pointing {
    pub angle: f64,
    /// How far from the middle it has been moved, shares of the dial's radius.
    pub out: f64,
}

/// Declination and right ascension of the mean sun, radians.
fn sun(clock: &CityClock) -> (f64, f64) {
    let longitude = TAU * (f64::from(clock.day) + clock.hour / 24.0 - 80.5) / 365.25;
    let tilt = OBLIQUITY_DEG.to_radians();
    ((tilt.sin() * longitude.sin()).asin(), (tilt.cos() * longitude.sin()).atan2(longitude.cos()))
}

/// Where a declination lies on a plate drawn from the north pole (stereographic, as on the clock in Prague): share of the plate's radius,
/// 1 at the northern tropic.
fn circle_of(declination: f64) -> f64 {
    let quarter = core::f64::consts::FRAC_PI_4;
    (quarter + declination / 2.0).tan() / (quarter + OBLIQUITY_DEG.to_radians() / 2.0).tan()
}

/// Middle (upwards) and radius of the circle of an altitude at a latitude, shares of the plate's radius.
pub(crate) fn altitude_circle(lat_deg: f64, altitude_deg: f64) -> (f64, f64) {
    let (lat, altitude) = (lat_deg.clamp(5.0, 85.0).to_radians(), altitude_deg.to_radians());
    let (top, foot) = (circle_of(altitude + lat - FRAC_PI_2), -circle_of(altitude + FRAC_PI_2 - lat));
    ((top + foot) / 2.0, (top - foot) / 2.0)
}

/// How a clock's moving parts stand: of twelve hours the hour's and the minute's hand; of twenty-four the one hand; of an astrolabe the ring
/// of the ecliptic, the hand, and the sun on it.
pub(crate) fn pointings(dial: Dial, clock: &CityClock) -> Vec<Pointing> {
    let hour = clock.hour.rem_euclid(24.0);
    let at = |angle: f64| Pointing { angle: angle.rem_euclid(TAU), out: 0.0 };
    let day = at(TAU * (hour - 12.0) / 24.0);
    match dial {
        Dial::Twelve => vec![at(TAU * hour / 12.0), at(TAU * hour.fract())],
        Dial::TwentyFour => vec![day],
        Dial::Astrolabe => {
            let (declination, ascension) = sun(clock);
            vec![at(day.angle + ascension - FRAC_PI_2), day, Pointing { out: PLATE * circle_of(declination), ..day }]
        }
    }
}

const VERMILION: Rgb = Rgb(0xB0, 0x4A, 0x2E);
const DAY: Rgb = Rgb(0x4E, 0x7F, 0xA6);
const DUSK: Rgb = Rgb(0xB5, 0x68, 0x3C);
const NIGHT: Rgb = Rgb(0x1E, 0x1D, 0x22);
/// How far layers of a dial lie above one another, metres.
const LAYER_M: f32 = 0.012;
const ROUND: usize = 72;

/// Cuts dials: a sculpt, and how large and in which colours.
struct Cutter<'a> {
    sculpt: &'a mut Sculpt,
    radius: f32,
    face: Paint,
    gold: Paint,
}

fn around(share: f32) -> Vec2 {
    let (sin, cos) = (core::f32::consts::TAU * share).sin_cos();
    Vec2::new(sin, cos)
}

impl Cutter<'_> {
    fn at(&self, p: Vec2, layer: f32) -> Vec3 {
        (p * self.radius).extend(layer * LAYER_M)
    }

    /// A disc about a middle, cut off at a circle about the dial's.
    fn disc(&mut self, middle: Vec2, radius: f32, within: f32, layer: f32, paint: Paint) {
        let count = if radius < 0.06 { 14 } else { ROUND };
        let corner = |n: usize| {
            let p = middle + around(n as f32 / count as f32) * Vec2::new(-1.0, 1.0) * radius;
            self.at(if p.length() > within { p.normalize() * within } else { p }, layer)
        };
        let corners: Vec<Vec3> = (0..count).map(corner).collect();
        self.sculpt.face(&corners, paint);
    }

    fn ring(&mut self, middle: Vec2, (inner, outer): (f32, f32), layer: f32, paint: Paint) {
        let edge = |n: usize, radius: f32| paint.at(self.at(middle + around(n as f32 / ROUND as f32) * radius, layer), Vec3::Z);
        let points: Vec<_> = (0..=ROUND).flat_map(|n| [edge(n, outer), edge(n, inner)]).collect();
        self.sculpt.grid(2, points);
    }

    fn stroke(&mut self, from: Vec2, to: Vec2, width: f32, layer: f32, paint: Paint) {
        let across = (to - from).normalize_or_zero().perp() * (width / 2.0);
        let corners = [from - across, to - across, to + across, from + across].map(|p| self.at(p, layer));
        self.sculpt.face(&corners, paint);
    }

    /// A Roman numeral whose foot is turned to the middle, about a point at a share of a round.
    fn numeral(&mut self, text: &str, share: f32, far: f32, height: f32, layer: f32) {
        let wide = |letter: char| if letter == 'I' { 0.30 } else { 0.62 };
        let whole: f32 = text.chars().map(wide).sum::<f32>() * height;
        let out = around(share);
        let right = -out.perp();
        let mut begin = -whole / 2.0;
        let gold = self.gold;
        for letter in text.chars() {
            let width = wide(letter) * height;
            let p = |x: f32, y: f32| out * (far + (y - 0.5) * height) + right * (begin + x * width);
            let (thick, thin) = (0.125 * height, 0.06 * height);
            let strokes: &[((f32, f32), (f32, f32), f32)] = match letter {
                'I' => &[((0.5, 0.0), (0.5, 1.0), thick)],
                'V' => &[((0.08, 1.0), (0.5, 0.0), thick), ((0.5, 0.0), (0.9, 1.0), thin)],
                _ => &[((0.08, 1.0), (0.9, 0.0), thick), ((0.08, 0.0), (0.9, 1.0), thin)],
            };
            for &(from, to, width) in strokes {
                self.stroke(p(from.0, from.1), p(to.0, to.1), width, layer, gold);
                // Serifs.
                for end in [from, to] {
                    if letter == 'V' && end.1 == 0.0 {
                        continue;
                    }
                    let half = 0.085 * height / (wide(letter) * height);
                    self.stroke(p(end.0 - half, end.1), p(end.0 + half, end.1), 0.045 * height, layer, gold);
                }
            }
            begin += width;
        }
    }

    fn numerals(&mut self, count: usize, far: f32, height: f32, layer: f32) {
        const ROMAN: [&str; 12] = ["XII", "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X", "XI"];
        for n in 0..count {
            self.numeral(ROMAN[n % 12], n as f32 / count as f32, far, height, layer);
        }
    }

    fn ticks(&mut self, count: usize, long: usize, (inner, outer): (f32, f32), width: f32, layer: f32) {
        for n in 0..count {
            let (way, is_long) = (around(n as f32 / count as f32), n % long == 0);
            let from = if is_long { inner } else { inner + (outer - inner) * 0.45 };
            self.stroke(way * from, way * outer, if is_long { width * 1.8 } else { width }, layer, self.gold);
        }
    }

    fn twelve(&mut self) {
        let (face, gold) = (self.face, self.gold);
        self.disc(Vec2::ZERO, 1.0, 1.0, 0.0, face);
        self.ring(Vec2::ZERO, (0.965, 1.0), 1.0, gold);
        self.ring(Vec2::ZERO, (0.845, 0.857), 1.0, gold);
        self.ticks(60, 5, (0.865, 0.955), 0.012, 1.0);
        self.numerals(12, 0.71, 0.215, 1.0);
        self.ring(Vec2::ZERO, (0.545, 0.553), 1.0, gold);
        for n in 0..12 {
            let way = around((n as f32 + 0.5) / 12.0);
            self.stroke(way * 0.30, way * 0.5, 0.018, 1.0, gold);
        }
    }

    fn twenty_four(&mut self) {
        let (face, gold) = (self.face, self.gold);
        self.disc(Vec2::ZERO, 1.0, 1.0, 0.0, face);
        self.ring(Vec2::ZERO, (0.975, 1.0), 1.0, gold);
        self.ticks(96, 4, (0.915, 0.968), 0.008, 1.0);
        self.numerals(24, 0.825, 0.125, 1.0);
        self.ring(Vec2::ZERO, (0.735, 0.747), 1.0, gold);
    }

    /// The sky's plate: day, twilight and night at a latitude, with the tropics, the equator and lines of the hours.
    fn plate(&mut self, lat_deg: f64) {
        let plate = PLATE as f32;
        let paint = |colour: Rgb, of: Paint| Paint { colour, shine: 0.15, ..of };
        let face = self.face;
        self.disc(Vec2::ZERO, plate * 1.045, 1.0, 0.6, paint(DAY.scaled(0.8), face));
        self.disc(Vec2::ZERO, plate, plate, 1.0, paint(DAY, face));
        for (altitude_deg, colour, layer) in [(0.0, DUSK, 1.5), (NIGHT_DEG, NIGHT, 2.0)] {
            let (middle, radius) = altitude_circle(lat_deg, altitude_deg);
            self.disc(Vec2::new(0.0, middle as f32 * plate), radius as f32 * plate, plate, layer, paint(colour, face));
        }
        let gold = self.gold;
        for degrees in [-OBLIQUITY_DEG, 0.0, OBLIQUITY_DEG] {
            let r = circle_of(degrees.to_radians()) as f32 * plate;
            self.ring(Vec2::ZERO, (r - 0.006, r + 0.006), 2.5, gold);
        }
        let inner = circle_of(-OBLIQUITY_DEG.to_radians()) as f32 * plate;
        for n in 0..24 {
            let way = around(n as f32 / 24.0);
            self.stroke(way * inner, way * plate, 0.006, 2.5, gold);
        }
        self.disc(Vec2::ZERO, 0.13, 1.0, 2.6, paint(Rgb(0x4B, 0x6F, 0x5E), face));
    }
}

/// Parts of a clock.
pub(crate) struct Cut {
    /// The dial.
    pub dial: Sculpt,
    /// What [`pointings`] moves, in its order, each pointing up.
    pub hands: Vec<Sculpt>,
}

/// Cuts a clock: x to the right of who looks at it, y up, z towards them; metres.
pub(crate) fn cut(dial: Dial, radius_m: f64, (face, gold): (Rgb, Rgb), lat_deg: f64) -> Cut {
    let radius = radius_m as f32;
    let face = Paint { colour: face, shine: 0.1, lit: 1.0 };
    let gold = Paint { colour: gold, shine: 1.0, lit: 1.0 };
    let mut plate = Sculpt::default();
    let mut cutter = Cutter { sculpt: &mut plate, radius, face, gold };
    match dial {
        Dial::Twelve => cutter.twelve(),
        Dial::TwentyFour => cutter.twenty_four(),
        Dial::Astrolabe => {
            cutter.twenty_four();
            cutter.plate(lat_deg);
        }
    }
    let hand = |make: &dyn Fn(&mut Cutter<'_>)| {
        let mut sculpt = Sculpt::default();
        make(&mut Cutter { sculpt: &mut sculpt, radius, face, gold });
        sculpt
    };
    let hands = match dial {
        Dial::Twelve => vec![hand(&|c| pointer(c, 0.52, 0.060, 3.0)), hand(&|c| pointer(c, 0.83, 0.042, 4.0))],
        Dial::TwentyFour => vec![hand(&|c| pointer(c, 0.88, 0.040, 3.0))],
        Dial::Astrolabe => vec![hand(&ecliptic), hand(&|c| pointer(c, 0.90, 0.030, 4.0)), hand(&orb)],
    };
    Cut { dial: plate, hands }
}

/// A hand with a leaf near its tip and a counterweight.
fn pointer(cutter: &mut Cutter<'_>, length: f32, width: f32, layer: f32) {
    let gold = cutter.gold;
    cutter.disc(Vec2::ZERO, width * 1.5, 1.0, layer + 0.3, gold);
    cutter.stroke(Vec2::new(0.0, -length * 0.28), Vec2::new(0.0, length * 0.74), width * 0.62, layer, gold);
    cutter.disc(Vec2::new(0.0, -length * 0.28), width * 0.95, 2.0, layer, gold);
    let leaf = [(0.0, 0.62), (1.0, 0.76), (0.0, 1.0), (-1.0, 0.76)].map(|(x, y)| Vec2::new(x * width * 0.95, y * length));
    let corners = leaf.map(|p| cutter.at(p, layer + 0.2));
    cutter.sculpt.face(&corners, gold);
}

/// The ring of the ecliptic with its twelve signs, the summer solstice farthest up.
fn ecliptic(cutter: &mut Cutter<'_>) {
    let plate = PLATE as f32;
    let (far, near) = (1.0, circle_of(-OBLIQUITY_DEG.to_radians()) as f32);
    let (middle, radius) = (Vec2::new(0.0, (far - near) / 2.0 * plate), (far + near) / 2.0 * plate);
    let gold = cutter.gold;
    let field = Paint { colour: Rgb(0x2F, 0x3A, 0x52), ..cutter.face };
    cutter.ring(middle, (radius - 0.105, radius), 3.2, field);
    for (inner, outer) in [(radius - 0.012, radius), (radius - 0.105, radius - 0.095)] {
        cutter.ring(middle, (inner, outer), 3.4, gold);
    }
    for n in 0..12 {
        let way = around(n as f32 / 12.0);
        cutter.stroke(middle + way * (radius - 0.1), middle + way * radius, 0.008, 3.4, gold);
        let sign = middle + around((n as f32 + 0.5) / 12.0) * (radius - 0.053);
        cutter.disc(sign, 0.022, 2.0, 3.4, gold);
    }
}

/// The sun on its hand.
fn orb(cutter: &mut Cutter<'_>) {
    let gold = cutter.gold;
    for n in 0..16 {
        let way = around(n as f32 / 16.0);
        cutter.stroke(way * 0.04, way * if n % 2 == 0 { 0.085 } else { 0.068 }, 0.012, 5.0, gold);
    }
    cutter.disc(Vec2::ZERO, 0.048, 1.0, 5.3, Paint { colour: Rgb(0xE0, 0xB8, 0x4A), ..gold });
    cutter.disc(Vec2::ZERO, 0.018, 1.0, 5.6, Paint { colour: VERMILION, shine: 0.3, ..gold });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(day: u16, hour: f64) -> CityClock {
        CityClock { day, hour, pace: 0.0 }
    }

    #[test]
    fn hands_stand_as_on_a_clock() {
        let degrees = |dial, hour| pointings(dial, &at(100, hour)).into_iter().map(|p| p.angle.to_degrees()).collect::<Vec<_>>();
        for (hour, told) in [(3.0, [90.0, 0.0]), (15.5, [105.0, 180.0]), (0.0, [0.0, 0.0]), (23.25, [337.5, 90.0])] {
            let found = degrees(Dial::Twelve, hour);
            assert!(found.iter().zip(told).all(|(a, b)| (a - b).abs() < 1e-9), "{hour}: {found:?}");
        }
        for (hour, told) in [(12.0, 0.0), (18.0, 90.0), (0.0, 180.0), (6.0, 270.0)] {
            assert!((degrees(Dial::TwentyFour, hour)[0] - told).abs() < 1e-9, "{hour}");
        }
    }

    #[test]
    fn the_sun_sets_where_the_plate_turns_to_dusk() {
        let lat = 50.087_f64;
        let (middle, radius) = altitude_circle(lat, 0.0);
        for day in [20_u16, 80, 120, 172, 220, 300, 355] {
            // The hour angle of sunset: cos H = −tan φ tan δ.
            let mut hour = 18.0;
            for _ in 0..4 {
                let (declination, _) = sun(&at(day, hour));
                hour = 12.0 + (-lat.to_radians().tan() * declination.tan()).acos() * 12.0 / core::f64::consts::PI;
            }
            let orb = pointings(Dial::Astrolabe, &at(day, hour))[2];
            let (x, y) = (orb.angle.sin() * orb.out / PLATE, orb.angle.cos() * orb.out / PLATE);
            let off = x.hypot(y - middle) - radius;
            assert!(off.abs() < 1e-3, "day {day}, hour {hour}: the sun is {off} off the horizon");
        }
    }

    #[test]
    fn the_sun_stands_on_the_ecliptic() {
        for day in (1..366).step_by(17) {
            for hour in [0.0, 5.3, 12.0, 21.0] {
                let all = pointings(Dial::Astrolabe, &at(day, hour));
                let (far, near) = (1.0, circle_of(-OBLIQUITY_DEG.to_radians()));
                let (out, radius) = ((far - near) / 2.0 * PLATE, (far + near) / 2.0 * PLATE);
                let place = |angle: f64, out: f64| (angle.sin() * out, angle.cos() * out);
                let ((mx, my), (x, y)) = (place(all[0].angle, out), place(all[2].angle, all[2].out));
                assert!(((x - mx).hypot(y - my) - radius).abs() < 1e-9, "day {day}, hour {hour}");
            }
        }
    }

    #[test]
    fn everything_on_a_dial_faces_who_looks_at_it() {
        for dial in [Dial::Twelve, Dial::TwentyFour, Dial::Astrolabe] {
            let Cut { dial: plate, hands } = cut(dial, 1.5, (Rgb(20, 30, 60), Rgb(200, 170, 80)), 50.0);
            assert_eq!(hands.len(), pointings(dial, &CityClock::default()).len());
            for sculpt in core::iter::once(&plate).chain(&hands) {
                assert!(sculpt.points().all(|(p, normal)| normal.z > 0.99 && p.truncate().length() < 1.8), "{dial:?}");
                for [a, b, c] in sculpt.triangles() {
                    assert!((b - a).cross(c - a).z > -1e-6, "{dial:?}: {a} {b} {c}");
                }
            }
            assert!(plate.points().all(|(p, _)| p.truncate().length() <= 1.5 + 1e-4), "{dial:?}: nothing hangs over its rim");
        }
    }
}
