//! That edits survive a new survey: whatever wobbles, each lands on the thing that it was written for, or is reported.

use std::collections::BTreeMap;

use glam::DVec2;
use proptest::prelude::*;

use super::{GraphOverride, GraphOverrides, Target};
use crate::draw::Draw;
use crate::{Block, BlockKind, CityGraph, Id, Link, LinkKind, Node, Severity, StreetClass};

/// Nodes of a town of crooked streets, some pairs of them one to five metres apart.
const SIDE: usize = 9;

fn spot(i: usize, draw: Draw) -> DVec2 {
    let draw = draw.part(i as u64);
    let (x, y) = ((i % SIDE) as f64, (i / SIDE) as f64);
    // Every fourth crossroads lies close to its eastern neighbour.
    let near = if i.is_multiple_of(4) { 33.0 } else { 0.0 };
    DVec2::new(x * 36.0 + near + draw.between("x", -0.8, 0.8), y * 36.0 + draw.between("y", -2.0, 2.0))
}

fn block(outline: Vec<DVec2>) -> Block {
    Block { id: Id::NONE, kind: BlockKind::Built, name: String::new(), district: String::new(), outline, holes: Vec::new() }
}

/// A town whose positions come from `at`, and whose links leave out those of `dropped`. What each link and block really is
/// stands in its name, so that it is known again whatever its id.
fn town(at: &dyn Fn(usize) -> DVec2, dropped: &dyn Fn(&str) -> bool) -> CityGraph {
    let mut graph = CityGraph::default();
    let id = |i: usize| Id::from_place("node", at(i));
    for i in 0..SIDE * SIDE {
        graph.nodes.push(Node { id: id(i), pos: at(i), z: i as f64 });
    }
    let mut link = |a: usize, b: usize| {
        let name = format!("{a}-{b}");
        if !dropped(&name) {
            let kind = LinkKind::Street(StreetClass::Lane);
            let (from, to) = (id(a), id(b));
            graph.links.push(Link {
                id: Id::NONE,
                from,
                to,
                via: Vec::new(),
                kind,
                width_m: 0.0,
                profile: Vec::new(),
                name,
                layer: 0,
                surfacing: None,
            });
        }
    };
    for i in 0..SIDE * SIDE {
        if i % SIDE + 1 < SIDE {
            link(i, i + 1);
        }
        if i / SIDE + 1 < SIDE {
            link(i, i + SIDE);
        }
    }
    for i in (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE + 1 < SIDE) {
        let corners = [i, i + 1, i + 1 + SIDE, i + SIDE];
        let middle = corners.iter().map(|&c| at(c)).sum::<DVec2>() / 4.0;
        let outline = corners.iter().map(|&c| at(c) + (middle - at(c)).normalize() * 4.0).collect();
        graph.blocks.push(Block { name: format!("block {i}"), ..block(outline) });
    }
    graph.fill_ids();
    graph
}

fn middle_of(graph: &CityGraph, link: &Link) -> DVec2 {
    let at = graph.node_positions();
    (at[&link.from] + at[&link.to]) / 2.0
}

/// What an edit did to a graph, told by the names that things had before: the widths, the moves, the districts set.
fn seen(before: &CityGraph, after: &CityGraph) -> Vec<String> {
    let mut out = Vec::new();
    let width =
        |g: &CityGraph| -> BTreeMap<String, u64> { g.links.iter().map(|l| (l.name.clone(), l.width_m.to_bits())).collect() };
    let (was, is) = (width(before), width(after));
    out.extend(is.iter().filter(|(name, w)| was.get(*name).is_some_and(|b| b != *w)).map(|(name, _)| format!("width of {name}")));
    let pos = |g: &CityGraph| -> BTreeMap<u64, DVec2> { g.nodes.iter().map(|n| (n.z as u64, n.pos)).collect() };
    let (was, is) = (pos(before), pos(after));
    out.extend(is.iter().filter(|(i, p)| was.get(i).is_some_and(|b| b != *p)).map(|(i, _)| format!("move of {i}")));
    let gone = width(after);
    out.extend(before.links.iter().filter(|l| !gone.contains_key(&l.name)).map(|l| format!("loss of {}", l.name)));
    for (b, a) in before.blocks.iter().zip(&after.blocks) {
        if b.district != a.district {
            out.push(format!("district of {}", a.name));
        }
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn an_edit_lands_on_its_thing_or_is_reported(
        seed in any::<u64>(), wobble in 0.0_f64..1.5, pick in 0_usize..60, has_id in any::<bool>(), is_lost in any::<bool>(),
    ) {
        let draw = Draw::new(seed, Id(1), "town");
        let first = town(&|i| spot(i, draw), &|_| false);
        let link = &first.links[pick * first.links.len() / 60];
        let node = &first.nodes[pick * first.nodes.len() / 60];
        let block = &first.blocks[pick];
        let target = |id: Id, at: DVec2| Target { id: if has_id { id } else { Id::NONE }, at };
        let edits = [
            (format!("width of {}", link.name), GraphOverride::Width { target: target(link.id, middle_of(&first, link)), width_m: 7.25 }),
            (format!("move of {}", node.z), GraphOverride::MoveNode { target: target(node.id, node.pos), to: node.pos + DVec2::new(12.0, 9.0) }),
            (format!("loss of {}", link.name), GraphOverride::RemoveLink(target(link.id, middle_of(&first, link)))),
            (
                format!("district of {}", block.name),
                GraphOverride::Block {
                    target: target(block.id, block.outline.iter().sum::<DVec2>() / 4.0), kind: None, district: Some("modern".into()), name: None,
                },
            ),
        ];
        // The new survey: everything elsewhere by up to `wobble`, one link in twenty gone, and the edits' own link if it is lost.
        // (A link of a few metres lies so near to those it met that it cannot be told from them when it is gone.)
        let is_long = middle_of(&first, link).distance(first.node_positions()[&link.from]) > 5.0;
        let moved = |i: usize| {
            let draw = draw.part(1000 + i as u64);
            let (turn, far) = (draw.between("turn", 0.0, core::f64::consts::TAU), wobble * libm::sqrt(draw.unit("far")));
            spot(i, Draw::new(seed, Id(1), "town")) + DVec2::new(libm::cos(turn), libm::sin(turn)) * far
        };
        let is_gone = |name: &str| if name == link.name { is_lost && is_long } else { Draw::new(seed, Id::from_place(name, DVec2::ZERO), "gone").chance("gone", 0.05) };
        let second = town(&moved, &is_gone);
        for (expected, edit) in edits {
            let mut after = second.clone();
            let findings = GraphOverrides { edits: vec![edit], ..GraphOverrides::default() }.apply(&mut after);
            let seen = seen(&second, &after);
            if findings.iter().any(|f| f.severity == Severity::Dropped) {
                prop_assert!(seen.is_empty(), "an edit that was reported as left out did {seen:?}");
            } else {
                prop_assert_eq!(seen, [expected]);
            }
        }
    }
}

#[test]
fn edits_with_room_about_them_are_found_again() {
    let draw = Draw::new(9, Id(1), "town");
    let first = town(&|i| spot(i, draw), &|_| false);
    let second = town(&|i| spot(i, draw) + DVec2::new(0.9, -1.1), &|_| false);
    let edits: Vec<GraphOverride> = first
        .links
        .iter()
        .map(|l| GraphOverride::Width { target: Target { id: l.id, at: middle_of(&first, l) }, width_m: 7.25 })
        .collect();
    let mut after = second.clone();
    let findings = GraphOverrides { edits, ..GraphOverrides::default() }.apply(&mut after);
    let hit = after.links.iter().filter(|l| l.width_m == 7.25).count();
    assert!(hit + findings.len() >= first.links.len() && hit * 10 > first.links.len() * 9, "{hit} of {}", first.links.len());
    let same = first.links.iter().zip(&second.links).filter(|(a, b)| a.id == b.id).count();
    assert!(same * 4 < first.links.len(), "the ids changed, so that the places found them: {same}");
}
