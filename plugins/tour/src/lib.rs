//! Guided tours: RON files that move the eye through the city, with captions, pause, wander-off and resume.
//!
//! ```text
//!  *.tour.ron ──asset──► Tour ──compile (route)──► poses over time ──► Eye, CityClock, caption
//! ```
//!
//! # Write a tour
//! ```
//! let text = r#"(
//!     title: "To the square",
//!     city: "old_prague.graph.ron",
//!     steps: [
//!         Start(at: Place("Powder Tower")),
//!         Say(text: "Kings began their way here."),
//!         Walk(to: Place("Old Town Square")),
//!         Chapter(title: "The square", translations: {"cs": "Náměstí"}),
//!         Mark(name: "bells"),
//!         Look(at: Spot(at: Place("Old Town Hall"), height_m: 40), seconds: 3),
//!         Wait(seconds: 2),
//!     ],
//! )"#;
//! let tour: veduta_city::Tour = veduta_city::file::parse(text, "square.tour.ron")?;
//! assert_eq!(tour.steps.len(), 7);
//! # Ok::<(), veduta_city::file::SyntaxError>(())
//! ```
//! A mistake shows file, line, column and the offending line; the last good version of a reloaded tour stays. A tour is
//! played with [`TourCommand`]s, and [`TourPlayer`] says how it stands:
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_tour::{TourCommand, TourPlugin};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, TourPlugin::default()))
//!     .add_systems(Startup, |mut tour: MessageWriter<TourCommand>| {
//!         tour.write(TourCommand::Open("royal_route.tour.ron".into()));
//!     })
//!     .run();
//! ```
//!
//! Recordings and pictures lie beside the tour's file: Ogg Vorbis, and PNG, JPEG or WebP. Narration is heard out while the tour goes
//! on, at its own pace however fast the tour plays; it stands still with the tour, and ends when the tour is sent to another time. Whoever
//! makes sounds (`veduta-sound`) plays them as [`Accompany`](veduta_ecs::Accompany) says; what is missing is told once, and the tour goes on.
//! ```
//! let text = r#"(
//!     title: "At the bridge",
//!     city: "old_prague.graph.ron",
//!     steps: [
//!         Start(at: Place("Old Town Bridge Tower")),
//!         Sound(file: "river.ogg"),
//!         Narrate(
//!             file: "bridge.ogg", files: {"cs": "bridge.cs.ogg"},
//!             text: "The bridge is of 1357.", translations: {"cs": "Most je z roku 1357."},
//!         ),
//!         Picture(file: "bridge-1850.webp", caption: "The bridge about 1850", seconds: 6),
//!         Wait(seconds: 8),
//!         Sound(),
//!     ],
//! )"#;
//! let tour: veduta_city::Tour = veduta_city::file::parse(text, "bridge.tour.ron")?;
//! assert_eq!(tour.steps.len(), 6);
//! # Ok::<(), veduta_city::file::SyntaxError>(())
//! ```
//! A [`TourMark`] tells a game that a moment has come which the tour marks: to ring bells, to open a door. The other way round, a game puts a
//! [`Subject`](veduta_ecs::Subject) on what moves, and a tour follows it with the eye from wherever it leads the visitor: where a step looks
//! at a spot, `follow: "Hay cart"` names it.
//!
//! Its [`controls`], whose keys a visitor may change ([`veduta_controls`]); at first they are:
//!
//! | control | keyboard | gamepad |
//! |---|---|---|
//! | play, pause, resume after wandering off | T | X / square |
//! | ten seconds back, ahead | , and . | shoulder buttons |
//! | the next chapter | End | A / cross |
//! | slower, faster | `[` and `]` | |
//! | record the visitor's walk, and end it | R | |
//! | open and close the editor | E | |
//! | in the editor: add this view | V | |
//!
//! # Edit a tour
//! [`TourEditor`] edits the tour that is open, or a new one: a walk that was recorded, views that were taken, steps on a line of time.
//! What it makes of it is played at once, comments in the file stay, and every edit can be undone. The plugin opens no files:
//! [`SaveTour`] asks whoever owns them to (in a browser, whoever offers a download), and [`TourSaved`] answers.
//!
//! # Limits
//! Walked steps need streets, and names places: a tour waits for the parts of the overview about the city's start, and for twice as much
//! around it as long as it does not lie within. Of places of one name in a large city, those about the start are meant. In a large
//! city a tour far from its start has much of the overview read, and compiling it then takes part of a frame's time.
//!
//! # Rejected
//! Animation clips in the engine's format: nobody writes them by hand.

mod accompany;
mod asset;
mod caption;
pub mod controls;
mod editor;
mod follow;
mod picture;
mod play;
mod ready;
mod streets;
mod strip;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use veduta_ecs::VedutaSystems;
use veduta_ui::UiSystems;

pub use asset::{TourAsset, TourLoadError};
pub use caption::CaptionSettings;
pub use controls::add_controls;
pub use editor::{EditorCommand, EditorLeft, EditorSettings, Recorder, SaveHow, SaveTour, TourEditor, TourSaved};
pub use play::{TourCommand, TourEnded, TourMark, TourPlayer, TourState};
pub use strip::StripSettings;

/// Plays guided tours.
#[derive(Debug, Clone, Copy)]
pub struct TourPlugin {
    /// Whether captions are drawn and keys read.
    pub interface: bool,
}

impl Default for TourPlugin {
    fn default() -> Self {
        Self { interface: true }
    }
}

/// What the interface says, by language.
const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

impl Plugin for TourPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.init_asset::<TourAsset>()
            .register_asset_loader(asset::TourLoader)
            .init_resource::<TourPlayer>()
            .init_resource::<CaptionSettings>()
            .add_message::<TourCommand>()
            .add_message::<TourEnded>()
            .add_message::<TourMark>()
            .add_systems(
                Update,
                (play::obey, ready::tell_failures, ready::compile_tour, accompany::accompany, play::play, play::tell_path)
                    .chain()
                    .in_set(VedutaSystems::Steer),
            );
        if self.interface {
            veduta_ui::ensure(app);
            controls::add_controls(app);
            editor::build(app);
            editor::build_windows(app);
            app.init_resource::<StripSettings>()
                .init_resource::<picture::Shown>()
                .add_systems(Update, controls::read_keys)
                .add_systems(
                    EguiPrimaryContextPass,
                    (caption::draw_caption, picture::draw_picture, strip::draw).chain().in_set(UiSystems::Draw),
                );
        }
    }
}
