use serde::{Deserialize, Serialize};

use crate::{
    Anchor, Arcade, Course, Design, Gable, GridPolygon, GridPos, Id, ObjectKind, Ornament, Place, PlacedMonument, PlanFacade,
    PlanTerrain, Rgb, RoofShape, StreetClass, Styles, Viewpoint, WaySpan,
};

/// The city plan: everything that will stand and lie in the city, on the grid, with every choice made that looks at
/// neighbours. It is what growth makes and what is cut into cells.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CityPlan {
    /// Name of the city.
    pub name: String,
    /// Where plan (0, 0) lies on Earth.
    pub anchor: Anchor,
    /// Who is to be credited for the data.
    #[serde(default)]
    pub attribution: String,
    /// Seed of every draw.
    pub seed: u64,
    /// Version of growth that made it.
    pub growth_version: u32,
    /// The styles it was grown with; houses refer to them by index.
    pub styles: Styles,
    /// The monuments in it; houses refer to them by index.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub designs: Vec<Design>,
    /// Where a visit begins.
    pub start: Viewpoint,
    /// Edge of the modelled city, counter-clockwise.
    pub extent: GridPolygon,
    /// Elevations of the ground.
    #[serde(default, skip_serializing_if = "PlanTerrain::is_level")]
    pub terrain: PlanTerrain,
    /// Ground partition: patches do not overlap and leave no gap inside the extent, except under houses.
    pub ground: Vec<GroundPatch>,
    /// What patches are laid along.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub courses: Vec<Course>,
    /// Houses.
    pub houses: Vec<House>,
    /// Walls of them that somebody painted, ascending by wall.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub facades: Vec<PlanFacade>,
    /// What stands in the streets.
    pub objects: Vec<PlanObject>,
    /// What is painted on carriageways, and rails.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub markings: Vec<Marking>,
    /// Where ways leave the ground, on bridges and in tunnels: the spans of each one after another.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spans: Vec<WaySpan>,
    /// Centre lines with names, for maps, routes and labels.
    pub streets: Vec<PlanStreet>,
    /// Things with a name.
    pub places: Vec<Place>,
}

/// What covers a patch of ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum SurfaceKind {
    /// Carriageway, asphalt.
    Asphalt,
    /// Setts.
    Cobbles,
    /// Mosaic pavement beside a carriageway, and small-stone squares.
    Mosaic,
    /// Flagstones.
    Flagstones,
    /// Gravel, earth.
    Gravel,
    /// Lawn.
    Grass,
    /// Yard between houses: earth and old paving.
    Yard,
    /// Open water: not walkable.
    Water,
    /// Rails in ballast.
    Ballast,
    /// Nothing: the ground is open there, above a ramp that leads down to a tunnel. Not drawn and not walkable.
    Opening,
}

impl SurfaceKind {
    /// Whether people may walk on it.
    #[must_use]
    pub const fn is_walkable(self) -> bool {
        !matches!(self, Self::Water | Self::Opening)
    }

    /// Whether it belongs to streets and squares, where cells begin.
    #[must_use]
    pub const fn is_public(self) -> bool {
        matches!(self, Self::Asphalt | Self::Cobbles | Self::Mosaic | Self::Flagstones)
    }
}

/// A piece of ground.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundPatch {
    /// What covers it.
    pub surface: SurfaceKind,
    /// Where.
    pub outline: GridPolygon,
    /// Height of its top above the terrain, grid steps (pavements stand a kerb above the carriageway).
    pub z: i32,
    /// Index of the course that it is laid along; by the compass without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub course: Option<u32>,
}

/// A house: one or more volumes.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct House {
    /// Stable id.
    pub id: Id,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// House number, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub number: String,
    /// Index into [`CityPlan::styles`].
    pub style: u16,
    /// Its lowest floor above the city's zero, grid steps: what begins there stands on the ground, however that slopes.
    #[serde(default, skip_serializing_if = "is_at_zero")]
    pub floor: i32,
    /// Its bodies; never empty.
    pub volumes: Vec<Volume>,
    /// What is seen in place of the bodies' walls and roofs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub monument: Option<PlacedMonument>,
}

/// A vertical prism with a roof.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Volume {
    /// Outline; collinear neighbours are joined, so that every edge is one wall.
    pub footprint: GridPolygon,
    /// Foot of the walls above the city's zero, grid steps.
    pub bottom: i32,
    /// Eaves above the city's zero, grid steps.
    pub eaves: i32,
    /// Colour of the walls.
    pub colour: Rgb,
    /// Colour of mouldings and frames.
    pub trim: Rgb,
    /// Roof.
    pub roof: PlanRoof,
    /// Shape of its gables.
    #[serde(default, skip_serializing_if = "is_plain")]
    pub gable: Gable,
    /// One for each edge: of the outer ring in order, then of each hole in order.
    pub walls: Vec<Wall>,
    /// Walks that it hangs over, ascending by wall and span.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub arcades: Vec<Arcade>,
}

fn is_at_zero(height: &i32) -> bool {
    *height == 0
}

fn is_none(bays: &u32) -> bool {
    *bays == 0
}

fn is_plain(gable: &Gable) -> bool {
    *gable == Gable::Plain
}

impl Volume {
    /// Highest point of the roof above the city's zero, grid steps.
    #[must_use]
    pub const fn top(&self) -> i32 {
        self.eaves.saturating_add(if self.roof.height > 0 { self.roof.height } else { 0 })
    }
}

/// A roof, as it will be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanRoof {
    /// Shape.
    pub shape: RoofShape,
    /// Eaves to ridge, grid steps; [`PlanRoof::NONE`] if there is none.
    pub height: i32,
    /// Direction along which the ridge runs (for skillions: in which the slope falls), whole degrees clockwise from north,
    /// 0 to 359.
    pub direction: u16,
    /// Colour of the covering.
    pub colour: Rgb,
}

impl PlanRoof {
    /// The height of a roof that is not there, because another volume stands on all of its own.
    pub const NONE: i32 = -1;

    /// Whether there is a roof.
    #[must_use]
    pub const fn is_there(&self) -> bool {
        self.height != Self::NONE
    }
}

/// What a wall faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum WallKind {
    /// A street, square, park or water: a façade.
    Street,
    /// A courtyard or garden.
    #[default]
    Yard,
    /// A neighbour, over most of its length: no openings.
    Party,
}

/// One wall: an edge of a volume's footprint.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// What it faces.
    pub kind: WallKind,
    /// Number of bays (window axes); 0: a blind wall.
    pub bays: u8,
    /// Storeys from the ground up; they fill the wall from bottom to eaves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub storeys: Vec<Storey>,
    /// The ground floor's openings.
    #[serde(default)]
    pub ground_floor: GroundFloor,
    /// What it carries besides, if anything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ornament: Option<Box<Ornament>>,
}

/// One storey of a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Storey {
    /// Height, grid steps.
    pub height: i32,
    /// What every bay of it holds (on the ground floor: those that [`GroundFloor`] leaves).
    pub opening: Opening,
}

/// What fills one bay of one storey. Each is one small texture of the workshop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Opening {
    /// Bare wall.
    #[default]
    Blank,
    /// Plain rectangular window with sill.
    Window,
    /// Window with a moulded surround.
    FramedWindow,
    /// Window with surround and straight cornice above.
    CorniceWindow,
    /// Window with surround and triangular pediment.
    PedimentWindow,
    /// Round-arched window.
    ArchedWindow,
    /// Tall pointed window of a church.
    LancetWindow,
    /// Small square window of an attic.
    AtticWindow,
    /// Broad modern window.
    WideWindow,
    /// Narrow slit or loophole of a tower.
    Slit,
    /// House door: round-arched stone portal.
    Portal,
    /// Plain door.
    Door,
    /// Shop front with display window.
    Shop,
    /// Arch of an arcade.
    Arcade,
    /// Gate for carriages.
    Gate,
    /// Clock face.
    Clock,
    /// Louvred opening of a belfry.
    Belfry,
}

/// Openings of a wall's ground floor, bay by bay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundFloor {
    /// Bay of the door, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub door_bay: Option<u8>,
    /// The door.
    #[serde(default)]
    pub door: Opening,
    /// Bays of shops: bit i for bay i.
    #[serde(default)]
    pub shops: u32,
    /// Bays without an opening, because the ground before them is too high: bit i for bay i.
    #[serde(default, skip_serializing_if = "is_none")]
    pub blank: u32,
}

impl Wall {
    /// What fills a bay (from the wall's start) of a storey (from the ground).
    #[must_use]
    pub fn opening(&self, storey: usize, bay: u8) -> Opening {
        let Some(s) = self.storeys.get(storey) else { return Opening::Blank };
        if storey > 0 {
            return s.opening;
        }
        if self.ground_floor.door_bay == Some(bay) {
            return self.ground_floor.door;
        }
        let is_in = |bays: u32| bay < 32 && bays >> bay & 1 == 1;
        if is_in(self.ground_floor.blank) {
            return Opening::Blank;
        }
        if is_in(self.ground_floor.shops) {
            return Opening::Shop;
        }
        s.opening
    }
}

/// Something that stands in the city.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanObject {
    /// Stable id.
    pub id: Id,
    /// What it is.
    pub kind: ObjectKind,
    /// Where.
    pub pos: GridPos,
    /// Its foot above the city's zero, grid steps.
    pub z: i32,
    /// Where its front looks, whole degrees clockwise from north, 0 to 359.
    pub heading: u16,
    /// Height, grid steps; never 0.
    pub height: i32,
    /// Index of the design that it is seen as, in place of what its kind looks like.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub monument: Option<u16>,
}

/// Kind of a [`Marking`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum MarkingKind {
    /// A line.
    Line,
    /// A broken line, which begins with a dash: see [`Marking::DASH_M`].
    Dashes,
    /// Stripes along a carriageway, side by side along the marking's line, which leads across it.
    Zebra,
    /// The two rails of a tram, or of a railway that crosses a street: their heads lie even with the paving.
    Rails,
    /// The two rails of a railway on their sleepers.
    Track,
}

/// Something that is laid on the ground.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Marking {
    /// What it is.
    pub kind: MarkingKind,
    /// Its middle line: two vertices or more.
    pub line: Vec<GridPos>,
    /// Breadth across its line, grid steps: of paint; of a zebra, the length of its stripes; of rails, the gauge.
    pub width: i32,
    /// Height of what it is laid on above the terrain, grid steps.
    pub z: i32,
}

impl Marking {
    /// Length of a dash, metres.
    pub const DASH_M: f64 = 3.0;
    /// Length of the gap after it, metres.
    pub const GAP_M: f64 = 6.0;
}

/// A street's centre line.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanStreet {
    /// Stable id of the link.
    pub id: Id,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Vertices.
    pub line: Vec<GridPos>,
    /// Full width, grid steps.
    pub width: i32,
    /// Whether people can walk along it.
    pub walkable: bool,
    /// Layer: 0 ground.
    #[serde(default)]
    pub layer: i8,
    /// Class of the link: what names on maps go by, and which of them are stairs.
    #[serde(default)]
    pub class: StreetClass,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doors_and_shops_stand_only_on_the_ground_floor() {
        let storey = |opening| Storey { height: 3072, opening };
        let wall = Wall {
            kind: WallKind::Street,
            bays: 3,
            storeys: vec![storey(Opening::Window), storey(Opening::FramedWindow)],
            ground_floor: GroundFloor { door_bay: Some(1), door: Opening::Portal, shops: 0b101, blank: 0b001 },
            ornament: None,
        };
        let row = |s| (0..3).map(|b| wall.opening(s, b)).collect::<Vec<_>>();
        assert_eq!(row(0), [Opening::Blank, Opening::Portal, Opening::Shop]);
        assert_eq!(row(1), [Opening::FramedWindow; 3]);
        assert_eq!(wall.opening(9, 0), Opening::Blank);
    }
}
