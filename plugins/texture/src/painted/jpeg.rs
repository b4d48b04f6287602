//! Pictures of level 3 as they travel: baseline JPEG, which every platform decodes, of one size.

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use super::Pixels;

/// Texels along a picture of level 3.
pub const PICTURE_SIDE: usize = 512;

/// Most bytes of a picture as stored.
pub const PICTURE_STORED_CAP: usize = 64 << 10;

/// Why a picture of level 3 is not shown.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// Longer than any picture may be.
    #[error("the picture has {0} bytes, more than {PICTURE_STORED_CAP}")]
    TooLong(usize),
    /// Not a JPEG of the kind that is shown.
    #[error("not a picture that is shown: {0}")]
    Strange(&'static str),
    /// Of another size.
    #[error("the picture has {width} × {height} texels, not {PICTURE_SIDE} × {PICTURE_SIDE}")]
    Size {
        /// Columns, as its header claims.
        width: u16,
        /// Rows.
        height: u16,
    },
    /// Broken within.
    #[error("the picture is broken: {0}")]
    Broken(String),
}

/// The stored form of a picture, as fine as `most_bytes` allow; `None` if even the coarsest is longer, or its sides are of no JPEG.
#[must_use]
pub fn encode_picture(picture: &Pixels, most_bytes: usize) -> Option<Vec<u8>> {
    let (width, height) = (u16::try_from(picture.width).ok()?, u16::try_from(picture.height()).ok()?);
    let bytes = picture.bytes();
    let encode = |quality: u8| {
        let mut stored = Vec::new();
        let mut encoder = Encoder::new(&mut stored, quality);
        encoder.set_sampling_factor(SamplingFactor::R_4_2_0);
        // Tables of its own would part the colours into scans, of which decoders lose some.
        encoder.encode(&bytes, width, height, ColorType::Rgb).ok()?;
        Some(stored).filter(|stored| stored.len() <= most_bytes)
    };
    let (mut best, mut low, mut high) = (encode(1)?, 1, 96);
    while high - low > 1 {
        let quality = low + (high - low) / 2;
        match encode(quality) {
            Some(stored) => (best, low) = (stored, quality),
            None => high = quality,
        }
    }
    Some(best)
}

/// The picture of stored bytes. Length, kind and size are looked at before anything is decoded, so that no file takes more than a few
/// milliseconds and a megabyte.
///
/// # Errors
/// If it is no whole baseline JPEG of [`PICTURE_SIDE`] squared in colour.
pub fn decode_picture(stored: &[u8]) -> Result<Pixels, PictureError> {
    check(stored)?;
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(PICTURE_SIDE)
        .set_max_height(PICTURE_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    // It is others' code, and nothing of it outlives the call.
    let decoded = std::panic::catch_unwind(|| JpegDecoder::new_with_options(ZCursor::new(stored), options).decode());
    let bytes = decoded.map_err(|_| PictureError::Broken("its decoder gave up on it".to_owned()))?;
    let bytes = bytes.map_err(|error| PictureError::Broken(format!("{error:?}").chars().take(200).collect()))?;
    let pixels = Pixels::of_rgb(PICTURE_SIDE, &bytes).filter(|pixels| pixels.height() == PICTURE_SIDE);
    pixels.ok_or_else(|| PictureError::Broken("it has fewer texels than it says".to_owned()))
}

/// Looks at the segments before the first scan: there must be one frame, baseline, in colour, of the right size.
fn check(stored: &[u8]) -> Result<(), PictureError> {
    use PictureError::Strange;
    if stored.len() > PICTURE_STORED_CAP {
        return Err(PictureError::TooLong(stored.len()));
    }
    let mut rest = stored.strip_prefix(&[0xFF, 0xD8]).ok_or(Strange("it is no JPEG"))?;
    let mut is_framed = false;
    loop {
        let [0xFF, marker, high, low, after @ ..] = rest else { return Err(Strange("its header is cut off")) };
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        let segment = length.checked_sub(2).and_then(|length| after.split_at_checked(length));
        let (segment, behind) = segment.ok_or(Strange("its header is cut off"))?;
        match marker {
            0xC0 => {
                let [8, h1, h0, w1, w0, components, ..] = segment else { return Err(Strange("its frame is not of 8 bits")) };
                let (height, width) = (u16::from_be_bytes([*h1, *h0]), u16::from_be_bytes([*w1, *w0]));
                let is_size = |texels: u16| usize::from(texels) == PICTURE_SIDE;
                if !is_size(width) || !is_size(height) {
                    return Err(PictureError::Size { width, height });
                }
                if *components != 3 || is_framed {
                    return Err(Strange("it has another number of colours or frames"));
                }
                is_framed = true;
            }
            0xDA if is_framed && segment.first() == Some(&3) => return Ok(()),
            0xDA if is_framed => return Err(Strange("it tells its colours one after another")),
            0xDA => return Err(Strange("it has no frame")),
            // All other frames: progressive, lossless, arithmetic; and lines counted at the end.
            0xC1..=0xC3 | 0xC5..=0xCF | 0xDC => return Err(Strange("it is not baseline")),
            0xC4 | 0xDB | 0xDD | 0xE0..=0xEF | 0xFE => {}
            _ => return Err(Strange("it has segments of no picture")),
        }
        rest = behind;
    }
}
