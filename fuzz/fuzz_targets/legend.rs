#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_survey::raster::Legend;

fuzz_target!(|text: &str| {
    if let Ok(legend) = Legend::parse(text, "fuzz") {
        let again = Legend::parse(&legend.to_ron(), "again").expect("our own writing");
        assert_eq!(legend, again);
    }
});
