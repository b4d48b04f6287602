//! Things with a name, and where a visit begins.

use std::collections::{BTreeMap, HashSet};

use glam::DVec2;
use veduta_city::{
    CityGraph, Finding, GridPos, House, Id, LinkKind, ObjectShell, Opening, Place, PlaceKind, PlanObject, Severity, StreetClass,
    Styles, SurfaceKind, Viewpoint,
};

use super::extent::Extent;
use super::objects::{Site, about};
use super::{outline, streets};
use crate::mesh::radius_m;

/// The graph's places, then named houses, squares and streets that have none yet.
pub(super) fn places(graph: &CityGraph, houses: &[House], styles: &Styles) -> Vec<Place> {
    let mut list = List::default();
    graph.places.iter().for_each(|p| list.add(p.clone()));
    for house in houses.iter().filter(|h| !h.name.is_empty()) {
        let Some(volume) = house.volumes.first() else { continue };
        let is_monument = styles.0.get(usize::from(house.style)).is_some_and(|s| {
            let tall = [Opening::LancetWindow, Opening::Slit, Opening::Blank];
            s.windows.iter().all(|w| tall.contains(w))
        });
        let kind = if is_monument { PlaceKind::Monument } else { PlaceKind::House };
        let reach = volume.footprint.area_m2().max(0.0).sqrt() / 2.0;
        list.name(kind, &house.name, volume.footprint.centroid(), reach + 15.0);
    }
    for square in graph.squares.iter().filter(|s| !s.name.is_empty()) {
        let found = outline::polygons(&square.outline, &square.holes);
        if let Some(largest) = found.iter().max_by(|a, b| a.area_m2().total_cmp(&b.area_m2())) {
            list.name(PlaceKind::Square, &square.name, largest.centroid(), largest.area_m2().max(0.0).sqrt() / 2.0 + 5.0);
        }
    }
    for (name, (_, middle)) in longest_by_name(graph) {
        list.name(PlaceKind::Street, &name, middle, 15.0);
    }
    list.places
}

/// The middle of the longest link of every street name, by name.
fn longest_by_name(graph: &CityGraph) -> BTreeMap<String, (f64, DVec2)> {
    let at = graph.node_positions();
    let mut out: BTreeMap<String, (f64, DVec2)> = BTreeMap::new();
    for link in graph.links.iter().filter(|l| matches!(l.kind, LinkKind::Street(_)) && !l.name.is_empty()) {
        let line = graph.polyline(link, &at).unwrap_or_default();
        let Some((middle, _)) = streets::middle_of(&line) else { continue };
        let length = streets::length_m(&line);
        let known = out.entry(link.name.clone()).or_insert((length, middle));
        if length > known.0 {
            *known = (length, middle);
        }
    }
    out
}

#[derive(Default)]
struct List {
    places: Vec<Place>,
    names: HashSet<String>,
    ids: HashSet<Id>,
}

impl List {
    fn add(&mut self, mut place: Place) {
        while !place.id.is_given() || !self.ids.insert(place.id) {
            place.id =
                if place.id.is_given() { Id(place.id.0.wrapping_add(1) | 1 << 63) } else { Id::from_place("place", place.pos) };
        }
        self.names.insert(place.name.clone());
        self.places.push(place);
    }

    fn name(&mut self, kind: PlaceKind, name: &str, pos: DVec2, radius_m: f64) {
        if !self.names.contains(name) {
            self.add(Place { name: name.to_owned(), kind, pos, radius_m, ..Place::default() });
        }
    }
}

/// Farthest that a start is moved; metres.
const FARTHEST_MOVE_M: f64 = 100.0;
/// Room that a visitor needs between things that stand; metres.
const ROOM_M: f64 = 0.5;
/// … and that one who was moved has to see them, if there is so much not far away; metres.
const SIGHT_M: f64 = 4.5;
const NEAR_M: f64 = 20.0;

/// Where a visit begins: the graph's own choice, else in the middle of the walkable street nearest to the city's middle, looking
/// along it; moved out of houses and what stands, back from where it looks if there is room, so that what was in the way is seen.
pub(super) fn start(
    graph: &CityGraph,
    extent: &Extent,
    site: &Site<'_>,
    objects: &[PlanObject],
    findings: &mut Vec<Finding>,
) -> Viewpoint {
    let is_meant = |v: &Viewpoint| [v.pos.x, v.pos.y, v.eye_m, v.heading_deg, v.pitch_deg].iter().all(|n| n.is_finite());
    let given = graph.start.filter(is_meant);
    let chosen = given.unwrap_or_else(|| in_the_midst(graph, extent, site));
    let discs = objects.iter().map(|o| (o.pos.to_metres(), radius_m(&ObjectShell::of(o))));
    let near: Vec<_> = discs.filter(|(middle, r)| middle.distance(chosen.pos) < FARTHEST_MOVE_M + r + SIGHT_M).collect();
    let is_free = |pos: DVec2, room_m: f64| site.is_free(pos) && near.iter().all(|(o, r)| o.distance(pos) >= r + room_m);
    if is_free(chosen.pos, ROOM_M) {
        return chosen;
    }
    let is_dry =
        |pos: DVec2| site.deck(pos).is_some() || site.surface(pos).is_some_and(|(surface, _)| surface != SurfaceKind::Water);
    let place = |room_m: f64, within_m: f64| {
        let mut places = about(chosen.pos, chosen.heading_deg + 180.0, within_m);
        places.find(|&pos| is_free(pos, room_m) && is_dry(pos))
    };
    let found = place(SIGHT_M, NEAR_M).or_else(|| place(ROOM_M, FARTHEST_MOVE_M));
    let Some(pos) = found else { return chosen };
    if given.is_some() && !site.is_free(chosen.pos) {
        let message = "start: it lay inside a house and was moved to free ground";
        findings.push(Finding::new(Severity::Repaired, Id::NONE, Some(chosen.pos), message));
    }
    Viewpoint { pos, ..chosen }
}

/// The middle of the walkable street nearest to the city's middle; the city's middle if there is none.
fn in_the_midst(graph: &CityGraph, extent: &Extent, site: &Site<'_>) -> Viewpoint {
    let middle = extent.middle();
    let at = graph.node_positions();
    let stand = |link: &veduta_city::Link| {
        let walk = matches!(link.kind, LinkKind::Street(class) if class != StreetClass::Motorway) && link.layer >= 0;
        let (pos, dir) = streets::middle_of(&graph.polyline(link, &at).filter(|_| walk)?)?;
        (extent.holds(GridPos::from_metres(pos)) && site.is_free(pos)).then_some((pos, dir))
    };
    let best = graph.links.iter().filter_map(stand).min_by(|a, b| a.0.distance(middle).total_cmp(&b.0.distance(middle)));
    let Some((pos, dir)) = best else { return Viewpoint { pos: middle, ..Viewpoint::default() } };
    let heading_deg = libm::round(libm::atan2(dir.x, dir.y).to_degrees().rem_euclid(360.0));
    Viewpoint { pos, heading_deg, ..Viewpoint::default() }
}
