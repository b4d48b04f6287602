use std::collections::BTreeSet;

use glam::{DVec2, Vec2Swizzles};
use veduta_city::{GridPolygon, Overview, StreetClass, SurfaceKind};

use crate::body::Body;
use crate::clash::Slab;
use crate::drawing::{Drawing, Group};
use crate::gazette::{Entry, Fields, index};
use crate::margin::{Key, Margin, index_width};
use crate::named::positions;
use crate::sheet::extent;
use crate::{
    Colours, Detail, Frame, Layers, Layout, Letters, MapWords, NameKind, Named, Paper, Setting, Sheet, Tone, lay_out, tones,
};

/// Ways that are drawn on a map, plan metres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ways {
    /// That somebody is led.
    pub led: Vec<Vec<DVec2>>,
    /// Of a tour, a line for each part between cuts.
    pub tour: Vec<Vec<DVec2>>,
    /// That the visitor has gone.
    pub trail: Vec<Vec<DVec2>>,
}

/// A map that is to be drawn on paper.
pub struct Order<'a> {
    /// The city, or what of it is known.
    pub overview: &'a Overview,
    /// What is shown beyond.
    pub detail: &'a Detail,
    /// Edge of the modelled city, if it is known.
    pub extent: Option<&'a GridPolygon>,
    /// What stands above it.
    pub title: &'a str,
    /// Whom to credit.
    pub credit: &'a str,
    /// When it was drawn, if that is to be told.
    pub date: Option<&'a str>,
    /// On what.
    pub paper: Paper,
    /// Denominator of the scale; the largest round one at which all fits, if none.
    pub denominator: Option<f64>,
    /// Plan position in the middle; the city's, if none.
    pub middle: Option<DVec2>,
    /// Heading that points up, degrees clockwise from north.
    pub up_deg: f64,
    /// What is shown.
    pub layers: Layers,
    /// In which inks.
    pub colours: Colours,
    /// Whether there is a grid and an index of names.
    pub has_index: bool,
    /// Ways.
    pub ways: &'a Ways,
    /// What the margin says.
    pub words: &'a MapWords,
    /// Names as they are written in the map's language.
    pub written: &'a dyn Fn(&str) -> String,
    /// What names are sorted by.
    pub sorted_by: &'a dyn Fn(&str) -> String,
}

/// A map that has been drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The map.
    pub drawing: Drawing,
    /// Its scale's denominator.
    pub denominator: f64,
    /// What names there was room for.
    pub layout: Layout,
    /// Names that the index has no room for.
    pub left_out: usize,
    /// Letters of names that the font lacks; in pictures there are gaps for them.
    pub lacking: BTreeSet<char>,
}

/// Why there is no map.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MapError {
    /// Nothing is known of the city.
    #[error("there is nothing to draw: no house and no street")]
    Empty,
    /// The font cannot be read.
    #[error("the font cannot be read")]
    Font,
}

/// Size of ordinary names, millimetres, and how often names of long streets are repeated.
const EM_MM: f64 = 2.1;
const REPEAT_MM: f64 = 85.0;
/// About the size of an index's fields, millimetres.
const FIELD_MM: f64 = 52.0;

/// Draws a map.
///
/// # Errors
/// [`MapError::Empty`] if there is nothing to draw.
pub fn draw(order: &Order<'_>) -> Result<Drawn, MapError> {
    let letters = Letters::new().ok_or(MapError::Font)?;
    let named = Named::of([order.overview], order.written).shown(&order.layers);
    let (middle, size_m) = part(order).ok_or(MapError::Empty)?;
    let sheet = sheet(order, size_m, &named);
    let (frame, denominator) = sheet.fit(middle, size_m, order.denominator, order.up_deg);
    let fields = order.has_index.then(|| Fields::new(sheet.map, FIELD_MM));
    let inks = order.colours.inks();
    let body = Body { frame, map: sheet.map, colours: order.colours, inks };
    let mut groups = body.ground_and_houses(order.overview, order.detail, order.extent, order.layers.trees);
    groups.push(body.ways(&shown_ways(order)));
    let advance = |letter: char| letters.advance(letter);
    let setting = Setting {
        frame,
        bounds: sheet.map.grown(-0.8),
        em: EM_MM,
        repeat: REPEAT_MM,
        taken: &ends_of_ways(order, &frame),
        advance: &advance,
        before: None,
    };
    let layout = lay_out(&named.wanted(), &setting);
    let margin = Margin { sheet, inks, words: order.words, letters: &letters };
    let [grid, edge] = margin.frame(fields.as_ref());
    groups.push(grid);
    groups.extend(body.names(&named, &layout, EM_MM));
    groups.push(edge);
    let keys = keys(order, &groups, &layout);
    groups.push(margin.notes(order.title, denominator, order.up_deg, &keys, order.credit, order.date));
    let mut left_out = 0;
    if let (Some(area), Some(fields)) = (sheet.index, &fields) {
        let (group, left) = margin.index(area, &index(entries(&named, &layout, frame, fields), order.sorted_by));
        groups.push(group);
        left_out = left;
    }
    let written = layout.names.iter().flat_map(|name| name.text.chars());
    let lacking = written.filter(|&letter| !letters.has(letter)).collect();
    let drawing = Drawing {
        size_mm: sheet.size_mm,
        title: order.title.to_owned(),
        credit: order.credit.to_owned(),
        paper: inks.paper,
        groups,
    };
    Ok(Drawn { drawing, denominator, layout, left_out, lacking })
}

/// The part of the plan that is shown: its middle, and its size across and up.
fn part(order: &Order<'_>) -> Option<(DVec2, DVec2)> {
    // What is built decides, not how far the ground goes on.
    let (middle, size_m) = extent(positions(order.overview), order.up_deg)?;
    Some((order.middle.unwrap_or(middle), size_m * 1.02))
}

/// The sheet, turned so that the larger scale fits, or where the scale is given, so that more is seen.
fn sheet(order: &Order<'_>, size_m: DVec2, named: &Named) -> Sheet {
    let streets: BTreeSet<&str> = named.streets.iter().map(|street| street.name.as_str()).collect();
    let count = named.marks.iter().filter(|mark| is_told(named, mark.kind)).count() + streets.len();
    let of = |size_mm: DVec2| Sheet::new(size_mm, if order.has_index { index_width(count, size_mm.y) } else { 0.0 });
    let upright = of(order.paper.size_mm);
    if !order.paper.may_turn {
        return upright;
    }
    let level = of(order.paper.size_mm.yx());
    let scale = |sheet: &Sheet| (sheet.map.size() / size_m.max(DVec2::splat(1.0))).min_element();
    if scale(&level) > scale(&upright) { level } else { upright }
}

fn shown_ways(order: &Order<'_>) -> Ways {
    let shown = |is: bool, lines: &[Vec<DVec2>]| if is { lines.to_vec() } else { Vec::new() };
    Ways {
        led: shown(order.layers.route, &order.ways.led),
        tour: shown(order.layers.tour, &order.ways.tour),
        trail: shown(order.layers.trail, &order.ways.trail),
    }
}

fn ends_of_ways(order: &Order<'_>, frame: &Frame) -> Vec<Slab> {
    let ends = order.ways.led.iter().filter(|_| order.layers.route).filter_map(|line| line.last());
    let pin = |end: &DVec2| Slab { middle: frame.project(*end) - DVec2::new(0.0, 1.3), half: DVec2::splat(1.3), along: DVec2::X };
    ends.map(pin).collect()
}

/// What the legend has to explain: what is on the map.
fn keys(order: &Order<'_>, groups: &[Group], layout: &Layout) -> Vec<Key> {
    let has = |name: &str| groups.iter().any(|group| group.name == name && !group.items.is_empty());
    let tones: BTreeSet<Tone> = tones(order.overview).into_iter().collect();
    let has_ballast = order.overview.ground.iter().any(|patch| patch.surface == SurfaceKind::Ballast);
    let has_steps = order.overview.streets.iter().any(|street| street.class == StreetClass::Steps);
    let ways = shown_ways(order);
    let candidates = [
        (Key::House, tones.contains(&Tone::House)),
        (Key::Notable, tones.contains(&Tone::Notable)),
        (Key::Monument, tones.contains(&Tone::Monument)),
        (Key::Park, has("parks")),
        (Key::Water, has("water")),
        (Key::Railway, has_ballast),
        (Key::Steps, has_steps),
        (Key::Arcade, has("arcades")),
    ];
    let signs: BTreeSet<_> = layout.signs.iter().map(|sign| sign.symbol).collect();
    let ways = [(Key::Led, !ways.led.is_empty()), (Key::Tour, !ways.tour.is_empty()), (Key::Trail, !ways.trail.is_empty())];
    let shown = candidates.into_iter().filter(|(_, is)| *is).map(|(key, _)| key);
    let ways = ways.into_iter().filter(|(_, is)| *is).map(|(key, _)| key);
    shown.chain(signs.into_iter().map(Key::Sign)).chain(ways).collect()
}

/// So many houses with a name are told in the index, or none.
const MOST_HOUSES: usize = 80;

/// Whether the index tells of places of a kind.
fn is_told(named: &Named, kind: NameKind) -> bool {
    match kind {
        NameKind::View | NameKind::Shop => false,
        NameKind::House => named.marks.iter().filter(|mark| mark.kind == kind).count() <= MOST_HOUSES,
        _ => true,
    }
}

/// Lines of the index: streets where their names stand, else where their middle lies; places and landmarks where they are.
fn entries(named: &Named, layout: &Layout, frame: Frame, fields: &Fields) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut add = |name: &str, at: DVec2| {
        if let Some(field) = fields.of(at) {
            entries.push(Entry { name: name.to_owned(), field });
        }
    };
    let mut done = BTreeSet::new();
    let streets = layout.names.iter().filter(|name| matches!(name.course, crate::Course::Along(_)));
    for name in streets {
        if done.insert(name.text.as_str()) {
            add(&name.text, name.slabs[name.slabs.len() / 2].middle);
        }
    }
    for street in &named.streets {
        // The longest line of a name comes first.
        if done.insert(street.name.as_str()) {
            add(&street.name, frame.project(street.line[street.line.len() / 2]));
        }
    }
    let marks = named.marks.iter().filter(|mark| is_told(named, mark.kind));
    marks.for_each(|mark| add(&mark.name, frame.project(mark.plan_pos)));
    let told: BTreeSet<&str> = named.marks.iter().map(|mark| mark.name.as_str()).collect();
    let landmarks = named.landmarks.iter().filter(|(_, name)| !told.contains(name.as_str()));
    landmarks.for_each(|(landmark, name)| add(name, frame.project(landmark.plan_pos)));
    entries
}
