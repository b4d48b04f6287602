use veduta_city::Tells;

/// A city's clock that goes faster than this, hours a second, passes hours in silence: nobody could tell them apart.
const FASTEST: f64 = 0.25;
/// Who moves the clock further than this at once has set it, hours.
const LEAP: f64 = 0.25;
/// A clock that is set so near to an hour is set to it, hours; it then strikes after a breath.
const ON_THE_HOUR: f64 = 1.0 / 240.0;
const BREATH_S: f64 = 0.6;
/// Most quarters that one look tells of.
const MOST_MARKS: usize = 4;

/// A quarter of an hour that the city's clock has passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Quarters since midnight, 0 to 95.
    pub quarter: u32,
    /// When, in seconds of the time that frames are shown in.
    pub at_s: f64,
}

/// Looks at a clock and tells which quarters it passes, and when exactly, however many frames a second look at it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct ClockWatch {
    last: Option<(f64, f64)>,
}

/// What a look at the clock tells.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Look {
    /// Quarters that were passed, in order.
    pub marks: Vec<Mark>,
    /// Whether the clock was set: what was being struck stops.
    pub is_set: bool,
}

impl ClockWatch {
    /// Looks at an hour (0 to 24) at a time (seconds).
    pub(crate) fn look(&mut self, hour: f64, time_s: f64) -> Look {
        let Some((last_hour, last_s)) = self.last.replace((hour, time_s)) else { return Look::default() };
        let (moved, passed_s) = ((hour - last_hour + 12.0).rem_euclid(24.0) - 12.0, time_s - last_s);
        if moved == 0.0 {
            return Look::default();
        }
        let pace = moved / passed_s;
        if !(0.0..=LEAP).contains(&moved) || passed_s <= 0.0 || pace > FASTEST {
            let whole = hour.round();
            let is_on = (hour - whole).abs() < ON_THE_HOUR && passed_s >= 0.0;
            let mark = Mark { quarter: (whole as u32 % 24) * 4, at_s: time_s + BREATH_S };
            // A clock that is turned fast only passes its hours.
            let was_turned = passed_s > 0.0 && moved.abs() <= LEAP;
            return Look { marks: if is_on && !was_turned { vec![mark] } else { Vec::new() }, is_set: true };
        }
        let (first, last) = ((last_hour * 4.0).floor() as i64 + 1, ((last_hour + moved) * 4.0).floor() as i64);
        let marks = (first..=last).take(MOST_MARKS).map(|quarter| {
            let since_h = last_hour + moved - quarter as f64 / 4.0;
            Mark { quarter: quarter.rem_euclid(96) as u32, at_s: time_s - since_h / pace }
        });
        Look { marks: marks.collect(), is_set: false }
    }
}

/// How often a bell is struck at a quarter.
pub(crate) fn strokes(tells: &Tells, quarter: u32) -> u32 {
    let (hour, part) = (quarter / 4, quarter % 4);
    match tells {
        Tells::Hours if part == 0 => (hour + 11) % 12 + 1,
        Tells::Hours => 0,
        Tells::Quarters => (part + 3) % 4 + 1,
        Tells::At { hours, strokes } => {
            let is_now = hours.iter().any(|hour| (hour * 4.0).round() as u32 % 96 == quarter);
            if is_now { *strokes } else { 0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks of a clock that goes from an hour at a pace (city seconds a second) for some seconds, seen at some frames a second.
    fn watched(from: f64, pace: f64, seconds: f64, fps: f64) -> Vec<Mark> {
        let mut watch = ClockWatch::default();
        let frames = (seconds * fps) as u32;
        (0..=frames)
            .flat_map(|n| {
                let t = f64::from(n) / fps;
                watch.look((from + pace * t / 3600.0).rem_euclid(24.0), t).marks
            })
            .collect()
    }

    #[test]
    fn quarters_are_struck_when_they_are_due_at_any_frame_rate() {
        for (pace, seconds) in [(1.0, 2_000.0), (60.0, 70.0), (300.0, 30.0)] {
            let (slow, fast) = (watched(11.7, pace, seconds, 30.0), watched(11.7, pace, seconds, 144.0));
            assert!(!slow.is_empty());
            assert_eq!(slow.len(), fast.len(), "{slow:?}\n{fast:?}");
            for (a, b) in slow.iter().zip(&fast) {
                assert!(a.quarter == b.quarter && (a.at_s - b.at_s).abs() < 1e-6, "{a:?} {b:?}");
            }
            let due = (11.75 - 11.7) * 3600.0 / pace;
            assert!(slow[0].quarter == 47 && (slow[0].at_s - due).abs() < 1e-6, "{:?} at {due}", slow[0]);
        }
    }

    #[test]
    fn midnight_is_twelve_and_noon_too() {
        let marks = watched(23.99, 60.0, 2.0, 60.0);
        assert_eq!(marks.iter().map(|mark| mark.quarter).collect::<Vec<_>>(), [0]);
        let hours: Vec<u32> = (0..24).map(|hour| strokes(&Tells::Hours, hour * 4)).collect();
        assert_eq!(hours[0], 12);
        assert_eq!(hours[1..13], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
        assert_eq!(hours[23], 11);
        assert_eq!((0..5).map(|q| strokes(&Tells::Quarters, q)).collect::<Vec<_>>(), [4, 1, 2, 3, 4]);
        assert_eq!(strokes(&Tells::Hours, 5), 0);
        let angelus = Tells::At { hours: vec![6.0, 12.0, 18.25], strokes: 33 };
        assert_eq!([24, 48, 72, 73].map(|q| strokes(&angelus, q)), [33, 33, 0, 33]);
    }

    #[test]
    fn a_clock_that_is_set_or_turned_rings_no_hundred_bells() {
        let mut watch = ClockWatch::default();
        watch.look(9.0, 0.0);
        let set = watch.look(17.5, 1.0 / 60.0);
        assert_eq!((set.marks.len(), set.is_set), (0, true), "a tour sets the hour");
        let noon = watch.look(12.0, 2.0 / 60.0);
        assert_eq!(noon.marks.iter().map(|mark| mark.quarter).collect::<Vec<_>>(), [48], "who sets it to noon hears noon");
        assert!(noon.is_set && noon.marks[0].at_s > 2.0 / 60.0);
        // Held keys turn it by an hour and a half a second, forwards and backwards.
        for step in [0.025, -0.025] {
            let mut hour = 12.0;
            for n in 3..600 {
                hour += step;
                let look = watch.look(hour, f64::from(n) / 60.0);
                assert!(look.marks.is_empty(), "{hour}");
            }
            watch.look(12.0, 10.0);
        }
        assert_eq!(watch.look(12.0, 11.0), Look::default(), "it stands");
        assert!(watch.look(3.1, 11.0).marks.is_empty(), "set while time stands");
    }
}
