//! Squares: open space that the streets around it do not account for.
//!
//! ```text
//!  nodes with much room ─► region: what a disc of nearly that room can reach (morphological opening, in a window)
//!                       ─► how much of it would the streets that enter it cover, if they went on to its middle?
//!                          most ─► a crossroads of wide streets        little ─► a square
//! ```
//!
//! The papers go the other way, from loops of short streets to their hull. A region of the picture itself keeps its
//! shape: an L stays an L. What the map prints in a colour of squares is a square as it is printed.

use std::collections::BTreeMap;

use glam::{DVec2, IVec2};

use super::bitmap::Bitmap;
use super::classify::Classes;
use super::clean::{Labels, SPECK_M2};
use super::morphology::{band, grown, shrunk};
use super::outline::{Corners, Outline, outlines};
use super::parts::Parts;
use super::sketch::{Sketch, SketchNode, SketchStreet, length};

/// Least and greatest radius of the largest disc in a square, metres.
const RADIUS_M: core::ops::Range<f64> = 8.0..150.0;
/// Rooms of a larger radius are not looked at, pixels: at scales where a square is so large, letters are as wide as streets.
const MOST_RADIUS_PX: f64 = 160.0;
/// The disc whose reach is a square's region, in radii of the largest.
const REGION_RADII: f64 = 0.72;
/// How far into its corners it goes, in that disc's radii.
const CORNER_SHARE: f64 = 0.45;
/// How far a square goes from the middle of its largest disc, in its radii.
const MOST_REACH_RADII: f64 = 6.0;
/// Least area of a square, in areas covered by the streets that enter it.
const LEAST_SURPLUS: f64 = 1.2;

/// Half the width of edges in which the colour of squares is none, pixels.
const EDGE_PX: usize = 2;

/// A square as found.
#[derive(Debug, Clone)]
pub(crate) struct FoundSquare {
    /// Its outline in pixels, y down, clockwise as seen.
    pub outline: Vec<DVec2>,
}

/// What is printed in the colour of squares, as whole regions with a margin; nothing where there is none.
pub(crate) fn printed_squares(classes: &Classes, labels: &Labels<'_>, paved: &Bitmap, margin: usize, mpp: f64) -> Option<Bitmap> {
    if classes.square.is_blank() {
        return None;
    }
    let mut printed = labels.cleaned(&classes.square).with_margin(margin);
    printed.keep(paved);
    // Where streets' colour meets that of blocks, theirs may lie between.
    let mut regions = grown(&shrunk(&printed, EDGE_PX), EDGE_PX);
    regions.keep(&printed);
    let least = (2.0 * SPECK_M2 / (mpp * mpp)) as i64;
    for run in Parts::of(&regions.clone(), Corners::Part).smaller_than(least) {
        regions.set_between(run.y as usize, run.from as usize, run.to as usize, false);
    }
    (!regions.is_blank()).then_some(regions)
}

/// Finds squares, cuts the streets at their borders, and gives their outlines. What is `printed` as squares is taken as it is.
pub(crate) fn squares(sketch: &mut Sketch, paved: &Bitmap, printed: Option<&Bitmap>, margin: i32, mpp: f64) -> Vec<FoundSquare> {
    let mut taken = Bitmap::new(paved.width(), paved.height());
    let mut found = Vec::new();
    if let Some(printed) = printed {
        for border in outlines(printed, Corners::Part).into_iter().filter(|o| !o.is_hole()) {
            let region = Region::printed(printed, &border);
            region.add_to(&mut taken);
            let size = IVec2::new(paved.width() as i32, paved.height() as i32);
            let on_map = |p: DVec2| p.clamp(DVec2::splat(f64::from(margin)), (size - margin).as_dvec2());
            found.push((FoundSquare { outline: region.outline().into_iter().map(on_map).collect() }, region));
        }
    }
    let ends = Ends::of(sketch);
    let mut examined: Vec<(DVec2, f64)> = Vec::new();
    for (at, radius) in candidates(sketch, mpp) {
        // The roomiest place of an open space speaks for it.
        let is_known = examined.iter().any(|(other, room)| other.distance(at) < 0.6 * room && radius > 0.6 * room);
        if is_known || taken.get(at.x as isize, at.y as isize) {
            continue;
        }
        examined.push((at, radius));
        let Some(region) = Region::around(sketch, &ends, paved, at, radius, margin) else { continue };
        if printed.is_some() && region.overlaps(&taken) {
            continue;
        }
        if region.is_square(sketch, radius) {
            region.add_to(&mut taken);
            found.push((FoundSquare { outline: region.outline() }, region));
        }
    }
    if !found.is_empty() {
        cut(sketch, &taken, &found, mpp);
    }
    found.into_iter().map(|(square, _)| square).collect()
}

/// Nodes with more room about them than the streets that meet there need, the roomiest first.
fn candidates(sketch: &Sketch, mpp: f64) -> Vec<(DVec2, f64)> {
    let at = sketch.ends();
    let mut result: Vec<(DVec2, f64)> = Vec::new();
    for (node, ends) in sketch.nodes.iter().zip(&at) {
        if !RADIUS_M.contains(&(node.radius * mpp)) || node.radius > MOST_RADIUS_PX {
            continue;
        }
        let narrow: Vec<f64> = ends.iter().map(|&(i, _)| sketch.streets[i].half).filter(|h| *h < 0.85 * node.radius).collect();
        let widest = narrow.iter().copied().fold(0.0, f64::max);
        if narrow.len() < ends.len() || node.radius > 1.2 * widest {
            result.push((node.pos, node.radius));
        }
    }
    result.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.x.total_cmp(&b.0.x)).then(a.0.y.total_cmp(&b.0.y)));
    result
}

/// Where streets end, found by place.
struct Ends {
    by_cell: BTreeMap<(i32, i32), Vec<(usize, DVec2)>>,
}

impl Ends {
    /// Size of a cell, pixels.
    const CELL: f64 = 128.0;

    fn of(sketch: &Sketch) -> Self {
        let mut by_cell: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for (i, street) in sketch.streets.iter().enumerate() {
            for end in street.ends {
                let pos = sketch.nodes[end].pos;
                by_cell.entry(Self::cell(pos)).or_default().push((i, pos));
            }
        }
        Self { by_cell }
    }

    fn cell(p: DVec2) -> (i32, i32) {
        ((p.x / Self::CELL).floor() as i32, (p.y / Self::CELL).floor() as i32)
    }

    /// The streets with an end within `reach` of a place on both axes, in order.
    fn within(&self, at: DVec2, reach: f64) -> Vec<usize> {
        let (low, high) = (Self::cell(at - reach), Self::cell(at + reach));
        let cells = (low.0..=high.0).flat_map(|x| (low.1..=high.1).map(move |y| (x, y)));
        let ends = cells.filter_map(|cell| self.by_cell.get(&cell)).flatten();
        let mut near: Vec<usize> = ends.filter(|(_, p)| (*p - at).abs().max_element() < reach).map(|(i, _)| *i).collect();
        near.sort_unstable();
        near.dedup();
        near
    }
}

/// A part of the picture about a candidate, and what of it a disc can reach.
struct Region {
    /// Upper left corner of its window.
    origin: IVec2,
    /// The region.
    area: Bitmap,
    border: Outline,
    /// Streets that end near it.
    near: Vec<usize>,
}

impl Region {
    /// A region in the colour of squares.
    fn printed(printed: &Bitmap, border: &Outline) -> Self {
        let (low, high) = border.extent();
        let size = (high - low).as_uvec2();
        let mut area = Bitmap::new(size.x as usize, size.y as usize);
        let border = border.moved(-low);
        border.paint(&mut area, true);
        area.keep(&Bitmap::from_window(printed, low, area.width(), area.height()));
        Self { origin: low, area, border, near: Vec::new() }
    }

    /// Whether more than a third of it is among some pixels.
    fn overlaps(&self, pixels: &Bitmap) -> bool {
        let mut shared = self.area.clone();
        shared.keep(&Bitmap::from_window(pixels, self.origin, shared.width(), shared.height()));
        3 * shared.count() > self.area.count()
    }

    fn around(sketch: &Sketch, ends: &Ends, paved: &Bitmap, at: DVec2, radius: f64, margin: i32) -> Option<Self> {
        let steps = (REGION_RADII * radius) as usize;
        let middle = IVec2::new(at.x as i32, at.y as i32);
        let reach = (MOST_REACH_RADII * radius) as i32 + 8;
        let (seed, origin) = seed(paved, at, steps, reach)?;
        let reached = grown(&seed, steps);
        // A disc does not reach into corners: what is paved there belongs to it, but for the streets that lead away.
        let mut area = grown(&reached, corner_steps(steps));
        let (width, height) = (area.width(), area.height());
        area.keep(&Bitmap::from_window(paved, origin, width, height));
        let mut away = Bitmap::new(width, height);
        let inside = |p: DVec2| reached.get_at(p);
        let near = ends.within(at, f64::from(reach));
        let (low, high) = (origin.as_dvec2(), (origin + IVec2::new(width as i32, height as i32)).as_dvec2());
        for street in near.iter().map(|&i| &sketch.streets[i]) {
            let half = street.half + 1.5;
            let is_near = |p: DVec2| p.cmpgt(low - half).all() && p.cmplt(high + half).all();
            for stretch in street.line.windows(4).step_by(3).filter(|w| is_near(w[0]) || is_near(w[3])) {
                let (a, b) = (stretch[0] - low, stretch[3] - low);
                if !inside(a) && !inside(b) {
                    band(&mut away, a, b, half);
                }
            }
        }
        away.remove(&reached);
        area.remove(&away);
        let border = outlines(&area, Corners::Part).into_iter().max_by_key(|o| o.area_px)?;
        // What goes on is no place, and what is cut by the map's border is not known.
        let (low, high) = border.extent();
        let (low, high) = (low + origin, high + origin);
        let is_inside = low.cmpgt(middle - reach + 1).all() && high.cmplt(middle + reach - 1).all();
        let size = IVec2::new(paved.width() as i32, paved.height() as i32);
        let on_map = low.cmpgt(IVec2::splat(margin)).all() && high.cmplt(size - margin).all();
        (is_inside && on_map).then_some(Self { origin, area, border, near })
    }

    /// Whether the streets that enter it leave enough of it open.
    fn is_square(&self, sketch: &Sketch, radius: f64) -> bool {
        let middle = self.middle();
        let mut covered = Bitmap::new(self.area.width(), self.area.height());
        for street in self.near.iter().map(|&i| &sketch.streets[i]) {
            if street.half > 0.9 * radius || street.line.len() < 2 {
                continue;
            }
            for end in 0..2 {
                let Some(entry) = self.entry(street, end) else { continue };
                band(&mut covered, entry - self.origin.as_dvec2(), middle, street.half + 0.5);
            }
        }
        covered.keep(&self.area);
        let covered = covered.count() as f64;
        self.border.area_px as f64 > LEAST_SURPLUS * covered
    }

    /// Where a street comes in, as seen from outside, if one of its ends lies in here.
    fn entry(&self, street: &SketchStreet, end: usize) -> Option<DVec2> {
        let mut line = street.seen_from(end);
        if !self.holds(line.next()?) {
            return None;
        }
        line.find(|p| !self.holds(*p))
    }

    fn holds(&self, at: DVec2) -> bool {
        self.area.get_at(at - self.origin.as_dvec2())
    }

    /// Its middle, in the window.
    fn middle(&self) -> DVec2 {
        let (mut sum, mut n) = (DVec2::ZERO, 0.0);
        for (x, y) in self.area.pixels() {
            sum += DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            n += 1.0;
        }
        sum / f64::max(n, 1.0)
    }

    fn add_to(&self, taken: &mut Bitmap) {
        let size = IVec2::new(self.area.width() as i32, self.area.height() as i32);
        taken.add_from(&self.area, IVec2::ZERO, self.origin, size);
    }

    /// Its outline in the picture.
    fn outline(&self) -> Vec<DVec2> {
        self.border.moved(self.origin).simplified(1.2)
    }
}

/// How far into corners a square goes that a disc of so many pixels' radius can reach.
fn corner_steps(steps: usize) -> usize {
    (CORNER_SHARE * steps as f64) as usize
}

/// The places about one at which a disc of `steps` pixels' radius fits in, in a window that holds all that it then
/// reaches, and the window's upper left corner. Nothing where it does not fit, or goes farther than `reach`.
fn seed(paved: &Bitmap, at: DVec2, steps: usize, reach: i32) -> Option<(Bitmap, IVec2)> {
    let middle = IVec2::new(at.x as i32, at.y as i32);
    // Most squares lie in a small window; where one does not, the larger is looked at.
    for reach in [reach / 2, reach] {
        let (origin, side) = (middle - reach, 2 * reach);
        let window = Bitmap::from_window(paved, origin, side as usize, side as usize);
        let core = shrunk(&window, steps);
        let found = outlines(&core, Corners::Join);
        let own = found.iter().filter(|o| !o.is_hole()).find(|o| o.encloses(at - origin.as_dvec2()))?;
        let (low, high) = own.extent();
        // Nearer to the border than that, it is not known what a disc touches.
        let open = steps as i32;
        if low.min_element() <= open || high.max_element() >= side - open {
            continue;
        }
        let about = IVec2::splat((steps + corner_steps(steps)) as i32 + 2);
        let size = (high - low + 2 * about).as_uvec2();
        let mut seed = Bitmap::new(size.x as usize, size.y as usize);
        own.moved(about - low).paint(&mut seed, true);
        let corner = low - about;
        seed.keep(&Bitmap::from_window(&core, corner, seed.width(), seed.height()));
        return Some((seed, origin + corner));
    }
    None
}

/// The point of a ring nearest to another.
fn nearest_on(ring: &[DVec2], p: DVec2) -> DVec2 {
    let mut best = (f64::MAX, p);
    for (i, &a) in ring.iter().enumerate() {
        let along = ring[(i + 1) % ring.len()] - a;
        let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        let q = a + along * t;
        if q.distance_squared(p) < best.0 {
            best = (q.distance_squared(p), q);
        }
    }
    best.1
}

/// Least length of a street that leads to a square, metres …
const LEAST_M: f64 = 2.0;
/// … and of one between two squares.
const LEAST_BETWEEN_M: f64 = 14.0;

/// Cuts streets where they enter a square; what is inside goes.
fn cut(sketch: &mut Sketch, taken: &Bitmap, found: &[(FoundSquare, Region)], mpp: f64) {
    let inside = |p: DVec2| taken.get_at(p);
    let square_at = |p: DVec2| found.iter().position(|(_, region)| region.holds(p));
    let mut streets = Vec::new();
    for street in core::mem::take(&mut sketch.streets) {
        if !street.line.iter().any(|&p| inside(p)) {
            streets.push(street);
            continue;
        }
        let mut i = 0;
        while i < street.line.len() {
            if inside(street.line[i]) {
                i += 1;
                continue;
            }
            let from = i;
            while i < street.line.len() && !inside(street.line[i]) {
                i += 1;
            }
            let mut line = street.line[from..i].to_vec();
            let border = |p: DVec2, sketch: &mut Sketch| {
                let square = square_at(p);
                let p = square.map_or(p, |i| nearest_on(&found[i].0.outline, p));
                sketch.nodes.push(SketchNode { pos: p, radius: street.half, square });
                sketch.nodes.len() - 1
            };
            let mut ends = street.ends;
            let mut cuts = 0;
            if from > 0 {
                ends[0] = border(street.line[from - 1], sketch);
                line.insert(0, sketch.nodes[ends[0]].pos);
                cuts += 1;
            }
            if i < street.line.len() {
                ends[1] = border(street.line[i], sketch);
                line.push(sketch.nodes[ends[1]].pos);
                cuts += 1;
            }
            let least = if cuts == 2 { LEAST_BETWEEN_M } else { LEAST_M };
            if length(&line) * mpp > least {
                streets.push(SketchStreet { ends, line, half: street.half, range: street.range });
            }
        }
    }
    sketch.streets = streets;
    sketch.drop_lone_nodes();
}
