use serde::{Deserialize, Serialize};
use veduta_city::{GridPos, PlanTerrain};

use super::{Malformed, expecting};

/// A [`PlanTerrain`]: each post as the difference from where the three before it (west, south, south-west) let it be expected, which
/// on even slopes is next to nothing, in the largest power of two of grid steps that tells them all.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireTerrain {
    origin: GridPos,
    step: i32,
    columns: u32,
    unit: u8,
    off: Vec<i32>,
}

/// What a post is expected to be after those before it.
fn expected(before: &[i32], i: usize, columns: usize) -> i32 {
    let post = |back: usize| before[i - back];
    match (!i.is_multiple_of(columns), i >= columns) {
        (true, true) => post(1).wrapping_add(post(columns)).wrapping_sub(post(columns + 1)),
        (true, false) => post(1),
        (false, true) => post(columns),
        (false, false) => 0,
    }
}

impl From<&PlanTerrain> for WireTerrain {
    fn from(terrain: &PlanTerrain) -> Self {
        let (heights, columns) = (&terrain.heights, terrain.columns.max(1) as usize);
        let unit = heights.iter().fold(0, |bits, height| bits | height).trailing_zeros() % i32::BITS;
        let off = (0..heights.len()).map(|i| heights[i].wrapping_sub(expected(heights, i, columns)) >> unit).collect();
        Self { origin: terrain.origin, step: terrain.step, columns: terrain.columns, unit: unit as u8, off }
    }
}

impl TryFrom<WireTerrain> for PlanTerrain {
    type Error = Malformed;

    fn try_from(wire: WireTerrain) -> Result<Self, Malformed> {
        let columns = wire.columns.max(1) as usize;
        let mut heights = expecting(wire.off.len());
        for (i, off) in wire.off.into_iter().enumerate() {
            heights.push(expected(&heights, i, columns).wrapping_add(off.wrapping_shl(wire.unit.into())));
        }
        let terrain = Self { origin: wire.origin, step: wire.step, columns: wire.columns, heights };
        match terrain.check() {
            Ok(()) => Ok(terrain),
            Err(_) => Err(Malformed::Reason("the posts of the terrain do not fill a grid")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_heights_survive_and_slopes_take_next_to_nothing() {
        let terrain = |heights: Vec<i32>| PlanTerrain { origin: GridPos(3, -9), step: 4096, columns: 4, heights };
        let odd = terrain(vec![20_480_000, 0, -1, 7, -20_480_000, 3, 3, 20_480_000]);
        assert_eq!(PlanTerrain::try_from(WireTerrain::from(&odd)), Ok(odd));
        let even = terrain(vec![0, 160, -320, 48, 16, 0, 0, 64]);
        let wire = WireTerrain::from(&even);
        assert_eq!((wire.unit, wire.off[1], PlanTerrain::try_from(wire)), (4, 10, Ok(even)));
        let slope = terrain((0..40).map(|i| 5_000 + (i % 4) * 300 + (i / 4) * 77).collect());
        let wire = WireTerrain::from(&slope);
        assert_eq!(wire.off.iter().filter(|off| **off != 0).count(), 13, "the first row and the first column");
        assert_eq!(PlanTerrain::try_from(wire), Ok(slope));
        let ragged = WireTerrain { off: vec![1; 7], ..WireTerrain::from(&terrain(vec![0; 8])) };
        assert!(PlanTerrain::try_from(ragged).is_err());
        assert_eq!(PlanTerrain::try_from(WireTerrain::from(&PlanTerrain::default())), Ok(PlanTerrain::default()));
    }
}
