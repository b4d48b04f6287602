use veduta_ecs::{City, Subject};

use super::*;

#[test]
fn a_cut_stays_dark_until_what_is_in_sight_stands_and_then_clears() {
    let (mut hold, mut awaited) = (Hold::Cut, Awaited { cells: 3, ahead: 0 });
    let mut darkness = Vec::new();
    for frame in 0..40 {
        awaited.cells = if frame < 10 { 3 } else { 0 };
        let still = hold.is_still();
        let (next, dark) = hold.next(0.05, &awaited);
        assert_eq!(still, frame <= 10, "time stands still while it is dark, frame {frame}");
        darkness.push(dark);
        hold = next;
    }
    assert!(darkness[..=10].iter().all(|d| *d == 1.0), "{darkness:?}");
    assert!(darkness[10..].windows(2).all(|w| w[1] <= w[0] && w[0] - w[1] < 0.2), "it clears softly: {darkness:?}");
    assert_eq!((hold, darkness[39]), (Hold::None, 0.0));
}

#[test]
fn it_is_dark_for_as_long_as_something_is_awaited() {
    let awaited = Awaited { cells: 1, ahead: 0 };
    let mut hold = Hold::Cut;
    for frame in 0..12_000 {
        let dark;
        (hold, dark) = hold.next(0.05, &awaited);
        assert!(hold.is_still() && dark == 1.0, "frame {frame}");
    }
}

#[test]
fn it_stands_still_until_what_lies_ahead_stands() {
    let mut app = playing(20.0, "Start(at: At(0, 0)), Wait(seconds: 20)");
    let time_s = |app: &App| app.world().resource::<TourPlayer>().time_s();
    (0..40).for_each(|_| app.update());
    let before_s = time_s(&app);
    assert!(before_s > 0.5, "{before_s} s");
    app.world_mut().resource_mut::<Awaited>().ahead = 2;
    (0..200).for_each(|_| app.update());
    assert_eq!((time_s(&app), eye(&mut app).fade), (before_s, 0.0), "in the light");
    assert!(app.world().resource::<TourPlayer>().waits());
    app.world_mut().resource_mut::<Awaited>().ahead = 0;
    (0..20).for_each(|_| app.update());
    assert!(!app.world().resource::<TourPlayer>().waits());
    let passed_s = time_s(&app) - before_s;
    assert!((passed_s - 1.0).abs() < 0.06, "it goes on at its pace: {passed_s} s");
}

#[test]
fn films_are_never_dark_at_a_cut() {
    let mut hold = Hold::Cut;
    for cells in [2, 1, 0] {
        let (next, dark) = hold.next(0.0, &Awaited { cells, ahead: 0 });
        assert_eq!(dark, 0.0, "{cells} cells awaited");
        hold = next;
    }
    assert_eq!(hold, Hold::None);
}

/// A tour that is played so many times a second, in a city without streets.
fn playing(hz: f64, steps: &str) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), crate::TourPlugin { interface: false }))
        .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(std::time::Duration::from_secs_f64(1.0 / hz)))
        .insert_resource(City::default());
    app.world_mut().spawn(Viewer);
    let text = format!(r#"(title: "t", city: "", steps: [{steps}])"#);
    let tour: Tour = veduta_city::file::parse(&text, "t.tour.ron").expect("no mistakes");
    app.world_mut().write_message(TourCommand::Give(Box::new(tour)));
    app
}

fn eye(app: &mut App) -> Eye {
    *app.world_mut().query::<&Eye>().single(app.world()).expect("one viewer")
}

/// The clock adds up rounded nanoseconds, and all that follows from it.
#[test]
fn the_player_stands_at_the_same_place_at_any_frame_rate() {
    const STEPS: &str = r#"Start(at: At(0, 0)), Fly(through: [(0, 0, 2), (30, 40, 12), (90, 10, 30)], speed: 14),
        Look(at: Spot(at: At(0, 0), height_m: 4), seconds: 3), Fov(deg: 40, seconds: 1), Wait(seconds: 1)"#;
    let sixths = |hz: f64| {
        let mut app = playing(hz, STEPS);
        let mut eyes = std::collections::BTreeMap::new();
        for _ in 0..(60.0 * hz) as u32 {
            app.update();
            let player = app.world().resource::<TourPlayer>();
            let sixth = player.time_s() * 6.0;
            if player.state() == TourState::Playing && (sixth - sixth.round()).abs() < 1e-3 {
                eyes.insert(sixth.round() as u32, eye(&mut app));
            }
        }
        eyes
    };
    let (slow, fast) = (sixths(30.0), sixths(144.0));
    assert!(slow.len() > 60 && slow.keys().eq(fast.keys()), "{} and {}", slow.len(), fast.len());
    for (a, b) in slow.values().zip(fast.values()) {
        assert!(a.plan_pos.distance(b.plan_pos) < 1e-3 && (a.eye_m - b.eye_m).abs() < 1e-3, "{a:?} and {b:?}");
        let turned = (a.heading_deg - b.heading_deg + 180.0).rem_euclid(360.0) - 180.0;
        assert!(turned.abs().max((a.pitch_deg - b.pitch_deg).abs()).max((a.fov_deg - b.fov_deg).abs()) < 1e-2, "{a:?} and {b:?}");
    }
}

/// A cart that goes by, as a game would move it.
fn drive(time: Res<Time>, mut carts: Query<(&mut Transform, &mut GlobalTransform), With<Subject>>) {
    for (mut at, mut global) in &mut carts {
        at.translation.x = 6.0 * time.elapsed_secs() - 60.0;
        *global = GlobalTransform::from(*at);
    }
}

#[test]
fn the_eye_goes_with_what_moves_and_leaves_it_when_it_is_gone() {
    const STEPS: &str =
        r#"Start(at: At(0, 0)), Look(at: Spot(at: At(0, 30), height_m: 1.65, follow: "Cart"), seconds: 2), Wait(seconds: 30)"#;
    let watched = |hz: f64| {
        let mut app = playing(hz, STEPS);
        app.add_systems(PreUpdate, drive);
        let hidden =
            (Subject("Cart".into()), Transform::from_xyz(0.0, 0.0, -9.0), GlobalTransform::default(), InheritedVisibility::HIDDEN);
        app.world_mut().spawn(hidden);
        let cart =
            app.world_mut().spawn((Subject("Cart".into()), Transform::from_xyz(0.0, 1.65, -30.0), GlobalTransform::default())).id();
        let headings: Vec<f64> = (0..20)
            .map(|_| {
                (0..hz as u32).for_each(|_| app.update());
                assert_eq!((eye(&mut app).plan_pos, eye(&mut app).eye_m), (DVec2::ZERO, 1.65), "the eye stays the tour's");
                (eye(&mut app).heading_deg + 180.0).rem_euclid(360.0) - 180.0
            })
            .collect();
        app.world_mut().entity_mut(cart).despawn();
        (0..(3.0 * hz) as u32).for_each(|_| app.update());
        let left = (eye(&mut app).heading_deg + 180.0).rem_euclid(360.0) - 180.0;
        (headings, left)
    };
    let ((slow, left), (fast, _)) = (watched(30.0), watched(144.0));
    for (second, (a, b)) in slow.iter().zip(&fast).enumerate().skip(6) {
        let there = (6.0 * (second as f64 + 1.0) - 60.0).atan2(30.0).to_degrees();
        assert!((a - there).abs() < 8.0, "after {second} s it looks to {a}°, and the cart is at {there}°");
        assert!((a - b).abs() < 1.0, "{a}° at 30 and {b}° at 144 frames a second");
    }
    assert!(left.abs() < 0.5, "the spot is looked at again: {left}°");
}

#[test]
fn a_tour_that_is_halted_while_it_fades_in_can_be_seen() {
    let mut app = playing(20.0, "Start(at: At(0, 0)), Wait(seconds: 5), Cut(to: At(50, 0)), Wait(seconds: 5)");
    let mut darkest: f64 = 0.0;
    let has_faded = (0..200).any(|_| {
        app.update();
        darkest = darkest.max(eye(&mut app).fade);
        app.world().resource::<TourPlayer>().time_s() > 5.0 && eye(&mut app).fade > 0.3
    });
    assert!(has_faded, "a cut fades out: {darkest}");
    app.world_mut().write_message(TourCommand::Toggle);
    (0..40).for_each(|_| app.update());
    assert_eq!(app.world().resource::<TourPlayer>().state(), TourState::Paused);
    assert_eq!(eye(&mut app).fade, 0.0);
    app.world_mut().write_message(TourCommand::Toggle);
    app.update();
    assert!(eye(&mut app).fade > 0.3, "and goes on where it was");
}

#[test]
fn marks_are_told_once_as_their_moments_come() {
    let steps = r#"Start(at: At(0, 0)), Mark(name: "a"), Rain(wet: 1), Wait(seconds: 3), Mark(name: "b")"#;
    let mut app = playing(10.0, steps);
    let mut told = Vec::new();
    for _ in 0..80 {
        app.update();
        told.extend(app.world_mut().resource_mut::<Messages<TourMark>>().drain().map(|mark| mark.name));
    }
    assert_eq!(told, ["a", "b"]);
    assert_eq!(app.world().resource::<TourPath>().0.len(), 1, "one part without cuts");
    app.world_mut().write_message(TourCommand::Stop);
    app.update();
    assert!(app.world().resource::<TourPath>().0.is_empty());
    assert_eq!(app.world().resource::<Weather>().wet, 1.0);
}

#[test]
fn a_tour_with_a_mistake_is_told_with_its_line_and_ends_the_waiting() {
    let dir = std::env::temp_dir().join(format!("veduta-tour-{}", std::process::id()));
    std::fs::create_dir_all(&dir).expect("a folder of our own");
    std::fs::write(dir.join("bad.tour.ron"), "(\n  title: \"Bad\",\n  city: \"x\"\n  steps: [],\n)").expect("room");
    let mut app = App::new();
    let assets = AssetPlugin { file_path: dir.display().to_string(), ..default() };
    app.add_plugins((MinimalPlugins, assets, crate::TourPlugin { interface: false }));
    app.world_mut().write_message(TourCommand::Open("bad.tour.ron".into()));
    for _ in 0..2_000 {
        app.update();
        if app.world().resource::<TourPlayer>().error().is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let player = app.world().resource::<TourPlayer>();
    let told = player.error().expect("a message");
    assert!(told.contains("bad.tour.ron:3") && !told.contains("backtrace"), "{told}");
    assert_eq!(player.state(), TourState::Idle);
    let _ = std::fs::remove_dir_all(dir);
}
