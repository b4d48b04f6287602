use bevy::ecs::system::SystemParam;
use bevy::input::ButtonState;
use bevy::input::mouse::MouseButtonInput;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Area, Id as EguiId, Label, Order, TextWrapMode, pos2};
use veduta_city::{GridPos, Massing, Place, PlaceKind, Viewpoint};
use veduta_controls::Tap;
use veduta_ecs::{City, Eye, Interface, PointersTaken, Sight, Sights, Steering, Viewer, WalkTo, Words, WorldOrigin};
use veduta_ui::{Look, Surface};

use crate::near::{Pin, heading_to};
use crate::{CityGuide, Lead};

/// What can be pointed at in the picture. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct PickSettings {
    /// Whether a click on something that the guide knows tells of it.
    pub tells: bool,
    /// Whether a click on the ground leads there.
    pub leads: bool,
    /// So far things can be pointed at, metres.
    pub reach_m: f64,
}

impl Default for PickSettings {
    fn default() -> Self {
        Self { tells: true, leads: true, reach_m: 220.0 }
    }
}

/// What lies under the pointer.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub enum Pointed {
    /// Nothing.
    #[default]
    Nothing,
    /// Something that has a name.
    Place(Place),
    /// The ground, plan metres.
    Ground(DVec2),
}

/// The place that a house, or a spot of it, belongs to: what stands in it, else what is so near that it is meant.
fn place_of<'a>(places: impl Iterator<Item = &'a Place>, house: &Massing, at: DVec2) -> Option<&'a Place> {
    let is_thing = |place: &&Place| !matches!(place.kind, PlaceKind::Street | PlaceKind::Square | PlaceKind::Viewpoint);
    let off = |place: &&'a Place| {
        let inside = house.outline.contains(GridPos::from_metres(place.pos));
        if inside { 0.0 } else { place.pos.distance(at) / (place.radius_m * 0.5).clamp(4.0, 20.0) }
    };
    let nearest = places.filter(is_thing).map(|place| (off(&place), place)).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.filter(|(off, _)| *off <= 1.0).map(|(_, place)| place)
}

/// Looks so often a second at what lies under the pointer.
const LOOKS_HZ: f64 = 10.0;

/// What can be seen at a point of the window.
#[derive(SystemParam)]
pub(crate) struct Picking<'w, 's> {
    city: Option<Res<'w, City>>,
    origin: Res<'w, WorldOrigin>,
    settings: Res<'w, PickSettings>,
    sights: Sights<'w>,
    cameras: Query<'w, 's, (&'static Camera, &'static GlobalTransform, &'static Eye), With<Viewer>>,
}

impl Picking<'_, '_> {
    /// What lies under a point of the window, logical pixels.
    fn at(&self, at: Vec2) -> Pointed {
        let ray =
            self.cameras.iter().find_map(|(camera, transform, eye)| Some((camera.viewport_to_world(transform, at).ok()?, eye)));
        let (Some((ray, eye)), Some(city)) = (ray, &self.city) else { return Pointed::Nothing };
        let plan = |world: Vec3| {
            let (pos, z_m) = self.origin.plan_from_world(world);
            pos.extend(z_m)
        };
        let from = plan(ray.origin);
        let way = plan(ray.origin + *ray.direction) - from;
        match self.sights.along(from, way, self.settings.reach_m, eye.ground_m) {
            Some(Sight { house: Some(house), at, .. }) => place_of(city.overviews.places(), house, at.truncate())
                .map_or(Pointed::Nothing, |place| Pointed::Place(place.clone())),
            Some(Sight { house: None, at, .. }) => Pointed::Ground(at.truncate()),
            None => Pointed::Nothing,
        }
    }
}

/// Looks at what lies under the pointer.
pub(crate) fn point(
    time: Res<Time<Real>>,
    picking: Picking<'_, '_>,
    taken: Res<PointersTaken>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut since_s: Local<f64>,
    mut pointed: ResMut<Pointed>,
) {
    *since_s += time.delta_secs_f64();
    if *since_s < 1.0 / LOOKS_HZ {
        return;
    }
    *since_s = 0.0;
    let cursor = windows.single().ok().and_then(Window::cursor_position).filter(|_| !taken.mouse);
    pointed.set_if_neq(cursor.map_or(Pointed::Nothing, |at| picking.at(at)));
}

/// A press and a release so near each other, points, and so soon, seconds, are a click.
const CLICK: (f32, f64) = (6.0, 0.6);

/// A click, or a tap, tells of what has a name, and leads over the ground.
pub(crate) fn click(
    time: Res<Time<Real>>,
    mut buttons: MessageReader<MouseButtonInput>,
    mut taps: MessageReader<Tap>,
    windows: Query<&Window, With<PrimaryWindow>>,
    viewers: Query<&Eye, With<Viewer>>,
    (picking, taken, steering): (Picking<'_, '_>, Res<PointersTaken>, Res<Steering>),
    mut pressed: Local<Option<(Vec2, f64, Pointed)>>,
    mut pin: ResMut<Pin>,
    mut walks: MessageWriter<WalkTo>,
) {
    let at = windows.single().ok().and_then(Window::cursor_position);
    // A finger does not hover: what lies under it is looked for when it taps.
    let mut meant: Vec<Pointed> = taps.read().map(|tap| picking.at(tap.at)).collect();
    for event in buttons.read().filter(|event| event.button == MouseButton::Left) {
        let Some(at) = at else { continue };
        if event.state == ButtonState::Pressed {
            // Looked for anew: what was pointed at of late may lie elsewhere than where the pointer has come to.
            *pressed = (!taken.mouse).then(|| (at, time.elapsed_secs_f64(), picking.at(at)));
            continue;
        }
        let Some((from, since_s, what)) = pressed.take() else { continue };
        if from.distance(at) <= CLICK.0 && time.elapsed_secs_f64() - since_s <= CLICK.1 {
            meant.push(what);
        }
    }
    let (Some(eye), Some(what)) = (viewers.iter().next(), meant.pop()) else { return };
    let settings = &picking.settings;
    match what {
        Pointed::Place(place) if settings.tells => *pin = Pin::here(place, eye.plan_pos),
        Pointed::Ground(to) if settings.leads && *steering != Steering::Guided && eye.eye_m <= veduta_route::WALK_EYE_M => {
            let to = Viewpoint { pos: to, heading_deg: heading_to(eye.plan_pos, to), ..Viewpoint::default() };
            walks.write(WalkTo { name: String::new(), to });
        }
        _ => {}
    }
}

/// Writes the name of what lies under the pointer beside it.
pub(crate) fn draw(
    mut contexts: EguiContexts,
    windows: Query<&Window, With<PrimaryWindow>>,
    (pointed, lead, steering): (Res<Pointed>, Res<Lead>, Res<Steering>),
    (guide, words, interface): (Res<CityGuide>, Res<Words>, Res<Interface>),
) -> Result {
    let Pointed::Place(place) = &*pointed else { return Ok(()) };
    let Some(at) = windows.single().ok().and_then(Window::cursor_position) else { return Ok(()) };
    if lead.is_under_way() || *steering != Steering::Visitor {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let corner = pos2(at.x + look.text, at.y + look.text * 0.6);
    Area::new(EguiId::new("veduta pointed")).fixed_pos(corner).order(Order::Tooltip).interactable(false).show(context, |ui| {
        look.frame(Surface::Dusk).show(ui, |ui| {
            let name = look.words(guide.name(&place.name, &words), 0.95, look.ink(Surface::Dusk));
            ui.add(Label::new(name).wrap_mode(TextWrapMode::Extend));
        });
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use bevy::camera::{CameraProjection, RenderTargetInfo};
    use bevy::input::InputPlugin;
    use veduta_city::{GridPolygon, Overview};
    use veduta_ecs::{Overviews, VedutaSystems};

    use super::*;

    fn house(x: i32, y: i32, half: i32, height_m: i32) -> Massing {
        let corner = |a: i32, b: i32| GridPos((x + a * half) * 1024, (y + b * half) * 1024);
        Massing::block(GridPolygon::simple(vec![corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)]), height_m * 1024)
    }

    /// A viewer on open ground who looks north and down, in a window that nothing is drawn into.
    fn outdoors() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, InputPlugin, veduta_ecs::EcsPlugin))
            .init_resource::<PickSettings>()
            .init_resource::<Pointed>()
            .init_resource::<Pin>()
            .add_message::<Tap>()
            .insert_resource(City { overviews: Overviews::whole(Overview::default()), ..City::default() })
            .add_systems(Update, click.after(VedutaSystems::Show));
        let eye = Eye { pitch_deg: -20.0, ..Eye::default() };
        let mut camera = Camera::default();
        let lens = PerspectiveProjection { fov: 55_f32.to_radians(), aspect_ratio: 16.0 / 9.0, ..default() };
        camera.computed.clip_from_view = lens.get_clip_from_view();
        camera.computed.target_info = Some(RenderTargetInfo { physical_size: UVec2::new(1280, 720), scale_factor: 1.0 });
        app.world_mut().spawn((camera, Transform::default(), Viewer, veduta_ecs::Footing::Own, eye));
        app.finish();
        app.cleanup();
        (0..3).for_each(|_| app.update());
        app
    }

    #[test]
    fn a_tap_on_the_ground_leads_there() {
        let mut app = outdoors();
        app.world_mut().write_message(Tap { at: Vec2::new(640.0, 360.0) });
        app.update();
        let walks: Vec<WalkTo> = app.world_mut().resource_mut::<Messages<WalkTo>>().drain().collect();
        let [walk] = walks.as_slice() else { panic!("one walk: {walks:?}") };
        let ahead_m = 1.65 / 20_f64.to_radians().tan();
        assert!(walk.to.pos.distance(DVec2::new(0.0, ahead_m)) < 0.05, "{walk:?}");
        app.world_mut().write_message(Tap { at: Vec2::new(640.0, 5.0) });
        app.update();
        assert!(app.world().resource::<Messages<WalkTo>>().is_empty(), "a tap into the sky leads nowhere");
    }

    #[test]
    fn a_click_means_what_lies_where_it_began_and_nothing_beneath_a_window() {
        let mut app = outdoors();
        let at = Vec2::new(640.0, 360.0);
        let mut window = Window { resolution: (1280, 720).into(), ..default() };
        window.set_cursor_position(Some(at));
        let window = app.world_mut().spawn((window, PrimaryWindow)).id();
        let mut click = |is_taken: bool, pointed: Pointed| {
            app.world_mut().resource_mut::<PointersTaken>().mouse = is_taken;
            app.insert_resource(pointed);
            for state in [ButtonState::Pressed, ButtonState::Released] {
                app.world_mut().write_message(MouseButtonInput { button: MouseButton::Left, state, window });
            }
            app.update();
            app.world_mut().resource_mut::<Messages<WalkTo>>().drain().map(|walk| walk.to.pos).collect::<Vec<_>>()
        };
        let elsewhere = Pointed::Ground(DVec2::new(90.0, 90.0));
        assert_eq!(click(true, elsewhere.clone()), [], "the pointer came over a window since it was last looked at");
        let walks = click(false, elsewhere);
        assert!(matches!(&walks[..], [to] if to.distance(DVec2::new(0.0, 4.53)) < 0.05), "{walks:?}");
    }

    #[test]
    fn a_house_tells_of_what_stands_in_it_or_close_by() {
        let place = |name: &str, x: f64, kind| Place { name: name.into(), pos: DVec2::new(x, 0.0), kind, ..Place::default() };
        let places = [
            place("Tower", 21.0, PlaceKind::Monument),
            place("Street", 20.0, PlaceKind::Street),
            place("Inn", 60.0, PlaceKind::House),
        ];
        let told =
            |x: i32| place_of(places.iter(), &house(x, 0, 5, 10), DVec2::new(f64::from(x) - 5.0, 0.0)).map(|p| p.name.as_str());
        assert_eq!(told(20), Some("Tower"));
        assert_eq!(told(66), Some("Inn"), "its sign stands a metre before the wall");
        assert_eq!(told(120), None);
    }
}
