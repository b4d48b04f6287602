//! Façades that somebody painted or photographed, as they travel.

use core::fmt;
use std::collections::BTreeSet;

use glam::DVec2;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::facade_draft::{FacadeObjectKind, ObjectHead};
use crate::grid::GridPos;
use crate::opening::{Head, Recess};
use crate::{GRID_PER_METRE, Rgb};

/// A façade that somebody painted, as level 2 tells it: small textures, and where they are on the wall. Lengths are grid steps; places are
/// from the wall's lower left corner, as it is seen from the street.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaintedFacade {
    /// Width and height of the picture. The wall is as wide, whatever its length; above the picture's height it repeats the upper edge.
    pub size: (i32, i32),
    /// Into so many pictures side by side and equally wide the picture of level 3 is cut; never 0.
    pub sections: u8,
    /// The wall's colour between the objects.
    pub colour: Rgb,
    /// Small textures.
    pub textures: Vec<SmallTexture>,
    /// Where they are; later ones lie on the paintings before them.
    pub objects: Vec<PaintedObject>,
}

/// A small texture of up to 16 colours.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmallTexture {
    /// Texels in a row.
    pub width: u8,
    /// Its colours.
    pub palette: Vec<Rgb>,
    /// Of each texel its colour's place in the palette, row by row from the top.
    pub texels: Vec<u8>,
}

/// An object of a [`PaintedFacade`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaintedObject {
    /// What it is.
    pub kind: FacadeObjectKind,
    /// Its texture's place among [`PaintedFacade::textures`].
    pub texture: u8,
    /// Lower left corner of the first.
    pub low: (i32, i32),
    /// Width and height.
    pub size: (i32, i32),
    /// How it ends at the top.
    pub head: ObjectHead,
    /// How deep it lies in the wall.
    pub depth: i32,
    /// How many side by side.
    pub columns: u8,
    /// How many above one another.
    pub rows: u8,
    /// From one to the next.
    pub step: (i32, i32),
}

impl PaintedFacade {
    /// Most metres of a façade, along and up.
    pub const MOST_M: f64 = 200.0;
    /// Most small textures.
    pub const MOST_TEXTURES: usize = 64;
    /// Most objects, repeated ones counted.
    pub const MOST_PLACES: usize = 1_000;
    /// Least width and height of an object, grid steps: a decimetre, but for what the grid takes.
    const LEAST_SIDE: i32 = 100;
    /// Most sections.
    pub const MOST_SECTIONS: u8 = 16;
    /// So many times as large as the wall its objects may be, all together.
    const MOST_LAYERS: i64 = 4;
    /// Most rectangles into which the edges of openings may cut a wall.
    pub const MOST_RECTANGLES: usize = 4_000;
    /// Most texels of a small texture, across and down.
    pub const MOST_TEXELS: usize = 32;
    /// Most colours of a small texture.
    pub const MOST_COLOURS: usize = 16;

    /// How many pictures level 3 is made of: the wall of each section and, if there are objects, an atlas of them.
    #[must_use]
    pub fn pictures(&self) -> usize {
        usize::from(self.sections) + usize::from(!self.objects.is_empty())
    }

    /// Whether it can be drawn.
    ///
    /// # Errors
    /// What is wrong with it, in a clause.
    pub fn check(&self) -> Result<(), String> {
        let most = (Self::MOST_M as i32 + 1) * GRID_PER_METRE;
        let is_length = |steps: i32| steps > 0 && steps <= most;
        if !is_length(self.size.0) || !is_length(self.size.1) {
            return Err(format!("a painted façade of {:?} steps", self.size));
        }
        if self.sections == 0 || self.sections > Self::MOST_SECTIONS {
            return Err(format!("a painted façade of {} sections", self.sections));
        }
        if self.textures.len() > Self::MOST_TEXTURES {
            return Err(format!("a painted façade has {} small textures", self.textures.len()));
        }
        for (n, texture) in self.textures.iter().enumerate() {
            texture.check().map_err(|reason| format!("small texture {n} {reason}"))?;
        }
        if self.objects.len() > Self::MOST_TEXTURES {
            return Err(format!("a painted façade has {} kinds of objects", self.objects.len()));
        }
        let (mut places, mut area) = (0, 0);
        for (n, object) in self.objects.iter().enumerate() {
            let fits = |low: i32, size: i32, step: i32, count: u8, whole: i32| {
                let last = i64::from(step) * i64::from(count.saturating_sub(1));
                let reach = [i64::from(low), i64::from(low) + last];
                size > 0 && count > 0 && reach.iter().all(|&at| at >= 0 && at + i64::from(size) <= i64::from(whole))
            };
            let is_in = fits(object.low.0, object.size.0, object.step.0, object.columns, self.size.0)
                && fits(object.low.1, object.size.1, object.step.1, object.rows, self.size.1);
            let count = usize::from(object.columns) * usize::from(object.rows);
            places += count;
            if !is_in || places > Self::MOST_PLACES || !(0..=GRID_PER_METRE).contains(&object.depth) {
                return Err(format!("object {n} of a painted façade lies beyond it"));
            }
            if object.size.0.min(object.size.1) < Self::LEAST_SIDE {
                return Err(format!("object {n} of a painted façade is too small"));
            }
            area += count as i64 * i64::from(object.size.0) * i64::from(object.size.1);
            if usize::from(object.texture) >= self.textures.len() {
                return Err(format!("object {n} of a painted façade has no texture"));
            }
        }
        if area > Self::MOST_LAYERS * i64::from(self.size.0) * i64::from(self.size.1) {
            return Err(format!("the objects of a painted façade are more than {} times as large as it", Self::MOST_LAYERS));
        }
        let cuts = |of: fn((i32, i32)) -> i32| {
            let places = self
                .objects
                .iter()
                .filter(|object| !object.is_flat())
                .flat_map(|object| object.places().map(move |low| [of(low), of(low) + of(object.size)]));
            places.flatten().collect::<BTreeSet<i32>>().len() + 1
        };
        let rectangles = cuts(|p| p.0) * cuts(|p| p.1);
        if rectangles > Self::MOST_RECTANGLES {
            return Err(format!("the objects of a painted façade cut it into {rectangles} rectangles: put them in rows"));
        }
        Ok(())
    }
}

impl SmallTexture {
    /// Texels in a column.
    #[must_use]
    pub fn height(&self) -> usize {
        self.texels.len().checked_div(self.width.into()).unwrap_or_default()
    }

    /// The colour of a texel; the last of its row or column beyond them.
    #[must_use]
    pub fn at(&self, column: usize, row: usize) -> Rgb {
        let (width, height) = (usize::from(self.width), self.height());
        let texel = row.min(height.saturating_sub(1)) * width + column.min(width.saturating_sub(1));
        let colour = self.texels.get(texel).and_then(|&colour| self.palette.get(usize::from(colour)));
        colour.copied().unwrap_or(Rgb(128, 128, 128))
    }

    fn check(&self) -> Result<(), String> {
        let (width, height) = (usize::from(self.width), self.height());
        let is_side = |texels: usize| (1..=PaintedFacade::MOST_TEXELS).contains(&texels);
        if !is_side(width) || !is_side(height) || width * height != self.texels.len() {
            return Err(format!("has {} texels in rows of {width}", self.texels.len()));
        }
        if self.palette.is_empty() || self.palette.len() > PaintedFacade::MOST_COLOURS {
            return Err(format!("has {} colours", self.palette.len()));
        }
        match self.texels.iter().find(|&&texel| usize::from(texel) >= self.palette.len()) {
            None => Ok(()),
            Some(texel) => Err(format!("names colour {texel} of {}", self.palette.len())),
        }
    }
}

impl PaintedObject {
    /// Whether it is painted on the wall: no hole in it, and other objects may lie on it.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.kind == FacadeObjectKind::Painting && self.depth == 0
    }

    /// Lower left corners of all its repetitions, row by row.
    pub fn places(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        let at = |low: i32, step: i32, n: u8| low + step * i32::from(n);
        let row =
            move |row| (0..self.columns).map(move |column| (at(self.low.0, self.step.0, column), at(self.low.1, self.step.1, row)));
        (0..self.rows).flat_map(row)
    }

    /// Its hole, metres, as if its lower left corner were (0, 0).
    #[must_use]
    pub fn recess(&self) -> Recess {
        let high = GridPos(self.size.0, self.size.1).to_metres();
        let head = match self.head {
            ObjectHead::Flat => Head::Flat,
            ObjectHead::Segment => Head::Segment((high.x / 5.0).min(high.y / 2.0)),
            // Broader than high is no half circle.
            ObjectHead::Round if high.x > 2.0 * high.y => Head::Segment(high.y / 2.0),
            ObjectHead::Round => Head::Round,
        };
        let depth_m = f64::from(self.depth) / f64::from(GRID_PER_METRE);
        Recess { low: DVec2::ZERO, high, head, jamb_m: 0.0, depth_m, surround: None }
    }
}

/// A painted façade in a plan: on which wall it is, and its pictures.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFacade {
    /// Index of the house, of its volume, and of that one's wall.
    pub wall: (u32, u16, u16),
    /// What level 2 tells.
    pub painted: PaintedFacade,
    /// What level 3 is made of: the wall of each section, from the left, then an atlas of the objects.
    pub pictures: Vec<PictureFile>,
}

/// A façade that is cut, and where it is to go.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedFacade {
    /// What it is called in messages.
    pub name: String,
    /// A place before its wall, plan metres.
    pub at: DVec2,
    /// Height of its eaves over the wall's foot, grid steps.
    pub eaves: i32,
    /// What level 2 tells.
    pub painted: PaintedFacade,
    /// What level 3 is made of.
    pub pictures: Vec<PictureFile>,
}

/// A painted wall of a cell's sheet.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaintedWall {
    /// Index of the wall in the sheet.
    pub wall: u32,
    /// How it is painted.
    pub painted: PaintedFacade,
}

/// A picture as stored, of which nothing is known: whoever shows it decodes it with care.
#[derive(Clone, PartialEq, Eq, Hash, Default)]
pub struct PictureFile(
    /// Its bytes.
    pub Vec<u8>,
);

impl fmt::Debug for PictureFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PictureFile({} B)", self.0.len())
    }
}

impl Serialize for PictureFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for PictureFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Bytes;
        impl<'de> Visitor<'de> for Bytes {
            type Value = PictureFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the bytes of a picture")
            }

            fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<PictureFile, E> {
                Ok(PictureFile(bytes.to_vec()))
            }

            fn visit_byte_buf<E: Error>(self, bytes: Vec<u8>) -> Result<PictureFile, E> {
                Ok(PictureFile(bytes))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<PictureFile, A::Error> {
                let mut bytes = Vec::new();
                while let Some(byte) = seq.next_element()? {
                    bytes.push(byte);
                }
                Ok(PictureFile(bytes))
            }
        }
        deserializer.deserialize_byte_buf(Bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file;

    #[test]
    fn pictures_survive_in_a_plan_that_people_read() {
        let facade = PlanFacade {
            wall: (1, 0, 2),
            painted: PaintedFacade { size: (9000, 14_000), sections: 1, ..PaintedFacade::default() },
            pictures: vec![PictureFile((0..=255).collect())],
        };
        let text = file::to_text(&facade).expect("it can be written");
        assert_eq!(file::parse::<PlanFacade>(&text, "x.plan.ron").expect("it can be read"), facade);
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let texture = SmallTexture { width: 2, palette: vec![Rgb(1, 2, 3)], texels: vec![0; 6] };
        let object = PaintedObject {
            kind: FacadeObjectKind::Window,
            texture: 0,
            low: (100, 100),
            size: (1000, 2000),
            head: ObjectHead::Round,
            depth: 200,
            columns: 2,
            rows: 1,
            step: (3000, 0),
        };
        let good = PaintedFacade {
            size: (9000, 14_000),
            sections: 1,
            colour: Rgb(1, 2, 3),
            textures: vec![texture],
            objects: vec![object],
        };
        assert_eq!(good.check(), Ok(()));
        let refused = |spoil: fn(&mut PaintedFacade)| {
            let mut bad = good.clone();
            spoil(&mut bad);
            bad.check().expect_err("it cannot be drawn")
        };
        assert!(refused(|f| f.size.0 = 0).contains("steps"));
        assert!(refused(|f| f.sections = 0).contains("sections"));
        assert!(refused(|f| f.textures[0].texels[5] = 1).contains("colour 1 of 1"));
        assert!(refused(|f| f.textures[0].texels.truncate(5)).contains("5 texels"));
        assert!(refused(|f| f.objects[0].texture = 1).contains("no texture"));
        assert!(refused(|f| f.objects[0].columns = 4).contains("beyond it"));
        assert!(refused(|f| f.objects[0].step.0 = i32::MAX).contains("beyond it"));
        assert!(refused(|f| f.objects[0].depth = -1).contains("beyond it"));
        assert!(refused(|f| f.objects[0].size.0 = 9).contains("too small"));
        assert!(refused(|f| f.objects = vec![f.objects[0]; 300]).contains("300 kinds of objects"));
        // One over the other.
        let covers = |f: &mut PaintedFacade| {
            (f.objects[0].low, f.objects[0].size, f.objects[0].step, f.objects[0].columns) = ((0, 0), f.size, (0, 0), 5);
        };
        assert!(refused(covers).contains("4 times as large"));
        let scattered = |f: &mut PaintedFacade| {
            let object = PaintedObject { size: (200, 200), columns: 1, rows: 1, ..f.objects[0] };
            f.objects = (0..64).map(|n| PaintedObject { low: (n * 130, n * 209), ..object }).collect();
        };
        assert!(refused(scattered).contains("put them in rows"));
    }
}
