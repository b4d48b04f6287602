use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A guided tour: a list of steps, played one after another.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tour {
    /// Title shown to the visitor.
    pub title: String,
    /// The title in other languages: by the language's code.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub translations: BTreeMap<String, String>,
    /// The city it belongs to: a path relative to the tour's file, or a URL.
    pub city: String,
    /// Walking speed in metres a second where a step gives none.
    #[serde(default = "Tour::default_speed")]
    pub speed: f64,
    /// Eye height in metres where a step gives none.
    #[serde(default = "Tour::default_eye_m")]
    pub eye_m: f64,
    /// Vertical field of view in degrees at the start.
    #[serde(default = "Tour::default_fov_deg")]
    pub fov_deg: f64,
    /// Hour of the day at the start, 0 to 24.
    #[serde(default = "Tour::default_hour")]
    pub hour: f64,
    /// Day of the year, 1 to 366: it tells the sun's height and the season.
    #[serde(default = "Tour::default_day")]
    pub day: u16,
    /// What happens.
    pub steps: Vec<Step>,
}

impl Tour {
    /// Pictures and recordings beside its file that it names, each once, in order.
    #[must_use]
    pub fn files(&self) -> BTreeSet<&str> {
        fn of(step: &Step) -> Vec<&str> {
            match step {
                Step::Narrate { file, files, .. } => files.values().chain([file]).map(String::as_str).collect(),
                Step::Sound { file } => file.as_deref().into_iter().collect(),
                Step::Picture { file, .. } => vec![file],
                _ => Vec::new(),
            }
        }
        self.steps.iter().flat_map(of).collect()
    }

    /// A tour without steps.
    #[must_use]
    pub fn new(title: String, city: String) -> Self {
        let (speed, eye_m) = (Self::default_speed(), Self::default_eye_m());
        let (fov_deg, hour, day) = (Self::default_fov_deg(), Self::default_hour(), Self::default_day());
        Self { title, translations: BTreeMap::new(), city, speed, eye_m, fov_deg, hour, day, steps: Vec::new() }
    }

    const fn default_speed() -> f64 {
        1.4
    }
    pub(crate) const fn default_eye_m() -> f64 {
        1.65
    }
    pub(crate) const fn default_fov_deg() -> f64 {
        55.0
    }
    pub(crate) const fn default_hour() -> f64 {
        10.0
    }
    pub(crate) const fn default_day() -> u16 {
        160
    }
}

/// A spot: a place's name, or plan metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Where {
    /// The place of that name.
    Place(String),
    /// Plan metres.
    At(f64, f64),
}

impl Where {
    /// The position, if it needs no looking up.
    #[must_use]
    pub fn plan_pos(&self) -> Option<DVec2> {
        match *self {
            Self::At(x, y) => Some(DVec2::new(x, y)),
            Self::Place(_) => None,
        }
    }
}

/// Where the eye turns.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LookAt {
    /// Along the way, a little ahead.
    #[default]
    Ahead,
    /// At a spot, so many metres above the ground there.
    Spot {
        /// The spot.
        at: Where,
        /// Metres above the ground.
        #[serde(default = "Tour::default_eye_m")]
        height_m: f64,
        /// Something that moves thereabouts, by its name: as long as it is there, it is what the eye turns to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        follow: Option<String>,
    },
    /// In a direction.
    Heading {
        /// Degrees clockwise from north.
        deg: f64,
        /// Degrees, up is positive.
        #[serde(default)]
        pitch_deg: f64,
    },
}

/// How a movement starts and stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Ease {
    /// Gently at both ends.
    #[default]
    InOut,
    /// Gently at the start.
    In,
    /// Gently at the end.
    Out,
    /// Evenly.
    Linear,
}

/// One step of a tour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Step {
    /// Stand somewhere at once, behind a fade.
    Start {
        /// Where.
        at: Where,
        /// Eye height in metres.
        #[serde(default)]
        eye_m: Option<f64>,
        /// Where the eye turns.
        #[serde(default)]
        look: LookAt,
    },
    /// Walk along the streets.
    Walk {
        /// Where to.
        to: Where,
        /// Spots to pass, in order, before `to`.
        #[serde(default)]
        via: Vec<Where>,
        /// Metres a second.
        #[serde(default)]
        speed: Option<f64>,
        /// Where the eye turns meanwhile.
        #[serde(default)]
        look: LookAt,
        /// How it starts and stops.
        #[serde(default)]
        ease: Ease,
    },
    /// Fly along a smooth curve through points given as (x, y, metres above the ground).
    Fly {
        /// The points, after the present one.
        through: Vec<(f64, f64, f64)>,
        /// Metres a second.
        speed: f64,
        /// Where the eye turns meanwhile.
        #[serde(default)]
        look: LookAt,
        /// How it starts and stops.
        #[serde(default)]
        ease: Ease,
    },
    /// Move by key frames, as a camera that was recorded or animated elsewhere.
    Track {
        /// Each (seconds since the step's begin, x, y, metres above the ground, heading, pitch), after the present pose. It is at
        /// rest at both ends, but a track that follows another goes on in the same movement.
        keys: Vec<(f64, f64, f64, f64, f64, f64)>,
    },
    /// Turn on the spot.
    Look {
        /// Where to.
        at: LookAt,
        /// In so many seconds.
        seconds: f64,
    },
    /// Stay.
    Wait {
        /// So many seconds.
        seconds: f64,
    },
    /// Show a caption while the tour goes on.
    Say {
        /// The words.
        text: String,
        /// The words in other languages: by the language's code.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        translations: BTreeMap<String, String>,
        /// For so many seconds; by the length of the text if not given.
        #[serde(default)]
        seconds: Option<f64>,
    },
    /// Tell something: a recording is heard while the tour goes on, and its words are shown as a caption.
    Narrate {
        /// The recording, Ogg Vorbis: a path beside the tour's file.
        file: String,
        /// The recording in other languages: by the language's code.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        files: BTreeMap<String, String>,
        /// Its words.
        text: String,
        /// The words in other languages: by the language's code.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        translations: BTreeMap<String, String>,
        /// They are shown for so many seconds; by the length of the text if not given.
        #[serde(default)]
        seconds: Option<f64>,
    },
    /// Let something be heard beneath all else, over and over, while the tour goes on.
    Sound {
        /// The recording, Ogg Vorbis: a path beside the tour's file. Without one, what is heard ends.
        #[serde(default)]
        file: Option<String>,
    },
    /// Show a picture while the tour goes on.
    Picture {
        /// The picture, PNG, JPEG or WebP: a path beside the tour's file.
        file: String,
        /// What it shows, and whose it is.
        #[serde(default, skip_serializing_if = "String::is_empty")]
        caption: String,
        /// The caption in other languages: by the language's code.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        translations: BTreeMap<String, String>,
        /// For so many seconds.
        seconds: f64,
    },
    /// Begin a chapter: what a visitor can go to.
    Chapter {
        /// Its title.
        title: String,
        /// The title in other languages: by the language's code.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        translations: BTreeMap<String, String>,
    },
    /// Tell the game that this moment has come.
    Mark {
        /// What the game knows it by.
        name: String,
    },
    /// Change how wet the streets are while the tour goes on: clouds come with the rain.
    Rain {
        /// 0 (dry) to 1 (puddles).
        wet: f64,
        /// In so many seconds.
        #[serde(default)]
        seconds: f64,
    },
    /// Change the vertical field of view while the tour goes on.
    Fov {
        /// Degrees.
        deg: f64,
        /// In so many seconds.
        #[serde(default)]
        seconds: f64,
    },
    /// Change the hour of the day while the tour goes on.
    Time {
        /// Hour, 0 to 24.
        hour: f64,
        /// In so many seconds.
        #[serde(default)]
        seconds: f64,
    },
    /// Fade out, stand somewhere else, fade in.
    Cut {
        /// Where.
        to: Where,
        /// Eye height in metres.
        #[serde(default)]
        eye_m: Option<f64>,
        /// Where the eye turns.
        #[serde(default)]
        look: LookAt,
        /// Seconds of the fade, out and in together.
        #[serde(default = "Step::default_fade_s")]
        seconds: f64,
    },
}

impl Step {
    /// Where the eye turns, if the step says it.
    #[must_use]
    pub const fn look(&self) -> Option<&LookAt> {
        match self {
            Self::Start { look, .. } | Self::Cut { look, .. } | Self::Walk { look, .. } | Self::Fly { look, .. } => Some(look),
            Self::Look { at, .. } => Some(at),
            _ => None,
        }
    }

    pub(crate) const fn default_fade_s() -> f64 {
        1.6
    }
}
