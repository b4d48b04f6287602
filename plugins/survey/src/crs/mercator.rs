//! Transverse Mercator by Krüger's series to the fourth order (Karney, "Transverse Mercator with an accuracy of a few
//! nanometers", 2011; a micrometre here), and Web Mercator.

use core::f64::consts::PI;

use glam::DVec2;

use super::datum::Ellipsoid;

/// Radius of Web Mercator's sphere, metres.
const SPHERE_M: f64 = 6_378_137.0;
/// Web Mercator's square ends at this latitude, with a little more for what lies across its edge; radians.
const WEB_LIMIT: f64 = 85.1 * PI / 180.0;
/// Farthest from the central meridian, radians; beyond it the series is no good.
const FARTHEST: f64 = PI / 4.0;

/// Mercator's projection of the sphere, fed with latitudes of the ellipsoid, as web maps have it (EPSG:3857).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WebMercator;

impl WebMercator {
    pub(super) fn forward(self, (lat, lon): (f64, f64)) -> Option<DVec2> {
        (lat.abs() <= WEB_LIMIT).then(|| SPHERE_M * DVec2::new(lon, libm::asinh(libm::tan(lat))))
    }

    pub(super) fn inverse(self, pos: DVec2) -> (f64, f64) {
        (libm::atan(libm::sinh(pos.y / SPHERE_M)), pos.x / SPHERE_M)
    }
}

/// The projection with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TransverseMercator {
    e: f64,
    central: f64,
    /// Radius of the rectifying sphere times the scale on the central meridian, metres.
    radius: f64,
    /// False easting, and false northing less the origin's distance from the equator; metres.
    shift: DVec2,
    to_plane: [f64; 4],
    to_sphere: [f64; 4],
}

impl TransverseMercator {
    /// `origin` is latitude and longitude in degrees.
    pub(super) fn new(ellipsoid: Ellipsoid, origin: (f64, f64), scale: f64, false_m: DVec2) -> Self {
        let n = ellipsoid.f / (2.0 - ellipsoid.f);
        let n2 = n * n;
        let (n3, n4) = (n2 * n, n2 * n2);
        let mut out = Self {
            e: libm::sqrt(ellipsoid.e2()),
            central: origin.1.to_radians(),
            radius: scale * ellipsoid.a / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0),
            shift: false_m,
            to_plane: [
                n / 2.0 - 2.0 / 3.0 * n2 + 5.0 / 16.0 * n3 + 41.0 / 180.0 * n4,
                13.0 / 48.0 * n2 - 3.0 / 5.0 * n3 + 557.0 / 1440.0 * n4,
                61.0 / 240.0 * n3 - 103.0 / 140.0 * n4,
                49_561.0 / 161_280.0 * n4,
            ],
            to_sphere: [
                n / 2.0 - 2.0 / 3.0 * n2 + 37.0 / 96.0 * n3 - n4 / 360.0,
                n2 / 48.0 + n3 / 15.0 - 437.0 / 1440.0 * n4,
                17.0 / 480.0 * n3 - 37.0 / 840.0 * n4,
                4397.0 / 161_280.0 * n4,
            ],
        };
        out.shift.y -= out.plane((origin.0.to_radians(), 0.0)).y * out.radius;
        out
    }

    /// Zone 1 to 60 of the universal system.
    pub(super) fn utm(ellipsoid: Ellipsoid, zone: u32, south: bool) -> Self {
        let north_m = if south { 10_000_000.0 } else { 0.0 };
        Self::new(ellipsoid, (0.0, 6.0 * f64::from(zone) - 183.0), 0.9996, DVec2::new(500_000.0, north_m))
    }

    /// Metres east and north of a latitude and longitude in radians on the ellipsoid.
    pub(super) fn forward(self, (lat, lon): (f64, f64)) -> Option<DVec2> {
        let turns = libm::round((lon - self.central) / (2.0 * PI));
        let east = lon - self.central - turns * 2.0 * PI;
        let pos = self.shift + self.radius * self.plane((lat, east));
        (east.abs() <= FARTHEST && pos.is_finite()).then_some(pos)
    }

    /// Position on the plane of unit radius.
    fn plane(self, (lat, east): (f64, f64)) -> DVec2 {
        let conformal = self.conformal(libm::tan(lat));
        let (sin, cos) = (libm::sin(east), libm::cos(east));
        let north = libm::atan2(conformal, cos);
        let out = libm::asinh(sin / libm::hypot(conformal, cos));
        DVec2::new(out, north) + series(&self.to_plane, DVec2::new(out, north))
    }

    /// Tangent of the conformal latitude of the tangent of a latitude.
    fn conformal(self, tan: f64) -> f64 {
        let secant = libm::hypot(1.0, tan);
        let sigma = libm::sinh(self.e * libm::atanh(self.e * tan / secant));
        tan * libm::hypot(1.0, sigma) - sigma * secant
    }

    /// Latitude and longitude in radians of metres east and north.
    pub(super) fn inverse(self, pos: DVec2) -> Option<(f64, f64)> {
        let plane = (pos - self.shift) / self.radius;
        if !(plane.x.abs() <= 1.0 && plane.y.abs() <= PI / 2.0) {
            return None;
        }
        let sphere = plane - series(&self.to_sphere, plane);
        let (out, cos) = (libm::sinh(sphere.x), libm::cos(sphere.y));
        let conformal = libm::sin(sphere.y) / libm::hypot(out, cos);
        // Newton's rule; the second step is exact to the last digits.
        let flat = 1.0 - self.e * self.e;
        let tan = (0..4).fold(conformal / flat, |tan, _| {
            let now = self.conformal(tan);
            let slope = (1.0 + flat * tan * tan) / (flat * libm::hypot(1.0, tan));
            tan + (conformal - now) / libm::hypot(1.0, now) * slope
        });
        let lon = self.central + libm::atan2(out, cos);
        let lat = libm::atan(tan);
        (lat.is_finite() && lon.is_finite()).then_some((lat, lon))
    }
}

/// Sum of `c[j] sin 2j(y + ix)` as x and y.
fn series(c: &[f64; 4], p: DVec2) -> DVec2 {
    c.iter().zip(1..).fold(DVec2::ZERO, |sum, (&c, j)| {
        let k = 2.0 * f64::from(j);
        let (sin, cos) = (libm::sin(k * p.y), libm::cos(k * p.y));
        sum + c * DVec2::new(cos * libm::sinh(k * p.x), sin * libm::cosh(k * p.x))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_guidance_note_comes_out() {
        // British National Grid, 50°30' N 0°30' E: 577274.99 m east, 69740.50 m north (guidance note 373-7-2).
        let airy = Ellipsoid { a: 6_377_563.396, f: 1.0 / 299.324_964_6 };
        let grid = TransverseMercator::new(airy, (49.0, -2.0), 0.999_601_272, DVec2::new(400_000.0, -100_000.0));
        let geo = (50.5_f64.to_radians(), 0.5_f64.to_radians());
        let pos = grid.forward(geo).unwrap();
        assert!(pos.distance(DVec2::new(577_274.99, 69_740.50)) < 0.02, "{pos}");
        let (lat, lon) = grid.inverse(pos).unwrap();
        assert!((lat - geo.0).abs() < 1e-12 && (lon - geo.1).abs() < 1e-12);
    }
}
