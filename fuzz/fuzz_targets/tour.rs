#![no_main]

use glam::DVec2;
use libfuzzer_sys::fuzz_target;
use veduta_city::{GridPos, Id, Place, PlanStreet, Tour, file};
use veduta_route::{Gazetteer, StreetNet, compile};

/// Two streets that cross, and two places.
fn town() -> (StreetNet, Gazetteer) {
    let street = |id: u64, line: [(f64, f64); 3]| PlanStreet {
        id: Id(id),
        name: "Celetná".to_owned(),
        line: line.map(|p| GridPos::from_metres(p.into())).to_vec(),
        width: 6 * 1024,
        walkable: true,
        ..PlanStreet::default()
    };
    let streets = [street(1, [(0.0, 0.0), (80.0, 0.0), (160.0, 9.0)]), street(2, [(80.0, -60.0), (80.0, 0.0), (75.0, 60.0)])];
    let place = |name: &str, x: f64, y: f64| Place { name: name.to_owned(), pos: DVec2::new(x, y), ..Place::default() };
    (StreetNet::new(&streets), Gazetteer::new(&[place("Well", 80.0, 3.0), place("Gate", 150.0, 9.0)]))
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(tour) = file::parse_bytes::<Tour>(bytes, "fuzz") else { return };
    let (net, places) = town();
    let Ok(played) = compile(&tour, &net, &places) else { return };
    let end = played.duration_s();
    assert!(end.is_finite() && end >= 0.0);
    for i in 0..=20 {
        let pose = played.pose(end * f64::from(i) / 20.0);
        assert!(pose.plan_pos.is_finite() && pose.eye_m.is_finite() && pose.pitch_deg.abs() <= 90.0);
        assert!((0.0..360.0).contains(&pose.heading_deg));
    }
});
