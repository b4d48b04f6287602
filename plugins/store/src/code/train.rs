//! Makes the priors anew, after a form has changed, from cities that the project makes itself. They are baked first, by a program
//! that knows the new form (and begins with the old priors, which is no harm; or with none, if the coder itself has changed, which cannot
//! read them: `: > plugins/store/src/code/priors.bin`):
//!
//! ```sh
//! for city in scenes/old_prague plugins/store/training/*.words.ron; do
//!     cargo run --bin veduta-bake -- bake $city -o /tmp/training/$(basename $city).city
//! done
//! VEDUTA_CITIES="$(echo /tmp/training/*.city)" cargo test -p veduta-store --lib train_priors -- --ignored
//! ```
//!
//! Then the version of the format is raised.

use std::path::Path;

use serde::Serialize;
use veduta_city::Level;

use super::mix::VIEWS;
use super::models::{Column, Models};
use super::priors::{Prior, WireColumn, WirePrior, WireSlot};
use super::range::{Bits, Chance};
use super::ser::Writer;
use super::{Outlines, press};
use crate::wire::{WireHouses, WireOverview, WireRegion, WireSheet, WireShell};
use crate::{BlobRef, DirReader, Packet, Reader, decode_overview, decode_packet, read_index};

/// Bits of one kind, packet by packet.
#[derive(Clone, Default)]
struct Seen(Vec<Vec<bool>>, bool);

struct Trainer;

impl Bits for Trainer {
    type Slot = Seen;

    fn bit(&mut self, slot: &mut Seen, one: bool) -> bool {
        if !core::mem::replace(&mut slot.1, true) {
            slot.0.push(Vec::new());
        }
        slot.0.last_mut().expect("begun").push(one);
        one
    }

    fn mixed(&mut self, slots: [&mut Seen; VIEWS], one: bool) -> bool {
        slots.into_iter().for_each(|slot| {
            self.bit(slot, one);
        });
        one
    }

    fn raw(&mut self, value: u64, _: u32) -> u64 {
        value
    }
}

/// What some bits cost that begin with a chance.
fn cost(runs: &[Vec<bool>], from: Chance) -> f64 {
    let run = |run: &Vec<bool>| {
        let mut chance = from;
        let bit = |&one: &bool| {
            let cost = chance.cost(one);
            chance.learn(one);
            cost
        };
        run.iter().map(bit).sum::<f64>()
    };
    runs.iter().map(run).sum()
}

/// What a slot must save in all cities together to be told.
const WORTH_BITS: f64 = 8.0;

/// The slots of which it is worth to know something, fitted.
fn fit(seen: &[Seen]) -> Vec<WireSlot> {
    let mut gap = 0;
    let fitted = seen.iter().filter_map(|seen| {
        let count: usize = seen.0.iter().map(Vec::len).sum();
        let zeros = seen.0.iter().flatten().filter(|one| !**one).count();
        let zero = ((zeros as f64 + 0.4) / (count as f64 + 0.8) * 65535.0) as u16;
        let total = |slot: &WireSlot| cost(&seen.0, slot.chance());
        let mut best = WireSlot::near(zero).min_by(|a, b| total(a).total_cmp(&total(b))).expect("some are near");
        if cost(&seen.0, Chance::EVEN) - total(&best) < WORTH_BITS {
            gap += 1;
            return None;
        }
        best.0 = core::mem::take(&mut gap);
        Some(best)
    });
    fitted.collect()
}

/// The prior of some structures, with lines.
fn train<T: Serialize>(all: &[(T, Outlines)]) -> WirePrior {
    let mut models: Models<Seen> = Models::default();
    for (wire, outlines) in all {
        let mut bits = Trainer;
        wire.serialize(&mut Writer::new(&mut bits, &mut models)).expect("ours");
        outlines.tell(&mut bits, &mut models);
        for column in &mut models.columns {
            (column.before, column.earlier, column.digits, column.flags) = (0, 0, 0, 0);
            column.slots.iter_mut().chain(&mut column.letters).for_each(|slot| slot.1 = false);
        }
        models.new_row();
    }
    let column =
        |column: Column<Seen>| WireColumn { slots: fit(&column.slots), letters: fit(&column.letters), children: column.children };
    WirePrior(models.columns.into_iter().map(column).collect())
}

/// Everything of one kind, of some cities.
#[derive(Default)]
struct All {
    shells: Vec<(WireShell, Outlines)>,
    sheets: Vec<(WireSheet, Outlines)>,
    overviews: Vec<(WireOverview, Outlines)>,
    regions: Vec<(WireRegion, Outlines)>,
    houses: Vec<(WireHouses, Outlines)>,
}

impl All {
    fn read(&mut self, dir: &Path) {
        let reader = DirReader::new(dir).expect("a city");
        let index = read_index(&reader).expect("an index");
        let stored = |blob: &BlobRef| reader.read(&blob.path(), blob.bytes.into()).expect("there");
        for (i, cell) in index.cells() {
            let context = index.packet_context(i);
            for level in [Level::One, Level::Two] {
                let Some(blob) = cell.packet(level) else { continue };
                match decode_packet(&stored(blob), blob, level, context).expect("whole") {
                    Packet::Shell(shell) => self.shells.push(WireShell::of(&shell, context)),
                    Packet::Facades(sheet) => self.sheets.push((WireSheet::from(&sheet), Outlines::default())),
                    Packet::Pictures(_) => {}
                }
            }
        }
        for (number, region) in index.regions_here() {
            let overview =
                decode_overview(&stored(&region.overview), &region.overview, index.overview_context(number)).expect("whole");
            self.overviews.push(WireOverview::of(&overview, index.overview_context(number)));
            self.regions.push(WireRegion::of(region, number as usize, &index.regions));
            self.houses.extend(index.houses(number).map(|houses| WireHouses::of(houses, index.houses_context(number))));
        }
    }
}

#[test]
#[ignore = "writes priors.bin"]
fn train_priors() {
    let mut all = All::default();
    let cities = std::env::var("VEDUTA_CITIES").expect("folders of cities in VEDUTA_CITIES");
    cities.split_whitespace().for_each(|dir| all.read(Path::new(dir)));
    let priors = [train(&all.shells), train(&all.sheets), train(&all.overviews), train(&all.regions), train(&all.houses)];
    let mut bytes = Vec::new();
    press(&priors, None, Prior::None, &mut bytes);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/code/priors.bin");
    std::fs::write(&file, &bytes).expect("written");
    println!("{}: {} B", file.display(), bytes.len());
}
