//! Real maps, from the file to a step in a street: every extract bakes and can be walked in.

use std::path::{Path, PathBuf};

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta::ecs::StandingCells;
use veduta::prelude::*;
use veduta::walker::Intent;
use veduta_bake::{BakeSettings, bake};
use veduta_city::{GridPos, metres};
use veduta_tests::{root, walker_in, workplace};

/// Portland spans 70 km²: its sight is cut short here, so that the test is.
const PORTLAND_SIGHT_M: f64 = 120.0;

/// The shared extracts; `None`, told aloud, where there are none.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("VEDUTA_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no shared data");
    None
}

/// Whether a plan position lies in the walls of a house of a cell that stands.
fn in_a_house(app: &App, at: DVec2) -> bool {
    let at = GridPos(GridPos::steps(at.x), GridPos::steps(at.y));
    app.world().resource::<StandingCells>().iter().any(|(_, _, shell)| {
        let solid = |v: &veduta_city::VolumeShell| metres(v.bottom) < 2.0 && v.footprint.contains(at - shell.origin);
        shell.houses.iter().flat_map(|house| &house.volumes).any(solid)
    })
}

/// Walks off in four directions; gives the longest way made, metres.
fn longest_walk(city: &Path, name: &str) -> f64 {
    let (mut app, walker) = walker_in(city);
    let eye = |app: &App| *app.world().get::<Eye>(walker).expect("the walker has an eye");
    let mut longest: f64 = 0.0;
    for heading_deg in [20.0, 110.0, 200.0, 290.0] {
        app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").heading_deg = heading_deg;
        let from = eye(&app).plan_pos;
        for _ in 0..150 {
            *app.world_mut().resource_mut::<Intent>() = Intent { go: DVec3::Y, run: true, ..Intent::default() };
            app.update();
            let now = eye(&app);
            assert!(now.z_m() > 1.0 && now.z_m() < 8.0, "{name}: an eye {:.1} m high at {:?}", now.z_m(), now.plan_pos);
            assert!(!in_a_house(&app, now.plan_pos), "{name}: walked into a house at {:?}", now.plan_pos);
        }
        longest = longest.max(from.distance(eye(&app).plan_pos));
    }
    longest
}

fn is_baked_and_walked_in(name: &str, file: &str) {
    let Some(data) = data() else { return };
    let dir = workplace(&format!("extract-{name}"));
    let city = dir.join("x.city");
    let mut settings = BakeSettings::default();
    if file.starts_with("portland") {
        settings.partition.sight_m = PORTLAND_SIGHT_M;
    }
    bake(&data.join(file), &city, &settings, &mut |_| ()).unwrap_or_else(|e| panic!("{file}: {e}"));
    let walked = longest_walk(&city, file);
    println!("{file}: {walked:.1} m");
    assert!(walked > 8.0, "{file}: a runner comes only {walked:.1} m in five seconds");
    let _ = std::fs::remove_dir_all(dir);
}

/// A test for each extract: two or more are walked in at once.
macro_rules! every_extract_bakes_and_can_be_walked_in {
    ($($name:ident: $file:literal,)*) => {
        mod every_extract_bakes_and_can_be_walked_in {
            $(
                #[test]
                fn $name() {
                    super::is_baked_and_walked_in(stringify!($name), $file);
                }
            )*
        }
    };
}

every_extract_bakes_and_can_be_walked_in! {
    munich: "munich_altstadt/munich_altstadt.osm.gz",
    krems: "krems_donau/krems_2013.osm.gz",
    lauf: "lauf_pegnitz/lauf_an_der_pegnitz_2020.osm.pbf",
    helsinki: "helsinki_centre/helsinki_centre_2019.osm.pbf",
    rome: "rome_esquilino/rome_piazza_vittorio.osm.pbf",
    valletta: "valletta/valletta_2016.osm.pbf",
    new_york: "new_york_greenwich/nyc_greenwich_village_2015.osm.pbf",
    frederiksted: "frederiksted_grid/frederiksted.osm.pbf",
    marrakech: "marrakech_koutoubia/marrakech.osm.gz",
    berlin: "berlin_neukoelln/neukoelln.osm",
    heidelberg: "heidelberg_altstadt_roads/heidelberg_altstadt_roads.osm.pbf",
    prague_new_town: "prague_new_town_roads/prague_new_town_roads_2017.osm",
    prague_karlovo_namesti: "prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm",
    portland: "portland_dem/portland-central-filtered.osm.pbf",
}
