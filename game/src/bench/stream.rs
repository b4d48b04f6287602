//! `veduta bench stream`: what streaming costs the main thread and the line, beside the naive way.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anstream::{eprintln, println};
use bevy::math::DVec2;
use cpu_time::ThreadTime;
use veduta::city::{GridPos, Level, Step, Tour, Where, file};
use veduta_bake::{BakeSettings, bake};
use veduta_store::{DirReader, read_index, read_overview};

use super::{Walk, Way, large, line, median, workplace};
use crate::{Failure, cities};

/// A town of more than 50,000 houses, in words.
const TOWN: &str = "(name: \"Fifty thousand\", seed: 11, size_m: 4000, plan: Medieval(), squares: 30)";
/// How often both walks are made.
const WALKS: usize = 7;
/// How often walks that are compared are repeated at most.
const REPEAT: usize = 40;
/// They have settled when what their frames take at least has fallen by less than this share ...
const SETTLED: f64 = 0.01;
/// ... in so many rounds.
const SETTLED_ROUNDS: usize = 5;
/// Metres a second of the fast run through it.
const RUN_M_S: f64 = 8.0;
/// How far it leads, metres.
const RUN_M: f64 = 1_600.0;
/// A viewer of the naive way wants everything so near, metres.
const NAIVE_M: f64 = 400.0;
/// The sample city so many times, along and across, that it goes on on all sides of the walk as far as anything is asked for, overviews
/// included: what its walk is compared with in larger ones, as a walk along a city's edge asks for less.
const SURROUNDED: (u32, u32) = (3, 5);
/// Ten and a hundred times as large as that.
const TIMES: [(u32, u32, &str); 2] = [(15, 10, "10x"), (50, 30, "100x")];

/// Measures and prints, as one object of JSON or as lines of it.
///
/// # Errors
/// If a city cannot be baked or walked.
pub(super) fn stream(scene: &Path, json: bool) -> Result<(), Failure> {
    let dir = workplace("stream")?;
    let mut figures: Vec<(String, f64, &str)> = Vec::new();
    let mut tell = |name: &str, value: f64, unit: &'static str| {
        if !json {
            line(name, value, unit);
        }
        figures.push((name.to_owned(), value, unit));
    };
    let tour: Tour = file::read(&cities::sample_scene().join("royal_route.tour.ron"))?;

    let sample = dir.join("sample.city");
    let stats = bake(scene, &sample, &BakeSettings::default(), &mut |_| ())?.stats;
    let (town, run, houses) = fast_run(&dir, &tour)?;
    let walk = |n: usize| -> Result<[Walk; 2], Failure> {
        let both = [Walk::run(&sample, &tour, Way::Streamed)?, Walk::run(&town, &run, Way::Streamed)?];
        for (name, walk) in ["tour", "run"].into_iter().zip(&both) {
            eprintln!("longest frames of {name} {n}, streaming + building in µs: {}", walk.told_worst());
        }
        Ok(both)
    };
    let walks = (1..=WALKS).map(walk).collect::<Result<Vec<_>, Failure>>()?;
    let [small, fast] = &walks[WALKS - 1];
    eprintln!("the sample tour: {} frames; {}", small.frames.len(), small.told_bytes());
    eprintln!("a run of {RUN_M} m through {houses} houses: {} frames", fast.frames.len());
    let naive = Walk::run(&town, &run, Way::Naive { around_m: NAIVE_M })?;

    // Of the way where it is more. Of several walks the middle one counts: what the way asks for, it asks of all of them, and of some the machine
    // holds a frame up for milliseconds.
    let most = |of_walks: fn(&mut [f64]) -> f64, share: f64| {
        let took = |way: usize| walks.iter().map(|walk| within(walk[way].streaming(), share)).collect::<Vec<_>>();
        [0, 1].map(|way| of_walks(&mut took(way))).into_iter().fold(0.0, f64::max) / 1e3
    };
    tell("stream_cpu_p999_ms", most(median, 0.999), "ms");
    tell("stream_cpu_max_ms", most(median, 1.0), "ms");
    tell("stream_cpu_max_once_ms", most(|walks| walks.iter().copied().fold(0.0, f64::max), 1.0), "ms");
    // Beside what the machine itself makes of the same work.
    let [usual, longest, longest_once] = unevenness(WALKS, fast.frames.len());
    tell("same_work_ms", usual, "ms");
    tell("same_work_max_ms", longest, "ms");
    tell("same_work_max_once_ms", longest_once, "ms");
    let late = walks.iter().flatten().flat_map(|walk| &walk.late_frames).max().copied().unwrap_or(0);
    tell("level1_after_portal_frames", f64::from(late), "1");
    let worst = |walk: &Walk| walk.frames.iter().copied().fold(0.0, f64::max);
    let worst_before_leap = |walk: &Walk| walk.frames[..walk.before_leap].iter().copied().fold(0.0, f64::max);
    tell("worst_frame_ratio_vs_naive", worst(&naive) / worst(fast), "1");
    tell("worst_frame_ratio_before_leap", worst_before_leap(&naive) / worst_before_leap(fast), "1");
    tell("worst_frame_ms", worst(fast) / 1e3, "ms");
    tell("worst_frame_naive_ms", worst(&naive) / 1e3, "ms");
    // Without those of levels 3 and 4.
    tell("walk_bytes_before_level3", small.bytes_by_kind[..6].iter().sum::<u64>() as f64, "B");
    tell("walk_bytes", small.bytes as f64, "B");
    // What is told of places, the tours, the life and the sounds, which the program asks for at the start, too.
    let opened = read_index(&DirReader::new(&sample)?)?;
    let told = opened.files.iter().filter(|file| file.path.ends_with(".ron"));
    tell("files_bytes", told.map(|file| f64::from(file.blob.bytes)).sum(), "B");
    for level in [Level::One, Level::Two] {
        let bytes = stats.bytes_per_house(level).unwrap_or(0.0);
        tell(&format!("bytes_per_house_level{}", level as u8), bytes, "B");
    }
    let (surrounded, stats) = large(scene, &dir, SURROUNDED, "surrounded")?;
    let houses = stats.houses;
    for (columns, rows, name) in TIMES {
        let (city, stats) = large(scene, &dir, (columns, rows), name)?;
        let (mut frames, mut bytes, mut memory, mut told) = ([Vec::new(), Vec::new()], 0.0, 0.0, Default::default());
        let mut rounds: Vec<[f64; 2]> = Vec::new();
        while rounds.len() < REPEAT && !settled(&rounds) {
            // In turn, so that a busy moment of the machine meets both.
            let small = Walk::run(&surrounded, &tour, Way::Streamed)?;
            let walk = Walk::run(&city, &tour, Way::Streamed)?;
            bytes = walk.bytes as f64 / small.bytes as f64;
            memory = walk.memory as f64 / small.memory as f64;
            told = [small.told_bytes(), walk.told_bytes()];
            frames.iter_mut().zip([small.frames, walk.frames]).for_each(|(least, frames)| take_least(least, frames));
            rounds.push(frames.clone().map(|mut least| median(&mut least)));
        }
        eprintln!("the sample tour in a city of {houses} houses: {}", told[0]);
        eprintln!("the sample tour in a city of {} houses: {}", stats.houses, told[1]);
        let [small, walk] = rounds.last().copied().unwrap_or_default();
        eprintln!("its frames take {walk:.0} µs, and {small:.0} µs in the other, the least of {} walks each", rounds.len());
        tell(&format!("frame_ratio_{name}"), walk / small, "1");
        tell(&format!("bytes_ratio_{name}"), bytes, "1");
        tell(&format!("memory_ratio_{name}"), memory, "1");
        std::fs::remove_dir_all(&city)?;
    }
    if json {
        let object = figures.into_iter().map(|(name, value, _)| (name, value.into())).collect();
        println!("{}", serde_json::Value::Object(object));
    }
    std::fs::remove_dir_all(&dir)?;
    Ok(())
}

/// Takes the least that each frame of a walk took: what a run has of the machine's other work, which may be half of it, another has not.
fn take_least(least: &mut Vec<f64>, frames: Vec<f64>) {
    if least.is_empty() {
        *least = frames;
    } else {
        least.iter_mut().zip(frames).for_each(|(least, frame)| *least = least.min(frame));
    }
}

/// Whether two walks' frames took about as much some rounds ago as they do now: more rounds would hardly find less.
fn settled(rounds: &[[f64; 2]]) -> bool {
    let before = rounds.len().checked_sub(1 + SETTLED_ROUNDS).map(|n| rounds[n]);
    let now = rounds.last().copied();
    before.zip(now).is_some_and(|(before, now)| before.into_iter().zip(now).all(|(before, now)| now > (1.0 - SETTLED) * before))
}

/// What the frames of a walk take at most, in so large a share of them; 0 of none.
fn within(frames: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut ascending: Vec<f64> = frames.collect();
    ascending.sort_by(f64::total_cmp);
    let n = (share * ascending.len() as f64).ceil() as usize;
    ascending.get(n.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// How uneven the machine is: what the same work takes of its thread after a nap, as a frame's does: its median, the middle one of the longest of
/// so many runs, and the longest of all, milliseconds.
fn unevenness(runs: usize, times: usize) -> [f64; 3] {
    const STEPS: u32 = 25_000;
    const NAP: Duration = Duration::from_micros(50);
    let table: Vec<u64> = (0..1 << 15).collect();
    let work = |seed: u64| {
        let step = |x: u64, _| x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(table[(x >> 49) as usize]);
        core::hint::black_box((0..STEPS).fold(seed, step));
    };
    let time = |seed: usize| {
        std::thread::sleep(NAP);
        let began = ThreadTime::now();
        work(seed as u64);
        began.elapsed().as_secs_f64() * 1e3
    };
    let took: Vec<Vec<f64>> = (0..runs).map(|_| (0..times).map(time).collect()).collect();
    let mut longest: Vec<f64> = took.iter().map(|run| within(run.iter().copied(), 1.0)).collect();
    let all = took.iter().flatten().copied();
    [within(all, 0.5), median(&mut longest), within(longest.iter().copied(), 1.0)]
}

/// A run through a town of more than 50,000 houses, along its streets, and a leap back; where it lies, and how many it has.
pub(super) fn fast_run(dir: &Path, sample: &Tour) -> Result<(PathBuf, Tour, u64), Failure> {
    let words = dir.join("town.words.ron");
    std::fs::write(&words, TOWN)?;
    let (city, stats) = large(&words, dir, (1, 1), "town")?;
    let houses = stats.houses;
    let reader = DirReader::new(&city)?;
    let index = read_index(&reader)?;
    let overview = read_overview(&reader, &index)?;
    let start = index.start.pos;
    // The street's end that lies nearest to as far away as the run is to lead.
    let ends = overview.streets.iter().filter(|street| street.walkable).filter_map(|street| street.line.last());
    let off = |pos: &GridPos| (pos.to_metres().distance(start) - RUN_M).abs();
    let goal = ends.min_by(|a, b| off(a).total_cmp(&off(b))).map_or(start, |pos| pos.to_metres());
    let at = |pos: DVec2| Where::At(pos.x, pos.y);
    let steps = vec![
        Step::Start { at: at(start), eye_m: None, look: Default::default() },
        Step::Walk { to: at(goal), via: Vec::new(), speed: Some(RUN_M_S), look: Default::default(), ease: Default::default() },
        // And back in one leap, which no reading ahead can know of.
        Step::Start { at: at(start), eye_m: None, look: Default::default() },
        Step::Wait { seconds: 5.0 },
    ];
    Ok((city, Tour { title: "Run".into(), steps, ..sample.clone() }, houses))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walks_settle_when_neither_gets_quicker() {
        let quicker = |n: usize| 100.0 * 0.99f64.powi(n as i32);
        let falling: Vec<_> = (0..20).map(|n| [100.0, quicker(n)]).collect();
        assert!(!settled(&falling) && !settled(&[]), "one still falls");
        let fallen: Vec<_> = (0..20).map(|n| [100.0, quicker(n.min(8))]).collect();
        let rounds = (1..=20).find(|&n| settled(&fallen[..n]));
        assert_eq!(rounds, Some(8 + 1 + SETTLED_ROUNDS), "as soon as it falls no more");
    }

    #[test]
    fn a_share_of_frames_is_counted_from_below() {
        let frames = (1..=1_000).rev().map(f64::from);
        assert_eq!([0.5, 0.999, 1.0].map(|share| within(frames.clone(), share)), [500.0, 999.0, 1_000.0]);
        assert_eq!(within(core::iter::empty(), 0.5), 0.0);
    }
}
