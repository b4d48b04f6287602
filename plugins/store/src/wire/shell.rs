use serde::{Deserialize, Serialize};
use veduta_city::{
    Arcade, CellShell, Course, Design, Gable, GridPos, GroundPatch, HouseShell, Id, Marking, MarkingKind, ObjectKind,
    PlacedMonument, PlanObject, PlanRoof, PlanTerrain, Rgb, RoofShape, SurfaceKind, VolumeShell, WaySpan,
};

use super::{
    Malformed,
    columns::{Deltas, Ids, Lists, Pull, PullIds, PullLists, PullTable, Table, TableWriter},
    points::{PointWriter, Points, PullPoints},
    terrain::WireTerrain,
};

/// A [`CellShell`] in columns.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireShell {
    origin: GridPos,
    terrain: WireTerrain,
    points: Points,
    colours: Table<Rgb>,
    ground: WireGround,
    houses: WireHouses,
    volumes: WireVolumes,
    objects: WireObjects,
    /// How many blind portals there are.
    blind: u32,
    markings: WireMarkings,
    designs: Vec<Design>,
    monuments: Vec<PlacedMonument>,
    spans: Vec<WaySpan>,
    drawn_spans: u32,
}

#[derive(Serialize, Deserialize)]
struct WireGround {
    surfaces: Vec<SurfaceKind>,
    z: Deltas,
    /// 0: none; else one more than the course.
    courses: Vec<u32>,
    /// Where each course begins.
    from: Vec<i32>,
}

#[derive(Serialize, Deserialize)]
struct WireHouses {
    ids: Ids,
    styles: Vec<u16>,
    floors: Deltas,
    volumes: Vec<u32>,
    /// Which of them are monuments.
    monuments: Vec<u32>,
}

#[derive(Serialize, Deserialize)]
struct WireVolumes {
    bottoms: Deltas,
    /// Above the bottom.
    eaves: Vec<i32>,
    shapes: Vec<RoofShape>,
    roof_heights: Vec<i32>,
    directions: Vec<u16>,
    gables: Vec<Gable>,
    has_roof: Vec<bool>,
    walls: Lists,
    /// Each with the number of its volume; ascending.
    arcades: Vec<(u32, Arcade)>,
}

#[derive(Serialize, Deserialize)]
struct WireObjects {
    ids: Ids,
    kinds: Vec<ObjectKind>,
    z: Deltas,
    headings: Vec<u16>,
    heights: Vec<i32>,
    /// 0: as its kind looks; else one more than its design.
    designs: Vec<u32>,
}

#[derive(Serialize, Deserialize)]
struct WireMarkings {
    kinds: Vec<MarkingKind>,
    widths: Vec<i32>,
    z: Deltas,
}

impl From<&CellShell> for WireShell {
    fn from(shell: &CellShell) -> Self {
        let volumes = || shell.houses.iter().flat_map(|house| &house.volumes);
        let mut points = PointWriter::default();
        points.polygon(&shell.outline);
        // Houses first: the ground between them then walks along edges already told.
        volumes().for_each(|volume| points.polygon(&volume.footprint));
        shell.ground.iter().for_each(|patch| points.polygon(&patch.outline));
        shell.objects.iter().for_each(|object| points.point(object.pos));
        for &(from, to) in &shell.blind {
            points.point(from);
            points.point(to);
        }
        shell.markings.iter().for_each(|marking| points.line(&marking.line));
        shell.courses.iter().for_each(|course| points.line(&course.line));
        let mut colours = TableWriter::default();
        for volume in volumes() {
            [volume.colour, volume.trim, volume.roof.colour].iter().for_each(|colour| colours.push(colour));
        }
        Self {
            origin: shell.origin,
            terrain: WireTerrain::from(&shell.terrain),
            points: points.finish(),
            colours: colours.finish(),
            ground: WireGround {
                surfaces: shell.ground.iter().map(|patch| patch.surface).collect(),
                z: Deltas::of(shell.ground.iter().map(|patch| patch.z)),
                courses: shell.ground.iter().map(|patch| patch.course.map_or(0, |course| course.saturating_add(1))).collect(),
                from: shell.courses.iter().map(|course| course.from).collect(),
            },
            houses: WireHouses {
                ids: ids(shell.houses.iter().map(|house| house.id)),
                styles: shell.houses.iter().map(|house| house.style).collect(),
                floors: Deltas::of(shell.houses.iter().map(|house| house.floor)),
                volumes: shell.houses.iter().map(|house| house.volumes.len() as u32).collect(),
                monuments: (0..).zip(&shell.houses).filter(|(_, house)| house.is_monument).map(|(i, _)| i).collect(),
            },
            volumes: WireVolumes::of(volumes()),
            objects: WireObjects::of(&shell.objects),
            blind: shell.blind.len() as u32,
            markings: WireMarkings {
                kinds: shell.markings.iter().map(|marking| marking.kind).collect(),
                widths: shell.markings.iter().map(|marking| marking.width).collect(),
                z: Deltas::of(shell.markings.iter().map(|marking| marking.z)),
            },
            designs: shell.designs.clone(),
            monuments: shell.monuments.clone(),
            spans: shell.spans.clone(),
            drawn_spans: shell.drawn_spans,
        }
    }
}

fn ids(all: impl Iterator<Item = Id>) -> Ids {
    let mut ids = Ids::default();
    all.for_each(|id| ids.push(id));
    ids
}

impl WireVolumes {
    fn of<'a>(volumes: impl Iterator<Item = &'a VolumeShell> + Clone) -> Self {
        let mut walls = Lists::default();
        volumes.clone().for_each(|volume| walls.push(volume.walls.iter().map(|&wall| u32::from(wall))));
        Self {
            bottoms: Deltas::of(volumes.clone().map(|volume| volume.bottom)),
            eaves: volumes.clone().map(|volume| volume.eaves.wrapping_sub(volume.bottom)).collect(),
            shapes: volumes.clone().map(|volume| volume.roof.shape).collect(),
            roof_heights: volumes.clone().map(|volume| volume.roof.height).collect(),
            directions: volumes.clone().map(|volume| volume.roof.direction).collect(),
            gables: volumes.clone().map(|volume| volume.gable).collect(),
            has_roof: volumes.clone().map(|volume| volume.has_roof).collect(),
            walls,
            arcades: (0..).zip(volumes).flat_map(|(v, volume)| volume.arcades.iter().map(move |&arcade| (v, arcade))).collect(),
        }
    }
}

impl WireObjects {
    fn of(objects: &[PlanObject]) -> Self {
        Self {
            ids: ids(objects.iter().map(|object| object.id)),
            kinds: objects.iter().map(|object| object.kind).collect(),
            z: Deltas::of(objects.iter().map(|object| object.z)),
            headings: objects.iter().map(|object| object.heading).collect(),
            heights: objects.iter().map(|object| object.height).collect(),
            designs: objects.iter().map(|object| object.monument.map_or(0, |design| u32::from(design) + 1)).collect(),
        }
    }
}

impl TryFrom<WireShell> for CellShell {
    type Error = Malformed;

    fn try_from(mut wire: WireShell) -> Result<Self, Malformed> {
        let mut points = wire.points.pull();
        let mut colours = wire.colours.pull();
        let outline = points.polygon()?;
        let houses = wire.houses.pull(&mut wire.volumes.pull(), &mut points, &mut colours)?;
        let starts = core::mem::take(&mut wire.ground.from);
        let ground = wire.ground.pull(&mut points)?;
        let objects = wire.objects.pull(&mut points)?;
        let blind = (0..wire.blind).map(|_| Ok((points.point()?, points.point()?))).collect::<Result<_, _>>()?;
        let markings = wire.markings.pull(&mut points)?;
        let course = |from| Ok(Course { line: points.line()?, from });
        let courses = starts.into_iter().map(course).collect::<Result<_, _>>()?;
        points.finish()?;
        colours.finish()?;
        let WireShell { origin, designs, monuments, spans, drawn_spans, .. } = wire;
        let terrain = PlanTerrain::try_from(wire.terrain)?;
        Ok(Self {
            origin,
            outline,
            terrain,
            ground,
            courses,
            houses,
            objects,
            blind,
            markings,
            spans,
            drawn_spans,
            designs,
            monuments,
        })
    }
}

impl WireGround {
    fn pull(self, points: &mut PullPoints) -> Result<Vec<GroundPatch>, Malformed> {
        let mut z = Pull::new("heights of ground", self.z.numbers());
        let mut courses = Pull::new("courses of ground", self.courses);
        let ground = self
            .surfaces
            .into_iter()
            .map(|surface| {
                let (outline, z) = (points.polygon()?, z.take()?);
                Ok(GroundPatch { surface, outline, z, course: courses.take()?.checked_sub(1) })
            })
            .collect::<Result<_, _>>()?;
        z.finish()?;
        courses.finish()?;
        Ok(ground)
    }
}

impl WireHouses {
    fn pull(
        self,
        volumes: &mut PullVolumes,
        points: &mut PullPoints,
        colours: &mut PullTable<Rgb>,
    ) -> Result<Vec<HouseShell>, Malformed> {
        let mut ids = self.ids.pull();
        let mut counts = Pull::new("volumes of houses", self.volumes);
        let mut floors = Pull::new("floors of houses", self.floors.numbers());
        let mut houses = Vec::with_capacity(self.styles.len());
        for style in self.styles {
            let count = counts.take()? as usize;
            if count > volumes.bottoms.left() {
                return Err(Malformed::Reason("a house has more volumes than are left"));
            }
            let id = ids.take()?;
            let volumes = (0..count).map(|_| volumes.take(points, colours)).collect::<Result<_, _>>()?;
            houses.push(HouseShell { id, style, floor: floors.take()?, volumes, is_monument: false });
        }
        for i in self.monuments {
            let house = houses.get_mut(i as usize).ok_or(Malformed::Reason("a monument stands for a house that is not there"))?;
            house.is_monument = true;
        }
        ids.finish()?;
        counts.finish()?;
        floors.finish()?;
        volumes.finish()?;
        Ok(houses)
    }
}

struct PullVolumes {
    bottoms: Pull<i32>,
    eaves: Pull<i32>,
    shapes: Pull<RoofShape>,
    roof_heights: Pull<i32>,
    directions: Pull<u16>,
    gables: Pull<Gable>,
    has_roof: Pull<bool>,
    walls: PullLists,
    arcades: std::iter::Peekable<std::vec::IntoIter<(u32, Arcade)>>,
    taken: u32,
}

impl WireVolumes {
    fn pull(self) -> PullVolumes {
        PullVolumes {
            bottoms: Pull::new("feet of volumes", self.bottoms.numbers()),
            eaves: Pull::new("eaves of volumes", self.eaves),
            shapes: Pull::new("roofs", self.shapes),
            roof_heights: Pull::new("heights of roofs", self.roof_heights),
            directions: Pull::new("directions of roofs", self.directions),
            gables: Pull::new("gables", self.gables),
            has_roof: Pull::new("marks of roofs", self.has_roof),
            walls: self.walls.pull(),
            arcades: self.arcades.into_iter().peekable(),
            taken: 0,
        }
    }
}

impl PullVolumes {
    fn take(&mut self, points: &mut PullPoints, colours: &mut PullTable<Rgb>) -> Result<VolumeShell, Malformed> {
        let bottom = self.bottoms.take()?;
        let walls = self.walls.take()?.into_iter().map(u16::try_from).collect::<Result<_, _>>();
        let number = self.taken;
        self.taken += 1;
        let arcades = core::iter::from_fn(|| self.arcades.next_if(|arcade| arcade.0 == number)).map(|arcade| arcade.1);
        let arcades = arcades.collect();
        Ok(VolumeShell {
            footprint: points.polygon()?,
            bottom,
            eaves: bottom.wrapping_add(self.eaves.take()?),
            colour: colours.take()?,
            trim: colours.take()?,
            roof: PlanRoof {
                shape: self.shapes.take()?,
                height: self.roof_heights.take()?,
                direction: self.directions.take()?,
                colour: colours.take()?,
            },
            gable: self.gables.take()?,
            has_roof: self.has_roof.take()?,
            walls: walls.map_err(|_| Malformed::Reason("a wall's index is too large"))?,
            arcades,
        })
    }

    fn finish(&self) -> Result<(), Malformed> {
        self.bottoms.finish()?;
        self.eaves.finish()?;
        self.shapes.finish()?;
        self.roof_heights.finish()?;
        self.directions.finish()?;
        self.gables.finish()?;
        self.has_roof.finish()?;
        self.walls.finish()?;
        match self.arcades.len() {
            0 => Ok(()),
            _ => Err(Malformed::Reason("an arcade belongs to no volume")),
        }
    }
}

impl WireObjects {
    fn pull(self, points: &mut PullPoints) -> Result<Vec<PlanObject>, Malformed> {
        let mut ids: PullIds = self.ids.pull();
        let mut z = Pull::new("feet of objects", self.z.numbers());
        let mut headings = Pull::new("headings of objects", self.headings);
        let mut heights = Pull::new("heights of objects", self.heights);
        let mut designs = Pull::new("designs of objects", self.designs);
        let mut objects = Vec::with_capacity(self.kinds.len());
        for kind in self.kinds {
            objects.push(PlanObject {
                id: ids.take()?,
                kind,
                pos: points.point()?,
                z: z.take()?,
                heading: headings.take()?,
                height: heights.take()?,
                monument: match designs.take()?.checked_sub(1).map(u16::try_from) {
                    None => None,
                    Some(Ok(design)) => Some(design),
                    Some(Err(_)) => return Err(Malformed::Reason("an object's design is too large a number")),
                },
            });
        }
        ids.finish()?;
        z.finish()?;
        headings.finish()?;
        heights.finish()?;
        designs.finish()?;
        Ok(objects)
    }
}

impl WireMarkings {
    fn pull(self, points: &mut PullPoints) -> Result<Vec<Marking>, Malformed> {
        let mut widths = Pull::new("widths of markings", self.widths);
        let mut z = Pull::new("heights of markings", self.z.numbers());
        let marking = |kind| Ok(Marking { kind, line: points.line()?, width: widths.take()?, z: z.take()? });
        let markings = self.kinds.into_iter().map(marking).collect::<Result<_, _>>()?;
        widths.finish()?;
        z.finish()?;
        Ok(markings)
    }
}
