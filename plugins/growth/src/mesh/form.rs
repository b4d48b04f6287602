use glam::DVec2;
use veduta_city::{RoofShape, VolumeShell, metres};

use super::outline::{Edge, neighbours, wall_count, wall_edge};

/// Height over parameter: pairs from (0, 0) to (1, 1).
pub(super) type Profile = &'static [(f64, f64)];

const STRAIGHT: Profile = &[(0.0, 0.0), (1.0, 1.0)];
const GAMBREL: Profile = &[(0.0, 0.0), (0.36, 0.66), (1.0, 1.0)];
const MANSARD: Profile = &[(0.0, 0.0), (0.24, 0.66), (1.0, 1.0)];
/// A quarter circle in steps of 15°: (1 − cos, sin).
const ROUND: Profile = &[
    (0.0, 0.0),
    (0.034_074_173_7, 0.258_819_045_1),
    (0.133_974_596_2, 0.5),
    (0.292_893_218_8, core::f64::consts::FRAC_1_SQRT_2),
    (0.5, 0.866_025_403_8),
    (0.741_180_954_9, 0.965_925_826_3),
    (1.0, 1.0),
];

/// Where the hips of a half-hipped roof cut its gables, as parameter.
const HALF_HIP: f64 = 0.6;

/// An affine function of the plan position.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Affine {
    pub(super) slope: DVec2,
    pub(super) offset: f64,
}

impl Affine {
    pub(super) fn at(self, p: DVec2) -> f64 {
        self.slope.dot(p) + self.offset
    }
}

/// A level ridge from gable to gable over level eaves: for convex footprints with two sides along the ridge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ridge {
    /// Walls that the ridge meets: entered on the first, left on the second.
    pub(super) gables: [usize; 2],
    /// Where it meets them, as share of the wall.
    pub(super) shares: [f64; 2],
    /// How far the hips reach in from the gables, metres; 0 without hips.
    pub(super) hip_run: f64,
    /// The way the ridge runs.
    pub(super) along: DVec2,
}

impl Ridge {
    /// Parameter at which gables end and hips begin.
    pub(super) fn gable_top(&self) -> f64 {
        if self.hip_run > 0.0 { HALF_HIP } else { 1.0 }
    }
}

/// What kind of parameter the roof has.
#[derive(Debug, Clone, Copy)]
pub(super) enum Form {
    /// Level at the eaves.
    Flat,
    /// Level ridge, level eaves, gables.
    Ridge(Ridge),
    /// The least of some planes.
    Planes([Affine; 4], usize),
    /// A row of this many slopes that each rise from 0 to 1 as the function grows by 1.
    Saw(Affine, u32),
    /// Slopes on every side.
    Hip,
    /// Rings drawn towards the middle.
    Lathe,
}

/// Everything about a volume's roof that its faces and the gables above its walls must agree on.
#[derive(Debug, Clone, Copy)]
pub struct RoofForm<'a> {
    pub(super) volume: &'a VolumeShell,
    pub(super) form: Form,
    pub(super) profile: Profile,
    /// Metres above the city's zero.
    pub(super) eaves: f64,
    /// Eaves to ridge, metres.
    pub(super) height: f64,
}

impl<'a> RoofForm<'a> {
    /// Decides how a volume's roof is built.
    #[must_use]
    pub fn new(volume: &'a VolumeShell) -> Self {
        use RoofShape as S;
        let (form, profile) = match volume.roof.shape {
            _ if volume.roof.height <= 0 || volume.footprint.outer.len() < 3 => (Form::Flat, STRAIGHT),
            S::Flat => (Form::Flat, STRAIGHT),
            S::Gabled | S::HalfHipped => (gabled(volume), STRAIGHT),
            S::Gambrel => (gabled(volume), GAMBREL),
            S::Round => (gabled(volume), ROUND),
            S::Skillion => (skillion(volume), STRAIGHT),
            S::SawTooth => (saw_tooth(volume), STRAIGHT),
            S::Hipped => (Form::Hip, STRAIGHT),
            S::Mansard => (Form::Hip, MANSARD),
            S::Pyramidal | S::Dome | S::Onion | S::Cone if is_star(volume) => (Form::Lathe, STRAIGHT),
            S::Pyramidal | S::Cone => (Form::Hip, STRAIGHT),
            S::Dome | S::Onion => (Form::Hip, ROUND),
        };
        Self { volume, form, profile, eaves: metres(volume.eaves), height: metres(volume.roof.height.max(0)) }
    }

    /// Height over the eaves in metres of the roof along a wall, as (share of the wall's length, height): at least the two
    /// ends, shares ascending (twice the same where the roof has a step). `out` is emptied first.
    pub fn along_wall(&self, wall: usize, out: &mut Vec<(f64, f64)>) {
        out.clear();
        match self.form {
            Form::Ridge(ridge) => self.along_gable(&ridge, wall, out),
            Form::Planes(ref planes, n) => self.along_planes(&planes[..n.min(4)], wall, out),
            Form::Saw(steps, n) => along_teeth(&self.volume.footprint, steps, n, wall, out),
            Form::Flat | Form::Hip | Form::Lathe => {}
        }
        if out.len() < 2 {
            out.clear();
            out.extend([(0.0, 0.0), (1.0, 0.0)]);
        }
        out.iter_mut().for_each(|point| point.1 *= self.height);
    }

    /// Whether the roof is level with the eaves along a wall's whole length. `scratch` is overwritten.
    pub(super) fn is_level_along(&self, wall: usize, scratch: &mut Vec<(f64, f64)>) -> bool {
        match self.form {
            Form::Flat | Form::Hip | Form::Lathe => true,
            Form::Ridge(ridge) => !ridge.gables.contains(&wall),
            _ => {
                self.along_wall(wall, scratch);
                scratch.iter().all(|point| point.1 < 0.02)
            }
        }
    }

    /// Height as share of the whole at a parameter.
    pub(super) fn bend(&self, t: f64) -> f64 {
        bend(self.profile, t)
    }

    fn along_gable(&self, ridge: &Ridge, wall: usize, out: &mut Vec<(f64, f64)>) {
        let Some(end) = ridge.gables.iter().position(|&g| g == wall) else { return };
        let (share, top) = (ridge.shares[end], ridge.gable_top());
        for &(t, h) in self.profile.iter().filter(|(t, _)| *t < top) {
            out.push((t * share, h));
        }
        out.push((top * share, self.bend(top)));
        if top < 1.0 {
            out.push((1.0 - top * (1.0 - share), self.bend(top)));
        }
        for &(t, h) in self.profile.iter().rev().filter(|(t, _)| *t < top) {
            out.push((1.0 - t * (1.0 - share), h));
        }
    }

    fn along_planes(&self, planes: &[Affine], wall: usize, out: &mut Vec<(f64, f64)>) {
        let Some(edge) = wall_edge(&self.volume.footprint, wall) else { return };
        let ends = |plane: Affine| (plane.at(edge.a), plane.at(edge.b));
        out.extend([(0.0, 0.0), (1.0, 0.0)]);
        let mut cut = |share: f64| {
            if share > 1e-9 && share < 1.0 - 1e-9 {
                out.push((share, 0.0));
            }
        };
        for (i, &p) in planes.iter().enumerate() {
            let (p0, p1) = ends(p);
            for &(t, _) in self.profile.iter().filter(|(t, _)| *t > 0.0 && *t < 1.0) {
                cut((t - p0) / (p1 - p0));
            }
            for &q in planes.iter().take(i) {
                let (q0, q1) = ends(q);
                cut((q0 - p0) / ((p1 - p0) - (q1 - q0)));
            }
        }
        out.sort_by(|x, y| x.0.total_cmp(&y.0));
        out.dedup_by(|x, y| x.0 - y.0 < 1e-9);
        for (share, h) in out.iter_mut() {
            let t = planes.iter().map(|p| p.at(edge.at(*share))).fold(1.0, f64::min);
            *h = self.bend(t.max(0.0));
        }
    }
}

/// Height of a profile at a parameter.
pub(super) fn bend(profile: Profile, t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    let piece = profile.windows(2).find(|w| t <= w[1].0);
    piece.map_or(1.0, |w| w[0].1 + (w[1].1 - w[0].1) * (t - w[0].0) / (w[1].0 - w[0].0))
}

/// The side of a tooth line that a wall on it belongs to is found this far inside of the wall; metres.
const NUDGE_M: f64 = 1e-4;

fn along_teeth(footprint: &veduta_city::GridPolygon, steps: Affine, n: u32, wall: usize, out: &mut Vec<(f64, f64)>) {
    let Some(edge) = wall_edge(footprint, wall) else { return };
    let (s0, s1) = (steps.at(edge.a), steps.at(edge.b));
    let inside = steps.slope.dot(edge.out) * -NUDGE_M;
    if (s1 - s0).abs() < 1e-3 {
        let h = tooth(s0 + inside, n).1;
        out.extend([(0.0, h), (1.0, h)]);
        return;
    }
    let mut cuts: Vec<f64> = (1..n).map(|k| (f64::from(k) - s0) / (s1 - s0)).filter(|&c| c > 0.0 && c < 1.0).collect();
    cuts.sort_by(f64::total_cmp);
    let mut from = 0.0;
    for to in cuts.into_iter().chain([1.0]) {
        let (index, _) = tooth(s0 + (s1 - s0) * (from + to) / 2.0, n);
        let height = |share: f64| (s0 + (s1 - s0) * share - f64::from(index)).clamp(0.0, 1.0);
        out.extend([(from, height(from)), (to, height(to))]);
        from = to;
    }
}

/// Which tooth a place is in, and its parameter there.
fn tooth(s: f64, n: u32) -> (u32, f64) {
    let index = s.floor().clamp(0.0, f64::from(n.max(1) - 1));
    (index as u32, (s - index).clamp(0.0, 1.0))
}

/// Unit vector of a heading in whole degrees clockwise from north, or of the footprint's longest edge within 2° of it or of
/// its perpendicular: directions are whole degrees, walls are not.
fn snapped(volume: &VolumeShell) -> DVec2 {
    let radians = f64::from(volume.roof.direction).to_radians();
    let told = DVec2::new(libm::sin(radians), libm::cos(radians));
    let mut best = (0.0, told);
    for i in 0..volume.footprint.outer.len() {
        let Some(edge) = wall_edge(&volume.footprint, i) else { continue };
        let quarter = [edge.along, -edge.along, edge.out, -edge.out];
        let Some(near) = quarter.into_iter().find(|d| d.dot(told) > 0.999_39) else { continue };
        if edge.length > best.0 {
            best = (edge.length, near);
        }
    }
    best.1
}

/// Least and greatest distance of the outer ring along a direction.
fn extent(volume: &VolumeShell, along: DVec2) -> (f64, f64) {
    let distances = volume.footprint.outer.iter().map(|p| p.to_metres().dot(along));
    distances.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
}

/// Least extent of a roof that is built with slopes; metres.
const LEAST_M: f64 = 0.2;

fn gabled(volume: &VolumeShell) -> Form {
    let along = snapped(volume);
    let across = DVec2::new(along.y, -along.x);
    let ((d0, d1), (s0, s1)) = (extent(volume, across), extent(volume, along));
    let (half, middle) = ((d1 - d0) / 2.0, (d1 + d0) / 2.0);
    if half < LEAST_M || s1 - s0 < LEAST_M {
        return Form::Flat;
    }
    if !volume.footprint.holes.is_empty() || outer_area(volume) < 0.75 * (d1 - d0) * (s1 - s0) {
        return Form::Hip;
    }
    let is_half_hipped = volume.roof.shape == RoofShape::HalfHipped;
    let hip_run = if is_half_hipped { ((1.0 - HALF_HIP) * half).min(0.4 * (s1 - s0)) } else { 0.0 };
    if let Some(ridge) = level_ridge(volume, along, across, middle, half, hip_run) {
        return Form::Ridge(ridge);
    }
    let left = Affine { slope: across / half, offset: 1.0 - middle / half };
    let right = Affine { slope: -across / half, offset: 1.0 + middle / half };
    if !is_half_hipped {
        return Form::Planes([left, right, Affine::default(), Affine::default()], 2);
    }
    let rise = (1.0 - HALF_HIP) / hip_run;
    let near = Affine { slope: along * rise, offset: HALF_HIP - s0 * rise };
    let far = Affine { slope: along * -rise, offset: HALF_HIP + s1 * rise };
    Form::Planes([left, right, near, far], 4)
}

/// A level ridge, if the footprint is convex, the ridge's line meets exactly two walls, no corner lies near it and both eaves
/// run steadily along it.
fn level_ridge(volume: &VolumeShell, along: DVec2, across: DVec2, middle: f64, half: f64, hip_run: f64) -> Option<Ridge> {
    let ring = &volume.footprint.outer;
    let at = |i: usize| ring[i % ring.len()].to_metres();
    let (mut gables, mut shares, mut found) = ([0; 2], [0.0; 2], 0);
    for i in 0..ring.len() {
        let (a, b, c) = (at(i), at(i + 1), at(i + 2));
        let (da, db) = (across.dot(a) - middle, across.dot(b) - middle);
        let turn = (b - a).perp_dot(c - b);
        if da.abs() < 0.5 * half || turn < -1e-6 * (b - a).length() * (c - b).length() {
            return None;
        }
        if (da > 0.0) == (db > 0.0) {
            // Counter-clockwise, the side on the right of the ridge is walked along it, the other against it.
            if (b - a).dot(along) * da.signum() <= 0.0 {
                return None;
            }
            continue;
        }
        let end = usize::from(da < 0.0);
        found += 1;
        gables[end] = i;
        shares[end] = da / (da - db);
    }
    let ends = [wall_edge(&volume.footprint, gables[0])?.at(shares[0]), wall_edge(&volume.footprint, gables[1])?.at(shares[1])];
    let is_long = (ends[0] - ends[1]).dot(along) > (2.0 * hip_run).max(LEAST_M);
    (found == 2 && gables[0] != gables[1] && is_long).then_some(Ridge { gables, shares, hip_run, along })
}

fn outer_area(volume: &VolumeShell) -> f64 {
    let Some(o) = volume.footprint.outer.first().map(|p| p.to_metres()) else { return 0.0 };
    let at = |p: &veduta_city::GridPos| p.to_metres() - o;
    volume.footprint.outer.windows(2).map(|w| at(&w[0]).perp_dot(at(&w[1]))).sum::<f64>() / 2.0
}

fn skillion(volume: &VolumeShell) -> Form {
    let falls = snapped(volume);
    let (s0, s1) = extent(volume, falls);
    if s1 - s0 < LEAST_M {
        return Form::Flat;
    }
    let plane = Affine { slope: -falls / (s1 - s0), offset: s1 / (s1 - s0) };
    Form::Planes([plane, Affine::default(), Affine::default(), Affine::default()], 1)
}

/// Length of a saw tooth, metres, and the most of them.
const TOOTH_M: f64 = 5.0;
const MOST_TEETH: f64 = 64.0;

fn saw_tooth(volume: &VolumeShell) -> Form {
    let falls = snapped(volume);
    let (s0, s1) = extent(volume, falls);
    if s1 - s0 < 2.0 * LEAST_M {
        return Form::Flat;
    }
    let n = ((s1 - s0) / TOOTH_M).round().clamp(2.0, MOST_TEETH);
    let step = (s1 - s0) / n;
    Form::Saw(Affine { slope: -falls / step, offset: s1 / step }, n as u32)
}

/// Whether the middle of a footprint without holes sees all of it.
fn is_star(volume: &VolumeShell) -> bool {
    let footprint = &volume.footprint;
    let middle = centroid(volume);
    let sees = |i| {
        let Some(edge) = wall_edge(footprint, i) else { return true };
        edge.out.dot(edge.a - middle) > 0.02
    };
    footprint.holes.is_empty() && (0..wall_count(footprint)).all(sees)
}

/// Centroid of the outer ring, metres.
pub(super) fn centroid(volume: &VolumeShell) -> DVec2 {
    let ring = &volume.footprint.outer;
    let Some(base) = ring.first().map(|p| p.to_metres()) else { return DVec2::ZERO };
    let (mut sum, mut twice) = (DVec2::ZERO, 0.0);
    for w in ring.windows(2) {
        let (a, b) = (w[0].to_metres() - base, w[1].to_metres() - base);
        sum += (a + b) * a.perp_dot(b);
        twice += a.perp_dot(b);
    }
    if twice.abs() < 1e-9 { base } else { base + sum / (3.0 * twice) }
}

/// Walls along which an overhang may run round the corner: whether the wall before and after is level, too.
pub(super) fn level_neighbours(form: &RoofForm<'_>, wall: usize, scratch: &mut Vec<(f64, f64)>) -> (Option<Edge>, Option<Edge>) {
    let Some((before, after)) = neighbours(&form.volume.footprint, wall) else { return (None, None) };
    let mut level = |i| if form.is_level_along(i, scratch) { wall_edge(&form.volume.footprint, i) } else { None };
    (level(before), level(after))
}
