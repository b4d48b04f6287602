//! The guide alone, in a game's own scene: a garden with three sights and a path. Press `/`, type "pond" and Enter: you are led there.
//!
//! `cargo run -p veduta-guide --example guide_alone`

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{GridPos, Guide, GuidePlace, Id, Overview, Place, PlaceKind, PlanStreet};
use veduta_ecs::{City, Eye, Overviews, Viewer};
use veduta_guide::{CityGuide, GuidePlugin, PlaceEntered};

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, GuidePlugin::default()));
    garden(&mut app);
    app.add_systems(Startup, build_scene).add_systems(Update, tell);
    app.run()
}

/// A message comes whenever a place begins to matter.
fn tell(mut entered: MessageReader<PlaceEntered>) {
    for place in entered.read() {
        info!("you stand before the {}", place.name);
    }
}

/// Sights of the garden: name, place in metres, and what to know about it.
const SIGHTS: [(&str, (f64, f64), &str); 3] = [
    ("Old oak", (0.0, 18.0), "Planted when the garden was laid out, **two hundred years** ago."),
    ("Lily pond", (40.0, 20.0), "Frogs from March on. *Please do not feed them.*"),
    ("Summer house", (40.0, -15.0), "Tea at four, except on Mondays."),
];

/// Tells the guide of places and paths, without any city of ours.
fn garden(app: &mut App) {
    let line = [(0, -30), (0, 12), (34, 16), (36, -12)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
    let path = PlanStreet { id: Id(1), name: "Garden path".into(), line, width: 2 * 1024, walkable: true, ..PlanStreet::default() };
    let place = |(n, (name, pos, _)): (usize, &(&str, (f64, f64), &str))| Place {
        id: Id(10 + n as u64),
        name: (*name).into(),
        kind: PlaceKind::Monument,
        pos: DVec2::from(*pos),
        radius_m: 14.0,
        ..default()
    };
    let places = SIGHTS.iter().enumerate().map(place).collect();
    let overview = Overview { streets: vec![path], places, ..default() };
    let told = |(name, _, text): &(&str, (f64, f64), &str)| GuidePlace {
        name: (*name).into(),
        text: [("en".to_owned(), (*text).to_owned())].into(),
        ..default()
    };
    app.insert_resource(City { name: "Garden".into(), overviews: Overviews::whole(overview), ..default() })
        .insert_resource(CityGuide::of(Guide { places: SIGHTS.iter().map(told).collect(), ..default() }));
}

/// A lawn, and a block for each sight.
fn build_scene(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((Camera3d::default(), Viewer, Eye { plan_pos: DVec2::new(0.0, -25.0), ..default() }));
    commands.spawn((DirectionalLight::default(), Transform::from_xyz(3.0, 8.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y)));
    let green = materials.add(Color::srgb(0.35, 0.5, 0.25));
    commands.spawn((Mesh3d(meshes.add(Plane3d::default().mesh().size(160.0, 160.0))), MeshMaterial3d(green)));
    let (block, stone) = (meshes.add(Cuboid::new(3.0, 5.0, 3.0)), materials.add(Color::srgb(0.75, 0.7, 0.6)));
    for (_, (x, y), _) in SIGHTS {
        // Plan x east, y north; world x east, z south.
        let at = Transform::from_xyz(x as f32, 2.5, -y as f32);
        commands.spawn((Mesh3d(block.clone()), MeshMaterial3d(stone.clone()), at));
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use veduta_city::Viewpoint;
    use veduta_ecs::WalkTo;
    use veduta_guide::{Lead, NearPlace};

    use super::*;

    #[test]
    fn the_visitor_is_led_to_the_pond_and_told_of_it() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), GuidePlugin { interface: false }))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(50)));
        garden(&mut app);
        app.world_mut().spawn((Viewer, Eye { plan_pos: DVec2::new(0.0, -25.0), ..default() }));
        let (x, y) = SIGHTS[1].1;
        let to = Viewpoint { pos: DVec2::new(x - 5.0, y - 3.0), heading_deg: 60.0, ..default() };
        app.world_mut().write_message(WalkTo { name: "Lily pond".into(), to });
        app.update();
        for _ in 0..3_000 {
            app.update();
            std::thread::sleep(Duration::from_micros(200));
            if !app.world().resource::<Lead>().is_under_way() {
                break;
            }
        }
        (0..20).for_each(|_| app.update());
        let near = app.world().resource::<NearPlace>().0.as_ref().map(|place| place.name.clone());
        assert_eq!(near.as_deref(), Some("Lily pond"));
    }
}
