//! The way from a picture to streets, squares and blocks.

use glam::DVec2;
use veduta_city::{LinkKind, StreetClass, WidthAt};

use crate::Georeference;

use super::SIDE_PX;
use super::bitmap::Bitmap;
use super::blocks::{FoundBlock, blocks};
use super::bridge::lead_through;
use super::classify::{Classes, classified};
use super::clean::{Labels, MARGIN, cleaned, is_rare};
use super::course::courses;
use super::crossing;
use super::enclosed::tell_streets;
use super::ends::{clipped, run_on};
use super::filter::median5;
use super::house::{Footprint, houses};
use super::legend::Legend;
use super::neatline::Neatline;
use super::outline::{Corners, simplified};
use super::over::{over_rails, over_water};
use super::parts::Parts;
use super::picture::Picture;
use super::profile::profile;
use super::sketch::Sketch;
use super::square::{printed_squares, squares};
use super::stage::{self, Stage, Stages};
use super::thinning::thinned;
use super::tint::Tints;
use super::trace::traced;
use super::yard::courtyards;

/// How far a street's line may be from what was traced, metres, or pixels if these are larger.
const SIMPLE_M: f64 = 0.6;
/// Share of the streets' pixels that must not look like noise, or the map is read at twice its size …
const LEAST_STEADY: f64 = 0.3;
/// … or at four times it, and no more.
const MOST_TIMES: usize = 4;

/// What a map shows, in plan metres.
#[derive(Debug, Clone, Default)]
pub(super) struct MapReading {
    /// Streets.
    pub streets: Vec<ReadStreet>,
    /// Rivers and railways: kind, line and width.
    pub courses: Vec<(LinkKind, Vec<DVec2>, f64)>,
    /// Squares.
    pub squares: Vec<Vec<DVec2>>,
    /// Blocks.
    pub blocks: Vec<FoundBlock>,
    /// Single houses.
    pub houses: Vec<Footprint>,
}

/// A street between two nodes.
#[derive(Debug, Clone, Default)]
pub(super) struct ReadStreet {
    /// Its line.
    pub line: Vec<DVec2>,
    /// Its class, where the map tells it by colour.
    pub class: Option<StreetClass>,
    /// The width that it mostly has, metres.
    pub width: f64,
    /// Its widths from place to place, where they vary.
    pub profile: Vec<WidthAt>,
    /// 0, or 1 where it runs over water or rails.
    pub layer: i8,
}

impl MapReading {
    /// The same, where the picture lies.
    pub fn placed(self, place: &Georeference) -> Self {
        let (mpp, height) = (place.metres_per_pixel(), f64::from(place.size().1));
        self.moved(|p| place.plan_pos(DVec2::new(p.x / mpp, height - p.y / mpp)))
    }

    /// The same elsewhere.
    fn moved(mut self, to: impl Fn(DVec2) -> DVec2) -> Self {
        let move_all = |line: &mut Vec<DVec2>| line.iter_mut().for_each(|p| *p = to(*p));
        self.streets.iter_mut().for_each(|street| move_all(&mut street.line));
        self.courses.iter_mut().for_each(|(_, line, _)| move_all(line));
        self.squares.iter_mut().for_each(move_all);
        self.blocks.iter_mut().flat_map(FoundBlock::rings_mut).for_each(move_all);
        self.houses.iter_mut().flat_map(Footprint::rings_mut).for_each(move_all);
        let [origin, east, north] = [DVec2::ZERO, DVec2::X, DVec2::Y].map(&to);
        if (east - origin).perp_dot(north - origin) < 0.0 {
            // A picture that lies mirrored: what ran counter-clockwise runs clockwise there.
            let of_blocks = self.blocks.iter_mut().flat_map(FoundBlock::rings_mut);
            let of_houses = self.houses.iter_mut().flat_map(Footprint::rings_mut);
            self.squares.iter_mut().chain(of_blocks).chain(of_houses).for_each(|ring| ring.reverse());
        }
        self
    }
}

/// Reads a map within its neatline, if it has one. `done` is told the name of each step as it ends.
pub(super) fn read_within(
    neatline: Option<&Neatline>,
    picture: &Picture,
    legend: &Legend,
    mpp: f64,
    threads: usize,
    stages: &mut Stages<'_>,
    done: &mut dyn FnMut(&'static str),
) -> MapReading {
    let Some(neatline) = neatline else { return read_map(picture, legend, mpp, threads, stages, done) };
    let inside = neatline.map_of(picture);
    let given = stages.given.map(|(stage, picture)| (stage, neatline.cropped(picture)));
    let is_shown = stages.show.is_some();
    let mut show = |stage: Stage, shown: &Picture| stages.show(stage, || neatline.pasted(shown));
    let mut of_inside = Stages { given: given.as_ref().map(|(stage, picture)| (*stage, picture)), ..Stages::default() };
    if is_shown {
        of_inside.show = Some(&mut show);
    }
    let reading = read_map(&inside, legend, mpp, threads, &mut of_inside, done);
    reading.moved(|p| p + neatline.corner() * mpp)
}

/// Reads a map of so many metres a pixel. `done` is told the name of each step as it ends.
fn read_map(
    picture: &Picture,
    legend: &Legend,
    mpp: f64,
    threads: usize,
    stages: &mut Stages<'_>,
    done: &mut dyn FnMut(&'static str),
) -> MapReading {
    let mut classes = stages.given(Stage::Classes).map_or_else(|| told_apart(picture, legend), stage::classes);
    stages.show(Stage::Classes, || stage::of_classes(&classes));
    let times = enlarged(&mut classes);
    let mpp = mpp / times as f64;
    let given =
        |stages: &Stages<'_>, stage| stages.given(stage).map(|mended| larger(stage::white(mended), times).with_margin(MARGIN));
    let shown = |bitmap: &Bitmap| smaller(bitmap.without_margin(MARGIN), times);
    done("classify");
    let (mut paved, hidden, mut parts) = cleaned(&classes, mpp);
    if let Some(mended) = given(stages, Stage::Streets) {
        paved = mended;
        parts = Parts::of(&paved, Corners::Join).parts;
    }
    stages.show(Stage::Streets, || stage::of_bitmaps(&shown(&paved), None));
    let labels = Labels::of(&classes.ink);
    let printed = printed_squares(&classes, &labels, &paved, MARGIN, mpp);
    let yards = courtyards(&mut paved, &parts, &hidden, printed.as_ref(), mpp);
    done("clean");
    // Lines that were drawn into a skeleton may be wider than a pixel.
    let skeleton = thinned(given(stages, Stage::Skeleton).as_ref().unwrap_or(&paved), threads);
    stages.show(Stage::Skeleton, || stage::of_bitmaps(&shown(&skeleton), Some(&shown(&paved))));
    done("skeleton");
    let graph = traced(&skeleton);
    done("trace");
    let mut sketch = Sketch::of(graph, &paved);
    sketch.prune();
    sketch.join_chains();
    sketch.prune();
    sketch.join_chains();
    done("simplify");
    sketch.measure(&paved);
    lead_through(&mut sketch, &mut paved, &hidden, mpp);
    sketch.join_chains();
    done("widths");
    let found = squares(&mut sketch, &paved, printed.as_ref(), MARGIN as i32, mpp);
    sketch.prune();
    sketch.join_chains();
    done("squares");
    crossing::settle(&mut sketch, &paved, mpp);
    sketch.join_chains();
    let (width, height) = (classes.street.width(), classes.street.height());
    let size = DVec2::new(width as f64, height as f64);
    let margin = DVec2::splat(MARGIN as f64);
    let plan = |p: DVec2| DVec2::new(p.x - margin.x, size.y - (p.y - margin.y)) * mpp;
    let mut streets = read_streets(&sketch, [&paved, &hidden], Tints::of(picture, legend, times).as_ref(), mpp);
    done("streets");
    let mut street = paved.without_margin(MARGIN);
    if let Some(yards) = yards {
        street.add(&yards.without_margin(MARGIN));
    }
    let blank = || Bitmap::new(width, height);
    let (mut railway, mut river) = (blank(), blank());
    let mut courses_found = Vec::new();
    for (kind, class, mask) in
        [(LinkKind::Railway { tram: false }, &classes.railway, &mut railway), (LinkKind::Watercourse, &classes.water, &mut river)]
    {
        if is_rare(class) {
            continue;
        }
        *mask = labels.cleaned(class);
        let found = courses(mask, mpp, tolerance_px(mpp));
        streets = match kind {
            LinkKind::Watercourse => over_water(streets, &found, mask, mpp),
            _ => over_rails(streets, &found, mask, mpp),
        };
        for course in found {
            let line = course.line.iter().map(|p| DVec2::new(p.x, size.y - p.y) * mpp).collect();
            courses_found.push((kind, line, 2.0 * course.half * mpp));
        }
    }
    for street in &mut streets {
        for p in &mut street.line {
            *p = DVec2::new(p.x, size.y - p.y) * mpp;
        }
    }
    done("courses");
    let blocks = blocks(&street, [&railway, &river], &classes, mpp);
    let mut houses = houses(&classes, &labels, mpp);
    houses.iter_mut().flat_map(Footprint::rings_mut).for_each(|ring| {
        *ring = ring.iter().rev().map(|p| DVec2::new(p.x, size.y - p.y) * mpp).collect();
    });
    done("blocks");
    let squares = found.iter().map(|s| s.outline.iter().rev().map(|&p| plan(p)).collect()).collect();
    MapReading { streets, courses: courses_found, squares, blocks, houses }
}

/// The classes of a map's pixels.
fn told_apart(picture: &Picture, legend: &Legend) -> Classes {
    let mut classes = classified(picture, legend);
    if legend.is_outlined {
        tell_streets(&mut classes);
    }
    classes
}

/// The streets of a sketch, as far as they lie on the map; in its pixels. `paved` and what labels may hide of it have a margin.
fn read_streets(sketch: &Sketch, [paved, hidden]: [&Bitmap; 2], tints: Option<&Tints<'_>>, mpp: f64) -> Vec<ReadStreet> {
    let ends = sketch.degrees();
    let margin = DVec2::splat(MARGIN as f64);
    let corner = DVec2::new(paved.width() as f64, paved.height() as f64) - margin;
    let tolerance_px = tolerance_px(mpp);
    let mut streets = Vec::new();
    for street in &sketch.streets {
        let mut line = street.line.clone();
        for end in 0..2 {
            if ends[street.ends[end]] == 1 && sketch.nodes[street.ends[end]].square.is_none() {
                run_on(&mut line, end, street.half, paved);
            }
        }
        for piece in clipped(&line, margin, corner) {
            let piece = simplified(&piece, tolerance_px);
            let mouths = [(0, piece.first()), (1, piece.last())].map(|(end, p)| {
                let node = sketch.nodes[street.ends[end]];
                let is_met = ends[street.ends[end]] > 2 || node.square.is_some();
                (is_met && p == Some(&node.pos)).then_some(node.radius)
            });
            let profile = profile(&piece, (street.half, street.range), mouths, [paved, hidden], mpp);
            let line: Vec<DVec2> = piece.into_iter().map(|p| p - margin).collect();
            let class = tints.and_then(|tints| tints.class_of(&line, street.half));
            streets.push(ReadStreet { line, class, width: 2.0 * street.half * mpp, profile, layer: 0 });
        }
    }
    streets
}

/// Makes the classes of a map larger whose streets are so narrow that cleaning would take most of them for noise, and says how
/// many times.
fn enlarged(classes: &mut Classes) -> usize {
    let is_thin = |street: &Bitmap| {
        let mut steady = median5(street);
        steady.keep(street);
        (steady.count() as f64) < LEAST_STEADY * street.count() as f64
    };
    let mut times = 1;
    while times < MOST_TIMES && 2 * classes.street.width().max(classes.street.height()) <= SIDE_PX && is_thin(&classes.street) {
        for class in classes.all_mut() {
            *class = larger(core::mem::replace(class, Bitmap::new(0, 0)), 2);
        }
        times *= 2;
    }
    times
}

/// A bitmap made larger, by a power of two.
fn larger(mut bitmap: Bitmap, times: usize) -> Bitmap {
    for _ in 0..times.ilog2() {
        bitmap = bitmap.doubled(2 * bitmap.width(), 2 * bitmap.height());
    }
    bitmap
}

/// A bitmap made smaller, by a power of two.
fn smaller(mut bitmap: Bitmap, times: usize) -> Bitmap {
    for _ in 0..times.ilog2() {
        bitmap = bitmap.halved();
    }
    bitmap
}

/// How far the line of a street or course may be from what was traced, pixels.
fn tolerance_px(mpp: f64) -> f64 {
    (SIMPLE_M / mpp).max(1.0)
}
