//! How it stands with what a client asks for.

use super::ClientSettings;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) enum State {
    #[default]
    Missing,
    InFlight,
    Here,
    /// Trying again cannot help.
    Dead,
}

/// How it stands with one thing that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Slot {
    pub(super) state: State,
    /// Failures in a row.
    pub(super) failures: u32,
    /// When the first of them was told; later by the time in which nobody was there to answer.
    pub(super) failing_since_s: f64,
    /// Nobody has been there to answer since then.
    pub(super) silent_since_s: Option<f64>,
    /// Not asked for before this time.
    pub(super) again_s: f64,
    /// It failed because nobody answered: when somebody does, it need not wait so long.
    pub(super) is_unreachable: bool,
}

impl Slot {
    pub(super) fn is_due(&self, now_s: f64) -> bool {
        self.state == State::Missing && (self.failures == 0 || now_s >= self.again_s)
    }

    /// Notes that it failed, and returns in how many seconds it may be asked for again: so long after it was asked for as is waited after so
    /// many failures, but not at once. A failure that took long has waited already.
    pub(super) fn fail(&mut self, settings: &ClientSettings, failure: Failure, took_s: f64, now_s: f64) -> f64 {
        if self.failures == 0 {
            self.failing_since_s = now_s;
        }
        if failure.is_outage {
            self.silent_since_s.get_or_insert(now_s);
        } else if let Some(since_s) = self.silent_since_s.take() {
            self.failing_since_s += now_s - since_s;
        }
        self.failures = self.failures.saturating_add(1);
        self.state = State::Missing;
        self.is_unreachable = failure.is_unreachable;
        let wait_s = (back_off_s(settings, self.failures) - took_s).max(back_off_s(settings, 1));
        self.again_s = now_s + wait_s;
        wait_s
    }

    /// Notes that somebody answers again.
    pub(super) fn hope(&mut self, until_s: f64) {
        if self.state == State::Missing && self.is_unreachable {
            self.again_s = self.again_s.min(until_s);
        }
    }

    /// Whether it cannot be had: nothing can help, or nothing has for so long, not counting what nobody was there to answer.
    pub(super) fn gave_up(&self, now_s: f64, patience_s: f64) -> bool {
        let until_s = self.silent_since_s.unwrap_or(now_s);
        self.state == State::Dead || (self.failures > 0 && until_s - self.failing_since_s >= patience_s)
    }
}

/// What a failure says beside that something did not come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Failure {
    /// It did not come because nobody answered for it.
    pub(super) is_unreachable: bool,
    /// Nobody was there to answer for anything.
    pub(super) is_outage: bool,
}

/// How it stands with a region and with its cells, by level.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RegionSlot {
    pub(super) slot: Slot,
    /// None as long as the region is not here.
    pub(super) cells: Vec<[Slot; 4]>,
}

impl RegionSlot {
    pub(super) fn slots_mut(&mut self) -> impl Iterator<Item = &mut Slot> {
        self.cells.iter_mut().flatten().chain([&mut self.slot])
    }
}

/// Seconds to wait after so many failures in a row: doubled each time, up to the cap.
fn back_off_s(settings: &ClientSettings, failures: u32) -> f64 {
    // Beyond 2^60 times anything the cap holds.
    let doublings = failures.saturating_sub(1).min(60);
    (settings.retry_first_s * (1_u64 << doublings) as f64).min(settings.retry_cap_s)
}
