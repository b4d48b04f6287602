//! Monuments in place of buildings' walls and roofs.

use std::collections::HashMap;

use veduta_city::{CityGraph, Design, Finding, GridPos, House, Id, MonumentTag, Monuments, PlacedMonument, Severity};

/// Puts the monuments that a graph names in place of their buildings, and tells the designs that they refer to. A building whose
/// monument cannot be made keeps its walls and roofs.
pub(super) fn place(graph: &CityGraph, library: &Monuments, houses: &mut [House], findings: &mut Vec<Finding>) -> Vec<Design> {
    let tags: HashMap<Id, &MonumentTag> =
        graph.buildings.iter().filter_map(|building| Some((building.id, building.monument.as_ref()?))).collect();
    let mut designs: Vec<Design> = Vec::new();
    let mut known: HashMap<Design, u16> = HashMap::new();
    for house in houses {
        let Some(tag) = tags.get(&house.id) else { continue };
        let Some(first) = house.volumes.first() else { continue };
        let pos = tag.pos.unwrap_or_else(|| first.footprint.centroid());
        let mut told = |message: String| findings.push(Finding::new(Severity::Repaired, house.id, Some(pos), message));
        let design = match library.design(&tag.name, &tag.with) {
            Ok(design) => design,
            Err(error) => {
                told(format!("{error}: the building stands without it"));
                continue;
            }
        };
        let number = match known.get(&design) {
            Some(&number) => number,
            None => {
                let Ok(number) = u16::try_from(designs.len()) else {
                    told("more than 65,536 different monuments: the building stands without its own".to_owned());
                    continue;
                };
                designs.push(design.clone());
                known.insert(design, number);
                number
            }
        };
        let foot = house.volumes.iter().map(|volume| volume.bottom).min().unwrap_or(0);
        let heading = libm::round(libm::fmod(libm::fmod(tag.heading_deg, 360.0) + 360.0, 360.0) * 100.0) as i32 % 36_000;
        house.monument = Some(PlacedMonument { design: number, pos: GridPos::from_metres(pos), z: foot, heading: heading as u16 });
    }
    designs
}
