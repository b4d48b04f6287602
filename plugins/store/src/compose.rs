mod division;

use std::borrow::Cow;

use veduta_city::{
    Boxes, Cell, CellShell, Cells, CityPlan, DistrictOf, FacadeSheet, GRID_PER_METRE, GridPos, GroundPatch, Level, OverviewParts,
    Palette, PictureFile, Style, WaySpan,
};

pub(crate) use division::Division;
use division::{add_vistas, leaves, regions};

use crate::index::encode_index;
use crate::leaf::LEAF;
use crate::overview::{decode_overview, encode_overview};
use crate::packet::{encode_pictures, encode_sheet, encode_shell, encode_styles};
use crate::region::{decode_region, encode_region};
use crate::wire::{bounds_beyond, metres_beyond};
use crate::{
    BlobRef, CellEntry, CityIndex, CityStats, FORMAT_VERSION, OverviewContext, Packet, PacketContext, Region, StoreError,
    decode_index, decode_packet, decode_styles, sheet_fits, valid, wall_count,
};

const WHAT: &str = "the city to be written";

pub(crate) fn invalid(reason: String) -> StoreError {
    StoreError::Invalid { what: WHAT, reason }
}

/// Where blobs go as they are made, from several threads.
pub(crate) type Sink<'s> = dyn Fn(&BlobRef, &[u8]) -> Result<(), StoreError> + Sync + 's;

/// The index of a plan, but for its regions. Styles go to the sink, read back first, so that what is
/// written can be read.
pub(crate) fn head(plan: &CityPlan, stats: &mut CityStats, sink: &Sink<'_>) -> Result<CityIndex, StoreError> {
    stats.houses = plan.houses.len() as u64;
    Ok(CityIndex {
        format: FORMAT_VERSION,
        name: plan.name.clone(),
        anchor: plan.anchor,
        attribution: plan.attribution.clone(),
        seed: plan.seed,
        growth_version: plan.growth_version,
        start: plan.start,
        extent: plan.extent.clone(),
        regions: [].into(),
        leaves: Vec::new(),
        palettes: palettes(plan).into(),
        styles: styles(plan, stats, sink)?,
        files: Vec::new(),
        bounds: Boxes::default(),
        pages: Vec::new(),
        here: 0,
        houses: Vec::new(),
    })
}

/// What is to be written of a cell.
#[derive(Debug, Clone)]
pub struct CellParts<'a> {
    /// Level 1.
    pub shell: Cow<'a, CellShell>,
    /// Level 2: as many walls as the shell has.
    pub sheet: Cow<'a, FacadeSheet>,
    /// Level 3: pictures of the sheet's painted walls.
    pub pictures: Vec<PictureFile>,
    /// Its ground as the overview is to tell it, in the city's own coordinates; `None`: piece by piece as the shell does.
    pub ground: Option<Vec<GroundPatch>>,
}

impl CellParts<'_> {
    /// What the overview is to tell of the ground.
    fn take_ground(&mut self) -> Vec<GroundPatch> {
        self.ground.take().unwrap_or_else(|| {
            let origin = self.shell.origin;
            let place = |patch: &GroundPatch| patch.outline.map(|pos| pos.wrapping_add(origin));
            let patch = |patch: &GroundPatch| GroundPatch { outline: place(patch), ..patch.clone() };
            self.shell.ground.iter().map(patch).collect()
        })
    }
}

/// What is told of the packets of all cells in their entries of the index, and what the overviews are to tell of their ground; the packets
/// go to the sink.
pub(crate) fn entries<'a>(
    (plan, division): (&CityPlan, &Division),
    cells: &Cells,
    contents: &(dyn Fn(usize) -> CellParts<'a> + Sync),
    stats: &mut CityStats,
    sink: &Sink<'_>,
) -> Result<(Vec<CellEntry>, Vec<Vec<GroundPatch>>), StoreError> {
    let count = cells.cells.len();
    let palettes = palettes(plan);
    let entries = side_by_side(count, &|i| {
        let mut parts = contents(i);
        let told = |error: StoreError| match error {
            StoreError::Write { .. } => error,
            error => invalid(format!("cell {i} ({}): {error}", cells.cells[i].id)),
        };
        let cell = &cells.cells[i];
        let context = division.context(i, &cell.outline, &palettes);
        let entry = entry((plan, context), cell, (&parts.shell, &parts.sheet, &parts.pictures), sink).map_err(told)?;
        Ok((entry, parts.take_ground()))
    })?;
    let (entries, ground): (Vec<CellEntry>, _) = entries.into_iter().unzip();
    stats.cells += count as u64;
    for entry in &entries {
        stats.walls += u64::from(entry.walls);
        for (sum, packet) in stats.bytes_level.iter_mut().zip(&entry.packets) {
            *sum += packet.map_or(0, |blob| u64::from(blob.bytes));
        }
    }
    Ok((entries, ground))
}

/// The file of an index, which was read back. Its regions, made of the entries and of what cells tell of themselves, go to the sink.
pub(crate) fn index(
    mut index: CityIndex,
    entries: Vec<CellEntry>,
    (overviews, houses): (&[BlobRef], &[Option<BlobRef>]),
    cells: Cells,
    stats: &mut CityStats,
    sink: &Sink<'_>,
) -> Result<Vec<u8>, StoreError> {
    let Cells { cells, portals, visible, far, skyline } = cells;
    let whole = Region { cells: take_over(entries, cells, visible)?, portals, skyline, ..Region::default() };
    let (mut regions, mut pages) = regions(whole)?;
    add_vistas(&mut pages, &regions, &far)?;
    for number in 0..regions.len() {
        let missing = || invalid(format!("there are {} overviews, and regions beyond", overviews.len()));
        let (overview, houses) = (*overviews.get(number).ok_or_else(missing)?, *houses.get(number).ok_or_else(missing)?);
        let page = Region { overview, houses, ..core::mem::take(&mut pages[number]) };
        let stored = encode_region(&page, number as u32, &regions);
        let blob = BlobRef::of(&stored);
        regions[number].blob = Some(blob);
        read_back(&page, &decode_region(&stored, number as u32, &regions)?)?;
        sink(&blob, &stored)?;
        stats.bytes_index += stored.len() as u64;
    }
    if regions.len() > LEAF {
        index.leaves = leaves(&mut regions, stats, sink)?;
    }
    index.regions = regions.into();
    let index = index.without_pages();
    let stored = encode_index(&index);
    read_back(&index, &decode_index(&stored)?)?;
    stats.regions = index.regions.len() as u64;
    stats.bytes_index += stored.len() as u64;
    Ok(stored)
}

/// Least and greatest corner in plan of all that is drawn with cells.
fn bounds_of(cells: &[CellEntry]) -> (GridPos, GridPos) {
    let around = |sum: Option<(GridPos, GridPos)>, (lo, hi): (GridPos, GridPos)| {
        let (low, high) = sum.unwrap_or((lo, hi));
        Some((GridPos(low.0.min(lo.0), low.1.min(lo.1)), GridPos(high.0.max(hi.0), high.1.max(hi.1))))
    };
    cells.iter().map(|cell| cell.bounds).fold(None, around).unwrap_or_default()
}

/// Fewest things worth a thread.
const LEAST_SHARE: usize = 8;

/// What `make` makes of 0, …, `count` − 1, in order, or its first mistake; shared among threads where there are any.
fn side_by_side<T: Send>(count: usize, make: &(dyn Fn(usize) -> Result<T, StoreError> + Sync)) -> Result<Vec<T>, StoreError> {
    let threads = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
    let share = count.div_ceil(threads).max(LEAST_SHARE);
    if share >= count {
        return (0..count).map(make).collect();
    }
    let parts: Vec<Result<Vec<T>, StoreError>> = std::thread::scope(|scope| {
        let part = |from: usize| scope.spawn(move || (from..(from + share).min(count)).map(make).collect());
        let running: Vec<_> = (0..count).step_by(share).map(part).collect();
        running.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(parts.into_iter().flatten().collect())
}

/// Fails if reading gives something other than what was written.
fn read_back<T: PartialEq>(written: &T, read: &T) -> Result<(), StoreError> {
    if written == read { Ok(()) } else { Err(invalid("it reads back as something else".to_owned())) }
}

/// Metres about a region's cells within which its overview tells the elevations of the ground.
const TERRAIN_MARGIN: i32 = 64 * GRID_PER_METRE;

/// The overviews of the regions that cells are told in: they go to the sink, each read back first.
pub(crate) fn overviews(
    (plan, division): (&CityPlan, &Division),
    cells: &Cells,
    (entries, ground): (&[CellEntry], &[Vec<GroundPatch>]),
    stats: &mut CityStats,
    sink: &Sink<'_>,
) -> Result<Vec<BlobRef>, StoreError> {
    let squares = &division.squares;
    let bounds: Vec<_> = squares.iter().map(|(_, cells)| bounds_of(&entries[cells.clone()])).collect();
    let part_of = |pos: GridPos| {
        let home = squares.partition_point(|(key, _)| key.first_code() <= pos.morton()).checked_sub(1);
        let nearest = || (0..squares.len()).min_by_key(|&n| distance_squared(bounds[n], pos));
        home.filter(|&n| squares[n].0.holds(pos)).or_else(nearest).unwrap_or_default()
    };
    let parts = OverviewParts::new(plan, squares.len(), part_of);
    let blobs = side_by_side(squares.len(), &|n| {
        let (lo, hi) = bounds[n];
        let wider = |steps: i32, by: i32| steps.saturating_add(by);
        let about = (
            GridPos(wider(lo.0, -TERRAIN_MARGIN), wider(lo.1, -TERRAIN_MARGIN)),
            GridPos(wider(hi.0, TERRAIN_MARGIN), wider(hi.1, TERRAIN_MARGIN)),
        );
        let district = |cell: usize| {
            let Cell { houses, spans, .. } = &cells.cells[cell];
            DistrictOf { cell: cell as u32, ground: &ground[cell], houses, spans }
        };
        let overview = parts.overview(n, about, squares[n].1.clone().map(district));
        // Before it is told: numbers that are none are told as others.
        valid::check_overview(&overview).map_err(invalid)?;
        let here = squares[n].1.clone();
        let context = OverviewContext { first: here.start as u32, cells: &entries[here], houses: Some(&division.houses[n].0) };
        let stored = encode_overview(&overview, context);
        let blob = BlobRef::of(&stored);
        read_back(&overview, &decode_overview(&stored, &blob, context)?)?;
        sink(&blob, &stored)?;
        Ok(blob)
    })?;
    stats.bytes_overview += blobs.iter().map(|blob| u64::from(blob.bytes)).sum::<u64>();
    Ok(blobs)
}

fn distance_squared((lo, hi): (GridPos, GridPos), pos: GridPos) -> i128 {
    let off = |v: i32, lo: i32, hi: i32| i128::from(v) - i128::from(v.clamp(lo, hi.max(lo)));
    off(pos.0, lo.0, hi.0).pow(2) + off(pos.1, lo.1, hi.1).pow(2)
}

fn styles(plan: &CityPlan, stats: &mut CityStats, sink: &Sink<'_>) -> Result<Option<BlobRef>, StoreError> {
    if plan.styles.0.is_empty() {
        return Ok(None);
    }
    if let Some(house) = plan.houses.iter().find(|house| usize::from(house.style) >= plan.styles.0.len()) {
        return Err(invalid(format!("house {} has style {} of {}", house.id, house.style, plan.styles.0.len())));
    }
    let stored = encode_styles(&plan.styles);
    let blob = BlobRef::of(&stored);
    read_back(&plan.styles, &decode_styles(&stored, &blob)?)?;
    stats.bytes_styles = u64::from(blob.bytes);
    sink(&blob, &stored)?;
    Ok(Some(blob))
}

/// What houses of each style are painted with.
fn palettes(plan: &CityPlan) -> Vec<Palette> {
    plan.styles.0.iter().map(Style::palette).collect()
}

/// What is told of the packets of a cell in its entry of the index; they go to the sink.
fn entry(
    (plan, context): (&CityPlan, PacketContext<'_>),
    cell: &Cell,
    (shell, sheet, pictures): (&CellShell, &FacadeSheet, &[PictureFile]),
    sink: &Sink<'_>,
) -> Result<CellEntry, StoreError> {
    let walls = wall_count(shell);
    if walls != cell.walls.len() || !sheet_fits(shell, sheet) {
        let (has, sheet) = (cell.walls.len(), sheet.walls.len());
        return Err(invalid(format!("it has {has} walls, its shell {walls}, its sheet {sheet}")));
    }
    let styles = plan.styles.0.len();
    if let Some(house) = shell.houses.iter().find(|house| styles > 0 && usize::from(house.style) >= styles) {
        return Err(invalid(format!("a house of it has style {} of {styles}", house.style)));
    }
    let mut packets = [None; 4];
    let stored = encode_shell(shell, context);
    let blob = BlobRef::of(&stored);
    read_back(&Packet::Shell(Box::new(shell.clone())), &decode_packet(&stored, &blob, Level::One, context)?)?;
    sink(&blob, &stored)?;
    packets[Level::One.index()] = Some(blob);
    // Trees know two levels too, though nothing is to be told of the second.
    if walls > 0 || shell.objects.iter().any(|object| object.kind.is_tree()) {
        let stored = encode_sheet(sheet);
        let blob = BlobRef::of(&stored);
        read_back(&Packet::Facades(sheet.clone()), &decode_packet(&stored, &blob, Level::Two, context)?)?;
        sink(&blob, &stored)?;
        packets[Level::Two.index()] = Some(blob);
    }
    if sheet.pictures() != pictures.len() {
        return Err(invalid(format!("its painted walls have {} pictures, but there are {}", sheet.pictures(), pictures.len())));
    }
    if !pictures.is_empty() {
        let stored = encode_pictures(pictures);
        let blob = BlobRef::of(&stored);
        read_back(&Packet::Pictures(pictures.to_vec()), &decode_packet(&stored, &blob, Level::Three, context)?)?;
        sink(&blob, &stored)?;
        packets[Level::Three.index()] = Some(blob);
    }
    Ok(CellEntry {
        // Overviews are told with it, before the index takes over the cells.
        outline: cell.outline.clone(),
        bounds: bounds(cell, shell),
        top: top(cell, shell),
        houses: cell.houses.len() as u32,
        walls: walls as u32,
        packets,
        ..CellEntry::default()
    })
}

/// The entries with what cells tell of themselves: taken over, because an index is as large as they are.
fn take_over(mut entries: Vec<CellEntry>, cells: Vec<Cell>, visible: Vec<Vec<u32>>) -> Result<Vec<CellEntry>, StoreError> {
    let (count, cut, seen) = (entries.len(), cells.len(), visible.len());
    if cut != count || seen != count {
        return Err(invalid(format!("there are {cut} cells but {seen} visible sets, and packets of {count} cells")));
    }
    for ((entry, cell), visible) in entries.iter_mut().zip(cells).zip(visible) {
        let Cell { id, name, outline, floor, portals, .. } = cell;
        let bounds = bounds_beyond(&outline, metres_beyond(&outline, entry.bounds));
        *entry = CellEntry { id, name, outline, floor, bounds, portals, visible, ..core::mem::take(entry) };
    }
    Ok(entries)
}

/// Least and greatest corner in plan of all that is drawn with a cell. Called on a shell that was checked, so that sums
/// stay within the grid.
fn bounds(cell: &Cell, shell: &CellShell) -> (GridPos, GridPos) {
    let houses = shell.houses.iter().flat_map(|house| &house.volumes).flat_map(|volume| &volume.footprint.outer);
    let ground = shell.ground.iter().flat_map(|patch| &patch.outline.outer);
    let objects = shell.objects.iter().map(|object| &object.pos);
    let spans = drawn_spans(shell).flat_map(|span| &span.stations).flat_map(|station| [&station.left, &station.right]);
    let drawn = houses.chain(ground).chain(objects).chain(spans).chain(&shell.outline.outer).map(|&pos| pos + shell.origin);
    let mut all = drawn.chain(cell.outline.outer.iter().copied());
    let first = all.next().unwrap_or(shell.origin);
    all.fold((first, first), |(lo, hi), p| (GridPos(lo.0.min(p.0), lo.1.min(p.1)), GridPos(hi.0.max(p.0), hi.1.max(p.1))))
}

/// Highest thing of a cell, grid steps.
fn top(cell: &Cell, shell: &CellShell) -> i32 {
    let houses =
        shell.houses.iter().flat_map(|house| &house.volumes).map(|volume| volume.eaves.saturating_add(volume.roof.height.max(0)));
    let objects = shell.objects.iter().map(|object| object.z.saturating_add(object.height));
    let spans = drawn_spans(shell).flat_map(|span| &span.stations).map(|station| station.z.saturating_add(PARAPET));
    houses.chain(objects).chain(spans).fold(cell.floor.1, i32::max)
}

/// Highest that parapets and railings stand above a bridge, grid steps.
const PARAPET: i32 = 2 * GRID_PER_METRE;

fn drawn_spans(shell: &CellShell) -> impl Iterator<Item = &WaySpan> {
    shell.spans.iter().take(shell.drawn_spans as usize)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Arc;

    use veduta_city::{GridPolygon, Id, Portal, PortalSide};

    use super::*;
    use crate::decode_leaf;

    /// Cells a side of a large city.
    const SIDE: i32 = 317;
    /// Metres from cell to cell.
    const APART_M: i32 = 50;
    /// So many cells away one sees, along and across.
    const SIGHT: i32 = 3;

    /// A city of 100,489 cells in rows: each with four portals, 49 cells in sight and two packets that do not shrink.
    fn large() -> Region {
        let side = APART_M * GRID_PER_METRE;
        let mut places: Vec<(i32, i32)> = (0..SIDE).flat_map(|x| (0..SIDE).map(move |y| (x, y))).collect();
        let outline = |(x, y): (i32, i32)| {
            // Corners on no round numbers.
            let at = |x: i32, y: i32| GridPos(x * side + (x * 7919 + y * 104_729) % 9000, y * side + (x * 15_485 + y * 863) % 9000);
            GridPolygon::simple(vec![at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)])
        };
        places.sort_by_key(|&place| outline(place).middle().morton());
        let mut number = vec![0; (SIDE * SIDE) as usize];
        (0..).zip(&places).for_each(|(n, &(x, y))| number[(x * SIDE + y) as usize] = n);
        let number =
            |(x, y): (i32, i32)| ((0..SIDE).contains(&x) && (0..SIDE).contains(&y)).then(|| number[(x * SIDE + y) as usize]);
        let mut noise = blake3::Hasher::new().finalize_xof();
        let mut whole = Region::default();
        for (cell, &(x, y)) in (0_u32..).zip(&places) {
            let outline = outline((x, y));
            let around = (-SIGHT..=SIGHT).flat_map(|dx| (-SIGHT..=SIGHT).map(move |dy| (x + dx, y + dy)));
            let mut visible: Vec<u32> = around.filter_map(number).collect();
            visible.sort_unstable();
            let mut packets = [None; 4];
            for (n, packet) in packets.iter_mut().take(2).enumerate() {
                let mut hash = [0; 12];
                noise.fill(&mut hash);
                *packet = Some(BlobRef { hash, bytes: 400 + u32::from(hash[0]) * (2 - n as u32) });
            }
            let bounds = bounds_beyond(&outline, [u32::from(packets[0].map_or(0, |blob| blob.hash[1])) % 20; 4]);
            whole.cells.push(CellEntry {
                id: Id(u64::from_le_bytes(*packets[1].map_or([0; 12], |blob| blob.hash).first_chunk().unwrap_or(&[0; 8]))),
                name: format!("Street {}", y / 3),
                floor: (0, 150),
                bounds,
                top: 12_000 + i32::from(packets[0].map_or(0, |blob| blob.hash[2])) * 64,
                visible,
                houses: 5,
                walls: 17,
                packets,
                outline: outline.clone(),
                ..CellEntry::default()
            });
            for (n, beyond) in [(1, (x + 1, y)), (2, (x, y + 1))] {
                let ends = (outline.outer[n], outline.outer[(n + 1) % 4]);
                let beyond = number(beyond).map_or(PortalSide::Edge, PortalSide::Cell);
                let n = whole.portals.len() as u32;
                whole.portals.push(Portal { ends, cell, beyond });
                whole.cells[cell as usize].portals.push(n);
            }
        }
        for (n, portal) in (0..).zip(&whole.portals) {
            if let PortalSide::Cell(other) = portal.beyond {
                whole.cells[other as usize].portals.push(n);
            }
        }
        whole.cells.iter_mut().for_each(|cell| cell.portals.sort_unstable());
        whole.skyline = (0..whole.cells.len() as u32).step_by(400).collect();
        whole
    }

    #[test]
    fn regions_about_a_place_are_found_as_if_all_were_looked_at() {
        let (told, _) = regions(large()).expect("a city");
        let head = head(&CityPlan::default(), &mut CityStats::default(), &|_, _| Ok(())).expect("a head");
        let index = CityIndex { regions: told.into(), ..head }.without_pages();
        let off = |(lo, hi): (GridPos, GridPos), pos: GridPos| {
            let along = |lo: i32, hi: i32, at: i32| (lo - at).max(at - hi).max(0);
            along(lo.0, hi.0, pos.0).max(along(lo.1, hi.1, pos.1))
        };
        for n in 0..400 {
            let (x, y, reach) = (n % 20 * APART_M * SIDE / 16, n / 20 * APART_M * SIDE / 16, n * n % 2_000);
            let (pos, reach) = (GridPos(x * GRID_PER_METRE, y * GRID_PER_METRE), reach * GRID_PER_METRE);
            let all = (0..).zip(&*index.regions).filter(|(_, region)| off(region.bounds, pos) <= reach);
            assert!(index.regions_about(pos, reach).eq(all), "{pos:?} {reach}");
        }
        assert_eq!(index.regions_about(GridPos(0, 0), i32::MAX).count(), index.regions.len());
    }

    #[test]
    fn a_city_of_a_hundred_thousand_cells_opens_reading_36_kb() {
        let (mut told, mut pages) = regions(large()).expect("a city");
        let count = pages.len() as u32;
        (0..).zip(&mut pages).for_each(|(n, page)| page.vistas = (n + 1..count.min(n + 9)).collect());
        let stored: Vec<Vec<u8>> = (0..).zip(&pages).map(|(n, page)| encode_region(page, n, &told)).collect();
        for (entry, stored) in told.iter_mut().zip(&stored) {
            entry.blob = Some(BlobRef::of(stored));
        }
        let plan = CityPlan { name: "Large".to_owned(), ..CityPlan::default() };
        let head = head(&plan, &mut CityStats::default(), &|_, _| Ok(())).expect("a head");
        let shelf = std::sync::Mutex::new(Vec::new());
        let keep = |_: &BlobRef, stored: &[u8]| {
            shelf.lock().expect("one thread").push(stored.to_vec());
            Ok(())
        };
        let leaves = leaves(&mut told, &mut CityStats::default(), &keep).expect("leaves");
        let shelf = shelf.into_inner().expect("one thread");
        let index = CityIndex { regions: told.into(), leaves, ..head }.without_pages();
        assert!(index.cell_count() >= 100_000);
        let list = encode_index(&index);
        let opened = decode_index(&list).expect("whole");
        let per_cell = stored.iter().map(Vec::len).sum::<usize>() as f64 / f64::from(index.cell_count());
        let mut most = 0;
        // Wherever a visit begins: the region of the place, and all that tell of what is seen from there.
        for start in (0..SIDE).step_by(13).flat_map(|x| (0..SIDE).step_by(17).map(move |y| GridPos(x, y))) {
            let pos = GridPos((start.0 * APART_M + 25) * GRID_PER_METRE, (start.1 * APART_M + 25) * GRID_PER_METRE);
            let mut index = opened.clone();
            let (mut read, mut bytes) = (BTreeSet::new(), list.len());
            let mut fetch = |index: &mut CityIndex, numbers: Vec<u32>| {
                for number in numbers {
                    if let Some(leaf) = index.missing_leaf(number) {
                        let stored = &shelf[leaf as usize];
                        bytes += stored.len();
                        let count = CityIndex::leaf_count(index.regions.len(), leaf);
                        let told = decode_leaf(stored, &index.leaves[leaf as usize], count).expect("whole");
                        index.put_leaf(leaf, &told);
                    }
                    if read.insert(number) {
                        bytes += stored[number as usize].len();
                        let region = decode_region(&stored[number as usize], number, &index.regions).expect("whole");
                        index.put(number, Arc::new(region));
                    }
                }
            };
            let about = index.regions_at(pos).collect();
            fetch(&mut index, about);
            let cell = index.locate(pos).expect("a cell");
            let seen = index.cell(cell).map(|entry| entry.visible.clone()).expect("told");
            let numbers = seen.iter().filter_map(|&cell| index.region_of(cell)).collect();
            fetch(&mut index, numbers);
            assert!(seen.iter().all(|&cell| index.cell(cell).is_some()));
            most = most.max(bytes);
        }
        println!("{} regions, {} B listed, {per_cell:.1} B a cell, at most {most} B to open", index.regions.len(), list.len());
        assert!(most <= 36_000, "{most} bytes are read");
    }
}
