//! Blocks: what lies between the streets.

use glam::DVec2;
use veduta_city::BlockKind;

use super::bitmap::Bitmap;
use super::classify::Classes;
use super::clean::SPECK_M2;
use super::filter::median5;
use super::morphology::{Sweep, grown, swept_at};
use super::outline::{Corners, Outline, outlines, simplified_ring};

/// Half the width of gaps between courses and streets that are closed, pixels.
const GAP_PX: usize = 3;
/// Rows of a block in which it is looked at what it holds.
const LOOKS: i32 = 24;

/// The outlines of what is neither street nor course, with what they hold.
pub(crate) fn blocks(street: &Bitmap, courses: [&Bitmap; 2], classes: &Classes, mpp: f64) -> Vec<(BlockKind, Vec<DVec2>)> {
    let mut area = street.inverted();
    for course in courses {
        area.remove(course);
    }
    // Where a course comes to a street, noise leaves a gap by which the blocks on its two sides would be one.
    if courses.iter().any(|course| !course.is_blank()) {
        let mut gaps = courses[0].clone();
        gaps.add(courses[1]);
        gaps = grown(&gaps, 2 * GAP_PX);
        gaps.keep(&area);
        gaps.remove(&swept_at(&gaps, &area, &[Sweep::Shrink(GAP_PX), Sweep::Grow(GAP_PX)]));
        area.remove(&gaps);
    }
    let mut ponds = classes.water.clone();
    ponds.keep(&area);
    let ponds = median5(&ponds);
    let least = (2.0 * SPECK_M2 / (mpp * mpp)) as i64;
    // What most of a block shows covers at least half of the smallest.
    let has_grounds = 2 * classes.park.count().max(ponds.count()) as i64 > least;
    let height = street.height() as f64;
    outlines(&area, Corners::Part)
        .into_iter()
        .filter(|o| o.area_px > least)
        .map(|outline| {
            let kind = if has_grounds { kind(&outline, &classes.park, &ponds) } else { BlockKind::Built };
            let ring: Vec<DVec2> = outline.corners.iter().map(|c| c.as_dvec2()).collect();
            let ring = simplified_ring(&ring, 1.0).into_iter().rev();
            (kind, ring.map(|p| DVec2::new(p.x, height - p.y) * mpp).collect())
        })
        .collect()
}

/// What a block is: what most of it shows.
fn kind(outline: &Outline, parks: &Bitmap, ponds: &Bitmap) -> BlockKind {
    let (low, high) = outline.extent();
    let every = ((high.y - low.y) / LOOKS).max(1);
    let is_looked_at: Vec<bool> = (0..high.y - low.y).map(|y| y % every == every / 2).collect();
    let (mut all, mut park, mut water) = (0, 0, 0);
    for (y, from, to) in outline.spans(|y| is_looked_at[(y - low.y) as usize]) {
        let (y, from, to) = (y as usize, from as usize, to as usize);
        all += to - from;
        park += parks.count_between(y, from, to);
        water += ponds.count_between(y, from, to);
    }
    if 2 * park > all {
        BlockKind::Park
    } else if 2 * water > all {
        BlockKind::Water
    } else {
        BlockKind::Built
    }
}
