//! Edits of squares and blocks.

use glam::DVec2;

use super::Target;
use super::network::{Outcome, drop_lone, length_m, new_node};
use super::target::{Found, cross, distance_to_border, distance_to_ring, find, is_inside, line_of};
use crate::ring_edges;
use crate::{CityGraph, Id, Link, LinkKind, Ring, Square};

/// Ends of cut streets closer than this are one node; metres.
const WELD_M: f64 = 0.5;
/// What lies this close to a square's border runs along it; metres.
const ALONG_M: f64 = 0.3;
/// Pieces of streets shorter than this outside a new square are left out; metres.
const SHORT_M: f64 = 1.0;

pub(super) fn find_block(graph: &CityGraph, target: &Target) -> Found {
    find("block", &graph.blocks, target, |b| (b.id, distance_to_ring(&b.outline, target.at)))
}

pub(super) fn find_square(graph: &CityGraph, target: &Target) -> Found {
    find("square", &graph.squares, target, |s| (s.id, distance_to_ring(&s.outline, target.at)))
}

/// Puts a square in: streets on the ground are cut at its border, and what runs inside goes.
pub(super) fn add_square(graph: &mut CityGraph, square: &Square) -> Outcome {
    let mut square = square.clone();
    if signed_area(&square.outline) < 0.0 {
        square.outline.reverse();
    }
    if square.id.is_given() && graph.squares.iter().any(|s| s.id == square.id) {
        return Err(format!("square {} is there already", square.id));
    }
    let at = graph.node_positions();
    let mut touched: Vec<Id> = Vec::new();
    let mut welds: Vec<(DVec2, Id)> = Vec::new();
    for link in core::mem::take(&mut graph.links) {
        let line = line_of(graph, &link, &at);
        if link.layer != 0 || !matches!(link.kind, LinkKind::Street(_)) || !comes_near(&line, &square.outline) {
            graph.links.push(link);
            continue;
        }
        touched.extend([link.from, link.to]);
        let mut id = Some(link.id);
        let length = length_m(&line).max(1e-9);
        for (begin, piece) in outside(&line, &square.outline) {
            let mut end = |graph: &mut CityGraph, p: DVec2| {
                let own = [(link.from, line.first()), (link.to, line.last())];
                if let Some((node, _)) = own.into_iter().find(|(_, q)| q.is_some_and(|q| q.distance(p) < 1e-6)) {
                    return node;
                }
                if let Some((_, node)) = welds.iter().find(|(q, _)| q.distance(p) < WELD_M) {
                    return *node;
                }
                let node = new_node(graph, Id::NONE, p, 0.0);
                welds.push((p, node));
                node
            };
            let (Some(&first), Some(&last)) = (piece.first(), piece.last()) else { continue };
            let (from, to) = (end(graph, first), end(graph, last));
            if from != to || piece.len() > 3 {
                let via = piece.get(1..piece.len() - 1).unwrap_or_default().to_vec();
                let mut rest = Link { id: id.take().unwrap_or(Id::NONE), from, to, via, ..link.clone() };
                rest.part_profile(begin / length, ((begin + length_m(&piece)) / length).min(1.0));
                graph.links.push(rest);
            }
        }
    }
    drop_lone(graph, &touched);
    graph.squares.push(square);
    Ok(Vec::new())
}

fn comes_near(line: &[DVec2], ring: &[DVec2]) -> bool {
    line.iter().any(|&p| is_inside(ring, p)) || line.windows(2).any(|w| ring_edges(ring).any(|e| cross((w[0], w[1]), e)))
}

/// The pieces of a line outside a ring, each at least a metre long, with how much of the line lies before them, metres.
fn outside(line: &[DVec2], ring: &[DVec2]) -> Vec<(f64, Vec<DVec2>)> {
    let mut pieces: Vec<(f64, Vec<DVec2>)> = Vec::new();
    let mut open: Vec<DVec2> = Vec::new();
    let (mut gone, mut begin) = (0.0, 0.0);
    for w in line.windows(2) {
        let &[a, b] = w else { continue };
        let mut cuts = vec![0.0, 1.0];
        cuts.extend(ring_edges(ring).filter_map(|(c, d)| meets(a, b, c, d)));
        cuts.sort_by(f64::total_cmp);
        for t in cuts.windows(2).filter(|t| t[1] - t[0] > 1e-9) {
            let (p, q) = (a.lerp(b, t[0]), a.lerp(b, t[1]));
            let middle = (p + q) / 2.0;
            if is_inside(ring, middle) || distance_to_border(ring, middle) < ALONG_M {
                pieces.push((begin, core::mem::take(&mut open)));
            } else {
                if open.is_empty() {
                    begin = gone + a.distance(p);
                    open.push(p);
                }
                open.push(q);
            }
        }
        gone += a.distance(b);
    }
    pieces.push((begin, open));
    pieces.into_iter().filter(|(_, piece)| length_m(piece) >= SHORT_M).collect()
}

/// Where the edge c–d cuts a–b, as a share of it.
fn meets(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<f64> {
    let (u, v) = (b - a, d - c);
    let den = u.perp_dot(v);
    if den == 0.0 {
        return None;
    }
    let (t, s) = ((c - a).perp_dot(v) / den, (c - a).perp_dot(u) / den);
    (t > 0.0 && t < 1.0 && (0.0..=1.0).contains(&s)).then_some(t)
}

/// Takes a square out; the streets that ended on it end there still.
pub(super) fn remove_square(graph: &mut CityGraph, target: &Target) -> Outcome {
    let (i, note) = find_square(graph, target)?;
    graph.squares.remove(i);
    Ok(note.into_iter().collect())
}

pub(super) fn remove_block(graph: &mut CityGraph, target: &Target) -> Outcome {
    let (i, note) = find_block(graph, target)?;
    graph.blocks.remove(i);
    Ok(note.into_iter().collect())
}

/// Cuts a courtyard out of a block.
pub(super) fn add_courtyard(graph: &mut CityGraph, target: &Target, ring: &Ring) -> Outcome {
    let (i, note) = find_block(graph, target)?;
    let block = &mut graph.blocks[i];
    let leaves = |outline: &[DVec2]| ring_edges(ring).any(|e| ring_edges(outline).any(|f| cross(e, f)));
    if leaves(&block.outline) || !ring.iter().all(|&p| is_inside(&block.outline, p)) {
        return Err(format!("the courtyard does not lie within block {}", block.id));
    }
    let meets_hole =
        |hole: &Ring| leaves(hole) || hole.iter().any(|&p| is_inside(ring, p)) || ring.iter().any(|&p| is_inside(hole, p));
    if block.holes.iter().any(meets_hole) {
        return Err(format!("the courtyard meets another of block {}", block.id));
    }
    let mut hole = ring.clone();
    if signed_area(&hole) > 0.0 {
        hole.reverse();
    }
    block.holes.push(hole);
    Ok(note.into_iter().collect())
}

/// Positive if counter-clockwise.
pub(super) fn signed_area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    ring_edges(ring).map(|(a, b)| (a - origin).perp_dot(b - origin)).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Finding, GraphOverrides, NodeKind, file};

    /// Two streets that cross at the origin, with a block in the north-east.
    fn edited(edits: &str) -> (CityGraph, Vec<Finding>) {
        let text = "(name: \"T\", anchor: (lat: 50, lon: 14),
            nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (50, 0)), (id: 3, pos: (0, 50)), (id: 4, pos: (-50, 0)), (id: 5, pos: (0, -50))],
            links: [(id: 12, from: 1, to: 2, kind: Street(Lane)), (id: 13, from: 1, to: 3, kind: Street(Lane)),
                    (id: 14, from: 4, to: 1, kind: Street(Lane)), (id: 15, from: 5, to: 1, kind: Street(Lane)),
                    (id: 16, from: 4, to: 2, kind: Railway(tram: false))],
            blocks: [(id: 21, outline: [(4, 4), (46, 4), (46, 46), (4, 46)])])";
        let mut graph: CityGraph = file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        let overrides: GraphOverrides = file::parse(&format!("(edits: [{edits}])"), "t").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(overrides.validate(), []);
        let findings = overrides.apply(&mut graph);
        graph.fill_ids();
        assert_eq!(graph.validate(), []);
        (graph, findings)
    }

    #[test]
    fn streets_end_on_a_drawn_square() {
        let (graph, findings) = edited("AddSquare((name: \"Market\", outline: [(-10, 10), (10, 10), (10, -10), (-10, -10)]))");
        assert_eq!(findings, []);
        assert!(signed_area(&graph.squares[0].outline) > 0.0);
        assert_eq!((graph.links.len(), graph.nodes.len()), (5, 8), "the crossroads went, four ends came; the railway stays whole");
        let at = graph.node_positions();
        for link in &graph.links[..4] {
            let ends = [link.from, link.to].map(|n| at[&n]);
            assert!((ends[0].distance(ends[1]) - 40.0).abs() < 1e-9 && (12..=15).contains(&link.id.0), "{link:?}");
        }
        assert_eq!(graph.node_kinds().values().filter(|k| **k == NodeKind::BlindAlley).count(), 6);
    }

    #[test]
    fn a_street_through_a_corner_is_left_in_two_pieces() {
        let (graph, _) = edited("AddSquare((outline: [(20, -8), (32, -8), (32, 8), (20, 8)]))");
        let pieces: Vec<&Link> = graph.links.iter().filter(|l| l.id == Id(12) || l.id.0 > 1 << 60).collect();
        assert_eq!((pieces.len(), graph.links.len()), (2, 6));
    }

    #[test]
    fn a_courtyard_lies_within_its_block() {
        let (graph, _) = edited("Courtyard(target: (at: (20, 20)), ring: [(15, 15), (35, 15), (35, 35), (15, 35)])");
        assert!(signed_area(&graph.blocks[0].holes[0]) < 0.0);
        let (graph, findings) = edited(
            "Courtyard(target: (at: (20, 20)), ring: [(15, 15), (35, 15), (35, 35), (15, 35)]),
             Courtyard(target: (at: (10, 10)), ring: [(20, 20), (25, 20), (25, 25)]),
             Courtyard(target: (at: (10, 10)), ring: [(40, 40), (60, 40), (60, 45)])",
        );
        assert_eq!(graph.blocks[0].holes.len(), 1);
        assert!(
            findings[0].message.contains("meets another") && findings[1].message.contains("does not lie within"),
            "{findings:?}"
        );
    }

    #[test]
    fn blocks_and_squares_come_and_go() {
        let (graph, findings) = edited(
            "AddBlock((id: 22, kind: Park, outline: [(-46, 4), (-4, 4), (-4, 46), (-46, 46)])),
             Block(target: (id: 22, at: (-20, 20)), kind: Monument, district: \"old_town\", name: \"Hill\"),
             RemoveBlock((at: (20, 20))),
             AddSquare((id: 7, outline: [(60, 60), (70, 60), (70, 70)])), RemoveSquare((at: (68, 62))), RemoveSquare((at: (68, 62)))",
        );
        assert_eq!((graph.blocks.len(), graph.squares.len(), graph.blocks[0].name.as_str()), (1, 0, "Hill"));
        assert!(findings.len() == 1 && findings[0].message.starts_with("edit 6 (RemoveSquare): "), "{findings:?}");
    }
}
