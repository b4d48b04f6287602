//! Plans, cells and packets in a few readable lines, each text with its counts first.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;
use veduta_cells::{cell_shells, facade_sheets};
use veduta_city::{Cells, CityPlan, GridPolygon, House, PortalSide, SurfaceKind};

/// FNV-1a: no secret, only a fingerprint that needs no crate.
#[must_use]
pub fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}

fn hash_of<T: Serialize>(value: &T) -> String {
    let text = ron::to_string(value).unwrap_or_else(|e| panic!("{e}"));
    format!("{:016x}", hash(&text))
}

fn ring(polygon: &GridPolygon) -> String {
    let vertex = |p: &veduta_city::GridPos| format!("{:.2},{:.2}", p.to_metres().x, p.to_metres().y);
    let outer: Vec<String> = polygon.outer.iter().map(vertex).collect();
    let holes = if polygon.holes.is_empty() { String::new() } else { format!(" less {} holes", polygon.holes.len()) };
    format!("{}{holes}", outer.join(" "))
}

fn list(of: &[u32]) -> String {
    of.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Ground by surface, houses volume by volume, objects, streets, places; hashes of all of each kind.
#[must_use]
pub fn plan(plan: &CityPlan) -> String {
    let mut text = String::new();
    let mut line = |words: String| writeln!(text, "{words}").unwrap_or_else(|e| panic!("{e}"));
    line(format!("# {} houses, {}", plan.houses.len(), hash_of(&plan.houses)));
    line(format!("# {} patches of ground, {}", plan.ground.len(), hash_of(&plan.ground)));
    line(format!("# {} objects, {}", plan.objects.len(), hash_of(&plan.objects)));
    line(format!("# {} streets, {}", plan.streets.len(), hash_of(&plan.streets)));
    line(format!("# {} places, {}", plan.places.len(), hash_of(&plan.places)));
    line(format!("extent {}", ring(&plan.extent)));
    line(format!("start {:.2},{:.2} heading {:.1}", plan.start.pos.x, plan.start.pos.y, plan.start.heading_deg));
    let mut ground: BTreeMap<SurfaceKind, (usize, f64)> = BTreeMap::new();
    for patch in &plan.ground {
        let sum = ground.entry(patch.surface).or_default();
        *sum = (sum.0 + 1, sum.1 + patch.outline.area_m2());
    }
    for (surface, (patches, m2)) in ground {
        line(format!("ground {surface:?}: {m2:.1} m² in {patches} patches"));
    }
    for h in &plan.houses {
        line(house(plan, h));
    }
    for o in &plan.objects {
        line(format!("object {} {:?} at {:.2},{:.2}", o.id, o.kind, o.pos.to_metres().x, o.pos.to_metres().y));
    }
    for s in &plan.streets {
        line(format!("street {} “{}” {} vertices, {:.1} m wide", s.id, s.name, s.line.len(), f64::from(s.width) / 1024.0));
    }
    for p in &plan.places {
        line(format!("place {:?} “{}” at {:.2},{:.2}", p.kind, p.name, p.pos.x, p.pos.y));
    }
    text
}

fn house(plan: &CityPlan, house: &House) -> String {
    let style = plan.styles.0.get(usize::from(house.style)).map_or("?", |s| &s.name);
    let mut text = format!("house {} “{}” {} {style}", house.id, house.name, house.number);
    for v in &house.volumes {
        let m = |steps: i32| f64::from(steps) / 1024.0;
        let bays: Vec<String> = v.walls.iter().map(|w| format!("{}×{}", w.bays, w.storeys.len())).collect();
        text += &format!(
            "\n  {} | {:.2} to {:.2} m, roof {:?} {:.2} m | {}",
            ring(&v.footprint),
            m(v.bottom),
            m(v.eaves),
            v.roof.shape,
            m(v.roof.height),
            bays.join(" ")
        );
        for (i, ornament) in v.walls.iter().enumerate().filter_map(|(i, wall)| Some((i, wall.ornament.as_deref()?))) {
            text += &format!("\n    wall {i}: {}", ron::to_string(ornament).unwrap_or_else(|e| panic!("{e}")));
        }
    }
    text
}

/// Cells with what belongs to them and what they see, portals.
#[must_use]
pub fn cells(cells: &Cells) -> String {
    let mut text = String::new();
    let mut line = |words: String| writeln!(text, "{words}").unwrap_or_else(|e| panic!("{e}"));
    line(format!("# {} cells, {}", cells.cells.len(), hash_of(&cells.cells)));
    line(format!("# {} portals, {}", cells.portals.len(), hash_of(&cells.portals)));
    let seen: usize = cells.visible.iter().map(Vec::len).sum();
    line(format!("# {seen} times a cell sees another, {}", hash_of(&cells.visible)));
    let far: usize = cells.far.iter().map(Vec::len).sum();
    line(format!("# {far} times a cell sees a square far away, {}", hash_of(&cells.far)));
    line(format!("skyline {}", list(&cells.skyline)));
    for (i, (cell, seen)) in cells.cells.iter().zip(&cells.visible).enumerate() {
        let yards = cell.yards.iter().map(GridPolygon::area_m2).fold(0.0, |sum, m2| sum + m2);
        line(format!(
            "cell {i} {} “{}” {:.1} m², yards {yards:.1} m², {} walls, roofs {} | sees {}",
            cell.id,
            cell.name,
            cell.outline.area_m2(),
            cell.walls.len(),
            list(&cell.houses),
            list(seen)
        ));
    }
    for p in &cells.portals {
        let beyond = match p.beyond {
            PortalSide::Cell(cell) => cell.to_string(),
            PortalSide::Edge => "edge".to_owned(),
        };
        let (a, b) = (p.ends.0.to_metres(), p.ends.1.to_metres());
        line(format!("portal {}–{beyond} {:.2},{:.2} {:.2},{:.2}", p.cell, a.x, a.y, b.x, b.y));
    }
    text
}

/// What travels for each cell, before it is compressed.
#[must_use]
pub fn packets(plan: &CityPlan, cells: &Cells) -> String {
    let (shells, sheets) = (cell_shells(plan, cells), facade_sheets(plan, cells));
    let mut text = format!("# {} shells, {}\n# {} sheets, {}\n", shells.len(), hash_of(&shells), sheets.len(), hash_of(&sheets));
    for (i, (shell, sheet)) in shells.iter().zip(&sheets).enumerate() {
        let volumes: usize = shell.houses.iter().map(|h| h.volumes.len()).sum();
        let openings: usize = sheet.walls.iter().map(|w| usize::from(w.bays) * w.storeys.len()).sum();
        let m2: f64 = shell.ground.iter().map(|p| p.outline.area_m2()).sum();
        let line = format!(
            "packet {i}: {} patches {m2:.1} m², {volumes} volumes, {} objects, {} blind portals, {} walls, {openings} openings | {} {}\n",
            shell.ground.len(),
            shell.objects.len(),
            shell.blind.len(),
            sheet.walls.len(),
            hash_of(shell),
            hash_of(sheet)
        );
        text += &line;
    }
    text
}
