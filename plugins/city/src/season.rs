use serde::{Deserialize, Serialize};

/// Season, as trees know it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Season {
    /// Young leaves, blossom.
    Spring,
    /// Full leaf.
    #[default]
    Summer,
    /// Leaves turned.
    Autumn,
    /// Bare boughs.
    Winter,
}

/// Between these latitudes trees keep their leaves all year, degrees.
const TROPIC_DEG: f64 = 23.5;
/// First days of spring, summer, autumn and winter in the north: the first of March, June, September and December.
const FIRST_DAYS: [u16; 4] = [60, 152, 244, 335];

impl Season {
    /// All of them, from spring.
    pub const ALL: [Self; 4] = [Self::Spring, Self::Summer, Self::Autumn, Self::Winter];

    /// The season of a day of the year (1 to 366) at a latitude (degrees, north positive), by months; always summer in the tropics.
    #[must_use]
    pub fn at(lat_deg: f64, day: u16) -> Self {
        if lat_deg.abs() < TROPIC_DEG {
            return Self::Summer;
        }
        let begun = FIRST_DAYS.iter().rposition(|&first| day >= first).unwrap_or(3);
        // The south is half a year ahead.
        Self::ALL[if lat_deg < 0.0 { (begun + 2) % 4 } else { begun }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seasons_follow_the_months_and_turn_about_in_the_south() {
        use Season::{Autumn, Spring, Summer, Winter};
        for (day, north, south) in [
            (1, Winter, Summer),
            (59, Winter, Summer),
            (60, Spring, Autumn),
            (75, Spring, Autumn),
            (160, Summer, Winter),
            (243, Summer, Winter),
            (250, Autumn, Spring),
            (334, Autumn, Spring),
            (335, Winter, Summer),
            (366, Winter, Summer),
        ] {
            assert_eq!((Season::at(50.0, day), Season::at(-34.0, day), Season::at(1.3, day)), (north, south, Summer), "{day}");
        }
    }
}
