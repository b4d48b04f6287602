use bevy::prelude::*;

/// How many bytes a second have come of late while something was on its way, over whatever line there is: small packets over a late
/// line come slowly, too. By the app's time.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq, Default)]
#[reflect(Resource)]
pub struct Pace {
    bytes: f64,
    /// Seconds in which they came.
    came_in_s: f64,
    /// Seconds waited since something came last: what is large comes in one piece after long.
    waited_s: f64,
    last_s: Option<f64>,
}

impl Pace {
    /// What came so many seconds of waiting ago counts for a third.
    const MEMORY_S: f64 = 4.0;
    /// No wait counts for longer: after an outage the line is soon as fast as before.
    const LONGEST_S: f64 = 30.0;
    /// So long one must have waited for a line to be called slow.
    const LEAST_S: f64 = 0.5;

    /// A frame has brought so many bytes; `was_waiting` if any were on their way before it.
    pub(crate) fn pass(&mut self, now_s: f64, was_waiting: bool, bytes: u64) {
        let passed_s = (now_s - self.last_s.replace(now_s).unwrap_or(now_s)).max(0.0);
        if !was_waiting || passed_s == 0.0 {
            return;
        }
        self.waited_s = (self.waited_s + passed_s).min(Self::LONGEST_S);
        if bytes > 0 {
            let waited_s = core::mem::take(&mut self.waited_s);
            let stays = (-waited_s / Self::MEMORY_S).exp();
            self.bytes = self.bytes * stays + bytes as f64;
            self.came_in_s = self.came_in_s * stays + waited_s;
        }
    }

    /// Bytes a second; `None` as long as nobody has waited enough to tell.
    #[must_use]
    pub fn bytes_s(&self) -> Option<f64> {
        let waited_s = self.came_in_s + self.waited_s;
        (waited_s >= Self::LEAST_S).then(|| self.bytes / waited_s)
    }

    /// Bytes that come within so many seconds; no limit as long as nobody can tell, and for infinitely many.
    pub(crate) fn bytes_within(&self, seconds: f64) -> u64 {
        match self.bytes_s() {
            Some(bytes_s) if seconds.is_finite() => (bytes_s * seconds) as u64,
            _ => u64::MAX,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds of frames that bring so many bytes each, while something is on its way.
    fn wait(pace: &mut Pace, seconds: f64, bytes: u64) {
        let from_s = pace.last_s.unwrap_or(0.0);
        let frames = (seconds * 50.0) as u32;
        (0..=frames).for_each(|frame| pace.pass(from_s + f64::from(frame) / 50.0, true, bytes));
    }

    #[test]
    fn a_slow_line_is_told_from_an_idle_one() {
        let mut pace = Pace::default();
        (0..5_000).for_each(|frame| pace.pass(f64::from(frame) / 50.0, false, 0));
        assert_eq!(pace.bytes_s(), None, "nothing was asked for");
        wait(&mut pace, 0.3, 10);
        assert_eq!(pace.bytes_s(), None, "too early to tell");
        wait(&mut pace, 10.0, 10);
        let slow = pace.bytes_s().expect("it is known by now");
        assert!((slow - 500.0).abs() < 10.0, "{slow}");
        let before = pace;
        (0..500).for_each(|frame| pace.pass(before.last_s.unwrap_or(0.0) + f64::from(frame) / 50.0, false, 0));
        assert_eq!(pace.bytes_s(), before.bytes_s(), "an idle line is as fast as it was");
        wait(&mut pace, 12.0, 1_000);
        let fast = pace.bytes_s().expect("known");
        assert!((45_000.0..50_500.0).contains(&fast), "what was long ago is forgotten: {fast}");
    }

    #[test]
    fn a_large_piece_after_a_long_wait_is_no_sign_of_haste() {
        let mut pace = Pace::default();
        for second in 0..200_u32 {
            pace.pass(f64::from(second), true, if second % 20 == 0 { 6_000 } else { 0 });
        }
        let slow = pace.bytes_s().expect("known");
        assert!((150.0..310.0).contains(&slow), "{slow}");
    }

    #[test]
    fn an_outage_is_soon_forgotten() {
        let mut pace = Pace::default();
        wait(&mut pace, 10.0, 1_000);
        wait(&mut pace, 600.0, 0);
        assert!(pace.bytes_s().is_some_and(|bytes_s| bytes_s < 10_000.0), "{pace:?}");
        assert!(pace.bytes_within(2.0) < 20_000);
        assert_eq!((pace.bytes_within(f64::INFINITY), Pace::default().bytes_within(2.0)), (u64::MAX, u64::MAX));
        wait(&mut pace, 15.0, 1_000);
        assert!(pace.bytes_s().is_some_and(|bytes_s| bytes_s > 20_000.0), "{pace:?}");
    }

    #[test]
    fn where_no_time_passes_nothing_is_known() {
        let mut pace = Pace::default();
        (0..100).for_each(|_| pace.pass(7.0, true, 1_000));
        assert_eq!(pace.bytes_s(), None);
    }
}
