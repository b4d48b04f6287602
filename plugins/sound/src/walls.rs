use bevy::math::{DVec2, DVec3};
use veduta_city::{GridPos, Overview, metres};

/// More houses than this between ear and source make no difference.
pub(crate) const MOST: u32 = 4;

/// How many houses stand in the straight way between two points in plan space, of those that lie in a part of the overview; at most
/// [`MOST`]. A house that one of the points is in, or over, does not count: bells hang in towers.
pub(crate) fn between(overview: &Overview, a: DVec3, b: DVec3) -> u32 {
    let (lo, hi) = (a.min(b), a.max(b));
    let mut count = 0;
    for house in &overview.houses {
        let Some(first) = house.outline.outer.first() else { continue };
        let Some((low, high)) = house.outline.bounds() else { continue };
        let (low, high) = (low.to_metres(), high.to_metres());
        if low.x > hi.x || low.y > hi.y || high.x < lo.x || high.y < lo.y {
            continue;
        }
        let top_m = overview.terrain.height_m(first.to_metres()) + metres(house.height);
        if lo.z > top_m {
            continue;
        }
        let holds = |p: DVec3| house.outline.contains(GridPos::from_metres(p.truncate()));
        if holds(a) || holds(b) {
            continue;
        }
        // Where the way crosses the outline it must be lower than the ridge: roofs are taken for boxes.
        let is_hidden = house.outline.edges().any(|(from, to)| {
            crossing(a.truncate(), b.truncate(), from.to_metres(), to.to_metres())
                .is_some_and(|share| a.z + (b.z - a.z) * share < top_m)
        });
        if is_hidden {
            count += 1;
            if count >= MOST {
                return MOST;
            }
        }
    }
    count
}

/// Where a way from a to b crosses an edge from c to d, as a share of the way.
fn crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<f64> {
    let (way, edge) = (b - a, d - c);
    let across = way.perp_dot(edge);
    if across == 0.0 {
        return None;
    }
    let (share, along) = ((c - a).perp_dot(edge) / across, (c - a).perp_dot(way) / across);
    ((0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&along)).then_some(share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::{GridPolygon, Massing};

    fn house(x: i32, height_m: i32) -> Massing {
        let corners = [(x, -20), (x + 10, -20), (x + 10, 20), (x, 20)].map(|(x, y)| GridPos(x * 1_024, y * 1_024));
        Massing::block(GridPolygon::simple(corners.into()), height_m * 1_024)
    }

    fn overview() -> Overview {
        Overview { houses: vec![house(20, 15), house(40, 15), house(100, 60)], ..Overview::default() }
    }

    #[test]
    fn houses_between_count_and_roofs_are_looked_over() {
        let eye = DVec3::new(0.0, 0.0, 1.6);
        for (to, count, why) in [
            (DVec3::new(15.0, 0.0, 1.0), 0, "before the houses"),
            (DVec3::new(35.0, 0.0, 1.0), 1, "behind the first"),
            (DVec3::new(60.0, 0.0, 1.0), 2, "behind both"),
            (DVec3::new(60.0, 0.0, 70.0), 0, "high above the roofs"),
            (DVec3::new(60.0, 200.0, 1.0), 0, "beside them"),
            (DVec3::new(105.0, 0.0, 50.0), 1, "in a tower of its own: the nearest hides it, the second does not"),
            (DVec3::new(25.0, 0.0, 1.0), 0, "inside of the first"),
        ] {
            assert_eq!(between(&overview(), eye, to), count, "{why}");
            assert_eq!(between(&overview(), to, eye), count, "{why}, the other way");
        }
    }
}
