use std::collections::BTreeMap;

use veduta_city::{Anchor, Id};

use crate::SurveyError;

/// Most nodes, ways, relations, references and members that are taken in together.
pub(crate) const MOST_ITEMS: u64 = 40_000_000;

/// Key and value pairs of an element, in the file's order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Tags(Vec<(Box<str>, Box<str>)>);

impl Tags {
    pub(crate) fn push(&mut self, key: &str, value: &str) {
        self.0.push((key.into(), value.into()));
    }

    pub(crate) fn extend(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
    }

    /// The value of a key.
    pub(crate) fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(k, _)| &**k == key).map(|(_, v)| &**v)
    }

    /// The value of the first of several keys that is there.
    pub(crate) fn first_of(&self, keys: &[&str]) -> Option<&str> {
        keys.iter().find_map(|key| self.get(key))
    }

    /// Whether a key has exactly this value.
    pub(crate) fn is(&self, key: &str, value: &str) -> bool {
        self.get(key) == Some(value)
    }

    /// Whether a key has one of these values.
    pub(crate) fn is_any(&self, key: &str, values: &[&str]) -> bool {
        self.get(key).is_some_and(|v| values.contains(&v))
    }

    /// Whether a key is there and does not say no.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.get(key).is_some_and(|v| v != "no")
    }

    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The text of a key, cleaned: no control characters, single plain spaces (maps hold no-break spaces), no ends blank.
    pub(crate) fn text(&self, key: &str) -> String {
        let plain: String = self.get(key).unwrap_or_default().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        plain.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

impl<'a> FromIterator<(&'a str, &'a str)> for Tags {
    fn from_iter<I: IntoIterator<Item = (&'a str, &'a str)>>(pairs: I) -> Self {
        Self(pairs.into_iter().map(|(k, v)| (k.into(), v.into())).collect())
    }
}

/// Numbers of elements up to this are hashes of kind and place: those of sources that number nothing, with the two top bits
/// of a hash. OSM's own, also those that editors give to new things, are all above.
const LAST_HASH: i64 = -(1 << 62) - 1;

/// The number of an element that has none, from what it is and where.
pub(crate) fn number_from_place(kind: &str, plan_pos: glam::DVec2) -> i64 {
    (Id::from_place(kind, plan_pos).0 & !(1 << 62)) as i64
}

/// Id of the way of a number.
pub(crate) fn way_id(number: i64) -> Id {
    id_of(2, number)
}

/// Id of the relation of a number.
pub(crate) fn relation_id(number: i64) -> Id {
    id_of(3, number)
}

fn id_of(kind: u8, number: i64) -> Id {
    if number <= LAST_HASH { Id(number as u64) } else { Id::from_source(kind, number as u64) }
}

/// A point on Earth, perhaps with tags.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    /// Degrees north.
    pub lat: f64,
    /// Degrees east.
    pub lon: f64,
    pub tags: Tags,
}

/// A polyline through nodes.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Way {
    pub nodes: Vec<i64>,
    pub tags: Tags,
}

impl Way {
    pub(crate) fn is_closed(&self) -> bool {
        self.nodes.len() > 3 && self.nodes.first() == self.nodes.last()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MemberKind {
    Node,
    Way,
    Relation,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Member {
    pub kind: MemberKind,
    pub id: i64,
    pub role: Box<str>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Relation {
    pub members: Vec<Member>,
    pub tags: Tags,
}

/// Corners of a box in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    pub south: f64,
    pub west: f64,
    pub north: f64,
    pub east: f64,
}

/// What a file holds, whatever its format: sorted by id, so that all that follows is in one order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct OsmData {
    pub bounds: Option<Bounds>,
    /// Where plan (0, 0) lies, if the file says so.
    pub anchor: Option<Anchor>,
    pub nodes: BTreeMap<i64, Node>,
    pub ways: BTreeMap<i64, Way>,
    pub relations: BTreeMap<i64, Relation>,
    /// Nodes that say no position on Earth.
    pub unplaced: Vec<i64>,
    /// How much was taken in.
    pub items: u64,
}

impl OsmData {
    /// Counts items taken in; an error once there are too many.
    pub(crate) fn admit(&mut self, more: usize, name: &str) -> Result<(), SurveyError> {
        self.items = self.items.saturating_add(more as u64);
        if self.items > MOST_ITEMS {
            return Err(SurveyError::TooLarge {
                name: name.to_owned(),
                what: "nodes, ways, relations and references",
                limit: MOST_ITEMS,
            });
        }
        Ok(())
    }

    /// Takes a node in. A position that is not on Earth is remembered as missing.
    pub(crate) fn add_node(&mut self, id: i64, lat: f64, lon: f64, tags: Tags) {
        if lat.abs() <= 90.0 && lon.abs() <= 180.0 {
            self.nodes.insert(id, Node { lat, lon, tags });
        } else {
            self.unplaced.push(id);
        }
    }

    /// The id of the node at a position that came without one (Overpass' `out geom`): the same position, the same id. Such
    /// ids are negative and far from those that editors give to new things.
    pub(crate) fn node_at(&mut self, lat: f64, lon: f64) -> Option<i64> {
        if !(lat.abs() <= 90.0 && lon.abs() <= 180.0) {
            return None;
        }
        let steps = |degrees: f64| libm::round(degrees * 1e7) as i64;
        let id = -1 - (steps(lat + 90.0) << 32 | steps(lon + 180.0));
        self.nodes.entry(id).or_insert_with(|| Node { lat, lon, tags: Tags::default() });
        Some(id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_cleaned() {
        let tags: Tags = [("name", " V\u{a0}Lesíčku\n")].into_iter().collect();
        assert_eq!(tags.text("name"), "V Lesíčku");
        assert_eq!(tags.text("nothing"), "");
    }

    #[test]
    fn positions_without_ids_are_one_node_each() {
        let mut data = OsmData::default();
        let a = data.node_at(48.1, 11.5).unwrap();
        assert_eq!(data.node_at(48.1, 11.5), Some(a));
        assert_ne!(data.node_at(48.1, 11.500_000_1), Some(a));
        assert_ne!(data.node_at(-48.1, -11.5), Some(a));
        assert_eq!(data.node_at(f64::NAN, 0.0), None);
        assert_eq!(data.nodes.len(), 3);
    }

    #[test]
    fn elements_without_a_number_are_named_by_their_place() {
        let number = number_from_place("street", glam::DVec2::new(3.0, 4.0));
        assert!(number <= LAST_HASH && way_id(number).0 >> 62 == 2, "{number}");
        assert_eq!(way_id(number), relation_id(number));
        assert_eq!((way_id(7), way_id(-7)), (Id::from_source(2, 7), Id::from_source(2, -7_i64 as u64)));
    }

    #[test]
    fn a_node_off_the_earth_is_remembered_as_unplaced() {
        let mut data = OsmData::default();
        data.add_node(7, 91.0, 0.0, Tags::default());
        assert_eq!((data.nodes.len(), data.unplaced.as_slice()), (0, &[7][..]));
    }
}
