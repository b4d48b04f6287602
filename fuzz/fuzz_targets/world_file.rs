#![no_main]

use glam::DVec2;
use libfuzzer_sys::fuzz_target;
use veduta_survey::{Crs, Georeference};

/// Corners of a picture and a place far out.
const PIXELS: [DVec2; 4] = [DVec2::ZERO, DVec2::new(640.0, 480.0), DVec2::new(0.5, 479.5), DVec2::new(-1e6, 1e6)];

fuzz_target!(|text: &str| {
    for epsg in [4326, 3857, 32633] {
        let Ok(crs) = Crs::from_epsg(epsg) else { continue };
        let Ok(place) = Georeference::from_world_file("fuzz.pgw", (640, 480), text, &crs) else { continue };
        assert!(place.metres_per_pixel() > 0.0 && place.metres_per_pixel().is_finite());
        for pixel in PIXELS {
            let back = place.pixel_pos(place.plan_pos(pixel));
            assert!(!back.is_nan(), "{pixel} came back as {back}");
        }
    }
});
