//! One measured figure, beside a peer's.

use core::fmt;

use anstream::println;
use serde::Serialize;

use crate::program::Failure;

/// A figure, as it is printed: a line of JSON or a row of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Figure {
    pub name: String,
    pub value: f64,
    pub unit: &'static str,
    /// What the peer is, and its figure in the same unit; left out where it was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer_value: Option<f64>,
}

impl Figure {
    pub fn new(name: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { name: name.into(), value, unit, peer: None, peer_value: None }
    }

    /// Beside a peer's figure, if there is one.
    pub fn beside(self, peer: &'static str, value: Option<f64>) -> Self {
        Self { peer: value.map(|_| peer), peer_value: value, ..self }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, unit, peer, peer_value } = self;
        let digits = |value: f64| if value < 10.0 && *unit != "1" { 4 } else { 0 };
        write!(f, "| {name} | {value:.0$} | {unit} | ", digits(*value))?;
        match (peer, peer_value) {
            (Some(peer), Some(theirs)) => {
                let ratio = value / theirs;
                write!(f, "{peer} | {theirs:.0$} | {ratio:.1$} |", digits(*theirs), if ratio < 10.0 { 3 } else { 0 })
            }
            _ => write!(f, "– | – | – |"),
        }
    }
}

/// Prints figures: a line of JSON each, or a table.
pub(super) fn print(figures: &[Figure], json: bool) -> Result<(), Failure> {
    if !json {
        println!("| figure | ours | unit | peer | peer's | ratio |\n|---|---|---|---|---|---|");
    }
    for figure in figures {
        if json { println!("{}", serde_json::to_string(figure)?) } else { println!("{figure}") }
    }
    Ok(())
}
