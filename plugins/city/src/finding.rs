use core::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::Id;

/// How much a [`Finding`] matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Severity {
    /// Worth knowing; nothing is lost.
    Note,
    /// The thing was mended and kept.
    Repaired,
    /// The thing was left out.
    Dropped,
}

/// Something a stage dropped or repaired, with its place and the reason. Importers and growers return these beside their
/// result, so that nothing is lost in silence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Finding {
    /// How much it matters.
    pub severity: Severity,
    /// The thing concerned, or [`Id::NONE`].
    pub id: Id,
    /// Where, in plan metres, if known.
    pub plan_pos: Option<DVec2>,
    /// What happened and why, in a sentence without a full stop.
    pub message: String,
}

impl Finding {
    /// A finding about a thing.
    #[must_use]
    pub fn new(severity: Severity, id: Id, plan_pos: Option<DVec2>, message: impl Into<String>) -> Self {
        Self { severity, id, plan_pos, message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match self.severity {
            Severity::Note => "note",
            Severity::Repaired => "repaired",
            Severity::Dropped => "dropped",
        };
        write!(f, "{word}: ")?;
        if self.id.is_given() {
            write!(f, "{} ", self.id)?;
        }
        if let Some(p) = self.plan_pos {
            write!(f, "at ({:.1}, {:.1}) ", p.x, p.y)?;
        }
        write!(f, "{}", self.message)
    }
}
