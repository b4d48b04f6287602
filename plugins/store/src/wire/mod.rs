//! The wire form: private structures that postcard writes, with exact conversions to and from the public types.
//!
//! Values of one kind stand together in a column, because deflate finds more to say twice that way. Vertices are told once
//! a packet and then named ([`points`]), ids without their leading zeros, colours, texts and walls by tables. The model's own
//! serde form cannot be used: it leaves out empty fields, which only self-describing formats survive.
//!
//! Hostile bytes: every count is backed by that many entries of some column before memory is taken for it, so what is
//! decoded is at most a small multiple of the inflated size, and all columns must be used up.

mod columns;
mod index;
mod overview;
mod places;
mod points;
mod region;
mod sheet;
mod shell;
mod terrain;

pub(crate) use index::WireIndex;
pub(crate) use overview::WireOverview;
pub(crate) use region::{WireRegion, bounds_beyond, metres_beyond};
pub(crate) use sheet::WireSheet;
pub(crate) use shell::WireShell;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{BlobRef, StoreError};
use columns::Pull;

/// What is wrong with columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Malformed {
    /// In a sentence.
    Reason(&'static str),
    /// A column that has fewer or more entries than the others ask for.
    Column(&'static str),
}

impl Malformed {
    pub(crate) fn of(self, what: &'static str) -> StoreError {
        let reason = match self {
            Self::Reason(reason) => reason.to_owned(),
            Self::Column(name) => format!("there are too few or too many {name}"),
        };
        StoreError::Malformed { what, reason }
    }
}

/// References to blobs in columns.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireBlobs {
    bytes: Vec<u32>,
    hashes: Vec<[u8; 16]>,
}

impl WireBlobs {
    fn of<'a>(blobs: impl IntoIterator<Item = &'a BlobRef>) -> Self {
        let (bytes, hashes) = blobs.into_iter().map(|blob| (blob.bytes, blob.hash)).unzip();
        Self { bytes, hashes }
    }

    fn pull(self, name: &'static str) -> PullBlobs {
        PullBlobs { bytes: Pull::new(name, self.bytes), hashes: Pull::new(name, self.hashes) }
    }
}

/// Takes references off [`WireBlobs`].
struct PullBlobs {
    bytes: Pull<u32>,
    hashes: Pull<[u8; 16]>,
}

impl PullBlobs {
    fn take(&mut self) -> Result<BlobRef, Malformed> {
        Ok(BlobRef { hash: self.hashes.take()?, bytes: self.bytes.take()? })
    }

    fn is_empty(&self) -> bool {
        self.bytes.is_empty() && self.hashes.is_empty()
    }

    fn finish(&self) -> Result<(), Malformed> {
        self.bytes.finish()?;
        self.hashes.finish()
    }
}

/// Bytes of a wire structure.
pub(crate) fn to_bytes<T: Serialize>(wire: &T) -> Vec<u8> {
    match postcard::to_allocvec(wire) {
        Ok(bytes) => bytes,
        // Columns have known lengths and no maps, which is all that postcard could refuse.
        Err(error) => unreachable!("postcard into memory: {error}"),
    }
}

/// Wire structure of bytes that must be used up.
pub(crate) fn from_bytes<T: DeserializeOwned>(what: &'static str, bytes: &[u8]) -> Result<T, StoreError> {
    match postcard::take_from_bytes(bytes) {
        Ok((wire, [])) => Ok(wire),
        Ok(_) => Err(Malformed::Reason("bytes are left over").of(what)),
        Err(error) => Err(StoreError::Malformed { what, reason: error.to_string() }),
    }
}
