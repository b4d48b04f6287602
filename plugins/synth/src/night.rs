use core::f64::consts::TAU;

use veduta_city::draw::Draw;

use crate::filter::{OnePole, StateVariable, hump, rise};
use crate::noise::{Wander, unit};
use crate::voice::Sampled;

/// A summer's night: crickets, and a dog far away.
pub(crate) struct Night {
    crickets: Vec<Cricket>,
    dog: Option<Dog>,
    gain: f64,
}

impl Night {
    pub fn new(crickets: u8, dog: bool, draw: Draw, rate_hz: f64) -> Self {
        Self {
            crickets: (0..u64::from(crickets)).map(|n| Cricket::new(draw.part(n), rate_hz)).collect(),
            dog: dog.then(|| Dog::new(draw, rate_hz)),
            gain: 1.15 / libm::sqrt(f64::from(crickets.max(1))),
        }
    }
}

impl Sampled for Night {
    fn sample(&mut self) -> Option<f64> {
        let song: f64 = self.crickets.iter_mut().map(Cricket::next).sum();
        let bark = self.dog.as_mut().map_or(0.0, Dog::next);
        Some(song * self.gain + bark)
    }
}

/// A cricket: chirps of three or four pulses of one high note.
struct Cricket {
    rate_hz: f64,
    turn: f64,
    phase: f64,
    chirp_s: f64,
    pulses: f64,
    now_s: f64,
    level: f64,
    mood: Wander,
}

/// Length of a pulse, and from one to the next, seconds.
const PULSE_S: (f64, f64) = (0.017, 0.029);

impl Cricket {
    fn new(draw: Draw, rate_hz: f64) -> Self {
        let hz = draw.between("note", 4_050.0, 4_900.0).min(0.4 * rate_hz);
        Self {
            rate_hz,
            turn: hz / rate_hz,
            phase: 0.0,
            chirp_s: draw.between("chirp", 0.34, 0.52),
            pulses: if draw.chance("four", 0.5) { 4.0 } else { 3.0 },
            now_s: draw.between("start", 0.0, 0.5),
            level: draw.between("level", 0.35, 1.0),
            mood: Wander::new(draw, "mood", 2.3, rate_hz),
        }
    }

    fn next(&mut self) -> f64 {
        let within_s = self.now_s - self.chirp_s * libm::floor(self.now_s / self.chirp_s);
        self.now_s += 1.0 / self.rate_hz;
        self.phase = (self.phase + self.turn).fract();
        // Now and then it falls silent.
        let mood = rise((self.mood.next() - 0.15) * 5.0);
        let pulse = libm::floor(within_s / PULSE_S.1);
        if pulse >= self.pulses || mood <= 0.0 {
            return 0.0;
        }
        let loud = hump((within_s - pulse * PULSE_S.1) / PULSE_S.0) * (0.6 + 0.4 * pulse / self.pulses);
        loud * mood * self.level * libm::sin(TAU * self.phase)
    }
}

/// A dog that barks now and then behind many houses.
struct Dog {
    key: u64,
    rate_hz: f64,
    n: u64,
    phase: f64,
    throat: [StateVariable; 2],
    far: (OnePole, OnePole),
}

/// In every so many seconds it may bark.
const WATCH_S: f64 = 21.0;
/// Length of a bark, seconds.
const BARK_S: f64 = 0.17;

impl Dog {
    fn new(draw: Draw, rate_hz: f64) -> Self {
        Self {
            key: draw.bits("dog"),
            rate_hz,
            n: 0,
            phase: 0.0,
            throat: [StateVariable::new(620.0, 3.0, rate_hz), StateVariable::new(1_150.0, 4.0, rate_hz)],
            far: (OnePole::new(900.0, rate_hz), OnePole::new(1_400.0, rate_hz)),
        }
    }

    fn next(&mut self) -> f64 {
        let now_s = self.n as f64 / self.rate_hz;
        self.n += 1;
        let watch = libm::floor(now_s / WATCH_S);
        let asked = |what: u64| unit(self.key, watch as u64 * 8 + what);
        let gap_s = 0.32 + 0.3 * asked(2);
        let since_s = now_s - watch * WATCH_S - 3.0 - 12.0 * asked(3);
        let bark = libm::floor(since_s / gap_s);
        let barks = if asked(0) < 0.6 { 2.0 + libm::floor(3.0 * asked(1)) } else { 0.0 };
        let share = if since_s >= 0.0 && bark < barks { (since_s - bark * gap_s) / BARK_S } else { 2.0 };
        let source = if share < 1.0 {
            let hz = 390.0 - 150.0 * share;
            self.phase = (self.phase + hz / self.rate_hz).fract();
            (2.0 * self.phase - 1.0) * rise(share / 0.12) * rise((1.0 - share) / 0.7)
        } else {
            0.0
        };
        let voiced: f64 = self.throat.iter_mut().map(|filter| filter.band(source)).sum();
        0.9 * self.far.1.low(self.far.0.low(voiced))
    }
}

#[cfg(test)]
mod tests {
    use crate::spectrum::{rms, share_between};
    use crate::voice;
    use veduta_city::Sound;

    #[test]
    fn crickets_sing_high_and_in_pulses() {
        let mut out = vec![0.0; 4 * 32_768];
        voice(&Sound::Night { crickets: 1, dog: false }, 8, 32_768.0).expect("it is made").fill(&mut out);
        let loudest = out.chunks(16_384).max_by(|a, b| rms(a).total_cmp(&rms(b))).expect("some");
        assert!(share_between(loudest, (3_500.0, 5_500.0), 32_768.0) > 0.95);
    }

    #[test]
    fn a_dog_barks_now_and_then_low_and_never_long() {
        let mut out = vec![0.0; 90 * 32_768];
        voice(&Sound::Night { crickets: 0, dog: true }, 8, 32_768.0).expect("it is made").fill(&mut out);
        let tenths: Vec<f64> = out.chunks(3_276).map(rms).collect();
        let loud = tenths.iter().filter(|&&t| t > 0.02).count();
        assert!((3..200).contains(&loud), "{loud} of {} tenths of a second", tenths.len());
    }
}
