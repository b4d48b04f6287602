//! Coordinate reference systems of terrain models, scanned maps and vector maps: which they are, and the way to latitude and
//! longitude and back.
//!
//! Own formulas (a page each, from IOGP's guidance note 373-7-2 and Karney 2011) over `libm`, because every crate tried calls
//! the platform's trigonometry, which would make the same map give other bytes elsewhere: `proj4rs` 0.2 (also without any
//! reading of EPSG codes, WKT or GeoTIFF keys, which is the larger half of the work here), `geodesy`, and bindings to PROJ,
//! which are not Rust.

mod datum;
mod krovak;
mod mercator;
mod wkt;

use core::fmt;

use glam::DVec2;

use datum::{BESSEL, Datum, GRS80_ELLIPSOID, S_JTSK_TO_WGS84, WGS84_ELLIPSOID};
use krovak::Krovak;
use mercator::{TransverseMercator, WebMercator};

/// A coordinate reference system: what the numbers in a file mean.
///
/// Read from EPSG codes 4326, 4258, 4269 (degrees), 3857, 32601–32660 and 32701–32760 (UTM), 25828–25838 (UTM of ETRS89),
/// 26901–26923 (UTM of NAD83) and 5514 with its older name 102067 (S-JTSK / Krovak East North); of WKT also any transverse
/// Mercator on a datum that lies on WGS 84 or whose WKT says how it is shifted (`TOWGS84`).
///
/// Positions are x east, y north in the system's own unit; in degrees x is the longitude, as all raster and vector files have
/// it, whatever order the register prescribes.
///
/// ETRS89 and NAD83 are taken as WGS 84 (they differ by less than 1.5 m). S-JTSK is shifted by the seven parameters of
/// EPSG:5239, good to 1 m in Czechia; in Slovakia they are up to 2.5 m off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crs {
    projection: Projection,
    datum: Datum,
    /// Metres in a unit of a projected system.
    unit_m: f64,
    /// Code of the register, 0 if it has none.
    epsg: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Projection {
    Degrees,
    WebMercator(WebMercator),
    TransverseMercator(TransverseMercator),
    Krovak(Krovak),
}

/// Why a coordinate reference system is not known.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CrsError {
    /// A code that is not read here.
    #[error("the coordinate system EPSG:{0}")]
    Code(u32),
    /// Well-known text of something that is not read here.
    #[error("a coordinate system with {0}")]
    Part(String),
    /// Text that is neither a code nor WKT.
    #[error("a coordinate system that is said by neither an EPSG code nor WKT (it begins \"{0}\")")]
    Text(String),
}

/// What to do about a [`CrsError`].
pub(crate) const CRS_FIX: &str =
    "reproject it to EPSG:4326, 3857, a UTM zone or 5514 (gdalwarp -t_srs EPSG:4326, or ogr2ogr for a vector map)";

impl Crs {
    /// Latitude and longitude on WGS 84, in degrees (EPSG:4326).
    pub const WGS84: Self =
        Self { projection: Projection::Degrees, datum: Datum { ellipsoid: WGS84_ELLIPSOID, shift: None }, unit_m: 1.0, epsg: 4326 };

    /// The system with a code of the EPSG register (or 102067, Esri's older name of 5514).
    ///
    /// # Errors
    /// [`CrsError::Code`] if it is none of those read here.
    pub fn from_epsg(code: u32) -> Result<Self, CrsError> {
        let (wgs84, grs80) = (WGS84_ELLIPSOID, GRS80_ELLIPSOID);
        let utm = |ellipsoid, zone: u32, south| Self {
            projection: Projection::TransverseMercator(TransverseMercator::utm(ellipsoid, zone, south)),
            datum: Datum { ellipsoid, shift: None },
            ..Self::WGS84
        };
        let crs = match code {
            4326 => Self::WGS84,
            4258 | 4269 => Self { datum: Datum { ellipsoid: grs80, shift: None }, ..Self::WGS84 },
            3857 => Self { projection: Projection::WebMercator(WebMercator), ..Self::WGS84 },
            5514 | 102_067 => {
                let datum = Datum { ellipsoid: BESSEL, shift: Some(S_JTSK_TO_WGS84) };
                Self { projection: Projection::Krovak(Krovak::new(BESSEL)), datum, ..Self::WGS84 }
            }
            32_601..=32_660 => utm(wgs84, code - 32_600, false),
            32_701..=32_760 => utm(wgs84, code - 32_700, true),
            25_828..=25_838 => utm(grs80, code - 25_800, false),
            26_901..=26_923 => utm(grs80, code - 26_900, false),
            _ => return Err(CrsError::Code(code)),
        };
        Ok(Self { epsg: code, ..crs })
    }

    /// The system that a text names: what stands in a `.prj` file. Either WKT (version 1 in OGC's or Esri's words, or 2), or a
    /// code, as in `EPSG:5514`, `epsg 32633` or `urn:ogc:def:crs:EPSG::25833`; what follows a code is passed over.
    ///
    /// # Errors
    /// [`CrsError`] if it names nothing that is read here.
    pub fn from_text(text: &str) -> Result<Self, CrsError> {
        let text = text.trim_start_matches('\u{FEFF}').trim();
        if let Some(code) = code_in(text) {
            return Self::from_epsg(code);
        }
        match wkt::parse(text) {
            Some(tree) => wkt::crs_of(&tree),
            None => Err(CrsError::Text(text.chars().take(40).collect())),
        }
    }

    /// A transverse Mercator of its own parameters; degrees, and lengths in the unit of `unit_m` metres.
    fn transverse_mercator(datum: Datum, unit_m: f64, origin: (f64, f64), scale: f64, false_m: DVec2) -> Self {
        let projection = TransverseMercator::new(datum.ellipsoid, origin, scale, false_m);
        Self { projection: Projection::TransverseMercator(projection), datum, unit_m, epsg: 0 }
    }

    /// A transverse Mercator on WGS 84, for GeoTIFF's own parameters: the origin in degrees (latitude, longitude), false
    /// easting and northing in metres.
    pub(crate) fn user_transverse_mercator(origin: (f64, f64), scale: f64, false_m: DVec2, unit_m: f64) -> Self {
        Self::transverse_mercator(Self::WGS84.datum, unit_m, origin, scale, false_m)
    }

    /// The same system in a unit of so many metres; without effect on degrees.
    pub(crate) fn in_units_of(self, unit_m: f64) -> Self {
        Self { unit_m, ..self }
    }

    /// Whether positions are degrees of longitude and latitude.
    #[must_use]
    pub fn is_degrees(&self) -> bool {
        self.projection == Projection::Degrees
    }

    /// WGS 84 latitude and longitude in degrees of a position in this system; `None` where the system has no such position.
    #[must_use]
    pub fn geo_from_pos(&self, pos: DVec2) -> Option<(f64, f64)> {
        let is_plain = self.is_degrees() && self.datum.shift.is_none();
        let own = match self.projection {
            _ if is_plain => return (pos.y.abs() <= 90.0 && pos.x.abs() <= 540.0).then_some((pos.y, pos.x)),
            Projection::Degrees => (pos.y.to_radians(), pos.x.to_radians()),
            Projection::WebMercator(p) => p.inverse(pos * self.unit_m),
            Projection::TransverseMercator(p) => p.inverse(pos * self.unit_m)?,
            Projection::Krovak(p) => p.inverse(pos * self.unit_m)?,
        };
        let (lat, lon) = self.datum.wgs84_from_own(own);
        let (lat, lon) = (lat.to_degrees(), lon.to_degrees());
        (lat.abs() <= 90.0 && lon.abs() <= 540.0).then_some((lat, lon))
    }

    /// Position in this system of a WGS 84 latitude and longitude in degrees; `None` where the system does not reach.
    #[must_use]
    pub fn pos_from_geo(&self, lat: f64, lon: f64) -> Option<DVec2> {
        if !(lat.abs() <= 90.0 && lon.abs() <= 540.0) {
            return None;
        }
        if self.is_degrees() && self.datum.shift.is_none() {
            return Some(DVec2::new(lon, lat));
        }
        let own = self.datum.own_from_wgs84((lat.to_radians(), lon.to_radians()));
        let pos = match self.projection {
            Projection::Degrees => return Some(DVec2::new(own.1.to_degrees(), own.0.to_degrees())),
            Projection::WebMercator(p) => p.forward(own)?,
            Projection::TransverseMercator(p) => p.forward(own)?,
            Projection::Krovak(p) => p.forward(own)?,
        };
        Some(pos / self.unit_m)
    }
}

impl fmt::Display for Crs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.epsg, self.projection) {
            (0, Projection::Degrees) => f.write_str("degrees"),
            (0, Projection::TransverseMercator(_)) => f.write_str("a transverse Mercator"),
            (0, Projection::Krovak(_)) => f.write_str("Krovak"),
            (0, Projection::WebMercator(_)) => f.write_str("Web Mercator"),
            (code, _) => write!(f, "EPSG:{code}"),
        }
    }
}

/// The code that a text names at its beginning, if it is no WKT.
fn code_in(text: &str) -> Option<u32> {
    let lower: String = text.chars().take(60).collect::<String>().to_ascii_lowercase();
    let rest = ["urn:ogc:def:crs:", "http://www.opengis.net/def/crs/", "+init="]
        .iter()
        .fold(lower.as_str(), |t, p| t.strip_prefix(p).unwrap_or(t));
    let rest = rest.strip_prefix("epsg").or_else(|| rest.strip_prefix("esri")).unwrap_or(rest);
    let digits = rest.trim_start_matches([':', '/', ' ', '0', '.']);
    let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    digits.get(..end)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn crs(code: u32) -> Crs {
        Crs::from_epsg(code).unwrap()
    }

    /// Places whose positions PROJ 9.5 gives; for 5514 by the operation EPSG:5239.
    const PLACES: &[(u32, f64, f64, f64, f64)] = &[
        (5514, 50.0909, 14.4005, -744_228.682, -1_042_431.782),
        (5514, 49.1951, 16.6068, -598_248.741, -1_160_744.683),
        (5514, 49.8209, 18.2625, -472_181.920, -1_103_062.834),
        (102_067, 50.0796, 12.3740, -887_793.069, -1_021_916.753),
        (5514, 48.9747, 14.4743, -755_831.383, -1_166_139.105),
        (32_633, 50.0909, 14.4005, 457_116.789, 5_548_909.553),
        (32_633, 48.0, 12.1, 283_682.608, 5_320_370.154),
        (32_733, -33.9, 14.4005, 444_572.299, 6_248_769.997),
        (32_733, -10.0, 12.1, 182_044.572, 8_893_189.343),
        (25_833, 50.0909, 14.4005, 457_116.789, 5_548_909.553),
        (32_617, 43.642_566_7, -79.387_138_9, 630_084.31, 4_833_438.55),
        (3857, 50.0909, 14.4005, 1_603_056.327, 6_462_033.027),
        (3857, 48.0, 12.1, 1_346_965.839, 6_106_854.835),
        (4326, 50.0909, 14.4005, 14.4005, 50.0909),
        (4269, 45.5231, -122.6765, -122.6765, 45.5231),
    ];

    #[test]
    fn known_places_lie_where_proj_says_there_and_back() {
        for &(code, lat, lon, x, y) in PLACES {
            let pos = crs(code).pos_from_geo(lat, lon).unwrap();
            let tolerance_m = 0.02;
            assert!(pos.distance(DVec2::new(x, y)) < tolerance_m, "EPSG:{code}: {pos} is not ({x}, {y})");
            let (back_lat, back_lon) = crs(code).geo_from_pos(pos).unwrap();
            assert!((back_lat - lat).abs() < 1e-7 && (back_lon - lon).abs() < 1e-7, "EPSG:{code}: {back_lat}, {back_lon}");
        }
    }

    #[test]
    fn codes_are_found_in_every_way_they_are_written() {
        for text in
            ["EPSG:5514 (S-JTSK / Krovak East North)", "\u{FEFF}epsg:5514\n", "5514", "urn:ogc:def:crs:EPSG::5514", "ESRI:102067"]
        {
            assert!(matches!(Crs::from_text(text).unwrap().projection, Projection::Krovak(_)), "{text}");
        }
        assert_eq!(Crs::from_text("EPSG:2065"), Err(CrsError::Code(2065)));
        assert!(matches!(Crs::from_text("Gauss-Boaga"), Err(CrsError::Text(_))));
        assert!(matches!(Crs::from_text(""), Err(CrsError::Text(_))));
    }

    #[test]
    fn places_where_a_system_does_not_reach_are_none() {
        assert_eq!(crs(3857).pos_from_geo(89.0, 0.0), None);
        assert_eq!(crs(32_633).pos_from_geo(10.0, 160.0), None);
        assert_eq!(crs(4326).geo_from_pos(DVec2::new(14.0, 91.0)), None);
        for code in [4326, 3857, 32_633, 5514] {
            assert_eq!(crs(code).pos_from_geo(f64::NAN, 14.0), None);
            for wild in [f64::NAN, f64::INFINITY, 1e300, -1e18] {
                let geo = crs(code).geo_from_pos(DVec2::new(wild, wild));
                assert!(geo.is_none_or(|(lat, lon)| lat.is_finite() && lon.is_finite()), "EPSG:{code} of {wild}: {geo:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn there_and_back_is_the_same_place(lat in 47.7f64..51.1, lon in 12.0f64..18.9) {
            for code in [4258, 3857, 32_633, 25_833, 5514] {
                let pos = crs(code).pos_from_geo(lat, lon).unwrap();
                let (a, o) = crs(code).geo_from_pos(pos).unwrap();
                // A millimetre.
                prop_assert!((a - lat).abs() < 1e-8 && (o - lon).abs() < 1e-8, "EPSG:{}: {} {}", code, a - lat, o - lon);
            }
        }
    }
}
