use glam::{DVec2, swizzles::Vec3Swizzles};
use veduta_city::{GridPos, LookAt, Place, Step, Tour, Viewpoint, Where};

use super::*;
use crate::{CompiledTour, StepKind, compile, samples::grid_town};

/// A visitor who is recorded at so many frames a second.
struct Visitor {
    t_s: f64,
    frame_s: f64,
    pose: Pose,
    recording: Recording,
    /// Every pose, with its moment.
    passed: Vec<(f64, Pose)>,
}

impl Visitor {
    fn new(x: f64, y: f64, heading_deg: f64, frames: f64) -> Self {
        let pose = Pose { plan_pos: (x, y).into(), eye_m: 1.65, heading_deg, fov_deg: 55.0, ..Pose::default() };
        Self { t_s: 0.0, frame_s: 1.0 / frames, pose, recording: Recording::default(), passed: Vec::new() }
    }

    fn frame(&mut self) {
        self.recording.note(self.t_s, &self.pose);
        self.passed.push((self.t_s, self.pose));
        self.t_s += self.frame_s;
    }

    fn stand(&mut self, seconds: f64) {
        (0..(seconds / self.frame_s) as u32).for_each(|_| self.frame());
    }

    /// Turns at 70 degrees a second.
    fn turn(&mut self, by_deg: f64, tilt_deg: f64) {
        let frames = (by_deg.abs().max(tilt_deg.abs()) / 70.0 / self.frame_s).ceil();
        for _ in 0..frames as u32 {
            self.pose.heading_deg = (self.pose.heading_deg + by_deg / frames).rem_euclid(360.0);
            self.pose.pitch_deg += tilt_deg / frames;
            self.frame();
        }
    }

    /// Goes to a spot and height without turning.
    fn go(&mut self, x: f64, y: f64, eye_m: f64, speed: f64) {
        let (from, to) = (self.pose.at(), DVec3::new(x, y, eye_m));
        let frames = (from.distance(to) / speed / self.frame_s).ceil();
        for i in 1..=frames as u32 {
            let at = from.lerp(to, f64::from(i) / frames);
            (self.pose.plan_pos, self.pose.eye_m) = (at.xy(), at.z);
            self.frame();
        }
    }

    /// Turns towards a spot while walking there, as one does with the keys.
    fn walk(&mut self, x: f64, y: f64, speed: f64) {
        loop {
            let d = DVec2::new(x, y) - self.pose.plan_pos;
            if d.length() < 1.2 * speed * self.frame_s + 0.3 {
                return;
            }
            let wanted = turn_deg(self.pose.heading_deg, libm::atan2(d.x, d.y).to_degrees());
            let most = 70.0 * self.frame_s;
            self.pose.heading_deg = (self.pose.heading_deg + wanted.clamp(-most, most)).rem_euclid(360.0);
            if wanted.abs() < 60.0 {
                let heading = self.pose.heading_deg.to_radians();
                self.pose.plan_pos += DVec2::new(heading.sin(), heading.cos()) * speed * self.frame_s;
            }
            self.frame();
        }
    }
}

fn tour() -> Tour {
    let text = r#"(title: "t", city: "x", steps: [])"#;
    veduta_city::file::parse(text, "t.tour.ron").expect("no mistakes")
}

fn played(steps: Vec<Step>, net: &StreetNet, places: &Gazetteer) -> CompiledTour {
    let tour = Tour { steps, ..tour() };
    compile(&tour, net, places).unwrap_or_else(|error| panic!("{error}\n{:#?}", tour.steps))
}

/// How far two courses are from each other, each gone through in order (the discrete Fréchet distance; Eiter and Mannila 1994).
fn apart_m(a: &[DVec3], b: &[DVec3]) -> f64 {
    let mut row: Vec<f64> = Vec::new();
    for &p in a {
        let mut next: Vec<f64> = Vec::with_capacity(b.len());
        for (j, &q) in b.iter().enumerate() {
            let before = [row.get(j), j.checked_sub(1).and_then(|j| row.get(j)), next.last()];
            let reached = before.into_iter().flatten().copied().reduce(f64::min).unwrap_or(0.0);
            next.push(p.distance(q).max(reached));
        }
        row = next;
    }
    *row.last().expect("courses have points")
}

/// A course by its length: a point every so many metres.
fn course(points: impl Iterator<Item = DVec3>, every_m: f64) -> Vec<DVec3> {
    let mut course: Vec<DVec3> = Vec::new();
    let mut end = None;
    for p in points {
        end = Some(p);
        if course.last().is_none_or(|last| last.distance(p) >= every_m) {
            course.push(p);
        }
    }
    course.extend(end);
    course
}

/// The recording, played, is nowhere farther from the visit than `most_m`.
fn follows(visitor: &Visitor, net: &StreetNet, places: &Gazetteer, most_m: f64) -> (Vec<Step>, CompiledTour) {
    const EVERY_M: f64 = 0.25;
    let steps = visitor.recording.steps(&tour(), net, places);
    let compiled = played(steps.clone(), net, places);
    let visit = course(visitor.passed.iter().map(|(_, pose)| pose.at()), EVERY_M);
    let frames = (compiled.duration_s() * 30.0).ceil() as u32;
    let tour = course((0..=frames).map(|i| compiled.pose(f64::from(i) / 30.0).at()), EVERY_M);
    let apart = apart_m(&visit, &tour);
    assert!(apart <= most_m + EVERY_M, "{apart:.2} m apart\n{steps:#?}");
    (steps, compiled)
}

fn kinds(steps: &[Step]) -> Vec<StepKind> {
    steps.iter().map(StepKind::of).collect()
}

#[test]
fn a_walk_round_corners_is_one_step_and_is_followed() {
    let net = StreetNet::new(&grid_town(4, 50.0));
    for frames in [4.0, 30.0, 144.0] {
        let mut visitor = Visitor::new(0.0, 5.0, 0.0, frames);
        for (x, y) in [(0.6, 50.0), (50.0, 51.0), (99.5, 50.0), (100.0, 120.0)] {
            visitor.walk(x, y, 1.4);
        }
        let (steps, _) = follows(&visitor, &net, &Gazetteer::default(), RECORDED_WALK_M);
        let kinds = kinds(&steps);
        assert_eq!(kinds[0], StepKind::Start);
        assert!(kinds.len() <= 4 && kinds[1..].iter().all(|kind| matches!(kind, StepKind::Walk | StepKind::Look)), "{steps:#?}");
        let spots: usize = steps.iter().map(|step| if let Step::Walk { via, .. } = step { via.len() + 1 } else { 0 }).sum();
        assert!(spots <= 5, "{spots} spots for 3 corners: {steps:#?}");
        let speeds = steps.iter().filter_map(|step| if let Step::Walk { speed, .. } = step { *speed } else { None });
        assert_eq!(speeds.count(), 0, "the tour's own speed needs no telling");
    }
}

#[test]
fn ways_that_no_street_leads_are_followed_too() {
    let net = StreetNet::new(&grid_town(4, 50.0));
    // Across a block, round in a circle, back on the same way, and along the side of a street.
    let courses: [&[(f64, f64)]; 4] = [
        &[(25.0, 25.0), (40.0, 48.0), (60.0, 75.0), (100.0, 100.0)],
        &[(20.0, 0.0), (30.0, 10.0), (20.0, 20.0), (10.0, 10.0), (20.0, 0.0), (20.0, -10.0)],
        &[(0.0, 40.0), (0.0, 5.0), (0.0, 30.0)],
        &[(4.0, 10.0), (4.0, 140.0)],
    ];
    for net in [&net, &StreetNet::new(&[])] {
        for course in courses {
            let mut visitor = Visitor::new(course[0].0, course[0].1, 40.0, 30.0);
            for &(x, y) in &course[1..] {
                visitor.walk(x, y, 1.6);
            }
            follows(&visitor, net, &Gazetteer::default(), RECORDED_WALK_M);
        }
    }
}

#[test]
fn pauses_become_waits_and_turns_of_the_head_looks() {
    let net = StreetNet::new(&grid_town(4, 50.0));
    let mut visitor = Visitor::new(0.0, 5.0, 0.0, 30.0);
    visitor.walk(0.0, 40.0, 1.4);
    visitor.stand(2.0);
    visitor.turn(80.0, 20.0);
    visitor.stand(3.0);
    visitor.turn(-80.0, -20.0);
    visitor.walk(0.0, 70.0, 1.4);
    let (steps, compiled) = follows(&visitor, &net, &Gazetteer::default(), RECORDED_WALK_M);
    use StepKind as K;
    assert_eq!(kinds(&steps), [K::Start, K::Walk, K::Wait, K::Look, K::Wait, K::Look, K::Walk], "{steps:#?}");
    let Step::Look { at: LookAt::Heading { deg, pitch_deg }, .. } = steps[3] else { panic!("{:?}", steps[3]) };
    assert!(turn_deg(80.0, deg).abs() <= 3.0 && (pitch_deg - 20.0).abs() <= 3.0, "{deg} {pitch_deg}");
    let Step::Wait { seconds } = steps[4] else { panic!("{:?}", steps[4]) };
    assert!((seconds - 3.0).abs() < 0.4, "{seconds}");
    let span = compiled.steps().iter().find(|span| span.index == 4).expect("every step has its time");
    let pose = compiled.pose(f64::midpoint(span.start_s, span.end_s));
    assert!(turn_deg(80.0, pose.heading_deg).abs() < RECORDED_GAZE_DEG && (pose.pitch_deg - 20.0).abs() < RECORDED_GAZE_DEG);
}

#[test]
fn who_walks_past_something_and_looks_at_it_looks_at_that_spot() {
    let net = StreetNet::new(&grid_town(4, 50.0));
    let mut visitor = Visitor::new(0.0, 0.0, 0.0, 30.0);
    let tower = DVec3::new(25.0, 30.0, 12.0);
    for i in 0..900 {
        visitor.pose.plan_pos = DVec2::new(0.0, f64::from(i) * 0.05);
        let facing = Facing::along(tower - visitor.pose.at(), Facing::default());
        (visitor.pose.heading_deg, visitor.pose.pitch_deg) = (facing.heading, facing.pitch);
        visitor.frame();
    }
    let (steps, compiled) = follows(&visitor, &net, &Gazetteer::default(), RECORDED_WALK_M);
    assert_eq!(kinds(&steps), [StepKind::Start, StepKind::Walk], "{steps:#?}");
    let Step::Walk { look: LookAt::Spot { at: Where::At(x, y), height_m, .. }, .. } = steps[1] else { panic!("{steps:#?}") };
    assert!(DVec3::new(x, y, height_m).distance(tower) < 1.0, "{x} {y} {height_m}");
    for (_, pose) in visitor.passed.iter().step_by(30) {
        let along = |t: &f64| compiled.pose(*t).plan_pos.distance(pose.plan_pos);
        let times: Vec<f64> = (0..400).map(|i| compiled.duration_s() * f64::from(i) / 400.0).collect();
        let nearest = times.iter().min_by(|a, b| along(a).total_cmp(&along(b))).expect("there are moments");
        let seen = compiled.pose(*nearest);
        assert!(turn_deg(seen.heading_deg, pose.heading_deg).abs() <= RECORDED_GAZE_DEG, "{seen:?} {pose:?}");
    }
}

#[test]
fn a_flight_is_fitted_by_few_points() {
    let net = StreetNet::new(&grid_town(4, 50.0));
    let mut visitor = Visitor::new(0.0, 0.0, 0.0, 30.0);
    visitor.walk(0.0, 20.0, 1.4);
    visitor.go(0.0, 25.0, 12.0, 4.0);
    // Half a circle, rising, always looking along it.
    for i in 0..=600 {
        let angle = core::f64::consts::PI * f64::from(i) / 600.0;
        visitor.pose.plan_pos = DVec2::new(30.0 - 30.0 * angle.cos(), 25.0 + 30.0 * angle.sin());
        visitor.pose.eye_m = 12.0 + f64::from(i) / 60.0;
        visitor.pose.heading_deg = angle.to_degrees();
        visitor.frame();
    }
    visitor.go(60.0, 0.0, 1.65, 6.0);
    visitor.walk(100.0, 0.0, 1.4);
    let (steps, _) = follows(&visitor, &net, &Gazetteer::default(), RECORDED_WALK_M);
    let flown: Vec<&Step> = steps.iter().filter(|step| matches!(step, Step::Fly { .. })).collect();
    let points: usize = flown.iter().map(|step| if let Step::Fly { through, .. } = step { through.len() } else { 0 }).sum();
    assert!(flown.len() <= 5 && points <= 16, "{points} points in {} flights for {} samples", flown.len(), visitor.passed.len());
    // By itself, in space and closely.
    let start = visitor.passed.iter().position(|(_, pose)| pose.eye_m >= 12.0).expect("it flies");
    let mut flight = Visitor::new(0.0, 25.0, 0.0, 30.0);
    flight.passed = visitor.passed[start..start + 600].to_vec();
    flight.passed.iter().for_each(|(t_s, pose)| flight.recording.note(*t_s, pose));
    follows(&flight, &net, &Gazetteer::default(), RECORDED_FLIGHT_M);
}

#[test]
fn a_leap_is_a_cut_and_a_place_is_named_where_its_stand_is() {
    let net = StreetNet::new(&grid_town(4, 50.0));
    let stand = Viewpoint { pos: (100.0, 130.0).into(), ..Viewpoint::default() };
    let place = |name: &str, pos: DVec2, view| Place { name: name.into(), pos, view, ..Place::default() };
    let places =
        Gazetteer::new(&[place("Tower", (90.0, 140.0).into(), Some(stand)), place("Elsewhere", (100.0, 100.0).into(), None)]);
    let mut visitor = Visitor::new(0.0, 0.0, 90.0, 30.0);
    visitor.stand(1.0);
    visitor.pose.plan_pos = DVec2::new(100.0, 50.0);
    visitor.pose.fov_deg = 75.0;
    visitor.walk(100.0, 130.0, 2.2);
    let (steps, _) = follows(&visitor, &net, &places, RECORDED_WALK_M);
    use StepKind as K;
    assert_eq!(kinds(&steps).iter().filter(|kind| **kind == K::Cut).count(), 1, "{steps:#?}");
    assert!(steps.contains(&Step::Fov { deg: 75.0, seconds: 0.5 }), "{steps:#?}");
    let Some(Step::Walk { to, speed, .. }) = steps.last() else { panic!("{steps:#?}") };
    assert_eq!((to, *speed), (&Where::Place("Tower".into()), Some(2.2)));
}

#[test]
fn nothing_makes_it_panic_and_little_is_kept_of_a_long_stand() {
    let mut recording = Recording::default();
    assert!(recording.steps(&tour(), &StreetNet::new(&[]), &Gazetteer::default()).is_empty());
    let pose = Pose { eye_m: 1.65, fov_deg: 55.0, ..Pose::default() };
    for i in 0..100_000 {
        recording.note(f64::from(i) / 30.0, &pose);
    }
    recording.note(f64::NAN, &pose);
    recording.note(4_000.0, &Pose { eye_m: f64::INFINITY, ..pose });
    assert!(recording.samples.len() <= 2 && (recording.duration_s() - 3333.3).abs() < 1.0);
    let steps = recording.steps(&tour(), &StreetNet::new(&[]), &Gazetteer::default());
    assert_eq!(kinds(&steps), [StepKind::Start, StepKind::Wait]);
    let far = GridPos(i32::MAX, 0).to_metres();
    recording.note(3_400.0, &Pose { plan_pos: far, ..pose });
    assert_eq!(kinds(&recording.steps(&tour(), &StreetNet::new(&[]), &Gazetteer::default())).last(), Some(&StepKind::Cut));
}
