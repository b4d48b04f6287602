//! In the street: blue stones for what is on its way, walls in the portals; a click on one walks through.

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::egui::Color32;
use veduta::city::Viewpoint;
use veduta::ecs::{Ground, JumpTo, OpenCells, PointersTaken, WorldOrigin};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Streamed};
use veduta::walker::{Gait, Intent, WalkerSystems};
use veduta_store::What;

use super::{EDGE, Expert, OPEN, PENDING, SHUT, is_shown};

/// Height of a wall, and between its lines; metres.
const HIGH_M: f64 = 2.6;
const APART_M: f64 = 1.3;
/// Half the edge of a stone, metres.
const STONE_M: f32 = 0.35;
/// So far beyond a portal one has walked through it, metres.
const BEYOND_M: f64 = 1.2;
/// Who has come no nearer for so long gives up, seconds: what is beyond a shut wall may still come.
const PATIENCE_S: f64 = 20.0;
/// What counts as nearer, metres.
const NEARER_M: f64 = 0.1;

/// Where a click on a wall leads.
#[derive(Resource, Default)]
struct WalkThrough(Option<Way>);

struct Way {
    to: DVec2,
    /// The least that was left of it, metres, and for how long it has been no less.
    least_m: f64,
    for_s: f64,
}

/// Has clicks on walls walk through.
pub(super) fn add_clicks(app: &mut App) {
    app.init_resource::<WalkThrough>()
        .add_systems(Update, click.run_if(is_shown))
        .add_systems(Update, walk_through.after(WalkerSystems::Input).before(WalkerSystems::Move));
}

pub(super) fn colour(colour: Color32, alpha: f32) -> Color {
    Color::srgba_u8(colour.r(), colour.g(), colour.b(), (alpha * 255.0) as u8)
}

pub(super) fn draw(
    mut gizmos: Gizmos<'_, '_>,
    streamed: Streamed<'_>,
    open: Res<OpenCells>,
    origin: Res<WorldOrigin>,
    ground: Ground<'_>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
) {
    let Some(index) = streamed.index() else { return };
    let Some((eye, current)) = viewers.iter().next() else { return };
    let z_at = |pos: DVec2| ground.at(pos, eye.ground_m);
    let pending = streamed.pending().filter_map(|what| if let What::Packet { cell, .. } = what { index.cell(cell) } else { None });
    for entry in pending {
        let middle = entry.outline.centroid();
        let at = origin.world_from_plan(middle, z_at(middle)) + Vec3::Y * STONE_M;
        gizmos.cube(Transform::from_translation(at).with_scale(Vec3::splat(2.0 * STONE_M)), colour(PENDING, 1.0));
        gizmos.line(at, at + Vec3::Y * 30.0, colour(PENDING, 0.4));
    }
    let Some(here) = current.and_then(|current| current.0) else { return };
    for portal in index.portals(here) {
        let ink = match portal.other(here) {
            None => EDGE,
            Some(beyond) if open.lead(here, beyond) => OPEN,
            Some(_) => SHUT,
        };
        let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
        let corner = |pos: DVec2, high_m: f64| origin.world_from_plan(pos, z_at(pos) + high_m);
        let (low, high) = (0.05, HIGH_M);
        gizmos.lineloop([corner(a, low), corner(b, low), corner(b, high), corner(a, high)], colour(ink, 0.9));
        let bars = (a.distance(b) / APART_M).ceil().max(1.0);
        for n in 1..bars as u32 {
            let pos = a.lerp(b, f64::from(n) / bars);
            gizmos.line(corner(pos, low), corner(pos, high), colour(ink, 0.35));
        }
    }
}

/// A click on a wall.
fn click(
    (buttons, taken): (Res<ButtonInput<MouseButton>>, Res<PointersTaken>),
    windows: Query<&Window, With<PrimaryWindow>>,
    cameras: Query<(&Camera, &GlobalTransform)>,
    streamed: Streamed<'_>,
    origin: Res<WorldOrigin>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
    mut expert: ResMut<Expert>,
    mut jumps: MessageWriter<JumpTo>,
    mut through: ResMut<WalkThrough>,
) {
    if let (Some(pos), Some((eye, _))) = (expert.leap.take(), viewers.iter().next()) {
        jumps.write(JumpTo(Viewpoint { pos, heading_deg: eye.heading_deg, ..Viewpoint::default() }));
    }
    if !buttons.just_pressed(MouseButton::Left) || taken.mouse {
        return;
    }
    let (Some(index), Ok(window), Some((eye, current))) = (streamed.index(), windows.single(), viewers.iter().next()) else {
        return;
    };
    let Some(here) = current.and_then(|current| current.0) else { return };
    let ray = window
        .cursor_position()
        .and_then(|at| cameras.iter().find_map(|(camera, transform)| camera.viewport_to_world(transform, at).ok()));
    let Some(ray) = ray else { return };
    let (from, _) = origin.plan_from_world(ray.origin);
    let (to, _) = origin.plan_from_world(ray.origin + *ray.direction);
    let hits = index.portals(here).filter(|portal| !portal.is_blind()).filter_map(|portal| {
        let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
        let (way, along) = portal.meets(from, to - from)?;
        let height_m = f64::from(ray.origin.y + ray.direction.y * way as f32) - eye.ground_m;
        // The cell lies to the left of the way from end to end if it is the portal's own.
        let out = if portal.cell == here { -(b - a).perp() } else { (b - a).perp() };
        let target = a.lerp(b, along.clamp(0.1, 0.9)) + out.normalize_or_zero() * BEYOND_M;
        (-0.5..HIGH_M + 0.5).contains(&height_m).then_some((way, target))
    });
    if let Some((_, target)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) {
        through.0 = Some(Way { to: target, least_m: f64::INFINITY, for_s: 0.0 });
    }
}

/// Walks on through a wall that was clicked, until the visitor moves or is through.
fn walk_through(
    time: Res<Time>,
    mut through: ResMut<WalkThrough>,
    mut intent: ResMut<Intent>,
    mut viewers: Query<(&mut Eye, &Gait), (With<Viewer>, With<Walker>)>,
) {
    let Some(way) = &mut through.0 else { return };
    let Some((mut eye, gait)) = viewers.iter_mut().next() else { return };
    if gait.is_examining() || gait.is_landing() {
        // Whoever goes round a point comes down to the street first.
        intent.toggle_examine |= gait.is_examining();
        return;
    }
    let ahead = way.to - eye.plan_pos;
    if ahead.length() < way.least_m - NEARER_M {
        (way.least_m, way.for_s) = (ahead.length(), 0.0);
    }
    way.for_s += time.delta_secs_f64();
    if intent.is_moving() || ahead.length() < 0.3 || way.for_s > PATIENCE_S {
        through.0 = None;
        return;
    }
    let heading = ahead.x.atan2(ahead.y).to_degrees();
    let turn = (heading - eye.heading_deg + 540.0).rem_euclid(360.0) - 180.0;
    eye.heading_deg += turn * (1.0 - (-6.0 * time.delta_secs_f64()).exp());
    if turn.abs() < 30.0 {
        intent.go.y = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::asset::AssetPlugin;
    use bevy::camera::{CameraProjection, RenderTargetInfo};
    use bevy::input::mouse::MouseButtonInput;
    use bevy::input::{ButtonState, InputPlugin};
    use bevy::time::TimeUpdateStrategy;
    use veduta::buildings::{Building, BuildingsPlugin};
    use veduta::streaming::Fetching;
    use veduta::walker::{Jump, SolidCells};
    use veduta_bake::{BakeSettings, bake};
    use veduta_store::{CityIndex, DirReader, read_index};

    use super::*;

    const SIZE: UVec2 = UVec2::new(1280, 720);

    /// A visitor who has arrived in a city, with keys and a mouse, a camera and a window.
    struct Visit {
        app: App,
        walker: Entity,
        window: Entity,
        index: CityIndex,
    }

    impl Visit {
        fn begin(city: &std::path::Path) -> Self {
            let mut app = App::new();
            app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin, InputPlugin))
                .init_asset::<Mesh>()
                .add_plugins((
                    veduta::ecs::EcsPlugin,
                    StreamingPlugin { fetching: Fetching::Inline },
                    BuildingsPlugin { building: Building::Inline },
                    WalkerPlugin::default(),
                ))
                .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(33)))
                .insert_resource(OpenCity(city.display().to_string()))
                .insert_resource(Expert { is_shown: true, is_aloft: false, reach_m: 200.0, leap: None });
            add_clicks(&mut app);
            let window = app.world_mut().spawn((Window { resolution: SIZE.into(), ..default() }, PrimaryWindow)).id();
            let mut lens = PerspectiveProjection { fov: Eye::default().fov_deg.to_radians() as f32, ..default() };
            lens.update(SIZE.x as f32, SIZE.y as f32);
            let mut camera = Camera::default();
            camera.computed.clip_from_view = lens.get_clip_from_view();
            camera.computed.target_info = Some(RenderTargetInfo { physical_size: SIZE, scale_factor: 1.0 });
            let walker = app.world_mut().spawn((camera, Walker, Transform::default())).id();
            app.finish();
            app.cleanup();
            let index = read_index(&DirReader::new(city).expect("a city")).expect("whole");
            let mut visit = Self { app, walker, window, index };
            visit.until("arrived", |visit| {
                let world = visit.app.world();
                !world.resource::<SolidCells>().is_empty() && *world.resource::<Jump>() == Jump::None
            });
            visit
        }

        fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
            for _ in 0..1_500 {
                self.app.update();
                if holds(self) {
                    return;
                }
            }
            panic!("still not {what}: {:?} {:?}", self.eye(), self.cell());
        }

        fn eye(&self) -> Eye {
            *self.app.world().get::<Eye>(self.walker).expect("a walker has one")
        }

        fn gait(&self) -> Gait {
            *self.app.world().get::<Gait>(self.walker).expect("a walker has one")
        }

        fn cell(&self) -> u32 {
            self.app.world().get::<CurrentCell>(self.walker).and_then(|current| current.0).expect("in a cell")
        }

        /// Holds keys for so many frames.
        fn hold(&mut self, keys: &[KeyCode], frames: usize) {
            keys.iter().for_each(|&key| self.app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(key));
            (0..frames).for_each(|_| self.app.update());
            keys.iter().for_each(|&key| self.app.world_mut().resource_mut::<ButtonInput<KeyCode>>().release(key));
            self.app.update();
        }

        /// A wall that one sees and that no other stands before: where in the window, and the cell beyond.
        fn wall(&self) -> Option<(Vec2, u32)> {
            let (world, eye, here) = (self.app.world(), self.eye(), self.cell());
            let (camera, transform) = (world.get::<Camera>(self.walker)?, world.get::<GlobalTransform>(self.walker)?);
            let walls = || self.index.portals(here).filter(|portal| !portal.is_blind());
            walls().find_map(|portal| {
                let middle = portal.ends.0.to_metres().midpoint(portal.ends.1.to_metres());
                let at = world.resource::<WorldOrigin>().world_from_plan(middle, eye.ground_m + HIGH_M / 2.0);
                let pixel = camera.world_to_viewport(transform, at).ok()?;
                let is_seen = Rect::from_corners(Vec2::ZERO, SIZE.as_vec2()).contains(pixel);
                let way = middle - eye.plan_pos;
                let is_first = walls().all(|other| other.meets(eye.plan_pos, way).is_none_or(|(share, _)| share > 0.999));
                (is_seen && is_first).then_some((pixel, portal.other(here)?))
            })
        }

        fn click(&mut self, at: Vec2) {
            self.app.world_mut().get_mut::<Window>(self.window).expect("spawned").set_cursor_position(Some(at));
            for state in [ButtonState::Pressed, ButtonState::Released] {
                let click = MouseButtonInput { button: MouseButton::Left, state, window: self.window };
                self.app.world_mut().write_message(click);
                self.app.update();
            }
        }
    }

    /// Clicks on a wall that is seen, and waits until one has walked through.
    fn walks_through(visit: &mut Visit) {
        let (pixel, beyond) = visit.wall().expect("a wall is seen");
        visit.click(pixel);
        visit.until("through", |visit| visit.cell() == beyond && !visit.gait().is_landing());
        assert!(!visit.gait().is_examining(), "one walks through on foot");
        visit.until("at rest", |visit| visit.app.world().resource::<WalkThrough>().0.is_none());
        assert_eq!(visit.cell(), beyond);
    }

    #[test]
    fn a_click_on_a_wall_walks_through_it_from_what_is_examined_too() {
        let city = std::env::temp_dir().join(format!("veduta-walls-{}.city", std::process::id()));
        let place = crate::cities::project_root().join("plugins/bake/tests/places/riverside/riverside.graph.ron");
        bake(&place, &city, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        let mut visit = Visit::begin(&city);
        visit.app.world_mut().resource_mut::<PointersTaken>().mouse = true;
        visit.click(visit.wall().expect("a wall is seen").0);
        assert!(visit.app.world().resource::<WalkThrough>().0.is_none(), "a click on a window means no wall behind it");
        visit.app.world_mut().resource_mut::<PointersTaken>().mouse = false;
        walks_through(&mut visit);
        visit.hold(&[KeyCode::KeyO], 1);
        visit.hold(&[KeyCode::ArrowDown, KeyCode::KeyS], 40);
        assert!(visit.gait().is_examining() && visit.eye().eye_m > 3.0, "{:?}", visit.eye());
        let from = visit.eye().plan_pos;
        walks_through(&mut visit);
        let eye = visit.eye();
        assert!(eye.plan_pos.distance(from) > 50.0, "however far it was: {eye:?}");
        assert!((1.4..1.9).contains(&eye.eye_m), "it stands in the street: {eye:?}");
        let _ = std::fs::remove_dir_all(city);
    }
}
