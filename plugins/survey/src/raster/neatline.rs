//! The neatline of a scanned sheet: the frame that a map ends at. What lies in the margin around it is no part of the map, and
//! neither is the sheet's grid.
//!
//! A neatline is four long lines that end at each other's corners. The lines of a grid are as long, but others cross them and
//! go on; they divide the map into even parts. Paper is never flat, so all of them may wander a little.

mod line;

use core::ops::Range;

use glam::{DVec2, UVec2};

use super::bitmap::Bitmap;
use super::classify::{Classes, classified};
use super::legend::Legend;
use super::picture::Picture;
use line::{BANDS, Line, Side, Strip};

/// Share of the picture's border that shows nothing but paper where a sheet has a margin.
const BLANK: f64 = 0.95;
/// Colours of paper differ by no more than this from the one in the middle, each channel.
const PAPER: u8 = 48;
/// Pixels from the border at which that is looked at: scans end in a soft line.
const BORDER: usize = 3;
/// A margin takes at most this share of a picture's side.
const DEEP: f64 = 0.25;
/// Share of a line that must be there, …
const THERE: f64 = 0.75;
/// … and of what would go on beyond its end, that may be: so far, as a share of a side, and so far from the end, pixels.
const GONE: f64 = 0.3;
const BEYOND: f64 = 0.015;
const END: usize = 4;
/// Lines that are tried for each side.
const LINES: usize = 6;
/// Most parts that a grid divides a map into, …
const MOST_PARTS: usize = 12;
/// … by lines of which so much is there, …
const GRID_THERE: f64 = 0.6;
/// … so near to their place, as a share of the picture, …
const GRID_NEAR: f64 = 0.004;
/// … so thin, pixels, …
const GRID_THICK: usize = 6;
/// … and which run with the neatline but for so many pixels.
const GRID_ASTRAY: usize = 6;

/// The inside of a sheet's neatline, pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Neatline {
    /// The first and last column inside, for each row.
    columns: Vec<[usize; 2]>,
    /// The first and last row inside, for each column.
    rows: Vec<[usize; 2]>,
    /// What holds it: its first pixel, and the one after its last.
    low: UVec2,
    high: UVec2,
    /// Lines of the sheet's grid: where they are, and how thick.
    grid: Vec<(Line, Range<usize>, usize)>,
}

impl Neatline {
    /// Of a map that has one, and nothing but paper at its border.
    pub fn of(picture: &Picture, legend: &Legend) -> Option<Self> {
        if !has_blank_border(picture) {
            return None;
        }
        let marks = marks(&classified(picture, legend))?;
        let [left, right, top, bottom] = Side::ALL.map(|side| lines(&marks, side));
        let pairs = left.iter().flat_map(|left| right.iter().map(move |right| [left, right]));
        let threes = pairs.flat_map(|[left, right]| top.iter().map(move |top| [left, right, top]));
        let frames = threes.flat_map(|[left, right, top]| bottom.iter().map(move |bottom| Frame([left, right, top, bottom])));
        let smallest = frames.filter(Frame::is_closed).min_by(|a, b| a.area().total_cmp(&b.area()))?;
        Some(smallest.inside(&marks))
    }

    /// Its first column and row, and the ones after its last.
    pub fn extent(&self) -> [UVec2; 2] {
        [self.low, self.high]
    }

    /// From a picture's lower left corner to its own, y up.
    pub fn corner(&self) -> DVec2 {
        DVec2::new(f64::from(self.low.x), self.columns.len() as f64 - f64::from(self.high.y))
    }

    /// The map alone.
    pub fn map_of(&self, picture: &Picture) -> Picture {
        if self.grid.is_empty() {
            return self.cropped(picture);
        }
        let mut picture = picture.clone();
        for (line, range, thick) in &self.grid {
            line.erase(*thick, range.clone(), &mut picture);
        }
        self.cropped(&picture)
    }

    /// What is inside, in the box that holds it; what of that box lies outside shows what lies nearest inside.
    pub fn cropped(&self, picture: &Picture) -> Picture {
        let [width, height] = (self.high - self.low).to_array().map(|n| n as usize);
        let mut pixels = Vec::with_capacity(3 * width * height);
        for y in self.low.y as usize..self.high.y as usize {
            let [first, last] = self.columns[y];
            for x in self.low.x as usize..self.high.x as usize {
                let x = x.clamp(first, last);
                let [top, bottom] = self.rows[x];
                pixels.extend(picture.at(x, y.clamp(top, bottom)).unwrap_or_default());
            }
        }
        Picture { width, height, pixels }
    }

    /// A picture of what is inside, with black about it, as large as the whole.
    pub fn pasted(&self, inside: &Picture) -> Picture {
        let (width, height) = (self.rows.len(), self.columns.len());
        let mut pixels = vec![0; 3 * width * height];
        for y in 0..inside.height {
            let to = 3 * ((y + self.low.y as usize) * width + self.low.x as usize);
            pixels[to..to + 3 * inside.width].copy_from_slice(&inside.pixels[3 * y * inside.width..][..3 * inside.width]);
        }
        Picture { width, height, pixels }
    }
}

/// Whether nearly all of a picture's border has one colour.
fn has_blank_border(picture: &Picture) -> bool {
    let (width, height) = (picture.width, picture.height);
    if width.min(height) < 2 * BANDS {
        return false;
    }
    let mut colours: Vec<[u8; 3]> = border(width, height).filter_map(|(x, y)| picture.at(x, y)).collect();
    let half = colours.len() / 2;
    let middle = [0, 1, 2].map(|c| colours.select_nth_unstable_by_key(half, |colour| colour[c]).1[c]);
    let is_paper = |colour: &&[u8; 3]| (0..3).all(|c| colour[c].abs_diff(middle[c]) <= PAPER);
    colours.iter().filter(is_paper).count() as f64 > BLANK * colours.len() as f64
}

/// The pixels at a picture's border.
fn border(width: usize, height: usize) -> impl Iterator<Item = (usize, usize)> {
    let across = (0..width).flat_map(move |x| [(x, BORDER), (x, height - 1 - BORDER)]);
    across.chain((0..height).flat_map(move |y| [(BORDER, y), (width - 1 - BORDER, y)]))
}

/// What is not of the class that the border has.
fn marks(classes: &Classes) -> Option<Bitmap> {
    let Classes { street, park, water, railway, ink, house, square: _ } = classes;
    let (width, height) = (street.width(), street.height());
    let mut any = street.clone();
    [park, water, railway, ink, house].into_iter().for_each(|class| any.add(class));
    let all = [street.inverted(), any, park.inverted(), water.inverted(), ink.inverted()];
    let count = border(width, height).count() as f64;
    all.into_iter().find(|marks| {
        let marked = border(width, height).filter(|&(x, y)| marks.get(x as isize, y as isize)).count();
        (marked as f64) < (1.0 - BLANK) * count
    })
}

/// The lines along a side that are mostly there, the clearest first.
fn lines(marks: &Bitmap, side: Side) -> Vec<Line> {
    let [length, depth] = side.size(marks.width(), marks.height());
    let mut found = Strip::of(marks, side, 0..(DEEP * depth as f64) as usize).lines(LINES);
    // The middle of a side is sure to be between the corners.
    found.retain(|line| line.there(length / 4..length - length / 4) > THERE);
    found
}

/// Four lines: left, right, top and bottom.
struct Frame<'a>([&'a Line; 4]);

impl Frame<'_> {
    /// Rows in which the left line begins and ends, and the right one; columns of the top one, and the bottom one.
    fn spans(&self) -> [Range<usize>; 4] {
        let [left, right, top, bottom] = self.0.map(|line| &line.inward);
        let (width, height) = (top.len(), left.len());
        let across = |row: usize| left[row]..width - 1 - right[row];
        let down = |column: usize| top[column]..height - 1 - bottom[column];
        // Lines hardly turn: one step from the middles is enough.
        let [columns, rows] = [across(height / 2), down(width / 2)];
        [down(columns.start), down(columns.end), across(rows.start), across(rows.end)]
    }

    /// Whether its lines end at each other.
    fn is_closed(&self) -> bool {
        self.0.iter().zip(self.spans()).all(|(line, span)| {
            let beyond = (BEYOND * line.is_there.len() as f64) as usize;
            let (before, after) = (span.start.saturating_sub(END), span.end + END);
            !span.is_empty()
                && line.there(span) > THERE
                && line.there(before.saturating_sub(beyond)..before) < GONE
                && line.there(after..after + beyond) < GONE
        })
    }

    fn area(&self) -> f64 {
        let [left, _, top, _] = self.spans().map(|span| span.len() as f64);
        left * top
    }

    /// What is within its lines.
    fn inside(&self, marks: &Bitmap) -> Neatline {
        let spans = self.spans();
        let inner = |side: usize| {
            let (line, span) = (self.0[side], spans[side].clone());
            let most = line.side.size(marks.width(), marks.height())[1] / 2 - 1;
            let thick = line.thickness(marks, span);
            line.inward.iter().map(move |inward| (inward + thick).min(most))
        };
        let pairs = |near: usize, far: usize, size: usize| -> Vec<[usize; 2]> {
            inner(near).zip(inner(far)).map(|(near, far)| [near, size - 1 - far]).collect()
        };
        let (columns, rows) = (pairs(0, 1, marks.width()), pairs(2, 3, marks.height()));
        let extent = |of: &[[usize; 2]], span: &Range<usize>| {
            let first = of[span.clone()].iter().map(|pair| pair[0]).min().unwrap_or(0);
            let past = of[span.clone()].iter().map(|pair| pair[1] + 1).max().unwrap_or(first);
            (first as u32, past as u32)
        };
        let (x, y) = (extent(&columns, &spans[0]), extent(&rows, &spans[2]));
        let mut grid = self.grid(marks, 0);
        grid.extend(self.grid(marks, 2));
        Neatline { columns, rows, low: UVec2::new(x.0, y.0), high: UVec2::new(x.1, y.1), grid }
    }

    /// The lines of a grid between one of its lines and the one across.
    fn grid(&self, marks: &Bitmap, side: usize) -> Vec<(Line, Range<usize>, usize)> {
        let (near, far, span) = (self.0[side], self.0[side + 1], self.spans()[side].clone());
        let [_, depth] = near.side.size(marks.width(), marks.height());
        let reach = (GRID_NEAR * depth as f64) as usize;
        let of_parts = |parts: usize| {
            let nth = |n: usize| {
                // Where it would be at each place along, if it divides the map evenly.
                let even = |along: usize| (near.inward[along] * (parts - n) + (depth - 1 - far.inward[along]) * n) / parts;
                let middle = even((span.start + span.end) / 2);
                let line = Strip::of(marks, near.side, middle.saturating_sub(reach)..(middle + reach).min(depth)).clearest();
                let there = span.clone().filter(|&along| line.is_there[along]);
                let mut astray: Vec<usize> = there.map(|along| line.inward[along] + depth - even(along)).collect();
                astray.sort_unstable();
                let spread = astray.get(astray.len() * 19 / 20).zip(astray.get(astray.len() / 20)).map(|(high, low)| high - low);
                let is_one = line.there(span.clone()) > GRID_THERE && spread.is_some_and(|spread| spread <= GRID_ASTRAY);
                is_one
                    .then(|| (line.thickness(marks, span.clone()).min(GRID_THICK), line))
                    .map(|(thick, line)| (line, span.clone(), thick))
            };
            (1..parts).map(nth).collect::<Option<Vec<_>>>()
        };
        (2..=MOST_PARTS).rev().find_map(of_parts).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 900;
    const HEIGHT: usize = 1100;
    const PAPER: [u8; 3] = [214, 200, 170];
    const INK: [u8; 3] = [60, 52, 48];
    /// Where the sheet's lines lie, two pixels thick.
    const SIDES: [f64; 4] = [80.0, 830.0, 110.0, 1020.0];

    /// How far a line of a sheet that lay crooked and was not flat is from its place.
    fn astray(along: f64) -> f64 {
        0.012 * (along - 500.0) + 3.0 * (along / 170.0).sin()
    }

    fn is_left(x: f64, y: f64) -> bool {
        (0.0..2.0).contains(&(x - SIDES[0] - astray(y)))
    }

    fn is_frame(x: f64, y: f64) -> bool {
        let (dx, dy) = (x - astray(y), y - astray(x));
        let [left, right, top, bottom] = [dx - SIDES[0], dx - SIDES[1], dy - SIDES[2], dy - SIDES[3]];
        let is_line = |d: f64| (0.0..2.0).contains(&d);
        is_line(left) || is_line(right) || is_line(top) || is_line(bottom) && [left, -right, top, -bottom].iter().all(|&d| d > -2.0)
    }

    /// A line of the frame, from corner to corner.
    fn is_line(x: f64, y: f64) -> bool {
        let (dx, dy) = (x - astray(y), y - astray(x));
        is_frame(x, y) && (SIDES[0]..SIDES[1] + 2.0).contains(&dx) && (SIDES[2]..SIDES[3] + 2.0).contains(&dy)
    }

    /// Lines that divide the map within the frame into so many parts across and down; with one part, all of it.
    fn is_grid(parts: [i32; 2], x: f64, y: f64) -> bool {
        let (u, v) = ((x - astray(y) - SIDES[0]) / (SIDES[1] - SIDES[0]), (y - astray(x) - SIDES[2]) / (SIDES[3] - SIDES[2]));
        let is_within = (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v);
        let is_on = |share: f64, parts: i32, size: f64| (share * f64::from(parts)).fract() * size / f64::from(parts) < 2.0;
        let is_one = u * (SIDES[1] - SIDES[0]) > 10.0 && is_on(u, parts[0], SIDES[1] - SIDES[0])
            || v * (SIDES[3] - SIDES[2]) > 10.0 && is_on(v, parts[1], SIDES[3] - SIDES[2]);
        is_within && (parts == [1, 1] || is_one)
    }

    /// The outlines of a town of blocks, up to the frame.
    fn is_town(x: f64, y: f64) -> bool {
        let is_inside = x > SIDES[0] + 12.0 && x < SIDES[1] - 8.0 && y > SIDES[2] + 12.0 && y < SIDES[3] - 8.0;
        let side = |v: f64| (v % 90.0, (16.0..18.0).contains(&(v % 90.0)) || (88.0..90.0).contains(&(v % 90.0)));
        let ((u, on_u), (v, on_v)) = (side(x), side(y));
        is_inside && (on_u && v >= 16.0 || on_v && u >= 16.0)
    }

    fn sheet(is_ink: impl Fn(f64, f64) -> bool) -> Picture {
        let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x as f64, y as f64)));
        let pixels = pixels.flat_map(|(x, y)| if is_ink(x, y) { INK } else { PAPER }).collect();
        Picture { width: WIDTH, height: HEIGHT, pixels }
    }

    fn neatline(picture: &Picture) -> Option<Neatline> {
        let legend = "(outlined: true, colours: [(colour: \"#D6C8AA\", class: Street), (colour: \"#3C3430\", class: Label)])";
        Neatline::of(picture, &Legend::parse(legend, "sheet.legend.ron").unwrap_or_else(|e| panic!("{e}")))
    }

    /// Whether its lines are where they were drawn, and nothing of them is left.
    fn is_true(found: &Neatline) -> bool {
        let rows = SIDES[2] as usize + 20..SIDES[3] as usize - 20;
        let columns = SIDES[0] as usize + 20..SIDES[1] as usize - 20;
        let near = |found: usize, drawn: f64| (-1.0..4.0).contains(&(found as f64 - drawn));
        let far = |found: usize, drawn: f64| (-4.0..1.0).contains(&(found as f64 - drawn));
        let is_at = |line: &[[usize; 2]], range: core::ops::Range<usize>, sides: [f64; 2]| {
            range.into_iter().all(|at| {
                let aside = astray(at as f64);
                near(line[at][0], sides[0] + 2.0 + aside) && far(line[at][1], sides[1] - 1.0 + aside)
            })
        };
        is_at(&found.columns, rows, [SIDES[0], SIDES[1]]) && is_at(&found.rows, columns, [SIDES[2], SIDES[3]])
    }

    #[test]
    fn lines_are_followed_where_they_wander() {
        let found = neatline(&sheet(|x, y| is_line(x, y) || is_town(x, y))).unwrap_or_else(|| panic!("none"));
        assert!(is_true(&found), "{:?}", found.extent());
        // Nothing of the lines is left inside.
        let inside = found.cropped(&sheet(is_line));
        let ink = inside.pixels.chunks(3).filter(|colour| **colour == INK).count();
        assert!(ink < 20, "{ink} pixels of the frame are left");
    }

    #[test]
    fn the_innermost_frame_ends_the_map_and_its_grid_does_not() {
        let outer = |x: f64, y: f64| {
            let is_line = |d: f64| (0.0..5.0).contains(&d);
            let within = (30.0..875.0).contains(&x) && (35.0..1075.0).contains(&y);
            within && (is_line(x - 30.0) || is_line(x - 870.0) || is_line(y - 35.0) || is_line(y - 1070.0))
        };
        let title = |x: f64, y: f64| (60.0..85.0).contains(&y) && (300.0..600.0).contains(&x) && x % 12.0 < 5.0;
        let drawn = |x: f64, y: f64| outer(x, y) || title(x, y) || is_line(x, y) || is_town(x, y);
        let found = neatline(&sheet(|x, y| drawn(x, y) || is_grid([4, 4], x, y)));
        assert!(found.as_ref().is_some_and(|found| is_true(found) && found.grid.len() == 6), "{:?}", found.map(|f| f.grid.len()));
        let uneven = |x: f64, y: f64| is_grid([4, 4], x + 23.0, y + 23.0) && is_grid([1, 1], x, y);
        let found = neatline(&sheet(|x, y| drawn(x, y) || uneven(x, y)));
        assert!(found.as_ref().is_some_and(|found| is_true(found) && found.grid.is_empty()), "{:?}", found.map(|f| f.grid.len()));
    }

    #[test]
    fn a_grid_is_taken_out_and_what_it_crosses_is_not() {
        // Slanting lines.
        let slant = |x: f64, y: f64| is_grid([1, 1], x, y) && (x + 0.7 * y) % 130.0 < 3.0;
        let ink = |picture: &Picture| picture.pixels.chunks(3).filter(|colour| **colour == INK).count() as f64;
        let [with, without] = [true, false].map(|has_grid| {
            let picture = sheet(|x, y| is_line(x, y) || slant(x, y) || has_grid && is_grid([4, 3], x, y));
            let found = neatline(&picture).unwrap_or_else(|| panic!("none"));
            assert_eq!(found.grid.len(), if has_grid { 5 } else { 0 });
            ink(&found.map_of(&picture))
        });
        assert!((with / without - 1.0).abs() < 0.01, "{with} {without}");
    }

    #[test]
    fn a_torn_line_is_one_and_three_sides_are_none() {
        let torn = |x: f64, y: f64| is_line(x, y) && (x + y) % 100.0 > 12.0;
        let found = neatline(&sheet(|x, y| torn(x, y) || is_town(x, y)));
        assert!(found.as_ref().is_some_and(is_true), "{:?}", found.map(|found| found.extent()));
        let open = |x: f64, y: f64| is_line(x, y) && (!is_left(x, y) || y < SIDES[2] + 30.0);
        assert_eq!(neatline(&sheet(|x, y| open(x, y) || is_town(x, y))), None);
    }

    #[test]
    fn a_town_is_no_frame() {
        assert_eq!(neatline(&sheet(is_town)), None, "blocks in rows");
        assert_eq!(neatline(&sheet(|_, _| false)), None, "blank paper");
        // A frame, but the map goes on beyond it.
        assert_eq!(neatline(&sheet(|x, y| is_line(x, y) || is_town(x % 700.0 + 90.0, y % 700.0 + 120.0))), None, "full bleed");
    }

    #[test]
    fn what_was_cropped_goes_back_to_its_place() {
        let picture = sheet(|x, y| is_line(x, y) || is_town(x, y));
        let found = neatline(&picture).unwrap_or_else(|| panic!("none"));
        let inside = found.cropped(&picture);
        let [low, high] = found.extent();
        assert_eq!(UVec2::new(inside.width as u32, inside.height as u32), high - low);
        let whole = found.pasted(&inside);
        assert_eq!((whole.width, whole.height), (WIDTH, HEIGHT));
        assert_eq!((whole.at(450, 600), whole.at(300, 178)), (picture.at(450, 600), picture.at(300, 178)));
        assert_eq!(whole.at(20, 20), Some([0; 3]), "outside is black");
        assert_eq!(found.corner(), DVec2::new(f64::from(low.x), (HEIGHT - high.y as usize) as f64));
    }
}
