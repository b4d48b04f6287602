use core::fmt;

use serde::Serialize;
use veduta_city::Level;

/// Figures of a city as written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct CityStats {
    /// Houses.
    pub houses: u64,
    /// Walls.
    pub walls: u64,
    /// Cells.
    pub cells: u64,
    /// Different blobs.
    pub blobs: u64,
    /// Blobs that were not there already.
    pub blobs_written: u64,
    /// Blobs that an earlier city had and this one has not.
    pub blobs_removed: u64,
    /// Regions of the index.
    pub regions: u64,
    /// Bytes of the index and of all its regions.
    pub bytes_index: u64,
    /// Bytes of the overview.
    pub bytes_overview: u64,
    /// Bytes of what regions tell of their houses.
    pub bytes_houses: u64,
    /// Bytes of the styles.
    pub bytes_styles: u64,
    /// Bytes of the files that travel with the city.
    pub bytes_files: u64,
    /// Bytes of all packets, by [`Level::index`].
    pub bytes_level: [u64; 4],
}

impl CityStats {
    /// Bytes of a level's packets for each house, at level 1 with what regions tell of it; `None` without houses.
    #[must_use]
    pub fn bytes_per_house(&self, level: Level) -> Option<f64> {
        let houses = if level == Level::One { self.bytes_houses } else { 0 };
        (self.houses > 0).then(|| (houses + self.bytes_level[level.index()]) as f64 / self.houses as f64)
    }
}

impl fmt::Display for CityStats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} houses in {} cells; index {} B, overview {} B",
            self.houses, self.cells, self.bytes_index, self.bytes_overview
        )?;
        for level in Level::ALL {
            let houses = if level == Level::One { self.bytes_houses } else { 0 };
            let bytes = houses + self.bytes_level[level.index()];
            if bytes > 0 {
                write!(f, "; {level} {bytes} B")?;
                if let Some(each) = self.bytes_per_house(level) {
                    write!(f, " ({each:.1} B a house)")?;
                }
                if houses > 0 {
                    write!(f, ", {houses} B of them for the overview, too")?;
                }
            }
        }
        Ok(())
    }
}
