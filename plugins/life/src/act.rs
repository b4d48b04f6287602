//! What those on stage do in a frame.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta_city::LifeKind;
use veduta_ecs::{CityClock, Cue, Eye, Subject, Viewer, Weather};

use crate::dial::{Pointing, pointings};
use crate::flock::Notice;
use crate::material::{MistMaterial, SolidMaterial};
use crate::pigeon;
use crate::population::eye_pos;
use crate::ring::Belfry;
use crate::stage::{Part, Stage};
use crate::wind::Wind;

/// The sound of pigeons that fly up.
pub const WINGS: &str = "wings";

/// What birds noticed, and when they were told last.
#[derive(Debug, Default)]
pub(crate) struct Before {
    time_s: f64,
    eyes: Vec<DVec3>,
}

/// Lets flocks do what they do, and shows them.
pub(crate) fn fly(
    time: Res<Time>,
    viewers: Query<&Eye, With<Viewer>>,
    belfry: Res<Belfry>,
    mut stage: ResMut<Stage>,
    mut solids: Option<ResMut<Assets<SolidMaterial>>>,
    mut mists: Option<ResMut<Assets<MistMaterial>>>,
    mut middles: Query<&mut Transform, With<Subject>>,
    mut cues: ParamSet<(MessageReader<Cue>, MessageWriter<Cue>)>,
    mut before: Local<Before>,
) {
    let (from_s, to_s) = (before.time_s, time.elapsed_secs_f64());
    let eyes: Vec<DVec3> = viewers.iter().map(eye_pos).collect();
    let pairs: Vec<(DVec3, DVec3)> =
        eyes.iter().enumerate().map(|(n, eye)| (before.eyes.get(n).copied().unwrap_or(*eye), *eye)).collect();
    *before = Before { time_s: to_s, eyes };
    let mut noises = belfry.noises.clone();
    // Whatever else is heard frightens birds, too, but not their own wings and not bells, which are told with their time.
    let others = cues
        .p0()
        .read()
        .filter(|cue| cue.sound != WINGS && !cue.sound.starts_with("bell."))
        .map(|cue| (to_s, cue.plan_pos.truncate()))
        .collect::<Vec<_>>();
    noises.extend(others);
    let mut heard = Vec::new();
    for actor in stage.actors.values_mut() {
        let Part::Flock { flock, birds, shades, origin_m, hues, subject } = &mut actor.part else { continue };
        let last = flock.frightened_s;
        flock.advance(from_s, to_s, &Notice { eyes: &pairs, noises: &noises });
        if flock.frightened_s != last {
            heard.push(actor.dweller.plan_pos.extend(actor.z_m));
        }
        if let Some(mut middle) = subject.and_then(|subject| middles.get_mut(subject).ok()) {
            let sum: DVec3 = flock.poses(to_s).map(|pose| pose.pos - *origin_m).sum();
            let from = sum / flock.len() as f64;
            middle.translation = actor.world + DVec3::new(from.x, from.z, -from.y).as_vec3();
        }
        let Some(mut birds) = solids.as_mut().and_then(|solids| solids.get_mut(&*birds)) else { continue };
        let numbers = &mut birds.extension.told.numbers;
        for (n, pose) in flock.poses(to_s).enumerate() {
            let from = pose.pos - *origin_m;
            let place = Vec3::new(from.x as f32, from.z as f32, -from.y as f32);
            let told = pigeon::told(&pose, place, hues.get(n).copied().unwrap_or(0.0));
            numbers[3 * n..3 * n + 3].copy_from_slice(&told);
        }
        let numbers = *numbers;
        if let Some(mut shades) = mists.as_mut().and_then(|mists| mists.get_mut(&*shades)) {
            shades.told.numbers = numbers;
        }
    }
    for plan_pos in heard {
        cues.p1().write(Cue { sound: WINGS.to_owned(), plan_pos, gain_db: 0.0 });
    }
}

/// Turns the hands of clocks.
pub(crate) fn turn_hands(
    clock: Res<CityClock>,
    stage: Res<Stage>,
    mut hands: Query<&mut Transform>,
    mut last: Local<Option<CityClock>>,
) {
    if last.replace(*clock) == Some(*clock) && !stage.is_changed() {
        return;
    }
    for actor in stage.actors.values() {
        let (Part::Clock { hands: entities }, LifeKind::Clock { dial, radius_m, .. }) = (&actor.part, &actor.dweller.kind) else {
            continue;
        };
        let face = Quat::from_rotation_y(core::f32::consts::PI - actor.dweller.heading_deg.to_radians() as f32);
        for (entity, Pointing { angle, out }) in entities.iter().zip(pointings(*dial, &clock)) {
            let Ok(mut transform) = hands.get_mut(*entity) else { continue };
            let turn = face * Quat::from_rotation_z(-angle as f32);
            let next = Transform::from_translation(actor.world + turn * Vec3::Y * (out * radius_m) as f32).with_rotation(turn);
            transform.set_if_neq(next);
        }
    }
}

/// Swings signs.
pub(crate) fn swing(time: Res<Time>, weather: Res<Weather>, stage: Res<Stage>, mut boards: Query<&mut Transform>) {
    let wind = Wind::of(&weather);
    for actor in stage.actors.values() {
        let Part::Sign { board, pendulum } = &actor.part else { continue };
        let Ok(mut transform) = boards.get_mut(*board) else { continue };
        let heading = actor.dweller.heading_deg.to_radians();
        let face = Quat::from_rotation_y(core::f32::consts::PI - heading as f32);
        // The board's face looks to the right and left of who looks at the wall.
        let across = wind.toward.dot(DVec2::new(-heading.cos(), heading.sin()));
        let angle = pendulum.angle(&wind, actor.dweller.plan_pos, across, time.elapsed_secs_f64());
        transform.rotation = face * Quat::from_rotation_z(angle as f32);
    }
}

/// Where a figure is that passes a window, of so many: its number, and its place from −1 (it comes) to 1 (it goes).
pub(crate) fn passing(count: u32, seconds: f64, since_s: f64) -> Option<(usize, f64)> {
    let share = since_s / seconds;
    if !(0.0..1.0).contains(&share) {
        return None;
    }
    let each = share * f64::from(count);
    let x = each.fract();
    // It lingers in the middle.
    let slowed = x + 0.13 * (core::f64::consts::TAU * x).sin();
    Some((each as usize, 2.0 * slowed - 1.0))
}

/// Shows the figures that pass when the hour is struck.
pub(crate) fn pass_figures(
    time: Res<Time>,
    belfry: Res<Belfry>,
    stage: Res<Stage>,
    mut bodies: Query<(&mut Transform, &mut Visibility, &mut Mesh3d)>,
) {
    for actor in stage.actors.values() {
        let (Part::Figures { figures, bodies: meshes }, LifeKind::Figures { count, windows_m, size_m, seconds }) =
            (&actor.part, &actor.dweller.kind)
        else {
            continue;
        };
        let since_s = belfry.hour.map_or(-1.0, |hour| time.elapsed_secs_f64() - hour.at_s);
        let face = Quat::from_rotation_y(core::f32::consts::PI - actor.dweller.heading_deg.to_radians() as f32);
        for (n, (entity, window)) in figures.iter().zip(windows_m).enumerate() {
            let Ok((mut transform, mut visibility, mut mesh)) = bodies.get_mut(*entity) else { continue };
            let Some((number, place)) = passing(*count, *seconds, since_s) else {
                visibility.set_if_neq(Visibility::Hidden);
                continue;
            };
            visibility.set_if_neq(Visibility::Inherited);
            // Every second window has the rest of them, so that no two are alike at once.
            let body = &meshes[(number + n * (meshes.len() / 2).max(1)) % meshes.len().max(1)];
            if mesh.0 != *body {
                mesh.0 = body.clone();
            }
            let x = window + place * (size_m.0 * 0.5 + size_m.1 * 0.15);
            // They look where they go, and turn to the street in the middle.
            let look = 1.25 * place.abs().powf(1.5);
            let turn = face * Quat::from_rotation_y(look as f32);
            let next = Transform::from_translation(actor.world + face * Vec3::X * x as f32).with_rotation(turn);
            transform.set_if_neq(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_come_one_after_another_and_linger_before_the_street() {
        assert_eq!(passing(6, 42.0, -1.0), None);
        assert_eq!(passing(6, 42.0, 42.0), None);
        let (mut last, mut middle_s) = ((0, -1.0), 0);
        for step in 0..4_200 {
            let (number, place) = passing(6, 42.0, f64::from(step) * 0.01).expect("they pass");
            assert!((-1.0..=1.0).contains(&place));
            if number == last.0 {
                assert!(place >= last.1, "it goes on");
            } else {
                assert!(number == last.0 + 1 && last.1 > 0.97 && place < -0.97, "the next comes when one has gone");
            }
            middle_s += u32::from(place.abs() < 0.3);
            last = (number, place);
        }
        assert_eq!(last.0, 5);
        assert!(middle_s > 1_800, "{middle_s} hundredths of a second in the middle");
    }
}
