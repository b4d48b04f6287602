//! Bridges: where a street runs over water or rails.
//!
//! A course and the streets share no node. Where a street's line crosses a course's, the stretch over it becomes a street of its
//! own, a layer above the ground, from bank to bank and a little beyond; where no more than that is left of the street, to
//! its end. So the layers join at the ends of streets alone, as those of made-up towns do.
//!
//! ```text
//!      quay ──●────────────── quay            ●  crossroads      ○  a joint of two
//!   ~~~~~~~~~~║~~~~~~~~~~~~~~~~~~~~~~
//!   ~~~~~~~~~~║~~ layer 1 ~~~~~~~~~~~
//!             ○
//!             │   layer 0
//! ```
//!
//! # Water and rails
//! Over water there is no other way than a bridge, or a dam: banks are where no water shows beside the street any more. Rails
//! may cross a street in its own plane. Maps draw them over the street then, as they draw a viaduct over it; so a street
//! whose paving shows no rails at all between rails on both sides of it runs over them, and any other stays on the ground.
//! A railway bridge over a street stays on the ground, too: which of the two is above cannot be told from a level crossing.

use glam::DVec2;
use veduta_city::WidthAt;

use super::bitmap::Bitmap;
use super::course::FoundCourse;
use super::read::ReadStreet;
use super::sketch::length;

/// How far a bridge goes on beyond the banks, metres.
const RUN_ON_M: f64 = 2.0;
/// No shorter piece of street is left between a bridge and the street's end: metres …
const LEAST_REST_M: f64 = 5.0;
/// … and widths of it.
const LEAST_REST_WIDTHS: f64 = 0.6;
/// Beside a street, so many pixels beyond its edge, its surroundings show.
const BESIDE_PX: f64 = 3.0;
/// How far from a course's line water is its own, in its half widths …
const COURSE_HALVES: f64 = 1.6;
/// … and pixels.
const COURSE_PX: f64 = 6.0;
/// Share of a crossing's pixels that may look like rails though none are drawn over the street.
const STRAY_RAILS: f64 = 0.05;
/// Share of the pixels of the rails' own line beside the street that must.
const RAILS_BESIDE: f64 = 0.6;
/// Sine of the least angle at which a street crosses.
const LEAST_SINE: f64 = 0.25;

/// Parts streets where they run over watercourses that are found: `water` shows them. Lines in pixels; `mpp`: metres a
/// pixel.
pub(crate) fn over_water(streets: Vec<ReadStreet>, courses: &[FoundCourse], water: &Bitmap, mpp: f64) -> Vec<ReadStreet> {
    parted(streets, courses, mpp, |half, street, crossing, course| Some(between_banks(half, &street.line, crossing, course, water)))
}

/// The same of railways, for streets that are painted over the rails.
pub(crate) fn over_rails(streets: Vec<ReadStreet>, courses: &[FoundCourse], rails: &Bitmap, mpp: f64) -> Vec<ReadStreet> {
    parted(streets, courses, mpp, |half, _, crossing, course| {
        is_painted_over(half, crossing, course, rails).then(|| {
            let reach = (course.half + half * crossing.cosine) / crossing.sine;
            [crossing.at - reach, crossing.at + reach]
        })
    })
}

/// Where a street's line crosses a course's.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    pos: DVec2,
    /// How far along the street, pixels, and which share of it.
    at: f64,
    share: f64,
    /// The course's direction, of length 1.
    course: DVec2,
    /// Of the angle between the two, at least [`LEAST_SINE`].
    sine: f64,
    cosine: f64,
}

/// Parts streets by the stretches that `stretch` gives for their crossings, in pixels along the street. It is told half the
/// street's width there.
fn parted(
    streets: Vec<ReadStreet>,
    courses: &[FoundCourse],
    mpp: f64,
    stretch: impl Fn(f64, &ReadStreet, &Crossing, &FoundCourse) -> Option<[f64; 2]>,
) -> Vec<ReadStreet> {
    let mut out = Vec::with_capacity(streets.len());
    for street in streets {
        let mut stretches = Vec::new();
        for course in courses {
            for crossing in crossings(&street.line, &course.line) {
                let half = street.width_at(crossing.share) / 2.0 / mpp;
                stretches.extend(stretch(half, &street, &crossing, course));
            }
        }
        if stretches.is_empty() || street.layer != 0 {
            out.push(street);
        } else {
            part(street, stretches, mpp, &mut out);
        }
    }
    out
}

/// Where two lines cross, in the order of the first.
fn crossings(street: &[DVec2], course: &[DVec2]) -> Vec<Crossing> {
    let bounds = |line: &[DVec2]| line.iter().fold((DVec2::MAX, DVec2::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
    let (low, high) = bounds(street);
    let mut found = Vec::new();
    for c in course.windows(2) {
        let (a, b) = bounds(c);
        if b.cmplt(low).any() || a.cmpgt(high).any() {
            continue;
        }
        let v = c[1] - c[0];
        let mut gone = 0.0;
        for s in street.windows(2) {
            let u = s[1] - s[0];
            let den = u.perp_dot(v);
            if den != 0.0 {
                let (t, along) = ((c[0] - s[0]).perp_dot(v) / den, (c[0] - s[0]).perp_dot(u) / den);
                // Half open: a crossing at a vertex is one.
                if (0.0..1.0).contains(&t) && (0.0..1.0).contains(&along) {
                    let (street_dir, course_dir) = (u.normalize_or(DVec2::X), v.normalize_or(DVec2::X));
                    let sine = street_dir.perp_dot(course_dir).abs().max(LEAST_SINE);
                    found.push(Crossing {
                        pos: s[0] + u * t,
                        at: gone + u.length() * t,
                        share: 0.0,
                        course: course_dir,
                        sine,
                        cosine: street_dir.dot(course_dir).abs(),
                    });
                }
            }
            gone += u.length();
        }
        found.iter_mut().for_each(|crossing| crossing.share = crossing.at / gone);
    }
    found.sort_by(|a, b| a.at.total_cmp(&b.at));
    found
}

/// From bank to bank about a crossing: as far as water shows on both sides of the street, and where it crosses at a slant, on one.
fn between_banks(half: f64, line: &[DVec2], crossing: &Crossing, course: &FoundCourse, water: &Bitmap) -> [f64; 2] {
    let near = COURSE_HALVES * course.half + COURSE_PX;
    let shows = |at: f64, both: bool| {
        let Some((p, ahead)) = place(line, at) else { return false };
        let wet = [ahead.perp(), -ahead.perp()].map(|side| {
            let q = p + side * (half + BESIDE_PX);
            water.get_at(q)
        });
        let is_wet = if both { wet[0] && wet[1] } else { wet[0] || wet[1] };
        is_wet && distance_to(&course.line, p) < near
    };
    let slant = 2.0 * half * crossing.cosine / crossing.sine + 2.0;
    let bank = |step: f64| {
        let (mut last, mut one) = (crossing.at, None);
        // Across half the course nothing is asked: piers and letters may hide the water at the crossing itself.
        let sure = 0.5 * course.half;
        let most = near / crossing.sine;
        let mut gone = 0.0;
        while gone < most {
            gone += 1.0;
            let at = crossing.at + step * gone;
            if gone <= sure || shows(at, true) {
                (last, one) = (at, None);
            } else if shows(at, false) && gone - (last - crossing.at).abs() <= slant {
                one = Some(at);
            } else {
                break;
            }
        }
        one.unwrap_or(last)
    };
    [bank(-1.0), bank(1.0)]
}

/// Whether a street is painted over the rails that it crosses: none show in it, and they do on both sides.
fn is_painted_over(half: f64, crossing: &Crossing, course: &FoundCourse, rails: &Bitmap) -> bool {
    let share = |from: f64, to: f64| {
        // Of the rails' band, from so far to so far along it from the crossing.
        let (mut all, mut set) = (0.0, 0.0);
        let (steps, lanes) = (((to - from).abs() as usize).max(2), (course.half as usize).max(1));
        for i in 0..=steps {
            let p = crossing.pos + crossing.course * (from + (to - from) * i as f64 / steps as f64);
            for lane in 0..=2 * lanes {
                let q = p + crossing.course.perp() * (0.7 * course.half * (lane as f64 / lanes as f64 - 1.0));
                all += 1.0;
                set += f64::from(u8::from(rails.get_at(q)));
            }
        }
        set / all
    };
    let slant = course.half * crossing.cosine / crossing.sine;
    let edge = half / crossing.sine;
    let inner = (0.8 * edge - slant).max(0.3 * edge);
    let (near, far) = (edge + slant + BESIDE_PX, edge + slant + BESIDE_PX + 3.0 * course.half + 6.0);
    share(-inner, inner) < STRAY_RAILS && share(near, far) > RAILS_BESIDE && share(-near, -far) > RAILS_BESIDE
}

fn distance_to(line: &[DVec2], p: DVec2) -> f64 {
    let to = |w: &[DVec2]| {
        let along = w[1] - w[0];
        let t = ((p - w[0]).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        p.distance(w[0] + along * t)
    };
    line.windows(2).map(to).fold(f64::MAX, f64::min)
}

/// The point so far along a line, and the direction there; nothing beyond its ends.
fn place(line: &[DVec2], at: f64) -> Option<(DVec2, DVec2)> {
    let mut left = at;
    if left < 0.0 {
        return None;
    }
    for w in line.windows(2) {
        let piece = w[0].distance(w[1]);
        if left <= piece && piece > 0.0 {
            return Some((w[0].lerp(w[1], left / piece), (w[1] - w[0]) / piece));
        }
        left -= piece;
    }
    None
}

/// Parts a street into what is on the ground and the stretches above it.
fn part(street: ReadStreet, mut stretches: Vec<[f64; 2]>, mpp: f64, out: &mut Vec<ReadStreet>) {
    let length = length(&street.line);
    let least = (LEAST_REST_M / mpp).max(LEAST_REST_WIDTHS * street.width / mpp);
    let run_on = RUN_ON_M / mpp;
    stretches.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for [from, to] in stretches {
        let (from, to) = (from - run_on, to + run_on);
        let from = if from < least { 0.0 } else { from };
        let to = if to > length - least { length } else { to };
        match merged.last_mut() {
            Some(last) if from < last[1] + least => last[1] = last[1].max(to),
            _ => merged.push([from, to]),
        }
    }
    let mut gone = 0.0;
    for [from, to] in merged {
        for (from, to, layer) in [(gone, from, 0), (from, to, 1)] {
            if to > from {
                out.push(street.between(from, to, length, layer));
            }
        }
        gone = to;
    }
    if gone < length {
        out.push(street.between(gone, length, length, 0));
    }
}

impl ReadStreet {
    /// Its width at a share of its length, metres.
    fn width_at(&self, share: f64) -> f64 {
        WidthAt::between(&self.profile, share).unwrap_or(self.width)
    }

    /// The part of it between two places along it, on a layer.
    fn between(&self, from: f64, to: f64, length: f64, layer: i8) -> Self {
        let end = |at: f64, or: Option<&DVec2>| place(&self.line, at).map_or_else(|| or.copied().unwrap_or_default(), |(p, _)| p);
        let (first, last) = (end(from, self.line.first()), end(to, self.line.last()));
        let mut line = vec![if from <= 0.0 { self.line.first().copied().unwrap_or(first) } else { first }];
        let mut gone = 0.0;
        for w in self.line.windows(2) {
            gone += w[0].distance(w[1]);
            if from + 1e-6 < gone && gone < to - 1e-6 {
                line.push(w[1]);
            }
        }
        line.push(if to >= length { self.line.last().copied().unwrap_or(last) } else { last });
        let profile = WidthAt::part(&self.profile, from / length, (to / length).min(1.0));
        Self { line, class: self.class, width: WidthAt::mean(&profile).unwrap_or(self.width), profile, layer }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MPP: f64 = 0.5;

    /// A band of 40 pixels about y = 150, but where `is_hidden`.
    fn band(is_hidden: impl Fn(DVec2) -> bool) -> (Bitmap, [FoundCourse; 1]) {
        let bitmap =
            Bitmap::from_fn(400, 300, |x, y| (130..170).contains(&y) && !is_hidden(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)));
        (bitmap, [FoundCourse { line: vec![DVec2::new(0.0, 150.0), DVec2::new(400.0, 150.0)], half: 20.0 }])
    }

    /// A street 10 m (20 pixels) wide.
    fn street(line: &[(f64, f64)]) -> ReadStreet {
        ReadStreet { line: line.iter().map(|&p| p.into()).collect(), width: 10.0, ..ReadStreet::default() }
    }

    fn is_under(line: &[DVec2]) -> impl Fn(DVec2) -> bool {
        move |p| distance_to(line, p) < 10.0
    }

    /// Checks layer, first and last point of every piece, to a pixel and a half.
    fn assert_pieces(pieces: &[ReadStreet], want: &[(i8, [f64; 2], [f64; 2])]) {
        let is_at = |p: Option<&DVec2>, want: [f64; 2]| p.is_some_and(|p| p.distance(want.into()) < 1.5);
        let is_it = |(piece, want): (&ReadStreet, &(i8, [f64; 2], [f64; 2]))| {
            piece.layer == want.0 && is_at(piece.line.first(), want.1) && is_at(piece.line.last(), want.2)
        };
        assert!(pieces.len() == want.len() && pieces.iter().zip(want).all(is_it), "{pieces:?} for {want:?}");
    }

    #[test]
    fn a_street_over_a_river_is_a_bridge_from_bank_to_bank() {
        let across = street(&[(200.0, 20.0), (200.0, 280.0)]);
        let (water, course) = band(is_under(&across.line));
        // Two metres beyond either bank.
        let parts = over_water(vec![across], &course, &water, MPP);
        assert_pieces(
            &parts,
            &[(0, [200.0, 20.0], [200.0, 126.0]), (1, [200.0, 126.0], [200.0, 174.0]), (0, [200.0, 174.0], [200.0, 280.0])],
        );
    }

    #[test]
    fn a_bridge_goes_to_the_crossroads_on_the_quay_and_no_further() {
        let across = street(&[(200.0, 122.0), (200.0, 280.0)]);
        let (water, course) = band(is_under(&[DVec2::new(200.0, 0.0), DVec2::new(200.0, 300.0)]));
        let parts = over_water(vec![across, street(&[(0.0, 122.0), (200.0, 122.0)])], &course, &water, MPP);
        let quay = (0, [0.0, 122.0], [200.0, 122.0]);
        assert_pieces(&parts, &[(1, [200.0, 122.0], [200.0, 174.0]), (0, [200.0, 174.0], [200.0, 280.0]), quay]);
    }

    #[test]
    fn a_bridge_at_a_slant_spans_the_water_of_both_its_sides() {
        let slanting = street(&[(70.0, 20.0), (330.0, 280.0)]);
        let (water, course) = band(is_under(&slanting.line));
        let parts = over_water(vec![slanting], &course, &water, MPP);
        let bridge = parts.iter().find(|s| s.layer == 1).expect("there is one");
        let (a, b) = (bridge.line[0], bridge.line[1]);
        // Its edges meet the banks 20 pixels apart along it.
        assert!((a.y - 120.0).abs() < 5.0 && (b.y - 180.0).abs() < 5.0, "{a} {b}");
    }

    #[test]
    fn rails_are_crossed_by_a_bridge_only_where_the_street_hides_them() {
        let across = || vec![street(&[(200.0, 20.0), (200.0, 280.0)])];
        let (hidden, course) = band(is_under(&across()[0].line));
        let (drawn_over, _) = band(|_| false);
        let (ends_there, _) = band(|p| p.x > 190.0);
        let (half_hidden, _) = band(|p| (200.0..210.0).contains(&p.x));
        let layers = |rails: &Bitmap| over_rails(across(), &course, rails, MPP).iter().map(|s| s.layer).collect::<Vec<i8>>();
        assert_eq!(layers(&hidden), [0, 1, 0]);
        assert_eq!((layers(&drawn_over), layers(&ends_there), layers(&half_hidden)), (vec![0], vec![0], vec![0]));
    }

    proptest! {
        #[test]
        fn parts_make_up_the_street(line in prop::collection::vec((0.0..400.0f64, 0.0..300.0f64), 2..8), widths in prop::collection::vec(3.0..20.0f64, 0..4)) {
            let mut whole = street(&line);
            let last = widths.len().max(2) as f64 - 1.0;
            whole.profile = widths.iter().enumerate().map(|(i, &width_m)| WidthAt { share: i as f64 / last, width_m }).collect();
            let (water, course) = band(is_under(&whole.line));
            let parts = over_water(vec![whole.clone()], &course, &water, MPP);
            let all: f64 = parts.iter().map(|part| length(&part.line)).sum();
            prop_assert!((all - length(&whole.line)).abs() < 1e-6, "{} of {}", all, length(&whole.line));
            prop_assert_eq!(parts[0].line.first(), whole.line.first());
            prop_assert_eq!(parts[parts.len() - 1].line.last(), whole.line.last());
            let mut gone = 0.0;
            for (i, part) in parts.iter().enumerate() {
                prop_assert!(i == 0 || part.line.first() == parts[i - 1].line.last() && part.layer != parts[i - 1].layer);
                if !widths.is_empty() {
                    let middle = (gone + length(&part.line) / 2.0) / all;
                    prop_assert!((part.width_at(0.5) - whole.width_at(middle)).abs() < 1e-6);
                }
                gone += length(&part.line);
            }
        }
    }
}
