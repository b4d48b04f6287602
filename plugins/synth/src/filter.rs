//! Filters, in double precision.

use core::f64::consts::{PI, TAU};

/// A filter of first order: 6 dB an octave.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnePole {
    a: f64,
    low: f64,
}

impl OnePole {
    pub fn new(cutoff_hz: f64, rate_hz: f64) -> Self {
        Self { a: share(cutoff_hz, rate_hz), low: 0.0 }
    }

    pub fn low(&mut self, x: f64) -> f64 {
        self.low += self.a * (x - self.low);
        self.low
    }

    pub fn high(&mut self, x: f64) -> f64 {
        x - self.low(x)
    }
}

/// How far a filter of first order goes towards its input in a sample.
pub(crate) fn share(cutoff_hz: f64, rate_hz: f64) -> f64 {
    1.0 - libm::exp(-TAU * (cutoff_hz / rate_hz).clamp(0.0, 0.49))
}

/// Takes away what does not move: below 12 Hz.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DcBlocker(OnePole);

impl DcBlocker {
    pub fn new(rate_hz: f64) -> Self {
        Self(OnePole::new(12.0, rate_hz))
    }

    pub fn pass(&mut self, x: f64) -> f64 {
        self.0.high(x)
    }
}

/// A state variable filter, solved without delay in its loop (Zavalishin, *The Art of VA Filter Design*): it may be tuned while it sounds.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct StateVariable {
    g: f64,
    k: f64,
    scale: f64,
    s1: f64,
    s2: f64,
}

impl StateVariable {
    pub fn new(centre_hz: f64, q: f64, rate_hz: f64) -> Self {
        let mut filter = Self::default();
        filter.tune(centre_hz, q, rate_hz);
        filter
    }

    pub fn tune(&mut self, centre_hz: f64, q: f64, rate_hz: f64) {
        self.g = libm::tan(PI * (centre_hz / rate_hz).clamp(1e-5, 0.45));
        self.k = 1.0 / q.max(0.1);
        self.scale = 1.0 / (1.0 + self.g * (self.g + self.k));
    }

    /// Low-pass and band-pass; the latter with a gain of 1 at its centre.
    pub fn pass(&mut self, x: f64) -> (f64, f64) {
        let band = self.scale * (self.g * (x - self.s2) + self.s1);
        let low = self.s2 + self.g * band;
        self.s1 = 2.0 * band - self.s1;
        self.s2 = 2.0 * low - self.s2;
        (low, self.k * band)
    }

    pub fn low(&mut self, x: f64) -> f64 {
        self.pass(x).0
    }

    pub fn band(&mut self, x: f64) -> f64 {
        self.pass(x).1
    }

    pub fn high(&mut self, x: f64) -> f64 {
        let (low, band) = self.pass(x);
        x - band - low
    }
}

/// A sine that dies away; its pitch may rise or fall meanwhile.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ringing {
    at: (f64, f64),
    turn: (f64, f64),
    bend: (f64, f64),
}

impl Ringing {
    /// From silence, at an amplitude that falls by 60 dB in so many seconds.
    pub fn new(hz: f64, amplitude: f64, fall_60_db_s: f64, rate_hz: f64) -> Self {
        Self::bent(hz, 0.0, amplitude, fall_60_db_s, rate_hz)
    }

    /// The same, with a pitch that changes by so many hertz a second.
    pub fn bent(hz: f64, hz_s: f64, amplitude: f64, fall_60_db_s: f64, rate_hz: f64) -> Self {
        let decay = libm::exp(-core::f64::consts::LN_10 * 3.0 / (fall_60_db_s.max(1e-4) * rate_hz));
        let (angle, bend) = (TAU * hz / rate_hz, TAU * hz_s / (rate_hz * rate_hz));
        let at = |angle: f64, length: f64| (libm::cos(angle) * length, libm::sin(angle) * length);
        Self { at: (amplitude, 0.0), turn: at(angle, decay), bend: at(bend, 1.0) }
    }

    pub fn next(&mut self) -> f64 {
        let out = self.at.1;
        self.at = times(self.at, self.turn);
        self.turn = times(self.turn, self.bend);
        out
    }

    /// Its amplitude now.
    pub fn amplitude(&self) -> f64 {
        libm::hypot(self.at.0, self.at.1)
    }
}

fn times(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// From 0 over 1 in the middle to 0, smoothly; 0 outside of 0 to 1.
pub(crate) fn hump(x: f64) -> f64 {
    if (0.0..=1.0).contains(&x) { 0.5 - 0.5 * libm::cos(TAU * x) } else { 0.0 }
}

/// From 0 at 0 to 1 at 1, smoothly, and so on.
pub(crate) fn rise(x: f64) -> f64 {
    0.5 - 0.5 * libm::cos(PI * x.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 48_000.0;

    /// Gain of a filter at a frequency, once it has settled.
    fn gain(hz: f64, mut filter: impl FnMut(f64) -> f64) -> f64 {
        let out: Vec<f64> = (0..48_000).map(|n| filter(libm::sin(TAU * hz * f64::from(n) / RATE_HZ))).collect();
        out[24_000..].iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    #[test]
    fn filters_let_through_what_they_should() {
        let mut filter = StateVariable::new(1_000.0, 4.0, RATE_HZ);
        assert!((gain(1_000.0, |x| filter.band(x)) - 1.0).abs() < 0.01);
        assert!(gain(250.0, |x| filter.band(x)) < 0.1 && gain(4_000.0, |x| filter.band(x)) < 0.1);
        let mut filter = StateVariable::new(1_000.0, 0.7, RATE_HZ);
        assert!((gain(50.0, |x| filter.low(x)) - 1.0).abs() < 0.02 && gain(8_000.0, |x| filter.low(x)) < 0.03);
        let mut filter = StateVariable::new(1_000.0, 0.7, RATE_HZ);
        assert!(gain(100.0, |x| filter.high(x)) < 0.03 && (gain(12_000.0, |x| filter.high(x)) - 1.0).abs() < 0.05);
        let mut dc = DcBlocker::new(RATE_HZ);
        assert!((0..96_000).map(|_| dc.pass(1.0)).last().expect("some").abs() < 1e-3);
    }

    #[test]
    fn what_rings_has_its_pitch_and_dies_away_in_time() {
        let mut ringing = Ringing::new(440.0, 1.0, 0.5, RATE_HZ);
        let out: Vec<f64> = (0..24_000).map(|_| ringing.next()).collect();
        let crossings = out[..9_600].windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        assert!((87..=88).contains(&crossings), "{crossings} in 0.2 s");
        assert!((ringing.amplitude() - 1e-3).abs() < 1e-5, "{}", ringing.amplitude());
    }
}
