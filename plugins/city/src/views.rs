use serde::{Deserialize, Serialize};

use crate::{Tour, Viewpoint};

/// Fixed stands in a city from which stills are taken, always the same: `X.views.ron`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Views {
    /// The city: a path relative to the file, or a URL.
    pub city: String,
    /// The stills.
    pub stills: Vec<Still>,
    /// Stands before single houses, each of which is shown at every level of detail.
    #[serde(default)]
    pub houses: Vec<Viewpoint>,
}

/// A still: from where, when, and in what weather.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Still {
    /// Name of its picture: letters, digits, `_` and `-`.
    pub name: String,
    /// Stand and direction.
    pub at: Viewpoint,
    /// Vertical field of view, degrees.
    #[serde(default = "Tour::default_fov_deg")]
    pub fov_deg: f64,
    /// Local solar time, hours, 0 to 24.
    #[serde(default = "Tour::default_hour")]
    pub hour: f64,
    /// Day of the year, 1 to 366.
    #[serde(default = "Tour::default_day")]
    pub day: u16,
    /// How wet the streets are, 0 to 1.
    #[serde(default)]
    pub wet: f64,
}

impl Views {
    /// What is wrong with it, a sentence each.
    #[must_use]
    pub fn validate(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        if self.city.is_empty() {
            wrong.push("it names no city: write city: \"town.graph.ron\"".to_owned());
        }
        for (i, still) in self.stills.iter().enumerate() {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
            if still.name.is_empty() || !still.name.chars().all(is_plain) {
                wrong.push(format!("still {}: `{}` is no name for a picture: use letters, digits, `_` and `-`", i + 1, still.name));
            }
            if self.stills[..i].iter().any(|other| other.name == still.name) {
                wrong.push(format!("still {}: the name `{}` is taken", i + 1, still.name));
            }
            let mut within = |what: &str, value: f64, least: f64, most: f64| {
                if !(least..=most).contains(&value) {
                    wrong.push(format!("still `{}`: {what} is {value}; give {least} to {most}", still.name));
                }
            };
            within("fov_deg", still.fov_deg, 5.0, 150.0);
            within("hour", still.hour, 0.0, 24.0);
            within("day", still.day.into(), 1.0, 366.0);
            within("wet", still.wet, 0.0, 1.0);
        }
        let stands = self.stills.iter().map(|still| &still.at).chain(&self.houses);
        for (i, at) in stands.enumerate() {
            let numbers = [at.pos.x, at.pos.y, at.eye_m, at.heading_deg, at.pitch_deg];
            if !numbers.iter().all(|n| n.is_finite() && n.abs() < 2e6) {
                wrong.push(format!("stand {}: its numbers are not all finite and below 2,000,000", i + 1));
            }
        }
        wrong
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_mistake_is_told() {
        let text = r#"(city: "", stills: [
            (name: "a b", at: (pos: (0, 0))),
            (name: "c", at: (pos: (0, 0)), fov_deg: 170, hour: 25, day: 0, wet: 2),
            (name: "c", at: (pos: (9e9, 0))),
        ], houses: [(pos: (0, 0), eye_m: inf)])"#;
        let views: Views = ron::from_str(text).expect("it can be read");
        let wrong = views.validate();
        let told = ["no city", "a b", "fov_deg is 170", "hour is 25", "day is 0", "wet is 2", "`c` is taken", "stand 3", "stand 4"];
        assert_eq!(wrong.len(), told.len(), "{wrong:#?}");
        for (wrong, told) in wrong.iter().zip(told) {
            assert!(wrong.contains(told), "{wrong} does not tell {told}");
        }
    }
}
