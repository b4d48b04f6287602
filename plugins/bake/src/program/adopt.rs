use std::path::Path;

use anstream::println;
use veduta_bake::{BakeSettings, Input, adopt};

use super::Failure;

/// Takes back what was changed in a modeller, and tells of it.
pub(crate) fn take_back(input: &Input, model: &Path, quiet: bool) -> Result<(), Failure> {
    let adopted = adopt(input, model, &BakeSettings::default())?;
    for (name, path) in adopted.changed.iter().filter(|_| !quiet) {
        println!("{name}: {}", path.display());
    }
    for note in &adopted.notes {
        println!("note: {note}");
    }
    println!("{}: {} houses changed, {} as they were", adopted.overrides.display(), adopted.changed.len(), adopted.unchanged);
    Ok(())
}
