use veduta_city::{PlaceKind, StreetClass};

use crate::Inks;

/// What a name on a map is the name of. In the order in which names are given room.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum NameKind {
    /// A square.
    Square,
    /// A landmark that is drawn as a small picture.
    Landmark,
    /// A river, pond or sea.
    Water,
    /// A main street.
    Main,
    /// A street.
    Street,
    /// A park.
    Park,
    /// A sight that is marked with a symbol.
    Sight,
    /// A lane.
    Lane,
    /// A way for walkers, stairs, a service road.
    Path,
    /// A house.
    House,
    /// A shop, inn or office.
    Shop,
    /// A spot with a view.
    View,
}

/// How a name is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NameStyle {
    /// Size of its letters, in ems of the map.
    pub size: f64,
    /// The least that it may shrink to where room is narrow, in ems.
    pub least: f64,
    /// How much thicker its strokes are than the font's, in parts of the size.
    pub weight: f64,
    /// Whether its letters lean.
    pub is_slanted: bool,
    /// Room between letters, in parts of the size.
    pub spacing: f64,
    /// From this scale on it is written: ems of the map to a metre.
    pub from_scale: f64,
}

impl NameKind {
    /// All of them, in order.
    pub const ALL: [Self; 12] = [
        Self::Square,
        Self::Landmark,
        Self::Water,
        Self::Main,
        Self::Street,
        Self::Park,
        Self::Sight,
        Self::Lane,
        Self::Path,
        Self::House,
        Self::Shop,
        Self::View,
    ];

    /// Of a street.
    #[must_use]
    pub const fn of_street(class: StreetClass) -> Self {
        match class {
            StreetClass::Motorway | StreetClass::Main => Self::Main,
            StreetClass::Street => Self::Street,
            StreetClass::Lane => Self::Lane,
            StreetClass::Service | StreetClass::Path | StreetClass::Steps => Self::Path,
        }
    }

    /// Of a place; `None` where places of its kind are named otherwise: streets along their lines.
    #[must_use]
    pub const fn of_place(kind: PlaceKind) -> Option<Self> {
        match kind {
            PlaceKind::Square => Some(Self::Square),
            PlaceKind::Monument => Some(Self::Sight),
            PlaceKind::House => Some(Self::House),
            PlaceKind::Shop => Some(Self::Shop),
            PlaceKind::Viewpoint => Some(Self::View),
            PlaceKind::Other => Some(Self::Park),
            PlaceKind::Street => None,
        }
    }

    /// How it is written.
    #[must_use]
    pub const fn style(self) -> NameStyle {
        let plain = NameStyle { size: 1.0, least: 0.78, weight: 0.03, is_slanted: false, spacing: 0.02, from_scale: 0.0 };
        match self {
            Self::Square => NameStyle { size: 1.12, least: 0.9, weight: 0.055, spacing: 0.04, from_scale: 0.02, ..plain },
            Self::Landmark => NameStyle { size: 1.02, least: 0.85, weight: 0.055, from_scale: 0.02, ..plain },
            Self::Water => NameStyle { size: 1.25, is_slanted: true, spacing: 0.18, ..plain },
            Self::Main => NameStyle { size: 1.15, weight: 0.05, spacing: 0.05, from_scale: 0.02, ..plain },
            Self::Street => NameStyle { from_scale: 0.04, ..plain },
            Self::Park => NameStyle { size: 0.95, is_slanted: true, from_scale: 0.03, ..plain },
            Self::Sight => NameStyle { size: 0.88, weight: 0.04, from_scale: 0.05, ..plain },
            Self::Lane => NameStyle { size: 0.9, least: 0.7, from_scale: 0.055, ..plain },
            Self::Path => NameStyle { size: 0.8, least: 0.68, weight: 0.02, from_scale: 0.09, ..plain },
            Self::House => NameStyle { size: 0.76, least: 0.7, weight: 0.02, from_scale: 0.1, ..plain },
            // There are hundreds of them in a town.
            Self::Shop => NameStyle { size: 0.72, least: 0.7, weight: 0.02, from_scale: 0.22, ..plain },
            Self::View => NameStyle { size: 0.76, least: 0.7, weight: 0.02, is_slanted: true, from_scale: 0.14, ..plain },
        }
    }

    /// The ink of its letters.
    #[must_use]
    pub const fn ink(self, inks: &Inks) -> veduta_city::Rgb {
        match self {
            Self::Water => inks.water_name,
            Self::Park => inks.park_name,
            Self::Landmark | Self::Sight => inks.sight,
            Self::View => inks.view,
            _ => inks.name,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_streets_the_greater_is_written_larger_and_from_farther_off() {
        let of = |class: StreetClass| NameKind::of_street(class).style();
        for pair in StreetClass::ALL.windows(2) {
            let [greater, lesser] = [of(pair[0]), of(pair[1])];
            assert!(greater.size >= lesser.size && greater.from_scale <= lesser.from_scale, "{pair:?}");
        }
        for kind in NameKind::ALL {
            assert!(kind.style().least <= kind.style().size);
        }
    }
}
