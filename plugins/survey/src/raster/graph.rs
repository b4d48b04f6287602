//! From what a map shows to a city graph.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use veduta_city::{Building, CityGraph, Id, Link, LinkKind, Node, RoofTags, Square, StreetClass, WidthAt};

use super::read::{MapReading, ReadStreet};
use crate::log::Log;
use crate::polygon::{Polygon, difference, even_odd};
use crate::start;

/// Streets at least so wide are main streets, metres …
const MAIN_M: f64 = 14.0;
/// … and those narrower than this are lanes.
const LANE_M: f64 = 7.0;
/// Ends closer together than this are one node, metres.
const WELD_M: f64 = 0.01;

/// The city graph of a reading.
pub(super) fn graph_of(reading: MapReading, log: &mut Log) -> CityGraph {
    let mut nodes = Nodes::default();
    let mut links = Vec::new();
    let of_courses =
        reading.courses.into_iter().map(|(kind, line, width)| (kind, ReadStreet { line, width, ..ReadStreet::default() }));
    let of_streets = reading.streets.into_iter().map(|street| {
        let class = street.class.unwrap_or_else(|| class_of(street.width));
        (LinkKind::Street(class), street)
    });
    for (kind, ReadStreet { line, width, profile, layer, .. }) in of_streets.chain(of_courses) {
        let (Some(&first), Some(&last)) = (line.first(), line.last()) else { continue };
        let (from, to) = (nodes.at(first), nodes.at(last));
        if from == to && line.len() < 4 {
            log.dropped(Id::NONE, Some(first), "a link shorter than a centimetre was left out");
            continue;
        }
        let via = line[1..line.len() - 1].iter().map(|&p| rounded(p)).collect();
        let (width_m, profile) = (rounded_to(width, 100.0), told(profile));
        links.push(Link { id: Id::NONE, from, to, via, kind, width_m, profile, name: String::new(), layer, surfacing: None });
    }
    let mut graph = CityGraph { margin_m: CityGraph::default_margin_m(), nodes: nodes.all, links, ..CityGraph::default() };
    for outline in reading.squares {
        for polygon in repaired(outline, Vec::new(), "square", log) {
            let Polygon { outer, holes } = polygon;
            graph.squares.push(Square { id: Id::NONE, name: String::new(), outline: outer, holes, surfacing: Default::default() });
        }
    }
    for block in reading.blocks {
        for polygon in repaired(block.outline, block.holes, "block", log) {
            graph.blocks.push(crate::grounds::block(Id::NONE, block.kind, String::new(), &polygon));
        }
    }
    for house in reading.houses {
        graph.buildings.extend(repaired(house.outline, house.courts, "house", log).into_iter().map(building));
    }
    graph.start = start::start(&graph);
    graph
}

/// Nodes by place.
#[derive(Default)]
struct Nodes {
    all: Vec<Node>,
    by_place: BTreeMap<(i64, i64), Id>,
    taken: BTreeSet<Id>,
}

impl Nodes {
    fn at(&mut self, pos: DVec2) -> Id {
        let pos = rounded(pos);
        let key = ((pos.x / WELD_M).round() as i64, (pos.y / WELD_M).round() as i64);
        if let Some(&id) = self.by_place.get(&key) {
            return id;
        }
        let mut id = Id::from_place("node", pos);
        while !self.taken.insert(id) {
            id.0 = id.0.wrapping_add(1) | 1 << 63;
        }
        self.by_place.insert(key, id);
        self.all.push(Node { id, pos, z: 0.0 });
        id
    }
}

fn rounded(p: DVec2) -> DVec2 {
    (p / WELD_M).round() * WELD_M
}

fn rounded_to(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// A profile as it is written: widths to a centimetre, shares to a ten thousandth.
fn told(profile: Vec<WidthAt>) -> Vec<WidthAt> {
    let entries =
        profile.into_iter().map(|e| WidthAt { share: rounded_to(e.share, 10_000.0), width_m: rounded_to(e.width_m, 100.0) });
    let mut entries: Vec<WidthAt> = entries.collect();
    entries.dedup_by(|next, kept| next.share <= kept.share);
    entries
}

fn class_of(width_m: f64) -> StreetClass {
    if width_m >= MAIN_M {
        StreetClass::Main
    } else if width_m >= LANE_M {
        StreetClass::Street
    } else {
        StreetClass::Lane
    }
}

/// A house of which only the footprint is known.
fn building(polygon: Polygon) -> Building {
    Building {
        id: Id::NONE,
        name: String::new(),
        number: String::new(),
        style: String::new(),
        outline: polygon.outer,
        holes: polygon.holes,
        min_height_m: 0.0,
        height_m: None,
        levels: None,
        roof: RoofTags::default(),
        colour: None,
        parts: Vec::new(),
        monument: None,
    }
}

/// A ring less its holes as valid polygons.
fn repaired(ring: Vec<DVec2>, holes: Vec<Vec<DVec2>>, what: &str, log: &mut Log) -> Vec<Polygon> {
    let ring: Vec<DVec2> = ring.into_iter().map(rounded).collect();
    let at = ring.first().copied();
    let (polygons, is_untouched) = even_odd(&[ring]);
    if !is_untouched {
        log.repaired(Id::NONE, at, format!("the outline of a {what} crossed itself"));
    }
    if holes.is_empty() {
        return polygons;
    }
    let of_hole = |hole: Vec<DVec2>| even_odd(&[hole.into_iter().map(rounded).collect()]).0;
    let holes: Vec<Polygon> = holes.into_iter().flat_map(of_hole).collect();
    difference(&polygons, &holes)
}
