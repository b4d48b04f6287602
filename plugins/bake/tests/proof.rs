//! Rays as the truth of visible sets.

#[path = "shared/folder.rs"]
mod folder;

use std::path::Path;
use std::sync::Arc;

use folder::Folder;
use veduta_bake::{BakeSettings, Proof, ProofSettings, bake, prove};
use veduta_city::{CellShell, Level, Overview};
use veduta_store::{CityIndex, Packet, Region, decode_packet, open_reader, read_index};

/// A small town in words, with a river, baked and read back.
fn town(name: &str) -> (CityIndex, Vec<CellShell>) {
    let folder = Folder::new(name);
    let words = "(name: \"T\", seed: 5, size_m: 300, plan: Medieval(), squares: 1, river: (width_m: 12, bridges: 1))";
    let out = folder.0.join("t.city");
    baked(&folder.write("t.words.ron", words), &out)
}

/// A city baked and read back.
fn baked(input: &Path, out: &Path) -> (CityIndex, Vec<CellShell>) {
    bake(input, out, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let reader = open_reader(&out.to_string_lossy()).unwrap_or_else(|e| panic!("{e}"));
    let read = |path: &str| reader.read(path, 1 << 24).unwrap_or_else(|e| panic!("{e}"));
    let index = read_index(&*reader).unwrap_or_else(|e| panic!("{e}"));
    let shell = |i: u32, cell: &veduta_store::CellEntry| {
        let blob = cell.packet(Level::One)?;
        match decode_packet(&read(&blob.path()), blob, Level::One, index.packet_context(i)) {
            Ok(Packet::Shell(shell)) => Some(*shell),
            _ => None,
        }
    };
    let shells = index.cells().filter_map(|(i, cell)| shell(i, cell)).collect();
    (index, shells)
}

#[test]
fn sets_that_hold_everything_lack_nothing_and_empty_ones_are_found_out() {
    let (mut index, shells) = town("sets");
    let count = index.cell_count();
    assert_eq!(shells.len() as u32, count);
    let settings = ProofSettings { rays: 20_000, eyes_a_cell: 20, seed: 3, districts_m: -1.0, ..ProofSettings::default() };
    let with = |index: &mut CityIndex, set: fn(u32, u32) -> Vec<u32>| -> Proof {
        for number in 0..index.regions.len() as u32 {
            let mut region = Region::clone(index.region(number).unwrap_or_else(|| panic!("here")));
            let cells = region.cells.iter_mut().zip(index.regions[number as usize].first..);
            cells.for_each(|(cell, number)| cell.visible = set(number, count));
            region.skyline.clear();
            index.put(number, Arc::new(region));
        }
        prove(index, &shells, &settings)
    };
    let all = with(&mut index, |_, count| (0..count).collect());
    assert!(all.rays > 19_000 && all.hits > all.rays / 2, "{} of {} rays hit", all.hits, all.rays);
    assert_eq!((all.misses, all.missing.len()), (0, 0));
    let own = with(&mut index, |number, _| vec![number]);
    assert!(own.misses > own.rays / 8 && own.by_districts == 0, "{} misses", own.misses);
    let near = prove(&index, &shells, &ProofSettings { eyes_a_cell: 0, districts_m: Overview::ABOUT_M, ..settings });
    assert_eq!((near.misses, near.by_districts), (0, own.misses), "all is near enough to be seen as a district");
    let hazy = prove(&index, &shells, &ProofSettings { eyes_a_cell: 0, far_m: 60.0, ..settings });
    assert!(hazy.misses > 0 && hazy.hazy > 0 && own.hazy == 0, "{} misses, {} in haze", hazy.misses, hazy.hazy);
    assert_eq!(hazy.misses + hazy.hazy, own.misses, "haze hides some, and none is lost");
    assert!(own.missing.iter().all(|missing| missing.from != missing.cell));
    assert!(own.missing.len() > count as usize, "{} pairs", own.missing.len());
    for missing in &own.missing {
        let (eye, cell) = (missing.eye, index.cell(missing.from).unwrap_or_else(|| panic!("{missing:?}")));
        let floor_m = f64::from(cell.floor.0) / 1024.0;
        assert!(cell.outline.contains(veduta_city::GridPos::from_metres(eye.0)), "{missing:?}");
        assert!(eye.1 > floor_m - 1.0 && eye.1 < f64::from(cell.floor.1) / 1024.0 + 20.0, "{missing:?}");
    }
    // Whatever is in a set of one is seen; of all, houses hide a part.
    assert_eq!(own.excess(), Some(1.0));
    assert!(all.excess().is_some_and(|excess| excess > 1.5), "{:?}", all.excess());
}

#[test]
fn visible_sets_of_the_sample_city_lack_nothing_and_hold_little_more() {
    let folder = Folder::new("sample");
    let (index, shells) = baked(Path::new("../../scenes/old_prague"), &folder.0.join("p.city"));
    let proof = prove(&index, &shells, &ProofSettings { rays: 200_000, eyes_a_cell: 1, ..ProofSettings::default() });
    assert!(proof.rays > 190_000 && proof.hits > proof.rays / 2, "{} of {} rays hit", proof.hits, proof.rays);
    assert_eq!((proof.misses, &proof.missing[..]), (0, &[][..]));
    // All of this city is near enough to be seen as a district, which would hide what sets lack.
    assert!(
        proof.by_districts * 10_000 <= proof.rays,
        "{} of {} rays see what only districts tell of",
        proof.by_districts,
        proof.rays
    );
    // 1.18; 1.16 with 1,000 eyes a cell: more of them see all that fewer see, so that it only falls.
    let excess = proof.excess().unwrap_or(f64::INFINITY);
    assert!(excess <= 1.25, "visible sets hold {excess:.3} times what can be seen");
}

#[test]
fn a_proof_is_the_same_for_any_number_of_threads() {
    let (index, shells) = town("threads");
    let settings = ProofSettings { rays: 5_000, eyes_a_cell: 5, seed: 1, districts_m: -1.0, ..ProofSettings::default() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap_or_else(|e| panic!("{e}"));
        pool.install(|| prove(&index, &shells, &settings))
    };
    assert_eq!(on(1), on(3));
}
