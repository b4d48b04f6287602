//! Pictures of level 3 as they travel: lossy WebP of one size, which every platform decodes, with a chunk of [flat colours](super::flats).

use std::io::Cursor;

use image_webp::WebPDecoder;

use super::Pixels;
use super::flats::FlatColours;

/// Texels along a picture of level 3.
pub const PICTURE_SIDE: usize = 512;

/// Most bytes of a picture as stored.
pub const PICTURE_STORED_CAP: usize = 64 << 10;

/// Name of the chunk of flat colours, which other readers of WebP pass over.
const FLATS: &[u8; 4] = b"FLAT";

/// Most bytes that [`keep_flats`] adds: the chunk's head, what it holds, and what makes both even.
pub const MOST_FLATS_BYTES: usize = 8 + (1 + 3 * FlatColours::MOST).next_multiple_of(2) + 1;

/// Why a picture of level 3 is not shown.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// Longer than any picture may be.
    #[error("the picture has {0} bytes, more than {PICTURE_STORED_CAP}")]
    TooLong(usize),
    /// Not a WebP of the kind that is shown.
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

/// The picture of stored bytes. Length, kind and size are looked at before anything is decoded, so that no file takes more than a few
/// milliseconds and megabytes.
///
/// # Errors
/// If it is no whole lossy WebP of [`PICTURE_SIDE`] squared.
pub fn decode_picture(stored: &[u8]) -> Result<Pixels, PictureError> {
    let flats = check(stored)?;
    // It is others' code, and nothing of it outlives the call. Browsers know no such end of a panic: there it would be the program's.
    let decoded = std::panic::catch_unwind(|| {
        let mut decoder = WebPDecoder::new(Cursor::new(stored))?;
        decoder.set_memory_limit(4 << 20);
        let mut bytes = vec![0; decoder.output_buffer_size().unwrap_or_default().min(PICTURE_SIDE * PICTURE_SIDE * 4)];
        decoder.read_image(&mut bytes).map(|()| bytes)
    });
    let bytes = decoded.map_err(|_| PictureError::Broken("its decoder gave up on it".to_owned()))?;
    let bytes = bytes.map_err(|error| PictureError::Broken(error.to_string()))?;
    let pixels = Pixels::of_rgb(PICTURE_SIDE, &bytes).filter(|pixels| pixels.height() == PICTURE_SIDE);
    let mut pixels = pixels.ok_or_else(|| PictureError::Broken("it has other texels than it says".to_owned()))?;
    flats.restore(&mut pixels);
    Ok(pixels)
}

/// A picture as stored by an encoder of lossy WebP, with those colours of its original that are flat, as [`decode_picture`] gives them back.
///
/// # Errors
/// As [`decode_picture`].
pub fn keep_flats(mut stored: Vec<u8>, original: &Pixels) -> Result<Vec<u8>, PictureError> {
    let flats = FlatColours::of(original, &decode_picture(&stored)?).bytes();
    if !flats.is_empty() {
        stored.resize(stored.len().next_multiple_of(2), 0);
        stored.extend(FLATS);
        stored.extend((flats.len() as u32).to_le_bytes());
        stored.extend(&flats);
        stored.resize(stored.len().next_multiple_of(2), 0);
        let whole = (stored.len() - 8) as u32;
        stored[4..8].copy_from_slice(&whole.to_le_bytes());
    }
    Ok(stored)
}

/// Looks at the headers: a chunk with a whole lossy frame of the right size, after it perhaps one of flat colours.
fn check(stored: &[u8]) -> Result<FlatColours, PictureError> {
    use PictureError::Strange;
    if stored.len() > PICTURE_STORED_CAP {
        return Err(PictureError::TooLong(stored.len()));
    }
    let (head, frame) = stored.split_first_chunk::<20>().ok_or(Strange("its header is cut off"))?;
    let [b'R', b'I', b'F', b'F', r0, r1, r2, r3, b'W', b'E', b'B', b'P', kind @ .., c0, c1, c2, c3] = head else {
        return Err(Strange("it is no WebP"));
    };
    if kind != b"VP8 " {
        return Err(Strange("it is not plain lossy WebP"));
    }
    let [whole, chunk] = [[*r0, *r1, *r2, *r3], [*c0, *c1, *c2, *c3]].map(|bytes| u32::from_le_bytes(bytes) as usize);
    let rest = frame.get(chunk.next_multiple_of(2).min(frame.len())..).unwrap_or_default();
    if whole != stored.len() - 8 || chunk > frame.len() {
        return Err(Strange("it is longer or shorter than it says"));
    }
    let flats = if rest.is_empty() {
        FlatColours::default()
    } else {
        flats(rest).ok_or(Strange("what follows its frame is no flat colours"))?
    };
    let [tag, _, _, 0x9D, 0x01, 0x2A, w0, w1, h0, h1, ..] = frame else { return Err(Strange("its frame is cut off")) };
    if tag & 1 != 0 {
        return Err(Strange("it begins with a change of a frame"));
    }
    // The upper two bits tell how it may be enlarged.
    let [width, height] = [[*w0, *w1], [*h0, *h1]].map(|bytes| u16::from_le_bytes(bytes) & 0x3FFF);
    let is_size = |texels: u16| usize::from(texels) == PICTURE_SIDE;
    if is_size(width) && is_size(height) { Ok(flats) } else { Err(PictureError::Size { width, height }) }
}

fn flats(chunk: &[u8]) -> Option<FlatColours> {
    let (name, rest) = chunk.split_first_chunk::<4>()?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let length = u32::from_le_bytes(*length) as usize;
    let is_whole = name == FLATS && length <= rest.len() && rest.len() - length <= 1;
    is_whole.then(|| FlatColours::of_bytes(&rest[..length])).flatten()
}
