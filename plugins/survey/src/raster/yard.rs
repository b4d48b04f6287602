//! Courtyards: bits of the streets' colour that no street leads to.
//!
//! A map that only tells built from open shows the courts of its blocks as it shows its streets. What hangs together with
//! the network is street, however narrow the gate is through which it does; what does not, and is a place rather than a way,
//! is a courtyard. A street that a label cuts off lies beside that label, and one that noise cuts off is long and narrow.

use glam::IVec2;

use super::bitmap::Bitmap;
use super::clean::SPECK_M2;
use super::morphology::grown;
use super::outline::{Corners, Outline, outlines};
use super::parts::Part;

/// Least share of the disc as long around that a courtyard covers: 0.79 of a square, 0.5 of a box four times as long as wide.
const LEAST_ROUND: f64 = 0.36;
/// A part of the network that a label may have cut off lies so near to the label, pixels.
const BESIDE_PX: usize = 4;

/// Takes courtyards out of the streets, and gives them; nothing where there are none. `parts` are those of the streets, or
/// of what they were before they were cleaned of specks. What lies beside anything `hidden`, or has any pixel that is `kept`,
/// is none.
pub(crate) fn courtyards(street: &mut Bitmap, parts: &[Part], hidden: &Bitmap, kept: Option<&Bitmap>, mpp: f64) -> Option<Bitmap> {
    let size = IVec2::new(street.width() as i32, street.height() as i32);
    let least_px = (SPECK_M2 / (mpp * mpp)) as i64;
    let largest = parts.iter().map(|part| part.area_px).max()?;
    let is_inside = |part: &Part| part.low.min_element() > 0 && part.high.cmplt(size).all();
    let may_be = |part: &&Part| part.area_px >= least_px && part.area_px < largest && is_inside(part);
    let mut yards: Option<Bitmap> = None;
    for part in parts.iter().filter(may_be) {
        let Some(yard) = Yard::of(street, part) else { continue };
        if yard.is_round() && !yard.meets(hidden) && !kept.is_some_and(|kept| yard.has_any_of(kept)) {
            let yards = yards.get_or_insert_with(|| Bitmap::new(street.width(), street.height()));
            let (width, height) = (yard.area.width() as i32, yard.area.height() as i32);
            yards.add_from(&yard.area, IVec2::ZERO, yard.corner, IVec2::new(width, height));
        }
    }
    if let Some(yards) = &yards {
        street.remove(yards);
    }
    yards
}

/// A part of the streets that may be a courtyard, in a window of its own.
struct Yard {
    corner: IVec2,
    area: Bitmap,
    /// Pixels inside of its outline, and the outline's length.
    inside_px: f64,
    around_px: f64,
}

impl Yard {
    /// Nothing if it goes around a block.
    fn of(street: &Bitmap, part: &Part) -> Option<Self> {
        let corner = part.low - BESIDE_PX as i32;
        let (width, height) = (part.high - part.low + 2 * BESIDE_PX as i32).as_usizevec2().into();
        let window = Bitmap::from_window(street, corner, width, height);
        let found = outlines(&window, Corners::Join);
        // Other parts may reach into the window, or lie in it.
        let low = part.low - corner;
        let high = part.high - corner;
        let own = found.iter().find(|o| !o.is_hole() && o.extent() == (low, high))?;
        let mut area = Bitmap::new(width, height);
        own.paint(&mut area, true);
        area.keep(&window);
        if outlines(&area, Corners::Join).iter().any(Outline::is_hole) {
            return None;
        }
        let ring = own.simplified(1.0);
        let around_px = (0..ring.len()).map(|i| ring[i].distance(ring[(i + 1) % ring.len()])).sum();
        Some(Self { corner, area, inside_px: own.area_px as f64, around_px })
    }

    fn is_round(&self) -> bool {
        let disc = self.around_px * self.around_px / (4.0 * core::f64::consts::PI);
        self.inside_px > LEAST_ROUND * disc
    }

    /// Whether it lies beside any of these pixels.
    fn meets(&self, pixels: &Bitmap) -> bool {
        let mut near = grown(&self.area, BESIDE_PX);
        near.keep(&self.window_of(pixels));
        !near.is_blank()
    }

    fn has_any_of(&self, pixels: &Bitmap) -> bool {
        let mut own = self.area.clone();
        own.keep(&self.window_of(pixels));
        !own.is_blank()
    }

    fn window_of(&self, of: &Bitmap) -> Bitmap {
        Bitmap::from_window(of, self.corner, self.area.width(), self.area.height())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::parts::Parts;

    /// A street along the top, and what else is light.
    fn yards(light: impl Fn(usize, usize) -> bool, hidden: impl Fn(usize, usize) -> bool) -> (usize, usize) {
        let mut street = Bitmap::from_fn(200, 200, |x, y| y < 20 || light(x, y));
        let before = street.count();
        let hidden = Bitmap::from_fn(200, 200, hidden);
        let parts = Parts::of(&street, Corners::Join).parts;
        let yards = courtyards(&mut street, &parts, &hidden, None, 0.5);
        (yards.map_or(0, |yards| yards.count()), before - street.count())
    }

    fn is_in(low: [usize; 2], high: [usize; 2]) -> impl Fn(usize, usize) -> bool {
        move |x, y| (low[0]..high[0]).contains(&x) && (low[1]..high[1]).contains(&y)
    }

    #[test]
    fn a_court_that_no_street_leads_to_is_a_courtyard() {
        assert_eq!(yards(is_in([60, 60], [120, 100]), |_, _| false), (2400, 2400));
        // An L.
        let wings = |x: usize, y: usize| is_in([60, 60], [120, 85])(x, y) || is_in([60, 60], [85, 130])(x, y);
        assert_eq!(yards(wings, |_, _| false).0, 25 * 60 + 45 * 25);
    }

    #[test]
    fn what_a_street_leads_to_is_none() {
        let court = is_in([60, 60], [120, 100]);
        for gate in [1, 2, 8] {
            assert_eq!(yards(|x, y| court(x, y) || is_in([80, 10], [80 + gate, 70])(x, y), |_, _| false), (0, 0), "{gate}");
        }
        // By a corner only.
        let corner = |x: usize, y: usize| court(x, y) || (x < 60 && x > 20 && y < 60 && x + y > 117 && x + y < 120);
        assert_eq!(yards(|x, y| corner(x, y) || is_in([20, 10], [60, 60])(x, y), |_, _| false), (0, 0));
    }

    #[test]
    fn cut_off_streets_and_rings_are_none() {
        assert_eq!(yards(is_in([60, 60], [160, 72]), |_, _| false), (0, 0), "a stretch of street");
        let ring = |x: usize, y: usize| is_in([50, 50], [150, 150])(x, y) && !is_in([60, 60], [140, 140])(x, y);
        assert_eq!(yards(ring, |_, _| false), (0, 0), "a street about a block");
        let letters = is_in([120, 70], [140, 90]);
        assert_eq!(yards(is_in([60, 60], [120, 100]), letters), (0, 0), "a label may hide the way to it");
        assert_eq!(yards(is_in([160, 60], [200, 100]), |_, _| false), (0, 0), "a way may lead to it beyond the border");
        assert_eq!(yards(is_in([60, 60], [70, 70]), |_, _| false), (0, 0), "25 m² are a speck");
    }

    #[test]
    fn other_parts_in_its_window_are_left_alone() {
        // A courtyard, a street that winds about it from the street at the top, and a stretch of street beside it.
        let light = |x: usize, y: usize| {
            is_in([60, 60], [100, 100])(x, y)
                || is_in([30, 10], [36, 110])(x, y)
                || is_in([30, 104], [110, 110])(x, y)
                || is_in([56, 20], [58, 100])(x, y)
        };
        assert_eq!(yards(light, |_, _| false), (1600, 1600));
    }
}
