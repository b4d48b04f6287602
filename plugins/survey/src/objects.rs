//! Things that stand in streets and squares.

use glam::DVec2;
use veduta_city::{Building, Id, ObjectKind, Severity, StandingObject};

use crate::buildings::{Index, footprint_of};
use crate::extent::Extent;
use crate::length;
use crate::log::Log;
use crate::osm::{OsmData, Tags, way_id};
use crate::polygon::Polygon;
use crate::shapes::{Area, Use};

/// Distance between the trees of a row that is drawn as a line, in metres.
const ROW_STEP_M: f64 = 8.0;
/// Distance from a track's middle to where people wait, in metres.
const STOP_ASIDE_M: f64 = 2.8;

/// What tags describe as standing there.
pub(crate) fn kind_of(tags: &Tags) -> Option<ObjectKind> {
    Some(match () {
        () if tags.is("natural", "tree") => tree_kind(tags),
        () if tags.is("highway", "street_lamp") || tags.is("man_made", "street_lamp") => ObjectKind::Lamp,
        () if tags.is("amenity", "bench") => ObjectKind::Bench,
        () if tags.is("amenity", "fountain") => ObjectKind::Fountain,
        () if tags.is_any("railway", &["tram_stop"]) || tags.is("highway", "bus_stop") => ObjectKind::TramStop,
        () if tags.is("barrier", "bollard") => ObjectKind::Bollard,
        () if tags.is_any("shop", &["kiosk", "newsagent"]) && !tags.has("building") && !tags.has("level") => ObjectKind::Kiosk,
        () if tags.is("man_made", "water_well") || tags.is("amenity", "drinking_water") => ObjectKind::Well,
        () if tags.is("advertising", "column") => ObjectKind::Column,
        () if tags.is("amenity", "waste_basket") => ObjectKind::Bin,
        () if is_statue(tags) => ObjectKind::Statue,
        () => return None,
    })
}

/// Genera of trees that are not just broad-leaved, as they begin in species' Latin names.
const GENERA: [(ObjectKind, &[&str]); 5] = [
    (
        ObjectKind::Conifer,
        &[
            "abies",
            "araucaria",
            "cedrus",
            "chamaecyparis",
            "cryptomeria",
            "cupressus",
            "juniperus",
            "larix",
            "metasequoia",
            "picea",
            "pinus",
            "pseudotsuga",
            "sequoia",
            "sequoiadendron",
            "taxodium",
            "taxus",
            "thuja",
            "tsuga",
        ],
    ),
    (ObjectKind::Birch, &["betula"]),
    (ObjectKind::Willow, &["salix"]),
    (
        ObjectKind::FruitTree,
        &["amelanchier", "citrus", "cornus", "crataegus", "magnolia", "malus", "olea", "prunus", "punica", "pyrus", "sorbus"],
    ),
    (
        ObjectKind::Palm,
        &["arecaceae", "butia", "chamaerops", "cocos", "phoenix", "roystonea", "sabal", "syagrus", "trachycarpus", "washingtonia"],
    ),
];
/// Cultivars that grow as columns.
const COLUMNAR: [&str; 4] = ["fastigiat", "italica", "columnar", "pyramidalis"];

/// What a tree looks like, by its species or genus, else by its leaves.
fn tree_kind(tags: &Tags) -> ObjectKind {
    let named = ["species", "taxon", "genus"].iter().find_map(|key| tags.get(key)).unwrap_or_default().to_lowercase();
    let cultivar = tags.get("taxon:cultivar").or_else(|| tags.get("cultivar")).unwrap_or_default().to_lowercase();
    let genus = named.split_whitespace().next().unwrap_or_default();
    if let Some((kind, _)) = GENERA.iter().find(|(_, genera)| genera.contains(&genus)) {
        return *kind;
    }
    if COLUMNAR.iter().any(|form| named.contains(form) || cultivar.contains(form)) {
        ObjectKind::Poplar
    } else if tags.is("leaf_type", "needleleaved") || tags.is("type", "conifer") {
        ObjectKind::Conifer
    } else if tags.is("type", "palm") || tags.is("leaf_type", "palm") {
        ObjectKind::Palm
    } else {
        ObjectKind::Tree
    }
}

/// Memorials that stand free: plaques and stumbling stones do not.
fn is_statue(tags: &Tags) -> bool {
    let flat = ["plaque", "stolperstein", "plate", "blue_plaque", "ghost_bike", "graffiti", "mural", "wall"];
    let is_flat = tags.is_any("memorial", &flat) || tags.is_any("memorial:type", &flat);
    let is_art = tags.is_any("artwork_type", &["statue", "sculpture", "bust", "stone"]);
    !is_flat
        && !tags.has("building")
        && (tags.is_any("historic", &["memorial", "monument", "wayside_cross", "wayside_shrine"])
            || (tags.is("tourism", "artwork") && is_art)
            || tags.is_any("man_made", &["obelisk", "statue"]))
}

/// Collects standing objects.
struct Collector<'a> {
    objects: Vec<StandingObject>,
    footprints: Vec<Polygon>,
    index: Index,
    extent: &'a Extent,
}

impl Collector<'_> {
    /// `heading` is the direction that the thing faces where its tags say none.
    fn add(&mut self, id: Id, kind: ObjectKind, plan_pos: DVec2, heading: DVec2, tags: &Tags, log: &mut Log) {
        if !self.extent.contains(plan_pos) {
            log.tally(Severity::Dropped, id, Some(plan_pos), "standing objects lie outside the extent");
            return;
        }
        let is_inside =
            self.index.near(plan_pos, plan_pos).into_iter().any(|i| self.footprints.get(i).is_some_and(|f| f.contains(plan_pos)));
        if is_inside {
            log.tally(Severity::Dropped, id, Some(plan_pos), format!("objects of the kind {kind:?} lie inside a building"));
            return;
        }
        self.objects.push(StandingObject {
            id,
            kind,
            pos: plan_pos,
            heading_deg: tags.get("direction").and_then(length::bearing).unwrap_or_else(|| heading_deg(heading)),
            height_m: tags.get("height").and_then(length::metres).filter(|h| (0.2..=80.0).contains(h)).unwrap_or(0.0),
            name: tags.text("name"),
            monument: String::new(),
        });
    }
}

/// Every standing object of the file.
pub(crate) fn objects(
    data: &OsmData,
    areas: &[Area<'_>],
    buildings: &[Building],
    extent: &Extent,
    log: &mut Log,
) -> Vec<StandingObject> {
    // A roof in the air has objects below it.
    let footprints: Vec<Polygon> = buildings.iter().filter(|b| b.min_height_m < 2.0).map(footprint_of).collect();
    let index = Index::new(footprints.iter());
    let mut out = Collector { objects: Vec::new(), footprints, index, extent };
    let tracks = tram_directions(data, extent);
    for (&number, node) in data.nodes.iter().filter(|(_, n)| !n.tags.is_empty()) {
        let Some(kind) = kind_of(&node.tags) else { continue };
        let id = Id::from_source(1, number as u64);
        let pos = extent.plan_pos(node);
        // People wait beside the track, facing it.
        let along = tracks.get(&number).filter(|_| kind == ObjectKind::TramStop);
        let (aside, heading) = along.map_or((DVec2::ZERO, DVec2::Y), |a| (-a.perp() * STOP_ASIDE_M, a.perp()));
        out.add(id, kind, pos + aside, heading, &node.tags, log);
    }
    for area in areas.iter().filter(|a| matches!(a.use_, Use::Thing | Use::Square | Use::Water)) {
        if let Some(kind) = kind_of(area.tags).filter(|k| !matches!(k, ObjectKind::Kiosk)) {
            out.add(area.id, kind, area.inner_pos(), DVec2::Y, area.tags, log);
        }
    }
    for (&number, way) in data.ways.iter().filter(|(_, w)| w.tags.is("natural", "tree_row")) {
        let points: Vec<DVec2> = way.nodes.iter().filter_map(|id| data.nodes.get(id)).map(|n| extent.plan_pos(n)).collect();
        let kind = tree_kind(&way.tags);
        for (i, pos) in stations(&points, ROW_STEP_M).into_iter().enumerate() {
            let id = if i == 0 { way_id(number) } else { Id::NONE };
            out.add(id, kind, pos, DVec2::Y, &way.tags, log);
        }
    }
    out.objects
}

/// Points along a polyline, both ends included, at even steps near to the one asked for.
fn stations(points: &[DVec2], step_m: f64) -> Vec<DVec2> {
    let total: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    let steps = (total / step_m).round().clamp(1.0, 2000.0);
    let (mut out, mut walked, mut next) = (Vec::new(), 0.0, 0.0);
    for pair in points.windows(2) {
        let [a, b] = pair else { continue };
        let length = a.distance(*b);
        while length > 0.0 && next <= walked + length + 1e-9 && out.len() <= steps as usize {
            out.push(a.lerp(*b, ((next - walked) / length).min(1.0)));
            next = total * out.len() as f64 / steps;
        }
        walked += length;
    }
    out
}

/// Direction of travel of tram tracks at their nodes.
fn tram_directions(data: &OsmData, extent: &Extent) -> std::collections::BTreeMap<i64, DVec2> {
    let mut out = std::collections::BTreeMap::new();
    for way in data.ways.values().filter(|w| w.tags.is("railway", "tram")) {
        for pair in way.nodes.windows(2) {
            let [a, b] = pair else { continue };
            if let (Some(from), Some(to)) = (data.nodes.get(a), data.nodes.get(b))
                && let Some(along) = (extent.plan_pos(to) - extent.plan_pos(from)).try_normalize()
            {
                out.entry(*a).or_insert(along);
                out.insert(*b, along);
            }
        }
    }
    out
}

/// Compass heading of a direction in plan.
pub(crate) fn heading_deg(direction: DVec2) -> f64 {
    libm::atan2(direction.x, direction.y).to_degrees().rem_euclid(360.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(pairs: &[(&str, &str)]) -> Option<ObjectKind> {
        kind_of(&pairs.iter().copied().collect())
    }

    #[test]
    fn things_are_told_by_their_tags() {
        assert_eq!(kind(&[("natural", "tree"), ("leaf_type", "needleleaved")]), Some(ObjectKind::Conifer));
        for (key, value, want) in [
            ("species", "Tilia cordata", ObjectKind::Tree),
            ("genus", "Betula", ObjectKind::Birch),
            ("species", "Salix babylonica", ObjectKind::Willow),
            ("species", "Prunus avium", ObjectKind::FruitTree),
            ("species", "Populus nigra 'Italica'", ObjectKind::Poplar),
            ("species", "Populus tremula", ObjectKind::Tree),
            ("species", "Taxus baccata 'Fastigiata'", ObjectKind::Conifer),
            ("species", "Cupressus sempervirens", ObjectKind::Conifer),
            ("taxon", "Phoenix dactylifera", ObjectKind::Palm),
            ("species", "Pinus sylvestris", ObjectKind::Conifer),
            ("genus", "Larix", ObjectKind::Conifer),
            ("type", "palm", ObjectKind::Palm),
        ] {
            assert_eq!(kind(&[("natural", "tree"), (key, value)]), Some(want), "{key}={value}");
        }
        assert_eq!(kind(&[("highway", "street_lamp")]), Some(ObjectKind::Lamp));
        assert_eq!(kind(&[("historic", "memorial")]), Some(ObjectKind::Statue));
        assert_eq!(kind(&[("historic", "memorial"), ("memorial", "stolperstein")]), None);
        assert_eq!(kind(&[("tourism", "artwork"), ("artwork_type", "mural")]), None);
        assert_eq!(kind(&[("amenity", "post_box")]), None);
    }

    #[test]
    fn a_row_has_trees_at_both_ends_and_even_steps() {
        let row = stations(&[DVec2::ZERO, DVec2::new(20.0, 0.0), DVec2::new(20.0, 12.0)], 8.0);
        assert_eq!(row.len(), 5);
        assert_eq!((row[0], row[4]), (DVec2::ZERO, DVec2::new(20.0, 12.0)));
        assert!(row.windows(2).all(|w| (w[0].distance(w[1]) - 8.0).abs() < 0.5 || w[1].x == 20.0), "{row:?}");
        assert!(stations(&[DVec2::ZERO], 8.0).is_empty());
    }

    #[test]
    fn headings_turn_clockwise_from_north() {
        assert_eq!([DVec2::Y, DVec2::X, -DVec2::Y, -DVec2::X].map(heading_deg), [0.0, 90.0, 180.0, 270.0]);
    }
}
