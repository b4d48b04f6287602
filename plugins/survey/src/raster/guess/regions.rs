//! Connected regions of a mask, and the figures of shape that a guess goes by.

/// A mask or a picture of colour numbers, small enough to be looked at again and again.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Number of the colour of each pixel.
    pub(super) colours: Vec<u8>,
}

/// A connected region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Region {
    pub(super) area: usize,
    /// Columns and rows of its bounding box: first, and one past the last.
    pub(super) columns: [usize; 2],
    pub(super) rows: [usize; 2],
}

impl Region {
    /// Longer side of the bounding box.
    pub(super) fn length(&self) -> usize {
        (self.columns[1] - self.columns[0]).max(self.rows[1] - self.rows[0])
    }

    fn joined(self, other: Self) -> Self {
        let wider = |a: [usize; 2], b: [usize; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self { area: self.area + other.area, columns: wider(self.columns, other.columns), rows: wider(self.rows, other.rows) }
    }
}

struct Run {
    row: usize,
    from: usize,
    to: usize,
    parent: usize,
}

fn root(runs: &mut [Run], mut i: usize) -> usize {
    while runs[i].parent != i {
        let up = runs[runs[i].parent].parent;
        runs[i].parent = up;
        i = up;
    }
    i
}

/// Regions of the pixels that `is_in` says, joined by sides, and by corners where `by_corners`. The largest first; the
/// second value gives the region of each run, for [`paint`].
pub(super) fn regions(sheet: &Sheet, is_in: &dyn Fn(u8) -> bool, by_corners: bool) -> (Vec<Region>, Labels) {
    let reach = usize::from(by_corners);
    let inside: [bool; 256] = core::array::from_fn(|c| is_in(c as u8));
    let mut runs: Vec<Run> = Vec::new();
    let mut above = 0..0;
    for (y, row) in sheet.colours.chunks_exact(sheet.width.max(1)).enumerate() {
        let first = runs.len();
        let mut x = 0;
        let mut up = above.start;
        while x < row.len() {
            if !inside[usize::from(row[x])] {
                x += 1;
                continue;
            }
            let from = x;
            while x < row.len() && inside[usize::from(row[x])] {
                x += 1;
            }
            let own = runs.len();
            runs.push(Run { row: y, from, to: x, parent: own });
            while up < above.end && runs[up].to + reach <= from {
                up += 1;
            }
            let mut touching = up;
            while touching < above.end && runs[touching].from < x + reach {
                let (a, b) = (root(&mut runs, own), root(&mut runs, touching));
                runs[a.max(b)].parent = a.min(b);
                touching += 1;
            }
        }
        above = first..runs.len();
    }
    collect(runs)
}

/// Which region each run belongs to: row, first column, one past the last, number of the region.
pub(super) type Labels = Vec<(usize, usize, usize, usize)>;

fn collect(mut runs: Vec<Run>) -> (Vec<Region>, Labels) {
    let roots: Vec<usize> = (0..runs.len()).map(|i| root(&mut runs, i)).collect();
    let mut found: Vec<(usize, Region)> = Vec::new();
    let mut number = vec![usize::MAX; runs.len()];
    for (run, &root) in runs.iter().zip(&roots) {
        let own = Region { area: run.to - run.from, columns: [run.from, run.to], rows: [run.row, run.row + 1] };
        if number[root] == usize::MAX {
            number[root] = found.len();
            found.push((found.len(), own));
        } else {
            let old = &mut found[number[root]].1;
            *old = old.joined(own);
        }
    }
    found.sort_by_key(|(first, region)| (core::cmp::Reverse(region.area), *first));
    let mut rank = vec![0; found.len()];
    found.iter().enumerate().for_each(|(i, (first, _))| rank[*first] = i);
    let labels = runs.iter().zip(&roots).map(|(run, &root)| (run.row, run.from, run.to, rank[number[root]])).collect();
    (found.into_iter().map(|(_, region)| region).collect(), labels)
}

/// How many regions of one size would lie as these do: `(Σa)² / Σa²`. One vast region among specks counts as one.
pub(super) fn effective_number(regions: &[Region]) -> f64 {
    let sum: f64 = regions.iter().map(|r| r.area as f64).sum();
    let squares: f64 = regions.iter().map(|r| (r.area as f64).powi(2)).sum();
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

/// What a set of colours looks like.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    /// Share of the sheet.
    pub(super) share: f64,
    /// Width of its strokes, pixels: twice its area by the length of its edge.
    pub(super) thickness: f64,
    /// Share of its area that lies in regions reaching over a fifth of the sheet.
    pub(super) far_reaching: f64,
    /// Area of the region that a pixel of it lies in, on average.
    pub(super) region_area: f64,
    /// Length of the region that a pixel of it lies in, on average.
    pub(super) region_length: f64,
    /// Into how many regions it divides the rest of the sheet.
    pub(super) divides: f64,
    /// Areas of these regions, the largest first; pixels.
    pub(super) gaps: Vec<usize>,
    /// The same as `divides`, leaving aside the largest region of the rest and what is smaller than a few strokes across.
    pub(super) inner_divides: f64,
}

impl Shape {
    pub(super) fn of(sheet: &Sheet, is_in: &dyn Fn(u8) -> bool) -> Self {
        let all = (sheet.width * sheet.height).max(1) as f64;
        let (rest, _) = regions(sheet, &|c| !is_in(c), false);
        let area = sheet.width * sheet.height - rest.iter().map(|r| r.area).sum::<usize>();
        let thickness = 2.0 * area as f64 / edge(sheet, is_in).max(1) as f64;
        // Where other colours meet softly, a thin line of this one may join what is apart.
        let own =
            if thickness > SOFT { regions(&eroded(sheet, is_in), &|c| c == 1, true).0 } else { regions(sheet, is_in, true).0 };
        let own_area: usize = own.iter().map(|r| r.area).sum();
        let side = sheet.width.max(sheet.height);
        let far: usize = own.iter().filter(|r| 5 * r.length() >= side).map(|r| r.area).sum();
        let mean = |of: &dyn Fn(&Region) -> f64| own.iter().map(|r| r.area as f64 * of(r)).sum::<f64>() / own_area.max(1) as f64;
        let least = (4.0 * thickness).powi(2).max(64.0);
        let inner: Vec<Region> = rest.iter().skip(1).filter(|r| r.area as f64 > least).copied().collect();
        Self {
            share: area as f64 / all,
            thickness,
            far_reaching: far as f64 / own_area.max(1) as f64,
            region_area: mean(&|r| r.area as f64),
            region_length: mean(&|r| r.length() as f64),
            divides: effective_number(&rest),
            gaps: rest.iter().map(|r| r.area).collect(),
            inner_divides: effective_number(&inner),
        }
    }

    /// How much it is a network that divides a city into blocks: into many, and connected far and wide.
    pub(super) fn network(&self) -> f64 {
        self.divides * self.far_reaching
    }

    /// How many regions of some size it leaves: larger than a crossroads of streets as wide as `thickness`.
    pub(super) fn blocks(&self, thickness: f64) -> usize {
        self.gaps.partition_point(|&area| area as f64 > (2.0 * thickness).powi(2).max(36.0))
    }
}

/// Strokes wider than this are still there without their outermost pixels.
const SOFT: f64 = 4.0;

/// A mask (1) of the pixels whose four neighbours are all of a set of colours.
fn eroded(sheet: &Sheet, is_in: &dyn Fn(u8) -> bool) -> Sheet {
    let inside: [bool; 256] = core::array::from_fn(|c| is_in(c as u8));
    let (width, height) = (sheet.width, sheet.height);
    let at = |x: usize, y: usize| inside[usize::from(sheet.colours[y * width + x])];
    let is_core = |x: usize, y: usize| {
        at(x, y)
            && at(x.saturating_sub(1), y)
            && at((x + 1).min(width - 1), y)
            && at(x, y.saturating_sub(1))
            && at(x, (y + 1).min(height - 1))
    };
    let colours = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| u8::from(is_core(x, y)));
    Sheet { width, height, colours: colours.collect() }
}

/// Length of the edge between a set of colours and the others, in sides of pixels; the border of the sheet is none.
fn edge(sheet: &Sheet, is_in: &dyn Fn(u8) -> bool) -> usize {
    let inside: [bool; 256] = core::array::from_fn(|c| is_in(c as u8));
    let differ = |a: &u8, b: &u8| inside[usize::from(*a)] != inside[usize::from(*b)];
    let width = sheet.width.max(1);
    let across = sheet.colours.chunks_exact(width).map(|row| row.windows(2).filter(|w| differ(&w[0], &w[1])).count());
    let down = sheet.colours.iter().zip(sheet.colours.iter().skip(width)).filter(|(a, b)| differ(a, b));
    across.sum::<usize>() + down.count()
}

/// What a colour is to another, as [`shared_edge`] sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// Its edge is looked at.
    Own,
    /// What it may share its edge with.
    With,
    /// Hardly to be told from it: no edge.
    Alike,
    /// Anything else.
    Other,
}

/// Share of the edge of some colours that is shared with others; looked at from pixel to pixel `over` apart, so that soft edges
/// are stepped over.
pub(super) fn shared_edge(sheet: &Sheet, over: usize, side_of: &dyn Fn(u8) -> Side) -> f64 {
    let side: [Side; 256] = core::array::from_fn(|c| side_of(c as u8));
    let (mut shared, mut other) = (0usize, 0usize);
    let mut meet = |p: u8, q: u8| match (side[usize::from(p)], side[usize::from(q)]) {
        (Side::Own, Side::With) | (Side::With, Side::Own) => shared += 1,
        (Side::Own, Side::Other) | (Side::Other, Side::Own) => other += 1,
        _ => {}
    };
    let width = sheet.width.max(1);
    sheet.colours.chunks_exact(width).for_each(|row| row.iter().zip(row.iter().skip(over)).for_each(|(&p, &q)| meet(p, q)));
    sheet.colours.iter().zip(sheet.colours.iter().skip(over * width)).for_each(|(&p, &q)| meet(p, q));
    shared as f64 / (shared + other).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sheet(rows: &[&str]) -> Sheet {
        let colours = rows.iter().flat_map(|r| r.bytes().map(|b| u8::from(b == b'#'))).collect();
        Sheet { width: rows[0].len(), height: rows.len(), colours }
    }

    #[test]
    fn a_cross_of_streets_makes_four_blocks() {
        let sheet = sheet(&["..#..", "..#..", "#####", "..#..", "..#.."]);
        let shape = Shape::of(&sheet, &|c| c == 1);
        assert!((shape.divides - 4.0).abs() < 1e-9 && shape.far_reaching == 1.0, "{shape:?}");
        assert!(Shape::of(&sheet, &|c| c == 0).divides < 1.01, "the blocks do not divide the streets");
    }

    #[test]
    fn a_block_has_its_edge_with_streets_and_a_street_across_has_not() {
        // 0 street, 1 block, 2 main street.
        let rows = ["0111220", "0111220", "0000220", "0111220"];
        let colours = rows.iter().flat_map(|r| r.bytes().map(|b| b - b'0')).collect();
        let sheet = Sheet { width: 7, height: 4, colours };
        let edge = |of: u8, with: u8| {
            shared_edge(&sheet, 1, &|c| {
                if c == of {
                    Side::Own
                } else if c == with {
                    Side::With
                } else {
                    Side::Other
                }
            })
        };
        assert!((edge(1, 0) - 9.0 / 12.0).abs() < 1e-9, "{}", edge(1, 0));
        assert!((edge(2, 0) - 5.0 / 8.0).abs() < 1e-9, "{}", edge(2, 0));
        assert_eq!(edge(0, 7), 0.0);
    }

    #[test]
    fn corners_join_only_where_asked() {
        let sheet = sheet(&["#..", ".#.", "..#"]);
        assert_eq!(regions(&sheet, &|c| c == 1, true).0.len(), 1);
        assert_eq!(regions(&sheet, &|c| c == 1, false).0.len(), 3);
        assert_eq!(regions(&sheet, &|c| c == 0, false).0.len(), 2);
    }

    proptest! {
        #[test]
        fn regions_are_those_of_a_flood(bits in proptest::collection::vec(any::<bool>(), 63), by_corners in any::<bool>()) {
            let sheet = Sheet { width: 9, height: 7, colours: bits.iter().map(|&b| u8::from(b)).collect() };
            let mut areas = Vec::new();
            let mut seen = [false; 63];
            for start in 0..63 {
                if !bits[start] || seen[start] {
                    continue;
                }
                let (mut area, mut todo) = (0, vec![start]);
                seen[start] = true;
                while let Some(at) = todo.pop() {
                    area += 1;
                    for other in 0..63 {
                        let apart = [(at % 9).abs_diff(other % 9), (at / 9).abs_diff(other / 9)];
                        let is_next = apart[0].max(apart[1]) == 1 && (by_corners || apart[0] + apart[1] == 1);
                        if is_next && bits[other] && !seen[other] {
                            seen[other] = true;
                            todo.push(other);
                        }
                    }
                }
                areas.push(area);
            }
            areas.sort_by(|a, b| b.cmp(a));
            let (found, labels) = regions(&sheet, &|c| c == 1, by_corners);
            prop_assert_eq!(found.iter().map(|r| r.area).collect::<Vec<_>>(), areas);
            for (i, region) in found.iter().enumerate() {
                let of = labels.iter().filter(|l| l.3 == i);
                prop_assert_eq!(of.map(|(_, from, to, _)| to - from).sum::<usize>(), region.area);
            }
        }
    }
}
