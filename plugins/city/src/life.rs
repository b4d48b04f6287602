use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{Rgb, Where};

mod check;

/// What moves in a city: `X.life.ron` beside it. A city without such a file lives by [`LifeRules`] alone.
///
/// ```
/// let text = r##"(
///     things: [
///         (name: "Church clock", at: At(12, -40), height_m: 21, heading_deg: 180, kind: Clock(radius_m: 1.2)),
///         (name: "Great bell", at: Place("Church"), height_m: 26, kind: Bell(sound: "bell.great", tells: Hours)),
///         (name: "Market pigeons", at: Place("Market"), kind: Flock(radius_m: 16, count: 24)),
///         (name: "Town's flag", at: Place("Town hall"), by: (3, 0), height_m: 14, heading_deg: 90,
///          kind: Flag(pole_m: 2.5, tilt_deg: 50, fields: ["#FFFFFF", "#B3202A"])),
///     ],
/// )"##;
/// let life: veduta_city::Life = veduta_city::file::parse(text, "town.life.ron")?;
/// assert!(life.validate().is_empty());
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Life {
    /// The city: a path relative to the file, or a URL; only for checking names against it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub city: String,
    /// What lives without being told of.
    #[serde(default)]
    pub rules: LifeRules,
    /// What is told of.
    #[serde(default)]
    pub things: Vec<LivingThing>,
}

/// What lives in any city, by what the city itself tells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LifeRules {
    /// Pigeons on each square that has a name and no flock of its own; 0 for none.
    pub pigeons: u32,
    /// Share of the houses with chimneys in which a fire burns on a winter evening, 0 to 1.
    pub hearths: f64,
    /// Whether water plays in fountains of which nothing is told.
    pub fountains: bool,
}

impl Default for LifeRules {
    fn default() -> Self {
        Self { pigeons: 20, hearths: 0.45, fountains: true }
    }
}

/// Something that moves, and where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LivingThing {
    /// What it is called in messages, and by tours that follow it with the eye; each name once.
    pub name: String,
    /// Where: a place by its name, or plan metres.
    pub at: Where,
    /// How far from there, metres east and north.
    #[serde(default)]
    pub by: DVec2,
    /// Height above the ground there, metres: of a clock's middle, of a pole's foot, of an iron arm that a sign hangs from, of the floor that
    /// figures walk on. Heights of water are above it, too.
    #[serde(default)]
    pub height_m: f64,
    /// Where its front looks, degrees clockwise from north: a dial, a window; where a pole leans and an arm reaches.
    #[serde(default)]
    pub heading_deg: f64,
    /// What it is.
    pub kind: LifeKind,
}

/// What something living is. Lengths in metres, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LifeKind {
    /// Water that falls into a basin.
    Fountain {
        /// Radius of the water in the basin.
        radius_m: f64,
        /// Height of that water.
        water_m: f64,
        /// Where water comes from.
        jets: Vec<Jet>,
    },
    /// A flag on a pole.
    Flag {
        /// Length of the pole.
        pole_m: f64,
        /// How far the pole leans, degrees from upright.
        #[serde(default)]
        tilt_deg: f64,
        /// Size of the cloth: along the pole, and away from it.
        #[serde(default = "LifeKind::default_cloth_m")]
        size_m: (f64, f64),
        /// Colours of its stripes, from the top of the pole down.
        fields: Vec<Rgb>,
        /// Colour of a wedge at the pole.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        wedge: Option<Rgb>,
    },
    /// Smoke of one chimney.
    Smoke {
        /// How thick it is: 1 for a tiled stove.
        #[serde(default = "LifeKind::default_strength")]
        strength: f64,
        /// Whether it smokes on summer days, too; else as hearths do: in the cold season, most of all in the evening.
        #[serde(default)]
        always: bool,
    },
    /// Pigeons that walk about on the ground.
    Flock {
        /// How far from the middle they walk.
        radius_m: f64,
        /// How many.
        #[serde(default = "LifeKind::default_pigeons")]
        count: u32,
        /// How near somebody who walks may come before they fly up.
        #[serde(default = "LifeKind::default_startle_m")]
        startle_m: f64,
    },
    /// A board that hangs from an iron arm.
    Sign {
        /// Its outline.
        #[serde(default)]
        shape: SignShape,
        /// Width and height of the board.
        #[serde(default = "LifeKind::default_board_m")]
        size_m: (f64, f64),
        /// How far the arm reaches from the wall.
        #[serde(default = "LifeKind::default_arm_m")]
        arm_m: f64,
        /// Colour of the board.
        colour: Rgb,
        /// Colour of its rim and of the device on it.
        trim: Rgb,
    },
    /// A dial with hands that show the city's hour.
    Clock {
        /// Radius of the dial.
        radius_m: f64,
        /// What the dial shows.
        #[serde(default)]
        dial: Dial,
        /// Colour of the dial.
        #[serde(default = "LifeKind::default_face")]
        face: Rgb,
        /// Colour of numerals and hands.
        #[serde(default = "LifeKind::default_gold")]
        gold: Rgb,
    },
    /// Figures that pass behind windows when a clock strikes.
    Figures {
        /// How many pass each window.
        #[serde(default = "LifeKind::default_figures")]
        count: u32,
        /// Middles of the windows, metres to the right of who looks at them.
        windows_m: Vec<f64>,
        /// Width and height of a window.
        size_m: (f64, f64),
        /// How long the procession lasts.
        #[serde(default = "LifeKind::default_procession_s")]
        seconds: f64,
    },
    /// A bell that tells the hour.
    Bell {
        /// Name of its sound.
        sound: String,
        /// When it is struck.
        #[serde(default)]
        tells: Tells,
        /// From stroke to stroke.
        #[serde(default = "LifeKind::default_stroke_s")]
        every_s: f64,
        /// How long after the hour it begins, so that bells do not strike into one another.
        #[serde(default)]
        after_s: f64,
        /// Decibels above how its sound is described.
        #[serde(default)]
        gain_db: f64,
    },
}

/// Water that rises, or only falls, from some openings in a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jet {
    /// How many openings, evenly round the middle.
    #[serde(default = "Jet::default_count")]
    pub count: u32,
    /// Radius of the ring of openings, metres.
    #[serde(default)]
    pub radius_m: f64,
    /// Height of the openings, metres.
    pub height_m: f64,
    /// How high water rises above them, metres; 0 where it runs over a rim.
    #[serde(default)]
    pub rise_m: f64,
    /// How far outwards it falls, metres.
    pub reach_m: f64,
    /// Height at which it meets water, metres; that of the basin if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lands_m: Option<f64>,
    /// Thickness where it comes out, metres.
    #[serde(default = "Jet::default_width_m")]
    pub width_m: f64,
}

/// What a dial shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum Dial {
    /// Twelve hours, with a hand for hours and one for minutes.
    #[default]
    Twelve,
    /// Twice twelve hours, noon at the top, with one hand.
    TwentyFour,
    /// The same round a plate of the sky: day, twilight and night at the city's latitude, the sun on its way, and the ecliptic's ring.
    Astrolabe,
}

/// Outline of a sign's board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum SignShape {
    /// A rectangle.
    #[default]
    Board,
    /// A disc.
    Round,
    /// A shield with a point.
    Shield,
}

/// When a bell is struck.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Tells {
    /// On the hour, one to twelve strokes.
    #[default]
    Hours,
    /// On each quarter, one to four strokes.
    Quarters,
    /// At some hours so many strokes, as bells are rung for the Angelus.
    At {
        /// Hours of the day, 0 to 24, in quarters of an hour.
        hours: Vec<f64>,
        /// Strokes.
        strokes: u32,
    },
}

impl Jet {
    const fn default_count() -> u32 {
        1
    }

    const fn default_width_m() -> f64 {
        0.022
    }
}

impl LifeKind {
    const fn default_cloth_m() -> (f64, f64) {
        (1.0, 1.5)
    }

    const fn default_strength() -> f64 {
        1.0
    }

    const fn default_pigeons() -> u32 {
        24
    }

    const fn default_startle_m() -> f64 {
        4.5
    }

    const fn default_board_m() -> (f64, f64) {
        (0.6, 0.75)
    }

    const fn default_arm_m() -> f64 {
        0.95
    }

    const fn default_face() -> Rgb {
        Rgb(0x26, 0x35, 0x4E)
    }

    const fn default_gold() -> Rgb {
        Rgb(0xC9, 0xA9, 0x4E)
    }

    const fn default_figures() -> u32 {
        6
    }

    const fn default_procession_s() -> f64 {
        44.0
    }

    const fn default_stroke_s() -> f64 {
        2.4
    }

    /// What it is called in messages.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Fountain { .. } => "fountain",
            Self::Flag { .. } => "flag",
            Self::Smoke { .. } => "smoke",
            Self::Flock { .. } => "flock",
            Self::Sign { .. } => "sign",
            Self::Clock { .. } => "clock",
            Self::Figures { .. } => "figures",
            Self::Bell { .. } => "bell",
        }
    }
}

impl LivingThing {
    /// Where it is, for places that a function finds by name; `None` if it does not.
    pub fn plan_pos(&self, find: impl FnOnce(&str) -> Option<DVec2>) -> Option<DVec2> {
        let at = match &self.at {
            Where::At(x, y) => DVec2::new(*x, *y),
            Where::Place(name) => find(name)?,
        };
        Some(at + self.by)
    }
}
