//! What every town keeps, whatever the words.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use proptest::prelude::*;
use veduta_city::Square;

use super::*;

fn words(plan: &str, size_m: f64, seed: u64, rest: &str) -> CityWords {
    let text = format!("(name: \"T\", seed: {seed}, size_m: {size_m:?}, plan: {plan}, {rest})");
    veduta_city::file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"))
}

fn made(words: &CityWords) -> CityGraph {
    survey_words(words).unwrap_or_else(|e| panic!("{e}: {words:?}")).graph
}

const PLANS: [&str; 7] = [
    "Medieval()",
    "Medieval(edge: Ring, crooked: 1)",
    "Medieval(edge: Open, crooked: 0.2)",
    "Radial()",
    "Grid()",
    "Mixed()",
    "Mixed(outside: Suburb)",
];
const RIVERS: [&str; 4] =
    ["", "river: (width_m: 14)", "river: (width_m: 40, passes: Centre, bends: 3)", "river: (passes: Edge, bends: 0)"];

/// A street's line, its half-width, its ends.
struct Street<'a> {
    link: &'a Link,
    line: Vec<DVec2>,
}

fn streets(graph: &CityGraph) -> Vec<Street<'_>> {
    let at = graph.node_positions();
    let is_street = |l: &&Link| matches!(l.kind, LinkKind::Street(_));
    graph.links.iter().filter(is_street).map(|link| Street { link, line: graph.polyline(link, &at).expect("nodes") }).collect()
}

fn touches(square: &Square, p: DVec2) -> bool {
    crate::polygon::edges(&square.outline).any(|(a, b)| fit::distance_to(p, a, b) < 0.02)
}

/// What is wrong with a town, in words; empty if nothing is.
fn flaws(graph: &CityGraph) -> Vec<String> {
    let mut out: Vec<String> = graph.validate().iter().map(ToString::to_string).collect();
    let streets = streets(graph);
    let least = if graph.nodes.len() > 30 { 5 } else { 2 };
    if streets.len() < 6 || graph.blocks.iter().filter(|b| b.kind == BlockKind::Built).count() < least {
        out.push(format!("{} streets, {} blocks", streets.len(), graph.blocks.len()));
    }
    close_streets(&streets, &mut out);
    sharp_corners(&streets, &mut out);
    loose_ends(graph, &streets, &mut out);
    bad_blocks(graph, &streets, &mut out);
    out
}

/// Streets that cross or run closer than their widths without sharing a node.
fn close_streets(streets: &[Street<'_>], out: &mut Vec<String>) {
    let mut tree = Vec::new();
    for (i, s) in streets.iter().enumerate() {
        for w in s.line.windows(2) {
            tree.push(rstar::primitives::GeomWithData::new(rstar::primitives::Line::new(w[0].to_array(), w[1].to_array()), i));
        }
    }
    let tree = rstar::RTree::bulk_load(tree);
    for (i, s) in streets.iter().enumerate() {
        for w in s.line.windows(2) {
            let (low, high) = (w[0].min(w[1]) - 30.0, w[0].max(w[1]) + 30.0);
            for other in tree.locate_in_envelope_intersecting(&rstar::AABB::from_corners(low.to_array(), high.to_array())) {
                let o = &streets[other.data];
                let shares = [o.link.from, o.link.to].iter().any(|n| [s.link.from, s.link.to].contains(n));
                if other.data <= i || shares {
                    continue;
                }
                let (c, d) = (DVec2::from_array(other.geom().from), DVec2::from_array(other.geom().to));
                let apart = fit::distance((w[0], w[1]), (c, d));
                let is_close = apart < (s.link.width() + o.link.width()) / 2.0;
                if is_close && (apart == 0.0 || !is_joined(streets, s, o)) {
                    out.push(format!("{} and {} are {apart:.1} m apart near {}", s.link.name, o.link.name, w[0]));
                }
            }
        }
    }
}

/// Whether a short street joins ends of two: the three are corners of one block, and how sharp those may be is looked at apart.
fn is_joined(streets: &[Street<'_>], a: &Street<'_>, b: &Street<'_>) -> bool {
    let near = 1.1 * (a.link.width() + b.link.width());
    let ends = |s: &Street<'_>| [s.link.from, s.link.to];
    let joins = |s: &&Street<'_>| {
        let [from, to] = ends(s);
        let (at_a, at_b) = (|n| ends(a).contains(&n), |n| ends(b).contains(&n));
        (at_a(from) && at_b(to)) || (at_a(to) && at_b(from))
    };
    streets.iter().filter(joins).any(|s| s.line.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>() < near)
}

/// Streets that leave a node at less than 28° to one another.
fn sharp_corners(streets: &[Street<'_>], out: &mut Vec<String>) {
    let mut leaving: BTreeMap<Id, Vec<DVec2>> = BTreeMap::new();
    for s in streets {
        let n = s.line.len();
        leaving.entry(s.link.from).or_default().push((s.line[1] - s.line[0]).normalize());
        leaving.entry(s.link.to).or_default().push((s.line[n - 2] - s.line[n - 1]).normalize());
    }
    for (node, dirs) in leaving {
        for (i, a) in dirs.iter().enumerate() {
            for b in &dirs[i + 1..] {
                if a.dot(*b) > 28.0_f64.to_radians().cos() {
                    out.push(format!("a sharp corner at {node}"));
                }
            }
        }
    }
}

/// Ends of streets that are neither on a square nor at the edge of the town, and streets that cannot be reached.
fn loose_ends(graph: &CityGraph, streets: &[Street<'_>], out: &mut Vec<String>) {
    let at: HashMap<Id, DVec2> = graph.node_positions();
    let mut around: BTreeMap<Id, Vec<Id>> = BTreeMap::new();
    for s in streets {
        around.entry(s.link.from).or_default().push(s.link.to);
        around.entry(s.link.to).or_default().push(s.link.from);
    }
    let mut hubs: Vec<Vec<Id>> = Vec::new();
    for square in &graph.squares {
        hubs.push(around.keys().copied().filter(|n| touches(square, at[n])).collect());
    }
    let reach = at.iter().filter(|(n, _)| around.contains_key(n)).map(|(_, p)| p.length()).fold(0.0, f64::max);
    for (node, next) in &around {
        let is_on_square = hubs.iter().any(|h| h.contains(node));
        if next.len() == 1 && !is_on_square && at[node].length() < 0.6 * reach {
            out.push(format!("a loose end at {}", at[node]));
        }
    }
    let Some(&first) = around.keys().next() else { return };
    let (mut seen, mut open) = (BTreeSet::from([first]), vec![first]);
    while let Some(n) = open.pop() {
        let across = hubs.iter().filter(|h| h.contains(&n)).flatten();
        for &m in around[&n].iter().chain(across) {
            if seen.insert(m) {
                open.push(m);
            }
        }
    }
    if seen.len() < around.len() {
        out.push(format!("{} of {} nodes cannot be reached", around.len() - seen.len(), around.len()));
    }
}

/// Blocks that are no simple outlines, or that a street runs through.
fn bad_blocks(graph: &CityGraph, streets: &[Street<'_>], out: &mut Vec<String>) {
    let inside = |ring: &[DVec2], p: DVec2| Polygon { outer: ring.to_vec(), holes: Vec::new() }.contains(p);
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    for block in &graph.blocks {
        if !crate::polygon::is_simple(&block.outline) || crate::polygon::signed_area(&block.outline) <= 0.0 {
            out.push(format!("a block at {} has no simple outline", block.outline[0]));
        }
        if block.kind == BlockKind::Water {
            continue;
        }
        let (low, high) = block.outline.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
        for s in streets {
            for w in s.line.windows(2) {
                let mid = (w[0] + w[1]) / 2.0;
                if mid.cmpge(low).all() && mid.cmple(high).all() && inside(&block.outline, mid) {
                    out.push(format!("{} runs through a block at {mid}", s.link.name));
                }
            }
        }
    }
    for square in &graph.squares {
        *names.entry(&square.name).or_default() += 1;
        for s in streets {
            let mid = s.line[s.line.len() / 2 - 1].lerp(s.line[s.line.len() / 2], 0.5);
            if inside(&square.outline, mid) && !touches(square, mid) {
                out.push(format!("{} runs through {}", s.link.name, square.name));
            }
        }
    }
    out.extend(names.iter().filter(|(_, n)| **n > 1).map(|(name, _)| format!("two squares are called {name}")));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn every_town_is_sound(
        plan in 0..PLANS.len(), river in 0..RIVERS.len(), seed in 0_u64..10_000, size in 200.0_f64..1_300.0, density in 0.1_f64..1.0,
        squares in 0_u32..4,
    ) {
        let rest = format!("density: {density:?}, squares: {squares}, {}", RIVERS[river]);
        let graph = made(&words(PLANS[plan], size.round(), seed, &rest));
        let flaws = flaws(&graph);
        prop_assert!(flaws.is_empty(), "{} {} seed {seed} size {size:.0} {rest}: {flaws:#?}", PLANS[plan], RIVERS[river]);
    }
}

#[test]
fn large_towns_are_sound_and_quickly_made() {
    for (n, plan) in PLANS.iter().enumerate() {
        for size in [2_400.0, 4_000.0] {
            let words = words(plan, size, n as u64, "squares: 6, river: (width_m: 90, bridges: 8)");
            let began = std::time::Instant::now();
            let graph = made(&words);
            let seconds = began.elapsed().as_secs_f64();
            println!("{plan} {size} m: {} links, {} blocks, {seconds:.2} s", graph.links.len(), graph.blocks.len());
            assert!(seconds < 60.0, "{plan} {size}: {seconds} s");
            let flaws = flaws(&graph);
            assert!(flaws.is_empty(), "{plan} {size}: {flaws:#?}");
        }
    }
}

#[test]
fn the_same_words_give_the_same_bytes_and_another_seed_others() {
    let text = |seed| veduta_city::file::to_text(&made(&words("Mixed()", 700.0, seed, RIVERS[2]))).expect("plain values");
    assert_eq!(text(4), text(4));
    assert_ne!(text(4), text(5));
}

#[test]
fn names_are_given_once() {
    let graph = made(&words("Medieval()", 900.0, 2, RIVERS[1]));
    let mut ends: BTreeMap<&str, BTreeSet<Id>> = BTreeMap::new();
    for s in streets(&graph).iter().filter(|s| s.link.layer == 0) {
        assert!(!s.link.name.is_empty());
        ends.entry(&s.link.name).or_default().extend([s.link.from, s.link.to]);
    }
    assert!(ends.len() > 60, "{} names", ends.len());
}

#[test]
fn a_river_is_bridged_above_the_water() {
    for plan in PLANS {
        let graph = made(&words(plan, 800.0, 11, "river: (width_m: 30, passes: Beside, bridges: 2, name: \"Wend\")"));
        let water = graph.blocks.iter().find(|b| b.kind == BlockKind::Water).expect("the river");
        assert_eq!(water.name, "Wend");
        let water = Polygon { outer: water.outline.clone(), holes: Vec::new() };
        let over: Vec<_> =
            streets(&graph).into_iter().filter(|s| s.line.windows(2).any(|w| water.contains((w[0] + w[1]) / 2.0))).collect();
        assert_eq!(over.len(), 2, "{plan}");
        assert!(over.iter().all(|s| s.link.layer == 1 && s.link.name.ends_with("Bridge")), "{plan}");
    }
}

#[test]
fn squares_parks_and_districts_are_those_asked_for() {
    let rest = "squares: 4, parks: 0.1, districts: [(name: \"Docks\", style: \"industrial\", share: 0.3, at: East), \
                (name: \"Rest\", style: \"modern\", share: 0.1)]";
    let graph = made(&words("Grid()", 1_400.0, 3, rest));
    assert_eq!(graph.squares.len(), 4);
    let area = |kind: BlockKind, district: &str| -> f64 {
        let of = graph.blocks.iter().filter(|b| b.kind == kind && b.district == district);
        of.map(|b| crate::polygon::signed_area(&b.outline)).sum()
    };
    let (docks, rest) = (area(BlockKind::Built, "industrial"), area(BlockKind::Built, "modern"));
    assert!((0.25..0.35).contains(&(docks / (docks + rest))), "{docks} of {}", docks + rest);
    let named: f64 = graph
        .blocks
        .iter()
        .filter(|b| b.kind == BlockKind::Park && !b.name.is_empty())
        .map(|b| crate::polygon::signed_area(&b.outline))
        .sum();
    assert!((0.05..0.16).contains(&(named / (docks + rest + named))), "{named}");
    let east = |style: &str| {
        let xs: Vec<f64> = graph.blocks.iter().filter(|b| b.district == style).map(|b| b.outline[0].x).collect();
        xs.iter().sum::<f64>() / xs.len() as f64
    };
    assert!(east("industrial") > east("modern") + 200.0);
}
