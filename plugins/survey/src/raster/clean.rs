//! Streets, rails and water free of labels and noise.

use core::cell::OnceCell;

use super::bitmap::Bitmap;
use super::classify::Classes;
use super::filter::{crowded, dilated, dilated_twice, filled, filled_among, median5};
use super::morphology::Sweep::{Grow, Shrink};
use super::morphology::{grown, swept, swept_at};
use super::outline::{Corners, outlines};
use super::parts::{Part, Parts};
use super::sight::seen_as_street;

/// Pixels that a cleaned picture is continued by on every side, so that streets do not end at its border.
pub(crate) const MARGIN: usize = 64;
/// Islands of street, and of what is no street, smaller than this are noise; square metres.
pub(crate) const SPECK_M2: f64 = 60.0;
/// A street is seen to go on under a railway so wide, metres.
const VIADUCT_M: f64 = 11.0;
/// Letters of a word are closer together than four times this, pixels.
const WORD_GAP: usize = 2;
/// A quarter of the height of a name's letters that is wider than a street it might hide, pixels.
const LARGE: usize = 4;
/// What is so much wider than that, in twos of pixels, is letters side by side, what is not is a symbol.
const SYMBOL: i32 = 10;

/// Whether so few pixels are set that they are noise: one in 2,000.
pub(crate) fn is_rare(class: &Bitmap) -> bool {
    class.count() * 2000 < class.width() * class.height()
}

/// The streets free of labels and noise, and what a label may hide, both with a margin; and the streets' connected parts, the
/// specks that were taken out among them.
pub(crate) fn cleaned(classes: &Classes, mpp: f64) -> (Bitmap, Bitmap, Vec<Part>) {
    let mut street = classes.street.clone();
    let mut hidden = Bitmap::new(street.width(), street.height());
    let [has_ink, has_rails] = [&classes.ink, &classes.railway].map(|class| !is_rare(class));
    let rails = ((has_ink || has_rails) && !classes.railway.is_blank()).then(|| median5(&classes.railway));
    if has_ink {
        let mut ink = crowded(&classes.ink);
        ink.keep(&classes.ink);
        if let Some(rails) = &rails {
            ink.remove(&dilated_twice(rails));
        }
        let mut ink = dilated_twice(&ink);
        // Between a letter and the street it stands on, its soft edge looks like a block.
        let seen = median5(&street.without(&ink));
        let mut edges = grown(&ink, 2);
        edges.keep(&grown(&seen, 2));
        edges.add(&swept(&ink, &[Grow(3), Shrink(3)]));
        edges.remove(&seen);
        ink.add(&edges);
        street.remove(&ink);
        let steady = crowded(&street);
        street.keep(&steady);
        let under = seen_as_street(&street, &names(&ink));
        street.add(&under);
        street = filled(&street, &ink.without(&under));
        hidden = ink;
    }
    if let Some(rails) = rails.filter(|_| has_rails) {
        // Streets go on under viaducts.
        let reach = (VIADUCT_M / 2.0 / mpp) as usize + 1;
        let rails = grown(&rails, 3);
        street.add(&swept_at(&rails, &street, &[Grow(reach), Shrink(reach)]));
        hidden.add(&rails);
    }
    let mut street = median5(&street.with_margin(MARGIN));
    let least = (SPECK_M2 / (mpp * mpp)) as i64;
    // Islands first, then what is left open in streets.
    let islands = Parts::of(&street, Corners::Join);
    for run in islands.smaller_than(least) {
        street.set_between(run.y as usize, run.from as usize, run.to as usize, false);
    }
    for run in Parts::of(&street.inverted(), Corners::Part).smaller_than(least) {
        street.set_between(run.y as usize, run.from as usize, run.to as usize, true);
    }
    (street, hidden.with_margin(MARGIN), islands.parts)
}

/// The parts of what is inked that may hide a street: not the letters of a large, spaced name, which lies where it will.
fn names(ink: &Bitmap) -> Bitmap {
    // At half the resolution: letters that large show there.
    let mut large = swept(&ink.halved(), &[Grow(WORD_GAP), Shrink(WORD_GAP), Shrink(LARGE)]);
    for outline in outlines(&large, Corners::Join).iter().filter(|o| !o.is_hole()) {
        let (low, high) = outline.extent();
        if (high - low).max_element() < SYMBOL {
            outline.paint(&mut large, false);
        }
    }
    let large = grown(&large, LARGE + 1).doubled(ink.width(), ink.height());
    ink.without(&large)
}

/// What labels and symbols hide, with their soft edges; found when it is first asked for.
pub(crate) struct Labels<'a> {
    ink: &'a Bitmap,
    hidden: OnceCell<(Bitmap, Parts)>,
}

impl<'a> Labels<'a> {
    /// Of what is inked.
    pub fn of(ink: &'a Bitmap) -> Self {
        Self { ink, hidden: OnceCell::new() }
    }

    /// What there is of a class, under labels too.
    pub fn seen_through(&self, class: &Bitmap) -> Bitmap {
        let (hidden, parts) = self.hidden.get_or_init(|| {
            let hidden = dilated(&crowded(self.ink));
            let parts = Parts::of(&hidden, Corners::Join);
            (hidden, parts)
        });
        filled_among(class, hidden, parts)
    }

    /// The same, free of noise.
    pub fn cleaned(&self, class: &Bitmap) -> Bitmap {
        median5(&self.seen_through(class))
    }
}
