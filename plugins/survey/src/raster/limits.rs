/// How large a picture may be, and what decoding it may take. Both are checked against what the file's header says before a
/// pixel is decoded.
///
/// ```
/// use veduta_survey::raster::{Picture, PictureError, PictureLimits};
///
/// // A PNG that says it is 100,000 pixels wide, in 33 bytes.
/// let mut bomb = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\x01\x86\xa0\0\0\0\x01\x08\x02\0\0\0".to_vec();
/// bomb.extend([0; 4]);
/// let refused = Picture::decode(&bomb, "bomb.png", &PictureLimits::default());
/// assert!(matches!(refused, Err(PictureError::TooLarge { width: 100_000, .. })));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureLimits {
    /// Longest side, pixels.
    pub side_px: u32,
    /// Most memory that decoding may take beside the file itself, the finished picture included; bytes. What is counted is
    /// what the decoders ask for; where a file turns out to hold less than it says, less is ever touched.
    pub bytes: u64,
}

impl Default for PictureLimits {
    /// 16,384 pixels a side and 3 GiB: enough for that side in every format read here. An RGB PNG of that side takes 768 MiB,
    /// a progressive JPEG without subsampling 2.25 GiB.
    fn default() -> Self {
        Self { side_px: 16_384, bytes: 3 << 30 }
    }
}
