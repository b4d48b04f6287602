//! From a picture to colour, small textures, and the pictures of sections.

use glam::DVec2;
use veduta_city::{FacadeDraft, FacadeObject, GridPolygon, GridPos, PaintedFacade, PaintedObject, Rgb, SmallTexture};

use super::Pixels;
use super::atlas::{MARGIN, Place, Shown, beside, fill, layout, repeats, sharpen, shown, used};
use super::picture::PICTURE_SIDE;
use super::quantise::{Quantised, quantise};

/// Longest that a section is, metres: its texels are 3.5 cm wide then.
const SECTION_M: f64 = 18.0;
/// Texels of a small texture in a metre.
const SMALL_PER_M: f64 = 9.0;
/// Small textures have no more colours than bring them so near to the picture, as [`quantise`] measures.
const NEAR: f32 = 900.0;
/// Share of a wall between its objects that tells its colour.
const LEAST_FREE: f64 = 0.3;
/// Points along and up at which the wall's colour is looked at.
const PROBES: usize = 200;

/// Why a façade could not be cut.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CutError {
    /// The description has mistakes.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Draft(Vec<veduta_city::FacadeError>),
    /// No part of the outline is free of objects.
    #[error("the objects cover the whole wall: there is nothing to tell its colour")]
    Covered,
    /// Its objects cut it into too many pieces.
    #[error("{0}")]
    Busy(String),
}

/// A façade, cut out of its picture.
#[derive(Debug, Clone, PartialEq)]
pub struct CutFacade {
    /// Its colour for level 1, small textures and their places for level 2.
    pub painted: PaintedFacade,
    /// What [`compose`](super::compose) makes level 3 of, all [`PICTURE_SIDE`] squared: they are still to be stored.
    pub pictures: Vec<Pixels>,
}

/// Cuts a façade out of its picture.
///
/// # Errors
/// If the draft has mistakes, or the picture cannot be cut by it.
pub fn cut_facade(draft: &FacadeDraft, picture: &Pixels) -> Result<CutFacade, CutError> {
    let errors = draft.validate();
    if !errors.is_empty() {
        return Err(CutError::Draft(errors));
    }
    let sections = (draft.size_m.x / SECTION_M).ceil().clamp(1.0, f64::from(PaintedFacade::MOST_SECTIONS)) as u8;
    let scene = Scene { draft, picture, linear: picture.texels.iter().map(|texel| texel.to_linear()).collect() };
    let colour = scene.wall_colour().ok_or(CutError::Covered)?;
    let textures = (0..draft.objects.len()).map(|n| scene.small(n)).collect();
    let size = steps(draft.size_m);
    let objects = (0_u8..).zip(&draft.objects).map(|(texture, object)| painted(object, texture, size)).collect();
    let painted = PaintedFacade { size, sections, colour, textures, objects };
    painted.check().map_err(CutError::Busy)?;
    let shown = shown(&painted, PICTURE_SIDE, repeats);
    let width = draft.size_m.x / f64::from(sections);
    let section = |n: usize| {
        let (low, high) = (DVec2::new(width * n as f64, 0.0), DVec2::new(width * (n + 1) as f64, draft.size_m.y));
        scene.resample((low, high), (PICTURE_SIDE, PICTURE_SIDE))
    };
    let whole: Vec<Pixels> = (0..shown.of.len()).map(section).collect();
    let mut pictures = whole.clone();
    for (wall, of) in pictures.iter_mut().zip(&shown.of) {
        let is_covered: Vec<bool> = of.iter().map(Option::is_some).collect();
        // A texel beside an object may have a part of it.
        fill(wall, &is_covered, |i| beside(i, PICTURE_SIDE).iter().any(|&j| is_covered[j]), colour);
    }
    if !painted.objects.is_empty() {
        pictures.push(scene.atlas(&painted, &shown, &whole));
    }
    Ok(CutFacade { painted, pictures })
}

fn steps(length_m: DVec2) -> (i32, i32) {
    (GridPos::steps(length_m.x), GridPos::steps(length_m.y))
}

/// An object on the grid. What a person measured a little out of the picture lies within it.
fn painted(object: &FacadeObject, texture: u8, whole: (i32, i32)) -> PaintedObject {
    let (columns, rows) = (object.repeat.columns, object.repeat.rows);
    let (low, size, step) = (steps(object.low), steps(object.size), steps(object.repeat.step));
    // Least and greatest place of the first such that the last lies within, too.
    let place = |low: i32, size: i32, step: i32, count: u8, whole: i32| {
        let reach = step * i32::from(count.saturating_sub(1));
        low.min(whole - size - reach.max(0)).max(-reach.min(0)).max(0)
    };
    let size = (size.0.min(whole.0), size.1.min(whole.1));
    PaintedObject {
        kind: object.kind,
        texture,
        low: (place(low.0, size.0, step.0, columns, whole.0), place(low.1, size.1, step.1, rows, whole.1)),
        size,
        head: object.head,
        depth: GridPos::steps(object.depth_m.unwrap_or(object.kind.depth_m())),
        columns,
        rows,
        step,
    }
}

struct Scene<'a> {
    draft: &'a FacadeDraft,
    picture: &'a Pixels,
    linear: Vec<[f32; 3]>,
}

impl Scene<'_> {
    /// Mean of the wall between its objects, in linear light; of that between its openings if it is painted nearly all over.
    fn wall_colour(&self) -> Option<Rgb> {
        self.colour_beside(|_| true, LEAST_FREE).or_else(|| self.colour_beside(|object| !object.is_flat(), 0.0))
    }

    /// Mean of the wall beside some of its objects; `None` if they leave no more than a share of it.
    fn colour_beside(&self, is_counted: impl Fn(&FacadeObject) -> bool, share: f64) -> Option<Rgb> {
        let objects = self.draft.objects.iter().filter(|object| is_counted(object));
        let places: Vec<(DVec2, DVec2)> = objects.flat_map(|object| object.places().map(|low| (low, low + object.size))).collect();
        let is_free = |p: DVec2| !places.iter().any(|(low, high)| p.cmpge(*low).all() && p.cmple(*high).all());
        let ring: Vec<GridPos> = self.draft.outline.iter().map(|&p| GridPos::from_metres(p)).collect();
        let outline = (!ring.is_empty()).then(|| GridPolygon::simple(ring));
        let is_wall = |p: DVec2| outline.as_ref().is_none_or(|outline| outline.contains(GridPos::from_metres(p)));
        let (mut sum, mut count, mut all) = ([0.0_f64; 3], 0.0, 0.0);
        for n in 0..PROBES * PROBES {
            let p = self.draft.size_m * (DVec2::new((n % PROBES) as f64, (n / PROBES) as f64) + 0.5) / PROBES as f64;
            if !is_wall(p) {
                continue;
            }
            all += 1.0;
            if is_free(p) {
                let [x, y] = self.pixel(p).map(|at| at as usize);
                let texel = self.linear[y.min(self.picture.height() - 1) * self.picture.width + x.min(self.picture.width - 1)];
                (0..3).for_each(|c| sum[c] += f64::from(texel[c]));
                count += 1.0;
            }
        }
        (count > all * share).then(|| Rgb::from_linear(sum.map(|c| (c / count) as f32)))
    }

    /// Where a place of the wall lies in the picture: columns from the left, rows from the top.
    fn pixel(&self, p: DVec2) -> [f64; 2] {
        let DVec2 { x, y } = p / self.draft.size_m;
        [x * self.picture.width as f64, (1.0 - y) * self.picture.height() as f64]
    }

    /// The first of an object, in few colours.
    fn small(&self, n: usize) -> SmallTexture {
        let object = &self.draft.objects[n];
        let side = |m: f64| ((m * SMALL_PER_M).round() as usize).clamp(4, PaintedFacade::MOST_TEXELS);
        let (width, height) = (side(object.size.x), side(object.size.y));
        let (mut pixels, is_seen) = self.part(n, DVec2::ZERO, (width, height));
        // What is never seen goes on with the row: what repeats costs least.
        let first = is_seen.iter().position(|&is_seen| is_seen).unwrap_or_default();
        let mut last = pixels.texels[first];
        for (texel, is_seen) in pixels.texels.iter_mut().zip(is_seen) {
            if is_seen { last = *texel } else { *texel = last }
        }
        let few = [4, 6, 8, 12].into_iter().map(|most| quantise(&pixels.texels, most)).find(|quantised| quantised.error <= NEAR);
        let Quantised { palette, texels, .. } = few.unwrap_or_else(|| quantise(&pixels.texels, PaintedFacade::MOST_COLOURS));
        SmallTexture { width: width as u8, palette, texels }
    }

    /// All objects that repeat, each once, with a little of what is about them, for sections that are to look so.
    fn atlas(&self, painted: &PaintedFacade, shown: &Shown, whole: &[Pixels]) -> Pixels {
        let mut atlas = Pixels { width: PICTURE_SIDE, texels: vec![painted.colour; PICTURE_SIDE * PICTURE_SIDE] };
        let places = layout(painted);
        for (n, &Place { x, y, width, height }) in places.iter().enumerate().filter(|&(n, _)| repeats(&painted.objects[n])) {
            let beyond = self.draft.objects[n].size / DVec2::new(width as f64, height as f64) * MARGIN as f64;
            let (width, height) = (width + 2 * MARGIN, height + 2 * MARGIN);
            let (part, _) = self.part(n, beyond, (width, height));
            for (row, texels) in part.texels.chunks_exact(width).enumerate() {
                let start = (y - MARGIN + row) * PICTURE_SIDE + x - MARGIN;
                atlas.texels[start..start + width].copy_from_slice(texels);
            }
        }
        sharpen(&mut atlas, &places, shown, whole);
        // What lies below another object wherever it is repeated is never seen.
        let is_free: Vec<bool> = used(&places, shown).into_iter().map(|is_used| !is_used).collect();
        fill(&mut atlas, &is_free, |_| false, painted.colour);
        atlas
    }

    /// An object and a little beyond it at so many texels, each of them from the first of its places where no later object covers it; and
    /// which are covered at none.
    fn part(&self, n: usize, beyond: DVec2, (width, height): (usize, usize)) -> (Pixels, Vec<bool>) {
        let object = &self.draft.objects[n];
        let covers: Vec<(DVec2, DVec2)> =
            self.draft.objects[n + 1..].iter().flat_map(|later| later.places().map(|low| (low, low + later.size))).collect();
        let texel = (object.size + beyond * 2.0) / DVec2::new(width as f64, height as f64);
        let mut is_seen = vec![false; width * height];
        let mut part: Option<Pixels> = None;
        for low in object.places().map(|low| low - beyond) {
            let near: Vec<_> = covers
                .iter()
                .filter(|cover| cover.0.cmplt(low + object.size + beyond * 2.0).all() && cover.1.cmpgt(low).all())
                .collect();
            let is_free = |i: usize| {
                let corner = low + texel * DVec2::new((i % width) as f64, (height - 1 - i / width) as f64);
                !near.iter().any(|(from, to)| from.cmplt(corner + texel).all() && to.cmpgt(corner).all())
            };
            let news: Vec<usize> = (0..is_seen.len()).filter(|&i| !is_seen[i] && is_free(i)).collect();
            if news.is_empty() && part.is_some() {
                continue;
            }
            let here = self.resample((low, low + object.size + beyond * 2.0), (width, height));
            let part = part.get_or_insert_with(|| here.clone());
            for i in news {
                (part.texels[i], is_seen[i]) = (here.texels[i], true);
            }
            if is_seen.iter().all(|&is_seen| is_seen) {
                break;
            }
        }
        let part = part.unwrap_or_else(|| Pixels { width, texels: vec![Rgb::default(); width * height] });
        (part, is_seen)
    }

    /// A rectangle of the wall at another number of texels: means over what each of them covers, in linear light.
    fn resample(&self, (low, high): (DVec2, DVec2), (width, height): (usize, usize)) -> Pixels {
        let [left, bottom] = self.pixel(low);
        let [right, top] = self.pixel(high);
        let columns = shares(left, right, width, self.picture.width);
        let rows = shares(top, bottom, height, self.picture.height());
        // Across first, then down: each source texel is touched once or twice.
        let first = rows.iter().flatten().map(|share| share.0).min().unwrap_or_default();
        let last = rows.iter().flatten().map(|share| share.0).max().unwrap_or_default();
        let across: Vec<Vec<[f32; 3]>> = (first..=last)
            .map(|row| {
                let row = &self.linear[row * self.picture.width..][..self.picture.width];
                columns.iter().map(|shares| weighted(shares, |column| row[column])).collect()
            })
            .collect();
        let texel = |row: usize, column: usize| Rgb::from_linear(weighted(&rows[row], |source| across[source - first][column]));
        let texels = (0..height).flat_map(|row| (0..width).map(move |column| (row, column)));
        Pixels { width, texels: texels.map(|(row, column)| texel(row, column)).collect() }
    }
}

fn weighted(shares: &[(usize, f32)], of: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for &(source, share) in shares {
        let texel = of(source);
        (0..3).for_each(|c| sum[c] += share * texel[c]);
    }
    sum
}

/// For each of `count` equal parts from `from` to `to`, which of `all` source texels it covers and by which share of itself.
fn shares(from: f64, to: f64, count: usize, all: usize) -> Vec<Vec<(usize, f32)>> {
    let step = (to - from) / count as f64;
    let part = |n: usize| {
        let (a, b) = (from + step * n as f64, from + step * (n + 1) as f64);
        let last = all - 1;
        let (first, end) = ((a.max(0.0) as usize).min(last), (b.ceil().max(1.0) as usize - 1).min(last));
        let cover = |source: usize| {
            let (low, high) = (
                if source == 0 { f64::NEG_INFINITY } else { source as f64 },
                if source == last { f64::INFINITY } else { source as f64 + 1.0 },
            );
            ((b.min(high) - a.max(low)) / step).clamp(0.0, 1.0) as f32
        };
        let mut covered: Vec<(usize, f32)> = (first..=end.max(first)).map(|source| (source, cover(source))).collect();
        let total: f32 = covered.iter().map(|share| share.1).sum();
        covered.iter_mut().for_each(|share| share.1 /= total.max(1e-6));
        covered
    };
    (0..count).map(part).collect()
}
