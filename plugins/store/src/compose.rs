use std::borrow::Cow;

use veduta_city::{Cell, CellShell, Cells, CityPlan, FacadeSheet, GRID_PER_METRE, GridPos, Level, Overview, WaySpan};

use crate::index::encode_index;
use crate::overview::{decode_overview, press};
use crate::packet::{encode_sheet, encode_shell, encode_styles};
use crate::wire::WireOverview;
use crate::{
    BlobRef, CellEntry, CityIndex, CityStats, FORMAT_VERSION, Packet, StoreError, decode_index, decode_packet, decode_styles,
    sheet_fits, wall_count,
};

const WHAT: &str = "the city to be written";

pub(crate) fn invalid(reason: String) -> StoreError {
    StoreError::Invalid { what: WHAT, reason }
}

/// Where blobs go as they are made, from several threads.
pub(crate) type Sink<'s> = dyn Fn(&BlobRef, &[u8]) -> Result<(), StoreError> + Sync + 's;

/// The index of a plan, but for its cells and what is between them. Overview and styles go to the sink, each read back first, so that what is
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
        cells: Vec::new(),
        portals: Vec::new(),
        skyline: Vec::new(),
        places: plan.places.clone(),
        overview: overview(plan, stats, sink)?,
        styles: styles(plan, stats, sink)?,
    })
}

/// What is told of the packets of all cells in their entries of the index; the packets go to the sink.
pub(crate) fn entries<'a>(
    plan: &CityPlan,
    cells: &Cells,
    contents: &(dyn Fn(usize) -> (Cow<'a, CellShell>, Cow<'a, FacadeSheet>) + Sync),
    stats: &mut CityStats,
    sink: &Sink<'_>,
) -> Result<Vec<CellEntry>, StoreError> {
    let count = cells.cells.len();
    let entries = side_by_side(count, &|i| {
        let (shell, sheet) = contents(i);
        let told = |error: StoreError| match error {
            StoreError::Write { .. } => error,
            error => invalid(format!("cell {i} ({}): {error}", cells.cells[i].id)),
        };
        entry(plan, &cells.cells[i], (&shell, &sheet), sink).map_err(told)
    })?;
    stats.cells += count as u64;
    for entry in &entries {
        stats.walls += u64::from(entry.walls);
        for (sum, packet) in stats.bytes_level.iter_mut().zip(&entry.packets) {
            *sum += packet.map_or(0, |blob| u64::from(blob.bytes));
        }
    }
    Ok(entries)
}

/// The file of an index, which was read back.
pub(crate) fn index(index: &CityIndex, stats: &mut CityStats) -> Result<Vec<u8>, StoreError> {
    let stored = encode_index(index);
    read_back(index, &decode_index(&stored)?)?;
    stats.bytes_index = stored.len() as u64;
    Ok(stored)
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

fn overview(plan: &CityPlan, stats: &mut CityStats, sink: &Sink<'_>) -> Result<BlobRef, StoreError> {
    // Made twice rather than kept while it is encoded and decoded: it is as large as all houses' outlines.
    let columns = WireOverview::from(&Overview::of(plan));
    // A statement of its own: the overview is gone by now.
    let stored = press(columns);
    let blob = BlobRef::of(&stored);
    let read = decode_overview(&stored, &blob)?;
    read_back(&Overview::of(plan), &read)?;
    stats.bytes_overview = u64::from(blob.bytes);
    sink(&blob, &stored)?;
    Ok(blob)
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

/// What is told of the packets of a cell in its entry of the index; they go to the sink.
fn entry(
    plan: &CityPlan,
    cell: &Cell,
    (shell, sheet): (&CellShell, &FacadeSheet),
    sink: &Sink<'_>,
) -> Result<CellEntry, StoreError> {
    let walls = wall_count(shell);
    if walls != cell.walls.len() || !sheet_fits(shell, sheet) {
        let (has, sheet) = (cell.walls.len(), sheet.walls.len());
        return Err(invalid(format!("it has {has} walls, its shell {walls}, its sheet {sheet}")));
    }
    let styles = plan.styles.0.len();
    if let Some(house) = shell.houses.iter().find(|house| styles > 0 && usize::from(house.style) >= styles) {
        return Err(invalid(format!("its house {} has style {} of {styles}", house.id, house.style)));
    }
    let mut packets = [None; 4];
    let stored = encode_shell(shell);
    let blob = BlobRef::of(&stored);
    read_back(&Packet::Shell(Box::new(shell.clone())), &decode_packet(&stored, &blob, Level::One)?)?;
    sink(&blob, &stored)?;
    packets[Level::One.index()] = Some(blob);
    // Trees know two levels too, though nothing is to be told of the second.
    if walls > 0 || shell.objects.iter().any(|object| object.kind.is_tree()) {
        let stored = encode_sheet(sheet);
        let blob = BlobRef::of(&stored);
        read_back(&Packet::Facades(sheet.clone()), &decode_packet(&stored, &blob, Level::Two)?)?;
        sink(&blob, &stored)?;
        packets[Level::Two.index()] = Some(blob);
    }
    Ok(CellEntry {
        bounds: bounds(cell, shell),
        top: top(cell, shell),
        houses: cell.houses.len() as u32,
        walls: walls as u32,
        packets,
        ..CellEntry::default()
    })
}

/// Adds to the entries what cells tell of themselves: taken over, because an index is as large as they are.
pub(crate) fn take_over(index: &mut CityIndex, cells: Cells) -> Result<(), StoreError> {
    let (count, cut, seen) = (index.cells.len(), cells.cells.len(), cells.visible.len());
    if cut != count || seen != count {
        return Err(invalid(format!("there are {cut} cells but {seen} visible sets, and packets of {count} cells")));
    }
    for ((entry, cell), visible) in index.cells.iter_mut().zip(cells.cells).zip(cells.visible) {
        let Cell { id, name, outline, floor, portals, .. } = cell;
        *entry = CellEntry { id, name, outline, floor, portals, visible, ..core::mem::take(entry) };
    }
    (index.portals, index.skyline) = (cells.portals, cells.skyline);
    Ok(())
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
