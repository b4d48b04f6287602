//! What places a picture on the ground.

mod affine;
mod geotiff;
mod known;
mod world;

use std::io::Cursor;

use glam::{DMat2, DVec2};
use tiff::decoder::Decoder;
use veduta_city::Anchor;

use crate::crs::{CRS_FIX, Crs};
use crate::error::SurveyError;

pub(crate) use affine::Affine;
pub(crate) use geotiff::tags;
pub use known::KnownPoint;
pub(crate) use world::world_file;

/// Metres a pixel that a street map may have: at the lower end a street is thousands of pixels wide, at the upper a town is
/// one pixel.
const SCALES_M: core::ops::RangeInclusive<f64> = 0.001..=1000.0;
/// Side of the largest picture that is taken as one city, in metres: beyond it the plan's tangent plane is no good.
const LARGEST_M: f64 = 100_000.0;

/// From the pixels of a picture to plan metres and back.
///
/// Pixel positions count from the upper left corner at the pixels' edges: (0, 0) is the corner of the picture, (0.5, 0.5) the
/// middle of its first pixel, (width, height) the lower right corner. Plan positions are metres from the [anchor](Self::anchor),
/// x east and y north.
///
/// ```text
/// metres a pixel ──────────────► plan (0, 0) at the lower left corner, no place on Earth: x = column·m, y = (height − row)·m
/// two known points ─┐
/// world file + CRS ─┼─► anchor at the picture's middle, plan positions around it
/// GeoTIFF tags ─────┘
/// ```
///
/// ```
/// use glam::DVec2;
/// let plain = veduta_survey::Georeference::from_metres_per_pixel("map.png", (400, 300), 0.5)?;
/// assert_eq!(plain.plan_pos(DVec2::new(0.0, 300.0)), DVec2::ZERO);
/// assert_eq!(plain.plan_pos(DVec2::new(10.0, 298.0)), DVec2::new(5.0, 1.0));
/// # Ok::<(), veduta_survey::SurveyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Georeference {
    anchor: Anchor,
    size: (u32, u32),
    way: Way,
    /// The way taken as straight around the picture's middle.
    near: Affine,
}

/// How positions are found.
#[derive(Debug, Clone, PartialEq)]
enum Way {
    /// Straight to a plan that lies nowhere on Earth.
    Scale,
    /// Straight to the plan.
    Known,
    /// By way of a coordinate system.
    Crs(Box<(Affine, Crs)>),
}

impl Georeference {
    /// A picture of which only the scale is known: plan (0, 0) is its lower left corner, and the anchor is left at latitude and
    /// longitude 0. `size` is width and height in pixels; `name` stands in messages.
    ///
    /// # Errors
    /// [`SurveyError::Unplaced`] if the scale is none that a street map can have, or the picture has no pixels.
    pub fn from_metres_per_pixel(name: &str, size: (u32, u32), metres: f64) -> Result<Self, SurveyError> {
        if !SCALES_M.contains(&metres) {
            return Err(off_scale(name, metres));
        }
        let near = Affine {
            origin: DVec2::new(0.0, f64::from(size.1) * metres),
            step: DMat2::from_cols(DVec2::new(metres, 0.0), DVec2::new(0.0, -metres)),
        };
        checked(name, Self { anchor: Anchor::default(), size, way: Way::Scale, near })
    }

    /// A picture of which two points are known: it may be turned, but not stretched. The anchor is its middle.
    ///
    /// # Errors
    /// [`SurveyError::Unplaced`] if the points are too near each other, or what they say of the scale cannot be.
    pub fn from_known_points(name: &str, size: (u32, u32), points: [KnownPoint; 2]) -> Result<Self, SurveyError> {
        let (anchor, near) = known::similarity(name, size, points)?;
        checked(name, Self { anchor, size, way: Way::Known, near })
    }

    /// A picture with a world file (`.pgw`, `.jgw`, `.tfw`, `.wld`), in the coordinate system that the file means but does not
    /// name. The anchor is the picture's middle.
    ///
    /// # Errors
    /// [`SurveyError::Broken`] or [`SurveyError::Cut`] with the world file's line, [`SurveyError::Unplaced`] if it and the
    /// coordinate system do not go together.
    pub fn from_world_file(name: &str, size: (u32, u32), text: &str, crs: &Crs) -> Result<Self, SurveyError> {
        let affine = world_file(text, name)?;
        Self::from_crs(name, size, affine, *crs)
    }

    /// A picture in a TIFF that says where it lies; `None` if it does not. Only the tags are read, not the picture. `crs` is
    /// used where the tags tell a place but no coordinate system.
    ///
    /// # Errors
    /// [`SurveyError::Broken`] if it is no TIFF, [`SurveyError::Unsupported`] if its coordinate system is not read here,
    /// [`SurveyError::Unplaced`] if the tags cannot be right.
    pub fn from_geotiff(name: &str, bytes: &[u8], crs: Option<&Crs>) -> Result<Option<Self>, SurveyError> {
        let broken = |e: tiff::TiffError| SurveyError::Broken { name: name.to_owned(), format: "TIFF", detail: e.to_string() };
        let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(broken)?;
        let size = decoder.dimensions().map_err(broken)?;
        let found = tags(&mut decoder);
        let Some(affine) = found.affine else { return Ok(None) };
        let crs = match (found.crs, crs) {
            (Some(Ok(own)), _) => own,
            (Some(Err(e)), None) => {
                return Err(SurveyError::Unsupported { name: name.to_owned(), feature: e.to_string(), fix: CRS_FIX });
            }
            (_, Some(given)) => *given,
            (None, None) => return Ok(None),
        };
        Self::from_crs(name, size, affine, crs).map(Some)
    }

    fn from_crs(name: &str, size: (u32, u32), affine: Affine, crs: Crs) -> Result<Self, SurveyError> {
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        let middle = DVec2::new(width, height) / 2.0;
        let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
        let off = |pixel: DVec2| {
            let pos = affine.pos(pixel);
            let detail = format!(
                "pixel ({}, {}) comes to ({}, {}), which is no place in {crs}; give the coordinate system that the numbers are in",
                pixel.x, pixel.y, pos.x, pos.y
            );
            SurveyError::Unplaced { name: name.to_owned(), detail }
        };
        for pixel in corners.into_iter().map(DVec2::from).chain([middle]) {
            crs.geo_from_pos(affine.pos(pixel)).ok_or_else(|| off(pixel))?;
        }
        let (lat, lon) = crs.geo_from_pos(affine.pos(middle)).ok_or_else(|| off(middle))?;
        let anchor = Anchor { lat, lon: around(lon) };
        let plan = |pixel: DVec2| {
            let (lat, lon) = crs.geo_from_pos(affine.pos(pixel)).ok_or_else(|| off(pixel))?;
            Ok(anchor.plan_from_geo(lat, lon))
        };
        let (half, down_half) = (DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.5));
        let (east, down) = (plan(middle + half)? - plan(middle - half)?, plan(middle + down_half)? - plan(middle - down_half)?);
        let step = DMat2::from_cols(east, down);
        let near = Affine { origin: plan(middle)? - step * middle, step };
        checked(name, Self { anchor, size, way: Way::Crs(Box::new((affine, crs))), near })
    }

    /// Where plan (0, 0) lies on Earth; latitude and longitude 0 where only the scale is known.
    #[must_use]
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// Width and height of the picture in pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Whether the picture's place on Earth is known, and not only its scale.
    #[must_use]
    pub fn is_placed(&self) -> bool {
        self.way != Way::Scale
    }

    /// Plan position in metres of a pixel position.
    #[must_use]
    pub fn plan_pos(&self, pixel: DVec2) -> DVec2 {
        match &self.way {
            Way::Scale | Way::Known => self.near.pos(pixel),
            Way::Crs(way) => match way.1.geo_from_pos(way.0.pos(pixel)) {
                Some((lat, lon)) => self.anchor.plan_from_geo(lat, lon),
                None => self.near.pos(pixel),
            },
        }
    }

    /// Pixel position of a plan position; may lie outside of the picture.
    #[must_use]
    pub fn pixel_pos(&self, plan_pos: DVec2) -> DVec2 {
        let straight = || self.near.pixel(plan_pos);
        match &self.way {
            Way::Scale | Way::Known => straight(),
            Way::Crs(way) => {
                let (affine, crs) = &**way;
                let (lat, lon) = self.anchor.geo_from_plan(plan_pos);
                crs.pos_from_geo(lat, lon).map_or_else(straight, |pos| affine.pixel(pos))
            }
        }
    }

    /// Metres a pixel, of the side of a square with a pixel's area at the picture's middle.
    #[must_use]
    pub fn metres_per_pixel(&self) -> f64 {
        libm::sqrt(self.near.step.determinant().abs())
    }

    /// Length in metres of a step to the next column and to the next row at the picture's middle. They differ where a map was
    /// drawn in degrees: resample it first if widths are to be measured.
    #[must_use]
    pub fn pixel_size_m(&self) -> DVec2 {
        DVec2::new(self.near.step.x_axis.length(), self.near.step.y_axis.length())
    }
}

/// A longitude within half a turn of Greenwich.
fn around(lon: f64) -> f64 {
    lon - 360.0 * libm::round(lon / 360.0)
}

fn off_scale(name: &str, metres: f64) -> SurveyError {
    let detail = format!("{metres} metres a pixel are no scale of a street map; it lies between 0.001 and 1000");
    SurveyError::Unplaced { name: name.to_owned(), detail }
}

fn checked(name: &str, made: Georeference) -> Result<Georeference, SurveyError> {
    let unplaced = |detail: String| Err(SurveyError::Unplaced { name: name.to_owned(), detail });
    let (size, metres) = (made.size, made.metres_per_pixel());
    if size.0 == 0 || size.1 == 0 {
        return unplaced(format!("a picture of {} x {} pixels has no place", size.0, size.1));
    }
    if !made.near.is_sound() || !SCALES_M.contains(&metres) {
        return Err(off_scale(name, metres));
    }
    let sides = made.pixel_size_m() * DVec2::new(f64::from(size.0), f64::from(size.1));
    if !sides.is_finite() || sides.max_element() > LARGEST_M {
        let (w, h) = (sides.x / 1000.0, sides.y / 1000.0);
        return unplaced(format!(
            "it would cover {w:.0} x {h:.0} km, and one city at most 100; check the scale, or cut a part out"
        ));
    }
    if made.anchor.lat.is_nan() || made.anchor.lat.abs() > 85.0 {
        return unplaced(format!(
            "its middle lies at latitude {}, where no city is; latitude comes before longitude",
            made.anchor.lat
        ));
    }
    Ok(made)
}

#[cfg(test)]
mod tests;
