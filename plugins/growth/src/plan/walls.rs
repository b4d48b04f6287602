//! Walls: what each faces, its axes, storeys and openings.

use rayon::prelude::*;
use veduta_city::{
    GridPolygon, GridPos, House, Opening, Palette, PlanRoof, PlanTerrain, Storey, Style, Volume, Wall, WallKind, metres,
};

use super::facing::{BodyRef, Edge, Facing, Party};
use super::floors::{before_bay, threshold};
use super::houses::{Body, Draft, StyleBook};
use super::index::{Cells, Index};
use super::massing::{self, Mass};
use super::variety::{Look, bays};
use veduta_city::bounds::grown;

/// A neighbour that covers more than this share of a wall's length and height makes it a party wall.
const PARTY_SHARE: f64 = 0.5;
/// Storeys lower than this have attic windows; metres.
const ATTIC_M: f64 = 2.6;
/// Height of a low top storey or a mezzanine as a share of the others'.
const LOW_STOREY: f64 = 0.68;
/// Least height of a storey; metres.
const LEAST_STOREY_M: f64 = 2.0;
/// Bodies whose foot is higher than this have no doors; grid steps.
pub(super) const DOORSTEP: i32 = 512;
/// Windows begin so high above the floor; a bay where the ground rises above has none. Metres.
pub(super) const SILL_M: f64 = 0.8;
/// Shops have the ground before them between these heights above their floor, metres.
const BEFORE_SHOPS_M: core::ops::RangeInclusive<f64> = -0.45..=0.3;
/// A door stands where it was drawn, unless the ground suits it better elsewhere by more than this; metres.
const DOOR_CHOICE_M: f64 = 0.12;
/// Ground floors lower than this have no shops; metres.
const LEAST_SHOP_M: f64 = 2.6;

/// Drafts that become houses together.
const AT_ONCE: usize = 8192;

/// All houses, with walls, in the order of the drafts. These go piece by piece as their houses come: there is never all of both.
pub(super) fn houses(
    drafts: Vec<Draft>,
    facing: &Facing,
    masses: &[Vec<Mass>],
    looks: &[Look],
    book: &StyleBook<'_>,
    terrain: &PlanTerrain,
) -> Vec<House> {
    let of_house = |(h, mut draft): (usize, Draft)| {
        let (look, style) = (&looks[h], book.style(draft.style));
        let mut volumes: Vec<Volume> = Vec::with_capacity(draft.bodies.len());
        let mut edges: Vec<Vec<Edge>> = Vec::with_capacity(draft.bodies.len());
        for b in 0..draft.bodies.len() {
            let footprint = core::mem::take(&mut draft.bodies[b].footprint);
            edges.push(facing.of_body((h, b), &footprint).collect());
            volumes.push(Volume { footprint, ..volume(&draft, (h, b), &edges[b], masses, look, style) });
        }
        let mut floor = masses[h].first().map_or(0, |mass| mass.floor);
        floor += add_ground_floor(&mut volumes, &edges, &masses[h], &draft, look, style, &Slope { terrain, floor });
        if !terrain.is_level() {
            suit_ground(&mut volumes, &edges, &masses[h], &Slope { terrain, floor });
        }
        House { id: draft.id, name: draft.name, number: draft.number, style: draft.style as u16, floor, volumes, monument: None }
    };
    let count = drafts.len();
    let mut drafts = drafts.into_iter().enumerate();
    let pieces: Vec<Vec<(usize, Draft)>> = (0..count.div_ceil(AT_ONCE)).map(|_| drafts.by_ref().take(AT_ONCE).collect()).collect();
    drop(drafts);
    let mut houses = Vec::with_capacity(count);
    pieces.into_iter().for_each(|piece| houses.par_extend(piece.into_par_iter().map(of_house)));
    houses
}

/// A volume without its footprint.
fn volume(draft: &Draft, at: BodyRef, edges: &[Edge], masses: &[Vec<Mass>], look: &Look, style: &Style) -> Volume {
    let (body, mass) = (&draft.bodies[at.1], masses[at.0][at.1]);
    let tiers = tiers(body, &mass, style, draft, at.1);
    let wall = |edge: &Edge| {
        let kind = kind(edge, &mass, masses);
        if kind == WallKind::Party {
            return Wall { kind, ..Wall::default() };
        }
        let storeys = storeys(&tiers, kind, &mass, body, look);
        let is_blind = storeys.iter().all(|s| s.opening == Opening::Blank) && look.door == Opening::Blank;
        let wish = if kind == WallKind::Yard { look.bay_m * 1.25 } else { look.bay_m };
        let bays = if is_blind { 0 } else { bays(edge.length_m(), wish) };
        Wall { kind, bays, storeys, ..Wall::default() }
    };
    let colour = body.colour.map_or_else(|| look.painted(), Palette::bounded);
    let roof = body.roof.colour.map_or_else(|| Palette::tinted(look.roof, look.tint), Palette::bounded);
    Volume {
        footprint: GridPolygon::default(),
        bottom: mass.bottom,
        eaves: mass.eaves,
        colour,
        trim: style.palette().trim(colour),
        roof: PlanRoof { colour: roof, ..mass.roof },
        gable: look.gable,
        walls: edges.iter().map(wall).collect(),
        arcades: Vec::new(),
    }
}

/// What a wall faces: a neighbour if others cover most of it, in length and in height.
fn kind(edge: &Edge, mine: &Mass, masses: &[Vec<Mass>]) -> WallKind {
    let height = massing::wall_m(mine).max(0.1);
    let share = |party: &Party| {
        let (house, body) = party.body();
        let other = masses.get(house)?.get(body)?;
        let common = metres(mine.eaves.min(other.eaves) - mine.bottom.max(other.bottom)).max(0.0);
        Some(party.share * (common / height).min(1.0))
    };
    let covered: f64 = edge.parties.iter().filter_map(share).sum();
    match (covered > PARTY_SHARE, edge.is_public) {
        (true, _) => WallKind::Party,
        (false, true) => WallKind::Street,
        (false, false) => WallKind::Yard,
    }
}

/// A body's storeys.
struct Tiers {
    /// Heights from its foot, grid steps: they fill the wall exactly.
    heights: Vec<i32>,
    /// The storey behind the finest windows: the first, or the one over a mezzanine.
    main: usize,
}

fn tiers(body: &Body, mass: &Mass, style: &Style, draft: &Draft, index: usize) -> Tiers {
    let draw = draft.draw.part(index as u64);
    let (ground, upper) = massing::storey_heights(style, draw);
    let whole = massing::wall_m(mass);
    let ground = if mass.hangs() { upper } else { ground };
    let fitting = if whole < ground + 0.5 * upper { 1.0 } else { 1.0 + libm::round((whole - ground) / upper) };
    let told = body.levels.filter(|_| !mass.hangs()).map(libm::round);
    let n = told.unwrap_or(fitting).clamp(1.0, libm::floor(whole / LEAST_STOREY_M).clamp(1.0, 250.0)) as usize;
    let mut weights = vec![upper; n];
    weights[0] = ground;
    // Now and then the top storey is a low one under the eaves.
    if n >= 3 && upper < 5.0 && draw.chance("low top storey", 0.35) {
        weights[n - 1] = upper * LOW_STOREY;
    }
    let has_mezzanine = n >= 4 && !mass.hangs() && draw.chance("mezzanine", style.mezzanines);
    if has_mezzanine {
        weights[1] = upper * LOW_STOREY;
    }
    Tiers { heights: fill(mass.eaves - mass.bottom, &weights), main: 1 + usize::from(has_mezzanine) }
}

/// Cuts a length into parts by weight, those of one weight alike, at whole steps of heights; the first has the rest.
fn fill(length: i32, weights: &[f64]) -> Vec<i32> {
    let (sum, step) = (weights.iter().sum::<f64>(), f64::from(massing::HEIGHT_STEP));
    let part = |weight: &f64| (libm::round(f64::from(length) * weight / sum / step) * step) as i32;
    let mut parts: Vec<i32> = weights.iter().map(part).collect();
    let upper: i32 = parts.iter().skip(1).sum();
    if let Some(first) = parts.first_mut() {
        *first = length - upper;
    }
    parts
}

fn storeys(tiers: &Tiers, kind: WallKind, mass: &Mass, body: &Body, look: &Look) -> Vec<Storey> {
    let Tiers { heights, main } = tiers;
    let last = heights.len() - 1;
    let hangs = mass.hangs();
    let opening = |i: usize, height: i32| {
        if let Some(given) = body.opening {
            return given;
        }
        let is_tower = look.upper == Opening::Slit;
        if is_tower && i == last && last >= 2 && !body.is_covered {
            return Opening::Belfry;
        }
        let drawn = match i {
            0 if !hangs => look.ground,
            i if i == *main && kind == WallKind::Street && !hangs => look.main,
            _ => look.upper,
        };
        let is_low = i == last && last > 0 && metres(height) < ATTIC_M || (1..*main).contains(&i);
        match drawn {
            Opening::Blank | Opening::Slit | Opening::Clock | Opening::LancetWindow => drawn,
            _ if is_low => Opening::AtticWindow,
            Opening::WideWindow | Opening::ArchedWindow => drawn,
            _ if kind == WallKind::Yard => Opening::Window,
            _ => drawn,
        }
    };
    heights.iter().enumerate().map(|(i, &height)| Storey { height, opening: opening(i, height) }).collect()
}

/// One door a house, on its longest street wall, else on its longest wall to a yard; shops on street walls. Raises the house so that
/// its door opens onto the ground before it, and tells by how much.
fn add_ground_floor(
    volumes: &mut [Volume],
    edges: &[Vec<Edge>],
    masses: &[Mass],
    draft: &Draft,
    look: &Look,
    style: &Style,
    slope: &Slope<'_>,
) -> i32 {
    let shopkeeper = style.shops > 0.0 && draft.draw.chance("shops", (style.shops * 1.6).min(1.0));
    let mut best: Option<(WallKind, f64, usize, usize)> = None;
    for (v, volume) in volumes.iter_mut().enumerate().filter(|(v, _)| !masses[*v].hangs()) {
        for (w, wall) in volume.walls.iter_mut().enumerate().filter(|(_, wall)| wall.bays > 0) {
            let length = edges[v][w].length_m();
            // Street before yard, then the longer; of equals the first.
            let rank = (wall.kind == WallKind::Street, length);
            if best.is_none_or(|(kind, longest, ..)| rank > (kind == WallKind::Street, longest)) {
                best = Some((wall.kind, length, v, w));
            }
            let is_high = wall.storeys.first().is_some_and(|s| metres(s.height) >= LEAST_SHOP_M);
            if shopkeeper && wall.kind == WallKind::Street && is_high {
                let draw = draft.draw.part(v as u64).part(w as u64);
                let is_shop = |bay: &u8| draw.part(u64::from(*bay)).chance("shop", 0.65);
                wall.ground_floor.shops = (0..wall.bays.min(32)).filter(is_shop).fold(0, |bits, bay| bits | 1 << bay);
            }
        }
    }
    let Some((kind, length, v, w)) = best else { return 0 };
    let wall = &mut volumes[v].walls[w];
    let before = slope.before(&edges[v][w], wall.bays);
    put_door(wall, kind, length, draft, look, &before);
    let at_door = wall.ground_floor.door_bay.and_then(|bay| before.get(usize::from(bay)));
    let rise = at_door.map_or(0, |&ground| threshold(ground));
    for volume in volumes {
        volume.bottom = volume.bottom.saturating_add(rise);
        volume.eaves = volume.eaves.saturating_add(rise);
    }
    rise
}

/// The ground about a house.
struct Slope<'a> {
    terrain: &'a PlanTerrain,
    /// Of the house, grid steps above the city's zero.
    floor: i32,
}

impl Slope<'_> {
    /// Lowest and highest ground before each bay of a wall above the floor, metres; none where the ground is level.
    fn before(&self, edge: &Edge, bays: u8) -> Vec<(f64, f64)> {
        if self.terrain.is_level() {
            return Vec::new();
        }
        (0..bays).map(|bay| before_bay(self.terrain, metres(self.floor), (edge.a(), edge.b()), bay, bays)).collect()
    }
}

/// Leaves out windows and shops where the ground before them is too high (above the ground floor in a whole storey of a wall), and shops
/// where it is too low.
fn suit_ground(volumes: &mut [Volume], edges: &[Vec<Edge>], masses: &[Mass], slope: &Slope<'_>) {
    let on_ground = volumes.iter_mut().zip(edges).zip(masses).filter(|(_, mass)| !mass.hangs());
    for (wall, edge) in on_ground.flat_map(|((volume, edges), _)| volume.walls.iter_mut().zip(edges)) {
        let highest = slope.terrain.range_along(edge.a(), edge.b()).1 - metres(slope.floor);
        let mut base = wall.storeys.first().map_or(0, |storey| storey.height);
        for storey in wall.storeys.iter_mut().skip(1) {
            if highest > metres(base) + SILL_M {
                storey.opening = Opening::Blank;
            }
            base += storey.height;
        }
        let (before, floor) = (slope.before(edge, wall.bays), &mut wall.ground_floor);
        for (bay, (low, high)) in (0..32_u8).zip(before).filter(|(bay, _)| floor.door_bay != Some(*bay)) {
            if high > SILL_M {
                floor.blank |= 1 << bay;
            }
            if !BEFORE_SHOPS_M.contains(&low) || !BEFORE_SHOPS_M.contains(&high) {
                floor.shops &= !(1 << bay);
            }
        }
    }
}

fn put_door(wall: &mut Wall, kind: WallKind, length_m: f64, draft: &Draft, look: &Look, before: &[(f64, f64)]) {
    let bay_m = length_m / f64::from(wall.bays.max(1));
    let door = match look.door {
        Opening::Blank => return,
        _ if kind == WallKind::Yard || bay_m < 2.0 => Opening::Door,
        Opening::Gate if bay_m < 2.8 => Opening::Portal,
        other => other,
    };
    let (last, middle) = (wall.bays - 1, wall.bays / 2);
    let bay = match draft.draw.below("door bay", 4) {
        0 => 0,
        1 => last,
        _ => middle,
    };
    // Ground above the threshold is worse than steps up to it.
    let unfit = |bay: u8| before.get(usize::from(bay)).map_or(0.0, |&(low, high)| 4.0 * high.max(0.0) - low.min(0.0));
    let fittest = (0..wall.bays).min_by(|&a, &b| unfit(a).total_cmp(&unfit(b))).unwrap_or(bay);
    let bay = if unfit(bay) <= unfit(fittest) + DOOR_CHOICE_M { bay } else { fittest };
    wall.ground_floor.door_bay = Some(bay);
    wall.ground_floor.door = door;
    if bay < 32 {
        wall.ground_floor.shops &= !(1 << bay);
    }
}

/// Volumes, each with how far its foot hangs above its house's floor, metres: for questions about places.
pub(super) type Standing = Index<f64>;

/// An index of all volumes, in the cells of the bodies they were built on: of houses as they were built, before monuments take their place.
pub(super) fn standing(houses: &[House], cells: Cells) -> Standing {
    let volumes = houses.iter().flat_map(|house| house.volumes.iter().map(move |volume| (volume, house.floor)));
    let hangs_m = |(volume, floor): (&Volume, i32)| (volume.footprint.clone(), metres(volume.bottom.saturating_sub(floor)));
    Index::over(cells, volumes.map(hangs_m).collect())
}

/// The middles of all doors' thresholds.
pub(super) fn doorsteps(houses: &[House]) -> Doorsteps {
    let mut out = Vec::new();
    for volume in houses.iter().flat_map(|h| &h.volumes) {
        let edges = volume.footprint.edges();
        for (wall, (a, b)) in volume.walls.iter().zip(edges) {
            if let Some(bay) = wall.ground_floor.door_bay {
                let t = (f64::from(bay) + 0.5) / f64::from(wall.bays.max(1));
                out.push(GridPos::from_metres(a.to_metres().lerp(b.to_metres(), t)));
            }
        }
    }
    out.sort_unstable();
    Doorsteps(out)
}

/// Where the doors are, from west to east.
pub(super) struct Doorsteps(Vec<GridPos>);

impl Doorsteps {
    /// Whether one lies within a distance of a position along each axis.
    pub fn is_near(&self, pos: GridPos, reach_m: f64) -> bool {
        let (low, high) = grown((pos, pos), GridPos::steps(reach_m));
        let first = self.0.partition_point(|door| door.0 < low.0);
        self.0[first..].iter().take_while(|door| door.0 <= high.0).any(|door| (low.1..=high.1).contains(&door.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doors_are_near_within_a_square() {
        let at = |x: i32, y: i32| GridPos(x * 1024, y * 1024);
        let doorsteps = Doorsteps(vec![at(0, 0), at(3, 50), at(3, 90), at(9, 0)]);
        for (pos, reach_m, is_near) in [
            (at(4, 1), 3.9, false),
            (at(4, 1), 4.0, true),
            (at(4, 52), 1.9, false),
            (at(4, 52), 2.0, true),
            (at(3, 70), 19.9, false),
            (at(12, -2), 3.0, true),
            (at(13, -2), 3.0, false),
        ] {
            assert_eq!(doorsteps.is_near(pos, reach_m), is_near, "{pos:?} {reach_m}");
        }
    }

    #[test]
    fn parts_fill_a_length_exactly() {
        let parts = fill(14_337, &[4.2, 3.3, 3.3, 2.2]);
        assert_eq!(parts.iter().sum::<i32>(), 14_337);
        assert!(parts[0] > parts[1] && parts[1] > parts[3]);
        assert!((parts[1] - parts[2]).abs() <= 1);
    }
}
