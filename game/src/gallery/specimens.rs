use std::collections::BTreeMap;
use std::fmt::Write;

use bevy::math::DVec2;
use veduta_bake::{Stock, monument_bounds};
use veduta_city::{CityGraph, ObjectKind, file};

use super::{Sheet, Specimen};
use crate::Failure;

/// The town of a sheet's specimens, which stand in a row from west to east along a street, and where each is looked at from.
///
/// # Errors
/// If a monument of the stock cannot be built, or the sheet is none of [`Sheet::SPECIMENS`].
pub fn specimens(sheet: Sheet) -> Result<(CityGraph, Vec<Specimen>), Failure> {
    let mut town = Town::default();
    match sheet {
        Sheet::Views | Sheet::Levels => return Err("views and levels are of a city that there is, not of specimens".into()),
        Sheet::Styles => styles(&mut town),
        Sheet::Roofs => roofs(&mut town),
        Sheet::Monuments => monuments(&mut town)?,
        Sheet::Crossings => crossings(&mut town),
        Sheet::Furniture => furniture(&mut town),
    }
    Ok((town.graph()?, town.specimens))
}

/// A graph in the making, as text, because that is the shortest way to write one.
#[derive(Default)]
struct Town {
    nodes: String,
    links: String,
    squares: String,
    blocks: String,
    buildings: String,
    objects: String,
    node_count: u32,
    specimens: Vec<Specimen>,
    /// Where the next specimen begins, metres east.
    east: f64,
}

impl Town {
    fn node(&mut self, x: f64, y: f64) -> u32 {
        self.node_count += 1;
        let _infallible = write!(self.nodes, "(id: {}, pos: ({x}, {y})),", self.node_count);
        self.node_count
    }

    fn link(&mut self, from: u32, to: u32, class: &str) {
        self.way(from, to, &format!("Street({class})"), 0);
    }

    fn way(&mut self, from: u32, to: u32, kind: &str, layer: i8) {
        let _infallible = write!(self.links, "(from: {from}, to: {to}, kind: {kind}, layer: {layer}),");
    }

    /// A cobbled place in front of what is looked at.
    fn square(&mut self, low: DVec2, high: DVec2) {
        let _infallible = write!(self.squares, "(outline: {}),", rectangle(low, high));
    }

    fn specimen(&mut self, name: &str, plan_pos: DVec2, eye_m: f64, (heading_deg, pitch_deg): (f64, f64)) {
        self.specimens.push(Specimen { name: name.to_owned(), plan_pos, eye_m, heading_deg, pitch_deg });
    }

    fn graph(&mut self) -> Result<CityGraph, Failure> {
        // A street along the whole row, so that the town can be walked.
        let (west, east) = (self.node(-60.0, -70.0), self.node(self.east + 60.0, -70.0));
        self.link(west, east, "Street");
        let Self { nodes, links, squares, blocks, buildings, objects, .. } = self;
        let text = format!(
            "(name: \"Gallery\", anchor: (lat: 50.09, lon: 14.42), seed: 7, margin_m: 60, nodes: [{nodes}], links: [{links}],
              squares: [{squares}], blocks: [{blocks}], buildings: [{buildings}], objects: [{objects}])"
        );
        Ok(file::parse(&text, "gallery.graph.ron")?)
    }
}

fn ring(points: &[(f64, f64)]) -> String {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("({x}, {y})")).collect();
    format!("[{}]", points.join(","))
}

fn rectangle(low: DVec2, high: DVec2) -> String {
    ring(&[(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)])
}

/// Styles of single buildings, which no district is grown in.
const SINGLE: [&str; 4] = ["church", "tower", "clock_tower", "monument"];

fn styles(town: &mut Town) {
    for style in Stock::new().styles.0 {
        let x = town.east + 60.0;
        town.east += 150.0;
        town.square(DVec2::new(x - 60.0, -60.0), DVec2::new(x + 60.0, 0.0));
        if SINGLE.contains(&style.name.as_str()) {
            let half = (style.frontage_m.0 + style.frontage_m.1) / 4.0;
            let depth = (style.depth_m.0 + style.depth_m.1) / 2.0;
            let outline = rectangle(DVec2::new(x - half, 0.0), DVec2::new(x + half, depth));
            let _infallible = write!(town.buildings, "(outline: {outline}, style: {:?}),", style.name);
            let storeys = f64::from(style.storeys.0 + style.storeys.1) / 2.0;
            let height = 1.4 * ((storeys - 1.0) * style.storey_m.1 + style.ground_floor_m.1);
            let far = (1.35 * height).max(2.4 * half + 8.0);
            town.specimen(&style.name, DVec2::new(x - 0.42 * far, -0.9 * far), 1.65 + 0.12 * height, (25.0, 14.0));
        } else {
            let outline = rectangle(DVec2::new(x - 48.0, 0.0), DVec2::new(x + 48.0, 46.0));
            let _infallible = write!(town.blocks, "(outline: {outline}, district: {:?}),", style.name);
            let height = f64::from(style.storeys.1) * style.storey_m.1 + 6.0;
            let far = (1.5 * height).clamp(22.0, 56.0);
            town.specimen(&style.name, DVec2::new(x - 0.35 * far, -far), 1.65 + 0.08 * height, (18.0, 8.0));
        }
    }
}

/// Names of roof shapes, in the order in which they are known.
const ROOFS: [&str; 13] = [
    "Flat",
    "Gabled",
    "Hipped",
    "HalfHipped",
    "Pyramidal",
    "Skillion",
    "Mansard",
    "Gambrel",
    "Dome",
    "Onion",
    "Cone",
    "Round",
    "SawTooth",
];

/// Footprints that are no rectangles, each with the roof that it is to have.
const ODD: [(&str, &str, &[(f64, f64)]); 6] = [
    ("ell", "Hipped", &[(0.0, 0.0), (18.0, 0.0), (18.0, 8.0), (8.0, 8.0), (8.0, 17.0), (0.0, 17.0)]),
    ("tee", "Hipped", &[(0.0, 0.0), (20.0, 0.0), (20.0, 8.0), (14.0, 8.0), (14.0, 18.0), (6.0, 18.0), (6.0, 8.0), (0.0, 8.0)]),
    ("you", "Mansard", &[(0.0, 0.0), (22.0, 0.0), (22.0, 18.0), (14.0, 18.0), (14.0, 8.0), (8.0, 8.0), (8.0, 18.0), (0.0, 18.0)]),
    ("slant", "Gabled", &[(0.0, 0.0), (16.0, 2.0), (18.0, 14.0), (3.0, 11.0)]),
    ("octagon", "Pyramidal", &[(4.0, 0.0), (9.0, 0.0), (13.0, 4.0), (13.0, 9.0), (9.0, 13.0), (4.0, 13.0), (0.0, 9.0), (0.0, 4.0)]),
    ("star", "Hipped", &[(8.0, 0.0), (10.5, 5.5), (16.0, 8.0), (10.5, 10.5), (8.0, 16.0), (5.5, 10.5), (0.0, 8.0), (5.5, 5.5)]),
];

fn roofs(town: &mut Town) {
    let plain: &[(f64, f64)] = &[(0.0, 0.0), (16.0, 0.0), (16.0, 10.0), (0.0, 10.0)];
    let square: &[(f64, f64)] = &[(2.0, 0.0), (12.0, 0.0), (12.0, 10.0), (2.0, 10.0)];
    let shaped = ROOFS.map(|shape| {
        let is_turned = matches!(shape, "Pyramidal" | "Dome" | "Onion" | "Cone");
        (shape.to_lowercase(), shape, if is_turned { square } else { plain })
    });
    let odd = ODD.map(|(name, shape, outline)| (format!("{name}_{}", shape.to_lowercase()), shape, outline));
    for (name, shape, outline) in shaped.into_iter().chain(odd) {
        let x = town.east + 40.0;
        town.east += 70.0;
        town.square(DVec2::new(x - 30.0, -60.0), DVec2::new(x + 32.0, 26.0));
        let height = match shape {
            "Flat" => 0.0,
            "Skillion" | "SawTooth" => 2.6,
            "Onion" => 9.0,
            _ => 5.0,
        };
        let outline: Vec<(f64, f64)> = outline.iter().map(|&(u, v)| (x + u, v)).collect();
        let _infallible = write!(
            town.buildings,
            "(outline: {}, style: \"old_town\", levels: 2, height_m: {}, roof: (shape: {shape}, height_m: {height})),",
            ring(&outline),
            7.5 + height
        );
        town.specimen(&name, DVec2::new(x - 12.0, -24.0), 19.0, (35.0, -20.0));
    }
}

fn monuments(town: &mut Town) -> Result<(), Failure> {
    let monuments = Stock::new().monuments;
    for monument in &monuments.0 {
        let (low, high) = monument_bounds(&monuments.design(&monument.name, &BTreeMap::new())?);
        let (size, middle) = (high - low, (high + low) / 2.0);
        let reach = size.x.max(size.y).max(size.z).max(1.0);
        let x = town.east + size.x / 2.0 + 30.0 + reach;
        town.east = x + size.x / 2.0 + reach;
        let around = DVec2::new(size.x / 2.0 + 6.0, 0.0);
        town.square(DVec2::new(x, -60.0) - around, DVec2::new(x, size.y + 6.0) + around);
        // Its least corner on y = 0; something to stand on where it is thin.
        let half = DVec2::new(size.x, size.y).max(DVec2::splat(1.0)) / 2.0;
        let at = DVec2::new(x, half.y);
        let _infallible = write!(
            town.buildings,
            "(outline: {}, height_m: {}, monument: (name: {:?}, pos: ({}, {}), heading_deg: 180)),",
            rectangle(at - half, at + half),
            size.z.max(1.0),
            monument.name,
            at.x - middle.x,
            at.y - middle.y
        );
        let far = 1.25 * DVec2::new(size.x, size.y).length().max(size.z) + size.y / 2.0 + 0.6;
        let (turn, eye_m) = (25.0_f64.to_radians(), low.z.max(0.0) + 0.35 * size.z + 0.25 * size.x.max(size.y).min(size.z));
        let stand = at - DVec2::new(turn.sin(), turn.cos()) * far;
        let pitch = ((size.z / 2.0 + low.z - eye_m) / far).atan().to_degrees();
        town.specimen(&monument.name, stand, eye_m, (25.0, pitch));
    }
    Ok(())
}

/// Arms of the crossings: headings in degrees, and the classes of their streets by turns.
const CROSSINGS: [(&str, &[f64], &[&str]); 10] = [
    ("three_at_90", &[0.0, 90.0, 270.0], &["Street"]),
    ("three_at_35", &[0.0, 35.0, 190.0], &["Street", "Lane"]),
    ("four_at_90", &[0.0, 90.0, 180.0, 270.0], &["Main", "Street"]),
    ("four_askew", &[10.0, 75.0, 205.0, 250.0], &["Street", "Lane"]),
    ("five", &[0.0, 60.0, 130.0, 205.0, 290.0], &["Main", "Street"]),
    ("six", &[0.0, 55.0, 120.0, 180.0, 230.0, 300.0], &["Main", "Street", "Lane"]),
    ("seven", &[5.0, 50.0, 105.0, 160.0, 205.0, 260.0, 310.0], &["Street"]),
    ("eight", &[0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0], &["Street"]),
    ("two_at_15", &[0.0, 15.0, 180.0], &["Street"]),
    ("a_bend", &[0.0, 100.0], &["Main"]),
];

/// What leads over what.
const OVERPASSES: [(&str, &str, &str); 3] = [
    ("a_street_over_a_street", "Street(Main)", "Street(Street)"),
    ("a_street_over_rails", "Street(Street)", "Railway(tram: false)"),
    ("rails_over_a_street", "Railway(tram: false)", "Street(Main)"),
];

/// What leads under a street.
const TUNNELS: [(&str, &str); 3] = [
    ("a_street_under_a_street", "Street(Main)"),
    ("a_footway_under_a_street", "Street(Path)"),
    ("rails_under_a_street", "Railway(tram: false)"),
];

fn crossings(town: &mut Town) {
    for (name, arms, classes) in CROSSINGS {
        let x = town.east + 100.0;
        town.east += 200.0;
        let middle = town.node(x, 40.0);
        for (heading, class) in arms.iter().zip(classes.iter().cycle()) {
            let way = DVec2::new(heading.to_radians().sin(), heading.to_radians().cos()) * 70.0;
            let end = town.node(x + way.x, 40.0 + way.y);
            town.link(middle, end, class);
        }
        town.specimen(name, DVec2::new(x, -4.0), 46.0, (0.0, -45.0));
    }
    for (name, over, below) in OVERPASSES {
        let x = town.east + 170.0;
        town.east += 340.0;
        let ends = [-150.0, -18.0, 18.0, 150.0].map(|along| town.node(x + along, 40.0));
        for (pair, layer) in ends.windows(2).zip([0, 1, 0]) {
            town.way(pair[0], pair[1], over, layer);
        }
        let (south, north) = (town.node(x, -110.0), town.node(x, 190.0));
        town.way(south, north, below, 0);
        town.specimen(name, DVec2::new(x - 14.0, -4.0), 9.0, (18.0, -8.0));
    }
    for (name, below) in TUNNELS {
        let x = town.east + 330.0;
        town.east += 660.0;
        let ends = [-320.0, -20.0, 20.0, 320.0].map(|along| town.node(x + along, 40.0));
        for (pair, layer) in ends.windows(2).zip([0, -1, 0]) {
            town.way(pair[0], pair[1], below, layer);
        }
        let (south, north) = (town.node(x, -110.0), town.node(x, 190.0));
        town.way(south, north, "Street(Street)", 0);
        town.specimen(name, DVec2::new(x - 38.0, 40.0), 2.4, (90.0, 3.0));
    }
}

/// Every kind of object.
fn furniture(town: &mut Town) {
    for kind in ObjectKind::ALL {
        let x = town.east + 40.0;
        town.east += 60.0;
        town.square(DVec2::new(x - 28.0, -60.0), DVec2::new(x + 28.0, 20.0));
        let _infallible = write!(town.objects, "(kind: {kind:?}, pos: ({x}, 0), heading_deg: 180),");
        let height: f64 = match kind {
            ObjectKind::Poplar | ObjectKind::Palm => 12.0,
            ObjectKind::Birch | ObjectKind::Willow => 9.0,
            ObjectKind::FruitTree => 5.0,
            kind if kind.is_tree() => 11.0,
            ObjectKind::Lamp | ObjectKind::Statue | ObjectKind::Fountain => 4.5,
            ObjectKind::Bollard | ObjectKind::Bin => 1.3,
            ObjectKind::Hedge | ObjectKind::Planter | ObjectKind::Shrub | ObjectKind::Bench => 2.0,
            _ => 3.2,
        };
        let far = 1.9 * height;
        let eye_m = 0.6 * height;
        let pitch = ((0.45 * height - eye_m) / far).atan().to_degrees();
        town.specimen(&format!("{kind:?}").to_lowercase(), DVec2::new(x - 0.45 * far, -0.9 * far), eye_m, (26.5, pitch));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sheet_is_a_sound_town() {
        for &sheet in &Sheet::SPECIMENS {
            let (mut graph, specimens) = specimens(sheet).unwrap_or_else(|e| panic!("{sheet:?}: {e}"));
            graph.fill_ids();
            assert_eq!(graph.validate(), [], "{sheet:?}");
            let mut names: Vec<&str> = specimens.iter().map(|s| s.name.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            assert!(names.len() == specimens.len() && names.len() >= 9, "{sheet:?}: {names:?}");
        }
    }
}
