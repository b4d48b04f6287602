//! Monuments in place of buildings' walls and roofs, and of what objects of a kind look like.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;
use veduta_city::{
    CityGraph, Design, Finding, GridPolygon, GridPos, House, Id, MonumentTag, Monuments, PlacedMonument, PlanObject, Ring,
    Severity, StandIn,
};

use super::furniture::Piece;

/// The designs of a city, each once, in the order in which they are first needed.
pub(super) struct Designs<'a> {
    stock: &'a Monuments,
    models: &'a [Design],
    list: Vec<Design>,
    known: HashMap<Design, u16>,
}

impl<'a> Designs<'a> {
    pub fn new(stock: &'a Monuments, models: &'a [Design]) -> Self {
        Self { stock, models, list: Vec::new(), known: HashMap::new() }
    }

    pub fn finish(self) -> Vec<Design> {
        self.list
    }

    /// Number of a monument's design with some parameters, or why there is none.
    fn number(&mut self, name: &str, with: &BTreeMap<String, f64>) -> Result<u16, String> {
        let model = self.models.iter().find(|model| model.name == name);
        let design = match model {
            Some(model) if with.is_empty() => model.clone(),
            Some(_) => return Err(format!("`{name}` is a model from a file and has no parameters")),
            None => self.stock.design(name, with).map_err(|error| error.to_string())?,
        };
        if let Some(&number) = self.known.get(&design) {
            return Ok(number);
        }
        let number = u16::try_from(self.list.len()).map_err(|_| "more than 65,536 different monuments".to_owned())?;
        self.list.push(design.clone());
        self.known.insert(design, number);
        Ok(number)
    }

    /// Puts the monuments that a graph names in place of their buildings. A building whose monument cannot be made keeps its walls and
    /// roofs.
    pub fn of_houses(&mut self, graph: &CityGraph, houses: &mut [House], findings: &mut Vec<Finding>) {
        let tagged =
            graph.buildings.iter().filter_map(|building| Some((building.id, (building.monument.as_ref()?, &building.outline))));
        let tags: HashMap<Id, (&MonumentTag, &Ring)> = tagged.collect();
        for house in houses {
            let Some(&(tag, outline)) = tags.get(&house.id) else { continue };
            let middle = || GridPolygon::simple(outline.iter().map(|&p| GridPos::from_metres(p)).collect()).centroid();
            let pos = tag.pos.unwrap_or_else(middle);
            match self.number(&tag.name, &tag.with) {
                Ok(design) => house.monument = Some(placed(house, design, pos, tag.heading_deg)),
                Err(why) => findings.push(without(house.id, pos, "building", &why)),
            }
        }
    }

    /// Puts in place of finished houses what is to be seen there. What finds no house, or cannot be made, is told.
    pub fn stand_in(&mut self, graph: &CityGraph, houses: &mut [House], findings: &mut Vec<Finding>) {
        for StandIn { target, monument: tag } in &graph.stand_ins {
            let holds = |house: &House| house.volumes.iter().any(|v| v.footprint.contains(GridPos::from_metres(target.at)));
            let known = houses.iter().position(|house| target.id != Id::NONE && house.id == target.id);
            let Some(house) = known.or_else(|| houses.iter().position(holds)).map(|found| &mut houses[found]) else {
                let message = format!("house: none of that id, and none at that place, to be seen as `{}`", tag.name);
                findings.push(Finding::new(Severity::Dropped, target.id, Some(target.at), message));
                continue;
            };
            let pos = tag.pos.unwrap_or(target.at);
            match self.number(&tag.name, &tag.with) {
                Ok(design) => house.monument = Some(placed(house, design, pos, tag.heading_deg)),
                Err(why) => findings.push(without(house.id, pos, "house", &why)),
            }
        }
    }

    /// The same for objects. A height that is given is the monument's, if it has a parameter of that name.
    pub fn of_objects(&mut self, given: &[Piece<'_>], objects: &mut [PlanObject], findings: &mut Vec<Finding>) {
        let named: HashMap<Id, &Piece<'_>> = given.iter().map(|piece| (piece.id, piece)).collect();
        for object in objects {
            let Some(given) = named.get(&object.id) else { continue };
            let has_height = self.stock.find(given.monument).is_some_and(|m| m.parameters.contains_key("height"));
            let height = (given.height_m > 0.0 && has_height).then(|| ("height".to_owned(), given.height_m));
            match self.number(given.monument, &height.into_iter().collect()) {
                Ok(design) => object.monument = Some(design),
                Err(why) => findings.push(without(object.id, given.pos, "object", &why)),
            }
        }
    }
}

/// Something on the floor of a house.
fn placed(house: &House, design: u16, pos: DVec2, heading_deg: f64) -> PlacedMonument {
    let z = house.volumes.iter().map(|volume| volume.bottom).min().unwrap_or(0);
    PlacedMonument { design, pos: GridPos::from_metres(pos), z, heading: heading(heading_deg) }
}

fn without(id: Id, pos: DVec2, what: &str, why: &str) -> Finding {
    Finding::new(Severity::Repaired, id, Some(pos), format!("{what}: {why}; it stands as if it had no monument"))
}

/// Hundredths of a degree, 0 to 35,999.
fn heading(degrees: f64) -> u16 {
    let turned = libm::fmod(libm::fmod(degrees, 360.0) + 360.0, 360.0);
    (libm::round(turned * 100.0) as i32 % 36_000) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Growth, Stock, grow};

    fn grown(building: &str, objects: &str) -> Growth {
        let text = format!(
            "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (-40, 0)), (id: 2, pos: (40, 0))],
              links: [(from: 1, to: 2, kind: Street(Lane))],
              buildings: [(id: 7, outline: [(0, 10), (4, 10), (4, 14), (0, 14)], {building})], objects: [{objects}])"
        );
        let graph: CityGraph = veduta_city::file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"));
        grow(&graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_building_and_an_object_of_one_design_share_it() {
        let object = "(kind: Statue, pos: (20, 12), heading_deg: 90, height_m: 9, monument: \"obelisk\")";
        let growth = grown("monument: (name: \"obelisk\", heading_deg: -90.5, with: {\"height\": 9})", object);
        assert_eq!(growth.findings, []);
        let placed = growth.plan.houses[0].monument.expect("a monument");
        assert_eq!((placed.pos, placed.heading), (GridPos::from_metres(DVec2::new(2.0, 12.0)), 26_950));
        assert_eq!((growth.plan.designs.len(), growth.plan.objects[0].monument), (1, Some(placed.design)));
    }

    #[test]
    fn what_cannot_be_made_is_told_and_stands_without() {
        let growth = grown("monument: (name: \"obelix\")", "(kind: Statue, pos: (20, 12), monument: \"\")");
        assert!(growth.plan.houses[0].monument.is_none() && growth.plan.designs.is_empty());
        let told: Vec<&str> = growth.findings.iter().map(|f| f.message.as_str()).collect();
        assert!(told.len() == 1 && told[0].starts_with("building: there is no monument `obelix`; there are:"), "{told:?}");
    }

    #[test]
    fn headings_go_once_round() {
        assert_eq!([0.0, 359.999, -0.004, 725.5, 1e9].map(heading), [0, 0, 0, 550, 28_000]);
    }
}
