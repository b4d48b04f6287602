//! Which names, symbols and small pictures a map has room for, and where they stand. One for paper and screen.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::clash::{Slab, Taken};
use crate::ribbon::Ribbon;
use crate::{Area, Frame, Landmark, NameKind, StreetLine, Symbol};

/// A place that is to be marked or named.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Its name, as it is written.
    pub name: String,
    /// What it is.
    pub kind: NameKind,
    /// The sign that stands at it, if any.
    pub symbol: Option<Symbol>,
    /// Where, plan metres.
    pub plan_pos: DVec2,
}

/// What there is to be named.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Streets.
    pub streets: &'a [StreetLine],
    /// Places.
    pub marks: &'a [Mark],
    /// Landmarks, with the names that are written beside them.
    pub landmarks: &'a [(Landmark, String)],
}

/// How it is to be laid out.
pub struct Setting<'a> {
    /// How plan metres lie on the drawing.
    pub frame: Frame,
    /// Where names may stand.
    pub bounds: Area,
    /// Size of ordinary names, units.
    pub em: f64,
    /// Names of long streets are repeated about this often, units.
    pub repeat: f64,
    /// What is taken already.
    pub taken: &'a [Slab],
    /// Width of a letter, in parts of its size.
    pub advance: &'a dyn Fn(char) -> f64,
    /// Where names stood before: they stay there while they can.
    pub before: Option<&'a Stood>,
}

/// Where names stand.
#[derive(Debug, Clone, PartialEq)]
pub enum Course {
    /// Along the middle of a street: the line that the letters' middles follow, from the first to the last.
    Along(Vec<DVec2>),
    /// Level, about a place: in lines, about the middle of the block of them.
    Level {
        /// What it names, on the drawing.
        anchor: DVec2,
        /// From there to the middle of the block.
        offset: DVec2,
        /// Its lines.
        lines: Vec<String>,
    },
}

/// A name that has found room.
#[derive(Debug, Clone, PartialEq)]
pub struct Name {
    /// What is written.
    pub text: String,
    /// What it names.
    pub kind: NameKind,
    /// Size of its letters, units.
    pub size: f64,
    /// Where it stands.
    pub course: Course,
    /// What it takes up.
    pub slabs: Vec<Slab>,
}

/// A sign that has found room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sign {
    /// Which.
    pub symbol: Symbol,
    /// Its middle on the drawing.
    pub at: DVec2,
    /// Index of the mark.
    pub mark: usize,
}

/// A small picture that has found room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Index of the landmark.
    pub landmark: usize,
    /// Middle of its ground on the drawing.
    pub at: DVec2,
    /// Units of the drawing to a metre of the picture.
    pub scale: f64,
}

/// What a map has room for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layout {
    /// Names, the weightiest first.
    pub names: Vec<Name>,
    /// Signs.
    pub signs: Vec<Sign>,
    /// Small pictures.
    pub pictures: Vec<Shown>,
    stood: Stood,
}

/// Where names stood, so that they stay there on the next drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stood {
    /// By name and index of the line: metres from its start to the middle of each name on it.
    along: BTreeMap<(String, usize), Vec<f64>>,
    /// By name: which side of its place.
    beside: BTreeMap<String, usize>,
}

impl Layout {
    /// Where its names stand.
    #[must_use]
    pub fn stood(&self) -> &Stood {
        &self.stood
    }
}

/// Sharpest turn between two letters, radians, and how much a name may wind in all.
const SHARPEST: f64 = 0.38;
const WINDING: f64 = 1.9;
/// Heights of a small picture, ems: at least and at most; and its greatest width.
const LEAST_PICTURE: f64 = 3.4;
const MOST_PICTURE: f64 = 8.0;
const WIDEST_PICTURE: f64 = 7.5;
/// Names wider than this are written in two lines, ems.
const WIDE: f64 = 8.5;
/// So many positions along a street are tried.
const TRIES: usize = 48;
/// Size of a sign, ems.
pub const SIGN: f64 = 1.05;
/// Height of a line of a name, in parts of its size.
pub const LEADING: f64 = 1.12;

/// Lays out names, signs and pictures: no two overlap. Names are given room by their kind, streets of one kind by their length.
#[must_use]
pub fn lay_out(wanted: &Wanted<'_>, setting: &Setting<'_>) -> Layout {
    let mut draft = Draft { setting, taken: Taken::new(setting.em * 2.0), layout: Layout::default() };
    draft.taken.take(setting.taken);
    let em_a_metre = setting.frame.scale / setting.em;
    let mut marks: Vec<usize> = (0..wanted.marks.len()).collect();
    marks.sort_by(|&a, &b| {
        let (a, b) = (&wanted.marks[a], &wanted.marks[b]);
        a.kind.cmp(&b.kind).then_with(|| a.name.cmp(&b.name)).then(a.plan_pos.x.total_cmp(&b.plan_pos.x))
    });
    let mut streets: Vec<(usize, f64)> = wanted.streets.iter().map(StreetLine::length_m).enumerate().collect();
    streets.sort_by(|a, b| {
        let kind = |n: usize| NameKind::of_street(wanted.streets[n].class);
        kind(a.0).cmp(&kind(b.0)).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0))
    });
    let mut pictured = vec![false; wanted.landmarks.len()];
    for kind in NameKind::ALL {
        let is_large_enough = em_a_metre >= kind.style().from_scale;
        if kind == NameKind::Landmark {
            draft.pictures(wanted.landmarks, &mut pictured);
        }
        for &mark in marks.iter().filter(|&&n| wanted.marks[n].kind == kind) {
            let place = &wanted.marks[mark];
            let is_pictured = wanted.landmarks.iter().zip(&pictured).any(|((landmark, name), &is)| {
                is && (landmark.name == place.name || *name == place.name || landmark.stands_on(place.plan_pos))
            });
            if !is_pictured {
                draft.mark(mark, place, is_large_enough, em_a_metre);
            }
        }
        for &(n, _) in streets.iter().filter(|&&(n, _)| is_large_enough && NameKind::of_street(wanted.streets[n].class) == kind) {
            draft.street(n, &wanted.streets[n], kind);
        }
    }
    draft.layout
}

struct Draft<'a> {
    setting: &'a Setting<'a>,
    taken: Taken,
    layout: Layout,
}

/// Where a block of lines stands about its place, in the order of what reads best (Imhof 1962): right, left, below, above, then aslant.
const SIDES: [(f64, f64); 8] =
    [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.8, -0.8), (0.8, 0.8), (-0.8, -0.8), (-0.8, 0.8)];

impl Draft<'_> {
    fn fits(&self, slabs: &[Slab]) -> bool {
        slabs.iter().all(|slab| slab.is_within(&self.setting.bounds)) && self.taken.leaves_free(slabs)
    }

    /// Advances of letters with the room between them, units.
    fn advances(&self, text: &str, kind: NameKind, size: f64) -> Vec<f64> {
        let style = kind.style();
        text.chars().map(|letter| ((self.setting.advance)(letter) + style.spacing + style.weight) * size).collect()
    }

    fn pictures(&mut self, landmarks: &[(Landmark, String)], pictured: &mut [bool]) {
        let (em, frame) = (self.setting.em, self.setting.frame);
        for (n, (landmark, name)) in landmarks.iter().enumerate() {
            let at = frame.project(landmark.plan_pos);
            let bounds = landmark.picture(frame.up_deg, crate::Colours::Paper).bounds;
            let size = bounds.size();
            let fitting = (em * MOST_PICTURE / size.y).min(em * WIDEST_PICTURE / size.x);
            let scale = frame.scale.max(em * LEAST_PICTURE / size.y).min(fitting);
            let on_map = Area { min: at + bounds.min * scale, max: at + bounds.max * scale };
            let slab = [Slab::upright(on_map.grown(-0.06 * on_map.size().min_element()))];
            if !self.fits(&slab) {
                continue;
            }
            self.taken.take(&slab);
            pictured[n] = true;
            self.layout.pictures.push(Shown { landmark: n, at, scale });
            if em_of(frame, em) >= NameKind::Landmark.style().from_scale {
                let reach = on_map.size() / 2.0;
                let from_anchor = on_map.middle() - at;
                self.beside(name, NameKind::Landmark, at, from_anchor, reach, &[2, 0, 1, 3]);
            }
        }
    }

    fn mark(&mut self, n: usize, mark: &Mark, is_named: bool, em_a_metre: f64) {
        let (em, at) = (self.setting.em, self.setting.frame.project(mark.plan_pos));
        if !self.setting.bounds.contains(at) {
            return;
        }
        let Some(symbol) = mark.symbol else {
            if is_named {
                self.level_at(mark, at);
            }
            return;
        };
        // Of hundreds of shops the signs alone would say nothing.
        let is_lesser = matches!(mark.kind, NameKind::House | NameKind::Shop);
        if em_a_metre < symbol.from_scale() || is_lesser && !is_named {
            return;
        }
        let sign = Slab::upright(Area { min: at - em * SIGN * 0.5, max: at + em * SIGN * 0.5 });
        if !self.fits(&[sign]) {
            return;
        }
        self.taken.take(&[sign]);
        self.layout.signs.push(Sign { symbol, at, mark: n });
        let before = self.layout.names.len();
        if is_named {
            self.beside(&mark.name, mark.kind, at, DVec2::ZERO, DVec2::splat(em * SIGN * 0.5), &[0, 1, 2, 3, 4, 5, 6, 7]);
        }
        if is_lesser && self.layout.names.len() == before {
            self.layout.signs.pop();
        }
    }

    /// A name about its place itself: of a square, park or water.
    fn level_at(&mut self, mark: &Mark, at: DVec2) {
        let em = self.setting.em;
        let shifts =
            [(0.0, 0.0), (0.0, 1.2), (0.0, -1.2), (2.0, 0.0), (-2.0, 0.0), (1.6, 1.4), (-1.6, 1.4), (1.6, -1.4), (-1.6, -1.4)];
        for size in self.sizes(mark.kind) {
            for (n, shift) in self.ordered(&mark.name, shifts.len()).into_iter().map(|n| (n, shifts[n])) {
                if self.block(&mark.name, mark.kind, size, at, DVec2::from(shift) * em, n) {
                    return;
                }
            }
        }
    }

    fn sizes(&self, kind: NameKind) -> [f64; 2] {
        let style = kind.style();
        [style.size, style.least].map(|size| size * self.setting.em)
    }

    /// Positions in the order in which they are tried: that of before first.
    fn ordered(&self, name: &str, count: usize) -> Vec<usize> {
        let before = self.setting.before.and_then(|stood| stood.beside.get(name)).copied().filter(|&n| n < count);
        before.into_iter().chain((0..count).filter(|&n| Some(n) != before)).collect()
    }

    /// A name beside something that reaches so far about a middle.
    fn beside(&mut self, name: &str, kind: NameKind, at: DVec2, middle: DVec2, reach: DVec2, sides: &[usize]) {
        let gap = self.setting.em * 0.22;
        for size in self.sizes(kind) {
            for side in self.ordered(name, SIDES.len()).into_iter().filter(|side| sides.contains(side)) {
                let half = self.block_size(&self.lines(name, kind, size), kind, size) / 2.0;
                let way = DVec2::from(SIDES[side]);
                let offset = middle + way * (reach + half + gap);
                if self.block(name, kind, size, at, offset, side) {
                    return;
                }
            }
        }
    }

    /// A name in one line, or in two where it is long.
    fn lines(&self, name: &str, kind: NameKind, size: f64) -> Vec<String> {
        let width = |text: &str| self.advances(text, kind, size).iter().sum::<f64>();
        if width(name) <= WIDE * self.setting.em {
            return vec![name.to_owned()];
        }
        let breaks = name.match_indices(' ').map(|(at, _)| (&name[..at], &name[at + 1..]));
        let best = breaks.min_by(|a, b| width(a.0).max(width(a.1)).total_cmp(&width(b.0).max(width(b.1))));
        best.map_or_else(|| vec![name.to_owned()], |(first, second)| vec![first.to_owned(), second.to_owned()])
    }

    fn block_size(&self, lines: &[String], kind: NameKind, size: f64) -> DVec2 {
        let width = lines.iter().map(|line| self.advances(line, kind, size).iter().sum::<f64>()).fold(0.0, f64::max);
        DVec2::new(width, size * LEADING * lines.len() as f64)
    }

    /// Writes a block of lines there if it has room.
    fn block(&mut self, name: &str, kind: NameKind, size: f64, anchor: DVec2, offset: DVec2, position: usize) -> bool {
        let lines = self.lines(name, kind, size);
        let half = self.block_size(&lines, kind, size) / 2.0;
        let middle = anchor + offset;
        let slabs = vec![Slab::upright(Area { min: middle - half, max: middle + half })];
        if !self.fits(&slabs) {
            return false;
        }
        self.taken.take(&slabs);
        self.layout.stood.beside.insert(name.to_owned(), position);
        let course = Course::Level { anchor, offset, lines };
        self.layout.names.push(Name { text: name.to_owned(), kind, size, course, slabs });
        true
    }

    /// A street's name along it, again and again where it is long.
    fn street(&mut self, n: usize, street: &StreetLine, kind: NameKind) {
        let (setting, style) = (self.setting, kind.style());
        let line: Vec<DVec2> = street.line.iter().map(|&p| setting.frame.project(p)).collect();
        let near = setting.bounds;
        if !line.windows(2).any(|w| touches(&near, w[0], w[1])) {
            return;
        }
        // Letters fit between the street's edges where they can; in narrow lanes they reach over them.
        let breadth = 2.0 * street.half_width_m * setting.frame.scale;
        let size = (breadth * 0.8).clamp(style.least * setting.em, style.size * setting.em);
        let Some(ribbon) = Ribbon::smooth(line, size * 1.6, breadth * 0.4) else { return };
        let advances = self.advances(&street.name, kind, size);
        let length: f64 = advances.iter().sum();
        let room = ribbon.length() - size * 0.3;
        if length > room {
            return;
        }
        let count = (libm::floor(room / setting.repeat.max(length * 1.5)) as usize).clamp(1, 64);
        let share = ribbon.length() / count as f64;
        let before = setting.before.and_then(|stood| stood.along.get(&(street.name.clone(), n))).map_or(&[][..], Vec::as_slice);
        for instance in 0..count {
            let window = (instance as f64 * share, (instance + 1) as f64 * share);
            let wished = before.iter().map(|m| m * setting.frame.scale).find(|m| (window.0..window.1).contains(m));
            let Some((start, slabs)) = self.along(&ribbon, &advances, size, window, wished) else { continue };
            self.taken.take(&slabs);
            let middle_m = (start + length / 2.0) / setting.frame.scale;
            self.layout.stood.along.entry((street.name.clone(), n)).or_default().push(middle_m);
            let course = Course::Along(run(&ribbon, start, length));
            self.layout.names.push(Name { text: street.name.clone(), kind, size, course, slabs });
        }
    }

    /// The best free position in a window of a street: the straightest and nearest to its middle, or to where it stood before.
    fn along(
        &self,
        ribbon: &Ribbon,
        advances: &[f64],
        size: f64,
        window: (f64, f64),
        wished: Option<f64>,
    ) -> Option<(f64, Vec<Slab>)> {
        let length: f64 = advances.iter().sum();
        let (from, to) = (window.0 + size * 0.15, window.1 - length - size * 0.15);
        if to < from {
            return None;
        }
        let steps = (libm::ceil((to - from) / (size * 0.6)) as usize).clamp(1, TRIES);
        let starts = (0..=steps).map(|i| from + (to - from) * i as f64 / steps as f64);
        let wished_start = wished.map(|middle| (middle - length / 2.0).clamp(from, to));
        let middle = (window.0 + window.1 - length) / 2.0;
        let mut tried: Vec<(f64, f64, Vec<Slab>)> = starts
            .chain(wished_start)
            .filter_map(|start| {
                let (slabs, winding) = letters(ribbon, advances, size, start)?;
                let away = (start - middle).abs() / (window.1 - window.0).max(1e-9);
                let is_wished = wished_start == Some(start);
                Some((if is_wished { -1.0 } else { winding + away * 0.8 }, start, slabs))
            })
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        tried.into_iter().find(|(_, _, slabs)| self.fits(slabs)).map(|(_, start, slabs)| (start, slabs))
    }
}

fn em_of(frame: Frame, em: f64) -> f64 {
    frame.scale / em
}

/// Whether a straight piece may touch a rectangle.
fn touches(area: &Area, a: DVec2, b: DVec2) -> bool {
    a.min(b).cmple(area.max).all() && a.max(b).cmpge(area.min).all()
}

/// The stretch of a ribbon that a name follows, in the direction in which it is read: to the right, or upwards.
fn run(ribbon: &Ribbon, start: f64, length: f64) -> Vec<DVec2> {
    let end = start + length;
    if reads_backwards(ribbon, start, end) { ribbon.piece(end, start) } else { ribbon.piece(start, end) }
}

fn reads_backwards(ribbon: &Ribbon, start: f64, end: f64) -> bool {
    let d = ribbon.at(end).0 - ribbon.at(start).0;
    // Nearly upright names are read upwards.
    if d.x.abs() < 0.08 * d.y.abs() { d.y > 0.0 } else { d.x < 0.0 }
}

/// What each letter takes up along a ribbon, and how much they wind; `None` where they wind too much.
fn letters(ribbon: &Ribbon, advances: &[f64], size: f64, start: f64) -> Option<(Vec<Slab>, f64)> {
    let length: f64 = advances.iter().sum();
    let is_backwards = reads_backwards(ribbon, start, start + length);
    let mut slabs = Vec::with_capacity(advances.len());
    let (mut upto, mut winding, mut last) = (0.0, 0.0, None::<DVec2>);
    for advance in advances {
        let along = upto + advance / 2.0;
        upto += advance;
        let s = if is_backwards { start + length - along } else { start + along };
        let (at, leads) = ribbon.at(s);
        let along = if is_backwards { -leads } else { leads };
        if let Some(last) = last {
            let turn = libm::fabs(libm::atan2(last.perp_dot(along), last.dot(along)));
            winding += turn;
            if turn > SHARPEST || winding > WINDING {
                return None;
            }
        }
        last = Some(along);
        slabs.push(Slab { middle: at, half: DVec2::new(advance / 2.0, size * 0.5), along });
    }
    Some((slabs, winding))
}
