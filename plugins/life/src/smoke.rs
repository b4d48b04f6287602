//! Smoke over chimneys: which fires burn, and where.

use bevy::camera::visibility::NoFrustumCulling;
use bevy::light::NotShadowCaster;
use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{Id, LifeKind, Season};
use veduta_ecs::{City, CityClock, Eye, Ground, OpenCity, StandingCells, Viewer, WorldOrigin};

use crate::craft;
use crate::material::{MistMaterial, NUMBERS};
use crate::population::{Chimney, Population, stands};
use crate::settings::LifeSettings;
use crate::stage::{LifeMaterials, Living};

/// The one mesh of all smoke.
#[derive(Component, Debug, Clone, Copy)]
pub(crate) struct Smoke {
    chimneys: usize,
}

/// Fires are looked at again when a viewer has gone so far, metres, or the clock so many hours.
const STEP_M: f64 = 12.0;
const STEP_H: f64 = 0.05;

/// What was looked at when fires were chosen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chosen {
    eyes: Vec<DVec2>,
    version: u64,
    settings: LifeSettings,
    when: (u16, i64),
    standing: usize,
}

/// How many of those who have a hearth have lit it, 0 to 1: by the season, and most of all in the evening.
pub(crate) fn hearths_lit(season: Season, hour: f64) -> f64 {
    let cold = match season {
        Season::Winter => 1.0,
        Season::Autumn => 0.6,
        Season::Spring => 0.45,
        Season::Summer => 0.08,
    };
    // Bells of morning and evening, over what burns all day and what is left at night.
    let about = |middle: f64, wide: f64| {
        let off = (hour - middle + 12.0).rem_euclid(24.0) - 12.0;
        (-(off / wide).powi(2)).exp()
    };
    let night = 0.18 + 0.22 * about(13.0, 4.5);
    cold * (night + 0.45 * about(7.5, 1.6) + 0.62 * about(19.5, 2.6)).min(1.0)
}

/// How strongly a chimney smokes where a share of all hearths is lit: fires are lit one after another, and grow.
fn strength(chimney: &Chimney, lit: f64) -> f64 {
    if chimney.always {
        return chimney.strength;
    }
    chimney.strength * ((lit - chimney.draw.unit("lit")) * 5.0).clamp(0.0, 1.0)
}

/// Chooses the fires that are seen, and tells the shader where they burn.
pub(crate) fn kindle(
    mut commands: Commands,
    (population, settings, clock): (Res<Population>, Res<LifeSettings>, Res<CityClock>),
    (city, opened, standing): (Option<Res<City>>, Option<Res<OpenCity>>, Res<StandingCells>),
    (ground, origin): (Ground<'_>, Res<WorldOrigin>),
    viewers: Query<&Eye, With<Viewer>>,
    (materials, mut mists, mut meshes): (Res<LifeMaterials>, ResMut<Assets<MistMaterial>>, ResMut<Assets<Mesh>>),
    smokes: Query<(Entity, &Smoke)>,
    mut chosen: Local<Option<Chosen>>,
) {
    let eyes: Vec<DVec2> = viewers.iter().map(|eye| eye.plan_pos).collect();
    let now = Chosen {
        eyes: eyes.iter().map(|eye| (eye / STEP_M).round()).collect(),
        version: population.version,
        settings: *settings,
        when: (clock.day, (clock.hour / STEP_H) as i64),
        standing: standing.len(),
    };
    if materials.smoke == Handle::default() || chosen.as_ref() == Some(&now) {
        return;
    }
    *chosen = Some(now);
    let most = if settings.kinds.smoke { (settings.most_fires as usize).min(NUMBERS) } else { 0 };
    let lat_deg = city.as_ref().map_or(50.0, |city| city.anchor.lat);
    let lit = hearths_lit(Season::at(lat_deg, clock.day), clock.hour);
    let reach_m = settings.reach_m(&LifeKind::Smoke { strength: 1.0, always: true });
    let told = population.told.iter().filter_map(|dweller| {
        let LifeKind::Smoke { strength, always } = dweller.kind else { return None };
        let top = origin.world_from_plan(dweller.plan_pos, ground.at(dweller.plan_pos, f64::INFINITY) + dweller.height_m);
        let draw = Draw::new(0, dweller.id, "fire");
        stands(dweller.plan_pos, &standing, opened.as_deref()).then_some(Chimney {
            top,
            plan_pos: dweller.plan_pos,
            draw,
            strength,
            always,
        })
    });
    let mut fires: Vec<(f64, Vec4)> = population
        .chimneys
        .values()
        .flatten()
        .copied()
        .chain(told)
        .filter_map(|chimney| {
            let away = eyes.iter().map(|eye| eye.distance(chimney.plan_pos)).fold(f64::INFINITY, f64::min);
            let strength = strength(&chimney, lit);
            // Smoke thins out before its distance ends, so that none appears.
            let near = ((reach_m - away) / (0.3 * reach_m)).clamp(0.0, 1.0);
            (strength * near > 0.01).then(|| (away, chimney.top.extend((strength * near) as f32)))
        })
        .collect();
    fires.sort_by(|a, b| a.0.total_cmp(&b.0));
    fires.truncate(most);
    if let Some(mut material) = mists.get_mut(&materials.smoke) {
        material.told.numbers = [Vec4::ZERO; NUMBERS];
        for (number, (_, fire)) in material.told.numbers.iter_mut().zip(&fires) {
            *number = *fire;
        }
    }
    // As many chimneys as burn, in steps, so that the mesh is seldom made anew.
    let wanted = fires.len().div_ceil(8) * 8;
    match smokes.iter().next() {
        Some((_, smoke)) if smoke.chimneys == wanted => {}
        old => {
            if let Some((entity, _)) = old {
                commands.entity(entity).despawn();
            }
            if wanted > 0 {
                let mesh = Mesh3d(meshes.add(craft::smoke(wanted).mesh()));
                let material = MeshMaterial3d(materials.smoke.clone());
                commands.spawn((
                    Smoke { chimneys: wanted },
                    Living(Id::NONE),
                    mesh,
                    material,
                    Transform::default(),
                    NoFrustumCulling,
                    NotShadowCaster,
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fires_burn_in_the_cold_and_in_the_evening() {
        let lit = |season, hour| hearths_lit(season, hour);
        assert!(lit(Season::Winter, 19.5) > 0.75 && lit(Season::Winter, 19.5) <= 1.0);
        assert!(lit(Season::Winter, 19.5) > 2.0 * lit(Season::Winter, 3.0));
        assert!(lit(Season::Winter, 7.5) > lit(Season::Winter, 11.0));
        assert!(lit(Season::Summer, 19.5) < 0.1 && lit(Season::Autumn, 19.5) > lit(Season::Spring, 19.5));
        assert!((lit(Season::Winter, 23.99) - lit(Season::Winter, 0.0)).abs() < 0.01, "midnight is no border");
    }

    #[test]
    fn a_chimney_once_lit_smokes_more_the_colder_it_gets() {
        let draw = Draw::new(0, Id(9), "fire");
        let chimney = Chimney { top: Vec3::ZERO, plan_pos: DVec2::ZERO, draw, strength: 0.9, always: false };
        let all: Vec<f64> = (0..=100).map(|n| strength(&chimney, f64::from(n) / 100.0)).collect();
        assert!(all[0] == 0.0 && all.windows(2).all(|pair| pair[1] >= pair[0]));
        assert_eq!(strength(&Chimney { always: true, ..chimney }, 0.0), 0.9);
    }
}
