use core::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use veduta_city::{Level, Overview, Palette};

use crate::{
    BlobRef, CityIndex, HousesContext, OverviewContext, Packet, PacketContext, Reader, Region, RegionEntry, RegionHouses,
    StoreError, decode_file, decode_houses, decode_index, decode_leaf, decode_overview, decode_packet, decode_region,
};

/// Number of a request, never used twice by the same client.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RequestId(pub u64);

/// What a request asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum What {
    /// The city's index.
    Index,
    /// Where some regions are stored.
    Leaf(
        /// Which leaf of the index.
        u32,
    ),
    /// What the index tells of the cells of one region.
    Region(
        /// Which region.
        u32,
    ),
    /// The overview of one region.
    Overview(
        /// Which region.
        u32,
    ),
    /// The houses of one region.
    Houses(
        /// Which region.
        u32,
    ),
    /// One of the city's files.
    File(
        /// Which, in the order of the index.
        u32,
    ),
    /// A cell's packet.
    Packet {
        /// Which cell.
        cell: u32,
        /// Which level.
        level: Level,
    },
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index => f.write_str("the city's index"),
            Self::Leaf(number) => write!(f, "leaf {number} of the index"),
            Self::Region(number) => write!(f, "region {number} of the index"),
            Self::Overview(number) => write!(f, "the overview of region {number}"),
            Self::Houses(number) => write!(f, "the houses of region {number}"),
            Self::File(number) => write!(f, "file {number} of the city"),
            Self::Packet { cell, level } => write!(f, "cell {cell}, {level}"),
        }
    }
}

/// Something that a [`crate::Client`] wants read. Whoever does the I/O reads `path`, calls [`Request::decode`] on the bytes
/// off the main thread, and hands the result to [`crate::Client::deliver`]. Each request must be answered once, with an
/// error if it is given up: it counts as in flight until then.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Its number.
    pub id: RequestId,
    /// Path within the city.
    pub path: String,
    /// Most bytes to read.
    pub limit: u64,
    /// What it asks for.
    pub what: What,
    /// The content asked for; none for the index, which checks itself.
    pub blob: Option<BlobRef>,
    /// All regions of the city, by which those asked for name each other.
    pub(crate) regions: Arc<[RegionEntry]>,
    /// Of a packet: the region of its cell, and where it is in it. Of an overview or houses: their region.
    pub(crate) home: Option<(Arc<Region>, usize)>,
    /// Of a packet or an overview: the houses of that region.
    pub(crate) houses: Option<Arc<RegionHouses>>,
    /// What houses are painted with.
    pub(crate) palettes: Arc<[Palette]>,
}

/// The answer to a request, decoded and checked.
#[derive(Debug, Clone, PartialEq)]
pub enum Payload {
    /// The index.
    Index {
        /// The index, without its regions.
        index: Box<CityIndex>,
        /// Bytes that it took on the wire.
        bytes: u64,
    },
    /// Where the regions of a leaf are stored.
    Leaf(Vec<BlobRef>),
    /// A region.
    Region(Arc<Region>),
    /// An overview.
    Overview(Arc<Overview>),
    /// Houses of a region.
    Houses(Arc<RegionHouses>),
    /// A file.
    File(Arc<[u8]>),
    /// A packet.
    Packet(Box<Packet>),
}

impl Request {
    /// What the bytes that were read say. Pure; takes up to some milliseconds.
    ///
    /// # Errors
    /// If the bytes are not those asked for, or cannot be understood.
    pub fn decode(&self, bytes: Vec<u8>) -> Result<Payload, StoreError> {
        let cells = self.home.as_ref().map_or(&[][..], |(region, _)| &region.cells);
        let houses = self.houses.as_deref();
        match (self.what, &self.blob) {
            (What::Overview(number), Some(blob)) => {
                let first = self.regions.get(number as usize).map_or(0, |entry| entry.first);
                decode_overview(&bytes, blob, OverviewContext { first, cells, houses })
                    .map(|overview| Payload::Overview(Arc::new(overview)))
            }
            (What::Houses(_), Some(blob)) => {
                let context = HousesContext { cells, palettes: &self.palettes };
                decode_houses(&bytes, blob, context).map(|houses| Payload::Houses(Arc::new(houses)))
            }
            (What::Leaf(leaf), Some(blob)) => {
                decode_leaf(&bytes, blob, CityIndex::leaf_count(self.regions.len(), leaf)).map(Payload::Leaf)
            }
            (What::Region(number), Some(_)) => {
                decode_region(&bytes, number, &self.regions).map(|region| Payload::Region(Arc::new(region)))
            }
            (What::File(_), Some(blob)) => decode_file(&bytes, blob).map(|content| Payload::File(content.into())),
            (What::Packet { level, .. }, Some(blob)) => {
                let place = self.home.as_ref().map_or(0, |(_, place)| *place);
                let outline = cells.get(place).map(|cell| &cell.outline);
                let context = PacketContext { outline, palettes: &self.palettes, houses, place };
                decode_packet(&bytes, blob, level, context).map(|packet| Payload::Packet(Box::new(packet)))
            }
            _ => {
                let index = Box::new(decode_index(&bytes)?);
                Ok(Payload::Index { index, bytes: bytes.len() as u64 })
            }
        }
    }

    /// Reads and decodes; waits for the reader.
    ///
    /// # Errors
    /// If reading or decoding fails; the error names the city and the file.
    pub fn fetch(&self, reader: &dyn Reader) -> Result<Payload, StoreError> {
        self.decode(reader.read(&self.path, self.limit)?).map_err(|error| error.in_file(reader.describe(), &self.path))
    }
}
