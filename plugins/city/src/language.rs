//! Codes of languages, as translations are told by.

/// What people write for a language, and its code (ISO 639-1).
const MEANT: [(&str, &str); 24] = [
    ("cz", "cs"),
    ("cze", "cs"),
    ("czech", "cs"),
    ("english", "en"),
    ("eng", "en"),
    ("gb", "en"),
    ("uk-en", "en"),
    ("us", "en"),
    ("italian", "it"),
    ("ita", "it"),
    ("german", "de"),
    ("ger", "de"),
    ("at", "de"),
    ("french", "fr"),
    ("fre", "fr"),
    ("spanish", "es"),
    ("dk", "da"),
    ("gr", "el"),
    ("jp", "ja"),
    ("cn", "zh"),
    ("kr", "ko"),
    ("ua", "uk"),
    ("si", "sl"),
    ("ee", "et"),
];

/// What is wrong with a language's code, in words; `None` if it is of the form of one: two or three small letters, with a region or
/// script after a hyphen where that matters.
#[must_use]
pub fn language_mistake(code: &str) -> Option<String> {
    let small = code.to_lowercase();
    if let Some((_, meant)) = MEANT.iter().find(|(written, _)| *written == small) {
        return Some(format!("\"{code}\" is no language's code; write \"{meant}\""));
    }
    let mut parts = code.split('-');
    let language = parts.next().unwrap_or_default();
    let is_code = (2..=3).contains(&language.len()) && language.bytes().all(|b| b.is_ascii_lowercase());
    if is_code && parts.all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_alphanumeric())) {
        return None;
    }
    Some(format!("\"{code}\" is no language's code; write two small letters, as \"en\", \"cs\" or \"it\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_told_from_what_people_write() {
        for code in ["en", "cs", "it", "haw", "zh-Hant", "pt-BR"] {
            assert_eq!(language_mistake(code), None, "{code}");
        }
        for (code, meant) in
            [("cz", "\"cs\""), ("English", "\"en\""), ("EN", "small letters"), ("", "small letters"), ("deutsch", "letters")]
        {
            assert!(language_mistake(code).is_some_and(|words| words.contains(meant)), "{code}");
        }
    }
}
