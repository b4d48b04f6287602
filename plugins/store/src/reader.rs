use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::{INDEX_NAME, ReadError};

/// Where a city lies: the one thing here that does I/O on reading. Called from whichever thread may wait.
pub trait Reader: Send + Sync + 'static {
    /// All bytes of a file of the city, if there are no more than `limit`.
    ///
    /// `path` is relative, of ASCII letters, digits, `.`, `_`, `-` and `/`.
    ///
    /// # Errors
    /// If the path could lead elsewhere, nothing is there, there is too much, or the disk or line fails.
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError>;

    /// The same, unless the file is still the one that came with a mark: whoever knows no marks reads it.
    ///
    /// # Errors
    /// As [`Reader::read`].
    fn read_if_changed(&self, path: &str, limit: u64, _tag: Option<&str>) -> Result<Fresh, ReadError> {
        self.read(path, limit).map(|bytes| Fresh::Changed { bytes, tag: None })
    }

    /// The place in words, for messages.
    fn describe(&self) -> String;
}

/// What came of reading a file that is kept already.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fresh {
    /// It has not changed.
    Same,
    /// It is new.
    Changed {
        /// All of it.
        bytes: Vec<u8>,
        /// The mark by which whoever sent it knows it again.
        tag: Option<String>,
    },
}

/// Fails unless a path can only lead to something within a city, whatever the system makes of odd names.
pub(crate) fn check_path(path: &str) -> Result<(), ReadError> {
    let forbid = |reason| Err(ReadError::Forbidden { path: path.chars().take(200).collect(), reason });
    if path.is_empty() || path.len() > 255 {
        return forbid("it must have 1 to 255 letters");
    }
    if !path.bytes().all(|b| b.is_ascii_alphanumeric() || b"._-/".contains(&b)) {
        return forbid("only letters, digits, `.`, `_`, `-` and `/` are allowed");
    }
    if path.split('/').any(|part| part.is_empty() || part.starts_with('.')) {
        return forbid("no part of it may be empty or begin with a dot");
    }
    Ok(())
}

/// Reads a city from a directory and never from outside of it.
#[derive(Debug, Clone)]
pub struct DirReader {
    /// Canonical, so that links can be judged by where they end.
    root: PathBuf,
}

impl DirReader {
    /// A reader of a directory that holds a city.
    ///
    /// # Errors
    /// [`ReadError::NoDirectory`] or [`ReadError::NoIndex`]; [`ReadError::Failed`] if the system does not let it be seen.
    pub fn new(dir: impl AsRef<Path>) -> Result<Self, ReadError> {
        use std::io::ErrorKind::{NotADirectory, NotFound};
        let dir = dir.as_ref();
        let fail = |error: std::io::Error| ReadError::Failed {
            place: dir.display().to_string(),
            path: INDEX_NAME.to_owned(),
            message: error.to_string(),
        };
        let root = match dir.canonicalize() {
            Ok(root) => root,
            Err(error) if matches!(error.kind(), NotFound | NotADirectory) => return Err(ReadError::NoDirectory(dir.to_owned())),
            Err(error) => return Err(fail(error)),
        };
        match root.join(INDEX_NAME).metadata() {
            Ok(about) if about.is_file() => Ok(Self { root }),
            Ok(_) => Err(ReadError::NoIndex(dir.to_owned())),
            Err(error) if matches!(error.kind(), NotFound | NotADirectory) => Err(ReadError::NoIndex(dir.to_owned())),
            Err(error) => Err(fail(error)),
        }
    }
}

impl Reader for DirReader {
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        check_path(path)?;
        let (place, path) = (self.describe(), path.to_owned());
        let fail = |error: std::io::Error| match error.kind() {
            std::io::ErrorKind::NotFound => ReadError::NotFound { place: place.clone(), path: path.clone() },
            _ => ReadError::Failed { place: place.clone(), path: path.clone(), message: error.to_string() },
        };
        let real = self.root.join(&path).canonicalize().map_err(fail)?;
        if !real.starts_with(&self.root) {
            return Err(ReadError::Forbidden { path, reason: "it is a link that leads out of the city" });
        }
        // Looked at before opening: opening a pipe would wait for ever.
        let about = real.metadata().map_err(fail)?;
        if !about.is_file() {
            return Err(ReadError::Failed { place, path, message: "it is not a file".to_owned() });
        }
        if about.len() > limit {
            return Err(ReadError::TooLarge { place, path, limit });
        }
        let mut bytes = Vec::with_capacity(about.len() as usize);
        let file = std::fs::File::open(&real).map_err(fail)?;
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(fail)?;
        if bytes.len() as u64 > limit {
            return Err(ReadError::TooLarge { place, path, limit });
        }
        Ok(bytes)
    }

    fn describe(&self) -> String {
        self.root.display().to_string()
    }
}

/// A reader for a place as a person writes it: a directory (or the index in it), `http://…` or `https://…`.
///
/// # Errors
/// If there is no such directory, no city in it, or the place is written in another way. A server is not asked yet.
pub fn open_reader(place: &str) -> Result<Arc<dyn Reader>, ReadError> {
    let scheme = place.split_once("://").map(|(scheme, _)| scheme.to_ascii_lowercase());
    match scheme.as_deref() {
        #[cfg(not(target_arch = "wasm32"))]
        Some("http" | "https") => Ok(Arc::new(crate::HttpReader::new(place)?)),
        Some(scheme) => {
            Err(ReadError::Place { place: place.to_owned(), reason: format!("`{scheme}` is not supported on this platform") })
        }
        None => {
            let path = Path::new(place);
            let is_index = path.file_name().is_some_and(|name| name == INDEX_NAME) && path.is_file();
            // The parent of a bare name is empty.
            let dir = if is_index { path.parent().filter(|dir| *dir != Path::new("")).unwrap_or(Path::new(".")) } else { path };
            Ok(Arc::new(DirReader::new(dir)?))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_relative_paths_are_asked_for() {
        let good = [INDEX_NAME, "blobs/ab/abcdef.bin", "a-b_c/d.e.f"];
        for path in good {
            assert_eq!(check_path(path), Ok(()), "{path}");
        }
        let long = "x".repeat(256);
        let bad = [
            "",
            "/",
            "/etc/passwd",
            "..",
            "../x",
            "blobs/../../x",
            "blobs/..",
            "./city.veduta",
            "blobs//x",
            "blobs/",
            ".hidden",
            "blobs/.git/x",
            "%2e%2e/x",
            "blobs/%2e%2e%2f%2e%2e/x",
            "..%2fx",
            "%252e%252e/x",
            "..\\x",
            "blobs\\..\\..\\x",
            "\\\\server\\share",
            "C:\\x",
            "C:/x",
            "C:x",
            "file:///etc/passwd",
            "http://elsewhere/x",
            "//elsewhere/x",
            "x?y=z",
            "x#y",
            "x y",
            "x\0",
            "x\n",
            "blobs/…/x",
            "．．/x",
            "~/x",
            "$HOME/x",
            "city.veduta:stream",
            long.as_str(),
        ];
        for path in bad {
            assert!(matches!(check_path(path), Err(ReadError::Forbidden { .. })), "{path:?} must be refused");
        }
    }
}
