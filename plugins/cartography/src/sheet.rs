use core::str::FromStr;

use glam::DVec2;

use crate::{Area, Frame};

/// A sheet of paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paper {
    /// Width and height, millimetres.
    pub size_mm: DVec2,
    /// Whether it may be turned so that more fits on it.
    pub may_turn: bool,
}

/// Sides of sheets, millimetres: at least and at most.
pub const SIDES_MM: core::ops::RangeInclusive<f64> = 70.0..=2_000.0;

/// Not a sheet of paper.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no paper: write A0 to A5, or a width and height in millimetres, as in 400x300mm; sides of 70 to 2000 mm are printed on"
)]
pub struct PaperError(pub String);

impl Paper {
    /// A sheet of the A series (ISO 216), which may be turned: `A(3)`.
    #[must_use]
    pub fn a(n: u32) -> Self {
        let (mut short, mut long) = (841.0, 1189.0);
        for _ in 0..n.min(10) {
            (short, long) = (libm::floor(long / 2.0), short);
        }
        Self { size_mm: DVec2::new(short, long), may_turn: true }
    }
}

impl FromStr for Paper {
    type Err = PaperError;

    fn from_str(text: &str) -> Result<Self, PaperError> {
        let wrong = || PaperError(text.to_owned());
        let plain = text.trim().to_ascii_lowercase();
        if let Some(n) = plain.strip_prefix('a') {
            return n.parse().ok().filter(|n| *n <= 5).map(Self::a).ok_or_else(wrong);
        }
        let (width, height) = plain.strip_suffix("mm").unwrap_or(&plain).split_once(['x', '×']).ok_or_else(wrong)?;
        let side = |text: &str| text.trim().parse::<f64>().ok().filter(|mm| SIDES_MM.contains(mm));
        let (width, height) = side(width).zip(side(height)).ok_or_else(wrong)?;
        Ok(Self { size_mm: DVec2::new(width, height), may_turn: false })
    }
}

/// Denominators of scales that maps have.
const SCALES: [f64; 25] = [
    250.0, 500.0, 750.0, 1_000.0, 1_250.0, 1_500.0, 1_750.0, 2_000.0, 2_500.0, 3_000.0, 3_500.0, 4_000.0, 4_500.0, 5_000.0,
    6_000.0, 7_000.0, 8_000.0, 9_000.0, 10_000.0, 12_500.0, 15_000.0, 20_000.0, 25_000.0, 50_000.0, 100_000.0,
];
/// Denominators of scales that can be asked for.
pub const DENOMINATORS: core::ops::RangeInclusive<f64> = 100.0..=200_000.0;

/// Where on the sheet what stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Width and height, millimetres.
    pub size_mm: DVec2,
    /// The map.
    pub map: Area,
    /// The title, above it.
    pub head: Area,
    /// Scale, north and legend, below it.
    pub foot: Area,
    /// The index, on its right, if there is one.
    pub index: Option<Area>,
}

const MARGIN_MM: f64 = 8.0;
const HEAD_MM: f64 = 13.0;
const FOOT_MM: f64 = 20.0;
const GAP_MM: f64 = 3.0;

impl Sheet {
    /// A sheet with an index so wide beside the map; 0 for none.
    #[must_use]
    pub fn new(size_mm: DVec2, index_mm: f64) -> Self {
        let inner = Area { min: DVec2::splat(MARGIN_MM), max: size_mm - MARGIN_MM };
        let index_mm = index_mm.min(inner.size().x * 0.36);
        // Between them stand the numbers of the fields.
        let right = inner.max.x - if index_mm > 0.0 { index_mm + 2.0 * GAP_MM } else { 0.0 };
        let map = Area { min: inner.min + DVec2::new(0.0, HEAD_MM), max: DVec2::new(right, inner.max.y - FOOT_MM) };
        let head = Area { min: inner.min, max: DVec2::new(inner.max.x, map.min.y) };
        let foot = Area { min: DVec2::new(inner.min.x, map.max.y + GAP_MM), max: inner.max };
        let beside = Area { min: DVec2::new(right + 2.0 * GAP_MM, map.min.y), max: DVec2::new(inner.max.x, map.max.y) };
        Self { size_mm, map, head, foot, index: (index_mm > 0.0).then_some(beside) }
    }

    /// How a part of the plan lies on it: about a middle, so large, as large as a round scale lets it be; or of a given scale. Answers the
    /// scale's denominator too.
    #[must_use]
    pub fn fit(&self, middle: DVec2, size_m: DVec2, denominator: Option<f64>, up_deg: f64) -> (Frame, f64) {
        let room = self.map.size();
        let fits = |denominator: &f64| (size_m * 1000.0 / denominator).cmple(room).all();
        let denominator = denominator.unwrap_or_else(|| {
            let found = SCALES.iter().copied().find(|d| fits(d));
            // Beyond all usual scales, in whole hundred thousands.
            found.unwrap_or_else(|| libm::ceil((size_m * 1000.0 / room).max_element() / 1e5) * 1e5)
        });
        (Frame::new(middle, self.map.middle(), 1000.0 / denominator, up_deg), denominator)
    }
}

/// The smallest part of a plan, turned, that holds some positions: its middle in plan and its size across and up.
#[must_use]
pub fn extent(positions: impl IntoIterator<Item = DVec2>, up_deg: f64) -> Option<(DVec2, DVec2)> {
    let turned = Frame::new(DVec2::ZERO, DVec2::ZERO, 1.0, up_deg);
    let bounds = positions.into_iter().map(|p| turned.project(p)).fold(None, |bounds: Option<Area>, p| {
        Some(bounds.map_or(Area { min: p, max: p }, |b| Area { min: b.min.min(p), max: b.max.max(p) }))
    })?;
    Some((turned.plan(bounds.middle()), bounds.size()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paper_is_told_by_name_or_by_its_sides() {
        let size = |text: &str| text.parse::<Paper>().map(|paper| paper.size_mm.to_array());
        assert_eq!(size("A4"), Ok([210.0, 297.0]));
        assert_eq!((size("a3"), size("A0")), (Ok([297.0, 420.0]), Ok([841.0, 1189.0])));
        assert_eq!((size("400x300mm"), size("400 × 300")), (Ok([400.0, 300.0]), Ok([400.0, 300.0])));
        for wrong in ["A9", "A", "3x4", "400", "x", "1e9x5", "NaNx300"] {
            assert_eq!(size(wrong), Err(PaperError(wrong.to_owned())));
        }
    }

    #[test]
    fn the_largest_round_scale_is_taken_at_which_all_fits() {
        let sheet = Sheet::new(DVec2::new(420.0, 297.0), 0.0);
        let (frame, denominator) = sheet.fit(DVec2::ZERO, DVec2::new(1_000.0, 500.0), None, 0.0);
        assert_eq!(denominator, 2_500.0);
        assert!(sheet.map.contains(frame.project(DVec2::new(499.0, 249.0))));
        assert!(1_000.0 * 1000.0 / 2_000.0 > sheet.map.size().x, "1 : 2000 would be too large");
        assert_eq!(sheet.fit(DVec2::ZERO, DVec2::splat(1e9), None, 0.0).1 % 1e5, 0.0);
        assert_eq!(sheet.fit(DVec2::ZERO, DVec2::splat(1e3), Some(777.0), 0.0).1, 777.0);
    }

    #[test]
    fn the_extent_of_what_is_turned_is_as_narrow_as_it_is() {
        let diagonal = (0..=10).map(|i| DVec2::splat(f64::from(i)));
        let (middle, size) = extent(diagonal, 45.0).expect("not empty");
        assert!(middle.distance(DVec2::splat(5.0)) < 1e-9 && size.x < 1e-9 && (size.y - 200f64.sqrt()).abs() < 1e-9, "{size}");
        assert_eq!(extent([], 0.0), None);
    }
}
