#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_survey::ElevationGrid;

fuzz_target!(|bytes: &[u8]| {
    // The name tells an SRTM tile's place.
    for name in ["grid.asc", "N49E011.hgt"] {
        if let Ok(grid) = ElevationGrid::read(bytes, name, None) {
            let (low, high) = grid.range_m();
            assert!(low <= high && grid.cell_m() > 0.0);
            assert!((0.0..=1.0).contains(&grid.share_of_holes()));
            let _ = grid.at(49.5, 11.5);
        }
    }
});
