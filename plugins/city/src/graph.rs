use std::collections::{HashMap, HashSet};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{Anchor, Id, MonumentTag, Opening, Place, Rgb, StandingObject, Target, Terrain, Viewpoint, WidthAt};

/// A closed ring in plan metres; the last vertex joins the first and is not repeated.
pub type Ring = Vec<DVec2>;

/// The city graph: streets, squares, blocks, given houses and standing objects, in plan metres. It is what survey makes,
/// what a person edits, and what growth turns into a plan.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CityGraph {
    /// Name of the city.
    pub name: String,
    /// Where plan (0, 0) lies on Earth.
    pub anchor: Anchor,
    /// Elevation of the city's zero in metres above the sea: what is added to a node's `z` to get its elevation on a map. 0
    /// where no terrain is known.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub zero_m: f64,
    /// Elevations of the ground; without them it is level.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terrain: Option<Terrain>,
    /// Who is to be credited for the data, as the licence asks.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub attribution: String,
    /// Seed of every draw that growth makes.
    #[serde(default)]
    pub seed: u64,
    /// Where a visit begins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Viewpoint>,
    /// Half-size of the ground beyond the outermost thing, in metres.
    #[serde(default = "CityGraph::default_margin_m")]
    pub margin_m: f64,
    /// Where links meet, end or change.
    #[serde(default)]
    pub nodes: Vec<Node>,
    /// Streets, railways and watercourses.
    #[serde(default)]
    pub links: Vec<Link>,
    /// Squares.
    #[serde(default)]
    pub squares: Vec<Square>,
    /// Blocks: built, park, monument, water.
    #[serde(default)]
    pub blocks: Vec<Block>,
    /// Houses whose footprint is known.
    #[serde(default)]
    pub buildings: Vec<Building>,
    /// Lamps, trees, benches, fountains and the like.
    #[serde(default)]
    pub objects: Vec<StandingObject>,
    /// Things with a name.
    #[serde(default)]
    pub places: Vec<Place>,
    /// What is seen in place of houses, given or grown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stand_ins: Vec<StandIn>,
}

/// A monument or a model that is seen in place of a house.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandIn {
    /// The house: by its id, or by a place in its footprint.
    pub target: Target,
    /// What is seen; it stands where the house does.
    pub monument: MonumentTag,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// An end of links.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// Stable id; links refer to it.
    pub id: Id,
    /// Plan metres.
    pub pos: DVec2,
    /// Elevation in metres above the city's zero ([`CityGraph::zero_m`]).
    #[serde(default)]
    pub z: f64,
}

/// What a node is, by the links that end there. Derived, never stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NodeKind {
    /// No link ends here.
    Lone,
    /// One link ends here.
    BlindAlley,
    /// Two links join: a name, width or class changes.
    Joint,
    /// Three or more links meet.
    Crossroads,
}

/// Class of a street, widest claim on space first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum StreetClass {
    /// Motorway, trunk.
    Motorway,
    /// Primary, secondary.
    Main,
    /// Tertiary, unclassified, residential.
    #[default]
    Street,
    /// Living street, pedestrian street, lane.
    Lane,
    /// Service road, driveway, alley for vehicles.
    Service,
    /// Footway, path, passage, cycleway.
    Path,
    /// Stairs.
    Steps,
}

impl StreetClass {
    /// All of them, the greatest first.
    pub const ALL: [Self; 7] = [Self::Motorway, Self::Main, Self::Street, Self::Lane, Self::Service, Self::Path, Self::Steps];

    /// Width from wall to wall, or of the way itself, where a map gives none; metres.
    #[must_use]
    pub const fn default_width_m(self) -> f64 {
        match self {
            Self::Motorway => 18.0,
            Self::Main => 14.0,
            Self::Street => 10.0,
            Self::Lane => 6.5,
            Self::Service => 4.0,
            Self::Path | Self::Steps => 2.5,
        }
    }

    /// Whether vehicles have a carriageway of their own between kerbs.
    #[must_use]
    pub const fn has_carriageway(self) -> bool {
        matches!(self, Self::Motorway | Self::Main | Self::Street)
    }
}

/// Paving of a street or square.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Surfacing {
    /// Asphalt.
    Asphalt,
    /// Setts, about 10 cm.
    #[default]
    Cobbles,
    /// Mosaic of small stones, about 6 cm.
    Mosaic,
    /// Flagstones, concrete slabs.
    Flagstones,
    /// Gravel, earth, sand.
    Gravel,
    /// Grass.
    Grass,
}

/// What a link is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LinkKind {
    /// A street or way for people.
    Street(StreetClass),
    /// Rails. `tram` ones lie in a street.
    Railway {
        /// Whether they lie in a street's surface.
        tram: bool,
    },
    /// River, canal, stream.
    Watercourse,
}

/// A polyline between two nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Stable id; hashed from kind and middle when not given.
    #[serde(default)]
    pub id: Id,
    /// First node.
    pub from: Id,
    /// Last node.
    pub to: Id,
    /// Inner vertices (curve nodes), plan metres.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<DVec2>,
    /// What it is.
    pub kind: LinkKind,
    /// Full width in metres; 0 means the mean of its profile, or the class's default.
    #[serde(default)]
    pub width_m: f64,
    /// Widths from place to place, where they vary, in the order of the line; empty where it is `width_m` wide all along. See
    /// [`Link::width_at`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub profile: Vec<WidthAt>,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Layer: 0 ground, above for bridges, below for tunnels.
    #[serde(default)]
    pub layer: i8,
    /// Paving; the class decides if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surfacing: Option<Surfacing>,
}

impl Link {
    /// Width in metres: its own, its profile's mean, or its class's. Where it varies, that is the width it mostly has; see
    /// [`Link::width_at`].
    #[must_use]
    pub fn width(&self) -> f64 {
        if self.width_m > 0.0 {
            return self.width_m;
        }
        if let Some(mean) = WidthAt::mean(&self.profile) {
            return mean;
        }
        match self.kind {
            LinkKind::Street(class) => class.default_width_m(),
            LinkKind::Railway { .. } => 4.0,
            LinkKind::Watercourse => 6.0,
        }
    }
}

/// An open place between houses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Square {
    /// Stable id; hashed from kind and centre when not given.
    #[serde(default)]
    pub id: Id,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Outline, counter-clockwise, plan metres.
    pub outline: Ring,
    /// Holes, clockwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<Ring>,
    /// Paving.
    #[serde(default)]
    pub surfacing: Surfacing,
}

/// What a block holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum BlockKind {
    /// Houses; grown where none are given.
    #[default]
    Built,
    /// Lawn, trees, paths.
    Park,
    /// A monument's ground: kept free.
    Monument,
    /// Open water.
    Water,
}

/// What streets enclose, or an area of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Stable id; hashed from kind and centre when not given.
    #[serde(default)]
    pub id: Id,
    /// What it holds.
    #[serde(default)]
    pub kind: BlockKind,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Name of the style its houses are grown in; empty: by seed.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub district: String,
    /// Outline, counter-clockwise, plan metres.
    pub outline: Ring,
    /// Holes, clockwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<Ring>,
}

/// Shape of a roof, in the words of OpenStreetMap's `roof:shape`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum RoofShape {
    /// Level.
    Flat,
    /// Two slopes and two gables.
    #[default]
    Gabled,
    /// Slopes on every side.
    Hipped,
    /// Gables cut by small hips.
    HalfHipped,
    /// Slopes that meet in a point.
    Pyramidal,
    /// One slope.
    Skillion,
    /// Hipped with a steep lower part.
    Mansard,
    /// Gabled with a steep lower part.
    Gambrel,
    /// Half sphere.
    Dome,
    /// Onion.
    Onion,
    /// Cone.
    Cone,
    /// Half cylinder.
    Round,
    /// A row of skillions.
    SawTooth,
}

/// What a map says of a roof.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoofTags {
    /// Shape; the style decides if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<RoofShape>,
    /// From eaves to ridge, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Direction in which the (main) slope falls, degrees clockwise from north.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// Whether the ridge runs across the longer side.
    #[serde(default)]
    pub across: bool,
    /// Colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Rgb>,
}

/// A body of a building that is not simply its whole footprint: a tower, a wing, a dome on a roof.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BuildingPart {
    /// Stable id; hashed when not given.
    #[serde(default)]
    pub id: Id,
    /// Outline, counter-clockwise, plan metres.
    pub outline: Ring,
    /// Holes, clockwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<Ring>,
    /// Underside above the ground, metres.
    #[serde(default)]
    pub min_height_m: f64,
    /// Top (ridge) above the ground, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Storeys, from the ground (also those below `min_height_m`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub levels: Option<f64>,
    /// Roof.
    #[serde(default)]
    pub roof: RoofTags,
    /// Colour of the walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Rgb>,
    /// What every bay of its walls holds, in place of what the style says: a clock, say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening: Option<Opening>,
}

/// A building whose footprint is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Building {
    /// Stable id; hashed from kind and centre when not given.
    #[serde(default)]
    pub id: Id,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// House number, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub number: String,
    /// Name of a style; empty: by seed.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub style: String,
    /// Outline, counter-clockwise, plan metres.
    pub outline: Ring,
    /// Courtyards, clockwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<Ring>,
    /// Underside above the ground, metres (a house over a passage).
    #[serde(default)]
    pub min_height_m: f64,
    /// Top (ridge) above the ground, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Storeys below the eaves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub levels: Option<f64>,
    /// Roof.
    #[serde(default)]
    pub roof: RoofTags,
    /// Colour of the walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Rgb>,
    /// Parts. If there are any, they stand instead of the outline.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<BuildingPart>,
    /// What is seen in place of walls and roofs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub monument: Option<MonumentTag>,
}

impl CityGraph {
    /// Ground kept beyond the outermost thing where a file says nothing; metres.
    #[must_use]
    pub const fn default_margin_m() -> f64 {
        30.0
    }

    /// Whether everything has an id, so that [`fill_ids`](Self::fill_ids) has nothing to do.
    #[must_use]
    pub fn has_ids(&self) -> bool {
        let Self { links, squares, blocks, buildings, objects, places, .. } = self;
        let of_buildings = buildings.iter().flat_map(|b| b.parts.iter().map(|part| part.id).chain([b.id]));
        let of_ground = links.iter().map(|l| l.id).chain(squares.iter().map(|s| s.id)).chain(blocks.iter().map(|b| b.id));
        let of_rest = objects.iter().map(|o| o.id).chain(places.iter().map(|p| p.id));
        of_ground.chain(of_buildings).chain(of_rest).all(|id| id.is_given())
    }

    /// Gives every thing that has no id one from its kind and place, moving on where two would share one. Call after
    /// reading a file written by hand; idempotent.
    pub fn fill_ids(&mut self) {
        let at: HashMap<Id, DVec2> = self.nodes.iter().map(|n| (n.id, n.pos)).collect();
        let middle = |ring: &[DVec2]| ring.iter().copied().sum::<DVec2>() / ring.len().max(1) as f64;
        fn fill(taken: &mut HashSet<Id>, id: &mut Id, kind: &str, pos: DVec2) {
            if !id.is_given() {
                *id = Id::from_place(kind, pos);
                while taken.contains(id) {
                    id.0 = id.0.wrapping_add(1) | 1 << 63;
                }
            }
            taken.insert(*id);
        }
        let mut taken: HashSet<Id> = self.links.iter().map(|l| l.id).filter(|id| id.is_given()).collect();
        for link in &mut self.links {
            let ends = [at.get(&link.from), at.get(&link.to)].map(|p| p.copied().unwrap_or_default());
            let mean = link.via.get(link.via.len() / 2).copied().unwrap_or((ends[0] + ends[1]) / 2.0);
            fill(&mut taken, &mut link.id, "link", mean);
        }
        let mut taken = HashSet::new();
        for square in &mut self.squares {
            fill(&mut taken, &mut square.id, "square", middle(&square.outline));
        }
        let mut taken = HashSet::new();
        for block in &mut self.blocks {
            fill(&mut taken, &mut block.id, "block", middle(&block.outline));
        }
        let mut taken: HashSet<Id> = self.buildings.iter().map(|b| b.id).filter(|id| id.is_given()).collect();
        for building in &mut self.buildings {
            fill(&mut taken, &mut building.id, "building", middle(&building.outline));
            let mut parts = HashSet::new();
            for part in &mut building.parts {
                fill(&mut parts, &mut part.id, "part", middle(&part.outline));
            }
        }
        let mut taken: HashSet<Id> = self.objects.iter().map(|o| o.id).filter(|id| id.is_given()).collect();
        for object in &mut self.objects {
            fill(&mut taken, &mut object.id, "object", object.pos);
        }
        let mut taken: HashSet<Id> = self.places.iter().map(|p| p.id).filter(|id| id.is_given()).collect();
        for place in &mut self.places {
            fill(&mut taken, &mut place.id, "place", place.pos);
        }
    }

    /// The whole polyline of a link, ends included; `None` if an end is unknown.
    #[must_use]
    pub fn polyline(&self, link: &Link, at: &HashMap<Id, DVec2>) -> Option<Vec<DVec2>> {
        let (from, to) = (*at.get(&link.from)?, *at.get(&link.to)?);
        Some(core::iter::once(from).chain(link.via.iter().copied()).chain(core::iter::once(to)).collect())
    }

    /// Positions of the nodes by id.
    #[must_use]
    pub fn node_positions(&self) -> HashMap<Id, DVec2> {
        self.nodes.iter().map(|n| (n.id, n.pos)).collect()
    }

    /// Kind of every node, by how many street links end there.
    #[must_use]
    pub fn node_kinds(&self) -> HashMap<Id, NodeKind> {
        let mut ends: HashMap<Id, usize> = self.nodes.iter().map(|n| (n.id, 0)).collect();
        for link in &self.links {
            *ends.entry(link.from).or_default() += 1;
            *ends.entry(link.to).or_default() += 1;
        }
        let kind = |n| match n {
            0 => NodeKind::Lone,
            1 => NodeKind::BlindAlley,
            2 => NodeKind::Joint,
            _ => NodeKind::Crossroads,
        };
        ends.into_iter().map(|(id, n)| (id, kind(n))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{lane, node};

    #[test]
    fn filled_ids_are_unique_and_stay() {
        let mut graph = CityGraph {
            nodes: vec![node(1, 0.0, 0.0), node(2, 10.0, 0.0), node(3, 0.0, 10.0)],
            links: vec![lane(1, 2), lane(1, 2), lane(2, 3)],
            ..Default::default()
        };
        graph.fill_ids();
        let first: Vec<Id> = graph.links.iter().map(|l| l.id).collect();
        assert_eq!(first.iter().collect::<HashSet<_>>().len(), 3, "{first:?}");
        graph.fill_ids();
        assert_eq!(first, graph.links.iter().map(|l| l.id).collect::<Vec<_>>());
        assert!(graph.has_ids());
        assert_eq!(graph.node_kinds()[&Id(2)], NodeKind::Crossroads);
    }
}
