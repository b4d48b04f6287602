use veduta_city::draw::Draw;

use crate::filter::{OnePole, StateVariable};
use crate::noise::{Wander, White};
use crate::voice::Sampled;

/// Wind: noise through two resonances that wander with its gusts, over a low rumble.
pub(crate) struct Wind {
    rate_hz: f64,
    strength: f64,
    white: White,
    gust: Wander,
    breath: Wander,
    whistle: [(StateVariable, Wander); 2],
    rumble: [OnePole; 2],
    far: [OnePole; 2],
    n: u32,
}

/// Filters are tuned anew every so many samples.
const TUNED_EVERY: u32 = 64;

impl Wind {
    pub fn new(strength: f64, draw: Draw, rate_hz: f64) -> Self {
        let whistle = |name, seconds| (StateVariable::new(400.0, 1.5, rate_hz), Wander::new(draw, name, seconds, rate_hz));
        Self {
            rate_hz,
            strength,
            white: White::new(draw, "white"),
            gust: Wander::new(draw, "gust", 2.6, rate_hz),
            breath: Wander::new(draw, "breath", 0.45, rate_hz),
            whistle: [whistle("low", 1.9), whistle("high", 1.3)],
            rumble: [OnePole::new(150.0, rate_hz); 2],
            far: [OnePole::new(1_100.0, rate_hz); 2],
            n: 0,
        }
    }
}

impl Sampled for Wind {
    fn sample(&mut self) -> Option<f64> {
        let gust = 0.75 * self.gust.next() + 0.25 * self.breath.next();
        let white = self.white.next();
        let mut x = 3.0 * self.rumble.iter_mut().fold(white, |x, low| low.low(x));
        for ((filter, wander), (low_hz, span_hz, level)) in self.whistle.iter_mut().zip([(170.0, 260.0, 2.6), (420.0, 650.0, 1.0)])
        {
            let where_to = wander.next();
            if self.n == 0 {
                let centre_hz = low_hz + span_hz * (0.5 * where_to + 0.5 * gust) * (0.5 + 0.7 * self.strength);
                filter.tune(centre_hz, 1.2 + 2.0 * self.strength * where_to, self.rate_hz);
            }
            x += level * filter.band(white);
        }
        // Resonances have long skirts: what hisses in them is lost on the way.
        let x = self.far.iter_mut().fold(x, |x, low| low.low(x));
        self.n = (self.n + 1) % TUNED_EVERY;
        let swell = 0.35 + (0.5 + 0.6 * self.strength) * gust * gust;
        Some(1.05 * x * swell)
    }
}

/// Rain on paving: a hiss of drops that are not told apart, and single ones, each a short ringing.
pub(crate) struct Rain {
    strength: f64,
    white: White,
    drops: White,
    hiss: (StateVariable, OnePole),
    breath: Wander,
    struck: [Struck; 8],
    chance: f64,
    gain: f64,
}

/// A puddle, a gutter, a sill: what rings when a drop falls on it.
#[derive(Clone, Copy)]
struct Struck {
    filter: StateVariable,
    level: f64,
}

impl Rain {
    pub fn new(strength: f64, draw: Draw, rate_hz: f64) -> Self {
        let mut n = 0;
        let struck = [(); 8].map(|()| {
            n += 1;
            let part = draw.part(n);
            let hz = 800.0 * libm::pow(7.0, part.unit("pitch"));
            Struck {
                filter: StateVariable::new(hz.min(0.4 * rate_hz), part.between("ringing", 6.0, 22.0), rate_hz),
                level: 900.0 / hz + 0.5,
            }
        });
        let drops_s = 40.0 + 500.0 * strength;
        Self {
            strength,
            white: White::new(draw, "white"),
            drops: White::new(draw, "drops"),
            hiss: (StateVariable::new(1_300.0, 0.6, rate_hz), OnePole::new(8_500.0, rate_hz)),
            breath: Wander::new(draw, "breath", 1.4, rate_hz),
            struck,
            chance: drops_s / rate_hz,
            gain: 0.1 / (0.058 + 0.163 * strength),
        }
    }
}

impl Sampled for Rain {
    fn sample(&mut self) -> Option<f64> {
        let hiss = self.hiss.0.high(self.hiss.1.low(self.white.next()));
        let mut x = (0.15 + 0.45 * self.strength) * hiss * (0.8 + 0.4 * self.breath.next());
        // One draw tells whether a drop falls, on what, and how hard.
        let asked = self.drops.unit() / self.chance;
        let hit = if asked < 1.0 { Some(((asked * 8.0) as usize, (asked * 4_096.0).fract())) } else { None };
        for (n, struck) in self.struck.iter_mut().enumerate() {
            let blow = match hit {
                Some((which, hard)) if which == n => 9.0 * struck.level * (0.15 + hard * hard * hard),
                _ => 0.0,
            };
            x += struck.filter.band(blow);
        }
        Some(x * self.gain)
    }
}

#[cfg(test)]
mod tests {
    use crate::spectrum::share_between;
    use crate::voice;
    use veduta_city::Sound;

    #[test]
    fn wind_is_low_and_rain_is_high() {
        let high = |sound: &Sound| {
            let mut out = vec![0.0; 65_536];
            voice(sound, 4, 32_768.0).expect("it is made").fill(&mut out);
            share_between(&out, (1_200.0, 16_000.0), 32_768.0)
        };
        let (wind, rain) = (high(&Sound::Wind { strength: 0.5 }), high(&Sound::Rain { strength: 0.5 }));
        assert!(wind < 0.15 && rain > 0.6, "{wind:.2} of wind, {rain:.2} of rain lie above 1.2 kHz");
    }
}
