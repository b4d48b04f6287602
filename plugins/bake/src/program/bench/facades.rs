//! `bench facades`: what a painted front costs one core of the walker's machine when it comes.

use std::path::PathBuf;

use clap::Args;
use glam::DVec2;
use veduta_bake::read_facade;
use veduta_city::PlacedFacade;
use veduta_texture::{PictureLayer, Pixels, compose, decode_picture};

use super::figure::{Figure, print};
use super::growth::best;
use crate::program::Failure;

/// What to measure.
#[derive(Args)]
pub(crate) struct FacadesBench {
    /// Files of painted façades.
    #[arg(value_name = "FACADE", required = true)]
    facades: Vec<PathBuf>,
    /// How often each is made; the best counts.
    #[arg(long, default_value_t = 20)]
    repeat: usize,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
}

/// Milliseconds of one section of a façade: of its picture's decoding, composing, mips and blocks.
type Costs = [f64; 4];

/// Measures and prints the façade that takes longest, step by step.
///
/// # Errors
/// If a façade cannot be read.
pub(crate) fn facades(bench: &FacadesBench) -> Result<(), Failure> {
    let mut worst: Costs = [0.0; 4];
    for path in &bench.facades {
        let costs = measured(&read_facade(path, DVec2::ZERO)?, bench.repeat)
            .ok_or_else(|| format!("{}: it cannot be put together", path.display()))?;
        worst.iter_mut().zip(costs).for_each(|(worst, cost)| *worst = cost.max(*worst));
    }
    let names = ["facade_decode_ms", "facade_compose_ms", "facade_mips_ms", "facade_blocks_ms"];
    let figures: Vec<Figure> = names.into_iter().zip(worst).map(|(name, ms)| Figure::new(name, ms, "ms")).collect();
    print(&figures, bench.json)
}

fn measured(facade: &PlacedFacade, repeat: usize) -> Option<Costs> {
    let sections = f64::from(facade.painted.sections);
    let decode = || facade.pictures.iter().map(|file| decode_picture(&file.0).ok()).collect::<Option<Vec<Pixels>>>();
    let (decode_s, pictures) = best(repeat, decode);
    let pictures = pictures?;
    let (compose_s, composed) = best(repeat, || compose(&facade.painted, &pictures));
    let composed = composed?;
    let (mips_s, layers) = best(repeat, || composed.iter().map(PictureLayer::new).collect::<Option<Vec<_>>>());
    let layers = layers?;
    let (blocks_s, _) = best(repeat, || layers.iter().map(PictureLayer::in_blocks).collect::<Vec<_>>());
    Some([decode_s, compose_s, mips_s, blocks_s].map(|seconds| 1e3 * seconds / sections))
}
