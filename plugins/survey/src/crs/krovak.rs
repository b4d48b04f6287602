//! The oblique conic projection of Czechia and Slovakia: IOGP guidance note 373-7-2, method 1041 (Krovak, north orientated).

use core::f64::consts::FRAC_PI_4;

use glam::DVec2;

use super::datum::Ellipsoid;

/// Latitude of the centre, 49°30'; longitude of the origin, 24°50' east of Greenwich; co-latitude of the cone's axis,
/// 30°17'17.30311"; latitude of the pseudo standard parallel, 78°30'. Radians.
const CENTRE_LAT: f64 = 49.5 * DEGREE;
const ORIGIN_LON: f64 = (24.0 + 50.0 / 60.0) * DEGREE;
const AXIS: f64 = (30.0 + 17.0 / 60.0 + 17.303_11 / 3600.0) * DEGREE;
const PARALLEL: f64 = 78.5 * DEGREE;
const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// Scale on the pseudo standard parallel.
const SCALE: f64 = 0.9999;
/// No place of the projection's countries lies farther from the cone's apex than this; metres.
const FARTHEST_M: f64 = 5_000_000.0;

/// The projection with its constants, in the notation of the guidance note.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Krovak {
    e: f64,
    b: f64,
    t0: f64,
    n: f64,
    r0: f64,
}

impl Krovak {
    pub(super) fn new(ellipsoid: Ellipsoid) -> Self {
        let e2 = ellipsoid.e2();
        let e = libm::sqrt(e2);
        let (sin, cos) = (libm::sin(CENTRE_LAT), libm::cos(CENTRE_LAT));
        let a = ellipsoid.a * libm::sqrt(1.0 - e2) / (1.0 - e2 * sin * sin);
        let b = libm::sqrt(1.0 + e2 * cos * cos * cos * cos / (1.0 - e2));
        let gamma = libm::asin(sin / b);
        let t0 = libm::tan(FRAC_PI_4 + gamma / 2.0) * libm::pow((1.0 + e * sin) / (1.0 - e * sin), e * b / 2.0)
            / libm::pow(libm::tan(FRAC_PI_4 + CENTRE_LAT / 2.0), b);
        Self { e, b, t0, n: libm::sin(PARALLEL), r0: SCALE * a / libm::tan(PARALLEL) }
    }

    /// Metres east and north (both negative) of a latitude and longitude in radians on the ellipsoid.
    pub(super) fn forward(self, (lat, lon): (f64, f64)) -> Option<DVec2> {
        let v = self.b * (ORIGIN_LON - lon);
        if v.abs() > core::f64::consts::FRAC_PI_3 || lat <= 0.0 {
            return None;
        }
        let stretched = self.t0 * libm::pow(libm::tan(lat / 2.0 + FRAC_PI_4), self.b) / self.squeeze(lat, self.b);
        let u = 2.0 * (libm::atan(stretched) - FRAC_PI_4);
        let t = libm::asin(libm::cos(AXIS) * libm::sin(u) + libm::sin(AXIS) * libm::cos(u) * libm::cos(v));
        let d = libm::asin(libm::cos(u) * libm::sin(v) / libm::cos(t));
        let r = self.r0 * libm::pow(libm::tan(FRAC_PI_4 + PARALLEL / 2.0) / libm::tan(t / 2.0 + FRAC_PI_4), self.n);
        let theta = self.n * d;
        let pos = -r * DVec2::new(libm::sin(theta), libm::cos(theta));
        pos.is_finite().then_some(pos)
    }

    /// Latitude and longitude in radians of metres east and north.
    pub(super) fn inverse(self, pos: DVec2) -> Option<(f64, f64)> {
        let (south, west) = (-pos.y, -pos.x);
        let r = libm::hypot(south, west);
        if !(r > 1.0 && r < FARTHEST_M) {
            return None;
        }
        let d = libm::atan2(west, south) / self.n;
        let t = 2.0 * (libm::atan(libm::pow(self.r0 / r, 1.0 / self.n) * libm::tan(FRAC_PI_4 + PARALLEL / 2.0)) - FRAC_PI_4);
        let u = libm::asin(libm::cos(AXIS) * libm::sin(t) - libm::sin(AXIS) * libm::cos(t) * libm::cos(d));
        let v = libm::asin(libm::cos(t) * libm::sin(d) / libm::cos(u));
        let base = libm::pow(libm::tan(u / 2.0 + FRAC_PI_4) / self.t0, 1.0 / self.b);
        // Each step gains two digits and more: the eccentricity is small.
        let lat = (0..8).fold(u, |lat, _| 2.0 * (libm::atan(base * self.squeeze(lat, 1.0)) - FRAC_PI_4));
        let lon = ORIGIN_LON - v / self.b;
        (lat.is_finite() && lon.is_finite()).then_some((lat, lon))
    }

    /// What the ellipsoid's flattening takes from the isometric latitude.
    fn squeeze(self, lat: f64, power: f64) -> f64 {
        let sin = self.e * libm::sin(lat);
        libm::pow((1.0 + sin) / (1.0 - sin), self.e * power / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::datum::BESSEL;
    use super::*;

    #[test]
    fn the_example_of_the_guidance_note_comes_out() {
        // 50°12'32.442" N, 16°50'59.179" E: southing 1050538.63 m, westing 568991.00 m (guidance note 373-7-2).
        let geo = ((50.0 + 12.0 / 60.0 + 32.442 / 3600.0) * DEGREE, (16.0 + 50.0 / 60.0 + 59.179 / 3600.0) * DEGREE);
        let pos = Krovak::new(BESSEL).forward(geo).unwrap();
        assert!(pos.distance(DVec2::new(-568_990.995, -1_050_538.631)) < 0.01, "{pos}");
        let (lat, lon) = Krovak::new(BESSEL).inverse(pos).unwrap();
        assert!((lat - geo.0).abs() < 1e-11 && (lon - geo.1).abs() < 1e-11);
    }
}
