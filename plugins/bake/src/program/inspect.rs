use anstream::{eprintln, println};
use veduta_bake::{Proof, ProofSettings, prove};
use veduta_city::{CellShell, Level};
use veduta_store::{
    CityIndex, Packet, Reader, StoreError, decode_overview, decode_packet, decode_styles, open_reader, read_index, sheet_fits,
};
use veduta_texture::decode_picture;

use super::Failure;

/// Whether and how visible sets are put to the proof.
#[derive(clap::Args)]
pub(crate) struct Proving {
    /// Prove the visible sets: whatever random rays see from eyes in a cell must be in its set.
    #[arg(long)]
    prove: bool,
    /// Rays of a proof.
    #[arg(long, default_value_t = ProofSettings::default().rays, requires = "prove")]
    rays: u64,
    /// Eyes in each cell that look for all that is seen from it, to tell how much too large its set is; 2000 tell it well.
    #[arg(long, default_value_t = 0, requires = "prove")]
    eyes: u32,
    /// Seed of a proof's eyes.
    #[arg(long, default_value_t = ProofSettings::default().seed, requires = "prove")]
    proof_seed: u64,
}

/// What was found in a city.
#[derive(Default)]
struct Found {
    /// Whole packets by level.
    packets: [u64; 4],
    /// Their bytes by level.
    bytes: [u64; 4],
    /// Things with a name.
    places: usize,
    /// What is wrong.
    broken: Vec<String>,
    /// Of level 1, by cell.
    shells: Vec<CellShell>,
}

/// Reads a city through and says what is in it.
pub(crate) fn inspect(city: &str, json: bool, proving: &Proving) -> Result<(), Failure> {
    let reader = open_reader(city)?;
    let index = read_index(&*reader)?;
    let found = look(&*reader, &index);
    let settings =
        ProofSettings { rays: proving.rays, eyes_a_cell: proving.eyes, seed: proving.proof_seed, ..ProofSettings::default() };
    let proof = (proving.prove && found.broken.is_empty()).then(|| prove(&index, &found.shells, &settings));
    let houses: u64 = index.cells().map(|(_, cell)| u64::from(cell.houses)).sum();
    let seen: usize = index.cells().map(|(_, cell)| cell.visible.len()).sum();
    let (cells, regions) = (index.cell_count(), index.regions.len());
    let visible_mean = seen as f64 / f64::from(cells.max(1));
    // Those between two regions are told in both.
    let told = index.regions_here().flat_map(|(number, region)| region.portals.iter().map(move |portal| (number, portal)));
    let portals = told.filter(|(number, portal)| index.region_of(portal.cell) == Some(*number)).count();
    let skyline: usize = index.regions_here().map(|(_, region)| region.skyline.len()).sum();
    let vistas: usize = index.regions_here().map(|(_, region)| region.vistas.len()).sum();
    if json {
        let mut figures = serde_json::json!({
            "name": index.name, "cells": cells, "regions": regions, "portals": portals, "houses": houses,
            "places": found.places, "visible_mean": visible_mean, "skyline": skyline, "vistas": vistas,
            "packets": found.packets, "bytes": found.bytes, "broken": found.broken.len(),
        });
        if let Some(proof) = &proof {
            figures["proof"] = serde_json::json!({
                "rays": proof.rays, "hits": proof.hits, "misses": proof.misses, "missing_pairs": proof.missing.len(),
                "by_districts": proof.by_districts, "bare": proof.bare, "hazy": proof.hazy,
                "excess": proof.excess(),
                "missing": proof.missing.iter().map(|missing| serde_json::json!({
                    "from": missing.from, "cell": missing.cell,
                    "eye": [missing.eye.0.x, missing.eye.0.y, missing.eye.1],
                    "seen": [missing.seen.0.x, missing.seen.0.y, missing.seen.1],
                })).collect::<Vec<_>>(),
            });
        }
        println!("{figures}");
    } else {
        println!("{} ({})", index.name, reader.describe());
        println!("  {cells} cells in {regions} regions, {portals} portals, {houses} houses, {} places", found.places);
        println!(
            "  {visible_mean:.1} cells seen from a cell, {skyline} on the skyline; {vistas} times a region sees another from afar"
        );
        for level in Level::ALL.into_iter().filter(|l| found.packets[l.index()] > 0) {
            println!("  {level}: {} packets, {} bytes", found.packets[level.index()], found.bytes[level.index()]);
        }
    }
    found.broken.iter().for_each(|b| eprintln!("{b}"));
    if let Some(proof) = &proof {
        tell(proof, &index, json);
    }
    match found.broken.len() {
        0 if proof.as_ref().is_some_and(|proof| !proof.missing.is_empty()) => {
            Err(format!("{city}: what can be seen is missing from visible sets").into())
        }
        0 => Ok(()),
        1 => Err(format!("{city}: one part is broken; bake the city again").into()),
        n => Err(format!("{city}: {n} parts are broken; bake the city again").into()),
    }
}

/// Missing cells that are told one by one.
const MOST_TOLD: usize = 10;

fn tell(proof: &Proof, index: &CityIndex, json: bool) {
    if !json {
        println!(
            "  {} rays through {} triangles: {} met something, {} saw what is in neither visible set nor skyline nor district ({} pairs of \
             cells), {} what only districts tell of, {} of them trees or furniture; {} saw it only where haze hides it",
            proof.rays,
            proof.triangles,
            proof.hits,
            proof.misses,
            proof.missing.len(),
            proof.by_districts,
            proof.bare,
            proof.hazy
        );
        if let Some(excess) = proof.excess() {
            println!("  visible sets hold {excess:.3} times the area that is seen, the skyline apart");
        }
    }
    let name = |cell: u32| index.cell(cell).map_or("", |cell| &cell.name);
    for missing in proof.missing.iter().take(MOST_TOLD) {
        let ((eye, eye_m), (seen, seen_m)) = (missing.eye, missing.seen);
        eprintln!(
            "from cell {} ({}), at ({:.2}, {:.2}, {eye_m:.2}), cell {} ({}) is seen at ({:.2}, {:.2}, {seen_m:.2})",
            missing.from,
            name(missing.from),
            eye.x,
            eye.y,
            missing.cell,
            name(missing.cell),
            seen.x,
            seen.y
        );
    }
}

/// Reads everything that an index names.
fn look(reader: &dyn Reader, index: &CityIndex) -> Found {
    let mut found = Found::default();
    let read = |blob: &veduta_store::BlobRef| reader.read(&blob.path(), u64::from(blob.bytes)).map_err(StoreError::from);
    for (number, blob) in index.regions_here().map(|(number, region)| (number, &region.overview)) {
        match read(blob).and_then(|stored| decode_overview(&stored, blob, index.overview_context(number))) {
            Ok(overview) => found.places += overview.places.len(),
            Err(error) => {
                found.broken.push(format!("overview of region {number}: {}", error.in_file(reader.describe(), &blob.path())));
            }
        }
    }
    if let Some(blob) = &index.styles
        && let Err(error) = read(blob).and_then(|stored| decode_styles(&stored, blob))
    {
        found.broken.push(format!("styles: {}", error.in_file(reader.describe(), &blob.path())));
    }
    for (i, cell) in index.cells() {
        let (mut shell, mut pictures_told) = (None, 0);
        for level in Level::ALL {
            let Some(blob) = cell.packet(level) else { continue };
            match read(blob).and_then(|stored| decode_packet(&stored, blob, level, index.packet_context(i))) {
                Ok(packet) => {
                    match packet {
                        Packet::Shell(one) => shell = Some(*one),
                        Packet::Facades(sheet) => {
                            if shell.as_ref().is_some_and(|shell| !sheet_fits(shell, &sheet)) {
                                found.broken.push(format!("cell {i}, {level}: its walls are not those of level 1"));
                                continue;
                            }
                            pictures_told = sheet.pictures();
                        }
                        Packet::Pictures(pictures) => {
                            let pictures: Vec<_> = pictures.iter().map(|picture| decode_picture(&picture.0)).collect();
                            if pictures.len() != pictures_told {
                                found.broken.push(format!("cell {i}, {level}: its pictures are not those of level 2"));
                                continue;
                            }
                            let errors = pictures.into_iter().filter_map(Result::err);
                            found.broken.extend(errors.map(|error| format!("cell {i}, {level}: {error}")));
                        }
                    }
                    found.packets[level.index()] += 1;
                    found.bytes[level.index()] += u64::from(blob.bytes);
                }
                Err(error) => found.broken.push(format!("cell {i}, {level}: {}", error.in_file(reader.describe(), &blob.path()))),
            }
        }
        found.shells.push(shell.unwrap_or_default());
    }
    found
}
