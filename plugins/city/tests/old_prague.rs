//! The sample city as its files stand: it parses, holds together, and keeps to its own rules.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::PathBuf;

use glam::DVec2;
use veduta_city::{
    Block, BlockKind, CityGraph, GraphOverride, GraphOverrides, Id, LinkKind, ObjectKind, Ring, Step, Tour, Viewpoint, Where, file,
};

fn scene(name: &str) -> PathBuf {
    PathBuf::from("../../scenes/old_prague").join(name)
}

fn read<T: serde::de::DeserializeOwned>(name: &str) -> T {
    file::read(&scene(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// The city as growth takes it: with ids and overrides.
fn city() -> CityGraph {
    let mut graph: CityGraph = read("old_prague.graph.ron");
    graph.fill_ids();
    let overrides: GraphOverrides = read("old_prague.graph.overrides.ron");
    assert_eq!(overrides.apply(&mut graph), [], "every override finds its thing");
    graph.fill_ids();
    graph
}

fn edges(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)).take(ring.len())
}

fn area(ring: &[DVec2]) -> f64 {
    edges(ring).map(|(a, b)| a.perp_dot(b)).sum::<f64>() / 2.0
}

fn inside(ring: &[DVec2], p: DVec2) -> bool {
    edges(ring).filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)).count() % 2 == 1
}

fn to_edge(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t))
}

fn to_border(ring: &[DVec2], p: DVec2) -> f64 {
    edges(ring).map(|(a, b)| to_edge(a, b, p)).fold(f64::INFINITY, f64::min)
}

/// Points along a line, no more than a metre apart.
fn samples(line: &[DVec2]) -> Vec<DVec2> {
    let points = |a: DVec2, b: DVec2| {
        let n = a.distance(b).ceil().max(1.0) as usize;
        (0..=n).map(move |i| a.lerp(b, i as f64 / n as f64))
    };
    line.windows(2).flat_map(|e| points(e[0], e[1])).collect()
}

fn closed(ring: &Ring) -> Vec<DVec2> {
    ring.iter().copied().chain(ring.first().copied()).collect()
}

/// Street lines with their half widths and names.
fn streets(graph: &CityGraph) -> Vec<(Vec<DVec2>, f64, &str)> {
    let at = graph.node_positions();
    let street = |l: &&veduta_city::Link| matches!(l.kind, LinkKind::Street(_));
    let line = |l| graph.polyline(l, &at).unwrap_or_else(|| panic!("link {} has both nodes", l.id));
    graph.links.iter().filter(street).map(|l| (line(l), l.width() / 2.0, l.name.as_str())).collect()
}

fn to_streets(streets: &[(Vec<DVec2>, f64, &str)], p: DVec2) -> f64 {
    let near = |line: &[DVec2]| line.windows(2).map(|e| to_edge(e[0], e[1], p)).fold(f64::INFINITY, f64::min);
    streets.iter().map(|(line, ..)| near(line)).fold(f64::INFINITY, f64::min)
}

fn solid_blocks(graph: &CityGraph) -> impl Iterator<Item = &Block> {
    graph.blocks.iter().filter(|b| matches!(b.kind, BlockKind::Built | BlockKind::Monument | BlockKind::Water))
}

/// Walls at eye height: parts that reach the ground, or the outline of what has no parts.
fn walls(graph: &CityGraph) -> Vec<(&str, &Ring)> {
    let mut walls = Vec::new();
    for b in &graph.buildings {
        match b.parts.is_empty() {
            true => walls.push((b.name.as_str(), &b.outline)),
            false => walls.extend(b.parts.iter().filter(|p| p.min_height_m < 2.5).map(|p| (b.name.as_str(), &p.outline))),
        }
    }
    walls
}

#[test]
fn nothing_is_wrong_and_enough_is_there() {
    let graph = city();
    assert_eq!(graph.validate(), []);
    let named: BTreeSet<&str> = streets(&graph).iter().map(|s| s.2).filter(|n| !n.is_empty()).collect();
    assert!(named.len() >= 18, "named streets: {named:?}");
    for name in ["Celetná", "Karlova", "Melantrichova", "Husova", "Železná"] {
        assert!(named.contains(name), "{name} is missing");
    }
    let squares: Vec<&str> = graph.squares.iter().map(|s| s.name.as_str()).collect();
    for name in ["Old Town Square", "Small Square", "Mariánské Square"] {
        assert!(squares.contains(&name), "{name} is missing from {squares:?}");
    }
    assert!(graph.objects.len() >= 60, "{} objects", graph.objects.len());
    for kind in [ObjectKind::Lamp, ObjectKind::Tree, ObjectKind::Fountain, ObjectKind::Bench, ObjectKind::TramStop] {
        assert!(graph.objects.iter().any(|o| o.kind == kind), "no {kind:?}");
    }
    assert!(graph.places.len() >= 40, "{} places", graph.places.len());
    for name in ["Old Town Hall", "Church of Our Lady before Týn", "Church of St Nicholas", "Powder Tower"] {
        assert!(graph.buildings.iter().any(|b| b.name == name && b.parts.len() > 3), "{name} with its parts");
    }
}

#[test]
fn landmarks_stand_where_they_are_on_earth() {
    let graph = city();
    let middle = |ring: &Ring| ring.iter().copied().sum::<DVec2>() / ring.len() as f64;
    for (name, lat, lon) in [
        ("Old Town Hall", 50.08695, 14.4205),
        ("Church of Our Lady before Týn", 50.0876, 14.4227),
        ("Church of St Nicholas", 50.0879, 14.41985),
        ("Powder Tower", 50.08727, 14.42786),
        ("Old Town Bridge Tower", 50.08622, 14.41355),
    ] {
        let there = graph.anchor.plan_from_geo(lat, lon);
        let Some(b) = graph.buildings.iter().find(|b| b.name == name) else { panic!("{name} is missing") };
        let off = middle(&b.outline).distance(there);
        assert!(off < 15.0, "{name} is {off:.1} m from where it should be");
    }
}

#[test]
fn there_is_one_way_through_all_streets() {
    let graph = city();
    let mut next: HashMap<Id, Vec<Id>> = HashMap::new();
    for l in graph.links.iter().filter(|l| matches!(l.kind, LinkKind::Street(_))) {
        next.entry(l.from).or_default().push(l.to);
        next.entry(l.to).or_default().push(l.from);
    }
    let mut seen = BTreeSet::from([graph.nodes[0].id]);
    let mut todo = vec![graph.nodes[0].id];
    while let Some(id) = todo.pop() {
        todo.extend(next.get(&id).into_iter().flatten().copied().filter(|&n| seen.insert(n)));
    }
    let cut_off: Vec<Id> = graph.nodes.iter().map(|n| n.id).filter(|id| !seen.contains(id)).collect();
    assert_eq!(cut_off, [], "nodes that no street reaches");
    let lines = streets(&graph);
    for p in &graph.places {
        let far = to_streets(&lines, p.pos);
        assert!(far < 45.0, "{} is {far:.0} m from the nearest street", p.name);
    }
}

#[test]
fn blocks_keep_clear_of_each_other_and_of_streets_and_squares() {
    let graph = city();
    let lines = streets(&graph);
    for a in &graph.blocks {
        assert!(area(&a.outline) > 0.0, "block {} runs clockwise", a.id);
        let deep = |ring: &Ring, p: DVec2| inside(ring, p) && to_border(ring, p) > 0.3;
        let border = samples(&closed(&a.outline));
        for b in graph.blocks.iter().filter(|b| b.id != a.id) {
            assert!(!border.iter().any(|&p| deep(&b.outline, p)), "blocks {} and {} overlap", a.id, b.id);
        }
        for s in &graph.squares {
            let overlap =
                border.iter().find(|&&p| deep(&s.outline, p) && !s.holes.iter().any(|h| inside(h, p) || to_border(h, p) < 0.3));
            assert_eq!(overlap, None, "block {} reaches into {}", a.id, s.name);
        }
        for (line, half, name) in lines.iter().filter(|_| a.kind != BlockKind::Park) {
            for e in line.windows(2) {
                let along = |p: DVec2| (p - e[0]).dot(e[1] - e[0]) / (e[1] - e[0]).length_squared();
                let hit = border.iter().find(|&&p| (0.0..=1.0).contains(&along(p)) && to_edge(e[0], e[1], p) < half - 0.3);
                assert_eq!(hit, None, "block {} reaches into {name}", a.id);
            }
        }
    }
}

#[test]
fn blocks_have_room_for_a_hundred_and_fifty_houses() {
    let graph = city();
    let lines = streets(&graph);
    let fronts = |b: &&Block| b.kind == BlockKind::Built;
    let by_street = |p: &DVec2| lines.iter().any(|(l, half, _)| l.windows(2).any(|e| to_edge(e[0], e[1], *p) < half + 1.0));
    let metres: usize =
        graph.blocks.iter().filter(fronts).map(|b| samples(&closed(&b.outline)).iter().filter(|p| by_street(p)).count()).sum();
    assert!(metres >= 1_500, "{metres} m of street front is fewer than 150 houses of 10 m");
}

#[test]
fn houses_stand_in_blocks_or_on_free_ground_and_not_in_each_other() {
    let graph = city();
    let lines = streets(&graph);
    let walls = walls(&graph);
    for (name, ring) in &walls {
        assert!(area(ring) > 0.0, "an outline of {name} runs clockwise");
        for p in samples(&closed(ring)) {
            let crossed = lines.iter().find(|street| to_streets(std::slice::from_ref(street), p) < street.1.min(2.0) - 0.1);
            assert_eq!(crossed.map(|street| street.2), None, "{name} stands in the middle of a street at {p}");
        }
    }
    for (i, (a, ring)) in walls.iter().enumerate() {
        for (b, other) in walls[..i].iter().filter(|(b, _)| b != a) {
            let hit = samples(&closed(ring)).into_iter().find(|&p| inside(other, p) && to_border(other, p) > 0.4);
            assert_eq!(hit, None, "{a} and {b} overlap");
        }
    }
}

#[test]
fn things_and_people_stand_on_open_ground() {
    let graph = city();
    let walls = walls(&graph);
    let in_wall = |p: DVec2| {
        solid_blocks(&graph).any(|b| inside(&b.outline, p))
            || walls.iter().any(|(name, ring)| !name.starts_with("Hus") && inside(ring, p))
    };
    let lines = streets(&graph);
    for o in &graph.objects {
        assert!(!in_wall(o.pos), "{:?} {} at {} stands in a wall or in the water", o.kind, o.name, o.pos);
        assert!(to_streets(&lines, o.pos) > 1.0, "{:?} at {} stands in the way", o.kind, o.pos);
    }
    let start: Vec<(&str, Viewpoint)> = graph.start.iter().map(|v| ("the start", *v)).collect();
    assert_eq!(start.len(), 1, "a visit begins somewhere");
    let views = graph.places.iter().filter_map(|p| Some((p.name.as_str(), p.view?)));
    for (name, view) in start.into_iter().chain(views).filter(|(_, v)| v.eye_m < 3.0) {
        assert!(!in_wall(view.pos), "the view of {name} is from inside a wall");
    }
    for p in &graph.places {
        assert!(!in_wall(p.pos), "{} cannot be walked to", p.name);
    }
    let mut names = BTreeMap::new();
    for p in &graph.places {
        *names.entry(p.name.as_str()).or_insert(0) += 1;
    }
    names.retain(|_, n| *n > 1);
    assert!(names.is_empty(), "two places of one name: {names:?}");
}

#[test]
fn an_override_of_a_thing_that_is_gone_is_told() {
    let mut graph: CityGraph = read("old_prague.graph.ron");
    graph.fill_ids();
    graph.buildings.clear();
    let overrides: GraphOverrides = read("old_prague.graph.overrides.ron");
    let edits = overrides.edits.iter().filter(|e| matches!(e, GraphOverride::Building { .. })).count();
    assert!(edits >= 3, "{edits} edits of buildings");
    assert_eq!(overrides.apply(&mut graph).len(), edits);
}

#[test]
fn tours_name_places_that_are_there_and_keep_their_pace() {
    let graph = city();
    for name in ["royal_route.tour.ron", "royal_route_long.tour.ron", "to_the_clock.tour.ron"] {
        let tour: Tour = read(name);
        assert!(scene(&tour.city).is_file(), "{name}: its city {} is beside it", tour.city);
        let known = |w: &Where| match w {
            Where::Place(place) => assert!(graph.places.iter().any(|p| p.name == *place), "{name}: no place {place}"),
            Where::At(x, y) => {
                assert!(!solid_blocks(&graph).any(|b| inside(&b.outline, DVec2::new(*x, *y))), "{name}: ({x}, {y}) is in a block")
            }
        };
        for step in &tour.steps {
            match step {
                Step::Start { at, .. } | Step::Cut { to: at, .. } => known(at),
                Step::Walk { to, via, speed, .. } => {
                    via.iter().chain([to]).for_each(known);
                    assert!(speed.unwrap_or(tour.speed) <= 2.0, "{name} walks no faster than 2 m/s");
                }
                Step::Fly { .. } => assert_ne!(name, "royal_route_long.tour.ron", "the long tour stays on foot"),
                _ => {}
            }
        }
        assert!(matches!(tour.steps.first(), Some(Step::Start { .. })), "{name} starts somewhere");
    }
}

#[test]
fn whatever_has_no_id_is_noticed() {
    let whole = city();
    assert!(whole.has_ids());
    let ids: [fn(&mut CityGraph) -> Option<&mut Id>; 7] = [
        |graph| graph.links.last_mut().map(|link| &mut link.id),
        |graph| graph.squares.last_mut().map(|square| &mut square.id),
        |graph| graph.blocks.last_mut().map(|block| &mut block.id),
        |graph| graph.buildings.last_mut().map(|building| &mut building.id),
        |graph| graph.buildings.iter_mut().find_map(|building| building.parts.last_mut()).map(|part| &mut part.id),
        |graph| graph.objects.last_mut().map(|object| &mut object.id),
        |graph| graph.places.last_mut().map(|place| &mut place.id),
    ];
    for (kind, id) in ids.iter().enumerate() {
        let mut graph = whole.clone();
        *id(&mut graph).unwrap_or_else(|| panic!("there is nothing of kind {kind}")) = Id::NONE;
        assert!(!graph.has_ids(), "kind {kind}");
        graph.fill_ids();
        assert!(graph.has_ids(), "kind {kind}");
    }
}
