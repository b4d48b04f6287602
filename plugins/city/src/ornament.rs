use serde::{Deserialize, Serialize};

/// What a street front carries besides its openings. Bays are counted from the wall's start, storeys from its ground floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ornament {
    /// What divides or frames it.
    #[serde(default)]
    pub articulation: Articulation,
    /// Its bay window.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub oriel: Option<Oriel>,
    /// Its balconies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balconies: Option<Balconies>,
    /// Its statue.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub niche: Option<Niche>,
}

/// How a front is divided or framed from its first floor to its cornice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Articulation {
    /// Not at all.
    #[default]
    Plain,
    /// Dressed stones at its corners, from the ground.
    Quoins,
    /// Pilasters between its bays.
    Pilasters,
}

/// A bay window: what stands out of a front over some storeys of one bay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Oriel {
    /// Its bay.
    pub bay: u8,
    /// Its lowest and highest storey.
    pub storeys: (u8, u8),
}

/// Balconies: one a storey before each run of bays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Balconies {
    /// Their bays: bit i for bay i.
    pub bays: u32,
    /// Lowest and highest storey that has them.
    pub storeys: (u8, u8),
    /// What keeps people from falling.
    pub parapet: Parapet,
}

impl Balconies {
    /// Runs of neighbouring bays, first and last.
    pub fn runs(self) -> impl Iterator<Item = (u8, u8)> {
        let has = move |bay: u8| bay < 32 && self.bays >> bay & 1 == 1;
        let last = move |from: u8| (from..32).take_while(|&bay| has(bay)).last().unwrap_or(from);
        (0..32).filter(move |&bay| has(bay) && (bay == 0 || !has(bay - 1))).map(move |from| (from, last(from)))
    }
}

/// The parapet of a balcony.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Parapet {
    /// Stone balusters under a coping.
    Balusters,
    /// Iron bars.
    Iron,
    /// Solid.
    Panels,
}

/// A statue on a console, before the pier between two bays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Niche {
    /// The bay after the pier; never 0.
    pub bay: u8,
    /// Its storey.
    pub storey: u8,
}

/// Where houses of a style have balconies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum BalconyPlaces {
    /// Nowhere.
    #[default]
    Nowhere,
    /// One of stone, over the door.
    OverDoor,
    /// Of iron, up the middle.
    Middle,
    /// Of iron, at both ends.
    Ends,
    /// Solid ones, at every other bay of all upper storeys.
    Stacks,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balconies_join_before_neighbouring_bays() {
        let runs = |bays| Balconies { bays, storeys: (1, 1), parapet: Parapet::Iron }.runs().collect::<Vec<_>>();
        assert_eq!(runs(0b1011_0001), [(0, 0), (4, 5), (7, 7)]);
        assert_eq!(runs(u32::MAX), [(0, 31)]);
        assert!(runs(0).is_empty());
    }
}
