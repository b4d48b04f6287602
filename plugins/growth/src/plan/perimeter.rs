//! A ring of lots round the edge of a site.
//!
//! ```text
//!   p ─────┬────┬────┬───── p      corner lots lie on both streets, up to the foot of the
//!   │ corner│ lot│ lot│corner│      inner corner q on each; the sides between are cut at
//!   │   q ──┴────┴────┴── q  │      right angles into lots of the style's frontage
//!   ├──────┤  courtyard ├────┤
//! ```
//! Sides too short for a lot belong to the corner lot that goes round them. Where a site is too narrow for two rows back to
//! back it is sliced across instead.

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{GridPolygon, GridPos, Style};

use super::{boolean, outline};

/// Sides shorter than this belong to a corner; metres.
const SHORT_SIDE_M: f64 = 6.0;
/// Rests of sides shorter than this are joined to a corner lot; metres.
const SHORT_REST_M: f64 = 4.5;
/// Turns of more than this are corners; radians (30°).
const CORNER: f64 = core::f64::consts::FRAC_PI_6;
/// Least width of a courtyard between two rows; metres.
const LEAST_COURT_M: f64 = 5.0;
/// Shallowest row of houses that is tried before short sides are given up; metres.
const SHALLOWEST_M: f64 = 7.0;
/// Sides this close to a given house have no street before them; metres.
const BESIDE_M: f64 = 0.3;

/// A piece of ground to build on.
pub(super) struct Site<'a> {
    pub outline: &'a GridPolygon,
    /// Given houses beside it.
    pub houses: &'a [&'a GridPolygon],
    /// Diameter of the largest disc in it, metres; or of one as large as [`enough_m`].
    pub width_m: f64,
}

/// Sites in which a disc of this radius lies are wide for houses of a style; metres.
pub(super) fn enough_m(style: &Style) -> f64 {
    style.depth_m.1 + LEAST_COURT_M / 2.0
}

/// Lots of a site, on the grid, in order round it. They may overlap a little in odd corners and reach beyond the site: the
/// caller cuts them.
pub(super) fn lots(site: &Site<'_>, style: &Style, draw: Draw) -> Vec<GridPolygon> {
    let width = site.width_m;
    let depth = draw.between("depth", style.depth_m.0, style.depth_m.1);
    let bounds = outline::smallest_box(&site.outline.outer);
    let is_compact = site.outline.area_m2() > 0.6 * bounds.length_m * bounds.width_m;
    if width < 1.3 * style.depth_m.1 && is_compact {
        return slices(site.outline, style, draw);
    }
    let depth = if !is_compact && width < 1.3 * style.depth_m.1 {
        depth.min(width)
    } else if width < 2.0 * depth + LEAST_COURT_M {
        width / 2.0
    } else {
        depth
    };
    let ring = ring_lots(site, depth, style, draw);
    if ring.is_empty() { slices(site.outline, style, draw) } else { ring }
}

/// Houses from one side of a narrow site to the other.
fn slices(site: &GridPolygon, style: &Style, draw: Draw) -> Vec<GridPolygon> {
    let bounds = outline::smallest_box(&site.outer);
    let base = site.outer.first().map_or(DVec2::ZERO, |p| p.to_metres());
    let low = site.outer.iter().map(|p| (p.to_metres() - base).dot(bounds.along)).fold(f64::INFINITY, f64::min);
    let cuts = cuts(bounds.length_m, style, draw);
    let mut out = Vec::new();
    let mut rest = vec![site.clone()];
    let reach = bounds.length_m + bounds.width_m + 10.0;
    for &s in &cuts[1..cuts.len() - 1] {
        // Everything before the cut.
        let at = base + bounds.along * (low + s);
        let side = bounds.along.perp() * reach;
        let half = [at - side - bounds.along * reach, at - side, at + side, at + side - bounds.along * reach];
        let half: Vec<GridPos> = half.map(GridPos::on_plan).to_vec();
        let (before, after) = boolean::split(&boolean::rings(&rest), &[&half]);
        out.extend(before);
        rest = after;
    }
    out.extend(rest);
    out
}

/// Where a length is cut into lots: 0, …, `length_m`. Frontages differ by up to a fifth and fill the length.
fn cuts(length_m: f64, style: &Style, draw: Draw) -> Vec<f64> {
    let frontage = draw.between("frontage", style.frontage_m.0, style.frontage_m.1);
    let n = (libm::round(length_m / frontage) as usize).clamp(1, 10_000);
    let weights: Vec<f64> = (0..n).map(|i| draw.part(i as u64).between("share", 0.8, 1.2)).collect();
    let sum: f64 = weights.iter().sum();
    let mut at = 0.0;
    let mut cuts = vec![0.0];
    for weight in &weights[..n - 1] {
        at += weight / sum * length_m;
        cuts.push(at);
    }
    cuts.push(length_m);
    cuts
}

/// A side long enough for lots.
#[derive(Debug, Clone)]
struct Side {
    a: DVec2,
    dir: DVec2,
    length: f64,
    is_frontage: bool,
    /// Vertices from its end to the next side's start, both included.
    chain: Vec<DVec2>,
}

impl Side {
    fn at(&self, s: f64) -> DVec2 {
        self.a + self.dir * s
    }
    fn inward(&self) -> DVec2 {
        self.dir.perp()
    }
}

/// One end of a side's row of lots.
#[derive(Debug, Clone, Copy)]
struct Cut {
    s: f64,
    inner: DVec2,
}

/// What stands between a side and the next.
#[derive(Debug, Clone)]
struct Joint {
    end: Cut,
    start: Cut,
    has_corner: bool,
}

fn ring_lots(site: &Site<'_>, depth: f64, style: &Style, draw: Draw) -> Vec<GridPolygon> {
    let ring: Vec<DVec2> = site.outline.outer.iter().map(|p| p.to_metres()).collect();
    let mut depth = depth;
    let mut is_short: Vec<bool> = (0..ring.len()).map(|i| ring[i].distance(ring[(i + 1) % ring.len()]) < SHORT_SIDE_M).collect();
    // Each round shortens the depth once or gives up one side: it ends.
    for _ in 0..ring.len() + 2 {
        let sides = sides(&ring, &is_short, site.houses);
        if sides.len() < 2 || !sides.iter().any(|s| s.0.is_frontage) {
            return Vec::new();
        }
        let joints: Vec<Joint> = (0..sides.len()).map(|i| joint(&sides[i].0, &sides[(i + 1) % sides.len()].0, depth)).collect();
        let rest = |i: usize| joints[i].end.s - joints[(i + sides.len() - 1) % sides.len()].start.s;
        let worst = (0..sides.len()).filter(|&i| sides[i].0.is_frontage).min_by(|&i, &j| rest(i).total_cmp(&rest(j)));
        match worst {
            Some(i) if rest(i) < -0.01 => {
                let length = sides[i].0.length;
                let fitting = depth * length / (length - rest(i));
                if fitting >= SHALLOWEST_M.min(depth * 0.95) && fitting < depth * 0.999 {
                    depth = fitting;
                } else {
                    is_short[sides[i].1] = true;
                }
            }
            _ => return build(&sides, &joints, depth, style, draw),
        }
    }
    Vec::new()
}

/// The long sides of a ring with the index of their first vertex, and the chains between them.
fn sides(ring: &[DVec2], is_short: &[bool], houses: &[&GridPolygon]) -> Vec<(Side, usize)> {
    let n = ring.len();
    let long: Vec<usize> = (0..n).filter(|&i| !is_short[i]).collect();
    let side = |k: usize| {
        let (i, next) = (long[k], long[(k + 1) % long.len()]);
        let (a, b) = (ring[i], ring[(i + 1) % n]);
        let steps = (next + n - (i + 1) % n) % n;
        let chain = (0..=steps).map(|j| ring[(i + 1 + j) % n]).collect();
        let middle = (a + b) / 2.0;
        let is_beside =
            |h: &&GridPolygon| h.edges().any(|(p, q)| outline::distance_to_edge(middle, p.to_metres(), q.to_metres()) < BESIDE_M);
        let dir = (b - a).normalize_or(DVec2::X);
        (Side { a, dir, length: a.distance(b), is_frontage: !houses.iter().any(is_beside), chain }, i)
    };
    (0..long.len()).map(side).collect()
}

/// The intersection of two lines; `None` if they are almost parallel.
fn meet(p: DVec2, u: DVec2, q: DVec2, v: DVec2) -> Option<DVec2> {
    let cross = u.perp_dot(v);
    (cross.abs() > 0.05).then(|| p + u * ((q - p).perp_dot(v) / cross))
}

/// How two sides that follow one another are joined.
fn joint(a: &Side, b: &Side, depth: f64) -> Joint {
    let turn = libm::atan2(a.dir.perp_dot(b.dir), a.dir.dot(b.dir));
    let (ia, ib) = (a.at(a.length) + a.inward() * depth, b.a + b.inward() * depth);
    let plain = Joint { end: Cut { s: a.length, inner: ia }, start: Cut { s: 0.0, inner: ib }, has_corner: false };
    let inner = meet(ia, a.dir, ib, b.dir);
    if !(a.is_frontage && b.is_frontage) {
        // The row runs up to the house beside it.
        let mut joint = plain;
        if turn > CORNER {
            if let Some(p) = meet(ia, a.dir, b.a, b.dir).filter(|p| p.distance(ia) < 2.0 * depth) {
                joint.end.inner = p;
            }
            if let Some(p) = meet(ib, b.dir, a.a, a.dir).filter(|p| p.distance(ib) < 2.0 * depth) {
                joint.start.inner = p;
            }
        }
        return joint;
    }
    if turn > CORNER
        && let Some(q) = inner
    {
        let (s, t) = ((q - a.a).dot(a.dir), (q - b.a).dot(b.dir));
        if s <= a.length && t >= 0.0 {
            return Joint { end: Cut { s, inner: q }, start: Cut { s: t, inner: q }, has_corner: true };
        }
    }
    let middle = (a.at(a.length) + b.a) / 2.0;
    let q = inner.filter(|q| q.distance(middle) < 2.0 * depth).unwrap_or((ia + ib) / 2.0);
    Joint { end: Cut { s: a.length, inner: q }, start: Cut { s: 0.0, inner: q }, has_corner: false }
}

fn build(sides: &[(Side, usize)], joints: &[Joint], depth: f64, style: &Style, draw: Draw) -> Vec<GridPolygon> {
    let n = sides.len();
    // Corner lots as outer path and inner path (back again), grown where a side's rest is too short for a lot.
    let corner = |i: usize| -> (Vec<DVec2>, Vec<DVec2>) {
        let (side, next) = (&sides[i].0, &sides[(i + 1) % n].0);
        let outer = core::iter::once(side.at(joints[i].end.s)).chain(side.chain.iter().copied());
        (outer.chain([next.at(joints[i].start.s)]).collect(), vec![joints[i].end.inner])
    };
    let mut corners: Vec<_> = (0..n).map(|i| joints[i].has_corner.then(|| corner(i))).collect();
    let mut rows: Vec<Vec<GridPolygon>> = vec![Vec::new(); n];
    for i in 0..n {
        let (side, before) = (&sides[i].0, (i + n - 1) % n);
        let (start, end) = (joints[before].start, joints[i].end);
        let rest = end.s - start.s;
        if !side.is_frontage || rest < 0.05 {
            continue;
        }
        if rest < SHORT_REST_M && joints[i].has_corner {
            if let Some((outer, inner)) = &mut corners[i] {
                outer.insert(0, side.at(start.s));
                inner.push(start.inner);
            }
            continue;
        }
        if rest < SHORT_REST_M && joints[before].has_corner {
            if let Some((outer, inner)) = &mut corners[before] {
                outer.push(side.at(end.s));
                inner.insert(0, end.inner);
            }
            continue;
        }
        let tail = if joints[i].has_corner { &[][..] } else { &side.chain[1..] };
        rows[i] = row(side, start, end, tail, depth, style, draw.part(sides[i].1 as u64));
    }
    let close = |path: (Vec<DVec2>, Vec<DVec2>)| polygon(path.0.into_iter().chain(path.1));
    rows.into_iter().zip(corners).flat_map(|(row, corner)| row.into_iter().chain(corner.map(close))).collect()
}

/// The lots of one side between two cuts; the last also takes the bend (`tail`) after the side.
fn row(side: &Side, start: Cut, end: Cut, tail: &[DVec2], depth: f64, style: &Style, draw: Draw) -> Vec<GridPolygon> {
    let cuts = cuts(end.s - start.s, style, draw);
    let last = cuts.len() - 1;
    let outer = |k: usize| if k == last { side.at(end.s) } else { side.at(start.s + cuts[k]) };
    let inner = |k: usize| match k {
        0 => start.inner,
        k if k == last => end.inner,
        _ => outer(k) + side.inward() * depth,
    };
    let lot = |k: usize| {
        let tail = if k + 1 == last { tail } else { &[] };
        polygon([outer(k), outer(k + 1)].into_iter().chain(tail.iter().copied()).chain([inner(k + 1), inner(k)]))
    };
    (0..last).map(lot).collect()
}

fn polygon(path: impl Iterator<Item = DVec2>) -> GridPolygon {
    let mut ring: Vec<GridPos> = path.map(GridPos::on_plan).collect();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    GridPolygon::simple(ring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Stock;
    use crate::plan::inradius::inradius_m;
    use veduta_city::Id;

    fn site(of: &[(f64, f64)]) -> GridPolygon {
        let ring: Vec<DVec2> = of.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        outline::polygons(&ring, &[]).remove(0)
    }

    fn lots_of(outline: &GridPolygon) -> Vec<GridPolygon> {
        let styles = Stock::new().styles;
        lots(
            &Site { outline, houses: &[], width_m: 2.0 * inradius_m(outline, enough_m(&styles.0[0])) },
            &styles.0[0],
            Draw::new(1, Id(1), "test"),
        )
    }

    #[test]
    fn a_block_gets_a_ring_of_lots_round_a_courtyard() {
        let outline = site(&[(0.0, 0.0), (60.0, 0.0), (60.0, 50.0), (0.0, 50.0)]);
        let lots = lots_of(&outline);
        assert!((14..=28).contains(&lots.len()), "{} lots", lots.len());
        let area: f64 = lots.iter().map(GridPolygon::area_m2).sum();
        assert!(area < 0.95 * 3000.0, "a courtyard is left: {area}");
        let together: f64 = boolean::union(&boolean::rings(&lots)).iter().map(GridPolygon::area_m2).sum();
        assert!((area - together).abs() < 1.0, "lots do not overlap: {area} {together}");
        for (i, lot) in lots.iter().enumerate() {
            let shared = lots.iter().enumerate().filter(|&(j, _)| j != i).flat_map(|(_, l)| &l.outer);
            let n = lot.outer.iter().filter(|v| shared.clone().any(|w| w == *v)).count();
            assert!(n >= 3, "party walls share their vertices: lot {i} shares {n}");
        }
    }

    #[test]
    fn a_narrow_block_is_sliced_across() {
        let outline = site(&[(0.0, 0.0), (60.0, 0.0), (60.0, 11.0), (0.0, 11.0)]);
        let lots = lots_of(&outline);
        assert!((5..=9).contains(&lots.len()), "{} lots", lots.len());
        assert!((lots.iter().map(GridPolygon::area_m2).sum::<f64>() - 660.0).abs() < 0.1);
    }

    #[test]
    fn a_chamfered_corner_is_one_house() {
        let outline = site(&[(0.0, 0.0), (57.0, 0.0), (60.0, 3.0), (60.0, 50.0), (0.0, 50.0)]);
        let corner = GridPos::from_metres(DVec2::new(58.0, 2.0));
        assert_eq!(lots_of(&outline).iter().filter(|l| l.contains(corner)).count(), 1);
    }
}
