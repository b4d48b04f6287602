//! A walker in the sample city: walls stop it, it never falls, it is never stuck.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta::ecs::JumpTo;
use veduta::prelude::*;
use veduta::walker::{Gait, Intent, Jump};
use veduta_city::{GridPos, Viewpoint, metres};
use veduta_tests::{sample_city, sample_plan, update_until, walker_in};

/// An app with a walker that has arrived at the start.
fn arrived() -> (App, Entity) {
    walker_in(sample_city())
}

fn eye(app: &App, walker: Entity) -> Eye {
    *app.world().get::<Eye>(walker).expect("the walker has an eye")
}

/// Walks on for some seconds of the app's time.
fn walk(app: &mut App, walker: Entity, seconds: f64, go: DVec3, run: bool) {
    for _ in 0..(seconds / 0.033) as u32 {
        *app.world_mut().resource_mut::<Intent>() = Intent { go, run, ..Intent::default() };
        app.update();
        let eye = eye(app, walker);
        assert!(eye.z_m() > 1.0, "fell through the floor at {:?}", eye.plan_pos);
        assert!(eye.z_m() < 6.0, "was lifted off the ground at {:?}", eye.plan_pos);
        assert!(!in_a_house(eye.plan_pos), "walked into a house at {:?}", eye.plan_pos);
    }
}

fn in_a_house(at: DVec2) -> bool {
    let at = GridPos(GridPos::steps(at.x), GridPos::steps(at.y));
    let solid = |v: &veduta_city::Volume| metres(v.bottom) < 2.0 && v.footprint.contains(at);
    sample_plan().houses.iter().any(|house| house.volumes.iter().any(solid))
}

#[test]
fn walls_stop_a_runner_in_every_direction_and_nobody_is_stuck() {
    let (mut app, walker) = arrived();
    let start = eye(&app, walker).plan_pos;
    for heading_deg in [0.0, 70.0, 140.0, 215.0, 290.0] {
        app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").heading_deg = heading_deg;
        let before = eye(&app, walker).plan_pos;
        walk(&mut app, walker, 14.0, DVec3::new(0.0, 1.0, 0.0), true);
        let after = eye(&app, walker).plan_pos;
        assert!(before.distance(after) > 3.0, "heading {heading_deg}: from {before:?} only to {after:?}");
        // Away from whatever stopped it: never stuck.
        walk(&mut app, walker, 2.0, DVec3::new(0.0, -1.0, 0.0), false);
        let back = eye(&app, walker).plan_pos;
        assert!(after.distance(back) > 1.5, "heading {heading_deg}: stuck at {after:?}");
    }
    assert!(start.distance(eye(&app, walker).plan_pos) < 600.0);
}

#[test]
fn walking_keeps_its_pace_and_eye_height() {
    let (mut app, walker) = arrived();
    app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").heading_deg = 250.0;
    walk(&mut app, walker, 1.0, DVec3::new(0.0, 1.0, 0.0), false);
    let before = eye(&app, walker);
    walk(&mut app, walker, 3.0, DVec3::new(0.0, 1.0, 0.0), false);
    let after = eye(&app, walker);
    let pace = before.plan_pos.distance(after.plan_pos) / 3.0;
    let wished = app.world().resource::<WalkerSettings>().walk_m_s;
    assert!((pace - wished).abs() < 0.15 * wished, "{pace:.2} m/s instead of {wished:.2}");
    assert!((after.eye_m - 1.65).abs() < 0.06, "the eye stands {:.2} m high", after.eye_m);
}

fn head(eye: &Eye) -> DVec3 {
    eye.plan_pos.extend(eye.z_m())
}

/// Does what takes a walker to the ground, and waits until he stands there: his head does not leap.
fn land(app: &mut App, walker: Entity, intent: Intent) {
    let mut before = head(&eye(app, walker));
    *app.world_mut().resource_mut::<Intent>() = intent;
    for _ in 0..90 {
        app.update();
        *app.world_mut().resource_mut::<Intent>() = Intent::default();
        let now = head(&eye(app, walker));
        assert!(now.distance(before) < 2.0, "the head leaps from {before} to {now}");
        before = now;
        if !app.world().get::<Gait>(walker).expect("a walker has one").is_landing() {
            return;
        }
    }
    panic!("it does not come down");
}

#[test]
fn examining_goes_round_what_is_looked_at_and_ends_in_a_street() {
    let (mut app, walker) = arrived();
    let before = eye(&app, walker);
    let ask = |app: &mut App, intent: Intent| {
        *app.world_mut().resource_mut::<Intent>() = intent;
        app.update();
        *app.world_mut().resource_mut::<Intent>() = Intent::default();
    };
    ask(&mut app, Intent { toggle_examine: true, ..Intent::default() });
    let gait = |app: &App| *app.world().get::<Gait>(walker).expect("a walker has one");
    assert!(gait(&app).is_examining());
    let now = eye(&app, walker);
    assert!(head(&now).distance(head(&before)) < 0.3, "it begins where the eye is: {now:?}");
    let (mut last, mut highest_m, mut turned) = (head(&now), 0_f64, std::collections::BTreeSet::new());
    for n in 0_u32..1_500 {
        let tilt_deg = if n % 500 < 250 { -0.6 } else { 0.6 };
        let near = if n % 300 < 150 { -0.01 } else { 0.01 };
        ask(&mut app, Intent { turn_deg: 1.0, tilt_deg, near, ..Intent::default() });
        let now = eye(&app, walker);
        let ground_m = head(&now).z - now.eye_m;
        assert!(now.eye_m > 0.5, "below the ground of {ground_m} m at {now:?}");
        let is_low = now.eye_m < 4.0;
        assert!(!(is_low && in_a_house(now.plan_pos)), "in a house at {now:?}");
        last = head(&now);
        highest_m = highest_m.max(now.eye_m);
        turned.insert((now.heading_deg / 10.0) as u32);
    }
    assert!(highest_m > 5.0 && turned.len() > 6, "it does go round: {highest_m} m high, {} tens of degrees", turned.len());
    land(&mut app, walker, Intent { toggle_examine: true, ..Intent::default() });
    assert!(!gait(&app).is_examining() && !gait(&app).flying);
    walk(&mut app, walker, 2.0, DVec3::ZERO, false);
    let after = eye(&app, walker);
    assert!(!in_a_house(after.plan_pos), "landed in a house at {after:?} from {last}");
    assert!((after.eye_m - before.eye_m).abs() < 0.1 && after.pitch_deg.abs() < 13.0, "it stands upright: {after:?}");
    walk(&mut app, walker, 2.0, DVec3::Y, false);
    assert!(eye(&app, walker).plan_pos.distance(after.plan_pos) > 0.5, "and walks on");
}

#[test]
fn from_what_is_examined_one_flies_on_without_a_leap() {
    let (mut app, walker) = arrived();
    *app.world_mut().resource_mut::<Intent>() = Intent { toggle_examine: true, ..Intent::default() };
    app.update();
    for _ in 0..60 {
        *app.world_mut().resource_mut::<Intent>() = Intent { tilt_deg: -1.0, near: -0.01, ..Intent::default() };
        app.update();
    }
    *app.world_mut().resource_mut::<Intent>() = Intent::default();
    (0..60).for_each(|_| app.update());
    let before = head(&eye(&app, walker));
    *app.world_mut().resource_mut::<Intent>() = Intent { toggle_fly: true, ..Intent::default() };
    app.update();
    *app.world_mut().resource_mut::<Intent>() = Intent::default();
    (0..10).for_each(|_| app.update());
    let after = head(&eye(&app, walker));
    assert!(app.world().get::<Gait>(walker).expect("a walker has one").flying);
    assert!(after.distance(before) < 0.3, "from {before} to {after}");
}

#[test]
fn flying_ends_in_a_street() {
    let (mut app, walker) = arrived();
    *app.world_mut().resource_mut::<Intent>() = Intent { toggle_fly: true, ..Intent::default() };
    app.update();
    *app.world_mut().resource_mut::<Intent>() = Intent::default();
    // Over the roof of the first house nearby.
    let here = eye(&app, walker).plan_pos;
    let houses = sample_plan().houses.iter().flat_map(|h| &h.volumes).map(|v| v.footprint.centroid());
    let roof = houses
        .map(|c| DVec2::new(c.x, c.y))
        .filter(|c| in_a_house(*c))
        .min_by(|a, b| a.distance_squared(here).total_cmp(&b.distance_squared(here)))
        .expect("houses stand round the square");
    app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").plan_pos = roof;
    for _ in 0..30 {
        app.update();
    }
    land(&mut app, walker, Intent { toggle_fly: true, ..Intent::default() });
    walk(&mut app, walker, 2.0, DVec3::ZERO, false);
    let at = eye(&app, walker).plan_pos;
    assert!(!in_a_house(at), "landed in a house at {at:?}");
}

#[test]
fn two_walkers_jump_together_and_neither_stays_in_the_dark() {
    let (mut app, first) = arrived();
    let beside = eye(&app, first);
    let second = app.world_mut().spawn((Walker, Transform::default(), beside)).id();
    let to = Viewpoint { heading_deg: 90.0, ..app.world().resource::<City>().start };
    app.world_mut().write_message(JumpTo(to));
    app.update();
    assert!(matches!(app.world().resource::<Jump>(), Jump::Leaving(_)));
    update_until(&mut app, 600, "the jump is over", |world| *world.resource::<Jump>() == Jump::None);
    for walker in [first, second] {
        let eye = eye(&app, walker);
        assert_eq!((eye.fade, eye.heading_deg), (0.0, 90.0), "{:?}", eye.plan_pos);
    }
}
