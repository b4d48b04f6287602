//! A small city made by hand: a street between two terraces, cut into cells, turned so that nothing lies along an axis.
#![allow(dead_code, reason = "each test uses its own part")]

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{
    Anchor, Cell, CellShell, Cells, CityPlan, FacadeObjectKind, FacadeSheet, Gable, GridPolygon, GridPos, GroundFloor, GroundPatch,
    House, HouseShell, Id, ObjectHead, ObjectKind, ObjectShell, Opening, PaintedFacade, PaintedObject, PaintedWall, PictureFile,
    Place, PlaceKind, PlanObject, PlanRoof, PlanStreet, Portal, PortalSide, Rgb, RoofShape, SmallTexture, Storey, SurfaceKind,
    Viewpoint, Volume, VolumeShell, Wall, WallKind,
};
use veduta_store::{
    BlobRef, CellParts, CityIndex, CityStats, CityWriter, DirReader, Region, RegionEntry, RegionKey, StoreError, encode_leaf,
    encode_region, read_index, write_city,
};

/// A city ready to be written.
pub struct City {
    pub plan: CityPlan,
    pub cells: Cells,
    pub shells: Vec<CellShell>,
    pub sheets: Vec<FacadeSheet>,
}

const M: i32 = 1024;

/// A position along and across the street (metres × 1024), turned by the angle of the triangle 7, 24, 25.
fn at(along: i32, across: i32) -> GridPos {
    GridPos((along * 24 - across * 7) / 25, (along * 7 + across * 24) / 25)
}

fn quad(a0: i32, a1: i32, c0: i32, c1: i32) -> GridPolygon {
    GridPolygon::simple(vec![at(a0, c0), at(a1, c0), at(a1, c1), at(a0, c1)])
}

fn colour(draw: Draw, question: &str) -> Rgb {
    *draw
        .pick(question, &[Rgb(0xD9, 0xB3, 0x6C), Rgb(0xC8, 0xA0, 0x70), Rgb(0xB0, 0x50, 0x40), Rgb(0xEE, 0xE0, 0xC8)])
        .expect("four")
}

/// The walls of a house: front, side, back, side.
fn walls(draw: Draw, storeys: usize, height: i32) -> Vec<Wall> {
    let stack = |windows: Opening| {
        (0..storeys)
            .map(|n| Storey {
                height: if n == 0 { height - (storeys as i32 - 1) * (height / storeys as i32) } else { height / storeys as i32 },
                opening: if n == 0 { Opening::Window } else { windows },
            })
            .collect::<Vec<_>>()
    };
    let windows = *draw.pick("windows", &[Opening::FramedWindow, Opening::CorniceWindow, Opening::ArchedWindow]).expect("three");
    let bays = 3 + draw.below("bays", 4) as u8;
    let door =
        GroundFloor { door_bay: Some(draw.below("door", bays.into()) as u8), door: Opening::Portal, shops: 0b101, blank: 0b10 };
    let party = || Wall { kind: WallKind::Party, bays: 0, storeys: stack(Opening::Blank), ..Wall::default() };
    vec![
        Wall { kind: WallKind::Street, bays, storeys: stack(windows), ground_floor: door, ornament: None },
        party(),
        Wall { kind: WallKind::Yard, bays, storeys: stack(Opening::Window), ..Wall::default() },
        party(),
    ]
}

fn house(draw: Draw, footprint: GridPolygon) -> House {
    let storeys = 3 + draw.below("storeys", 3);
    let eaves = draw.between("eaves", 9.0, 16.0);
    let height = GridPos::steps(eaves);
    House {
        id: Id::from_place("house", footprint.centroid()),
        name: String::new(),
        number: format!("{}", draw.below("number", 900)),
        style: 0,
        floor: 0,
        volumes: vec![Volume {
            walls: walls(draw, storeys, height),
            footprint,
            bottom: 0,
            eaves: height,
            colour: colour(draw, "wall"),
            trim: colour(draw, "trim"),
            roof: PlanRoof {
                shape: *draw.pick("roof", &[RoofShape::Gabled, RoofShape::Hipped, RoofShape::Mansard]).expect("three"),
                height: GridPos::steps(draw.between("ridge", 3.0, 7.0)),
                direction: 74,
                colour: colour(draw, "tiles"),
            },
            gable: Gable::Plain,
            arcades: Vec::new(),
        }],
        monument: None,
    }
}

fn shell_of(house: &House, origin: GridPos) -> HouseShell {
    let volumes = house.volumes.iter().map(|volume| {
        let walls = (0..volume.walls.len() as u16).collect();
        VolumeShell { footprint: moved(&volume.footprint, origin), ..VolumeShell::of(volume, walls, true) }
    });
    HouseShell { style: house.style, floor: house.floor, volumes: volumes.collect(), is_monument: false }
}

fn moved(polygon: &GridPolygon, origin: GridPos) -> GridPolygon {
    let ring = |ring: &Vec<GridPos>| ring.iter().map(|&p| p - origin).collect();
    GridPolygon { outer: ring(&polygon.outer), holes: polygon.holes.iter().map(ring).collect() }
}

/// A street of `count` cells with `each` houses on either side of each.
pub fn city(count: usize, each: usize) -> City {
    let mut plan = CityPlan {
        name: "Testov".to_owned(),
        anchor: Anchor { lat: 50.087, lon: 14.421 },
        attribution: "nobody".to_owned(),
        seed: 7,
        growth_version: 1,
        start: Viewpoint { pos: DVec2::new(5.0, 1.0), ..Viewpoint::default() },
        ..CityPlan::default()
    };
    let mut city = City { plan: CityPlan::default(), cells: Cells::default(), shells: Vec::new(), sheets: Vec::new() };
    let mut along = 0;
    for c in 0..count {
        along = add_cell(&mut plan, &mut city, c, count, each, along);
    }
    plan.extent = quad(-9 * M, along + 9 * M, -40 * M, 40 * M);
    plan.streets.push(PlanStreet {
        id: Id::from_source(2, 4_567_890),
        name: "Dlouhá".to_owned(),
        line: vec![at(0, 0), at(along, 0)],
        width: 10 * M,
        walkable: true,
        ..PlanStreet::default()
    });
    plan.places.push(Place {
        id: Id(12),
        name: "Kašna".to_owned(),
        kind: PlaceKind::Monument,
        pos: DVec2::new(3.0, 0.5),
        radius_m: 25.0,
        text: "A fountain.".to_owned(),
        view: Some(Viewpoint::default()),
    });
    city.plan = plan;
    city
}

fn add_cell(plan: &mut CityPlan, city: &mut City, c: usize, count: usize, each: usize, start: i32) -> i32 {
    let draw = Draw::new(plan.seed, Id(c as u64), "cell");
    let origin = at(start, 0);
    let mut cell =
        Cell { id: Id::from_place("cell", origin.to_metres()), name: "Dlouhá".to_owned(), floor: (0, 150), ..Cell::default() };
    let mut shell = CellShell { origin, ..CellShell::default() };
    let mut sheet = FacadeSheet::default();
    let mut front = start;
    for n in 0..each {
        let draw = draw.part(n as u64);
        let next = front + GridPos::steps(draw.between("frontage", 6.0, 14.0));
        for side in [1, -1] {
            let back = 5 * M + GridPos::steps(draw.part(side as u64 & 3).between("depth", 10.0, 15.0));
            let footprint = if side > 0 { quad(front, next, 5 * M, back) } else { quad(front, next, -back, -5 * M) };
            let house = house(draw.part(side as u64 & 3), footprint);
            let number = plan.houses.len() as u32;
            cell.houses.push(number);
            cell.walls.extend((0..4).map(|wall| (number, 0, wall)));
            shell.houses.push(shell_of(&house, origin));
            sheet.walls.extend(house.volumes.iter().flat_map(|volume| volume.walls.clone()));
            plan.houses.push(house);
        }
        front = next;
    }
    cell.outline = quad(start, front, -5 * M, 5 * M);
    for (surface, c0, c1, z) in [
        (SurfaceKind::Cobbles, -3 * M, 3 * M, 0),
        (SurfaceKind::Mosaic, 3 * M, 5 * M, 150),
        (SurfaceKind::Mosaic, -5 * M, -3 * M, 150),
    ] {
        plan.ground.push(GroundPatch { surface, outline: quad(start, front, c0, c1), z, course: None });
        shell.ground.push(GroundPatch { surface, outline: moved(&quad(start, front, c0, c1), origin), z, course: None });
    }
    let pos = at(start + M, 4 * M);
    let lamp = PlanObject {
        id: Id::from_place("lamp", pos.to_metres()),
        kind: ObjectKind::Lamp,
        pos,
        z: 150,
        heading: 90,
        height: 5 * M,
        monument: None,
    };
    cell.objects.push(plan.objects.len() as u32);
    shell.objects.push(ObjectShell { pos: pos - origin, ..ObjectShell::of(&lamp) });
    plan.objects.push(lamp);
    shell.outline = moved(&cell.outline, origin);
    add_portals(city, &mut cell, &mut shell, c, count, (start, front));
    city.cells.visible.push((c.saturating_sub(1)..(c + 2).min(count)).map(|n| n as u32).collect());
    city.cells.cells.push(cell);
    city.shells.push(shell);
    city.sheets.push(sheet);
    front
}

fn add_portals(city: &mut City, cell: &mut Cell, shell: &mut CellShell, c: usize, count: usize, (start, front): (i32, i32)) {
    let portals = &mut city.cells.portals;
    let mut blind = |portal: Portal| shell.blind.push((portal.ends.0 - shell.origin, portal.ends.1 - shell.origin));
    if c == 0 {
        portals.push(Portal { ends: (at(start, 5 * M), at(start, -5 * M)), cell: 0, beyond: PortalSide::Edge });
        blind(portals[0]);
    }
    let beyond = if c + 1 < count { PortalSide::Cell(c as u32 + 1) } else { PortalSide::Edge };
    cell.portals = vec![portals.len() as u32 - 1, portals.len() as u32];
    portals.push(Portal { ends: (at(front, -5 * M), at(front, 5 * M)), cell: c as u32, beyond });
    if c + 1 == count {
        blind(portals[portals.len() - 1]);
    }
}

impl City {
    pub fn parts(&self, cell: usize) -> CellParts<'_> {
        let (shell, sheet) = (Cow::Borrowed(&self.shells[cell]), Cow::Borrowed(&self.sheets[cell]));
        let picture = |n: usize| PictureFile((0..60).map(|byte| (n * 31 + byte * 7) as u8).collect());
        CellParts { shell, sheet, pictures: (0..self.sheets[cell].pictures()).map(picture).collect(), ground: None }
    }

    /// Writes the city with all that one may have: a painted front in each cell with its picture, and a file.
    pub fn write_whole(mut self, dir: &Path) -> Result<CityStats, StoreError> {
        for sheet in &mut self.sheets {
            sheet.painted.push(PaintedWall { wall: 0, painted: painted(6) });
        }
        let mut writer = CityWriter::new(dir, &self.plan)?;
        writer.cells(&self.plan, &self.cells, &|cell| self.parts(cell))?;
        writer.file("testov.guide.ron", "What is told of a fountain. ".repeat(9).as_bytes())?;
        writer.finish(self.cells)
    }

    pub fn write(&self, dir: &Path) -> Result<CityStats, StoreError> {
        write_city(dir, &self.plan, &self.cells, &self.shells, &self.sheets)
    }
}

/// The index of a city of 65 regions, and the leaf and the page of the last of them, which is empty.
pub fn large() -> (CityIndex, Vec<u8>, Vec<u8>) {
    let temp = TempDir::new("large");
    city(1, 1).write(&temp.0).expect("written");
    let mut index = read_index(&DirReader::new(&temp.0).expect("a city")).expect("an index");
    let region = |n: u32| RegionEntry {
        key: RegionKey::new(n, 8).expect("a square"),
        first: 1,
        cells: 0,
        blob: None,
        ..index.regions[0].clone()
    };
    let mut regions: Vec<RegionEntry> = (0..65).map(region).collect();
    (regions[0].first, regions[0].cells) = (0, 1);
    let page = encode_region(&Region::default(), 64, &regions);
    let leaf = encode_leaf(&[BlobRef::of(&page)]);
    (index.regions, index.leaves) = (regions.into(), vec![BlobRef { bytes: 9, ..BlobRef::default() }, BlobRef::of(&leaf)]);
    (index, leaf, page)
}

/// A wall that is painted after a photograph.
pub fn painted(colours: u8) -> PaintedFacade {
    let texture = SmallTexture {
        width: 12,
        palette: (0..colours).map(|c| Rgb(c * 9, 200 - c, 77)).collect(),
        texels: (0..12 * 20).map(|i| (i / 7 % usize::from(colours)) as u8).collect(),
    };
    let object = |kind, head| PaintedObject {
        kind,
        texture: 0,
        low: (1024, 2048),
        size: (1100, 2000),
        head,
        depth: 200,
        columns: 3,
        rows: 2,
        step: (2600, 3500),
    };
    use FacadeObjectKind::{Door, Painting, Shop, Window};
    let objects =
        [(Window, ObjectHead::Flat), (Door, ObjectHead::Round), (Shop, ObjectHead::Segment), (Painting, ObjectHead::Flat)];
    PaintedFacade {
        size: (14_000, 16_000),
        sections: 2,
        colour: Rgb(120, 99, 75),
        textures: vec![texture],
        objects: objects.map(|(kind, head)| object(kind, head)).to_vec(),
    }
}

/// A directory of its own that goes away with the value.
pub struct TempDir(pub PathBuf);

impl TempDir {
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let dir = std::env::temp_dir().join(format!("veduta-store-{name}-{}-{n}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        std::fs::create_dir_all(&dir).expect("a temporary directory");
        Self(dir)
    }

    pub fn join(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }
}

impl Drop for TempDir {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Every file below a directory with its bytes, by path.
pub fn files(dir: &Path) -> std::collections::BTreeMap<PathBuf, Vec<u8>> {
    let mut all = std::collections::BTreeMap::new();
    for entry in std::fs::read_dir(dir).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            all.insert(path.clone(), std::fs::read(&path).expect("a file"));
        }
    }
    all
}
