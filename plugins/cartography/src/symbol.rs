use veduta_city::{PlaceKind, Rgb};

use crate::Inks;

/// A small sign that marks a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Symbol {
    /// A sight: a tower with a pointed roof.
    Sight,
    /// A house, shop or inn: a gable.
    House,
    /// A spot with a view: an eye's cone.
    View,
    /// Where a way ends: a pin's head.
    End,
}

impl Symbol {
    /// All of them, in the order of legends.
    pub const ALL: [Self; 4] = [Self::Sight, Self::House, Self::View, Self::End];

    /// Of a place; `None` where only its name is written.
    #[must_use]
    pub const fn of_place(kind: PlaceKind) -> Option<Self> {
        match kind {
            PlaceKind::Monument => Some(Self::Sight),
            PlaceKind::House | PlaceKind::Shop => Some(Self::House),
            PlaceKind::Viewpoint => Some(Self::View),
            PlaceKind::Square | PlaceKind::Street | PlaceKind::Other => None,
        }
    }

    /// Its convex outline about its middle, in parts of the symbol's size: x to the right, y downwards.
    #[must_use]
    pub const fn outline(self) -> &'static [[f64; 2]] {
        match self {
            Self::Sight => &[[0.0, -0.62], [0.26, -0.14], [0.26, 0.48], [-0.26, 0.48], [-0.26, -0.14]],
            Self::House => &[[0.0, -0.44], [0.38, -0.05], [0.38, 0.4], [-0.38, 0.4], [-0.38, -0.05]],
            Self::View => &[[0.0, 0.42], [-0.44, -0.3], [-0.18, -0.44], [0.18, -0.44], [0.44, -0.3]],
            Self::End => &[[0.0, 0.5], [-0.4, -0.1], [-0.3, -0.4], [0.0, -0.5], [0.3, -0.4], [0.4, -0.1]],
        }
    }

    /// Its ink.
    #[must_use]
    pub const fn ink(self, inks: &Inks) -> Rgb {
        match self {
            Self::Sight => inks.sight,
            Self::House => inks.wall,
            Self::View => inks.view,
            Self::End => inks.led,
        }
    }

    /// From this scale on it is drawn: ems of the map to a metre.
    #[must_use]
    pub const fn from_scale(self) -> f64 {
        match self {
            Self::Sight | Self::End => 0.0,
            Self::View => 0.075,
            Self::House => 0.1,
        }
    }

    /// The message that names it in a legend.
    #[must_use]
    pub const fn message(self) -> &'static str {
        match self {
            Self::Sight => "legend-sight",
            Self::House => "legend-house",
            Self::View => "legend-view",
            Self::End => "legend-end",
        }
    }
}
