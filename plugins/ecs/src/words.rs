use std::borrow::Cow;
use std::collections::BTreeMap;

use bevy::prelude::*;
use fluent_bundle::concurrent::FluentBundle;
use fluent_bundle::{FluentArgs, FluentResource, FluentValue};
use unic_langid::LanguageIdentifier;

/// What interfaces say, in the visitor's language: messages of [Fluent](https://projectfluent.org) files, which every plugin brings
/// for itself.
///
/// A message that the visitor's language lacks is said in English, and one that English lacks by its name, so that it is seen.
///
/// ```
/// use veduta_ecs::Words;
///
/// let mut words = Words::default();
/// words.add("en", "left = { $metres } m left").expect("no mistakes");
/// words.add("it", "left = ancora { $metres } m").expect("no mistakes");
/// words.speak("it");
/// assert_eq!(words.say_with("left", &[("metres", 40.into())]), "ancora 40 m");
/// ```
#[derive(Resource, Default)]
pub struct Words {
    language: String,
    bundles: BTreeMap<String, FluentBundle<FluentResource>>,
}

/// What is said where a language has no word for it.
const FALLBACK: &str = "en";

/// Languages that write a point where others write a comma.
const POINTED: [&str; 6] = ["en", "he", "ja", "ko", "th", "zh"];

/// A number or text that stands in a message.
pub type WordsValue = FluentValue<'static>;

/// Messages that could not be added.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("words in `{language}`: {message}")]
pub struct WordsError {
    /// Code of the language.
    pub language: String,
    /// What is wrong.
    pub message: String,
}

impl Words {
    /// Adds messages in a language, told by its code (`en`, `cs`, `it`). What was there under the same names is said anew.
    ///
    /// # Errors
    /// If the code is none or a message cannot be read; what can be read is added.
    pub fn add(&mut self, language: &str, messages: &str) -> Result<(), WordsError> {
        let wrong = |message: String| WordsError { language: language.to_owned(), message };
        let code: LanguageIdentifier = language.parse().map_err(|_| wrong("that is no code of a language".to_owned()))?;
        let bundle = self.bundles.entry(language.to_owned()).or_insert_with(|| {
            let mut bundle = FluentBundle::new_concurrent(vec![code]);
            // Marks that isolate directions of writing have no picture in many fonts.
            bundle.set_use_isolating(false);
            bundle
        });
        let (resource, mistakes) = match FluentResource::try_new(messages.to_owned()) {
            Ok(resource) => (resource, Vec::new()),
            Err((resource, mistakes)) => (resource, mistakes),
        };
        bundle.add_resource_overriding(resource);
        match mistakes.first() {
            None => Ok(()),
            Some(mistake) => {
                let line = messages.get(..mistake.pos.start).map_or(1, |before| before.lines().count().max(1));
                Err(wrong(format!("line {line}: {mistake}")))
            }
        }
    }

    /// Adds what a plugin brings: languages and their messages.
    ///
    /// # Panics
    /// If they have mistakes: they are part of the program.
    pub fn bring(app: &mut App, files: &[(&str, &str)]) {
        let mut words = app.world_mut().get_resource_or_init::<Self>();
        for (language, messages) in files {
            words.add(language, messages).unwrap_or_else(|mistake| panic!("{mistake}"));
        }
    }

    /// Codes of the languages that there are.
    pub fn languages(&self) -> impl Iterator<Item = &str> {
        self.bundles.keys().map(String::as_str)
    }

    /// Code of the language that is spoken.
    #[must_use]
    pub fn language(&self) -> &str {
        if self.language.is_empty() { FALLBACK } else { &self.language }
    }

    /// Speaks a language from now on; one that is not there is spoken once it comes, and English till then.
    pub fn speak(&mut self, language: &str) {
        language.clone_into(&mut self.language);
    }

    /// The languages to look for in texts, first the visitor's.
    #[must_use]
    pub fn preferred(&self) -> [&str; 2] {
        [self.language(), FALLBACK]
    }

    /// A message.
    #[must_use]
    pub fn say(&self, message: &str) -> String {
        self.say_with(message, &[])
    }

    /// A message with values.
    #[must_use]
    pub fn say_with(&self, message: &str, values: &[(&str, WordsValue)]) -> String {
        let args: FluentArgs<'_> = values.iter().map(|(name, value)| (Cow::Borrowed(*name), value.clone())).collect();
        for language in self.preferred() {
            let Some(bundle) = self.bundles.get(language) else { continue };
            let Some(pattern) = bundle.get_message(message).and_then(|found| found.value()) else { continue };
            let mut mistakes = Vec::new();
            let said = bundle.format_pattern(pattern, Some(&args), &mut mistakes);
            if mistakes.is_empty() {
                return said.into_owned();
            }
        }
        message.to_owned()
    }

    /// A message without values in a language of its own; `None` where it has none.
    #[must_use]
    pub fn said_in(&self, language: &str, message: &str) -> Option<String> {
        let bundle = self.bundles.get(language)?;
        let pattern = bundle.get_message(message)?.value()?;
        let mut mistakes = Vec::new();
        let said = bundle.format_pattern(pattern, None, &mut mistakes);
        mistakes.is_empty().then(|| said.into_owned())
    }

    /// A number with so many digits after the point, or comma, as the visitor's language writes it.
    #[must_use]
    pub fn number(&self, value: f64, digits: usize) -> String {
        let plain = format!("{value:.digits$}");
        if POINTED.contains(&self.language()) { plain } else { plain.replace('.', ",") }
    }

    /// Whether a language has a message of its own.
    #[must_use]
    pub fn has(&self, language: &str, message: &str) -> bool {
        self.bundles.get(language).is_some_and(|bundle| bundle.has_message(message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_language_lacks_is_said_in_english_and_else_by_name() {
        let mut words = Words::default();
        words.add("en", "map = Map\nhelp = Help").expect("no mistakes");
        words.add("cs", "map = Mapa").expect("no mistakes");
        assert_eq!(words.say("map"), "Map");
        words.speak("cs");
        assert_eq!([words.say("map"), words.say("help"), words.say("lost")], ["Mapa", "Help", "lost"]);
        words.speak("eo");
        assert_eq!(words.say("map"), "Map", "a language that is not there");
        assert_eq!(words.languages().collect::<Vec<_>>(), ["cs", "en"]);
    }

    #[test]
    fn czech_numbers_have_their_three_forms() {
        let mut words = Words::default();
        words
            .add("cs", "minutes = { $n ->\n    [one] { $n } minuta\n    [few] { $n } minuty\n   *[other] { $n } minut\n}")
            .expect("no mistakes");
        words.speak("cs");
        let say = |n: u32| words.say_with("minutes", &[("n", n.into())]);
        assert_eq!([say(1), say(3), say(7)], ["1 minuta", "3 minuty", "7 minut"]);
    }

    #[test]
    fn numbers_are_written_as_the_language_does() {
        let mut words = Words::default();
        assert_eq!(words.number(1.25, 1), "1.2");
        words.speak("cs");
        assert_eq!([words.number(1.25, 1), words.number(40.4, 0)], ["1,2", "40"]);
    }

    #[test]
    fn mistakes_are_told_with_their_line_and_the_rest_is_kept() {
        let mut words = Words::default();
        let told = words.add("en", "good = Good\nbad = {\nalso = Also").expect_err("a brace is open").to_string();
        assert!(told.contains("`en`") && told.contains("line 2") || told.contains("line 3"), "{told}");
        assert_eq!(words.say("good"), "Good");
        assert!(words.add("not a code", "").is_err());
    }

    #[test]
    fn a_message_without_its_values_is_told_by_name() {
        let mut words = Words::default();
        words.add("en", "left = { $metres } m").expect("no mistakes");
        assert_eq!(words.say("left"), "left");
    }
}
