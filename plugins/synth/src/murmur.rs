use veduta_city::draw::Draw;

use crate::filter::{OnePole, StateVariable, rise};
use crate::noise::{White, unit};
use crate::voice::Sampled;

/// First three formants of vowels as men speak them, hertz (means of Peterson and Barney, 1952).
const VOWELS: [[f64; 3]; 7] = [
    [270.0, 2_290.0, 3_010.0],
    [390.0, 1_990.0, 2_550.0],
    [530.0, 1_840.0, 2_480.0],
    [730.0, 1_090.0, 2_440.0],
    [570.0, 840.0, 2_410.0],
    [300.0, 870.0, 2_240.0],
    [490.0, 1_350.0, 1_690.0],
];

/// People who talk somewhere across a square: each a voice with vowels and pauses of its own, then dulled and smeared by the distance.
pub(crate) struct Murmur {
    talkers: Vec<Talker>,
    far: (OnePole, OnePole),
    smear: [AllPass; 3],
    gain: f64,
}

impl Murmur {
    pub fn new(people: u8, draw: Draw, rate_hz: f64) -> Self {
        let talkers = (0..u64::from(people)).map(|n| Talker::new(draw.part(n), rate_hz)).collect();
        let smear = [0.0173, 0.0291, 0.0437].map(|seconds| AllPass::new((seconds * rate_hz) as usize));
        Self {
            talkers,
            far: (OnePole::new(1_900.0, rate_hz), OnePole::new(3_200.0, rate_hz)),
            smear,
            gain: 3.8 / libm::sqrt(f64::from(people)),
        }
    }
}

impl Sampled for Murmur {
    fn sample(&mut self) -> Option<f64> {
        let mut x: f64 = self.talkers.iter_mut().map(Talker::next).sum();
        x = self.far.1.low(self.far.0.low(x));
        for smear in &mut self.smear {
            x = smear.pass(x);
        }
        Some(x * self.gain)
    }
}

/// A delay that leaves loudness as it is and blurs time (Schroeder 1962).
struct AllPass {
    line: Vec<f64>,
    at: usize,
}

impl AllPass {
    fn new(samples: usize) -> Self {
        Self { line: vec![0.0; samples.max(1)], at: 0 }
    }

    fn pass(&mut self, x: f64) -> f64 {
        const BLUR: f64 = 0.45;
        let delayed = self.line[self.at];
        let kept = x + BLUR * delayed;
        self.line[self.at] = kept;
        self.at = (self.at + 1) % self.line.len();
        delayed - BLUR * kept
    }
}

/// Filters are tuned anew every so many samples.
const TUNED_EVERY: u32 = 48;
/// How fast the mouth moves: seconds to two thirds of the way.
const GLIDE_S: f64 = 0.035;

/// Somebody who talks in phrases of syllables with pauses between.
struct Talker {
    key: u64,
    rate_hz: f64,
    /// Voice of a man at 1, of a woman at 1.17, of a child higher.
    size: f64,
    pitch_hz: f64,
    loud: f64,
    breath: White,
    phase: f64,
    formants: [f64; 3],
    filters: [StateVariable; 3],
    syllable: Syllable,
    /// Number of the syllable, over all that is said.
    count: u64,
    /// Syllables left of the phrase.
    left: u64,
    n: u32,
}

/// What is said now, or not said.
struct Syllable {
    vowel: [f64; 3],
    /// Samples gone of it, and in all.
    at: u32,
    length: u32,
    stress: f64,
    /// Multiple of the voice's pitch at its start and at its end.
    pitch: (f64, f64),
}

impl Talker {
    fn new(draw: Draw, rate_hz: f64) -> Self {
        let is_high = draw.chance("voice", 0.5);
        let (size, pitch_hz) =
            if is_high { (1.17, draw.between("pitch", 165.0, 240.0)) } else { (1.0, draw.between("pitch", 92.0, 145.0)) };
        let key = draw.bits("talk");
        // They do not all begin at once.
        let wait_s = draw.between("wait", 0.0, 1.2);
        let silence = Syllable { vowel: VOWELS[6], at: 0, length: (wait_s * rate_hz) as u32 + 1, stress: 0.0, pitch: (1.0, 1.0) };
        Self {
            key,
            rate_hz,
            size,
            pitch_hz,
            loud: draw.between("loud", 0.6, 1.2),
            breath: White::new(draw, "breath"),
            phase: 0.0,
            formants: VOWELS[6],
            filters: [StateVariable::new(500.0, 5.0, rate_hz); 3],
            syllable: silence,
            count: 0,
            left: 0,
            n: 0,
        }
    }

    /// What follows: the next syllable, or a pause.
    fn go_on(&mut self) {
        self.count += 1;
        let asked = |what: u64| unit(self.key, self.count * 8 + what);
        if self.left == 0 {
            self.left = 4 + (asked(0) * 11.0) as u64;
            let pause_s = 0.25 + 1.6 * asked(1) * asked(1);
            self.syllable = Syllable { length: (pause_s * self.rate_hz) as u32, at: 0, stress: 0.0, ..self.syllable };
            return;
        }
        self.left -= 1;
        let is_last = self.left == 0;
        let length_s = 0.11 + 0.13 * asked(2) + if is_last { 0.1 } else { 0.0 };
        let fall = 0.06 * (6.0 - self.left as f64).max(0.0) / 6.0;
        let high = 0.94 + 0.22 * asked(3) - fall;
        self.syllable = Syllable {
            vowel: VOWELS[(asked(4) * VOWELS.len() as f64) as usize % VOWELS.len()].map(|hz| hz * self.size),
            at: 0,
            length: (length_s * self.rate_hz) as u32,
            stress: 0.45 + 0.55 * asked(5),
            pitch: (high, high * (0.92 + 0.12 * asked(6)) - if is_last { 0.08 } else { 0.0 }),
        };
    }

    fn next(&mut self) -> f64 {
        if self.syllable.at >= self.syllable.length {
            self.go_on();
        }
        let share = f64::from(self.syllable.at) / f64::from(self.syllable.length.max(1));
        self.syllable.at += 1;
        self.n = (self.n + 1) % TUNED_EVERY;
        if self.n == 0 {
            let way = 1.0 - libm::exp(-f64::from(TUNED_EVERY) / (GLIDE_S * self.rate_hz));
            for ((filter, now), goal) in self.filters.iter_mut().zip(&mut self.formants).zip(self.syllable.vowel) {
                *now += (goal - *now) * way;
                filter.tune(*now, 5.0 + *now / 400.0, self.rate_hz);
            }
        }
        if self.syllable.stress <= 0.0 {
            return 0.0;
        }
        let (from, to) = self.syllable.pitch;
        self.phase = (self.phase + self.pitch_hz * (from + (to - from) * share) / self.rate_hz).fract();
        // Open and shut within a syllable; a little breath as it begins.
        let open = rise(share / 0.22) * rise((1.0 - share) / 0.35);
        let hiss = 0.16 * rise(1.0 - share / 0.25);
        let source = pulse(self.phase) + hiss * self.breath.next();
        let levels = [1.0, 0.55, 0.25];
        let voiced: f64 = self.filters.iter_mut().zip(levels).map(|(filter, level)| level * filter.band(source)).sum();
        voiced * open * self.syllable.stress * self.loud
    }
}

/// The flow of air through the vocal folds over a period (Rosenberg 1971), less its mean: it opens, shuts faster, and stays shut.
fn pulse(phase: f64) -> f64 {
    const OPEN: f64 = 0.42;
    const SHUT: f64 = 0.16;
    let flow = if phase < OPEN {
        let x = phase / OPEN;
        x * x * (3.0 - 2.0 * x)
    } else if phase < OPEN + SHUT {
        let x = (phase - OPEN) / SHUT;
        1.0 - x * x
    } else {
        0.0
    };
    flow - (OPEN * 0.5 + SHUT * 2.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{rms, share_between};
    use crate::voice;
    use veduta_city::Sound;

    #[test]
    fn a_murmur_lies_where_voices_lie_and_comes_and_goes() {
        let mut out = vec![0.0; 6 * 32_768];
        voice(&Sound::Murmur { people: 1 }, 2, 32_768.0).expect("it is made").fill(&mut out);
        let voices = share_between(&out[32_768..2 * 32_768], (80.0, 3_500.0), 32_768.0);
        assert!(voices > 0.97, "{voices}");
        // Syllables: the loudness of tenths of a second differs widely.
        let tenths: Vec<f64> = out.chunks(3_276).map(rms).collect();
        let most = tenths.iter().copied().fold(0.0, f64::max);
        assert!(tenths.iter().filter(|&&t| t < 0.2 * most).count() > 5 && tenths.iter().filter(|&&t| t > 0.5 * most).count() > 5);
    }

    #[test]
    fn a_pulse_has_no_mean_and_no_jump() {
        let all: Vec<f64> = (0..10_000).map(|n| pulse(f64::from(n) / 10_000.0)).collect();
        assert!((all.iter().sum::<f64>() / 10_000.0).abs() < 1e-3);
        assert!(all.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.002));
    }
}
