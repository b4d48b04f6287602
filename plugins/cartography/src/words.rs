use fluent_bundle::concurrent::FluentBundle;
use fluent_bundle::{FluentArgs, FluentResource, FluentValue};
use unic_langid::LanguageIdentifier;

/// What is written in a map's margin, by language.
const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

/// What is written in a map's margin, in one language.
pub struct MapWords {
    language: &'static str,
    bundle: FluentBundle<FluentResource>,
}

/// A language that margins are not written in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("maps are not written in `{0}`; there are: en, cs, it")]
pub struct UnknownLanguage(pub String);

impl MapWords {
    /// Codes of the languages that there are.
    pub fn languages() -> impl Iterator<Item = &'static str> {
        WORDS.iter().map(|(code, _)| *code)
    }

    /// In a language, told by its code.
    ///
    /// # Errors
    /// [`UnknownLanguage`] if there are no words in it.
    pub fn of(language: &str) -> Result<Self, UnknownLanguage> {
        let unknown = || UnknownLanguage(language.to_owned());
        let (code, file) = WORDS.iter().find(|(code, _)| *code == language).ok_or_else(unknown)?;
        let id: LanguageIdentifier = code.parse().map_err(|_| unknown())?;
        let mut bundle = FluentBundle::new_concurrent(vec![id]);
        bundle.set_use_isolating(false);
        // What can be read of the file; a test reads all of it.
        let resource = FluentResource::try_new((*file).to_owned()).unwrap_or_else(|(resource, _)| resource);
        bundle.add_resource_overriding(resource);
        Ok(Self { language: code, bundle })
    }

    /// Code of the language.
    #[must_use]
    pub const fn language(&self) -> &'static str {
        self.language
    }

    /// A message; its name where there is none.
    #[must_use]
    pub fn say(&self, message: &str) -> String {
        self.with(message, &FluentArgs::new())
    }

    /// A message about a number. It is written in figures, thousands apart.
    #[must_use]
    pub fn say_number(&self, message: &str, n: u64) -> String {
        let mut args = FluentArgs::new();
        let is_plural = matches!(message, "map-index-more");
        args.set("n", if is_plural { FluentValue::from(n) } else { FluentValue::from(thousands(n)) });
        self.with(message, &args)
    }

    /// A message about somebody who is credited.
    #[must_use]
    pub fn say_credit(&self, message: &str, credit: &str) -> String {
        let mut args = FluentArgs::new();
        args.set("credit", credit);
        self.with(message, &args)
    }

    fn with(&self, message: &str, args: &FluentArgs<'_>) -> String {
        let pattern = self.bundle.get_message(message).and_then(|message| message.value());
        pattern.map_or_else(|| message.to_owned(), |p| self.bundle.format_pattern(p, Some(args), &mut Vec::new()).into_owned())
    }
}

/// A number with narrow spaces between its thousands, as every language here may write it (ISO 31-0).
fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let first = digits.len() % 3;
    let mut parts: Vec<&str> = if first > 0 { vec![&digits[..first]] } else { Vec::new() };
    parts.extend((first..digits.len()).step_by(3).map(|at| &digits[at..at + 3]));
    parts.join("\u{a0}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_says_everything_in_the_same_order() {
        let messages = |file: &str| -> Vec<String> {
            let is_name = |line: &&str| line.starts_with(|c: char| c.is_ascii_lowercase());
            file.lines().filter(is_name).filter_map(|line| line.split_once(" =").map(|(name, _)| name.to_owned())).collect()
        };
        let all = messages(WORDS[0].1);
        for (code, file) in WORDS {
            assert!(FluentResource::try_new(file.to_owned()).is_ok(), "{code}");
            assert_eq!(messages(file), all, "{code}");
        }
    }

    #[test]
    fn numbers_and_plurals_are_as_the_language_has_them() {
        let words = MapWords::of("cs").expect("there is Czech");
        assert_eq!(words.say_number("map-scale", 12_500), "1 : 12\u{a0}500");
        assert_eq!(words.say_number("map-index-more", 3), "3 další jména se sem nevešla");
        assert_eq!(words.say_credit("map-credit", "© OSM"), "Data: © OSM");
        assert_eq!(MapWords::of("tlh").err(), Some(UnknownLanguage("tlh".into())));
        assert_eq!([1, 999, 1_000, 1_234_567].map(thousands), ["1", "999", "1\u{a0}000", "1\u{a0}234\u{a0}567"]);
    }
}
