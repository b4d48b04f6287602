//! Ways joined to rings, rings nested to polygons: OSM's multipolygons
//! (<https://wiki.openstreetmap.org/wiki/Relation:multipolygon>).
//!
//! Ends are joined by place rather than by node, so that doubled nodes do not tear a ring. Nesting follows the even–odd rule,
//! which needs no roles: they are wrong too often. Where outer rings lie on each other (the same house drawn twice), even–odd
//! would leave almost nothing; then their union is taken, less the union of what is called inner.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use veduta_city::Ring;

use crate::extent::Extent;
use crate::osm::OsmData;
use crate::polygon::{Polygon, difference, even_odd, union};

/// An end this near to its own beginning closes a ring, in metres.
const CLOSE_GAP_M: f64 = 1.0;

/// A position in steps of 1e-7 degrees, as OSM stores it.
type Spot = (i64, i64);

/// One member way.
pub(crate) struct Piece<'a> {
    pub nodes: &'a [i64],
    pub is_inner: bool,
}

/// What came of joining.
#[derive(Debug, Default)]
pub(crate) struct Assembly {
    pub polygons: Vec<Polygon>,
    /// Whether rings had to be mended.
    pub is_mended: bool,
    /// Ends that found no other end.
    pub open: usize,
    /// Nodes that the file does not hold.
    pub missing: usize,
    /// Whether rings closed but all are too small to keep.
    pub is_tiny: bool,
}

/// Joins pieces to polygons, in plan metres. What cannot be closed is left out and counted.
pub(crate) fn assemble(pieces: &[Piece<'_>], data: &OsmData, extent: &Extent) -> Assembly {
    let mut out = Assembly::default();
    let mut positions: BTreeMap<Spot, DVec2> = BTreeMap::new();
    let mut paths: Vec<(Vec<Spot>, bool)> = Vec::new();
    for piece in pieces {
        let mut path: Vec<Spot> = Vec::with_capacity(piece.nodes.len());
        for id in piece.nodes {
            let Some(node) = data.nodes.get(id) else {
                out.missing += 1;
                continue;
            };
            let spot = (libm::round(node.lat * 1e7) as i64, libm::round(node.lon * 1e7) as i64);
            positions.entry(spot).or_insert_with(|| extent.plan_pos(node));
            if path.last() != Some(&spot) {
                path.push(spot);
            }
        }
        if path.len() >= 2 {
            paths.push((path, piece.is_inner));
        }
    }
    let n = paths.len();
    let mut seen = BTreeSet::new();
    paths.retain(|(path, _)| seen.insert(canonical(path)));
    out.is_mended |= paths.len() < n;

    let (rings, open) = join(&paths);
    let ring = |spots: &[Spot]| -> Ring { spots.iter().filter_map(|s| positions.get(s).copied()).collect() };
    let mut closed: Vec<(Ring, bool)> = rings.iter().map(|(spots, is_inner)| (ring(spots), *is_inner)).collect();
    for (spots, is_inner) in open {
        let points = ring(&spots);
        let is_near = points.first().zip(points.last()).is_some_and(|(a, b)| a.distance(*b) <= CLOSE_GAP_M);
        if is_near && points.len() > 3 && out.missing == 0 {
            out.is_mended = true;
            closed.push((points, is_inner));
        } else {
            out.open += 1;
        }
    }
    let all: Vec<Ring> = closed.iter().map(|(r, _)| r.clone()).collect();
    let (polygons, is_untouched) = even_odd(&all);
    out.is_mended |= !is_untouched;
    out.polygons = polygons;
    let size = |r: &Ring| crate::polygon::signed_area(r).abs();
    out.is_tiny = out.polygons.is_empty() && out.open == 0 && closed.iter().any(|(r, _)| size(r) > 0.0);
    if closed.len() > 1 {
        by_roles_if_stacked(&closed, &mut out);
    }
    out
}

/// Replaces the even–odd result by (union of outers) less (union of inners) where outers lie on each other.
fn by_roles_if_stacked(closed: &[(Ring, bool)], out: &mut Assembly) {
    let flat = |is_inner: bool| -> Vec<Polygon> {
        closed.iter().filter(|(_, i)| *i == is_inner).flat_map(|(r, _)| even_odd(core::slice::from_ref(r)).0).collect()
    };
    let (outers, inners) = (flat(false), flat(true));
    if outers.len() < 2 {
        return;
    }
    let by_roles = difference(&union(&outers), &union(&inners));
    let area = |all: &[Polygon]| all.iter().map(Polygon::area_m2).sum::<f64>();
    // A courtyard wrongly called outer also covers twice; only an almost complete loss shows doubled outers.
    if area(&out.polygons) < 0.2 * area(&by_roles) {
        out.polygons = by_roles;
        out.is_mended = true;
    }
}

/// One form for a path in either direction and, closed, from any beginning.
fn canonical(path: &[Spot]) -> Vec<Spot> {
    let is_closed = path.first() == path.last() && path.len() > 2;
    let forms = |mut p: Vec<Spot>| {
        if is_closed {
            p.pop();
            let least = p.iter().enumerate().min_by_key(|(_, s)| **s).map_or(0, |(i, _)| i);
            p.rotate_left(least);
        }
        p
    };
    let backward: Vec<Spot> = path.iter().rev().copied().collect();
    forms(path.to_vec()).min(forms(backward))
}

type Path = (Vec<Spot>, bool);

/// Walks along paths from end to end until back at the beginning; gives rings and what stayed open. Wherever an even number
/// of ends meets, no walk can get stuck, and any way to pair them encloses the same area by the even–odd rule.
fn join(paths: &[Path]) -> (Vec<Path>, Vec<Path>) {
    let mut ends: BTreeMap<Spot, Vec<usize>> = BTreeMap::new();
    for (i, (path, _)) in paths.iter().enumerate() {
        if let (Some(&first), Some(&last)) = (path.first(), path.last())
            && first != last
        {
            ends.entry(first).or_default().push(i);
            ends.entry(last).or_default().push(i);
        }
    }
    let mut used = vec![false; paths.len()];
    // Where an odd number of ends meets, walks begin: they cannot close anyway, and would tear rings if met half way.
    let is_odd = |path: &[Spot]| {
        let odd = |s: Option<&Spot>| s.and_then(|s| ends.get(s)).is_some_and(|e| e.len() % 2 == 1);
        odd(path.first()) || odd(path.last())
    };
    let mut order: Vec<usize> = (0..paths.len()).collect();
    order.sort_by_key(|&i| paths.get(i).is_none_or(|(p, _)| is_odd(p)));
    let (mut rings, mut open) = (Vec::new(), Vec::new());
    for start in order {
        if used.get(start).copied().unwrap_or(true) {
            continue;
        }
        let Some((path, is_inner)) = paths.get(start) else { continue };
        used[start] = true;
        let mut walk = path.clone();
        while walk.first() != walk.last() {
            let Some(end) = walk.last().copied() else { break };
            let free = ends.get(&end).into_iter().flatten().copied().find(|&i| !used.get(i).copied().unwrap_or(true));
            let Some((next, i)) = free.and_then(|i| paths.get(i).map(|(p, _)| (p, i))) else { break };
            used[i] = true;
            if next.first() == Some(&end) {
                walk.extend(next.iter().skip(1));
            } else {
                walk.extend(next.iter().rev().skip(1));
            }
        }
        let is_closed = walk.len() > 3 && walk.first() == walk.last();
        if is_closed { rings.push((walk, *is_inner)) } else { open.push((walk, *is_inner)) }
    }
    (rings, open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use crate::osm::Tags;

    /// Nodes 0.. on a grid of 10 by 10, about 111 m apart.
    fn grid() -> (OsmData, Extent) {
        let mut data = OsmData::default();
        for i in 0..100 {
            data.add_node(i, 0.001 * (i / 10) as f64, 0.001 * (i % 10) as f64, Tags::default());
        }
        let extent = Extent::of(&data, &mut Log::default()).unwrap();
        (data, extent)
    }

    fn assembled(ways: &[(&[i64], bool)]) -> Assembly {
        let (data, extent) = grid();
        let pieces: Vec<Piece<'_>> = ways.iter().map(|&(nodes, is_inner)| Piece { nodes, is_inner }).collect();
        assemble(&pieces, &data, &extent)
    }

    fn cells(assembly: &Assembly) -> f64 {
        assembly.polygons.iter().map(Polygon::area_m2).sum::<f64>() / (111.3195 * 110.5743)
    }

    #[test]
    fn two_halves_join_in_any_direction() {
        for second in [[2, 22, 20], [20, 22, 2]] {
            let out = assembled(&[(&[20, 0, 2], false), (&second, false)]);
            assert!((cells(&out) - 4.0).abs() < 0.01 && out.open == 0 && !out.is_mended, "{out:?}");
        }
    }

    #[test]
    fn inner_rings_are_holes_whatever_their_role() {
        for role in [true, false] {
            let out = assembled(&[(&[0, 5, 55, 50, 0], false), (&[11, 12, 22, 21, 11], role)]);
            assert_eq!((out.polygons.len(), out.polygons[0].holes.len()), (1, 1));
            assert!((cells(&out) - 24.0).abs() < 0.1);
        }
    }

    #[test]
    fn an_open_ring_is_counted_and_left_out() {
        let out = assembled(&[(&[0, 2, 22], false), (&[55, 57, 77, 75, 55], false)]);
        assert_eq!(out.open, 1);
        assert!((cells(&out) - 4.0).abs() < 0.01);
    }

    #[test]
    fn missing_nodes_are_counted() {
        let out = assembled(&[(&[0, 2, 1234, 22, 20, 0], false)]);
        assert_eq!(out.missing, 1);
    }

    #[test]
    fn a_doubled_outline_does_not_cancel_itself() {
        let same = assembled(&[(&[0, 2, 22, 20, 0], false), (&[22, 20, 0, 2, 22], false)]);
        assert!((cells(&same) - 4.0).abs() < 0.01 && same.is_mended);
        let nearly = assembled(&[(&[0, 5, 55, 50, 0], false), (&[0, 5, 55, 54, 50, 40, 0], false)]);
        assert!((cells(&nearly) - 25.0).abs() < 0.1, "{}", cells(&nearly));
    }

    /// Rings of a MULTIPOLYGON in WKT as pairs of longitude and latitude.
    fn wkt_rings(wkt: &str) -> Vec<Vec<(f64, f64)>> {
        let inner = wkt.trim_start_matches("MULTIPOLYGON");
        let rings = inner.split(['(', ')']).filter(|part| part.contains(char::is_numeric));
        rings
            .map(|ring| {
                let pairs = ring.split(',').filter(|p| !p.trim().is_empty());
                pairs.map(|p| p.trim().split_once(' ').map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).unwrap()).collect()
            })
            .collect()
    }

    /// The multipolygon cases of osmcode/osm-testdata against the areas that it expects, ends joined by location. Invalid
    /// cases may give anything but a panic; valid ones must give the same area.
    #[test]
    fn the_test_grid_of_osmcode_comes_out_as_expected() {
        let Some(folder) = crate::testing::data() else { return };
        let bytes = std::fs::read(folder.join("osm_tiny/osm_testdata_grid_all.osm")).unwrap();
        let data = crate::osm::decode(&bytes, "grid.osm").unwrap();
        let tests = std::fs::read(folder.join("osm_tiny/osm_testdata_grid_tests.json")).unwrap();
        let tests: serde_json::Value = serde_json::from_slice(&tests).unwrap();
        let (mut right, mut wrong) = (0, Vec::new());
        for test in tests.as_array().unwrap() {
            let areas = &test["areas"];
            let variant = ["location", "fix", "default"].iter().find_map(|v| areas[*v].as_array());
            for area in variant.into_iter().flatten() {
                let (id, wkt) = (area["from_id"].as_i64().unwrap(), area["wkt"].as_str().unwrap());
                let mut pieces = Vec::new();
                if area["from_type"] == "way" {
                    pieces.push(Piece { nodes: &data.ways[&id].nodes, is_inner: false });
                } else {
                    for m in data.relations[&id].members.iter().filter(|m| m.kind == crate::osm::MemberKind::Way) {
                        let nodes = data.ways.get(&m.id).map(|w| w.nodes.as_slice()).unwrap_or_default();
                        pieces.push(Piece { nodes, is_inner: &*m.role == "inner" });
                    }
                }
                let first = pieces.iter().flat_map(|p| p.nodes).find_map(|n| data.nodes.get(n));
                let Some(first) = first else { continue };
                let anchor = veduta_city::Anchor { lat: first.lat, lon: first.lon };
                let extent = Extent { anchor, low: DVec2::splat(-1e6), high: DVec2::splat(1e6) };
                // What others mend by dropping doubled pieces may be left out here, but must not come out wrong.
                let may_be_left_out = areas["fix"].is_array() && !areas["location"].is_array();
                let got: f64 = assemble(&pieces, &data, &extent).polygons.iter().map(Polygon::area_m2).sum();
                if wkt == "INVALID" {
                    continue;
                }
                let plan = |r: Vec<(f64, f64)>| -> Ring { r.into_iter().map(|(x, y)| anchor.plan_from_geo(y, x)).collect() };
                let rings: Vec<Ring> = wkt_rings(wkt).into_iter().map(plan).collect();
                let expected: f64 = even_odd(&rings).0.iter().map(Polygon::area_m2).sum();
                if (got / expected - 1.0).abs() < 1e-3 || (may_be_left_out && got == 0.0) {
                    right += 1;
                } else {
                    wrong.push((test["test_id"].clone(), test["description"].clone(), got / expected));
                }
            }
        }
        println!("{right} right");
        assert!(right > 60 && wrong.is_empty(), "{right} right, wrong: {wrong:#?}");
    }
}
