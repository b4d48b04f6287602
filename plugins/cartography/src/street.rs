use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{GridPos, PlanStreet, StreetClass, metres};

/// A street of one name as a map writes it: its pieces between crossroads joined to one line.
#[derive(Debug, Clone, PartialEq)]
pub struct StreetLine {
    /// Its name.
    pub name: String,
    /// Class of the longest of its pieces.
    pub class: StreetClass,
    /// Half its mean width, metres.
    pub half_width_m: f64,
    /// Vertices, plan metres.
    pub line: Vec<DVec2>,
    /// Whether it lies below the ground.
    pub is_below: bool,
}

impl StreetLine {
    /// Length, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.line.windows(2).map(|w| w[0].distance(w[1])).sum()
    }
}

/// One piece goes on in another where they turn by less than this: the cosine.
const GOES_ON: f64 = 0.3;

/// Streets with a name, their pieces joined where one goes on in another, by name and from the longest on. Streets are joined name by
/// name, at each crossroads with what goes on most nearly straight.
#[must_use]
pub fn join_streets<'a>(streets: impl IntoIterator<Item = &'a PlanStreet>) -> Vec<StreetLine> {
    let mut by_name: BTreeMap<(&str, bool), Vec<&PlanStreet>> = BTreeMap::new();
    for street in streets.into_iter().filter(|street| !street.name.is_empty() && street.line.len() > 1) {
        by_name.entry((&street.name, street.layer < 0)).or_default().push(street);
    }
    let mut lines = Vec::new();
    for ((name, is_below), mut pieces) in by_name {
        pieces.sort_by(|a, b| a.id.cmp(&b.id).then_with(|| a.line.cmp(&b.line)));
        let first = lines.len();
        lines.extend(chains(&pieces).into_iter().map(|chain| line(name, is_below, &pieces, &chain)));
        lines[first..].sort_by(|a: &StreetLine, b| b.length_m().total_cmp(&a.length_m()));
    }
    lines
}

/// A piece, and whether it is gone along backwards.
type Link = (usize, bool);

fn chains(pieces: &[&PlanStreet]) -> Vec<Vec<Link>> {
    let mut ends: BTreeMap<GridPos, Vec<Link>> = BTreeMap::new();
    for (n, piece) in pieces.iter().enumerate() {
        // A piece that is entered at its last vertex is gone along backwards.
        for (end, backwards) in [(piece.line.first(), false), (piece.line.last(), true)] {
            ends.entry(end.copied().unwrap_or_default()).or_default().push((n, backwards));
        }
    }
    let mut is_used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    for n in 0..pieces.len() {
        if is_used[n] {
            continue;
        }
        is_used[n] = true;
        let mut chain = vec![(n, false)];
        extend(pieces, &ends, &mut is_used, &mut chain);
        let turned = |(n, backwards): Link| (n, !backwards);
        chain = chain.into_iter().rev().map(turned).collect();
        extend(pieces, &ends, &mut is_used, &mut chain);
        chains.push(chain);
    }
    chains
}

fn extend(pieces: &[&PlanStreet], ends: &BTreeMap<GridPos, Vec<Link>>, is_used: &mut [bool], chain: &mut Vec<Link>) {
    while let Some(&last) = chain.last() {
        let (end, leads) = leaves(pieces, last);
        let here = ends.get(&end).into_iter().flatten().filter(|(n, _)| !is_used[*n]);
        let straight = |link: &Link| leads.dot(enters(pieces, *link));
        let Some(&next) = here.max_by(|a, b| straight(a).total_cmp(&straight(b))).filter(|next| straight(next) > GOES_ON) else {
            return;
        };
        is_used[next.0] = true;
        chain.push(next);
    }
}

fn vertices(pieces: &[&PlanStreet], (n, backwards): Link) -> Vec<GridPos> {
    let mut line = pieces[n].line.clone();
    if backwards {
        line.reverse();
    }
    line
}

/// Where a link ends, and its direction there.
fn leaves(pieces: &[&PlanStreet], link: Link) -> (GridPos, DVec2) {
    let line = vertices(pieces, link);
    let [.., before, last] = line[..] else { return (GridPos::default(), DVec2::ZERO) };
    (last, (last.to_metres() - before.to_metres()).normalize_or_zero())
}

/// Direction in which a link sets out.
fn enters(pieces: &[&PlanStreet], link: Link) -> DVec2 {
    match vertices(pieces, link)[..] {
        [first, second, ..] => (second.to_metres() - first.to_metres()).normalize_or_zero(),
        _ => DVec2::ZERO,
    }
}

fn line(name: &str, is_below: bool, pieces: &[&PlanStreet], chain: &[Link]) -> StreetLine {
    let mut vertices: Vec<DVec2> = chain.iter().flat_map(|&link| vertices(pieces, link)).map(GridPos::to_metres).collect();
    vertices.dedup();
    let length = |street: &PlanStreet| street.line.windows(2).map(|w| w[0].to_metres().distance(w[1].to_metres())).sum::<f64>();
    let of_chain = || chain.iter().map(|&(n, _)| (pieces[n], length(pieces[n])));
    let longest = of_chain().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(StreetClass::default(), |(piece, _)| piece.class);
    let total: f64 = of_chain().map(|(_, length)| length).sum();
    let width = of_chain().map(|(piece, length)| metres(piece.width.max(0)) * length).sum::<f64>() / total.max(1e-9);
    StreetLine { name: name.to_owned(), class: longest, half_width_m: width / 2.0, line: vertices, is_below }
}

#[cfg(test)]
mod tests {
    use veduta_city::Id;

    use super::*;

    fn piece(id: u64, name: &str, line: &[(f64, f64)]) -> PlanStreet {
        let line = line.iter().map(|&p| GridPos::from_metres(p.into())).collect();
        PlanStreet { id: Id(id), name: name.into(), line, width: 8 * 1024, walkable: true, ..PlanStreet::default() }
    }

    #[test]
    fn pieces_of_a_street_become_one_line_whichever_way_they_run() {
        let pieces = [
            piece(1, "Long", &[(50.0, 0.0), (0.0, 0.0)]),
            piece(2, "Long", &[(50.0, 0.0), (100.0, 5.0)]),
            piece(3, "Long", &[(160.0, 5.0), (100.0, 5.0)]),
            piece(4, "", &[(0.0, 0.0), (0.0, 90.0)]),
        ];
        let lines = join_streets(&pieces);
        assert_eq!(lines.len(), 1);
        let xs: Vec<f64> = lines[0].line.iter().map(|p| p.x).collect();
        assert!(xs == [0.0, 50.0, 100.0, 160.0] || xs == [160.0, 100.0, 50.0, 0.0], "{xs:?}");
        assert_eq!(lines[0].half_width_m, 4.0);
        let mut other_way = pieces.to_vec();
        other_way.reverse();
        assert_eq!(join_streets(&other_way), lines, "whatever the order");
    }

    #[test]
    fn a_street_that_forks_goes_on_straight_and_its_arm_is_a_line_of_its_own() {
        let pieces = [
            piece(1, "Fork", &[(0.0, 0.0), (50.0, 0.0)]),
            piece(2, "Fork", &[(50.0, 0.0), (90.0, 40.0)]),
            piece(3, "Fork", &[(50.0, 0.0), (120.0, 0.0)]),
        ];
        let lines = join_streets(&pieces);
        assert_eq!(lines.iter().map(|line| line.length_m().round()).collect::<Vec<_>>(), [120.0, 57.0]);
    }

    #[test]
    fn a_ring_ends_where_it_began() {
        let ring = [
            piece(1, "Ring", &[(0.0, 0.0), (40.0, -10.0), (80.0, 0.0)]),
            piece(2, "Ring", &[(80.0, 0.0), (90.0, 40.0), (80.0, 80.0)]),
            piece(3, "Ring", &[(80.0, 80.0), (40.0, 90.0), (0.0, 80.0)]),
            piece(4, "Ring", &[(0.0, 80.0), (-10.0, 40.0), (0.0, 0.0)]),
        ];
        let lines = join_streets(&ring);
        assert!(lines.iter().map(|line| line.line.len()).sum::<usize>() >= 9);
        assert!(lines.iter().all(|line| line.line.len() > 1));
    }
}
