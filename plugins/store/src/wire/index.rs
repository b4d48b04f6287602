use glam::DVec2;
use serde::{Deserialize, Serialize};
use veduta_city::{Anchor, Place, PlaceKind, Portal, Viewpoint};

use super::{
    Malformed,
    columns::{Deltas, Ids, Lists, Pull, Texts},
    points::{PointWriter, Points, PullPoints},
    shell::{code_of_side, side_of_code},
};
use crate::{BlobRef, CellEntry, CityIndex, FORMAT_VERSION};

/// A [`CityIndex`] in columns.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireIndex {
    anchor: Anchor,
    seed: u64,
    growth_version: u32,
    start: Viewpoint,
    points: Points,
    /// Name and attribution of the city, names of cells, name and text of each place.
    texts: Texts,
    cells: WireCells,
    portals: WirePortals,
    skyline: Lists,
    places: WirePlaces,
    overview: WireBlob,
    styles: Option<WireBlob>,
}

type WireBlob = ([u8; 32], u32);

const fn wire_of_blob(blob: &BlobRef) -> WireBlob {
    (blob.hash, blob.bytes)
}

const fn blob_of_wire((hash, bytes): WireBlob) -> BlobRef {
    BlobRef { hash, bytes }
}

#[derive(Serialize, Deserialize)]
struct WireCells {
    ids: Ids,
    floors_low: Deltas,
    /// Above the lowest.
    floors_high: Vec<i32>,
    tops: Deltas,
    portals: Lists,
    visible: Lists,
    houses: Vec<u32>,
    walls: Vec<u32>,
    /// Bit n: it has a packet of the level with index n.
    levels: Vec<u8>,
    packets: Vec<WireBlob>,
}

#[derive(Serialize, Deserialize)]
struct WirePortals {
    cells: Vec<u32>,
    /// 0: the edge; else one more than the cell.
    beyond: Vec<u64>,
}

#[derive(Serialize, Deserialize)]
struct WirePlaces {
    ids: Ids,
    kinds: Vec<PlaceKind>,
    marks: Vec<(DVec2, f64, Option<Viewpoint>)>,
}

impl From<&CityIndex> for WireIndex {
    fn from(index: &CityIndex) -> Self {
        let mut points = PointWriter::default();
        points.polygon(&index.extent);
        for cell in &index.cells {
            points.polygon(&cell.outline);
            points.point(cell.bounds.0);
            points.point(cell.bounds.1);
        }
        for portal in &index.portals {
            points.point(portal.ends.0);
            points.point(portal.ends.1);
        }
        let mut skyline = Lists::default();
        skyline.push(index.skyline.iter().copied());
        let places = index.places.iter().flat_map(|place| [place.name.as_str(), place.text.as_str()]);
        let cells = index.cells.iter().map(|cell| cell.name.as_str());
        Self {
            anchor: index.anchor,
            seed: index.seed,
            growth_version: index.growth_version,
            start: index.start,
            points: points.finish(),
            texts: Texts::of([index.name.as_str(), index.attribution.as_str()].into_iter().chain(cells).chain(places)),
            cells: WireCells::of(&index.cells),
            portals: WirePortals {
                cells: index.portals.iter().map(|portal| portal.cell).collect(),
                beyond: index.portals.iter().map(|portal| code_of_side(portal.beyond)).collect(),
            },
            skyline,
            places: WirePlaces::of(&index.places),
            overview: wire_of_blob(&index.overview),
            styles: index.styles.as_ref().map(wire_of_blob),
        }
    }
}

impl WireCells {
    fn of(cells: &[CellEntry]) -> Self {
        let (mut ids, mut portals, mut visible) = (Ids::default(), Lists::default(), Lists::default());
        for cell in cells {
            ids.push(cell.id);
            portals.push(cell.portals.iter().copied());
            visible.push(cell.visible.iter().copied());
        }
        let levels = |cell: &CellEntry| (0..4).filter(|&n| cell.packets[n].is_some()).fold(0, |bits, n| bits | 1 << n);
        Self {
            ids,
            floors_low: Deltas::of(cells.iter().map(|cell| cell.floor.0)),
            floors_high: cells.iter().map(|cell| cell.floor.1.wrapping_sub(cell.floor.0)).collect(),
            tops: Deltas::of(cells.iter().map(|cell| cell.top)),
            portals,
            visible,
            houses: cells.iter().map(|cell| cell.houses).collect(),
            walls: cells.iter().map(|cell| cell.walls).collect(),
            levels: cells.iter().map(levels).collect(),
            packets: cells.iter().flat_map(|cell| cell.packets.iter().flatten()).map(wire_of_blob).collect(),
        }
    }

    fn pull(
        self,
        points: &mut PullPoints,
        mut name: impl FnMut() -> Result<String, Malformed>,
    ) -> Result<Vec<CellEntry>, Malformed> {
        let mut ids = self.ids.pull();
        let mut low = Pull::new("floors of cells", self.floors_low.numbers());
        let mut high = Pull::new("heights of floors", self.floors_high);
        let mut tops = Pull::new("tops of cells", self.tops.numbers());
        let (mut portals, mut visible) = (self.portals.pull(), self.visible.pull());
        let mut houses = Pull::new("houses of cells", self.houses);
        let mut walls = Pull::new("walls of cells", self.walls);
        let mut packets = Pull::new("packets of cells", self.packets);
        let mut cells = Vec::with_capacity(self.levels.len());
        for levels in self.levels {
            let floor = low.take()?;
            cells.push(CellEntry {
                id: ids.take()?,
                name: name()?,
                outline: points.polygon()?,
                bounds: (points.point()?, points.point()?),
                floor: (floor, floor.wrapping_add(high.take()?)),
                top: tops.take()?,
                portals: portals.take()?,
                visible: visible.take()?,
                houses: houses.take()?,
                walls: walls.take()?,
                packets: packets_of(levels, &mut packets)?,
            });
        }
        ids.finish()?;
        low.finish()?;
        high.finish()?;
        tops.finish()?;
        portals.finish()?;
        visible.finish()?;
        houses.finish()?;
        walls.finish()?;
        packets.finish()?;
        Ok(cells)
    }
}

fn packets_of(levels: u8, packets: &mut Pull<WireBlob>) -> Result<[Option<BlobRef>; 4], Malformed> {
    if levels >= 1 << 4 {
        return Err(Malformed::Reason("a cell has packets of unknown levels"));
    }
    let mut all = [None; 4];
    for (n, packet) in all.iter_mut().enumerate() {
        if levels >> n & 1 == 1 {
            *packet = Some(blob_of_wire(packets.take()?));
        }
    }
    Ok(all)
}

impl WirePlaces {
    fn of(places: &[Place]) -> Self {
        let mut ids = Ids::default();
        places.iter().for_each(|place| ids.push(place.id));
        Self {
            ids,
            kinds: places.iter().map(|place| place.kind).collect(),
            marks: places.iter().map(|place| (place.pos, place.radius_m, place.view)).collect(),
        }
    }

    fn pull(self, mut text: impl FnMut() -> Result<String, Malformed>) -> Result<Vec<Place>, Malformed> {
        let mut ids = self.ids.pull();
        let mut kinds = Pull::new("kinds of places", self.kinds);
        let mut places = Vec::with_capacity(self.marks.len());
        for (pos, radius_m, view) in self.marks {
            let (id, kind) = (ids.take()?, kinds.take()?);
            places.push(Place { id, kind, pos, radius_m, view, name: text()?, text: text()? });
        }
        ids.finish()?;
        kinds.finish()?;
        Ok(places)
    }
}

impl TryFrom<WireIndex> for CityIndex {
    type Error = Malformed;

    fn try_from(wire: WireIndex) -> Result<Self, Malformed> {
        let mut points = wire.points.pull();
        let mut texts = wire.texts.pull()?;
        let (name, attribution) = (texts.take()?, texts.take()?);
        let extent = points.polygon()?;
        let cells = wire.cells.pull(&mut points, || texts.take())?;
        let mut beyond = Pull::new("portals", wire.portals.beyond);
        let mut portals = Vec::with_capacity(wire.portals.cells.len());
        for cell in wire.portals.cells {
            let ends = (points.point()?, points.point()?);
            portals.push(Portal { ends, cell, beyond: side_of_code(beyond.take()?)? });
        }
        beyond.finish()?;
        points.finish()?;
        let places = wire.places.pull(|| texts.take())?;
        texts.finish()?;
        let mut skyline_lists = wire.skyline.pull();
        let skyline = skyline_lists.take()?;
        skyline_lists.finish()?;
        Ok(Self {
            format: FORMAT_VERSION,
            name,
            anchor: wire.anchor,
            attribution,
            seed: wire.seed,
            growth_version: wire.growth_version,
            start: wire.start,
            extent,
            cells,
            portals,
            skyline,
            places,
            overview: blob_of_wire(wire.overview),
            styles: wire.styles.map(blob_of_wire),
        })
    }
}
