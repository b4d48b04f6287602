//! Houses for built blocks that have none: where to build, and a ring of lots round each courtyard.

use core::ops::Range;
use std::collections::HashMap;

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{BlockKind, CityGraph, Finding, GridPolygon, GridPos, GroundPatch, Id, Link, LinkKind, Severity, Style};

use super::band::{Station, pieces, quad, stations};
use super::extent::Extent;
use super::ground;
use super::houses::{Body, Draft, Grown, StyleBook};
use super::index::Index;
use super::inradius::inradius_m;
use super::perimeter::{self, Site};
use super::streets::{self, Layer, Rank};
use super::{Area, boolean, massing, outline, relation, stand};
use veduta_city::bounds::{Bounds, do_meet, joined};

/// A built block is grown only where given buildings cover less than this share of it.
const MOST_COVERED: f64 = 0.35;
/// Pieces of blocks smaller than this stay empty; square metres.
const LEAST_SITE_M2: f64 = 25.0;
/// Sites narrower than this stay empty, metres: verges between a footway and its street, slits beside a given house.
pub(super) const NARROWEST_SITE_M: f64 = 5.5;
/// Lots smaller than this are not built on; square metres.
const LEAST_LOT_M2: f64 = 12.0;
/// Lots narrower than this are not built on; metres.
const LEAST_WIDTH_M: f64 = 2.0;
/// Larger pieces are not built on, square metres: they are country.
const LARGEST_SITE_M2: f64 = 100_000.0;
/// Share of a street's width that is cut out of a block drawn along it. Less than the whole, since blocks are drawn to their
/// building line, and widths of streets are round numbers. Where streets cut a block into pieces, it was not drawn to a
/// building line, and the whole width is cut out.
const CORE: f64 = 0.7;
/// A given house whose wall runs this close to the building line stands on it; metres.
const GAP_M: f64 = 0.35;
/// A lot that loses no more than this share to another block's house is cut; one that loses more is given up.
const MOST_CUT: f64 = 0.1;
/// Bodies may overlap by this much before one is cut; square metres.
const TOLERATED_M2: f64 = 0.25;

/// A block to build on.
struct Plot {
    id: Id,
    district: String,
    /// The building line.
    outline: Vec<GridPolygon>,
}

/// Grows houses on the built blocks; where a graph has streets and neither blocks nor houses, on what streets enclose.
pub(super) fn grow_lots(
    graph: &CityGraph,
    areas: &[Area<'_>],
    ground: &[GroundPatch],
    extent: &Extent,
    obstacles: &Obstacles,
    book: &StyleBook<'_>,
    findings: &mut Vec<Finding>,
) -> Vec<Draft> {
    let built: Vec<&Area<'_>> = areas.iter().filter(|a| a.block.kind == BlockKind::Built).collect();
    let streets = graph.links.iter().filter(|l| matches!(l.kind, LinkKind::Street(_))).count();
    let plots: Vec<Plot> = if built.is_empty() && obstacles.given * 2 < streets {
        found_plots(ground, extent)
    } else {
        let whole = extent.polygon();
        let within = |p: &GridPolygon| {
            if p.outer.iter().all(|&p| extent.holds(p)) {
                return vec![p.clone()];
            }
            boolean::intersection(&boolean::rings([p]), &boolean::rings([&whole]))
        };
        let plot = |a: &&Area<'_>| {
            let outline = a.polygons.iter().flat_map(within).collect();
            Plot { id: a.block.id, district: a.block.district.clone(), outline }
        };
        built.iter().map(plot).collect()
    };
    let grow = |plot: &Plot| {
        let mut findings = Vec::new();
        let drafts = grow_plot(graph, plot, obstacles, book, &mut findings);
        (drafts, findings)
    };
    let (drafts, told): (Vec<Vec<Draft>>, Vec<Vec<Finding>>) = plots.par_iter().map(grow).unzip();
    findings.extend(told.into_iter().flatten());
    // Blocks may overlap one another; of two houses on one spot the first stands.
    part_ways(drafts, findings)
}

/// What streets enclose, where nobody drew blocks: the extent less everything laid, without what touches its edge.
fn found_plots(ground: &[GroundPatch], extent: &Extent) -> Vec<Plot> {
    let inner = |p: &GridPolygon| {
        let on_edge = |v: &GridPos| v.0 == extent.lo.0 || v.0 == extent.hi.0 || v.1 == extent.lo.1 || v.1 == extent.hi.1;
        p.area_m2() <= LARGEST_SITE_M2 && !p.outer.iter().any(on_edge)
    };
    let plot = |p: GridPolygon| Plot { id: Id::from_place("block", p.centroid()), district: String::new(), outline: vec![p] };
    ground::yards(ground).into_iter().filter(inner).map(plot).collect()
}

/// What blocks are not built over.
pub(super) struct Obstacles {
    /// How many houses are given, …
    given: usize,
    /// … and where their bodies stand.
    houses: Index<()>,
    /// Squares, water, parks, monuments, rails.
    open: Index<()>,
    /// Straight pieces of streets: their cores, …
    cores: Index<()>,
    /// … and their whole widths.
    widths: Index<()>,
}

impl Obstacles {
    pub fn new(graph: &CityGraph, layers: &[Layer], given: &[Draft]) -> Self {
        let footprints = given.iter().flat_map(|d| &d.bodies).map(|b| (b.footprint.clone(), ()));
        let is_open =
            |l: &&Layer| matches!(l.rank, Rank::Opening | Rank::Square | Rank::Rails | Rank::Monument | Rank::Water | Rank::Park);
        // Bands may wind twice about a place, which only a union tells from a hole.
        let whole = |l: &Layer, shape: &GridPolygon| match l.rank {
            Rank::Water | Rank::Rails => boolean::union(&boolean::rings([shape])),
            _ => vec![shape.clone()],
        };
        let open = layers.iter().filter(is_open).flat_map(|l| l.shapes.iter().flat_map(|s| whole(l, s)));
        let open = open.map(|shape| (shape, ())).collect();
        let at: HashMap<Id, DVec2> = graph.node_positions();
        // Railways on bridges, too, under which no ballast lies.
        let is_street = |link: &&Link| match link.kind {
            LinkKind::Street(_) => link.layer >= 0,
            LinkKind::Railway { tram } => !tram && link.layer > 0,
            LinkKind::Watercourse => false,
        };
        let streets = graph.links.iter().filter(is_street);
        let streets: Vec<(&Link, Vec<Station>)> =
            streets.map(|link| (link, stations(&graph.polyline(link, &at).unwrap_or_default(), link))).collect();
        // Both at once, though few blocks ask for the widths: what they wait for side by side must not be side by side itself.
        let (cores, widths) = rayon::join(|| carved(&streets, CORE), || carved(&streets, 1.0));
        Self { given: given.len(), houses: Index::new(footprints.collect()), open: Index::new(open), cores, widths }
    }

    /// What may be built on of a block.
    fn sites(&self, outline: &GridPolygon, houses: &[&GridPolygon]) -> Vec<GridPolygon> {
        fn polygons<'b>(of: &'b Index<()>, outline: &GridPolygon) -> Vec<&'b GridPolygon> {
            let near = of.near(outline, 0.0).into_iter().map(|(polygon, ())| polygon);
            near.filter(|polygon| relation::may_meet(outline, polygon)).collect()
        }
        let open = polygons(&self.open, outline);
        let gaps: Vec<GridPolygon> = houses.iter().flat_map(|house| gaps(outline, house)).collect();
        let carve = |streets: &Index<()>| {
            let streets = polygons(streets, outline);
            let taken = boolean::rings(houses.iter().copied().chain(&gaps).chain(open.iter().copied()).chain(streets));
            let mut sites = match taken[..] {
                [] => vec![outline.clone()],
                _ => boolean::difference(&boolean::rings([outline]), &taken),
            };
            sites.retain(|site| site.area_m2() >= LEAST_SITE_M2);
            sites
        };
        let sites = carve(&self.cores);
        if sites.len() > 1 { carve(&self.widths) } else { sites }
    }
}

/// Straight pieces of streets, over a share of their width.
fn carved(streets: &[(&Link, Vec<Station>)], share: f64) -> Index<()> {
    let quads = |(link, stations): &(&Link, Vec<Station>)| {
        let half = |at: f64| streets::width_at_m(link, at) / 2.0 * share;
        pieces(stations, half).into_iter().map(|quad| (quad, ()))
    };
    Index::new(streets.iter().flat_map(quads).collect())
}

/// The slits between a house's walls and a building line that they were meant to stand on.
fn gaps(outline: &GridPolygon, house: &GridPolygon) -> Vec<GridPolygon> {
    let lines: Vec<(DVec2, DVec2)> = outline.edges().map(|(a, b)| (a.to_metres(), b.to_metres())).collect();
    let is_on_line = |p: DVec2| lines.iter().any(|&(a, b)| outline::distance_to_edge(p, a, b) <= GAP_M);
    let walls = house.edges().map(|(a, b)| (a.to_metres(), b.to_metres()));
    let along = walls.filter(|&(a, b)| [a, (a + b) / 2.0, b].into_iter().all(is_on_line));
    along.filter_map(|(a, b)| quad(a, b, GAP_M + 0.01)).collect()
}

fn grow_plot(
    graph: &CityGraph,
    plot: &Plot,
    obstacles: &Obstacles,
    book: &StyleBook<'_>,
    findings: &mut Vec<Finding>,
) -> Vec<Draft> {
    let mut out = Vec::new();
    let mut count = 0;
    let mut narrow: Vec<DVec2> = Vec::new();
    for outline in &plot.outline {
        let houses: Vec<&GridPolygon> = obstacles.houses.near(outline, 0.0).into_iter().map(|(p, ())| p).collect();
        // Parts of one building overlap one another: what they cover together counts.
        let covered = match houses[..] {
            [] => Vec::new(),
            _ => boolean::intersection(&boolean::rings([outline]), &boolean::rings(houses.iter().copied())),
        };
        if covered.iter().map(GridPolygon::area_m2).sum::<f64>() > outline.area_m2() * MOST_COVERED {
            continue;
        }
        for site in obstacles.sites(outline, &houses) {
            if site.area_m2() > LARGEST_SITE_M2 {
                let message = format!("block: {:.0} m² without a street are not built on", site.area_m2());
                findings.push(Finding::new(Severity::Dropped, plot.id, Some(site.centroid()), message));
                continue;
            }
            let style = book.of_district(&plot.district);
            let look = book.style(style);
            let width_m = 2.0 * inradius_m(&site, perimeter::enough_m(look).max(NARROWEST_SITE_M));
            if width_m < NARROWEST_SITE_M {
                narrow.push(site.centroid());
                continue;
            }
            let draw = Draw::new(graph.seed, Id::from_place("site", site.centroid()), "lots");
            let lots = grow_site(&Site { outline: &site, houses: &houses, width_m }, look, draw);
            count += lots.len();
            let lots = lots.into_iter().filter(is_buildable);
            out.extend(lots.filter_map(|lot| draft(graph, lot, style, look, draw)));
        }
    }
    if let Some(&first) = narrow.first() {
        let message = format!("block: {} pieces of it are narrower than {NARROWEST_SITE_M} m and not built on", narrow.len());
        findings.push(Finding::new(Severity::Note, plot.id, Some(first), message));
    }
    if out.len() < count {
        let message = format!("block: {} of {count} lots are too small or thin to build on", count - out.len());
        findings.push(Finding::new(Severity::Note, plot.id, plot.outline.first().map(GridPolygon::centroid), message));
    }
    out
}

/// Footprints on one site: disjoint, each within it.
fn grow_site(site: &Site<'_>, style: &Style, draw: Draw) -> Vec<GridPolygon> {
    let lots = perimeter::lots(site, style, draw);
    let mut out: Vec<Lot> = Vec::new();
    for lot in lots {
        out.extend(trimmed(lot, site.outline, &out).map(Lot::new));
    }
    out.into_iter().map(|lot| lot.outline).collect()
}

/// A lot, and the box about it.
struct Lot {
    outline: GridPolygon,
    bounds: Bounds,
}

impl Lot {
    fn new(outline: GridPolygon) -> Self {
        Self { bounds: outline.bounds().unwrap_or_default(), outline }
    }

    /// Whether it has more in common with another than rounding explains.
    fn overlaps(&self, other: &Self) -> bool {
        do_meet(self.bounds, other.bounds) && boolean::overlap_m2(&self.outline, &other.outline) > TOLERATED_M2 / 5.0
    }
}

/// The largest piece of a lot that lies in its site and on no earlier lot.
fn trimmed(lot: GridPolygon, site: &GridPolygon, earlier: &[Lot]) -> Option<GridPolygon> {
    let largest = |pieces: Vec<GridPolygon>| pieces.into_iter().max_by(|a, b| a.area_m2().total_cmp(&b.area_m2()));
    let is_sound = outline::is_simple(&lot.outer) && lot.area_m2() > 0.0;
    let lot = if is_sound { lot } else { largest(boolean::union(&boolean::rings([&lot])))? };
    // Kept as it was drawn if it lies within its site but for what rounding explains, so that party walls share their vertices.
    let shared = boolean::overlap_m2(&lot, site);
    let lot = if shared > 0.0 && shared > lot.area_m2() - TOLERATED_M2 {
        lot
    } else {
        largest(boolean::intersection(&boolean::rings([&lot]), &boolean::rings([site])))?
    };
    let mut lot = Lot::new(lot);
    for other in earlier {
        if lot.overlaps(other) {
            lot = Lot::new(largest(boolean::difference(&boolean::rings([&lot.outline]), &boolean::rings([&other.outline])))?);
        }
    }
    // Straight walls, unless they would push into a neighbour.
    let straight = Lot::new(largest(outline::straightened(&lot.outline))?);
    let is_free = straight.outline == lot.outline || !earlier.iter().any(|other| straight.overlaps(other));
    Some(if is_free { straight.outline } else { lot.outline })
}

fn is_buildable(footprint: &GridPolygon) -> bool {
    let area = footprint.area_m2();
    area >= LEAST_LOT_M2 && 2.0 * area / outline::perimeter_m(footprint).max(1.0) >= LEAST_WIDTH_M / 2.0
}

/// The house of a lot; `None` where its style leaves no room for one.
fn draft(graph: &CityGraph, lot: GridPolygon, style_index: usize, style: &Style, row: Draw) -> Option<Draft> {
    let id = Id::from_place("grown house", lot.centroid());
    let (ground, upper) = massing::storey_heights(style, row);
    let (low, high) = (usize::from(style.storeys.0), usize::from(style.storeys.1));
    let storeys = low + row.below("storeys", high.saturating_sub(low) + 1);
    let eaves_m = ground + (storeys.max(1) - 1) as f64 * upper;
    let own = Draw::new(graph.seed, id, "house");
    let bodies = stand::bodies(lot, style, (ground, upper, storeys), own)?;
    Some(Draft {
        id,
        name: String::new(),
        number: String::new(),
        style: style_index,
        draw: own,
        grown: Some(Grown { eaves_m }),
        bodies,
    })
}

/// Cuts grown houses that reach a little over others of another block (walls that follow a bent border are straightened on each
/// side of it), and drops those that stand on others.
fn part_ways(plots: Vec<Vec<Draft>>, findings: &mut Vec<Finding>) -> Vec<Draft> {
    // Where the houses of each plot stand in the list of all, and the box about them.
    let ends = plots.iter().scan(0, |end, plot| {
        *end += plot.len();
        Some(*end)
    });
    let ranges: Vec<Range<usize>> = ends.zip(&plots).map(|(end, plot)| end - plot.len()..end).collect();
    let mut drafts: Vec<Draft> = Vec::with_capacity(plots.iter().map(Vec::len).sum());
    plots.into_iter().for_each(|plot| drafts.extend(plot));
    let boxes: Vec<Bounds> = drafts.iter().map(|draft| draft.bodies[0].footprint.bounds().unwrap_or_default()).collect();
    let about = |houses: &Range<usize>| {
        let (lo, hi) = boxes[houses.clone()].iter().copied().reduce(joined)?;
        Some((Extent { lo, hi }.polygon(), houses.clone()))
    };
    let index = Index::new(ranges.iter().filter_map(about).collect());
    let earlier = |i: usize, footprint: &GridPolygon| -> Vec<usize> {
        let plots = index.near(footprint, 0.0).into_iter();
        plots.flat_map(|(_, houses)| houses.clone()).filter(|&j| j < i && do_meet(boxes[i], boxes[j])).collect()
    };
    // Houses only ever lose ground: those that overlap none now never will.
    let is_over = |(i, draft): (usize, &Draft)| {
        let footprint = &draft.bodies[0].footprint;
        earlier(i, footprint).into_iter().any(|j| boolean::overlap_m2(footprint, &drafts[j].bodies[0].footprint) > TOLERATED_M2)
    };
    let is_over: Vec<bool> = drafts.par_iter().enumerate().map(is_over).collect();
    let mut stands = vec![true; drafts.len()];
    for i in (0..drafts.len()).filter(|&i| is_over[i]) {
        let footprint = &drafts[i].bodies[0].footprint;
        let others = earlier(i, footprint).into_iter().filter(|&j| stands[j]);
        let others: Vec<&GridPolygon> = others.map(|j| &drafts[j].bodies[0].footprint).collect();
        if others.iter().all(|other| boolean::overlap_m2(footprint, other) <= TOLERATED_M2) {
            continue;
        }
        let rest = boolean::difference(&boolean::rings([footprint]), &boolean::rings(others));
        let rest = rest.into_iter().max_by(|a, b| a.area_m2().total_cmp(&b.area_m2()));
        let enough = (1.0 - MOST_CUT) * footprint.area_m2();
        match rest.filter(|rest| rest.area_m2() >= enough && is_buildable(rest)) {
            Some(rest) => {
                // Steps stand on the rest, or not at all.
                let bodies = &mut drafts[i].bodies;
                bodies[0].footprint = rest;
                let stands = |pair: &[Body]| {
                    let (below, step) = (&pair[0].footprint, &pair[1].footprint);
                    boolean::overlap_m2(step, below) > step.area_m2() - TOLERATED_M2
                };
                let count = 1 + bodies.windows(2).take_while(|pair| stands(pair)).count();
                bodies.truncate(count);
                bodies[count - 1].is_covered = false;
            }
            None => {
                stands[i] = false;
                let message = "grown house: blocks overlap here, and another house stands on its lot";
                findings.push(Finding::new(Severity::Dropped, drafts[i].id, Some(footprint.centroid()), message));
            }
        }
    }
    drafts.into_iter().zip(stands).filter_map(|(d, stands)| stands.then_some(d)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Stock;

    fn box_of(x: f64, y: f64, w: f64, h: f64) -> Vec<DVec2> {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| DVec2::new(x, y)).to_vec()
    }

    fn polygon(x: f64, y: f64, w: f64, h: f64) -> GridPolygon {
        outline::polygons(&box_of(x, y, w, h), &[]).remove(0)
    }

    fn grow(text: &str) -> (usize, Vec<Finding>) {
        let graph: CityGraph = veduta_city::file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"));
        let growth = crate::plan::grow(&graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}"));
        (growth.plan.houses.len(), growth.findings)
    }

    #[test]
    fn a_building_of_many_parts_does_not_fill_its_block_many_times() {
        let part = "(outline: [(2,2),(22,2),(22,12),(2,12)], height_m: 9)";
        let text = |parts: usize| {
            format!(
                "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (-9, -9)), (id: 2, pos: (70, -9))],
                  links: [(from: 1, to: 2, kind: Street(Lane))],
                  blocks: [(outline: [(0,0),(60,0),(60,40),(0,40)])],
                  buildings: [(id: 7, outline: [(2,2),(22,2),(22,12),(2,12)], parts: [{}])])",
                [part].repeat(parts).join(",")
            )
        };
        let (one, _) = grow(&text(1));
        let (six, _) = grow(&text(6));
        assert!(one > 5, "{one} houses");
        assert_eq!(one, six);
    }

    #[test]
    fn a_slit_before_a_given_house_is_no_site() {
        let outline = polygon(0.0, 0.0, 60.0, 40.0);
        for (gap, slits) in [(0.0, 3), (0.3, 3), (0.5, 0)] {
            // Beside three sides of the block.
            let house = polygon(gap, gap, 20.0, 40.0 - 2.0 * gap);
            assert_eq!(gaps(&outline, &house).len(), slits, "a gap of {gap} m");
        }
    }

    #[test]
    fn a_lot_on_the_building_line_stays_as_it_was_drawn_though_rounded_beyond_it() {
        let grid = |p: DVec2| GridPos::from_metres(p);
        let corners = [(0.0, 0.0), (30.0, -4.0), (61.37, 7.91), (50.0, 60.0), (-5.0, 40.0)].map(DVec2::from);
        let site = GridPolygon::simple(corners.map(grid).to_vec());
        for (i, (from, to)) in (0..40).flat_map(|i| [(0, 1), (2, 3), (4, 0)].map(|(a, b)| (i, (corners[a], corners[b])))) {
            let along = (to - from).normalize();
            let lot = |depth: f64| {
                let front = [1.0, 10.3].map(|at| from + along * (at + 0.35 * f64::from(i)));
                let back = front.map(|p| p + along.perp() * depth);
                GridPolygon::simple([front[0], front[1], back[1], back[0]].map(grid).to_vec())
            };
            let drawn = lot(11.0);
            assert_eq!(trimmed(drawn.clone(), &site, &[]), Some(drawn.clone()), "{i} {from}");
            // The same lot inside out is turned over, one beyond the line is none, and of one that goes through all the rest is left.
            let mut turned = drawn.clone();
            turned.outer.reverse();
            let turned = trimmed(turned, &site, &[]).expect("the same ground");
            assert!((turned.area_m2() - drawn.area_m2()).abs() < 0.01, "{i} {from}");
            assert!(trimmed(lot(-11.0), &site, &[]).is_none_or(|rest| rest.area_m2() < 0.1), "{i} {from}");
            let through = trimmed(lot(91.0), &site, &[]).expect("it begins in the site");
            assert!(boolean::overlap_m2(&through, &site) > through.area_m2() - TOLERATED_M2 && through.area_m2() > 50.0);
        }
    }

    #[test]
    fn houses_that_touch_across_a_border_both_stand() {
        let styles = Stock::new().styles;
        let graph = CityGraph::default();
        let house = |x: f64, w: f64| {
            draft(&graph, polygon(x, 0.0, w, 10.0), 0, &styles.0[0], Draw::new(1, Id(1), "t")).expect("a house in a row")
        };
        let mut findings = Vec::new();
        let plots = vec![vec![house(0.0, 10.05)], Vec::new(), vec![house(10.0, 10.0), house(15.0, 10.0)]];
        let stand = part_ways(plots, &mut findings);
        assert_eq!((stand.len(), findings.len()), (2, 1));
        let overlap = boolean::overlap_m2(&stand[0].bodies[0].footprint, &stand[1].bodies[0].footprint);
        assert_eq!(overlap, 0.0);
    }

    #[test]
    fn steps_stand_on_what_is_left_of_their_podium() {
        let styles = Stock::new().styles;
        let stand = veduta_city::Stand::Setbacks { podium: (4, 4), share: veduta_city::Range(0.95, 0.95) };
        let tower = Style { stand, ..styles.0[styles.find("skyscraper").expect("stock")].clone() };
        let house = |x: f64, w: f64, style: &Style| {
            draft(&CityGraph::default(), polygon(x, 0.0, w, 40.0), 0, style, Draw::new(1, Id(1), "t")).expect("room")
        };
        // Steps are a metre narrower on each side than what they stand on.
        for (cut, count) in [(0.0, 3), (0.5, 3), (1.5, 1), (3.0, 1)] {
            let next = house(-20.0, 20.0 + cut, &styles.0[0]);
            let stand = part_ways(vec![vec![next], vec![house(0.0, 40.0, &tower)]], &mut Vec::new());
            let bodies = &stand[1].bodies;
            assert_eq!(bodies.len(), count, "{cut} m cut off");
            assert!(bodies.iter().enumerate().all(|(i, body)| body.is_covered == (i + 1 < count)), "{cut} m cut off");
        }
    }
}
