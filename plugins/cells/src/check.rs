use std::collections::HashSet;

use veduta_city::{Cell, Cells, CityPlan, GRID_PER_METRE, GridPolygon, GridPos, Id, PLAN_STEP, PortalSide};

use crate::free::free_space;
use crate::overlay::{Keep, combine, edges, ring_area_2, total_m2, turned_rings};
use crate::partition::PartitionSettings;
use crate::patches::Patches;

/// What is wrong with a city's cells, naming the cell by id and the rest by index.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CellsError {
    /// Two cells with one id.
    #[error("two cells have the id {id}")]
    DuplicateId {
        /// Which id.
        id: Id,
    },
    /// A ring that is too short or runs the wrong way round.
    #[error(
        "cell {cell}: ring {ring} of the outline has {n} vertices or runs the wrong way (outer counter-clockwise, holes clockwise)"
    )]
    Ring {
        /// Which cell.
        cell: Id,
        /// Which ring: 0 is the outer one.
        ring: usize,
        /// Its number of vertices.
        n: usize,
    },
    /// Cells that lie over each other.
    #[error("the cells overlap on {m2:.3} m²")]
    Overlap {
        /// How much, square metres.
        m2: f64,
    },
    /// Cells that reach into houses or beyond the extent.
    #[error("the cells reach into houses or beyond the extent on {m2:.3} m²")]
    NotFree {
        /// How much, square metres.
        m2: f64,
    },
    /// Something refers to a thing that is not there.
    #[error("cell {cell} refers to {what} {index}, which is not there")]
    Unknown {
        /// Which cell.
        cell: Id,
        /// Kind of thing.
        what: &'static str,
        /// Which one.
        index: usize,
    },
    /// A list that must ascend does not.
    #[error("the {what} of cell {cell} do not ascend")]
    Unsorted {
        /// Which cell.
        cell: Id,
        /// Which list.
        what: &'static str,
    },
    /// A portal that does not lie on the outline of a cell it belongs to.
    #[error("portal {portal} does not lie on the outline of cell {cell}")]
    PortalOffOutline {
        /// Index of the portal.
        portal: usize,
        /// The cell.
        cell: Id,
    },
    /// A portal that one of its cells does not list, or that a stranger lists.
    #[error("portal {portal} and the portals of cell {cell} disagree on whether they belong together")]
    PortalUnlisted {
        /// Index of the portal.
        portal: usize,
        /// The cell.
        cell: Id,
    },
    /// Something that must belong to exactly one cell.
    #[error("{what} {index} belongs to {cells} cells instead of one")]
    NotOnce {
        /// Kind of thing.
        what: &'static str,
        /// Which one: of the plan; walls as `house/volume/wall`.
        index: String,
        /// How many cells have it.
        cells: usize,
    },
    /// There is not one list of what is seen a cell.
    #[error("there are {sets} lists of {what} for {cells} cells")]
    VisibleCount {
        /// Lists of what.
        what: &'static str,
        /// Number of sets.
        sets: usize,
        /// Number of cells.
        cells: usize,
    },
    /// A visible set that lacks the cell itself or a neighbour through a portal.
    #[error("the visible set of cell {cell} lacks cell {lacks}, which is itself or beyond a portal")]
    NotSeen {
        /// Whose set.
        cell: Id,
        /// What it lacks.
        lacks: u32,
    },
}

/// Everything wrong with the cells of a plan, in order: outlines are proper, do not overlap and
/// stay out of houses (with the default clearance), portals lie on the outlines of both their cells,
/// every wall, roof and object belongs to exactly one cell, visible sets hold at least the neighbours, all lists ascend. Empty for
/// what [`crate::partition`] made, unless the plan has no free space (then nothing has a cell).
#[must_use]
pub fn check(plan: &CityPlan, cells: &Cells) -> Vec<CellsError> {
    let mut errors = Vec::new();
    check_outlines(cells, &mut errors);
    check_free(plan, cells, &mut errors);
    check_lists(plan, cells, &mut errors);
    check_portals(cells, &mut errors);
    check_owners(plan, cells, &mut errors);
    check_visible(cells, &mut errors);
    errors
}

fn check_outlines(cells: &Cells, errors: &mut Vec<CellsError>) {
    let mut ids = HashSet::new();
    for cell in &cells.cells {
        if !ids.insert(cell.id) {
            errors.push(CellsError::DuplicateId { id: cell.id });
        }
        for (i, ring) in cell.outline.rings().enumerate() {
            let area = ring_area_2(ring);
            if ring.len() < 3 || area == 0 || (area > 0) != (i == 0) {
                errors.push(CellsError::Ring { cell: cell.id, ring: i, n: ring.len() });
            }
        }
    }
    let sum: f64 = cells.cells.iter().map(|cell| cell.outline.area_m2()).sum();
    let rings = cells.cells.iter().flat_map(|cell| turned_rings(&cell.outline));
    let overlap_m2 = sum - total_m2(&combine(Keep::First, rings, [], false));
    if overlap_m2 > 1e-6 * sum {
        errors.push(CellsError::Overlap { m2: overlap_m2 });
    }
}

/// Mean width up to which a piece is a leaving of the plan's steps, metres.
const SLIVER_M: f64 = PLAN_STEP as f64 / GRID_PER_METRE as f64;

/// Cells may reach under long walls by a step of the plan, where these were cut.
fn check_free(plan: &CityPlan, cells: &Cells, errors: &mut Vec<CellsError>) {
    let free = free_space(plan, &Patches::new(plan), &PartitionSettings::default(), &mut Vec::new());
    let rings = cells.cells.iter().flat_map(|cell| turned_rings(&cell.outline));
    let mut beyond = combine(Keep::FirstAlone, rings, free.iter().flat_map(turned_rings), false);
    beyond.retain(|piece| {
        let perimeter_m: f64 = piece.edges().map(|(a, b)| (b.to_metres() - a.to_metres()).length()).sum();
        2.0 * piece.area_m2() > SLIVER_M * perimeter_m
    });
    if !beyond.is_empty() {
        errors.push(CellsError::NotFree { m2: total_m2(&beyond) });
    }
}

fn check_lists(plan: &CityPlan, cells: &Cells, errors: &mut Vec<CellsError>) {
    for cell in &cells.cells {
        let mut indices = |what, list: &[u32], count: usize| {
            if !list.is_sorted_by(|a, b| a < b) {
                errors.push(CellsError::Unsorted { cell: cell.id, what });
            }
            if let Some(&index) = list.iter().find(|&&i| i as usize >= count) {
                errors.push(CellsError::Unknown { cell: cell.id, what, index: index as usize });
            }
        };
        indices("portals", &cell.portals, cells.portals.len());
        indices("houses", &cell.houses, plan.houses.len());
        indices("objects", &cell.objects, plan.objects.len());
        indices("markings", &cell.markings, plan.markings.len());
        indices("spans of ways", &cell.spans, plan.spans.len());
        if !cell.walls.is_sorted_by(|a, b| a < b) {
            errors.push(CellsError::Unsorted { cell: cell.id, what: "walls" });
        }
    }
    if !cells.far.is_empty() && cells.far.len() != cells.cells.len() {
        errors.push(CellsError::VisibleCount { what: "cells far away", sets: cells.far.len(), cells: cells.cells.len() });
    }
    for (cell, far) in cells.cells.iter().zip(&cells.far) {
        if !far.is_sorted_by(|a, b| a < b) {
            errors.push(CellsError::Unsorted { cell: cell.id, what: "cells far away" });
        }
        if let Some(&index) = far.iter().find(|&&i| i as usize >= cells.cells.len()) {
            errors.push(CellsError::Unknown { cell: cell.id, what: "cell far away", index: index as usize });
        }
    }
    if !cells.skyline.is_sorted_by(|a, b| a < b) {
        errors.push(CellsError::Unsorted { cell: Id::NONE, what: "skyline" });
    }
    if let Some(&index) = cells.skyline.iter().find(|&&i| i as usize >= cells.cells.len()) {
        errors.push(CellsError::Unknown { cell: Id::NONE, what: "skyline cell", index: index as usize });
    }
}

fn check_portals(cells: &Cells, errors: &mut Vec<CellsError>) {
    for (i, portal) in cells.portals.iter().enumerate() {
        let beyond = match portal.beyond {
            PortalSide::Cell(cell) => Some(cell),
            PortalSide::Edge => None,
        };
        for side in [Some(portal.cell), beyond].into_iter().flatten() {
            let Some(cell) = cells.cells.get(side as usize) else {
                errors.push(CellsError::Unknown { cell: Id::NONE, what: "cell of a portal", index: side as usize });
                continue;
            };
            let (a, b) = if side == portal.cell { portal.ends } else { (portal.ends.1, portal.ends.0) };
            if !runs_along(&cell.outline, a, b) {
                errors.push(CellsError::PortalOffOutline { portal: i, cell: cell.id });
            }
            if !cell.portals.contains(&(i as u32)) {
                errors.push(CellsError::PortalUnlisted { portal: i, cell: cell.id });
            }
        }
    }
    for (i, cell) in (0..).zip(&cells.cells) {
        for &p in &cell.portals {
            if let Some(portal) = cells.portals.get(p as usize)
                && portal.cell != i
                && portal.beyond != PortalSide::Cell(i)
            {
                errors.push(CellsError::PortalUnlisted { portal: p as usize, cell: cell.id });
            }
        }
    }
}

/// Whether a directed segment lies on one directed edge of a polygon.
fn runs_along(polygon: &GridPolygon, a: GridPos, b: GridPos) -> bool {
    let within = |v: i32, p: i32, q: i32| p.min(q) <= v && v <= p.max(q);
    let on = |v: GridPos, p: GridPos, q: GridPos| p.cross(q, v) == 0 && within(v.0, p.0, q.0) && within(v.1, p.1, q.1);
    let same_way = |p: GridPos, q: GridPos| {
        let product = |a: i32, b: i32, p: i32, q: i32| (i64::from(b) - i64::from(a)) * (i64::from(q) - i64::from(p));
        product(a.0, b.0, p.0, q.0) + product(a.1, b.1, p.1, q.1) > 0
    };
    polygon.rings().any(|ring| edges(ring).any(|(p, q)| on(a, p, q) && on(b, p, q) && same_way(p, q)))
}

fn check_owners(plan: &CityPlan, cells: &Cells, errors: &mut Vec<CellsError>) {
    let count = |n: usize, of: fn(&Cell) -> &[u32]| {
        let mut owners = vec![0_usize; n];
        for &i in cells.cells.iter().flat_map(of) {
            if let Some(owners) = owners.get_mut(i as usize) {
                *owners += 1;
            }
        }
        owners
    };
    let houses = count(plan.houses.len(), |cell| &cell.houses);
    let objects = count(plan.objects.len(), |cell| &cell.objects);
    let markings = count(plan.markings.len(), |cell| &cell.markings);
    let spans = count(plan.spans.len(), |cell| &cell.spans);
    for (what, owners) in [("roof of house", houses), ("object", objects), ("marking", markings), ("span of a way", spans)] {
        let not_once = owners.into_iter().enumerate().filter(|&(_, n)| n != 1);
        errors.extend(not_once.map(|(i, cells)| CellsError::NotOnce { what, index: i.to_string(), cells }));
    }
    let mut walls: Vec<Vec<Vec<usize>>> =
        plan.houses.iter().map(|house| house.volumes.iter().map(|volume| vec![0; volume.walls.len()]).collect()).collect();
    for cell in &cells.cells {
        for &(h, v, w) in &cell.walls {
            let owners = walls.get_mut(h as usize).and_then(|house| house.get_mut(usize::from(v))?.get_mut(usize::from(w)));
            match owners {
                Some(owners) => *owners += 1,
                None => errors.push(CellsError::Unknown { cell: cell.id, what: "a wall of house", index: h as usize }),
            }
        }
    }
    for (h, house) in walls.iter().enumerate() {
        for (v, volume) in house.iter().enumerate() {
            for (w, &cells) in volume.iter().enumerate().filter(|&(_, &cells)| cells != 1) {
                errors.push(CellsError::NotOnce { what: "wall", index: format!("{h}/{v}/{w}"), cells });
            }
        }
    }
}

fn check_visible(cells: &Cells, errors: &mut Vec<CellsError>) {
    if cells.visible.len() != cells.cells.len() {
        errors.push(CellsError::VisibleCount { what: "visible cells", sets: cells.visible.len(), cells: cells.cells.len() });
    }
    for (i, (cell, seen)) in (0..).zip(cells.cells.iter().zip(&cells.visible)) {
        if !seen.is_sorted_by(|a, b| a < b) {
            errors.push(CellsError::Unsorted { cell: cell.id, what: "visible cells" });
        }
        if let Some(&index) = seen.iter().find(|&&s| s as usize >= cells.cells.len()) {
            errors.push(CellsError::Unknown { cell: cell.id, what: "visible cell", index: index as usize });
        }
        let neighbours = cell.portals.iter().filter_map(|&p| cells.portals.get(p as usize)?.other(i));
        for lacks in core::iter::once(i).chain(neighbours).filter(|n| seen.binary_search(n).is_err()) {
            errors.push(CellsError::NotSeen { cell: cell.id, lacks });
        }
    }
}
