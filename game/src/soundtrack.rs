//! The sound of a film: a WAV file beside it, or within it where ffmpeg can put it there.

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use veduta_synth::{wav_head, wav_samples};

use crate::Failure;

/// Frames of sound a second.
pub(crate) const RATE_HZ: u32 = 48_000;

/// A sound track that grows with its film.
pub(crate) struct TrackFile {
    file: BufWriter<File>,
    path: PathBuf,
    frames: u64,
}

impl TrackFile {
    /// The track of a film: of its name, and beside it.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn beside(film: &Path) -> Result<Self, Failure> {
        let name = film.file_stem().unwrap_or_default().to_string_lossy();
        let path = film.with_file_name(format!("{name}.wav"));
        let file = File::create(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut track = Self { file: BufWriter::new(file), path, frames: 0 };
        // How long it is stands in its head: told in the end.
        track.write(&wav_head(0, RATE_HZ))?;
        Ok(track)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.file.write_all(bytes).map_err(|error| format!("{}: {error}", self.path.display()).into())
    }

    /// Adds interleaved stereo.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, stereo: &[f32]) -> Result<(), Failure> {
        self.frames += stereo.len() as u64 / 2;
        self.write(&wav_samples(stereo))
    }

    /// Closes it. Of a film in mp4 it becomes a part; else gives back where it is.
    ///
    /// # Errors
    /// If it cannot be written, or ffmpeg cannot join the two.
    pub fn finish(mut self, film: &Path) -> Result<Option<PathBuf>, Failure> {
        let told = |error: std::io::Error| format!("{}: {error}", self.path.display());
        self.file.seek(SeekFrom::Start(0)).map_err(told)?;
        self.file.write_all(&wav_head(self.frames, RATE_HZ)).map_err(told)?;
        self.file.flush().map_err(told)?;
        drop(self.file);
        if film.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("mp4")) {
            return Ok(Some(self.path));
        }
        let joined = film.with_extension("joined.mp4");
        let status = Command::new("ffmpeg")
            .args(["-y", "-loglevel", "error", "-i"])
            .arg(film)
            .arg("-i")
            .arg(&self.path)
            .args(["-c:v", "copy", "-c:a", "aac", "-b:a", "160k", "-movflags", "+faststart", "-fflags", "+bitexact"])
            .args(["-map_metadata", "-1"])
            .arg(&joined)
            .status()
            .map_err(|error| format!("ffmpeg: {error}"))?;
        if !status.success() {
            return Err(format!("{}: ffmpeg ended with {status}; its sound is {}", film.display(), self.path.display()).into());
        }
        std::fs::rename(&joined, film).map_err(|error| format!("{}: {error}", film.display()))?;
        std::fs::remove_file(&self.path).map_err(|error| format!("{}: {error}", self.path.display()))?;
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_lies_beside_its_film_and_tells_its_length() {
        let folder = std::env::temp_dir().join(format!("veduta-track-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("room");
        let film = folder.join("walk.png");
        let mut track = TrackFile::beside(&film).expect("room");
        track.add(&[0.5; 200]).expect("room");
        track.add(&[-0.5; 200]).expect("room");
        let path = track.finish(&film).expect("room").expect("no part of a picture");
        let bytes = std::fs::read(&path).expect("it is there");
        assert_eq!((path, bytes.len()), (folder.join("walk.wav"), 44 + 800));
        assert_eq!(bytes[..44], wav_head(200, RATE_HZ));
        let _ = std::fs::remove_dir_all(folder);
    }
}
