//! Numbers that are none: with units, as times of the clock, as fractions, in words.

use super::{around::Around, instead};

/// A number is wanted, and something else stands there.
pub(super) fn no_number(here: &Around<'_>) -> String {
    let thing = here.thing();
    let plain = thing.trim_matches('"');
    if let Some(inner) = thing.strip_prefix("Some(") {
        return format!("the number stands alone, without `Some(…)`: write `{}`", inner.trim_end_matches(')'));
    }
    if matches!(thing, "null" | "None" | "nil" | "none" | "undefined") {
        return format!("a number is wanted here, and `{thing}` is none; what is not wanted is left out, field and all");
    }
    if let Some(told) = clock(here, plain) {
        return told;
    }
    if here.name() == "At" && thing.starts_with(['(', '[']) {
        return format!(
            "At(…) takes two numbers without more brackets, metres east and north: write `At({})`",
            thing.trim_matches(['(', '[', ')', ']'])
        );
    }
    if here.name() == "At" {
        return format!("At(…) takes two numbers without names, metres east and north: At(12.5, -3){}", instead(here));
    }
    let number = plain[..plain.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).unwrap_or(plain.len())].trim();
    if number.parse::<f64>().is_ok() && number != thing {
        return format!("a number is wanted here, without quotation marks or a unit: write `{number}`");
    }
    format!("a number is wanted here, without quotation marks or a unit{}", instead(here))
}

/// A time of the clock, as people write it: `12:00`, `5pm`.
fn clock(here: &Around<'_>, plain: &str) -> Option<String> {
    if !matches!(here.field, "hour") {
        return None;
    }
    let hour = hour_of(plain)?;
    Some(format!("hours are decimal, from 0 to 24: half past five in the afternoon is 17.5; write `{hour}`, not `{plain}`"))
}

/// The decimal hour that a person's way to write it means.
fn hour_of(written: &str) -> Option<f64> {
    let small = written.to_ascii_lowercase().replace([' ', '.'], "");
    let after = if small.ends_with("pm") { 12.0 } else { 0.0 };
    let is_of_twelve = small.ends_with("pm") || small.ends_with("am");
    let digits = if is_of_twelve { &small[..small.len() - 2] } else { small.trim_end_matches('h') };
    let (hours, minutes) = digits.split_once([':', 'h']).unwrap_or((digits, "0"));
    let (hours, minutes): (f64, f64) = (hours.parse().ok()?, minutes.parse().ok()?);
    if !(0.0..=24.0).contains(&hours) || !(0.0..60.0).contains(&minutes) {
        return None;
    }
    let hours = if is_of_twelve { hours % 12.0 + after } else { hours };
    Some((100.0 * (hours + minutes / 60.0)).round() / 100.0)
}

/// A number that something stands at which is none: a unit, or minutes.
pub(super) fn with_unit(here: &Around<'_>, end: usize) -> Option<(usize, String)> {
    let (text, at) = (here.text, here.at);
    let before = text[..end].len() - text[..end].trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
    let start = end - before;
    let follows: String = text[at..].chars().take_while(|c| c.is_alphanumeric() || matches!(c, '°' | '/' | '%' | ':')).collect();
    let (number, field) = (&text[start..end], Around::new(text, start));
    if before == 0 || follows.is_empty() {
        return None;
    }
    if let Some(told) = clock(&field, &format!("{number}{follows}")) {
        return Some((start, told));
    }
    if end != at && (field.field.is_empty() || follows.ends_with(':')) {
        return None;
    }
    let gap = &text[end..at];
    Some((start, format!("a number stands alone, as its field says the unit: `{number}`, not `{number}{gap}{follows}`")))
}

/// A sign that does not belong where it stands: mostly in a number.
pub(super) fn unexpected(here: &Around<'_>, c: char) -> (usize, String) {
    let line = here.text[..here.at].rfind('\n').map_or(0, |newline| newline + 1);
    let of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '/');
    let start = line + here.text[line..here.at].trim_end_matches(of_number).len();
    let rest = &here.text[start..];
    let written = &rest[..rest.find(|c: char| !of_number(c)).unwrap_or(rest.len())];
    let parts = written.split_once('/').and_then(|(over, under)| Some((over.parse::<f64>().ok()?, under.parse::<f64>().ok()?)));
    if let Some((over, under)) = parts.filter(|(_, under)| *under != 0.0) {
        let value = (1000.0 * over / under).round() / 1000.0;
        return (start, format!("numbers are decimal: write `{value}`, not `{written}`"));
    }
    if here.field == "city" || c == '/' {
        return (here.at, "a comment begins with `//`".to_owned());
    }
    (here.at, format!("`{c}` does not belong here"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_the_clock_are_decimal_hours() {
        for (written, hour) in [
            ("12:00", Some(12.0)),
            ("17:30", Some(17.5)),
            ("5pm", Some(17.0)),
            ("12 am", Some(0.0)),
            ("17h15", Some(17.25)),
            ("five", None),
            ("25:00", None),
        ] {
            assert_eq!(hour_of(written), hour, "{written}");
        }
    }
}
