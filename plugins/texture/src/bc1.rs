//! Blocks of 4 × 4 opaque texels in 8 bytes (BC1), made fast enough for pictures that come while somebody walks.

use std::sync::LazyLock;

use glam::{IVec4, Vec4};

/// Texels of a block.
const TEXELS: usize = 16;
/// Blocks whose squares of errors sum up to less are good enough: channels are off by five of 255, twice what five bits leave.
const CLOSE: f32 = (3 * TEXELS * 5 * 5) as f32;
/// A value of each texel, row by row.
type Texels = [Vec4; 4];
/// A block's channels, 0 to 255.
type Channels = [Texels; 3];
/// A colour, each channel 0 to 255.
type Colour = [f32; 3];

/// A block of texels in RGBA8, whose alpha counts for nothing.
pub(crate) fn block(texels: &[[u8; 4]; TEXELS]) -> [u8; 8] {
    let bits = texels.map(u32::from_le_bytes);
    if bits.iter().all(|texel| texel << 8 == bits[0] << 8) {
        return plain([texels[0][0], texels[0][1], texels[0][2]]);
    }
    let rows: [IVec4; 4] = core::array::from_fn(|y| IVec4::from_array(core::array::from_fn(|x| bits[4 * y + x] as i32)));
    let row = |c: usize, y: usize| (rows[y] >> (8 * c as i32) & 255).as_vec4();
    let channels: Channels = core::array::from_fn(|c| core::array::from_fn(|y| row(c, y)));
    // The diagonal of the colours' bounds along which they lie, a little within them; then the line that fits best.
    let (first, last) = diagonal(&channels);
    let rough = Line::between(first, last);
    let (shares, error) = rough.shares(&channels);
    if error < CLOSE {
        return rough.bytes(&shares);
    }
    let (line, shares) = match fitted(&channels, &shares).map(|fine| (fine, fine.shares(&channels))) {
        Some((fine, (shares, finer))) if finer < error => (fine, shares),
        _ => (rough, shares),
    };
    line.bytes(&shares)
}

/// The sum of all texels' values.
fn sum([a, b, c, d]: Texels) -> f32 {
    (a + b + c + d).element_sum()
}

/// The ends of the diagonal of bounds along which most colours lie.
fn diagonal(channels: &Channels) -> (Colour, Colour) {
    /// So much of the bounds lies beyond either end: few texels are at the very ends.
    const WITHIN: f32 = 1.0 / 16.0;
    let low = channels.map(|[a, b, c, d]| a.min(b).min(c.min(d)).min_element());
    let high = channels.map(|[a, b, c, d]| a.max(b).max(c.max(d)).max_element());
    let range: Colour = core::array::from_fn(|c| high[c] - low[c]);
    let widest = (1..3).fold(0, |widest, c| if range[c] > range[widest] { c } else { widest });
    let about = |c: usize| {
        let middle = Vec4::splat((high[c] + low[c]) * 0.5);
        channels[c].map(|row| row - middle)
    };
    let main = about(widest);
    let (mut first, mut last) = ([0.0; 3], [0.0; 3]);
    for c in 0..3 {
        let own = about(c);
        let along = sum(core::array::from_fn(|y| own[y] * main[y]));
        let (from, to) = (high[c] - range[c] * WITHIN, low[c] + range[c] * WITHIN);
        (first[c], last[c]) = if along < 0.0 { (to, from) } else { (from, to) };
    }
    (first, last)
}

/// The line that fits texels best which have such shares of its ends, by least squares; none where all have the same.
fn fitted(channels: &Channels, shares: &Texels) -> Option<Line> {
    let all = sum(*shares);
    let of_first = sum(shares.map(|share| share * share));
    let of_both = all - of_first;
    let of_last = TEXELS as f32 - all - of_both;
    let scale = of_first * of_last - of_both * of_both;
    if scale < 1e-3 {
        return None;
    }
    let (of_first, of_both, of_last) = (of_first / scale, of_both / scale, of_last / scale);
    let (mut first, mut last) = ([0.0; 3], [0.0; 3]);
    for (c, channel) in channels.iter().enumerate() {
        let to_first = sum(core::array::from_fn(|y| channel[y] * shares[y]));
        let to_last = sum(*channel) - to_first;
        first[c] = (of_last * to_first - of_both * to_last).clamp(0.0, 255.0);
        last[c] = (of_first * to_last - of_both * to_first).clamp(0.0, 255.0);
    }
    Some(Line::between(first, last))
}

/// The four colours of a block lie on a line: its ends as they are kept, in 5, 6 and 5 bits.
#[derive(Debug, Clone, Copy)]
struct Line {
    first: u16,
    last: u16,
}

impl Line {
    /// Between the kept colours nearest to two; the first is the greater number, as in blocks without holes.
    fn between(a: Colour, b: Colour) -> Self {
        let kept = |[r, g, b]: Colour| {
            let near = |value: f32, most: f32| (value * (most / 255.0) + 0.5) as u16;
            near(r, 31.0) << 11 | near(g, 63.0) << 5 | near(b, 31.0)
        };
        let (a, b) = (kept(a), kept(b));
        Self { first: a.max(b), last: a.min(b) }
    }

    /// The share of the first end that each texel has, in thirds, and the sum of squares by which they are off.
    fn shares(self, channels: &Channels) -> (Texels, f32) {
        /// What has no room for fractions: adding it and taking it away again rounds.
        const ROUND: Vec4 = Vec4::splat(12_582_912.0);
        let (first, last) = (shown(self.first), shown(self.last));
        let way: Colour = core::array::from_fn(|c| first[c] - last[c]);
        let length: f32 = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
        let thirds = if length > 0.0 { 3.0 / length } else { 0.0 };
        let mut error = Vec4::ZERO;
        let shares = core::array::from_fn(|y| {
            let off: [Vec4; 3] = core::array::from_fn(|c| channels[c][y] - last[c]);
            let along = (off[0] * way[0] + off[1] * way[1] + off[2] * way[2]) * thirds;
            let share = (along.max(Vec4::ZERO).min(Vec4::splat(3.0)) + ROUND - ROUND) * (1.0 / 3.0);
            for c in 0..3 {
                let off = off[c] - share * way[c];
                error += off * off;
            }
            share
        });
        (shares, error.element_sum())
    }

    fn bytes(self, shares: &Texels) -> [u8; 8] {
        // Of two equal ends every code is the same but the last, a hole.
        if self.first == self.last {
            return joined(self.first, self.last, 0);
        }
        // Two bits a texel: its thirds.
        let places = Vec4::new(3.0, 12.0, 48.0, 192.0);
        let thirds = u32::from_le_bytes(shares.map(|row| (row.dot(places) + 0.5) as u8));
        // No, one, two and three thirds of the first end have the codes 1, 3, 2 and 0.
        let codes = (thirds ^ thirds << 1) & 0xAAAA_AAAA | !thirds >> 1 & 0x5555_5555;
        joined(self.first, self.last, codes)
    }
}

fn joined(first: u16, last: u16, codes: u32) -> [u8; 8] {
    let ([a, b], [c, d], [e, f, g, h]) = (first.to_le_bytes(), last.to_le_bytes(), codes.to_le_bytes());
    [a, b, c, d, e, f, g, h]
}

/// A kept colour as it is shown.
fn shown(kept: u16) -> Colour {
    let (r, g, b) = (kept >> 11, kept >> 5 & 63, kept & 31);
    [r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2].map(f32::from)
}

/// A block of one colour: what lies a third of the way between two kept colours comes nearer to it than these.
fn plain(colour: [u8; 3]) -> [u8; 8] {
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

    proptest! {
        #[test]
        fn whatever_lies_in_a_block_has_no_holes_and_comes_near(texels in prop::array::uniform16(any::<[u8; 4]>())) {
            let (ours, theirs) = (error(&texels, block(&texels)), error(&texels, of_library(&texels)));
            prop_assert!(ours <= theirs * 2.0 + 500.0, "{ours} beside {theirs}");
        }
    }
}
