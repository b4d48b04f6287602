//! What every pixel of a map stands for, by the nearest colour of the legend.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::Bitmap;
use super::legend::{Legend, MapClass};
use super::picture::Picture;

/// A map's classes, a bitmap each.
#[derive(Debug, Clone)]
pub(crate) struct Classes {
    pub street: Bitmap,
    pub park: Bitmap,
    pub water: Bitmap,
    pub railway: Bitmap,
    /// Labels and symbols.
    pub ink: Bitmap,
    /// Single houses, where they have a colour of their own.
    pub house: Bitmap,
    /// Squares that have a colour of their own; they are in `street` too.
    pub square: Bitmap,
}

impl Classes {
    pub fn all_mut(&mut self) -> [&mut Bitmap; 7] {
        let Self { street, park, water, railway, ink, house, square } = self;
        [street, park, water, railway, ink, house, square]
    }
}

pub(super) const STREET: u8 = 0;
const BUILT: u8 = 1;
const PARK: u8 = 2;
const WATER: u8 = 3;
const RAILWAY: u8 = 4;
const INK: u8 = 5;
const HOUSE: u8 = 6;
const SQUARE: u8 = 7;
/// Bits of a shade's class below those of a street's own class.
pub(super) const CLASS_BITS: u8 = 3;

/// Steps a channel of the table of colours.
const STEPS: usize = 32;
/// Entries of that table.
pub(super) const TABLE: usize = STEPS * STEPS * STEPS;

/// Classifies a picture's pixels.
#[must_use]
pub(crate) fn classified(picture: &Picture, legend: &Legend) -> Classes {
    let (light, table) = looked_up(picture, legend, |class| class % (1 << CLASS_BITS));
    Arch::new().dispatch(Classing { picture, light: &light, table: &table })
}

/// The classes of all pixels, by what is known of their colours.
struct Classing<'a> {
    picture: &'a Picture,
    light: &'a Light,
    /// The class of each entry.
    table: &'a [u8; TABLE],
}

impl NullaryFnOnce for Classing<'_> {
    type Output = Classes;

    #[inline(always)]
    fn call(self) -> Classes {
        let Self { picture, light, table } = self;
        let (w, h) = (picture.width, picture.height);
        let [mut street, mut park, mut water, mut railway, mut ink, mut house, mut square] = [(); 7].map(|()| Bitmap::new(w, h));
        for y in 0..h {
            let row = &picture.pixels[y * w * 3..(y + 1) * w * 3];
            let [s, p, wa, r, i] = [street.row_mut(y), park.row_mut(y), water.row_mut(y), railway.row_mut(y), ink.row_mut(y)];
            let [ho, sq] = [house.row_mut(y), square.row_mut(y)];
            for (k, pixels) in row.chunks(WORD_BYTES).enumerate() {
                let of = classes_of_word(pixels, light.gain_at(k * 64, y), table);
                let of = |bit: u8| of[usize::from(bit)];
                (s[k], p[k], wa[k], r[k], i[k]) = (of(STREET) | of(SQUARE), of(PARK), of(WATER), of(RAILWAY), of(INK));
                (ho[k], sq[k]) = (of(HOUSE), of(SQUARE));
            }
        }
        Classes { street, park, water, railway, ink, house, square }
    }
}

/// How bright a picture is, and what `of` makes of the class of the shade that is nearest to each entry of the table.
pub(super) fn looked_up(picture: &Picture, legend: &Legend, of: impl Fn(u8) -> u8) -> (Light, Box<[u8; TABLE]>) {
    let printed = printed_legend(picture, legend);
    let light = Light::of(picture, &printed);
    let shades = with_edges(printed);
    let mut table = Box::new([of(BUILT); TABLE]);
    for (entry, &shade) in table.iter_mut().zip(nearest(&shades).iter()) {
        *entry = shades.get(shade as usize).map_or(of(BUILT), |shade| of(shade.class));
    }
    (light, table)
}

/// Bytes of 64 pixels.
const WORD_BYTES: usize = 64 * 3;

/// For each class, where it is in a word of at most 64 pixels.
#[inline(always)]
fn classes_of_word(pixels: &[u8], gain: u16, table: &[u8; TABLE]) -> [u64; 8] {
    let Ok(word) = <&[u8; WORD_BYTES]>::try_from(pixels) else {
        let mut word = [0; WORD_BYTES];
        word[..pixels.len()].copy_from_slice(pixels);
        return of_each(&word, gain, table).map(|bits| bits & ((1 << (pixels.len() / 3)) - 1));
    };
    if is_even(word) {
        let mut words = [0; 8];
        words[usize::from(table[entry_at([word[0], word[1], word[2]], gain)] % 8)] = u64::MAX;
        return words;
    }
    of_each(word, gain, table)
}

/// Whether all pixels are alike: each as the one before.
#[inline(always)]
fn is_even(pixels: &[u8; WORD_BYTES]) -> bool {
    let mut differ = 0;
    for i in 3..WORD_BYTES {
        differ |= pixels[i] ^ pixels[i - 3];
    }
    differ == 0
}

#[inline(always)]
fn of_each(word: &[u8; WORD_BYTES], gain: u16, table: &[u8; TABLE]) -> [u64; 8] {
    let mut entries = [0; 64];
    for (i, entry) in entries.iter_mut().enumerate() {
        *entry = entry_at([word[3 * i], word[3 * i + 1], word[3 * i + 2]], gain) as u16;
    }
    exchanged(eights(&entries, table))
}

/// The classes of eight pixels a word: byte `c` has a bit for each that is of class `c`.
///
/// Not for wide registers: what is looked up at 64 places goes through them one by one.
#[inline(never)]
fn eights(entries: &[u16; 64], table: &[u8; TABLE]) -> [u64; 8] {
    const OF_CLASS: [u64; 8] = [1, 1 << 8, 1 << 16, 1 << 24, 1 << 32, 1 << 40, 1 << 48, 1 << 56];
    let mut words = [0; 8];
    for k in 0..8 {
        let mut word = 0;
        for i in 0..8 {
            word |= OF_CLASS[usize::from(table[usize::from(entries[8 * k + i])] % 8)] << i;
        }
        words[k] = word;
    }
    words
}

/// Byte `i` of word `k` as byte `k` of word `i`.
#[inline(always)]
fn exchanged(mut words: [u64; 8]) -> [u64; 8] {
    // In squares of two by two bytes, of four by four, and all.
    for (apart, mask) in [(1, 0x00FF_00FF_00FF_00FF), (2, 0x0000_FFFF_0000_FFFF), (4, 0x0000_0000_FFFF_FFFF)] {
        for k in (0..8).filter(|k| k & apart == 0) {
            let swapped = (words[k] >> (8 * apart) ^ words[k + apart]) & mask;
            words[k] ^= swapped << (8 * apart);
            words[k + apart] ^= swapped;
        }
    }
    words
}

/// The table's entry for a colour in light of some gain.
#[inline(always)]
pub(super) fn entry_at([red, green, blue]: [u8; 3], gain: u16) -> usize {
    usize::from(step_at(red, gain) << 10 | step_at(green, gain) << 5 | step_at(blue, gain))
}

#[inline(always)]
fn step_at(value: u8, gain: u16) -> u16 {
    let evened = (u32::from(value) * 2 * u32::from(gain)) >> 16;
    (if evened > 255 { 255 } else { evened as u16 }) >> 3
}

/// How bright a scan is from place to place.
pub(super) struct Light {
    /// Tiles a row.
    columns: usize,
    /// For each tile, the number of its brightness.
    level: Vec<u8>,
    /// For each brightness, by what values are multiplied to be as in even light.
    gains: Vec<u16>,
}

/// A gain that leaves values as they are.
const EVEN: u16 = 1 << 15;

/// Pixels of a tile's side.
const TILE: usize = 128;
/// Pixels looked at along a tile's side.
const LOOKS: usize = 12;
/// Brightness is told in so many hundredths.
const LEVEL: f32 = 0.01;
/// Steps of brightness to either side.
const LEVELS: i32 = 12;

impl Light {
    fn of(picture: &Picture, shades: &[Shade]) -> Self {
        let near = nearest(shades);
        let (columns, rows) = (picture.width.div_ceil(TILE).max(1), picture.height.div_ceil(TILE).max(1));
        let own: Vec<f32> = (0..rows * columns).map(|i| brightness(picture, shades, &near, i % columns, i / columns)).collect();
        // A tile's own figure is rough; light changes slowly.
        let level = (0..rows * columns).map(|i| {
            let (x, y) = (i % columns, i / columns);
            let (mut sum, mut n) = (0.0, 0.0);
            for ny in y.saturating_sub(1)..(y + 2).min(rows) {
                for nx in x.saturating_sub(1)..(x + 2).min(columns) {
                    sum += own[ny * columns + nx];
                    n += 1.0;
                }
            }
            let level = ((sum / n - 1.0) / LEVEL).round() as i32;
            (level.clamp(-LEVELS, LEVELS) + LEVELS) as u8
        });
        Self { columns, level: level.collect(), gains: (-LEVELS..=LEVELS).map(gain_of).collect() }
    }

    #[inline(always)]
    pub(super) fn gain_at(&self, x: usize, y: usize) -> u16 {
        self.gains[usize::from(self.level[y / TILE * self.columns + x / TILE])]
    }
}

/// The gain that evens light of so many steps of brightness more than even. Rounded up, values come out as by division.
fn gain_of(level: i32) -> u16 {
    (f32::from(EVEN) / (1.0 + level as f32 * LEVEL)).ceil() as u16
}

/// How much brighter the pixels of a tile are than the shades they are nearest to: the median.
fn brightness(picture: &Picture, shades: &[Shade], near: &[u32; TABLE], column: usize, row: usize) -> f32 {
    let mut ratios = Vec::with_capacity(LOOKS * LOOKS);
    for i in 0..LOOKS * LOOKS {
        let x = column * TILE + (i % LOOKS) * TILE / LOOKS + TILE / LOOKS / 2;
        let y = row * TILE + (i / LOOKS) * TILE / LOOKS + TILE / LOOKS / 2;
        let Some(pixel) = picture.at(x, y) else { continue };
        let shade = shades.get(near[entry_at(pixel, EVEN)] as usize);
        let pixel = pixel.map(f32::from);
        if let Some(shade) = shade.filter(|shade| distance2(pixel, shade.colour) < SURE * SURE) {
            ratios.push(pixel.iter().sum::<f32>() / shade.colour.iter().sum::<f32>().max(1.0));
        }
    }
    let middle = ratios.len() / 2;
    if ratios.len() < LOOKS { 1.0 } else { *ratios.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

/// A colour and what it stands for.
#[derive(Debug, Clone, Copy)]
struct Shade {
    class: u8,
    colour: [f32; 3],
}

/// For each entry of the table, the number of the nearest shade.
fn nearest(shades: &[Shade]) -> Box<[u32; TABLE]> {
    let middle = |i: usize| (i * 256 / STEPS) as f32 + 3.5;
    let off = |shade: &Shade, channel: usize| -> [f32; STEPS] {
        core::array::from_fn(|i| (middle(i) - shade.colour[channel]) * (middle(i) - shade.colour[channel]))
    };
    // Squares of distances by channel.
    let off: Vec<[[f32; STEPS]; 3]> = shades.iter().map(|shade| [off(shade, 0), off(shade, 1), off(shade, 2)]).collect();
    let mut table = Box::new([0; TABLE]);
    for (i, entries) in table.as_chunks_mut::<STEPS>().0.iter_mut().enumerate() {
        let mut least = [f32::MAX; STEPS];
        for (number, [red, green, blue]) in off.iter().enumerate() {
            let rest = red[i / STEPS] + green[i % STEPS];
            for ((least, entry), blue) in least.iter_mut().zip(entries.iter_mut()).zip(blue) {
                let distance2 = rest + blue;
                (*least, *entry) = if distance2 < *least { (distance2, number as u32) } else { (*least, *entry) };
            }
        }
    }
    table
}

#[inline(always)]
fn distance2(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (r, g, b) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    r * r + g * g + b * b
}

fn mixed(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    core::array::from_fn(|c| a[c] + (b[c] - a[c]) * t)
}

/// The legend's colours as they came out on this map's paper.
fn printed_legend(picture: &Picture, legend: &Legend) -> Vec<Shade> {
    let shades: Vec<Shade> =
        legend.colours.iter().map(|entry| Shade { class: class_of(entry.class), colour: entry.colour.map(f32::from) }).collect();
    as_printed(picture, &shades)
}

/// Shades with the mixtures that soft edges show.
fn with_edges(mut shades: Vec<Shade>) -> Vec<Shade> {
    let is_of = |s: &Shade, classes: &[u8]| classes.contains(&(s.class % (1 << CLASS_BITS)));
    let of = |classes: &[u8]| -> Vec<Shade> { shades.iter().copied().filter(|s| is_of(s, classes)).collect() };
    let (street, blocks, inks) = (of(&[STREET, SQUARE]), of(&[BUILT, PARK, WATER, HOUSE]), of(&[INK]));
    let ground = of(&[STREET, SQUARE, BUILT, PARK, WATER, RAILWAY, HOUSE]);
    let mut more = Vec::new();
    for paper in &street {
        for block in &blocks {
            // What lies between the two belongs to the nearer, though a third colour may lie there too.
            for (t, class) in [(0.2, STREET), (0.4, STREET), (0.6, block.class), (0.8, block.class)] {
                more.push(Shade { class, colour: mixed(paper.colour, block.colour, t) });
            }
        }
        for ink in &inks {
            for t in [0.35, 0.5] {
                let colour = mixed(paper.colour, ink.colour, t);
                if ground.iter().all(|g| distance2(g.colour, colour) > 1600.0) {
                    more.push(Shade { class: INK, colour });
                }
            }
        }
    }
    for (house, ground) in of(&[HOUSE]).iter().flat_map(|house| of(&[BUILT, PARK]).into_iter().map(move |ground| (*house, ground)))
    {
        for (t, class) in [(0.25, ground.class), (0.45, ground.class), (0.55, house.class), (0.75, house.class)] {
            let colour = mixed(ground.colour, house.colour, t);
            if shades.iter().all(|shade| distance2(shade.colour, colour) > 900.0) {
                more.push(Shade { class, colour });
            }
        }
    }
    shades.extend(more);
    shades
}

/// A class as a shade has it; a street's own class is in the bits above [`CLASS_BITS`], counted from 1.
fn class_of(class: MapClass) -> u8 {
    match class {
        MapClass::Street(None) => STREET,
        MapClass::Street(Some(own)) => STREET | (own as u8 + 1) << CLASS_BITS,
        MapClass::Square => SQUARE,
        MapClass::Built => BUILT,
        MapClass::House => HOUSE,
        MapClass::Park => PARK,
        MapClass::Water => WATER,
        MapClass::Railway => RAILWAY,
        MapClass::Label => INK,
    }
}

/// How far a pixel may be from its shade for the fit of the paper, in colour steps.
const SURE: f32 = 40.0;

/// How a channel comes out: stretched and shifted.
type Fit = [(f32, f32); 3];

/// Ink on tinted, unevenly lit paper: every channel is stretched and shifted, alike for all colours. The fit is begun with
/// the colours as they stand, and with the brightest of them as bright as the picture is; the better one holds.
fn as_printed(picture: &Picture, shades: &[Shade]) -> Vec<Shade> {
    let sample = sample(picture);
    let plain: Fit = [(1.0, 0.0); 3];
    let toned: Fit = core::array::from_fn(|c| {
        let brightest = shades.iter().map(|s| s.colour[c]).fold(1.0, f32::max);
        let mut values: Vec<f32> = sample.iter().map(|p| p[c]).collect();
        values.sort_by(f32::total_cmp);
        let high = values.get(values.len() * 19 / 20).copied().unwrap_or(255.0);
        ((high / brightest).clamp(0.6, 1.2), 0.0)
    });
    let (plain, toned) = (fitted(&sample, shades, plain), fitted(&sample, shades, toned));
    let fit = if toned.1 < 0.8 * plain.1 { toned.0 } else { plain.0 };
    printed(shades, &fit)
}

fn printed(shades: &[Shade], fit: &Fit) -> Vec<Shade> {
    let colour = |s: &Shade| core::array::from_fn(|c| s.colour[c] * fit[c].0 + fit[c].1);
    shades.iter().map(|s| Shade { class: s.class, colour: colour(s) }).collect()
}

/// Improves a fit by turns: the nearest shade of each pixel, then the line through the pairs. Gives it with how far the
/// pixels are from their shades; those farther than [`SURE`] count as that.
fn fitted(sample: &[[f32; 3]], shades: &[Shade], mut fit: Fit) -> (Fit, f32) {
    const ROUNDS: usize = 6;
    let mut off = 0.0;
    for round in 0..=ROUNDS {
        let now = printed(shades, &fit);
        let mut pairs: Vec<(usize, [f32; 3])> = Vec::new();
        off = 0.0;
        for pixel in sample {
            let (mut nearest, mut least) = (0, SURE * SURE);
            for (i, shade) in now.iter().enumerate() {
                let distance2 = distance2(*pixel, shade.colour);
                if distance2 < least {
                    (nearest, least) = (i, distance2);
                }
            }
            off += least;
            if least < SURE * SURE {
                pairs.push((nearest, *pixel));
            }
        }
        if pairs.is_empty() || round == ROUNDS {
            break;
        }
        let n = pairs.len() as f32;
        for (c, fit) in fit.iter_mut().enumerate() {
            let x = |p: &(usize, [f32; 3])| shades[p.0].colour[c];
            let (mean_x, mean_y) = (pairs.iter().map(x).sum::<f32>() / n, pairs.iter().map(|p| p.1[c]).sum::<f32>() / n);
            let spread: f32 = pairs.iter().map(|p| (x(p) - mean_x) * (x(p) - mean_x)).sum();
            let shared: f32 = pairs.iter().map(|p| (x(p) - mean_x) * (p.1[c] - mean_y)).sum();
            if spread > n {
                fit.0 = (shared / spread).clamp(0.6, 1.2);
            }
            fit.1 = mean_y - fit.0 * mean_x;
        }
    }
    (fit, off)
}

/// From 6,000 to 24,000 pixels from all over a picture.
fn sample(picture: &Picture) -> Vec<[f32; 3]> {
    let step = ((picture.width * picture.height / 6_000) as f64).sqrt().max(1.0) as usize;
    let columns = || (step / 2..picture.width).step_by(step);
    let at = |x: usize, y: usize| (y * picture.width + x) * 3;
    (step / 2..picture.height)
        .step_by(step)
        .flat_map(|y| columns().map(move |x| (x, y)))
        .map(|(x, y)| core::array::from_fn(|c| f32::from(picture.pixels[at(x, y) + c])))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::LegendColour;
    use proptest::prelude::*;

    #[test]
    fn values_are_evened_as_by_division() {
        for level in -LEVELS..=LEVELS {
            let light = (100 + level) as usize;
            let gain = gain_of(level);
            for value in 0..=255 {
                let evened = (usize::from(value) * 100 / light).min(255);
                assert_eq!(usize::from(step_at(value, gain)), evened / 8, "{value} in light of {light} hundredths");
            }
        }
    }

    proptest! {
        #[test]
        fn pixels_are_classified_as_one_by_one(width in 1usize..300, runs in prop::collection::vec((0usize..8, 1usize..90), 1..60), noise in 0u8..2) {
            const COLOURS: [[u8; 3]; 8] =
                [[250; 3], [220, 200, 170], [120, 190, 110], [90, 150, 220], [130, 60, 150], [20; 3], [190, 70, 50], [255, 225, 60]];
            let colours = MapClass::ALL.into_iter().zip(COLOURS).map(|(class, colour)| LegendColour { class, colour }).collect();
            let legend = Legend { colours, ..Legend::default() };
            let all: Vec<usize> = runs.iter().flat_map(|&(colour, length)| core::iter::repeat_n(colour, length)).collect();
            let height = all.len().div_ceil(width);
            let shade = |i: usize| COLOURS[all[i % all.len()]].map(|c| c.saturating_sub(noise * (i * 7 % 5) as u8));
            let picture = Picture { width, height, pixels: (0..width * height).flat_map(shade).collect() };
            let mut classes = classified(&picture, &legend);
            let (light, table) = looked_up(&picture, &legend, |class| class);
            let counts = classes.all_mut().map(|bitmap| bitmap.pixels().count());
            let mut expected = [0; 7];
            let Classes { street, park, water, railway, ink, house, square } = &classes;
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
                let class = table[entry_at(picture.at(x, y).unwrap_or_default(), light.gain_at(x, y))];
                let is = [class == STREET || class == SQUARE, class == PARK, class == WATER, class == RAILWAY, class == INK, class == HOUSE, class == SQUARE];
                for ((bitmap, is), expected) in [street, park, water, railway, ink, house, square].into_iter().zip(is).zip(&mut expected) {
                    prop_assert_eq!(bitmap.get(x as isize, y as isize), is, "class {} at {}, {}", class, x, y);
                    *expected += usize::from(is);
                }
            }
            prop_assert_eq!(counts, expected, "nothing beyond the width");
        }
    }
}
