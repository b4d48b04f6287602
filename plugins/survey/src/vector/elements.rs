//! Features to nodes, ways and relations, which the rest of the survey reads as it reads OpenStreetMap.

use glam::DVec2;
use veduta_city::{Anchor, Id, Severity};

use super::Layer;
use super::date::{Date, Span, Standing, standing};
use super::feature::{Content, Feature, Shape};
use super::mapping::Mapping;
use super::space::Space;
use super::succession::Successors;
use super::tagging::{Drawn, LayerName, Tagged, tagged};
use crate::SurveyError;
use crate::lines::short;
use crate::log::Log;
use crate::osm::{Member, MemberKind, OsmData, Relation, Tags, Way, number_from_place};

/// Degrees to the unit of the coarse grid that names things by place: about half a metre a step.
const GRID_PER_DEGREE: f64 = 111_320.0;

/// When a feature began and ended.
struct Life {
    is_dated: bool,
    start: Span,
    end: Span,
}

/// Collects the elements of several layers.
pub(super) struct Collector<'a> {
    pub data: OsmData,
    pub log: Log,
    mapping: &'a Mapping,
    date: Option<&'a Date>,
    /// Where features begin, those too that do not stand: latitude and longitude.
    places: Vec<(f64, f64)>,
    /// Features with dates, and of those not yet and no more standing.
    dated: usize,
    not_yet: usize,
    no_more: usize,
}

impl<'a> Collector<'a> {
    pub(super) fn new(mapping: &'a Mapping, date: Option<&'a Date>) -> Self {
        Self { data: OsmData::default(), log: Log::default(), mapping, date, places: Vec::new(), dated: 0, not_yet: 0, no_more: 0 }
    }

    /// Takes a layer in.
    pub(super) fn add(&mut self, layer: &Layer<'_>, content: &Content, space: &Space) -> Result<(), SurveyError> {
        let day = self.date.map(Date::day);
        let lives: Vec<Life> = content.features.iter().map(|f| self.life(f)).collect();
        let new = content.features.iter().zip(&lives).filter(|(_, life)| day.is_some_and(|day| life.start.contains(day)));
        let successors = Successors::new(new.map(|(f, _)| f), space);
        for (feature, life) in content.features.iter().zip(&lives) {
            if feature.shapes.is_empty() {
                self.tell(Severity::Note, format!("features of {} have no geometry", layer.name));
                continue;
            }
            self.places.extend(feature.shapes.iter().filter_map(|s| space.geo(s.positions().next()?)));
            let is_going = day.is_some_and(|day| life.end.contains(day) && !life.start.contains(day));
            if is_going && successors.replace(feature, space) {
                self.no_more += 1;
            } else if self.stands(life) {
                for shape in &feature.shapes {
                    self.add_shape(layer, feature, shape, space)?;
                }
            }
        }
        Ok(())
    }

    /// Tells what dates made of the features, and gives out what was collected.
    pub(super) fn finish(mut self) -> (OsmData, Log) {
        let gone = self.not_yet + self.no_more;
        if gone > 0 {
            let message = match self.date {
                Some(date) => format!(
                    "of {} features with dates {} did not stand yet and {} stood no more in {date}: they are left out",
                    self.dated, self.not_yet, self.no_more
                ),
                None => format!(
                    "of {} features with dates {} have come to an end: without a date to show, they are left out",
                    self.dated, self.no_more
                ),
            };
            self.log.note(Id::NONE, None, message);
        }
        if self.dated > 0 {
            self.data.anchor = middle(self.places);
        }
        (self.data, self.log)
    }

    fn tell(&mut self, severity: Severity, message: String) {
        self.log.tally(severity, Id::NONE, None, message);
    }

    /// When a feature began and ended, as far as it says.
    fn life(&mut self, feature: &Feature) -> Life {
        let mapping = self.mapping;
        let (start, end) = (self.span(feature, &mapping.start), self.span(feature, &mapping.end));
        let life =
            Life { is_dated: start.is_some() || end.is_some(), start: start.unwrap_or_default(), end: end.unwrap_or_default() };
        self.dated += usize::from(life.is_dated);
        if life.start.from.zip(life.end.to).is_some_and(|(from, to)| from > to) {
            self.tell(Severity::Note, "features end before they begin: they stand at no time".to_owned());
        }
        life
    }

    /// Whether a feature stands at the date to be shown; counts those that do not.
    fn stands(&mut self, life: &Life) -> bool {
        match standing(life.start, life.end, self.date) {
            Standing::Stands => return true,
            Standing::NotYet => self.not_yet += 1,
            Standing::NoMore => self.no_more += 1,
        }
        false
    }

    fn span(&mut self, feature: &Feature, names: &[String]) -> Option<Span> {
        let (name, text) = feature.first_of(names)?;
        let span = Span::parse(text);
        if span.is_none() {
            let message = format!("{name}=\"{}\" is no date that is understood: it is taken as not known", short(text));
            self.tell(Severity::Note, message);
        }
        span
    }

    fn add_shape(&mut self, layer: &Layer<'_>, feature: &Feature, shape: &Shape, space: &Space) -> Result<(), SurveyError> {
        let vertices = shape.positions().count();
        self.data.admit(1 + vertices, layer.name)?;
        let drawn = drawn_of(shape, feature);
        let tags = match tagged(feature, LayerName { name: layer.name, holds: layer.holds }, drawn, self.mapping) {
            Tagged::As(tags) => tags,
            Tagged::Ignored => {
                self.tell(Severity::Note, format!("features of {} are of kinds that the mapping passes over", layer.name));
                return Ok(());
            }
            Tagged::Unknown => {
                self.tell_unknown(layer, feature, drawn);
                return Ok(());
            }
        };
        match shape {
            Shape::Points(points) => points.iter().for_each(|p| self.add_point(feature, *p, &tags, space)),
            Shape::Lines(lines) => lines.iter().for_each(|line| self.add_line(feature, line, &tags, space)),
            Shape::Rings(rings) => match rings.as_slice() {
                // A loop of street that some program took for an area, since it closes.
                [(ring, _)] if drawn != Drawn::Area => self.add_line(feature, ring, &tags, space),
                _ => self.add_area(feature, rings, tags, space),
            },
        }
        Ok(())
    }

    fn tell_unknown(&mut self, layer: &Layer<'_>, feature: &Feature, drawn: Drawn) {
        let words = match drawn {
            Drawn::Point => "points",
            Drawn::Line | Drawn::ClosedLine => "lines",
            Drawn::Area => "polygons",
        };
        let value = feature.first_of(&self.mapping.kind).map(|(k, v)| format!(" ({k}=\"{}\")", short(v))).unwrap_or_default();
        let message = format!(
            "{words} of {} say nothing that a city graph holds{value}: a mapping may name what they are, in `kinds` or `layers`",
            layer.name
        );
        self.tell(Severity::Dropped, message);
    }

    /// The node at a position; `None` off the Earth.
    fn node(&mut self, pos: DVec2, space: &Space) -> Option<i64> {
        let node = space.geo(pos).and_then(|(lat, lon)| self.data.node_at(lat, lon));
        if node.is_none() {
            self.tell(Severity::Dropped, "vertices lie nowhere on Earth".to_owned());
        }
        node
    }

    fn nodes(&mut self, line: &[DVec2], space: &Space) -> Vec<i64> {
        line.iter().filter_map(|p| self.node(*p, space)).collect()
    }

    fn add_point(&mut self, feature: &Feature, pos: DVec2, tags: &Tags, space: &Space) {
        let Some((lat, lon)) = space.geo(pos) else {
            self.tell(Severity::Dropped, "points lie nowhere on Earth".to_owned());
            return;
        };
        let own = osm_number(&feature.id, "node").filter(|n| !self.data.nodes.contains_key(n));
        let number = own.unwrap_or_else(|| {
            // Not the number of the vertex at this place: two points there, or a point on a line, are two things.
            let mut number = number_from_place("point", grid(lat, lon)) >> 1;
            while self.data.nodes.contains_key(&number) {
                number = number.wrapping_add(1);
            }
            number
        });
        self.data.add_node(number, lat, lon, tags.clone());
    }

    fn add_line(&mut self, feature: &Feature, line: &[DVec2], tags: &Tags, space: &Space) {
        let nodes = self.nodes(line, space);
        if nodes.len() < 2 {
            self.tell(Severity::Dropped, "lines have fewer than two vertices".to_owned());
            return;
        }
        let number = self.way_number(feature, "line", &nodes);
        self.data.ways.insert(number, Way { nodes, tags: tags.clone() });
    }

    fn add_area(&mut self, feature: &Feature, rings: &[(Vec<DVec2>, bool)], tags: Tags, space: &Space) {
        let mut closed: Vec<(Vec<i64>, bool)> = Vec::new();
        for (ring, is_inner) in rings {
            let mut nodes = self.nodes(ring, space);
            nodes.dedup();
            if nodes.first() != nodes.last() {
                nodes.extend(nodes.first().copied());
            }
            if nodes.len() < 4 {
                self.tell(Severity::Dropped, "outlines have fewer than three corners".to_owned());
            } else {
                closed.push((nodes, *is_inner));
            }
        }
        let first = closed.first().map(|(nodes, _)| nodes.clone()).unwrap_or_default();
        match closed.len() {
            0 => {}
            1 if osm_number(&feature.id, "relation").is_none() => {
                let number = self.way_number(feature, "area", &first);
                self.data.ways.insert(number, Way { nodes: first, tags });
            }
            _ => {
                let mut members = Vec::with_capacity(closed.len());
                for (nodes, is_inner) in closed {
                    let id = self.way_number(&Feature::default(), "ring", &nodes);
                    self.data.ways.insert(id, Way { nodes, tags: Tags::default() });
                    members.push(Member { kind: MemberKind::Way, id, role: if is_inner { "inner" } else { "outer" }.into() });
                }
                let own = osm_number(&feature.id, "relation").filter(|n| !self.data.relations.contains_key(n));
                let mut number = own.unwrap_or_else(|| self.place_number("areas", &first));
                while self.data.relations.contains_key(&number) {
                    number = number.wrapping_sub(1);
                }
                let tags = multipolygon(tags);
                self.data.relations.insert(number, Relation { members, tags });
            }
        }
    }

    /// A free number for a way: OpenStreetMap's own, or one from its place.
    fn way_number(&mut self, feature: &Feature, kind: &str, nodes: &[i64]) -> i64 {
        let own = osm_number(&feature.id, "way");
        if let Some(number) = own.filter(|n| !self.data.ways.contains_key(n)) {
            return number;
        }
        if own.is_some() {
            self.tell(Severity::Note, "features share one id: all but the first are named by place".to_owned());
        }
        let mut number = self.place_number(kind, nodes);
        while self.data.ways.contains_key(&number) {
            number = number.wrapping_sub(1);
        }
        number
    }

    /// A number from kind and place: the middle of the box around.
    fn place_number(&self, kind: &str, nodes: &[i64]) -> i64 {
        let at = nodes.iter().filter_map(|n| self.data.nodes.get(n)).map(|n| grid(n.lat, n.lon));
        let (low, high) = at.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        number_from_place(kind, (low + high) / 2.0)
    }
}

/// An anchor amid all features, so that a town has one at whatever date it is shown: the medians, to about a metre.
fn middle(places: Vec<(f64, f64)>) -> Option<Anchor> {
    let (mut lats, mut lons): (Vec<f64>, Vec<f64>) = places.into_iter().unzip();
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).map(|v| libm::round(v * 1e5) / 1e5)
    };
    Some(Anchor { lat: median(&mut lats)?, lon: median(&mut lons)? })
}

/// Degrees in steps of about half a metre.
pub(super) fn grid(lat: f64, lon: f64) -> DVec2 {
    DVec2::new(lon, lat) * GRID_PER_DEGREE
}

/// Tags of a relation that is an area, whatever else they say of its type.
fn multipolygon(tags: Tags) -> Tags {
    if tags.is("type", "multipolygon") {
        return tags;
    }
    let mut out = Tags::default();
    out.push("type", "multipolygon");
    out.extend(&tags);
    out
}

fn drawn_of(shape: &Shape, feature: &Feature) -> Drawn {
    match shape {
        Shape::Points(_) => Drawn::Point,
        Shape::Lines(lines) => match lines.as_slice() {
            [line] if line.len() > 3 && line.first() == line.last() => Drawn::ClosedLine,
            _ => Drawn::Line,
        },
        Shape::Rings(rings) => {
            let is_way = rings.len() == 1 && osm_number(&feature.id, "way").is_some();
            let is_street = feature.get("highway").is_some() && feature.get("area").is_none_or(|a| a == "no");
            if is_way && is_street { Drawn::ClosedLine } else { Drawn::Area }
        }
    }
}

/// The number of an id of OpenStreetMap of a type: `way/123`.
fn osm_number(id: &str, kind: &str) -> Option<i64> {
    id.strip_prefix(kind)?.strip_prefix('/')?.parse().ok().filter(|n| *n > 0)
}
