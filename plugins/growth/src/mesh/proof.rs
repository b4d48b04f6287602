//! Properties of whole meshes over outlines of many kinds and every roof.

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use veduta_city::{
    CellShell, FacadeSheet, Gable, GridPolygon, GridPos, GridRing, GroundFloor, GroundPatch, HouseShell, Opening, PlanRoof, Rgb,
    RoofShape, Storey, SurfaceKind, VolumeShell, Wall, WallKind,
};

use super::outline::{contains, rings, wall_count};
use super::*;

const SHAPES: [RoofShape; 13] = [
    RoofShape::Flat,
    RoofShape::Gabled,
    RoofShape::Hipped,
    RoofShape::HalfHipped,
    RoofShape::Pyramidal,
    RoofShape::Skillion,
    RoofShape::Mansard,
    RoofShape::Gambrel,
    RoofShape::Dome,
    RoofShape::Onion,
    RoofShape::Cone,
    RoofShape::Round,
    RoofShape::SawTooth,
];

fn ring(points: impl IntoIterator<Item = (f64, f64)>) -> GridRing {
    points.into_iter().map(|p| GridPos::from_metres(p.into())).collect()
}

/// Corners on a circle (convex), or at changing distances from its middle (star-shaped).
fn round(spokes: &[(f64, f64)], radius: f64, is_convex: bool) -> GridPolygon {
    let n = spokes.len() as f64;
    GridPolygon::simple(ring(spokes.iter().enumerate().map(|(i, &(jitter, r))| {
        let angle = (i as f64 + 0.8 * jitter) / n * core::f64::consts::TAU;
        let r = if is_convex { radius } else { radius * r };
        (r * libm::cos(angle), r * libm::sin(angle))
    })))
}

/// A rectangle with a notch, or a courtyard, turned by an angle.
fn wing(w: f64, d: f64, notch: (f64, f64), has_court: bool, turn: f64) -> GridPolygon {
    let turned = |(x, y): (f64, f64)| {
        let v = DVec2::from_angle(turn).rotate(DVec2::new(x, y));
        (v.x, v.y)
    };
    let (nx, ny) = (w * notch.0, d * notch.1);
    if has_court {
        let outer = ring([(0.0, 0.0), (w, 0.0), (w, d), (0.0, d)].map(turned));
        let hole = ring(
            [(nx * 0.5, ny * 0.5), (nx * 0.5, d - ny * 0.4), (w - nx * 0.3, d - ny * 0.4), (w - nx * 0.3, ny * 0.5)].map(turned),
        );
        return GridPolygon { outer, holes: vec![hole] };
    }
    GridPolygon::simple(ring([(0.0, 0.0), (w, 0.0), (w, ny), (nx, ny), (nx, d), (0.0, d)].map(turned)))
}

fn outlines() -> impl Strategy<Value = GridPolygon> {
    let spokes = prop::collection::vec((0.0..1.0_f64, 0.35..1.0_f64), 4..14);
    let circle = (spokes, 3.0..25.0_f64, any::<bool>()).prop_map(|(s, r, c)| round(&s, r, c));
    let notched = (6.0..40.0_f64, 6.0..40.0_f64, (0.2..0.8_f64, 0.2..0.8_f64), any::<bool>(), 0.0..6.3_f64)
        .prop_map(|(w, d, n, c, t)| wing(w, d, n, c, t));
    let quad = (5.0..15.0_f64, 8.0..20.0_f64, -2.0..2.0_f64, -2.0..2.0_f64)
        .prop_map(|(w, d, p, q)| GridPolygon::simple(ring([(0.0, 0.0), (w, p), (w + q, d), (q * 0.5, d - p)])));
    prop_oneof![circle, notched, quad]
}

fn volume(footprint: GridPolygon, shape: RoofShape, direction: u16, height: i32) -> VolumeShell {
    let walls = (0..wall_count(&footprint) as u16).collect();
    let roof = PlanRoof { shape, height, direction, colour: Rgb(0xA2, 0x4B, 0x33) };
    let (colour, trim) = (Rgb(0xD9, 0xB3, 0x6C), Rgb(0xEF, 0xE3, 0xC8));
    VolumeShell {
        footprint,
        bottom: 512,
        eaves: 512 + 13 * 1024,
        colour,
        trim,
        roof,
        gable: Gable::Plain,
        has_roof: true,
        walls,
        arcades: Vec::new(),
    }
}

fn cell(volume: VolumeShell) -> CellShell {
    CellShell { houses: vec![HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false }], ..Default::default() }
}

fn sheet(shell: &CellShell, bays: u8) -> FacadeSheet {
    let storey = |metres: i32, opening| Storey { height: metres * 1024, opening };
    let wall = |i: usize| Wall {
        kind: [WallKind::Street, WallKind::Yard, WallKind::Party][i % 3],
        bays: if i % 3 == 2 { 0 } else { bays },
        storeys: vec![
            storey(4, Opening::Window),
            storey(3, Opening::CorniceWindow),
            storey(3, Opening::Blank),
            storey(3, Opening::Blank),
        ],
        ground_floor: GroundFloor { door_bay: Some(1), door: Opening::Portal, shops: 0b1001, blank: 0 },
        ornament: None,
    };
    FacadeSheet::of((0..wall::wall_total(shell)).map(wall).collect())
}

fn triangles(mesh: &MeshData) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| DVec3::from_array(mesh.positions[i as usize].map(f64::from))))
}

fn face_area(mesh: &MeshData) -> f64 {
    triangles(mesh).map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// Area seen from straight above, faces from below taken off.
fn shadow(mesh: &MeshData) -> f64 {
    triangles(mesh).map(|[a, b, c]| (b - a).cross(c - a).y / 2.0).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    #[test]
    fn a_roof_covers_its_footprint_within_its_height(outline in outlines(), direction in 0..360_u16, height in 1024..8192_i32) {
        let footprint = rings(&outline);
        let area = outline.area_m2();
        for shape in SHAPES {
            let shell = cell(volume(outline.clone(), shape, direction, height));
            let mesh = roof_coverings(&shell);
            prop_assert_eq!(mesh.validate(), Ok(()));
            prop_assert!((shadow(&mesh) - area).abs() < 0.01 * area, "{:?}: {} of {}", shape, shadow(&mesh), area);
            let top = 13.5 + f64::from(height) / 1024.0 + 1e-3;
            for p in mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))) {
                prop_assert!(p.y >= 13.5 - 1e-3 && p.y <= top, "{:?}: {}", shape, p);
                let plan = DVec2::new(p.x, -p.z);
                let inside = contains(&footprint, plan) || border_distance(&footprint, plan) < 2e-3;
                prop_assert!(inside, "{:?}: {} lies outside", shape, p);
            }
            prop_assert_eq!(roofs(&shell).validate(), Ok(()));
        }
    }

    #[test]
    fn both_levels_of_a_wall_cover_the_same(outline in outlines(), direction in 0..360_u16, bays in 0..6_u8) {
        for shape in SHAPES {
            let shell = cell(volume(outline.clone(), shape, direction, 4096));
            let sheet = sheet(&shell, bays);
            let (one, two) = (level1(&shell), facades(&shell, &sheet).unwrap());
            prop_assert_eq!(one.validate(), Ok(()));
            prop_assert_eq!(level2(&shell, &sheet).unwrap().validate(), Ok(()));
            let (a, b) = (face_area(&one), face_area(&two));
            prop_assert!((a - b).abs() < 1e-3 * a, "{:?}: {} and {}", shape, a, b);
            let distinct = |mesh: &MeshData| {
                let mut centres = mesh.centres.iter().map(|c| c.map(f32::to_bits)).collect::<Vec<_>>();
                centres.sort_unstable();
                centres.dedup();
                centres
            };
            prop_assert_eq!(distinct(&one), distinct(&two));
            let mouldings = distinct(&mouldings(&shell, &sheet).unwrap());
            prop_assert!(mouldings.iter().all(|c| distinct(&one).contains(c)));
        }
    }

    #[test]
    fn gables_close_the_gap_between_walls_and_roof(outline in outlines(), direction in 0..360_u16) {
        for shape in SHAPES {
            let shell = cell(volume(outline.clone(), shape, direction, 4096));
            let (mut closed, walls) = (roof_coverings(&shell), level1(&shell));
            closed.append(&walls);
            // Of a closed body without its floor, all upright parts cancel out, and the shadow is the floor.
            let sum: DVec3 = triangles(&closed).map(|[a, b, c]| (b - a).cross(c - a) / 2.0).sum();
            let flat = DVec2::new(sum.x, sum.z).length();
            prop_assert!(flat < 2e-3 * face_area(&closed), "{:?}: {}", shape, sum);
        }
    }

    #[test]
    fn nothing_panics_on_rubbish(points in prop::collection::vec((any::<i32>(), any::<i32>()), 0..9), small in any::<bool>(),
        numbers in prop::array::uniform4(any::<i32>()), direction in any::<u16>(), walls in prop::collection::vec(any::<u16>(), 0..4)) {
        let shrink = if small { 1 << 18 } else { 1 };
        let ring: GridRing = points.iter().map(|&(x, y)| GridPos(x / shrink, y / shrink)).collect();
        let outline = GridPolygon { outer: ring.clone(), holes: vec![ring, Vec::new()] };
        for shape in SHAPES {
            let [bottom, eaves, height, z] = numbers;
            let walls = walls.iter().map(|w| w % 12).collect();
            let volume = VolumeShell { bottom, eaves, walls, ..volume(outline.clone(), shape, direction, height) };
            let patch = |surface| GroundPatch { surface, outline: outline.clone(), z, course: None };
            let ground = vec![patch(SurfaceKind::Grass), patch(SurfaceKind::Water)];
            let shell = CellShell { origin: GridPos(z, height), ground, ..cell(volume) };
            let sheet = sheet(&shell, 5);
            for mesh in [super::ground(&shell), roofs(&shell), level1(&shell), level2(&shell, &sheet).unwrap()] {
                prop_assert_eq!(mesh.validate(), Ok(()));
            }
            prop_assert_eq!(collision(&shell).objects, []);
        }
    }
}

fn border_distance(rings: &[Vec<DVec2>], p: DVec2) -> f64 {
    let mut nearest = f64::INFINITY;
    for ring in rings {
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            nearest = nearest.min(p.distance(a.lerp(b, t)));
        }
    }
    nearest
}

/// Length in plan of the covering's edges that no other face of it shares.
fn open_edges(mesh: &MeshData) -> f64 {
    let key = |p: DVec3| (p * 500.0).round().to_array().map(|c| c as i64);
    let mut edges: Vec<_> =
        triangles(mesh).flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]).filter(|(a, b)| key(*a) != key(*b)).collect();
    let directed: Vec<_> = edges.iter().map(|(a, b)| (key(*a), key(*b))).collect();
    edges.retain(|(a, b)| !directed.contains(&(key(*b), key(*a))));
    edges.iter().map(|(a, b)| DVec2::new(a.x - b.x, a.z - b.z).length()).sum()
}

#[test]
fn coverings_are_watertight() {
    let house = GridPolygon::simple(ring([(0.0, 0.0), (10.0, 0.0), (10.0, 14.0), (0.0, 14.0)]));
    let octagon = round(&[(0.0, 1.0); 8], 5.0, true);
    let l = wing(16.0, 14.0, (0.5, 0.5), false, 0.0);
    let court = wing(30.0, 30.0, (0.5, 0.5), true, 0.0);
    for (name, outline) in [("house", house), ("octagon", octagon), ("l", l), ("court", court)] {
        let round: f64 =
            rings(&outline).iter().map(|r| (0..r.len()).map(|i| r[i].distance(r[(i + 1) % r.len()])).sum::<f64>()).sum();
        for shape in SHAPES.into_iter().filter(|s| *s != RoofShape::SawTooth) {
            let mesh = roof_coverings(&cell(volume(outline.clone(), shape, 0, 4096)));
            let open = open_edges(&mesh);
            assert!((open - round).abs() < 0.02, "{name} {shape:?}: {open} of {round}");
        }
    }
}

#[test]
fn a_house_stays_small() {
    let outline = GridPolygon::simple(ring([(0.0, 0.0), (9.0, 0.3), (9.4, 14.0), (0.2, 14.2)]));
    let shell = cell(volume(outline, RoofShape::Gabled, 90, 5 * 1024));
    let sheet = sheet(&shell, 4);
    let count = |mesh: &MeshData| (mesh.positions.len(), mesh.triangle_count());
    let [all, bodies, details] =
        [roofs(&shell), super::roof_bodies(&shell), super::roof_details(&shell)].map(|m| m.triangle_count());
    assert!(bodies > 0 && details > 0 && bodies + details == all, "{bodies} of bodies and {details} of details make {all}");
    println!("roof {:?}, level 1 {:?}", count(&roofs(&shell)), count(&level1(&shell)));
    println!("level 2 {:?} with mouldings {:?}", count(&facades(&shell, &sheet).unwrap()), count(&level2(&shell, &sheet).unwrap()));
    assert_eq!(level1(&shell).triangle_count(), 4 * 2 + 2 * 2, "four walls and two gables of two halves");
    assert!(level2(&shell, &sheet).unwrap().triangle_count() < 200);
    assert!(roofs(&shell).triangle_count() < 150);
}
