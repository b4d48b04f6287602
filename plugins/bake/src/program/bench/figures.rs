//! Figures of many maps made one.

use core::fmt;
use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::program::Failure;

/// How maps are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Streets and blocks alone.
    Plain,
    /// With labels, water, railways and parks, and scanned.
    Hard,
    PlainFigureGround,
    HardFigureGround,
}

impl Kind {
    pub const ALL: [Self; 4] = [Self::Plain, Self::Hard, Self::PlainFigureGround, Self::HardFigureGround];

    pub fn is_figure_ground(self) -> bool {
        matches!(self, Self::PlainFigureGround | Self::HardFigureGround)
    }

    /// What `make_map.py` is told.
    pub fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Plain => &[],
            Self::Hard => &["--labels", "--water", "--parks", "--noise", "scan"],
            Self::PlainFigureGround => &["--figure-ground"],
            Self::HardFigureGround => &["--figure-ground", "--labels", "--water", "--parks", "--noise", "scan"],
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Plain => "plain",
            Self::Hard => "hard",
            Self::PlainFigureGround => "plain, figure-ground",
            Self::HardFigureGround => "hard, figure-ground",
        })
    }
}

/// Figures over many maps: of what is counted, over all of it; of the rest, the mean of the maps.
pub(crate) struct Pooled([f64; 7]);

impl Pooled {
    pub const HEADS: [&str; 7] =
        ["crossroads F1", "blind alleys F1", "links F1", "topology", "width error m", "squares F1", "blocks F1"];

    /// # Errors
    /// A score without one of the figures.
    pub fn of(scores: &[Value]) -> Result<Self, Failure> {
        let number = |score: &Value, path: &str| {
            score.pointer(path).and_then(Value::as_f64).ok_or_else(|| Failure::from(format!("a score without {path}")))
        };
        let sum = |path: &str| scores.iter().map(|score| number(score, path)).sum::<Result<f64, Failure>>();
        let mean = |path: &str| Ok::<f64, Failure>(sum(path)? / scores.len().max(1) as f64);
        let f1 = |what: &str| {
            let (matched, truth) = (sum(&format!("/{what}/matched"))?, sum(&format!("/{what}/truth"))?);
            let all = truth + sum(&format!("/{what}/found"))?;
            Ok::<f64, Failure>(if all > 0.0 { 2.0 * matched / all } else { 1.0 })
        };
        Ok(Self([
            f1("crossroads")?,
            f1("blind_alleys")?,
            mean("/links/f1")?,
            mean("/topology/agree")?,
            mean("/street_width/median_abs_error_m")?,
            f1("squares")?,
            f1("blocks")?,
        ]))
    }

    pub fn to_json(&self) -> Value {
        json!(Self::HEADS.into_iter().zip(self.0).collect::<BTreeMap<_, _>>())
    }
}

impl fmt::Display for Pooled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells: Vec<String> = self.0.iter().map(|figure| format!("{figure:.3}")).collect();
        f.write_str(&cells.join(" | "))
    }
}

/// The run with the median total, of seconds by step. Of an even number of runs, the slower of the two in the middle.
pub(crate) fn median_seconds(runs: &[serde_json::Map<String, Value>]) -> serde_json::Map<String, Value> {
    let total = |run: &serde_json::Map<String, Value>| run.get("total").and_then(Value::as_f64).unwrap_or(f64::MAX);
    let mut order: Vec<&serde_json::Map<String, Value>> = runs.iter().collect();
    order.sort_by(|a, b| total(a).total_cmp(&total(b)));
    order.get(order.len() / 2).map(|run| (*run).clone()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_pooled_and_shares_are_averaged() {
        let score = |matched: u32, truth: u32, found: u32, share: f64| {
            let counted = json!({ "matched": matched, "truth": truth, "found": found });
            json!({
                "crossroads": counted, "blind_alleys": counted, "squares": counted, "blocks": counted,
                "links": { "f1": share }, "topology": { "agree": share }, "street_width": { "median_abs_error_m": share },
            })
        };
        let pooled = Pooled::of(&[score(9, 10, 10, 1.0), score(0, 10, 0, 0.5)]).expect("all figures are there");
        assert_eq!(pooled.0, [0.6, 0.6, 0.75, 0.75, 0.75, 0.6, 0.6]);
        assert!(Pooled::of(&[json!({})]).is_err(), "a score that lacks figures is an error");
        let none = Pooled::of(&[score(0, 0, 0, 1.0)]).expect("all figures are there");
        assert_eq!(none.0[0], 1.0, "nothing found where nothing is");
    }

    #[test]
    fn the_median_run_is_taken_whole() {
        let run = |total: f64| serde_json::Map::from_iter([("total".to_owned(), json!(total))]);
        assert_eq!(median_seconds(&[run(3.0), run(1.0), run(2.0)]), run(2.0));
        assert!(median_seconds(&[]).is_empty());
    }
}
