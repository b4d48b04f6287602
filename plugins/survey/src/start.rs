//! Where a visit begins.

use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{Building, CityGraph, Id, LinkKind, StreetClass, Viewpoint};

use crate::buildings::footprint_of;
use crate::objects::heading_deg;
use crate::polygon::Polygon;

/// The middle of the largest square, else the crossroads nearest to the middle of all, else a street's end; looking along
/// the nearest street.
pub(crate) fn start(graph: &CityGraph) -> Option<Viewpoint> {
    let at: HashMap<Id, DVec2> = graph.node_positions();
    let pos = middle_of_largest_square(graph).or_else(|| middlemost_node(graph))?;
    Some(Viewpoint { pos, heading_deg: heading_along_street(graph, &at, pos), ..Viewpoint::default() })
}

fn middle_of_largest_square(graph: &CityGraph) -> Option<DVec2> {
    let outlines = graph.squares.iter().map(|s| Polygon { outer: s.outline.clone(), holes: s.holes.clone() });
    let mut by_size: Vec<Polygon> = outlines.collect();
    by_size.sort_by(|a, b| b.area_m2().total_cmp(&a.area_m2()));
    by_size.iter().map(Polygon::inner_pos).find(|pos| !is_in_building(&graph.buildings, *pos))
}

fn is_in_building(buildings: &[Building], pos: DVec2) -> bool {
    buildings.iter().any(|b| b.min_height_m < 2.5 && footprint_of(b).contains(pos))
}

fn is_walkable_street(kind: LinkKind, layer: i8) -> bool {
    layer == 0 && matches!(kind, LinkKind::Street(class) if class != StreetClass::Motorway)
}

/// The crossroads nearest to the middle of all street nodes; of a map without crossroads, the nearest node.
fn middlemost_node(graph: &CityGraph) -> Option<DVec2> {
    let mut ends: HashMap<Id, usize> = HashMap::new();
    for link in graph.links.iter().filter(|l| is_walkable_street(l.kind, l.layer)) {
        *ends.entry(link.from).or_default() += 1;
        *ends.entry(link.to).or_default() += 1;
    }
    let streets: Vec<(DVec2, bool)> = graph.nodes.iter().filter_map(|n| ends.get(&n.id).map(|&count| (n.pos, count > 2))).collect();
    let middle = streets.iter().map(|s| s.0).sum::<DVec2>() / streets.len().max(1) as f64;
    let far = |s: &&(DVec2, bool)| (!s.1, s.0.distance_squared(middle));
    let nearest = streets.iter().min_by(|a, b| {
        let (a, b) = (far(a), far(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    // Houses without streets are looked at from beside the first.
    nearest.map(|s| s.0).or_else(|| {
        let (low, _) = footprint_of(graph.buildings.first()?).bounds();
        Some(low - DVec2::splat(5.0))
    })
}

/// Heading of the street piece nearest to a position, towards its longer side; towards the first house if there is none.
fn heading_along_street(graph: &CityGraph, at: &HashMap<Id, DVec2>, pos: DVec2) -> f64 {
    let mut best: Option<(f64, DVec2)> = None;
    for link in graph.links.iter().filter(|l| is_walkable_street(l.kind, l.layer)) {
        for pair in graph.polyline(link, at).unwrap_or_default().windows(2) {
            let &[a, b] = pair else { continue };
            let t = ((pos - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
            let away = a.lerp(b, t).distance(pos);
            if best.is_none_or(|(d, _)| away < d) {
                best = Some((away, if t < 0.5 { b - a } else { a - b }));
            }
        }
    }
    let towards_house = || graph.buildings.first().map(|b| footprint_of(b).inner_pos() - pos);
    best.map(|b| b.1).or_else(towards_house).map_or(0.0, heading_deg)
}
