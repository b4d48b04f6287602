use std::io::Cursor;

use bevy_egui::egui::{Color32, ColorImage};
use image_webp::WebPDecoder;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

/// Larger files are refused before they are looked at; bytes.
pub const LARGEST_BYTES: usize = 8 << 20;
/// Pictures of more pixels are refused by their heads, before any room is made for them.
pub const MOST_PIXELS: usize = 24_000_000;
/// Most scans of a progressive JPEG; encoders write about ten.
const MOST_SCANS: usize = 64;
/// What a decoder may take beside its pixels; bytes.
const WORKING_BYTES: usize = 64 << 20;

/// A picture that cannot be shown.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// The file is too large.
    #[error("{0} bytes are more than the {LARGEST_BYTES} that a picture may have; save it smaller")]
    TooManyBytes(usize),
    /// It has too many pixels.
    #[error("{0} × {1} pixels are more than {MOST_PIXELS}; save it smaller")]
    TooManyPixels(usize, usize),
    /// It is none of the kinds that are shown.
    #[error("it is no PNG, JPEG or WebP; save it as one of them")]
    Unknown,
    /// It is broken.
    #[error("a broken {0}: {1}; save it anew")]
    Broken(&'static str, String),
}

/// Whole pixels of a picture, 8 bits a channel.
struct Pixels {
    size: [usize; 2],
    channels: usize,
    bytes: Vec<u8>,
}

/// A picture no wider or higher than so many pixels.
pub(super) fn decode(bytes: &[u8], widest: usize) -> Result<ColorImage, PictureError> {
    if bytes.len() > LARGEST_BYTES {
        return Err(PictureError::TooManyBytes(bytes.len()));
    }
    let pixels = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png(bytes)?,
        [0xff, 0xd8, 0xff, ..] => jpeg(bytes)?,
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => webp(bytes)?,
        _ => return Err(PictureError::Unknown),
    };
    Ok(shrunk(&pixels, widest))
}

/// Whether there is room for a picture; how many pixels it has.
fn room(width: usize, height: usize) -> Result<usize, PictureError> {
    let count = width.checked_mul(height).filter(|&count| count > 0 && count <= MOST_PIXELS);
    count.ok_or(PictureError::TooManyPixels(width, height))
}

fn png(bytes: &[u8]) -> Result<Pixels, PictureError> {
    let broken = |error: png::DecodingError| PictureError::Broken("PNG", error.to_string());
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: WORKING_BYTES });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(broken)?;
    let size = [reader.info().width as usize, reader.info().height as usize];
    let count = room(size[0], size[1])?;
    let channels = reader.output_color_type().0.samples();
    let mut bytes = vec![0; count * channels];
    if reader.output_buffer_size() != Some(bytes.len()) {
        return Err(PictureError::Broken("PNG", "its head contradicts itself".to_owned()));
    }
    reader.next_frame(&mut bytes).map_err(broken)?;
    Ok(Pixels { size, channels, bytes })
}

fn jpeg(bytes: &[u8]) -> Result<Pixels, PictureError> {
    let broken = |detail: String| PictureError::Broken("JPEG", detail);
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_max_scans(MOST_SCANS)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| broken(error.to_string()))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| broken("it tells no size".to_owned()))?;
    let mut pixels = vec![0; 3 * room(width, height)?];
    if decoder.output_buffer_size() != Some(pixels.len()) {
        return Err(broken("its head contradicts itself".to_owned()));
    }
    decoder.decode_into(&mut pixels).map_err(|error| broken(error.to_string()))?;
    Ok(Pixels { size: [width, height], channels: 3, bytes: pixels })
}

fn webp(bytes: &[u8]) -> Result<Pixels, PictureError> {
    let broken = |error: image_webp::DecodingError| PictureError::Broken("WebP", error.to_string());
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    decoder.set_memory_limit(WORKING_BYTES);
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut pixels = vec![0; channels * room(width, height)?];
    decoder.read_image(&mut pixels).map_err(broken)?;
    Ok(Pixels { size: [width, height], channels, bytes: pixels })
}

impl Pixels {
    /// A pixel's red, green, blue and alpha.
    fn at(&self, x: usize, y: usize) -> [u32; 4] {
        let from = (y * self.size[0] + x) * self.channels;
        let channel = |n: usize| self.bytes.get(from + n).copied().map_or(0, u32::from);
        match self.channels {
            1 => [channel(0), channel(0), channel(0), 255],
            2 => [channel(0), channel(0), channel(0), channel(1)],
            3 => [channel(0), channel(1), channel(2), 255],
            _ => [channel(0), channel(1), channel(2), channel(3)],
        }
    }
}

/// The picture, each of its pixels the mean of so many by so many of the original that it is no wider than `widest`.
fn shrunk(pixels: &Pixels, widest: usize) -> ColorImage {
    let by = pixels.size[0].max(pixels.size[1]).div_ceil(widest.max(1)).max(1);
    let size = pixels.size.map(|side| (side / by).max(1));
    let mut out = Vec::with_capacity(size[0] * size[1]);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let (mut sum, mut count) = ([0_u32; 4], 0);
            for row in (y * by..(y + 1) * by).take_while(|&row| row < pixels.size[1]) {
                for column in (x * by..(x + 1) * by).take_while(|&column| column < pixels.size[0]) {
                    let pixel = pixels.at(column, row);
                    sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
                    count += 1;
                }
            }
            let [r, g, b, a] = sum.map(|sum| (sum / count.max(1)) as u8);
            out.push(Color32::from_rgba_unmultiplied(r, g, b, a));
        }
    }
    ColorImage::new(size, out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG whose left half is red and right half blue.
    fn halves(width: u32, height: u32, color: png::ColorType) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, width, height);
        encoder.set_color(color);
        let mut writer = encoder.write_header().expect("room");
        let pixel = |x: u32| if x < width / 2 { [255, 0, 0, 255] } else { [0, 0, 255, 255] };
        let data: Vec<u8> = (0..height).flat_map(|_| (0..width).flat_map(|x| pixel(x)[..color.samples()].to_vec())).collect();
        writer.write_image_data(&data).expect("room");
        writer.finish().expect("room");
        out
    }

    #[test]
    fn pictures_are_shown_and_large_ones_shrunk() {
        for color in [png::ColorType::Rgb, png::ColorType::Rgba] {
            let image = decode(&halves(40, 20, color), 16).expect("a good picture");
            assert_eq!(image.size, [13, 6]);
            assert_eq!((image.pixels[0], image.pixels[12]), (Color32::from_rgb(255, 0, 0), Color32::from_rgb(0, 0, 255)));
        }
        assert_eq!(decode(&halves(40, 20, png::ColorType::Rgb), 1_600).expect("a good picture").size, [40, 20]);
    }

    #[test]
    fn what_cannot_be_shown_is_told_and_never_takes_memory() {
        assert_eq!(decode(&vec![0; LARGEST_BYTES + 1], 16), Err(PictureError::TooManyBytes(LARGEST_BYTES + 1)));
        for bytes in [&b""[..], b"GIF89a", b"RIFF1234WAVE"] {
            assert_eq!(decode(bytes, 16), Err(PictureError::Unknown));
        }
        // A head that promises 65,000 by 65,000 pixels.
        let mut bomb = halves(8, 8, png::ColorType::Rgb);
        bomb[16..24].copy_from_slice(&[0, 0, 0xfd, 0xe8, 0, 0, 0xfd, 0xe8]);
        assert!(decode(&bomb, 16).is_err());
        let good = halves(64, 64, png::ColorType::Rgb);
        for cut in 4..good.len() - 20 {
            assert!(matches!(decode(&good[..cut], 16), Err(PictureError::Broken("PNG", _))), "cut at {cut}");
        }
        for head in [&[0xff, 0xd8, 0xff, 0xe0, 1, 2, 3][..], b"RIFF1234WEBPVP8 "] {
            assert!(matches!(decode(head, 16), Err(PictureError::Broken(..))));
        }
    }
}
