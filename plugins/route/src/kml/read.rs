//! KML as a tour.

use veduta_city::{Finding, Id, Severity, Step, Tour, file::SyntaxError};

use super::{
    KmlCity, View,
    element::{self, Element},
    finding,
    playlist::Playlist,
    steps::{dialled, said, steps, tour},
};
use crate::pose::turn_deg;

/// How near changes of the field of view and of the hour are told: degrees, hours.
const NEAR_DEG: f64 = 0.35;
const NEAR_HOURS: f64 = 0.06;

/// Reads the first tour of a KML file for a city; and what of it a tour here does not do. `file` names it in errors.
///
/// # Errors
/// A [`SyntaxError`] with line and column where the text is no KML, or has no tour with a view in it.
pub fn from_kml(bytes: &[u8], file: &str, city: KmlCity<'_>) -> Result<(Tour, Vec<Finding>), SyntaxError> {
    if bytes.starts_with(b"PK\x03\x04") {
        let message = "this is an archive (KMZ): unpack it as one unpacks a .zip, and take the .kml in it";
        return Err(SyntaxError::at("", file, 0, message));
    }
    let text = match core::str::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text),
        Err(error) => {
            let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
            return Err(SyntaxError::at(&good, file, good.len(), "the text is not UTF-8 from here on"));
        }
    };
    let root = element::read(text, file)?;
    let all = root.all();
    let tours: Vec<&Element> = all.iter().copied().filter(|element| element.name == "Tour").collect();
    let Some((first, others)) = tours.split_first() else {
        let message = format!("`{}` has no `gx:Tour` in it: record a tour, and save it as KML", root.name);
        return Err(SyntaxError::at(text, file, root.at, message));
    };
    let mut playlist = Playlist::new(text, city, &root);
    if let Some(other) = others.first() {
        let message = format!("{} more tours are left out: each goes into a file of its own", others.len());
        playlist.tell(Severity::Dropped, "tours", other.at, &message);
    }
    let primitives = first.child("Playlist").map(|list| &list.children[..]).unwrap_or_default();
    let _all_played = primitives.iter().all(|primitive| playlist.play(primitive));
    if playlist.views.is_empty() {
        let why = playlist.findings().first().map_or(String::new(), |finding| format!(": {}", finding.message));
        let message = format!("the tour shows nothing of the city{why}");
        return Err(SyntaxError::at(text, file, first.at, message));
    }
    let title = first.words("name").or_else(|| root.child("Document")?.words("name")).unwrap_or("Tour").to_owned();
    Ok(told(text, city, title, first, playlist))
}

fn told(text: &str, city: KmlCity<'_>, title: String, own: &Element, mut playlist: Playlist<'_>) -> (Tour, Vec<Finding>) {
    let pieces = core::mem::take(&mut playlist.pieces);
    // What is told before the first view waits for it.
    let first = pieces.iter().position(|piece| matches!(piece, super::playlist::Piece::Place { .. })).unwrap_or(0);
    let views = core::mem::take(&mut playlist.views);
    let fov: Vec<(f64, f64)> = views.iter().filter_map(|(at_s, view)| Some((*at_s, view.fov_deg?))).collect();
    let hours = hours(&views);
    let mut asides = said(core::mem::take(&mut playlist.words));
    asides.extend(dialled(&fov, NEAR_DEG, |deg, seconds| Step::Fov { deg, seconds }));
    asides.extend(dialled(&hours, NEAR_HOURS, |hour, seconds| Step::Time { hour: hour.rem_euclid(24.0), seconds }));
    asides.sort_by(|a, b| a.0.total_cmp(&b.0));
    let stamp = views.iter().find_map(|(_, view)| view.stamp);
    let (steps, late_s) = steps(pieces[first..].to_vec(), asides);
    let mut findings = playlist.findings();
    if late_s > 0.01 {
        let message = format!("the tour becomes {late_s:.1} s longer, for the dark at its begin and about its cuts");
        findings.push(finding(Severity::Note, text, own.at, &message));
    }
    if views.iter().any(|(_, view)| view.stamp.is_some_and(|(day, _)| Some(day) != stamp.map(|stamp| stamp.0))) {
        findings.push(Finding::new(
            Severity::Dropped,
            Id::NONE,
            None,
            "the date changes in the tour; that of its first view is kept",
        ));
    }
    (tour(title, city.name, (fov.first().map(|first| first.1), stamp), steps), findings)
}

/// The hours over time, counted on over midnight.
fn hours(views: &[(f64, View)]) -> Vec<(f64, f64)> {
    let mut hours: Vec<(f64, f64)> = Vec::new();
    for (at_s, (_, hour)) in views.iter().filter_map(|(at_s, view)| Some((*at_s, view.stamp?))) {
        let last = hours.last().map_or(hour, |last| last.1);
        // The hours of a day as degrees of a turn.
        hours.push((at_s, last + turn_deg(15.0 * last, 15.0 * hour) / 15.0));
    }
    hours
}
