//! What unit tests share.

use std::path::PathBuf;

/// Folder of the shared test data: `VEDUTA_DATA`, or `shared/data` beside the workspace; says so if there is none.
pub(crate) fn data() -> Option<PathBuf> {
    let beside = "../../../shared/data";
    let folder = std::env::var_os("VEDUTA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if !folder.is_dir() {
        println!("skipped: no shared data");
        return None;
    }
    Some(folder)
}
