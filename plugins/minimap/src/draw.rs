use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{
    self, Align2, Color32, Context, FontId, Id, Order, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Vec2 as EguiVec2,
    WidgetInfo, WidgetType,
};
use veduta_cartography::{Colours, Inks};
use veduta_city::Viewpoint;
use veduta_controls::{KeyNames, Layers};
use veduta_ecs::{City, Docks, Eye, Interface, JumpTo, Route, TourPath, Viewer, WalkTo, Words};
use veduta_ui::Look;

use crate::controls::{MapOpen, PAGE};
use crate::panel::map_panel;
use crate::tiles::{Fill, MapTiles, colour};
use crate::view::{MapView, Projection, zoomed};
use crate::{ExportMap, MapNames, MinimapSettings, Trail};

/// What is drawn besides the plan.
struct Shown<'a> {
    city: &'a City,
    tiles: &'a MapTiles,
    eye: &'a Eye,
    route: &'a Route,
    marked: Option<DVec2>,
    words: &'a Words,
    keys: &'a KeyNames,
    trail: &'a Trail,
    tour: &'a TourPath,
    settings: MinimapSettings,
    colours: Colours,
}

impl Shown<'_> {
    fn inks(&self) -> &'static Inks {
        self.colours.inks()
    }
}

/// Draws the map in the corner, or the large one.
pub(crate) fn draw_map(
    mut contexts: EguiContexts,
    city: Option<Res<City>>,
    tiles: Res<MapTiles>,
    viewers: Query<&Eye, With<Viewer>>,
    (route, words, interface): (Res<Route>, Res<Words>, Res<Interface>),
    (trail, tour, keys, docks, layers): (Res<Trail>, Res<TourPath>, Res<KeyNames>, Res<Docks>, Res<Layers>),
    mut settings: ResMut<MinimapSettings>,
    mut view: ResMut<MapView>,
    mut names: ResMut<MapNames>,
    (mut jumps, mut walks): (MessageWriter<JumpTo>, MessageWriter<WalkTo>),
    mut exports: MessageWriter<ExportMap>,
) -> Result {
    let (Some(city), Some(eye)) = (city, viewers.iter().next()) else { return Ok(()) };
    if !settings.visible && !view.open {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let shown = Shown {
        city: &city,
        tiles: &tiles,
        eye,
        route: &route,
        marked: view.marked,
        words: &words,
        keys: &keys,
        trail: &trail,
        tour: &tour,
        settings: *settings,
        colours: Colours::chosen(interface.high_contrast, settings.colour_blind_safe),
    };
    // What is laid out is no change that others look for.
    let names = names.bypass_change_detection();
    if view.open {
        let click = large_map(context, &look, &shown, &mut view, names);
        let mut next = *settings;
        // What lies over the map lies over its panel.
        if layers.page() == Some(PAGE)
            && let Some(format) = map_panel(context, &look, &words, &mut next)
        {
            let map = Projection::new(context.content_rect(), view.middle.unwrap_or(eye.plan_pos), view.radius_m, 0.0);
            let size = map.rect.size() / map.scale;
            exports.write(ExportMap {
                format,
                middle: map.middle(),
                size_m: DVec2::new(size.x.into(), size.y.into()),
                up_deg: 0.0,
                layers: next.layers(),
                colours: shown.colours,
            });
        }
        settings.set_if_neq(next);
        match click {
            Some(Click { to, walks: false }) => drop(jumps.write(JumpTo(to))),
            Some(Click { to, walks: true }) => {
                let name = nearest_name(&city, to.pos).unwrap_or_default();
                walks.write(WalkTo { name, to });
            }
            None => {}
        }
    } else if !view.is_covered {
        // Where docks leave little, at the upper edge: the lower one has the bar and captions.
        let is_at_top = settings.top || *docks != Docks::default();
        corner_map(context, Look::free(&docks, context), is_at_top, &shown, &mut settings, &mut view, names);
    }
    Ok(())
}

fn corner_map(
    context: &Context,
    free: Rect,
    is_at_top: bool,
    shown: &Shown<'_>,
    settings: &mut ResMut<'_, MinimapSettings>,
    view: &mut MapView,
    names: &mut MapNames,
) {
    let screen = context.content_rect();
    let edge = (screen.height() * settings.share).clamp(120.0, 900.0);
    let margin = edge * 0.06;
    let corner = egui::pos2(
        if settings.left { free.left() + margin } else { free.right() - edge - margin },
        if is_at_top { free.top() + margin } else { free.bottom() - edge - margin },
    );
    egui::Area::new(Id::new("veduta minimap")).fixed_pos(corner).order(Order::Middle).show(context, |ui| {
        let (rect, response) = ui.allocate_exact_size(EguiVec2::splat(edge), Sense::click());
        let name = shown.words.say("map-open");
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
        if response.hovered() {
            let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            // Untouched, nothing has changed.
            if wheel != 0.0 || pinch != 1.0 {
                settings.radius_m = zoomed(settings.radius_m, (-wheel / 300.0).exp() / pinch);
            }
        }
        if response.on_hover_text(format!("{name} ({})", shown.keys.said::<MapOpen>(shown.words))).clicked() {
            view.open = true;
            view.middle = None;
            view.radius_m = view.radius_m.max(settings.radius_m * 2.0);
        }
        let up = if settings.north_up { 0.0 } else { shown.eye.heading_deg };
        let map = Projection::new(rect, shown.eye.plan_pos, settings.radius_m, up);
        paint(&ui.painter().with_clip_rect(rect), &map, shown, edge / 18.0, names, false);
        ui.painter().rect_stroke(rect, 4.0, Stroke::new(2.0, colour(shown.inks().stone)), StrokeKind::Middle);
    });
}

/// Where a click on the large map leads, and whether on foot.
struct Click {
    to: Viewpoint,
    walks: bool,
}

fn large_map(context: &Context, look: &Look, shown: &Shown<'_>, view: &mut MapView, names: &mut MapNames) -> Option<Click> {
    let screen = context.content_rect();
    let eye = shown.eye;
    let mut click = None;
    egui::Area::new(Id::new("veduta map")).fixed_pos(screen.min).order(Order::Foreground).show(context, |ui| {
        let (rect, response) = ui.allocate_exact_size(screen.size(), Sense::click_and_drag());
        let map = Projection::new(rect, view.middle.unwrap_or(eye.plan_pos), view.radius_m, 0.0);
        let text = (look.text * 1.0).clamp(10.0, 60.0);
        let pointer = response.interact_pointer_pos();
        // Who takes hold of himself is carried; who takes hold of the map moves it.
        if response.drag_started() {
            let held = ui.input(|i| i.pointer.press_origin()).is_some_and(|at| at.distance(map.screen(eye.plan_pos)) < text * 1.2);
            view.carries = held;
        }
        if view.carries && response.drag_stopped() {
            view.carries = false;
            if let Some(at) = pointer {
                click = Some(Click { to: target(shown.city, map.plan(at), f64::from(14.0 / map.scale), eye), walks: false });
                view.open = false;
            }
        }
        if response.dragged() && !view.carries {
            let d = response.drag_delta() / map.scale;
            view.middle = Some(map.middle() - DVec2::new(f64::from(d.x), f64::from(-d.y)));
        }
        let (wheel, pinch, walks) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta(), i.modifiers.shift));
        if wheel != 0.0 || pinch != 1.0 {
            view.radius_m = zoomed(view.radius_m, (-wheel / 300.0).exp() / pinch);
        }
        paint(ui.painter(), &map, shown, text, names, true);
        if let Some(at) = pointer.filter(|_| view.carries) {
            carried(ui.painter(), &map, shown, look, at, text);
        }
        title(ui.painter(), rect, look, shown);
        if response.clicked()
            && let Some(at) = pointer
        {
            click = Some(Click { to: target(shown.city, map.plan(at), f64::from(14.0 / map.scale), eye), walks });
            view.open = false;
        }
    });
    click
}

/// Where a click leads: to the place under it, else to the nearest street, else right there.
fn target(city: &City, at: DVec2, reach_m: f64, eye: &Eye) -> Viewpoint {
    let near = city.overviews.places().map(|p| (DVec2::new(p.pos.x, p.pos.y).distance(at), p)).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((d, place)) = near
        && d <= reach_m
        && let Some(view) = place.view
    {
        return view;
    }
    let spot = nearest_on_street(city, at).filter(|p| p.distance(at) < 40.0).unwrap_or(at);
    Viewpoint { pos: [spot.x, spot.y].into(), heading_deg: eye.heading_deg, ..Viewpoint::default() }
}

fn nearest_on_street(city: &City, at: DVec2) -> Option<DVec2> {
    let streets = city.overviews.iter().flat_map(|(_, overview)| &overview.streets).filter(|s| s.walkable);
    let pieces = streets.flat_map(|s| s.line.windows(2).map(|w| [w[0], w[1]].map(|p| p.to_metres())));
    pieces
        .map(|[a, b]| {
            let (a, b) = (DVec2::new(a.x, a.y), DVec2::new(b.x, b.y));
            let t = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
            a.lerp(b, t)
        })
        .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)))
}

/// Name of what is nearest to a spot: a place, else a street.
fn nearest_name(city: &City, at: DVec2) -> Option<String> {
    let place = city.overviews.places().filter(|p| p.pos.distance(at) < p.radius_m).min_by(|a, b| {
        let away = |p: &veduta_city::Place| p.pos.distance_squared(at);
        away(a).total_cmp(&away(b))
    });
    let streets = city.overviews.iter().flat_map(|(_, overview)| &overview.streets).filter(|s| s.walkable && !s.name.is_empty());
    let street = || {
        let away = |s: &veduta_city::PlanStreet| {
            s.line.iter().map(|p| p.to_metres().distance_squared(at)).min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
        };
        streets.min_by(|a, b| away(a).total_cmp(&away(b))).map(|s| s.name.to_string())
    };
    place.map(|p| p.name.clone()).or_else(street)
}

/// Where somebody will stand who is carried over the map: himself, where he comes down, and what that is called.
fn carried(painter: &Painter, map: &Projection, shown: &Shown<'_>, look: &Look, at: Pos2, text: f32) {
    let to = target(shown.city, map.plan(at), f64::from(14.0 / map.scale), shown.eye);
    let foot = map.screen(to.pos);
    let inks = shown.inks();
    painter.add(Shape::line(vec![at, foot], Stroke::new(text * 0.12, colour(inks.trail))));
    marker(painter, map, &Eye { plan_pos: to.pos, heading_deg: to.heading_deg, ..*shown.eye }, text, inks);
    if let Some(name) = nearest_name(shown.city, to.pos) {
        let galley = painter.layout_no_wrap(name, FontId::proportional(look.text), colour(inks.name));
        let corner = foot + EguiVec2::new(text * 1.2, -galley.size().y / 2.0);
        let rect = Rect::from_min_size(corner, galley.size()).expand(text * 0.25);
        painter.rect(rect, 3.0, colour(inks.halo), Stroke::new(1.0, colour(inks.stone)), StrokeKind::Outside);
        painter.galley(corner, galley, colour(inks.name));
    }
}

fn title(painter: &Painter, rect: Rect, look: &Look, shown: &Shown<'_>) {
    let ink = colour(shown.inks().name);
    let (inset, text) = (look.text * 0.9, look.text);
    // Beside the compass.
    let at = rect.left_top() + EguiVec2::new(inset * 3.6, inset);
    painter.text(at, Align2::LEFT_TOP, &shown.city.name, FontId::proportional(text * 1.7), ink);
    let at = rect.left_bottom() + EguiVec2::new(inset, -inset);
    let hint = shown.words.say_with("map-hint", &[("key", shown.keys.said::<MapOpen>(shown.words).into())]);
    painter.text(at, Align2::LEFT_BOTTOM, hint, FontId::proportional(text), ink);
    let at = rect.right_bottom() - EguiVec2::splat(inset);
    painter.text(at, Align2::RIGHT_BOTTOM, &shown.city.attribution, FontId::proportional(text * 0.8), ink);
}

fn paint(painter: &Painter, map: &Projection, shown: &Shown<'_>, text: f32, names: &mut MapNames, is_large: bool) {
    let inks = shown.inks();
    painter.rect_filled(map.rect, 4.0, colour(inks.yard));
    let palette = Fill::palette(inks);
    for tile in shown.tiles.near(map.middle().as_vec2(), map.reach_m()) {
        let vertices = tile.points.iter().zip(&tile.fills).map(|(&[x, y], &fill)| egui::epaint::Vertex {
            pos: map.screen(DVec2::new(f64::from(x), f64::from(y))),
            uv: egui::epaint::WHITE_UV,
            color: palette[fill as usize],
        });
        let mesh = egui::Mesh { vertices: vertices.collect(), indices: tile.indices.clone(), ..egui::Mesh::default() };
        painter.add(Shape::mesh(mesh));
    }
    let Shown { settings, .. } = shown;
    if settings.tour {
        shown.tour.0.iter().for_each(|line| dashed(painter, map, line, colour(inks.tour), text * 0.22, text * 0.9));
    }
    if settings.trail {
        shown.trail.0.iter().for_each(|line| dashed(painter, map, line, colour(inks.trail), text * 0.2, text * 0.35));
    }
    if settings.route {
        route(painter, map, shown.route, text, inks);
    }
    names.draw(is_large, painter, map, text, settings.layers(), shown.colours);
    if let Some(spot) = shown.marked {
        pin(painter, map.screen(spot), text, inks);
    }
    marker(painter, map, shown.eye, text, inks);
    compass(painter, map, text, inks);
}

/// A line of dashes.
fn dashed(painter: &Painter, map: &Projection, line: &[DVec2], colour: Color32, width: f32, dash: f32) {
    let near = map.rect.expand(map.rect.width());
    // What lies far off the map is not cut into dashes.
    for part in line.split(|&p| !near.contains(map.screen(p))).filter(|part| part.len() > 1) {
        let points: Vec<Pos2> = part.iter().map(|&p| map.screen(p)).collect();
        painter.extend(Shape::dashed_line(&points, Stroke::new(width, colour), dash, dash * 0.8));
    }
}

/// The way that the visitor is led, with its end.
fn route(painter: &Painter, map: &Projection, route: &Route, size: f32, inks: &Inks) {
    let (Some(&end), true) = (route.way.last(), route.way.len() > 1) else { return };
    let points: Vec<Pos2> = route.way.iter().map(|&p| map.screen(p)).collect();
    painter.add(Shape::line(points.clone(), Stroke::new(size * 0.5, colour(inks.halo).gamma_multiply(0.82))));
    painter.add(Shape::line(points, Stroke::new(size * 0.28, colour(inks.led))));
    pin(painter, map.screen(end), size, inks);
}

/// A pin that stands on a spot.
fn pin(painter: &Painter, foot: Pos2, size: f32, inks: &Inks) {
    let (led, halo) = (colour(inks.led), colour(inks.halo));
    let head = foot - EguiVec2::new(0.0, size * 1.5);
    let side = EguiVec2::new(size * 0.5, -size * 0.25);
    let tip = vec![foot, head + EguiVec2::new(-side.x, -side.y), head + EguiVec2::new(side.x, -side.y)];
    painter.add(Shape::convex_polygon(tip, led, Stroke::NONE));
    painter.circle(head, size * 0.62, led, Stroke::new(size * 0.1, halo));
    painter.circle_filled(head, size * 0.22, halo);
}

/// The walker: a dot with a cone of view.
fn marker(painter: &Painter, map: &Projection, eye: &Eye, size: f32, inks: &Inks) {
    let you = colour(inks.trail);
    let at = map.screen(eye.plan_pos);
    let ahead = eye.heading_deg.to_radians() as f32 - map.up;
    let half = (eye.fov_deg.to_radians() as f32 * 0.75).min(1.2);
    let ray = |angle: f32| at + EguiVec2::new(angle.sin(), -angle.cos()) * size * 2.6;
    let cone: Vec<Pos2> = core::iter::once(at).chain((0..=8).map(|i| ray(ahead - half + half * i as f32 / 4.0))).collect();
    painter.add(Shape::convex_polygon(cone, you.gamma_multiply(0.28), Stroke::NONE));
    painter.circle(at, size * 0.42, you, Stroke::new(size * 0.12, colour(inks.halo)));
}

fn compass(painter: &Painter, map: &Projection, size: f32, inks: &Inks) {
    let at = map.rect.left_top() + EguiVec2::splat(size * 1.4);
    let (sin, cos) = map.up.sin_cos();
    let north = EguiVec2::new(-sin, -cos);
    let side = EguiVec2::new(-north.y, north.x);
    let tip = |along: f32, across: f32| at + north * size * along + side * size * across;
    painter.circle_filled(at, size * 1.05, colour(inks.halo).gamma_multiply(0.8));
    let red = colour(inks.sight);
    painter.add(Shape::convex_polygon(vec![tip(0.9, 0.0), tip(0.0, 0.3), tip(0.0, -0.3)], red, Stroke::NONE));
    let grey = colour(inks.stone);
    painter.add(Shape::convex_polygon(vec![tip(-0.9, 0.0), tip(0.0, -0.3), tip(0.0, 0.3)], grey, Stroke::NONE));
}
