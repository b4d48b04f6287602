use std::collections::BTreeMap;

use super::design::{Content, DEEPEST, Design, DesignError, MOST_COPIES, MOST_PIECES, Material, Piece, Repeat};
use super::formula::Formula;
use super::shape::{Shape, Unit};
use super::{Monument, Monuments, Part};
use crate::{GRID_PER_METRE, HIGHEST_M};

/// Most points of one line.
const MOST_POINTS: usize = 1_000;
/// Steps of a ratio, and hundredths of a degree.
const RATIO: f64 = 1024.0;
const HUNDREDTHS: f64 = 100.0;

/// What is wrong with a monument.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MonumentError {
    /// There is no such monument.
    #[error("there is no monument `{name}`; there are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// Two monuments share a name.
    #[error("two monuments are called `{0}`")]
    Twice(String),
    /// A parameter that the monument does not have.
    #[error("monument `{monument}` has no parameter `{name}`; it has: {known}")]
    Parameter {
        /// Which monument.
        monument: String,
        /// What it was told.
        name: String,
        /// What it takes.
        known: String,
    },
    /// Something in a part.
    #[error("monument `{monument}`, {place}: {message}")]
    Part {
        /// Which monument.
        monument: String,
        /// Which part, counted from 1 within each list, and field.
        place: String,
        /// What is wrong.
        message: String,
    },
    /// It cannot be drawn.
    #[error("monument `{monument}`: {error}")]
    Design {
        /// Which monument.
        monument: String,
        /// Why.
        error: DesignError,
    },
}

impl Monuments {
    /// A monument by name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Monument> {
        self.0.iter().find(|monument| monument.name == name)
    }

    /// Everything wrong with the monuments, each tried with its own parameters; empty if growth may take them.
    #[must_use]
    pub fn validate(&self) -> Vec<MonumentError> {
        let mut errors = Vec::new();
        for (i, monument) in self.0.iter().enumerate() {
            if self.0[..i].iter().any(|other| other.name == monument.name) {
                errors.push(MonumentError::Twice(monument.name.clone()));
            }
            errors.extend(self.design(&monument.name, &BTreeMap::new()).err());
        }
        errors
    }

    /// A monument with its formulas worked out.
    ///
    /// # Errors
    /// [`MonumentError`] if there is no such monument or parameter, or something in it cannot be.
    pub fn design(&self, name: &str, with: &BTreeMap<String, f64>) -> Result<Design, MonumentError> {
        let design = Design { name: name.to_owned(), ..Design::default() };
        let mut resolver = Resolver { stock: self, within: Vec::new(), design };
        resolver.monument(name, with, &BTreeMap::new())?;
        let design = resolver.design.told_once();
        design.check().map_err(|error| MonumentError::Design { monument: name.to_owned(), error })?;
        Ok(design)
    }
}

struct Resolver<'a> {
    stock: &'a Monuments,
    /// Names of the monuments that are being worked out, outermost first.
    within: Vec<&'a str>,
    design: Design,
}

/// What a monument's parts may refer to.
struct Scope<'a> {
    monument: &'a Monument,
    values: BTreeMap<&'a str, f64>,
    paints: BTreeMap<&'a str, Material>,
}

/// Where in a monument, for errors: numbers of parts from the outermost on.
#[derive(Clone)]
struct Place(Vec<usize>, &'static str);

impl Scope<'_> {
    fn error(&self, place: &Place, field: &str, message: impl Into<String>) -> MonumentError {
        let numbers: Vec<String> = place.0.iter().map(ToString::to_string).collect();
        let what = if place.1.is_empty() { String::new() } else { format!(" ({})", place.1) };
        let part = if numbers.is_empty() { String::new() } else { format!("part {}{what}, ", numbers.join(".")) };
        MonumentError::Part { monument: self.monument.name.clone(), place: format!("{part}`{field}`"), message: message.into() }
    }

    fn value(&self, place: &Place, field: &str, formula: &Formula) -> Result<f64, MonumentError> {
        let value = formula.value(&|name| self.values.get(name).copied()).map_err(|name| {
            let known: Vec<&str> = self.values.keys().copied().collect();
            self.error(place, field, format!("there is no `{name}` in `{formula}`; there are: {}", known.join(", ")))
        })?;
        if value.is_finite() { Ok(value) } else { Err(self.error(place, field, format!("`{formula}` is {value}"))) }
    }

    fn whole(&self, place: &Place, field: &str, unit: Unit, formula: &Formula) -> Result<i32, MonumentError> {
        let value = self.value(place, field, formula)?;
        let told = |message: String| Err(self.error(place, field, message));
        match unit {
            Unit::Length if value.abs() > HIGHEST_M => told(format!("{value} m is more than {HIGHEST_M} m")),
            Unit::Length => Ok(libm::round(value * f64::from(GRID_PER_METRE)) as i32),
            Unit::Angle if value.abs() > 3600.0 => told(format!("{value}° is more than ten turns")),
            Unit::Angle => Ok(libm::round(value * HUNDREDTHS) as i32),
            Unit::Ratio if value.abs() > 100.0 => told(format!("{value} is more than 100")),
            Unit::Ratio => Ok(libm::round(value * RATIO) as i32),
            Unit::Count if !(0.0..=f64::from(MOST_COPIES)).contains(&value) => {
                told(format!("{value} is not a number of things from 0 to {MOST_COPIES}"))
            }
            Unit::Count => Ok(libm::round(value) as i32),
        }
    }

    fn three(&self, place: &Place, field: &str, unit: Unit, [x, y, z]: &[Formula; 3]) -> Result<[i32; 3], MonumentError> {
        let whole = |of| self.whole(place, field, unit, of);
        Ok([whole(x)?, whole(y)?, whole(z)?])
    }
}

impl<'a> Resolver<'a> {
    fn monument(
        &mut self,
        name: &str,
        with: &BTreeMap<String, f64>,
        paints: &BTreeMap<String, Material>,
    ) -> Result<(), MonumentError> {
        let names = |all: &mut dyn Iterator<Item = &str>| all.collect::<Vec<_>>().join(", ");
        let library = self.stock;
        let Some(monument) = library.find(name) else {
            let known = names(&mut library.0.iter().map(|m| m.name.as_str()));
            return Err(MonumentError::Unknown { name: name.to_owned(), known });
        };
        let mut scope = Scope { monument, values: BTreeMap::new(), paints: BTreeMap::new() };
        let top = Place(Vec::new(), "");
        if self.within.contains(&monument.name.as_str()) {
            return Err(scope.error(&top, "parts", "it is used by itself"));
        }
        for (parameter, default) in &monument.parameters {
            let told = with.get(parameter).copied().unwrap_or(*default);
            if !told.is_finite() {
                return Err(scope.error(&top, parameter, format!("{told} is no number")));
            }
            scope.values.insert(parameter, told);
        }
        if let Some(unknown) = with.keys().find(|told| !monument.parameters.contains_key(told.as_str())) {
            let known = names(&mut monument.parameters.keys().map(String::as_str));
            return Err(MonumentError::Parameter { monument: name.to_owned(), name: unknown.clone(), known });
        }
        for (value, formula) in &monument.values {
            let worked_out = scope.value(&top, value, formula)?;
            scope.values.insert(value, worked_out);
        }
        for (paint, material) in &monument.paints {
            scope.paints.insert(paint, paints.get(paint).copied().unwrap_or(*material));
        }
        self.within.push(&monument.name);
        self.parts(&scope, &top, &monument.parts, "")?;
        self.within.pop();
        Ok(())
    }

    fn parts(&mut self, scope: &Scope<'a>, within: &Place, parts: &'a [Part], paint: &str) -> Result<(), MonumentError> {
        for (i, part) in parts.iter().enumerate() {
            let mut place = within.clone();
            place.0.push(i + 1);
            place.1 = part.shape.as_ref().map_or("", Shape::name);
            self.part(scope, &place, part, paint)?;
        }
        Ok(())
    }

    fn part(&mut self, scope: &Scope<'a>, place: &Place, part: &'a Part, paint: &str) -> Result<(), MonumentError> {
        if place.0.len() + self.within.len() > DEEPEST {
            return Err(scope.error(place, "parts", format!("nested more than {DEEPEST} deep")));
        }
        if let Some(when) = &part.when
            && scope.value(place, "when", when)? <= 0.0
        {
            return Ok(());
        }
        let repeat = part.repeat.as_ref().map(|repeat| repetition(scope, place, repeat)).transpose()?;
        if repeat.is_some_and(|repeat| *repeat.count() == 0) {
            return Ok(());
        }
        let paint = if part.paint.is_empty() { paint } else { &part.paint };
        let content = match (&part.shape, &part.uses, &part.parts[..]) {
            (Some(shape), None, []) => Content::Shape(shape_of(scope, place, shape)?),
            (None, Some(_), []) | (None, None, [_, ..]) => Content::Group(0),
            _ => return Err(scope.error(place, "shape", "a part has one of `shape`, `uses` and `parts`")),
        };
        let is_shape = matches!(content, Content::Shape(_));
        let infill = match part.infill.as_str() {
            "" => None,
            infill => Some(self.paint(scope, place, "infill", infill)?),
        };
        let piece = Piece {
            at: scope.three(place, "at", Unit::Length, &part.at)?,
            turn: [
                scope.whole(place, "tilt_deg", Unit::Angle, &part.tilt_deg)?,
                scope.whole(place, "roll_deg", Unit::Angle, &part.roll_deg)?,
                scope.whole(place, "turn_deg", Unit::Angle, &part.turn_deg)?,
            ],
            scale: scope.three(place, "scale", Unit::Ratio, &part.scale)?,
            mirror: part.mirror,
            repeat,
            paint: if is_shape { self.paint(scope, place, "paint", paint)? } else { 0 },
            infill,
            content,
        };
        let index = self.design.pieces.len();
        if index >= MOST_PIECES {
            return Err(scope.error(place, "parts", DesignError::TooMany.to_string()));
        }
        self.design.pieces.push(piece);
        if !is_shape {
            match &part.uses {
                Some(uses) => self.uses(scope, place, uses, part)?,
                None => self.parts(scope, place, &part.parts, paint)?,
            }
            let inner = self.design.pieces.len() - index - 1;
            self.design.pieces[index].content = Content::Group(inner as u32);
        }
        Ok(())
    }

    fn uses(&mut self, scope: &Scope<'a>, place: &Place, uses: &'a str, part: &'a Part) -> Result<(), MonumentError> {
        let mut with = BTreeMap::new();
        for (name, formula) in &part.with {
            with.insert(name.clone(), scope.value(place, name, formula)?);
        }
        let mut paints = BTreeMap::new();
        for (theirs, ours) in &part.paints {
            let Some(&material) = scope.paints.get(ours.as_str()) else {
                return Err(scope.error(place, "paints", format!("there is no paint `{ours}`")));
            };
            paints.insert(theirs.clone(), material);
        }
        self.monument(uses, &with, &paints)
    }

    /// Index of a paint among the design's materials.
    fn paint(&mut self, scope: &Scope<'a>, place: &Place, field: &str, name: &str) -> Result<u8, MonumentError> {
        let Some(&material) = scope.paints.get(name) else {
            let known: Vec<&str> = scope.paints.keys().copied().collect();
            let message = format!("there is no paint `{name}`; there are: {}", known.join(", "));
            return Err(scope.error(place, field, message));
        };
        let found = self.design.materials.iter().position(|&m| m == material);
        let index = found.unwrap_or_else(|| {
            self.design.materials.push(material);
            self.design.materials.len() - 1
        });
        u8::try_from(index).map_err(|_| scope.error(place, field, "more than 256 materials"))
    }
}

fn shape_of(scope: &Scope<'_>, place: &Place, shape: &Shape<Formula>) -> Result<Shape<i32>, MonumentError> {
    let points = match shape {
        Shape::Lathe { profile: points, .. }
        | Shape::Extrusion { outline: points, .. }
        | Shape::Panel { outline: points, .. }
        | Shape::Sweep { along: points, .. }
        | Shape::Roof { outline: points, .. } => points.len(),
        Shape::Tube { path, .. } => path.len(),
        _ => 0,
    };
    if points > MOST_POINTS {
        return Err(scope.error(place, "shape", format!("{points} points are more than {MOST_POINTS}")));
    }
    shape.try_map(&mut |field, unit, formula| scope.whole(place, field, unit, formula))
}

fn repetition(scope: &Scope<'_>, place: &Place, repeat: &Repeat<Formula>) -> Result<Repeat<i32>, MonumentError> {
    let whole = |field, unit, formula| scope.whole(place, field, unit, formula);
    Ok(match repeat {
        Repeat::Row { count, step, centred } => Repeat::Row {
            count: whole("count", Unit::Count, count)?,
            step: scope.three(place, "step", Unit::Length, step)?,
            centred: *centred,
        },
        Repeat::Around { count, arc_deg, rise } => Repeat::Around {
            count: whole("count", Unit::Count, count)?,
            arc_deg: arc_deg.as_ref().map(|n| whole("arc_deg", Unit::Angle, n)).transpose()?,
            rise: rise.as_ref().map(|n| whole("rise", Unit::Length, n)).transpose()?,
        },
    })
}
