use core::str::FromStr;

use glam::{DMat2, DVec2};
use veduta_city::Anchor;

use super::Affine;
use crate::SurveyError;

/// Two points nearer than this share of the picture's diagonal say too little: a pixel's error between them turns and
/// stretches the whole picture.
const NEAREST_SHARE: f64 = 0.05;

/// A point of a picture whose place is known. Written `column,row=latitude,longitude`, as in `120,340.5=50.0870,14.4210`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownPoint {
    /// Column and row, at pixel edges from the upper left corner.
    pub pixel: DVec2,
    /// Degrees north.
    pub lat: f64,
    /// Degrees east.
    pub lon: f64,
}

impl FromStr for KnownPoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let pair = |part: &str| -> Option<(f64, f64)> {
            let (a, b) = part.split_once(',')?;
            let number = |t: &str| t.trim().parse::<f64>().ok().filter(|n| n.is_finite());
            Some((number(a)?, number(b)?))
        };
        let found = text.split_once('=').and_then(|(pixel, geo)| Some((pair(pixel)?, pair(geo)?)));
        let Some((pixel, (lat, lon))) = found else {
            return Err(format!("`{text}` is not column,row=latitude,longitude, as in 120,340=50.0870,14.4210"));
        };
        if !(lat.abs() <= 85.0 && lon.abs() <= 180.0) {
            return Err(format!(
                "({lat}, {lon}) is not a latitude within ±85° and a longitude within ±180°; the latitude comes first"
            ));
        }
        Ok(Self { pixel: pixel.into(), lat, lon })
    }
}

/// The anchor at the picture's middle, and the way to the plan that turns and scales so that both points come right.
pub(super) fn similarity(name: &str, size: (u32, u32), points: [KnownPoint; 2]) -> Result<(Anchor, Affine), SurveyError> {
    let size = DVec2::new(f64::from(size.0), f64::from(size.1));
    let unplaced = |detail: String| SurveyError::Unplaced { name: name.to_owned(), detail };
    let apart = points[0].pixel.distance(points[1].pixel);
    if apart.is_nan() || apart < NEAREST_SHARE * size.length() {
        return Err(unplaced(format!(
            "its known points are {apart:.1} pixels apart, too near for the scale; take two at opposite ends of the picture"
        )));
    }
    let first = Anchor { lat: points[0].lat, lon: points[0].lon };
    // Metres differ a little with the latitude they are measured at: the picture's middle, found in two steps, decides.
    let (lat, lon) = first.geo_from_plan(through(first, points).pos(size / 2.0));
    let near = Anchor { lat, lon };
    let is_off = |a: Anchor| !(a.lat.abs() <= 85.0 && a.lon.is_finite());
    if is_off(near) {
        return Err(unplaced("its middle would lie beyond latitude 85°; check the known points".into()));
    }
    let (lat, lon) = near.geo_from_plan(through(near, points).pos(size / 2.0));
    let anchor = Anchor { lat, lon: super::around(lon) };
    if is_off(anchor) {
        return Err(unplaced("its middle would lie beyond latitude 85°; check the known points".into()));
    }
    Ok((anchor, through(anchor, points)))
}

fn through(anchor: Anchor, [a, b]: [KnownPoint; 2]) -> Affine {
    let plan = |p: KnownPoint| anchor.plan_from_geo(p.lat, p.lon);
    // Rows run down; the picture is mirrored before it is turned.
    let up = |p: DVec2| DVec2::new(p.x, -p.y);
    let (pixels, metres) = (up(b.pixel - a.pixel), plan(b) - plan(a));
    let turn = DVec2::new(metres.dot(pixels), pixels.perp_dot(metres)) / pixels.length_squared();
    let step = DMat2::from_cols(turn, DVec2::new(turn.y, -turn.x));
    Affine { origin: plan(a) - step * a.pixel, step }
}
