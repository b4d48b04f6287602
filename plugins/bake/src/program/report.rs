use core::fmt::Write;

use anstream::{eprint, eprintln};
use veduta_city::{Finding, Severity};

/// How many places are named of each kind of finding.
const PLACES: usize = 3;

/// Tells on the standard error stream what was dropped or repaired: every finding, or a summary by kind.
pub(crate) fn report(findings: &[Finding], quiet: bool, all: bool) {
    if quiet || findings.is_empty() {
        return;
    }
    if all {
        findings.iter().for_each(|finding| eprintln!("{finding}"));
    } else {
        eprint!("{}", summary(findings));
        eprintln!("(each one: bake --findings)");
    }
}

/// Tells every finding about a file.
pub(crate) fn report_all(findings: &[Finding], file: &str, quiet: bool) {
    if !quiet {
        findings.iter().for_each(|finding| eprintln!("{file}: {finding}"));
    }
}

/// Findings of one kind: those of one severity whose messages differ in numbers and names alone.
struct Kind<'a> {
    message: String,
    findings: Vec<&'a Finding>,
    /// How many things they tell of.
    things: u64,
}

/// The findings grouped by severity and kind, the most frequent first, each with its first places.
fn summary(findings: &[Finding]) -> String {
    let mut text = String::new();
    for (severity, word) in [(Severity::Dropped, "dropped"), (Severity::Repaired, "repaired"), (Severity::Note, "notes")] {
        let mut kinds: Vec<Kind<'_>> = Vec::new();
        for finding in findings.iter().filter(|f| f.severity == severity) {
            let (message, things) = things_of(&finding.message);
            let message = kind_of(message);
            match kinds.iter_mut().find(|kind| kind.message == message) {
                Some(kind) => {
                    kind.findings.push(finding);
                    kind.things += things;
                }
                None => kinds.push(Kind { message, findings: vec![finding], things }),
            }
        }
        if kinds.is_empty() {
            continue;
        }
        kinds.sort_by_key(|kind| core::cmp::Reverse(kind.things));
        let count: u64 = kinds.iter().map(|kind| kind.things).sum();
        // Writing to a string does not fail.
        let _ = writeln!(text, "{word}: {count}");
        kinds.iter().for_each(|kind| tell(kind, &mut text));
    }
    text
}

fn tell(kind: &Kind<'_>, text: &mut String) {
    let message = match kind.findings.as_slice() {
        [one] => things_of(&one.message).0,
        _ => &kind.message,
    };
    let _ = writeln!(text, "{:>7} × {message}", kind.things);
    let places: Vec<String> = kind.findings.iter().filter_map(|finding| place(finding)).take(PLACES).collect();
    if !places.is_empty() {
        let more = if kind.things > places.len() as u64 { ", …" } else { "" };
        let _ = writeln!(text, "          {}{more}", places.join(", "));
    }
}

/// A message and how many things it tells of: a stage may tell of many alike in one finding, “… (first of 12)”.
fn things_of(message: &str) -> (&str, u64) {
    let told = message.strip_suffix(')').and_then(|m| m.rsplit_once(" (first of "));
    told.and_then(|(message, n)| Some((message, n.parse().ok()?))).unwrap_or((message, 1))
}

/// Which thing, and where; `None` if neither is known.
fn place(finding: &Finding) -> Option<String> {
    let pos = finding.plan_pos.map(|p| format!("at ({:.0}, {:.0})", p.x, p.y));
    match (finding.id.is_given(), pos) {
        (true, Some(pos)) => Some(format!("{} {pos}", finding.id)),
        (true, None) => Some(finding.id.to_string()),
        (false, pos) => pos,
    }
}

/// A message with an ellipsis for each number and for what stands between quotes.
fn kind_of(message: &str) -> String {
    let mut kind = String::with_capacity(message.len());
    let mut quote = None;
    let mut is_number = false;
    for c in message.chars() {
        if let Some(end) = quote {
            if c == end {
                quote = None;
                kind.push('…');
                kind.push(c);
            }
            continue;
        }
        let was_number = is_number;
        is_number = c.is_ascii_digit() || (was_number && matches!(c, '.' | ',' | '/' | '-'));
        match c {
            '"' | '`' => {
                quote = Some(c);
                kind.push(c);
            }
            '“' => {
                quote = Some('”');
                kind.push(c);
            }
            _ if is_number => {
                if !was_number {
                    kind.push('…');
                }
            }
            _ => kind.push(c),
        }
    }
    kind
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use veduta_city::Id;

    use super::*;

    #[test]
    fn findings_are_grouped_by_kind_the_most_frequent_first() {
        let finding = |severity, x: f64, message: &str| Finding::new(severity, Id::NONE, Some(DVec2::new(x, 1.0)), message);
        let mut findings = vec![
            finding(Severity::Note, 1.0, "a width of \"-2\" is not believed"),
            finding(Severity::Dropped, 2.0, "a tower leans"),
            finding(Severity::Note, 3.0, "a width of \"0.3\" is not believed (first of 7)"),
        ];
        findings
            .extend((0..5).map(|i| finding(Severity::Dropped, f64::from(i), &format!("{i}.5 of {} vertices are missing", 9 + i))));
        assert_eq!(
            summary(&findings),
            "dropped: 6
      5 × … of … vertices are missing
          at (0, 1), at (1, 1), at (2, 1), …
      1 × a tower leans
          at (2, 1)
notes: 8
      8 × a width of \"…\" is not believed
          at (1, 1), at (3, 1), …
"
        );
    }

    #[test]
    fn an_unclosed_quote_ends_with_the_message() {
        assert_eq!(kind_of("a width of \"3"), "a width of \"");
    }
}
