use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, plan, survey_bare};
use veduta_city::{Anchor, Guide, Life, Overview, PlanTerrain, Step, TourText, Where, language_mistake};
use veduta_route::{Gazetteer, StepProblem, StreetNet, TourError, compile};
use veduta_store::{DirReader, INDEX_NAME, read_index, read_overview};

use super::check::recording_beside;

/// What a tour needs of its city.
pub(super) struct Town {
    pub net: StreetNet,
    pub places: Gazetteer,
    pub anchor: Anchor,
    pub terrain: PlanTerrain,
    /// Elevation of the city's zero above the sea in metres, where it is known.
    pub zero_m: Option<f64>,
    /// How far the farthest street is from the middle, metres.
    pub reach_m: f64,
}

/// Cities of the tours that were checked, by path, so that each is grown once.
#[derive(Default)]
pub(crate) struct Towns(BTreeMap<PathBuf, Result<Town, String>>);

/// Checks a tour: its settings and steps, and, where its city lies beside it, places and ways. Each mistake shows its line.
pub(crate) fn check_tour(path: &Path, text: &TourText, towns: &mut Towns) -> Result<String, Vec<String>> {
    let (tour, file) = (text.tour(), path.display().to_string());
    let mut wrong = wrong_languages(text, &file);
    let words = format!("“{}”, {} steps", tour.title, tour.steps.len());
    wrong.extend(tour.steps.iter().enumerate().flat_map(|(i, step)| {
        let shown = move |(named, why): (String, String)| {
            let message = format!("step {}: {why}", i + 1);
            text.mistake_near(i, &[&format!("\"{named}\"")], &path.display().to_string(), message).to_string()
        };
        missing_files(path, step).into_iter().map(shown)
    }));
    let whole = |message: String| text.setting_mistake("city", &file, message).to_string();
    let checked = match city_of(path, &tour.city) {
        None => {
            let error = compile(tour, &StreetNet::new(&[]), &Gazetteer::new(&[])).err().filter(is_own);
            wrong.extend(error.map(|error| shown(&error, text, &file)));
            wrong.extend(not_here(path, &tour.city).map(whole));
            format!("{words}; places and ways were not looked at, for `{}` is not here", tour.city)
        }
        Some(city) => match towns.0.entry(city).or_insert_with_key(|city| open(city)) {
            Ok(town) => match compile(tour, &town.net, &town.places) {
                Ok(tour) => format!("{words}, {:.0} s", tour.duration_s()),
                Err(error) => {
                    wrong.push(shown(&error, text, &file));
                    words
                }
            },
            Err(error) => {
                wrong.push(whole(format!("its city cannot be opened: {error}")));
                words
            }
        },
    };
    if wrong.is_empty() { Ok(checked) } else { Err(wrong) }
}

/// A tour's mistake with its line.
pub(super) fn shown(error: &TourError, text: &TourText, file: &str) -> String {
    let message = error.to_string();
    let mistake = match error {
        TourError::Empty => text.setting_mistake("steps", file, message),
        TourError::TooManySteps(_) => text.mistake(None, file, message),
        TourError::Setting(range) => {
            text.setting_mistake(SETTINGS.iter().find(|(what, _)| range.what.starts_with(what)).map_or("", |s| s.1), file, message)
        }
        TourError::Step { step, problem, .. } => match problem {
            StepProblem::UnknownPlace { name, .. } => text.mistake_near(step - 1, &[&format!("\"{name}\"")], file, message),
            StepProblem::Range(range) => text.mistake_near(step - 1, fields_of(range.what), file, message),
            _ => text.mistake(Some(step - 1), file, message),
        },
    };
    mistake.to_string()
}

/// A tour's settings as their mistakes name them, and as the file does.
const SETTINGS: [(&str, &str); 5] =
    [("speed", "speed"), ("eye", "eye_m"), ("field of view", "fov_deg"), ("hour", "hour"), ("day", "day")];

/// The fields that a number out of range may stand in.
fn fields_of(what: &str) -> &'static [&'static str] {
    match what {
        what if what.contains("seconds") && !what.contains("metres a second") => &["seconds", "keys"],
        what if what.contains("speed") => &["speed"],
        what if what.contains("eye") => &["eye_m"],
        what if what.contains("heading") || what.contains("field of view") => &["deg"],
        what if what.contains("pitch") => &["pitch_deg"],
        what if what.contains("spot's height") => &["height_m"],
        what if what.contains("hour") => &["hour"],
        what if what.contains("wet") => &["wet"],
        _ => &[],
    }
}

/// Files that a step plays or shows and that are not there, or cannot be played or shown, each with what is wrong.
fn missing_files(path: &Path, step: &Step) -> Vec<(String, String)> {
    let recording = |file: &String| Some((file.clone(), recording_beside(path, file).err()?));
    match step {
        Step::Narrate { file, files, .. } => files.values().chain([file]).filter_map(recording).collect(),
        Step::Sound { file } => file.iter().filter_map(recording).collect(),
        Step::Picture { file, .. } => picture_beside(path, file).err().map(|why| (file.clone(), why)).into_iter().collect(),
        _ => Vec::new(),
    }
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

/// Codes of translations that are none.
fn wrong_languages(text: &TourText, file: &str) -> Vec<String> {
    let tour = text.tour();
    let own = tour.translations.keys().filter_map(|code| language_mistake(code));
    let mut wrong: Vec<String> = own.map(|message| text.setting_mistake("translations", file, message).to_string()).collect();
    for (i, step) in tour.steps.iter().enumerate() {
        let translations: Vec<&String> = match step {
            Step::Say { translations, .. } | Step::Chapter { translations, .. } | Step::Picture { translations, .. } => {
                translations.keys().collect()
            }
            Step::Narrate { translations, files, .. } => translations.keys().chain(files.keys()).collect(),
            _ => continue,
        };
        for code in translations {
            let message = language_mistake(code).map(|message| format!("step {}: {message}", i + 1));
            wrong.extend(message.map(|message| text.mistake_near(i, &[&format!("\"{code}\"")], file, message).to_string()));
        }
    }
    wrong
}

/// That a city is not where a tour says, if others lie there, one of which may be meant.
fn not_here(path: &Path, named: &str) -> Option<String> {
    if named.contains("://") {
        return None;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut cities: Vec<String> = names.filter(|name| name.ends_with(".graph.ron") || name.ends_with(".city")).collect();
    cities.sort();
    let beside = cities.iter().map(|city| format!("\"{city}\"")).collect::<Vec<_>>().join(", ");
    (!cities.is_empty()).then(|| format!("there is no city at `{named}`, as seen from this file; beside it lies {beside}"))
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
    fn of(overview: Overview, anchor: Anchor) -> Self {
        let ends = overview.streets.iter().flat_map(|street| &street.line).map(|pos| pos.to_metres().length());
        let reach_m = ends.fold(0.0, f64::max);
        let net = StreetNet::new(&overview.streets).on(&overview.terrain);
        Self { net, places: Gazetteer::new(&overview.places), anchor, terrain: overview.terrain, zero_m: None, reach_m }
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
    if city.join(INDEX_NAME).is_file() {
        return open_baked(city).map_err(|error| error.to_string());
    }
    let input = Input::of(city).map_err(|error| error.to_string())?;
    let planned = plan(&input, &BakeSettings::default(), &mut |_| ()).map_err(|error| error.to_string())?;
    // What is not a map has none to tell it.
    let zero_m = survey_bare(&input).ok().map(|(graph, _)| graph.zero_m).filter(|&zero_m| zero_m != 0.0);
    let overview = Overview::of(&planned.plan);
    Ok(Town { zero_m, ..Town::of(overview, planned.plan.anchor) })
}

fn open_baked(city: &Path) -> Result<Town, veduta_store::StoreError> {
    let reader = DirReader::new(city)?;
    let index = read_index(&reader)?;
    Ok(Town::of(read_overview(&reader, &index)?, index.anchor))
}
