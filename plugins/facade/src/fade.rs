use bevy::mesh::MeshTag;
use bevy::prelude::*;
use veduta_city::Level;
use veduta_ecs::{Cell, CellMesh, CellStands, LevelFade};

/// How arriving levels fade in.
#[derive(Resource, Reflect, Debug, Clone, Copy)]
#[reflect(Resource)]
pub struct FadeSettings {
    /// Seconds from nothing to all; 0 shows them at once (films).
    pub seconds: f32,
}

impl Default for FadeSettings {
    fn default() -> Self {
        Self { seconds: 3.5 }
    }
}

/// A fade that has begun and shows nothing yet.
const BEGUN: f32 = 1.0 / 1024.0;

/// Advances the fades of levels whose meshes stand. Level 1 of a cell stands at once: nothing was there before it, and a
/// dissolving house would show the street behind.
pub(crate) fn fade_levels(
    time: Res<Time>,
    settings: Res<FadeSettings>,
    mut stands: MessageReader<CellStands>,
    mut growing: Local<Vec<(Entity, usize)>>,
    mut cells: Query<&mut LevelFade, With<Cell>>,
) {
    for message in stands.read() {
        let Ok(mut fade) = cells.get_mut(message.entity) else { continue };
        let i = message.level.index();
        if message.level == Level::One || settings.seconds <= 0.0 {
            fade.0[i] = 1.0;
        } else {
            fade.0[i] = fade.0[i].max(BEGUN);
            if !growing.contains(&(message.entity, i)) {
                growing.push((message.entity, i));
            }
        }
    }
    let step = if settings.seconds > 0.0 { time.delta_secs() / settings.seconds } else { 1.0 };
    growing.retain(|&(entity, i)| {
        let Ok(mut fade) = cells.get_mut(entity) else { return false };
        // A level that was taken away meanwhile does not come back without its meshes.
        if fade.0[i] <= 0.0 {
            return false;
        }
        fade.0[i] = (fade.0[i] + step).min(1.0);
        fade.0[i] < 1.0
    });
}

/// Hands a cell's fades to its meshes, in the bits of their tags.
pub(crate) fn tag_meshes(
    cells: Query<(&LevelFade, &Children), Or<(Changed<LevelFade>, Changed<Children>)>>,
    mut meshes: Query<&mut MeshTag, With<CellMesh>>,
) {
    for (fade, children) in &cells {
        let tag = pack(fade.0);
        for child in children {
            if let Ok(mut mesh) = meshes.get_mut(*child) {
                mesh.set_if_neq(MeshTag(tag));
            }
        }
    }
}

/// Two bits for level 1, which fades next to never, and ten for each of the others: so many steps that none is seen.
fn pack([one, finer @ ..]: [f32; 4]) -> u32 {
    let bits = |fade: f32, most: f32| (fade.clamp(0.0, 1.0) * most).round() as u32;
    finer.iter().rev().fold(0, |tag, &fade| tag << 10 | bits(fade, 1023.0)) << 2 | bits(one, 3.0)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use bevy::time::TimeUpdateStrategy;
    use veduta_ecs::CellMeshKind;

    #[test]
    fn level_1_stands_at_once_and_level_2_fades_in() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, crate::FacadePlugin::default()));
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)));
        app.insert_resource(FadeSettings { seconds: 0.5 });
        let cell = app.world_mut().spawn((Cell(0), LevelFade::default())).id();
        let kind = CellMeshKind::Walls(Level::Two);
        let mesh = app.world_mut().spawn((CellMesh { cell: 0, kind }, ChildOf(cell))).id();
        app.update();
        for level in [Level::One, Level::Two] {
            app.world_mut().write_message(CellStands { entity: cell, cell: 0, level });
        }
        app.update();
        let fade = |app: &App| app.world().get::<LevelFade>(cell).expect("spawned above").0;
        assert_eq!(fade(&app)[0], 1.0);
        assert!(fade(&app)[1] > 0.0 && fade(&app)[1] < 0.5, "{:?}", fade(&app));
        for _ in 0..6 {
            app.update();
        }
        assert_eq!(fade(&app)[1], 1.0);
        assert_eq!(app.world().get::<MeshTag>(mesh).expect("spawned above").0, 0b1111_1111_1111);
    }

    #[test]
    fn a_fade_under_way_ends_when_levels_are_to_show_at_once() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, crate::FacadePlugin::default()));
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        let cell = app.world_mut().spawn((Cell(0), LevelFade::default())).id();
        app.world_mut().write_message(CellStands { entity: cell, cell: 0, level: Level::Two });
        app.update();
        let fade = |app: &App| app.world().get::<LevelFade>(cell).expect("spawned above").0[1];
        assert!(fade(&app) < 0.1);
        app.insert_resource(FadeSettings { seconds: 0.0 });
        app.update();
        assert_eq!(fade(&app), 1.0);
    }

    #[test]
    fn a_level_that_is_taken_away_in_its_fade_does_not_come_back() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, crate::FacadePlugin::default()));
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)));
        app.insert_resource(FadeSettings { seconds: 1.0 });
        let cell = app.world_mut().spawn((Cell(0), LevelFade::default())).id();
        let level_2 = |app: &App| app.world().get::<LevelFade>(cell).expect("spawned above").0[1];
        let stands = CellStands { entity: cell, cell: 0, level: Level::Two };
        app.world_mut().write_message(stands);
        app.update();
        app.update();
        app.world_mut().get_mut::<LevelFade>(cell).expect("spawned above").0[1] = 0.0;
        app.update();
        assert_eq!(level_2(&app), 0.0);
        // Told twice, it fades no faster.
        for _ in 0..2 {
            app.world_mut().write_message(stands);
            app.update();
        }
        app.update();
        assert!(level_2(&app) > 0.25 && level_2(&app) < 0.35, "{}", level_2(&app));
    }

    #[test]
    fn a_mesh_that_arrives_with_its_level_is_shown_at_once() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, crate::FacadePlugin::default()));
        app.insert_resource(FadeSettings { seconds: 0.0 });
        let cell = app.world_mut().spawn((Cell(0), LevelFade::default())).id();
        let kind = CellMeshKind::Walls(Level::Two);
        let mesh = app.world_mut().spawn((CellMesh { cell: 0, kind }, ChildOf(cell))).id();
        app.world_mut().write_message(CellStands { entity: cell, cell: 0, level: Level::Two });
        app.update();
        assert_eq!(app.world().get::<MeshTag>(mesh).expect("spawned above").0, 0b1111_1111_1100, "no later change will tag it");
    }
}
