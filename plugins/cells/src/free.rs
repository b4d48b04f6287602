//! Free space: the extent less the houses that stand on the ground.

use glam::DVec2;
use veduta_city::{CityPlan, Finding, GRID_PER_METRE, GridPolygon, GridPos, GridRing, House, Id, Severity, Volume};

use crate::overlay::{Bounds, Keep, combine, edges, ring_area_2, turned_rings};
use crate::partition::PartitionSettings;
use crate::patches::Patches;

/// Farthest coordinate from the anchor, grid steps.
const FARTHEST: i32 = 1 << 30;
/// Longest side of the extent's bounds, grid steps: products of two such lengths fit 64 bits with room to spare.
const WIDEST: i32 = 1 << 28;
/// All free space, courtyards included: connected polygons.
pub(crate) fn free_space(
    plan: &CityPlan,
    patches: &Patches<'_>,
    settings: &PartitionSettings,
    findings: &mut Vec<Finding>,
) -> Vec<GridPolygon> {
    let Some(bounds) = usable_bounds(&plan.extent) else {
        findings.push(Finding::new(
            Severity::Dropped,
            Id::NONE,
            None,
            "the extent has no area, spans more than 260 km or lies more than 1,000 km from the anchor",
        ));
        return Vec::new();
    };
    let mut obstacles: Vec<GridRing> = Vec::new();
    for house in &plan.houses {
        for volume in &house.volumes {
            if !is_within_reach(volume, bounds) {
                let message = "a volume without a footprint, or far outside of the extent, is no obstacle";
                findings.push(Finding::new(Severity::Dropped, house.id, None, message));
            } else if !is_passage(house, volume, patches, settings) {
                obstacles.extend(turned_rings(&volume.footprint));
            }
        }
    }
    combine(Keep::FirstAlone, turned_rings(&plan.extent), obstacles, true)
}

fn usable_bounds(extent: &GridPolygon) -> Option<Bounds> {
    let (lo, hi) = extent.bounds()?;
    let is_near = [lo, hi].iter().all(|p| p.0.unsigned_abs() < FARTHEST as u32 && p.1.unsigned_abs() < FARTHEST as u32);
    let is_small = is_near && hi.0 - lo.0 < WIDEST && hi.1 - lo.1 < WIDEST;
    (is_small && ring_area_2(&extent.outer) != 0).then_some((lo, hi))
}

/// Whether a footprint is a polygon near enough for products of coordinates to be safe.
fn is_within_reach(volume: &Volume, extent: Bounds) -> bool {
    let Some((lo, hi)) = volume.footprint.bounds() else { return false };
    let near = |v: i32, lo: i32, hi: i32| {
        i64::from(v) >= i64::from(lo) - i64::from(WIDEST) && i64::from(v) <= i64::from(hi) + i64::from(WIDEST)
    };
    [lo, hi].iter().all(|p| near(p.0, extent.0.0, extent.1.0) && near(p.1, extent.0.1, extent.1.1))
        && ring_area_2(&volume.footprint.outer) != 0
}

/// Whether one can walk under a volume: it hangs higher than the clearance above the ground beside it or, where there is none,
/// above the foot of its house.
fn is_passage(house: &House, volume: &Volume, patches: &Patches<'_>, settings: &PartitionSettings) -> bool {
    let Some((lo, hi)) = volume.footprint.bounds() else { return false };
    let clearance = GridPos::steps(settings.clearance_m);
    if i64::from(volume.bottom) - i64::from(house.floor) <= i64::from(clearance) {
        return false;
    }
    let hangs_above = |z: i32| i64::from(volume.bottom) - i64::from(z) > i64::from(clearance);
    let margin = GRID_PER_METRE;
    let around = (GridPos(lo.0 - margin, lo.1 - margin), GridPos(hi.0 + margin, hi.1 + margin));
    let foot = house.volumes.iter().map(|v| v.bottom).min().unwrap_or(volume.bottom);
    let lowest = patches.lowest(around);
    if !hangs_above(lowest.unwrap_or(foot).min(foot)) {
        return false;
    }
    let beside = edges(&volume.footprint.outer).filter_map(|(a, b)| patches.z_at(beside(a, b, 0.5, 0.3)));
    hangs_above(beside.max().unwrap_or(foot))
}

/// The position a share of the way along an edge, pushed to the right of it by a distance in metres: outward, for the rings of a
/// solid.
pub(crate) fn beside(a: GridPos, b: GridPos, share: f64, distance_m: f64) -> GridPos {
    let (from, to) = (a.to_metres(), b.to_metres());
    let along = to - from;
    let length = libm::sqrt(along.length_squared());
    let outward = if length > 0.0 { DVec2::new(along.y, -along.x) / length } else { DVec2::ZERO };
    GridPos::from_metres(from + along * share + outward * distance_m)
}
