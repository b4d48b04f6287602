//! What is seen through tunnels, which lead under the cells and not through their portals.

use std::collections::BTreeSet;

use veduta_city::{Cells, CityPlan, WaySpan};

/// Lets whoever sees the cell of a tunnel's ramp see all of the tunnel, and whoever is in it or above it what is seen from its ramps.
pub(crate) fn see_through(plan: &CityPlan, cells: &mut Cells) {
    if !plan.spans.iter().any(WaySpan::is_bore) {
        return;
    }
    let mut owners: Vec<Option<u32>> = vec![None; plan.spans.len()];
    for (cell, c) in cells.cells.iter().zip(0..) {
        for &span in &cell.spans {
            if let Some(owner) = owners.get_mut(span as usize) {
                *owner = Some(c);
            }
        }
    }
    let goes_on = |a: &WaySpan, b: &WaySpan| is_below(a) && is_below(b) && a.stations.last() == b.stations.first();
    let visible = cells.visible.clone();
    let mut first = 0;
    for tunnel in plan.spans.chunk_by(goes_on) {
        let parts = first..first + tunnel.len();
        first = parts.end;
        if !tunnel.iter().any(WaySpan::is_bore) {
            continue;
        }
        let below: BTreeSet<u32> = owners[parts.clone()].iter().flatten().copied().collect();
        // What is seen beyond a tunnel is seen from its ramps.
        let ramps = tunnel.iter().zip(&owners[parts]).filter(|(span, _)| span.is_ramp());
        let mouths: BTreeSet<u32> = ramps.filter_map(|(_, owner)| *owner).collect();
        let seen = |cell: &u32| visible.get(*cell as usize).into_iter().flatten().copied();
        let all: BTreeSet<u32> = below.iter().copied().chain(mouths.iter().flat_map(seen)).collect();
        for &cell in &all {
            join(&mut cells.visible, cell, &below);
        }
        for &cell in &below {
            join(&mut cells.visible, cell, &all);
        }
    }
}

const fn is_below(span: &WaySpan) -> bool {
    span.is_ramp() || span.is_bore()
}

fn join(visible: &mut [Vec<u32>], cell: u32, more: &BTreeSet<u32>) {
    let Some(set) = visible.get_mut(cell as usize) else { return };
    set.extend(more);
    set.sort_unstable();
    set.dedup();
}

#[cfg(test)]
mod tests {
    use veduta_city::{BoreEnd, Cell, GridPos, Id, SpanForm, SpanStation, SurfaceKind};

    use super::*;

    fn span(form: SpanForm, from: i32) -> WaySpan {
        let station = |x: i32| SpanStation { left: GridPos(x, 2000), right: GridPos(x, -2000), z: -6000 };
        WaySpan {
            id: Id(1),
            form,
            surface: SurfaceKind::Asphalt,
            pavements: (0, 0),
            parapets: (true, true),
            stations: vec![station(from), station(from + 10_000)],
            springing: 0,
            piers: (None, None),
            markings: Vec::new(),
        }
    }

    #[test]
    fn who_sees_one_end_of_a_tunnel_sees_the_other() {
        let bore = SpanForm::Bore { crown: 5000, ends: (BoreEnd::Portal, BoreEnd::Portal) };
        let spans = |under: SpanForm| {
            vec![span(SpanForm::Ramp, 0), span(under, 10_000), span(SpanForm::Ramp, 20_000), span(SpanForm::Ramp, 90_000)]
        };
        let owned = [vec![0], vec![], vec![1], vec![], vec![2], vec![3]];
        let set = |spans: Vec<WaySpan>| {
            let plan = CityPlan { spans, ..CityPlan::default() };
            let mut cells = Cells { visible: vec![vec![0, 1], vec![0, 1], vec![2], vec![3], vec![4], vec![5]], ..Cells::default() };
            cells.cells = owned.iter().map(|spans| Cell { spans: spans.clone(), ..Cell::default() }).collect();
            see_through(&plan, &mut cells);
            cells.visible
        };
        assert_eq!(set(spans(bore)), [vec![0, 1, 2, 4], vec![0, 1, 2, 4], vec![0, 1, 2, 4], vec![3], vec![0, 1, 2, 4], vec![5]]);
        assert_eq!(set(spans(SpanForm::Ramp))[0], [0, 1], "nothing is seen through what is no tunnel");
    }
}
