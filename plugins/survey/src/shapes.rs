//! Areas: closed ways and multipolygon relations with tags, as polygons in plan metres.

use std::collections::BTreeSet;

use glam::DVec2;
use veduta_city::{Id, Severity};

use crate::extent::Extent;
use crate::log::Log;
use crate::osm::{MemberKind, OsmData, Relation, Tags, Way, relation_id, way_id};
use crate::polygon::{Polygon, intersection};
use crate::rings::{Assembly, Piece, assemble};

/// What an area is taken for, the first that fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Use {
    Building,
    Part,
    Square,
    Water,
    Park,
    /// Land that is no building ground: fields, tracks, parking.
    Open,
    /// A parcel of land that one house may stand on.
    Plot,
    /// A block that houses stand on, drawn as such.
    Block,
    /// A named or standing thing that happens to be drawn as an area.
    Thing,
}

/// An area of the map.
#[derive(Debug)]
pub(crate) struct Area<'a> {
    pub id: Id,
    pub use_: Use,
    pub tags: &'a Tags,
    /// At least one.
    pub polygons: Vec<Polygon>,
}

impl Area<'_> {
    pub(crate) fn inner_pos(&self) -> DVec2 {
        let largest = self.polygons.iter().max_by(|a, b| a.area_m2().total_cmp(&b.area_m2()));
        largest.map_or(DVec2::ZERO, Polygon::inner_pos)
    }

    pub(crate) fn area_m2(&self) -> f64 {
        self.polygons.iter().map(Polygon::area_m2).sum()
    }
}

const PARK_LEISURE: &[&str] = &["park", "garden", "playground", "dog_park", "nature_reserve", "golf_course"];
const PARK_LANDUSE: &[&str] =
    &["grass", "forest", "cemetery", "village_green", "recreation_ground", "meadow", "flowerbed", "orchard", "vineyard"];
const PARK_NATURAL: &[&str] = &["wood", "scrub", "grassland", "heath", "shrubbery"];
const OPEN_LANDUSE: &[&str] = &[
    "farmland",
    "farmyard",
    "railway",
    "quarry",
    "allotments",
    "military",
    "construction",
    "brownfield",
    "greenfield",
    "landfill",
    "plant_nursery",
    "greenhouse_horticulture",
];

/// The key by which vector maps tell blocks; OpenStreetMap has no word for them.
pub(crate) const BLOCK_KEY: &str = "block";

/// What tags of an area say it is; `None` if nothing here takes it.
pub(crate) fn use_of(tags: &Tags) -> Option<Use> {
    if tags.has("building") && !tags.is_any("building", &["entrance", "demolished", "proposed", "razed"]) {
        return Some(Use::Building);
    }
    if tags.has("building:part") {
        return Some(Use::Part);
    }
    if tags.is("boundary", "lot") || tags.is("place", "plot") {
        return Some(Use::Plot);
    }
    if tags.is(BLOCK_KEY, "built") {
        return Some(Use::Block);
    }
    if is_square(tags) {
        return Some(Use::Square);
    }
    if tags.has("highway") || tags.has("area:highway") || tags.has("indoor") {
        return None;
    }
    if tags.is_any("natural", &["water", "bay"])
        || tags.is_any("waterway", &["riverbank", "dock"])
        || tags.is_any("landuse", &["basin", "reservoir"])
    {
        return Some(Use::Water);
    }
    if tags.is_any("leisure", PARK_LEISURE)
        || tags.is_any("landuse", PARK_LANDUSE)
        || tags.is_any("natural", PARK_NATURAL)
        || tags.is("amenity", "grave_yard")
    {
        return Some(Use::Park);
    }
    if tags.is_any("landuse", OPEN_LANDUSE)
        || tags.is_any("leisure", &["pitch", "track", "stadium", "marina", "swimming_pool"])
        || tags.is_any("amenity", &["parking", "school", "hospital", "university", "college"])
        || tags.is_any("natural", &["sand", "beach", "bare_rock", "wetland", "cliff", "scree"])
    {
        return Some(Use::Open);
    }
    let is_thing = ["amenity", "tourism", "historic", "shop", "office", "man_made", "leisure", "craft"].iter().any(|k| tags.has(k));
    is_thing.then_some(Use::Thing)
}

fn is_square(tags: &Tags) -> bool {
    tags.is("place", "square")
        || tags.is("amenity", "marketplace")
        || tags.is_any("area:highway", &["pedestrian", "footway"])
        || (tags.is_any("highway", &["pedestrian", "footway", "living_street"]) && !tags.is("area", "no") && is_area(tags))
}

/// Whether a closed highway is a surface rather than a loop.
fn is_area(tags: &Tags) -> bool {
    tags.is("area", "yes") || tags.is("type", "multipolygon")
}

/// Every area of the file, ways first, each in order of ids.
pub(crate) fn areas<'a>(data: &'a OsmData, extent: &Extent, log: &mut Log) -> Vec<Area<'a>> {
    let mut consumed = BTreeSet::new();
    let mut of_relations = Vec::new();
    for (&number, relation) in &data.relations {
        if relation.tags.is("type", "multipolygon") {
            of_relations.extend(of_relation(number, relation, data, extent, &mut consumed, log));
        }
    }
    let mut out = Vec::new();
    for (&number, way) in &data.ways {
        if !consumed.contains(&number) {
            out.extend(of_way(number, way, data, extent, log));
        }
    }
    out.extend(of_relations);
    out
}

fn of_way<'a>(number: i64, way: &'a Way, data: &'a OsmData, extent: &Extent, log: &mut Log) -> Option<Area<'a>> {
    if way.tags.is_empty() {
        return None;
    }
    let use_ = use_of(&way.tags)?;
    let id = way_id(number);
    let assembly = assemble(&[Piece { nodes: &way.nodes, is_inner: false }], data, extent);
    if !way.is_closed() && assembly.polygons.is_empty() {
        // Open lines are no areas; only what can be nothing else is missed.
        if matches!(use_, Use::Building | Use::Part) {
            log.dropped(id, place_of(way, data, extent), format!("{} is drawn with a line that does not close", words(use_)));
        }
        return None;
    }
    finish(Drawn { id, use_, tags: &way.tags, assembly, gone: 0, pos: place_of(way, data, extent) }, extent, log)
}

fn of_relation<'a>(
    number: i64,
    relation: &'a Relation,
    data: &'a OsmData,
    extent: &Extent,
    consumed: &mut BTreeSet<i64>,
    log: &mut Log,
) -> Option<Area<'a>> {
    let id = relation_id(number);
    let members = || relation.members.iter().filter(|m| m.kind == MemberKind::Way);
    let outers = || members().filter(|m| &*m.role != "inner");
    // Relations of before 2017 left their tags on the outer ways.
    let mut tags = &relation.tags;
    let mut use_ = use_of(tags);
    if use_.is_none() {
        let tagged = outers().filter_map(|m| data.ways.get(&m.id)).find(|w| use_of(&w.tags).is_some());
        tags = &tagged?.tags;
        use_ = use_of(tags);
    }
    let use_ = use_?;
    let there: Vec<_> = members().filter_map(|m| data.ways.get(&m.id).map(|w| (m, w))).collect();
    let gone = members().count() - there.len();
    let pos = there.first().and_then(|(_, way)| place_of(way, data, extent));
    let pieces: Vec<Piece<'_>> = there.iter().map(|(m, w)| Piece { nodes: &w.nodes, is_inner: &*m.role == "inner" }).collect();
    let assembly = assemble(&pieces, data, extent);
    let drawn = Drawn { id, use_, tags, assembly, gone, pos };
    let area = finish(drawn, extent, log)?;
    for member in outers() {
        let is_same = data.ways.get(&member.id).is_some_and(|w| use_of(&w.tags) == Some(use_));
        if is_same && consumed.insert(member.id) && !core::ptr::eq(tags, &relation.tags) {
            log.tally(Severity::Note, id, pos, "multipolygons with their tags on the outer way (as before 2017) were read as such");
        }
    }
    Some(area)
}

fn words(use_: Use) -> &'static str {
    match use_ {
        Use::Building => "a building",
        Use::Part => "a building part",
        Use::Square => "a square",
        Use::Water => "a water area",
        Use::Park => "a park or green",
        Use::Open => "an open area",
        Use::Plot => "a plot",
        Use::Block => "a block",
        Use::Thing => "an area",
    }
}

/// An area as it was drawn, before it is checked.
struct Drawn<'a> {
    id: Id,
    use_: Use,
    tags: &'a Tags,
    assembly: Assembly,
    /// Member ways that the file does not hold.
    gone: usize,
    pos: Option<DVec2>,
}

/// Checks what was assembled, clips wide areas to the extent and tells what was mended or lost.
fn finish<'a>(drawn: Drawn<'a>, extent: &Extent, log: &mut Log) -> Option<Area<'a>> {
    tell_lost(&drawn, log)?;
    let Drawn { id, use_, tags, assembly, gone, pos } = drawn;
    let polygons = clipped(use_, assembly.polygons, extent, || {
        log.tally(Severity::Repaired, id, pos, "water, parks and fields are cut off at the extent's border");
    });
    if polygons.is_empty() {
        log.tally(Severity::Dropped, id, pos, "areas lie outside the extent");
        return None;
    }
    let what = words(use_);
    match () {
        () if matches!(use_, Use::Open | Use::Thing) => {}
        () if assembly.missing + gone > 0 => {
            log.repaired(id, pos, format!("{what} has pieces outside the file: what closes without them is kept"));
        }
        () if assembly.open > 0 => {
            log.repaired(id, pos, format!("{what} has {} lines that do not close: they are left out", assembly.open))
        }
        () if assembly.is_mended => {
            log.repaired(id, pos, format!("{what} has an outline that crosses, touches or repeats itself: it was redrawn"));
        }
        () => {}
    }
    Some(Area { id, use_, tags, polygons })
}

/// Tells why an area cannot be kept; `Some` if it can. Rings that close without the ways that are gone are whole; a ring
/// with vertices missing is good enough for water and greens, which the extent's border cuts anyway, but not for houses.
fn tell_lost(drawn: &Drawn<'_>, log: &mut Log) -> Option<()> {
    let Drawn { id, use_, assembly, gone, pos, .. } = drawn;
    let (what, is_minor) = (words(*use_), matches!(use_, Use::Open | Use::Thing));
    let is_wide = matches!(use_, Use::Water | Use::Park | Use::Open);
    let is_torn = assembly.missing > 0 || (*gone > 0 && assembly.open > 0);
    let lost = assembly.missing + gone;
    match () {
        () if assembly.is_tiny => log.tally(Severity::Dropped, *id, *pos, "outlines of less than a square metre are left out"),
        () if (is_torn && !is_wide) || (lost > 0 && assembly.polygons.is_empty()) => match is_minor {
            true => log.tally(Severity::Dropped, *id, *pos, "areas have part of their outline outside the file"),
            false => log.dropped(*id, *pos, format!("{what} has part of its outline outside the file ({lost} vertices or ways)")),
        },
        () if assembly.polygons.is_empty() => match is_minor {
            true => log.tally(Severity::Dropped, *id, *pos, "areas have outlines that enclose nothing"),
            false => {
                log.dropped(*id, *pos, format!("{what} has an outline that encloses nothing; {} lines do not close", assembly.open))
            }
        },
        () => return Some(()),
    }
    None
}

/// The polygons as far as they belong to the extent: houses and squares whole or not at all, wide areas cut off.
fn clipped(use_: Use, mut polygons: Vec<Polygon>, extent: &Extent, on_cut: impl FnOnce()) -> Vec<Polygon> {
    if matches!(use_, Use::Building | Use::Part | Use::Thing | Use::Square | Use::Plot | Use::Block) {
        polygons.retain(|p| extent.contains(p.inner_pos()));
    } else if polygons.iter().any(|p| p.outer.iter().any(|v| !extent.contains(*v))) {
        let frame = Polygon { outer: extent.ring(), holes: Vec::new() };
        polygons = intersection(&polygons, [&frame]);
        if !polygons.is_empty() {
            on_cut();
        }
    }
    polygons
}

/// Plan position of the first vertex that the file holds.
pub(crate) fn place_of(way: &Way, data: &OsmData, extent: &Extent) -> Option<DVec2> {
    way.nodes.iter().find_map(|id| data.nodes.get(id)).map(|n| extent.plan_pos(n))
}
