use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use bevy_rapier3d::prelude::Collider;
use veduta_city::{CellShell, GridPos, Level};
use veduta_ecs::{CellContent, CellReady, CellReleased};
use veduta_growth::mesh::collision;

/// Cells whose walls and floors are in place: where one can walk. All else is closed.
#[derive(Resource, Debug, Default)]
pub struct SolidCells {
    cells: BTreeMap<u32, (Entity, Arc<CellShell>)>,
}

impl SolidCells {
    /// Whether a plan position lies in a cell with floor and walls, or in the tunnel of one, which may lead under houses.
    #[must_use]
    pub fn hold(&self, pos: GridPos) -> bool {
        self.cells.values().any(|(_, shell)| {
            let here = pos - shell.origin;
            let mut bores = shell.spans.iter().take(shell.drawn_spans as usize).filter(|span| span.is_bore());
            shell.outline.contains(here) || bores.any(|bore| bore.height_m(here.to_metres()).is_some())
        })
    }

    /// The cell in whose outline a plan position lies.
    #[must_use]
    pub fn at(&self, pos: GridPos) -> Option<u32> {
        self.cells.iter().find(|(_, (_, shell))| shell.outline.contains(pos - shell.origin)).map(|(cell, _)| *cell)
    }

    /// The nearest plan position that lies half a metre or more inside a cell; `None` if there are no cells.
    #[must_use]
    pub fn nearest(&self, pos: GridPos) -> Option<GridPos> {
        let target = pos.to_metres();
        let shells = self.cells.values().map(|(_, shell)| shell);
        let candidates = shells.flat_map(|shell| {
            let ring = &shell.outline.outer;
            let middle = shell.outline.centroid();
            ring.iter().zip(ring.iter().cycle().skip(1)).flat_map(move |(a, b)| {
                let (a, b) = (a.to_metres(), b.to_metres());
                let local = target - shell.origin.to_metres();
                let t = ((local - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
                let edge = a.lerp(b, t);
                let inward = [(b - a).perp().normalize_or_zero() * 0.6, (middle - edge).normalize_or_zero() * 1.5];
                inward
                    .map(|step| GridPos::from_metres(edge + step))
                    .into_iter()
                    .filter(|p| shell.outline.contains(*p))
                    .map(|p| p + shell.origin)
            })
        });
        candidates.min_by(|a, b| a.to_metres().distance_squared(target).total_cmp(&b.to_metres().distance_squared(target)))
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }
}

/// Colliders of a cell in the making.
#[derive(Component)]
pub(crate) struct Hardening(Task<Vec<(Vec3, Collider)>>, u32);

/// Starts making the colliders of cells whose content has arrived, off the main thread.
pub(crate) fn start(mut commands: Commands, mut ready: MessageReader<CellReady>, contents: Query<&CellContent>) {
    for message in ready.read().filter(|m| m.level == Level::One) {
        let Ok(content) = contents.get(message.entity) else { continue };
        let shell = Arc::clone(&content.shell);
        let task = AsyncComputeTaskPool::get().spawn(async move { colliders(&shell) });
        commands.entity(message.entity).insert(Hardening(task, message.cell));
    }
}

/// Walls, floor and standing objects as shapes, each with its place in the cell.
fn colliders(shell: &CellShell) -> Vec<(Vec3, Collider)> {
    let solid = collision(shell);
    let mut shapes = Vec::new();
    for mesh in [solid.walls, solid.ground] {
        if mesh.triangles.is_empty() {
            continue;
        }
        match Collider::trimesh(mesh.positions.into_iter().map(Vec3::from).collect(), mesh.triangles) {
            Ok(collider) => shapes.push((Vec3::ZERO, collider)),
            Err(error) => error!("a cell's walls are no collider: {error}"),
        }
    }
    for pillar in solid.objects {
        let half = (pillar.height_m / 2.0).max(0.05);
        shapes.push((Vec3::from(pillar.foot) + Vec3::Y * half, Collider::cylinder(half, pillar.radius_m)));
    }
    shapes
}

/// Puts finished colliders in place, under their cell.
pub(crate) fn finish(
    mut commands: Commands,
    mut making: Query<(Entity, &mut Hardening, &CellContent)>,
    mut solid: ResMut<SolidCells>,
) {
    for (entity, mut hardening, content) in &mut making {
        let Some(shapes) = check_ready(&mut hardening.0) else { continue };
        let cell = hardening.1;
        for (at, collider) in shapes {
            commands.spawn((collider, Transform::from_translation(at), ChildOf(entity)));
        }
        commands.entity(entity).remove::<Hardening>();
        solid.cells.insert(cell, (entity, Arc::clone(&content.shell)));
    }
}

/// Released cells are closed again.
pub(crate) fn forget(mut released: MessageReader<CellReleased>, mut solid: ResMut<SolidCells>) {
    for message in released.read() {
        solid.cells.remove(&message.cell);
    }
}
