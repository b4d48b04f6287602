//! The tours of the sample city, played on the streets that are grown from it: what a visitor would notice.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use glam::{DVec2, DVec3, swizzles::Vec3Swizzles};
use veduta_bake::{BakeSettings, Input, cut, plan};
use veduta_cells::Contents;
use veduta_city::{CityPlan, GridPos, Overview, TourText, file, metres};
use veduta_growth::mesh::collision;
use veduta_route::{
    CompiledTour, Gazetteer, Pose, StreetNet, TURN_DEG_S, compile,
    kml::{KmlCity, from_kml, to_kml},
    turn_deg,
};

const SCENE: &str = "../../scenes/old_prague";

struct Played {
    name: String,
    tour: CompiledTour,
}

struct Sample {
    plan: CityPlan,
    net: StreetNet,
    places: Gazetteer,
    tours: Vec<Played>,
}

/// The sample city with its tours, grown once.
fn sample() -> &'static Sample {
    static SAMPLE: OnceLock<Sample> = OnceLock::new();
    SAMPLE.get_or_init(|| {
        let input = Input::of(Path::new(SCENE)).unwrap_or_else(|e| panic!("{e}"));
        let plan = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
        let net = StreetNet::new(&Overview::of(&plan).streets).on(&plan.terrain);
        let places = Gazetteer::new(&plan.places);
        let paths = std::fs::read_dir(SCENE).expect("the scene is a folder").map(|entry| entry.expect("it can be read").path());
        let mut paths: Vec<PathBuf> = paths.filter(|path| path.to_string_lossy().ends_with(".tour.ron")).collect();
        paths.sort();
        let play = |path: PathBuf| {
            let text = TourText::read(&path).unwrap_or_else(|e| panic!("{e}"));
            let name = path.display().to_string();
            let tour = compile(text.tour(), &net, &places).unwrap_or_else(|e| panic!("{name}: {e}"));
            Played { name, tour }
        };
        let tours = paths.into_iter().map(play).collect();
        Sample { plan, net, places, tours }
    })
}

fn at(pose: &Pose) -> DVec3 {
    pose.plan_pos.extend(pose.eye_m)
}

/// Moments of a tour at a rate, and its last.
fn moments(tour: &CompiledTour, hz: f64) -> impl Iterator<Item = f64> {
    let many = (tour.duration_s() * hz) as u32;
    (0..=many).map(move |i| f64::from(i) / hz).chain([tour.duration_s()])
}

#[test]
fn every_tour_of_the_sample_city_can_be_played() {
    let tours = &sample().tours;
    for Played { name, tour } in tours {
        println!("{name}: {:.1} s", tour.duration_s());
        assert!(tour.duration_s() > 20.0, "{name}: over before it begins");
    }
    assert!(tours.len() >= 3, "{} tours are beside the city", tours.len());
}

/// Walkers gain 3 m/s² at most along their way and across it; flights 5 along, if gently, and 6 across, as `veduta-route` says.
const WALK_GAIN_M_S2: f64 = 4.3;
const FLY_GAIN_M_S2: f64 = 8.0;
/// Twice the greatest angular speed within the half second of an average, degrees/s².
const TURN_GAIN_DEG_S2: f64 = 250.0;

#[test]
fn no_tour_jumps_in_speed_or_turn() {
    const HZ: f64 = 240.0;
    for Played { name, tour } in &sample().tours {
        let mut poses: Vec<Pose> = Vec::new();
        let mut greatest = [0.0_f64; 5];
        for i in 0..=(tour.duration_s() * HZ) as u32 + 20 {
            let t = f64::from(i) / HZ;
            let now = tour.pose(t);
            // A cut is where it is dark.
            if now.fade >= 1.0 {
                poses.clear();
            }
            poses.push(now);
            let [.., a, b, c] = &poses[..] else { continue };
            let gain = (at(c) - 2.0 * at(b) + at(a)).length() * HZ * HZ;
            let is_walk = tour.steps().iter().any(|step| step.is_walk && (step.start_s - 0.01..step.end_s + 0.01).contains(&t));
            let turn = |a: &Pose, b: &Pose| DVec2::new(turn_deg(a.heading_deg, b.heading_deg), b.pitch_deg - a.pitch_deg) * HZ;
            let (before, after) = (turn(a, b), turn(b, c));
            let turning = after.abs().max_element();
            let turn_gain = ((after - before) * HZ).abs().max_element();
            assert!(turning <= TURN_DEG_S * 1.001, "{name}: at {t:.3} s it turns at {turning}°/s");
            assert!(turn_gain <= TURN_GAIN_DEG_S2, "{name}: at {t:.3} s the turn changes by {turn_gain}°/s²");
            let most = if is_walk { WALK_GAIN_M_S2 } else { FLY_GAIN_M_S2 };
            assert!(gain <= most, "{name}: at {t:.3} s an acceleration of {gain} m/s², walking: {is_walk}");
            let speed = (at(c) - at(b)).length() * HZ;
            let walked = if is_walk { gain } else { 0.0 };
            for (greatest, one) in greatest.iter_mut().zip([speed, gain, walked, turning, turn_gain]) {
                *greatest = greatest.max(one);
            }
        }
        let [speed, gain, walked, turning, turn_gain] = greatest;
        println!("{name}: {speed:.1} m/s, {gain:.1} m/s² ({walked:.1} walking), {turning:.1}°/s, {turn_gain:.0}°/s²");
    }
}

#[test]
fn a_tour_is_the_same_at_any_frame_rate() {
    for Played { name, tour } in &sample().tours {
        // As a player counts: frame by frame, with the error that adds up.
        let stepped = |hz: u32| {
            let (mut t, mut poses) = (0.0, Vec::new());
            for frame in 0..(tour.duration_s() * f64::from(hz)) as u32 {
                if frame % (hz / 6) == 0 {
                    poses.push(tour.pose(t));
                }
                t += 1.0 / f64::from(hz);
            }
            poses
        };
        let (slow, fast) = (stepped(30), stepped(144));
        assert!(slow.len().abs_diff(fast.len()) <= 1 && slow.len() > 100);
        for (a, b) in slow.iter().zip(&fast) {
            assert!(at(a).distance(at(b)) < 1e-3, "{name}: {a:?} and {b:?}");
            assert!(turn_deg(a.heading_deg, b.heading_deg).abs().max((a.pitch_deg - b.pitch_deg).abs()) < 1e-3, "{name}");
        }
    }
}

/// Upright faces of the city, by squares of the plan.
struct Walls {
    segments: Vec<(DVec2, DVec2, f64, f64)>,
    by_square: BTreeMap<(i32, i32), Vec<usize>>,
}

const SQUARE_M: f64 = 8.0;

impl Walls {
    /// All that a walker is stopped by.
    fn of(plan: &CityPlan) -> Self {
        let (cells, _) = cut(plan, &[], &BakeSettings::default());
        let contents = Contents::new(plan, &cells);
        let mut walls = Self { segments: Vec::new(), by_square: BTreeMap::new() };
        for cell in 0..cells.cells.len() {
            let shell = contents.shell(cell);
            let origin = shell.origin.to_metres();
            let faces = collision(&shell).walls;
            for triangle in &faces.triangles {
                // Corners are the engine's: y up, z south.
                let corners = triangle.map(|i| DVec3::from_array(faces.positions[i as usize].map(f64::from)));
                let plan_pos = |corner: DVec3| origin + DVec2::new(corner.x, -corner.z);
                let (low, high) = corners.iter().fold((f64::MAX, f64::MIN), |(low, high), c| (low.min(c.y), high.max(c.y)));
                let ends = [plan_pos(corners[0]), plan_pos(corners[1]), plan_pos(corners[2])];
                let (a, b) = if ends[0].distance(ends[1]) > 1e-3 { (ends[0], ends[1]) } else { (ends[0], ends[2]) };
                walls.add((a, b, low, high));
            }
        }
        walls
    }

    fn add(&mut self, segment: (DVec2, DVec2, f64, f64)) {
        let square = |p: DVec2| ((p.x / SQUARE_M).floor() as i32, (p.y / SQUARE_M).floor() as i32);
        let (least, most) = (square(segment.0.min(segment.1) - 1.0), square(segment.0.max(segment.1) + 1.0));
        for x in least.0..=most.0 {
            for y in least.1..=most.1 {
                self.by_square.entry((x, y)).or_default().push(self.segments.len());
            }
        }
        self.segments.push(segment);
    }

    /// Distance of the nearest face at a height, if it is less than a metre.
    fn nearest_m(&self, eye: DVec3) -> f64 {
        let square = ((eye.x / SQUARE_M).floor() as i32, (eye.y / SQUARE_M).floor() as i32);
        let near = self.by_square.get(&square).map(|near| &near[..]).unwrap_or_default();
        let faces = near.iter().map(|&i| self.segments[i]).filter(|(.., low, high)| (*low..=*high).contains(&eye.z));
        faces.map(|(a, b, ..)| off(eye.xy(), a, b)).fold(1.0, f64::min)
    }
}

/// Distance of a point from a segment.
fn off(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + along * share)
}

#[test]
fn no_tour_enters_a_wall_or_the_ground() {
    const OFF_M: f64 = 0.3;
    let sample = sample();
    let walls = Walls::of(&sample.plan);
    assert!(walls.segments.len() > 5_000, "{} faces", walls.segments.len());
    // The measure itself: from the middle of a wall, none is farther than the wall.
    let (a, b, low, high) = walls.segments[walls.segments.len() / 2];
    assert!(walls.nearest_m(((a + b) / 2.0).extend((low + high) / 2.0)) < 1e-6);
    // And they are where the houses are: of a house's edges, many stand free.
    let volumes = sample.plan.houses.iter().flat_map(|house| &house.volumes);
    let edges: Vec<_> = volumes.flat_map(|volume| volume.footprint.edges()).map(|(a, b)| (a.to_metres(), b.to_metres())).collect();
    let eye = |(a, b): &(DVec2, DVec2)| ((*a + *b) / 2.0).extend(sample.plan.terrain.height_m((*a + *b) / 2.0) + 1.65);
    let free = edges.iter().filter(|edge| walls.nearest_m(eye(edge)) < 0.02).count();
    assert!(4 * free > edges.len(), "{free} of {} edges of houses have a wall", edges.len());
    for Played { name, tour } in &sample.tours {
        let mut nearest = (f64::MAX, 0.0);
        for t in moments(tour, 30.0) {
            let pose = tour.pose(t);
            let ground = sample.plan.terrain.height_m(pose.plan_pos);
            let eye = at(&pose) + DVec3::Z * ground;
            assert!(pose.eye_m >= 0.2, "{name}: at {t:.1} s in the ground: {pose:?}");
            let wall_m = walls.nearest_m(eye);
            assert!(wall_m >= OFF_M, "{name}: at {t:.1} s {wall_m:.2} m from a wall: {pose:?}");
            nearest = if wall_m < nearest.0 { (wall_m, t) } else { nearest };
            if pose.eye_m > 3.0 {
                let p = GridPos::from_metres(pose.plan_pos);
                let bodies = sample.plan.houses.iter().flat_map(|house| house.volumes.iter().map(move |volume| (house, volume)));
                for (house, volume) in bodies.filter(|(_, volume)| volume.footprint.contains(p)) {
                    let (low, high) = (metres(volume.bottom), metres(volume.top()));
                    assert!(!(low..high).contains(&eye.z), "{name}: at {t:.1} s within “{}” {}: {pose:?}", house.name, house.id);
                }
            }
        }
        println!("{name}: {:.2} m from a wall at {:.1} s", nearest.0, nearest.1);
    }
}

#[test]
fn a_tour_that_went_out_as_kml_comes_in_the_same() {
    let sample = sample();
    let city = KmlCity {
        name: "old_prague.graph.ron",
        anchor: sample.plan.anchor,
        zero_m: None,
        terrain: &sample.plan.terrain,
        reach_m: 20_000.0,
    };
    for Played { name, tour } in &sample.tours {
        let (kml, _) = to_kml(tour, sample.plan.anchor, "en");
        let (read, findings) = from_kml(kml.as_bytes(), "x.kml", city).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(findings, [], "{name}");
        // As a file is: written, and read again.
        let text = TourText::new(&read).unwrap_or_else(|e| panic!("{name}: {e}"));
        let read = file::parse(text.text(), "x.tour.ron").unwrap_or_else(|e| panic!("{name}: {e}"));
        let again = compile(&read, &sample.net, &sample.places).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut worst = [0.0_f64; 3];
        for t in moments(tour, 120.0) {
            let (a, b) = (tour.pose(t), again.pose(t));
            let turned = turn_deg(a.heading_deg, b.heading_deg).abs().max((a.pitch_deg - b.pitch_deg).abs());
            let off = [at(&a).distance(at(&b)), turned, (a.fov_deg - b.fov_deg).abs()];
            assert!(off[0] < 0.1 && off[1] < 0.5 && off[2] < 0.5, "{name}: at {t:.2} s {off:?}\n{a:?}\n{b:?}");
            worst = core::array::from_fn(|i| worst[i].max(off[i]));
        }
        // KML's seconds are rounded: a caption may come and go a hundredth of a second off.
        let goes_on = |&t: &f64| tour.caption(t - 0.01) == tour.caption(t + 0.01);
        for t in moments(tour, 5.0).map(|t| t + 0.05).filter(goes_on) {
            assert_eq!(
                (tour.caption(t), tour.caption_in(t, "cs")),
                (again.caption(t), again.caption_in(t, "cs")),
                "{name}: at {t}"
            );
        }
        println!(
            "{name}: {} bytes, {:.3} m, {:.2}°, {:.2}° of field at most; {:.1} and {:.1} s",
            kml.len(),
            worst[0],
            worst[1],
            worst[2],
            tour.duration_s(),
            again.duration_s()
        );
    }
}

#[test]
fn the_program_takes_a_tour_out_and_in_again() {
    let folder = std::env::temp_dir().join(format!("veduta-tour-kml-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("room");
    let run = |arguments: &[&Path]| {
        let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).args(arguments).output().expect("the program runs");
        (out.status.code(), format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr)))
    };
    let [tour, import, export, check, to] = ["tour", "import", "export", "check", "-o"].map(Path::new);
    let (kml, read) = (folder.join("clock.kml"), folder.join("clock.tour.ron"));
    let clock = Path::new(SCENE).join("to_the_clock.tour.ron");
    let (code, told) = run(&[tour, export, &clock, to, &kml]);
    assert!(code == Some(0) && told.contains("“To the clock”, 64 s"), "{told}");
    let (code, told) = run(&[tour, import, &kml, Path::new(SCENE), to, &read]);
    assert!(code == Some(0) && told.contains("“To the clock”"), "{told}");
    let (code, told) = run(&[check, &read]);
    assert!(code == Some(0) && told.contains("64 s"), "{told}");

    std::fs::write(&kml, b"PK\x03\x04...").expect("room");
    let (code, told) = run(&[tour, import, &kml, Path::new(SCENE), to, &read]);
    assert!(code == Some(1) && told.contains("clock.kml:1:1") && told.contains("unpack it"), "{told}");
    let alone = folder.join("alone.tour.ron");
    std::fs::copy(&clock, &alone).expect("room");
    let (code, told) = run(&[tour, export, &alone, to, &kml]);
    assert!(code == Some(1) && told.contains("alone.tour.ron:4:3: its city `old_prague.graph.ron` is not here"), "{told}");
    let _ = std::fs::remove_dir_all(folder);
}
