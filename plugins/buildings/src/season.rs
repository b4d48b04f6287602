use bevy::prelude::*;
use veduta_city::Season;
use veduta_ecs::{City, CityClock};

/// Latitude where no city is open, degrees.
const LAT_DEG: f64 = 50.0;

/// The season in which trees are seen. It follows [`CityClock`] and the city's latitude; they are made anew when it turns.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CitySeason(
    /// Which.
    pub Season,
);

pub(crate) fn find_season(clock: Res<CityClock>, city: Option<Res<City>>, mut season: ResMut<CitySeason>) {
    let lat_deg = city.map_or(LAT_DEG, |city| city.anchor.lat);
    season.set_if_neq(CitySeason(Season::at(lat_deg, clock.day)));
}
