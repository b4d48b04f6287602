//! A value of a text changed into another with as little as possible written anew.

use core::ops::Range;
use std::collections::BTreeMap;

use super::{
    layout::{laid_out, quoted},
    syntax::{Group, Node, Trivia, comments, plain, scan, trivia},
    value::{Field, Value},
};
use crate::file;

/// A text that stands in a larger one.
#[derive(Debug)]
pub(super) struct Piece {
    pub text: String,
    /// Column of its first character.
    pub column: usize,
    /// What the line that it begins in is set in by.
    pub indent: usize,
    pub newline: &'static str,
    /// Comments that stood in what is no more.
    pub homeless: Vec<String>,
}

/// Most passes over a piece; each mends a difference.
const MOST_PASSES: usize = 20_000;

impl Piece {
    /// Makes the text say this value.
    pub fn say(&mut self, value: &Value) {
        if self.is_said(|changes, node| changes.merge(node, value)) {
            return;
        }
        let all = 0..self.text.len();
        self.make_homeless(all);
        self.text = laid_out(value, self.column, self.indent, 1).replace('\n', self.newline);
    }

    /// Makes the fields of a group say these values; those that are not among them stay.
    pub fn say_fields(&mut self, fields: &[Field]) {
        self.is_said(|changes, node| node.items('(').into_iter().for_each(|group| changes.merge_fields(group, fields)));
    }

    /// Changes the text until nothing more comes or goes; `false` if that has no end.
    fn is_said(&mut self, change: impl Fn(&mut Changes<'_>, &Node)) -> bool {
        (0..MOST_PASSES).any(|_| {
            let Some(node) = scan(&self.text) else { return true };
            let mut changes = Changes { piece: self, splices: Vec::new(), is_done: false };
            change(&mut changes, &node);
            let Changes { splices, is_done, .. } = changes;
            self.apply(splices);
            !is_done
        })
    }

    fn apply(&mut self, mut splices: Vec<(Range<usize>, String)>) {
        splices.sort_by_key(|(range, _)| range.start);
        for (range, with) in splices.into_iter().rev() {
            self.text.replace_range(range, &with);
        }
    }

    fn make_homeless(&mut self, range: Range<usize>) {
        let found: Vec<String> = comments(&self.text, range).into_iter().map(|range| self.text[range].to_owned()).collect();
        self.homeless.extend(found);
    }

    fn line_start(&self, at: usize) -> Option<usize> {
        self.text[..at].rfind('\n').map(|newline| newline + 1)
    }

    fn column_of(&self, at: usize) -> usize {
        match self.line_start(at) {
            Some(start) => self.text[start..at].chars().count(),
            None => self.column + self.text[..at].chars().count(),
        }
    }

    fn indent_of(&self, at: usize) -> usize {
        self.line_start(at).map_or(self.indent, |start| indent(&self.text[start..]))
    }
}

/// White space that a line begins with, in characters.
pub(super) fn indent(line: &str) -> usize {
    line.chars().take_while(|c| matches!(c, ' ' | '\t')).count()
}

pub(super) fn is_white(text: &str) -> bool {
    text.chars().all(char::is_whitespace)
}

/// Where the next line begins, if it begins before anything but white space and comments.
pub(super) fn next_line(text: &str, range: Range<usize>) -> Option<usize> {
    let end = range.end;
    trivia(text, range).into_iter().find_map(|trivia| match trivia {
        Trivia::Space(space) => text[space.start..space.end.min(end)].find('\n').map(|at| space.start + at + 1),
        Trivia::Comment(_) => None,
    })
}

/// Whether a value of a text is this one already.
pub(super) fn is_same(text: &str, node: &Node, value: &Value) -> bool {
    let node = node.unwrapped(text);
    let word = &text[node.span.clone()];
    let same = |items: &[&Node], values: &[Value]| {
        items.len() == values.len() && items.iter().zip(values).all(|(item, value)| is_same(text, item, value))
    };
    match value {
        Value::Nothing => plain(word) == "None",
        Value::Number(number) => node.group.is_none() && parsed_number(word) == Some(*number),
        Value::Text(meant) => node.group.is_none() && string(word).as_ref() == Some(meant),
        Value::Word(meant) => plain(word) == *meant,
        Value::Struct(name, fields) => named(text, node, name).is_some_and(|group| {
            let of = |field: &Field| group.items.iter().find(|item| key(text, item.key.as_ref()) == Some(field.key));
            fields.iter().all(|field| of(field).map_or(!field.is_told, |item| is_same(text, &item.value, &field.value)))
        }),
        Value::Tuple(name, values) => named(text, node, name).is_some_and(|group| same(&nodes(group), values)),
        Value::List(values) => node.items('[').is_some_and(|group| same(&nodes(group), values)),
        Value::Map(entries) => node.items('{').is_some_and(|group| {
            let found: Option<BTreeMap<String, String>> =
                group.items.iter().map(|item| Some((map_key(text, item.key.as_ref())?, word_string(text, &item.value)?))).collect();
            found.as_ref() == Some(entries)
        }),
    }
}

/// The group of a value of this name, which may be empty.
fn named<'a>(text: &str, node: &'a Node, name: &str) -> Option<&'a Group> {
    let found = node.name.clone().map_or("", |range| plain(&text[range]));
    node.items('(').filter(|_| found == name)
}

fn nodes(group: &Group) -> Vec<&Node> {
    group.items.iter().map(|item| &item.value).collect()
}

pub(super) fn key<'a>(text: &'a str, range: Option<&Range<usize>>) -> Option<&'a str> {
    range.map(|range| plain(&text[range.clone()]))
}

fn map_key(text: &str, range: Option<&Range<usize>>) -> Option<String> {
    string(&text[range?.clone()])
}

fn word_string(text: &str, node: &Node) -> Option<String> {
    string(&text[node.span.clone()])
}

fn parsed_number(word: &str) -> Option<f64> {
    file::parse(word, "").ok().or_else(|| file::parse::<u16>(word, "").ok().map(f64::from))
}

fn string(word: &str) -> Option<String> {
    file::parse(word, "").ok()
}

/// What one pass over a piece changes: as many values as differ, or one field or item more or less.
struct Changes<'a> {
    piece: &'a mut Piece,
    splices: Vec<(Range<usize>, String)>,
    /// A field or item came or went: the rest waits for the next pass.
    is_done: bool,
}

impl Changes<'_> {
    fn merge(&mut self, node: &Node, value: &Value) {
        if self.is_done || is_same(&self.piece.text, node, value) {
            return;
        }
        let node = node.unwrapped(&self.piece.text);
        let are_named = |group: &Group| group.items.iter().all(|item| item.key.is_some());
        match value {
            Value::Struct(name, fields) => {
                if let Some(group) = named(&self.piece.text, node, name).filter(|group| are_named(group)) {
                    return self.merge_fields(group, fields);
                }
            }
            Value::Tuple(name, values) => {
                if let Some(group) = named(&self.piece.text, node, name).filter(|group| group.items.len() == values.len()) {
                    return group.items.iter().zip(values).for_each(|(item, value)| self.merge(&item.value, value));
                }
            }
            Value::List(values) => {
                if let Some(group) = node.items('[') {
                    return self.merge_list(group, values);
                }
            }
            Value::Map(entries) => {
                if let Some(group) = node.items('{') {
                    return self.merge_map(group, entries);
                }
            }
            Value::Nothing | Value::Number(_) | Value::Text(_) | Value::Word(_) => {}
        }
        self.replace(node, value);
    }

    fn replace(&mut self, node: &Node, value: &Value) {
        self.piece.make_homeless(node.span.clone());
        let (column, indent) = (self.piece.column_of(node.span.start), self.piece.indent_of(node.span.start));
        let text = laid_out(value, column, indent, 1).replace('\n', self.piece.newline);
        self.splices.push((node.span.clone(), text));
    }

    fn merge_fields(&mut self, group: &Group, fields: &[Field]) {
        for (i, item) in group.items.iter().enumerate() {
            let key = key(&self.piece.text, item.key.as_ref());
            let Some(field) = fields.iter().find(|field| key == Some(field.key)) else { continue };
            let is_to_go = field.value.is_empty() && !is_same(&self.piece.text, &item.value, &field.value);
            if is_to_go {
                return self.remove(group, i);
            }
            self.merge(&item.value, &field.value);
            if self.is_done {
                return;
            }
        }
        let place = |field: &Field| group.items.iter().position(|item| key(&self.piece.text, item.key.as_ref()) == Some(field.key));
        let missing = fields.iter().position(|field| field.is_told && place(field).is_none());
        if let Some(missing) = missing {
            let before = fields[..missing].iter().rev().find_map(place);
            self.insert(group, before, &format!("{}: ", fields[missing].key), &fields[missing].value);
        }
    }

    fn merge_list(&mut self, group: &Group, values: &[Value]) {
        let items = nodes(group);
        let same = |(item, value): &(&&Node, &Value)| is_same(&self.piece.text, item, value);
        let shorter = items.len().min(values.len());
        let first = items.iter().zip(values).take_while(same).count();
        let last = items.iter().rev().zip(values.iter().rev()).take(shorter - first).take_while(same).count();
        let both = shorter - last;
        if items.len() > values.len() {
            return self.remove(group, both);
        }
        if items.len() < values.len() {
            return self.insert(group, both.checked_sub(1), "", &values[both]);
        }
        items.iter().zip(values).for_each(|(item, value)| self.merge(item, value));
    }

    fn merge_map(&mut self, group: &Group, entries: &BTreeMap<String, String>) {
        let keys: Vec<Option<String>> = group.items.iter().map(|item| map_key(&self.piece.text, item.key.as_ref())).collect();
        for (i, item) in group.items.iter().enumerate() {
            match keys[i].as_ref().and_then(|key| entries.get(key)) {
                // Of two entries of a key, the later one counts.
                Some(_) if keys[i + 1..].contains(&keys[i]) => {}
                Some(text) => self.merge(&item.value, &Value::Text(text.clone())),
                None => return self.remove(group, i),
            }
        }
        let missing = entries.iter().find(|(key, _)| !keys.iter().flatten().any(|found| found == *key));
        if let Some((key, text)) = missing {
            let last = group.items.len().checked_sub(1);
            self.insert(group, last, &format!("{}: ", quoted(key)), &Value::Text(text.clone()));
        }
    }

    /// Puts an entry after another of its group, or first.
    fn insert(&mut self, group: &Group, after: Option<usize>, key: &str, value: &Value) {
        self.is_done = true;
        let text = &self.piece.text;
        let next = group.items.get(after.map_or(0, |i| i + 1)).map_or(group.close, |item| item.start());
        let before = after.map(|i| &group.items[i]);
        let from = before.map_or(group.open + 1, |item| item.end_with_comma());
        let neighbour = before.or_else(|| group.items.first()).map_or(group.open, |item| item.start());
        let begins_line = text[..neighbour].rfind('\n').is_some_and(|newline| is_white(&text[newline..neighbour]));
        let line = next_line(text, from..next).filter(|_| begins_line && !group.items.is_empty());
        let indent = self.piece.indent_of(neighbour);
        let column = if line.is_some() { indent } else { self.piece.column_of(from) } + key.chars().count();
        let entry = format!("{key}{}", laid_out(value, column, indent, 2)).replace('\n', self.piece.newline);
        if let Some(line) = line {
            self.splices.extend(before.filter(|item| item.comma.is_none()).map(|item| (item.end()..item.end(), ",".to_owned())));
            self.splices.push((line..line, format!("{}{entry},{}", " ".repeat(indent), self.piece.newline)));
        } else if let Some(before) = before {
            self.splices.push((before.end()..before.end(), format!(", {entry}")));
        } else {
            let comma = if group.items.is_empty() { "" } else { ", " };
            self.splices.push((from..from, format!("{entry}{comma}")));
        }
    }

    /// Takes an entry out of its group; comments beside it stay.
    fn remove(&mut self, group: &Group, i: usize) {
        self.is_done = true;
        let item = &group.items[i];
        let (start, end) = (item.start(), item.end());
        self.piece.make_homeless(start..end);
        let text = &self.piece.text;
        if let Some(comma) = item.comma.filter(|&comma| !comments(text, end..comma).is_empty()) {
            self.splices.extend([(start..end, String::new()), (comma..comma + 1, String::new())]);
            return;
        }
        let end = item.end_with_comma();
        let line = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let rest = text[end..].find('\n').map(|newline| end + newline + 1);
        let is_blank = |range: Range<usize>| is_white(&text[range]);
        if let Some(rest) = rest.filter(|&rest| line > 0 && is_blank(line..start) && is_blank(end..rest)) {
            self.splices.push((line..rest, String::new()));
            return;
        }
        let spaces = |text: &str| text.len() - text.trim_start_matches(' ').len();
        let previous = i.checked_sub(1).and_then(|i| group.items[i].comma);
        let range = match previous.filter(|&comma| is_blank(comma + 1..start)) {
            // The last one goes with the comma before it.
            Some(comma) if item.comma.is_none() => comma..end,
            Some(comma) if end == group.close => comma + 1..end,
            _ => start..end + spaces(&text[end..]),
        };
        self.splices.push((range, String::new()));
    }
}
