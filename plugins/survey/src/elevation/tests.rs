use proptest::prelude::*;
use veduta_city::{Building, CityGraph, Id, Link, LinkKind, Node, Severity, StreetClass};

use super::*;

/// A grid of metres around latitude 50, longitude 14, in UTM, whose plan positions are those of the city below.
fn grid(columns: u32, rows: u32, cell_m: f64, height: impl Fn(f64, f64) -> f64) -> ElevationGrid {
    let crs = Crs::from_epsg(32_633).unwrap();
    let origin = crs.pos_from_geo(50.0, 15.0).unwrap();
    let mut text = format!(
        "ncols {columns}\nnrows {rows}\nxllcorner {}\nyllcorner {}\ncellsize {cell_m}\nNODATA_value -9999\n",
        origin.x, origin.y
    );
    for row in (0..rows).rev() {
        for column in 0..columns {
            let (x, y) = ((f64::from(column) + 0.5) * cell_m, (f64::from(row) + 0.5) * cell_m);
            text += &format!("{:.3} ", height(x, y));
        }
        text += "\n";
    }
    ElevationGrid::read(text.as_bytes(), "made.asc", Some("EPSG:32633")).unwrap()
}

/// On UTM's central meridian the grid's metres are 0.9996 of the plan's; the city lies where the grid begins.
fn city(nodes: &[(f64, f64)], links: &[(u64, u64, i8)]) -> CityGraph {
    let mut graph = CityGraph { anchor: Anchor { lat: 50.0, lon: 15.0 }, ..CityGraph::default() };
    graph.nodes = (1..).zip(nodes).map(|(i, &(x, y))| Node { id: Id(i), pos: DVec2::new(x, y), z: 7.0 }).collect();
    graph.links = links
        .iter()
        .map(|&(from, to, layer)| Link {
            id: Id::NONE,
            from: Id(from),
            to: Id(to),
            via: Vec::new(),
            kind: LinkKind::Street(StreetClass::Street),
            width_m: 0.0,
            profile: Vec::new(),
            name: String::new(),
            layer,
            surfacing: None,
        })
        .collect();
    graph.fill_ids();
    graph
}

fn house(x: f64, y: f64, side: f64) -> Building {
    let outline = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(dx, dy)| DVec2::new(x + dx, y + dy));
    Building { outline: outline.into(), ..ron_house() }
}

fn ron_house() -> Building {
    Building {
        id: Id::NONE,
        name: String::new(),
        number: String::new(),
        style: String::new(),
        outline: Vec::new(),
        holes: Vec::new(),
        min_height_m: 0.0,
        height_m: None,
        levels: None,
        roof: Default::default(),
        colour: None,
        parts: Vec::new(),
        monument: None,
    }
}

#[test]
fn a_slope_is_read_exactly_between_its_cells() {
    let slope = grid(40, 40, 10.0, |x, y| 200.0 + 0.1 * x - 0.05 * y);
    let mut graph = city(&[(100.0, 100.0), (203.0, 147.0), (307.0, 20.0)], &[(1, 2, 0), (2, 3, 0)]);
    assert!(drape(&mut graph, &slope).is_empty(), "nothing to tell of a plain slope");
    let expected = |p: DVec2| 200.0 + 0.9996 * (0.1 * p.x - 0.05 * p.y);
    let lowest = graph.nodes.iter().map(|n| expected(n.pos)).fold(f64::INFINITY, f64::min);
    assert_eq!(graph.zero_m, lowest.floor());
    for node in &graph.nodes {
        assert!((graph.zero_m + node.z - expected(node.pos)).abs() < 0.02, "{node:?}");
        assert!(node.z >= 0.0 && (node.z * 100.0).fract().abs() < 1e-6);
    }
    let ground = graph.terrain.as_ref().expect("ground");
    assert_eq!((ground.check(), ground.step_m), (Ok(()), 10.0));
    let (low, high) = (ground.origin, DVec2::new(407.0, 217.0));
    assert!(low.cmple(DVec2::new(100.0, 20.0) - 40.0).all(), "{low}");
    for p in [DVec2::new(100.0, 20.0), DVec2::new(222.2, 133.3), DVec2::new(307.0, 147.0)] {
        assert!((graph.zero_m + ground.height_m(p) - expected(p)).abs() < 0.02 && p.cmple(high).all());
    }
    let once = graph.clone();
    drape(&mut graph, &slope);
    assert_eq!(graph, once, "draping again gives the same");
}

#[test]
fn a_bridge_rises_evenly_and_does_not_follow_the_river() {
    let valley = grid(40, 10, 10.0, |x, _| if (150.0..250.0).contains(&x) { 180.0 } else { 200.0 });
    let mut graph = city(
        &[(100.0, 50.0), (160.0, 50.0), (220.0, 50.0), (280.0, 50.0), (200.0, 20.0), (200.0, 80.0)],
        &[(1, 2, 1), (2, 3, 1), (3, 4, 1), (1, 5, 0), (4, 5, 0), (5, 6, 0)],
    );
    drape(&mut graph, &valley);
    let z: Vec<f64> = graph.nodes.iter().map(|n| graph.zero_m + n.z).collect();
    assert_eq!(z, [200.0, 200.0, 200.0, 200.0, 180.0, 180.0]);
}

#[test]
fn a_spike_is_reported_with_its_place_and_passed_over() {
    let spiked = grid(40, 40, 10.0, |x, y| if (x, y) == (205.0, 205.0) { 900.0 } else { 200.0 + 0.02 * x });
    let mut graph = city(&[(205.0, 205.0), (100.0, 100.0)], &[(1, 2, 0)]);
    let findings = drape(&mut graph, &spiked);
    assert!((graph.zero_m + graph.nodes[0].z - 204.1).abs() < 0.1, "{:?}", graph.nodes);
    let spike = findings.iter().find(|f| f.message.contains("900.0 m")).unwrap_or_else(|| panic!("{findings:?}"));
    assert_eq!(spike.severity, Severity::Repaired);
    assert!(spike.plan_pos.unwrap().distance(DVec2::new(205.0, 205.0)) < 0.2, "{spike}");
    assert!(findings.iter().any(|f| f.id == Id(1) && f.message.contains("holes")), "{findings:?}");
    let steps = grid(40, 40, 1.0, |x, y| if x > 20.0 && y > 20.0 { 215.0 } else { 200.0 });
    assert!(steps.spikes((0, 0), (40, 40)).is_empty(), "the corner of a wall is no spike");
}

#[test]
fn small_holes_are_filled_and_large_ones_told() {
    let with_hole = |side: f64| {
        grid(200, 200, 10.0, move |x, y| {
            let inside = (x - 1005.0).abs() < side / 2.0 && (y - 1005.0).abs() < side / 2.0;
            if inside { -9999.0 } else { 300.0 + 0.01 * x }
        })
    };
    let nodes = [(1005.0, 1005.0), (100.0, 100.0)];
    let mut graph = city(&nodes, &[(1, 2, 0)]);
    let findings = drape(&mut graph, &with_hole(300.0));
    assert!((graph.zero_m + graph.nodes[0].z - 310.0).abs() < 0.3, "{:?}", graph.nodes);
    assert_eq!((findings.len(), findings[0].severity), (1, Severity::Note), "{findings:?}");
    let findings = drape(&mut graph, &with_hole(1500.0));
    let told: Vec<Severity> = findings.iter().map(|f| f.severity).collect();
    assert_eq!(told, [Severity::Note, Severity::Repaired], "{findings:?}");
    assert!(findings[0].message.contains("posts of the ground") && findings[1].message.contains("large hole"));
    assert!(graph.terrain.as_ref().is_some_and(|ground| ground.check().is_ok()));
    assert_eq!(graph.nodes[0].z, graph.nodes[1].z, "guessed from its neighbour");
    // At the ragged border of the data nothing is carried far out.
    let half = grid(200, 20, 10.0, |x, _| if x < 1000.0 { 250.0 } else { -9999.0 });
    let at = |x: f64| half.at_plan(graph.anchor, DVec2::new(x, 100.0));
    assert!(at(1010.0).is_some_and(|h| (h - 250.0).abs() < 1e-6) && at(1100.0).is_none(), "{:?}", at(1010.0));
}

#[test]
fn nodes_outside_are_told_once_with_the_first_place() {
    let small = grid(10, 10, 10.0, |_, _| 240.0);
    let mut graph = city(&[(50.0, 50.0), (500.0, 50.0), (900.0, 50.0)], &[(1, 2, 0), (2, 3, 0)]);
    let findings = drape(&mut graph, &small);
    assert_eq!(findings.len(), 2, "{findings:?}");
    let outside = &findings[1];
    assert!(outside.message.contains("outside of made.asc") && outside.message.contains("first of 2"), "{outside}");
    assert_eq!((outside.id, outside.plan_pos), (Id(2), Some(DVec2::new(500.0, 50.0))));
    assert!(graph.nodes.iter().all(|n| n.z == 0.0));
    graph.anchor.lat = 40.0;
    let before = graph.clone();
    let findings = drape(&mut graph, &small);
    assert!(findings[0].severity == Severity::Dropped && findings[0].message.contains("latitude 40.0000"), "{}", findings[0]);
    assert_eq!(graph, before);
}

#[test]
fn houses_get_the_height_of_their_roofs() {
    let ground = |x: f64, _: f64| 200.0 + 0.02 * x;
    let roofs = |x: f64, y: f64| {
        let ridge = (x - 40.0).abs();
        match (x, y) {
            // A chimney over the roof, and a mast.
            (x, y) if (42.0..43.0).contains(&x) && (40.0..41.0).contains(&y) => 230.0,
            (x, y) if (30.0..50.0).contains(&x) && (30.0..50.0).contains(&y) => ground(40.0, y) + 12.0 - 0.4 * ridge,
            (x, y) if (60.0..70.0).contains(&x) && (30.0..40.0).contains(&y) => ground(x, y) + 6.0,
            (x, y) => ground(x, y),
        }
    };
    let (terrain, surface) = (grid(120, 120, 1.0, ground), grid(120, 120, 1.0, roofs));
    for terrain in [Some(&terrain), None] {
        let mut graph = city(&[(5.0, 5.0), (100.0, 5.0)], &[(1, 2, 0)]);
        graph.buildings = vec![house(30.0, 30.0, 20.0), house(60.0, 30.0, 10.0), house(90.0, 90.0, 10.0), house(5.0, 90.0, 1.0)];
        graph.buildings.push(Building { height_m: Some(99.0), ..house(62.0, 32.0, 5.0) });
        graph.fill_ids();
        let findings = heights_from_surface(&mut graph, &surface, terrain);
        let heights: Vec<Option<f64>> = graph.buildings.iter().map(|b| b.height_m).collect();
        assert!((heights[0].unwrap() - 11.6).abs() < 0.4, "between eaves of 8 and a ridge of 12 m, not the chimney: {heights:?}");
        assert!((heights[1].unwrap() - 6.0).abs() < 0.3, "{heights:?}");
        assert_eq!(heights[2..], [None, None, Some(99.0)], "nothing stands, too small, given");
        assert_eq!(findings.len(), 3, "{findings:?}");
    }
}

/// A whole file in each of the formats.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    use tiff::encoder::{Compression, TiffEncoder, colortype};
    let text =
        b"ncols 4\nnrows 3\nxllcorner 14\nyllcorner 50\ncellsize 0.05\nNODATA_value -1\n1 2 3 4\n5 6 7 8\n9 10 -1 12\n".to_vec();
    let keys: [u16; 12] = [1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326];
    let tiff = |compression: Compression| {
        let mut out = std::io::Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut out).unwrap().with_compression(compression);
        let mut image = encoder.new_image::<colortype::Gray32Float>(20, 30).unwrap();
        image.rows_per_strip(7).unwrap();
        let tags = image.encoder();
        tags.write_tag(tiff::tags::Tag::ModelPixelScaleTag, &[0.01, 0.01, 0.0][..]).unwrap();
        tags.write_tag(tiff::tags::Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 14.0, 50.5, 0.0][..]).unwrap();
        tags.write_tag(tiff::tags::Tag::GeoKeyDirectoryTag, &keys[..]).unwrap();
        tags.write_tag(tiff::tags::Tag::GdalNodata, "-9999").unwrap();
        let values: Vec<f32> = (0..600).map(|i| if i == 5 { -9999.0 } else { i as f32 }).collect();
        image.write_data(&values).unwrap();
        out.into_inner()
    };
    let zipped = packed::tests::zip(&[("a.asc", &text), ("a.prj", b"EPSG:4326")]);
    vec![
        ("a.asc", text),
        ("a.tif", tiff(Compression::Uncompressed)),
        ("b.tif", tiff(Compression::Deflate(tiff::encoder::compression::DeflateLevel::Fast))),
        ("c.tif", tiff(Compression::Lzw)),
        ("a.zip", zipped),
    ]
}

#[test]
fn formats_are_told_by_content() {
    for (name, bytes) in files() {
        let grid = ElevationGrid::read(&bytes, "no_ending", Some("EPSG:4326")).unwrap_or_else(|e| panic!("{name}: {e}"));
        let (lat, lon, expected) = if name.ends_with("tif") { (50.495, 14.005, 0.0) } else { (50.125, 14.025, 1.0) };
        assert!((grid.at(lat, lon).unwrap() - expected).abs() < 1e-3, "{name}: {grid:?}");
        assert!(grid.share_of_holes() > 0.0, "{name}: the hole is a hole");
        // Degrees counted round the other way.
        assert!((grid.at(lat, lon - 360.0).unwrap() - expected).abs() < 1e-3, "{name}");
    }
    let error = |bytes: &[u8], prj| ElevationGrid::read(bytes, "x.bin", prj).unwrap_err().to_string();
    assert!(error(b"hello", None).contains("neither an ESRI ASCII grid"));
    let text = &files()[0].1;
    assert!(error(text, None).contains("put a .prj beside it"), "{}", error(text, None));
    assert!(error(text, Some("EPSG:31468")).contains("EPSG:31468"));
    assert!(
        error(&String::from_utf8_lossy(text).replace("yllcorner 50", "yllcorner 500000").into_bytes(), Some("4326"))
            .contains("no place")
    );
}

/// A little-endian TIFF of 32-bit grey as given: data from byte 8 on, then the directory.
fn raw_tiff(data: &[u8], width: u32, height: u32, compression: u32, more: &[(u16, &[u32])]) -> Vec<u8> {
    let (width, height, compression) = ([width], [height], [compression]);
    let first: [(u16, &[u32]); 5] = [(256, &width), (257, &height), (258, &[32]), (259, &compression), (262, &[1])];
    let (mut out, mut arrays, mut entries) = (b"II*\0".to_vec(), Vec::new(), Vec::new());
    for &(tag, values) in first.iter().chain(more) {
        let at = (8 + data.len() + arrays.len()) as u32;
        let value = if let &[one] = values { one } else { at };
        if values.len() > 1 {
            arrays.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        }
        let count = (values.len() as u32).to_le_bytes();
        entries.extend(tag.to_le_bytes().into_iter().chain([4, 0]).chain(count).chain(value.to_le_bytes()));
    }
    out.extend(((8 + data.len() + arrays.len()) as u32).to_le_bytes().iter().chain(data).chain(&arrays));
    out.extend(((entries.len() / 12) as u16).to_le_bytes().iter().chain(&entries).chain(&[0; 4]));
    out
}

#[test]
fn tiles_are_put_in_their_places_and_empty_ones_are_holes() {
    // Three tiles of 16 x 16 across, two down; the fifth is left out.
    let tile = |i: usize| (0..256).flat_map(move |p| ((1000 * i + p) as f32).to_le_bytes());
    let data: Vec<u8> = (0..6).flat_map(tile).collect();
    let offsets: Vec<u32> = (0..6).map(|i| 8 + 1024 * i).collect();
    let counts = [1024, 1024, 1024, 1024, 0, 1024];
    let bytes =
        raw_tiff(&data, 40, 20, 1, &[(277, &[1]), (322, &[16]), (323, &[16]), (324, &offsets), (325, &counts), (339, &[3])]);
    let cells = geotiff::read(&bytes, "t.tif").unwrap();
    assert_eq!((cells.columns, cells.rows), (40, 20));
    let at = |column: usize, row: usize| cells.heights[row * 40 + column];
    assert_eq!((at(0, 0), at(17, 2), at(39, 15), at(3, 17), at(33, 19)), (0.0, 1033.0, 2247.0, 3019.0, 5049.0));
    assert!(at(16, 16).is_nan() && at(31, 19).is_nan(), "a tile of no bytes");
    assert_eq!(cells.heights.iter().filter(|h| h.is_nan()).count(), 16 * 4);
    let error = ElevationGrid::read(&bytes, "t.tif", Some("EPSG:4326")).unwrap_err().to_string();
    assert!(error.contains("tags do not tell where it lies"), "{error}");
}

#[test]
fn headers_that_lie_are_refused_before_room_is_made() {
    // One strip at byte 8.
    let tiff = |width: u32, height: u32, rows_per_strip: u32, compression: u32, count: u32| {
        let (rows, strip) = ([rows_per_strip], [count]);
        raw_tiff(&[0; 16], width, height, compression, &[(273, &[8]), (277, &[1]), (278, &rows), (279, &strip), (339, &[3])])
    };
    let error = |bytes: Vec<u8>| ElevationGrid::read(&bytes, "x.tif", Some("4326")).unwrap_err();
    assert!(matches!(error(tiff(20_000, 20_000, 20_000, 1, 16)), SurveyError::GridTooLarge { columns: 20_000, .. }));
    for compression in [1, 5, 8] {
        let told = error(tiff(16_384, 16_384, 16_384, compression, 16));
        assert!(matches!(told, SurveyError::Cut { .. }), "{told}");
    }
    assert!(matches!(error(tiff(100, 100, 100, 1, 40_000)), SurveyError::Cut { .. }));
    assert!(matches!(error(tiff(100, 100, 100, 1, 0)), SurveyError::Broken { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(700) })]

    #[test]
    fn mutated_files_are_read_or_refused(which in 0usize..5, at in proptest::collection::vec((0.0f64..1.0, any::<u8>()), 1..6), cut in 0.0f64..1.4) {
        let (name, mut bytes) = files().swap_remove(which);
        for (place, with) in at {
            // Headers stand at the front of the one and at the end of the other.
            let length = bytes.len();
            let index = (if with % 2 == 0 { place } else { 1.0 - place * 0.2 } * length as f64) as usize;
            if let Some(byte) = bytes.get_mut(index.min(length - 1)) {
                *byte = with;
            }
        }
        bytes.truncate(((bytes.len() as f64 * cut) as usize).max(1));
        if let Ok(grid) = ElevationGrid::read(&bytes, name, Some("EPSG:4326")) {
            prop_assert!(u64::from(grid.size().0) * u64::from(grid.size().1) <= MOST_CELLS);
            let (low, high) = grid.range_m();
            prop_assert!(low >= -1000.0 && high <= 9000.0);
            prop_assert!(grid.at(50.1, 14.1).is_none_or(|h| (low..=high).contains(&h)));
        }
    }

    #[test]
    fn any_text_after_a_header_is_read_or_refused(text in "[-0-9. \\neE]{0,40}", columns in 0u64..5, rows in 0u64..5) {
        let file = format!("ncols {columns}\nnrows {rows}\nxllcorner 14\nyllcorner 50\ncellsize 0.05\n{text}");
        if let Ok(grid) = ElevationGrid::read(file.as_bytes(), "a.asc", Some("4326")) {
            prop_assert_eq!((u64::from(grid.size().0), u64::from(grid.size().1)), (columns, rows));
        }
    }
}
