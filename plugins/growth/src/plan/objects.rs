//! What stands in the streets: given objects, moved out of walls; lamps and trees where a graph has none.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{
    BlockKind, CityGraph, Finding, GridPos, Id, Link, LinkKind, ObjectKind, PlanObject, Severity, StandingObject, StreetClass,
    SurfaceKind,
};

use super::facing::{BodyRef, HEADROOM_M};
use super::ground::Ground;
use super::index::Index;
use super::{Area, streets};

/// Farthest that an object is moved out of a house; metres.
const FARTHEST_MOVE_M: f64 = 3.0;
/// Distance between lamps along a street; metres.
const LAMP_STEP_M: f64 = 25.0;
/// Lamps keep this far from doors; metres.
const DOOR_CLEAR_M: f64 = 1.6;
/// Distance between grown trees; metres.
const TREE_STEP_M: f64 = 9.0;
/// A graph with fewer objects than one in so many metres of street gets lamps and trees.
const SPARSE_M: f64 = 120.0;
/// Most objects that are grown.
const MOST_GROWN: usize = 50_000;
/// Tallest object that is meant; metres.
const TALLEST_M: f64 = 200.0;

/// What lies and stands, for questions about places.
pub(super) struct Site<'a> {
    pub ground: &'a Ground,
    pub standing: &'a Index<(BodyRef, f64)>,
    pub doorsteps: &'a Index<()>,
}

impl Site<'_> {
    /// Whether a position is outside of all houses.
    pub fn is_free(&self, pos: DVec2) -> bool {
        self.standing.at(GridPos::from_metres(pos)).all(|(_, bottom)| *bottom >= HEADROOM_M)
    }

    /// Whether a disc about a position is outside of all houses, by its rim.
    fn is_free_about(&self, pos: DVec2, radius_m: f64) -> bool {
        let rim = |i: usize| pos + compass(f64::from(i as u32) * 45.0) * radius_m;
        self.is_free(pos) && (0..8).all(|i| self.is_free(rim(i)))
    }

    /// The nearest free position within a distance, in rings of 25 cm.
    pub fn nearest_free(&self, pos: DVec2, within_m: f64) -> Option<DVec2> {
        if self.is_free(pos) {
            return Some(pos);
        }
        let rings = (1..=(within_m / 0.25) as u32).map(|r| f64::from(r) * 0.25);
        let mut about = rings.flat_map(|r| (0..16).map(move |i| pos + compass(f64::from(i) * 22.5) * r));
        about.find(|&p| self.is_free(p))
    }

    /// What lies at a position, and how high.
    pub fn surface(&self, pos: DVec2) -> Option<(SurfaceKind, i32)> {
        self.ground.at(GridPos::from_metres(pos)).next().copied()
    }
}

/// Unit vector of a heading in degrees clockwise from north.
pub(super) fn compass(degrees: f64) -> DVec2 {
    let angle = degrees.to_radians();
    DVec2::new(libm::sin(angle), libm::cos(angle))
}

/// Height of an object that gives none, metres.
fn own_height_m(kind: ObjectKind, draw: Draw) -> f64 {
    match kind {
        ObjectKind::Lamp => 4.2,
        ObjectKind::Tree => draw.between("height", 8.0, 12.0),
        ObjectKind::Conifer => draw.between("height", 10.5, 13.5),
        ObjectKind::Bench | ObjectKind::Bollard => 0.9,
        ObjectKind::Fountain => 2.5,
        ObjectKind::Statue => 4.0,
        ObjectKind::TramStop | ObjectKind::Well => 3.0,
        ObjectKind::Kiosk => 2.8,
        ObjectKind::Column => 3.2,
        ObjectKind::Bin => 1.0,
    }
}

fn placed(object: &StandingObject, seed: u64, site: &Site<'_>) -> PlanObject {
    let draw = Draw::new(seed, object.id, "object");
    let height =
        if object.height_m > 0.0 && object.height_m <= TALLEST_M { object.height_m } else { own_height_m(object.kind, draw) };
    let heading = if object.heading_deg.is_finite() { object.heading_deg } else { 0.0 };
    PlanObject {
        id: object.id,
        kind: object.kind,
        pos: GridPos::from_metres(object.pos),
        z: site.surface(object.pos).map_or(0, |(_, z)| z),
        heading: libm::round(heading.rem_euclid(360.0)) as u16 % 360,
        height: GridPos::steps(height).max(1),
        monument: None,
    }
}

/// All objects of the city: the graph's in order, then lamps and trees of parks where it has few, and the trees of yards, which
/// no map knows.
pub(super) fn objects(graph: &CityGraph, areas: &[Area<'_>], site: &Site<'_>, findings: &mut Vec<Finding>) -> Vec<PlanObject> {
    let mut out = Vec::new();
    for object in &graph.objects {
        if site.surface(object.pos).is_none() {
            let message = "object: it stands beyond the edge of the city";
            findings.push(Finding::new(Severity::Dropped, object.id, Some(object.pos), message));
            continue;
        }
        match site.nearest_free(object.pos, FARTHEST_MOVE_M) {
            Some(pos) if pos == object.pos => out.push(placed(object, graph.seed, site)),
            Some(pos) => {
                let message = format!("object: it stood inside a house and was moved by {:.1} m", pos.distance(object.pos));
                findings.push(Finding::new(Severity::Repaired, object.id, Some(object.pos), message));
                out.push(placed(&StandingObject { pos, ..object.clone() }, graph.seed, site));
            }
            None => {
                let message = "object: it stands inside a house, farther than 3 m from free ground";
                findings.push(Finding::new(Severity::Dropped, object.id, Some(object.pos), message));
            }
        }
    }
    let at = graph.node_positions();
    let length: f64 = graph.links.iter().filter_map(|l| graph.polyline(l, &at)).map(|l| streets::length_m(&l)).sum();
    let mut grown = Vec::new();
    if (graph.objects.len() as f64) < length / SPARSE_M {
        grown.extend(lamps(graph, site));
        grown.extend(trees(graph, areas, &LAWN, site));
    }
    grown.extend(trees(graph, areas, &YARD, site));
    if grown.len() > MOST_GROWN {
        let message = format!("{} lamps and trees would be grown: {MOST_GROWN} are", grown.len());
        findings.push(Finding::new(Severity::Note, Id::NONE, None, message));
        grown.truncate(MOST_GROWN);
    }
    let mut seen: std::collections::HashSet<Id> = out.iter().map(|o| o.id).collect();
    grown.retain(|o| seen.insert(o.id));
    out.par_extend(grown.par_iter().map(|o| placed(o, graph.seed, site)));
    out
}

fn grown(kind: ObjectKind, name: &str, pos: DVec2, heading_deg: f64) -> StandingObject {
    StandingObject {
        id: Id::from_place(name, pos),
        kind,
        pos,
        heading_deg,
        height_m: 0.0,
        name: String::new(),
        monument: String::new(),
    }
}

/// Lamps along streets, on alternating sides.
fn lamps(graph: &CityGraph, site: &Site<'_>) -> Vec<StandingObject> {
    let at = graph.node_positions();
    let of_link = |link: &Link| {
        let mut out: Vec<StandingObject> = Vec::new();
        let LinkKind::Street(class) = link.kind else { return out };
        let width = streets::width_m(link);
        if link.layer < 0 || matches!(class, StreetClass::Path | StreetClass::Steps | StreetClass::Motorway) || width < 3.0 {
            return out;
        }
        let line = graph.polyline(link, &at).unwrap_or_default();
        let offset = (width / 2.0 - if streets::pavement_m(class, width) > 0.0 { 0.7 } else { 0.45 }).max(0.5);
        let count = (streets::length_m(&line) / LAMP_STEP_M) as usize;
        for i in 0..count.min(MOST_GROWN) {
            let Some((p, dir)) = streets::along(&line, (i as f64 + 0.5) * LAMP_STEP_M) else { continue };
            let side = if i % 2 == 0 { dir.perp() } else { -dir.perp() };
            // Nearer to the middle where a house stands in the way, and a little along where a door does.
            let wishes = [0.0, 2.2, -2.2].into_iter().flat_map(|s| [0.0, 0.4, 0.8, 1.2].map(|o| (s, o)));
            let stand = wishes.map(|(s, o)| p + dir * s + side * (offset - o).max(0.3)).find(|&q| may_light(q, class, site));
            if let Some(q) = stand {
                let heading = libm::atan2(-side.x, -side.y).to_degrees();
                out.push(grown(ObjectKind::Lamp, "grown lamp", q, heading));
            }
        }
        out
    };
    graph.links.par_iter().map(of_link).flatten_iter().collect()
}

fn may_light(pos: DVec2, class: StreetClass, site: &Site<'_>) -> bool {
    let Some((surface, z)) = site.surface(pos) else { return false };
    let on_carriageway = class.has_carriageway() && surface == SurfaceKind::Asphalt && z == 0;
    let near = |d: DVec2| veduta_city::GridPolygon::simple(vec![GridPos::from_metres(d)]);
    let in_doorway = !site.doorsteps.near(&near(pos), DOOR_CLEAR_M).is_empty();
    surface.is_public() && !on_carriageway && !in_doorway && site.is_free_about(pos, 0.3)
}

/// Where trees are grown, and how close.
struct Stand {
    block: BlockKind,
    surface: SurfaceKind,
    /// Share of the squares of [`TREE_STEP_M`] that have one.
    chance: f64,
    /// Free ground about a trunk, metres.
    clear_m: f64,
}

/// Lawns of parks: about a tree in 150 m².
const LAWN: Stand = Stand { block: BlockKind::Park, surface: SurfaceKind::Grass, chance: 0.55, clear_m: 2.0 };
/// Yards wide enough for a crown.
const YARD: Stand = Stand { block: BlockKind::Built, surface: SurfaceKind::Yard, chance: 0.4, clear_m: 3.2 };

fn trees(graph: &CityGraph, areas: &[Area<'_>], stand: &Stand, site: &Site<'_>) -> Vec<StandingObject> {
    let of_area = |area: &Area<'_>| {
        let mut out = Vec::new();
        if area.block.kind != stand.block {
            return out;
        }
        for (lo, hi) in area.polygons.iter().filter_map(|p| p.bounds()) {
            let (lo, hi) = ((lo.to_metres() / TREE_STEP_M).floor(), (hi.to_metres() / TREE_STEP_M).ceil());
            if (hi - lo).x * (hi - lo).y > 4.0 * MOST_GROWN as f64 {
                continue;
            }
            for j in lo.y as i64..hi.y as i64 {
                for i in lo.x as i64..hi.x as i64 {
                    let corner = DVec2::new(i as f64, j as f64) * TREE_STEP_M;
                    let draw = Draw::new(graph.seed, Id::from_place("tree square", corner + 0.25), "trees");
                    if !draw.chance("tree", stand.chance) {
                        continue;
                    }
                    let pos = corner + TREE_STEP_M * DVec2::new(draw.between("x", 0.15, 0.85), draw.between("y", 0.15, 0.85));
                    let is_soil = || site.surface(pos).is_some_and(|(s, _)| s == stand.surface);
                    if area.holds(GridPos::from_metres(pos)) && is_soil() && site.is_free_about(pos, stand.clear_m) {
                        let kind = if draw.chance("conifer", 0.12) { ObjectKind::Conifer } else { ObjectKind::Tree };
                        out.push(grown(kind, "grown tree", pos, draw.between("heading", 0.0, 360.0)));
                    }
                }
            }
        }
        out
    };
    areas.par_iter().map(of_area).flatten_iter().collect()
}
