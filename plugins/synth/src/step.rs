use veduta_city::{Footfall, draw::Draw};

use crate::filter::{OnePole, Ringing, StateVariable, rise};
use crate::noise::{White, unit};
use crate::voice::Sampled;

/// What a shoe makes of a kind of ground.
struct Ground {
    /// Centre of what is heard of the blow, hertz, and how sharp it is.
    tone_hz: f64,
    q: f64,
    /// How long heel and toe sound, seconds.
    heel_s: f64,
    toe_s: f64,
    /// Levels of the blow, of the body's thud and of grains that give way.
    blow: f64,
    thud: f64,
    grains: f64,
    /// What rings under the blow: hertz and level.
    rings: &'static [(f64, f64)],
}

const fn ground(on: Footfall) -> Ground {
    match on {
        Footfall::Cobble => Ground {
            tone_hz: 1_900.0,
            q: 0.9,
            heel_s: 0.018,
            toe_s: 0.03,
            blow: 1.0,
            thud: 0.35,
            grains: 0.08,
            rings: &[(1_240.0, 0.12), (2_750.0, 0.08)],
        },
        Footfall::Flagstone => Ground {
            tone_hz: 1_350.0,
            q: 1.1,
            heel_s: 0.014,
            toe_s: 0.022,
            blow: 1.0,
            thud: 0.4,
            grains: 0.03,
            rings: &[(860.0, 0.14)],
        },
        Footfall::Gravel => {
            Ground { tone_hz: 2_600.0, q: 0.6, heel_s: 0.05, toe_s: 0.09, blow: 0.25, thud: 0.25, grains: 1.0, rings: &[] }
        }
        Footfall::Grass => {
            Ground { tone_hz: 900.0, q: 0.5, heel_s: 0.06, toe_s: 0.1, blow: 0.4, thud: 0.35, grains: 0.12, rings: &[] }
        }
        Footfall::Wood => Ground {
            tone_hz: 700.0,
            q: 1.2,
            heel_s: 0.02,
            toe_s: 0.03,
            blow: 0.7,
            thud: 0.6,
            grains: 0.0,
            rings: &[(178.0, 0.5), (342.0, 0.3), (610.0, 0.14)],
        },
    }
}

/// One step: the heel strikes, then the ball of the foot comes down, softer and longer.
pub(crate) struct Step {
    ground: Ground,
    white: White,
    tone: StateVariable,
    bright: OnePole,
    key: u64,
    ringing: Vec<Ringing>,
    rate_hz: f64,
    n: u64,
    toe: u64,
    end: u64,
    grain: f64,
    strength: f64,
}

impl Step {
    pub fn new(on: Footfall, draw: Draw, rate_hz: f64) -> Self {
        let ground = ground(on);
        let tone_hz = ground.tone_hz * draw.between("tone", 0.85, 1.18);
        let toe_s = draw.between("toe", 0.07, 0.115);
        let mut step = Self {
            tone: StateVariable::new(tone_hz, ground.q, rate_hz),
            ground,
            white: White::new(draw, "white"),
            bright: OnePole::new(5_500.0, rate_hz),
            key: draw.bits("grains"),
            ringing: Vec::new(),
            rate_hz,
            n: 0,
            toe: (toe_s * rate_hz) as u64,
            end: ((toe_s + 0.28) * rate_hz) as u64,
            grain: 0.0,
            strength: draw.between("strength", 0.75, 1.0),
        };
        step.strike(1.0);
        step
    }

    /// What rings when a part of the foot comes down.
    fn strike(&mut self, force: f64) {
        self.ringing.push(Ringing::new(86.0, 0.5 * self.ground.thud * force, 0.09, self.rate_hz));
        let rings = self.ground.rings.iter().map(|&(hz, level)| Ringing::new(hz, 0.6 * level * force, 0.12, self.rate_hz));
        self.ringing.extend(rings);
    }

    /// How strongly a part of the foot that came down so long ago is heard.
    fn pressed(&self, since: f64, length_s: f64) -> f64 {
        rise(since / 0.0012) * libm::exp(-since / length_s)
    }
}

/// Grains a second that give way under a foot.
const GRAINS_S: f64 = 900.0;

impl Sampled for Step {
    fn sample(&mut self) -> Option<f64> {
        if self.n >= self.end {
            return None;
        }
        if self.n == self.toe {
            self.strike(0.45);
        }
        let now_s = self.n as f64 / self.rate_hz;
        let heel = self.pressed(now_s, self.ground.heel_s);
        let toe_since = (self.n as f64 - self.toe as f64) / self.rate_hz;
        let toe = if toe_since >= 0.0 { 0.5 * self.pressed(toe_since, self.ground.toe_s) } else { 0.0 };
        let white = self.bright.low(self.white.next());
        let mut x = 1.5 * self.ground.blow * self.tone.band(white) * (heel + toe);
        if self.ground.grains > 0.0 {
            // Grains fall in at random; each is a short rustle.
            let slot = self.n / (self.rate_hz / GRAINS_S) as u64;
            let hard = unit(self.key, slot);
            let goal = if hard > 0.55 { libm::pow(hard, 4.0) } else { 0.0 };
            self.grain += (goal - self.grain) * 0.12 * 44_100.0 / self.rate_hz.max(8_000.0);
            x += 1.7 * self.ground.grains * self.grain * white * (heel + 1.2 * toe);
        }
        x += self.ringing.iter_mut().map(Ringing::next).sum::<f64>();
        self.n += 1;
        let left = (self.end - self.n) as f64 / (0.05 * self.rate_hz);
        Some(0.8 * x * self.strength * rise(left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{rms, share_between};
    use crate::voice;
    use veduta_city::Sound;

    fn step(on: Footfall, seed: u64) -> Vec<f32> {
        let mut out = vec![0.0; 32_768];
        let n = voice(&Sound::Step { on }, seed, 32_768.0).expect("it is made").fill(&mut out);
        out.truncate(n);
        out
    }

    #[test]
    fn heel_and_toe_are_two_blows() {
        for on in [Footfall::Cobble, Footfall::Flagstone, Footfall::Wood] {
            let out = step(on, 3);
            let loud: Vec<f64> = out.chunks(164).map(rms).collect();
            let heel = loud[..10].iter().copied().fold(0.0, f64::max);
            let between = loud[10..14].iter().copied().fold(f64::INFINITY, f64::min);
            let toe = loud[14..28].iter().copied().fold(0.0, f64::max);
            assert!(heel > toe && toe > 1.5 * between, "{on:?}: {heel} {between} {toe}");
        }
    }

    #[test]
    fn grounds_are_told_apart() {
        let high = |on| share_between(&step(on, 3), (1_500.0, 16_000.0), 32_768.0);
        let (gravel, cobble, grass, wood) =
            (high(Footfall::Gravel), high(Footfall::Cobble), high(Footfall::Grass), high(Footfall::Wood));
        assert!(gravel > 0.5 && cobble > 0.3 && wood < 0.15 && grass < cobble, "{gravel:.2} {cobble:.2} {grass:.2} {wood:.2}");
    }
}
