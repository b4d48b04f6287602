//! What stands in the streets: given objects, moved out of walls, and what rules put where a graph has none.

use glam::DVec2;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use veduta_city::draw::Draw;
use veduta_city::{
    CityGraph, Finding, FurnitureRule, GridPos, Id, ObjectKind, PlanObject, PlanTerrain, Severity, StandingObject, SurfaceKind,
};

use super::facing::HEADROOM_M;
use super::furniture::{Furnisher, Piece, Taken};
use super::ground::Ground;
use super::massing::{HEIGHT_STEP, even};
use super::network::Network;
use super::spans::Decks;
use super::walls::{Doorsteps, Standing};
use super::{Area, streets};

/// Farthest that an object is moved out of a house; metres.
const FARTHEST_MOVE_M: f64 = 3.0;
/// … and out of the water.
const FARTHEST_BANK_M: f64 = 8.0;
/// A graph with fewer objects than one in so many metres of street is furnished.
const SPARSE_M: f64 = 120.0;
/// Most objects that are grown: more than a city of 500 km² has.
const MOST_GROWN: usize = 2_000_000;
/// Most of a rule's wishes that are looked at before what they gave is placed.
const AT_ONCE: usize = 1 << 14;
/// From the top of a bridge to its underside, metres.
const DECK_M: f64 = 1.2;
/// Ways so far below the ground lie in ramps, and their walls reach so far; metres.
const DEEP_M: f64 = 0.3;
const BESIDE_RAMP_M: f64 = 0.7;
/// Tallest object that is meant; metres.
const TALLEST_M: f64 = 200.0;

/// What lies and stands, for questions about places.
pub(super) struct Site<'a> {
    pub terrain: &'a PlanTerrain,
    pub ground: &'a Ground<'a>,
    pub decks: &'a Decks<'a>,
    pub standing: &'a Standing,
    pub doorsteps: &'a Doorsteps,
}

impl Site<'_> {
    /// Whether a position is outside of all houses.
    pub fn is_free(&self, pos: DVec2) -> bool {
        self.standing.at(GridPos::from_metres(pos)).all(|&hangs_m| hangs_m >= HEADROOM_M)
    }

    /// Whether a disc about a position is outside of all houses, by its rim.
    pub fn is_free_about(&self, pos: DVec2, radius_m: f64) -> bool {
        disc(pos, radius_m).all(|p| self.is_free(p))
    }

    /// The nearest free position within a distance.
    pub fn nearest_free(&self, pos: DVec2, within_m: f64) -> Option<DVec2> {
        if self.is_free(pos) { Some(pos) } else { about(pos, 0.0, within_m).find(|&p| self.is_free(p)) }
    }

    /// Where something goes that stands in the water or on a ramp and is not meant to: the nearest free place on land. `None` if it may stay,
    /// or there is no such place near. What stands on a bridge stays there.
    fn bank(&self, object: &StandingObject) -> Option<DVec2> {
        let may_be_wet = object.kind == ObjectKind::Fountain || !object.monument.is_empty();
        let lies = |pos: DVec2, kind: SurfaceKind| self.surface(pos).is_some_and(|(surface, _)| surface == kind);
        let is_wet = |pos: DVec2| !may_be_wet && lies(pos, SurfaceKind::Water) && self.deck(pos).is_none();
        let is_open = |pos: DVec2| lies(pos, SurfaceKind::Opening) && (object.kind != ObjectKind::Lamp || self.deck(pos).is_none());
        let is_off = |pos: DVec2| is_wet(pos) || (!self.decks.is_none() && disc(pos, object.kind.radius_m()).any(is_open));
        if !is_off(object.pos) {
            return None;
        }
        let is_land = |p: DVec2| self.surface(p).is_some() && !is_off(p);
        let places = || about(object.pos, 0.0, FARTHEST_BANK_M).filter(|&p| is_land(p));
        let has_room = |&p: &DVec2| self.is_free_about(p, object.kind.radius_m());
        places().find(has_room).or_else(|| places().find(|&p| self.is_free(p)))
    }

    /// The foot of something round above the city's zero, grid steps: on slopes the lowest ground under it, so that it hangs nowhere.
    fn foot(&self, pos: DVec2, radius_m: f64) -> i32 {
        if let Some((_, height)) = self.deck(pos) {
            return GridPos::steps(height);
        }
        let above = self.surface(pos).map_or(0, |(_, z)| z);
        if self.terrain.is_level() {
            return above;
        }
        let rim = EIGHT_WINDS.into_iter().step_by(2).map(|wind| self.terrain.height_m(pos + wind * radius_m));
        let lowest = rim.fold(self.terrain.height_m(pos), f64::min);
        above.saturating_add(GridPos::steps(lowest))
    }

    /// What lies on a bridge at a position, and how high above the city's zero, metres: of bridges over water, or so low that nobody
    /// walks under them.
    pub fn deck(&self, pos: DVec2) -> Option<(SurfaceKind, f64)> {
        let (surface, height) = self.decks.surface(pos)?;
        let is_wet = self.surface(pos).is_some_and(|(below, _)| below == SurfaceKind::Water);
        (is_wet || height - self.terrain.height_m(pos) < HEADROOM_M).then_some((surface, height))
    }

    /// Whether something that reaches so far and so high would meet a bridge that leads over it, or the wall of a ramp beside it.
    pub fn meets_span(&self, pos: DVec2, reach_m: f64, top_m: f64) -> bool {
        let heights = |p: DVec2| {
            let ground = self.terrain.height_m(p);
            self.decks.heights_at(p).map(move |height| height - ground)
        };
        let is_low = |p: DVec2| heights(p).any(|height| (HEADROOM_M..top_m + DECK_M).contains(&height));
        let is_ramp = |p: DVec2| heights(p).any(|height| height < -DEEP_M);
        let rings = [reach_m / 2.0, reach_m].into_iter().flat_map(|r| EIGHT_WINDS.map(|wind| pos + wind * r));
        !self.decks.is_none()
            && (core::iter::once(pos).chain(rings).any(is_low)
                || (self.deck(pos).is_none()
                    && EIGHT_WINDS.into_iter().any(|wind| is_ramp(pos + wind * (reach_m + BESIDE_RAMP_M)))))
    }

    /// What lies at a position, bridges aside, and how high above the terrain.
    pub fn surface(&self, pos: DVec2) -> Option<(SurfaceKind, i32)> {
        self.ground.at(GridPos::from_metres(pos)).next().copied()
    }
}

/// Unit vectors to the north, the north-east and so on.
const EIGHT_WINDS: [DVec2; 8] = {
    const D: f64 = core::f64::consts::FRAC_1_SQRT_2;
    [
        DVec2::new(0.0, 1.0),
        DVec2::new(D, D),
        DVec2::new(1.0, 0.0),
        DVec2::new(D, -D),
        DVec2::new(0.0, -1.0),
        DVec2::new(-D, -D),
        DVec2::new(-1.0, 0.0),
        DVec2::new(-D, D),
    ]
};

/// A position and eight on the rim of a disc about it.
fn disc(pos: DVec2, radius_m: f64) -> impl Iterator<Item = DVec2> {
    core::iter::once(pos).chain(EIGHT_WINDS.map(|wind| pos + wind * radius_m))
}

/// Positions about another within a distance, in rings of 25 cm, each from a heading on.
pub(super) fn about(pos: DVec2, first_deg: f64, within_m: f64) -> impl Iterator<Item = DVec2> {
    let rings = (1..=(within_m / 0.25) as u32).map(|r| f64::from(r) * 0.25);
    rings.flat_map(move |r| (0..16).map(move |i| pos + compass(first_deg + f64::from(i) * 22.5) * r))
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
        ObjectKind::Poplar => draw.between("height", 12.0, 17.0),
        ObjectKind::Birch => draw.between("height", 8.0, 12.0),
        ObjectKind::Willow => draw.between("height", 7.5, 10.5),
        ObjectKind::FruitTree => draw.between("height", 3.8, 5.6),
        ObjectKind::Palm => draw.between("height", 6.5, 11.0),
        ObjectKind::Bench | ObjectKind::Bollard => 0.9,
        ObjectKind::Signals => 3.4,
        ObjectKind::Sign => 2.6,
        ObjectKind::Hedge => 0.95,
        ObjectKind::Planter => 1.1,
        ObjectKind::Shrub => draw.between("height", 0.9, 1.7),
        ObjectKind::Fountain => 2.5,
        ObjectKind::Statue => 4.0,
        ObjectKind::TramStop | ObjectKind::Well => 3.0,
        ObjectKind::Kiosk => 2.8,
        ObjectKind::Parasol => 2.7,
        ObjectKind::Column => 3.2,
        ObjectKind::Bin => 1.0,
    }
}

/// What a map tells of an object, at a place.
fn piece(object: &StandingObject, pos: DVec2) -> Piece<'_> {
    let &StandingObject { id, kind, heading_deg, height_m, ref monument, .. } = object;
    Piece { id, kind, pos, heading_deg, height_m, monument }
}

fn placed(object: &Piece<'_>, seed: u64, site: &Site<'_>) -> PlanObject {
    let draw = Draw::new(seed, object.id, "object");
    let height =
        if object.height_m > 0.0 && object.height_m <= TALLEST_M { object.height_m } else { own_height_m(object.kind, draw) };
    let heading = if object.heading_deg.is_finite() { object.heading_deg } else { 0.0 };
    PlanObject {
        id: object.id,
        kind: object.kind,
        pos: GridPos::on_plan(object.pos),
        z: site.foot(object.pos, object.kind.radius_m()),
        heading: libm::round(heading.rem_euclid(360.0)) as u16 % 360,
        height: even(height).max(HEIGHT_STEP),
        monument: None,
    }
}

/// All objects of the city: the graph's in order, then what rules put, where it has few or where no map ever has; and what is to stand
/// as a monument again, as the graph and the rules have it.
pub(super) fn objects<'a>(
    graph: &'a CityGraph,
    areas: &[Area<'_>],
    (network, rules): (&Network<'_>, &'a [FurnitureRule]),
    site: &Site<'_>,
    findings: &mut Vec<Finding>,
) -> (Vec<PlanObject>, Vec<Piece<'a>>) {
    let mut out = Vec::new();
    for object in &graph.objects {
        if site.surface(object.pos).is_none() {
            let message = "object: it stands beyond the edge of the city";
            findings.push(Finding::new(Severity::Dropped, object.id, Some(object.pos), message));
            continue;
        }
        if let Some(pos) = site.bank(object) {
            let message = format!("object: it stood in water or over a ramp and was moved by {:.1} m", pos.distance(object.pos));
            findings.push(Finding::new(Severity::Repaired, object.id, Some(object.pos), message));
            out.push(placed(&piece(object, pos), graph.seed, site));
            continue;
        }
        match site.nearest_free(object.pos, FARTHEST_MOVE_M) {
            Some(pos) if pos == object.pos => out.push(placed(&piece(object, pos), graph.seed, site)),
            Some(pos) => {
                let message = format!("object: it stood inside a house and was moved by {:.1} m", pos.distance(object.pos));
                findings.push(Finding::new(Severity::Repaired, object.id, Some(object.pos), message));
                out.push(placed(&piece(object, pos), graph.seed, site));
            }
            None => {
                let message = "object: it stands inside a house, farther than 3 m from free ground";
                findings.push(Finding::new(Severity::Dropped, object.id, Some(object.pos), message));
            }
        }
    }
    let at = graph.node_positions();
    let length: f64 = graph.links.iter().filter_map(|l| graph.polyline(l, &at)).map(|l| streets::length_m(&l)).sum();
    let is_bare = (graph.objects.len() as f64) < length / SPARSE_M;
    let mut furnisher = Furnisher { graph, areas, network, site, taken: Taken::default() };
    out.iter().for_each(|object| furnisher.taken.add(object.pos.to_metres(), object.kind));
    let given: FxHashSet<Id> = out.iter().map(|o| o.id).collect();
    let mut monuments: Vec<Piece<'a>> =
        graph.objects.iter().map(|object| piece(object, object.pos)).filter(|piece| !piece.monument.is_empty()).collect();
    let most = out.len() + MOST_GROWN;
    for rule in rules.iter().filter(|rule| is_bare || rule.always) {
        let mut wishes = furnisher.wishes(rule).peekable();
        while wishes.peek().is_some() {
            let mut grown = furnisher.granted(rule, wishes.by_ref().take(AT_ONCE));
            grown.retain(|o| !given.contains(&o.id));
            let is_too_much = out.len() + grown.len() > most;
            if is_too_much {
                let message = format!("more than {MOST_GROWN} pieces of furniture would be grown: `{}` puts no more", rule.name);
                findings.push(Finding::new(Severity::Note, Id::NONE, None, message));
                grown.truncate(most - out.len());
            }
            out.par_extend(grown.par_iter().map(|o| placed(o, graph.seed, site)));
            monuments.extend(grown.into_iter().filter(|piece| !piece.monument.is_empty()));
            if is_too_much {
                break;
            }
        }
    }
    out.shrink_to_fit();
    (out, monuments)
}
