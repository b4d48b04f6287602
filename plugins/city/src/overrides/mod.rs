mod areas;
mod cells;
mod check;
mod network;
#[cfg(test)]
mod survives;
mod target;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{
    Block, BlockKind, Building, CityGraph, Finding, FurnitureRule, Id, LinkKind, Monument, MonumentTag, Place, Ring, RoofTags,
    Severity, Square, StandIn, StandingObject, StyleDraft, Surfacing,
};
pub use cells::{CellOverride, CellsOverrides};
pub use check::OverrideError;
use network::Outcome;
pub use target::Target;
use target::{distance_to_ring, find, find_link};

/// A person's edits to a graph, in a file of their own (`X.graph.overrides.ron`), so that they survive a new survey.
///
/// ```
/// use veduta_city::{CityGraph, GraphOverrides, file};
///
/// let mut graph: CityGraph = file::parse(r#"(
///     name: "A cross", anchor: (lat: 50.09, lon: 14.42),
///     nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (80, 0)), (id: 3, pos: (0, 80)), (id: 4, pos: (-80, 0)), (id: 5, pos: (0, -80))],
///     links: [(id: 12, from: 1, to: 2, kind: Street(Lane)), (id: 13, from: 1, to: 3, kind: Street(Lane)),
///             (id: 14, from: 1, to: 4, kind: Street(Lane)), (id: 15, from: 1, to: 5, kind: Street(Lane))],
///     blocks: [(id: 21, outline: [(4, 4), (76, 4), (76, 76), (4, 76)])],
/// )"#, "cross.graph.ron")?;
/// let overrides: GraphOverrides = file::parse(r#"(edits: [
///     // The street map puts the eastern end too far south.
///     MoveNode(target: (id: 2, at: (80, 0)), to: (80, 6)),
///     // A passage that the survey missed, from the end of one lane to the middle of another, which it parts.
///     AddLink((from: (at: (80, 6)), to: (at: (0, 40)), kind: Street(Steps), name: "Long Steps")),
///     Link(target: (at: (-40, 0)), kind: Street(Main), width_m: 12, name: "West Street"),
///     SplitLink((at: (0, -40))),
///     // A market on the crossroads: the lanes end on its border.
///     AddSquare((name: "Market", outline: [(-9, -9), (9, -9), (9, 9), (-9, 9)])),
///     Courtyard(target: (id: 21, at: (40, 60)), ring: [(30, 55), (60, 55), (60, 70), (30, 70)]),
///     Block(target: (id: 21, at: (40, 60)), kind: Park, name: "Orchard"),
///     RemoveLink((at: (500, 500))),
/// ])"#, "cross.graph.overrides.ron")?;
/// assert_eq!(overrides.validate(), []);
/// let findings = overrides.apply(&mut graph);
/// assert_eq!(findings.len(), 1, "nothing is lost in silence");
/// assert_eq!(findings[0].message, "edit 8 (RemoveLink): nothing of that id, and no link within 5 m of that place");
/// assert_eq!((graph.squares.len(), graph.nodes.len(), graph.links.len()), (1, 10, 7));
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraphOverrides {
    /// Edits, applied in order.
    #[serde(default)]
    pub edits: Vec<GraphOverride>,
    /// Styles added to, or put in place of, the stock ones.
    #[serde(default)]
    pub styles: Vec<StyleDraft>,
    /// Monuments added to, or put in place of, the stock ones.
    #[serde(default)]
    pub monuments: Vec<Monument>,
    /// Models in files, under names that buildings, houses and objects call them by as they do monuments.
    #[serde(default)]
    pub models: Vec<ModelFile>,
    /// Façades given as pictures, and where they are.
    #[serde(default)]
    pub facades: Vec<FacadeFile>,
    /// Rules for furniture, added to, or put in place of, the stock ones.
    #[serde(default)]
    pub furniture: Vec<FurnitureRule>,
}

/// A model in a file: binary glTF (`.glb`), metres, y up, its front to +z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// What it is called by; goes before a stock monument of that name.
    pub name: String,
    /// The file, by its path from the folder of the overrides.
    pub file: String,
    /// The node of the file that it is, with all below it; the whole scene if not given.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub node: String,
}

/// A painted façade ([`FacadeDraft`](crate::FacadeDraft)) in a file, and the wall that it is on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacadeFile {
    /// The file (`.facade.ron`), by its path from the folder of the overrides.
    pub file: String,
    /// A place before the wall: it goes on the street front that is nearest.
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
        /// What is seen in place of walls and roofs.
        #[serde(default)]
        monument: Option<MonumentTag>,
    },
    /// Put a monument or a model in place of a house, whether the graph gives it or growth builds it; the place is in its footprint.
    House(StandIn),
    /// Take a building out.
    RemoveBuilding(Target),
    /// Put a building in.
    AddBuilding(Box<Building>),
    /// Change the width of a link, from end to end.
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
    /// Change a link; what is not given stays.
    Link {
        /// Which.
        target: Target,
        /// New kind, with its class.
        #[serde(default)]
        kind: Option<LinkKind>,
        /// New width from end to end, metres; 0 gives the class's own back.
        #[serde(default)]
        width_m: Option<f64>,
        /// New name.
        #[serde(default)]
        name: Option<String>,
        /// New layer: 0 ground, above for bridges, below for tunnels.
        #[serde(default)]
        layer: Option<i8>,
        /// New paving.
        #[serde(default)]
        surfacing: Option<Surfacing>,
    },
    /// Move a node, and the ends of its links with it. Onto another node it does not go: join the two.
    MoveNode {
        /// Which.
        target: Target,
        /// Where to, plan metres.
        to: DVec2,
    },
    /// Put a node in that no link ends at yet, for links to come. (A new link makes its own nodes.)
    AddNode {
        /// Its id; from its place if not given.
        #[serde(default)]
        id: Id,
        /// Plan metres.
        at: DVec2,
        /// Elevation, metres.
        #[serde(default)]
        z: f64,
    },
    /// Take a node out. A blind alley's link goes with it; where two links meet they become one, with the longer one's id and
    /// nature; at a crossroads nothing is done, and the edit is reported.
    RemoveNode(Target),
    /// Make one node of two: links that ended at the second end at the first.
    JoinNodes {
        /// The node that stays.
        target: Target,
        /// The node that goes.
        with: Target,
    },
    /// Put a link in.
    AddLink(Box<LinkEdit>),
    /// Take a link out, and nodes at which nothing ends any more.
    RemoveLink(Target),
    /// Part a link at the point of it that is nearest to the target's place. The first part keeps the id.
    SplitLink(Target),
    /// Put a square in. Streets on the ground end on its border; what lies inside goes.
    AddSquare(Square),
    /// Take a square out.
    RemoveSquare(Target),
    /// Put a block in.
    AddBlock(Block),
    /// Take a block out.
    RemoveBlock(Target),
    /// Cut a courtyard out of a block.
    Courtyard {
        /// The block.
        target: Target,
        /// The courtyard's outline, either way round, plan metres.
        ring: Ring,
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
        /// New name.
        #[serde(default)]
        name: Option<String>,
    },
    /// Put an object in.
    AddObject(StandingObject),
    /// Take an object out.
    RemoveObject(Target),
    /// Put a place in.
    AddPlace(Place),
}

/// A link that an edit puts in. An end takes the node within 5 m of it, or parts the link that it lies on, or makes a node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkEdit {
    /// Its id; from its place if not given.
    #[serde(default)]
    pub id: Id,
    /// Its first end.
    pub from: Target,
    /// Its last end.
    pub to: Target,
    /// Inner vertices, plan metres.
    #[serde(default)]
    pub via: Vec<DVec2>,
    /// What it is.
    pub kind: LinkKind,
    /// Full width in metres; 0 means the class's default.
    #[serde(default)]
    pub width_m: f64,
    /// Name, may be empty.
    #[serde(default)]
    pub name: String,
    /// Layer: 0 ground, above for bridges, below for tunnels.
    #[serde(default)]
    pub layer: i8,
    /// Paving; the class decides if not given.
    #[serde(default)]
    pub surfacing: Option<Surfacing>,
}

impl GraphOverrides {
    /// Applies the edits to a graph, in order; each sees what those before it did. An edit that cannot be applied (its thing is
    /// found neither by id nor by place, or might be either of two, or what it asks for is no good) is left out and reported,
    /// with its number and the reason; so is what is worth knowing of one that was applied.
    ///
    /// New links and squares without an id stay so: call [`CityGraph::fill_ids`] after.
    #[must_use]
    pub fn apply(&self, graph: &mut CityGraph) -> Vec<Finding> {
        let mut findings = Vec::new();
        for (i, edit) in self.edits.iter().enumerate() {
            let (id, at) = edit.subject();
            let (severity, messages) = match edit.apply(graph) {
                Ok(notes) => (Severity::Note, notes),
                Err(reason) => (Severity::Dropped, vec![reason]),
            };
            let tell = |m: String| Finding::new(severity, id, at, format!("edit {} ({}): {m}", i + 1, edit.kind()));
            findings.extend(messages.into_iter().map(tell));
        }
        findings
    }
}

impl GraphOverride {
    /// Id and place that the edit names.
    fn subject(&self) -> (Id, Option<DVec2>) {
        let of = |target: &Target| (target.id, Some(target.at));
        match self {
            Self::Building { target, .. }
            | Self::Width { target, .. }
            | Self::Name { target, .. }
            | Self::Link { target, .. }
            | Self::MoveNode { target, .. }
            | Self::JoinNodes { target, .. }
            | Self::Courtyard { target, .. }
            | Self::Block { target, .. }
            | Self::RemoveBuilding(target)
            | Self::RemoveNode(target)
            | Self::RemoveLink(target)
            | Self::SplitLink(target)
            | Self::RemoveSquare(target)
            | Self::RemoveBlock(target)
            | Self::RemoveObject(target) => of(target),
            Self::House(stand_in) => of(&stand_in.target),
            Self::AddNode { id, at, .. } => (*id, Some(*at)),
            Self::AddLink(link) => (link.id, Some(link.from.at)),
            Self::AddSquare(square) => (square.id, square.outline.first().copied()),
            Self::AddBlock(block) => (block.id, block.outline.first().copied()),
            Self::AddBuilding(building) => (building.id, building.outline.first().copied()),
            Self::AddObject(object) => (object.id, Some(object.pos)),
            Self::AddPlace(place) => (place.id, Some(place.pos)),
        }
    }

    fn apply(&self, graph: &mut CityGraph) -> Outcome {
        match self {
            Self::Building { .. } => self.change_building(graph),
            Self::Block { .. } => self.change_block(graph),
            Self::Link { .. } | Self::Width { .. } | Self::Name { .. } => self.change_link(graph),
            Self::MoveNode { target, to } => network::move_node(graph, target, *to),
            Self::AddNode { id, at, z } => network::add_node(graph, *id, *at, *z),
            Self::RemoveNode(target) => network::remove_node(graph, target),
            Self::JoinNodes { target, with } => network::join_nodes(graph, target, with),
            Self::AddLink(link) => network::add_link(graph, link),
            Self::RemoveLink(target) => network::remove_link(graph, target),
            Self::SplitLink(target) => network::split_link(graph, target),
            Self::AddSquare(square) => areas::add_square(graph, square),
            Self::RemoveSquare(target) => areas::remove_square(graph, target),
            Self::RemoveBlock(target) => areas::remove_block(graph, target),
            Self::Courtyard { target, ring } => areas::add_courtyard(graph, target, ring),
            Self::RemoveBuilding(target) => {
                let (i, note) = find_building(graph, target)?;
                graph.buildings.remove(i);
                Ok(note.into_iter().collect())
            }
            Self::RemoveObject(target) => {
                let (i, note) = find("object", &graph.objects, target, |o| (o.id, o.pos.distance(target.at)))?;
                graph.objects.remove(i);
                Ok(note.into_iter().collect())
            }
            Self::House(stand_in) => {
                graph.stand_ins.push(stand_in.clone());
                Ok(Vec::new())
            }
            Self::AddBlock(block) => put(&mut graph.blocks, block.clone()),
            Self::AddBuilding(building) => put(&mut graph.buildings, (**building).clone()),
            Self::AddObject(object) => put(&mut graph.objects, object.clone()),
            Self::AddPlace(place) => put(&mut graph.places, place.clone()),
        }
    }

    fn change_building(&self, graph: &mut CityGraph) -> Outcome {
        let Self::Building { target, name, style, height_m, levels, roof, colour, monument } = self else { return Ok(Vec::new()) };
        let (i, note) = find_building(graph, target)?;
        let b = &mut graph.buildings[i];
        set(&mut b.name, name.as_ref());
        set(&mut b.style, style.as_ref());
        set(&mut b.roof, roof.as_ref());
        b.height_m = height_m.or(b.height_m);
        b.levels = levels.or(b.levels);
        b.colour = colour.or(b.colour);
        b.monument = monument.clone().or(b.monument.take());
        Ok(note.into_iter().collect())
    }

    fn change_block(&self, graph: &mut CityGraph) -> Outcome {
        let Self::Block { target, kind, district, name } = self else { return Ok(Vec::new()) };
        let (i, note) = areas::find_block(graph, target)?;
        let b = &mut graph.blocks[i];
        set(&mut b.kind, kind.as_ref());
        set(&mut b.district, district.as_ref());
        set(&mut b.name, name.as_ref());
        Ok(note.into_iter().collect())
    }

    fn change_link(&self, graph: &mut CityGraph) -> Outcome {
        type Change<'a> = (&'a Target, Option<&'a LinkKind>, Option<f64>, Option<&'a String>, Option<i8>, Option<Surfacing>);
        let (target, kind, width_m, name, layer, surfacing): Change<'_> = match self {
            Self::Width { target, width_m } => (target, None, Some(*width_m), None, None, None),
            Self::Name { target, name } => (target, None, None, Some(name), None, None),
            Self::Link { target, kind, width_m, name, layer, surfacing } => {
                (target, kind.as_ref(), *width_m, name.as_ref(), *layer, *surfacing)
            }
            _ => return Ok(Vec::new()),
        };
        let (i, note) = find_link(graph, target)?;
        let link = &mut graph.links[i];
        set(&mut link.kind, kind);
        set(&mut link.name, name);
        if width_m.is_some() {
            // One width for all of it.
            link.profile.clear();
        }
        set(&mut link.width_m, width_m.as_ref());
        set(&mut link.layer, layer.as_ref());
        link.surfacing = surfacing.or(link.surfacing);
        Ok(note.into_iter().collect())
    }
}

fn find_building(graph: &CityGraph, target: &Target) -> target::Found {
    find("building", &graph.buildings, target, |b| (b.id, distance_to_ring(&b.outline, target.at)))
}

fn put<T>(things: &mut Vec<T>, thing: T) -> Outcome {
    things.push(thing);
    Ok(Vec::new())
}

fn set<T: Clone>(slot: &mut T, new: Option<&T>) {
    if let Some(new) = new {
        slot.clone_from(new);
    }
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
        let told: Vec<&str> = findings.iter().map(|f| f.message.as_str()).collect();
        let expected = [
            "edit 2 (RemoveBuilding): the building of that id is 1261.5 m away from that place now",
            "edit 3 (RemoveObject): nothing of that id, and no object within 5 m of that place",
        ];
        assert_eq!(told, expected);
    }
}
