use veduta_city::{Anchor, GridPolygon, GridPos, Id, Level, Place, Portal, Viewpoint};

use crate::blob::{INFLATED_CAP, deflate, inflate};
use crate::wire::{WireIndex, from_bytes, to_bytes};
use crate::{BlobRef, FORMAT_VERSION, StoreError, valid};

/// What a walker must know of a whole city before asking for any part of it. It comes only out of [`decode_index`] or
/// [`crate::write_city`], both of which make sure that every index in it points at something.
#[derive(Debug, Clone, PartialEq)]
pub struct CityIndex {
    /// Version of the format, [`FORMAT_VERSION`].
    pub format: u32,
    /// Name of the city.
    pub name: String,
    /// Where plan (0, 0) lies on Earth.
    pub anchor: Anchor,
    /// Who is to be credited for the data.
    pub attribution: String,
    /// Seed of every draw.
    pub seed: u64,
    /// Version of growth that made the plan.
    pub growth_version: u32,
    /// Where a visit begins.
    pub start: Viewpoint,
    /// Edge of the modelled city, counter-clockwise.
    pub extent: GridPolygon,
    /// Cells; all else refers to them by index.
    pub cells: Vec<CellEntry>,
    /// Portals; cells refer to them by index.
    pub portals: Vec<Portal>,
    /// Cells whose tallest things are seen from (almost) everywhere, ascending.
    pub skyline: Vec<u32>,
    /// Things with a name.
    pub places: Vec<Place>,
    /// The [`veduta_city::Overview`].
    pub overview: BlobRef,
    /// The styles that the city was baked with.
    pub styles: Option<BlobRef>,
}

/// What the index says of a cell.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CellEntry {
    /// Stable id.
    pub id: Id,
    /// Name of its square or street, may be empty.
    pub name: String,
    /// Its space in plan.
    pub outline: GridPolygon,
    /// Lowest and highest ground, grid steps.
    pub floor: (i32, i32),
    /// Least and greatest corner in plan of all that is drawn with it, houses and yards included.
    pub bounds: (GridPos, GridPos),
    /// Its highest thing above the city's zero, grid steps.
    pub top: i32,
    /// Its portals, ascending.
    pub portals: Vec<u32>,
    /// Cells seen from somewhere in it, itself included, ascending.
    pub visible: Vec<u32>,
    /// Houses whose roof it carries: over all cells they add up to the city's.
    pub houses: u32,
    /// Walls that face it.
    pub walls: u32,
    /// Its packets, by [`Level::index`]. A cell without walls and trees has none beyond level 1.
    pub packets: [Option<BlobRef>; 4],
}

impl CellEntry {
    /// The packet of a level.
    #[must_use]
    pub fn packet(&self, level: Level) -> Option<&BlobRef> {
        self.packets.get(level.index())?.as_ref()
    }
}

impl CityIndex {
    /// The cell in which a plan position lies, by looking at all; `None` outside of every cell. Where floors lie above each
    /// other, the first.
    #[must_use]
    pub fn locate(&self, pos: GridPos) -> Option<u32> {
        let is_in = |cell: &CellEntry| {
            let (lo, hi) = cell.bounds;
            lo.0 <= pos.0 && pos.0 <= hi.0 && lo.1 <= pos.1 && pos.1 <= hi.1 && cell.outline.contains(pos)
        };
        self.cells.iter().position(is_in).map(|i| i as u32)
    }
}

/// What an index is called in messages.
pub(crate) const WHAT: &str = "the index";
/// First bytes of an index.
const MAGIC: &[u8; 7] = b"VEDUTA\0";
/// Kind of file: an index.
const KIND: u8 = 1;
/// Bytes before the payload: mark, kind, version, checksum, inflated size.
const HEADER: usize = 7 + 1 + 4 + 32 + 4;

/// Stored form of an index.
#[must_use]
pub fn encode_index(index: &CityIndex) -> Vec<u8> {
    seal(&to_bytes(&WireIndex::from(index)))
}

/// Content of an index under its header.
fn seal(content: &[u8]) -> Vec<u8> {
    let mut sealed = u32::try_from(content.len()).unwrap_or(u32::MAX).to_le_bytes().to_vec();
    deflate(content, &mut sealed);
    let mut stored = Vec::with_capacity(HEADER + sealed.len());
    stored.extend(MAGIC);
    stored.push(KIND);
    stored.extend(FORMAT_VERSION.to_le_bytes());
    stored.extend(blake3::hash(&sealed).as_bytes());
    stored.extend(sealed);
    stored
}

/// Takes the first `N` bytes off what is left of `stored` bytes.
fn head<'a, const N: usize>(bytes: &mut &'a [u8], stored: usize) -> Result<&'a [u8; N], StoreError> {
    let short = StoreError::Length { what: WHAT, expected: HEADER as u64, found: stored as u64 };
    let (first, rest) = bytes.split_first_chunk().ok_or(short)?;
    *bytes = rest;
    Ok(first)
}

/// The index of stored bytes.
///
/// # Errors
/// [`StoreError::NotACity`], [`StoreError::Newer`], [`StoreError::Older`] by the first bytes; [`StoreError::Checksum`] if the
/// rest is damaged; [`StoreError::Invalid`] if an index in it points at nothing.
pub fn decode_index(stored: &[u8]) -> Result<CityIndex, StoreError> {
    let mut rest = stored;
    if !rest.starts_with(MAGIC) {
        return Err(StoreError::NotACity);
    }
    let _: &[u8; 7] = head(&mut rest, stored.len())?;
    let &[kind] = head(&mut rest, stored.len())?;
    if kind != KIND {
        return Err(StoreError::Kind { expected: WHAT, found: format!("a file of kind {kind}") });
    }
    match u32::from_le_bytes(*head(&mut rest, stored.len())?) {
        FORMAT_VERSION => {}
        found if found > FORMAT_VERSION => return Err(StoreError::Newer { found }),
        found => return Err(StoreError::Older { found }),
    }
    let sum: &[u8; 32] = head(&mut rest, stored.len())?;
    if blake3::hash(rest).as_bytes() != sum {
        return Err(StoreError::Checksum { what: WHAT });
    }
    let size = u32::from_le_bytes(*head(&mut rest, stored.len())?);
    let wire: WireIndex = from_bytes(WHAT, &inflate(WHAT, rest, u64::from(size), INFLATED_CAP)?)?;
    let index = CityIndex::try_from(wire).map_err(|malformed| malformed.of(WHAT))?;
    valid::check_index(&index).map_err(|reason| StoreError::Invalid { what: WHAT, reason })?;
    Ok(index)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::collection::vec;
    use proptest::prelude::*;
    use veduta_city::PortalSide;

    use super::*;

    /// Two cells side by side.
    fn index() -> CityIndex {
        let square = |x| GridPolygon::simple(vec![GridPos(x, 0), GridPos(x + 50, 0), GridPos(x + 50, 50), GridPos(x, 50)]);
        let blob = |n: u8| Some(BlobRef { hash: [n; 32], bytes: 100 + u32::from(n) });
        let cell = |n: u32| CellEntry {
            id: Id(1 << 63 | u64::from(n)),
            name: format!("cell {n}"),
            outline: square(50 * n as i32),
            floor: (-3, 4),
            bounds: (GridPos(-9, -9), GridPos(999, 99)),
            top: 20_000,
            portals: vec![0],
            visible: vec![0, 1],
            houses: 3,
            walls: 7,
            packets: [blob(n as u8), blob(9), None, None],
        };
        CityIndex {
            format: FORMAT_VERSION,
            name: "Testov".to_owned(),
            anchor: Anchor { lat: 50.0, lon: 14.0 },
            attribution: "nobody".to_owned(),
            seed: u64::MAX,
            growth_version: 3,
            start: Viewpoint::default(),
            extent: square(-100),
            cells: vec![cell(0), cell(1)],
            portals: vec![Portal { ends: (GridPos(50, 0), GridPos(50, 50)), cell: 0, beyond: PortalSide::Cell(1) }],
            skyline: vec![1],
            places: vec![Place {
                name: "Kašna".to_owned(),
                pos: DVec2::new(0.1, -7.0),
                view: Some(Viewpoint::default()),
                ..Place::default()
            }],
            overview: BlobRef { hash: [77; 32], bytes: 12 },
            styles: Some(BlobRef { hash: [78; 32], bytes: 13 }),
        }
    }

    #[test]
    fn an_index_survives() {
        assert_eq!(decode_index(&encode_index(&index())), Ok(index()));
    }

    #[test]
    fn a_form_that_changed_has_a_new_version() {
        let form = blake3::hash(&to_bytes(&WireIndex::from(&index()))).to_hex();
        assert_eq!((FORMAT_VERSION, &form[..16]), (9, "e5d0179e08061f6c"), "raise FORMAT_VERSION if this is on purpose");
    }

    #[test]
    fn an_index_that_claims_gigabytes_is_refused() {
        let claims: [(&str, fn(&mut CityIndex) -> &mut BlobRef, u32); 3] = [
            ("a packet of level 1", |index| index.cells[1].packets[0].as_mut().expect("a packet"), 17 << 20),
            ("the overview", |index| &mut index.overview, 66 << 20),
            ("the styles", |index| index.styles.as_mut().expect("styles"), u32::MAX),
        ];
        for (what, blob, bytes) in claims {
            let mut index = index();
            blob(&mut index).bytes = 16 << 20;
            assert_eq!(decode_index(&encode_index(&index)).as_ref(), Ok(&index), "{what}: large, but possible");
            blob(&mut index).bytes = bytes;
            let error = decode_index(&encode_index(&index)).expect_err(what).to_string();
            assert!(error.contains(&format!("{what} claims {bytes} bytes")), "{error}");
        }
    }

    #[test]
    fn what_does_not_shrink_stays_below_the_cap_of_its_kind() {
        let mut reader = blake3::Hasher::new().finalize_xof();
        let mut noise = vec![0; 16 << 20];
        reader.fill(&mut noise);
        let stored = crate::blob::pack(crate::blob::BlobKind::Shell, &noise);
        assert!(stored.len() as u64 <= crate::blob::BlobKind::Shell.stored_cap(), "{} bytes", stored.len());
    }

    proptest! {
        /// Someone who can compute checksums makes indices that no encoder would.
        #[test]
        fn forged_indices_do_no_harm(edits in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
            let mut content = to_bytes(&WireIndex::from(&index()));
            for (at, byte) in edits {
                let at = at.index(content.len());
                content[at] = byte;
            }
            if let Ok(index) = decode_index(&seal(&content)) {
                prop_assert_eq!(valid::check_index(&index), Ok(()));
                let _anywhere = index.locate(GridPos(25, 25));
            }
        }
    }
}
