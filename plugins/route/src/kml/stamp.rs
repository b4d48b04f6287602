//! Moments of a year: as KML tells them, in universal time, and as a tour does, by the sun over the city.

/// The year of moments in exported tours: a leap year, so that every day of a tour has its date.
pub const YEAR: i64 = 2024;

/// Days before each month of [`YEAR`].
const BEFORE: [u16; 12] = [0, 31, 60, 91, 121, 152, 182, 213, 244, 274, 305, 335];

/// A day and an hour of the sun at a longitude, as a moment of [`YEAR`] in universal time.
pub(super) fn stamp(day: u16, hour: f64, lon: f64) -> String {
    let second = libm::round((f64::from(day.clamp(1, 366)) - 1.0) * 86_400.0 + (hour - lon / 15.0) * 3600.0);
    // The first and last hours of the year are taken for those of the other end.
    let second = second.rem_euclid(366.0 * 86_400.0) as u32;
    let (day, second) = ((second / 86_400) as u16, second % 86_400);
    let month = BEFORE.partition_point(|&before| before <= day);
    let of_month = day - BEFORE[month - 1] + 1;
    format!("{YEAR}-{month:02}-{of_month:02}T{:02}:{:02}:{:02}Z", second / 3600, second / 60 % 60, second % 60)
}

/// Day of the year and the sun's hour at a longitude of a moment as XML Schema writes it; what is cut off counts as its begin, and
/// noon of a day.
pub(super) fn read(when: &str, lon: f64) -> Option<(u16, f64)> {
    let (date, time) = match when.split_once('T') {
        Some((date, time)) => (date, Some(time)),
        None => (when, None),
    };
    let mut parts = date.split('-').map(|part| part.parse::<u16>().ok());
    parts.next()??;
    let month = parts.next().unwrap_or(Some(1)).filter(|month| (1..=12).contains(month))?;
    let of_month = parts.next().unwrap_or(Some(1)).filter(|day| (1..=31).contains(day))?;
    let day = (BEFORE[usize::from(month) - 1] + of_month).min(366);
    let hour = match time {
        Some(time) => universal_hour(time)? + lon / 15.0,
        None => 12.0,
    };
    let days = libm::floor(hour / 24.0);
    let day = (f64::from(day) - 1.0 + days).rem_euclid(366.0) as u16 + 1;
    Some((day, (hour - 24.0 * days).clamp(0.0, 24.0)))
}

/// Hours of a time of day with its zone, as in `18:30:05.5+02:00`.
fn universal_hour(time: &str) -> Option<f64> {
    let zone = time.find(['Z', '+', '-']).unwrap_or(time.len());
    let (clock, zone) = time.split_at(zone);
    let east = match zone.chars().next() {
        Some(sign @ ('+' | '-')) => clock_hours(&zone[1..])? * if sign == '-' { -1.0 } else { 1.0 },
        _ => 0.0,
    };
    Some(clock_hours(clock)? - east)
}

fn clock_hours(clock: &str) -> Option<f64> {
    let mut hours = 0.0;
    for (part, unit) in clock.split(':').zip([1.0, 60.0, 3600.0]) {
        hours += part.parse::<f64>().ok().filter(|part| (0.0..=60.0).contains(part))? / unit;
    }
    (hours <= 24.0).then_some(hours)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_is_read_as_it_was_written() {
        for (day, hour, lon) in [(1, 0.5, 14.4), (60, 12.0, 0.0), (160, 23.75, -122.0), (366, 9.25, 14.42)] {
            let text = stamp(day, hour, lon);
            let (read_day, read_hour) = read(&text, lon).unwrap_or_else(|| panic!("{text}"));
            assert!(read_day == day && (read_hour - hour).abs() < 1e-3, "{text}: {read_day}, {read_hour}");
        }
        assert_eq!(stamp(160, 10.0, 15.0), "2024-06-08T09:00:00Z");
        assert_eq!(read("2009-03-01T18:00:00+02:00", 30.0), Some((61, 18.0)));
        assert_eq!((read("2009-02", 0.0), read("soon", 0.0), read("2009-13-01", 0.0)), (Some((32, 12.0)), None, None));
    }
}
