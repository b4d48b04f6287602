//! Houses of a packet: what is told of them with their region is not told again.

use serde::{Deserialize, Serialize};
use veduta_city::{Arcade, CellShell, Gable, GridPolygon, GridPos, HouseShell, PlanRoof, PlanTerrain, Rgb, VolumeShell};

use super::{
    Malformed, Steps, expecting,
    houses::{WireRoof, eaves_of},
    paint::{Brush, Paint},
};
use crate::code::{Outlines, Source, Unread};
use crate::{HousePart, PacketContext, RegionHouses};

/// Section of outlines.
const FOOTPRINTS: u8 = 1;

#[derive(Serialize, Deserialize)]
pub(super) struct WireHouse {
    /// None: that of its first volume, which its region tells.
    style: Option<u16>,
    /// Above that of the house before.
    floor: i32,
    is_monument: bool,
    volumes: Vec<WireVolume>,
}

#[derive(Serialize, Deserialize)]
struct WireVolume {
    body: WireBody,
    /// Above the house's floor.
    bottom: i32,
    has_roof: bool,
    gable: Gable,
    /// None: as the palette goes with the wall.
    trim: Option<(u8, u8, u8)>,
    /// Steps from one to the next.
    walls: Vec<u16>,
    arcades: Vec<Arcade>,
}

/// Footprint, eaves, roof and colours of a volume.
#[derive(Serialize, Deserialize)]
enum WireBody {
    /// Those of the next part of a house of the cell.
    Own,
    /// Those of any other part, by how many parts it is beyond the last one told so.
    Other(i32),
    /// Told here.
    Told {
        /// Above the bottom.
        eaves: i32,
        roof: WireRoof,
        /// None: as the last volume that was told here.
        paint: Option<Paint>,
    },
}

const NO_PART: Malformed = Malformed::Reason("a part of a house is named that its region does not tell of");

/// What is told of houses before a packet is, each part once.
struct Parts<'c> {
    houses: Option<&'c RegionHouses>,
    origin: GridPos,
    /// The next of the cell's own, and behind the last of them.
    own: core::ops::Range<usize>,
    /// The last other one.
    last: i32,
    is_taken: Vec<bool>,
}

impl<'c> Parts<'c> {
    fn new(context: PacketContext<'c>, origin: GridPos) -> Self {
        let own = context.houses.map_or(0..0, |houses| houses.numbers(context.place));
        let count = context.houses.map_or(0, |houses| houses.parts().len());
        Self { houses: context.houses, origin, last: own.start as i32, own, is_taken: vec![false; count] }
    }

    /// The part that says all of a volume that a body does, and how it is named from now on.
    fn find(&mut self, volume: &VolumeShell, terrain: &PlanTerrain) -> Option<(&'c HousePart, WireBody)> {
        let parts = self.houses?.parts();
        let corner = volume.footprint.outer.first()?.wrapping_add(self.origin);
        let is_it = |&number: &usize| {
            let part = &parts[number];
            !self.is_taken[number]
                && part.massing.outline.outer.first() == Some(&corner)
                && self.body(part, terrain) == Body::of(volume)
        };
        let number = self.own.clone().find(is_it).or_else(|| (0..parts.len()).find(is_it))?;
        let body = match self.own.clone().next() {
            Some(next) if next == number => WireBody::Own,
            _ => WireBody::Other((number as i32).wrapping_sub(self.last)),
        };
        let part = self.take(&body).ok().flatten()?;
        Some((part, body))
    }

    /// The part that a body names; `None` if the body tells itself what it is.
    fn take(&mut self, body: &WireBody) -> Result<Option<&'c HousePart>, Malformed> {
        let number = match *body {
            WireBody::Told { .. } => return Ok(None),
            WireBody::Own => self.own.clone().next(),
            WireBody::Other(step) => {
                self.last = self.last.wrapping_add(step);
                usize::try_from(self.last).ok()
            }
        };
        let part = self.houses.zip(number).and_then(|(houses, number)| Some((houses.parts().get(number)?, number)));
        let (part, number) = part.ok_or(NO_PART)?;
        // Else few bytes could fill the memory.
        if core::mem::replace(&mut self.is_taken[number], true) {
            return Err(Malformed::Reason("a part of a house is named twice"));
        }
        if self.own.contains(&number) {
            self.own.start = number + 1;
        }
        Ok(Some(part))
    }

    fn body(&self, HousePart { massing, .. }: &HousePart, terrain: &PlanTerrain) -> Body {
        let footprint = massing.outline.map(|pos| pos.wrapping_sub(self.origin));
        let ground = footprint.outer.first().map_or(0, |&pos| terrain.height(pos));
        let eaves = ground.wrapping_add(eaves_of(massing));
        Body { footprint, eaves, colour: massing.colour, roof: massing.roof }
    }
}

/// What a part tells of a volume.
#[derive(PartialEq, Eq)]
struct Body {
    footprint: GridPolygon,
    eaves: i32,
    colour: Rgb,
    roof: PlanRoof,
}

impl Body {
    fn of(volume: &VolumeShell) -> Self {
        Self { footprint: volume.footprint.clone(), eaves: volume.eaves, colour: volume.colour, roof: volume.roof }
    }
}

/// Rows of a shell's houses, and their footprints.
pub(super) fn houses(shell: &CellShell, context: PacketContext<'_>, outlines: &mut Outlines) -> Vec<WireHouse> {
    let mut floors = Steps::default();
    let mut brush = Brush::new(context.palettes);
    let mut parts = Parts::new(context, shell.origin);
    let mut rows = Vec::with_capacity(shell.houses.len());
    for house in &shell.houses {
        let mut style = Some(house.style);
        let mut volumes = Vec::with_capacity(house.volumes.len());
        for (n, volume) in house.volumes.iter().enumerate() {
            let body = match parts.find(volume, &shell.terrain) {
                Some((part, body)) => {
                    outlines.know(&volume.footprint);
                    style = style.filter(|&style| n > 0 || style != part.style);
                    body
                }
                None => {
                    outlines.polygon(FOOTPRINTS, &volume.footprint);
                    WireBody::Told {
                        eaves: volume.eaves.wrapping_sub(volume.bottom),
                        roof: WireRoof::of(&volume.roof, &volume.footprint),
                        paint: brush.tell(house.style, [volume.colour, volume.roof.colour]),
                    }
                }
            };
            let mut next = 0_u16;
            let step = |&wall: &u16| wall.wrapping_sub(core::mem::replace(&mut next, wall.wrapping_add(1)));
            volumes.push(WireVolume {
                body,
                bottom: volume.bottom.wrapping_sub(house.floor),
                has_roof: volume.has_roof,
                gable: volume.gable,
                trim: brush.tell_trim(house.style, volume.colour, volume.trim),
                walls: volume.walls.iter().map(step).collect(),
                arcades: volume.arcades.clone(),
            });
        }
        rows.push(WireHouse { style, floor: floors.to(house.floor), is_monument: house.is_monument, volumes });
    }
    rows
}

/// Houses of a shell with an origin, on a terrain that has been checked.
pub(super) fn pull_houses(
    rows: Vec<WireHouse>,
    context: PacketContext<'_>,
    (origin, terrain): (GridPos, &PlanTerrain),
    outlines: &mut Source<'_, '_>,
) -> Result<Vec<HouseShell>, Unread> {
    let mut floors = Steps::default();
    let mut brush = Brush::new(context.palettes);
    let mut parts = Parts::new(context, origin);
    let mut houses = expecting(rows.len());
    for WireHouse { style: mut told, floor, is_monument, volumes: rows } in rows {
        let floor = floors.by(floor);
        let mut volumes = expecting(rows.len());
        for row in rows {
            let bottom = floor.wrapping_add(row.bottom);
            let part = parts.take(&row.body)?;
            let style = told.or_else(|| part.map(|part| part.style)).ok_or(Malformed::Reason("a house has no style"))?;
            told = Some(style);
            let Body { footprint, eaves, colour, roof } = match (part, row.body) {
                (None, WireBody::Told { eaves, roof, paint }) => {
                    let footprint = outlines.polygon(FOOTPRINTS)?;
                    let [colour, covering] = brush.paint(style, paint)?;
                    let roof = roof.roof(&footprint, covering);
                    Body { footprint, eaves: bottom.wrapping_add(eaves), colour, roof }
                }
                (part, _) => {
                    let body = parts.body(part.ok_or(NO_PART)?, terrain);
                    outlines.know(&body.footprint);
                    body
                }
            };
            let mut next = 0_u16;
            let wall = |step: u16| {
                let wall = next.wrapping_add(step);
                next = wall.wrapping_add(1);
                wall
            };
            volumes.push(VolumeShell {
                footprint,
                bottom,
                eaves,
                colour,
                trim: brush.trim(style, colour, row.trim)?,
                roof,
                gable: row.gable,
                has_roof: row.has_roof,
                walls: row.walls.into_iter().map(wall).collect(),
                arcades: row.arcades,
            });
        }
        let style = told.ok_or(Malformed::Reason("a house has no style"))?;
        houses.push(HouseShell { style, floor, volumes, is_monument });
    }
    Ok(houses)
}
