use core::ops::Range;
use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::model::Model;
use super::shape::{Shape, Unit};
use crate::{GridPos, Rgb, Tile};

/// What a part of a monument is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// What the tile is multiplied by.
    pub colour: Rgb,
    /// Texture; a bay's tile is stretched over the front of what it covers.
    pub tile: Tile,
}

/// An axis of a part's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Axis {
    /// Left and right change places.
    X,
    /// Front and back change places.
    Y,
}

/// How a part is repeated, in the frame of what it is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Repeat<N> {
    /// In a row.
    Row {
        /// How many, the first included.
        count: N,
        /// From one to the next, metres.
        step: [N; 3],
        /// Whether the row's middle stands where its first would.
        #[serde(default)]
        centred: bool,
    },
    /// About the upright axis.
    Around {
        /// How many, the first included.
        count: N,
        /// Degrees from the first to the last and one step on, clockwise seen from above; a whole turn without.
        #[serde(default = "whole_turn")]
        arc_deg: Option<N>,
        /// From one to the next, upwards; metres.
        #[serde(default = "whole_turn")]
        rise: Option<N>,
    },
}

/// A field that may be left out. (What serde would assume asks for `N: Default`.)
const fn whole_turn<N>() -> Option<N> {
    None
}

/// A monument with all its formulas worked out: what a plan and a packet carry. Lengths are grid steps, angles hundredths of a
/// degree, ratios 1/1024.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Name of the monument.
    pub name: String,
    /// Pieces refer to them by index.
    pub materials: Vec<Material>,
    /// Drawn one after the other; a group comes before what is in it.
    pub pieces: Vec<Piece>,
}

/// A piece of a [`Design`]: a shape or a group, placed: scaled, rolled, tilted, turned, moved, mirrored and repeated, in this order.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Grid steps.
    pub at: [i32; 3],
    /// About x (its top leans back), about y (its top leans to the right), about z (clockwise seen from above).
    pub turn: [i32; 3],
    /// 1024 for 1.
    pub scale: [i32; 3],
    /// A second one, mirrored at the plane through the origin of what it is part of.
    pub mirror: Option<Axis>,
    /// More of it.
    pub repeat: Option<Repeat<i32>>,
    /// What it is made of; index of [`Design::materials`].
    pub paint: u8,
    /// What fills its holes or gables.
    pub infill: Option<u8>,
    /// What it is.
    pub content: Content,
}

/// What a [`Piece`] is.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Content {
    /// A solid.
    Shape(Shape<i32>),
    /// So many of the pieces that follow it in the list, placed together.
    Group(u32),
    /// Triangles from a file.
    Model(Model),
    /// What the piece is that stands so many before it in the list, whole before this one and none of these: the same, once more.
    Again(u32),
}

/// A monument at its place in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacedMonument {
    /// Index of its design.
    pub design: u16,
    /// Where its origin stands.
    pub pos: GridPos,
    /// Its foot above the city's zero, grid steps.
    pub z: i32,
    /// Where its front looks, hundredths of a degree clockwise from north, 0 to 35,999.
    pub heading: u16,
}

impl<N> Repeat<N> {
    /// How many.
    pub const fn count(&self) -> &N {
        match self {
            Self::Row { count, .. } | Self::Around { count, .. } => count,
        }
    }
}

/// Most faces that a design may come to, by [`Shape::most_faces`] and repetitions counted.
pub const MOST_FACES: u64 = 4_000_000;
/// Most pieces that a design may have, repetitions not counted.
pub(super) const MOST_PIECES: usize = 60_000;
/// Deepest nesting of groups.
pub(super) const DEEPEST: usize = 24;
/// Most of one thing in a repetition, and most sides of a round body.
pub(super) const MOST_COPIES: i32 = 1_000;
/// Largest scale, 1/1024.
const MOST_SCALE: u32 = 100 * 1024;
/// Largest number of a shape.
const FARTHEST: u32 = 1 << 24;

/// Why a design cannot be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DesignError {
    /// It comes to too much.
    #[error("it comes to more than {MOST_PIECES} pieces or {MOST_FACES} faces")]
    TooMany,
    /// A number of a shape is out of bounds.
    #[error("`{1}` of piece {0} is out of bounds")]
    Number(usize, &'static str),
    /// A group reaches beyond the list or the group that it is in, or groups are nested too deeply.
    #[error("piece {0} is no group of pieces, or is nested more than {DEEPEST} deep")]
    Group(usize),
    /// A piece that is once more what does not stand whole before it, or that nests too deeply.
    #[error("piece {0} is once more what is not there before it, or is nested more than {DEEPEST} deep")]
    Again(usize),
    /// A repetition out of bounds.
    #[error("piece {0} is there a number of times that is not within 0 to {MOST_COPIES}")]
    Copies(usize),
    /// A material that is not there.
    #[error("piece {0} is made of a material that is not there")]
    Material(usize),
    /// A material whose tile is a picture of something else.
    #[error("material {0} is the picture of a tree")]
    Tile(usize),
    /// A model's triangles, numbers or normals are none.
    #[error("piece {0} is a model with corners that are not there, lie too far away or face nowhere")]
    Model(usize),
}

impl Design {
    /// Checks that groups are whole and not too deep, that materials exist, and that it does not come to more than any machine
    /// should draw.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), DesignError> {
        if let Some(i) = self.materials.iter().position(|material| material.tile.is_card()) {
            return Err(DesignError::Tile(i));
        }
        for (i, piece) in self.pieces.iter().enumerate() {
            let copies = piece.repeat.as_ref().map_or(1, |repeat| *repeat.count());
            if !(0..=MOST_COPIES).contains(&copies) {
                return Err(DesignError::Copies(i));
            }
            let is_far = |n: &i32| n.unsigned_abs() > FARTHEST;
            if piece.at.iter().any(is_far) || piece.turn.iter().any(is_far) {
                return Err(DesignError::Number(i, "at"));
            }
            if piece.scale.iter().any(|&n| n == 0 || n.unsigned_abs() > MOST_SCALE) {
                return Err(DesignError::Number(i, "scale"));
            }
            let is_shape = !matches!(self.content(i), Some((_, Content::Group(_))) | None);
            if matches!(&piece.content, Content::Model(model) if !model.is_whole(FARTHEST)) {
                return Err(DesignError::Model(i));
            }
            if let Content::Shape(shape) = &piece.content {
                let bounded = |field, unit, &n: &i32| match unit {
                    Unit::Count if !(0..=MOST_COPIES).contains(&n) => Err(DesignError::Number(i, field)),
                    Unit::Length | Unit::Angle | Unit::Ratio if n.unsigned_abs() > FARTHEST => Err(DesignError::Number(i, field)),
                    _ => Ok(n),
                };
                shape.try_map(&mut { bounded })?;
            }
            let of = piece.infill.into_iter().chain(is_shape.then_some(piece.paint));
            if of.into_iter().any(|material| usize::from(material) >= self.materials.len()) {
                return Err(DesignError::Material(i));
            }
        }
        if self.most_faces()? > MOST_FACES || self.pieces.len() > MOST_PIECES { Err(DesignError::TooMany) } else { Ok(()) }
    }

    /// A bound on the number of faces that it comes to, repetitions and the walk of groups counted.
    ///
    /// # Errors
    /// [`DesignError::Group`] and [`DesignError::Again`] if its pieces are not whole.
    pub fn most_faces(&self) -> Result<u64, DesignError> {
        // A group costs its walk even where there is nothing in it.
        self.sum(1, &|content| match content {
            Content::Shape(shape) => shape.most_faces(),
            Content::Model(model) => model.triangles.len() as u64,
            Content::Group(_) | Content::Again(_) => 0,
        })
    }

    /// How many shapes it stands for, repetitions counted; 0 for one that does not pass [`Design::check`].
    #[must_use]
    pub fn shape_count(&self) -> u64 {
        self.sum(0, &|_| 1).unwrap_or(0)
    }

    /// What its shapes come to, repetitions counted.
    fn sum(&self, group: u64, each: &dyn Fn(&Content) -> u64) -> Result<u64, DesignError> {
        let mut sum = Sum { design: self, group, each, known: vec![None; self.pieces.len()] };
        Ok(sum.of(0..self.pieces.len(), 0)?.0)
    }

    /// What a piece is, and the number of the piece that tells it; `None` if there is no such piece.
    fn content(&self, piece: usize) -> Option<(usize, &Content)> {
        let told = match self.pieces.get(piece)?.content {
            Content::Again(back) => piece.checked_sub(back as usize)?,
            _ => piece,
        };
        match &self.pieces.get(told)?.content {
            Content::Again(_) => None,
            content => Some((told, content)),
        }
    }

    /// The pieces on their own level of a range of the list, each with what it is, which is never [`Content::Again`], and the range of
    /// those within it. What is not there is left out.
    pub fn level(&self, mut range: Range<usize>) -> impl Iterator<Item = (&Piece, &Content, Range<usize>)> {
        range.end = range.end.min(self.pieces.len());
        core::iter::from_fn(move || {
            loop {
                let i = range.next()?;
                let piece = self.pieces.get(i)?;
                if let Content::Group(n) = piece.content {
                    range.start = group(&range, n).map_or(range.start, |inner| inner.end);
                }
                let Some((told, content)) = self.content(i) else { continue };
                let inner = match content {
                    Content::Group(n) => group(&(told + 1..self.pieces.len()), *n).unwrap_or_default(),
                    _ => 0..0,
                };
                return Some((piece, content, inner));
            }
        })
    }

    /// The same monument with what its pieces are told no more than once.
    pub(super) fn told_once(self) -> Self {
        let mut pieces = Vec::with_capacity(self.pieces.len());
        tell_once(&self.pieces, &mut pieces, &mut HashMap::new());
        Self { pieces, ..self }
    }
}

/// Sums up what a design comes to.
struct Sum<'a> {
    design: &'a Design,
    /// What a group adds by itself.
    group: u64,
    each: &'a dyn Fn(&Content) -> u64,
    /// Of each piece that is behind: what it is comes to, how deep it nests, and where the next one is.
    known: Vec<Option<(u64, usize, usize)>>,
}

impl Sum<'_> {
    /// What some pieces at a depth come to, and how deep they nest.
    fn of(&mut self, mut range: Range<usize>, depth: usize) -> Result<(u64, usize), DesignError> {
        let (mut sum, mut deepest) = (0_u64, 0);
        while let Some(i) = range.next() {
            let piece = &self.design.pieces[i];
            let (inner, deep) = match &piece.content {
                content @ (Content::Shape(_) | Content::Model(_)) => ((self.each)(content), 0),
                Content::Group(n) => {
                    let inner = group(&range, *n).filter(|_| depth < DEEPEST).ok_or(DesignError::Group(i))?;
                    range.start = inner.end;
                    let (sum, deep) = self.of(inner, depth + 1)?;
                    (sum.saturating_add(self.group), deep + 1)
                }
                Content::Again(back) => {
                    let told = i.checked_sub(*back as usize).and_then(|told| self.known[told]);
                    let whole = told.filter(|&(_, deep, end)| end <= i && depth + deep <= DEEPEST);
                    whole.map(|(sum, deep, _)| (sum, deep)).ok_or(DesignError::Again(i))?
                }
            };
            if !matches!(piece.content, Content::Again(_)) {
                self.known[i] = Some((inner, deep, range.start));
            }
            let copies = piece.repeat.as_ref().map_or(1, |repeat| u64::from((*repeat.count()).max(0).unsigned_abs()));
            let copies = if piece.mirror.is_some() { 2 * copies } else { copies };
            sum = sum.saturating_add(copies.saturating_mul(inner));
            deepest = deepest.max(deep);
        }
        Ok((sum, deepest))
    }
}

/// Appends pieces, those that are what one of the list is already as that once more. `known` tells where in the list stands what is told, with
/// all that is within it.
fn tell_once<'a>(pieces: &'a [Piece], list: &mut Vec<Piece>, known: &mut HashMap<(&'a Content, &'a [Piece]), usize>) {
    let mut left = pieces.iter();
    while let Some(piece) = left.next() {
        let rest = left.as_slice();
        let inner = match piece.content {
            Content::Group(n) => rest.get(..n as usize).unwrap_or(rest),
            _ => &[],
        };
        left = rest[inner.len()..].iter();
        let here = list.len();
        let before = *known.entry((&piece.content, inner)).or_insert(here);
        list.push(piece.clone());
        if before < here {
            list[here].content = Content::Again((here - before) as u32);
        } else if !inner.is_empty() {
            tell_once(inner, list, known);
            list[here].content = Content::Group((list.len() - here - 1) as u32);
        }
    }
}

/// The first pieces of what is left of a range, if it has so many.
fn group(left: &Range<usize>, n: u32) -> Option<Range<usize>> {
    let end = left.start.checked_add(n as usize)?;
    (end <= left.end).then_some(left.start..end)
}
