use bevy::prelude::*;
use veduta_city::{Anchor, GridPolygon, Viewpoint};

use crate::{Overviews, Rim};

/// The open city, as maps, guides and tours need it. Streaming inserts it; a game without streaming may insert its own.
#[derive(Resource, Debug, Clone, Default)]
pub struct City {
    /// Name.
    pub name: String,
    /// Whom to credit.
    pub attribution: String,
    /// Where it lies on Earth.
    pub anchor: Anchor,
    /// Where a visit begins.
    pub start: Viewpoint,
    /// Edge of the modelled city.
    pub extent: GridPolygon,
    /// How high it rises near its edge.
    pub rim: Rim,
    /// Streets, areas, houses in outline and places, in parts that come and go.
    pub overviews: Overviews,
    /// Files that travel with it, by their paths: guides, tours, pictures. The asset server loads one as `city://` and its path.
    pub files: Vec<String>,
}

impl City {
    /// Path for the asset server of the first file with an ending that travels with the city.
    #[must_use]
    pub fn file(&self, ending: &str) -> Option<String> {
        self.files.iter().find(|path| path.ends_with(ending)).map(|path| format!("{CITY_SOURCE}://{path}"))
    }
}

/// Name of the asset source of files that travel with the open city.
pub const CITY_SOURCE: &str = "city";

/// What to load of the kind of `handle` where a city has opened: its own file with an ending, if it has one and nothing but what came with
/// another city was asked for before.
#[must_use]
pub fn own_file<A: Asset>(city: &City, ending: &str, handle: Option<&Handle<A>>) -> Option<String> {
    let came_with_a_city = |handle: &Handle<A>| handle.path().is_some_and(|path| path.source().as_str() == Some(CITY_SOURCE));
    handle.is_none_or(came_with_a_city).then(|| city.file(ending)).flatten()
}

/// Asks for a city: a directory, or the URL of one on a web server. What was open before is closed.
#[derive(Resource, Debug, Clone, PartialEq, Eq)]
pub struct OpenCity(
    /// Path or URL.
    pub String,
);

/// A city is open: its index has arrived.
#[derive(Message, Debug, Clone, Copy)]
pub struct CityOpened;

/// Something of the city could not be had; the walk goes on with what is there.
#[derive(Message, Debug, Clone)]
pub struct CityFailed {
    /// What happened, with place and fix.
    pub message: String,
    /// Whether it will be tried again by itself.
    pub will_retry: bool,
}

/// Puts the viewer somewhere else, behind a fade.
#[derive(Message, Debug, Clone, Copy)]
pub struct JumpTo(
    /// Where.
    pub Viewpoint,
);
