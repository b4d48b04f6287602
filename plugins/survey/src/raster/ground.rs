//! What a block holds: houses, a park or water; and the border where it is part the one, part the other.
//!
//! A block is what most of it shows. Where both of two grounds take a quarter of it, it is parted, if the border between them
//! can be told: after smoothing it away and back by a few metres, nearly every pixel must still be on its own side. Trees
//! drawn one by one, hatching and lawns about houses fail that, and stay one block.

use veduta_city::BlockKind;

use super::bitmap::Bitmap;
use super::blocks::{Plot, plots};
use super::filter::{crowded, dilated_twice, filled, median5};
use super::morphology::{grown, shrunk};
use super::outline::Corners;
use super::parts::Parts;

/// Rows of a block in which it is looked at what it holds.
const LOOKS: i32 = 24;
/// Percent of a block that a ground takes at least, and leaves at least, if it is parted.
const LEAST_PERCENT: i64 = 25;
/// Percent of a parted block that smoothing its border may put on the other side.
const MOST_UNCLEAN_PERCENT: i64 = 4;
/// Half the width of what smoothing takes away: metres, or pixels where these are larger.
const SMOOTH_M: f64 = 1.5;
const SMOOTH_PX: usize = 2;

/// A map's grounds.
pub(super) struct Grounds<'a> {
    pub park: &'a Bitmap,
    pub pond: &'a Bitmap,
    /// Labels and symbols.
    pub ink: &'a Bitmap,
    /// Fewest pixels of a block.
    pub least: i64,
    pub mpp: f64,
}

/// How much of a block its grounds take, by the rows that were looked at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Share {
    all: i64,
    park: i64,
    pond: i64,
}

impl Share {
    /// What most of it shows.
    pub fn kind(self) -> BlockKind {
        if 2 * self.park > self.all {
            BlockKind::Park
        } else if 2 * self.pond > self.all {
            BlockKind::Water
        } else {
            BlockKind::Built
        }
    }

    /// The ground that takes much of it and leaves much.
    fn parting(self) -> Option<BlockKind> {
        let parts = |part: i64| (LEAST_PERCENT * self.all..=(100 - LEAST_PERCENT) * self.all).contains(&(100 * part));
        if self.all > 0 && parts(self.park) {
            Some(BlockKind::Park)
        } else if self.all > 0 && parts(self.pond) {
            Some(BlockKind::Water)
        } else {
            None
        }
    }
}

impl Grounds<'_> {
    /// How much of a block its grounds take.
    pub fn share(&self, plot: &Plot) -> Share {
        let mut share = Share::default();
        for (outline, sign) in core::iter::once((&plot.outline, 1)).chain(plot.holes.iter().map(|hole| (hole, -1))) {
            let (low, high) = plot.outline.extent();
            let every = ((high.y - low.y) / LOOKS).max(1);
            // So many rows each of those looked at stands for.
            let rows = sign * i64::from(every);
            for (y, from, to) in outline.spans(|y| (y - low.y) % every == every / 2) {
                let (y, from, to) = (y as usize, from as usize, to as usize);
                share.all += rows * (to - from) as i64;
                share.park += rows * self.park.count_between(y, from, to) as i64;
                share.pond += rows * self.pond.count_between(y, from, to) as i64;
            }
        }
        share
    }

    /// The parts of a block of two grounds, each with its kind, if there are such.
    pub fn parted(&self, plot: &Plot, share: Share) -> Option<Vec<(BlockKind, Plot)>> {
        let kind = share.parting()?;
        let (low, high) = plot.outline.extent();
        let corner = low - 1;
        let size = (high - low + 2).as_usizevec2();
        let window = |of: &Bitmap| Bitmap::from_window(of, corner, size.x, size.y);
        let mut own = Bitmap::new(size.x, size.y);
        plot.outline.moved(-corner).paint(&mut own, true);
        for hole in &plot.holes {
            hole.moved(-corner).paint(&mut own, false);
        }
        let shown = if kind == BlockKind::Park { self.park } else { self.pond };
        let (ground, rest) = self.smoothed(&own, &window(shown), &window(self.ink))?;
        // What is no park may be mostly pond, and the other way round.
        let rest_kind = match kind {
            BlockKind::Park => Share { all: share.all - share.park, park: 0, ..share },
            _ => Share { all: share.all - share.pond, pond: 0, ..share },
        };
        let of = |kind: BlockKind, area: &Bitmap| -> Vec<(BlockKind, Plot)> {
            let moved = |plot: Plot| Plot {
                outline: plot.outline.moved(corner),
                holes: plot.holes.iter().map(|hole| hole.moved(corner)).collect(),
            };
            plots(area, self.least).into_iter().map(|plot| (kind, moved(plot))).collect()
        };
        let mut parts = of(kind, &ground);
        parts.extend(of(rest_kind.kind(), &rest));
        Some(parts)
    }

    /// A block's two grounds with the border between them made smooth; nothing if they are not two, or much changes sides.
    fn smoothed(&self, own: &Bitmap, shown: &Bitmap, ink: &Bitmap) -> Option<(Bitmap, Bitmap)> {
        let steps = ((SMOOTH_M / self.mpp) as usize).max(SMOOTH_PX);
        let mut seen = shown.clone();
        if !ink.is_blank() {
            let mut hidden = dilated_twice(&crowded(ink));
            hidden.keep(own);
            seen = filled(&seen, &hidden);
        }
        seen.keep(own);
        let seen = median5(&seen);
        let opened = |area: &Bitmap| {
            let mut open = grown(&shrunk(area, steps), steps);
            open.keep(area);
            open
        };
        // First what the ground is without bits and strips, then what the rest is; each lot too small goes to the other.
        let mut ground = opened(&seen);
        let mut rest = opened(&own.without(&ground));
        ground = own.without(&rest);
        self.give_away(&mut ground, &mut rest);
        self.give_away(&mut rest, &mut ground);
        let all = own.count() as i64;
        let is_large = |area: &Bitmap| 100 * area.count() as i64 >= LEAST_PERCENT * all && area.count() as i64 > self.least;
        let mut changed = ground.without(&seen).count();
        changed += {
            let mut gone = seen.clone();
            gone.keep(&rest);
            gone.count()
        };
        let is_clean = 100 * changed as i64 <= MOST_UNCLEAN_PERCENT * all;
        (is_large(&ground) && is_large(&rest) && is_clean).then_some((ground, rest))
    }

    /// Gives parts that are smaller than a block to the other ground.
    fn give_away(&self, from: &mut Bitmap, to: &mut Bitmap) {
        for run in Parts::of(&from.clone(), Corners::Part).smaller_than(self.least) {
            let (y, start, end) = (run.y as usize, run.from as usize, run.to as usize);
            from.set_between(y, start, end, false);
            to.set_between(y, start, end, true);
        }
    }
}
