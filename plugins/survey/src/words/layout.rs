//! The fabric of each plan, and of the grid.

use core::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Id, StreetClass};

use super::centred::{medieval, mixed, radial};
use super::description::{CityWords, Plan, TownEdge};
use super::fabric::{Fabric, FaceId, Role, Use, Way, crossings, ring_edges};
use super::fit::Fit;
use super::grain::{Grain, Pattern, cut_to_blocks};
use super::hub::Exit;
use super::lattice::Lattice;
use super::river::{Bridge, Channel, bridges, crossings_of, fords, is_square_on};
use super::shape::Shape;
use super::turn;

/// A town in the making.
#[derive(Debug)]
pub(super) struct Town {
    pub fabric: Fabric,
    pub shape: Shape,
    pub channel: Option<Channel>,
    pub bridges: Vec<Bridge>,
    /// Gates that a main street leads to.
    pub gates: Vec<Exit>,
    pub square: Option<FaceId>,
    /// Whether the border is a street.
    pub is_closed: bool,
}

/// Smaller towns have a lane round them, whatever the plan; metres.
const SMALL_M: f64 = 320.0;
/// Streets along river and border do not meet at less; radians (34°).
const SHARP: f64 = 0.6;
/// Grids of fewer blocks from side to side have a lane round them.
const SMALL_GRID: f64 = 5.5;

/// Lays the streets of a town, down to its blocks.
pub(super) fn lay_out(words: &CityWords) -> Town {
    match &words.plan {
        Plan::Grid { short_m, long_m, avenue_every, diagonals, heading_deg } => {
            let draw = Lattice::draw(words.seed);
            // Headings run clockwise from north.
            let angle = heading_deg.map_or_else(|| draw.between("angle", -0.5, 0.5), |h| FRAC_PI_2 - h.to_radians());
            let reach = 1.5 * words.size_m();
            let lattice =
                Lattice::new(DVec2::ZERO, angle, reach, [*short_m, *long_m].map(|gap| dense(words, gap)), *avenue_every, draw);
            let between = |(low, high): (f64, f64)| (low + high) / 2.0;
            let area = between(dense(words, *short_m)) * between(dense(words, *long_m)) * 0.8;
            grid(words, &lattice, *diagonals, area)
        }
        Plan::Radial { boulevards, rings, block_m } => radial(words, *boulevards, *rings, *block_m),
        Plan::Medieval { edge, gates, crooked, block_m } => medieval(words, *edge, *gates, *crooked, *block_m),
        Plan::Mixed { core, roads, crooked, outside, block_m } => mixed(words, *core, *roads, *crooked, *outside, *block_m),
    }
}

/// Distances that density makes of those given.
fn dense(words: &CityWords, (low, high): (f64, f64)) -> (f64, f64) {
    let by = 1.0 / libm::sqrt(0.65 + 0.5 * words.density);
    // No town is so small that it has only a few blocks.
    let most = words.size_m() / 4.5;
    ((low * by).min(most).max(38.0), (high * by).min(most).max(38.0))
}

/// Area of a block of a side, by density, and by size likewise.
pub(super) fn block_m2(words: &CityWords, side_m: f64) -> f64 {
    let side_m = side_m.min(words.size_m() / 6.5);
    side_m * side_m / (0.65 + 0.5 * words.density)
}

fn grid(words: &CityWords, lattice: &Lattice, diagonals: u32, block_m2: f64) -> Town {
    let draw = Draw::new(words.seed, Id(7), "words: grid");
    // At an open edge the outermost ground, half a block deep, is left to the country.
    let side = libm::sqrt(block_m2);
    let (edge, fringe) = if words.size_m() < SMALL_GRID * side { (TownEdge::Wall, 0.0) } else { (TownEdge::Open, 0.5 * side) };
    let half = words.size_m() / 2.0 + fringe;
    let aspect = draw.between("aspect", 0.8, 1.0);
    let shape = Shape::Oblong { dir: lattice.dir(), half_m: DVec2::new(half, half * aspect) };
    let mut town = begin(words, shape, edge, (StreetClass::Street, 12.0), 20.0);
    let corners = town.fabric.outline(0);
    if let Some(channel) = town.channel.clone() {
        let mut lines: Vec<(DVec2, DVec2)> = Vec::new();
        let avenues = lattice.across(&shape.border());
        for line in avenues.iter().filter(|l| l.is_avenue) {
            lines.extend(fords(&channel, line.through, line.dir).into_iter().map(|p| (p, line.dir)));
        }
        lines.retain(|&(p, dir)| is_square_on(&channel, p, dir) && shape.share(p) < 0.92);
        lines.sort_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
        // Where no avenue meets the river, straight over it.
        lines.extend(crossings_of(&channel, &shape, DVec2::ZERO, 3, &[]));
        let wanted = bridge_count(words, half);
        town.bridges = bridges(&mut town.fabric, &channel, &lines, wanted, (StreetClass::Main, 15.0));
    }
    for n in 0..diagonals {
        let draw = draw.part(u64::from(n));
        let angle = draw.between("angle", 0.6, 0.97) * if (n + u32::from(draw.chance("side", 0.5))) % 2 == 0 { 1.0 } else { -1.0 };
        let through = turn(DVec2::X, draw.between("turn", 0.0, TAU)) * draw.between("away", 0.1, 0.4) * half;
        diagonal(&mut town, through, turn(lattice.dir(), angle), &corners);
    }
    let streets = [(StreetClass::Main, 19.0), (StreetClass::Street, 12.5)];
    cut_to_blocks(&mut town.fabric, words.seed, &|_| Grain { block_m2, pattern: Pattern::Lattice(lattice), streets });
    town
}

/// An avenue across all land on a line.
fn diagonal(town: &mut Town, through: DVec2, dir: DVec2, border: &[DVec2]) {
    if crossings(border, through, dir).len() != 2 {
        return;
    }
    let fit = Fit { width_m: 20.0, clear_m: 30.0, least_m2: 2_500.0, least_width_m: 30.0, least_angle: 0.5, gap_m: 34.0 };
    let way = town.fabric.add_way(Role::Street(StreetClass::Main), 20.0, true);
    for face in 0..town.fabric.faces.len() {
        let fabric = &mut town.fabric;
        if fabric.faces[face].use_ != Use::Land {
            continue;
        }
        for [a, b] in crossings(&fabric.outline(face), through, dir).as_chunks::<2>().0 {
            let (Some(from), Some(to)) = (fabric.end_near(face, a.0, a.1, fit.gap_m), fabric.end_near(face, b.0, b.1, fit.gap_m))
            else {
                continue;
            };
            if fabric.division(face, from, &[], to, &fit).is_some() {
                let (from, to) = (fabric.place(from), fabric.place(to));
                fabric.split(face, from, &[], to, way);
                break;
            }
        }
    }
}

/// The border, and the river in it; `widest_m` is the width of the widest street.
pub(super) fn begin(words: &CityWords, shape: Shape, edge: TownEdge, quay: (StreetClass, f64), widest_m: f64) -> Town {
    let edge = if edge == TownEdge::Open && words.size_m() < SMALL_M { TownEdge::Wall } else { edge };
    let role = match edge {
        TownEdge::Wall => (Role::Street(StreetClass::Lane), 5.5),
        TownEdge::Ring => (Role::Street(StreetClass::Main), 16.0),
        TownEdge::Open => (Role::Edge, 0.0),
    };
    let mut fabric = Fabric::new(&shape.border(), Way { role: role.0, width_m: role.1, is_main: false });
    let mut channel = words.river.as_ref().map(|river| Channel::new(river, &shape, quay.1, widest_m, words.seed));
    if let Some(river) = &mut channel {
        let way = fabric.add_way(Role::Street(quay.0), quay.1, false);
        if river.lay(&mut fabric, way).is_none() {
            channel = None;
        }
        open_mouths(&mut fabric, channel.as_ref().map_or(&[], |c| &c.mouths));
    }
    let is_closed = edge != TownEdge::Open;
    Town { fabric, shape, channel, bridges: Vec::new(), gates: Vec::new(), square: None, is_closed }
}

/// No street runs along the border where water passes it, nor where it would meet a quay at a sharp angle.
fn open_mouths(fabric: &mut Fabric, mouths: &[u32]) {
    let waters = fabric.faces.iter().filter(|f| f.use_ == Use::Water);
    let mut open: Vec<(u32, u32)> =
        waters.flat_map(|f| ring_edges(&f.ring)).filter(|&(a, b)| fabric.way_id(a, b) == Some(0)).collect();
    for &mouth in mouths {
        let towards = |n: u32| (fabric.pos(n) - fabric.pos(mouth)).normalize_or_zero();
        let (border, quay): (Vec<u32>, Vec<u32>) =
            fabric.neighbours(mouth).iter().partition(|&&n| fabric.way_id(mouth, n) == Some(0));
        let is_sharp = |n: u32| quay.iter().any(|&q| towards(n).dot(towards(q)) > libm::cos(SHARP));
        open.extend(border.into_iter().filter(|&n| is_sharp(n)).map(|n| (mouth, n)));
    }
    let none = fabric.add_way(Role::Edge, 0.0, false);
    for (a, b) in open {
        fabric.set_way(a, b, none);
    }
}

/// Bridges wanted: those given, or one for every 350 m of river, at least one.
pub(super) fn bridge_count(words: &CityWords, half: f64) -> usize {
    let given = words.river.as_ref().and_then(|r| r.bridges);
    given.unwrap_or_else(|| libm::round(half / 190.0).clamp(1.0, 12.0) as u32) as usize
}
