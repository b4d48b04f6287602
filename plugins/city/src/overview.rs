use serde::{Deserialize, Serialize};

use crate::{CityPlan, GridPolygon, GridPos, Id, ObjectKind, Place, PlanStreet, PlanTerrain, SurfaceKind, Volume, WaySpan};

/// What maps, search and routes need of a whole city, without its façades.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Overview {
    /// Elevations of the ground.
    #[serde(default, skip_serializing_if = "PlanTerrain::is_level")]
    pub terrain: PlanTerrain,
    /// Centre lines with names.
    pub streets: Vec<PlanStreet>,
    /// What covers the ground, and where.
    pub areas: Vec<(SurfaceKind, GridPolygon)>,
    /// A house's id, an outline, its highest point above the city's zero in grid steps. A house of several volumes has one
    /// entry for each outline that differs, one after another.
    pub houses: Vec<(Id, GridPolygon, i32)>,
    /// Names and numbers of those houses that have them.
    pub names: Vec<HouseName>,
    /// What stands in the streets.
    pub objects: Vec<(ObjectKind, GridPos)>,
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
    /// The overview of a plan.
    #[must_use]
    pub fn of(plan: &CityPlan) -> Self {
        let mut overview = Self {
            terrain: plan.terrain.clone(),
            streets: plan.streets.clone(),
            areas: plan.ground.iter().map(|patch| (patch.surface, patch.outline.clone())).collect(),
            objects: plan.objects.iter().map(|object| (object.kind, object.pos)).collect(),
            spans: plan.spans.clone(),
            places: plan.places.clone(),
            ..Self::default()
        };
        for house in &plan.houses {
            let first = overview.houses.len();
            let is_called = !house.name.is_empty() || !house.number.is_empty();
            if is_called && !house.volumes.is_empty() {
                let (name, number) = (house.name.clone(), house.number.clone());
                overview.names.push(HouseName { house: first as u32, name, number });
            }
            for volume in &house.volumes {
                overview.add_outline(house.id, first, volume);
            }
        }
        overview
    }

    /// Adds a volume's outline, or raises the equal one that the house has already from `first` on.
    fn add_outline(&mut self, id: Id, first: usize, volume: &Volume) {
        let top = volume.top();
        let known = self.houses.iter_mut().skip(first).find(|(_, outline, _)| *outline == volume.footprint);
        match known {
            Some((_, _, highest)) => *highest = top.max(*highest),
            None => self.houses.push((id, volume.footprint.clone(), top)),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{House, PlanRoof, Rgb, RoofShape};

    use super::*;

    #[test]
    fn storeys_stacked_on_one_outline_are_one_entry_with_the_highest_top() {
        let outline = |x| GridPolygon::simple(vec![GridPos(x, 0), GridPos(x + 9, 0), GridPos(x, 9)]);
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
            volumes: vec![volume(0, 100), volume(0, 300), volume(50, 20)],
            monument: None,
        };
        let plan = CityPlan { houses: vec![House { number: String::new(), ..house.clone() }, house], ..CityPlan::default() };
        let overview = Overview::of(&plan);
        assert_eq!(overview.houses[..2], [(Id(7), outline(0), 305), (Id(7), outline(50), 25)]);
        assert_eq!(overview.names, [HouseName { house: 2, name: String::new(), number: "12".to_owned() }]);
    }
}
