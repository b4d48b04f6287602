//! What the colours of a map stand for: a small file that a person writes, or corrects after a guess.

use core::fmt;

use serde::de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use veduta_city::file::{self, SyntaxError};
use veduta_city::{Finding, Rgb, StreetClass};

/// Most colours of a legend.
const MOST_COLOURS: usize = 256;
/// Coarsest scale; metres a pixel.
const MOST_METRES: f64 = 1000.0;

/// What a colour on a map stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MapClass {
    /// Street; of a class, where the map tells classes by colour.
    Street(Option<StreetClass>),
    /// Square, where it has a colour of its own.
    Square,
    /// The block that houses stand in, and they themselves where the map does not tell them from it.
    Built,
    /// Single houses, where they have a colour of their own upon the ground of a block. Each region of it is a footprint;
    /// blocks stay what lies between the streets, houses and ground together. It is said by the legend and not derived from
    /// regions of [`Built`](Self::Built) that are smaller than the loop of streets around them: a park's pavilion, a block of
    /// another tint and a strip of ground between two streets all look like that.
    House,
    /// Park, garden, wood.
    Park,
    /// River, canal, lake, sea.
    Water,
    /// Railway, tramway.
    Railway,
    /// Lettering, symbols, lines that mean nothing on the ground: filled from around them.
    Label,
}

impl MapClass {
    /// Every class, streets without one of their own.
    pub const ALL: [Self; 8] =
        [Self::Street(None), Self::Square, Self::Built, Self::House, Self::Park, Self::Water, Self::Railway, Self::Label];

    /// The class by its name in legend files, in RON's spelling or JSON's: `Street`, `street`, `railroad`.
    fn named(name: &str) -> Option<Self> {
        Some(match name.to_lowercase().as_str() {
            "street" => Self::Street(None),
            "square" => Self::Square,
            "built" => Self::Built,
            "house" => Self::House,
            "park" => Self::Park,
            "water" => Self::Water,
            "railway" | "railroad" => Self::Railway,
            "label" => Self::Label,
            _ => return None,
        })
    }

    /// Its name in RON.
    const fn name(self) -> &'static str {
        match self {
            Self::Street(_) => "Street",
            Self::Square => "Square",
            Self::Built => "Built",
            Self::House => "House",
            Self::Park => "Park",
            Self::Water => "Water",
            Self::Railway => "Railway",
            Self::Label => "Label",
        }
    }
}

/// A colour and what it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LegendColour {
    /// What it stands for.
    pub class: MapClass,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// What the colours of a map stand for, and its scale.
///
/// # The file
/// RON:
/// ```
/// use veduta_city::StreetClass;
/// use veduta_survey::raster::{Legend, MapClass};
///
/// let text = r##"(
///     metres_per_pixel: 0.5,             // may be left out
///     outlined: false,                   // may be left out; true where blocks are only outlined, on the streets' paper
///     colours: [
///         (colour: "#FFFEF8", class: Street),
///         (colour: "#FCDD80", class: Street, street: Main),
///         (colour: "#E2D3BE", class: Built),
///         (colour: "#B5D59E", class: Park),
///     ],
/// )"##;
/// let legend = Legend::parse(text, "old_town.legend.ron")?;
/// assert_eq!(legend.metres_per_pixel, Some(0.5));
/// assert_eq!(legend.colours[1].class, MapClass::Street(Some(StreetClass::Main)));
///
/// // A mistake is told with its place.
/// let error = Legend::parse("(colours: [\n  (colour: \"#FFF\", class: Stret),\n])", "x.ron").unwrap_err();
/// assert!(error.to_string().starts_with("x.ron:2:"), "{error}");
/// # Ok::<(), veduta_survey::raster::LegendError>(())
/// ```
/// Colours are `#RRGGBB`, `#RGB` or a basic CSS name; classes `Street`, `Square`, `Built`, `House`, `Park`, `Water`,
/// `Railway`, `Label`; a street's class one of [`StreetClass`].
///
/// JSON, of colours as three numbers from 0 to 255 under the name of their class; `street:main` names a class of street:
/// ```
/// let text = r#"{"metres_per_pixel": 0.5, "classes": {"street": [[255, 254, 248]], "street:main": [[252, 221, 128]],
///     "built": [[226, 211, 190], [231, 200, 178]], "railroad": [[112, 78, 140]]}}"#;
/// let legend = veduta_survey::raster::Legend::parse(text, "legend.json")?;
/// assert_eq!(legend.colours.len(), 5);
/// # Ok::<(), veduta_survey::raster::LegendError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Legend {
    /// Metres that a pixel is wide, if the legend says so.
    pub metres_per_pixel: Option<f64>,
    /// Whether blocks are only outlined, on the paper that streets are of too: that colour is the streets', and lines, letters
    /// and hatching are labels. What lines enclose is a block.
    pub is_outlined: bool,
    /// The colours, none twice.
    pub colours: Vec<LegendColour>,
}

/// Why a legend could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LegendError {
    /// A mistake in the text, with file, line, column and the line itself.
    #[error("{0}")]
    Syntax(#[from] SyntaxError),
    /// Without a street there is nothing to survey.
    #[error("{name} names no colour of streets: add one, such as (colour: \"#FFFFFF\", class: Street)")]
    NoStreet {
        /// The file.
        name: String,
    },
}

impl Legend {
    /// Reads a legend, RON or JSON (told by its first sign, `(` or `{`); `name` stands in messages.
    ///
    /// # Errors
    /// [`LegendError`], with line and column: for a mistake of spelling, an unknown class, a colour that stands for two
    /// things, a scale that is none, or more than 256 colours; and where no colour stands for streets.
    pub fn parse(text: &str, name: &str) -> Result<Self, LegendError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let legend = if text.trim_start().starts_with('{') {
            let read: JsonFile = serde_json::from_str(text).map_err(|error| syntax_error(text, name, &error))?;
            Self { metres_per_pixel: read.metres_per_pixel, is_outlined: read.outlined, colours: read.classes }
        } else {
            let read: RonFile = file::parse(text, name)?;
            Self { metres_per_pixel: read.metres_per_pixel, is_outlined: read.outlined, colours: read.colours }
        };
        if !legend.colours.iter().any(|c| matches!(c.class, MapClass::Street(_))) {
            return Err(LegendError::NoStreet { name: name.to_owned() });
        }
        Ok(legend)
    }

    /// The legend as RON, with comments for the person who corrects it. Reading it gives the same legend.
    #[must_use]
    pub fn to_ron(&self) -> String {
        self.to_ron_with(&[])
    }

    /// As [`Legend::to_ron`], with what a guess was not sure of: a finding that names a colour stands above that colour, the
    /// others at the top.
    #[must_use]
    pub fn to_ron_with(&self, findings: &[Finding]) -> String {
        let mut text = String::from(
            "// What the colours of the map stand for. Correct what is wrong, and survey again with this file as its legend.\n\
             // Classes: Street, Square, Built, House (single houses in a colour of their own), Park, Water, Railway, Label\n\
             // (lettering and symbols, which are filled from around).\n\
             // A street may have a class: (colour: \"#FCDD80\", class: Street, street: Main); they are Motorway, Main, Street,\n\
             // Lane, Service, Path, Steps. A colour of the map that is not here goes to the nearest one that is.\n",
        );
        let hex = |c: &LegendColour| Rgb(c.colour[0], c.colour[1], c.colour[2]).to_string();
        let says = |finding: &Finding, indent: &str| format!("{indent}// {}\n", finding.message.replace(['\n', '\r'], " "));
        let is_of = |finding: &Finding, c: &LegendColour| finding.message.contains(&hex(c));
        for finding in findings.iter().filter(|f| !self.colours.iter().any(|c| is_of(f, c))) {
            text += &says(finding, "");
        }
        text += "(\n";
        match self.metres_per_pixel {
            Some(metres) => text += &format!("    metres_per_pixel: {metres:?},\n"),
            None => {
                text += "    // the scale is not known: write it here, or give two known points\n    // metres_per_pixel: 0.5,\n"
            }
        }
        if self.is_outlined {
            text += "    // blocks are only outlined: what lines enclose is one, and the paper around them is street\n    outlined: true,\n";
        }
        text += "    colours: [\n";
        for colour in &self.colours {
            for finding in findings.iter().filter(|f| is_of(f, colour)) {
                text += &says(finding, "        ");
            }
            let class = colour.class.name();
            let street = match colour.class {
                MapClass::Street(Some(street)) => format!(", street: {street:?}"),
                _ => String::new(),
            };
            text += &format!("        (colour: \"{}\", class: {class}{street}),\n", hex(colour));
        }
        text + "    ],\n)\n"
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Legend")]
struct RonFile {
    #[serde(default, deserialize_with = "scale")]
    metres_per_pixel: Option<f64>,
    #[serde(default)]
    outlined: bool,
    #[serde(deserialize_with = "ron_colours")]
    colours: Vec<LegendColour>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonFile {
    #[serde(default, deserialize_with = "scale")]
    metres_per_pixel: Option<f64>,
    #[serde(default)]
    outlined: bool,
    #[serde(deserialize_with = "json_colours")]
    classes: Vec<LegendColour>,
}

/// A scale that can be one.
fn scale<'de, D: Deserializer<'de>>(source: D) -> Result<Option<f64>, D::Error> {
    match Option::<f64>::deserialize(source)? {
        Some(metres) if !(metres > 0.0 && metres <= MOST_METRES) => {
            Err(D::Error::custom(format!("{metres} metres a pixel is no scale: above 0 and at most {MOST_METRES}")))
        }
        metres => Ok(metres),
    }
}

/// Adds a colour unless it is there already.
fn add<E: serde::de::Error>(colours: &mut Vec<LegendColour>, new: LegendColour) -> Result<(), E> {
    if let Some(old) = colours.iter().find(|old| old.colour == new.colour) {
        if old.class == new.class {
            return Ok(());
        }
        let hex = Rgb(new.colour[0], new.colour[1], new.colour[2]);
        return Err(E::custom(format!("{hex} cannot stand for both {:?} and {:?}", old.class, new.class)));
    }
    if colours.len() == MOST_COLOURS {
        return Err(E::custom(format!("a legend has at most {MOST_COLOURS} colours")));
    }
    colours.push(new);
    Ok(())
}

#[derive(Deserialize)]
enum RonClass {
    Street,
    Square,
    Built,
    House,
    Park,
    Water,
    Railway,
    Label,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "LegendColour")]
struct RonColour {
    colour: Rgb,
    class: RonClass,
    #[serde(default)]
    street: Option<StreetClass>,
}

fn ron_colours<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<LegendColour>, D::Error> {
    struct Colours;
    impl<'de> Visitor<'de> for Colours {
        type Value = Vec<LegendColour>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a list of colours, such as [(colour: \"#FFFFFF\", class: Street)]")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
            let mut colours = Vec::new();
            while let Some(RonColour { colour, class, street }) = list.next_element()? {
                let class = match class {
                    RonClass::Street => MapClass::Street(street),
                    _ if street.is_some() => return Err(A::Error::custom("only a Street has a class of street")),
                    RonClass::Square => MapClass::Square,
                    RonClass::Built => MapClass::Built,
                    RonClass::House => MapClass::House,
                    RonClass::Park => MapClass::Park,
                    RonClass::Water => MapClass::Water,
                    RonClass::Railway => MapClass::Railway,
                    RonClass::Label => MapClass::Label,
                };
                add(&mut colours, LegendColour { class, colour: [colour.0, colour.1, colour.2] })?;
            }
            Ok(colours)
        }
    }
    source.deserialize_seq(Colours)
}

fn json_colours<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<LegendColour>, D::Error> {
    struct Classes;
    impl<'de> Visitor<'de> for Classes {
        type Value = Vec<LegendColour>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("classes with their colours, such as {\"street\": [[255, 255, 255]]}")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut colours = Vec::new();
            while let Some(class) = map.next_key_seed(ClassKey)? {
                map.next_value_seed(ColoursOf { class, colours: &mut colours })?;
            }
            Ok(colours)
        }
    }
    source.deserialize_map(Classes)
}

/// The colours of one class. They are added while their list is read, so that a mistake is told there.
struct ColoursOf<'a> {
    class: MapClass,
    colours: &'a mut Vec<LegendColour>,
}

impl<'de> DeserializeSeed<'de> for ColoursOf<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<(), D::Error> {
        source.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for ColoursOf<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of colours, such as [[255, 255, 255]]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        while let Some(colour) = list.next_element::<[u8; 3]>()? {
            add(self.colours, LegendColour { class: self.class, colour })?;
        }
        Ok(())
    }
}

/// `street`, `street:main`, `railroad` …
struct ClassKey;

impl<'de> DeserializeSeed<'de> for ClassKey {
    type Value = MapClass;

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<MapClass, D::Error> {
        let name = String::deserialize(source)?;
        let unknown = || {
            D::Error::custom(format!(
                "`{name}` is no class: street, square, built, house, park, water, railroad, label, or street:main and the like"
            ))
        };
        match name.split_once(':') {
            Some((street, class)) if street.eq_ignore_ascii_case("street") => {
                let mut letters = class.trim().to_lowercase();
                if let Some(first) = letters.get_mut(..1) {
                    first.make_ascii_uppercase();
                }
                let class = file::parse::<StreetClass>(&letters, "").map_err(|_| unknown())?;
                Ok(MapClass::Street(Some(class)))
            }
            _ => MapClass::named(name.trim()).ok_or_else(unknown),
        }
    }
}

/// A mistake in JSON, told as those in RON are.
fn syntax_error(text: &str, name: &str, error: &serde_json::Error) -> SyntaxError {
    const SHOWN: usize = 120;
    let (line, column) = (error.line().max(1), error.column().max(1));
    let whole: Vec<char> = text.lines().nth(line - 1).unwrap_or("").chars().collect();
    let from = (column - 1).saturating_sub(SHOWN / 2).min(whole.len());
    let shown = whole.get(from..whole.len().min(from + SHOWN)).unwrap_or(&[]);
    let message = error.to_string();
    SyntaxError {
        file: name.to_owned(),
        line,
        column,
        text: shown.iter().map(|&c| if c == '\t' { ' ' } else { c }).collect(),
        caret: (column - 1).saturating_sub(from).min(SHOWN),
        // The place is told already.
        message: message.rsplit_once(" at line ").map_or(message.as_str(), |(what, _)| what).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use veduta_city::{Id, Severity};

    fn error_of(text: &str) -> String {
        Legend::parse(text, "t").expect_err(text).to_string()
    }

    #[test]
    fn mistakes_are_told_with_line_and_column() {
        let ron = |line: &str| format!("(\n  colours: [\n    (colour: \"#FFFFFF\", class: Street),\n    {line}\n  ],\n)");
        for (line, says) in [
            ("(colour: \"#FFFFFF\", class: Built),", "both Street(None) and Built"),
            ("(colour: \"#GGGGGG\", class: Built),", "no colour"),
            ("(colour: \"#000000\", class: Hut),", "Hut"),
            ("(colour: \"#000000\", class: Built, street: Main),", "only a Street"),
            ("(colour: \"#000000\", clas: Built),", "clas"),
            ("(colour: \"#000000\", class: Street, street: Wide),", "Wide"),
        ] {
            let error = error_of(&ron(line));
            assert!(error.starts_with("t:4:") && error.contains(says), "{line}: {error}");
        }
        let json = |line: &str| format!("{{\n \"classes\": {{\n  \"street\": [[255, 255, 255]],\n  {line}\n }}\n}}");
        for (line, says) in [
            ("\"built\": [[255, 255, 255]]", "both Street(None) and Built"),
            ("\"built\": [[255, 255, 256]]", "256"),
            ("\"built\": [[255, 255]]", "length 2"),
            ("\"hut\": [[1, 2, 3]]", "`hut` is no class"),
            ("\"street:wide\": [[1, 2, 3]]", "`street:wide` is no class"),
            ("\"street:\": [[1, 2, 3]]", "`street:` is no class"),
        ] {
            let error = error_of(&json(line));
            assert!(error.starts_with("t:4:") && error.contains(says), "{line}: {error}");
        }
    }

    #[test]
    fn a_scale_that_is_none_is_refused() {
        for scale in ["0", "-1", "1001", "inf", "NaN"] {
            let error = error_of(&format!("(metres_per_pixel: {scale}, colours: [(colour: \"#FFF\", class: Street)])"));
            assert!(error.contains("is no scale"), "{error}");
        }
        assert!(error_of("{\"metres_per_pixel\": 0, \"classes\": {}}").contains("is no scale"));
    }

    #[test]
    fn a_legend_without_streets_is_refused() {
        assert_eq!(Legend::parse("{\"classes\": {}}", "t"), Err(LegendError::NoStreet { name: "t".to_owned() }));
        assert!(error_of("(colours: [(colour: \"#FFF\", class: Park)])").contains("no colour of streets"));
    }

    #[test]
    fn the_legend_of_a_generated_map_is_read() {
        let text = r#"{"metres_per_pixel": 0.5, "classes": {"street": [[244, 239, 226]], "built": [[54, 50, 48], [70, 63, 60]],
            "label": [[196, 62, 40], [214, 146, 36], [196, 62, 40]], "railroad": [[148, 104, 168]]}}"#;
        let legend = Legend::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        let classes: Vec<MapClass> = legend.colours.iter().map(|c| c.class).collect();
        use MapClass::{Built, Label, Railway, Street};
        assert_eq!(classes, [Street(None), Built, Built, Label, Label, Railway], "a colour given twice counts once");
    }

    #[test]
    fn what_a_guess_was_not_sure_of_stands_beside_its_colour() {
        let legend = Legend {
            metres_per_pixel: None,
            is_outlined: false,
            colours: vec![
                LegendColour { class: MapClass::Street(None), colour: [255; 3] },
                LegendColour { class: MapClass::Built, colour: [200, 0, 1] },
            ],
        };
        let note = |text: &str| Finding::new(Severity::Note, Id::NONE, None, text);
        let text = legend.to_ron_with(&[note("#C80001 may be\na park"), note("colours are few")]);
        let lines: Vec<&str> = text.lines().collect();
        let at = lines.iter().position(|l| l.contains("may be a park")).unwrap_or_else(|| panic!("{text}"));
        assert!(lines[at].trim().starts_with("//") && lines[at + 1].contains("#C80001"), "{text}");
        let top = lines.iter().position(|l| *l == "// colours are few").unwrap_or_else(|| panic!("{text}"));
        assert!(lines[top + 1..].contains(&"("), "{text}");
        assert_eq!(Legend::parse(&text, "t").unwrap_or_else(|e| panic!("{e}")), legend);
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_again(
            metres in proptest::option::of(0.01f64..10.0),
            is_outlined: bool,
            picks in proptest::collection::btree_map(any::<[u8; 3]>(), 0usize..15, 1..20),
        ) {
            use StreetClass::{Lane, Main, Motorway, Path, Service, Steps, Street};
            let streets = [Motorway, Main, Street, Lane, Service, Path, Steps];
            let class = |i: usize| MapClass::ALL.get(i).copied().unwrap_or_else(|| MapClass::Street(Some(streets[i - MapClass::ALL.len()])));
            let mut colours: Vec<_> = picks.into_iter().map(|(colour, i)| LegendColour { class: class(i), colour }).collect();
            colours[0].class = MapClass::Street(None);
            let legend = Legend { metres_per_pixel: metres, is_outlined, colours };
            let text = legend.to_ron();
            prop_assert_eq!(Legend::parse(&text, "t").map_err(|e| TestCaseError::fail(e.to_string()))?, legend);
        }

        #[test]
        fn no_text_makes_the_reader_panic(text in "[\\(\\{\\[\\]\\}\\):,\"#a-zA-Z0-9 \n\t\u{e9}]{0,200}") {
            let _ = Legend::parse(&text, "t");
        }
    }
}
