//! Which free space people can reach: what hangs together with public ground through gaps wide enough to walk.

use std::collections::BTreeMap;

use veduta_city::{CityPlan, Finding, GRID_PER_METRE, GridPolygon, Id, Severity};

use crate::hull::distance_2;
use crate::outline::outlines;
use crate::overlay::{clip_patch, total_m2};
use crate::partition::PartitionSettings;
use crate::patches::Patches;
use crate::triangulate::Triangle;

/// Pieces up to this size beside reachable space belong to it however narrow their mouth: niches of façades. Square metres.
const NICHE_M2: f64 = 4.0;

/// The triangles that can be reached, and the others. Slits too narrow to walk through join nothing, but stay where they begin at
/// reachable space, since one looks through them. Falls back to the largest piece where there is no public ground.
pub(crate) fn reachable(
    triangles: &[Triangle],
    plan: &CityPlan,
    patches: &Patches<'_>,
    settings: &PartitionSettings,
    findings: &mut Vec<Finding>,
) -> (Vec<Triangle>, Vec<Triangle>) {
    let is_slit: Vec<bool> = triangles.iter().map(|t| is_slit(t, settings.min_passage_m)).collect();
    let piece = pieces(triangles, &is_slit, settings.min_passage_m);
    let (outlines, _) = outlines(triangles, &piece, &plan.extent);
    let mut slits = vec![false; outlines.len()];
    for (t, &piece) in piece.iter().enumerate() {
        slits[piece as usize] |= is_slit[t];
    }
    let least_m2 = settings.min_public_m2;
    let mut is_kept: Vec<bool> = outlines.iter().map(|o| public_m2(o, patches, least_m2) >= least_m2).collect();
    for (kept, is_slit) in is_kept.iter_mut().zip(&slits) {
        *kept &= !is_slit;
    }
    if !is_kept.contains(&true) {
        keep_largest(&outlines, &mut is_kept, least_m2, findings);
    }
    // Slits and niches beside what is kept.
    let beside: Vec<u32> = (0..triangles.len())
        .filter(|&t| triangles[t].beyond.iter().flatten().any(|&n| is_kept[piece[n as usize] as usize]))
        .map(|t| piece[t])
        .collect();
    for piece in beside {
        let kept = &mut is_kept[piece as usize];
        *kept = *kept || slits[piece as usize] || outlines[piece as usize].area_m2() < NICHE_M2;
    }
    (only(triangles, |t| is_kept[piece[t] as usize]), only(triangles, |t| !is_kept[piece[t] as usize]))
}

fn keep_largest(outlines: &[GridPolygon], is_kept: &mut [bool], least_m2: f64, findings: &mut Vec<Finding>) {
    let largest = outlines.iter().enumerate().max_by(|a, b| a.1.area_m2().total_cmp(&b.1.area_m2()));
    if let Some((i, outline)) = largest {
        is_kept[i] = true;
        let message = format!(
            "no piece of free space holds {least_m2} m² of public ground: the largest piece, {:.0} m², became the city",
            outline.area_m2()
        );
        findings.push(Finding::new(Severity::Repaired, Id::NONE, Some(outline.centroid()), message));
    }
}

/// Outlines of the spaces that triangles fill together.
pub(crate) fn spaces(triangles: &[Triangle], extent: &GridPolygon) -> Vec<GridPolygon> {
    let is_slit = vec![true; triangles.len()];
    outlines(triangles, &pieces(triangles, &is_slit, 0.0), extent).0
}

/// Whether a triangle leads through between a wall and a corner that are closer than a passage is wide.
fn is_slit(triangle: &Triangle, min_passage_m: f64) -> bool {
    let least = min_passage_m * f64::from(GRID_PER_METRE);
    (0..3).any(|i| {
        let (a, b) = triangle.edge(i);
        let corner = triangle.corners[(i + 2) % 3];
        let is_way =
            triangle.beyond[i].is_none() && triangle.beyond[(i + 1) % 3].is_some() && triangle.beyond[(i + 2) % 3].is_some();
        let wall_2 = distance_2(a, b);
        let (from_a, from_b) = (distance_2(a, corner), distance_2(b, corner));
        // The corner's foot lies on the wall if neither angle at the wall is obtuse.
        let is_before_wall = from_a <= wall_2 + from_b && from_b <= wall_2 + from_a;
        is_way && is_before_wall && (triangle.area_2() as f64) < least * libm::sqrt(wall_2 as f64)
    })
}

/// Pieces of space that hang together through edges wide enough (slits: through any edges between them), numbered from 0.
fn pieces(triangles: &[Triangle], is_slit: &[bool], min_passage_m: f64) -> Vec<u32> {
    let least = min_passage_m * f64::from(GRID_PER_METRE);
    let least_2 = (least * least) as i64;
    let mut piece = vec![u32::MAX; triangles.len()];
    let mut count = 0;
    for start in 0..triangles.len() {
        if piece[start] != u32::MAX {
            continue;
        }
        piece[start] = count;
        let mut stack = vec![start];
        while let Some(t) = stack.pop() {
            for i in 0..3 {
                let (a, b) = triangles[t].edge(i);
                let Some(next) = triangles[t].beyond[i].map(|n| n as usize) else { continue };
                let is_joined = is_slit[t] == is_slit[next] && (is_slit[t] || distance_2(a, b) >= least_2);
                if is_joined && piece[next] == u32::MAX {
                    piece[next] = count;
                    stack.push(next);
                }
            }
        }
        count += 1;
    }
    piece
}

/// Square metres of public ground in a shape; may stop counting beyond `enough`.
fn public_m2(shape: &GridPolygon, patches: &Patches<'_>, enough: f64) -> f64 {
    let Some(bounds) = shape.bounds() else { return 0.0 };
    if shape.area_m2() < enough {
        return 0.0;
    }
    let mut sum = 0.0;
    for patch in patches.near(bounds).into_iter().filter(|patch| patch.surface.is_public()) {
        sum += total_m2(&clip_patch(&patch.outline, shape, bounds));
        if sum >= enough {
            break;
        }
    }
    sum
}

/// Some of the triangles, with their neighbours renumbered.
pub(crate) fn only(triangles: &[Triangle], is_kept: impl Fn(usize) -> bool) -> Vec<Triangle> {
    let kept: Vec<usize> = (0..triangles.len()).filter(|&t| is_kept(t)).collect();
    let number: BTreeMap<u32, u32> = (0..).zip(&kept).map(|(n, &t)| (t as u32, n)).collect();
    let beyond = |t: Option<u32>| t.and_then(|t| number.get(&t).copied());
    kept.iter().map(|&t| Triangle { beyond: triangles[t].beyond.map(beyond), ..triangles[t] }).collect()
}
