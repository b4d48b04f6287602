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
    /// Pictures of it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<GuidePicture>,
    /// What can be listened to there, Ogg Vorbis: a path beside the guide's file.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sound: String,
    /// Pages on the web, `https://` or `http://`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<String>,
}

/// A picture of a place.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuidePicture {
    /// PNG, JPEG or WebP: a path beside the guide's file, or an `https://` address that the visitor is asked about.
    pub file: String,
    /// What it shows: by the language's code.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub caption: BTreeMap<String, String>,
    /// Whose it is, and under what licence: by the language's code.
    pub credit: BTreeMap<String, String>,
}

impl GuidePicture {
    /// Whether it lies on the web.
    #[must_use]
    pub fn is_on_the_web(&self) -> bool {
        self.file.contains("://")
    }

    /// What is wrong with it.
    fn mistake(&self) -> Option<String> {
        let file = &self.file;
        if self.is_on_the_web() {
            if !file.starts_with("https://") || !is_web_address(file) {
                return Some(format!("the picture `{file}` must begin with https:// and have no spaces, or lie beside the guide"));
            }
        } else {
            let name = file.to_ascii_lowercase();
            let is_picture = [".png", ".jpg", ".jpeg", ".webp"].iter().any(|ending| name.ends_with(ending));
            if !is_picture || !crate::is_beside(file) {
                return Some(format!(
                    "the picture `{file}` must be a .png, .jpg, .jpeg or .webp in or below the guide's folder, or an https:// address"
                ));
            }
        }
        let is_credited = self.credit.values().any(|credit| !credit.trim().is_empty());
        (!is_credited).then(|| format!("the picture `{file}` has no credit: say whose it is and under what licence"))
    }
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
            let of_pictures = place.pictures.iter().flat_map(|picture| picture.caption.keys().chain(picture.credit.keys()));
            place
                .names
                .keys()
                .chain(place.text.keys())
                .chain(of_pictures)
                .for_each(|code| check_code(&format!("place “{}”", place.name), code));
        }
        for (n, place) in self.places.iter().enumerate() {
            if place.name.trim().is_empty() {
                wrong.push(format!("place {}: it has no name: write name: \"...\", as in the map", n + 1));
            } else if !told.insert(&place.name) {
                wrong.push(format!("place “{}” is told twice: keep one", place.name));
            }
            let of = |mistake: String| format!("place “{}”: {mistake}", place.name);
            wrong.extend(place.pictures.iter().filter_map(GuidePicture::mistake).map(of));
            if !place.hours.is_empty() {
                wrong.extend(crate::hours::mistake(&place.hours).map(of));
            }
            let is_recording = crate::is_beside(&place.sound) && place.sound.to_ascii_lowercase().ends_with(".ogg");
            if !(place.sound.is_empty() || is_recording) {
                wrong.push(of(format!("the sound `{}` must be an .ogg in or below the guide's folder", place.sound)));
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

/// Words in the first of some languages that there are any in, else in any.
fn first_in<'a>(words: &'a BTreeMap<String, String>, languages: &[&str]) -> Option<&'a str> {
    let first = languages.iter().find_map(|language| words.get(*language));
    first.or_else(|| words.values().next()).map(String::as_str)
}

impl GuidePicture {
    /// What it shows, in the first of some languages that there is one in, else in any.
    #[must_use]
    pub fn caption_in(&self, languages: &[&str]) -> &str {
        first_in(&self.caption, languages).unwrap_or("")
    }

    /// Whose it is, in the same way.
    #[must_use]
    pub fn credit_in(&self, languages: &[&str]) -> &str {
        first_in(&self.credit, languages).unwrap_or("")
    }
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
        first_in(&self.text, languages)
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
    fn pictures_are_credited_and_lie_where_they_may() {
        let text = r#"(places: [(
            name: "A",
            hours: "Tu-Su 10:00-18:00",
            sound: "organ.ogg",
            pictures: [
                (file: "a/tower.webp", caption: {"en": "The tower", "cs": "Věž"}, credit: {"en": "Own work, CC0"}),
                (file: "https://example.org/a.jpg", credit: {"en": "Somebody, CC BY 4.0"}),
                (file: "http://example.org/a.jpg", credit: {"en": "x"}),
                (file: "../a.png", credit: {"en": "x"}),
                (file: "a.gif", credit: {"en": "x"}),
                (file: "b.png", credit: {}),
            ],
        ), (name: "B", hours: "Tuesday", sound: "x.mp3")])"#;
        let guide: Guide = crate::file::parse(text, "t.guide.ron").unwrap_or_else(|e| panic!("{e}"));
        let wrong = guide.validate();
        for told in ["`http://example.org/a.jpg`", "`../a.png`", "`a.gif`", "`b.png` has no credit", "`Tuesday`", "`x.mp3`"] {
            assert!(wrong.iter().any(|wrong| wrong.contains(told)), "{told}: {wrong:#?}");
        }
        assert_eq!(wrong.len(), 6, "{wrong:#?}");
        let picture = &guide.places[0].pictures[0];
        assert_eq!((picture.caption_in(&["cs", "en"]), picture.credit_in(&["cs", "en"])), ("Věž", "Own work, CC0"));
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
