//! What a colour that is no street stands for.

use super::Notes;
use super::regions::Shape;
use crate::raster::MapClass;
use crate::raster::quantise::{apart, oklab};

/// A colour of the map and its shape.
#[derive(Debug, Clone)]
pub(super) struct Colour {
    pub(super) rgb: [u8; 3],
    pub(super) lab: [f32; 3],
    pub(super) shape: Shape,
}

impl Colour {
    pub(super) fn new(rgb: [u8; 3], shape: Shape) -> Self {
        Self { rgb, lab: oklab(rgb), shape }
    }

    pub(super) fn chroma(&self) -> f32 {
        self.lab[1].hypot(self.lab[2])
    }

    /// Whether it is not plainly park, water or railway by hue, nor too little to be streets.
    pub(super) fn may_be_street(&self, paper: [u8; 3]) -> bool {
        let [chroma, hue] = chroma_and_hue(on_white(self.rgb, paper));
        !(chroma > 0.03 && (105.0..345.0).contains(&hue)) && self.shape.share > 0.0005
    }
}

/// Saturation and hue, degrees: 30 red, 90 yellow, 140 green, 240 blue, 310 purple.
fn chroma_and_hue(lab: [f32; 3]) -> [f32; 2] {
    [lab[1].hypot(lab[2]), libm::atan2f(lab[2], lab[1]).to_degrees().rem_euclid(360.0)]
}

/// The paper's colour: that of light streets, or else the lightest of some share. White where there is none.
pub(super) fn paper(found: &[Colour], streets: &[usize]) -> [u8; 3] {
    let is_paper = |c: &&Colour| c.lab[0] > 0.75 && c.chroma() < 0.07 && c.shape.share > 0.05;
    let lightest = |colours: &mut dyn Iterator<Item = &Colour>| {
        colours.filter(is_paper).max_by(|a, b| a.lab[0].total_cmp(&b.lab[0])).map(|c| c.rgb)
    };
    let of_streets = lightest(&mut streets.iter().filter_map(|&i| found.get(i)));
    of_streets.or_else(|| lightest(&mut found.iter())).unwrap_or([255; 3])
}

/// A colour as it would be on white paper.
fn on_white(rgb: [u8; 3], paper: [u8; 3]) -> [f32; 3] {
    oklab([0, 1, 2].map(|i| (u32::from(rgb[i]) * 255 / u32::from(paper[i]).max(1)).min(255) as u8))
}

/// Whether a colour is only the soft edge between two wide ones.
pub(super) fn is_fringe(found: &[Colour], this: usize) -> bool {
    let colour = &found[this];
    if colour.shape.thickness > 1.2 || colour.shape.far_reaching > 0.3 {
        return false;
    }
    let wide: Vec<&Colour> = found.iter().filter(|c| c.shape.share > 0.1 && c.rgb != colour.rgb).collect();
    let mixture = |a: &Colour, b: &Colour, t: f32| {
        oklab([0, 1, 2].map(|i| (f32::from(a.rgb[i]) * (1.0 - t) + f32::from(b.rgb[i]) * t) as u8))
    };
    let is_near = |a: &Colour, b: &Colour| (1..10).any(|t| apart(mixture(a, b, t as f32 / 10.0), colour.lab) < 0.05 * 0.05);
    wide.iter().enumerate().any(|(i, a)| wide[i + 1..].iter().any(|b| is_near(a, b)))
}

/// What a colour that is no street stands for; `network` is the streets' shape.
pub(super) fn class_of(colour: &Colour, network: &Shape, paper: [u8; 3], is_outlined: bool, notes: &mut Notes) -> MapClass {
    let shape = &colour.shape;
    let [chroma, hue] = chroma_and_hue(on_white(colour.rgb, paper));
    let reach = if is_outlined { network.thickness.min(15.0) } else { network.thickness };
    let is_spots = shape.far_reaching < 0.05 && shape.region_area < (2.5 * reach).powi(2);
    let is_fine = shape.thickness < 0.3 * reach && shape.region_area < (4.0 * reach).powi(2);
    let is_strokes = is_fine && shape.far_reaching < 0.3 && shape.share < 0.08;
    let is_leafy = chroma > 0.03 && (105.0..178.0).contains(&hue);
    let is_watery = chroma > 0.025 && (178.0..285.0).contains(&hue);
    let is_long = shape.region_length.powi(2) > 8.0 * shape.region_area;
    if is_outlined && shape.thickness < 3.0 {
        return MapClass::Label;
    }
    let is_line = is_long && shape.share < 0.08 && shape.region_length > 4.0 * reach;
    let is_purple = chroma > 0.04 && (285.0..350.0).contains(&hue);
    let is_vague = is_spots || is_strokes || is_leafy || is_watery || shape.far_reaching <= 0.3;
    if is_line && colour.lab[0] < 0.72 && (is_purple || !is_vague) {
        let hex = colour.hex();
        notes.add(format!("{hex} is taken for railways: long lines that divide no blocks; they may be borders or walls"));
        return MapClass::Railway;
    }
    if (is_spots || is_strokes) && shape.share < 0.15 {
        return MapClass::Label;
    }
    if is_leafy {
        return MapClass::Park;
    }
    if is_watery {
        return MapClass::Water;
    }
    if shape.share < 0.02 {
        notes.add(format!("{} is taken for built ground, though there is little of it", colour.hex()));
    }
    MapClass::Built
}
