//! The sample tours: no camera enters a wall, walked stretches keep a walking pace.

use veduta_city::{GridPos, Tour, file, metres};
use veduta_route::{CompiledTour, Gazetteer, StreetNet, compile};
use veduta_tests::{sample_plan, scene};

const TOURS: [&str; 3] = ["royal_route", "royal_route_long", "to_the_clock"];

fn compiled(name: &str) -> CompiledTour {
    let plan = sample_plan();
    let tour: Tour = file::read(&scene().join(format!("{name}.tour.ron"))).unwrap_or_else(|e| panic!("{e}"));
    compile(&tour, &StreetNet::new(&plan.streets), &Gazetteer::new(&plan.places)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn no_eye_enters_a_wall_in_any_frame() {
    let plan = sample_plan();
    for name in TOURS {
        let tour = compiled(name);
        let frames = (tour.duration_s() * 24.0) as u32;
        assert!(frames > 24 * 30, "{name} lasts {} s", tour.duration_s());
        for frame in 0..frames {
            let pose = tour.pose(f64::from(frame) / 24.0);
            let at = GridPos::from_metres(pose.plan_pos);
            let inside = plan.houses.iter().find(|house| {
                house.volumes.iter().any(|v| {
                    // Half a metre of air all round: the near plane must not cut a wall either.
                    let near = |dx: f64, dy: f64| v.footprint.contains(at + GridPos(GridPos::steps(dx), GridPos::steps(dy)));
                    let beside = near(0.0, 0.0) || near(0.5, 0.0) || near(-0.5, 0.0) || near(0.0, 0.5) || near(0.0, -0.5);
                    beside && pose.eye_m > metres(v.bottom) - 0.3 && pose.eye_m < metres(v.top()) + 0.5
                })
            });
            if let Some(house) = inside {
                panic!("{name}, frame {frame}: the eye at {:?}, {:.1} m up, is in house {}", pose.plan_pos, pose.eye_m, house.id);
            }
        }
    }
}

#[test]
fn walked_stretches_keep_to_two_metres_a_second() {
    for name in TOURS {
        let tour = compiled(name);
        for span in tour.steps().iter().filter(|span| span.is_walk) {
            let mut t = span.start_s;
            while t + 0.1 < span.end_s {
                let speed = tour.pose(t).plan_pos.distance(tour.pose(t + 0.1).plan_pos) / 0.1;
                assert!(speed <= 2.02, "{name}, second {t:.1}: {speed:.2} m/s");
                t += 0.1;
            }
        }
    }
}

#[test]
fn the_royal_route_takes_two_minutes() {
    let seconds = compiled("royal_route").duration_s();
    assert!((110.0..135.0).contains(&seconds), "{seconds:.1} s");
}
