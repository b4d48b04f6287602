//! What lies at a spot of a town: nothing of it, a house, water.

use glam::DVec2;
use veduta_city::{GridPos, Massing, PlanStreet, SurfaceKind, metres};
use veduta_route::OFF_STREET_M;

use super::town::Town;

/// How one comes to stand at a spot.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Stand {
    /// At once.
    Placed,
    /// On foot, for which a spot outside of the city is a mistake.
    Walked,
}

/// Farther beyond its streets a spot is outside of a city; metres.
const OUTSIDE_M: f64 = 50.0;
/// Views go farther.
const FAR_M: f64 = 3_000.0;
/// A spot is within an outline if it is so far from its edges, metres: outlines on maps are rounded.
const WITHIN_M: f64 = 0.4;
/// A coordinate of the anchor's differs by no more from what a person means by degrees.
const NEAR_DEG: f64 = 0.3;

impl Town {
    /// Metres of what is written as degrees of latitude and longitude near the city, in either order.
    pub fn degrees(&self, pos: DVec2) -> Option<DVec2> {
        let is_near = |lat: f64, lon: f64| (lat - self.anchor.lat).abs() < NEAR_DEG && (lon - self.anchor.lon).abs() < NEAR_DEG;
        // Whole metres and tenths are metres.
        let is_fine = |value: f64| (value * 100.0).fract().abs() > 1e-6;
        if !is_fine(pos.x) || !is_fine(pos.y) {
            return None;
        }
        let (lat, lon) = if is_near(pos.x, pos.y) { (pos.x, pos.y) } else { (pos.y, pos.x) };
        is_near(lat, lon).then(|| self.anchor.plan_from_geo(lat, lon))
    }

    /// What is odd about standing at a spot, in words.
    pub fn stood_at(&self, pos: DVec2, how: Stand) -> Option<String> {
        let outside_m = self.outside_m(pos);
        if outside_m > OUTSIDE_M || self.net.nearest(pos).is_some_and(|foot| foot.distance_m > OFF_STREET_M) {
            let far_m = self.net.nearest(pos).map_or(outside_m, |foot| foot.distance_m);
            return (how == Stand::Placed)
                .then(|| format!("this lies outside of the city, {far_m:.0} m from the nearest street; {}", self.reaches()));
        }
        if let Some((house, _)) = self.house_at(pos) {
            return Some(format!("this lies within a house{house}: the view is inside of it; choose a spot in the street"));
        }
        self.is_in_water(pos).then(|| "this lies in the water".to_owned())
    }

    /// What is odd about looking at a spot, in words.
    pub fn looked_at(&self, pos: DVec2) -> Option<String> {
        let outside_m = self.outside_m(pos);
        (outside_m > FAR_M)
            .then(|| format!("what is looked at lies {:.1} km outside of the city; {}", outside_m / 1000.0, self.reaches()))
    }

    /// What is odd about flying through a point, in words.
    pub fn flown_through(&self, pos: DVec2, height_m: f64) -> Option<String> {
        let outside_m = self.outside_m(pos);
        if outside_m > FAR_M {
            return Some(format!("this lies {:.1} km outside of the city; {}", outside_m / 1000.0, self.reaches()));
        }
        let (house, top_m) = self.house_at(pos).filter(|(_, top_m)| *top_m > height_m)?;
        Some(format!("the flight goes through a house{house}, which is {top_m:.0} m high"))
    }

    /// How far a position lies beyond the box of all streets, metres.
    fn outside_m(&self, pos: DVec2) -> f64 {
        let (low, high) = self.bounds_m();
        if low.x > high.x { 0.0 } else { pos.distance(pos.clamp(low, high)) }
    }

    fn reaches(&self) -> String {
        let (low, high) = self.bounds_m();
        format!("its streets reach from x {:.0} to {:.0} and y {:.0} to {:.0}", low.x, high.x, low.y, high.y)
    }

    /// The box of all streets, metres.
    fn bounds_m(&self) -> (DVec2, DVec2) {
        let ends = self.overview.streets.iter().flat_map(|street| &street.line).map(|pos| pos.to_metres());
        ends.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), pos| (low.min(pos), high.max(pos)))
    }

    /// The house that a position lies well within: its name in words, and how high it is in metres.
    fn house_at(&self, pos: DVec2) -> Option<(String, f64)> {
        let corners = [(0.0, 0.0), (WITHIN_M, 0.0), (-WITHIN_M, 0.0), (0.0, WITHIN_M), (0.0, -WITHIN_M)];
        let corners = corners.map(|off| GridPos::from_metres(pos + DVec2::from(off)));
        let is_within = |house: &&Massing| corners.iter().all(|corner| house.outline.contains(*corner));
        let (index, house) = self.overview.houses.iter().enumerate().find(|(_, house)| is_within(house))?;
        let of_it = |name: &&veduta_city::HouseName| (name.house as usize..(name.house + name.parts) as usize).contains(&index);
        let name = self.overview.names.iter().find(of_it).map(|name| if name.name.is_empty() { &name.number } else { &name.name });
        Some((name.map_or_else(String::new, |name| format!(" (“{name}”)")), metres(house.height)))
    }

    /// Whether there is water at a position, and no bridge.
    fn is_in_water(&self, pos: DVec2) -> bool {
        let at = GridPos::from_metres(pos);
        let is_water = |patch: &veduta_city::GroundPatch| patch.surface == SurfaceKind::Water && patch.outline.contains(at);
        self.overview.ground.iter().any(is_water) && !self.overview.streets.iter().any(|street| is_on(street, pos))
    }
}

/// Whether a position lies on a street, or beside it by as much as maps are rounded.
fn is_on(street: &PlanStreet, pos: DVec2) -> bool {
    let reach_m = metres(street.width) / 2.0 + 1.0;
    street.line.windows(2).any(|ends| {
        let (a, b) = (ends[0].to_metres(), ends[1].to_metres());
        let share = ((pos - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
        pos.distance(a.lerp(b, share)) < reach_m
    })
}
