//! A city on disk or behind HTTP: index, packets and checksums.

mod blob;
mod client;
mod compose;
mod error;
#[cfg(not(target_arch = "wasm32"))]
mod http;
mod index;
mod overview;
mod packet;
mod reader;
mod request;
mod stats;
mod valid;
mod wire;
mod write;

pub use blob::BlobRef;
pub use client::{Client, ClientEvent, ClientSettings, ClientStats};
pub use error::{ReadError, StoreError};
#[cfg(not(target_arch = "wasm32"))]
pub use http::{HttpReader, HttpSettings};
pub use index::{CellEntry, CityIndex, decode_index, encode_index};
pub use overview::{HouseName, Overview};
pub use packet::{Packet, decode_packet, decode_styles, encode_packet, sheet_fits, wall_count};
pub use reader::{DirReader, Reader, open_reader};
pub use request::{Payload, Request, RequestId, What};
pub use stats::CityStats;
pub use write::write_city;

/// Version of the format that this program writes and reads.
pub const FORMAT_VERSION: u32 = 1;

/// Name of the index's file in a city's directory.
pub const INDEX_NAME: &str = "city.veduta";
