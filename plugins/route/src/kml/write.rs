//! A compiled tour as KML.

use core::fmt::Write;

use glam::DVec3;
use veduta_city::{Anchor, Finding, Id, Severity};

use super::{across_deg, element::escaped, stamp::stamp};
use crate::{
    CompiledTour, Pose,
    pose::turn_deg,
    script::{Caption, Spoken},
};

/// Moments looked at, a second.
const RATE_HZ: f64 = 60.0;
/// Straight lines between samples are as near to the tour as this: metres, degrees of the view and of the field, hours.
const NEAR_M: f64 = 0.02;
const NEAR_DEG: f64 = 0.1;
const NEAR_HOURS: f64 = 0.02;
/// Longest time between samples of what moves, in seconds: curves through them stay as near as lines.
const LONGEST_S: f64 = 1.0;

/// A tour as KML text, the words in a language told by its code, or in the tour's own; and what is lost.
///
/// Times are kept to a thousandth of a second, and the camera's way to 2 cm and 0.1°, whether it is shown straight or smooth
/// between the samples.
#[must_use]
pub fn to_kml(tour: &CompiledTour, anchor: Anchor, language: &str) -> (String, Vec<Finding>) {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    out.push_str("<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n");
    let title = escaped(tour.title_in(language));
    let captions = shown(tour);
    let mut written = Written { out, anchor, day: tour.day(), at_s: 0.0 };
    written.line(format_args!("<name>{title}</name>\n<open>1</open>"));
    written.line(format_args!(
        "<Style id=\"caption\"><IconStyle><scale>0</scale></IconStyle><LabelStyle><scale>0</scale></LabelStyle>\
         <BalloonStyle><text>$[description]</text></BalloonStyle></Style>"
    ));
    for (i, caption) in captions.iter().enumerate() {
        written.placemark(i, caption, &tour.pose(caption.start_s), language);
    }
    written.line(format_args!("<gx:Tour>\n<name>{title}</name>\n<gx:Playlist>"));
    let mut events: Vec<Event> = Vec::new();
    for (i, caption) in captions.iter().enumerate() {
        events.extend([Event { at_s: caption.start_s, caption: i, is_shown: true }]);
        events.push(Event { at_s: caption.end_s, caption: i, is_shown: false });
    }
    // Of two at one moment, the one before goes first.
    events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s).then(a.is_shown.cmp(&b.is_shown)));
    let stops = stops(tour, &events);
    let mut events = events.into_iter().peekable();
    let mut shots = tour.timeline.cuts().into_iter().chain([tour.duration_s()]);
    let mut start_s = shots.next().unwrap_or(0.0);
    for end_s in shots {
        written.fly(start_s, &tour.pose(start_s), "bounce");
        let own: Vec<f64> = stops.iter().copied().filter(|&stop| start_s <= stop && stop < end_s).chain([end_s]).collect();
        let mut from_s = start_s;
        for stop_s in own {
            written.stretch(tour, from_s, stop_s, stop_s == end_s && end_s < tour.duration_s());
            from_s = stop_s;
            while let Some(event) = events.next_if(|event| event.at_s <= stop_s) {
                written.show(event.caption, event.is_shown);
            }
        }
        start_s = end_s;
    }
    events.for_each(|event| written.show(event.caption, event.is_shown));
    written.out.push_str("</gx:Playlist>\n</gx:Tour>\n</Document>\n</kml>\n");
    (written.out, lost(tour))
}

/// When a caption comes or goes.
struct Event {
    at_s: f64,
    caption: usize,
    is_shown: bool,
}

/// The captions as they are shown: one ends where the next begins.
fn shown(tour: &CompiledTour) -> Vec<Caption> {
    let all = &tour.script.captions;
    let next = all.iter().skip(1).map(|caption| caption.start_s).chain([tour.duration_s()]);
    let cut = all.iter().zip(next).map(|(caption, next)| Caption { end_s: caption.end_s.min(next), ..caption.clone() });
    cut.filter(|caption| caption.end_s > caption.start_s && !caption.text.own().is_empty()).collect()
}

/// Moments that are samples in any case: where a step begins or ends, or a caption comes or goes.
fn stops(tour: &CompiledTour, events: &[Event]) -> Vec<f64> {
    let spans = tour.steps().iter().flat_map(|span| [span.start_s, span.end_s]);
    let mut stops: Vec<f64> = spans.chain(events.iter().map(|event| event.at_s)).filter(|&stop| stop > 0.0).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|b, a| *b - *a < 1e-6);
    stops
}

fn lost(tour: &CompiledTour) -> Vec<Finding> {
    let told = |many: usize, what: &str| {
        let message = format!("{many} {what}: KML has nothing like it");
        (many > 0).then(|| Finding::new(Severity::Dropped, Id::NONE, None, message))
    };
    let cuts = tour.timeline.cuts().len() - 1;
    let dark = (cuts > 0).then(|| {
        let message = format!("{cuts} cuts are shown without the darkness about them");
        Finding::new(Severity::Note, Id::NONE, None, message)
    });
    let rain = usize::from(tour.wet(0.0).is_some());
    let lost = [
        told(tour.script.chapters.len(), "chapters"),
        told(tour.script.marks.len(), "marks"),
        told(tour.subjects.len(), "views that follow what moves"),
        told(rain, "weather"),
        dark,
    ];
    lost.into_iter().flatten().collect()
}

/// A moment of the tour as numbers that go from one moment to the next without a jump.
#[derive(Clone, Copy)]
struct Sample {
    at_s: f64,
    pose: Pose,
    heading: f64,
    hour: f64,
}

impl Sample {
    fn at(at_s: f64, pose: Pose, before: Option<&Self>) -> Self {
        let Some(before) = before else { return Self { at_s, pose, heading: pose.heading_deg, hour: pose.hour } };
        let heading = before.heading + turn_deg(before.heading, pose.heading_deg);
        // The hours of a day as degrees of a turn.
        let hour = before.hour + turn_deg(15.0 * before.hour, 15.0 * pose.hour) / 15.0;
        Self { at_s, pose, heading, hour }
    }

    /// Whether a moment lies as near to the straight line between two others as is asked for.
    fn is_between(&self, a: &Self, b: &Self) -> bool {
        let share = (self.at_s - a.at_s) / (b.at_s - a.at_s);
        let off = |a: f64, b: f64, own: f64| (a + (b - a) * share - own).abs();
        let at = |pose: &Pose| -> DVec3 { pose.at() };
        at(&a.pose).lerp(at(&b.pose), share).distance(at(&self.pose)) <= NEAR_M
            && off(a.heading, b.heading, self.heading) <= NEAR_DEG
            && off(a.pose.pitch_deg, b.pose.pitch_deg, self.pose.pitch_deg) <= NEAR_DEG
            && off(a.pose.fov_deg, b.pose.fov_deg, self.pose.fov_deg) <= NEAR_DEG
            && off(a.hour, b.hour, self.hour) <= NEAR_HOURS
    }

    fn is_like(&self, other: &Self) -> bool {
        let degrees = [
            self.heading - other.heading,
            self.pose.pitch_deg - other.pose.pitch_deg,
            self.pose.fov_deg - other.pose.fov_deg,
            self.hour - other.hour,
        ];
        self.pose.at().distance(other.pose.at()) < 1e-3 && degrees.iter().all(|d| d.abs() < 1e-3)
    }
}

struct Written {
    out: String,
    anchor: Anchor,
    day: u16,
    /// How much of the tour has been told, in seconds.
    at_s: f64,
}

impl Written {
    fn line(&mut self, line: core::fmt::Arguments<'_>) {
        // A string takes whatever it is given.
        let _ = writeln!(self.out, "{line}");
    }

    /// Seconds since what was told last, and takes them as told; whole thousandths, whose errors do not add up.
    fn since(&mut self, at_s: f64) -> f64 {
        let now = libm::round(at_s * 1000.0) / 1000.0;
        let seconds = now - self.at_s;
        self.at_s = now;
        seconds
    }

    /// Tells what lies between two moments without a cut; where one follows, the moment just before it is the last.
    fn stretch(&mut self, tour: &CompiledTour, from_s: f64, to_s: f64, is_cut_next: bool) {
        if to_s - from_s < 1e-6 {
            return;
        }
        // A moment just before the last is the last: where the tour is cut there, the next would be seen.
        let many = libm::ceil((to_s - from_s) * RATE_HZ - 1e-3).max(1.0) as usize;
        let mut samples: Vec<Sample> = Vec::with_capacity(many + 1);
        for i in 0..=many {
            let at_s = if i == many { to_s } else { from_s + i as f64 / RATE_HZ };
            let seen_s = if i == many && is_cut_next { to_s - 1e-6 } else { at_s };
            samples.push(Sample::at(at_s, tour.pose(seen_s), samples.last()));
        }
        let mut at = 0;
        while at + 1 < samples.len() {
            let still = samples[at..].iter().take_while(|sample| sample.is_like(&samples[at])).count() - 1;
            if samples[at + still].at_s - samples[at].at_s > 0.25 || at + still + 1 == samples.len() && still > 0 {
                at += still;
                let seconds = self.since(samples[at].at_s);
                self.line(format_args!("<gx:Wait><gx:duration>{seconds:.3}</gx:duration></gx:Wait>"));
                continue;
            }
            let fits = |to: usize| {
                let (a, b) = (&samples[at], &samples[to]);
                b.at_s - a.at_s <= LONGEST_S && samples[at + 1..to].iter().all(|sample| sample.is_between(a, b))
            };
            at = (at + 2..samples.len()).take_while(|&to| fits(to)).last().unwrap_or(at + 1);
            self.fly(samples[at].at_s, &samples[at].pose, "smooth");
        }
    }

    fn fly(&mut self, at_s: f64, pose: &Pose, mode: &str) {
        let seconds = self.since(at_s);
        let (lat, lon) = self.anchor.geo_from_plan(pose.plan_pos);
        let when = stamp(self.day, pose.hour, self.anchor.lon);
        let Pose { eye_m, heading_deg, pitch_deg, fov_deg, .. } = *pose;
        self.line(format_args!(
            "<gx:FlyTo><gx:duration>{seconds:.3}</gx:duration><gx:flyToMode>{mode}</gx:flyToMode><Camera>\
             <gx:horizFov>{:.3}</gx:horizFov><gx:TimeStamp><when>{when}</when></gx:TimeStamp>\
             <longitude>{lon:.9}</longitude><latitude>{lat:.9}</latitude><altitude>{eye_m:.4}</altitude>\
             <heading>{heading_deg:.4}</heading><tilt>{:.4}</tilt><roll>0</roll>\
             <altitudeMode>relativeToGround</altitudeMode></Camera></gx:FlyTo>",
            across_deg(fov_deg),
            90.0 + pitch_deg,
        ));
    }

    fn show(&mut self, caption: usize, is_shown: bool) {
        self.line(format_args!(
            "<gx:AnimatedUpdate><gx:duration>0</gx:duration><Update><targetHref/><Change><Placemark targetId=\"caption-{caption}\">\
             <gx:balloonVisibility>{}</gx:balloonVisibility></Placemark></Change></Update></gx:AnimatedUpdate>",
            u8::from(is_shown)
        ));
    }

    /// The placemark whose balloon shows a caption, some steps before the eye.
    fn placemark(&mut self, index: usize, caption: &Caption, pose: &Pose, language: &str) {
        const AHEAD_M: f64 = 15.0;
        let heading = pose.heading_deg.to_radians();
        let ahead = pose.plan_pos + AHEAD_M * glam::DVec2::new(libm::sin(heading), libm::cos(heading));
        let (lat, lon) = self.anchor.geo_from_plan(ahead);
        let words = |text: &str| escaped(&escaped(text));
        let Spoken { text, translations } = &caption.text;
        let data: String = translations
            .iter()
            .map(|(code, text)| format!("<Data name=\"{}\"><value>{}</value></Data>", escaped(code), escaped(text)))
            .collect();
        let own = format!("<Data name=\"\"><value>{}</value></Data>", escaped(text));
        self.line(format_args!(
            "<Placemark id=\"caption-{index}\"><description>{}</description><styleUrl>#caption</styleUrl>\
             <ExtendedData>{own}{data}</ExtendedData><Point><altitudeMode>relativeToGround</altitudeMode>\
             <coordinates>{lon:.9},{lat:.9},{:.2}</coordinates></Point></Placemark>",
            words(caption.text.within(language)),
            pose.eye_m
        ));
    }
}
