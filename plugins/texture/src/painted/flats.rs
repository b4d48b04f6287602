//! Flat colours: what of a painting has one colour has exactly that one again after a lossy codec.
//!
//! A codec shifts flat areas by a step or two and rings beside edges, which eyes see first where nothing else is. So the most frequent colours of
//! a picture travel with it, and texels that come near to one of them become it. A photograph has none.

use veduta_city::Rgb;

use super::Pixels;

/// The colours of a picture that most of its texels have.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct FlatColours {
    /// How far in any channel a texel may be from one of them to become it.
    reach: u8,
    colours: Vec<Rgb>,
}

impl FlatColours {
    /// Most of them.
    pub(super) const MOST: usize = 64;
    /// Least texels that make a colour worth its bytes.
    const LEAST: usize = 128;
    /// Reaches that are tried.
    const REACHES: [u8; 6] = [0, 2, 3, 4, 5, 6];
    /// Two of them are farther apart than this.
    const APART: u8 = 2;
    /// Farthest that any reaches.
    const FARTHEST: u8 = 8;
    /// Colours of a channel that a cell of the table has.
    const CELL: u8 = 4;

    /// Those of a picture, with the reach that brings a decoded one nearest to it.
    pub(super) fn of(picture: &Pixels, decoded: &Pixels) -> Self {
        let mut texels = picture.texels.clone();
        texels.sort_unstable();
        let runs = texels.chunk_by(|a, b| a == b).map(|run| (run[0], run.len()));
        let mut frequent: Vec<(Rgb, usize)> = runs.filter(|&(_, count)| count >= Self::LEAST).collect();
        frequent.sort_by_key(|&(colour, count)| (core::cmp::Reverse(count), colour));
        let mut colours: Vec<Rgb> = Vec::new();
        for (colour, _) in frequent {
            if colours.len() < Self::MOST && colours.iter().all(|&other| distance(colour, other) > Self::APART) {
                colours.push(colour);
            }
        }
        let restored = |reach: u8| {
            let flats = Self { reach, colours: colours.clone() };
            let mut restored = decoded.clone();
            flats.restore(&mut restored);
            (error(picture, &restored), flats)
        };
        let best = Self::REACHES.map(restored).into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, flats)| flats).filter(|flats| flats.reach > 0).unwrap_or_default()
    }

    /// Gives texels that are near to one of them that colour.
    pub(super) fn restore(&self, picture: &mut Pixels) {
        if self.reach == 0 {
            return;
        }
        let per_side = usize::from(u8::MAX / Self::CELL) + 1;
        let cell = |c: u8| usize::from(c / Self::CELL);
        // Which colour a cell's texels may become: the first, which is the most frequent, of those that reach it.
        let mut table = vec![u8::MAX; per_side * per_side * per_side];
        for (n, &Rgb(r, g, b)) in (0_u8..).zip(&self.colours) {
            let range = |c: u8| cell(c.saturating_sub(self.reach))..=cell(c.saturating_add(self.reach));
            for at in range(r).flat_map(|r| range(g).flat_map(move |g| range(b).map(move |b| (r * per_side + g) * per_side + b))) {
                if table[at] == u8::MAX || self.is_nearer(n, table[at], at, per_side) {
                    table[at] = n;
                }
            }
        }
        for texel in &mut picture.texels {
            let at = (cell(texel.0) * per_side + cell(texel.1)) * per_side + cell(texel.2);
            if let Some(&colour) = self.colours.get(usize::from(table[at]))
                && distance(*texel, colour) <= self.reach
            {
                *texel = colour;
            }
        }
    }

    /// Whether the middle of a cell is nearer to one colour than to another.
    fn is_nearer(&self, a: u8, b: u8, at: usize, per_side: usize) -> bool {
        let middle = |cell: usize| (cell as u8) * Self::CELL + Self::CELL / 2;
        let middle = Rgb(middle(at / per_side / per_side), middle(at / per_side % per_side), middle(at % per_side));
        let far = |n: u8| {
            let Rgb(r, g, b) = self.colours[usize::from(n)];
            [(r, middle.0), (g, middle.1), (b, middle.2)].map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).iter().sum::<u32>()
        };
        far(a) < far(b)
    }

    /// As bytes: the reach, then red, green and blue of each; nothing if there are none.
    pub(super) fn bytes(&self) -> Vec<u8> {
        if self.reach == 0 {
            return Vec::new();
        }
        core::iter::once(self.reach).chain(self.colours.iter().flat_map(|&Rgb(r, g, b)| [r, g, b])).collect()
    }

    /// Of bytes; `None` if they are others.
    pub(super) fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let (&reach, colours) = bytes.split_first()?;
        let (colours, rest) = colours.as_chunks::<3>();
        let is_sound = (1..=Self::FARTHEST).contains(&reach) && rest.is_empty() && (1..=Self::MOST).contains(&colours.len());
        is_sound.then(|| Self { reach, colours: colours.iter().map(|&[r, g, b]| Rgb(r, g, b)).collect() })
    }
}

/// How far apart two colours are in the channel in which they are most.
fn distance(a: Rgb, b: Rgb) -> u8 {
    a.0.abs_diff(b.0).max(a.1.abs_diff(b.1)).max(a.2.abs_diff(b.2))
}

/// How much two pictures differ for an eye, to which many small differences are more than few large ones.
fn error(a: &Pixels, b: &Pixels) -> f64 {
    a.texels.iter().zip(&b.texels).map(|(&a, &b)| f64::from(distance(a, b)).sqrt()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = Rgb(170, 60, 50);
    const SAND: Rgb = Rgb(210, 180, 120);

    /// Red on the left, sand on the right, some texels of neither; and the same after a codec that is a step or two off.
    fn pictures() -> (Pixels, Pixels) {
        let of = |off: fn(usize) -> u8| {
            let texel = |i: usize| match i % 64 {
                0..30 => Rgb(RED.0 + off(i), RED.1, RED.2 - off(i)),
                30..34 => Rgb(100 + (i / 64) as u8, 90, 80),
                _ => Rgb(SAND.0, SAND.1 - off(i), SAND.2),
            };
            Pixels { width: 64, texels: (0..64 * 64).map(texel).collect() }
        };
        (of(|_| 0), of(|i| (i % 3) as u8))
    }

    #[test]
    fn flat_areas_are_as_they_were_and_others_as_they_came() {
        let (picture, mut decoded) = pictures();
        let flats = FlatColours::of(&picture, &decoded);
        assert_eq!(flats.colours, [RED, SAND]);
        flats.restore(&mut decoded);
        assert!(decoded == picture);
        assert_eq!(FlatColours::of_bytes(&flats.bytes()), Some(flats));
    }

    #[test]
    fn a_photograph_has_none() {
        let texel = |i: usize| Rgb((i * 7919 % 251) as u8, (i * 104_729 % 241) as u8, (i * 1_299_709 % 239) as u8);
        let photograph = Pixels { width: 64, texels: (0..64 * 64).map(texel).collect() };
        let flats = FlatColours::of(&photograph, &photograph);
        assert_eq!((&flats, flats.bytes()), (&FlatColours::default(), Vec::new()));
        let mut same = photograph.clone();
        flats.restore(&mut same);
        assert!(same == photograph);
    }

    #[test]
    fn other_bytes_are_refused() {
        for bytes in [&[][..], &[2], &[2, 1], &[0, 1, 2, 3], &[9, 1, 2, 3], &[2; 1 + 3 * 65], &[2, 1, 2, 3, 4]] {
            assert_eq!(FlatColours::of_bytes(bytes), None, "{bytes:?}");
        }
    }
}
