//! Makes tours ready: read, and compiled once the streets they walk on are here.

use std::sync::Arc;

use bevy::asset::{AssetLoadError, AssetLoadFailedEvent};
use bevy::prelude::*;
use veduta_ecs::{Around, City, OverviewWants, Steering};
use veduta_route::compile;

use crate::asset::TourLoadError;
use crate::play::Hold;
use crate::streets::{AROUND_TOUR_M, SEARCH_M, Streets, reach_m};
use crate::{TourAsset, TourPlayer, TourState};

/// Tells of a tour that could not be read. The last good version, if there is one, plays on.
pub(crate) fn tell_failures(mut failed: MessageReader<AssetLoadFailedEvent<TourAsset>>, mut player: ResMut<TourPlayer>) {
    for failure in failed.read() {
        if player.handle.as_ref().is_none_or(|handle| handle.id() != failure.id) {
            continue;
        }
        let message = match &failure.error {
            AssetLoadError::AssetLoaderError(error) => match error.error().downcast_ref::<TourLoadError>() {
                Some(mistake) => mistake.to_string(),
                None => format!("{}: the tour cannot be read", failure.path),
            },
            error => error.to_string(),
        };
        error!("{message}");
        player.last_error = Some(message);
        if player.compiled.is_none() {
            player.state = TourState::Idle;
        }
    }
}

/// Compiles the tour once it and the city's streets are here, and anew when its file has changed.
pub(crate) fn compile_tour(
    mut events: MessageReader<AssetEvent<TourAsset>>,
    assets: Res<Assets<TourAsset>>,
    city: Option<Res<City>>,
    mut player: ResMut<TourPlayer>,
    mut wants: ResMut<OverviewWants>,
    mut steering: ResMut<Steering>,
) {
    let handle = player.handle.clone();
    for event in events.read() {
        // What is edited is compiled by whoever edits it.
        let changed = |id: &AssetId<TourAsset>| !player.is_edited && handle.as_ref().is_some_and(|h| h.id() == *id);
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } = event
            && changed(id)
            && let Some(asset) = assets.get(*id)
        {
            player.source = Some(asset.tour.clone());
        }
    }
    if player.source.is_none() {
        OverviewWants::ask(&mut wants, "tour", None);
        return;
    }
    let Some(city) = city else { return };
    let around = Around { middle: city.start.pos, radius_m: player.search_m.unwrap_or(SEARCH_M) };
    OverviewWants::ask(&mut wants, "tour", Some(around));
    let Some(parts) = Streets::parts(&city, around) else { return };
    let Some(source) = player.source.take() else { return };
    let streets = Streets::of(&parts, around);
    let compiled = compile(&source, &streets.net, &streets.places);
    let reach_m = compiled.as_ref().map_or(f64::INFINITY, |tour| reach_m(tour, around.middle) + AROUND_TOUR_M);
    if reach_m > around.radius_m && !city.overviews.is_all(around) {
        // The same for the same city, whatever else of it is here: another way, or another place of that name, might be found.
        player.search_m = Some(around.radius_m * 2.0);
        player.source = Some(source);
        return;
    }
    player.search_m = None;
    match compiled {
        Ok(tour) => {
            info!("tour “{}”: {:.0} s", tour.title(), tour.duration_s());
            player.t_s = player.t_s.min(tour.duration_s());
            player.put(tour, Arc::new(streets));
            if player.play_when_ready {
                player.play_when_ready = false;
                player.state = TourState::Playing;
                player.hold = Hold::Cut;
                steering.set_if_neq(Steering::Guided);
            }
        }
        Err(error) => {
            // The last good version, if there is one, plays on.
            let message = format!("tour “{}”: {error}", source.title);
            error!("{message}");
            player.last_error = Some(message);
            if player.compiled.is_none() {
                player.state = TourState::Idle;
            }
        }
    }
}
