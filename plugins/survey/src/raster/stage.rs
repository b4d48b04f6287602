//! Steps of reading whose results can be looked at, mended in any paint program, and given back.

use core::fmt;

use super::bitmap::Bitmap;
use super::classify::Classes;
use super::picture::Picture;

/// A step whose result is a picture of the map's size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// What each pixel stands for, before labels are looked through: a colour a class.
    Classes,
    /// Streets and squares free of labels and noise: white on black.
    Streets,
    /// The streets' skeleton: white, on the streets in grey. Only what is white counts when it is given back.
    Skeleton,
}

impl Stage {
    /// In the order in which a map is read.
    pub const ALL: [Self; 3] = [Self::Classes, Self::Streets, Self::Skeleton];

    /// The stage of a file named as stages are written: `map.streets.png` is of [`Stage::Streets`].
    #[must_use]
    pub fn of_file(name: &str) -> Option<Self> {
        let (stem, _) = name.rsplit_once('.')?;
        let word = stem.rsplit_once('.').map_or(stem, |(_, word)| word);
        Self::ALL.into_iter().find(|stage| stage.to_string() == word)
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Classes => "classes",
            Self::Streets => "streets",
            Self::Skeleton => "skeleton",
        })
    }
}

/// What is done with stages while a map is read; nothing, by default.
#[derive(Default)]
pub struct Stages<'a> {
    /// A stage that is taken as it is given, in place of what would be found: a picture of the map's size.
    pub given: Option<(Stage, &'a Picture)>,
    /// Is shown every stage, the one that was given too.
    pub show: Option<&'a mut dyn FnMut(Stage, &Picture)>,
}

impl Stages<'_> {
    /// The picture that was given of a stage.
    pub(super) fn given(&self, stage: Stage) -> Option<&Picture> {
        self.given.filter(|(given, _)| *given == stage).map(|(_, picture)| picture)
    }

    /// Shows a stage, drawn only if anybody looks.
    pub(super) fn show(&mut self, stage: Stage, draw: impl FnOnce() -> Picture) {
        if let Some(show) = &mut self.show {
            show(stage, &draw());
        }
    }
}

/// Colours of streets, built ground, parks, water, railways, labels, houses and squares.
const COLOURS: [[u8; 3]; 8] = [
    [255, 255, 255],
    [217, 197, 168],
    [148, 190, 110],
    [120, 170, 215],
    [120, 60, 150],
    [20, 20, 20],
    [190, 70, 50],
    [255, 225, 60],
];
const WHITE: [u8; 3] = [255; 3];
const GREY: [u8; 3] = [96; 3];
const BLACK: [u8; 3] = [0; 3];
/// A colour with a channel's mean from here on counts as white.
const BRIGHT: u32 = 176;

/// A picture of a colour for each pixel.
fn drawn(width: usize, height: usize, colour: impl Fn(usize, usize) -> [u8; 3]) -> Picture {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| colour(x, y)).collect();
    Picture { width, height, pixels }
}

/// Pixels as a picture: white what is in the first bitmap, grey what is in the second, if there is one.
pub(super) fn of_bitmaps(white: &Bitmap, grey: Option<&Bitmap>) -> Picture {
    drawn(white.width(), white.height(), |x, y| {
        let (x, y) = (x as isize, y as isize);
        if white.get(x, y) {
            WHITE
        } else if grey.is_some_and(|grey| grey.get(x, y)) {
            GREY
        } else {
            BLACK
        }
    })
}

/// What is white in a picture.
pub(super) fn white(picture: &Picture) -> Bitmap {
    let is_white = |colour: [u8; 3]| colour.iter().map(|&c| u32::from(c)).sum::<u32>() >= 3 * BRIGHT;
    Bitmap::from_fn(picture.width, picture.height, |x, y| picture.at(x, y).is_some_and(is_white))
}

/// Classes as a picture.
pub(super) fn of_classes(classes: &Classes) -> Picture {
    drawn(classes.street.width(), classes.street.height(), |x, y| {
        let (x, y) = (x as isize, y as isize);
        let Classes { street, park, water, railway, ink, house, square } = classes;
        // What is a square is a street too.
        let shown = [square, street, park, water, railway, ink, house];
        let colours = [COLOURS[7], COLOURS[0], COLOURS[2], COLOURS[3], COLOURS[4], COLOURS[5], COLOURS[6]];
        shown.iter().zip(colours).find(|(class, _)| class.get(x, y)).map_or(COLOURS[1], |(_, colour)| colour)
    })
}

/// The classes that a picture shows, by the nearest of their colours: brushes of paint programs have soft edges.
pub(super) fn classes(picture: &Picture) -> Classes {
    let distance2 = |a: [u8; 3], b: [u8; 3]| (0..3).map(|c| (i32::from(a[c]) - i32::from(b[c])).pow(2)).sum::<i32>();
    let nearest = |x, y| {
        let colour = picture.at(x, y).unwrap_or(COLOURS[1]);
        (0..COLOURS.len()).min_by_key(|&i| distance2(COLOURS[i], colour))
    };
    let of = |class: usize| Bitmap::from_fn(picture.width, picture.height, |x, y| nearest(x, y) == Some(class));
    let mut street = of(0);
    let square = of(7);
    street.add(&square);
    Classes { street, park: of(2), water: of(3), railway: of(4), ink: of(5), house: of(6), square }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_told_by_their_files_names() {
        for stage in Stage::ALL {
            assert_eq!(Stage::of_file(&format!("map.{stage}.png")), Some(stage));
            assert_eq!(Stage::of_file(&format!("{stage}.png")), Some(stage));
        }
        for name in ["map.png", "streets", "streets.map.png", ".png"] {
            assert_eq!(Stage::of_file(name), None, "{name}");
        }
    }

    #[test]
    fn classes_come_back_as_they_were_drawn() {
        let of = |n: usize| Bitmap::from_fn(70, 9, |x, y| (x / 3 + y) % 8 == n);
        let mut street = of(0);
        street.add(&of(6));
        let drawn = Classes { street, park: of(1), water: of(2), railway: of(3), ink: of(4), house: of(5), square: of(6) };
        let back = classes(&of_classes(&drawn));
        assert_eq!(back.street, drawn.street);
        assert_eq!(back.park, drawn.park);
        assert_eq!(back.water, drawn.water);
        assert_eq!(back.railway, drawn.railway);
        assert_eq!(back.ink, drawn.ink);
        assert_eq!(back.house, drawn.house);
        assert_eq!(back.square, drawn.square);
    }

    #[test]
    fn only_white_comes_back_of_a_skeleton() {
        let street = Bitmap::from_fn(70, 9, |_, y| y > 2);
        let line = Bitmap::from_fn(70, 9, |_, y| y == 5);
        assert_eq!(white(&of_bitmaps(&line, Some(&street))), line);
    }
}
