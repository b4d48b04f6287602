//! What a client says.

use std::sync::Arc;

use veduta_city::{Level, Overview};

use crate::{Packet, StoreError, What};

/// What a delivery meant.
#[derive(Debug, Clone, PartialEq)]
pub enum ClientEvent {
    /// The index is there, without its regions.
    Opened,
    /// What the index tells of the cells of a region is there.
    RegionReady(
        /// Which region.
        u32,
    ),
    /// Something is there that others are found by or read with: a leaf of the index, the houses of a region.
    Ready(
        /// What.
        What,
    ),
    /// The overview of a region is there. It may no longer be wanted: then call [`Client::forget_overview`](crate::Client::forget_overview).
    OverviewReady {
        /// Which region.
        region: u32,
        /// It.
        overview: Arc<Overview>,
    },
    /// A file is there.
    FileReady {
        /// Which, in the order of the index.
        number: u32,
        /// Its bytes.
        content: Arc<[u8]>,
    },
    /// A packet is there. It may no longer be wanted: then call [`Client::forget`](crate::Client::forget).
    Arrived {
        /// Which cell.
        cell: u32,
        /// Which level.
        level: Level,
        /// Its content.
        packet: Packet,
    },
    /// A request failed.
    Failed {
        /// What it asked for.
        what: What,
        /// Why.
        error: Arc<StoreError>,
        /// Seconds until it is tried again; `None` if that cannot help, and so never.
        again_in_s: Option<f64>,
    },
}

/// What a client has done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ClientStats {
    /// Requests made.
    pub requests: u64,
    /// Answers that were what was asked for.
    pub delivered: u64,
    /// Bytes of those answers as stored.
    pub bytes: u64,
    /// Of those, bytes of packets by [`Level::index`].
    pub bytes_level: [u64; 4],
    /// Requests that failed.
    pub failures: u64,
    /// Requests that were taken back before they were sent.
    pub cancelled: u64,
    /// Deliveries of requests that were not on their way: a mistake of whoever does the I/O.
    pub unexpected: u64,
    /// Requests on their way now.
    pub in_flight: usize,
}
