use earcut::Earcut;
use glam::{DVec2, DVec3};
use veduta_city::draw::Draw;
use veduta_city::{CellShell, GridPolygon, GridPos, Id, PlanTerrain, metres};

/// Plan position (x, y) at a height, in the engine's axes.
pub(super) fn engine(plan: DVec2, y: f64) -> DVec3 {
    DVec3::new(plan.x, y, -plan.y)
}

/// What is random about a thing, by where in the plan it is: the same whatever cell draws it.
pub(super) fn draw_at(shell: &CellShell, pos: GridPos, stage: &str) -> Draw {
    let (origin, wrapped) = (shell.origin, i32::wrapping_add);
    Draw::new(0, Id(GridPos(wrapped(origin.0, pos.0), wrapped(origin.1, pos.1)).morton()), stage)
}

/// Plan position as a façade's or house's centre (x, z).
pub(super) fn centre_of(plan: DVec2) -> [f32; 2] {
    [plan.x as f32, -plan.y as f32]
}

/// Middle of a footprint's bounds as centre of its roof.
pub(super) fn middle(polygon: &GridPolygon) -> DVec2 {
    polygon.bounds().map_or(DVec2::ZERO, |(low, high)| (low.to_metres() + high.to_metres()) / 2.0)
}

/// An edge of a polygon with its neighbours, in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) a: DVec2,
    pub(super) b: DVec2,
    pub(super) length: f64,
    /// From a to b.
    pub(super) along: DVec2,
    /// Out of the polygon.
    pub(super) out: DVec2,
}

impl Edge {
    /// `None` if the two are one.
    pub(super) fn new(a: DVec2, b: DVec2) -> Option<Self> {
        let length = (b - a).length();
        let along = (b - a) / length;
        (length > 1e-6).then_some(Self { a, b, length, along, out: DVec2::new(along.y, -along.x) })
    }

    pub(super) fn at(&self, share: f64) -> DVec2 {
        self.a.lerp(self.b, share)
    }

    pub(super) fn normal(&self) -> [f32; 3] {
        engine(self.out, 0.0).as_vec3().to_array()
    }
}

/// The edge of a wall by its index: outer ring in order, then each hole.
pub(super) fn wall_edge(polygon: &GridPolygon, wall: usize) -> Option<Edge> {
    let (ring, i) = locate(polygon, wall)?;
    Edge::new(ring.get(i)?.to_metres(), ring.get((i + 1) % ring.len())?.to_metres())
}

/// Indices of the walls before and after a wall in its ring.
pub(super) fn neighbours(polygon: &GridPolygon, wall: usize) -> Option<(usize, usize)> {
    let (ring, i) = locate(polygon, wall)?;
    let first = wall - i;
    Some((first + (i + ring.len() - 1) % ring.len(), first + (i + 1) % ring.len()))
}

fn locate(polygon: &GridPolygon, wall: usize) -> Option<(&Vec<GridPos>, usize)> {
    let mut i = wall;
    for ring in polygon.rings() {
        if i < ring.len() {
            return Some((ring, i));
        }
        i -= ring.len();
    }
    None
}

/// Number of edges, which is the number of walls.
pub(super) fn wall_count(polygon: &GridPolygon) -> usize {
    polygon.rings().map(Vec::len).sum()
}

/// Rings in metres, the outer one first.
pub(super) type Rings = Vec<Vec<DVec2>>;

/// Rings without repeated vertices; empty if the outer ring has no area or turns the wrong way. Holes of fewer than three
/// vertices are left out.
pub(super) fn rings(polygon: &GridPolygon) -> Rings {
    let mut rings: Rings = Vec::with_capacity(1 + polygon.holes.len());
    for ring in polygon.rings() {
        let mut points: Vec<DVec2> = ring.iter().map(|p| p.to_metres()).collect();
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() >= 3 {
            rings.push(points);
        } else if rings.is_empty() {
            return rings;
        }
    }
    if rings.first().is_some_and(|outer| area(outer) <= 1e-6) {
        rings.clear();
    }
    rings
}

/// Signed area of a ring, square metres.
pub(super) fn area(ring: &[DVec2]) -> f64 {
    let Some(&o) = ring.first() else { return 0.0 };
    ring.windows(2).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum::<f64>() / 2.0
}

/// Whether a counter-clockwise ring never turns right (by more than a grain).
pub(super) fn is_convex(ring: &[DVec2]) -> bool {
    let n = ring.len();
    (0..n).all(|i| {
        let (a, b, c) = (ring[i], ring[(i + 1) % n], ring[(i + 2) % n]);
        (b - a).perp_dot(c - b) >= -1e-6 * (b - a).length() * (c - b).length()
    })
}

/// Whether a position lies in the polygon of some rings, by the even–odd rule.
pub(super) fn contains(rings: &[Vec<DVec2>], p: DVec2) -> bool {
    rings.iter().filter(|ring| is_in_ring(ring.iter().copied(), p)).count() % 2 == 1
}

/// The same for a polygon on the grid, in metres.
pub(super) fn grid_contains(polygon: &GridPolygon, p: DVec2) -> bool {
    polygon.rings().filter(|ring| is_in_ring(ring.iter().map(|q| q.to_metres()), p)).count() % 2 == 1
}

fn is_in_ring(ring: impl Iterator<Item = DVec2> + Clone, p: DVec2) -> bool {
    let next = ring.clone().cycle().skip(1);
    let crossed = ring.zip(next).filter(|(a, b)| {
        let rise = b.y - a.y;
        (a.y > p.y) != (b.y > p.y) && (p.x - a.x) * rise.abs() < (b.x - a.x) * (p.y - a.y) * rise.signum()
    });
    crossed.count() % 2 == 1
}

/// Cuts polygons into triangles; keeps its memory between calls.
#[derive(Default)]
pub(super) struct Triangulator {
    earcut: Earcut<f64>,
    points: Vec<[f64; 2]>,
    holes: Vec<u32>,
    triangles: Vec<u32>,
}

impl Triangulator {
    /// Calls `each` with every triangle of some rings, as indices into the rings' points laid end to end,
    /// counter-clockwise.
    pub(super) fn each(&mut self, rings: &[Vec<DVec2>], mut each: impl FnMut([usize; 3], [DVec2; 3])) {
        self.points.clear();
        self.holes.clear();
        for ring in rings {
            if !self.points.is_empty() {
                self.holes.push(self.points.len() as u32);
            }
            self.points.extend(ring.iter().map(|p| p.to_array()));
        }
        self.earcut.earcut(self.points.iter().copied(), &self.holes, &mut self.triangles);
        self.turn();
        // The engine leaves out vertices in the middle of straight lines.
        if self.triangles.len() / 3 + 2 != self.points.len() + 2 * self.holes.len() {
            self.mend();
        }
        for t in self.triangles.chunks_exact(3) {
            let index = [t[0] as usize, t[1] as usize, t[2] as usize];
            each(index, index.map(|i| self.at(i as u32)));
        }
    }

    fn at(&self, i: u32) -> DVec2 {
        self.points.get(i as usize).copied().map_or(DVec2::ZERO, DVec2::from_array)
    }

    /// Turns all triangles counter-clockwise; those without area go.
    fn turn(&mut self) {
        let mut kept = 0;
        for i in (0..self.triangles.len()).step_by(3) {
            let [a, b, c] = [self.triangles[i], self.triangles[i + 1], self.triangles[i + 2]];
            let turn = (self.at(b) - self.at(a)).perp_dot(self.at(c) - self.at(a));
            if turn != 0.0 {
                self.triangles[kept..kept + 3].copy_from_slice(&if turn > 0.0 { [a, b, c] } else { [a, c, b] });
                kept += 3;
            }
        }
        self.triangles.truncate(kept);
    }

    /// Splits triangles so that every vertex on the edge of one is a corner of it.
    fn mend(&mut self) {
        let mut edges: Vec<(u32, u32)> =
            self.triangles.chunks_exact(3).flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
        edges.sort_unstable();
        let is_lone = |a: u32, b: u32| edges.binary_search(&(b, a)).is_err();
        let mut open: Vec<[u32; 3]> = self.triangles.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        self.triangles.clear();
        let mut order: Vec<u32> = (0..self.points.len() as u32).collect();
        order.sort_unstable_by(|&i, &j| self.at(i).x.total_cmp(&self.at(j).x));
        while let Some([a, b, c]) = open.pop() {
            let split = [[a, b, c], [b, c, a], [c, a, b]].into_iter().find_map(|[a, b, c]| {
                let between = if is_lone(a, b) { self.between(a, b, &order) } else { None };
                between.map(|p| [[a, p, c], [p, b, c]])
            });
            match split {
                Some(parts) => open.extend(parts),
                None => self.triangles.extend([a, b, c]),
            }
        }
    }

    /// A vertex within the way from one to another. `order`: all vertices from west to east.
    fn between(&self, a: u32, b: u32, order: &[u32]) -> Option<u32> {
        let (from, to) = (self.at(a), self.at(b));
        let is_within = |p: DVec2| {
            let (along, way) = (to - from, p - from);
            along.perp_dot(way) == 0.0 && along.dot(way) > 0.0 && along.dot(way) < along.length_squared()
        };
        let (west, east) = (from.x.min(to.x), from.x.max(to.x));
        let first = order.partition_point(|&i| self.at(i).x < west);
        order[first..].iter().copied().take_while(|&i| self.at(i).x <= east).find(|&i| is_within(self.at(i)))
    }
}

/// Height of the ground by place.
pub(super) struct GroundHeights<'a> {
    patches: Vec<(DVec2, DVec2, &'a GridPolygon, i32)>,
    /// Of the patches above the terrain.
    lowest: Option<i32>,
    terrain: &'a PlanTerrain,
}

impl<'a> GroundHeights<'a> {
    pub(super) fn new(shell: &'a veduta_city::CellShell) -> Self {
        let bounded = shell.ground.iter().filter_map(|p| p.outline.bounds().map(|bounds| (bounds, p)));
        let patches: Vec<_> = bounded.map(|((low, high), p)| (low.to_metres(), high.to_metres(), &p.outline, p.z)).collect();
        let lowest = patches.iter().map(|p| p.3).min();
        Self { patches, lowest, terrain: &shell.terrain }
    }

    /// Height in metres of the ground before a wall; on the cell's lowest patch where none lies there; `None` without any.
    pub(super) fn before(&self, edge: &Edge) -> Option<f64> {
        let lift = self.patch_before(edge).or(self.lowest)?;
        Some(self.terrain.height_m(Self::place_before(edge)) + metres(lift))
    }

    fn place_before(edge: &Edge) -> DVec2 {
        edge.at(0.5) + edge.out * 0.3
    }

    /// Height above the terrain of the patch before a wall, grid steps; `None` where none lies there.
    pub(super) fn patch_before(&self, edge: &Edge) -> Option<i32> {
        let p = Self::place_before(edge);
        let within = |low: DVec2, high: DVec2| low.cmple(p).all() && p.cmple(high).all();
        let here = self.patches.iter().find(|(low, high, outline, _)| within(*low, *high) && grid_contains(outline, p));
        here.map(|patch| patch.3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> GridPolygon {
        let square = |low: i32, high: i32| vec![GridPos(low, low), GridPos(high, low), GridPos(high, high), GridPos(low, high)];
        let mut hole = square(1024, 2048);
        hole.reverse();
        GridPolygon { outer: square(0, 4096), holes: vec![hole] }
    }

    #[test]
    fn walls_are_counted_over_outer_ring_and_holes() {
        let frame = frame();
        assert_eq!(wall_count(&frame), 8);
        let south = wall_edge(&frame, 0).unwrap();
        assert_eq!((south.out, south.length), (DVec2::NEG_Y, 4.0));
        let court = wall_edge(&frame, 4).unwrap();
        assert!(court.out.dot(DVec2::splat(1.5) - court.at(0.5)) > 0.0, "a courtyard's walls look into it");
        assert!(wall_edge(&frame, 8).is_none());
        assert_eq!(neighbours(&frame, 0), Some((3, 1)));
        assert_eq!(neighbours(&frame, 7), Some((6, 4)));
    }

    #[test]
    fn triangles_cover_a_frame_and_turn_left() {
        let rings = rings(&frame());
        let mut sum = 0.0;
        Triangulator::default().each(&rings, |_, t| {
            let turn = area(&t);
            assert!(turn > 0.0);
            sum += turn;
        });
        assert!((sum - 15.0).abs() < 1e-9, "{sum}");
        assert!(contains(&rings, DVec2::splat(0.5)) && !contains(&rings, DVec2::splat(1.5)));
    }
}
