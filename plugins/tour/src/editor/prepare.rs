//! What takes longer than a frame: streets about the tour, the tour compiled, recordings made into steps. It goes on beside the frames.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use veduta_city::{Step, Tour};
use veduta_ecs::{Around, City, Eye, OverviewWants, Viewer};
use veduta_route::{Recording, Sketch, joined, sketch};

use super::TourEditor;
use super::record::Recorder;
use crate::TourPlayer;
use crate::streets::{AROUND_TOUR_M, SEARCH_M, Streets, reach_m};

/// What is being prepared.
#[derive(Resource, Default)]
pub(super) struct Jobs {
    /// A recording that is to become steps.
    pub recorded: Option<Recording>,
    streets: Option<Task<Arc<Streets>>>,
    sketch: Option<(u64, Task<Sketch>)>,
    steps: Option<Task<Vec<Step>>>,
    /// How far about the city's start streets are asked for, metres.
    search_m: f64,
    /// How far from there the tour leads, metres, and the version of which that is true.
    reach: (Option<u64>, f64),
}

impl Jobs {
    pub fn is_busy(&self) -> bool {
        self.recorded.is_some() || self.streets.is_some() || self.sketch.is_some() || self.steps.is_some()
    }
}

fn start<T: Send + 'static>(job: impl FnOnce() -> T + Send + 'static) -> Task<T> {
    AsyncComputeTaskPool::get().spawn(async move { job() })
}

fn done<T>(task: &mut Task<T>) -> Option<T> {
    check_ready(task)
}

/// Asks for the streets about the city's start, as far as the tour, a recording and the visitor need them.
pub(super) fn ask_streets(
    city: Option<Res<City>>,
    (mut editor, recorder): (ResMut<TourEditor>, Res<Recorder>),
    viewers: Query<&Eye, With<Viewer>>,
    mut jobs: ResMut<Jobs>,
    mut wants: ResMut<OverviewWants>,
) {
    let Some(city) = city.filter(|_| editor.is_open || recorder.is_on()) else {
        OverviewWants::ask(&mut wants, "tour editor", None);
        if jobs.search_m != 0.0 {
            jobs.search_m = 0.0;
            editor.streets = None;
        }
        return;
    };
    let visitor_m = viewers.iter().map(|eye| eye.plan_pos.distance(city.start.pos)).fold(0.0, f64::max);
    let document = editor.document.as_ref();
    let version = document.and_then(|document| document.sketched);
    if jobs.reach.0 != version {
        let tour = document.and_then(|document| document.sketch.tour.as_ref());
        jobs.reach = (version, tour.map_or(0.0, |tour| reach_m(tour, city.start.pos)));
    }
    let needed_m = visitor_m.max(jobs.reach.1) + AROUND_TOUR_M;
    let mut search_m = jobs.search_m.max(SEARCH_M);
    while search_m < needed_m && !city.overviews.is_all(Around { middle: city.start.pos, radius_m: search_m }) {
        search_m *= 2.0;
    }
    if jobs.search_m != search_m {
        jobs.search_m = search_m;
    }
    let around = Around { middle: city.start.pos, radius_m: search_m };
    OverviewWants::ask(&mut wants, "tour editor", Some(around));
    let has = editor.streets.as_ref().is_some_and(|streets| streets.around == around);
    if has || jobs.streets.is_some() || !editor.is_open {
        return;
    }
    if let Some(parts) = Streets::parts(&city, around) {
        jobs.streets = Some(start(move || Arc::new(Streets::of(&parts, around))));
    }
}

/// Takes what is ready, shows it, and begins what is next.
pub(super) fn run(mut jobs: ResMut<Jobs>, mut editor: ResMut<TourEditor>, mut player: ResMut<TourPlayer>) {
    let (jobs, editor) = (&mut *jobs, &mut *editor);
    if let Some(streets) = jobs.streets.as_mut().and_then(done) {
        jobs.streets = None;
        editor.streets = Some(streets);
        if let Some(document) = &mut editor.document {
            document.sketched = None;
        }
    }
    take_sketch(jobs, editor, &mut player);
    let (Some(document), Some(streets)) = (&mut editor.document, &editor.streets) else { return };
    if let Some(steps) = jobs.steps.as_mut().and_then(done) {
        jobs.steps = None;
        let before = document.edit.selected().end.checked_sub(1);
        let stands = document.sketch.views.iter().rev().find(|(index, _)| before.is_some_and(|before| *index <= before));
        let has_steps = !document.edit.tour().steps.is_empty();
        let steps = joined(steps, stands.map(|(_, pose)| pose).filter(|_| has_steps));
        if let Err(error) = document.edit.insert(&steps) {
            editor.notice = error.to_string();
        }
    }
    if let Some(recording) = jobs.recorded.take_if(|_| jobs.steps.is_none()) {
        let (tour, streets) = (settings(document.edit.tour()), streets.clone());
        jobs.steps = Some(start(move || recording.steps(&tour, &streets.net, &streets.places)));
    }
    let version = document.edit.version();
    if document.sketched != Some(version) && jobs.sketch.is_none() {
        let (tour, streets) = (document.edit.tour().clone(), streets.clone());
        jobs.sketch = Some((version, start(move || sketch(&tour, &streets.net, &streets.places))));
    }
}

/// A tour without its steps.
fn settings(tour: &Tour) -> Tour {
    Tour { steps: Vec::new(), ..tour.clone() }
}

/// Takes a sketch that is ready, and has the player show it.
fn take_sketch(jobs: &mut Jobs, editor: &mut TourEditor, player: &mut TourPlayer) {
    let Some((version, sketch)) = jobs.sketch.as_mut().and_then(|(version, task)| Some((*version, done(task)?))) else { return };
    jobs.sketch = None;
    let (Some(document), Some(streets)) = (&mut editor.document, &editor.streets) else { return };
    document.sketched = Some(version);
    document.sketch = Arc::new(sketch);
    player.show(document.sketch.tour.clone(), streets.clone());
}
