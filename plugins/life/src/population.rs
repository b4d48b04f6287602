//! Who lives in the open city: what is told, and what follows by rule.

use std::collections::{BTreeMap, HashMap};

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{CellShell, GridPos, Id, Jet, LifeKind, LifeRules, LivingThing, ObjectKind, Place, PlaceKind};
use veduta_ecs::{CellReleased, CellStands, City, OpenCity, StandingCells, WorldOrigin};
use veduta_growth::mesh::chimney_tops;

use crate::asset::CityLife;

/// Something that lives, where it was found to be.
#[derive(Debug, Clone)]
pub(crate) struct Dweller {
    pub id: Id,
    /// What it is told of by, empty if rules tell of it.
    pub name: String,
    pub plan_pos: DVec2,
    pub height_m: f64,
    pub heading_deg: f64,
    pub kind: LifeKind,
}

/// A chimney that may smoke.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chimney {
    /// World position.
    pub top: Vec3,
    pub plan_pos: DVec2,
    pub draw: Draw,
    pub strength: f64,
    pub always: bool,
}

/// All that lives in the open city.
#[derive(Resource, Debug, Default)]
pub(crate) struct Population {
    /// What is told, with what rules say of the whole city.
    pub told: Vec<Dweller>,
    /// What rules say of each cell that stands.
    pub by_cell: BTreeMap<u32, Vec<Dweller>>,
    /// Chimneys of each cell that stands.
    pub chimneys: BTreeMap<u32, Vec<Chimney>>,
    /// Grows with every change.
    pub version: u64,
}

/// A square of which nothing is told has pigeons where no told flock is so near, metres.
const APART_M: f64 = 45.0;
/// How far pigeons walk about the middle of a square, metres.
const SQUARE_M: f64 = 17.0;
/// A fountain that is told of is the one that stands so near, metres.
const SAME_M: f64 = 3.5;

impl Population {
    pub(crate) fn dwellers(&self) -> impl Iterator<Item = &Dweller> {
        self.told.iter().chain(self.by_cell.values().flatten())
    }

    fn has_near(&self, plan_pos: DVec2, within_m: f64, is_alike: impl Fn(&LifeKind) -> bool) -> bool {
        self.told.iter().any(|other| is_alike(&other.kind) && other.plan_pos.distance(plan_pos) < within_m)
    }

    fn settle(&mut self, things: &[LivingThing], rules: &LifeRules, places: &[&Place]) {
        let by_name: HashMap<&str, DVec2> = places.iter().map(|place| (place.name.as_str(), place.pos)).collect();
        self.told = things
            .iter()
            .filter_map(|thing| {
                let plan_pos = thing.plan_pos(|name| by_name.get(name).copied())?;
                let LivingThing { name, height_m, heading_deg, kind, .. } = thing.clone();
                Some(Dweller { id: Id::from_place(&name, plan_pos), name, plan_pos, height_m, heading_deg, kind })
            })
            .collect();
        if rules.pigeons == 0 {
            return;
        }
        for place in places.iter().filter(|place| place.kind == PlaceKind::Square) {
            if self.has_near(place.pos, APART_M, |kind| matches!(kind, LifeKind::Flock { .. })) {
                continue;
            }
            let kind = LifeKind::Flock { radius_m: SQUARE_M, count: rules.pigeons, startle_m: 4.5 };
            let id = Id::from_place("pigeons", place.pos);
            self.told.push(Dweller { id, name: String::new(), plan_pos: place.pos, height_m: 0.0, heading_deg: 0.0, kind });
        }
    }

    fn settle_cell(&mut self, cell: u32, shell: &CellShell, rules: &LifeRules, origin: &WorldOrigin) {
        let mut dwellers = Vec::new();
        let fountains = shell.objects.iter().filter(|object| object.kind == ObjectKind::Fountain && object.monument.is_none());
        for object in fountains.filter(|_| rules.fountains) {
            let plan_pos = (shell.origin + object.pos).to_metres();
            if self.has_near(plan_pos, SAME_M, |kind| matches!(kind, LifeKind::Fountain { .. })) {
                continue;
            }
            let id = Id::from_place("fountain", plan_pos);
            let kind = usual_fountain(veduta_city::metres(object.height));
            dwellers.push(Dweller { id, name: String::new(), plan_pos, height_m: 0.0, heading_deg: 0.0, kind });
        }
        self.by_cell.insert(cell, dwellers);
        if rules.hearths > 0.0 {
            let corner = origin.world_from_grid(shell.origin);
            let tops = chimney_tops(shell, |draw| draw.chance("has a hearth", rules.hearths));
            let chimneys = tops.into_iter().map(|top| {
                let top = corner + Vec3::from_array(top);
                let (plan_pos, _) = origin.plan_from_world(top);
                let draw = Draw::new(0, Id::from_place("hearth", plan_pos), "fire");
                Chimney { top, plan_pos, draw, strength: draw.between("strength", 0.6, 1.15), always: false }
            });
            self.chimneys.insert(cell, chimneys.collect());
        }
    }
}

/// Water as it plays in the fountain that furnishes squares, 3.2 m high unless another height is told: it leaps from the top into the bowl,
/// and runs over its rim into the basin.
fn usual_fountain(height_m: f64) -> LifeKind {
    let size = if height_m > 0.0 { (height_m / 3.2).clamp(0.3, 12.0) } else { 1.0 };
    let jet = |count, radius_m, height_m, rise_m, reach_m, lands_m: Option<f64>, width_m| Jet {
        count,
        radius_m: radius_m * size,
        height_m: height_m * size,
        rise_m: rise_m * size,
        reach_m: reach_m * size,
        lands_m: lands_m.map(|at| at * size),
        width_m,
    };
    let jets = vec![
        jet(6, 0.05, 3.15, 0.22, 0.48, Some(2.06), 0.014),
        jet(10, 0.90, 2.09, 0.0, 0.34, None, 0.028),
        jet(4, 0.30, 1.62, 0.02, 0.75, None, 0.016),
    ];
    LifeKind::Fountain { radius_m: 1.6 * size, water_m: 0.66 * size, jets }
}

/// Keeps the population: what is told is looked for when it or the city has changed, what rules say of cells as they stand and go.
pub(crate) fn settle(
    life: Res<CityLife>,
    city: Option<Res<City>>,
    standing: Res<StandingCells>,
    origin: Res<WorldOrigin>,
    mut stand: MessageReader<CellStands>,
    mut released: MessageReader<CellReleased>,
    mut population: ResMut<Population>,
) {
    let is_city_new = city.as_ref().is_some_and(|city| city.is_changed());
    let is_all_new = life.is_changed() || origin.is_changed();
    if is_all_new || is_city_new {
        let places: Vec<&Place> = city.iter().flat_map(|city| city.overviews.places()).collect();
        population.settle(&life.life().things, &life.life().rules, &places);
        population.version += 1;
    }
    for CellReleased { cell } in released.read() {
        population.by_cell.remove(cell);
        population.chimneys.remove(cell);
        population.version += 1;
    }
    let mut cells: Vec<u32> =
        stand.read().map(|stands| stands.cell).filter(|cell| !population.by_cell.contains_key(cell)).collect();
    if is_all_new {
        cells = standing.iter().map(|(cell, ..)| cell).collect();
    }
    for cell in cells {
        if let Some((_, _, shell)) = standing.iter().find(|(n, ..)| *n == cell) {
            population.settle_cell(cell, shell, &life.life().rules, &origin);
            population.version += 1;
        }
    }
}

/// Distances from a thing at which ground is looked for, metres: things on roofs and towers stand over no street.
const ABOUT_M: [f64; 4] = [0.0, 4.0, 9.0, 16.0];

/// Whether what surrounds a plan position stands. Where nobody opens cities, there is nothing to wait for.
pub(crate) fn stands(plan_pos: DVec2, standing: &StandingCells, opened: Option<&OpenCity>) -> bool {
    opened.is_none()
        || ABOUT_M.iter().any(|&away| {
            (0..8).any(|n| {
                let (sin, cos) = (core::f64::consts::TAU * f64::from(n) / 8.0).sin_cos();
                standing.hold(GridPos::from_metres(plan_pos + DVec2::new(cos, sin) * away))
            })
        })
}

/// Where a viewer's eye is: plan metres with the elevation.
pub(crate) fn eye_pos(eye: &veduta_ecs::Eye) -> DVec3 {
    eye.plan_pos.extend(eye.z_m())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use veduta_city::{GridPolygon, Level, ObjectShell, Where};

    use super::*;

    fn square(name: &str, x: f64) -> Place {
        Place { name: name.to_owned(), kind: PlaceKind::Square, pos: DVec2::new(x, 0.0), ..Place::default() }
    }

    #[test]
    fn squares_have_pigeons_but_where_some_are_told_of() {
        let flock = LifeKind::Flock { radius_m: 9.0, count: 5, startle_m: 3.0 };
        let thing = |name: &str, at| LivingThing {
            name: name.to_owned(),
            at,
            by: DVec2::new(2.0, 0.0),
            height_m: 0.0,
            heading_deg: 0.0,
            kind: flock.clone(),
        };
        let (near, far) = (square("Market", 0.0), square("Corn Market", 300.0));
        let things = [thing("ours", Where::Place("Market".to_owned())), thing("lost", Where::Place("Nowhere".to_owned()))];
        let mut population = Population::default();
        population.settle(&things, &LifeRules::default(), &[&near, &far]);
        let told: Vec<(f64, u32)> = population
            .told
            .iter()
            .map(|dweller| match dweller.kind {
                LifeKind::Flock { count, .. } => (dweller.plan_pos.x, count),
                _ => (0.0, 0),
            })
            .collect();
        assert_eq!(told, [(2.0, 5), (300.0, LifeRules::default().pigeons)]);
        population.settle(&things, &LifeRules { pigeons: 0, ..LifeRules::default() }, &[&near, &far]);
        assert_eq!(population.told.len(), 1);
    }

    #[test]
    fn fountains_of_which_nothing_is_told_play_too() {
        let at = |x: i32| ObjectShell {
            kind: ObjectKind::Fountain,
            pos: GridPos(x * 1024, 0),
            z: 0,
            heading: 0,
            height: 4 * 1024,
            monument: None,
        };
        let outline = GridPolygon::simple(vec![GridPos(0, 0), GridPos(9999, 0), GridPos(0, 9999)]);
        let shell = CellShell { origin: GridPos(10 * 1024, 0), outline, objects: vec![at(1), at(40)], ..CellShell::default() };
        let mut population = Population::default();
        let told = usual_fountain(3.2);
        population.told.push(Dweller {
            id: Id(1),
            name: String::new(),
            plan_pos: DVec2::new(12.0, 0.5),
            height_m: 0.0,
            heading_deg: 0.0,
            kind: told,
        });
        population.settle_cell(3, &shell, &LifeRules::default(), &WorldOrigin::default());
        let places: Vec<DVec2> = population.by_cell[&3].iter().map(|dweller| dweller.plan_pos).collect();
        assert_eq!(places, [DVec2::new(50.0, 0.0)], "the other is told of");
        let life = veduta_city::Life {
            things: vec![LivingThing {
                name: "f".to_owned(),
                at: Where::At(0.0, 0.0),
                by: DVec2::ZERO,
                height_m: 0.0,
                heading_deg: 0.0,
                kind: usual_fountain(4.5),
            }],
            ..veduta_city::Life::default()
        };
        assert!(life.validate().is_empty(), "{:?}", life.validate());
    }

    #[test]
    fn a_tower_stands_with_the_street_at_its_foot() {
        let outline = GridPolygon::simple(vec![GridPos(0, 0), GridPos(10_240, 0), GridPos(10_240, 10_240), GridPos(0, 10_240)]);
        let shell = Arc::new(CellShell { outline, ..CellShell::default() });
        let mut standing = StandingCells::default();
        let open = OpenCity("somewhere".to_owned());
        let beside = DVec2::new(17.0, 5.0);
        assert!(!stands(beside, &standing, Some(&open)) && stands(beside, &standing, None));
        standing.add(0, Level::One, &shell);
        assert!(stands(beside, &standing, Some(&open)));
        assert!(!stands(DVec2::new(60.0, 5.0), &standing, Some(&open)));
    }
}
