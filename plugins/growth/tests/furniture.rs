//! Furniture stands by rule: in no doorway, house or carriageway, and clear of other furniture.

mod synthetic;

use glam::DVec2;
use veduta_city::{BlockKind, CityGraph, CityPlan, FurnitureRule, Id, Link, LinkKind, ObjectKind, PlanObject, SurfaceKind, file};
use veduta_growth::plan::{Stock, grow};

fn grown(graph: &CityGraph, rules: &str) -> CityPlan {
    let rules: Vec<FurnitureRule> = file::parse(rules, "test").unwrap_or_else(|e| panic!("{e}"));
    let stock = Stock::new().with(&[], Vec::new(), rules).unwrap_or_else(|e| panic!("{e:?}"));
    grow(graph, &stock).unwrap_or_else(|e| panic!("{e}")).plan
}

fn parsed(text: &str) -> CityGraph {
    file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
}

/// A crossroads, each arm of its class.
fn crossroads(classes: [&str; 4]) -> CityGraph {
    let [e, n, w, s] = classes;
    parsed(&format!(
        "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3,
          nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (120, 0)), (id: 3, pos: (0, 120)), (id: 4, pos: (-120, 0)), (id: 5, pos: (0, -120))],
          links: [(from: 1, to: 2, kind: Street({e})), (from: 1, to: 3, kind: Street({n})),
                  (from: 4, to: 1, kind: Street({w})), (from: 5, to: 1, kind: Street({s}))])"
    ))
}

fn of(plan: &CityPlan, kind: ObjectKind) -> Vec<&PlanObject> {
    plan.objects.iter().filter(|object| object.kind == kind).collect()
}

fn under(plan: &CityPlan, object: &PlanObject) -> Option<(SurfaceKind, i32)> {
    plan.ground.iter().find(|patch| patch.outline.contains(object.pos)).map(|patch| (patch.surface, patch.z))
}

#[test]
fn lights_stand_where_main_streets_cross_and_signs_where_others_meet_them() {
    for (classes, lights, signs) in [
        (["Main"; 4], 4, 0),
        (["Main", "Street", "Main", "Main"], 4, 0),
        (["Main", "Street", "Main", "Street"], 0, 2),
        (["Street"; 4], 0, 0),
    ] {
        let plan = grown(&crossroads(classes), "[]");
        assert_eq!((of(&plan, ObjectKind::Signals).len(), of(&plan, ObjectKind::Sign).len()), (lights, signs), "{classes:?}");
        for object in of(&plan, ObjectKind::Signals).into_iter().chain(of(&plan, ObjectKind::Sign)) {
            let (pos, heading) = (object.pos.to_metres(), f64::from(object.heading).to_radians());
            let front = DVec2::new(heading.sin(), heading.cos());
            // It looks along its arm, away from the middle, and stands on the right of who comes: on the left of the way out.
            let out = if pos.x.abs() > pos.y.abs() { DVec2::new(pos.x.signum(), 0.0) } else { DVec2::new(0.0, pos.y.signum()) };
            assert!(front.dot(out) > 0.999 && out.perp_dot(pos) > 3.0, "{pos}: {front}");
            assert_eq!(under(&plan, object).map(|(_, z)| z > 0), Some(true), "on the pavement");
        }
    }
}

/// Distance from an edge of what lies beside it.
fn beside(p: DVec2, a: DVec2, b: DVec2) -> Option<f64> {
    let along = (p - a).dot(b - a) / (b - a).length_squared();
    (0.0..=1.0).contains(&along).then(|| p.distance(a.lerp(b, along)))
}

#[test]
fn nothing_stands_in_the_way() {
    let mut graph = synthetic::city(5, 3);
    for (i, block) in graph.blocks.iter_mut().filter(|b| b.kind == BlockKind::Built).enumerate() {
        block.kind = if i % 5 == 0 { BlockKind::Park } else { BlockKind::Built };
    }
    let more = "[(name: \"tubs\", put: [(kind: Planter), (kind: Bin, share: 2)], clear_m: 0.5,
                  place: Along(streets: [Main, Street, Lane], every_m: 4, side: Both, at: Edge(0.5)))]";
    let plan = grown(&graph, more);
    assert!(plan.objects.len() > 300, "{} objects", plan.objects.len());
    let doors: Vec<DVec2> = plan
        .houses
        .iter()
        .flat_map(|house| &house.volumes)
        .flat_map(|volume| {
            volume.walls.iter().zip(volume.footprint.edges()).filter_map(|(wall, (a, b))| {
                let bay = wall.ground_floor.door_bay?;
                Some(a.to_metres().lerp(b.to_metres(), (f64::from(bay) + 0.5) / f64::from(wall.bays.max(1))))
            })
        })
        .collect();
    assert!(doors.len() > 100, "{} doors", doors.len());
    let at = graph.node_positions();
    let carriageways: Vec<(&Link, Vec<DVec2>)> = graph
        .links
        .iter()
        .filter(|link| matches!(link.kind, LinkKind::Street(class) if class.has_carriageway()))
        .filter_map(|link| Some((link, graph.polyline(link, &at)?)))
        .collect();
    assert!(!carriageways.is_empty());
    for (i, object) in plan.objects.iter().enumerate() {
        let pos = object.pos.to_metres();
        let in_house = plan.houses.iter().flat_map(|h| &h.volumes).any(|v| v.footprint.contains(object.pos));
        assert!(!in_house, "{object:?} stands in a house");
        assert!(under(&plan, object).is_some(), "{object:?} stands beyond the city");
        for (link, line) in &carriageways {
            let from_middle = line.windows(2).filter_map(|e| beside(pos, e[0], e[1])).fold(f64::INFINITY, f64::min);
            assert!(from_middle > 0.29 * link.width(), "{object:?} stands {from_middle} m from the middle of {link:?}");
        }
        assert!(doors.iter().all(|door| door.distance(pos) > 1.2), "{object:?} stands in a doorway");
        let is_hedge = |o: &PlanObject| o.kind == ObjectKind::Hedge;
        for other in &plan.objects[..i] {
            let apart = other.pos.to_metres().distance(pos) - other.kind.radius_m() - object.kind.radius_m();
            assert!(apart > if is_hedge(other) || is_hedge(object) { -1e-3 } else { 0.49 }, "{object:?} and {other:?}: {apart} m");
        }
    }
}

#[test]
fn nothing_stands_on_a_railway() {
    let mut graph = crossroads(["Street"; 4]);
    let rails = parsed(
        "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 7, pos: (60, -60)), (id: 8, pos: (60, 60))],
          links: [(from: 7, to: 8, kind: Railway(tram: false), width_m: 8)])",
    );
    graph.nodes.extend(rails.nodes);
    graph.links.extend(rails.links);
    let posts =
        "[(name: \"posts\", put: [(kind: Bollard)], place: Along(streets: [Street], every_m: 3, side: Both, at: Edge(0.8)))]";
    let plan = grown(&graph, posts);
    let near: Vec<f64> = plan.objects.iter().map(|o| (o.pos.to_metres().x - 60.0).abs()).filter(|d| *d < 8.0).collect();
    assert!(!near.is_empty() && near.iter().all(|d| *d > 4.3), "{near:?}");
}

#[test]
fn rules_are_turned_off_and_put_monuments() {
    let graph = crossroads(["Main", "Street", "Main", "Street"]);
    assert!(!of(&grown(&graph, "[]"), ObjectKind::Lamp).is_empty());
    let plan = grown(
        &graph,
        "[(name: \"lamps\", put: []), (name: \"posts\", put: [(kind: Statue, monument: \"obelisk\", height_m: (5, 5))],
          place: Along(streets: [Street], every_m: 30, side: Both, at: Edge(0.8)))]",
    );
    assert_eq!(of(&plan, ObjectKind::Lamp), Vec::<&PlanObject>::new());
    let posts = of(&plan, ObjectKind::Statue);
    assert!(posts.len() >= 8 && posts.iter().all(|post| post.monument == Some(0) && post.height == 5 * 1024), "{posts:?}");
    assert_eq!(plan.designs.iter().map(|design| design.name.as_str()).collect::<Vec<_>>(), ["obelisk"]);
}

#[test]
fn hedges_run_in_rows_with_gaps_along_a_park() {
    let mut graph = crossroads(["Street"; 4]);
    let blocks = parsed(
        "(name: \"T\", anchor: (lat: 50, lon: 14), blocks: [(kind: Park, outline: [(10, 10), (90, 10), (90, 90), (10, 90)])])",
    );
    graph.blocks = blocks.blocks;
    let plan = grown(&graph, "[]");
    let hedges = of(&plan, ObjectKind::Hedge);
    let south: Vec<f64> = hedges.iter().map(|h| h.pos.to_metres()).filter(|p| (p.y - 11.2).abs() < 0.1).map(|p| p.x).collect();
    let mut gaps: Vec<f64> = south.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    assert!(south.len() > 25, "{} hedges along 80 m", south.len());
    assert!((gaps[0] - 1.95).abs() < 0.02 && (3..=4).contains(&gaps.iter().filter(|gap| **gap > 4.0).count()), "{south:?}");
    assert!(plan.objects.iter().filter(|o| o.kind == ObjectKind::Tree).count() > 10);
    let twice = grown(&graph, "[]");
    assert_eq!(plan.objects, twice.objects);
}

#[test]
fn a_park_has_a_middle_that_benches_look_at_between_the_walks() {
    let mut graph = crossroads(["Street"; 4]);
    let blocks = parsed(
        "(name: \"T\", anchor: (lat: 50, lon: 14), blocks: [(kind: Park, outline: [(10, 10), (90, 10), (90, 90), (10, 90)]),
            (kind: Park, outline: [(-90, 10), (-10, 10), (-10, 24), (-90, 24)])])",
    );
    graph.blocks = blocks.blocks;
    let plan = grown(&graph, "[]");
    let middles: Vec<&PlanObject> = of(&plan, ObjectKind::Fountain).into_iter().chain(of(&plan, ObjectKind::Statue)).collect();
    let middle = DVec2::new(50.0, 50.0);
    assert!(
        middles.len() == 1 && middles[0].pos.to_metres().distance(middle) < 0.1,
        "one, in the park with room for it: {middles:?}"
    );
    let ring: Vec<&PlanObject> = of(&plan, ObjectKind::Bench)
        .into_iter()
        .filter(|bench| (bench.pos.to_metres().distance(middle) - 5.0).abs() < 0.01)
        .collect();
    assert!((4..=10).contains(&ring.len()), "{}", ring.len());
    for bench in ring {
        let (pos, heading) = (bench.pos.to_metres(), f64::from(bench.heading).to_radians());
        assert!(DVec2::new(heading.sin(), heading.cos()).dot((middle - pos).normalize()) > 0.99, "{pos}");
        let behind = veduta_city::GridPos::from_metres(middle + (pos - middle) * 1.6);
        let surface = plan.ground.iter().find(|patch| patch.outline.contains(behind)).map(|patch| patch.surface);
        assert_eq!(surface, Some(SurfaceKind::Grass), "no walk leads through {pos}");
    }
}

#[test]
fn palms_grow_in_the_south_alone() {
    for (lat, has_palms) in [(50.0, false), (17.7, true), (-33.0, true), (-45.0, false)] {
        let mut graph = crossroads(["Main"; 4]);
        graph.anchor.lat = lat;
        let plan = grown(&graph, "[]");
        let (palms, trees) = (of(&plan, ObjectKind::Palm).len(), of(&plan, ObjectKind::Tree).len());
        assert_eq!((palms > 10, trees > 10), (has_palms, !has_palms), "{lat}: {palms} palms, {trees} other trees");
    }
}

#[test]
fn rows_run_on_round_the_corners_of_a_curved_park() {
    let mut graph = crossroads(["Street"; 4]);
    // A circle of sides shorter than a piece of hedge.
    let corner = |i: u32| {
        let turn = f64::from(i) * core::f64::consts::TAU / 240.0;
        format!("({:.3}, {:.3})", 55.0 + 40.0 * turn.cos(), 55.0 + 40.0 * turn.sin())
    };
    let outline: Vec<String> = (0..240).map(corner).collect();
    graph.blocks =
        parsed(&format!("(name: \"T\", anchor: (lat: 50, lon: 14), blocks: [(kind: Park, outline: [{}])])", outline.join(",")))
            .blocks;
    let plan = grown(&graph, "[]");
    let mut turns: Vec<f64> =
        of(&plan, ObjectKind::Hedge).iter().map(|hedge| (hedge.pos.to_metres() - DVec2::splat(55.0)).to_angle() * 40.0).collect();
    turns.sort_unstable_by(f64::total_cmp);
    let gaps = turns.windows(2).filter(|pair| pair[1] - pair[0] > 4.0).count();
    // 251 m round: eleven rows of 18 m with gaps of 4.5 m.
    assert!((90..=110).contains(&turns.len()) && (10..=11).contains(&gaps), "{} pieces, {gaps} gaps", turns.len());
}

#[test]
fn a_map_that_tells_of_furniture_is_left_as_it_is() {
    let mut graph = crossroads(["Main", "Street", "Main", "Street"]);
    let objects: Vec<String> = (0..8).map(|i| format!("(id: {}, kind: Bench, pos: ({}, 6))", 90 + i, 20 + 10 * i)).collect();
    let told = parsed(&format!("(name: \"T\", anchor: (lat: 50, lon: 14), objects: [{}])", objects.join(",")));
    graph.objects = told.objects;
    let plan = grown(&graph, "[]");
    assert!(plan.objects.iter().all(|object| (90..98).contains(&object.id.0)), "{:?}", plan.objects);
    assert_eq!(plan.objects.len(), 8);
    assert!(plan.objects.iter().any(|object| object.id == Id(97)));
}
