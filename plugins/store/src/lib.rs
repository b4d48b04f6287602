//! A city on disk or behind HTTP: index, packets and checksums.
//!
//! ```text
//!  CityPlan, Cells ─┐                                   ┌─ DirReader ──┐   bytes
//!  CellShell   ×n   ├─ write_city ──► DIR/city.veduta ──┤              ├──────────► Request::decode (any thread)
//!  FacadeSheet ×n  ─┘                     blobs/ab/….bin └─ HttpReader ─┘                  │ Payload or StoreError
//!                                                              ▲                          ▼
//!               streaming ── want(cell, level)… ──► Client ── Request            Client::deliver ──► ClientEvent
//! ```
//!
//! Only these do I/O: [`write_city`], [`CityWriter`] and the [`Reader`]s; of these, [`CacheReader`] keeps what another has read. The [`Client`] is a state machine: it says what to
//! read next and takes what was read, so that threads, a browser's fetch or a test may do the reading. It reads no clock.
//!
//! # Use
//! Write a city, open the place where it lies, and feed the client:
//! ```
//! use veduta_city::{Cell, CellShell, Cells, CityPlan, FacadeSheet, GridPolygon, GridPos, Level};
//! use veduta_store::{Client, ClientEvent, ClientSettings, open_reader, write_city};
//!
//! let outline = GridPolygon::simple(vec![GridPos(0, 0), GridPos(9000, 0), GridPos(0, 9000)]);
//! let cell = Cell { outline: outline.clone(), ..Cell::default() };
//! let cells = Cells { cells: vec![cell], visible: vec![vec![0]], ..Cells::default() };
//! let shell = CellShell { outline, ..CellShell::default() };
//! let dir = std::env::temp_dir().join(format!("veduta-doc-{}.city", std::process::id()));
//! let stats = write_city(&dir, &CityPlan::default(), &cells, &[shell], &[FacadeSheet::default()])?;
//! assert_eq!(stats.cells, 1);
//!
//! let reader = open_reader(&dir.to_string_lossy())?; // or "https://example.org/prague.city"
//! let mut client = Client::new(ClientSettings::default());
//! client.want([(0, Level::One), (0, Level::Two)]);
//! let mut arrived = Vec::new();
//! while let Some(request) = client.next_request(0.0) {
//!     let answer = request.fetch(reader.as_ref()); // on a thread that may wait
//!     for event in client.deliver(request.id, answer, 0.0) {
//!         if let ClientEvent::Arrived { cell, level, .. } = event {
//!             arrived.push((cell, level));
//!         }
//!     }
//! }
//! assert_eq!(arrived, [(0, Level::One)], "a cell without walls and trees has no level 2");
//! # std::fs::remove_dir_all(&dir)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Format
//!
//! | file | bytes |
//! |---|---|
//! | `city.veduta` | `VEDUTA`, 0; kind 1; version, u32; blake3 of all that follows, 32 bytes; the index |
//! | `blobs/ab/abcdef….bin` | kind: 1, 2, 4 packets of levels 1 to 3, 16 overview, 17 styles, 18 region, 19 file, 20 houses of a region, 21 leaf of the index; the content |
//!
//! Numbers are little-endian. A blob is named by the first 12 bytes of the blake3 hash of its bytes, so a copy that answers to its name is
//! whole. Contents are structures of numbers (differences, each vertex and wall told once, colours by the palettes of styles) behind how
//! many values they have, as a varint; they go through an adaptive range coder that begins with what such numbers are like on average.
//! A cell's packet does not tell what the index does: its outline, the palettes ([`PacketContext`]); nor does an overview
//! ([`OverviewContext`]). Both leave out footprints, heights, roofs and colours of the houses of their region, which are in a blob of
//! their own ([`RegionHouses`]) that is read before. Positions are told in steps of a quarter of a metre, of the plan or of the grid, whatever
//! all of them lie on.
//!
//! The index lists regions: squares of the whole grid, or halves of them, with at most 128 cells each. What it tells of these cells
//! (outlines, portals, visible sets, packets) is in the regions' blobs, which name the overview and the houses of each region too. Where
//! the regions of a larger city are stored is told in leaves, each of 64 regions ([`CityIndex::leaves`]). Opening a city reads the list, a
//! leaf, and the region in which a visit begins, however large it is. Cells are numbered along the quadtree's curve; in a region's blob
//! those of others are named by the other's square, so that what is built at one end of a city changes no bytes at the other.
//!
//! # Failures
//! What is damaged or missing is asked for again, 0.5 s later at first, then twice as long each time, 3 s at most, counted from when it
//! was asked for; the others keep coming. When the line comes back to life, what failed because of it does not wait any longer. A line
//! is given up by its silence, however slow it is ([`HttpSettings`]): so that 5 s after the end of any fault an open city is as it was.
//! What has only failed for [`ClientSettings::patience_s`] counts as not to be had, though it is tried on; time in which nobody was there to
//! answer ([`ReadError::is_outage`]) does not count.
//! What cannot get better (a newer format, a damaged index, sound bytes that make no sense) is told once. Bytes from anywhere are safe to
//! decode: they are bounded in memory before they are believed, and every index in what comes out points at something, but for bays and
//! storeys of ornaments and doors: whoever draws them leaves out what a wall does not have.
//!
//! # Limits
//! The list of regions (some 5 bytes each) is read whole. A walk that goes on while its city is baked again sees packets missing until it
//! is opened anew. A power cut right after writing may lose blobs; writing again mends them. Two programs must not write to one directory
//! at a time. A packet tells neither ids of houses nor of objects: whoever needs them takes the plan.
//!
//! # Rejected
//! The model's own serde form (it leaves out empty fields, which formats without names do not survive); deflate over columns in
//! postcard, which this was until format 11 (more than twice the bytes: a packet of 400 bytes is too short to tell a code of its own, and
//! numbers are no letters); zstd (a C library, or slow in a browser); one archive with byte ranges (plain servers
//! differ in them, and nothing unchanged could stay when baking again); retries inside readers (nobody could count them).

mod blob;
#[cfg(not(target_arch = "wasm32"))]
mod cache;
mod client;
mod code;
mod compose;
mod disk;
mod error;
mod file;
mod houses;
#[cfg(not(target_arch = "wasm32"))]
mod http;
mod index;
mod leaf;
mod overview;
#[cfg(not(target_arch = "wasm32"))]
mod pace;
mod packet;
mod reader;
mod region;
mod request;
mod stats;
mod valid;
mod wire;
mod write;

pub use blob::BlobRef;
#[cfg(not(target_arch = "wasm32"))]
pub use cache::{CacheReader, CacheStats};
pub use client::{Client, ClientEvent, ClientSettings, ClientStats};
pub use compose::CellParts;
pub use error::{ReadError, StoreError};
pub use file::{CityFile, FILE_CAP, decode_file, encode_file};
pub use houses::{HousePart, HousesContext, RegionHouses, decode_houses, encode_houses};
#[cfg(not(target_arch = "wasm32"))]
pub use http::{HttpReader, HttpSettings};
pub use index::{CityIndex, decode_index, encode_index, read_index};
pub use leaf::{decode_leaf, encode_leaf};
pub use overview::{OverviewContext, decode_overview, encode_overview, read_overview};
pub use packet::{Packet, PacketContext, decode_packet, decode_styles, encode_packet, sheet_fits, wall_count};
pub use reader::{DirReader, Fresh, Reader, open_reader};
pub use region::{CellEntry, Region, RegionEntry, RegionKey, decode_region, encode_region};
pub use request::{Payload, Request, RequestId, What};
pub use stats::CityStats;
pub use write::{CityWriter, write_city};

// The small city of the tests names this crate as others do.
#[cfg(test)]
extern crate self as veduta_store;

/// Version of the format that this program writes and reads.
pub const FORMAT_VERSION: u32 = 22;

/// Name of the index's file in a city's directory.
pub const INDEX_NAME: &str = "city.veduta";
