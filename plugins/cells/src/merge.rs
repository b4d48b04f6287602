//! Triangles joined to cells: wide openings first, so that the narrow places stay as borders.

use std::collections::BTreeMap;

use veduta_city::{GRID_PER_METRE, GridPos};

use crate::hull::{Hull, distance_2};
use crate::partition::PartitionSettings;
use crate::patches::Patches;
use crate::triangulate::Triangle;

/// Cell of each triangle, numbered densely from 0.
pub(crate) fn merge(triangles: &[Triangle], patches: &Patches<'_>, settings: &PartitionSettings) -> Vec<u32> {
    let mut groups = Groups::new(triangles, patches);
    let mut doors = doors(triangles);
    doors.sort_unstable();
    for door in doors {
        groups.try_join(door.left, door.right, &Limits::of(settings, 1.0));
    }
    // Small rests first ask for a union that is nearly convex; what is left (slits, corners behind corners) takes any.
    let small = (settings.min_area_m2, Limits::of(settings, 1.5));
    let tiny = (settings.min_area_m2 / 4.0, Limits { convexity: 0.0, ..Limits::of(settings, 1.5) });
    for (area_m2, limits) in [small, tiny] {
        for _ in 0..8 {
            if !join_rests(triangles, &mut groups, area_m2, &limits) {
                break;
            }
        }
    }
    let group: Vec<u32> = (0..triangles.len() as u32).map(|t| groups.root(t)).collect();
    numbered(triangles, &group)
}

/// Numbers the groups of triangles by the Morton codes of the middles of their bounds, so that those which lie together are told together.
pub(crate) fn numbered(triangles: &[Triangle], group: &[u32]) -> Vec<u32> {
    let mut bounds: BTreeMap<u32, (GridPos, GridPos)> = BTreeMap::new();
    for (triangle, &group) in triangles.iter().zip(group) {
        let (lo, hi) = bounds.entry(group).or_insert((triangle.corners[0], triangle.corners[0]));
        for corner in triangle.corners {
            *lo = GridPos(lo.0.min(corner.0), lo.1.min(corner.1));
            *hi = GridPos(hi.0.max(corner.0), hi.1.max(corner.1));
        }
    }
    let mut order: Vec<(u64, u32)> = bounds.into_iter().map(|(group, (lo, hi))| (lo.midpoint(hi).morton(), group)).collect();
    order.sort_unstable();
    let number: BTreeMap<u32, u32> = (0..).zip(order).map(|(n, (_, group))| (group, n)).collect();
    group.iter().map(|group| number[group]).collect()
}

/// An edge between two triangles; sorts widest first, then by place.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Door {
    /// Length squared, negative so that the widest comes first.
    width_2: core::cmp::Reverse<i64>,
    ends: (GridPos, GridPos),
    left: u32,
    right: u32,
}

fn doors(triangles: &[Triangle]) -> Vec<Door> {
    let mut doors = Vec::new();
    for (left, triangle) in (0..).zip(triangles) {
        for (i, right) in triangle.beyond.iter().enumerate() {
            if let Some(right) = *right
                && left < right
            {
                let (a, b) = triangle.edge(i);
                doors.push(Door { width_2: core::cmp::Reverse(distance_2(a, b)), ends: (a.min(b), a.max(b)), left, right });
            }
        }
    }
    doors
}

/// What a union must stay within, grid steps.
struct Limits {
    close: Size,
    /// Where neither side has public ground.
    open: Size,
    convexity: f64,
}

/// Twice an area, and a distance squared.
struct Size {
    area_2: i64,
    diameter_2: i64,
}

impl Size {
    fn of(area_m2: f64, diameter_m: f64, slack: f64) -> Self {
        let step = f64::from(GRID_PER_METRE);
        let diameter = diameter_m * slack * step;
        Self { area_2: (area_m2 * slack * 2.0 * step * step) as i64, diameter_2: (diameter * diameter) as i64 }
    }
}

impl Limits {
    fn of(settings: &PartitionSettings, slack: f64) -> Self {
        let close = Size::of(settings.max_area_m2, settings.max_diameter_m, slack);
        let open = Size::of(settings.open_area_m2, settings.open_diameter_m, slack);
        Self {
            open: Size { area_2: open.area_2.max(close.area_2), diameter_2: open.diameter_2.max(close.diameter_2) },
            close,
            convexity: settings.min_convexity / slack,
        }
    }
}

/// Union–find over triangles; roots carry hull, area and whether there is no public ground.
struct Groups {
    parent: Vec<u32>,
    area_2: Vec<i64>,
    hull: Vec<Hull>,
    is_open: Vec<bool>,
}

impl Groups {
    fn new(triangles: &[Triangle], patches: &Patches<'_>) -> Self {
        Self {
            is_open: triangles.iter().map(|t| !patches.is_public_at(t.middle())).collect(),
            parent: (0..triangles.len() as u32).collect(),
            area_2: triangles.iter().map(Triangle::area_2).collect(),
            hull: triangles.iter().map(|t| Hull::of(t.corners.to_vec())).collect(),
        }
    }

    fn root(&mut self, mut t: u32) -> u32 {
        while self.parent[t as usize] != t {
            let grand = self.parent[self.parent[t as usize] as usize];
            self.parent[t as usize] = grand;
            t = grand;
        }
        t
    }

    /// Joins the groups of two triangles if the union stays within the limits. A group that is longer than the limit already (one
    /// wall may be) still takes in what makes it no longer.
    fn try_join(&mut self, a: u32, b: u32, limits: &Limits) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b) as usize, a.max(b) as usize);
        let area_2 = self.area_2[low] + self.area_2[high];
        let longest_2 = self.hull[low].diameter_2.max(self.hull[high].diameter_2);
        let is_open = self.is_open[low] && self.is_open[high];
        let size = if is_open { &limits.open } else { &limits.close };
        if a == b || area_2 > size.area_2 {
            return false;
        }
        let hull = self.hull[low].with(&self.hull[high]);
        if hull.diameter_2 > size.diameter_2.max(longest_2 + longest_2 / 16)
            || (area_2 as f64) < limits.convexity * hull.area_2 as f64
        {
            return false;
        }
        self.parent[high] = low as u32;
        self.area_2[low] = area_2;
        self.is_open[low] = is_open;
        self.hull[low] = hull;
        self.hull[high] = Hull::default();
        true
    }
}

/// Lets each group smaller than an area join the neighbour with which it shares the longest border; whether any did.
fn join_rests(triangles: &[Triangle], groups: &mut Groups, area_m2: f64, limits: &Limits) -> bool {
    let step = f64::from(GRID_PER_METRE);
    let small_2 = (area_m2 * 2.0 * step * step) as i64;
    let mut borders: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    for door in doors(triangles) {
        let (a, b) = (groups.root(door.left), groups.root(door.right));
        if a != b && (groups.area_2[a as usize] < small_2 || groups.area_2[b as usize] < small_2) {
            *borders.entry((a.min(b), a.max(b))).or_default() += libm::sqrt(door.width_2.0 as f64);
        }
    }
    let mut wishes: Vec<(i64, u32, f64, u32)> = borders
        .iter()
        .flat_map(|(&(a, b), &width)| [(a, b, width), (b, a, width)])
        .map(|(from, to, width)| (groups.area_2[from as usize], from, -width, to))
        .filter(|&(area_2, ..)| area_2 < small_2)
        .collect();
    wishes.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)).then(a.3.cmp(&b.3)));
    let mut has_joined = false;
    for (_, from, _, to) in wishes {
        let root = groups.root(from);
        if groups.area_2[root as usize] < small_2 {
            has_joined |= groups.try_join(from, to, limits);
        }
    }
    has_joined
}
