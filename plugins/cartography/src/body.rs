//! The map itself: ground, water, houses, ways, names.

use glam::DVec2;
use veduta_city::{GridPolygon, GridPos, Overview, SpanForm, StreetClass, SurfaceKind, metres};

use crate::drawing::{Align, Baseline, Group, Item, Stroke, Text};
use crate::layout::{Course, LEADING, Layout, Name, SIGN, Shown};
use crate::letters::{CAPITAL, SMALL};
use crate::ribbon::beside;
use crate::{Area, Colours, Detail, Frame, Inks, NameKind, Named, Symbol, Ways, tones};

/// Areas of one kind reach so far over one another, millimetres across: else pictures would show seams between them.
const SEAM_MM: f64 = 0.2;

/// How a map's body is drawn.
pub(crate) struct Body<'a> {
    pub frame: Frame,
    pub map: Area,
    pub colours: Colours,
    pub inks: &'a Inks,
}

impl Body<'_> {
    fn group(&self, name: &'static str) -> Group {
        Group::new(name, Some(self.map))
    }

    fn ring(&self, ring: &[GridPos]) -> Vec<DVec2> {
        ring.iter().map(|pos| self.frame.project(pos.to_metres())).collect()
    }

    fn line(&self, line: &[DVec2]) -> Vec<DVec2> {
        line.iter().map(|&p| self.frame.project(p)).collect()
    }

    fn mm(&self, length_m: f64) -> f64 {
        length_m * self.frame.scale
    }

    /// The rings of a polygon; `None` if nothing of it is on the map.
    fn rings(&self, polygon: &GridPolygon) -> Option<Vec<Vec<DVec2>>> {
        let outer = self.ring(&polygon.outer);
        let (first, rest) = outer.split_first()?;
        let (low, high) = rest.iter().fold((*first, *first), |(low, high), p| (low.min(*p), high.max(*p)));
        let is_here = low.cmple(self.map.max).all() && high.cmpge(self.map.min).all();
        is_here.then(|| core::iter::once(outer).chain(polygon.holes.iter().map(|hole| self.ring(hole))).collect())
    }

    /// Ground of some kinds: a rim under all of it, then the areas, which leave no seam between them.
    fn ground(
        &self,
        group: &'static str,
        overview: &Overview,
        is_kind: impl Fn(SurfaceKind) -> bool,
        rim: Option<Stroke>,
    ) -> Group {
        let mut drawn = self.group(group);
        let patches = || {
            let found = overview.ground.iter().filter(|patch| is_kind(patch.surface));
            found.filter_map(|patch| Some((self.inks.ground(patch.surface)?, self.rings(&patch.outline)?)))
        };
        if let Some(rim) = rim {
            drawn.items.extend(patches().map(|(_, rings)| Item::Area { rings, fill: None, edge: Some(rim.clone()) }));
        }
        drawn.items.extend(patches().map(|(ink, rings)| Item::Area {
            rings,
            fill: Some(ink),
            edge: Some(Stroke::round(ink, SEAM_MM)),
        }));
        drawn
    }

    /// All that lies under the names.
    pub fn ground_and_houses(&self, overview: &Overview, detail: &Detail, extent: Option<&GridPolygon>, trees: bool) -> Vec<Group> {
        let inks = self.inks;
        let mut land = self.group("land");
        let edge =
            [self.map.min, DVec2::new(self.map.max.x, self.map.min.y), self.map.max, DVec2::new(self.map.min.x, self.map.max.y)];
        let beyond = extent.and_then(|extent| self.rings(extent));
        let rings = beyond.unwrap_or_else(|| vec![edge.to_vec()]);
        land.items.push(Item::Area { rings, fill: Some(inks.yard), edge: None });
        let is_soil = |surface| matches!(surface, SurfaceKind::Gravel | SurfaceKind::Ballast);
        let rim = Stroke::round(inks.kerb, 0.34);
        vec![
            land,
            self.ground("parks", overview, |surface| surface == SurfaceKind::Grass, None),
            self.ground("soil", overview, is_soil, None),
            self.ground("streets", overview, SurfaceKind::is_public, Some(rim)),
            self.ground("water", overview, |surface| surface == SurfaceKind::Water, Some(Stroke::round(inks.bank, 0.6))),
            self.stairs(overview),
            self.bridges(overview),
            if trees { self.trees(detail) } else { self.group("trees") },
            self.houses(overview),
            self.arcades(detail),
        ]
    }

    /// Stairs as their treads.
    fn stairs(&self, overview: &Overview) -> Group {
        let mut drawn = self.group("stairs");
        for street in overview.streets.iter().filter(|street| street.class == StreetClass::Steps && street.layer >= 0) {
            let width = self.mm(metres(street.width)).max(0.7);
            let stroke = Stroke { dashes: vec![0.14, 0.3], ..Stroke::plain(self.inks.stone, width) };
            drawn.items.push(Item::Line { points: self.ring(&street.line), stroke });
        }
        drawn
    }

    /// Bridges with their parapets, ramps, and tunnels dashed.
    fn bridges(&self, overview: &Overview) -> Group {
        let mut drawn = self.group("bridges");
        let sides = |span: &veduta_city::WaySpan| {
            let side = |left: bool| -> Vec<DVec2> {
                let ends = span.stations.iter().map(|station| if left { station.left } else { station.right });
                ends.map(|pos| self.frame.project(pos.to_metres())).collect()
            };
            [side(true), side(false)]
        };
        for span in overview.spans.iter().filter(|span| span.is_bore()) {
            let stroke = Stroke { dashes: vec![1.0, 0.8], ..Stroke::plain(self.inks.kerb, 0.2) };
            drawn.items.extend(sides(span).map(|points| Item::Line { points, stroke: stroke.clone() }));
        }
        let open = || overview.spans.iter().filter(|span| !span.is_bore());
        for span in open() {
            let Some((ink, rings)) = self.inks.ground(span.surface).zip(self.rings(&span.outline())) else { continue };
            drawn.items.push(Item::Area { rings, fill: Some(ink), edge: Some(Stroke::round(ink, 0.07)) });
        }
        for span in open() {
            let width = if matches!(span.form, SpanForm::Arches) { 0.32 } else { 0.2 };
            let has = [span.parapets.0, span.parapets.1];
            let shown = sides(span).into_iter().zip(has).filter(|(_, has)| *has);
            drawn.items.extend(shown.map(|(points, _)| Item::Line { points, stroke: Stroke::plain(self.inks.stone, width) }));
        }
        drawn
    }

    fn trees(&self, detail: &Detail) -> Group {
        let mut drawn = self.group("trees");
        // From far off there would be more dots than map.
        if self.frame.scale < 0.12 {
            return drawn;
        }
        let near = self.map.grown(3.0);
        for &(plan_pos, radius_m) in &detail.trees {
            let at = self.frame.project(plan_pos);
            let radius = self.mm(radius_m).clamp(0.25, 2.5);
            if near.contains(at) {
                drawn.items.push(dot(at, radius, self.inks.tree));
            }
        }
        drawn
    }

    fn houses(&self, overview: &Overview) -> Group {
        let mut drawn = self.group("houses");
        let width = if self.frame.scale >= 0.15 { 0.12 } else { 0.07 };
        let tones = tones(overview);
        let has_edges = self.frame.scale >= 0.08;
        let mut order: Vec<usize> = (0..overview.houses.len()).collect();
        // Dark ones, and of a house its higher parts, lie above.
        order.sort_by_key(|&i| (tones[i], overview.houses[i].height));
        for i in order {
            let Some(rings) = self.rings(&overview.houses[i].outline) else { continue };
            let edge = has_edges.then(|| Stroke::round(self.inks.wall, width));
            drawn.items.push(Item::Area { rings, fill: Some(self.inks.house(tones[i])), edge });
        }
        drawn
    }

    fn arcades(&self, detail: &Detail) -> Group {
        let mut drawn = self.group("arcades");
        let stroke = Stroke { dashes: vec![0.01, 0.75], ..Stroke::round(self.inks.stone, 0.42) };
        if self.frame.scale >= 0.2 {
            let lines = detail.arcades.iter().map(|line| self.line(line));
            drawn.items.extend(lines.map(|points| Item::Line { points, stroke: stroke.clone() }));
        }
        drawn
    }

    /// Ways that are gone.
    pub fn ways(&self, ways: &Ways) -> Group {
        let mut drawn = self.group("ways");
        let inks = self.inks;
        let mut add = |lines: &[Vec<DVec2>], stroke: Stroke| {
            for points in lines.iter().filter(|line| line.len() > 1).map(|line| self.line(line)) {
                let halo = Stroke { dashes: Vec::new(), ..Stroke::round(inks.halo, stroke.width + 0.7) };
                drawn.items.push(Item::Line { points: points.clone(), stroke: halo });
                drawn.items.push(Item::Line { points, stroke: stroke.clone() });
            }
        };
        add(&ways.trail, Stroke { dashes: vec![0.01, 1.1], ..Stroke::round(inks.trail, 0.6) });
        add(&ways.tour, Stroke { dashes: vec![2.4, 1.4], ..Stroke::plain(inks.tour, 0.75) });
        add(&ways.led, Stroke::round(inks.led, 0.95));
        for end in ways.led.iter().filter_map(|line| line.last()) {
            drawn.items.push(sign(Symbol::End, self.frame.project(*end) - DVec2::new(0.0, 1.3), 2.6, inks));
        }
        drawn
    }

    /// Pictures, signs and names that have found room.
    pub fn names(&self, named: &Named, layout: &Layout, em: f64) -> [Group; 3] {
        let mut pictures = self.group("landmarks");
        for shown in &layout.pictures {
            self.picture(named, shown, &mut pictures);
        }
        let mut signs = self.group("signs");
        signs.items.extend(layout.signs.iter().map(|s| sign(s.symbol, s.at, em * SIGN, self.inks)));
        let mut names = self.group("names");
        // The weightiest last, so that nothing lies over them.
        layout.names.iter().rev().for_each(|name| names.items.extend(letters(name, em, self.inks).into_iter().map(Item::Text)));
        [pictures, signs, names]
    }

    fn picture(&self, named: &Named, shown: &Shown, group: &mut Group) {
        let (landmark, _) = &named.landmarks[shown.landmark];
        let picture = landmark.picture(self.frame.up_deg, self.colours);
        let placed = |points: &[DVec2]| -> Vec<DVec2> { points.iter().map(|&p| shown.at + p * shown.scale).collect() };
        let halo = Stroke::round(self.inks.halo, 0.55);
        group.items.extend(picture.facets.iter().map(|facet| {
            let rings = vec![placed(&facet.points)];
            Item::Area { rings, fill: None, edge: Some(halo.clone()) }
        }));
        group.items.extend(picture.facets.iter().map(|facet| {
            let edge = Stroke::round(facet.edge.unwrap_or(facet.fill), if facet.edge.is_some() { 0.07 } else { 0.04 });
            Item::Area { rings: vec![placed(&facet.points)], fill: Some(facet.fill), edge: Some(edge) }
        }));
    }
}

/// A round dot.
pub(crate) fn dot(at: DVec2, radius: f64, ink: veduta_city::Rgb) -> Item {
    Item::Line { points: vec![at, at + DVec2::new(0.01, 0.0)], stroke: Stroke::round(ink, radius * 2.0) }
}

/// A sign about a place.
pub(crate) fn sign(symbol: Symbol, at: DVec2, size: f64, inks: &Inks) -> Item {
    let ring = symbol.outline().iter().map(|&p| at + DVec2::from(p) * size).collect();
    Item::Area { rings: vec![ring], fill: Some(symbol.ink(inks)), edge: Some(Stroke::round(inks.halo, size * 0.1)) }
}

/// The lines of letters of a name.
fn letters(name: &Name, em: f64, inks: &Inks) -> Vec<Text> {
    let style = name.kind.style();
    let text = |words: &str, on: Baseline| Text {
        words: words.to_owned(),
        size: name.size,
        ink: name.kind.ink(inks),
        halo: Some((inks.halo, em * if name.kind == NameKind::Water { 0.05 } else { 0.16 })),
        weight: style.weight,
        is_slanted: style.is_slanted,
        // The layout reckons with thicker strokes.
        spacing: style.spacing + style.weight,
        on,
    };
    match &name.course {
        // The middles of small letters lie on the street's middle.
        Course::Along(line) => {
            let down = name.size * (SMALL + CAPITAL) / 4.0;
            vec![text(&name.text, Baseline::Along(beside(line, down)))]
        }
        Course::Level { anchor, offset, lines } => {
            let middle = *anchor + *offset;
            let leading = name.size * LEADING;
            let first = middle.y - leading * (lines.len() as f64 - 1.0) / 2.0 + name.size * CAPITAL / 2.0;
            let at = |n: usize| DVec2::new(middle.x, first + leading * n as f64);
            lines.iter().enumerate().map(|(n, line)| text(line, Baseline::At(at(n), Align::Middle))).collect()
        }
    }
}
