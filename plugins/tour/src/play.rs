use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::Tour;
use veduta_ecs::{Awaited, CityClock, Eye, Itinerary, Steering, Stop, TourPath, Viewer, Weather};
use veduta_route::{CompiledTour, Pose, ResumeLeg, resume};

use crate::TourAsset;
use crate::accompany::Moments;
use crate::follow::Following;
use crate::streets::Streets;

/// What to do with the tour.
#[derive(Message, Debug, Clone, PartialEq)]
pub enum TourCommand {
    /// Load a tour from the asset server (a path such as `royal_route.tour.ron`) and play it as soon as it can be.
    Open(String),
    /// Play a tour given as a value.
    Give(Box<Tour>),
    /// Play on; after wandering off, from where the visitor is now.
    Play,
    /// Stand still.
    Pause,
    /// Play or pause, whichever it is not.
    Toggle,
    /// Go to a second of the tour.
    Seek(f64),
    /// Play at a multiple of the written speed, 0.1 to 8.
    Speed(f64),
    /// End it.
    Stop,
}

/// A tour has come to its end or was stopped.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct TourEnded {
    /// Its title.
    pub title: String,
    /// Whether its end was reached.
    pub finished: bool,
}

/// A moment that the tour marks has come while it played; what is passed over by going elsewhere in time is not told.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct TourMark {
    /// What the tour calls it.
    pub name: String,
}

/// How the tour stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TourState {
    /// No tour.
    #[default]
    Idle,
    /// The tour, or the streets it walks on, have not arrived.
    Waiting,
    /// On its way.
    Playing,
    /// On the way back to where it was left.
    Returning,
    /// Standing still.
    Paused,
    /// The visitor has taken the controls; [`TourCommand::Play`] resumes.
    Wandering,
}

/// After a cut (a start, a seek) the tour stands in the dark until what is in sight stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) enum Hold {
    /// Nothing to wait for.
    #[default]
    None,
    /// The eye goes there in this frame; only then is it known what is in sight.
    Cut,
    /// In the dark.
    Dark,
    /// Clearing, from 1 to 0.
    Clearing(f64),
}

/// Seconds in which the dark after a cut clears.
const CLEAR_S: f64 = 0.3;

impl Hold {
    /// The hold of the next frame, and how dark it makes this one. Where no time passes (films settle each frame by
    /// themselves) nothing is dark.
    fn next(self, seconds: f64, awaited: &Awaited) -> (Self, f64) {
        match self {
            Self::None => (Self::None, 0.0),
            Self::Dark if awaited.cells == 0 && seconds <= 0.0 => (Self::None, 0.0),
            Self::Dark if awaited.cells == 0 => (Self::Clearing(1.0), 1.0),
            Self::Cut | Self::Dark => (Self::Dark, if seconds > 0.0 { 1.0 } else { 0.0 }),
            Self::Clearing(dark) => {
                let left = dark - seconds / CLEAR_S;
                (if left > 0.0 { Self::Clearing(left) } else { Self::None }, left.max(0.0))
            }
        }
    }

    /// Whether the tour's time stands still.
    fn is_still(self) -> bool {
        matches!(self, Self::Cut | Self::Dark)
    }
}

/// The tour player.
#[derive(Resource, Default)]
pub struct TourPlayer {
    pub(crate) handle: Option<Handle<TourAsset>>,
    /// The tour that was given as a value.
    pub(crate) given: Option<Box<Tour>>,
    pub(crate) source: Option<Tour>,
    pub(crate) compiled: Option<CompiledTour>,
    /// How often it was compiled.
    versions: u64,
    /// Streets and places that it was compiled with.
    streets: Option<Arc<Streets>>,
    /// How far about the city's start its streets are looked for, if farther than at first.
    pub(crate) search_m: Option<f64>,
    pub(crate) state: TourState,
    pub(crate) t_s: f64,
    speed: Option<f64>,
    pub(crate) hold: Hold,
    /// Whether it stands still until what lies ahead stands.
    waits: bool,
    leg: Option<(ResumeLeg, f64)>,
    pub(crate) play_when_ready: bool,
    /// Whether it has just been sent to another time: what is marked there counts.
    has_sought: bool,
    pub(crate) last_error: Option<String>,
    /// Whether it is under edit: what is played then comes from there, not from its file.
    pub(crate) is_edited: bool,
    /// Grows whenever it is sent to another time.
    seeks: u64,
}

impl TourPlayer {
    /// How it stands.
    #[must_use]
    pub fn state(&self) -> TourState {
        self.state
    }

    /// Whether it stands still, under way as it is, because what lies ahead has not come.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.waits
    }

    /// Second of the tour that is shown.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.t_s
    }

    /// Multiple of the written speed.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed.unwrap_or(1.0)
    }

    /// The tour, once it is ready.
    #[must_use]
    pub fn tour(&self) -> Option<&CompiledTour> {
        self.compiled.as_ref()
    }

    /// Caption of this moment in a language, told by its code; in the tour's own where there is none in it.
    #[must_use]
    pub fn caption(&self, language: &str) -> Option<&str> {
        let shown = matches!(self.state, TourState::Playing | TourState::Paused);
        self.compiled.as_ref().filter(|_| shown)?.caption_in(self.t_s, language)
    }

    /// What is wrong with the tour, if anything is.
    #[must_use]
    pub fn error(&self) -> Option<&str> {
        self.last_error.as_deref()
    }

    /// Which tour it is, by a number of its own; another once its file has changed.
    pub(crate) fn version(&self) -> u64 {
        self.versions
    }

    /// How often it was sent to another time.
    pub(crate) fn seeks(&self) -> u64 {
        self.seeks
    }

    /// A path of the asset server for a file beside the tour's. A tour that was given as a value lies among the assets.
    pub(crate) fn beside(&self, file: &str) -> String {
        let tour = self.handle.as_ref().and_then(Handle::path);
        let path = tour.and_then(|tour| tour.resolve_embed_str(file).ok());
        path.map_or_else(|| file.to_owned(), |path| path.to_string())
    }

    pub(crate) fn forget(&mut self) {
        *self = Self { speed: self.speed, versions: self.versions + 1, ..Self::default() };
    }

    /// Has a tour that can be played, in place of the one before.
    pub(crate) fn put(&mut self, tour: CompiledTour, streets: Arc<Streets>) {
        (self.compiled, self.streets, self.last_error) = (Some(tour), Some(streets), None);
        self.versions += 1;
    }

    /// Shows a tour under edit: at the same second as long as it has that. Whoever has the eye keeps it.
    pub(crate) fn show(&mut self, tour: Option<CompiledTour>, streets: Arc<Streets>) {
        self.source = None;
        let Some(tour) = tour else {
            (self.compiled, self.state, self.t_s) = (None, TourState::Idle, 0.0);
            self.versions += 1;
            return;
        };
        self.t_s = self.t_s.min(tour.duration_s());
        self.put(tour, streets);
        if matches!(self.state, TourState::Idle | TourState::Waiting) {
            (self.state, self.play_when_ready) = (TourState::Wandering, false);
        }
    }

    /// Stands at a second of the tour, and takes the eye there: behind a fade if that is far.
    pub(crate) fn stand_at(&mut self, t_s: f64, eye: Option<&Eye>, steering: &mut Steering) {
        const NEAR_M: f64 = 40.0;
        let Some(tour) = &self.compiled else { return };
        self.t_s = t_s.clamp(0.0, tour.duration_s());
        let there = tour.pose(self.t_s).plan_pos;
        let is_near = eye.is_some_and(|eye| eye.plan_pos.distance(there) < NEAR_M);
        self.hold = if is_near { Hold::None } else { Hold::Cut };
        (self.leg, self.state) = (None, TourState::Paused);
        *steering = Steering::Guided;
    }
}

/// Obeys commands.
pub(crate) fn obey(
    mut commands: MessageReader<TourCommand>,
    assets: Res<AssetServer>,
    mut player: ResMut<TourPlayer>,
    mut steering: ResMut<Steering>,
    viewers: Query<&Eye, With<Viewer>>,
    clock: Res<CityClock>,
    mut ended: MessageWriter<TourEnded>,
) {
    for command in commands.read() {
        match command {
            TourCommand::Open(path) => {
                player.forget();
                player.handle = Some(assets.load(path.clone()));
                player.play_when_ready = true;
                player.state = TourState::Waiting;
            }
            TourCommand::Give(tour) => {
                player.forget();
                player.source = Some((**tour).clone());
                player.given = Some(tour.clone());
                player.play_when_ready = true;
                player.state = TourState::Waiting;
            }
            TourCommand::Play => play_on(&mut player, &mut steering, viewers.iter().next(), &clock),
            TourCommand::Pause => pause(&mut player),
            TourCommand::Toggle if player.state == TourState::Playing => pause(&mut player),
            TourCommand::Toggle => play_on(&mut player, &mut steering, viewers.iter().next(), &clock),
            TourCommand::Seek(t_s) => {
                let end = player.compiled.as_ref().map_or(0.0, CompiledTour::duration_s);
                player.t_s = if t_s.is_finite() { t_s.clamp(0.0, end) } else { player.t_s };
                player.hold = Hold::Cut;
                player.has_sought = true;
                player.seeks += 1;
                // Who goes to a moment of the tour is on the tour again.
                if matches!(player.state, TourState::Returning | TourState::Wandering) {
                    (player.leg, player.state) = (None, TourState::Playing);
                    steering.set_if_neq(Steering::Guided);
                }
            }
            TourCommand::Speed(times) if times.is_finite() => player.speed = Some(times.clamp(0.1, 8.0)),
            TourCommand::Speed(_) => {}
            TourCommand::Stop => {
                if let Some(tour) = &player.compiled {
                    ended.write(TourEnded { title: tour.title().to_owned(), finished: false });
                }
                player.forget();
                // Whoever else leads goes on.
                if *steering == Steering::Guided {
                    *steering = Steering::Visitor;
                }
            }
        }
    }
}

fn pause(player: &mut TourPlayer) {
    if player.state == TourState::Playing {
        player.state = TourState::Paused;
    }
}

fn play_on(player: &mut TourPlayer, steering: &mut ResMut<Steering>, eye: Option<&Eye>, clock: &CityClock) {
    match player.state {
        TourState::Paused => {
            player.state = TourState::Playing;
            // From its end it begins again.
            if player.compiled.as_ref().is_some_and(|tour| player.t_s >= tour.duration_s()) {
                (player.t_s, player.hold) = (0.0, Hold::Cut);
                player.seeks += 1;
            }
        }
        TourState::Wandering => {
            let (Some(tour), Some(streets), Some(eye)) = (&player.compiled, &player.streets, eye) else { return };
            player.leg = Some((resume(tour, &streets.net, pose_of(eye, clock.hour), player.t_s), 0.0));
            player.state = TourState::Returning;
        }
        TourState::Idle | TourState::Waiting => player.play_when_ready = true,
        TourState::Playing | TourState::Returning => {}
    }
    if matches!(player.state, TourState::Playing | TourState::Returning) {
        steering.set_if_neq(Steering::Guided);
    }
}

/// Where an eye is and looks, at an hour.
pub(crate) fn pose_of(eye: &Eye, hour: f64) -> Pose {
    Pose {
        plan_pos: [eye.plan_pos.x, eye.plan_pos.y].into(),
        eye_m: eye.eye_m,
        heading_deg: eye.heading_deg,
        pitch_deg: eye.pitch_deg,
        fov_deg: eye.fov_deg,
        hour,
        fade: eye.fade,
    }
}

/// Tells where the viewers will be, and once that the tour leads nowhere any more: others may lead then.
fn tell_ahead(player: &TourPlayer, has_told: &mut bool, itineraries: &mut Query<&mut Itinerary, With<Viewer>>) {
    let is_under_way = matches!(player.state, TourState::Waiting | TourState::Playing | TourState::Returning | TourState::Paused);
    let tour = player.compiled.as_ref().filter(|_| is_under_way);
    let stop = |tour: &CompiledTour, in_s: f64| {
        let in_s_of_it = in_s * player.speed();
        let pose = match &player.leg {
            Some((leg, t_s)) if t_s + in_s_of_it < leg.duration_s() => leg.pose(t_s + in_s_of_it),
            Some((leg, t_s)) => tour.pose(leg.resumes_at_s() + t_s + in_s_of_it - leg.duration_s()),
            None => tour.pose(player.t_s + in_s_of_it),
        };
        Stop { in_s, plan_pos: pose.plan_pos, eye_m: pose.eye_m }
    };
    let stops = tour.map_or_else(Vec::new, |tour| Itinerary::AHEAD_S.iter().map(|&in_s| stop(tour, in_s)).collect());
    if stops.is_empty() && !*has_told {
        return;
    }
    *has_told = !stops.is_empty();
    for mut itinerary in itineraries {
        itinerary.set_if_neq(Itinerary(stops.clone()));
    }
}

/// Share of the sky that clouds cover when it rains.
const RAIN_CLOUDS: f32 = 0.85;

/// Tells others where the tour leads.
pub(crate) fn tell_path(player: Res<TourPlayer>, mut path: ResMut<TourPath>, mut told: Local<Option<u64>>) {
    if !player.is_changed() {
        return;
    }
    let now = player.compiled.as_ref().map(|_| player.versions);
    if *told != now {
        path.set_if_neq(TourPath(player.compiled.as_ref().map_or_else(Vec::new, CompiledTour::paths)));
        *told = now;
    }
}

/// Moves the eye along the tour.
pub(crate) fn play(
    time: Res<Time>,
    mut player: ResMut<TourPlayer>,
    steering: Res<Steering>,
    awaited: Res<Awaited>,
    mut clock: ResMut<CityClock>,
    mut viewers: Query<&mut Eye, With<Viewer>>,
    mut itineraries: Query<&mut Itinerary, With<Viewer>>,
    mut has_told: Local<bool>,
    mut weather: ResMut<Weather>,
    mut ended: MessageWriter<TourEnded>,
    mut moments: Moments,
    mut following: Following,
) {
    tell_ahead(&player, &mut has_told, &mut itineraries);
    let guided = *steering == Steering::Guided;
    if matches!(player.state, TourState::Playing | TourState::Returning | TourState::Paused) && !guided {
        player.state = TourState::Wandering;
        player.leg = None;
        // A fade under way would leave the wanderer in the dark.
        for mut eye in &mut viewers {
            eye.fade = 0.0;
        }
    }
    let (was, seconds) = (player.hold, time.delta_secs_f64());
    let (hold, dark) = was.next(seconds, &awaited);
    if hold != was {
        player.hold = hold;
    }
    // What lies ahead stands before one goes there.
    let waits = awaited.ahead > 0 && matches!(player.state, TourState::Playing | TourState::Returning);
    if player.waits != waits {
        player.waits = waits;
    }
    let dt = if was.is_still() || waits { 0.0 } else { seconds * player.speed() };
    let pose = match player.state {
        TourState::Playing => {
            let Some((end, title)) = player.compiled.as_ref().map(|t| (t.duration_s(), t.title().to_owned())) else { return };
            let before_s = player.t_s;
            let marked_s = if core::mem::take(&mut player.has_sought) { before_s - 1e-6 } else { before_s };
            player.t_s = (before_s + dt).min(end);
            if let Some(tour) = &player.compiled {
                moments.tell(&player, tour, marked_s);
            }
            if player.t_s >= end {
                ended.write(TourEnded { title, finished: true });
                player.state = TourState::Paused;
            }
            player.compiled.as_ref().map(|tour| tour.pose(player.t_s))
        }
        TourState::Paused => player.compiled.as_ref().map(|tour| tour.pose(player.t_s)),
        TourState::Returning => {
            let Some((leg, t)) = &mut player.leg else { return };
            *t += dt;
            let (pose, there, resumes_at_s) = (leg.pose(*t), *t >= leg.duration_s(), leg.resumes_at_s());
            if there {
                player.leg = None;
                player.t_s = resumes_at_s;
                player.state = TourState::Playing;
            }
            Some(pose)
        }
        TourState::Idle | TourState::Waiting | TourState::Wandering => None,
    };
    let Some(pose) = pose else { return };
    let pose = following.lead(&player, pose, viewers.iter().next(), was.is_still(), seconds);
    if let Some(day) = player.compiled.as_ref().map(CompiledTour::day).filter(|day| *day != clock.day) {
        clock.day = day;
    }
    if clock.hour != pose.hour {
        clock.hour = pose.hour;
    }
    if let Some(wet) = player.compiled.as_ref().and_then(|tour| tour.wet(player.t_s)) {
        let wet = wet as f32;
        let usual = Weather::default().clouds;
        let next = Weather { wet, clouds: usual + (RAIN_CLOUDS - usual) * wet, ..*weather };
        weather.set_if_neq(next);
    }
    for mut eye in &mut viewers {
        let ground_m = eye.ground_m;
        eye.set_if_neq(Eye {
            plan_pos: DVec2::new(pose.plan_pos.x, pose.plan_pos.y),
            ground_m,
            eye_m: pose.eye_m,
            heading_deg: pose.heading_deg,
            pitch_deg: pose.pitch_deg,
            fov_deg: pose.fov_deg,
            // Who halts a tour halts it to look.
            fade: if player.state == TourState::Paused { dark } else { pose.fade.max(dark) },
        });
    }
}

#[cfg(test)]
mod tests;
