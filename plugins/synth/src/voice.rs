use veduta_city::{Id, Sound, draw::Draw};

use crate::bell::Bell;
use crate::birds::{Songbirds, Wings};
use crate::filter::DcBlocker;
use crate::murmur::Murmur;
use crate::night::Night;
use crate::step::Step;
use crate::water::Water;
use crate::weather::{Rain, Wind};

/// A sound that is being made: one channel of samples in ±1, one block after another.
pub trait Voice: Send + Sync {
    /// Fills a block with the samples that follow, and gives back how many there were: fewer than asked for once it is over.
    fn fill(&mut self, out: &mut [f32]) -> usize;
}

/// What makes samples one by one; `None` once it is over.
pub(crate) trait Sampled: Send + Sync {
    fn sample(&mut self) -> Option<f64>;
}

/// Seconds in which an endless voice comes from silence.
const RISE_S: f64 = 0.05;

/// A voice with its start softened, without DC, within ±1.
struct Finished<S> {
    source: S,
    dc: DcBlocker,
    gain: f64,
    rise: f64,
}

impl<S: Sampled> Voice for Finished<S> {
    fn fill(&mut self, out: &mut [f32]) -> usize {
        for (n, slot) in out.iter_mut().enumerate() {
            let Some(x) = self.source.sample() else { return n };
            *slot = within(self.dc.pass(x) * self.gain) as f32;
            self.gain = (self.gain + self.rise).min(1.0);
        }
        out.len()
    }
}

/// Bends what is louder than 0.7 so that it stays within ±1, without a corner.
fn within(x: f64) -> f64 {
    const KNEE: f64 = 0.7;
    let over = x.abs() - KNEE;
    if over <= 0.0 {
        return x;
    }
    let room = 1.0 - KNEE;
    (KNEE + room * over / (over + room)).copysign(x)
}

/// Lowest and highest rate at which voices are made, samples a second.
const RATES: (f64, f64) = (8_000.0, 192_000.0);

/// A voice for a sound that is made; `None` for a recording. The seed tells voices of one sound apart; a rate out of 8 to 192 kHz
/// is brought within.
#[must_use]
pub fn voice(sound: &Sound, seed: u64, rate_hz: f64) -> Option<Box<dyn Voice>> {
    let rate_hz = if rate_hz.is_finite() { rate_hz.clamp(RATES.0, RATES.1) } else { 44_100.0 };
    // Bad numbers have been told when the file was read; here they must do no harm.
    if !sound.validate().is_empty() {
        return None;
    }
    let draw = Draw::new(seed, Id::NONE, "voice");
    let endless = 1.0 / (RISE_S * rate_hz);
    Some(match *sound {
        Sound::File(_) => return None,
        Sound::Bell { strike_hz, weight_kg } => finished(Bell::new(strike_hz, weight_kg, draw, rate_hz), 1.0, rate_hz),
        Sound::Step { on } => finished(Step::new(on, draw, rate_hz), 1.0, rate_hz),
        Sound::Wings { birds } => finished(Wings::new(birds, draw, rate_hz), 1.0, rate_hz),
        Sound::Water { flow, spray, bubbles, lapping } => {
            finished(Water::new([flow, spray, bubbles, lapping], draw, rate_hz), endless, rate_hz)
        }
        Sound::Wind { strength } => finished(Wind::new(strength, draw, rate_hz), endless, rate_hz),
        Sound::Rain { strength } => finished(Rain::new(strength, draw, rate_hz), endless, rate_hz),
        Sound::Murmur { people } => finished(Murmur::new(people, draw, rate_hz), endless, rate_hz),
        Sound::Birds { calls } => finished(Songbirds::new(calls, draw, rate_hz), endless, rate_hz),
        Sound::Night { crickets, dog } => finished(Night::new(crickets, dog, draw, rate_hz), endless, rate_hz),
    })
}

/// A voice that rises by so much a sample; what rises at once brings its own start.
fn finished<S: Sampled + 'static>(source: S, rise: f64, rate_hz: f64) -> Box<dyn Voice> {
    Box::new(Finished { source, dc: DcBlocker::new(rate_hz), gain: if rise < 1.0 { 0.0 } else { 1.0 }, rise })
}

#[cfg(test)]
mod tests {
    use veduta_city::{Footfall, Soundscape};

    use super::*;
    use crate::spectrum::{mean, peak, rms};

    const RATE_HZ: f64 = 44_100.0;

    /// One of every kind.
    fn all() -> Vec<Sound> {
        let mut all = vec![
            Sound::Bell { strike_hz: 220.0, weight_kg: 2_000.0 },
            Sound::FOUNTAIN,
            Sound::RIVER,
            Sound::WEIR,
            Sound::Wind { strength: 0.2 },
            Sound::Wind { strength: 1.0 },
            Sound::Rain { strength: 0.1 },
            Sound::Rain { strength: 1.0 },
            Sound::Murmur { people: 1 },
            Sound::Murmur { people: 12 },
            Sound::Birds { calls: 60.0 },
            Sound::Wings { birds: 6 },
            Sound::Night { crickets: 4, dog: true },
        ];
        all.extend(Footfall::ALL.map(|on| Sound::Step { on }));
        all.extend(Soundscape::usual_beds().into_iter().map(|bed| bed.sound));
        all
    }

    /// So many seconds of a sound, or all of it.
    fn made(sound: &Sound, seed: u64, seconds: f64, rate_hz: f64) -> Vec<f32> {
        let mut out = vec![0.0; (seconds * rate_hz) as usize];
        let n = voice(sound, seed, rate_hz).expect("it is made").fill(&mut out);
        out.truncate(n);
        out
    }

    #[test]
    fn blocks_of_any_size_hold_the_same_samples() {
        for sound in all() {
            let whole = made(&sound, 3, 1.5, RATE_HZ);
            let mut pieces = vec![0.0; whole.len()];
            let mut voice = voice(&sound, 3, RATE_HZ).expect("it is made");
            let (mut at, sizes) = (0, [1, 7, 64, 333, 1_024]);
            for size in sizes.into_iter().cycle() {
                if at == pieces.len() {
                    break;
                }
                let end = pieces.len().min(at + size);
                assert_eq!(voice.fill(&mut pieces[at..end]), end - at);
                at = end;
            }
            assert!(whole.iter().zip(&pieces).all(|(a, b)| a.to_bits() == b.to_bits()), "{sound:?}");
        }
    }

    #[test]
    fn seeds_tell_voices_apart() {
        for sound in all() {
            let [one, other] = [1, 2].map(|seed| made(&sound, seed, 4.0, RATE_HZ));
            assert!(one != other, "{sound:?}");
        }
    }

    #[test]
    fn every_voice_keeps_its_level_at_every_rate() {
        for sound in all() {
            for rate_hz in [16_000.0, 22_050.0, 44_100.0, 48_000.0, 96_000.0] {
                let out = made(&sound, 5, 12.0, rate_hz);
                assert!(out.iter().all(|x| x.is_finite()), "{sound:?} at {rate_hz}");
                assert!(peak(&out) <= 1.0, "{sound:?} at {rate_hz}: {}", peak(&out));
                assert!(mean(&out).abs() < 2e-3, "{sound:?} at {rate_hz}: a mean of {}", mean(&out));
                if sound.is_endless() {
                    assert_eq!(out.len(), (12.0 * rate_hz) as usize);
                    let level = rms(&out);
                    assert!((0.03..0.25).contains(&level), "{sound:?} at {rate_hz}: {level}");
                } else {
                    assert!((0.1..=1.0).contains(&peak(&out)), "{sound:?} at {rate_hz}: peaks at {}", peak(&out));
                }
            }
        }
    }

    #[test]
    fn voices_begin_and_end_without_a_click() {
        for sound in all() {
            let out = made(&sound, 5, 120.0, RATE_HZ);
            // A click is a jump from silence: nothing that a membrane follows.
            assert!(out[0].abs() < 0.02, "{sound:?} begins with {}", out[0]);
            if !sound.is_endless() {
                assert!((out.len() as f64) < 60.0 * RATE_HZ, "{sound:?} ends");
                let last = &out[out.len() - 16..];
                assert!(peak(last) < 2e-3, "{sound:?} ends with {last:?}");
            }
        }
    }

    #[test]
    fn what_is_too_loud_is_bent_smoothly() {
        assert_eq!((within(0.5), within(-0.7)), (0.5, -0.7));
        for n in 0..100 {
            let x = f64::from(n) * 0.1;
            assert!(within(x) <= 1.0 && within(x + 0.1) > within(x) && within(-x) == -within(x));
        }
    }

    #[test]
    fn bad_numbers_and_recordings_have_no_voice() {
        for sound in [Sound::File("x.ogg".into()), Sound::Bell { strike_hz: f64::NAN, weight_kg: 1.0 }, Sound::Murmur { people: 0 }]
        {
            assert!(voice(&sound, 1, RATE_HZ).is_none(), "{sound:?}");
        }
        assert!(voice(&Sound::FOUNTAIN, 1, f64::NAN).is_some() && voice(&Sound::FOUNTAIN, 1, 0.0).is_some());
    }
}
