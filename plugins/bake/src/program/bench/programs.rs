//! The programs that draw maps, read them, and score what was read.

use core::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use serde_json::Value;

use super::figures::Kind;
use crate::program::Failure;

/// Styles of towns that are drawn.
pub(crate) const STYLES: [&str; 4] = ["old", "grid", "radial", "mixed"];

/// A map that is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Map {
    pub style: &'static str,
    pub seed: u32,
    pub size: u32,
    pub kind: Kind,
}

impl fmt::Display for Map {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { style, seed, size, kind } = self;
        write!(f, "{}-{style}-{size}-{seed}", kind.to_string().replace(", ", "-"))
    }
}

/// A reader of maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reader {
    Veduta,
    Peer,
}

impl Reader {
    pub const ALL: [Self; 2] = [Self::Veduta, Self::Peer];
}

impl fmt::Display for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Veduta => "veduta",
            Self::Peer => "peer",
        })
    }
}

/// Where the programs are, and where their results go.
pub(crate) struct Programs {
    python: PathBuf,
    peers: PathBuf,
    work: PathBuf,
    /// This program.
    own: PathBuf,
}

impl Programs {
    /// # Errors
    /// A peer that is not there.
    pub fn new(python: &Path, peers: &Path, work: &Path) -> Result<Self, Failure> {
        for name in ["make_map.py", "peer_raster.py", "score_graph.py"] {
            if !peers.join(name).is_file() {
                return Err(format!("{}: not there; give the folder of the peers by --peers", peers.join(name).display()).into());
            }
        }
        let own = std::env::current_exe()?;
        Ok(Self { python: python.to_owned(), peers: peers.to_owned(), work: work.to_owned(), own })
    }

    /// Does something for each map, two at a time, and gives the results in order.
    pub fn on_each<T: Send>(maps: &[Map], act: impl Fn(&Map) -> Result<T, Failure> + Sync) -> Result<Vec<T>, Failure> {
        const AT_ONCE: usize = 2;
        let next = Mutex::new(0..maps.len());
        let take = || next.lock().ok()?.next();
        let done = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..AT_ONCE {
                scope.spawn(|| {
                    while let Some(i) = take() {
                        // Failures cannot leave their thread, but for their text.
                        let result = act(&maps[i]).map_err(|error| error.to_string());
                        if let Ok(mut done) = done.lock() {
                            done.push((i, result));
                        }
                    }
                });
            }
        });
        let mut done = done.into_inner().map_err(|_| "a thread failed")?;
        done.sort_by_key(|(i, _)| *i);
        done.into_iter().map(|(_, result)| result.map_err(Failure::from)).collect()
    }

    /// The folder of a map, which is drawn if it is not there.
    pub fn folder(&self, map: &Map) -> Result<PathBuf, Failure> {
        let Map { style, seed, size, kind } = map;
        let folder = self.work.join(map.to_string());
        // What is written last.
        if folder.join("legend.json").is_file() && folder.join("truth.geojson").is_file() {
            return Ok(folder);
        }
        fs::create_dir_all(&folder)?;
        let mut draw = self.python("make_map.py");
        draw.args(["--style", style, "--seed", &seed.to_string(), "--size", &size.to_string()]).args(kind.arguments());
        draw.arg("-o").arg(&folder);
        run(draw)?;
        Ok(folder)
    }

    /// Reads a map; the seconds of each step.
    pub fn read(&self, map: &Map, reader: Reader) -> Result<serde_json::Map<String, Value>, Failure> {
        let folder = self.folder(map)?;
        let (picture, legend) = (folder.join("map.png"), folder.join("legend.json"));
        let found = folder.join(format!("{reader}.geojson"));
        let command = match reader {
            Reader::Veduta => {
                let mut own = Command::new(&self.own);
                own.arg("survey").arg(picture).arg("--legend").arg(legend).arg("--geojson").arg(found);
                own.arg("-o").arg(folder.join("veduta.graph.ron")).args(["--timings", "--quiet"]);
                own
            }
            Reader::Peer => {
                let mut peer = self.python("peer_raster.py");
                peer.arg(picture).arg("--legend").arg(legend).arg("-o").arg(found).arg("--timings");
                peer
            }
        };
        let text = run(command)?;
        let seconds = text.lines().filter_map(|line| serde_json::from_str(line).ok()).find_map(|value| match value {
            Value::Object(map) if map.contains_key("total") => Some(map),
            _ => None,
        });
        seconds.ok_or_else(|| format!("{reader} did not tell its seconds: {text}").into())
    }

    /// Reads a map and scores what was found.
    pub fn score(&self, map: &Map, reader: Reader) -> Result<Value, Failure> {
        self.read(map, reader)?;
        let folder = self.folder(map)?;
        let mut score = self.python("score_graph.py");
        score.arg(folder.join("truth.geojson")).arg(folder.join(format!("{reader}.geojson")));
        Ok(serde_json::from_str(&run(score)?)?)
    }

    /// How many nodes and links were found when a map was last read.
    pub fn found(&self, map: &Map, reader: Reader) -> Result<(usize, usize), Failure> {
        let text = fs::read_to_string(self.folder(map)?.join(format!("{reader}.geojson")))?;
        let found: Value = serde_json::from_str(&text)?;
        let features = found["features"].as_array().map(Vec::as_slice).unwrap_or_default();
        let count = |kind: &str| features.iter().filter(|feature| feature["properties"]["feature"] == kind).count();
        Ok((count("node"), count("link")))
    }

    fn python(&self, program: &str) -> Command {
        let mut command = Command::new(&self.python);
        command.arg(self.peers.join(program));
        command
    }
}

/// Runs a program to its end; what it prints.
pub(super) fn run(mut command: Command) -> Result<String, Failure> {
    let name = command.get_args().next().unwrap_or(command.get_program()).to_string_lossy().into_owned();
    let output = command.output().map_err(|error| format!("{}: {error}", command.get_program().to_string_lossy()))?;
    if !output.status.success() {
        return Err(format!("{name} failed: {}", String::from_utf8_lossy(&output.stderr).trim()).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}
