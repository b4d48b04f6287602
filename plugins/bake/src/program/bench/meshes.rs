//! `bench meshes`: what it takes to see all cells of a city by making their meshes of packets on the walker's machine, and by
//! downloading them ready made, over lines of several bandwidths.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use flate2::{Compression, write::DeflateEncoder};
use veduta_bake::BakeSettings;
use veduta_cells::{Contents, partition};
use veduta_city::{CellShell, FacadeSheet, Level, Palette, Season, Style};
use veduta_growth::mesh::{self, MeshData, MonumentDetail};
use veduta_growth::plan::{Stock, grow};
use veduta_store::{BlobRef, Packet, PacketContext, decode_packet, encode_packet};

use super::figure::{Figure, print};
use super::growth::{best, graph};
use crate::program::Failure;

/// What to measure.
#[derive(Args)]
pub(crate) struct MeshesBench {
    /// A map, graph or words; a town described in words if not given.
    #[arg(value_name = "MAP")]
    map: Option<PathBuf>,
    /// Bandwidths of lines, megabits a second.
    #[arg(long, value_delimiter = ',', default_value = "0.1,1,10,100,1000")]
    mbit: Vec<f64>,
    /// How often meshes are made; the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
}

/// Both packets of a cell, as they are sent.
struct Sent {
    shell: (BlobRef, Vec<u8>),
    sheet: (BlobRef, Vec<u8>),
}

/// Measures and prints.
///
/// # Errors
/// If the map cannot be read or grown, or a packet not be read back.
pub(crate) fn meshes(bench: &MeshesBench) -> Result<(), Failure> {
    let plan = grow(&graph(bench.map.as_deref())?, &Stock::new())?.plan;
    let cells = partition(&plan, &[], &BakeSettings::default().partition).cells;
    let contents = Contents::new(&plan, &cells);
    let palettes: Vec<Palette> = plan.styles.0.iter().map(Style::palette).collect();
    // Each tells its houses itself, which takes more than with what a region tells of them.
    let context =
        |cell: usize| PacketContext { outline: Some(&cells.cells[cell].outline), palettes: &palettes, ..PacketContext::default() };
    let sent = |cell: usize| {
        let stored = |packet: &Packet| {
            let stored = encode_packet(packet, context(cell));
            (BlobRef::of(&stored), stored)
        };
        let shell = stored(&Packet::Shell(Box::new(contents.shell(cell))));
        Sent { shell, sheet: stored(&Packet::Facades(contents.sheet(cell))) }
    };
    let sent: Vec<Sent> = (0..cells.cells.len()).map(sent).collect();
    let make = || sent.iter().enumerate().map(|(cell, sent)| made(sent, context(cell))).collect::<Result<Vec<_>, Failure>>();
    let (make_s, made) = best(bench.repeat, make);
    let made = made?;
    let packets: usize = sent.iter().map(|sent| sent.shell.1.len() + sent.sheet.1.len()).sum();
    let ready: usize = made.iter().map(ready_bytes).sum::<Result<usize, Failure>>()?;
    let triangles: usize = made.iter().map(MeshData::triangle_count).sum();
    let mut figures = vec![
        Figure::new("cells", sent.len() as f64, "1"),
        Figure::new("triangles", triangles as f64, "1"),
        Figure::new("make_s", make_s, "s"),
        Figure::new("packet_bytes", packets as f64, "B").beside("ready meshes", Some(ready as f64)),
    ];
    for &mbit in &bench.mbit {
        let download_s = |bytes: usize| bytes as f64 * 8.0 / (mbit * 1e6);
        let figure = Figure::new(format!("seconds_at_{mbit}_mbit"), download_s(packets) + make_s, "s");
        figures.push(figure.beside("ready meshes", Some(download_s(ready))));
    }
    let even_mbit = ready.saturating_sub(packets) as f64 * 8.0 / make_s.max(1e-9) / 1e6;
    figures.push(Figure::new("making_is_faster_below_mbit", even_mbit, "Mbit/s"));
    print(&figures, bench.json)
}

/// The meshes of both levels of a cell, of what was sent, as the buildings plugin makes them.
fn made(sent: &Sent, context: PacketContext<'_>) -> Result<MeshData, Failure> {
    let read = |(blob, stored): &(BlobRef, Vec<u8>), level| decode_packet(stored, blob, level, context);
    let (shell, sheet): (Box<CellShell>, FacadeSheet) = match (read(&sent.shell, Level::One)?, read(&sent.sheet, Level::Two)?) {
        (Packet::Shell(shell), Packet::Facades(sheet)) => (shell, sheet),
        _ => return Err("a packet is of another level".into()),
    };
    let mut all = mesh::ground(&shell);
    let season = Season::default();
    let parts = [
        mesh::markings(&shell),
        mesh::spans(&shell),
        mesh::roofs(&shell),
        mesh::objects(&shell),
        mesh::level1(&shell),
        mesh::monuments(&shell, MonumentDetail::COARSE),
        mesh::tree_cards(&shell, season),
        mesh::level2(&shell, &sheet)?,
        mesh::monuments(&shell, MonumentDetail::MIDDLE),
        mesh::trees(&shell, season),
    ];
    parts.iter().for_each(|part| all.append(part));
    Ok(all)
}

/// Bytes of a mesh as it would be shipped: positions and centres in steps of 1.5 mm a hundred metres, normals in two bytes, colours in three
/// and the tile in one, texture coordinates in 1/256 repeats; each column as differences, high and low bytes apart, deflated.
fn ready_bytes(mesh: &MeshData) -> Result<usize, Failure> {
    let (low, high) = mesh.positions.iter().flatten().fold((0_f32, 0_f32), |(low, high), &v| (low.min(v), high.max(v)));
    let scale = 65_535.0 / (high - low).max(1e-3);
    let placed = |v: f32| ((v - low) * scale).round() as i32;
    let byte = |v: f32| (v * 127.0).round() as i32;
    let columns: [Vec<i32>; 14] = [
        mesh.positions.iter().map(|p| placed(p[0])).collect(),
        mesh.positions.iter().map(|p| placed(p[1])).collect(),
        mesh.positions.iter().map(|p| placed(p[2])).collect(),
        mesh.centres.iter().map(|p| placed(p[0])).collect(),
        mesh.centres.iter().map(|p| placed(p[1])).collect(),
        mesh.normals.iter().map(|n| byte(n[0])).collect(),
        mesh.normals.iter().map(|n| byte(n[1])).collect(),
        mesh.uvs.iter().map(|uv| (uv[0] * 256.0).round() as i32).collect(),
        mesh.uvs.iter().map(|uv| (uv[1] * 256.0).round() as i32).collect(),
        mesh.colours.iter().map(|c| byte(c[0])).collect(),
        mesh.colours.iter().map(|c| byte(c[1])).collect(),
        mesh.colours.iter().map(|c| byte(c[2])).collect(),
        mesh.colours.iter().map(|c| c[3].round() as i32).collect(),
        mesh.indices.iter().map(|&i| i as i32).collect(),
    ];
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::best());
    for column in columns {
        let steps = || column.iter().scan(0_i32, |last, &n| Some(n.wrapping_sub(core::mem::replace(last, n))));
        let folded = || steps().map(|step| ((step << 1) ^ (step >> 31)) as u32);
        for byte in 0..3 {
            let bytes: Vec<u8> = folded().map(|n| (n >> (8 * byte)) as u8).collect();
            deflated.write_all(&bytes)?;
        }
    }
    Ok(deflated.finish()?.len())
}
