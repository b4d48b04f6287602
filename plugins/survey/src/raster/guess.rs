//! What the colours of a map stand for, guessed from how they lie.
//!
//! ```text
//!  picture ──quantise──► colours ──┬─ networks: which colours, together, divide the rest into most blocks ──► streets
//!                                  ├─ hue of what is wide: green, blue ────────────────────────────────────► park, water
//!                                  ├─ long lines that divide little ───────────────────────────────────────► railway
//!                                  ├─ small spots and thin strokes ────────────────────────────────────────► label
//!                                  ├─ many regions within one ground, away from all streets ───────────────► house
//!                                  └─ the rest ────────────────────────────────────────────────────────────► built
//! ```
//! Light streets between coloured blocks and black streets on white paper are told by the same figure, as neither lightness
//! nor hue says what a street is, but that it leads everywhere and encloses everything else.

mod classes;
mod regions;

use veduta_city::{Finding, Id, Rgb, Severity, StreetClass};

use crate::raster::quantise::{apart, nearest_table, reduced, table_index};
use crate::raster::{Legend, LegendColour, MapClass, Picture};
use classes::Colour;
use regions::{Shape, Sheet, Side, shared_edge};

/// Longest side of the sheet that shapes are measured on; pixels.
const SHEET_SIDE: usize = 2048;
/// Ink differs from paper by more lightness than this.
const STAINED: f32 = 0.12;
/// A network of streets divides the rest of the map into so many blocks at the least.
const LEAST_NETWORK: f64 = 4.0;

/// Guesses what the colours of a map stand for. `colours` says to how many the map is to be reduced; without it, they are its
/// own most frequent ones ([`crate::raster::swatches`]).
///
/// ```
/// use veduta_survey::raster::{MapClass, Picture, guess_legend};
///
/// // Streets every 20 pixels, 4 wide, between blocks.
/// let colour = |x: usize, y: usize| if x % 20 < 4 || y % 20 < 4 { [250, 250, 245] } else { [200, 170, 150] };
/// let pixels = (0..200 * 200).flat_map(|i| colour(i % 200, i / 200)).collect();
/// let (legend, findings) = guess_legend(&Picture { width: 200, height: 200, pixels }, None);
/// let class_of = |colour| legend.colours.iter().find(|c| c.colour == colour).map(|c| c.class);
/// assert_eq!(class_of([250, 250, 245]), Some(MapClass::Street(None)));
/// assert_eq!(class_of([200, 170, 150]), Some(MapClass::Built));
/// println!("{}", legend.to_ron_with(&findings));
/// ```
#[must_use]
pub fn guess_legend(picture: &Picture, colours: Option<usize>) -> (Legend, Vec<Finding>) {
    let (swatches, is_grainy) = reduced(picture, colours);
    let mut notes = Notes::default();
    if let Some(asked) = colours.filter(|&asked| asked > swatches.len()) {
        notes.add(format!("{asked} colours were asked for, and {} stand out", swatches.len()));
    }
    let rgb: Vec<[u8; 3]> = swatches.iter().map(|s| s.colour).collect();
    if rgb.is_empty() {
        return (Legend::default(), notes.0);
    }
    let sheet = sheet(picture, &rgb, is_grainy);
    let found: Vec<Colour> = (0..rgb.len()).map(|i| Colour::new(rgb[i], Shape::of(&sheet, &|c| usize::from(c) == i))).collect();
    let streets = streets(&sheet, &found, classes::paper(&found, &[]), &mut notes);
    let network = Shape::of(&sheet, &|c| streets.contains(&usize::from(c)));
    let is_outlined = is_outlined(&found, &streets, &network);
    if is_outlined {
        notes.add(
            "streets and blocks are both bare paper, parted by outlines: what lines enclose is taken for blocks, and the paper \
             around them for streets, squares and parks; close in a stage picture what stands open"
                .to_owned(),
        );
    }
    let paper = classes::paper(&found, &streets);
    let mut legend = Legend { is_outlined, ..Legend::default() };
    for (i, colour) in found.iter().enumerate() {
        let class = if is_outlined && (streets.contains(&i) || is_stain(colour, &found[streets[0]])) {
            MapClass::Street(None)
        } else if streets.contains(&i) {
            street_class(&found, &streets, i, &mut notes)
        } else if classes::is_fringe(&found, i) {
            notes.add(format!("{} is left out: it only shows where two other colours meet", colour.hex()));
            continue;
        } else {
            classes::class_of(colour, &network, paper, is_outlined, &mut notes)
        };
        legend.colours.push(LegendColour { class, colour: colour.rgb });
    }
    let houses = if is_outlined { Vec::new() } else { houses(&sheet, &found, &streets, &network, &legend) };
    for entry in legend.colours.iter_mut().filter(|entry| houses.iter().any(|&i| found[i].rgb == entry.colour)) {
        entry.class = MapClass::House;
        let hex = Rgb(entry.colour[0], entry.colour[1], entry.colour[2]);
        notes.add(format!("{hex} is taken for single houses: many of them lie within ground of another colour, off the streets"));
    }
    (legend, notes.0)
}

/// The colours of single houses among those of built ground: they lie within a ground that is as wide as a block, and hardly
/// touch streets. Lines of another colour that blocks are cased by are no ground. Houses that stand on the street, and those
/// with outlines, are not told from blocks: there a person must say it.
fn houses(sheet: &Sheet, found: &[Colour], streets: &[usize], network: &Shape, legend: &Legend) -> Vec<usize> {
    const LEAST_HOUSES: f64 = 24.0;
    const MOST_ON_STREETS: f64 = 0.15;
    const LEAST_ON_GROUND: f64 = 0.6;
    let is_built = |i: &usize| legend.colours.iter().any(|c| c.colour == found[*i].rgb && c.class == MapClass::Built);
    let built: Vec<usize> = (0..found.len()).filter(is_built).collect();
    let pixels = (sheet.width * sheet.height) as f64;
    let is_ground = |i: &usize| found[*i].shape.thickness > 0.4 * network.thickness && found[*i].shape.share > 0.1;
    let grounds: Vec<usize> = built.iter().copied().filter(is_ground).collect();
    let is_house = |i: &usize| {
        let shape = &found[*i].shape;
        let ground: Vec<usize> = grounds.iter().copied().filter(|g| g != i).collect();
        let many = shape.share * pixels > LEAST_HOUSES * shape.region_area;
        many && !ground.is_empty()
            && edge_with(sheet, found, *i, streets) < MOST_ON_STREETS
            && edge_with(sheet, found, *i, &ground) > LEAST_ON_GROUND
    };
    let houses: Vec<usize> = built.iter().copied().filter(is_house).collect();
    // Of two colours that lie within one another neither is told from the ground.
    if grounds.iter().all(|g| houses.contains(g)) { Vec::new() } else { houses }
}

/// What is told to the person.
#[derive(Debug, Default)]
struct Notes(Vec<Finding>);

impl Notes {
    fn add(&mut self, message: String) {
        self.0.push(Finding::new(Severity::Note, Id::NONE, None, message));
    }
}

/// The picture as numbers of its colours, small enough.
fn sheet(picture: &Picture, colours: &[[u8; 3]], is_grainy: bool) -> Sheet {
    let table = nearest_table(colours);
    let step = picture.width.max(picture.height).div_ceil(SHEET_SIDE).max(1);
    let (width, height) = (picture.width.div_ceil(step), picture.height.div_ceil(step));
    let mut numbers = Vec::with_capacity(width * height);
    for y in (0..picture.height).step_by(step) {
        for x in (0..picture.width).step_by(step) {
            let at = 3 * (y * picture.width + x);
            let own = [picture.pixels[at], picture.pixels[at + 1], picture.pixels[at + 2]];
            numbers.push(table[table_index(if is_grainy { mean_about(picture, x, y) } else { own })]);
        }
    }
    Sheet { width, height, colours: numbers }
}

/// Mean of a pixel and its neighbours.
fn mean_about(picture: &Picture, x: usize, y: usize) -> [u8; 3] {
    let (mut sum, mut count) = ([0u32; 3], 0);
    let columns = x.saturating_sub(1)..(x + 2).min(picture.width);
    for row in y.saturating_sub(1)..(y + 2).min(picture.height) {
        let from = row * picture.width;
        for pixel in picture.pixels[3 * (from + columns.start)..3 * (from + columns.end)].chunks_exact(3) {
            (0..3).for_each(|i| sum[i] += u32::from(pixel[i]));
            count += 1;
        }
    }
    sum.map(|s| (s / count) as u8)
}

/// The colours that, together, are the network of streets.
fn streets(sheet: &Sheet, found: &[Colour], paper: [u8; 3], notes: &mut Notes) -> Vec<usize> {
    let mut starts: Vec<usize> = (0..found.len()).filter(|&i| found[i].may_be_street(paper)).collect();
    starts.sort_by(|&a, &b| found[b].shape.network().total_cmp(&found[a].shape.network()).then(a.cmp(&b)));
    // What leads far begins; blocks do not, unless nothing else is there.
    let leading: Vec<usize> = starts.iter().copied().filter(|&i| found[i].shape.far_reaching > 0.6).collect();
    let first = if leading.is_empty() { &starts } else { &leading };
    let grown = first.iter().take(3).map(|&start| grown(sheet, found, &starts, start));
    let mut best: (Vec<usize>, f64) = (Vec::new(), 0.0);
    for next in grown {
        if next.1 > best.1 {
            best = next;
        }
    }
    if best.1 >= LEAST_NETWORK {
        let set = best.0;
        let more = |&i: &usize| !set.contains(&i) && set.iter().any(|&s| found[i].runs_with(&found[s]));
        let more: Vec<usize> = starts.iter().copied().filter(more).filter(|&i| edge_with(sheet, found, i, &set) < 0.42).collect();
        return [set, more].concat();
    }
    // A small town in the middle of a large sheet: the land around counts for nothing.
    let inner = |c: &Colour| c.shape.inner_divides * c.shape.far_reaching;
    let lines = (0..found.len()).filter(|&i| found[i].may_be_street(paper) && found[i].shape.share < 0.4);
    let street = lines.max_by(|&a, &b| inner(&found[a]).total_cmp(&inner(&found[b])));
    let street = street.filter(|&i| inner(&found[i]) >= LEAST_NETWORK).or(best.0.first().copied()).unwrap_or(0);
    notes.add(format!("{} is taken for streets, though it hardly divides the map into blocks", found[street].hex()));
    vec![street]
}

/// A network that grows from one colour by those that make it divide more, and how well it does.
fn grown(sheet: &Sheet, found: &[Colour], starts: &[usize], start: usize) -> (Vec<usize>, f64) {
    let shape_of = |set: &[usize]| Shape::of(sheet, &|c| set.contains(&usize::from(c)));
    let width = found[start].shape.thickness;
    let (mut set, mut network, mut blocks) = (vec![start], found[start].shape.network(), found[start].shape.blocks(width));
    loop {
        let more = starts.iter().filter(|&&i| !set.contains(&i) && found[i].goes_with(&found[start]));
        let more = more.filter(|&&i| edge_with(sheet, found, i, &set) < ENCLOSED);
        let tried = more.map(|&i| (i, shape_of(&[set.as_slice(), &[i]].concat())));
        // A street parts what was one; a block that is added is one less.
        let parting = tried.filter(|(_, shape)| shape.network() > 1.4 * network && shape.blocks(width) > blocks);
        let Some((next, shape)) = parting.max_by(|a, b| a.1.network().total_cmp(&b.1.network())) else { break };
        set.push(next);
        (network, blocks) = (shape.network(), shape.blocks(width));
    }
    // Begun from a colour of blocks, the set has them still.
    while let Some(at) = set.iter().position(|&i| set.len() > 1 && edge_with(sheet, found, i, &set) > ENCLOSED) {
        set.remove(at);
        network = shape_of(&set).network();
    }
    (set, network)
}

/// A colour that has more of its edge than this with streets lies between them, and is no street itself.
const ENCLOSED: f64 = 0.6;

/// Share of a colour's edge that it has with others of a set.
fn edge_with(sheet: &Sheet, found: &[Colour], colour: usize, set: &[usize]) -> f64 {
    let others = || set.iter().copied().filter(|&i| i != colour);
    let narrowest = others().map(|i| found[i].shape.thickness).fold(f64::INFINITY, f64::min);
    let over = if narrowest > 8.0 { 4 } else { 1 };
    let side = |i: usize| match i {
        own if own == colour => Side::Own,
        with if others().any(|other| other == with) => Side::With,
        alike if found.get(alike).is_some_and(|c| apart(c.lab, found[colour].lab) < 0.06 * 0.06) => Side::Alike,
        _ => Side::Other,
    };
    shared_edge(sheet, over, &|c| side(usize::from(c)))
}

/// Whether all that is not street is strokes on the paper of the streets.
fn is_outlined(found: &[Colour], streets: &[usize], network: &Shape) -> bool {
    let is_wide = |c: &Colour| c.shape.share > 0.02 && c.shape.thickness > 0.3 * network.thickness;
    network.share > 0.6 && !found.iter().enumerate().any(|(i, c)| !streets.contains(&i) && is_wide(c))
}

/// Whether a colour is bare paper, darker or lighter than most of it.
fn is_stain(colour: &Colour, paper: &Colour) -> bool {
    let lighter = colour.lab[0] - paper.lab[0];
    lighter.abs() < STAINED || lighter > 0.0 && paper.lab[0] > 0.5
}

/// Of several colours of streets the least coloured is the ordinary one.
fn street_class(found: &[Colour], streets: &[usize], this: usize, notes: &mut Notes) -> MapClass {
    let plainest = streets.iter().min_by(|&&a, &&b| found[a].chroma().total_cmp(&found[b].chroma()));
    if plainest == Some(&this) {
        return MapClass::Street(None);
    }
    notes.add(format!("{} is taken for main streets, as it is more coloured than other streets", found[this].hex()));
    MapClass::Street(Some(StreetClass::Main))
}

impl Colour {
    fn hex(&self) -> String {
        Rgb(self.rgb[0], self.rgb[1], self.rgb[2]).to_string()
    }

    /// Whether both may be colours of streets on one map: of similar lightness and width, and leading far.
    fn goes_with(&self, other: &Self) -> bool {
        self.is_alike(other) && self.shape.far_reaching > 0.12 && self.shape.share > 0.004
    }

    /// The same for a piece of street here and there.
    fn runs_with(&self, other: &Self) -> bool {
        let shape = &self.shape;
        self.is_alike(other) && shape.region_length.powi(2) > 3.0 * shape.region_area && shape.region_length > 4.0 * shape.thickness
    }

    fn is_alike(&self, other: &Self) -> bool {
        let stroke = self.shape.thickness / other.shape.thickness.max(1e-9);
        (self.lab[0] - other.lab[0]).abs() < 0.2 && (0.25..4.0).contains(&stroke)
    }
}

#[cfg(test)]
mod tests;
