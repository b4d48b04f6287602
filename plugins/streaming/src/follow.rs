use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::GridPos;
use veduta_ecs::{CellEntered, Eye, Viewer};
use veduta_store::CityIndex;

use crate::fetch::Store;
use crate::journal::{Event, Journal};

/// The cell in which a viewer is; `None` outside of every cell, and where the region that tells of it has not come yet.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentCell(
    /// Index of the cell.
    pub Option<u32>,
);

/// Follows every viewer: its cell, else through a portal, else anew.
pub(crate) fn follow_viewers(
    mut commands: Commands,
    store: Option<Res<Store>>,
    mut viewers: Query<(Entity, &Eye, Option<&mut CurrentCell>), With<Viewer>>,
    time: Res<Time>,
    mut journal: ResMut<Journal>,
    mut entered: MessageWriter<CellEntered>,
) {
    let Some(index) = store.as_ref().and_then(|store| store.client.index()) else { return };
    for (viewer, eye, current) in &mut viewers {
        let pos = grid(eye.plan_pos);
        let before = current.as_deref().copied();
        let now = follow(index, before.and_then(|c| c.0), pos);
        if before == Some(CurrentCell(now)) {
            continue;
        }
        match current {
            Some(mut current) => current.0 = now,
            None => drop(commands.entity(viewer).insert(CurrentCell(now))),
        }
        journal.note(time.elapsed_secs_f64(), Event::Entered { viewer: viewer.to_bits(), cell: now });
        entered.write(CellEntered { viewer, cell: now });
    }
}

fn grid(plan_pos: DVec2) -> GridPos {
    GridPos(GridPos::steps(plan_pos.x), GridPos::steps(plan_pos.y))
}

/// The cell of a position, looking first in the present one, then beyond its portals, then in all that is told of the place.
fn follow(index: &CityIndex, present: Option<u32>, pos: GridPos) -> Option<u32> {
    let holds = |cell: u32| index.cell(cell).is_some_and(|entry| entry.outline.contains(pos));
    if let Some(cell) = present {
        if holds(cell) {
            return present;
        }
        let mut beyond = index.portals(cell).filter_map(|portal| portal.other(cell));
        if let Some(next) = beyond.find(|&cell| holds(cell)) {
            return Some(next);
        }
    }
    index.locate(pos)
}
