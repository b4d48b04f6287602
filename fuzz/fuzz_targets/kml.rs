#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::{Anchor, PlanTerrain, TourText};
use veduta_route::{
    Gazetteer, StreetNet, compile,
    kml::{KmlCity, from_kml, to_kml},
};

fuzz_target!(|bytes: &[u8]| {
    let terrain = PlanTerrain::default();
    let anchor = Anchor { lat: 50.087, lon: 14.421 };
    let city = KmlCity { name: "x.city", anchor, zero_m: None, terrain: &terrain, reach_m: 50_000.0 };
    let Ok((tour, _)) = from_kml(bytes, "fuzz.kml", city) else { return };
    let text = TourText::new(&tour).expect("what is read can be written");
    assert_eq!(*text.tour(), tour);
    // Too many steps, or too long, it may be.
    let Ok(played) = compile(&tour, &StreetNet::new(&[]), &Gazetteer::default()) else { return };
    if played.duration_s() < 60.0 {
        let (kml, _) = to_kml(&played, anchor, "en");
        from_kml(kml.as_bytes(), "again.kml", city).expect("what is written can be read");
    }
});
