//! Life alone, in a game's own scene: a green with a fountain, a flag, a sign, a clock on a wall, and pigeons that fly up before you.
//!
//! `cargo run -p veduta-life --example life_alone`

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{Dial, Jet, Life, LifeKind, LivingThing, Rgb, SignShape, Tells, Where};
use veduta_ecs::{CityClock, Cue, Eye, Viewer};
use veduta_life::{CityLife, LifePlugin};

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, LifePlugin))
        .insert_resource(CityLife::of(green()))
        // A minute for every second: the hands are seen to go, and the bell is heard of.
        .insert_resource(CityClock { hour: 8.9, pace: 60.0, ..default() })
        .add_systems(Startup, build_scene)
        .add_systems(Update, (run_clock, approach, tell));
    app.run()
}

/// The clock runs: with the sky's plugin that does it.
fn run_clock(time: Res<Time>, mut clock: ResMut<CityClock>) {
    clock.hour = (clock.hour + clock.pace * time.delta_secs_f64() / 3600.0).rem_euclid(24.0);
}

/// The viewer walks to and fro: past the fountain, and among the pigeons.
fn approach(time: Res<Time>, mut viewers: Query<&mut Eye, With<Viewer>>) {
    let t = time.elapsed_secs_f64();
    for mut eye in &mut viewers {
        eye.plan_pos.y = -13.0 + 8.0 * (1.0 - (0.3 * t).cos()) / 2.0;
        eye.pitch_deg = 2.0;
    }
}

/// Sounds are asked for: who adds a plugin of sounds hears them.
fn tell(mut cues: MessageReader<Cue>) {
    for cue in cues.read() {
        info!("{} at {:.0}", cue.sound, cue.plan_pos);
    }
}

/// What lives here. A file `*.life.ron` says the same.
fn green() -> Life {
    let thing = |name: &str, (x, y): (f64, f64), height_m: f64, kind: LifeKind| LivingThing {
        name: name.into(),
        at: Where::At(x, y),
        by: DVec2::ZERO,
        height_m,
        heading_deg: 180.0,
        kind,
    };
    let jet = |count, radius_m, height_m, rise_m, reach_m| Jet {
        count,
        radius_m,
        height_m,
        rise_m,
        reach_m,
        lands_m: None,
        width_m: 0.02,
    };
    let (gold, night, red) = (Rgb(0xC9, 0xA9, 0x4E), Rgb(0x26, 0x35, 0x4E), Rgb(0xB3, 0x20, 0x2A));
    let white = Rgb(0xF2, 0xF0, 0xEA);
    Life {
        things: vec![
            thing(
                "fountain",
                (-4.0, 2.0),
                0.0,
                LifeKind::Fountain {
                    radius_m: 1.9,
                    water_m: 0.5,
                    jets: vec![jet(1, 0.0, 0.7, 2.0, 0.2), jet(10, 0.2, 0.7, 0.9, 1.2)],
                },
            ),
            thing(
                "flag",
                (5.0, 3.0),
                0.0,
                LifeKind::Flag { pole_m: 6.5, tilt_deg: 0.0, size_m: (1.4, 2.1), fields: vec![white, red], wedge: Some(night) },
            ),
            thing("clock", (0.0, 7.7), 4.6, LifeKind::Clock { radius_m: 1.1, dial: Dial::Twelve, face: night, gold }),
            thing(
                "sign",
                (2.6, 7.7),
                3.0,
                LifeKind::Sign { shape: SignShape::Shield, size_m: (0.7, 0.9), arm_m: 1.0, colour: red, trim: gold },
            ),
            thing("pigeons", (0.0, -2.0), 0.0, LifeKind::Flock { radius_m: 6.0, count: 24, startle_m: 3.5 }),
            thing(
                "bell",
                (0.0, 8.0),
                7.0,
                LifeKind::Bell { sound: "bell".into(), tells: Tells::Hours, every_s: 1.5, after_s: 0.0, gain_db: 0.0 },
            ),
        ],
        ..default()
    }
}

/// A green, a wall, and a basin.
fn build_scene(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((Camera3d::default(), Viewer, Eye { plan_pos: DVec2::new(0.0, -13.0), ..default() }));
    let sun = DirectionalLight { shadow_maps_enabled: true, ..default() };
    commands.spawn((sun, Transform::from_xyz(5.0, 8.0, 7.0).looking_at(Vec3::ZERO, Vec3::Y)));
    let (green, stone) = (materials.add(Color::srgb(0.52, 0.50, 0.46)), materials.add(Color::srgb(0.78, 0.70, 0.56)));
    commands.spawn((Mesh3d(meshes.add(Plane3d::default().mesh().size(60.0, 60.0))), MeshMaterial3d(green)));
    // Plan x east, y north; world x east, z south.
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::new(9.0, 7.0, 1.0))),
        MeshMaterial3d(stone.clone()),
        Transform::from_xyz(0.0, 3.5, -8.3),
    ));
    commands.spawn((Mesh3d(meshes.add(Cylinder::new(2.0, 0.5))), MeshMaterial3d(stone), Transform::from_xyz(-4.0, 0.24, -2.0)));
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use veduta_ecs::Subject;
    use veduta_life::{LifeSettings, Living, SolidMaterial, WINGS};

    use super::*;

    /// The green without a window, and all cues of some seconds.
    fn lived(seconds: u32, fps: u32, settings: LifeSettings) -> (App, Vec<String>) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Mesh>()
            .add_plugins(LifePlugin)
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1) / fps))
            .insert_resource(CityLife::of(green()))
            .insert_resource(settings)
            .insert_resource(CityClock { hour: 8.9, pace: 60.0, ..default() })
            .add_systems(Update, (run_clock, approach).before(veduta_ecs::VedutaSystems::Stream));
        app.world_mut().spawn((Viewer, Eye { plan_pos: DVec2::new(0.0, -13.0), ..default() }));
        let mut heard = Vec::new();
        for _ in 0..seconds * fps {
            app.update();
            heard.extend(app.world_mut().resource_mut::<Messages<Cue>>().drain().map(|cue| cue.sound));
        }
        (app, heard)
    }

    fn count<C: Component>(app: &mut App) -> usize {
        app.world_mut().query::<&C>().iter(app.world()).count()
    }

    #[test]
    fn everything_lives_and_makes_itself_heard() {
        let (mut app, heard) = lived(20, 30, LifeSettings::default());
        // Fountain, flag, dial and two hands, arm and board, birds and their shade.
        assert_eq!(count::<Living>(&mut app), 9);
        assert_eq!(heard.iter().filter(|sound| *sound == "bell").count(), 1, "a clock in haste gives nine one stroke");
        assert!(heard.iter().any(|sound| sound == WINGS), "the viewer has come too near");
        let materials = app.world().resource::<Assets<SolidMaterial>>();
        assert!(materials.iter().count() >= 2);
    }

    /// What tours can follow with the eye, and how high it is.
    fn subjects(app: &mut App) -> Vec<(String, f32)> {
        let mut named: Vec<(String, f32)> = app
            .world_mut()
            .query::<(&Subject, &Transform)>()
            .iter(app.world())
            .map(|(name, at)| (name.0.clone(), at.translation.y))
            .collect();
        named.sort_by(|a, b| a.0.cmp(&b.0));
        named
    }

    #[test]
    fn what_is_told_of_can_be_followed_with_the_eye() {
        let (mut app, _) = lived(1, 30, LifeSettings::default());
        let names: Vec<String> = subjects(&mut app).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["clock", "flag", "fountain", "pigeons", "sign"]);
        let mut highest: f32 = 0.0;
        for _ in 0..600 {
            app.update();
            highest = highest.max(subjects(&mut app)[3].1);
        }
        assert!(highest > 1.5, "the middle of a flock flies up with it: {highest} m");
    }

    #[test]
    fn who_wants_nothing_pays_for_nothing() {
        let settings = LifeSettings { kinds: veduta_life::LifeKinds::NONE, ..default() };
        let (mut app, heard) = lived(20, 30, settings);
        assert_eq!((count::<Living>(&mut app), heard.len()), (0, 0));
    }
}
