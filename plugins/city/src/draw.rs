//! Random draws keyed by (seed, stable id, stage): the same for any order of visits, thread count and platform.
//!
//! ```
//! use veduta_city::{Id, draw::Draw};
//! let house = Draw::new(7, Id(12), "house");
//! assert_eq!(house.unit("colour"), Draw::new(7, Id(12), "house").unit("colour"));
//! assert_ne!(house.unit("colour"), house.unit("bays"));
//! ```

use crate::Id;

/// A point of decision: a seed, a thing, a stage. Each question asked of it has one answer for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draw(u64);

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection that scatters neighbouring keys.
const fn scatter(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// FNV-1a over the question's words, then scattered by the caller.
const fn words(text: &str) -> u64 {
    let (bytes, mut hash, mut i) = (text.as_bytes(), 0xCBF2_9CE4_8422_2325_u64, 0);
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x0000_0100_0000_01B3);
        i += 1;
    }
    hash
}

impl Draw {
    /// Draws for one thing at one stage.
    #[must_use]
    pub const fn new(seed: u64, id: Id, stage: &str) -> Self {
        Self(scatter(scatter(scatter(seed) ^ id.0) ^ words(stage)))
    }

    /// The draw for the `n`th part of this thing (storey, bay, lot).
    #[must_use]
    pub const fn part(self, n: u64) -> Self {
        Self(scatter(self.0 ^ scatter(n)))
    }

    /// 64 random bits for a question.
    #[must_use]
    pub const fn bits(self, question: &str) -> u64 {
        scatter(self.0 ^ words(question))
    }

    /// A number in [0, 1).
    #[must_use]
    pub fn unit(self, question: &str) -> f64 {
        (self.bits(question) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in [low, high); `low` if the range is empty.
    #[must_use]
    pub fn between(self, question: &str, low: f64, high: f64) -> f64 {
        low + self.unit(question) * (high - low).max(0.0)
    }

    /// One of `0..n`; 0 if `n` is 0.
    #[must_use]
    pub fn below(self, question: &str, n: usize) -> usize {
        (self.unit(question) * n as f64) as usize
    }

    /// One of a list; `None` if it is empty.
    #[must_use]
    pub fn pick<'a, T>(self, question: &str, of: &'a [T]) -> Option<&'a T> {
        of.get(self.below(question, of.len()))
    }

    /// True with probability `p`.
    #[must_use]
    pub fn chance(self, question: &str, p: f64) -> bool {
        self.unit(question) < p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_spread_evenly_over_ids() {
        let mut bins = [0_u32; 10];
        for id in 0..10_000 {
            bins[Draw::new(1, Id(id), "test").below("bin", 10)] += 1;
        }
        assert!(bins.iter().all(|&n| (850..1150).contains(&n)), "{bins:?}");
    }
}
