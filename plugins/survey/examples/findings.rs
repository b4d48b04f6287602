//! Surveys maps and prints what came out and every finding: `cargo run -p veduta-survey --example findings -- MAP…`

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for file in std::env::args().skip(1) {
        let start = Instant::now();
        let result = std::fs::read(&file).map_err(|e| format!("{file}: {e}"));
        match result.and_then(|bytes| veduta_survey::survey_osm(&bytes, &file).map_err(|e| e.to_string())) {
            Ok(survey) => {
                let graph = &survey.graph;
                println!(
                    "{file}: \"{}\" around {:?}, {} links, {} buildings, {} squares, {} blocks, {} objects, {} places, {} ms, start {:?}",
                    graph.name,
                    graph.anchor,
                    graph.links.len(),
                    graph.buildings.len(),
                    graph.squares.len(),
                    graph.blocks.len(),
                    graph.objects.len(),
                    graph.places.len(),
                    start.elapsed().as_millis(),
                    graph.start,
                );
                survey.findings.iter().for_each(|finding| println!("  {finding}"));
            }
            Err(message) => {
                eprintln!("{message}");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}
