//! `veduta-bake survey` on pictures: where they lie, and what is refused.

use std::path::Path;
use std::process::Command;

use glam::DVec2;
use veduta_city::{CityGraph, file};
use veduta_survey::raster::{Legend, Picture, PictureLimits};

#[path = "shared/folder.rs"]
mod folder;

use folder::Folder;

const SIZE: u32 = 400;
const LEGEND: &str = r#"{ "classes": { "street": [[255, 254, 248]], "built": [[226, 211, 190]] } }"#;

/// Two streets that cross in the picture's middle, with a legend that tells no scale.
fn town(folder: &Folder) {
    let paved = |x: u32, y: u32| x.abs_diff(SIZE / 2) < 10 || y.abs_diff(SIZE / 2) < 8;
    let colour = |i: u32| if paved(i % SIZE, i / SIZE) { [255, 254, 248] } else { [226, 211, 190] };
    let pixels: Vec<u8> = (0..SIZE * SIZE).flat_map(colour).collect();
    let file = std::fs::File::create(folder.0.join("town.png")).unwrap_or_else(|e| panic!("{e}"));
    let mut encoder = png::Encoder::new(file, SIZE, SIZE);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap_or_else(|e| panic!("{e}"));
    writer.write_image_data(&pixels).unwrap_or_else(|e| panic!("{e}"));
    folder.write("town.legend.json", LEGEND);
}

/// Surveys the town; the graph, or what the program says instead.
fn survey(folder: &Folder, arguments: &[&str]) -> Result<CityGraph, String> {
    let out = folder.0.join("out.graph.ron");
    let mut command = Command::new(env!("CARGO_BIN_EXE_veduta-bake"));
    command.arg("survey").arg(folder.0.join("town.png")).arg("-o").arg(&out).args(arguments);
    let output = command.output().unwrap_or_else(|e| panic!("{e}"));
    if output.status.success() {
        Ok(file::read(Path::new(&out)).unwrap_or_else(|e| panic!("{e}")))
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

/// The crossroads' place and the widths of the streets that meet there.
fn crossroads(graph: &CityGraph) -> (DVec2, f64) {
    let ends = |id| graph.links.iter().filter(|link| link.from == id || link.to == id).count();
    let node = graph.nodes.iter().find(|node| ends(node.id) == 4).unwrap_or_else(|| panic!("no crossroads"));
    (node.pos, graph.links.iter().map(|link| link.width_m).fold(0.0, f64::max))
}

#[test]
fn a_scale_that_is_given_puts_the_lower_left_corner_at_nought() {
    let folder = Folder::new("raster-scale");
    town(&folder);
    let (at, widest) = crossroads(&survey(&folder, &["--metres-per-pixel", "0.5"]).unwrap_or_else(|e| panic!("{e}")));
    assert!(at.distance(DVec2::splat(100.0)) < 1.0, "{at}");
    assert!((widest - 9.5).abs() < 0.6, "{widest}");
}

#[test]
fn a_guessed_legend_tells_the_scale_that_is_known() {
    let folder = Folder::new("raster-guess");
    town(&folder);
    std::fs::remove_file(folder.0.join("town.legend.json")).unwrap_or_else(|e| panic!("{e}"));
    let legend = |arguments: &[&str]| {
        survey(&folder, arguments).unwrap_or_else(|e| panic!("{e}"));
        let text = std::fs::read_to_string(folder.0.join("out.legend.ron")).unwrap_or_else(|e| panic!("{e}"));
        let legend = Legend::parse(&text, "out.legend.ron").unwrap_or_else(|e| panic!("{e}"));
        (text.contains("the scale is not known: write it here"), legend)
    };
    let (is_unknown, known) = legend(&["--metres-per-pixel", "0.25"]);
    assert_eq!((is_unknown, known.metres_per_pixel, known.colours.len()), (false, Some(0.25), 2));
    let (is_unknown, unknown) = legend(&[]);
    assert_eq!((is_unknown, unknown.metres_per_pixel), (true, None));
    assert_eq!(unknown.colours, known.colours);
}

#[test]
fn a_world_file_places_the_picture_and_asks_for_its_coordinate_system() {
    let folder = Folder::new("raster-world");
    town(&folder);
    // UTM zone 33 north: a metre and a half a pixel, from 458,000 east and 5,549,000 north.
    folder.write("town.pgw", "1.5\n0\n0\n-1.5\n458000.75\n5548999.25\n");
    let refused = survey(&folder, &[]).expect_err("the coordinate system is not known");
    assert!(refused.contains("--crs") && refused.contains("town.pgw"), "{refused}");
    let graph = survey(&folder, &["--crs", "EPSG:32633"]).unwrap_or_else(|e| panic!("{e}"));
    let (at, widest) = crossroads(&graph);
    assert!(at.length() < 3.0, "plan (0, 0) is the picture's middle, and the crossroads at {at}");
    assert!((widest - 3.0 * 9.5).abs() < 2.0, "{widest}");
    assert!((graph.anchor.lat - 50.09).abs() < 0.02 && (graph.anchor.lon - 14.41).abs() < 0.02, "{:?}", graph.anchor);
    folder.write("town.prj", "EPSG:32633\n");
    assert_eq!(survey(&folder, &[]).unwrap_or_else(|e| panic!("{e}")), graph, "a .prj beside it says the same");
    // A scale that is given leaves the place out.
    let bare = survey(&folder, &["--metres-per-pixel", "0.5"]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(bare.anchor.lat, 0.0);
}

#[test]
fn two_known_points_place_the_picture_and_one_does_not() {
    let folder = Folder::new("raster-known");
    town(&folder);
    let (a, b) = ("0,0=50.0900,14.4100", "400,0=50.0900,14.4200");
    let refused = survey(&folder, &["--known-point", a]).expect_err("one point is too few");
    assert!(refused.contains("--known-point twice"), "{refused}");
    let graph = survey(&folder, &["--known-point", a, "--known-point", b]).unwrap_or_else(|e| panic!("{e}"));
    // 0.01 degrees of longitude are 715 m there.
    let (at, widest) = crossroads(&graph);
    assert!(at.length() < 3.0 && (widest - 19.0 * 1.789).abs() < 2.0, "{at}, {widest}");
    assert!((graph.anchor.lon - 14.415).abs() < 1e-3 && graph.anchor.lat < 50.09, "{:?}", graph.anchor);
    let refused = survey(&folder, &["--known-point", "here"]).expect_err("no point");
    assert!(refused.contains("column,row=latitude,longitude"), "{refused}");
}

#[test]
fn stages_are_written_and_one_that_was_mended_is_taken_as_it_is() {
    let folder = Folder::new("raster-stages");
    town(&folder);
    let stages = folder.0.join("stages");
    let to = stages.to_string_lossy().into_owned();
    let graph = survey(&folder, &["--metres-per-pixel", "0.5", "--stages", &to]).unwrap_or_else(|e| panic!("{e}"));
    for stage in ["classes", "streets", "skeleton"] {
        let file = stages.join(format!("town.{stage}.png"));
        let again = survey(&folder, &["--metres-per-pixel", "0.5", "--from", &file.to_string_lossy()]);
        assert_eq!(again.unwrap_or_else(|e| panic!("{e}")), graph, "{stage} as they were found change nothing");
    }
    // One arm of the crossroads painted over, in a paint program.
    let file = stages.join("town.streets.png");
    let bytes = std::fs::read(&file).unwrap_or_else(|e| panic!("{e}"));
    let mut picture = Picture::decode(&bytes, "town.streets.png", &PictureLimits::default()).unwrap_or_else(|e| panic!("{e}"));
    for (i, channel) in picture.pixels.iter_mut().enumerate() {
        let (x, y) = (i / 3 % SIZE as usize, i / 3 / SIZE as usize);
        if (230..400).contains(&x) && (180..220).contains(&y) {
            *channel = 0;
        }
    }
    let out = std::fs::File::create(&file).unwrap_or_else(|e| panic!("{e}"));
    picture.write_png(out).unwrap_or_else(|e| panic!("{e}"));
    let mended =
        survey(&folder, &["--metres-per-pixel", "0.5", "--from", &file.to_string_lossy()]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((graph.links.len(), mended.links.len()), (4, 3));
    let refused = survey(&folder, &["--from", &folder.0.join("town.png").to_string_lossy()]).expect_err("no stage");
    assert!(refused.contains("which stage"), "{refused}");
}
