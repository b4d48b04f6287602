use core::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A stable 64-bit name of a thing: the source's own (OSM type and number, a number written by hand), or a hash of its
/// kind and its anchor position on a coarse grid. `Id(0)` is "not given yet" ([`Id::NONE`]).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Id(pub u64);

/// Side in metres of the coarse grid that anchor positions are snapped to before hashing.
const COARSE_M: f64 = 0.5;

impl Id {
    /// Not given: replaced by a hash of kind and place when a file is read.
    pub const NONE: Self = Self(0);

    /// Id of a thing of the source: OSM's `node`, `way` and `relation` are kinds 1, 2 and 3. The two top bits are left
    /// clear for hashes to set.
    #[must_use]
    pub const fn from_source(kind: u8, number: u64) -> Self {
        Self(((kind as u64) << 58) | (number & ((1 << 58) - 1)))
    }

    /// Id from kind and anchor position, stable while the thing stays within its half-metre square. The top bit is set, so
    /// that it never equals a source's id.
    #[must_use]
    pub fn from_place(kind: &str, plan_pos: DVec2) -> Self {
        let snapped = (plan_pos / COARSE_M).floor();
        let mut hasher = blake3::Hasher::new();
        hasher.update(kind.as_bytes());
        hasher.update(&(snapped.x as i64).to_le_bytes());
        hasher.update(&(snapped.y as i64).to_le_bytes());
        let mut first = [0; 8];
        first.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
        Self(u64::from_le_bytes(first) | 1 << 63)
    }

    /// Whether the id has been given.
    #[must_use]
    pub const fn is_given(self) -> bool {
        self.0 != 0
    }
}

impl fmt::Debug for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Id({self})")
    }
}

impl fmt::Display for Id {
    /// `way/123` for ids of OSM, sixteen hexadecimal digits for hashes, the bare number otherwise.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.0 & ((1 << 58) - 1);
        match self.0 >> 58 {
            0 => write!(f, "{number}"),
            1 => write!(f, "node/{number}"),
            2 => write!(f, "way/{number}"),
            3 => write!(f, "relation/{number}"),
            _ => write!(f, "{:016x}", self.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_from_place_survives_a_nudge_and_tells_kinds_apart() {
        let here = DVec2::new(10.1, -20.2);
        assert_eq!(Id::from_place("lamp", here), Id::from_place("lamp", here + 0.1));
        assert_ne!(Id::from_place("lamp", here), Id::from_place("tree", here));
        assert_ne!(Id::from_place("lamp", here), Id::from_place("lamp", here + 0.6));
    }

    #[test]
    fn ids_of_osm_print_as_osm_does() {
        assert_eq!(Id::from_source(2, 123).to_string(), "way/123");
        assert_eq!(Id(7).to_string(), "7");
    }
}
