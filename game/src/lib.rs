//! The example game: walk, film and look at a city.
//!
//! ```text
//!  CITY | URL | MAP ──cities──► baked directory ──► window (walk) or studio without a display (film, shot)
//! ```
//!
//! Everything it does, it does through the plugins; it adds a command line, a window, a line of help and the studio that
//! renders frame by frame without a display.
//!
//! # Limits
//! The studio needs a Vulkan, Metal or Direct3D adapter; a software one (Mesa lavapipe) will do.
//!
//! # Rejected
//! Filming through a hidden window: machines without a display have none to hide.

pub mod bench;
pub mod camera;
pub mod cities;
pub mod cli;
pub mod encode;
mod expert;
pub mod film;
pub mod gallery;
mod hud;
pub mod journal;
pub mod profile;
mod settings;
pub mod shot;
mod soundtrack;
pub mod studio;
pub mod tours;
pub mod walk;

/// What every command may fail with: a message that names the file and the fix.
pub type Failure = Box<dyn std::error::Error>;
