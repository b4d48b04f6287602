use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{FARTHEST_M, GRID_PER_METRE, GridPos, metres};

/// Most posts of a terrain.
const MOST_POSTS: usize = 1 << 24;
/// Least and greatest distance of posts, metres.
const STEPS_M: core::ops::RangeInclusive<f64> = 0.5..=1_000.0;
/// No ground is higher above a city's zero, or lower beneath it; metres.
const HIGHEST_GROUND_M: f64 = 10_000.0;

/// Elevations of the bare ground under a city graph: posts on a regular grid.
///
/// In a file it is `(origin: (x, y), step_m: …, rows_m: [[…], …])`, the southernmost row first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "Rows", into = "Rows")]
pub struct Terrain {
    /// Plan position of the south-western post, metres.
    pub origin: DVec2,
    /// Distance between posts, metres.
    pub step_m: f64,
    /// Posts in a row from west to east.
    pub columns: u32,
    /// Metres above the city's zero ([`crate::CityGraph::zero_m`]): rows from south to north.
    pub heights_m: Vec<f64>,
}

impl Terrain {
    /// What is wrong with it, in a sentence without a full stop.
    ///
    /// # Errors
    /// The first mistake.
    pub fn check(&self) -> Result<(), String> {
        if !self.origin.is_finite() || self.origin.abs().max_element() > FARTHEST_M {
            return Err(format!("its origin ({}, {}) is no place within {} km", self.origin.x, self.origin.y, FARTHEST_M / 1000.0));
        }
        if !STEPS_M.contains(&self.step_m) {
            return Err(format!("its `step_m` of {} is not within {} to {}", self.step_m, STEPS_M.start(), STEPS_M.end()));
        }
        let (columns, posts) = (self.columns as usize, self.heights_m.len());
        if columns < 2 || !posts.is_multiple_of(columns) || posts < 2 * columns {
            return Err(format!("its {posts} posts do not fill two rows or more of {columns} columns, two or more"));
        }
        if posts > MOST_POSTS {
            return Err(format!("it has {posts} posts; {MOST_POSTS} are possible"));
        }
        match self.heights_m.iter().position(|h| !h.is_finite() || h.abs() > HIGHEST_GROUND_M) {
            Some(i) => Err(format!(
                "its post {i} is {} m high: ground lies within {HIGHEST_GROUND_M} m of the city's zero",
                self.heights_m[i]
            )),
            None => Ok(()),
        }
    }

    /// Elevation at a plan position, bilinear between the posts; beyond them that of the border. Metres above the city's zero.
    #[must_use]
    pub fn height_m(&self, plan_pos: DVec2) -> f64 {
        let Some(square) = Square::at((plan_pos - self.origin) / self.step_m, self.columns, self.heights_m.len()) else {
            return 0.0;
        };
        let [sw, se, nw, ne] = square.posts.map(|i| self.heights_m[i]);
        let (x, y) = (square.share.x, square.share.y);
        let (south, north) = (sw + (se - sw) * x, nw + (ne - nw) * x);
        south + (north - south) * y
    }
}

/// A [`Terrain`] as files tell it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rows {
    origin: DVec2,
    step_m: f64,
    rows_m: Vec<Vec<f64>>,
}

/// A [`PlanTerrain`] as files tell it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanRows {
    origin: GridPos,
    step: i32,
    rows: Vec<Vec<i32>>,
}

/// Rows end to end, and how long each is.
fn flat<H: Copy>(rows: &[Vec<H>]) -> Result<(u32, Vec<H>), String> {
    let columns = rows.first().map_or(0, Vec::len);
    match rows.iter().position(|row| row.len() != columns) {
        Some(i) => Err(format!("row {} of the terrain has {} posts, the first {columns}", i + 1, rows[i].len())),
        None => Ok((u32::try_from(columns).map_err(|_| "a row of the terrain is too long")?, rows.concat())),
    }
}

fn rows<H: Copy>(columns: u32, heights: &[H]) -> Vec<Vec<H>> {
    heights.chunks(columns.max(1) as usize).map(<[H]>::to_vec).collect()
}

impl From<Terrain> for Rows {
    fn from(terrain: Terrain) -> Self {
        Self { origin: terrain.origin, step_m: terrain.step_m, rows_m: rows(terrain.columns, &terrain.heights_m) }
    }
}

impl TryFrom<Rows> for Terrain {
    type Error = String;

    fn try_from(told: Rows) -> Result<Self, String> {
        let (columns, heights_m) = flat(&told.rows_m)?;
        Ok(Self { origin: told.origin, step_m: told.step_m, columns, heights_m })
    }
}

impl From<PlanTerrain> for PlanRows {
    fn from(terrain: PlanTerrain) -> Self {
        Self { origin: terrain.origin, step: terrain.step, rows: rows(terrain.columns, &terrain.heights) }
    }
}

impl TryFrom<PlanRows> for PlanTerrain {
    type Error = String;

    fn try_from(told: PlanRows) -> Result<Self, String> {
        let (columns, heights) = flat(&told.rows)?;
        Ok(Self { origin: told.origin, step: told.step, columns, heights })
    }
}

/// Four posts about a place, and where it lies between them.
struct Square {
    /// South-west, south-east, north-west, north-east.
    posts: [usize; 4],
    /// 0 to 1, east and north.
    share: DVec2,
}

impl Square {
    /// At a place in steps from the first post; beyond the border the nearest. `None` where there is no square.
    fn at(place: DVec2, columns: u32, posts: usize) -> Option<Self> {
        let columns = columns as usize;
        let rows = posts.checked_div(columns)?;
        if columns < 2 || rows < 2 {
            return None;
        }
        let last = DVec2::new((columns - 1) as f64, (rows - 1) as f64);
        let place = place.clamp(DVec2::ZERO, last);
        let low = place.floor().min(last - 1.0);
        let first = low.y as usize * columns + low.x as usize;
        Some(Self { posts: [first, first + 1, first + columns, first + columns + 1], share: place - low })
    }
}

/// The ground of a plan: posts on a regular grid, and triangles between them, the squares cut from south-west to north-east. What
/// lies on it tells its height above it; without posts it is level, at the city's zero.
///
/// In a file it is `(origin: (x, y), step: …, rows: [[…], …])`, the southernmost row first.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(try_from = "PlanRows", into = "PlanRows")]
pub struct PlanTerrain {
    /// The south-western post.
    pub origin: GridPos,
    /// Distance between posts, grid steps.
    pub step: i32,
    /// Posts in a row from west to east.
    pub columns: u32,
    /// Above the city's zero, grid steps: rows from south to north.
    pub heights: Vec<i32>,
}

impl PlanTerrain {
    /// Whether there are no posts: level ground at the city's zero.
    #[must_use]
    pub const fn is_level(&self) -> bool {
        self.heights.is_empty()
    }

    /// What is wrong with it, in a sentence without a full stop.
    ///
    /// # Errors
    /// The first mistake.
    pub fn check(&self) -> Result<(), String> {
        if self.is_level() {
            return Ok(());
        }
        let (columns, posts) = (self.columns as usize, self.heights.len());
        if columns < 2 || !posts.is_multiple_of(columns) || posts < 2 * columns || posts > MOST_POSTS {
            return Err(format!("its {posts} posts do not fill two rows or more of {columns} columns"));
        }
        let reach = |origin: i32, count: usize| i64::from(origin) + i64::from(self.step) * (count as i64 - 1);
        let ends = [reach(self.origin.0, columns), reach(self.origin.1, posts / columns)];
        let far = i64::from(GridPos::steps(FARTHEST_M + 100_000.0));
        let is_far = [self.origin.0, self.origin.1].map(i64::from).into_iter().chain(ends).any(|v| v.abs() > far);
        if self.step < GRID_PER_METRE || is_far {
            return Err(format!("its posts, {} grid steps apart, are closer than a metre or reach too far", self.step));
        }
        let highest = GridPos::steps(2.0 * HIGHEST_GROUND_M);
        match self.heights.iter().find(|h| h.unsigned_abs() > highest.unsigned_abs()) {
            Some(height) => Err(format!("a post is at a height of {height} steps")),
            None => Ok(()),
        }
    }

    /// Height of the ground at a plan position, beyond the posts that of the border. Metres above the city's zero.
    #[must_use]
    pub fn height_m(&self, plan_pos: DVec2) -> f64 {
        let place = (plan_pos - self.origin.to_metres()) / metres(self.step);
        let Some(square) = Square::at(place, self.columns, self.heights.len()) else { return 0.0 };
        let [sw, se, nw, ne] = square.posts.map(|i| metres(self.heights[i]));
        let (x, y) = (square.share.x, square.share.y);
        if x >= y { sw + (se - sw) * x + (ne - se) * y } else { sw + (nw - sw) * y + (ne - nw) * x }
    }

    /// The same on the grid.
    #[must_use]
    pub fn height(&self, pos: GridPos) -> i32 {
        if self.is_level() { 0 } else { GridPos::steps(self.height_m(pos.to_metres())) }
    }

    /// How steeply the ground rises eastwards and northwards about a plan position, smoothed over the posts around: metres per metre.
    #[must_use]
    pub fn slope(&self, plan_pos: DVec2) -> DVec2 {
        if self.is_level() {
            return DVec2::ZERO;
        }
        let step = metres(self.step);
        let rise = |way: DVec2| (self.height_m(plan_pos + way * step) - self.height_m(plan_pos - way * step)) / (2.0 * step);
        DVec2::new(rise(DVec2::X), rise(DVec2::Y))
    }

    /// Lowest and highest post that tells of the ground within some bounds.
    #[must_use]
    pub fn range(&self, bounds: (GridPos, GridPos)) -> (i32, i32) {
        let Some(window) = self.window(bounds, 0) else { return (0, 0) };
        let posts = || window.posts(self.columns as usize).map(|i| self.heights[i]);
        (posts().min().unwrap_or(0), posts().max().unwrap_or(0))
    }

    /// What tells of the ground within some bounds, and of its slope there; positions relative to another origin.
    #[must_use]
    pub fn crop(&self, bounds: (GridPos, GridPos), origin: GridPos) -> Self {
        let Some(window) = self.window(bounds, 1) else { return Self::default() };
        let heights = window.posts(self.columns as usize).map(|i| self.heights[i]).collect();
        let place =
            |from: i32, count: usize, origin: i32| from.wrapping_add(self.step.wrapping_mul(count as i32)).wrapping_sub(origin);
        let (column, row) = window.low;
        Self {
            origin: GridPos(place(self.origin.0, column, origin.0), place(self.origin.1, row, origin.1)),
            step: self.step,
            columns: (window.high.0 - window.low.0 + 1) as u32,
            heights,
        }
    }

    /// Whether a plan position lies between its posts.
    #[must_use]
    pub fn covers(&self, plan_pos: DVec2) -> bool {
        let Some(rows) = self.heights.len().checked_div(self.columns as usize).filter(|_| !self.is_level()) else { return false };
        let place = (plan_pos - self.origin.to_metres()) / metres(self.step);
        place.min_element() >= 0.0 && place.x <= f64::from(self.columns) - 1.0 && place.y <= rows as f64 - 1.0
    }

    /// Parts of a terrain, which were cropped from it, as one. Ground of which none of them tells lies on the city's zero.
    #[must_use]
    pub fn joined(parts: &[&Self]) -> Self {
        let parts = || parts.iter().filter(|part| !part.is_level() && part.columns > 0 && part.step > 0);
        let Some(first) = parts().next() else { return Self::default() };
        let step = first.step;
        let rows = |part: &Self| (part.heights.len() / part.columns as usize) as i64;
        let corner = |part: &Self| {
            let off = |a: i32, b: i32| (i64::from(a) - i64::from(b)).div_euclid(i64::from(step));
            (off(part.origin.0, first.origin.0), off(part.origin.1, first.origin.1))
        };
        let (mut low, mut high) = ((0_i64, 0_i64), (0_i64, 0_i64));
        for part in parts() {
            let (x, y) = corner(part);
            low = (x.min(low.0), y.min(low.1));
            high = (high.0.max(x + i64::from(part.columns)), high.1.max(y + rows(part)));
        }
        let (columns, rows) = ((high.0 - low.0) as usize, (high.1 - low.1) as usize);
        if columns.saturating_mul(rows) > MOST_POSTS {
            // They are parts of nothing that may be.
            return (*first).clone();
        }
        let mut heights = vec![0; columns * rows];
        for part in parts() {
            let (x, y) = corner(part);
            for (row, posts) in part.heights.chunks(part.columns as usize).enumerate() {
                let at = ((y - low.1) as usize + row) * columns + (x - low.0) as usize;
                heights[at..at + posts.len()].copy_from_slice(posts);
            }
        }
        let from = |origin: i32, posts: i64| (i64::from(origin) + posts * i64::from(step)) as i32;
        let origin = GridPos(from(first.origin.0, low.0), from(first.origin.1, low.1));
        Self { origin, step, columns: columns as u32, heights }
    }

    /// Where the straight way from one plan position to another crosses the lines between posts: the shares of it, ascending, without
    /// its ends. Between two of them the ground is straight.
    #[must_use]
    pub fn bends(&self, a: DVec2, b: DVec2) -> Vec<f64> {
        let mut shares = Vec::new();
        if self.is_level() {
            return shares;
        }
        let (origin, step) = (self.origin.to_metres(), metres(self.step));
        let (a, b) = ((a - origin) / step, (b - origin) / step);
        let (columns, rows) = (f64::from(self.columns), (self.heights.len() as f64 / f64::from(self.columns)).floor());
        let families = [(a.x, b.x, 0.0, columns), (a.y, b.y, 0.0, rows), (a.y - a.x, b.y - b.x, 1.0 - columns, rows)];
        for (from, to, least, end) in families {
            // Beyond the posts the ground does not bend.
            let (low, high) = (from.min(to).max(least - 1.0), from.max(to).min(end));
            let mut line = low.floor() + 1.0;
            while line < high {
                shares.push((line - from) / (to - from));
                line += 1.0;
            }
        }
        shares.sort_unstable_by(f64::total_cmp);
        shares.dedup_by(|a, b| *a - *b < 1e-9);
        shares
    }

    /// Lowest and highest ground along a straight way, metres above the city's zero.
    #[must_use]
    pub fn range_along(&self, a: DVec2, b: DVec2) -> (f64, f64) {
        let shares = self.bends(a, b);
        let heights = [0.0, 1.0].into_iter().chain(shares).map(|share| self.height_m(a.lerp(b, share)));
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)))
    }

    /// Columns and rows of the posts about some bounds, and so many more on each side. `None` if there are no posts.
    fn window(&self, (lo, hi): (GridPos, GridPos), more: i64) -> Option<Window> {
        let columns = self.columns as usize;
        let rows = self.heights.len().checked_div(columns)?;
        if columns < 2 || rows < 2 || self.step <= 0 {
            return None;
        }
        let at = |v: i32, from: i32| (i64::from(v) - i64::from(from)).div_euclid(i64::from(self.step));
        let clamped = |i: i64, count: usize| i.clamp(0, count as i64 - 1) as usize;
        let axis = |lo: i32, hi: i32, from: i32, count: usize| {
            let first = clamped(at(lo, from) - more, count - 1);
            (first, clamped(at(hi, from) + 1 + more, count).max(first + 1))
        };
        let ((x0, x1), (y0, y1)) = (axis(lo.0, hi.0, self.origin.0, columns), axis(lo.1, hi.1, self.origin.1, rows));
        Some(Window { low: (x0, y0), high: (x1, y1) })
    }
}

/// Columns and rows of posts, inclusive.
struct Window {
    low: (usize, usize),
    high: (usize, usize),
}

impl Window {
    /// Indices of its posts, row by row.
    fn posts(&self, columns: usize) -> impl Iterator<Item = usize> + '_ {
        (self.low.1..=self.high.1).flat_map(move |row| (self.low.0..=self.high.0).map(move |column| row * columns + column))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn parts_of_a_terrain_make_it_again() {
        let step = 4 * GRID_PER_METRE;
        let heights = (0..20 * 30).map(|i| (i * 37) % 1000).collect();
        let whole = PlanTerrain { origin: GridPos(-7 * step, 5), step, columns: 20, heights };
        let at = |x: i32, y: i32| GridPos(whole.origin.0 + x * step, whole.origin.1 + y * step);
        let halves = [(at(9, 0), at(19, 29)), (at(0, 0), at(9, 29))].map(|bounds| whole.crop(bounds, GridPos(0, 0)));
        assert_eq!(PlanTerrain::joined(&[&halves[0], &PlanTerrain::default(), &halves[1]]), whole);
        assert_eq!(PlanTerrain::joined(&[]), PlanTerrain::default());
        let far = PlanTerrain { origin: GridPos(1 << 30, 1 << 30), ..halves[0].clone() };
        assert_eq!(PlanTerrain::joined(&[&halves[0], &far]), halves[0]);
        assert!(halves[1].covers(at(3, 3).to_metres()) && !halves[1].covers(at(15, 3).to_metres()));
    }

    fn slanted() -> PlanTerrain {
        // Four by three posts of 4 m about the anchor, rising a metre a post eastwards and two northwards.
        let heights = (0..3).flat_map(|row| (0..4).map(move |column| (column + 2 * row) * 1024)).collect();
        PlanTerrain { origin: GridPos(-4096, -4096), step: 4096, columns: 4, heights }
    }

    #[test]
    fn heights_between_posts_are_straight_and_go_on_level_beyond_them() {
        let terrain = slanted();
        assert_eq!(terrain.check(), Ok(()));
        assert_eq!(terrain.height_m(DVec2::new(1.0, 2.0)), 0.25 + 1.0 + 3.0);
        assert_eq!(terrain.height(GridPos(1024, 2048)), 4352);
        assert_eq!(terrain.height_m(DVec2::new(100.0, -100.0)), 3.0);
        assert!(terrain.slope(DVec2::new(2.0, 0.0)).abs_diff_eq(DVec2::new(0.25, 0.5), 1e-12));
        assert_eq!(PlanTerrain::default().height_m(DVec2::ONE), 0.0);
        let metres = Terrain { origin: DVec2::splat(-4.0), step_m: 4.0, columns: 4, heights_m: (0..12).map(f64::from).collect() };
        assert_eq!((metres.check(), metres.height_m(DVec2::new(2.0, 1.0))), (Ok(()), 1.5 + 4.0 * 1.25));
    }

    #[test]
    fn files_tell_a_row_a_line() {
        let plan = crate::CityPlan { terrain: slanted(), ..crate::CityPlan::default() };
        let text = crate::file::to_text(&plan).expect("plain values");
        assert!(text.contains("\n   [0, 1024, 2048, 3072],\n"), "{text}");
        assert_eq!(crate::file::parse::<crate::CityPlan>(&text, "t").unwrap_or_else(|e| panic!("{e}")), plan);
        let ragged = crate::file::parse::<Terrain>("(origin: (0, 0), step_m: 5, rows_m: [[1, 2], [3]])", "t");
        assert!(ragged.is_err_and(|e| e.to_string().contains("row 2 of the terrain has 1 posts, the first 2")));
    }

    #[test]
    fn what_is_wrong_is_told() {
        let good = Terrain { origin: DVec2::ZERO, step_m: 4.0, columns: 2, heights_m: vec![0.0; 4] };
        let bad = [
            (Terrain { origin: DVec2::NAN, ..good.clone() }, "origin"),
            (Terrain { step_m: 0.0, ..good.clone() }, "step_m"),
            (Terrain { columns: 3, ..good.clone() }, "columns"),
            (Terrain { columns: 0, ..good.clone() }, "columns"),
            (Terrain { heights_m: vec![0.0, 1.0, f64::INFINITY, 0.0], ..good.clone() }, "post 2"),
        ];
        for (terrain, word) in bad {
            assert!(terrain.check().is_err_and(|error| error.contains(word)), "{word}");
        }
        let plan = slanted();
        for bad in [
            PlanTerrain { columns: 5, ..plan.clone() },
            PlanTerrain { step: 0, ..plan.clone() },
            PlanTerrain { origin: GridPos(i32::MAX, 0), ..plan.clone() },
            PlanTerrain { heights: vec![i32::MIN; 12], ..plan },
        ] {
            assert!(bad.check().is_err());
        }
    }

    proptest! {
        #[test]
        fn a_part_tells_the_same_heights_and_slopes(
            heights in proptest::collection::vec(-9_000..9_000_i32, 12),
            corner in (-9_000..9_000_i32, -9_000..9_000_i32),
            size in (1..9_000_i32, 1..9_000_i32),
            at in (0.0..1.0_f64, 0.0..1.0_f64),
        ) {
            let terrain = PlanTerrain { heights, ..slanted() };
            let (lo, hi) = (GridPos(corner.0, corner.1), GridPos(corner.0 + size.0, corner.1 + size.1));
            let origin = GridPos(1024, -2048);
            let part = terrain.crop((lo, hi), origin);
            prop_assert_eq!(part.check(), Ok(()));
            let p = lo.to_metres() + DVec2::new(at.0, at.1) * (hi - lo).to_metres();
            let here = p - origin.to_metres();
            prop_assert!((terrain.height_m(p) - part.height_m(here)).abs() < 1e-9);
            prop_assert!(terrain.slope(p).abs_diff_eq(part.slope(here), 1e-9));
            let (low, high) = terrain.range((lo, hi));
            prop_assert!((metres(low)..=metres(high)).contains(&terrain.height_m(p)));
        }

        #[test]
        fn the_ground_is_straight_between_its_bends(
            heights in proptest::collection::vec(-9_000..9_000_i32, 12),
            ends in ((-9.0..9.0_f64, -9.0..9.0_f64), (-9.0..9.0_f64, -9.0..9.0_f64)),
        ) {
            let terrain = PlanTerrain { heights, ..slanted() };
            let (a, b) = (DVec2::new(ends.0.0, ends.0.1), DVec2::new(ends.1.0, ends.1.1));
            let mut shares = terrain.bends(a, b);
            shares.insert(0, 0.0);
            shares.push(1.0);
            let height = |share: f64| terrain.height_m(a.lerp(b, share));
            let (low, high) = terrain.range_along(a, b);
            for pair in shares.windows(2) {
                let middle = height((pair[0] + pair[1]) / 2.0);
                prop_assert!((middle - (height(pair[0]) + height(pair[1])) / 2.0).abs() < 1e-6);
                prop_assert!(low - 1e-9 <= middle && middle <= high + 1e-9);
            }
        }
    }
}
