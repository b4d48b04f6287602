//! Edits of nodes and links.

use glam::DVec2;

use super::target::{cross, find_link, find_node, foot, line_of};
use super::{LinkEdit, Target};
use crate::{CityGraph, Id, Link, LinkKind, Node};

/// Nodes and ends closer than this would be one; metres.
const WELD_M: f64 = 0.5;

/// What an edit came to: done, with what is worth telling, or left out for a reason.
pub(super) type Outcome = Result<Vec<String>, String>;

fn told(note: Option<String>) -> Vec<String> {
    note.into_iter().collect()
}

/// Adds a node with an id of its place, unless one is given.
pub(super) fn new_node(graph: &mut CityGraph, id: Id, pos: DVec2, z: f64) -> Id {
    let mut id = if id.is_given() { id } else { Id::from_place("node", pos) };
    while graph.nodes.iter().any(|n| n.id == id) {
        id.0 = id.0.wrapping_add(1) | 1 << 63;
    }
    graph.nodes.push(Node { id, pos, z });
    id
}

fn links_at(graph: &CityGraph, node: Id) -> Vec<usize> {
    (0..graph.links.len()).filter(|&i| [graph.links[i].from, graph.links[i].to].contains(&node)).collect()
}

/// Takes out nodes of a list at which nothing ends any more.
pub(super) fn drop_lone(graph: &mut CityGraph, nodes: &[Id]) {
    let used = |id: Id| graph.links.iter().any(|l| l.from == id || l.to == id);
    let lone: Vec<Id> = nodes.iter().copied().filter(|&id| !used(id)).collect();
    graph.nodes.retain(|n| !lone.contains(&n.id));
}

/// Moves a node, and the ends of its links with it.
pub(super) fn move_node(graph: &mut CityGraph, target: &Target, to: DVec2) -> Outcome {
    let (i, note) = find_node(graph, target)?;
    let id = graph.nodes[i].id;
    if let Some(other) = graph.nodes.iter().find(|n| n.id != id && n.pos.distance(to) < WELD_M) {
        return Err(format!("node {} is there already: join the two instead", other.id));
    }
    let before = graph.nodes[i].pos;
    graph.nodes[i].pos = to;
    let links = links_at(graph, id);
    let at = graph.node_positions();
    let folded = links.iter().any(|&l| length_m(&line_of(graph, &graph.links[l], &at)) < WELD_M);
    if folded {
        graph.nodes[i].pos = before;
        return Err("a link would have no length".to_owned());
    }
    let crossings: Vec<String> = links.iter().filter_map(|&l| crossing_of(graph, l)).collect();
    Ok(told(note).into_iter().chain(crossings).collect())
}

/// Puts a node in; on a link it parts the link.
pub(super) fn add_node(graph: &mut CityGraph, id: Id, at: DVec2, z: f64) -> Outcome {
    if id.is_given() && graph.nodes.iter().any(|n| n.id == id) {
        return Err(format!("node {id} is there already"));
    }
    if let Some(near) = graph.nodes.iter().find(|n| n.pos.distance(at) < WELD_M) {
        return Err(format!("node {} is there already", near.id));
    }
    new_node(graph, id, at, z);
    Ok(Vec::new())
}

/// Takes a node out: a blind alley with its link, a joint of two links leaves one link, a crossroads stays.
pub(super) fn remove_node(graph: &mut CityGraph, target: &Target) -> Outcome {
    let (i, note) = find_node(graph, target)?;
    let id = graph.nodes[i].id;
    let links = links_at(graph, id);
    match links.as_slice() {
        [] => {
            graph.nodes.remove(i);
        }
        [only] => {
            let gone = graph.links.remove(*only);
            drop_lone(graph, &[gone.from, gone.to]);
        }
        &[a, b] => {
            let mut notes = told(note);
            notes.extend(merge(graph, id, a, b)?);
            return Ok(notes);
        }
        many => return Err(format!("{} links end at node {id}: remove links, or join it with another node", many.len())),
    }
    Ok(told(note))
}

/// Makes one link of two that meet at a node, which goes. It keeps the id and the nature of the longer.
fn merge(graph: &mut CityGraph, node: Id, a: usize, b: usize) -> Outcome {
    let at = graph.node_positions();
    let length = |l: usize| length_m(&line_of(graph, &graph.links[l], &at));
    let (keep, lose) = if length(a) >= length(b) { (a, b) } else { (b, a) };
    let mut one = graph.links[keep].clone();
    let other = graph.links[lose].clone();
    if one.from == node {
        one.via.reverse();
        one.reverse_profile();
        (one.from, one.to) = (one.to, one.from);
    }
    let (mut via, end) = (other.via.clone(), if other.from == node { other.to } else { other.from });
    if other.to == node {
        via.reverse();
    }
    one.via.extend(via);
    one.to = end;
    if one.from == one.to && one.via.len() < 2 {
        return Err("the two links there would be a loop without room".to_owned());
    }
    // A profile keeps the widths of both.
    let has_profile = !one.profile.is_empty() || !other.profile.is_empty();
    let nature = |l: &Link| (l.kind, l.width().to_bits() * u64::from(!has_profile), l.name.clone(), l.layer);
    let note =
        (nature(&one) != nature(&other)).then(|| format!("link {} takes over link {}, which differed from it", one.id, other.id));
    one.join_profile(length(keep), &other, length(lose), other.to == node);
    graph.links[keep] = one;
    graph.links.remove(lose);
    graph.nodes.retain(|n| n.id != node);
    Ok(told(note))
}

/// Makes one node of two: what ended at the second ends at the first. Links between them that fold up go.
pub(super) fn join_nodes(graph: &mut CityGraph, target: &Target, with: &Target) -> Outcome {
    let (i, note) = find_node(graph, target)?;
    let (j, other_note) = find_node(graph, with)?;
    if i == j {
        return Err("both ends of the edit are one node".to_owned());
    }
    let (keep, lose) = (graph.nodes[i].id, graph.nodes[j].id);
    for link in &mut graph.links {
        for end in [&mut link.from, &mut link.to] {
            if *end == lose {
                *end = keep;
            }
        }
    }
    graph.nodes.remove(j);
    let before = graph.links.len();
    graph.links.retain(|l| l.from != l.to || l.via.len() > 1);
    let folded = before - graph.links.len();
    let gone = (folded > 0).then(|| format!("{folded} links between the two nodes are gone"));
    Ok(note.into_iter().chain(other_note).chain(gone).collect())
}

/// Puts a link in. Its ends are nodes where there are any, part links that they lie on, and are new nodes otherwise.
pub(super) fn add_link(graph: &mut CityGraph, link: &LinkEdit) -> Outcome {
    let mut notes = Vec::new();
    if link.id.is_given() && graph.links.iter().any(|l| l.id == link.id) {
        return Err(format!("link {} is there already", link.id));
    }
    let before = (graph.nodes.clone(), graph.links.clone());
    let ends = ends_of(graph, link, &mut notes);
    let (from, to) = ends.inspect_err(|_| {
        // An end may have parted a link before the other turned out to be no good.
        (graph.nodes, graph.links) = before;
    })?;
    graph.links.push(Link {
        id: link.id,
        from,
        to,
        via: link.via.clone(),
        kind: link.kind,
        width_m: link.width_m,
        profile: Vec::new(),
        name: link.name.clone(),
        layer: link.layer,
        surfacing: link.surfacing,
    });
    notes.extend(crossing_of(graph, graph.links.len() - 1));
    Ok(notes)
}

fn ends_of(graph: &mut CityGraph, link: &LinkEdit, notes: &mut Vec<String>) -> Result<(Id, Id), String> {
    let from = end_of(graph, &link.from, notes)?;
    let to = end_of(graph, &link.to, notes)?;
    if from == to && link.via.len() < 2 {
        return Err(format!("both ends are node {from}: the link would have no length"));
    }
    Ok((from, to))
}

/// The node at an end of a new link.
fn end_of(graph: &mut CityGraph, target: &Target, notes: &mut Vec<String>) -> Result<Id, String> {
    match find_node(graph, target) {
        Ok((i, note)) => {
            notes.extend(note);
            return Ok(graph.nodes[i].id);
        }
        Err(reason) if !reason.starts_with("nothing") => return Err(reason),
        Err(_) if target.id.is_given() => notes.push(format!("node {} is gone: another takes its place", target.id)),
        Err(_) => {}
    }
    match find_link(graph, target) {
        Ok((i, _)) => part(graph, i, target.at),
        Err(reason) if !reason.starts_with("nothing") => Err(reason),
        Err(_) => Ok(new_node(graph, Id::NONE, target.at, 0.0)),
    }
}

/// Takes a link out, and the nodes at which nothing ends then.
pub(super) fn remove_link(graph: &mut CityGraph, target: &Target) -> Outcome {
    let (i, note) = find_link(graph, target)?;
    let gone = graph.links.remove(i);
    drop_lone(graph, &[gone.from, gone.to]);
    Ok(told(note))
}

/// Parts a link at the point of it that is nearest to the target's place.
pub(super) fn split_link(graph: &mut CityGraph, target: &Target) -> Outcome {
    let (i, note) = find_link(graph, target)?;
    part(graph, i, target.at)?;
    Ok(told(note))
}

/// Parts a link near a point: the first part keeps the id. Gives back the node between the parts.
fn part(graph: &mut CityGraph, i: usize, near: DVec2) -> Result<Id, String> {
    let at = graph.node_positions();
    let line = line_of(graph, &graph.links[i], &at);
    let piece = (0..line.len().saturating_sub(1)).min_by(|&m, &n| {
        let d = |k: usize| super::target::distance_to_edge(line[k], line[k + 1], near);
        d(m).total_cmp(&d(n))
    });
    let Some(k) = piece else { return Err("the link has no line".to_owned()) };
    let pos = line[k].lerp(line[k + 1], foot(line[k], line[k + 1], near));
    if line.first().is_some_and(|p| p.distance(pos) < WELD_M) || line.last().is_some_and(|p| p.distance(pos) < WELD_M) {
        return Err(format!("link {} ends there already", graph.links[i].id));
    }
    let z = |id: Id| graph.nodes.iter().find(|n| n.id == id).map_or(0.0, |n| n.z);
    let (first, second) = (line[..=k].to_vec(), line[k + 1..].to_vec());
    let gone = length_m(&first) + line[k].distance(pos);
    let share = gone / length_m(&line).max(1e-9);
    let height = z(graph.links[i].from) * (1.0 - share) + z(graph.links[i].to) * share;
    let node = new_node(graph, Id::NONE, pos, height);
    let apart = |p: &DVec2| p.distance(pos) > 1e-6;
    let mut rest = graph.links[i].clone();
    rest.id = Id::NONE;
    rest.from = node;
    rest.via = second[..second.len() - 1].iter().copied().filter(apart).collect();
    rest.part_profile(share, 1.0);
    let link = &mut graph.links[i];
    link.part_profile(0.0, share);
    link.to = node;
    link.via = first[1..].iter().copied().filter(apart).collect();
    graph.links.insert(i + 1, rest);
    Ok(node)
}

pub(super) fn length_m(line: &[DVec2]) -> f64 {
    line.windows(2).map(|e| e[0].distance(e[1])).sum()
}

/// That a street crosses another of its layer without a node, if it does.
fn crossing_of(graph: &CityGraph, i: usize) -> Option<String> {
    let at = graph.node_positions();
    let is_street = |l: &Link| matches!(l.kind, LinkKind::Street(_));
    let link = graph.links.get(i).filter(|l| is_street(l))?;
    let line = line_of(graph, link, &at);
    let others = graph.links.iter().enumerate().filter(|(j, l)| *j != i && is_street(l) && l.layer == link.layer);
    others.map(|(_, l)| l).find_map(|other| {
        let theirs = line_of(graph, other, &at);
        let meet = line.windows(2).any(|a| theirs.windows(2).any(|b| cross((a[0], a[1]), (b[0], b[1]))));
        meet.then(|| format!("link {} crosses link {} without a node: split both, or set a layer", link.id, other.id))
    })
}

#[cfg(test)]
mod tests {
    use crate::{CityGraph, Finding, GraphOverrides, Id, Severity, file};

    /// A cross of four lanes about node 1, each 50 m long.
    fn cross() -> CityGraph {
        let text = "(name: \"T\", anchor: (lat: 50, lon: 14),
            nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (50, 0)), (id: 3, pos: (0, 50)), (id: 4, pos: (-50, 0)), (id: 5, pos: (0, -50), z: 10)],
            links: [(id: 12, from: 1, to: 2, kind: Street(Lane), name: \"East\"), (id: 13, from: 1, to: 3, kind: Street(Lane)),
                    (id: 14, from: 1, to: 4, kind: Street(Lane)), (id: 15, from: 5, to: 1, kind: Street(Main), via: [(3, -25)])])";
        file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"))
    }

    fn edited(edits: &str) -> (CityGraph, Vec<Finding>) {
        let mut graph = cross();
        let overrides: GraphOverrides = file::parse(&format!("(edits: [{edits}])"), "t").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(overrides.validate(), []);
        let findings = overrides.apply(&mut graph);
        graph.fill_ids();
        assert_eq!(graph.validate(), []);
        (graph, findings)
    }

    fn refused(edits: &str, reason: &str) {
        let (graph, findings) = edited(edits);
        assert_eq!(graph, cross(), "{edits} leaves the graph as it was");
        let is_told = |f: &Finding| f.severity == Severity::Dropped && f.message.contains(reason) && f.plan_pos.is_some();
        assert!(findings.len() == 1 && is_told(&findings[0]), "{edits}: {findings:?}");
    }

    #[test]
    fn a_node_moves_with_its_links_but_not_onto_another() {
        let (graph, findings) = edited("MoveNode(target: (at: (50, 1)), to: (60, 5))");
        assert_eq!((graph.nodes[1].pos.x, graph.links[0].to, findings.len()), (60.0, Id(2), 0));
        refused("MoveNode(target: (at: (50, 0)), to: (0, 50.2))", "node 3 is there already");
        refused("MoveNode(target: (at: (90, 0)), to: (0, 9))", "no node within 5 m");
        let (_, findings) = edited("MoveNode(target: (id: 3, at: (0, 50)), to: (20, -20)), RemoveLink((at: (0, 90)))");
        assert_eq!(findings.len(), 1, "{findings:?}");
        let (_, findings) = edited("AddLink((from: (at: (40, 30)), to: (at: (40, -30)), kind: Street(Lane)))");
        assert!(findings.len() == 1 && findings[0].message.contains("crosses link 12 without a node"), "{findings:?}");
    }

    #[test]
    fn what_becomes_of_a_removed_nodes_links_depends_on_their_number() {
        refused("RemoveNode((id: 1, at: (0, 0)))", "4 links end at node 1");
        let (graph, _) = edited("RemoveNode((at: (50, 0)))");
        assert_eq!((graph.links.len(), graph.nodes.len()), (3, 4), "a blind alley goes with its link");
        let (graph, findings) = edited("RemoveLink((at: (0, 30))), RemoveLink((at: (-30, 0))), RemoveNode((at: (0, 0)))");
        assert_eq!((graph.links.len(), graph.nodes.len()), (1, 2));
        let link = &graph.links[0];
        assert_eq!((link.id, link.from, link.to, link.via.len()), (Id(15), Id(5), Id(2), 1));
        assert!(findings.len() == 1 && findings[0].message.contains("takes over link 12"), "{findings:?}");
    }

    #[test]
    fn a_split_link_keeps_its_id_in_its_first_part() {
        let (graph, _) = edited("SplitLink((at: (1.5, -30)))");
        assert_eq!((graph.links.len(), graph.nodes.len()), (5, 6));
        let (first, second) = (&graph.links[3], &graph.links[4]);
        assert!(first.id == Id(15) && first.to == second.from && second.to == Id(1), "{first:?} {second:?}");
        assert_eq!((first.via.len(), second.via.len()), (0, 1));
        assert!((5.5..6.5).contains(&graph.nodes[5].z), "its height lies between those of its ends: {}", graph.nodes[5].z);
        refused("SplitLink((id: 12, at: (50, 0.2)))", "ends there already");
    }

    #[test]
    fn a_new_link_takes_nodes_parts_links_or_makes_nodes() {
        let (graph, _) = edited("AddLink((from: (at: (50, 0)), to: (at: (0, 30)), kind: Street(Lane), name: \"Short cut\"))");
        assert_eq!((graph.links.len(), graph.nodes.len()), (6, 6), "the northern link was parted");
        let new = graph.links.last().expect("six links");
        assert!(new.from == Id(2) && graph.node_kinds()[&new.to] == crate::NodeKind::Crossroads && new.id.is_given());
        let (graph, _) = edited("AddLink((from: (at: (50, 0)), to: (at: (90, 30)), kind: Street(Path)))");
        assert_eq!((graph.links.len(), graph.nodes.len()), (5, 6));
        refused("AddLink((from: (at: (50, 0)), to: (at: (49, 0)), kind: Street(Path)))", "no length");
        refused("AddLink((from: (at: (0, 30)), to: (at: (0, 30.2)), kind: Street(Path)))", "no length");
        refused("AddLink((id: 12, from: (at: (50, 0)), to: (at: (9, 40)), kind: Street(Path)))", "link 12 is there already");
    }

    #[test]
    fn joined_nodes_are_one() {
        let (graph, _) = edited("JoinNodes(target: (at: (50, 0)), with: (at: (0, 50)))");
        assert_eq!((graph.links.len(), graph.nodes.len()), (4, 4));
        let (graph, findings) = edited("JoinNodes(target: (at: (0, 0)), with: (at: (50, 0)))");
        assert_eq!((graph.links.len(), graph.nodes.len(), findings.len()), (3, 4, 1));
        refused("JoinNodes(target: (at: (0, 0)), with: (at: (1, 0)))", "one node");
    }

    #[test]
    fn a_links_nature_can_be_set() {
        let (graph, findings) = edited(
            "Link(target: (at: (30, 0)), kind: Street(Main), width_m: 21, name: \"Broadway\", layer: 1, surfacing: Asphalt)",
        );
        let link = &graph.links[0];
        assert_eq!((link.width_m, link.name.as_str(), link.layer, findings.len()), (21.0, "Broadway", 1, 0));
        refused("Link(target: (at: (0.5, 0.5)), width_m: 3)", "two links lie there");
    }
}
