//! Places by name, as people write them.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::Place;

use crate::letters::{distance, fold};

/// Place names and what they stand for.
///
/// A name is found as written first, then without regard to case, diacritics, hyphens and spacing, so that `Celetna` finds
/// `Celetná`. Of several places with one name the first counts.
#[derive(Debug, Clone, Default)]
pub struct Gazetteer {
    places: Vec<Place>,
    exact: BTreeMap<String, usize>,
    folded: BTreeMap<String, usize>,
}

/// Most names suggested.
const SUGGESTED: usize = 3;
/// Names are compared by so many characters at most.
const COMPARED: usize = 64;

impl Gazetteer {
    /// A gazetteer of the places that have a name.
    #[must_use]
    pub fn new(places: &[Place]) -> Self {
        let mut gazetteer = Self::default();
        for place in places.iter().filter(|p| !p.name.trim().is_empty()) {
            let index = gazetteer.places.len();
            gazetteer.exact.entry(place.name.clone()).or_insert(index);
            gazetteer.folded.entry(fold(&place.name)).or_insert(index);
            gazetteer.places.push(place.clone());
        }
        gazetteer
    }

    /// The place of a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Place> {
        let index = self.exact.get(name).or_else(|| self.folded.get(&fold(name)))?;
        self.places.get(*index)
    }

    /// The names of all places, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.exact.keys().map(String::as_str)
    }

    /// Name and stand of the place whose stand is nearest to a position, if one is within so many metres and found by its name.
    #[must_use]
    pub fn standing_at(&self, plan_pos: DVec2, within_m: f64) -> Option<(&str, DVec2)> {
        let found = self.exact.values().filter_map(|&index| self.places.get(index));
        let stands = found.map(|place| (place.name.as_str(), place.view.map_or(place.pos, |view| view.pos)));
        let near = stands.filter(|(_, stand)| stand.distance(plan_pos) <= within_m);
        near.min_by(|a, b| a.1.distance(plan_pos).total_cmp(&b.1.distance(plan_pos)))
    }

    /// Name of the place nearest to a position, within so many metres, and how far off it is.
    #[must_use]
    pub fn nearest(&self, plan_pos: DVec2, within_m: f64) -> Option<(&str, f64)> {
        let near = self.places.iter().map(|place| (place.name.as_str(), place.pos.distance(plan_pos)));
        near.filter(|(_, away_m)| *away_m <= within_m).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Up to three names that a person may have meant, best first: those that contain the name or are contained in it, and
    /// those within a few letters of it. Empty if nothing is alike.
    #[must_use]
    pub fn suggest(&self, name: &str) -> Vec<&str> {
        let asked: Vec<char> = fold(name).chars().take(COMPARED).collect();
        let asked_text: String = asked.iter().collect();
        let mut alike: Vec<(usize, &str)> = Vec::new();
        for (folded, &index) in &self.folded {
            let Some(place) = self.places.get(index) else { continue };
            let letters: Vec<char> = folded.chars().take(COMPARED).collect();
            let apart = distance(&asked, &letters);
            let least = asked.len().min(letters.len());
            let contains = least >= 3 && (folded.contains(&asked_text) || asked_text.contains(folded.as_str()));
            if apart <= (asked.len().max(letters.len()) / 3).max(2) && apart < asked.len() {
                alike.push((apart, &place.name));
            } else if contains {
                alike.push((4, &place.name));
            }
        }
        alike.sort_unstable();
        alike.into_iter().take(SUGGESTED).map(|(_, name)| name).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn gazetteer(names: &[&str]) -> Gazetteer {
        let place = |(i, name): (usize, &&str)| Place { name: (*name).to_owned(), pos: DVec2::splat(i as f64), ..Place::default() };
        Gazetteer::new(&names.iter().enumerate().map(place).collect::<Vec<_>>())
    }

    #[test]
    fn names_are_found_without_case_and_marks_but_exactly_first() {
        let places = gazetteer(&["Celetna", "Celetná", "Staroměstské náměstí", "Karl-Marx-Straße", "Łódzka"]);
        let index = |name| places.find(name).map(|p| p.pos.x as usize);
        assert_eq!(index("Celetná"), Some(1), "as written");
        assert_eq!(index("CELETNÁ"), Some(0), "the first of those that are alike");
        assert_eq!(index("staromestske  namesti "), Some(2));
        assert_eq!(index("Staroměstske\u{301} na\u{301}me\u{30c}sti\u{301}"), Some(2), "marks as characters of their own");
        assert_eq!(index("karl marx strasse"), Some(3));
        assert_eq!(index("lodzka"), Some(4));
        assert_eq!(index("Nowhere"), None);
        assert_eq!(index(""), None);
    }

    #[test]
    fn near_names_are_suggested_best_first() {
        let places = gazetteer(&["Old Town Square", "Small Square", "Powder Tower", "Old Town Hall", "Týn Church"]);
        assert_eq!(places.suggest("Powder Towre"), ["Powder Tower"], "two letters swapped");
        assert_eq!(places.suggest("tyn chruch"), ["Týn Church"]);
        assert_eq!(places.suggest("Old Town")[..2], ["Old Town Hall", "Old Town Square"]);
        assert!(places.suggest("Xyzzy").is_empty());
        assert!(places.suggest("").is_empty());
    }

    proptest! {
        #[test]
        fn no_name_makes_it_panic(name in any::<String>()) {
            let places = gazetteer(&["Old Town Square", &name]);
            let _ = (places.find(&name), places.suggest(&name));
        }
    }
}
