use core::f64::consts::TAU;

use veduta_city::draw::Draw;

use crate::filter::{OnePole, StateVariable, hump};
use crate::noise::{White, unit};
use crate::voice::Sampled;

/// Songbirds: now and then one calls, a short series of chirps, each a sine that sweeps.
pub(crate) struct Songbirds {
    key: u64,
    rate_hz: f64,
    n: u64,
    /// Length of a turn: in each, one bird calls.
    turn: u64,
    turns: u64,
    chirps: Vec<Chirp>,
    gain: f64,
}

/// One chirp of a call.
#[derive(Clone, Copy)]
struct Chirp {
    start: u64,
    length: u64,
    hz: (f64, f64),
    level: f64,
    phase: f64,
}

/// Chirps that are told at a time.
const MOST_CHIRPS: usize = 24;

impl Songbirds {
    pub fn new(calls: f64, draw: Draw, rate_hz: f64) -> Self {
        Self {
            key: draw.bits("birds"),
            rate_hz,
            n: 0,
            turn: (60.0 / calls * rate_hz) as u64,
            turns: 0,
            chirps: Vec::with_capacity(MOST_CHIRPS),
            // The rarer they call, the louder a call must be for the same mean; but none shouts.
            gain: (0.6 / libm::sqrt(calls / 60.0)).clamp(0.4, 0.95),
        }
    }

    /// One bird's call, somewhere in the turn that begins.
    fn call(&mut self) {
        let asked = |what: u64| unit(self.key, self.turns * 64 + what);
        let seconds = |s: f64| (s * self.rate_hz) as u64;
        // A few birds, each with its own call: the draw of the bird tells pitch and shape.
        let bird = (asked(0) * 5.0) as u64;
        let its = |what: u64| unit(self.key ^ 0x5EED, bird * 16 + what);
        let middle_hz = (2_600.0 * libm::pow(1.9, its(0))).min(0.2 * self.rate_hz);
        let sweep = 0.12 + 0.5 * its(1);
        let (chirp_s, gap_s) = (0.05 + 0.09 * its(2), 0.03 + 0.12 * its(3));
        let count = 1 + (its(4) * 3.0 + asked(1) * 4.0) as u64;
        let level = 0.35 + 0.65 * asked(2);
        let mut start = self.n + (asked(3) * 0.5 * self.turn as f64) as u64;
        for n in 0..count {
            if self.chirps.len() >= MOST_CHIRPS {
                break;
            }
            let up = if (n + bird).is_multiple_of(2) { 1.0 } else { -1.0 };
            let high = middle_hz * (0.94 + 0.12 * asked(8 + n));
            let hz = (high * (1.0 - 0.5 * sweep * up), high * (1.0 + 0.5 * sweep * up));
            self.chirps.push(Chirp { start, length: seconds(chirp_s), hz, level, phase: 0.0 });
            start += seconds(chirp_s + gap_s);
        }
        self.turns += 1;
    }
}

impl Sampled for Songbirds {
    fn sample(&mut self) -> Option<f64> {
        if self.n >= self.turns * self.turn {
            let now = self.n;
            self.chirps.retain(|chirp| chirp.start + chirp.length > now);
            self.call();
        }
        let mut x = 0.0;
        for chirp in &mut self.chirps {
            if self.n < chirp.start || self.n >= chirp.start + chirp.length {
                continue;
            }
            let share = (self.n - chirp.start) as f64 / chirp.length as f64;
            let hz = chirp.hz.0 + (chirp.hz.1 - chirp.hz.0) * share;
            chirp.phase = (chirp.phase + hz / self.rate_hz).fract();
            x += chirp.level * hump(share) * libm::sin(TAU * chirp.phase);
        }
        self.n += 1;
        Some(x * self.gain)
    }
}

/// Birds that fly up: wings beat fast and clap at first, then slower and fainter as they go.
pub(crate) struct Wings {
    birds: Vec<Flight>,
    n: u64,
    end: u64,
    white: White,
    clap: (StateVariable, OnePole),
}

/// One bird's beats: when each begins, in samples, and how loud it is.
struct Flight {
    beats: Vec<(u64, f64)>,
    next: usize,
    body: StateVariable,
    beat_samples: f64,
}

impl Wings {
    pub fn new(birds: u8, draw: Draw, rate_hz: f64) -> Self {
        let whole = 0.75 / libm::sqrt(f64::from(birds));
        let flights: Vec<Flight> = (0..u64::from(birds))
            .map(|n| {
                let draw = draw.part(n);
                let mut at_s = draw.between("start", 0.002, 0.02 + 0.05 * f64::from(birds.min(10)));
                let (pace_hz, count) = (draw.between("pace", 8.5, 11.5), 9 + draw.below("beats", 8));
                let mut beats = Vec::new();
                for n in 0..count {
                    let gone = n as f64 / count as f64;
                    beats.push(((at_s * rate_hz) as u64, whole * libm::pow(1.0 - gone, 1.4)));
                    at_s += (1.0 + 0.7 * gone) / (pace_hz * draw.part(n as u64).between("beat", 0.94, 1.06));
                }
                let body = StateVariable::new(draw.between("body", 420.0, 900.0), 0.9, rate_hz);
                Flight { beats, next: 0, body, beat_samples: 0.075 * rate_hz }
            })
            .collect();
        let last = flights.iter().filter_map(|flight| flight.beats.last().map(|beat| beat.0)).max().unwrap_or(0);
        Self {
            birds: flights,
            n: 0,
            end: last + (0.2 * rate_hz) as u64,
            white: White::new(draw, "white"),
            clap: (StateVariable::new(1_400.0, 0.8, rate_hz), OnePole::new(5_000.0, rate_hz)),
        }
    }
}

impl Sampled for Wings {
    fn sample(&mut self) -> Option<f64> {
        if self.n >= self.end {
            return None;
        }
        let white = self.white.next();
        let clap = self.clap.0.high(self.clap.1.low(white));
        let mut x = 0.0;
        for bird in &mut self.birds {
            while bird.beats.get(bird.next + 1).is_some_and(|beat| beat.0 <= self.n) {
                bird.next += 1;
            }
            let Some(&(start, loud)) = bird.beats.get(bird.next).filter(|beat| beat.0 <= self.n) else {
                continue;
            };
            let share = (self.n - start) as f64 / bird.beat_samples;
            // Down fast, back slowly.
            let beat = if share < 0.25 { hump(share * 2.0) } else { hump(0.5 + (share - 0.25) / 1.5) };
            let slap = if bird.next < 4 { 0.7 * hump(share * 4.0) } else { 0.0 };
            x += loud * (1.5 * beat * bird.body.band(white) + slap * clap);
        }
        self.n += 1;
        // The last tenth fades, whatever the filters still hold.
        let left = (self.end - self.n) as f64 / (0.1 * self.end as f64);
        Some(x * left.min(1.0))
    }
}

#[cfg(test)]
mod tests {
    use crate::spectrum::{rms, share_between};
    use crate::voice;
    use veduta_city::Sound;

    const RATE_HZ: f64 = 32_768.0;

    #[test]
    fn calls_are_high_and_rare() {
        let mut out = vec![0.0; 20 * 32_768];
        voice(&Sound::Birds { calls: 30.0 }, 6, RATE_HZ).expect("it is made").fill(&mut out);
        let tenths: Vec<f64> = out.chunks(3_276).map(rms).collect();
        assert!(tenths.iter().filter(|&&t| t < 1e-3).count() > 60, "there are pauses");
        assert!(tenths.iter().filter(|&&t| t > 0.05).count() > 10, "there are calls");
        let loudest = out.chunks(32_768).max_by(|a, b| rms(a).total_cmp(&rms(b))).expect("some");
        assert!(share_between(loudest, (1_800.0, 9_000.0), RATE_HZ) > 0.95);
    }

    #[test]
    fn wings_beat_and_fade() {
        let mut out = vec![0.0; 5 * 32_768];
        let n = voice(&Sound::Wings { birds: 1 }, 6, RATE_HZ).expect("it is made").fill(&mut out);
        let out = &out[..n];
        assert!((0.8..3.5).contains(&(n as f64 / RATE_HZ)), "{} s", n as f64 / RATE_HZ);
        // Loudness in hundredths of a second goes up and down some nine times a second.
        let loud: Vec<f64> = out.chunks(327).map(rms).collect();
        let most = loud.iter().copied().fold(0.0, f64::max);
        let beats = loud.windows(2).filter(|pair| pair[0] < 0.12 * most && pair[1] >= 0.12 * most).count();
        assert!((4..=20).contains(&beats), "{beats} beats");
        assert!(rms(&out[..n / 3]) > 2.0 * rms(&out[2 * n / 3..]));
    }
}
