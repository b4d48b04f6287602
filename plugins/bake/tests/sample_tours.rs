//! The tours of the sample city compile on the streets that are grown from it.

use std::path::PathBuf;

use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{Overview, Tour, file};
use veduta_route::{Gazetteer, StreetNet, compile};

#[test]
fn every_tour_of_the_sample_city_can_be_played() {
    let scene = PathBuf::from("../../scenes/old_prague");
    let input = Input::of(&scene).unwrap_or_else(|e| panic!("{e}"));
    let planned = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let net = StreetNet::new(&Overview::of(&planned.plan).streets);
    let places = Gazetteer::new(&planned.plan.places);
    let mut tours = 0;
    for entry in std::fs::read_dir(&scene).expect("the scene is a folder") {
        let path = entry.expect("the scene can be read").path();
        if !path.to_string_lossy().ends_with(".tour.ron") {
            continue;
        }
        let tour: Tour = file::read(&path).unwrap_or_else(|e| panic!("{e}"));
        let compiled = compile(&tour, &net, &places).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        println!("{}: {:.1} s", path.display(), compiled.duration_s());
        assert!(compiled.duration_s() > 20.0, "{}: over before it begins", path.display());
        tours += 1;
    }
    assert!(tours >= 3, "{tours} tours are beside the city");
}
