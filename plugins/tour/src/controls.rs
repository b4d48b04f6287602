//! What can be done with a tour: its controls.

use bevy::input::gamepad::GamepadButton as Pad;
use bevy::prelude::*;
use veduta_controls::{Always, ControlsAppExt, Input, Presses, Scope, control};
use veduta_ecs::Words;

use crate::{TourCommand, TourPlayer, TourState};

/// While a tour is open.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct OnTour;

impl Scope for OnTour {
    const NAME: &'static str = "tour";
}

control! {
    /// Begins the tour, pauses it, resumes it after wandering off.
    pub TourPause: Always = "tour.pause", [Input::key(KeyCode::KeyT), Input::Pad(Pad::West)];
    /// Ten seconds back.
    pub TourBack: OnTour = "tour.back", [Input::key(KeyCode::Comma), Input::Pad(Pad::LeftTrigger)];
    /// Ten seconds ahead.
    pub TourAhead: OnTour = "tour.ahead", [Input::key(KeyCode::Period), Input::Pad(Pad::RightTrigger)];
    /// To the next chapter.
    pub TourNext: OnTour = "tour.next", [Input::key(KeyCode::End), Input::Pad(Pad::South)];
    /// Slower.
    pub TourSlower: OnTour = "tour.slower", [Input::key(KeyCode::BracketLeft)];
    /// Faster.
    pub TourFaster: OnTour = "tour.faster", [Input::key(KeyCode::BracketRight)];
    /// Begins to record the visitor's walk, and ends it.
    pub TourRecord: Always = "tour.record", [Input::key(KeyCode::KeyR)];
    /// Opens and closes the editor.
    pub TourEdit: Always = "tour.edit", [Input::key(KeyCode::KeyE)];
    /// In the editor, adds the present view.
    pub TourView: Always = "tour.view", [Input::key(KeyCode::KeyV)];
}

/// Adds the tour's controls to the list, without anything that they do.
pub fn add_controls(app: &mut App) {
    Words::bring(app, &crate::WORDS);
    app.add_scope::<OnTour, _>(|player: Option<Res<TourPlayer>>| player.is_some_and(|player| player.state() != TourState::Idle))
        .add_control::<TourPause>()
        .add_control::<TourBack>()
        .add_control::<TourAhead>()
        .add_control::<TourNext>()
        .add_control::<TourSlower>()
        .add_control::<TourFaster>()
        .add_control::<TourRecord>()
        .add_control::<TourEdit>()
        .add_control::<TourView>();
}

/// Seconds that one press goes back or ahead.
const SKIP_S: f64 = 10.0;

pub(crate) fn read_keys(presses: Presses<'_, '_>, player: Res<TourPlayer>, mut commands: MessageWriter<TourCommand>) {
    if presses.begins::<TourPause>() {
        commands.write(TourCommand::Toggle);
    }
    let pressed = |is_plus: bool, is_minus: bool| f64::from(is_plus) - f64::from(is_minus);
    let skip = pressed(presses.begins::<TourAhead>(), presses.begins::<TourBack>());
    if skip != 0.0 {
        commands.write(TourCommand::Seek(player.time_s() + SKIP_S * skip));
    }
    if presses.begins::<TourNext>()
        && let Some(tour) = player.tour()
        && let Some(next) = tour.chapters().iter().find(|chapter| chapter.start_s > player.time_s() + 0.1)
    {
        commands.write(TourCommand::Seek(next.start_s));
    }
    let faster = pressed(presses.begins::<TourFaster>(), presses.begins::<TourSlower>());
    if faster != 0.0 {
        commands.write(TourCommand::Speed(player.speed() * 2_f64.powf(faster * 0.5)));
    }
}
