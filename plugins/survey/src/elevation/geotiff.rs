//! Elevations in a GeoTIFF: one band of whole or floating numbers, in strips or tiles.

use std::io::Cursor;

use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::{Cells, check_size};
use crate::SurveyError;
use crate::crs::CRS_FIX;
use crate::georeference::tags;

/// Largest strip or tile as decoded, bytes: the largest grid in one strip of 32-bit numbers.
const LARGEST_CHUNK: usize = 1 << 30;
/// Most strips or tiles: the largest grid in tiles of 16 x 16.
const MOST_CHUNKS: usize = 1 << 20;
/// No compression of a TIFF packs tighter than this.
const TIGHTEST: u64 = 4096;

/// Whether the first bytes are those of a TIFF.
pub(super) fn is_tiff(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| bytes.starts_with(*magic))
}

/// Reads the first picture of a file.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Cells, SurveyError> {
    let failed = |e: TiffError| failure(name, &e);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = LARGEST_CHUNK;
    limits.intermediate_buffer_size = LARGEST_CHUNK;
    limits.ifd_value_size = 8 * MOST_CHUNKS;
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(failed)?.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(failed)?;
    let (columns, rows) = check_size(name, width.into(), height.into())?;
    let color = decoder.colortype().map_err(failed)?;
    if !matches!(color, ColorType::Gray(8 | 16 | 32 | 64)) {
        return Err(SurveyError::Unsupported {
            name: name.to_owned(),
            feature: format!("{color:?} for elevations"),
            fix: "take one band of whole or floating numbers out of it (gdal_translate -b 1 -ot Float32)",
        });
    }
    let found = tags(&mut decoder);
    let no_data = decoder.find_tag(Tag::GdalNodata).ok().flatten().and_then(|v| v.into_string().ok());
    let no_data = no_data.and_then(|text| text.trim_matches(['\0', ' ']).parse::<f64>().ok());
    let sizes = chunk_sizes(&mut decoder, bytes.len() as u64, name)?;
    check_contents(&mut decoder, &sizes, color, name)?;
    let mut heights = vec![f32::NAN; columns as usize * rows as usize];
    let (chunk_width, chunk_height) = decoder.chunk_dimensions();
    let across = columns.div_ceil(chunk_width.max(1));
    for (i, &packed) in (0..).zip(&sizes) {
        let (left, top) = ((i % across) * chunk_width, (i / across).saturating_mul(chunk_height));
        if packed == 0 || top >= rows {
            // Left out because nothing is in it.
            continue;
        }
        let chunk = decoder.read_chunk(i).map_err(failed)?;
        let row_length = chunk_width.min(columns - left) as usize;
        let place = Place { columns: columns as usize, left: left as usize, top: top as usize, row_length };
        let scale = Scale { no_data, unit_m: found.height_unit_m };
        match chunk {
            DecodingResult::U8(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::U16(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::U32(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::U64(v) => place.fill(&mut heights, &v, |x| scale.metres(x as f64)),
            DecodingResult::I8(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::I16(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::I32(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::I64(v) => place.fill(&mut heights, &v, |x| scale.metres(x as f64)),
            DecodingResult::F16(v) => place.fill(&mut heights, &v, |x| scale.metres(x.to_f64())),
            DecodingResult::F32(v) => place.fill(&mut heights, &v, |x| scale.metres(x.into())),
            DecodingResult::F64(v) => place.fill(&mut heights, &v, |x| scale.metres(x)),
        }
    }
    let crs =
        found.crs.transpose().map_err(|e| SurveyError::Unsupported { name: name.to_owned(), feature: e.to_string(), fix: CRS_FIX });
    Ok(Cells { columns, rows, affine: found.affine, crs: crs?, heights })
}

/// How numbers become metres.
#[derive(Clone, Copy)]
struct Scale {
    no_data: Option<f64>,
    unit_m: f64,
}

impl Scale {
    fn metres(self, value: f64) -> f32 {
        // Some programs write the number that stands for no data with fewer digits than the cells have.
        let is_hole = self.no_data.is_some_and(|hole| value == hole || (value - hole).abs() <= 1e-6 * hole.abs());
        if is_hole { f32::NAN } else { (value * self.unit_m) as f32 }
    }
}

/// Where a strip or tile lies in the grid.
#[derive(Clone, Copy)]
struct Place {
    columns: usize,
    left: usize,
    top: usize,
    /// Its columns that lie inside of the grid.
    row_length: usize,
}

impl Place {
    fn fill<T: Copy>(self, heights: &mut [f32], values: &[T], metres: impl Fn(T) -> f32) {
        let rows = heights.chunks_exact_mut(self.columns.max(1)).skip(self.top);
        for (row, values) in rows.zip(values.chunks_exact(self.row_length.max(1))) {
            let cells = row.iter_mut().skip(self.left);
            cells.zip(values).for_each(|(cell, &value)| *cell = metres(value));
        }
    }
}

/// Packed bytes of every strip or tile; an error if one lies outside of the file, or if there are not enough for the grid.
fn chunk_sizes(decoder: &mut Decoder<Cursor<&[u8]>>, length: u64, name: &str) -> Result<Vec<u64>, SurveyError> {
    let failed = |e: TiffError| failure(name, &e);
    let is_tiled = decoder.get_chunk_type() == ChunkType::Tile;
    let (offsets, counts) =
        if is_tiled { (Tag::TileOffsets, Tag::TileByteCounts) } else { (Tag::StripOffsets, Tag::StripByteCounts) };
    let offsets = decoder.get_tag_u64_vec(offsets).map_err(failed)?;
    let counts = decoder.get_tag_u64_vec(counts).map_err(failed)?;
    let expected = if is_tiled { decoder.tile_count() } else { decoder.strip_count() }.map_err(failed)? as usize;
    if offsets.len() != counts.len() || counts.len() != expected || expected > MOST_CHUNKS {
        let detail = format!("{} strips or tiles where its size asks for {expected}", counts.len().min(offsets.len()));
        return Err(SurveyError::Broken { name: name.to_owned(), format: "GeoTIFF", detail });
    }
    for (i, (&offset, &count)) in offsets.iter().zip(&counts).enumerate() {
        if offset.checked_add(count).is_none_or(|end| end > length) {
            let place = format!("after {length} bytes, in strip or tile {i} of {expected}");
            return Err(SurveyError::Cut { name: name.to_owned(), format: "GeoTIFF", place });
        }
    }
    Ok(counts)
}

/// Refuses a file whose strips or tiles are too short for what they should hold, before room is made for it.
fn check_contents(decoder: &mut Decoder<Cursor<&[u8]>>, sizes: &[u64], color: ColorType, name: &str) -> Result<(), SurveyError> {
    if sizes.iter().all(|&packed| packed == 0) {
        return Err(SurveyError::Broken {
            name: name.to_owned(),
            format: "GeoTIFF",
            detail: "all of its strips or tiles are empty".into(),
        });
    }
    let compression = decoder.find_tag_unsigned::<u16>(Tag::Compression).map_err(|e| failure(name, &e))?.unwrap_or(1);
    let tightest = if compression == 1 { 1 } else { TIGHTEST };
    for (i, &packed) in (0..).zip(sizes).filter(|&(_, &packed)| packed > 0) {
        // Of a tile all is stored, of the last strip only what lies in the picture.
        let (width, height) = decoder.chunk_data_dimensions(i);
        let needed = u64::from(width) * u64::from(height) * u64::from(color.bit_depth()) / 8;
        if packed.saturating_mul(tightest) < needed {
            let place = format!("in strip or tile {i}, which has {packed} bytes for {width} x {height} values");
            return Err(SurveyError::Cut { name: name.to_owned(), format: "GeoTIFF", place });
        }
    }
    Ok(())
}

fn failure(name: &str, error: &TiffError) -> SurveyError {
    let name = name.to_owned();
    match error {
        TiffError::UnsupportedError(what) => SurveyError::Unsupported {
            name,
            feature: what.to_string(),
            fix: "write it anew (gdal_translate -co COMPRESS=DEFLATE -ot Float32)",
        },
        TiffError::LimitsExceeded => SurveyError::Broken {
            name,
            format: "GeoTIFF",
            detail: "its strips or tiles or tags are larger than any grid that is taken".into(),
        },
        other => SurveyError::Broken { name, format: "GeoTIFF", detail: other.to_string() },
    }
}
