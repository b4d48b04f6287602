//! Blocks of 4 × 4 opaque texels in 8 bytes (BC1), four at a time, made fast enough for pictures that come while somebody walks.

use std::sync::LazyLock;

use glam::Vec4;

/// Texels of a block.
const TEXELS: usize = 16;
/// Blocks made at a time.
pub(crate) const AT_ONCE: usize = 4;
/// Blocks whose squares of errors sum up to less are good enough: channels are off by five of 255, twice what five bits leave.
const CLOSE: Vec4 = Vec4::splat((3 * TEXELS * 5 * 5) as f32);
/// Shares that tell a line's ends less apart tell none.
const APART: Vec4 = Vec4::splat(1e-3);
/// What has no room for fractions: adding it rounds to a whole number, which is in the lowest bits then.
const ROUND: Vec4 = Vec4::splat(12_582_912.0);

/// Texels of a block in RGBA8, row by row, the first channel lowest. Alpha counts for nothing.
pub(crate) type Block = [u32; TEXELS];
/// A value of each texel in each block.
type Texels = [Vec4; TEXELS];
/// The channels of blocks, 0 to 255.
type Channels = [Texels; 3];
/// A colour in each block, each channel 0 to 255.
type Colours = [Vec4; 3];

/// Blocks as cards read them. What is made of each has nothing to do with the others.
pub(crate) fn blocks(texels: &[Block; AT_ONCE]) -> [[u8; 8]; AT_ONCE] {
    let plain =
        texels.each_ref().map(|block| block.iter().all(|texel| texel << 8 == block[0] << 8).then(|| of_one_colour(block[0])));
    if let [Some(a), Some(b), Some(c), Some(d)] = plain {
        return [a, b, c, d];
    }
    let mut channels: Channels = [[Vec4::ZERO; TEXELS]; 3];
    for i in 0..TEXELS {
        let [a, b, c, d] = texels;
        for (n, channel) in (0..).zip(&mut channels) {
            // A number so large that its lowest bits count whole ones.
            let bits = [a[i], b[i], c[i], d[i]].map(|texel| texel >> (8 * n) & 0xFF | 0x4B00_0000);
            channel[i] = Vec4::from_array(bits.map(f32::from_bits)) - 8_388_608.0;
        }
    }
    // The diagonal of the colours' bounds along which they lie, a little within them; then the line that fits best.
    let (first, last) = diagonal(&channels);
    let rough = Lines::between(first, last);
    let (shares, error) = rough.shares(&channels);
    let mut made = rough.bytes(&shares);
    let is_far = error.cmpge(CLOSE);
    if is_far.any() {
        let (fine, apart) = fitted(&channels, &shares);
        let (shares, finer) = fine.shares(&channels);
        let fine = fine.bytes(&shares);
        let is_finer = is_far & apart.cmpge(APART) & finer.cmplt(error);
        (0..AT_ONCE).filter(|&n| is_finer.test(n)).for_each(|n| made[n] = fine[n]);
    }
    core::array::from_fn(|n| plain[n].unwrap_or(made[n]))
}

/// The ends of the diagonal of bounds along which most colours lie.
fn diagonal(channels: &Channels) -> (Colours, Colours) {
    /// So much of the bounds lies beyond either end: few texels are at the very ends.
    const WITHIN: f32 = 1.0 / 16.0;
    let low = channels.map(|of| of.into_iter().fold(of[0], Vec4::min));
    let high = channels.map(|of| of.into_iter().fold(of[0], Vec4::max));
    let range: Colours = core::array::from_fn(|c| high[c] - low[c]);
    let middle: Colours = core::array::from_fn(|c| (high[c] + low[c]) * 0.5);
    let is_green = range[1].cmpgt(range[0]);
    let is_blue = range[2].cmpgt(range[0].max(range[1]));
    let widest = |colour: Colours| Vec4::select(is_blue, colour[2], Vec4::select(is_green, colour[1], colour[0]));
    let mut along = [Vec4::ZERO; 3];
    let off = |c: usize, i: usize| channels[c][i] - middle[c];
    for i in 0..TEXELS {
        let off = [off(0, i), off(1, i), off(2, i)];
        let main = widest(off);
        (0..3).for_each(|c| along[c] += off[c] * main);
    }
    let ends: [(Vec4, Vec4); 3] = core::array::from_fn(|c| {
        let (from, to, falls) = (high[c] - range[c] * WITHIN, low[c] + range[c] * WITHIN, along[c].cmplt(Vec4::ZERO));
        (Vec4::select(falls, to, from), Vec4::select(falls, from, to))
    });
    (ends.map(|(first, _)| first), ends.map(|(_, last)| last))
}

/// The lines that fit texels best which have such shares of their ends, by least squares, and how well these tell them apart: next to
/// not at all where all have the same.
fn fitted(channels: &Channels, shares: &Texels) -> (Lines, Vec4) {
    let (mut all, mut of_first) = (Vec4::ZERO, Vec4::ZERO);
    let (mut to_first, mut to_both) = ([Vec4::ZERO; 3], [Vec4::ZERO; 3]);
    for (i, &share) in shares.iter().enumerate() {
        all += share;
        of_first += share * share;
        for c in 0..3 {
            to_first[c] += channels[c][i] * share;
            to_both[c] += channels[c][i];
        }
    }
    let of_both = all - of_first;
    let of_last = Vec4::splat(TEXELS as f32) - all - of_both;
    let apart = of_first * of_last - of_both * of_both;
    let scale = apart.max(APART).recip();
    let (of_first, of_both, of_last) = (of_first * scale, of_both * scale, of_last * scale);
    let (mut first, mut last) = ([Vec4::ZERO; 3], [Vec4::ZERO; 3]);
    let bounded = |colour: Vec4| colour.max(Vec4::ZERO).min(Vec4::splat(255.0));
    for c in 0..3 {
        let to_last = to_both[c] - to_first[c];
        first[c] = bounded(of_last * to_first[c] - of_both * to_last);
        last[c] = bounded(of_first * to_last - of_both * to_first[c]);
    }
    (Lines::between(first, last), apart)
}

/// The four colours of each block lie on a line between two that are kept, in 5, 6 and 5 bits.
struct Lines {
    /// The ends as they are kept; the first is the greater number, as in blocks without holes.
    kept: [Vec4; 2],
    /// The first end as it is shown, less the last.
    way: Colours,
    last: Colours,
}

impl Lines {
    /// Between the kept colours nearest to some.
    fn between(a: Colours, b: Colours) -> Self {
        let (a, b) = (Kept::nearest(a), Kept::nearest(b));
        let in_order = a.number.cmpge(b.number);
        let either = |c: usize| {
            let (first, last) = (Vec4::select(in_order, a.shown[c], b.shown[c]), Vec4::select(in_order, b.shown[c], a.shown[c]));
            (first - last, last)
        };
        let ends = [0, 1, 2].map(either);
        Self {
            kept: [a.number.max(b.number), a.number.min(b.number)],
            way: ends.map(|(way, _)| way),
            last: ends.map(|(_, last)| last),
        }
    }

    /// The share of the first end that each texel has, in thirds, and the sums of squares by which they are off.
    fn shares(&self, channels: &Channels) -> (Texels, Vec4) {
        let (way, last) = (&self.way, &self.last);
        // Where both ends are one, whatever is a share of nothing.
        let length = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).max(Vec4::ONE);
        let thirds = way.map(|way| way * 3.0 / length);
        let mut error = Vec4::ZERO;
        let shares = core::array::from_fn(|i| {
            let off: Colours = core::array::from_fn(|c| channels[c][i] - last[c]);
            let along = off[0] * thirds[0] + off[1] * thirds[1] + off[2] * thirds[2];
            let share = (along.max(Vec4::ZERO).min(Vec4::splat(3.0)) + ROUND - ROUND) * (1.0 / 3.0);
            for c in 0..3 {
                let off = off[c] - share * way[c];
                error += off * off;
            }
            share
        });
        (shares, error)
    }

    fn bytes(&self, shares: &Texels) -> [[u8; 8]; AT_ONCE] {
        let [first, last] = self.kept.map(whole);
        // Two bits a texel: its thirds.
        let half = |from: usize| {
            let placed = (from..from + TEXELS / 2).rev().fold(Vec4::ZERO, |sum, i| sum * 4.0 + shares[i] * 3.0);
            whole(placed)
        };
        let (low, high) = (half(0), half(TEXELS / 2));
        core::array::from_fn(|n| {
            let thirds = low[n] | high[n] << 16;
            // No, one, two and three thirds of the first end have the codes 1, 3, 2 and 0.
            let codes = (thirds ^ thirds << 1) & 0xAAAA_AAAA | !thirds >> 1 & 0x5555_5555;
            // Of two equal ends every code is the same but the last, a hole.
            joined(first[n] as u16, last[n] as u16, if first[n] == last[n] { 0 } else { codes })
        })
    }
}

/// Colours that can be kept: as numbers, and as they are shown.
struct Kept {
    number: Vec4,
    shown: Colours,
}

impl Kept {
    fn nearest([r, g, b]: Colours) -> Self {
        let round = |value: Vec4| value + ROUND - ROUND;
        let near = |value: Vec4, most: f32| round(value * (most / 255.0));
        let (r, g, b) = (near(r, 31.0), near(g, 63.0), near(b, 31.0));
        // The highest bits again below the lowest: so many times the number, its fraction dropped.
        let five = |kept: Vec4| round(kept * 8.25 - 0.375);
        let six = |kept: Vec4| round(kept * 4.0625 - 0.46875);
        Self { number: r * 2048.0 + g * 32.0 + b, shown: [five(r), six(g), five(b)] }
    }
}

/// Whole numbers of at most 22 bits.
fn whole(numbers: Vec4) -> [u32; AT_ONCE] {
    (numbers + ROUND).to_array().map(|number| number.to_bits() & 0x3F_FFFF)
}

fn joined(first: u16, last: u16, codes: u32) -> [u8; 8] {
    let ([a, b], [c, d], [e, f, g, h]) = (first.to_le_bytes(), last.to_le_bytes(), codes.to_le_bytes());
    [a, b, c, d, e, f, g, h]
}

/// A block of one colour: what lies a third of the way between two kept colours comes nearer to it than these.
fn of_one_colour(texel: u32) -> [u8; 8] {
    let colour = texel.to_le_bytes();
    let [r, g, b] = [0, 1, 2].map(|c| PLAIN[usize::from(c == 1)][usize::from(colour[c])]);
    let kept = |of: fn((u8, u8)) -> u8| u16::from(of(r)) << 11 | u16::from(of(g)) << 5 | u16::from(of(b));
    let (first, last) = (kept(|ends| ends.0), kept(|ends| ends.1));
    // Two thirds of the first end, told from either side.
    let codes = match first.cmp(&last) {
        core::cmp::Ordering::Greater => u32::MAX / 3 * 2,
        core::cmp::Ordering::Less => u32::MAX,
        core::cmp::Ordering::Equal => 0,
    };
    joined(first.max(last), first.min(last), codes)
}

/// For channels of 5 and of 6 bits and each value, the ends of which two thirds and one third come nearest to it.
static PLAIN: LazyLock<[[(u8, u8); 256]; 2]> = LazyLock::new(|| {
    [(31_u8, 5_u32), (63, 6)].map(|(most, bits)| {
        let shown = |kept: u8| i32::from(kept << (8 - bits) | kept >> (2 * bits - 8));
        core::array::from_fn(|value| {
            let ends = (0..=most).flat_map(|a| (0..=most).map(move |b| (a, b)));
            // Near ends before far ones: cards round differently between them.
            let off = |&(a, b): &(u8, u8)| ((2 * shown(a) + shown(b) - 3 * value as i32).abs(), a.abs_diff(b));
            ends.min_by_key(off).unwrap_or_default()
        })
    })
});

#[cfg(test)]
mod tests {
    use block_compression::CompressionVariant;
    use block_compression::encode::compress_rgba8;
    use proptest::prelude::*;

    use super::*;

    fn block(texels: &[[u8; 4]; TEXELS]) -> [u8; 8] {
        blocks(&[texels.map(u32::from_le_bytes); AT_ONCE])[0]
    }

    /// A kept colour as a card shows it.
    fn shown(kept: u16) -> [f32; 3] {
        let (r, g, b) = (kept >> 11, kept >> 5 & 63, kept & 31);
        [r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2].map(f32::from)
    }

    /// The texels that a card shows of a block.
    fn read(block: [u8; 8]) -> [[f32; 3]; TEXELS] {
        let [first, last] = [0, 2].map(|at| u16::from_le_bytes([block[at], block[at + 1]]));
        let codes = u32::from_le_bytes([block[4], block[5], block[6], block[7]]);
        let mix = |share: f32| core::array::from_fn(|c| shown(first)[c] * share + shown(last)[c] * (1.0 - share));
        let has_hole = first <= last;
        core::array::from_fn(|i| match (codes >> (2 * i) & 0b11, has_hole) {
            (0, _) => shown(first),
            (1, _) => shown(last),
            (2, false) => mix(2.0 / 3.0),
            (3, false) => mix(1.0 / 3.0),
            (2, true) => mix(0.5),
            _ => panic!("a hole"),
        })
    }

    fn error(texels: &[[u8; 4]; TEXELS], block: [u8; 8]) -> f32 {
        let shown = read(block);
        texels.iter().zip(shown).map(|(texel, shown)| (0..3).map(|c| (f32::from(texel[c]) - shown[c]).powi(2)).sum::<f32>()).sum()
    }

    fn of_library(texels: &[[u8; 4]; TEXELS]) -> [u8; 8] {
        let mut block = [0; 8];
        compress_rgba8(CompressionVariant::BC1, texels.as_flattened(), &mut block, 4, 4, 16);
        block
    }

    #[test]
    fn plain_colours_are_as_near_as_they_can_be() {
        for value in 0..=255_u8 {
            let texels = [[value, value, value, 255]; TEXELS];
            let shown = read(block(&texels))[0];
            assert!(
                shown.iter().zip([1.5, 0.9, 1.5]).all(|(shown, most)| (shown - f32::from(value)).abs() <= most),
                "{value}: {shown:?}"
            );
        }
    }

    #[test]
    fn blocks_of_pictures_are_about_as_true_as_the_librarys() {
        // Edges, ramps and grain, as façades have them.
        let draw = |seed: u32| {
            let mut state = seed.wrapping_mul(0x9E37_79B9) | 1;
            move || {
                state ^= state << 13;
                state ^= state >> 17;
                state ^= state << 5;
                state
            }
        };
        let (mut ours, mut theirs) = (0.0, 0.0);
        for seed in 0..4_000 {
            let mut next = draw(seed);
            let colour = |n: u32| [n as u8, (n >> 8) as u8, (n >> 16) as u8].map(i32::from);
            let (a, b, edge, grain) = (colour(next()), colour(next()), (next() % 5) as i32, (next() % 24) as i32);
            let texels: [[u8; 4]; TEXELS] = core::array::from_fn(|i| {
                let (x, y) = (i as i32 % 4, i as i32 / 4);
                let share = if seed % 2 == 0 { 4 * i32::from(x + y / 2 >= edge) } else { (x + y) * 4 / 6 };
                let noise = (next() % 64) as i32 * grain / 64 - grain / 2;
                let [r, g, b] = core::array::from_fn(|c| (a[c] + (b[c] - a[c]) * share / 4 + noise).clamp(0, 255) as u8);
                [r, g, b, 255]
            });
            ours += f64::from(error(&texels, block(&texels)));
            theirs += f64::from(error(&texels, of_library(&texels)));
        }
        println!("squares of errors: {:.3} of the library's", ours / theirs);
        assert!(ours < theirs * 1.15, "{ours} beside {theirs}");
    }

    #[test]
    fn colours_are_shown_as_cards_do() {
        for kept in 0..=u16::MAX {
            let near = Kept::nearest(shown(kept).map(Vec4::splat));
            assert_eq!((near.number.x as u16, near.shown.map(|c| c.x)), (kept, shown(kept)));
        }
    }

    proptest! {
        #[test]
        fn blocks_have_nothing_to_do_with_each_other(
            texels in prop::array::uniform4(prop::array::uniform16(any::<u32>())),
            plain in prop::option::of(0..AT_ONCE),
        ) {
            let mut texels = texels;
            plain.iter().for_each(|&n| texels[n] = [texels[n][0]; TEXELS]);
            let alone = texels.map(|block| blocks(&[block; AT_ONCE])[0]);
            prop_assert_eq!(blocks(&texels), alone);
        }

        #[test]
        fn whatever_lies_in_a_block_has_no_holes_and_comes_near(texels in prop::array::uniform16(any::<[u8; 4]>())) {
            let (ours, theirs) = (error(&texels, block(&texels)), error(&texels, of_library(&texels)));
            prop_assert!(ours <= theirs * 2.0 + 500.0, "{ours} beside {theirs}");
        }
    }
}
