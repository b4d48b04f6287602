//! A picture file as pixels: PNG, JPEG, TIFF and WebP, told by content, never taking more memory than allowed.

mod error;
mod jpeg;
mod png;
mod rows;
mod tiff;
mod webp;

pub use error::PictureError;

use crate::raster::PictureLimits;
use crate::raster::picture::error::Reason;

/// A picture as RGB, 8 bits a channel, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of every pixel: `3 * width * height` bytes.
    pub pixels: Vec<u8>,
}

impl Picture {
    /// Decodes a PNG, JPEG, TIFF or WebP file, told by its content; `name` stands in messages.
    ///
    /// Grey, palette, CMYK and 16-bit pictures become RGB of 8 bits; what is transparent is laid over white paper; colour
    /// profiles are left aside. Of an animated PNG and of a TIFF of many pages the first picture is read. Orientation tags
    /// (EXIF, TIFF) are *ignored*: world files and GeoTIFF tags speak of the rows as they are stored.
    ///
    /// # Errors
    /// [`PictureError`] if the bytes are no such file, are cut off or broken, promise more than they hold, or need more than
    /// `limits`. Refusing a file whose header is over the limits, or promises more than the file can hold, takes neither
    /// time nor memory worth mentioning.
    ///
    /// # Limits
    /// A JPEG whose entropy-coded data were changed without breaking its code decodes to wrong pixels: the format has no
    /// checksum. Lossless WebP of 16,384 pixels a side is one too many for its decoder; 16,383 is read.
    pub fn decode(bytes: &[u8], name: &str, limits: &PictureLimits) -> Result<Self, PictureError> {
        let decoder: Decode = match Format::of(bytes) {
            Some(Format::Png) => png::decode,
            Some(Format::Jpeg) => jpeg::decode,
            Some(Format::Tiff) => tiff::decode,
            Some(Format::WebP) => webp::decode,
            None => return Err(stranger(bytes).named(name)),
        };
        // The decoders under ours are others' code, and have been seen to panic on broken files. Nothing of theirs outlives the
        // call, so a panic that no check of ours foresees is one more way of saying that the file is broken.
        let decoded = std::panic::catch_unwind(|| decoder(bytes, limits));
        let upset = || Reason::Broken { format: "picture", detail: "its decoder gave up on it".to_owned() };
        decoded.unwrap_or_else(|_| Err(upset())).map_err(|reason| reason.named(name))
    }

    /// Writes it as a PNG file.
    ///
    /// # Errors
    /// What the writer says, or if it has no pixels.
    pub fn write_png(&self, to: impl std::io::Write) -> std::io::Result<()> {
        png::encode(self, to)
    }

    /// Whether bytes begin like a file that [`Picture::decode`] reads; a broken file may pass and fail later.
    #[must_use]
    pub fn looks_like_picture(bytes: &[u8]) -> bool {
        Format::of(bytes).is_some()
    }

    /// Red, green and blue of the pixel in column `x` and row `y`, if it is inside.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let from = 3 * (y * self.width + x);
        self.pixels.get(from..from + 3)?.try_into().ok()
    }
}

type Decode = fn(&[u8], &PictureLimits) -> Result<Picture, Reason>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Jpeg,
    Tiff,
    WebP,
}

impl Format {
    fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"\x89PNG") {
            Some(Self::Png)
        } else if bytes.starts_with(b"\xff\xd8\xff") {
            Some(Self::Jpeg)
        } else if [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| bytes.starts_with(*magic)) {
            Some(Self::Tiff)
        } else if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
            Some(Self::WebP)
        } else {
            None
        }
    }
}

/// What to say of a file that is none of ours: the formats that people try are named.
fn stranger(bytes: &[u8]) -> Reason {
    let known: [(&[u8], &str); 10] = [
        (b"GIF8", "GIF"),
        (b"BM", "BMP"),
        (b"%PDF", "PDF"),
        (b"\0\0\0\x0cjP  ", "JPEG 2000"),
        (b"\xff\x4f\xff\x51", "JPEG 2000"),
        (b"\0\0\0\x0cJXL ", "JPEG XL"),
        (b"\xff\x0a", "JPEG XL"),
        (b"<svg", "SVG"),
        (b"8BPS", "Photoshop's format"),
        (b"\x76\x2f\x31\x01", "OpenEXR"),
    ];
    if bytes.get(4..8) == Some(b"ftyp") {
        return Reason::Unsupported { feature: "HEIC or AVIF".to_owned(), fix: SAVE_AS_PNG };
    }
    match known.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        Some((_, format)) => Reason::Unsupported { feature: (*format).to_owned(), fix: SAVE_AS_PNG },
        None => Reason::NotPicture,
    }
}

/// What to do about most things that are not read.
const SAVE_AS_PNG: &str = "open it in a paint program and save it as PNG";

/// Checks the side, the memory, and that there is anything at all. `working_bytes` is what the decoder needs beside the
/// finished picture.
fn check_size(format: &'static str, width: u64, height: u64, working_bytes: u64, limits: &PictureLimits) -> Result<(), Reason> {
    if width == 0 || height == 0 {
        return Err(Reason::Broken { format, detail: format!("its header says {width} × {height} pixels") });
    }
    if width.max(height) > u64::from(limits.side_px) {
        return Err(Reason::TooLarge { width, height, limit: limits.side_px });
    }
    let needed = (3 * width * height).saturating_add(working_bytes);
    if needed > limits.bytes || usize::try_from(needed).is_err() {
        return Err(Reason::TooMuchMemory { width, height, needed, limit: limits.bytes });
    }
    Ok(())
}

/// The finished picture's pixels, white or black as the system gives them: untouched pages cost nothing, so a file that ends
/// early never takes what it promised.
fn blank(width: usize, height: usize) -> Vec<u8> {
    vec![0; 3 * width * height]
}
