//! A tour as a tree of RON values, and how such a tree is laid out: on one line where that is short enough, or a field a line.

use super::value::{Field, Value};

/// Longest line that is written where it can be broken, in characters.
const WIDTH: usize = 130;
/// Spaces that a level is set in by.
pub(super) const INDENT: usize = 2;

/// A value as text that begins in a column and whose further lines are set in by `indent`; `after` characters follow it.
pub(super) fn laid_out(value: &Value, column: usize, indent: usize, after: usize) -> String {
    let line = inline(value);
    if column + line.chars().count() + after <= WIDTH {
        return line;
    }
    let inner = indent + INDENT;
    match value {
        Value::Struct(name, fields) => {
            let fields = fields.iter().filter(|field| field.is_told).map(|field| entry(field.key, &field.value, inner));
            broken(&format!("{name}("), fields, ")", indent)
        }
        Value::Map(entries) => {
            broken("{", entries.iter().map(|(key, text)| entry(&quoted(key), &Value::Text(text.clone()), inner)), "}", indent)
        }
        Value::List(items) if items.iter().all(|item| matches!(item, Value::Tuple(..))) => filled(items, indent),
        Value::List(items) => broken("[", items.iter().map(|item| laid_out(item, inner, inner, 1)), "]", indent),
        // Numbers, words and short tuples of them have no place to be broken at.
        _ => line,
    }
}

/// A field or an entry of a map, on a line set in so far.
pub(super) fn entry(key: &str, value: &Value, indent: usize) -> String {
    let key = format!("{key}: ");
    let value = laid_out(value, indent + key.chars().count(), indent, 1);
    key + &value
}

fn broken(open: &str, items: impl Iterator<Item = String>, close: &str, indent: usize) -> String {
    let (inner, outer) = (" ".repeat(indent + INDENT), " ".repeat(indent));
    let items: String = items.map(|item| format!("{inner}{item},\n")).collect();
    format!("{open}\n{items}{outer}{close}")
}

/// As many items on a line as it holds.
fn filled(items: &[Value], indent: usize) -> String {
    let inner = " ".repeat(indent + INDENT);
    let mut lines = vec![inner.clone()];
    for item in items {
        let item = format!("{},", inline(item));
        let Some(line) = lines.last_mut() else { break };
        if *line == inner {
            line.push_str(&item);
        } else if line.chars().count() + 1 + item.chars().count() <= WIDTH {
            line.push(' ');
            line.push_str(&item);
        } else {
            lines.push(format!("{inner}{item}"));
        }
    }
    format!("[\n{}\n{}]", lines.join("\n"), " ".repeat(indent))
}

/// A value on one line.
fn inline(value: &Value) -> String {
    let list = |items: &[Value]| items.iter().map(inline).collect::<Vec<_>>().join(", ");
    match value {
        Value::Nothing => "None".to_owned(),
        Value::Number(number) => number.to_string(),
        Value::Text(text) => quoted(text),
        Value::Word(word) => (*word).to_owned(),
        Value::Struct(name, fields) => {
            let told = fields.iter().filter(|field| field.is_told);
            let fields: Vec<String> = told.map(|Field { key, value, .. }| format!("{key}: {}", inline(value))).collect();
            format!("{name}({})", fields.join(", "))
        }
        Value::Tuple(name, items) => format!("{name}({})", list(items)),
        Value::List(items) => format!("[{}]", list(items)),
        Value::Map(entries) => {
            let entries: Vec<String> = entries.iter().map(|(key, text)| format!("{}: {}", quoted(key), quoted(text))).collect();
            format!("{{{}}}", entries.join(", "))
        }
    }
}

/// A string in quotes; only what must be is escaped.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    quoted.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            '\r' => quoted.push_str("\\r"),
            // Line separators and marks of direction would be white space to a reader.
            c if c.is_control() || matches!(c, '\u{200E}' | '\u{200F}' | '\u{2028}' | '\u{2029}') => {
                quoted.extend(c.escape_unicode());
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
