use serde::{Deserialize, Serialize};

use crate::{
    CityPlan, GRID_PER_METRE, GridPolygon, GridPos, GridRing, GroundPatch, House, Place, PlanRoof, PlanStreet, PlanTerrain, Rgb,
    RoofShape, SurfaceKind, Volume, WaySpan,
};

/// Grid steps to which outlines on maps are rounded: a quarter of a metre.
pub const MAP_STEP: i32 = GRID_PER_METRE / 4;

/// What maps, search and routes need of a city or a part of it, and what it looks like from afar: without its façades.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Overview {
    /// Elevations of the ground.
    #[serde(default, skip_serializing_if = "PlanTerrain::is_level")]
    pub terrain: PlanTerrain,
    /// Centre lines with names.
    pub streets: Vec<PlanStreet>,
    /// What covers the ground but openings, and where, in multiples of [`MAP_STEP`], without the courses that it is laid along. Of a city
    /// with cells what is paved is one piece a cell.
    pub ground: Vec<GroundPatch>,
    /// Houses [as maps show them](Massing::on_map). One of several volumes has an entry for each outline that differs, one after another.
    pub houses: Vec<Massing>,
    /// Names and numbers of those houses that have them.
    pub names: Vec<HouseName>,
    /// Spans of ways on bridges and below the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spans: Vec<WaySpan>,
    /// Things with a name, [rounded](Place::rounded).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<Place>,
    /// Which cells ground, houses and spans belong to, ascending. Empty where there are no cells.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub districts: Vec<District>,
}

/// So many pieces of ground, houses and spans, after those of the districts before it, are what a cell looks like from afar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct District {
    /// Index of the cell.
    pub cell: u32,
    /// Entries of [`Overview::ground`].
    pub ground: u32,
    /// Entries of [`Overview::houses`].
    pub houses: u32,
    /// Entries of [`Overview::spans`].
    pub spans: u32,
}

/// A house or a part of it on maps and from afar: an outline, raised to the eaves, under a roof. As precise as a plan, or, in overviews,
/// [as maps show it](Self::on_map).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Massing {
    /// In plan; on maps in multiples of [`MAP_STEP`].
    pub outline: GridPolygon,
    /// How high its top, the ridge of its roof, stands above the ground at its first vertex; on maps in multiples of [`MAP_STEP`].
    pub height: i32,
    /// Its roof; on maps its height in multiples of [`MAP_STEP`], and along or across the longest edge of the outline.
    pub roof: PlanRoof,
    /// Of its walls.
    pub colour: Rgb,
}

impl Massing {
    /// Colours are told in so many steps a channel on maps.
    const COLOURS: u8 = 15;

    /// A white block, so high, for maps alone.
    #[must_use]
    pub const fn block(outline: GridPolygon, height: i32) -> Self {
        let white = Rgb(255, 255, 255);
        Self { outline, height, roof: PlanRoof { shape: RoofShape::Flat, height: 0, direction: 0, colour: white }, colour: white }
    }

    /// Of a volume.
    #[must_use]
    pub fn of(volume: &Volume, terrain: &PlanTerrain) -> Self {
        let ground = volume.footprint.outer.first().map_or(0, |&pos| terrain.height(pos));
        let height = volume.top().saturating_sub(ground);
        Self { outline: volume.footprint.clone(), height, roof: volume.roof, colour: volume.colour }
    }

    /// Of the volumes of a house of which something is left on maps, in their order: of those that have one outline there, the highest.
    #[must_use]
    pub fn of_house(house: &House, terrain: &PlanTerrain) -> Vec<Self> {
        let mut told: Vec<(GridPolygon, Self)> = Vec::new();
        for volume in &house.volumes {
            let Some(outline) = on_map(&volume.footprint) else { continue };
            let massing = Self::of(volume, terrain);
            match told.iter_mut().find(|(known, _)| *known == outline) {
                Some((_, known)) if known.height < massing.height => *known = massing,
                Some(_) => {}
                None => told.push((outline, massing)),
            }
        }
        told.into_iter().map(|(_, massing)| massing).collect()
    }

    /// As maps show it; `None` if nothing of it is left there.
    #[must_use]
    pub fn on_map(&self) -> Option<Self> {
        let outline = on_map(&self.outline)?;
        let PlanRoof { shape, height: rise, direction, colour } = self.roof;
        let quarter = Self::nearest_quarter(&outline, direction);
        let roof = PlanRoof {
            shape,
            height: rounded(rise.max(0)),
            direction: Self::quarter_deg(&outline, quarter),
            colour: coarse(colour),
        };
        Some(Self { outline, height: rounded(self.height), roof, colour: coarse(self.colour) })
    }

    /// The direction that lies so many quarter turns from that of the outline's longest edge, whole degrees clockwise from north.
    #[must_use]
    pub fn quarter_deg(outline: &GridPolygon, quarter: u8) -> u16 {
        let ring = &outline.outer;
        let edges = ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| b.to_metres() - a.to_metres());
        let longest = edges.reduce(|long, edge| if edge.length_squared() > long.length_squared() { edge } else { long });
        let edge = longest.unwrap_or_default();
        let deg = libm::round(libm::atan2(edge.x, edge.y).to_degrees()) as i32 + i32::from(quarter) * 90;
        deg.rem_euclid(360) as u16
    }

    /// How many quarter turns come nearest to a direction.
    #[must_use]
    pub fn nearest_quarter(outline: &GridPolygon, direction: u16) -> u8 {
        let off = |quarter: &u8| {
            let off = (i32::from(Self::quarter_deg(outline, *quarter)) - i32::from(direction)).rem_euclid(360);
            off.min(360 - off)
        };
        (0..4).min_by_key(off).unwrap_or_default()
    }
}

/// A colour to the nearest of the few that are told apart from afar.
fn coarse(Rgb(r, g, b): Rgb) -> Rgb {
    let coarse = |c: u8| {
        let step = u8::MAX / Massing::COLOURS;
        (c.saturating_add(step / 2) / step) * step
    };
    Rgb(coarse(r), coarse(g), coarse(b))
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
    /// So many entries, from the first on, are the house.
    #[serde(default = "HouseName::one")]
    pub parts: u32,
}

impl HouseName {
    const fn one() -> u32 {
        1
    }
}

impl Overview {
    /// Within this distance of an eye overviews are there, whatever else is seen, metres: what is told as seen over the roofs of hills begins there,
    /// proofs count on it, and streaming asks for no less.
    pub const ABOUT_M: f64 = 500.0;

    /// The overview of a whole plan.
    #[must_use]
    pub fn of(plan: &CityPlan) -> Self {
        let everywhere = (GridPos(i32::MIN, i32::MIN), GridPos(i32::MAX, i32::MAX));
        let (houses, spans) = [plan.houses.len(), plan.spans.len()].map(|count| (0..count as u32).collect::<Vec<_>>()).into();
        let all = DistrictOf { cell: 0, ground: &plan.ground, houses: &houses, spans: &spans };
        let overview = OverviewParts::new(plan, 1, |_| 0).overview(0, everywhere, [all]);
        Self { districts: Vec::new(), ..overview }
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
            whole.ground.extend_from_slice(&part.ground);
            whole.houses.extend_from_slice(&part.houses);
            whole.spans.extend_from_slice(&part.spans);
            whole.places.extend_from_slice(&part.places);
            whole.districts.extend_from_slice(&part.districts);
            terrains.push(&part.terrain);
        }
        Self { terrain: PlanTerrain::joined(&terrains), ..whole }
    }
}

/// What of a plan belongs to a cell, as an overview is to tell it.
#[derive(Debug, Clone, Copy)]
pub struct DistrictOf<'a> {
    /// Index of the cell.
    pub cell: u32,
    /// Its ground, as precise as may be.
    pub ground: &'a [GroundPatch],
    /// Houses whose roofs it carries, as indices of the plan.
    pub houses: &'a [u32],
    /// Spans of ways whose middles lie in it, as indices of the plan.
    pub spans: &'a [u32],
}

/// Which streets and places of a plan are told in which part of its overview: each in one.
#[derive(Debug)]
pub struct OverviewParts<'a> {
    plan: &'a CityPlan,
    parts: Vec<Part>,
}

/// Indices of a plan's things.
#[derive(Debug, Clone, Default)]
struct Part {
    streets: Vec<u32>,
    places: Vec<u32>,
}

impl<'a> OverviewParts<'a> {
    /// Sorts a plan's streets and places into so many parts, by the place where each begins. What `part_of` puts into a part that there is
    /// not goes into the last.
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
        for (i, place) in plan.places.iter().enumerate() {
            sort(|part| &mut part.places, i, Some(GridPos::from_metres(place.pos)));
        }
        Self { plan, parts }
    }

    /// The overview of a part, with what its cells look like from afar, and the elevations of the ground within some bounds. What is no
    /// index of the plan is left out.
    ///
    /// # Panics
    /// If there is no such part.
    #[must_use]
    pub fn overview<'d>(
        &self,
        part: usize,
        bounds: (GridPos, GridPos),
        districts: impl IntoIterator<Item = DistrictOf<'d>>,
    ) -> Overview {
        let (plan, part) = (self.plan, &self.parts[part]);
        let mut overview = Overview {
            terrain: plan.terrain.crop(bounds, GridPos(0, 0)),
            streets: part.streets.iter().map(|&i| plan.streets[i as usize].clone()).collect(),
            places: part.places.iter().map(|&i| plan.places[i as usize].rounded()).collect(),
            ..Overview::default()
        };
        for of in districts {
            let before = [overview.ground.len(), overview.houses.len(), overview.spans.len()];
            let patch = |&GroundPatch { surface, ref outline, z, .. }: &GroundPatch| {
                Some(GroundPatch { surface, outline: on_map(outline)?, z, course: None })
            };
            let is_there = |patch: &&GroundPatch| patch.surface != SurfaceKind::Opening;
            overview.ground.extend(of.ground.iter().filter(is_there).filter_map(patch));
            overview.spans.extend(of.spans.iter().filter_map(|&i| plan.spans.get(i as usize)).cloned());
            for house in of.houses.iter().filter_map(|&i| plan.houses.get(i as usize)) {
                let first = overview.houses.len();
                overview.houses.extend(Massing::of_house(house, &plan.terrain).iter().filter_map(Massing::on_map));
                let is_called = !house.name.is_empty() || !house.number.is_empty();
                if is_called && overview.houses.len() > first {
                    let (name, number) = (house.name.clone(), house.number.clone());
                    let parts = (overview.houses.len() - first) as u32;
                    overview.names.push(HouseName { house: first as u32, name, number, parts });
                }
            }
            let after = [overview.ground.len(), overview.houses.len(), overview.spans.len()];
            let [ground, houses, spans] = core::array::from_fn(|i| (after[i] - before[i]) as u32);
            overview.districts.push(District { cell: of.cell, ground, houses, spans });
        }
        overview
    }
}

const fn rounded(steps: i32) -> i32 {
    steps.saturating_add(MAP_STEP / 2).div_euclid(MAP_STEP) * MAP_STEP
}

/// A polygon as maps show it: in multiples of [`MAP_STEP`]; `None` if nothing is left of it.
#[must_use]
pub fn on_map(polygon: &GridPolygon) -> Option<GridPolygon> {
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
    use crate::Id;

    use super::*;

    fn outline(x: i32) -> GridPolygon {
        GridPolygon::simple(vec![GridPos(x, 0), GridPos(x + 9 * 256, 0), GridPos(x, 8 * 256)])
    }

    fn volume(x: i32, eaves: i32) -> Volume {
        Volume {
            footprint: outline(x),
            bottom: 0,
            eaves,
            colour: Rgb(200, 101, 7),
            trim: Rgb::default(),
            roof: PlanRoof { shape: RoofShape::Gabled, height: 300, direction: 350, colour: Rgb(255, 0, 42) },
            gable: Default::default(),
            walls: Vec::new(),
            arcades: Vec::new(),
        }
    }

    fn house(number: &str, volumes: Vec<Volume>) -> House {
        House { id: Id(7), name: String::new(), number: number.to_owned(), style: 0, floor: 0, volumes, monument: None }
    }

    #[test]
    fn storeys_stacked_on_nearly_one_outline_are_one_entry_with_the_highest_top() {
        let volumes = || vec![volume(0, 100), volume(10, 2780), volume(512, 200)];
        let plan = CityPlan { houses: vec![house("", volumes()), house("12", volumes())], ..CityPlan::default() };
        let overview = Overview::of(&plan);
        let told = |massing: &Massing| (massing.outline.clone(), massing.height, massing.roof.height);
        assert_eq!(overview.houses[..2].iter().map(told).collect::<Vec<_>>(), [(outline(0), 3072, 256), (outline(512), 512, 256)]);
        assert_eq!(overview.names, [HouseName { house: 2, name: String::new(), number: "12".to_owned(), parts: 2 }]);
        assert!(overview.districts.is_empty());
    }

    #[test]
    fn roofs_follow_their_outlines_and_colours_are_few() {
        let precise = Massing::of(&volume(0, 1000), &PlanTerrain::default());
        let told = (&precise.outline, precise.height, precise.roof.direction, precise.colour);
        assert_eq!(told, (&outline(0), 1300, 350, Rgb(200, 101, 7)));
        let massing = precise.on_map().expect("an area");
        // The longest edge leads from (2304, 0) to (0, 2048).
        let leads = libm::round(libm::atan2(-9.0, 8.0).to_degrees()) as i32 + 360;
        assert_eq!(i32::from(massing.roof.direction), leads, "the nearest to 350 of it and its quarter turns");
        assert_eq!(massing.colour, Rgb(204, 102, 0));
        assert_eq!(massing.roof.colour, Rgb(255, 0, 34));
        for quarter in 0..4 {
            let deg = Massing::quarter_deg(&massing.outline, quarter);
            assert_eq!(Massing::nearest_quarter(&massing.outline, deg), quarter);
        }
    }

    #[test]
    fn every_thing_is_told_in_one_part_and_districts_in_order() {
        let at = |x: i32| GridPos(x * 1024, 0);
        let patch = |x: i32, surface| GroundPatch {
            surface,
            outline: GridPolygon::simple(vec![at(x), at(x + 5), GridPos(x * 1024, 5000)]),
            z: 3,
            course: Some(1),
        };
        let street = |i: i32| PlanStreet {
            id: Id(i as u64),
            name: String::new(),
            line: vec![at(i), at(i + 1)],
            width: 4096,
            walkable: true,
            ..PlanStreet::default()
        };
        let plan = CityPlan {
            streets: (0..6).map(street).collect(),
            ground: [SurfaceKind::Grass, SurfaceKind::Opening, SurfaceKind::Yard, SurfaceKind::Water]
                .map(|kind| patch(4, kind))
                .to_vec(),
            houses: vec![house("1", vec![volume(0, 100)]), house("2", vec![volume(0, 100), volume(900, 100)])],
            ..CityPlan::default()
        };
        let parts = OverviewParts::new(&plan, 2, |pos| usize::from(pos.0 >= 3 * 1024));
        let ground = [patch(1, SurfaceKind::Grass)];
        let district = |cell, ground, houses| DistrictOf { cell, ground, houses, spans: &[] };
        let west = parts.overview(0, (at(0), at(9)), [district(4, &ground, &[1, 9]), district(5, &[], &[0])]);
        let east = parts.overview(1, (at(0), at(9)), []);
        let ids = |overview: &Overview| overview.streets.iter().map(|street| street.id.0).collect::<Vec<_>>();
        assert_eq!((ids(&west), ids(&east)), (vec![0, 1, 2], vec![3, 4, 5]));
        assert_eq!((west.ground.len(), west.ground[0].course, west.ground[0].z), (1, None, 3));
        let told = |cell, ground, houses| District { cell, ground, houses, spans: 0 };
        assert_eq!(west.districts, [told(4, 1, 2), told(5, 0, 1)]);
        assert_eq!(west.names.iter().map(|name| (name.house, &*name.number)).collect::<Vec<_>>(), [(0, "2"), (2, "1")]);
        let whole = Overview::of(&plan);
        assert_eq!(
            whole.ground.iter().map(|patch| patch.surface).collect::<Vec<_>>(),
            [SurfaceKind::Grass, SurfaceKind::Yard, SurfaceKind::Water]
        );
        assert_eq!(Overview::joined([&west, &east]).districts, west.districts);
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
