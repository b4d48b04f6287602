//! Plans with a middle: medieval, radial, mixed.

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Id, StreetClass};

use super::description::{CityWords, Outside, TownEdge};
use super::fabric::Role;
use super::fit::Fit;
use super::grain::{Grain, Pattern, cut_to_blocks};
use super::hub::{Exit, Mains, gates, join_far_gates, market, open_square, ring_street, round_place};
use super::lattice::Lattice;
use super::layout::{Town, begin, block_m2, bridge_count};
use super::river::{bridges, crossings_of};
use super::shape::Shape;

/// A lattice without avenues: ring and roads are the broad streets.
const NO_AVENUES: u32 = u32::MAX;

/// What the centred plans differ in.
struct Centred<'a> {
    edge: TownEdge,
    /// How far the border goes in and out, 0 to 1.
    uneven: f64,
    /// Streets that lead out.
    roads: u32,
    mains: Mains,
    /// Streets along the river.
    quay: (StreetClass, f64),
    /// Rings: share of the radius, class and width.
    rings: Vec<(f64, StreetClass, f64)>,
    /// Radius of the main square, metres, and whether it is round.
    square_m: f64,
    is_round: bool,
    /// Share of the radius within which the town is old.
    core: f64,
    /// The grain at a share of the radius.
    grain: &'a dyn Fn(f64) -> Grain<'a>,
}

/// A number that the words leave to the size of the town.
fn by_size(words: &CityWords, least: f64, metres: f64, most: f64) -> u32 {
    libm::round(words.size_m() / 2.0 / metres + least).min(most) as u32
}

/// Boulevards of a small town are not as broad as a city's.
fn broad(words: &CityWords) -> f64 {
    (words.size_m() / 800.0).clamp(0.55, 1.0)
}

fn old_mains(crooked: f64) -> Mains {
    Mains { role: Role::Street(StreetClass::Street), width_m: 9.5, crooked, clear_m: 17.0 }
}

fn old_grain<'a>(words: &CityWords, block_m: f64, crooked: f64, share: f64) -> Grain<'a> {
    Grain {
        block_m2: block_m2(words, block_m) * (0.72 + 0.8 * share.min(1.2)),
        pattern: Pattern::Bent(crooked.max(0.05)),
        streets: [(StreetClass::Lane, 7.0), (StreetClass::Lane, 5.0)],
    }
}

/// Crooked streets from gates to a market.
pub(super) fn medieval(words: &CityWords, edge: TownEdge, gates: Option<u32>, crooked: f64, block_m: f64) -> Town {
    let grain = |share: f64| old_grain(words, block_m, crooked, share);
    centred(
        words,
        &Centred {
            edge,
            uneven: 0.5 + 0.5 * crooked,
            roads: gates.unwrap_or_else(|| by_size(words, 3.0, 160.0, 9.0)),
            mains: old_mains(crooked),
            quay: (StreetClass::Lane, 6.0),
            rings: Vec::new(),
            square_m: (0.075 * words.size_m()).clamp(15.0, 60.0),
            is_round: false,
            core: f64::INFINITY,
            grain: &grain,
        },
    )
}

/// Boulevards from a central square, and rings about it.
pub(super) fn radial(words: &CityWords, boulevards: Option<u32>, rings: Option<u32>, block_m: f64) -> Town {
    let count = rings.unwrap_or_else(|| by_size(words, 1.0, 270.0, 7.0));
    let broad = broad(words);
    // The outermost ring lies a little inside the border, the others closer to one another towards the middle.
    let ring = |n: u32| {
        let t = f64::from(n + 1) / f64::from(count);
        (0.1 + 0.82 * t * (0.9 + 0.1 * t), StreetClass::Main, if n + 1 == count { 16.0 } else { 20.0 } * broad)
    };
    let grain = |_: f64| Grain {
        block_m2: block_m2(words, block_m),
        pattern: Pattern::Bent(0.0),
        streets: [(StreetClass::Street, 14.0 * broad), (StreetClass::Street, (11.5 * broad).max(8.0))],
    };
    centred(
        words,
        &Centred {
            edge: TownEdge::Open,
            uneven: 0.15,
            roads: boulevards.unwrap_or_else(|| by_size(words, 5.0, 260.0, 12.0)),
            mains: Mains { role: Role::Street(StreetClass::Main), width_m: 22.0 * broad, crooked: 0.0, clear_m: 24.0 * broad },
            quay: (StreetClass::Street, 12.0),
            rings: (0..count).map(ring).collect(),
            square_m: (0.055 * words.size_m()).clamp(22.0, 75.0),
            is_round: true,
            core: 0.0,
            grain: &grain,
        },
    )
}

/// A medieval core within a ring street, and a newer town round it.
pub(super) fn mixed(words: &CityWords, core: f64, roads: Option<u32>, crooked: f64, outside: Outside, block_m: f64) -> Town {
    let half = words.size_m() / 2.0;
    let mut rings = vec![(core, StreetClass::Main, 22.0 * broad(words))];
    if half * (1.0 - core) > 420.0 {
        rings.push(((1.0 + 2.0 * core) / 3.0, StreetClass::Main, 17.0));
    }
    let draw = Draw::new(words.seed, Id(8), "words: suburb");
    let lattice = Lattice::new(
        DVec2::ZERO,
        draw.between("angle", -0.6, 0.6),
        words.size_m(),
        [(62.0, 84.0), (84.0, 120.0)],
        NO_AVENUES,
        draw,
    );
    let grain = |share: f64| -> Grain<'_> {
        if share < core {
            return old_grain(words, block_m, crooked, share / core);
        }
        match outside {
            Outside::Grid => Grain {
                block_m2: block_m2(words, 84.0),
                pattern: Pattern::Lattice(&lattice),
                streets: [(StreetClass::Main, 17.0), (StreetClass::Street, 12.0)],
            },
            Outside::Suburb => Grain {
                block_m2: block_m2(words, 95.0),
                pattern: Pattern::Bent(0.55),
                streets: [(StreetClass::Street, 11.0), (StreetClass::Street, 9.0)],
            },
        }
    };
    centred(
        words,
        &Centred {
            edge: TownEdge::Open,
            uneven: 0.8,
            roads: roads.unwrap_or_else(|| by_size(words, 3.0, 220.0, 10.0)),
            mains: Mains { width_m: 11.0, ..old_mains(crooked * 0.6) },
            quay: (StreetClass::Street, 10.0),
            rings,
            square_m: (0.22 * half * core.max(0.3)).clamp(15.0, 56.0),
            is_round: false,
            core,
            grain: &grain,
        },
    )
}

fn centred(words: &CityWords, plan: &Centred<'_>) -> Town {
    // At an open edge the outermost ground, not quite half a block deep, is left to the country.
    let fringe =
        if plan.edge == TownEdge::Open && plan.rings.len() < 2 { 0.4 * libm::sqrt((plan.grain)(1.0).block_m2) } else { 0.0 };
    let shape = Shape::round(words.seed, words.size_m() / 2.0 + fringe, plan.uneven);
    let widest_m = plan.rings.iter().map(|r| r.2).fold(plan.mains.width_m, f64::max);
    let mut town = begin(words, shape, plan.edge, plan.quay, widest_m);
    lay_mains(&mut town, words, plan);
    for &(share, class, width_m) in &plan.rings {
        let way = town.fabric.add_way(Role::Street(class), width_m, false);
        let fit = Fit {
            width_m,
            clear_m: width_m / 2.0 + 14.0,
            least_m2: 700.0,
            least_width_m: 16.0,
            least_angle: 0.7,
            gap_m: width_m + 10.0,
        };
        ring_street(&mut town.fabric, &shape, share, way, &fit);
    }
    for face in 0..town.fabric.faces.len() {
        town.fabric.faces[face].is_core = shape.share(town.fabric.middle(face)) < plan.core;
    }
    cut_to_blocks(&mut town.fabric, words.seed, &|p| (plan.grain)(shape.share(p)));
    town
}

/// Gates, bridges, the main square, and the streets between them.
fn lay_mains(town: &mut Town, words: &CityWords, plan: &Centred<'_>) {
    let shape = town.shape;
    let corners = if plan.is_round { round_place(plan.square_m) } else { market(plan.square_m, words.seed) };
    let hub = hub_beside(town, plan.square_m * 1.4);
    let mouths = town.channel.as_ref().map(|c| c.mouths.clone()).unwrap_or_default();
    let mut exits = gates(&mut town.fabric, &shape, plan.roads, &mouths, words.seed);
    if let Some(channel) = town.channel.clone() {
        let wanted = bridge_count(words, words.size_m() / 2.0);
        let class = if let Role::Street(class) = plan.mains.role { class } else { StreetClass::Street };
        let rings: Vec<f64> = plan.rings.iter().map(|r| r.0).collect();
        let lines = crossings_of(&channel, &shape, hub, wanted, &rings);
        town.bridges = bridges(&mut town.fabric, &channel, &lines, wanted, (class, plan.mains.width_m.min(14.0)));
        exits.extend(town.bridges.iter().flat_map(|b| b.ends).map(|spot| Exit { spot, is_gate: false }));
    }
    if let Some((square, reached)) = open_square(&mut town.fabric, hub, &corners, &exits, &plan.mains, words.seed) {
        town.square = Some(square);
        town.gates = reached.into_iter().filter(|e| e.is_gate).collect();
    }
    let far: Vec<Exit> = exits.iter().copied().filter(|e| town.gates.iter().all(|g| g.spot != e.spot)).collect();
    let reached = join_far_gates(&mut town.fabric, &far, &plan.mains, words.seed);
    town.gates.extend(reached);
}

/// The middle, or as near to it as a square by the river has room.
fn hub_beside(town: &Town, square_m: f64) -> DVec2 {
    let Some(channel) = &town.channel else { return DVec2::ZERO };
    let need = channel.quay_at_m + square_m + 34.0;
    let Some(nearest) = channel.middle.iter().copied().min_by(|a, b| a.length_squared().total_cmp(&b.length_squared())) else {
        return DVec2::ZERO;
    };
    let away = -nearest.normalize_or(DVec2::X);
    // Step by step, since the river bends.
    (0..60).map(|i| away * (f64::from(i) * 4.0)).find(|p| channel.distance_m(*p) >= need).unwrap_or(DVec2::ZERO)
}
