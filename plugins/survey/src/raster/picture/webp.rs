use std::io::{Cursor, ErrorKind};

use image_webp::{DecodingError, WebPDecoder};

use super::error::Reason;
use super::rows::Samples;
use super::{Picture, SAVE_AS_PNG, blank, check_size};
use crate::raster::PictureLimits;

const FORMAT: &str = "WebP";

pub(super) fn decode(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, Reason> {
    let header = Header::read(bytes)?;
    check_size(FORMAT, header.width, header.height, header.working_bytes(), limits)?;
    if header.least_bytes() > header.data {
        let Header { width, height, data, .. } = header;
        return Err(Reason::HeaderLies { format: FORMAT, width, height, bytes: data });
    }
    if header.has_lossless && header.width.max(header.height) > 16_383 {
        return Err(Reason::Unsupported { feature: "lossless WebP of 16,384 pixels a side".to_owned(), fix: SAVE_AS_PNG });
    }
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(reason)?;
    let (width, height) = (header.width as usize, header.height as usize);
    if decoder.dimensions() != (header.width as u32, header.height as u32) {
        return Err(broken("its canvas and its picture differ in size"));
    }
    if !decoder.has_alpha() {
        let mut pixels = blank(width, height);
        decoder.read_image(&mut pixels).map_err(reason)?;
        return Ok(Picture { width, height, pixels });
    }
    let mut with_alpha = vec![0; 4 * width * height];
    decoder.read_image(&mut with_alpha).map_err(reason)?;
    let mut pixels = blank(width, height);
    Samples::Rgba.convert(&with_alpha, &mut pixels);
    Ok(Picture { width, height, pixels })
}

/// What the chunks say before anything is decoded.
#[derive(Debug, Default)]
struct Header {
    width: u64,
    height: u64,
    has_lossless: bool,
    has_alpha: bool,
    /// Bytes of picture data.
    data: u64,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Reason> {
        let number = |at: usize, count: usize| {
            let part = bytes.get(at..at + count);
            part.map(|b| b.iter().rev().fold(0u64, |n, &b| n << 8 | u64::from(b))).ok_or_else(|| cut("in its header"))
        };
        if 8 + number(4, 4)? > bytes.len() as u64 {
            return Err(cut(&format!("after {} bytes of {}", bytes.len(), 8 + number(4, 4)?)));
        }
        let mut header = Self::default();
        let (mut at, mut canvas, mut picture) = (12, None, None);
        while at + 8 <= bytes.len() && picture.is_none() {
            let length = number(at + 4, 4)?;
            if at as u64 + 8 + length > bytes.len() as u64 {
                return Err(cut("inside a chunk"));
            }
            let body = at + 8;
            match &bytes[at..at + 4] {
                b"VP8X" => {
                    let flags = number(body, 1)?;
                    if flags & 2 != 0 {
                        let feature = "an animation".to_owned();
                        return Err(Reason::Unsupported { feature, fix: "save one picture of it as PNG" });
                    }
                    header.has_alpha |= flags & 16 != 0;
                    canvas = Some((1 + number(body + 4, 3)?, 1 + number(body + 7, 3)?));
                }
                b"VP8L" => {
                    let bits = number(body + 1, 4)?;
                    picture = Some((1 + (bits & 0x3fff), 1 + (bits >> 14 & 0x3fff)));
                    (header.has_lossless, header.has_alpha) = (true, header.has_alpha || bits >> 28 & 1 != 0);
                    header.data = length;
                }
                b"VP8 " => {
                    picture = Some((number(body + 6, 2)? & 0x3fff, number(body + 8, 2)? & 0x3fff));
                    header.data = length;
                    if number(body, 3)? >> 5 > length {
                        return Err(broken("its first part is longer than the whole"));
                    }
                }
                _ => {}
            }
            at = body + length.next_multiple_of(2) as usize;
        }
        // The canvas is what a decoder trusts; check it even where no picture follows.
        (header.width, header.height) = canvas.or(picture).ok_or_else(|| broken("there is no picture in it"))?;
        match picture {
            None => header.data = 0,
            Some(size) if size != (header.width, header.height) => {
                return Err(broken("its canvas and its picture differ in size"));
            }
            Some(_) => {}
        }
        Ok(header)
    }

    /// Fewest bytes that a lossy picture can have: a 16 × 16 block takes two decisions of 1/177 bit at the least. A lossless
    /// one of a single colour takes none.
    fn least_bytes(&self) -> u64 {
        let blocks = self.width.div_ceil(16) * self.height.div_ceil(16);
        if self.has_lossless { 16 } else { 16 + blocks / 708 }
    }

    /// What decoding takes beside the picture; bytes.
    fn working_bytes(&self) -> u64 {
        let area = self.width.next_multiple_of(16) * self.height.next_multiple_of(16);
        let lossless = 5 * area;
        // Luminance, chrominance in quarters, what is known of each block, and alpha, packed as a lossless picture.
        let lossy = area * 3 / 2 + area / 4 + if self.has_alpha { 4 * area + lossless } else { 0 };
        (1 << 20) + if self.has_lossless { lossless } else { lossy }
    }
}

fn broken(detail: &str) -> Reason {
    Reason::Broken { format: FORMAT, detail: detail.to_owned() }
}

fn cut(place: &str) -> Reason {
    Reason::Cut { format: FORMAT, place: place.to_owned() }
}

fn reason(error: DecodingError) -> Reason {
    match error {
        DecodingError::IoError(e) if e.kind() == ErrorKind::UnexpectedEof => cut("before all its pixels have come"),
        DecodingError::UnsupportedFeature(feature) => Reason::Unsupported { feature, fix: SAVE_AS_PNG },
        other => Reason::Broken { format: FORMAT, detail: other.to_string() },
    }
}
