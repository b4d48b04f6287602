//! Places and their information, search, and being led there.
//!
//! ```text
//!  City.overviews, Eye ──► near (a Gaussian in position and view) ──► PlaceEntered / PlaceLeft ──► panel
//!  *.guide.ron ──asset──► CityGuide: names and texts in the visitor's language ──────────────────────┘
//!  places, streets, Offers ──► Directory ──► search box ──► JumpTo, ShowOnMap, OfferTaken
//!                                                      └──► WalkTo ──► lead ──► Eye, Route
//! ```
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_guide::{GuidePlugin, OpenGuide, PlaceEntered};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, GuidePlugin::default()))
//!     .add_systems(Startup, |mut guide: MessageWriter<OpenGuide>| {
//!         guide.write(OpenGuide("old_prague.guide.ron".into()));
//!     })
//!     .add_systems(Update, |mut entered: MessageReader<PlaceEntered>| {
//!         for place in entered.read() { info!("{}", place.name); }
//!     })
//!     .run();
//! ```
//! It reads the [`City`](veduta_ecs::City) resource; in a game without streaming, insert one of your own with an overview that has places
//! and streets. A game's own commands come into the search box by [`Offers`].
//!
//! The key of the search box may be changed ([`controls`]); the box's own may not.
//!
//! | key | |
//! |---|---|
//! | `/` | search: places, streets, tours, commands |
//! | ↑ ↓ | choose |
//! | Enter | walk there, or do it |
//! | Shift+Enter | be there at once |
//! | Ctrl+Enter | show it on the map |
//! | click, tap | tells of what has a name, and leads to where the ground was clicked |
//!
//! # Limits
//! One place at a time is told of. In a large city what lies farther than 1.5 km is found only once its part of the overview is here.
//!
//! # Rejected
//! Trigger volumes as entities: ten thousand places would cost every frame; here only the nearest are looked at.

mod asset;
pub mod controls;
mod directory;
mod gallery;
mod lead;
mod names;
mod near;
mod obstacles;
mod panel;
mod pick;
mod search;
mod trail;

use bevy::input::mouse::MouseButtonInput;
use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use veduta_ecs::{VedutaSystems, Words};
use veduta_ui::UiSystems;

pub use asset::{CityGuide, GuideAsset, GuideLoadError, OpenGuide};
pub use controls::add_controls;
pub use directory::{Directory, Found, Offer, OfferTaken, Offers};
pub use lead::{Lead, LeadSettings, WalkEnded};
pub use near::{NearPlace, Pin, PlaceEntered, PlaceLeft, relevance};
pub use panel::PanelSettings;
pub use pick::{PickSettings, Pointed};
pub use search::{SearchAction, SearchBox};

/// Tells what stands near the visitor, finds things and leads there.
#[derive(Debug, Clone, Copy)]
pub struct GuidePlugin {
    /// Whether panels are drawn and keys read.
    pub interface: bool,
}

impl Default for GuidePlugin {
    fn default() -> Self {
        Self { interface: true }
    }
}

/// What the interface says, by language.
const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

impl Plugin for GuidePlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        Words::bring(app, &WORDS);
        app.init_asset::<GuideAsset>()
            .register_asset_loader(asset::GuideLoader)
            .init_resource::<CityGuide>()
            .init_resource::<NearPlace>()
            .init_resource::<Pin>()
            .init_resource::<PanelSettings>()
            .init_resource::<Directory>()
            .init_resource::<Offers>()
            .init_resource::<Lead>()
            .init_resource::<LeadSettings>()
            .add_message::<OpenGuide>()
            .add_message::<PlaceEntered>()
            .add_message::<PlaceLeft>()
            .add_message::<OfferTaken>()
            .add_message::<WalkEnded>()
            .add_systems(Update, (asset::open, asset::take).chain())
            .add_systems(Update, (lead::set_out, lead::find_way, lead::go).chain().in_set(VedutaSystems::Steer))
            .add_systems(Update, (near::find_near, trail::lay, names::tell).in_set(VedutaSystems::Show));
        if self.interface {
            veduta_ui::ensure(app);
            controls::add_controls(app);
            app.init_resource::<SearchBox>()
                .init_resource::<panel::PanelState>()
                .init_resource::<PickSettings>()
                .init_resource::<Pointed>()
                .add_systems(Update, (pick::point, pick::click).chain().run_if(resource_exists::<Messages<MouseButtonInput>>))
                .add_systems(Update, directory::keep)
                .add_systems(Update, controls::read_keys)
                .add_systems(
                    EguiPrimaryContextPass,
                    (panel::draw, lead::draw, pick::draw, search::draw).chain().in_set(UiSystems::Draw),
                );
        }
    }
}
