//! Sounds made from numbers: bells, water, wind, rain, voices, birds, steps; and the desk on which they are mixed.
//!
//! ```text
//!  Sound (veduta-city) ──voice──► Voice ──fill──► samples ─┐
//!  Ogg Vorbis ──Recording───────► Voice ──────────────────┼─► Desk: gain, pan, low-pass, delay, limiter ──► stereo
//!                                                  Orders ─┘
//! ```
//!
//! # Use
//! ```
//! use veduta_city::Sound;
//! let bell = Sound::Bell { strike_hz: 220.0, weight_kg: 1_100.0 };
//! let mut voice = veduta_synth::voice(&bell, 7, 44_100.0).expect("it is made, not recorded");
//! let mut second = vec![0.0_f32; 44_100];
//! assert_eq!(voice.fill(&mut second), second.len());
//! assert!(second.iter().any(|x| x.abs() > 0.1));
//! ```
//!
//! # Levels
//! Endless voices have a mean of −20 dB below full scale (a root mean square of 0.1) as long as something is heard of them;
//! strokes, steps and wings peak below full scale. All start and end from silence, carry no DC, and never leave ±1.
//!
//! # Determinism
//! Noise is keyed by voice and sample, so a seed gives the same samples whatever the sizes of the blocks. Sines are libm's.
//!
//! # Limits
//! What is made is told from what it imitates by anybody who listens for it; what matters more (a famous bell, a narration) is
//! better recorded.
//!
//! # Rejected
//! Samples from libraries: licences, megabytes, and loops that ears find out. A graph of sounds (`fundsp`): more than nine voices
//! need.

mod bell;
mod birds;
mod desk;
mod filter;
mod murmur;
mod night;
mod noise;
mod recording;
mod step;
mod voice;
mod water;
mod wav;
mod weather;

#[cfg(test)]
mod spectrum;

pub use desk::{BLOCK, ChannelId, Desk, Levels, Order};
pub use recording::{Recording, RecordingError};
pub use voice::{Voice, voice};
pub use wav::{WAV_HEAD, wav, wav_head, wav_samples};
