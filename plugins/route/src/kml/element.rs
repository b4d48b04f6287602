//! A KML text as a tree of elements, within limits.

use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};
use veduta_city::file::SyntaxError;

/// Largest text that is read, in bytes.
const LARGEST: usize = 64 << 20;
/// Deepest nesting of elements, and most of them.
const DEEPEST: usize = 64;
const MOST_ELEMENTS: usize = 1 << 21;

/// An element, without the prefix of its name.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub name: String,
    pub id: Option<String>,
    pub target: Option<String>,
    /// The attribute `name`, as data has it.
    pub key: Option<String>,
    /// Its own words, without those of elements in it.
    pub text: String,
    pub children: Vec<Self>,
    /// Byte at which it begins.
    pub at: usize,
}

impl Element {
    /// The first element of a name in it.
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The words of the first element of a name in it.
    pub fn words(&self, name: &str) -> Option<&str> {
        self.child(name).map(|child| child.text.trim()).filter(|words| !words.is_empty())
    }

    /// It and all within it, in the order of the text.
    pub fn all(&self) -> Vec<&Self> {
        let mut found = vec![self];
        for child in &self.children {
            found.extend(child.all());
        }
        found
    }

    fn of(start: &BytesStart<'_>, at: usize) -> Self {
        let mut element = Self { name: start.local_name().as_ref().to_owned(), at, ..Self::default() };
        for attribute in start.attributes().flatten() {
            let value = attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0).ok().map(|value| value.into_owned());
            match attribute.key.local_name().as_ref() {
                "id" => element.id = value,
                "targetId" => element.target = value,
                "name" => element.key = value,
                _ => {}
            }
        }
        element
    }
}

/// Reads a text; its outermost element is returned.
pub(super) fn read(text: &str, file: &str) -> Result<Element, SyntaxError> {
    let fails = |at: usize, message: String| SyntaxError::at(text, file, at, message);
    if text.len() > LARGEST {
        return Err(fails(0, format!("{} bytes is more than the {LARGEST} that a tour in KML may have", text.len())));
    }
    let mut reader = Reader::from_str(text);
    let (mut open, mut many): (Vec<Element>, usize) = (Vec::new(), 0);
    loop {
        let at = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|fault| fails(reader.error_position() as usize, format!("broken XML: {fault}")))?;
        let (started, ends) = match event {
            Event::Start(start) => (Some(Element::of(&start, at)), false),
            Event::Empty(start) => (Some(Element::of(&start, at)), true),
            Event::End(_) => (None, true),
            Event::Text(words) => {
                told(&mut open, &words.xml10_content());
                continue;
            }
            Event::CData(words) => {
                told(&mut open, &words.xml10_content());
                continue;
            }
            Event::GeneralRef(name) => {
                let known = name.resolve_char_ref().ok().flatten().or_else(|| entity(&name.xml10_content()));
                let c = known.ok_or_else(|| fails(at, format!("broken XML: there is no `&{};`", name.xml10_content())))?;
                told(&mut open, c.encode_utf8(&mut [0; 4]));
                continue;
            }
            Event::Eof => return Err(fails(text.len(), unfinished(&open))),
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => continue,
        };
        if let Some(element) = started {
            many += 1;
            if open.len() >= DEEPEST || many > MOST_ELEMENTS {
                let limit =
                    format!("more than {MOST_ELEMENTS} elements, or more than {DEEPEST} within one another: no tour needs so many");
                return Err(fails(at, limit));
            }
            open.push(element);
        }
        if let Some(element) = ends.then(|| open.pop()).flatten() {
            match open.last_mut() {
                Some(parent) => parent.children.push(element),
                None => return Ok(element),
            }
        }
    }
}

fn told(open: &mut [Element], words: &str) {
    if let Some(element) = open.last_mut() {
        element.text.push_str(words);
    }
}

fn unfinished(open: &[Element]) -> String {
    match open.last() {
        Some(element) => format!("the text ends within `{}`: it is cut off", element.name),
        None => "there is no element in it: this is not KML".to_owned(),
    }
}

fn entity(name: &str) -> Option<char> {
    match name {
        "amp" => Some('&'),
        "lt" => Some('<'),
        "gt" => Some('>'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        _ => None,
    }
}

/// A text as it stands in XML.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // XML has no way to tell others.
            c if c.is_control() && !matches!(c, '\n' | '\t') => escaped.push(' '),
            '\u{FFFE}' | '\u{FFFF}' => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

/// The words of a piece of HTML, as a balloon shows them.
pub(super) fn without_marks(html: &str) -> String {
    let mut words = String::new();
    let mut rest = html;
    while let Some(open) = rest.find('<') {
        words.push_str(&rest[..open]);
        let Some(close) = rest[open..].find('>') else {
            words.push_str(&rest[open..]);
            rest = "";
            break;
        };
        words.push(' ');
        rest = &rest[open + close + 1..];
    }
    words.push_str(rest);
    let plain = [("&nbsp;", " "), ("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&apos;", "'"), ("&amp;", "&")];
    let words = plain.iter().fold(words, |words, (mark, c)| words.replace(mark, c));
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}
