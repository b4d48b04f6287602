use std::collections::HashMap;

use glam::Vec3;
use veduta_city::{GridPos, Monuments, file};

use super::*;

/// Every kind of shape, each for itself.
const SHAPES: [(&str, &str); 17] = [
    ("box", "Box(size: (2, 3, 4))"),
    ("cylinder", "Cylinder(radius: 1, height: 3)"),
    ("frustum", "Cylinder(radius: 1, height: 3, top: 0.4, sides: 8)"),
    ("pyramid", "Cone(radius: 1, height: 3, sides: 4)"),
    ("cone", "Cone(radius: 1, height: 3)"),
    ("ball", "Sphere(radius: 1.5)"),
    ("baluster", "Lathe(profile: [(0.2, 0), (0.2, 0.1), (0.3, 0.4, 0.3), (0.1, 0.9), (0.2, 1)])"),
    ("basin", "Lathe(profile: [(2, 0), (2, 1), (1.6, 1), (1.6, 0.4)], sides: 8)"),
    (
        "plinth",
        "Extrusion(outline: [(-1, -1), (1, -1), (1, 1, 1), (-1, 1)], holes: [(at: (0, 0), shape: Circle(0.4))], height: 0.5)",
    ),
    (
        "wall",
        "Panel(outline: [(-3, 0), (3, 0), (3, 5), (0, 7), (-3, 5)], depth: 0.6,
        holes: [(at: (-2, 1), shape: Arch(0.8, 2, Pointed), row: (3, (2, 0))), (at: (0, 4.6), shape: Foil(0.7, 4))])",
    ),
    (
        "rose",
        "Panel(outline: [(3, 0), (-3, 0, 1), (3, 0, 1)], depth: 0.4, holes: [(at: (0, 0), shape: Foil(0.5, 6)),
        (at: (0, 0), shape: Arch(0.5, 1.6, Round), around: (12, 0.9))])",
    ),
    (
        "cornice",
        "Sweep(section: [(0, 0), (0.2, 0.1), (0.4, 0.4, 0.4), (0.4, 0.5), (0, 0.6)], along: [(-2, -1), (2, -1), (2, 1), (-2, 1)], closed: true)",
    ),
    ("archivolt", "Sweep(section: [(0, 0), (0.2, 0), (0.2, 0.2), (0, 0.2)], along: [(2, 0), (-2, 0, 1)])"),
    ("limb", "Tube(path: [(0, 0, 0, 0.2), (0.5, 0, 1, 0.15), (0.6, 0.4, 2, 0)])"),
    ("groin", "Vault(size: (4, 5), rise: 2, cross: true)"),
    ("barrel", "Vault(size: (4, 5), rise: 2, head: Pointed)"),
    ("roof", "Roof(outline: [(-3, -5), (3, -5), (3, 5), (-3, 5)], shape: Hipped, height: 3)"),
];

/// Those that are no closed bodies by themselves.
const OPEN: [&str; 5] = ["groin", "barrel", "roof", "cornice", "archivolt"];

fn design(shape: &str, more: &str) -> Design {
    let text = format!(
        "[(name: \"m\", paints: {{\"stone\": (colour: \"#B79F79\", tile: Stone)}}, parts: [(paint: \"stone\", {more} shape: {shape})])]"
    );
    let monuments: Monuments = file::parse(&text, "test").unwrap_or_else(|e| panic!("{e}"));
    monuments.design("m", &std::collections::BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"))
}

fn made(design: &Design, heading: u16, detail: MonumentDetail) -> MeshData {
    // Well above its foot's height, so that undersides are kept.
    let placed = veduta_city::PlacedMonument { design: 0, pos: GridPos(2048, -1024), z: -9000, heading };
    let mut design = design.clone();
    design.pieces.iter_mut().take(1).for_each(|piece| piece.at[2] += 9000);
    let mut mesh = MeshData::default();
    monument(&design, &placed, detail, &mut mesh);
    mesh
}

fn at(mesh: &MeshData, i: u32) -> Vec3 {
    Vec3::from_array(mesh.positions[i as usize])
}

/// Directed edges that no triangle takes the other way, by position.
fn loose_edges(mesh: &MeshData) -> usize {
    let key = |i: u32| at(mesh, i).to_array().map(|c| (c * 2048.0).round() as i64);
    let mut edges: HashMap<[[i64; 3]; 2], i64> = HashMap::new();
    for t in mesh.indices.chunks_exact(3) {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let (a, b) = (key(a), key(b));
            *edges.entry(if a < b { [a, b] } else { [b, a] }).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().filter(|&&n| n != 0).count()
}

fn volume(mesh: &MeshData) -> f32 {
    mesh.indices.chunks_exact(3).map(|t| at(mesh, t[0]).dot(at(mesh, t[1]).cross(at(mesh, t[2])))).sum::<f32>() / 6.0
}

#[test]
fn every_shape_is_sound_and_its_normals_look_outwards() {
    for (name, shape) in SHAPES {
        for more in ["", "mirror: X, at: (9, 0, 0),", "turn_deg: 30, tilt_deg: 20, roll_deg: 10, scale: (1, 2, 1.5),"] {
            for detail in [MonumentDetail::FINE, MonumentDetail { least_m: 0.0, ..MonumentDetail::COARSE }] {
                let mesh = made(&design(shape, more), 12_345, detail);
                mesh.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
                assert!(mesh.triangle_count() > 3, "{name}");
                for t in mesh.indices.chunks_exact(3) {
                    let [a, b, c] = [t[0], t[1], t[2]].map(|i| at(&mesh, i));
                    let turn = (b - a).cross(c - a).normalize_or_zero();
                    for &i in t {
                        let normal = Vec3::from_array(mesh.normals[i as usize]);
                        assert!(turn.dot(normal) > 0.3 || turn == Vec3::ZERO, "{name} {more}: {turn} against {normal}");
                    }
                }
            }
        }
    }
}

#[test]
fn bodies_are_closed_and_not_inside_out() {
    for (name, shape) in SHAPES.into_iter().filter(|(name, _)| !OPEN.contains(name)) {
        for more in ["", "mirror: Y, at: (0, 9, 0),"] {
            let mesh = made(&design(shape, more), 9_000, MonumentDetail::FINE);
            assert_eq!(loose_edges(&mesh), 0, "{name} {more}");
            assert!(volume(&mesh) > 0.01, "{name} {more}: {}", volume(&mesh));
        }
    }
}

#[test]
fn no_shape_comes_to_more_faces_than_it_tells() {
    let without_sides = [
        ("cylinder of no sides", "Cylinder(radius: 3, height: 3, sides: 0)"),
        ("cone of two", "Cone(radius: 30, height: 3, sides: 2)"),
        ("lathe of one", "Lathe(profile: [(2, 0), (2, 1), (1.6, 1, 0.4), (1.6, 0.4)], sides: 1)"),
        ("tube of none", "Tube(path: [(0, 0, 0, 2), (0.5, 0, 1, 1.5), (0.6, 0.4, 2, 0)], sides: 0)"),
        ("many-lobed", "Panel(outline: [(3, 0), (-3, 0, 1), (3, 0, 1)], depth: 0.4, holes: [(at: (0, 0), shape: Foil(2.5, 24))])"),
    ];
    for (name, shape) in SHAPES.into_iter().chain(without_sides) {
        let design = design(shape, "");
        let mesh = made(&design, 0, MonumentDetail::FINE);
        let told = design.most_faces().unwrap_or_else(|e| panic!("{name}: {e}"));
        // A face is a ring of corners; rings of four come to two triangles.
        assert!(mesh.triangle_count() as u64 <= 2 * told, "{name}: {} triangles, {told} faces told", mesh.triangle_count());
    }
}

#[test]
fn known_bodies_have_their_volumes() {
    for (shape, expected) in [
        ("Box(size: (2, 3, 4))", 24.0),
        ("Cone(radius: 1, height: 3, sides: 4)", 4.0),
        ("Cylinder(radius: 1, height: 3)", 9.42),
        ("Sphere(radius: 1.5)", 14.14),
        ("Panel(outline: [(0, 0), (4, 0), (4, 3), (0, 3)], depth: 0.5, holes: [(at: (2, 1), shape: Rect(1, 1))])", 5.5),
    ] {
        let found = volume(&made(&design(shape, ""), 0, MonumentDetail::FINE));
        assert!((found - expected).abs() < 0.03 * expected, "{shape}: {found} for {expected}");
    }
}

#[test]
fn the_front_looks_where_the_heading_says() {
    let panel = design("Panel(outline: [(0, 0), (2, 0), (2, 3), (0, 3)], depth: 0.5)", "");
    for (heading, front, right) in [(0, Vec3::NEG_Z, Vec3::NEG_X), (9_000, Vec3::X, Vec3::NEG_Z), (18_000, Vec3::Z, Vec3::X)] {
        let mesh = made(&panel, heading, MonumentDetail { has_reveals: false, ..MonumentDetail::FINE });
        assert!((Vec3::from_array(mesh.normals[0]) - front).length() < 1e-5, "{heading}: {:?}", mesh.normals[0]);
        let foot = Vec3::new(2.0, 0.0, 1.0);
        let reach = mesh
            .positions
            .iter()
            .map(|p| (Vec3::from_array(*p) - foot).dot(right))
            .fold((0.0, 0.0), |(l, h): (f32, f32), d| (l.min(d), h.max(d)));
        assert!(reach.0.abs() < 1e-4 && (reach.1 - 2.0).abs() < 1e-4, "{heading}: {reach:?}");
    }
}

#[test]
fn copies_stand_in_rows_and_rings() {
    let ring = design("Box(size: (0.1, 0.1, 1))", "at: (0, -3, 0), repeat: Around(count: 4, rise: 0.5),");
    let mesh = made(&ring, 0, MonumentDetail::FINE);
    let foot = Vec3::new(2.0, 0.0, 1.0);
    let middles: Vec<Vec3> =
        mesh.positions.chunks(24).map(|box_| box_.iter().map(|p| Vec3::from_array(*p)).sum::<Vec3>() / 24.0 - foot).collect();
    assert_eq!(middles.len(), 4);
    // The front looks north: the first stands there, the next clockwise from it.
    let expected = [Vec3::NEG_Z, Vec3::X, Vec3::Z, Vec3::NEG_X];
    for (i, (middle, way)) in middles.iter().zip(expected).enumerate() {
        let want = way * 3.0 + Vec3::Y * (0.5 + 0.5 * i as f32);
        assert!((*middle - want).length() < 1e-4, "{i}: {middle} for {want}");
    }
    let row = design("Sphere(radius: 0.5)", "repeat: Row(count: 3, step: (2, 0, 0), centred: true),");
    let mesh = made(&row, 18_000, MonumentDetail::FINE);
    let reach = mesh.positions.iter().map(|p| p[0] - 2.0).fold((0.0, 0.0), |(l, h): (f32, f32), x| (l.min(x), h.max(x)));
    assert!((reach.0 + 2.5).abs() < 0.02 && (reach.1 - 2.5).abs() < 0.02, "{reach:?}");
}

#[test]
fn what_is_slight_is_left_out_from_afar() {
    let rail = design("Box(size: (20, 0.1, 0.1))", "");
    assert!(made(&rail, 0, MonumentDetail::COARSE).is_empty());
    assert_eq!(made(&rail, 0, MonumentDetail::FINE).triangle_count(), 12);
    let wall = design("Box(size: (20, 0.1, 5))", "turn_deg: 40, tilt_deg: 30,");
    assert_eq!(made(&wall, 0, MonumentDetail::COARSE).triangle_count(), 12);
}

#[test]
fn a_bay_is_stretched_over_what_it_covers() {
    let text = "[(name: \"m\", paints: {\"dial\": (colour: \"#FFFFFF\", tile: Bay(Clock))},
        parts: [(paint: \"dial\", shape: Panel(outline: [(2, 0), (-2, 0, 1), (2, 0, 1)], depth: 0.2))])]";
    let monuments: Monuments = file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"));
    let design = monuments.design("m", &std::collections::BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"));
    let mesh = made(&design, 18_000, MonumentDetail { has_reveals: false, ..MonumentDetail::FINE });
    let front = mesh.normals.iter().zip(&mesh.uvs).filter(|(n, _)| n[2] > 0.9);
    let uvs: Vec<[f32; 2]> = front.map(|(_, uv)| *uv).collect();
    let reach = uvs
        .iter()
        .fold(([9.0_f32; 2], [-9.0_f32; 2]), |(l, h), uv| ([l[0].min(uv[0]), l[1].min(uv[1])], [h[0].max(uv[0]), h[1].max(uv[1])]));
    assert!(reach.0.iter().all(|c| c.abs() < 1e-3) && reach.1.iter().all(|c| (c - 1.0).abs() < 1e-3), "{reach:?}");
}

#[test]
fn every_stock_monument_is_sound_and_lighter_from_afar() {
    let monuments = crate::plan::Stock::new().monuments;
    for monument in &monuments.0 {
        let name = &monument.name;
        let design = monuments.design(name, &std::collections::BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"));
        let [fine, coarse] = [MonumentDetail::FINE, MonumentDetail::COARSE].map(|detail| {
            let placed = veduta_city::PlacedMonument { design: 0, pos: GridPos(0, 0), z: 0, heading: 0 };
            let mut mesh = MeshData::default();
            super::monument(&design, &placed, detail, &mut mesh);
            mesh.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
            mesh
        });
        assert!((1..=80_000).contains(&fine.triangle_count()), "{name}: {} triangles", fine.triangle_count());
        assert!(coarse.triangle_count() <= fine.triangle_count(), "{name}");
        let is_large = fine.triangle_count() > 20_000;
        assert!(!is_large || 10 * coarse.triangle_count() < 9 * fine.triangle_count(), "{name}: {}", coarse.triangle_count());
        // The outline is the same from afar.
        let reach = |mesh: &MeshData| {
            let none = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
            mesh.positions.iter().map(|p| Vec3::from_array(*p)).fold(none, |(l, h), p| (l.min(p), h.max(p)))
        };
        let (near, far) = (reach(&fine), reach(&coarse));
        let apart = (near.0 - far.0).abs().max((near.1 - far.1).abs());
        assert!(!is_large || apart.max_element() < 1.6, "{name} is {apart} smaller from afar");
    }
}
