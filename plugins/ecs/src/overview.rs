use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::bounds::{self, Bounds};
use veduta_city::{Boxes, GridPos, Overview, Place};

/// A circle in plan.
#[derive(Debug, Clone, Copy, PartialEq, Default, Reflect)]
pub struct Around {
    /// Its middle, plan metres.
    pub middle: DVec2,
    /// Its radius, metres; infinite for everywhere.
    pub radius_m: f64,
}

impl Around {
    /// A circle about this one that stays the same as long as its middle moves less than a sixteenth of its radius or so: to be asked for
    /// anew only now and then.
    #[must_use]
    pub fn coarsely(middle: DVec2, radius_m: f64) -> Self {
        let step = (radius_m / 16.0).max(8.0);
        let radius_m = (radius_m / step).ceil() * step + 2.0 * step;
        Self { middle: (middle / step).round() * step, radius_m }
    }

    /// A box around it, however it is rounded to the grid.
    fn bounds(self) -> Bounds {
        let corner = |way: f64| GridPos::from_metres(self.middle + way * (self.radius_m + 1.0));
        (corner(-1.0), corner(1.0))
    }

    fn meets(self, bounds: Bounds) -> bool {
        bounds::distance_m(bounds, self.middle) <= self.radius_m
    }
}

/// Which parts of the overview plugins need, each under a name of its own, besides what lies about the viewers. Streaming sees to them.
#[derive(Resource, Debug, Clone, Default, PartialEq)]
pub struct OverviewWants(
    /// By plugin.
    pub BTreeMap<&'static str, Around>,
);

impl OverviewWants {
    /// Asks for what reaches into a circle, in place of what was asked for under the name before; `None` for nothing.
    pub fn ask(wants: &mut ResMut<'_, Self>, name: &'static str, around: Option<Around>) {
        if wants.0.get(name).copied() == around {
            return;
        }
        match around {
            Some(around) => drop(wants.0.insert(name, around)),
            None => drop(wants.0.remove(name)),
        }
    }
}

/// The overview of the open city, in parts that come and go.
#[derive(Debug, Clone, Default)]
pub struct Overviews {
    /// Of all parts.
    bounds: Boxes,
    here: BTreeMap<u32, Arc<Overview>>,
    vistas: Vec<u32>,
}

impl Overviews {
    /// A city's whole overview.
    #[must_use]
    pub fn whole(overview: Overview) -> Self {
        let everywhere = (GridPos(i32::MIN, i32::MIN), GridPos(i32::MAX, i32::MAX));
        Self { bounds: [everywhere].into_iter().collect(), here: [(0, Arc::new(overview))].into(), vistas: Vec::new() }
    }

    /// Parts that lie within bounds, none of which has come.
    #[must_use]
    pub fn awaited(bounds: impl IntoIterator<Item = Bounds>) -> Self {
        Self { bounds: bounds.into_iter().collect(), ..Self::default() }
    }

    /// Puts a part where it belongs, or takes it away.
    pub fn put(&mut self, part: u32, overview: Option<Arc<Overview>>) {
        match overview {
            Some(overview) if (part as usize) < self.bounds.len() => drop(self.here.insert(part, overview)),
            _ => drop(self.here.remove(&part)),
        }
    }

    /// Parts that viewers see from afar, however far away they lie.
    #[must_use]
    pub fn vistas(&self) -> &[u32] {
        &self.vistas
    }

    /// Replaces the list of parts that viewers see from afar.
    pub fn set_vistas(&mut self, parts: Vec<u32>) {
        self.vistas = parts;
    }

    /// A part that is here.
    #[must_use]
    pub fn get(&self, part: u32) -> Option<&Arc<Overview>> {
        self.here.get(&part)
    }

    /// The parts that are here, with their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &Arc<Overview>)> {
        self.here.iter().map(|(&part, overview)| (part, overview))
    }

    /// The parts that are here and reach into a circle.
    pub fn near(&self, around: Around) -> impl Iterator<Item = &Arc<Overview>> {
        let is_near = move |part: u32| self.bounds.get(part).is_some_and(|bounds| around.meets(bounds));
        self.iter().filter(move |&(part, _)| is_near(part)).map(|(_, overview)| overview)
    }

    /// Numbers of the parts that reach into a circle, here or not.
    pub fn within(&self, around: Around) -> impl Iterator<Item = u32> {
        let is_near = move |part: &u32| self.bounds.get(*part).is_some_and(|bounds| around.meets(bounds));
        self.bounds.meeting(around.bounds()).filter(is_near)
    }

    /// Whether all parts that reach into a circle are here.
    #[must_use]
    pub fn has(&self, around: Around) -> bool {
        self.within(around).all(|part| self.here.contains_key(&part))
    }

    /// Whether all parts reach into a circle.
    #[must_use]
    pub fn is_all(&self, around: Around) -> bool {
        self.bounds.iter().all(|bounds| around.meets(bounds))
    }

    /// The parts that reach into a circle and are here as one.
    #[must_use]
    pub fn joined(&self, around: Around) -> Overview {
        Overview::joined(self.near(around).map(AsRef::as_ref))
    }

    /// Things with a name, of the parts that are here.
    pub fn places(&self) -> impl Iterator<Item = &Place> {
        self.iter().flat_map(|(_, overview)| &overview.places)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_has_the_parts_that_reach_into_it() {
        let part = |x: i32| (GridPos(x * 1024, 0), GridPos((x + 100) * 1024, 100 * 1024));
        let mut overviews = Overviews::awaited([part(0), part(100), part(500)]);
        let near = Around { middle: DVec2::new(90.0, 50.0), radius_m: 20.0 };
        assert_eq!(overviews.within(near).collect::<Vec<_>>(), [0, 1]);
        overviews.put(0, Some(Arc::default()));
        assert!(!overviews.has(near));
        overviews.put(1, Some(Arc::default()));
        assert!(overviews.has(near) && !overviews.is_all(near));
        let everywhere = Around { radius_m: f64::INFINITY, ..near };
        assert!(overviews.is_all(everywhere) && !overviews.has(everywhere));
        assert!(Overviews::whole(Overview::default()).has(near));
        let coarse = Around::coarsely(near.middle, 100.0);
        assert!(coarse.middle.distance(near.middle) + 100.0 <= coarse.radius_m, "it holds what it was asked about");
    }
}
