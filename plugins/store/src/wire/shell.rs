use serde::{Deserialize, Serialize};
use veduta_city::{
    Arcade, CellShell, Course, Design, GRID_PER_METRE, Gable, GridPolygon, GridPos, GroundPatch, HouseShell, Marking, MarkingKind,
    Massing, ObjectKind, ObjectShell, PlacedMonument, PlanRoof, PlanTerrain, RoofShape, SurfaceKind, VolumeShell, WaySpan,
};

use super::{
    paint::{Brush, Paint},
    terrain::WireTerrain,
};
use crate::PacketContext;
use crate::code::{Handmade, Outlines, Source, Unread};

/// Sections of outlines.
const OUTLINE: u8 = 0;
const FOOTPRINTS: u8 = 1;
const PATCHES: u8 = 2;
const PLACES: u8 = 3;
const BLIND: u8 = 4;
const MARKINGS: u8 = 5;
const COURSES: u8 = 6;

/// A [`CellShell`] in rows. Vertices of the cell's outline are known from the index.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireShell {
    /// From the middle of the cell's bounds, to whole metres.
    origin: GridPos,
    terrain: WireTerrain,
    houses: Vec<WireHouse>,
    ground: Vec<WirePatch>,
    objects: Vec<WireObject>,
    /// How many blind portals there are.
    blind: u32,
    markings: Vec<WireMarking>,
    /// Where each course begins.
    courses: Vec<i32>,
    designs: Handmade<Vec<Design>>,
    monuments: Vec<PlacedMonument>,
    spans: Vec<WaySpan>,
    drawn_spans: u32,
}

#[derive(Serialize, Deserialize)]
struct WireHouse {
    style: u16,
    /// Above that of the house before.
    floor: i32,
    is_monument: bool,
    volumes: Vec<WireVolume>,
}

#[derive(Serialize, Deserialize)]
struct WireVolume {
    /// Above the house's floor.
    bottom: i32,
    /// Above the bottom.
    eaves: i32,
    /// Its direction: quarter turns from the footprint's longest edge, and degrees beyond.
    roof: (RoofShape, i32, u8, i16),
    has_roof: bool,
    gable: Gable,
    /// Steps from one to the next.
    walls: Vec<u16>,
    arcades: Vec<Arcade>,
    /// None: as the volume before.
    paint: Option<Paint>,
}

#[derive(Serialize, Deserialize)]
struct WirePatch {
    surface: SurfaceKind,
    /// Above that of the patch before.
    z: i32,
    /// 0: none; else one more than the course.
    course: u32,
}

#[derive(Serialize, Deserialize)]
struct WireObject {
    kind: ObjectKind,
    height: i32,
    heading: u16,
    /// Above that of the object before.
    z: i32,
    design: Option<u16>,
}

#[derive(Serialize, Deserialize)]
struct WireMarking {
    kind: MarkingKind,
    width: i32,
    /// Above that of the marking before.
    z: i32,
}

/// Numbers told as steps from one to the next; wraps, so that any numbers survive.
#[derive(Default)]
struct Steps(i32);

impl Steps {
    fn to(&mut self, n: i32) -> i32 {
        n.wrapping_sub(core::mem::replace(&mut self.0, n))
    }

    fn by(&mut self, step: i32) -> i32 {
        self.0 = self.0.wrapping_add(step);
        self.0
    }
}

/// What is known of a cell's vertices, from an origin.
fn known(context: PacketContext<'_>, origin: GridPos) -> GridPolygon {
    let Some(outline) = context.outline else { return GridPolygon::default() };
    let local = |&p: &GridPos| GridPos(p.0.wrapping_sub(origin.0), p.1.wrapping_sub(origin.1));
    let ring = |ring: &Vec<GridPos>| ring.iter().map(local).collect();
    GridPolygon { outer: ring(&outline.outer), holes: outline.holes.iter().map(ring).collect() }
}

fn middle(context: PacketContext<'_>) -> GridPos {
    let (lo, hi) = context.outline.and_then(GridPolygon::bounds).unwrap_or_default();
    lo.midpoint(hi).rounded(GRID_PER_METRE)
}

impl WireShell {
    pub(crate) fn of(shell: &CellShell, context: PacketContext<'_>) -> (Self, Outlines) {
        let (origin, middle) = (shell.origin, middle(context));
        let mut outlines = Outlines::default();
        outlines.know(&known(context, origin));
        outlines.polygon(OUTLINE, &shell.outline);
        // Houses first: the ground between them then walks along edges already told.
        shell.houses.iter().flat_map(|house| &house.volumes).for_each(|volume| outlines.polygon(FOOTPRINTS, &volume.footprint));
        shell.ground.iter().for_each(|patch| outlines.polygon(PATCHES, &patch.outline));
        shell.objects.iter().for_each(|object| outlines.point(PLACES, object.pos));
        for &(from, to) in &shell.blind {
            outlines.point(BLIND, from);
            outlines.point(BLIND, to);
        }
        shell.markings.iter().for_each(|marking| outlines.line(MARKINGS, &marking.line));
        shell.courses.iter().for_each(|course| outlines.line(COURSES, &course.line));
        let (mut z, mut feet, mut paint) = (Steps::default(), Steps::default(), Steps::default());
        let patch = |patch: &GroundPatch| WirePatch {
            surface: patch.surface,
            z: z.to(patch.z),
            course: patch.course.map_or(0, |course| course.saturating_add(1)),
        };
        let object = |object: &ObjectShell| WireObject {
            kind: object.kind,
            height: object.height,
            heading: object.heading,
            z: feet.to(object.z),
            design: object.monument,
        };
        let marking = |marking: &Marking| WireMarking { kind: marking.kind, width: marking.width, z: paint.to(marking.z) };
        let wire = Self {
            origin: GridPos(origin.0.wrapping_sub(middle.0), origin.1.wrapping_sub(middle.1)),
            terrain: WireTerrain::from(&shell.terrain),
            houses: houses(shell, context),
            ground: shell.ground.iter().map(patch).collect(),
            objects: shell.objects.iter().map(object).collect(),
            blind: shell.blind.len() as u32,
            markings: shell.markings.iter().map(marking).collect(),
            courses: shell.courses.iter().map(|course| course.from).collect(),
            designs: Handmade(shell.designs.clone()),
            monuments: shell.monuments.clone(),
            spans: shell.spans.clone(),
            drawn_spans: shell.drawn_spans,
        };
        (wire, outlines)
    }

    pub(crate) fn pull(self, context: PacketContext<'_>, outlines: &mut Source<'_, '_>) -> Result<CellShell, Unread> {
        let middle = middle(context);
        let origin = GridPos(middle.0.wrapping_add(self.origin.0), middle.1.wrapping_add(self.origin.1));
        outlines.know(&known(context, origin));
        let outline = outlines.polygon(OUTLINE)?;
        let houses = pull_houses(self.houses, context, outlines)?;
        let (mut z, mut feet, mut paint) = (Steps::default(), Steps::default(), Steps::default());
        let ground = self.ground.into_iter().map(|patch| {
            let course = patch.course.checked_sub(1);
            Ok(GroundPatch { surface: patch.surface, outline: outlines.polygon(PATCHES)?, z: z.by(patch.z), course })
        });
        let ground = ground.collect::<Result<_, Unread>>()?;
        let objects = self.objects.into_iter().map(|object| {
            let WireObject { kind, height, heading, z, design: monument } = object;
            Ok(ObjectShell { kind, pos: outlines.point(PLACES)?, z: feet.by(z), heading, height, monument })
        });
        let objects = objects.collect::<Result<_, Unread>>()?;
        let blind = (0..self.blind).map(|_| Ok((outlines.point(BLIND)?, outlines.point(BLIND)?)));
        let blind = blind.collect::<Result<_, Unread>>()?;
        let markings = self.markings.into_iter().map(|marking| {
            let WireMarking { kind, width, z } = marking;
            Ok(Marking { kind, line: outlines.line(MARKINGS)?, width, z: paint.by(z) })
        });
        let markings = markings.collect::<Result<_, Unread>>()?;
        let courses = self.courses.into_iter().map(|from| Ok(Course { line: outlines.line(COURSES)?, from }));
        let courses = courses.collect::<Result<_, Unread>>()?;
        Ok(CellShell {
            origin,
            outline,
            terrain: PlanTerrain::try_from(self.terrain)?,
            ground,
            courses,
            houses,
            objects,
            blind,
            markings,
            spans: self.spans,
            drawn_spans: self.drawn_spans,
            designs: self.designs.0,
            monuments: self.monuments,
        })
    }
}

/// Rows of a shell's houses.
fn houses(shell: &CellShell, context: PacketContext<'_>) -> Vec<WireHouse> {
    let mut floors = Steps::default();
    let mut brush = Brush::new(context.palettes);
    let mut volume = |house: &HouseShell, volume: &VolumeShell| {
        let mut next = 0_u16;
        let step = |&wall: &u16| wall.wrapping_sub(core::mem::replace(&mut next, wall.wrapping_add(1)));
        let quarter = Massing::nearest_quarter(&volume.footprint, volume.roof.direction);
        let beyond = (volume.roof.direction.wrapping_sub(Massing::quarter_deg(&volume.footprint, quarter))) as i16;
        WireVolume {
            bottom: volume.bottom.wrapping_sub(house.floor),
            eaves: volume.eaves.wrapping_sub(volume.bottom),
            roof: (volume.roof.shape, volume.roof.height, quarter, beyond),
            has_roof: volume.has_roof,
            gable: volume.gable,
            walls: volume.walls.iter().map(step).collect(),
            arcades: volume.arcades.clone(),
            paint: brush.tell(house.style, [volume.colour, volume.trim, volume.roof.colour]),
        }
    };
    let row = |house: &HouseShell| WireHouse {
        style: house.style,
        floor: floors.to(house.floor),
        is_monument: house.is_monument,
        volumes: house.volumes.iter().map(|v| volume(house, v)).collect(),
    };
    shell.houses.iter().map(row).collect()
}

fn pull_houses(rows: Vec<WireHouse>, context: PacketContext<'_>, outlines: &mut Source<'_, '_>) -> Result<Vec<HouseShell>, Unread> {
    let mut floors = Steps::default();
    let mut brush = Brush::new(context.palettes);
    let mut volume = |row: WireVolume, style: u16, floor: i32| {
        let bottom = floor.wrapping_add(row.bottom);
        let [colour, trim, roof] = brush.paint(style, row.paint)?;
        let (shape, height, quarter, beyond) = row.roof;
        let footprint = outlines.polygon(FOOTPRINTS)?;
        let direction = Massing::quarter_deg(&footprint, quarter & 3).wrapping_add(beyond as u16);
        let mut next = 0_u16;
        let wall = |step: u16| {
            let wall = next.wrapping_add(step);
            next = wall.wrapping_add(1);
            wall
        };
        Ok(VolumeShell {
            footprint,
            bottom,
            eaves: bottom.wrapping_add(row.eaves),
            colour,
            trim,
            roof: PlanRoof { shape, height, direction, colour: roof },
            gable: row.gable,
            has_roof: row.has_roof,
            walls: row.walls.into_iter().map(wall).collect(),
            arcades: row.arcades,
        })
    };
    let house = |row: WireHouse| {
        let (style, floor) = (row.style, floors.by(row.floor));
        let volumes = row.volumes.into_iter().map(|row| volume(row, style, floor)).collect::<Result<_, Unread>>()?;
        Ok(HouseShell { style, floor, volumes, is_monument: row.is_monument })
    };
    rows.into_iter().map(house).collect()
}
