//! Where the parts of a tour stand in its text: fields, items of lists, entries of pairs.

use core::ops::Range;

use super::{TourText, merge, syntax::Node};
use crate::file::SyntaxError;

impl TourText {
    /// A mistake in a part of a step, from 0, or of the tour itself. The part is told by fields, places in lists from 0 and keys of pairs,
    /// with points between them: `speed`, `look.at`, `through.2.1`, `translations.cs`. What is not told in the text is pointed at by what it
    /// would stand in, and a pair by its key.
    ///
    /// ```
    /// let text = "(title: \"A walk\", city: \"x.city\", steps: [\n  Walk(to: At(0, 0), via: [At(1, 2), At(3, 4)]),\n])";
    /// let tour = veduta_city::TourText::parse(text, "a.tour.ron")?;
    /// let place = |part| {
    ///     let mistake = tour.mistake_at(Some(0), part, "a.tour.ron", "wrong".to_owned());
    ///     (mistake.line, mistake.column)
    /// };
    /// assert_eq!(place("via.1"), (2, 38));
    /// assert_eq!(place("via.1.0"), (2, 41));
    /// assert_eq!(place("speed"), (2, 3));
    /// # Ok::<(), veduta_city::file::SyntaxError>(())
    /// ```
    #[must_use]
    pub fn mistake_at(&self, step: Option<usize>, part: &str, file: &str, message: String) -> SyntaxError {
        let (at, _) = self.found_part(step, part);
        SyntaxError::at(&self.text, file, at + self.mark, message)
    }

    /// A part as it is written, told as in [`TourText::mistake_at`]; `None` if it is not in the text.
    #[must_use]
    pub fn written_part(&self, step: Option<usize>, part: &str) -> Option<&str> {
        self.found_part(step, part).1.map(|span| &self.body()[span])
    }

    /// The keys of pairs, in the order in which they stand, each as often as it stands there.
    #[must_use]
    pub fn keys(&self, step: Option<usize>, part: &str) -> Vec<&str> {
        let (_, span) = self.found_part(step, part);
        let node = span.and_then(|span| self.node_at(step, &span));
        let Some(pairs) = node.and_then(|node| node.unwrapped(self.body()).items('{')) else { return Vec::new() };
        pairs.items.iter().filter_map(|item| Some(self.body()[item.key.clone()?].trim_matches('"'))).collect()
    }

    /// Where to point at for a part, and where it stands if it does.
    fn found_part(&self, step: Option<usize>, part: &str) -> (usize, Option<Range<usize>>) {
        let Some(mut node) = self.first_node(step) else { return (self.root.span.start, None) };
        let mut at = node.span.start;
        for name in part.split('.').filter(|name| !name.is_empty()) {
            let Some((begin, inner)) = inner(self.body(), node, name) else { return (at, None) };
            (at, node) = (begin, inner);
        }
        (at, Some(node.span.clone()))
    }

    fn first_node(&self, step: Option<usize>) -> Option<&Node> {
        match step {
            None => Some(&self.root),
            Some(step) => Some(&self.steps().items.get(step)?.value),
        }
    }

    /// The value that stands in a span.
    fn node_at(&self, step: Option<usize>, span: &Range<usize>) -> Option<&Node> {
        let mut node = self.first_node(step)?;
        while node.span != *span {
            let items = &node.group.as_ref()?.items;
            node = &items.iter().find(|item| item.value.span.start <= span.start && span.end <= item.value.span.end)?.value;
        }
        Some(node)
    }
}

/// A part of a value by its name, and where to point at for it.
fn inner<'a>(body: &str, node: &'a Node, name: &str) -> Option<(usize, &'a Node)> {
    let group = node.unwrapped(body).group.as_ref()?;
    let are_pairs = group.bracket == '{';
    let is_named = |key: Option<&Range<usize>>| match key {
        Some(key) if are_pairs => body[key.clone()].trim_matches('"') == name,
        key => merge::key(body, key) == Some(name),
    };
    let item = group.items.iter().find(|item| is_named(item.key.as_ref()));
    let item = item.or_else(|| group.items.get(name.parse::<usize>().ok()?).filter(|item| item.key.is_none()))?;
    Some((if are_pairs { item.start() } else { item.value.span.start }, &item.value))
}
