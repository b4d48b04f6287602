//! Bells: what is struck when the city's clock passes a quarter.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta_city::LifeKind;
use veduta_ecs::{CityClock, Cue, Eye, Ground, Steering, Viewer};

use crate::population::Population;
use crate::settings::LifeSettings;
use crate::strike::{ClockWatch, Mark, strokes};

/// Strokes of one bell that may wait; who rings longer is not heard to the end.
const MOST_STROKES: usize = 120;
/// A clock that goes faster than this, hours a second, gives each hour one stroke: the next hour comes before twelve are struck.
const HURRIED: f64 = 1.0 / 120.0;

/// What the city's clock has told, and what is still to be struck.
#[derive(Resource, Debug, Default)]
pub(crate) struct Belfry {
    watch: ClockWatch,
    /// Strokes to come: when, of which bell, where.
    due: Vec<Stroke>,
    /// The last whole hour that was passed, and when.
    pub hour: Option<Mark>,
    /// When and where something was loud since the last frame.
    pub noises: Vec<(f64, DVec2)>,
    seen: (f64, f64),
}

#[derive(Debug, Clone)]
struct Stroke {
    at_s: f64,
    sound: String,
    plan_pos: DVec3,
    gain_db: f64,
    /// The first of several.
    is_first: bool,
}

/// Looks at the clock, and strikes what is due.
pub(crate) fn strike(
    (clock, steering): (Res<CityClock>, Res<Steering>),
    time: Res<Time>,
    settings: Res<LifeSettings>,
    population: Res<Population>,
    ground: Ground<'_>,
    viewers: Query<&Eye, With<Viewer>>,
    mut belfry: ResMut<Belfry>,
    mut cues: MessageWriter<Cue>,
) {
    let now_s = time.elapsed_secs_f64();
    let belfry = &mut *belfry;
    let look = belfry.watch.look(clock.hour, now_s);
    let (last_hour, last_s) = core::mem::replace(&mut belfry.seen, (clock.hour, now_s));
    let pace = ((clock.hour - last_hour + 12.0).rem_euclid(24.0) - 12.0) / (now_s - last_s).max(1e-9);
    if look.is_set {
        belfry.due.clear();
        belfry.hour = None;
    }
    // A tour that sets the hour does not mean its bells.
    let is_meant = !look.is_set || *steering != Steering::Guided;
    for mark in look.marks.into_iter().filter(|_| is_meant) {
        if mark.quarter.is_multiple_of(4) {
            belfry.hour = Some(mark);
        }
        if settings.kinds.bells {
            let near = |plan_pos: DVec2| viewers.iter().any(|eye| eye.plan_pos.distance(plan_pos) < 1_500.0);
            let is_hurried = !look.is_set && pace > HURRIED;
            toll(&population, mark, is_hurried, &near, &ground, &mut belfry.due);
        }
    }
    belfry.noises.clear();
    // Strokes come in the order in which they are due, whatever the frames.
    belfry.due.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    let come = belfry.due.partition_point(|stroke| stroke.at_s <= now_s);
    for stroke in belfry.due.drain(..come) {
        if stroke.is_first {
            belfry.noises.push((stroke.at_s, stroke.plan_pos.truncate()));
        }
        cues.write(Cue { sound: stroke.sound, plan_pos: stroke.plan_pos, gain_db: stroke.gain_db as f32 });
    }
}

/// Puts the strokes of a quarter where they will be struck.
fn toll(
    population: &Population,
    mark: Mark,
    is_hurried: bool,
    is_near: &dyn Fn(DVec2) -> bool,
    ground: &Ground<'_>,
    due: &mut Vec<Stroke>,
) {
    for dweller in population.dwellers().filter(|dweller| is_near(dweller.plan_pos)) {
        let LifeKind::Bell { sound, tells, every_s, after_s, gain_db } = &dweller.kind else { continue };
        let count = strokes(tells, mark.quarter).min(MOST_STROKES as u32);
        let count = if is_hurried { count.min(1) } else { count };
        let z_m = ground.at(dweller.plan_pos, f64::INFINITY) + dweller.height_m;
        due.extend((0..count).map(|n| Stroke {
            at_s: mark.at_s + after_s + every_s * f64::from(n),
            sound: sound.clone(),
            plan_pos: dweller.plan_pos.extend(z_m),
            gain_db: *gain_db,
            is_first: n == 0,
        }));
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use veduta_city::{Life, LivingThing, Tells, Where};

    use super::*;
    use crate::{CityLife, LifePlugin};

    fn bell(name: &str, tells: Tells, after_s: f64) -> LivingThing {
        LivingThing {
            name: name.to_owned(),
            at: Where::At(10.0, 20.0),
            by: DVec2::ZERO,
            height_m: 30.0,
            heading_deg: 0.0,
            kind: LifeKind::Bell { sound: format!("bell.{name}"), tells, every_s: 2.0, after_s, gain_db: -3.0 },
        }
    }

    /// A town with two bells, seen at some frames a second.
    fn town(fps: f64) -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, LifePlugin))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / fps)))
            .insert_resource(CityLife::of(Life {
                things: vec![bell("hour", Tells::Hours, 5.0), bell("quarter", Tells::Quarters, 0.0)],
                ..Life::default()
            }));
        app.world_mut().spawn((Viewer, Eye::default()));
        app
    }

    /// Runs for some seconds; which sounds were asked for, and when, to a frame.
    fn listen(app: &mut App, seconds: f64, fps: f64) -> Vec<(f64, Cue)> {
        let mut heard = Vec::new();
        for _ in 0..(seconds * fps).round() as u32 {
            let pace = app.world().resource::<CityClock>().pace;
            let mut clock = app.world_mut().resource_mut::<CityClock>();
            // As the sky lets it run.
            clock.hour = (clock.hour + pace / fps / 3600.0).rem_euclid(24.0);
            app.update();
            let now_s = app.world().resource::<Time>().elapsed_secs_f64();
            heard.extend(app.world_mut().resource_mut::<Messages<Cue>>().drain().map(|cue| (now_s, cue)));
        }
        heard
    }

    #[test]
    fn bells_tell_the_hour_stroke_by_stroke() {
        for fps in [20.0, 144.0] {
            let mut app = town(fps);
            app.insert_resource(CityClock { hour: 2.999, pace: 1.0, ..CityClock::default() });
            let heard = listen(&mut app, 30.0, fps);
            let when = |sound: &str| heard.iter().filter(|(_, cue)| cue.sound == sound).map(|(when, _)| *when).collect::<Vec<_>>();
            let (quarters, hours) = (when("bell.quarter"), when("bell.hour"));
            assert_eq!((quarters.len(), hours.len()), (4, 3), "{heard:?}");
            for (n, (quarter, first)) in quarters.iter().zip([3.6, 5.6, 7.6, 9.6]).enumerate() {
                assert!((quarter - first).abs() < 2.5 / fps, "stroke {n} at {quarter}, not {first}");
            }
            assert!((hours[0] - 8.6).abs() < 2.5 / fps && (hours[2] - 12.6).abs() < 2.5 / fps, "{hours:?}");
            assert!(heard.iter().all(|(_, cue)| cue.plan_pos == DVec3::new(10.0, 20.0, 30.0) && cue.gain_db == -3.0));
        }
    }

    #[test]
    fn nothing_is_struck_that_was_leapt_over() {
        let mut app = town(60.0);
        app.insert_resource(CityClock { hour: 9.1, ..CityClock::default() });
        assert!(listen(&mut app, 1.0, 60.0).is_empty());
        for hour in [17.3, 4.6, 23.9] {
            app.world_mut().resource_mut::<CityClock>().hour = hour;
            assert!(listen(&mut app, 3.0, 60.0).is_empty(), "set to {hour}");
        }
        app.world_mut().resource_mut::<CityClock>().hour = 12.0;
        let noon = listen(&mut app, 60.0, 60.0);
        assert_eq!(noon.iter().filter(|(_, cue)| cue.sound == "bell.hour").count(), 12, "who sets it to noon hears noon");
        // A tour that sets it means the light.
        app.insert_resource(Steering::Guided);
        app.world_mut().resource_mut::<CityClock>().hour = 15.0;
        assert!(listen(&mut app, 20.0, 60.0).is_empty());
        app.insert_resource(Steering::Visitor);
        // Who sets it stops it by setting it again.
        app.world_mut().resource_mut::<CityClock>().hour = 11.0;
        let begun = listen(&mut app, 7.0, 60.0);
        app.world_mut().resource_mut::<CityClock>().hour = 11.4;
        let rest = listen(&mut app, 40.0, 60.0);
        assert!(!begun.is_empty() && rest.is_empty(), "{begun:?} {rest:?}");
    }

    #[test]
    fn a_hurried_clock_gives_each_hour_one_stroke_and_a_racing_one_none() {
        let mut app = town(60.0);
        app.insert_resource(CityClock { hour: 8.9, pace: 3600.0 * 0.1, ..CityClock::default() });
        let heard = listen(&mut app, 22.0, 60.0);
        let hours = heard.iter().filter(|(_, cue)| cue.sound == "bell.hour").count();
        assert_eq!(hours, 2, "9 and 10 have been struck by now: {heard:?}");
        let mut app = town(60.0);
        app.insert_resource(CityClock { hour: 8.9, pace: 3600.0, ..CityClock::default() });
        assert!(listen(&mut app, 30.0, 60.0).is_empty());
    }

    #[test]
    fn who_wants_no_bells_hears_none() {
        let mut app = town(60.0);
        app.world_mut().resource_mut::<LifeSettings>().kinds.bells = false;
        app.insert_resource(CityClock { hour: 2.999, pace: 1.0, ..CityClock::default() });
        assert!(listen(&mut app, 20.0, 60.0).is_empty());
    }
}
