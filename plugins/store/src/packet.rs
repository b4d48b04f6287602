use veduta_city::{CellShell, FacadeSheet, Level, Styles};

use crate::blob::{BlobKind, pack, unpack};
use crate::wire::{WireSheet, WireShell, from_bytes, to_bytes};
use crate::{BlobRef, StoreError, valid};

/// What is transferred for one cell at one level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Packet {
    /// Level 1: all that stands and lies in the cell.
    Shell(CellShell),
    /// Level 2: openings of its walls.
    Facades(FacadeSheet),
}

impl Packet {
    /// The level it belongs to.
    #[must_use]
    pub const fn level(&self) -> Level {
        match self {
            Self::Shell(_) => Level::One,
            Self::Facades(_) => Level::Two,
        }
    }
}

/// Stored form of a packet. The same packet gives the same bytes on every platform.
#[must_use]
pub fn encode_packet(packet: &Packet) -> Vec<u8> {
    match packet {
        Packet::Shell(shell) => encode_shell(shell),
        Packet::Facades(sheet) => encode_sheet(sheet),
    }
}

pub(crate) fn encode_shell(shell: &CellShell) -> Vec<u8> {
    pack(BlobKind::Shell, &to_bytes(&WireShell::from(shell)))
}

pub(crate) fn encode_sheet(sheet: &FacadeSheet) -> Vec<u8> {
    pack(BlobKind::Facades, &to_bytes(&WireSheet::from(sheet)))
}

/// The packet of stored bytes that the reference stands for. Any bytes are safe: length and checksum are looked at first,
/// then they are inflated within a cap, decoded, and checked. A shell's rings have at least three vertices, its walls are
/// edges of their footprints, and its positions may be added and subtracted without overflow.
///
/// # Errors
/// What is wrong with the bytes; see [`StoreError::is_permanent`] for whether reading them anew may help.
pub fn decode_packet(stored: &[u8], blob: &BlobRef, level: Level) -> Result<Packet, StoreError> {
    match level {
        Level::One => {
            let what = BlobKind::Shell.words();
            let wire: WireShell = from_bytes(what, &unpack(BlobKind::Shell, stored, blob)?)?;
            let shell = CellShell::try_from(wire).map_err(|malformed| malformed.of(what))?;
            valid::check_shell(&shell).map_err(|reason| StoreError::Invalid { what, reason })?;
            Ok(Packet::Shell(shell))
        }
        Level::Two => {
            let what = BlobKind::Facades.words();
            let wire: WireSheet = from_bytes(what, &unpack(BlobKind::Facades, stored, blob)?)?;
            Ok(Packet::Facades(FacadeSheet::try_from(wire).map_err(|malformed| malformed.of(what))?))
        }
        Level::Three | Level::Four => Err(StoreError::NoSuchLevel(level)),
    }
}

/// Number of walls that a shell draws.
#[must_use]
pub fn wall_count(shell: &CellShell) -> usize {
    shell.houses.iter().flat_map(|house| &house.volumes).map(|volume| volume.walls.len()).sum()
}

/// Whether a sheet has one wall for each of the shell's.
#[must_use]
pub fn sheet_fits(shell: &CellShell, sheet: &FacadeSheet) -> bool {
    wall_count(shell) == sheet.walls.len()
}

pub(crate) fn encode_styles(styles: &Styles) -> Vec<u8> {
    pack(BlobKind::Styles, &to_bytes(styles))
}

/// The styles of stored bytes that the reference stands for ([`crate::CityIndex::styles`]).
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or are no styles to draw from.
pub fn decode_styles(stored: &[u8], blob: &BlobRef) -> Result<Styles, StoreError> {
    let what = BlobKind::Styles.words();
    let styles: Styles = from_bytes(what, &unpack(BlobKind::Styles, stored, blob)?)?;
    match styles.validate().first() {
        None => Ok(styles),
        Some(error) => Err(StoreError::Invalid { what, reason: error.to_string() }),
    }
}
