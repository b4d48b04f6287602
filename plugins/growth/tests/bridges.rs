//! Bridges over rivers and valleys: they begin and end on the ground, are whole, and stand on piers out of the way.

use glam::DVec2;
use proptest::prelude::*;
use veduta_city::{
    CellShell, CityGraph, CityPlan, GRID_PER_METRE, GridPos, Id, MarkingKind, ObjectKind, SpanForm, SurfaceKind, Terrain, WaySpan,
    file, metres,
};
use veduta_growth::mesh;
use veduta_growth::plan::{Stock, grow};

/// A river between x = -30 and 30, less wide in the south, with what a map says crosses it.
fn river(links: &str) -> CityGraph {
    let text = format!(
        "(name: \"River\", anchor: (lat: 50, lon: 14), seed: 3, margin_m: 40,
          nodes: [(id: 1, pos: (-90, 0)), (id: 2, pos: (-45, 0)), (id: 3, pos: (45, 6)), (id: 4, pos: (90, 0)), (id: 5, pos: (-90, 80)),
            (id: 6, pos: (90, 60)), (id: 7, pos: (0, 40)), (id: 8, pos: (-90, -90)), (id: 9, pos: (90, -80)), (id: 10, pos: (-45, 14)), (id: 11, pos: (45, 20))],
          links: [{links}],
          blocks: [(kind: Water, outline: [(-26, -160), (26, -160), (32, 0), (30, 140), (-30, 140), (-30, 0)])])"
    );
    file::parse(&text, "river").unwrap_or_else(|e| panic!("{e}"))
}

fn grown(graph: &CityGraph) -> CityPlan {
    grow(graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}")).plan
}

const MAIN: &str = "(id: 11, from: 1, to: 2, kind: Street(Main), width_m: 14), (id: 12, from: 2, to: 3, kind: Street(Main), width_m: 14, layer: 1),
    (id: 13, from: 3, to: 4, kind: Street(Main), width_m: 14)";

/// What lies on the ground at a place, and how high above the terrain, metres.
fn ground(plan: &CityPlan, p: DVec2) -> (SurfaceKind, f64) {
    let pos = GridPos::from_metres(p);
    let patch = plan.ground.iter().find(|patch| patch.outline.contains(pos));
    patch.map(|patch| (patch.surface, metres(patch.z))).unwrap_or_else(|| panic!("nothing at {p}"))
}

/// Spans of one bridge share their stations; those at both ends lie on the ground, and what is between is off it.
fn prove(plan: &CityPlan, spans: &[&WaySpan]) {
    let (first, last) = (spans[0], spans[spans.len() - 1]);
    for pair in spans.windows(2) {
        assert_eq!(pair[0].stations.last(), pair[1].stations.first());
        assert!(pair[0].piers.1.is_some() && pair[0].piers.1 == pair[1].piers.0);
    }
    assert_eq!((first.piers.0, last.piers.1), (None, None));
    for station in [&first.stations[0], &last.stations[last.stations.len() - 1]] {
        let p = station.at(0.0);
        assert!(
            (metres(station.z) - plan.terrain.height_m(p)).abs() < 0.05,
            "an end at {} over {}",
            metres(station.z),
            plan.terrain.height_m(p)
        );
    }
    for span in spans {
        assert!(span.stations.len() > 1 && span.stations.windows(2).all(|pair| pair[0] != pair[1]));
        let slopes = span.stations.windows(2).map(|pair| metres(pair[1].z - pair[0].z) / pair[0].at(0.0).distance(pair[1].at(0.0)));
        assert!(slopes.into_iter().all(|slope| slope.abs() < 0.3));
        // The arch or girder is above the water.
        let foot = span.piers.1.or(span.piers.0);
        assert!(foot.is_none_or(|foot| foot < span.springing - GRID_PER_METRE / 2));
    }
    let shell = CellShell {
        terrain: plan.terrain.clone(),
        ground: plan.ground.clone(),
        spans: spans.iter().map(|&span| span.clone()).collect(),
        drawn_spans: spans.len() as u32,
        ..CellShell::default()
    };
    let mesh = mesh::spans(&shell);
    assert_eq!(mesh.validate(), Ok(()));
    assert!(!mesh.is_empty());
    // Normals look the way their faces turn.
    for t in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| glam::Vec3::from_array(mesh.positions[i as usize]).as_dvec3());
        let normal = glam::Vec3::from_array(mesh.normals[t[0] as usize]).as_dvec3();
        assert!((b - a).cross(c - a).dot(normal) >= 0.0);
    }
    let collision = mesh::collision(&shell);
    for span in spans {
        for station in &span.stations[..span.stations.len() - 1] {
            let p = station.at(0.3);
            let under = collision
                .ground
                .triangles
                .iter()
                .filter_map(|t| height_on(&collision.ground, *t, p))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!((under - metres(station.z)).abs() < 0.15, "{under} for {}", metres(station.z));
        }
    }
}

/// Height of a triangle of the ground over a place.
fn height_on(mesh: &mesh::Trimesh, triangle: [u32; 3], p: DVec2) -> Option<f64> {
    let at = triangle.map(|i| glam::Vec3::from_array(mesh.positions[i as usize]).as_dvec3());
    let [a, b, c] = at.map(|q| DVec2::new(q.x, -q.z));
    let whole = (b - a).perp_dot(c - a);
    let [u, v, w] = [(b, c), (c, a), (a, b)].map(|(s, t)| (t - s).perp_dot(p - s) / whole);
    (whole > 1e-9 && [u, v, w].iter().all(|&share| share >= -1e-6)).then(|| u * at[0].y + v * at[1].y + w * at[2].y)
}

#[test]
fn a_street_crosses_a_river_on_arches_of_stone() {
    let plan = grown(&river(MAIN));
    let spans: Vec<&WaySpan> = plan.spans.iter().collect();
    assert!(spans.len() > 2 && spans.iter().all(|span| span.id == Id(12) && span.form == SpanForm::Arches));
    prove(&plan, &spans);
    // Below it the river flows on, deep under its banks; beside it the street's ground ends in the water.
    assert_eq!(ground(&plan, DVec2::new(0.0, 3.0)).0, SurfaceKind::Water);
    assert!(ground(&plan, DVec2::new(0.0, 3.0)).1 < -2.0);
    assert_eq!(ground(&plan, DVec2::new(-38.0, 0.5)).0, SurfaceKind::Asphalt);
    let length: f64 =
        spans.iter().flat_map(|span| span.stations.windows(2)).map(|pair| pair[0].at(0.0).distance(pair[1].at(0.0))).sum();
    assert!((55.0..66.0).contains(&length), "{length} m of bridge");
    // The lines of its lanes are on it and not in the river, and nothing stands on its carriageway.
    assert!(spans.iter().all(|span| span.markings.iter().any(|marking| marking.kind == MarkingKind::Dashes)));
    assert!(plan.markings.iter().all(|m| m.line.iter().all(|p| ground(&plan, p.to_metres()).0 != SurfaceKind::Water)));
    let on_it: Vec<_> =
        plan.objects.iter().filter(|object| spans.iter().any(|span| span.height_m(object.pos.to_metres()).is_some())).collect();
    assert!(on_it.iter().any(|object| object.kind == ObjectKind::Lamp), "it is lit");
    assert!(on_it.iter().all(|object| metres(object.z) > 0.0 && object.kind != ObjectKind::Tree));
}

#[test]
fn streets_beside_one_another_share_their_bridge_and_paths_lie_on_it() {
    // Two carriageways that touch, and a footway along one of them.
    let links = format!(
        "{MAIN}, (id: 22, from: 10, to: 11, kind: Street(Main), width_m: 14, layer: 1),
        (id: 32, from: 2, to: 3, via: [(0, 1)], kind: Street(Path), width_m: 2, layer: 1)"
    );
    let plan = grown(&river(&links));
    let of = |id: u64| plan.spans.iter().filter(move |span| span.id == Id(id)).collect::<Vec<_>>();
    assert!(of(32).is_empty(), "the footway lies on the bridge");
    let (south, north) = (of(12), of(22));
    prove(&plan, &south);
    assert!(south.iter().all(|span| span.parapets == (false, true) && span.pavements.0 == 0 && span.pavements.1 > 0));
    assert!(north.iter().all(|span| span.parapets == (true, false) && span.pavements.1 == 0 && span.pavements.0 > 0));
}

#[test]
fn rails_cross_on_girders_and_trams_on_the_street() {
    let links = format!(
        "{MAIN}, (id: 41, from: 2, to: 3, kind: Railway(tram: true), layer: 1), (id: 51, from: 8, to: 9, kind: Railway(tram: false), width_m: 9)"
    );
    let plan = grown(&river(&links));
    let (rail, street): (Vec<&WaySpan>, Vec<_>) = plan.spans.iter().partition(|span| span.id == Id(51));
    prove(&plan, &rail);
    prove(&plan, &street);
    assert!(
        rail.iter().all(|span| span.form == SpanForm::Girder && span.surface == SurfaceKind::Ballast && span.markings.len() == 2)
    );
    assert!(street.iter().all(|span| span.markings.iter().any(|m| m.kind == MarkingKind::Rails && m.left.0.abs() < 20)));
}

#[test]
fn a_jetty_stands_on_piers_and_a_brook_is_led_under_the_street() {
    let mut graph = river("(id: 12, from: 2, to: 7, kind: Street(Lane), width_m: 4)");
    let plan = grown(&graph);
    let jetty: Vec<&WaySpan> = plan.spans.iter().collect();
    prove(&plan, &jetty);
    let end = jetty[jetty.len() - 1].stations.last().expect("it has an end").at(0.0);
    assert!(jetty.len() > 1 && end.distance(DVec2::new(0.0, 40.0)) < 0.1, "it ends at {end}");
    graph = river(MAIN);
    graph.blocks[0].outline = [(-4.0, -160.0), (4.0, -160.0), (4.0, 140.0), (-4.0, 140.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
    let plan = grown(&graph);
    assert!(plan.spans.is_empty());
    assert_eq!(ground(&plan, DVec2::new(0.0, 3.0)).0, SurfaceKind::Asphalt);
}

#[test]
fn a_bridge_leads_over_a_valley() {
    let mut graph = river(MAIN);
    graph.blocks.clear();
    let posts = 81;
    let depth = |x: f64| 9.0 * (1.0 - (x / 34.0).abs()).clamp(0.0, 0.5);
    let heights_m = (0..posts * posts).map(|i| 20.0 - depth(f64::from(i % posts) * 4.0 - 160.0)).collect();
    graph.terrain = Some(Terrain { origin: DVec2::splat(-160.0), step_m: 4.0, columns: posts as u32, heights_m });
    let plan = grown(&graph);
    let spans: Vec<&WaySpan> = plan.spans.iter().collect();
    prove(&plan, &spans);
    assert!(spans.iter().all(|span| span.form == SpanForm::Girder));
    let middle = plan.terrain.height_m(DVec2::new(0.0, 3.0));
    assert!((middle - 15.5).abs() < 0.1, "the valley stays: {middle}");
    assert!(plan.spans.iter().filter_map(|span| span.height_m(DVec2::new(0.0, 3.0))).all(|height| height > 20.0));
}

/// A level city in which a street of a length leads over a way at x = 0, from streets that begin 200 m away; another street ends at
/// where the bridge begins.
fn overpass(half_m: f64, over: &str, below: &str) -> CityGraph {
    let text = format!(
        "(name: \"Over\", anchor: (lat: 50, lon: 14), seed: 3, margin_m: 40,
          nodes: [(id: 1, pos: (-200, 0)), (id: 2, pos: (-{half_m}, 0)), (id: 3, pos: ({half_m}, 0)), (id: 4, pos: (200, 0)), (id: 5, pos: (0, -200)),
            (id: 6, pos: (0, 200)), (id: 7, pos: (-{half_m}, 120))],
          links: [(id: 11, from: 1, to: 2, kind: {over}), (id: 12, from: 2, to: 3, kind: {over}, layer: 1), (id: 13, from: 3, to: 4, kind: {over}),
            (id: 14, from: 5, to: 6, kind: {below}), (id: 15, from: 2, to: 7, kind: Street(Street))])"
    );
    file::parse(&text, "over").unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_level_city_rises_to_its_overpasses() {
    for (half_m, over, below, clear_m) in [
        (15.0, "Street(Main), width_m: 12", "Railway(tram: false), width_m: 9", 5.4),
        (15.0, "Street(Street)", "Street(Main), width_m: 12", 4.6),
        (20.0, "Railway(tram: false), width_m: 9", "Street(Lane)", 2.8),
        (12.0, "Street(Path)", "Street(Path)", 2.8),
        (120.0, "Street(Motorway), width_m: 16", "Street(Main), width_m: 12", 4.6),
    ] {
        let plan = grown(&overpass(half_m, over, below));
        let spans: Vec<&WaySpan> = plan.spans.iter().collect();
        assert!(!spans.is_empty() && spans.iter().all(|span| span.id == Id(12)), "{over} over {below}");
        prove(&plan, &spans);
        let height = |x: f64, y: f64| plan.terrain.height_m(DVec2::new(x, y));
        let deck = spans.iter().find_map(|span| span.height_m(DVec2::ZERO)).expect("a bridge over the middle");
        assert!(deck - height(0.0, 0.0) >= clear_m + 0.5, "{over} over {below}: {deck}");
        // What passes below stays on its level, and so does the city.
        for (x, y) in [(0.0, 0.0), (0.0, 60.0), (0.0, -199.0), (60.0, 60.0), (-120.0, -80.0)] {
            assert!(height(x, y).abs() < 0.05, "{over} over {below}: {} at {x}, {y}", height(x, y));
        }
        // The way up is steady, on both streets.
        let ends = [-half_m, half_m].map(|x| height(x, 0.0));
        let grade = if over.starts_with("Railway") { 0.03 } else { 0.08 };
        for i in 0..100 {
            let (x, t) = (-half_m - f64::from(i), f64::from(i));
            assert!((height(x - 1.0, 0.0) - height(x, 0.0)).abs() < grade, "{over} over {below} at {x}");
            assert!((height(-half_m, t + 1.0) - height(-half_m, t)).abs() < 0.14, "{over} over {below}, {t} m aside");
        }
        if half_m > 100.0 {
            assert!(ends.iter().all(|end| *end < 2.0), "a long bridge rises by itself: {ends:?}");
        }
    }
}

/// The ground of a terrain that rises eastwards by so much a metre, and has a valley so deep along a line to the north at x = 0.
fn rising(by: f64, valley_m: f64) -> Terrain {
    let (posts, step_m) = (121, 5.0);
    let x = |i: usize| (i % posts) as f64 * step_m - 300.0;
    let depth = |x: f64| valley_m * (2.0 - x.abs() / 15.0).clamp(0.0, 1.0);
    let heights_m = (0..posts * posts).map(|i| 50.0 + by * x(i) - depth(x(i))).collect();
    Terrain { origin: DVec2::splat(-300.0), step_m, columns: posts as u32, heights_m }
}

/// The bridge in pieces, some of them drawn backwards.
fn in_pieces(graph: &mut CityGraph, count: u64) {
    let bridge = graph.links.remove(1);
    let at = |graph: &CityGraph, id: Id| *graph.nodes.iter().find(|node| node.id == id).expect("a node");
    let (from, to) = (at(graph, bridge.from), at(graph, bridge.to));
    let mut last = from.id;
    for i in 1..=count {
        let next = if i == count { to.id } else { Id(100 + i) };
        if i < count {
            let pos = from.pos.lerp(to.pos, i as f64 / count as f64);
            graph.nodes.push(veduta_city::Node { id: next, pos, ..from });
        }
        let (from, to) = if i % 2 == 0 { (next, last) } else { (last, next) };
        graph.links.push(veduta_city::Link { from, to, id: Id(200 + i), ..bridge.clone() });
        last = next;
    }
}

#[test]
fn overpasses_on_slopes_and_over_valleys_clear_what_passes_below() {
    for (half_m, by, valley_m, count) in [
        (30.0, 0.06, 0.0, 1),
        (60.0, 0.03, 0.0, 3),
        (120.0, 0.02, 0.0, 2),
        (40.0, 0.0, 9.0, 2),
        (40.0, 0.0, 2.0, 1),
        (30.0, -0.05, 1.0, 4),
    ] {
        let mut graph = overpass(half_m, "Street(Main), width_m: 12", "Street(Street)");
        in_pieces(&mut graph, count);
        graph.terrain = Some(rising(by, valley_m));
        let plan = grown(&graph);
        let spans: Vec<&WaySpan> = plan.spans.iter().collect();
        assert!(!spans.is_empty(), "{half_m} {by} {valley_m} {count}");
        prove(&plan, &spans);
        let deck = spans.iter().find_map(|span| span.height_m(DVec2::ZERO)).expect("a bridge over the middle");
        let above = deck - plan.terrain.height_m(DVec2::ZERO);
        let most = valley_m.max(5.7) + 2.5;
        assert!((5.2..most).contains(&above), "{half_m} {by} {valley_m} {count}: {above}");
    }
}

#[test]
fn trams_go_over_a_bridge_with_their_street() {
    let mut graph = overpass(15.0, "Street(Main), width_m: 12", "Railway(tram: false), width_m: 9");
    let deck = |graph: &CityGraph| grown(graph).spans.iter().find_map(|span| span.height_m(DVec2::ZERO)).expect("a bridge");
    let without = deck(&graph);
    for (id, from, to, layer) in [(61, 1, 2, 0), (62, 2, 3, 1), (63, 3, 4, 0)] {
        let kind = veduta_city::LinkKind::Railway { tram: true };
        let tram = veduta_city::Link { id: Id(id), from: Id(from), to: Id(to), kind, layer, ..graph.links[0].clone() };
        graph.links.push(tram);
    }
    let with = deck(&graph);
    assert!((with - without).abs() < 0.05, "{without} m without trams, {with} m with them");
}

/// A bridge over a railway from which another parts so far beyond its middle line.
fn parting(east_m: f64) -> CityGraph {
    let mut graph = overpass(60.0, "Street(Main), width_m: 12", "Railway(tram: false), width_m: 9");
    in_pieces(&mut graph, 2);
    let ramp = "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 31, pos: (55, -30)), (id: 32, pos: (200, -60)), (id: 101, pos: (0, 0))],
        links: [(id: 41, from: 101, to: 31, kind: Street(Street), layer: 1), (id: 42, from: 31, to: 32, kind: Street(Street))])";
    let ramp: CityGraph = file::parse(ramp, "ramp").unwrap_or_else(|e| panic!("{e}"));
    graph.nodes.iter_mut().filter(|node| node.id == Id(101)).for_each(|node| node.pos = DVec2::new(east_m, 0.0));
    graph.nodes.extend(ramp.nodes.into_iter().filter(|node| node.id != Id(101)));
    graph.links.extend(ramp.links);
    graph
}

#[test]
fn a_bridge_that_parts_over_what_it_crosses_clears_it() {
    let plan = grown(&parting(3.0));
    let deck = plan.spans.iter().find_map(|span| span.height_m(DVec2::ZERO)).expect("a bridge over the rails");
    assert!(deck - plan.terrain.height_m(DVec2::ZERO) > 5.7, "{deck}");
}

#[test]
fn where_bridges_part_in_the_air_they_stand_on_piers() {
    let plan = grown(&parting(15.0));
    let part = DVec2::new(15.0, 0.0);
    assert!(plan.terrain.height_m(part).abs() < 0.1, "a mound under the bridges: {}", plan.terrain.height_m(part));
    let heights: Vec<f64> = plan.spans.iter().filter_map(|span| span.height_m(part)).collect();
    assert!(heights.len() == 3 && heights.iter().all(|h| *h > 5.0 && (h - heights[0]).abs() < 0.15), "{heights:?}");
    let is_near = |station: &veduta_city::SpanStation| station.at(0.0).distance(part) < 2.0;
    let ends = plan.spans.iter().filter(|span| span.stations.last().is_some_and(is_near));
    let (on_piers, cut): (Vec<&WaySpan>, Vec<&WaySpan>) =
        ends.partition(|span| span.piers.1.is_some_and(|foot| metres(foot) < 0.0));
    assert!(!on_piers.is_empty());
    // What ends without a pier is cut there, and goes on.
    let goes_on = |span: &&WaySpan| plan.spans.iter().any(|other| other.stations.first() == span.stations.last());
    assert!(cut.iter().all(goes_on));
}

#[test]
fn no_parapet_crosses_the_lanes_of_another_bridge() {
    for (east_m, side) in [(15.0, 1.0), (15.0, -1.0), (3.0, 1.0), (-10.0, 1.0)] {
        let mut graph = parting(east_m);
        graph.nodes.iter_mut().filter(|node| [Id(31), Id(32)].contains(&node.id)).for_each(|node| node.pos.y *= side);
        let plan = grown(&graph);
        let (ramp, road): (Vec<&WaySpan>, Vec<&WaySpan>) = plan.spans.iter().partition(|span| span.id == Id(41));
        assert!(!ramp.is_empty() && !road.is_empty());
        let is_on = |others: &[&WaySpan], p: DVec2, z: f64| {
            others.iter().any(|other| other.height_m(p).is_some_and(|height| (height - z).abs() < 0.5))
        };
        // Well inside: so is all that is near.
        let is_inside = |others: &[&WaySpan], p: DVec2, z: f64| {
            (0..8).all(|i| is_on(others, p + DVec2::from_angle(f64::from(i) * core::f64::consts::FRAC_PI_4) * 0.9, z))
        };
        let mut open = 0;
        for (own, others) in [(&ramp, &road), (&road, &ramp)] {
            for span in own {
                for (side, has_parapet) in [(1.0, span.parapets.0), (-1.0, span.parapets.1)] {
                    open += usize::from(!has_parapet);
                    for pair in span.stations.windows(2).filter(|_| has_parapet) {
                        for k in 0..=20 {
                            let edge = |station: &veduta_city::SpanStation| station.at(side * (station.half_m() + 0.15));
                            let p = edge(&pair[0]).lerp(edge(&pair[1]), f64::from(k) / 20.0);
                            let z = metres(pair[0].z) + metres(pair[1].z - pair[0].z) * f64::from(k) / 20.0;
                            assert!(!is_inside(others, p, z), "{east_m}: a parapet of {} across another bridge at {p}", span.id);
                        }
                    }
                }
            }
        }
        assert!(open >= 2, "{east_m}: both are open where they part");
        let shell = CellShell {
            terrain: plan.terrain.clone(),
            ground: plan.ground.clone(),
            spans: plan.spans.clone(),
            drawn_spans: plan.spans.len() as u32,
            ..CellShell::default()
        };
        assert_eq!(mesh::spans(&shell).validate(), Ok(()));
    }
}

#[test]
fn bridges_that_cannot_fly_make_no_dams() {
    // Too short for a span, without room beside the path, and bent where there would have to be a span.
    for (half_m, width, via) in [(1.8, 6, ""), (1.8, 6, "(0, 3)"), (8.0, 20, "(0, 8)"), (8.0, 6, "(0, 8)"), (1.8, 6, "(0, 40)")] {
        let mut graph = overpass(half_m, "Street(Street)", "Street(Path)");
        let link = format!("(id: 12, from: 2, to: 3, kind: Street(Street), layer: 1, width_m: {width}, via: [{via}])");
        let text = format!(
            "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 2, pos: (0, 0)), (id: 3, pos: (1, 1))], links: [{link}])"
        );
        let bent: CityGraph = file::parse(&text, "bent").unwrap_or_else(|e| panic!("{e}"));
        graph.links[1] = bent.links[0].clone();
        let plan = grown(&graph);
        for y in [-60.0, -30.0, -3.0, 3.0, 8.0, 20.0, 80.0] {
            let height = plan.terrain.height_m(DVec2::new(0.0, y));
            assert!(height.abs() < 0.25, "{half_m} {width} {via}: {height} m on the path at {y}");
        }
    }
}

#[test]
fn no_tree_grows_into_a_bridge() {
    let plan = grown(&overpass(30.0, "Street(Main), width_m: 16", "Street(Main), width_m: 18"));
    let trees: Vec<DVec2> = plan.objects.iter().filter(|o| o.kind.is_tree()).map(|o| o.pos.to_metres()).collect();
    let is_under = |p: DVec2| plan.spans.iter().any(|span| span.height_m(p).is_some());
    assert!(trees.len() > 20, "{} trees along the streets", trees.len());
    assert!(trees.iter().all(|&p| !is_under(p) && !is_under(p + DVec2::new(0.0, 2.9)) && !is_under(p - DVec2::new(0.0, 2.9))));
    let lamps = plan.objects.iter().filter(|o| o.kind == ObjectKind::Lamp);
    assert!(lamps.filter(|o| o.pos.to_metres().length() < 60.0).count() > 3, "it is lit about the bridge");
}

#[test]
fn ways_over_ways_over_ways_clear_one_another() {
    let mut graph = overpass(40.0, "Street(Main), width_m: 12", "Railway(tram: false), width_m: 9");
    let more = "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 21, pos: (-60, -120)), (id: 22, pos: (-30, -60)), (id: 23, pos: (30, 60)), (id: 24, pos: (60, 120))],
        links: [(id: 31, from: 21, to: 22, kind: Street(Main)), (id: 32, from: 22, to: 23, kind: Street(Main), layer: 2), (id: 33, from: 23, to: 24, kind: Street(Main))])";
    let more: CityGraph = file::parse(more, "more").unwrap_or_else(|e| panic!("{e}"));
    graph.nodes.extend(more.nodes);
    graph.links.extend(more.links);
    let plan = grown(&graph);
    let deck = |plan: &CityPlan, id: u64| {
        plan.spans.iter().filter(|span| span.id == Id(id)).find_map(|span| span.height_m(DVec2::ZERO)).expect("a bridge")
    };
    assert!(deck(&plan, 12) > 5.9 && deck(&plan, 32) > deck(&plan, 12) + 5.0, "{} {}", deck(&plan, 12), deck(&plan, 32));
    // High above a valley, too.
    graph.terrain = Some(rising(0.0, 9.0));
    let plan = grown(&graph);
    assert!(deck(&plan, 32) > deck(&plan, 12) + 5.0, "{} {}", deck(&plan, 12), deck(&plan, 32));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_crossing_of_a_river_is_whole(
        (ax, ay, bx, by) in (-88.0..-50.0_f64, -90.0..90.0_f64, 50.0..88.0_f64, -90.0..90.0_f64),
        via in proptest::collection::vec((-40.0..40.0_f64, -60.0..60.0_f64), 0..3),
        width in 2.0..22.0_f64,
        (layer, class) in (0..2_i8, prop::sample::select(&["Street(Main)", "Street(Street)", "Street(Lane)", "Street(Path)", "Railway(tram: false)"][..])),
        is_back in any::<bool>(),
    ) {
        let mut via = via;
        via.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut from, mut to) = (1, 4);
        if is_back {
            via.reverse();
            (from, to) = (4, 1);
        }
        let mut graph = river(&format!("(id: 12, from: {from}, to: {to}, via: {via:?}, kind: {class}, width_m: {width}, layer: {layer})"));
        graph.nodes[0].pos = DVec2::new(ax, ay);
        graph.nodes[3].pos = DVec2::new(bx, by);
        let plan = grown(&graph);
        let reaches_over = plan.spans.iter().any(|span| span.stations.iter().any(|s| s.at(0.0).x.abs() < 20.0));
        prop_assert!(reaches_over, "it leads over the river");
        for run in plan.spans.chunk_by(|a, _| a.piers.1.is_some()) {
            prove(&plan, &run.iter().collect::<Vec<_>>());
        }
    }

    #[test]
    fn any_overpass_is_whole(
        half_m in 6.0..120.0_f64,
        turn in 0.4..2.7_f64,
        over in prop::sample::select(&["Street(Motorway), width_m: 20", "Street(Main)", "Street(Street)", "Street(Lane)", "Street(Path)", "Railway(tram: false), width_m: 9"][..]),
        below in prop::sample::select(&["Street(Main), width_m: 14", "Street(Street)", "Street(Path)", "Railway(tram: false), width_m: 9"][..]),
        (by, count) in (-0.04..0.04_f64, 1..5_u64),
        is_level in any::<bool>(),
    ) {
        let mut graph = overpass(half_m, over, below);
        in_pieces(&mut graph, count);
        graph.terrain = (!is_level).then(|| rising(by, 0.0));
        for (node, sign) in [(4, -1.0), (5, 1.0)] {
            graph.nodes[node].pos = DVec2::from_angle(turn) * 200.0 * sign;
        }
        let plan = grown(&graph);
        let deck = plan.spans.iter().find_map(|span| span.height_m(DVec2::ZERO));
        let needed = if below.starts_with("Railway") { 5.4 } else if below == "Street(Path)" { 2.8 } else { 4.6 };
        let above = deck.map(|deck| deck - plan.terrain.height_m(DVec2::ZERO));
        let has_room = half_m > 24.0 && (0.8..2.3).contains(&turn);
        prop_assert!(!has_room || above.is_some_and(|above| above > needed + 0.3), "{above:?} above {below}");
        for run in plan.spans.chunk_by(|a, _| a.piers.1.is_some()) {
            prove(&plan, &run.iter().collect::<Vec<_>>());
        }
    }
}
