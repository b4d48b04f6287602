//! What ground is laid along: streets on their way through crossroads, and the fronts of squares.
//!
//! At a node every street goes on with the one that lies straightest before it, the broad ones first; these keep their course across the
//! node, and what joins them from aside ends at their edge.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{CityGraph, Course, GridPos, Id, Link, LinkKind, MAP_STEP, SurfaceKind};

use super::band::LEAST_PIECE_M;
use super::streets::{link_surface, pavement_m, surface, width_m};

/// Streets go on where they bend by less than this at a node: the cosine.
const STRAIGHT: f64 = 0.6;
/// The same of the only two streets at a node.
const ALONE: f64 = -0.3;

/// Whether a surface shows which way it is laid.
pub(super) const fn is_laid(surface: SurfaceKind) -> bool {
    matches!(surface, SurfaceKind::Cobbles | SurfaceKind::Flagstones | SurfaceKind::Mosaic)
}

/// The courses of a city, the broad streets' first.
pub(super) struct Courses {
    list: Vec<Course>,
    of_links: Vec<Option<u32>>,
    of_squares: Vec<Option<u32>>,
}

/// An end of a link.
#[derive(Debug, Clone, Copy)]
struct End {
    link: usize,
    is_start: bool,
    /// Away from the node.
    along: DVec2,
    width_m: f64,
}

impl Courses {
    pub fn of(graph: &CityGraph) -> Self {
        let at = graph.node_positions();
        let lines: Vec<Option<Vec<DVec2>>> =
            graph.links.iter().map(|link| graph.polyline(link, &at).filter(|_| is_laid_link(link))).collect();
        let partner = partners(graph, &lines);
        let mut chains: Vec<(f64, Vec<(usize, bool)>)> = Vec::new();
        let mut is_taken = vec![false; graph.links.len()];
        for link in (0..graph.links.len()).filter(|&link| lines[link].is_some()) {
            if is_taken[link] {
                continue;
            }
            // Back to where it begins, or once round.
            let (mut first, mut is_forward) = (link, true);
            while let Some(&(before, is_start)) = partner.get(&(first, is_forward)) {
                (first, is_forward) = (before, !is_start);
                if first == link {
                    break;
                }
            }
            let mut chain: Vec<(usize, bool)> = Vec::new();
            let mut here = Some((first, is_forward));
            while let Some((next, is_forward)) = here.filter(|next| !is_taken[next.0]) {
                is_taken[next] = true;
                chain.push((next, is_forward));
                here = partner.get(&(next, !is_forward)).copied();
            }
            let breadth = chain.iter().map(|&(link, _)| width_m(&graph.links[link])).fold(0.0, f64::max);
            chains.push((breadth, chain));
        }
        chains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut courses = Self { list: Vec::new(), of_links: vec![None; graph.links.len()], of_squares: Vec::new() };
        for (_, chain) in chains {
            let number = courses.list.len() as u32;
            let mut line: Vec<GridPos> = Vec::new();
            for (link, is_forward) in chain {
                courses.of_links[link] = Some(number);
                let points = lines[link].iter().flatten().map(|&p| place(p));
                if is_forward { line.extend(points) } else { line.extend(points.rev()) }
            }
            line.dedup();
            courses.list.push(Course { line, from: 0 });
        }
        for square in &graph.squares {
            let edges = square.outline.iter().zip(square.outline.iter().cycle().skip(1));
            let longest = edges.max_by(|e, f| e.0.distance_squared(*e.1).total_cmp(&f.0.distance_squared(*f.1)));
            let front = longest.filter(|_| is_laid(surface(square.surfacing)));
            courses.of_squares.push(front.map(|_| courses.list.len() as u32));
            courses.list.extend(front.map(|(&a, &b)| Course { line: [a, b].map(place).to_vec(), from: 0 }));
        }
        courses
    }

    pub fn of_link(&self, link: usize) -> Option<u32> {
        self.of_links[link]
    }

    pub fn of_square(&self, square: usize) -> Option<u32> {
        self.of_squares[square]
    }

    pub fn finish(self) -> Vec<Course> {
        self.list
    }
}

/// Courses run along quarters of a metre: they only turn the paving.
fn place(p: DVec2) -> GridPos {
    GridPos::from_metres(p).rounded(MAP_STEP)
}

/// Whether something of a link shows which way it is laid.
fn is_laid_link(link: &Link) -> bool {
    let LinkKind::Street(class) = link.kind else { return false };
    link.layer >= 0 && (is_laid(link_surface(link)) || pavement_m(class, width_m(link)) > 0.0)
}

/// For each end of a link, the end of another that goes on from there.
fn partners(graph: &CityGraph, lines: &[Option<Vec<DVec2>>]) -> BTreeMap<(usize, bool), (usize, bool)> {
    let mut nodes: BTreeMap<Id, Vec<End>> = BTreeMap::new();
    for (i, (link, line)) in graph.links.iter().zip(lines).enumerate() {
        let Some(line) = line else { continue };
        let away = |mut line: Box<dyn Iterator<Item = &DVec2> + '_>| {
            let start = *line.next()?;
            line.map(|&p| p - start).find(|way| way.length() > LEAST_PIECE_M).map(DVec2::normalize)
        };
        let ends = [(link.from, true, away(Box::new(line.iter()))), (link.to, false, away(Box::new(line.iter().rev())))];
        for (node, is_start, along) in ends {
            let end = along.map(|along| End { link: i, is_start, along, width_m: width_m(link) });
            nodes.entry(node).or_default().extend(end);
        }
    }
    let mut partner = BTreeMap::new();
    for ends in nodes.values() {
        let least = if ends.len() == 2 { ALONE } else { STRAIGHT };
        let mut pairs: Vec<(f64, f64, usize, usize)> = Vec::new();
        for (i, a) in ends.iter().enumerate() {
            for (j, b) in ends.iter().enumerate().skip(i + 1) {
                let straight = -a.along.dot(b.along);
                if straight >= least && a.link != b.link {
                    pairs.push((a.width_m.min(b.width_m), straight, i, j));
                }
            }
        }
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)).then((a.2, a.3).cmp(&(b.2, b.3))));
        for (_, _, i, j) in pairs {
            let [a, b] = [i, j].map(|end| (ends[end].link, ends[end].is_start));
            if !partner.contains_key(&a) && !partner.contains_key(&b) {
                partner.insert(a, b);
                partner.insert(b, a);
            }
        }
    }
    partner
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(nodes: &str, links: &str) -> CityGraph {
        let text = format!("(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [{nodes}], links: [{links}])");
        veduta_city::file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"))
    }

    const CROSS: &str =
        "(id: 1, pos: (-50, 0)), (id: 2, pos: (0, 0)), (id: 3, pos: (50, 3)), (id: 4, pos: (0, 50)), (id: 5, pos: (5, -50))";

    #[test]
    fn the_broad_street_goes_through_and_the_narrow_one_too_if_it_is_straight() {
        let lane = |from: u32, to: u32, width: f64| format!("(from: {from}, to: {to}, kind: Street(Lane), width_m: {width})");
        let graph = graph(CROSS, &[lane(4, 2, 4.0), lane(2, 1, 8.0), lane(2, 3, 8.0), lane(5, 2, 4.0)].join(", "));
        let courses = Courses::of(&graph);
        assert_eq!([0, 1, 2, 3].map(|link| courses.of_link(link)), [Some(1), Some(0), Some(0), Some(1)]);
        let list = courses.finish();
        let ends = |course: &Course| [course.line[0], course.line[2]].map(|p| (p.0 / 1024, p.1 / 1024));
        assert_eq!(list.iter().map(|course| course.line.len()).collect::<Vec<_>>(), [3, 3]);
        assert!([[(-50, 0), (50, 3)], [(50, 3), (-50, 0)]].contains(&ends(&list[0])), "{list:?}");
        assert!([[(0, 50), (5, -50)], [(5, -50), (0, 50)]].contains(&ends(&list[1])), "{list:?}");
    }

    #[test]
    fn a_ring_is_one_course_and_asphalt_without_pavements_has_none() {
        let ring = "(from: 1, to: 4, kind: Street(Lane)), (from: 3, to: 4, kind: Street(Lane)), (from: 3, to: 5, kind: Street(Lane)),
            (from: 1, to: 5, kind: Street(Lane)), (from: 1, to: 2, kind: Street(Service)), (from: 2, to: 3, kind: Railway(tram: false))";
        let courses = Courses::of(&graph(CROSS, ring));
        assert_eq!([0, 1, 2, 3].map(|link| courses.of_link(link)), [Some(0); 4]);
        assert_eq!([4, 5].map(|link| courses.of_link(link)), [None; 2]);
        let list = courses.finish();
        assert!(list.len() == 1 && list[0].line.len() == 5 && list[0].line[0] == list[0].line[4], "{list:?}");
    }
}
