use glam::DVec2;
use veduta_city::{GridPos, LookAt, PlanTerrain, Severity, Step, Tour, Where, file};

use super::*;
use crate::{CompiledTour, Gazetteer, StreetNet, compile, pose::turn_deg, samples::grid_town};

const ANCHOR: Anchor = Anchor { lat: 50.087, lon: 14.421 };

fn level() -> PlanTerrain {
    PlanTerrain::default()
}

fn read_on(kml: &str, terrain: &PlanTerrain, zero_m: Option<f64>) -> (Tour, Vec<Finding>) {
    let city = KmlCity { name: "x.city", anchor: ANCHOR, zero_m, terrain, reach_m: 5_000.0 };
    from_kml(kml.as_bytes(), "x.kml", city).unwrap_or_else(|e| panic!("{e}\n{kml}"))
}

fn read(kml: &str) -> (Tour, Vec<Finding>) {
    read_on(kml, &level(), None)
}

fn compiled(tour: &Tour) -> CompiledTour {
    compile(tour, &StreetNet::new(&grid_town(5, 50.0)), &Gazetteer::default()).unwrap_or_else(|e| panic!("{e}\n{tour:?}"))
}

fn played(text: &str) -> CompiledTour {
    compiled(&file::parse(text, "t").unwrap_or_else(|e| panic!("{e}")))
}

/// A playlist within what must stand around it.
fn playlist(primitives: &str) -> String {
    format!(
        "<?xml version='1.0'?>\n<kml xmlns='http://www.opengis.net/kml/2.2' xmlns:gx='http://www.google.com/kml/ext/2.2'>\n<gx:Tour><name>A &amp; B</name>\n<gx:Playlist>\n{primitives}\n</gx:Playlist></gx:Tour></kml>"
    )
}

fn fly(seconds: f64, mode: &str, (x, y): (f64, f64), rest: &str) -> String {
    let (lat, lon) = ANCHOR.geo_from_plan(DVec2::new(x, y));
    format!(
        "<gx:FlyTo><gx:duration>{seconds}</gx:duration><gx:flyToMode>{mode}</gx:flyToMode><Camera><longitude>{lon}</longitude><latitude>{lat}</latitude>{rest}</Camera></gx:FlyTo>\n"
    )
}

const AT_10_M: &str = "<altitude>10</altitude><heading>90</heading><tilt>80</tilt><altitudeMode>relativeToGround</altitudeMode>";

/// That two tours show the same at all times.
fn alike(a: &CompiledTour, b: &CompiledTour) {
    let mut worst = [0.0_f64; 4];
    let seconds = a.duration_s().max(b.duration_s());
    for i in 0..=(seconds * 120.0) as u32 {
        let t = f64::from(i) / 120.0;
        // At the moment of a cut it is dark.
        let (p, q) = (a.pose(t), b.pose(t));
        if p.fade == 1.0 || q.fade == 1.0 {
            continue;
        }
        let off = [
            p.plan_pos.extend(p.eye_m).distance(q.plan_pos.extend(q.eye_m)),
            turn_deg(p.heading_deg, q.heading_deg).abs().max((p.pitch_deg - q.pitch_deg).abs()),
            (p.fov_deg - q.fov_deg).abs(),
            turn_deg(15.0 * p.hour, 15.0 * q.hour).abs() / 15.0,
        ];
        assert!(off[0] < 0.1 && off[1] < 0.5 && off[2] < 0.5 && off[3] < 0.15, "at {t}: {off:?} between {p:?} and {q:?}");
        worst = core::array::from_fn(|i| worst[i].max(off[i]));
    }
    println!("{worst:?}");
    assert!((a.duration_s() - b.duration_s()).abs() < 0.1, "{} and {}", a.duration_s(), b.duration_s());
}

#[test]
fn a_tour_goes_out_and_comes_in_again() {
    let tour = played(
        r#"(title: "Out & in", city: "x", fov_deg: 60, hour: 9, day: 280, steps: [
            Start(at: At(0, 0), look: Heading(deg: 200)),
            Say(text: "a < b & \"c\"", translations: {"cs": "á"}, seconds: 4),
            Wait(seconds: 2),
            Walk(to: At(50, 50), look: Ahead),
            Time(hour: 18, seconds: 20),
            Fov(deg: 40, seconds: 3),
            Walk(to: At(100, 100), speed: 2, look: Spot(at: At(120, 70), height_m: 40)),
            Look(at: Heading(deg: 10, pitch_deg: 20), seconds: 3),
            Say(text: "up"),
            Fly(through: [(110, 120, 20), (150, 150, 30), (190, 120, 12)], speed: 15),
            Cut(to: At(0, 150), look: Heading(deg: 90), seconds: 2),
            Wait(seconds: 3),
            Cut(to: At(50, 150), look: Ahead),
            Walk(to: At(20, 150)),
            Say(text: "That was it", seconds: 5),
        ])"#,
    );
    let (kml, lost) = to_kml(&tour, ANCHOR, "en");
    assert_eq!(lost.len(), 1, "the dark: {lost:?}");
    let (again, findings) = read(&kml);
    assert_eq!(findings, [], "{kml}");
    assert_eq!((again.title.as_str(), again.day, again.fov_deg), ("Out & in", 280, 60.0));
    let played = compiled(&again);
    alike(&tour, &played);
    for i in 0..(tour.duration_s() * 10.0) as u32 {
        let t = f64::from(i) / 10.0 + 0.013;
        assert_eq!((tour.caption(t), tour.caption_in(t, "cs")), (played.caption(t), played.caption_in(t, "cs")), "at {t}");
    }
    let fovs: Vec<&Step> = again.steps.iter().filter(|step| matches!(step, Step::Fov { .. })).collect();
    assert_eq!(fovs.len(), 1, "a turn of a dial stays one: {fovs:?}");
}

#[test]
fn samples_are_as_near_to_the_tour_on_straight_lines_as_on_curves() {
    let tour = played(
        "(title: \"t\", city: \"x\", steps: [Start(at: At(0, 0)), Walk(to: At(100, 150)), Fly(through: [(150, 150, 30), (0, 0, 9)], speed: 20)])",
    );
    let (kml, _) = to_kml(&tour, ANCHOR, "en");
    // Each flight as one of its own along a line with an even speed: what is between two samples at most.
    let (again, _) = read(&kml);
    let keys: Vec<(f64, DVec2)> = {
        let (mut now, mut keys) = (0.8, Vec::new());
        for step in &again.steps {
            match step {
                Step::Track { keys: own } => {
                    keys.extend(own.iter().map(|key| (now + key.0, DVec2::new(key.1, key.2))));
                    now += own.last().map_or(0.0, |key| key.0);
                }
                Step::Wait { seconds } => now += seconds,
                _ => {}
            }
        }
        keys
    };
    assert!(keys.len() > 50);
    for pair in keys.windows(2) {
        for share in [0.25, 0.5, 0.75] {
            let t = pair[0].0 + (pair[1].0 - pair[0].0) * share;
            let off = tour.pose(t).plan_pos.distance(pair[0].1.lerp(pair[1].1, share));
            assert!(off < 0.05, "{off} m at {t}");
        }
    }
}

#[test]
fn cameras_and_targets_stand_where_they_say() {
    // The ground falls northwards by a quarter, from 300 m above the sea.
    let heights = (0..4).flat_map(|row| [-row * 25 * 1024; 2]).collect();
    let terrain = PlanTerrain { origin: GridPos(0, 0), step: 100 * 1024, columns: 2, heights };
    let first = |primitives: &str| match &read_on(&playlist(primitives), &terrain, Some(300.0)).0.steps[0] {
        Step::Start { at: Where::At(x, y), eye_m: Some(eye_m), look: LookAt::Heading { deg, pitch_deg } } => {
            [*x, *y, *eye_m, *deg, *pitch_deg]
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(first(&fly(0.0, "bounce", (30.0, 40.0), AT_10_M)), [30.0, 40.0, 10.0, 90.0, -10.0]);
    let absolute = AT_10_M.replace("relativeToGround", "absolute").replace(">10<", ">310<");
    assert_eq!(
        first(&fly(0.0, "bounce", (30.0, 40.0), &absolute)),
        [30.0, 40.0, 20.0, 90.0, -10.0],
        "10 m above zero, 20 above ground"
    );
    let clamped = AT_10_M.replace("relativeToGround", "clampToGround");
    assert_eq!(first(&fly(0.0, "bounce", (30.0, 40.0), &clamped)), [30.0, 40.0, 1.65, 90.0, -10.0]);
    // 100 m to the south of a target 10 m above its ground, 45° down at it: 25 m of that are ground.
    let target = fly(
        0.0,
        "bounce",
        (30.0, 140.0),
        "<altitude>10</altitude><tilt>45</tilt><range>141.4213562</range><altitudeMode>relativeToGround</altitudeMode>",
    );
    let target = target.replace("Camera", "LookAt");
    assert_eq!(first(&target), [30.0, 40.0, 85.0, 0.0, -45.0]);
}

#[test]
fn flights_wait_and_words_come_at_their_times() {
    let list = [
        fly(3.0, "bounce", (0.0, 0.0), AT_10_M),
        "<gx:AnimatedUpdate><gx:delayedStart>1</gx:delayedStart><Update><Change><Placemark targetId='p'><gx:balloonVisibility>1</gx:balloonVisibility></Placemark></Change></Update></gx:AnimatedUpdate>".to_owned(),
        fly(4.0, "bounce", (40.0, 0.0), AT_10_M),
        fly(2.0, "bounce", (40.0, 20.0), AT_10_M),
        "<gx:AnimatedUpdate><Update><Change><Placemark targetId='p'><gx:balloonVisibility>0</gx:balloonVisibility></Placemark></Change></Update></gx:AnimatedUpdate>".to_owned(),
        "<gx:Wait><gx:duration>2.5</gx:duration></gx:Wait>".to_owned(),
        fly(2.0, "smooth", (60.0, 20.0), AT_10_M),
        fly(2.0, "smooth", (80.0, 20.0), AT_10_M),
    ];
    let place =
        "<Placemark id='p'><name>n</name><description><![CDATA[<b>The</b> tower &amp; bell]]></description></Placemark></kml>";
    let (tour, findings) = read(&playlist(&list.concat()).replace("</kml>", place));
    assert_eq!(findings, []);
    assert_eq!(tour.title, "A & B");
    let played = compiled(&tour);
    for (t, x, y) in [
        (3.0, 0.0, 0.0),
        (5.0, 20.0, 0.0),
        (7.0, 40.0, 0.0),
        (9.0, 40.0, 20.0),
        (11.5, 40.0, 20.0),
        (13.5, 60.0, 20.0),
        (15.5, 80.0, 20.0),
    ] {
        let pose = played.pose(t);
        assert!(pose.plan_pos.distance(DVec2::new(x, y)) < 0.05, "at {t}: {pose:?}\n{tour:?}");
    }
    let speed = |t: f64| played.pose(t + 0.005).plan_pos.distance(played.pose(t - 0.005).plan_pos) / 0.01;
    assert!(speed(7.0) < 0.2 && speed(13.5) > 8.0, "from rest to rest, and smooth: {} and {}", speed(7.0), speed(13.5));
    let words = |t: f64| played.caption(t).map(str::to_owned);
    assert_eq!(
        [words(3.9), words(4.1), words(8.9), words(9.1)],
        [None, Some("The tower & bell".into()), Some("The tower & bell".into()), None]
    );
}

#[test]
fn what_a_tour_does_not_do_is_told_with_its_line() {
    let list = [
        fly(0.0, "bounce", (0.0, 0.0), &AT_10_M.replace("<tilt>", "<roll>5</roll><tilt>")),
        fly(1.0, "bounce", (1.0, 0.0), &AT_10_M.replace("<tilt>", "<roll>5</roll><tilt>")),
        "<gx:SoundCue><href>a.mp3</href></gx:SoundCue>\n<gx:TourControl><gx:playMode>pause</gx:playMode></gx:TourControl>\n".to_owned(),
        "<gx:AnimatedUpdate><Update><Change><IconStyle targetId='i'><scale>9</scale></IconStyle></Change><Delete/></Update></gx:AnimatedUpdate>\n".to_owned(),
        fly(1.0, "bounce", (900_000.0, 0.0), AT_10_M),
        fly(1.0, "bounce", (2.0, 0.0), &AT_10_M.replace(">10<", ">-3<")),
        "<gx:FlyTo/><gx:Dance/><gx:Wait><gx:duration>soon</gx:duration></gx:Wait>".to_owned(),
    ];
    let (tour, findings) = read(&playlist(&list.concat()));
    assert!(tour.steps.len() > 2);
    let told: Vec<String> = findings.iter().map(ToString::to_string).collect();
    for (i, start) in [
        "dropped: line 5, column 93: the camera's roll is left out: visitors stay upright (and 1 more like it)",
        "dropped: line 7, column 1: the sound `a.mp3` is not played",
        "dropped: line 8, column 1: the pause",
        "dropped: line 9, column 36: the change of `IconStyle`",
        "dropped: line 9, column 101: `Delete` is left out",
        "dropped: line 10, column 93: the view is 900 km from",
        "repaired: line 11, column 93: the eye would be -3.0 m above the ground; it is raised to 1.65",
        "dropped: line 12, column 1: a flight without `Camera` or `LookAt`",
        "dropped: line 12, column 12: `Dance` is nothing that a tour does",
        "repaired: line 12, column 23: `soon` is no time in seconds",
    ]
    .iter()
    .enumerate()
    {
        let found = told.get(i).map_or("", String::as_str);
        let (shown, _) = found.split_at(found.len().min(start.len()));
        assert!(shown == *start || found.contains(start.split(": ").last().unwrap_or("")), "{i}: {found}\nis not {start}");
    }
}

#[test]
fn what_is_no_tour_is_refused_with_a_place() {
    let terrain = level();
    let city = KmlCity { name: "x", anchor: ANCHOR, zero_m: None, terrain: &terrain, reach_m: 50_000.0 };
    let wrong = |text: &str| from_kml(text.as_bytes(), "x.kml", city).expect_err(text).to_string();
    for (text, words) in [
        ("", "x.kml:1:1: there is no element in it: this is not KML"),
        ("<kml><Document>\n</kml>", "x.kml:2:1: broken XML"),
        ("<kml>\n<gx:Tour>", "x.kml:2:10: the text ends within `Tour`"),
        ("<kml><Document/></kml>", "x.kml:1:1: `kml` has no `gx:Tour` in it"),
        ("<kml>&boom;</kml>", "x.kml:1:6: broken XML: there is no `&boom;`"),
        ("PK\u{3}\u{4}zip", "this is an archive (KMZ)"),
        (&playlist("<gx:Wait/>"), "x.kml:3:1: the tour shows nothing of the city"),
        (&format!("{}{}", "<a>".repeat(70), "</a>".repeat(70)), "no tour needs so many"),
    ] {
        let told = wrong(text);
        assert!(told.contains(words), "{text}: {told}");
    }
}

proptest::proptest! {
    #[test]
    fn no_text_makes_the_reader_panic_and_every_tour_read_can_be_written_again(
        parts in proptest::collection::vec(0usize..9, 0..14),
        numbers in proptest::collection::vec(proptest::prop_oneof![0.0..9.0f64, -1e7..1e7f64, proptest::prelude::Just(0.0)], 14),
        cut in 0.0..1.5f64,
    ) {
        let part = |(i, part): (usize, &usize)| {
            let number = numbers[i % numbers.len()];
            match part {
                0..=3 => fly(number, if part % 2 == 0 { "smooth" } else { "bounce" }, (number, 5.0 * i as f64), AT_10_M),
                4 => format!("<gx:Wait><gx:duration>{number}</gx:duration></gx:Wait>"),
                5 => fly(0.0, "smooth", (3.0 * i as f64, number % 100.0), AT_10_M),
                6 => format!("<gx:AnimatedUpdate><gx:delayedStart>{number}</gx:delayedStart><Update><Change><Placemark targetId='p'><description>w{i}</description></Placemark></Change></Update></gx:AnimatedUpdate>"),
                7 => fly(number, "smooth", (1.0, 1.0), &format!("<gx:horizFov>{number}</gx:horizFov><gx:TimeStamp><when>2024-06-08T0{}:00:00Z</when></gx:TimeStamp><tilt>{number}</tilt>", i % 10)),
                _ => "<x>".to_owned(),
            }
        };
        let text = playlist(&parts.iter().enumerate().map(part).collect::<String>());
        let end = (text.len() as f64 * cut.min(1.0)) as usize;
        let terrain = level();
        let city = KmlCity { name: "x", anchor: ANCHOR, zero_m: None, terrain: &terrain, reach_m: 50_000.0 };
        if let Ok((tour, _)) = from_kml(&text.as_bytes()[..end], "x.kml", city) {
            let played = compiled(&tour);
            let written = veduta_city::TourText::new(&tour);
            proptest::prop_assert!(written.is_ok());
            if played.duration_s() < 300.0 {
                let (kml, _) = to_kml(&played, ANCHOR, "en");
                proptest::prop_assert!(from_kml(kml.as_bytes(), "y.kml", city).is_ok());
            }
        }
    }
}

#[test]
fn notes_have_their_weight() {
    let far = fly(9.0, "bounce", (900.0, 0.0), AT_10_M);
    let (_, findings) = read(&playlist(&(fly(0.0, "bounce", (0.0, 0.0), AT_10_M) + &far)));
    assert!(findings.iter().all(|finding| finding.severity == Severity::Note), "{findings:?}");
    assert_eq!(findings.len(), 2, "the arc, and the dark at the begin: {findings:?}");
}
