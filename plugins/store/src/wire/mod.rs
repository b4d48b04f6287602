//! The wire form: private structures that [`code`](crate::code) writes, with exact conversions to and from the public types.
//!
//! Vertices are told once a packet and then named ([`Outlines`](crate::code::Outlines)), texts and walls by tables, numbers as differences from what they
//! are expected to be. The model's own serde form cannot be used: it leaves out empty fields, which only self-describing formats
//! survive.
//!
//! Hostile bytes: every count is backed by that many values before memory is taken for it, so what is decoded is at most a small
//! multiple of how many values there are, and all columns must be used up. For what is made of rows of them no more than a mebibyte is taken before
//! they are read ([`expecting`]).

mod columns;
mod houses;
mod index;
mod keys;
mod overview;
mod paint;
mod places;
mod region;
mod sheet;
mod shell;
mod terrain;
mod volumes;

pub(crate) use houses::WireHouses;
pub(crate) use index::WireIndex;
pub(crate) use overview::WireOverview;
pub(crate) use region::{WireRegion, bounds_beyond, metres_beyond};
pub(crate) use sheet::WireSheet;
pub(crate) use shell::WireShell;

use serde::{Deserialize, Serialize};

use crate::code::Unread;
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

impl From<Malformed> for Unread {
    fn from(malformed: Malformed) -> Self {
        Self(malformed.reason())
    }
}

impl Malformed {
    fn reason(self) -> String {
        match self {
            Self::Reason(reason) => reason.to_owned(),
            Self::Column(name) => format!("there are too few or too many {name}"),
        }
    }

    pub(crate) fn of(self, what: &'static str) -> StoreError {
        StoreError::Malformed { what, reason: self.reason() }
    }
}

/// Bytes of memory that are taken for things before they come.
const AT_ONCE: usize = 1 << 20;

/// Room for so many things, but for no more than [`AT_ONCE`] before they come: a thing takes hundreds of bytes, and what claims that there is one
/// may take a bit.
fn expecting<T>(count: usize) -> Vec<T> {
    Vec::with_capacity(count.min(AT_ONCE / size_of::<T>().max(1)))
}

/// Numbers told as steps from one to the next; wraps, so that any numbers survive.
#[derive(Default)]
struct Steps(i32);

impl Steps {
    fn to(&mut self, n: i32) -> i32 {
        n.wrapping_sub(core::mem::replace(&mut self.0, n))
    }

    fn by(&mut self, step: i32) -> i32 {
        self.0 = self.0.wrapping_add(step);
        self.0
    }
}

/// A hash as a number about which nothing can be known.
fn noise_of(hash: [u8; BlobRef::HASH_BYTES]) -> u128 {
    hash.iter().rev().fold(0, |noise, &byte| noise << 8 | u128::from(byte))
}

/// References to blobs in columns.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireBlobs {
    bytes: Vec<u32>,
    hashes: Vec<u128>,
}

impl WireBlobs {
    pub(crate) fn of<'a>(blobs: impl IntoIterator<Item = &'a BlobRef>) -> Self {
        let (bytes, hashes) = blobs.into_iter().map(|blob| (blob.bytes, noise_of(blob.hash))).unzip();
        Self { bytes, hashes }
    }

    /// All of them.
    pub(crate) fn all(self, name: &'static str) -> Result<Vec<BlobRef>, Malformed> {
        let mut blobs = self.pull(name);
        let mut all = expecting(blobs.bytes.left());
        while !blobs.is_empty() {
            all.push(blobs.take()?);
        }
        Ok(all)
    }

    fn pull(self, name: &'static str) -> PullBlobs {
        PullBlobs { bytes: Pull::new(name, self.bytes), hashes: Pull::new(name, self.hashes) }
    }
}

/// Takes references off [`WireBlobs`].
struct PullBlobs {
    bytes: Pull<u32>,
    hashes: Pull<u128>,
}

impl PullBlobs {
    fn take(&mut self) -> Result<BlobRef, Malformed> {
        let (hash, bytes) = (self.hashes.take()?, self.bytes.take()?);
        Ok(BlobRef { hash: core::array::from_fn(|i| (hash >> (8 * i)) as u8), bytes })
    }

    fn is_empty(&self) -> bool {
        self.bytes.is_empty() && self.hashes.is_empty()
    }

    fn finish(&self) -> Result<(), Malformed> {
        self.bytes.finish()?;
        self.hashes.finish()
    }
}
