//! A walker on a bridge, and under none.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta::prelude::*;
use veduta::walker::Intent;
use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{Viewpoint, WaySpan};
use veduta_tests::{riverside_city, riverside_graph, walker_in};

fn bridges() -> Vec<WaySpan> {
    let input = Input::of(&riverside_graph()).unwrap_or_else(|e| panic!("{e}"));
    plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan.spans
}

fn eye(app: &App, walker: Entity) -> Eye {
    *app.world().get::<Eye>(walker).expect("the walker has an eye")
}

fn go(app: &mut App, intent: Intent) {
    *app.world_mut().resource_mut::<Intent>() = intent;
    app.update();
}

fn on_bridge(bridges: &[WaySpan], pos: DVec2) -> Option<f64> {
    bridges.iter().find_map(|span| span.height_m(pos))
}

fn ahead(run: bool) -> Intent {
    Intent { go: DVec3::new(0.0, 1.0, 0.0), run, ..Intent::default() }
}

#[test]
fn a_walker_crosses_the_river_with_both_feet_on_the_bridge() {
    let bridges = bridges();
    let (mut app, walker) = walker_in(riverside_city());
    let mut steps = 0;
    for _ in 0..2_400 {
        go(&mut app, ahead(true));
        let eye = eye(&app, walker);
        let Some(height) = on_bridge(&bridges, eye.plan_pos) else { continue };
        assert!((height - 0.25..height + 0.3).contains(&eye.ground_m), "{} on {height} at {}", eye.ground_m, eye.plan_pos);
        steps += 1;
    }
    let end = eye(&app, walker);
    println!("{steps} steps on the bridge, to {}", end.plan_pos);
    assert!(steps > 300 && end.plan_pos.x > 60.0, "{end:?}");
}

#[test]
fn a_parapet_stops_whoever_walks_against_it() {
    let bridges = bridges();
    let (mut app, walker) = walker_in(riverside_city());
    for (heading_deg, pos) in [(0.0, DVec2::new(5.0, 2.5)), (180.0, DVec2::new(12.0, 2.5))] {
        app.world_mut().write_message(JumpTo(Viewpoint { pos, heading_deg, ..Default::default() }));
        for _ in 0..200 {
            go(&mut app, Intent::default());
        }
        let start = eye(&app, walker);
        let height = on_bridge(&bridges, pos).expect("a bridge is there");
        assert!(
            (height - 0.1..height + 0.2).contains(&start.ground_m),
            "{} on {height}: whoever jumps there is on it",
            start.ground_m
        );
        for _ in 0..600 {
            go(&mut app, ahead(true));
        }
        let end = eye(&app, walker);
        assert!(end.plan_pos.distance(pos) > 4.0 && on_bridge(&bridges, end.plan_pos).is_some(), "{end:?}");
    }
}
