//! What the faces between streets are for: squares, parks, gardens, churches, districts.

use std::collections::BTreeSet;

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Block, BlockKind, Id, Ring, Square, Surfacing};

use super::description::{CityWords, District, Part, Plan};
use super::fabric::{Fabric, FaceId, Role, Spot, Use, ring_edges};
use super::grain;
use super::landmarks::church;
use super::layout::Town;
use super::network::Streets;
use crate::polygon::{Polygon, difference, even_odd, perimeter_m, signed_area};

/// Sizes that a square may have, square metres.
const SQUARE_M2: (f64, f64) = (900.0, 11_000.0);
/// Ground on which a church may stand, square metres.
const CHURCH_M2: (f64, f64) = (1_100.0, 6_500.0);
/// Pieces of blocks smaller or thinner than this are left paved; square metres, metres.
const LEAST_BLOCK_M2: f64 = 120.0;
const LEAST_WIDTH_M: f64 = 7.0;
/// Vertices this close to the line between their neighbours are left out; metres.
const STRAIGHT_M: f64 = 0.04;

/// Whether a face may be built on: it touches neither the edge of the modelled ground nor water.
fn is_inner(fabric: &Fabric, face: FaceId) -> bool {
    let is_land = !matches!(fabric.faces.get(face).map(|f| f.use_), None | Some(Use::Water));
    is_land && ring_edges(fabric.ring(face)).all(|(a, b)| fabric.way(a, b).is_some_and(|w| w.role != Role::Edge))
}

/// Faces of land that nothing has been decided about.
fn free(fabric: &Fabric) -> Vec<FaceId> {
    (0..fabric.faces.len()).filter(|&f| fabric.faces[f].use_ == Use::Land && is_inner(fabric, f)).collect()
}

/// Opens squares until there are as many as wanted or none has room; gives back how many there are.
pub(super) fn open_squares(town: &mut Town, wanted: u32) -> u32 {
    let heads: BTreeSet<Spot> = town.bridges.iter().flat_map(|b| b.ends).chain(town.gates.iter().map(|g| g.spot)).collect();
    let mut middles: Vec<DVec2> = town.square.iter().map(|&f| town.fabric.middle(f)).collect();
    let apart = town.shape.radius_m(DVec2::X) * 0.25;
    while (middles.len() as u32) < wanted {
        let fabric = &town.fabric;
        let may = |&f: &FaceId| {
            let area = fabric.area_m2(f);
            let round = 2.0 * area / perimeter_m(&fabric.outline(f));
            let middle = fabric.middle(f);
            (SQUARE_M2.0..=SQUARE_M2.1).contains(&area)
                && round > 0.36 * libm::sqrt(area)
                && middles.iter().all(|m| m.distance(middle) > apart.max(110.0))
                && town.shape.share(middle) < 0.85
                && ring_edges(fabric.ring(f)).all(|(a, b)| fabric.way_id(a, b) != Some(0) && !heads.contains(&a))
                && ring_edges(fabric.ring(f)).all(|(a, b)| fabric.face_left(b, a).is_some_and(|n| is_dry(fabric, n)))
        };
        // The first near the middle, the others each as far from the rest as half the town is wide at most.
        let worth = |f: FaceId| {
            let middle = fabric.middle(f);
            let near = middles.iter().map(|m| m.distance(middle)).fold(f64::INFINITY, f64::min);
            // Well inside the town: half-way out.
            let off = (town.shape.share(middle) - 0.45).abs();
            if middles.is_empty() { -middle.length() } else { near.min(2.4 * apart) * (1.0 - 1.5 * off).max(0.05) }
        };
        let Some(face) = free(fabric).into_iter().filter(may).max_by(|&a, &b| worth(a).total_cmp(&worth(b))) else { break };
        middles.push(fabric.middle(face));
        make_square(&mut town.fabric, face);
        town.square.get_or_insert(face);
    }
    middles.len() as u32
}

fn is_dry(fabric: &Fabric, face: FaceId) -> bool {
    fabric.faces.get(face).is_some_and(|f| f.use_ != Use::Water && f.use_ != Use::Square)
}

/// Makes a face a square: the streets round it become part of it, and what led there ends on its border.
fn make_square(fabric: &mut Fabric, face: FaceId) {
    let front = fabric.add_way(Role::Front, 0.0, false);
    let ring: Vec<(Spot, Spot)> = ring_edges(fabric.ring(face)).collect();
    for (a, b) in ring {
        fabric.set_way(a, b, front);
    }
    if let Some(face) = fabric.faces.get_mut(face) {
        face.use_ = Use::Square;
    }
}

/// Makes parks of so great a share of the ground, and of a church's ground by the main square.
pub(super) fn choose_parks(town: &mut Town, share: f64, seed: u64) {
    let fabric = &town.fabric;
    let mut all = free(fabric);
    let area = |f: FaceId| fabric.area_m2(f);
    let mut left = share * all.iter().map(|&f| area(f)).sum::<f64>();
    let worth = |f: FaceId| {
        let draw = Draw::new(seed, Id::from_place("ground", fabric.middle(f)), "words: parks");
        let by_water = town.channel.as_ref().is_some_and(|c| c.distance_m(fabric.middle(f)) < c.quay_at_m + 70.0);
        let far = town.shape.share(fabric.middle(f));
        draw.unit("worth") + if by_water { 0.3 } else { 0.0 } + 0.3 * far.min(0.8) + area(f).min(20_000.0) / 25_000.0
    };
    all.sort_by(|&a, &b| worth(b).total_cmp(&worth(a)));
    let mut chosen = Vec::new();
    for face in all {
        if area(face) <= left * 1.15 {
            left -= area(face);
            chosen.push(face);
        }
    }
    for face in chosen {
        town.fabric.faces[face].use_ = Use::Park;
    }
}

/// The ground for the main church: the face nearest to the main square that has room for it.
pub(super) fn choose_church(town: &mut Town) -> Option<FaceId> {
    let fabric = &town.fabric;
    let square = town.square.map(|f| fabric.middle(f))?;
    let may = |&f: &FaceId| {
        let area = fabric.area_m2(f);
        (CHURCH_M2.0..=CHURCH_M2.1).contains(&area) && 2.0 * area / perimeter_m(&fabric.outline(f)) > 0.36 * libm::sqrt(area)
    };
    let away = |f: FaceId| fabric.middle(f).distance(square);
    let mut near: Vec<FaceId> = free(fabric).into_iter().filter(may).collect();
    near.sort_by(|&a, &b| away(a).total_cmp(&away(b)));
    let has_room = |f: FaceId| matches!(between_streets(fabric, f).as_slice(), [ground] if church(ground, "", 0).is_some());
    let face = near.into_iter().take(12).find(|&f| has_room(f))?;
    town.fabric.faces[face].use_ = Use::Monument;
    Some(face)
}

/// A block and the face it came of.
#[derive(Debug)]
pub(super) struct Ground {
    pub block: Block,
    pub face: FaceId,
    pub area_m2: f64,
}

/// Blocks of all inner faces: what their streets leave.
pub(super) fn blocks(town: &Town, streets: &Streets, words: &CityWords) -> Vec<Ground> {
    let fabric = &town.fabric;
    let mut out = Vec::new();
    for face in (0..fabric.faces.len()).filter(|&f| is_inner(fabric, f)) {
        let use_ = fabric.faces[face].use_;
        let is_fronted = ring_edges(fabric.ring(face))
            .any(|(a, b)| streets.has(a, b) || fabric.way(a, b).is_some_and(|w| w.role == Role::Front));
        let kind = match use_ {
            Use::Square | Use::Water => continue,
            Use::Park => BlockKind::Park,
            Use::Monument => BlockKind::Monument,
            Use::Land if is_garden(town, face, words) => BlockKind::Park,
            Use::Land => BlockKind::Built,
        };
        if !is_fronted {
            continue;
        }
        for outline in between_streets(fabric, face) {
            let area_m2 = signed_area(&outline);
            if area_m2 < LEAST_BLOCK_M2 || 2.0 * area_m2 / perimeter_m(&outline) < LEAST_WIDTH_M {
                continue;
            }
            let block = Block { id: Id::NONE, kind, name: String::new(), district: String::new(), outline, holes: Vec::new() };
            out.push(Ground { block, face, area_m2 });
        }
    }
    out
}

/// Whether a block towards the edge is gardens, since the town is not dense.
fn is_garden(town: &Town, face: FaceId, words: &CityWords) -> bool {
    let middle = town.fabric.middle(face);
    let share = town.shape.share(middle);
    let draw = Draw::new(words.seed, Id::from_place("ground", middle), "words: gardens");
    draw.chance("garden", (1.0 - words.density) * 0.8 * share * share * share)
}

/// Outlines of what a face's streets leave of it, on the centimetre.
fn between_streets(fabric: &Fabric, face: FaceId) -> Vec<Ring> {
    let ring = fabric.ring(face);
    let whole = [Polygon { outer: fabric.outline(face), holes: Vec::new() }];
    let n = ring.len();
    let half = |i: usize| {
        let (a, b) = (ring[i % n], ring[(i + 1) % n]);
        fabric.way(a, b).map_or(0.0, |w| w.width_m / 2.0)
    };
    let pos = |i: usize| fabric.pos(ring[i % n]);
    let mut bands: Vec<Polygon> = Vec::new();
    let mut add = |outer: Ring| {
        if signed_area(&outer) > 1e-6 {
            bands.push(Polygon { outer, holes: Vec::new() });
        }
    };
    for i in 0..n {
        let (p, q) = (pos(i), pos(i + 1));
        let in_m = (q - p).perp().normalize_or_zero() * half(i);
        add(vec![p, q, q + in_m, p + in_m]);
        let next = pos(i + 2) - q;
        let next_in = next.perp().normalize_or_zero() * half(i + 1);
        if (q - p).perp_dot(next) < 0.0 {
            // The street bends away: the corner between its two pieces.
            let tip = in_m + next_in;
            let reach = tip * (in_m.length() * next_in.length() / tip.length_squared().max(1e-9)).max(0.5);
            add(vec![q, q + next_in, q + if reach.length() < 2.0 * in_m.length() { reach } else { tip * 0.5 }, q + in_m]);
        }
    }
    let left = if bands.is_empty() { whole.to_vec() } else { difference(&whole, &bands) };
    left.into_iter().flat_map(|polygon| tidied(&polygon.outer)).collect()
}

/// A ring on the centimetre, without vertices that do not bend it; the pieces it falls into, if it does.
fn tidied(ring: &[DVec2]) -> Vec<Ring> {
    let mut kept: Ring = ring.iter().map(|&p| super::fabric::rounded(p)).collect();
    kept.dedup();
    let mut i = 0;
    while kept.len() > 3 && i < kept.len() {
        let n = kept.len();
        let (a, p, b) = (kept[(i + n - 1) % n], kept[i], kept[(i + 1) % n]);
        let is_spike = (p - a).dot(b - p) < 0.0 && (p - a).perp_dot(b - p).abs() < 0.05 * (p - a).length() * (b - p).length();
        if super::fit::distance_to(p, a, b) < STRAIGHT_M || is_spike {
            kept.remove(i);
            i = i.saturating_sub(2);
        } else {
            i += 1;
        }
    }
    even_odd(&[kept]).0.into_iter().map(|p| p.outer.into_iter().map(super::fabric::rounded).collect()).collect()
}

/// Squares of the faces that are squares.
pub(super) fn squares(fabric: &Fabric, is_old: bool) -> Vec<(FaceId, Square)> {
    let square = |f: FaceId| Square {
        id: Id::NONE,
        name: String::new(),
        outline: fabric.outline(f),
        holes: Vec::new(),
        surfacing: if is_old { Surfacing::Cobbles } else { Surfacing::Mosaic },
    };
    (0..fabric.faces.len()).filter(|&f| fabric.faces[f].use_ == Use::Square).map(|f| (f, square(f))).collect()
}

/// The districts that a plan has where the words name none.
fn custom(words: &CityWords, core_share: f64) -> Vec<District> {
    let district = |name: &str, style: &str, share: f64, at: Part| District { name: name.into(), style: style.into(), share, at };
    match words.plan {
        Plan::Medieval { .. } => vec![district("Old Town", "old_town", 1.0, Part::Centre)],
        Plan::Mixed { .. } => vec![
            district("Old Town", "old_town", core_share.max(1e-6), Part::Centre),
            district("New Town", "tenement", (0.55 * (1.0 - core_share)).max(1e-6), Part::Ring),
            district("Garden Town", "suburban", 1.0, Part::Edge),
        ],
        Plan::Radial { .. } => {
            vec![district("Inner Town", "tenement", 0.6, Part::Centre), district("Garden Town", "suburban", 1.0, Part::Edge)]
        }
        Plan::Grid { .. } => vec![
            district("Downtown", "modern", 0.14, Part::Centre),
            district("Midtown", "tenement", 0.5, Part::Ring),
            district("Garden Town", "suburban", 1.0, Part::Edge),
        ],
    }
}

/// Gives every built block a district; gives back each district's name and middle.
pub(super) fn districts(town: &Town, words: &CityWords, grounds: &mut [Ground]) -> Vec<(String, DVec2)> {
    let built: Vec<usize> = (0..grounds.len()).filter(|&i| grounds[i].block.kind == BlockKind::Built).collect();
    let total: f64 = built.iter().map(|&i| grounds[i].area_m2).sum();
    let is_core = |i: usize| town.fabric.faces.get(grounds[i].face).is_some_and(|f| f.is_core);
    let core: f64 = built.iter().filter(|&&i| is_core(i)).map(|&i| grounds[i].area_m2).sum();
    let list = if words.districts.is_empty() { custom(words, core / total.max(1.0)) } else { words.districts.clone() };
    let mut left = built;
    let mut out = Vec::new();
    for (n, district) in list.iter().enumerate() {
        let middle = |i: usize| town.fabric.middle(grounds[i].face);
        left.sort_by(|&a, &b| rank(town, district.at, middle(a)).total_cmp(&rank(town, district.at, middle(b))).then(a.cmp(&b)));
        let (mut taken, mut want) = (Vec::new(), district.share * total);
        while want > 0.0 && !left.is_empty() {
            let i = left.remove(0);
            want -= grounds[i].area_m2;
            taken.push(i);
        }
        if n + 1 == list.len() {
            taken.append(&mut left);
        }
        let area: f64 = taken.iter().map(|&i| grounds[i].area_m2).sum();
        let sum: DVec2 = taken.iter().map(|&i| middle(i) * grounds[i].area_m2).sum();
        // The middle of a ring lies outside it: the block nearest to it stands for it.
        let mean = sum / area.max(1.0);
        let near = taken.iter().map(|&i| middle(i)).min_by(|a, b| a.distance(mean).total_cmp(&b.distance(mean)));
        if let Some(near) = near {
            out.push((district.name.clone(), near));
        }
        for i in taken {
            grounds[i].block.district.clone_from(&district.style);
        }
    }
    out
}

/// The lower, the sooner a district of a part takes a spot.
fn rank(town: &Town, part: Part, p: DVec2) -> f64 {
    let share = town.shape.share(p);
    match part {
        Part::Centre => share,
        Part::Ring => (share - 0.5).abs(),
        Part::Edge => -share,
        Part::North => -p.y,
        Part::East => -p.x,
        Part::South => p.y,
        Part::West => p.x,
    }
}

/// Length and direction of the longer extent of an outline.
pub(super) fn lie_of(outline: &[DVec2]) -> (DVec2, f64) {
    let (dir, (low, high)) = grain::long_axis(outline);
    (dir, high - low)
}
