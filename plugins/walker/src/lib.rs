//! The camera controller that all else drives: walk, fly, look; with walls that stop you and portals that wait.
//!
//! ```text
//!  controls ──► Intent ──┬─► walk (rapier's character controller) ◄─ glide to a street ─┐
//!                        ├─► fly (no walls, never below ground) ────────────────────────┤──► Eye
//!                        └─► go round a point (never in a house) ───────────────────────┘
//!  JumpTo ──► fade, wait for the place, stand ─────────────────────────────────────────────► Eye
//! ```
//!
//! Walking uses bevy_rapier3d's kinematic character controller: it slides along walls and climbs kerbs and steps up to
//! [`WalkerSettings::step_m`]. A cell is shut as long as it, or anything that is seen from it, does not stand: you wait at its
//! portal as at a door, and never fall through a floor that has not arrived. Blind portals, the edge of the modelled city, stop you in the same way.
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_ecs::Viewer;
//! use veduta_walker::{Walker, WalkerPlugin};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, WalkerPlugin::default()))
//!     .add_systems(Startup, |mut commands: Commands| { commands.spawn((Camera3d::default(), Viewer, Walker)); })
//!     .run();
//! ```
//!
//! Its controls, whose keys a visitor may change ([`veduta_controls`]), stand in [`controls`]; these are they at first:
//!
//! | control | keyboard and mouse | gamepad | touch |
//! |---|---|---|---|
//! | walk | W A S D, arrows up, down | left stick | a finger on the left half |
//! | look | mouse with the right button held; arrows left, right | right stick | a finger on the right half |
//! | run | Shift | left stick pressed | |
//! | fly, land | F | Y / triangle | |
//! | up, down (flying) | Space, C | triggers | |
//! | field of view 40°, 55°, 75° | 1, 2, 3 | d-pad up: the next | two fingers on the right half |
//! | eye height 1.6 to 3 m | PageUp, PageDown | d-pad left, right | |
//! | examine, walk on | O | right stick pressed | |
//! | turn, near (examining) | drag with either button, wheel; arrows, W S | sticks | fingers |
//!
//! # Limits
//! One walker; others may view. Round a point the eye keeps out of houses as the overview has them, upright blocks: an oriel or a tower's
//! helm it may touch. A gaze into the sky is led down to what lies below.
//!
//! # Rejected
//! An orbit at a fixed distance that slides along walls (it looks through houses that stand between); its eye stays in the line of sight.
//! A capsule of our own against plan polygons: rapier's controller handles steps, slopes and corners, and games bring rapier
//! bodies of their own into the street.

mod body;
mod collide;
pub mod controls;
mod glide;
mod input;
mod jump;
mod orbit;

use bevy::prelude::*;
use bevy_rapier3d::prelude::{NoUserData, RapierPhysicsPlugin};
use veduta_ecs::VedutaSystems;

pub use body::{Gait, Walker, WalkerBody};
pub use collide::SolidCells;
pub use controls::add_controls;
pub use input::{Intent, MouseHeld};
pub use jump::Jump;

/// Lets a visitor walk and fly.
#[derive(Debug, Clone, Copy)]
pub struct WalkerPlugin {
    /// Whether keys, mouse and gamepad are read. Without, [`Intent`] is yours to write.
    pub input: bool,
}

impl Default for WalkerPlugin {
    fn default() -> Self {
        Self { input: true }
    }
}

/// Speeds and sizes. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct WalkerSettings {
    /// Walking, metres a second.
    pub walk_m_s: f64,
    /// Running, metres a second.
    pub run_m_s: f64,
    /// Flying, metres a second; running multiplies it by four.
    pub fly_m_s: f64,
    /// Highest step climbed without jumping, metres.
    pub step_m: f32,
    /// Half the width of a person, metres.
    pub radius_m: f32,
    /// Degrees a pixel of mouse movement turns.
    pub mouse_deg: f64,
    /// Degrees a second a gamepad stick turns at full tilt.
    pub stick_deg_s: f64,
    /// Fields of view to choose from, vertical degrees.
    pub fovs_deg: [f64; 3],
    /// Lowest and highest eye of a walker, metres.
    pub eye_m: (f64, f64),
}

impl Default for WalkerSettings {
    fn default() -> Self {
        Self {
            walk_m_s: 1.9,
            run_m_s: 6.0,
            fly_m_s: 12.0,
            step_m: 0.35,
            radius_m: 0.28,
            mouse_deg: 0.12,
            stick_deg_s: 120.0,
            fovs_deg: [40.0, 55.0, 75.0],
            eye_m: (1.6, 3.0),
        }
    }
}

/// The order of a walker's frame, within [`VedutaSystems::Steer`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WalkerSystems {
    /// Keys, mouse and gamepad become an intent.
    Input,
    /// The intent moves the body; the body moves the eye.
    Move,
}

impl Plugin for WalkerPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        if !app.is_plugin_added::<RapierPhysicsPlugin<NoUserData>>() {
            app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default());
        }
        app.init_resource::<WalkerSettings>()
            .init_resource::<Intent>()
            .init_resource::<SolidCells>()
            .init_resource::<Jump>()
            .register_type::<WalkerSettings>()
            .configure_sets(Update, (WalkerSystems::Input, WalkerSystems::Move).chain().in_set(VedutaSystems::Steer))
            .add_systems(
                Update,
                (jump::begin, jump::advance, body::give_bodies, body::take_over, body::settle, body::stride)
                    .chain()
                    .in_set(WalkerSystems::Move),
            )
            .add_systems(Update, (collide::start, collide::finish, collide::forget).chain().in_set(VedutaSystems::Build));
        if self.input {
            input::build(app);
        }
    }
}
