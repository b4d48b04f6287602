use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

/// What is told of a city's places, beyond what its map says: `X.guide.ron`.
///
/// ```
/// let text = r#"(
///     places: [
///         (
///             name: "Powder Tower",
///             names: {"cs": "Prašná brána"},
///             text: {"en": "The gate of **1475**.", "cs": "Brána z roku **1475**."},
///             period: "1475",
///             certainty: Typical,
///         ),
///     ],
/// )"#;
/// let guide: veduta_city::Guide = veduta_city::file::parse(text, "town.guide.ron")?;
/// assert_eq!(guide.places[0].name_in("cs"), "Prašná brána");
/// assert_eq!(guide.places[0].name_in("it"), "Powder Tower");
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guide {
    /// The city: a path relative to the file, or a URL; only for checking names against it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub city: String,
    /// Language of the names in the map, and of texts where there is none in the visitor's: its code of two or three letters (ISO 639).
    #[serde(default = "Guide::default_language")]
    pub language: String,
    /// Places, told once each.
    pub places: Vec<GuidePlace>,
}

/// What is told of a place.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuidePlace {
    /// Its name in the map.
    pub name: String,
    /// Its name in other languages, where it has one: by the language's code.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub names: BTreeMap<String, String>,
    /// What else people call it, in any language: to be found by.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub other_names: Vec<String>,
    /// What to know about it, in Markdown: by the language's code.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub text: BTreeMap<String, String>,
    /// When what stands there was built, as a year or years: `1475`, `1365–1511`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub period: String,
    /// How far what is shown of it can be trusted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certainty: Option<Certainty>,
    /// When it is open, as OpenStreetMap writes it: `Tu-Su 10:00-18:00`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub hours: String,
    /// Pages on the web, `https://` or `http://`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<String>,
}

/// How far a reconstruction can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Certainty {
    /// Measured, or built from drawings and photographs.
    Documented,
    /// Right in size, place and kind; typical in detail.
    Typical,
    /// As it may have been.
    Invented,
}

impl Guide {
    fn default_language() -> String {
        "en".to_owned()
    }

    /// The entry of a place.
    #[must_use]
    pub fn of(&self, place: &str) -> Option<&GuidePlace> {
        self.places.iter().find(|told| told.name == place)
    }

    /// What is wrong with it, a sentence each.
    #[must_use]
    pub fn validate(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut told = BTreeSet::new();
        let mut check_code = |of: &str, code: &str| {
            if !((2..=3).contains(&code.len()) && code.bytes().all(|b| b.is_ascii_lowercase())) {
                wrong.push(format!("{of}: `{code}` is no code of a language: write two or three small letters, such as \"en\""));
            }
        };
        check_code("language", &self.language);
        for place in &self.places {
            place.names.keys().chain(place.text.keys()).for_each(|code| check_code(&format!("place “{}”", place.name), code));
        }
        for (n, place) in self.places.iter().enumerate() {
            if place.name.trim().is_empty() {
                wrong.push(format!("place {}: it has no name: write name: \"...\", as in the map", n + 1));
            } else if !told.insert(&place.name) {
                wrong.push(format!("place “{}” is told twice: keep one", place.name));
            }
            for link in place.links.iter().filter(|link| !is_web_address(link)) {
                wrong.push(format!(
                    "place “{}”: the link `{link}` must begin with https:// or http:// and have no spaces",
                    place.name
                ));
            }
        }
        wrong
    }
}

/// Whether a link leads to the web, and nowhere else.
fn is_web_address(link: &str) -> bool {
    let rest = link.strip_prefix("https://").or_else(|| link.strip_prefix("http://"));
    rest.is_some_and(|rest| !rest.is_empty() && !rest.starts_with('/'))
        && !link.chars().any(|c| c.is_whitespace() || c.is_control())
}

impl GuidePlace {
    /// Its name in a language; its name in the map where it has no other.
    #[must_use]
    pub fn name_in(&self, language: &str) -> &str {
        self.names.get(language).map_or(&self.name, String::as_str)
    }

    /// Its text in the first of some languages that there is one in, else in any.
    #[must_use]
    pub fn text_in(&self, languages: &[&str]) -> Option<&str> {
        let first = languages.iter().find_map(|language| self.text.get(*language));
        first.or_else(|| self.text.values().next()).map(String::as_str)
    }

    /// All its names.
    pub fn all_names(&self) -> impl Iterator<Item = &str> {
        core::iter::once(&self.name).chain(self.names.values()).chain(&self.other_names).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_told_with_the_place_and_the_remedy() {
        let place = |name: &str| GuidePlace { name: name.to_owned(), ..GuidePlace::default() };
        let guide = Guide {
            city: String::new(),
            language: "English".to_owned(),
            places: vec![
                place("A"),
                place("A"),
                place(" "),
                GuidePlace {
                    names: [("CZ".to_owned(), "Bé".to_owned())].into(),
                    links: [
                        "javascript:alert(1)",
                        "file:///etc/passwd",
                        "https://",
                        "https:///x",
                        "https://a b",
                        "https://example.org",
                    ]
                    .map(str::to_owned)
                    .into(),
                    ..place("B")
                },
            ],
        };
        let wrong = guide.validate();
        let tells = |what: &str| wrong.iter().filter(|w| w.contains(what)).count();
        assert_eq!(tells("two or three small letters"), 2, "{wrong:?}");
        assert_eq!(
            (tells("told twice"), tells("place 3: it has no name"), tells("must begin with https://")),
            (1, 1, 5),
            "{wrong:?}"
        );
        assert_eq!(wrong.len(), 9, "{wrong:?}");
    }

    #[test]
    fn texts_come_in_the_first_language_that_there_is() {
        let text = [("en", "one"), ("it", "uno")].map(|(code, text)| (code.to_owned(), text.to_owned()));
        let place = GuidePlace { name: "A".to_owned(), text: text.into(), ..GuidePlace::default() };
        assert_eq!(place.text_in(&["cs", "it"]), Some("uno"));
        assert_eq!(place.text_in(&["cs"]), Some("one"), "any is better than none");
        assert_eq!(GuidePlace::default().text_in(&["en"]), None);
    }
}
