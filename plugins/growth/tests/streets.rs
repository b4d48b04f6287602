//! Streets that never break: whatever the graph, the ground is a partition, and the streets' ground is whole.

mod ground_proof;

use glam::DVec2;
use ground_proof::{prove_mesh, prove_partition};
use proptest::prelude::*;
use veduta_city::{CityGraph, CityPlan, GridPos, GroundPatch, Id, Link, LinkKind, Node, StreetClass, SurfaceKind, WidthAt};
use veduta_growth::plan::{Stock, grow};

/// Read once for all graphs.
static STOCK: std::sync::LazyLock<Stock> = std::sync::LazyLock::new(Stock::new);

/// The patch at a position; `None` on a border.
fn patch_at(plan: &CityPlan, p: GridPos) -> Option<&GroundPatch> {
    plan.ground.iter().find(|patch| patch.outline.contains(p))
}

/// Nobody who walks along a street, in its middle or near its edges, leaves its ground.
fn prove_streets(graph: &CityGraph, plan: &CityPlan) {
    let at = graph.node_positions();
    for link in graph.links.iter().filter(|link| link.layer >= 0 && matches!(link.kind, LinkKind::Street(_))) {
        let line = graph.polyline(link, &at).unwrap_or_default();
        let length: f64 = line.windows(2).map(|e| e[0].distance(e[1])).sum();
        let mut gone = 0.0;
        for e in line.windows(2) {
            // Slivers may join what is beside them.
            if e[0].distance(e[1]) < 1.0 {
                gone += e[0].distance(e[1]);
                continue;
            }
            let aside = (e[1] - e[0]).normalize().perp();
            for share in [0.25, 0.5, 0.75] {
                let half = link.width_at((gone + e[0].distance(e[1]) * share) / length) / 2.0;
                let middle = e[0].lerp(e[1], share);
                // Bridges cut the corners of bends, and carry ways that run along their edges.
                let near = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|off| middle + aside * off);
                if near.iter().any(|&p| plan.spans.iter().any(|span| span.height_m(p).is_some())) {
                    continue;
                }
                // What lies nearer to an edge than this may join what is beside it, as slivers do.
                let edge = (0.9 * half).min(half - 0.2).max(0.0);
                for offset in [-edge, 0.0, edge] {
                    let p = GridPos::from_metres(middle + aside * offset);
                    let surface = patch_at(plan, p).map(|patch| patch.surface);
                    let is_street = !matches!(surface, None | Some(SurfaceKind::Yard | SurfaceKind::Grass | SurfaceKind::Water));
                    assert!(is_street, "{:?} at {p:?}, {offset} m from the middle of {link:?}", surface);
                }
            }
            gone += e[0].distance(e[1]);
        }
    }
}

fn check(graph: &CityGraph) {
    let growth = grow(graph, &STOCK).unwrap_or_else(|e| panic!("{e}"));
    prove_partition(&growth.plan);
    prove_streets(graph, &growth.plan);
    prove_mesh(&growth.plan);
}

fn link(id: u64, ends: (u64, u64), class: StreetClass, width_m: f64) -> Link {
    Link {
        id: Id(id),
        from: Id(ends.0),
        to: Id(ends.1),
        via: Vec::new(),
        kind: LinkKind::Street(class),
        width_m,
        profile: Vec::new(),
        name: String::new(),
        layer: 0,
        surfacing: None,
    }
}

fn graph(nodes: impl IntoIterator<Item = DVec2>, links: Vec<Link>) -> CityGraph {
    let nodes = nodes.into_iter().zip(1..).map(|(pos, id)| Node { id: Id(id), pos, z: 0.0 }).collect();
    CityGraph { nodes, links, seed: 1, margin_m: 20.0, ..CityGraph::default() }
}

fn class() -> impl Strategy<Value = StreetClass> {
    prop::sample::select(StreetClass::ALL.to_vec())
}

/// Three to eight streets that meet at angles of 15° and more, some of them joined by a ring.
fn crossing() -> impl Strategy<Value = CityGraph> {
    let arm = (1.0..10.0_f64, prop_oneof![0.01..3.0_f64, 5.0..70.0_f64], class(), 0.5..30.0_f64, any::<bool>());
    (prop::collection::vec(arm, 3..=8), 0.0..360.0_f64).prop_map(|(arms, turn)| {
        let spare = 360.0 - 15.0 * arms.len() as f64;
        let all: f64 = arms.iter().map(|arm| arm.0).sum();
        let mut angle = turn;
        let mut nodes = vec![DVec2::ZERO];
        let mut links = Vec::new();
        for (i, &(share, length, class, width_m, has_ring)) in arms.iter().enumerate() {
            angle += 15.0 + spare * share / all;
            nodes.push(DVec2::from_angle(angle.to_radians()) * length);
            let next = if i + 1 == arms.len() { 2 } else { i as u64 + 3 };
            links.push(link(100 + i as u64, (1, i as u64 + 2), class, width_m));
            if has_ring {
                links.push(link(200 + i as u64, (i as u64 + 2, next), class, width_m / 3.0 + 0.5));
            }
        }
        graph(nodes, links)
    })
}

/// Links of all kinds between nodes anywhere, with bends, over and under one another.
fn tangle() -> impl Strategy<Value = CityGraph> {
    let axis = || prop_oneof![(0..8_i32).prop_map(|v| f64::from(v) * 10.0), 0.0..80.0_f64];
    let pos = move || (axis(), axis()).prop_map(|(x, y)| DVec2::new(x, y));
    let kind = prop_oneof![
        8 => class().prop_map(LinkKind::Street),
        1 => any::<bool>().prop_map(|tram| LinkKind::Railway { tram }),
        1 => Just(LinkKind::Watercourse),
    ];
    let width = prop_oneof![3 => 0.5..40.0_f64, 1 => Just(0.0)];
    let profile = prop::collection::vec((0.0..1.0_f64, 0.5..20.0_f64), 0..3);
    let link = (0..7_u64, 0..7_u64, kind, width, prop::collection::vec(pos(), 0..4), -1..2_i8, profile);
    (prop::collection::vec(pos(), 7), prop::collection::vec(link, 1..10)).prop_map(|(nodes, links)| {
        let link = |(i, (from, to, kind, width_m, via, layer, profile)): (
            usize,
            (u64, u64, LinkKind, f64, Vec<DVec2>, i8, Vec<(f64, f64)>),
        )| {
            let mut profile: Vec<WidthAt> = profile.into_iter().map(|(share, width_m)| WidthAt { share, width_m }).collect();
            profile.sort_by(|a, b| a.share.total_cmp(&b.share));
            Link { kind, via, layer, profile, ..self::link(100 + i as u64, (from + 1, to + 1), StreetClass::Lane, width_m) }
        };
        graph(nodes, links.into_iter().enumerate().map(link).collect())
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 5_000, ..ProptestConfig::default() })]

    #[test]
    fn crossings_of_any_arms_are_whole(graph in crossing()) {
        check(&graph);
    }

    #[test]
    fn tangles_are_whole(graph in tangle()) {
        prop_assume!(graph.validate().is_empty());
        check(&graph);
    }
}
