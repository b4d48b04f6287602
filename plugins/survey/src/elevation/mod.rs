//! Elevations of the ground and of what stands on it, and what they tell a city graph.

mod ascii_grid;
mod drape;
mod geotiff;
mod hgt;
mod packed;
mod posts;
mod sample;
mod spikes;
mod spread;
mod surface;

use core::fmt;

use glam::DVec2;
use veduta_city::Anchor;

use crate::SurveyError;
use crate::crs::{CRS_FIX, Crs};
use crate::georeference::Affine;

pub use drape::drape;
pub use spikes::Spike;
pub use surface::heights_from_surface;

/// Most cells of a grid.
const MOST_CELLS: u64 = 16_384 * 16_384;
/// Sides of a cell that are taken, metres.
const CELLS_M: core::ops::RangeInclusive<f64> = 0.001..=10_000.0;
/// What lies outside of this is no elevation of a place with houses but a number that stands for no data; metres.
const BELIEVED_M: core::ops::RangeInclusive<f32> = -1_000.0..=9_000.0;

/// A grid of elevations: a terrain model (bare ground) or a surface model (with roofs and trees), in metres above the sea as
/// its maker reckons it.
///
/// Cells are areas: a value belongs to a cell's middle and is interpolated in between, and the outermost half cell keeps the
/// value of its middle. Cells without data are filled from around where the hole is small.
///
/// ```
/// let text = "ncols 2\nnrows 2\nxllcorner 14.0\nyllcorner 50.0\ncellsize 0.05\n200 210\n180 190\n";
/// let grid = veduta_survey::ElevationGrid::read(text.as_bytes(), "hill.asc", Some("EPSG:4326"))?;
/// assert_eq!(grid.at(50.09, 14.01), Some(200.0));
/// assert!((grid.at(50.05, 14.05).unwrap() - 195.0).abs() < 1e-6);
/// assert_eq!(grid.at(50.5, 14.05), None);
/// # Ok::<(), veduta_survey::SurveyError>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct ElevationGrid {
    name: String,
    columns: u32,
    rows: u32,
    affine: Affine,
    crs: Crs,
    /// Size of a cell in the middle of the grid, metres.
    cell_m: f64,
    /// Metres, row by row from the north; NaN where there is no data.
    heights: Vec<f32>,
}

/// What a format gives.
#[derive(Debug)]
struct Cells {
    columns: u32,
    rows: u32,
    affine: Option<Affine>,
    crs: Option<Crs>,
    heights: Vec<f32>,
}

/// Columns and rows if they are not too many.
fn check_size(name: &str, columns: u64, rows: u64) -> Result<(u32, u32), SurveyError> {
    let too_large = || SurveyError::GridTooLarge { name: name.to_owned(), columns, rows };
    if columns == 0 || rows == 0 {
        let detail = format!("it has {columns} x {rows} cells");
        return Err(SurveyError::Broken { name: name.to_owned(), format: "elevation grid", detail });
    }
    if columns.checked_mul(rows).is_none_or(|cells| cells > MOST_CELLS) {
        return Err(too_large());
    }
    Ok((u32::try_from(columns).map_err(|_| too_large())?, u32::try_from(rows).map_err(|_| too_large())?))
}

impl ElevationGrid {
    /// Reads a grid, told by content: ESRI ASCII grid (`.asc`), SRTM tile of one or three seconds (`.hgt`, whose name tells
    /// its place), GeoTIFF of one band; each also in a `.zip` with one such file, or in a `.gz`.
    ///
    /// `name` is the file's name; `prj` is the text of the `.prj` beside it, which tells the coordinate system where the file
    /// itself does not.
    ///
    /// # Errors
    /// [`SurveyError`] if the bytes are no such file, are cut off or broken, hold more than 16,384² cells (told by the header,
    /// before room is made for them), or do not say where they lie.
    pub fn read(bytes: &[u8], name: &str, prj: Option<&str>) -> Result<Self, SurveyError> {
        match packed::unpack(bytes, name)? {
            Some(inner) => {
                let prj = inner.prj.as_deref().or(prj);
                let whole_name = format!("{name} ({})", inner.name);
                Self::of_plain(&inner.bytes, &inner.name, &whole_name, prj)
            }
            None => Self::of_plain(bytes, name, name, prj),
        }
    }

    fn of_plain(bytes: &[u8], own_name: &str, name: &str, prj: Option<&str>) -> Result<Self, SurveyError> {
        let cells = if geotiff::is_tiff(bytes) {
            geotiff::read(bytes, name)?
        } else if ascii_grid::is_ascii_grid(bytes) {
            ascii_grid::read(bytes, name)?
        } else if hgt::is_hgt(bytes, own_name) {
            hgt::read(bytes, own_name)?
        } else {
            return Err(SurveyError::NotElevation { name: name.to_owned() });
        };
        Self::of_cells(cells, name, prj)
    }

    fn of_cells(cells: Cells, name: &str, prj: Option<&str>) -> Result<Self, SurveyError> {
        let unplaced = |detail: &str| SurveyError::Unplaced { name: name.to_owned(), detail: detail.to_owned() };
        let Some(affine) = cells.affine else {
            return Err(unplaced("its tags do not tell where it lies; write it anew with gdal_translate -a_ullr and -a_srs"));
        };
        let crs = match (cells.crs, prj) {
            (Some(own), _) => own,
            (None, Some(text)) => Crs::from_text(text).map_err(|e| {
                let name = format!("the .prj of {name}");
                SurveyError::Unsupported { name, feature: e.to_string(), fix: CRS_FIX }
            })?,
            (None, None) => {
                return Err(unplaced("it does not tell its coordinate system; put a .prj beside it that does, as in EPSG:5514"));
            }
        };
        let mut grid = Self {
            name: name.to_owned(),
            columns: cells.columns,
            rows: cells.rows,
            affine,
            crs,
            cell_m: 0.0,
            heights: cells.heights,
        };
        grid.cell_m = grid.measured_cell().ok_or_else(|| {
            let detail = format!("its middle is no place in {crs}; give the coordinate system that its numbers are in");
            SurveyError::Unplaced { name: name.to_owned(), detail }
        })?;
        if !CELLS_M.contains(&grid.cell_m) {
            return Err(unplaced(&format!(
                "its cells would be {} m wide, and a city's are between a millimetre and 10 km",
                grid.cell_m
            )));
        }
        grid.heights.iter_mut().filter(|h| !BELIEVED_M.contains(h)).for_each(|h| *h = f32::NAN);
        if grid.heights.iter().all(|h| h.is_nan()) {
            let detail = "no cell of it holds an elevation (they lie between -1000 and 9000 m)".to_owned();
            return Err(SurveyError::Broken { name: name.to_owned(), format: "elevation grid", detail });
        }
        Ok(grid)
    }

    /// Side in metres of a square with the area of a cell in the grid's middle.
    fn measured_cell(&self) -> Option<f64> {
        let middle = DVec2::new(f64::from(self.columns), f64::from(self.rows)) / 2.0;
        let geo = |by: DVec2| self.crs.geo_from_pos(self.affine.pos(middle + by));
        let (lat, lon) = geo(DVec2::ZERO)?;
        let anchor = Anchor { lat, lon };
        let plan = |by: DVec2| geo(by).map(|(lat, lon)| anchor.plan_from_geo(lat, lon));
        let side = libm::sqrt(plan(DVec2::X)?.perp_dot(plan(DVec2::Y)?).abs());
        (lat.abs() <= 89.0 && side.is_finite()).then_some(side)
    }

    /// Name of the file.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }

    /// Its coordinate system.
    #[must_use]
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// Side of a cell in metres, in the middle of the grid.
    #[must_use]
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Least and greatest elevation in metres.
    #[must_use]
    pub fn range_m(&self) -> (f64, f64) {
        let known = self.heights.iter().filter(|h| !h.is_nan());
        let (low, high) = known.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &h| (low.min(h), high.max(h)));
        (low.into(), high.into())
    }

    /// Share of the cells that hold no data.
    #[must_use]
    pub fn share_of_holes(&self) -> f64 {
        self.heights.iter().filter(|h| h.is_nan()).count() as f64 / self.heights.len().max(1) as f64
    }

    /// Elevation in metres at a WGS 84 latitude and longitude in degrees: between the four nearest cells, those without data
    /// filled from around them. `None` outside of the grid and in the middle of large holes.
    #[must_use]
    pub fn at(&self, lat: f64, lon: f64) -> Option<f64> {
        sample::Sampler::new(self).at(self.pixel_from_geo(lat, lon)?).height_m()
    }

    /// Elevation in metres at a plan position of a city.
    #[must_use]
    pub fn at_plan(&self, anchor: Anchor, plan_pos: DVec2) -> Option<f64> {
        let (lat, lon) = anchor.geo_from_plan(plan_pos);
        self.at(lat, lon)
    }

    /// The pixel position of a place; may lie outside of the grid.
    fn pixel_from_geo(&self, lat: f64, lon: f64) -> Option<DVec2> {
        let pos = self.crs.pos_from_geo(lat, lon)?;
        let pixel = self.affine.pixel(pos);
        if self.crs.is_degrees() && !self.holds(pixel) {
            // Some grids count degrees from 0 to 360.
            let turned = [-360.0, 360.0].map(|turn| self.affine.pixel(pos + DVec2::new(turn, 0.0)));
            return turned.into_iter().find(|p| self.holds(*p)).or(Some(pixel));
        }
        Some(pixel)
    }

    fn pixel_from_plan(&self, anchor: Anchor, plan_pos: DVec2) -> Option<DVec2> {
        let (lat, lon) = anchor.geo_from_plan(plan_pos);
        self.pixel_from_geo(lat, lon)
    }

    fn plan_from_pixel(&self, anchor: Anchor, pixel: DVec2) -> Option<DVec2> {
        let (lat, lon) = self.crs.geo_from_pos(self.affine.pos(pixel))?;
        Some(anchor.plan_from_geo(lat, lon))
    }

    fn holds(&self, pixel: DVec2) -> bool {
        let size = DVec2::new(f64::from(self.columns), f64::from(self.rows));
        pixel.cmpge(DVec2::splat(-sample::BORDER)).all() && pixel.cmple(size + sample::BORDER).all()
    }

    /// Value of a cell; `None` outside and without data.
    fn cell(&self, column: i64, row: i64) -> Option<f64> {
        let is_inside = (0..i64::from(self.columns)).contains(&column) && (0..i64::from(self.rows)).contains(&row);
        let height = is_inside.then(|| self.heights.get(row as usize * self.columns as usize + column as usize)).flatten()?;
        (!height.is_nan()).then_some(f64::from(*height))
    }

    /// What it covers, in degrees.
    fn covers(&self) -> String {
        let (width, height) = (f64::from(self.columns), f64::from(self.rows));
        let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
        let geo = corners.iter().filter_map(|&c| self.crs.geo_from_pos(self.affine.pos(c.into())));
        let none = (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY);
        let (south, north, west, east) =
            geo.fold(none, |(s, n, w, e), (lat, lon)| (s.min(lat), n.max(lat), w.min(lon), e.max(lon)));
        format!("latitudes {south:.4} to {north:.4} and longitudes {west:.4} to {east:.4}")
    }

    /// Whether any node of a city lies in the grid.
    ///
    /// # Errors
    /// [`SurveyError::Elsewhere`] with both places if none does.
    pub fn check_covers(&self, graph: &veduta_city::CityGraph) -> Result<(), SurveyError> {
        let is_inside = |p: DVec2| self.pixel_from_plan(graph.anchor, p).is_some_and(|pixel| self.holds(pixel));
        let corners = graph.buildings.iter().filter_map(|b| b.outline.first().copied());
        if graph.nodes.iter().map(|n| n.pos).chain(corners).any(is_inside) {
            return Ok(());
        }
        let city = format!("latitude {:.4} and longitude {:.4}", graph.anchor.lat, graph.anchor.lon);
        Err(SurveyError::Elsewhere { name: self.name.clone(), covers: self.covers(), city })
    }
}

impl fmt::Debug for ElevationGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ElevationGrid({}, {} x {} cells of {:.1} m, {})", self.name, self.columns, self.rows, self.cell_m, self.crs)
    }
}

#[cfg(test)]
mod tests;
