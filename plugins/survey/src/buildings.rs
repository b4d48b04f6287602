//! Houses with known footprints, their parts gathered into them.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use veduta_city::{Building, BuildingPart, Id, Severity};

use crate::body::Body;
use crate::extent::Extent;
use crate::log::Log;
use crate::osm::{MemberKind, OsmData, relation_id, way_id};
use crate::polygon::{Polygon, difference, perimeter_m, union};
use crate::shapes::{Area, Use};

/// Parts that cover this share of a building's outline stand for all of it.
const FULL_COVER: f64 = 0.9;
/// A part whose underside is higher leaves room for the building's own body below it, in metres.
const OVERHEAD_M: f64 = 8.0;
/// Left-over bodies smaller than this, or thinner than a metre or so, are seams between parts; square metres.
const LEAST_BODY_M2: f64 = 6.0;

/// A footprint and what was made of it so far.
struct Draft {
    building: Building,
    footprint: Polygon,
    parts: Vec<Drawn>,
}

struct Drawn {
    id: Id,
    polygon: Polygon,
    body: Body,
}

type Box2 = GeomWithData<Rectangle<[f64; 2]>, usize>;

/// An index of polygons by their bounds.
pub(crate) struct Index(RTree<Box2>);

impl Index {
    pub(crate) fn new<'a>(polygons: impl Iterator<Item = &'a Polygon>) -> Self {
        let boxes = polygons.enumerate().map(|(i, p)| {
            let (low, high) = p.bounds();
            GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), i)
        });
        Self(RTree::bulk_load(boxes.collect()))
    }

    /// Indices of polygons whose bounds meet a box, ascending.
    pub(crate) fn near(&self, low: DVec2, high: DVec2) -> Vec<usize> {
        let search = AABB::from_corners(low.to_array(), high.to_array());
        let mut found: Vec<usize> = self.0.locate_in_envelope_intersecting(&search).map(|b| b.data).collect();
        found.sort_unstable();
        found
    }
}

/// Every building of the file, by order of ids within ways and relations.
pub(crate) fn buildings(areas: &[Area<'_>], data: &OsmData, extent: &Extent, log: &mut Log) -> Vec<Building> {
    let mut drafts = footprints(areas, log);
    let index = Index::new(drafts.iter().map(|d| &d.footprint));
    let by_relation = parts_by_relation(data);
    let mut orphans = Vec::new();
    for area in above_ground(areas, Use::Part, log) {
        for (i, polygon) in area.polygons.iter().enumerate() {
            let part = Drawn {
                id: if i == 0 { area.id } else { Id::NONE },
                polygon: polygon.clone(),
                body: Body::of(area.tags, polygon, area.id, log),
            };
            match home_of(&part, area.id, &drafts, &index, &by_relation).and_then(|i| drafts.get_mut(i)) {
                Some(draft) => draft.parts.push(part),
                None => orphans.push(part),
            }
        }
    }
    drafts.extend(houses_of_orphans(orphans, log));
    let mut out: Vec<Building> = drafts.into_iter().map(|d| finished(d, log)).collect();
    number_by_addresses(&mut out, data, extent);
    tell_contained(&out, log);
    out
}

/// The areas of one use that stand in the open, so that they can be seen from the street.
fn above_ground<'a, 'd>(areas: &'a [Area<'d>], use_: Use, log: &mut Log) -> Vec<&'a Area<'d>> {
    let mut out: Vec<&Area<'d>> = areas.iter().filter(|a| a.use_ == use_).collect();
    out.retain(|area| {
        let layer = area.tags.get("layer").and_then(crate::length::number).unwrap_or(0.0);
        let is_below = area.tags.is("location", "underground") || (layer < 0.0 && !area.tags.has("height"));
        if is_below {
            log.tally(Severity::Dropped, area.id, Some(area.inner_pos()), "buildings under the ground are left out");
        }
        !is_below
    });
    out
}

fn footprints(areas: &[Area<'_>], log: &mut Log) -> Vec<Draft> {
    let mut drafts: Vec<Draft> = Vec::new();
    let mut seen: BTreeMap<Vec<(i64, i64)>, Id> = BTreeMap::new();
    for area in above_ground(areas, Use::Building, log) {
        for (i, polygon) in area.polygons.iter().enumerate() {
            let mut vertices: Vec<(i64, i64)> =
                polygon.outer.iter().map(|p| (libm::round(p.x * 50.0) as i64, libm::round(p.y * 50.0) as i64)).collect();
            vertices.sort_unstable();
            if let Some(first) = seen.get(&vertices) {
                log.dropped(area.id, Some(polygon.inner_pos()), format!("a building has the very outline of {first}"));
                continue;
            }
            seen.insert(vertices, area.id);
            let body = Body::of(area.tags, polygon, area.id, log);
            drafts.push(Draft {
                building: Building {
                    id: if i == 0 { area.id } else { Id::NONE },
                    name: area.tags.text("name"),
                    number: area.tags.text("addr:housenumber"),
                    ..house(polygon, body)
                },
                footprint: polygon.clone(),
                parts: Vec::new(),
            });
        }
    }
    drafts
}

fn house(polygon: &Polygon, body: Body) -> Building {
    Building {
        id: Id::NONE,
        name: String::new(),
        number: String::new(),
        style: String::new(),
        outline: polygon.outer.clone(),
        holes: polygon.holes.clone(),
        min_height_m: body.min_height_m,
        height_m: body.height_m,
        levels: body.levels,
        roof: body.roof,
        colour: body.colour,
        parts: Vec::new(),
        monument: None,
    }
}

/// For every part that a `type=building` relation names, the outlines that it names too.
fn parts_by_relation(data: &OsmData) -> BTreeMap<Id, Vec<Id>> {
    let mut out: BTreeMap<Id, Vec<Id>> = BTreeMap::new();
    let id_of = |m: &crate::osm::Member| match m.kind {
        MemberKind::Node => None,
        MemberKind::Way => Some(way_id(m.id)),
        MemberKind::Relation => Some(relation_id(m.id)),
    };
    for relation in data.relations.values().filter(|r| r.tags.is("type", "building")) {
        let outlines: Vec<Id> = relation.members.iter().filter(|m| &*m.role == "outline").filter_map(id_of).collect();
        for part in relation.members.iter().filter(|m| &*m.role != "outline").filter_map(id_of) {
            out.entry(part).or_default().extend(&outlines);
        }
    }
    out
}

/// The building that a part belongs to: the one its relation names, otherwise the smallest that contains it.
fn home_of(part: &Drawn, id: Id, drafts: &[Draft], index: &Index, by_relation: &BTreeMap<Id, Vec<Id>>) -> Option<usize> {
    if let Some(outlines) = by_relation.get(&id)
        && let Some(i) = drafts.iter().position(|d| d.building.id.is_given() && outlines.contains(&d.building.id))
    {
        return Some(i);
    }
    let inside = part.polygon.inner_pos();
    let size = |i: &usize| drafts.get(*i).map_or(f64::INFINITY, |d| d.footprint.area_m2());
    let holds = |i: &usize| {
        drafts.get(*i).is_some_and(|d| Polygon { outer: d.footprint.outer.clone(), holes: Vec::new() }.contains(inside))
    };
    index.near(inside, inside).into_iter().filter(holds).min_by(|a, b| size(a).total_cmp(&size(b)))
}

/// Parts that stand in no building: those that touch become one building of their own.
fn houses_of_orphans(orphans: Vec<Drawn>, log: &mut Log) -> Vec<Draft> {
    if orphans.is_empty() {
        return Vec::new();
    }
    let footprints = union(orphans.iter().map(|o| &o.polygon));
    let mut groups: Vec<Vec<Drawn>> = footprints.iter().map(|_| Vec::new()).collect();
    for orphan in orphans {
        let inside = orphan.polygon.inner_pos();
        log.tally(Severity::Note, orphan.id, Some(inside), "building parts without a building around them stand for themselves");
        match footprints.iter().position(|f| f.contains(inside)).and_then(|i| groups.get_mut(i)) {
            Some(group) => group.push(orphan),
            None => log.dropped(orphan.id, Some(inside), "a building part has no area left"),
        }
    }
    let mut out = Vec::new();
    for (footprint, parts) in footprints.into_iter().zip(groups) {
        let Some(first) = parts.iter().map(|p| p.id).filter(|id| id.is_given()).min() else { continue };
        let top = parts.iter().filter_map(|p| p.body.height_m).fold(0.0, f64::max);
        let body = Body { height_m: (top > 0.0).then_some(top), ..Body::default() };
        out.push(Draft { building: Building { id: first, ..house(&footprint, body) }, footprint, parts });
    }
    out
}

/// A building with its parts; where they cover only some of it, its own body fills the rest.
fn finished(draft: Draft, log: &mut Log) -> Building {
    let Draft { mut building, footprint, parts } = draft;
    if parts.is_empty() {
        return building;
    }
    let mut used = BTreeSet::new();
    let pos = footprint.inner_pos();
    let own = Body {
        min_height_m: building.min_height_m,
        height_m: building.height_m,
        levels: building.levels,
        roof: building.roof,
        colour: building.colour,
    };
    let left = difference([&footprint], parts.iter().map(|p| &p.polygon));
    let area = |all: &[Polygon]| all.iter().map(Polygon::area_m2).sum::<f64>();
    if area(&left) > (1.0 - FULL_COVER) * footprint.area_m2() {
        let low = parts.iter().filter(|p| p.body.min_height_m < OVERHEAD_M).map(|p| &p.polygon);
        for polygon in difference([&footprint], low) {
            if polygon.area_m2() >= LEAST_BODY_M2 && polygon.area_m2() > 0.5 * perimeter_m(&polygon.outer) {
                building.parts.push(part_of(Id::NONE, &polygon, own));
            }
        }
        if !building.parts.is_empty() {
            log.repaired(building.id, Some(pos), "its parts cover only some of the building: its own body fills the rest");
        }
    }
    for Drawn { id, polygon, mut body } in parts {
        // What a part leaves open, its building may tell.
        body.colour = body.colour.or(own.colour);
        body.roof.colour = body.roof.colour.or(own.roof.colour);
        let id = if used.insert(id) { id } else { Id::NONE };
        building.parts.push(part_of(id, &polygon, body));
    }
    building
}

fn part_of(id: Id, polygon: &Polygon, body: Body) -> BuildingPart {
    BuildingPart {
        id,
        outline: polygon.outer.clone(),
        holes: polygon.holes.clone(),
        min_height_m: body.min_height_m,
        height_m: body.height_m,
        levels: body.levels,
        roof: body.roof,
        colour: body.colour,
        opening: None,
    }
}

/// Footprint of a building as a polygon.
pub(crate) fn footprint_of(building: &Building) -> Polygon {
    Polygon { outer: building.outline.clone(), holes: building.holes.clone() }
}

/// Gives buildings without a number the lowest of the address points inside them.
fn number_by_addresses(buildings: &mut [Building], data: &OsmData, extent: &Extent) {
    let footprints: Vec<Polygon> = buildings.iter().map(footprint_of).collect();
    let index = Index::new(footprints.iter());
    let mut best: BTreeMap<usize, (u32, String)> = BTreeMap::new();
    for node in data.nodes.values().filter(|n| n.tags.has("addr:housenumber")) {
        let (pos, number) = (extent.plan_pos(node), node.tags.text("addr:housenumber"));
        let digits: String = number.chars().take_while(char::is_ascii_digit).collect();
        let key = (digits.parse().unwrap_or(u32::MAX), number);
        for i in index.near(pos, pos) {
            if footprints.get(i).is_some_and(|f| f.contains(pos)) && best.get(&i).is_none_or(|b| key < *b) {
                best.insert(i, key.clone());
            }
        }
    }
    for (i, (_, number)) in best {
        if let Some(building) = buildings.get_mut(i).filter(|b| b.number.is_empty()) {
            building.number = number;
        }
    }
}

/// Notes buildings that stand inside others: both are kept, as neither can be told wrong.
fn tell_contained(buildings: &[Building], log: &mut Log) {
    let footprints: Vec<Polygon> = buildings.iter().map(footprint_of).collect();
    let index = Index::new(footprints.iter());
    for (i, (building, footprint)) in buildings.iter().zip(&footprints).enumerate() {
        let pos = footprint.inner_pos();
        let outer = index.near(pos, pos).into_iter().find(|&j| {
            let larger = footprints.get(j).filter(|other| j != i && other.area_m2() > footprint.area_m2());
            larger.is_some_and(|other| other.contains(pos))
        });
        if let Some(outer) = outer.and_then(|j| buildings.get(j)) {
            log.note(building.id, Some(pos), format!("a building stands inside {}: both are kept", outer.id));
        }
    }
}
