use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::GridPos;
use veduta_ecs::{CellEntered, Eye, Viewer};
use veduta_store::CityIndex;

use crate::fetch::Store;

/// The cell in which a viewer is; `None` outside of every cell.
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
        entered.write(CellEntered { viewer, cell: now });
    }
}

fn grid(plan_pos: DVec2) -> GridPos {
    GridPos(GridPos::steps(plan_pos.x), GridPos::steps(plan_pos.y))
}

/// The cell of a position, looking first in the present one, then beyond its portals, then everywhere.
fn follow(index: &CityIndex, present: Option<u32>, pos: GridPos) -> Option<u32> {
    let holds = |cell: u32| index.cells.get(cell as usize).is_some_and(|c| c.outline.contains(pos));
    if let Some(cell) = present {
        if holds(cell) {
            return present;
        }
        let portals = index.cells.get(cell as usize).map_or(&[][..], |c| &c.portals);
        let beyond = portals.iter().filter_map(|&p| index.portals.get(p as usize)?.other(cell));
        if let Some(next) = beyond.into_iter().find(|&c| holds(c)) {
            return Some(next);
        }
    }
    index.locate(pos)
}
