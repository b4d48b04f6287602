//! Monuments: what is built from primitives by name, as a person writes it.
//!
//! ```text
//!  Monument (formulas of parameters) ──design──► Design (whole numbers) ──► plan, packets ──► growth's mesh
//! ```
//!
//! A monument is a list of parts; each is a [`Shape`], another monument, or parts again, placed, mirrored and repeated. Numbers may be
//! formulas of the monument's parameters. A part's frame is that of an elevation: x to the right of who looks at the front, y away
//! from them, z up.
//!
//! ```
//! use veduta_city::{Monuments, file};
//! let monuments: Monuments = file::parse(
//!     r##"[(
//!         name: "obelisk",
//!         parameters: {"height": 12},
//!         paints: {"stone": (colour: "#B79F79", tile: Stone)},
//!         parts: [(paint: "stone", parts: [
//!             (shape: Box(size: (3, 3, 0.6))),
//!             (at: (0, 0, 0.6), shape: Cylinder(radius: 0.8, top: 0.5, height: "height - 1.6", sides: 4)),
//!             (at: (0, 0, "height - 1"), shape: Cone(radius: 0.5, height: 1, sides: 4)),
//!         ])],
//!     )]"##,
//!     "obelisk.ron",
//! )?;
//! let design = monuments.design("obelisk", &[("height".to_owned(), 20.0)].into())?;
//! assert_eq!(design.shape_count(), 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Rejected
//! A scripting language (a design could run for ever, and would not fit a packet) · meshes from a modeller alone (no parameters, no
//! levels of detail, a thousand times the bytes).

mod design;
mod formula;
mod model;
mod resolve;
mod shape;

use std::collections::BTreeMap;

use glam::DVec2;
use serde::{Deserialize, Serialize};

pub use design::{Axis, Content, Design, DesignError, MOST_FACES, Material, Piece, PlacedMonument, Repeat};
pub use formula::{Formula, FormulaError};
pub use model::{Model, ModelVertex};
pub use resolve::MonumentError;
pub use shape::{Head, Hole, HoleShape, PathPoint, Shape, Unit};

/// The monuments of a city, and what they are put together from.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Monuments(pub Vec<Monument>);

/// A monument as a person writes it: a tower, a column, a church.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Monument {
    /// Name, as buildings and other monuments call it.
    pub name: String,
    /// Numbers that whoever uses it may set, with what they are otherwise.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
    /// Numbers worked out of the parameters and of those before them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<(String, Formula)>,
    /// What it is made of, by name; whoever uses it may set others.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub paints: BTreeMap<String, Material>,
    /// What it is put together from.
    pub parts: Vec<Part>,
}

/// A part of a monument: one of `shape`, `uses` and `parts`, scaled, rolled, tilted, turned, moved, mirrored and repeated, in
/// this order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Where its origin stands; metres.
    #[serde(default = "zeros", skip_serializing_if = "is_zeros")]
    pub at: [Formula; 3],
    /// Clockwise seen from above, degrees.
    #[serde(default = "zero", skip_serializing_if = "is_zero")]
    pub turn_deg: Formula,
    /// About x: its top leans back; degrees.
    #[serde(default = "zero", skip_serializing_if = "is_zero")]
    pub tilt_deg: Formula,
    /// About y: its top leans to the right; degrees.
    #[serde(default = "zero", skip_serializing_if = "is_zero")]
    pub roll_deg: Formula,
    /// Along each axis.
    #[serde(default = "ones", skip_serializing_if = "is_ones")]
    pub scale: [Formula; 3],
    /// A second one on the other side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirror: Option<Axis>,
    /// More of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<Repeat<Formula>>,
    /// Left out where this is 0 or less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<Formula>,
    /// Name of a paint; that of the group it is in if empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub paint: String,
    /// Name of the paint that fills a panel's holes or closes a roof's gables; empty: they stay open.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub infill: String,
    /// A solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape<Formula>>,
    /// Another monument, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uses: Option<String>,
    /// Parameters of the monument that it uses.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub with: BTreeMap<String, Formula>,
    /// Paints of the monument that it uses: theirs by name, and which of ours takes its place.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub paints: BTreeMap<String, String>,
    /// Parts of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Part>,
}

/// Which monument stands in place of a building's walls and roofs; its outlines stay what stops people and shades the street.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MonumentTag {
    /// Name of the monument.
    pub name: String,
    /// Where its origin stands, plan metres; the middle of the building's outline if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pos: Option<DVec2>,
    /// Where its front looks, degrees clockwise from north.
    #[serde(default)]
    pub heading_deg: f64,
    /// Parameters.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub with: BTreeMap<String, f64>,
}

fn zero() -> Formula {
    Formula::number(0.0)
}

fn zeros() -> [Formula; 3] {
    [zero(), zero(), zero()]
}

fn ones() -> [Formula; 3] {
    [(); 3].map(|()| Formula::number(1.0))
}

fn is_zero(of: &Formula) -> bool {
    *of == zero()
}

fn is_zeros(of: &[Formula; 3]) -> bool {
    *of == zeros()
}

fn is_ones(of: &[Formula; 3]) -> bool {
    *of == ones()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file;

    fn read(text: &str) -> Monuments {
        file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
    }

    fn paint() -> &'static str {
        r##"paints: {"stone": (colour: "#B79F79", tile: Stone)}"##
    }

    fn mistake(parts: &str) -> String {
        let text = format!("[(name: \"m\", parameters: {{\"h\": 2}}, {}, parts: [{parts}])]", paint());
        read(&text).validate().iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn formulas_become_whole_numbers() {
        let text = format!(
            "[(name: \"m\", parameters: {{\"h\": 2}}, values: [(\"half\", \"h / 2\"), (\"quarter\", \"half / 2\")], {},
              parts: [(paint: \"stone\", at: (0, \"quarter\", 1), turn_deg: 22.5, mirror: X,
                       repeat: Around(count: \"h * 2\"), shape: Lathe(profile: [(\"half\", 0), (0, 1, 0.5)]))])]",
            paint()
        );
        let design = read(&text).design("m", &[("h".to_owned(), 4.0)].into()).unwrap_or_else(|e| panic!("{e}"));
        let piece = &design.pieces[0];
        assert_eq!((piece.at, piece.turn, piece.scale), ([0, 1024, 1024], [0, 0, 2250], [1024; 3]));
        assert_eq!(piece.repeat.as_ref().map(|r| *r.count()), Some(8));
        let profile = vec![PathPoint { pos: [2048, 0], bulge: None }, PathPoint { pos: [0, 1024], bulge: Some(512) }];
        assert_eq!(piece.content, Content::Shape(Shape::Lathe { profile, sides: None }));
        assert_eq!(design.shape_count(), 16);
    }

    #[test]
    fn mistakes_name_part_field_and_fix() {
        let good = "(paint: \"stone\", shape: Sphere(radius: \"h\"))";
        assert_eq!(mistake(good), "");
        for (parts, told) in [
            ("(paint: \"stone\", shape: Sphere(radius: \"w\"))", "part 1 (Sphere), `radius`: there is no `w` in `w`; there are: h"),
            ("(shape: Sphere(radius: 1))", "part 1 (Sphere), `paint`: there is no paint ``; there are: stone"),
            ("(paint: \"stone\")", "part 1, `shape`: a part has one of `shape`, `uses` and `parts`"),
            (
                "(parts: [(paint: \"stone\", shape: Cone(radius: \"1 / 0\", height: 1))])",
                "part 1.1 (Cone), `radius`: `1 / 0` is inf",
            ),
            ("(uses: \"n\")", "there is no monument `n`; there are: m"),
            ("(uses: \"m\")", "monument `m`, `parts`: it is used by itself"),
            (
                "(paint: \"stone\", repeat: Row(count: -1, step: (1, 0, 0)), shape: Sphere(radius: 1))",
                "`count`: -1 is not a number",
            ),
            ("(paint: \"stone\", shape: Sphere(radius: 1e6))", "1000000 m is more than"),
        ] {
            let found = mistake(parts);
            assert!(found.contains(told), "{parts}: {found}");
        }
    }

    #[test]
    fn a_monument_of_too_many_faces_is_refused() {
        let many = "repeat: Row(count: 1000, step: (1, 0, 0))";
        let found = mistake(&format!("({many}, parts: [({many}, paint: \"stone\", shape: Sphere(radius: 1))])"));
        assert!(found.contains("or 4000000 faces"), "{found}");
    }

    #[test]
    fn a_design_from_elsewhere_is_checked() {
        let text = format!(
            "[(name: \"m\", {}, parts: [(parts: [(paint: \"stone\", shape: Sphere(radius: 1))]), (paint: \"stone\", shape: Sphere(radius: 2))])]",
            paint()
        );
        let good = read(&text).design("m", &BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((good.check(), good.pieces.len()), (Ok(()), 3));
        let levels: Vec<usize> = good.level(0..3).map(|(_, _, inner)| inner.len()).collect();
        assert_eq!(levels, [1, 0]);
        let fault = |spoil: fn(&mut Design)| {
            let mut design = good.clone();
            spoil(&mut design);
            design.check().expect_err("spoilt")
        };
        assert_eq!(fault(|d| d.pieces[0].content = Content::Group(3)), DesignError::Group(0));
        assert_eq!(fault(|d| d.materials.clear()), DesignError::Material(1));
        let fewer = |d: &mut Design| d.pieces[2].repeat = Some(Repeat::Row { count: -1, step: [0; 3], centred: false });
        assert_eq!(fault(fewer), DesignError::Copies(2));
    }

    #[test]
    fn groups_may_not_be_nested_without_end() {
        let group = |n: u32| Piece { content: Content::Group(n), ..piece() };
        let design = |depth: u32| Design { pieces: (0..depth).rev().map(group).collect(), ..Design::default() };
        assert_eq!(design(20).check(), Ok(()));
        assert_eq!(design(100_000).check(), Err(DesignError::Group(24)));
    }

    #[test]
    fn what_is_there_several_times_is_told_once() {
        let text = format!(
            "[(name: \"pair\", {paint}, parts: [(paint: \"stone\", parts: [(shape: Sphere(radius: 1)), (shape: Cone(radius: 1, height: 2))])]),
              (name: \"row\", {paint}, parts: [(uses: \"pair\"), (at: (5, 0, 0), uses: \"pair\"), (paint: \"stone\", shape: Cone(radius: 1, height: 2))])]",
            paint = paint()
        );
        let row = read(&text).design("row", &BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"));
        let told: Vec<&Content> = row.pieces.iter().map(|piece| &piece.content).collect();
        assert_eq!((told[4], told[5]), (&Content::Again(4), &Content::Again(2)));
        assert_eq!((row.pieces.len(), row.pieces[4].at, row.shape_count()), (6, [5 * 1024, 0, 0], 5));
        // As its level tells it, nothing is told again.
        let level: Vec<(&Content, core::ops::Range<usize>)> = row.level(0..6).map(|(_, content, inner)| (content, inner)).collect();
        assert_eq!(level, [(told[0], 1..4), (told[0], 1..4), (told[3], 0..0)]);
    }

    #[test]
    fn what_is_told_again_stands_whole_before() {
        let list = |contents: &[Content]| Design {
            materials: vec![Material { colour: crate::Rgb(0, 0, 0), tile: crate::Tile::Stone }],
            pieces: contents.iter().map(|content| Piece { content: content.clone(), ..piece() }).collect(),
            ..Design::default()
        };
        let ball = || Content::Shape(Shape::Sphere { radius: 1 });
        assert_eq!(list(&[ball(), Content::Again(1), Content::Again(2)]).check(), Ok(()));
        for (contents, fault) in [
            (vec![ball(), Content::Again(0)], 1),
            (vec![ball(), Content::Again(2)], 1),
            (vec![ball(), Content::Again(u32::MAX)], 1),
            (vec![ball(), Content::Again(1), Content::Again(1)], 2),
            (vec![Content::Group(1), Content::Again(1)], 1),
        ] {
            let bad = list(&contents);
            assert_eq!(bad.check(), Err(DesignError::Again(fault)));
            assert!(bad.level(0..contents.len()).count() <= contents.len());
        }
        // Groups of the group before, twice each.
        let tower = |floors: u32| {
            let floor = |_| [Content::Group(2), Content::Again(4), Content::Again(5)];
            let first = [Content::Group(2), ball(), Content::Again(1)];
            list(&first.into_iter().chain((1..floors).flat_map(floor)).collect::<Vec<_>>())
        };
        assert_eq!((tower(3).check(), tower(3).shape_count()), (Ok(()), 2 + 4 + 8));
        assert_eq!(tower(23).check(), Err(DesignError::TooMany));
        assert_eq!(tower(100_000).check(), Err(DesignError::Again(73)));
    }

    #[test]
    fn groups_of_nothing_cost_their_walk() {
        let group = |n: u32| {
            let repeat = Some(Repeat::Row { count: 1_000, step: [0; 3], centred: false });
            Piece { repeat, content: Content::Group(n), ..piece() }
        };
        let design = |depth: u32| Design { pieces: (0..depth).rev().map(group).collect(), ..Design::default() };
        assert_eq!((design(1).most_faces(), design(1).check()), (Ok(1_000), Ok(())));
        assert_eq!(design(2).check(), Ok(()));
        assert_eq!(design(3).check(), Err(DesignError::TooMany));
        assert_eq!((design(20).check(), design(20).shape_count()), (Err(DesignError::TooMany), 0));
    }

    fn piece() -> Piece {
        let content = Content::Group(0);
        Piece { at: [0; 3], turn: [0; 3], scale: [1024; 3], mirror: None, repeat: None, paint: 0, infill: None, content }
    }

    #[test]
    fn what_is_used_takes_parameters_and_paints() {
        let text = r##"[
            (name: "column", parameters: {"height": 3}, paints: {"stone": (colour: "#000001", tile: Stone)},
             parts: [(paint: "stone", shape: Cylinder(radius: 0.3, height: "height"))]),
            (name: "porch", paints: {"marble": (colour: "#000002", tile: Stone)},
             parts: [(uses: "column", with: {"height": "2 * 2.5"}, paints: {"stone": "marble"})]),
            (name: "wrong", parts: [(uses: "column", with: {"width": 1})]),
        ]"##;
        let all = read(text);
        let design = all.design("porch", &BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(design.materials, [Material { colour: crate::Rgb(0, 0, 2), tile: crate::Tile::Stone }]);
        assert_eq!(design.pieces[0].content, Content::Group(1));
        assert!(matches!(design.pieces[1].content, Content::Shape(Shape::Cylinder { height: 5120, .. })));
        let told = all.validate().iter().map(ToString::to_string).collect::<Vec<_>>();
        assert_eq!(told, ["monument `column` has no parameter `width`; it has: height"]);
    }

    #[test]
    fn designs_survive_files_and_packets() {
        let text = format!(
            "[(name: \"m\", {}, parts: [(paint: \"stone\", infill: \"stone\", repeat: Around(count: 3, arc_deg: 90), shape: Panel(
                outline: [(0, 0), (2, 0), (2, 3), (0, 3, 0.4)], depth: 0.5,
                holes: [(at: (1, 1), shape: Foil(0.4, 4), around: (6, 0.8))])),
              (paint: \"stone\", mirror: Y, shape: Tube(path: [(0, 0, 0, 0.1), (0, 1, 2, 0)]))])]",
            paint()
        );
        let monuments = read(&text);
        let again = file::to_text(&monuments).unwrap_or_default();
        assert_eq!(file::parse::<Monuments>(&again, "again").map_err(|e| e.to_string()), Ok(monuments.clone()));
        let design = monuments.design("m", &BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"));
        let text = file::to_text(&design).unwrap_or_default();
        assert_eq!(file::parse::<Design>(&text, "design").map_err(|e| e.to_string()), Ok(design.clone()));
    }
}
