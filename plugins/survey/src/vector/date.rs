//! Dates as historic maps give them: the useful part of EDTF (<https://www.loc.gov/standards/datetime/>) and of
//! OpenStreetMap's `start_date` (<https://wiki.openstreetmap.org/wiki/Key:start_date>).

use core::fmt;
use core::str::FromStr;

/// A day as a number that sorts: year · 10,000 + month · 100 + day.
pub(super) type Day = i64;

/// Years from here on are how tables write "until today".
const NEVER: i64 = 9000;

/// When something may have been: from a day to a day, both included; `None` is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Span {
    pub from: Option<Day>,
    pub to: Option<Day>,
}

impl Span {
    /// Reads a date, a period or an open interval: `1850`, `1850-05`, `1850-05-12`, `~1850`, `1850?`, `185X`, `1850s`, `C19`,
    /// `1850/1860`, `1850..1860`, `../1860`, `/1860`, `before 1850`, `after 1850`, `late 1850s`.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = text.trim().to_lowercase();
        let text = text.trim_matches(['[', ']', '{', '}', ' ']);
        let open = |side: &str| side.trim_matches(['.', ' ']).is_empty() || matches!(side.trim(), "open" | "unknown");
        let side = |side: &str| if open(side) { Some(Self::default()) } else { Self::period(side) };
        if let Some((from, to)) = text.split_once('/').or_else(|| text.split_once("..")) {
            if open(from) && open(to) {
                return None;
            }
            return Some(Self { from: side(from)?.from, to: side(to)?.to });
        }
        Self::period(text)
    }

    /// One date or period with the words around it.
    fn period(text: &str) -> Option<Self> {
        let text = text.trim();
        for word in ["before ", "until ", "by ", "<"] {
            if let Some(rest) = text.strip_prefix(word) {
                return Some(Self { from: None, to: Self::period(rest)?.to });
            }
        }
        for word in ["after ", "since ", "from ", ">"] {
            if let Some(rest) = text.strip_prefix(word) {
                return Some(Self { from: Self::period(rest)?.from, to: None });
            }
        }
        for word in ["early ", "mid ", "mid-", "late ", "about ", "around ", "circa ", "ca. ", "ca ", "c. ", "~", "≈", "j:"] {
            if let Some(rest) = text.strip_prefix(word) {
                return Self::period(rest);
            }
        }
        let plain = text.trim_end_matches(['~', '?', '%']).trim_end();
        if let Some(number) = plain.strip_prefix('c').and_then(|n| n.parse::<i64>().ok()).filter(|n| (1..=99).contains(n)) {
            return Some(Self::of_years(100 * (number - 1) + 1, 100 * number));
        }
        if let Some(decade) = plain.strip_suffix('s').filter(|d| d.len() == 4 && d.ends_with('0')) {
            let first: i64 = decade.parse().ok()?;
            return Some(Self::of_years(first, first + 9));
        }
        Self::day_month_or_year(plain)
    }

    /// Whether a day lies in a span of which both ends are known.
    pub(super) fn contains(&self, day: Day) -> bool {
        self.from.is_some_and(|from| from <= day) && self.to.is_some_and(|to| day <= to)
    }

    fn of_years(first: i64, last: i64) -> Self {
        Self { from: Some(first * 10_000 + 101), to: Some(last * 10_000 + 1231) }
    }

    fn day_month_or_year(text: &str) -> Option<Self> {
        let text = text.split('t').next().unwrap_or(text);
        let (sign, rest) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
        let is_digits = |t: &str| !t.is_empty() && t.bytes().all(|b| b.is_ascii_digit());
        // Tables without a column for dates write them in one.
        if is_digits(rest) && rest.len() == 8 {
            return Self::day_month_or_year(&format!("{}-{}-{}", &rest[..4], &rest[4..6], &rest[6..]));
        }
        let mut parts = rest.split('-');
        let year = parts.next()?;
        let unknown = year.len() - year.trim_end_matches(['x', 'u']).len();
        if unknown > 0 {
            let known: i64 = year.get(..year.len() - unknown)?.parse().ok()?;
            let wide = 10_i64.checked_pow(u32::try_from(unknown).ok()?).filter(|_| year.len() == 4)?;
            return (sign == 1).then(|| Self::of_years(known * wide, known * wide + wide - 1));
        }
        if !is_digits(year) || year.len() > 4 {
            return None;
        }
        let year: i64 = sign * year.parse::<i64>().ok()?;
        let part = |text: Option<&str>| match text {
            None => Some(None),
            Some(t) if !t.is_empty() && t.bytes().all(|b| matches!(b, b'x' | b'u')) => Some(None),
            Some(t) => t.parse::<i64>().ok().filter(|_| is_digits(t)).map(Some),
        };
        let (month, day) = (part(parts.next())?, part(parts.next())?);
        if parts.next().is_some() {
            return None;
        }
        match (month, day) {
            (None, _) => Some(Self::of_years(year, year)),
            (Some(m), None) if (1..=12).contains(&m) => {
                let at = year * 10_000 + m * 100;
                Some(Self { from: Some(at + 1), to: Some(at + days_of(year, m)) })
            }
            (Some(m), Some(d)) if (1..=12).contains(&m) && (1..=days_of(year, m)).contains(&d) => {
                let at = year * 10_000 + m * 100 + d;
                Some(Self { from: Some(at), to: Some(at) })
            }
            _ => None,
        }
    }
}

fn days_of(year: i64, month: i64) -> i64 {
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    match month {
        2 => 28 + i64::from(is_leap),
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// A day in the past that a city is shown at: `1876-05-12`, or the last day of a month or year, `1876-05` or `1876`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Date {
    day: Day,
    text: String,
}

/// A text that is no date.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no date: write a year, a month or a day, such as 1876, 1876-05 or 1876-05-12")]
pub struct ParseDateError(String);

impl Date {
    /// The day, as a number that sorts.
    pub(super) fn day(&self) -> Day {
        self.day
    }
}

impl FromStr for Date {
    type Err = ParseDateError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || ParseDateError(text.to_owned());
        let span = Span::parse(text).ok_or_else(error)?;
        // A period of which neither end is known, or half of it, is no time to be at.
        match (span.from, span.to) {
            (Some(_), Some(day)) => Ok(Self { day, text: text.trim().to_owned() }),
            _ => Err(error()),
        }
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Whether something stands at a date.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    Stands,
    NotYet,
    NoMore,
}

/// Whether what began and ended then stands at a date; without one, whether it has no end. What is only roughly known counts
/// for the longest time that it allows. The last day is one of standing, as OpenHistoricalMap has it.
pub(super) fn standing(start: Span, end: Span, at: Option<&Date>) -> Standing {
    let end = end.to.filter(|day| *day < NEVER * 10_000);
    match at {
        None if end.is_some() => Standing::NoMore,
        None => Standing::Stands,
        Some(date) if start.from.is_some_and(|day| day > date.day) => Standing::NotYet,
        Some(date) if end.is_some_and(|day| day < date.day) => Standing::NoMore,
        Some(_) => Standing::Stands,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn dates_read_as_maps_write_them() {
        for (text, from, to) in [
            ("1850", Some(18_500_101), Some(18_501_231)),
            ("1850-02", Some(18_500_201), Some(18_500_228)),
            ("1904-02", Some(19_040_201), Some(19_040_229)),
            ("1850-05-12", Some(18_500_512), Some(18_500_512)),
            ("18500512", Some(18_500_512), Some(18_500_512)),
            ("1850-05-12T10:00:00Z", Some(18_500_512), Some(18_500_512)),
            ("~1850", Some(18_500_101), Some(18_501_231)),
            ("1850?", Some(18_500_101), Some(18_501_231)),
            ("1850-xx-xx", Some(18_500_101), Some(18_501_231)),
            ("185X", Some(18_500_101), Some(18_591_231)),
            ("18uu", Some(18_000_101), Some(18_991_231)),
            ("late 1850s", Some(18_500_101), Some(18_591_231)),
            ("C19", Some(18_010_101), Some(19_001_231)),
            ("1850/1860-05", Some(18_500_101), Some(18_600_531)),
            ("[1850..1860]", Some(18_500_101), Some(18_601_231)),
            ("../1860", None, Some(18_601_231)),
            ("/1860", None, Some(18_601_231)),
            ("1850..", Some(18_500_101), None),
            ("before 1850", None, Some(18_501_231)),
            ("after 1850-05", Some(18_500_501), None),
            ("-0100", Some(-999_899), Some(-998_769)),
        ] {
            assert_eq!(Span::parse(text), Some(Span { from, to }), "{text}");
        }
        for text in ["", "..", "/", "soon", "1850-13", "1850-02-30", "18500", "1850-1-2-3", "xxxx", "C0", "5X", "1850 or so"] {
            assert_eq!(Span::parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_date_lies_between_beginning_and_end_both_included() {
        let at = |text: &str| text.parse::<Date>().unwrap();
        let life = |start: &str, end: &str, date: &str| {
            standing(Span::parse(start).unwrap_or_default(), Span::parse(end).unwrap_or_default(), Some(&at(date)))
        };
        assert_eq!(life("1841", "1876", "1876"), Standing::Stands);
        assert_eq!(life("1877", "", "1876"), Standing::NotYet);
        assert_eq!(life("1841", "1876", "1877"), Standing::NoMore);
        assert_eq!(life("1841-06", "", "1841"), Standing::Stands, "a year is meant as its end");
        assert_eq!(life("1841", "1927-06-04", "1927"), Standing::NoMore);
        assert_eq!(life("", "", "1700"), Standing::Stands);
        assert_eq!(life("", "9999-12-31", "2020"), Standing::Stands);
        let span = |t| Span::parse(t).unwrap();
        assert_eq!(standing(span("1841"), span("1876"), None), Standing::NoMore);
        assert_eq!(standing(span("1841"), span("9999-12-31"), None), Standing::Stands);
        assert_eq!(standing(span("1841"), Span::default(), None), Standing::Stands);
    }

    #[test]
    fn half_a_period_is_no_time_to_be_at() {
        assert!("after 1850".parse::<Date>().is_err());
        let error = "yesterday".parse::<Date>().unwrap_err().to_string();
        assert!(error.contains("`yesterday`") && error.contains("1876-05"), "{error}");
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "[-0-9xs~/.cTé ]{0,14}") {
            let _ = Span::parse(&text);
        }

        #[test]
        fn spans_do_not_run_backwards(year in -3000_i64..3000, month in 1_i64..13) {
            let span = Span::parse(&format!("{}{:04}-{month:02}", if year < 0 { "-" } else { "" }, year.abs())).unwrap();
            prop_assert!(span.from <= span.to);
        }
    }
}
