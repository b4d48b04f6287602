//! What is wrong with a RON text and what to do, in words for somebody who has never seen RON.

use ron::error::Error;

use crate::tour_text::syntax::{Trivia, is_space, last_scalar, trivia, unclosed};
use around::{Around, is_of_word, last_word};
use words::{known_as, names};

mod around;
mod number;
#[cfg(test)]
mod tests;
mod tour;
mod whole;
mod words;

/// A mistake: the byte to point at, and what to say. The reader tells where it stood before and after its last move.
pub(super) fn advice(error: &Error, text: &str, (start, end): (usize, usize), is_tour: bool) -> (usize, String) {
    let moved = trivia(text, start..end.max(start)).iter().map(|piece| piece.range().len()).sum::<usize>();
    // What a reader of ours says is of the value that it has just read, not of what comes after it.
    let is_ours = matches!(error, Error::Message(_));
    let at = if start + moved == end && !is_ours { end } else { start };
    if let Some(told) = whole::whole(text, is_tour) {
        return told;
    }
    let here = Around::new(text, at);
    other_bracket(&here).or_else(|| sign(&here)).unwrap_or_else(|| of_error(error, &here))
}

/// A sign that never stands in RON where the reader is, whatever it wanted.
fn sign(here: &Around<'_>) -> Option<(usize, String)> {
    let found = here.found()?;
    let message = match found {
        '“' | '”' | '„' | '‘' | '’' | '«' | '»' | '‚' | '`' => {
            format!("the quotation mark {found} is a printer's; write the straight one of the keyboard, \"")
        }
        '−' | '–' | '—' if here.rest()[found.len_utf8()..].starts_with(|c: char| c.is_ascii_digit()) => {
            format!("the dash {found} is a printer's; write the minus sign of the keyboard, -")
        }
        '，' | '、' | '；' => format!("the comma {found} is of another script; write the one of the keyboard, `,`"),
        '：' => "the colon ： is of another script; write the one of the keyboard, `:`".to_owned(),
        '（' | '）' => format!("the bracket {found} is of another script; write the one of the keyboard"),
        ';' => "between fields and steps stands a comma, not `;`".to_owned(),
        '=' => "between a field's name and its value stands `:`, not `=`".to_owned(),
        c if c.is_whitespace() && !is_space(c) => {
            "a space of another kind stands here, as word processors and web pages write it; put a plain one in its place"
                .to_owned()
        }
        '\u{200b}' | '\u{feff}' => "an invisible sign stands here, as web pages have it; take it away".to_owned(),
        _ => return None,
    };
    Some((here.at, message))
}

/// What the reader wanted, and what stands there.
fn of_error(error: &Error, here: &Around<'_>) -> (usize, String) {
    let (text, at) = (here.text, here.at);
    let message = match error {
        Error::ExpectedComma => return comma(here),
        Error::Eof | Error::UnclosedBlockComment => return cut_off(error, text, at),
        Error::ExpectedStringEnd => "a text begins here with `\"` and never ends; put another `\"` where it does".to_owned(),
        Error::ExpectedArray => no_list(here),
        Error::ExpectedMap => {
            format!("pairs are wanted here, in curly brackets: {{\"cs\": \"…\", \"it\": \"…\"}}{}", instead(here))
        }
        Error::ExpectedMapColon => tour::named(here)
            .unwrap_or_else(|| format!("`:` is wanted here, between a field's name and its value{}", instead(here))),
        Error::ExpectedArrayEnd => format!("`]` is wanted here, at the list's end{}", instead(here)),
        Error::ExpectedMapEnd => format!("`}}` is wanted here, at the end of the pairs{}", instead(here)),
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => not_ended(here),
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => no_bracket(here),
        Error::ExpectedDifferentStructName { expected, found } => {
            format!("round brackets are wanted here, with or without `{expected}` before them; `{found}` stands there")
        }
        Error::ExpectedString => no_text(here),
        Error::ExpectedFloat => number::no_number(here),
        Error::ExpectedInteger | Error::IntegerOutOfBounds | Error::InvalidIntegerDigit { .. } => {
            format!("a whole number within its range is wanted here{}", instead(here))
        }
        Error::ExpectedBoolean => format!("`true` or `false` is wanted here{}", instead(here)),
        Error::ExpectedIdentifier => identifier(here),
        Error::InvalidEscape(_) => return escape(here),
        Error::NoSuchStructField { expected, found, .. } => return (field_at(here, found), no_field(here, expected, found)),
        Error::NoSuchEnumVariant { expected, found, outer } => no_variant(here, expected, found, outer.as_deref()),
        Error::MissingStructField { field, outer } => missing_field(here, field, outer.as_deref()),
        Error::DuplicateStructField { field, .. } => format!("`{field}` stands there twice; take one away"),
        Error::ExpectedDifferentLength { expected, found } => different_length(here, expected, *found),
        Error::SuggestRawIdentifier(word) if word.starts_with(|c: char| !c.is_alphabetic()) => identifier(here),
        Error::SuggestRawIdentifier(word) | Error::InvalidIdentifier(word) => match word.replace('-', "_") {
            joined if joined != *word => format!("words are joined by `_`: write `{joined}`, not `{word}`"),
            _ => format!("`{word}` is neither a name nor a number"),
        },
        Error::TrailingCharacters if here.found() == Some('(') => {
            "nothing may follow here, and another `(` does: a file tells one thing, and a bracket closed too early ends it"
                .to_owned()
        }
        Error::TrailingCharacters => "nothing may follow here: is a bracket closed too early, or once too often?".to_owned(),
        Error::UnexpectedChar('/') => "a comment begins with `//`".to_owned(),
        Error::UnexpectedChar(c) => return number::unexpected(here, *c),
        other => other.to_string(),
    };
    (at, message)
}

/// What stands there instead, if it can be shown.
fn instead(here: &Around<'_>) -> String {
    match (here.thing(), here.found()) {
        (thing, Some(_)) if !thing.is_empty() && thing.chars().count() <= 60 && !thing.contains(char::is_control) => {
            format!("; `{thing}` stands there")
        }
        (_, Some(c)) if !c.is_control() && !c.is_whitespace() => format!("; `{c}` stands there"),
        _ => String::new(),
    }
}

/// A missing comma, pointed at where it should be; or what only looks like one.
fn comma(here: &Around<'_>) -> (usize, String) {
    let (text, at) = (here.text, here.at);
    let before = trivia(text, 0..at);
    let end = before.iter().rev().map(Trivia::range).fold(at, |end, range| if range.end == end { range.start } else { end });
    let last = last_scalar(text, end);
    if let Some(start) = last.filter(|&start| text[start..].starts_with('"') && text[start..end].contains('\n')) {
        return (start, "the text that begins here has no end in its line; put a `\"` there".to_owned());
    }
    if last.is_some_and(|start| text[start..].starts_with('"')) && end == at && here.rest().starts_with(is_of_word) {
        let message = "the text ends at this quotation mark, and more of it follows; within a text write \\\" for a quotation mark";
        return (end - 1, message.to_owned());
    }
    number::with_unit(here, end).unwrap_or_else(|| (end, "a comma is missing here, before what follows".to_owned()))
}

/// That a closing bracket is not that of what is open.
fn other_bracket(here: &Around<'_>) -> Option<(usize, String)> {
    let (text, at, found) = (here.text, here.at, here.found()?);
    let meant = match found {
        ')' => '(',
        ']' => '[',
        '}' => '{',
        _ => return None,
    };
    let open = here.open.last().filter(|open| open.bracket != meant)?;
    let line = text[..open.at].matches('\n').count() + 1;
    let own_line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let is_one_too_many = text[..at].trim_end_matches([' ', ',']).ends_with(')') && unclosed(&text[own_line..at]).is_empty();
    let message = if found == ')' && is_one_too_many {
        format!(
            "one `)` too many: nothing is open here that it could close, but the `{}` of line {line}; take it away",
            open.bracket
        )
    } else {
        format!("`{found}` does not close the `{}` of line {line}: is a bracket missing, or another one meant?", open.bracket)
    };
    Some((at, message))
}

/// A text that ends within something: what is open is said.
fn cut_off(error: &Error, text: &str, at: usize) -> (usize, String) {
    if *error == Error::UnclosedBlockComment {
        let begin = text[..at].rfind("/*").unwrap_or(at);
        return (begin, "the comment that begins with `/*` never ends; put `*/` where it does".to_owned());
    }
    match unclosed(text).last() {
        Some(&(open, bracket)) => (open, format!("this `{bracket}` is never closed; put a `{}` where it ends", closing(bracket))),
        None => (at, "the text ends before it is complete".to_owned()),
    }
}

const fn closing(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// A list is wanted, and something else stands there.
fn no_list(here: &Around<'_>) -> String {
    const WANTED: &str = "a list is wanted here, in square brackets even if it has one item";
    let thing = here.thing();
    match (here.field, here.found()) {
        ("via", Some('(')) if thing.ends_with(')') => format!("{WANTED}: write `[At{thing}]`"),
        ("via", Some('P' | 'A')) if thing.ends_with(')') => format!("{WANTED}: write `[{thing}]`"),
        _ => format!("{WANTED}: [ … ]{}", instead(here)),
    }
}

/// `)` is wanted, and more stands there.
fn not_ended(here: &Around<'_>) -> String {
    match here.name() {
        "At" => format!(
            "At(…) takes two numbers, metres east and north, with a point for decimals: At(12.5, -3); `{}` is too much",
            here.thing()
        ),
        "Place" => format!("the `)` that ends `Place(` is missing before `{}`", here.thing()),
        "" => format!("`)` is wanted here: there are more numbers than a point has{}", instead(here)),
        _ => format!("`)` is wanted here{}", instead(here)),
    }
}

/// `(` is wanted, and something else stands there.
fn no_bracket(here: &Around<'_>) -> String {
    let step = tour::of(last_word(&here.text[..here.at]));
    match (step, here.found()) {
        (Some(step), Some('[' | '{')) => {
            format!("`(` is wanted here: fields stand in round brackets, as in `{}`{}", step.example, instead(here))
        }
        (None, Some('[')) if here.thing().ends_with(']') => {
            format!("`(` is wanted here: coordinates stand in round brackets: write `({})`", here.thing().trim_matches(['[', ']']))
        }
        (Some(step), _) => format!("`(` is wanted here, with the fields of `{}`: write `{}`", step.name, step.example),
        (None, _) => format!("`(` is wanted here: fields and coordinates stand in round brackets{}", instead(here)),
    }
}

/// A text is wanted, and something else stands there.
fn no_text(here: &Around<'_>) -> String {
    const WANTED: &str = "a text is wanted here, in straight quotation marks";
    let thing = here.thing();
    let is_plain = !thing.is_empty() && !thing.contains(['\'', '"', ':', '(', '[', '{']) && !thing.contains(char::is_control);
    match here.found() {
        Some('{') => format!("{WANTED}; those in other languages stand beside it: text: \"…\", translations: {thing}"),
        Some('\'') => format!("{WANTED}, \"…\", not '…'"),
        Some(_) if here.bracket() == Some('{') && here.field.is_empty() => {
            let word: &str = thing.split(':').next().unwrap_or_default().trim();
            format!("the code of a language stands in quotation marks: write \"{word}\": \"…\"")
        }
        Some(_) if here.name() == "Place" && thing.starts_with("name") => {
            "a place's name stands alone, without a field: Place(\"…\")".to_owned()
        }
        Some(_) if is_plain => format!("{WANTED}: write \"{thing}\""),
        _ => format!("{WANTED}: \"…\"{}", instead(here)),
    }
}

/// A name is wanted, and something else stands there.
fn identifier(here: &Around<'_>) -> String {
    let before = here.text[..here.at].trim_end();
    let follows_number = before.strip_suffix(',').is_some_and(|number| number.ends_with(|c: char| c.is_ascii_digit()));
    if let Some(told) = tour::named(here).or_else(|| tour::spelled(here)) {
        return told;
    }
    let thing = here.thing();
    let is_key = |thing: &str| here.rest()[thing.len()..].trim_start().starts_with(':');
    match here.found() {
        Some(',') => "there is one comma too many; take it away".to_owned(),
        Some('0'..='9') if follows_number && here.bracket() == Some('(') => {
            "a name is wanted here; with decimals, a point parts them: 1.5, not 1,5".to_owned()
        }
        Some('#') => "a name is wanted here; `#` stands there: a comment begins with `//`".to_owned(),
        Some('"') if is_key(thing) && here.bracket() == Some('(') => {
            format!("a field's name stands without quotation marks: write `{}: …`", thing.trim_matches('"'))
        }
        Some('-') if tour::is_step(here) => "a step begins with its name; take the dash away".to_owned(),
        Some(_) if tour::is_step(here) => format!("a step is wanted here, such as `Wait(seconds: 3)`{}", instead(here)),
        Some('0'..='9' | '(' | '-' | '+' | '.') => format!("a name is wanted here, with its value after `:`{}", instead(here)),
        Some('"') => format!("a name without quotation marks is wanted here{}", instead(here)),
        Some('[') => "one value is wanted here, not a list".to_owned(),
        _ => format!("a name is wanted here{}", instead(here)),
    }
}

/// A sign that a text does not know after `\`, pointed at.
fn escape(here: &Around<'_>) -> (usize, String) {
    let at = here.rest().find('\\').map_or(here.at, |off| here.at + off);
    let line = here.text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let quote = here.text[line..at].rfind('"').map_or(line, |quote| line + quote);
    let field = Around::new(here.text, quote).field;
    let is_path = matches!(field, "file" | "city" | "files") || here.text[quote..at].ends_with(':');
    let message = if is_path {
        "within quotation marks `\\` begins a sign; in a path write `/` instead, as on every system"
    } else {
        "within quotation marks `\\` begins a sign; write it twice, \\\\, for itself"
    };
    (at, message.to_owned())
}

/// Where an unknown field stands: the reader stands before it, or after it.
fn field_at(here: &Around<'_>, found: &str) -> usize {
    let skipped = here.rest().len() - here.rest().trim_start_matches(is_space).len();
    if here.rest()[skipped..].starts_with(found) { here.at + skipped } else { here.at }
}

fn no_field(here: &Around<'_>, expected: &[&str], found: &str) -> String {
    // The reader stands before the name, or after it.
    let rest = here.rest().trim_start_matches(is_space);
    let rest = rest.strip_prefix(found).unwrap_or(rest).trim_start_matches(is_space);
    if rest.starts_with('(') {
        return format!("`{found}(…)` stands among fields: the `)` that ends what comes before it is missing");
    }
    if let Some((inner, outer)) = tour::belongs_outside(here, found) {
        return format!(
            "there is no field `{found}` in `{inner}`; it belongs to `{outer}`: is the `)` missing before it that ends `{inner}(`?"
        );
    }
    if crate::language_mistake(found).is_none() && expected.contains(&"translations") && found.len() == 2 {
        let own = expected.first().unwrap_or(&"text");
        return format!(
            "there is no field `{found}` here; words in other languages are written translations: {{\"{found}\": \"…\"}}, beside `{own}: \"…\"`"
        );
    }
    match (found, here.name()) {
        ("from", "Walk") => return "there is no field `from` here: a walk begins where the tour stands; to begin elsewhere put `Cut(to: …)` before it".to_owned(),
        ("heading" | "heading_deg" | "deg" | "direction", "Start" | "Cut" | "Walk" | "Fly") => {
            return format!("there is no field `{found}` here; a direction of view is written look: Heading(deg: 90)");
        }
        ("to", "Fly") => return "there is no field `to` here; a flight is told by its points: through: [(x, y, metres above the ground)]".to_owned(),
        ("steps", "Chapter") => return "there is no field `steps` here; a chapter lasts until the next one, and its steps simply follow it".to_owned(),
        _ => {}
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

/// A name that is none of those that may stand there.
fn no_variant(here: &Around<'_>, expected: &[&str], found: &str, outer: Option<&str>) -> String {
    // The reader stands before the name, or after it.
    let before = here.text[..here.at].trim_end_matches(is_space);
    let begin = if here.rest().starts_with(found) { here.at } else { before.len() - last_word(before).len() };
    let whole = Around::new(here.text, begin).thing();
    let whole = if whole.starts_with(found) { whole } else { found };
    match (outer, found) {
        (_, "Some") => format!("what may be left out is written alone, without `Some(…)`{}", unwrapped(whole)),
        (Some("LookAt"), _) if matches!(known_as(&["Place", "At"], found), Some("Place" | "At")) && whole.ends_with(')') => {
            format!("where to look is written `Spot(at: …)`: write `Spot(at: {whole})`")
        }
        (_, "None" | "null" | "nil") => "what is not wanted is left out: take the field away".to_owned(),
        (Some("Where"), "Spot" | "Heading" | "Ahead") => {
            format!("one stands at and goes to a place or metres, Place(\"…\") or At(12.5, -3); `{found}` tells only where to look")
        }
        (Some("Where"), _) => match known_as(expected, found) {
            Some(known) => format!("`{found}` is not known here; did you mean `{known}`?"),
            None if whole.contains(['(', '[', '{']) => {
                format!("`{found}` is no spot; a place is written Place(\"…\"), metres At(12.5, -3)")
            }
            None => format!("`{whole}` is no spot; a place's name stands as Place(\"{whole}\"), metres as At(12.5, -3)"),
        },
        _ => format!("`{found}` is not known here{}", names(expected, found)),
    }
}

fn unwrapped(whole: &str) -> String {
    let inner = whole.strip_prefix("Some(").and_then(|inner| inner.strip_suffix(')'));
    inner.map_or_else(String::new, |inner| format!(": write `{inner}`"))
}

fn missing_field(here: &Around<'_>, field: &str, outer: Option<&str>) -> String {
    let example = outer.or(Some(here.name())).and_then(tour::of).or_else(|| tour::of(here.name()));
    let as_in = example.map_or_else(String::new, |made| format!(", as in `{}`", made.example));
    let value = match field {
        "title" => "\"…\"",
        "city" => "\"town.graph.ron\"",
        "steps" => "[ … ]",
        _ => "…",
    };
    format!("`{field}` is missing; write `{field}: {value}` before the closing bracket{as_in}")
}

/// A tuple of another length than it should have.
fn different_length(here: &Around<'_>, expected: &str, found: usize) -> String {
    let are = if found == 1 { "1 is given".to_owned() } else { format!("{found} are given") };
    let list = here.open.iter().rev().find(|open| open.bracket == '[').map_or("", |open| open.name);
    match (here.name(), list) {
        ("At", _) => format!("At(…) takes two numbers, metres east and north: At(12.5, -3); {are}"),
        ("", "through") => format!("a point of a flight has three numbers, (x, y, metres above the ground); {are}"),
        ("", "keys") => format!("a key of a track has six numbers, (seconds, x, y, height, heading, pitch); {are}"),
        _ => format!("{expected} is wanted, and {are}"),
    }
}
