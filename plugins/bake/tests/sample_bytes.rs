//! What the sample city costs on the wire.

use std::path::Path;

use veduta_bake::{BakeSettings, bake};
use veduta_city::Level;

#[test]
fn a_house_of_the_sample_city_takes_few_bytes() {
    let out = std::env::temp_dir().join(format!("veduta-bake-bytes-{}", std::process::id()));
    let baked =
        bake(Path::new("../../scenes/old_prague"), &out, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    std::fs::remove_dir_all(&out).unwrap_or_else(|e| panic!("{e}"));
    println!("{}", baked.stats);
    let bytes = |level| baked.stats.bytes_per_house(level).expect("houses");
    // Without the priors of the store (`code/priors.bin`, made anew when a form changes), it would be 83 and 19.
    assert!(bytes(Level::One) <= 64.0, "level 1 takes {:.1} B a house", bytes(Level::One));
    assert!(bytes(Level::Two) <= 16.0, "level 2 takes {:.1} B a house", bytes(Level::Two));
}
