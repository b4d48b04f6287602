use std::io::{Cursor, ErrorKind};

use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::error::Reason;
use super::rows::{Samples, packed};
use super::{Picture, SAVE_AS_PNG, blank, check_size, jpeg};
use crate::raster::PictureLimits;

const FORMAT: &str = "TIFF";
/// Most bytes that the values of one tag may take: room for a million tiles.
const TAG_BYTES: usize = 8 << 20;

pub(super) fn decode(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, Reason> {
    match palette_entry(bytes) {
        // The decoder reads no palettes, but greys of as many bits are the same samples.
        Some(_) if bytes.len() as u64 > limits.bytes / 2 => Err(unsupported("a palette, in so large a file")),
        Some(at) => {
            let mut as_grey = bytes.to_vec();
            as_grey[at] = 1;
            decode_as(&as_grey, true, limits)
        }
        None => decode_as(bytes, false, limits),
    }
}

fn decode_as(bytes: &[u8], has_palette: bool, limits: &PictureLimits) -> Result<Picture, Reason> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(reason)?;
    let sheet = Sheet::read(&mut decoder, bytes, has_palette, limits)?;
    decoder = decoder.with_limits(piece_limits(limits));
    let mut pixels = blank(sheet.width, sheet.height);
    for chunk in 0..sheet.chunks.len() {
        sheet.read_chunk(chunk, &mut decoder, bytes, limits, &mut pixels)?;
    }
    Ok(Picture { width: sheet.width, height: sheet.height, pixels })
}

/// Where the first directory says, in one byte, that its samples are numbers of a palette's colours.
fn palette_entry(bytes: &[u8]) -> Option<usize> {
    const PHOTOMETRIC: u64 = 262;
    const PALETTE: u64 = 3;
    let is_big_end = bytes.first() == Some(&b'M');
    let number = |at: usize, count: usize| {
        let part = bytes.get(at..at.checked_add(count)?)?;
        let join = |n: u64, b: &u8| n << 8 | u64::from(*b);
        Some(if is_big_end { part.iter().fold(0, join) } else { part.iter().rev().fold(0, join) })
    };
    // BigTIFF has wider numbers and places.
    let is_wide = number(2, 2)? == 43;
    let (places, counts, entry) = if is_wide { (8, 8, 20) } else { (4, 2, 12) };
    let directory = usize::try_from(number(if is_wide { 8 } else { 4 }, places)?).ok()?;
    let count = number(directory, counts)?;
    let first = directory.checked_add(counts)?;
    // More entries than the file has bytes end by `number`.
    for i in 0..usize::try_from(count).ok()? {
        let at = i.checked_mul(entry)?.checked_add(first)?;
        if number(at, 2)? == PHOTOMETRIC {
            let value = at + if is_wide { 12 } else { 8 };
            return (number(value, 2)? == PALETTE).then_some(if is_big_end { value + 1 } else { value });
        }
    }
    None
}

/// The sum was checked before; these hold one piece each.
fn piece_limits(limits: &PictureLimits) -> Limits {
    let most = usize::try_from(limits.bytes).unwrap_or(usize::MAX);
    let mut pieces = Limits::default();
    (pieces.decoding_buffer_size, pieces.intermediate_buffer_size, pieces.ifd_value_size) = (most, most, TAG_BYTES);
    pieces
}

/// How samples become colours.
#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// 8 or 16 bits each.
    Whole(Samples),
    /// Greys of 1, 2 or 4 bits.
    PackedGrey(usize),
    /// Palette of 1, 2, 4 or 8 bits.
    Palette(usize, Vec<[u8; 3]>),
    /// JPEG in strips or tiles, with the tables that they share. Colours as they are, or luminance and chrominance.
    Jpeg { tables: Vec<u8>, is_plain_rgb: bool },
}

/// The first picture of a file: where its strips or tiles are, and what they hold.
#[derive(Debug)]
struct Sheet {
    width: usize,
    height: usize,
    kind: Kind,
    /// Bytes a sample: 1 or 2.
    sample_bytes: usize,
    /// Samples that lie together: 1 where each plane has strips of its own.
    together: usize,
    /// Size of a strip or tile in full.
    chunk_size: [usize; 2],
    /// Strips or tiles in a row.
    across: usize,
    /// Strips or tiles of one plane.
    a_plane: usize,
    /// Where each lies in the file: from and length.
    chunks: Vec<(usize, usize)>,
}

type Source<'a> = Decoder<Cursor<&'a [u8]>>;

impl Sheet {
    fn read(decoder: &mut Source, bytes: &[u8], has_palette: bool, limits: &PictureLimits) -> Result<Self, Reason> {
        let (width, height) = decoder.dimensions().map_err(reason)?;
        let size = [u64::from(width), u64::from(height)];
        check_size(FORMAT, size[0], size[1], 0, limits)?;
        let tag = |decoder: &mut Source, tag| decoder.find_tag_unsigned::<u32>(tag).map_err(reason);
        let compression = tag(decoder, Tag::Compression)?.unwrap_or(1);
        let is_planar = tag(decoder, Tag::PlanarConfiguration)?.unwrap_or(1) == 2;
        for format in decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(reason)?.unwrap_or_default() {
            if format != 1 {
                return Err(unsupported("signed or floating-point samples"));
            }
        }
        let colours = decoder.colortype().map_err(reason)?;
        let samples = usize::from(colours.num_samples());
        let (kind, bits) = Self::kind(decoder, colours, compression == 7, has_palette)?;
        if is_planar && !matches!(kind, Kind::Whole(Samples::Grey | Samples::Rgb)) {
            return Err(unsupported("planes of anything but grey or RGB"));
        }
        let chunk_size = decoder.chunk_dimensions();
        let chunk_size = [chunk_size.0, chunk_size.1].map(|n| n as usize);
        let most = 2 * limits.side_px.max(64) as usize;
        let is_strip = decoder.get_chunk_type() == ChunkType::Strip;
        let chunk_size = if is_strip { [width as usize, chunk_size[1].min(height as usize)] } else { chunk_size };
        if chunk_size.iter().any(|&n| n == 0 || n > most) {
            return Err(broken(format!("its tiles are {} × {} pixels", chunk_size[0], chunk_size[1])));
        }
        let across = if is_strip { 1 } else { (width as usize).div_ceil(chunk_size[0]) };
        let a_plane = across * (height as usize).div_ceil(chunk_size[1]);
        let planes = if is_planar { samples } else { 1 };
        let together = if is_planar { 1 } else { samples };
        let chunk_bytes = (chunk_size[0] * chunk_size[1] * together) as u64 * (bits as u64).max(8) / 8;
        let working = match &kind {
            Kind::Jpeg { .. } => 3 * chunk_size[0] as u64 * chunk_size[1] as u64 + bytes.len() as u64,
            Kind::Whole(Samples::Rgb) if is_strip && bits == 8 && !is_planar => 1 << 18,
            _ => 2 * chunk_bytes + (1 << 18),
        };
        let working = working + if has_palette { bytes.len() as u64 } else { 0 };
        check_size(FORMAT, size[0], size[1], working + 16 * (a_plane * planes) as u64, limits)?;
        let chunks = Self::chunks(decoder, is_strip, a_plane * planes, bytes)?;
        let data: u64 = chunks.iter().map(|c| c.1 as u64).sum();
        let raw = size[0] * size[1] * (samples * bits) as u64 / 8;
        if raw > data.saturating_mul(best_ratio(compression, size[0])) {
            return Err(Reason::HeaderLies { format: FORMAT, width: size[0], height: size[1], bytes: data });
        }
        let [width, height] = size.map(|n| n as usize);
        Ok(Self { width, height, kind, sample_bytes: bits.div_ceil(8), together, chunk_size, across, a_plane, chunks })
    }

    /// What its samples are, and how many bits each has.
    fn kind(decoder: &mut Source, colours: ColorType, is_jpeg: bool, has_palette: bool) -> Result<(Kind, usize), Reason> {
        if is_jpeg {
            let tables = match decoder.find_tag(Tag::JPEGTables).map_err(reason)? {
                Some(tables) => tables.into_u8_vec().map_err(reason)?,
                None => Vec::new(),
            };
            return match colours {
                ColorType::RGB(8) => Ok((Kind::Jpeg { tables, is_plain_rgb: true }, 8)),
                ColorType::Gray(8) | ColorType::YCbCr(8) => Ok((Kind::Jpeg { tables, is_plain_rgb: false }, 8)),
                other => Err(unsupported(&format!("JPEG-packed samples of kind {other:?}"))),
            };
        }
        if has_palette {
            let ColorType::Gray(bits @ (1 | 2 | 4 | 8)) = colours else {
                return Err(unsupported("a palette of more than 256 colours"));
            };
            let map = decoder.get_tag_u16_vec(Tag::ColorMap).map_err(reason)?;
            return Ok((Kind::Palette(usize::from(bits), palette(&map, 1 << bits)?), usize::from(bits)));
        }
        let is_multiplied =
            decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).ok().flatten().is_some_and(|e| e.first() == Some(&1));
        Ok(match colours {
            ColorType::Gray(bits @ (8 | 16)) => (Kind::Whole(Samples::Grey), usize::from(bits)),
            ColorType::GrayA(bits @ (8 | 16)) | ColorType::Multiband { bit_depth: bits @ (8 | 16), num_samples: 2 } => {
                (Kind::Whole(Samples::GreyAlpha), usize::from(bits))
            }
            ColorType::RGB(bits @ (8 | 16)) => (Kind::Whole(Samples::Rgb), usize::from(bits)),
            ColorType::RGBA(bits @ (8 | 16)) if is_multiplied => (Kind::Whole(Samples::RgbaMultiplied), usize::from(bits)),
            ColorType::RGBA(bits @ (8 | 16)) => (Kind::Whole(Samples::Rgba), usize::from(bits)),
            ColorType::CMYK(bits @ (8 | 16)) => (Kind::Whole(Samples::Cmyk), usize::from(bits)),
            ColorType::Gray(bits @ (1 | 2 | 4)) => (Kind::PackedGrey(usize::from(bits)), usize::from(bits)),
            other => return Err(unsupported(&format!("samples of kind {other:?}"))),
        })
    }

    /// Where the strips or tiles lie; each must lie in the file.
    fn chunks(decoder: &mut Source, is_strip: bool, count: usize, bytes: &[u8]) -> Result<Vec<(usize, usize)>, Reason> {
        let tags = if is_strip { [Tag::StripOffsets, Tag::StripByteCounts] } else { [Tag::TileOffsets, Tag::TileByteCounts] };
        let [from, length] = tags.map(|tag| decoder.find_tag_unsigned_vec::<u64>(tag).map_err(reason));
        let (from, length) = (from?.unwrap_or_default(), length?.unwrap_or_default());
        if from.len() < count || length.len() < count {
            let told = from.len().min(length.len());
            return Err(broken(format!("it tells where {told} of its {count} strips or tiles are")));
        }
        let inside = |(from, length): (u64, u64)| {
            let end = from.checked_add(length).filter(|&end| end <= bytes.len() as u64);
            end.map(|_| (from as usize, length as usize))
        };
        let chunks: Option<Vec<_>> = from.into_iter().zip(length).take(count).map(inside).collect();
        chunks.ok_or_else(|| Reason::Cut { format: FORMAT, place: "before the pixels that its header points at".to_owned() })
    }

    /// Rectangle of a strip or tile of its plane: left, top, width, height.
    fn place(&self, chunk: usize) -> [usize; 4] {
        let number = chunk % self.a_plane;
        let (left, top) = (number % self.across * self.chunk_size[0], number / self.across * self.chunk_size[1]);
        [left, top, self.chunk_size[0].min(self.width - left), self.chunk_size[1].min(self.height - top)]
    }

    fn read_chunk(
        &self,
        chunk: usize,
        decoder: &mut Source,
        bytes: &[u8],
        limits: &PictureLimits,
        pixels: &mut [u8],
    ) -> Result<(), Reason> {
        let [left, top, width, height] = self.place(chunk);
        let line = 3 * self.width;
        if let Kind::Jpeg { tables, is_plain_rgb } = &self.kind {
            let (from, length) = self.chunks[chunk];
            let part = jpeg_of(tables, &bytes[from..from + length]);
            let part = jpeg::decode_part(&part, self.chunk_size, *is_plain_rgb, limits)?;
            let rows = part.pixels.chunks_exact(3 * part.width).zip(pixels.chunks_exact_mut(line).skip(top));
            if part.width < width || part.height < height {
                return Err(broken(format!("strip or tile {chunk} is smaller than it should be")));
            }
            rows.take(height).for_each(|(from, to)| to[3 * left..3 * (left + width)].copy_from_slice(&from[..3 * width]));
            return Ok(());
        }
        let number = u32::try_from(chunk).map_err(|_| broken("it has too many strips".to_owned()))?;
        if self.kind == Kind::Whole(Samples::Rgb) && self.sample_bytes == 1 && self.together == 3 && width == self.width {
            return decoder.read_chunk_bytes(number, &mut pixels[top * line..(top + height) * line]).map_err(reason);
        }
        let samples = match decoder.read_chunk(number).map_err(reason)? {
            DecodingResult::U8(samples) => samples,
            DecodingResult::U16(samples) => samples.into_iter().map(|s| (s >> 8) as u8).collect(),
            _ => return Err(unsupported("samples that are no whole numbers of 8 or 16 bits")),
        };
        let row_bytes = match &self.kind {
            Kind::PackedGrey(bits) | Kind::Palette(bits, _) => (width * bits).div_ceil(8),
            _ => width * self.together,
        };
        if samples.len() < row_bytes * height {
            return Err(broken(format!("strip or tile {chunk} is smaller than it should be")));
        }
        for (row, to) in samples.chunks_exact(row_bytes).zip(pixels.chunks_exact_mut(line).skip(top)).take(height) {
            self.convert(row, chunk / self.a_plane, &mut to[3 * left..3 * (left + width)]);
        }
        Ok(())
    }

    /// A row of samples, of all planes or of one, into RGB.
    fn convert(&self, row: &[u8], plane: usize, to: &mut [u8]) {
        match &self.kind {
            Kind::Whole(samples) if self.together == samples.count() => samples.convert(row, to),
            Kind::Whole(_) => {
                // Each plane writes its own channel; more than three were refused.
                to.iter_mut().skip(plane).step_by(3).zip(row).for_each(|(to, &from)| *to = from);
            }
            Kind::PackedGrey(bits) => {
                let most = (1u16 << bits) - 1;
                for (i, pixel) in to.chunks_exact_mut(3).enumerate() {
                    pixel.fill((u16::from(packed(row, i, *bits)) * 255 / most) as u8);
                }
            }
            Kind::Palette(bits, palette) => {
                for (i, pixel) in to.chunks_exact_mut(3).enumerate() {
                    let index = if *bits == 8 { row.get(i).copied().unwrap_or(0) } else { packed(row, i, *bits) };
                    pixel.copy_from_slice(&palette.get(usize::from(index)).copied().unwrap_or_default());
                }
            }
            Kind::Jpeg { .. } => {}
        }
    }
}

/// A file of its own from shared tables (which end by an end mark) and one strip's data.
fn jpeg_of(tables: &[u8], data: &[u8]) -> Vec<u8> {
    let mut file = tables.strip_suffix(&[0xff, 0xd9]).unwrap_or(tables).to_vec();
    if file.starts_with(&[0xff, 0xd8]) {
        file.extend_from_slice(data.strip_prefix(&[0xff, 0xd8]).unwrap_or(data));
    } else {
        file = data.to_vec();
    }
    file
}

/// The colours of a palette: all reds, all greens, all blues, of 16 bits; some programs write 8.
fn palette(map: &[u16], colours: usize) -> Result<Vec<[u8; 3]>, Reason> {
    if map.len() < 3 * colours {
        return Err(broken(format!("its palette has {} values of {}", map.len(), 3 * colours)));
    }
    let shift = if map.iter().any(|&v| v > 255) { 8 } else { 0 };
    Ok((0..colours).map(|i| [i, i + colours, i + 2 * colours].map(|at| (map[at] >> shift) as u8)).collect())
}

/// What a compression makes at most of one byte.
fn best_ratio(compression: u32, width: u64) -> u64 {
    match compression {
        1 => 1,
        32_773 => 64,
        // The longest string of a table of 4,096 grows by one byte a code.
        5 => 1400,
        8 | 32_946 => 1032,
        7 => 768,
        // Fax: a bit a row.
        _ => 8 * width,
    }
}

fn broken(detail: String) -> Reason {
    Reason::Broken { format: FORMAT, detail }
}

fn unsupported(what: &str) -> Reason {
    Reason::Unsupported { feature: format!("TIFF with {what}"), fix: SAVE_AS_PNG }
}

fn reason(error: TiffError) -> Reason {
    match error {
        TiffError::IoError(e) if e.kind() == ErrorKind::UnexpectedEof => {
            Reason::Cut { format: FORMAT, place: "before all its pixels have come".to_owned() }
        }
        TiffError::UnsupportedError(what) => unsupported(&what.to_string()),
        TiffError::LimitsExceeded => broken("a part of it is larger than such a picture can have".to_owned()),
        other => broken(other.to_string()),
    }
}
