use proptest::prelude::*;
use tiff::encoder::{TiffEncoder, colortype::Gray8};

use super::*;

const SIZE: (u32, u32) = (1000, 800);

fn known(text: &str) -> KnownPoint {
    text.parse().unwrap_or_else(|e: String| panic!("{e}"))
}

#[test]
fn the_plain_case_counts_from_the_lower_left_corner() {
    let plain = Georeference::from_metres_per_pixel("m", SIZE, 0.25).unwrap();
    assert_eq!(plain.plan_pos(DVec2::new(1000.0, 0.0)), DVec2::new(250.0, 200.0));
    assert_eq!(plain.pixel_pos(DVec2::new(250.0, 200.0)), DVec2::new(1000.0, 0.0));
    assert_eq!((plain.metres_per_pixel(), plain.is_placed()), (0.25, false));
    for wrong in [0.0, -1.0, f64::NAN, 1e-9, 1e9] {
        assert!(matches!(Georeference::from_metres_per_pixel("m", SIZE, wrong), Err(SurveyError::Unplaced { .. })), "{wrong}");
    }
    assert!(Georeference::from_metres_per_pixel("m", (0, 5), 1.0).is_err());
    assert!(Georeference::from_metres_per_pixel("m", (16_384, 5), 10.0).unwrap_err().to_string().contains("164 x 0 km"));
}

#[test]
fn two_known_points_come_out_where_they_are() {
    let points = [known("100,700=50.08,14.40"), known("900,100=50.09,14.42")];
    let made = Georeference::from_known_points("m", SIZE, points).unwrap();
    for p in points {
        let (lat, lon) = made.anchor().geo_from_plan(made.plan_pos(p.pixel));
        assert!((lat - p.lat).abs() < 1e-9 && (lon - p.lon).abs() < 1e-9, "{lat} {lon}");
    }
    assert!(made.plan_pos(DVec2::new(500.0, 400.0)).length() < 1.0, "the anchor is the middle");
    let size = made.pixel_size_m();
    assert!((size.x - size.y).abs() < 1e-9 && size.x > 1.0, "turned, not stretched: {size}");
    // North is up: a point above lies farther north.
    assert!(made.plan_pos(DVec2::new(500.0, 0.0)).y > made.plan_pos(DVec2::new(500.0, 800.0)).y);
}

#[test]
fn a_picture_that_is_turned_is_turned_back() {
    // North is to the right: going right goes north, going down goes east.
    let metres = Anchor { lat: 50.0, lon: 14.0 };
    let at = |x: f64, y: f64| metres.geo_from_plan(DVec2::new(x, y));
    let (a, b) = (at(0.0, 0.0), at(0.0, 900.0));
    let point = |pixel: DVec2, (lat, lon): (f64, f64)| KnownPoint { pixel, lat, lon };
    let made = Georeference::from_known_points("m", SIZE, [point(DVec2::ZERO, a), point(DVec2::new(900.0, 0.0), b)]).unwrap();
    let step = made.plan_pos(DVec2::new(0.0, 10.0)) - made.plan_pos(DVec2::ZERO);
    assert!(step.distance(DVec2::new(10.0, 0.0)) < 0.01, "{step}");
}

#[test]
fn points_that_say_too_little_are_refused() {
    let error = |a: &str, b: &str| Georeference::from_known_points("m.png", SIZE, [known(a), known(b)]).unwrap_err().to_string();
    assert!(error("1,1=50,14", "2,2=50.1,14.1").contains("opposite ends"));
    assert!(error("1,1=50,14", "900,700=50,14").contains("no scale"));
    assert!("1,1=91,14".parse::<KnownPoint>().unwrap_err().contains("latitude comes first"));
    assert!("1;1=9,14".parse::<KnownPoint>().unwrap_err().contains("column,row=latitude,longitude"));
}

#[test]
fn a_world_file_in_krovak_lies_in_prague() {
    let crs = Crs::from_epsg(5514).unwrap();
    let made = Georeference::from_world_file("m.pgw", SIZE, "0.5\n0\n0\n-0.5\n-744478.682\n-1042231.782\n", &crs).unwrap();
    // Half a metre a pixel: the middle is 249.75 m east and 199.75 m south of the first pixel's middle.
    assert!((made.anchor().lat - 50.0909).abs() < 1e-5 && (made.anchor().lon - 14.4005).abs() < 1e-5, "{:?}", made.anchor());
    assert!((made.metres_per_pixel() - 0.5).abs() < 1e-4, "{}", made.metres_per_pixel());
    // Krovak's north is not the meridian's: about 8 degrees apart in Prague.
    let up = made.plan_pos(DVec2::new(500.0, 0.0)) - made.plan_pos(DVec2::new(500.0, 800.0));
    let turn = libm::atan2(up.x, up.y).to_degrees();
    assert!((turn.abs() - 7.97).abs() < 0.3, "{turn}");
    let error = Georeference::from_world_file("m.pgw", SIZE, "0.5\n0\n0\n-0.5\n-7444\n-1042231\n", &Crs::WGS84).unwrap_err();
    assert!(error.to_string().contains("no place in EPSG:4326"), "{error}");
}

/// A small TIFF with tags.
fn geotiff(scale: &[f64], tie: &[f64], keys: &[u16]) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut out).unwrap();
    let mut image = encoder.new_image::<Gray8>(40, 20).unwrap();
    let directory = image.encoder();
    directory.write_tag(Tag::ModelPixelScaleTag, scale).unwrap();
    directory.write_tag(Tag::ModelTiepointTag, tie).unwrap();
    directory.write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
    image.write_data(&[0; 800]).unwrap();
    out.into_inner()
}

use tiff::tags::Tag;

#[test]
fn tags_of_a_geotiff_place_it() {
    let keys = [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32_633];
    let bytes = geotiff(&[2.0, 2.0, 0.0], &[0.0, 0.0, 0.0, 457_076.789, 5_548_929.553, 0.0], &keys);
    let made = Georeference::from_geotiff("m.tif", &bytes, None).unwrap().unwrap();
    assert!((made.anchor().lat - 50.0909).abs() < 1e-6 && (made.anchor().lon - 14.4005).abs() < 1e-6, "{:?}", made.anchor());
    assert!((made.metres_per_pixel() - 2.0).abs() < 0.002);
    let point = [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2, 3072, 0, 1, 32_633];
    let bytes = geotiff(&[2.0, 2.0, 0.0], &[0.0, 0.0, 0.0, 457_077.789, 5_548_928.553, 0.0], &point);
    let same = Georeference::from_geotiff("m.tif", &bytes, None).unwrap().unwrap();
    assert!((same.anchor().lat - made.anchor().lat).abs() < 1e-9, "a point's value belongs to the pixel's middle");
    let odd = [1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 31_468];
    let bytes = geotiff(&[2.0, 2.0, 0.0], &[0.0; 6], &odd);
    let error = Georeference::from_geotiff("m.tif", &bytes, None).unwrap_err();
    assert!(error.to_string().contains("EPSG:31468"), "{error}");
    assert!(Georeference::from_geotiff("m.tif", b"II*\0", None).is_err());
}

proptest! {
    #[test]
    fn pixels_come_back(column in 0.0f64..1000.0, row in 0.0f64..800.0) {
        let pixel = DVec2::new(column, row);
        let krovak = Georeference::from_world_file("m", SIZE, "0.5\n0\n0\n-0.5\n-744478\n-1042231\n", &Crs::from_epsg(5514).unwrap()).unwrap();
        let known = Georeference::from_known_points("m", SIZE, [known("0,800=50.08,14.40"), known("1000,0=50.09,14.42")]).unwrap();
        for made in [krovak, known] {
            prop_assert!(made.pixel_pos(made.plan_pos(pixel)).distance(pixel) < 0.01, "within five millimetres");
        }
    }

    #[test]
    fn mutated_tags_never_panic(at in 0usize..1100, with: u8) {
        let keys = [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32_633];
        let mut bytes = geotiff(&[2.0, 2.0, 0.0], &[0.0, 0.0, 0.0, 457_076.789, 5_548_929.553, 0.0], &keys);
        if let Some(byte) = bytes.get_mut(at) {
            *byte = with;
        }
        if let Ok(Some(made)) = Georeference::from_geotiff("m.tif", &bytes, None) {
            prop_assert!(made.plan_pos(DVec2::ZERO).is_finite());
        }
    }
}
