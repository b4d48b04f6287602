//! A city is heard as a game hears it, without a device: through a sound track.

use std::sync::Arc;
use std::time::Duration;

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use veduta_city::{CellShell, GridPolygon, GridPos, GroundPatch, Level, ObjectKind, ObjectShell, Soundscape, SurfaceKind};
use veduta_ecs::{Accompany, City, CityClock, CityFailed, Cue, Eye, Footing, Part, StandingCells, Viewer, Weather};
use veduta_sound::{CitySounds, SoundPlugin, SoundSettings, SoundTrack};

const RATE_HZ: u32 = 16_000;

/// A square of 200 m with a fountain in its middle, and a listener who stands 12 m south of it and looks north.
fn town() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin { file_path: "tests".into(), ..default() }))
        .insert_resource(SoundTrack::new(RATE_HZ))
        .add_plugins(SoundPlugin)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(50)))
        .insert_resource(City::default())
        .insert_resource(CityClock { day: 160, hour: 12.0, pace: 0.0 });
    let corner = |x: i32, y: i32| GridPos(x * 1_024, y * 1_024);
    let outline = GridPolygon::simple(vec![corner(-100, -100), corner(100, -100), corner(100, 100), corner(-100, 100)]);
    let shell = CellShell {
        outline: outline.clone(),
        ground: vec![GroundPatch { surface: SurfaceKind::Cobbles, outline, z: 0, course: None }],
        objects: vec![ObjectShell {
            kind: ObjectKind::Fountain,
            pos: GridPos(0, 0),
            z: 0,
            heading: 0,
            height: 3_072,
            monument: None,
        }],
        ..CellShell::default()
    };
    app.world_mut().resource_mut::<StandingCells>().add(0, Level::One, &Arc::new(shell));
    let eye = Eye { plan_pos: DVec2::new(0.0, -12.0), ..default() };
    app.world_mut().spawn((Viewer, Footing::Own, eye, Transform::default()));
    app.finish();
    app.cleanup();
    // No time passes before the first frame.
    app.update();
    app
}

/// What is heard in so many seconds: left and right.
fn hear(app: &mut App, seconds: f64) -> (Vec<f32>, Vec<f32>) {
    for _ in 0..(seconds * 20.0).round() as usize {
        app.update();
    }
    let samples = app.world_mut().resource_mut::<SoundTrack>().take();
    assert_eq!(samples.len(), 2 * (seconds * f64::from(RATE_HZ)).round() as usize, "a track is as long as the time");
    assert!(samples.iter().all(|x| x.abs() <= 1.0));
    (samples.iter().step_by(2).copied().collect(), samples.iter().skip(1).step_by(2).copied().collect())
}

fn level_db(samples: &[f32]) -> f64 {
    let power = samples.iter().map(|x| f64::from(x * x)).sum::<f64>() / samples.len().max(1) as f64;
    10.0 * power.max(1e-12).log10()
}

fn set_eye(app: &mut App, change: impl Fn(&mut Eye)) {
    let mut eyes = app.world_mut().query::<&mut Eye>();
    eyes.iter_mut(app.world_mut()).for_each(|mut eye| change(&mut eye));
}

/// No beds and no steps: what else there is.
fn quiet(app: &mut App) {
    app.insert_resource(CitySounds::of(Soundscape { beds: Some(Vec::new()), ..Soundscape::default() }));
    app.insert_resource(SoundSettings { steps: 0.0, ..default() });
}

#[test]
fn a_town_without_a_file_sounds_and_can_be_muted() {
    let mut app = town();
    hear(&mut app, 3.0);
    let (left, right) = hear(&mut app, 3.0);
    assert!((-45.0..-15.0).contains(&level_db(&left)), "{:.1} dB", level_db(&left));
    assert!((level_db(&left) - level_db(&right)).abs() < 4.0, "it comes from all about");
    app.insert_resource(SoundSettings { is_muted: true, ..default() });
    hear(&mut app, 1.0);
    assert!(level_db(&hear(&mut app, 1.0).0) < -100.0);
}

#[test]
fn the_same_walk_sounds_the_same() {
    let walk = || {
        let mut app = town();
        (0..40)
            .flat_map(|n| {
                set_eye(&mut app, |eye| eye.plan_pos.y = -12.0 - f64::from(n) * 0.1);
                hear(&mut app, 0.05).0
            })
            .collect::<Vec<f32>>()
    };
    assert_eq!(walk(), walk());
}

#[test]
fn a_fountain_is_heard_from_its_side_and_fades_with_distance() {
    let mut app = town();
    quiet(&mut app);
    hear(&mut app, 4.0);
    let (left, right) = hear(&mut app, 2.0);
    let near = level_db(&left);
    assert!((near - level_db(&right)).abs() < 1.0, "it lies ahead");
    set_eye(&mut app, |eye| eye.heading_deg = 90.0);
    hear(&mut app, 1.0);
    let (left, right) = hear(&mut app, 2.0);
    assert!(level_db(&left) > level_db(&right) + 10.0, "who looks east has it on the left");
    set_eye(&mut app, |eye| (eye.heading_deg, eye.plan_pos.y) = (0.0, -48.0));
    hear(&mut app, 6.0);
    let far = level_db(&hear(&mut app, 2.0).0);
    assert!((8.0..20.0).contains(&(near - far)), "{near:.1} dB at 12 m, {far:.1} dB at 48 m");
}

#[test]
fn a_bell_is_late_by_its_distance_and_has_its_own_fader() {
    let mut app = town();
    quiet(&mut app);
    app.world_mut().resource_mut::<StandingCells>().clear();
    hear(&mut app, 3.0);
    let strike = |app: &mut App| {
        app.world_mut().write_message(Cue { sound: "bell.any".into(), plan_pos: DVec3::new(0.0, 674.0, 1.65), gain_db: 12.0 });
    };
    strike(&mut app);
    let (left, _) = hear(&mut app, 4.0);
    let first = left.iter().position(|x| x.abs() > 1e-4).expect("it is heard") as f64 / f64::from(RATE_HZ);
    assert!((1.98..2.1).contains(&first), "686 m take two seconds: {first:.3}");
    app.insert_resource(SoundSettings { bells: 0.0, steps: 0.0, ..default() });
    hear(&mut app, 60.0);
    strike(&mut app);
    assert!(level_db(&hear(&mut app, 4.0).0) < -100.0);
}

#[test]
fn who_walks_is_heard_by_the_ground_and_who_flies_is_not() {
    let mut app = town();
    let no_beds = Soundscape { beds: Some(Vec::new()), ..Soundscape::default() };
    app.insert_resource(CitySounds::of(no_beds)).insert_resource(SoundSettings { ambience: 0.0, ..default() });
    let mut walk = |eye_m: f64| {
        // The last step is over.
        hear(&mut app, 1.0);
        let steps: Vec<f32> = (0..60)
            .flat_map(|n| {
                set_eye(&mut app, |eye| (eye.plan_pos.x, eye.eye_m) = (f64::from(n) * 0.08, eye_m));
                hear(&mut app, 0.05).0
            })
            .collect();
        level_db(&steps)
    };
    let (walking, flying) = (walk(1.65), walk(12.0));
    assert!((-60.0..-30.0).contains(&walking), "{walking:.1} dB");
    assert!(flying < -100.0, "{flying:.1} dB");
}

#[test]
fn rain_is_heard_and_stops() {
    let mut app = town();
    hear(&mut app, 3.0);
    let dry = level_db(&hear(&mut app, 2.0).0);
    app.insert_resource(Weather { clouds: 0.9, wet: 0.9, ..Weather::default() });
    hear(&mut app, 3.0);
    assert!(level_db(&hear(&mut app, 2.0).0) > dry + 2.0);
    app.insert_resource(Weather { clouds: 0.4, wet: 0.1, ..Weather::default() });
    hear(&mut app, 6.0);
    assert!((level_db(&hear(&mut app, 3.0).0) - dry).abs() < 3.0);
}

/// Updates until something holds; files are read on other threads.
fn until(app: &mut App, holds: &mut dyn FnMut(&mut App) -> bool) -> bool {
    (0..2_000).any(|_| {
        app.update();
        std::thread::sleep(Duration::from_millis(1));
        holds(app)
    })
}

#[test]
fn narration_is_played_held_and_ended_and_a_missing_one_is_told_once() {
    let mut app = town();
    quiet(&mut app);
    app.world_mut().resource_mut::<StandingCells>().clear();
    app.world_mut().write_message(Accompany::Play { file: "tone.ogg".into(), part: Part::Ambience });
    let is_heard = |app: &mut App| level_db(&app.world_mut().resource_mut::<SoundTrack>().take()) > -60.0;
    assert!(until(&mut app, &mut |app| is_heard(app)), "the recording is heard");
    app.world_mut().write_message(Accompany::Hold);
    hear(&mut app, 0.5);
    assert!(level_db(&hear(&mut app, 1.0).0) < -100.0, "it stands still");
    app.world_mut().write_message(Accompany::GoOn);
    hear(&mut app, 0.5);
    assert!(level_db(&hear(&mut app, 1.0).0) > -40.0, "it goes on, over and over");
    app.world_mut().write_message(Accompany::End(Part::Ambience));
    hear(&mut app, 0.5);
    assert!(level_db(&hear(&mut app, 1.0).0) < -100.0);
    app.world_mut().write_message(Accompany::Play { file: "none.ogg".into(), part: Part::Narration });
    let mut told = Vec::new();
    until(&mut app, &mut |app| {
        told.extend(app.world_mut().resource_mut::<Messages<CityFailed>>().drain().map(|failed| failed.message));
        !told.is_empty()
    });
    app.world_mut().write_message(Accompany::Play { file: "none.ogg".into(), part: Part::Narration });
    for _ in 0..20 {
        app.update();
        told.extend(app.world_mut().resource_mut::<Messages<CityFailed>>().drain().map(|failed| failed.message));
    }
    assert!(told.len() == 1 && told[0].contains("none.ogg") && told[0].contains("goes on without it"), "{told:?}");
}

#[test]
fn without_a_device_or_a_track_all_goes_on() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, SoundPlugin));
    app.world_mut().spawn((Viewer, Eye::default(), Transform::default()));
    app.finish();
    app.cleanup();
    for _ in 0..50 {
        app.world_mut().write_message(Cue { sound: "bell".into(), plan_pos: DVec3::ZERO, gain_db: 0.0 });
        app.world_mut().write_message(Accompany::Stop);
        app.update();
    }
}
