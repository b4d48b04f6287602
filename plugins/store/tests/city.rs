//! Writing a city and reading it back.

mod sample;

use sample::{City, TempDir, city, files};
use veduta_city::{CityPlan, District, Gable, GridPos, Level, ObjectKind, ObjectShell, Overview, PortalSide, Stand, Style};
use veduta_store::*;

fn index_of(dir: &std::path::Path) -> CityIndex {
    read_index(&DirReader::new(dir).expect("a city")).expect("a sound index")
}

fn blob_bytes(dir: &std::path::Path, blob: &BlobRef) -> Vec<u8> {
    std::fs::read(dir.join(blob.path())).expect("a blob")
}

#[test]
fn a_city_of_three_cells_reads_back_as_it_was() {
    let temp = TempDir::new("round");
    let dir = temp.join("x.city");
    let city = city(3, 4);
    let stats = city.write(&dir).expect("written");
    let index = index_of(&dir);
    assert_eq!((index.name.as_str(), index.seed, index.anchor), ("Testov", 7, city.plan.anchor));
    assert_eq!((&index.extent, index.start), (&city.plan.extent, city.plan.start));
    let region = index.region(0).expect("here");
    assert_eq!((&region.portals, &region.skyline), (&city.cells.portals, &city.cells.skyline));
    assert_eq!((index.cell_count(), stats.regions), (3, 1));
    for (c, entry) in index.cells().map(|(c, entry)| (c as usize, entry)) {
        let cell = &city.cells.cells[c];
        assert_eq!(
            (entry.id, &entry.outline, &entry.portals, &entry.visible),
            (cell.id, &cell.outline, &cell.portals, &city.cells.visible[c])
        );
        assert_eq!((entry.houses, entry.walls), (8, 32));
        let [Some(one), Some(two), None, None] = entry.packets else { panic!("levels 1 and 2: {:?}", entry.packets) };
        let read = |blob: &BlobRef, level| decode_packet(&blob_bytes(&dir, blob), blob, level, index.packet_context(c as u32));
        assert_eq!(read(&one, Level::One), Ok(Packet::Shell(Box::new(city.shells[c].clone()))));
        assert_eq!(read(&two, Level::Two), Ok(Packet::Facades(city.sheets[c].clone())));
        assert!(sheet_fits(&city.shells[c], &city.sheets[c]));
        let tallest = city.shells[c].houses.iter().map(|h| h.volumes[0].eaves + h.volumes[0].roof.height).max();
        assert_eq!(Some(entry.top), tallest);
    }
    let overview = read_overview(&DirReader::new(&dir).expect("a city"), &index).expect("an overview");
    let of_plan = Overview::of(&city.plan);
    assert_eq!(
        (&overview.streets, &overview.places, overview.houses.len()),
        (&of_plan.streets, &of_plan.places, of_plan.houses.len())
    );
    assert!(of_plan.houses.iter().all(|massing| overview.houses.contains(massing)), "cell by cell");
    let of_cells = |of: fn(&District) -> u32| overview.districts.iter().map(of).collect::<Vec<_>>();
    assert_eq!((of_cells(|d| d.cell), of_cells(|d| d.houses)), (vec![0, 1, 2], vec![8; 3]));
    let patches: Vec<u32> = city.shells.iter().map(|shell| shell.ground.len() as u32).collect();
    assert_eq!(of_cells(|d| d.ground), patches);
    assert_eq!((overview.houses.len(), overview.names.len(), overview.streets[0].name.as_str()), (24, 24, "Dlouhá"));
    assert_eq!((stats.houses, stats.cells, stats.walls, index.styles), (24, 3, 96, None));
}

#[test]
fn a_cell_has_a_second_level_where_it_has_walls_or_trees() {
    let has = |objects: Vec<ObjectShell>| {
        let temp = TempDir::new("trees");
        let mut city = city(1, 0);
        city.shells[0].objects = objects;
        city.write(&temp.0).expect("written");
        index_of(&temp.0).cell(0).expect("a cell").packets.map(|packet| packet.is_some())
    };
    let object = |kind| ObjectShell { kind, pos: GridPos(0, 0), z: 0, heading: 0, height: 0, monument: None };
    assert_eq!(has(vec![object(ObjectKind::Bench)]), [true, false, false, false]);
    assert_eq!(has(vec![object(ObjectKind::Birch)]), [true, true, false, false]);
}

#[test]
fn every_position_of_a_street_is_located_in_its_cell() {
    let temp = TempDir::new("locate");
    let city = city(3, 2);
    city.write(&temp.0).expect("written");
    let index = index_of(&temp.0);
    for (c, cell) in index.cells() {
        let middle = GridPos::from_metres(cell.outline.centroid());
        assert_eq!(index.locate(middle), Some(c));
        let (lo, hi) = cell.bounds;
        let shell = &city.shells[c as usize];
        let house = shell.houses[0].volumes[0].footprint.outer[2] + shell.origin;
        assert!(lo.0 <= house.0 && house.0 <= hi.0 && lo.1 <= house.1 && house.1 <= hi.1, "houses are within the bounds");
    }
    assert_eq!(index.locate(GridPos(0, 50 * 1024)), None);
}

#[test]
fn the_same_city_gives_the_same_bytes() {
    let temp = TempDir::new("same");
    let (a, b) = (temp.join("a"), temp.join("b"));
    city(3, 4).write(&a).expect("written");
    city(3, 4).write(&b).expect("written");
    let strip = |dir: &std::path::Path| {
        files(dir).into_iter().map(|(p, bytes)| (p.strip_prefix(dir).expect("below").to_owned(), bytes)).collect::<Vec<_>>()
    };
    assert_eq!(strip(&a), strip(&b));
    assert!(files(&temp.0).keys().all(|path| !path.to_string_lossy().contains("part")), "nothing is left over");
}

#[test]
fn styles_travel_with_the_city() {
    let temp = TempDir::new("styles");
    let mut city = city(1, 1);
    let style = Style {
        name: "old".to_owned(),
        storeys: (3, 5),
        ground_floor_m: veduta_city::Range(3.5, 4.5),
        storey_m: veduta_city::Range(3.0, 3.6),
        bay_m: veduta_city::Range(2.5, 3.5),
        frontage_m: veduta_city::Range(7.0, 14.0),
        depth_m: veduta_city::Range(10.0, 14.0),
        walls: vec![veduta_city::Rgb(1, 2, 3)],
        trim: 1.2,
        roofs: vec![veduta_city::RoofShape::Gabled],
        pitch_deg: veduta_city::Range(35.0, 50.0),
        roof_colours: vec![veduta_city::Rgb(4, 5, 6)],
        main_windows: vec![veduta_city::Opening::Window],
        windows: vec![veduta_city::Opening::Window],
        ground_windows: vec![veduta_city::Opening::Window],
        doors: vec![veduta_city::Opening::Door],
        shops: 0.5,
        gables: vec![Gable::Volute],
        gable_fronts: 0.5,
        stand: Stand::Detached(3.0),
        articulation: vec![veduta_city::Articulation::Quoins],
        balconies: vec![veduta_city::BalconyPlaces::Ends],
        oriels: 0.25,
        niches: 0.75,
        mezzanines: 0.125,
    };
    city.plan.styles.0.push(style);
    city.write(&temp.0).expect("written");
    let blob = index_of(&temp.0).styles.expect("styles");
    assert_eq!(decode_styles(&blob_bytes(&temp.0, &blob), &blob), Ok(city.plan.styles.clone()));
    city.shells[0].houses[0].style = 1;
    let error = city.write(&temp.0).expect_err("no such style").to_string();
    assert!(error.contains("has style 1 of 1"), "{error}");
}

#[test]
fn baking_again_replaces_what_changed_and_sweeps_the_rest() {
    let temp = TempDir::new("again");
    let mut city = city(3, 4);
    let first = city.write(&temp.0).expect("written");
    assert_eq!((first.blobs, first.blobs_written, first.blobs_removed), (9, 9, 0));
    let same = city.write(&temp.0).expect("written");
    assert_eq!((same.blobs_written, same.blobs_removed), (0, 0));
    city.shells[1].houses[0].volumes[0].colour = veduta_city::Rgb(9, 9, 9);
    std::fs::write(temp.join("notes.txt"), "mine").expect("a file");
    std::fs::write(temp.join("blobs/notes.txt"), "mine").expect("a file");
    let changed = city.write(&temp.0).expect("written");
    assert_eq!((changed.blobs_written, changed.blobs_removed), (2, 2), "the packet, and the region that names it");
    assert_eq!(files(&temp.0).len(), 9 + 1 + 2, "blobs, index, and files that are not ours");
    let blob = index_of(&temp.0).cell(1).expect("a cell").packets[0].expect("a packet");
    std::fs::write(temp.0.join(blob.path()), "damaged").expect("a file");
    assert_eq!(city.write(&temp.0).expect("written").blobs_written, 1, "a damaged blob is mended");
}

#[test]
fn a_directory_of_something_else_is_left_alone() {
    let temp = TempDir::new("else");
    std::fs::write(temp.join("thesis.doc"), "mine").expect("a file");
    let error = city(1, 1).write(&temp.0).expect_err("occupied");
    assert!(matches!(error, StoreError::Occupied(_)) && error.to_string().contains("name an empty or new directory"), "{error}");
    assert!(matches!(city(1, 1).write(&temp.join("thesis.doc")), Err(StoreError::Occupied(_))), "a file is no directory");
    assert_eq!(files(&temp.0).len(), 1);
    std::fs::create_dir(temp.join("empty")).expect("a directory");
    city(1, 1).write(&temp.join("empty")).expect("an empty one will do");
    city(1, 1).write(&temp.join("new/deeper")).expect("a new one will do");
}

#[test]
fn an_interrupted_run_leaves_no_city_and_is_taken_up() {
    let temp = TempDir::new("cut");
    let dir = temp.join("x");
    let city = city(2, 2);
    // A folder where the index's part goes makes the last step fail.
    std::fs::create_dir_all(dir.join("city.part/x")).expect("a directory");
    assert!(matches!(city.write(&dir), Err(StoreError::Write { .. })));
    assert!(matches!(DirReader::new(&dir), Err(ReadError::NoIndex(_))), "no city is there");
    std::fs::remove_dir_all(dir.join("city.part")).expect("removed");
    city.write(&dir).expect("taken up");
    // The same over an old city: it stays readable.
    let old = std::fs::read(dir.join(INDEX_NAME)).expect("an index");
    std::fs::create_dir_all(dir.join("city.part/x")).expect("a directory");
    let bigger = sample::city(3, 3);
    assert!(matches!(bigger.write(&dir), Err(StoreError::Write { .. })));
    assert_eq!(std::fs::read(dir.join(INDEX_NAME)).expect("an index"), old);
    let index = index_of(&dir);
    for blob in index.cells().flat_map(|(_, cell)| cell.packets.iter().flatten()) {
        blob.verify("a blob", &blob_bytes(&dir, blob)).expect("the old city is whole");
    }
}

#[test]
fn a_writer_that_is_not_finished_leaves_what_stood_there() {
    let temp = TempDir::new("half");
    let (fresh, old) = (temp.join("fresh"), temp.join("old"));
    city(2, 2).write(&old).expect("written");
    let before = files(&temp.0);
    let other = city(3, 5);
    for dir in [&fresh, &old] {
        let mut writer = CityWriter::new(dir, &other.plan).expect("begun");
        writer.cells(&other.plan, &other.cells, &|cell| other.parts(cell)).expect("its cells are written");
        assert!(files(&temp.0).len() > before.len(), "blobs are on the disk");
        drop(writer);
        assert_eq!(files(&temp.0), before, "and gone");
    }
    // What the old city has stays, also where the new one would have brought the same.
    let mut writer = CityWriter::new(&old, &city(2, 2).plan).expect("begun");
    let same = city(2, 2);
    writer.cells(&same.plan, &same.cells, &|cell| same.parts(cell)).expect("nothing to write");
    drop(writer);
    assert_eq!(files(&temp.0), before);
}

/// Writes a city with something wrong and returns the message.
fn refused(spoil: impl FnOnce(&mut City)) -> String {
    let temp = TempDir::new("bad");
    let mut city = city(3, 2);
    spoil(&mut city);
    let error = city.write(&temp.join("x")).expect_err("refused");
    assert!(matches!(error, StoreError::Invalid { .. }), "{error:?}");
    assert!(files(&temp.0).is_empty(), "nothing is touched");
    error.to_string()
}

#[test]
fn contradictions_are_named_before_anything_is_written() {
    let has = |text: &str, part: &str| assert!(text.contains(part), "{text}");
    has(&refused(|c| _ = c.shells.pop()), "3 cells but 2 shells");
    has(&refused(|c| _ = c.sheets.pop()), "3 cells but 2 sheets");
    has(&refused(|c| _ = c.cells.visible.pop()), "3 cells but 2 visible sets");
    has(&refused(|c| _ = c.sheets[1].walls.pop()), "its sheet 15");
    has(&refused(|c| c.cells.visible[1] = vec![0, 1, 9]), "name number 9 of 3");
    has(&refused(|c| c.cells.visible[1] = vec![1, 0]), "do not ascend");
    has(&refused(|c| c.cells.visible[1] = vec![0]), "not in its own visible set");
    has(&refused(|c| c.cells.cells[1].portals = vec![1]), "cell 1 does not know of portal 2 on its border");
    has(&refused(|c| c.cells.cells.swap(0, 2)), "is out of order: sort cells by");
    has(&refused(|c| c.cells.skyline = vec![3]), "skyline name number 3 of 3");
    has(&refused(|c| c.cells.portals[0].beyond = PortalSide::Cell(7)), "leads to cell 7 of 3");
    has(&refused(|c| c.cells.cells[0].portals = vec![3]), "portal 3 is not on its border");
    has(&refused(|c| c.cells.cells[0].outline.outer.truncate(2)), "a ring of 2 vertices");
    has(&refused(|c| c.shells[0].houses[0].volumes[0].walls = vec![0, 1, 2, 4]), "wall 4 on a footprint of 4 edges");
    has(&refused(|c| c.shells[0].houses[0].volumes[0].eaves = i32::MAX), "at a height of");
    has(&refused(|c| c.shells[0].origin = GridPos(i32::MAX, 0)), "too far");
    has(&refused(|c| c.plan.places[0].pos.x = f64::NAN), "place `Kašna` lies nowhere");
}

#[test]
fn a_plan_without_anything_is_an_empty_city() {
    let temp = TempDir::new("none");
    let stats = write_city(&temp.0, &CityPlan::default(), &Default::default(), &[], &[]).expect("written");
    assert_eq!((stats.houses, stats.cells, stats.bytes_per_house(Level::One)), (0, 0, None));
    assert_eq!(index_of(&temp.0).locate(GridPos(0, 0)), None);
}

#[test]
fn a_house_takes_few_bytes() {
    let temp = TempDir::new("bytes");
    let stats = city(40, 5).write(&temp.0).expect("written");
    println!("{stats}");
    let (one, two) = (stats.bytes_per_house(Level::One).expect("houses"), stats.bytes_per_house(Level::Two).expect("houses"));
    assert!(one <= 32.0, "level 1 takes {one:.1} bytes a house");
    assert!(two <= 22.0, "level 2 takes {two:.1} bytes a house");
}
