use std::collections::VecDeque;
use std::io::Cursor;
use std::sync::Arc;

use lewton::VorbisError;
use lewton::inside_ogg::OggStreamReader;

use crate::filter::rise;
use crate::voice::Voice;

/// A recording in Ogg Vorbis, whose head has been read and found good. It is decoded as it plays; several channels are heard as one.
#[derive(Clone)]
pub struct Recording {
    bytes: Arc<[u8]>,
    rate_hz: u32,
    /// As its last page tells.
    frames: Option<u64>,
}

/// A recording that cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file is larger than a recording may be.
    #[error("{bytes} bytes is more than a recording may have ({} MB); cut it, or encode it with less", Recording::LARGEST >> 20)]
    TooLarge {
        /// Its size.
        bytes: usize,
    },
    /// It is no Ogg Vorbis, or its head is broken.
    #[error("it is not Ogg Vorbis ({0}); convert it, for example by `ffmpeg -i it -c:a libvorbis it.ogg`")]
    NotVorbis(String),
    /// Its rate or its channels are not what anybody records with.
    #[error("{channels} channels at {rate_hz} Hz: give 1 to 8 channels at 8,000 to 192,000 Hz")]
    Odd {
        /// Channels.
        channels: u8,
        /// Samples a second.
        rate_hz: u32,
    },
}

impl Recording {
    /// Larger files are refused; bytes.
    pub const LARGEST: usize = 32 << 20;

    /// Looks at the head of a file.
    ///
    /// # Errors
    /// [`RecordingError`] if it is too large, no Ogg Vorbis, or of an odd rate.
    pub fn new(bytes: impl Into<Arc<[u8]>>) -> Result<Self, RecordingError> {
        let bytes = bytes.into();
        if bytes.len() > Self::LARGEST {
            return Err(RecordingError::TooLarge { bytes: bytes.len() });
        }
        let reader =
            OggStreamReader::new(Cursor::new(Arc::clone(&bytes))).map_err(|error| RecordingError::NotVorbis(error.to_string()))?;
        let (channels, rate_hz) = (reader.ident_hdr.audio_channels, reader.ident_hdr.audio_sample_rate);
        if !((1..=8).contains(&channels) && (8_000..=192_000).contains(&rate_hz)) {
            return Err(RecordingError::Odd { channels, rate_hz });
        }
        let frames = last_position(&bytes);
        Ok(Self { bytes, rate_hz, frames })
    }

    /// How long it plays, as its last page tells; seconds. 0 where it does not.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.frames.unwrap_or(0) as f64 / f64::from(self.rate_hz)
    }

    /// A voice that plays it at a rate, once or over and over. Where it turns out to be broken, it ends.
    #[must_use]
    pub fn voice(&self, rate_hz: f64, is_repeated: bool) -> Box<dyn Voice> {
        let step = f64::from(self.rate_hz) / if rate_hz.is_finite() { rate_hz.clamp(8_000.0, 192_000.0) } else { 44_100.0 };
        let fade = (FADE_S * f64::from(self.rate_hz)) as usize;
        Box::new(Playing {
            recording: self.clone(),
            reader: None,
            is_repeated,
            is_read: false,
            waiting: VecDeque::new(),
            read: 0,
            window: [0.0; 4],
            gone: 0,
            fade,
            at: 2.0,
            step,
        })
    }
}

/// Position of the last page that tells one, in frames: pages begin with `OggS`, and the position is at their seventh byte.
fn last_position(bytes: &[u8]) -> Option<u64> {
    let page = bytes.windows(4).rposition(|window| window == b"OggS")?;
    let position = u64::from_le_bytes(bytes.get(page + 6..page + 14)?.try_into().ok()?);
    (position != u64::MAX).then_some(position)
}

/// Seconds in which a recording comes from silence and goes into it.
const FADE_S: f64 = 0.008;

struct Playing {
    recording: Recording,
    reader: Option<OggStreamReader<Cursor<Arc<[u8]>>>>,
    is_repeated: bool,
    /// Whether this round has been read to its end.
    is_read: bool,
    waiting: VecDeque<f32>,
    /// Frames read of this round.
    read: u64,
    /// Four samples about the place that is heard: between the second and the third.
    window: [f32; 4],
    /// Samples taken of this round.
    gone: usize,
    fade: usize,
    /// How far between them, 0 to 1; more as long as samples are to be taken.
    at: f64,
    step: f64,
}

impl Playing {
    /// Reads on until more waits than is needed to know the end when it comes.
    fn read_on(&mut self) {
        while !self.is_read && self.waiting.len() <= self.fade {
            if self.reader.is_none() {
                self.reader = OggStreamReader::new(Cursor::new(Arc::clone(&self.recording.bytes))).ok();
            }
            let packet: Option<Vec<Vec<f32>>> = self.reader.as_mut().and_then(|reader| next_packet(reader).ok().flatten());
            let Some(channels) = packet else {
                (self.is_read, self.reader) = (true, None);
                return;
            };
            let share = 1.0 / channels.len().max(1) as f32;
            // The last packet is filled up: what goes beyond the end is none of it.
            let left = self.recording.frames.map_or(u64::MAX, |frames| frames.saturating_sub(self.read));
            let frames = channels.first().map_or(0, Vec::len).min(usize::try_from(left).unwrap_or(usize::MAX));
            self.read += frames as u64;
            let mixed = (0..frames).map(|n| channels.iter().filter_map(|c| c.get(n)).sum::<f32>() * share);
            self.waiting.extend(mixed.map(|x| if x.is_finite() { x.clamp(-1.0, 1.0) } else { 0.0 }));
        }
    }

    /// The next sample of the recording, faded at its ends; `None` once there are no more.
    fn next(&mut self) -> Option<f32> {
        self.read_on();
        let Some(x) = self.waiting.pop_front() else {
            // An empty one would go round for ever.
            if !self.is_repeated || self.gone == 0 {
                return None;
            }
            (self.is_read, self.gone, self.read) = (false, 0, 0);
            self.read_on();
            return self.waiting.pop_front().map(|_| 0.0);
        };
        let share = |n: usize| rise(n as f64 / self.fade.max(1) as f64) as f32;
        let fall = if self.is_read { share(self.waiting.len()) } else { 1.0 };
        let gain = share(self.gone).min(fall);
        self.gone += 1;
        Some(x * gain)
    }
}

fn next_packet(reader: &mut OggStreamReader<Cursor<Arc<[u8]>>>) -> Result<Option<Vec<Vec<f32>>>, VorbisError> {
    reader.read_dec_packet_generic::<Vec<Vec<f32>>>()
}

impl Voice for Playing {
    fn fill(&mut self, out: &mut [f32]) -> usize {
        for (n, slot) in out.iter_mut().enumerate() {
            while self.at >= 1.0 {
                let Some(x) = self.next() else { return n };
                self.window = [self.window[1], self.window[2], self.window[3], x];
                self.at -= 1.0;
            }
            *slot = between(self.window, self.at as f32);
            self.at += self.step;
        }
        out.len()
    }
}

/// A cubic (Catmull-Rom) between the second and the third of four samples.
fn between([a, b, c, d]: [f32; 4], x: f32) -> f32 {
    let slope = 0.5 * (c - a);
    let bend = a - 2.5 * b + 2.0 * c - 0.5 * d;
    let twist = 1.5 * (b - c) + 0.5 * (d - a);
    ((twist * x + bend) * x + slope) * x + b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{amplitude_at, peak};

    /// Half a second of 440 Hz at 22,050 Hz, in stereo with the right at half the left.
    const TONE: &[u8] = include_bytes!("../tests/tone.ogg");

    fn play(rate_hz: f64, is_repeated: bool, frames: usize) -> Vec<f32> {
        let recording = Recording::new(TONE).unwrap_or_else(|e| panic!("{e}"));
        let mut out = vec![0.0; frames];
        let n = recording.voice(rate_hz, is_repeated).fill(&mut out);
        out.truncate(n);
        out
    }

    #[test]
    fn a_recording_plays_at_its_pitch_whatever_the_rate() {
        let recording = Recording::new(TONE).unwrap_or_else(|e| panic!("{e}"));
        assert!((recording.seconds() - 0.5).abs() < 0.01, "{}", recording.seconds());
        for rate_hz in [22_050.0, 44_100.0, 48_000.0] {
            let out = play(rate_hz, false, 200_000);
            assert!((out.len() as f64 / rate_hz - 0.5).abs() < 0.01, "{} samples at {rate_hz}", out.len());
            let at = |hz| amplitude_at(&out, hz, rate_hz);
            assert!(at(440.0) > 0.2 && at(440.0) > 20.0 * at(880.0), "{} and {}", at(440.0), at(880.0));
            assert!(out[0].abs() < 0.01 && out[out.len() - 1].abs() < 0.02);
        }
    }

    #[test]
    fn what_is_repeated_goes_on_without_a_click() {
        let out = play(22_050.0, true, 60_000);
        assert_eq!(out.len(), 60_000);
        // 440 Hz at 0.375 moves 0.047 a sample.
        let jump = out.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
        assert!(jump < 0.06 && peak(&out[40_000..]) > 0.3, "{jump}");
    }

    #[test]
    fn what_is_broken_is_told_or_ends() {
        for bytes in [&b""[..], b"OggS", &TONE[..60], b"RIFF....WAVE"] {
            assert!(matches!(Recording::new(bytes), Err(RecordingError::NotVorbis(_))), "{} bytes", bytes.len());
        }
        let large = vec![0_u8; Recording::LARGEST + 1];
        assert!(matches!(Recording::new(large), Err(RecordingError::TooLarge { .. })));
        // Cut off or scrambled behind its head, it ends early.
        for cut in (TONE.len() / 2..TONE.len()).step_by(97) {
            let mut bytes = TONE[..cut].to_vec();
            let mut out = vec![0.0; 50_000];
            if let Ok(recording) = Recording::new(bytes.clone()) {
                assert!(recording.voice(22_050.0, true).fill(&mut out) <= out.len());
            }
            bytes.extend(&TONE[cut..]);
            for (n, byte) in bytes.iter_mut().enumerate().skip(cut) {
                *byte ^= (n % 251) as u8;
            }
            if let Ok(recording) = Recording::new(bytes) {
                recording.voice(22_050.0, false).fill(&mut out);
                assert!(out.iter().all(|x| x.is_finite()));
            }
        }
    }
}
