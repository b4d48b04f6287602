mod adopt;
mod bench;
mod beside;
mod check;
mod city_named;
mod export;
mod inspect;
mod map;
mod places;
mod report;
mod serve;
mod source;
mod tour;
mod tour_check;
mod tour_notes;
mod town;
mod town_ground;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anstream::{eprintln, println};
use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use veduta_bake::{BakeSettings, ExportSettings, Planned, Stage, bake_input, cell_edits, lay_on_ground, plan, survey_bare};
use veduta_city::file;
use veduta_survey::{GeoJsonSettings, to_geojson};

use report::report;
use source::Source;

/// What every command may fail with: a message that names the file and the fix.
pub(crate) type Failure = Box<dyn std::error::Error>;

/// Turns maps into cities you can walk through.
#[derive(Parser)]
#[command(name = "veduta-bake", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// No progress bar and no list of findings.
    #[arg(long, global = true)]
    quiet: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Turn a map into a city graph; edits in `X.graph.overrides.ron` stay there and are applied when it is grown.
    Survey {
        #[command(flatten)]
        source: Source,
        /// Where to write the graph.
        #[arg(short, long)]
        output: PathBuf,
        /// Where to write the graph as GeoJSON too, in plan metres.
        #[arg(long, value_name = "FILE")]
        geojson: Option<PathBuf>,
        /// Write GeoJSON in degrees of longitude and latitude.
        #[arg(long, requires = "geojson")]
        degrees: bool,
        /// Print the seconds that each step took on a picture of a map, as one line of JSON.
        #[arg(long)]
        timings: bool,
    },
    /// Grow a city graph into a plan.
    Grow {
        #[command(flatten)]
        source: Source,
        /// Where to write the plan.
        #[arg(short, long)]
        output: PathBuf,
        /// Seed instead of the graph's own.
        #[arg(long)]
        seed: Option<u64>,
    },
    /// Bake a map, graph, plan or scene folder to a city.
    Bake {
        #[command(flatten)]
        source: Source,
        /// The city's directory; beside the input if not given.
        #[arg(short, long)]
        output: Option<PathBuf>,
        /// Seed instead of the graph's own.
        #[arg(long)]
        seed: Option<u64>,
        /// Print figures as one line of JSON.
        #[arg(long)]
        json: bool,
        /// List every finding instead of the first of each kind.
        #[arg(long)]
        findings: bool,
    },
    /// Look into a baked city: figures, and whether every part of it is whole.
    Inspect {
        /// City directory or URL.
        city: String,
        /// Print figures as JSON.
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        proof: inspect::Proving,
    },
    /// Check RON files: graphs, overrides, plans, styles, and tours against their city.
    Check {
        /// The files.
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Of a tour that can be played, also tell how long each of its steps takes.
        #[arg(long)]
        steps: bool,
    },
    /// List the places of a city, as tours name them: where they lie, and what its guide calls them.
    Places {
        /// The city: a baked one, a map, graph, plan or scene folder.
        city: PathBuf,
    },
    /// Draw the map of a baked city, plan, graph or map for print, as SVG or PNG.
    Map {
        #[command(flatten)]
        source: Source,
        /// Where to write it: .svg or .png.
        #[arg(short, long)]
        output: PathBuf,
        #[command(flatten)]
        wishes: Box<map::Wishes>,
    },
    /// Write a plan, graph or map as binary glTF, with named houses, façades and objects, for modellers and other engines; or a
    /// file of monuments.
    Export {
        #[command(flatten)]
        source: Source,
        /// Of a file of monuments, this one alone.
        #[arg(long, value_name = "NAME")]
        monument: Option<String>,
        /// A parameter of the monument, as in height=20; may be given several times.
        #[arg(long, value_name = "NAME=NUMBER", value_parser = export::parameter)]
        with: Vec<(String, f64)>,
        /// Where to write the model (.glb), or with --by-cell the folder of models.
        #[arg(short, long)]
        output: PathBuf,
        /// Write a model for each cell of the city, with the textures that they share and a list of them.
        #[arg(long, conflicts_with = "monument")]
        by_cell: bool,
        /// Write this house alone, by its name or id, to change it in a modeller and `adopt` it; may be given several times.
        #[arg(long, value_name = "NAME", conflicts_with_all = ["monument", "by_cell"])]
        house: Vec<String>,
        /// Pixels a side of each texture: 16 to 1024.
        #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=1024))]
        texture: u32,
    },
    /// Take houses back that were changed in a 3D modeller: models beside the map's overrides, which name them from then on.
    Adopt {
        #[command(flatten)]
        source: Source,
        /// The city, or houses of it, as `export` wrote it and a modeller changed it (.glb).
        #[arg(long, value_name = "FILE")]
        model: PathBuf,
    },
    /// Take tours to Google Earth and back (KML).
    #[command(subcommand)]
    Tour(tour::TourCommand),
    /// Measure this program beside its peers.
    #[command(subcommand)]
    Bench(Bench),
    /// Serve a city over HTTP on this machine.
    Serve {
        /// City directory.
        city: PathBuf,
        /// Port; 0 takes a free one.
        #[arg(long, default_value_t = 8080)]
        port: u16,
    },
}

/// What can be measured.
#[derive(Subcommand)]
enum Bench {
    /// Survey drawn maps whose streets are known: how true, and how fast.
    Survey(bench::SurveyBench),
    /// Thin maps and random bitmaps: whether each pixel is as OpenCV has it, and how fast.
    Thinning(bench::ThinningBench),
    /// Cut a city into cells and find their visible sets: how fast, and how that grows with the city.
    Cells(bench::CellsBench),
    /// Grow a city and make its meshes: how fast.
    Growth(bench::GrowthBench),
    /// Make all meshes of a city from its packets: how fast, and from which bandwidth on ready ones would come sooner.
    Meshes(bench::MeshesBench),
    /// Make the pictures of painted façades ready for a graphics card: how long one core takes.
    Facades(bench::FacadesBench),
    /// Find the straight skeletons of footprints: how fast, and whether each has one.
    Roofs(bench::RoofsBench),
}

/// Runs the program: 0 done, 1 failed with a message, 2 wrong usage.
pub(crate) fn run() -> ExitCode {
    let arguments = Arguments::parse();
    match command(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("veduta-bake: {error}");
            ExitCode::FAILURE
        }
    }
}

fn command(arguments: Arguments) -> Result<(), Failure> {
    let quiet = arguments.quiet;
    match arguments.command {
        Command::Survey { source, output, geojson, degrees, timings } => {
            let began = Instant::now();
            let mut extent_m = None;
            let mut seconds = Vec::new();
            let input = source.input()?;
            let (graph, findings) = match &input.raster {
                Some(raster) => {
                    let mut since = began;
                    let survey = raster.survey(&input.path, &mut |step| {
                        let now = Instant::now();
                        seconds.push((step, (now - since).as_secs_f64()));
                        since = now;
                    })?;
                    if survey.is_guessed {
                        let path = legend_beside(&output);
                        file::write_text(&survey.legend_ron, &path)?;
                        println!("{}: the legend as guessed; correct it and give it by --legend", path.display());
                    }
                    extent_m = survey.extent_m;
                    let (mut graph, mut findings) = (survey.graph, survey.findings);
                    findings.extend(lay_on_ground(&mut graph, &input.heights)?);
                    (graph, findings)
                }
                None => survey_bare(&input)?,
            };
            let surveyed = began.elapsed();
            file::write(&graph, &output)?;
            if let Some(path) = geojson {
                let settings = GeoJsonSettings { degrees, extent_m };
                file::write_text(&to_geojson(&graph, &settings), &path)?;
            }
            if timings {
                seconds.push(("total", seconds.iter().filter(|(step, _)| *step != "decode").map(|(_, s)| s).sum()));
                seconds.push(("write", (began.elapsed() - surveyed).as_secs_f64()));
                let steps: serde_json::Map<_, _> = seconds.into_iter().map(|(step, s)| (step.to_owned(), s.into())).collect();
                println!("{}", serde_json::Value::Object(steps));
            }
            report(&findings, quiet, false);
            println!(
                "{}: {} links, {} buildings, {} places",
                output.display(),
                graph.links.len(),
                graph.buildings.len(),
                graph.places.len()
            );
        }
        Command::Grow { source, output, seed } => {
            let planned = planned(&source, seed, quiet)?;
            file::write(&planned.plan, &output)?;
            println!("{}: {} houses", output.display(), planned.plan.houses.len());
        }
        Command::Bake { source, output, seed, json, findings } => {
            crate::allocator::keep_no_memory();
            bake_city(&source, output, seed, quiet, json, findings)?;
        }
        Command::Inspect { city, json, proof } => inspect::inspect(&city, json, &proof)?,
        Command::Check { files, steps } => check::check(&files, steps)?,
        Command::Places { city } => places::list(&city)?,
        Command::Map { source, output, wishes } => map::map(&source, &output, &wishes, quiet)?,
        Command::Export { source, output, by_cell, house, monument, with, texture } => {
            let settings = ExportSettings { texture_px: texture };
            match source.only().and_then(|path| Some((path, check::as_monuments(path)?))) {
                Some((path, _)) if by_cell || !house.is_empty() => {
                    return Err(format!("{}: monuments have no cells and are no houses", path.display()).into());
                }
                Some((path, read)) => export::monuments((path, &read?.0), monument.as_deref(), with, &settings, &output)?,
                None if by_cell => {
                    let edits = cell_edits(&source.input()?.path)?;
                    export::cells(&planned(&source, None, quiet)?.plan, &edits, &settings, &output, quiet)?;
                }
                None => export::city(&export::only(planned(&source, None, quiet)?.plan, &house)?, &settings, &output)?,
            }
        }
        Command::Adopt { source, model } => adopt::take_back(&source.input()?, &model, quiet)?,
        Command::Tour(command) => tour::tour(&command, quiet)?,
        Command::Bench(Bench::Survey(survey)) => bench::survey(&survey)?,
        Command::Bench(Bench::Thinning(thinning)) => bench::thinning(&thinning)?,
        Command::Bench(Bench::Cells(cells)) => bench::cells(&cells)?,
        Command::Bench(Bench::Growth(growth)) => bench::growth(&growth)?,
        Command::Bench(Bench::Meshes(meshes)) => bench::meshes(&meshes)?,
        Command::Bench(Bench::Facades(facades)) => bench::facades(&facades)?,
        Command::Bench(Bench::Roofs(roofs)) => bench::roofs(&roofs)?,
        Command::Serve { city, port } => serve::serve(&city, port)?,
    }
    Ok(())
}

fn planned(source: &Source, seed: Option<u64>, quiet: bool) -> Result<Planned, Failure> {
    let settings = BakeSettings { seed, ..BakeSettings::default() };
    let planned = plan(&source.input()?, &settings, &mut |_| ())?;
    report(&planned.findings, quiet, false);
    Ok(planned)
}

fn bake_city(
    source: &Source,
    output: Option<PathBuf>,
    seed: Option<u64>,
    quiet: bool,
    json: bool,
    all: bool,
) -> Result<(), Failure> {
    let output = output.unwrap_or_else(|| city_beside(source.path()));
    let settings = BakeSettings { seed, ..BakeSettings::default() };
    let bar = if quiet || json { ProgressBar::hidden() } else { ProgressBar::new(Stage::ALL.len() as u64) };
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {msg} ({elapsed})") {
        bar.set_style(style);
    }
    let began = Instant::now();
    let mut spans: Vec<(Stage, f64)> = Vec::new();
    let input = source.input()?;
    let baked = bake_input(&input, &output, &settings, &mut |stage| {
        bar.set_position(spans.len() as u64);
        bar.set_message(stage.to_string());
        spans.push((stage, began.elapsed().as_secs_f64()));
    });
    bar.finish_and_clear();
    let baked = baked?;
    let total_s = began.elapsed().as_secs_f64();
    let ends = spans.iter().skip(1).map(|s| s.1).chain([total_s]);
    let seconds: Vec<(Stage, f64)> = spans.iter().zip(ends).map(|(&(stage, from), to)| (stage, to - from)).collect();
    if json {
        let seconds: serde_json::Map<String, serde_json::Value> =
            seconds.into_iter().map(|(stage, s)| (format!("{stage:?}").to_lowercase(), s.into())).collect();
        let line = serde_json::json!({
            "city": output, "stats": baked.stats, "findings": baked.findings.len(), "seconds": seconds, "total_s": total_s,
        });
        println!("{line}");
    } else {
        report(&baked.findings, quiet, all);
        let stages: Vec<String> = seconds.iter().map(|(stage, s)| format!("{stage} {s:.1}")).collect();
        println!("{}: {}; {total_s:.1} s ({})", output.display(), baked.stats, stages.join(", "));
    }
    Ok(())
}

/// `X.legend.ron` beside a graph `X.…`.
fn legend_beside(graph: &Path) -> PathBuf {
    let name = graph.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(".graph.ron").or_else(|| name.strip_suffix(".ron")).unwrap_or(&name).to_owned();
    graph.with_file_name(format!("{stem}.legend.ron"))
}

/// `X.city` beside an input `X.…`.
fn city_beside(input: &Path) -> PathBuf {
    let overrides = veduta_bake::overrides_beside(input);
    let name = overrides.file_name().unwrap_or_default().to_string_lossy().replace(".graph.overrides.ron", ".city");
    input.with_file_name(name)
}
