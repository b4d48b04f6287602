//! Places by name, as people write them.

use std::collections::BTreeMap;

use veduta_city::Place;

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

/// Letters and what they become once their marks are taken off.
const MARKED: [(&str, &str); 31] = [
    ("a", "àáâãäåāăąǎạảấầẩẫậắằẳẵặ"),
    ("ae", "æǽ"),
    ("c", "çćĉċč"),
    ("d", "ďđḍ"),
    ("dh", "ð"),
    ("e", "èéêëēĕėęěẹẻẽếềểễệ"),
    ("g", "ĝğġģǧ"),
    ("h", "ĥħḥ"),
    ("i", "ìíîïĩīĭįıǐỉị"),
    ("ij", "ĳ"),
    ("j", "ĵ"),
    ("k", "ķǩ"),
    ("l", "ĺļľŀłḷ"),
    ("m", "ṃ"),
    ("n", "ñńņňŉŋṇ"),
    ("o", "òóôõöøōŏőǒơọỏốồổỗộớờởỡợ"),
    ("oe", "œ"),
    ("r", "ŕŗř"),
    ("s", "śŝşšșṣ"),
    ("ss", "ßẞ"),
    ("t", "ţťŧțṭ"),
    ("th", "þ"),
    ("u", "ùúûüũūŭůűųǔưụủứừửữự"),
    ("w", "ŵẁẃẅ"),
    ("y", "ýÿŷỳỵỷỹ"),
    ("z", "źżžẓ"),
    ("α", "ά"),
    ("ε", "έ"),
    ("и", "й"),
    ("ο", "ό"),
    ("'", "’‘ʼ`´"),
];

/// A name in small letters without marks, with single spaces for hyphens and runs of space.
fn fold(name: &str) -> String {
    let mut folded = String::with_capacity(name.len());
    for c in name.chars().flat_map(char::to_lowercase) {
        match c {
            '\u{300}'..='\u{36f}' => {}
            c if c.is_whitespace() || matches!(c, '-' | '‐' | '‑' | '–' | '—' | '_') => {
                if !folded.is_empty() && !folded.ends_with(' ') {
                    folded.push(' ');
                }
            }
            c if c.is_ascii() && c != '`' => folded.push(c),
            c => match MARKED.iter().find(|(_, marked)| marked.contains(c)) {
                Some((plain, _)) => folded.push_str(plain),
                None => folded.push(c),
            },
        }
    }
    folded.truncate(folded.trim_end().len());
    folded
}

/// Least number of letters put in, left out, changed, or swapped with their neighbour (optimal string alignment).
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before_last: Vec<usize> = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.iter().enumerate() {
        let mut row = vec![i + 1; b.len() + 1];
        for (j, cb) in b.iter().enumerate() {
            let changed = last[j] + usize::from(ca != cb);
            row[j + 1] = changed.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *ca == b[j - 1] && a[i - 1] == *cb {
                row[j + 1] = row[j + 1].min(before_last[j - 1] + 1);
            }
        }
        before_last = core::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
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
        fn distance_is_a_distance(a in "[a-e]{0,9}", b in "[a-e]{0,9}") {
            let (ca, cb): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
            let apart = distance(&ca, &cb);
            prop_assert_eq!(apart, distance(&cb, &ca));
            prop_assert_eq!(apart == 0, a == b);
            prop_assert!(apart <= ca.len().max(cb.len()));
            prop_assert!(apart >= ca.len().abs_diff(cb.len()));
        }

        #[test]
        fn folding_twice_changes_nothing(name in "\\PC{0,40}") {
            let once = fold(&name);
            prop_assert_eq!(fold(&once), once);
        }

        #[test]
        fn no_name_makes_it_panic(name in any::<String>()) {
            let places = gazetteer(&["Old Town Square", &name]);
            let _ = (places.find(&name), places.suggest(&name));
        }
    }
}
