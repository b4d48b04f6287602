//! Every OpenStreetMap extract of the shared test data, from file to city. `VEDUTA_DATA` names the folder; without it
//! `shared/data` beside the workspace is looked for, and where there is none the tests say so and pass.

#[path = "../../growth/tests/ground_proof/mod.rs"]
mod ground_proof;
mod shared;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use ground_proof::{prove_mesh, prove_partition};
use veduta_bake::{BakeError, BakeSettings, Baked, Input, ProofSettings, bake, cut, plan, prove};
use veduta_city::{CellShell, GridPos, Level, Overview, PlaceKind};
use veduta_store::{CellEntry, CityIndex, DirReader, Packet, Reader, decode_packet, decode_styles, read_index, read_overview};

/// How far one sees in Portland, whose extract spans 70 km²: the test is to stay short. Metres.
const PORTLAND_SIGHT_M: f64 = 120.0;
/// Rays that look for what visible sets and skyline lack, in each city.
const RAYS: u64 = 30_000;
/// So many of those that meet something may see over the roofs what is in no visible set.
const MOST_OVER_ROOFS: f64 = 0.002;

/// A file and what its city has at least: houses, named streets, squares with a name.
struct Expected {
    file: &'static str,
    houses: u64,
    streets: usize,
    squares: usize,
}

const fn least(file: &'static str, houses: u64, streets: usize, squares: usize) -> Expected {
    Expected { file, houses, streets, squares }
}

/// A folder of its own that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-real-maps-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn bake_to(input: &Path, out: &Path) -> Result<Baked, BakeError> {
    bake(input, out, &BakeSettings::default(), &mut |_| ())
}

/// Every file below a folder with its content, in order.
fn files(dir: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut open = vec![dir.to_owned()];
    while let Some(dir) = open.pop() {
        for entry in std::fs::read_dir(&dir).unwrap_or_else(|e| panic!("{}: {e}", dir.display())) {
            let path = entry.unwrap_or_else(|e| panic!("{e}")).path();
            if path.is_dir() {
                open.push(path);
            } else {
                let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                found.push((path, bytes));
            }
        }
    }
    found.sort();
    found
}

/// Least and greatest corner of a box in plan.
type Box2 = (GridPos, GridPos);

/// A city read back through the reader.
struct Opened {
    index: CityIndex,
    overview: Overview,
    /// How many named streets it shows.
    named: usize,
    /// By cell: boxes of what is drawn with it and may be seen from other cells' space: houses, objects, ways above and below.
    things: Vec<Vec<Box2>>,
    /// By cell: boxes of its yards' ground.
    yards: Vec<Vec<Box2>>,
    /// By cell: whether a tunnel leads below it. Who sees a part of a tunnel sees all of it, and who is above it what its ramps see.
    has_tunnel: Vec<bool>,
    shells: Vec<CellShell>,
}

/// How far a crown reaches from its stem, grid steps.
const CROWN: i32 = 8 * 1024;

/// The box about some points.
fn around(mut points: impl Iterator<Item = GridPos>) -> Option<Box2> {
    let first = points.next()?;
    let grown = |(lo, hi): Box2, p: GridPos| (GridPos(lo.0.min(p.0), lo.1.min(p.1)), GridPos(hi.0.max(p.0), hi.1.max(p.1)));
    Some(points.fold((first, first), grown))
}

fn boxes(shell: &CellShell) -> (Vec<Box2>, Vec<Box2>) {
    let houses = shell.houses.iter().flat_map(|house| &house.volumes);
    let houses = houses.filter_map(|volume| around(volume.footprint.outer.iter().copied()));
    let objects = shell.objects.iter().map(|object| {
        let reach = GridPos(CROWN, CROWN);
        (object.pos - reach, object.pos + reach)
    });
    let spans =
        shell.spans.iter().filter_map(|span| around(span.stations.iter().flat_map(|station| [station.left, station.right])));
    let yards = shell.ground.iter().filter(|patch| !shell.outline.contains(patch.outline.middle()));
    let yards = yards.filter_map(|patch| around(patch.outline.outer.iter().copied()));
    let placed = |(lo, hi): Box2| (lo + shell.origin, hi + shell.origin);
    (houses.chain(objects).chain(spans).map(placed).collect(), yards.map(placed).collect())
}

fn opened(city: &Path) -> Opened {
    let reader = DirReader::new(city).unwrap_or_else(|e| panic!("{e}"));
    let read = |path: &str| reader.read(path, 1 << 28).unwrap_or_else(|e| panic!("{e}"));
    let index = read_index(&reader).unwrap_or_else(|e| panic!("{e}"));
    let styles = index.styles.unwrap_or_else(|| panic!("a city carries its styles"));
    let styles = decode_styles(&read(&styles.path()), &styles).unwrap_or_else(|e| panic!("{e}"));
    assert!(!styles.0.is_empty());
    let overview = read_overview(&reader, &index).unwrap_or_else(|e| panic!("{e}"));
    let named: BTreeSet<&str> = overview.streets.iter().map(|s| s.name.as_str()).filter(|name| !name.is_empty()).collect();
    let (mut roofs, mut things, mut yards, mut has_tunnel, mut shells) = (0, Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, cell) in index.cells() {
        let mut walls = 0;
        for level in Level::ALL {
            let Some(blob) = cell.packet(level) else { continue };
            match decode_packet(&read(&blob.path()), blob, level, index.packet_context(i))
                .unwrap_or_else(|e| panic!("cell {i}, {level}: {e}"))
            {
                Packet::Shell(shell) => {
                    let (things_here, yards_here) = boxes(&shell);
                    things.push(things_here);
                    yards.push(yards_here);
                    has_tunnel.push(shell.spans.iter().any(|span| span.is_bore() || span.is_ramp()));
                    assert!(!shell.ground.is_empty(), "cell {i} of {} has no ground", index.name);
                    roofs += shell.houses.iter().filter(|h| h.volumes.iter().any(|v| v.has_roof)).count() as u64;
                    walls = shell.houses.iter().flat_map(|h| &h.volumes).map(|v| v.walls.len()).sum();
                    shells.push(*shell);
                }
                Packet::Facades(sheet) => assert_eq!(sheet.walls.len(), walls, "cell {i}"),
                Packet::Pictures(_) => panic!("cell {i} of {} is painted", index.name),
            }
        }
        assert!(cell.packet(Level::One).is_some(), "cell {i} has no packet");
        assert_eq!(cell.walls as usize, walls, "cell {i}");
    }
    assert_eq!(roofs, index.cells().map(|(_, cell)| u64::from(cell.houses)).sum::<u64>());
    let named = named.len();
    Opened { index, overview, named, things, yards, has_tunnel, shells }
}

/// Of what is seen from cells, so much may be seen from one side alone: walls and roofs that are drawn with a cell round the corner.
const MOST_ONE_SIDED: f64 = 0.15;
/// So many may be for no reason that the packets tell.
const MOST_UNMET: f64 = 0.0001;

/// Whether two boxes touch.
fn touch(a: Box2, b: Box2) -> bool {
    a.0.0 <= b.1.0 && b.0.0 <= a.1.0 && a.0.1 <= b.1.1 && b.0.1 <= a.1.1
}

/// Portals belong to both their cells, visible sets hold the cell and its neighbours and see back, but for what stands at the border of
/// another cell that is seen; nearly all hangs together.
fn check_index(opened: &Opened) {
    let index = &opened.index;
    let cells: Vec<&CellEntry> = index.cells().map(|(_, cell)| cell).collect();
    let neighbours = |cell: u32| index.portals(cell).filter_map(move |portal| portal.other(cell)).collect::<Vec<u32>>();
    for cell in 0..index.cell_count() {
        for portal in index.portals(cell) {
            let sides = [Some(portal.cell), portal.other(portal.cell)];
            assert!(sides.contains(&Some(cell)), "{}: {portal:?} and cell {cell}", index.name);
            let knows = |side: u32| index.portals(side).any(|other| other == portal);
            assert!(sides.into_iter().flatten().all(knows), "{}: {portal:?}", index.name);
        }
    }
    let (mut all_seen, mut one_sided, mut unmet) = (0, 0, 0);
    for (i, cell) in (0..).zip(&cells) {
        let sees = |to: u32| cell.visible.binary_search(&to).is_ok();
        assert!(sees(i) && neighbours(i).into_iter().all(sees), "{}: cell {i} does not see its neighbours", index.name);
        all_seen += cell.visible.len();
        let is_blind = |&seen: &u32| cells[seen as usize].visible.binary_search(&i).is_err();
        let rooms = |k: u32| cells[k as usize].outline.bounds().into_iter().chain(opened.yards[k as usize].iter().copied());
        let rooms: Vec<(u32, Box2)> = cell.visible.iter().flat_map(|&k| rooms(k).map(move |room| (k, room))).collect();
        for seen in cell.visible.iter().copied().filter(is_blind) {
            one_sided += 1;
            let there: Vec<Box2> = [&opened.things, &opened.yards].into_iter().flat_map(|of| &of[seen as usize]).copied().collect();
            let whole = around(there.iter().flat_map(|&(lo, hi)| [lo, hi]));
            let meets = |&&(k, room): &&(u32, Box2)| k != seen && whole.is_some_and(|whole| touch(room, whole));
            let is_met = rooms.iter().filter(meets).any(|&(_, room)| there.iter().any(|&thing| touch(thing, room)));
            let is_met = is_met || [i, seen].iter().any(|&cell| opened.has_tunnel[cell as usize]);
            unmet += usize::from(!is_met);
        }
    }
    println!("{}: {one_sided} of {all_seen} are seen from one side alone, {unmet} of them for no reason", index.name);
    assert!(
        (unmet as f64) <= MOST_UNMET * all_seen as f64,
        "{}: {unmet} see nobody back and have nothing that stands elsewhere",
        index.name
    );
    assert!((one_sided as f64) < MOST_ONE_SIDED * all_seen as f64, "{}: {one_sided} of {all_seen} see nobody back", index.name);
    let start = index.locate(veduta_city::GridPos::from_metres(index.start.pos));
    let start = start.unwrap_or_else(|| panic!("{} begins outside of all cells", index.name));
    let mut reached = vec![false; cells.len()];
    let mut open = vec![start];
    while let Some(cell) = open.pop() {
        if !core::mem::replace(&mut reached[cell as usize], true) {
            open.extend(neighbours(cell));
        }
    }
    let area = |which: &dyn Fn(usize) -> bool| -> f64 {
        cells.iter().enumerate().filter(|&(i, _)| which(i)).map(|(_, c)| c.outline.area_m2()).sum()
    };
    let (here, all) = (area(&|i| reached[i]), area(&|_| true));
    assert!(here > 0.9 * all, "{}: {here:.0} m² of {all:.0} m² can be reached from the start", index.name);
}

fn ground_is_whole(expected: &Expected) {
    let Some(data) = shared::data() else { return };
    let input = Input::of(&data.join(expected.file)).unwrap_or_else(|e| panic!("{e}"));
    let plan = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
    println!("{}: {} patches", expected.file, plan.ground.len());
    prove_partition(&plan);
    prove_mesh(&plan);
}

/// Prints a line of a table: file, houses, cells, portals, named streets, squares, seen from a cell, findings, seconds, seconds a km².
fn becomes_a_city(name: &str, expected: &Expected) {
    let Some(data) = shared::data() else { return };
    let folder = Folder::new(name);
    let out = folder.0.join("x.city");
    let began = Instant::now();
    let mut settings = BakeSettings::default();
    if expected.file.starts_with("portland") {
        (settings.partition.sight_m, settings.partition.far_m) = (PORTLAND_SIGHT_M, PORTLAND_SIGHT_M);
    }
    let baked = bake(&data.join(expected.file), &out, &settings, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let seconds = began.elapsed().as_secs_f64();
    let opened = opened(&out);
    check_index(&opened);
    if !expected.file.starts_with("portland") {
        let proof = prove(&opened.index, &opened.shells, &ProofSettings { rays: RAYS, ..ProofSettings::default() });
        assert!(proof.hits > RAYS / 3, "{}: {} hits", expected.file, proof.hits);
        assert_eq!(proof.misses, 0, "{}: {:?}", expected.file, proof.missing);
        // Without districts near by, only what is seen over roofs is missing.
        let alone = ProofSettings { rays: RAYS, districts_m: -1.0, ..ProofSettings::default() };
        let alone = prove(&opened.index, &opened.shells, &alone);
        println!("{}: {} of {} rays see what districts near by tell of", expected.file, alone.misses, alone.hits);
        assert!(alone.misses as f64 <= MOST_OVER_ROOFS * alone.hits as f64, "{}: {} misses", expected.file, alone.misses);
    }
    let Opened { index, overview, named: streets, .. } = opened;
    let squares = overview.places.iter().filter(|p| p.kind == PlaceKind::Square).count();
    let seen: usize = index.cells().map(|(_, cell)| cell.visible.len()).sum();
    println!(
        "| {} | {} | {} | {} | {streets} | {squares} | {:.1} | {} | {seconds:.1} | {:.2} |",
        expected.file.split('/').next().unwrap_or_default(),
        baked.stats.houses,
        index.cell_count(),
        index.regions_here().map(|(_, region)| region.portals.len()).sum::<usize>(),
        seen as f64 / f64::from(index.cell_count()),
        baked.findings.len(),
        seconds / index.extent.area_m2() * 1e6
    );
    for (what, got, least) in [
        ("houses", baked.stats.houses, expected.houses),
        ("named streets", streets as u64, expected.streets as u64),
        ("squares", squares as u64, expected.squares as u64),
    ] {
        assert!(got >= least, "{}: {got} {what}, at least {least} are in the map", expected.file);
    }
    assert_eq!(index.cells().map(|(_, cell)| u64::from(cell.houses)).sum::<u64>(), baked.stats.houses);
    for finding in &baked.findings {
        assert!(finding.message.len() > 10 && !finding.message.ends_with('.'), "{}: {finding}", expected.file);
    }
}

/// Two tests for each extract: as many run at once as there are cores.
macro_rules! every_extract {
    ($($name:ident: $expected:expr,)*) => {
        mod the_ground_of_every_extract_is_whole {
            use super::{ground_is_whole, least};
            $(
                #[test]
                fn $name() {
                    ground_is_whole(&$expected);
                }
            )*
        }

        mod every_extract_becomes_a_city {
            use super::{becomes_a_city, least};
            $(
                #[test]
                fn $name() {
                    becomes_a_city(stringify!($name), &$expected);
                }
            )*
        }
    };
}

every_extract! {
    munich: least("munich_altstadt/munich_altstadt.osm.gz", 470, 80, 10),
    krems: least("krems_donau/krems_2013.osm.gz", 3500, 150, 0),
    lauf: least("lauf_pegnitz/lauf_an_der_pegnitz_2020.osm.pbf", 6400, 330, 0),
    helsinki: least("helsinki_centre/helsinki_centre_2019.osm.pbf", 3300, 205, 5),
    rome: least("rome_esquilino/rome_piazza_vittorio.osm.pbf", 900, 70, 3),
    valletta: least("valletta/valletta_2016.osm.pbf", 1700, 140, 1),
    new_york: least("new_york_greenwich/nyc_greenwich_village_2015.osm.pbf", 1500, 34, 0),
    frederiksted: least("frederiksted_grid/frederiksted.osm.pbf", 310, 20, 0),
    marrakech: least("marrakech_koutoubia/marrakech.osm.gz", 310, 17, 0),
    berlin: least("berlin_neukoelln/neukoelln.osm", 130, 7, 0),
    heidelberg: least("heidelberg_altstadt_roads/heidelberg_altstadt_roads.osm.pbf", 7000, 195, 3),
    prague_new_town: least("prague_new_town_roads/prague_new_town_roads_2017.osm", 5500, 165, 0),
    prague_karlovo_namesti: least("prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm", 30, 2, 0),
    portland: least("portland_dem/portland-central-filtered.osm.pbf", 65_000, 600, 0),
    berlin_siegessaeule: least("osm_tiny/berlin_siegessaeule.osm.gz", 12, 7, 0),
    tiny_roundabout: least("osm_tiny/tiny_roundabout.osm", 18, 1, 0),
    roof_shapes: least("roof_shapes/roof_shapes_real.osm", 20, 0, 0),
}

#[test]
fn cells_of_real_towns_keep_their_rules() {
    let Some(data) = shared::data() else { return };
    for file in [
        "munich_altstadt/munich_altstadt.osm.gz",
        "rome_esquilino/rome_piazza_vittorio.osm.pbf",
        "marrakech_koutoubia/marrakech.osm.gz",
        "frederiksted_grid/frederiksted.osm.pbf",
        "prague_new_town_roads/prague_new_town_roads_2017.osm",
        "osm_tiny/tiny_roundabout.osm",
    ] {
        let input = Input::of(&data.join(file)).unwrap_or_else(|e| panic!("{e}"));
        let settings = BakeSettings::default();
        let plan = plan(&input, &settings, &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
        let (cells, _) = cut(&plan, &[], &settings);
        let errors = veduta_cells::check(&plan, &cells);
        assert!(errors.is_empty(), "{file}: {} mistakes, the first: {}", errors.len(), errors[0]);
    }
}

#[test]
fn maps_of_single_buildings_end_in_a_model() {
    let Some(data) = shared::data() else { return };
    let folder = Folder::new("single");
    let mut maps: Vec<PathBuf> = std::fs::read_dir(data.join("roof_shapes/osmbuilding_tests"))
        .unwrap_or_else(|e| panic!("{e}"))
        .map(|entry| entry.unwrap_or_else(|e| panic!("{e}")).path())
        .collect();
    maps.sort();
    assert!(maps.len() > 10);
    for map in maps {
        let out = folder.0.join("x.city");
        let _ = std::fs::remove_dir_all(&out);
        let baked = bake_to(&map, &out).unwrap_or_else(|e| panic!("{}: {e}", map.display()));
        assert!(baked.stats.houses >= 1, "{}: {:?}", map.display(), baked.findings);
        check_index(&opened(&out));
    }
}

#[test]
fn a_map_without_streets_and_houses_is_refused_with_its_reasons() {
    let Some(data) = shared::data() else { return };
    let folder = Folder::new("grid");
    let out = folder.0.join("x.city");
    let error = bake_to(&data.join("osm_tiny/osm_testdata_grid_all.osm"), &out).expect_err("nothing to walk in");
    assert!(error.to_string().contains("neither streets nor buildings"), "{error}");
    assert!(files(&folder.0).is_empty());
}

#[test]
fn truncated_extracts_are_refused_and_nothing_is_written() {
    let Some(data) = shared::data() else { return };
    let folder = Folder::new("cut");
    for file in [
        "prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm",
        "osm_tiny/berlin_siegessaeule.osm.gz",
        "munich_altstadt/munich_altstadt.osm.gz",
        "frederiksted_grid/frederiksted.osm.pbf",
        "valletta/valletta_2016.osm.pbf",
    ] {
        let bytes = std::fs::read(data.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        let map = folder.0.join(Path::new(file).file_name().unwrap_or_default());
        let out = folder.0.join("x.city");
        for share in [0.0, 0.001, 0.1, 0.5, 0.9, 0.999] {
            let length = (bytes.len() as f64 * share) as usize;
            std::fs::write(&map, &bytes[..length]).unwrap_or_else(|e| panic!("{e}"));
            let error = bake_to(&map, &out).expect_err(&format!("{length} bytes of {file}"));
            assert!(error.to_string().contains(&*map.file_name().unwrap_or_default().to_string_lossy()), "{error}");
            assert_eq!(files(&folder.0).len(), 1, "{length} bytes of {file} left something");
        }
        std::fs::remove_file(&map).unwrap_or_else(|e| panic!("{e}"));
    }
}
