use veduta_city::{CityPlan, Massing, Palette};

use crate::blob::{BlobKind, pack_with, unpack_with};
use crate::wire::WireHouses;
use crate::{BlobRef, CellEntry, StoreError, valid};

/// A part of a house.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HousePart {
    /// Style of its house.
    pub style: u16,
    /// Where it stands and what it looks like, as precise as in the plan.
    pub massing: Massing,
}

/// The houses of a region, by the cells that carry their roofs. Packets of the region's cells, and its overview, name what is told here
/// instead of telling it again.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RegionHouses {
    parts: Vec<HousePart>,
    /// How many parts are told when each cell has been.
    ends: Vec<u32>,
}

impl RegionHouses {
    /// What is told of houses of a plan, given by their indices, cell by cell.
    pub(crate) fn of<'a>(plan: &CityPlan, cells: impl IntoIterator<Item = &'a Vec<u32>>) -> Self {
        let mut told = Self::default();
        for house in cells.into_iter().map(|houses| houses.iter().filter_map(|&house| plan.houses.get(house as usize))) {
            let part = |style: u16| move |massing| HousePart { style, massing };
            told.push(house.flat_map(|house| Massing::of_house(house, &plan.terrain).into_iter().map(part(house.style))));
        }
        told
    }

    /// Adds the parts of the next cell.
    pub fn push(&mut self, parts: impl IntoIterator<Item = HousePart>) {
        self.parts.extend(parts);
        self.ends.push(self.parts.len() as u32);
    }

    /// Parts of houses whose roofs a cell carries, by its place in the region; none if there is no such cell.
    #[must_use]
    pub fn of_cell(&self, place: usize) -> &[HousePart] {
        self.parts.get(self.numbers(place)).unwrap_or_default()
    }

    /// Numbers of them among [`RegionHouses::parts`].
    pub(crate) fn numbers(&self, place: usize) -> core::ops::Range<usize> {
        let end = |place: Option<usize>| place.and_then(|place| self.ends.get(place)).map_or(0, |&end| end as usize);
        let end_here = end(Some(place));
        end(place.checked_sub(1)).min(end_here)..end_here
    }

    /// All parts, one cell after another.
    #[must_use]
    pub fn parts(&self) -> &[HousePart] {
        &self.parts
    }

    /// How many cells it tells of.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.ends.len()
    }
}

/// What houses need not tell, because the index does. They are read with what they were written with, as a packet is.
#[derive(Debug, Clone, Copy, Default)]
pub struct HousesContext<'a> {
    /// The region's cells.
    pub cells: &'a [CellEntry],
    /// Colours of houses by their styles: [`CityIndex::palettes`](crate::CityIndex::palettes).
    pub palettes: &'a [Palette],
}

/// Stored form of a region's houses.
#[must_use]
pub fn encode_houses(houses: &RegionHouses, context: HousesContext<'_>) -> Vec<u8> {
    pack_with(BlobKind::Houses, &WireHouses::of(houses, context))
}

/// The houses of stored bytes that the reference stands for.
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or contradict themselves.
pub fn decode_houses(stored: &[u8], blob: &BlobRef, context: HousesContext<'_>) -> Result<RegionHouses, StoreError> {
    let what = BlobKind::Houses.words();
    let houses = unpack_with(BlobKind::Houses, stored, blob, |wire: WireHouses, outlines| wire.pull(context, outlines))?;
    valid::check_houses(&houses, context.cells.len()).map_err(|reason| StoreError::Invalid { what, reason })?;
    Ok(houses)
}

#[cfg(test)]
mod tests {
    use veduta_city::{
        CellShell, Gable, GridPolygon, GridPos, HouseShell, Level, PlanRoof, PlanTerrain, Rgb, RoofShape, VolumeShell,
    };

    use super::*;
    use crate::{FORMAT_VERSION, Packet, PacketContext, decode_packet, encode_packet};

    fn square(x: i32, y: i32, side: i32) -> GridPolygon {
        GridPolygon::simple(vec![GridPos(x, y), GridPos(x + side, y), GridPos(x + side, y + side), GridPos(x, y + side)])
    }

    fn part(x: i32, shape: RoofShape, rise: i32) -> HousePart {
        let roof = PlanRoof { shape, height: rise, direction: 12, colour: Rgb(140, 60, 40) };
        let outline = GridPolygon { holes: vec![square(x + 9, 9, 4).outer], ..square(x, 0, 10_240) };
        HousePart {
            style: (x % 3).unsigned_abs() as u16,
            massing: Massing { outline, height: 12_345, roof, colour: Rgb(200, 180, 140) },
        }
    }

    /// Three cells, the second of which has no house.
    fn houses() -> RegionHouses {
        let mut houses = RegionHouses::default();
        houses.push([part(0, RoofShape::Gabled, 4_000), part(10_240, RoofShape::Flat, PlanRoof::NONE)]);
        houses.push([]);
        houses.push([part(-99_999, RoofShape::Dome, 1)]);
        houses
    }

    fn cells() -> Vec<CellEntry> {
        [-20_000, 0, 20_480].map(|x| CellEntry { outline: square(x, -10_240, 10_240), ..CellEntry::default() }).to_vec()
    }

    #[test]
    fn houses_survive_with_and_without_palettes() {
        let cells = cells();
        let palettes = vec![Palette { walls: vec![Rgb(200, 180, 140)], roofs: vec![Rgb(140, 60, 40)], trim: 1.1 }; 2];
        for palettes in [&palettes[..], &[]] {
            let context = HousesContext { cells: &cells, palettes };
            let stored = encode_houses(&houses(), context);
            assert_eq!(decode_houses(&stored, &BlobRef::of(&stored), context), Ok(houses()));
        }
        assert_eq!([0, 1, 2, 3].map(|place| houses().of_cell(place).len()), [2, 0, 1, 0]);
        assert_eq!(houses().numbers(2), 2..3);
    }

    #[test]
    fn a_form_that_changed_has_a_new_version() {
        let form = blake3::hash(&encode_houses(&houses(), HousesContext { cells: &cells(), palettes: &[] })).to_hex();
        assert_eq!((FORMAT_VERSION, &form[..16]), (22, "8fdc140604045a34"), "raise FORMAT_VERSION if this is on purpose");
    }

    #[test]
    fn houses_of_another_region_are_refused() {
        let cells = cells();
        let stored = encode_houses(&houses(), HousesContext { cells: &cells, palettes: &[] });
        let context = HousesContext { cells: &cells[1..], palettes: &[] };
        let error = decode_houses(&stored, &BlobRef::of(&stored), context).expect_err("two cells").to_string();
        assert!(error.contains("they tell of 3 cells, and there are 2"), "{error}");
    }

    /// A cell of whose two houses one is told with its region, and the wall of one of another cell.
    fn shell() -> CellShell {
        let volume = |part: &HousePart, ground: i32, walls: Vec<u16>| VolumeShell {
            footprint: part.massing.outline.clone(),
            bottom: 70,
            eaves: ground + part.massing.height - part.massing.roof.height.max(0),
            colour: part.massing.colour,
            trim: Rgb(1, 2, 3),
            roof: part.massing.roof,
            gable: Gable::Plain,
            has_roof: true,
            walls,
            arcades: Vec::new(),
        };
        let house = |part: &HousePart, walls: Vec<u16>| HouseShell {
            style: part.style,
            floor: 70,
            volumes: vec![volume(part, 500, walls)],
            is_monument: false,
        };
        let houses = houses();
        CellShell {
            outline: square(0, 0, 9_000),
            terrain: PlanTerrain { origin: GridPos(-9_000, -9_000), step: 40_960, columns: 2, heights: vec![500; 4] },
            houses: vec![
                house(&houses.parts()[2], vec![1, 3]),
                house(&part(7, RoofShape::Hipped, 9), vec![0]),
                house(&houses.parts()[0], vec![2]),
            ],
            ..CellShell::default()
        }
    }

    #[test]
    fn what_a_region_tells_of_a_house_its_packets_do_not() {
        let (houses, palettes) = (houses(), [Palette { walls: Vec::new(), roofs: Vec::new(), trim: 1.0 }]);
        let packet = Packet::Shell(Box::new(shell()));
        let alone = PacketContext { palettes: &palettes, ..PacketContext::default() };
        let with = PacketContext { houses: Some(&houses), ..alone };
        let [long, short] = [alone, with].map(|context| encode_packet(&packet, context));
        assert!(short.len() + 20 < long.len(), "{} B of {}", short.len(), long.len());
        let read = |stored: &[u8], context| decode_packet(stored, &BlobRef::of(stored), Level::One, context);
        assert_eq!(read(&short, with).as_ref(), Ok(&packet));
        assert_eq!(read(&long, with).as_ref(), Ok(&packet), "who tells all needs nobody");
        let error = read(&short, alone).expect_err("no houses are known").to_string();
        assert!(error.contains("a part of a house is named that its region does not tell of"), "{error}");
    }

    #[test]
    fn a_part_is_a_volume_of_one_house_alone() {
        let (houses, mut shell) = (houses(), shell());
        let context = PacketContext { houses: Some(&houses), ..PacketContext::default() };
        // Twice the same: the second is told by itself.
        shell.houses.push(shell.houses[0].clone());
        let packet = Packet::Shell(Box::new(shell));
        let stored = encode_packet(&packet, context);
        assert_eq!(decode_packet(&stored, &BlobRef::of(&stored), Level::One, context), Ok(packet));
    }
}
