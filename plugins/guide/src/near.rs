use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{Id, Place, PlaceKind};
use veduta_ecs::{City, Eye, Viewer};

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

/// A place is left only at this multiple of its radius, so that its border does not flicker.
const LEAVE_AT: f64 = 1.3;
/// From this height above the ground on nobody is at a place.
const ALOFT_M: f64 = 12.0;

/// Looks for the nearest place each frame; says so when it changes.
pub(crate) fn find_near(
    city: Option<Res<City>>,
    viewers: Query<&Eye, With<Viewer>>,
    mut near: ResMut<NearPlace>,
    mut entered: MessageWriter<PlaceEntered>,
    mut left: MessageWriter<PlaceLeft>,
) {
    let eye = viewers.iter().next();
    let now = match (&city, eye) {
        (Some(city), Some(eye)) if eye.eye_m < ALOFT_M => nearest(city.overviews.places(), eye.plan_pos, near.0.as_ref()),
        _ => None,
    };
    if now.map(|p| p.id) == near.0.as_ref().map(|p| p.id) {
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

/// The place whose middle is nearest as a share of its radius; the present one keeps a lead.
fn nearest<'a>(places: impl Iterator<Item = &'a Place>, at: DVec2, present: Option<&Place>) -> Option<&'a Place> {
    let share = |place: &Place| {
        let lead = if present.is_some_and(|p| p.id == place.id) { LEAVE_AT } else { 1.0 };
        at.distance(DVec2::new(place.pos.x, place.pos.y)) / (place.radius_m.max(0.1) * lead)
    };
    let told = places.filter(|p| !matches!(p.kind, PlaceKind::Street) || !p.text.is_empty());
    told.map(|p| (share(p), p)).filter(|(s, _)| *s <= 1.0).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, p)| p)
}

#[cfg(test)]
mod tests {
    use veduta_city::Overview;
    use veduta_ecs::Overviews;

    use super::*;

    fn place(id: u64, x: f64) -> Place {
        Place { id: Id(id), name: format!("place {id}"), pos: [x, 0.0].into(), radius_m: 10.0, ..Place::default() }
    }

    #[test]
    fn a_place_is_entered_once_and_left_beyond_its_border() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, crate::GuidePlugin { interface: false }));
        let overview = Overview { places: vec![place(1, 0.0), place(2, 100.0)], ..Overview::default() };
        app.insert_resource(City { overviews: Overviews::whole(overview), ..City::default() });
        let viewer = app.world_mut().spawn((Viewer, Eye { plan_pos: DVec2::new(9.0, 0.0), ..Eye::default() })).id();
        let mut at = |x: f64| {
            app.world_mut().get_mut::<Eye>(viewer).expect("spawned above").plan_pos.x = x;
            app.update();
            app.world().resource::<NearPlace>().0.as_ref().map(|p| p.id.0)
        };
        assert_eq!(at(9.0), Some(1));
        assert_eq!(at(11.0), Some(1), "just past the border it stays");
        assert_eq!(at(14.0), None);
        assert_eq!(at(11.0), None, "just outside it is not entered");
        assert_eq!(at(95.0), Some(2));
    }
}
