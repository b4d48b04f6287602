//! What is wrong with a RON text and what to do, in words for somebody who has never seen RON.

use ron::error::Error;

use crate::tour_text::syntax::{Trivia, is_space, last_scalar, trivia, unclosed};

/// A mistake: the byte to point at, and what to say. The reader tells where it stood before and after its last move.
pub(super) fn advice(error: &Error, text: &str, start: usize, end: usize) -> (usize, String) {
    let moved = trivia(text, start..end.max(start)).iter().map(|piece| piece.range().len()).sum::<usize>();
    // What a reader of ours says is of the value that it has just read, not of what comes after it.
    let is_ours = matches!(error, Error::Message(_));
    let at = if start + moved == end && !is_ours { end } else { start };
    let found = text[at..].chars().next();
    if let Some(message) = found.and_then(|found| other_bracket(text, at, found)) {
        return (at, message);
    }
    if let Some(quote @ ('“' | '”' | '„' | '‘' | '’' | '«' | '»' | '‚' | '`')) = found {
        return (at, format!("the quotation mark {quote} is a printer's; write the straight one of the keyboard, \""));
    }
    if text[at..].starts_with('=') {
        return (at, "between a field's name and its value stands `:`, not `=`".to_owned());
    }
    let message = match error {
        Error::ExpectedComma => return comma(text, at),
        Error::Eof | Error::UnclosedBlockComment => return cut_off(error, text, at),
        Error::ExpectedStringEnd => "a text begins here with `\"` and never ends; put another `\"` where it does".to_owned(),
        Error::ExpectedArray => {
            format!("a list is wanted here, in square brackets even if it has one item: [ … ]{}", instead(found))
        }
        Error::ExpectedMap => {
            format!("pairs are wanted here, in curly brackets: {{\"cs\": \"…\", \"it\": \"…\"}}{}", instead(found))
        }
        Error::ExpectedMapColon => format!("`:` is wanted here, between a name and its value{}", instead(found)),
        Error::ExpectedArrayEnd => format!("`]` is wanted here, at the list's end{}", instead(found)),
        Error::ExpectedMapEnd => format!("`}}` is wanted here, at the end of the pairs{}", instead(found)),
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => format!("`)` is wanted here{}", instead(found)),
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => {
            format!("`(` is wanted here: fields and coordinates stand in round brackets{}", instead(found))
        }
        Error::ExpectedString => format!("a text is wanted here, in straight quotation marks: \"…\"{}", instead(found)),
        Error::ExpectedFloat => format!("a number is wanted here, without quotation marks or a unit{}", instead(found)),
        Error::ExpectedInteger | Error::IntegerOutOfBounds | Error::InvalidIntegerDigit { .. } => {
            format!("a whole number within its range is wanted here{}", instead(found))
        }
        Error::ExpectedBoolean => format!("`true` or `false` is wanted here{}", instead(found)),
        Error::ExpectedIdentifier => return (at, identifier(text, at, found)),
        Error::InvalidEscape(_) => "within quotation marks `\\` begins a sign; write it twice, \\\\, for itself".to_owned(),
        Error::NoSuchStructField { expected, found, .. } => return (at, no_field(text, at, expected, found)),
        Error::NoSuchEnumVariant { expected, found, outer } => {
            let names = names(expected, found);
            match outer.as_deref() {
                Some("Where") => {
                    format!("`{found}` is no spot; a place's name stands as Place(\"{found}\"), metres as At(12.5, -3)")
                }
                _ => format!("`{found}` is not known here{names}"),
            }
        }
        Error::MissingStructField { field, .. } => format!("`{field}` is missing; write `{field}: …` before the closing bracket"),
        Error::DuplicateStructField { field, .. } => format!("`{field}` stands there twice; take one away"),
        Error::ExpectedDifferentLength { expected, found } => format!("{expected} is wanted, and {found} are given"),
        Error::SuggestRawIdentifier(word) if word.starts_with(|c: char| !c.is_alphabetic()) => {
            return (at, identifier(text, at, found));
        }
        Error::SuggestRawIdentifier(word) => format!("`{word}` is neither a name nor a number"),
        Error::TrailingCharacters => "nothing may follow here: is a bracket closed too early, or once too often?".to_owned(),
        Error::UnexpectedChar('/') => "a comment begins with `//`".to_owned(),
        Error::UnexpectedChar(c) => format!("`{c}` does not belong here"),
        other => other.to_string(),
    };
    (at, message)
}

/// What stands there instead, if it can be shown.
fn instead(found: Option<char>) -> String {
    match found {
        Some(c) if !c.is_control() && !c.is_whitespace() => format!("; `{c}` stands there"),
        _ => String::new(),
    }
}

/// A missing comma, pointed at where it should be; or what only looks like one.
fn comma(text: &str, at: usize) -> (usize, String) {
    let before = trivia(text, 0..at);
    let end = before.iter().rev().map(Trivia::range).fold(at, |end, range| if range.end == end { range.start } else { end });
    if let Some(start) = last_scalar(text, end).filter(|&start| text[start..].starts_with('"') && text[start..end].contains('\n')) {
        return (start, "the text that begins here has no end in its line; put a `\"` there".to_owned());
    }
    let word: String = text[at..].chars().take_while(|c| c.is_alphanumeric() || matches!(c, '°' | '/' | '%')).collect();
    let number = text[..at].len() - text[..at].trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
    if end == at && number > 0 && !word.is_empty() {
        let number = &text[at - number..at];
        let message = format!("a number stands alone, as its field says the unit: `{number}`, not `{number}{word}`");
        return (at - number.len(), message);
    }
    (end, "a comma is missing here, before what follows".to_owned())
}

/// That a closing bracket is not that of what is open.
fn other_bracket(text: &str, at: usize, found: char) -> Option<String> {
    let meant = match found {
        ')' => '(',
        ']' => '[',
        '}' => '{',
        _ => return None,
    };
    let &(open, bracket) = unclosed(&text[..at]).last()?;
    let line = text[..open].matches('\n').count() + 1;
    (bracket != meant)
        .then(|| format!("`{found}` does not close the `{bracket}` of line {line}: is a bracket missing, or another one meant?"))
}

/// A text that ends within something: what is open is said.
fn cut_off(error: &Error, text: &str, at: usize) -> (usize, String) {
    match unclosed(text).last() {
        Some(&(open, bracket)) if *error == Error::Eof => {
            let closing = match bracket {
                '(' => ')',
                '[' => ']',
                _ => '}',
            };
            (open, format!("this `{bracket}` is never closed; put a `{closing}` where it ends"))
        }
        _ if *error == Error::UnclosedBlockComment => {
            (at, "the comment that begins with `/*` never ends; put `*/` where it does".to_owned())
        }
        _ => (at, "the text ends before it is complete".to_owned()),
    }
}

/// A name is wanted, and something else stands there.
fn identifier(text: &str, at: usize, found: Option<char>) -> String {
    let before = text[..at].trim_end();
    let follows_number = before.strip_suffix(',').is_some_and(|number| number.ends_with(|c: char| c.is_ascii_digit()));
    match found {
        Some('0'..='9') if follows_number => "a name is wanted here; with decimals, a point parts them: 1.5, not 1,5".to_owned(),
        Some('0'..='9' | '(' | '-' | '+' | '.') => {
            "a name is wanted here, with its value after `:`; a spot in metres stands as At(12.5, -3)".to_owned()
        }
        Some('#') => "a name is wanted here; `#` stands there: a comment begins with `//`".to_owned(),
        Some('"') => "a name without quotation marks is wanted here; a place stands as Place(\"…\")".to_owned(),
        Some('[') => "one value is wanted here, not a list".to_owned(),
        found => format!("a name is wanted here{}", instead(found)),
    }
}

fn no_field(text: &str, at: usize, expected: &[&str], found: &str) -> String {
    // The reader stands before the name, or after it.
    let rest = text[at..].trim_start_matches(is_space);
    let rest = rest.strip_prefix(found).unwrap_or(rest).trim_start_matches(is_space);
    if rest.starts_with('(') {
        return format!("`{found}(…)` stands among fields: the `)` that ends what comes before it is missing");
    }
    let but = match found.rsplit_once('_') {
        None => expected.iter().find(|name| name.rsplit_once('_').is_some_and(|(stem, _)| stem == found)),
        Some(_) => None,
    };
    match but {
        Some(name) => format!("there is no field `{found}` here; with its unit it is `{name}`"),
        None => format!("there is no field `{found}` here{}", names(expected, found)),
    }
}

/// What is meant if it is alike, and else all that is known.
fn names(expected: &[&str], found: &str) -> String {
    let near = expected.iter().map(|name| (distance(name, found), name)).min();
    match near {
        Some((apart, name)) if apart <= 1 + found.chars().count() / 4 => format!("; did you mean `{name}`?"),
        _ if expected.is_empty() => String::new(),
        _ => format!("; known are {}", expected.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")),
    }
}

/// Letters to be changed, put in or taken out to make one word of another, whatever their case (Levenshtein 1966).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.to_lowercase().chars().enumerate() {
        let mut corner = i;
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let changed = corner + usize::from(x != *y);
            corner = row[j + 1];
            row[j + 1] = changed.min(corner + 1).min(row[j] + 1);
        }
    }
    row.last().copied().unwrap_or(0)
}
