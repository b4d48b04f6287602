//! The ground of a plan: that of the graph, with the streets cut into it.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{BlockKind, CityGraph, GRID_PER_METRE, GridPolygon, GridPos, Link, LinkKind, PlanTerrain, Terrain, metres};

use super::bridges::{Bridges, CLEAR_M};
use super::earthworks::Earthworks;
use super::extent::Extent;
use super::index::Index;
use super::outline;
use super::streets::{along, length_m, width_at_m};

/// Distance of posts, and of those of cities with more than so many; metres.
const STEP_M: i32 = 4;
const MOST_POSTS: i64 = 4_000_000;
/// Streets are level across, so far beyond their sides: the diagonal of a square between posts, in distances of posts.
const LEVEL: f64 = core::f64::consts::SQRT_2;
/// So far beyond that the ground goes over into what it was; metres.
const BLEND_M: f64 = 14.0;
/// How much steeper the sides of causeways are.
const CAUSEWAY: f64 = 4.0;
/// Posts stand at heights of so many grid steps (1.6 cm), which makes them shorter to tell.
const POST_STEPS: i32 = 16;
/// Street profiles are told so closely, and smoothed over so many metres each way.
const STATION_M: f64 = 4.0;
const SMOOTHED_M: f64 = 12.0;

/// The ground of a city: level across its streets, whose middle lines follow the graph's terrain, smoothed; at crossroads between
/// those that meet; and as it was some 20 m away from them. The ends of bridges lie on causeways, where no street runs under them, and
/// between the ends the ground is as it was. Ponds and lakes are level.
pub(super) fn terrain(graph: &CityGraph, (bridges, works): (&Bridges, &Earthworks), extent: &Extent) -> PlanTerrain {
    if graph.terrain.is_none() && works.is_none() {
        return PlanTerrain::default();
    }
    let raw = &Raw(graph.terrain.as_ref());
    let posts = Posts::over(extent);
    let at = graph.node_positions();
    let cut = |(i, link): (usize, &Link)| {
        let is_cut = link.layer >= 0 && !matches!(link.kind, LinkKind::Watercourse);
        let line = graph.polyline(link, &at).filter(|_| is_cut)?;
        let mut pieces = pieces(&line, (i, link), raw, (bridges, works));
        if link.kind == (LinkKind::Railway { tram: true }) {
            // Trams go where their streets do, over bridges too.
            let is_own = |piece: &Piece| !works.are_at((piece.ends.0 + piece.ends.1) / 2.0);
            pieces.retain(|piece| link.layer == 0 && is_own(piece));
        }
        Some(posts.claims(&pieces))
    };
    let mut claims: Vec<(u32, Claim)> = graph.links.par_iter().enumerate().filter_map(cut).flatten_iter().collect();
    let lakes = lakes(graph, raw);
    let lake = |pos: GridPos| lakes.at(pos).next().copied();
    let ground = |i: usize| lake(posts.pos(i)).unwrap_or_else(|| raw.height_m(posts.pos(i).to_metres()));
    let mut heights: Vec<i32> = (0..posts.count()).into_par_iter().map(|i| steps(ground(i))).collect();
    // Stable, and so in the order of links within a post: sums are the same for any number of threads.
    claims.par_sort_by_key(|claim| claim.0);
    for of_post in claims.chunk_by(|a, b| a.0 == b.0) {
        let post = of_post[0].0 as usize;
        heights[post] = steps(settled(ground(post), lake(posts.pos(post)).is_some(), of_post));
    }
    PlanTerrain { origin: posts.origin, step: posts.step, columns: posts.columns as u32, heights }
}

/// The ground as maps tell it: level at the city's zero where they do not.
struct Raw<'a>(Option<&'a Terrain>);

impl Raw<'_> {
    fn height_m(&self, p: DVec2) -> f64 {
        self.0.map_or(0.0, |terrain| terrain.height_m(p))
    }
}

/// Waters that rise less than this from shore to shore are level, and this share of what the terrain says of them is lower; metres.
const LEVEL_WATER_M: f64 = 3.0;
const LOW_SHARE: f64 = 0.2;
/// A water's height is told by so many places along each side of the box about it.
const SOUNDINGS: u32 = 24;

/// The heights of ponds and lakes.
fn lakes(graph: &CityGraph, raw: &Raw<'_>) -> Index<f64> {
    let waters = graph.blocks.iter().filter(|block| block.kind == BlockKind::Water);
    let polygons: Vec<GridPolygon> = waters.flat_map(|block| outline::polygons(&block.outline, &block.holes)).collect();
    let lake = |water: &GridPolygon| {
        let (low, high) = water.bounds()?;
        let place = |i: u32, from: f64, to: f64| from + (to - from) * (f64::from(i) + 0.5) / f64::from(SOUNDINGS);
        let (low, high) = (low.to_metres(), high.to_metres());
        let all = (0..SOUNDINGS * SOUNDINGS)
            .map(|i| DVec2::new(place(i % SOUNDINGS, low.x, high.x), place(i / SOUNDINGS, low.y, high.y)))
            .filter(|&p| water.contains(GridPos::from_metres(p)));
        let mut heights: Vec<f64> = all.map(|p| raw.height_m(p)).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| heights.get((heights.len() as f64 * share) as usize).copied();
        let (lowest, highest) = (at(LOW_SHARE)?, at(1.0 - LOW_SHARE)?);
        (highest - lowest < LEVEL_WATER_M).then(|| (water.clone(), lowest))
    };
    Index::new(polygons.par_iter().filter_map(lake).collect())
}

/// Height of a post in grid steps.
fn steps(height_m: f64) -> i32 {
    libm::round(height_m * f64::from(GRID_PER_METRE / POST_STEPS)) as i32 * POST_STEPS
}

/// Where the posts are.
struct Posts {
    origin: GridPos,
    step: i32,
    columns: usize,
    rows: usize,
}

impl Posts {
    fn over(extent: &Extent) -> Self {
        let span = |lo: i32, hi: i32| i64::from(hi) - i64::from(lo);
        let (width, height) = (span(extent.lo.0, extent.hi.0), span(extent.lo.1, extent.hi.1));
        let mut step = STEP_M * GRID_PER_METRE;
        while (width / i64::from(step) + 2) * (height / i64::from(step) + 2) > MOST_POSTS {
            step += GRID_PER_METRE;
        }
        let first = |lo: i32| lo.div_euclid(step).saturating_mul(step);
        let origin = GridPos(first(extent.lo.0), first(extent.lo.1));
        let count = |from: i32, hi: i32| (span(from, hi) / i64::from(step)) as usize + 2;
        Self { origin, step, columns: count(origin.0, extent.hi.0), rows: count(origin.1, extent.hi.1) }
    }

    const fn count(&self) -> usize {
        self.columns * self.rows
    }

    fn pos(&self, i: usize) -> GridPos {
        let place = |from: i32, n: usize| from.saturating_add(self.step.saturating_mul(n as i32));
        GridPos(place(self.origin.0, i % self.columns), place(self.origin.1, i / self.columns))
    }

    /// What a street says of each post near it: by the nearest place on its middle line.
    fn claims(&self, pieces: &[Piece]) -> Vec<(u32, Claim)> {
        let mut nearest: BTreeMap<u32, Claim> = BTreeMap::new();
        for piece in pieces {
            let level_m = LEVEL * metres(self.step);
            let reach = piece.half_m.0.max(piece.half_m.1) + level_m + BLEND_M;
            let (lo, hi) = (piece.ends.0.min(piece.ends.1) - reach, piece.ends.0.max(piece.ends.1) + reach);
            let step = f64::from(self.step);
            let first =
                |metres: f64, from: i32| ((f64::from(GridPos::steps(metres)) - f64::from(from)) / step).ceil().max(0.0) as usize;
            let (x0, y0) = (first(lo.x, self.origin.0), first(lo.y, self.origin.1));
            let (x1, y1) = (first(hi.x, self.origin.0).min(self.columns), first(hi.y, self.origin.1).min(self.rows));
            for i in (y0..y1).flat_map(|y| (x0..x1).map(move |x| y * self.columns + x)) {
                let claim = piece.claim(self.pos(i).to_metres(), level_m);
                let post = i as u32;
                if nearest.get(&post).is_none_or(|known| claim.far_m < known.far_m) {
                    nearest.insert(post, claim);
                }
            }
        }
        nearest.into_iter().filter(|(_, claim)| f64::from(claim.beyond_m) < BLEND_M).collect()
    }
}

/// What a street says of the height of a post; there are many.
#[derive(Debug, Clone, Copy)]
struct Claim {
    height_m: f32,
    /// How far the post is from the middle line.
    far_m: f32,
    /// How far it is from where the street is level across; 0 within.
    beyond_m: f32,
    is_bridge: bool,
    /// Whether it lies on an embankment, whose sides are steep.
    is_steep: bool,
}

/// The height of a post on ground (or water) of a height that streets claim. Under bridges the ground is that of streets, where there are
/// any; the sides of their causeways are steep, and streets beside waters leave them alone.
fn settled(ground_m: f64, is_water: bool, claims: &[(u32, Claim)]) -> f64 {
    let (mut sum, mut weights, mut nearest) = (0.0, 0.0, BLEND_M);
    let is_street = |claim: &Claim| !claim.is_bridge && claim.beyond_m == 0.0;
    let has_street = claims.iter().any(|(_, claim)| is_street(claim));
    for (_, claim) in claims {
        let [height_m, far_m, beyond_m] = [claim.height_m, claim.far_m, claim.beyond_m].map(f64::from);
        let beyond_m = if claim.is_steep { beyond_m * CAUSEWAY } else { beyond_m };
        if beyond_m >= BLEND_M || (claim.is_bridge && has_street) || (is_water && !claim.is_bridge && beyond_m > 0.0) {
            continue;
        }
        let fade = 1.0 - beyond_m / BLEND_M;
        let weight = fade * fade / ((far_m + 0.5) * (far_m + 0.5));
        (sum, weights) = (sum + weight * height_m, weights + weight);
        nearest = nearest.min(beyond_m);
    }
    if weights <= 0.0 {
        return ground_m;
    }
    let t = nearest / BLEND_M;
    let share = t * t * (3.0 - 2.0 * t);
    sum / weights * (1.0 - share) + ground_m * share
}

/// A short straight piece of a street: its ends, the heights there, and half its width.
struct Piece {
    is_bridge: bool,
    is_steep: bool,
    /// Which of its ends are where a bridge begins: there is no ground of the street's beyond.
    is_end: (bool, bool),
    ends: (DVec2, DVec2),
    height_m: (f64, f64),
    half_m: (f64, f64),
}

impl Piece {
    fn claim(&self, p: DVec2, level_m: f64) -> Claim {
        let way = self.ends.1 - self.ends.0;
        let share = (p - self.ends.0).dot(way) / way.length_squared().max(1e-12);
        let is_off = (self.is_end.0 && share < 0.0) || (self.is_end.1 && share > 1.0);
        let share = share.clamp(0.0, 1.0);
        let far_m = p.distance(self.ends.0 + way * share);
        let between = |(a, b): (f64, f64)| a + (b - a) * share;
        let beyond_m = if is_off { f64::INFINITY } else { (far_m - between(self.half_m) - level_m).max(0.0) };
        let height_m = between(self.height_m) as f32;
        Claim { height_m, far_m: far_m as f32, beyond_m: beyond_m as f32, is_bridge: self.is_bridge, is_steep: self.is_steep }
    }
}

/// A street in short pieces, but where it leads over bridges, its heights smoothed along it. At its ends they are those of the ground, so
/// that streets which meet agree.
fn pieces(line: &[DVec2], (i, link): (usize, &Link), raw: &Raw<'_>, (bridges, works): (&Bridges, &Earthworks)) -> Vec<Piece> {
    let whole = length_m(line);
    let share = |s: f64| if whole > 0.0 { s / whole } else { 0.0 };
    let parts = bridges.on_ground(i);
    let mut stations: Vec<(f64, DVec2)> = Vec::new();
    let mut gone = 0.0;
    for pair in line.windows(2) {
        let length = pair[0].distance(pair[1]);
        let count = (length / STATION_M).ceil().max(1.0) as u32;
        let place = |i: u32| f64::from(i) / f64::from(count);
        stations.extend((0..count).map(|i| (gone + length * place(i), pair[0].lerp(pair[1], place(i)))));
        gone += length;
    }
    stations.extend(line.last().map(|&p| (whole, p)));
    let ground: Vec<f64> = stations.iter().map(|&(_, p)| raw.height_m(p)).collect();
    let smooth = |s: f64| {
        let reach = SMOOTHED_M.min(s).min(whole - s) + 1e-9;
        let first = stations.partition_point(|other| other.0 < s - reach);
        let end = stations.partition_point(|other| other.0 <= s + reach);
        ground[first..end].iter().sum::<f64>() / (end - first).max(1) as f64
    };
    let height = |s: f64| bridges.ground_m(i, share(s)).unwrap_or_else(|| smooth(s) + works.link_m(i, share(s)));
    let half = |s: f64| width_at_m(link, share(s)) / 2.0;
    let mut out = Vec::new();
    for part in &parts {
        // The stations within it, and its ends where they are elsewhere.
        let (from, to) = (part.start * whole, part.end * whole);
        let end = |s: f64| along(line, s.min(whole - 1e-6).max(0.0)).map(|(p, _)| (s, p));
        let inside = stations.iter().copied().filter(|(s, _)| from + 1e-6 < *s && *s < to - 1e-6);
        let of_part: Vec<(f64, DVec2)> = end(from).into_iter().chain(inside).chain(end(to)).collect();
        for (k, pair) in of_part.windows(2).enumerate() {
            let ((s, a), (t, b)) = (pair[0], pair[1]);
            let is_raised = works.link_m(i, share(s)).max(works.link_m(i, share(t))) > 0.0;
            // What a map lays over another way and cannot fly is no more in that one's way than a bridge.
            let above_m = (height(s) - raw.height_m(a)).min(height(t) - raw.height_m(b));
            let is_dam = link.layer > 0 && above_m > CLEAR_M;
            out.push(Piece {
                is_bridge: bridges.is_under_end(i, share((s + t) / 2.0)).unwrap_or(is_dam),
                is_steep: bridges.is_bridge(i) || is_raised,
                is_end: (k == 0 && part.start > 0.0, k + 2 == of_part.len() && part.end < 1.0),
                ends: (a, b),
                height_m: (height(s), height(t)),
                half_m: (half(s), half(t)),
            });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::water::{Depths, Waters};
    use super::*;

    /// A hillside that rises northwards by a fifth, with a street along it and one up it.
    fn hillside() -> CityGraph {
        let text = "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (-80, 0)), (id: 2, pos: (0, 0)), (id: 3, pos: (80, 0)),
             (id: 4, pos: (0, 80))], links: [(from: 1, to: 2, kind: Street(Street), width_m: 10), (from: 2, to: 3, kind: Street(Street), width_m: 10),
             (from: 2, to: 4, kind: Street(Street), width_m: 10)])";
        let mut graph: CityGraph = veduta_city::file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        let heights_m = (0..41).flat_map(|row| [f64::from(row); 41]).collect();
        graph.terrain = Some(Terrain { origin: DVec2::splat(-100.0), step_m: 5.0, columns: 41, heights_m });
        graph.fill_ids();
        graph
    }

    fn grown(graph: &CityGraph) -> PlanTerrain {
        let waters = Waters::of(graph, &[], Depths::of(graph.terrain.as_ref()));
        let works = Earthworks::of(graph);
        terrain(graph, (&Bridges::of(graph, &waters, &works), &works), &super::super::extent::extent(graph, &mut Vec::new()))
    }

    #[test]
    fn streets_are_level_across_and_the_hill_stays_beyond() {
        let ground = grown(&hillside());
        assert_eq!(ground.check(), Ok(()));
        let height = |x: f64, y: f64| ground.height_m(DVec2::new(x, y));
        for x in [-60.0, -33.3, 40.0, 61.7] {
            let across: Vec<f64> = [-5.0, -2.2, 0.0, 3.1, 5.0].map(|y| height(x, y)).to_vec();
            assert!(across.iter().all(|h| (h - 20.0).abs() < 0.02), "at {x}: {across:?}");
            assert!((height(x, 31.0) - 26.2).abs() < 0.01 && (height(x, -31.0) - 13.8).abs() < 0.01);
        }
        for y in [30.0, 50.0, 70.0] {
            assert!((height(-5.0, y) - (20.0 + y / 5.0)).abs() < 0.05 && (height(5.0, y) - height(-5.0, y)).abs() < 0.05);
        }
        // No step on the way up, also where the streets meet: nowhere much steeper than the hill.
        for i in 0..160 {
            let (y, x) = (f64::from(i) * 0.5, 0.7);
            assert!((height(x, y + 0.5) - height(x, y)).abs() < 0.5 * 0.45, "at {y}");
        }
        let mut level = hillside();
        level.terrain = None;
        assert!(grown(&level).is_level());
    }

    #[test]
    fn a_bump_in_the_street_is_smoothed_and_a_bridge_leads_over_a_valley() {
        let mut graph = hillside();
        let terrain = graph.terrain.as_mut().expect("a hill");
        terrain.heights_m[20 * 41 + 12] += 3.0;
        let raw = terrain.clone();
        let bump = DVec2::new(-40.0, 0.0);
        let ground = grown(&graph);
        assert!(raw.height_m(bump) == 23.0 && (20.1..21.2).contains(&ground.height_m(bump)), "{}", ground.height_m(bump));
        // Under a bridge a valley stays, and its ends lie on the ground before it.
        graph.terrain.as_mut().expect("a hill").heights_m.iter_mut().enumerate().for_each(|(i, height)| {
            if (11..=13).contains(&(i % 41)) {
                *height -= 8.0;
            }
        });
        graph.links.iter_mut().for_each(|link| link.layer = 1);
        let ground = grown(&graph);
        assert!((14.9..15.1).contains(&ground.height_m(bump)), "{}", ground.height_m(bump));
        for x in [-58.0, -56.0, -24.0, -22.0] {
            let across: Vec<f64> = [-5.0, 0.0, 5.0].map(|y| ground.height_m(DVec2::new(x, y))).to_vec();
            assert!(across.iter().all(|h| (h - 20.0).abs() < 0.02), "at {x}: {across:?}");
        }
        assert!((ground.height_m(bump + DVec2::new(20.0, 17.0)) - 23.4).abs() < 0.05, "its causeway is narrow");
    }

    #[test]
    fn ponds_are_level_and_streets_leave_them_alone() {
        let mut graph = hillside();
        let pond = "(name: \"P\", anchor: (lat: 50, lon: 14), blocks: [(kind: Water, outline: [(-60, 8), (-40, 8), (-40, 16), (-60, 16)])])";
        graph.blocks = veduta_city::file::parse::<CityGraph>(pond, "t").unwrap_or_else(|e| panic!("{e}")).blocks;
        let ground = grown(&graph);
        let heights = [(-56.0, 12.0), (-48.0, 12.0), (-44.0, 12.0)].map(|(x, y)| ground.height_m(DVec2::new(x, y)));
        assert!(heights.iter().all(|h| (h - heights[0]).abs() < 1e-9 && (21.5..22.5).contains(h)), "{heights:?}");
    }
}
