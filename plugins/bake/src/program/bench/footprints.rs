//! Footprints that the peer of growth writes, and what it makes of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;
use glam::DVec2;
use serde::Deserialize;
use veduta_city::{CellShell, Gable, GridPolygon, GridPos, HouseShell, PlanRoof, Rgb, RoofShape, VolumeShell};

use super::programs::run;
use crate::program::Failure;

/// The peer of growth, if it is to be measured.
#[derive(Args)]
pub(crate) struct GrowthPeer {
    /// Folder of peer_growth.py, which writes the footprints and measures the peers on them, and of make_map.py.
    #[arg(long, value_name = "DIR")]
    peers: Option<PathBuf>,
    /// Python with what its first lines name.
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// Seed of its footprints.
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Where they are kept.
    #[arg(long, value_name = "DIR", default_value = "target/bench-growth")]
    work: PathBuf,
}

/// Footprints without courtyards, and the peers' figures on them.
#[derive(Default)]
pub(super) struct Footprints {
    /// Of at most 12 corners.
    pub few: Vec<Vec<DVec2>>,
    /// Stars of many corners, the fewest first.
    pub stars: Vec<Vec<DVec2>>,
    pub figures: Vec<PeerFigure>,
}

impl Footprints {
    /// A figure of the peers', if it was measured.
    pub fn peer(&self, name: &str) -> Option<f64> {
        self.figures.iter().find(|figure| figure.name == name).map(|figure| figure.value)
    }

    /// A cell of houses on the footprints of few corners, under roofs of a shape and height.
    pub fn houses(&self, shape: RoofShape, height: i32) -> CellShell {
        let house = |ring: &Vec<DVec2>| {
            let footprint = GridPolygon::simple(ring.iter().map(|&p| GridPos::from_metres(p)).collect());
            let walls = (0..ring.len() as u16).collect();
            let roof = PlanRoof { shape, height, direction: 0, colour: Rgb(0xA2, 0x4B, 0x33) };
            let [colour, trim] = [Rgb(0xD9, 0xB3, 0x6C), Rgb(0xEF, 0xE3, 0xC8)];
            let volume = VolumeShell {
                footprint,
                bottom: 0,
                eaves: 12 * 1024,
                colour,
                trim,
                roof,
                gable: Gable::Plain,
                has_roof: true,
                walls,
                arcades: Vec::new(),
            };
            HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false }
        };
        CellShell { houses: self.few.iter().map(house).collect(), ..CellShell::default() }
    }
}

impl GrowthPeer {
    /// The Python, the peers' folder and the one for what is made, and the seed, if anything of the peers' is to be run.
    pub fn maps(&self) -> Option<((&Path, &Path, &Path), u32)> {
        self.peers.as_deref().map(|peers| ((&*self.python, peers, &*self.work), self.seed))
    }

    /// Its footprints and figures; nothing if it is not to be measured.
    pub fn measured(&self) -> Result<Option<Footprints>, Failure> {
        let Some(peers) = &self.peers else { return Ok(None) };
        fs::create_dir_all(&self.work)?;
        let file = self.work.join("footprints.json");
        let mut peer = Command::new(&self.python);
        peer.arg(peers.join("peer_growth.py")).args(["--seed", &self.seed.to_string()]).arg("--write").arg(&file);
        let figures = run(peer)?.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
        let read: File = serde_json::from_str(&fs::read_to_string(&file)?)?;
        let rings = |rings: Vec<Vec<[f64; 2]>>| rings.into_iter().map(|ring| ring.into_iter().map(DVec2::from).collect());
        let mut stars: Vec<Vec<DVec2>> = rings(read.stars.into_values().collect()).collect();
        stars.sort_by_key(Vec::len);
        Ok(Some(Footprints { few: rings(read.footprints).collect(), stars, figures }))
    }
}

/// The peer's file.
#[derive(Deserialize)]
struct File {
    footprints: Vec<Vec<[f64; 2]>>,
    /// By their number of corners.
    stars: BTreeMap<String, Vec<[f64; 2]>>,
}

/// A figure as the peer prints it.
#[derive(Deserialize)]
pub(super) struct PeerFigure {
    name: String,
    value: f64,
}
