use serde::{Deserialize, Serialize};
use veduta_city::Anchor;

/// A city described in words: the content of an `X.words.ron`. Every field but `name`, `plan` and one of `size_m` and
/// `population` may be left out.
///
/// ```
/// let text = r#"(
///     name: "Brookwick", seed: 7, size_m: 480,
///     plan: Medieval(edge: Wall, gates: 4),
///     river: (width_m: 26, passes: Beside, bridges: 2, name: "Brook"),
///     districts: [(name: "Old Town", style: "old_town", share: 0.7, at: Centre)],
///     squares: 2, parks: 0.04,
/// )"#;
/// let words: veduta_survey::CityWords = veduta_city::file::parse(text, "brookwick.words.ron")?;
/// let survey = veduta_survey::survey_words(&words)?;
/// assert_eq!(survey, veduta_survey::survey_words(&words)?, "the same every time");
/// assert!(survey.graph.squares.len() == 2 && survey.graph.blocks.len() > 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CityWords {
    /// Name of the city.
    pub name: String,
    /// Seed of every choice that the words leave open, and of growth's; 0 if not given.
    #[serde(default)]
    pub seed: u64,
    /// Where on Earth the middle lies (sun and compass go by it); 50° N 15° E if not given.
    #[serde(default = "CityWords::default_anchor")]
    pub anchor: Anchor,
    /// Distance from edge to edge of the town through its middle, metres, 200 to 4,000; from `population` if not given.
    #[serde(default)]
    pub size_m: Option<f64>,
    /// People who live there, 100 to 1,000,000; only where `size_m` is not given. With `density` it decides the size.
    #[serde(default)]
    pub population: Option<u32>,
    /// How its streets lie.
    pub plan: Plan,
    /// How closely it is built, 0.1 to 1: small blocks and few gardens towards 1; 0.7 if not given.
    #[serde(default = "CityWords::default_density")]
    pub density: f64,
    /// Districts in the order in which they choose their ground; the plan's own custom if there are none.
    #[serde(default)]
    pub districts: Vec<District>,
    /// River; none if not given.
    #[serde(default)]
    pub river: Option<River>,
    /// Whether a railway passes by outside the town; no if not given.
    #[serde(default)]
    pub railway: bool,
    /// Share of the ground between streets that is park, 0 to 0.4; 0.03 if not given.
    #[serde(default = "CityWords::default_parks")]
    pub parks: f64,
    /// Number of squares, the main one among them, 0 to 40; 1 if not given. Medieval, radial and mixed plans have at least one.
    #[serde(default = "CityWords::default_squares")]
    pub squares: u32,
}

/// How streets lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Plan {
    /// Straight streets at right angles, with avenues.
    Grid {
        /// Least and greatest distance between parallel streets one way, metres, within 40 to 250; (60, 90) if not given.
        #[serde(default = "Plan::default_short_m")]
        short_m: (f64, f64),
        /// The same the other way; (90, 140) if not given.
        #[serde(default = "Plan::default_long_m")]
        long_m: (f64, f64),
        /// Every how manieth street is an avenue, 2 to 12; 4 if not given.
        #[serde(default = "Plan::default_avenue_every")]
        avenue_every: u32,
        /// Avenues that run across the grid, 0 to 3; 1 if not given.
        #[serde(default = "Plan::default_diagonals")]
        diagonals: u32,
        /// Heading of the long streets, degrees clockwise from north; by seed if not given.
        #[serde(default)]
        heading_deg: Option<f64>,
    },
    /// Boulevards from a central square, and rings about it.
    Radial {
        /// Boulevards, 3 to 16; by size if not given.
        #[serde(default)]
        boulevards: Option<u32>,
        /// Rings, 1 to 8; by size if not given.
        #[serde(default)]
        rings: Option<u32>,
        /// Side of a block, metres, 40 to 200; 85 if not given.
        #[serde(default = "Plan::default_radial_block_m")]
        block_m: f64,
    },
    /// Crooked streets from gates to a market.
    Medieval {
        /// What lies round the town; a wall if not given.
        #[serde(default)]
        edge: TownEdge,
        /// Gates, 2 to 12; by size if not given.
        #[serde(default)]
        gates: Option<u32>,
        /// How crooked the streets are, 0 to 1; 0.6 if not given.
        #[serde(default = "Plan::default_crooked")]
        crooked: f64,
        /// Side of a block, metres, 30 to 120; 52 if not given.
        #[serde(default = "Plan::default_medieval_block_m")]
        block_m: f64,
    },
    /// A medieval core within a ring street, and a newer town round it.
    Mixed {
        /// Share of the town's radius that the core has, 0.15 to 0.7; 0.38 if not given.
        #[serde(default = "Plan::default_core")]
        core: f64,
        /// Streets that lead out, 3 to 14; by size if not given.
        #[serde(default)]
        roads: Option<u32>,
        /// How crooked the core's streets are, 0 to 1; 0.6 if not given.
        #[serde(default = "Plan::default_crooked")]
        crooked: f64,
        /// What lies outside the ring; a grid if not given.
        #[serde(default)]
        outside: Outside,
        /// Side of a block of the core, metres, 30 to 120; 52 if not given.
        #[serde(default = "Plan::default_medieval_block_m")]
        block_m: f64,
    },
}

/// What lies round a medieval town.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum TownEdge {
    /// A wall with towers and gates, and a lane inside it.
    #[default]
    Wall,
    /// A broad street where the wall stood.
    Ring,
    /// Nothing: the last houses look on fields.
    Open,
}

/// What lies outside the ring of a mixed town.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Outside {
    /// Straight streets at right angles.
    #[default]
    Grid,
    /// Winding streets and large blocks.
    Suburb,
}

/// A part of the town whose houses are of one style.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct District {
    /// Its name, as a place's.
    pub name: String,
    /// Style of its houses: one of growth's stock styles (`old_town`, `tenement`, `suburban`, `modern`, `industrial`, …) or
    /// one that the overrides bring.
    pub style: String,
    /// Share of the built ground, above 0 to 1. What no district takes goes to the last one.
    pub share: f64,
    /// Where it lies; in the centre if not given.
    #[serde(default)]
    pub at: Part,
}

/// A part of the town.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Part {
    /// Round the middle.
    #[default]
    Centre,
    /// Between the middle and the edge.
    Ring,
    /// Farthest out.
    Edge,
    /// In the north.
    North,
    /// In the east.
    East,
    /// In the south.
    South,
    /// In the west.
    West,
}

/// A river through the town.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct River {
    /// Width of the water, metres, 4 to 250, and at most a quarter of the town; 30 if not given.
    #[serde(default = "River::default_width_m")]
    pub width_m: f64,
    /// Where it passes; beside the centre if not given.
    #[serde(default)]
    pub passes: Passes,
    /// Bends, 0 to 12; 2 if not given.
    #[serde(default = "River::default_bends")]
    pub bends: u32,
    /// Bridges, 1 to 24; as many as have room; by size if not given.
    #[serde(default)]
    pub bridges: Option<u32>,
    /// Where it flows, degrees clockwise from north; by seed if not given.
    #[serde(default)]
    pub heading_deg: Option<f64>,
    /// Its name; from the program's own list if empty.
    #[serde(default)]
    pub name: String,
}

/// Where a river passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Passes {
    /// Through the middle.
    Centre,
    /// Half-way between middle and edge.
    #[default]
    Beside,
    /// Near the edge.
    Edge,
}

impl CityWords {
    const fn default_anchor() -> Anchor {
        Anchor { lat: 50.0, lon: 15.0 }
    }

    const fn default_density() -> f64 {
        0.7
    }

    const fn default_parks() -> f64 {
        0.03
    }

    const fn default_squares() -> u32 {
        1
    }

    /// Distance from edge to edge, metres: the one given, or what so many people need.
    pub(super) fn size_m(&self) -> f64 {
        let people_a_hectare = 50.0 + 200.0 * self.density;
        let for_people = |n: u32| libm::sqrt(f64::from(n) / people_a_hectare * 10_000.0 * 4.0 / core::f64::consts::PI);
        self.size_m.or_else(|| self.population.map(for_people)).unwrap_or(0.0)
    }
}

impl Plan {
    const fn default_short_m() -> (f64, f64) {
        (60.0, 90.0)
    }

    const fn default_long_m() -> (f64, f64) {
        (90.0, 140.0)
    }

    const fn default_avenue_every() -> u32 {
        4
    }

    const fn default_diagonals() -> u32 {
        1
    }

    const fn default_radial_block_m() -> f64 {
        85.0
    }

    const fn default_crooked() -> f64 {
        0.6
    }

    const fn default_medieval_block_m() -> f64 {
        52.0
    }

    const fn default_core() -> f64 {
        0.38
    }
}

impl River {
    const fn default_width_m() -> f64 {
        30.0
    }

    const fn default_bends() -> u32 {
        2
    }
}
