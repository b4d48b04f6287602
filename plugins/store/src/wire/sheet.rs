use serde::{Deserialize, Serialize};
use veduta_city::{
    Articulation, Balconies, FacadeSheet, GroundFloor, Niche, Opening, Oriel, Ornament, PaintedWall, Parapet, Storey, Wall,
    WallKind,
};

use super::{
    Malformed,
    columns::{Pull, Table, TableWriter, Uses},
    expecting,
};

/// A [`FacadeSheet`]: different walls once, made of different stacks of storeys once.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireSheet {
    /// For each wall, which of the different walls it is.
    walls: Uses,
    kinds: Vec<WallKind>,
    bays: Vec<u8>,
    /// 0: no door; else one more than its bay.
    door_bays: Vec<u16>,
    doors: Vec<Opening>,
    shops: Vec<u32>,
    blank: Vec<u32>,
    ornaments: Vec<Option<WireOrnament>>,
    /// For each different wall, which of the different stacks it has.
    stacks: Uses,
    /// Each different stack; none: one without storeys.
    tall: Vec<Option<WireStack>>,
    painted: Vec<PaintedWall>,
}

/// Storeys of a wall.
#[derive(Serialize, Deserialize)]
struct WireStack {
    /// Of the ground floor, its height beyond that of the stack before.
    ground: (i32, Opening),
    /// Of the storeys above it, each by the one below.
    above: Option<(WireStorey, Vec<WireStorey>)>,
}

/// Its height beyond that of the storey below, and its openings; none: those of the storey below.
#[derive(Serialize, Deserialize)]
struct WireStorey(i32, Option<Opening>);

impl WireStorey {
    fn of(storey: Storey, below: Storey) -> Self {
        let opening = (storey.opening != below.opening).then_some(storey.opening);
        Self(storey.height.wrapping_sub(below.height), opening)
    }

    fn storey(self, below: Storey) -> Storey {
        Storey { height: below.height.wrapping_add(self.0), opening: self.1.unwrap_or(below.opening) }
    }
}

impl WireStack {
    /// `ground` is what the ground floor of the stack before measures, and will be this one's.
    fn of(stack: &[Storey], ground: &mut i32) -> Option<Self> {
        let (&first, rest) = stack.split_first()?;
        let height = first.height.wrapping_sub(core::mem::replace(ground, first.height));
        let mut below = first;
        let mut told = |&storey: &Storey| WireStorey::of(storey, core::mem::replace(&mut below, storey));
        let above = rest.split_first().map(|(second, rest)| (told(second), rest.iter().map(told).collect()));
        Some(Self { ground: (height, first.opening), above })
    }

    fn storeys(self, ground: &mut i32) -> Vec<Storey> {
        *ground = ground.wrapping_add(self.ground.0);
        let mut storey = Storey { height: *ground, opening: self.ground.1 };
        let mut stack = vec![storey];
        for told in self.above.into_iter().flat_map(|(second, rest)| [second].into_iter().chain(rest)) {
            storey = told.storey(storey);
            stack.push(storey);
        }
        stack
    }
}

/// An [`Ornament`]: articulation; bay and storeys of the oriel; bays, storeys and parapet of the balconies; bay and storey of the niche.
#[derive(Serialize, Deserialize)]
struct WireOrnament(Articulation, Option<(u8, (u8, u8))>, Option<(u32, (u8, u8), Parapet)>, Option<(u8, u8)>);

impl From<Ornament> for WireOrnament {
    fn from(of: Ornament) -> Self {
        Self(
            of.articulation,
            of.oriel.map(|oriel| (oriel.bay, oriel.storeys)),
            of.balconies.map(|balconies| (balconies.bays, balconies.storeys, balconies.parapet)),
            of.niche.map(|niche| (niche.bay, niche.storey)),
        )
    }
}

impl From<WireOrnament> for Ornament {
    fn from(WireOrnament(articulation, oriel, balconies, niche): WireOrnament) -> Self {
        Self {
            articulation,
            oriel: oriel.map(|(bay, storeys)| Oriel { bay, storeys }),
            balconies: balconies.map(|(bays, storeys, parapet)| Balconies { bays, storeys, parapet }),
            niche: niche.map(|(bay, storey)| Niche { bay, storey }),
        }
    }
}

/// Most walls of a sheet, and most storeys of all its walls together: a table could claim far more than its bytes.
const WALLS_CAP: usize = 1 << 20;
const STOREYS_CAP: usize = 1 << 22;

impl From<&FacadeSheet> for WireSheet {
    fn from(sheet: &FacadeSheet) -> Self {
        let mut walls = TableWriter::default();
        sheet.walls.iter().for_each(|wall| walls.push(wall));
        let (different, walls) = walls.finish().parts();
        let mut stacks = TableWriter::default();
        different.iter().for_each(|wall| stacks.push(&wall.storeys));
        let (tall, stacks) = stacks.finish().parts();
        let mut ground = 0;
        Self {
            walls,
            kinds: different.iter().map(|wall| wall.kind).collect(),
            bays: different.iter().map(|wall| wall.bays).collect(),
            door_bays: different.iter().map(|wall| wall.ground_floor.door_bay.map_or(0, |bay| u16::from(bay) + 1)).collect(),
            doors: different.iter().map(|wall| wall.ground_floor.door).collect(),
            shops: different.iter().map(|wall| wall.ground_floor.shops).collect(),
            blank: different.iter().map(|wall| wall.ground_floor.blank).collect(),
            ornaments: different.iter().map(|wall| wall.ornament.as_deref().copied().map(WireOrnament::from)).collect(),
            stacks,
            tall: tall.iter().map(|stack| WireStack::of(stack, &mut ground)).collect(),
            painted: sheet.painted.clone(),
        }
    }
}

impl TryFrom<WireSheet> for FacadeSheet {
    type Error = Malformed;

    fn try_from(wire: WireSheet) -> Result<Self, Malformed> {
        let mut ground = 0;
        let tall = wire.tall.into_iter().map(|stack| stack.map_or_else(Vec::new, |stack| stack.storeys(&mut ground))).collect();
        let mut stacks = Table::of_parts(tall, wire.stacks).pull();
        let mut budget = STOREYS_CAP;
        let mut spend = |storeys: usize| {
            budget = budget.checked_sub(storeys).ok_or(Malformed::Reason("walls have too many storeys together"))?;
            Ok(())
        };
        let mut bays = Pull::new("bays", wire.bays);
        let mut door_bays = Pull::new("bays of doors", wire.door_bays);
        let mut doors = Pull::new("doors", wire.doors);
        let mut shops = Pull::new("shops", wire.shops);
        let mut blank = Pull::new("bays without an opening", wire.blank);
        let mut ornaments = Pull::new("ornaments", wire.ornaments);
        let mut different = expecting(wire.kinds.len());
        for kind in wire.kinds {
            let door_bay = door_bays.take()?.checked_sub(1).map(u8::try_from).transpose();
            let ground_floor = GroundFloor {
                door_bay: door_bay.map_err(|_| Malformed::Reason("a door's bay is too large"))?,
                door: doors.take()?,
                shops: shops.take()?,
                blank: blank.take()?,
            };
            let storeys = stacks.take_ref()?;
            spend(storeys.len())?;
            let ornament = ornaments.take()?.map(|ornament| Box::new(ornament.into()));
            different.push(Wall { kind, bays: bays.take()?, storeys: storeys.clone(), ground_floor, ornament });
        }
        stacks.finish()?;
        bays.finish()?;
        door_bays.finish()?;
        doors.finish()?;
        shops.finish()?;
        blank.finish()?;
        ornaments.finish()?;
        let mut uses = Table::of_parts(different, wire.walls).pull();
        if uses.left() > WALLS_CAP {
            return Err(Malformed::Reason("a sheet has too many walls"));
        }
        let mut walls = expecting(uses.left());
        while uses.left() > 0 {
            let wall = uses.take_ref()?;
            spend(wall.storeys.len())?;
            walls.push(wall.clone());
        }
        Ok(Self { painted: wire.painted, ..Self::of(walls) })
    }
}

#[cfg(test)]
impl WireSheet {
    /// A sheet that names one wall so often.
    pub(crate) fn named_often(wall: &Wall, often: usize) -> Self {
        let sheet = FacadeSheet::of(vec![wall.clone()]);
        Self { walls: Uses::of(vec![0; often]), ..Self::from(&sheet) }
    }
}
