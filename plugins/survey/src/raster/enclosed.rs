//! Streets of a map that only outlines its blocks: streets and blocks are both bare paper, and lines part them.
//!
//! ```text
//!  ink ──► lines (dots and letters left out) ──► paper between them ──► wide parts: blocks, also those that lie open a little
//!                                                                  ├──► wide parts that streets lead on from: squares, parks
//!                                                                  └──► long parts: the network, and pieces of it ──┐
//!  streets ◄── what lines, names and rails cover is filled from around, but hatching is a block's ◄─────────────────┘
//! ```
//! Blocks are closed shapes, the streets around them one part of the paper that leads everywhere. A part is measured by how
//! much is left of it at growing depths: a strip has lost half of its area halfway to its middle, and keeps the length of its
//! border until there; a block loses most of its area, and its border bit by bit, long before. The idea of closed shapes is
//! that of Chen, Carlinet, Chazalon and others, *Vectorization of Historical Maps Using Deep Edge Filtering and Closed Shape
//! Extraction* (ICDAR 2021); here no net is trained, and which of them are streets is told.

use super::bitmap::Bitmap;
use super::classify::Classes;
use super::filter::filled;
use super::morphology::Sweep::{Grow, Shrink};
use super::morphology::{grown, shrunk, swept};
use super::outline::Corners;
use super::parts::{Part, Parts};
use super::sight::seen_as_street;

/// Strokes that reach less far than this are dots, letters and symbols; halves of a street's width.
const MARK: f64 = 4.0;
/// How often these are looked for.
const ROUNDS: usize = 3;
/// Gaps in outlines are closed that are as wide as twice this share of half a street's width …
const GAP: f64 = 0.25;
/// … and where a wide part opens to a street by less than twice these shares, it is a block that lies open.
const MOUTHS: [f64; 3] = [0.35, 0.6, 0.85];
/// It covers more than so many squares of a street's width; crossroads and squares do not.
const BLOCK: f64 = 12.0;
/// What is in doubt is hatching if it is wider than twice this share.
const THICK: f64 = 0.6;
/// Streets are at most so many times as wide as most are …
const WIDE: f64 = 1.6;
/// … and pieces of them at least so many.
const NARROW: f64 = 0.35;
/// A wide part that streets of so many times half a street's width lead on from is no block: …
const LEADS_ON: f64 = 60.0;
/// … a place is so many times as wide as streets, …
const SQUARE: f64 = 3.0;
/// … and it is open grounds, not a square, if it is so many times as wide.
const GROUNDS: f64 = 8.0;
/// A part so many times as long as half its width is a piece of street if it touches one, …
const LONG: f64 = 15.0;
/// … and one half that long if most of it lies along one: a lane between rails or rows of trees.
const STRIP: f64 = 8.0;
const ALONG: f64 = 0.6;
/// A part so long is streets wherever it is.
const FAR: f64 = 30.0;
/// More than this share of the picture's border is along the margin of a sheet, not along streets that it cuts.
const BORDER: f64 = 0.5;
/// The paper between rails is at least so wide, and so long; halves of a street's width.
const SLIT: f64 = 0.15;
const RAIL: f64 = 8.0;
/// What has more streets than this around it is no hatching.
const AROUND: f64 = 0.5;
/// Strokes that cover more than so many squares of a street's width are hatching, and that is of buildings.
const HATCHING: f64 = 8.0;

/// Makes streets of the paper that outlines do not enclose, squares and parks of what is wide of it, and nothing of outlines,
/// letters and all else that is drawn in ink. If nothing leads anywhere, nothing is street.
pub(super) fn tell_streets(classes: &mut Classes) {
    let (width, height) = (classes.street.width(), classes.street.height());
    classes.street = Bitmap::new(width, height);
    let mut ink = core::mem::replace(&mut classes.ink, Bitmap::new(width, height));
    let Some(half) = without_marks(&mut ink) else { return };
    // What is neither ink nor paper has a class of its own, and parts streets as ink does.
    [&classes.park, &classes.water, &classes.railway, &classes.house].into_iter().for_each(|other| ink.add(other));
    let mut closed = ink.inverted();
    let mut blocks = taken_blocks(&mut closed, half);
    let cut = rounded(GAP * half).max(1);
    let [squares, grounds] = open_places(&closed, cut, half);
    let mut places = squares.clone();
    places.add(&grounds);
    closed.remove(&places);
    let shapes = Shapes::of(&closed, cut);
    let Some(network) = shapes.streets() else { return };
    let core = with_pieces(&shapes, network, cut, &places);
    let mut streets = reached(&core, cut, &closed);
    blocks.add(&reached(&shapes.core.without(&core), cut, &closed));
    closed.remove(&streets);
    closed.remove(&blocks);
    streets.add(&squares);
    blocks.add(&grounds);
    classes.square.add(&squares);
    classes.park.add(&grounds);
    // Between rails it is as narrow as between the strokes of hatching, but long.
    let is_railed =
        |shape: Shape| shape.half > SLIT * half && shape.slenderness() > FAR && shape.area > 2.0 * RAIL * half * shape.half;
    streets.add(&Shapes::of(&closed, 0).painted(is_railed));
    let mut doubt = streets.neither(&blocks);
    doubt.remove(&hatching(&doubt, [&streets, &blocks], cut, half));
    // A name may fill a street from side to side; lines are too thin for names.
    let mut names = swept(&doubt, &[Shrink(cut.max(2)), Grow(cut.max(2) + 1)]);
    names.keep(&doubt);
    let mut known = seen_as_street(&streets, &names);
    known.add(&streets);
    doubt.remove(&known);
    classes.street = filled(&known, &doubt);
}

/// Takes dots, letters and symbols out of the ink, and tells half of a street's width, if there are streets.
fn without_marks(ink: &mut Bitmap) -> Option<f64> {
    // Letters hide how wide streets are, and that tells letters from lines: by and by.
    let mut half = 0.0;
    for _ in 0..ROUNDS {
        half = Shapes::of(&ink.inverted(), 1).streets()?.half;
        let marks = Parts::of(ink, Corners::Join).only(|part| f64::from((part.high - part.low).max_element()) < MARK * half);
        for run in marks.runs {
            ink.set_between(run.y as usize, run.from as usize, run.to as usize, false);
        }
    }
    Some(half)
}

/// Takes what is wide out of what is closed: blocks, also those that open to streets a little.
fn taken_blocks(closed: &mut Bitmap, half: f64) -> Bitmap {
    let mut blocks = Bitmap::new(closed.width(), closed.height());
    for mouth in MOUTHS.map(|share| rounded(share * half).max(1)) {
        let shapes = Shapes::of(closed, mouth);
        let is_block = |shape: Shape| {
            let wide = shape.half / (WIDE * half);
            wide > 1.0
                && shape.slenderness() < LONG * wide * wide
                && shape.area > BLOCK * (2.0 * half).powi(2)
                && !leads_on(&shapes.painted(|other| other.part == shape.part), half)
        };
        blocks.add(&reached(&shapes.painted(is_block), mouth, closed));
        closed.remove(&blocks);
    }
    blocks
}

/// Of what is in doubt, what is drawn over closely: that is a block; but not between two lanes of one street.
fn hatching(doubt: &Bitmap, told: [&Bitmap; 2], cut: usize, half: f64) -> Bitmap {
    let thick = rounded(THICK * half);
    let thick = Parts::of(&swept(doubt, &[Shrink(thick), Grow(thick)]), Corners::Join);
    let hatched = thick.only(|part| part.area_px as f64 > HATCHING * (2.0 * half).powi(2));
    let touched = hatched.touched(told, cut + 2);
    let mut hatching = Bitmap::new(doubt.width(), doubt.height());
    for run in hatched.runs {
        let [street, block] = touched[run.part as usize];
        if street as f64 <= AROUND * (street + block) as f64 {
            hatching.set_between(run.y as usize, run.from as usize, run.to as usize, true);
        }
    }
    hatching
}

/// What is so near to what was so far inside.
fn reached(core: &Bitmap, reach: usize, within: &Bitmap) -> Bitmap {
    let mut reached = grown(core, reach);
    reached.keep(within);
    reached
}

/// What is much wider than a street.
fn wide_part(of: &Bitmap, half: f64) -> Bitmap {
    let reach = rounded(WIDE * half);
    let mut wide = swept(of, &[Shrink(reach), Grow(reach)]);
    wide.keep(of);
    wide
}

/// Whether streets lead from a part that is wider than they are.
fn leads_on(part: &Bitmap, half: f64) -> bool {
    let strips = part.without(&wide_part(part, half)).count();
    strips as f64 > LEADS_ON * 2.0 * half * half
}

/// What is wide of the streets' network: squares, and the grounds that lie open to streets, gardens and promenades.
fn open_places(closed: &Bitmap, cut: usize, half: f64) -> [Bitmap; 2] {
    let shapes = Shapes::of(closed, cut);
    let network = shapes.streets().map(|network| network.part);
    let is_open = |shape: Shape| {
        let is_large = shape.area > BLOCK * (2.0 * half).powi(2);
        Some(shape.part) == network || is_large && leads_on(&shapes.painted(|other| other.part == shape.part), half)
    };
    let wide = Shapes::of(&wide_part(&shapes.painted(is_open), half), 0);
    let is_place = |shape: &Shape| shape.half > SQUARE * half && shape.slenderness() < LONG * shape.half / (WIDE * half);
    [false, true].map(|is_large| {
        let places = wide.painted(|shape| is_place(&shape) && (shape.half > GROUNDS * half) == is_large);
        reached(&places, cut, closed)
    })
}

/// The network, and the parts that are pieces of it, parted from it by rails, rows of trees, letters or folds of the sheet.
fn with_pieces(shapes: &Shapes, network: Shape, cut: usize, places: &Bitmap) -> Bitmap {
    let is_piece = |shape: &Shape| {
        let is_wide = shape.half > WIDE * network.half && shape.slenderness() < FAR;
        !is_wide
            && shape.half > NARROW * network.half
            && shape.area > 2.0 * network.half * network.half
            && shape.slenderness() > STRIP
    };
    let others = (0..shapes.parts.parts.len()).filter(|&i| i != network.part && !shapes.is_margin(i));
    let mut pieces: Vec<Shape> = others.map(|i| shapes.shape(i)).filter(is_piece).collect();
    let mut streets = shapes.painted(|shape| shape.part == network.part);
    loop {
        let mut beside = grown(&streets, 2 * cut + rounded(network.half));
        beside.add(&grown(places, 2 * cut + rounded(network.half)));
        let before = pieces.len();
        pieces.retain(|piece| {
            let of_piece = shapes.parts.runs.iter().filter(|run| run.part as usize == piece.part);
            let near = of_piece.map(|run| beside.count_between(run.y as usize, run.from as usize, run.to as usize));
            let near = near.sum::<usize>() as f64;
            let least = if near > ALONG * piece.area {
                STRIP
            } else if near > 0.0 {
                LONG
            } else {
                FAR
            };
            let is_street = piece.slenderness() > least;
            if is_street {
                streets.add(&shapes.painted(|shape| shape.part == piece.part));
            }
            !is_street
        });
        if pieces.len() == before {
            return streets;
        }
    }
}

/// The parts of what is open, with gaps closed, and how much is left of each at growing depths.
struct Shapes {
    /// What is more than so many pixels inside.
    core: Bitmap,
    cut: usize,
    parts: Parts,
    /// For each depth, pixels of each part.
    left: Vec<Vec<u32>>,
}

/// A part's measures, pixels.
#[derive(Debug, Clone, Copy)]
struct Shape {
    part: usize,
    area: f64,
    /// Half its width; of a block, somewhat more than half of the way to its middle.
    half: f64,
}

impl Shape {
    /// Its length in halves of its width; 6 of a square.
    fn slenderness(&self) -> f64 {
        self.area / (2.0 * self.half * self.half)
    }
}

/// Depths at which shapes are measured, pixels: each about a sixth more than the one before.
const DEPTHS: [usize; 24] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 19, 22, 26, 30, 35, 41, 48, 56, 66, 77, 90];

impl Shapes {
    fn of(open: &Bitmap, cut: usize) -> Self {
        let core = shrunk(open, cut);
        let parts = Parts::of(&core, Corners::Part);
        let mut left = Vec::new();
        for depth in DEPTHS {
            let layer = shrunk(&core, depth);
            let mut pixels = vec![0; parts.parts.len()];
            for run in &parts.runs {
                pixels[run.part as usize] += layer.count_between(run.y as usize, run.from as usize, run.to as usize) as u32;
            }
            left.push(pixels);
        }
        Self { core, cut, parts, left }
    }

    fn shape(&self, part: usize) -> Shape {
        let left = |i: usize| f64::from(self.left[i][part]);
        // A strip has lost half of its area halfway to its middle.
        Shape { part, area: left(0), half: self.cut as f64 + 2.0 * depth_at(left(0) / 2.0, left) }
    }

    /// The streets' network: the part that leads farthest for its width, of all that cover some of the map; and half of the
    /// width of most streets.
    fn streets(&self) -> Option<Shape> {
        let shapes = (0..self.parts.parts.len()).filter(|&i| !self.is_margin(i)).map(|i| self.shape(i));
        let best = shapes.max_by(|a, b| (a.area * a.slenderness()).total_cmp(&(b.area * b.slenderness())))?;
        // Blocks that lie open have little of the border.
        let left = |i: usize| f64::from(self.left[i][best.part]);
        let border = |i: usize| (left(i) - left(i + 1)) / (DEPTHS[i + 1] - DEPTHS[i]) as f64;
        let half = self.cut as f64 + depth_at(border(0) / 2.0, |i| if i + 1 < DEPTHS.len() { border(i) } else { 0.0 });
        (best.slenderness() > LONG).then_some(Shape { half, ..best })
    }

    /// Whether a part goes around the picture: the margin of a sheet.
    fn is_margin(&self, part: usize) -> bool {
        let (width, height) = (self.core.width() as i32, self.core.height() as i32);
        let Part { low, high, .. } = self.parts.parts[part];
        if low.x > 0 && low.y > 0 && high.x < width && high.y < height {
            return false;
        }
        let of_part = self.parts.runs.iter().filter(|run| run.part as usize == part);
        let on_border = of_part.map(|run| match run.y {
            y if y == 0 || y == height - 1 => run.to - run.from,
            _ => i32::from(run.from == 0) + i32::from(run.to == width),
        });
        f64::from(on_border.sum::<i32>()) > BORDER * f64::from(2 * (width + height))
    }

    /// The pixels of some parts.
    fn painted(&self, is_wanted: impl Fn(Shape) -> bool) -> Bitmap {
        let wanted: Vec<bool> = (0..self.parts.parts.len()).map(|i| is_wanted(self.shape(i))).collect();
        let mut painted = Bitmap::new(self.core.width(), self.core.height());
        for run in self.parts.runs.iter().filter(|run| wanted[run.part as usize]) {
            painted.set_between(run.y as usize, run.from as usize, run.to as usize, true);
        }
        painted
    }
}

/// The depth at which what is measured at each of them falls to a value.
fn depth_at(value: f64, measured: impl Fn(usize) -> f64) -> f64 {
    let Some(after) = (1..DEPTHS.len()).find(|&i| measured(i) <= value) else { return DEPTHS[DEPTHS.len() - 1] as f64 };
    let [a, b] = [DEPTHS[after - 1], DEPTHS[after]].map(|depth| depth as f64);
    let (from, to) = (measured(after - 1), measured(after));
    a + (b - a) * ((from - value) / (from - to).max(1e-9)).clamp(0.0, 1.0)
}

fn rounded(pixels: f64) -> usize {
    (pixels + 0.5) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::classify::classified;
    use crate::raster::{Picture, PictureLimits, guess_legend};

    const SIDE: usize = 640;
    const STREET: usize = 20;
    const PITCH: usize = STREET + 100;
    /// Where the picture's corner lies in the town: in the middle of a block.
    const CORNER: usize = 70;

    /// A town of square blocks, with an alley into one of them.
    fn is_street(x: usize, y: usize) -> bool {
        x % PITCH < STREET || y % PITCH < STREET || (290..300).contains(&x) && (260..300).contains(&y)
    }

    /// The outlines of its blocks, two pixels wide and within them.
    fn is_line(x: usize, y: usize) -> bool {
        let beside = |dx: usize, dy: usize| is_street((x + dx).saturating_sub(2), (y + dy).saturating_sub(2));
        !is_street(x, y) && (0..5).any(|dx| (0..5).any(|dy| beside(dx, dy)))
    }

    fn told(is_ink: impl FnMut(usize, usize) -> bool) -> Bitmap {
        told_apart(is_ink).street
    }

    fn told_apart(mut is_ink: impl FnMut(usize, usize) -> bool) -> Classes {
        let ink = Bitmap::from_fn(SIDE, SIDE, |x, y| is_ink(x + CORNER, y + CORNER));
        let blank = Bitmap::new(SIDE, SIDE);
        let [park, water, railway, house, square] = [(); 5].map(|()| blank.clone());
        let mut classes = Classes { street: ink.inverted(), park, water, railway, ink, house, square };
        tell_streets(&mut classes);
        assert!(classes.ink.is_blank(), "nothing is left in doubt");
        classes
    }

    /// Share of the pixels that are told wrongly, of those that are not of a line or beside one.
    fn wrong(street: &Bitmap) -> f64 {
        let clear =
            |x: usize, y: usize| (0..7).all(|d| !is_line((x + d).saturating_sub(3), y) && !is_line(x, (y + d).saturating_sub(3)));
        let all = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x + CORNER, y + CORNER)));
        let (mut wrong, mut count) = (0, 0);
        for (x, y) in all.filter(|&(x, y)| clear(x, y)) {
            count += 1;
            wrong += usize::from(street.get((x - CORNER) as isize, (y - CORNER) as isize) != is_street(x, y));
        }
        f64::from(wrong as u32) / f64::from(count)
    }

    #[test]
    fn what_lines_enclose_is_no_street() {
        assert!(wrong(&told(is_line)) < 0.001);
    }

    #[test]
    fn what_lies_open_to_streets_is_a_square_or_a_park() {
        // So many blocks each way have no outlines: their ground is that wide, with the streets around it.
        for (blocks, is_square, is_park) in [(0, false, false), (2, true, false), (3, false, true)] {
            let is_open = |v: usize| (PITCH..PITCH + blocks * PITCH + STREET).contains(&v);
            let classes = told_apart(|x, y| is_line(x, y) && !(is_open(x) && is_open(y)));
            let middle = ((PITCH + blocks * PITCH / 2 + STREET / 2) - CORNER) as isize;
            let is_in = |class: &Bitmap| blocks > 0 && class.get(middle, middle);
            assert_eq!((is_in(&classes.square), is_in(&classes.park)), (is_square, is_park), "{blocks}");
            assert_eq!((classes.square.is_blank(), classes.park.is_blank()), (!is_square, !is_park), "{blocks}");
            assert_eq!(is_in(&classes.street), is_square, "{blocks}: squares are streets, parks are not");
            assert!(classes.street.get((5 * PITCH + 10 - CORNER) as isize, 300), "{blocks}: a street beside it");
        }
    }

    #[test]
    fn broken_outlines_enclose_all_the_same() {
        // A gap into every other block: a crack, and one of half a street's width.
        for gap in [4, 10] {
            let street = told(|x, y| is_line(x, y) && !(x % 240 < 24 && (60..60 + gap).contains(&(y % 120))));
            let wrong = wrong(&street);
            assert!(wrong < 0.01, "{gap}: {wrong}");
        }
    }

    #[test]
    fn folds_rails_letters_and_hatching_change_nothing() {
        let fold = |_: usize, y: usize| y.abs_diff(310) < 1;
        // Two rails along a street.
        let rails = |x: usize, _: usize| [247, 252].contains(&x);
        // Bars from side to side of a street, and others within a block.
        let name = |x: usize, y: usize| {
            (363..377).contains(&y) && (420..460).contains(&x) && x % 4 < 2
                || (410..422).contains(&y) && (400..450).contains(&x) && x % 4 < 2
        };
        let hatching = |x: usize, y: usize| (20..120).contains(&x) && (20..80).contains(&y) && (x + y) % 4 < 2;
        for (what, mark) in
            [("fold", &fold as &dyn Fn(usize, usize) -> bool), ("rails", &rails), ("name", &name), ("hatching", &hatching)]
        {
            let wrong = wrong(&told(|x, y| is_line(x, y) || mark(x, y)));
            assert!(wrong < 0.005, "{what}: {wrong}");
        }
    }

    #[test]
    fn the_margin_of_a_sheet_is_no_street() {
        // A frame 18 pixels from the border.
        let frame = |x: usize| (CORNER + 18..CORNER + SIDE - 18).contains(&x);
        let is_frame = |x: usize, y: usize| frame(x) && frame(y) && !(frame(x - 1) && frame(x + 1) && frame(y - 1) && frame(y + 1));
        let street = told(|x, y| is_frame(x, y) || frame(x) && frame(y) && is_line(x, y));
        assert!(!street.get(9, 320) && !street.get(320, 9) && !street.get(631, 320));
        let crossing = (2 * PITCH + STREET / 2 - CORNER) as isize;
        assert!(street.get(crossing, crossing) && street.get(crossing, crossing + PITCH as isize / 2));
    }

    /// Scans, and what a person drew over them: of what is told to be street on the scan, the share that is enclosed by the
    /// same shapes as drawn, and the reverse. (Hatched wings of houses are closed shapes as drawn, and look like lanes there.)
    #[test]
    fn scans_are_told_as_a_person_drew_them() {
        let Some(data) = crate::testing::data() else { return };
        for name in ["paris_1925_saint_germain", "paris_1925_invalides"] {
            let read = |file: String| {
                let bytes = std::fs::read(data.join("raster_paris_1925").join(&file)).unwrap_or_else(|e| panic!("{file}: {e}"));
                let picture = Picture::decode(&bytes, &file, &PictureLimits::default()).unwrap_or_else(|e| panic!("{e}"));
                let (legend, _) = guess_legend(&picture, None);
                assert!(legend.is_outlined, "{file}");
                let mut classes = classified(&picture, &legend);
                tell_streets(&mut classes);
                classes.street
            };
            let [scanned, drawn] = [read(format!("{name}.jpg")), read(format!("{name}_edges.png"))];
            let mut both = scanned.clone();
            both.keep(&drawn);
            let [precision, recall] = [&scanned, &drawn].map(|of| both.count() as f64 / of.count() as f64);
            assert!(precision > 0.75 && recall > 0.55, "{name}: {precision:.3} {recall:.3}");
        }
    }

    #[test]
    fn without_a_network_nothing_is_street() {
        assert!(told(|_, _| false).is_blank());
        assert!(told(|_, _| true).is_blank());
        assert!(told(|x, _| x == 300).is_blank());
    }
}
