use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{Finding, Id, Severity};

/// Collects findings. What happens again and again in one way (a tag that is not understood, ends beyond the border) is told
/// once, with how often and where first.
#[derive(Debug, Default)]
pub(crate) struct Log {
    findings: Vec<Finding>,
    tallies: BTreeMap<(Severity, String), (usize, Id, Option<DVec2>)>,
}

impl Log {
    pub(crate) fn push(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    pub(crate) fn note(&mut self, id: Id, plan_pos: Option<DVec2>, message: impl Into<String>) {
        self.push(Finding::new(Severity::Note, id, plan_pos, message));
    }

    pub(crate) fn repaired(&mut self, id: Id, plan_pos: Option<DVec2>, message: impl Into<String>) {
        self.push(Finding::new(Severity::Repaired, id, plan_pos, message));
    }

    pub(crate) fn dropped(&mut self, id: Id, plan_pos: Option<DVec2>, message: impl Into<String>) {
        self.push(Finding::new(Severity::Dropped, id, plan_pos, message));
    }

    /// One more of a kind that is told once.
    pub(crate) fn tally(&mut self, severity: Severity, id: Id, plan_pos: Option<DVec2>, message: impl Into<String>) {
        self.tallies.entry((severity, message.into())).or_insert((0, id, plan_pos)).0 += 1;
    }

    /// All findings: the single ones in order, then the tallies.
    pub(crate) fn finish(self) -> Vec<Finding> {
        let mut all = self.findings;
        for ((severity, message), (times, id, plan_pos)) in self.tallies {
            let message = if times == 1 { message } else { format!("{message} (first of {times})") };
            all.push(Finding::new(severity, id, plan_pos, message));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetition_is_told_once() {
        let mut log = Log::default();
        for i in 1..=3 {
            log.tally(Severity::Note, Id(i), None, "odd tag");
        }
        let all = log.finish();
        assert_eq!((all.len(), all[0].id, all[0].message.as_str()), (1, Id(1), "odd tag (first of 3)"));
    }
}
