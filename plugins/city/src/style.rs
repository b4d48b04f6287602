use serde::{Deserialize, Serialize};

use crate::{Articulation, BalconyPlaces, Opening, Rgb, RoofShape};

/// A range of numbers to draw from, both ends included as far as the draw goes; written `(low, high)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Range(
    /// Low end.
    pub f64,
    /// High end.
    pub f64,
);

/// How houses of a kind look: what growth draws from. Lengths are metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// Name, as districts and overrides call it.
    pub name: String,
    /// Storeys below the eaves.
    pub storeys: (u8, u8),
    /// Height of the ground floor.
    pub ground_floor_m: Range,
    /// Height of the upper storeys.
    pub storey_m: Range,
    /// Distance between window axes.
    pub bay_m: Range,
    /// Frontage of grown lots.
    pub frontage_m: Range,
    /// Depth of grown houses.
    pub depth_m: Range,
    /// Wall colours to choose from.
    pub walls: Vec<Rgb>,
    /// Mouldings lighter than the wall by this factor.
    pub trim: f64,
    /// Roof shapes to choose from.
    pub roofs: Vec<RoofShape>,
    /// Pitch in degrees.
    pub pitch_deg: Range,
    /// Roof colours to choose from.
    pub roof_colours: Vec<Rgb>,
    /// Windows of the first floor to choose from.
    pub main_windows: Vec<Opening>,
    /// Windows of the other floors to choose from.
    pub windows: Vec<Opening>,
    /// Ground-floor windows to choose from.
    pub ground_windows: Vec<Opening>,
    /// Doors to choose from.
    pub doors: Vec<Opening>,
    /// Share of ground-floor bays that are shops, 0 to 1.
    pub shops: f64,
    /// Shapes of gable walls to choose from.
    #[serde(default = "Style::plain_gables")]
    pub gables: Vec<Gable>,
    /// Share of narrow houses in a row that show the street their gable, 0 to 1.
    #[serde(default = "Style::some_gables")]
    pub gable_fronts: f64,
    /// How a grown house stands on its lot.
    #[serde(default)]
    pub stand: Stand,
    /// How its street fronts are divided or framed, to choose from.
    #[serde(default = "Style::plain_fronts")]
    pub articulation: Vec<Articulation>,
    /// Where its door's front has balconies, to choose from.
    #[serde(default = "Style::no_balconies")]
    pub balconies: Vec<BalconyPlaces>,
    /// Share of houses with a bay window on the door's front, 0 to 1.
    #[serde(default)]
    pub oriels: f64,
    /// Share of houses with a statue on the door's front, 0 to 1.
    #[serde(default)]
    pub niches: f64,
    /// Share of houses of four storeys and more with a mezzanine, a low storey over the ground floor, 0 to 1.
    #[serde(default)]
    pub mezzanines: f64,
}

/// The colours that a style's houses are painted with, unless a map or a person gives others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Palette {
    /// Those of walls.
    pub walls: Vec<Rgb>,
    /// Those of roofs.
    pub roofs: Vec<Rgb>,
    /// Mouldings are lighter than the wall by this factor.
    pub trim: f64,
}

impl Palette {
    /// Houses of one colour differ by so many steps of lightness either way.
    pub const TINTS: core::ops::RangeInclusive<i8> = -3..=3;
    /// What one step changes.
    const TINT: f64 = 0.02;

    /// A colour as it is painted: so many steps lighter, never pure black, never pure white.
    #[must_use]
    pub fn tinted(colour: Rgb, steps: i8) -> Rgb {
        Self::bounded(colour.scaled(1.0 + Self::TINT * f64::from(steps)))
    }

    /// Colour of the mouldings that go with a wall.
    #[must_use]
    pub fn trim(&self, wall: Rgb) -> Rgb {
        Self::bounded(wall.scaled(self.trim))
    }

    /// A colour as anything is painted: never pure black, never pure white.
    #[must_use]
    pub fn bounded(colour: Rgb) -> Rgb {
        let channel = |c: u8| c.clamp(0x1A, 0xF4);
        Rgb(channel(colour.0), channel(colour.1), channel(colour.2))
    }
}

/// Shape of a grown house's gable walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Gable {
    /// Under the roof.
    #[default]
    Plain,
    /// In steps above the roof: Gothic, Dutch.
    Stepped,
    /// In curves above the roof: Renaissance, Baroque.
    Volute,
    /// A low triangle with a cornice: Classicist.
    Pediment,
}

/// How a grown house stands on its lot.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Stand {
    /// From party wall to party wall.
    #[default]
    Row,
    /// Apart from its lot's edges by about so much, metres.
    Detached(f64),
    /// A podium of so many storeys over the whole lot; what stands on it steps back twice, each time to such a share of its width.
    Setbacks {
        /// Storeys of the podium.
        podium: (u8, u8),
        /// Width of each step over that of the one below.
        share: Range,
    },
}

impl Style {
    /// What its houses are painted with.
    #[must_use]
    pub fn palette(&self) -> Palette {
        Palette { walls: self.walls.clone(), roofs: self.roof_colours.clone(), trim: self.trim }
    }

    fn plain_gables() -> Vec<Gable> {
        vec![Gable::Plain]
    }

    const fn some_gables() -> f64 {
        0.15
    }

    fn plain_fronts() -> Vec<Articulation> {
        vec![Articulation::Plain]
    }

    fn no_balconies() -> Vec<BalconyPlaces> {
        vec![BalconyPlaces::Nowhere]
    }
}

/// A style as a person writes it: what is not given is that of the style that it inherits from. See [`Style`] for the fields.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct StyleDraft {
    pub name: String,
    /// Name of another style.
    pub inherits: Option<String>,
    pub storeys: Option<(u8, u8)>,
    pub ground_floor_m: Option<Range>,
    pub storey_m: Option<Range>,
    pub bay_m: Option<Range>,
    pub frontage_m: Option<Range>,
    pub depth_m: Option<Range>,
    pub walls: Option<Vec<Rgb>>,
    pub trim: Option<f64>,
    pub roofs: Option<Vec<RoofShape>>,
    pub pitch_deg: Option<Range>,
    pub roof_colours: Option<Vec<Rgb>>,
    pub main_windows: Option<Vec<Opening>>,
    pub windows: Option<Vec<Opening>>,
    pub ground_windows: Option<Vec<Opening>>,
    pub doors: Option<Vec<Opening>>,
    pub shops: Option<f64>,
    pub gables: Option<Vec<Gable>>,
    pub gable_fronts: Option<f64>,
    pub stand: Option<Stand>,
    pub articulation: Option<Vec<Articulation>>,
    pub balconies: Option<Vec<BalconyPlaces>>,
    pub oriels: Option<f64>,
    pub niches: Option<f64>,
    pub mezzanines: Option<f64>,
}

impl StyleDraft {
    /// The style that it says, with the rest from the style that it inherits from, one of those that are known.
    ///
    /// # Errors
    /// [`StyleError::Unknown`] if there is no such style, [`StyleError::Missing`] for a field that neither gives.
    pub fn finish(&self, known: &Styles) -> Result<Style, StyleError> {
        let base = match &self.inherits {
            None => None,
            Some(name) => match known.find(name) {
                Some(i) => known.0.get(i),
                None => return Err(StyleError::Unknown { style: self.name.clone(), name: name.clone(), known: known.names() }),
            },
        };
        let missing = |field| StyleError::Missing { style: self.name.clone(), field };
        let range = |own: Option<Range>, of: fn(&Style) -> Range, field| own.or(base.map(of)).ok_or_else(|| missing(field));
        let openings = |own: &Option<Vec<Opening>>, of: fn(&Style) -> &Vec<Opening>, field| {
            own.clone().or_else(|| base.map(|b| of(b).clone())).ok_or_else(|| missing(field))
        };
        let colours = |own: &Option<Vec<Rgb>>, of: fn(&Style) -> &Vec<Rgb>, field| {
            own.clone().or_else(|| base.map(|b| of(b).clone())).ok_or_else(|| missing(field))
        };
        Ok(Style {
            name: self.name.clone(),
            storeys: self.storeys.or(base.map(|b| b.storeys)).ok_or_else(|| missing("storeys"))?,
            ground_floor_m: range(self.ground_floor_m, |b| b.ground_floor_m, "ground_floor_m")?,
            storey_m: range(self.storey_m, |b| b.storey_m, "storey_m")?,
            bay_m: range(self.bay_m, |b| b.bay_m, "bay_m")?,
            frontage_m: range(self.frontage_m, |b| b.frontage_m, "frontage_m")?,
            depth_m: range(self.depth_m, |b| b.depth_m, "depth_m")?,
            walls: colours(&self.walls, |b| &b.walls, "walls")?,
            trim: self.trim.or(base.map(|b| b.trim)).ok_or_else(|| missing("trim"))?,
            roofs: self.roofs.clone().or_else(|| base.map(|b| b.roofs.clone())).ok_or_else(|| missing("roofs"))?,
            pitch_deg: range(self.pitch_deg, |b| b.pitch_deg, "pitch_deg")?,
            roof_colours: colours(&self.roof_colours, |b| &b.roof_colours, "roof_colours")?,
            main_windows: openings(&self.main_windows, |b| &b.main_windows, "main_windows")?,
            windows: openings(&self.windows, |b| &b.windows, "windows")?,
            ground_windows: openings(&self.ground_windows, |b| &b.ground_windows, "ground_windows")?,
            doors: openings(&self.doors, |b| &b.doors, "doors")?,
            shops: self.shops.or(base.map(|b| b.shops)).ok_or_else(|| missing("shops"))?,
            gables: self.gables.clone().or_else(|| base.map(|b| b.gables.clone())).unwrap_or_else(Style::plain_gables),
            gable_fronts: self.gable_fronts.or(base.map(|b| b.gable_fronts)).unwrap_or_else(Style::some_gables),
            stand: self.stand.or(base.map(|b| b.stand)).unwrap_or_default(),
            articulation: self
                .articulation
                .clone()
                .or_else(|| base.map(|b| b.articulation.clone()))
                .unwrap_or_else(Style::plain_fronts),
            balconies: self.balconies.clone().or_else(|| base.map(|b| b.balconies.clone())).unwrap_or_else(Style::no_balconies),
            oriels: self.oriels.or(base.map(|b| b.oriels)).unwrap_or_default(),
            niches: self.niches.or(base.map(|b| b.niches)).unwrap_or_default(),
            mezzanines: self.mezzanines.or(base.map(|b| b.mezzanines)).unwrap_or_default(),
        })
    }
}

/// The styles of a city.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Styles(pub Vec<Style>);

/// What is wrong with a style.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// A list to choose from is empty.
    #[error("style `{style}`: `{field}` is empty; it needs at least one entry")]
    Empty {
        /// Which style.
        style: String,
        /// Which list.
        field: &'static str,
    },
    /// A range is not a range.
    #[error("style `{style}`: `{field}` is ({low}, {high}); it needs 0 < low ≤ high")]
    Range {
        /// Which style.
        style: String,
        /// Which range.
        field: &'static str,
        /// Its low end.
        low: f64,
        /// Its high end.
        high: f64,
    },
    /// A share is none.
    #[error("style `{style}`: `{field}` is {share}; it needs 0 to 1")]
    Share {
        /// Which style.
        style: String,
        /// Which share.
        field: &'static str,
        /// What it is.
        share: f64,
    },
    /// It inherits from a style that is not there.
    #[error("style `{style}` inherits from `{name}`, which is not there; there are: {known}")]
    Unknown {
        /// Which style.
        style: String,
        /// What it names.
        name: String,
        /// What there is.
        known: String,
    },
    /// A field that neither it nor what it inherits from gives.
    #[error("style `{style}`: `{field}` is not given; give it, or name a style to take it from: inherits: \"old_town\"")]
    Missing {
        /// Which style.
        style: String,
        /// Which field.
        field: &'static str,
    },
    /// Two styles share a name.
    #[error("two styles are called `{0}`")]
    Twice(String),
}

impl Styles {
    /// Index of a style by name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|style| style.name == name)
    }

    /// All names.
    fn names(&self) -> String {
        self.0.iter().map(|style| style.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// Everything wrong with the styles; empty if growth may draw from them.
    #[must_use]
    pub fn validate(&self) -> Vec<StyleError> {
        let mut errors = Vec::new();
        for (i, s) in self.0.iter().enumerate() {
            if self.find(&s.name) != Some(i) {
                errors.push(StyleError::Twice(s.name.clone()));
            }
            let lists = [
                ("walls", s.walls.is_empty()),
                ("roofs", s.roofs.is_empty()),
                ("roof_colours", s.roof_colours.is_empty()),
                ("main_windows", s.main_windows.is_empty()),
                ("windows", s.windows.is_empty()),
                ("ground_windows", s.ground_windows.is_empty()),
                ("doors", s.doors.is_empty()),
                ("gables", s.gables.is_empty()),
                ("articulation", s.articulation.is_empty()),
                ("balconies", s.balconies.is_empty()),
            ];
            for (field, empty) in lists {
                if empty {
                    errors.push(StyleError::Empty { style: s.name.clone(), field });
                }
            }
            let shares = [
                ("shops", s.shops),
                ("gable_fronts", s.gable_fronts),
                ("oriels", s.oriels),
                ("niches", s.niches),
                ("mezzanines", s.mezzanines),
            ];
            for (field, share) in shares.into_iter().filter(|(_, share)| !(0.0..=1.0).contains(share)) {
                errors.push(StyleError::Share { style: s.name.clone(), field, share });
            }
            let ranges = [
                ("storeys", Range(f64::from(s.storeys.0), f64::from(s.storeys.1))),
                ("ground_floor_m", s.ground_floor_m),
                ("storey_m", s.storey_m),
                ("bay_m", s.bay_m),
                ("frontage_m", s.frontage_m),
                ("depth_m", s.depth_m),
                ("pitch_deg", s.pitch_deg),
            ];
            let stand = match s.stand {
                Stand::Row => None,
                Stand::Detached(apart_m) => Some(("stand", Range(apart_m, apart_m))),
                Stand::Setbacks { podium, share } if podium.0 > 0 && podium.0 <= podium.1 && share.1 <= 1.0 => {
                    Some(("stand", share))
                }
                // A range that is none, to be told.
                Stand::Setbacks { share, .. } => Some(("stand", Range(0.0, share.1))),
            };
            for (field, Range(low, high)) in ranges.into_iter().chain(stand) {
                if !(low > 0.0 && low <= high && high < 1000.0) {
                    errors.push(StyleError::Range { style: s.name.clone(), field, low, high });
                }
            }
        }
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file;

    fn draft(text: &str) -> StyleDraft {
        file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_style_takes_what_it_does_not_say_from_another() {
        let base = draft(
            r##"(name: "base", storeys: (2, 3), ground_floor_m: (4, 5), storey_m: (3, 4), bay_m: (2, 3), frontage_m: (7, 12),
            depth_m: (9, 12), walls: ["#FFFFFF"], trim: 1.1, roofs: [Hipped], pitch_deg: (40, 50), roof_colours: ["#8C3E2C"],
            main_windows: [Window], windows: [Window], ground_windows: [Window], doors: [Door], shops: 0.2)"##,
        );
        let base = base.finish(&Styles::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((base.gables.as_slice(), base.stand), (&[Gable::Plain][..], Stand::Row));
        let known = Styles(vec![base.clone()]);
        let other = draft(r#"(name: "other", inherits: "base", storeys: (5, 6), gables: [Stepped])"#);
        let other = other.finish(&known).unwrap_or_else(|e| panic!("{e}"));
        let expected = Style { name: "other".to_owned(), storeys: (5, 6), gables: vec![Gable::Stepped], ..base };
        assert_eq!(other, expected);
    }

    #[test]
    fn a_share_beyond_the_whole_is_told() {
        let base = r##"(name: "base", storeys: (2, 3), ground_floor_m: (4, 5), storey_m: (3, 4), bay_m: (2, 3), frontage_m: (7, 12),
            depth_m: (9, 12), walls: ["#FFFFFF"], trim: 1.1, roofs: [Hipped], pitch_deg: (40, 50), roof_colours: ["#8C3E2C"],
            main_windows: [Window], windows: [Window], ground_windows: [Window], doors: [Door], shops: 0.2, oriels: 1.5,
            niches: 1.0, balconies: [])"##;
        let style = draft(base).finish(&Styles::default()).unwrap_or_else(|e| panic!("{e}"));
        let told: Vec<String> = Styles(vec![style]).validate().iter().map(ToString::to_string).collect();
        assert_eq!(
            told,
            ["style `base`: `balconies` is empty; it needs at least one entry", "style `base`: `oriels` is 1.5; it needs 0 to 1"]
        );
    }

    #[test]
    fn what_nobody_gives_is_told() {
        let known = Styles::default();
        let told = |text: &str| draft(text).finish(&known).map_or_else(|e| e.to_string(), |_| String::new());
        assert!(told("(name: \"x\")").contains("style `x`: `storeys` is not given"));
        assert!(told("(name: \"x\", inherits: \"y\")").contains("inherits from `y`, which is not there"));
    }
}
