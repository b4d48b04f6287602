use std::sync::Arc;

use veduta_city::{Anchor, Boxes, GridPolygon, GridPos, Palette, Portal, Viewpoint};

use crate::blob::{STORED_CAP, VALUES_CAP};
use crate::code::{Prior, press, unpress_with};
use crate::leaf::LEAF;
use crate::region::decode_region;
use crate::wire::WireIndex;
use crate::{
    BlobRef, CellEntry, CityFile, FORMAT_VERSION, HousesContext, INDEX_NAME, OverviewContext, PacketContext, Reader, Region,
    RegionEntry, RegionHouses, StoreError, decode_houses, decode_leaf, valid,
};

/// What a walker must know of a whole city before asking for any part of it, and, as they come, the [`Region`]s that tell of its cells
/// and their houses.
/// It comes only out of [`decode_index`], [`read_index`] or a [`crate::Client`], which make sure that every index in it points at
/// something.
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
    /// Its regions, at least one, in the order of their squares' Morton codes and of their cells' numbers.
    pub regions: Arc<[RegionEntry]>,
    /// Of each region: [`RegionEntry::bounds`].
    pub(crate) bounds: Boxes,
    /// Leaves, each of which tells where 64 regions are stored; none if the index does.
    pub leaves: Vec<BlobRef>,
    /// What houses are painted with, style by style.
    pub palettes: Arc<[Palette]>,
    /// The styles that the city was baked with.
    pub styles: Option<BlobRef>,
    /// Files that travel with the city, in the order of their paths.
    pub files: Vec<CityFile>,
    /// Of each region, what is here.
    pub(crate) pages: Vec<Option<Arc<Region>>>,
    /// How many of them are here: asked each frame, and counting them would take the longer the larger the city is.
    pub(crate) here: usize,
    /// Of each region, its houses if they are here.
    pub(crate) houses: Vec<Option<Arc<RegionHouses>>>,
}

impl CityIndex {
    /// The same, of which no region is here.
    pub(crate) fn without_pages(mut self) -> Self {
        self.bounds = self.regions.iter().map(|region| region.bounds).collect();
        (self.pages, self.here) = (vec![None; self.regions.len()], 0);
        self.houses = vec![None; self.regions.len()];
        self
    }

    /// How many cells the city has.
    #[must_use]
    pub fn cell_count(&self) -> u32 {
        self.regions.last().map_or(0, |last| last.first + last.cells)
    }

    /// Number of the region in which a cell is told; `None` if there is no such cell.
    #[must_use]
    pub fn region_of(&self, cell: u32) -> Option<u32> {
        let number = self.regions.partition_point(|region| region.first <= cell).checked_sub(1)?;
        // Regions without cells begin where the next one does.
        self.regions[number].numbers().contains(&cell).then_some(number as u32)
    }

    /// A region that is here.
    #[must_use]
    pub fn region(&self, number: u32) -> Option<&Arc<Region>> {
        self.pages.get(number as usize)?.as_ref()
    }

    /// The regions that are here, with their numbers.
    pub fn regions_here(&self) -> impl Iterator<Item = (u32, &Arc<Region>)> {
        (0..).zip(&self.pages).filter_map(|(number, page)| Some((number, page.as_ref()?)))
    }

    /// How many regions are here.
    #[must_use]
    pub const fn regions_here_count(&self) -> usize {
        self.here
    }

    /// Puts a region where [`decode_region`](crate::decode_region) or a change of it belongs; nothing happens if there is no such number.
    pub fn put(&mut self, number: u32, region: Arc<Region>) {
        if let Some(page) = self.pages.get_mut(number as usize) {
            self.here += usize::from(page.replace(region).is_none());
        }
    }

    /// Number of the leaf that tells where a region is stored; `None` if that is known, or there is no such region.
    #[must_use]
    pub fn missing_leaf(&self, region: u32) -> Option<u32> {
        let entry = self.regions.get(region as usize)?;
        entry.blob.is_none().then_some(region / LEAF as u32)
    }

    /// How many regions a leaf tells of.
    pub(crate) fn leaf_count(regions: usize, leaf: u32) -> usize {
        regions.saturating_sub(leaf as usize * LEAF).min(LEAF)
    }

    /// Puts what [`decode_leaf`](crate::decode_leaf) told where it belongs.
    pub fn put_leaf(&mut self, leaf: u32, regions: &[BlobRef]) {
        let entries = Arc::make_mut(&mut self.regions).iter_mut().skip(leaf as usize * LEAF).take(LEAF);
        entries.zip(regions).for_each(|(entry, &blob)| entry.blob = Some(blob));
    }

    /// Takes a region away, and its houses.
    pub fn forget(&mut self, number: u32) {
        if let (Some(page), Some(houses)) = (self.pages.get_mut(number as usize), self.houses.get_mut(number as usize)) {
            self.here -= usize::from(page.take().is_some());
            *houses = None;
        }
    }

    /// The houses of a region, if they are here.
    #[must_use]
    pub fn houses(&self, number: u32) -> Option<&Arc<RegionHouses>> {
        self.houses.get(number as usize)?.as_ref()
    }

    /// Puts houses where [`decode_houses`](crate::decode_houses) or a change of it belongs; nothing happens if there is no such number.
    pub fn put_houses(&mut self, number: u32, houses: Arc<RegionHouses>) {
        if let Some(page) = self.houses.get_mut(number as usize) {
            *page = Some(houses);
        }
    }

    /// What is told of a cell, if its region is here.
    #[must_use]
    pub fn cell(&self, cell: u32) -> Option<&CellEntry> {
        let number = self.region_of(cell)?;
        self.region(number)?.cells.get((cell - self.regions[number as usize].first) as usize)
    }

    /// All cells of the regions that are here, with their numbers, ascending.
    pub fn cells(&self) -> impl Iterator<Item = (u32, &CellEntry)> {
        self.regions_here().flat_map(|(number, region)| self.regions[number as usize].numbers().zip(&region.cells))
    }

    /// What a cell's packets are read with.
    #[must_use]
    pub fn packet_context(&self, cell: u32) -> PacketContext<'_> {
        let number = self.region_of(cell);
        let houses = number.and_then(|number| self.houses(number));
        PacketContext {
            outline: self.cell(cell).map(|entry| &entry.outline),
            palettes: &self.palettes,
            houses: houses.map(|houses| &**houses),
            place: number.map_or(0, |number| (cell - self.regions[number as usize].first) as usize),
        }
    }

    /// What a region's houses are read with.
    #[must_use]
    pub fn houses_context(&self, region: u32) -> HousesContext<'_> {
        HousesContext { cells: self.region(region).map_or(&[], |region| &region.cells), palettes: &self.palettes }
    }

    /// What a region's overview is read with.
    #[must_use]
    pub fn overview_context(&self, region: u32) -> OverviewContext<'_> {
        let first = self.regions.get(region as usize).map_or(0, |entry| entry.first);
        let cells = self.region(region).map_or(&[][..], |region| &region.cells);
        OverviewContext { first, cells, houses: self.houses(region).map(|houses| &**houses) }
    }

    /// Portals on a cell's border, if its region is here.
    pub fn portals(&self, cell: u32) -> impl Iterator<Item = &Portal> {
        let region = self.region_of(cell).and_then(|number| self.region(number));
        let portals = region
            .zip(self.cell(cell))
            .map(|(region, entry)| entry.portals.iter().filter_map(|&portal| region.portals.get(portal as usize)));
        portals.into_iter().flatten()
    }

    /// Whether a cell is known to be on the skyline.
    #[must_use]
    pub fn is_skyline(&self, cell: u32) -> bool {
        let region = self.region_of(cell).and_then(|number| self.region(number));
        region.is_some_and(|region| region.skyline.binary_search(&cell).is_ok())
    }

    /// Regions that may have a cell at a plan position.
    pub fn regions_at(&self, pos: GridPos) -> impl Iterator<Item = u32> {
        self.regions_about(pos, 0).map(|(number, _)| number)
    }

    /// Regions of which something may be drawn in a square about a plan position that reaches so many grid steps each way, by their
    /// numbers, which ascend.
    pub fn regions_about(&self, pos: GridPos, reach: i32) -> impl Iterator<Item = (u32, &RegionEntry)> {
        let square = (
            GridPos(pos.0.saturating_sub(reach), pos.1.saturating_sub(reach)),
            GridPos(pos.0.saturating_add(reach), pos.1.saturating_add(reach)),
        );
        self.bounds.meeting(square).filter_map(|number| Some((number, self.regions.get(number as usize)?)))
    }

    /// The cell in which a plan position lies, by looking at all in those of [`CityIndex::regions_at`] that are here; `None` outside of
    /// every cell. Where floors lie above each other, the first.
    #[must_use]
    pub fn locate(&self, pos: GridPos) -> Option<u32> {
        self.regions_at(pos).find_map(|number| {
            let mut cells = self.regions[number as usize].numbers().zip(&self.region(number)?.cells);
            cells.find(|(_, cell)| is_in(cell.bounds, pos) && cell.outline.contains(pos)).map(|(cell, _)| cell)
        })
    }
}

fn is_in((lo, hi): (GridPos, GridPos), pos: GridPos) -> bool {
    lo.0 <= pos.0 && pos.0 <= hi.0 && lo.1 <= pos.1 && pos.1 <= hi.1
}

/// The whole index of a city: waits for the reader. For tools; walkers read what they come to.
///
/// # Errors
/// If the index or one of its regions cannot be read or understood; the error names the file.
pub fn read_index(reader: &dyn Reader) -> Result<CityIndex, StoreError> {
    let stored = reader.read(INDEX_NAME, STORED_CAP)?;
    let mut index = decode_index(&stored).map_err(|error| error.in_file(reader.describe(), INDEX_NAME))?;
    for leaf in 0..index.leaves.len() as u32 {
        let blob = index.leaves[leaf as usize];
        let stored = reader.read(&blob.path(), u64::from(blob.bytes))?;
        let regions = decode_leaf(&stored, &blob, CityIndex::leaf_count(index.regions.len(), leaf));
        index.put_leaf(leaf, &regions.map_err(|error| error.in_file(reader.describe(), &blob.path()))?);
    }
    for number in 0..index.regions.len() as u32 {
        let blob = index.regions[number as usize].blob.unwrap_or_default();
        let stored = reader.read(&blob.path(), u64::from(blob.bytes))?;
        let region = decode_region(&stored, number, &index.regions);
        let region = region.map_err(|error| error.in_file(reader.describe(), &blob.path()))?;
        let houses = region.houses;
        index.put(number, Arc::new(region));
        if let Some(blob) = houses {
            let stored = reader.read(&blob.path(), u64::from(blob.bytes))?;
            let houses = decode_houses(&stored, &blob, index.houses_context(number));
            index.put_houses(number, Arc::new(houses.map_err(|error| error.in_file(reader.describe(), &blob.path()))?));
        }
    }
    Ok(index)
}

/// What an index is called in messages.
pub(crate) const WHAT: &str = "the index";
/// First bytes of an index.
const MAGIC: &[u8; 7] = b"VEDUTA\0";
/// Kind of file: an index.
const KIND: u8 = 1;
/// Bytes before the content: mark, kind, version, checksum.
const HEADER: usize = 7 + 1 + 4 + 32;

/// Stored form of an index, without its regions.
#[must_use]
pub fn encode_index(index: &CityIndex) -> Vec<u8> {
    let mut sealed = Vec::new();
    let (wire, outlines) = WireIndex::of(index);
    press(&wire, Some(&outlines), Prior::None, &mut sealed);
    seal(&sealed)
}

/// Content of an index under its header.
fn seal(sealed: &[u8]) -> Vec<u8> {
    let mut stored = Vec::with_capacity(HEADER + sealed.len());
    stored.extend(MAGIC);
    stored.push(KIND);
    stored.extend(FORMAT_VERSION.to_le_bytes());
    stored.extend(blake3::hash(sealed).as_bytes());
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

/// Whether bytes are those of an index, of any version, and whole.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn is_whole(stored: &[u8]) -> bool {
    let Some((sum, rest)) = stored.get(MAGIC.len() + 5..).and_then(|rest| rest.split_first_chunk::<32>()) else { return false };
    stored.starts_with(MAGIC) && blake3::hash(rest).as_bytes() == sum
}

/// The index of stored bytes; none of its regions is here yet.
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
    let index = unpress_with(WHAT, rest, Prior::None, VALUES_CAP, WireIndex::pull)?;
    valid::check_index(&index).map_err(|reason| StoreError::Invalid { what: WHAT, reason })?;
    Ok(index)
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;
    use veduta_city::{Id, PortalSide, Rgb};

    use super::*;
    use crate::blob::{BlobKind, pack};
    use crate::region::{RegionKey, encode_region};

    /// Two regions side by side, of two cells and of one.
    fn index() -> CityIndex {
        let square = |x| GridPolygon::simple(vec![GridPos(x, 0), GridPos(x + 50, 0), GridPos(x + 50, 50), GridPos(x, 50)]);
        let blob = |n: u8| Some(BlobRef { hash: [n; 12], bytes: 100 + u32::from(n) });
        let cell = |n: u32| CellEntry {
            id: Id(1 << 63 | u64::from(n)),
            name: format!("cell {n}"),
            outline: square(50 * n as i32),
            floor: (-3, 4),
            bounds: (GridPos(50 * n as i32 - 1024, 0), GridPos(50 * n as i32 + 50, 50 + 7 * 1024)),
            top: 20_000,
            portals: if n == 1 { vec![0, 1] } else { vec![0] },
            visible: vec![0, 1, 2],
            houses: 3,
            walls: 7,
            packets: [blob(n as u8), blob(9), None, None],
        };
        let portal = |cell: u32| {
            let x = 50 * cell as i32 + 50;
            Portal { ends: (GridPos(x, 0), GridPos(x, 50)), cell, beyond: PortalSide::Cell(cell + 1) }
        };
        let pages = [
            Region {
                cells: vec![cell(0), cell(1)],
                portals: vec![portal(0), portal(1)],
                skyline: vec![1],
                vistas: vec![1],
                overview: BlobRef { hash: [75; 12], bytes: 11 },
                houses: Some(BlobRef { hash: [77; 12], bytes: 15 }),
            },
            Region {
                cells: vec![cell(2)],
                portals: vec![portal(1)],
                skyline: vec![],
                vistas: vec![],
                overview: BlobRef { hash: [76; 12], bytes: 12 },
                houses: None,
            },
        ];
        let bounds = (GridPos(-1024, 0), GridPos(2048, 8192));
        let entry = |key, first, cells, skyline| RegionEntry {
            key,
            first,
            cells,
            skyline,
            top: 1024 * (20 - first as i32),
            bounds,
            blob: None,
        };
        let key = |square| RegionKey::new(square, 6).expect("a square");
        let mut regions = [entry(key(0b11_00_00), 0, 2, 1), entry(key(0b11_00_01), 2, 1, 0)];
        for n in 0..2 {
            regions[n].blob = Some(BlobRef::of(&encode_region(&pages[n], n as u32, &regions)));
        }
        let mut index = CityIndex {
            format: FORMAT_VERSION,
            name: "Testov".to_owned(),
            anchor: Anchor { lat: 50.0, lon: 14.0 },
            attribution: "nobody".to_owned(),
            seed: u64::MAX,
            growth_version: 3,
            start: Viewpoint::default(),
            extent: square(-100),
            regions: regions.into(),
            leaves: Vec::new(),
            palettes: [Palette { walls: vec![Rgb(200, 190, 170)], roofs: vec![Rgb(140, 70, 50)], trim: 1.1 }].into(),
            styles: Some(BlobRef { hash: [78; 12], bytes: 13 }),
            files: vec![CityFile { path: "t.guide.ron".to_owned(), blob: BlobRef { hash: [79; 12], bytes: 14 } }],
            bounds: Boxes::default(),
            pages: Vec::new(),
            here: 0,
            houses: Vec::new(),
        }
        .without_pages();
        for (n, page) in (0..).zip(pages) {
            index.put(n, Arc::new(page));
        }
        index
    }

    fn read(index: &CityIndex) -> Result<CityIndex, StoreError> {
        let mut read = decode_index(&encode_index(index))?;
        for (number, region) in index.regions_here() {
            read.put(number, Arc::new(decode_region(&encode_region(region, number, &index.regions), number, &index.regions)?));
        }
        Ok(read)
    }

    #[test]
    fn an_index_survives() {
        assert_eq!(read(&index()), Ok(index()));
    }

    #[test]
    fn a_form_that_changed_has_a_new_version() {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&encode_index(&index())[HEADER..]);
        for (number, region) in index().regions_here() {
            hasher.update(&encode_region(region, number, &index().regions));
        }
        let form = hasher.finalize().to_hex();
        assert_eq!((FORMAT_VERSION, &form[..16]), (22, "0ce7ff84c1b317ee"), "raise FORMAT_VERSION if this is on purpose");
    }

    #[test]
    fn a_cell_is_found_where_its_region_is_here() {
        let whole = index();
        assert_eq!([0, 1, 2, 3].map(|cell| whole.region_of(cell)), [Some(0), Some(0), Some(1), None]);
        assert_eq!(whole.cells().map(|(cell, _)| cell).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(whole.cell(2).map(|cell| cell.name.as_str()), Some("cell 2"));
        assert_eq!(whole.portals(1).map(|portal| portal.other(1)).collect::<Vec<_>>(), [Some(0), Some(2)]);
        assert_eq!((whole.is_skyline(1), whole.is_skyline(2), whole.cell_count()), (true, false, 3));
        assert_eq!([25, 75, 125].map(|x| whole.locate(GridPos(x, 25))), [Some(0), Some(1), Some(2)]);
        let mut part = whole;
        part.forget(0);
        assert_eq!((part.cell(1), part.cells().count(), part.portals(1).count()), (None, 1, 0));
        assert_eq!([25, 125].map(|x| part.locate(GridPos(x, 25))), [None, Some(2)]);
        assert_eq!(part.regions_at(GridPos(25, 25)).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(part.regions_at(GridPos(25, -25)).count(), 0);
    }

    #[test]
    fn a_region_that_grows_changes_only_the_names_of_its_own_cells() {
        let (before, mut regions) = (index(), index().regions.to_vec());
        let mut after = Region::clone(before.region(1).expect("here"));
        // A cell is built in the first region: the numbers of all that follow are one higher.
        (regions[0].cells, regions[1].first) = (3, 3);
        let shift = |cell: u32| if cell == 2 { 3 } else { cell };
        after.cells[0].visible = after.cells[0].visible.iter().map(|&cell| shift(cell)).collect();
        after.portals[0].beyond = PortalSide::Cell(3);
        let stored = |region: &Region, regions: &[RegionEntry]| encode_region(region, 1, regions);
        assert_eq!(stored(&after, &regions), stored(before.region(1).expect("here"), &before.regions));
    }

    #[test]
    fn an_index_that_claims_gigabytes_is_refused() {
        let claims: [(&str, fn(&mut CityIndex) -> &mut BlobRef, u32); 2] = [
            ("a region of the index", |index| Arc::make_mut(&mut index.regions)[1].blob.as_mut().expect("told"), 17 << 20),
            ("the styles", |index| index.styles.as_mut().expect("styles"), u32::MAX),
        ];
        for (what, blob, bytes) in claims {
            let mut index = index().without_pages();
            blob(&mut index).bytes = 16 << 20;
            assert_eq!(decode_index(&encode_index(&index)).as_ref(), Ok(&index), "{what}: large, but possible");
            blob(&mut index).bytes = bytes;
            let error = decode_index(&encode_index(&index)).expect_err(what).to_string();
            assert!(error.contains(&format!("{what} claims {bytes} bytes")), "{error}");
        }
        let mut index = index();
        let mut region = Region::clone(index.region(0).expect("here"));
        region.cells[1].packets[0].as_mut().expect("a packet").bytes = 17 << 20;
        let stored = encode_region(&region, 0, &index.regions);
        Arc::make_mut(&mut index.regions)[0].blob = Some(BlobRef::of(&stored));
        let error = decode_region(&stored, 0, &index.regions).expect_err("a large packet").to_string();
        assert!(error.contains("a packet of level 1 claims 17825792 bytes"), "{error}");
    }

    #[test]
    fn a_region_may_not_reach_higher_than_anything_does() {
        let read = |top: i32| {
            let mut index = index().without_pages();
            Arc::make_mut(&mut index.regions)[1].top = top;
            decode_index(&encode_index(&index)).map(|read| read.regions[1].top)
        };
        for top in [0, 1 << 27, -(1 << 27)] {
            assert_eq!(read(top), Ok(top));
        }
        for top in [(1 << 27) + 1024, -(1 << 27) - 1024, i32::MAX / 1024 * 1024] {
            let error = read(top).expect_err("too high").to_string();
            assert!(error.contains(&format!("region 1: its top is at a height of {top} steps")), "{error}");
        }
    }

    #[test]
    fn noise_takes_hardly_more_than_its_own_size() {
        let mut reader = blake3::Hasher::new().finalize_xof();
        let mut noise = vec![0_u8; 1 << 20];
        reader.fill(&mut noise);
        let stored = pack(BlobKind::Styles, &noise);
        assert!(stored.len() < noise.len() * 102 / 100, "{} bytes", stored.len());
    }

    proptest! {
        /// Someone who can compute checksums makes indices that no encoder would.
        #[test]
        fn forged_indices_do_no_harm(edits in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
            let forge = |mut content: Vec<u8>| {
                for (at, byte) in &edits {
                    let at = 1 + at.index(content.len() - 1);
                    content[at] = *byte;
                }
                content
            };
            if let Ok(index) = decode_index(&seal(&forge(encode_index(&index()).split_off(HEADER)))) {
                prop_assert_eq!(valid::check_index(&index), Ok(()));
            }
            let mut index = index();
            let stored = forge(encode_region(index.region(0).expect("here"), 0, &index.regions));
            Arc::make_mut(&mut index.regions)[0].blob = Some(BlobRef::of(&stored));
            if let Ok(region) = decode_region(&stored, 0, &index.regions) {
                prop_assert_eq!(valid::check_region(&region, &index.regions[0], &index.regions), Ok(()));
                index.put(0, Arc::new(region));
                let _anywhere = index.locate(GridPos(25, 25));
            }
        }
    }
}
