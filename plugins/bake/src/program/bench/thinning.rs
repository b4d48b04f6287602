//! `bench thinning`: thinning beside OpenCV's and scikit-image's, pixel by pixel and second by second.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anstream::println;
use clap::Args;
use serde::Deserialize;
use veduta_survey::raster::{Bitmap, Picture, PictureLimits, thinned, thinned_portably};

use super::programs::run;
use crate::program::Failure;

/// What the peers run.
const SCRIPT: &str = include_str!("thinning.py");
/// Values that the sum of a pixel's channels may have.
const SUMS: usize = 3 * 255 + 1;

/// What to thin, and with what beside.
#[derive(Args)]
pub(crate) struct ThinningBench {
    /// Pictures of maps; their bright pixels are thinned, and their dark ones.
    #[arg(value_name = "PICTURE")]
    pictures: Vec<PathBuf>,
    /// Random bitmaps that are thinned too.
    #[arg(long, default_value_t = 10_000)]
    random: usize,
    /// How many of the pictures are timed, from the first.
    #[arg(long, default_value_t = 1)]
    timed: usize,
    /// Python with opencv-contrib-python and scikit-image.
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// Where bitmaps are kept.
    #[arg(long, value_name = "DIR", default_value = "target/bench-thinning")]
    work: PathBuf,
}

/// Seconds that the peers took for a bitmap.
#[derive(Debug, Clone, Copy, Deserialize)]
struct PeerSeconds {
    opencv: f64,
    scikit: f64,
}

/// Thins everything, and prints how much differs and how long it took.
///
/// # Errors
/// If a pixel differs from OpenCV's skeletons, or a peer cannot be run.
pub(crate) fn thinning(bench: &ThinningBench) -> Result<(), Failure> {
    let mut bitmaps = Vec::new();
    for path in &bench.pictures {
        let name = path.to_string_lossy();
        let picture = Picture::decode(&fs::read(path)?, &name, &PictureLimits::default())?;
        let least = threshold(&picture);
        let bright =
            Bitmap::from_fn(picture.width, picture.height, |x, y| picture.at(x, y).is_some_and(|colour| sum(&colour) >= least));
        let dark = Bitmap::from_fn(picture.width, picture.height, |x, y| !bright.get(x as isize, y as isize));
        bitmaps.extend([bright, dark]);
    }
    let timed = bench.timed.saturating_mul(2).min(bitmaps.len());
    bitmaps.extend((0..bench.random as u64).map(random));
    fs::create_dir_all(&bench.work)?;
    let (given, made) = (bench.work.join("bitmaps"), bench.work.join("skeletons"));
    write(&bitmaps, &given)?;
    let script = bench.work.join("thinning.py");
    fs::write(&script, SCRIPT)?;
    let mut peers = Command::new(&bench.python);
    peers.arg(script).args([&given, &made]).args(["--timed", &timed.to_string()]);
    let seconds: Vec<PeerSeconds> = serde_json::from_str(&run(peers)?)?;
    println!(
        "| bitmap | one thread | two | portable | OpenCV | scikit-image | OpenCV / best | scikit-image / best | OpenCV / portable |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (i, (bitmap, peer)) in bitmaps.iter().zip(&seconds).enumerate() {
        let own = [best(|| thinned(bitmap, 1)), best(|| thinned(bitmap, 2)), best(|| thinned_portably(bitmap, 1))];
        let name = bench.pictures[i / 2].file_name().unwrap_or_default().to_string_lossy();
        let [one, two, portable] = own.map(|s| format!("{:.1} ms", s * 1e3));
        let least = own[0].min(own[1]);
        println!(
            "| {name}, {} | {one} | {two} | {portable} | {:.0} ms | {:.0} ms | {:.0} | {:.0} | {:.0} |",
            if i % 2 == 0 { "bright" } else { "dark" },
            peer.opencv * 1e3,
            peer.scikit * 1e3,
            peer.opencv / least,
            peer.scikit / least,
            peer.opencv / own[2]
        );
    }
    let (pixels, differ) = compare(&bitmaps, &made)?;
    println!("{} bitmaps, {pixels} pixels of skeletons, thinned in three ways: {differ} differ from OpenCV's", bitmaps.len());
    if differ > 0 { Err(format!("{differ} pixels differ from OpenCV's skeletons").into()) } else { Ok(()) }
}

/// How bright a pixel is.
fn sum(colour: &[u8]) -> usize {
    colour.iter().map(|&c| usize::from(c)).sum()
}

/// The brightness from which on pixels count as bright: by it the dark and the bright ones differ most from each other
/// (Otsu, *A threshold selection method from gray-level histograms*, IEEE Transactions on Systems, Man, and Cybernetics 9(1),
/// 1979).
fn threshold(picture: &Picture) -> usize {
    let mut counts = vec![0.0; SUMS];
    for colour in picture.pixels.chunks_exact(3) {
        counts[sum(colour)] += 1.0;
    }
    let (all, bright) =
        counts.iter().enumerate().fold((0.0, 0.0), |(n, of), (value, count)| (n + count, of + value as f64 * count));
    let (mut below, mut of_below) = (0.0, 0.0);
    let mut best = (0.0, 0);
    for (value, count) in counts.iter().enumerate() {
        let above = all - below;
        if below > 0.0 && above > 0.0 {
            let apart: f64 = of_below / below - (bright - of_below) / above;
            let between = below * above * apart * apart;
            if between > best.0 {
                best = (between, value);
            }
        }
        below += count;
        of_below += value as f64 * count;
    }
    best.1
}

/// The seconds of the best of three runs.
fn best(run: impl Fn() -> Bitmap) -> f64 {
    let time = |_| {
        let began = Instant::now();
        std::hint::black_box(run());
        began.elapsed().as_secs_f64()
    };
    (0..3).map(time).fold(f64::MAX, f64::min)
}

/// A bitmap of blots, the coarser and denser by its number.
fn random(number: u64) -> Bitmap {
    let mixed = |n: u64| {
        let n = n.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 32
    };
    let size = |salt: u64| 3 + mixed(number * 4 + salt) as usize % 200;
    let (grain, density) = (1 + mixed(number * 4 + 2) as usize % 12, 20 + mixed(number * 4 + 3) % 200);
    Bitmap::from_fn(size(0), size(1), |x, y| {
        let (x, y) = ((x / grain) as u64, (y / grain) as u64);
        mixed(mixed(x.wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ y) ^ number) % 256 < density
    })
}

fn write(bitmaps: &[Bitmap], path: &Path) -> Result<(), Failure> {
    let mut file = std::io::BufWriter::new(fs::File::create(path)?);
    for bitmap in bitmaps {
        for side in [bitmap.width(), bitmap.height()] {
            file.write_all(&u32::try_from(side)?.to_le_bytes())?;
        }
        for y in 0..bitmap.height() as isize {
            let row: Vec<u8> = (0..bitmap.width() as isize).map(|x| if bitmap.get(x, y) { 255 } else { 0 }).collect();
            file.write_all(&row)?;
        }
    }
    Ok(file.flush()?)
}

/// How many pixels the peer's skeletons have, and how many of ours, on one thread, on two, and without wide registers,
/// are not as they are there.
fn compare(bitmaps: &[Bitmap], made: &Path) -> Result<(usize, usize), Failure> {
    let made = fs::read(made)?;
    let mut rest = &made[..];
    let (mut pixels, mut differ) = (0, 0);
    for bitmap in bitmaps {
        let (width, size) = (bitmap.width(), bitmap.width() * bitmap.height());
        let skeleton = rest.get(8..8 + size).ok_or("the peer made fewer skeletons than it was given bitmaps")?;
        rest = &rest[8 + size..];
        let theirs = Bitmap::from_fn(width, bitmap.height(), |x, y| skeleton[y * width + x] > 0);
        pixels += theirs.count();
        for ours in [thinned(bitmap, 1), thinned(bitmap, 2), thinned_portably(bitmap, 1)] {
            let mut both = ours.clone();
            both.keep(&theirs);
            differ += ours.count() + theirs.count() - 2 * both.count();
        }
    }
    Ok((pixels, differ))
}
