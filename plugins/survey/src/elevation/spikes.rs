use std::collections::BTreeSet;

use glam::DVec2;
use veduta_city::{Anchor, CityGraph, Finding, Id, Severity};

use super::ElevationGrid;
use super::sample::Sampler;

/// Least height of a spike over its surroundings, and how much more of it is asked for a metre of cell: where cells are
/// large, real hills rise within one. Metres; metres a metre.
const LEAST_M: f64 = 5.0;
const LEAST_PER_CELL: f64 = 0.15;
/// A spike stands out by so many standard deviations (as the median deviation tells them) of its surroundings.
const DEVIATIONS: f64 = 6.0;
/// Standard deviations in a median deviation of normally spread values.
const NORMAL: f64 = 1.4826;
/// At most so many of the 24 cells around may be as high: more are a building, a rock or a wall.
const MOST_ALIKE: usize = 3;
/// So many of the cells around must hold data.
const LEAST_KNOWN: usize = 8;
/// Spikes that are told one by one.
const TOLD: usize = 20;
/// Cells around the city that are looked at.
const AROUND: f64 = 8.0;

/// A cell that stands out of its surroundings as no ground does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spike {
    /// Column from the west, from 0.
    pub column: u32,
    /// Row from the north, from 0.
    pub row: u32,
    /// What the cell holds, metres.
    pub height_m: f64,
    /// Median of the 24 cells around it, metres.
    pub around_m: f64,
}

impl ElevationGrid {
    /// The cells that differ from the median of the 24 around them by more than ground does: by at least 5 m, by six of the
    /// surroundings' standard deviations, and with at most three of them alike. Cells from `low` up to before `high` (column,
    /// row) are looked at.
    #[must_use]
    pub fn spikes(&self, low: (u32, u32), high: (u32, u32)) -> Vec<Spike> {
        let rows = low.1..high.1.min(self.rows);
        let cells = rows.flat_map(|row| (low.0..high.0.min(self.columns)).map(move |column| (column, row)));
        cells.filter_map(|(column, row)| self.spike(column, row)).collect()
    }

    fn spike(&self, column: u32, row: u32) -> Option<Spike> {
        let (x, y) = (i64::from(column), i64::from(row));
        let height_m = self.cell(x, y)?;
        let least = LEAST_M + LEAST_PER_CELL * self.cell_m;
        let around = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy))).filter(|&d| d != (0, 0));
        // Most cells have company at once.
        let mut known: Vec<f64> = Vec::new();
        let mut alike = 0;
        for height in around.filter_map(|(dx, dy)| self.cell(x + dx, y + dy)) {
            alike += usize::from((height - height_m).abs() <= least / 2.0);
            if alike > MOST_ALIKE {
                return None;
            }
            known.push(height);
        }
        if known.len() < LEAST_KNOWN {
            return None;
        }
        let around_m = median(&mut known)?;
        let mut off: Vec<f64> = known.iter().map(|h| (h - around_m).abs()).collect();
        let deviation = NORMAL * median(&mut off)?;
        let is_spike = (height_m - around_m).abs() > least.max(DEVIATIONS * deviation);
        is_spike.then_some(Spike { column, row, height_m, around_m })
    }

    /// A sampler that takes the spikes under and around a city for holes, and what is to be told of them.
    pub(super) fn without_spikes(&self, graph: &CityGraph) -> (Sampler<'_>, Vec<Finding>) {
        let Some((low, high)) = self.window(graph) else { return (Sampler::new(self), Vec::new()) };
        let spikes = self.spikes(low, high);
        let taken_out: BTreeSet<(i64, i64)> = spikes.iter().map(|s| (s.column.into(), s.row.into())).collect();
        (Sampler::without(self, taken_out), self.told(&spikes, graph.anchor))
    }

    /// Cells under and around the nodes and houses of a city.
    fn window(&self, graph: &CityGraph) -> Option<((u32, u32), (u32, u32))> {
        let houses = graph.buildings.iter().filter_map(|b| b.outline.first().copied());
        let all = graph.nodes.iter().map(|n| n.pos).chain(houses);
        let pixels = all.filter_map(|p| self.pixel_from_plan(graph.anchor, p)).filter(|p| self.holds(*p));
        let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = pixels.fold(none, |(low, high), p| (low.min(p), high.max(p)));
        let (low, high) = ((low - AROUND).max(DVec2::ZERO), high + AROUND);
        low.cmple(high).all().then_some(((low.x as u32, low.y as u32), (high.x as u32 + 1, high.y as u32 + 1)))
    }

    fn told(&self, spikes: &[Spike], anchor: Anchor) -> Vec<Finding> {
        let place = |s: &Spike| self.plan_from_pixel(anchor, DVec2::new(f64::from(s.column), f64::from(s.row)) + 0.5);
        let mut out: Vec<Finding> = spikes
            .iter()
            .take(TOLD)
            .map(|s| {
                let message = format!(
                    "a cell of {} says {:.1} m among others around {:.1} m: taken for a fault and filled from around it",
                    self.name, s.height_m, s.around_m
                );
                Finding::new(Severity::Repaired, Id::NONE, place(s), message)
            })
            .collect();
        if let Some(next) = spikes.get(TOLD) {
            let message = format!("{} more cells of {} stand out like this and were filled", spikes.len() - TOLD, self.name);
            out.push(Finding::new(Severity::Repaired, Id::NONE, place(next), message));
        }
        out
    }
}

/// The middle value; sorts.
pub(super) fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The value below which a share of all lies; sorts.
pub(super) fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get(libm::round(share * last as f64) as usize).copied()
}
