#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_survey::raster::{Picture, PictureLimits, guess_legend};

fuzz_target!(|bytes: &[u8]| {
    let limits = PictureLimits { side_px: 256, bytes: 16 << 20 };
    if let Ok(picture) = Picture::decode(bytes, "fuzz", &limits) {
        assert!(picture.width <= 256 && picture.height <= 256);
        assert_eq!(picture.pixels.len(), 3 * picture.width * picture.height);
        // The guess takes a hundred times longer than decoding such a picture.
        if bytes.len() % 32 != 0 {
            return;
        }
        let (legend, findings) = guess_legend(&picture, None);
        assert!(!legend.colours.is_empty());
        assert!(legend.to_ron_with(&findings).ends_with(")\n"));
    }
});
