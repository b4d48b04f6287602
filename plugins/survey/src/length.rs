//! Lengths and angles as people tag them (<https://wiki.openstreetmap.org/wiki/Map_features/Units>).

/// Metres of a length: `12`, `12 m`, `12,5`, `~12`, `1 km`, `40'`, `40 ft`, `5'6"`, `3600"`; of a list (`12;14`) the first.
/// `None` if it is no length.
pub(crate) fn metres(text: &str) -> Option<f64> {
    let text = text.split(';').next()?.trim().trim_start_matches(['~', '≈', '>', '<', '+']).trim_end_matches('+').trim();
    let (number, unit) = leading_number(text)?;
    let metres = match unit.trim().to_lowercase().as_str() {
        "" | "m" | "m." | "mt" | "mtr" | "meter" | "metre" | "meters" | "metres" => number,
        "km" => number * 1000.0,
        "cm" => number / 100.0,
        "ft" | "ft." | "foot" | "feet" | "'" | "’" | "′" => number * 0.3048,
        "\"" | "''" | "in" | "inch" | "″" | "”" => number * 0.0254,
        feet_and_inches => {
            let rest = feet_and_inches.strip_prefix(['\'', '’', '′']).or_else(|| feet_and_inches.strip_prefix("ft"))?;
            let (inches, unit) = leading_number(rest.trim_start())?;
            matches!(unit.trim(), "\"" | "''" | "in" | "″" | "”" | "").then_some((number * 12.0 + inches) * 0.0254)?
        }
    };
    metres.is_finite().then_some(metres)
}

/// A plain number, with a comma or a point; of a list the first.
pub(crate) fn number(text: &str) -> Option<f64> {
    let (number, rest) = leading_number(text.split(';').next()?.trim())?;
    rest.trim().is_empty().then_some(number)
}

/// Degrees clockwise from north, in [0, 360): `45`, `45°`, `NE`, `north-east`.
pub(crate) fn bearing(text: &str) -> Option<f64> {
    const NAMES: [&str; 16] = ["n", "nne", "ne", "ene", "e", "ese", "se", "sse", "s", "ssw", "sw", "wsw", "w", "wnw", "nw", "nnw"];
    let text = text.split(';').next()?.trim().to_lowercase();
    if let Some((number, rest)) = leading_number(&text) {
        return matches!(rest.trim(), "" | "°" | "deg").then(|| number.rem_euclid(360.0)).filter(|d| d.is_finite());
    }
    let short: String = text
        .replace("north", "n")
        .replace("south", "s")
        .replace("east", "e")
        .replace("west", "w")
        .chars()
        .filter(char::is_ascii_alphabetic)
        .collect();
    NAMES.iter().position(|&n| n == short).map(|i| i as f64 * 22.5)
}

/// The number that a text begins with, and the rest. A comma before one or two digits is a decimal comma.
fn leading_number(text: &str) -> Option<(f64, &str)> {
    let end = text
        .char_indices()
        .find(|&(i, c)| !(c.is_ascii_digit() || c == '.' || c == ',' || (i == 0 && (c == '-' || c == '+'))))
        .map_or(text.len(), |(i, _)| i);
    let (digits, rest) = text.split_at(end);
    let value: f64 = digits.replace(',', ".").parse().ok()?;
    value.is_finite().then_some((value, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_read_as_people_write_them() {
        for (text, expected) in [
            ("12", 12.0),
            ("12 m", 12.0),
            ("12m", 12.0),
            ("12,5", 12.5),
            ("~7.5", 7.5),
            ("4.6+", 4.6),
            ("0.1 km", 100.0),
            ("300'", 91.44),
            ("40 ft", 12.192),
            ("3600\"", 91.44),
            ("298'24\"", 91.44),
            ("5 ft 6 in", 1.676_4),
            ("12;14", 12.0),
            (".5", 0.5),
            ("-2", -2.0),
        ] {
            let got = metres(text).unwrap_or_else(|| panic!("{text} is a length"));
            assert!((got - expected).abs() < 1e-9, "{text}: {got}");
        }
        for text in ["", "high", "12 storeys", "1.2.3", "m", "'"] {
            assert_eq!(metres(text), None, "{text}");
        }
    }

    #[test]
    fn bearings_are_numbers_or_names() {
        assert_eq!(bearing("370"), Some(10.0));
        assert_eq!(bearing("45°"), Some(45.0));
        assert_eq!(bearing("NNW"), Some(337.5));
        assert_eq!(bearing("south-east"), Some(135.0));
        assert_eq!(bearing("along"), None);
    }
}
