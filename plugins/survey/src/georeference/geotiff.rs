//! Where a TIFF says it lies: OGC 19-008, GeoTIFF 1.1.

use std::io::{Read, Seek};

use glam::DVec2;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::affine::Affine;
use crate::crs::{Crs, CrsError};

/// Keys of the directory that are read.
mod key {
    pub const MODEL: u16 = 1024;
    pub const RASTER: u16 = 1025;
    pub const CITATION: u16 = 1026;
    pub const GEODETIC: u16 = 2048;
    pub const PROJECTED: u16 = 3072;
    pub const PROJECTED_CITATION: u16 = 3073;
    pub const METHOD: u16 = 3075;
    pub const LINEAR_UNIT: u16 = 3076;
    pub const LINEAR_UNIT_SIZE: u16 = 3077;
    pub const ORIGIN_LON: u16 = 3080;
    pub const ORIGIN_LAT: u16 = 3081;
    pub const FALSE_EAST: u16 = 3082;
    pub const FALSE_NORTH: u16 = 3083;
    pub const SCALE: u16 = 3092;
    pub const VERTICAL_UNIT: u16 = 4099;
}

/// "Of its own definition" in place of a code.
const USER_DEFINED: u32 = 32_767;
/// More keys than this are not looked at.
const MOST_KEYS: usize = 256;

/// What a TIFF says of its place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GeoTags {
    /// From pixel edges to the system's positions, if said.
    pub affine: Option<Affine>,
    /// The coordinate system, if said.
    pub crs: Option<Result<Crs, CrsError>>,
    /// Metres in a unit of height.
    pub height_unit_m: f64,
}

/// One key's value.
#[derive(Debug, Clone, PartialEq)]
enum Value {
    Short(u16),
    Double(f64),
    Text(String),
}

/// The keys of a TIFF in the order of its directory.
#[derive(Debug, Default)]
struct Keys(Vec<(u16, Value)>);

impl Keys {
    fn get(&self, key: u16) -> Option<&Value> {
        self.0.iter().find(|(k, _)| *k == key).map(|(_, v)| v)
    }

    fn code(&self, key: u16) -> Option<u32> {
        self.get(key).and_then(|v| if let Value::Short(code) = v { Some(u32::from(*code)) } else { None })
    }

    fn double(&self, key: u16) -> Option<f64> {
        self.get(key).and_then(|v| if let Value::Double(x) = v { Some(*x) } else { None })
    }

    fn text(&self, key: u16) -> Option<&str> {
        self.get(key).and_then(|v| if let Value::Text(t) = v { Some(t.as_str()) } else { None })
    }
}

/// The tags of a TIFF's first picture.
pub(crate) fn tags<R: Read + Seek>(decoder: &mut Decoder<R>) -> GeoTags {
    let keys = keys(decoder);
    let is_point = keys.code(key::RASTER) == Some(2);
    GeoTags {
        affine: affine(decoder, is_point).filter(Affine::is_sound),
        crs: crs(&keys),
        height_unit_m: length_unit_m(keys.code(key::VERTICAL_UNIT)).unwrap_or(1.0),
    }
}

fn doubles<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> Vec<f64> {
    decoder.find_tag(tag).ok().flatten().and_then(|v| v.into_f64_vec().ok()).unwrap_or_default()
}

fn affine<R: Read + Seek>(decoder: &mut Decoder<R>, is_point: bool) -> Option<Affine> {
    // Where the directory says that a value belongs to a point, that is the middle of the pixel.
    let of = |at: DVec2, column: DVec2, row: DVec2| {
        if is_point {
            Affine::of_first_middle(at, column, row)
        } else {
            Affine { origin: at, step: glam::DMat2::from_cols(column, row) }
        }
    };
    if let &[a, b, _, d, e, f, _, h, ..] = doubles(decoder, Tag::ModelTransformationTag).as_slice() {
        return Some(of(DVec2::new(d, h), DVec2::new(a, e), DVec2::new(b, f)));
    }
    let (scale, tie) = (doubles(decoder, Tag::ModelPixelScaleTag), doubles(decoder, Tag::ModelTiepointTag));
    let (&[sx, sy, ..], &[i, j, _, x, y, ..]) = (scale.as_slice(), tie.as_slice()) else { return None };
    let (column, row) = (DVec2::new(sx, 0.0), DVec2::new(0.0, -sy));
    Some(of(DVec2::new(x, y) - i * column - j * row, column, row))
}

fn keys<R: Read + Seek>(decoder: &mut Decoder<R>) -> Keys {
    let Some(directory) = decoder.find_tag_unsigned_vec::<u16>(Tag::GeoKeyDirectoryTag).ok().flatten() else {
        return Keys::default();
    };
    let numbers = doubles(decoder, Tag::GeoDoubleParamsTag);
    let ascii = decoder.find_tag(Tag::GeoAsciiParamsTag).ok().flatten();
    let ascii = ascii.and_then(|v| v.into_string().ok()).unwrap_or_default();
    let entries = directory.as_chunks::<4>().0.iter().skip(1).take(MOST_KEYS);
    let value = |&[id, place, count, at]: &[u16; 4]| {
        let (count, from) = (usize::from(count), usize::from(at));
        let value = match place {
            0 => Value::Short(at),
            34_736 => Value::Double(*numbers.get(from)?),
            34_737 => {
                let bytes = ascii.as_bytes().get(from..(from + count).min(ascii.len()))?;
                Value::Text(String::from_utf8_lossy(bytes).trim_end_matches(['|', '\0']).to_owned())
            }
            _ => return None,
        };
        Some((id, value))
    };
    Keys(entries.filter_map(value).collect())
}

fn crs(keys: &Keys) -> Option<Result<Crs, CrsError>> {
    let is_degrees = keys.code(key::MODEL) == Some(2);
    let code = if is_degrees { keys.code(key::GEODETIC) } else { keys.code(key::PROJECTED) };
    match code {
        Some(code) if code != USER_DEFINED => Some(Crs::from_epsg(code)),
        None if !is_degrees && keys.code(key::MODEL).is_none() => keys.code(key::GEODETIC).map(Crs::from_epsg),
        _ => Some(citation(keys).or_else(|| user_defined(keys)).unwrap_or(Err(CrsError::Part("a definition of its own".into())))),
    }
}

/// Esri writes WKT where a citation should stand.
fn citation(keys: &Keys) -> Option<Result<Crs, CrsError>> {
    let texts = [key::PROJECTED_CITATION, key::CITATION].into_iter().filter_map(|k| keys.text(k));
    texts.filter_map(|t| t.split_once("ESRI PE String = ")).map(|(_, wkt)| Crs::from_text(wkt)).next()
}

/// A transverse Mercator given by its parameters, on a datum that has a code read here.
fn user_defined(keys: &Keys) -> Option<Result<Crs, CrsError>> {
    const TRANSVERSE_MERCATOR: u32 = 1;
    if keys.code(key::METHOD)? != TRANSVERSE_MERCATOR {
        return None;
    }
    let datum = keys.code(key::GEODETIC)?;
    if let Err(error) = Crs::from_epsg(datum) {
        return Some(Err(error));
    }
    let unit_m = length_unit_m(keys.code(key::LINEAR_UNIT)).or(keys.double(key::LINEAR_UNIT_SIZE)).unwrap_or(1.0);
    let number = |key| keys.double(key).unwrap_or(0.0);
    let origin = (number(key::ORIGIN_LAT), keys.double(key::ORIGIN_LON)?);
    let scale = keys.double(key::SCALE).unwrap_or(1.0);
    let false_m = unit_m * DVec2::new(number(key::FALSE_EAST), number(key::FALSE_NORTH));
    let is_sane =
        origin.0.abs() <= 90.0 && origin.1.abs() <= 360.0 && (0.1..10.0).contains(&scale) && (1e-4..1e4).contains(&unit_m);
    let wild = || CrsError::Part("a transverse Mercator whose parameters are out of range".into());
    Some(if is_sane { Ok(Crs::user_transverse_mercator(origin, scale, false_m, unit_m)) } else { Err(wild()) })
}

/// Metres in a unit of length by its code.
fn length_unit_m(code: Option<u32>) -> Option<f64> {
    match code? {
        9001 => Some(1.0),
        9002 => Some(0.3048),
        9003 => Some(1200.0 / 3937.0),
        _ => None,
    }
}
