use core::fmt;

use super::description::{CityWords, Plan, River};

/// What is wrong with a description, naming the field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WordsError {
    /// The field, as the file writes it.
    pub field: String,
    /// What is wrong and what would be right, in a clause without a full stop.
    pub reason: String,
}

impl fmt::Display for WordsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {}", self.field, self.reason)
    }
}

impl std::error::Error for WordsError {}

/// Sizes of towns, metres.
const SIZES_M: (f64, f64) = (200.0, 4_000.0);
/// Most districts.
const MOST_DISTRICTS: usize = 40;

impl CityWords {
    /// Everything wrong with the description, in order of its fields; empty if a city can be made of it.
    #[must_use]
    pub fn validate(&self) -> Vec<WordsError> {
        let mut list = List(Vec::new());
        if self.name.trim().is_empty() {
            list.add("name", "is empty; every city has a name");
        }
        list.range("anchor.lat", self.anchor.lat, -85.0, 85.0);
        list.range("anchor.lon", self.anchor.lon, -180.0, 180.0);
        list.range("density", self.density, 0.1, 1.0);
        self.check_size(&mut list);
        list.range("parks", self.parks, 0.0, 0.4);
        list.count("squares", Some(self.squares), 0, 40);
        self.plan.check(&mut list);
        if let Some(river) = &self.river {
            river.check(self.size_m(), &mut list);
        }
        if self.districts.len() > MOST_DISTRICTS {
            list.add("districts", &format!("are {}; there may be {MOST_DISTRICTS}", self.districts.len()));
        }
        for (i, district) in self.districts.iter().enumerate() {
            let field = |of: &str| format!("districts[{i}].{of}");
            if district.name.trim().is_empty() {
                list.add(&field("name"), "is empty; every district has a name");
            }
            if district.style.trim().is_empty() {
                list.add(&field("style"), "is empty; name a style, such as \"old_town\"");
            }
            if !(district.share > 0.0 && district.share <= 1.0) {
                list.add(&field("share"), &format!("is {:?}; it must be above 0 and at most 1", district.share));
            }
        }
        list.0
    }

    fn check_size(&self, list: &mut List) {
        match (self.size_m, self.population) {
            (None, None) => list.add("size_m", "is missing; give it, or `population`"),
            (Some(_), Some(_)) => list.add("population", "is given beside `size_m`; give one of them"),
            (Some(size_m), None) => list.range("size_m", size_m, SIZES_M.0, SIZES_M.1),
            (None, Some(n)) => {
                list.count("population", Some(n), 100, 1_000_000);
                let size_m = self.size_m();
                if (100..=1_000_000).contains(&n) && !(SIZES_M.0..=SIZES_M.1).contains(&size_m) {
                    let (low, high) = SIZES_M;
                    list.add(
                        "population",
                        &format!("of {n} at this density makes a town of {size_m:.0} m; it must have {low} to {high} m"),
                    );
                }
            }
        }
    }
}

impl Plan {
    fn check(&self, list: &mut List) {
        match self {
            Self::Grid { short_m, long_m, avenue_every, diagonals, heading_deg } => {
                for (field, (low, high)) in [("plan.short_m", *short_m), ("plan.long_m", *long_m)] {
                    if !(low >= 40.0 && low <= high && high <= 250.0) {
                        list.add(field, &format!("is ({low:?}, {high:?}); both must lie between 40 and 250, the lesser first"));
                    }
                }
                list.count("plan.avenue_every", Some(*avenue_every), 2, 12);
                list.count("plan.diagonals", Some(*diagonals), 0, 3);
                list.heading("plan.heading_deg", *heading_deg);
            }
            Self::Radial { boulevards, rings, block_m } => {
                list.count("plan.boulevards", *boulevards, 3, 16);
                list.count("plan.rings", *rings, 1, 8);
                list.range("plan.block_m", *block_m, 40.0, 200.0);
            }
            Self::Medieval { edge: _, gates, crooked, block_m } => {
                list.count("plan.gates", *gates, 2, 12);
                list.range("plan.crooked", *crooked, 0.0, 1.0);
                list.range("plan.block_m", *block_m, 30.0, 120.0);
            }
            Self::Mixed { core, roads, crooked, outside: _, block_m } => {
                list.range("plan.core", *core, 0.15, 0.7);
                list.count("plan.roads", *roads, 3, 14);
                list.range("plan.crooked", *crooked, 0.0, 1.0);
                list.range("plan.block_m", *block_m, 30.0, 120.0);
            }
        }
    }
}

impl River {
    fn check(&self, size_m: f64, list: &mut List) {
        list.range("river.width_m", self.width_m, 4.0, 250.0);
        if self.width_m > size_m / 4.0 && self.width_m <= 250.0 {
            list.add("river.width_m", &format!("is {:?}, more than a quarter of the town's {size_m:.0} m", self.width_m));
        }
        list.count("river.bends", Some(self.bends), 0, 12);
        list.count("river.bridges", self.bridges, 1, 24);
        list.heading("river.heading_deg", self.heading_deg);
    }
}

struct List(Vec<WordsError>);

impl List {
    fn add(&mut self, field: &str, reason: &str) {
        self.0.push(WordsError { field: field.to_owned(), reason: reason.to_owned() });
    }

    fn range(&mut self, field: &str, value: f64, least: f64, most: f64) {
        if !(least..=most).contains(&value) {
            self.add(field, &format!("is {value:?}; it must lie between {least} and {most}"));
        }
    }

    fn count(&mut self, field: &str, value: Option<u32>, least: u32, most: u32) {
        if let Some(value) = value.filter(|value| !(least..=most).contains(value)) {
            self.add(field, &format!("is {value}; it must lie between {least} and {most}"));
        }
    }

    fn heading(&mut self, field: &str, value: Option<f64>) {
        if let Some(value) = value.filter(|v| !(-360.0..=360.0).contains(v)) {
            self.add(field, &format!("is {value:?}; it must be degrees clockwise from north, within ±360"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> Vec<String> {
        let words: CityWords = veduta_city::file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        words.validate().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_cannot_be_meant_is_told_by_its_field() {
        let wrong = [
            ("name: \" \", size_m: 400, plan: Medieval()", "`name` is empty"),
            ("name: \"T\", plan: Medieval()", "`size_m` is missing; give it, or `population`"),
            ("name: \"T\", size_m: 400, population: 900, plan: Medieval()", "`population` is given beside `size_m`"),
            ("name: \"T\", size_m: 40, plan: Medieval()", "`size_m` is 40.0; it must lie between 200 and 4000"),
            ("name: \"T\", size_m: NaN, plan: Medieval()", "`size_m` is NaN"),
            ("name: \"T\", population: 200, plan: Medieval()", "`population` of 200 at this density makes a town of 116 m"),
            ("name: \"T\", population: 2, plan: Medieval()", "`population` is 2; it must lie between 100 and 1000000"),
            ("name: \"T\", size_m: 400, density: 0, plan: Medieval()", "`density` is 0.0"),
            ("name: \"T\", size_m: 400, squares: 41, plan: Medieval()", "`squares` is 41"),
            ("name: \"T\", size_m: 400, parks: inf, plan: Medieval()", "`parks` is inf"),
            ("name: \"T\", size_m: 400, plan: Medieval(crooked: 2)", "`plan.crooked` is 2.0"),
            ("name: \"T\", size_m: 400, plan: Grid(short_m: (90, 60))", "`plan.short_m` is (90.0, 60.0)"),
            ("name: \"T\", size_m: 400, plan: Grid(heading_deg: NaN)", "`plan.heading_deg` is NaN"),
            ("name: \"T\", size_m: 400, plan: Radial(rings: 0)", "`plan.rings` is 0"),
            ("name: \"T\", size_m: 400, plan: Mixed(core: 0.9)", "`plan.core` is 0.9"),
            ("name: \"T\", size_m: 400, plan: Mixed(), river: (width_m: 120)", "`river.width_m` is 120.0, more than a quarter"),
            ("name: \"T\", size_m: 400, plan: Mixed(), river: (bridges: 0)", "`river.bridges` is 0"),
            (
                "name: \"T\", size_m: 400, plan: Mixed(), districts: [(name: \"A\", style: \"modern\", share: 0)]",
                "`districts[0].share` is 0.0; it must be above 0",
            ),
            ("name: \"T\", size_m: 400, anchor: (lat: 99, lon: 0), plan: Mixed()", "`anchor.lat` is 99.0"),
        ];
        for (text, reason) in wrong {
            let told = told(&format!("({text})"));
            assert!(told.len() == 1 && told[0].starts_with(reason), "{text}: {told:?}");
        }
        assert_eq!(told("(name: \"T\", population: 9000, plan: Radial())"), [""; 0]);
    }

    #[test]
    fn a_misspelt_field_is_refused_with_its_line() {
        for (text, field) in [
            ("(name: \"T\",\n plan: Grid(blocks: 3))", "blocks"),
            ("(name: \"T\", plan: Medieval(),\n rivers: 2)", "rivers"),
            ("(name: \"T\", plan: Medieval(),\n river: (length_m: 2))", "length_m"),
            ("(name: \"T\", plan: Medieval(),\n districts: [(nam: \"x\")])", "nam"),
        ] {
            let error = veduta_city::file::parse::<CityWords>(text, "x.words.ron").expect_err(text);
            assert!(error.line == 2 && error.message.contains(field), "{error}");
        }
    }
}
