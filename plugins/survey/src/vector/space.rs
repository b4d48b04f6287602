//! From a layer's own coordinates to latitude and longitude.

use glam::DVec2;
use veduta_city::Anchor;

use super::feature::{Content, Named, Shape};
use crate::SurveyError;
use crate::crs::{CRS_FIX, Crs};

/// Where a layer's coordinates lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Space {
    Known(Crs),
    /// Plan metres about an anchor.
    Plan(Anchor),
}

impl Space {
    /// The space of a layer: as it says itself, otherwise degrees, as RFC 7946 has it, if its positions can be that.
    pub(super) fn of(content: &Content, name: &str) -> Result<Self, SurveyError> {
        match &content.crs {
            Some(Named::Plan(anchor)) => Ok(Self::Plan(anchor.unwrap_or_default())),
            // Longitude and latitude on WGS 84 in the words of OGC, and on NAD83.
            Some(Named::Text(text)) if text.contains("CRS84") || text.contains("CRS83") => Ok(Self::Known(Crs::WGS84)),
            Some(Named::Text(text)) => Crs::from_text(text).map(Self::Known).map_err(|error| SurveyError::Unsupported {
                name: name.to_owned(),
                feature: error.to_string(),
                fix: CRS_FIX,
            }),
            None => {
                let positions = || content.features.iter().flat_map(|f| &f.shapes).flat_map(Shape::positions);
                let on_earth = positions().filter(|p| p.x.abs() <= 180.0 && p.y.abs() <= 90.0).count();
                if on_earth * 2 >= positions().count() {
                    return Ok(Self::Known(Crs::WGS84));
                }
                Err(SurveyError::Unsupported {
                    name: name.to_owned(),
                    feature: "coordinates that are no degrees, without a word on their coordinate system".to_owned(),
                    fix: "add the .prj file of the Shapefile or a `crs` member to the GeoJSON, or reproject it to EPSG:4326",
                })
            }
        }
    }

    /// Latitude and longitude in degrees; `None` off the Earth.
    pub(super) fn geo(&self, pos: DVec2) -> Option<(f64, f64)> {
        let (lat, lon) = match self {
            Self::Known(crs) => crs.geo_from_pos(pos)?,
            Self::Plan(anchor) => anchor.geo_from_plan(pos),
        };
        // Some programs count past the date line.
        let lon = if lon > 180.0 {
            lon - 360.0
        } else if lon < -180.0 {
            lon + 360.0
        } else {
            lon
        };
        (lat.abs() <= 90.0 && lon.abs() <= 180.0).then_some((lat, lon))
    }
}

#[cfg(test)]
mod tests {
    use super::super::feature::Feature;
    use super::*;

    fn content(crs: Option<&str>, at: DVec2) -> Content {
        let feature = Feature { shapes: vec![Shape::Points(vec![at])], ..Feature::default() };
        Content { features: vec![feature], crs: crs.map(|c| Named::Text(c.to_owned())), ..Content::default() }
    }

    #[test]
    fn systems_are_told_by_name_and_degrees_by_their_range() {
        let geo = |crs: Option<&str>, x: f64, y: f64| {
            let at = DVec2::new(x, y);
            Space::of(&content(crs, at), "a").unwrap().geo(at).unwrap()
        };
        assert_eq!(geo(None, 14.4, 50.1), (50.1, 14.4));
        assert_eq!(geo(Some("urn:ogc:def:crs:OGC:1.3:CRS84"), 14.4, 50.1), (50.1, 14.4));
        let (lat, lon) = geo(Some("urn:ogc:def:crs:EPSG::3857"), 1_602_980.0, 6_464_000.0);
        assert!((lat - 50.098).abs() < 0.01 && (lon - 14.4).abs() < 0.001, "{lat} {lon}");
        assert_eq!(geo(None, 179.0 + 0.5, 1.0), (1.0, 179.5));
    }

    #[test]
    fn what_is_unknown_is_an_error_that_says_what_to_do() {
        let error = Space::of(&content(None, DVec2::new(-743_000.0, -1_043_000.0)), "town.shp").unwrap_err().to_string();
        assert!(error.contains("town.shp") && error.contains(".prj"), "{error}");
        let error = Space::of(&content(Some("EPSG:31370"), DVec2::ONE), "town.shp").unwrap_err().to_string();
        assert!(error.contains("town.shp") && error.contains("EPSG:31370") && error.contains("reproject"), "{error}");
    }
}
