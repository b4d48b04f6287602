//! Streets and places of the open city, as far as a tour needs them.

use std::sync::{Arc, OnceLock};

use bevy::math::DVec2;
use veduta_city::Overview;
use veduta_ecs::{Around, City};
use veduta_route::{CompiledTour, Finder, Gazetteer, Named, StreetNet};

/// They are looked for so far about the city's start, then twice as far, until all of a tour lies within; metres.
pub(crate) const SEARCH_M: f64 = 500.0;
/// So far about a tour there may be shorter ways, metres.
pub(crate) const AROUND_TOUR_M: f64 = 100.0;

/// Streets to walk along and places to name, within a circle.
#[derive(Debug, Clone)]
pub(crate) struct Streets {
    pub around: Around,
    pub net: StreetNet,
    pub places: Gazetteer,
    finder: OnceLock<Finder>,
}

impl Streets {
    /// Those of an overview's parts.
    pub fn of(parts: &[Arc<Overview>], around: Around) -> Self {
        let overview = Overview::joined(parts.iter().map(AsRef::as_ref));
        let net = StreetNet::new(&overview.streets).on(&overview.terrain);
        Self { around, net, places: Gazetteer::new(&overview.places), finder: OnceLock::new() }
    }

    /// Places by what people type of their names; made when somebody first does.
    pub fn finder(&self) -> &Finder {
        self.finder.get_or_init(|| {
            let places = self.places.names().filter_map(|name| self.places.find(name));
            Finder::new(places.map(|place| Named::place(place, None)).collect())
        })
    }

    /// The parts that are needed, once they have come.
    pub fn parts(city: &City, around: Around) -> Option<Vec<Arc<Overview>>> {
        city.overviews.has(around).then(|| city.overviews.near(around).cloned().collect())
    }
}

/// How far a tour leads from a place, metres.
pub(crate) fn reach_m(tour: &CompiledTour, from: DVec2) -> f64 {
    let stops = (0..=tour.duration_s().ceil() as u32).map(|s| tour.pose(f64::from(s)).plan_pos);
    stops.map(|pos| pos.distance(from)).fold(0.0, f64::max)
}
