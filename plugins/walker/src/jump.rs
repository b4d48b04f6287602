use bevy::prelude::*;
use veduta_city::{GridPos, Viewpoint};
use veduta_ecs::{Awaited, City, CityOpened, Eye, JumpTo, Steering, Viewer};

use crate::{SolidCells, Walker};

/// A jump under way: fade out, stand there, wait until what is in sight stands, fade in.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub enum Jump {
    /// None.
    #[default]
    None,
    /// Darkening.
    Leaving(Viewpoint),
    /// Dark, until there is a floor and all that is in sight stands.
    Waiting {
        /// Seconds waited so far.
        for_s: f64,
    },
    /// Clearing.
    Arriving,
}

/// Seconds of a fade, one way.
const FADE_S: f64 = 0.25;

impl Jump {
    /// Whether the visitor's feet are off the ground meanwhile.
    #[must_use]
    pub const fn is_under_way(&self) -> bool {
        matches!(self, Self::Leaving(_) | Self::Waiting { .. })
    }
}

/// Starts jumps that are asked for; an opened city begins with a jump to its start.
pub(crate) fn begin(
    mut asked: MessageReader<JumpTo>,
    mut opened: MessageReader<CityOpened>,
    city: Option<Res<City>>,
    mut jump: ResMut<Jump>,
    mut steering: ResMut<Steering>,
    mut viewers: Query<&mut Eye, (With<Viewer>, With<Walker>)>,
) {
    if opened.read().last().is_some()
        && let Some(city) = city
    {
        for mut eye in &mut viewers {
            *eye = Eye { fade: 1.0, ..Eye::at(city.start) };
        }
        *jump = Jump::Waiting { for_s: 0.0 };
    }
    if let Some(&JumpTo(view)) = asked.read().last() {
        *jump = Jump::Leaving(view);
        steering.set_if_neq(Steering::Visitor);
    }
}

/// How long a floor is waited for when all in sight stands, seconds: a place without a cell, such as a viewpoint in the air, has none.
const FLOOR_S: f64 = 2.0;

/// Carries a jump on.
pub(crate) fn advance(
    time: Res<Time>,
    steering: Res<Steering>,
    solid: Res<SolidCells>,
    awaited: Res<Awaited>,
    mut jump: ResMut<Jump>,
    mut viewers: Query<&mut Eye, (With<Viewer>, With<Walker>)>,
) {
    if *jump != Jump::None && *steering == Steering::Led {
        // Who is led is on his way: he is not to be put elsewhere after all, nor to walk in the dark.
        *jump = Jump::None;
        viewers.iter_mut().for_each(|mut eye| eye.fade = 0.0);
    }
    if *jump == Jump::None || *steering != Steering::Visitor {
        return;
    }
    if viewers.is_empty() {
        return;
    }
    let step = time.delta_secs_f64() / FADE_S;
    // Whoever walks jumps, on however many screens.
    let mut fade_by = |way: f64| {
        viewers.iter_mut().for_each(|mut eye| eye.fade = (eye.fade + way).clamp(0.0, 1.0));
    };
    let next = match *jump {
        Jump::Leaving(view) => {
            fade_by(step);
            if viewers.iter().any(|eye| eye.fade < 1.0) {
                return;
            }
            for mut eye in &mut viewers {
                *eye = Eye { fade: 1.0, fov_deg: eye.fov_deg, ..Eye::at(view) };
            }
            Jump::Waiting { for_s: 0.0 }
        }
        Jump::Waiting { for_s } => {
            let is_held = |eye: &Eye| solid.hold(GridPos::from_metres(eye.plan_pos));
            let ready = awaited.cells == 0 && (viewers.iter().all(is_held) || for_s > FLOOR_S);
            if ready { Jump::Arriving } else { Jump::Waiting { for_s: for_s + time.delta_secs_f64() } }
        }
        Jump::Arriving => {
            fade_by(-step);
            if viewers.iter().any(|eye| eye.fade > 0.0) { Jump::Arriving } else { Jump::None }
        }
        Jump::None => Jump::None,
    };
    jump.set_if_neq(next);
}
