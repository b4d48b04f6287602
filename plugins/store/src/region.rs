use core::ops::Range;

use veduta_city::{GridPolygon, GridPos, Id, Level, Portal};

use crate::blob::{BlobKind, pack_with, unpack_with};
use crate::code::Source;
use crate::wire::WireRegion;
use crate::{BlobRef, StoreError, valid};

/// A square of the whole grid or a half of one, named by the way down to it: a one, then a bit for each time that it was halved (north,
/// east, north, …). They are the same for every city, so that what is built at one end changes no names at the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegionKey(u32);

/// What has more cells than this is halved, unless it is one of the smallest squares.
pub(crate) const MOST_CELLS: usize = 128;

impl RegionKey {
    /// How often the smallest squares were halved: they measure 128 m.
    pub(crate) const DEEPEST: u32 = 30;

    /// The whole grid.
    pub(crate) const WHOLE: Self = Self(1);

    /// One of the squares so many steps down, counted along the curve of their Morton codes; `None` if there are fewer, or none so deep.
    #[must_use]
    pub fn new(square: u32, depth: u32) -> Option<Self> {
        (depth <= Self::DEEPEST && square < 1 << depth).then(|| Self(1 << depth | square))
    }

    /// Which of the squares as deep it is, in the order of their Morton codes.
    pub(crate) const fn square(self) -> u32 {
        self.0 ^ 1 << self.depth()
    }

    /// The square or half so many steps down in which a Morton code lies.
    fn of(code: u64, depth: u32) -> Self {
        Self(1 << depth | code.checked_shr(u64::BITS - depth).unwrap_or_default() as u32)
    }

    /// How many steps down it lies.
    pub(crate) const fn depth(self) -> u32 {
        u32::BITS - 1 - self.0.leading_zeros()
    }

    /// The Morton code of its south-western corner, which is the least in it.
    pub(crate) fn first_code(self) -> u64 {
        u64::from(self.square()).checked_shl(u64::BITS - self.depth()).unwrap_or_default()
    }

    /// Whether a plan position lies in it.
    pub(crate) fn holds(self, pos: GridPos) -> bool {
        Self::of(pos.morton(), self.depth()) == self
    }
}

/// What the index says of a region: a square of the city whose cells are told together, in a blob of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RegionEntry {
    /// Which square.
    pub key: RegionKey,
    /// Number of its first cell. Its cells have the numbers from there on, by the Morton codes of the middles of their outlines.
    pub first: u32,
    /// How many cells it has.
    pub cells: u32,
    /// How many of them are on the skyline.
    pub skyline: u32,
    /// The highest thing drawn with its cells above the city's zero: whole metres, in grid steps; 0 if it has no cells.
    pub top: i32,
    /// Least and greatest corner in plan of all that is drawn with its cells, on whole metres.
    pub bounds: (GridPos, GridPos),
    /// Its [`Region`]; none as long as the leaf of the index that tells of it is not here.
    pub blob: Option<BlobRef>,
}

impl RegionEntry {
    /// Numbers of its cells.
    #[must_use]
    pub fn numbers(&self) -> Range<u32> {
        self.first..self.first.saturating_add(self.cells)
    }
}

/// What the index tells of the cells of one region.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region {
    /// Its cells, from [`RegionEntry::first`] on.
    pub cells: Vec<CellEntry>,
    /// Portals of its cells; those into another region are told in both. Cells are named by their numbers in the city.
    pub portals: Vec<Portal>,
    /// Those of its cells whose tallest things are seen over the roofs from far away, by their numbers in the city, ascending.
    pub skyline: Vec<u32>,
    /// Regions of which something is seen from its cells farther away than visible sets reach: by their numbers, ascending.
    pub vistas: Vec<u32>,
    /// The [`veduta_city::Overview`] of what lies in its square, or beyond all squares and nearest to it.
    pub overview: BlobRef,
    /// Its [`crate::RegionHouses`]; none if there are no houses.
    pub houses: Option<BlobRef>,
}

/// What the index says of a cell.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CellEntry {
    /// Stable id.
    pub id: Id,
    /// Name of its square or street, may be empty.
    pub name: String,
    /// Its space in plan.
    pub outline: GridPolygon,
    /// Lowest and highest ground, grid steps.
    pub floor: (i32, i32),
    /// Least and greatest corner in plan of all that is drawn with it, houses and yards included: whole metres beyond its outline.
    pub bounds: (GridPos, GridPos),
    /// Its highest thing above the city's zero, grid steps.
    pub top: i32,
    /// Its portals, as indices of [`Region::portals`], ascending.
    pub portals: Vec<u32>,
    /// Cells seen from somewhere in it, itself included, by their numbers in the city, ascending.
    pub visible: Vec<u32>,
    /// Houses whose roof it carries: over all cells they add up to the city's.
    pub houses: u32,
    /// Walls that face it.
    pub walls: u32,
    /// Its packets, by [`Level::index`]. A cell without walls and trees has none beyond level 1.
    pub packets: [Option<BlobRef>; 4],
}

impl CellEntry {
    /// The packet of a level.
    #[must_use]
    pub fn packet(&self, level: Level) -> Option<&BlobRef> {
        self.packets.get(level.index())?.as_ref()
    }
}

/// The squares that cells of these ascending Morton codes are told in, and which cells lie in each.
pub(crate) fn squares(codes: &[u64]) -> Vec<(RegionKey, Range<usize>)> {
    let mut squares = Vec::new();
    cut(codes, 0..codes.len(), 0, &mut squares);
    squares
}

fn cut(codes: &[u64], cells: Range<usize>, depth: u32, squares: &mut Vec<(RegionKey, Range<usize>)>) {
    if cells.len() <= MOST_CELLS || depth == RegionKey::DEEPEST {
        let first = codes.get(cells.start).copied().unwrap_or_default();
        // The smallest square that holds them all would change its name whenever a cell is built beside it.
        squares.push((RegionKey::of(first, depth), cells));
        return;
    }
    let mut from = cells.start;
    while from < cells.end {
        let half = RegionKey::of(codes[from], depth + 1);
        let until = from + codes[from..cells.end].partition_point(|&code| RegionKey::of(code, depth + 1) <= half);
        cut(codes, from..until, depth + 1, squares);
        from = until;
    }
}

/// Stored form of a region, which is the one with a number of these. What it says of the cells of others is told by the others' keys.
#[must_use]
pub fn encode_region(region: &Region, number: u32, regions: &[RegionEntry]) -> Vec<u8> {
    pack_with(BlobKind::Region, &WireRegion::of(region, number as usize, regions))
}

/// The region of stored bytes, which is the one with a number of these.
///
/// # Errors
/// If the bytes are not those that the index names, cannot be decoded, or contradict themselves or the index.
pub fn decode_region(stored: &[u8], number: u32, regions: &[RegionEntry]) -> Result<Region, StoreError> {
    let what = BlobKind::Region.words();
    let none = || StoreError::Invalid { what, reason: format!("there is no region {number} of {}", regions.len()) };
    let entry = regions.get(number as usize).ok_or_else(none)?;
    let unknown = || StoreError::Invalid { what, reason: format!("the leaf that tells of region {number} is not here") };
    let blob = entry.blob.as_ref().ok_or_else(unknown)?;
    let pull = |wire: WireRegion, outlines: &mut Source<'_, '_>| wire.pull(number as usize, regions, outlines);
    let region = unpack_with(BlobKind::Region, stored, blob, pull)?;
    valid::check_region(&region, entry, regions).map_err(|reason| StoreError::Invalid { what, reason })?;
    Ok(region)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowded_squares_are_halved() {
        let at = |x: i32, y: i32| GridPos(x * 1024, y * 1024).morton();
        let few: Vec<u64> = (0..100).map(|i| at(i, 0)).collect();
        assert_eq!(squares(&few), [(RegionKey::WHOLE, 0..100)]);
        let mut many: Vec<u64> = (-20..20).flat_map(|x| (-20..20).map(move |y| at(40 * x, 40 * y))).collect();
        many.sort_unstable();
        let squares = squares(&many);
        assert!(squares.iter().all(|(key, cells)| cells.len() <= MOST_CELLS && key.depth() <= RegionKey::DEEPEST), "{squares:?}");
        assert_eq!(squares.iter().map(|(_, cells)| cells.len()).sum::<usize>(), many.len());
        assert!(squares.windows(2).all(|pair| pair[0].1.end == pair[1].1.start), "one after another: {squares:?}");
        assert!(squares.is_sorted_by_key(|(key, _)| key.first_code()), "{squares:?}");
        for (key, cells) in squares {
            assert!(many[cells].iter().all(|&code| code >= key.first_code()));
        }
    }

    #[test]
    fn what_is_built_at_one_end_changes_no_square_at_the_other() {
        let at = |x: i32, y: i32| GridPos(x * 1024, y * 1024).morton();
        let town = |to: i32| {
            let mut codes: Vec<u64> = (0..to).flat_map(|x| (0..16).map(move |y| at(64 * x, 64 * y))).collect();
            codes.sort_unstable();
            squares(&codes).into_iter().map(|(key, cells)| (key, codes[cells].to_vec())).collect::<Vec<_>>()
        };
        let (small, large) = (town(16), town(40));
        let kept = small.iter().filter(|square| large.contains(square)).count();
        assert_eq!((kept, small.len(), large.len()), (2, 2, 5));
    }

    #[test]
    fn any_number_of_cells_may_lie_on_one_spot() {
        let codes = vec![GridPos(5, 5).morton(); 1000];
        assert_eq!(squares(&codes), [(RegionKey::of(codes[0], RegionKey::DEEPEST), 0..1000)]);
        assert_eq!(squares(&[]), [(RegionKey::WHOLE, 0..0)], "a city without cells has a region all the same");
    }

    #[test]
    fn a_square_knows_where_it_begins() {
        for pos in [GridPos(0, 0), GridPos(-1, 7), GridPos(123_456, -654_321), GridPos(i32::MIN, i32::MAX)] {
            for depth in 0..=RegionKey::DEEPEST {
                let key = RegionKey::of(pos.morton(), depth);
                assert_eq!(RegionKey::new(key.square(), depth), Some(key));
                assert_eq!(RegionKey::of(key.first_code(), depth), key);
                assert!(key.first_code() <= pos.morton());
            }
        }
        for (square, depth) in [(1, 0), (16, 4), (u32::MAX, 30), (0, 31), (0, 32), (0, u32::MAX)] {
            assert_eq!(RegionKey::new(square, depth), None, "{square} {depth}");
        }
    }
}
