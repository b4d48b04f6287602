//! Who is led over a line that fails, by a tour or along the streets: he stands still before what has not come, and is never led into a hole.

use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta::ecs::{Awaited, Itinerary, StandingCells, WalkTo};
use veduta::guide::Lead;
use veduta::prelude::*;
use veduta::streaming::{Fetching, Link, StreamingSettings, Wanted};
use veduta::tour::{TourCommand, TourPlayer, TourState};
use veduta_city::{Level, Tour, Viewpoint, file};
use veduta_tests::{quiet_app, sample_city, scene, update_until};

const STEP_S: f64 = 0.05;

struct Led {
    app: App,
    viewer: Entity,
    /// Seconds in which it stood still for what lay ahead.
    waited_s: f64,
}

impl Led {
    /// On the sample tour, over a line.
    fn begin(link: Link) -> Self {
        let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_secs_f64(STEP_S));
        app.add_plugins(TourPlugin { interface: false }).insert_resource(link);
        let viewer = app.world_mut().spawn((Viewer, Transform::default(), Projection::default())).id();
        let tour: Tour = file::read(&scene().join("royal_route.tour.ron")).unwrap_or_else(|e| panic!("{e}"));
        app.world_mut().write_message(TourCommand::Give(Box::new(tour)));
        update_until(&mut app, 4_000, "the tour plays", |world| world.resource::<TourPlayer>().state() == TourState::Playing);
        Self { app, viewer, waited_s: 0.0 }
    }

    fn time_s(&self) -> f64 {
        self.app.world().resource::<TourPlayer>().time_s()
    }

    /// Nothing that is in sight is missing, unless it is dark, or districts stand for cells.
    fn check(&self) {
        let world = self.app.world();
        let eye = world.get::<Eye>(self.viewer).expect("spawned");
        let is_flying = eye.eye_m >= world.resource::<StreamingSettings>().flying_from_m;
        let (wanted, standing) = (world.resource::<Wanted>(), world.resource::<StandingCells>());
        let is_missing = |cell: &&u32| wanted.wants(**cell) && !standing.levels(**cell).has(Level::One);
        let missing: Vec<&u32> = wanted.in_sight.iter().filter(is_missing).collect();
        assert!(missing.is_empty() || eye.fade >= 1.0 || is_flying, "at {:?}, cells {missing:?} are holes", eye.plan_pos);
    }

    /// Lets it play for so long, or to its end; in no frame that is not dark anything that is in sight may be missing.
    fn play(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S) as u32 {
            self.app.update();
            self.check();
            let player = self.app.world().resource::<TourPlayer>();
            self.waited_s += f64::from(u8::from(player.waits())) * STEP_S;
            if player.state() != TourState::Playing {
                return;
            }
        }
    }
}

const WELL: Link = Link { latency_s: 0.05, bytes_s: 200_000.0, loss: 0.0, is_down: false };

#[test]
fn on_a_good_line_a_tour_never_waits() {
    let mut led = Led::begin(WELL);
    led.play(200.0);
    let player = led.app.world().resource::<TourPlayer>();
    let whole_s = player.tour().expect("ready").duration_s();
    assert_eq!((player.state(), player.time_s()), (TourState::Paused, whole_s), "it has ended");
    assert!(led.waited_s < 0.5, "{} s were waited", led.waited_s);
}

#[test]
fn where_the_line_is_down_a_tour_waits_for_what_lies_ahead_and_goes_on() {
    let mut led = Led::begin(WELL);
    led.play(15.0);
    led.app.insert_resource(Link { is_down: true, ..WELL });
    led.play(300.0);
    let (stood_s, waited_s) = (led.time_s(), led.waited_s);
    assert!(waited_s > 200.0 && stood_s < 100.0, "{waited_s} s were waited, at {stood_s} s of the tour");
    led.app.insert_resource(WELL);
    led.play(10.0);
    assert!(led.time_s() > stood_s + 4.0, "it goes on within 5 s: {} s", led.time_s() - stood_s);
    led.play(200.0);
    assert_eq!(led.app.world().resource::<TourPlayer>().state(), TourState::Paused, "it comes to its end");
}

/// Who left the tour walks back to it, and that way is read ahead, not the tour's.
#[test]
fn the_way_back_to_a_tour_is_told_ahead() {
    let mut led = Led::begin(WELL);
    led.play(45.0);
    led.app.insert_resource(Link { is_down: true, ..WELL });
    // Taken elsewhere meanwhile, where nothing is.
    let away = led.app.world().resource::<City>().start.pos;
    *led.app.world_mut().resource_mut::<Steering>() = Steering::Visitor;
    led.app.update();
    led.app.world_mut().get_mut::<Eye>(led.viewer).expect("spawned").plan_pos = away;
    led.app.world_mut().write_message(TourCommand::Play);
    led.app.update();
    led.app.update();
    assert_eq!(led.app.world().resource::<TourPlayer>().state(), TourState::Returning);
    let itinerary = led.app.world().get::<Itinerary>(led.viewer).expect("a viewer has one");
    let near_m = itinerary.0[0].plan_pos.distance(away);
    assert!(near_m < 15.0, "what is told first lies on the way back, not {near_m} m away");
    led.app.insert_resource(WELL);
    for _ in 0..(120.0 / STEP_S) as u32 {
        led.app.update();
        if led.app.world().resource::<TourPlayer>().state() == TourState::Playing {
            return;
        }
    }
    panic!("it never comes back");
}

/// Who is led along the streets waits as a tour does.
#[test]
fn who_is_led_waits_for_what_lies_ahead() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_secs_f64(STEP_S));
    app.add_plugins(GuidePlugin { interface: false }).insert_resource(WELL);
    update_until(&mut app, 400, "the city is open", |world| world.contains_resource::<City>());
    let start = app.world().resource::<City>().start;
    let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
    update_until(&mut app, 2_000, "the start stands", |world| {
        let wanted = world.resource::<Wanted>();
        !wanted.in_sight.is_empty() && *world.resource::<Awaited>() == Awaited::default()
    });
    let to = Viewpoint { pos: DVec2::new(-480.0, 60.0), ..start };
    app.world_mut().write_message(WalkTo { name: "the river".to_owned(), to });
    update_until(&mut app, 4_000, "under way", |world| *world.resource::<Steering>() == Steering::Led);
    app.insert_resource(Link { is_down: true, ..WELL });
    let mut led = Led { app, viewer, waited_s: 0.0 };
    let steps = |led: &mut Led, seconds: f64| {
        for _ in 0..(seconds / STEP_S) as u32 {
            led.app.update();
            led.check();
            led.waited_s += f64::from(u8::from(led.app.world().resource::<Lead>().waits())) * STEP_S;
        }
    };
    steps(&mut led, 300.0);
    let stood = led.app.world().get::<Eye>(viewer).expect("spawned").plan_pos;
    assert!(led.waited_s > 100.0 && stood.distance(start.pos) < 400.0, "{} s were waited, at {stood}", led.waited_s);
    led.app.insert_resource(WELL);
    steps(&mut led, 10.0);
    let after = led.app.world().get::<Eye>(viewer).expect("spawned").plan_pos;
    assert!(after.distance(stood) > 3.0, "it goes on: from {stood} to {after}");
}

#[test]
fn over_a_slow_drip_a_tour_takes_longer_and_shows_no_hole() {
    let mut led = Led::begin(Link { bytes_s: 700.0, ..WELL });
    led.play(600.0);
    assert!(led.waited_s > 1.0, "it never had to wait");
    assert_eq!(led.app.world().resource::<TourPlayer>().state(), TourState::Paused, "it comes to its end");
}
