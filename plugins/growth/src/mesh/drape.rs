use glam::{DVec2, DVec3};
use veduta_city::{CellShell, PlanTerrain, metres};

use super::outline::engine;

/// Lays what lies on the ground on a cell's terrain: cuts it along the lines on which the ground bends. A line that two shapes have in
/// common is cut in the same places for both.
pub(super) struct Drape<'a> {
    terrain: &'a PlanTerrain,
    origin: DVec2,
    step: f64,
}

/// Nearer to a line than this is on it; shares of the distance between posts.
const ON_LINE: f64 = 1e-9;

impl<'a> Drape<'a> {
    pub(super) fn of(shell: &'a CellShell) -> Self {
        let terrain = &shell.terrain;
        Self { terrain, origin: terrain.origin.to_metres(), step: metres(terrain.step.max(1)) }
    }

    pub(super) const fn is_level(&self) -> bool {
        self.terrain.is_level()
    }

    /// Height of the ground at a place.
    pub(super) fn y(&self, p: DVec2) -> f64 {
        self.terrain.height_m(p)
    }

    /// A place so far above the ground, in the engine's axes.
    pub(super) fn above(&self, p: DVec2, lift: f64) -> DVec3 {
        engine(p, self.y(p) + lift)
    }

    /// The ground's normal at a place, smooth from square to square.
    pub(super) fn normal(&self, p: DVec2) -> [f32; 3] {
        if self.is_level() {
            return [0.0, 1.0, 0.0];
        }
        let slope = self.terrain.slope(p);
        DVec3::new(-slope.x, 1.0, slope.y).normalize().as_vec3().to_array()
    }

    /// The places at which a straight way bends with the ground, its ends among them: those at which [`Drape::pieces`] cuts a polygon
    /// along it.
    pub(super) fn way(&self, a: DVec2, b: DVec2) -> Vec<DVec2> {
        let mut way = vec![a, b];
        if self.is_level() {
            return way;
        }
        for family in [Family::East, Family::North, Family::Diagonal] {
            let mut cut = Vec::with_capacity(way.len() + 4);
            for pair in way.windows(2) {
                cut.push(pair[0]);
                self.cut_edge(pair[0], pair[1], family, &mut cut);
            }
            cut.push(b);
            way = cut;
        }
        way
    }

    /// Adds where an edge crosses the lines of a family, from its first end on.
    fn cut_edge(&self, p: DVec2, q: DVec2, family: Family, out: &mut Vec<DVec2>) {
        let (from, to) = (self.place(p, family), self.place(q, family));
        let (mut low, high) = if from < to { (p, q) } else { (q, p) };
        let first = out.len();
        for line in self.lines(from.min(to), from.max(to), family) {
            let offset = |p: DVec2| (p, self.place(p, family) - line);
            low = self.crossing(offset(low), offset(high), family, line);
            out.push(low);
        }
        if from > to {
            out[first..].reverse();
        }
    }

    /// Lowest ground along a straight way.
    pub(super) fn lowest(&self, a: DVec2, b: DVec2) -> f64 {
        self.terrain.range_along(a, b).0
    }

    /// Highest ground along a straight way.
    pub(super) fn highest(&self, a: DVec2, b: DVec2) -> f64 {
        self.terrain.range_along(a, b).1
    }

    /// Calls `each` with the pieces of a convex polygon on each of which the ground is flat; convex and turned alike.
    pub(super) fn pieces(&self, polygon: &[DVec2], mut each: impl FnMut(&[DVec2])) {
        if self.is_level() {
            return each(polygon);
        }
        let mut pieces = vec![polygon.to_vec()];
        for family in [Family::East, Family::North, Family::Diagonal] {
            pieces = pieces.into_iter().flat_map(|piece| self.cut_all(piece, family)).collect();
        }
        pieces.iter().for_each(|piece| each(piece));
    }

    /// The lines of a family between two places on which the ground bends: none lie beyond the posts.
    fn lines(&self, low: f64, high: f64, family: Family) -> impl Iterator<Item = f64> + use<> {
        let (columns, rows) =
            (f64::from(self.terrain.columns), (self.terrain.heights.len() as f64 / f64::from(self.terrain.columns)).floor());
        let (least, most) = match family {
            Family::East => (0.0, columns - 1.0),
            Family::North => (0.0, rows - 1.0),
            Family::Diagonal => (1.0 - columns, rows - 1.0),
        };
        let (first, last) = (((low + ON_LINE).floor() + 1.0).max(least), ((high - ON_LINE).ceil() - 1.0).min(most));
        let count = (last - first + 1.0).max(0.0) as u32;
        (0..count).map(move |i| first + f64::from(i))
    }

    /// How many lines of a family lie before a place.
    fn place(&self, p: DVec2, family: Family) -> f64 {
        let local = (p - self.origin) / self.step;
        match family {
            Family::East => local.x,
            Family::North => local.y,
            Family::Diagonal => local.y - local.x,
        }
    }

    /// A polygon cut along all lines of a family.
    fn cut_all(&self, polygon: Vec<DVec2>, family: Family) -> Vec<Vec<DVec2>> {
        let (low, high) = polygon
            .iter()
            .map(|&p| self.place(p, family))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), f| (low.min(f), high.max(f)));
        let (mut out, mut rest) = (Vec::new(), polygon);
        for line in self.lines(low, high, family) {
            let (below, above) = self.cut(&rest, family, line);
            out.extend((below.len() >= 3).then_some(below));
            rest = above;
        }
        out.extend((rest.len() >= 3).then_some(rest));
        out
    }

    /// A convex polygon's parts before and beyond a line.
    fn cut(&self, polygon: &[DVec2], family: Family, line: f64) -> (Vec<DVec2>, Vec<DVec2>) {
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (f, g) = (self.place(p, family) - line, self.place(q, family) - line);
            if f <= ON_LINE {
                below.push(p);
            }
            if f >= -ON_LINE {
                above.push(p);
            }
            if f.abs() > ON_LINE && g.abs() > ON_LINE && (f < 0.0) != (g < 0.0) {
                let crossing = self.crossing((p, f), (q, g), family, line);
                below.push(crossing);
                above.push(crossing);
            }
        }
        (below, above)
    }

    /// Where an edge crosses a line: the same whichever way the edge runs.
    fn crossing(&self, a: (DVec2, f64), b: (DVec2, f64), family: Family, line: f64) -> DVec2 {
        let is_forth = (a.0.x, a.0.y) < (b.0.x, b.0.y);
        let ((p, f), (q, g)) = if is_forth { (a, b) } else { (b, a) };
        let crossing = p + (q - p) * (f / (f - g));
        match family {
            Family::East => DVec2::new(self.origin.x + line * self.step, crossing.y),
            Family::North => DVec2::new(crossing.x, self.origin.y + line * self.step),
            Family::Diagonal => crossing,
        }
    }
}

/// Parallel lines on which the ground bends.
#[derive(Clone, Copy)]
enum Family {
    East,
    North,
    Diagonal,
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;
    use veduta_city::GridPos;

    use super::super::outline::area;
    use super::*;

    fn hill() -> CellShell {
        let heights = (0..36).map(|i| (i * i * 379) % 5_000).collect();
        let terrain = PlanTerrain { origin: GridPos(-10_240, -10_240), step: 4096, columns: 6, heights };
        CellShell { terrain, ..CellShell::default() }
    }

    fn point() -> impl Strategy<Value = DVec2> {
        (-12_000..12_000_i32, -12_000..12_000_i32).prop_map(|(x, y)| GridPos(x, y).to_metres())
    }

    proptest! {
        #[test]
        fn a_way_bends_where_polygons_along_it_are_cut(a in point(), b in point(), c in point()) {
            prop_assume!((b - a).perp_dot(c - a) > 1e-3);
            let shell = hill();
            let drape = Drape::of(&shell);
            let way = drape.way(a, b);
            let mut corners = Vec::new();
            drape.pieces(&[a, b, c], |piece| corners.extend(piece.iter().copied()));
            for p in &way {
                prop_assert!(corners.contains(p), "{p}");
            }
            for pair in way.windows(2) {
                prop_assert!((b - a).dot(pair[1] - pair[0]) >= 0.0);
            }
        }

        #[test]
        fn pieces_fill_a_triangle_and_the_ground_is_flat_on_each(a in point(), b in point(), c in point()) {
            prop_assume!((b - a).perp_dot(c - a) > 1e-3);
            let shell = hill();
            let drape = Drape::of(&shell);
            let mut sum = 0.0;
            let mut sound = Ok(());
            drape.pieces(&[a, b, c], |piece| {
                sum += area(piece);
                let middle = piece.iter().sum::<DVec2>() / piece.len() as f64;
                let mean = piece.iter().map(|&p| drape.y(p)).sum::<f64>() / piece.len() as f64;
                if (drape.y(middle) - mean).abs() > 1e-6 || area(piece) < -1e-9 {
                    sound = Err(format!("{piece:?}"));
                }
            });
            prop_assert_eq!(sound, Ok(()));
            prop_assert!((sum - area(&[a, b, c])).abs() < 1e-6);
        }

        #[test]
        fn two_shapes_are_cut_alike_where_they_meet(a in point(), b in point(), c in point(), d in point()) {
            let left = |p: DVec2| (b - a).perp_dot(p - a);
            prop_assume!(left(c) > 1e-3 && left(d) < -1e-3);
            let shell = hill();
            let drape = Drape::of(&shell);
            let mut on_border: [BTreeMap<[u64; 2], ()>; 2] = Default::default();
            for (found, ring) in on_border.iter_mut().zip([[a, b, c], [b, a, d]]) {
                drape.pieces(&ring, |piece| {
                    let near = piece.iter().filter(|&&p| left(p).abs() < 1e-7 * (b - a).length());
                    found.extend(near.map(|p| (p.to_array().map(f64::to_bits), ())));
                });
            }
            let [one, other] = on_border;
            prop_assert_eq!(one, other);
        }
    }
}
