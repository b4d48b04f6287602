use veduta_city::draw::Draw;

use crate::filter::{Ringing, StateVariable, rise};
use crate::noise::White;
use crate::voice::Sampled;

/// A bell's partials: frequency as a multiple of the strike note, level in decibels, and how long it rings as a share of the hum.
/// Names and ratios are those of a church bell with a minor third (Fletcher and Rossing, *The Physics of Musical Instruments*,
/// chapter 21).
const PARTIALS: [(f64, f64, f64); 12] = [
    (0.5, -7.0, 1.0),   // hum
    (1.0, -3.0, 0.55),  // prime
    (1.2, 0.0, 0.5),    // tierce
    (1.5, -14.0, 0.32), // quint
    (2.0, 0.0, 0.34),   // nominal
    (2.52, -12.0, 0.2), // deciem
    (2.66, -13.0, 0.2), // undeciem
    (3.01, -4.0, 0.22), // duodeciem
    (4.16, -7.0, 0.15), // upper octave
    (5.43, -11.0, 0.1),
    (6.79, -15.0, 0.075),
    (8.21, -19.0, 0.055),
];

/// Seconds in which the hum of a bell of a tonne falls by 60 dB.
const HUM_S: f64 = 15.0;
/// No bell rings longer than this, seconds.
const LONGEST_S: f64 = 36.0;
/// The clapper's blow, seconds.
const BLOW_S: f64 = 0.0025;
/// In its last moments it is taken to silence, seconds.
const END_S: f64 = 0.5;

/// One stroke of a bell. Every partial is two: bells are never quite round, and the pair beats.
pub(crate) struct Bell {
    partials: Vec<Ringing>,
    clapper: White,
    clang: StateVariable,
    clang_level: f64,
    clang_decay: f64,
    n: u64,
    blow: f64,
    end: u64,
    fade: f64,
}

impl Bell {
    pub fn new(strike_hz: f64, weight_kg: f64, draw: Draw, rate_hz: f64) -> Self {
        let hum_s = (HUM_S * libm::pow(weight_kg / 1_000.0, 0.3)).clamp(0.8, LONGEST_S);
        let level = |db: f64| libm::pow(10.0, db / 20.0);
        let heard = PARTIALS.iter().enumerate().filter(|(_, (ratio, ..))| ratio * strike_hz < 0.45 * rate_hz);
        let whole: f64 = heard.clone().map(|(_, &(_, db, _))| level(db)).sum();
        let mut partials = Vec::new();
        for (n, &(ratio, db, life)) in heard {
            let part = draw.part(n as u64);
            let hz = strike_hz * ratio * part.between("tuning", 0.998, 1.002);
            // The pair lies a beat apart: one in two to eight seconds, faster for high partials.
            let beat_hz = part.between("beat", 0.12, 0.5) * ratio.max(0.6);
            let (amplitude, weak) = (0.95 * level(db) / whole, part.between("weak", 0.15, 0.4));
            partials.push(Ringing::new(hz, amplitude * (1.0 - weak), hum_s * life, rate_hz));
            partials.push(Ringing::new(hz + beat_hz, amplitude * weak, hum_s * life * 0.9, rate_hz));
        }
        let end = ((hum_s * 1.1).min(LONGEST_S) * rate_hz) as u64;
        Self {
            partials,
            clapper: White::new(draw, "clapper"),
            clang: StateVariable::new((strike_hz * 9.0).clamp(1_800.0, 5_000.0), 0.8, rate_hz),
            clang_level: 0.35,
            clang_decay: libm::exp(-1.0 / (0.012 * rate_hz)),
            n: 0,
            blow: 1.0 / (BLOW_S * rate_hz),
            end,
            fade: 1.0 / (END_S * rate_hz),
        }
    }
}

/// Partials that have died away are let go every so many samples.
const REST: u64 = 4_096;

impl Sampled for Bell {
    fn sample(&mut self) -> Option<f64> {
        if self.n >= self.end {
            return None;
        }
        if self.n.is_multiple_of(REST) {
            self.partials.retain(|partial| partial.amplitude() > 1e-6);
        }
        let mut x: f64 = self.partials.iter_mut().map(Ringing::next).sum();
        if self.clang_level > 1e-5 {
            x += self.clang.band(self.clapper.next()) * self.clang_level;
            self.clang_level *= self.clang_decay;
        }
        let left = (self.end - self.n) as f64 * self.fade;
        let gain = rise(self.n as f64 * self.blow) * rise(left);
        self.n += 1;
        Some(x * gain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{amplitude_at, rms};
    use crate::voice;
    use veduta_city::Sound;

    const RATE_HZ: f64 = 44_100.0;

    fn stroke(strike_hz: f64, weight_kg: f64) -> Vec<f32> {
        let mut out = vec![0.0; (40.0 * RATE_HZ) as usize];
        let n = voice(&Sound::Bell { strike_hz, weight_kg }, 1, RATE_HZ).expect("it is made").fill(&mut out);
        out.truncate(n);
        out
    }

    #[test]
    fn partials_stand_where_a_bells_partials_are() {
        for strike_hz in [110.0, 220.0, 523.0] {
            let out = stroke(strike_hz, 3_000.0);
            let second = &out[2_000..2_000 + 44_100];
            let at = |ratio: f64| {
                let around = (-20..=20).map(|n| amplitude_at(second, strike_hz * ratio * (1.0 + f64::from(n) * 2e-4), RATE_HZ));
                around.fold(0.0, f64::max)
            };
            for ratio in [0.5, 1.0, 1.2, 2.0, 3.01] {
                assert!(at(ratio) > 8.0 * at(ratio * 1.1).max(at(ratio * 0.93)), "{strike_hz} Hz: {ratio} stands out");
            }
            assert!(at(1.2) > at(1.5), "the tierce is louder than the quint");
        }
    }

    #[test]
    fn the_hum_outlives_what_is_above_it_and_heavy_bells_ring_longer() {
        let out = stroke(220.0, 3_000.0);
        let late = &out[(5.0 * RATE_HZ) as usize..(6.0 * RATE_HZ) as usize];
        assert!(amplitude_at(late, 110.0, RATE_HZ) > 5.0 * amplitude_at(late, 220.0 * 4.16, RATE_HZ));
        let (small, great) = (stroke(880.0, 20.0), stroke(110.0, 9_000.0));
        assert!(small.len() * 3 < great.len(), "{} and {} samples", small.len(), great.len());
        assert!((0.05..0.35).contains(&rms(&out[..44_100])), "{}", rms(&out[..44_100]));
    }

    #[test]
    fn nothing_lies_above_what_the_rate_can_tell() {
        let bell = Bell::new(4_000.0, 1.0, Draw::new(1, veduta_city::Id(1), "t"), 22_050.0);
        // Of partials from 2 kHz on, those below 9.9 kHz are left, two each.
        assert_eq!(bell.partials.len(), 2 * PARTIALS.iter().filter(|(ratio, ..)| ratio * 4_000.0 < 9_922.0).count());
    }
}
