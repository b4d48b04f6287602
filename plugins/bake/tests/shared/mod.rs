//! Where the shared extracts lie.

use std::path::PathBuf;

/// The shared extracts: `VEDUTA_DATA`, else beside the workspace; `None`, told aloud, where there are none.
#[must_use]
pub fn data() -> Option<PathBuf> {
    let beside = "../../../shared/data";
    let folder = std::env::var_os("VEDUTA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no shared data");
    None
}
