//! What several things that are known of one bit make of it together: in whole numbers, so that every platform finds the same.

use std::sync::LazyLock;

use super::range::{CHANCE_BITS, Chance, LEAST};

/// A logit is told in 1/256, from -2047 to 2047.
const MOST: i32 = 2047;
/// So many steps of it between two points of the curve.
const APART: i32 = 32;
/// Logistic curve: chance of a zero in 1/2^16 at every point from -8 to 8.
const CURVE: [u16; 129] = curve();

const fn curve() -> [u16; 129] {
    // e^(1/8) in 1/2^30.
    const STEP: u128 = 1_216_708_887;
    let mut curve = [1 << 15; 129];
    let (mut power, mut i) = (1_u128 << 30, 1);
    while i <= 64 {
        power = (power * STEP) >> 30;
        let chance = ((power << 16) / (power + (1 << 30))) as u16;
        curve[64 + i] = chance;
        curve[64 - i] = u16::MAX - chance;
        i += 1;
    }
    curve
}

/// Chance of a zero by its logit.
fn squash(logit: i32) -> u16 {
    let at = logit.clamp(-MOST, MOST) + MOST + 1;
    let (n, part) = ((at / APART) as usize, at % APART);
    let (low, high) = (i32::from(CURVE[n]), i32::from(CURVE[(n + 1).min(128)]));
    (low + (high - low) * part / APART) as u16
}

/// Logits by the first twelve bits of a chance.
static LOGITS: LazyLock<Vec<i16>> = LazyLock::new(|| {
    let mut logits = Vec::with_capacity(4096);
    for logit in -MOST..=MOST {
        let until = usize::from(squash(logit) >> 4) + 1;
        logits.resize(until.max(logits.len()), logit as i16);
    }
    logits.resize(4096, MOST as i16);
    logits
});

/// How many things are known of a bit.
pub(crate) const VIEWS: usize = 3;
/// Evidence is told apart so finely.
const CLASSES: usize = 6;
/// What each view counts by how much evidence it stands for, in 1/256: found by descent over the cities that priors are made from.
const WEIGHTS: [[i16; CLASSES]; VIEWS] = [[130, 125, 110, 112, 115, 113], [95, 100, 92, 85, 88, 90], [150, 135, 122, 105, 80, 72]];

/// How much evidence a chance stands for.
fn class(seen: u8) -> usize {
    match seen {
        0 => 0,
        1..=2 => 1,
        3..=6 => 2,
        7..=14 => 3,
        15..=40 => 4,
        _ => 5,
    }
}

fn logit(chance: Chance) -> i32 {
    LOGITS[usize::from(chance.zero() >> 4)].into()
}

/// Chance of a zero, in 1/2^15.
pub(crate) fn together(views: [Chance; VIEWS]) -> u32 {
    let sum: i32 = views.iter().zip(&WEIGHTS).map(|(&view, weights)| logit(view) * i32::from(weights[class(view.seen())])).sum();
    let zero = squash(sum / 256);
    (u32::from(zero) >> (16 - CHANCE_BITS)).clamp(LEAST, (1 << CHANCE_BITS) - LEAST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_survive_as_logits_and_views_that_agree_are_surer_than_each() {
        for zero in (600..65_000_u16).step_by(97) {
            let back = squash(logit(Chance::new(zero, 9)));
            assert!(back.abs_diff(zero) < 80, "{zero}: {back}");
        }
        let chance = |zero: u16| Chance::new(zero, 30);
        let of = |views: [u16; VIEWS]| f64::from(together(views.map(chance))) / f64::from(1 << CHANCE_BITS);
        assert!((of([1 << 15; VIEWS]) - 0.5).abs() < 0.01);
        let (sure, torn) = (of([60_000; VIEWS]), of([60_000, 5_536, 1 << 15]));
        assert!(sure > 60_000.0 / 65_536.0 && (0.3..0.7).contains(&torn), "{sure} {torn}");
        assert!((of([60_000; VIEWS]) + of([5_536; VIEWS]) - 1.0).abs() < 0.01, "zeros and ones are alike");
    }

    #[test]
    fn nothing_is_certain() {
        for views in [[0; VIEWS], [u16::MAX; VIEWS]] {
            let zero = together(views.map(|zero| Chance::new(zero, 90)));
            assert!((LEAST..=(1 << CHANCE_BITS) - LEAST).contains(&zero), "{zero}");
        }
    }
}
