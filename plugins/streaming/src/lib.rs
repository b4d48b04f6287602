//! Streams a city cell by cell around its viewers.
//!
//! ```text
//!  OpenCity ──► fetch threads ◄──► Client (store)       CityOpened, City
//!  Eye ──► follow (CellEntered) ──► plan what is wanted ──► ask ──► deliver (CellReady) ──► release (CellReleased)
//! ```
//!
//! The current cell is followed by portal crossing. What the index tells of cells comes region by region, those about the viewer and of
//! what is in sight first; parts of the overview, for maps, tours and the city from afar, when all in sight stands: those about the viewers,
//! what plugins ask for ([`OverviewWants`](veduta_ecs::OverviewWants)), and of what is seen from where viewers are the nearest and the tallest. Wanted are the cells of its visible set at level 1, nearest
//! first, then level 2 within [`StreamingSettings::level_2_m`] and finer ones within [`StreamingSettings::level_3_m`], then level 1 of all
//! that is seen from the cells next to it and from those ahead, the soonest first: where an [`Itinerary`](veduta_ecs::Itinerary) leads, else
//! where the viewer's [`Motion`] does. A cell opens ([`OpenCells`](veduta_ecs::OpenCells)) when nothing would be missing from there. A viewer
//! above the roofs wants everything within [`StreamingSettings::level_2_m`], and the overview beyond. Levels of a cell arrive strictly in
//! order. Of finer levels no more is asked for than the line brings in a while: its [`Pace`] is measured. Nothing is read or decoded on the
//! main thread.
//!
//! What a web server sent is kept in a [`StreamingCache`]. [`Wanted::why`] tells why a cell is wanted, and the [`Journal`] all that
//! happened; it can be replayed to what is loaded, and tells what a walk [downloaded](Downloads). [`StreamingDiagnosticsPlugin`] tells
//! figures among Bevy's diagnostics. [`Reconnect`] asks at once for all that
//! waits to be tried again.
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_ecs::{OpenCity, Viewer};
//! use veduta_streaming::StreamingPlugin;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, StreamingPlugin::default()))
//!     .insert_resource(OpenCity("http://localhost:8000/prague.city".into()))
//!     .add_systems(Startup, |mut commands: Commands| { commands.spawn((Camera3d::default(), Viewer)); })
//!     .run();
//! ```
//!
//! # Rejected
//! Bevy's asset server for packets: no checksums, no retry, no order, and whole files are all it reads.

mod deliver;
mod diagnostics;
mod downloads;
mod fetch;
mod files;
mod follow;
mod journal;
mod link;
mod look;
mod memory;
mod motion;
mod need;
mod overviews;
mod pace;
mod rank;
mod want;

use bevy::prelude::*;
use veduta_city::Overview;
use veduta_ecs::{DistrictMemory, VedutaSystems};

pub use deliver::{RetryTime, StreamingStats};
pub use diagnostics::StreamingDiagnosticsPlugin;
pub use downloads::{BytesByKind, Downloads, Stay};
pub use fetch::{CityReader, Fetching, Reconnect, StreamingCache};
pub use files::CityAssetsPlugin;
pub use follow::CurrentCell;
pub use journal::{Entry, Event, Journal, JournalError, Reason, read_journal, replay, write_journal};
pub use link::Link;
pub use look::Streamed;
pub use motion::Motion;
pub use pace::Pace;
pub use veduta_store::What;
pub use want::{Wanted, Why};

/// Streams the city that [`OpenCity`](veduta_ecs::OpenCity) names.
#[derive(Debug, Clone, Default)]
pub struct StreamingPlugin {
    /// Where reading and decoding happen.
    pub fetching: Fetching,
}

/// The order of streaming in a frame, within [`VedutaSystems::Stream`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StreamingSystems {
    /// Opens and closes cities.
    Open,
    /// Finds the cell of every viewer.
    Follow,
    /// Plans what is wanted.
    Want,
    /// Takes what has arrived and asks for more.
    Deliver,
    /// Lets go of what is no longer wanted.
    Release,
}

/// Distances, caps and budgets. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct StreamingSettings {
    /// Level 2 is wanted within this distance of a viewer, metres; of one above the roofs or outside of every cell level 1 as well, since
    /// beyond it the overview's districts are to be seen.
    pub level_2_m: f64,
    /// Level 3, the pictures of painted façades, is wanted within this distance of a viewer, metres.
    pub level_3_m: f64,
    /// Height above the ground from which a viewer counts as flying, metres.
    pub flying_from_m: f64,
    /// Skyline cells are wanted within this distance, metres.
    pub skyline_m: f64,
    /// No more skyline cells than these are wanted: those that look tallest, in the regions that do.
    pub skyline_cells: u32,
    /// The overview is wanted within this distance of a viewer, metres. With less than [`Overview::ABOUT_M`] there are holes in hills: what is
    /// seen over the roofs there is told from that distance on.
    pub overview_m: f64,
    /// So many more overviews, at most, are wanted of what is seen from afar, nearest first.
    pub vistas: usize,
    /// Of hills and whatever else looks tall from afar ([`StreamingSettings::TALL`]) so many are wanted at most, those that look tallest; the
    /// nearest ones count among them.
    pub tall_vistas: usize,
    /// The overview is wanted within this distance of a viewer above the roofs, metres. Districts are made of it as far as
    /// `BuildSettings::districts_m` goes.
    pub overview_flying_m: f64,
    /// Seconds that a cell, or a finer level of one that stays, is kept after it was last wanted.
    pub keep_s: f64,
    /// Most bytes of memory that the city takes: packets, and the meshes and pictures made of them, in cells and from afar. What is farthest is
    /// left out, and over it what is no longer wanted goes, the farthest first; of what is seen from afar no more comes than takes half of it.
    pub memory_cap_bytes: u64,
    /// Most answers taken a frame.
    pub packets_a_frame: usize,
    /// No more answers are taken in a frame that has brought so many bytes, as sent.
    pub bytes_a_frame: u64,
    /// Nothing is asked for as long as this is set; what is on its way still arrives. Whoever waits in the dark, at a portal or on a tour waits on.
    pub paused: bool,
    /// Highest level asked for.
    pub finest: u8,
    /// Of levels beyond the first no more is asked for than comes within so many seconds at the [`Pace`] of the line, nearest first;
    /// infinite for all, whatever the line.
    pub finer_within_s: f64,
}

impl StreamingSettings {
    /// Levels are wanted so much farther off than they begin to show, metres: two seconds of a quick flight.
    pub const LEAD_M: f64 = 40.0;
    /// What rises by more than this with every metre to it looks tall from afar.
    pub const TALL: f64 = 1.0 / 16.0;

    /// How many parts of the overview may show cells from afar: no more than take half of the cap, as large as they are by now.
    fn most_parts(&self, afar: DistrictMemory) -> usize {
        let bytes_a_part = afar.bytes.checked_div(afar.parts as u64).unwrap_or_default();
        (self.memory_cap_bytes / 2).checked_div(bytes_a_part).map_or(usize::MAX, |parts| parts as usize)
    }

    /// What the cap leaves to cells: the city from afar comes first, since it is all that stands where they do not, an eighth is always kept for
    /// it, and a sixteenth for what takes more than was to be expected.
    fn cap_of_cells(&self, afar: DistrictMemory) -> u64 {
        let cap = self.memory_cap_bytes;
        (cap - cap / 16).saturating_sub(afar.bytes.max(cap / 8))
    }
}

impl Default for StreamingSettings {
    fn default() -> Self {
        Self {
            level_2_m: 150.0 + Self::LEAD_M,
            level_3_m: 55.0 + Self::LEAD_M,
            flying_from_m: 6.0,
            skyline_m: 2_000.0,
            skyline_cells: 48,
            overview_m: Overview::ABOUT_M,
            vistas: 8,
            tall_vistas: 32,
            overview_flying_m: 700.0,
            keep_s: 10.0,
            memory_cap_bytes: 512 << 20,
            packets_a_frame: 16,
            bytes_a_frame: 64 << 10,
            paused: false,
            finest: 4,
            finer_within_s: 20.0,
        }
    }
}

impl Plugin for StreamingPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        use StreamingSystems::{Deliver, Follow, Open, Release, Want};
        app.insert_resource(self.fetching)
            .init_resource::<StreamingSettings>()
            .init_resource::<Wanted>()
            .init_resource::<StreamingStats>()
            .init_resource::<RetryTime>()
            .init_resource::<StreamingCache>()
            .init_resource::<Journal>()
            .init_resource::<Link>()
            .init_resource::<Pace>()
            .init_resource::<memory::Sizes>()
            .register_type::<Link>()
            .register_type::<Pace>()
            .add_message::<Reconnect>()
            .register_type::<StreamingSettings>()
            .configure_sets(Update, (Open, Follow, Want, Deliver, Release).chain().in_set(VedutaSystems::Stream))
            .add_systems(Update, (fetch::open_city, fetch::reconnect).chain().in_set(Open))
            .add_systems(Update, (follow::follow_viewers, motion::measure).chain().in_set(Follow))
            .add_systems(
                Update,
                (memory::measure, want::plan_wanted, (want::count_awaited, want::open_cells, overviews::plan_overviews))
                    .chain()
                    .in_set(Want),
            )
            .add_systems(Update, (files::take_asks, deliver::deliver).chain().in_set(Deliver))
            .add_systems(Update, deliver::release_cells.in_set(Release));
    }
}
