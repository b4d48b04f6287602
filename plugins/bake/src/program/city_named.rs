//! The city that a tour names.

use std::path::{Path, PathBuf};

use super::town::city_of;

/// What a tour's `city` is.
pub(super) enum Named {
    /// An address, which is not looked at.
    OnTheWeb,
    /// A path where something lies.
    Here(PathBuf),
    /// No city, and why, in words.
    Wrong(String),
}

/// Files that belong to a city and are none.
const NO_CITIES: [(&str, &str); 6] = [
    (".tour.ron", "a tour"),
    (".guide.ron", "a guide"),
    (".life.ron", "a city's life"),
    (".sound.ron", "a city's sounds"),
    (".overrides.ron", "a person's edits"),
    (".views.ron", "a list of views"),
];

/// What a tour in a file names as its city.
pub(super) fn named_city(path: &Path, named: &str) -> Named {
    if named.starts_with("https://") || named.starts_with("http://") {
        return Named::OnTheWeb;
    }
    let wrong = |what: &str| Named::Wrong(format!("{what}{}", lying_there(path, named)));
    let shown = named.escape_debug();
    if named.trim().is_empty() {
        return wrong("the city is empty; write the path of its map as seen from this file, such as \"town.graph.ron\"");
    }
    if named.contains("://") {
        return wrong(&format!("`{shown}` is no address of a city: those begin with https:// or http://"));
    }
    if let Some((_, what)) = NO_CITIES.iter().find(|(ending, _)| named.ends_with(ending)) {
        return wrong(&format!(
            "`{shown}` is {what}; here stands the city that this tour leads through: its map, or what was baked of it"
        ));
    }
    match city_of(path, named) {
        Some(city) => Named::Here(city),
        None if named.contains('\\') => wrong(&format!("there is no city at `{shown}`; in a path write `/` instead of `\\`")),
        None if !named.contains(['.', '/']) => wrong(&format!(
            "there is no city at `{shown}`, as seen from this file; a path is wanted here, such as \"town.graph.ron\", not a name"
        )),
        None => wrong(&format!("there is no city at `{shown}`, as seen from this file")),
    }
}

/// Cities that lie where a tour looks for its own, or else beside it.
fn lying_there(path: &Path, named: &str) -> String {
    let beside = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (before, _) = named.rsplit_once('/').unwrap_or_default();
    let there = Some(cities_in(&beside.join(before), before)).filter(|cities| !cities.is_empty() && !before.is_empty());
    let (words, cities) = there.map_or_else(|| ("beside it lies", cities_in(beside, "")), |cities| ("there lies", cities));
    if cities.is_empty() {
        return "; paths lead from the folder that this file lies in".to_owned();
    }
    format!("; {words} {}", cities.join(", "))
}

/// Graphs and baked cities in a folder, as a tour writes them that calls the folder so.
fn cities_in(folder: &Path, called: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let is_city = |name: &String| name.ends_with(".graph.ron") || name.ends_with(".city") || name.ends_with(".osm.pbf");
    let mut names: Vec<String> = names.filter(is_city).collect();
    names.sort();
    let slash = if called.is_empty() { "" } else { "/" };
    names.into_iter().map(|name| format!("\"{called}{slash}{name}\"")).collect()
}
