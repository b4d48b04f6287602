//! Growing and shrinking by discs.

use glam::DVec2;
use pulp::{Arch, NullaryFnOnce};

use super::bitmap::Bitmap;

/// What lies within so many pixels of what is set (an octagon, which is near enough to a disc).
#[must_use]
pub(crate) fn grown(bitmap: &Bitmap, steps: usize) -> Bitmap {
    let mut result = bitmap.clone();
    let share = core::f64::consts::SQRT_2 - 1.0;
    for i in 0..steps {
        let corners = ((i + 1) as f64 * share) as usize > (i as f64 * share) as usize;
        result = Arch::new().dispatch(Step { bitmap: &result, corners });
    }
    result
}

/// What lies more than so many pixels inside of what is set. Beyond the border all is taken to be set.
#[must_use]
pub(crate) fn shrunk(bitmap: &Bitmap, steps: usize) -> Bitmap {
    grown(&bitmap.inverted(), steps).inverted()
}

/// Sets the pixels within `half` of a stretch.
pub(crate) fn band(bitmap: &mut Bitmap, a: DVec2, b: DVec2, half: f64) {
    let (low, high) = (a.min(b) - half, a.max(b) + half);
    let along = b - a;
    let length2 = along.length_squared().max(1e-9);
    for y in low.y.max(0.0) as usize..(high.y.max(0.0) as usize + 1).min(bitmap.height()) {
        for x in low.x.max(0.0) as usize..(high.x.max(0.0) as usize + 1).min(bitmap.width()) {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - a;
            let t = (p.dot(along) / length2).clamp(0.0, 1.0);
            if (p - along * t).length_squared() < half * half {
                bitmap.set(x, y, true);
            }
        }
    }
}

/// What is set, and what touches it by a side, or by a corner too.
struct Step<'a> {
    bitmap: &'a Bitmap,
    corners: bool,
}

impl NullaryFnOnce for Step<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let Self { bitmap, corners } = self;
        let mut result = Bitmap::new(bitmap.width(), bitmap.height());
        let (used, last) = (bitmap.width().div_ceil(64), bitmap.last_word());
        let blank = vec![0; bitmap.stride() + 1];
        for y in 0..bitmap.height() {
            let above = if y > 0 { bitmap.padded(y - 1) } else { &blank };
            let below = if y + 1 < bitmap.height() { bitmap.padded(y + 1) } else { &blank };
            let at = bitmap.padded(y);
            let to = result.row_mut(y);
            let n = to.len();
            let (above, at, below) = (&above[..n + 2], &at[..n + 2], &below[..n + 2]);
            for k in 0..n {
                let wide = |row: &[u64]| row[k + 1] | row[k + 1] << 1 | row[k] >> 63 | row[k + 1] >> 1 | row[k + 2] << 63;
                let beside = if corners { wide(above) | wide(below) } else { above[k + 1] | below[k + 1] };
                to[k] = wide(at) | beside;
            }
            to[used..].fill(0);
            to[used - 1] &= last;
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growing_reaches_every_border() {
        for width in [1, 63, 64, 65, 512, 513, 1024] {
            let full = Bitmap::from_fn(width, 3, |_, _| true);
            assert_eq!(grown(&full, 2), full, "width {width}");
            assert_eq!(shrunk(&full, 2), full, "width {width}");
        }
    }

    #[test]
    fn a_point_grows_to_nearly_a_disc() {
        let mut point = Bitmap::new(141, 141);
        point.set(70, 70, true);
        for radius in [3usize, 10, 30] {
            let disc = grown(&point, radius);
            for (x, y) in disc.pixels() {
                let d = ((x as f64 - 70.0).powi(2) + (y as f64 - 70.0).powi(2)).sqrt();
                assert!(d <= 1.1 * radius as f64 + 1.0, "({x}, {y}) is too far for {radius}");
            }
            assert!(disc.count() as f64 > 0.95 * core::f64::consts::PI * (radius * radius) as f64);
            assert_eq!(shrunk(&disc, radius).count(), 1, "shrinking undoes growing of a point");
        }
    }
}
