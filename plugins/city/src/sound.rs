use serde::{Deserialize, Serialize};

use crate::SurfaceKind;

/// A sound: made from numbers, or recorded. What is made is the same for the same numbers and seed, on any machine.
///
/// ```
/// let text = r#"[Bell(strike_hz: 196, weight_kg: 1400), Rain(strength: 0.5), File("organ.ogg")]"#;
/// let sounds: Vec<veduta_city::Sound> = veduta_city::file::parse(text, "sounds")?;
/// assert!(sounds.iter().all(|sound| sound.validate().is_empty()));
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Sound {
    /// A recording in Ogg Vorbis: a path relative to the file that names it.
    File(String),
    /// One stroke of a bell, which rings until it has died away.
    Bell {
        /// The note that is heard as its own: that of its prime partial, hertz.
        strike_hz: f64,
        /// Its weight: heavy bells ring longer. Kilograms.
        weight_kg: f64,
    },
    /// Water that falls or flows, for ever.
    Water {
        /// How broad and deep it rushes, 0 to 1: a river, a weir.
        flow: f64,
        /// How much of it breaks to drops in the air, 0 to 1: a fountain.
        spray: f64,
        /// How much of it bubbles, 0 to 1.
        bubbles: f64,
        /// How far it comes and goes, as waves against a quay, 0 to 1.
        lapping: f64,
    },
    /// Wind about roofs and corners, for ever.
    Wind {
        /// From a draught, 0, to a gale, 1.
        strength: f64,
    },
    /// Rain on paving, for ever.
    Rain {
        /// From a drizzle, 0, to a cloudburst, 1.
        strength: f64,
    },
    /// People who talk, too far off for words to be understood; for ever.
    Murmur {
        /// How many are told apart, 1 to 24.
        people: u8,
    },
    /// Songbirds, for ever.
    Birds {
        /// How often one calls, in a minute, 1 to 240.
        calls: f64,
    },
    /// Birds that fly up, once.
    Wings {
        /// How many, 1 to 24.
        birds: u8,
    },
    /// One step of a walker: heel, then toe.
    Step {
        /// What is trodden on.
        on: Footfall,
    },
    /// A summer's night, for ever.
    Night {
        /// How many crickets are told apart, 0 to 12.
        crickets: u8,
        /// Whether a dog barks now and then, far away.
        #[serde(default)]
        dog: bool,
    },
}

/// What ground sounds like under a heel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Footfall {
    /// Setts: hard and uneven.
    #[default]
    Cobble,
    /// Flagstones and asphalt: hard and even.
    Flagstone,
    /// Gravel, ballast, earth: grains that give way.
    Gravel,
    /// Grass.
    Grass,
    /// Planks.
    Wood,
}

impl Footfall {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Cobble, Self::Flagstone, Self::Gravel, Self::Grass, Self::Wood];

    /// What a surface sounds like; `None` of what nobody walks on.
    #[must_use]
    pub const fn of(surface: SurfaceKind) -> Option<Self> {
        match surface {
            SurfaceKind::Cobbles => Some(Self::Cobble),
            SurfaceKind::Asphalt | SurfaceKind::Mosaic | SurfaceKind::Flagstones => Some(Self::Flagstone),
            SurfaceKind::Gravel | SurfaceKind::Yard | SurfaceKind::Ballast => Some(Self::Gravel),
            SurfaceKind::Grass => Some(Self::Grass),
            SurfaceKind::Water | SurfaceKind::Opening => None,
        }
    }

    /// The name of the cue of a step on it.
    #[must_use]
    pub const fn cue(self) -> &'static str {
        match self {
            Self::Cobble => "step.cobble",
            Self::Flagstone => "step.flagstone",
            Self::Gravel => "step.gravel",
            Self::Grass => "step.grass",
            Self::Wood => "step.wood",
        }
    }
}

impl Sound {
    /// A fountain of middling size.
    pub const FOUNTAIN: Self = Self::Water { flow: 0.25, spray: 0.7, bubbles: 0.8, lapping: 0.0 };
    /// A broad river that passes by.
    pub const RIVER: Self = Self::Water { flow: 0.45, spray: 0.0, bubbles: 0.2, lapping: 0.8 };
    /// Water that falls over a weir.
    pub const WEIR: Self = Self::Water { flow: 1.0, spray: 0.6, bubbles: 0.3, lapping: 0.1 };

    /// Whether it goes on for ever; of a recording, whether it is meant to is not known.
    #[must_use]
    pub const fn is_endless(&self) -> bool {
        !matches!(self, Self::File(_) | Self::Bell { .. } | Self::Wings { .. } | Self::Step { .. })
    }

    /// What is wrong with its numbers, a phrase each.
    #[must_use]
    pub fn validate(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut within = |what: &str, value: f64, least: f64, most: f64| {
            if !(least..=most).contains(&value) {
                wrong.push(format!("{what} is {value}; give {least} to {most}"));
            }
        };
        match self {
            Self::File(path) => {
                if !is_beside(path) || !path.to_ascii_lowercase().ends_with(".ogg") {
                    wrong.push(format!("`{path}` must be the path of an .ogg file in or below the folder of this file"));
                }
            }
            Self::Bell { strike_hz, weight_kg } => {
                within("strike_hz", *strike_hz, 40.0, 4_000.0);
                within("weight_kg", *weight_kg, 0.05, 250_000.0);
            }
            Self::Water { flow, spray, bubbles, lapping } => {
                within("flow", *flow, 0.0, 1.0);
                within("spray", *spray, 0.0, 1.0);
                within("bubbles", *bubbles, 0.0, 1.0);
                within("lapping", *lapping, 0.0, 1.0);
            }
            Self::Wind { strength } | Self::Rain { strength } => within("strength", *strength, 0.0, 1.0),
            Self::Murmur { people } => within("people", f64::from(*people), 1.0, 24.0),
            Self::Birds { calls } => within("calls", *calls, 1.0, 240.0),
            Self::Wings { birds } => within("birds", f64::from(*birds), 1.0, 24.0),
            Self::Step { .. } => {}
            Self::Night { crickets, .. } => within("crickets", f64::from(*crickets), 0.0, 12.0),
        }
        wrong
    }
}

/// Whether a path leads to a file in or below the folder that it is read from, on any system.
#[must_use]
pub fn is_beside(path: &str) -> bool {
    let is_odd = |part: &str| part.is_empty() || part == ".." || part == ".";
    !path.is_empty() && !path.contains(['\\', ':', '\0', '#']) && !path.split('/').any(is_odd)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_bounds_are_told() {
        let bad = [
            (Sound::Bell { strike_hz: f64::NAN, weight_kg: 0.0 }, 2),
            (Sound::Water { flow: 2.0, spray: -1.0, bubbles: f64::INFINITY, lapping: 0.5 }, 3),
            (Sound::Wind { strength: 1.1 }, 1),
            (Sound::Murmur { people: 0 }, 1),
            (Sound::Birds { calls: 0.0 }, 1),
            (Sound::Wings { birds: 200 }, 1),
            (Sound::Night { crickets: 13, dog: true }, 1),
            (Sound::File("../other.ogg".into()), 1),
            (Sound::File("bell.mp3".into()), 1),
        ];
        for (sound, mistakes) in bad {
            assert_eq!(sound.validate().len(), mistakes, "{sound:?}: {:?}", sound.validate());
        }
        for good in [Sound::FOUNTAIN, Sound::RIVER, Sound::WEIR, Sound::File("a/b.ogg".into())] {
            assert!(good.validate().is_empty(), "{good:?}");
        }
    }

    #[test]
    fn paths_stay_beside_their_file() {
        for (path, is_good) in [
            ("a.ogg", true),
            ("sounds/a.ogg", true),
            ("", false),
            ("/etc/a.ogg", false),
            ("a/../../b.ogg", false),
            ("C:/a.ogg", false),
            ("a\\b.ogg", false),
            ("https://example.org/a.ogg", false),
        ] {
            assert_eq!(is_beside(path), is_good, "{path}");
        }
    }

    #[test]
    fn whatever_is_walked_on_sounds() {
        use SurfaceKind::{Asphalt, Ballast, Cobbles, Flagstones, Grass, Gravel, Mosaic, Opening, Water, Yard};
        for surface in [Asphalt, Ballast, Cobbles, Flagstones, Grass, Gravel, Mosaic, Opening, Water, Yard] {
            assert_eq!(Footfall::of(surface).is_some(), surface.is_walkable(), "{surface:?}");
        }
    }
}
