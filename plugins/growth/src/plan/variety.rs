//! Looks of houses, drawn one by one and then set apart: no two neighbours alike.

use rayon::prelude::*;
use veduta_city::{Gable, Opening, Palette, Rgb, Style};

use super::facing::{Edge, Facing};
use super::houses::{Draft, StyleBook};

/// Colours closer than this in every channel look alike.
const ALIKE: u8 = 14;
/// Least distance between window axes: a window of 1.1 m and 0.8 m of wall; metres.
const LEAST_BAY_M: f64 = 1.9;
/// Walls shorter than this stay blind; metres.
const LEAST_WINDOW_WALL_M: f64 = 1.6;
/// Most bays of a wall.
const MOST_BAYS: f64 = 200.0;

/// What a house looks like, apart from its heights.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Look {
    /// Colour of the walls, before the tint.
    pub wall: Rgb,
    /// Whether a person or a map gave the colour.
    pub is_given: bool,
    /// How much lighter drawn colours are, in steps of [`Palette`].
    pub tint: i8,
    /// Colour of the roof.
    pub roof: Rgb,
    /// Windows of the first floor.
    pub main: Opening,
    /// Windows above.
    pub upper: Opening,
    /// Windows of the ground floor.
    pub ground: Opening,
    /// The door.
    pub door: Opening,
    /// Distance between window axes, metres.
    pub bay_m: f64,
    /// Shape of its gables.
    pub gable: Gable,
}

impl Look {
    fn draw(draft: &Draft, style: &Style) -> Self {
        let d = draft.draw;
        let opening = |question, of: &[Opening]| d.pick(question, of).copied().unwrap_or_default();
        let given = draft.bodies.iter().find_map(|b| b.colour);
        Self {
            wall: given.or_else(|| d.pick("wall", &style.walls).copied()).unwrap_or_default(),
            is_given: given.is_some(),
            tint: d.below("tint", Palette::TINTS.count()) as i8 + Palette::TINTS.start(),
            roof: d.pick("roof colour", &style.roof_colours).copied().unwrap_or_default(),
            main: opening("main windows", &style.main_windows),
            upper: opening("windows", &style.windows),
            ground: opening("ground windows", &style.ground_windows),
            door: opening("door", &style.doors),
            bay_m: d.between("bay", style.bay_m.0, style.bay_m.1),
            // A map's buildings keep the roofs that it tells.
            gable: draft.grown.and_then(|_| d.pick("gable", &style.gables).copied()).unwrap_or_default(),
        }
    }

    /// Colour of the walls as they will be painted.
    pub fn painted(&self) -> Rgb {
        if self.is_given { Palette::bounded(self.wall) } else { Palette::tinted(self.wall, self.tint) }
    }
}

/// Window axes of a wall: as near to the wished distance as leaves 0.8 m of wall between windows; none on walls under 1.6 m.
pub(super) fn bays(length_m: f64, bay_m: f64) -> u8 {
    if length_m < LEAST_WINDOW_WALL_M {
        return 0;
    }
    let most = libm::floor(length_m / LEAST_BAY_M).clamp(1.0, MOST_BAYS);
    libm::round(length_m / bay_m.max(LEAST_BAY_M)).clamp(1.0, most) as u8
}

/// The wall that a house is known by: its longest that faces a street, else its longest.
pub(super) fn main_edge<'a>(facing: &'a Facing, (house, draft): (usize, &'a Draft)) -> Option<Edge<'a>> {
    facing
        .of_house(house, draft)
        .max_by(|a, b| (a.is_public, a.length_m()).partial_cmp(&(b.is_public, b.length_m())).unwrap_or(core::cmp::Ordering::Equal))
}

/// Whether two colours can hardly be told apart.
pub(super) fn alike(a: Rgb, b: Rgb) -> bool {
    a.0.abs_diff(b.0) < ALIKE && a.1.abs_diff(b.1) < ALIKE && a.2.abs_diff(b.2) < ALIKE
}

/// Looks of all houses. Those with given colours come first, then the others by id; each takes the first colour of its palette,
/// from the one drawn onwards, that no settled neighbour wears; where the palette is spent, it differs in its windows.
pub(super) fn looks(drafts: &[Draft], facing: &Facing, book: &StyleBook<'_>) -> Vec<Look> {
    let mut looks: Vec<Look> = drafts.par_iter().map(|draft| Look::draw(draft, book.style(draft.style))).collect();
    let width = |house: (usize, &Draft)| main_edge(facing, house).map_or(0.0, |edge| edge.length_m());
    let widths: Vec<f64> = drafts.par_iter().enumerate().map(width).collect();
    let mut order: Vec<usize> = (0..drafts.len()).collect();
    order.sort_by_key(|&h| (!looks[h].is_given, drafts[h].id, h));
    let mut is_settled = vec![false; drafts.len()];
    for h in order {
        let near = facing.neighbours(h).filter(|&n| is_settled[n]).map(|n| (&looks[n], widths[n]));
        let near: Vec<(&Look, f64)> = near.collect();
        looks[h] = set_apart(looks[h].clone(), widths[h], &near, &drafts[h], book.style(drafts[h].style));
        is_settled[h] = true;
    }
    looks
}

fn set_apart(mut look: Look, width: f64, near: &[(&Look, f64)], draft: &Draft, style: &Style) -> Look {
    if !look.is_given {
        let n = style.walls.len();
        let first = draft.draw.below("wall", n);
        let palette = (0..n).filter_map(|k| style.walls.get((first + k) % n)).map(|&wall| Look { wall, ..look.clone() });
        let mut fresh = palette.filter(|l| near.iter().all(|(other, _)| !alike(l.painted(), other.painted())));
        if let Some(fresh) = fresh.next() {
            return fresh;
        }
    }
    // The colours are spent or given: change what else tells houses apart, one thing at a time.
    let is_twin = |l: &Look| near.iter().any(|(other, w)| are_twins(l, width, other, *w));
    let mut variants = style.main_windows.iter().flat_map(|&main| {
        let with_main = Look { main, ..look.clone() };
        let grounds = style.ground_windows.iter().map(move |&ground| Look { ground, ..with_main.clone() });
        grounds.flat_map(|l| [l.bay_m, style.bay_m.0, style.bay_m.1].map(|bay_m| Look { bay_m, ..l.clone() }))
    });
    if is_twin(&look)
        && let Some(other) = variants.find(|l| !is_twin(l))
    {
        look = other;
    }
    look
}

/// Whether two houses are alike in colour, number of axes, main windows and ground floor together.
fn are_twins(a: &Look, a_width: f64, b: &Look, b_width: f64) -> bool {
    alike(a.painted(), b.painted()) && bays(a_width, a.bay_m) == bays(b_width, b.bay_m) && a.main == b.main && a.ground == b.ground
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bays_leave_solid_wall_between_windows() {
        for tenths in 0..400 {
            let length = f64::from(tenths) / 10.0;
            let n = bays(length, 2.4);
            assert_eq!(n == 0, length < 1.6, "{length} m");
            assert!(n <= 1 || length / f64::from(n) >= 1.9, "{n} bays on {length} m");
        }
        assert_eq!(bays(9.0, 3.0), 3);
        assert_eq!(bays(1e9, 3.0), 200);
    }
}
