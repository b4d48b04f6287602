//! Arcades: houses whose style asks for them stand back behind a walk, and what hangs over it fits what stands below.

use std::collections::BTreeSet;

use glam::DVec2;
use veduta_city::{CityGraph, CityPlan, GridPolygon, Opening, Volume, WallKind, file, metres, ring_edges};
use veduta_growth::plan::{Stock, grow};

/// A block of a style between streets on all sides; the ground rises to the east.
fn plan(style: &str, seed: u64, slope_m: f64) -> CityPlan {
    let (near, far) = (120.0 * slope_m, 240.0 * slope_m);
    let text = format!(
        "(name: \"T\", anchor: (lat: 50, lon: 14), seed: {seed},
          terrain: Some((origin: (-40, -40), step_m: 120, rows_m: [[0, {near}, {far}], [0, {near}, {far}], [0, {near}, {far}]])),
          nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (110, 0)), (id: 3, pos: (110, 90)), (id: 4, pos: (0, 90))],
          links: [(from: 1, to: 2, kind: Street(Street), width_m: 12), (from: 2, to: 3, kind: Street(Lane), width_m: 8),
                  (from: 3, to: 4, kind: Street(Street), width_m: 12), (from: 4, to: 1, kind: Street(Lane), width_m: 8)],
          blocks: [(outline: [(4, 6), (106, 6), (106, 84), (4, 84)], district: \"{style}\")])"
    );
    let graph: CityGraph = file::parse(&text, "test").unwrap_or_else(|e| panic!("{e}"));
    grow(&graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}")).plan
}

/// Volumes that hang over walks, each with the ground floor below it.
fn arcaded(plan: &CityPlan) -> Vec<(&Volume, &Volume)> {
    let pairs = plan.houses.iter().flat_map(|house| {
        let above = house.volumes.iter().filter(|volume| !volume.arcades.is_empty());
        above.map(move |above| {
            let is_below = |volume: &&Volume| volume.eaves == above.bottom && volume.footprint != above.footprint;
            (above, house.volumes.iter().find(is_below).expect("it stands on a ground floor"))
        })
    });
    pairs.collect()
}

fn edge(polygon: &GridPolygon, i: usize) -> [DVec2; 2] {
    let (a, b) = polygon.edges().nth(i).expect("there is such an edge");
    [a.to_metres(), b.to_metres()]
}

#[test]
fn fronts_stand_back_behind_their_arches() {
    let (mut corners, mut whole) = (0, 0);
    for seed in 0..12 {
        let plan = plan("renaissance", seed, 0.0);
        let pairs = arcaded(&plan);
        assert!(pairs.len() * 2 > plan.houses.len(), "seed {seed}: {} of {}", pairs.len(), plan.houses.len());
        for (above, below) in pairs {
            let fronts: BTreeSet<u16> = above.arcades.iter().filter(|arcade| arcade.depth > 0).map(|arcade| arcade.wall).collect();
            corners += usize::from(fronts.len() > 1);
            whole += 1;
            assert_eq!(above.footprint.outer.len(), below.footprint.outer.len());
            assert!(below.bottom < below.eaves && above.bottom < above.eaves && !below.roof.is_there() && above.roof.is_there());
            for w in 0..above.walls.len() {
                let ([a, b], [c, d]) = (edge(&above.footprint, w), edge(&below.footprint, w));
                let back = (b - a).normalize().perp().dot((c + d) / 2.0 - a);
                assert!((d - c).dot(b - a) > 0.0, "the ground floor's outline runs as the one above");
                if fronts.contains(&(w as u16)) {
                    assert!((back - 3.6).abs() < 0.02, "{back} m");
                    assert_eq!(above.walls[w].kind, WallKind::Street);
                    assert_ne!(below.walls[w].storeys[0].opening, Opening::Arcade);
                } else {
                    // Beside a neighbour not the least slit is left.
                    assert!((-0.03..1e-9).contains(&back), "{back} m");
                }
                assert_eq!(below.walls[w].storeys.len().min(1), below.walls[w].storeys.len());
                let height: i32 = above.walls[w].storeys.iter().map(|storey| storey.height).sum();
                assert!(above.walls[w].storeys.is_empty() || height == above.eaves - above.bottom, "storeys fill the wall");
            }
            for wall in &fronts {
                let mut spans: Vec<(i32, i32)> = above.arcades.iter().filter(|a| a.wall == *wall).map(|a| a.span).collect();
                spans.sort_unstable();
                let [a, b] = edge(&above.footprint, (*wall).into());
                assert!(spans[0].0 == 0 && (metres(spans[spans.len() - 1].1) - a.distance(b)).abs() < 0.002, "{spans:?}");
                assert!(spans.windows(2).all(|pair| pair[0].1 == pair[1].0), "{spans:?}");
            }
            for arcade in &above.arcades {
                let (pitch, room) = (metres(arcade.span.1 - arcade.span.0) / f64::from(arcade.arches), above.bottom - arcade.floor);
                assert!((2.3..4.5).contains(&pitch) && metres(room) > 2.6, "{arcade:?}");
                // A kerb above the street's carriageway.
                assert!((0.0..=0.35).contains(&metres(arcade.floor)), "{arcade:?}");
            }
        }
    }
    assert!(whole > 150 && corners > 5, "{whole} arcaded houses, {corners} of them at corners");
}

#[test]
fn an_open_end_has_an_arch_of_its_own() {
    let text = "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 1, nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (80, 0))],
          links: [(from: 1, to: 2, kind: Street(Lane), width_m: 8)],
          buildings: [(id: 7, style: \"renaissance\", levels: 3, outline: [(30, 4), (48, 4), (50, 20), (30, 20)])])";
    let graph: CityGraph = file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"));
    let plan = grow(&graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}")).plan;
    let pairs = arcaded(&plan);
    let [(above, _)] = pairs[..] else { panic!("{} arcaded volumes", pairs.len()) };
    let front = above.arcades.iter().find(|arcade| arcade.depth > 0).expect("a walk along the street").wall;
    let n = above.footprint.outer.len() as u16;
    for (wall, from_start) in [((front + n - 1) % n, false), ((front + 1) % n, true)] {
        let ends: Vec<_> = above.arcades.iter().filter(|arcade| arcade.wall == wall).collect();
        let [a, b] = edge(&above.footprint, wall.into());
        let [end] = ends[..] else { panic!("{} arches at an end", ends.len()) };
        let (length, (from, to)) = (a.distance(b), (metres(end.span.0), metres(end.span.1)));
        assert!((end.arches, end.depth) == (1, 0) && (3.5..3.8).contains(&(to - from)), "{end:?}");
        assert!(if from_start { from == 0.0 } else { (to - length).abs() < 0.002 }, "{end:?}");
    }
}

#[test]
fn doors_and_shops_lie_behind_the_walk() {
    let plan = plan("renaissance", 3, 0.0);
    let (mut doors, mut shops) = (0, 0);
    for (above, below) in arcaded(&plan) {
        assert!(above.walls.iter().all(|wall| wall.ground_floor == Default::default()));
        doors += below.walls.iter().filter(|wall| wall.ground_floor.door_bay.is_some()).count();
        shops += below.walls.iter().filter(|wall| wall.ground_floor.shops != 0).count();
        let top = above.walls.iter().map(|wall| wall.storeys.len()).max().unwrap_or(0);
        for ornament in above.walls.iter().filter_map(|wall| wall.ornament.as_deref()) {
            assert!(ornament.oriel.is_none_or(|oriel| usize::from(oriel.storeys.1) < top && oriel.storeys.0 == 0));
        }
    }
    assert!(doors > 10 && shops > 0, "{doors} doors, {shops} fronts with shops");
}

#[test]
fn where_there_is_no_room_or_no_level_ground_arches_are_painted() {
    let steep = plan("renaissance", 3, 0.1);
    let painted = |plan: &CityPlan| {
        let walls = plan.houses.iter().flat_map(|house| house.volumes.iter().flat_map(|volume| &volume.walls));
        walls.filter(|wall| wall.storeys.first().is_some_and(|storey| storey.opening == Opening::Arcade)).count()
    };
    let arcaded_east_west = arcaded(&steep).len();
    assert!(arcaded_east_west < arcaded(&plan("renaissance", 3, 0.0)).len() && painted(&steep) > 5);
    assert!(arcaded(&plan("modern", 3, 0.0)).is_empty());
    for (above, below) in arcaded(&steep) {
        for arcade in &above.arcades {
            assert!((metres(arcade.floor) - metres(below.bottom)).abs() <= 0.36, "{arcade:?}");
        }
    }
}

#[test]
fn walks_of_a_row_join() {
    let plan = plan("renaissance", 5, 0.0);
    let below: Vec<&GridPolygon> = arcaded(&plan).iter().map(|(_, below)| &below.footprint).collect();
    // Ground floors that touch leave no slit between them: a corner of one lies on or in the other.
    let touching = below.iter().enumerate().flat_map(|(i, a)| below[i + 1..].iter().map(move |b| (a, b)));
    let mut joined = 0;
    for (a, b) in touching {
        let near = |p: DVec2| {
            ring_edges(&b.outer).any(|(c, d)| {
                distance(p, [c.to_metres(), d.to_metres()]) < 0.003 || b.contains(veduta_city::GridPos::from_metres(p))
            })
        };
        let on = a.outer.iter().filter(|p| near(p.to_metres())).count();
        joined += usize::from(on >= 2);
    }
    assert!(joined > 10, "{joined} pairs");
}

fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let way = b - a;
    let share = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    p.distance(a + way * share)
}
