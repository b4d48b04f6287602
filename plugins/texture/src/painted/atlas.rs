//! Pictures of level 3, taken apart: the wall without what repeats on it section by section, and all that repeats once.

use glam::DVec2;
use veduta_city::{PaintedFacade, PaintedObject, Rgb};

use super::Pixels;
use super::picture::PICTURE_SIDE;
use crate::mips::halve;

/// How much finer objects are kept than sections show them; less where they do not fit.
const FINER: f64 = 1.4;
/// Texels about an object that are kept with it in the atlas, so that nothing of its neighbours bleeds into it.
pub(super) const MARGIN: usize = 2;
/// The grid that objects lie on, which is that of the codec's blocks.
const BLOCK: usize = 8;

/// Where an object lies in the atlas, texels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Left upper corner, margin apart.
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// Whether an object lies in the atlas: the wall keeps what is there once.
pub(super) fn repeats(object: &PaintedObject) -> bool {
    object.columns > 1 || object.rows > 1
}

/// Where each object that repeats lies: on shelves, the highest first, as finely as they fit. The same for the same objects.
pub(super) fn layout(painted: &PaintedFacade) -> Vec<Place> {
    // Texels a step of the grid.
    let mut scale = DVec2::new(f64::from(painted.sections) / f64::from(painted.size.0), 1.0 / f64::from(painted.size.1));
    scale *= PICTURE_SIDE as f64 * FINER;
    loop {
        if let Some(places) = shelves(&painted.objects, scale) {
            return places;
        }
        scale *= 0.9;
    }
}

fn shelves(objects: &[PaintedObject], scale: DVec2) -> Option<Vec<Place>> {
    let size = |object: &PaintedObject| {
        let size = DVec2::new(object.size.0.into(), object.size.1.into()) * scale;
        ((size.x.ceil() as usize).max(1), (size.y.ceil() as usize).max(1))
    };
    let cell = |texels: usize| (texels + 2 * MARGIN).next_multiple_of(BLOCK);
    let mut order: Vec<usize> = (0..objects.len()).filter(|&n| repeats(&objects[n])).collect();
    order.sort_by_key(|&n| (core::cmp::Reverse(size(&objects[n]).1), n));
    let mut places = vec![Place { x: 0, y: 0, width: 1, height: 1 }; objects.len()];
    let (mut x, mut y, mut shelf) = (0, 0, 0);
    for n in order {
        let (width, height) = size(&objects[n]);
        if x + cell(width) > PICTURE_SIDE {
            (x, y, shelf) = (0, y + shelf, 0);
        }
        if x + cell(width) > PICTURE_SIDE || y + cell(height) > PICTURE_SIDE {
            return None;
        }
        places[n] = Place { x: x + MARGIN, y: y + MARGIN, width, height };
        x += cell(width);
        shelf = shelf.max(cell(height));
    }
    Some(places)
}

/// Which object a texel of a section shows at its middle, and where in it: 0 to 1 from its left and from its top.
pub(super) struct Shown {
    /// Of each texel of each section, row by row; none where the wall is.
    pub(super) of: Vec<Vec<Option<(u8, DVec2)>>>,
    /// Width and height of a texel as a share of each object.
    pub(super) texels: Vec<DVec2>,
}

/// Finds some of the objects in sections of so many texels a side; others hide what they lie on, as the wall does.
pub(super) fn shown(painted: &PaintedFacade, side: usize, is_shown: impl Fn(&PaintedObject) -> bool) -> Shown {
    let texel = DVec2::new(f64::from(painted.size.0) / f64::from(painted.sections), f64::from(painted.size.1)) / side as f64;
    let mut of = vec![vec![None; side * side]; painted.sections.into()];
    let mut texels = Vec::with_capacity(painted.objects.len());
    for (n, object) in (0_u8..).zip(&painted.objects) {
        let size = DVec2::new(object.size.0.into(), object.size.1.into());
        texels.push(texel / size);
        for (low_x, low_y) in object.places() {
            // In texels of the whole row of sections, y from the top.
            let (left, top) = (f64::from(low_x) / texel.x, (f64::from(painted.size.1 - low_y) - size.y) / texel.y);
            let (right, bottom) = (left + size.x / texel.x, top + size.y / texel.y);
            let range = |from: f64, to: f64, end: usize| (from + 0.5).floor() as usize..((to + 0.5).floor() as usize).min(end);
            for y in range(top, bottom, side) {
                for x in range(left, right, side * of.len()) {
                    let at = DVec2::new((x as f64 + 0.5 - left) / (right - left), (y as f64 + 0.5 - top) / (bottom - top));
                    of[x / side][y * side + x % side] = is_shown(object).then_some((n, at));
                }
            }
        }
    }
    Shown { of, texels }
}

/// The pictures of a façade's sections as level 3 shows them, of those that it is kept as: the wall of each section, then, if it has objects,
/// the atlas. `None` if they are others, or the façade cannot be drawn.
#[must_use]
pub fn compose(painted: &PaintedFacade, pictures: &[Pixels]) -> Option<Vec<Pixels>> {
    painted.check().ok()?;
    let is_whole = |pixels: &Pixels| pixels.width == PICTURE_SIDE && pixels.height() == PICTURE_SIDE;
    if pictures.len() != painted.pictures() || !pictures.iter().all(is_whole) {
        return None;
    }
    let mut sections = pictures[..painted.sections.into()].to_vec();
    let Some(atlas) = pictures.get(sections.len()) else { return Some(sections) };
    let (places, shown) = (layout(painted), shown(painted, PICTURE_SIDE, repeats));
    let linear: Vec<[f32; 3]> = atlas.texels.iter().map(|texel| texel.to_linear()).collect();
    for (section, of) in sections.iter_mut().zip(&shown.of) {
        for (texel, shown_here) in section.texels.iter_mut().zip(of) {
            let Some((n, at)) = shown_here else { continue };
            let (place, step) = (&places[usize::from(*n)], shown.texels[usize::from(*n)]);
            let mut mean = [0.0; 3];
            footprint(place, *at, step, |i, share| (0..3).for_each(|c| mean[c] += share * linear[i][c]));
            *texel = Rgb::from_linear(mean);
        }
    }
    Some(sections)
}

/// Which texels of the atlas any section shows anything of.
pub(super) fn used(places: &[Place], shown: &Shown) -> Vec<bool> {
    let mut used = vec![false; PICTURE_SIDE * PICTURE_SIDE];
    for &(n, at) in shown.of.iter().flatten().flatten() {
        footprint(&places[usize::from(n)], at, shown.texels[usize::from(n)], |i, _| used[i] = true);
    }
    used
}

/// Brings the atlas nearer to what sections are to show, on the mean of all places where an object is repeated: texels of sections blur those of
/// the atlas, so these become a little sharper than the picture.
pub(super) fn sharpen(atlas: &mut Pixels, places: &[Place], shown: &Shown, wanted: &[Pixels]) {
    let mut linear: Vec<[f32; 3]> = atlas.texels.iter().map(|texel| texel.to_linear()).collect();
    let mut missing = vec![([0.0_f32; 3], 0.0_f32); linear.len()];
    for (texel, shown_here) in wanted.iter().zip(&shown.of).flat_map(|(wanted, of)| wanted.texels.iter().zip(of)) {
        let Some((n, at)) = shown_here else { continue };
        let (place, step) = (&places[usize::from(*n)], shown.texels[usize::from(*n)]);
        let mut rest = texel.to_linear();
        footprint(place, *at, step, |i, share| (0..3).for_each(|c| rest[c] -= share * linear[i][c]));
        footprint(place, *at, step, |i, share| {
            (0..3).for_each(|c| missing[i].0[c] += share * rest[c]);
            missing[i].1 += share;
        });
    }
    for (i, (rest, share)) in missing.into_iter().enumerate().filter(|(_, (_, share))| *share > 0.0) {
        (0..3).for_each(|c| linear[i][c] = (linear[i][c] + rest[c] / share).clamp(0.0, 1.0));
        atlas.texels[i] = Rgb::from_linear(linear[i]);
    }
}

/// What a texel of so many shares of the object covers in the atlas, about a place: texels and their shares of it. Where objects are kept more
/// finely than they are shown, as where they are not.
fn footprint(place: &Place, at: DVec2, texel: DVec2, mut of: impl FnMut(usize, f32)) {
    let size = DVec2::new(place.width as f64, place.height as f64);
    let corner = DVec2::new(place.x as f64, place.y as f64);
    // At least as broad as a texel of the atlas: then it is the mean of those beside it, as between texels.
    let half = (texel * size / 2.0).max(DVec2::splat(0.5));
    let middle = (corner + at * size).clamp(half, DVec2::splat(PICTURE_SIDE as f64) - half);
    let (low, high) = (middle - half, middle + half);
    let area = (4.0 * half.x * half.y) as f32;
    let last = |end: f64| (end.ceil() as usize).min(PICTURE_SIDE);
    for y in low.y as usize..last(high.y) {
        let rows = (high.y.min(y as f64 + 1.0) - low.y.max(y as f64)) as f32;
        for x in low.x as usize..last(high.x) {
            let share = rows * (high.x.min(x as f64 + 1.0) - low.x.max(x as f64)) as f32;
            of(y * PICTURE_SIDE + x, share / area);
        }
    }
}

/// Fills texels that are free to be anything smoothly from the others, so that they cost nothing. `is_vague`: those that are not free, but tell
/// nothing either.
pub(super) fn fill(picture: &mut Pixels, is_free: &[bool], is_vague: impl Fn(usize) -> bool, rest: Rgb) {
    /// Rounds in which steps between what was filled are smoothed out.
    const ROUNDS: usize = 12;
    let side = picture.width;
    let unknown: Vec<usize> = (0..picture.texels.len()).filter(|&i| is_free[i] || is_vague(i)).collect();
    let mut is_known = vec![true; picture.texels.len()];
    unknown.iter().for_each(|&i| is_known[i] = false);
    // Means of what is known, over ever larger squares, until one knows something: colours and how many they are of.
    let told = picture
        .texels
        .iter()
        .zip(is_known)
        .map(|(texel, is_known)| if is_known { (texel.to_linear(), 1.0) } else { ([0.0; 3], 0.0) });
    let mut squares: Vec<Vec<([f32; 3], f32)>> = vec![told.collect()];
    while let Some(last) = squares.last().filter(|last| last.len() > 1) {
        let sum = |four: [([f32; 3], f32); 4]| {
            let share: f32 = four.iter().map(|(_, share)| share).sum();
            (core::array::from_fn(|c| four.iter().map(|(colour, share)| colour[c] * share).sum::<f32>() / share.max(1.0)), share)
        };
        squares.push(halve(last.len().isqrt(), last, sum));
    }
    let mut linear = vec![rest.to_linear()];
    for finer in squares.iter().rev() {
        let side = finer.len().isqrt();
        let coarser = linear.len().isqrt();
        let step = side / coarser;
        linear = finer
            .iter()
            .enumerate()
            .map(|(i, &(colour, share))| if share > 0.0 { colour } else { linear[i / side / step * coarser + i % side / step] })
            .collect();
    }
    for _ in 0..ROUNDS {
        for &i in &unknown {
            let four = beside(i, side);
            linear[i] = core::array::from_fn(|c| four.iter().map(|&j| linear[j][c]).sum::<f32>() * 0.25);
        }
    }
    for i in unknown.into_iter().filter(|&i| is_free[i]) {
        picture.texels[i] = Rgb::from_linear(linear[i]);
    }
}

/// The four texels beside one in a square of so many a side; itself beyond its edges.
pub(super) fn beside(i: usize, side: usize) -> [usize; 4] {
    let (x, y) = (i % side, i / side);
    [i - usize::from(x > 0), i + usize::from(x + 1 < side), i - side * usize::from(y > 0), i + side * usize::from(y + 1 < side)]
}
