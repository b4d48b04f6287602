use glam::DVec2;
use veduta_city::{CityGraph, Id};

/// A city of `columns` × `rows` copies of a graph side by side, the original in their middle: for measuring how costs grow with a
/// city's size. Places keep their names in the original alone. The ground is level.
#[must_use]
pub fn enlarged(graph: &CityGraph, columns: u32, rows: u32) -> CityGraph {
    let Some((low, high)) = bounds(graph) else { return graph.clone() };
    let step = high - low + DVec2::splat(2.0 * graph.margin_m + 20.0);
    let mut large = CityGraph { nodes: Vec::new(), terrain: None, ..graph.clone() };
    let (columns, rows) = (i64::from(columns.max(1)), i64::from(rows.max(1)));
    for copy in 0..columns * rows {
        let (column, row) = (copy % columns - columns / 2, copy / columns - rows / 2);
        let is_original = (column, row) == (0, 0);
        let by = DVec2::new(column as f64, row as f64) * step;
        let id = |id: Id| if is_original { id } else { Id::from_place(&format!("{id} copy {column} {row}"), DVec2::ZERO) };
        large.nodes.extend(graph.nodes.iter().map(|n| {
            let mut n = *n;
            (n.id, n.pos) = (id(n.id), n.pos + by);
            n
        }));
        if is_original {
            continue;
        }
        let ring = |ring: &[DVec2]| ring.iter().map(|p| *p + by).collect::<Vec<_>>();
        let rings = |holes: &[Vec<DVec2>]| holes.iter().map(|h| ring(h)).collect::<Vec<_>>();
        large.links.extend(graph.links.iter().cloned().map(|mut l| {
            (l.id, l.from, l.to, l.via) = (id(l.id), id(l.from), id(l.to), ring(&l.via));
            l
        }));
        large.squares.extend(graph.squares.iter().cloned().map(|mut s| {
            (s.id, s.outline, s.holes) = (id(s.id), ring(&s.outline), rings(&s.holes));
            s
        }));
        large.blocks.extend(graph.blocks.iter().cloned().map(|mut b| {
            (b.id, b.outline, b.holes) = (id(b.id), ring(&b.outline), rings(&b.holes));
            b
        }));
        large.buildings.extend(graph.buildings.iter().cloned().map(|mut b| {
            (b.id, b.outline, b.holes) = (id(b.id), ring(&b.outline), rings(&b.holes));
            for part in &mut b.parts {
                (part.id, part.outline, part.holes) = (id(part.id), ring(&part.outline), rings(&part.holes));
            }
            b
        }));
        large.objects.extend(graph.objects.iter().cloned().map(|mut o| {
            (o.id, o.pos) = (id(o.id), o.pos + by);
            o
        }));
    }
    large
}

fn bounds(graph: &CityGraph) -> Option<(DVec2, DVec2)> {
    let points = || {
        let areas = graph.squares.iter().map(|s| &s.outline).chain(graph.blocks.iter().map(|b| &b.outline));
        let rings = areas.chain(graph.buildings.iter().map(|b| &b.outline)).flatten();
        graph.nodes.iter().map(|n| n.pos).chain(graph.links.iter().flat_map(|l| &l.via).copied()).chain(rings.copied())
    };
    let low = points().reduce(DVec2::min)?;
    Some((low, points().reduce(DVec2::max)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_do_not_touch_and_the_graph_stays_valid() {
        let text = "(name: \"T\", anchor: (lat: 50, lon: 14), margin_m: 10,
            nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (100, 50))],
            links: [(id: 9, from: 1, to: 2, kind: Street(Lane))],
            buildings: [(outline: [(10, 10), (20, 10), (20, 20)])])";
        let mut graph: CityGraph = veduta_city::file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        graph.fill_ids();
        let large = enlarged(&graph, 5, 2);
        assert_eq!((large.nodes.len(), large.links.len(), large.buildings.len()), (20, 10, 10));
        assert_eq!(large.validate(), []);
        let corner = |n: usize| large.buildings[n].outline[0];
        assert_eq!(corner(0), DVec2::new(10.0, 10.0), "the original stays where it is");
        assert!((1..10).all(|n| corner(n).distance(corner(0)) >= 50.0 + 20.0));
        assert!(corner(1).x < 0.0 && corner(9).x > 0.0, "copies lie on both sides of it");
    }
}
