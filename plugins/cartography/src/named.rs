use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use veduta_city::{GridPos, Overview, Place, PlaceKind, SurfaceKind, metres};

use crate::landmark::LANDMARK_M;
use crate::{Landmark, Mark, NameKind, StreetLine, Symbol, Tone, Wanted, join_streets, landmarks};

/// Which of its layers a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layers {
    /// Names of streets, squares, water and parks.
    pub names: bool,
    /// Sights and houses of note, with their names.
    pub places: bool,
    /// Spots with a view.
    pub views: bool,
    /// Landmarks as small pictures.
    pub landmarks: bool,
    /// Trees.
    pub trees: bool,
    /// The way that somebody is led.
    pub route: bool,
    /// Where a tour leads.
    pub tour: bool,
    /// Where the visitor has been.
    pub trail: bool,
}

impl Layers {
    /// All of them.
    pub const ALL: Self =
        Self { names: true, places: true, views: true, landmarks: true, trees: true, route: true, tour: true, trail: true };
    /// None: ground and houses alone.
    pub const NONE: Self =
        Self { names: false, places: false, views: false, landmarks: false, trees: false, route: false, tour: false, trail: false };
    /// What they are called.
    pub const CALLED: [&'static str; 8] = ["names", "places", "views", "landmarks", "trees", "route", "tour", "trail"];

    /// The layer of a name, to be switched; `None` if there is none.
    pub fn of(&mut self, called: &str) -> Option<&mut bool> {
        Some(match called {
            "names" => &mut self.names,
            "places" => &mut self.places,
            "views" => &mut self.views,
            "landmarks" => &mut self.landmarks,
            "trees" => &mut self.trees,
            "route" => &mut self.route,
            "tour" => &mut self.tour,
            "trail" => &mut self.trail,
            _ => return None,
        })
    }
}

/// Streets longer than this in all are no squares, metres.
const LONGEST_SQUARE_M: f64 = 220.0;

/// What of a city there is to be named on maps, made once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named {
    /// Streets.
    pub streets: Vec<StreetLine>,
    /// Places.
    pub marks: Vec<Mark>,
    /// Landmarks, the highest first, with their names as they are written.
    pub landmarks: Vec<(Landmark, String)>,
}

impl Named {
    /// Of the parts of an overview, with names as they are written in the map's language.
    #[must_use]
    pub fn of<'a>(parts: impl IntoIterator<Item = &'a Overview> + Clone, written: &dyn Fn(&str) -> String) -> Self {
        let streets = join_streets(parts.clone().into_iter().flat_map(|part| &part.streets));
        let mut long: BTreeMap<&str, f64> = BTreeMap::new();
        for street in &streets {
            *long.entry(&street.name).or_default() += street.length_m();
        }
        // Maps draw pedestrian streets as areas; they are named along their lines.
        let is_street = |place: &Place| {
            place.kind == PlaceKind::Square && long.get(place.name.as_str()).is_some_and(|&length_m| length_m > LONGEST_SQUARE_M)
        };
        let mut marks = Vec::new();
        let mut high = Vec::new();
        for part in parts {
            let places = part.places.iter().filter(|place| !is_street(place));
            marks.extend(places.filter_map(|place| mark(place, part, written)));
            high.extend(landmarks(part));
        }
        high.sort_by(|a, b| b.height_m.total_cmp(&a.height_m).then_with(|| a.name.cmp(&b.name)));
        let landmarks = high.into_iter().map(|landmark| (landmark.clone(), written(&landmark.name))).collect();
        Self { streets, marks, landmarks }
    }

    /// Those marks and landmarks that layers show.
    #[must_use]
    pub fn shown(&self, layers: &Layers) -> Self {
        let is_shown = |mark: &&Mark| match mark.kind {
            NameKind::View => layers.views,
            NameKind::Sight | NameKind::House | NameKind::Shop => layers.places,
            _ => layers.names,
        };
        Self {
            streets: if layers.names { self.streets.clone() } else { Vec::new() },
            marks: self.marks.iter().filter(is_shown).cloned().collect(),
            landmarks: if layers.landmarks { self.landmarks.clone() } else { Vec::new() },
        }
    }

    /// As a layout takes it.
    #[must_use]
    pub fn wanted(&self) -> Wanted<'_> {
        Wanted { streets: &self.streets, marks: &self.marks, landmarks: &self.landmarks }
    }
}

fn mark(place: &Place, part: &Overview, written: &dyn Fn(&str) -> String) -> Option<Mark> {
    let mut kind = NameKind::of_place(place.kind).filter(|_| !place.name.is_empty())?;
    if place.kind == PlaceKind::Other {
        let at = GridPos::from_metres(place.pos);
        let ground = part.ground.iter().find(|patch| patch.outline.contains(at)).map(|patch| patch.surface);
        kind = match ground {
            Some(SurfaceKind::Water) => NameKind::Water,
            Some(SurfaceKind::Grass | SurfaceKind::Gravel) => NameKind::Park,
            _ => NameKind::House,
        };
    }
    Some(Mark { name: written(&place.name), kind, symbol: Symbol::of_place(place.kind), plan_pos: place.pos })
}

/// How dark each entry of an overview's houses is drawn.
#[must_use]
pub fn tones(overview: &Overview) -> Vec<Tone> {
    let tone = |height: i32| if metres(height) >= LANDMARK_M { Tone::Notable } else { Tone::House };
    let mut tones: Vec<Tone> = overview.houses.iter().map(|massing| tone(massing.height)).collect();
    let monuments: BTreeSet<&str> =
        overview.places.iter().filter(|place| place.kind == PlaceKind::Monument).map(|place| place.name.as_str()).collect();
    for name in overview.names.iter().filter(|name| !name.name.is_empty()) {
        let parts = tones.iter_mut().skip(name.house as usize).take(name.parts as usize);
        let mut parts: Vec<&mut Tone> = parts.collect();
        // A church is one thing, however low its aisles.
        let is_high = parts.iter().any(|tone| **tone > Tone::House);
        let tone = if is_high || monuments.contains(name.name.as_str()) { Tone::Monument } else { Tone::Notable };
        parts.iter_mut().for_each(|part| **part = tone);
    }
    tones
}

/// Plan positions of all that an overview draws, coarsely: corners of its houses and streets.
pub fn positions(overview: &Overview) -> impl Iterator<Item = DVec2> + '_ {
    let houses = overview.houses.iter().flat_map(|massing| &massing.outline.outer);
    houses.chain(overview.streets.iter().flat_map(|street| &street.line)).map(|&pos| pos.to_metres())
}

#[cfg(test)]
mod tests {
    use veduta_city::{GridPolygon, GroundPatch, HouseName, Massing};

    use super::*;

    fn square(x: f64) -> GridPolygon {
        let at = |dx: f64, dy: f64| GridPos::from_metres(DVec2::new(x + dx, dy));
        GridPolygon::simple(vec![at(0.0, 0.0), at(9.0, 0.0), at(9.0, 9.0), at(0.0, 9.0)])
    }

    #[test]
    fn houses_are_darker_the_more_is_told_of_them() {
        let massing = |x: f64, height: i32| Massing::block(square(x), height * 1024);
        let name = |house: u32, name: &str, parts: u32| HouseName { house, name: name.into(), number: "7".into(), parts };
        let overview = Overview {
            houses: vec![
                massing(0.0, 12),
                massing(10.0, 12),
                massing(20.0, 40),
                massing(30.0, 9),
                massing(40.0, 50),
                massing(50.0, 9),
            ],
            names: vec![name(0, "", 1), name(1, "U Minuty", 1), name(4, "Týn", 2), name(3, "Well", 1)],
            places: vec![Place { name: "Well".into(), kind: PlaceKind::Monument, ..Place::default() }],
            ..Overview::default()
        };
        let expected = [Tone::House, Tone::Notable, Tone::Notable, Tone::Monument, Tone::Monument, Tone::Monument];
        assert_eq!(tones(&overview), expected);
    }

    #[test]
    fn other_places_are_named_after_the_ground_that_they_lie_on() {
        let patch = |surface, x| GroundPatch { surface, outline: square(x), z: 0, course: None };
        let place = |name: &str, x: f64, kind| Place { name: name.into(), kind, pos: DVec2::new(x, 4.0), ..Place::default() };
        let overview = Overview {
            ground: vec![patch(SurfaceKind::Water, 0.0), patch(SurfaceKind::Grass, 20.0)],
            places: vec![
                place("Vltava", 3.0, PlaceKind::Other),
                place("Kampa", 23.0, PlaceKind::Other),
                place("Street", 0.0, PlaceKind::Street),
                place("", 0.0, PlaceKind::Square),
            ],
            ..Overview::default()
        };
        let named = Named::of([&overview], &|name| name.to_uppercase());
        let kinds: Vec<_> = named.marks.iter().map(|mark| (mark.name.as_str(), mark.kind)).collect();
        assert_eq!(kinds, [("VLTAVA", NameKind::Water), ("KAMPA", NameKind::Park)]);
        assert!(named.shown(&Layers::NONE).marks.is_empty());
    }

    #[test]
    fn every_layer_can_be_switched_by_its_name() {
        let mut layers = Layers::NONE;
        for called in Layers::CALLED {
            *layers.of(called).expect("it is there") = true;
        }
        assert_eq!(layers, Layers::ALL);
        assert!(layers.of("moon").is_none());
    }
}
