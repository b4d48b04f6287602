//! Things with a name.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{Id, Place, PlaceKind};

use crate::extent::Extent;
use crate::log::Log;
use crate::osm::{OsmData, Tags};
use crate::shapes::{Area, Use};

/// Places of one name nearer to each other than this are one, in metres: a church and its point of interest.
const SAME_PLACE_M: f64 = 60.0;

/// Settlements by how well they name a city.
const SETTLEMENTS: [&str; 8] = ["city", "town", "village", "borough", "suburb", "quarter", "hamlet", "neighbourhood"];

/// How many of them, from the first, are no part of another.
const WHOLE_SETTLEMENTS: usize = 3;

/// What kind of place tags describe; `None` if it is none that visitors look for.
pub(crate) fn kind_of(tags: &Tags) -> Option<PlaceKind> {
    let sacred = ["place_of_worship", "monastery"];
    let monument_buildings =
        ["church", "cathedral", "chapel", "mosque", "synagogue", "temple", "tower", "castle", "basilica", "monastery", "palace"];
    Some(match () {
        () if tags.is("tourism", "viewpoint") => PlaceKind::Viewpoint,
        () if tags.has("historic")
            || tags.is_any("amenity", &sacred)
            || tags.is("amenity", "fountain")
            || tags.is_any("building", &monument_buildings)
            || tags.is_any("tourism", &["attraction", "artwork"])
            || tags.is_any("man_made", &["tower", "obelisk", "lighthouse"]) =>
        {
            PlaceKind::Monument
        }
        () if tags.is("place", "square") || tags.is("amenity", "marketplace") => PlaceKind::Square,
        () if tags.has("shop") || tags.has("craft") || tags.has("office") => PlaceKind::Shop,
        () if tags.is_any(
            "amenity",
            &[
                "restaurant",
                "cafe",
                "bar",
                "pub",
                "fast_food",
                "ice_cream",
                "pharmacy",
                "bank",
                "post_office",
                "biergarten",
                "food_court",
            ],
        ) || tags.is_any("tourism", &["hotel", "hostel", "guest_house", "information"]) =>
        {
            PlaceKind::Shop
        }
        () if tags.has("building") => PlaceKind::House,
        () if tags.is("railway", "station") || tags.is("railway", "tram_stop") || tags.is("railway", "halt") => PlaceKind::Other,
        () if tags.is_any("place", &["neighbourhood", "quarter", "suburb", "locality", "island", "islet"]) => PlaceKind::Other,
        () if ["amenity", "tourism", "leisure"].iter().any(|k| tags.has(k)) || tags.is("natural", "water") => PlaceKind::Other,
        () => return None,
    })
}

/// Which of two entries of one place stays: the weightier kind.
fn rank(kind: PlaceKind) -> u8 {
    match kind {
        PlaceKind::Monument => 0,
        PlaceKind::Square => 1,
        PlaceKind::Viewpoint => 2,
        PlaceKind::House => 3,
        PlaceKind::Shop => 4,
        PlaceKind::Street | PlaceKind::Other => 5,
    }
}

fn place(id: Id, kind: PlaceKind, plan_pos: DVec2, area_m2: f64, tags: &Tags) -> Place {
    let built = tags.text("start_date");
    let built = if built.is_empty() { built } else { format!("Since {built}.") };
    let text = [tags.text("description"), built].into_iter().filter(|t| !t.is_empty()).collect::<Vec<_>>().join(" ");
    let radius_m = Place::default_radius_m().max(libm::sqrt(area_m2)).min(150.0);
    Place { id, name: tags.text("name"), kind, pos: plan_pos, radius_m, text, view: None }
}

/// Every named place of the file inside the extent, one for each name and neighbourhood.
pub(crate) fn places(data: &OsmData, areas: &[Area<'_>], extent: &Extent, log: &mut Log) -> Vec<Place> {
    let mut all = Vec::new();
    for area in areas {
        if area.tags.get("name").is_none() {
            continue;
        }
        let kind = kind_of(area.tags).or((area.use_ == Use::Square).then_some(PlaceKind::Square));
        let kind = kind.or(matches!(area.use_, Use::Park | Use::Water).then_some(PlaceKind::Other));
        if let Some(kind) = kind {
            all.push(place(area.id, kind, area.inner_pos(), area.area_m2(), area.tags));
        }
    }
    for (&number, node) in data.nodes.iter().filter(|(_, n)| n.tags.get("name").is_some()) {
        let pos = extent.plan_pos(node);
        if let Some(kind) = kind_of(&node.tags).filter(|_| extent.contains(pos)) {
            all.push(place(Id::from_source(1, number as u64), kind, pos, 0.0, &node.tags));
        }
    }
    all.retain(|p| !p.name.is_empty());
    all.sort_by_key(|p| rank(p.kind));
    let mut by_name: BTreeMap<String, Vec<DVec2>> = BTreeMap::new();
    let n = all.len();
    all.retain(|p| {
        let known = by_name.entry(p.name.clone()).or_default();
        let is_new = known.iter().all(|k| k.distance(p.pos) > SAME_PLACE_M);
        known.push(p.pos);
        is_new
    });
    if all.len() < n {
        log.note(Id::NONE, None, format!("{} places repeat the name of a place next to them: told once", n - all.len()));
    }
    all
}

/// Name of the city that the map shows: its city, town or village; else what most addresses say; else a quarter of it.
pub(crate) fn settlement(data: &OsmData, extent: &Extent) -> Option<String> {
    let reach_m = (extent.high - extent.low).max_element().max(1000.0);
    let mut best: Option<(usize, f64, String)> = None;
    for node in data.nodes.values().filter(|n| n.tags.get("name").is_some()) {
        let Some(rank) = node.tags.get("place").and_then(|p| SETTLEMENTS.iter().position(|&s| s == p)) else { continue };
        let away = extent.plan_pos(node).length();
        // A settlement further off than the map is wide is another one.
        if away <= reach_m && best.as_ref().is_none_or(|b| (rank, away) < (b.0, b.1)) {
            best = Some((rank, away, node.tags.text("name")));
        }
    }
    let whole = best.as_ref().filter(|(rank, ..)| *rank < WHOLE_SETTLEMENTS).map(|b| b.2.clone());
    whole.or_else(|| city_of_addresses(data, extent)).or(best.map(|b| b.2)).filter(|name| !name.is_empty())
}

/// The city that most addresses name, if more than a few do.
fn city_of_addresses(data: &OsmData, extent: &Extent) -> Option<String> {
    let is_here = |node: &crate::osm::Node| extent.contains(extent.plan_pos(node));
    let nodes = data.nodes.values().filter(|n| !n.tags.is_empty() && is_here(n)).map(|n| &n.tags);
    let ways = data.ways.values().filter(|w| w.nodes.first().and_then(|id| data.nodes.get(id)).is_some_and(is_here));
    let tags = nodes.chain(ways.map(|w| &w.tags));
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    tags.filter(|t| t.has("addr:city")).for_each(|t| *counts.entry(t.text("addr:city")).or_default() += 1);
    let (name, times) = counts.into_iter().max_by(|a, b| a.1.cmp(&b.1).then_with(|| b.0.cmp(&a.0)))?;
    (times >= 5).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::{Bounds, Tags};

    #[test]
    fn kinds_follow_tags() {
        let kind = |pairs: &[(&str, &str)]| kind_of(&pairs.iter().copied().collect::<Tags>());
        assert_eq!(kind(&[("building", "church"), ("name", "x")]), Some(PlaceKind::Monument));
        assert_eq!(kind(&[("amenity", "cafe")]), Some(PlaceKind::Shop));
        assert_eq!(kind(&[("building", "yes")]), Some(PlaceKind::House));
        assert_eq!(kind(&[("building", "yes"), ("shop", "bakery")]), Some(PlaceKind::Shop));
        assert_eq!(kind(&[("highway", "residential")]), None);
    }

    #[test]
    fn one_name_next_door_is_one_place_and_the_city_names_itself() {
        let mut data = OsmData { bounds: Some(Bounds { south: 0.0, west: 0.0, north: 0.01, east: 0.01 }), ..OsmData::default() };
        let named = |name, key, value| -> Tags { [("name", name), (key, value)].into_iter().collect() };
        data.add_node(1, 0.005, 0.005, named("St John", "amenity", "place_of_worship"));
        data.add_node(2, 0.0051, 0.005, named("St John", "tourism", "information"));
        data.add_node(3, 0.009, 0.005, named("St John", "amenity", "pub"));
        data.add_node(4, 0.001, 0.001, named("Hamletville", "place", "hamlet"));
        data.add_node(5, 0.002, 0.001, named("Townsville", "place", "town"));
        let (mut log, mut other) = (Log::default(), Log::default());
        let extent = Extent::of(&data, &mut other).unwrap();
        let places = places(&data, &[], &extent, &mut log);
        assert_eq!(places.iter().map(|p| p.kind).collect::<Vec<_>>(), [PlaceKind::Monument, PlaceKind::Shop]);
        assert_eq!(settlement(&data, &extent).as_deref(), Some("Townsville"));
    }
}
