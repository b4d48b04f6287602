//! Elevations for nodes that have none of their own, from those that have: as a rope hangs between its ends.

use std::collections::{BTreeMap, HashMap};

use veduta_city::{CityGraph, Id};

/// Links shorter than this count as this long, metres.
const SHORTEST_M: f64 = 0.5;
/// Elevations are found to this, metres.
const PRECISE_M: f64 = 1e-4;

/// Fills the elevations (one a node, in the graph's order) that are `None`: each becomes the mean of its neighbours along
/// links, weighted by how short those are, so that a bridge rises evenly from end to end. A group of nodes without any known
/// neighbour takes the elevation of the nearest node. `None` is left only if none was known at all.
pub(super) fn spread(graph: &CityGraph, heights: &mut [Option<f64>]) {
    let index: HashMap<Id, usize> = graph.nodes.iter().enumerate().map(|(i, n)| (n.id, i)).collect();
    let at = graph.node_positions();
    let mut near: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for link in &graph.links {
        let (Some(&a), Some(&b)) = (index.get(&link.from), index.get(&link.to)) else { continue };
        let Some(line) = graph.polyline(link, &at) else { continue };
        let length: f64 = line.windows(2).map(|w| if let &[p, q] = w { p.distance(q) } else { 0.0 }).sum();
        let weight = 1.0 / length.max(SHORTEST_M);
        for (from, to) in [(a, b), (b, a)] {
            if a != b && heights.get(from).is_some_and(Option::is_none) {
                near.entry(from).or_default().push((to, weight));
            }
        }
    }
    for group in groups(&near, heights) {
        let solved = solve(&group, &near, heights);
        for (&node, height) in group.iter().zip(solved.into_iter().flatten()) {
            if let Some(slot) = heights.get_mut(node) {
                *slot = Some(height);
            }
        }
    }
    take_nearest(graph, heights);
}

/// Nodes without elevation that hang together, each group in the graph's order.
fn groups(near: &BTreeMap<usize, Vec<(usize, f64)>>, heights: &[Option<f64>]) -> Vec<Vec<usize>> {
    let mut is_taken = vec![false; heights.len()];
    let mut out = Vec::new();
    for &start in near.keys() {
        let mut group = Vec::new();
        let mut open = vec![start];
        while let Some(node) = open.pop() {
            let is_new = is_taken.get_mut(node).is_some_and(|taken| !core::mem::replace(taken, true));
            if !is_new {
                continue;
            }
            group.push(node);
            let next = near.get(&node).into_iter().flatten().map(|&(to, _)| to);
            open.extend(next.filter(|&to| heights.get(to).is_some_and(Option::is_none)));
        }
        group.sort_unstable();
        out.extend((!group.is_empty()).then_some(group));
    }
    out
}

/// Elevations of a group by the method of conjugate gradients; `None` if no known node touches it.
fn solve(group: &[usize], near: &BTreeMap<usize, Vec<(usize, f64)>>, heights: &[Option<f64>]) -> Option<Vec<f64>> {
    let place: HashMap<usize, usize> = group.iter().enumerate().map(|(i, &node)| (node, i)).collect();
    let (mut inner, mut pull, mut sum) = (vec![Vec::new(); group.len()], vec![0.0; group.len()], vec![0.0; group.len()]);
    let (mut known, mut count) = (0.0, 0.0);
    for (i, node) in group.iter().enumerate() {
        for &(to, weight) in near.get(node).into_iter().flatten() {
            sum[i] += weight;
            match (place.get(&to), heights.get(to).copied().flatten()) {
                (Some(&j), _) => inner[i].push((j, weight)),
                (None, Some(height)) => {
                    pull[i] += weight * height;
                    (known, count) = (known + height, count + 1.0);
                }
                (None, None) => sum[i] -= weight,
            }
        }
    }
    if count == 0.0 {
        return None;
    }
    let times = |x: &[f64]| -> Vec<f64> {
        let row = |i: usize| sum[i] * x[i] - inner[i].iter().map(|&(j, w): &(usize, f64)| w * x[j]).sum::<f64>();
        (0..x.len()).map(row).collect()
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut x = vec![known / count; group.len()];
    let mut rest: Vec<f64> = pull.iter().zip(times(&x)).map(|(b, ax)| b - ax).collect();
    let eased = |rest: &[f64]| -> Vec<f64> { rest.iter().zip(&sum).map(|(r, s)| r / s.max(1e-12)).collect() };
    let mut way = eased(&rest);
    let mut energy = dot(&rest, &way);
    for _ in 0..4 * group.len() + 16 {
        let most = rest.iter().zip(&sum).map(|(r, s)| (r / s.max(1e-12)).abs()).fold(0.0, f64::max);
        let ahead = times(&way);
        let bend = dot(&way, &ahead);
        if most < PRECISE_M / group.len() as f64 || bend <= 0.0 {
            break;
        }
        let step = energy / bend;
        x.iter_mut().zip(&way).for_each(|(x, w)| *x += step * w);
        rest.iter_mut().zip(&ahead).for_each(|(r, a)| *r -= step * a);
        let next = eased(&rest);
        let new = dot(&rest, &next);
        let turn = new / energy;
        energy = new;
        way.iter_mut().zip(&next).for_each(|(w, n)| *w = n + turn * *w);
    }
    Some(x)
}

/// Nodes that no link joins to a known one take the elevation of the nearest that has one.
fn take_nearest(graph: &CityGraph, heights: &mut [Option<f64>]) {
    let known: Vec<_> = graph.nodes.iter().zip(&*heights).filter_map(|(n, h)| Some(([n.pos.x, n.pos.y], (*h)?))).collect();
    if known.is_empty() || known.len() == heights.len() {
        return;
    }
    let tree = rstar::RTree::bulk_load(known.iter().map(|&(p, h)| rstar::primitives::GeomWithData::new(p, h)).collect());
    for (node, height) in graph.nodes.iter().zip(heights) {
        if height.is_none() {
            *height = tree.nearest_neighbor(&[node.pos.x, node.pos.y]).map(|n| n.data);
        }
    }
}
