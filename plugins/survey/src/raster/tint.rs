//! Classes of streets by the colour they are printed in.

use glam::DVec2;
use veduta_city::StreetClass;

use super::classify::{CLASS_BITS, Light, STREET, TABLE, entry_at, looked_up};
use super::legend::{Legend, MapClass};
use super::picture::Picture;

/// Pixels between places at which a street is looked at …
const STATION_PX: f64 = 3.0;
/// … and how far to its sides, in half widths: nearer to its edge, colours mix.
const ASIDE: [f64; 3] = [-0.45, 0.0, 0.45];
/// Share of a street's length at each end that is not looked at, where another one's colour may cover it.
const ENDS: f64 = 0.15;
/// No class, and every class of street.
const KINDS: usize = 8;
const CLASSES: [StreetClass; KINDS - 1] = StreetClass::ALL;

/// What is not a street's colour.
const OTHER: u8 = u8::MAX;

/// The colours of a map's streets, where its legend tells classes by them.
pub(super) struct Tints<'a> {
    picture: &'a Picture,
    light: Light,
    /// How many times larger than the picture the places are that are asked for.
    times: f64,
    /// For each colour, the street's class counted from 1, 0 for a street without one, or [`OTHER`].
    table: Box<[u8; TABLE]>,
}

impl<'a> Tints<'a> {
    /// Nothing where the legend has no class of street. Places will be asked for so many times larger than the picture.
    pub fn of(picture: &'a Picture, legend: &Legend, times: usize) -> Option<Self> {
        if !legend.colours.iter().any(|c| matches!(c.class, MapClass::Street(Some(_)))) {
            return None;
        }
        let is_street = |class: u8| class % (1 << CLASS_BITS) == STREET;
        let (light, table) = looked_up(picture, legend, |class| if is_street(class) { class >> CLASS_BITS } else { OTHER });
        Some(Self { picture, light, times: times as f64, table })
    }

    /// The class of a street along a line of so many half pixels' width, pixels with y down: what most of its colour says.
    /// Nothing where that is the colour of streets without a class.
    pub fn class_of(&self, line: &[DVec2], half: f64) -> Option<StreetClass> {
        let length: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
        let (from, to) = (length * ENDS, length * (1.0 - ENDS));
        let mut votes = [0usize; KINDS];
        let mut gone = 0.0;
        // The first station lies half a step in.
        let mut next = f64::max(from, STATION_PX.min(length) / 2.0);
        for stretch in line.windows(2) {
            let (a, along) = (stretch[0], stretch[1] - stretch[0]);
            let Some(way) = along.try_normalize() else { continue };
            while next <= (gone + along.length()).min(to) {
                let at = a + way * (next - gone);
                for aside in ASIDE {
                    let kind = self.at(at + way.perp() * (aside * half));
                    if let Some(votes) = votes.get_mut(usize::from(kind)) {
                        *votes += 1;
                    }
                }
                next += STATION_PX;
            }
            gone += along.length();
        }
        // Of equals the one without a class, then the widest.
        let most = votes.iter().copied().max()?;
        let kind = votes.iter().position(|&v| v == most)?;
        kind.checked_sub(1).and_then(|class| CLASSES.get(class)).copied()
    }

    fn at(&self, p: DVec2) -> u8 {
        if p.min_element() < 0.0 {
            return OTHER;
        }
        let (x, y) = ((p.x / self.times) as usize, (p.y / self.times) as usize);
        self.picture.at(x, y).map_or(OTHER, |pixel| self.table[entry_at(pixel, self.light.gain_at(x, y))])
    }
}
