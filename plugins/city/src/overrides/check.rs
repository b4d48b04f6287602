use core::fmt;

use glam::DVec2;

use super::areas::signed_area;
use super::target::cross;
use crate::ring_edges;
use crate::{
    BuildingPart, CityGraph, FARTHEST_M, GraphOverride, GraphOverrides, HIGHEST_M, MOST_LEVELS, RoofTags, Target, WIDEST_M,
};

/// What is wrong with an edit, naming it by its number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OverrideError {
    /// Which edit, from 1.
    pub edit: usize,
    /// What kind of edit it is, as the file calls it.
    pub kind: &'static str,
    /// What is wrong, in a sentence without a full stop.
    pub reason: String,
}

impl fmt::Display for OverrideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "edit {} ({}): {}", self.edit, self.kind, self.reason)
    }
}

impl std::error::Error for OverrideError {}

impl GraphOverride {
    /// Name of the kind of edit, as the file calls it.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Building { .. } => "Building",
            Self::House(_) => "House",
            Self::RemoveBuilding(_) => "RemoveBuilding",
            Self::AddBuilding(_) => "AddBuilding",
            Self::Width { .. } => "Width",
            Self::Name { .. } => "Name",
            Self::Link { .. } => "Link",
            Self::MoveNode { .. } => "MoveNode",
            Self::AddNode { .. } => "AddNode",
            Self::RemoveNode(_) => "RemoveNode",
            Self::JoinNodes { .. } => "JoinNodes",
            Self::AddLink(_) => "AddLink",
            Self::RemoveLink(_) => "RemoveLink",
            Self::SplitLink(_) => "SplitLink",
            Self::AddSquare(_) => "AddSquare",
            Self::RemoveSquare(_) => "RemoveSquare",
            Self::AddBlock(_) => "AddBlock",
            Self::RemoveBlock(_) => "RemoveBlock",
            Self::Courtyard { .. } => "Courtyard",
            Self::Block { .. } => "Block",
            Self::AddObject(_) => "AddObject",
            Self::RemoveObject(_) => "RemoveObject",
            Self::AddPlace(_) => "AddPlace",
        }
    }
}

impl GraphOverrides {
    /// Everything wrong with the edits by themselves, in order; whether their things are there is told by
    /// [`GraphOverrides::apply`].
    #[must_use]
    pub fn validate(&self) -> Vec<OverrideError> {
        let mut errors = Vec::new();
        for (i, edit) in self.edits.iter().enumerate() {
            let mut reasons = Vec::new();
            check(edit, &mut reasons);
            errors.extend(reasons.into_iter().map(|reason| OverrideError { edit: i + 1, kind: edit.kind(), reason }));
        }
        errors
    }
}

fn check(edit: &GraphOverride, reasons: &mut Vec<String>) {
    match edit {
        GraphOverride::Building { target, height_m, levels, roof, .. } => {
            check_target(target, reasons);
            check_heights(*height_m, *levels, roof.as_ref(), reasons);
        }
        GraphOverride::House(stand_in) => check_target(&stand_in.target, reasons),
        GraphOverride::Width { target, width_m } => {
            check_target(target, reasons);
            // 0 gives the class's own width back.
            check_range("width_m", *width_m, 0.0, WIDEST_M, reasons);
        }
        GraphOverride::Link { target, width_m, .. } => {
            check_target(target, reasons);
            check_range("width_m", width_m.unwrap_or(0.0), 0.0, WIDEST_M, reasons);
        }
        GraphOverride::MoveNode { target, to } => {
            check_target(target, reasons);
            check_place("to", *to, reasons);
        }
        GraphOverride::AddNode { at, z, .. } => {
            check_place("at", *at, reasons);
            check_range("z", *z, -FARTHEST_M, FARTHEST_M, reasons);
        }
        GraphOverride::JoinNodes { target, with } => {
            check_target(target, reasons);
            check_place("with.at", with.at, reasons);
        }
        GraphOverride::AddLink(link) => {
            check_place("from.at", link.from.at, reasons);
            check_place("to.at", link.to.at, reasons);
            link.via.iter().for_each(|&p| check_place("via", p, reasons));
            check_range("width_m", link.width_m, 0.0, WIDEST_M, reasons);
        }
        GraphOverride::AddSquare(square) => {
            check_alone(CityGraph { squares: vec![square.clone()], ..CityGraph::default() }, reasons);
            check_simple("outline", &square.outline, reasons);
            square.holes.iter().for_each(|h| check_simple("holes", h, reasons));
        }
        GraphOverride::AddBlock(block) => {
            check_alone(CityGraph { blocks: vec![block.clone()], ..CityGraph::default() }, reasons);
            check_simple("outline", &block.outline, reasons);
            block.holes.iter().for_each(|h| check_simple("holes", h, reasons));
        }
        GraphOverride::Courtyard { target, ring } => {
            check_target(target, reasons);
            ring.iter().for_each(|&p| check_place("ring", p, reasons));
            if ring.len() < 3 {
                reasons.push(format!("`ring` has {} vertices; it needs at least three", ring.len()));
            }
            check_simple("ring", ring, reasons);
        }
        GraphOverride::RemoveBuilding(target)
        | GraphOverride::RemoveNode(target)
        | GraphOverride::RemoveLink(target)
        | GraphOverride::SplitLink(target)
        | GraphOverride::RemoveSquare(target)
        | GraphOverride::RemoveBlock(target)
        | GraphOverride::RemoveObject(target)
        | GraphOverride::Name { target, .. }
        | GraphOverride::Block { target, .. } => check_target(target, reasons),
        GraphOverride::AddBuilding(building) => {
            check_alone(CityGraph { buildings: vec![(**building).clone()], ..CityGraph::default() }, reasons);
            check_heights(building.height_m, building.levels, Some(&building.roof), reasons);
            check_range("min_height_m", building.min_height_m, 0.0, HIGHEST_M, reasons);
            for BuildingPart { height_m, levels, roof, min_height_m, .. } in &building.parts {
                check_heights(*height_m, *levels, Some(roof), reasons);
                check_range("min_height_m", *min_height_m, 0.0, HIGHEST_M, reasons);
            }
        }
        GraphOverride::AddObject(object) => {
            check_alone(CityGraph { objects: vec![object.clone()], ..CityGraph::default() }, reasons);
            check_range("height_m", object.height_m, 0.0, HIGHEST_M, reasons);
            if !object.heading_deg.is_finite() {
                reasons.push("`heading_deg` of object is not a number".to_owned());
            }
        }
        GraphOverride::AddPlace(place) => {
            check_alone(CityGraph { places: vec![place.clone()], ..CityGraph::default() }, reasons);
        }
    }
}

/// What a graph would say of the one thing in it.
fn check_alone(graph: CityGraph, reasons: &mut Vec<String>) {
    reasons.extend(graph.validate().iter().map(ToString::to_string));
}

pub(super) fn check_target(target: &Target, reasons: &mut Vec<String>) {
    check_place("at", target.at, reasons);
}

pub(super) fn check_place(field: &str, DVec2 { x, y }: DVec2, reasons: &mut Vec<String>) {
    if !(x.abs() <= FARTHEST_M && y.abs() <= FARTHEST_M) {
        reasons.push(format!("`{field}` is ({x:?}, {y:?}); both numbers must lie between -{FARTHEST_M} and {FARTHEST_M}"));
    }
}

/// Outlines that people draw have an area and do not cross themselves. Those with other mistakes are told of those alone.
fn check_simple(field: &str, ring: &[DVec2], reasons: &mut Vec<String>) {
    if ring.len() < 3 || !ring.iter().all(|p| p.is_finite()) {
        return;
    }
    let edges: Vec<(DVec2, DVec2)> = ring_edges(ring).collect();
    if edges.iter().enumerate().any(|(i, &a)| edges.iter().skip(i + 1).any(|&b| cross(a, b))) {
        reasons.push(format!("`{field}` crosses itself"));
    } else if signed_area(ring).abs() < 1.0 {
        reasons.push(format!("`{field}` encloses less than 1 m²"));
    }
}

fn check_heights(height_m: Option<f64>, levels: Option<f64>, roof: Option<&RoofTags>, reasons: &mut Vec<String>) {
    for (field, value, most) in [("height_m", height_m, HIGHEST_M), ("levels", levels, MOST_LEVELS)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && *value <= most)) {
            reasons.push(format!("`{field}` is {value:?}; it must be above 0 and at most {most}"));
        }
    }
    if let Some(height_m) = roof.and_then(|roof| roof.height_m) {
        check_range("roof.height_m", height_m, 0.0, HIGHEST_M, reasons);
    }
    if let Some(deg) = roof.and_then(|roof| roof.direction_deg).filter(|deg| !deg.is_finite()) {
        reasons.push(format!("`roof.direction_deg` is {deg:?}; it must be a number of degrees"));
    }
}

fn check_range(field: &str, value: f64, least: f64, most: f64, reasons: &mut Vec<String>) {
    if !(least..=most).contains(&value) {
        reasons.push(format!("`{field}` is {value:?}; it must lie between {least} and {most}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file;

    fn told(edits: &str) -> Vec<String> {
        let overrides: GraphOverrides = file::parse(&format!("(edits: [{edits}])"), "t").unwrap_or_else(|e| panic!("{e}"));
        overrides.validate().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn an_edit_that_cannot_be_meant_is_told_by_its_number() {
        let wrong = [
            ("Width(target: (at: (0, 0)), width_m: 1e300)", "(Width): `width_m` is 1e300; it must lie between 0 and 400"),
            ("Width(target: (at: (0, 0)), width_m: -4)", "(Width): `width_m` is -4.0;"),
            ("Width(target: (at: (0, 0)), width_m: NaN)", "(Width): `width_m` is NaN;"),
            ("RemoveObject((at: (0, NaN)))", "(RemoveObject): `at` is (0.0, NaN);"),
            ("Name(target: (at: (1e7, 0)), name: \"x\")", "(Name): `at` is (10000000.0, 0.0);"),
            ("Building(target: (at: (0, 0)), height_m: -3)", "(Building): `height_m` is -3.0;"),
            ("Building(target: (at: (0, 0)), levels: inf)", "(Building): `levels` is inf;"),
            ("Building(target: (at: (0, 0)), roof: (height_m: NaN))", "(Building): `roof.height_m` is NaN;"),
            ("Building(target: (at: (0, 0)), roof: (direction_deg: NaN))", "(Building): `roof.direction_deg` is NaN;"),
            ("AddBuilding((outline: [(0, 0), (1, 0)]))", "(AddBuilding): building has an outline of 2 vertices"),
            ("AddBuilding((outline: [(0, 0), (1, 0), (1, 1)], parts: [(outline: [(0, 0), (1, 0), (1, 1)], height_m: 0)]))", "0.0;"),
            ("AddObject((kind: Bench, pos: (inf, 0)))", "(AddObject): object has a coordinate that is not a number"),
            ("AddObject((kind: Bench, pos: (0, 0), heading_deg: NaN))", "(AddObject): `heading_deg` of object is not a number"),
            ("MoveNode(target: (at: (0, 0)), to: (0, inf))", "(MoveNode): `to` is (0.0, inf);"),
            ("MoveNode(target: (at: (0, 1e9)), to: (0, 0))", "(MoveNode): `at` is"),
            ("AddNode(at: (NaN, 0))", "(AddNode): `at` is (NaN, 0.0);"),
            ("AddNode(at: (0, 0), z: NaN)", "(AddNode): `z` is NaN;"),
            ("JoinNodes(target: (at: (0, 0)), with: (at: (0, NaN)))", "(JoinNodes): `with.at` is (0.0, NaN);"),
            ("AddLink((from: (at: (0, NaN)), to: (at: (9, 9)), kind: Street(Lane)))", "(AddLink): `from.at` is"),
            (
                "AddLink((from: (at: (0, 0)), to: (at: (9, 9)), via: [(1, inf)], kind: Street(Lane)))",
                "(AddLink): `via` is (1.0, inf);",
            ),
            ("AddLink((from: (at: (0, 0)), to: (at: (9, 9)), width_m: 900, kind: Street(Lane)))", "(AddLink): `width_m` is 900.0;"),
            ("Link(target: (at: (0, 0)), width_m: -1)", "(Link): `width_m` is -1.0;"),
            ("AddSquare((outline: [(0, 0), (1, 0)]))", "(AddSquare): square has an outline of 2 vertices"),
            ("AddSquare((outline: [(0, 0), (9, 9), (9, 0), (0, 9)]))", "(AddSquare): `outline` crosses itself"),
            ("AddSquare((outline: [(0, 0), (9, 9), (4, 4)]))", "(AddSquare): `outline` encloses less than 1 m²"),
            ("AddBlock((outline: [(0, 0), (9, 9), (9, 0), (0, 9)]))", "(AddBlock): `outline` crosses itself"),
            ("Courtyard(target: (at: (0, 0)), ring: [(0, 0), (9, 9)])", "(Courtyard): `ring` has 2 vertices"),
            ("RemoveNode((at: (NaN, 0)))", "(RemoveNode): `at` is"),
            ("AddPlace((name: \"x\", pos: (0, 2e6)))", "(AddPlace): place lies at (0, 2000000)"),
            ("AddPlace((name: \"x\", pos: (0, 0), radius_m: NaN))", "(AddPlace): `radius_m` of place is not a number"),
        ];
        for (edit, reason) in wrong {
            let told = told(&format!("RemoveBuilding((at: (0, 0))), {edit}"));
            assert_eq!(told.len(), 1, "{edit}: {told:?}");
            assert!(told[0].starts_with("edit 2 (") && told[0].contains(reason), "{edit}: {told:?}");
        }
        assert_eq!(told("Width(target: (at: (0, 0)), width_m: 0), Building(target: (at: (0, 0)), roof: (height_m: 0))"), [""; 0]);
    }
}
