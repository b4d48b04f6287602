//! Capitals of even strokes, as sign painters write them.

use crate::canvas::{Canvas, Rect, Texel, stroke};

/// Strokes of a letter, from corner to corner; its height is 1, its foot at 0.
type Strokes = &'static [&'static [(f32, f32)]];

/// Letters with their widths.
const LETTERS: [(char, f32, Strokes); 14] = [
    ('A', 0.70, &[&[(0.0, 0.0), (0.35, 1.0), (0.70, 0.0)], &[(0.13, 0.36), (0.57, 0.36)]]),
    ('\u{c1}', 0.70, &[&[(0.0, 0.0), (0.35, 1.0), (0.70, 0.0)], &[(0.13, 0.36), (0.57, 0.36)], &[(0.33, 1.14), (0.46, 1.32)]]),
    ('E', 0.52, &[&[(0.52, 1.0), (0.0, 1.0), (0.0, 0.0), (0.52, 0.0)], &[(0.0, 0.53), (0.43, 0.53)]]),
    ('I', 0.0, &[&[(0.0, 0.0), (0.0, 1.0)]]),
    ('K', 0.58, &[&[(0.0, 0.0), (0.0, 1.0)], &[(0.54, 1.0), (0.0, 0.38)], &[(0.18, 0.58), (0.58, 0.0)]]),
    ('L', 0.48, &[&[(0.0, 1.0), (0.0, 0.0), (0.48, 0.0)]]),
    ('M', 0.80, &[&[(0.0, 0.0), (0.06, 1.0), (0.40, 0.22), (0.74, 1.0), (0.80, 0.0)]]),
    ('N', 0.64, &[&[(0.0, 0.0), (0.0, 1.0), (0.64, 0.0), (0.64, 1.0)]]),
    (
        'O',
        0.84,
        &[&[
            (0.84, 0.50),
            (0.78, 0.75),
            (0.63, 0.93),
            (0.42, 1.0),
            (0.21, 0.93),
            (0.06, 0.75),
            (0.0, 0.50),
            (0.06, 0.25),
            (0.21, 0.07),
            (0.42, 0.0),
            (0.63, 0.07),
            (0.78, 0.25),
            (0.84, 0.50),
        ]],
    ),
    (
        'R',
        0.56,
        &[
            &[(0.0, 0.0), (0.0, 1.0), (0.28, 1.0), (0.44, 0.94), (0.50, 0.77), (0.44, 0.60), (0.28, 0.53), (0.0, 0.53)],
            &[(0.26, 0.53), (0.56, 0.0)],
        ],
    ),
    (
        'S',
        0.52,
        &[&[
            (0.48, 0.86),
            (0.38, 0.97),
            (0.24, 1.0),
            (0.09, 0.93),
            (0.03, 0.77),
            (0.10, 0.62),
            (0.26, 0.53),
            (0.43, 0.43),
            (0.51, 0.27),
            (0.44, 0.08),
            (0.27, 0.0),
            (0.10, 0.03),
            (0.0, 0.15),
        ]],
    ),
    ('T', 0.62, &[&[(0.0, 1.0), (0.62, 1.0)], &[(0.31, 1.0), (0.31, 0.0)]]),
    ('V', 0.70, &[&[(0.0, 1.0), (0.35, 0.0), (0.70, 1.0)]]),
    ('W', 0.98, &[&[(0.0, 1.0), (0.25, 0.0), (0.49, 0.86), (0.73, 0.0), (0.98, 1.0)]]),
];

/// Room between letters, and half the breadth of strokes, in heights of a letter.
const SPACE: f32 = 0.34;
const HALF: f32 = 0.075;

/// Writes a word about a place: `tall` metres high. Letters that there are none of are left out.
pub(crate) fn write(canvas: &mut Canvas, word: &str, (cx, foot): (f32, f32), tall: f32, fill: Texel) {
    let letters: Vec<_> = word.chars().filter_map(|c| LETTERS.iter().find(|letter| letter.0 == c)).collect();
    let width = letters.iter().map(|letter| letter.1).sum::<f32>() + SPACE * letters.len().saturating_sub(1) as f32;
    let mut left = cx - width * tall / 2.0;
    for &&(_, wide, strokes) in &letters {
        let place = |(x, y): (f32, f32)| (left + x * tall, foot + y * tall);
        let half = HALF * tall;
        let area = Rect::new(left, foot, left + wide * tall, foot + 1.35 * tall).grow(half, half);
        let distance = |x: f32, y: f32| {
            let pieces = strokes.iter().flat_map(|line| line.windows(2));
            pieces.map(|piece| stroke(place(piece[0]), place(piece[1]), half, x, y)).fold(f32::MAX, f32::min)
        };
        canvas.paint(area, distance, |_, _| fill);
        left += (wide + SPACE) * tall;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_stands_about_its_middle_on_its_foot() {
        let mut canvas = Canvas::tiling(256, (2.0, 1.0), |_, _| Texel::tinted(0.0, 0.5));
        write(&mut canvas, "NOV\u{c1}K", (1.0, 0.4), 0.2, Texel::tinted(1.0, 0.5));
        let inked = |row: usize, column: usize| canvas.texels[row * 256 + column].tint.x > 0.5;
        let columns: Vec<usize> = (0..256).filter(|&column| (0..256).any(|row| inked(row, column))).collect();
        let rows: Vec<usize> = (0..256).filter(|&row| (0..256).any(|column| inked(row, column))).collect();
        let (left, right) = (columns[0], columns[columns.len() - 1]);
        assert!((left + right).abs_diff(255) < 6, "from {left} to {right}");
        // The foot is 0.6 m below the top; the accent rises a third above the letters.
        assert!(rows[rows.len() - 1].abs_diff(157) < 4 && rows[0].abs_diff(84) < 5, "{rows:?}");
    }

    #[test]
    fn letters_that_are_not_there_take_no_room() {
        let written = |word: &str| {
            let mut canvas = Canvas::tiling(64, (1.0, 1.0), |_, _| Texel::tinted(0.0, 0.5));
            write(&mut canvas, word, (0.5, 0.4), 0.2, Texel::tinted(1.0, 0.5));
            canvas.texels.iter().map(|texel| texel.tint.x).sum::<f32>()
        };
        assert_eq!(written("?L#"), written("L"));
        assert!(written("L") > 0.0);
    }
}
