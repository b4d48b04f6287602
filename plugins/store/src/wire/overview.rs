use serde::{Deserialize, Serialize};
use veduta_city::{HouseName, ObjectKind, Overview, PlanStreet, PlanTerrain, SurfaceKind, WaySpan};

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
    points: Points,
    /// Names of streets, then name and number of each named house.
    texts: Texts,
    street_ids: Ids,
    widths: Vec<i32>,
    walkable: Vec<bool>,
    layers: Vec<i8>,
    areas: Vec<SurfaceKind>,
    house_ids: Ids,
    tops: Deltas,
    named: Deltas,
    objects: Vec<ObjectKind>,
    spans: Vec<WaySpan>,
    places: WirePlaces,
}

impl From<&Overview> for WireOverview {
    fn from(overview: &Overview) -> Self {
        let mut points = PointWriter::default();
        let (mut street_ids, mut house_ids) = (Ids::default(), Ids::default());
        for (id, outline, _) in &overview.houses {
            house_ids.push(*id);
            points.polygon(outline);
        }
        overview.areas.iter().for_each(|(_, outline)| points.polygon(outline));
        for street in &overview.streets {
            street_ids.push(street.id);
            points.line(&street.line);
        }
        overview.objects.iter().for_each(|&(_, pos)| points.point(pos));
        let streets = overview.streets.iter().map(|street| street.name.as_str());
        let names = overview.names.iter().flat_map(|name| [name.name.as_str(), name.number.as_str()]);
        Self {
            terrain: WireTerrain::from(&overview.terrain),
            points: points.finish(),
            texts: Texts::of(streets.chain(names)),
            street_ids,
            widths: overview.streets.iter().map(|street| street.width).collect(),
            walkable: overview.streets.iter().map(|street| street.walkable).collect(),
            layers: overview.streets.iter().map(|street| street.layer).collect(),
            areas: overview.areas.iter().map(|&(surface, _)| surface).collect(),
            house_ids,
            tops: Deltas::of(overview.houses.iter().map(|&(_, _, top)| top)),
            named: Deltas::of(overview.names.iter().map(|name| name.house as i32)),
            objects: overview.objects.iter().map(|&(kind, _)| kind).collect(),
            spans: overview.spans.clone(),
            places: WirePlaces::of(&overview.places),
        }
    }
}

impl TryFrom<WireOverview> for Overview {
    type Error = Malformed;

    fn try_from(wire: WireOverview) -> Result<Self, Malformed> {
        let mut points = wire.points.pull();
        let mut texts = wire.texts.pull()?;
        let mut ids = wire.house_ids.pull();
        let houses =
            wire.tops.numbers().into_iter().map(|top| Ok((ids.take()?, points.polygon()?, top))).collect::<Result<_, _>>()?;
        ids.finish()?;
        let areas = wire.areas.into_iter().map(|surface| Ok((surface, points.polygon()?))).collect::<Result<_, _>>()?;
        let lines = Lines { ids: wire.street_ids, widths: wire.widths, walkable: wire.walkable, layers: wire.layers };
        let streets = lines.pull(&mut points, || texts.take())?;
        let objects = wire.objects.into_iter().map(|kind| Ok((kind, points.point()?))).collect::<Result<_, _>>()?;
        points.finish()?;
        let names = wire
            .named
            .numbers()
            .into_iter()
            .map(|house| Ok(HouseName { house: house as u32, name: texts.take()?, number: texts.take()? }))
            .collect::<Result<_, _>>()?;
        texts.finish()?;
        let (terrain, places) = (PlanTerrain::try_from(wire.terrain)?, wire.places.pull()?);
        Ok(Self { terrain, streets, areas, houses, names, objects, spans: wire.spans, places })
    }
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
