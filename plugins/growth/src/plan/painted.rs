//! Painted façades find their walls.

use glam::DVec2;
use veduta_city::{Finding, GRID_PER_METRE, House, Id, PlacedFacade, PlanFacade, Severity, WallKind, metres};

/// Farthest that a façade's place may be from its wall, metres.
const REACH_M: f64 = 5.0;
/// By how much of its own a picture's width may differ from its wall's before somebody is told.
const STRETCH: f64 = 0.15;

/// Puts façades on the walls that they are meant for, and gives these the façade's colour and height. What finds no wall is told.
pub(super) fn hang(facades: &[PlacedFacade], houses: &mut [House], findings: &mut Vec<Finding>) -> Vec<PlanFacade> {
    let mut hung: Vec<PlanFacade> = Vec::new();
    for facade in facades {
        let mut told = |severity, id: Id, message: String| {
            findings.push(Finding::new(severity, id, Some(facade.at), format!("façade `{}`: {message}", facade.name)));
        };
        let Some((wall, length_m)) = nearest(houses, facade.at) else {
            told(Severity::Dropped, Id::NONE, format!("no wall on a street within {REACH_M} m of that place"));
            continue;
        };
        if hung.iter().any(|other| other.wall == wall) {
            told(Severity::Dropped, houses[wall.0 as usize].id, "another façade is on that wall already".to_owned());
            continue;
        }
        let house = &mut houses[wall.0 as usize];
        let width_m = metres(facade.painted.size.0);
        if (length_m / width_m - 1.0).abs() > STRETCH {
            told(
                Severity::Note,
                house.id,
                format!("its picture is {width_m:.1} m wide and its wall {length_m:.1} m: it is stretched"),
            );
        }
        let is_built_upon = |eaves: i32| house.volumes.iter().any(|other| (other.bottom - eaves).abs() < GRID_PER_METRE / 4);
        let volume = &house.volumes[usize::from(wall.1)];
        let eaves = volume.bottom.saturating_add(facade.eaves);
        if is_built_upon(volume.eaves) && (volume.eaves - eaves).abs() > GRID_PER_METRE / 4 {
            let message = format!("something stands on its wall, which stays {:.1} m high", metres(volume.eaves - volume.bottom));
            told(Severity::Note, house.id, message);
        } else {
            house.volumes[usize::from(wall.1)].eaves = eaves;
        }
        house.volumes[usize::from(wall.1)].colour = facade.painted.colour;
        hung.push(PlanFacade { wall, painted: facade.painted.clone(), pictures: facade.pictures.clone() });
    }
    hung.sort_by_key(|facade| facade.wall);
    hung
}

/// House, volume and wall of the street front that is nearest to a place, and its length in metres.
fn nearest(houses: &[House], at: DVec2) -> Option<((u32, u16, u16), f64)> {
    let fronts = (0_u32..).zip(houses).filter(|(_, house)| house.monument.is_none()).flat_map(|(h, house)| {
        (0_u16..).zip(&house.volumes).flat_map(move |(v, volume)| {
            (0_u16..)
                .zip(volume.walls.iter().zip(volume.footprint.edges()))
                .map(move |(w, (wall, edge))| ((h, v, w), wall.kind, edge))
        })
    });
    let near = fronts.filter(|(_, kind, _)| *kind == WallKind::Street).filter_map(|(wall, _, (a, b))| {
        let (a, b) = (a.to_metres(), b.to_metres());
        let share = (at - a).dot(b - a) / (b - a).length_squared().max(1e-9);
        let away = at.distance(a.lerp(b, share.clamp(0.0, 1.0)));
        (away <= REACH_M).then_some((away, wall, a.distance(b)))
    });
    near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, wall, length_m)| (wall, length_m))
}

#[cfg(test)]
mod tests {
    use veduta_city::{CityGraph, PaintedFacade, Rgb};

    use super::*;
    use crate::plan::{Growth, Stock, grow};

    fn grown(at: &[(f64, f64)]) -> Growth {
        let graph: CityGraph = veduta_city::file::parse(
            "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (-40, 0)), (id: 2, pos: (40, 0))],
              links: [(from: 1, to: 2, kind: Street(Lane))],
              buildings: [(id: 7, outline: [(0, 4), (10, 4), (10, 14), (0, 14)], height_m: 12)])",
            "t",
        )
        .unwrap_or_else(|e| panic!("{e}"));
        let painted = PaintedFacade { size: (12 * 1024, 15 * 1024), sections: 1, colour: Rgb(9, 8, 7), ..PaintedFacade::default() };
        let facade = |&at: &(f64, f64)| PlacedFacade {
            name: "test".to_owned(),
            at: at.into(),
            eaves: 14 * 1024,
            painted: painted.clone(),
            pictures: Vec::new(),
        };
        let stock = Stock { facades: at.iter().map(facade).collect(), ..Stock::new() };
        grow(&graph, &stock).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_facade_finds_its_wall_and_gives_it_colour_and_height() {
        let Growth { plan, findings } = grown(&[(5.0, 3.0)]);
        let [facade] = &*plan.facades else { panic!("one façade") };
        let (h, v, w) = facade.wall;
        let volume = &plan.houses[h as usize].volumes[usize::from(v)];
        assert_eq!((volume.colour, volume.eaves - volume.bottom), (Rgb(9, 8, 7), 14 * 1024));
        assert_eq!(volume.walls[usize::from(w)].kind, WallKind::Street);
        let told: Vec<&str> = findings.iter().map(|f| f.message.as_str()).collect();
        assert_eq!(told, ["façade `test`: its picture is 12.0 m wide and its wall 10.0 m: it is stretched"]);
    }

    #[test]
    fn what_finds_no_wall_or_a_taken_one_is_told() {
        let Growth { plan, findings } = grown(&[(5.0, 3.0), (7.0, 3.5), (5.0, -30.0)]);
        assert_eq!(plan.facades.len(), 1);
        let told: Vec<&str> = findings.iter().map(|f| f.message.as_str()).filter(|m| !m.contains("stretched")).collect();
        let expected = [
            "façade `test`: another façade is on that wall already",
            "façade `test`: no wall on a street within 5 m of that place",
        ];
        assert_eq!(told, expected);
    }
}
