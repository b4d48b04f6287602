use serde::{Deserialize, Serialize};
use veduta_city::{
    District, GridPolygon, GridPos, GroundPatch, HouseName, MAP_STEP, Massing, Overview, PlanRoof, PlanStreet, PlanTerrain, Rgb,
    RoofShape, StreetClass, SurfaceKind, WaySpan, on_map,
};

use super::{
    Malformed,
    columns::{Deltas, Ids, Pull, Table, TableWriter, Texts},
    expecting,
    places::WirePlaces,
    terrain::WireTerrain,
};
use crate::OverviewContext;
use crate::code::{Outlines, Source, Unread};

/// Sections of outlines: of houses and of the ground, in steps of maps; of streets.
const HOUSES: u8 = 0;
const GROUND: u8 = 1;
const STREETS: u8 = 2;

/// An [`Overview`] in columns.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireOverview {
    terrain: WireTerrain,
    /// Names of streets, then name and number of each named house.
    texts: Texts,
    street_ids: Ids,
    widths: Vec<i32>,
    walkable: Vec<bool>,
    layers: Vec<i8>,
    ground: Vec<WireGround>,
    houses: Vec<WireMassing>,
    /// Colours of walls, then of roofs.
    paints: Table<(u8, u8, u8)>,
    named: Deltas,
    spans: Vec<WaySpan>,
    places: WirePlaces,
    /// Cells of districts.
    cells: Deltas,
    /// How many pieces of ground, houses and spans each has; none told: the houses that are known of its cell.
    districts: Vec<(u32, Option<u32>, u32)>,
    /// Of streets.
    classes: Vec<StreetClass>,
    /// How many entries each named house has.
    parts: Vec<u32>,
}

#[derive(Serialize, Deserialize)]
struct WireGround {
    surface: SurfaceKind,
    z: i32,
}

/// Heights in steps of maps.
#[derive(Serialize, Deserialize)]
struct WireMassing {
    height: i32,
    shape: RoofShape,
    rise: i32,
    /// How many quarter turns the roof's direction is from that of the longest edge.
    quarter: u8,
}

impl WireMassing {
    fn of(massing: &Massing) -> Self {
        let PlanRoof { shape, height, direction, .. } = massing.roof;
        let quarter = Massing::nearest_quarter(&massing.outline, direction);
        Self { height: massing.height / MAP_STEP, shape, rise: height / MAP_STEP, quarter }
    }

    fn massing(self, outline: GridPolygon, [wall, roof]: [Rgb; 2]) -> Massing {
        let height = self.rise.saturating_mul(MAP_STEP);
        let roof =
            PlanRoof { shape: self.shape, height, direction: Massing::quarter_deg(&outline, self.quarter & 3), colour: roof };
        Massing { outline, height: self.height.saturating_mul(MAP_STEP), roof, colour: wall }
    }
}

impl WireOverview {
    pub(crate) fn of(overview: &Overview, context: OverviewContext<'_>) -> (Self, Outlines) {
        let mut outlines = Outlines::default();
        let (mut rest, mut ground) = (&overview.houses[..], overview.ground.iter());
        let (mut houses, mut districts) = (Vec::new(), Vec::with_capacity(overview.districts.len()));
        for district in &overview.districts {
            if let Some(outline) = known(context, district.cell) {
                outlines.know(&outline);
            }
            let (here, after) = rest.split_at_checked(district.houses as usize).unwrap_or((rest, &[]));
            rest = after;
            let is_known = here.len() == district.houses as usize && known_houses(context, district.cell) == here;
            for massing in here {
                let outline = in_map_steps(&massing.outline);
                if is_known { outlines.know(&outline) } else { outlines.polygon(HOUSES, &outline) }
            }
            houses.extend(if is_known { &[] } else { here });
            districts.push((district.ground, (!is_known).then_some(district.houses), district.spans));
            let here = ground.by_ref().take(district.ground as usize);
            here.for_each(|patch| outlines.polygon(GROUND, &in_map_steps(&patch.outline)));
        }
        rest.iter().for_each(|massing| outlines.polygon(HOUSES, &in_map_steps(&massing.outline)));
        houses.extend(rest);
        ground.for_each(|patch| outlines.polygon(GROUND, &in_map_steps(&patch.outline)));
        let mut paints = TableWriter::default();
        let colours = houses.iter().map(|massing| massing.colour);
        colours.chain(houses.iter().map(|massing| massing.roof.colour)).for_each(|Rgb(r, g, b)| paints.push(&(r, g, b)));
        let mut street_ids = Ids::default();
        for street in &overview.streets {
            street_ids.push(street.id);
            outlines.line(STREETS, &street.line);
        }
        let streets = overview.streets.iter().map(|street| street.name.as_str());
        let names = overview.names.iter().flat_map(|name| [name.name.as_str(), name.number.as_str()]);
        let wire = Self {
            terrain: WireTerrain::from(&overview.terrain),
            texts: Texts::of(streets.chain(names)),
            street_ids,
            widths: overview.streets.iter().map(|street| street.width).collect(),
            walkable: overview.streets.iter().map(|street| street.walkable).collect(),
            layers: overview.streets.iter().map(|street| street.layer).collect(),
            ground: overview.ground.iter().map(|patch| WireGround { surface: patch.surface, z: patch.z }).collect(),
            houses: houses.into_iter().map(WireMassing::of).collect(),
            paints: paints.finish(),
            named: Deltas::of(overview.names.iter().map(|name| name.house as i32)),
            spans: overview.spans.clone(),
            places: WirePlaces::of(&overview.places),
            cells: Deltas::of(overview.districts.iter().map(|district| district.cell as i32)),
            districts,
            classes: overview.streets.iter().map(|street| street.class).collect(),
            parts: overview.names.iter().map(|name| name.parts).collect(),
        };
        (wire, outlines)
    }

    pub(crate) fn pull(self, context: OverviewContext<'_>, outlines: &mut Source<'_, '_>) -> Result<Overview, Unread> {
        let wire = self;
        let cells = wire.cells.numbers();
        if cells.len() != wire.districts.len() {
            return Err(Malformed::Reason("there are not as many districts as cells").into());
        }
        // Else what is known of one cell would be told again and again.
        if !cells.is_sorted_by(|&a, &b| (a as u32) < b as u32) {
            return Err(Malformed::Reason("cells of districts do not ascend").into());
        }
        let mut texts = wire.texts.pull()?;
        let mut paints = wire.paints.pull();
        let mut paint = || paints.take_ref().map(|&(r, g, b)| Rgb(r, g, b));
        let walls = wire.houses.iter().map(|_| paint()).collect::<Result<Vec<_>, _>>()?;
        let mut rows = wire.houses.into_iter().zip(walls);
        let mut patches = wire.ground.into_iter();
        let (mut houses, mut ground) = (expecting(rows.len()), expecting(patches.len()));
        let mut districts = expecting(cells.len());
        let mut tell_houses = |houses: &mut Vec<Massing>, outlines: &mut Source<'_, '_>, many: usize| -> Result<(), Unread> {
            for (row, wall) in rows.by_ref().take(many) {
                houses.push(row.massing(in_grid_steps(&outlines.polygon(HOUSES)?), [wall, paint()?]));
            }
            Ok(())
        };
        let mut tell_ground = |outlines: &mut Source<'_, '_>, many: usize| -> Result<(), Unread> {
            for WireGround { surface, z } in patches.by_ref().take(many) {
                ground.push(GroundPatch { surface, outline: in_grid_steps(&outlines.polygon(GROUND)?), z, course: None });
            }
            Ok(())
        };
        for (cell, (of_ground, of_houses, spans)) in cells.into_iter().map(|cell| cell as u32).zip(wire.districts) {
            if let Some(outline) = known(context, cell) {
                outlines.know(&outline);
            }
            let before = houses.len();
            match of_houses {
                Some(many) => tell_houses(&mut houses, outlines, many as usize)?,
                None => houses.extend(known_houses(context, cell)),
            }
            if of_houses.is_none() {
                houses[before..].iter().for_each(|massing| outlines.know(&in_map_steps(&massing.outline)));
            }
            tell_ground(outlines, of_ground as usize)?;
            let many = of_houses.unwrap_or((houses.len() - before) as u32);
            districts.push(District { cell, ground: of_ground, houses: many, spans });
        }
        tell_houses(&mut houses, outlines, usize::MAX)?;
        tell_ground(outlines, usize::MAX)?;
        paints.finish()?;
        let lines = Lines {
            ids: wire.street_ids,
            widths: wire.widths,
            walkable: wire.walkable,
            layers: wire.layers,
            classes: wire.classes,
        };
        let streets = lines.pull(outlines, || texts.take())?;
        let mut parts = Pull::new("parts of named houses", wire.parts);
        let named =
            wire.named.numbers().into_iter().map(|house| {
                Ok(HouseName { house: house as u32, name: texts.take()?, number: texts.take()?, parts: parts.take()? })
            });
        let names = named.collect::<Result<_, Malformed>>()?;
        parts.finish()?;
        texts.finish()?;
        let (terrain, places) = (PlanTerrain::try_from(wire.terrain)?, wire.places.pull()?);
        Ok(Overview { terrain, streets, ground, houses, names, spans: wire.spans, places, districts })
    }
}

/// What is known of a cell's vertices, in steps of maps.
fn known(context: OverviewContext<'_>, cell: u32) -> Option<GridPolygon> {
    let cell = context.cells.get(cell.checked_sub(context.first)? as usize)?;
    on_map(&cell.outline).map(|outline| in_map_steps(&outline))
}

/// What is known of its houses.
fn known_houses(context: OverviewContext<'_>, cell: u32) -> Vec<Massing> {
    let place = cell.checked_sub(context.first).map(|place| place as usize);
    let parts = context.houses.zip(place).map_or(&[][..], |(houses, place)| houses.of_cell(place));
    parts.iter().filter_map(|part| part.massing.on_map()).collect()
}

/// An outline on a map, told by the steps of maps.
fn in_map_steps(outline: &GridPolygon) -> GridPolygon {
    outline.map(|pos| GridPos(pos.0.div_euclid(MAP_STEP), pos.1.div_euclid(MAP_STEP)))
}

fn in_grid_steps(outline: &GridPolygon) -> GridPolygon {
    outline.map(|pos| GridPos(pos.0.saturating_mul(MAP_STEP), pos.1.saturating_mul(MAP_STEP)))
}

/// Columns of streets.
struct Lines {
    ids: Ids,
    widths: Vec<i32>,
    walkable: Vec<bool>,
    layers: Vec<i8>,
    classes: Vec<StreetClass>,
}

impl Lines {
    fn pull(
        self,
        outlines: &mut Source<'_, '_>,
        mut name: impl FnMut() -> Result<String, Malformed>,
    ) -> Result<Vec<PlanStreet>, Unread> {
        let mut ids = self.ids.pull();
        let mut walkable = Pull::new("walkable streets", self.walkable);
        let mut layers = Pull::new("layers of streets", self.layers);
        let mut classes = Pull::new("classes of streets", self.classes);
        let mut streets = expecting(self.widths.len());
        for width in self.widths {
            streets.push(PlanStreet {
                id: ids.take()?,
                name: name()?,
                line: outlines.line(STREETS)?,
                width,
                walkable: walkable.take()?,
                layer: layers.take()?,
                class: classes.take()?,
            });
        }
        ids.finish()?;
        walkable.finish()?;
        layers.finish()?;
        classes.finish()?;
        Ok(streets)
    }
}
