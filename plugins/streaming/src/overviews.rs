use std::collections::BTreeSet;

use bevy::prelude::*;
use veduta_city::{GridPos, bounds};
use veduta_ecs::{Around, City, DistrictMemory, Eye, OverviewWants, Viewer};
use veduta_store::{CityIndex, RegionEntry};

use crate::fetch::Store;
use crate::need::{largest_first, rise_per_m};
use crate::{CurrentCell, StreamingSettings, Wanted};

/// A viewer as overviews are planned for, coarsely: what is planned depends on nothing else of where he is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Standpoint {
    /// Within it all overviews are wanted.
    about: Around,
    /// Elevation of the ground, metres.
    ground_m: f64,
}

impl Standpoint {
    fn of(eye: &Eye, settings: &StreamingSettings) -> Self {
        const STEP_M: f64 = 8.0;
        let is_flying = eye.eye_m >= settings.flying_from_m;
        let radius_m = if is_flying { settings.overview_flying_m } else { settings.overview_m };
        Self { about: Around::coarsely(eye.plan_pos, radius_m), ground_m: (eye.ground_m / STEP_M).round() * STEP_M }
    }

    /// How far away a region is, at least; metres.
    fn distance_m(&self, region: &RegionEntry) -> f64 {
        bounds::distance_m(region.bounds, self.about.middle)
    }

    /// How tall it looks, at most.
    fn rise_per_m(&self, region: &RegionEntry) -> f64 {
        rise_per_m(region.top, region.bounds, (self.about.middle, self.ground_m))
    }
}

/// What overviews were last planned for.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Planned {
    standpoints: Vec<Standpoint>,
    plugins: Vec<Around>,
    /// The regions that viewers stand in or fly over and that are here to tell what is seen from them.
    grounds: Vec<u32>,
    /// So many parts may show cells from afar.
    most_parts: usize,
}

/// Plans which parts of the overview are wanted: those about the viewers, then what plugins ask for, then what viewers see from afar: what is
/// nearest, and what looks tall.
pub(crate) fn plan_overviews(
    (city, store): (Option<ResMut<City>>, Option<Res<Store>>),
    settings: Res<StreamingSettings>,
    wants: Res<OverviewWants>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
    afar: Res<DistrictMemory>,
    mut wanted: ResMut<Wanted>,
    mut planned: Local<Planned>,
) {
    let Some(mut city) = city else { return };
    let index = store.as_ref().and_then(|store| store.client.index());
    let grounds = viewers.iter().filter_map(|(eye, current)| {
        let index = index?;
        let is_here = |number: &u32| index.region(*number).is_some();
        let of_cell = current.and_then(|current| index.region_of(current.0?));
        of_cell.or_else(|| index.regions_at(GridPos::from_metres(eye.plan_pos)).find(is_here)).filter(is_here)
    });
    // A city just opened has no list yet.
    let is_new = wanted.overviews.is_empty() || settings.is_changed();
    // What had to go once does not come back because others are smaller.
    let most_parts = if is_new { usize::MAX } else { planned.most_parts };
    let asked = Planned {
        standpoints: viewers.iter().map(|(eye, _)| Standpoint::of(eye, &settings)).collect(),
        plugins: wants.0.values().copied().collect(),
        grounds: grounds.collect(),
        most_parts: settings.most_parts(*afar).min(most_parts),
    };
    if *planned == asked && !is_new {
        return;
    }
    *planned = asked;
    let within = |circle: Around| city.overviews.within(circle).collect::<Vec<_>>();
    let about: Vec<u32> = planned.standpoints.iter().flat_map(|at| within(at.about)).collect();
    let near = about.iter().copied().collect();
    let vistas = index.map_or_else(Vec::new, |index| vistas(index, &planned, &near, &settings));
    let mut overviews: Vec<u32> = Vec::new();
    let of_plugins = planned.plugins.iter().flat_map(|&circle| within(circle));
    for part in about.into_iter().chain(of_plugins).chain(vistas.iter().copied()) {
        if !overviews.contains(&part) {
            overviews.push(part);
        }
    }
    if city.overviews.vistas() != vistas {
        city.overviews.set_vistas(vistas);
    }
    if wanted.overviews != overviews {
        wanted.overviews = overviews;
        wanted.generation += 1;
    }
}

/// What is to be there of what is seen from some regions and is not near.
fn vistas(index: &CityIndex, planned: &Planned, near: &BTreeSet<u32>, settings: &StreamingSettings) -> Vec<u32> {
    let grounds = planned.grounds.iter().filter_map(|&number| index.region(number));
    let seen: BTreeSet<u32> = grounds.flat_map(|region| &region.vistas).copied().filter(|number| !near.contains(number)).collect();
    let room = planned.most_parts.saturating_sub(near.len());
    let most = |number: u32, of: &dyn Fn(&Standpoint, &RegionEntry) -> f64| {
        let region = &index.regions[number as usize];
        planned.standpoints.iter().map(|at| of(at, region)).fold(f64::NEG_INFINITY, f64::max)
    };
    let nearness = |number: u32| most(number, &|at, region| -at.distance_m(region));
    let rise = |number: u32| most(number, &Standpoint::rise_per_m);
    let mut vistas: Vec<u32> = largest_first(seen.iter().map(|&n| (nearness(n), n))).take(settings.vistas).collect();
    let tall = largest_first(seen.iter().map(|&n| (rise(n), n)).filter(|(rise, _)| *rise > StreamingSettings::TALL));
    let more: Vec<u32> = tall.take(settings.tall_vistas).filter(|number| !vistas.contains(number)).collect();
    vistas.extend(more);
    vistas.truncate(room);
    vistas
}
