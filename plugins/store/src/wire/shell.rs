use serde::{Deserialize, Serialize};
use veduta_city::{
    CellShell, Course, Design, GRID_PER_METRE, GridPolygon, GridPos, GroundPatch, Marking, MarkingKind, ObjectKind, ObjectShell,
    PlacedMonument, PlanTerrain, SurfaceKind, WaySpan,
};

use super::{
    Steps,
    terrain::WireTerrain,
    volumes::{WireHouse, houses, pull_houses},
};
use crate::PacketContext;
use crate::code::{Handmade, Outlines, Source, Unread};

/// Sections of outlines, beside that of footprints.
const OUTLINE: u8 = 0;
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
        let houses = houses(shell, context, &mut outlines);
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
            houses,
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
        let terrain = PlanTerrain::try_from(self.terrain)?;
        let houses = pull_houses(self.houses, context, (origin, &terrain), outlines)?;
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
            terrain,
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
