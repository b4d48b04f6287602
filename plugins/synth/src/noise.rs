//! Noise that is keyed by voice and sample.

use veduta_city::draw::Draw;

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
const fn scatter(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// The `n`th number of a key, in 0 to 1.
pub(crate) fn unit(key: u64, n: u64) -> f64 {
    (scatter(key ^ n.wrapping_mul(0xD134_2543_DE82_EF95)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// White noise, a number a sample.
#[derive(Debug, Clone)]
pub(crate) struct White {
    key: u64,
    n: u64,
}

impl White {
    pub fn new(draw: Draw, name: &str) -> Self {
        Self { key: draw.bits(name), n: 0 }
    }

    /// In ±1, evenly spread: a root mean square of 0.577.
    pub fn next(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// In 0 to 1.
    pub fn unit(&mut self) -> f64 {
        self.n += 1;
        unit(self.key, self.n)
    }
}

/// A number in 0 to 1 that wanders, with a new goal every so many seconds.
#[derive(Debug, Clone)]
pub(crate) struct Wander {
    key: u64,
    n: u64,
    x: f64,
    step: f64,
    ends: (f64, f64),
}

impl Wander {
    pub fn new(draw: Draw, name: &str, seconds: f64, rate_hz: f64) -> Self {
        let key = draw.bits(name);
        Self { key, n: 1, x: 0.0, step: 1.0 / (seconds * rate_hz).max(1.0), ends: (unit(key, 0), unit(key, 1)) }
    }

    pub fn next(&mut self) -> f64 {
        let share = self.x * self.x * (3.0 - 2.0 * self.x);
        let value = self.ends.0 + (self.ends.1 - self.ends.0) * share;
        self.x += self.step;
        if self.x >= 1.0 {
            self.x -= 1.0;
            self.n += 1;
            self.ends = (self.ends.1, unit(self.key, self.n));
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::Id;

    #[test]
    fn noise_is_white() {
        let mut white = White::new(Draw::new(1, Id(2), "test"), "noise");
        let x: Vec<f64> = (0..100_000).map(|_| white.next()).collect();
        let along = |lag: usize| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64;
        assert!((along(0) - 1.0 / 3.0).abs() < 0.005, "{}", along(0));
        assert!((1..20).all(|lag| along(lag).abs() < 0.005), "no sample tells of another");
    }

    #[test]
    fn what_wanders_never_jumps_and_goes_everywhere() {
        let mut wander = Wander::new(Draw::new(1, Id(2), "test"), "wander", 0.1, 1_000.0);
        let x: Vec<f64> = (0..50_000).map(|_| wander.next()).collect();
        assert!(x.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02));
        assert!(x.iter().any(|&x| x < 0.1) && x.iter().any(|&x| x > 0.9) && x.iter().all(|x| (0.0..=1.0).contains(x)));
    }
}
