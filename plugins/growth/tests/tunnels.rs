//! Tunnels: they come out at portals, keep under what stands above them, and leave the ground whole.

use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;
use veduta_city::{
    BoreEnd, CellShell, CityGraph, Finding, GridPolygon, GridPos, GroundPatch, Id, Link, LinkKind, MarkingKind, ObjectKind,
    PlanObject, SpanForm, StreetClass, SurfaceKind, Terrain, WaySpan, file, metres,
};
use veduta_growth::mesh;
use veduta_growth::plan::{Growth, Stock, grow};

/// A street from west to east, below the ground between x = -60 and 60, and a street across it at x = 0.
fn town(more: &str) -> CityGraph {
    let text = format!(
        "(name: \"Tunnel\", anchor: (lat: 50, lon: 14), seed: 3, margin_m: 40,
          nodes: [(id: 1, pos: (-220, 0)), (id: 2, pos: (-60, 0)), (id: 3, pos: (60, 0)), (id: 4, pos: (220, 0)),
            (id: 5, pos: (0, -120)), (id: 6, pos: (0, 120))],
          links: [(id: 11, from: 1, to: 2, kind: Street(Main), width_m: 12), (id: 12, from: 2, to: 3, kind: Street(Main), width_m: 12, layer: -1),
            (id: 13, from: 3, to: 4, kind: Street(Main), width_m: 12), (id: 14, from: 5, to: 6, kind: Street(Street), width_m: 9)]{more})"
    );
    file::parse(&text, "tunnel").unwrap_or_else(|e| panic!("{e}"))
}

/// Ground that rises to a ridge along x = 0, so high.
fn ridge(height_m: f64) -> String {
    let row = (0..61).map(|i| format!("{:.2}", height_m * (1.0 - (f64::from(i * 10 - 300) / 90.0).abs()).max(0.0)));
    let row = format!("[{}]", row.collect::<Vec<_>>().join(", "));
    format!(", terrain: (origin: (-300, -150), step_m: 10, rows_m: [{}])", vec![row; 31].join(", "))
}

fn grown(graph: &CityGraph) -> Growth {
    grow(graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}"))
}

fn dropped(growth: &Growth) -> Vec<&Finding> {
    growth.findings.iter().filter(|finding| finding.message.contains("tunnel")).collect()
}

fn is_bore(span: &&WaySpan) -> bool {
    span.is_bore()
}

fn patch_at(growth: &Growth, p: DVec2) -> &GroundPatch {
    let pos = GridPos::from_metres(p);
    growth.plan.ground.iter().find(|patch| patch.outline.contains(pos)).unwrap_or_else(|| panic!("nothing at {p}"))
}

/// A tunnel's spans follow one another from the ground to the ground, its bores lie deep enough, the ground is open above its ramps alone,
/// and its meshes are sound.
fn prove(growth: &Growth) {
    let plan = &growth.plan;
    let spans: Vec<&WaySpan> = plan.spans.iter().filter(|span| span.is_bore() || span.is_ramp()).collect();
    assert!(!spans.is_empty());
    for pair in spans.windows(2) {
        assert_eq!(pair[0].stations.last(), pair[1].stations.first());
    }
    for (span, station) in [(spans[0], 0), (spans[spans.len() - 1], spans[spans.len() - 1].stations.len() - 1)] {
        let station = span.stations[station];
        assert!(
            !span.is_ramp() || (metres(station.z) - plan.terrain.height_m(station.at(0.0))).abs() < 0.1,
            "it begins in the air"
        );
    }
    for span in &spans {
        for pair in span.stations.windows(2) {
            let slope = metres(pair[1].z - pair[0].z) / pair[0].at(0.0).distance(pair[1].at(0.0));
            assert!(slope.abs() < 0.24, "{slope}");
        }
        for station in &span.stations {
            for left in [-0.9, 0.0, 0.9] {
                let p = station.at(left * station.half_m());
                let cover = plan.terrain.height_m(p) - metres(station.z);
                match span.form {
                    SpanForm::Bore { crown, .. } => assert!(cover > metres(crown) + 1.0, "{cover} m at {p}"),
                    // It is as level across as the hillside is not.
                    _ => assert!(cover > -1.6, "a ramp in the air at {p}: {cover}"),
                }
            }
        }
        // Between its stations: at them it may end.
        let outline = span.outline();
        for pair in span.stations.windows(2) {
            for share in [0.2, 0.5, 0.8] {
                let p = pair[0].at(0.0).lerp(pair[1].at(0.0), share);
                let cover = plan.terrain.height_m(p) - span.height_m(p).expect("it leads there");
                let is_open = patch_at(growth, p).surface == SurfaceKind::Opening;
                assert!(outline.contains(GridPos::from_metres(p)));
                // A portal's wall stands over the end of the opening before it.
                let is_in_wall = pair.iter().any(|station| station.at(0.0).distance(p) < 0.3);
                assert!(
                    is_open == span.is_ramp() || is_in_wall || (span.is_ramp() && cover < 0.1),
                    "{p}: {:?}",
                    patch_at(growth, p).surface
                );
            }
        }
    }
    // Above bores, and beside ramps, the ground is as it was.
    let open: f64 = plan.ground.iter().filter(|p| p.surface == SurfaceKind::Opening).map(|p| p.outline.area_m2()).sum();
    let ramps: f64 = spans.iter().filter(|span| span.is_ramp()).map(|span| span.outline().area_m2()).sum();
    assert!(open < ramps * 1.5, "{open} m² are open above {ramps} m²");
    let shell = CellShell {
        terrain: plan.terrain.clone(),
        ground: plan.ground.clone(),
        spans: spans.iter().map(|&span| span.clone()).collect(),
        drawn_spans: spans.len() as u32,
        ..CellShell::default()
    };
    for drawn in [mesh::spans(&shell), mesh::ground(&shell)] {
        assert_eq!(drawn.validate(), Ok(()));
        for t in drawn.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from_array(drawn.positions[i as usize]).as_dvec3());
            let normal = Vec3::from_array(drawn.normals[t[0] as usize]).as_dvec3();
            // Corners are as exact as 32 bits.
            assert!((b - a).cross(c - a).dot(normal) > -1e-5, "{a} {b} {c} {normal}");
        }
    }
    let collision = mesh::collision(&shell);
    // Whoever is in a bore sees its lining all about.
    for (i, span) in spans.iter().enumerate().filter(|(_, span)| span.is_bore()) {
        let alone =
            CellShell { spans: vec![(*span).clone()], drawn_spans: 1, terrain: plan.terrain.clone(), ..CellShell::default() };
        let drawn = mesh::spans(&alone);
        let (a, b) = (span.stations[0], span.stations[1]);
        let eye = ((a.at(0.3) + b.at(0.3)) / 2.0).extend(metres(a.z + b.z) / 2.0 + 1.5);
        let left = (a.at(1.0) - a.at(0.0)).extend(0.0);
        for way in [left, -left, DVec3::Z, DVec3::NEG_Z] {
            assert!(is_seen(&drawn, eye, way), "bore {i} is open towards {way}");
        }
    }
    // One walks over it from side to side, but for the parapets of its portals.
    for pair in spans.iter().filter(|span| span.is_bore()).flat_map(|span| span.stations.windows(2)) {
        let beside = |left: f64| {
            let p = (pair[0].at(left) + pair[1].at(left)) / 2.0;
            p.extend(plan.terrain.height_m(p) + 1.0)
        };
        let half = pair[0].half_m().max(pair[1].half_m());
        let steps = [-half - 0.5, 0.0, half + 0.5].map(beside);
        assert!(!steps.windows(2).any(|step| is_shut(&collision.walls, step[0], step[1])), "a wall above it at {}", steps[1]);
    }
    // One walks through it from end to end, and nothing stands in the way.
    for span in &spans {
        for pair in span.stations.windows(2) {
            let p = (pair[0].at(0.3) + pair[1].at(0.3)) / 2.0;
            let height = span.height_m(p).expect("it leads there");
            let floors = collision.ground.triangles.iter().filter_map(|t| height_on(&collision.ground, *t, p));
            assert!(floors.into_iter().any(|floor| (floor - height).abs() < 0.4), "no floor at {p}");
            let [a, b] = [pair[0], pair[1]].map(|station| station.at(0.3).extend(metres(station.z) + 1.5));
            // It may end at a wall.
            assert!(!is_shut(&collision.walls, a, a.lerp(b, 0.98)), "a wall across it at {p}");
        }
    }
}

/// Whether what lies nearest in a direction from a place, heights last, shows its front.
fn is_seen(mesh: &mesh::MeshData, from: DVec3, way: DVec3) -> bool {
    let engine = |p: DVec3| DVec3::new(p.x, p.z, -p.y);
    let (from, way) = (engine(from), engine(way));
    let hit = |t: &[u32]| {
        let [p, q, r] = [t[0], t[1], t[2]].map(|i| Vec3::from_array(mesh.positions[i as usize]).as_dvec3());
        let (e, f, to) = (q - p, r - p, from - p);
        let across = way.cross(f);
        let turn = e.dot(across);
        let (u, v, s) = (to.dot(across) / turn, way.dot(to.cross(e)) / turn, f.dot(to.cross(e)) / turn);
        (turn.abs() > 1e-9 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && s > 0.0).then_some((s, turn > 0.0))
    };
    let nearest = mesh.indices.chunks_exact(3).filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.is_some_and(|(_, is_front)| is_front)
}

/// Height of a triangle of the ground over a place.
fn height_on(mesh: &mesh::Trimesh, triangle: [u32; 3], p: DVec2) -> Option<f64> {
    let at = triangle.map(|i| Vec3::from_array(mesh.positions[i as usize]).as_dvec3());
    let [a, b, c] = at.map(|q| DVec2::new(q.x, -q.z));
    let whole = (b - a).perp_dot(c - a);
    let [u, v, w] = [(b, c), (c, a), (a, b)].map(|(s, t)| (t - s).perp_dot(p - s) / whole);
    (whole > 1e-9 && [u, v, w].iter().all(|&share| share >= -1e-6)).then(|| u * at[0].y + v * at[1].y + w * at[2].y)
}

/// Whether a straight line between two places, with their heights, meets a wall.
fn is_shut(walls: &mesh::Trimesh, a: DVec3, b: DVec3) -> bool {
    let engine = |p: DVec3| DVec3::new(p.x, p.z, -p.y);
    let (from, way) = (engine(a), engine(b) - engine(a));
    walls.triangles.iter().any(|t| {
        let [p, q, r] = t.map(|i| Vec3::from_array(walls.positions[i as usize]).as_dvec3());
        let (e, f) = (q - p, r - p);
        let across = way.cross(f);
        let turn = e.dot(across);
        if turn.abs() < 1e-9 {
            return false;
        }
        let to = from - p;
        let u = to.dot(across) / turn;
        let v = way.dot(to.cross(e)) / turn;
        let s = f.dot(to.cross(e)) / turn;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&s)
    })
}

fn ends(growth: &Growth) -> Vec<(BoreEnd, BoreEnd)> {
    let of = |span: &WaySpan| match span.form {
        SpanForm::Bore { ends, .. } => Some(ends),
        _ => None,
    };
    growth.plan.spans.iter().filter_map(of).collect()
}

#[test]
fn a_street_dives_under_another_on_level_ground() {
    let growth = grown(&town(""));
    assert_eq!(dropped(&growth), Vec::<&Finding>::new());
    prove(&growth);
    let bores: Vec<&WaySpan> = growth.plan.spans.iter().filter(is_bore).collect();
    let all = ends(&growth);
    assert_eq!((all[0].0, all[all.len() - 1].1), (BoreEnd::Portal, BoreEnd::Portal));
    assert!(all.windows(2).all(|pair| (pair[0].1, pair[1].0) == (BoreEnd::Bore, BoreEnd::Bore)));
    // It comes out where the map says, and its ramps are as long as a tenth allows.
    let (first, last) = (bores[0].stations[0].at(0.0), bores[bores.len() - 1].stations.last().expect("stations").at(0.0));
    assert!((first.x + 60.0).abs() < 1.5 && (last.x - 60.0).abs() < 1.5, "{first} {last}");
    let tops = [growth.plan.spans[0].stations[0].at(0.0).x, growth.plan.spans.last().unwrap().stations.last().unwrap().at(0.0).x];
    assert!((55.0..75.0).contains(&(-60.0 - tops[0])) && (55.0..75.0).contains(&(tops[1] - 60.0)), "{tops:?}");
    // The street across is whole, lanes go on below, and nothing stands above the ramps.
    assert_eq!(patch_at(&growth, DVec2::new(0.0, 0.0)).surface, SurfaceKind::Asphalt);
    assert!(growth.plan.spans.iter().all(|span| span.markings.iter().any(|m| m.kind == MarkingKind::Dashes)));
    let openings: Vec<&GridPolygon> =
        growth.plan.ground.iter().filter(|p| p.surface == SurfaceKind::Opening).map(|p| &p.outline).collect();
    let over = |p: GridPos| openings.iter().any(|opening| opening.contains(p));
    assert!(growth.plan.markings.iter().all(|m| !m.line.iter().any(|&p| over(p))), "paint in the air");
    for object in growth.plan.objects.iter().filter(|object| over(object.pos)) {
        let floor = growth.plan.spans.iter().find_map(|span| span.height_m(object.pos.to_metres()));
        assert!(floor.is_some_and(|floor| (floor - metres(object.z)).abs() < 0.3), "{object:?}");
    }
    assert!(growth.plan.objects.iter().any(|object| over(object.pos) && object.kind == ObjectKind::Lamp), "its ramps are lit");
    // People find their way through it.
    assert!(growth.plan.streets.iter().any(|street| street.id == Id(12) && street.walkable));
}

#[test]
fn a_hill_is_pierced_level_and_its_ramps_are_short() {
    let growth = grown(&town(&ridge(25.0)));
    prove(&growth);
    let spans: Vec<&WaySpan> = growth.plan.spans.iter().filter(|span| span.is_bore() || span.is_ramp()).collect();
    let heights = spans.iter().flat_map(|span| &span.stations).map(|station| metres(station.z));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    assert!(high - low < 9.0, "it climbs the hill: {low} to {high}");
    let ramps: f64 = spans
        .iter()
        .filter(|span| span.is_ramp())
        .map(|span| span.stations[0].at(0.0).distance(span.stations[span.stations.len() - 1].at(0.0)))
        .sum();
    assert!(ramps < 70.0, "{ramps} m of ramps");
    // They begin where the street is level across, before the map lets go of the ground.
    let top = spans[0].stations[0];
    assert!(top.at(0.0).x < -65.0, "{}", top.at(0.0));
    let sides = [top.left, top.right].map(|side| growth.plan.terrain.height_m(side.to_metres()));
    assert!((sides[0] - sides[1]).abs() < 0.05, "{sides:?}");
}

#[test]
fn a_tunnel_that_ends_below_the_ground_has_a_wall_there() {
    let mut graph = town("");
    graph.links.retain(|link| link.id != Id(13));
    let growth = grown(&graph);
    prove(&growth);
    let all = ends(&growth);
    assert_eq!((all[0].0, all[all.len() - 1].1), (BoreEnd::Portal, BoreEnd::Wall));
    assert_eq!(growth.plan.spans.iter().filter(|span| span.is_ramp()).count(), 3, "one ramp, of three spans");
    // It may end under a house, as ways into garages do.
    let house = ", buildings: [(id: 90, outline: [(20, -30), (90, -30), (90, 30), (20, 30)])]";
    let mut under = town(house);
    under.links.retain(|link| link.id != Id(13));
    let growth = grown(&under);
    prove(&growth);
    assert_eq!(dropped(&growth), Vec::<&Finding>::new());
    // And all of one that has no end on the ground is left out.
    graph.links.retain(|link| link.id != Id(11));
    let growth = grown(&graph);
    assert_eq!(growth.plan.spans, []);
    assert_eq!(dropped(&growth)[0].message, "tunnel: not laid, for all of it lies below the ground");
}

#[test]
fn rivers_are_tunnelled_under() {
    let river = ", blocks: [(id: 80, kind: Water, outline: [(-24, -150), (24, -150), (24, 150), (-24, 150)])]";
    let mut graph = town(river);
    graph.links.retain(|link| link.id != Id(14));
    let growth = grown(&graph);
    assert_eq!(dropped(&growth), Vec::<&Finding>::new());
    prove(&growth);
    let water = patch_at(&growth, DVec2::ZERO);
    let bed_m = metres(water.z) - 1.0;
    assert!(water.surface == SurfaceKind::Water && bed_m < -2.0, "{water:?}");
    let bore = growth.plan.spans.iter().filter(is_bore).find_map(|span| span.height_m(DVec2::ZERO)).expect("it leads there");
    assert!(bore + 5.0 < bed_m, "a bore at {bore} m under a bed at {bed_m}");
}

#[test]
fn trams_lie_in_the_tunnel_that_their_layer_says() {
    let rails = |layer: i8| {
        let mut graph = town("");
        let street = graph.links.iter().find(|link| link.id == Id(12)).expect("the tunnel").clone();
        graph.links.push(Link { id: Id(41), kind: LinkKind::Railway { tram: true }, layer, ..street });
        let growth = grown(&graph);
        let has_rails = |span: &WaySpan| span.markings.iter().any(|marking| marking.kind == MarkingKind::Rails);
        let below = growth.plan.spans.iter().filter(is_bore).filter(|span| has_rails(span)).count();
        let above = growth.plan.markings.iter().filter(|marking| marking.kind == MarkingKind::Rails).count();
        assert_eq!(dropped(&growth), Vec::<&Finding>::new());
        (below > 2, above > 2)
    };
    assert_eq!((rails(-1), rails(0)), ((true, false), (false, true)));
    // Without a tunnel below it a tram is told.
    let mut graph = town("");
    graph.links.retain(|link| link.id == Id(14) || link.id == Id(12));
    graph.links[0].kind = LinkKind::Railway { tram: true };
    assert_eq!(dropped(&grown(&graph))[0].message, "tram tunnel: not laid, for it lies below the ground");
}

#[test]
fn it_is_dark_far_from_the_portals() {
    let growth = grown(&town(""));
    let brightness = |is_inner: bool| {
        let of = |span: &&WaySpan| matches!(span.form, SpanForm::Bore { ends, .. } if (ends == (BoreEnd::Bore, BoreEnd::Bore)) == is_inner);
        let spans: Vec<WaySpan> = growth.plan.spans.iter().filter(is_bore).filter(of).cloned().collect();
        let drawn = mesh::spans(&CellShell { drawn_spans: spans.len() as u32, spans, ..CellShell::default() });
        // Of the carriageway, which is as bright everywhere else.
        let up = drawn.colours.iter().zip(&drawn.normals).filter(|(_, normal)| normal[1] > 0.99).map(|(colour, _)| colour[0]);
        up.fold((f32::INFINITY, 0.0_f32), |(least, most), red| (least.min(red), most.max(red)))
    };
    let ((_, outer), (inner, _)) = (brightness(false), brightness(true));
    assert!(outer > 0.9 && inner < 0.5 * outer, "{outer} {inner}");
}

#[test]
fn tunnels_that_cross_too_near_are_told() {
    let mut graph = town("");
    for link in &mut graph.links {
        link.kind = LinkKind::Street(StreetClass::Street);
    }
    let more = "(name: \"M\", anchor: (lat: 50, lon: 14),
        nodes: [(id: 25, pos: (-40, -220)), (id: 26, pos: (-40, -60)), (id: 27, pos: (40, 60)), (id: 28, pos: (40, 220))],
        links: [(id: 31, from: 25, to: 26, kind: Street(Street)), (id: 32, from: 26, to: 27, kind: Street(Street), layer: -2),
          (id: 33, from: 27, to: 28, kind: Street(Street))])";
    let more: CityGraph = file::parse(more, "more").unwrap_or_else(|e| panic!("{e}"));
    graph.nodes.extend(more.nodes);
    graph.links.extend(more.links);
    let growth = grown(&graph);
    prove(&growth);
    let told: Vec<(Id, &str)> = dropped(&growth).iter().map(|finding| (finding.id, finding.message.as_str())).collect();
    assert_eq!(told, [(Id(32), "tunnel: not laid, for another lies too near below or above")]);
}

#[test]
fn one_street_dives_twice() {
    let text = "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3, margin_m: 40,
        nodes: [(id: 1, pos: (-300, 0)), (id: 2, pos: (-140, 0)), (id: 3, pos: (-90, 0)), (id: 4, pos: (0, 0)), (id: 5, pos: (90, 0)),
          (id: 6, pos: (140, 0)), (id: 7, pos: (300, 0)), (id: 8, pos: (-115, -90)), (id: 9, pos: (-115, 90)), (id: 10, pos: (115, -90)), (id: 11, pos: (115, 90))],
        links: [(id: 21, from: 1, to: 2, kind: Street(Street)), (id: 22, from: 3, to: 2, kind: Street(Street), layer: -1),
          (id: 23, from: 3, to: 4, kind: Street(Street)), (id: 24, from: 5, to: 4, kind: Street(Street)), (id: 25, from: 5, to: 6, kind: Street(Street), layer: -1),
          (id: 26, from: 6, to: 7, kind: Street(Street)), (id: 27, from: 8, to: 9, kind: Street(Street)), (id: 28, from: 10, to: 11, kind: Street(Street))])";
    let growth = grown(&file::parse(text, "t").unwrap_or_else(|e| panic!("{e}")));
    assert_eq!(dropped(&growth), Vec::<&Finding>::new());
    assert_eq!(ends(&growth).iter().filter(|ends| ends.0 == BoreEnd::Portal).count(), 2);
    assert_eq!(patch_at(&growth, DVec2::new(0.0, 0.5)).surface, SurfaceKind::Asphalt, "between them it is on the ground");
}

#[test]
fn houses_above_are_tunnelled_under_and_none_is_built_on_a_ramp() {
    let house = ", buildings: [(id: 90, outline: [(-40, -12), (40, -12), (40, 14), (-40, 14)])],
        blocks: [(id: 80, outline: [(-190, -30), (-10, -30), (-10, 40), (-190, 40)])]";
    let growth = grown(&town(house));
    prove(&growth);
    assert!(growth.plan.houses.len() > 10);
    let open: Vec<GridPolygon> =
        growth.plan.ground.iter().filter(|p| p.surface == SurfaceKind::Opening).map(|p| p.outline.clone()).collect();
    for footprint in growth.plan.houses.iter().flat_map(|house| &house.volumes).map(|volume| &volume.footprint) {
        let inside = |p: DVec2| open.iter().any(|open| open.contains(GridPos::from_metres(p)));
        let centre = footprint.centroid();
        let middle = |pair: &[GridPos]| ((pair[0].to_metres() + pair[1].to_metres()) / 2.0).lerp(centre, 0.02);
        assert!(!footprint.outer.windows(2).any(|pair| inside(middle(pair))), "a house over a ramp: {footprint:?}");
    }
}

#[test]
fn railways_and_footways_have_tunnels_of_their_size() {
    for (kind, crown, length) in [("Railway(tram: false)", 5.5..6.2, 300.0), ("Street(Path)", 2.7..3.2, 120.0)] {
        let text = format!(
            "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3,
              nodes: [(id: 1, pos: (-{length}, 0)), (id: 2, pos: (-40, 0)), (id: 3, pos: (40, 3)), (id: 4, pos: ({length}, 0)),
                (id: 5, pos: (0, -120)), (id: 6, pos: (0, 120)), (id: 7, pos: (-{length}, 60)), (id: 8, pos: ({length}, 60))],
              links: [(id: 15, from: 7, to: 8, kind: Street(Street)), (id: 11, from: 1, to: 2, kind: {kind}, width_m: 4), (id: 12, from: 2, to: 3, kind: {kind}, width_m: 4, layer: -1),
                (id: 13, from: 3, to: 4, kind: {kind}, width_m: 4), (id: 14, from: 5, to: 6, kind: Street(Street), width_m: 9)])"
        );
        let growth = grown(&file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}")));
        prove(&growth);
        for span in growth.plan.spans.iter().filter(is_bore) {
            let SpanForm::Bore { crown: high, .. } = span.form else { panic!("a bore") };
            assert!(crown.contains(&metres(high)));
        }
    }
}

#[test]
fn what_grows_or_stands_beside_a_ramp_does_not_reach_over_it() {
    // A park all about a footway, with a tree where its ramp is and one on its wall.
    let text = "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3,
        nodes: [(id: 1, pos: (-90, 0)), (id: 2, pos: (-20, 0)), (id: 3, pos: (20, 0)), (id: 4, pos: (90, 0)), (id: 5, pos: (0, -90)),
          (id: 6, pos: (0, 90)), (id: 7, pos: (-90, 80)), (id: 8, pos: (-90, -80))],
        links: [(id: 11, from: 1, to: 2, kind: Street(Path), width_m: 3), (id: 12, from: 2, to: 3, kind: Street(Path), width_m: 3, layer: -1),
          (id: 13, from: 3, to: 4, kind: Street(Path), width_m: 3), (id: 14, from: 5, to: 6, kind: Street(Street)), (id: 15, from: 7, to: 8, kind: Street(Street))],
        objects: [(id: 70, kind: Tree, pos: (-30, 0)), (id: 71, kind: Tree, pos: (-32, 1.6)), (id: 72, kind: Fountain, pos: (-34, 0))],
        blocks: [(id: 80, kind: Park, outline: [(-86, -60), (-6, -60), (-6, 60), (-86, 60)])])";
    let mut graph: CityGraph = file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
    for seed in 1..9 {
        graph.seed = seed;
        let growth = grown(&graph);
        let trees: Vec<&PlanObject> = growth.plan.objects.iter().filter(|object| object.kind.is_tree()).collect();
        assert!(trees.len() > 20 && [70, 71].iter().all(|&id| trees.iter().any(|tree| tree.id == Id(id))));
        let ramps: Vec<&WaySpan> = growth.plan.spans.iter().filter(|span| span.is_ramp()).collect();
        for tree in trees {
            assert!(
                ramps.iter().all(|ramp| ramp.height_m(tree.pos.to_metres()).is_none_or(|z| z > -0.4)),
                "a tree in a ramp: {tree:?}"
            );
        }
        for object in
            growth.plan.objects.iter().filter(|object| object.kind != ObjectKind::Lamp && ![70, 71].contains(&object.id.0))
        {
            let p = object.pos.to_metres();
            let reaches = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].map(|way| p + way * 0.6);
            let is_over = reaches.iter().any(|&p| ramps.iter().any(|ramp| ramp.height_m(p).is_some_and(|z| z < -0.4)));
            assert!(object.id != Id(72) || !is_over, "a fountain in a ramp: {object:?}");
            assert!(!is_over || ramps.iter().any(|ramp| ramp.height_m(p).is_some()), "{object:?}");
        }
    }
}

#[test]
fn what_has_no_room_is_told_and_leaves_the_ground_alone() {
    // A street crosses 15 m before the tunnel, and what is crossed lies right at its mouth.
    let text = "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3,
        nodes: [(id: 1, pos: (-35, 0)), (id: 2, pos: (-20, 0)), (id: 3, pos: (20, 0)), (id: 4, pos: (220, 0)), (id: 5, pos: (-10, -90)),
          (id: 6, pos: (-10, 90)), (id: 7, pos: (-35, 80)), (id: 8, pos: (-35, -80))],
        links: [(id: 11, from: 1, to: 2, kind: Street(Street)), (id: 12, from: 2, to: 3, kind: Street(Street), layer: -1),
          (id: 13, from: 3, to: 4, kind: Street(Street)), (id: 14, from: 5, to: 6, kind: Street(Street)),
          (id: 15, from: 7, to: 1, kind: Street(Street)), (id: 16, from: 1, to: 8, kind: Street(Street)),
          (id: 17, from: 5, to: 8, kind: Watercourse, layer: -1), (id: 18, from: 6, to: 7, kind: Street(Path), layer: -1)])";
    let growth = grown(&file::parse(text, "t").unwrap_or_else(|e| panic!("{e}")));
    let told: Vec<(Id, &str)> = growth.findings.iter().map(|finding| (finding.id, finding.message.as_str())).collect();
    assert!(told.contains(&(Id(12), "tunnel: not laid, for its first ramp has no room")), "{told:?}");
    assert!(told.contains(&(Id(17), "covered watercourse: not laid, for it lies below the ground")), "{told:?}");
    assert_eq!(growth.plan.spans, []);
    assert!(growth.plan.ground.iter().all(|patch| patch.surface != SurfaceKind::Opening));
    assert!(
        growth.plan.streets.iter().all(|street| street.walkable != [12, 18].contains(&street.id.0)),
        "{:?}",
        growth.plan.streets
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_tunnel_is_whole(
        half_m in 8.0..110.0_f64,
        across_m in -0.9..0.9_f64,
        turn in 0.5..2.6_f64,
        (class, below) in (0..5_usize, prop::sample::select(&["Street(Main)", "Street(Path)", "Railway(tram: false)"][..])),
        width_m in 1.5..16.0_f64,
        bend in prop::collection::vec((-0.9..0.9_f64, -12.0..12.0_f64), 0..3),
        (ridge_m, slope) in (prop_oneof![Just(0.0), 2.0..40.0_f64], -0.05..0.05_f64),
        is_back in any::<bool>(),
    ) {
        let class = ["Street(Main)", "Street(Street)", "Street(Lane)", "Street(Path)", "Railway(tram: false)"][class];
        let mut via: Vec<(f64, f64)> = bend.into_iter().map(|(share, y)| (share * half_m, y)).collect();
        via.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut from, mut to) = (2, 3);
        if is_back {
            via.reverse();
            (from, to) = (3, 2);
        }
        let far = DVec2::from_angle(turn) * 130.0;
        let x = across_m * half_m;
        let text = format!(
            "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3, margin_m: 20,
              nodes: [(id: 1, pos: (-380, 0)), (id: 2, pos: (-{half_m}, 0)), (id: 3, pos: ({half_m}, 0)), (id: 4, pos: (380, 0)),
                (id: 5, pos: ({}, {})), (id: 6, pos: ({}, {})), (id: 7, pos: (-380, 140)), (id: 8, pos: (380, 140))],
              links: [(id: 11, from: 1, to: 2, kind: {class}, width_m: {width_m}), (id: 13, from: 4, to: 3, kind: {class}, width_m: {width_m}),
                (id: 12, from: {from}, to: {to}, via: {via:?}, kind: {class}, width_m: {width_m}, layer: -1),
                (id: 14, from: 5, to: 6, kind: {below}), (id: 15, from: 7, to: 8, kind: Street(Street))])",
            x - far.x, -far.y, x + far.x, far.y
        );
        let mut graph: CityGraph = file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"));
        let height = |i: usize| {
            let x = (i % 81) as f64 * 10.0 - 400.0;
            ridge_m * (1.0 - (x / (half_m + 20.0)).abs()).max(0.0) + x * slope
        };
        let heights_m = (0..81 * 41).map(height).collect();
        graph.terrain = (ridge_m > 0.0).then(|| Terrain { origin: DVec2::new(-400.0, -200.0), step_m: 10.0, columns: 81, heights_m });
        let growth = grown(&graph);
        let told = dropped(&growth);
        prop_assert!(told.len() < 2, "{told:?}");
        let is_laid = growth.plan.spans.iter().any(WaySpan::is_bore);
        prop_assert!(is_laid != told.iter().any(|finding| finding.id == Id(12)), "{told:?}");
        if is_laid {
            prove(&growth);
        } else {
            prop_assert!(growth.plan.ground.iter().all(|patch| patch.surface != SurfaceKind::Opening));
        }
        // Room for it is plain to see.
        let has_room = class != "Railway(tram: false)" && half_m > 40.0 && across_m.abs() < 0.4 && (1.0..2.1).contains(&turn) && via.is_empty();
        prop_assert!(!has_room || is_laid, "{told:?}");
    }
}
