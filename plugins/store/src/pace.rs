//! When to stop waiting for a server: by whether anything comes, not by how long all of it takes.
//!
//! Each byte buys the connection that it came on some time, up to a bound: a slow line goes on, one that drips or is silent does not. As
//! long as bytes come on other connections of the same reader, a silent one is waited for longer: on a slow line an answer waits behind
//! those before it. It does not wait behind those that were asked for well after it: one that they overtake is lost. All this is below
//! encryption, which passes on nothing before a block is whole.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use ureq::unversioned::transport::{Buffers, ConnectionDetails, Connector, NextTimeout, Transport, time};
use ureq::{Error, Timeout};

/// How long is waited.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pace {
    /// For something to come.
    pub stall: Duration,
    /// So much longer, as long as something comes on other connections.
    pub patience: Duration,
    /// Slowest line that is waited for, bytes a second.
    pub least_bytes_s: f64,
}

impl Pace {
    /// What so many bytes buy.
    fn worth(&self, bytes: usize) -> Duration {
        Duration::try_from_secs_f64(bytes as f64 / self.least_bytes_s).map_or(self.stall, |worth| worth.min(self.stall))
    }

    /// Until when a connection is waited for that was until then, now that so many bytes came on it.
    fn later(&self, until: Instant, bytes: usize, now: Instant) -> Instant {
        (until + self.worth(bytes)).min(now + self.stall)
    }
}

/// What all connections of a reader have in common.
#[derive(Debug, Clone)]
pub(crate) struct Paced {
    pace: Pace,
    news: Arc<Mutex<News>>,
}

/// What came of late.
#[derive(Debug, Default)]
struct News {
    /// Until when what came on any connection counts as a line that moves.
    moving: Option<Instant>,
    /// When the last of all was asked that something has come of.
    asked: Option<Instant>,
}

impl Paced {
    pub fn new(pace: Pace) -> Self {
        Self { pace, news: Arc::default() }
    }

    /// So many bytes came of what was asked then.
    fn note(&self, bytes: usize, asked: Instant, now: Instant) {
        let mut news = self.news.lock().unwrap_or_else(PoisonError::into_inner);
        news.moving = Some(self.pace.later(news.moving.map_or(now, |until| until.max(now)), bytes, now));
        news.asked = news.asked.max(Some(asked));
    }

    /// How long to wait, before looking again, for a connection that is waited for until then and was last heard of then; `None` if no
    /// longer.
    fn wait(&self, (until, heard): (Instant, Instant), now: Instant) -> Option<Duration> {
        /// How often is looked whether others move.
        const LOOK: Duration = Duration::from_millis(100);
        if let Some(left) = until.checked_duration_since(now).filter(|left| !left.is_zero()) {
            return Some(left);
        }
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner);
        // A few bytes are no line that moves.
        let is_moving = news.moving.is_some_and(|until| until > now + self.pace.stall / 5);
        let is_overtaken = news.asked.is_some_and(|asked| asked > heard + self.pace.stall * 2 / 5);
        (now < until + self.pace.patience && is_moving && !is_overtaken).then_some(LOOK)
    }
}

impl<In: Transport> Connector<In> for Paced {
    type Out = PacedLine<In>;

    fn connect(&self, _: &ConnectionDetails<'_>, chained: Option<In>) -> Result<Option<PacedLine<In>>, Error> {
        let now = Instant::now();
        Ok(chained.map(|line| PacedLine { line, common: self.clone(), until: now + self.pace.stall, asked: now, heard: now }))
    }
}

/// A connection that is waited for as long as something comes.
#[derive(Debug)]
pub(crate) struct PacedLine<In> {
    line: In,
    common: Paced,
    /// Until when it is waited for.
    until: Instant,
    /// When something was last asked on it.
    asked: Instant,
    /// When something was last asked on it, or came.
    heard: Instant,
}

impl<In: Transport> Transport for PacedLine<In> {
    fn buffers(&mut self) -> &mut dyn Buffers {
        self.line.buffers()
    }

    fn transmit_output(&mut self, amount: usize, timeout: NextTimeout) -> Result<(), Error> {
        self.asked = Instant::now();
        (self.heard, self.until) = (self.asked, self.asked + self.common.pace.stall);
        self.line.transmit_output(amount, timeout)
    }

    fn await_input(&mut self, timeout: NextTimeout) -> Result<bool, Error> {
        let began = Instant::now();
        loop {
            let now = Instant::now();
            let wait = self.common.wait((self.until, self.heard), now).ok_or(Error::Timeout(Timeout::PerRead))?;
            let left = timeout.after.saturating_sub(now - began);
            let after = time::Duration::Exact(wait.min(left).max(Duration::from_millis(1)));
            let before = self.line.buffers().input().len();
            match self.line.await_input(NextTimeout { after, ..timeout }) {
                Err(Error::Timeout(_)) if !left.saturating_sub(*after).is_zero() => {}
                Ok(true) => {
                    let (bytes, now) = (self.line.buffers().input().len().saturating_sub(before), Instant::now());
                    (self.heard, self.until) = (now, self.common.pace.later(self.until, bytes, now));
                    self.common.note(bytes, self.asked, now);
                    return Ok(true);
                }
                other => return other,
            }
        }
    }

    fn is_open(&mut self) -> bool {
        self.line.is_open()
    }

    fn is_tls(&self) -> bool {
        self.line.is_tls()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACE: Pace = Pace { stall: Duration::from_millis(2_500), patience: Duration::from_millis(7_500), least_bytes_s: 512.0 };

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    #[test]
    fn what_comes_fast_enough_is_waited_for_and_what_drips_is_not() {
        let began = Instant::now();
        // A packet of the network each so many milliseconds: until when is it waited for?
        let ends = |bytes: usize, each_ms: u64| {
            let (mut now, mut until) = (began, began + PACE.stall);
            while now < until && now < began + ms(60_000) {
                now += ms(each_ms);
                if now < until {
                    until = PACE.later(until, bytes, now);
                }
            }
            (until - began).as_millis() as u64
        };
        assert!(ends(1_460, 2_000) > 60_000, "700 bytes a second");
        assert!(ends(60, 100) > 60_000, "in small parts");
        assert!(ends(10, 1_000) < 2_700, "ten bytes a second");
        assert!(ends(25, 100) < 5_200, "half of the slowest line");
        assert_eq!(ends(1 << 20, 5_000), 2_500, "silence");
    }

    #[test]
    fn a_silent_connection_is_waited_for_longer_while_others_move() {
        let (common, now) = (Paced::new(PACE), Instant::now());
        let (asked, wait) = (now, |at: Instant| common.wait((now + ms(2_500), now), at));
        assert_eq!(wait(now + ms(1_800)), Some(ms(700)));
        let ended = now + ms(2_500);
        assert_eq!(wait(ended), None, "nothing has come at all");
        common.note(40, asked, ended);
        assert_eq!(wait(ended), None, "a few bytes are no line that moves");
        common.note(4_000, asked, ended);
        assert!(wait(ended).is_some() && wait(ended + ms(1_900)).is_some());
        assert_eq!(wait(ended + ms(2_100)), None, "nothing came any more");
        common.note(4_000, asked, now + ms(10_100));
        assert_eq!(wait(now + ms(10_100)), None, "not for ever");
    }

    #[test]
    fn what_is_overtaken_is_lost() {
        let (common, now) = (Paced::new(PACE), Instant::now());
        let waits = || common.wait((now + ms(2_500), now), now + ms(2_600)).is_some();
        common.note(4_000, now + ms(900), now + ms(2_600));
        assert!(waits(), "asked for at about the same time");
        common.note(4_000, now + ms(1_100), now + ms(2_600));
        assert!(!waits(), "asked for later");
    }
}
