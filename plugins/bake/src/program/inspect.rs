use veduta_city::Level;
use veduta_store::{INDEX_NAME, decode_index, decode_packet, open_reader};

use super::Failure;

/// Reads a city through and says what is in it.
pub(crate) fn inspect(city: &str, json: bool) -> Result<(), Failure> {
    let reader = open_reader(city)?;
    let index = decode_index(&reader.read(INDEX_NAME, 256 << 20)?)?;
    let (mut whole, mut broken, mut bytes) = ([0_u64; 4], Vec::new(), [0_u64; 4]);
    for (i, cell) in index.cells.iter().enumerate() {
        for level in Level::ALL {
            let Some(blob) = &cell.packets[level.index()] else { continue };
            let read = reader.read(&blob.path(), u64::from(blob.bytes)).map_err(|e| e.to_string());
            match read.and_then(|stored| decode_packet(&stored, blob, level).map_err(|e| e.to_string())) {
                Ok(_) => {
                    whole[level.index()] += 1;
                    bytes[level.index()] += u64::from(blob.bytes);
                }
                Err(error) => broken.push(format!("cell {i}, {level}: {error}")),
            }
        }
    }
    let houses: u64 = index.cells.iter().map(|c| u64::from(c.houses)).sum();
    let seen: usize = index.cells.iter().map(|c| c.visible.len()).sum();
    if json {
        let figures = serde_json::json!({
            "name": index.name, "cells": index.cells.len(), "portals": index.portals.len(), "houses": houses,
            "places": index.places.len(), "visible_mean": seen as f64 / index.cells.len().max(1) as f64,
            "skyline": index.skyline.len(), "packets": whole, "bytes": bytes, "broken": broken.len(),
        });
        println!("{figures}");
    } else {
        println!("{} ({})", index.name, reader.describe());
        println!("  {} cells, {} portals, {houses} houses, {} places", index.cells.len(), index.portals.len(), index.places.len());
        println!(
            "  {:.1} cells seen from a cell, {} on the skyline",
            seen as f64 / index.cells.len().max(1) as f64,
            index.skyline.len()
        );
        for level in Level::ALL.into_iter().filter(|l| whole[l.index()] > 0) {
            println!("  {level}: {} packets, {} bytes", whole[level.index()], bytes[level.index()]);
        }
    }
    broken.iter().for_each(|b| eprintln!("{b}"));
    if broken.is_empty() { Ok(()) } else { Err(format!("{city}: {} packets are broken; bake the city again", broken.len()).into()) }
}
