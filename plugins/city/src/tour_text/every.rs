//! Every mistake of a tour that cannot be read, as far as those before it let it be told.

use super::{TourText, syntax};
use crate::{
    Tour,
    file::{self, SyntaxError},
};

/// After so many mistakes the rest is not looked at.
const MOST: usize = 100;

impl TourText {
    /// Every mistake of a text that is no tour: a step whose brackets are whole is set aside, and reading goes on without it. What is
    /// wrong besides steps and brackets ends it.
    ///
    /// ```
    /// use veduta_city::TourText;
    ///
    /// let text = "(title: \"A walk\", city: \"x.city\", steps: [\n  Wait(second: 1),\n  Wait(seconds: 2),\n  Wlak(to: At(0, 0)),\n])";
    /// let lines: Vec<usize> = TourText::mistakes(text, "a.tour.ron").iter().map(|mistake| mistake.line).collect();
    /// assert_eq!(lines, [2, 4]);
    /// ```
    #[must_use]
    pub fn mistakes(text: &str, file: &str) -> Vec<SyntaxError> {
        let body = text.trim_start_matches('\u{feff}');
        let mut rest = body.to_owned();
        let mut mistakes = Vec::new();
        while mistakes.len() < MOST
            && let Err(mistake) = file::parse::<Tour>(&rest, file)
        {
            let at = file::byte_of(&rest, mistake.line, mistake.column);
            let place = file::byte_of(body, mistake.line, mistake.column);
            mistakes.push(SyntaxError::at(body, file, place, mistake.message));
            match without_step(&rest, at) {
                Some(without) => rest = without,
                None => break,
            }
        }
        mistakes
    }
}

/// A text with space in place of the step that stands at a byte.
fn without_step(text: &str, at: usize) -> Option<String> {
    let root = syntax::scan(text)?;
    let of_steps = |item: &&syntax::Item| item.key.clone().is_some_and(|key| syntax::plain(&text[key]) == "steps");
    let list = root.items('(')?.items.iter().find(of_steps)?.value.items('[')?;
    let step = list.items.iter().find(|item| (item.start()..=item.end()).contains(&at))?;
    let blank = |c: char| if c == '\n' { '\n' } else { ' ' };
    let (start, end) = (step.start(), step.end_with_comma());
    Some(text[..start].chars().chain(text[start..end].chars().map(blank)).chain(text[end..].chars()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(text: &str) -> Vec<(usize, usize)> {
        TourText::mistakes(text, "a.tour.ron").iter().map(|mistake| (mistake.line, mistake.column)).collect()
    }

    #[test]
    fn every_step_that_cannot_be_read_is_told_at_its_place() {
        let text =
            "\u{feff}(title: \"Ž\", city: \"x\", steps: [\n Wait(),\n Say(text: \"ž\"), Fov(d: 1),\n Wait(\n  s: 2,\n ),\n Ok, ])";
        assert_eq!(places(text), [(2, 7), (3, 22), (5, 3), (7, 2)]);
        let shown = TourText::mistakes(text, "a.tour.ron")[1].text.clone();
        assert!(shown.contains("Say(text: \"ž\"), Fov(d: 1)"), "the line is that of the text: {shown}");
    }

    #[test]
    fn what_is_not_a_step_ends_reading() {
        assert_eq!(places("(titel: \"T\", steps: [Wait()])"), [(1, 2)]);
        assert_eq!(places("(title: \"T\", city: \"x\", steps: [Wait(), Wait(])"), [(1, 38)]);
        assert_eq!(places("(title: \"T\", city: \"x\", steps: [Wait(seconds: 1)])"), []);
    }
}
