use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::system::SystemParam;
use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{GridPos, WaySpan};

use crate::{Around, City, Eye, StandingCells, Viewer};

/// How high the ground of the open city is: by its overview, where that has not come by the cells that stand.
#[derive(SystemParam)]
pub struct Ground<'w> {
    city: Option<Res<'w, City>>,
    standing: Res<'w, StandingCells>,
}

/// Eyes rise and sink with the mean of the ground so far around them, as a share of their height above it, and at least so far,
/// metres: walkers do not feel where its triangles meet, and flights go over ditches.
const AROUND: f64 = 0.5;
const LEAST_AROUND_M: f64 = 1.0;

/// Whoever is so far below a bridge goes under it, metres.
const HEADROOM_M: f64 = 2.0;
/// Ways that lie no farther below the ground than this end there: it goes on above them; metres.
const UNDER_M: f64 = 0.3;
/// No span of a way reaches so far from its first station, metres.
const LONGEST_SPAN_M: f64 = 100.0;

/// What one stands on somewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Floor {
    z_m: f64,
    /// Whether it is a bridge, a ramp or a tunnel.
    is_span: bool,
}

impl Ground<'_> {
    /// Height of what one stands on at a plan position who is at a height there, metres above the city's zero: of the ground, or of
    /// the highest way on a bridge or in a tunnel there that is not a man's height above. 0 where nothing is known of the ground.
    #[must_use]
    pub fn at(&self, plan_pos: DVec2, near_m: f64) -> f64 {
        self.floor(plan_pos, near_m).map_or(0.0, |floor| floor.z_m)
    }

    fn floor(&self, plan_pos: DVec2, near_m: f64) -> Option<Floor> {
        let overviews = self.city.as_ref().map(|city| &city.overviews);
        let around = Around { middle: plan_pos, radius_m: LONGEST_SPAN_M };
        let near = || overviews.into_iter().flat_map(|all| all.near(around));
        let known = near().find(|part| part.terrain.covers(plan_pos)).or_else(|| near().find(|part| part.terrain.is_level()));
        if let Some(known) = known {
            let spans = near().flat_map(|part| &part.spans);
            return Some(floor(spans, known.terrain.height_m(plan_pos), plan_pos, near_m));
        }
        let pos = GridPos::from_metres(plan_pos);
        let (_, _, shell) = self.standing.iter().find(|(_, _, shell)| shell.outline.contains(pos - shell.origin))?;
        let p = plan_pos - shell.origin.to_metres();
        Some(floor(&shell.spans, shell.terrain.height_m(p), p, near_m))
    }

    /// The floor that an eye so far above it rises and sinks with, smoother, the higher it is; as [`Ground::at`] else.
    #[must_use]
    pub fn about(&self, plan_pos: DVec2, near_m: f64, eye_m: f64) -> f64 {
        let Some(here) = self.floor(plan_pos, near_m) else { return 0.0 };
        let reach = (eye_m * AROUND).max(LEAST_AROUND_M);
        let diagonal = core::f64::consts::FRAC_1_SQRT_2;
        let ways = [(1.0, 0.0), (diagonal, diagonal), (0.0, 1.0), (-diagonal, diagonal)];
        let around = ways.into_iter().map(|(x, y)| DVec2::new(x, y) * reach).flat_map(|way| [plan_pos + way, plan_pos - way]);
        // Where the ground lies beside a bridge does not move whoever is on it.
        let like = around.filter_map(|pos| self.floor(pos, here.z_m)).filter(|floor| floor.is_span == here.is_span);
        let (sum, count) = like.fold((2.0 * here.z_m, 2.0), |(sum, count), floor| (sum + floor.z_m, count + 1.0));
        sum / count
    }
}

/// What one stands on who is at a height over ground of another.
fn floor<'a>(spans: impl IntoIterator<Item = &'a WaySpan>, ground_m: f64, p: DVec2, near_m: f64) -> Floor {
    let near = spans.into_iter().filter(|span| {
        let first = span.stations.first().map(|station| station.left.to_metres());
        first.is_some_and(|first| first.distance_squared(p) < LONGEST_SPAN_M * LONGEST_SPAN_M)
    });
    let (mut best, mut has_ground, mut open) = (None::<f64>, true, ground_m);
    for (span, height) in near.filter_map(|span| Some((span, span.height_m(p)?))) {
        if span.is_ramp() {
            (has_ground, open) = (false, height);
        }
        if height < near_m + HEADROOM_M {
            best = Some(best.map_or(height, |best| best.max(height)));
        }
    }
    let is_reached = has_ground && ground_m < near_m + HEADROOM_M;
    match best {
        Some(z_m) if !is_reached || z_m >= ground_m || ground_m - z_m < UNDER_M => Floor { z_m, is_span: true },
        _ if has_ground => Floor { z_m: ground_m, is_span: false },
        _ => Floor { z_m: open, is_span: true },
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

/// Who moves so far at once has jumped, metres: onto the highest floor there.
const JUMP_M: f64 = 10.0;

/// Puts the ground under eyes that do not stand on their own.
pub(crate) fn follow_ground(
    ground: Ground<'_>,
    mut viewers: Query<(Entity, &mut Eye, &Footing), With<Viewer>>,
    mut last: Local<EntityHashMap<DVec2>>,
) {
    last.retain(|viewer, _| viewers.contains(*viewer));
    for (viewer, mut eye, footing) in &mut viewers {
        if ground.floor(eye.plan_pos, f64::INFINITY).is_none() {
            continue;
        }
        let has_jumped = last.insert(viewer, eye.plan_pos).is_none_or(|last| last.distance(eye.plan_pos) > JUMP_M);
        if *footing != Footing::Terrain {
            continue;
        }
        let near_m = if has_jumped { f64::INFINITY } else { eye.ground_m };
        let ground_m = ground.about(eye.plan_pos, near_m, eye.eye_m);
        if eye.ground_m != ground_m {
            eye.ground_m = ground_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use veduta_city::{BoreEnd, CellShell, GridPolygon, Id, Level, Overview, PlanTerrain, SpanForm, SpanStation, SurfaceKind};

    use super::*;
    use crate::{EcsPlugin, Overviews};

    /// A slope that rises a quarter metre a metre eastwards.
    fn slope(high: i32) -> PlanTerrain {
        let heights = (0..81).map(|i| high + (i % 9) * 1024).collect();
        PlanTerrain { origin: GridPos(-16 * 1024, -16 * 1024), step: 4096, columns: 9, heights }
    }

    #[test]
    fn who_walks_down_a_ramp_stays_in_the_tunnel_and_who_walks_above_it_stays_above() {
        let station = |x: i32, z: i32| SpanStation { left: GridPos(x * 1024, 3000), right: GridPos(x * 1024, -3000), z: z * 1024 };
        let span = |form: SpanForm, from: (i32, i32), to: (i32, i32)| WaySpan {
            id: Id(1),
            form,
            surface: SurfaceKind::Asphalt,
            pavements: (0, 0),
            parapets: (true, true),
            stations: vec![station(from.0, from.1), station(to.0, to.1)],
            springing: 0,
            piers: (None, None),
            markings: Vec::new(),
        };
        let bore = SpanForm::Bore { crown: 5 * 1024, ends: (BoreEnd::Portal, BoreEnd::Wall) };
        let spans = [span(SpanForm::Ramp, (0, 10), (60, 4)), span(bore, (60, 4), (100, 4))];
        let walk = |from_m: f64, mut z: f64| {
            let step = |i: u32| DVec2::new(from_m + f64::from(i), 0.0);
            let mut floors = (0..110).map(|i| {
                let floor = floor(&spans, 10.0, step(i), z);
                z = floor.z_m;
                (floor.z_m, floor.is_span)
            });
            floors.by_ref().take(95 - from_m as usize).last()
        };
        assert_eq!(walk(-5.0, 10.0), Some((4.0, true)), "down the ramp and in");
        assert_eq!(walk(70.0, 10.0), Some((10.0, false)), "above it");
        assert_eq!(floor(&spans, 10.0, DVec2::new(30.0, 0.0), f64::INFINITY).z_m, 7.0, "above a ramp there is no ground");
        assert_eq!(floor(&spans, 10.0, DVec2::new(80.0, 0.0), f64::INFINITY).z_m, 10.0, "who jumps there is above the bore");
        assert_eq!(floor(&spans, 10.0, DVec2::new(80.0, 9.0), 4.0).z_m, 10.0, "beside it there is earth");
        assert_eq!(floor(&spans, 10.0, DVec2::new(30.0, 0.0), -50.0).z_m, 7.0);
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
        let overviews = Overviews::whole(Overview { terrain: slope(10 * 1024), ..Overview::default() });
        app.insert_resource(City { overviews, ..City::default() });
        app.update();
        assert!((z(&app)[0] - 15.0).abs() < 1e-9 && z(&app)[1] == 0.0, "{:?}", z(&app));
    }
}
