//! The steps of a tour's text as stretches of lines: each with its comments and its comma.

use core::ops::Range;

use super::{
    merge::{indent, is_white, next_line},
    syntax::{Group, Trivia, comments, trivia},
};

/// Where a step stands with the comments that belong to it: those directly above, and those after it on its line.
pub(super) fn slot(text: &str, list: &Group, i: usize) -> Range<usize> {
    let start = list.items[i].start();
    let from = i.checked_sub(1).map_or_else(|| end_of_opening(text, list), |before| slot_end(text, list, before));
    let mut first = start;
    for piece in trivia(text, from..start).into_iter().rev() {
        match piece {
            Trivia::Comment(range) => first = range.start,
            Trivia::Space(range) if text[range.clone()].matches('\n').count() > 1 => break,
            Trivia::Space(_) => {}
        }
    }
    // With what the line is set in by.
    let line = text[..first].rfind('\n').map_or(0, |newline| newline + 1);
    let is_first_on_its_line = line >= from && is_white(&text[line..first]);
    (if is_first_on_its_line { line } else { first })..slot_end(text, list, i)
}

/// After the line that the list is opened in, if nothing but a comment stands on it.
fn end_of_opening(text: &str, list: &Group) -> usize {
    let first = list.items.first().map_or(list.close, |item| item.start());
    next_line(text, list.open + 1..first).unwrap_or(list.open + 1)
}

fn slot_end(text: &str, list: &Group, i: usize) -> usize {
    let item = &list.items[i];
    let end = item.end_with_comma();
    let next = list.items.get(i + 1).map_or(list.close, |item| item.start());
    if let Some(line) = next_line(text, end..next) {
        return line;
    }
    if i + 1 < list.items.len() {
        return end;
    }
    comments(text, end..next).last().map_or(end, |comment| comment.end)
}

/// A step's lines as they can be put anywhere: whole lines, with a comma.
pub(super) fn lines(text: &str, list: &Group, i: usize, newline: &str) -> String {
    let (slot, item) = (slot(text, list, i), &list.items[i]);
    let mut lines = String::new();
    if !text[slot.clone()].starts_with([' ', '\t']) {
        lines.push_str(&" ".repeat(list_indent(text, list)));
    }
    lines.push_str(&text[slot.start..item.end()]);
    lines.push_str(if item.comma.is_none() { "," } else { "" });
    lines.push_str(text[item.end()..slot.end].trim_end());
    lines.push_str(newline);
    lines
}

/// What the lines of the list's items are set in by.
pub(super) fn list_indent(text: &str, list: &Group) -> usize {
    let line = |at: usize| text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let own = |at: usize| is_white(&text[line(at)..at]).then(|| text[line(at)..at].chars().count());
    let found = list.items.iter().find_map(|item| own(item.start()));
    found.unwrap_or_else(|| indent(&text[line(list.close)..]) + super::layout::INDENT)
}

/// The text with a step's lines taken out.
pub(super) fn without(text: &str, list: &Group, i: usize) -> String {
    let mut slot = slot(text, list, i);
    let are_lines = text[..slot.start].ends_with('\n') && text[..slot.end].ends_with('\n');
    if are_lines {
        let (before, after) = (blank_before(text, slot.start), blank_after(text, slot.end));
        let is_first = end_of_opening(text, list) >= before;
        let is_last = i + 1 == list.items.len() && indent_only(&text[after..list.close]);
        // Where blank lines stood on both sides, those before will do.
        if after > slot.end && (before < slot.start || is_first) {
            slot.end = after;
        } else if is_last && before < slot.start {
            slot.start = before;
        }
    } else if text[slot.end..].starts_with(' ') && i + 1 < list.items.len() {
        slot.end += 1;
    }
    format!("{}{}", &text[..slot.start], &text[slot.end..])
}

fn indent_only(text: &str) -> bool {
    text.chars().all(|c| matches!(c, ' ' | '\t'))
}

/// Where the blank lines before a line begin.
fn blank_before(text: &str, mut at: usize) -> usize {
    loop {
        let Some(above) = text[..at].strip_suffix('\n') else { return at };
        let start = above.rfind('\n').map_or(0, |newline| newline + 1);
        if start == 0 || !above[start..].trim().is_empty() {
            return at;
        }
        at = start;
    }
}

/// Where the blank lines from a line on end.
fn blank_after(text: &str, mut at: usize) -> usize {
    while let Some(newline) = text[at..].find('\n').filter(|&newline| text[at..at + newline].trim().is_empty()) {
        at += newline + 1;
    }
    at
}

/// The text with lines put in so that they are the list's items from `i` on.
pub(super) fn with(text: &str, list: &Group, i: usize, lines: &str, newline: &str) -> String {
    let before = i.checked_sub(1).map(|i| &list.items[i]);
    let at = match i.checked_sub(1) {
        Some(before) => slot_end(text, list, before),
        None if list.items.is_empty() => end_of_empty(text, list),
        None => slot(text, list, 0).start,
    };
    // After a last item that had no comma.
    let comma = before.filter(|item| item.comma.is_none()).map(|item| item.end());
    let head = comma.map_or_else(|| text[..at].to_owned(), |comma| format!("{},{}", &text[..comma], &text[comma..at]));
    if text[..at].ends_with('\n') {
        return format!("{head}{lines}{}", &text[at..]);
    }
    let rest = text[at..].trim_start_matches(' ');
    let is_last = i == list.items.len();
    let line = text[..list.open].rfind('\n').map_or(0, |newline| newline + 1);
    let indent = if is_last { indent(&text[line..]) } else { list_indent(text, list) };
    format!("{head}{newline}{lines}{}{rest}", " ".repeat(indent))
}

/// Where the first item of an empty list belongs: before the line of its closing bracket.
fn end_of_empty(text: &str, list: &Group) -> usize {
    match trivia(text, list.open + 1..list.close).last() {
        Some(Trivia::Space(space)) => text[space.clone()].rfind('\n').map_or(space.start, |at| space.start + at + 1),
        Some(Trivia::Comment(comment)) => comment.end,
        None => list.open + 1,
    }
}
