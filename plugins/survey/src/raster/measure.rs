//! Distances to the border of what is set, measured where they are needed.

use glam::DVec2;

use super::bitmap::{Bitmap, pixel_of};

/// How far one can go from a point in a direction (of length 1) before a pixel that is not set, up to `reach`; pixels.
#[must_use]
pub(crate) fn ray(bitmap: &Bitmap, from: DVec2, direction: DVec2, reach: f64) -> f64 {
    let step = DVec2::new(direction.x.signum(), direction.y.signum());
    let per = DVec2::new(1.0 / direction.x.abs().max(1e-12), 1.0 / direction.y.abs().max(1e-12));
    let (mut x, mut y) = pixel_of(from);
    let floor = DVec2::new(x as f64, y as f64);
    let to_edge = |at: f64, low: f64, forward: bool| if forward { low + 1.0 - at } else { at - low };
    let mut next = DVec2::new(to_edge(from.x, floor.x, step.x > 0.0), to_edge(from.y, floor.y, step.y > 0.0)) * per;
    let mut gone = 0.0;
    while gone < reach {
        if !bitmap.get(x, y) {
            return gone;
        }
        // Chosen without a branch: which side of a pixel a slanting line leaves by is hard to foretell.
        let across = next.x < next.y;
        gone = if across { next.x } else { next.y };
        next += DVec2::new(if across { per.x } else { 0.0 }, if across { 0.0 } else { per.y });
        x += if across { step.x as isize } else { 0 };
        y += if across { 0 } else { step.y as isize };
    }
    reach
}

/// The radius of the largest disc about the middle of a pixel that holds set pixels only, up to `reach`; pixels. Zero
/// where the pixel is not set.
#[must_use]
pub(crate) fn clearance(bitmap: &Bitmap, at: DVec2, reach: f64) -> f64 {
    let (x, y) = pixel_of(at);
    let limit = (reach + 0.5) * (reach + 0.5);
    // The square of the distance to the nearest pixel that is not set, and a whole number above its root.
    let mut best = limit as isize + 1;
    let mut most = (reach + 0.5) as isize + 1;
    let mut dy = 0;
    while dy * dy < best {
        for row in if dy == 0 { [y, y] } else { [y - dy, y + dy] } {
            let dx = gap(bitmap, x, row, most);
            if dx * dx + dy * dy < best {
                best = dx * dx + dy * dy;
                most = (best as f64).sqrt() as isize + 1;
            }
        }
        dy += 1;
    }
    ((best as f64).min(limit).sqrt() - 0.5).max(0.0)
}

/// Whether a disc of a radius about the middle of a pixel holds set pixels only: whether there is more clearance than
/// that.
#[must_use]
pub(crate) fn is_clear(bitmap: &Bitmap, at: DVec2, radius: f64) -> bool {
    let (x, y) = pixel_of(at);
    let radius2 = (radius + 0.5) * (radius + 0.5);
    let high = (radius + 0.5) as isize;
    (0..=high).all(|dy| {
        let half = (radius2 - (dy * dy) as f64).sqrt() as isize;
        bitmap.is_full(y - dy, x - half, x + half + 1) && bitmap.is_full(y + dy, x - half, x + half + 1)
    })
}

/// How many pixels to the side the nearest pixel of a row is that is not set, from 0 to `most`.
fn gap(bitmap: &Bitmap, x: isize, y: isize, most: isize) -> isize {
    if y < 0 || y >= bitmap.height() as isize || x < 0 || x >= bitmap.width() as isize {
        return 0;
    }
    let row = bitmap.padded(y as usize);
    if most <= 32 {
        // The 32 pixels before it, itself, and 31 after it; the row begins with a blank word.
        let first = x as usize + 32;
        let (word, bit) = (first / 64, first % 64);
        let window = row[word] >> bit | row[word + 1] << 1 << (63 - bit);
        let right = (!(window >> 32)).trailing_zeros();
        let left = (!(window << 31)).leading_zeros();
        return (right.min(left) as isize).min(most);
    }
    let (word, bit) = (x as usize / 64 + 1, x as usize % 64);
    // To the right.
    let mut right = (!(row[word] >> bit)).trailing_zeros() as isize;
    if right >= 64 - bit as isize {
        right = 64 - bit as isize;
        for &next in &row[word + 1..] {
            let run = next.trailing_ones() as isize;
            right += run;
            if run < 64 || right > most {
                break;
            }
        }
    }
    // To the left.
    let mut left = (row[word] << (63 - bit)).leading_ones() as isize;
    if left > bit as isize {
        left = bit as isize + 1;
        for &next in row[..word].iter().rev() {
            let run = next.leading_ones() as isize;
            left += run;
            if run < 64 || left > most {
                break;
            }
        }
    }
    right.min(left).min(most)
}

/// The median of some numbers, or nothing of nothing; takes their order.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn clearance_is_the_distance_to_the_nearest_unset_pixel(width in 1usize..400, height in 1usize..150, cell in 5usize..150, seed: u64, x in 0usize..400, y in 0usize..150, reach in 0.0..150.0f64) {
            let bitmap = Bitmap::from_fn(width, height, |x, y| {
                let n = ((x / cell) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / cell) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < 15
            });
            let (x, y) = ((x % width) as isize, (y % height) as isize);
            let mut nearest = reach + 0.5;
            for py in -1..=height as isize {
                for px in -1..=width as isize {
                    if !bitmap.get(px, py) {
                        nearest = nearest.min((((px - x).pow(2) + (py - y).pow(2)) as f64).sqrt());
                    }
                }
            }
            let found = clearance(&bitmap, DVec2::new(x as f64 + 0.5, y as f64 + 0.5), reach);
            prop_assert!((found - (nearest - 0.5).max(0.0)).abs() < 1e-9, "{} for {}", found, nearest - 0.5);
        }

        #[test]
        fn a_disc_is_clear_if_it_is_smaller_than_the_clearance(width in 1usize..300, height in 1usize..60, seed: u64, x in 0usize..300, y in 0usize..60, radius in 0.0..20.0f64) {
            let bitmap = Bitmap::from_fn(width, height, |x, y| {
                let n = ((x / 9) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / 9) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < 15
            });
            let at = DVec2::new((x % width) as f64 + 0.5, (y % height) as f64 + 0.5);
            let is_set = bitmap.get(at.x as isize, at.y as isize);
            prop_assert_eq!(is_clear(&bitmap, at, radius), is_set && clearance(&bitmap, at, 30.0) > radius);
        }

        #[test]
        fn a_ray_ends_where_what_is_set_ends(angle in 0.0..core::f64::consts::TAU, half in 1usize..40) {
            let bitmap = Bitmap::from_fn(200, 100, |_, y| (50 - half..50 + half).contains(&y));
            let direction = DVec2::new(libm::cos(angle), libm::sin(angle));
            let reach = ray(&bitmap, DVec2::new(100.0, 50.0), direction, 1e3);
            let to_band = half as f64 / direction.y.abs();
            let to_side = 100.0 / direction.x.abs();
            prop_assert!((reach - to_band.min(to_side).min(1e3)).abs() < 1e-6, "{} for {}", reach, to_band);
        }
    }
}
