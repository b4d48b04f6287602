use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::egui::{Pos2, Rect, Vec2 as EguiVec2};

use veduta_ecs::ShowOnMap;

/// State of the large map.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub struct MapView {
    /// Whether the large map is open.
    pub open: bool,
    /// Its middle in plan metres, once it has been dragged; else the walker's place.
    pub middle: Option<DVec2>,
    /// Metres from the middle to its nearer edge; 0 until opened.
    pub radius_m: f32,
    /// A spot that was asked to be shown, plan metres.
    pub marked: Option<DVec2>,
    /// Whether the visitor has taken hold of himself, to be put down elsewhere.
    pub carries: bool,
    /// Whether something else lies where the small map is; it is not drawn then. Kept by whoever lies there.
    pub is_covered: bool,
}

/// Opens the large map about a spot that is to be shown.
pub(crate) fn show_asked(mut asked: MessageReader<ShowOnMap>, mut view: ResMut<MapView>) {
    if let Some(spot) = asked.read().last() {
        let (middle, marked) = (Some(spot.plan_pos), Some(spot.plan_pos));
        *view = MapView { open: true, middle, radius_m: 220.0, marked, carries: false, ..*view };
    }
}

/// A radius scaled within what makes sense on a map.
pub(crate) fn zoomed(radius_m: f32, factor: f32) -> f32 {
    (radius_m * factor).clamp(25.0, 5_000.0)
}

/// How plan metres lie on the screen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    pub rect: Rect,
    middle: DVec2,
    /// Points a metre.
    pub scale: f32,
    /// Heading that points up, radians clockwise from north.
    pub up: f32,
}

impl Projection {
    pub fn new(rect: Rect, middle: DVec2, radius_m: f32, up_deg: f64) -> Self {
        let scale = rect.width().min(rect.height()) / 2.0 / radius_m.max(1.0);
        Self { rect, middle, scale, up: up_deg.to_radians() as f32 }
    }

    /// Screen position of a plan position.
    pub fn screen(&self, plan_pos: DVec2) -> Pos2 {
        let d = (plan_pos - self.middle).as_vec2() * self.scale;
        let (sin, cos) = self.up.sin_cos();
        self.rect.center() + EguiVec2::new(d.x * cos - d.y * sin, -(d.x * sin + d.y * cos))
    }

    /// Plan position under a screen position.
    pub fn plan(&self, screen: Pos2) -> DVec2 {
        let d = (screen - self.rect.center()) / self.scale;
        let (sin, cos) = self.up.sin_cos();
        self.middle + DVec2::new(f64::from(d.x * cos - d.y * sin), f64::from(-d.x * sin - d.y * cos))
    }

    /// Metres from the middle to a corner.
    pub fn reach_m(&self) -> f32 {
        self.rect.size().length() / 2.0 / self.scale
    }

    pub fn middle(&self) -> DVec2 {
        self.middle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Rect {
        Rect::from_min_size(Pos2::ZERO, EguiVec2::splat(200.0))
    }

    #[test]
    fn ahead_is_up_when_the_heading_is() {
        let east_up = Projection::new(square(), DVec2::ZERO, 100.0, 90.0);
        let p = east_up.screen(DVec2::new(50.0, 0.0));
        assert!((p.x - 100.0).abs() < 1e-3 && (p.y - 50.0).abs() < 1e-3, "{p:?}");
        let north_up = Projection::new(square(), DVec2::ZERO, 100.0, 0.0);
        let p = north_up.screen(DVec2::new(50.0, 0.0));
        assert!((p.x - 150.0).abs() < 1e-3 && (p.y - 100.0).abs() < 1e-3, "{p:?}");
    }

    #[test]
    fn a_click_finds_the_plan_position_it_is_drawn_from() {
        let map = Projection::new(square(), DVec2::new(-300.0, 40.0), 250.0, 137.0);
        for plan in [DVec2::new(-290.0, 60.0), DVec2::new(-400.0, -20.0)] {
            assert!((map.plan(map.screen(plan)) - plan).length() < 1e-2);
        }
    }
}
