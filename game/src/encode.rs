//! Writes films: PNG frames, mp4 through ffmpeg where it is installed, animated PNG elsewhere.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anstream::eprintln;
use image::RgbaImage;
use image::imageops::{FilterType, resize};

use crate::Failure;
use crate::studio::Size;

/// Where a film's frames go.
pub enum Encoder {
    /// Numbered PNG files in a directory.
    Frames {
        /// The directory.
        dir: PathBuf,
    },
    /// A running ffmpeg that takes raw frames.
    Video {
        /// The program.
        ffmpeg: Child,
        /// The file.
        path: PathBuf,
    },
    /// One animated PNG, at most [`ANIMATED_WIDTH`] wide and 12 frames a second.
    Animated {
        /// The writer.
        writer: Box<png::Writer<BufWriter<File>>>,
        /// Size of its frames.
        size: Size,
        /// Of so many frames one is kept.
        every: u32,
        /// The file.
        path: PathBuf,
    },
}

/// Widest animated PNG, pixels: it has no compression between frames.
pub const ANIMATED_WIDTH: u32 = 480;

/// Whether ffmpeg is there to be called.
#[must_use]
pub fn has_ffmpeg() -> bool {
    let asked = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    asked.is_ok_and(|status| status.success())
}

/// Where frame `n` of a film in a folder lies.
fn frame_path(dir: &Path, n: u32) -> PathBuf {
    dir.join(format!("{n:05}.png"))
}

impl Encoder {
    /// An encoder for what `out` names: `x.mp4`, `x.png`, or a directory. An mp4 without ffmpeg becomes an animated PNG of the
    /// same name.
    ///
    /// # Errors
    /// If the place cannot be written to, or is a folder that holds an earlier film's frames.
    pub fn open(out: &Path, size: Size, fps: u32, frames: u32) -> Result<Self, Failure> {
        let ending = out.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match ending.as_str() {
            "mp4" if has_ffmpeg() => Self::video(out, size, fps),
            "mp4" => {
                let instead = out.with_extension("png");
                eprintln!("ffmpeg is not installed: writing {} instead", instead.display());
                Self::animated(&instead, size, fps, frames)
            }
            "png" => Self::animated(out, size, fps, frames),
            ending if !ending.is_empty() => {
                Err(format!("{}: films are written as .mp4, .png, or into a folder without an ending", out.display()).into())
            }
            _ => {
                std::fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
                if frame_path(out, 0).exists() {
                    // A shorter film would end in the older one's last frames.
                    return Err(format!(
                        "{}: holds the frames of an earlier film; remove them or name another folder",
                        out.display()
                    )
                    .into());
                }
                Ok(Self::Frames { dir: out.to_owned() })
            }
        }
    }

    fn video(path: &Path, size: Size, fps: u32) -> Result<Self, Failure> {
        let ffmpeg = Command::new("ffmpeg")
            .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s"])
            .arg(format!("{}x{}", size.width, size.height))
            .args([
                "-r",
                &fps.to_string(),
                "-i",
                "-",
                "-vf",
                "crop=trunc(iw/2)*2:trunc(ih/2)*2",
                "-c:v",
                "libx264",
                "-preset",
                "medium",
            ])
            .args(["-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v", "+bitexact"])
            .args(["-map_metadata", "-1", "-threads", "2"])
            .arg(path)
            .stdin(Stdio::piped())
            .spawn()
            .map_err(|e| format!("ffmpeg: {e}"))?;
        Ok(Self::Video { ffmpeg, path: path.to_owned() })
    }

    fn animated(path: &Path, size: Size, fps: u32, frames: u32) -> Result<Self, Failure> {
        let every = fps.div_ceil(12).max(1);
        let width = size.width.min(ANIMATED_WIDTH);
        let size = Size { width, height: (size.height * width / size.width).max(1) };
        let file = File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut encoder = png::Encoder::new(BufWriter::new(file), size.width, size.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_animated(frames.div_ceil(every).max(1), 0)?;
        encoder.set_frame_delay(every.min(u32::from(u16::MAX)) as u16, fps.min(u32::from(u16::MAX)) as u16)?;
        Ok(Self::Animated { writer: Box::new(encoder.write_header()?), size, every, path: path.to_owned() })
    }

    /// Adds frame number `n`, counted from 0.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, n: u32, picture: &RgbaImage) -> Result<(), Failure> {
        match self {
            Self::Frames { dir } => {
                let path = frame_path(dir, n);
                picture.save(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            }
            Self::Video { ffmpeg, path } => {
                let pipe = ffmpeg.stdin.as_mut().ok_or("ffmpeg takes no frames")?;
                pipe.write_all(picture.as_raw()).map_err(|e| format!("{}: ffmpeg has stopped: {e}", path.display()))?;
            }
            Self::Animated { writer, size, every, .. } => {
                if n.is_multiple_of(*every) {
                    let small = resize(picture, size.width, size.height, FilterType::Triangle);
                    let rgb: Vec<u8> = small.pixels().flat_map(|p| [p[0], p[1], p[2]]).collect();
                    writer.write_image_data(&rgb)?;
                }
            }
        }
        Ok(())
    }

    /// Closes the film and says where it is.
    ///
    /// # Errors
    /// If the last of it cannot be written.
    pub fn finish(self) -> Result<PathBuf, Failure> {
        match self {
            Self::Frames { dir } => Ok(dir),
            Self::Video { mut ffmpeg, path } => {
                drop(ffmpeg.stdin.take());
                let status = ffmpeg.wait()?;
                if status.success() { Ok(path) } else { Err(format!("{}: ffmpeg ended with {status}", path.display()).into()) }
            }
            Self::Animated { writer, path, .. } => {
                writer.finish()?;
                Ok(path)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_is_not_mixed_with_an_older_one() {
        let out = std::env::temp_dir().join(format!("veduta-encode-{}", std::process::id()));
        let size = Size { width: 4, height: 2 };
        let mut first = Encoder::open(&out, size, 12, 1).unwrap();
        first.add(0, &RgbaImage::new(4, 2)).unwrap();
        first.finish().unwrap();
        let Err(refused) = Encoder::open(&out, size, 12, 1) else { panic!("an older film's frames would be overwritten") };
        assert!(refused.to_string().contains("earlier film"), "{refused}");
        std::fs::remove_dir_all(&out).unwrap();
    }
}
