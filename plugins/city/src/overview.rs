use serde::{Deserialize, Serialize};

use crate::{
    CityPlan, GRID_PER_METRE, GridPolygon, GridPos, GridRing, Place, PlanStreet, PlanTerrain, SurfaceKind, Volume, WaySpan,
};

/// Grid steps to which outlines on maps are rounded: a quarter of a metre.
pub const MAP_STEP: i32 = GRID_PER_METRE / 4;

/// What maps, search and routes need of a city or a part of it, without its façades.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Overview {
    /// Elevations of the ground.
    #[serde(default, skip_serializing_if = "PlanTerrain::is_level")]
    pub terrain: PlanTerrain,
    /// Centre lines with names.
    pub streets: Vec<PlanStreet>,
    /// What covers the ground, and where, in multiples of [`MAP_STEP`]. Yards are what is left.
    pub areas: Vec<(SurfaceKind, GridPolygon)>,
    /// Outlines of houses, and how high they stand above the ground at their first vertex, in multiples of [`MAP_STEP`]. A house of
    /// several volumes has one entry for each outline that differs, one after another.
    pub houses: Vec<(GridPolygon, i32)>,
    /// Names and numbers of those houses that have them.
    pub names: Vec<HouseName>,
    /// Spans of ways on bridges and below the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spans: Vec<WaySpan>,
    /// Things with a name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<Place>,
}

/// How people call a house.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HouseName {
    /// Index of the house's first entry in [`Overview::houses`].
    pub house: u32,
    /// Name, may be empty if there is a number.
    pub name: String,
    /// House number, may be empty if there is a name.
    pub number: String,
}

impl Overview {
    /// The overview of a whole plan.
    #[must_use]
    pub fn of(plan: &CityPlan) -> Self {
        let everywhere = (GridPos(i32::MIN, i32::MIN), GridPos(i32::MAX, i32::MAX));
        OverviewParts::new(plan, 1, |_| 0).overview(0, everywhere)
    }

    /// The overviews of parts of a city as one.
    #[must_use]
    pub fn joined<'a>(parts: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut whole = Self::default();
        let mut terrains = Vec::new();
        for part in parts {
            let first = whole.houses.len() as u32;
            whole.names.extend(part.names.iter().map(|name| HouseName { house: first + name.house, ..name.clone() }));
            whole.streets.extend_from_slice(&part.streets);
            whole.areas.extend_from_slice(&part.areas);
            whole.houses.extend_from_slice(&part.houses);
            whole.spans.extend_from_slice(&part.spans);
            whole.places.extend_from_slice(&part.places);
            terrains.push(&part.terrain);
        }
        Self { terrain: PlanTerrain::joined(&terrains), ..whole }
    }

    /// Adds an outline of a house, or raises the equal one that the house has already from `first` on.
    fn add_outline(&mut self, first: usize, volume: &Volume, terrain: &PlanTerrain) {
        let Some(outline) = on_map(&volume.footprint) else { return };
        let ground = volume.footprint.outer.first().map_or(0, |&pos| terrain.height(pos));
        let height = rounded(volume.top().saturating_sub(ground));
        let known = self.houses.iter_mut().skip(first).find(|(known, _)| *known == outline);
        match known {
            Some((_, highest)) => *highest = height.max(*highest),
            None => self.houses.push((outline, height)),
        }
    }
}

/// Which things of a plan are told in which part of its overview: each in one.
#[derive(Debug)]
pub struct OverviewParts<'a> {
    plan: &'a CityPlan,
    parts: Vec<Part>,
}

/// Indices of a plan's things.
#[derive(Debug, Clone, Default)]
struct Part {
    streets: Vec<u32>,
    ground: Vec<u32>,
    houses: Vec<u32>,
    spans: Vec<u32>,
    places: Vec<u32>,
}

impl<'a> OverviewParts<'a> {
    /// Sorts a plan's things into so many parts, by the place where each begins. What `part_of` puts into a part that there is not goes
    /// into the last.
    #[must_use]
    pub fn new(plan: &'a CityPlan, count: usize, part_of: impl Fn(GridPos) -> usize) -> Self {
        let mut parts = vec![Part::default(); count.max(1)];
        let mut sort = |list: fn(&mut Part) -> &mut Vec<u32>, i: usize, pos: Option<GridPos>| {
            let part = pos.map_or(0, &part_of).min(count.saturating_sub(1));
            list(&mut parts[part]).push(i as u32);
        };
        for (i, street) in plan.streets.iter().enumerate() {
            sort(|part| &mut part.streets, i, street.line.first().copied());
        }
        for (i, patch) in plan.ground.iter().enumerate() {
            if !matches!(patch.surface, SurfaceKind::Yard | SurfaceKind::Opening) {
                sort(|part| &mut part.ground, i, patch.outline.outer.first().copied());
            }
        }
        for (i, house) in plan.houses.iter().enumerate() {
            sort(|part| &mut part.houses, i, house.volumes.first().and_then(|volume| volume.footprint.outer.first().copied()));
        }
        for (i, span) in plan.spans.iter().enumerate() {
            sort(|part| &mut part.spans, i, span.stations.first().map(|station| station.left));
        }
        for (i, place) in plan.places.iter().enumerate() {
            sort(|part| &mut part.places, i, Some(GridPos::from_metres(place.pos)));
        }
        Self { plan, parts }
    }

    /// The overview of a part, with the elevations of the ground within some bounds.
    ///
    /// # Panics
    /// If there is no such part.
    #[must_use]
    pub fn overview(&self, part: usize, bounds: (GridPos, GridPos)) -> Overview {
        let (plan, part) = (self.plan, &self.parts[part]);
        let area = |&i: &u32| {
            let patch = &plan.ground[i as usize];
            Some((patch.surface, on_map(&patch.outline)?))
        };
        let mut overview = Overview {
            terrain: plan.terrain.crop(bounds, GridPos(0, 0)),
            streets: part.streets.iter().map(|&i| plan.streets[i as usize].clone()).collect(),
            areas: part.ground.iter().filter_map(area).collect(),
            spans: part.spans.iter().map(|&i| plan.spans[i as usize].clone()).collect(),
            places: part.places.iter().map(|&i| plan.places[i as usize].clone()).collect(),
            ..Overview::default()
        };
        for house in part.houses.iter().map(|&i| &plan.houses[i as usize]) {
            let first = overview.houses.len();
            house.volumes.iter().for_each(|volume| overview.add_outline(first, volume, &plan.terrain));
            let is_called = !house.name.is_empty() || !house.number.is_empty();
            if is_called && overview.houses.len() > first {
                let (name, number) = (house.name.clone(), house.number.clone());
                overview.names.push(HouseName { house: first as u32, name, number });
            }
        }
        overview
    }
}

const fn rounded(steps: i32) -> i32 {
    steps.saturating_add(MAP_STEP / 2).div_euclid(MAP_STEP) * MAP_STEP
}

/// A polygon as maps show it; `None` if nothing is left of it.
fn on_map(polygon: &GridPolygon) -> Option<GridPolygon> {
    let ring = |ring: &GridRing| {
        let mut coarse: GridRing = ring.iter().map(|pos| GridPos(rounded(pos.0), rounded(pos.1))).collect();
        coarse.dedup();
        while coarse.len() > 1 && coarse.first() == coarse.last() {
            coarse.pop();
        }
        (coarse.len() > 2).then_some(coarse)
    };
    Some(GridPolygon { outer: ring(&polygon.outer)?, holes: polygon.holes.iter().filter_map(ring).collect() })
}

#[cfg(test)]
mod tests {
    use crate::{GroundPatch, House, Id, PlanRoof, Rgb, RoofShape};

    use super::*;

    #[test]
    fn storeys_stacked_on_nearly_one_outline_are_one_entry_with_the_highest_top() {
        let outline = |x| GridPolygon::simple(vec![GridPos(x, 0), GridPos(x + 9 * 256, 0), GridPos(x, 9 * 256)]);
        let volume = |x, eaves| Volume {
            footprint: outline(x),
            bottom: 0,
            eaves,
            colour: Rgb::default(),
            trim: Rgb::default(),
            roof: PlanRoof { shape: RoofShape::Flat, height: 5, direction: 0, colour: Rgb::default() },
            gable: Default::default(),
            walls: Vec::new(),
            arcades: Vec::new(),
        };
        let house = House {
            id: Id(7),
            name: String::new(),
            number: "12".to_owned(),
            style: 0,
            floor: 0,
            volumes: vec![volume(0, 100), volume(10, 3000), volume(512, 200)],
            monument: None,
        };
        let plan = CityPlan { houses: vec![House { number: String::new(), ..house.clone() }, house], ..CityPlan::default() };
        let overview = Overview::of(&plan);
        assert_eq!(overview.houses[..2], [(outline(0), 3072), (outline(512), 256)]);
        assert_eq!(overview.names, [HouseName { house: 2, name: String::new(), number: "12".to_owned() }]);
    }
    #[test]
    fn every_thing_is_told_in_one_part() {
        let at = |x: i32| GridPos(x * 1024, 0);
        let patch = |x: i32, surface| GroundPatch {
            surface,
            outline: GridPolygon::simple(vec![at(x), at(x + 5), GridPos(x * 1024, 5000)]),
            z: 0,
            course: None,
        };
        let street = |i: i32| PlanStreet {
            id: Id(i as u64),
            name: String::new(),
            line: vec![at(i), at(i + 1)],
            width: 4096,
            walkable: true,
            layer: 0,
        };
        let plan = CityPlan {
            streets: (0..6).map(street).collect(),
            ground: vec![patch(1, SurfaceKind::Grass), patch(4, SurfaceKind::Yard), patch(4, SurfaceKind::Water)],
            ..CityPlan::default()
        };
        let parts = OverviewParts::new(&plan, 2, |pos| usize::from(pos.0 >= 3 * 1024));
        let [west, east] = [0, 1].map(|part| parts.overview(part, (at(0), at(9))));
        let ids = |overview: &Overview| overview.streets.iter().map(|street| street.id.0).collect::<Vec<_>>();
        assert_eq!((ids(&west), ids(&east)), (vec![0, 1, 2], vec![3, 4, 5]));
        let kinds = |overview: &Overview| overview.areas.iter().map(|(surface, _)| *surface).collect::<Vec<_>>();
        assert_eq!((kinds(&west), kinds(&east)), (vec![SurfaceKind::Grass], vec![SurfaceKind::Water]));
        assert_eq!(OverviewParts::new(&plan, 2, |_| 7).overview(1, (at(0), at(9))), Overview::of(&plan));
    }

    #[test]
    fn what_vanishes_on_a_map_is_left_out() {
        let sliver = GridPolygon::simple(vec![GridPos(0, 0), GridPos(9000, 0), GridPos(9000, 60), GridPos(0, 60)]);
        let speck = GridPolygon::simple(vec![GridPos(0, 0), GridPos(50, 0), GridPos(50, 60)]);
        assert_eq!((on_map(&sliver), on_map(&speck)), (None, None));
        let with_hole = GridPolygon {
            holes: vec![speck.outer],
            ..GridPolygon::simple(vec![GridPos(0, 0), GridPos(9000, 0), GridPos(0, 9000)])
        };
        assert_eq!(on_map(&with_hole).map(|polygon| polygon.holes.len()), Some(0));
    }
}
