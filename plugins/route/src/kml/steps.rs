//! A camera over time as the steps of a tour.

use veduta_city::{LookAt, Step, Tour, Where};

use super::{
    View,
    playlist::{Piece, Words},
};
use crate::{
    pose::{Facing, smoothstep, turn_deg},
    track::{Key, Track},
};

/// How long a `Start` stands in the dark.
const START_S: f64 = 0.8;
/// Longest and shortest fade of a cut, in seconds.
const FADES_S: (f64, f64) = (1.6, 0.4);
/// Most samples that are told as one turn of a dial.
const MOST_SAMPLES: usize = 1000;
/// Moments nearer than this are one.
const SAME_S: f64 = 5e-4;

/// What goes on beside the camera, from a moment on.
pub(super) type Aside = (f64, Step);

/// The steps of pieces in their order, with asides at their moments; and by how many seconds they are late in the end.
pub(super) fn steps(mut pieces: Vec<Piece>, asides: Vec<Aside>) -> (Vec<Step>, f64) {
    let (fades, late_s) = fades(&mut pieces);
    let mut out = Out { steps: Vec::new(), asides: asides.into(), follows_track: false, last: None };
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Place { at_s, view } => out.place(*at_s, view, i == 0, fades[i]),
            Piece::Rest { from_s, to_s } => out.rest(*from_s, *to_s),
            Piece::Track { from_s, keys } => out.track(*from_s, keys),
        }
    }
    out.until(f64::INFINITY);
    (out.steps, late_s)
}

/// Takes the time that fades need from the standing about them; says how long each is, and how much was not to be had.
fn fades(pieces: &mut [Piece]) -> (Vec<f64>, f64) {
    let (mut fades, mut late_s) = (vec![0.0; pieces.len()], 0.0);
    for i in 0..pieces.len() {
        let Piece::Place { view, .. } = pieces[i] else { continue };
        let after = pieces.get(i + 1).map_or(f64::INFINITY, |next| standing_first(next, &view));
        let (head, half) = if i == 0 {
            (0.0, START_S)
        } else {
            let before = standing_last(&pieces[i - 1]);
            let half = before.min(after).clamp(FADES_S.1 / 2.0, FADES_S.0 / 2.0);
            (half, half)
        };
        let mut taken = 0.0;
        if i > 0 {
            taken += shorten_end(&mut pieces[i - 1], head);
        }
        taken += pieces.get_mut(i + 1).map_or(half, |next| shorten_start(next, half, &view));
        late_s += head + half - taken;
        fades[i] = head + half;
    }
    (fades, late_s)
}

fn is_same(a: &View, b: &View) -> bool {
    let turn = turn_deg(a.heading_deg, b.heading_deg).abs().max((a.pitch_deg - b.pitch_deg).abs());
    a.at.distance(b.at) < 1e-3 && turn < 0.01
}

fn standing_first(piece: &Piece, view: &View) -> f64 {
    match piece {
        Piece::Rest { from_s, to_s } => to_s - from_s,
        Piece::Track { from_s, keys } => {
            keys.iter().take_while(|(_, key)| is_same(key, view)).last().map_or(0.0, |(at_s, _)| at_s - from_s)
        }
        Piece::Place { .. } => 0.0,
    }
}

fn standing_last(piece: &Piece) -> f64 {
    match piece {
        Piece::Rest { from_s, to_s } => to_s - from_s,
        Piece::Track { keys, .. } => keys.last().map_or(0.0, |(end_s, last)| {
            keys.iter().rev().take_while(|(_, key)| is_same(key, last)).last().map_or(0.0, |(at_s, _)| end_s - at_s)
        }),
        Piece::Place { .. } => 0.0,
    }
}

/// Takes standing off a piece's begin; says how much there was.
fn shorten_start(piece: &mut Piece, seconds: f64, view: &View) -> f64 {
    let taken = standing_first(piece, view).min(seconds);
    match piece {
        Piece::Rest { from_s, .. } => *from_s += taken,
        Piece::Track { from_s, keys } => {
            *from_s += taken;
            let start_s = *from_s + SAME_S;
            keys.retain(|(at_s, _)| *at_s > start_s);
        }
        Piece::Place { .. } => {}
    }
    taken
}

fn shorten_end(piece: &mut Piece, seconds: f64) -> f64 {
    let taken = standing_last(piece).min(seconds);
    match piece {
        Piece::Rest { to_s, .. } => *to_s -= taken,
        Piece::Track { keys, .. } if taken > 0.0 => {
            if let Some(&(end_s, last)) = keys.last() {
                keys.retain(|(at_s, _)| *at_s < end_s - taken - SAME_S);
                keys.push((end_s - taken, last));
            }
        }
        _ => {}
    }
    taken
}

/// Whole thousandths.
fn rounded(value: f64) -> f64 {
    // Not a negative zero, which a file would show.
    libm::round(value * 1000.0) / 1000.0 + 0.0
}

struct Out {
    steps: Vec<Step>,
    asides: std::collections::VecDeque<Aside>,
    /// Whether the last step that took time is a track: one that is to begin at rest must be parted from it.
    follows_track: bool,
    last: Option<View>,
}

impl Out {
    /// What goes on from before a moment.
    fn until(&mut self, at_s: f64) {
        while self.asides.front().is_some_and(|aside| aside.0 < at_s) {
            self.steps.extend(self.asides.pop_front().map(|aside| aside.1));
        }
    }

    fn place(&mut self, at_s: f64, view: &View, is_first: bool, fade_s: f64) {
        self.until(if is_first { START_S / 2.0 } else { at_s });
        let at = Where::At(rounded(view.at.x), rounded(view.at.y));
        let look = LookAt::Heading { deg: rounded(view.heading_deg), pitch_deg: rounded(view.pitch_deg) };
        let eye_m = Some(rounded(view.at.z));
        self.steps.push(if is_first {
            Step::Start { at, eye_m, look }
        } else {
            Step::Cut { to: at, eye_m, look, seconds: rounded(fade_s) }
        });
        (self.follows_track, self.last) = (false, Some(*view));
    }

    fn rest(&mut self, mut from_s: f64, to_s: f64) {
        loop {
            self.until(from_s + SAME_S);
            let until_s = self.asides.front().map_or(to_s, |aside| aside.0.min(to_s));
            if until_s - from_s > SAME_S {
                self.steps.push(Step::Wait { seconds: rounded(rounded(until_s) - rounded(from_s)) });
                self.follows_track = false;
            }
            if until_s >= to_s - SAME_S {
                return;
            }
            from_s = until_s;
        }
    }

    fn track(&mut self, from_s: f64, keys: &[(f64, View)]) {
        let (Some(last), Some(&(end_s, end))) = (self.last, keys.last()) else { return };
        if self.follows_track {
            self.steps.push(Step::Wait { seconds: 0.0 });
        }
        let key = |at_s: f64, view: &View| Key {
            seconds: at_s - from_s,
            at: view.at,
            facing: Facing { heading: view.heading_deg, pitch: view.pitch_deg },
        };
        let curve = Track::new(core::iter::once(key(from_s, &last)).chain(keys.iter().map(|(at_s, view)| key(*at_s, view))));
        let (mut own, mut start_s) = (Vec::new(), from_s);
        self.until(start_s + SAME_S);
        for (at_s, view) in self.parted(from_s, keys, &curve) {
            own.push((at_s, view));
            if self.asides.front().is_some_and(|aside| aside.0 < at_s + SAME_S) {
                self.end(&mut own, &mut start_s, at_s);
            }
        }
        self.end(&mut own, &mut start_s, end_s);
        (self.follows_track, self.last) = (true, Some(end));
    }

    /// The keys, and others on their curve wherever something begins between two of them, so that the track can be parted there and
    /// keeps its way.
    fn parted(&self, from_s: f64, keys: &[(f64, View)], curve: &Track) -> Vec<(f64, View)> {
        const PARTS: u32 = 16;
        let (mut parted, mut before_s) = (Vec::with_capacity(keys.len()), from_s);
        for &(at_s, view) in keys {
            let first = self.asides.partition_point(|aside| aside.0 <= before_s + SAME_S);
            let within = self.asides.iter().skip(first).map(|aside| aside.0).take_while(|t| *t < at_s - SAME_S);
            let mut times: Vec<f64> = within.collect();
            if !times.is_empty() {
                times.extend((1..PARTS).map(|i| before_s + (at_s - before_s) * f64::from(i) / f64::from(PARTS)));
                times.sort_by(f64::total_cmp);
                times.dedup_by(|b, a| *b - *a < SAME_S);
            }
            parted.extend(times.into_iter().map(|t| {
                let facing = curve.facing(t - from_s);
                (t, View { at: curve.at(t - from_s), heading_deg: facing.heading, pitch_deg: facing.pitch, ..view })
            }));
            parted.push((at_s, view));
            before_s = at_s;
        }
        parted
    }

    /// Writes the keys so far as a step, and what goes on from its end.
    fn end(&mut self, own: &mut Vec<(f64, View)>, start_s: &mut f64, end_s: f64) {
        let start = rounded(*start_s);
        let key = |(at_s, view): (f64, View)| {
            let seconds = rounded(rounded(at_s) - start);
            let heading = rounded(view.heading_deg.rem_euclid(360.0));
            (seconds, rounded(view.at.x), rounded(view.at.y), rounded(view.at.z), heading, rounded(view.pitch_deg))
        };
        let mut keys: Vec<_> = own.drain(..).map(key).collect();
        // Keys of one moment, and of none, after rounding.
        keys.retain(|key| key.0 > 0.0);
        keys.dedup_by(|b, a| b.0 <= a.0);
        if !keys.is_empty() {
            self.steps.push(Step::Track { keys });
        }
        *start_s = end_s;
        self.until(end_s + SAME_S);
    }
}

/// Words as steps, each for a while.
pub(super) fn said(words: Vec<Words>) -> Vec<Aside> {
    /// No words are looked at for longer.
    const LONGEST_S: f64 = 300.0;
    let step = |words: Words| {
        let seconds = words.until_s.map(|until_s| rounded(until_s - words.at_s).min(LONGEST_S));
        (words.at_s, Step::Say { text: words.text, translations: words.translations, seconds })
    };
    let is_seen = |words: &Words| !words.text.is_empty() && words.until_s.is_none_or(|until_s| until_s > words.at_s + SAME_S);
    words.into_iter().filter(is_seen).map(step).collect()
}

/// Changes of a number over time as steps: each as long as it fits one turn of a dial, within `near`.
pub(super) fn dialled(values: &[(f64, f64)], near: f64, step: impl Fn(f64, f64) -> Step) -> Vec<Aside> {
    let mut turns = Vec::new();
    let mut at = 0;
    while at + 1 < values.len() {
        let ((start_s, from), (next_s, next)) = (values[at], values[at + 1]);
        if (next - from).abs() < 1e-6 {
            at += 1;
            continue;
        }
        if next_s - start_s < SAME_S {
            turns.push((next_s, step(rounded(next), 0.0)));
            at += 1;
            continue;
        }
        let goes_on = |pair: &[(f64, f64)]| pair[1].0 - pair[0].0 >= SAME_S && (pair[1].1 - pair[0].1) * (next - from) > 0.0;
        let mut end = at + values[at..].windows(2).take(MOST_SAMPLES).take_while(|pair| goes_on(pair)).count();
        let fits = |end: usize| {
            let (end_s, to) = values[end];
            values[at..=end].iter().all(|(t, value)| {
                let turned = from + (to - from) * smoothstep((t - start_s) / (end_s - start_s));
                (turned - value).abs() <= near
            })
        };
        while end > at + 1 && !fits(end) {
            end = at + (end - at) / 2;
        }
        let (end_s, to) = values[end];
        turns.push((start_s, step(rounded(to), rounded(end_s - start_s))));
        at = end;
    }
    turns
}

/// A tour of these steps with a city's name and a title.
pub(super) fn tour(title: String, city: &str, first: (Option<f64>, Option<(u16, f64)>), steps: Vec<Step>) -> Tour {
    let (fov, stamp) = first;
    let mut tour = Tour::new(title, city.to_owned());
    tour.fov_deg = fov.unwrap_or(tour.fov_deg);
    if let Some((day, hour)) = stamp {
        (tour.day, tour.hour) = (day, rounded(hour));
    }
    tour.steps = steps;
    tour
}
