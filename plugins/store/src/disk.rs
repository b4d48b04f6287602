use std::fs;
use std::io::{Result, Write};
use std::path::Path;

/// Changes the disk, step by step. In tests it dies after so many steps, in the middle of the last: nothing is changed from then on, as
/// if the program had been killed.
#[derive(Debug, Default)]
pub(crate) struct Disk {
    #[cfg(test)]
    life: Option<std::sync::atomic::AtomicI64>,
}

impl Disk {
    /// One that dies after so many steps.
    #[cfg(test)]
    pub fn dying_after(steps: i64) -> Self {
        Self { life: Some(steps.into()) }
    }

    /// Takes a step; fails if it is dead. `true` while it lives on, `false` if this is the step of which it dies.
    #[cfg(test)]
    fn step(&self) -> Result<bool> {
        let Some(life) = &self.life else { return Ok(true) };
        match life.fetch_sub(1, std::sync::atomic::Ordering::SeqCst) {
            1.. => Ok(true),
            0 => Ok(false),
            _ => Err(std::io::Error::other("killed")),
        }
    }

    #[cfg(not(test))]
    #[expect(clippy::unused_self, clippy::unnecessary_wraps, reason = "only in tests is there anything to it")]
    const fn step(&self) -> Result<bool> {
        Ok(true)
    }

    fn whole(&self, what: impl FnOnce() -> Result<()>) -> Result<()> {
        if self.step()? { what() } else { Err(std::io::Error::other("killed")) }
    }

    /// Writes a file where nobody reads yet; its folder is made if need be.
    pub fn lay(&self, path: &Path, bytes: &[u8], is_lasting: bool) -> Result<()> {
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        let lives = self.step()?;
        let mut file = fs::File::create(path)?;
        file.write_all(if lives { bytes } else { bytes.get(..bytes.len() / 2).unwrap_or_default() })?;
        if !lives {
            return Err(std::io::Error::other("killed"));
        }
        if is_lasting { file.sync_all() } else { Ok(()) }
    }

    /// Moves a file or a folder; what was there is replaced in one step.
    pub fn rename(&self, from: &Path, to: &Path) -> Result<()> {
        self.whole(|| fs::rename(from, to))
    }

    /// Removes a file.
    pub fn remove_file(&self, path: &Path) -> Result<()> {
        self.whole(|| fs::remove_file(path))
    }

    /// Removes an empty folder.
    pub fn remove_dir(&self, path: &Path) -> Result<()> {
        self.whole(|| fs::remove_dir(path))
    }

    /// Removes a folder and all that is in it, if it is there.
    pub fn remove_all(&self, path: &Path) -> Result<()> {
        self.whole(|| match fs::remove_dir_all(path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        })
    }
}
