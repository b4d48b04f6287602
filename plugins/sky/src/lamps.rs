use bevy::prelude::*;
use veduta_ecs::{CellContent, Daylight, Viewer};
use veduta_growth::mesh::lantern;

/// Street lamps that shine. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct LampSettings {
    /// Most lamps that light what is about them; of all others only the lantern glows. Those nearest to a viewer are taken.
    pub most: usize,
    /// Farthest lamp that shines, metres.
    pub reach_m: f32,
}

impl Default for LampSettings {
    fn default() -> Self {
        Self { most: 24, reach_m: 90.0 }
    }
}

/// A light that hangs in the lantern it was last hung in.
#[derive(Component, Debug, Clone, Copy, Default)]
pub(crate) struct Lamp;

/// Luminous flux of a lamp, lumens; more than gas gave, as night is exposed as if there were a moon.
const FLUX_LM: f32 = 120_000.0;
/// How far a lamp's light reaches, metres.
const RANGE_M: f32 = 32.0;
/// Gaslight.
const GASLIGHT: Color = Color::linear_rgb(1.0, 0.62, 0.28);

/// Hangs lights in the lanterns nearest to the viewers at night. They fade in over the last fifth of their reach, so that none pops.
pub(crate) fn light_lamps(
    mut commands: Commands,
    settings: Res<LampSettings>,
    light: Res<Daylight>,
    viewers: Query<&GlobalTransform, With<Viewer>>,
    cells: Query<(&CellContent, &GlobalTransform)>,
    mut lamps: Query<(&mut PointLight, &mut Transform), With<Lamp>>,
) {
    if light.night <= 0.0 {
        lamps.iter_mut().filter(|(lamp, _)| lamp.intensity > 0.0).for_each(|(mut lamp, _)| lamp.intensity = 0.0);
        return;
    }
    let eyes: Vec<Vec3> = viewers.iter().map(GlobalTransform::translation).collect();
    let mut near: Vec<(f32, Vec3)> = Vec::new();
    for (content, place) in &cells {
        for at in content.shell.objects.iter().filter_map(lantern) {
            let at = place.transform_point(Vec3::from_array(at));
            let away = eyes.iter().map(|eye| eye.distance(at)).fold(f32::INFINITY, f32::min);
            if away < settings.reach_m {
                near.push((away, at));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Where there are more lanterns than lamps, the reach ends before the first that must go without.
    let reach_m = near.get(settings.most).map_or(settings.reach_m, |&(away, _)| away);
    near.truncate(settings.most);
    let power = |away: f32| FLUX_LM * light.night * ((reach_m - away) / (0.2 * reach_m)).clamp(0.0, 1.0);
    let mut hung = near.into_iter();
    for (mut lamp, mut transform) in &mut lamps {
        let next = hung.next();
        let intensity = next.map_or(0.0, |(away, _)| power(away));
        if lamp.intensity.to_bits() != intensity.to_bits() {
            lamp.intensity = intensity;
        }
        if let Some((_, at)) = next {
            transform.set_if_neq(Transform::from_translation(at));
        }
    }
    for (away, at) in hung {
        let lamp = PointLight { color: GASLIGHT, intensity: power(away), range: RANGE_M, radius: 0.12, ..PointLight::default() };
        commands.spawn((Lamp, lamp, Transform::from_translation(at)));
    }
}
