//! What covers the ground, as layers of overlapping shapes in order of priority.

use core::ops::Range;
use std::collections::{BTreeMap, HashMap};

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{
    Block, BlockKind, CityGraph, Finding, GridPolygon, GridPos, Id, Link, LinkKind, PlanStreet, Severity, StreetClass, SurfaceKind,
    Surfacing, WIDEST_M,
};

use super::band::{self, band, stations};
use super::bridges::Bridges;
use super::courses::{self, Courses};
use super::crossroads::{Arm, gaps, rounding, wedge};
use super::water::Depths;
use super::{Area, outline, walks};

/// Kerb: how far pavements stand above the carriageway, metres.
pub(super) const KERB_M: f64 = 0.12;
/// Narrower ones are laid this wide; metres.
const NARROWEST_M: f64 = 0.5;
/// Streets narrower than this have no pavements; metres.
const NARROWEST_WITH_PAVEMENTS_M: f64 = 6.0;

/// Priority of what covers the ground, highest first: where two overlap the first lies on top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// Ramps that lead below the ground.
    Opening,
    /// Between kerbs.
    Carriageway,
    /// Beside a carriageway.
    Pavement,
    /// A square.
    Square,
    /// A street of one surface.
    Lane,
    /// A footway.
    Path,
    /// Rails outside of streets.
    Rails,
    /// A monument's ground.
    Monument,
    /// Rivers and ponds.
    Water,
    /// Lawns.
    Park,
}

/// Shapes of one surface and priority; they may overlap.
#[derive(Debug)]
pub(super) struct Layer {
    /// Priority.
    pub rank: Rank,
    /// What covers them.
    pub surface: SurfaceKind,
    /// Height of its top above the terrain, grid steps.
    pub z: i32,
    /// The course that it is laid along.
    pub course: Option<u32>,
    /// Where.
    pub shapes: Vec<GridPolygon>,
}

#[cfg(test)]
impl Layer {
    pub fn new(rank: Rank, surface: SurfaceKind, shapes: Vec<GridPolygon>) -> Self {
        Self { rank, surface, z: key(rank, surface, None).1, course: None, shapes }
    }
}

/// What makes shapes one layer: priority, height of the top above the terrain in grid steps (deep water lies over shallow), surface, and
/// the course that it is laid along, of which the first lies on top.
type Key = (Rank, i32, SurfaceKind, Option<u32>);

fn key(rank: Rank, surface: SurfaceKind, course: Option<u32>) -> Key {
    (rank, if rank == Rank::Pavement { GridPos::steps(KERB_M) } else { 0 }, surface, course.filter(|_| courses::is_laid(surface)))
}

/// Width of the pavement on each side of a street with a carriageway; 0 if there is none. Metres.
pub(super) fn pavement_m(class: StreetClass, width_m: f64) -> f64 {
    match class {
        StreetClass::Main | StreetClass::Street if width_m >= NARROWEST_WITH_PAVEMENTS_M => (width_m * 0.2).clamp(1.5, 3.0),
        _ => 0.0,
    }
}

/// A link's width in metres: its own or its class's, at most 400.
pub(super) fn width_m(link: &Link) -> f64 {
    link.width().clamp(NARROWEST_M, WIDEST_M)
}

/// Its width at a share of its length, in the same bounds.
pub(super) fn width_at_m(link: &Link, share: f64) -> f64 {
    link.width_at(share).clamp(NARROWEST_M, WIDEST_M)
}

pub(super) const fn surface(surfacing: Surfacing) -> SurfaceKind {
    match surfacing {
        Surfacing::Asphalt => SurfaceKind::Asphalt,
        Surfacing::Cobbles => SurfaceKind::Cobbles,
        Surfacing::Mosaic => SurfaceKind::Mosaic,
        Surfacing::Flagstones => SurfaceKind::Flagstones,
        Surfacing::Gravel => SurfaceKind::Gravel,
        Surfacing::Grass => SurfaceKind::Grass,
    }
}

/// Everything that covers ground, in order of priority.
pub(super) fn layers(
    graph: &CityGraph,
    areas: &[Area<'_>],
    (bridges, depths, courses): (&Bridges, Depths, &Courses),
    openings: Vec<GridPolygon>,
    findings: &mut Vec<Finding>,
) -> Vec<Layer> {
    let mut shapes: BTreeMap<Key, Vec<GridPolygon>> = BTreeMap::new();
    if !openings.is_empty() {
        shapes.insert(key(Rank::Opening, SurfaceKind::Opening, None), openings);
    }
    link_shapes(graph, areas, (bridges, depths, courses), &mut shapes, findings);
    for (i, square) in graph.squares.iter().enumerate() {
        let found = outline::polygons(&square.outline, &square.holes);
        if found.is_empty() {
            let message = "square: its outline has no area";
            findings.push(Finding::new(Severity::Dropped, square.id, square.outline.first().copied(), message));
        }
        shapes.entry(key(Rank::Square, surface(square.surfacing), courses.of_square(i))).or_default().extend(found);
    }
    for area in areas {
        let key = match area.block.kind {
            BlockKind::Built => continue,
            BlockKind::Park => key(Rank::Park, SurfaceKind::Grass, None),
            BlockKind::Monument => key(Rank::Monument, SurfaceKind::Flagstones, None),
            BlockKind::Water => (Rank::Water, depths.of_block(&area.polygons), SurfaceKind::Water, None),
        };
        shapes.entry(key).or_default().extend(area.polygons.iter().cloned());
    }
    let walks = walks::walks(graph, areas);
    if !walks.is_empty() {
        shapes.entry(key(Rank::Path, SurfaceKind::Gravel, None)).or_default().extend(walks);
    }
    shapes.into_iter().map(|((rank, z, surface, course), shapes)| Layer { rank, surface, z, course, shapes }).collect()
}

/// One band to lay: the link, its half-width where the link is as wide as it mostly is, and what it is laid as.
struct Strip<'a> {
    link: &'a Link,
    half_m: f64,
    /// Width of the pavement beside it.
    pavement_m: f64,
    key: Key,
}

impl Strip<'_> {
    /// Its half-width at a share of the link's length: what is beside it keeps its own width.
    fn half_at(&self, share: f64) -> f64 {
        if self.link.profile.is_empty() {
            return self.half_m;
        }
        (self.half_m + (width_at_m(self.link, share) - width_m(self.link)) / 2.0).max(NARROWEST_M / 2.0)
    }
}

/// What a link covers.
#[derive(Default)]
struct Laid {
    finding: Option<Finding>,
    shapes: Vec<(Key, GridPolygon)>,
    /// Where its bands end on the ground, and meet others of their family.
    arms: Vec<((Family, Id), Arm<Key>)>,
}

fn link_shapes(
    graph: &CityGraph,
    areas: &[Area<'_>],
    (bridges, depths, courses): (&Bridges, Depths, &Courses),
    shapes: &mut BTreeMap<Key, Vec<GridPolygon>>,
    findings: &mut Vec<Finding>,
) {
    let at = graph.node_positions();
    let laid = |(i, link): (usize, &Link)| {
        let finding = width_finding(link, &at);
        let line = graph.polyline(link, &at);
        // Below the ground there are tunnels' ways alone.
        let Some(line) = line.filter(|_| link.layer >= 0 || bridges.has(i)) else { return Laid { finding, ..Laid::default() } };
        let strips = strips_of(link, &line, areas, (depths, courses.of_link(i)));
        let (shapes, arms) = lay(&strips, &line, &bridges.on_ground(i));
        Laid { finding, shapes, arms }
    };
    let all: Vec<Laid> = graph.links.par_iter().enumerate().map(laid).collect();
    let mut nodes: BTreeMap<(Family, Id), Vec<Arm<Key>>> = BTreeMap::new();
    for Laid { finding, shapes: own, arms } in all {
        findings.extend(finding);
        own.into_iter().for_each(|(key, shape)| shapes.entry(key).or_default().push(shape));
        arms.into_iter().for_each(|(node, arm)| nodes.entry(node).or_default().push(arm));
    }
    let between = |((family, node), mut arms): ((Family, Id), Vec<Arm<Key>>)| {
        let mut out = Vec::new();
        let Some(&pos) = at.get(&node) else { return out };
        for (before, after, gap) in gaps(&mut arms) {
            // The lower of both lies under what else is there.
            let key = before.what.max(after.what);
            let rounding = (family == Family::Kerbs).then(|| rounding(pos, before, after, gap));
            out.extend(wedge(pos, before, after, gap).into_iter().chain(rounding.flatten()).map(|shape| (key, shape)));
        }
        out
    };
    let between: Vec<Vec<(Key, GridPolygon)>> = nodes.into_iter().collect::<Vec<_>>().into_par_iter().map(between).collect();
    between.into_iter().flatten().for_each(|(key, shape)| shapes.entry(key).or_default().push(shape));
}

/// What there is to say of a link's width; 0 leaves it to the class.
fn width_finding(link: &Link, at: &HashMap<Id, DVec2>) -> Option<Finding> {
    if link.width_m == 0.0 || (NARROWEST_M..=WIDEST_M).contains(&link.width_m) {
        return None;
    }
    let (given, taken) = (link.width_m, width_m(link));
    let message = format!("a width of {given:?} m is not within {NARROWEST_M} to {WIDEST_M} m: {taken} m is taken");
    Some(Finding::new(Severity::Repaired, link.id, at.get(&link.from).copied(), message))
}

/// The bands of a link where it lies on the ground, told as shares of its length, and their arms.
fn lay(strips: &[Strip<'_>], line: &[DVec2], on_ground: &[Range<f64>]) -> (Vec<(Key, GridPolygon)>, Vec<((Family, Id), Arm<Key>)>) {
    let (mut shapes, mut arms) = (Vec::new(), Vec::new());
    for strip in strips {
        let stations = stations(line, strip.link);
        for part in on_ground {
            let shape = match *part {
                Range { start: 0.0, end: 1.0 } => band(&stations, |share| strip.half_at(share)),
                _ => band(&band::part(&stations, part.clone()), |share| strip.half_at(share)),
            };
            shapes.extend(shape.map(|shape| (strip.key, shape)));
        }
        let arm = |line: &mut dyn Iterator<Item = DVec2>, share: f64| {
            let is_on_ground = on_ground.iter().any(|part| part.start == share || part.end == share);
            Arm::new(line, strip.half_at(share), strip.pavement_m, strip.key).filter(|_| is_on_ground)
        };
        for family in Family::of(strip) {
            let forth = arm(&mut line.iter().copied(), 0.0).map(|arm| ((family, strip.link.from), arm));
            let back = arm(&mut line.iter().rev().copied(), 1.0).map(|arm| ((family, strip.link.to), arm));
            arms.extend(forth.into_iter().chain(back));
        }
    }
    (shapes, arms)
}

/// Bands that join one another where they meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Family {
    /// Carriageways between pavements.
    Kerbs,
    /// Streets with all that belongs to them.
    Streets,
    Rails,
    Water,
}

impl Family {
    fn of(strip: &Strip<'_>) -> impl Iterator<Item = Self> {
        let rank = strip.key.0;
        let own = match rank {
            Rank::Carriageway if strip.pavement_m > 0.0 => Self::Kerbs,
            Rank::Rails => Self::Rails,
            Rank::Water => Self::Water,
            _ => Self::Streets,
        };
        // A carriageway without pavements joins those that have them.
        let more = (rank == Rank::Carriageway && own == Self::Streets).then_some(Self::Kerbs);
        [own].into_iter().chain(more)
    }
}

fn strips_of<'a>(link: &'a Link, line: &[DVec2], areas: &[Area<'_>], (depths, course): (Depths, Option<u32>)) -> Vec<Strip<'a>> {
    let width = width_m(link);
    let strip = |half_m, key| Strip { link, half_m, pavement_m: 0.0, key };
    let (half, own) = (width / 2.0, link_surface(link));
    match link.kind {
        LinkKind::Watercourse => vec![strip(half, (Rank::Water, depths.of_course(width), own, None))],
        LinkKind::Railway { tram: true } => Vec::new(),
        LinkKind::Railway { tram: false } => vec![strip(half, key(Rank::Rails, own, None))],
        LinkKind::Street(class) if class.has_carriageway() => {
            let pavement = pavement_m(class, width);
            let carriageway = strip(half - pavement, key(Rank::Carriageway, own, course));
            let mut strips = vec![Strip { pavement_m: pavement, ..carriageway }];
            if pavement > 0.0 {
                strips.push(strip(half, key(Rank::Pavement, SurfaceKind::Mosaic, course)));
            }
            strips
        }
        LinkKind::Street(StreetClass::Lane | StreetClass::Service) => vec![strip(half, key(Rank::Lane, own, course))],
        LinkKind::Street(_) => {
            let is_gravel = link.surfacing.is_none() && in_park(line, areas);
            vec![strip(half, key(Rank::Path, if is_gravel { SurfaceKind::Gravel } else { own }, course))]
        }
    }
}

/// What a link is covered with: what it says, or what its class is.
pub(super) fn link_surface(link: &Link) -> SurfaceKind {
    let own = match link.kind {
        LinkKind::Watercourse => return SurfaceKind::Water,
        LinkKind::Railway { .. } => return SurfaceKind::Ballast,
        LinkKind::Street(StreetClass::Lane) => SurfaceKind::Cobbles,
        LinkKind::Street(class) if class.has_carriageway() => SurfaceKind::Asphalt,
        LinkKind::Street(StreetClass::Service) => SurfaceKind::Asphalt,
        LinkKind::Street(_) => SurfaceKind::Flagstones,
    };
    link.surfacing.map_or(own, surface)
}

/// Whether the middle of a polyline lies in a park.
pub(super) fn in_park(line: &[DVec2], areas: &[Area<'_>]) -> bool {
    let Some((middle, _)) = middle_of(line) else { return false };
    let pos = GridPos::from_metres(middle);
    areas.iter().filter(|a| a.block.kind == BlockKind::Park).any(|a: &Area<'_>| a.holds(pos))
}

/// The point half-way along a polyline and the direction there; `None` if it has no length.
pub(super) fn middle_of(line: &[DVec2]) -> Option<(DVec2, DVec2)> {
    let length = length_m(line);
    along(line, length / 2.0)
}

/// Length of a polyline, metres.
pub(super) fn length_m(line: &[DVec2]) -> f64 {
    line.windows(2).map(|e| e[0].distance(e[1])).sum()
}

/// The point at an arc length along a polyline and the direction there; `None` beyond its ends.
pub(super) fn along(line: &[DVec2], s_m: f64) -> Option<(DVec2, DVec2)> {
    let mut left = s_m;
    for e in line.windows(2) {
        let piece = e[0].distance(e[1]);
        if piece > 0.0 && left <= piece {
            let dir = (e[1] - e[0]) / piece;
            return Some((e[0] + dir * left.max(0.0), dir));
        }
        left -= piece;
    }
    None
}

/// Centre lines for maps, routes and labels.
pub(super) fn centre_lines(graph: &CityGraph, bridges: &Bridges) -> Vec<PlanStreet> {
    let at = graph.node_positions();
    let street = |(i, link): (usize, &Link)| {
        let LinkKind::Street(class) = link.kind else { return None };
        let mut line: Vec<GridPos> = graph.polyline(link, &at)?.into_iter().map(GridPos::from_metres).collect();
        line.dedup();
        (line.len() > 1).then(|| PlanStreet {
            id: link.id,
            name: link.name.clone(),
            line,
            width: GridPos::steps(width_m(link)),
            walkable: link.layer >= 0 || bridges.has(i),
            layer: link.layer,
            class,
        })
    };
    graph.links.iter().enumerate().filter_map(street).collect()
}

/// The areas of a graph's blocks as valid polygons; blocks without area are reported.
pub(super) fn areas<'a>(blocks: &'a [Block], findings: &mut Vec<Finding>) -> Vec<Area<'a>> {
    let polygons = |block: &Block| outline::polygons(&block.outline, &block.holes);
    let polygons: Vec<Vec<GridPolygon>> = blocks.par_iter().map(polygons).collect();
    let mut out = Vec::new();
    for (block, polygons) in blocks.iter().zip(polygons) {
        if polygons.is_empty() {
            let message = "block: its outline has no area";
            findings.push(Finding::new(Severity::Dropped, block.id, block.outline.first().copied(), message));
        } else {
            out.push(Area { block, polygons });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_width_that_cannot_be_meant_is_told() {
        for (given, taken) in
            [("1e300", Some("400 m is taken")), ("-4", Some("6.5 m is taken")), ("0.1", Some("0.5 m")), ("0", None), ("7", None)]
        {
            let text = format!(
                "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (40, 0))],
                  links: [(id: 3, from: 1, to: 2, kind: Street(Lane), width_m: {given})])"
            );
            let graph: CityGraph = veduta_city::file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"));
            let mut findings = Vec::new();
            layers(&graph, &[], (&Bridges::default(), Depths::of(None), &Courses::of(&graph)), Vec::new(), &mut findings);
            assert_eq!(findings.len(), usize::from(taken.is_some()), "{given}: {findings:?}");
            let is_told =
                |f: &Finding| f.id == Id(3) && f.plan_pos == Some(DVec2::ZERO) && taken.is_some_and(|t| f.message.contains(t));
            assert!(findings.iter().all(is_told), "{given}: {findings:?}");
        }
    }

    #[test]
    fn pavements_leave_a_carriageway() {
        for class in [StreetClass::Motorway, StreetClass::Main, StreetClass::Street, StreetClass::Lane] {
            for width in [0.5, 3.0, 6.0, 9.0, 14.0, 40.0] {
                let pavement = pavement_m(class, width);
                assert!(pavement == 0.0 || (1.5..=3.0).contains(&pavement));
                assert!(width - 2.0 * pavement > 0.4, "{class:?} of {width} m");
            }
        }
    }

    #[test]
    fn the_middle_of_a_bent_line_is_half_way_along_it() {
        let line = [DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(10.0, 30.0)];
        let (p, dir) = middle_of(&line).expect("it has length");
        assert_eq!((p, dir), (DVec2::new(10.0, 10.0), DVec2::Y));
        assert_eq!(middle_of(&[DVec2::ONE, DVec2::ONE]), None);
    }
}
