//! What belongs to each cell: walls, roofs, objects, heights of the ground.

use rayon::prelude::*;
use veduta_city::{Cells, CityPlan, Finding, GridPolygon, GridPos, House, Marking, Severity, Volume, WallKind};

use crate::free::beside;
use crate::locate::Locator;
use crate::overlay::{edges, ring_area_2};
use crate::patches::Patches;

/// Shares of the way along a wall at which its cell is sought.
const ALONG: [f64; 5] = [0.5, 0.25, 0.75, 0.1, 0.9];
/// Distances in front of a wall at which its cell is sought, metres.
const BEFORE_M: [f64; 4] = [0.05, 0.2, 0.4, 0.6];

/// Gives every wall, roof and object to a cell. There must be cells.
pub(crate) fn assign(plan: &CityPlan, cells: &mut Cells, findings: &mut Vec<Finding>) {
    let locator = Locator::new(&cells.cells);
    let homes: Vec<Option<Home>> = plan.houses.par_iter().map(|house| home(house, &locator)).collect();
    let objects: Vec<Option<u32>> = plan.objects.iter().map(|object| locator.find_or_nearest(object.pos)).collect();
    let middle = |marking: &Marking| {
        let (first, last) = (marking.line.first()?, marking.line.last()?);
        Some(GridPos::from_metres((first.to_metres() + last.to_metres()) / 2.0))
    };
    let markings: Vec<Option<u32>> = plan.markings.iter().map(|m| locator.find_or_nearest(middle(m)?)).collect();
    let spans: Vec<Option<u32>> = plan.spans.iter().map(|span| locator.find_or_nearest(span.middle()?)).collect();
    for (h, (house, home)) in (0..).zip(plan.houses.iter().zip(homes)) {
        let Some(home) = home else {
            let message = "a house without a footprint, or with more than 65,535 volumes or walls, has no cell";
            findings.push(Finding::new(Severity::Dropped, house.id, None, message));
            continue;
        };
        cells.cells[home.roof as usize].houses.push(h);
        for (volume, wall, cell) in home.walls {
            cells.cells[cell as usize].walls.push((h, volume, wall));
        }
    }
    for (o, cell) in (0..).zip(objects) {
        if let Some(cell) = cell {
            cells.cells[cell as usize].objects.push(o);
        }
    }
    for (m, cell) in (0..).zip(markings) {
        if let Some(cell) = cell {
            cells.cells[cell as usize].markings.push(m);
        }
    }
    for (b, cell) in (0..).zip(spans) {
        if let Some(cell) = cell {
            cells.cells[cell as usize].spans.push(b);
        }
    }
}

/// Pieces of free space smaller than this are leavings of the grid, square metres.
const LEAVINGS_M2: f64 = 0.01;

/// Gives every space outside of the cells to the cell nearest to it.
pub(crate) fn yards(spaces: Vec<GridPolygon>, cells: &mut Cells) {
    let locator = Locator::new(&cells.cells);
    let nearest = |space: &GridPolygon| {
        let near = space.outer.iter().filter_map(|&p| locator.nearest(p));
        near.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).map(|(cell, _)| cell)
    };
    let spaces: Vec<GridPolygon> = spaces.into_iter().filter(|space| space.area_m2() > LEAVINGS_M2).collect();
    let homes: Vec<Option<u32>> = spaces.par_iter().map(nearest).collect();
    for (space, home) in spaces.into_iter().zip(homes) {
        if let Some(cell) = home {
            cells.cells[cell as usize].yards.push(space);
        }
    }
}

/// Where a house belongs.
struct Home {
    /// Cell of its roof.
    roof: u32,
    /// Volume, wall, cell.
    walls: Vec<(u16, u16, u32)>,
}

/// The cell of each wall: the one in front of it or, where there is none (a party wall, an enclosed yard), that of the house's
/// first façade. `None` if the house has no vertex or too many parts to be numbered.
fn home(house: &House, locator: &Locator<'_>) -> Option<Home> {
    let mut facing: Vec<(u16, u16, Option<u32>, WallKind)> = Vec::new();
    for (v, volume) in house.volumes.iter().enumerate() {
        let v = u16::try_from(v).ok()?;
        let segments = segments(volume);
        for (w, wall) in volume.walls.iter().enumerate() {
            let cell = segments.get(w).and_then(|&(a, b)| cell_before(a, b, locator));
            facing.push((v, u16::try_from(w).ok()?, cell, wall.kind));
        }
    }
    let first_facade = facing.iter().find(|(_, _, cell, kind)| cell.is_some() && *kind == WallKind::Street);
    let first = first_facade.or_else(|| facing.iter().find(|(_, _, cell, _)| cell.is_some())).and_then(|f| f.2);
    let roof = first.or_else(|| nearest(house, locator))?;
    Some(Home { roof, walls: facing.into_iter().map(|(v, w, cell, _)| (v, w, cell.unwrap_or(roof))).collect() })
}

/// The cell that lies in front of a wall, solid on its left.
fn cell_before(a: GridPos, b: GridPos, locator: &Locator<'_>) -> Option<u32> {
    if a == b {
        return None;
    }
    ALONG.iter().find_map(|&share| BEFORE_M.iter().find_map(|&distance_m| locator.find(beside(a, b, share, distance_m))))
}

/// The edges of a volume in the order of its walls, each with the solid on its left however the ring was turned.
pub(crate) fn segments(volume: &Volume) -> Vec<(GridPos, GridPos)> {
    let mut segments = Vec::new();
    for (i, ring) in volume.footprint.rings().enumerate() {
        let is_turned = (ring_area_2(ring) > 0) == (i == 0);
        segments.extend(edges(ring).map(|(a, b)| if is_turned { (a, b) } else { (b, a) }));
    }
    segments
}

/// The cell nearest to any vertex of a house.
fn nearest(house: &House, locator: &Locator<'_>) -> Option<u32> {
    let vertices = house.volumes.iter().flat_map(|volume| &volume.footprint.outer);
    let nearest = vertices.filter_map(|&p| locator.nearest(p)).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    nearest.map(|(cell, _)| cell)
}

/// Fills in the lowest and highest ground of each cell; 0 where there is no ground.
pub(crate) fn floors(patches: &Patches<'_>, cells: &mut Cells) {
    cells.cells.par_iter_mut().for_each(|cell| cell.floor = patches.heights(&cell.outline).unwrap_or_default());
}
