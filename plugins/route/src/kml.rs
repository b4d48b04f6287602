//! Tours to and from KML (`gx:Tour`, as in Google Earth): <https://developers.google.com/kml/documentation/touring>.
//!
//! ```text
//!  CompiledTour ── sampled as sparsely as straight lines between samples allow ──► gx:FlyTo, gx:Wait, captions ── to_kml ──► text
//!  text ── from_kml ──► elements ──► a camera over time ──► Start, Track, Wait, Cut, Say, Fov, Time ──► Tour
//! ```
//!
//! # What is told in KML, and what is not
//! | in a tour | in KML |
//! |---|---|
//! | where the eye is and looks | `gx:FlyTo` with a `Camera`, heights relative to the ground, whatever steps led there; read from a `LookAt` too |
//! | `Wait`, and all standing still | `gx:Wait` |
//! | `Cut`, `Start` | a `gx:FlyTo` of no duration; the darkness about it is lost |
//! | `Say` | a placemark, its balloon shown by `gx:AnimatedUpdate`; other languages as `ExtendedData` |
//! | `Fov` | `gx:horizFov`, for a window of 16 : 9 |
//! | `Time`, the day | `gx:TimeStamp`: the hour is the sun's at the city's anchor, and the year is [`YEAR`] |
//! | `Chapter`, `Mark`, `Rain` | nothing; told by a finding |
//!
//! Of what KML has, a tour has no sound, no pause that waits for the visitor, no roll, no change of other things than captions, and no
//! arc over which a `bounce` leads: it goes straight. Each is told by a finding with its line and column. An archive (KMZ) must be
//! unpacked first.
//!
//! # Rejected
//! Walks and flights as such, so that a tour that was taken out is the tour that it was: KML knows cameras alone. A tree of the whole file by
//! another library: it would be a dependency for some twenty names of elements.

use veduta_city::{Anchor, Finding, Id, Severity, file};

mod element;
mod playlist;
mod read;
mod stamp;
mod steps;
#[cfg(test)]
mod tests;
mod write;

pub use read::from_kml;
pub use stamp::YEAR;
pub use write::to_kml;

/// Width of the window by its height that KML's horizontal field of view is meant for.
const ASPECT: f64 = 16.0 / 9.0;

/// The city that a tour in KML is read for.
#[derive(Debug, Clone, Copy)]
pub struct KmlCity<'a> {
    /// What the tour names as its city.
    pub name: &'a str,
    /// Where plan (0, 0) lies.
    pub anchor: Anchor,
    /// Elevation of the city's zero above the sea in metres, for absolute altitudes; `None` where it is not known.
    pub zero_m: Option<f64>,
    /// The ground.
    pub terrain: &'a veduta_city::PlanTerrain,
    /// Views farther than this from plan (0, 0) are not of the city and left out, metres.
    pub reach_m: f64,
}

/// A camera at a moment: plan metres and metres above the ground, degrees, and what else a view may tell.
#[derive(Debug, Clone, Copy, PartialEq)]
struct View {
    at: glam::DVec3,
    heading_deg: f64,
    pitch_deg: f64,
    fov_deg: Option<f64>,
    /// Day of the year and the sun's hour.
    stamp: Option<(u16, f64)>,
}

/// A field of view across, of one up and down; degrees. And back.
fn across_deg(up_deg: f64) -> f64 {
    2.0 * libm::atan(libm::tan(up_deg.to_radians() / 2.0) * ASPECT).to_degrees()
}

fn up_deg(across_deg: f64) -> f64 {
    2.0 * libm::atan(libm::tan(across_deg.to_radians() / 2.0) / ASPECT).to_degrees()
}

/// A finding about something in a KML text.
fn finding(severity: Severity, text: &str, at: usize, message: &str) -> Finding {
    let (line, column) = file::line_and_column(text, at);
    Finding::new(severity, Id::NONE, None, format!("line {line}, column {column}: {message}"))
}
