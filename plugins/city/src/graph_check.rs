use std::collections::HashSet;

use glam::DVec2;

use crate::{CityGraph, FARTHEST_M, Id, ProfileError, Viewpoint};

/// What is wrong with a graph, naming the thing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraphError {
    /// A position that is none.
    #[error("{} has a coordinate that is not a number", named(what, *id))]
    Coordinate {
        /// Kind of thing.
        what: &'static str,
        /// Which one.
        id: Id,
    },
    /// A position beyond what the grid can hold.
    #[error(
        "{} lies at ({x}, {y}), farther from the anchor than {} km; move the anchor, or cut a smaller city out",
        named(what, *id),
        FARTHEST_M / 1000.0
    )]
    TooFar {
        /// Kind of thing.
        what: &'static str,
        /// Which one.
        id: Id,
        /// Metres east.
        x: f64,
        /// Metres north.
        y: f64,
    },
    /// Another number that is none.
    #[error("`{field}` of {} is not a number", named(what, *id))]
    Number {
        /// Kind of thing.
        what: &'static str,
        /// Which one.
        id: Id,
        /// Which of its fields.
        field: &'static str,
    },
    /// Two things of one kind with one id.
    #[error("two {what}s have the id {id}: give one of them another")]
    DuplicateId {
        /// Kind of thing.
        what: &'static str,
        /// Which id.
        id: Id,
    },
    /// A link that names a node which is not there.
    #[error("link {link} ends at node {node}, which is not in `nodes`")]
    UnknownNode {
        /// The link.
        link: Id,
        /// The node it names.
        node: Id,
    },
    /// A width profile that is none.
    #[error("entry {entry} of the `profile` of {}: {error}", named("link", *link))]
    Profile {
        /// The link.
        link: Id,
        /// Which of its entries, from 1.
        entry: usize,
        /// What is wrong with it.
        error: ProfileError,
    },
    /// A ring of fewer than three vertices.
    #[error("{} has an outline of {n} vertices; it needs at least three", named(what, *id))]
    ShortRing {
        /// Kind of thing.
        what: &'static str,
        /// Which one.
        id: Id,
        /// How many vertices.
        n: usize,
    },
    /// Elevations that are none.
    #[error("the terrain: {0}")]
    Terrain(String),
    /// Latitude or longitude out of range.
    #[error("the anchor ({lat}, {lon}) is not a latitude within ±85° and a longitude within ±180°")]
    Anchor {
        /// Degrees.
        lat: f64,
        /// Degrees.
        lon: f64,
    },
}

/// A thing in words; one without an id by its kind alone.
fn named(what: &str, id: Id) -> String {
    if id.is_given() { format!("{what} {id}") } else { what.to_owned() }
}

/// What is wrong with the positions of a thing: the first that is wrong counts.
fn check_positions(what: &'static str, id: Id, positions: &[DVec2]) -> Option<GraphError> {
    positions.iter().find_map(|p| {
        if !p.is_finite() {
            return Some(GraphError::Coordinate { what, id });
        }
        (p.abs().max_element() > FARTHEST_M).then_some(GraphError::TooFar { what, id, x: p.x, y: p.y })
    })
}

/// Fields of a thing that must be numbers and are not.
fn check_numbers(what: &'static str, id: Id, fields: &[(&'static str, f64)]) -> impl Iterator<Item = GraphError> {
    fields.iter().filter(|(_, value)| !value.is_finite()).map(move |&(field, _)| GraphError::Number { what, id, field })
}

/// What is wrong with a stand.
fn check_view(what: &'static str, id: Id, view: &Viewpoint) -> Vec<GraphError> {
    let numbers = [("eye_m", view.eye_m), ("heading_deg", view.heading_deg), ("pitch_deg", view.pitch_deg)];
    check_positions(what, id, &[view.pos]).into_iter().chain(check_numbers(what, id, &numbers)).collect()
}

impl CityGraph {
    /// Everything wrong with the graph, in order; empty if growth may take it.
    #[must_use]
    pub fn validate(&self) -> Vec<GraphError> {
        let mut errors = Vec::new();
        if !(self.anchor.lat.abs() <= 85.0 && self.anchor.lon.abs() <= 180.0) {
            errors.push(GraphError::Anchor { lat: self.anchor.lat, lon: self.anchor.lon });
        }
        errors.extend(check_numbers("the graph", Id::NONE, &[("zero_m", self.zero_m)]));
        errors.extend(self.terrain.as_ref().and_then(|terrain| terrain.check().err()).map(GraphError::Terrain));
        if let Some(start) = &self.start {
            errors.extend(check_view("the start", Id::NONE, start));
        }
        let mut nodes = HashSet::new();
        for node in &self.nodes {
            errors.extend(check_positions("node", node.id, &[node.pos]));
            errors.extend(check_numbers("node", node.id, &[("z", node.z)]));
            if !nodes.insert(node.id) {
                errors.push(GraphError::DuplicateId { what: "node", id: node.id });
            }
        }
        let mut links = HashSet::new();
        for link in &self.links {
            for node in [link.from, link.to] {
                if !nodes.contains(&node) {
                    errors.push(GraphError::UnknownNode { link: link.id, node });
                }
            }
            errors.extend(check_positions("link", link.id, &link.via));
            errors.extend(check_numbers("link", link.id, &[("width_m", link.width_m)]));
            let wrong = link.profile_error().map(|(entry, error)| GraphError::Profile { link: link.id, entry, error });
            errors.extend(wrong);
            if link.id.is_given() && !links.insert(link.id) {
                errors.push(GraphError::DuplicateId { what: "link", id: link.id });
            }
        }
        let mut ring = |what: &'static str, id: Id, ring: &[DVec2]| {
            if ring.len() < 3 {
                errors.push(GraphError::ShortRing { what, id, n: ring.len() });
            }
            errors.extend(check_positions(what, id, ring));
        };
        for s in &self.squares {
            ring("square", s.id, &s.outline);
            s.holes.iter().for_each(|h| ring("square", s.id, h));
        }
        for b in &self.blocks {
            ring("block", b.id, &b.outline);
            b.holes.iter().for_each(|h| ring("block", b.id, h));
        }
        for b in &self.buildings {
            ring("building", b.id, &b.outline);
            b.holes.iter().for_each(|h| ring("building", b.id, h));
            for p in &b.parts {
                ring("building part", p.id, &p.outline);
                p.holes.iter().for_each(|h| ring("building part", p.id, h));
            }
        }
        let mut buildings = HashSet::new();
        for b in &self.buildings {
            if let Some(monument) = &b.monument {
                errors.extend(monument.pos.and_then(|pos| check_positions("the monument of building", b.id, &[pos])));
                let with = monument.with.values().copied().find(|value| !value.is_finite()).unwrap_or(0.0);
                let numbers = [("heading_deg", monument.heading_deg), ("with", with)];
                errors.extend(check_numbers("the monument of building", b.id, &numbers));
            }
            if b.id.is_given() && !buildings.insert(b.id) {
                errors.push(GraphError::DuplicateId { what: "building", id: b.id });
            }
        }
        for o in &self.objects {
            errors.extend(check_positions("object", o.id, &[o.pos]));
        }
        for p in &self.places {
            errors.extend(check_positions("place", p.id, &[p.pos]));
            errors.extend(check_numbers("place", p.id, &[("radius_m", p.radius_m)]));
            errors.extend(p.view.iter().flat_map(|view| check_view("the view of place", p.id, view)));
        }
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;
    use crate::testing::{lane, node};

    #[test]
    fn a_link_to_nowhere_is_named() {
        let graph = CityGraph { nodes: vec![node(1, 0.0, 0.0)], links: vec![lane(1, 2)], ..Default::default() };
        assert_eq!(graph.validate(), [GraphError::UnknownNode { link: Id::NONE, node: Id(2) }]);
    }

    #[test]
    fn not_a_number_is_found() {
        let graph = CityGraph { nodes: vec![node(1, f64::NAN, 0.0)], ..Default::default() };
        assert_eq!(graph.validate(), [GraphError::Coordinate { what: "node", id: Id(1) }]);
    }

    #[test]
    fn what_lies_too_far_away_is_told_with_its_place() {
        let graph = CityGraph { nodes: vec![node(1, FARTHEST_M, 0.0), node(2, 0.0, -2e6)], ..Default::default() };
        let errors = graph.validate();
        assert_eq!(errors, [GraphError::TooFar { what: "node", id: Id(2), x: 0.0, y: -2e6 }]);
        assert!(
            errors[0].to_string().contains("node 2 lies at (0, -2000000), farther from the anchor than 900 km"),
            "{}",
            errors[0]
        );
    }

    #[test]
    fn a_start_or_view_of_no_number_is_found() {
        let mut graph = CityGraph { start: Some(Viewpoint { pitch_deg: f64::NAN, ..Default::default() }), ..Default::default() };
        graph.places.push(Place { view: Some(Viewpoint { pos: DVec2::NAN, ..Default::default() }), ..Default::default() });
        let told: Vec<String> = graph.validate().iter().map(ToString::to_string).collect();
        assert_eq!(told, ["`pitch_deg` of the start is not a number", "the view of place has a coordinate that is not a number"]);
    }
}
