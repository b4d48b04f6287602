//! What travels with a city: its guide, tours, life and sounds, from its directory to the plugins that tell of it.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use veduta::buildings::{Building, BuildingsPlugin};
use veduta::ecs::{City, OpenCity, Viewer};
use veduta::guide::{CityGuide, GuidePlugin};
use veduta::streaming::{CityAssetsPlugin, Fetching, StreamingPlugin};
use veduta::tour::{TourCommand, TourPlayer, TourPlugin};
use veduta_tests::{sample_city, update_until};

#[test]
fn a_city_brings_its_guide_and_its_tours_from_wherever_it_lies() {
    let city = sample_city();
    let mut app = App::new();
    app.add_plugins(CityAssetsPlugin)
        .add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin))
        .init_asset::<Mesh>()
        .add_plugins((
            StreamingPlugin { fetching: Fetching::Threads(1) },
            BuildingsPlugin { building: Building::Inline },
            GuidePlugin { interface: false },
            TourPlugin { interface: false },
        ))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(33)))
        .insert_resource(OpenCity(city.display().to_string()));
    app.world_mut().spawn((Viewer, Transform::default()));
    update_until(&mut app, 5_000, "the guide has come", |world| world.resource::<CityGuide>().guide().places.len() > 40);
    let files = app.world().resource::<City>().files.clone();
    for path in
        ["old_prague.guide.ron", "old_prague.life.ron", "old_prague.sound.ron", "pictures/dusk.webp", "royal_route.tour.ron"]
    {
        assert!(files.iter().any(|file| file == path), "{path}: {files:?}");
    }
    app.world_mut().write_message(TourCommand::Open("city://royal_route.tour.ron".into()));
    update_until(&mut app, 5_000, "the tour has come", |world| world.resource::<TourPlayer>().tour().is_some());
    app.world_mut().write_message(TourCommand::Open("city://nowhere.tour.ron".into()));
    update_until(&mut app, 5_000, "what is not there is told", |world| {
        world.resource::<TourPlayer>().error().is_some_and(|error| error.contains("nowhere.tour.ron"))
    });
}

#[test]
fn without_the_asset_source_a_city_opens_all_the_same() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default()))
        .add_plugins((StreamingPlugin { fetching: Fetching::Inline }, GuidePlugin { interface: false }))
        .insert_resource(OpenCity(sample_city().display().to_string()));
    update_until(&mut app, 100, "it is open", |world| world.contains_resource::<City>());
    assert_eq!(app.world().resource::<City>().files, Vec::<String>::new(), "nothing is promised that cannot be had");
}
