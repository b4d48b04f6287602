//! Texts that are no RON from their beginning on.

use crate::tour_text::syntax::trivia;

/// A tour as short as it can be.
const SHORTEST: &str = "(title: \"A walk\", city: \"town.graph.ron\", steps: [Start(at: At(0, 0))])";

/// What is wrong with a text as a whole, and the byte to point at.
pub(super) fn whole(text: &str, is_tour: bool) -> Option<(usize, String)> {
    let mut begin = 0;
    for piece in trivia(text, 0..text.len()) {
        if piece.range().start != begin {
            break;
        }
        begin = piece.range().end;
    }
    let rest = &text[begin..];
    let example = if is_tour { format!("; the shortest tour is {SHORTEST}") } else { String::new() };
    if rest.is_empty() {
        return Some((0, format!("there is nothing in this file but space and comments{example}")));
    }
    if rest.starts_with("{\\rtf") {
        return Some((begin, "this is a document of a word processor (RTF); save it as plain text, in UTF-8".to_owned()));
    }
    if rest.starts_with('<') {
        return Some((begin, format!("this is HTML or XML, and RON is wanted{example}")));
    }
    if is_tour && rest.starts_with(['{', '[']) {
        return Some((begin, not_round(rest)));
    }
    let first_line = rest.lines().next().unwrap_or_default();
    if is_tour && first_line.trim_start_matches("---").split(':').next().is_some_and(|word| KEYS.contains(&word.trim())) {
        let is_yaml = rest.lines().any(|line| line.trim_start().starts_with("- "));
        return Some((
            begin,
            if is_yaml {
                format!("this looks like YAML, and a tour is RON, in brackets{example}")
            } else {
                "a tour stands in round brackets: put `(` before this, and `)` at the end of the file".to_owned()
            },
        ));
    }
    None
}

/// What tours begin with.
const KEYS: [&str; 9] = ["title", "translations", "city", "speed", "eye_m", "fov_deg", "hour", "day", "steps"];

fn not_round(rest: &str) -> String {
    let is_json = rest[1..].trim_start().starts_with('"');
    let looks = if is_json {
        "this looks like JSON, and a tour is RON, where names stand without quotation marks and fields in round brackets: "
    } else {
        "a tour stands in round brackets, from `(` to `)`: "
    };
    format!("{looks}{SHORTEST}")
}
