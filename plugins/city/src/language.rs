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

/// The languages that have a code of two letters (ISO 639-1).
const KNOWN: &str = "aa ab ae af ak am an ar as av ay az ba be bg bh bi bm bn bo br bs ca ce ch co cr cs cu cv cy da de dv dz ee el en eo es et eu \
    fa ff fi fj fo fr fy ga gd gl gn gu gv ha he hi ho hr ht hu hy hz ia id ie ig ii ik io is it iu ja jv ka kg ki kj kk kl km kn ko kr ks ku kv kw \
    ky la lb lg li ln lo lt lu lv mg mh mi mk ml mn mr ms mt my na nb nd ne ng nl nn no nr nv ny oc oj om or os pa pi pl ps pt qu rm rn ro ru rw sa \
    sc sd se sg sh si sk sl sm sn so sq sr ss st su sv sw ta te tg th ti tk tl tn to tr ts tt tw ty ug uk ur uz ve vi vo wa wo xh yi yo za zh zu";

/// Whether a code of two letters is a language's; codes of three letters are taken for one.
#[must_use]
pub fn is_known_language(code: &str) -> bool {
    let language = code.split('-').next().unwrap_or_default();
    language.len() != 2 || KNOWN.split_whitespace().any(|known| known == language)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn languages_are_known_by_their_codes() {
        assert_eq!(KNOWN.split_whitespace().filter(|code| code.len() == 2).count(), KNOWN.split_whitespace().count());
        assert!(
            ["en", "cs", "it", "pt-BR", "haw"].into_iter().all(is_known_language)
                && !is_known_language("xx")
                && !is_known_language("qq")
        );
    }

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
