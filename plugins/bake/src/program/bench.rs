//! `bench survey`: the survey of pictures measured beside the best chain that Python has for it, on maps whose streets
//! are known.
//!
//! ```text
//!  make_map.py ─► map.png, legend, truth ─┬─► veduta-bake survey ─┬─► score_graph.py ─► table of truth
//!  (once a map, then kept)                └─► peer_raster.py ─────┴─► --timings ─────► table of seconds, plot
//! ```
//!
//! Both are run as programs, each as a person would run it, and timed by their own `--timings`.

mod cells;
mod cmpe;
mod facades;
mod figure;
mod figures;
mod footprints;
mod growth;
mod meshes;
mod plot;
mod programs;
mod roofs;
mod thinning;

use std::path::PathBuf;

use anstream::{eprintln, println};
use clap::Args;
use serde_json::{Value, json};
use veduta_city::file;

use super::Failure;
pub(crate) use cells::{CellsBench, cells};
pub(crate) use facades::{FacadesBench, facades};
use figures::{Kind, Pooled, median_seconds};
pub(crate) use growth::{GrowthBench, growth};
pub(crate) use meshes::{MeshesBench, meshes};
use programs::{Map, Programs, Reader, STYLES};
pub(crate) use roofs::{RoofsBench, roofs};
pub(crate) use thinning::{ThinningBench, thinning};

/// What to measure, and with what.
#[derive(Args)]
pub(crate) struct SurveyBench {
    /// Folder of make_map.py, peer_raster.py and score_graph.py.
    #[arg(long, value_name = "DIR")]
    peers: PathBuf,
    /// Python with what their requirements.txt names.
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// First seed of the maps that are scored.
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Seeds a style that are scored; 0 scores none.
    #[arg(long, default_value_t = 8)]
    seeds: u32,
    /// Pixels a side of the maps that are scored.
    #[arg(long, default_value_t = 2048)]
    size: u32,
    /// Also score the same maps as figure-ground.
    #[arg(long)]
    figure_ground: bool,
    /// Pixels a side of the maps that are timed.
    #[arg(long, value_delimiter = ',', default_value = "512,1024,2048,4096")]
    timed: Vec<u32>,
    /// How often each is timed, in turn; the median counts.
    #[arg(long, default_value_t = 5)]
    repeat: usize,
    /// Where maps and results are kept; a map that is there is not drawn again.
    #[arg(long, value_name = "DIR", default_value = "target/bench-survey")]
    work: PathBuf,
    /// Where to write all figures as JSON.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Where to write the plot of time against pixels.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

/// The steps of reading a picture, in their order; decoding and writing are no part of the total.
const STEPS: [&str; 12] =
    ["classify", "clean", "skeleton", "trace", "simplify", "widths", "squares", "streets", "courses", "blocks", "graph", "total"];

/// Measures and prints the tables.
///
/// # Errors
/// A program that cannot be run, or does not say what it should.
pub(crate) fn survey(bench: &SurveyBench) -> Result<(), Failure> {
    let programs = Programs::new(&bench.python, &bench.peers, &bench.work)?;
    let scored = scored(bench, &programs)?;
    let timed = timed(bench, &programs)?;
    if let Some(path) = &bench.plot {
        file::write_text(&plot::svg(&timed), path)?;
    }
    if let Some(path) = &bench.output {
        let timed: Vec<Value> = timed.iter().map(Timed::to_json).collect();
        file::write_text(&format!("{:#}\n", json!({ "truth": scored, "seconds": timed })), path)?;
    }
    Ok(())
}

/// Scores both readers on every map, and prints the table.
fn scored(bench: &SurveyBench, programs: &Programs) -> Result<Vec<Value>, Failure> {
    let mut rows = Vec::new();
    if bench.seeds == 0 {
        return Ok(rows);
    }
    println!("| {} px, {} seeds × {} styles | reader | {} |", bench.size, bench.seeds, STYLES.len(), Pooled::HEADS.join(" | "));
    println!("|---|---|{}", "---|".repeat(Pooled::HEADS.len()));
    for kind in Kind::ALL.into_iter().filter(|kind| bench.figure_ground || !kind.is_figure_ground()) {
        let seeds = bench.seed..bench.seed.saturating_add(bench.seeds);
        let maps: Vec<Map> = seeds.flat_map(|seed| STYLES.map(|style| Map { style, seed, size: bench.size, kind })).collect();
        for reader in Reader::ALL {
            let (scores, unread) = scores(&maps, reader, programs)?;
            let pooled = Pooled::of(&scores)?;
            let left_out = if unread.is_empty() { String::new() } else { format!(", {} of {} maps", scores.len(), maps.len()) };
            println!("| {kind} | {reader}{left_out} | {pooled} |");
            rows.push(json!({
                "maps": kind.to_string(), "reader": reader.to_string(), "figures": pooled.to_json(), "unread": unread,
            }));
        }
    }
    println!();
    Ok(rows)
}

/// A reader's scores of some maps, and the names of those that it cannot read, of which it is told why.
///
/// # Errors
/// Ours cannot read one, or the peer none.
fn scores(maps: &[Map], reader: Reader, programs: &Programs) -> Result<(Vec<Value>, Vec<String>), Failure> {
    let score = |map: &Map| match programs.score(map, reader) {
        Err(error) if reader == Reader::Peer => Ok(Err(error.to_string())),
        score => score.map(Ok),
    };
    let (mut scores, mut unread, mut last) = (Vec::new(), Vec::new(), None);
    for (map, score) in maps.iter().zip(Programs::on_each(maps, score)?) {
        match score {
            Ok(score) => scores.push(score),
            Err(why) => {
                eprintln!("{reader} cannot read {map} and is scored without it: {}", why.lines().last().unwrap_or_default());
                unread.push(map.to_string());
                last = Some(why);
            }
        }
    }
    match last {
        Some(why) if scores.is_empty() => Err(why.into()),
        _ => Ok((scores, unread)),
    }
}

/// A map's seconds by step, for each reader.
pub(crate) struct Timed {
    map: Map,
    /// Nodes and links that the first reader, ours, found.
    nodes: usize,
    links: usize,
    seconds: [serde_json::Map<String, Value>; 2],
}

impl Timed {
    fn total(&self, reader: Reader) -> f64 {
        self.seconds[reader as usize].get("total").and_then(Value::as_f64).unwrap_or(f64::NAN)
    }

    fn to_json(&self) -> Value {
        json!({
            "maps": self.map.kind.to_string(), "style": self.map.style, "pixels": self.map.size, "nodes": self.nodes,
            "links": self.links, "veduta": self.seconds[0], "peer": self.seconds[1],
            "ratio": self.total(Reader::Peer) / self.total(Reader::Veduta),
        })
    }
}

/// Times both readers in turn on maps of every size, and prints the tables.
fn timed(bench: &SurveyBench, programs: &Programs) -> Result<Vec<Timed>, Failure> {
    let mut rows = Vec::new();
    let kinds = [Kind::Plain, Kind::Hard];
    for map in
        kinds.into_iter().flat_map(|kind| bench.timed.iter().map(move |&size| Map { style: "old", seed: bench.seed, size, kind }))
    {
        let mut runs = [Vec::new(), Vec::new()];
        let (mut nodes, mut links) = (0, 0);
        for _ in 0..bench.repeat.max(1) {
            for reader in Reader::ALL {
                let run = programs.read(&map, reader)?;
                if reader == Reader::Veduta {
                    (nodes, links) = programs.found(&map, reader)?;
                }
                runs[reader as usize].push(run);
            }
        }
        let seconds = runs.map(|runs| median_seconds(&runs));
        rows.push(Timed { map, nodes, links, seconds });
    }
    for kind in kinds {
        let of_kind: Vec<&Timed> = rows.iter().filter(|row| row.map.kind == kind).collect();
        let Some(first) = of_kind.first() else { continue };
        let names: Vec<&str> = STEPS.into_iter().filter(|step| first.seconds[0].contains_key(*step)).collect();
        println!("| {kind}, milliseconds | nodes | links | {} | peer | ratio |", names.join(" | "));
        println!("|---|---|---|{}---|---|", "---|".repeat(names.len()));
        for row in of_kind {
            let ms = |step: &str| row.seconds[0].get(step).and_then(Value::as_f64).unwrap_or(0.0) * 1e3;
            let cells: Vec<String> = names.iter().map(|step| format!("{:.1}", ms(step))).collect();
            let (ours, peer) = (row.total(Reader::Veduta), row.total(Reader::Peer));
            println!(
                "| {} px | {} | {} | {} | {:.1} | {:.1} |",
                row.map.size,
                row.nodes,
                row.links,
                cells.join(" | "),
                peer * 1e3,
                peer / ours
            );
        }
        println!();
    }
    Ok(rows)
}
