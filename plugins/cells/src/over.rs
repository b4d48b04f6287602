//! What is seen over the roofs where the ground is hilly: hills across a valley, and the town below whoever stands on one.
//!
//! From eyes all over the cells rays go out over a relief of the city, each as long as something beyond may rise above all that it has
//! passed. That is a sample, not a proof: what is told is told by squares, in which many eyes of many cells see much the same.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{Cells, CityPlan, GridPolygon, GridPos, Overview, PlanTerrain, Portal, PortalSide, metres};

use crate::far::{Square, squares};
use crate::partition::PartitionSettings;

/// Where the ground rises and falls by less, nothing but the skyline is seen over roofs from so far away. Metres.
const HILLY_M: f64 = 10.0;
/// Highest eye above the ground, metres.
const EYE_M: f64 = 3.0;
/// Directions in which an eye looks.
const DIRECTIONS: u32 = 128;
/// A ray's steps are as long as a cell of the relief, or this share of the way to it if that is more.
const STEP_SHARE: f64 = 1.0 / 32.0;
/// Side of the relief's cells, metres; more where it would have more cells than [`MOST_POSTS`].
const POST_M: f64 = 4.0;
const MOST_POSTS: f64 = 16e6;
/// Side of the blocks by which squares are found, metres.
const BLOCK_M: f64 = 32.0;

/// Adds to what is told as far away what is seen over the roofs.
pub(crate) fn see_over(plan: &CityPlan, cells: &mut Cells, settings: &PartitionSettings) {
    let heights = &plan.terrain.heights;
    let rise = heights.iter().max().zip(heights.iter().min()).map_or(0, |(most, least)| most.saturating_sub(*least));
    if metres(rise) < HILLY_M || settings.far_m <= Overview::ABOUT_M {
        return;
    }
    let squares = squares(plan, cells);
    let corners = squares.iter().flat_map(Square::corners).map(GridPos::to_metres);
    let Some(bounds) = corners.map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return };
    if bounds.0.distance(bounds.1) <= Overview::ABOUT_M {
        return;
    }
    let (relief, blocks) = (Relief::new(plan, bounds), Blocks::new(&squares));
    let look = |is_seen: &mut Vec<bool>, eye: GridPos| {
        is_seen.resize(squares.len(), false);
        let mut seen: Vec<u32> = Vec::new();
        relief.look(eye.to_metres(), settings.far_m, |at| {
            let new = blocks.of(at).iter().filter(|&&n| !core::mem::replace(&mut is_seen[n as usize], true));
            seen.extend(new);
        });
        seen.iter().for_each(|&n| is_seen[n as usize] = false);
        seen
    };
    // Nobody stands in those at the city's edge.
    let from_portal = |is_seen: &mut Vec<bool>, portal: &Portal| match portal.beyond {
        PortalSide::Cell(_) => look(is_seen, portal.ends.0.midpoint(portal.ends.1)),
        PortalSide::Edge => Vec::new(),
    };
    let from_portals: Vec<Vec<u32>> = cells.portals.par_iter().map_init(Vec::new, from_portal).collect();
    let mut far = core::mem::take(&mut cells.far);
    far.resize(cells.cells.len(), Vec::new());
    far.par_iter_mut().zip(&cells.cells).for_each_init(Vec::new, |is_seen, (far, cell)| {
        let portals = cell.portals.iter().filter_map(|&portal| from_portals.get(portal as usize)).flatten().copied();
        far.extend(portals.chain(look(is_seen, cell.outline.middle())).map(|n| squares[n as usize].cell));
        far.sort_unstable();
        far.dedup();
        far.shrink_to_fit();
    });
    cells.far = far;
}

/// What stands about a post of a relief, metres above the city's zero.
#[derive(Clone, Copy, Default)]
struct Post {
    /// Ground, or eaves if there is a house.
    hides_m: f32,
    /// The top of whatever is there.
    top_m: f32,
}

/// Heights of a city on a lattice.
struct Relief<'a> {
    terrain: &'a PlanTerrain,
    origin: DVec2,
    post_m: f64,
    columns: usize,
    posts: Vec<Post>,
    /// The highest of them.
    top_m: f64,
}

impl<'a> Relief<'a> {
    fn new(plan: &'a CityPlan, (low, high): (DVec2, DVec2)) -> Self {
        let size = high - low;
        let post_m = POST_M.max(libm::sqrt(size.x * size.y / MOST_POSTS));
        let (columns, rows) = ((size.x / post_m) as usize + 1, (size.y / post_m) as usize + 1);
        let mut posts = vec![Post::default(); columns * rows];
        posts.par_chunks_mut(columns).enumerate().for_each(|(row, posts)| {
            for (column, post) in posts.iter_mut().enumerate() {
                let ground_m = plan.terrain.height_m(low + post_m * middle(column, row)) as f32;
                *post = Post { hides_m: ground_m, top_m: ground_m };
            }
        });
        let mut relief = Self { terrain: &plan.terrain, origin: low, post_m, columns, posts, top_m: 0.0 };
        plan.houses.iter().flat_map(|house| &house.volumes).for_each(|volume| {
            let (eaves, top) = (metres(volume.eaves) as f32, metres(volume.top()) as f32);
            relief.raise(volume.footprint.middle().to_metres(), top);
            relief.cover(&volume.footprint, (eaves, top));
        });
        for object in &plan.objects {
            relief.raise(object.pos.to_metres(), metres(object.z.saturating_add(object.height)) as f32);
        }
        relief.top_m = relief.posts.iter().map(|post| post.top_m).fold(f32::MIN, f32::max).into();
        relief
    }

    /// Which post stands for a plan position.
    fn post(&self, pos: DVec2) -> Option<usize> {
        let at = (pos - self.origin) / self.post_m;
        let (column, row) = (at.x as usize, at.y as usize);
        let is_here = at.x >= 0.0 && at.y >= 0.0 && column < self.columns;
        is_here.then(|| row * self.columns + column).filter(|&post| post < self.posts.len())
    }

    /// Something small that shows.
    fn raise(&mut self, pos: DVec2, top_m: f32) {
        if let Some(post) = self.post(pos) {
            self.posts[post].top_m = self.posts[post].top_m.max(top_m);
        }
    }

    /// A volume with its eaves and top, wherever a post is within it.
    fn cover(&mut self, footprint: &GridPolygon, (eaves_m, top_m): (f32, f32)) {
        let Some((low, high)) = footprint.bounds() else { return };
        let first = |low: f64| (low / self.post_m - 0.5).ceil().max(0.0) as usize;
        let (from, to) = (low.to_metres() - self.origin, high.to_metres() - self.origin);
        let (rows, columns) = (first(from.y)..first(to.y), first(from.x)..first(to.x).min(self.columns));
        for row in rows {
            for column in columns.clone() {
                let pos = self.origin + self.post_m * middle(column, row);
                let Some(post) = self.posts.get_mut(row * self.columns + column) else { return };
                if footprint.contains(GridPos::from_metres(pos)) {
                    *post = Post { hides_m: post.hides_m.max(eaves_m), top_m: post.top_m.max(top_m) };
                }
            }
        }
    }

    /// Tells where something far away is seen from an eye.
    fn look(&self, eye: DVec2, far_m: f64, mut tell: impl FnMut(DVec2)) {
        let eye_m = self.terrain.height_m(eye) + EYE_M;
        // Eyes side by side look between each other's directions.
        let turn = (eye.x + eye.y) * 0.618;
        for n in 0..DIRECTIONS {
            let way = DVec2::from_angle((f64::from(n) + turn.fract()) / f64::from(DIRECTIONS) * TAU);
            let (mut off_m, mut slope) = (self.post_m, f64::NEG_INFINITY);
            // Beyond, nothing is high enough to rise above what has been passed.
            while off_m <= far_m && eye_m + slope * off_m.max(Overview::ABOUT_M) <= self.top_m {
                let pos = eye + off_m * way;
                let Some(post) = self.post(pos).map(|post| self.posts[post]) else { break };
                if off_m >= Overview::ABOUT_M && eye_m + slope * off_m <= f64::from(post.top_m) {
                    tell(pos);
                }
                slope = slope.max((f64::from(post.hides_m) - eye_m) / off_m);
                off_m += self.post_m.max(STEP_SHARE * off_m);
            }
        }
    }
}

/// Where a post stands, in posts.
fn middle(column: usize, row: usize) -> DVec2 {
    DVec2::new(column as f64 + 0.5, row as f64 + 0.5)
}

/// Which squares may hold what is at a place.
struct Blocks(BTreeMap<(i32, i32), Vec<u32>>);

impl Blocks {
    fn new(squares: &[Square]) -> Self {
        let mut blocks: BTreeMap<(i32, i32), Vec<u32>> = BTreeMap::new();
        for (n, square) in (0..).zip(squares) {
            let [low, _, high, _] = square.corners().map(|corner| Self::block(corner.to_metres()));
            for block in (low.0..=high.0).flat_map(|x| (low.1..=high.1).map(move |y| (x, y))) {
                blocks.entry(block).or_default().push(n);
            }
        }
        Self(blocks)
    }

    fn block(pos: DVec2) -> (i32, i32) {
        let at = (pos / BLOCK_M).floor();
        (at.x as i32, at.y as i32)
    }

    fn of(&self, pos: DVec2) -> &[u32] {
        self.0.get(&Self::block(pos)).map_or(&[], Vec::as_slice)
    }
}
