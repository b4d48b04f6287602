use bevy::ecs::system::SystemParam;
use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::GridPos;

use crate::{City, Eye, StandingCells, Viewer};

/// How high the ground of the open city is: by its overview, before that has come by the cells that stand.
#[derive(SystemParam)]
pub struct Ground<'w> {
    city: Option<Res<'w, City>>,
    standing: Res<'w, StandingCells>,
}

/// Eyes rise and sink with the mean of the ground so far around them, as a share of their height above it, and at least so far,
/// metres: walkers do not feel where its triangles meet, and flights go over ditches.
const AROUND: f64 = 0.5;
const LEAST_AROUND_M: f64 = 1.0;

impl Ground<'_> {
    /// Height of the ground at a plan position, metres above the city's zero; 0 where nothing is known of it.
    #[must_use]
    pub fn at(&self, plan_pos: DVec2) -> f64 {
        self.known(plan_pos).unwrap_or(0.0)
    }

    fn known(&self, plan_pos: DVec2) -> Option<f64> {
        if let Some(overview) = self.city.as_ref().and_then(|city| city.overview.as_ref()) {
            return Some(overview.terrain.height_m(plan_pos));
        }
        let pos = GridPos::from_metres(plan_pos);
        let here = self.standing.iter().find(|(_, _, shell)| shell.outline.contains(pos - shell.origin));
        here.map(|(_, _, shell)| shell.terrain.height_m(plan_pos - shell.origin.to_metres()))
    }

    /// The ground that an eye so far above it rises and sinks with: smoother, the higher it is.
    #[must_use]
    pub fn about(&self, plan_pos: DVec2, eye_m: f64) -> f64 {
        let reach = (eye_m * AROUND).max(LEAST_AROUND_M);
        let diagonal = core::f64::consts::FRAC_1_SQRT_2;
        let ways = [(1.0, 0.0), (diagonal, diagonal), (0.0, 1.0), (-diagonal, diagonal)];
        let around = ways.into_iter().map(|(x, y)| DVec2::new(x, y) * reach).flat_map(|way| [plan_pos + way, plan_pos - way]);
        let known = [plan_pos; 2].into_iter().chain(around).filter_map(|pos| self.known(pos));
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// Who says how high the ground under an eye is.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq, Eq, Default)]
#[reflect(Component)]
pub enum Footing {
    /// The terrain: [`Eye::ground_m`] is set for whoever moves the eye.
    #[default]
    Terrain,
    /// Whoever moves the eye, because it stands on something: [`Eye::ground_m`] is left alone.
    Own,
}

/// Puts the ground under eyes that do not stand on their own.
pub(crate) fn follow_ground(ground: Ground<'_>, mut viewers: Query<(&mut Eye, &Footing), With<Viewer>>) {
    for (mut eye, _) in viewers.iter_mut().filter(|(_, footing)| **footing == Footing::Terrain) {
        let ground_m = ground.about(eye.plan_pos, eye.eye_m);
        if eye.ground_m != ground_m {
            eye.ground_m = ground_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use veduta_city::{CellShell, GridPolygon, Level, Overview, PlanTerrain};

    use super::*;
    use crate::EcsPlugin;

    /// A slope that rises a quarter metre a metre eastwards.
    fn slope(high: i32) -> PlanTerrain {
        let heights = (0..81).map(|i| high + (i % 9) * 1024).collect();
        PlanTerrain { origin: GridPos(-16 * 1024, -16 * 1024), step: 4096, columns: 9, heights }
    }

    #[test]
    fn eyes_rise_with_the_ground_unless_they_stand_on_their_own() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, EcsPlugin));
        let eye = Eye { plan_pos: DVec2::new(4.0, 0.0), ..Eye::default() };
        let viewers = [Footing::Terrain, Footing::Own].map(|f| app.world_mut().spawn((Viewer, f, eye, Transform::default())).id());
        let z = |app: &App| viewers.map(|v| app.world().get::<Eye>(v).expect("spawned").ground_m);
        app.update();
        assert_eq!(z(&app), [0.0, 0.0], "nothing is known yet");
        // A cell comes first, then the overview, which is believed.
        let side = 8 * 1024;
        let outline = GridPolygon::simple(vec![GridPos(0, -side), GridPos(side, -side), GridPos(side, side), GridPos(0, side)]);
        let shell = Arc::new(CellShell { outline, terrain: slope(0), ..CellShell::default() });
        app.world_mut().resource_mut::<StandingCells>().add(0, Level::One, &shell);
        app.update();
        assert!((z(&app)[0] - 5.0).abs() < 1e-9 && z(&app)[1] == 0.0, "{:?}", z(&app));
        let overview = Some(Arc::new(Overview { terrain: slope(10 * 1024), ..Overview::default() }));
        app.insert_resource(City { overview, ..City::default() });
        app.update();
        assert!((z(&app)[0] - 15.0).abs() < 1e-9 && z(&app)[1] == 0.0, "{:?}", z(&app));
    }
}
