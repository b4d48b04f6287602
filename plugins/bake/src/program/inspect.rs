use anstream::{eprintln, println};
use veduta_city::Level;
use veduta_store::{
    CityIndex, INDEX_NAME, Packet, Reader, StoreError, decode_index, decode_overview, decode_packet, decode_styles, open_reader,
    sheet_fits,
};

use super::Failure;

/// What was found in a city.
#[derive(Default)]
struct Found {
    /// Whole packets by level.
    packets: [u64; 4],
    /// Their bytes by level.
    bytes: [u64; 4],
    /// What is wrong.
    broken: Vec<String>,
}

/// Reads a city through and says what is in it.
pub(crate) fn inspect(city: &str, json: bool) -> Result<(), Failure> {
    let reader = open_reader(city)?;
    let stored = reader.read(INDEX_NAME, 256 << 20)?;
    let index = decode_index(&stored).map_err(|error| error.in_file(reader.describe(), INDEX_NAME))?;
    let found = look(&*reader, &index);
    let houses: u64 = index.cells.iter().map(|c| u64::from(c.houses)).sum();
    let seen: usize = index.cells.iter().map(|c| c.visible.len()).sum();
    let visible_mean = seen as f64 / index.cells.len().max(1) as f64;
    if json {
        let figures = serde_json::json!({
            "name": index.name, "cells": index.cells.len(), "portals": index.portals.len(), "houses": houses,
            "places": index.places.len(), "visible_mean": visible_mean, "skyline": index.skyline.len(),
            "packets": found.packets, "bytes": found.bytes, "broken": found.broken.len(),
        });
        println!("{figures}");
    } else {
        println!("{} ({})", index.name, reader.describe());
        println!("  {} cells, {} portals, {houses} houses, {} places", index.cells.len(), index.portals.len(), index.places.len());
        println!("  {visible_mean:.1} cells seen from a cell, {} on the skyline", index.skyline.len());
        for level in Level::ALL.into_iter().filter(|l| found.packets[l.index()] > 0) {
            println!("  {level}: {} packets, {} bytes", found.packets[level.index()], found.bytes[level.index()]);
        }
    }
    found.broken.iter().for_each(|b| eprintln!("{b}"));
    match found.broken.len() {
        0 => Ok(()),
        1 => Err(format!("{city}: one part is broken; bake the city again").into()),
        n => Err(format!("{city}: {n} parts are broken; bake the city again").into()),
    }
}

/// Reads everything that an index names.
fn look(reader: &dyn Reader, index: &CityIndex) -> Found {
    let mut found = Found::default();
    let read = |blob: &veduta_store::BlobRef| reader.read(&blob.path(), u64::from(blob.bytes)).map_err(StoreError::from);
    let overview = read(&index.overview).and_then(|stored| decode_overview(&stored, &index.overview));
    if let Err(error) = overview {
        found.broken.push(format!("overview: {}", error.in_file(reader.describe(), &index.overview.path())));
    }
    if let Some(blob) = &index.styles
        && let Err(error) = read(blob).and_then(|stored| decode_styles(&stored, blob))
    {
        found.broken.push(format!("styles: {}", error.in_file(reader.describe(), &blob.path())));
    }
    for (i, cell) in index.cells.iter().enumerate() {
        let mut shell = None;
        for level in Level::ALL {
            let Some(blob) = cell.packet(level) else { continue };
            match read(blob).and_then(|stored| decode_packet(&stored, blob, level)) {
                Ok(packet) => {
                    match packet {
                        Packet::Shell(one) => shell = Some(one),
                        Packet::Facades(sheet) => {
                            if shell.as_ref().is_some_and(|shell| !sheet_fits(shell, &sheet)) {
                                found.broken.push(format!("cell {i}, {level}: its walls are not those of level 1"));
                                continue;
                            }
                        }
                    }
                    found.packets[level.index()] += 1;
                    found.bytes[level.index()] += u64::from(blob.bytes);
                }
                Err(error) => found.broken.push(format!("cell {i}, {level}: {}", error.in_file(reader.describe(), &blob.path()))),
            }
        }
    }
    found
}
