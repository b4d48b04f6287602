//! Ways along streets, and the poses of a tour over time.
//!
//! ```text
//!  street centre lines ──► StreetNet ──way──┐
//!  places ───────────────► Gazetteer ──find─┤
//!  Tour (RON) ──────────────────────────────┴─ compile ──► CompiledTour ── pose(t) ──► Pose
//!      step by step: names to positions, positions to smooth paths,          │
//!      paths to paces, directions wanted to directions followed              └─ resume ──► ResumeLeg ── pose(dt)
//! ```
//!
//! Values only: no engine, no clock, no files. The same tour gives the same poses at any frame rate, and any moment of it can
//! be asked for at once.
//!
//! # Use
//! 1. Make a [`StreetNet`] from the plan's streets and a [`Gazetteer`] from its places.
//! 2. [`compile`] the tour, or [`compile_with`] a test for free space, so that walks cross squares and end before walls.
//! 3. Ask for [`CompiledTour::pose`] and [`CompiledTour::caption`] each frame.
//!
//! ```
//! use veduta_city::{GridPos, Id, PlanStreet, Tour, file};
//! use veduta_route::{Gazetteer, StreetNet, compile};
//!
//! let line = [(0.0, 0.0), (80.0, 0.0), (80.0, 60.0)].map(|p| GridPos::from_metres(p.into())).to_vec();
//! let street = PlanStreet { id: Id(1), name: "Celetná".into(), line, width: 6 * 1024, walkable: true, ..PlanStreet::default() };
//! let text = r#"(title: "A walk", city: "old.city", steps: [
//!     Start(at: At(0, 0)),
//!     Say(text: "Round the corner"),
//!     Walk(to: At(80, 60)),
//! ])"#;
//! let tour: Tour = file::parse(text, "a.tour.ron")?;
//! let compiled = compile(&tour, &StreetNet::new(&[street]), &Gazetteer::default())?;
//! assert_eq!(compiled.caption(2.0), Some("Round the corner"));
//! let end = compiled.pose(compiled.duration_s());
//! assert!(end.plan_pos.distance((80.0, 60.0).into()) < 1e-6 && end.heading_deg.abs() < 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What the steps mean
//! | step | time it takes | remarks |
//! |---|---|---|
//! | `Start` | 0.8 s, out of the dark | the first step but for captions and the like; later on it is a `Cut` of 1.6 s |
//! | `Walk` | as its speed demands | along streets; one that follows another goes on without a stop, at its own speed; the eye stays as high as it was |
//! | `Fly` | likewise | a centripetal Catmull-Rom curve from the present position; one that follows another goes on in the same curve |
//! | `Track` | as its last key says | smooth through its keys, in place and in direction, and at rest at both ends; one that follows another goes on. Between it and a walk, flight or turn the view comes to rest, in half a second |
//! | `Look` | its seconds, or as many as 60° a second demand | `Ahead`: where the next movement sets off |
//! | `Wait` | its seconds | |
//! | `Cut` | its seconds, at least 0.4 | dark for a tenth of a second about the jump |
//! | `Say`, `Fov`, `Time`, `Rain` | none | they go on beside what follows; the tour ends when they have. The clock goes forward, or back by less than half a day |
//! | `Chapter`, `Mark` | none | a chapter is what a visitor can go to; a mark tells the game that its moment has come |
//!
//! `Ease` speaks of a movement's two ends, where gently is 1.2 m/s² for walkers and otherwise 3 (flights: with their speed);
//! no movement begins or ends with a jolt. A place is reached at the stand chosen for it ([`veduta_city::Place::view`]), else at its
//! position. A visitor who is to look ahead first turns towards the way, and turns round where the way turns back.
//!
//! # Edit
//! A [`TourEdit`] keeps a tour's text with what is selected in it and what can be undone; [`sketch`] compiles what can be played of it and
//! says what is wrong with the rest; [`mistakes`] tells everything that is wrong with one; [`steps_to_view`] leads to a view, and a [`Recording`] becomes steps that follow it.
//!
//! # Limits
//! - A tour lasts six hours at most, a leg is 100 km long at most, and heights are above the ground: slopes are for the one
//!   who knows the ground.
//! - Where a path bends too sharply for its speed (3 m/s² across for walkers, 6 for flights) it is gone along more slowly.
//! - Ways are the shortest; hills and crossings cost nothing. Stairs are left out on request, all of them
//!   ([`StreetNet::without_steps`]).
//!
//! # Follow
//! A tour may name something that moves ([`veduta_city::LookAt::Spot`]). Nobody knows beforehand where it will be, so the tour's own view turns to
//! the spot that is told, and [`Follow`] leads it from there to the thing while it is about, in place, never the eye.
//!
//! # Rejected
//! Springs and filters that run with the clock (other poses at other frame rates, and no seeking), but for what is followed; one table of whole poses
//! (speeds true only between its entries); clothoids at corners (arcs with smoothed pace and gaze look the same at a walk);
//! a navigation mesh (tours are told in streets, and the cells may not be loaded when a tour is compiled).

mod bounds;
mod compile;
mod edit;
mod error;
mod flight;
mod follow;
mod gazetteer;
pub mod kml;
mod letters;
mod mistakes;
mod net;
mod pace;
mod path;
mod plot;
mod pose;
mod reach;
mod record;
mod resume;
#[cfg(test)]
mod samples;
mod script;
mod search;
mod sketch;
mod timeline;
#[cfg(test)]
mod tours;
mod track;
mod walk;
mod way;

pub use bounds::{Bounds, numbers, settings, spots};
pub use compile::{CompiledTour, StepSpan, compile, compile_with, reading_s};
pub use edit::{Approach, TourEdit, joined, new_step, steps_to_view, stretched};
pub use error::{LONGEST_LEG_M, LONGEST_TOUR_S, MOST_KEYS, MOST_STEPS, Range, StepKind, StepProblem, TourError, WALK_EYE_M};
pub use follow::{Follow, Followed};
pub use gazetteer::Gazetteer;
pub use letters::{fold, plain_name};
pub use mistakes::{TourMistake, mistakes};
pub use net::{Foot, JOIN_M, StreetNet};
pub use path::CORNER_M;
pub use pose::{Pose, turn_deg};
pub use reach::{Unreached, unreached};
pub use record::{LONGEST_RECORDING_S, RECORDED_FLIGHT_M, RECORDED_GAZE_DEG, RECORDED_WALK_M, Recording};
pub use resume::{ResumeLeg, WALK_BACK_M, resume, resume_with};
pub use script::{Chapter, Mark, Narration, Spoken, TourPicture};
pub use search::{Finder, Hit, Named};
pub use sketch::{Sketch, is_aside, sketch};
pub use timeline::TURN_DEG_S;
pub use walk::Walk;
pub use way::{CROSSING_M, DETOUR, FreeLine, OFF_STREET_M, RouteError, STRAIGHT_M};
