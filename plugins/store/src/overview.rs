use veduta_city::{CityPlan, GridPolygon, GridPos, Id, ObjectKind, PlanStreet, SurfaceKind, Volume};

use crate::blob::{BlobKind, pack, unpack};
use crate::wire::{WireOverview, from_bytes, to_bytes};
use crate::{BlobRef, StoreError, valid};

/// What maps, search and routes need of a whole city, without its façades.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Overview {
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
}

/// How people call a house.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct HouseName {
    /// Index of the house's first entry in [`Overview::houses`].
    pub house: u32,
    /// Name, may be empty if there is a number.
    pub name: String,
    /// House number, may be empty if there is a name.
    pub number: String,
}

/// Highest point of a volume, grid steps.
pub(crate) const fn top_of(eaves: i32, roof_height: i32) -> i32 {
    eaves.saturating_add(if roof_height > 0 { roof_height } else { 0 })
}

impl Overview {
    /// The overview of a plan.
    #[must_use]
    pub fn of(plan: &CityPlan) -> Self {
        let mut overview = Self {
            streets: plan.streets.clone(),
            areas: plan.ground.iter().map(|patch| (patch.surface, patch.outline.clone())).collect(),
            objects: plan.objects.iter().map(|object| (object.kind, object.pos)).collect(),
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
        let top = top_of(volume.eaves, volume.roof.height);
        let known = self.houses.iter_mut().skip(first).find(|(_, outline, _)| *outline == volume.footprint);
        match known {
            Some((_, _, highest)) => *highest = top.max(*highest),
            None => self.houses.push((id, volume.footprint.clone(), top)),
        }
    }

    /// Stored form.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        pack(BlobKind::Overview, &to_bytes(&WireOverview::from(self)))
    }

    /// The overview of stored bytes that the reference stands for.
    ///
    /// # Errors
    /// If the bytes are not those, cannot be decoded, or contradict themselves.
    pub fn decode(stored: &[u8], blob: &BlobRef) -> Result<Self, StoreError> {
        let what = BlobKind::Overview.words();
        let wire: WireOverview = from_bytes(what, &unpack(BlobKind::Overview, stored, blob)?)?;
        let overview = Self::try_from(wire).map_err(|malformed| malformed.of(what))?;
        valid::check_overview(&overview).map_err(|reason| StoreError::Invalid { what, reason })?;
        Ok(overview)
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::{House, PlanRoof, Rgb, RoofShape};

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
            walls: Vec::new(),
        };
        let house = House {
            id: Id(7),
            name: String::new(),
            number: "12".to_owned(),
            style: 0,
            volumes: vec![volume(0, 100), volume(0, 300), volume(50, 20)],
        };
        let plan = CityPlan { houses: vec![House { number: String::new(), ..house.clone() }, house], ..CityPlan::default() };
        let overview = Overview::of(&plan);
        assert_eq!(overview.houses[..2], [(Id(7), outline(0), 305), (Id(7), outline(50), 25)]);
        assert_eq!(overview.names, [HouseName { house: 2, name: String::new(), number: "12".to_owned() }]);
        let stored = overview.encode();
        assert_eq!(Overview::decode(&stored, &BlobRef::of(&stored)), Ok(overview));
    }
}
