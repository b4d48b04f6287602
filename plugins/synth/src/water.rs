use veduta_city::draw::Draw;

use crate::filter::{OnePole, Ringing, StateVariable};
use crate::noise::{Wander, White, unit};
use crate::voice::Sampled;

/// Water that falls or flows: broad noise for what rushes, high noise for spray, bubbles that ring.
///
/// A bubble of radius r rings at 3.26 m/s ÷ r (Minnaert 1933), dies away by 0.13/r + 0.0072 r^−1.5 a second, and rises in pitch as
/// it comes up (van den Doel, "Physically based models for liquid sounds", 2005).
pub(crate) struct Water {
    rate_hz: f64,
    flow: f64,
    spray: f64,
    bubbles: f64,
    lapping: f64,
    gain: f64,
    white: White,
    rush: (StateVariable, OnePole),
    drops: (StateVariable, OnePole),
    wash: (StateVariable, OnePole),
    flow_wander: Wander,
    spray_wander: Wander,
    wave_wander: Wander,
    ringing: Vec<Ringing>,
    key: u64,
    slot: u64,
    slot_left: u32,
}

/// In each of so many moments a second one bubble may come up.
const SLOTS_S: f64 = 240.0;
/// More bubbles than this are never told apart.
const MOST_BUBBLES: usize = 28;

impl Water {
    /// Flow, spray, bubbles, lapping: 0 to 1 each.
    pub fn new([flow, spray, bubbles, lapping]: [f64; 4], draw: Draw, rate_hz: f64) -> Self {
        // Mean powers of its parts, as measured; so that every mixture has the mean that is promised.
        let power = 0.035 * flow * flow + 0.052 * spray * spray + 0.03 * bubbles * bubbles + 0.006 * lapping * lapping;
        Self {
            rate_hz,
            flow,
            spray,
            bubbles,
            lapping,
            gain: 0.1 / libm::sqrt(power).max(0.02),
            white: White::new(draw, "white"),
            rush: (StateVariable::new(330.0, 0.5, rate_hz), OnePole::new(90.0, rate_hz)),
            drops: (StateVariable::new(1_900.0, 0.6, rate_hz), OnePole::new(6_500.0, rate_hz)),
            wash: (StateVariable::new(520.0, 0.7, rate_hz), OnePole::new(800.0, rate_hz)),
            flow_wander: Wander::new(draw, "flow", 1.7, rate_hz),
            spray_wander: Wander::new(draw, "spray", 0.13, rate_hz),
            wave_wander: Wander::new(draw, "waves", 1.15, rate_hz),
            ringing: Vec::with_capacity(MOST_BUBBLES),
            key: draw.bits("bubbles"),
            slot: 0,
            slot_left: 0,
        }
    }

    /// Lets a bubble come up, or none.
    fn bubble(&mut self, wave: f64) {
        let asked = |what: u64| unit(self.key, self.slot * 4 + what);
        let share = self.bubbles * (1.0 - self.lapping) + self.bubbles * self.lapping * wave * wave;
        if asked(0) < 0.75 * share && self.ringing.len() < MOST_BUBBLES {
            // Radii from 0.7 to 6 mm, small ones more often; metres.
            let radius_m = 0.0007 * libm::pow(8.5, asked(1) * asked(1));
            let (hz, decay_s) = (3.26 / radius_m, 0.13 / radius_m + 0.0072 * libm::pow(radius_m, -1.5));
            let loud = libm::pow(radius_m / 0.003, 0.6) * (0.25 + 0.75 * asked(2));
            let rising_hz_s = if asked(3) < 0.4 { 0.12 * hz * decay_s } else { 0.0 };
            if hz < 0.4 * self.rate_hz {
                // Three times ln 10 makes 60 dB of one neper.
                self.ringing.push(Ringing::bent(hz, rising_hz_s, loud, 6.9 / decay_s, self.rate_hz));
            }
        }
        self.slot += 1;
    }
}

impl Sampled for Water {
    fn sample(&mut self) -> Option<f64> {
        let wave = self.wave_wander.next();
        if self.slot_left == 0 {
            self.slot_left = (self.rate_hz / SLOTS_S) as u32;
            self.ringing.retain(|bubble| bubble.amplitude() > 1e-3);
            self.bubble(wave);
        }
        self.slot_left -= 1;
        let white = self.white.next();
        let mut x = 0.0;
        if self.flow > 0.0 {
            let rush = self.rush.0.low(white) + 1.5 * self.rush.1.low(white);
            x += 1.6 * self.flow * rush * (0.7 + 0.6 * self.flow_wander.next());
        }
        if self.spray > 0.0 {
            let drops = self.drops.0.high(self.drops.1.low(white));
            x += 0.8 * self.spray * drops * (0.6 + 0.8 * self.spray_wander.next());
        }
        if self.lapping > 0.0 {
            x += 2.0 * self.lapping * self.wash.1.low(self.wash.0.band(white)) * wave * wave * wave;
        }
        if self.bubbles > 0.0 {
            x += 0.35 * self.bubbles * self.ringing.iter_mut().map(Ringing::next).sum::<f64>();
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
    fn fountains_are_bright_and_rivers_dull() {
        let made = |sound: &Sound| {
            let mut out = vec![0.0; 32_768];
            voice(sound, 9, 32_768.0).expect("it is made").fill(&mut out);
            share_between(&out, (1_000.0, 16_000.0), 32_768.0)
        };
        let (fountain, river) = (made(&Sound::FOUNTAIN), made(&Sound::RIVER));
        assert!(fountain > 0.35 && river < 0.25, "{fountain:.2} of a fountain, {river:.2} of a river lie above 1 kHz");
    }
}
