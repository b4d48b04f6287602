//! Pictures of level 3, taken apart: the wall without what repeats on it section by section, and all that repeats once.

use core::ops::Range;

use glam::{DVec2, Vec3A};
use veduta_city::{PaintedFacade, PaintedObject, Rgb};

use super::Pixels;
use super::picture::PICTURE_SIDE;
use crate::mips::{Light, halve};

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
    let mut of = vec![vec![None; side * side]; painted.sections.into()];
    for stamp in stamps(painted, side) {
        let is_shown = is_shown(&painted.objects[usize::from(stamp.object)]);
        for y in stamp.rows(side) {
            for x in stamp.columns(side * of.len()) {
                of[x / side][y * side + x % side] = is_shown.then(|| (stamp.object, stamp.share(x, y)));
            }
        }
    }
    let texel = texel_size(painted, side);
    let texels = painted.objects.iter().map(|object| texel / DVec2::new(object.size.0.into(), object.size.1.into())).collect();
    Shown { of, texels }
}

/// Size of a texel of sections of so many a side, in steps of the façade's grid.
fn texel_size(painted: &PaintedFacade, side: usize) -> DVec2 {
    DVec2::new(f64::from(painted.size.0) / f64::from(painted.sections), f64::from(painted.size.1)) / side as f64
}

/// An object in one of its places, in texels of the whole row of sections, y from the top.
struct Stamp {
    object: u8,
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

/// All objects in all their places, each before what lies on it.
fn stamps(painted: &PaintedFacade, side: usize) -> impl Iterator<Item = Stamp> {
    let texel = texel_size(painted, side);
    (0_u8..).zip(&painted.objects).flat_map(move |(n, object)| {
        let size = DVec2::new(object.size.0.into(), object.size.1.into());
        object.places().map(move |(low_x, low_y)| {
            let (left, top) = (f64::from(low_x) / texel.x, (f64::from(painted.size.1 - low_y) - size.y) / texel.y);
            Stamp { object: n, left, top, right: left + size.x / texel.x, bottom: top + size.y / texel.y }
        })
    })
}

impl Stamp {
    /// Texels whose middles it covers, of so many.
    fn columns(&self, end: usize) -> Range<usize> {
        covered(self.left, self.right, end)
    }

    fn rows(&self, end: usize) -> Range<usize> {
        covered(self.top, self.bottom, end)
    }

    /// Where the middle of a texel lies in it.
    fn share(&self, x: usize, y: usize) -> DVec2 {
        let within = |at: usize, from: f64, to: f64| (at as f64 + 0.5 - from) / (to - from);
        DVec2::new(within(x, self.left, self.right), within(y, self.top, self.bottom))
    }
}

fn covered(from: f64, to: f64, end: usize) -> Range<usize> {
    (from + 0.5).floor() as usize..((to + 0.5).floor() as usize).min(end)
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
    let (walls, atlas) = pictures.split_at(painted.sections.into());
    let mut sections = walls.to_vec();
    let Some(atlas) = atlas.first() else { return Some(sections) };
    let (places, mut painter) = (layout(painted), Painter::default());
    // What lies before others is painted first, and these where it leaves them to be seen.
    let end = PICTURE_SIDE * walls.len();
    let mut is_free = vec![true; PICTURE_SIDE * end];
    let stamps: Vec<Stamp> = stamps(painted, PICTURE_SIDE).collect();
    for stamps in stamps.chunk_by(|a, b| a.object == b.object).rev() {
        let object = stamps.first().map_or(0, |stamp| usize::from(stamp.object));
        if repeats(&painted.objects[object]) {
            painter.paint(&mut sections, &mut is_free, stamps, (&places[object], atlas));
            continue;
        }
        // The wall shows it.
        for stamp in stamps {
            let columns = stamp.columns(end);
            stamp.rows(PICTURE_SIDE).for_each(|y| is_free[y * end..][columns.clone()].fill(false));
        }
    }
    Some(sections)
}

/// Paints objects of the atlas on sections, first along their columns, then along their rows.
#[derive(Default)]
struct Painter {
    /// The part of the atlas that is shown of an object anywhere, in linear light.
    linear: Vec<Vec3A>,
    /// Part of a row of what is shown, as wide as it is in the atlas.
    line: Vec<Vec3A>,
}

impl Painter {
    /// Paints an object of the atlas in some places, where these are free yet.
    fn paint(&mut self, sections: &mut [Pixels], is_free: &mut [bool], stamps: &[Stamp], (place, atlas): (&Place, &Pixels)) {
        let (light, end) = (Light::tables(), PICTURE_SIDE * sections.len());
        let placed = |stamp: &Stamp| {
            let (columns, rows) = (stamp.columns(end), stamp.rows(PICTURE_SIDE));
            // What is smaller than a texel may be shown nowhere.
            (!columns.is_empty() && !rows.is_empty()).then(|| {
                let across = Taps::new(columns.clone(), stamp.left, stamp.right, (place.x, place.width));
                let down = Taps::new(rows.clone(), stamp.top, stamp.bottom, (place.y, place.height));
                (columns, rows, across, down)
            })
        };
        let placed: Vec<_> = stamps.iter().filter_map(placed).collect();
        let (left, right) = Taps::bounds(placed.iter().map(|(_, _, across, _)| across));
        let (top, bottom) = Taps::bounds(placed.iter().map(|(.., down)| down));
        self.linear.clear();
        for row in atlas.texels.chunks_exact(PICTURE_SIDE).take(bottom).skip(top) {
            self.linear.extend(row[left..right].iter().map(|&texel| light.linear_of(texel)));
        }
        for (columns, rows, across, down) in placed.into_iter().rev() {
            for (y, (from, shares)) in rows.zip(down.each()) {
                let is_free = &mut is_free[y * end..][columns.clone()];
                let mut begin = 0;
                for span in is_free.chunk_by(|a, b| a == b) {
                    let part = begin..begin + span.len();
                    begin = part.end;
                    if !span[0] {
                        continue;
                    }
                    let seen = across.reach(&part);
                    self.line.clear();
                    self.line.resize(seen.len(), Vec3A::ZERO);
                    for (line, &share) in self.linear.chunks_exact(right - left).skip(from - top).zip(shares) {
                        let line = &line[seen.start - left..seen.end - left];
                        self.line.iter_mut().zip(line).for_each(|(mean, &colour)| *mean += colour * share);
                    }
                    for (x, (from, shares)) in (columns.start + part.start..).zip(across.each().skip(part.start).take(part.len())) {
                        let texel = &mut sections[x / PICTURE_SIDE].texels[y * PICTURE_SIDE + x % PICTURE_SIDE];
                        *texel = light.srgb_of(mixed(&self.line[from - seen.start..], shares));
                    }
                }
                is_free.fill(false);
            }
        }
    }
}

/// The sum of some colours, each times its share.
fn mixed(colours: &[Vec3A], shares: &[f32]) -> Vec3A {
    match (colours, shares) {
        // As many as almost all have.
        (&[a, b, c, ..], &[of_a, of_b, of_c]) => a * of_a + b * of_b + c * of_c,
        _ => colours.iter().zip(shares).map(|(&colour, &share)| colour * share).sum(),
    }
}

/// What texels of a section show of an object in the atlas along one axis: texels there, and their shares.
struct Taps {
    /// Of each texel, the first one.
    firsts: Vec<usize>,
    /// Of each, equally many.
    shares: Vec<f32>,
    /// So many.
    count: usize,
}

impl Taps {
    /// Of some texels of sections, of an object that reaches from one place to another, and lies in the atlas from a texel on, so many long.
    fn new(texels: Range<usize>, from: f64, to: f64, (corner, length): (usize, usize)) -> Self {
        let (step, length) = (1.0 / (to - from), length as f64);
        // However it lies to the texels.
        let count = (((step * length).max(1.0) + 1.0).ceil() as usize).min(PICTURE_SIDE);
        let mut taps = Self { firsts: Vec::with_capacity(texels.len()), shares: Vec::with_capacity(count * texels.len()), count };
        for texel in texels {
            let (low, high) = reach(corner as f64, length, (texel as f64 + 0.5 - from) * step, step);
            let (first, whole) = ((low as usize).min(PICTURE_SIDE - count), 1.0 / (high - low));
            taps.firsts.push(first);
            taps.shares.extend((first..first + count).map(|n| (overlap(n, low, high) * whole).max(0.0) as f32));
        }
        taps
    }

    /// Of each texel the first one, and the shares from there on.
    fn each(&self) -> impl Iterator<Item = (usize, &[f32])> {
        self.firsts.iter().copied().zip(self.shares.chunks_exact(self.count))
    }

    /// Texels of the atlas that some following ones show.
    fn reach(&self, of: &Range<usize>) -> Range<usize> {
        self.firsts[of.start]..self.firsts[of.end - 1] + self.count
    }

    /// The first texel of all, and the one after the last.
    fn bounds<'a>(taps: impl Iterator<Item = &'a Self>) -> (usize, usize) {
        let ends = taps.map(|taps| taps.reach(&(0..taps.firsts.len())));
        ends.fold((PICTURE_SIDE, 0), |(from, to), reach| (from.min(reach.start), to.max(reach.end)))
    }
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
    let (left, right) = reach(place.x as f64, place.width as f64, at.x, texel.x);
    let (top, bottom) = reach(place.y as f64, place.height as f64, at.y, texel.y);
    let area = (right - left) * (bottom - top);
    for y in top as usize..last(bottom) {
        let rows = overlap(y, top, bottom);
        for x in left as usize..last(right) {
            of(y * PICTURE_SIDE + x, (rows * overlap(x, left, right) / area) as f32);
        }
    }
}

/// Along one axis of the atlas, from where to where a texel reaches that is a share of an object, about a place in the object.
fn reach(corner: f64, length: f64, at: f64, texel: f64) -> (f64, f64) {
    // At least as broad as a texel of the atlas: then it is the mean of those beside it, as between texels.
    let half = (texel * length / 2.0).max(0.5);
    let middle = (corner + at * length).clamp(half, PICTURE_SIDE as f64 - half);
    (middle - half, middle + half)
}

/// The texel of the atlas before which a reach ends.
fn last(end: f64) -> usize {
    (end.ceil() as usize).min(PICTURE_SIDE)
}

/// How much of a texel lies between two places.
fn overlap(texel: usize, low: f64, high: f64) -> f64 {
    high.min(texel as f64 + 1.0) - low.max(texel as f64)
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

#[cfg(test)]
mod tests {
    use veduta_city::draw::Draw;
    use veduta_city::{FacadeObjectKind, Id, ObjectHead, SmallTexture};

    use super::*;

    /// What is composed, texel by texel.
    fn plainly(painted: &PaintedFacade, pictures: &[Pixels]) -> Vec<Pixels> {
        let (walls, atlas) = pictures.split_at(painted.sections.into());
        let (places, shown) = (layout(painted), shown(painted, PICTURE_SIDE, repeats));
        let mut sections = walls.to_vec();
        for (texel, shown_here) in sections.iter_mut().zip(&shown.of).flat_map(|(section, of)| section.texels.iter_mut().zip(of)) {
            let Some((n, at)) = shown_here else { continue };
            let mut mean = Vec3A::ZERO;
            footprint(&places[usize::from(*n)], *at, shown.texels[usize::from(*n)], |i, share| {
                mean += share * Vec3A::from_array(atlas[0].texels[i].to_linear());
            });
            *texel = Rgb::from_linear(mean.into());
        }
        sections
    }

    #[test]
    fn facades_of_all_kinds_are_composed_as_texel_by_texel() {
        for seed in 0..6 {
            let draw = Draw::new(seed, Id(7), "facade");
            let below = |name: &str, n: u64, end: usize| draw.part(n).below(name, end) as i32;
            let sections = 1 + (seed % 3) as u8;
            let size = (200_000, 60_000);
            // From less than a texel to a third of the wall, one over the other.
            let object = |n: u64| PaintedObject {
                kind: FacadeObjectKind::Painting,
                texture: 0,
                low: (below("x", n, 60_000), below("y", n, 12_000)),
                size: [("w", 40_000), ("h", 12_000)]
                    .map(|(name, most)| 100 + below(name, n, if n % 4 == 3 { 9 } else { most }))
                    .into(),
                head: ObjectHead::Flat,
                depth: 0,
                columns: 1 + u8::from(!n.is_multiple_of(3)),
                rows: 1 + u8::from(!n.is_multiple_of(3)),
                step: (below("dx", n, 90_000), below("dy", n, 30_000)),
            };
            let texture = SmallTexture { width: 1, palette: vec![Rgb(9, 9, 9)], texels: vec![0] };
            let painted = PaintedFacade {
                size,
                sections,
                objects: (0..12).map(object).collect(),
                textures: vec![texture],
                ..PaintedFacade::default()
            };
            assert_eq!(painted.check(), Ok(()));
            let noise = |n: u64| Pixels {
                width: PICTURE_SIDE,
                texels: (0..PICTURE_SIDE * PICTURE_SIDE)
                    .map(|i| {
                        let bits = (i as u64 + 1).wrapping_mul(n + 3).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
                        Rgb(bits as u8, (bits >> 8) as u8, (bits >> 16) as u8)
                    })
                    .collect(),
            };
            let pictures: Vec<Pixels> = (0..painted.pictures() as u64).map(noise).collect();
            let (ours, plain) = (compose(&painted, &pictures).expect("it can be drawn"), plainly(&painted, &pictures));
            let off = |a: Rgb, b: Rgb| a.0.abs_diff(b.0).max(a.1.abs_diff(b.1)).max(a.2.abs_diff(b.2));
            let texels = ours.iter().zip(&plain).flat_map(|(ours, plain)| ours.texels.iter().zip(&plain.texels));
            let most = texels.map(|(&a, &b)| off(a, b)).max();
            assert!(most <= Some(1), "{most:?} of 255 off, seed {seed}");
            assert!(ours.iter().zip(&pictures).any(|(section, wall)| section != wall), "something is painted");
        }
    }
}
