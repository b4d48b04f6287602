//! The regions of a city, and what tells where they are stored.

use core::ops::Range;
use std::collections::BTreeSet;

use veduta_city::{Cell, CityPlan, GRID_PER_METRE, GridPolygon, GridPos, Palette};

use super::{Sink, bounds_of, invalid, palettes, read_back, side_by_side};
use crate::houses::{decode_houses, encode_houses};
use crate::leaf::{LEAF, decode_leaf, encode_leaf};
use crate::region::squares;
use crate::{
    BlobRef, CellEntry, CityStats, HousesContext, PacketContext, Region, RegionEntry, RegionHouses, RegionKey, StoreError, valid,
};

/// The regions of a city while it is written.
pub(crate) struct Division {
    pub(super) squares: Vec<(RegionKey, Range<usize>)>,
    /// Of each, its houses, and where they are stored if there are some.
    pub(super) houses: Vec<(RegionHouses, Option<BlobRef>)>,
}

impl Division {
    /// Of some cells, with what is told of their houses, which goes to the sink.
    pub(crate) fn new(plan: &CityPlan, cells: &[Cell], stats: &mut CityStats, sink: &Sink<'_>) -> Result<Self, StoreError> {
        let codes: Vec<u64> = cells.iter().map(|cell| cell.outline.middle().morton()).collect();
        let squares = squares(&codes);
        let palettes = palettes(plan);
        let houses = side_by_side(squares.len(), &|n| {
            let here = &cells[squares[n].1.clone()];
            let houses = RegionHouses::of(plan, here.iter().map(|cell| &cell.houses));
            if houses.parts().is_empty() {
                return Ok((houses, None));
            }
            let known = |cell: &Cell| CellEntry { outline: cell.outline.clone(), ..CellEntry::default() };
            let known: Vec<CellEntry> = here.iter().map(known).collect();
            let context = HousesContext { cells: &known, palettes: &palettes };
            let stored = encode_houses(&houses, context);
            let blob = BlobRef::of(&stored);
            read_back(&houses, &decode_houses(&stored, &blob, context)?)?;
            sink(&blob, &stored)?;
            Ok((houses, Some(blob)))
        })?;
        stats.bytes_houses += houses.iter().filter_map(|(_, blob)| *blob).map(|blob| u64::from(blob.bytes)).sum::<u64>();
        Ok(Self { squares, houses })
    }

    /// What a packet of a cell is read with.
    pub(super) fn context<'c>(&'c self, cell: usize, outline: &'c GridPolygon, palettes: &'c [Palette]) -> PacketContext<'c> {
        let region = self.squares.partition_point(|(_, cells)| cells.start <= cell).saturating_sub(1);
        let place = cell - self.squares[region].1.start;
        PacketContext { outline: Some(outline), palettes, houses: Some(&self.houses[region].0), place }
    }

    /// Where the houses of each region are stored.
    pub(crate) fn blobs(&self) -> Vec<Option<BlobRef>> {
        self.houses.iter().map(|(_, blob)| *blob).collect()
    }
}

/// The regions of a city that is one, not yet with their blobs, and what lies in each.
pub(super) fn regions(whole: Region) -> Result<(Vec<RegionEntry>, Vec<Region>), StoreError> {
    let codes: Vec<u64> = whole.cells.iter().map(|cell| cell.outline.middle().morton()).collect();
    if let Some(late) = codes.windows(2).position(|pair| pair[0] > pair[1]) {
        let id = whole.cells[late + 1].id;
        return Err(invalid(format!("cell {} ({id}) is out of order: sort cells by `outline.middle().morton()`", late + 1)));
    }
    let all = entry_of(RegionKey::WHOLE, 0..whole.cells.len() as u32, &whole);
    valid::check_region(&whole, &all, core::slice::from_ref(&all)).map_err(invalid)?;
    let Region { cells, portals, skyline, .. } = whole;
    let mut cells = cells.into_iter();
    let mut told = Vec::new();
    let mut pages = Vec::new();
    for (key, range) in squares(&codes) {
        let numbers = range.start as u32..range.end as u32;
        let mut page = Region { cells: cells.by_ref().take(range.len()).collect(), ..Region::default() };
        page.skyline = skyline.iter().copied().filter(|cell| numbers.contains(cell)).collect();
        // Portals keep their order, and cells name them by their places in the region.
        let known: BTreeSet<u32> = page.cells.iter().flat_map(|cell| cell.portals.iter().copied()).collect();
        page.portals = known.iter().map(|&portal| portals[portal as usize]).collect();
        let known: Vec<u32> = known.into_iter().collect();
        for cell in &mut page.cells {
            cell.portals.iter_mut().for_each(|portal| *portal = known.partition_point(|other| other < portal) as u32);
        }
        told.push(entry_of(key, numbers, &page));
        pages.push(page);
    }
    Ok((told, pages))
}

/// What the index says of a region, not yet with its blob.
fn entry_of(key: RegionKey, numbers: Range<u32>, region: &Region) -> RegionEntry {
    let (lo, hi) = bounds_of(&region.cells);
    let down = |steps: i32| steps.div_euclid(GRID_PER_METRE).saturating_mul(GRID_PER_METRE);
    let up = |steps: i32| down(steps.saturating_add(GRID_PER_METRE - 1));
    RegionEntry {
        key,
        first: numbers.start,
        cells: numbers.len() as u32,
        skyline: region.skyline.len() as u32,
        top: up(region.cells.iter().map(|cell| cell.top).max().unwrap_or_default()),
        bounds: (GridPos(down(lo.0), down(lo.1)), GridPos(up(hi.0), up(hi.1))),
        blob: None,
    }
}

/// Tells each region which others are seen from it far away: `far` is by cell, or nothing.
pub(super) fn add_vistas(pages: &mut [Region], regions: &[RegionEntry], far: &[Vec<u32>]) -> Result<(), StoreError> {
    let count = regions.last().map_or(0, |last| last.numbers().end as usize);
    let is_none = |cell: &u32| *cell as usize >= count;
    if (!far.is_empty() && far.len() != count) || far.iter().flatten().any(is_none) {
        return Err(invalid(format!("there are {count} cells, and {} lists of cells far away, or such as name others", far.len())));
    }
    for (page, own) in pages.iter_mut().zip(regions) {
        let cells = far.get(own.first as usize..(own.first + own.cells) as usize).unwrap_or_default();
        let others = cells.iter().flatten().filter(|cell| !own.numbers().contains(cell));
        let home = |&cell: &u32| regions.partition_point(|entry| entry.first <= cell).saturating_sub(1) as u32;
        page.vistas = others.map(home).collect::<BTreeSet<u32>>().into_iter().collect();
    }
    Ok(())
}

/// The leaves of an index, which go to the sink, and take over where regions are stored.
pub(super) fn leaves(regions: &mut [RegionEntry], stats: &mut CityStats, sink: &Sink<'_>) -> Result<Vec<BlobRef>, StoreError> {
    let leaf = |regions: &mut [RegionEntry]| {
        let blobs: Vec<BlobRef> = regions.iter_mut().filter_map(|entry| entry.blob.take()).collect();
        let stored = encode_leaf(&blobs);
        let blob = BlobRef::of(&stored);
        read_back(&blobs, &decode_leaf(&stored, &blob, blobs.len())?)?;
        sink(&blob, &stored)?;
        stats.bytes_index += stored.len() as u64;
        Ok(blob)
    };
    regions.chunks_mut(LEAF).map(leaf).collect()
}
