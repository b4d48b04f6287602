//! The ground of a cell in as few pieces and vertices as show it.

use std::collections::{BTreeMap, HashMap};

use veduta_city::{GRID_PER_METRE, GridPolygon, GridPos, GridRing, GroundPatch, PLAN_STEP, SurfaceKind};

use crate::free::beside;
use crate::overlay::{Edge, Keep, combine, edges, turned_rings};
use crate::widen::Hidden;

/// What pieces that are one have in common: surface, height and course.
type Kind = (SurfaceKind, i32, Option<u32>);

/// Yards of less mean width are leavings between a street and the houses on it, metres: the street is paved up to the walls.
const NARROW_M: f64 = 0.25;
/// So far beyond a border it is asked what lies there, metres.
const BEYOND_M: f64 = 0.03;

/// Pieces of ground that are apart from each other, those alike as one: yards as wide as suits their outlines, no vertices but where something
/// ends or turns. Along a portal the cell beyond drops the same.
pub(crate) fn merged(pieces: Vec<(&GroundPatch, GridPolygon)>, portals: &[Edge], hidden: &Hidden<'_>) -> Vec<GroundPatch> {
    let mut rings: BTreeMap<Kind, Vec<GridRing>> = BTreeMap::new();
    for (patch, piece) in pieces {
        rings.entry((patch.surface, patch.z, patch.course)).or_default().extend(turned_rings(&piece));
    }
    let one = |rings: Vec<GridRing>| combine(Keep::First, rings, [], true);
    let mut kinds: BTreeMap<Kind, Vec<GridPolygon>> = rings.into_iter().map(|(kind, rings)| (kind, one(rings))).collect();
    for (kind, narrow) in leavings(&mut kinds) {
        let all = kinds.remove(&kind).unwrap_or_default();
        kinds.insert(kind, one(all.iter().chain(&narrow).flat_map(turned_rings).collect()));
    }
    let patches = kinds.into_iter().flat_map(|((surface, z, course), polygons)| {
        polygons.into_iter().map(move |outline| GroundPatch { surface, outline, z, course })
    });
    let mut patches: Vec<GroundPatch> = patches.collect();
    straighten(&mut patches, portals);
    for yard in patches.iter_mut().filter(|patch| patch.surface == SurfaceKind::Yard) {
        yard.outline = hidden.widened(&yard.outline);
    }
    patches
}

/// Takes narrow yards away, and tells what paving they are to be part of.
fn leavings(kinds: &mut BTreeMap<Kind, Vec<GridPolygon>>) -> BTreeMap<Kind, Vec<GridPolygon>> {
    let mut found: BTreeMap<Kind, Vec<GridPolygon>> = BTreeMap::new();
    let yards: Vec<Kind> = kinds.keys().copied().filter(|kind| kind.0 == SurfaceKind::Yard).collect();
    for yard in yards {
        let all = kinds.remove(&yard).unwrap_or_default();
        let (narrow, wide): (Vec<GridPolygon>, Vec<GridPolygon>) = all.into_iter().partition(is_narrow);
        let mut kept = wide;
        for piece in narrow {
            match paving_beside(&piece, kinds) {
                Some(kind) => found.entry(kind).or_default().push(piece),
                None => kept.push(piece),
            }
        }
        if !kept.is_empty() {
            kinds.insert(yard, kept);
        }
    }
    found
}

fn is_narrow(piece: &GridPolygon) -> bool {
    let perimeter_m: f64 = piece.edges().map(|(a, b)| a.to_metres().distance(b.to_metres())).sum();
    2.0 * piece.area_m2().abs() < NARROW_M * perimeter_m
}

/// The paving with which a piece has most of its border in common.
fn paving_beside(piece: &GridPolygon, kinds: &BTreeMap<Kind, Vec<GridPolygon>>) -> Option<Kind> {
    let mut lengths: BTreeMap<Kind, f64> = BTreeMap::new();
    for ring in turned_rings(piece) {
        for (a, b) in edges(&ring) {
            let beyond = beside(a, b, 0.5, BEYOND_M);
            let is_there = |polygons: &Vec<GridPolygon>| polygons.iter().any(|polygon| polygon.contains(beyond));
            if let Some((&kind, _)) = kinds.iter().find(|(kind, polygons)| kind.0.is_public() && is_there(polygons)) {
                *lengths.entry(kind).or_default() += a.to_metres().distance(b.to_metres());
            }
        }
    }
    lengths.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(kind, _)| kind)
}

/// What is known of a vertex.
struct Vertex {
    /// The two between which it stands in every ring that it is part of; `None` where something ends at it.
    between: Option<Edge>,
    /// Numbers of these rings.
    rings: Vec<usize>,
}

/// Drops the vertices at which nothing ends and that lie on the line between those beside them, as far as the steps of plans tell, from all
/// patches at once, so that they stay as close as they were; where a portal ends, those on the very line. Where the ground was cut into tiles
/// and joined again, there are many.
fn straighten(patches: &mut [GroundPatch], portals: &[Edge]) {
    let rings: Vec<GridRing> = patches.iter().flat_map(|patch| turned_rings(&patch.outline)).collect();
    let is_sliver = |ring: &GridRing| is_narrow(&GridPolygon::simple(ring.clone()));
    let mut is_fixed: Vec<bool> = rings.iter().map(is_sliver).collect();
    let straight = loop {
        let straight = straightened(&rings, &is_fixed, portals);
        // What is hardly wider than a step may come to lie across itself.
        let bad: Vec<usize> =
            (0..rings.len()).filter(|&n| straight[n].len() < rings[n].len() && is_crossed(&straight[n])).collect();
        if bad.is_empty() {
            break straight;
        }
        bad.into_iter().for_each(|n| is_fixed[n] = true);
    };
    let mut straight = straight.into_iter();
    for patch in patches {
        let count = turned_rings(&patch.outline).count();
        let mut own = straight.by_ref().take(count);
        patch.outline = GridPolygon { outer: own.next().unwrap_or_default(), holes: own.collect() };
    }
}

/// Rings without the vertices that they can spare, but for the fixed ones, which keep all.
fn straightened(rings: &[GridRing], is_fixed: &[bool], portals: &[Edge]) -> Vec<GridRing> {
    let mut vertices: HashMap<GridPos, Vertex> = HashMap::new();
    for (n, ring) in rings.iter().enumerate() {
        for (i, &at) in ring.iter().enumerate() {
            let between = edge(ring[(i + ring.len() - 1) % ring.len()], ring[(i + 1) % ring.len()]);
            let vertex = vertices.entry(at).or_insert_with(|| Vertex { between: Some(between), rings: Vec::new() });
            vertex.between = vertex.between.filter(|&known| known == between);
            vertex.rings.push(n);
        }
    }
    let mut counts: Vec<usize> =
        rings.iter().zip(is_fixed).map(|(ring, &is_fixed)| if is_fixed { 0 } else { ring.len() }).collect();
    let mut order: Vec<GridPos> = vertices.keys().copied().collect();
    order.sort_unstable();
    let mut dropped: HashMap<Edge, Vec<GridPos>> = HashMap::new();
    for at in order {
        let Some(Vertex { between: Some((a, b)), rings }) = vertices.get(&at) else { continue };
        let (a, b, sides) = (*a, *b, [edge(at, *a), edge(at, *b)]);
        let mut off: Vec<GridPos> = sides.iter().filter_map(|side| dropped.get(side)).flatten().copied().collect();
        off.push(at);
        // Beyond a portal the same is dropped, if it is along it that one goes; where it ends, one does not know.
        let mut here = portals.iter().filter(|&&portal| is_along(portal, at)).peekable();
        let is_known = here.peek().is_none() || here.any(|&portal| is_along(portal, a) && is_along(portal, b));
        let is_straight = off.iter().all(|&p| if is_known { is_along((a, b), p) } else { a.cross(p, b) == 0 });
        // What stood beside it comes to stand beside each other.
        let past = |end: GridPos, other: GridPos| {
            let (p, q) = vertices.get(&end)?.between?;
            Some(edge(if p == at { q } else { p }, other))
        };
        let beside = [(a, past(a, b)), (b, past(b, a))];
        let is_flat = beside.iter().any(|(_, between)| between.is_some_and(|(p, q)| p == q));
        if is_flat || !is_straight || !is_between(a, at, b) || !rings.iter().all(|&n| counts[n] > 3) {
            continue;
        }
        rings.iter().for_each(|&n| counts[n] -= 1);
        vertices.remove(&at);
        for (end, between) in beside {
            vertices.entry(end).and_modify(|vertex| vertex.between = between);
        }
        sides.iter().for_each(|side| _ = dropped.remove(side));
        dropped.insert(edge(a, b), off);
    }
    let spared = |ring: &GridRing| ring.iter().copied().filter(|at| vertices.contains_key(at)).collect();
    rings.iter().map(spared).collect()
}

/// An edge, whichever way it runs.
fn edge(a: GridPos, b: GridPos) -> Edge {
    (a.min(b), a.max(b))
}

/// Whether edges of a ring meet that do not follow each other.
fn is_crossed(ring: &GridRing) -> bool {
    let all: Vec<Edge> = edges(ring).collect();
    let meets = |(a, b): Edge, (c, d): Edge| {
        let apart = |p: GridPos, q: GridPos, r: GridPos, s: GridPos| p.cross(q, r).signum() * p.cross(q, s).signum();
        let overlaps = |of: fn(GridPos) -> i32| of(a).min(of(b)) <= of(c).max(of(d)) && of(c).min(of(d)) <= of(a).max(of(b));
        let is_apart = [c, d].iter().any(|end| [a, b].contains(end)) || !overlaps(|p| p.0) || !overlaps(|p| p.1);
        !is_apart && apart(a, b, c, d) <= 0 && apart(c, d, a, b) <= 0
    };
    all.iter().enumerate().any(|(i, &one)| all[i + 1..].iter().any(|&other| meets(one, other)))
}

/// Whether a position lies on a line, as far as the steps of plans let all three tell.
fn is_along((a, b): Edge, at: GridPos) -> bool {
    let (from, to, at) = (a.to_metres(), b.to_metres(), at.to_metres());
    let way = to - from;
    // The position is half the diagonal of a step off at most, and so are the ends.
    let off_m = core::f64::consts::SQRT_2 * f64::from(PLAN_STEP) / f64::from(GRID_PER_METRE);
    let along = (at - from).dot(way) / way.length_squared().max(1e-12);
    let nearest = from + way * along.clamp(0.0, 1.0);
    nearest.distance(at) <= off_m
}

/// Whether the way by a position leads on.
fn is_between(a: GridPos, at: GridPos, b: GridPos) -> bool {
    let (a, at, b) = (a.to_metres(), at.to_metres(), b.to_metres());
    (at - a).dot(b - at) > 0.0
}

#[cfg(test)]
mod tests {
    use veduta_city::CityPlan;

    use super::*;

    fn patch(surface: SurfaceKind, corners: &[(f64, f64)]) -> GroundPatch {
        let at = |&(x, y): &(f64, f64)| GridPos::on_plan(glam::DVec2::new(x, y));
        GroundPatch { surface, outline: GridPolygon::simple(corners.iter().map(at).collect()), z: 0, course: None }
    }

    fn made(ground: &[GroundPatch], portals: &[Edge]) -> Vec<(SurfaceKind, usize, f64)> {
        let plan = CityPlan::default();
        let pieces = ground.iter().map(|patch| (patch, patch.outline.clone())).collect();
        let told = |patch: &GroundPatch| (patch.surface, patch.outline.outer.len(), libm::round(patch.outline.area_m2()));
        merged(pieces, portals, &Hidden::new(&plan)).iter().map(told).collect()
    }

    /// Two strips along a slanted border, cut into tiles whose corners were rounded to the steps of plans.
    fn strips(tiles: u32) -> Vec<GroundPatch> {
        let border = |x: f64| 10.0 + x / 9.7;
        let tile = |n: u32| {
            let (x, next) = (f64::from(n) * 7.3, f64::from(n + 1) * 7.3);
            [
                patch(SurfaceKind::Asphalt, &[(x, 0.0), (next, 0.0), (next, border(next)), (x, border(x))]),
                patch(SurfaceKind::Mosaic, &[(x, border(x)), (next, border(next)), (next, 30.0), (x, 30.0)]),
            ]
        };
        (0..tiles).flat_map(tile).collect()
    }

    #[test]
    fn tiles_are_joined_and_leave_no_vertices() {
        let m2 = |above: bool| {
            strips(8).iter().filter(|p| (p.surface == SurfaceKind::Mosaic) == above).map(|p| p.outline.area_m2()).sum()
        };
        let expected = [(SurfaceKind::Asphalt, 4, libm::round(m2(false))), (SurfaceKind::Mosaic, 4, libm::round(m2(true)))];
        assert_eq!(made(&strips(8), &[]), expected);
    }

    #[test]
    fn borders_of_holes_lose_their_vertices_too() {
        // A lawn in the middle of a square, both cut into tiles.
        let tile = |n: u32| {
            let (x, next) = (f64::from(n) * 7.3, f64::from(n + 1) * 7.3);
            let strip = |surface, [lo, hi]: [fn(f64) -> f64; 2]| {
                patch(surface, &[(x, lo(x)), (next, lo(next)), (next, hi(next)), (x, hi(x))])
            };
            let lower = |x: f64| 10.0 + x / 9.7;
            let upper = |x: f64| 20.0 + x / 9.7;
            let inner = if (2..6).contains(&n) { SurfaceKind::Grass } else { SurfaceKind::Cobbles };
            [
                strip(SurfaceKind::Cobbles, [|_| 0.0, lower]),
                strip(inner, [lower, upper]),
                strip(SurfaceKind::Cobbles, [upper, |_| 40.0]),
            ]
        };
        let ground: Vec<GroundPatch> = (0..8).flat_map(tile).collect();
        let plan = CityPlan::default();
        let made = merged(ground.iter().map(|patch| (patch, patch.outline.clone())).collect(), &[], &Hidden::new(&plan));
        let told: Vec<_> =
            made.iter().map(|patch| (patch.surface, patch.outline.rings().map(Vec::len).collect::<Vec<_>>())).collect();
        assert_eq!(told, [(SurfaceKind::Cobbles, vec![4, 4]), (SurfaceKind::Grass, vec![4])]);
    }

    #[test]
    fn where_something_or_a_portal_ends_vertices_stay() {
        // A third strip ends at the border, in its middle.
        let mut ground = strips(8);
        ground.retain(|patch| patch.surface == SurfaceKind::Asphalt);
        let above = strips(8);
        let split = |left: bool| {
            above.iter().filter(move |p| p.surface == SurfaceKind::Mosaic && (p.outline.outer[0].0 < 4 * 7475) == left)
        };
        ground.extend(split(true).cloned());
        ground.extend(split(false).map(|patch| GroundPatch { z: 9, ..patch.clone() }));
        assert_eq!(made(&ground, &[]).iter().map(|told| told.1).collect::<Vec<_>>(), [5, 4, 4]);
        // Its lower side bends by less than can be told, where a portal ends or elsewhere.
        let mut bent = strips(8);
        bent[6].outline.outer[1].1 += PLAN_STEP;
        bent[8].outline.outer[0].1 += PLAN_STEP;
        let bend = bent[8].outline.outer[0];
        let portal = |end: i32| (GridPos(0, 0), GridPos(end, PLAN_STEP));
        let told = [vec![], vec![portal(bend.0)], vec![portal(2 * bend.0)]].map(|portals| made(&bent, &portals)[0].1);
        assert_eq!(told, [4, 5, 4]);
    }

    #[test]
    fn a_strip_of_soil_between_pavement_and_wall_is_paved() {
        let pavement = patch(SurfaceKind::Mosaic, &[(0.0, 0.0), (30.0, 0.0), (30.0, 3.0), (0.0, 3.0)]);
        let strip = patch(SurfaceKind::Yard, &[(5.0, 3.0), (25.0, 3.0), (25.0, 3.2), (5.0, 3.1)]);
        let yard = patch(SurfaceKind::Yard, &[(40.0, 0.0), (60.0, 0.0), (60.0, 9.0), (40.0, 9.0)]);
        assert_eq!(made(&[pavement, strip, yard], &[]), [(SurfaceKind::Mosaic, 8, 93.0), (SurfaceKind::Yard, 4, 180.0)]);
    }
}
