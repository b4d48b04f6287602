use veduta_city::{CellShell, FacadeSheet, GridPolygon, Level, Palette, PictureFile, Styles};

use crate::blob::{BlobKind, open, pack, pack_with, unpack, unpack_with};
use crate::wire::{WireSheet, WireShell};
use crate::{BlobRef, RegionHouses, StoreError, valid};

/// What is transferred for one cell at one level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Packet {
    /// Level 1: all that stands and lies in the cell.
    Shell(Box<CellShell>),
    /// Level 2: openings of its walls.
    Facades(FacadeSheet),
    /// Level 3: pictures of its painted walls. They are not looked into: whoever decodes one has to mind what it claims.
    Pictures(Vec<PictureFile>),
}

impl Packet {
    /// The level it belongs to.
    #[must_use]
    pub const fn level(&self) -> Level {
        match self {
            Self::Shell(_) => Level::One,
            Self::Facades(_) => Level::Two,
            Self::Pictures(_) => Level::Three,
        }
    }
}

/// What a packet need not tell, because the index and the houses of its region do. A packet is read with what it was written with; with
/// anything else it is refused, or another cell comes of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PacketContext<'a> {
    /// The cell's outline: [`CellEntry::outline`](crate::CellEntry::outline).
    pub outline: Option<&'a GridPolygon>,
    /// Colours of houses by their styles: [`CityIndex::palettes`](crate::CityIndex::palettes).
    pub palettes: &'a [Palette],
    /// Houses of the cell's region.
    pub houses: Option<&'a RegionHouses>,
    /// Place of the cell in its region.
    pub place: usize,
}

/// Stored form of a packet. The same packet gives the same bytes on every platform.
#[must_use]
pub fn encode_packet(packet: &Packet, context: PacketContext<'_>) -> Vec<u8> {
    match packet {
        Packet::Shell(shell) => encode_shell(shell, context),
        Packet::Facades(sheet) => encode_sheet(sheet),
        Packet::Pictures(pictures) => encode_pictures(pictures),
    }
}

pub(crate) fn encode_shell(shell: &CellShell, context: PacketContext<'_>) -> Vec<u8> {
    pack_with(BlobKind::Shell, &WireShell::of(shell, context))
}

pub(crate) fn encode_sheet(sheet: &FacadeSheet) -> Vec<u8> {
    pack(BlobKind::Facades, &WireSheet::from(sheet))
}

/// Pictures are as small as they get: their number and lengths, then all of them.
pub(crate) fn encode_pictures(pictures: &[PictureFile]) -> Vec<u8> {
    let mut stored = vec![BlobKind::Pictures as u8];
    for number in core::iter::once(pictures.len()).chain(pictures.iter().map(|picture| picture.0.len())) {
        stored.extend(u32::try_from(number).unwrap_or(u32::MAX).to_le_bytes());
    }
    pictures.iter().for_each(|picture| stored.extend(&picture.0));
    stored
}

fn decode_pictures(stored: &[u8], blob: &BlobRef) -> Result<Vec<PictureFile>, StoreError> {
    let what = BlobKind::Pictures.words();
    let bytes = open(BlobKind::Pictures, stored, blob)?;
    let short = || StoreError::Invalid { what, reason: "its pictures are cut off".to_owned() };
    let (count, rest) = bytes.split_first_chunk::<4>().ok_or_else(short)?;
    let count = u32::from_le_bytes(*count) as usize;
    if count > 2 * FacadeSheet::MOST_SECTIONS {
        return Err(StoreError::Invalid { what, reason: format!("it has {count} pictures") });
    }
    let (lengths, mut rest) = rest.split_at_checked(4 * count).ok_or_else(short)?;
    let mut pictures = Vec::with_capacity(count);
    for length in lengths.as_chunks::<4>().0 {
        let (picture, behind) = rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(short)?;
        pictures.push(PictureFile(picture.to_vec()));
        rest = behind;
    }
    if rest.is_empty() {
        Ok(pictures)
    } else {
        Err(StoreError::Invalid { what, reason: "something follows its pictures".to_owned() })
    }
}

/// The packet of stored bytes that the reference stands for. Any bytes are safe: length and checksum are looked at first,
/// then they are decoded within a cap, and checked. A shell's rings have at least three vertices, its walls are
/// edges of their footprints, and its positions may be added and subtracted without overflow.
///
/// # Errors
/// What is wrong with the bytes; see [`StoreError::is_permanent`] for whether reading them anew may help.
pub fn decode_packet(stored: &[u8], blob: &BlobRef, level: Level, context: PacketContext<'_>) -> Result<Packet, StoreError> {
    match level {
        Level::One => {
            let what = BlobKind::Shell.words();
            let shell = unpack_with(BlobKind::Shell, stored, blob, |wire: WireShell, outlines| wire.pull(context, outlines))?;
            valid::check_shell(&shell).map_err(|reason| StoreError::Invalid { what, reason })?;
            Ok(Packet::Shell(Box::new(shell)))
        }
        Level::Two => {
            let what = BlobKind::Facades.words();
            let wire: WireSheet = unpack(BlobKind::Facades, stored, blob)?;
            let sheet = FacadeSheet::try_from(wire).map_err(|malformed| malformed.of(what))?;
            valid::check_painted(&sheet).map_err(|reason| StoreError::Invalid { what, reason })?;
            Ok(Packet::Facades(sheet))
        }
        Level::Three => Ok(Packet::Pictures(decode_pictures(stored, blob)?)),
        Level::Four => Err(StoreError::NoSuchLevel(level)),
    }
}

/// Number of walls that a shell draws.
#[must_use]
pub fn wall_count(shell: &CellShell) -> usize {
    shell.houses.iter().flat_map(|house| &house.volumes).map(|volume| volume.walls.len()).sum()
}

/// Whether a sheet has one wall for each of the shell's.
#[must_use]
pub fn sheet_fits(shell: &CellShell, sheet: &FacadeSheet) -> bool {
    wall_count(shell) == sheet.walls.len()
}

pub(crate) fn encode_styles(styles: &Styles) -> Vec<u8> {
    pack(BlobKind::Styles, styles)
}

/// The styles of stored bytes that the reference stands for ([`crate::CityIndex::styles`]).
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or are no styles to draw from.
pub fn decode_styles(stored: &[u8], blob: &BlobRef) -> Result<Styles, StoreError> {
    let what = BlobKind::Styles.words();
    let styles: Styles = unpack(BlobKind::Styles, stored, blob)?;
    match styles.validate().first() {
        None => Ok(styles),
        Some(error) => Err(StoreError::Invalid { what, reason: error.to_string() }),
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;
    use veduta_city::monument::{
        Axis, Content, Head, Hole, HoleShape, Material, Model, ModelVertex, PathPoint, Piece, Repeat, Shape,
    };
    use veduta_city::{
        Arcade, Articulation, Balconies, BoreEnd, Course, Design, Gable, GridPolygon, GridPos, GroundFloor, GroundPatch,
        HouseShell, Id, Marking, MarkingKind, Massing, Niche, ObjectKind, ObjectShell, Opening, Oriel, Ornament, Parapet,
        PlacedMonument, PlanRoof, PlanTerrain, Rgb, RoofShape, SpanForm, SpanMarking, SpanStation, Storey, SurfaceKind, Tile,
        VolumeShell, Wall, WallKind, WaySpan,
    };

    use super::*;
    use crate::HousePart;

    const NEAR: i32 = 1 << 27;

    fn any_pos() -> impl Strategy<Value = GridPos> {
        let near = (-9..9_i32, -9..9_i32);
        prop_oneof![near, (-NEAR..=NEAR, -NEAR..=NEAR)].prop_map(|(x, y)| GridPos(x, y))
    }

    fn any_polygon() -> impl Strategy<Value = GridPolygon> {
        (vec(any_pos(), 3..7), vec(vec(any_pos(), 3..5), 0..2)).prop_map(|(outer, holes)| GridPolygon { outer, holes })
    }

    fn any_colour() -> impl Strategy<Value = Rgb> {
        (0..3_u8, any::<u8>(), 0..2_u8).prop_map(|(r, g, b)| Rgb(r, g, b))
    }

    fn any_volume() -> impl Strategy<Value = VolumeShell> {
        let roof = (prop::sample::select(&[RoofShape::Flat, RoofShape::SawTooth][..]), 0..NEAR, 0..360_u16, any_colour());
        let roof = roof.prop_map(|(shape, height, direction, colour)| PlanRoof { shape, height, direction, colour });
        let walls = prop::sample::subsequence(vec![0_u16, 1, 2], 0..=3);
        (any_polygon(), -NEAR..NEAR, -NEAR..NEAR, any_colour(), any_colour(), roof, any::<bool>(), walls).prop_map(
            |(footprint, bottom, eaves, colour, trim, roof, has_roof, walls)| VolumeShell {
                footprint,
                bottom,
                eaves,
                colour,
                trim,
                roof,
                gable: if has_roof { Gable::Volute } else { Gable::Plain },
                has_roof,
                arcades: walls.iter().map(|&wall| arcade(wall)).collect(),
                walls,
            },
        )
    }

    const fn arcade(wall: u16) -> Arcade {
        Arcade { wall, span: (0, 9_000), arches: 3, floor: 150, depth: 3_700 }
    }

    /// A design with every kind of shape, hole and repetition.
    fn design() -> Design {
        let point = |x: i32, bulge: Option<i32>| PathPoint { pos: [x, 2 * x], bulge };
        let line = || vec![point(1, None), point(2, Some(3)), point(-4, None)];
        let shapes = [
            HoleShape::Rect(1, 2),
            HoleShape::Arch(3, 4, Head::Segmental),
            HoleShape::Circle(5),
            HoleShape::Foil(6, 7),
            HoleShape::Outline(line()),
        ];
        let hole = |shape| Hole { at: [8, 9], shape, row: Some((2, [3, 4])), around: Some((5, 6)) };
        let holes: Vec<Hole<i32>> = shapes.into_iter().map(hole).collect();
        let shapes = [
            Shape::Box { size: [1, 2, 3] },
            Shape::Cylinder { radius: 4, height: 5, top: Some(6), sides: None },
            Shape::Cone { radius: 7, height: 8, sides: Some(9) },
            Shape::Sphere { radius: 10 },
            Shape::Lathe { profile: line(), sides: None },
            Shape::Extrusion { outline: line(), holes: holes.clone(), height: 11 },
            Shape::Panel { outline: line(), holes, depth: 12, reveal: Some(13) },
            Shape::Sweep { section: line(), along: line(), closed: true },
            Shape::Tube { path: vec![[14, 15, 16, 17]], sides: Some(18) },
            Shape::Vault { size: [19, 20], rise: 21, head: Head::Pointed, cross: true },
            Shape::Roof { outline: line(), shape: RoofShape::Hipped, height: 22, direction_deg: Some(23) },
        ];
        let piece = |content| Piece {
            at: [1, -2, 3],
            turn: [4, -5, 6],
            scale: [1024, 512, 2048],
            mirror: Some(Axis::Y),
            repeat: Some(Repeat::Around { count: 2, arc_deg: Some(9_000), rise: None }),
            paint: 1,
            infill: Some(0),
            content,
        };
        let row = Repeat::Row { count: 3, step: [7, 8, 9], centred: true };
        let group = Piece { mirror: None, repeat: Some(row), ..piece(Content::Group(shapes.len() as u32)) };
        let vertex = |x: i32| ModelVertex { at: [x, -x, 3], normal: [0, -127, 5], uv: [x, 900] };
        let model = Model { vertices: (0..3).map(vertex).collect(), triangles: vec![[0, 1, 2]] };
        let (model, again) = (piece(Content::Model(model)), piece(Content::Again(1)));
        let pieces = core::iter::once(group)
            .chain(shapes.into_iter().map(|shape| piece(Content::Shape(shape))))
            .chain([model, again])
            .collect();
        let materials = [Tile::Stone, Tile::Bay(Opening::Clock)].map(|tile| Material { colour: Rgb(1, 2, 3), tile });
        Design { name: "everything".to_owned(), materials: materials.to_vec(), pieces }
    }

    fn span(z: i32) -> WaySpan {
        let station = |x: i32| SpanStation { left: GridPos(x, 3000), right: GridPos(x, -3000), z };
        WaySpan {
            id: Id(5),
            form: SpanForm::Girder,
            surface: SurfaceKind::Asphalt,
            pavements: (900, 0),
            parapets: (true, false),
            stations: vec![station(-9000), station(0), station(9000)],
            springing: -40,
            piers: (None, Some(-5000)),
            markings: vec![SpanMarking { kind: MarkingKind::Rails, left: (-4, 9), width: 1469 }],
        }
    }

    #[test]
    fn a_packet_with_a_bridge_that_leads_nowhere_is_refused() {
        let (mut shell, _) = full();
        shell.spans[0].stations.truncate(1);
        assert!(refused(shell).contains("span 0: it has no stations"));
        let (mut shell, _) = full();
        shell.drawn_spans = 3;
        assert!(refused(shell).contains("it draws 3 of 2 spans"));
        let (mut shell, _) = full();
        shell.spans = vec![span(7); 6_000];
        assert!(refused(shell).contains("its 6000 spans are 105469 m long"));
    }

    fn write(packet: &Packet) -> Vec<u8> {
        encode_packet(packet, PacketContext::default())
    }

    fn read(stored: &[u8], level: Level) -> Result<Packet, StoreError> {
        decode_packet(stored, &BlobRef::of(stored), level, PacketContext::default())
    }

    fn refused(shell: CellShell) -> String {
        let stored = write(&Packet::Shell(Box::new(shell)));
        read(&stored, Level::One).map_or_else(|e| e.to_string(), |_| String::new())
    }

    #[test]
    fn a_packet_with_a_design_that_cannot_be_drawn_is_refused() {
        let (mut shell, _) = full();
        shell.designs[0].pieces[0].content = Content::Group(99);
        assert!(refused(shell).contains("design 0: piece 0 is no group"));
        let (mut shell, _) = full();
        shell.monuments[0].design = 1;
        assert!(refused(shell).contains("monument 0 has design 1 of 1"));
    }

    fn any_shell() -> impl Strategy<Value = CellShell> {
        let surface = prop::sample::select(&[SurfaceKind::Asphalt, SurfaceKind::Ballast][..]);
        let patch = (surface, any_polygon(), -NEAR..NEAR).prop_map(|(surface, outline, z)| GroundPatch {
            surface,
            outline,
            z,
            course: None,
        });
        let house = (0..4_u16, -NEAR..NEAR, vec(any_volume(), 0..3), any::<bool>());
        let house = house.prop_map(|(style, floor, volumes, is_monument)| HouseShell { style, floor, volumes, is_monument });
        let object = (any_pos(), -NEAR..NEAR, any::<u16>(), 1..NEAR);
        let object = object.prop_map(|(pos, z, heading, height)| ObjectShell {
            kind: ObjectKind::Bin,
            pos,
            z,
            heading,
            height,
            monument: (height % 2 == 0).then_some(0),
        });
        let blind = (any_pos(), any_pos());
        (any_pos(), any_polygon(), vec(patch, 0..3), vec(house, 0..4), vec(object, 0..3), vec(blind, 0..3)).prop_map(
            |(origin, outline, ground, houses, objects, blind)| {
                let placed = |&pos: &GridPos| PlacedMonument { design: 0, pos, z: 5, heading: 35_999 };
                let monuments = ground.first().map(|patch| patch.outline.outer.iter().map(placed).collect()).unwrap_or_default();
                let line = outline.outer.clone();
                let marking = Marking { kind: MarkingKind::Dashes, line, width: 128, z: -3 };
                let heights = vec![origin.0 % 999, 5, outline.outer[0].1 % 999, -7, 0, 8];
                CellShell {
                    origin,
                    outline,
                    terrain: PlanTerrain { origin: GridPos(-7, 8), step: 2048, columns: 3, heights },
                    ground,
                    courses: Vec::new(),
                    houses,
                    objects,
                    blind,
                    markings: vec![marking],
                    spans: vec![span(origin.1 % 99); 2],
                    drawn_spans: 1,
                    designs: vec![design()],
                    monuments,
                }
            },
        )
    }

    /// One with all that there is, or with parts of it.
    fn ornament(n: u8) -> Box<Ornament> {
        Box::new(Ornament {
            articulation: [Articulation::Plain, Articulation::Quoins, Articulation::Pilasters][usize::from(n % 3)],
            oriel: n.is_multiple_of(2).then_some(Oriel { bay: n, storeys: (1, n) }),
            balconies: (n % 5 != 1).then_some(Balconies {
                bays: u32::from(n) << 9,
                storeys: (n, 2),
                parapet: [Parapet::Balusters, Parapet::Iron, Parapet::Panels][usize::from(n % 3)],
            }),
            niche: (n % 7 < 3).then_some(Niche { bay: n, storey: 4 }),
        })
    }

    fn any_wall() -> impl Strategy<Value = Wall> {
        let storey = (any::<i32>(), prop::sample::select(&[Opening::Blank, Opening::Window, Opening::Belfry][..]));
        let storeys = vec(storey.prop_map(|(height, opening)| Storey { height, opening }), 0..3);
        let kind = prop::sample::select(&[WallKind::Street, WallKind::Party][..]);
        let ground_floor = (any::<Option<u8>>(), any::<u32>());
        (kind, 0..3_u8, storeys, ground_floor).prop_map(|(kind, bays, storeys, (door_bay, shops))| Wall {
            kind,
            bays,
            storeys,
            ground_floor: GroundFloor { door_bay, door: Opening::Gate, shops, blank: shops / 3 },
            ornament: (shops % 2 == 1).then(|| ornament(shops as u8)),
        })
    }

    /// Houses of a region that tell of some volumes of a shell: of its own cell, the second of three, or of the first.
    fn houses_of(shell: &CellShell, picks: &[(prop::sample::Index, bool)]) -> RegionHouses {
        let volumes: Vec<(u16, &VolumeShell)> =
            shell.houses.iter().flat_map(|house| house.volumes.iter().map(|volume| (house.style, volume))).collect();
        let picked = picks.iter().filter(|_| !volumes.is_empty()).map(|(pick, is_own)| (pick.get(&volumes), *is_own));
        let part = |&(style, volume): &(u16, &VolumeShell)| {
            let ground = shell.terrain.height(volume.footprint.outer[0]);
            let height = volume.eaves.saturating_add(volume.roof.height.max(0)).wrapping_sub(ground);
            let outline = volume.footprint.map(|pos| pos.wrapping_add(shell.origin));
            HousePart { style, massing: Massing { outline, height, roof: volume.roof, colour: volume.colour } }
        };
        let of = |own: bool| picked.clone().filter(move |(_, is_own)| *is_own == own).map(move |(volume, _)| part(volume));
        let mut houses = RegionHouses::default();
        houses.push(of(false));
        houses.push(of(true));
        houses.push([]);
        houses
    }

    fn any_picks() -> impl Strategy<Value = Vec<(prop::sample::Index, bool)>> {
        vec((any::<prop::sample::Index>(), any::<bool>()), 0..9)
    }

    proptest! {
        #[test]
        fn shells_survive(
            shell in any_shell(),
            outline in any_polygon(),
            walls in vec(any_colour(), 0..4),
            picks in any_picks(),
        ) {
            let palettes = [Palette { roofs: walls.clone(), walls, trim: 1.2 }];
            let houses = houses_of(&shell, &picks);
            let packet = Packet::Shell(Box::new(shell));
            let context = PacketContext { outline: Some(&outline), palettes: &palettes, houses: Some(&houses), place: 1 };
            let stored = encode_packet(&packet, context);
            prop_assert_eq!(decode_packet(&stored, &BlobRef::of(&stored), Level::One, context), Ok(packet));
        }

        #[test]
        fn sheets_survive(different in vec(any_wall(), 0..5), uses in vec(any::<prop::sample::Index>(), 0..20)) {
            let walls = uses.iter().filter(|_| !different.is_empty()).map(|n| n.get(&different).clone()).collect();
            let packet = Packet::Facades(FacadeSheet::of(walls));
            prop_assert_eq!(read(&write(&packet), Level::Two), Ok(packet));
        }

        /// Someone who can compute checksums makes packets that no encoder would.
        #[test]
        fn forged_packets_do_no_harm(
            shell in any_shell(),
            walls in vec(any_wall(), 0..4),
            edits in vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
            cut in any::<prop::sample::Index>(),
            picks in any_picks(),
        ) {
            let houses = houses_of(&shell, &picks);
            let context = PacketContext { houses: Some(&houses), place: 1, ..PacketContext::default() };
            let forge = |packet: &Packet| {
                let mut stored = encode_packet(packet, context);
                for (at, byte) in &edits {
                    // Behind the kind.
                    let at = 1 + at.index(stored.len() - 1);
                    stored[at] = *byte;
                }
                let keep = if cut.index(3) == 0 { cut.index(stored.len()) } else { stored.len() };
                stored.truncate(keep);
                stored
            };
            let stored = forge(&Packet::Shell(Box::new(shell)));
            if let Ok(Packet::Shell(shell)) = decode_packet(&stored, &BlobRef::of(&stored), Level::One, context) {
                prop_assert_eq!(valid::check_shell(&shell), Ok(()));
                // Decoded positions may be added without overflow.
                let _sum = shell.outline.outer.iter().map(|&p| p + shell.origin).max();
            }
            let _either = read(&forge(&Packet::Facades(FacadeSheet::of(walls))), Level::Two);
        }
    }

    /// A shell and a sheet with every kind of thing, so that a change of order in the model is noticed.
    fn full() -> (CellShell, FacadeSheet) {
        use Opening as O;
        use RoofShape as R;
        let shapes = [
            R::Flat,
            R::Gabled,
            R::Hipped,
            R::HalfHipped,
            R::Pyramidal,
            R::Skillion,
            R::Mansard,
            R::Gambrel,
            R::Dome,
            R::Onion,
            R::Cone,
            R::Round,
            R::SawTooth,
        ];
        use SurfaceKind as S;
        let surfaces = [S::Asphalt, S::Cobbles, S::Mosaic, S::Flagstones, S::Gravel, S::Grass, S::Yard, S::Water, S::Ballast];
        use ObjectKind as K;
        let kinds = [
            K::Lamp,
            K::Tree,
            K::Conifer,
            K::Bench,
            K::Fountain,
            K::Statue,
            K::TramStop,
            K::Bollard,
            K::Kiosk,
            K::Well,
            K::Column,
            K::Bin,
            K::Signals,
            K::Sign,
            K::Hedge,
            K::Planter,
            K::Shrub,
            K::Poplar,
            K::Birch,
            K::Willow,
            K::FruitTree,
            K::Palm,
            K::Parasol,
        ];
        let openings = [
            O::Blank,
            O::Window,
            O::FramedWindow,
            O::CorniceWindow,
            O::PedimentWindow,
            O::ArchedWindow,
            O::LancetWindow,
            O::AtticWindow,
            O::WideWindow,
            O::Slit,
            O::Portal,
            O::Door,
            O::Shop,
            O::Arcade,
            O::Gate,
            O::Clock,
            O::Belfry,
        ];
        let outline = |x| GridPolygon::simple(vec![GridPos(x, 0), GridPos(x + 5, 0), GridPos(x, 5)]);
        let volume = |(n, &shape): (usize, &RoofShape)| VolumeShell {
            footprint: outline(n as i32),
            bottom: 1,
            eaves: 9000,
            colour: Rgb(1, 2, 3),
            trim: Rgb(4, 5, 6),
            roof: PlanRoof { shape, height: 77, direction: 300, colour: Rgb(7, 8, 9) },
            gable: [Gable::Plain, Gable::Stepped, Gable::Volute, Gable::Pediment][n % 4],
            has_roof: n % 2 == 0,
            walls: vec![0, 2],
            arcades: vec![arcade(2)],
        };
        let object = |&kind| ObjectShell { kind, pos: GridPos(-3, 4), z: 5, heading: 6, height: 7, monument: Some(0) };
        let wall = |kind| Wall {
            kind,
            bays: 3,
            storeys: openings.iter().map(|&opening| Storey { height: 3000, opening }).collect(),
            ground_floor: GroundFloor { door_bay: Some(1), door: O::Door, shops: 4, blank: 1 },
            ornament: Some(ornament(kind as u8)),
        };
        let ends = (GridPos(0, 0), GridPos(5, 0));
        let volumes = shapes.iter().enumerate().map(volume).collect();
        let shell = CellShell {
            origin: GridPos(1000, -1000),
            outline: outline(0),
            terrain: PlanTerrain { origin: GridPos(-9, 9), step: 4096, columns: 2, heights: vec![1, 2, 3, 5] },
            ground: surfaces.iter().map(|&surface| GroundPatch { surface, outline: outline(9), z: 3, course: Some(0) }).collect(),
            houses: vec![HouseShell { style: 1, floor: -5, volumes, is_monument: true }],
            courses: vec![Course { line: vec![GridPos(-7, 8), GridPos(90, 8)], from: 5000 }],
            objects: kinds.iter().map(object).collect(),
            blind: vec![ends],
            markings: [MarkingKind::Line, MarkingKind::Dashes, MarkingKind::Zebra, MarkingKind::Rails]
                .map(|kind| Marking { kind, line: vec![GridPos(1, 2), GridPos(3, 40)], width: 9, z: 8 })
                .to_vec(),
            spans: vec![
                span(7),
                WaySpan { form: SpanForm::Bore { crown: 5000, ends: (BoreEnd::Portal, BoreEnd::Wall) }, ..span(-7) },
            ],
            drawn_spans: 1,
            designs: vec![design()],
            monuments: vec![PlacedMonument { design: 0, pos: GridPos(-70, 8), z: 9, heading: 100 }],
        };
        (shell, FacadeSheet::of([WallKind::Street, WallKind::Yard, WallKind::Party].map(wall).to_vec()))
    }

    #[test]
    fn a_form_that_changed_has_a_new_version() {
        let (shell, sheet) = full();
        let hash = |packet: &Packet| blake3::hash(&write(packet)).to_hex()[..16].to_owned();
        let forms = (hash(&Packet::Shell(Box::new(shell))), hash(&Packet::Facades(sheet)));
        let expected = ("c6a8e305316b2ecf".to_owned(), "fb13120a768e30fd".to_owned());
        assert_eq!((crate::FORMAT_VERSION, forms), (22, expected), "raise FORMAT_VERSION if this is on purpose");
    }

    #[test]
    fn equal_walls_cost_next_to_nothing() {
        let storeys = vec![Storey { height: 3000, opening: Opening::Window }; 5];
        let wall = Wall { kind: WallKind::Street, bays: 6, storeys, ..Wall::default() };
        let size = |n| write(&Packet::Facades(FacadeSheet::of(vec![wall.clone(); n]))).len();
        assert!(size(1_100) - size(100) < 30, "{} B", size(1_100));
    }

    #[test]
    fn a_table_cannot_claim_the_memory() {
        // One tall wall named a million times: some hundred kilobytes that would become gigabytes.
        let tall = Wall { storeys: vec![Storey { height: 1, opening: Opening::Window }; 5_000], ..Wall::default() };
        let stored = pack(BlobKind::Facades, &WireSheet::named_often(&tall, 1_000_000));
        let error = read(&stored, Level::Two).expect_err("too much");
        assert!(error.to_string().contains("too many storeys"), "{error}");
    }
}
