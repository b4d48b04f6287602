use serde::{Deserialize, Serialize};
use veduta_city::{Anchor, Boxes, GRID_PER_METRE, GridPos, Palette, Viewpoint};

use super::{
    Malformed, WireBlobs,
    columns::{Deltas, Pull, Texts},
    keys::Keys,
};
use crate::code::{Outlines, Source, Unread};
use crate::{CityFile, CityIndex, FORMAT_VERSION, RegionEntry, RegionKey};

/// A [`CityIndex`] in columns, without the regions themselves.
#[derive(Serialize, Deserialize)]
pub(crate) struct WireIndex {
    anchor: Anchor,
    seed: u64,
    growth_version: u32,
    start: Viewpoint,
    /// Name and attribution of the city, then the paths of its files.
    texts: Texts,
    regions: WireRegions,
    leaves: WireBlobs,
    palettes: Vec<Palette>,
    styles: WireBlobs,
    files: WireBlobs,
}

#[derive(Serialize, Deserialize)]
struct WireRegions {
    keys: Keys,
    cells: Vec<u32>,
    skyline: Vec<u32>,
    /// Metres.
    tops: Deltas,
    /// Metres: western, southern, eastern, northern.
    bounds: [Deltas; 4],
    /// None of a city with leaves.
    blobs: WireBlobs,
}

/// The section of the city's edge.
const EXTENT: u8 = 0;

impl WireIndex {
    pub(crate) fn of(index: &CityIndex) -> (Self, Outlines) {
        let mut outlines = Outlines::default();
        outlines.polygon(EXTENT, &index.extent);
        let paths = index.files.iter().map(|file| file.path.as_str());
        let wire = Self {
            anchor: index.anchor,
            seed: index.seed,
            growth_version: index.growth_version,
            start: index.start,
            texts: Texts::of([index.name.as_str(), index.attribution.as_str()].into_iter().chain(paths)),
            regions: WireRegions::of(&index.regions, !index.leaves.is_empty()),
            leaves: WireBlobs::of(&index.leaves),
            palettes: index.palettes.to_vec(),
            styles: WireBlobs::of(&index.styles),
            files: WireBlobs::of(index.files.iter().map(|file| &file.blob)),
        };
        (wire, outlines)
    }
}

impl WireRegions {
    fn of(regions: &[RegionEntry], has_leaves: bool) -> Self {
        let metres = |of: fn(&RegionEntry) -> i32| Deltas::of(regions.iter().map(|region| of(region).div_euclid(GRID_PER_METRE)));
        Self {
            keys: Keys::of(RegionKey::WHOLE, regions.iter().map(|region| Some(region.key))),
            cells: regions.iter().map(|region| region.cells).collect(),
            skyline: regions.iter().map(|region| region.skyline).collect(),
            tops: metres(|region| region.top),
            bounds: [metres(|r| r.bounds.0.0), metres(|r| r.bounds.0.1), metres(|r| r.bounds.1.0), metres(|r| r.bounds.1.1)],
            blobs: WireBlobs::of(regions.iter().filter_map(|region| region.blob.as_ref().filter(|_| !has_leaves))),
        }
    }

    fn pull(self, has_leaves: bool) -> Result<Vec<RegionEntry>, Malformed> {
        let mut cells = Pull::new("numbers of cells", self.cells);
        let mut skyline = Pull::new("skylines of regions", self.skyline);
        let mut tops = Pull::new("tops of regions", self.tops.numbers());
        let mut sides = self.bounds.map(|side| Pull::new("bounds of regions", side.numbers()));
        let mut blobs = self.blobs.pull("blobs of regions");
        let mut side = |n: usize| Ok(sides[n].take()?.saturating_mul(GRID_PER_METRE));
        let mut first = 0_u32;
        let mut regions = Vec::new();
        for key in self.keys.pull(RegionKey::WHOLE)? {
            let count = cells.take()?;
            regions.push(RegionEntry {
                key,
                first,
                cells: count,
                skyline: skyline.take()?,
                top: tops.take()?.saturating_mul(GRID_PER_METRE),
                bounds: (GridPos(side(0)?, side(1)?), GridPos(side(2)?, side(3)?)),
                blob: if has_leaves { None } else { Some(blobs.take()?) },
            });
            first = first.checked_add(count).ok_or(Malformed::Reason("there are more cells than have numbers"))?;
        }
        cells.finish()?;
        skyline.finish()?;
        tops.finish()?;
        sides.iter().try_for_each(Pull::finish)?;
        blobs.finish()?;
        Ok(regions)
    }
}

impl WireIndex {
    pub(crate) fn pull(self, outlines: &mut Source<'_, '_>) -> Result<CityIndex, Unread> {
        let wire = self;
        let mut texts = wire.texts.pull()?;
        let (name, attribution) = (texts.take()?, texts.take()?);
        let files = wire.files.all("files")?.into_iter().map(|blob| Ok(CityFile { path: texts.take()?, blob }));
        let files = files.collect::<Result<_, Malformed>>()?;
        texts.finish()?;
        let extent = outlines.polygon(EXTENT)?;
        let leaves = wire.leaves.all("leaves of the index")?;
        let styles = match wire.styles.all("styles")?[..] {
            [] => None,
            [styles] => Some(styles),
            _ => return Err(Malformed::Reason("it has several styles").into()),
        };
        Ok(CityIndex {
            format: FORMAT_VERSION,
            name,
            anchor: wire.anchor,
            attribution,
            seed: wire.seed,
            growth_version: wire.growth_version,
            start: wire.start,
            extent,
            regions: wire.regions.pull(!leaves.is_empty())?.into(),
            leaves,
            palettes: wire.palettes.into(),
            styles,
            files,
            bounds: Boxes::default(),
            pages: Vec::new(),
            here: 0,
            houses: Vec::new(),
        }
        .without_pages())
    }
}
