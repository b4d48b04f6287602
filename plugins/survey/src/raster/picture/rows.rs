//! Rows of samples, as the formats have them, into rows of RGB.

/// What the samples of a row are, 8 bits each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Samples {
    Grey,
    GreyAlpha,
    Rgb,
    Rgba,
    /// Colour already multiplied by its alpha.
    RgbaMultiplied,
    Cmyk,
}

impl Samples {
    pub(super) const fn count(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::GreyAlpha => 2,
            Self::Rgb => 3,
            Self::Rgba | Self::RgbaMultiplied | Self::Cmyk => 4,
        }
    }

    /// Converts as many pixels as both rows have.
    pub(super) fn convert(self, from: &[u8], to: &mut [u8]) {
        let each = |from: &[u8], to: &mut [u8], pixel: &dyn Fn(&[u8]) -> [u8; 3]| {
            for (from, to) in from.chunks_exact(self.count()).zip(to.chunks_exact_mut(3)) {
                to.copy_from_slice(&pixel(from));
            }
        };
        match self {
            Self::Grey => {
                for (&grey, to) in from.iter().zip(to.chunks_exact_mut(3)) {
                    to.fill(grey);
                }
            }
            Self::Rgb => {
                let shared = from.len().min(to.len());
                to[..shared].copy_from_slice(&from[..shared]);
            }
            Self::GreyAlpha => each(from, to, &|p| [over_white(p[0], p[1]); 3]),
            Self::Rgba => {
                for (from, to) in from.chunks_exact(4).zip(to.chunks_exact_mut(3)) {
                    let alpha = from[3];
                    to.copy_from_slice(&from[..3]);
                    if alpha < 255 {
                        to.iter_mut().for_each(|c| *c = over_white(*c, alpha));
                    }
                }
            }
            Self::RgbaMultiplied => each(from, to, &|p| [p[0], p[1], p[2]].map(|c| c.saturating_add(255 - p[3]))),
            Self::Cmyk => each(from, to, &|p| [p[0], p[1], p[2]].map(|ink| product(255 - ink, 255 - p[3]))),
        }
    }
}

/// A sample of straight alpha over white paper.
fn over_white(sample: u8, alpha: u8) -> u8 {
    255 - product(255 - sample, alpha)
}

/// `a · b / 255`, rounded.
fn product(a: u8, b: u8) -> u8 {
    ((u16::from(a) * u16::from(b) + 127) / 255) as u8
}

/// The sample at `index` of a row of `bits` (1, 2 or 4) each, from the highest bit down.
pub(super) fn packed(row: &[u8], index: usize, bits: usize) -> u8 {
    let bit = index * bits;
    let byte = row.get(bit / 8).copied().unwrap_or(0);
    (byte >> (8 - bits - bit % 8)) & ((1u16 << bits) - 1) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_transparent_shows_white_paper() {
        let mut to = [0; 6];
        Samples::Rgba.convert(&[10, 20, 30, 0, 10, 20, 30, 255], &mut to);
        assert_eq!(to, [255, 255, 255, 10, 20, 30]);
        Samples::Rgba.convert(&[0, 0, 0, 128, 255, 255, 255, 7], &mut to);
        assert_eq!(to, [127, 127, 127, 255, 255, 255]);
        Samples::RgbaMultiplied.convert(&[0, 0, 0, 128, 3, 4, 5, 255], &mut to);
        assert_eq!(to, [127, 127, 127, 3, 4, 5]);
        Samples::GreyAlpha.convert(&[100, 255, 100, 0], &mut to);
        assert_eq!(to, [100, 100, 100, 255, 255, 255]);
    }

    #[test]
    fn no_ink_is_white_and_black_ink_is_black() {
        let mut to = [9; 6];
        Samples::Cmyk.convert(&[0, 0, 0, 0, 0, 0, 0, 255], &mut to);
        assert_eq!(to, [255, 255, 255, 0, 0, 0]);
        Samples::Cmyk.convert(&[255, 0, 0, 0, 0, 255, 255, 0], &mut to);
        assert_eq!(to, [0, 255, 255, 255, 0, 0], "cyan, red");
    }

    #[test]
    fn packed_samples_run_from_the_highest_bit() {
        let row = [0b1001_0011, 0b0100_0000];
        assert_eq!((0..10).map(|i| packed(&row, i, 1)).collect::<Vec<_>>(), [1, 0, 0, 1, 0, 0, 1, 1, 0, 1]);
        assert_eq!((0..5).map(|i| packed(&row, i, 2)).collect::<Vec<_>>(), [2, 1, 0, 3, 1]);
        assert_eq!((0..3).map(|i| packed(&row, i, 4)).collect::<Vec<_>>(), [9, 3, 4]);
        assert_eq!(packed(&row, 99, 4), 0, "beyond the row");
    }
}
