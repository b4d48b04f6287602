//! What street fronts carry besides their openings, as their style asks: pilasters or quoins on all of a house's, and on that of its door
//! a bay window, balconies, a statue.
//!
//! # Limits
//! What stands out of a front keeps to its own bays, above the heads of people, and is left out where the street is narrow.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{
    Articulation, Balconies, BalconyPlaces, GridPos, House, Niche, Opening, Oriel, Ornament, Parapet, PlanTerrain, Storey, Style,
    Wall, WallKind, metres,
};

use super::houses::StyleBook;
use super::walls::{DOORSTEP, Standing};

/// Narrower bays have no pilasters between them; metres.
const LEAST_PILASTER_BAY_M: f64 = 2.1;
/// Pilasters are no shorter and no taller than this; metres.
const PILASTERS_M: core::ops::RangeInclusive<f64> = 4.5..=17.0;
/// Bays with an oriel are so broad; metres.
const ORIEL_BAY_M: core::ops::RangeInclusive<f64> = 2.0..=4.2;
/// Narrower bays have no balcony; metres.
const LEAST_BALCONY_BAY_M: f64 = 1.9;
/// Narrower bays leave no pier for a statue; metres.
const LEAST_NICHE_BAY_M: f64 = 2.4;
/// Where something stands out of a front, its first floor is so high above the ground before it: corbels and consoles hang 0.8 m lower.
const HEADROOM_M: f64 = 3.0;
/// Ground before it without another house, so that something may stand out of a front; metres.
const CLEAR_M: [f64; 5] = [0.6, 1.2, 2.4, 3.6, 4.8];
/// Storeys lower than this are attics; metres.
const ATTIC_M: f64 = 2.6;
/// Most bays whose balconies can be told.
const MOST_BAYS: u8 = 32;

/// Gives houses their ornaments.
pub(super) fn adorn(houses: &mut [House], standing: &Standing, terrain: &PlanTerrain, book: &StyleBook<'_>, seed: u64) {
    houses.par_iter_mut().filter(|house| house.monument.is_none()).for_each(|house| {
        let style = book.style(usize::from(house.style));
        let draw = Draw::new(seed, house.id, "ornament");
        let floor = house.floor;
        let on_ground = house.volumes.iter_mut().filter(|volume| volume.bottom.saturating_sub(floor) <= DOORSTEP);
        for volume in on_ground {
            let edges: Vec<(DVec2, DVec2)> = volume.footprint.edges().map(|(a, b)| (a.to_metres(), b.to_metres())).collect();
            let height_m = metres(volume.eaves.saturating_sub(volume.bottom));
            let has_roof = volume.roof.is_there();
            for (wall, (a, b)) in volume.walls.iter_mut().zip(edges).filter(|(wall, _)| wall.kind == WallKind::Street) {
                if wall.bays == 0 || !wall.storeys.iter().skip(1).any(|storey| is_window(storey.opening)) {
                    continue;
                }
                let front = Front { wall, a, b, height_m };
                let mut ornament = Ornament::default();
                if has_roof {
                    ornament.articulation = front.articulation(style, draw);
                }
                let first_floor = volume.bottom.saturating_add(wall.storeys.first().map_or(0, |storey| storey.height));
                let is_high = metres(first_floor) >= terrain.range_along(a, b).1 + HEADROOM_M;
                if wall.ground_floor.door_bay.is_some() && is_high {
                    front.stand_out(&mut ornament, style, draw, standing);
                }
                wall.ornament = (ornament != Ornament::default()).then(|| Box::new(ornament));
            }
        }
    });
}

/// A wall that faces a street.
struct Front<'a> {
    wall: &'a Wall,
    a: DVec2,
    b: DVec2,
    height_m: f64,
}

impl Front<'_> {
    fn bay_m(&self) -> f64 {
        self.a.distance(self.b) / f64::from(self.wall.bays)
    }

    /// As the style has it, if there is room for it.
    fn articulation(&self, style: &Style, draw: Draw) -> Articulation {
        let drawn = draw.pick("articulation", &style.articulation).copied().unwrap_or_default();
        let ground_m = self.wall.storeys.first().map_or(0.0, |storey| metres(storey.height));
        let fits = match drawn {
            Articulation::Plain => true,
            Articulation::Quoins => self.a.distance(self.b) > 4.0,
            Articulation::Pilasters => self.bay_m() >= LEAST_PILASTER_BAY_M && PILASTERS_M.contains(&(self.height_m - ground_m)),
        };
        if fits { drawn } else { Articulation::Plain }
    }

    /// What stands out of the front of the door: a bay window or balconies; and a statue.
    fn stand_out(&self, ornament: &mut Ornament, style: &Style, draw: Draw, standing: &Standing) {
        let wall = self.wall;
        // From the storey over the ground floor and its mezzanine to the highest with whole windows all the way.
        let is_whole = |storey: &&Storey| is_window(storey.opening) && storey.opening != Opening::AtticWindow;
        let has_windows = |storey: &&Storey| is_whole(storey) && metres(storey.height) >= ATTIC_M;
        let first = 1 + usize::from(wall.storeys.len() > 2 && wall.storeys[1].opening == Opening::AtticWindow);
        let count = wall.storeys.iter().skip(first).take_while(has_windows).count();
        let storeys = (first as u8, (first + count).saturating_sub(1).min(usize::from(u8::MAX)) as u8);
        if count == 0 || wall.bays > MOST_BAYS || !self.is_clear(standing) {
            return;
        }
        if draw.chance("oriel", style.oriels) {
            ornament.oriel = self.oriel(storeys, draw);
        }
        if ornament.oriel.is_none() {
            let places = draw.pick("balconies", &style.balconies).copied().unwrap_or_default();
            ornament.balconies = self.balconies(places, storeys, draw);
        }
        // Pilasters stand where a statue would.
        if ornament.articulation != Articulation::Pilasters && draw.chance("niche", style.niches) {
            ornament.niche = self.niche(ornament, storeys.0, draw);
        }
    }

    fn oriel(&self, (first, top): (u8, u8), draw: Draw) -> Option<Oriel> {
        // It ends a storey below the eaves.
        let bays = self.wall.bays;
        let below_eaves = self.wall.storeys.len().checked_sub(2).filter(|&storey| storey >= usize::from(first))?;
        if bays < 3 || !ORIEL_BAY_M.contains(&self.bay_m()) {
            return None;
        }
        let bay = if bays % 2 == 1 && draw.chance("in the middle", 0.6) {
            bays / 2
        } else {
            1 + draw.below("oriel's bay", usize::from(bays) - 2) as u8
        };
        Some(Oriel { bay, storeys: (first, usize::from(top).min(below_eaves) as u8) })
    }

    fn balconies(&self, places: BalconyPlaces, (first, top): (u8, u8), draw: Draw) -> Option<Balconies> {
        let bays = self.wall.bays;
        let (every, parapet) = match places {
            BalconyPlaces::Nowhere => return None,
            BalconyPlaces::OverDoor => {
                let door = u32::from(self.wall.ground_floor.door_bay?);
                return (self.bay_m() >= LEAST_BALCONY_BAY_M && door < u32::from(MOST_BAYS)).then_some(Balconies {
                    bays: 1 << door,
                    storeys: (first, first),
                    parapet: Parapet::Balusters,
                });
            }
            // One bay, or the two beside the middle.
            BalconyPlaces::Middle => (1_u32 << (bays / 2) | 1 << ((bays - 1) / 2), Parapet::Iron),
            BalconyPlaces::Ends => (1 | 1 << (bays - 1), Parapet::Iron),
            BalconyPlaces::Stacks => {
                let stack = draw.below("stack", 2);
                ((stack..usize::from(bays)).step_by(2).fold(0, |bits, bay| bits | 1 << bay), Parapet::Panels)
            }
        };
        (self.bay_m() >= LEAST_BALCONY_BAY_M && every > 0).then_some(Balconies { bays: every, storeys: (first, top), parapet })
    }

    /// Between two bays of a storey that have nothing else before them.
    fn niche(&self, beside: &Ornament, storey: u8, draw: Draw) -> Option<Niche> {
        let is_free = |bay: u8| {
            beside.oriel.is_none_or(|oriel| oriel.bay != bay)
                && beside.balconies.is_none_or(|balconies| bay >= MOST_BAYS || balconies.bays >> bay & 1 == 0)
        };
        let free: Vec<u8> = (1..self.wall.bays).filter(|&bay| is_free(bay - 1) && is_free(bay)).collect();
        if self.bay_m() < LEAST_NICHE_BAY_M {
            return None;
        }
        draw.pick("niche's bay", &free).map(|&bay| Niche { bay, storey })
    }

    /// Whether the street before it is broad enough.
    fn is_clear(&self, standing: &Standing) -> bool {
        let out = -(self.b - self.a).normalize_or_zero().perp();
        let is_free = |p: DVec2| standing.at(GridPos::from_metres(p)).next().is_none();
        [0.03, 0.25, 0.5, 0.75, 0.97]
            .into_iter()
            .all(|share| CLEAR_M.into_iter().all(|far| is_free(self.a.lerp(self.b, share) + out * far)))
    }
}

/// Whether people look out of it.
const fn is_window(opening: Opening) -> bool {
    matches!(
        opening,
        Opening::Window
            | Opening::FramedWindow
            | Opening::CorniceWindow
            | Opening::PedimentWindow
            | Opening::ArchedWindow
            | Opening::WideWindow
            | Opening::AtticWindow
    )
}
