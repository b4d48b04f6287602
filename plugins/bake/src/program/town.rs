use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{Overview, Tour};
use veduta_route::{Gazetteer, StepProblem, StreetNet, TourError, compile};
use veduta_store::{DirReader, INDEX_NAME, read_index, read_overview};

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
    let Some(city) = city_of(path, tour) else {
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

/// Whether a mistake is the tour's own, whatever city it is played in.
const fn is_own(error: &TourError) -> bool {
    match error {
        TourError::Empty | TourError::TooManySteps(_) | TourError::Setting(_) => true,
        TourError::Step { problem, .. } => {
            matches!(problem, StepProblem::NoStart | StepProblem::Range(_) | StepProblem::NoPoints | StepProblem::TooManyPoints(_))
        }
    }
}

/// Where a tour's city lies: what it names, or the graph of which that would be baked.
fn city_of(path: &Path, tour: &Tour) -> Option<PathBuf> {
    if tour.city.is_empty() || tour.city.contains("://") {
        return None;
    }
    let named = path.with_file_name("").join(&tour.city);
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
