//! What every vector format comes down to: shapes with attributes.

use glam::DVec2;

/// Vertices in the layer's own coordinates, x before y.
pub(super) type Line = Vec<DVec2>;

/// Geometry of a feature. Rings repeat their first vertex at the end, or not; `is_inner` marks holes where the format tells.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Points(Vec<DVec2>),
    Lines(Vec<Line>),
    Rings(Vec<(Line, bool)>),
}

impl Shape {
    pub(super) fn positions(&self) -> Box<dyn Iterator<Item = DVec2> + '_> {
        match self {
            Self::Points(points) => Box::new(points.iter().copied()),
            Self::Lines(lines) => Box::new(lines.iter().flatten().copied()),
            Self::Rings(rings) => Box::new(rings.iter().flat_map(|(ring, _)| ring).copied()),
        }
    }
}

/// A feature of a layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Feature {
    /// The source's own name of it, may be empty.
    pub id: String,
    /// Name and value, in the file's order; nested values have dotted names.
    pub attributes: Vec<(String, String)>,
    /// Several only where shapes of several kinds were collected in one feature.
    pub shapes: Vec<Shape>,
}

impl Feature {
    /// The value of an attribute whatever the case of its name; blank ones count as not there.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(k, v)| k.eq_ignore_ascii_case(name) && !v.trim().is_empty());
        found.map(|(_, v)| v.trim())
    }

    /// The value of the first of several attributes that is there.
    pub(super) fn first_of<'a>(&'a self, names: &'a [String]) -> Option<(&'a str, &'a str)> {
        names.iter().find_map(|name| self.get(name).map(|value| (name.as_str(), value)))
    }
}

/// The content of a layer's file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Content {
    pub features: Vec<Feature>,
    /// How the file names its coordinate system, if it does.
    pub crs: Option<Named>,
    /// Whom the file itself credits, may be empty.
    pub attribution: String,
}

/// What a file says of its coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Named {
    /// A code or name, as GeoJSON of before 2016 gives it, or well-known text, as a `.prj` has it.
    Text(String),
    /// Plan metres about an anchor (latitude, longitude), if that is told.
    Plan(Option<veduta_city::Anchor>),
}
