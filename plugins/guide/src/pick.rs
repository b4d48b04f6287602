use bevy::input::ButtonState;
use bevy::input::mouse::MouseButtonInput;
use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Area, Id as EguiId, Label, Order, TextWrapMode, pos2};
use veduta_city::{GridPos, Massing, Place, PlaceKind, Viewpoint, metres};
use veduta_ecs::{Around, City, Eye, Ground, Interface, Steering, Viewer, WalkTo, Words, WorldOrigin};
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

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Met<'a> {
    House(&'a Massing, DVec2),
    Ground(DVec2),
}

/// Where a line of sight meets the wall or the roof of a house: metres of plan along it.
fn meets(house: &Massing, from: DVec3, way: DVec3, ground_m: f64) -> Option<f64> {
    let (a, d) = (from.truncate(), way.truncate());
    let top_m = ground_m + metres(house.height);
    let height_at = |t: f64| from.z + way.z * t;
    let mut first: Option<f64> = None;
    for ring in house.outline.rings() {
        for (n, p) in ring.iter().enumerate() {
            let (p, q) = (p.to_metres(), ring[(n + 1) % ring.len()].to_metres());
            let edge = q - p;
            let across = d.perp_dot(edge);
            if across.abs() < 1e-12 {
                continue;
            }
            let (t, u) = ((p - a).perp_dot(edge) / across, (p - a).perp_dot(d) / across);
            if t > 0.0 && (0.0..=1.0).contains(&u) && height_at(t) <= top_m && first.is_none_or(|first| t < first) {
                first = Some(t);
            }
        }
    }
    // From above, through the roof.
    if way.z < 0.0 {
        let t = (top_m - from.z) / way.z;
        if t > 0.0 && first.is_none_or(|first| t < first) && house.outline.contains(GridPos::from_metres(a + d * t)) {
            first = Some(t);
        }
    }
    first
}

/// What a line of sight meets first among houses and the ground, whose height is asked for.
fn meet<'a>(
    houses: impl Iterator<Item = &'a Massing>,
    from: DVec3,
    way: DVec3,
    reach_m: f64,
    ground_at: impl Fn(DVec2) -> f64,
) -> Option<Met<'a>> {
    let flat = way.truncate().length();
    let here_m = ground_at(from.truncate());
    let most = if flat > 1e-9 { reach_m / flat } else { f64::INFINITY };
    let walls = houses.filter_map(|house| meets(house, from, way, here_m).map(|t| (t, house)));
    let wall = walls.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(t, _)| *t <= most);
    let over = |t: f64| from.z + way.z * t - ground_at(from.truncate() + way.truncate() * t);
    let ground = first_below(most.min(reach_m / way.length().max(1e-9)), way.length(), over);
    let at = |t: f64| from.truncate() + way.truncate() * t;
    match (wall, ground) {
        (Some((t, house)), ground) if ground.is_none_or(|ground| t <= ground) => Some(Met::House(house, at(t))),
        (_, Some(ground)) => Some(Met::Ground(at(ground))),
        _ => None,
    }
}

/// Where a height over the ground, told along a line, first falls to nothing: in steps that grow with the distance, then by halves.
fn first_below(most: f64, pace: f64, over: impl Fn(f64) -> f64) -> Option<f64> {
    const HALVES: usize = 16;
    let mut t = 0.0;
    while t < most {
        let step = (0.5 + 0.04 * t * pace) / pace.max(1e-9);
        let next = (t + step).min(most);
        if over(next) <= 0.0 {
            let (mut above, mut below) = (t, next);
            for _ in 0..HALVES {
                let middle = (above + below) / 2.0;
                if over(middle) > 0.0 { above = middle } else { below = middle }
            }
            return Some(below);
        }
        t = next;
    }
    None
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

/// Looks at what lies under the pointer.
pub(crate) fn point(
    time: Res<Time<Real>>,
    mut contexts: EguiContexts,
    (city, origin, settings): (Option<Res<City>>, Res<WorldOrigin>, Res<PickSettings>),
    ground: Ground<'_>,
    windows: Query<&Window, With<PrimaryWindow>>,
    cameras: Query<(&Camera, &GlobalTransform, &Eye), With<Viewer>>,
    mut since_s: Local<f64>,
    mut pointed: ResMut<Pointed>,
) {
    *since_s += time.delta_secs_f64();
    if *since_s < 1.0 / LOOKS_HZ {
        return;
    }
    *since_s = 0.0;
    let cursor = windows.single().ok().and_then(Window::cursor_position);
    // By where the pointer is, not by where it was last moved: a panel may have opened under it.
    let is_over_panel = cursor.zip(contexts.ctx_mut().ok()).is_some_and(|(at, context)| {
        let layer = context.layer_id_at(pos2(at.x, at.y));
        context.egui_is_using_pointer() || layer.is_some_and(|layer| layer.order != Order::Background)
    });
    let ray = cursor.filter(|_| !is_over_panel).and_then(|at| {
        cameras.iter().find_map(|(camera, transform, eye)| Some((camera.viewport_to_world(transform, at).ok()?, eye)))
    });
    let (Some((ray, eye)), Some(city)) = (ray, city) else {
        pointed.set_if_neq(Pointed::Nothing);
        return;
    };
    let plan = |world: Vec3| {
        let (pos, z_m) = origin.plan_from_world(world);
        pos.extend(z_m)
    };
    let from = plan(ray.origin);
    let way = plan(ray.origin + *ray.direction) - from;
    let around = Around { middle: from.truncate(), radius_m: settings.reach_m };
    let reach_m = settings.reach_m;
    let is_near = |house: &&Massing| {
        house.outline.outer.first().is_some_and(|p| p.to_metres().distance_squared(from.truncate()) < (reach_m + 60.0).powi(2))
    };
    let houses = city.overviews.near(around).flat_map(|part| &part.houses).filter(is_near);
    let next = match meet(houses, from, way, reach_m, |pos| ground.at(pos, eye.ground_m)) {
        Some(Met::House(house, at)) => {
            place_of(city.overviews.places(), house, at).map_or(Pointed::Nothing, |place| Pointed::Place(place.clone()))
        }
        Some(Met::Ground(at)) => Pointed::Ground(at),
        None => Pointed::Nothing,
    };
    pointed.set_if_neq(next);
}

/// A press and a release so near each other, points, and so soon, seconds, are a click.
const CLICK: (f32, f64) = (6.0, 0.6);

/// A click tells of what has a name, and leads over the ground.
pub(crate) fn click(
    time: Res<Time<Real>>,
    mut buttons: MessageReader<MouseButtonInput>,
    windows: Query<&Window, With<PrimaryWindow>>,
    viewers: Query<&Eye, With<Viewer>>,
    (pointed, settings, steering): (Res<Pointed>, Res<PickSettings>, Res<Steering>),
    mut pressed: Local<Option<(Vec2, f64, Pointed)>>,
    mut pin: ResMut<Pin>,
    mut walks: MessageWriter<WalkTo>,
) {
    let at = windows.single().ok().and_then(Window::cursor_position);
    for event in buttons.read().filter(|event| event.button == MouseButton::Left) {
        let Some(at) = at else { continue };
        if event.state == ButtonState::Pressed {
            *pressed = Some((at, time.elapsed_secs_f64(), pointed.clone()));
            continue;
        }
        let Some((from, since_s, what)) = pressed.take() else { continue };
        if from.distance(at) > CLICK.0 || time.elapsed_secs_f64() - since_s > CLICK.1 {
            continue;
        }
        let Some(eye) = viewers.iter().next() else { continue };
        match what {
            Pointed::Place(place) if settings.tells => *pin = Pin::here(place, eye.plan_pos),
            Pointed::Ground(to) if settings.leads && *steering != Steering::Guided && eye.eye_m <= veduta_route::WALK_EYE_M => {
                let to = Viewpoint { pos: to, heading_deg: heading_to(eye.plan_pos, to), ..Viewpoint::default() };
                walks.write(WalkTo { name: String::new(), to });
            }
            _ => {}
        }
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
    use veduta_city::GridPolygon;

    use super::*;

    fn house(x: i32, y: i32, half: i32, height_m: i32) -> Massing {
        let corner = |a: i32, b: i32| GridPos((x + a * half) * 1024, (y + b * half) * 1024);
        Massing::block(GridPolygon::simple(vec![corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)]), height_m * 1024)
    }

    const EYE: DVec3 = DVec3::new(0.0, 0.0, 1.65);

    #[test]
    fn the_nearest_wall_roof_or_ground_is_met() {
        let town = [house(20, 0, 5, 10), house(40, 0, 5, 30)];
        let look = |way: DVec3| meet(town.iter(), EYE, way, 200.0, |_| 0.0);
        assert_eq!(look(DVec3::X), Some(Met::House(&town[0], DVec2::new(15.0, 0.0))));
        assert!(
            matches!(look(DVec3::new(1.0, 0.0, 0.6)), Some(Met::House(found, _)) if *found == town[1]),
            "over the first one's roof"
        );
        assert_eq!(look(DVec3::new(1.0, 0.0, 3.0)), None, "the sky");
        assert_eq!(look(DVec3::NEG_X), None, "nothing as far as it reaches");
        let Some(Met::Ground(at)) = look(DVec3::new(0.0, 1.0, -0.165)) else { panic!("the ground") };
        assert!(at.distance(DVec2::new(0.0, 10.0)) < 0.01, "{at}");
        let above = DVec3::new(20.0, 0.0, 60.0);
        let down = meet(town.iter(), above, DVec3::NEG_Z, 200.0, |_| 0.0);
        assert!(matches!(down, Some(Met::House(found, _)) if *found == town[0]), "its roof, from above");
    }

    #[test]
    fn on_a_slope_the_ground_is_where_it_is() {
        let slope = |pos: DVec2| pos.x * 0.1;
        let met = meet(core::iter::empty(), EYE, DVec3::new(1.0, 0.0, -0.1), 200.0, slope);
        let Some(Met::Ground(at)) = met else { panic!("the ground") };
        let over = EYE.z - 0.1 * at.x - slope(at);
        assert!(over.abs() < 0.01, "{over} m above it at {at}");
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
