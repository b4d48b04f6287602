//! Whole plans, through the public interface: what no stage can hold alone.

mod synthetic;

use std::collections::BTreeSet;

use geo::{Area, BooleanOps, Contains, Coord, LineString, MultiPolygon, Polygon, Validation};
use glam::DVec2;
use proptest::prelude::*;
use veduta_city::{
    Block, CityGraph, CityPlan, GridPolygon, House, Id, ObjectKind, Opening, StandingObject, SurfaceKind, Viewpoint, WallKind,
    metres,
};
use veduta_growth::plan::{Growth, GrowthError, Stock, grow};

fn parsed(text: &str) -> CityGraph {
    veduta_city::file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
}

fn grown(graph: &CityGraph) -> Growth {
    grow(graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}"))
}

fn geo_polygon(p: &GridPolygon) -> Polygon {
    let ring = |r: &Vec<veduta_city::GridPos>| {
        LineString::new(r.iter().map(|p| p.to_metres()).map(|p| Coord { x: p.x, y: p.y }).collect())
    };
    Polygon::new(ring(&p.outer), p.holes.iter().map(ring).collect())
}

/// Area that is covered twice and area that is not covered at all, square metres.
fn overlap_and_gap(plan: &CityPlan) -> (f64, f64) {
    let patches: Vec<Polygon> = plan.ground.iter().map(|g| geo_polygon(&g.outline)).collect();
    let sum: f64 = patches.iter().map(Area::unsigned_area).sum();
    let union: f64 = geo::algorithm::unary_union(&patches).unsigned_area();
    (sum - union, plan.extent.area_m2() - union)
}

/// Pairs of houses whose ground floors overlap, with the area.
fn overlaps(houses: &[House]) -> Vec<(Id, Id, f64)> {
    let flat: Vec<(Id, Polygon, _)> = houses
        .iter()
        .flat_map(|h| h.volumes.iter().map(move |v| (h.id, geo_polygon(&v.footprint), v.footprint.bounds())))
        .collect();
    let mut out = Vec::new();
    for (i, a) in flat.iter().enumerate() {
        for b in &flat[..i] {
            let (Some((alo, ahi)), Some((blo, bhi))) = (a.2, b.2) else { continue };
            if a.0 != b.0 && alo.0 < bhi.0 && blo.0 < ahi.0 && alo.1 < bhi.1 && blo.1 < ahi.1 {
                let area = a.1.intersection(&b.1).unsigned_area();
                if area > 0.05 {
                    out.push((a.0, b.0, area));
                }
            }
        }
    }
    out
}

/// A crossing of two streets with four empty blocks.
fn crossing() -> CityGraph {
    parsed(
        "(name: \"Crossing\", anchor: (lat: 50, lon: 14), seed: 3,
          nodes: [(id: 1, pos: (-90, 0)), (id: 2, pos: (90, 0)), (id: 3, pos: (0, -90)), (id: 4, pos: (0, 90)), (id: 5, pos: (0, 0))],
          links: [(from: 1, to: 5, kind: Street(Street), width_m: 12, name: \"Long Street\"), (from: 5, to: 2, kind: Street(Street), width_m: 12, name: \"Long Street\"),
                  (from: 3, to: 5, kind: Street(Lane), name: \"Short Lane\"), (from: 5, to: 4, kind: Street(Lane), name: \"Short Lane\")],
          blocks: [(outline: [(6, 8), (70, 8), (75, 66), (5, 70)]), (outline: [(-70, 8), (-6, 8), (-6, 70), (-50, 60)]),
                   (outline: [(-60, -50), (-6, -60), (-6, -8), (-64, -8)]), (outline: [(6, -22), (70, -22), (70, -8), (6, -8)])])",
    )
}

#[test]
fn the_ground_has_no_overlap_and_no_gap() {
    for graph in [crossing(), synthetic::city(4, 1)] {
        let plan = grown(&graph).plan;
        let (overlap, gap) = overlap_and_gap(&plan);
        let area = plan.extent.area_m2();
        assert!(overlap.abs() < 1e-4 * area && gap.abs() < 1e-4 * area, "overlap {overlap} m², gap {gap} m² of {area} m²");
        for patch in &plan.ground {
            assert!(patch.outline.area_m2() > 0.0, "outer rings are counter-clockwise");
            assert!(geo_polygon(&patch.outline).is_valid(), "{patch:?}");
        }
    }
}

#[test]
fn pavements_stand_a_kerb_above_the_carriageway() {
    let plan = grown(&crossing()).plan;
    let z = |surface| plan.ground.iter().filter(|g| g.surface == surface).map(|g| g.z).collect::<BTreeSet<i32>>();
    assert_eq!(z(SurfaceKind::Asphalt), BTreeSet::from([0]));
    assert_eq!(z(SurfaceKind::Mosaic), BTreeSet::from([123]), "12 cm");
}

#[test]
fn empty_blocks_are_built_round_without_overlaps() {
    let growth = grown(&crossing());
    let houses = &growth.plan.houses;
    assert!((50..110).contains(&houses.len()), "{} houses; {:?}", houses.len(), growth.findings);
    assert_eq!(overlaps(houses), []);
    for v in houses.iter().flat_map(|h| &h.volumes) {
        assert!(geo_polygon(&v.footprint).is_valid());
        assert!(v.footprint.area_m2() >= 12.0);
    }
    let in_court = veduta_city::GridPos::from_metres(DVec2::new(38.0, 38.0));
    assert!(!houses.iter().any(|h| h.volumes[0].footprint.contains(in_court)), "the courtyard is free");
}

#[test]
fn grown_neighbours_have_eaves_of_their_own() {
    let plan = grown(&crossing()).plan;
    let corners = |h: &House| h.volumes[0].footprint.outer.iter().copied().collect::<BTreeSet<_>>();
    let mut pairs = 0;
    for (i, a) in plan.houses.iter().enumerate() {
        for b in &plan.houses[..i] {
            if corners(a).intersection(&corners(b)).count() >= 2 {
                pairs += 1;
                let step = metres((a.volumes[0].eaves - b.volumes[0].eaves).abs());
                assert!((0.3..=2.5).contains(&step), "{step} m between {} and {}", a.id, b.id);
            }
        }
    }
    assert!(pairs > 40, "party walls share both their vertices: {pairs}");
}

#[test]
fn neighbours_are_not_twins() {
    for plan in [grown(&crossing()).plan, grown(&synthetic::city(3, 5)).plan] {
        let look = |h: &House| {
            let v = &h.volumes[0];
            let wall = v.walls.iter().filter(|w| w.kind == WallKind::Street).max_by_key(|w| w.bays);
            (v.colour, wall.map(|w| (w.bays, w.opening(1, 0), w.storeys[0].opening)))
        };
        let near =
            |a: veduta_city::Rgb, b: veduta_city::Rgb| a.0.abs_diff(b.0) < 10 && a.1.abs_diff(b.1) < 10 && a.2.abs_diff(b.2) < 10;
        for (i, a) in plan.houses.iter().enumerate() {
            let mine: BTreeSet<_> = a.volumes[0].footprint.outer.iter().collect();
            for b in
                plan.houses[..i].iter().filter(|b| b.volumes[0].footprint.outer.iter().filter(|v| mine.contains(v)).count() >= 2)
            {
                let (x, y) = (look(a), look(b));
                assert!(!(near(x.0, y.0) && x.1 == y.1), "{} and {} are alike: {x:?}", a.id, b.id);
            }
        }
    }
}

#[test]
fn walls_are_filled_by_their_storeys_and_have_sense() {
    let plan = grown(&synthetic::city(3, 2)).plan;
    for house in &plan.houses {
        let mut doors = 0;
        for v in &house.volumes {
            let edges: usize = v.footprint.rings().map(Vec::len).sum();
            assert_eq!(v.walls.len(), edges, "one wall for each edge");
            assert!(v.eaves - v.bottom >= 2252, "walls of 2.2 m at least");
            for wall in &v.walls {
                doors += usize::from(wall.ground_floor.door_bay.is_some());
                if wall.kind == WallKind::Party {
                    assert_eq!((wall.bays, wall.storeys.len()), (0, 0));
                } else {
                    assert_eq!(wall.storeys.iter().map(|s| s.height).sum::<i32>(), v.eaves - v.bottom);
                }
                assert!(wall.ground_floor.door_bay.is_none_or(|bay| bay < wall.bays));
            }
        }
        assert_eq!(doors, 1, "house {} has {doors} doors", house.id);
    }
    let kinds = |kind| plan.houses.iter().flat_map(|h| &h.volumes).flat_map(|v| &v.walls).filter(|w| w.kind == kind).count();
    let (street, yard, party) = (kinds(WallKind::Street), kinds(WallKind::Yard), kinds(WallKind::Party));
    assert!(street > 100 && yard > 100 && party > street, "{street} to streets, {yard} to yards, {party} to neighbours");
}

#[test]
fn a_row_faces_its_street_and_its_yard() {
    let plan = grown(&parsed(
        "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (60, 0))],
          links: [(from: 1, to: 2, kind: Street(Lane), width_m: 6)],
          buildings: [(id: 1, outline: [(10, 3), (20, 3), (20, 15), (10, 15)], height_m: 16),
                      (id: 2, outline: [(20, 3), (30, 3), (30, 15), (20, 15)], height_m: 15.5),
                      (id: 3, outline: [(30, 3), (40, 3), (40, 15), (30, 15)], height_m: 4)])",
    ))
    .plan;
    let kinds = |i: usize| plan.houses[i].volumes[0].walls.iter().map(|w| w.kind).collect::<Vec<_>>();
    use WallKind::{Party, Street, Yard};
    // From the south-west corner, counter-clockwise; find the southern wall first, since rings may begin anywhere.
    let turned = |i: usize| {
        let outer = &plan.houses[i].volumes[0].footprint.outer;
        let south = (0..4).find(|&k| outer[k].1 == outer[(k + 1) % 4].1 && outer[k].1 == 3 * 1024).expect("a southern wall");
        (0..4).map(|k| kinds(i)[(south + k) % 4]).collect::<Vec<_>>()
    };
    assert_eq!(turned(0)[..3], [Street, Party, Yard]);
    assert_eq!(turned(1)[0], Street);
    assert_ne!(turned(1)[1], Party, "a shed does not cover a house");
    assert_eq!(turned(2)[3], Party, "but the house covers the shed");
}

#[test]
fn towers_have_a_belfry_and_hanging_bodies_no_door() {
    let plan = grown(&parsed(
        "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (60, 0))],
          links: [(from: 1, to: 2, kind: Street(Lane), width_m: 6)],
          buildings: [(id: 1, name: \"Tower\", style: \"tower\", outline: [(10, 3), (18, 3), (18, 11), (10, 11)], height_m: 60),
                      (id: 2, outline: [(30, 3), (40, 3), (40, 15), (30, 15)], min_height_m: 4, height_m: 14)])",
    ))
    .plan;
    let top = plan.houses[0].volumes[0].walls[0].storeys.last().map(|s| s.opening);
    assert_eq!(top, Some(Opening::Belfry));
    let doors = |i: usize| plan.houses[i].volumes[0].walls.iter().filter(|w| w.ground_floor.door_bay.is_some()).count();
    assert_eq!((doors(0), doors(1)), (1, 0));
    assert!(plan.places.iter().any(|p| p.name == "Tower" && p.kind == veduta_city::PlaceKind::Monument));
    let tower = &plan.houses[0].volumes[0];
    assert_eq!(tower.eaves + tower.roof.height, 60 * 1024, "height is to the tip");
}

#[test]
fn objects_leave_houses_and_lamps_keep_off_the_carriageway() {
    let mut graph = crossing();
    graph.objects = parsed(
        "(name: \"T\", anchor: (lat: 50, lon: 14), objects: [(id: 1, kind: Bench, pos: (7, 9)), (id: 2, kind: Bench, pos: (20, -15)), (id: 3, kind: Well, pos: (38, 38)),
          (id: 4, kind: Well, pos: (9999, 0))])",
    )
    .objects;
    let growth = grown(&graph);
    let plan = &growth.plan;
    let is_in_house = |p| plan.houses.iter().flat_map(|h| &h.volumes).any(|v| v.footprint.contains(p));
    assert!(plan.objects.iter().all(|o| !is_in_house(o.pos) && o.height > 0));
    for id in [Id(1), Id(2), Id(4)] {
        assert!(growth.findings.iter().any(|f| f.id == id), "{id} is told: {:?}", growth.findings);
    }
    assert!(plan.objects.iter().any(|o| o.id == Id(3)));
    let bare = grown(&crossing()).plan;
    let lamps: Vec<_> = bare.objects.iter().filter(|o| o.kind == ObjectKind::Lamp).collect();
    assert!(lamps.len() >= 8, "{} lamps", lamps.len());
    for lamp in lamps {
        let under = bare.ground.iter().find(|g| g.outline.contains(lamp.pos)).map(|g| g.surface);
        assert!(matches!(under, Some(SurfaceKind::Mosaic | SurfaceKind::Cobbles)), "a lamp on {under:?}");
    }
}

#[test]
fn names_become_places_once() {
    let plan = grown(&crossing()).plan;
    let named = |name: &str| plan.places.iter().filter(|p| p.name == name).count();
    assert_eq!((named("Long Street"), named("Short Lane")), (1, 1));
    let start = veduta_city::GridPos::from_metres(plan.start.pos);
    assert!(plan.ground.iter().any(|g| g.surface.is_public() && g.outline.contains(start)), "a visit begins in a street");
}

#[test]
fn a_visit_begins_in_front_of_what_stands_in_the_way() {
    let chosen = Viewpoint { heading_deg: 90.0, ..grown(&crossing()).plan.start };
    let begins_with_a_fountain = |pos: DVec2| {
        let mut graph = crossing();
        graph.start = Some(chosen);
        let (kind, id) = (ObjectKind::Fountain, Id(7));
        graph.objects =
            vec![StandingObject { id, kind, pos, heading_deg: 0.0, height_m: 0.0, name: String::new(), monument: String::new() }];
        grown(&graph).plan.start
    };
    let moved = begins_with_a_fountain(chosen.pos);
    let away = moved.pos - chosen.pos;
    assert!(away.x < -ObjectKind::Fountain.radius_m() - 4.0 && away.y.abs() < 0.01, "it is looked at from the west: {away}");
    assert_eq!((moved.heading_deg, moved.eye_m), (90.0, chosen.eye_m));
    assert_eq!(begins_with_a_fountain(chosen.pos - DVec2::new(2.6, 0.0)), chosen, "beside it is where it was chosen to be");
}

#[test]
fn streets_without_houses_are_built_up() {
    let mut graph = synthetic::city(4, 9);
    graph.buildings.clear();
    graph.blocks.clear();
    let growth = grown(&graph);
    assert!(growth.plan.houses.len() > 150, "{} houses", growth.plan.houses.len());
    assert_eq!(overlaps(&growth.plan.houses), []);
    let streets: Vec<Polygon> =
        growth.plan.ground.iter().filter(|g| g.surface.is_public()).map(|g| geo_polygon(&g.outline)).collect();
    let streets: MultiPolygon = geo::algorithm::unary_union(&streets);
    for v in growth.plan.houses.iter().flat_map(|h| &h.volumes) {
        let inside = geo_polygon(&v.footprint).intersection(&streets).unsigned_area();
        assert!(inside < 0.1, "{inside} m² of a house stand in a street");
    }
}

#[test]
fn a_district_that_streets_cut_is_built_up_beside_them() {
    let mut graph = crossing();
    let district =
        parsed("(name: \"T\", anchor: (lat: 50, lon: 14), blocks: [(outline: [(-80, -70), (80, -70), (80, 70), (-80, 70)])])");
    graph.blocks = district.blocks;
    let plan = grown(&graph).plan;
    assert!(plan.houses.len() > 40, "{} houses", plan.houses.len());
    let centre = |h: &House| h.volumes[0].footprint.centroid();
    assert!(
        plan.houses.iter().all(|h| h.volumes[0].footprint.outer.iter().all(|v| v.to_metres().y.abs() > 5.9)),
        "the street is free"
    );
    assert!(plan.houses.iter().any(|h| centre(h).x < 0.0) && plan.houses.iter().any(|h| centre(h).x > 0.0));
}

#[test]
fn the_same_for_any_number_of_threads() {
    let mut graph = synthetic::city(3, 4);
    // With something to tell in one stage after another.
    graph.links.iter_mut().step_by(3).for_each(|link| link.width_m = 0.1);
    graph.margin_m = -1.0;
    let [a, b] = [graph.blocks[0].outline[0], graph.blocks[0].outline[1]].map(DVec2::round);
    let flat = vec![a, b, b + (b - a)];
    let blocks = (0..3).map(|i| Block { id: Id(900 + i), outline: flat.clone(), ..graph.blocks[0].clone() });
    graph.blocks.extend(blocks.collect::<Vec<_>>());
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        pool.install(|| grown(&graph))
    };
    let (alone, many) = (run(1), run(3));
    assert!(alone.findings.len() > 10, "{:?}", alone.findings);
    assert!(alone == many);
}

#[test]
fn outlines_lie_on_the_plans_grid() {
    let plan = grown(&synthetic::city(3, 4)).plan;
    let volumes = plan.houses.iter().flat_map(|house| &house.volumes).map(|volume| &volume.footprint);
    let outlines = volumes.chain(plan.ground.iter().map(|patch| &patch.outline)).chain([&plan.extent]);
    let vertices: Vec<_> = outlines.flat_map(GridPolygon::rings).flatten().collect();
    assert!(vertices.len() > 1_000 && vertices.iter().all(|p| p.is_on_plan()), "{} vertices", vertices.len());
    assert!(plan.objects.len() > 10 && plan.objects.iter().all(|object| object.pos.is_on_plan()));
}

#[test]
fn a_tunnel_without_room_for_its_ramp_is_told_and_not_laid() {
    let mut graph = crossing();
    graph.links[0].layer = -1;
    graph.links[0].id = Id(77);
    let growth = grown(&graph);
    assert!(growth.findings.iter().any(|f| f.id == Id(77) && f.message == "tunnel: not laid, for its last ramp has no room"));
    assert!(growth.plan.streets.iter().any(|s| s.id == Id(77) && !s.walkable));
}

#[test]
fn unsound_input_is_refused() {
    let bad = parsed("(name: \"T\", anchor: (lat: 50, lon: 14), links: [(from: 1, to: 2, kind: Watercourse)])");
    assert!(matches!(grow(&bad, &Stock::new()), Err(GrowthError::Graph(e)) if e.len() == 2));
    assert!(matches!(grow(&crossing(), &Stock::default()), Err(GrowthError::StyleCount(0))));
    let mut stock = Stock::new();
    stock.styles.0[0].walls.clear();
    assert!(matches!(grow(&crossing(), &stock), Err(GrowthError::Styles(e)) if e.len() == 1));
}

/// Any graph that passes its validation, sound in meaning or not.
fn any_graph() -> impl Strategy<Value = CityGraph> {
    let number = prop_oneof![8 => -120.0..120.0, 1 => Just(0.0), 1 => Just(8.9e5), 1 => Just(1e-9)];
    let point = (number.clone(), number.clone()).prop_map(|(x, y)| DVec2::new(x, y)).boxed();
    let ring = prop::collection::vec(point.clone(), 3..9).boxed();
    let odd = prop_oneof![Just(f64::NAN), Just(-3.0), Just(0.0), Just(1e12), 0.1..60.0].boxed();
    let building =
        (ring.clone(), prop::option::of(ring.clone()), prop::option::of(odd.clone()), prop::option::of(odd.clone()), 0..14_usize);
    let link = (0..6_usize, 0..6_usize, prop::collection::vec(point.clone(), 0..3), 0..9_usize, odd.clone(), -1..2_i8);
    (
        prop::collection::vec(point.clone(), 6),
        prop::collection::vec(link, 0..6),
        prop::collection::vec(building, 0..6),
        prop::collection::vec((ring.clone(), 0..4_usize), 0..4),
        prop::collection::vec(ring, 0..3),
        prop::collection::vec((point, odd.clone()), 0..4),
        odd,
    )
        .prop_map(|(nodes, links, buildings, blocks, squares, objects, margin_m)| {
            use veduta_city::{Block, BlockKind, Link, LinkKind, Node, RoofShape, Square, StreetClass, WidthAt};
            let kinds = [
                LinkKind::Street(StreetClass::Motorway),
                LinkKind::Street(StreetClass::Main),
                LinkKind::Street(StreetClass::Street),
                LinkKind::Street(StreetClass::Lane),
                LinkKind::Street(StreetClass::Path),
                LinkKind::Street(StreetClass::Steps),
                LinkKind::Railway { tram: false },
                LinkKind::Railway { tram: true },
                LinkKind::Watercourse,
            ];
            let shapes = [
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
            let mut graph = CityGraph { margin_m, ..CityGraph::default() };
            graph.nodes = (1..).zip(&nodes).map(|(id, &pos)| Node { id: Id(id), pos, z: 0.0 }).collect();
            let link = |(from, to, via, kind, width, layer): (usize, usize, Vec<DVec2>, usize, f64, i8)| Link {
                id: Id::NONE,
                from: Id(from as u64 + 1),
                to: Id(to as u64 + 1),
                via,
                kind: kinds[kind],
                width_m: if width.is_finite() { width } else { 0.0 },
                profile: [(0.3, width), (0.9, 8.0)]
                    .iter()
                    .filter(|(_, w)| kind % 2 == 1 && *w > 0.0 && *w <= 400.0)
                    .map(|&(share, width_m)| WidthAt { share, width_m })
                    .collect(),
                name: String::new(),
                layer,
                surfacing: None,
            };
            graph.links = links.into_iter().map(link).collect();
            graph.buildings = buildings
                .into_iter()
                .map(|(outline, hole, height_m, levels, shape)| {
                    let mut b = synthetic::building(outline);
                    b.holes.extend(hole);
                    (b.height_m, b.levels) = (height_m, levels);
                    b.roof.shape = shapes.get(shape).copied();
                    b.roof.height_m = levels;
                    b.min_height_m = height_m.unwrap_or(0.0);
                    b
                })
                .collect();
            let kinds = [BlockKind::Built, BlockKind::Park, BlockKind::Water, BlockKind::Monument];
            let block = |(outline, kind): (Vec<DVec2>, usize)| Block {
                id: Id::NONE,
                kind: kinds[kind],
                name: String::new(),
                district: String::new(),
                outline,
                holes: Vec::new(),
            };
            graph.blocks = blocks.into_iter().map(block).collect();
            let square =
                |outline| Square { id: Id::NONE, name: "S".into(), outline, holes: Vec::new(), surfacing: Default::default() };
            graph.squares = squares.into_iter().map(square).collect();
            let object = |(pos, height_m): (DVec2, f64)| StandingObject {
                id: Id::NONE,
                kind: ObjectKind::Tree,
                pos,
                heading_deg: height_m,
                height_m,
                name: String::new(),
                monument: String::new(),
            };
            graph.objects = objects.into_iter().map(object).collect();
            graph
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_sound_graph_grows_into_a_sound_plan(graph in any_graph()) {
        let plan = grown(&graph).plan;
        // Cities stretched by far vertices have thousands of empty tiles: only smaller ones are measured.
        let (overlap, gap) = if plan.ground.len() < 1000 { overlap_and_gap(&plan) } else { (0.0, 0.0) };
        let area = plan.extent.area_m2();
        prop_assert!(overlap.abs() < 1e-4 * area + 0.5 && gap.abs() < 1e-4 * area + 0.5, "overlap {overlap}, gap {gap} of {area}");
        for v in plan.houses.iter().flat_map(|h| &h.volumes) {
            prop_assert!(v.eaves > v.bottom && (v.roof.height >= 0 || !v.roof.is_there()));
            prop_assert!(v.footprint.area_m2() > 0.0);
            prop_assert_eq!(v.walls.len(), v.footprint.rings().map(Vec::len).sum::<usize>());
        }
    }

    #[test]
    fn lots_never_overlap(
        angles in prop::collection::vec((0.3..1.0_f64, 8.0..90.0_f64), 3..9),
        seed in 0..1000_u64,
    ) {
        // A star-shaped block of any size and corners.
        let total: f64 = angles.iter().map(|a| a.0).sum();
        let mut at = 0.0;
        let outline: Vec<DVec2> = angles.iter().map(|&(share, radius)| {
            at += share / total * core::f64::consts::TAU;
            DVec2::from_angle(at) * radius
        }).collect();
        let mut graph = parsed("(name: \"T\", anchor: (lat: 50, lon: 14), blocks: [(outline: [(0,0),(1,0),(1,1)])])");
        graph.blocks[0].outline = outline.clone();
        graph.seed = seed;
        let plan = grown(&graph).plan;
        prop_assert_eq!(overlaps(&plan.houses), []);
        let on_plan: Vec<DVec2> = outline.iter().map(|&p| veduta_city::GridPos::on_plan(p).to_metres()).collect();
        let block = Polygon::new(LineString::new(on_plan.iter().map(|p| Coord { x: p.x, y: p.y }).collect()), vec![]);
        for v in plan.houses.iter().flat_map(|h| &h.volumes) {
            let p = geo_polygon(&v.footprint);
            prop_assert!(p.is_valid(), "{:?}", v.footprint);
            prop_assert!(block.contains(&p) || p.difference(&block).unsigned_area() < 0.3, "a lot leaves its block");
        }
        if block.unsigned_area() > 400.0 {
            // A ring of houses ten metres deep, or all of a block that is narrower.
            let around: f64 = outline.iter().zip(outline.iter().cycle().skip(1)).map(|(a, b)| a.distance(*b)).sum();
            let ring = block.unsigned_area().min(around * 10.0);
            let share = plan.houses.iter().flat_map(|h| &h.volumes).map(|v| v.footprint.area_m2()).sum::<f64>() / ring;
            prop_assert!(share > 0.4, "only {share} of the {ring} m² along the edge of a block is built");
        }
    }
}
