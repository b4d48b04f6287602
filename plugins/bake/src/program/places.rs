//! The places of a city by their names: as its map has them, and as its guide tells them in other languages.

use std::collections::BTreeMap;
use std::path::Path;

use anstream::println;
use veduta_city::{Guide, file};
use veduta_route::fold;

use super::{Failure, beside::told_of, town::open};

/// Prints the places of a city, one a line: name, where it lies in plan metres, and what else it is called.
pub(crate) fn list(city: &Path) -> Result<(), Failure> {
    let town = open(city).map_err(|error| format!("{}: {error}", city.display()))?;
    let mut others: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (other, name) in town.known_as.values() {
        others.entry(name).or_default().push(other);
    }
    for name in town.places.names() {
        let Some(place) = town.places.find(name) else { continue };
        let others = others.get(name).map_or_else(String::new, |others| format!("  ({})", others.join(", ")));
        println!("{name}  At({:.1}, {:.1}){others}", place.pos.x, place.pos.y);
    }
    Ok(())
}

/// Names of the guides beside a city by their letters alone: each with how it is written and the place's name in the map.
pub(super) fn known_as(city: &Path) -> BTreeMap<String, (String, String)> {
    let guides = told_of(city, ".guide.ron").into_iter().filter_map(|path| file::read::<Guide>(&path).ok());
    let mut names = BTreeMap::new();
    for place in guides.flat_map(|guide| guide.places) {
        for other in place.names.values().chain(&place.other_names).filter(|other| **other != place.name) {
            names.entry(fold(other)).or_insert_with(|| (other.clone(), place.name.clone()));
        }
    }
    names
}
