use bevy::prelude::*;
use veduta_city::{Level, bounds};
use veduta_ecs::{Cell, CellContent, CellMemory, CellMesh, CellReady, Eye, LevelFade, MaterialsProvided, StandingCells, Viewer};

use crate::build::{BuildSettings, Queue};

/// How much farther than it is ordered relief is kept, metres: farther than any wall of a cell stands from the ground that one walks on, so
/// that none falls flat before an eye.
const KEEP_M: f64 = 40.0;

/// Orders relief where a viewer is near and gives it up where none is any more. It needs no packet of its own: it is made of what
/// level 2 is made of, and goes with it.
pub(crate) fn order(
    mut commands: Commands,
    settings: Res<BuildSettings>,
    provided: Option<Res<MaterialsProvided>>,
    viewers: Query<&Eye, With<Viewer>>,
    mut cells: Query<(Entity, &Cell, &CellContent, &mut LevelFade, &mut CellMemory)>,
    meshes: Query<(Entity, &CellMesh)>,
    mut standing: ResMut<StandingCells>,
    mut queue: ResMut<Queue>,
) {
    // Without materials that fade levels it would stand beside level 2.
    if provided.is_none() {
        return;
    }
    for (entity, &Cell(cell), content, mut fade, mut memory) in &mut cells {
        let levels = standing.levels(cell);
        let (has_walls, has_relief) = (levels.has(Level::Two), levels.has(Level::Four));
        if !has_relief && (!has_walls || settings.relief_m <= 0.0) {
            continue;
        }
        let away = viewers.iter().map(|eye| distance_m(content, eye)).fold(f64::INFINITY, f64::min);
        if has_relief && (!has_walls || away > settings.relief_m + KEEP_M) {
            let is_relief = |mesh: &CellMesh| mesh.cell == cell && mesh.kind.level() == Some(Level::Four);
            meshes.iter().filter(|(_, mesh)| is_relief(mesh)).for_each(|(mesh, _)| commands.entity(mesh).despawn());
            fade.0[Level::Four.index()] = 0.0;
            memory.0[Level::Four.index()] = 0;
            standing.remove_level(cell, Level::Four);
        } else if has_walls && !has_relief && away < settings.relief_m {
            queue.order_once(CellReady { entity, cell, level: Level::Four }, content);
        }
    }
}

/// Distance of an eye from a cell in plan, metres, as the material measures it.
fn distance_m(content: &CellContent, eye: &Eye) -> f64 {
    let origin = content.shell.origin.to_metres();
    content.shell.outline.bounds().map_or(f64::INFINITY, |own| bounds::distance_m(own, eye.plan_pos - origin))
}
