use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Where on Earth plan coordinates (0, 0) lie: WGS 84 latitude and longitude in degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// Degrees north.
    pub lat: f64,
    /// Degrees east.
    pub lon: f64,
}

impl Default for Anchor {
    fn default() -> Self {
        Self { lat: 0.0, lon: 0.0 }
    }
}

/// Semi-major axis of the WGS 84 ellipsoid in metres.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// First eccentricity squared of the WGS 84 ellipsoid.
const ECCENTRICITY_2: f64 = 6.694_379_990_141_317e-3;

impl Anchor {
    /// Metres per degree of longitude and of latitude at the anchor: the ellipsoid's radii of curvature in the prime
    /// vertical and in the meridian.
    fn metres_per_degree(self) -> DVec2 {
        let lat = self.lat.to_radians();
        let (sin, cos) = (libm::sin(lat), libm::cos(lat));
        let w2 = 1.0 - ECCENTRICITY_2 * sin * sin;
        let prime_vertical = SEMI_MAJOR_M / libm::sqrt(w2);
        let meridian = prime_vertical * (1.0 - ECCENTRICITY_2) / w2;
        DVec2::new(prime_vertical * cos, meridian) * (core::f64::consts::PI / 180.0)
    }

    /// Plan position in metres of a place given in degrees. Longitudes are taken the short way round the date line.
    #[must_use]
    pub fn plan_from_geo(self, lat: f64, lon: f64) -> DVec2 {
        let mut east = lon - self.lon;
        if east > 180.0 {
            east -= 360.0;
        } else if east < -180.0 {
            east += 360.0;
        }
        DVec2::new(east, lat - self.lat) * self.metres_per_degree()
    }

    /// Latitude and longitude in degrees of a plan position in metres.
    #[must_use]
    pub fn geo_from_plan(self, plan_pos: DVec2) -> (f64, f64) {
        let degrees = plan_pos / self.metres_per_degree();
        (self.lat + degrees.y, self.lon + degrees.x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_of_latitude_in_prague_is_111_km() {
        let anchor = Anchor { lat: 50.087, lon: 14.421 };
        let north = anchor.plan_from_geo(51.087, 14.421);
        assert!((north.y - 111_230.0).abs() < 20.0, "{north}");
        assert_eq!(north.x, 0.0);
    }

    #[test]
    fn there_and_back_is_the_same_place() {
        let anchor = Anchor { lat: -17.7, lon: 179.99 };
        let p = anchor.plan_from_geo(-17.71, -179.99);
        assert!(p.x > 0.0 && p.x < 3_000.0, "across the date line: {p}");
        let (lat, lon) = anchor.geo_from_plan(p);
        assert!((lat + 17.71).abs() < 1e-9 && (lon - 180.01).abs() < 1e-9);
    }
}
