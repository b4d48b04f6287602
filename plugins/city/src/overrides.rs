use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{BlockKind, Building, CityGraph, Finding, Id, Place, RoofTags, Severity, StandingObject, Style};

/// A person's edits to a graph, in a file of their own (`X.graph.overrides.ron`), so that they survive a new survey.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraphOverrides {
    /// Edits, applied in order.
    #[serde(default)]
    pub edits: Vec<GraphOverride>,
    /// Styles added to, or put in place of, the stock ones.
    #[serde(default)]
    pub styles: Vec<Style>,
}

/// What an edit is about: kind by the edit, id if it is known, and the place where the thing was when it was written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Id; [`Id::NONE`] to go by place alone.
    #[serde(default)]
    pub id: Id,
    /// Plan metres.
    pub at: DVec2,
}

/// One edit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum GraphOverride {
    /// Change a building; what is not given stays.
    Building {
        /// Which.
        target: Target,
        /// New name.
        #[serde(default)]
        name: Option<String>,
        /// New style.
        #[serde(default)]
        style: Option<String>,
        /// New height to the ridge, metres.
        #[serde(default)]
        height_m: Option<f64>,
        /// New number of storeys.
        #[serde(default)]
        levels: Option<f64>,
        /// New roof.
        #[serde(default)]
        roof: Option<RoofTags>,
        /// New colour of the walls.
        #[serde(default)]
        colour: Option<crate::Rgb>,
    },
    /// Take a building out.
    RemoveBuilding(Target),
    /// Put a building in.
    AddBuilding(Box<Building>),
    /// Change the width of a link.
    Width {
        /// Which.
        target: Target,
        /// Metres.
        width_m: f64,
    },
    /// Name a link.
    Name {
        /// Which.
        target: Target,
        /// The name.
        name: String,
    },
    /// Say what a block holds.
    Block {
        /// Which.
        target: Target,
        /// New kind.
        #[serde(default)]
        kind: Option<BlockKind>,
        /// New district.
        #[serde(default)]
        district: Option<String>,
    },
    /// Put an object in.
    AddObject(StandingObject),
    /// Take an object out.
    RemoveObject(Target),
    /// Put a place in.
    AddPlace(Place),
}

/// How far a thing may have moved and still be found by place; metres.
const REACH_M: f64 = 5.0;

impl GraphOverrides {
    /// Applies the edits to a graph. An edit whose thing is found neither by id nor within 5 m of its place is reported
    /// and left out.
    #[must_use]
    pub fn apply(&self, graph: &mut CityGraph) -> Vec<Finding> {
        let mut findings = Vec::new();
        let mut lost = |what: &str, target: &Target| {
            let message = format!("override of a {what}: nothing of that id, and no {what} within {REACH_M} m of that place");
            findings.push(Finding::new(Severity::Dropped, target.id, Some(target.at), message));
        };
        let at = graph.node_positions();
        for edit in &self.edits {
            match edit {
                GraphOverride::Building { target, name, style, height_m, levels, roof, colour } => {
                    let Some(i) = find(&graph.buildings, target, |b| (b.id, distance_to_ring(&b.outline, target.at))) else {
                        lost("building", target);
                        continue;
                    };
                    let b = &mut graph.buildings[i];
                    set(&mut b.name, name.as_ref());
                    set(&mut b.style, style.as_ref());
                    set(&mut b.roof, roof.as_ref());
                    b.height_m = height_m.or(b.height_m);
                    b.levels = levels.or(b.levels);
                    b.colour = colour.or(b.colour);
                }
                GraphOverride::RemoveBuilding(target) => {
                    match find(&graph.buildings, target, |b| (b.id, distance_to_ring(&b.outline, target.at))) {
                        Some(i) => drop(graph.buildings.remove(i)),
                        None => lost("building", target),
                    }
                }
                GraphOverride::AddBuilding(building) => graph.buildings.push((**building).clone()),
                GraphOverride::Width { target, width_m } => match find_link(graph, target, &at) {
                    Some(i) => graph.links[i].width_m = *width_m,
                    None => lost("link", target),
                },
                GraphOverride::Name { target, name } => match find_link(graph, target, &at) {
                    Some(i) => graph.links[i].name.clone_from(name),
                    None => lost("link", target),
                },
                GraphOverride::Block { target, kind, district } => {
                    let Some(i) = find(&graph.blocks, target, |b| (b.id, distance_to_ring(&b.outline, target.at))) else {
                        lost("block", target);
                        continue;
                    };
                    set(&mut graph.blocks[i].kind, kind.as_ref());
                    set(&mut graph.blocks[i].district, district.as_ref());
                }
                GraphOverride::AddObject(object) => graph.objects.push(object.clone()),
                GraphOverride::RemoveObject(target) => match find(&graph.objects, target, |o| (o.id, o.pos.distance(target.at))) {
                    Some(i) => drop(graph.objects.remove(i)),
                    None => lost("object", target),
                },
                GraphOverride::AddPlace(place) => graph.places.push(place.clone()),
            }
        }
        findings
    }
}

fn set<T: Clone>(slot: &mut T, new: Option<&T>) {
    if let Some(new) = new {
        slot.clone_from(new);
    }
}

/// By id if it is given and there, else the nearest within reach.
fn find<T>(things: &[T], target: &Target, key: impl Fn(&T) -> (Id, f64)) -> Option<usize> {
    if target.id.is_given()
        && let Some(i) = things.iter().position(|t| key(t).0 == target.id)
    {
        return Some(i);
    }
    let near = things.iter().enumerate().map(|(i, t)| (i, key(t).1)).min_by(|a, b| a.1.total_cmp(&b.1));
    near.filter(|&(_, d)| d <= REACH_M).map(|(i, _)| i)
}

fn find_link(graph: &CityGraph, target: &Target, at: &std::collections::HashMap<Id, DVec2>) -> Option<usize> {
    find(&graph.links, target, |link| {
        let line = graph.polyline(link, at).unwrap_or_default();
        (link.id, line.windows(2).map(|e| distance_to_edge(e[0], e[1], target.at)).fold(f64::INFINITY, f64::min))
    })
}

fn distance_to_edge(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t))
}

/// 0 inside, else the distance to the border.
fn distance_to_ring(ring: &[DVec2], p: DVec2) -> f64 {
    let pairs = || ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)).take(ring.len());
    let inside = pairs().filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)).count();
    if inside % 2 == 1 {
        return 0.0;
    }
    pairs().map(|(a, b)| distance_to_edge(a, b, p)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn house(id: u64, x: f64) -> Building {
        let text = format!("(id: {id}, outline: [({x}, 0), ({}, 0), ({}, 8), ({x}, 8)])", x + 8.0, x + 8.0);
        ron::from_str(&text).expect("the test's own text")
    }

    #[test]
    fn an_edit_finds_its_house_by_place_after_the_ids_changed() {
        let mut graph = CityGraph { buildings: vec![house(5, 0.0), house(6, 10.0)], ..Default::default() };
        let text = "(edits: [Building(target: (id: 77, at: (12, 4)), name: Some(\"At the Bell\")),
                             RemoveBuilding((id: 5, at: (900, 900))),
                             RemoveObject((at: (0, 0)))])";
        let overrides: GraphOverrides = ron::from_str(text).expect("the test's own text");
        let findings = overrides.apply(&mut graph);
        assert_eq!(graph.buildings.len(), 1);
        assert_eq!(graph.buildings[0].name, "At the Bell");
        assert_eq!(findings.len(), 1, "the object that is not there is reported: {findings:?}");
    }
}
