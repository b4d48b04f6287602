//! Ellipsoids, and the shift between a datum and WGS 84.

use glam::{DMat3, DVec3};

/// An ellipsoid of revolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ellipsoid {
    /// Semi-major axis, metres.
    pub a: f64,
    /// Flattening.
    pub f: f64,
}

pub(super) const WGS84_ELLIPSOID: Ellipsoid = Ellipsoid { a: 6_378_137.0, f: 1.0 / 298.257_223_563 };
pub(super) const GRS80_ELLIPSOID: Ellipsoid = Ellipsoid { a: 6_378_137.0, f: 1.0 / 298.257_222_101 };
pub(super) const BESSEL: Ellipsoid = Ellipsoid { a: 6_377_397.155, f: 1.0 / 299.152_812_8 };

/// EPSG:5239, "S-JTSK to WGS 84 (5)", the rotations turned to the convention of [`Shift`].
pub(super) const S_JTSK_TO_WGS84: Shift =
    Shift { metres: DVec3::new(572.213, 85.334, 461.94), seconds: DVec3::new(4.9732, 1.529, 5.2484), ppm: 3.5378 };

impl Ellipsoid {
    /// First eccentricity squared.
    pub(super) fn e2(self) -> f64 {
        self.f * (2.0 - self.f)
    }

    /// Geocentric position in metres of a latitude and longitude in radians on the ellipsoid.
    fn geocentric(self, (lat, lon): (f64, f64)) -> DVec3 {
        let (sin, cos) = (libm::sin(lat), libm::cos(lat));
        let n = self.a / libm::sqrt(1.0 - self.e2() * sin * sin);
        DVec3::new(n * cos * libm::cos(lon), n * cos * libm::sin(lon), n * (1.0 - self.e2()) * sin)
    }

    /// Latitude and longitude in radians of a geocentric position near the ellipsoid, after Bowring.
    fn geodetic(self, p: DVec3) -> (f64, f64) {
        let b = self.a * (1.0 - self.f);
        let e2 = self.e2();
        let across = libm::hypot(p.x, p.y);
        let beta = libm::atan2(p.z * self.a, across * b);
        let (sin, cos) = (libm::sin(beta), libm::cos(beta));
        let up = p.z + e2 / (1.0 - e2) * b * sin * sin * sin;
        let lat = libm::atan2(up, across - e2 * self.a * cos * cos * cos);
        (lat, libm::atan2(p.y, p.x))
    }
}

/// Seven parameters from a datum to WGS 84, rotations of the position vector (as `TOWGS84` has them).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shift {
    pub metres: DVec3,
    /// Seconds of arc.
    pub seconds: DVec3,
    /// Parts in a million.
    pub ppm: f64,
}

impl Shift {
    fn matrix(self) -> DMat3 {
        let r = self.seconds * (core::f64::consts::PI / (180.0 * 3600.0));
        let turn = DMat3::from_cols(DVec3::new(1.0, r.z, -r.y), DVec3::new(-r.z, 1.0, r.x), DVec3::new(r.y, -r.x, 1.0));
        turn * (1.0 + self.ppm * 1e-6)
    }
}

/// An ellipsoid, and how it lies to that of WGS 84 if not on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Datum {
    pub ellipsoid: Ellipsoid,
    pub shift: Option<Shift>,
}

impl Datum {
    /// Latitude and longitude in radians on WGS 84 of one on this datum. What lies above or below the ellipsoid moves by
    /// millimetres more.
    pub(super) fn wgs84_from_own(self, own: (f64, f64)) -> (f64, f64) {
        let Some(shift) = self.shift else { return own };
        WGS84_ELLIPSOID.geodetic(shift.matrix() * self.ellipsoid.geocentric(own) + shift.metres)
    }

    /// The way back.
    pub(super) fn own_from_wgs84(self, wgs84: (f64, f64)) -> (f64, f64) {
        let Some(shift) = self.shift else { return wgs84 };
        self.ellipsoid.geodetic(shift.matrix().inverse() * (WGS84_ELLIPSOID.geocentric(wgs84) - shift.metres))
    }
}
