//! Façades that somebody painted or photographed, as a person writes them.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::painted::PaintedFacade;

/// A façade given as a picture, as a person or an authoring tool writes it: `X.facade.ron` beside the picture.
///
/// ```
/// use veduta_city::{FacadeDraft, file};
///
/// let draft: FacadeDraft = file::parse(r#"(
///     name: "House at the Minute",
///     picture: "minute.jpg",
///     size_m: (11.2, 15.4),
///     objects: [
///         // Four windows side by side in each of two storeys.
///         (kind: Window, low: (1.0, 5.2), size: (1.1, 1.9), repeat: (columns: 4, rows: 2, step: (2.6, 3.4))),
///         (kind: Door, low: (4.9, 0.0), size: (1.4, 2.6), head: Round),
///         (kind: Painting, low: (4.4, 12.4), size: (2.4, 2.0)),
///     ],
/// )"#, "minute.facade.ron")?;
/// assert_eq!(draft.validate(), []);
/// assert_eq!(draft.eaves_m(), 15.4);
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacadeDraft {
    /// What it is called in messages.
    pub name: String,
    /// The picture, by its path from the folder of this file: PNG, JPEG, TIFF or WebP.
    pub picture: String,
    /// Width and height of what the picture shows, metres: its lower edge is the foot of the wall.
    pub size_m: DVec2,
    /// The wall's outline in the picture, counter-clockwise, metres from its lower left corner; all of the picture if not given. Where its
    /// sides end are the eaves; what is higher is a gable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outline: Vec<DVec2>,
    /// Windows, doors and paintings, each of which is a small texture of level 2. Those that come later lie on the paintings before them: a
    /// window on its painted surround, an arch on its courses of stone.
    #[serde(default)]
    pub objects: Vec<FacadeObject>,
}

/// What is on a façade, metres from its lower left corner.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacadeObject {
    /// What it is.
    pub kind: FacadeObjectKind,
    /// Lower left corner of the first.
    pub low: DVec2,
    /// Width and height.
    pub size: DVec2,
    /// How it ends at the top.
    #[serde(default)]
    pub head: ObjectHead,
    /// How deep it lies in the wall; by its kind if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_m: Option<f64>,
    /// How it is repeated.
    #[serde(default)]
    pub repeat: ObjectRepeat,
}

/// An object side by side with itself, and one above the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectRepeat {
    /// How many side by side.
    pub columns: u8,
    /// How many above one another.
    pub rows: u8,
    /// From one to the next, to the right and up, metres.
    pub step: DVec2,
}

impl Default for ObjectRepeat {
    fn default() -> Self {
        Self { columns: 1, rows: 1, step: DVec2::ZERO }
    }
}

/// Kind of a [`FacadeObject`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum FacadeObjectKind {
    /// A window: glass behind the wall.
    Window,
    /// A door or gate behind the wall.
    Door,
    /// A shop front.
    Shop,
    /// Something painted or carved: no deeper than the wall.
    Painting,
}

impl FacadeObjectKind {
    /// How deep such an object lies in its wall, metres.
    #[must_use]
    pub const fn depth_m(self) -> f64 {
        match self {
            Self::Window => 0.2,
            Self::Door => 0.28,
            Self::Shop => 0.1,
            Self::Painting => 0.0,
        }
    }
}

/// How an object ends at the top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum ObjectHead {
    /// Straight lintel.
    #[default]
    Flat,
    /// Arc that rises by a fifth of the width.
    Segment,
    /// Half circle.
    Round,
}

/// What is wrong with a façade, with the fix.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FacadeError {
    /// Sizes that no wall has.
    #[error("size_m is {0}: width and height must be from 1 to {most} m", most = PaintedFacade::MOST_M)]
    Size(DVec2),
    /// An outline that is none.
    #[error("the outline must have at least three corners, all within the picture")]
    Outline,
    /// An object that does not lie in the picture.
    #[error("object {0} reaches out of the picture: mind low, size and repeat, which are metres")]
    Beyond(usize),
    /// An object that has no size.
    #[error("object {0} must be at least 0.1 m wide and high")]
    Small(usize),
    /// Depths that no wall has.
    #[error("object {0} lies {1} m deep: that must be from 0 to 1 m")]
    Depth(usize, f64),
    /// An object that covers another that is no painting.
    #[error("object {0} covers object {1}: only paintings may be covered, by what comes after them")]
    Covers(usize, usize),
    /// Too many objects.
    #[error("there are {0} objects, repeated ones counted: at most {most}", most = PaintedFacade::MOST_PLACES)]
    Many(usize),
}

impl FacadeDraft {
    /// Height of the eaves over the foot of the wall, metres: where the outline's sides end.
    #[must_use]
    pub fn eaves_m(&self) -> f64 {
        let side = |x: f64| {
            let on = self.outline.iter().filter(|p| (p.x - x).abs() < 0.05).map(|p| p.y);
            on.fold(f64::NEG_INFINITY, f64::max)
        };
        let lower = side(0.0).min(side(self.size_m.x));
        if lower > 0.5 { lower } else { self.size_m.y }
    }

    /// All mistakes.
    #[must_use]
    pub fn validate(&self) -> Vec<FacadeError> {
        let within = |of: DVec2| of.cmpge(DVec2::splat(1.0)).all() && of.cmple(DVec2::splat(PaintedFacade::MOST_M)).all();
        if !within(self.size_m) {
            return vec![FacadeError::Size(self.size_m)];
        }
        let mut errors = Vec::new();
        // A picture is never measured to the millimetre.
        let slack = DVec2::splat(0.01);
        let holds = |p: DVec2| p.cmpge(-slack).all() && p.cmple(self.size_m + slack).all();
        if !self.outline.is_empty() && (self.outline.len() < 3 || !self.outline.iter().all(|&p| holds(p))) {
            errors.push(FacadeError::Outline);
        }
        let count = self.objects.iter().map(|object| usize::from(object.repeat.columns) * usize::from(object.repeat.rows)).sum();
        if count > PaintedFacade::MOST_PLACES || self.objects.len() > PaintedFacade::MOST_TEXTURES {
            return [errors, vec![FacadeError::Many(count)]].concat();
        }
        for (n, object) in self.objects.iter().enumerate() {
            let places: Vec<DVec2> = object.places().collect();
            if !(object.size.x >= 0.1 && object.size.y >= 0.1) || places.is_empty() {
                errors.push(FacadeError::Small(n));
            } else if !places.iter().all(|&low| holds(low) && holds(low + object.size)) {
                errors.push(FacadeError::Beyond(n));
            }
            if !object.depth_m.is_none_or(|depth| (0.0..=1.0).contains(&depth)) {
                errors.push(FacadeError::Depth(n, object.depth_m.unwrap_or_default()));
            }
            let covers = |other: &FacadeObject| {
                if other.is_flat() {
                    return false;
                }
                let apart =
                    |a: DVec2, b: DVec2| (a + object.size).cmple(b + 0.001).any() || (b + other.size).cmple(a + 0.001).any();
                places.iter().any(|&a| other.places().any(|b| !apart(a, b)))
            };
            errors.extend(self.objects[..n].iter().position(covers).map(|other| FacadeError::Covers(n, other)));
        }
        errors
    }
}

impl FacadeObject {
    /// Whether it is painted on the wall, so that other objects may lie on it.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.kind == FacadeObjectKind::Painting && self.depth_m.is_none_or(|depth| depth == 0.0)
    }

    /// Lower left corners of all its repetitions, row by row.
    pub fn places(&self) -> impl Iterator<Item = DVec2> + '_ {
        let ObjectRepeat { columns, rows, step } = self.repeat;
        (0..rows).flat_map(move |row| (0..columns).map(move |column| self.low + step * DVec2::new(column.into(), row.into())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draft() -> FacadeDraft {
        let window = FacadeObject {
            kind: FacadeObjectKind::Window,
            low: DVec2::new(1.0, 5.0),
            size: DVec2::new(1.0, 2.0),
            head: ObjectHead::Flat,
            depth_m: None,
            repeat: ObjectRepeat { columns: 3, rows: 2, step: DVec2::new(3.0, 4.0) },
        };
        let size_m = DVec2::new(10.0, 14.0);
        FacadeDraft { name: "test".into(), picture: "test.png".into(), size_m, outline: Vec::new(), objects: vec![window] }
    }

    #[test]
    fn each_mistake_has_its_words() {
        assert_eq!(draft().validate(), []);
        let told = |spoil: fn(&mut FacadeDraft)| {
            let mut draft = draft();
            spoil(&mut draft);
            draft.validate().iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        };
        assert!(told(|d| d.size_m.x = f64::NAN).starts_with("size_m is"));
        assert!(told(|d| d.outline = vec![DVec2::ZERO; 2]).contains("three corners"));
        assert!(told(|d| d.objects[0].repeat.columns = 4).starts_with("object 0 reaches out of the picture"));
        assert!(told(|d| d.objects[0].size.y = 0.0).starts_with("object 0 must be at least 0.1 m"));
        assert!(told(|d| d.objects[0].depth_m = Some(3.0)).starts_with("object 0 lies 3 m deep"));
        assert!(
            told(|d| d.objects.push(FacadeObject { repeat: ObjectRepeat::default(), ..d.objects[0] })).contains("covers object 0")
        );
        // A painting over windows hides them; below them it is their surround.
        let painting = |d: &FacadeDraft| FacadeObject { kind: FacadeObjectKind::Painting, ..d.objects[0] };
        assert!(
            told(|d| d.objects.push(FacadeObject { kind: FacadeObjectKind::Painting, ..d.objects[0] })).contains("covers object 0")
        );
        let below = FacadeDraft { objects: vec![painting(&draft()), draft().objects[0]], ..draft() };
        assert_eq!(below.validate(), []);
        assert!(told(|d| d.objects = vec![d.objects[0]; 65]).starts_with("there are 390 objects"));
    }

    #[test]
    fn eaves_are_where_the_sides_end() {
        let gabled = [(0.0, 0.0), (10.0, 0.0), (10.0, 9.5), (5.0, 14.0), (0.0, 9.0)].map(DVec2::from);
        assert_eq!(FacadeDraft { outline: gabled.to_vec(), ..draft() }.eaves_m(), 9.0);
        assert_eq!(draft().eaves_m(), 14.0);
    }
}
