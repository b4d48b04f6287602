//! Footprints drawn by number, for tests and benchmarks: the more awkward, the better.

use core::f64::consts::TAU;

use glam::DVec2;
use veduta_city::Id;
use veduta_city::draw::Draw;

/// Rings on the grid of plans, the outer one counter-clockwise, holes clockwise.
pub type Rings = Vec<Vec<DVec2>>;

/// The footprint of a number: wings (of equal widths, or not), combs, stairs, crosses and stars, regular or ragged, some turned,
/// some with up to four holes, some with corners in the middle of walls, steps of a millimetre, or pressed nearly flat; all up
/// to three kilometres from the origin. `None` if what was drawn crosses or touches itself.
#[must_use]
pub fn drawn_footprint(number: u64) -> Option<Rings> {
    let mut dice = Dice { draw: Draw::new(0, Id(number), "footprint"), thrown: 0 };
    let dice = &mut dice;
    let mut outer = if dice.one_in(3) { star(dice, 40) } else { wings(dice) };
    let mut holes = Rings::new();
    match dice.below(4) {
        0 => {
            outer.iter_mut().for_each(|p| *p *= 4.0);
            holes = (0..1 + dice.below(4)).map(|_| hole(dice, middle(&outer))).collect();
        }
        1 => worry(&mut outer, dice),
        _ => {}
    }
    let turn = if dice.one_in(2) { dice.between(0.0, TAU) } else { 0.0 };
    let turn = DVec2::new(libm::cos(turn), libm::sin(turn));
    let place = DVec2::new(dice.between(-3000.0, 3000.0), dice.between(-3000.0, 3000.0)).round();
    let on_grid = |ring: Vec<DVec2>| {
        let mut ring: Vec<DVec2> = ring.into_iter().map(|p| ((turn.rotate(p) + place) * GRID).round() / GRID).collect();
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        ring
    };
    let mut rings = vec![on_grid(outer)];
    for hole in holes.into_iter().map(on_grid) {
        rings.push(hole);
        // Holes that lie outside, or across one another, are left out.
        let is_inside = |ring: &[DVec2], p: DVec2| winds_around(ring, p);
        let (hole, others) = rings.split_last()?;
        let is_within = hole.iter().all(|&p| is_inside(&others[0], p));
        let is_apart = others[1..].iter().all(|other| !is_inside(other, hole[0]) && !is_inside(hole, other[0]));
        if !(hole.len() >= 3 && area(hole) < 0.0 && is_within && is_apart && is_simple(&rings)) {
            rings.pop();
        }
    }
    (rings[0].len() >= 3 && area(&rings[0]) > 0.0 && is_simple(&rings)).then_some(rings)
}

/// Steps of a metre on the grid.
const GRID: f64 = 1024.0;

/// Throws one number after another.
struct Dice {
    draw: Draw,
    thrown: u64,
}

impl Dice {
    fn unit(&mut self) -> f64 {
        self.thrown += 1;
        self.draw.part(self.thrown).unit("throw")
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }
}

/// A body with wings, square at every corner.
fn wings(dice: &mut Dice) -> Vec<DVec2> {
    // Whole metres, few of them: much happens at once.
    let is_even = dice.one_in(2);
    let [a, b, c, d, e] = [(); 5].map(|()| if is_even { 1.0 + dice.below(6) as f64 } else { dice.between(0.3, 12.0) });
    let points: Vec<(f64, f64)> = match dice.below(7) {
        0 => vec![(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)],
        1 => vec![(0.0, 0.0), (a + c, 0.0), (a + c, b), (a, b), (a, b + d), (0.0, b + d)],
        2 => {
            let (x, y) = (a + b + c, d + e);
            vec![(0.0, 0.0), (x, 0.0), (x, d), (a + b, d), (a + b, y), (a, y), (a, d), (0.0, d)]
        }
        3 => {
            let (x, y) = (a + b + c, d + e);
            vec![(0.0, 0.0), (x, 0.0), (x, y), (a + b, y), (a + b, d), (a, d), (a, y), (0.0, y)]
        }
        4 => {
            let (x, y, top) = (a + b + d, c + e, c + e + a);
            let left = [(a, top), (a, y), (0.0, y), (0.0, c), (a, c)];
            [&[(a, 0.0), (a + b, 0.0), (a + b, c), (x, c), (x, y), (a + b, y), (a + b, top)][..], &left].concat()
        }
        5 => {
            let teeth = 2 + dice.below(6);
            let mut comb = vec![(0.0, 0.0), ((2 * teeth - 1) as f64 * a, 0.0)];
            for i in (0..teeth).rev() {
                let x = 2.0 * i as f64 * a;
                comb.extend([(x + a, b + c), (x, b + c)]);
                if i > 0 {
                    comb.extend([(x, b), (x - a, b)]);
                }
            }
            comb
        }
        _ => {
            let steps = 2 + dice.below(6);
            let stair = |i: usize| {
                let (x, y) = ((steps - i) as f64 * a, (i + 1) as f64 * b);
                [(x, y), (x - a, y)]
            };
            [(0.0, 0.0), (steps as f64 * a, 0.0)].into_iter().chain((0..steps).flat_map(stair)).collect()
        }
    };
    points.into_iter().map(DVec2::from).collect()
}

/// A star of up to so many corners, about 10 m from its middle.
fn star(dice: &mut Dice, most: usize) -> Vec<DVec2> {
    let corners = 3 + dice.below(most);
    let kind = dice.below(6);
    let least = dice.between(0.1, 0.98);
    (0..corners)
        .map(|i| {
            let (off, reach) = match kind {
                0 => (0.0, 1.0),
                1 | 2 => (0.0, if i % 2 == 0 { 1.0 } else { least }),
                _ => (dice.between(-0.45, 0.45), dice.between(least, 1.0)),
            };
            let angle = (i as f64 + off) * TAU / corners as f64;
            DVec2::new(libm::cos(angle), libm::sin(angle)) * 10.0 * reach
        })
        .collect()
}

fn hole(dice: &mut Dice, about: DVec2) -> Vec<DVec2> {
    let mut hole = if dice.one_in(2) { wings(dice) } else { star(dice, 8) };
    let (size, own) = (dice.between(0.1, 0.8), middle(&hole));
    let off = if dice.one_in(2) { DVec2::ZERO } else { DVec2::new(dice.between(-10.0, 10.0), dice.between(-10.0, 10.0)).round() };
    hole.iter_mut().for_each(|p| *p = (*p - own) * size + about + off);
    hole.reverse();
    hole
}

/// Puts corners into walls, a step of the grid beside them or not, and may press it all flat.
fn worry(ring: &mut Vec<DVec2>, dice: &mut Dice) {
    for _ in 0..1 + dice.below(6) {
        let i = dice.below(ring.len());
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        let share = [0.5, dice.unit(), 0.001][dice.below(3)];
        let aside = [0.0, 1.0, -2.0][dice.below(3)] / GRID;
        ring.insert(i + 1, a.lerp(b, share) + (b - a).normalize_or_zero().perp() * aside);
    }
    if dice.one_in(3) {
        let flat = DVec2::new(1.0, dice.between(0.001, 0.1));
        ring.iter_mut().for_each(|p| *p *= flat);
    }
}

fn middle(ring: &[DVec2]) -> DVec2 {
    ring.iter().sum::<DVec2>() / ring.len() as f64
}

/// Signed area of a ring.
pub(super) fn area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    ring.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum::<f64>() / 2.0
}

/// Whether a place lies within a ring, by the even–odd rule.
pub(super) fn winds_around(ring: &[DVec2], p: DVec2) -> bool {
    let edges = (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]));
    let is_right = |(a, b): &(DVec2, DVec2)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
    edges.filter(is_right).count() % 2 == 1
}

/// Whether no two edges cross or touch but where one follows the other.
fn is_simple(rings: &[Vec<DVec2>]) -> bool {
    let edges_of = |(number, ring): (usize, &Vec<DVec2>)| {
        let (len, ring) = (ring.len(), ring.clone());
        (0..len).map(move |i| (number, i, len, ring[i], ring[(i + 1) % len]))
    };
    let edges: Vec<_> = rings.iter().enumerate().flat_map(edges_of).collect();
    edges.iter().enumerate().all(|(n, &(ring, i, len, a, b))| {
        edges[n + 1..].iter().all(|&(other, j, _, c, d)| {
            let follows = |i: usize, j: usize| ring == other && (i + 1) % len == j;
            match (follows(i, j), follows(j, i)) {
                (false, false) => !meet(a, b, c, d),
                (true, _) => !folds_back(a, b, d),
                (_, true) => !folds_back(c, d, b),
            }
        })
    })
}

fn folds_back(a: DVec2, b: DVec2, c: DVec2) -> bool {
    (b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0
}

fn meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let [of_c, of_d, of_a, of_b] = [side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)];
    let is_on = |p: DVec2, q: DVec2, r: DVec2, side: f64| side == 0.0 && (r - p).dot(r - q) <= 0.0;
    of_c * of_d < 0.0 && of_a * of_b < 0.0
        || is_on(a, b, c, of_c)
        || is_on(a, b, d, of_d)
        || is_on(c, d, a, of_a)
        || is_on(c, d, b, of_b)
}
