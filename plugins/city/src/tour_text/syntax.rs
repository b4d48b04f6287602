//! Where things stand in a RON text: values, their fields and items, commas and comments.
//!
//! It is run on texts that the reader has taken, so it knows brackets, words, strings and comments, and not what they mean.

use core::ops::Range;

/// Deepest nesting that is followed; the reader itself stops at 128.
const DEEPEST: usize = 256;

/// A value: a word, number or string; or a group, with or without a name before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Node {
    /// From the name or the first character to the last.
    pub span: Range<usize>,
    /// The name before a group's bracket.
    pub name: Option<Range<usize>>,
    pub group: Option<Group>,
}

/// What stands in a pair of brackets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Group {
    pub bracket: char,
    /// Where the opening bracket stands.
    pub open: usize,
    /// Where the closing bracket stands.
    pub close: usize,
    pub items: Vec<Item>,
}

/// A field, an entry of a map, or an item of a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Item {
    pub key: Option<Range<usize>>,
    pub value: Node,
    /// Where its comma stands; the last one may have none.
    pub comma: Option<usize>,
}

impl Item {
    pub fn start(&self) -> usize {
        self.key.as_ref().map_or(self.value.span.start, |key| key.start)
    }

    /// Where the value ends, and with its comma.
    pub fn end(&self) -> usize {
        self.value.span.end
    }

    pub fn end_with_comma(&self) -> usize {
        self.comma.map_or(self.end(), |comma| comma + 1)
    }
}

impl Node {
    /// The value within `Some(…)`, however often it is wrapped.
    pub fn unwrapped(&self, text: &str) -> &Self {
        let is_some = self.name.as_ref().is_some_and(|name| &text[name.clone()] == "Some");
        match &self.group {
            Some(Group { items, .. }) if is_some && items.len() == 1 && items[0].key.is_none() => items[0].value.unwrapped(text),
            _ => self,
        }
    }

    /// The items of a group in such brackets.
    pub fn items(&self, bracket: char) -> Option<&Group> {
        self.group.as_ref().filter(|group| group.bracket == bracket)
    }
}

/// A word as it is meant: `r#word` is `word`.
pub(super) fn plain(word: &str) -> &str {
    word.strip_prefix("r#").unwrap_or(word)
}

/// The one value of a text; `None` where it is no RON.
pub(super) fn scan(text: &str) -> Option<Node> {
    let mut scanner = Scanner { text, at: 0, depth: 0 };
    scanner.skip_trivia()?;
    while scanner.peek() == Some('#') {
        scanner.skip_attribute()?;
    }
    let node = scanner.value()?;
    scanner.skip_trivia()?;
    (scanner.at == text.len()).then_some(node)
}

/// White space or a comment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Trivia {
    Space(Range<usize>),
    Comment(Range<usize>),
}

impl Trivia {
    /// Where it stands.
    pub(crate) fn range(&self) -> core::ops::Range<usize> {
        match self {
            Self::Space(range) | Self::Comment(range) => range.clone(),
        }
    }
}

/// Where the word, number or string begins that ends at a byte.
pub(crate) fn last_scalar(text: &str, end: usize) -> Option<usize> {
    let mut scanner = Scanner { text: &text[..end], at: 0, depth: 0 };
    let mut last = None;
    while let Some(c) = scanner.peek() {
        let start = scanner.at;
        if scanner.comment() == Some(true) {
            continue;
        }
        match scanner.scalar() {
            Some(range) if scanner.at > start => last = Some(range),
            _ => scanner.at = start + c.len_utf8(),
        }
    }
    last.filter(|range| range.end == end).map(|range| range.start)
}

/// The white space and comments of a stretch of text; what else stands there (a comma, a value) is passed over.
pub(crate) fn trivia(text: &str, range: Range<usize>) -> Vec<Trivia> {
    let mut found = Vec::new();
    let mut scanner = Scanner { text: &text[..range.end], at: range.start, depth: 0 };
    while let Some(c) = scanner.peek() {
        let start = scanner.at;
        if is_space(c) {
            scanner.skip_while(is_space);
            found.push(Trivia::Space(start..scanner.at));
        } else if scanner.comment() == Some(true) {
            found.push(Trivia::Comment(start..scanner.at));
        } else if scanner.scalar().is_none() {
            scanner.at = start + c.len_utf8();
        }
    }
    found
}

/// The brackets that a text opens and does not close, and where they stand; it need not be whole.
pub(crate) fn unclosed(text: &str) -> Vec<(usize, char)> {
    let mut open: Vec<(usize, char)> = Vec::new();
    let mut scanner = Scanner { text, at: 0, depth: 0 };
    while let Some(c) = scanner.peek() {
        let start = scanner.at;
        match c {
            '(' | '[' | '{' => open.push((start, c)),
            ')' | ']' | '}' => {
                open.pop();
            }
            _ if scanner.comment() == Some(true) || scanner.at == start && scanner.scalar().is_some() => continue,
            _ => {}
        }
        scanner.at = start + c.len_utf8();
    }
    open
}

/// The comments of a stretch of text, those within values among them.
pub(super) fn comments(text: &str, range: Range<usize>) -> Vec<Range<usize>> {
    let comment = |trivia| match trivia {
        Trivia::Comment(range) => Some(range),
        Trivia::Space(_) => None,
    };
    trivia(text, range).into_iter().filter_map(comment).collect()
}

pub(crate) const fn is_space(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\n' | '\r' | '\x0B' | '\x0C' | '\u{85}' | '\u{200E}' | '\u{200F}' | '\u{2028}' | '\u{2029}')
}

struct Scanner<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl Scanner<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn next(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.at += c.len_utf8();
        Some(c)
    }

    fn eat(&mut self, c: char) -> bool {
        let is_there = self.peek() == Some(c);
        self.at += if is_there { c.len_utf8() } else { 0 };
        is_there
    }

    fn skip_while(&mut self, of: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|c| !of(c)).unwrap_or(rest.len());
    }

    fn skip_trivia(&mut self) -> Option<()> {
        loop {
            self.skip_while(is_space);
            if !self.comment()? {
                return Some(());
            }
        }
    }

    /// Passes over a comment, if one begins here; `None` if it has no end.
    fn comment(&mut self) -> Option<bool> {
        if self.rest().starts_with("//") {
            self.skip_while(|c| c != '\n');
            return Some(true);
        }
        if !self.rest().starts_with("/*") {
            return Some(false);
        }
        let mut level = 0;
        loop {
            if self.rest().starts_with("/*") {
                (self.at, level) = (self.at + 2, level + 1);
            } else if self.rest().starts_with("*/") {
                (self.at, level) = (self.at + 2, level - 1);
            } else {
                self.next()?;
            }
            if level == 0 {
                return Some(true);
            }
        }
    }

    /// `#![…]` before the value.
    fn skip_attribute(&mut self) -> Option<()> {
        while !self.eat(']') {
            self.skip_trivia()?;
            if self.peek() != Some(']') && self.scalar().is_none() {
                self.next()?;
            }
        }
        self.skip_trivia()
    }

    fn value(&mut self) -> Option<Node> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let node = match self.peek()? {
            '(' | '[' | '{' => {
                let group = self.group()?;
                Node { span: group.open..group.close + 1, name: None, group: Some(group) }
            }
            _ => {
                let word = self.scalar()?;
                let end = self.at;
                self.skip_trivia()?;
                if self.peek() == Some('(') {
                    let group = self.group()?;
                    Node { span: word.start..group.close + 1, name: Some(word), group: Some(group) }
                } else {
                    self.at = end;
                    Node { span: word, name: None, group: None }
                }
            }
        };
        self.depth -= 1;
        Some(node)
    }

    fn group(&mut self) -> Option<Group> {
        let (open, bracket) = (self.at, self.next()?);
        let closing = match bracket {
            '(' => ')',
            '[' => ']',
            _ => '}',
        };
        let mut items: Vec<Item> = Vec::new();
        loop {
            self.skip_trivia()?;
            let close = self.at;
            if self.eat(closing) {
                return Some(Group { bracket, open, close, items });
            }
            if items.last().is_some_and(|last| last.comma.is_none()) {
                return None;
            }
            items.push(self.item()?);
        }
    }

    fn item(&mut self) -> Option<Item> {
        let mut value = self.value()?;
        let mut key = None;
        let mut end = self.at;
        self.skip_trivia()?;
        if self.eat(':') {
            key = Some(value.span);
            self.skip_trivia()?;
            value = self.value()?;
            end = self.at;
            self.skip_trivia()?;
        }
        let comma = self.at;
        let has_comma = self.eat(',');
        if !has_comma {
            self.at = end;
        }
        Some(Item { key, value, comma: has_comma.then_some(comma) })
    }

    /// A word, a number, a character or a string of any kind.
    fn scalar(&mut self) -> Option<Range<usize>> {
        let start = self.at;
        if self.raw_string()? {
            return Some(start..self.at);
        }
        loop {
            match self.peek() {
                Some('"') => {
                    self.quoted('"')?;
                    break;
                }
                // Also of a byte, `b'x'`.
                Some('\'') => {
                    self.quoted('\'')?;
                    break;
                }
                Some('#') if &self.text[start..self.at] != "r" => break,
                Some(c) if is_space(c) || matches!(c, ',' | ':' | '(' | ')' | '[' | ']' | '{' | '}' | '/') => break,
                Some(c) => self.at += c.len_utf8(),
                None => break,
            }
        }
        (self.at > start).then_some(start..self.at)
    }

    /// `r"…"`, `r#"…"#` and so on, also after a `b`; `None` if it has no end.
    fn raw_string(&mut self) -> Option<bool> {
        let rest = self.rest();
        let Some(after) = rest.strip_prefix("br").or_else(|| rest.strip_prefix('r')) else { return Some(false) };
        let hashes = after.len() - after.trim_start_matches('#').len();
        let Some(content) = after[hashes..].strip_prefix('"') else { return Some(false) };
        let ending = format!("\"{}", "#".repeat(hashes));
        let end = content.find(&ending)?;
        self.at += rest.len() - content.len() + end + ending.len();
        Some(true)
    }

    fn quoted(&mut self, quote: char) -> Option<()> {
        self.next()?;
        // `'''` is the character between two others.
        if quote == '\'' && self.rest().starts_with("''") {
            self.at += 2;
            return Some(());
        }
        loop {
            match self.next()? {
                '\\' => {
                    self.next()?;
                }
                c if c == quote => return Some(()),
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The texts of the items of the outermost group.
    fn items(text: &str) -> Vec<&str> {
        let node = scan(text).unwrap_or_else(|| panic!("{text}"));
        let group = node.group.unwrap_or_else(|| panic!("{text}"));
        group.items.iter().map(|item| &text[item.start()..item.end()]).collect()
    }

    #[test]
    fn items_are_found_whatever_stands_in_strings_and_comments() {
        let text = r##"/* , ( /* [ */ */ Tour ( // a: )
            title: "a, \" b)", r#city : r#"x",)"#, c: ')', d: '\'', e: ''', f: b'"', /* ] */
            steps: [Wait(seconds: 1), /* ) */ Ahead] // )
        ) // done"##;
        let expected = [r#"title: "a, \" b)""#, r##"r#city : r#"x",)"#"##, "c: ')'", r"d: '\''", "e: '''", r#"f: b'"'"#];
        assert_eq!(items(text)[..6], expected);
        assert_eq!(items(text)[6], "steps: [Wait(seconds: 1), /* ) */ Ahead]");
    }

    #[test]
    fn attributes_come_before_the_value() {
        assert_eq!(items("#![enable(implicit_some)] # ! [type = \"a]\"] (a: 1, b: -2.5e-3)"), ["a: 1", "b: -2.5e-3"]);
    }

    #[test]
    fn what_is_no_ron_has_no_value() {
        for text in ["", "(", "(a: 1", "(a: 1 b: 2)", "/* ", "(\"", "(r#\"x\")", "(a: 1) 2", "[1,,2]", ")"] {
            assert_eq!(scan(text), None, "{text}");
        }
    }

    #[test]
    fn a_value_may_be_wrapped() {
        let text = "Some(Some( 5 ,))";
        let node = scan(text).expect("a value");
        assert_eq!(&text[node.unwrapped(text).span.clone()], "5");
    }

    #[test]
    fn comments_are_told_from_strings() {
        let text = "(a: \"// no\", // yes\n b: 'x', /* and /* this */ */ c: r\"/*\") // last";
        let found: Vec<&str> = comments(text, 0..text.len()).into_iter().map(|range| &text[range]).collect();
        assert_eq!(found, ["// yes", "/* and /* this */ */", "// last"]);
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_scanner_panic(text in "[\\[({:,\"'/*# \\\\rb\nxé\\])}]{0,40}") {
            let _ = scan(&text);
            let _ = comments(&text, 0..text.len());
        }
    }
}
