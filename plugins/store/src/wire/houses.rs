use serde::{Deserialize, Serialize};
use veduta_city::{GridPolygon, Massing, PlanRoof, Rgb, RoofShape};

use super::{
    Malformed,
    paint::{Brush, Paint},
};
use crate::code::{Outlines, Source, Unread};
use crate::{HousePart, HousesContext, RegionHouses};

/// Section of outlines.
const FOOTPRINTS: u8 = 0;

/// [`RegionHouses`] in rows.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireHouses {
    /// How many parts each cell has.
    cells: Vec<u32>,
    parts: Vec<WirePart>,
}

#[derive(Serialize, Deserialize)]
struct WirePart {
    style: u16,
    /// Above the ground at its first vertex.
    eaves: i32,
    roof: WireRoof,
    /// None: as the part before.
    paint: Option<Paint>,
}

/// A roof but for its colour: its direction in quarter turns from the footprint's longest edge, and degrees beyond.
#[derive(Serialize, Deserialize)]
pub(super) struct WireRoof(RoofShape, i32, u8, i16);

impl WireRoof {
    pub(super) fn of(roof: &PlanRoof, footprint: &GridPolygon) -> Self {
        let quarter = Massing::nearest_quarter(footprint, roof.direction);
        let beyond = roof.direction.wrapping_sub(Massing::quarter_deg(footprint, quarter)) as i16;
        Self(roof.shape, roof.height, quarter, beyond)
    }

    pub(super) fn roof(self, footprint: &GridPolygon, colour: Rgb) -> PlanRoof {
        let Self(shape, height, quarter, beyond) = self;
        let direction = Massing::quarter_deg(footprint, quarter & 3).wrapping_add(beyond as u16);
        PlanRoof { shape, height, direction, colour }
    }
}

/// How high eaves stand above the ground at the first vertex.
pub(super) const fn eaves_of(massing: &Massing) -> i32 {
    let rise = massing.roof.height;
    massing.height.wrapping_sub(if rise > 0 { rise } else { 0 })
}

impl WireHouses {
    pub(crate) fn of(houses: &RegionHouses, context: HousesContext<'_>) -> (Self, Outlines) {
        let mut outlines = Outlines::default();
        let mut brush = Brush::new(context.palettes);
        let mut part = |HousePart { style, massing }: &HousePart| WirePart {
            style: *style,
            eaves: eaves_of(massing),
            roof: WireRoof::of(&massing.roof, &massing.outline),
            paint: brush.tell(*style, [massing.colour, massing.roof.colour]),
        };
        let (mut cells, mut parts) = (Vec::with_capacity(houses.cell_count()), Vec::with_capacity(houses.parts().len()));
        for place in 0..houses.cell_count() {
            if let Some(cell) = context.cells.get(place) {
                outlines.know(&cell.outline);
            }
            let here = houses.of_cell(place);
            here.iter().for_each(|part| outlines.polygon(FOOTPRINTS, &part.massing.outline));
            cells.push(here.len() as u32);
            parts.extend(here.iter().map(&mut part));
        }
        (Self { cells, parts }, outlines)
    }

    pub(crate) fn pull(self, context: HousesContext<'_>, outlines: &mut Source<'_, '_>) -> Result<RegionHouses, Unread> {
        let mut brush = Brush::new(context.palettes);
        let mut rows = self.parts.into_iter();
        let mut houses = RegionHouses::default();
        for (place, count) in self.cells.into_iter().enumerate() {
            if let Some(cell) = context.cells.get(place) {
                outlines.know(&cell.outline);
            }
            let here = rows.by_ref().take(count as usize).map(|WirePart { style, eaves, roof, paint }| {
                let outline = outlines.polygon(FOOTPRINTS)?;
                let [colour, covering] = brush.paint(style, paint)?;
                let roof = roof.roof(&outline, covering);
                let massing = Massing { height: eaves.wrapping_add(roof.height.max(0)), outline, roof, colour };
                Ok(HousePart { style, massing })
            });
            let here = here.collect::<Result<Vec<_>, Unread>>()?;
            if here.len() != count as usize {
                return Err(Malformed::Column("parts of houses").into());
            }
            houses.push(here);
        }
        if rows.next().is_some() {
            return Err(Malformed::Column("parts of houses").into());
        }
        Ok(houses)
    }
}
