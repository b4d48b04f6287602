//! Few colours for many.

use veduta_city::Rgb;

/// Rounds in which colours find their places.
const ROUNDS: usize = 12;

/// Many colours as few.
pub(super) struct Quantised {
    pub(super) palette: Vec<Rgb>,
    /// Of each of the many, which of the few stands for it.
    pub(super) texels: Vec<u8>,
    /// Mean of the squares of how far they are from one another, weighted as eyes see them: 9 for a step of a byte in every channel.
    pub(super) error: f32,
}

/// Up to `most` colours (at most 256) that stand for all of them. The same for the same colours.
pub(super) fn quantise(colours: &[Rgb], most: usize) -> Quantised {
    let seen: Vec<[f32; 3]> = colours.iter().map(|&Rgb(r, g, b)| [r, g, b].map(f32::from)).collect();
    // Weighted as eyes see them.
    let apart = |a: &[f32; 3], b: &[f32; 3]| {
        let [r, g, b] = [0, 1, 2].map(|c| (a[c] - b[c]) * (a[c] - b[c]));
        2.0 * r + 4.0 * g + 3.0 * b
    };
    let mut palette: Vec<[f32; 3]> = seen.first().copied().into_iter().collect();
    // Each further one is the colour that is farthest from those before.
    let mut nearest: Vec<f32> = seen.iter().map(|colour| palette.first().map_or(0.0, |first| apart(colour, first))).collect();
    while palette.len() < most {
        let Some(farthest) = (0..seen.len()).max_by(|&a, &b| nearest[a].total_cmp(&nearest[b]).then(b.cmp(&a))) else { break };
        if nearest[farthest] <= 0.0 {
            break;
        }
        palette.push(seen[farthest]);
        for (least, colour) in nearest.iter_mut().zip(&seen) {
            *least = least.min(apart(colour, &seen[farthest]));
        }
    }
    let find = |palette: &[[f32; 3]], colour: &[f32; 3]| {
        (0..palette.len()).min_by(|&a, &b| apart(&palette[a], colour).total_cmp(&apart(&palette[b], colour))).unwrap_or_default()
    };
    for _ in 0..ROUNDS {
        let mut sums = vec![([0.0_f32; 3], 0.0_f32); palette.len()];
        for colour in &seen {
            let (sum, count) = &mut sums[find(&palette, colour)];
            (0..3).for_each(|c| sum[c] += colour[c]);
            *count += 1.0;
        }
        for (place, (sum, count)) in palette.iter_mut().zip(sums) {
            if count > 0.0 {
                *place = sum.map(|c| c / count);
            }
        }
    }
    let texels: Vec<u8> = seen.iter().map(|colour| find(&palette, colour) as u8).collect();
    let sum: f32 = seen.iter().zip(&texels).map(|(colour, &texel)| apart(colour, &palette[usize::from(texel)])).sum();
    let error = sum / seen.len().max(1) as f32;
    let rounded = palette.iter().map(|colour| {
        let [r, g, b] = colour.map(|c| (c + 0.5) as u8);
        Rgb(r, g, b)
    });
    Quantised { palette: rounded.collect(), texels, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_stay_as_they_are() {
        let colours = [Rgb(9, 9, 9), Rgb(200, 10, 10), Rgb(9, 9, 9), Rgb(10, 200, 10)];
        let Quantised { palette, texels, error } = quantise(&colours, 16);
        assert_eq!((palette.len(), error), (3, 0.0));
        assert_eq!(texels.iter().map(|&texel| palette[usize::from(texel)]).collect::<Vec<_>>(), colours);
        assert!(quantise(&[], 16).palette.is_empty());
    }

    #[test]
    fn many_colours_find_near_ones() {
        let colours: Vec<Rgb> = (0..=255).map(|i| Rgb(i, 255 - i, i / 2)).collect();
        let Quantised { palette, texels, error } = quantise(&colours, 16);
        assert!(palette.len() == 16 && error > 0.0 && error < quantise(&colours, 8).error);
        for (colour, &texel) in colours.iter().zip(&texels) {
            assert!(colour.0.abs_diff(palette[usize::from(texel)].0) <= 16, "{colour:?} became {:?}", palette[usize::from(texel)]);
        }
    }
}
