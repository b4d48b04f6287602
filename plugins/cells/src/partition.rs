use veduta_city::{Cell, CellOverride, Cells, CityPlan, Finding, Id, Severity};

use crate::edit::{self, Edited};
use crate::visible::{self, Seen};
use crate::{assign, free, merge, name, outline, over, patches::Patches, reach, skyline, triangulate, tunnels};

/// How free space is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct PartitionSettings {
    /// Greatest area of a cell, square metres; half as much again where a small rest has to go somewhere.
    pub max_area_m2: f64,
    /// Greatest distance between two points of a cell, metres; half as much again for small rests, and beyond where a single wall
    /// is longer.
    pub max_diameter_m: f64,
    /// Greatest area of a cell without any public ground (gardens, fields, water), square metres.
    pub open_area_m2: f64,
    /// Greatest distance between two points of such a cell, metres.
    pub open_diameter_m: f64,
    /// Cells smaller than this join a neighbour, square metres.
    pub min_area_m2: f64,
    /// Least share of a cell in its convex hull, 0 to 1.
    pub min_convexity: f64,
    /// Least public ground of a piece of free space that is kept, square metres: enclosed courtyards have none.
    pub min_public_m2: f64,
    /// Least width of a gap that joins two pieces of free space, metres. One looks through narrower ones but does not walk there.
    pub min_passage_m: f64,
    /// Clear height above the ground under which a volume is an obstacle; above it hangs over a passage. Metres.
    pub clearance_m: f64,
    /// How many sets of lines are told apart at one portal from one other. More: tighter visible sets, more work.
    pub line_sets: usize,
    /// How far visible sets reach: of what is farther the skyline tells, and [`Cells::far`]. Metres.
    pub sight_m: f64,
    /// How far one sees at all, metres; no farther than `sight_m` if that is more.
    pub far_m: f64,
    /// How many steps from portal to portal the lines through one portal are followed with care. Where there are more (gardens with
    /// houses strewn over them, where one sees a little of everything), only the lines' directions are told apart: visible sets
    /// may then hold more than can be seen, and lack nothing.
    pub sight_steps: usize,
}

impl Default for PartitionSettings {
    fn default() -> Self {
        Self {
            max_area_m2: 2_500.0,
            max_diameter_m: 70.0,
            open_area_m2: 10_000.0,
            open_diameter_m: 150.0,
            min_area_m2: 80.0,
            min_convexity: 0.6,
            min_public_m2: 200.0,
            min_passage_m: 0.6,
            clearance_m: 2.2,
            line_sets: 6,
            sight_m: 600.0,
            far_m: 6_000.0,
            sight_steps: 3_000,
        }
    }
}

/// What [`partition`] makes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Partition {
    /// The cells, with visible sets and skyline.
    pub cells: Cells,
    /// What was repaired or left out, and why.
    pub findings: Vec<Finding>,
}

/// Cuts a plan's free space into cells, makes a person's edits to them (see [`veduta_city::CellsOverrides`]), and says what belongs to each and
/// what is seen from it. The same plan, edits and settings give the same cells for any number of threads. Bad input leaves findings, and so does
/// an edit that cannot be made; if no free space is left there are no cells.
#[must_use]
pub fn partition(plan: &CityPlan, edits: &[CellOverride], settings: &PartitionSettings) -> Partition {
    let mut findings = Vec::new();
    let mut cells = cut(plan, edits, settings, &mut findings);
    if !cells.cells.is_empty() {
        let (seen, notes) = visible::visible_sets(plan, &cells, settings);
        findings.extend(notes);
        see(plan, &mut cells, seen, settings);
    }
    Partition { cells, findings }
}

/// The cells, with all that belongs to them, and nothing of what is seen.
pub(crate) fn cut(plan: &CityPlan, edits: &[CellOverride], settings: &PartitionSettings, findings: &mut Vec<Finding>) -> Cells {
    let patches = Patches::new(plan);
    let shapes = free::free_space(plan, &patches, settings, findings);
    let mesh = triangulate::triangulate(shapes, settings, findings);
    let (reached, rest) = reach::reachable(&mesh, plan, &patches, settings, findings);
    drop(mesh);
    let label = merge::merge(&reached, &patches, settings);
    let Edited { triangles, label, names } = edit::edited(edits, (reached, label), &plan.extent, findings);
    let (outlines, portals) = outline::outlines(&triangles, &label, &plan.extent);
    drop((triangles, label));
    let mut cells = Cells { portals, ..Cells::default() };
    cells.cells = outlines.into_iter().map(|outline| Cell { outline, ..Cell::default() }).collect();
    if cells.cells.is_empty() {
        findings.push(Finding::new(Severity::Dropped, Id::NONE, None, "no free space is left to walk in: the city has no cells"));
        return cells;
    }
    link_portals(&mut cells);
    give_ids(&mut cells);
    name::name_cells(plan, &mut cells);
    let given = cells.cells.iter_mut().zip(names).filter_map(|(cell, name)| Some((cell, name?)));
    given.for_each(|(cell, name)| cell.name = name);
    assign::assign(plan, &mut cells, findings);
    assign::yards(reach::spaces(&rest, &plan.extent), &mut cells);
    drop(rest);
    assign::floors(&patches, &mut cells);
    cells
}

/// Gives cells what is seen from them, through their portals and otherwise.
pub(crate) fn see(plan: &CityPlan, cells: &mut Cells, seen: Seen, settings: &PartitionSettings) {
    (cells.visible, cells.far) = (seen.sets, seen.far);
    tunnels::see_through(plan, cells);
    over::see_over(plan, cells, settings);
    cells.skyline = skyline::skyline(plan, cells);
}

fn link_portals(cells: &mut Cells) {
    for (i, portal) in (0..).zip(&cells.portals) {
        let sides = [Some(portal.cell), portal.other(portal.cell)];
        for cell in sides.into_iter().flatten() {
            cells.cells[cell as usize].portals.push(i);
        }
    }
}

/// Ids from the places of the cells' centroids, moving on where two share one.
fn give_ids(cells: &mut Cells) {
    let mut taken = std::collections::HashSet::new();
    for cell in &mut cells.cells {
        let mut id = Id::from_place("cell", cell.outline.centroid());
        while !taken.insert(id) {
            id.0 = id.0.wrapping_add(1) | 1 << 63;
        }
        cell.id = id;
    }
}
