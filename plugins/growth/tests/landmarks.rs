//! The landmarks of the sample city stand where their buildings do: whoever walks up to one is stopped where it is seen to begin.

use std::path::Path;

use glam::DVec2;
use veduta_city::{CityGraph, GridPolygon, file};
use veduta_growth::mesh::{MeshData, MonumentDetail, monument};
use veduta_growth::plan::{Stock, grow};

/// Heights between which a walker touches walls, and how far steps, bases and buttresses may stand out of a building's outline; metres.
const BODY_M: core::ops::Range<f64> = 0.6..2.0;
const OUT_M: f64 = 1.0;

fn graph() -> CityGraph {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/old_prague/old_prague.graph.ron");
    file::read(&path).unwrap_or_else(|e| panic!("{e}"))
}

fn distance_m(p: DVec2, polygon: &GridPolygon) -> f64 {
    if polygon.contains(veduta_city::GridPos::from_metres(p)) {
        return 0.0;
    }
    let edge = |a: DVec2, b: DVec2| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
        p.distance(a.lerp(b, t))
    };
    let ring = &polygon.outer;
    let edges = (0..ring.len()).map(|i| edge(ring[i].to_metres(), ring[(i + 1) % ring.len()].to_metres()));
    edges.fold(f64::INFINITY, f64::min)
}

#[test]
fn landmarks_stand_within_their_buildings() {
    let growth = grow(&graph(), &Stock::new()).unwrap_or_else(|e| panic!("{e}"));
    let about_monuments = |f: &&veduta_city::Finding| f.message.contains("monument");
    let wrong: Vec<String> = growth.findings.iter().filter(about_monuments).map(|f| f.message.clone()).collect();
    assert_eq!(wrong, [""; 0]);
    let landmarks: Vec<_> = growth.plan.houses.iter().filter_map(|house| Some((house, house.monument?))).collect();
    assert!(landmarks.len() >= 6, "{}", landmarks.len());
    let mut outside = Vec::new();
    for (house, placed) in landmarks {
        let design = &growth.plan.designs[usize::from(placed.design)];
        let mut mesh = MeshData::default();
        monument(design, &placed, MonumentDetail::FINE, &mut mesh);
        let foot = veduta_city::metres(placed.z);
        let mut farthest = (0.0, DVec2::ZERO);
        for p in &mesh.positions {
            let (at, up) = (DVec2::new(f64::from(p[0]), -f64::from(p[2])), f64::from(p[1]) - foot);
            if BODY_M.contains(&up) {
                let out = house.volumes.iter().map(|v| distance_m(at, &v.footprint)).fold(f64::INFINITY, f64::min);
                farthest = if out > farthest.0 { (out, at) } else { farthest };
            }
        }
        if farthest.0 > OUT_M {
            outside.push(format!("{} stands {:.2} m out of its building at {:.1}", house.name, farthest.0, farthest.1));
        }
    }
    assert_eq!(outside, [""; 0]);
}
