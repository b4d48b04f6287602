use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{Id, Place, PlaceKind};
use veduta_ecs::{City, Eye, Viewer};
use veduta_route::turn_deg;

/// The place that the visitor is at.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub struct NearPlace(
    /// The place; `None` between places.
    pub Option<Place>,
);

/// The visitor has come to a place.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct PlaceEntered {
    /// Its id.
    pub id: Id,
    /// Its name.
    pub name: String,
}

/// The visitor has left a place.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct PlaceLeft {
    /// Its id.
    pub id: Id,
}

/// A place that was asked about: it is told of as long as the visitor stays where he was told of it.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub struct Pin(Option<Pinned>);

#[derive(Debug, Clone, PartialEq)]
struct Pinned {
    place: Place,
    /// Where it is told of, plan metres.
    stand: DVec2,
    /// Whether the visitor has been there.
    is_there: bool,
}

/// Who goes farther from where something was told of, metres, has left it.
const STAYS_M: f64 = 12.0;

impl Pin {
    /// A place that was pointed at from a spot.
    #[must_use]
    pub fn here(place: Place, stand: DVec2) -> Self {
        Self(Some(Pinned { place, stand, is_there: true }))
    }

    /// A place that is to be told of once the visitor comes to a stand.
    #[must_use]
    pub fn there(place: Place, stand: DVec2) -> Self {
        Self(Some(Pinned { place, stand, is_there: false }))
    }

    /// The place to tell of to who stands somewhere; it is let go when he leaves.
    fn at(&mut self, plan_pos: DVec2) -> Option<&Place> {
        let pinned = self.0.as_mut()?;
        let is_near = pinned.stand.distance(plan_pos) < STAYS_M;
        if is_near {
            pinned.is_there = true;
        } else if pinned.is_there {
            self.0 = None;
            return None;
        }
        self.0.as_ref().filter(|pinned| pinned.is_there).map(|pinned| &pinned.place)
    }
}

/// Widths of the Gaussians: in multiples of a place's radius, and in degrees off the middle of the view.
const NEAR: f64 = 0.85;
const VIEW_DEG: f64 = 60.0;
/// Within this share of the radius the visitor stands in the place, wherever he looks; from twice as far on he looks at it or does not.
const WITHIN: f64 = 0.3;
/// A place is told of from this relevance on, until it has fallen below that; another takes over when it is so many times as relevant.
const ENTERS: f64 = 0.5;
const LEAVES: f64 = 0.2;
const LEAD: f64 = 1.25;
/// It must be so for as long as this, seconds: who turns round is not told of all that passes by.
const SETTLES_S: f64 = 0.35;
/// From this height above the ground on nobody is at a place.
const ALOFT_M: f64 = 12.0;

/// How much a place matters to an eye, 0 to 1: a Gaussian in its distance, by the place's own radius, times one in the angle between it
/// and the middle of the view; the nearer, the less the view counts.
///
/// After the information in context of the CMPE group's viewer (Carrozzino et al. 2009), which weighs both in the same way.
#[must_use]
pub fn relevance(place: &Place, eye: &Eye) -> f64 {
    let to = place.pos - eye.plan_pos;
    let near = to.length() / place.radius_m.max(0.1);
    let by_place = (-near * near / (2.0 * NEAR * NEAR)).exp();
    let off_deg = turn_deg(eye.heading_deg, heading_to(eye.plan_pos, place.pos));
    let by_view = (-off_deg * off_deg / (2.0 * VIEW_DEG * VIEW_DEG)).exp();
    let outside = ((near - WITHIN) / WITHIN).clamp(0.0, 1.0);
    by_place * (1.0 - outside + outside * by_view)
}

/// A place that is about to take over, and for how long.
#[derive(Default)]
pub(crate) struct Coming {
    id: Option<Id>,
    for_s: f64,
}

/// Looks for the most relevant place each frame; says so when it changes.
pub(crate) fn find_near(
    time: Res<Time>,
    city: Option<Res<City>>,
    viewers: Query<&Eye, With<Viewer>>,
    mut coming: Local<Coming>,
    mut pin: ResMut<Pin>,
    mut near: ResMut<NearPlace>,
    mut entered: MessageWriter<PlaceEntered>,
    mut left: MessageWriter<PlaceLeft>,
) {
    let eye = viewers.iter().next();
    let pinned = eye.and_then(|eye| pin.bypass_change_detection().at(eye.plan_pos));
    let is_pinned = pinned.is_some();
    let now = match (&city, eye) {
        _ if is_pinned => pinned,
        (Some(city), Some(eye)) if eye.eye_m < ALOFT_M => most_relevant(city.overviews.places(), eye, near.0.as_ref()),
        _ => None,
    };
    let now_id = now.map(|place| place.id);
    if now_id == near.0.as_ref().map(|place| place.id) {
        *coming = Coming { id: now_id, for_s: 0.0 };
        return;
    }
    if coming.id != now_id {
        *coming = Coming { id: now_id, for_s: 0.0 };
    }
    coming.for_s += time.delta_secs_f64();
    if coming.for_s < SETTLES_S && !is_pinned {
        return;
    }
    if let Some(before) = &near.0 {
        left.write(PlaceLeft { id: before.id });
    }
    if let Some(place) = now {
        entered.write(PlaceEntered { id: place.id, name: place.name.clone() });
    }
    near.0 = now.cloned();
}

/// The place that matters most; the present one keeps a lead.
fn most_relevant<'a>(places: impl Iterator<Item = &'a Place>, eye: &Eye, present: Option<&Place>) -> Option<&'a Place> {
    let is_present = |place: &Place| present.is_some_and(|p| p.id == place.id);
    let weighed = |place: &'a Place| {
        let reach_m = 2.0 * place.radius_m.max(0.1);
        if place.pos.distance_squared(eye.plan_pos) > reach_m * reach_m {
            return None;
        }
        let (relevance, is_present) = (relevance(place, eye), is_present(place));
        let least = if is_present { LEAVES } else { ENTERS };
        // A spot with a view gives way to what is seen from it.
        let weight = if place.kind == PlaceKind::Viewpoint { 0.5 } else { 1.0 };
        (relevance >= least).then_some((relevance * weight * if is_present { LEAD } else { 1.0 }, place))
    };
    let told = places.filter(|p| !matches!(p.kind, PlaceKind::Street) || !p.text.is_empty());
    told.filter_map(weighed).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
}

/// Where the visitor should look to see a place from where he stands, degrees clockwise from north.
pub(crate) fn heading_to(from: DVec2, to: DVec2) -> f64 {
    let d = to - from;
    d.x.atan2(d.y).to_degrees().rem_euclid(360.0)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use veduta_city::Overview;
    use veduta_ecs::Overviews;

    use super::*;

    fn place(id: u64, x: f64) -> Place {
        Place { id: Id(id), name: format!("place {id}"), pos: [x, 0.0].into(), radius_m: 10.0, ..Place::default() }
    }

    /// An app with two places, and a viewer that is put where and turned as asked; it tells the place after so many frames of 0.1 s.
    fn visit() -> impl FnMut(f64, f64, u32) -> Option<u64> {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), crate::GuidePlugin { interface: false }))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)));
        let overview = Overview { places: vec![place(1, 0.0), place(2, 100.0)], ..Overview::default() };
        app.insert_resource(City { overviews: Overviews::whole(overview), ..City::default() });
        let viewer = app.world_mut().spawn((Viewer, Eye::default())).id();
        move |x, heading_deg, frames| {
            let mut eye = app.world_mut().get_mut::<Eye>(viewer).expect("spawned above");
            (eye.plan_pos.x, eye.heading_deg) = (x, heading_deg);
            (0..frames).for_each(|_| app.update());
            app.world().resource::<NearPlace>().0.as_ref().map(|p| p.id.0)
        }
    }

    #[test]
    fn a_place_is_entered_once_and_left_beyond_its_border() {
        let mut at = visit();
        // Looking west, at the first of the two.
        assert_eq!(at(9.0, 270.0, 6), Some(1));
        assert_eq!(at(11.0, 270.0, 6), Some(1), "just past the border it stays");
        assert_eq!(at(16.0, 270.0, 6), None);
        assert_eq!(at(11.0, 270.0, 6), None, "just outside it is not entered");
        assert_eq!(at(95.0, 90.0, 6), Some(2));
    }

    #[test]
    fn what_is_behind_the_visitor_matters_less_and_where_he_stands_always() {
        let mut at = visit();
        assert_eq!(at(8.0, 90.0, 6), None, "with his back to it");
        assert_eq!(at(2.0, 90.0, 6), Some(1), "in its midst");
        assert_eq!(at(8.0, 0.0, 6), Some(1), "told of, it stays while he looks about");
    }

    #[test]
    fn a_spot_with_a_view_gives_way_to_what_is_seen_from_it() {
        let spot = Place { kind: PlaceKind::Viewpoint, ..place(1, 0.0) };
        let sight = Place { kind: PlaceKind::Monument, ..place(2, 9.0) };
        let eye = Eye { plan_pos: DVec2::new(1.0, 0.0), heading_deg: 90.0, ..Eye::default() };
        let told = |places: &[Place]| most_relevant(places.iter(), &eye, None).map(|place| place.id.0);
        assert_eq!(told(&[spot.clone(), sight]), Some(2));
        assert_eq!(told(&[spot]), Some(1));
    }

    #[test]
    fn turning_by_does_not_flicker() {
        let mut at = visit();
        assert_eq!(at(9.0, 270.0, 2), None, "a glance");
        assert_eq!(at(9.0, 90.0, 2), None);
        assert_eq!(at(9.0, 270.0, 5), Some(1));
    }

    #[test]
    fn what_was_asked_about_is_told_of_until_it_is_left() {
        let asked = place(7, 0.0);
        let mut pin = Pin::there(asked.clone(), DVec2::new(50.0, 0.0));
        let mut at = |x: f64| pin.at(DVec2::new(x, 0.0)).map(|place| place.id.0);
        assert_eq!([at(0.0), at(45.0), at(60.0), at(80.0), at(50.0)], [None, Some(7), Some(7), None, None]);
        let mut pin = Pin::here(asked, DVec2::ZERO);
        assert!(pin.at(DVec2::new(1.0, 0.0)).is_some());
    }

    #[test]
    fn relevance_falls_with_distance_and_angle() {
        let place = place(1, 0.0);
        let eye = |x: f64, heading_deg: f64| Eye { plan_pos: DVec2::new(x, 0.0), heading_deg, ..Eye::default() };
        let facing: Vec<f64> = (0..30).map(|x| relevance(&place, &eye(f64::from(x), 270.0))).collect();
        assert!(facing.windows(2).all(|w| w[1] < w[0]) && facing[0] == 1.0, "{facing:?}");
        let turning: Vec<f64> = (0..18).map(|n| relevance(&place, &eye(9.0, 270.0 + 10.0 * f64::from(n)))).collect();
        assert!(turning.windows(2).all(|w| w[1] < w[0]), "{turning:?}");
    }
}
