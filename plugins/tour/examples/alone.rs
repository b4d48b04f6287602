//! Tours alone, in any scene: two streets and two places are all that a tour needs to know of it.
//!
//! `cargo run -p veduta-tour --example tour_alone` (T pauses, comma and full stop skip)

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{GridPos, Id, Overview, Place, PlanStreet, Tour, file};
use veduta_ecs::{City, Overviews, Viewer};
use veduta_tour::{TourCommand, TourPlugin};

const TOUR: &str = r#"(
    title: "Round the corner",
    city: "none",
    steps: [
        Start(at: Place("Gate")),
        Say(text: "Two streets, one corner."),
        Walk(to: Place("Well"), speed: 3),
        Look(at: Heading(deg: 200, pitch_deg: 5), seconds: 2),
        Fly(through: [(45, 20, 12), (0, 0, 25)], speed: 12, look: Spot(at: Place("Well"), height_m: 2)),
    ],
)"#;

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, TourPlugin::default())).add_systems(Startup, build_scene);
    guide(&mut app);
    app.run()
}

/// Tells the plugin of the streets and places, and gives it the tour.
fn guide(app: &mut App) {
    app.insert_resource(village()).add_systems(Startup, |mut commands: Commands, mut tour: MessageWriter<TourCommand>| {
        commands.spawn((Camera3d::default(), Viewer));
        match file::parse::<Tour>(TOUR, "corner.tour.ron") {
            Ok(value) => _ = tour.write(TourCommand::Give(Box::new(value))),
            Err(mistake) => error!("{mistake}"),
        }
    });
}

/// Sixty metres east, then forty north.
fn village() -> City {
    let street = |id, name: &str, from: (i32, i32), to: (i32, i32)| PlanStreet {
        id: Id(id),
        name: name.into(),
        line: [from, to].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec(),
        width: 6 * 1024,
        walkable: true,
        ..PlanStreet::default()
    };
    let streets = vec![street(1, "East Street", (0, 0), (60, 0)), street(2, "North Street", (60, 0), (60, 40))];
    let place = |name: &str, x: f64, y: f64| Place { name: name.into(), pos: DVec2::new(x, y), ..default() };
    let places = vec![place("Gate", 0.0, 0.0), place("Well", 60.0, 40.0)];
    City { name: "Village".into(), overviews: Overviews::whole(Overview { streets, places, ..default() }), ..default() }
}

/// Blocks beside the streets, so that there is something to see. Plan (x, y) is the engine's (x, −z).
fn build_scene(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let block = meshes.add(Cuboid::new(8.0, 10.0, 8.0));
    let plaster = materials.add(Color::srgb(0.85, 0.75, 0.55));
    let ground = Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0)));
    commands.spawn((ground, MeshMaterial3d(materials.add(Color::srgb(0.45, 0.45, 0.42)))));
    for (x, y) in [(8, 10), (20, 10), (32, 10), (44, 10), (44, 24), (44, 38), (20, -10), (40, -10), (72, 5), (72, 25)] {
        let at = Transform::from_xyz(x as f32, 5.0, -y as f32);
        commands.spawn((Mesh3d(block.clone()), MeshMaterial3d(plaster.clone()), at));
    }
    let sun = DirectionalLight { illuminance: 8_000.0, ..default() };
    commands.spawn((sun, Transform::from_xyz(8.0, 10.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_ecs::Eye;
    use veduta_tour::{TourPlayer, TourState};

    #[test]
    fn the_tour_walks_round_the_corner_and_ends_in_the_air() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), TourPlugin { interface: false }));
        let step = std::time::Duration::from_millis(100);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step));
        guide(&mut app);
        let mut near_corner = f64::MAX;
        for _ in 0..900 {
            app.update();
            let eye = app.world_mut().query::<&Eye>().single(app.world()).expect("one viewer was spawned");
            near_corner = near_corner.min(eye.plan_pos.distance(DVec2::new(60.0, 0.0)));
        }
        let player = app.world().resource::<TourPlayer>();
        assert_eq!(player.error(), None);
        assert_eq!(player.state(), TourState::Paused, "it stands at its end");
        assert!(near_corner < 6.0, "it went round the corner, {near_corner} m from it");
        let eye = app.world_mut().query::<&Eye>().single(app.world()).expect("one viewer was spawned");
        assert!(eye.plan_pos.length() < 1.0 && (eye.eye_m - 25.0).abs() < 1.0, "{eye:?}");
    }
}
