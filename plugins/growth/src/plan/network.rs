//! The carriageways of a city as traffic sees them: streets, where they meet, and who waits there.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::furniture::Control;
use veduta_city::{CityGraph, Id, Link, LinkKind, StreetClass, Surfacing};

use super::band::{pieces, stations};
use super::crossroads::{Arm, gaps};
use super::index::Index;
use super::streets::{along, length_m, pavement_m, width_at_m, width_m};

/// Length of a zebra's stripes, and its distance from the corner of the kerbs; metres.
pub(super) const ZEBRA_M: f64 = 3.4;
const ZEBRA_SETBACK_M: f64 = 0.8;
/// Breadth of stop lines, and their distance from the zebra, or from the corner where there is none; metres.
pub(super) const STOP_M: f64 = 0.4;
const STOP_SETBACK_M: f64 = 1.2;
/// Carriageways between these widths have zebras, those from the second on two lanes; metres.
const ZEBRAS: core::ops::Range<f64> = 4.0..17.0;
pub(super) const TWO_LANES_M: f64 = 5.6;
/// Lines along a street begin so far behind what lies across it; metres.
const CLEAR_M: f64 = 0.8;
/// Share of the crossings of plain streets that have zebras.
const QUIET_ZEBRAS: f64 = 0.2;
/// Vehicles keep so far from the edge of a street without pavements, metres.
const EDGE_M: f64 = 1.0;
/// Trains reach so far beyond their ballast.
const TRAIN_M: f64 = 0.4;
/// So many arms of main streets at one node cross there, and have lights.
const SIGNALS: usize = 3;

/// Streets with a carriageway that is marked, and where they meet.
pub(super) struct Network<'a> {
    pub streets: Vec<Street<'a>>,
    /// Nodes of three arms or more.
    pub junctions: Vec<Junction>,
    /// Where vehicles drive, marked or not; without the corners of crossroads.
    pub carriageways: Index<()>,
}

/// A street with a carriageway.
pub(super) struct Street<'a> {
    pub link: &'a Link,
    pub class: StreetClass,
    pub line: Vec<DVec2>,
    pub length_m: f64,
    /// How much of its start and of its end belongs to crossroads: zebras and stop lines, and what they keep clear; metres.
    pub taken_m: [f64; 2],
}

/// Where streets meet.
pub(super) struct Junction {
    pub arms: Vec<JunctionArm>,
    pub control: Option<Control>,
}

/// A street that leaves a junction, and what lies across it: how far from the node, metres.
pub(super) struct JunctionArm {
    pub end: End,
    /// Half the carriageway's width there.
    pub half_m: f64,
    /// Where a zebra begins.
    pub zebra_m: Option<f64>,
    /// The middle of a stop line.
    pub stop_m: Option<f64>,
    /// How much of the street is the crossroads'.
    taken_m: f64,
}

/// An end of a street at a node.
#[derive(Clone, Copy)]
pub(super) struct End {
    /// Index of [`Network::streets`].
    pub street: usize,
    pub is_start: bool,
}

impl Street<'_> {
    /// Half the carriageway's width at a share of the street's length.
    pub fn half_m(&self, share: f64) -> f64 {
        width_at_m(self.link, share) / 2.0 - self.pavement_m()
    }

    /// Width of the pavement on each side.
    pub fn pavement_m(&self) -> f64 {
        pavement_m(self.class, width_m(self.link))
    }

    /// The place at a distance from one end, so far to the left of the way from there.
    pub fn at(&self, from_start: bool, s_m: f64, left_m: f64) -> Option<DVec2> {
        let (p, way) = self.way(from_start, s_m)?;
        Some(p + way.perp() * left_m)
    }

    /// The place at a distance from one end, and the way on from there.
    pub fn way(&self, from_start: bool, s_m: f64) -> Option<(DVec2, DVec2)> {
        match from_start {
            true => along(&self.line, s_m),
            false => along(&self.line, self.length_m - s_m).map(|(p, way)| (p, -way)),
        }
    }
}

impl<'a> Network<'a> {
    pub fn new(graph: &'a CityGraph) -> Self {
        let at = graph.node_positions();
        let street = |link: &'a Link| -> Option<Street<'a>> {
            let LinkKind::Street(class) = link.kind else { return None };
            let is_marked = class.has_carriageway() && link.layer >= 0 && link.surfacing.is_none_or(|s| s == Surfacing::Asphalt);
            let mut line = graph.polyline(link, &at).filter(|_| is_marked)?;
            line.dedup_by(|a, b| a.distance(*b) < 1e-6);
            (line.len() > 1).then(|| Street { link, class, length_m: length_m(&line), line, taken_m: [0.0; 2] })
        };
        let mut streets: Vec<Street<'_>> = graph.links.iter().filter_map(street).collect();
        let mut nodes: BTreeMap<Id, Vec<Arm<End>>> = BTreeMap::new();
        for (i, street) in streets.iter().enumerate() {
            for (node, is_start) in [(street.link.from, true), (street.link.to, false)] {
                let (end, share) = (End { street: i, is_start }, if is_start { 0.0 } else { 1.0 });
                let mut forth = street.line.iter().copied();
                let mut back = street.line.iter().rev().copied();
                let line: &mut dyn Iterator<Item = DVec2> = if is_start { &mut forth } else { &mut back };
                nodes.entry(node).or_default().extend(Arm::new(line, street.half_m(share), 0.0, end));
            }
        }
        let meet = nodes.into_iter().filter(|(_, arms)| arms.len() >= 3);
        let driven = |link: &Link| {
            let line = graph.polyline(link, &at).filter(|_| link.layer >= 0).unwrap_or_default();
            let stations = stations(&line, link);
            match beside_m(link) {
                Some(beside) => pieces(&stations, |share| (width_at_m(link, share) / 2.0 - beside).max(0.5)),
                None => Vec::new(),
            }
        };
        let carriageways = Index::new(graph.links.iter().flat_map(driven).map(|piece| (piece, ())).collect());
        let junctions: Vec<Junction> =
            meet.map(|(node, mut arms)| junction(Draw::new(graph.seed, node, "crossing"), &mut arms, &streets)).collect();
        for arm in junctions.iter().flat_map(|junction| &junction.arms) {
            streets[arm.end.street].taken_m[usize::from(!arm.end.is_start)] = arm.taken_m;
        }
        Self { streets, junctions, carriageways }
    }
}

/// Width on each side of a street or railway that vehicles leave free, metres: less than none where trains reach beyond the ballast.
/// `None` where none drive.
fn beside_m(link: &Link) -> Option<f64> {
    match link.kind {
        LinkKind::Street(class) if class.has_carriageway() => {
            let pavement = pavement_m(class, width_m(link));
            Some(if pavement > 0.0 { pavement } else { EDGE_M })
        }
        LinkKind::Railway { .. } => Some(-TRAIN_M),
        _ => None,
    }
}

fn junction(draw: Draw, arms: &mut [Arm<End>], streets: &[Street<'_>]) -> Junction {
    let mut clear: BTreeMap<(usize, bool), f64> = BTreeMap::new();
    for (before, after, gap) in gaps(arms) {
        let (b, a) = corner_m(before, after, gap);
        for (end, at) in [(before.what, b), (after.what, a)] {
            let entry = clear.entry((end.street, end.is_start)).or_default();
            *entry = entry.max(at);
        }
    }
    let is_main = |end: End| matches!(streets[end.street].class, StreetClass::Main | StreetClass::Motorway);
    let mains = arms.iter().filter(|arm| is_main(arm.what)).count();
    let control = match mains {
        0 => None,
        SIGNALS.. => Some(Control::Signals),
        _ => Some(Control::Stop),
    };
    let has_zebras = mains > 0 || draw.chance("zebras", QUIET_ZEBRAS);
    let of_arm = |arm: &Arm<End>| {
        let (end, street) = (arm.what, &streets[arm.what.street]);
        let mut at = clear.get(&(end.street, end.is_start)).copied().unwrap_or(0.0);
        let room = arm.straight_m.min(street.length_m * 0.5);
        let zebra = at + ZEBRA_SETBACK_M;
        let has_zebra = has_zebras && street.pavement_m() > 0.0 && ZEBRAS.contains(&(2.0 * arm.half_m)) && zebra + ZEBRA_M < room;
        at = if has_zebra { zebra + ZEBRA_M } else { at };
        let waits = match control {
            None => false,
            Some(Control::Stop) => !is_main(end),
            Some(Control::Signals) => true,
        };
        let stop = at + STOP_SETBACK_M;
        let has_stop = waits && arm.half_m * 2.0 >= TWO_LANES_M && stop + STOP_M < room;
        at = if has_stop { stop + STOP_M } else { at };
        JunctionArm {
            end,
            half_m: arm.half_m,
            zebra_m: has_zebra.then_some(zebra),
            stop_m: has_stop.then_some(stop),
            taken_m: at + CLEAR_M,
        }
    };
    Junction { arms: arms.iter().map(of_arm).collect(), control }
}

/// How far from the node the kerbs of two neighbouring arms meet, along each of them; metres.
fn corner_m<T>(before: &Arm<T>, after: &Arm<T>, gap: f64) -> (f64, f64) {
    let (sin, cos) = (libm::sin(gap), libm::cos(gap));
    if gap >= core::f64::consts::PI * 0.97 {
        return (0.0, 0.0);
    }
    let along = |mine: f64, other: f64| ((other + mine * cos) / sin.max(0.1)).max(0.0);
    // The rounding of the kerb begins a little before.
    let rounding = if gap > 0.35 { 2.0 } else { 0.0 };
    (along(before.half_m, after.half_m) + rounding, along(after.half_m, before.half_m) + rounding)
}
