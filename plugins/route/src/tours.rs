//! Tests of whole tours: what a visitor would notice.

use glam::{DVec2, swizzles::Vec3Swizzles};
use proptest::prelude::*;
use veduta_city::{Ease, GridPos, LookAt, Place, PlanTerrain, Step, Tour, Viewpoint, Where, file};

use crate::{
    CompiledTour, Gazetteer, Pose, StepKind, StepProblem, StreetNet, TURN_DEG_S, TourError, compile, compile_with, pose::turn_deg,
    resume, resume_with, samples::grid_town,
};

const SAMPLE: &str = r#"(
    title: "Four minutes in a town of squares", city: "town.city", speed: 1.4, hour: 9, day: 280,
    steps: [
        Say(text: "Welcome"),
        Start(at: Place("Powder Tower"), look: Heading(deg: 200)),
        Wait(seconds: 2),
        Walk(to: Place("well"), via: [At(50, 0)], look: Ahead),
        Time(hour: 18, seconds: 20),
        Fov(deg: 40, seconds: 3),
        Walk(to: At(100, 100), speed: 2, look: Spot(at: Place("Old Town Hall"), height_m: 40)),
        Look(at: Heading(deg: 10, pitch_deg: 20), seconds: 3),
        Fly(through: [(110, 120, 20), (150, 150, 30), (190, 120, 12)], speed: 9),
        Fly(through: [(200, 60, 4)], speed: 5, ease: Out),
        Cut(to: At(0, 150), look: Heading(deg: 90), seconds: 2),
        Walk(to: At(60, 150), ease: Linear),
        Walk(to: At(20, 150)),
        Say(text: "That was it", seconds: 5),
    ],
)"#;

fn town() -> StreetNet {
    StreetNet::new(&grid_town(5, 50.0))
}

fn places() -> Gazetteer {
    let place = |name: &str, x: f64, y: f64| Place { name: name.to_owned(), pos: DVec2::new(x, y), ..Place::default() };
    let view = Some(Viewpoint { pos: DVec2::new(100.0, 48.0), eye_m: 1.7, heading_deg: 0.0, pitch_deg: 0.0 });
    let hall = Place { view, ..place("Old Town Hall", 120.0, 70.0) };
    Gazetteer::new(&[place("Powder Tower", 0.0, 0.0), place("Well", 50.0, 50.0), hall])
}

fn read(text: &str) -> Tour {
    file::parse(text, "sample.tour.ron").unwrap_or_else(|e| panic!("{e}"))
}

fn with_steps(steps: Vec<Step>) -> Tour {
    Tour { steps, ..read("(title: \"t\", city: \"c\", steps: [])") }
}

fn start(x: f64, y: f64) -> Step {
    Step::Start { at: Where::At(x, y), eye_m: None, look: LookAt::Ahead }
}

fn walk(x: f64, y: f64) -> Step {
    Step::Walk { to: Where::At(x, y), via: Vec::new(), speed: None, look: LookAt::Ahead, ease: Ease::InOut }
}

fn compiled(tour: &Tour) -> CompiledTour {
    compile(tour, &town(), &places()).unwrap_or_else(|e| panic!("{e}"))
}

/// What must hold between poses at 240 Hz wherever it is not dark.
fn no_jerk(pose: impl Fn(f64) -> Pose, duration_s: f64, gain_m_s2: f64) -> Result<(), String> {
    const HZ: f64 = 240.0;
    let mut last: Option<(Pose, Option<(glam::DVec3, f64, f64)>)> = None;
    for i in 0..=(duration_s * HZ) as u32 + 20 {
        let t = f64::from(i) / HZ;
        let now = pose(t);
        let Some((before, rates_before)) = last.take() else {
            last = Some((now, None));
            continue;
        };
        if now.fade == 1.0 {
            last = Some((now, None));
            continue;
        }
        let velocity = (now.at() - before.at()) * HZ;
        let turning = turn_deg(before.heading_deg, now.heading_deg) * HZ;
        let nodding = (now.pitch_deg - before.pitch_deg) * HZ;
        if turning.abs() > TURN_DEG_S * 1.001 || nodding.abs() > TURN_DEG_S * 1.001 {
            return Err(format!("at {t:.3} s turning at {turning} and {nodding} degrees a second"));
        }
        if let Some((velocity_before, turning_before, nodding_before)) = rates_before {
            let gain = (velocity - velocity_before).length() * HZ;
            if gain > gain_m_s2 {
                return Err(format!("at {t:.3} s an acceleration of {gain} m/s2"));
            }
            let turn_gain = (turning - turning_before).abs().max((nodding - nodding_before).abs()) * HZ;
            // 2 * 60 degrees a second within the half second of one average.
            if turn_gain > 250.0 {
                return Err(format!("at {t:.3} s an angular acceleration of {turn_gain} degrees/s2"));
            }
        }
        last = Some((now, Some((velocity, turning, nodding))));
    }
    Ok(())
}

#[test]
fn the_sample_plays_without_a_jerk() {
    let tour = compiled(&read(SAMPLE));
    assert!((200.0..280.0).contains(&tour.duration_s()), "{}", tour.duration_s());
    no_jerk(|t| tour.pose(t), tour.duration_s(), 12.0).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn every_step_has_its_span_in_order() {
    let read = read(SAMPLE);
    let tour = compiled(&read);
    let spans = tour.steps();
    assert_eq!(spans.iter().map(|s| s.index).collect::<Vec<_>>(), (0..read.steps.len()).collect::<Vec<_>>());
    assert!(spans.windows(2).all(|w| w[0].start_s <= w[1].start_s && w[0].end_s >= w[0].start_s));
    for (span, step) in spans.iter().zip(&read.steps) {
        assert_eq!((span.kind, span.is_walk), (StepKind::of(step), matches!(step, Step::Walk { .. })));
    }
    let (first, second) = (spans[3], spans[6]);
    assert_eq!(first.end_s, second.start_s, "walks join");
    assert!(tour.pose(first.end_s).plan_pos.distance(DVec2::new(50.0, 50.0)) < 1.0, "at the well");
    assert_eq!(spans[4].start_s, second.start_s, "the clock turns from the well on");
}

#[test]
fn the_ground_speed_is_the_speed_asked_for() {
    let tour = compiled(&with_steps(vec![start(0.0, 0.0), walk(100.0, 0.0), walk(100.0, 150.0)]));
    let speed = |t: f64| tour.pose(t).plan_pos.distance(tour.pose(t + 0.05).plan_pos) / 0.05;
    let (from, to) = (tour.steps()[1].start_s + 2.5, tour.steps()[2].end_s - 2.5);
    let mut t = from;
    while t < to {
        assert!((speed(t) - 1.4).abs() < 2e-3, "{} m/s at {t}", speed(t));
        t += 0.05;
    }
    assert!((tour.steps()[2].end_s - tour.steps()[1].start_s - 250.0 / 1.4).abs() < 2.5);
}

#[test]
fn a_flight_keeps_its_speed_and_passes_its_points() {
    let points = [(60.0, 10.0, 20.0), (120.0, 80.0, 30.0), (60.0, 160.0, 25.0)];
    let fly = Step::Fly { through: points.to_vec(), speed: 6.0, look: LookAt::Ahead, ease: Ease::InOut };
    let tour = compiled(&with_steps(vec![start(0.0, 0.0), fly]));
    let span = tour.steps()[1];
    let at = |t: f64| tour.pose(t).at();
    for p in points {
        let p = glam::DVec3::from(p);
        let nearest = (0..4000).map(|i| at(f64::from(i) * 0.02).distance(p)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.1, "{nearest} m from {p}");
    }
    let mut t = span.start_s + 6.0;
    while t < span.end_s - 4.0 {
        let speed = at(t).distance(at(t + 0.1)) / 0.1;
        assert!((speed - 6.0).abs() < 0.03, "{speed} m/s at {t}");
        t += 0.1;
    }
}

#[test]
fn the_eye_looks_where_the_step_says() {
    let hall = LookAt::Spot { at: Where::Place("Old Town Hall".into()), height_m: 41.65, follow: None };
    let tour = compiled(&with_steps(vec![
        start(100.0, 0.0),
        walk(100.0, 200.0),
        Step::Cut { to: Where::At(120.0, 30.0), eye_m: None, look: hall, seconds: 2.0 },
        Step::Look { at: LookAt::Heading { deg: 90.0, pitch_deg: -5.0 }, seconds: 4.0 },
        Step::Wait { seconds: 2.0 },
    ]));
    let walking = tour.pose(60.0);
    assert!(walking.heading_deg.min(360.0 - walking.heading_deg) < 1e-6 && walking.pitch_deg.abs() < 1e-6, "{walking:?}");
    let up = tour.pose(tour.steps()[3].start_s - 0.6);
    assert!((up.pitch_deg - 45.0).abs() < 1e-6, "40 m up and 40 m away: {up:?}");
    let end = tour.pose(tour.duration_s());
    assert!((end.heading_deg - 90.0).abs() < 1e-6 && (end.pitch_deg + 5.0).abs() < 1e-6, "{end:?}");
    assert_eq!(tour.pose(0.0).eye_m, 1.65);
}

#[test]
fn on_a_slope_the_eye_looks_up_and_down_at_what_stands_higher_and_lower() {
    // The ground falls northwards by a quarter.
    let heights = (0..4).flat_map(|row| [-row * 25 * 1024; 2]).collect();
    let terrain = PlanTerrain { origin: GridPos(0, 0), step: 100 * 1024, columns: 2, heights };
    let steps = vec![
        start(20.0, 30.0),
        Step::Look { at: LookAt::Spot { at: Where::At(20.0, 70.0), height_m: 1.65, follow: None }, seconds: 4.0 },
        Step::Wait { seconds: 2.0 },
    ];
    let tour = compile(&with_steps(steps), &town().on(&terrain), &places()).unwrap_or_else(|e| panic!("{e}"));
    let end = tour.pose(tour.duration_s());
    assert!((end.pitch_deg + libm::atan(0.25).to_degrees()).abs() < 1e-6, "{end:?}");
}

#[test]
fn who_turns_back_turns_round_before_walking_off() {
    let tour = compiled(&with_steps(vec![start(0.0, 0.0), walk(60.0, 0.0), walk(10.0, 0.0)]));
    no_jerk(|t| tour.pose(t), tour.duration_s(), 6.0).unwrap_or_else(|e| panic!("{e}"));
    let mut t = 0.0;
    while t < tour.duration_s() {
        let (a, b) = (tour.pose(t), tour.pose(t + 0.02));
        let moved = b.plan_pos - a.plan_pos;
        if moved.length() > 0.02 * 0.7 {
            let along = libm::atan2(moved.x, moved.y).to_degrees();
            assert!(turn_deg(a.heading_deg, along).abs() < 60.0, "backwards at {t}: {a:?}");
        }
        t += 0.02;
    }
}

#[test]
fn chapters_marks_rain_and_translations_come_in_time() {
    let tour = read(
        r#"(title: "A", translations: {"cs": "Á"}, city: "", steps: [
            Start(at: At(0, 0)),
            Chapter(title: "First", translations: {"cs": "První"}),
            Say(text: "Hello", translations: {"cs": "Dobrý den a vítejte u nás ve městě"}),
            Mark(name: "bells"),
            Wait(seconds: 4),
            Rain(wet: 1, seconds: 2),
            Chapter(title: "Second"),
            Wait(seconds: 4),
            Mark(name: "end"),
        ])"#,
    );
    let tour = compiled(&tour);
    assert_eq!([tour.title(), tour.title_in("cs"), tour.title_in("it")], ["A", "Á", "A"]);
    let chapters: Vec<(f64, &str)> = tour.chapters().iter().map(|c| (c.start_s, c.title.within("cs"))).collect();
    assert_eq!(chapters, [(0.8, "První"), (4.8, "Second")]);
    assert_eq!([tour.chapter(0.5), tour.chapter(1.0), tour.chapter(8.0)], [None, Some(0), Some(1)]);
    assert_eq!([tour.caption(1.0), tour.caption_in(1.0, "cs")], [Some("Hello"), Some("Dobrý den a vítejte u nás ve městě")]);
    assert!(tour.caption(3.0).is_some(), "there is time to read the longest of its texts");
    let marks = |after, until| tour.marks(after, until).iter().map(|mark| mark.name.as_str()).collect::<Vec<_>>();
    assert_eq!((marks(0.0, 0.8), marks(0.8, 8.0), marks(0.0, 9.0)), (vec!["bells"], vec![], vec!["bells", "end"]));
    assert_eq!([tour.wet(1.0), tour.wet(5.8), tour.wet(9.0)], [Some(0.0), Some(0.5), Some(1.0)]);
    assert_eq!(
        compiled(&with_steps(vec![start(0.0, 0.0)])).wet(1.0),
        None,
        "a tour that says nothing of it leaves the weather as it is"
    );
}

#[test]
fn captions_hours_and_fields_of_view_go_on_beside() {
    let tour = compiled(&read(SAMPLE));
    assert_eq!(tour.caption(0.0), Some("Welcome"));
    assert_eq!(tour.caption(30.0), None);
    assert_eq!(tour.caption(f64::NAN), None);
    let turned = tour.steps()[4];
    assert_eq!(turned.end_s - turned.start_s, 20.0);
    assert_eq!((tour.pose(turned.start_s).hour, tour.day()), (9.0, 280));
    assert_eq!(tour.pose(turned.start_s + 10.0).hour, 13.5);
    assert_eq!((tour.pose(turned.end_s).hour, tour.pose(turned.end_s).fov_deg), (18.0, 40.0));
    assert_eq!(tour.caption(tour.duration_s() - 0.01), Some("That was it"), "the tour ends when it has been read");
    let night = compiled(&with_steps(vec![
        start(0.0, 0.0),
        Step::Time { hour: 22.0, seconds: 0.0 },
        Step::Time { hour: 2.0, seconds: 4.0 },
        Step::Wait { seconds: 5.0 },
    ]));
    assert_eq!(night.pose(2.8).hour, 0.0, "over midnight");
    assert_eq!(night.pose(9.0).hour, 2.0);
}

#[test]
fn it_is_dark_wherever_the_visitor_jumps() {
    let tour = compiled(&read(SAMPLE));
    assert_eq!(tour.pose(0.0).fade, 1.0);
    let mut jumps = 0;
    let mut t = 0.0;
    while t < tour.duration_s() {
        let (a, b) = (tour.pose(t), tour.pose(t + 1.0 / 60.0));
        if a.plan_pos.distance(b.plan_pos) > 1.0 {
            jumps += 1;
            assert_eq!((a.fade, b.fade), (1.0, 1.0), "at {t}");
        }
        t += 1.0 / 60.0;
    }
    assert_eq!(jumps, 1);
    assert_eq!(tour.paths().len(), 2);
    assert!(tour.path().len() > 10);
}

#[test]
fn mistakes_name_the_step_and_the_fix() {
    let wrong = |steps: &str| {
        let tour = read(&format!("(title: \"t\", city: \"c\", steps: [{steps}])"));
        compile(&tour, &town(), &places()).expect_err(steps)
    };
    let says = |steps: &str, step: usize, words: &[&str]| {
        let error = wrong(steps);
        assert_eq!(error.step(), Some(step), "{error}");
        for word in words {
            assert!(error.to_string().contains(word), "{error}");
        }
    };
    assert_eq!(wrong(""), TourError::Empty);
    assert_eq!(wrong("Say(text: \"x\")"), TourError::Empty, "words alone are no tour");
    says("Say(text: \"x\"), Walk(to: At(1, 2))", 2, &["(Walk)", "Start(at: ...)"]);
    says("Wait(seconds: 1)", 1, &["Start"]);
    says("Start(at: Place(\"Powder Towr\"))", 1, &["Powder Towr", "did you mean \"Powder Tower\"?"]);
    says("Start(at: At(0, 0)), Walk(to: At(9, 0), speed: 0)", 2, &["speed", "between 0.1 and 10"]);
    says("Start(at: At(0, 0)), Walk(to: At(9, 0), speed: NaN)", 2, &["speed", "NaN"]);
    says("Start(at: At(inf, 0))", 1, &["coordinate", "inf"]);
    says("Start(at: At(0, 0)), Walk(to: At(1e9, 0))", 2, &["coordinate"]);
    says("Start(at: At(0, 0)), Walk(to: At(2e6, 0))", 2, &["2000.0 km long"]);
    says("Start(at: At(0, 0)), Walk(to: At(5000, 0))", 2, &["from the nearest street", "Cut"]);
    says("Start(at: At(0, 0)), Fly(through: [], speed: 3)", 2, &["at least one point"]);
    says("Start(at: At(0, 0)), Fly(through: [(0, 0, -3)], speed: 3)", 2, &["height"]);
    says("Start(at: At(0, 0), eye_m: 30), Walk(to: At(50, 0))", 2, &["30 m above the ground"]);
    says("Start(at: At(0, 0)), Wait(seconds: -1)", 2, &["between 0 and"]);
    says("Start(at: At(0, 0)), Wait(seconds: 21600)", 2, &["6 hours"]);
    says("Start(at: At(0, 0)), Say(text: \"x\", seconds: 1e300)", 2, &["1e300"]);
    says("Start(at: At(0, 0)), Narrate(file: \"../x.ogg\", text: \"x\")", 2, &["../x.ogg", ".ogg"]);
    says("Start(at: At(0, 0)), Narrate(file: \"x.ogg\", files: {\"cs\": \"x.mp3\"}, text: \"x\")", 2, &["x.mp3"]);
    says("Start(at: At(0, 0)), Sound(file: \"https://example.org/x.ogg\")", 2, &["in or below the tour's folder"]);
    says("Start(at: At(0, 0)), Picture(file: \"x.gif\", seconds: 3)", 2, &["x.gif", ".webp"]);
    says("Start(at: At(0, 0)), Picture(file: \"x.png\", seconds: -3)", 2, &["-3"]);
    says("Start(at: At(0, 0)), Fov(deg: 0)", 2, &["field of view"]);
    says("Start(at: At(0, 0)), Time(hour: 25)", 2, &["hour"]);
    says("Start(at: At(0, 0)), Look(at: Spot(at: Place(\"well\"), height_m: NaN), seconds: 1)", 2, &["height"]);
    let nan = Tour { speed: f64::NAN, ..with_steps(vec![start(0.0, 0.0)]) };
    assert!(matches!(compile(&nan, &town(), &places()), Err(TourError::Setting(_))));
    for day in [0, 367] {
        let never = Tour { day, ..with_steps(vec![start(0.0, 0.0)]) };
        assert!(matches!(compile(&never, &town(), &places()), Err(TourError::Setting(_))), "{day}");
    }
    let many = with_steps(vec![Step::Wait { seconds: 0.0 }; 10_001]);
    assert_eq!(compile(&many, &town(), &places()).map(|_| ()), Err(TourError::TooManySteps(10_001)));
    let text = "(title: \"t\", city: \"c\", steps: [\n  Start(at: At(0, 0)),\n  Walk(towards: At(0, 0)),\n])";
    let error = file::parse::<Tour>(text, "t.ron").expect_err("no such field");
    assert_eq!((error.line, error.text.as_str()), (3, "  Walk(towards: At(0, 0)),"));
}

#[test]
fn recordings_and_pictures_have_their_moments() {
    let text = r#"(title: "t", city: "c", steps: [
        Start(at: At(0, 0)),
        Sound(file: "organ.ogg"),
        Wait(seconds: 5),
        Narrate(file: "one.ogg", files: {"cs": "jedna.ogg"}, text: "One.", translations: {"cs": "Jedna."}, seconds: 4),
        Picture(file: "map.webp", caption: "A map", seconds: 3),
        Wait(seconds: 10),
        Sound(),
        Wait(seconds: 1),
    ])"#;
    let tour: Tour = file::parse(text, "t.ron").unwrap_or_else(|e| panic!("{e}"));
    let tour = compile(&tour, &town(), &places()).unwrap_or_else(|e| panic!("{e}"));
    let told_s = tour.steps().iter().find(|step| step.kind == StepKind::Narrate).expect("it is told").start_s;
    assert_eq!(tour.narrations(told_s - 0.1, told_s).iter().map(|n| n.within("cs")).collect::<Vec<_>>(), ["jedna.ogg"]);
    assert!(tour.narrations(told_s, told_s + 30.0).is_empty(), "each begins once");
    assert_eq!(tour.caption_in(told_s + 1.0, "cs"), Some("Jedna."), "its words are a caption");
    let shown = |t_s: f64| tour.picture(t_s).map(|picture| (picture.file.as_str(), picture.caption.own()));
    assert_eq!((shown(told_s + 1.0), shown(told_s + 3.5)), (Some(("map.webp", "A map")), None));
    assert_eq!(
        (tour.ambience(told_s - 4.0), tour.ambience(told_s), tour.ambience(tour.duration_s())),
        (Some("organ.ogg"), Some("organ.ogg"), None)
    );
    assert_eq!(tour.recordings("en").collect::<Vec<_>>(), ["one.ogg", "organ.ogg"]);
}

#[test]
fn a_visitor_does_not_walk_into_a_house() {
    // The house of the hall: no line may touch it.
    let house = |p: DVec2| p.x > 110.0 && p.x < 130.0 && p.y > 60.0 && p.y < 80.0;
    let free = |a: DVec2, b: DVec2| (0..=200).all(|i| !house(a.lerp(b, f64::from(i) / 200.0)));
    let hall = Place { name: "Hall".to_owned(), pos: DVec2::new(120.0, 70.0), ..Place::default() };
    let tour = with_steps(vec![
        start(100.0, 0.0),
        Step::Walk { to: Where::Place("hall".into()), via: Vec::new(), speed: None, look: LookAt::Ahead, ease: Ease::InOut },
    ]);
    let tour = compile_with(&tour, &town(), &Gazetteer::new(&[hall]), &free).unwrap_or_else(|e| panic!("{e}"));
    let end = tour.pose(tour.duration_s()).plan_pos;
    assert!(!house(end) && end.distance(DVec2::new(109.0, 70.0)) < 1.5, "before the door: {end}");
    assert!(tour.path().iter().all(|p| !house(*p)));
}

#[test]
fn a_free_square_is_crossed() {
    let streets = StreetNet::new(&[
        crate::samples::street(&[(-80.0, 0.0), (0.0, 0.0)]),
        crate::samples::street(&[(70.0, 40.0), (150.0, 40.0)]),
    ]);
    let tour = with_steps(vec![start(-80.0, 0.0), walk(150.0, 40.0)]);
    let blocked = compile(&tour, &streets, &Gazetteer::default()).expect_err("no street joins them");
    assert!(matches!(blocked, TourError::Step { step: 2, problem: StepProblem::NoWay(_), .. }), "{blocked}");
    let tour = compile_with(&tour, &streets, &Gazetteer::default(), &|_, _| true).unwrap_or_else(|e| panic!("{e}"));
    assert!(tour.pose(tour.duration_s()).plan_pos.distance(DVec2::new(150.0, 40.0)) < 1e-6);
}

#[test]
fn a_visitor_who_wandered_off_comes_back_without_a_jerk() {
    let (tour, net) = (compiled(&read(SAMPLE)), town());
    let t = tour.steps()[3].start_s + 15.0;
    let on = tour.pose(t);
    for (off, is_walk) in [
        (DVec2::new(0.0, 0.0), true),
        (DVec2::new(3.0, -4.0), true),
        (DVec2::new(-20.0, 0.0), true),
        (DVec2::new(0.0, 90.0), false),
    ] {
        let from = Pose { plan_pos: on.plan_pos + off, heading_deg: 300.0, pitch_deg: -10.0, eye_m: 2.0, ..on };
        let leg = resume(&tour, &net, from, t);
        assert_eq!(leg.is_walk(), is_walk, "{off}");
        assert_eq!(leg.pose(0.0).at().xy(), from.plan_pos);
        assert!(turn_deg(leg.pose(0.0).heading_deg, 300.0).abs() < 1.0);
        let joint = (leg.pose(leg.duration_s()), tour.pose(leg.resumes_at_s()));
        assert!(joint.0.at().distance(joint.1.at()) < 1e-6, "{joint:?}");
        // The leg, then the tour.
        let whole = |dt: f64| {
            if dt <= leg.duration_s() { leg.pose(dt) } else { tour.pose(leg.resumes_at_s() + dt - leg.duration_s()) }
        };
        no_jerk(whole, leg.duration_s() + 5.0, 8.0).unwrap_or_else(|e| panic!("{off}: {e}"));
    }
    let walled = resume_with(&tour, &net, Pose { plan_pos: on.plan_pos + DVec2::new(0.0, -8.0), ..on }, t, &|_, _| false);
    assert!(!walled.is_walk() || walled.duration_s() > 3.0);
    let lost = resume(&tour, &net, Pose { eye_m: f64::NAN, ..on }, f64::NAN);
    assert!(lost.pose(1.0).is_finite() && lost.duration_s().is_finite());
}

#[test]
fn poses_do_not_depend_on_who_asks() {
    let tour = compiled(&read(SAMPLE));
    let again = compiled(&read(SAMPLE));
    for i in (0..4000).rev() {
        let t = f64::from(i) * 0.037;
        assert_eq!(tour.pose(t), again.pose(t));
    }
    assert_eq!(tour.pose(f64::NAN), tour.pose(-5.0));
    assert_eq!(tour.pose(f64::INFINITY), tour.pose(tour.duration_s()));
}

fn any_look() -> impl Strategy<Value = LookAt> {
    prop_oneof![
        2 => Just(LookAt::Ahead),
        1 => (0.0..200.0, 0.0..200.0, 0.0..40.0f64).prop_map(|(x, y, height_m)| LookAt::Spot { at: Where::At(x, y), height_m, follow: None }),
        1 => (-400.0..400.0, -60.0..60.0f64).prop_map(|(deg, pitch_deg)| LookAt::Heading { deg, pitch_deg }),
    ]
}

fn any_ease() -> impl Strategy<Value = Ease> {
    prop_oneof![Just(Ease::InOut), Just(Ease::In), Just(Ease::Out), Just(Ease::Linear)]
}

fn any_step() -> impl Strategy<Value = Step> {
    let spot = || (0.0..200.0, 0.0..200.0f64).prop_map(|(x, y)| Where::At(x, y));
    prop_oneof![
        4 => (spot(), proptest::collection::vec(spot(), 0..2), 0.8..2.0f64, any_look(), any_ease())
            .prop_map(|(to, via, speed, look, ease)| Step::Walk { to, via, speed: Some(speed), look, ease }),
        2 => (proptest::collection::vec((0.0..200.0, 0.0..200.0, 1.5..3.9f64), 1..4), 1.0..12.0f64, any_look(), any_ease())
            .prop_map(|(through, speed, look, ease)| Step::Fly { through, speed, look, ease }),
        2 => (any_look(), 0.0..5.0f64).prop_map(|(at, seconds)| Step::Look { at, seconds }),
        1 => (0.0..3.0f64).prop_map(|seconds| Step::Wait { seconds }),
        1 => (spot(), any_look(), 0.0..3.0f64)
            .prop_map(|(to, look, seconds)| Step::Cut { to, eye_m: None, look, seconds }),
        1 => Just(Step::Say { text: "Words".to_owned(), translations: Default::default(), seconds: None }),
        1 => (20.0..90.0, 0.0..4.0f64).prop_map(|(deg, seconds)| Step::Fov { deg, seconds }),
    ]
}

/// Numbers as a hostile file may hold them.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -300.0..300.0f64,
        1 => any::<f64>(),
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e9), Just(-1e300), Just(1e-300), Just(0.0)],
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_tour_jerks(steps in proptest::collection::vec(any_step(), 1..7)) {
        let mut all = vec![start(10.0, 0.0)];
        all.extend(steps);
        let tour = compiled(&with_steps(all));
        // Flights brake at 10 m/s2 at most and bend at 6.
        if let Err(e) = no_jerk(|t| tour.pose(t), tour.duration_s(), 14.0) {
            return Err(TestCaseError::fail(e));
        }
    }

    #[test]
    fn no_numbers_make_it_panic_or_last_for_ever(
        n in proptest::collection::vec(any_number(), 12), kinds in proptest::collection::vec(0u8..8, 1..5),
    ) {
        let mut steps = vec![start(n[0], n[1])];
        let look = LookAt::Spot { at: Where::At(n[10], n[11]), height_m: n[9], follow: None };
        for kind in kinds {
            steps.push(match kind {
                0 => Step::Walk { to: Where::At(n[2], n[3]), via: vec![Where::At(n[7], 0.0)], speed: Some(n[4]), look: LookAt::Ahead, ease: Ease::In },
                1 => Step::Fly { through: vec![(n[5], n[6], n[7]), (n[7], n[5], 3.0)], speed: n[8], look: look.clone(), ease: Ease::InOut },
                2 => Step::Look { at: look.clone(), seconds: n[6] },
                3 => Step::Wait { seconds: n[7] },
                4 => Step::Say { text: "x".to_owned(), translations: Default::default(), seconds: Some(n[3]) },
                5 => Step::Fov { deg: n[2], seconds: n[5] },
                6 => Step::Time { hour: n[8], seconds: n[4] },
                _ => Step::Cut { to: Where::At(n[8], n[9]), eye_m: Some(n[2]), look: LookAt::Heading { deg: n[3], pitch_deg: n[4] }, seconds: n[5] },
            });
        }
        if let Ok(tour) = compile_with(&with_steps(steps), &town(), &places(), &|_, _| true) {
            prop_assert!(tour.duration_s() <= crate::LONGEST_TOUR_S + 6.0);
            for t in n {
                prop_assert!(tour.pose(t).is_finite());
            }
        }
    }
}

#[test]
fn a_track_is_followed_as_it_is_told_and_joined_without_a_jerk() {
    let text = r#"(title: "t", city: "c", steps: [
        Start(at: At(0, 0), look: Heading(deg: 90)),
        Walk(to: At(50, 0), look: Heading(deg: 90)),
        Track(keys: [(2, 50, 10, 4, 120, 5), (4, 60, 20, 9, 200, -10), (6, 70, 20, 9, 240, -20)]),
        Say(text: "on"),
        Track(keys: [(1.5, 75, 20, 8, 260, -25), (4, 80, 10, 1.65, 300, 0)]),
        Walk(to: At(100, 0)),
    ])"#;
    let tour = compiled(&read(text));
    let (first, second) = (tour.steps()[2], tour.steps()[4]);
    assert_eq!((first.end_s - first.start_s, second.start_s, second.end_s - second.start_s), (6.0, first.end_s, 4.0));
    assert_eq!(tour.steps()[3].start_s, first.end_s, "what is said begins between the two");
    let key = |t: f64, at: (f64, f64, f64), heading: f64, pitch: f64| {
        let pose = tour.pose(t);
        assert!(pose.at().distance(at.into()) < 1e-6, "{pose:?} at {t}");
        // A spline reads the directions: a little of the curve is lost.
        let off = turn_deg(pose.heading_deg, heading).abs().max((pose.pitch_deg - pitch).abs());
        assert!(off < 0.05, "{pose:?} at {t}");
    };
    key(first.start_s + 4.0, (60.0, 20.0, 9.0), 200.0, -10.0);
    key(first.end_s, (70.0, 20.0, 9.0), 240.0, -20.0);
    key(second.start_s + 1.5, (75.0, 20.0, 8.0), 260.0, -25.0);
    key(second.end_s, (80.0, 10.0, 1.65), 300.0, 0.0);
    let speed = |t: f64| tour.pose(t + 0.01).at().distance(tour.pose(t - 0.01).at()) / 0.02;
    assert!(speed(first.end_s) > 2.0 && speed(second.end_s) < 0.5, "on between the two, and at rest in the end");
    no_jerk(|t| tour.pose(t), tour.duration_s(), 40.0).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn a_track_that_cannot_be_is_told_what_is_wrong() {
    let wrong = |keys: Vec<(f64, f64, f64, f64, f64, f64)>| {
        let tour = with_steps(vec![start(0.0, 0.0), Step::Track { keys }]);
        compile(&tour, &town(), &places()).expect_err("it cannot be").to_string()
    };
    let key = |s: f64, height: f64| (s, 0.0, 0.0, height, 0.0, 0.0);
    for (keys, words) in [
        (vec![], "step 2 (Track): a track has at least one key"),
        (vec![key(0.0, 2.0)], "key 1 of the track comes at 0 s"),
        (vec![key(2.0, 2.0), key(1.0, 2.0)], "key 2 of the track comes at 1 s"),
        (vec![key(2.0, f64::NAN)], "a height in metres is NaN"),
        (vec![key(1e9, 2.0)], "a key's time in seconds is"),
    ] {
        let told = wrong(keys);
        assert!(told.contains(words), "{told}");
    }
}
