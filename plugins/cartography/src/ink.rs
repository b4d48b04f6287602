use veduta_city::{Rgb, SurfaceKind};

/// Which set of colours a map is drawn in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Colours {
    /// Warm paper, as engraved maps have it.
    #[default]
    Paper,
    /// Black and white first: outlines carry the map, tints help.
    Contrast,
    /// Kinds differ in lightness and between blue and yellow, so that they are told apart with any two kinds of cones.
    ColourBlind,
}

impl Colours {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Paper, Self::Contrast, Self::ColourBlind];

    /// What a visitor's choices come to.
    #[must_use]
    pub const fn chosen(high_contrast: bool, colour_blind_safe: bool) -> Self {
        match (high_contrast, colour_blind_safe) {
            (true, _) => Self::Contrast,
            (false, true) => Self::ColourBlind,
            (false, false) => Self::Paper,
        }
    }

    /// The inks.
    #[must_use]
    pub const fn inks(self) -> &'static Inks {
        match self {
            Self::Paper => &PAPER,
            Self::Contrast => &CONTRAST,
            Self::ColourBlind => &COLOUR_BLIND,
        }
    }
}

/// The inks that a map is drawn in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inks {
    /// The paper beyond the map's frame.
    pub paper: Rgb,
    /// Yards, and ground of which nothing else is known.
    pub yard: Rgb,
    /// Streets and squares.
    pub street: Rgb,
    /// Their rim.
    pub kerb: Rgb,
    /// Gravel and earth.
    pub gravel: Rgb,
    /// Lawns and parks.
    pub grass: Rgb,
    /// Crowns of trees.
    pub tree: Rgb,
    /// Open water.
    pub water: Rgb,
    /// Its banks.
    pub bank: Rgb,
    /// Rails in ballast.
    pub ballast: Rgb,
    /// Houses.
    pub house: Rgb,
    /// Houses with a name.
    pub notable: Rgb,
    /// Monuments, and whatever stands high.
    pub monument: Rgb,
    /// Edges of houses.
    pub wall: Rgb,
    /// Parapets of bridges, treads of stairs, piers of arcades.
    pub stone: Rgb,
    /// Names.
    pub name: Rgb,
    /// Names of water.
    pub water_name: Rgb,
    /// Names of parks.
    pub park_name: Rgb,
    /// About names and lines, so that they stand off from what they cross.
    pub halo: Rgb,
    /// Sights.
    pub sight: Rgb,
    /// Spots with a view.
    pub view: Rgb,
    /// The way that somebody is led.
    pub led: Rgb,
    /// Where a tour leads.
    pub tour: Rgb,
    /// Where the visitor has been.
    pub trail: Rgb,
}

const PAPER: Inks = Inks {
    paper: Rgb(0xFA, 0xF6, 0xEC),
    yard: Rgb(0xEC, 0xE5, 0xD4),
    street: Rgb(0xFE, 0xFC, 0xF7),
    kerb: Rgb(0xC6, 0xBA, 0xA2),
    gravel: Rgb(0xF3, 0xEB, 0xD6),
    grass: Rgb(0xCB, 0xDB, 0xAE),
    tree: Rgb(0xA6, 0xC0, 0x86),
    water: Rgb(0xA8, 0xCB, 0xDC),
    bank: Rgb(0x5F, 0x93, 0xAF),
    ballast: Rgb(0xD2, 0xCC, 0xC2),
    house: Rgb(0xDC, 0xC6, 0xA8),
    notable: Rgb(0xCB, 0xA8, 0x84),
    monument: Rgb(0xBC, 0x86, 0x68),
    wall: Rgb(0x9C, 0x82, 0x63),
    stone: Rgb(0x7A, 0x6A, 0x56),
    name: Rgb(0x3A, 0x31, 0x27),
    water_name: Rgb(0x1F, 0x54, 0x72),
    park_name: Rgb(0x3C, 0x5A, 0x26),
    halo: Rgb(0xFE, 0xFC, 0xF7),
    sight: Rgb(0x7A, 0x2F, 0x25),
    view: Rgb(0x2A, 0x62, 0x90),
    led: Rgb(0x2A, 0x62, 0x90),
    tour: Rgb(0xB0, 0x76, 0x1E),
    trail: Rgb(0xB0, 0x3A, 0x2E),
};

const CONTRAST: Inks = Inks {
    paper: Rgb(0xFF, 0xFF, 0xFF),
    yard: Rgb(0xF2, 0xF2, 0xF2),
    street: Rgb(0xFF, 0xFF, 0xFF),
    kerb: Rgb(0x00, 0x00, 0x00),
    gravel: Rgb(0xF8, 0xF4, 0xE4),
    grass: Rgb(0xC4, 0xE8, 0xB0),
    tree: Rgb(0x60, 0xA0, 0x50),
    water: Rgb(0xA4, 0xD4, 0xFF),
    bank: Rgb(0x00, 0x2E, 0x80),
    ballast: Rgb(0xD8, 0xD8, 0xD8),
    house: Rgb(0xD0, 0xD0, 0xD0),
    notable: Rgb(0xB4, 0xB4, 0xB4),
    monument: Rgb(0x6A, 0x6A, 0x6A),
    wall: Rgb(0x00, 0x00, 0x00),
    stone: Rgb(0x00, 0x00, 0x00),
    name: Rgb(0x00, 0x00, 0x00),
    water_name: Rgb(0x00, 0x1A, 0x5C),
    park_name: Rgb(0x00, 0x3A, 0x00),
    halo: Rgb(0xFF, 0xFF, 0xFF),
    sight: Rgb(0x8A, 0x00, 0x00),
    view: Rgb(0x00, 0x00, 0xC8),
    led: Rgb(0x00, 0x00, 0xC8),
    tour: Rgb(0x8A, 0x4A, 0x00),
    trail: Rgb(0xC0, 0x00, 0x00),
};

/// Lines in the colours of Okabe and Ito (2008), areas in tints that differ in lightness or between blue and yellow.
const COLOUR_BLIND: Inks = Inks {
    paper: Rgb(0xFC, 0xFB, 0xF8),
    yard: Rgb(0xEF, 0xEC, 0xE6),
    street: Rgb(0xFF, 0xFF, 0xFF),
    kerb: Rgb(0xB4, 0xAE, 0xA4),
    gravel: Rgb(0xF7, 0xEF, 0xD8),
    grass: Rgb(0xF0, 0xE0, 0x9A),
    tree: Rgb(0xC8, 0xB4, 0x5A),
    water: Rgb(0x9C, 0xCD, 0xF0),
    bank: Rgb(0x00, 0x72, 0xB2),
    ballast: Rgb(0xDA, 0xD6, 0xD2),
    house: Rgb(0xCE, 0xC8, 0xC4),
    notable: Rgb(0xB0, 0xA8, 0xA6),
    monument: Rgb(0x78, 0x6C, 0x70),
    wall: Rgb(0x6E, 0x66, 0x62),
    stone: Rgb(0x50, 0x4A, 0x46),
    name: Rgb(0x1C, 0x1A, 0x18),
    water_name: Rgb(0x00, 0x44, 0x72),
    park_name: Rgb(0x4A, 0x42, 0x08),
    halo: Rgb(0xFF, 0xFF, 0xFF),
    sight: Rgb(0x6A, 0x24, 0x00),
    view: Rgb(0x00, 0x5A, 0x90),
    led: Rgb(0x00, 0x72, 0xB2),
    tour: Rgb(0xE6, 0x9F, 0x00),
    trail: Rgb(0xD5, 0x5E, 0x00),
};

impl Inks {
    /// What covers the ground; `None` where nothing is drawn.
    #[must_use]
    pub const fn ground(&self, surface: SurfaceKind) -> Option<Rgb> {
        match surface {
            SurfaceKind::Asphalt | SurfaceKind::Cobbles | SurfaceKind::Mosaic | SurfaceKind::Flagstones => Some(self.street),
            SurfaceKind::Gravel => Some(self.gravel),
            SurfaceKind::Grass => Some(self.grass),
            SurfaceKind::Water => Some(self.water),
            SurfaceKind::Ballast => Some(self.ballast),
            SurfaceKind::Yard | SurfaceKind::Opening => None,
        }
    }

    /// A house, by what it is.
    #[must_use]
    pub const fn house(&self, tone: Tone) -> Rgb {
        match tone {
            Tone::House => self.house,
            Tone::Notable => self.notable,
            Tone::Monument => self.monument,
        }
    }
}

/// How dark a house is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Tone {
    /// Any house.
    #[default]
    House,
    /// One with a name.
    Notable,
    /// A monument, or one that stands high.
    Monument,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two colours, 1 to 21 (WCAG 2.2).
    fn contrast(a: Rgb, b: Rgb) -> f32 {
        let light = |c: Rgb| {
            let [r, g, b] = c.to_linear();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    /// A colour as who lacks a kind of cones sees it (Machado, Oliveira and Fernandes 2009, severity 1), in CIE Lab.
    fn seen(colour: Rgb, by: [[f32; 3]; 3]) -> [f32; 3] {
        let linear = colour.to_linear();
        let [r, g, b] = by.map(|row| row.iter().zip(linear).map(|(m, c)| m * c).sum::<f32>().clamp(0.0, 1.0));
        let xyz = [
            (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505,
            0.2126 * r + 0.7152 * g + 0.0722 * b,
            (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089,
        ];
        let [x, y, z] = xyz.map(|t| if t > 0.008_856 { libm::cbrtf(t) } else { 7.787 * t + 16.0 / 116.0 });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    const ALL_CONES: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const LACKS: [[[f32; 3]; 3]; 3] = [
        [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]],
        [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
        [[1.255_528, -0.076_749, -0.178_779], [-0.078_411, 0.930_809, 0.147_602], [0.004_733, 0.691_367, 0.303_900]],
    ];

    fn apart(a: Rgb, b: Rgb, by: [[f32; 3]; 3]) -> f32 {
        let (a, b) = (seen(a, by), seen(b, by));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt()
    }

    #[test]
    fn names_can_be_read_on_their_halos_and_on_what_lies_about_them() {
        for colours in Colours::ALL {
            let inks = colours.inks();
            let least = if colours == Colours::Contrast { 7.0 } else { 4.5 };
            for (name, ground) in [(inks.name, inks.street), (inks.name, inks.house), (inks.water_name, inks.water)]
                .into_iter()
                .chain([(inks.park_name, inks.grass), (inks.name, inks.halo), (inks.sight, inks.street)])
            {
                let contrast = contrast(name, ground);
                assert!(contrast >= least, "{colours:?}: {name} on {ground}: {contrast:.1}");
            }
        }
    }

    #[test]
    fn kinds_of_ground_are_told_apart_whichever_cones_are_lacking() {
        let inks = Colours::ColourBlind.inks();
        let areas = [inks.street, inks.grass, inks.water, inks.house, inks.monument];
        let lines = [inks.led, inks.tour, inks.trail];
        for cones in LACKS.into_iter().chain([ALL_CONES]) {
            for (kinds, least) in [(&areas[..], 12.0), (&lines[..], 12.0)] {
                for (i, &a) in kinds.iter().enumerate() {
                    for &b in &kinds[..i] {
                        let apart = apart(a, b, cones);
                        assert!(apart >= least, "{a} and {b}: {apart:.1}");
                    }
                }
            }
        }
        // The usual inks are not made for that.
        let usual = Colours::Paper.inks();
        assert!(LACKS.into_iter().any(|cones| apart(usual.grass, usual.house, cones) < 12.0));
    }
}
