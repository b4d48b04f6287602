use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{Guide, Life, Overview, Step, Tour, Where};
use veduta_route::{Gazetteer, StepProblem, StreetNet, TourError, compile};
use veduta_store::{DirReader, INDEX_NAME, read_index, read_overview};

use super::check::recording_beside;

/// What a tour needs of its city.
struct Town {
    net: StreetNet,
    places: Gazetteer,
}

/// Cities of the tours that were checked, by path, so that each is grown once.
#[derive(Default)]
pub(crate) struct Towns(BTreeMap<PathBuf, Result<Town, String>>);

/// Checks a tour: its settings and steps, and, where its city lies beside it, places and ways.
pub(crate) fn check_tour(path: &Path, tour: &Tour, towns: &mut Towns) -> Result<String, Vec<String>> {
    let words = format!("“{}”, {} steps", tour.title, tour.steps.len());
    let told = |error: &dyn core::fmt::Display| vec![format!("{}: {error}", path.display())];
    let missing: Vec<String> = tour.steps.iter().enumerate().flat_map(|(n, step)| missing_files(path, n + 1, step)).collect();
    if !missing.is_empty() {
        return Err(missing);
    }
    let Some(city) = city_of(path, &tour.city) else {
        return match compile(tour, &StreetNet::new(&[]), &Gazetteer::new(&[])) {
            Err(error) if is_own(&error) => Err(told(&error)),
            _ => Ok(format!("{words}; places and ways were not looked at, for `{}` is not here", tour.city)),
        };
    };
    match towns.0.entry(city).or_insert_with_key(|city| open(city)) {
        Ok(town) => match compile(tour, &town.net, &town.places) {
            Ok(tour) => Ok(format!("{words}, {:.0} s", tour.duration_s())),
            Err(error) => Err(told(&error)),
        },
        Err(error) => Err(told(&format!("its city cannot be opened: {error}"))),
    }
}

/// What a step plays or shows that is not there, or cannot be played or shown.
fn missing_files(path: &Path, number: usize, step: &Step) -> Vec<String> {
    let problems: Vec<String> = match step {
        Step::Narrate { file, files, .. } => {
            files.values().chain([file]).filter_map(|file| recording_beside(path, file).err()).collect()
        }
        Step::Sound { file } => file.iter().filter_map(|file| recording_beside(path, file).err()).collect(),
        Step::Picture { file, .. } => picture_beside(path, file).err().into_iter().collect(),
        _ => Vec::new(),
    };
    problems.into_iter().map(|problem| format!("{}: step {number}: {problem}", path.display())).collect()
}

/// Whether a picture beside a file is there and small enough to be shown.
fn picture_beside(path: &Path, file: &str) -> Result<(), String> {
    if !veduta_city::is_beside(file) {
        return Err(format!("the picture `{file}` must lie in or below the folder of this file"));
    }
    let at = path.with_file_name("").join(file);
    let bytes = std::fs::metadata(&at).map_err(|error| format!("the picture {}: {error}", at.display()))?.len();
    if bytes > PICTURE_BYTES {
        return Err(format!("the picture {} has {bytes} bytes; at most {PICTURE_BYTES} are shown", at.display()));
    }
    Ok(())
}

/// Larger pictures are not shown; bytes.
const PICTURE_BYTES: u64 = 8 << 20;

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
    match city_of(path, &guide.city).map(|city| towns.0.entry(city).or_insert_with_key(|city| open(city))) {
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
    match city_of(path, &life.city).map(|city| towns.0.entry(city).or_insert_with_key(|city| open(city))) {
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

/// Whether a mistake is the tour's own, whatever city it is played in.
const fn is_own(error: &TourError) -> bool {
    match error {
        TourError::Empty | TourError::TooManySteps(_) | TourError::Setting(_) => true,
        TourError::Step { problem, .. } => {
            matches!(
                problem,
                StepProblem::NoStart
                    | StepProblem::Range(_)
                    | StepProblem::NoPoints
                    | StepProblem::TooManyPoints(_)
                    | StepProblem::File { .. }
            )
        }
    }
}

/// Where the city that a file names lies: what it names, or the graph of which that would be baked.
fn city_of(path: &Path, named: &str) -> Option<PathBuf> {
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

fn open(city: &Path) -> Result<Town, String> {
    if city.join(INDEX_NAME).is_file() {
        return open_baked(city).map_err(|error| error.to_string());
    }
    let input = Input::of(city).map_err(|error| error.to_string())?;
    let planned = plan(&input, &BakeSettings::default(), &mut |_| ()).map_err(|error| error.to_string())?;
    let overview = Overview::of(&planned.plan);
    Ok(Town { net: StreetNet::new(&overview.streets).on(&overview.terrain), places: Gazetteer::new(&planned.plan.places) })
}

fn open_baked(city: &Path) -> Result<Town, veduta_store::StoreError> {
    let reader = DirReader::new(city)?;
    let overview = read_overview(&reader, &read_index(&reader)?)?;
    Ok(Town { net: StreetNet::new(&overview.streets).on(&overview.terrain), places: Gazetteer::new(&overview.places) })
}
