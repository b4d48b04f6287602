//! A walker, a flight and a tour on a hillside.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta::prelude::*;
use veduta::walker::Intent;
use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::PlanTerrain;
use veduta_tests::{hillside_city, hillside_graph, walker_in};

fn terrain() -> PlanTerrain {
    let input = Input::of(&hillside_graph()).unwrap_or_else(|e| panic!("{e}"));
    plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan.terrain
}

fn eye(app: &App, walker: Entity) -> Eye {
    *app.world().get::<Eye>(walker).expect("the walker has an eye")
}

fn go(app: &mut App, intent: Intent) {
    *app.world_mut().resource_mut::<Intent>() = intent;
    app.update();
}

#[test]
fn a_walker_goes_up_and_down_a_steep_lane_with_both_feet_on_it() {
    let terrain = terrain();
    let (mut app, walker) = walker_in(hillside_city());
    let start = eye(&app, walker);
    for heading_deg in [0.0, 180.0] {
        app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").heading_deg = heading_deg;
        for _ in 0..900 {
            go(&mut app, Intent { go: DVec3::new(0.0, 1.0, 0.0), ..Intent::default() });
            let eye = eye(&app, walker);
            let ground = terrain.height_m(eye.plan_pos);
            assert!((ground - 0.15..ground + 0.35).contains(&eye.ground_m), "{} on {ground} at {}", eye.ground_m, eye.plan_pos);
            assert!((eye.eye_m - 1.65).abs() < 0.1);
        }
        let now = eye(&app, walker);
        let gone = now.plan_pos.y - start.plan_pos.y;
        println!("heading {heading_deg}: {gone:.1} m north, ground {:.1} m", now.ground_m);
        match heading_deg {
            0.0 => assert!(gone > 25.0 && now.ground_m > start.ground_m + 3.0, "{now:?}"),
            _ => assert!(gone < 5.0, "{now:?}"),
        }
    }
}

#[test]
fn a_flight_goes_straight_on_over_the_hill_and_ends_on_its_ground() {
    let terrain = terrain();
    let (mut app, walker) = walker_in(hillside_city());
    go(&mut app, Intent { toggle_fly: true, ..Intent::default() });
    for _ in 0..60 {
        go(&mut app, Intent { go: DVec3::new(0.0, 0.0, 1.0), ..Intent::default() });
    }
    for _ in 0..40 {
        go(&mut app, Intent::default());
    }
    let before = eye(&app, walker);
    assert!(before.eye_m > 15.0, "{before:?}");
    app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").pitch_deg = 0.0;
    for _ in 0..90 {
        go(&mut app, Intent { go: DVec3::new(0.0, 1.0, 0.0), ..Intent::default() });
    }
    let after = eye(&app, walker);
    assert!(after.plan_pos.distance(before.plan_pos) > 20.0, "{after:?}");
    assert!((after.z_m() - before.z_m()).abs() < 0.5, "from {} m to {} m", before.z_m(), after.z_m());
    assert!(after.ground_m > before.ground_m + 1.0, "{after:?}");
    go(&mut app, Intent { toggle_fly: true, ..Intent::default() });
    for _ in 0..90 {
        go(&mut app, Intent::default());
    }
    let landed = eye(&app, walker);
    let ground = terrain.height_m(landed.plan_pos);
    assert!((ground - 0.1..ground + 0.3).contains(&landed.ground_m), "{} on {ground}", landed.ground_m);
}

#[test]
fn whoever_is_put_somewhere_stands_on_the_ground_there() {
    let terrain = terrain();
    let (mut app, walker) = walker_in(hillside_city());
    for (x, y) in [(100.0, 60.0), (30.0, 64.0), (170.0, 69.0), (108.0, 122.0)] {
        let pos = DVec2::new(x, y);
        app.world_mut().write_message(JumpTo(veduta_city::Viewpoint { pos, ..Default::default() }));
        for _ in 0..200 {
            go(&mut app, Intent::default());
        }
        let eye = eye(&app, walker);
        let ground = terrain.height_m(eye.plan_pos);
        assert!(eye.plan_pos.distance(pos) < 1.0 && eye.fade == 0.0, "{eye:?}");
        assert!((ground - 0.05..ground + 0.2).contains(&eye.ground_m), "{} on {ground} at {pos}", eye.ground_m);
    }
}
