//! Names that are not known: what is meant by them.

/// What people write for a step, and the step.
const STEPS: [(&str, &str); 26] = [
    ("pause", "Wait"),
    ("stay", "Wait"),
    ("sleep", "Wait"),
    ("delay", "Wait"),
    ("goto", "Walk"),
    ("go", "Walk"),
    ("move", "Walk"),
    ("run", "Walk"),
    ("walkto", "Walk"),
    ("flyto", "Fly"),
    ("turn", "Look"),
    ("lookat", "Look"),
    ("teleport", "Cut"),
    ("jump", "Cut"),
    ("text", "Say"),
    ("caption", "Say"),
    ("speak", "Narrate"),
    ("voice", "Narrate"),
    ("audio", "Sound"),
    ("music", "Sound"),
    ("play", "Sound"),
    ("image", "Picture"),
    ("photo", "Picture"),
    ("zoom", "Fov"),
    ("hour", "Time"),
    ("weather", "Rain"),
];

/// What people write for a field, and the field; the first of these that is known where they wrote it is meant.
const FIELDS: [(&str, &[&str]); 26] = [
    ("duration", &["seconds"]),
    ("time", &["hour", "seconds"]),
    ("time_s", &["seconds"]),
    ("length", &["seconds"]),
    ("angle", &["deg", "pitch_deg"]),
    ("degrees", &["deg"]),
    ("value", &["deg", "hour", "wet", "seconds", "text"]),
    ("fov", &["fov_deg", "deg"]),
    ("fov_deg", &["deg"]),
    ("heading", &["deg", "look"]),
    ("direction", &["deg", "look"]),
    ("amount", &["wet"]),
    ("name", &["title", "text", "file"]),
    ("caption", &["text", "title"]),
    ("message", &["text"]),
    ("words", &["text"]),
    ("place", &["to", "at"]),
    ("where", &["to", "at"]),
    ("at", &["to"]),
    ("to", &["at"]),
    ("target", &["to", "at"]),
    ("points", &["through", "via", "keys"]),
    ("path", &["file", "through"]),
    ("picture", &["file"]),
    ("sound", &["file"]),
    ("map", &["city"]),
];

/// What is meant by a name if that is known or if it is alike, and else all that is known.
pub(super) fn names(expected: &[&str], found: &str) -> String {
    if let Some(meant) = known_as(expected, found) {
        return format!("; did you mean `{meant}`?");
    }
    match expected {
        [] => String::new(),
        [one] => format!("; only `{one}` is known"),
        _ => format!("; known are {}", expected.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")),
    }
}

/// The known name that is meant by another, if one is.
pub(super) fn known_as<'a>(expected: &[&'a str], found: &str) -> Option<&'a str> {
    let near = expected.iter().map(|name| (distance(name, found), *name)).min();
    near.filter(|(apart, _)| *apart <= 1 + found.chars().count() / 4).map(|(_, name)| name).or_else(|| synonym(expected, found))
}

fn synonym<'a>(expected: &[&'a str], found: &str) -> Option<&'a str> {
    let plain: String = found.to_lowercase().chars().filter(|c| *c != '_').collect();
    let step = STEPS.iter().filter(|(written, _)| *written == plain).map(|(_, meant)| *meant);
    let small = found.to_lowercase();
    let field = FIELDS.iter().filter(|(written, _)| *written == small).flat_map(|(_, meant)| meant.iter().copied());
    step.chain(field).find_map(|meant| expected.iter().find(|known| **known == meant).copied())
}

/// Letters to be changed, put in, taken out or swapped with their neighbours to make one word of another, whatever their case (optimal string
/// alignment).
pub(super) fn distance(a: &str, b: &str) -> usize {
    let letters = |word: &str| word.to_lowercase().chars().take(64).collect::<Vec<char>>();
    let (a, b) = (letters(a), letters(b));
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let changed = last[j] + usize::from(x != y);
            let mut least = changed.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *x == b[j - 1] && a[i - 1] == *y {
                least = least.min(before_last[j - 1] + 1);
            }
            row.push(least);
        }
        before_last = core::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_meant_is_told_and_else_what_is_known() {
        let wait: &[&str] = &["seconds"];
        assert_eq!(names(wait, "second"), "; did you mean `seconds`?");
        assert_eq!(names(wait, "duration"), "; did you mean `seconds`?");
        assert_eq!(names(wait, "colour"), "; only `seconds` is known");
        assert_eq!(names(&["Fov", "Fly"], "fvo"), "; did you mean `Fov`?", "two letters swapped are one slip");
        assert_eq!(names(&["Walk", "Wait"], "Pause"), "; did you mean `Wait`?");
        assert_eq!(names(&["Walk", "Wait"], "Sing"), "; known are `Walk`, `Wait`");
        assert_eq!(names(&["hour", "seconds"], "time"), "; did you mean `hour`?");
    }
}
