use serde::{Deserialize, Serialize};
use veduta_city::{GridPolygon, HouseName, MAP_STEP, Overview, PlanStreet, PlanTerrain, SurfaceKind, WaySpan};

use super::{
    Malformed,
    columns::{Deltas, Ids, Pull, Texts},
    places::WirePlaces,
    points::{PointWriter, Points, PullPoints},
    terrain::WireTerrain,
};

/// An [`Overview`] in columns.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireOverview {
    terrain: WireTerrain,
    /// Outlines of houses and areas, in steps of maps.
    outlines: Points,
    /// Lines of streets.
    lines: Points,
    /// Names of streets, then name and number of each named house.
    texts: Texts,
    street_ids: Ids,
    widths: Vec<i32>,
    walkable: Vec<bool>,
    layers: Vec<i8>,
    areas: Vec<SurfaceKind>,
    heights: Vec<i32>,
    named: Deltas,
    spans: Vec<WaySpan>,
    places: WirePlaces,
}

impl From<&Overview> for WireOverview {
    fn from(overview: &Overview) -> Self {
        let mut outlines = PointWriter::default();
        let houses = overview.houses.iter().map(|(outline, _)| outline);
        houses
            .chain(overview.areas.iter().map(|(_, outline)| outline))
            .for_each(|outline| outlines.polygon(&in_map_steps(outline)));
        let (mut lines, mut street_ids) = (PointWriter::default(), Ids::default());
        for street in &overview.streets {
            street_ids.push(street.id);
            lines.line(&street.line);
        }
        let streets = overview.streets.iter().map(|street| street.name.as_str());
        let names = overview.names.iter().flat_map(|name| [name.name.as_str(), name.number.as_str()]);
        Self {
            terrain: WireTerrain::from(&overview.terrain),
            outlines: outlines.finish(),
            lines: lines.finish(),
            texts: Texts::of(streets.chain(names)),
            street_ids,
            widths: overview.streets.iter().map(|street| street.width).collect(),
            walkable: overview.streets.iter().map(|street| street.walkable).collect(),
            layers: overview.streets.iter().map(|street| street.layer).collect(),
            areas: overview.areas.iter().map(|&(surface, _)| surface).collect(),
            heights: overview.houses.iter().map(|&(_, height)| height / MAP_STEP).collect(),
            named: Deltas::of(overview.names.iter().map(|name| name.house as i32)),
            spans: overview.spans.clone(),
            places: WirePlaces::of(&overview.places),
        }
    }
}

impl TryFrom<WireOverview> for Overview {
    type Error = Malformed;

    fn try_from(wire: WireOverview) -> Result<Self, Malformed> {
        let mut points = wire.outlines.pull();
        let mut outline = || points.polygon().map(in_grid_steps);
        let mut texts = wire.texts.pull()?;
        let heights = wire.heights.into_iter();
        let houses = heights.map(|height| Ok((outline()?, height.saturating_mul(MAP_STEP)))).collect::<Result<_, _>>()?;
        let areas = wire.areas.into_iter().map(|surface| Ok((surface, outline()?))).collect::<Result<_, _>>()?;
        points.finish()?;
        let mut points = wire.lines.pull();
        let lines = Lines { ids: wire.street_ids, widths: wire.widths, walkable: wire.walkable, layers: wire.layers };
        let streets = lines.pull(&mut points, || texts.take())?;
        points.finish()?;
        let names = wire
            .named
            .numbers()
            .into_iter()
            .map(|house| Ok(HouseName { house: house as u32, name: texts.take()?, number: texts.take()? }))
            .collect::<Result<_, _>>()?;
        texts.finish()?;
        let (terrain, places) = (PlanTerrain::try_from(wire.terrain)?, wire.places.pull()?);
        Ok(Self { terrain, streets, areas, houses, names, spans: wire.spans, places })
    }
}

fn scaled(mut polygon: GridPolygon, scale: impl Fn(i32) -> i32) -> GridPolygon {
    for pos in core::iter::once(&mut polygon.outer).chain(&mut polygon.holes).flatten() {
        (pos.0, pos.1) = (scale(pos.0), scale(pos.1));
    }
    polygon
}

/// An outline on a map, told by the steps of maps.
fn in_map_steps(outline: &GridPolygon) -> GridPolygon {
    scaled(outline.clone(), |steps| steps.div_euclid(MAP_STEP))
}

fn in_grid_steps(outline: GridPolygon) -> GridPolygon {
    scaled(outline, |steps| steps.saturating_mul(MAP_STEP))
}

/// Columns of streets.
struct Lines {
    ids: Ids,
    widths: Vec<i32>,
    walkable: Vec<bool>,
    layers: Vec<i8>,
}

impl Lines {
    fn pull(
        self,
        points: &mut PullPoints,
        mut name: impl FnMut() -> Result<String, Malformed>,
    ) -> Result<Vec<PlanStreet>, Malformed> {
        let mut ids = self.ids.pull();
        let mut walkable = Pull::new("walkable streets", self.walkable);
        let mut layers = Pull::new("layers of streets", self.layers);
        let mut streets = Vec::with_capacity(self.widths.len());
        for width in self.widths {
            streets.push(PlanStreet {
                id: ids.take()?,
                name: name()?,
                line: points.line()?,
                width,
                walkable: walkable.take()?,
                layer: layers.take()?,
            });
        }
        ids.finish()?;
        walkable.finish()?;
        layers.finish()?;
        Ok(streets)
    }
}
