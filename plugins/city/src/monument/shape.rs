use core::fmt;
use core::marker::PhantomData;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser::SerializeTuple};

use crate::RoofShape;

/// A solid that monuments are put together from. `N` is a [`Formula`](super::Formula) where a person writes it, and a whole
/// number in a [`Design`](super::Design), by the field's [`Unit`].
///
/// A shape stands on its own origin: x to the right of who looks at its front, y away from them, z up.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Shape<N> {
    /// A box.
    Box {
        /// Width, depth and height; its foot's middle is the origin.
        size: [N; 3],
    },
    /// An upright cylinder or prism; with another radius at its top, a frustum.
    Cylinder {
        /// To the middles of its sides, metres.
        radius: N,
        /// Metres.
        height: N,
        /// Radius at its top, if another.
        #[serde(default = "none")]
        top: Option<N>,
        /// Number of sides, one of which looks to the front; round without.
        #[serde(default = "none")]
        sides: Option<N>,
    },
    /// A cone or pyramid.
    Cone {
        /// To the middles of its sides, metres.
        radius: N,
        /// Metres.
        height: N,
        /// Number of sides; round without.
        #[serde(default = "none")]
        sides: Option<N>,
    },
    /// A ball that lies on the origin.
    Sphere {
        /// Metres.
        radius: N,
    },
    /// A profile turned about the upright axis.
    Lathe {
        /// From the foot up, `(radius, height)`; the body lies on the left of its way.
        profile: Vec<PathPoint<N>>,
        /// Number of sides; round without.
        #[serde(default = "none")]
        sides: Option<N>,
    },
    /// An outline in plan, drawn upwards.
    Extrusion {
        /// Counter-clockwise, `(x, y)`.
        outline: Vec<PathPoint<N>>,
        /// What is cut out of it.
        #[serde(default = "Vec::new")]
        holes: Vec<Hole<N>>,
        /// Metres.
        height: N,
    },
    /// An outline in elevation, drawn away from the viewer: a wall, a gable, tracery.
    Panel {
        /// Counter-clockwise as seen from the front, `(x, z)`.
        outline: Vec<PathPoint<N>>,
        /// What is cut out of it; filled behind with the part's `infill`, if it has one.
        #[serde(default = "Vec::new")]
        holes: Vec<Hole<N>>,
        /// From its front, at y = 0, to its back; metres.
        depth: N,
        /// How far behind the front the infill lies; half the depth without.
        #[serde(default = "none")]
        reveal: Option<N>,
    },
    /// A section drawn along a line in plan: cornices, steps, copings, archivolts.
    Sweep {
        /// `(out, up)`: out of the line's right-hand side, which is outside of a counter-clockwise ring. From the foot up.
        section: Vec<PathPoint<N>>,
        /// `(x, y)`.
        along: Vec<PathPoint<N>>,
        /// Whether the line returns to its start.
        #[serde(default)]
        closed: bool,
    },
    /// A round bar of changing thickness along a line in space: ribs, limbs, leaves, railings.
    Tube {
        /// `(x, y, z, radius)`.
        path: Vec<[N; 4]>,
        /// Number of sides; round without.
        #[serde(default = "none")]
        sides: Option<N>,
    },
    /// The underside of a vault, springing at z = 0.
    Vault {
        /// Width and length (along y).
        size: [N; 2],
        /// Metres.
        rise: N,
        /// Its curve.
        #[serde(default)]
        head: Head,
        /// Two vaults that cross, in place of one along y.
        #[serde(default)]
        cross: bool,
    },
    /// A roof over an outline, whose eaves lie at z = 0; its gables are closed with the part's `infill`.
    Roof {
        /// Counter-clockwise, `(x, y)`.
        outline: Vec<PathPoint<N>>,
        /// Shape.
        shape: RoofShape,
        /// Eaves to ridge, metres.
        height: N,
        /// The way the ridge runs, or the way down of a skillion; whole degrees clockwise from y.
        #[serde(default = "none")]
        direction_deg: Option<N>,
    },
}

/// A field that may be left out. (What serde would assume asks for `N: Default`.)
const fn none<N>() -> Option<N> {
    None
}

/// How an opening or a vault ends above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Head {
    /// Level.
    Flat,
    /// Half a circle (over a vault: half an ellipse).
    #[default]
    Round,
    /// Two arcs, each about the other's foot.
    Pointed,
    /// A flat arc, a sixth of the width high.
    Segmental,
}

/// What is cut out of an outline.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hole<N> {
    /// Where its origin lies in the outline.
    pub at: [N; 2],
    /// Its own outline.
    pub shape: HoleShape<N>,
    /// Number of such holes in a row, and the step from one to the next.
    #[serde(default = "none")]
    pub row: Option<(N, [N; 2])>,
    /// Number of such holes in a ring about `at`, and the ring's radius; each one's top looks outwards.
    #[serde(default = "none")]
    pub around: Option<(N, N)>,
}

/// Outline of a hole.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum HoleShape<N> {
    /// Width and height; its origin is the middle of its foot.
    Rect(N, N),
    /// Width and whole height; its origin is the middle of its foot.
    Arch(N, N, Head),
    /// Radius; its origin is its middle.
    Circle(N),
    /// Radius and number of lobes: trefoil, quatrefoil; its origin is its middle.
    Foil(N, N),
    /// Counter-clockwise about its origin.
    Outline(Vec<PathPoint<N>>),
}

/// A point of a line in a plane, and how the line comes to it. Written `(x, y)`, or `(x, y, bulge)` where it comes in an arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PathPoint<N> {
    /// Metres.
    pub pos: [N; 2],
    /// Rise of the arc that leads here over half its chord: 0 straight, 0.414 a quarter circle, 1 half a circle. An arc with a
    /// positive bulge turns left: it bulges out of a counter-clockwise outline.
    pub bulge: Option<N>,
}

/// What a number of a shape is, and the whole number that stands for it in a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Metres; steps of the grid.
    Length,
    /// Degrees; hundredths.
    Angle,
    /// A number of things; itself.
    Count,
    /// A ratio; 1/1024.
    Ratio,
}

impl<N> Shape<N> {
    /// The same shape of other numbers; `f` is told the field that it turns and its unit.
    ///
    /// # Errors
    /// The first that `f` tells.
    pub fn try_map<M, E>(&self, f: &mut impl FnMut(&'static str, Unit, &N) -> Result<M, E>) -> Result<Shape<M>, E> {
        use Unit::{Angle, Count, Length};
        Ok(match self {
            Self::Box { size: [x, y, z] } => {
                Shape::Box { size: [f("size", Length, x)?, f("size", Length, y)?, f("size", Length, z)?] }
            }
            Self::Cylinder { radius, height, top, sides } => Shape::Cylinder {
                radius: f("radius", Length, radius)?,
                height: f("height", Length, height)?,
                top: top.as_ref().map(|n| f("top", Length, n)).transpose()?,
                sides: sides.as_ref().map(|n| f("sides", Count, n)).transpose()?,
            },
            Self::Cone { radius, height, sides } => Shape::Cone {
                radius: f("radius", Length, radius)?,
                height: f("height", Length, height)?,
                sides: sides.as_ref().map(|n| f("sides", Count, n)).transpose()?,
            },
            Self::Sphere { radius } => Shape::Sphere { radius: f("radius", Length, radius)? },
            Self::Lathe { profile, sides } => Shape::Lathe {
                profile: path(f, "profile", profile)?,
                sides: sides.as_ref().map(|n| f("sides", Count, n)).transpose()?,
            },
            Self::Extrusion { outline, holes, height } => Shape::Extrusion {
                outline: path(f, "outline", outline)?,
                holes: holes.iter().map(|hole| hole.try_map(f)).collect::<Result<_, _>>()?,
                height: f("height", Length, height)?,
            },
            Self::Panel { outline, holes, depth, reveal } => Shape::Panel {
                outline: path(f, "outline", outline)?,
                holes: holes.iter().map(|hole| hole.try_map(f)).collect::<Result<_, _>>()?,
                depth: f("depth", Length, depth)?,
                reveal: reveal.as_ref().map(|n| f("reveal", Length, n)).transpose()?,
            },
            Self::Sweep { section, along, closed } => {
                Shape::Sweep { section: path(f, "section", section)?, along: path(f, "along", along)?, closed: *closed }
            }
            Self::Tube { path, sides } => Shape::Tube {
                path: path
                    .iter()
                    .map(|[x, y, z, r]| {
                        let mut length = |n| f("path", Length, n);
                        Ok([length(x)?, length(y)?, length(z)?, length(r)?])
                    })
                    .collect::<Result<_, _>>()?,
                sides: sides.as_ref().map(|n| f("sides", Count, n)).transpose()?,
            },
            Self::Vault { size, rise, head, cross } => {
                Shape::Vault { size: two(f, "size", size)?, rise: f("rise", Length, rise)?, head: *head, cross: *cross }
            }
            Self::Roof { outline, shape, height, direction_deg } => Shape::Roof {
                outline: path(f, "outline", outline)?,
                shape: *shape,
                height: f("height", Length, height)?,
                direction_deg: direction_deg.as_ref().map(|n| f("direction_deg", Angle, n)).transpose()?,
            },
        })
    }

    /// What it is called in a file.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Box { .. } => "Box",
            Self::Cylinder { .. } => "Cylinder",
            Self::Cone { .. } => "Cone",
            Self::Sphere { .. } => "Sphere",
            Self::Lathe { .. } => "Lathe",
            Self::Extrusion { .. } => "Extrusion",
            Self::Panel { .. } => "Panel",
            Self::Sweep { .. } => "Sweep",
            Self::Tube { .. } => "Tube",
            Self::Vault { .. } => "Vault",
            Self::Roof { .. } => "Roof",
        }
    }
}

impl Shape<i32> {
    /// A bound on the number of its faces, made as finely as ever.
    #[must_use]
    pub fn most_faces(&self) -> u64 {
        // An arc comes to 48 chords at most.
        let points = |line: &[PathPoint<i32>]| line.iter().map(|p| if p.bulge.is_some() { 48 } else { 1 }).sum::<u64>();
        // Fewer than three sides stand for round ones.
        let around = |sides: Option<i32>| sides.filter(|&n| n >= 3).map_or(48, |sides| u64::from(sides.unsigned_abs()));
        let plate = |outline: &[PathPoint<i32>], holes: &[Hole<i32>]| {
            // Holes are compared with one another and cut together.
            let in_holes = holes.iter().map(Hole::most_points).fold(0, u64::saturating_add);
            let all = points(outline).saturating_add(in_holes);
            all.saturating_mul(4).saturating_add(all.saturating_mul(in_holes) / 1024)
        };
        match self {
            Self::Box { .. } => 6,
            Self::Cylinder { sides, .. } | Self::Cone { sides, .. } => 3 * around(*sides),
            Self::Sphere { .. } => 48 * 24,
            Self::Lathe { profile, sides } => (points(profile) + 2) * around(*sides),
            Self::Extrusion { outline, holes, .. } | Self::Panel { outline, holes, .. } => plate(outline, holes),
            Self::Sweep { section, along, .. } => (points(section) + 1) * (points(along) + 1),
            Self::Tube { path, sides } => (path.len() as u64 + 2) * around(*sides),
            Self::Vault { .. } => 4 * 32,
            Self::Roof { outline, .. } => 70 * points(outline),
        }
    }
}

impl Hole<i32> {
    fn most_points(&self) -> u64 {
        let one = match &self.shape {
            HoleShape::Rect(..) => 4,
            HoleShape::Arch(..) | HoleShape::Circle(_) => 50,
            HoleShape::Foil(_, lobes) => 48 * u64::from(lobes.unsigned_abs().max(2)),
            HoleShape::Outline(outline) => 48 * outline.len() as u64,
        };
        let times = |count: Option<i32>| count.map_or(1, |count| u64::from(count.unsigned_abs()));
        one.saturating_mul(times(self.row.map(|row| row.0))).saturating_mul(times(self.around.map(|around| around.0)))
    }
}

impl<N> Hole<N> {
    fn try_map<M, E>(&self, f: &mut impl FnMut(&'static str, Unit, &N) -> Result<M, E>) -> Result<Hole<M>, E> {
        use Unit::{Count, Length};
        let shape = match &self.shape {
            HoleShape::Rect(width, height) => HoleShape::Rect(f("holes", Length, width)?, f("holes", Length, height)?),
            HoleShape::Arch(width, height, head) => HoleShape::Arch(f("holes", Length, width)?, f("holes", Length, height)?, *head),
            HoleShape::Circle(radius) => HoleShape::Circle(f("holes", Length, radius)?),
            HoleShape::Foil(radius, lobes) => HoleShape::Foil(f("holes", Length, radius)?, f("holes", Count, lobes)?),
            HoleShape::Outline(outline) => HoleShape::Outline(path(f, "holes", outline)?),
        };
        let row = self.row.as_ref().map(|(count, step)| Ok((f("row", Count, count)?, two(f, "row", step)?)));
        let around = self.around.as_ref().map(|(count, radius)| Ok((f("around", Count, count)?, f("around", Length, radius)?)));
        Ok(Hole { at: two(f, "at", &self.at)?, shape, row: row.transpose()?, around: around.transpose()? })
    }
}

/// Lengths.
fn two<N, M, E>(
    f: &mut impl FnMut(&'static str, Unit, &N) -> Result<M, E>,
    field: &'static str,
    [a, b]: &[N; 2],
) -> Result<[M; 2], E> {
    Ok([f(field, Unit::Length, a)?, f(field, Unit::Length, b)?])
}

fn path<N, M, E>(
    f: &mut impl FnMut(&'static str, Unit, &N) -> Result<M, E>,
    field: &'static str,
    of: &[PathPoint<N>],
) -> Result<Vec<PathPoint<M>>, E> {
    let point = |point: &PathPoint<N>| {
        let bulge = point.bulge.as_ref().map(|n| f(field, Unit::Ratio, n)).transpose()?;
        Ok(PathPoint { pos: two(f, field, &point.pos)?, bulge })
    };
    of.iter().map(point).collect()
}

impl<N: Serialize> Serialize for PathPoint<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [x, y] = &self.pos;
        if !serializer.is_human_readable() {
            return (x, y, &self.bulge).serialize(serializer);
        }
        let mut tuple = serializer.serialize_tuple(2 + usize::from(self.bulge.is_some()))?;
        tuple.serialize_element(x)?;
        tuple.serialize_element(y)?;
        self.bulge.iter().try_for_each(|bulge| tuple.serialize_element(bulge))?;
        tuple.end()
    }
}

impl<'de, N: Deserialize<'de>> Deserialize<'de> for PathPoint<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor<N>(PhantomData<N>);
        impl<'de, N: Deserialize<'de>> de::Visitor<'de> for Visitor<N> {
            type Value = PathPoint<N>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a point (x, y), or (x, y, bulge) where an arc leads to it")
            }

            fn visit_seq<A: de::SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let x = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(0, &self))?;
                let y = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(1, &self))?;
                Ok(PathPoint { pos: [x, y], bulge: seq.next_element()? })
            }
        }
        if deserializer.is_human_readable() {
            return deserializer.deserialize_tuple(3, Visitor(PhantomData));
        }
        let (x, y, bulge) = Deserialize::deserialize(deserializer)?;
        Ok(Self { pos: [x, y], bulge })
    }
}
