//! Which places can be walked to from one another.

use std::collections::BTreeMap;

use veduta_city::Place;

use crate::{RouteError, StreetNet};

/// A place that cannot be walked to from most others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unreached<'a> {
    /// The place.
    pub place: &'a Place,
    /// Why; `None` where it lies at streets that are not joined to those of most places.
    pub why: Option<RouteError>,
}

/// The places that [`StreetNet::way`] does not lead to from most others: from any other one of those it leads to each of the rest.
#[must_use]
pub fn unreached<'a>(net: &StreetNet, places: impl IntoIterator<Item = &'a Place>) -> Vec<Unreached<'a>> {
    let stands: Vec<(&Place, Result<Vec<u32>, RouteError>)> = places
        .into_iter()
        .map(|place| {
            let stand = place.view.map_or(place.pos, |view| view.pos);
            (place, net.pieces_at(stand))
        })
        .collect();
    let mut count: BTreeMap<u32, usize> = BTreeMap::new();
    for piece in stands.iter().flat_map(|(_, pieces)| pieces.iter().flatten()) {
        *count.entry(*piece).or_default() += 1;
    }
    let Some((&main, _)) = count.iter().max_by_key(|(piece, count)| (**count, core::cmp::Reverse(**piece))) else {
        return stands.into_iter().map(|(place, pieces)| Unreached { place, why: pieces.err() }).collect();
    };
    let is_apart = |(place, pieces): (&'a Place, Result<Vec<u32>, RouteError>)| match pieces {
        Ok(pieces) if pieces.contains(&main) => None,
        Ok(_) => Some(Unreached { place, why: None }),
        Err(why) => Some(Unreached { place, why: Some(why) }),
    };
    stands.into_iter().filter_map(is_apart).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{grid_town, street};

    #[test]
    fn places_apart_are_told_with_their_reasons() {
        let mut streets = grid_town(3, 50.0);
        streets.push(street(&[(1_000.0, 0.0), (1_100.0, 0.0)]));
        let net = StreetNet::new(&streets);
        let place = |name: &str, x: f64| Place { name: name.into(), pos: (x, 0.0).into(), ..Place::default() };
        let places = [place("here", 0.0), place("there", 90.0), place("isle", 1_050.0), place("nowhere", 9_000.0)];
        let apart = unreached(&net, &places);
        let names: Vec<&str> = apart.iter().map(|one| one.place.name.as_str()).collect();
        assert_eq!(names, ["isle", "nowhere"]);
        assert!(apart[0].why.is_none() && matches!(apart[1].why, Some(RouteError::OffStreets { .. })), "{apart:?}");
        assert_eq!(unreached(&StreetNet::new(&[]), &places).len(), 4);
        for (a, b) in [(0, 1), (1, 0)] {
            assert!(net.way(places[a].pos, places[b].pos).is_ok());
        }
    }
}
