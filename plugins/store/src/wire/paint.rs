//! Colours of houses: by the palettes of their styles where they come from there.

use serde::{Deserialize, Serialize};
use veduta_city::{Palette, Rgb};

use super::Malformed;

/// Colours of the walls and the roof of a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Paint {
    wall: Colour,
    roof: Colour,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Colour {
    /// One of the palette's, and how many tints it is from that of the colour before.
    Drawn(u8, i8),
    /// Any.
    Told(u8, u8, u8),
}

/// Paints one volume after another.
pub(crate) struct Brush<'p> {
    palettes: &'p [Palette],
    last: [Rgb; 2],
}

impl<'p> Brush<'p> {
    pub(crate) fn new(palettes: &'p [Palette]) -> Self {
        Self { palettes, last: Default::default() }
    }

    fn palette(&self, style: u16) -> Option<&'p Palette> {
        self.palettes.get(usize::from(style))
    }

    /// How the colours of walls and roof of the next volume are told; `None` if they are those of the volume before.
    pub(crate) fn tell(&mut self, style: u16, colours: [Rgb; 2]) -> Option<Paint> {
        if core::mem::replace(&mut self.last, colours) == colours {
            return None;
        }
        let [wall, roof] = colours;
        let palette = self.palette(style);
        let find = |of: &[Rgb], colour: Rgb, tint: i8| {
            // Most roofs have the tint of their walls, so that it is tried first.
            let tints = core::iter::once(tint).chain(Palette::TINTS);
            let all = tints.flat_map(|tint| (0..).zip(of).map(move |(n, &drawn)| (n, tint, drawn)));
            let found = all.filter(|&(_, tint, drawn)| Palette::tinted(drawn, tint) == colour).map(|(n, tint, _)| (n, tint)).next();
            found.map_or(((Colour::Told(colour.0, colour.1, colour.2)), 0), |(n, told)| (Colour::Drawn(n, told - tint), told))
        };
        let (wall, tint) = find(palette.map_or(&[][..], |p| first(&p.walls)), wall, 0);
        Some(Paint { wall, roof: find(palette.map_or(&[][..], |p| first(&p.roofs)), roof, tint).0 })
    }

    /// The colours of the next volume.
    pub(crate) fn paint(&mut self, style: u16, paint: Option<Paint>) -> Result<[Rgb; 2], Malformed> {
        let Some(paint) = paint else { return Ok(self.last) };
        let palette = self.palette(style);
        let none = Malformed::Reason("a colour is not in the palette of its house's style");
        let take = |colour, of: Option<&[Rgb]>, before: i8| match colour {
            Colour::Told(r, g, b) => Ok((Rgb(r, g, b), 0)),
            Colour::Drawn(n, step) => {
                let drawn = of.and_then(|of| of.get(usize::from(n))).ok_or(none)?;
                let tint = before.checked_add(step).filter(|tint| Palette::TINTS.contains(tint)).ok_or(none)?;
                Ok((Palette::tinted(*drawn, tint), tint))
            }
        };
        let (wall, tint) = take(paint.wall, palette.map(|p| &p.walls[..]), 0)?;
        self.last = [wall, take(paint.roof, palette.map(|p| &p.roofs[..]), tint)?.0];
        Ok(self.last)
    }

    /// How the colour of mouldings is told; `None` if it is the one that goes with the wall.
    pub(crate) fn tell_trim(&self, style: u16, wall: Rgb, trim: Rgb) -> Option<(u8, u8, u8)> {
        let goes_with = self.palette(style).map(|palette| palette.trim(wall));
        (goes_with != Some(trim)).then_some((trim.0, trim.1, trim.2))
    }

    /// The colour of mouldings.
    pub(crate) fn trim(&self, style: u16, wall: Rgb, told: Option<(u8, u8, u8)>) -> Result<Rgb, Malformed> {
        let goes_with = || self.palette(style).map(|palette| palette.trim(wall));
        let none = Malformed::Reason("mouldings have no colour, and their house no palette");
        told.map(|(r, g, b)| Rgb(r, g, b)).or_else(goes_with).ok_or(none)
    }
}

/// As many colours as have numbers.
fn first(of: &[Rgb]) -> &[Rgb] {
    of.get(..usize::from(u8::MAX)).unwrap_or(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_the_palette_and_any_others_survive() {
        let walls = vec![Rgb(200, 180, 140), Rgb(220, 220, 210), Rgb(0x1A, 255, 7)];
        let palettes = [Palette { walls, roofs: vec![Rgb(140, 60, 40)], trim: 1.1 }];
        let wall = Palette::tinted(Rgb(220, 220, 210), -2);
        let drawn = [wall, Palette::tinted(Rgb(140, 60, 40), -2)];
        let odd = [Rgb(1, 2, 3), Rgb(7, 8, 9)];
        let all = [(0, drawn), (0, drawn), (7, drawn), (0, odd), (9, odd), (0, [drawn[0], odd[1]])];
        let (mut told, mut read) = (Brush::new(&palettes), Brush::new(&palettes));
        let paints = all.map(|(style, colours)| told.tell(style, colours));
        assert_eq!(paints[0], Some(Paint { wall: Colour::Drawn(1, -2), roof: Colour::Drawn(0, 0) }));
        assert_eq!(paints[1], None);
        let back = paints.iter().zip(all).map(|(&paint, (style, _))| read.paint(style, paint));
        assert_eq!(back.collect::<Result<Vec<_>, _>>(), Ok(all.map(|(_, colours)| colours).to_vec()));
        let beyond = Paint { wall: Colour::Drawn(3, 0), roof: Colour::Drawn(0, 0) };
        for (style, paint) in [(0, beyond), (1, paints[0].expect("told")), (0, Paint { roof: Colour::Drawn(0, 9), ..beyond })] {
            assert!(read.paint(style, Some(paint)).is_err());
        }
    }

    #[test]
    fn mouldings_go_with_the_wall_or_have_any_colour() {
        let palettes = [Palette { walls: Vec::new(), roofs: Vec::new(), trim: 1.1 }];
        let brush = Brush::new(&palettes);
        let (wall, odd) = (Rgb(200, 180, 140), Rgb(4, 5, 6));
        let trim = palettes[0].trim(wall);
        assert_eq!([trim, odd].map(|trim| brush.tell_trim(0, wall, trim)), [None, Some((4, 5, 6))]);
        assert_eq!([None, Some((4, 5, 6))].map(|told| brush.trim(0, wall, told)), [Ok(trim), Ok(odd)]);
        assert_eq!(brush.tell_trim(1, wall, trim), Some((trim.0, trim.1, trim.2)), "no palette");
        assert!(brush.trim(1, wall, None).is_err());
    }
}
