//! A made-up city of any size: a bent grid of streets, blocks of houses back to back, a square, a park, a river.

use glam::DVec2;
use veduta_city::{
    Anchor, Block, BlockKind, Building, CityGraph, Id, Link, LinkKind, Node, RoofTags, Square, StreetClass, Surfacing, draw::Draw,
};

/// Distance between crossings, metres.
const STEP_M: f64 = 85.0;

/// A city of `n` × `n` blocks with about 25 given houses each.
pub fn city(n: usize, seed: u64) -> CityGraph {
    let id = |i: usize, j: usize| Id((i * (n + 1) + j + 1) as u64);
    let at = |i: usize, j: usize| {
        let d = Draw::new(seed, id(i, j), "node");
        DVec2::new(i as f64, j as f64) * STEP_M + DVec2::new(d.between("x", -6.0, 6.0), d.between("y", -6.0, 6.0))
    };
    let mut graph = CityGraph {
        name: "Synthetic".into(),
        anchor: Anchor { lat: 50.0, lon: 14.0 },
        seed,
        margin_m: 30.0,
        ..CityGraph::default()
    };
    for i in 0..=n {
        for j in 0..=n {
            graph.nodes.push(Node { id: id(i, j), pos: at(i, j), z: 0.0 });
            let ends = [(i < n).then(|| id(i + 1, j)), (j < n).then(|| id(i, j + 1))];
            graph.links.extend(ends.into_iter().flatten().map(|to| link(id(i, j), to, seed)));
        }
    }
    for i in 0..n {
        for j in 0..n {
            fill_block(&mut graph, [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], i, j);
        }
    }
    graph.fill_ids();
    graph
}

fn link(from: Id, to: Id, seed: u64) -> Link {
    let draw = Draw::new(seed, Id(from.0 << 20 | to.0), "link");
    let class = *draw
        .pick("class", &[StreetClass::Street, StreetClass::Lane, StreetClass::Main, StreetClass::Lane])
        .unwrap_or(&StreetClass::Lane);
    Link {
        id: Id::NONE,
        from,
        to,
        via: Vec::new(),
        kind: LinkKind::Street(class),
        width_m: 0.0,
        profile: Vec::new(),
        name: format!("Street {}", draw.below("name", 40)),
        layer: 0,
        surfacing: None,
    }
}

fn fill_block(graph: &mut CityGraph, corners: [DVec2; 4], i: usize, j: usize) {
    let middle = corners.iter().copied().sum::<DVec2>() / 4.0;
    let inset = corners.map(|c| c + (middle - c).normalize() * 11.0);
    let area = |kind| Block {
        id: Id::NONE,
        kind,
        name: String::new(),
        district: String::new(),
        outline: inset.to_vec(),
        holes: Vec::new(),
    };
    match (i * 7 + j * 3) % 41 {
        0 => graph.blocks.push(area(BlockKind::Park)),
        1 => graph.blocks.push(area(BlockKind::Water)),
        2 => graph.squares.push(Square {
            id: Id::NONE,
            name: format!("Square {i} {j}"),
            outline: inset.to_vec(),
            holes: Vec::new(),
            surfacing: Surfacing::Mosaic,
        }),
        3 => graph.blocks.push(area(BlockKind::Built)),
        _ => houses(graph, inset),
    }
}

/// Two rows of 13 houses, back to back.
fn houses(graph: &mut CityGraph, c: [DVec2; 4]) {
    let point = |s: f64, t: f64| c[0].lerp(c[1], s).lerp(c[3].lerp(c[2], s), t);
    for row in 0..2 {
        for k in 0..13 {
            let (s0, s1) = (f64::from(k) / 13.0, f64::from(k + 1) / 13.0);
            let (t0, t1) = if row == 0 { (0.0, 0.3) } else { (0.7, 1.0) };
            graph.buildings.push(building(vec![point(s0, t0), point(s1, t0), point(s1, t1), point(s0, t1)]));
        }
    }
}

/// A building of which only the outline is known.
pub fn building(outline: Vec<DVec2>) -> Building {
    Building {
        id: Id::NONE,
        name: String::new(),
        number: String::new(),
        style: String::new(),
        outline,
        holes: Vec::new(),
        min_height_m: 0.0,
        height_m: None,
        levels: None,
        roof: RoofTags::default(),
        colour: None,
        parts: Vec::new(),
        monument: None,
    }
}
