use super::drawn::{Rings, area, winds_around};
use super::*;

fn found(rings: &[Vec<DVec2>]) -> Skeleton {
    let mut skeletons = Skeletons::default();
    skeletons.find(rings.iter().map(Vec::as_slice)).unwrap_or_else(|e| panic!("{e}: {rings:?}")).clone()
}

fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&p| p.into()).collect()
}

fn face(skeleton: &Skeleton, face: &[u32]) -> Vec<DVec2> {
    face.iter().map(|&node| skeleton.nodes()[node as usize].truncate()).collect()
}

/// What has to be true of every skeleton, tried in other ways than the proof has.
fn try_it(rings: &[Vec<DVec2>], skeleton: &Skeleton) {
    let edges: Vec<(DVec2, DVec2)> = rings.iter().flat_map(|r| (0..r.len()).map(move |i| (r[i], r[(i + 1) % r.len()]))).collect();
    assert_eq!(skeleton.faces().len(), edges.len());
    let faces: Vec<Vec<DVec2>> = skeleton.faces().map(|f| face(skeleton, f)).collect();
    // Faces begin with their edges, exactly.
    for (face, &(a, b)) in faces.iter().zip(&edges) {
        assert_eq!((face[0], face[1]), (a, b));
    }
    // They cover what the rings enclose.
    let whole: f64 = rings.iter().map(|r| area(r)).sum();
    let sum: f64 = faces.iter().map(|f| area(f)).sum();
    let round: f64 = edges.iter().map(|(a, b)| a.distance(*b)).sum();
    assert!((sum - whole).abs() < 1e-3 * round, "{sum} of {whole}");
    // Every way from node to node is taken once each way, but for the edges.
    let mut ways: Vec<(u32, u32)> = Vec::new();
    for f in skeleton.faces() {
        ways.extend((1..f.len()).map(|i| (f[i], f[(i + 1) % f.len()])));
    }
    ways.sort_unstable();
    let is_paired = |&(a, b): &(u32, u32)| ways.binary_search(&(b, a)).is_ok();
    assert!(ways.windows(2).all(|w| w[0] != w[1]) && ways.iter().all(is_paired), "arcs between two faces each");
    // Places within lie in one face, but for those on arcs, and that is of an edge whose line is as far as the roof is high.
    let low = rings[0].iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = rings[0].iter().copied().reduce(DVec2::max).unwrap_or_default();
    for i in 0..16 {
        let p = low + (high - low) * DVec2::new((i as f64 * 0.618_034 + 0.137).fract(), (i as f64 * 0.754_877 + 0.313).fract());
        let is_within = rings.iter().filter(|r| winds_around(r, p)).count() % 2 == 1;
        let is_clear = faces.iter().flat_map(|f| (0..f.len()).map(move |i| (f[i], f[(i + 1) % f.len()]))).all(|(a, b)| {
            let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
            p.distance(a.lerp(b, t)) > 0.01
        });
        if is_clear {
            assert_eq!(faces.iter().filter(|f| winds_around(f, p)).count(), usize::from(is_within), "{p}");
        }
    }
}

#[test]
fn a_rectangle_has_a_ridge_of_its_length_less_its_width() {
    let skeleton = found(&[ring(&[(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (0.0, 4.0)])]);
    assert_eq!(skeleton.faces().map(<[u32]>::len).collect::<Vec<_>>(), [4, 3, 4, 3]);
    assert_eq!(skeleton.nodes().len(), 6);
    assert!(skeleton.nodes()[4..].iter().any(|n| n.distance(DVec3::new(8.0, 2.0, 2.0)) < 1e-9));
}

#[test]
fn what_happens_at_once_is_one_node() {
    for corners in [3, 4, 5, 6, 8, 12, 60] {
        let round: Vec<DVec2> =
            (0..corners).map(|i| DVec2::from_angle(f64::from(i) * core::f64::consts::TAU / f64::from(corners)) * 9.0).collect();
        let skeleton = found(core::slice::from_ref(&round));
        assert_eq!(skeleton.nodes().len(), round.len() + 1, "{corners} corners");
    }
    // A cross of five squares: four valleys and four ridges meet in the middle.
    let cross: [(f64, f64); 12] = [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)]
        .map(|(x, y)| (x.into(), y.into()));
    let skeleton = found(&[ring(&cross)]);
    assert_eq!(skeleton.nodes().len(), 12 + 4 + 1);
    assert!((skeleton.depth() - 0.5).abs() < 1e-9);
}

#[test]
fn a_courtyard_has_a_ridge_around_it() {
    let outer = ring(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
    let court = ring(&[(6.0, 6.0), (6.0, 14.0), (14.0, 14.0), (14.0, 6.0)]);
    let rings = [outer, court];
    let skeleton = found(&rings);
    assert!((skeleton.depth() - 3.0).abs() < 1e-9, "{}", skeleton.depth());
    try_it(&rings, &skeleton);
}

#[test]
fn of_convex_outlines_it_is_the_lowest_plane() {
    for number in 0..200 {
        let draw = veduta_city::draw::Draw::new(3, veduta_city::Id(number), "convex");
        let corners = 3 + draw.below("corners", 12);
        let at = |i: usize| (i as f64 + draw.part(i as u64).between("off", -0.4, 0.4)) * core::f64::consts::TAU / corners as f64;
        let outline: Vec<DVec2> = (0..corners).map(|i| DVec2::from_angle(at(i)) * 20.0).collect();
        let skeleton = found(core::slice::from_ref(&outline));
        for node in skeleton.nodes() {
            let away = |i: usize| {
                let (a, b) = (outline[i], outline[(i + 1) % corners]);
                (b - a).perp_dot(node.truncate() - a) / (b - a).length()
            };
            let lowest = (0..corners).map(away).fold(f64::INFINITY, f64::min);
            assert!((lowest - node.z).abs() < 1e-6, "{number}: {node} {lowest}");
        }
    }
}

#[test]
fn quadrilaterals_are_found_at_once_as_others_are() {
    let draw = |number: u64| veduta_city::draw::Draw::new(5, veduta_city::Id(number), "quad");
    let (mut at_once, mut skeletons, mut wavefront) = (0, Skeletons::default(), Wavefront::default());
    for number in 0..2000 {
        let between = |question: &str| draw(number).between(question, -1.9, 1.9);
        let (width, depth) = (draw(number).between("width", 5.0, 30.0), draw(number).between("depth", 5.0, 14.0));
        let quad = ring(&[
            (between("ax"), between("ay")),
            (width + between("bx"), between("by")),
            (width + between("cx"), depth + between("cy")),
            (between("dx"), depth + between("dy")),
        ]);
        let own = skeletons.find([quad.as_slice()]).unwrap_or_else(|e| panic!("{e}: {quad:?}")).clone();
        try_it(core::slice::from_ref(&quad), &own);
        at_once += u32::from(skeletons.is_plain_quad());
        assert!(wavefront.shrink(&quad, &[4], Jitter { by: 0.0, number: 0 }));
        wavefront.put_back(&quad);
        let nodes = |of: &Skeleton| {
            let mut nodes = of.nodes().to_vec();
            nodes.sort_by(|a, b| a.x.total_cmp(&b.x));
            nodes
        };
        let is_same = nodes(&own).iter().zip(nodes(&wavefront.skeleton)).all(|(a, b)| a.distance(b) < 1e-6);
        assert!(is_same && own.faces().map(<[u32]>::len).eq(wavefront.skeleton.faces().map(<[u32]>::len)), "{quad:?}");
    }
    assert!(at_once > 1900, "{at_once} of 2000");
}

#[test]
fn drawn_footprints_have_skeletons() {
    const COUNT: u64 = 20_000;
    let mut skeletons = Skeletons::default();
    let (mut tried, mut missing) = (0, 0);
    for rings in (0..COUNT).filter_map(drawn_footprint) {
        tried += 1;
        match skeletons.find(rings.iter().map(Vec::as_slice)) {
            Ok(skeleton) => try_it(&rings, skeleton),
            Err(_) => missing += 1,
        }
    }
    assert!(tried > COUNT * 9 / 10, "{tried} footprints");
    assert!(missing < COUNT / 1000, "{missing} of {tried} have none");
}

#[test]
fn the_same_footprint_elsewhere_has_the_same_skeleton() {
    let rings: Rings = vec![ring(&[(0.0, 0.0), (9.0, 0.0), (9.0, 4.0), (4.0, 4.0), (4.0, 9.0), (0.0, 9.0)])];
    let there: Rings = rings.iter().map(|r| r.iter().map(|p| *p + DVec2::new(4096.0, -2048.0)).collect()).collect();
    let (here, there) = (found(&rings), found(&there));
    assert!(here.faces().eq(there.faces()));
    let moved = |n: &DVec3| *n + DVec3::new(4096.0, -2048.0, 0.0);
    assert!(here.nodes().iter().map(moved).zip(there.nodes()).all(|(a, b)| a.distance(*b) < 1e-9));
}

#[test]
fn what_is_no_polygon_is_refused() {
    let mut skeletons = Skeletons::default();
    let mut error = |points: &[(f64, f64)]| skeletons.find([ring(points).as_slice()]).expect_err("no polygon");
    assert_eq!(error(&[(0.0, 0.0), (1.0, 0.0)]), SkeletonError::Degenerate { ring: 0, corner: 0 });
    assert_eq!(error(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 1.0)]), SkeletonError::Degenerate { ring: 0, corner: 1 });
    assert_eq!(error(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 5.0)]), SkeletonError::NotFound);
    assert_eq!(error(&[(0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)]), SkeletonError::NotFound, "clockwise");
    assert_eq!(error(&[(0.0, 0.0), (4.0, f64::NAN), (4.0, 4.0), (0.0, 4.0)]), SkeletonError::NotFound);
    assert_eq!(skeletons.find([]), Err(SkeletonError::NotFound));
    // The memory is as good as new after all that.
    assert!(skeletons.find([ring(&[(0.0, 0.0), (3.0, 0.0), (0.0, 4.0)]).as_slice()]).is_ok_and(|s| (s.depth() - 1.0).abs() < 1e-9));
}
