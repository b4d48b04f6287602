use bevy::prelude::*;
use veduta_ecs::{PlaceNames, Words};

use crate::CityGuide;

/// Tells others the names of places in the visitor's language.
pub(crate) fn tell(guide: Res<CityGuide>, words: Res<Words>, mut names: ResMut<PlaceNames>) {
    if !(guide.is_changed() || words.is_changed()) {
        return;
    }
    let language = words.language();
    let told = guide.guide().places.iter().filter(|place| place.names.contains_key(language));
    names.set_if_neq(PlaceNames(told.map(|place| (place.name.clone(), place.name_in(language).to_owned())).collect()));
}
