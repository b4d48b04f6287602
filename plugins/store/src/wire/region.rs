use std::collections::{BTreeSet, HashMap};

use serde::{Deserialize, Serialize};
use veduta_city::{GRID_PER_METRE, GridPolygon, GridPos, Id, Portal, PortalSide};

use super::{
    Malformed, WireBlobs,
    columns::{Deltas, Ids, Lists, Pull, Texts},
    expecting,
    keys::Keys,
};
use crate::code::{Outlines, Source, Unread};
use crate::{CellEntry, Region, RegionEntry, RegionKey};

/// Sections of outlines.
const CELLS: u8 = 0;
const PORTALS: u8 = 1;

/// A [`Region`] in columns. Cells have numbers of their own in it: first its own, then those of other regions that it names.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireRegion {
    /// Names of cells.
    texts: Texts,
    cells: WireCells,
    portals: WirePortals,
    skyline: Lists,
    foreign: Foreign,
    /// Those seen far away.
    vistas: Keys,
    /// The overview, and the houses if there are some.
    overview: WireBlobs,
}

/// Cells of other regions, by these and their places in them.
#[derive(Serialize, Deserialize)]
struct Foreign {
    regions: Keys,
    cells: Lists,
}

#[derive(Serialize, Deserialize)]
struct WireCells {
    /// What differs from the usual.
    ids: Ids,
    floors_low: Deltas,
    /// Above the lowest.
    floors_high: Vec<i32>,
    tops: Deltas,
    /// Metres west, south, east and north of the outline's bounds to which there is something to draw.
    beyond: Vec<u32>,
    portals: Lists,
    /// What differs from the expected.
    visible: Lists,
    houses: Vec<u32>,
    walls: Vec<u32>,
    /// Bit n: it has a packet of the level with index n.
    levels: Vec<u8>,
    packets: WireBlobs,
}

#[derive(Serialize, Deserialize)]
struct WirePortals {
    cells: Vec<u32>,
    /// 0: the edge; else one more than the cell.
    beyond: Vec<u32>,
}

/// Which cells most likely see which: who is seen sees back.
#[derive(Default)]
struct Mutual(HashMap<u32, Vec<u32>>);

impl Mutual {
    /// Those that a cell is expected to see, by what those before it see.
    fn expected(&mut self, cell: u32) -> BTreeSet<u32> {
        self.0.remove(&cell).into_iter().flatten().chain([cell]).collect()
    }

    fn sees(&mut self, cell: u32, seen: &BTreeSet<u32>) {
        seen.range(cell + 1..).for_each(|&other| self.0.entry(other).or_default().push(cell));
    }
}

/// The id that cells have by where they lie.
fn usual_id(outline: &GridPolygon) -> Id {
    Id::from_place("cell", outline.centroid())
}

/// Numbers of cells in the city from those in a region, and back.
struct Numbers {
    first: u32,
    own: u32,
    /// Ascending.
    foreign: Vec<u32>,
}

impl Numbers {
    /// Of a region that names cells.
    fn of(region: &Region, entry: &RegionEntry) -> Self {
        let own = entry.numbers();
        let sides = region.portals.iter().flat_map(|portal| [Some(portal.cell), portal.other(portal.cell)]).flatten();
        let mut foreign: Vec<u32> = region.cells.iter().flat_map(|cell| cell.visible.iter().copied()).chain(sides).collect();
        foreign.retain(|cell| !own.contains(cell));
        foreign.sort_unstable();
        foreign.dedup();
        Self { first: entry.first, own: entry.cells, foreign }
    }

    fn local(&self, cell: u32) -> u32 {
        match cell.checked_sub(self.first).filter(|&own| own < self.own) {
            Some(own) => own,
            None => self.own + self.foreign.partition_point(|&other| other < cell) as u32,
        }
    }

    fn global(&self, local: u32) -> Result<u32, Malformed> {
        match local.checked_sub(self.own) {
            None => Ok(self.first + local),
            Some(n) => self.foreign.get(n as usize).copied().ok_or(Malformed::Reason("a cell is named that is nowhere")),
        }
    }
}

impl Foreign {
    fn of(foreign: &[u32], own: RegionKey, regions: &[RegionEntry]) -> Self {
        let (mut keys, mut cells) = (Vec::new(), Lists::default());
        let mut rest = foreign;
        while let Some(&cell) = rest.first() {
            let home = regions.partition_point(|entry| entry.first <= cell).saturating_sub(1);
            // Whatever no region has is told of the last: it cannot be read back.
            let end = regions.get(home + 1).map_or(rest.len(), |next| rest.partition_point(|&other| other < next.first));
            let (here, after) = rest.split_at(end.max(1));
            let entry = &regions[home];
            keys.push(Some(entry.key));
            cells.push(here.iter().map(|cell| cell - entry.first));
            rest = after;
        }
        Self { regions: Keys::of(own, keys), cells }
    }

    fn pull(self, own: RegionKey, regions: &[RegionEntry]) -> Result<Vec<u32>, Malformed> {
        let mut lists = self.cells.pull();
        let mut all = Vec::new();
        for key in self.regions.pull(own)? {
            let entry = &regions[named(key, regions)?];
            let cells = lists.take()?;
            if cells.is_empty() {
                return Err(Malformed::Reason("a region is named for no cell"));
            }
            for cell in cells {
                if cell >= entry.cells {
                    return Err(Malformed::Reason("a cell is named that its region does not have"));
                }
                all.push(entry.first + cell);
            }
        }
        lists.finish()?;
        if all.is_sorted_by(|a, b| a < b) { Ok(all) } else { Err(Malformed::Reason("cells of other regions do not ascend")) }
    }
}

/// Number of the region with a key.
fn named(key: RegionKey, regions: &[RegionEntry]) -> Result<usize, Malformed> {
    let found = regions.binary_search_by_key(&key.first_code(), |entry| entry.key.first_code()).ok();
    let found = found.filter(|&n| regions[n].key == key);
    found.ok_or(Malformed::Reason("a region is named that is not there"))
}

impl WireRegion {
    pub(crate) fn of(region: &Region, number: usize, regions: &[RegionEntry]) -> (Self, Outlines) {
        let own = regions[number].key;
        let numbers = Numbers::of(region, &regions[number]);
        let mut outlines = Outlines::default();
        region.cells.iter().for_each(|cell| outlines.polygon(CELLS, &cell.outline));
        for portal in &region.portals {
            outlines.point(PORTALS, portal.ends.0);
            outlines.point(PORTALS, portal.ends.1);
        }
        let mut skyline = Lists::default();
        skyline.push(region.skyline.iter().map(|&cell| numbers.local(cell)));
        let beyond = |portal: &Portal| match portal.beyond {
            PortalSide::Edge => 0,
            PortalSide::Cell(cell) => numbers.local(cell) + 1,
        };
        let wire = Self {
            texts: Texts::of(region.cells.iter().map(|cell| cell.name.as_str())),
            cells: WireCells::of(&region.cells, &numbers),
            portals: WirePortals {
                cells: region.portals.iter().map(|portal| numbers.local(portal.cell)).collect(),
                beyond: region.portals.iter().map(beyond).collect(),
            },
            skyline,
            foreign: Foreign::of(&numbers.foreign, own, regions),
            // What is no region is told as none, and cannot be read back.
            vistas: Keys::of(own, region.vistas.iter().map(|&n| Some(regions.get(n as usize)?.key))),
            overview: WireBlobs::of(core::iter::once(&region.overview).chain(&region.houses)),
        };
        (wire, outlines)
    }

    pub(crate) fn pull(self, number: usize, regions: &[RegionEntry], outlines: &mut Source<'_, '_>) -> Result<Region, Unread> {
        let entry = &regions[number];
        let numbers = Numbers { first: entry.first, own: entry.cells, foreign: self.foreign.pull(entry.key, regions)? };
        // Before any of them is made: what claims a cell may take a bit.
        if self.cells.levels.len() != entry.cells as usize {
            return Err(Unread(format!("it has {} cells; the index says {}", self.cells.levels.len(), entry.cells)));
        }
        let mut texts = self.texts.pull()?;
        let cells = self.cells.pull(&numbers, outlines, || texts.take())?;
        let mut beyond = Pull::new("portals", self.portals.beyond);
        let mut portals = expecting(self.portals.cells.len());
        for cell in self.portals.cells {
            let ends = (outlines.point(PORTALS)?, outlines.point(PORTALS)?);
            let beyond = match beyond.take()?.checked_sub(1) {
                None => PortalSide::Edge,
                Some(cell) => PortalSide::Cell(numbers.global(cell)?),
            };
            portals.push(Portal { ends, cell: numbers.global(cell)?, beyond });
        }
        beyond.finish()?;
        texts.finish()?;
        let mut lists = self.skyline.pull();
        let skyline = lists.take()?.into_iter().map(|cell| numbers.global(cell)).collect::<Result<_, Malformed>>()?;
        lists.finish()?;
        let mut blobs = self.overview.pull("overviews and houses");
        let overview = blobs.take()?;
        let houses = if blobs.is_empty() { None } else { Some(blobs.take()?) };
        blobs.finish()?;
        let vistas = self
            .vistas
            .pull(entry.key)?
            .into_iter()
            .map(|key| Ok(named(key, regions)? as u32))
            .collect::<Result<_, Malformed>>()?;
        Ok(Region { cells, portals, skyline, vistas, overview, houses })
    }
}

impl WireCells {
    fn of(cells: &[CellEntry], numbers: &Numbers) -> Self {
        let (mut ids, mut portals, mut visible) = (Ids::default(), Lists::default(), Lists::default());
        let mut mutual = Mutual::default();
        for (n, cell) in (0..).zip(cells) {
            ids.push(Id(cell.id.0 ^ usual_id(&cell.outline).0));
            portals.push(cell.portals.iter().copied());
            let seen: BTreeSet<u32> = cell.visible.iter().map(|&cell| numbers.local(cell)).collect();
            let told: Vec<u32> = seen.symmetric_difference(&mutual.expected(n)).copied().collect();
            visible.push(told.into_iter());
            mutual.sees(n, &seen);
        }
        let levels = |cell: &CellEntry| (0..4).filter(|&n| cell.packets[n].is_some()).fold(0, |bits, n| bits | 1 << n);
        Self {
            ids,
            floors_low: Deltas::of(cells.iter().map(|cell| cell.floor.0)),
            floors_high: cells.iter().map(|cell| cell.floor.1.wrapping_sub(cell.floor.0)).collect(),
            tops: Deltas::of(cells.iter().map(|cell| cell.top)),
            beyond: cells.iter().flat_map(|cell| metres_beyond(&cell.outline, cell.bounds)).collect(),
            portals,
            visible,
            houses: cells.iter().map(|cell| cell.houses).collect(),
            walls: cells.iter().map(|cell| cell.walls).collect(),
            levels: cells.iter().map(levels).collect(),
            packets: WireBlobs::of(cells.iter().flat_map(|cell| cell.packets.iter().flatten())),
        }
    }

    fn pull(
        self,
        numbers: &Numbers,
        outlines: &mut Source<'_, '_>,
        mut name: impl FnMut() -> Result<String, Malformed>,
    ) -> Result<Vec<CellEntry>, Unread> {
        let mut ids = self.ids.pull();
        let mut low = Pull::new("floors of cells", self.floors_low.numbers());
        let mut high = Pull::new("heights of floors", self.floors_high);
        let mut tops = Pull::new("tops of cells", self.tops.numbers());
        let mut beyond = Pull::new("bounds of cells", self.beyond);
        let (mut portals, mut visible) = (self.portals.pull(), self.visible.pull());
        let mut houses = Pull::new("houses of cells", self.houses);
        let mut walls = Pull::new("walls of cells", self.walls);
        let mut packets = self.packets.pull("packets of cells");
        let mut mutual = Mutual::default();
        let mut cells = expecting(self.levels.len());
        for levels in self.levels {
            if levels >= 1 << 4 {
                return Err(Malformed::Reason("a cell has packets of unknown levels").into());
            }
            let floor = low.take()?;
            let outline = outlines.polygon(CELLS)?;
            let metres = [beyond.take()?, beyond.take()?, beyond.take()?, beyond.take()?];
            let told: BTreeSet<u32> = visible.take()?.into_iter().collect();
            let n = cells.len() as u32;
            let seen: BTreeSet<u32> = told.symmetric_difference(&mutual.expected(n)).copied().collect();
            mutual.sees(n, &seen);
            let mut seen = seen.into_iter().map(|cell| numbers.global(cell)).collect::<Result<Vec<_>, Malformed>>()?;
            seen.sort_unstable();
            let mut all = [None; 4];
            for (n, packet) in all.iter_mut().enumerate() {
                if levels >> n & 1 == 1 {
                    *packet = Some(packets.take()?);
                }
            }
            cells.push(CellEntry {
                id: Id(ids.take()?.0 ^ usual_id(&outline).0),
                name: name()?,
                bounds: bounds_beyond(&outline, metres),
                outline,
                floor: (floor, floor.wrapping_add(high.take()?)),
                top: tops.take()?,
                portals: portals.take()?,
                visible: seen,
                houses: houses.take()?,
                walls: walls.take()?,
                packets: all,
            });
        }
        ids.finish()?;
        low.finish()?;
        high.finish()?;
        tops.finish()?;
        beyond.finish()?;
        portals.finish()?;
        visible.finish()?;
        houses.finish()?;
        walls.finish()?;
        packets.finish()?;
        Ok(cells)
    }
}

/// Metres west, south, east and north of an outline's bounds to which others reach, rounded up.
pub(crate) fn metres_beyond(outline: &GridPolygon, (lo, hi): (GridPos, GridPos)) -> [u32; 4] {
    let (low, high) = outline.bounds().unwrap_or_default();
    let up = |to: i32, from: i32| {
        let steps = (i64::from(to) - i64::from(from)).max(0) as u64;
        u32::try_from(steps.div_ceil(GRID_PER_METRE as u64)).unwrap_or(u32::MAX)
    };
    [up(low.0, lo.0), up(low.1, lo.1), up(hi.0, high.0), up(hi.1, high.1)]
}

/// Bounds so many metres west, south, east and north of an outline's.
pub(crate) fn bounds_beyond(outline: &GridPolygon, metres: [u32; 4]) -> (GridPos, GridPos) {
    let (low, high) = outline.bounds().unwrap_or_default();
    let [west, south, east, north] = metres.map(|m| i32::try_from(m).unwrap_or(i32::MAX).saturating_mul(GRID_PER_METRE));
    let lo = GridPos(low.0.saturating_sub(west), low.1.saturating_sub(south));
    (lo, GridPos(high.0.saturating_add(east), high.1.saturating_add(north)))
}
