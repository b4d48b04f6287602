//! Blocks: what lies between the streets.
//!
//! ```text
//!  neither street nor course ──outlines──► blocks, and holes in them: what streets enclose that lead nowhere, squares,
//!                                          courtyards │
//!                                                     ▼
//!                                          what it holds: built, park, water; or two of them, if both take much of it
//! ```

use glam::DVec2;
use veduta_city::BlockKind;

use super::bitmap::Bitmap;
use super::classify::Classes;
use super::clean::SPECK_M2;
use super::filter::median5;
use super::ground::{Grounds, Share};
use super::morphology::{Sweep, grown, swept_at};
use super::outline::{Corners, Outline, holders, outlines};

/// Half the width of gaps between courses and streets that are closed, pixels.
const GAP_PX: usize = 3;
/// How far an outline may be from the pixels' edges, pixels.
const SIMPLE_PX: f64 = 1.0;

/// A block as found, in plan metres.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FoundBlock {
    pub kind: BlockKind,
    /// Counter-clockwise.
    pub outline: Vec<DVec2>,
    /// Clockwise.
    pub holes: Vec<Vec<DVec2>>,
}

/// A block in pixels.
pub(super) struct Plot {
    pub outline: Outline,
    pub holes: Vec<Outline>,
}

/// The outlines of what is neither street nor course, with what they hold.
pub(super) fn blocks(street: &Bitmap, courses: [&Bitmap; 2], classes: &Classes, mpp: f64) -> Vec<FoundBlock> {
    let mut area = street.neither(courses[0]);
    area.remove(courses[1]);
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
    if !ponds.is_blank() {
        ponds.keep(&area);
        ponds = median5(&ponds);
    }
    let least = (2.0 * SPECK_M2 / (mpp * mpp)) as i64;
    // What most of a block shows covers at least half of the smallest.
    let has_grounds = 2 * classes.park.count().max(ponds.count()) as i64 > least;
    let grounds = Grounds { park: &classes.park, pond: &ponds, ink: &classes.ink, least, mpp };
    let height = street.height() as f64;
    let mut found = Vec::new();
    for plot in plots(&area, least) {
        let share = if has_grounds { grounds.share(&plot) } else { Share::default() };
        match grounds.parted(&plot, share) {
            Some(parts) => found.extend(parts.into_iter().map(|(kind, part)| part.in_plan(kind, height, mpp))),
            None => found.push(plot.in_plan(share.kind(), height, mpp)),
        }
    }
    found
}

/// The connected parts of an area with their holes, less those and these of fewer pixels.
pub(super) fn plots(area: &Bitmap, least: i64) -> Vec<Plot> {
    let large = outlines(area, Corners::Part).into_iter().filter(|o| o.area_px.abs() > least);
    let (holes, outers): (Vec<Outline>, Vec<Outline>) = large.partition(Outline::is_hole);
    let holders = holders(&outers, &holes);
    let mut plots: Vec<Plot> = outers.into_iter().map(|outline| Plot { outline, holes: Vec::new() }).collect();
    for (hole, holder) in holes.into_iter().zip(holders) {
        if let Some(plot) = holder.and_then(|i| plots.get_mut(i)) {
            plot.holes.push(hole);
        }
    }
    plots
}

impl FoundBlock {
    /// Its outline and those of its holes.
    pub fn rings_mut(&mut self) -> impl Iterator<Item = &mut Vec<DVec2>> {
        core::iter::once(&mut self.outline).chain(&mut self.holes)
    }
}

impl Plot {
    fn in_plan(&self, kind: BlockKind, height: f64, mpp: f64) -> FoundBlock {
        let ring = |outline: &Outline| {
            outline.simplified(SIMPLE_PX).into_iter().rev().map(|p| DVec2::new(p.x, height - p.y) * mpp).collect()
        };
        FoundBlock { kind, outline: ring(&self.outline), holes: self.holes.iter().map(ring).collect() }
    }
}
