//! How grown houses stand on their lots: from party wall to party wall, apart, or stepping back.

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{GridPolygon, GridPos, Range, RoofShape, RoofTags, Stand, Style};

use super::houses::Body;
use super::outline;
use super::relation::is_convex;

/// The bodies of a house of a style on a lot: heights of its ground floor and upper storeys in metres, and how many there are. `None`
/// where there is no room.
pub(super) fn bodies(
    lot: GridPolygon,
    style: &Style,
    (ground_m, upper_m, storeys): (f64, f64, usize),
    draw: Draw,
) -> Option<Vec<Body>> {
    Some(match style.stand {
        Stand::Row => vec![body(lot)],
        Stand::Detached(apart_m) => vec![body(detached(&lot, apart_m)?)],
        Stand::Setbacks { podium, share } => setbacks(lot, (podium, share), (ground_m, upper_m, storeys), draw),
    })
}

fn body(footprint: GridPolygon) -> Body {
    Body {
        footprint,
        bottom_m: 0.0,
        height_m: None,
        levels: None,
        roof: RoofTags::default(),
        colour: None,
        opening: None,
        is_covered: false,
    }
}

/// Longest side of a detached house, and least width that one is built on; metres.
const LONGEST_DETACHED_M: f64 = 15.0;
const LEAST_DETACHED_M: f64 = 5.5;

/// A rectangle in the middle of a lot, apart from its edges.
fn detached(lot: &GridPolygon, apart_m: f64) -> Option<GridPolygon> {
    let bounds = outline::smallest_box(&lot.outer);
    let centre = lot.centroid();
    let edges: Vec<(DVec2, DVec2)> = outline::edges(&lot.outer).map(|(a, b)| (a.to_metres(), b.to_metres())).collect();
    let mut half = (DVec2::new(bounds.length_m, bounds.width_m) / 2.0 - apart_m).min(DVec2::splat(LONGEST_DETACHED_M / 2.0));
    // Lots are no rectangles: smaller until all corners are clear.
    for _ in 0..12 {
        if 2.0 * half.min_element() < LEAST_DETACHED_M {
            return None;
        }
        let (x, y) = (bounds.along * half.x, bounds.along.perp() * half.y);
        let corners = [centre - x - y, centre + x - y, centre + x + y, centre - x + y];
        let is_clear = |p: DVec2| {
            lot.contains(GridPos::from_metres(p))
                && edges.iter().all(|&(a, b)| outline::distance_to_edge(p, a, b) >= 0.85 * apart_m)
        };
        if corners.into_iter().all(is_clear) {
            return Some(GridPolygon::simple(corners.map(GridPos::on_plan).to_vec()));
        }
        half *= 0.92;
    }
    None
}

/// A podium over a lot and two steps on it, each narrower than the one below. Where a lot is not convex, the podium goes all the way up.
fn setbacks(
    lot: GridPolygon,
    ((low, high), share): ((u8, u8), Range),
    (ground_m, upper_m, storeys): (f64, f64, usize),
    draw: Draw,
) -> Vec<Body> {
    let top = |n: usize| ground_m + (n.max(1) - 1) as f64 * upper_m;
    let podium = usize::from(low) + draw.below("podium", usize::from(high.saturating_sub(low)) + 1);
    let flat = RoofTags { shape: Some(RoofShape::Flat), ..RoofTags::default() };
    if podium + 2 > storeys || !is_convex(&lot.outer) {
        return vec![Body { height_m: Some(top(storeys)), roof: flat, ..body(lot) }];
    }
    let second = podium + ((storeys - podium) as f64 * draw.between("second", 0.55, 0.8)) as usize;
    let mut out = vec![Body { height_m: Some(top(podium)), roof: flat, ..body(lot) }];
    for (i, (from, to)) in [(podium, second), (second, storeys)].into_iter().enumerate() {
        let Some(below) = out.last_mut() else { break };
        let (centre, share) = (below.footprint.centroid(), draw.part(i as u64).between("share", share.0, share.1));
        let ring = below.footprint.outer.iter().map(|p| GridPos::on_plan(centre + (p.to_metres() - centre) * share)).collect();
        let step = body(GridPolygon::simple(ring));
        if to <= from || step.footprint.area_m2() < LEAST_STEP_M2 {
            below.height_m = Some(top(storeys));
            break;
        }
        below.is_covered = true;
        out.push(Body { bottom_m: top(from), height_m: Some(top(to)), roof: flat, ..step });
    }
    out
}

/// Steps smaller than this are left out; square metres.
const LEAST_STEP_M2: f64 = 60.0;

#[cfg(test)]
mod tests {
    use veduta_city::Id;

    use super::*;
    use crate::plan::Stock;

    fn lot(corners: &[(f64, f64)]) -> GridPolygon {
        GridPolygon::simple(corners.iter().map(|&(x, y)| GridPos::from_metres(DVec2::new(x, y))).collect())
    }

    #[test]
    fn a_detached_house_is_clear_of_its_lot() {
        let lots = [
            lot(&[(0.0, 0.0), (18.0, 0.0), (18.0, 24.0), (0.0, 24.0)]),
            lot(&[(0.0, 0.0), (20.0, 3.0), (15.0, 26.0), (-3.0, 20.0)]),
        ];
        for lot in lots {
            let house = detached(&lot, 3.0).expect("there is room");
            assert!(house.area_m2() > 50.0 && house.outer.iter().all(|&p| lot.contains(p)), "{}", house.area_m2());
            for (a, b) in outline::edges(&lot.outer).map(|(a, b)| (a.to_metres(), b.to_metres())) {
                assert!(house.outer.iter().all(|p| outline::distance_to_edge(p.to_metres(), a, b) > 2.5));
            }
        }
        assert_eq!(detached(&lot(&[(0.0, 0.0), (9.0, 0.0), (9.0, 24.0), (0.0, 24.0)]), 3.0), None);
    }

    #[test]
    fn steps_stand_on_one_another_and_grow_narrower() {
        let styles = Stock::new().styles;
        let style = &styles.0[styles.find("skyscraper").expect("stock")];
        let whole = lot(&[(0.0, 0.0), (34.0, 0.0), (36.0, 30.0), (0.0, 30.0)]);
        for i in 0..50 {
            let bodies = bodies(whole.clone(), style, (5.5, 3.7, 26), Draw::new(1, Id(i), "t")).expect("a house");
            assert_eq!(bodies.len(), 3);
            for pair in bodies.windows(2) {
                assert_eq!(pair[0].height_m, Some(pair[1].bottom_m));
                assert!(pair[0].is_covered && pair[1].footprint.outer.iter().all(|&p| pair[0].footprint.contains(p)));
            }
            let top = bodies[2].height_m.expect("it is told");
            assert!((top - (5.5 + 25.0 * 3.7)).abs() < 1e-9, "{top}");
        }
        // A lot too small for steps goes up as it is, one too small for the second step ends with the first.
        for (side, count) in [(7.0, 1), (10.0, 1), (12.0, 2)] {
            let lot = lot(&[(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]);
            for i in 0..50 {
                let bodies = bodies(lot.clone(), style, (5.5, 3.7, 26), Draw::new(1, Id(i), "t")).expect("a house");
                let top = bodies[bodies.len() - 1].height_m.expect("it is told");
                assert!(bodies.len() <= count + 1 && (top - (5.5 + 25.0 * 3.7)).abs() < 1e-9, "{side}: {top}");
            }
        }
        let ell = lot(&[(0.0, 0.0), (30.0, 0.0), (30.0, 10.0), (10.0, 10.0), (10.0, 30.0), (0.0, 30.0)]);
        assert_eq!(bodies(ell, style, (5.5, 3.7, 26), Draw::new(1, Id(1), "t")).map(|b| b.len()), Some(1));
    }
}
