//! Houses that follow one another in one year.
//!
//! Where maps know years alone, a house that went in 1876 and the one that took its place in 1876 both stand in that year.
//! Two houses cannot, so the later one does; but a house that went in 1876 and was followed by none, or by one of 1877, stands.

use super::feature::{Feature, Shape};
use super::space::Space;
use crate::buildings::Index;
use crate::polygon::Polygon;

/// Areas of a layer that came to be in the very year, month or day that is shown.
pub(super) struct Successors {
    areas: Vec<Polygon>,
    index: Index,
}

impl Successors {
    pub(super) fn new<'a>(features: impl Iterator<Item = &'a Feature>, space: &Space) -> Self {
        let areas: Vec<Polygon> = features.flat_map(|f| areas_of(f, space)).collect();
        let index = Index::new(areas.iter());
        Self { areas, index }
    }

    /// Whether one of them stands where a feature stood: the middle of one lies in the other.
    pub(super) fn replace(&self, feature: &Feature, space: &Space) -> bool {
        areas_of(feature, space).iter().any(|old| {
            let (low, high) = old.bounds();
            let near = self.index.near(low, high).into_iter().filter_map(|i| self.areas.get(i));
            near.into_iter().any(|new| old.contains(new.inner_pos()) || new.contains(old.inner_pos()))
        })
    }
}

/// The outlines of a feature, about in metres; where its rings stand beside one another, each by itself.
fn areas_of(feature: &Feature, space: &Space) -> Vec<Polygon> {
    let rings = feature.shapes.iter().filter_map(|s| if let Shape::Rings(rings) = s { Some(rings) } else { None });
    let outer = rings.flatten().filter(|(_, is_inner)| !is_inner);
    let polygon = |(ring, _): &(Vec<glam::DVec2>, bool)| Polygon {
        outer: ring.iter().filter_map(|p| space.geo(*p)).map(|(lat, lon)| super::elements::grid(lat, lon)).collect(),
        holes: Vec::new(),
    };
    outer.map(polygon).filter(|p| p.outer.len() > 3).collect()
}
