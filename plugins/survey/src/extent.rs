use glam::DVec2;
use veduta_city::{Anchor, Finding, Id, Severity};

use crate::log::Log;
use crate::osm::{Bounds, Node, OsmData};

/// How far beyond the bounds that a file states, or that its streets and houses fill, things are kept, in metres: houses and
/// trees on the border stay whole.
const BEYOND_BOUNDS_M: f64 = 50.0;
/// Nodes that fill less than this share of the stated bounds show that the bounds are not theirs.
const PASSED_ON_SHARE: f64 = 0.1;
/// So few nodes show nothing.
const TELLING_NODES: usize = 20;
/// Side of the largest extent that is taken as one city, in metres: beyond it the plan's tangent plane is no good.
const LARGEST_M: f64 = 50_000.0;

/// Where the city lies: the anchor, and the box in plan metres that things are clipped to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    pub anchor: Anchor,
    /// Least corner in plan metres.
    pub low: DVec2,
    /// Greatest corner in plan metres.
    pub high: DVec2,
}

impl Extent {
    /// Plan position of a node.
    pub(crate) fn plan_pos(&self, node: &Node) -> DVec2 {
        self.anchor.plan_from_geo(node.lat, node.lon)
    }

    pub(crate) fn contains(&self, plan_pos: DVec2) -> bool {
        plan_pos.cmpge(self.low).all() && plan_pos.cmple(self.high).all()
    }

    /// The box as a ring, counter-clockwise.
    pub(crate) fn ring(&self) -> Vec<DVec2> {
        vec![self.low, DVec2::new(self.high.x, self.low.y), self.high, DVec2::new(self.low.x, self.high.y)]
    }

    /// The extent of a file: its stated bounds if they fit its nodes, otherwise where most nodes of
    /// streets and houses are. Outliers (the far ends
    /// of ferry lines, of motorways, of boundaries) do not stretch it.
    pub(crate) fn of(data: &OsmData, log: &mut Log) -> Option<Self> {
        let own = Self::of_file(data, log)?;
        Some(data.anchor.map_or(own, |anchor| own.anchored_at(anchor)))
    }

    /// The same box, seen from another anchor.
    fn anchored_at(&self, anchor: Anchor) -> Self {
        let seen = |corner: DVec2| {
            let (lat, lon) = self.anchor.geo_from_plan(corner);
            anchor.plan_from_geo(lat, lon)
        };
        Self { anchor, low: seen(self.low), high: seen(self.high) }
    }

    fn of_file(data: &OsmData, log: &mut Log) -> Option<Self> {
        let first = data.nodes.values().next()?;
        let all = settled_positions(data, first.lon);
        if let Some(bounds) = data.bounds {
            match Self::of_bounds(bounds, &all, first.lon) {
                Some(extent) => return Some(extent),
                None => log.push(Finding::new(
                    Severity::Note,
                    Id::NONE,
                    None,
                    "the bounds that the file states do not fit its nodes: the nodes' own extent is used",
                )),
            }
        }
        Self::of_positions(&all).or_else(|| Self::of_densest(data, first.lon, log))
    }

    fn of_bounds(bounds: Bounds, all: &[(f64, f64)], reference: f64) -> Option<Self> {
        let (west, east) = (around(bounds.west, reference), around(bounds.east, reference));
        let inside = |&&(lat, lon): &&(f64, f64)| lat >= bounds.south && lat <= bounds.north && lon >= west && lon <= east;
        if all.iter().filter(inside).count() * 5 < all.len() {
            return None;
        }
        let stated = Self::of_corners((bounds.south, west), (bounds.north, east));
        // Tools that cut a small piece out of a large extract often pass the large one's bounds on.
        let settled = Self::of_positions(all).unwrap_or(stated);
        let size = |e: &Self| (e.high - e.low).element_product();
        if all.len() >= TELLING_NODES && size(&settled) < PASSED_ON_SHARE * size(&stated) {
            return Some(settled);
        }
        stated.fits().then(|| Self { low: stated.low - BEYOND_BOUNDS_M, high: stated.high + BEYOND_BOUNDS_M, ..stated })
    }

    /// The box of the middle nine tenths, widened, then shrunk to the nodes inside.
    fn of_positions(all: &[(f64, f64)]) -> Option<Self> {
        let sorted = |pick: fn(&(f64, f64)) -> f64| {
            let mut values: Vec<f64> = all.iter().map(pick).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let (lats, lons) = (sorted(|p| p.0), sorted(|p| p.1));
        let span = |values: &[f64]| {
            let at = |part: usize| values.get(values.len().saturating_sub(1) * part / 20).copied();
            let (low, high) = (at(1)?, at(19)?);
            // About 100 m, and a third of the span.
            let more = 0.001 + (high - low) / 3.0;
            let least = values.iter().copied().find(|&v| v >= low - more)?;
            let most = values.iter().rev().copied().find(|&v| v <= high + more)?;
            Some((least, most))
        };
        let ((south, north), (west, east)) = (span(&lats)?, span(&lons)?);
        let box_ = Self::of_corners((south, west), (north, east));
        box_.fits().then(|| Self { low: box_.low - BEYOND_BOUNDS_M, high: box_.high + BEYOND_BOUNDS_M, ..box_ })
    }

    /// Where things are scattered over a country: the surroundings of the densest part. Every way counts once, by its first
    /// node, so that one intricate building does not outweigh a village.
    fn of_densest(data: &OsmData, reference: f64, log: &mut Log) -> Option<Self> {
        const BIN: f64 = 0.05;
        let firsts = data.ways.values().filter_map(|w| w.nodes.iter().find_map(|id| data.nodes.get(id)));
        let mut all: Vec<(f64, f64)> = firsts.map(|n| (n.lat, around(n.lon, reference))).collect();
        if all.is_empty() {
            all = data.nodes.values().map(|n| (n.lat, around(n.lon, reference))).collect();
        }
        let bin = |&(lat, lon): &(f64, f64)| ((lat / BIN).floor() as i64, (lon / BIN).floor() as i64);
        let mut bins = std::collections::BTreeMap::<_, usize>::new();
        all.iter().for_each(|p| *bins.entry(bin(p)).or_default() += 1);
        let around_bin = |&(y, x): &(i64, i64)| -> usize {
            (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (y + dy, x + dx))).filter_map(|b| bins.get(&b)).sum()
        };
        let densest = *bins.keys().max_by_key(|&b| (around_bin(b), core::cmp::Reverse(*b)))?;
        let near: Vec<_> =
            all.iter().copied().filter(|p| ((bin(p).0 - densest.0).abs() <= 1) && ((bin(p).1 - densest.1).abs() <= 1)).collect();
        let extent = Self::of_positions(&near)?;
        let far = all.len() - near.len();
        log.push(Finding::new(
            Severity::Dropped,
            Id::NONE,
            Some(DVec2::ZERO),
            format!(
                "{far} of {} ways lie scattered too far away for one city: only the surroundings of the densest part are kept",
                all.len()
            ),
        ));
        Some(extent)
    }

    fn of_corners((south, west): (f64, f64), (north, east): (f64, f64)) -> Self {
        let anchor = Anchor { lat: f64::midpoint(south, north), lon: around(f64::midpoint(west, east), 0.0) };
        Self { anchor, low: anchor.plan_from_geo(south, west), high: anchor.plan_from_geo(north, east) }
    }

    fn fits(&self) -> bool {
        let size = self.high - self.low;
        size.cmpge(DVec2::ZERO).all() && size.max_element() <= LARGEST_M
    }
}

/// Latitudes and longitudes of the nodes of streets and houses: coasts, ferries and boundaries reach far beyond a town and
/// have many nodes. All nodes where there are next to none of either.
fn settled_positions(data: &OsmData, reference: f64) -> Vec<(f64, f64)> {
    let settled = data.ways.values().filter(|w| w.tags.has("highway") || w.tags.has("building") || w.tags.has("building:part"));
    let nodes = settled.flat_map(|w| &w.nodes).filter_map(|id| data.nodes.get(id));
    let position = |n: &Node| (n.lat, around(n.lon, reference));
    let out: Vec<(f64, f64)> = nodes.map(position).collect();
    if out.len() < TELLING_NODES { data.nodes.values().map(position).collect() } else { out }
}

/// A longitude as the one within half a turn of another.
fn around(lon: f64, reference: f64) -> f64 {
    let turns = ((lon - reference) / 360.0).round();
    lon - 360.0 * turns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::Tags;

    fn data(positions: &[(f64, f64)]) -> OsmData {
        let mut data = OsmData::default();
        for (i, &(lat, lon)) in positions.iter().enumerate() {
            data.add_node(i as i64, lat, lon, Tags::default());
        }
        data
    }

    fn town() -> Vec<(f64, f64)> {
        (0..400).map(|i| (50.0 + f64::from(i % 20) * 0.0005, 14.0 + f64::from(i / 20) * 0.0005)).collect()
    }

    #[test]
    fn a_ferry_does_not_stretch_the_town() {
        let mut positions = town();
        positions.extend([(45.0, 14.0), (44.0, 13.0), (51.0, 19.0)]);
        let extent = Extent::of(&data(&positions), &mut Log::default()).unwrap();
        assert!((extent.high - extent.low).max_element() < 1200.0, "{extent:?}");
        assert!((extent.anchor.lat - 50.004_75).abs() < 0.001, "{extent:?}");
    }

    #[test]
    fn stated_bounds_count_if_nodes_lie_there() {
        let mut data = data(&town());
        data.bounds = Some(Bounds { south: 50.002, west: 14.002, north: 50.008, east: 14.008 });
        let extent = Extent::of(&data, &mut Log::default()).unwrap();
        assert_eq!((extent.anchor.lat * 1e6).round(), 50.005e6);
        data.bounds = Some(Bounds { south: 49.5, west: 13.5, north: 50.1, east: 14.1 });
        let extent = Extent::of(&data, &mut Log::default()).unwrap();
        assert!((extent.high - extent.low).max_element() < 1500.0, "bounds of a larger extract were passed on: {extent:?}");
        data.bounds = Some(Bounds { south: 10.0, west: 10.0, north: 10.1, east: 10.1 });
        let mut log = Log::default();
        assert!((Extent::of(&data, &mut log).unwrap().anchor.lat - 50.0).abs() < 0.1);
        assert!(log.finish()[0].message.contains("do not fit"));
    }

    #[test]
    fn a_country_is_reduced_to_its_densest_part_with_a_finding() {
        let mut positions = town();
        positions.extend((0..300).map(|i| (40.0 + f64::from(i) * 0.05, 5.0 + f64::from(i) * 0.03)));
        let mut log = Log::default();
        let extent = Extent::of(&data(&positions), &mut log).unwrap();
        assert!((extent.anchor.lat - 50.0).abs() < 0.1, "{extent:?}");
        assert!(log.finish().iter().any(|f| f.message.contains("scattered")), "the finding names what is lost");
    }

    #[test]
    fn a_town_on_the_date_line_is_one_town() {
        let positions: Vec<_> = town().into_iter().map(|(lat, lon)| (lat, around(lon - 14.005 + 180.0, 0.0))).collect();
        let extent = Extent::of(&data(&positions), &mut Log::default()).unwrap();
        assert!((extent.high - extent.low).max_element() < 1500.0, "{extent:?}");
    }
}
