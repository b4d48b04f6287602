//! A walker in the sample city: walls stop it, it never falls, it is never stuck.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta::prelude::*;
use veduta::walker::Intent;
use veduta_city::{GridPos, metres};
use veduta_tests::{sample_city, sample_plan, walker_in};

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
    *app.world_mut().resource_mut::<Intent>() = Intent { toggle_fly: true, ..Intent::default() };
    app.update();
    walk(&mut app, walker, 2.0, DVec3::ZERO, false);
    let at = eye(&app, walker).plan_pos;
    assert!(!in_a_house(at), "landed in a house at {at:?}");
}
