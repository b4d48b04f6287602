//! Where in a text a byte stands: what encloses it, which field it is the value of, and what a person would take for one thing there.

use crate::tour_text::syntax::{is_space, unclosed};

/// A bracket that is open.
#[derive(Debug, Clone, Copy)]
pub(super) struct Open<'a> {
    /// Where it stands.
    pub at: usize,
    pub bracket: char,
    /// The name before a round bracket, or the field whose value a list or map is.
    pub name: &'a str,
}

/// What is around a byte of a text.
#[derive(Debug, Clone)]
pub(super) struct Around<'a> {
    pub text: &'a str,
    pub at: usize,
    /// What is open there, the innermost last.
    pub open: Vec<Open<'a>>,
    /// The field that the byte is the value of; empty if it is none's.
    pub field: &'a str,
}

impl<'a> Around<'a> {
    pub fn new(text: &'a str, at: usize) -> Self {
        let named = |(open, bracket): (usize, char)| {
            let before = &text[..open];
            Open { at: open, bracket, name: if bracket == '(' { last_word(before) } else { field_before(before) } }
        };
        let open = unclosed(&text[..at]).into_iter().map(named).collect();
        Self { text, at, open, field: field_before(&text[..at]) }
    }

    pub fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    pub fn found(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// The name of the innermost bracket.
    pub fn name(&self) -> &'a str {
        self.open.last().map_or("", |open| open.name)
    }

    pub fn bracket(&self) -> Option<char> {
        self.open.last().map(|open| open.bracket)
    }

    /// Whether the byte is the first thing in its bracket.
    pub fn is_first(&self) -> bool {
        self.open.last().is_some_and(|open| self.text[open.at + 1..self.at].trim().is_empty())
    }

    /// What a person would take for one thing here: a quoted text, a name with what its brackets hold, or all up to the next comma,
    /// bracket or line.
    pub fn thing(&self) -> &'a str {
        thing(self.rest())
    }
}

/// The one thing that a text begins with.
fn thing(text: &str) -> &str {
    let line = text.split(['\n', '\r']).next().unwrap_or_default();
    if let Some(quoted) = line.strip_prefix('"') {
        return quoted.find('"').map_or(line, |end| &line[..end + 2]);
    }
    let end = line.find([',', ')', ']', '}', '"', '(', '[', '{', ';']).unwrap_or(line.len());
    let end = end.min(line.find("//").unwrap_or(end));
    if line[end..].starts_with(['(', '[', '{']) {
        return with_brackets(line, end);
    }
    line[..end].trim_end()
}

/// A line up to the bracket that closes the one at `open`; only what is before that where none does.
fn with_brackets(line: &str, open: usize) -> &str {
    let closed = line[open..].char_indices().find(|(at, c)| {
        let end = open + at + c.len_utf8();
        matches!(c, ')' | ']' | '}') && unclosed(&line[open..end]).is_empty()
    });
    closed.map_or_else(|| line[..open].trim_end(), |(at, c)| &line[..open + at + c.len_utf8()])
}

pub(super) const fn is_of_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || !c.is_ascii()
}

/// The word that a text ends with.
pub(super) fn last_word(text: &str) -> &str {
    let text = text.trim_end_matches(is_space);
    let start = text.trim_end_matches(|c: char| c.is_alphanumeric() || c == '_').len();
    &text[start..]
}

/// The field whose value comes next; empty if none's does.
fn field_before(text: &str) -> &str {
    text.trim_end_matches(is_space).strip_suffix(':').map_or("", last_word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(text: &str) -> Around<'_> {
        Around::new(text, text.find('^').expect("a mark"))
    }

    #[test]
    fn what_is_around_is_told() {
        let here = around("(a: [Wait(seconds: ^");
        assert_eq!((here.name(), here.field, here.open.len()), ("Wait", "seconds", 3));
        let here = around("(steps: [Walk(via: [^");
        assert_eq!((here.name(), here.field, here.bracket()), ("via", "", Some('[')));
        assert!(here.is_first() && !around("(a, ^").is_first());
    }

    #[test]
    fn one_thing_is_what_a_person_takes_for_one() {
        for (text, one) in [
            ("Old Town Hall), x", "Old Town Hall"),
            ("\"a, b\", c", "\"a, b\""),
            ("Spot(at: At(1, 2)), seconds: 2)", "Spot(at: At(1, 2))"),
            ("Some(3", "Some"),
            ("3 // three", "3"),
            ("\"open", "\"open"),
            ("", ""),
        ] {
            assert_eq!(thing(text), one, "{text}");
        }
    }
}
