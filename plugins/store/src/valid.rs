//! What decoded values must keep to, so that their users may index and subtract without looking.
//!
//! Plan positions stay within ±2³⁰ steps (1,048 km), positions within a cell and heights within ±2²⁷ (131 km): no sum or
//! difference of two of them leaves 32 bits.

use veduta_city::{
    CellShell, Course, District, FacadeSheet, GridPolygon, GridPos, GroundPatch, HouseShell, Massing, Overview, PlanTerrain,
    SpanForm, SpanStation, VolumeShell, WaySpan,
};

use crate::blob::BlobKind;
use crate::file::check_files;
use crate::leaf::LEAF;
use crate::region::MOST_CELLS;
use crate::{BlobRef, CellEntry, CityIndex, Region, RegionEntry, RegionHouses};

/// A reason in a sentence without a full stop.
type Check = Result<(), String>;

/// Most faces of all monuments of a cell together, and most vertices of one marking.
const MOST_FACES: u64 = 16_000_000;
/// Most squares of the terrain that patches of ground are cut into, as if each filled the box about it.
const MOST_SQUARES: u64 = 1 << 20;
/// As many in an overview, which tells of many cells.
const MOST_SQUARES_AFAR: u64 = 1 << 22;
/// Most spans of ways of a cell, and how long all are together, metres: posts, sleepers and dashes on them are counted by
/// that.
const MOST_SPANS: usize = 1 << 14;
const MOST_SPANS_M: f64 = 100_000.0;
/// Most markings of a span.
const MOST_MARKINGS: usize = 32;
const LONGEST_LINE: usize = 256;
const FAR: u32 = 1 << 30;
const NEAR: u32 = 1 << 27;

const fn is_within(pos: GridPos, reach: u32) -> bool {
    pos.0.unsigned_abs() <= reach && pos.1.unsigned_abs() <= reach
}

fn check_height(name: &str, height: i32) -> Check {
    if height.unsigned_abs() <= NEAR { Ok(()) } else { Err(format!("{name} is at a height of {height} steps")) }
}

fn check_polygon(name: &str, polygon: &GridPolygon, reach: u32) -> Check {
    for ring in polygon.rings() {
        if ring.len() < 3 {
            return Err(format!("{name} has a ring of {} vertices", ring.len()));
        }
        if let Some(pos) = ring.iter().find(|&&pos| !is_within(pos, reach)) {
            return Err(format!("{name} reaches to ({}, {}), too far", pos.0, pos.1));
        }
    }
    Ok(())
}

/// Fails unless the numbers ascend and stay below a count.
fn check_ascending(name: &str, list: &[u32], count: usize) -> Check {
    if !list.is_sorted_by(|a, b| a < b) {
        return Err(format!("{name} do not ascend"));
    }
    match list.last() {
        Some(&last) if last as usize >= count => Err(format!("{name} name number {last} of {count}")),
        _ => Ok(()),
    }
}

/// Number of edges, and so of walls, of an outline.
pub(crate) fn edge_count(polygon: &GridPolygon) -> usize {
    polygon.rings().map(Vec::len).sum()
}

pub(crate) fn check_shell(shell: &CellShell) -> Check {
    if !is_within(shell.origin, FAR - NEAR) {
        return Err(format!("its origin is at ({}, {}), too far", shell.origin.0, shell.origin.1));
    }
    check_polygon("its outline", &shell.outline, NEAR)?;
    shell.terrain.check().map_err(|reason| format!("its terrain: {reason}"))?;
    if squares(&shell.ground, &shell.terrain) > MOST_SQUARES {
        return Err(format!("its ground lies on more than {MOST_SQUARES} squares of its terrain"));
    }
    for (i, patch) in shell.ground.iter().enumerate() {
        check_polygon("it", &patch.outline, NEAR)
            .and_then(|()| check_height("it", patch.z))
            .map_err(|reason| format!("patch {i} of its ground: {reason}"))?;
        if let Some(course) = patch.course.filter(|&course| course as usize >= shell.courses.len()) {
            return Err(format!("patch {i} of its ground is laid along course {course} of {}", shell.courses.len()));
        }
    }
    let vertices: usize = shell.courses.iter().map(|course| course.line.len()).sum();
    if vertices > Course::MOST_VERTICES || !shell.courses.iter().flat_map(|course| &course.line).all(|&pos| is_within(pos, NEAR)) {
        return Err("its courses have too many vertices, or reach too far".to_owned());
    }
    for (i, house) in shell.houses.iter().enumerate() {
        check_house(house).map_err(|reason| format!("house {i}: {reason}"))?;
    }
    for (i, object) in shell.objects.iter().enumerate() {
        if !is_within(object.pos, NEAR) {
            return Err(format!("object {i} stands too far away"));
        }
        check_height("its foot", object.z)
            .and_then(|()| check_height("its top", object.height))
            .map_err(|reason| format!("object {i}: {reason}"))?;
        if let Some(design) = object.monument.filter(|&design| usize::from(design) >= shell.designs.len()) {
            return Err(format!("object {i} has design {design} of {}", shell.designs.len()));
        }
    }
    for (i, &(from, to)) in shell.blind.iter().enumerate() {
        if !is_within(from, NEAR) || !is_within(to, NEAR) {
            return Err(format!("blind portal {i} reaches too far"));
        }
    }
    for (i, marking) in shell.markings.iter().enumerate() {
        if !(2..=LONGEST_LINE).contains(&marking.line.len()) || !marking.line.iter().all(|&pos| is_within(pos, NEAR)) {
            return Err(format!("marking {i} has no line, or one that reaches too far"));
        }
        check_height("it", marking.z)
            .and_then(|()| check_height("its edge", marking.width))
            .map_err(|reason| format!("marking {i}: {reason}"))?;
    }
    if shell.drawn_spans as usize > shell.spans.len() {
        return Err(format!("it draws {} of {} spans", shell.drawn_spans, shell.spans.len()));
    }
    check_spans(&shell.spans, NEAR, 1)?;
    for (i, design) in shell.designs.iter().enumerate() {
        design.check().map_err(|error| format!("design {i}: {error}"))?;
    }
    for (i, placed) in shell.monuments.iter().enumerate() {
        if usize::from(placed.design) >= shell.designs.len() {
            return Err(format!("monument {i} has design {} of {}", placed.design, shell.designs.len()));
        }
        if !is_within(placed.pos, NEAR) {
            return Err(format!("monument {i} stands too far away"));
        }
        check_height("its foot", placed.z).map_err(|reason| format!("monument {i}: {reason}"))?;
    }
    let placed = shell.monuments.iter().map(|m| m.design).chain(shell.objects.iter().filter_map(|object| object.monument));
    let faces = placed.filter_map(|d| shell.designs.get(usize::from(d))?.most_faces().ok());
    if faces.fold(0, u64::saturating_add) > MOST_FACES {
        return Err(format!("its monuments come to more than {MOST_FACES} faces"));
    }
    Ok(())
}

/// Length of a span along its sides, metres.
fn length_m(span: &WaySpan) -> f64 {
    let step = |pair: &[SpanStation]| {
        let side = |a: GridPos, b: GridPos| a.to_metres().distance(b.to_metres());
        side(pair[0].left, pair[1].left).max(side(pair[0].right, pair[1].right))
    };
    span.stations.windows(2).map(step).sum()
}

fn check_span(span: &WaySpan, reach: u32) -> Check {
    let ends = span.stations.iter().flat_map(|station| [station.left, station.right]);
    if !(2..=LONGEST_LINE).contains(&span.stations.len()) || ends.into_iter().any(|pos| !is_within(pos, reach)) {
        return Err("it has no stations, or ones too far away".to_owned());
    }
    span.stations.iter().try_for_each(|station| check_height("it", station.z))?;
    let crown = match span.form {
        SpanForm::Bore { crown, .. } => Some(crown),
        _ => None,
    };
    let heights =
        [span.pavements.0, span.pavements.1, span.springing].into_iter().chain(span.piers.0).chain(span.piers.1).chain(crown);
    heights.into_iter().try_for_each(|height| check_height("what holds it", height))?;
    if span.markings.len() > MOST_MARKINGS {
        return Err(format!("it has {} markings", span.markings.len()));
    }
    span.markings.iter().flat_map(|m| [m.left.0, m.left.1, m.width]).try_for_each(|left| check_height("a marking", left))
}

/// How many squares between posts some patches may be cut into, at most.
fn squares(ground: &[GroundPatch], terrain: &PlanTerrain) -> u64 {
    let Some(rows) = terrain.heights.len().checked_div(terrain.columns as usize) else { return 0 };
    let posts = [(terrain.origin.0, terrain.columns as usize), (terrain.origin.1, rows)];
    let along = |low: i32, high: i32, (origin, count): (i32, usize)| {
        let end = i64::from(origin) + i64::from(terrain.step) * count as i64;
        let (from, to) = (i64::from(low).max(origin.into()), i64::from(high).min(end));
        ((to - from).max(0) / i64::from(terrain.step.max(1))) as u64 + 1
    };
    let bounds = ground.iter().filter_map(|patch| patch.outline.bounds());
    bounds.map(|(low, high)| along(low.0, high.0, posts[0]) * along(low.1, high.1, posts[1])).fold(0, u64::saturating_add)
}

fn check_house(house: &HouseShell) -> Check {
    check_height("its floor", house.floor)?;
    for (v, volume) in house.volumes.iter().enumerate() {
        check_volume(volume).map_err(|reason| format!("volume {v}: {reason}"))?;
    }
    Ok(())
}

fn check_volume(volume: &VolumeShell) -> Check {
    check_polygon("its footprint", &volume.footprint, NEAR)?;
    check_height("its foot", volume.bottom)?;
    check_height("its eaves", volume.eaves)?;
    check_height("its roof", volume.roof.height)?;
    if !volume.walls.is_sorted_by(|a, b| a < b) {
        return Err("its walls do not ascend".to_owned());
    }
    if !volume.arcades.is_sorted_by_key(|arcade| (arcade.wall, arcade.span)) {
        return Err("its arcades do not ascend".to_owned());
    }
    for arcade in &volume.arcades {
        check_height("its paving", arcade.floor)?;
        let (from, to) = arcade.span;
        if volume.walls.binary_search(&arcade.wall).is_err()
            || from < 0
            || to <= from
            || to.unsigned_abs() > NEAR
            || !(0..=1 << 20).contains(&arcade.depth)
        {
            return Err(format!("an arcade from {from} to {to} of wall {} lies under no wall here", arcade.wall));
        }
    }
    let edges = edge_count(&volume.footprint);
    match volume.walls.last() {
        Some(&last) if usize::from(last) >= edges => Err(format!("it has wall {last} on a footprint of {edges} edges")),
        _ => Ok(()),
    }
}

/// Spans of so many cells.
fn check_spans(spans: &[WaySpan], reach: u32, cells: usize) -> Check {
    for (i, span) in spans.iter().enumerate() {
        check_span(span, reach).map_err(|reason| format!("span {i}: {reason}"))?;
    }
    let length: f64 = spans.iter().map(length_m).sum();
    if length > MOST_SPANS_M * cells as f64 || spans.len() > MOST_SPANS * cells {
        return Err(format!("its {} spans are {length:.0} m long", spans.len()));
    }
    Ok(())
}

fn check_massing((i, Massing { outline, height, roof, .. }): (usize, &Massing)) -> Check {
    check_polygon("it", outline, FAR)
        .and_then(|()| check_height("its top", *height))
        .and_then(|()| check_height("its roof", roof.height))
        .map_err(|reason| format!("outline {i} of a house: {reason}"))
}

/// Houses of so many cells.
pub(crate) fn check_houses(houses: &RegionHouses, cells: usize) -> Check {
    if houses.cell_count() != cells {
        return Err(format!("they tell of {} cells, and there are {cells}", houses.cell_count()));
    }
    houses.parts().iter().map(|part| &part.massing).enumerate().try_for_each(check_massing)
}

pub(crate) fn check_overview(overview: &Overview) -> Check {
    if squares(&overview.ground, &overview.terrain) > MOST_SQUARES_AFAR {
        return Err(format!("its ground lies on more than {MOST_SQUARES_AFAR} squares of its terrain"));
    }
    overview.houses.iter().enumerate().try_for_each(check_massing)?;
    for (i, patch) in overview.ground.iter().enumerate() {
        check_polygon("it", &patch.outline, FAR)
            .and_then(|()| check_height("it", patch.z))
            .map_err(|reason| format!("ground {i}: {reason}"))?;
    }
    if !overview.districts.is_sorted_by(|a, b| a.cell < b.cell) {
        return Err("its districts are not told in the order of their cells, each once".to_owned());
    }
    let sum = |of: fn(&District) -> u32| overview.districts.iter().map(|district| u64::from(of(district))).sum::<u64>();
    let told = [
        ("pieces of ground", sum(|district| district.ground), overview.ground.len()),
        ("houses", sum(|district| district.houses), overview.houses.len()),
        ("spans", sum(|district| district.spans), overview.spans.len()),
    ];
    for (what, of_districts, all) in told {
        if !overview.districts.is_empty() && of_districts != all as u64 {
            return Err(format!("its districts have {of_districts} {what} of {all}"));
        }
    }
    check_districts(overview)?;
    // No more count than a region has, however many it says it has.
    check_spans(&overview.spans, FAR, overview.districts.len().clamp(1, MOST_CELLS))?;
    let mut in_streets = overview.streets.iter().flat_map(|street| &street.line);
    if let Some(pos) = in_streets.find(|&&pos| !is_within(pos, FAR)) {
        return Err(format!("something is at ({}, {}), too far", pos.0, pos.1));
    }
    for place in &overview.places {
        if !place.pos.is_finite() || !place.radius_m.is_finite() || !place.view.as_ref().is_none_or(is_view) {
            return Err(format!("place `{}` lies nowhere: a number of it is none", place.name));
        }
    }
    for name in &overview.names {
        if name.house as usize >= overview.houses.len() {
            return Err(format!("a name is given to house number {} of {}", name.house, overview.houses.len()));
        }
        if name.parts == 0 || name.parts as usize > overview.houses.len() - name.house as usize {
            return Err(format!("the house `{}` has {} parts", name.name, name.parts));
        }
    }
    Ok(())
}

/// Fails if something of a district lies so far from the rest of it that positions in it would not be those of a cell.
fn check_districts(overview: &Overview) -> Check {
    let mut ground = overview.ground.iter().map(|patch| patch.outline.bounds());
    let mut houses = overview.houses.iter().map(|massing| massing.outline.bounds());
    let mut spans = overview.spans.iter().map(|span| span.outline().bounds());
    for (n, district) in overview.districts.iter().enumerate() {
        let of_ground = ground.by_ref().take(district.ground as usize);
        let of_houses = houses.by_ref().take(district.houses as usize);
        let all = of_ground.chain(of_houses).chain(spans.by_ref().take(district.spans as usize)).flatten();
        let bounds = all.reduce(|(lo, hi), (l, h)| (GridPos(lo.0.min(l.0), lo.1.min(l.1)), GridPos(hi.0.max(h.0), hi.1.max(h.1))));
        if bounds.is_some_and(|(lo, hi)| lo.0.abs_diff(hi.0).max(lo.1.abs_diff(hi.1)) > NEAR) {
            return Err(format!("district {n} reaches too far"));
        }
    }
    Ok(())
}

/// Fails if a blob claims more bytes than any of its kind has: so much would be read before it could be looked at.
fn check_blob(kind: BlobKind, blob: Option<&BlobRef>) -> Check {
    match blob {
        Some(blob) if u64::from(blob.bytes) > kind.stored_cap() => {
            Err(format!("{} claims {} bytes, more than the {} that it may have", kind.words(), blob.bytes, kind.stored_cap()))
        }
        _ => Ok(()),
    }
}

pub(crate) fn check_index(index: &CityIndex) -> Check {
    let is_view = is_view(&index.start);
    if !is_view || !index.anchor.lat.is_finite() || !index.anchor.lon.is_finite() {
        return Err("its start or anchor is not a number".to_owned());
    }
    check_blob(BlobKind::Styles, index.styles.as_ref())?;
    check_files(&index.files)?;
    index.files.iter().try_for_each(|file| check_blob(BlobKind::File, Some(&file.blob)))?;
    // A city may have no edge, if nothing lies in it.
    if !(index.extent.outer.is_empty() && index.extent.holes.is_empty()) {
        check_polygon("the city's edge", &index.extent, FAR)?;
    }
    if index.regions.is_empty() {
        return Err("it has no region".to_owned());
    }
    for (i, region) in index.regions.iter().enumerate() {
        check_bounds(region.bounds)
            .and_then(|()| check_height("its top", region.top))
            .map_err(|reason| format!("region {i}: {reason}"))?;
        if region.skyline > region.cells {
            return Err(format!("region {i} has more cells on the skyline than cells"));
        }
        check_blob(BlobKind::Region, region.blob.as_ref())?;
    }
    if !index.leaves.is_empty() && index.leaves.len() != index.regions.len().div_ceil(LEAF) {
        return Err(format!("it has {} leaves for {} regions", index.leaves.len(), index.regions.len()));
    }
    index.leaves.iter().try_for_each(|leaf| check_blob(BlobKind::Leaf, Some(leaf)))?;
    if !index.regions.is_sorted_by(|a, b| a.key.first_code() < b.key.first_code()) {
        return Err("its regions are out of order".to_owned());
    }
    Ok(())
}

/// Where so many regions are stored.
pub(crate) fn check_leaf(regions: &[BlobRef], count: usize) -> Check {
    if regions.len() != count {
        return Err(format!("it tells of {} regions in place of {count}", regions.len()));
    }
    regions.iter().try_for_each(|region| check_blob(BlobKind::Region, Some(region)))
}

fn check_bounds((lo, hi): (GridPos, GridPos)) -> Check {
    if lo.0 > hi.0 || lo.1 > hi.1 || !is_within(lo, FAR) || !is_within(hi, FAR) {
        return Err("its bounds are no rectangle".to_owned());
    }
    Ok(())
}

fn is_view(view: &veduta_city::Viewpoint) -> bool {
    view.pos.is_finite() && view.eye_m.is_finite() && view.heading_deg.is_finite() && view.pitch_deg.is_finite()
}

/// A region against what the index says of it and of the others.
pub(crate) fn check_region(region: &Region, entry: &RegionEntry, regions: &[RegionEntry]) -> Check {
    if region.cells.len() != entry.cells as usize || region.skyline.len() != entry.skyline as usize {
        let (cells, skyline) = (region.cells.len(), region.skyline.len());
        let (told, told_skyline) = (entry.cells, entry.skyline);
        return Err(format!("it has {cells} cells, {skyline} of them on the skyline; the index says {told} and {told_skyline}"));
    }
    check_blob(BlobKind::Overview, Some(&region.overview))?;
    check_blob(BlobKind::Houses, region.houses.as_ref())?;
    let count = regions.last().map_or(0, |last| last.first as usize + last.cells as usize);
    for (cell, number) in region.cells.iter().zip(entry.first..) {
        check_cell(region, number, count, cell).map_err(|reason| format!("cell {number} ({}): {reason}", cell.id))?;
    }
    for (i, portal) in region.portals.iter().enumerate() {
        let other = portal.other(portal.cell).unwrap_or(portal.cell);
        if portal.cell.max(other) as usize >= count {
            return Err(format!("portal {i} leads to cell {} of {count}", portal.cell.max(other)));
        }
        if !entry.numbers().contains(&portal.cell) && !entry.numbers().contains(&other) {
            return Err(format!("portal {i} is on the border of none of its cells"));
        }
        if !is_within(portal.ends.0, FAR) || !is_within(portal.ends.1, FAR) {
            return Err(format!("portal {i} reaches too far"));
        }
        for cell in [portal.cell, other].into_iter().filter(|cell| entry.numbers().contains(cell)) {
            if region.cells[(cell - entry.first) as usize].portals.binary_search(&(i as u32)).is_err() {
                return Err(format!("cell {cell} does not know of portal {i} on its border"));
            }
        }
    }
    check_ascending("cells of the skyline", &region.skyline, count)?;
    check_ascending("regions far away", &region.vistas, regions.len())?;
    if let Some(cell) = region.skyline.iter().find(|cell| !entry.numbers().contains(cell)) {
        return Err(format!("cell {cell} of the skyline is another region's"));
    }
    Ok(())
}

/// Painted walls are walls of the sheet, and can be drawn.
pub(crate) fn check_painted(sheet: &FacadeSheet) -> Check {
    check_ascending("its painted walls", &sheet.painted.iter().map(|wall| wall.wall).collect::<Vec<_>>(), sheet.walls.len())?;
    sheet.painted.iter().try_for_each(|wall| wall.painted.check())?;
    match sheet.sections() {
        0..=FacadeSheet::MOST_SECTIONS => Ok(()),
        many => Err(format!("its painted walls have {many} sections")),
    }
}

fn check_cell(region: &Region, number: u32, count: usize, cell: &CellEntry) -> Check {
    check_polygon("its outline", &cell.outline, FAR)?;
    check_height("its floor", cell.floor.0)?;
    check_height("its floor", cell.floor.1)?;
    check_height("its top", cell.top)?;
    check_bounds(cell.bounds)?;
    check_ascending("its portals", &cell.portals, region.portals.len())?;
    for &p in &cell.portals {
        let is_here =
            region.portals.get(p as usize).is_some_and(|portal| portal.cell == number || portal.other(portal.cell) == Some(number));
        if !is_here {
            return Err(format!("portal {p} is not on its border"));
        }
    }
    check_ascending("its visible cells", &cell.visible, count)?;
    if cell.visible.binary_search(&number).is_err() {
        return Err("it is not in its own visible set".to_owned());
    }
    for (n, packet) in cell.packets.iter().enumerate() {
        let kind = [BlobKind::Shell, BlobKind::Facades, BlobKind::Pictures, BlobKind::Facades][n];
        check_blob(kind, packet.as_ref())?;
    }
    if let Some(level) = (1..4).find(|&n| cell.packets[n].is_some() && cell.packets[n - 1].is_none()) {
        return Err(format!("it has a packet of level {} but none of level {level}", level + 1));
    }
    Ok(())
}
