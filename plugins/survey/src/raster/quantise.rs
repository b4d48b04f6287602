//! The few colours that a map was printed in, found in the many that a file of it shows.
//!
//! Small windows spread evenly over the picture are sorted into even ones, whose mean goes into a histogram of 32³ colours,
//! and others, whose middle counts only where it is the lightest or darkest of them: the core of a thin stroke. Edges, which
//! show mixtures of two colours, are thus left out. Modes of the histogram, in Oklab (Ottosson 2020), are the map's colours.
//!
//! Rejected: k-means and Wu's quantiser, also of the `quantette` crate. They share out colours by area: a large paper in
//! uneven light takes several, a railway of half a per cent none; and edges pull every mean towards its neighbours.

use crate::raster::Picture;

/// A colour of a map's own, and how much of the map shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swatch {
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Share of the map's area, 0 to 1, edges and noise going to the nearest colour.
    pub share: f64,
}

/// Most colours that are looked for.
pub const MOST_SWATCHES: usize = 24;

/// Windows looked at, about.
const WINDOWS: usize = 1 << 18;
/// Colours of fewer windows are taken for noise; a share of all.
const LEAST_SHARE: f64 = 0.0012;
/// The same for colours that no mixture of others explains.
const LEAST_RARE: f64 = 0.00012;
/// Steps of a channel's histogram.
const STEPS: usize = 32;

/// The map's own most frequent colours, the commonest first: `colours` of them, or as many as stand out. There are fewer
/// where the map has fewer, and never more than [`MOST_SWATCHES`].
///
/// ```
/// use veduta_survey::raster::{Picture, swatches};
///
/// let mut map = Picture { width: 40, height: 30, pixels: [250, 245, 230].repeat(40 * 30) };
/// for y in 10..20 {
///     map.pixels[3 * 40 * y..3 * 40 * y + 3 * 20].copy_from_slice(&[120, 80, 60].repeat(20));
/// }
/// let found = swatches(&map, None);
/// assert_eq!(found.iter().map(|s| s.colour).collect::<Vec<_>>(), [[250, 245, 230], [120, 80, 60]]);
/// ```
#[must_use]
pub fn swatches(picture: &Picture, colours: Option<usize>) -> Vec<Swatch> {
    reduced(picture, colours).0
}

/// The colours, and whether the picture has a grain that should be smoothed before pixels are told apart.
pub(crate) fn reduced(picture: &Picture, colours: Option<usize>) -> (Vec<Swatch>, bool) {
    let sample = Sample::of(picture);
    let mut modes = modes(&sample.even, sample.reach, LEAST_SHARE * sample.windows as f64);
    let all: Vec<Bin> = sample.even.iter().chain(&sample.strokes).copied().collect();
    add_rare(&mut modes, &sample.even, &all, LEAST_RARE * sample.windows as f64);
    if let Some(most) = colours {
        while modes.len() > most.max(1) {
            drop_least(&mut modes, &all);
        }
    }
    (shared_out(&modes, picture), sample.is_grainy)
}

/// The number of the nearest colour, by perception, for every colour of 5 bits a channel: 32,768 entries, red highest.
/// `colours` must not be empty, and only the first 256 count.
#[must_use]
pub fn nearest_table(colours: &[[u8; 3]]) -> Vec<u8> {
    let labs: Vec<[f32; 3]> = colours.iter().take(256).map(|&c| oklab(c)).collect();
    let middle = |step: usize| (step * 8 + 4) as u8;
    let entry = |i: usize| nearest(oklab([middle(i >> 10), middle(i >> 5 & 31), middle(i & 31)]), &labs).0 as u8;
    (0..STEPS * STEPS * STEPS).map(entry).collect()
}

/// Entry of a colour in [`nearest_table`].
#[must_use]
pub fn table_index(colour: [u8; 3]) -> usize {
    let [r, g, b] = colour.map(|c| usize::from(c >> 3));
    r << 10 | g << 5 | b
}

/// A colour in Oklab: lightness, and green to red, blue to yellow.
#[must_use]
pub(crate) fn oklab(colour: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = veduta_city::Rgb(colour[0], colour[1], colour[2]).to_linear();
    let l = libm::cbrtf(0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b);
    let m = libm::cbrtf(0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b);
    let s = libm::cbrtf(0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b);
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Square of the distance between two colours.
pub(crate) fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

/// A colour as those are compared that lie on soft edges and thin strokes: hue and saturation count more than lightness, which
/// noise, uneven light and mixing change first.
pub(crate) fn stretched(lab: [f32; 3], by: f32) -> [f32; 3] {
    [lab[0], by * lab[1], by * lab[2]]
}

/// Number of the nearest colour and the square of its distance.
fn nearest(lab: [f32; 3], colours: &[[f32; 3]]) -> (usize, f32) {
    let lab = stretched(lab, 2.0);
    let each = colours.iter().enumerate().map(|(i, &c)| (i, apart(lab, stretched(c, 2.0))));
    each.fold((0, f32::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
}

/// Colours that fell into one step of the histogram.
#[derive(Debug, Clone, Copy)]
struct Bin {
    lab: [f32; 3],
    rgb: [f32; 3],
    weight: f32,
}

/// What the windows show.
struct Sample {
    even: Vec<Bin>,
    strokes: Vec<Bin>,
    windows: usize,
    /// Whether neighbours differ by noise: not where few colours alternate, as in a hatching drawn by a program.
    is_grainy: bool,
    /// How far the colours of one print lie apart, in Oklab.
    reach: f32,
}

impl Sample {
    fn of(picture: &Picture) -> Self {
        let (width, height) = (picture.width, picture.height);
        let step = ((width * height / WINDOWS) as f64).sqrt() as usize;
        let step = step.max(1);
        let columns: Vec<usize> = (0..width).step_by(step).collect();
        let mut seen = Vec::with_capacity(columns.len() * (height / step + 1));
        for y in (0..height).step_by(step) {
            seen.extend(columns.iter().map(|&x| Window::at(picture, x, y)));
        }
        let mut counts = [0usize; 256];
        seen.iter().for_each(|w| counts[usize::from(w.range)] += 1);
        let mut below = 0;
        let grain = (0..256).find(|&r| {
            below += counts[r];
            10 * below >= 3 * seen.len()
        });
        let grain = grain.unwrap_or(0).min(25);
        let evenly = (2 * grain + 2).max(6);
        let [mut even, mut strokes] = [Histogram::new(), Histogram::new()];
        for window in &seen {
            if usize::from(window.range) <= evenly {
                even.add(window.mean);
            } else if window.is_extreme {
                strokes.add(window.middle);
            }
        }
        let reach = if grain < 4 { 0.012 } else { 0.02 };
        Self { even: even.bins(), strokes: strokes.bins(), windows: seen.len(), is_grainy: grain >= 4 && !is_drawn(&seen), reach }
    }
}

/// Whether sixteen colours make up half of the picture.
fn is_drawn(seen: &[Window]) -> bool {
    let mut exact: Vec<[u8; 3]> = seen.iter().map(|w| w.middle).collect();
    exact.sort_unstable();
    let mut counts: Vec<usize> = exact.chunk_by(|a, b| a == b).map(<[_]>::len).collect();
    counts.sort_unstable_by(|a, b| b.cmp(a));
    2 * counts.iter().take(16).sum::<usize>() > seen.len()
}

/// Nine pixels, fewer at the border.
struct Window {
    mean: [u8; 3],
    middle: [u8; 3],
    /// Between the lightest and the darkest.
    range: u8,
    /// Whether the middle is the lightest or the darkest.
    is_extreme: bool,
}

impl Window {
    fn at(picture: &Picture, x: usize, y: usize) -> Self {
        let (mut sum, mut count) = ([0u32; 3], 0u32);
        let (mut least, mut most) = (u32::MAX, 0);
        let light = |p: &[u8]| (2 * u32::from(p[0]) + 5 * u32::from(p[1]) + u32::from(p[2])) / 8;
        let columns = x.saturating_sub(1)..(x + 2).min(picture.width);
        for row in y.saturating_sub(1)..(y + 2).min(picture.height) {
            let from = row * picture.width;
            for pixel in picture.pixels[3 * (from + columns.start)..3 * (from + columns.end)].chunks_exact(3) {
                (0..3).for_each(|i| sum[i] += u32::from(pixel[i]));
                count += 1;
                (least, most) = (least.min(light(pixel)), most.max(light(pixel)));
            }
        }
        let at = 3 * (y * picture.width + x);
        let middle = [picture.pixels[at], picture.pixels[at + 1], picture.pixels[at + 2]];
        let own = light(&middle);
        let is_extreme = own == least || own == most;
        Self { mean: sum.map(|s| ((s + count / 2) / count) as u8), middle, range: (most - least) as u8, is_extreme }
    }
}

/// Sums by colour of 5 bits a channel.
struct Histogram(Vec<[u32; 4]>);

impl Histogram {
    fn new() -> Self {
        Self(vec![[0; 4]; STEPS * STEPS * STEPS])
    }

    fn add(&mut self, colour: [u8; 3]) {
        let bin = &mut self.0[table_index(colour)];
        (0..3).for_each(|i| bin[i] += u32::from(colour[i]));
        bin[3] += 1;
    }

    fn bins(&self) -> Vec<Bin> {
        let filled = self.0.iter().filter(|b| b[3] > 0);
        filled
            .map(|&[r, g, b, n]| {
                let lab = oklab([r, g, b].map(|sum| ((sum + n / 2) / n) as u8));
                Bin { lab, rgb: [r, g, b].map(|sum| sum as f32 / n as f32), weight: n as f32 }
            })
            .collect()
    }
}

/// Weight about a colour, the nearest counting most.
fn density(bins: &[Bin], lab: [f32; 3], reach: f32) -> f32 {
    let near = |bin: &Bin| (1.0 - apart(bin.lab, lab) / (reach * reach)).max(0.0) * bin.weight;
    bins.iter().map(near).sum()
}

/// Finds the modes of a histogram, the highest first.
fn modes(bins: &[Bin], reach: f32, least: f64) -> Vec<Bin> {
    let mut found: Vec<Bin> = Vec::new();
    let mut free: Vec<Bin> = bins.to_vec();
    while found.len() < MOST_SWATCHES {
        let Some(highest) = free.iter().max_by(|a, b| a.weight.total_cmp(&b.weight)) else { break };
        let mode = climb(bins, highest.lab, reach);
        let near = |bin: &Bin, lab: [f32; 3]| apart(bin.lab, lab) <= 4.0 * reach * reach;
        let start = highest.lab;
        let weight: f32 = free.iter().filter(|b| near(b, mode.lab) || near(b, start)).map(|b| b.weight).sum();
        free.retain(|b| !near(b, mode.lab) && !near(b, start));
        if f64::from(weight) >= least && !found.iter().any(|old| is_flank(bins, mode.lab, old.lab, reach)) {
            found.push(Bin { weight, ..mode });
        }
    }
    found
}

/// The mean of what lies about a colour, again and again until it stays.
fn climb(bins: &[Bin], from: [f32; 3], reach: f32) -> Bin {
    let mut mode = Bin { lab: from, rgb: [0.0; 3], weight: 0.0 };
    for _ in 0..12 {
        let mut sum = [0.0f32; 7];
        for bin in bins.iter().filter(|b| apart(b.lab, mode.lab) <= reach * reach) {
            (0..3).for_each(|i| sum[i] += bin.lab[i] * bin.weight);
            (0..3).for_each(|i| sum[3 + i] += bin.rgb[i] * bin.weight);
            sum[6] += bin.weight;
        }
        let lab = [sum[0] / sum[6], sum[1] / sum[6], sum[2] / sum[6]];
        let has_stayed = apart(lab, mode.lab) < 1e-8;
        mode = Bin { lab, rgb: [sum[3] / sum[6], sum[4] / sum[6], sum[5] / sum[6]], weight: sum[6] };
        if has_stayed {
            break;
        }
    }
    mode
}

/// Whether a mode is only the flank of a higher one: no valley lies between them.
fn is_flank(bins: &[Bin], mode: [f32; 3], old: [f32; 3], reach: f32) -> bool {
    let gap = apart(mode, old).sqrt();
    if gap > 5.0 * reach {
        return false;
    }
    if gap < reach {
        return true;
    }
    let between = |t: f32| [0, 1, 2].map(|i| mode[i] + (old[i] - mode[i]) * t);
    let low = [0.3, 0.5, 0.7].iter().map(|&t| density(bins, between(t), reach)).fold(f32::INFINITY, f32::min);
    low > 0.6 * density(bins, mode, reach)
}

/// Adds the colours of thin strokes and of a few symbols. The cores of strokes are ink more or less mixed with what is around;
/// the ink itself is what lies farthest from all that is known and from mixtures of it.
fn add_rare(known: &mut Vec<Bin>, even: &[Bin], all: &[Bin], least: f64) {
    const NEW: f32 = 0.06;
    const ABOUT: f32 = 0.08;
    let weight_near = |bins: &[Bin], lab: [f32; 3]| {
        let near = bins.iter().filter(|b| apart(b.lab, lab) < ABOUT * ABOUT);
        f64::from(near.map(|b| b.weight).sum::<f32>())
    };
    while known.len() < MOST_SWATCHES {
        let mut new: Vec<(f32, Bin)> = all.iter().map(|bin| (newness(bin.lab, known), *bin)).collect();
        new.retain(|(newness, _)| *newness > NEW);
        let bins: Vec<Bin> = new.iter().map(|(_, bin)| *bin).collect();
        let enough = new.iter().filter(|(_, bin)| weight_near(&bins, bin.lab) >= least);
        let Some((_, farthest)) = enough.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        // Where the colour also fills areas, it is what those show.
        let of_areas: Vec<Bin> = even.iter().filter(|bin| newness(bin.lab, known) > NEW).copied().collect();
        let bins = if weight_near(&of_areas, farthest.lab) >= least { of_areas } else { bins };
        known.push(climb(&bins, farthest.lab, ABOUT));
    }
}

/// How far a colour lies from all that are known, and from mixtures of two.
fn newness(lab: [f32; 3], known: &[Bin]) -> f32 {
    let lab = stretched(lab, 1.5);
    let from_mixture = |a: [f32; 3], b: [f32; 3]| {
        let d = [0, 1, 2].map(|i| b[i] - a[i]);
        let along: f32 = (0..3).map(|i| (lab[i] - a[i]) * d[i]).sum::<f32>() / apart(a, b).max(1e-9);
        let t = along.clamp(0.0, 1.0);
        apart(lab, [0, 1, 2].map(|i| a[i] + t * d[i]))
    };
    // A colour mixed with itself is the colour.
    let pairs =
        known.iter().enumerate().flat_map(|(i, a)| known[i..].iter().map(move |b| (stretched(a.lab, 1.5), stretched(b.lab, 1.5))));
    pairs.map(|(a, b)| from_mixture(a, b)).fold(f32::INFINITY, f32::min).sqrt()
}

/// Takes out the colour that is missed least: its weight times the way to the next.
fn drop_least(modes: &mut Vec<Bin>, all: &[Bin]) {
    let labs: Vec<[f32; 3]> = modes.iter().map(|m| m.lab).collect();
    let mut weights = vec![0.0f32; labs.len()];
    all.iter().for_each(|bin| weights[nearest(bin.lab, &labs).0] += bin.weight);
    let cost = |i: usize| {
        let next = (0..labs.len()).filter(|&j| j != i).map(|j| apart(labs[i], labs[j])).fold(f32::INFINITY, f32::min);
        weights[i] * next
    };
    let least = (0..labs.len()).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
    if let Some(least) = least {
        modes.remove(least);
    }
}

/// The colours with their share of the picture, the commonest first.
fn shared_out(modes: &[Bin], picture: &Picture) -> Vec<Swatch> {
    let colours: Vec<[u8; 3]> = modes.iter().map(|m| m.rgb.map(|c| c.round() as u8)).collect();
    if colours.is_empty() {
        return Vec::new();
    }
    let table = nearest_table(&colours);
    let step = (picture.width * picture.height / WINDOWS).max(1) | 1;
    let mut counts = vec![0usize; colours.len()];
    let mut seen = 0;
    for pixel in picture.pixels.chunks_exact(3).step_by(step) {
        counts[usize::from(table[table_index([pixel[0], pixel[1], pixel[2]])])] += 1;
        seen += 1;
    }
    let mut swatches: Vec<Swatch> = colours
        .iter()
        .zip(counts)
        .map(|(&colour, count)| Swatch { colour, share: count as f64 / f64::from(seen.max(1)) })
        .collect();
    swatches.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.colour.cmp(&b.colour)));
    swatches
}
