//! Ways on foot between the named places of real maps: each leads there from every other, or baking says why not. `VEDUTA_DATA` names
//! the folder of maps; without it `shared/data` beside the workspace is looked for, and where there is none the test says so and passes.

mod shared;

use std::collections::BTreeSet;
use std::path::Path;

use veduta_bake::{BakeSettings, Input, bake, plan};
use veduta_city::{CityPlan, Place};
use veduta_route::{StreetNet, Unreached, unreached};

/// Maps of every kind of town, none so large that growing it takes long.
const MAPS: &[&str] = &[
    "munich_altstadt/munich_altstadt.osm.gz",
    "krems_donau/krems_2013.osm.gz",
    "rome_esquilino/rome_piazza_vittorio.osm.pbf",
    "valletta/valletta_2016.osm.pbf",
    "new_york_greenwich/nyc_greenwich_village_2015.osm.pbf",
    "frederiksted_grid/frederiksted.osm.pbf",
    "marrakech_koutoubia/marrakech.osm.gz",
    "berlin_neukoelln/neukoelln.osm",
    "prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm",
    "helsinki_centre/helsinki_centre_2019.osm.pbf",
];

/// What lies across a harbour, or where the map's edge has cut streets off, cannot be walked to: a twentieth of all places at most, and as
/// many as these of a small map. In Valletta it is Birgu and Manoel Island, in Krems Furth beyond the Danube.
const MOST_APART: (usize, usize) = (4, 20);

/// What is baked besides, so that the report itself is read.
const BAKED: &str = "marrakech_koutoubia/marrakech.osm.gz";

fn grown(map: &Path) -> CityPlan {
    let input = Input::of(map).unwrap_or_else(|e| panic!("{e}"));
    plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{}: {e}", map.display())).plan
}

fn stand(place: &Place) -> glam::DVec2 {
    place.view.map_or(place.pos, |view| view.pos)
}

/// The places that no way leads to from a place of those that most can be walked between.
fn found_by_walking<'a>(net: &StreetNet, plan: &'a CityPlan, told: &[Unreached<'_>]) -> BTreeSet<&'a str> {
    let is_told = |place: &Place| told.iter().any(|one| core::ptr::eq(one.place, place));
    let reached: Vec<&Place> = plan.places.iter().filter(|place| !is_told(place)).collect();
    let Some(first) = reached.first() else { return plan.places.iter().map(|place| place.name.as_str()).collect() };
    // Between some of those that are reached, each way.
    let some: Vec<&Place> = reached.iter().step_by(reached.len().div_ceil(12)).copied().collect();
    for a in &some {
        for b in &some {
            net.way(stand(a), stand(b)).unwrap_or_else(|e| panic!("{} to {}: {e}", a.name, b.name));
        }
    }
    let cannot = |place: &&Place| net.way(stand(first), stand(place)).is_err();
    plan.places.iter().filter(cannot).map(|place| place.name.as_str()).collect()
}

#[test]
fn every_place_of_a_real_map_can_be_walked_to_or_baking_says_why_not() {
    let Some(data) = shared::data() else { return };
    for &map in MAPS {
        let plan = grown(&data.join(map));
        let net = StreetNet::new(&plan.streets);
        let told = unreached(&net, &plan.places);
        for Unreached { place, why } in &told {
            let why = why.map_or_else(|| "the streets there are not joined to the others".to_owned(), |why| why.to_string());
            println!("{map}: {} ({:?}) at {:.0}: {why}", place.name, place.kind, place.pos);
        }
        println!("{map}: {} places, {} of them apart", plan.places.len(), told.len());
        let names: BTreeSet<&str> = told.iter().map(|one| one.place.name.as_str()).collect();
        assert_eq!(found_by_walking(&net, &plan, &told), names, "{map}");
        assert!(told.len() <= MOST_APART.0 + plan.places.len() / MOST_APART.1, "{map}: {names:?}");
        if map == BAKED {
            reported(&data.join(map), &told);
        }
    }
}

/// That baking reports these places, each with a reason, and no others.
fn reported(map: &Path, told: &[Unreached<'_>]) {
    let out = std::env::temp_dir().join(format!("veduta-reachability-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&out);
    let baked = bake(map, &out, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let _ = std::fs::remove_dir_all(&out);
    let is_way = |message: &&str| message.starts_with("no way on foot leads to");
    let found: BTreeSet<&str> = baked.findings.iter().map(|finding| finding.message.as_str()).filter(is_way).collect();
    assert_eq!(found.len(), told.len(), "{found:?}");
    for Unreached { place, why } in told {
        let reason = why.map_or_else(|| "not joined".to_owned(), |why| why.to_string());
        let is_reported = |message: &&&str| message.contains(&format!("“{}”", place.name)) && message.contains(&reason);
        assert!(found.iter().any(|message| is_reported(&message)), "{}: {found:?}", place.name);
    }
}
