//! Given buildings as drafts of houses: valid footprints on the grid, tags checked, a style chosen.

use rustc_hash::FxHashSet;
use veduta_city::draw::Draw;
use veduta_city::{
    BlockKind, Building, CityGraph, Finding, GridPolygon, HIGHEST_M, Id, MOST_LEVELS, Opening, Rgb, RoofTags, Severity, Style,
    Styles,
};

use super::extent::Extent;
use super::index::Index;
use super::{Area, boolean, outline};
use veduta_city::bounds::do_meet;

/// Smaller footprints are left out; square metres.
const LEAST_M2: f64 = 1.0;
/// Footprints larger than this without a style of their own are halls and office blocks; square metres.
const LARGE_M2: f64 = 2_500.0;

/// A house before its heights, walls and looks are known.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub id: Id,
    pub name: String,
    pub number: String,
    /// Index of its style.
    pub style: usize,
    /// Draws for this house.
    pub draw: Draw,
    /// Set for a house grown on a lot.
    pub grown: Option<Grown>,
    /// Never empty.
    pub bodies: Vec<Body>,
}

/// What a grown house shares with its block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grown {
    /// Eaves of the block's row, metres.
    pub eaves_m: f64,
}

/// One volume in the making.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub footprint: GridPolygon,
    pub bottom_m: f64,
    /// To the ridge, above the ground.
    pub height_m: Option<f64>,
    pub levels: Option<f64>,
    pub roof: RoofTags,
    pub colour: Option<Rgb>,
    /// What its bays hold in place of what the style says.
    pub opening: Option<Opening>,
    /// Whether another body of the house stands on it.
    pub is_covered: bool,
}

/// Which style a house has.
pub(super) struct StyleBook<'a> {
    styles: &'a Styles,
    districts: Index<usize>,
    large: usize,
}

impl<'a> StyleBook<'a> {
    /// Districts of built blocks decide for what stands in them; the first style is for what nothing else decides.
    pub fn new(styles: &'a Styles, areas: &[Area<'_>], findings: &mut Vec<Finding>) -> Self {
        let mut districts = Vec::new();
        for area in areas.iter().filter(|a| a.block.kind == BlockKind::Built && !a.block.district.is_empty()) {
            match styles.find(&area.block.district) {
                Some(style) => districts.extend(area.polygons.iter().map(|p| (p.clone(), style))),
                None => findings.push(unknown(area.block.id, area.block.outline.first().copied(), &area.block.district)),
            }
        }
        Self { styles, districts: Index::new(districts), large: styles.find("modern").unwrap_or(0) }
    }

    /// Style of a footprint: by name, else its district's, else by size.
    pub fn choose(&self, name: &str, id: Id, footprint: &GridPolygon, findings: &mut Vec<Finding>) -> usize {
        if !name.is_empty() {
            match self.styles.find(name) {
                Some(style) => return style,
                None => findings.push(unknown(id, footprint.outer.first().map(|p| p.to_metres()), name)),
            }
        }
        let inside = veduta_city::GridPos::from_metres(footprint.centroid());
        if let Some(&style) = self.districts.at(inside).next() {
            return style;
        }
        if footprint.area_m2() > LARGE_M2 { self.large } else { 0 }
    }

    /// Style of what grows on a block: its district's, else the first.
    pub fn of_district(&self, name: &str) -> usize {
        self.styles.find(name).unwrap_or(0)
    }

    /// The style that this book chose.
    pub fn style(&self, index: usize) -> &'a Style {
        &self.styles.0[index]
    }
}

fn unknown(id: Id, plan_pos: Option<glam::DVec2>, name: &str) -> Finding {
    Finding::new(Severity::Repaired, id, plan_pos, format!("there is no style `{name}`: another is taken"))
}

/// A number from a map if it can be meant: finite, above 0 and not beyond `most`.
fn sane(value: Option<f64>, most: f64, what: &str, id: Id, findings: &mut Vec<Finding>) -> Option<f64> {
    let value = value?;
    if value.is_finite() && value > 0.0 && value <= most {
        return Some(value);
    }
    findings.push(Finding::new(
        Severity::Repaired,
        id,
        None,
        format!("{what} of {value} left out: it needs to be within 0 to {most}"),
    ));
    None
}

/// Drafts of the graph's buildings, in order.
pub(super) fn given(graph: &CityGraph, book: &StyleBook<'_>, extent: &Extent, findings: &mut Vec<Finding>) -> Vec<Draft> {
    let mut seen: FxHashSet<GridPolygon> = FxHashSet::default();
    let mut drafts = Vec::new();
    for building in &graph.buildings {
        let place = building.outline.first().copied();
        let mut drop = |message: &str| findings.push(Finding::new(Severity::Dropped, building.id, place, message));
        let footprints = outline::polygons(&building.outline, &building.holes);
        let Some(whole) = footprints.iter().max_by(|a, b| a.area_m2().total_cmp(&b.area_m2())) else {
            drop("building: its outline has no area");
            continue;
        };
        if whole.area_m2() < LEAST_M2 {
            drop("building: its footprint is smaller than 1 m²");
            continue;
        }
        if !whole.outer.iter().all(|&p| extent.holds(p)) {
            drop("building: it reaches beyond the edge of the city");
            continue;
        }
        if !seen.insert(whole.clone()) {
            drop("building: another stands on the same footprint");
            continue;
        }
        let style = book.choose(&building.style, building.id, whole, findings);
        let bodies = bodies(building, &footprints, extent, findings);
        if bodies.is_empty() {
            findings.push(Finding::new(Severity::Dropped, building.id, place, "building: none of its parts can stand"));
            continue;
        }
        drafts.push(Draft {
            id: building.id,
            name: building.name.clone(),
            number: building.number.clone(),
            style,
            draw: Draw::new(graph.seed, building.id, "house"),
            grown: None,
            bodies,
        });
    }
    drafts
}

/// What a map says of a body, from the building or one of its parts.
struct Tags<'a> {
    id: Id,
    min_height_m: f64,
    height_m: Option<f64>,
    levels: Option<f64>,
    roof: &'a RoofTags,
    colour: Option<Rgb>,
    opening: Option<Opening>,
}

fn bodies(building: &Building, footprints: &[GridPolygon], extent: &Extent, findings: &mut Vec<Finding>) -> Vec<Body> {
    let mut out = Vec::new();
    if building.parts.is_empty() {
        let tags = Tags {
            id: building.id,
            min_height_m: building.min_height_m,
            height_m: building.height_m,
            levels: building.levels,
            roof: &building.roof,
            colour: building.colour,
            opening: None,
        };
        add_bodies(&tags, footprints, &mut out, findings);
        if footprints.len() > 1 {
            let message = format!("building: its outline crosses itself; it stands as {} bodies", footprints.len());
            findings.push(Finding::new(Severity::Repaired, building.id, building.outline.first().copied(), message));
        }
    }
    for part in &building.parts {
        let found = outline::polygons(&part.outline, &part.holes);
        let inside = found.iter().all(|p| p.outer.iter().all(|&v| extent.holds(v)));
        if found.iter().map(GridPolygon::area_m2).sum::<f64>() < 0.05 || !inside {
            let message = format!("building part {}: it has no area or lies beyond the edge of the city", part.id);
            findings.push(Finding::new(Severity::Dropped, building.id, part.outline.first().copied(), message));
            continue;
        }
        let tags = Tags {
            id: building.id,
            min_height_m: part.min_height_m,
            height_m: part.height_m.or_else(|| building.height_m.filter(|_| part.levels.is_none())),
            levels: part.levels,
            roof: &part.roof,
            colour: part.colour.or(building.colour),
            opening: part.opening,
        };
        add_bodies(&tags, &found, &mut out, findings);
    }
    mark_covered(&mut out);
    out
}

fn add_bodies(tags: &Tags<'_>, footprints: &[GridPolygon], out: &mut Vec<Body>, findings: &mut Vec<Finding>) {
    let id = tags.id;
    let height_m = sane(tags.height_m, HIGHEST_M, "height", id, findings);
    let levels = sane(tags.levels, MOST_LEVELS, "number of storeys", id, findings);
    let mut roof = *tags.roof;
    roof.height_m = match roof.height_m {
        Some(0.0) => Some(0.0),
        other => sane(other, HIGHEST_M, "roof height", id, findings),
    };
    roof.direction_deg = roof.direction_deg.filter(|d| d.is_finite());
    let mut bottom_m = tags.min_height_m;
    if !(0.0..HIGHEST_M).contains(&bottom_m) {
        let message = format!("underside of {bottom_m} m left out: it needs to be within 0 to {HIGHEST_M}");
        findings.push(Finding::new(Severity::Repaired, id, None, message));
        bottom_m = 0.0;
    }
    if let Some(top) = height_m.filter(|&top| top < bottom_m + 0.1) {
        let message = format!("a body from {bottom_m} m up to {top} m has no height");
        findings.push(Finding::new(Severity::Dropped, id, footprints.first().map(GridPolygon::centroid), message));
        return;
    }
    for footprint in footprints.iter().flat_map(outline::straightened).filter(|f| f.area_m2() >= 0.05) {
        out.push(Body {
            footprint,
            bottom_m,
            height_m,
            levels,
            roof,
            colour: tags.colour,
            opening: tags.opening,
            is_covered: false,
        });
    }
}

/// Bodies on which others stand get level tops, unless a map says otherwise.
fn mark_covered(bodies: &mut [Body]) {
    let boxes: Vec<_> = bodies.iter().map(|b| b.footprint.bounds()).collect();
    let meet = |i: usize, j: usize| boxes[i].zip(boxes[j]).is_some_and(|(a, b)| do_meet(a, b));
    for i in 0..bodies.len() {
        let Some(top) = bodies[i].height_m else { continue };
        let over = |j: &usize| *j != i && bodies[*j].bottom_m > 0.0 && bodies[*j].bottom_m >= top - 1.0 && meet(i, *j);
        let half = bodies[i].footprint.area_m2() * 0.4;
        let area: f64 =
            (0..bodies.len()).filter(over).map(|j| boolean::overlap_m2(&bodies[i].footprint, &bodies[j].footprint)).sum();
        bodies[i].is_covered = area > half;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Stock, extent, streets};

    fn grown(text: &str) -> (Vec<Draft>, Vec<Finding>) {
        let graph: CityGraph = veduta_city::file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"));
        let (styles, mut findings) = (Stock::new().styles, Vec::new());
        let extent = extent::extent(&graph, &mut findings);
        let areas = streets::areas(&graph.blocks, &mut findings);
        let book = StyleBook::new(&styles, &areas, &mut findings);
        let drafts = given(&graph, &book, &extent, &mut findings);
        (drafts, findings)
    }

    #[test]
    fn what_cannot_stand_is_dropped_with_a_reason() {
        let (drafts, findings) = grown(
            "(name: \"T\", anchor: (lat: 50, lon: 14), buildings: [
                (id: 1, outline: [(0,0),(10,0),(10,10),(0,10)]),
                (id: 2, outline: [(0,0),(10,0),(10,10),(0,10)]),
                (id: 3, outline: [(20,0),(30,0),(25,0)]),
                (id: 4, outline: [(40,0),(40.5,0),(40.5,0.5)]),
                (id: 5, outline: [(50,0),(60,0),(60,10)], height_m: -3, style: \"nowhere\")])",
        );
        assert_eq!(drafts.iter().map(|d| d.id).collect::<Vec<_>>(), [Id(1), Id(5)]);
        assert_eq!(drafts[1].bodies[0].height_m, None);
        let of = |id| findings.iter().filter(|f| f.id == Id(id)).count();
        assert_eq!((of(2), of(3), of(4), of(5)), (1, 1, 1, 2), "{findings:?}");
    }

    #[test]
    fn a_body_under_a_tower_is_covered() {
        let (drafts, _) = grown(
            "(name: \"T\", anchor: (lat: 50, lon: 14), buildings: [(id: 1, outline: [(0,0),(10,0),(10,10),(0,10)], parts: [
                (outline: [(0,0),(10,0),(10,10),(0,10)], height_m: 20),
                (outline: [(1,1),(9,1),(9,9),(1,9)], min_height_m: 20, height_m: 50)])])",
        );
        assert_eq!(drafts[0].bodies.iter().map(|b| b.is_covered).collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn a_district_gives_its_style() {
        let (drafts, _) = grown(
            "(name: \"T\", anchor: (lat: 50, lon: 14), blocks: [(outline: [(-5,-5),(50,-5),(50,50),(-5,50)], district: \"tenement\")],
              buildings: [(id: 1, outline: [(0,0),(10,0),(10,10),(0,10)]), (id: 2, outline: [(60,0),(70,0),(70,10),(60,10)])])",
        );
        assert_eq!(drafts[0].style, Stock::new().styles.find("tenement").expect("stock"));
        assert_eq!(drafts[1].style, 0);
    }
}
