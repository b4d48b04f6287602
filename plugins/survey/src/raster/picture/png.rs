use std::io::{Cursor, ErrorKind, Write};

use png::{ColorType, Decoder, DecodingError, Encoder, Limits, Reader, Transformations};

use super::error::Reason;
use super::rows::Samples;
use super::{Picture, blank, check_size};
use crate::raster::PictureLimits;

const FORMAT: &str = "PNG";
/// What deflate makes at most of one byte.
const DEFLATE_MOST: u64 = 1032;
/// Room for chunks that are kept whole (palette, transparency, times); bytes.
const CHUNKS: usize = 1 << 20;

pub(super) fn decode(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, Reason> {
    let (width, height) = dimensions(bytes)?;
    // Two rows of at most eight bytes a pixel, the decoder's window, and its chunks.
    check_size(FORMAT, width, height, 3 * 8 * width + (1 << 18) + CHUNKS as u64, limits)?;
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: CHUNKS });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(reason)?;
    // The decoder takes whole colours for granted.
    if reader.info().palette.as_ref().is_some_and(|p| p.is_empty() || p.len() % 3 != 0 || p.len() > 768) {
        return Err(broken("its palette is not of 1 to 256 whole colours"));
    }
    let raw_row = reader.info().raw_row_length() as u64;
    let data = data_bytes(bytes);
    // An interlaced picture has more and shorter rows; never less than half in all.
    if raw_row.saturating_mul(height) / 2 > data.saturating_mul(DEFLATE_MOST) {
        return Err(Reason::HeaderLies { format: FORMAT, width, height, bytes: data });
    }
    let (width, height) = (width as usize, height as usize);
    let samples = match reader.output_color_type().0 {
        ColorType::Grayscale => Samples::Grey,
        ColorType::GrayscaleAlpha => Samples::GreyAlpha,
        ColorType::Rgb => Samples::Rgb,
        ColorType::Rgba => Samples::Rgba,
        ColorType::Indexed => return Err(broken("a palette that cannot be expanded")),
    };
    let mut pixels = blank(width, height);
    if reader.info().interlaced {
        read_passes(&mut reader, samples, width, &mut pixels)?;
    } else if samples == Samples::Rgb {
        reader.next_frame(&mut pixels).map_err(reason)?;
    } else {
        let mut row = vec![0; samples.count() * width];
        for to in pixels.chunks_exact_mut(3 * width) {
            reader.read_row(&mut row).map_err(reason)?.ok_or_else(|| broken("too few rows"))?;
            samples.convert(&row, to);
        }
    }
    reader.finish().map_err(reason)?;
    Ok(Picture { width, height, pixels })
}

/// Where Adam7's passes begin and how far they step: column, row, columns apart, rows apart.
const PASSES: [[usize; 4]; 7] = [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

/// Writes a picture.
pub(super) fn encode(picture: &Picture, to: impl Write) -> std::io::Result<()> {
    let side = |n: usize| u32::try_from(n).map_err(|_| std::io::Error::from(ErrorKind::InvalidInput));
    let mut encoder = Encoder::new(to, side(picture.width)?, side(picture.height)?);
    encoder.set_color(ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&picture.pixels)?;
    Ok(writer.finish()?)
}

fn read_passes(reader: &mut Reader<Cursor<&[u8]>>, samples: Samples, width: usize, pixels: &mut [u8]) -> Result<(), Reason> {
    let height = pixels.len() / (3 * width);
    let mut row = vec![0; samples.count() * width];
    let mut rgb = vec![0; 3 * width];
    for [left, top, across, down] in PASSES {
        let columns = width.saturating_sub(left).div_ceil(across);
        if columns == 0 {
            continue;
        }
        for y in (top..height).step_by(down) {
            reader.read_row(&mut row).map_err(reason)?.ok_or_else(|| broken("too few rows"))?;
            samples.convert(&row[..samples.count() * columns], &mut rgb);
            for (i, pixel) in rgb.chunks_exact(3).take(columns).enumerate() {
                let to = 3 * (y * width + left + i * across);
                pixels[to..to + 3].copy_from_slice(pixel);
            }
        }
    }
    Ok(())
}

/// What the header, which must come first, says.
fn dimensions(bytes: &[u8]) -> Result<(u64, u64), Reason> {
    let number = |at: usize| bytes.get(at..at + 4).map(|b| b.iter().fold(0, |n, &b| n << 8 | u64::from(b)));
    let (Some(width), Some(height)) = (number(16), number(20)) else {
        return Err(Reason::Cut { format: FORMAT, place: format!("after {} bytes, in its header", bytes.len()) });
    };
    if bytes.get(..8) != Some(b"\x89PNG\r\n\x1a\n") {
        return Err(broken("its first bytes are damaged, as by a transfer in text mode"));
    }
    if bytes.get(12..16) != Some(b"IHDR") {
        return Err(broken("it does not begin with its header"));
    }
    Ok((width, height))
}

/// Bytes of picture data that are in the file.
fn data_bytes(bytes: &[u8]) -> u64 {
    let (mut at, mut data) = (8, 0);
    while let Some(head) = bytes.get(at..at + 8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if &head[4..] == b"IDAT" {
            data += length.min(bytes.len() - at - 8) as u64;
        }
        // A chunk of 4 GiB ends the walk on every machine.
        let Some(next) = at.checked_add(length).and_then(|at| at.checked_add(12)) else { break };
        at = next;
    }
    data
}

fn broken(detail: &str) -> Reason {
    Reason::Broken { format: FORMAT, detail: detail.to_owned() }
}

fn reason(error: DecodingError) -> Reason {
    match error {
        DecodingError::IoError(e) if e.kind() == ErrorKind::UnexpectedEof => {
            Reason::Cut { format: FORMAT, place: "before all its pixels have come, or without its end mark".to_owned() }
        }
        DecodingError::LimitsExceeded => broken("a palette or other small part of it is megabytes long"),
        other => Reason::Broken { format: FORMAT, detail: other.to_string() },
    }
}
