//! A playlist's primitives as a camera over time.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, swizzles::Vec3Swizzles};
use veduta_city::{Finding, Severity};

use super::{
    KmlCity, View,
    element::{Element, without_marks},
    finding, stamp, up_deg,
};
use crate::{LONGEST_TOUR_S, bounds::FURTHEST_M};

/// Least height of an eye, and what one is raised to that would lie lower; metres.
const LEAST_EYE_M: f64 = 0.2;
const EYE_M: f64 = 1.65;
/// Greatest height of an eye in metres.
const MOST_EYE_M: f64 = 2000.0;
/// What a tour here may be shorter than the longest, for the dark about its cuts and its last words; seconds.
const ROOM_S: f64 = 600.0;
/// Over shorter distances the arc of a `bounce` is hardly seen; metres.
const ARC_M: f64 = 100.0;

/// What the camera does from one moment on.
#[derive(Debug, Clone)]
pub(super) enum Piece {
    /// Stands somewhere at once.
    Place { at_s: f64, view: View },
    /// Moves from rest to rest through these.
    Track { from_s: f64, keys: Vec<(f64, View)> },
    /// Stays.
    Rest { from_s: f64, to_s: f64 },
}

/// Words that are shown.
#[derive(Debug, Clone)]
pub(super) struct Words {
    pub at_s: f64,
    pub until_s: Option<f64>,
    pub text: String,
    pub translations: BTreeMap<String, String>,
}

/// A playlist that is read.
pub(super) struct Playlist<'a> {
    text: &'a str,
    city: KmlCity<'a>,
    placemarks: BTreeMap<&'a str, &'a Element>,
    pub pieces: Vec<Piece>,
    pub words: Vec<Words>,
    /// Which of the words a placemark shows.
    shown: BTreeMap<String, usize>,
    /// Views over time, as far as they tell a field of view or a time.
    pub views: Vec<(f64, View)>,
    now_s: f64,
    last: Option<View>,
    /// Whether a smooth flight goes on in the one before.
    is_joined: bool,
    /// Findings of a kind: the first, and how many there are.
    found: Vec<(&'static str, Finding, usize)>,
}

impl<'a> Playlist<'a> {
    pub fn new(text: &'a str, city: KmlCity<'a>, root: &'a Element) -> Self {
        let named = |element: &'a Element| Some((element.id.as_deref()?, element));
        let placemarks = root.all().into_iter().filter(|element| element.name == "Placemark").filter_map(named).collect();
        Self {
            text,
            city,
            placemarks,
            pieces: Vec::new(),
            words: Vec::new(),
            shown: BTreeMap::new(),
            views: Vec::new(),
            now_s: 0.0,
            last: None,
            is_joined: false,
            found: Vec::new(),
        }
    }

    /// Notes something; of a kind only the first is told in full.
    pub fn tell(&mut self, severity: Severity, kind: &'static str, at: usize, message: &str) {
        match self.found.iter_mut().find(|found| found.0 == kind) {
            Some(found) => found.2 += 1,
            None => self.found.push((kind, finding(severity, self.text, at, message), 1)),
        }
    }

    pub fn findings(self) -> Vec<Finding> {
        let with_count = |(_, mut finding, many): (_, Finding, usize)| {
            if many > 1 {
                finding.message.push_str(&format!(" (and {} more like it)", many - 1));
            }
            finding
        };
        self.found.into_iter().map(with_count).collect()
    }

    /// Plays a primitive; `false` where the tour has become too long.
    pub fn play(&mut self, primitive: &'a Element) -> bool {
        let takes_time = matches!(primitive.name.as_str(), "FlyTo" | "Wait");
        let seconds = if takes_time { self.seconds(primitive, "duration") } else { 0.0 };
        if self.now_s + seconds > LONGEST_TOUR_S - ROOM_S {
            let message = format!("the tour ends here: it lasts {} hours at most", LONGEST_TOUR_S / 3600.0);
            self.tell(Severity::Dropped, "length", primitive.at, &message);
            return false;
        }
        match primitive.name.as_str() {
            "FlyTo" => self.fly(primitive, seconds),
            "Wait" => self.rest(seconds),
            "AnimatedUpdate" => self.update(primitive),
            "SoundCue" => {
                let href = primitive.words("href").unwrap_or("");
                self.tell(Severity::Dropped, "sound", primitive.at, &format!("the sound `{href}` is not played: a tour has none"));
            }
            "TourControl" => {
                self.tell(Severity::Dropped, "pause", primitive.at, "the pause is left out: a visitor stops a tour at will");
            }
            other => {
                self.tell(Severity::Dropped, "primitive", primitive.at, &format!("`{other}` is nothing that a tour does"));
            }
        }
        true
    }

    /// A time in seconds that an element tells, 0 if it tells none.
    fn seconds(&mut self, element: &Element, name: &str) -> f64 {
        let Some(words) = element.words(name) else { return 0.0 };
        match words.parse::<f64>() {
            Ok(seconds) if (0.0..=1e6).contains(&seconds) => seconds,
            _ => {
                let message = format!("`{words}` is no time in seconds; 0 is taken");
                self.tell(Severity::Repaired, "time", element.at, &message);
                0.0
            }
        }
    }

    /// The moment so many seconds on, in whole thousandths.
    fn later(&self, seconds: f64) -> f64 {
        libm::round((self.now_s + seconds) * 1000.0) / 1000.0
    }

    fn rest(&mut self, seconds: f64) {
        let to_s = self.later(seconds);
        match self.pieces.last_mut() {
            Some(Piece::Rest { to_s: end_s, .. }) => *end_s = to_s,
            _ => self.pieces.push(Piece::Rest { from_s: self.now_s, to_s }),
        }
        self.now_s = to_s;
        self.is_joined = false;
    }

    fn fly(&mut self, primitive: &Element, seconds: f64) {
        let element = primitive.children.iter().find(|child| matches!(child.name.as_str(), "Camera" | "LookAt"));
        let view = match element {
            Some(element) => self.view(element),
            None => {
                self.tell(Severity::Dropped, "view", primitive.at, "a flight without `Camera` or `LookAt` leads nowhere");
                None
            }
        };
        let Some(view) = view else { return self.rest(seconds) };
        let is_smooth = primitive.words("flyToMode") == Some("smooth");
        let from_s = self.now_s;
        self.now_s = self.later(seconds);
        match self.last {
            Some(last) if self.now_s > from_s => {
                if !is_smooth && last.at.distance(view.at) > ARC_M {
                    let message = "the flight leads straight, not over the arc of a `bounce`";
                    self.tell(Severity::Note, "arc", primitive.at, message);
                }
                match self.pieces.last_mut() {
                    Some(Piece::Track { keys, .. }) if is_smooth && self.is_joined => keys.push((self.now_s, view)),
                    _ => self.pieces.push(Piece::Track { from_s, keys: vec![(self.now_s, view)] }),
                }
                self.is_joined = is_smooth;
            }
            Some(_) => {
                self.pieces.push(Piece::Place { at_s: self.now_s, view });
                self.is_joined = false;
            }
            None => {
                self.pieces.push(Piece::Place { at_s: 0.0, view });
                // Wherever one was before, one is there while the first flight lasts.
                if self.now_s > 0.0 {
                    self.pieces.push(Piece::Rest { from_s: 0.0, to_s: self.now_s });
                }
            }
        }
        self.views.push((self.now_s, view));
        self.last = Some(view);
    }

    /// A number that an element tells.
    fn number(&mut self, element: &Element, name: &str) -> Option<f64> {
        let words = element.words(name)?;
        let number = words.parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            self.tell(Severity::Dropped, "number", element.at, &format!("`{words}` is no number for `{name}`"));
        }
        number
    }

    fn view(&mut self, element: &Element) -> Option<View> {
        let (Some(lon), Some(lat)) = (self.number(element, "longitude"), self.number(element, "latitude")) else {
            self.tell(Severity::Dropped, "place", element.at, "a view without longitude and latitude");
            return None;
        };
        let altitude = self.number(element, "altitude").unwrap_or(0.0);
        let heading_deg = self.number(element, "heading").unwrap_or(0.0).rem_euclid(360.0);
        let tilt = self.number(element, "tilt").unwrap_or(0.0);
        let pitch_deg = (tilt - 90.0).clamp(-90.0, 90.0);
        if self.number(element, "roll").is_some_and(|roll| roll != 0.0) {
            self.tell(Severity::Dropped, "roll", element.at, "the camera's roll is left out: visitors stay upright");
        }
        let pos = self.city.anchor.plan_from_geo(lat, lon);
        let mode = element.words("altitudeMode").unwrap_or("clampToGround");
        let height = self.height_m(element, mode, pos, altitude);
        let mut at = pos.extend(height);
        if element.name == "LookAt" {
            let range = self.number(element, "range").unwrap_or(0.0);
            let (heading, pitch) = (heading_deg.to_radians(), pitch_deg.to_radians());
            let along = DVec3::new(libm::sin(heading) * libm::cos(pitch), libm::cos(heading) * libm::cos(pitch), libm::sin(pitch));
            let eye = at - along * range;
            let fall = self.city.terrain.height_m(pos) - self.city.terrain.height_m(eye.xy());
            at = eye + DVec3::Z * fall;
        } else if mode.starts_with("clamp") {
            at.z = EYE_M;
            self.tell(Severity::Repaired, "clamp", element.at, "a camera on the ground itself is raised to the height of eyes");
        }
        let at = self.believed(element, at)?;
        let across = self.number(element, "horizFov").filter(|deg| (1.0..179.0).contains(deg));
        let fov_deg = across.map(|deg| (libm::round(up_deg(deg) * 100.0) / 100.0).clamp(5.0, 140.0));
        Some(View { at, heading_deg, pitch_deg, fov_deg, stamp: self.stamp(element) })
    }

    /// Height above the ground of an altitude.
    fn height_m(&mut self, element: &Element, mode: &str, pos: DVec2, altitude: f64) -> f64 {
        match mode {
            "absolute" => {
                if self.city.zero_m.is_none() {
                    let message = "the city does not know its elevation above the sea: absolute altitudes are taken above its zero";
                    self.tell(Severity::Note, "absolute", element.at, message);
                }
                altitude - self.city.zero_m.unwrap_or(0.0) - self.city.terrain.height_m(pos)
            }
            mode if mode.starts_with("clamp") => 0.0,
            _ => altitude,
        }
    }

    /// An eye that may be: near the city, above the ground and below the clouds.
    fn believed(&mut self, element: &Element, mut at: DVec3) -> Option<DVec3> {
        let is_within = at.is_finite() && at.xy().abs().max_element() < FURTHEST_M;
        if !is_within || at.xy().length() > self.city.reach_m {
            let message = format!("the view is {:.0} km from the city's middle: it is left out", at.xy().length() / 1000.0);
            self.tell(Severity::Dropped, "far", element.at, &message);
            return None;
        }
        if at.z < LEAST_EYE_M {
            let message = format!("the eye would be {:.1} m above the ground; it is raised to {EYE_M}", at.z);
            self.tell(Severity::Repaired, "low", element.at, &message);
            at.z = EYE_M;
        } else if at.z > MOST_EYE_M {
            let message = format!("the eye would be {:.0} m above the ground; it is lowered to {MOST_EYE_M}", at.z);
            self.tell(Severity::Repaired, "high", element.at, &message);
            at.z = MOST_EYE_M;
        }
        Some(at)
    }

    fn stamp(&mut self, view: &Element) -> Option<(u16, f64)> {
        let (name, of) = [("TimeStamp", "when"), ("TimeSpan", "begin")].into_iter().find(|(name, _)| view.child(name).is_some())?;
        let when = view.child(name)?.words(of)?;
        let stamp = stamp::read(when, self.city.anchor.lon);
        if stamp.is_none() {
            self.tell(Severity::Dropped, "stamp", view.at, &format!("`{when}` is no time, as 2024-06-08T09:00:00Z is"));
        }
        stamp
    }

    fn update(&mut self, primitive: &'a Element) {
        let at_s = self.now_s + self.seconds(primitive, "delayedStart");
        let Some(update) = primitive.child("Update") else { return };
        for change in &update.children {
            let changes: &[Element] = if change.name == "Change" { &change.children } else { &[] };
            for thing in changes {
                if thing.name == "Placemark" && self.change(thing, at_s) {
                    continue;
                }
                let message = format!("the change of `{}` is left out: of these a tour knows captions alone", thing.name);
                self.tell(Severity::Dropped, "change", thing.at, &message);
            }
            if !matches!(change.name.as_str(), "Change" | "targetHref") {
                let message = format!("`{}` is left out: a tour makes and removes nothing", change.name);
                self.tell(Severity::Dropped, "create", change.at, &message);
            }
        }
    }

    /// Shows or hides a caption; `false` if the change is about something else.
    fn change(&mut self, thing: &'a Element, at_s: f64) -> bool {
        let target = thing.target.clone().unwrap_or_default();
        let shown = self.placemarks.get(target.as_str()).copied();
        if let Some(description) = thing.child("description") {
            let words = (without_marks(&description.text), BTreeMap::new());
            self.show(target, at_s, words);
            return true;
        }
        match (thing.words("balloonVisibility"), shown) {
            (Some("1" | "true"), Some(placemark)) => self.show(target, at_s, words_of(placemark)),
            (Some("1" | "true"), None) => {
                self.tell(Severity::Dropped, "target", thing.at, &format!("there is no placemark `{target}` to show"));
            }
            (Some(_), _) => self.end(&target, at_s),
            (None, _) => return false,
        }
        true
    }

    /// The words of a placemark are shown no longer.
    fn end(&mut self, target: &str, at_s: f64) {
        if let Some(words) = self.shown.remove(target).and_then(|index| self.words.get_mut(index)) {
            words.until_s = Some(at_s);
        }
    }

    /// Words are shown from now on, in place of others of the same placemark.
    fn show(&mut self, target: String, at_s: f64, (text, translations): (String, BTreeMap<String, String>)) {
        self.end(&target, at_s);
        self.shown.insert(target, self.words.len());
        self.words.push(Words { at_s, until_s: None, text, translations });
    }
}

/// What a placemark's balloon says, and in other languages.
fn words_of(placemark: &Element) -> (String, BTreeMap<String, String>) {
    let described = placemark.words("description").or_else(|| placemark.words("name")).map(without_marks).unwrap_or_default();
    let data = placemark.child("ExtendedData").map(|data| &data.children[..]).unwrap_or_default();
    let mut texts: BTreeMap<String, String> =
        data.iter().filter_map(|data| Some((data.key.clone()?, data.words("value")?.to_owned()))).collect();
    // What somebody has changed since is not what the translations are of.
    let flat = |text: &String| text.split_whitespace().collect::<Vec<_>>().join(" ") == described;
    match texts.remove("") {
        Some(own) if flat(&own) || texts.values().any(flat) => (own, texts),
        _ => (described, BTreeMap::new()),
    }
}
