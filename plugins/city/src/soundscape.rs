use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{Footfall, ObjectKind, Season, Sound};

/// What a city sounds like: `X.sound.ron`. What a file leaves out is as it is in every city.
///
/// ```
/// let text = r#"(
///     sources: [
///         (name: "Mill weir", pos: (-420, 130), radius_m: 12, sound: Water(flow: 1, spray: 0.6, bubbles: 0.3, lapping: 0.1)),
///     ],
///     cues: {
///         "bell.tyn": (sound: Bell(strike_hz: 138.6, weight_kg: 6500), level_db: 4, radius_m: 30),
///     },
/// )"#;
/// let sounds: veduta_city::Soundscape = veduta_city::file::parse(text, "town.sound.ron")?;
/// assert!(sounds.validate().is_empty());
/// assert_eq!(sounds.cue("bell.tyn.second"), sounds.cue("bell.tyn"));
/// assert!(sounds.cue("step.grass").is_some(), "as in every city");
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Soundscape {
    /// What is heard where one stands, from all about; in place of [`Soundscape::usual_beds`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beds: Option<Vec<Bed>>,
    /// What is heard from a spot, besides what stands in the city and sounds by its kind.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SoundSource>,
    /// What is heard once when something happens: by its name. Those of [`Soundscape::usual_cues`] are there unless they are given anew.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cues: BTreeMap<String, CueSound>,
}

/// Where one stands, as far as it is heard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Setting {
    /// Between rows of houses.
    Lane,
    /// In the open, on paving.
    Square,
    /// On grass and among trees.
    Park,
    /// By the water.
    Bank,
    /// On a bridge.
    Bridge,
    /// Under an arcade, or in a tunnel.
    Arcade,
}

impl Setting {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Lane, Self::Square, Self::Park, Self::Bank, Self::Bridge, Self::Arcade];
}

/// What in the weather makes a sound louder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum Follows {
    /// Nothing.
    #[default]
    Nothing,
    /// Rain: silent without.
    Rain,
    /// Dry weather: silent in rain.
    Dry,
    /// Wind, and how high one is above the ground.
    Wind,
}

/// When something is heard.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heard {
    /// From one hour to another, 0 to 24, also past midnight; at all hours if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hours: Option<(f64, f64)>,
    /// Seasons; all if none is given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seasons: Vec<Season>,
    /// Weather.
    #[serde(default)]
    pub follows: Follows,
}

/// A sound from all about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bed {
    /// The sound: an endless one, or a recording that is repeated.
    pub sound: Sound,
    /// Decibels above the sound as it is made.
    #[serde(default)]
    pub level_db: f64,
    /// Where; everywhere if none is given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<Setting>,
    /// When.
    #[serde(default)]
    pub when: Heard,
}

/// A sound from a spot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoundSource {
    /// What it is, for people.
    pub name: String,
    /// Plan metres.
    pub pos: DVec2,
    /// Metres above the ground.
    #[serde(default = "SoundSource::usual_height_m")]
    pub height_m: f64,
    /// So far around it is as loud as it gets, metres; at twice the distance half as loud.
    #[serde(default = "SoundSource::usual_radius_m")]
    pub radius_m: f64,
    /// The sound: an endless one, or a recording that is repeated.
    pub sound: Sound,
    /// Decibels above the sound as it is made.
    #[serde(default)]
    pub level_db: f64,
    /// When.
    #[serde(default)]
    pub when: Heard,
}

impl SoundSource {
    const fn usual_height_m() -> f64 {
        1.0
    }
    const fn usual_radius_m() -> f64 {
        3.0
    }

    /// What a standing object sounds like by its kind, if it does; at the city's zero until it is put where it stands.
    #[must_use]
    pub fn of_object(kind: ObjectKind) -> Option<Self> {
        let source = |name: &str, radius_m, sound, level_db| Self {
            name: name.to_owned(),
            pos: DVec2::ZERO,
            height_m: Self::usual_height_m(),
            radius_m,
            sound,
            level_db,
            when: Heard::default(),
        };
        (kind == ObjectKind::Fountain).then(|| source("fountain", 3.0, Sound::FOUNTAIN, -4.0))
    }
}

/// The sound of a cue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CueSound {
    /// The sound: one that ends.
    pub sound: Sound,
    /// Decibels above the sound as it is made.
    #[serde(default)]
    pub level_db: f64,
    /// So far around it is as loud as it gets, metres.
    #[serde(default = "SoundSource::usual_radius_m")]
    pub radius_m: f64,
}

/// Within so many hours a sound comes and goes at the ends of its time.
const DAWN_H: f64 = 0.75;

impl Heard {
    /// How much is heard at an hour in a season, rain and wind apart: 0 to 1.
    #[must_use]
    pub fn share(&self, hour: f64, season: Season) -> f64 {
        if !(self.seasons.is_empty() || self.seasons.contains(&season)) {
            return 0.0;
        }
        let Some((from, to)) = self.hours else { return 1.0 };
        let length = (to - from).rem_euclid(24.0);
        let since = (hour - from).rem_euclid(24.0);
        // Hours to the nearer end of its time: positive within it.
        let within = if since <= length { since.min(length - since) } else { -(since - length).min(24.0 - since) };
        (within / DAWN_H + 0.5).clamp(0.0, 1.0)
    }

    fn validate(&self, of: &str, wrong: &mut Vec<String>) {
        if let Some((from, to)) = self.hours {
            for hour in [from, to] {
                if !(0.0..=24.0).contains(&hour) {
                    wrong.push(format!("{of}: the hour {hour} is none; give 0 to 24"));
                }
            }
            if from == to {
                wrong.push(format!("{of}: its hours begin and end at {from}; leave them out for the whole day"));
            }
        }
    }
}

impl Soundscape {
    /// Beds as in every city: what follows from where one stands, the hour, the season and the weather.
    #[must_use]
    pub fn usual_beds() -> Vec<Bed> {
        use Follows::{Dry, Nothing, Rain, Wind};
        use Season::{Autumn, Spring, Summer};
        use Setting::{Arcade, Bank, Bridge, Lane, Park, Square};
        let bed = |sound: Sound, level_db: f64, at: &[Setting], hours: Option<(f64, f64)>, seasons: &[Season], follows: Follows| {
            Bed { sound, level_db, at: at.to_vec(), when: Heard { hours, seasons: seasons.to_vec(), follows } }
        };
        vec![
            bed(Sound::Murmur { people: 10 }, -7.0, &[Square], Some((8.0, 22.5)), &[], Nothing),
            bed(Sound::Murmur { people: 4 }, -15.0, &[Lane, Arcade, Bridge], Some((8.5, 21.5)), &[], Nothing),
            bed(Sound::Birds { calls: 40.0 }, -10.0, &[Park], Some((4.5, 20.5)), &[Spring, Summer, Autumn], Dry),
            bed(Sound::Birds { calls: 14.0 }, -18.0, &[Lane, Square, Bank], Some((5.0, 20.0)), &[Spring, Summer], Dry),
            bed(Sound::RIVER, -7.0, &[Bank, Bridge], None, &[], Nothing),
            bed(Sound::Wind { strength: 0.4 }, -10.0, &[], None, &[], Wind),
            bed(Sound::Rain { strength: 0.5 }, -2.0, &[], None, &[], Rain),
            bed(Sound::Night { crickets: 5, dog: true }, -16.0, &[], Some((21.5, 4.0)), &[Summer], Dry),
        ]
    }

    /// Cues as in every city: a bell, wings, steps.
    #[must_use]
    pub fn usual_cues() -> BTreeMap<String, CueSound> {
        let step = |on: Footfall| (on.cue(), Sound::Step { on }, -14.0, 1.0);
        let cues = [
            ("bell", Sound::Bell { strike_hz: 247.0, weight_kg: 900.0 }, 0.0, 25.0),
            ("wings", Sound::Wings { birds: 6 }, -4.0, 5.0),
            step(Footfall::Cobble),
            step(Footfall::Flagstone),
            step(Footfall::Gravel),
            step(Footfall::Grass),
            step(Footfall::Wood),
        ];
        let cue =
            |(name, sound, level_db, radius_m): (&str, Sound, f64, f64)| (name.to_owned(), CueSound { sound, level_db, radius_m });
        cues.into_iter().map(cue).collect()
    }

    /// Its beds.
    #[must_use]
    pub fn all_beds(&self) -> Vec<Bed> {
        self.beds.clone().unwrap_or_else(Self::usual_beds)
    }

    /// The sound of a cue: that of its name, else of its name without what follows the last dot, and so on; else as in every city.
    #[must_use]
    pub fn cue(&self, name: &str) -> Option<CueSound> {
        let usual = Self::usual_cues();
        let mut shorter = Some(name);
        while let Some(name) = shorter {
            if let Some(cue) = self.cues.get(name).or_else(|| usual.get(name)) {
                return Some(cue.clone());
            }
            shorter = name.rsplit_once('.').map(|(head, _)| head);
        }
        None
    }

    /// Recordings that it names, each once.
    #[must_use]
    pub fn files(&self) -> BTreeSet<&str> {
        let beds = self.beds.iter().flatten().map(|bed| &bed.sound);
        let sources = self.sources.iter().map(|source| &source.sound);
        let sounds = beds.chain(sources).chain(self.cues.values().map(|cue| &cue.sound));
        sounds.filter_map(|sound| if let Sound::File(path) = sound { Some(path.as_str()) } else { None }).collect()
    }

    /// What is wrong with it, a sentence each.
    #[must_use]
    pub fn validate(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut check = |of: &str, sound: &Sound, level_db: f64, is_once: bool, when: Option<&Heard>| {
            wrong.extend(sound.validate().into_iter().map(|mistake| format!("{of}: {mistake}")));
            if !(-80.0..=24.0).contains(&level_db) {
                wrong.push(format!("{of}: level_db is {level_db}; give -80 to 24"));
            }
            if is_once && sound.is_endless() {
                wrong.push(format!("{of}: the sound never ends; name it among `beds` or `sources`, or take another"));
            }
            if !is_once && !sound.is_endless() && !matches!(sound, Sound::File(_)) {
                wrong.push(format!("{of}: the sound is heard once; name it among `cues`, or take another"));
            }
            if let Some(when) = when {
                when.validate(of, &mut wrong);
            }
        };
        for (n, bed) in self.beds.iter().flatten().enumerate() {
            check(&format!("bed {}", n + 1), &bed.sound, bed.level_db, false, Some(&bed.when));
        }
        for source in &self.sources {
            check(&format!("source “{}”", source.name), &source.sound, source.level_db, false, Some(&source.when));
        }
        for (name, cue) in &self.cues {
            check(&format!("cue “{name}”"), &cue.sound, cue.level_db, true, None);
        }
        for (n, source) in self.sources.iter().enumerate() {
            if source.name.trim().is_empty() {
                wrong.push(format!("source {}: it has no name", n + 1));
            }
            if ![source.pos.x, source.pos.y].iter().all(|n| n.is_finite() && n.abs() < 2e6) {
                wrong.push(format!("source “{}”: its position must be plan metres below 2,000,000", source.name));
            }
            if !(-200.0..=1_000.0).contains(&source.height_m) {
                wrong.push(format!("source “{}”: height_m is {}; give -200 to 1000", source.name, source.height_m));
            }
        }
        let of_source = |source: &SoundSource| (format!("source “{}”", source.name), source.radius_m);
        let radii = self.sources.iter().map(of_source);
        for (of, radius_m) in radii.chain(self.cues.iter().map(|(name, cue)| (format!("cue “{name}”"), cue.radius_m))) {
            if !(0.1..=1_000.0).contains(&radius_m) {
                wrong.push(format!("{of}: radius_m is {radius_m}; give 0.1 to 1000"));
            }
        }
        for name in self.cues.keys() {
            let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "._-".contains(c);
            if name.is_empty() || !name.chars().all(is_plain) || name.split('.').any(str::is_empty) {
                wrong.push(format!("cue “{name}”: write its name in small letters, digits, `_` and `-`, parts after a dot"));
            }
        }
        wrong
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_every_city_has_is_valid() {
        let all = Soundscape { beds: Some(Soundscape::usual_beds()), cues: Soundscape::usual_cues(), ..Soundscape::default() };
        assert_eq!(all.validate(), Vec::<String>::new());
        for setting in Setting::ALL {
            let heard = |bed: &&Bed| bed.at.is_empty() || bed.at.contains(&setting);
            assert!(Soundscape::usual_beds().iter().filter(heard).count() >= 3, "something is heard of a {setting:?}");
        }
        for on in Footfall::ALL {
            assert!(Soundscape::default().cue(on.cue()).is_some(), "{on:?}");
        }
    }

    #[test]
    fn each_mistake_is_told_with_its_owner() {
        let text = r#"(
            beds: [(sound: Step(on: Grass)), (sound: Wind(strength: 3), level_db: 99, when: (hours: (25, 3)))],
            sources: [(name: " ", pos: (9e9, 0), radius_m: 0, sound: Rain(strength: 1), when: (hours: (3, 3)))],
            cues: {"Bell": (sound: Rain(strength: 1)), "bell..x": (sound: File("/x.ogg"))},
        )"#;
        let sounds: Soundscape = crate::file::parse(text, "x.sound.ron").expect("it can be read");
        let wrong = sounds.validate();
        let told = [
            "bed 1: the sound is heard once",
            "bed 2: strength is 3",
            "bed 2: level_db is 99",
            "bed 2: the hour 25",
            "begin and end at 3",
            "cue “Bell”: the sound never ends",
            "`/x.ogg` must be",
            "source 1: it has no name",
            "2,000,000",
            "radius_m is 0",
            "cue “Bell”: write its name",
            "cue “bell..x”: write its name",
        ];
        for told in told {
            assert!(wrong.iter().any(|wrong| wrong.contains(told)), "{told} in {wrong:#?}");
        }
        assert_eq!(wrong.len(), told.len(), "{wrong:#?}");
    }

    #[test]
    fn cues_fall_back_to_shorter_names() {
        let own = CueSound { sound: Sound::Wings { birds: 2 }, level_db: 0.0, radius_m: 3.0 };
        let sounds = Soundscape { cues: [("wings.dove".to_owned(), own.clone())].into(), ..Soundscape::default() };
        assert_eq!(sounds.cue("wings.dove.white"), Some(own));
        assert_eq!(sounds.cue("wings.crow"), Soundscape::usual_cues().remove("wings"));
        assert_eq!(sounds.cue("trumpet.loud"), None);
    }

    #[test]
    fn hours_pass_midnight_and_have_soft_edges() {
        let night = Heard { hours: Some((21.0, 4.0)), ..Heard::default() };
        let day = Heard { hours: Some((8.0, 22.0)), ..Heard::default() };
        let share = |heard: &Heard, hour| heard.share(hour, Season::Summer);
        for hour in [22.0, 0.0, 2.0, 3.5] {
            assert_eq!(share(&night, hour), 1.0, "{hour}");
        }
        for hour in [5.0, 12.0, 20.0] {
            assert_eq!(share(&night, hour), 0.0, "{hour}");
        }
        assert_eq!((share(&day, 15.0), share(&day, 3.0)), (1.0, 0.0));
        for (heard, edge) in [(&night, 21.0), (&night, 4.0), (&day, 8.0), (&day, 22.0)] {
            assert!((share(heard, edge) - 0.5).abs() < 1e-9, "{edge}: {}", share(heard, edge));
        }
        // Never a jump, whatever the hour.
        for heard in [&night, &day] {
            let all: Vec<f64> = (0..=24_000).map(|n| share(heard, f64::from(n) / 1_000.0)).collect();
            assert!(all.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.002));
        }
        let spring = Heard { seasons: vec![Season::Spring], ..Heard::default() };
        assert_eq!((spring.share(3.0, Season::Spring), spring.share(3.0, Season::Winter)), (1.0, 0.0));
    }
}
