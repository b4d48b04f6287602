//! What street fronts carry: as their style asks, within their own bays, above people's heads, and only where the street is broad.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{
    Articulation, BalconyPlaces, CityGraph, CityPlan, GridPos, House, Opening, Ornament, Parapet, Wall, WallKind, file, metres,
};
use veduta_growth::plan::{Stock, grow};

fn parsed(text: &str) -> CityGraph {
    file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
}

/// A block of a style on a street so broad.
fn block(style: &str, street_m: f64, seed: u64) -> CityGraph {
    let half = street_m / 2.0;
    parsed(&format!(
        "(name: \"T\", anchor: (lat: 50, lon: 14), seed: {seed},
          nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (300, 0))],
          links: [(from: 1, to: 2, kind: Street(Street), width_m: {street_m})],
          blocks: [(outline: [(5, {half}), (295, {half}), (295, 70), (5, 70)], district: \"{style}\"),
                   (outline: [(5, -70), (295, -70), (295, -{half}), (5, -{half})], district: \"{style}\")])"
    ))
}

fn grown(graph: &CityGraph) -> CityPlan {
    grow(graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}")).plan
}

fn fronts(plan: &CityPlan) -> impl Iterator<Item = (&House, &Wall, [DVec2; 2])> {
    let volumes = plan.houses.iter().flat_map(|house| house.volumes.iter().map(move |volume| (house, volume)));
    // Walls over arcades have no ground floor.
    volumes.filter(|(_, volume)| volume.arcades.is_empty()).flat_map(|(house, volume)| {
        let edges = volume.footprint.edges().map(|(a, b)| [a.to_metres(), b.to_metres()]);
        volume.walls.iter().zip(edges).map(move |(wall, edge)| (house, wall, edge))
    })
}

/// Whether a low storey lies over the ground floor of a wall of several.
fn has_mezzanine(wall: &Wall) -> bool {
    wall.storeys.len() > 3 && wall.storeys[1].opening == Opening::AtticWindow
}

#[test]
fn a_mezzanine_lies_under_the_main_storey() {
    let graph = block("tenement", 14.0, 6);
    let mut stock = Stock::new();
    let tenement = stock.styles.find("tenement").expect("stock");
    let mut counts = Vec::new();
    for share in [0.0, 0.25, 1.0] {
        stock.styles.0[tenement].mezzanines = share;
        let plan = grow(&graph, &stock).unwrap_or_else(|e| panic!("{e}")).plan;
        let high = fronts(&plan).filter(|(_, wall, _)| wall.kind == WallKind::Street && wall.bays > 0 && wall.storeys.len() > 3);
        let (with, without): (Vec<_>, Vec<_>) = high.partition(|(_, wall, _)| has_mezzanine(wall));
        for (house, wall, _) in &with {
            let [ground, mezzanine, main] = [0, 1, 2].map(|i| wall.storeys[i]);
            assert!(metres(mezzanine.height) >= 2.0 && mezzanine.height * 5 < main.height * 4, "{:?}", wall.storeys);
            assert!(mezzanine.height < ground.height, "{:?}", wall.storeys);
            assert!(stock.styles.0[tenement].main_windows.contains(&main.opening), "{}: {:?}", house.id, wall.storeys);
        }
        counts.push((with.len(), without.len()));
    }
    let [(none, all), (some, rest), (whole, left)] = counts[..] else { panic!("three shares") };
    assert!(none == 0 && all > 20 && left == 0 && whole == all && some + rest == all, "{counts:?}");
    assert!(some > 0 && some < rest, "{counts:?}");
}

#[test]
fn ornaments_fit_their_walls() {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for style in ["old_town", "medieval", "renaissance", "baroque", "classicist", "tenement", "art_nouveau", "modern"] {
        let plan = grown(&block(style, 14.0, 4));
        assert!(plan.houses.len() > 20, "{style}: {} houses", plan.houses.len());
        for (_, wall, [a, b]) in fronts(&plan) {
            let Some(&ornament) = wall.ornament.as_deref() else { continue };
            assert_eq!(wall.kind, WallKind::Street);
            let Ornament { articulation, oriel, balconies, niche } = ornament;
            let has_door = wall.ground_floor.door_bay.is_some();
            assert!(has_door || (oriel, balconies, niche) == (None, None, None), "what stands out is on the door's front");
            let is_high = metres(wall.storeys[0].height) >= 3.0;
            let bay_m = a.distance(b) / f64::from(wall.bays);
            let storeys = wall.storeys.len() as u8;
            let first = 1 + u8::from(has_mezzanine(wall));
            *seen
                .entry(match articulation {
                    Articulation::Plain => "plain",
                    Articulation::Quoins => "quoins",
                    Articulation::Pilasters => "pilasters",
                })
                .or_default() += 1;
            if let Some(oriel) = oriel {
                *seen.entry("oriel").or_default() += 1;
                assert!(is_high && oriel.bay > 0 && oriel.bay + 1 < wall.bays && bay_m >= 2.0, "{oriel:?}");
                assert!(oriel.storeys.0 == first && oriel.storeys.1 >= first && oriel.storeys.1 + 1 < storeys, "{oriel:?}");
                assert!(balconies.is_none());
            }
            if let Some(balconies) = balconies {
                *seen
                    .entry(match balconies.parapet {
                        Parapet::Balusters => "balusters",
                        Parapet::Iron => "iron",
                        Parapet::Panels => "panels",
                    })
                    .or_default() += 1;
                assert!(is_high && balconies.runs().all(|(_, last)| last < wall.bays) && balconies.bays > 0, "{balconies:?}");
                assert!(balconies.storeys.0 == first && balconies.storeys.1 < storeys, "{balconies:?}");
            }
            if let Some(niche) = niche {
                *seen.entry("niche").or_default() += 1;
                let is_taken =
                    |bay: u8| oriel.is_some_and(|oriel| oriel.bay == bay) || balconies.is_some_and(|b| b.bays >> bay & 1 == 1);
                assert_ne!(articulation, Articulation::Pilasters);
                assert!(niche.bay > 0 && niche.bay < wall.bays && !is_taken(niche.bay) && !is_taken(niche.bay - 1), "{niche:?}");
            }
        }
    }
    for what in ["quoins", "pilasters", "oriel", "balusters", "iron", "panels", "niche"] {
        assert!(seen.get(what).is_some_and(|&n| n > 2), "{what}: {seen:?}");
    }
}

/// Whether something stands out of a wall.
fn stands_out(wall: &Wall) -> bool {
    wall.ornament.as_deref().is_some_and(|ornament| ornament.oriel.is_some() || ornament.balconies.is_some())
}

#[test]
fn nothing_stands_out_over_a_narrow_lane() {
    let count = |street_m| {
        let plan = grown(&block("art_nouveau", street_m, 9));
        for (_, wall, [a, b]) in fronts(&plan).filter(|(_, wall, _)| stands_out(wall)) {
            let out = -(b - a).normalize().perp();
            let before = GridPos::from_metres((a + b) / 2.0 + out * 4.5);
            let is_in = |house: &House| house.volumes.iter().any(|volume| volume.footprint.contains(before));
            assert!(!plan.houses.iter().any(is_in), "{wall:?}");
        }
        let doors = fronts(&plan).filter(|(_, wall, _)| wall.kind == WallKind::Street && wall.ground_floor.door_bay.is_some());
        assert!(doors.count() > 20, "there are fronts");
        fronts(&plan).filter(|(_, wall, _)| stands_out(wall)).count()
    };
    assert!(count(14.0) > 10);
    assert_eq!(count(4.0), 0);
}

#[test]
fn a_style_says_what_its_houses_carry() {
    let graph = block("old_town", 14.0, 2);
    let mut stock = Stock::new();
    let old = stock.styles.find("old_town").expect("stock");
    let of = |stock: &Stock| {
        let plan = grow(&graph, stock).unwrap_or_else(|e| panic!("{e}")).plan;
        let is_front = |wall: &Wall, [a, b]: [DVec2; 2]| wall.kind == WallKind::Street && wall.bays > 1 && a.distance(b) > 5.0;
        let all = fronts(&plan).filter(|&(_, wall, edge)| is_front(wall, edge));
        all.map(|(_, wall, _)| wall.ornament.as_deref().copied().unwrap_or_default()).collect::<Vec<Ornament>>()
    };
    let style = &mut stock.styles.0[old];
    (style.articulation, style.balconies) = (vec![Articulation::Plain], vec![BalconyPlaces::Nowhere]);
    (style.oriels, style.niches) = (0.0, 0.0);
    let all = of(&stock);
    assert!(all.len() > 20 && all.iter().all(|&ornament| ornament == Ornament::default()), "{}", all.len());
    stock.styles.0[old].articulation = vec![Articulation::Quoins];
    let all = of(&stock);
    assert!(all.iter().all(|ornament| ornament.articulation == Articulation::Quoins), "{all:?}");
    stock.styles.0[old].oriels = 1.0;
    let oriels = of(&stock).iter().filter(|ornament| ornament.oriel.is_some()).count();
    assert!(oriels > all.len() / 3, "{oriels} of {}", all.len());
}
