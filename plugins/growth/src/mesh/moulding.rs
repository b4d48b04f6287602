use glam::DVec2;
use veduta_city::{Articulation, CellShell, FacadeSheet, Opening, Tile, VolumeShell, Wall, WallKind};

use super::arcade;
use super::data::{MeshData, MeshError, Paint};
use super::footing::stands;
use super::ornament;
use super::outline::{Edge, engine, neighbours, wall_edge};
use super::painted;
use super::roof_detail::{OVERHANG_DROP_M, mitre};
use super::wall::{Front, check, runs, seen};

/// Section of a moulding from its lower edge on the wall to its upper one: metres out of the wall, metres up; convex.
pub(super) type Section = [(f64, f64)];

/// Crown cornice below the eaves of a tall wall.
const CROWN: &Section = &[(0.0, -0.44), (0.14, -0.34), (0.26, -0.19), (0.28, -OVERHANG_DROP_M), (0.0, -OVERHANG_DROP_M)];
/// Crown cornice below the eaves of a low one.
const LOW_CROWN: &Section = &[(0.0, -0.24), (0.13, -0.16), (0.15, -OVERHANG_DROP_M), (0.0, -OVERHANG_DROP_M)];
const STRING: &Section = &[(0.0, -0.02), (0.1, 0.02), (0.1, 0.15), (0.0, 0.18)];
const PLINTH: &Section = &[(0.03, 0.0), (0.03, 0.6), (0.0, 0.62)];

/// Walls from here on are tall, and none lower than the second figure has a cornice; metres.
const TALL_M: f64 = 7.0;
const CORNICE_FROM_M: f64 = 3.0;

/// Cornices, string courses, plinths and ornaments of the street walls: part of level 2. Centres are those of the walls.
///
/// # Errors
/// [`MeshError::SheetLength`] if the sheet is not of this shell.
pub fn mouldings(shell: &CellShell, sheet: &FacadeSheet) -> Result<MeshData, MeshError> {
    check(shell, sheet)?;
    let mut mesh = MeshData::default();
    add_mouldings(shell, sheet, &mut mesh);
    Ok(mesh)
}

/// What a volume's mouldings are drawn with, but for the place.
struct Paints {
    trim: Paint,
    plinth: Paint,
}

/// Adds the mouldings of walls that a sheet of the right length tells.
pub(super) fn add_mouldings(shell: &CellShell, sheet: &FacadeSheet, mesh: &mut MeshData) {
    mesh.reserve_quads(sheet.walls.iter().filter(|wall| wall.kind == WallKind::Street).count() * 40);
    for (house, volume, plans, number) in seen(shell, sheet) {
        let first = mesh.positions.len();
        arcade::fine(volume, mesh);
        let stands = stands(house, volume);
        let trim = Paint::new([0.0; 2], volume.trim, Tile::Stone);
        let plinth = Paint::new([0.0; 2], volume.colour.scaled(0.75), Tile::Stone);
        let walls = (number..).zip(volume.walls.iter().zip(plans));
        for (n, (&wall, plan)) in walls.filter(|(_, (_, plan))| plan.kind == WallKind::Street) {
            let Some(front) = Front::new(volume, wall, trim) else { continue };
            let centre = front.plaster.centre;
            let paints = Paints { trim: trim.at(centre), plinth: plinth.at(centre) };
            let ends = ends(volume, plans, wall, &front.edge);
            if volume.roof.is_there() {
                crown(&front, ends, paints.trim, mesh);
            }
            // What else stands out of a painted wall is in its picture.
            if painted::find(sheet, n).is_some() {
                continue;
            }
            dress(&front, plan, ends, stands, &paints, mesh);
            if let Some(ornament) = &plan.ornament {
                ornament::adorn(&front, plan, ornament, quoin_ends(volume, plans, wall, ends), (volume, stands), mesh);
            }
        }
        mesh.stand(first, house.floor);
    }
}

/// How a moulding ends at a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// Cut square, with a face.
    Square,
    /// Drawn to where it meets the next wall's, per metre of reach.
    Mitre(DVec2),
}

/// The moulding runs round a corner if the next wall is a street front, or is drawn by another cell and stands at a convex
/// corner, where it will be one most likely.
fn ends(volume: &VolumeShell, plans: &[Wall], wall: u16, edge: &Edge) -> [End; 2] {
    let Some((before, after)) = neighbours(&volume.footprint, wall.into()) else { return [End::Square; 2] };
    let end = |other: usize, is_before: bool| {
        let Some(next) = wall_edge(&volume.footprint, other) else { return End::Square };
        let (first, second) = if is_before { (&next, edge) } else { (edge, &next) };
        let listed = volume.walls.iter().position(|&w| usize::from(w) == other).and_then(|i| plans.get(i));
        let runs_on = match listed {
            Some(plan) => plan.kind == WallKind::Street,
            None => first.along.perp_dot(second.along) > 0.1,
        };
        if runs_on { mitre(first, second).map_or(End::Square, End::Mitre) } else { End::Square }
    };
    [end(before, true), end(after, false)]
}

/// Quoins meet round a corner only where the next wall has some, too.
fn quoin_ends(volume: &VolumeShell, plans: &[Wall], wall: u16, ends: [End; 2]) -> [End; 2] {
    let Some((before, after)) = neighbours(&volume.footprint, wall.into()) else { return [End::Square; 2] };
    let has_quoins = |other: usize| {
        let listed = volume.walls.iter().position(|&w| usize::from(w) == other).and_then(|i| plans.get(i));
        listed.and_then(|plan| plan.ornament.as_deref()).is_some_and(|ornament| ornament.articulation == Articulation::Quoins)
    };
    let end = |own: End, other: usize| if has_quoins(other) { own } else { End::Square };
    [end(ends[0], before), end(ends[1], after)]
}

/// The cornice below the eaves.
fn crown(front: &Front, ends: [End; 2], trim: Paint, mesh: &mut MeshData) {
    let height = front.eaves - front.bottom;
    if height >= CORNICE_FROM_M && front.edge.length > 1.0 {
        sweep(&front.edge, ends, if height >= TALL_M { CROWN } else { LOW_CROWN }, front.eaves, trim, mesh);
    }
}

fn dress(front: &Front, plan: &Wall, ends: [End; 2], stands: bool, paints: &Paints, mesh: &mut MeshData) {
    let height = front.eaves - front.bottom;
    let trim = paints.trim;
    if !stands && front.edge.length > 1.0 {
        // Over an arcade or a passage.
        sweep(&front.edge, ends, STRING, front.bottom, trim, mesh);
    } else if let [first, second, ..] = plan.storeys[..] {
        let total: f64 = plan.storeys.iter().map(|s| f64::from(s.height.max(0))).sum();
        if first.height > 0 && second.height > 0 && front.edge.length > 1.0 {
            let floor = front.bottom + height * f64::from(first.height) / total;
            sweep(&front.edge, ends, STRING, floor, trim, mesh);
        }
    }
    if stands && height > 1.5 {
        plinth(front, plan, ends, paints.plinth, mesh);
    }
}

/// The plinth, left out where something is open down to the ground.
fn plinth(front: &Front, plan: &Wall, ends: [End; 2], paint: Paint, mesh: &mut MeshData) {
    let bays = plan.bays.max(1);
    let mut from = Some(0);
    let mut stretch = |from: u8, to: u8| {
        let share = |bay: u8| front.edge.at(f64::from(bay) / f64::from(bays));
        let Some(edge) = Edge::new(share(from), share(to)) else { return };
        let ends = [if from == 0 { ends[0] } else { End::Square }, if to == bays { ends[1] } else { End::Square }];
        sweep(&edge, ends, PLINTH, front.bottom, paint, mesh);
    };
    for (start, end, opening) in runs(plan, 0) {
        if is_open_to_ground(opening) {
            if let Some(from) = from.filter(|&from| from < start) {
                stretch(from, start);
            }
            from = (end < bays).then_some(end);
        }
    }
    if let Some(from) = from {
        stretch(from, bays);
    }
}

pub(super) const fn is_open_to_ground(opening: Opening) -> bool {
    matches!(opening, Opening::Portal | Opening::Door | Opening::Shop | Opening::Arcade | Opening::Gate)
}

/// Draws a section along a wall.
pub(super) fn sweep(edge: &Edge, ends: [End; 2], section: &Section, height: f64, paint: Paint, mesh: &mut MeshData) {
    let way = |end: End| match end {
        End::Square => edge.out,
        End::Mitre(way) => way,
    };
    let (start, end) = (way(ends[0]), way(ends[1]));
    let reach = section.iter().map(|s| s.0).fold(0.0, f64::max);
    if edge.length + (end - start).dot(edge.along) * reach <= 0.0 {
        return;
    }
    let at = |corner: DVec2, way: DVec2, (out, up): (f64, f64)| engine(corner + way * out, height + up);
    for pair in section.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        mesh.polygon(&[at(edge.a, start, low), at(edge.b, end, low), at(edge.b, end, high), at(edge.a, start, high)], paint);
    }
    let cap = |corner: DVec2, way: DVec2| section.iter().map(move |&s| at(corner, way, s));
    let mut outline = Vec::with_capacity(section.len() + 1);
    // A section that begins out of the wall stands on the ground.
    let foot = section.first().filter(|s| s.0 > 0.0).map(|s| (0.0, s.1));
    if ends[0] == End::Square {
        outline.extend(foot.map(|f| at(edge.a, start, f)).into_iter().chain(cap(edge.a, start)));
        mesh.polygon(&outline, paint);
    }
    if ends[1] == End::Square {
        outline.clear();
        outline.extend(foot.map(|f| at(edge.b, end, f)).into_iter().chain(cap(edge.b, end)));
        outline.reverse();
        mesh.polygon(&outline, paint);
    }
}
