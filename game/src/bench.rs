//! `veduta bench`: figures that anyone can repeat, as lines of JSON.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anstream::println;
use bevy::asset::AssetPlugin;
use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use cpu_time::ThreadTime;
use veduta::buildings::{BuildSettings, Building, BuildingsPlugin};
use veduta::city::{Tour, file};
use veduta::ecs::{Awaited, CellEntered, StandingCells};
use veduta::facade::FacadePlugin;
use veduta::prelude::*;
use veduta::streaming::{Event, Fetching, Journal, StreamingStats, What};
use veduta::tour::TourState;
use veduta_bake::{BakeSettings, Input, bake, enlarged, files_of_overrides, overrides_beside, survey};
use veduta_store::CityStats;

use crate::studio::Size;
use crate::{Failure, cities};

mod entities;
mod frames;
mod stream;
mod visitor;

/// What to measure.
#[derive(clap::ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bench {
    /// Bake time, and bytes a house by level.
    Bake,
    /// The sample tour in the city and in one ten times as large: entities, CPU time a frame by system set, bytes.
    Walk,
    /// What streaming costs the main thread and the line, along the sample tour and on a run through a town of 50,000 houses, beside the
    /// naive way; and whether a city's size matters.
    Stream,
    /// What a frame costs the processor before it is drawn, beside a city of the same houses with an entity for each of their parts.
    Entities,
    /// What the visitor's interface (panels, map, guide, tour) costs the main thread in a frame, along the sample tour and on a run through a
    /// town of 50,000 houses; and what search and ways cost in towns of that size.
    Visitor,
    /// How many frames of the sample tour are drawn in a second, for each profile.
    Frames,
}

/// How many times larger the large city is.
const TIMES: (u32, u32) = (5, 2);
/// Longest that a city is waited for.
const PATIENCE: Duration = Duration::from_secs(60);
/// Nobody walks so far from frame to frame, metres.
const LEAP_M: f64 = 3.0;
/// Frames a second at which the tour is walked.
const FPS: f64 = 30.0;

/// Measures and prints.
///
/// # Errors
/// If the city cannot be baked or the tour not be played.
pub fn bench(what: Bench, city: Option<&str>, json: bool, size: Size) -> Result<(), Failure> {
    let scene = city.map_or_else(cities::sample_scene, PathBuf::from);
    match what {
        _ if json && what != Bench::Stream => Err("--json goes with `stream`; the others print lines of JSON as they are".into()),
        Bench::Bake => bench_bake(&scene),
        Bench::Walk => bench_walk(&scene),
        Bench::Stream => stream::stream(&scene, json),
        Bench::Entities => entities::entities(&scene),
        Bench::Visitor => visitor::visitor(&scene),
        Bench::Frames => frames::frames(&scene, size),
    }
}

fn line(name: &str, value: f64, unit: &str) {
    println!("{}", serde_json::json!({ "name": name, "value": value, "unit": unit, "peer": null, "peer_value": null }));
}

fn workplace(name: &str) -> Result<PathBuf, Failure> {
    let dir = std::env::temp_dir().join(format!("veduta-bench-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&dir).map_err(|e| format!("{}: {e}", dir.display()))?;
    Ok(dir)
}

fn bench_bake(scene: &Path) -> Result<(), Failure> {
    let dir = workplace("bake")?;
    let mut seconds = Vec::new();
    let mut last = None;
    for _ in 0..5 {
        let began = Instant::now();
        last = Some(bake(scene, &dir.join("b.city"), &BakeSettings::default(), &mut |_| ())?);
        seconds.push(began.elapsed().as_secs_f64());
    }
    if let Some(baked) = last {
        line("bake_s", median(&mut seconds), "s");
        line("houses", baked.stats.houses as f64, "1");
        for level in veduta::city::Level::ALL {
            if let Some(bytes) = baked.stats.bytes_per_house(level).filter(|b| *b > 0.0) {
                line(&format!("bytes_per_house_level{}", level as u8), bytes, "B");
            }
        }
    }
    std::fs::remove_dir_all(&dir)?;
    Ok(())
}

fn bench_walk(scene: &Path) -> Result<(), Failure> {
    let dir = workplace("walk")?;
    let tour: Tour = file::read(&cities::sample_scene().join("royal_route.tour.ron"))?;
    let mut medians = Vec::new();
    for (name, times) in [("sample", (1, 1)), ("large", TIMES)] {
        let (city, stats) = large(scene, &dir, times, name)?;
        let mut walk = Walk::run(&city, &tour, Way::Streamed)?;
        line(&format!("{name}_houses"), stats.houses as f64, "1");
        line(&format!("{name}_entities_max"), f64::from(walk.entities), "1");
        line(&format!("{name}_frame_us"), median(&mut walk.frames), "us");
        for (set, times) in SETS.iter().zip(&mut walk.sets) {
            line(&format!("{name}_{}_us", format!("{set:?}").to_lowercase()), median(times), "us");
        }
        line(&format!("{name}_tour_bytes"), walk.bytes as f64, "B");
        medians.push(median(&mut walk.frames));
    }
    line("frame_ratio_10x", medians[1] / medians[0], "1");
    std::fs::remove_dir_all(&dir)?;
    Ok(())
}

/// The scene, or one with so many copies of it along and across, baked.
fn large(scene: &Path, dir: &Path, times: (u32, u32), name: &str) -> Result<(PathBuf, CityStats), Failure> {
    let city = dir.join(format!("{name}.city"));
    if times == (1, 1) {
        let stats = bake(scene, &city, &BakeSettings::default(), &mut |_| ())?.stats;
        return Ok((city, stats));
    }
    let input = Input::of(scene)?;
    let (graph, ..) = survey(&input)?;
    let source = dir.join(format!("{name}.graph.ron"));
    file::write(&enlarged(&graph, times.0, times.1), &source)?;
    let overrides = overrides_beside(&input.path);
    if overrides.exists() {
        // Edits are applied already; styles still count.
        let mut kept: veduta::city::GraphOverrides = file::read(&overrides)?;
        kept.edits.clear();
        file::write(&kept, &overrides_beside(&source))?;
        // What it names by paths from its folder goes along.
        let (from, to) = (overrides.parent().unwrap_or(Path::new("")), source.parent().unwrap_or(Path::new("")));
        for named in files_of_overrides(&kept, &overrides) {
            let copy = to.join(named.strip_prefix(from).unwrap_or(&named));
            copy.parent().map_or(Ok(()), std::fs::create_dir_all)?;
            std::fs::copy(&named, &copy)?;
        }
    }
    let stats = bake(&source, &city, &BakeSettings::default(), &mut |_| ())?.stats;
    Ok((city, stats))
}

/// The middle value; 0 of none.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

const SETS: [VedutaSystems; 4] = [VedutaSystems::Steer, VedutaSystems::Stream, VedutaSystems::Build, VedutaSystems::Show];

/// How a city comes to the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// As streaming does it.
    Streamed,
    /// As streaming does it, with all that a visitor sees over the picture.
    Visited,
    /// The same, with the large map over it.
    Mapped,
    /// As streaming does it, with all that lives.
    Lived,
    /// All that is so near, in metres, whatever stands between; read and built on the main thread, as soon as it is wanted.
    Naive { around_m: f64 },
}

/// Figures of one walk along the tour: microseconds of the main thread's time for each frame.
struct Walk {
    frames: Vec<f64>,
    /// How many of them came before the first leap.
    before_leap: usize,
    sets: [Vec<f64>; 4],
    /// For each cell that was walked into, frames until its level 1 stood.
    late_frames: Vec<u32>,
    entities: u32,
    /// Of all that was read, each thing once.
    bytes: u64,
    /// The same of index, regions, houses, overviews and the four levels.
    bytes_by_kind: [u64; 8],
    /// Most bytes that stood at once: content as it was sent, and the meshes made of it.
    memory: u64,
}

/// CPU time of the thread at the borders of the system sets.
#[derive(Resource, Default)]
struct Marks(Vec<Duration>);

impl Walk {
    /// Plays the tour without drawing, on one thread, and measures its CPU time.
    fn run(city: &Path, tour: &Tour, way: Way) -> Result<Self, Failure> {
        let mut app = quiet_app(city, way);
        let began = Instant::now();
        while app.world().get_resource::<City>().is_none_or(|c| c.overviews.iter().next().is_none()) {
            if began.elapsed() > PATIENCE {
                return Err(format!("{}: the city did not open in {} s", city.display(), PATIENCE.as_secs()).into());
            }
            app.update();
            std::thread::sleep(Duration::from_millis(1));
        }
        app.world_mut().write_message(TourCommand::Give(Box::new(tour.clone())));
        app.update();
        let began = Instant::now();
        while app.world().resource::<TourPlayer>().state() == TourState::Waiting && began.elapsed() < PATIENCE {
            app.update();
            std::thread::sleep(Duration::from_millis(1));
        }
        let player = app.world().resource::<TourPlayer>();
        let Some(duration_s) = player.tour().map(|t| t.duration_s()) else {
            return Err(player.error().unwrap_or("the tour did not start").to_owned().into());
        };
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / FPS)));
        let mut walk = Self {
            frames: Vec::new(),
            before_leap: 0,
            sets: Default::default(),
            late_frames: Vec::new(),
            entities: 0,
            bytes: 0,
            bytes_by_kind: [0; 8],
            memory: 0,
        };
        let mut entered = app.world().resource::<Messages<CellEntered>>().get_cursor();
        let mut waiting: Vec<(u32, u32)> = Vec::new();
        let (mut here, mut cell, mut is_leap_over) = (DVec2::INFINITY, None, false);
        for frame in 0..(duration_s * FPS) as u32 {
            if frame % FPS as u32 == 0 {
                walk.memory = walk.memory.max(memory(app.world()));
            }
            app.world_mut().resource_mut::<Marks>().0.clear();
            // The tour goes on whatever has come, so that what is late is seen to be.
            app.world_mut().resource_mut::<Awaited>().ahead = 0;
            let began = ThreadTime::now();
            app.update();
            walk.frames.push(began.elapsed().as_secs_f64() * 1e6);
            let marks = &app.world().resource::<Marks>().0;
            for (times, pair) in walk.sets.iter_mut().zip(marks.windows(2)) {
                times.push((pair[1].saturating_sub(pair[0])).as_secs_f64() * 1e6);
            }
            walk.entities = walk.entities.max(app.world().entities().count_spawned());
            let eye = app.world_mut().query::<&Eye>().iter(app.world()).next().map_or(here, |eye| eye.plan_pos);
            // Who leaps comes through no portal.
            let has_leapt = core::mem::replace(&mut here, eye).distance(eye) > LEAP_M;
            is_leap_over |= has_leapt && frame > 0;
            walk.before_leap += usize::from(!is_leap_over);
            for message in entered.read(app.world().resource::<Messages<CellEntered>>()) {
                let from = core::mem::replace(&mut cell, message.cell);
                waiting.extend(message.cell.filter(|_| from.is_some() && !has_leapt).map(|cell| (cell, 0)));
            }
            let standing = app.world().resource::<StandingCells>();
            waiting.retain(|&(cell, frames)| {
                let stands = standing.levels(cell).has(veduta::city::Level::One);
                if stands {
                    walk.late_frames.push(frames);
                }
                !stands
            });
            waiting.iter_mut().for_each(|(_, frames)| *frames += 1);
        }
        walk.late_frames.extend(waiting.into_iter().map(|(_, frames)| frames));
        // What came twice would have been kept, on the way from a web server.
        let mut came = std::collections::BTreeMap::new();
        for entry in app.world().resource::<Journal>().entries() {
            if let Event::Arrived { what, bytes } = entry.event {
                came.insert(what, bytes);
            }
        }
        for (what, bytes) in came {
            let kind = match what {
                What::Index | What::Leaf(_) => 0,
                What::Region(_) => 1,
                What::Houses(_) => 2,
                What::Overview(_) => 3,
                What::Packet { level, .. } => 4 + level.index(),
                // None are asked for.
                What::File(_) => continue,
            };
            walk.bytes_by_kind[kind] += bytes;
        }
        walk.bytes = walk.bytes_by_kind.iter().sum();
        Ok(walk)
    }

    /// What was read, by kind.
    fn told_bytes(&self) -> String {
        let [index, regions, houses, overviews, one, two, ..] = self.bytes_by_kind;
        format!(
            "index {index} B, regions {regions} B, houses {houses} B, overviews {overviews} B, level 1 {one} B, level 2 {two} B"
        )
    }

    /// The frames in which streaming and building together took longest: number, what each took, microseconds.
    fn told_worst(&self) -> String {
        let mut frames: Vec<(usize, f64)> = self.streaming().enumerate().collect();
        frames.sort_by(|a, b| b.1.total_cmp(&a.1));
        let told = |&(n, _): &(usize, f64)| format!("{n}: {:.0} + {:.0}", self.sets[1][n], self.sets[2][n]);
        frames.iter().take(6).map(told).collect::<Vec<_>>().join(", ")
    }

    /// What streaming and building together took of each frame.
    fn streaming(&self) -> impl Iterator<Item = f64> {
        self.sets[1].iter().zip(&self.sets[2]).map(|(stream, build)| stream + build)
    }
}

/// Bytes of the content that is loaded, as it was sent, and of all meshes, whoever made them: not as streaming counts them.
fn memory(world: &World) -> u64 {
    let mesh = |mesh: &Mesh| {
        let corners = mesh.indices().map_or(0, |indices| indices.len() * 4);
        mesh.count_vertices() as u64 * mesh.get_vertex_size() + corners as u64
    };
    let meshes: u64 = world.resource::<Assets<Mesh>>().iter().map(|(_, of)| mesh(of)).sum();
    meshes + world.resource::<StreamingStats>().bytes_loaded
}

/// All that runs on the main thread of a walk, without drawing; reading and building happen on their threads, but in the naive way.
fn quiet_app(city: &Path, way: Way) -> App {
    let mut app = App::new();
    let (fetching, building) = match way {
        Way::Streamed | Way::Visited | Way::Mapped | Way::Lived => (Fetching::Threads(2), Building::Pool),
        Way::Naive { .. } => (Fetching::Inline, Building::Inline),
    };
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), bevy::transform::TransformPlugin))
        .init_asset::<Mesh>()
        .add_plugins((
            veduta::ecs::EcsPlugin,
            StreamingPlugin { fetching },
            BuildingsPlugin { building },
            FacadePlugin::default(),
            SkyPlugin,
        ))
        .insert_resource(OpenCity(city.display().to_string()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(1)))
        .insert_resource(Journal::keeping(usize::MAX))
        .init_resource::<Marks>()
        .add_systems(Update, mark.before(VedutaSystems::Steer))
        .add_systems(Update, mark.after(VedutaSystems::Steer).before(VedutaSystems::Stream))
        .add_systems(Update, mark.after(VedutaSystems::Stream).before(VedutaSystems::Build))
        .add_systems(Update, mark.after(VedutaSystems::Build).before(VedutaSystems::Show))
        .add_systems(Update, mark.after(VedutaSystems::Show))
        .edit_schedule(Update, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        });
    for schedule in [PreUpdate.intern(), PostUpdate.intern()] {
        app.edit_schedule(schedule, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        });
    }
    if matches!(way, Way::Visited | Way::Mapped) {
        visitor::add_interface(&mut app);
    } else {
        app.add_plugins((TourPlugin { interface: false }, GuidePlugin { interface: false }));
    }
    if way == Way::Lived {
        visitor::add_life(&mut app);
    }
    if let Way::Naive { around_m } = way {
        let mut settings = app.world_mut().resource_mut::<StreamingSettings>();
        (settings.flying_from_m, settings.level_2_m) = (0.0, around_m);
        settings.overview_flying_m = settings.overview_m;
        settings.memory_cap_bytes = u64::MAX;
        (settings.packets_a_frame, settings.bytes_a_frame) = (usize::MAX, u64::MAX);
        app.insert_resource(BuildSettings {
            vertices_a_frame: usize::MAX,
            in_the_making: usize::MAX,
            districts_m: 0.0,
            relief_m: 0.0,
        });
    }
    let viewer = app.world_mut().spawn((Viewer, Transform::default(), Projection::default())).id();
    if matches!(way, Way::Visited | Way::Mapped) {
        visitor::open_window(&mut app, viewer);
    }
    if way == Way::Mapped {
        visitor::open_map(&mut app);
    }
    app
}

fn mark(mut marks: ResMut<Marks>) {
    marks.0.push(ThreadTime::now().as_duration());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A resource that a system asks for and nobody brings would end a benchmark with its first frame.
    #[test]
    fn every_way_of_walking_has_what_it_asks_for() {
        for way in [Way::Streamed, Way::Visited, Way::Mapped, Way::Lived, Way::Naive { around_m: 100.0 }] {
            let mut app = quiet_app(Path::new("there is no such city"), way);
            (0..3).for_each(|_| app.update());
            let marks = app.world().resource::<Marks>().0.len();
            assert_eq!(marks, 3 * 5, "{way:?}: three frames ran to their end");
        }
    }
}
