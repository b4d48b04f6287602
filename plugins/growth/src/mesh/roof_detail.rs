//! What sits on a roof and at its edge.

use glam::{DVec2, DVec3};
use veduta_city::draw::Draw;
use veduta_city::{CellShell, Opening, Rgb, RoofShape, Tile};

use super::data::{MeshData, Paint};
use super::form::{Form, RoofForm, level_neighbours};
use super::hip::inset;
use super::outline::{Edge, area, draw_at, engine, wall_count, wall_edge};
use super::roof::{Roofer, covering};
use super::shape::Block;

/// How far eaves reach over the wall, and how far they drop on the way; metres. They rest on the crown cornice.
pub(super) const OVERHANG_M: f64 = 0.32;
pub(super) const OVERHANG_DROP_M: f64 = 0.06;

const PARAPET_M: f64 = 0.4;
const PARAPET_WIDTH_M: f64 = 0.25;
/// Least area of a flat roof with a parapet, square metres.
const PARAPET_FROM_M2: f64 = 25.0;

/// Adds the overhang or parapet, chimneys and dormers of a covered volume.
pub(super) fn details(draw: Draw, form: &RoofForm<'_>, roofer: &mut Roofer, mesh: &mut MeshData) {
    let size = area(&roofer.rings[0]);
    match form.form {
        Form::Flat => {
            if size >= PARAPET_FROM_M2 && form.eaves - veduta_city::metres(form.volume.bottom) > 2.5 {
                parapet(form, roofer, mesh);
            }
            return;
        }
        Form::Lathe if matches!(form.volume.roof.shape, RoofShape::Dome | RoofShape::Onion) => return,
        _ => {}
    }
    let reach = OVERHANG_M.min(0.06 * size.sqrt());
    let top = covering(form.volume);
    let under = Paint::new(top.centre, form.volume.trim, Tile::Plaster);
    for wall in 0..wall_count(&form.volume.footprint) {
        overhang(form, wall, reach, [top, under], &mut roofer.along, mesh);
    }
    if has_attic(form, size) {
        chimneys(draw, form, roofer, mesh);
        if draw.chance("dormers", 0.55) {
            dormers(form, roofer, mesh);
        }
    }
}

/// Whether people live under a roof over so many square metres: it has chimneys and may have dormers.
fn has_attic(form: &RoofForm<'_>, size: f64) -> bool {
    let is_steep = matches!(form.form, Form::Ridge(_) | Form::Planes(..) | Form::Hip) && form.height > 2.0;
    is_steep && (40.0..1500.0).contains(&size) && form.volume.roof.shape != RoofShape::Skillion
}

/// Tops of chimneys, one for each house that is picked by a draw of its own, in the mesh's axes.
#[must_use]
pub fn chimney_tops(shell: &CellShell, is_picked: impl Fn(Draw) -> bool) -> Vec<[f32; 3]> {
    let (mut roofer, mut scratch, mut tops) = (Roofer::default(), MeshData::default(), Vec::new());
    for house in shell.houses.iter().filter(|house| !house.is_monument) {
        let top = house.volumes.iter().filter(|volume| volume.has_roof).find_map(|volume| {
            let corner = volume.footprint.outer.first().copied()?;
            if !is_picked(draw_at(shell, corner, "hearth")) {
                return None;
            }
            let form = roofer.start(volume)?;
            let size = area(&roofer.rings[0]);
            if !has_attic(&form, size) {
                return None;
            }
            roofer.cover(&form, &mut scratch);
            stacks(draw_at(shell, corner, "roof"), &form, &roofer).next().map(|stack| engine(stack.block.middle, stack.top + CAP_M))
        });
        tops.extend(top.map(|top| top.as_vec3().to_array()));
    }
    tops
}

/// Where the outer line of a moulding of a given reach passes a corner between two edges, per metre of reach; `None` where
/// the corner is too sharp.
pub(super) fn mitre(before: &Edge, after: &Edge) -> Option<DVec2> {
    let opening = 1.0 + before.out.dot(after.out);
    (opening > 0.5).then(|| (before.out + after.out) / opening)
}

fn overhang(
    form: &RoofForm<'_>,
    wall: usize,
    reach: f64,
    [top, under]: [Paint; 2],
    scratch: &mut Vec<(f64, f64)>,
    mesh: &mut MeshData,
) {
    if !form.is_level_along(wall, scratch) {
        return;
    }
    let Some(edge) = wall_edge(&form.volume.footprint, wall) else { return };
    let (before, after) = level_neighbours(form, wall, scratch);
    let (start, end) = (before.and_then(|b| mitre(&b, &edge)), after.and_then(|n| mitre(&edge, &n)));
    let (from, to) = (edge.a + start.unwrap_or(edge.out) * reach, edge.b + end.unwrap_or(edge.out) * reach);
    if (to - from).dot(edge.along) <= 0.0 {
        return;
    }
    let low = form.eaves - OVERHANG_DROP_M;
    let [lip_a, lip_b, b, a] = [engine(from, low), engine(to, low), engine(edge.b, form.eaves), engine(edge.a, form.eaves)];
    let (under_a, under_b) = (engine(edge.a, low), engine(edge.b, low));
    mesh.polygon(&[lip_a, lip_b, b, a], top);
    mesh.polygon(&[under_a, under_b, lip_b, lip_a], under);
    if start.is_none() {
        mesh.polygon(&[a, under_a, lip_a], under);
    }
    if end.is_none() {
        mesh.polygon(&[b, lip_b, under_b], under);
    }
}

fn parapet(form: &RoofForm<'_>, roofer: &mut Roofer, mesh: &mut MeshData) {
    let Some(inner) = inset(&roofer.rings, PARAPET_WIDTH_M, &mut roofer.skeletons) else { return };
    let centre = covering(form.volume).centre;
    let wall = Paint::new(centre, form.volume.colour, Tile::Plaster);
    let coping = Paint::new(centre, form.volume.trim, Tile::Stone);
    let (low, high) = (form.eaves, form.eaves + PARAPET_M);
    for (outside, inside) in roofer.rings.iter().zip(&inner) {
        for i in 0..outside.len() {
            let j = (i + 1) % outside.len();
            let (a, b, c, d) = (outside[i], outside[j], inside[j], inside[i]);
            mesh.polygon(&[engine(a, low), engine(b, low), engine(b, high), engine(a, high)], wall);
            mesh.polygon(&[engine(a, high), engine(b, high), engine(c, high), engine(d, high)], coping);
            mesh.polygon(&[engine(c, low), engine(d, low), engine(d, high), engine(c, high)], wall);
        }
    }
}

/// Height of the roof over a plan position, metres above the eaves.
fn rise(form: &RoofForm<'_>, roofer: &Roofer, p: DVec2) -> Option<f64> {
    roofer.pieces.at(p).map(|t| form.bend(t) * form.height)
}

const BRICK: Rgb = Rgb(0x8E, 0x62, 0x50);

/// A chimney: its shaft from the roof up to its cap.
struct Stack {
    block: Block,
    foot: f64,
    top: f64,
}

/// Height of a chimney's cap.
const CAP_M: f64 = 0.14;

/// Chimneys near the ends of the ridge, where party walls are.
fn stacks(draw: Draw, form: &RoofForm<'_>, roofer: &Roofer) -> impl Iterator<Item = Stack> {
    let along = match form.form {
        Form::Ridge(ridge) => ridge.along,
        _ => longest(form).map_or(DVec2::Y, |edge| edge.along),
    };
    let across = DVec2::new(along.y, -along.x);
    let ring = &roofer.rings[0];
    let span = |d: DVec2| ring.iter().map(|p| p.dot(d)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let ((s0, s1), (d0, d1)) = (span(along), span(across));
    (0..3).filter_map(move |k| {
        let part = draw.part(k);
        if k == 2 && (s1 - s0 < 12.0 || !part.chance("third chimney", 0.5)) {
            return None;
        }
        let inset = part.between("chimney inset", 0.7, 1.1);
        let s = [s0 + inset, s1 - inset, (s0 + s1) / 2.0 + part.between("chimney middle", -1.5, 1.5)][k as usize];
        let side = if part.chance("chimney side", 0.5) { 1.0 } else { -1.0 };
        let d = (d0 + d1) / 2.0 + side * part.between("chimney off", 0.1, 0.3) * (d1 - d0);
        let (width, depth) = (0.55, part.between("chimney depth", 0.7, 1.2));
        let middle = along * s + across * d;
        let block = Block { middle, along, half: DVec2::new(width / 2.0, depth / 2.0) };
        let corners = block.corners();
        let mut rises = corners.iter().map(|&p| rise(form, roofer, p));
        let lowest = rises.try_fold(f64::INFINITY, |low, r| r.map(|r| low.min(r)))?;
        let top = form.eaves + (form.height + part.between("chimney above", 0.2, 0.7)).min(lowest + 2.4);
        Some(Stack { block, foot: form.eaves + (lowest - 0.3).max(0.0), top })
    })
}

fn chimneys(draw: Draw, form: &RoofForm<'_>, roofer: &Roofer, mesh: &mut MeshData) {
    let is_plastered = draw.chance("plastered chimneys", 0.6);
    let colour = if is_plastered { form.volume.colour.scaled(0.85) } else { BRICK };
    let paint = Paint::new(covering(form.volume).centre, colour, Tile::Plaster);
    for Stack { block, foot, top } in stacks(draw, form, roofer) {
        block.walls(mesh, foot, top, paint);
        let cap = Block { half: block.half + 0.07, ..block };
        cap.walls(mesh, top, top + CAP_M, paint.with_tile(Tile::Stone));
        cap.cap(mesh, top + CAP_M, paint.with_tile(Tile::Stone));
        cap.floor(mesh, top, paint);
    }
}

fn longest(form: &RoofForm<'_>) -> Option<Edge> {
    let edges = (0..form.volume.footprint.outer.len()).filter_map(|i| wall_edge(&form.volume.footprint, i));
    edges.max_by(|a, b| a.length.total_cmp(&b.length))
}

const DORMER_WIDTH_M: f64 = 1.3;
const DORMER_FRONT_M: f64 = 1.25;
/// From the eaves to a dormer's front, along the ground.
const DORMER_BACK_M: f64 = 0.75;
const DORMER_SLOPE: f64 = 0.22;

/// Dormers over the walls of this cell that have level eaves, one every two to three axes.
fn dormers(form: &RoofForm<'_>, roofer: &mut Roofer, mesh: &mut MeshData) {
    if form.profile.len() > 2 {
        return;
    }
    for &wall in &form.volume.walls {
        let Some(edge) = wall_edge(&form.volume.footprint, wall.into()) else { continue };
        if edge.length < 5.5 || !form.is_level_along(wall.into(), &mut roofer.along) {
            continue;
        }
        let count = ((edge.length - 1.0) / 4.6).floor().clamp(1.0, 8.0);
        for k in 0..count as u32 {
            dormer(form, roofer, &edge, (f64::from(k) + 0.5) / count, mesh);
        }
    }
}

fn dormer(form: &RoofForm<'_>, roofer: &Roofer, edge: &Edge, share: f64, mesh: &mut MeshData) -> Option<()> {
    let foot = edge.at(share) - edge.out * DORMER_BACK_M;
    let low = rise(form, roofer, foot)?;
    let slope = low / DORMER_BACK_M;
    if slope < 0.65 {
        return None;
    }
    let front = low + DORMER_FRONT_M;
    let run = DORMER_FRONT_M / (slope - DORMER_SLOPE);
    let back = front + DORMER_SLOPE * run;
    let half = edge.along * (DORMER_WIDTH_M / 2.0);
    // The back edge, and a step around the front, must lie on the same slope below the ridge.
    for side in [-1.0, 1.0] {
        let behind = rise(form, roofer, foot - edge.out * run + half * side)?;
        let before = rise(form, roofer, foot + half * side * 1.4)?;
        if (behind - back).abs() > 0.08 || (before - low).abs() > 0.08 || back > 0.93 * form.height {
            return None;
        }
    }
    let at = |side: f64, inwards: f64, h: f64| engine(foot + half * side - edge.out * inwards, form.eaves + h);
    let paint = Paint::new(covering(form.volume).centre, form.volume.colour, Tile::Plaster);
    let window = paint.with_tile(Tile::of_opening(Opening::AtticWindow));
    let corners = [at(-1.0, 0.0, low), at(1.0, 0.0, low), at(1.0, 0.0, front), at(-1.0, 0.0, front)];
    let uvs = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)].map(DVec2::from);
    mesh.quad(corners, edge.normal(), uvs, window);
    mesh.polygon(&[at(-1.0, run, back), at(-1.0, 0.0, low), at(-1.0, 0.0, front)], paint);
    mesh.polygon(&[at(1.0, 0.0, low), at(1.0, run, back), at(1.0, 0.0, front)], paint);
    let (lip, drop) = (0.15, 0.15 * DORMER_SLOPE);
    let top = [at(-1.12, -lip, front - drop), at(1.12, -lip, front - drop), at(1.12, run, back), at(-1.12, run, back)];
    mesh.polygon(&top, covering(form.volume));
    let under: [DVec3; 4] = [top[3], top[2], top[1], top[0]];
    mesh.polygon(&under, paint.with_tile(Tile::Wood));
    Some(())
}

#[cfg(test)]
mod tests {
    use veduta_city::{Gable, GridPolygon, GridPos, HouseShell, PlanRoof, VolumeShell};

    use super::*;

    fn house(x: i32, shape: RoofShape, is_monument: bool) -> HouseShell {
        let at = |dx: i32, y: i32| GridPos((x + dx) * 1024, y * 1024);
        let volume = VolumeShell {
            footprint: GridPolygon::simple(vec![at(0, 0), at(14, 0), at(14, 10), at(0, 10)]),
            bottom: 0,
            eaves: 12 * 1024,
            colour: Rgb(200, 180, 150),
            trim: Rgb(220, 200, 170),
            roof: PlanRoof { shape, height: 6 * 1024, direction: 90, colour: Rgb(160, 80, 60) },
            gable: Gable::Plain,
            has_roof: true,
            walls: vec![0, 1, 2, 3],
            arcades: Vec::new(),
        };
        HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument }
    }

    #[test]
    fn smoke_rises_from_the_top_of_a_chimney_that_is_drawn() {
        let houses =
            vec![house(0, RoofShape::Gabled, false), house(20, RoofShape::Hipped, false), house(40, RoofShape::Gabled, true)];
        let flat = house(60, RoofShape::Flat, false);
        let shell = CellShell { houses: houses.into_iter().chain([flat]).collect(), ..CellShell::default() };
        let tops = chimney_tops(&shell, |_| true);
        assert_eq!(tops.len(), 2, "neither monuments nor flat roofs have chimneys: {tops:?}");
        let drawn = super::super::roof::roof_details(&shell);
        for top in tops {
            let [x, y, z] = top;
            let near = drawn.positions.iter().filter(|p| (p[0] - x).abs() < 0.75 && (p[2] - z).abs() < 0.75);
            let highest = near.map(|p| p[1]).fold(f32::NEG_INFINITY, f32::max);
            assert!((highest - y).abs() < 1e-3, "{top:?} lies on a cap, not at {highest}");
        }
        assert!(chimney_tops(&shell, |_| false).is_empty());
    }
}
