//! What stands in streets, squares, parks and yards by rule, where a map does not say.

use glam::DVec2;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use veduta_city::draw::Draw;
use veduta_city::furniture::{AreaKind, Control, Offset, Placement, Side};
use veduta_city::{
    BlockKind, CityGraph, Furnishing, FurnitureRule, GridPolygon, GridPos, Id, Link, LinkKind, ObjectKind, Range, StreetClass,
    SurfaceKind, ring_edges,
};

use super::network::Network;
use super::objects::{Site, compass};
use super::{Area, outline, streets, walks};

/// Furniture keeps this far from doors beyond its own clearance, metres.
const DOOR_CLEAR_M: f64 = 1.3;
/// People pass between two things that stand so far apart, metres.
const PASSAGE_M: f64 = 0.5;
/// Furniture along a street is tried so far along from where it should stand, where something is in the way; metres.
const ASIDE_M: [f64; 3] = [0.0, 2.2, -2.2];
/// … and so much nearer to the middle of the street.
const INWARD_M: [f64; 4] = [0.0, 0.4, 0.8, 1.2];
/// Where it is looked whether a walk leads past what stands in a ring: so far behind it, metres.
const BEHIND_M: f64 = 3.0;
/// Most places that a rule has along one line or in one area.
const MOST_PLACES: usize = 50_000;
/// How far trees, lamps and other things reach, and how high, metres.
const TREE_M: (f64, f64) = (3.0, 17.0);
const LAMP_M: (f64, f64) = (0.3, 4.5);
const PIECE_M: (f64, f64) = (0.3, 3.5);

/// Something that a rule would put, and its heading.
pub(super) struct Wish {
    pos: DVec2,
    heading_deg: f64,
}

/// Something that is to stand at a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece<'a> {
    pub id: Id,
    pub kind: ObjectKind,
    pub pos: DVec2,
    pub heading_deg: f64,
    /// 0: its own, metres.
    pub height_m: f64,
    /// Name of what is built there; may be empty.
    pub monument: &'a str,
}

/// What rules put, in their order, clear of what stands already.
pub(super) struct Furnisher<'a> {
    pub graph: &'a CityGraph,
    pub areas: &'a [Area<'a>],
    pub network: &'a Network<'a>,
    pub site: &'a Site<'a>,
    pub taken: Taken,
}

/// The ground that things stand on: a disc each.
#[derive(Default)]
pub(super) struct Taken {
    discs: Vec<Disc>,
    /// The last one in each square.
    last: FxHashMap<(i32, i32), u32>,
}

struct Disc {
    middle: DVec2,
    /// The one before it in the same square; itself if there is none.
    before: u32,
    /// What stands there, which tells its radius.
    kind: ObjectKind,
}

impl Taken {
    /// Side of the squares in which they are looked for: two of the widest reach no farther; metres.
    const SIDE_M: f64 = 6.0;

    fn square(pos: DVec2) -> (i32, i32) {
        let at = (pos / Self::SIDE_M).floor();
        (at.x as i32, at.y as i32)
    }

    fn is_free(&self, pos: DVec2, radius_m: f64) -> bool {
        let (x, y) = Self::square(pos);
        let last = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).filter_map(move |y| self.last.get(&(x, y)).copied()));
        let before = |&at: &u32| Some(self.discs[at as usize].before).filter(|&before| before != at);
        let mut near = last.flat_map(|last| core::iter::successors(Some(last), before)).map(|at| &self.discs[at as usize]);
        near.all(|other| other.middle.distance(pos) >= other.kind.radius_m() + radius_m)
    }

    /// Takes what something of a kind stands on.
    pub fn add(&mut self, middle: DVec2, kind: ObjectKind) {
        let own = self.discs.len() as u32;
        let before = self.last.insert(Self::square(middle), own).unwrap_or(own);
        self.discs.push(Disc { middle, before, kind });
    }
}

impl Furnisher<'_> {
    /// What a rule would put, in order.
    pub fn wishes(&self, rule: &FurnitureRule) -> impl Iterator<Item = Wish> + use<> {
        let wishes = match &rule.place {
            _ if rule.put.is_empty() => Vec::new(),
            Placement::Along { streets, every_m, side, at } => self.along(rule, streets, *every_m, *side, *at),
            Placement::Crossings { control, inset_m } => vec![self.crossings(rule, *control, *inset_m)],
            Placement::Rim { of, every_m, inset_m, rows_m } => vec![self.rim(rule, *of, *every_m, *inset_m, *rows_m)],
            Placement::Scatter { of, every_m } => self.scatter(rule, *of, *every_m),
            Placement::Middle { of, least_m, ring } => vec![self.middle(rule, *of, *least_m, *ring)],
        };
        wishes.into_iter().flatten()
    }

    /// What a rule puts, as far as there is room for it.
    pub fn granted<'a>(&mut self, rule: &'a FurnitureRule, wishes: impl Iterator<Item = Wish>) -> Vec<Piece<'a>> {
        let mut out = Vec::new();
        for wish in wishes {
            let id = Id::from_place(&format!("grown {}", rule.name), wish.pos);
            let draw = Draw::new(self.graph.seed, id, "furniture");
            let Some(furnishing) = drawn(&rule.put, self.graph.anchor.lat, draw) else { continue };
            let (reach_m, top_m) = match furnishing.kind {
                kind if kind.is_tree() => TREE_M,
                ObjectKind::Lamp => LAMP_M,
                _ => PIECE_M,
            };
            let is_on_bridge = || furnishing.kind.is_tree() && self.site.deck(wish.pos).is_some();
            if is_on_bridge() || self.site.meets_span(wish.pos, reach_m, top_m) {
                continue;
            }
            let radius = furnishing.kind.radius_m();
            if !self.taken.is_free(wish.pos, radius + PASSAGE_M * f64::from(!is_row(&rule.place))) {
                continue;
            }
            self.taken.add(wish.pos, furnishing.kind);
            out.push(Piece {
                id,
                kind: furnishing.kind,
                pos: wish.pos,
                heading_deg: wish.heading_deg,
                height_m: furnishing.height_m.map_or(0.0, |Range(low, high)| draw.between("height", low, high)),
                monument: &furnishing.monument,
            });
        }
        out
    }

    fn chance(&self, rule: &FurnitureRule, place: DVec2) -> bool {
        rule.chance >= 1.0 || self.draw(rule, place).chance("chance", rule.chance)
    }

    /// The draw of one of a rule's places.
    fn draw(&self, rule: &FurnitureRule, place: DVec2) -> Draw {
        Draw::new(self.graph.seed, Id::from_place(&rule.name, place), "furniture rule")
    }

    /// What a rule wishes for along each link.
    fn along(&self, rule: &FurnitureRule, classes: &[StreetClass], every_m: f64, side: Side, at: Offset) -> Vec<Vec<Wish>> {
        let nodes = self.graph.node_positions();
        let taken: FxHashMap<Id, [f64; 2]> = self.network.streets.iter().map(|street| (street.link.id, street.taken_m)).collect();
        let of_link = |link: &Link| -> Vec<Wish> {
            let LinkKind::Street(class) = link.kind else { return Vec::new() };
            let (width, pavement) = (streets::width_m(link), streets::pavement_m(class, streets::width_m(link)));
            let offset = match at {
                Offset::Edge(inset) => width / 2.0 - inset,
                Offset::Kerb(out) if pavement > out => width / 2.0 - pavement + out,
                Offset::Kerb(_) => return Vec::new(),
            };
            if link.layer < 0 || !classes.contains(&class) || offset < 0.5 {
                return Vec::new();
            }
            let line = self.graph.polyline(link, &nodes).unwrap_or_default();
            let length = streets::length_m(&line);
            let count = (length / every_m) as usize;
            let [first, last] = taken.get(&link.id).copied().unwrap_or_default();
            let free = first..length - last;
            let mut out = Vec::new();
            for i in 0..count.min(MOST_PLACES) {
                let s = (i as f64 + 0.5) * every_m;
                let Some((p, way)) = streets::along(&line, s).filter(|_| free.contains(&s)) else { continue };
                let sides: &[f64] = match side {
                    Side::Both => &[1.0, -1.0],
                    Side::Alternating if i % 2 == 0 => &[1.0],
                    Side::Alternating => &[-1.0],
                };
                for out_way in sides.iter().map(|side| way.perp() * *side) {
                    if !self.chance(rule, p + out_way * offset) {
                        continue;
                    }
                    let tries = ASIDE_M.into_iter().flat_map(|s| INWARD_M.map(|o| p + way * s + out_way * (offset - o).max(0.3)));
                    let stand = tries.into_iter().find(|&q| self.may_stand(q, rule.clear_m));
                    out.extend(stand.map(|pos| Wish { pos, heading_deg: heading_deg(-out_way) }));
                }
            }
            out
        };
        self.graph.links.par_iter().map(of_link).collect()
    }

    fn crossings(&self, rule: &FurnitureRule, control: Control, inset_m: f64) -> Vec<Wish> {
        let mut out = Vec::new();
        for junction in self.network.junctions.iter().filter(|junction| junction.control == Some(control)) {
            for (arm, stop) in junction.arms.iter().filter_map(|arm| Some((arm, arm.stop_m?))) {
                let street = &self.network.streets[arm.end.street];
                let Some((p, way)) = street.way(arm.end.is_start, stop) else { continue };
                let pos = p + way.perp() * (arm.half_m + inset_m);
                if self.chance(rule, pos) && self.may_stand(pos, rule.clear_m) {
                    out.push(Wish { pos, heading_deg: heading_deg(way) });
                }
            }
        }
        out
    }

    /// Outlines of all areas of a kind.
    fn outlines(&self, of: AreaKind) -> Vec<GridPolygon> {
        let blocks = |kind: BlockKind| {
            let areas = self.areas.iter().filter(move |area| area.block.kind == kind);
            areas.flat_map(|area| area.polygons.iter().cloned()).collect()
        };
        match of {
            AreaKind::Squares => self.graph.squares.iter().flat_map(|s| outline::polygons(&s.outline, &s.holes)).collect(),
            AreaKind::Parks => blocks(BlockKind::Park),
            AreaKind::Yards => blocks(BlockKind::Built),
        }
    }

    fn rim(&self, rule: &FurnitureRule, of: AreaKind, every_m: f64, inset_m: f64, rows_m: Option<(f64, f64)>) -> Vec<Wish> {
        let mut out = Vec::new();
        let outlines = self.outlines(of);
        for ring in outlines.iter().flat_map(GridPolygon::rings) {
            // How far round the ring the next place is from where an edge begins: rows and gaps run on round its corners.
            let (mut gone, mut next) = (0.0, every_m / 2.0);
            let most = out.len() + MOST_PLACES;
            for (a, b) in ring_edges(ring) {
                let (a, b) = (a.to_metres(), b.to_metres());
                let Some(way) = (b - a).try_normalize() else { continue };
                let (length, inward) = (a.distance(b), way.perp());
                while next < length && out.len() < most {
                    let is_gap = rows_m.is_some_and(|(row, gap)| (gone + next) % (row + gap) > row);
                    let pos = a + way * next + inward * inset_m;
                    if !is_gap && self.chance(rule, pos) && self.is_of(of, pos, rule.clear_m) {
                        out.push(Wish { pos, heading_deg: heading_deg(inward) });
                    }
                    next += every_m;
                }
                gone += length;
                next -= length;
            }
        }
        out
    }

    fn middle(&self, rule: &FurnitureRule, of: AreaKind, least_m: f64, ring: Option<(u8, f64)>) -> Vec<Wish> {
        let mut out = Vec::new();
        for (middle, _) in self.outlines(of).iter().filter_map(walks::heart).filter(|disc| disc.1 >= least_m) {
            if !self.chance(rule, middle) {
                continue;
            }
            let Some((count, radius_m)) = ring else {
                out.extend(self.is_open(middle, rule.clear_m).then_some(Wish { pos: middle, heading_deg: 180.0 }));
                continue;
            };
            // Between two of the ways that lead in, if any does.
            let first = self.draw(rule, middle).between("first", 0.0, 360.0);
            for i in 0..count {
                let way = compass(first + 360.0 * f64::from(i) / f64::from(count));
                let (pos, behind) = (middle + way * radius_m, middle + way * (radius_m + BEHIND_M));
                let is_on_walk = self.surface(behind) == Some(SurfaceKind::Gravel);
                if !is_on_walk && self.is_open(pos, rule.clear_m) {
                    out.push(Wish { pos, heading_deg: heading_deg(-way) });
                }
            }
        }
        out
    }

    /// Whether a place is open ground, though not a carriageway, in no doorway and clear of houses.
    fn is_open(&self, pos: DVec2, clear_m: f64) -> bool {
        let is_ground = !matches!(self.surface(pos), None | Some(SurfaceKind::Water | SurfaceKind::Ballast | SurfaceKind::Opening));
        is_ground && self.is_out_of_the_way(pos, clear_m)
    }

    /// Whether a place is not on a carriageway, in no doorway and clear of houses.
    fn is_out_of_the_way(&self, pos: DVec2, clear_m: f64) -> bool {
        let here = GridPos::from_metres(pos);
        let on_carriageway = || self.network.carriageways.at(here).next().is_some();
        let in_doorway = || self.site.doorsteps.is_near(here, DOOR_CLEAR_M + clear_m);
        !on_carriageway() && !in_doorway() && self.site.is_free_about(pos, clear_m)
    }

    /// What lies at a place, bridges aside.
    fn surface(&self, pos: DVec2) -> Option<SurfaceKind> {
        self.site.surface(pos).map(|(surface, _)| surface)
    }

    /// What a rule wishes for in each area.
    fn scatter(&self, rule: &FurnitureRule, of: AreaKind, every_m: f64) -> Vec<Vec<Wish>> {
        let of_polygon = |polygon: &GridPolygon| {
            let mut out = Vec::new();
            let Some((lo, hi)) = polygon.bounds() else { return out };
            let (lo, hi) = ((lo.to_metres() / every_m).floor(), (hi.to_metres() / every_m).ceil());
            if (hi - lo).x * (hi - lo).y > 4.0 * MOST_PLACES as f64 {
                return out;
            }
            for (i, j) in (lo.y as i64..hi.y as i64).flat_map(|j| (lo.x as i64..hi.x as i64).map(move |i| (i, j))) {
                let corner = DVec2::new(i as f64, j as f64) * every_m;
                let draw = self.draw(rule, corner + 0.25);
                if !draw.chance("chance", rule.chance) {
                    continue;
                }
                let pos = corner + every_m * DVec2::new(draw.between("x", 0.15, 0.85), draw.between("y", 0.15, 0.85));
                if polygon.contains(GridPos::from_metres(pos)) && self.is_of(of, pos, rule.clear_m) {
                    out.push(Wish { pos, heading_deg: draw.between("heading", 0.0, 360.0) });
                }
            }
            out
        };
        self.outlines(of).par_iter().map(of_polygon).collect()
    }

    /// Whether something may stand at a place of an area, by what lies there.
    fn is_of(&self, of: AreaKind, pos: DVec2, clear_m: f64) -> bool {
        let is_soil = |soil: SurfaceKind| self.surface(pos) == Some(soil);
        match of {
            AreaKind::Squares => self.may_stand(pos, clear_m),
            AreaKind::Parks => is_soil(SurfaceKind::Grass) && self.site.is_free_about(pos, clear_m),
            AreaKind::Yards => is_soil(SurfaceKind::Yard) && self.site.is_free_about(pos, clear_m),
        }
    }

    /// Whether something may stand in the street: on public ground, not on a carriageway, in no doorway, clear of houses.
    fn may_stand(&self, pos: DVec2, clear_m: f64) -> bool {
        let on_bridge = || self.site.deck(pos).map(|(surface, _)| surface);
        let surface = on_bridge().or_else(|| self.surface(pos));
        let is_public = surface.is_some_and(SurfaceKind::is_public);
        is_public && self.is_out_of_the_way(pos, clear_m)
    }
}

/// Whether what a rule puts is meant to stand close.
const fn is_row(place: &Placement) -> bool {
    matches!(place, Placement::Rim { rows_m: Some(_), .. })
}

/// One of those that are put at a latitude, by share.
fn drawn(put: &[Furnishing], lat_deg: f64, draw: Draw) -> Option<&Furnishing> {
    let here = || put.iter().filter(|one| one.lat_deg.is_none_or(|Range(low, high)| (low..=high).contains(&lat_deg.abs())));
    let sum: f64 = here().map(|one| one.share).sum();
    let mut left = draw.between("which", 0.0, sum);
    let chosen = here().find(|one| {
        left -= one.share;
        left < 0.0
    });
    chosen.or_else(|| here().next_back())
}

/// Degrees clockwise from north.
fn heading_deg(way: DVec2) -> f64 {
    libm::atan2(way.x, way.y).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_free_where_it_touches_no_other() {
        let mut taken = Taken::default();
        let mut discs: Vec<(DVec2, ObjectKind)> = Vec::new();
        let kinds = [ObjectKind::Bin, ObjectKind::Tree, ObjectKind::Kiosk, ObjectKind::Fountain];
        for i in 0..3000_u64 {
            let draw = Draw::new(7, Id(i), "disc");
            // Negative places and sides of squares among them.
            let pos = DVec2::new(draw.between("x", -40.0, 40.0).round(), draw.between("y", -40.0, 40.0));
            let kind = *draw.pick("kind", &kinds).expect("kinds");
            let radius = kind.radius_m();
            let is_free = discs.iter().all(|&(other, kind)| other.distance(pos) >= kind.radius_m() + radius);
            assert_eq!(taken.is_free(pos, radius), is_free, "{pos} {radius}");
            if is_free || draw.chance("anyhow", 0.02) {
                taken.add(pos, kind);
                discs.push((pos, kind));
            }
        }
        assert!(discs.len() > 200, "{}", discs.len());
    }
}
