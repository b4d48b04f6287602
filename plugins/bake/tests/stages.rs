//! Stage goldens: what every stage makes of tiny places drawn by hand and of one real extract.
//!
//! `VEDUTA_BLESS=1` writes the goldens anew. Where something else comes out than is written there, it is left beside the golden
//! as `*.actual`, and the message tells the first line that differs. Plans and cells lie on the grid, and what a graph holds comes
//! from arithmetic that is the same everywhere: the goldens hold on every platform.

mod shared;
mod summary;

use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, cut, plan, survey};
use veduta_city::{CityGraph, Finding, file};

fn places() -> PathBuf {
    PathBuf::from("tests/places")
}

/// What the stages make of one input, as text by golden.
struct Stages {
    graph: String,
    findings: String,
    plan: String,
    cells: String,
    packets: String,
}

fn stages(path: &Path) -> Stages {
    let input = Input::of(path).unwrap_or_else(|e| panic!("{e}"));
    let (graph, _, _) = survey(&input).unwrap_or_else(|e| panic!("{e}"));
    let settings = BakeSettings::default();
    let planned = plan(&input, &settings, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let (cells, more) = cut(&planned.plan, &[], &settings);
    let findings: Vec<Finding> = planned.findings.into_iter().chain(more).collect();
    Stages {
        graph: file::to_text::<CityGraph>(&graph).unwrap_or_else(|e| panic!("{e}")),
        findings: findings.iter().map(|f| format!("{f}\n")).collect(),
        plan: summary::plan(&planned.plan),
        cells: summary::cells(&cells),
        packets: summary::packets(&planned.plan, &cells),
    }
}

/// Compares texts with goldens, or writes them; fails naming every golden that differs.
fn compare(dir: &Path, texts: &[(&str, &str)]) {
    let is_blessing = std::env::var_os("VEDUTA_BLESS").is_some_and(|v| v != "0" && !v.is_empty());
    let mut mistakes = Vec::new();
    for (name, text) in texts {
        let golden = dir.join(name);
        let actual = dir.join(format!("{name}.actual"));
        let write = |path: &Path| std::fs::write(path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        if is_blessing {
            write(&golden);
        }
        let told = std::fs::read_to_string(&golden).unwrap_or_default().replace("\r\n", "\n");
        if told == *text {
            // None is there as a rule.
            let _ = std::fs::remove_file(&actual);
        } else {
            write(&actual);
            mistakes.push(format!("{}: {}", golden.display(), first_difference(&told, text)));
        }
    }
    assert!(mistakes.is_empty(), "{}\n(see the *.actual beside; VEDUTA_BLESS=1 writes the goldens anew)", mistakes.join("\n"));
}

/// The first line in which two texts differ.
fn first_difference(golden: &str, actual: &str) -> String {
    let (mut a, mut b) = (golden.lines(), actual.lines());
    for line in 1.. {
        match (a.next(), b.next()) {
            (None, None) => break,
            (golden, actual) if golden != actual => {
                let tell = |text: Option<&str>| text.map_or_else(|| "nothing more".to_owned(), |t| format!("`{}`", t.trim()));
                return format!("line {line} is {}, and {} comes out", tell(golden), tell(actual));
            }
            _ => {}
        }
    }
    "only the ends of lines differ".to_owned()
}

#[test]
fn the_crossroads_stay_what_they_are() {
    let dir = places().join("crossroads");
    let s = stages(&dir.join("crossroads.osm"));
    compare(
        &dir,
        &[
            ("graph.golden.ron", &s.graph),
            ("findings.golden.txt", &s.findings),
            ("plan.golden.txt", &s.plan),
            ("cells.golden.txt", &s.cells),
            ("packets.golden.txt", &s.packets),
        ],
    );
}

/// Compares what becomes of a place drawn as a graph.
fn compare_place(name: &str) {
    let dir = places().join(name);
    let s = stages(&dir.join(format!("{name}.graph.ron")));
    compare(
        &dir,
        &[
            ("findings.golden.txt", &s.findings),
            ("plan.golden.txt", &s.plan),
            ("cells.golden.txt", &s.cells),
            ("packets.golden.txt", &s.packets),
        ],
    );
}

#[test]
fn the_lane_is_built_up_the_same_way() {
    compare_place("lane");
}

#[test]
fn the_hillside_is_built_up_the_same_way() {
    compare_place("hillside");
}

#[test]
fn the_riverside_is_built_up_the_same_way() {
    compare_place("riverside");
}

#[test]
fn a_real_extract_stays_what_it_is() {
    let Some(data) = shared::data() else { return };
    let path = data.join("prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm");
    let s = stages(&path);
    let graph: CityGraph = file::parse(&s.graph, "karlovo_namesti").unwrap_or_else(|e| panic!("{e}"));
    let mut text = String::from("Counts and hashes of what each stage makes of Karlovo náměstí.\n");
    for (name, stage) in
        [("graph", &s.graph), ("findings", &s.findings), ("plan", &s.plan), ("cells", &s.cells), ("packets", &s.packets)]
    {
        let head: String =
            stage.lines().take_while(|line| line.starts_with("# ")).map(|line| format!("  {}\n", &line[2..])).collect();
        text += &format!("{name}: {} lines, {:016x}\n{head}", stage.lines().count(), summary::hash(stage));
    }
    text += &format!(
        "links {}, nodes {}, buildings {}, squares {}, blocks {}, objects {}, places {}\n",
        graph.links.len(),
        graph.nodes.len(),
        graph.buildings.len(),
        graph.squares.len(),
        graph.blocks.len(),
        graph.objects.len(),
        graph.places.len()
    );
    compare(&places(), &[("karlovo_namesti.golden.txt", &text)]);
}

#[test]
fn the_first_difference_is_found() {
    assert_eq!(first_difference("a\nb\nc\n", "a\nx\nc\n"), "line 2 is `b`, and `x` comes out");
    assert_eq!(first_difference("a\n", "a\nb\n"), "line 2 is nothing more, and `b` comes out");
}
