//! A folder of a test's own.

use std::path::PathBuf;

/// A folder of its own that is removed in the end.
pub struct Folder(pub PathBuf);

impl Folder {
    /// An empty folder of that name among those of this process.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-bake-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Self(path)
    }

    /// Writes a file into it.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
