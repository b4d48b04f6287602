//! What holds of every layout, whatever is to be named.

use glam::DVec2;
use proptest::prelude::*;
use veduta_cartography::{Area, Course, Frame, Layers, Layout, Letters, Named, Setting, StreetLine, lay_out};
use veduta_city::{GridPos, Id, Overview, Place, PlaceKind, PlanStreet, StreetClass};

const NAMES: [&str; 6] = ["Celetná", "Dlouhá", "U Obecního domu", "Nám. Franze Kafky", "Žatecká", "Na Příkopě"];

fn street(n: usize, corners: &[(f64, f64)]) -> PlanStreet {
    let line = corners.iter().map(|&p| GridPos::from_metres(p.into())).collect();
    PlanStreet {
        id: Id(n as u64 + 1),
        name: format!("{} {}", NAMES[n % NAMES.len()], n / NAMES.len()),
        line,
        width: (4 + n as i32 % 9) * 1024,
        walkable: true,
        class: StreetClass::ALL[n % 7],
        ..PlanStreet::default()
    }
}

fn place(n: usize, (x, y): (f64, f64)) -> Place {
    const KINDS: [PlaceKind; 4] = [PlaceKind::Square, PlaceKind::Monument, PlaceKind::House, PlaceKind::Viewpoint];
    let name = format!("{} {n}", NAMES[n % NAMES.len()]);
    Place { id: Id(n as u64), name, kind: KINDS[n % 4], pos: DVec2::new(x, y), ..Place::default() }
}

fn named(streets: &[Vec<(f64, f64)>], places: &[(f64, f64)]) -> Named {
    let overview = Overview {
        streets: streets.iter().enumerate().map(|(n, corners)| street(n, corners)).collect(),
        places: places.iter().enumerate().map(|(n, &at)| place(n, at)).collect(),
        ..Overview::default()
    };
    Named::of([&overview], &str::to_owned).shown(&Layers::ALL)
}

fn laid_out(named: &Named, frame: Frame, bounds: Area, before: Option<&Layout>) -> Layout {
    let letters = Letters::new().expect("the font is part of the program");
    let advance = |letter: char| letters.advance(letter);
    lay_out(
        &named.wanted(),
        &Setting { frame, bounds, em: 2.1, repeat: 60.0, taken: &[], advance: &advance, before: before.map(Layout::stood) },
    )
}

/// How far a place lies from a line.
fn away(line: &[DVec2], p: DVec2) -> f64 {
    let from = |w: &[DVec2]| {
        let d = w[1] - w[0];
        let share = if d.length_squared() > 0.0 { ((p - w[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
        (w[0] + d * share).distance(p)
    };
    line.windows(2).map(from).fold(f64::INFINITY, f64::min)
}

fn corners() -> impl Strategy<Value = Vec<(f64, f64)>> {
    proptest::collection::vec((-400.0..400.0f64, -300.0..300.0f64), 2..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn names_never_overlap_nor_leave_the_map_nor_their_streets(
        streets in proptest::collection::vec(corners(), 0..24),
        places in proptest::collection::vec((-400.0..400.0f64, -300.0..300.0f64), 0..24),
        scale in 0.05..0.8f64, up_deg in 0.0..360.0f64,
    ) {
        let named = named(&streets, &places);
        let bounds = Area::new(DVec2::ZERO, DVec2::new(300.0, 200.0));
        let frame = Frame::new(DVec2::ZERO, bounds.middle(), scale, up_deg);
        let layout = laid_out(&named, frame, bounds, None);
        let slabs: Vec<(usize, _)> =
            layout.names.iter().enumerate().flat_map(|(n, name)| name.slabs.iter().map(move |slab| (n, *slab))).collect();
        for (i, (a, slab)) in slabs.iter().enumerate() {
            prop_assert!(slab.is_within(&bounds), "{} leaves the map", layout.names[*a].text);
            for (b, other) in &slabs[..i] {
                let (one, two) = (&layout.names[*a].text, &layout.names[*b].text);
                prop_assert!(a == b || !slab.meets(other), "{one} lies over {two}");
            }
        }
        for name in &layout.names {
            let Course::Along(line) = &name.course else { continue };
            let of_name = |street: &&StreetLine| street.name == name.text;
            let near = |street: &StreetLine| {
                let drawn: Vec<DVec2> = street.line.iter().map(|&p| frame.project(p)).collect();
                // Rounded corners stay within the street.
                let most = street.half_width_m * scale * 0.8 + 1e-6;
                line.iter().all(|&p| away(&drawn, p) <= most)
            };
            prop_assert!(named.streets.iter().filter(of_name).any(near), "{} stands beside its street", name.text);
            let reads = line[line.len() - 1] - line[0];
            prop_assert!(reads.x >= -0.09 * reads.y.abs(), "{} stands on its head", name.text);
        }
        prop_assert_eq!(&laid_out(&named, frame, bounds, None), &layout, "the same again");
        // Asked again for the same view, it stays as it is.
        let again = laid_out(&named, frame, bounds, Some(&layout));
        let count = |of: &Layout| of.names.len();
        prop_assert!(count(&again) * 10 >= count(&layout) * 9, "{} names of {}", count(&again), count(&layout));
    }
}

#[test]
fn names_are_repeated_on_long_streets_and_left_out_on_short_ones() {
    let lines = [vec![(-390.0, 0.0), (390.0, 10.0)], vec![(0.0, 100.0), (12.0, 100.0)]];
    let named = named(&lines, &[]);
    let bounds = Area::new(DVec2::ZERO, DVec2::new(400.0, 200.0));
    let layout = laid_out(&named, Frame::new(DVec2::ZERO, bounds.middle(), 0.4, 0.0), bounds, None);
    let texts: Vec<&str> = layout.names.iter().map(|name| name.text.as_str()).collect();
    assert!(texts.len() >= 4 && texts.iter().all(|text| *text == "Celetná 0"), "{texts:?}");
}

#[test]
fn names_stay_where_they_stood_while_the_map_is_zoomed() {
    let lines = [vec![(-300.0, -20.0), (-50.0, 0.0), (300.0, 60.0)], vec![(20.0, -250.0), (30.0, 250.0)]];
    let named = named(&lines, &[(-100.0, 100.0), (120.0, -90.0)]);
    let bounds = Area::new(DVec2::ZERO, DVec2::new(300.0, 200.0));
    let frame = |scale: f64| Frame::new(DVec2::ZERO, bounds.middle(), scale, 0.0);
    let mut last = laid_out(&named, frame(0.3), bounds, None);
    let middles = |layout: &Layout, frame: Frame| -> Vec<(String, DVec2)> {
        let middle = |name: &veduta_cartography::Name| frame.plan(name.slabs[name.slabs.len() / 2].middle);
        layout.names.iter().map(|name| (name.text.clone(), middle(name))).collect()
    };
    assert!(last.names.len() >= 3, "{:?}", middles(&last, frame(0.3)));
    for n in 1..=10 {
        let (before, now) = (frame(0.3 + f64::from(n - 1) * 0.01), frame(0.3 + f64::from(n) * 0.01));
        let next = laid_out(&named, now, bounds, Some(&last));
        for (text, at) in middles(&last, before) {
            let moved = middles(&next, now).into_iter().filter(|(t, _)| *t == text).map(|(_, p)| p.distance(at));
            let moved = moved.fold(f64::INFINITY, f64::min);
            assert!(moved < 12.0, "step {n}: {text} moved by {moved:.1} m");
        }
        last = next;
    }
}
