use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, plan, survey_bare};
use veduta_city::{Anchor, Guide, Life, Overview, Where};
use veduta_route::{Gazetteer, StreetNet, fold};
use veduta_store::{DirReader, INDEX_NAME, read_index, read_overview};

use super::beside::{picture_beside, recording_beside};
use super::places::known_as;

/// What a tour needs of its city.
pub(super) struct Town {
    pub net: StreetNet,
    pub places: Gazetteer,
    pub anchor: Anchor,
    /// Its streets, houses, ground and terrain.
    pub overview: Overview,
    /// Elevation of the city's zero above the sea in metres, where it is known.
    pub zero_m: Option<f64>,
    /// How far the farthest street is from the middle, metres.
    pub reach_m: f64,
    /// Where it lies.
    pub path: PathBuf,
    /// What its guide calls its places, by letters alone: as it is written, and the name in the map.
    pub known_as: BTreeMap<String, (String, String)>,
}

/// Cities of the tours that were checked, by path, so that each is grown once.
#[derive(Default)]
pub(crate) struct Towns(BTreeMap<PathBuf, Result<Town, String>>);

impl Towns {
    /// The city at a path.
    pub fn of(&mut self, city: &Path) -> Result<&Town, String> {
        self.0.entry(city.to_owned()).or_insert_with_key(|city| open(city)).as_ref().map_err(Clone::clone)
    }
}

/// Checks a guide: what stands in it, and, where its city lies beside it, whether that has its places.
pub(crate) fn check_guide(path: &Path, guide: &Guide, towns: &mut Towns) -> Result<String, Vec<String>> {
    let languages: BTreeSet<&String> = guide.places.iter().flat_map(|place| place.text.keys()).collect();
    let mut words = format!("{} places in {} languages", guide.places.len(), languages.len());
    let mut wrong = guide.validate();
    for place in &guide.places {
        let beside = place.pictures.iter().filter(|picture| !picture.is_on_the_web());
        let pictures = beside.filter_map(|picture| picture_beside(path, &picture.file).err());
        let sound = (!place.sound.is_empty()).then(|| recording_beside(path, &place.sound).err()).flatten();
        wrong.extend(pictures.chain(sound).map(|mistake| format!("place “{}”: {mistake}", place.name)));
    }
    match city_of(path, &guide.city).map(|city| towns.of(&city)) {
        Some(Ok(town)) => wrong.extend(guide.places.iter().filter_map(|place| town.lacks(&place.name))),
        Some(Err(error)) => wrong.push(format!("its city cannot be opened: {error}")),
        None => words.push_str("; names were not looked for, for its city is not here"),
    }
    if wrong.is_empty() { Ok(words) } else { Err(wrong.iter().map(|w| format!("{}: {w}", path.display())).collect()) }
}

/// Checks what is told of a city's life: what stands in it, and, where its city lies beside it, whether that has the places.
pub(crate) fn check_life(path: &Path, life: &Life, towns: &mut Towns) -> Result<String, Vec<String>> {
    let mut words = format!("{} living things", life.things.len());
    let mut wrong = life.validate();
    match city_of(path, &life.city).map(|city| towns.of(&city)) {
        Some(Ok(town)) => wrong.extend(life.things.iter().filter_map(|thing| match &thing.at {
            Where::Place(place) => Some(format!("{} “{}”: {}", thing.kind.word(), thing.name, town.lacks(place)?)),
            Where::At(..) => None,
        })),
        Some(Err(error)) => wrong.push(format!("its city cannot be opened: {error}")),
        None => words.push_str("; places were not looked for, for its city is not here"),
    }
    if wrong.is_empty() { Ok(words) } else { Err(wrong.iter().map(|w| format!("{}: {w}", path.display())).collect()) }
}

impl Town {
    fn of(overview: Overview, anchor: Anchor) -> Self {
        let ends = overview.streets.iter().flat_map(|street| &street.line).map(|pos| pos.to_metres().length());
        let reach_m = ends.fold(0.0, f64::max);
        let net = StreetNet::new(&overview.streets).on(&overview.terrain);
        let places = Gazetteer::new(&overview.places);
        Self { net, places, anchor, overview, zero_m: None, reach_m, path: PathBuf::new(), known_as: BTreeMap::new() }
    }

    /// What is meant by a name that no place has, or where their names are listed; in words that go on.
    pub fn hint(&self, name: &str, near: &[String]) -> String {
        match self.known_as.get(&fold(name)) {
            Some((_, meant)) => format!("; tours go by the map's names, and there it is \"{meant}\""),
            None if near.is_empty() => {
                format!("; `veduta-bake places {}` lists the names, and the search in the game finds them", self.path.display())
            }
            None => String::new(),
        }
    }

    /// A name that no place here has, in words.
    fn lacks(&self, name: &str) -> Option<String> {
        if self.places.find(name).is_some_and(|place| place.name == name) {
            return None;
        }
        let meant = match &self.places.suggest(name)[..] {
            [] => "see the map's `places`".to_owned(),
            alike => format!("is it {}?", alike.iter().map(|name| format!("“{name}”")).collect::<Vec<_>>().join(" or ")),
        };
        Some(format!("the map has no place “{name}”: {meant}"))
    }
}

/// Where the city that a file names lies: what it names, or the graph of which that would be baked.
pub(super) fn city_of(path: &Path, named: &str) -> Option<PathBuf> {
    if named.is_empty() || named.contains("://") {
        return None;
    }
    let named = path.with_file_name("").join(named);
    if named.exists() {
        return Some(named);
    }
    let graph = PathBuf::from(format!("{}.graph.ron", named.to_str()?.strip_suffix(".city")?));
    graph.exists().then_some(graph)
}

pub(super) fn open(city: &Path) -> Result<Town, String> {
    let town = if city.join(INDEX_NAME).is_file() {
        open_baked(city).map_err(|error| error.to_string())?
    } else {
        let input = Input::of(city).map_err(|error| error.to_string())?;
        let planned = plan(&input, &BakeSettings::default(), &mut |_| ()).map_err(|error| error.to_string())?;
        // What is not a map has none to tell it.
        let zero_m = survey_bare(&input).ok().map(|(graph, _)| graph.zero_m).filter(|&zero_m| zero_m != 0.0);
        Town { zero_m, ..Town::of(Overview::of(&planned.plan), planned.plan.anchor) }
    };
    Ok(Town { path: city.to_owned(), known_as: known_as(city), ..town })
}

fn open_baked(city: &Path) -> Result<Town, veduta_store::StoreError> {
    let reader = DirReader::new(city)?;
    let index = read_index(&reader)?;
    Ok(Town::of(read_overview(&reader, &index)?, index.anchor))
}
