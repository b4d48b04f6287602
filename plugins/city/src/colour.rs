use core::fmt;
use core::str::FromStr;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// A colour in sRGB, eight bits a channel; written `"#D9B36C"` in files.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Rgb(
    /// Red.
    pub u8,
    /// Green.
    pub u8,
    /// Blue.
    pub u8,
);

impl Rgb {
    /// The colour with every channel multiplied, clamped to 0–255.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        let scale = |c: u8| (f64::from(c) * by).round().clamp(0.0, 255.0) as u8;
        Self(scale(self.0), scale(self.1), scale(self.2))
    }

    /// The three channels in linear light, 0 to 1.
    #[must_use]
    pub fn to_linear(self) -> [f32; 3] {
        [self.0, self.1, self.2].map(|c| LINEAR[usize::from(c)])
    }

    /// The colour nearest to channels in linear light; what is beyond 0 to 1 is bounded.
    #[must_use]
    pub fn from_linear(channels: [f32; 3]) -> Self {
        let (linear, firsts) = (&*LINEAR, &*FIRSTS);
        let [r, g, b] = channels.map(|light| {
            // Not a number and what is dark count as 0.
            let bin = (light * BINS as f32) as usize;
            let mut above = usize::from(firsts[bin.min(BINS - 1)]);
            while above < 255 && linear[above] < light {
                above += 1;
            }
            let below = above.saturating_sub(1);
            if light - linear[below] < linear[above] - light { below as u8 } else { above as u8 }
        });
        Self(r, g, b)
    }
}

/// The linear light of each step of sRGB.
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    core::array::from_fn(|c| {
        let c = c as f32 / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
    })
});

/// Equal parts of linear light: finer than all but the darkest steps of sRGB.
const BINS: usize = 4096;

/// For each part, the first step of sRGB that is not darker than where it begins.
static FIRSTS: LazyLock<[u8; BINS]> = LazyLock::new(|| {
    core::array::from_fn(|bin| {
        let begin = bin as f32 / BINS as f32;
        LINEAR.partition_point(|&step| step < begin).min(255) as u8
    })
});

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

impl fmt::Debug for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// A text that is no colour.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no colour: write \"#RRGGBB\" or a CSS basic colour name such as \"maroon\"")]
pub struct ParseColourError(String);

impl FromStr for Rgb {
    type Err = ParseColourError;

    /// Reads `#RRGGBB`, `#RGB` or one of the colour names in use in OpenStreetMap's `building:colour`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let fail = || ParseColourError(text.to_owned());
        if let Some(hex) = text.trim().strip_prefix('#') {
            let digits: Vec<u8> = hex.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>().ok_or_else(fail)?;
            return match digits[..] {
                [r, g, b] => Ok(Self(r * 17, g * 17, b * 17)),
                [a, b, c, d, e, f] => Ok(Self(a * 16 + b, c * 16 + d, e * 16 + f)),
                _ => Err(fail()),
            };
        }
        let key: String = text.trim().to_lowercase().replace([' ', '_', '-'], "");
        NAMED.iter().find(|(name, _)| *name == key).map(|(_, rgb)| *rgb).ok_or_else(fail)
    }
}

/// CSS names met on real buildings.
const NAMED: &[(&str, Rgb)] = &[
    ("black", Rgb(0x00, 0x00, 0x00)),
    ("white", Rgb(0xFF, 0xFF, 0xFF)),
    ("gray", Rgb(0x80, 0x80, 0x80)),
    ("grey", Rgb(0x80, 0x80, 0x80)),
    ("lightgray", Rgb(0xD3, 0xD3, 0xD3)),
    ("lightgrey", Rgb(0xD3, 0xD3, 0xD3)),
    ("darkgray", Rgb(0xA9, 0xA9, 0xA9)),
    ("darkgrey", Rgb(0xA9, 0xA9, 0xA9)),
    ("silver", Rgb(0xC0, 0xC0, 0xC0)),
    ("maroon", Rgb(0x80, 0x00, 0x00)),
    ("red", Rgb(0xFF, 0x00, 0x00)),
    ("darkred", Rgb(0x8B, 0x00, 0x00)),
    ("orange", Rgb(0xFF, 0xA5, 0x00)),
    ("yellow", Rgb(0xFF, 0xFF, 0x00)),
    ("lightyellow", Rgb(0xFF, 0xFF, 0xE0)),
    ("olive", Rgb(0x80, 0x80, 0x00)),
    ("lime", Rgb(0x00, 0xFF, 0x00)),
    ("green", Rgb(0x00, 0x80, 0x00)),
    ("aqua", Rgb(0x00, 0xFF, 0xFF)),
    ("teal", Rgb(0x00, 0x80, 0x80)),
    ("blue", Rgb(0x00, 0x00, 0xFF)),
    ("lightblue", Rgb(0xAD, 0xD8, 0xE6)),
    ("navy", Rgb(0x00, 0x00, 0x80)),
    ("fuchsia", Rgb(0xFF, 0x00, 0xFF)),
    ("purple", Rgb(0x80, 0x00, 0x80)),
    ("pink", Rgb(0xFF, 0xC0, 0xCB)),
    ("salmon", Rgb(0xFA, 0x80, 0x72)),
    ("brown", Rgb(0xA5, 0x2A, 0x2A)),
    ("saddlebrown", Rgb(0x8B, 0x45, 0x13)),
    ("sienna", Rgb(0xA0, 0x52, 0x2D)),
    ("beige", Rgb(0xF5, 0xF5, 0xDC)),
    ("ivory", Rgb(0xFF, 0xFF, 0xF0)),
    ("tan", Rgb(0xD2, 0xB4, 0x8C)),
    ("wheat", Rgb(0xF5, 0xDE, 0xB3)),
    ("khaki", Rgb(0xF0, 0xE6, 0x8C)),
    ("lightbrown", Rgb(0xB5, 0x65, 0x1D)),
];

impl Serialize for Rgb {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() { serializer.collect_str(self) } else { (self.0, self.1, self.2).serialize(serializer) }
    }
}

impl<'de> Deserialize<'de> for Rgb {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            let text = String::deserialize(deserializer)?;
            text.parse().map_err(serde::de::Error::custom)
        } else {
            <(u8, u8, u8)>::deserialize(deserializer).map(|(r, g, b)| Self(r, g, b))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_read_as_people_write_them() {
        assert_eq!("#D9B36C".parse(), Ok(Rgb(0xD9, 0xB3, 0x6C)));
        assert_eq!("#fa0".parse(), Ok(Rgb(0xFF, 0xAA, 0x00)));
        assert_eq!("Light Grey".parse(), Ok(Rgb(0xD3, 0xD3, 0xD3)));
        assert!("#12345".parse::<Rgb>().is_err());
        assert!("chartreuse-ish".parse::<Rgb>().is_err());
    }
}
