//! What the visitor has chosen: read when the program begins, kept when it changes.

use std::path::PathBuf;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use veduta::buildings::BuildSettings;
use veduta::city::file;
use veduta::controls::{ControlList, Controls, ControlsSystems, WrittenControls};
use veduta::ecs::{Interface, Words};
use veduta::facade::{AutoLevels, LevelReach};
use veduta::guide::{LeadSettings, PanelSettings};
use veduta::life::{LifeKinds, LifeSettings};
use veduta::prelude::*;
use veduta::sound::SoundSettings;
use veduta::streaming::Link;
use veduta::tour::CaptionSettings;

use crate::profile::{Fitting, Profile, follow};

/// What the visitor has chosen. Live.
#[derive(Resource, Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Settings {
    /// Code of the language; the system's if none.
    pub language: Option<String>,
    /// Quality; fitting the graphics adapter if none.
    pub profile: Option<Profile>,
    /// Façades' highest level of detail.
    pub finest: u8,
    /// Frames a second that levels of detail make room for; none for any.
    pub hold_fps: Option<u16>,
    /// Kilobytes a second that streaming may take; none for all there are.
    pub kilobytes_s: Option<u32>,
    pub text_size: f32,
    pub high_contrast: bool,
    pub reduced_motion: bool,
    /// Windows, and how large and which way up the minimap is.
    pub minimap: bool,
    pub minimap_share: f32,
    pub minimap_radius_m: f32,
    /// Where it stands.
    pub minimap_left: bool,
    pub minimap_top: bool,
    pub north_up: bool,
    /// Layers of the map.
    pub map_names: bool,
    pub map_symbols: bool,
    pub map_views: bool,
    pub map_landmarks: bool,
    pub map_route: bool,
    pub map_trail: bool,
    pub map_tour: bool,
    pub colour_blind_safe: bool,
    /// Whether ways lead over no stairs.
    pub without_steps: bool,
    pub place_panel: bool,
    pub place_unfolded: bool,
    pub place_right: bool,
    pub captions: bool,
    /// Whether the city lives: pigeons, flags, water, clocks.
    pub life: bool,
    /// How loud all is, and of that the city, steps, bells and narration: factors.
    pub volume: f32,
    pub volume_city: f32,
    pub volume_steps: f32,
    pub volume_bells: f32,
    pub volume_narration: f32,
    pub muted: bool,
    /// Whether the city falls silent while its window is not in front.
    pub silent_behind: bool,
    /// Whether the bar stays; else it hides itself.
    pub bar_stays: bool,
    /// Whether the first minute has been gone through or skipped.
    pub knows_the_way: bool,
    /// What has been changed of keys: names of inputs by name of control.
    pub keys: WrittenControls,
}

impl Default for Settings {
    fn default() -> Self {
        let (map, sound) = (MinimapSettings::default(), SoundSettings::default());
        Self {
            language: None,
            profile: None,
            finest: 4,
            hold_fps: None,
            kilobytes_s: None,
            text_size: 1.0,
            high_contrast: false,
            reduced_motion: false,
            minimap: map.visible,
            minimap_share: map.share,
            minimap_radius_m: map.radius_m,
            minimap_left: map.left,
            minimap_top: map.top,
            north_up: map.north_up,
            map_names: map.names,
            map_symbols: map.symbols,
            map_views: map.views,
            map_landmarks: map.landmarks,
            map_route: map.route,
            map_trail: map.trail,
            map_tour: map.tour,
            colour_blind_safe: map.colour_blind_safe,
            without_steps: false,
            place_panel: true,
            place_unfolded: true,
            place_right: false,
            captions: true,
            life: true,
            volume: sound.master,
            volume_city: sound.ambience,
            volume_steps: sound.steps,
            volume_bells: sound.bells,
            volume_narration: sound.narration,
            muted: sound.is_muted,
            silent_behind: sound.rests_without_focus,
            bar_stays: false,
            knows_the_way: false,
            keys: WrittenControls::new(),
        }
    }
}

/// Where settings are kept, and how they came to be.
#[derive(Resource, Debug, Clone)]
pub(crate) struct SettingsFile {
    /// `None` where the system has no place for them: they last till the end then.
    path: Option<PathBuf>,
    /// What the command line has decided: it holds for this visit and is not kept.
    orders: Orders,
    kept: Settings,
    /// For how long what has changed was not kept, seconds.
    pending_s: f64,
}

/// What the command line decides.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Orders {
    pub language: Option<String>,
    pub profile: Option<Profile>,
    pub hold_fps: Option<u16>,
}

/// The folder for what a user has chosen.
fn config_dir() -> Option<PathBuf> {
    let var = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let base = var("XDG_CONFIG_HOME").or_else(|| var("APPDATA")).or_else(|| var("HOME").map(|home| home.join(".config")))?;
    Some(base.join("veduta"))
}

/// The language of the system, if the interface speaks it.
fn system_language(spoken: &[&str]) -> Option<String> {
    let told = ["LC_ALL", "LC_MESSAGES", "LANG"].iter().find_map(|name| std::env::var(name).ok().filter(|v| !v.is_empty()))?;
    let code = told.split(['_', '.', '@', '-']).next()?.to_lowercase();
    spoken.contains(&code.as_str()).then_some(code)
}

impl Settings {
    /// What was kept in the usual place. A file that cannot be read is told of and left alone until something else is chosen.
    pub fn read(orders: Orders) -> (Self, SettingsFile) {
        Self::read_from(config_dir().map(|dir| dir.join("settings.ron")), orders)
    }

    /// What was kept in a file; without one, as at first.
    pub fn read_from(path: Option<PathBuf>, orders: Orders) -> (Self, SettingsFile) {
        let found = path.as_ref().filter(|path| path.is_file());
        let kept = found.map_or_else(Self::default, |path| {
            file::read::<Self>(path).unwrap_or_else(|error| {
                warn!("settings as at first, for: {error}");
                Self::default()
            })
        });
        let kept = kept.within_bounds();
        let mut now = kept.clone();
        now.language = orders.language.clone().or(now.language);
        now.profile = orders.profile.or(now.profile);
        now.hold_fps = orders.hold_fps.or(now.hold_fps);
        (now, SettingsFile { path, orders, kept, pending_s: 0.0 })
    }

    /// Numbers that a hand has put out of bounds come back.
    fn within_bounds(mut self) -> Self {
        let within = |value: f32, (least, most): (f32, f32), otherwise: f32| {
            if value.is_finite() { value.clamp(least, most) } else { otherwise }
        };
        let usual = Self::default();
        self.text_size = within(self.text_size, TEXT_SIZE, usual.text_size);
        self.minimap_share = within(self.minimap_share, MINIMAP_SHARE, usual.minimap_share);
        self.minimap_radius_m = within(self.minimap_radius_m, MINIMAP_RADIUS_M, usual.minimap_radius_m);
        for (volume, usual) in [
            (&mut self.volume, usual.volume),
            (&mut self.volume_city, usual.volume_city),
            (&mut self.volume_steps, usual.volume_steps),
            (&mut self.volume_bells, usual.volume_bells),
            (&mut self.volume_narration, usual.volume_narration),
        ] {
            *volume = within(*volume, VOLUME, usual);
        }
        self.finest = self.finest.clamp(1, 4);
        self.hold_fps = self.hold_fps.map(|frames| frames.clamp(5, 500));
        self.kilobytes_s = self.kilobytes_s.map(|kilobytes| kilobytes.clamp(1, 1_000_000));
        self
    }
}

pub(crate) const TEXT_SIZE: (f32, f32) = (0.6, 2.5);
pub(crate) const VOLUME: (f32, f32) = (0.0, 1.5);
pub(crate) const MINIMAP_SHARE: (f32, f32) = (0.15, 0.6);
const MINIMAP_RADIUS_M: (f32, f32) = (25.0, 5_000.0);

impl SettingsFile {
    /// What is to be kept: what was chosen, but for what the command line decided.
    fn to_keep(&self, now: &Settings) -> Settings {
        let Orders { language, profile, hold_fps } = &self.orders;
        let mut keep = now.clone();
        if language.is_some() && now.language == *language {
            keep.language.clone_from(&self.kept.language);
        }
        if profile.is_some() && now.profile == *profile {
            keep.profile = self.kept.profile;
        }
        if hold_fps.is_some() && now.hold_fps == *hold_fps {
            keep.hold_fps = self.kept.hold_fps;
        }
        keep
    }

    fn write(&mut self, now: &Settings) {
        let keep = self.to_keep(now);
        let Some(path) = self.path.as_ref().filter(|_| keep != self.kept) else { return };
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).map_err(|error| error.to_string());
        match written.and_then(|()| file::write(&keep, path).map_err(|error| error.to_string())) {
            Ok(()) => self.kept = keep,
            Err(error) => {
                // Once is enough.
                self.path = None;
                warn!("settings cannot be kept: {error}");
            }
        }
    }
}

/// Settings as they bear on the rest, and their file.
pub(crate) struct SettingsPlugin;

impl Plugin for SettingsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, gather.after(ControlsSystems::Sense))
            .init_resource::<DroppedKeys>()
            .add_systems(PostStartup, read_controls)
            .add_systems(Update, (speak, dress, tune, reach, bind, enliven.after(reach)).run_if(resource_changed::<Settings>))
            .add_systems(Update, follow.after(reach))
            .add_systems(PostUpdate, keep)
            .add_systems(Last, keep_at_the_end);
    }
}

/// What was changed without the settings' window: by keys and wheel.
fn gather(
    (map, panel, captions): (Res<MinimapSettings>, Res<PanelSettings>, Res<CaptionSettings>),
    (lead, controls): (Res<LeadSettings>, Res<Controls>),
    mut settings: ResMut<Settings>,
) {
    let is_changed = map.is_changed() || panel.is_changed() || captions.is_changed() || lead.is_changed() || controls.is_changed();
    if !is_changed || settings.is_changed() {
        return;
    }
    let mut next = settings.clone();
    (next.minimap, next.minimap_share) = (map.visible, map.share);
    (next.minimap_radius_m, next.north_up) = (map.radius_m, map.north_up);
    (next.map_symbols, next.map_trail, next.map_tour) = (map.symbols, map.trail, map.tour);
    (next.map_names, next.map_views, next.map_landmarks) = (map.names, map.views, map.landmarks);
    (next.map_route, next.colour_blind_safe) = (map.route, map.colour_blind_safe);
    next.without_steps = lead.without_steps;
    (next.place_panel, next.captions) = (panel.visible, captions.visible);
    (next.minimap_left, next.minimap_top) = (map.left, map.top);
    (next.place_unfolded, next.place_right) = (panel.unfolded, panel.right);
    next.keys = controls.written();
    settings.set_if_neq(next);
}

/// Speaks the language that was chosen, else the system's.
fn speak(settings: Res<Settings>, mut words: ResMut<Words>) {
    let spoken: Vec<&str> = words.languages().collect();
    let language = settings.language.clone().or_else(|| system_language(&spoken)).unwrap_or_else(|| "en".to_owned());
    if words.language() != language {
        words.speak(&language);
    }
}

/// Letters, windows.
fn dress(
    settings: Res<Settings>,
    mut interface: ResMut<Interface>,
    mut map: ResMut<MinimapSettings>,
    mut panel: ResMut<PanelSettings>,
    mut captions: ResMut<CaptionSettings>,
    mut lead: ResMut<LeadSettings>,
) {
    lead.set_if_neq(LeadSettings { without_steps: settings.without_steps, ..*lead });
    interface.set_if_neq(Interface {
        size: settings.text_size,
        high_contrast: settings.high_contrast,
        reduced_motion: settings.reduced_motion,
        ..*interface
    });
    map.set_if_neq(MinimapSettings {
        visible: settings.minimap,
        share: settings.minimap_share,
        radius_m: settings.minimap_radius_m,
        left: settings.minimap_left,
        top: settings.minimap_top,
        north_up: settings.north_up,
        names: settings.map_names,
        symbols: settings.map_symbols,
        views: settings.map_views,
        landmarks: settings.map_landmarks,
        route: settings.map_route,
        colour_blind_safe: settings.colour_blind_safe,
        trail: settings.map_trail,
        tour: settings.map_tour,
    });
    panel.set_if_neq(PanelSettings {
        visible: settings.place_panel,
        unfolded: settings.place_unfolded,
        right: settings.place_right,
    });
    captions.set_if_neq(CaptionSettings { visible: settings.captions, ..*captions });
}

/// Takes the keys that were kept, once all controls are known. What cannot be taken is told of and left out of what is kept.
fn read_controls(
    list: Res<ControlList>,
    mut settings: ResMut<Settings>,
    mut controls: ResMut<Controls>,
    mut dropped: ResMut<DroppedKeys>,
) {
    let (kept, findings) = Controls::read(&settings.keys, &list);
    for finding in &findings {
        warn!("settings, keys: {finding}");
    }
    dropped.0 = findings.iter().map(ToString::to_string).collect();
    if !findings.is_empty() {
        settings.keys = kept.written();
    }
    controls.set_if_neq(kept);
}

/// What the kept settings said of keys and nobody could understand, for the visitor to read.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct DroppedKeys(pub Vec<String>);

/// Keys, where they were changed with all settings.
fn bind(settings: Res<Settings>, list: Res<ControlList>, mut controls: ResMut<Controls>) {
    if settings.keys != controls.written() {
        controls.set_if_neq(Controls::read(&settings.keys, &list).0);
    }
}

/// How loud things are.
fn tune(settings: Res<Settings>, mut sound: ResMut<SoundSettings>) {
    sound.set_if_neq(SoundSettings {
        master: settings.volume,
        ambience: settings.volume_city,
        steps: settings.volume_steps,
        bells: settings.volume_bells,
        narration: settings.volume_narration,
        is_muted: settings.muted,
        rests_without_focus: settings.silent_behind,
    });
}

/// Quality and what streaming may take.
fn reach(
    settings: Res<Settings>,
    mut commands: Commands,
    fitting: Res<Fitting>,
    mut profile: ResMut<Profile>,
    mut link: ResMut<Link>,
    auto: Option<Res<AutoLevels>>,
    mut levels: ResMut<LevelDistances>,
    mut streaming: ResMut<StreamingSettings>,
    mut building: ResMut<BuildSettings>,
) {
    profile.set_if_neq(settings.profile.unwrap_or(fitting.0));
    // What the profile allows, and of that what the visitor does.
    let mut allowed = profile.levels();
    for level in (settings.finest..4).map(usize::from) {
        (allowed.near[level - 1], allowed.far[level - 1]) = (0.0, 0.0);
    }
    levels.set_if_neq(allowed);
    let usual = profile.streaming();
    streaming.set_if_neq(StreamingSettings { finest: usual.finest.min(settings.finest.max(1)), ..usual });
    let relief_m = if settings.finest < 4 { 0.0 } else { profile.buildings().relief_m };
    building.set_if_neq(BuildSettings { relief_m, ..*building });
    let bytes_s = settings.kilobytes_s.map_or(f64::INFINITY, |kilobytes| f64::from(kilobytes) * 1_000.0);
    link.set_if_neq(Link { bytes_s, ..*link });
    match (settings.hold_fps, auto.is_some()) {
        (Some(frames), _) => commands.insert_resource(AutoLevels { frame_s: 1.0 / f64::from(frames.max(1)), ..default() }),
        (None, true) => {
            commands.remove_resource::<AutoLevels>();
            // What was drawn in for the frames' sake reaches out again.
            commands.insert_resource(LevelReach::default());
        }
        (None, false) => {}
    }
}

/// What lives: what the profile allows, if the visitor does.
fn enliven(settings: Res<Settings>, profile: Res<Profile>, mut life: ResMut<LifeSettings>) {
    let allowed = profile.life();
    life.set_if_neq(if settings.life { allowed } else { LifeSettings { kinds: LifeKinds::NONE, ..allowed } });
}

/// Seconds that choices rest before they are written: a slider is not written at every step.
const REST_S: f64 = 1.0;

fn keep(time: Res<Time<Real>>, settings: Res<Settings>, mut file: ResMut<SettingsFile>) {
    if settings.is_changed() {
        file.pending_s = f64::EPSILON;
        return;
    }
    if file.pending_s > 0.0 {
        file.pending_s += time.delta_secs_f64();
        if file.pending_s > REST_S {
            file.pending_s = 0.0;
            file.write(&settings);
        }
    }
}

fn keep_at_the_end(mut exits: MessageReader<AppExit>, settings: Res<Settings>, mut file: ResMut<SettingsFile>) {
    if exits.read().count() > 0 {
        file.write(&settings);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("veduta-settings-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        dir.join("settings.ron")
    }

    #[test]
    fn what_was_chosen_is_there_at_the_next_start() {
        let path = place("kept");
        let (mut settings, mut file) = Settings::read_from(Some(path.clone()), Orders::default());
        assert_eq!(settings, Settings::default());
        settings.language = Some("cs".into());
        settings.profile = Some(Profile::High);
        settings.text_size = 1.5;
        file.write(&settings);
        assert_eq!(Settings::read_from(Some(path.clone()), Orders::default()).0, settings);
        let _ = path.parent().map(std::fs::remove_dir_all);
    }

    #[test]
    fn the_command_line_holds_for_this_visit_alone() {
        let path = place("orders");
        let (mut settings, mut file) = Settings::read_from(Some(path.clone()), Orders::default());
        settings.language = Some("it".into());
        file.write(&settings);
        let orders = Orders { language: Some("cs".into()), profile: Some(Profile::Low), ..Orders::default() };
        let (mut settings, mut file) = Settings::read_from(Some(path.clone()), orders);
        assert_eq!((settings.language.as_deref(), settings.profile), (Some("cs"), Some(Profile::Low)));
        settings.captions = false;
        file.write(&settings);
        let (settings, _) = Settings::read_from(Some(path.clone()), Orders::default());
        assert_eq!((settings.language.as_deref(), settings.profile, settings.captions), (Some("it"), None, false));
        let _ = path.parent().map(std::fs::remove_dir_all);
    }

    #[test]
    fn keys_are_kept_and_those_that_nobody_knows_are_told_and_dropped() {
        let path = place("keys");
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("room");
        let text = r#"(text_size: 1.5, keys: {"walk.forward": ["KeyZ", "Nose"], "walk.sideways": ["KeyX"]})"#;
        std::fs::write(&path, text).expect("room");
        let (settings, file) = Settings::read_from(Some(path.clone()), Orders::default());
        assert_eq!(settings.text_size, 1.5, "the rest is read all the same");
        let mut app = App::new();
        app.add_plugins(MinimalPlugins);
        veduta::walker::add_controls(&mut app);
        app.insert_resource(settings).insert_resource(file).init_resource::<DroppedKeys>();
        app.add_systems(PostStartup, read_controls).add_systems(Update, bind);
        app.finish();
        app.update();
        let kept: WrittenControls = [("walk.forward".to_owned(), vec!["KeyZ".to_owned()])].into();
        assert_eq!(app.world().resource::<Controls>().written(), kept);
        let dropped = app.world().resource::<DroppedKeys>().0.join("; ");
        assert!(dropped.contains("Nose") && dropped.contains("walk.sideways"), "{dropped}");
        let settings = app.world().resource::<Settings>().clone();
        app.world_mut().resource_scope(|_, mut file: Mut<SettingsFile>| file.write(&settings));
        assert_eq!(Settings::read_from(Some(path.clone()), Orders::default()).0.keys, kept);
        app.world_mut().resource_mut::<Settings>().keys.clear();
        app.update();
        assert_eq!(*app.world().resource::<Controls>(), Controls::default(), "as at first");
        let _ = path.parent().map(std::fs::remove_dir_all);
    }

    #[test]
    fn a_file_with_a_mistake_or_odd_numbers_does_no_harm() {
        let path = place("odd");
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("room");
        for (text, size) in
            [("(text_size: 900)", TEXT_SIZE.1), ("(text_size: NaN)", 1.0), ("(text_siz", 1.0), ("(finest: 200)", 1.0)]
        {
            std::fs::write(&path, text).expect("room");
            let (settings, _) = Settings::read_from(Some(path.clone()), Orders::default());
            assert_eq!((settings.text_size, settings.finest), (size, 4), "{text}");
        }
        let _ = path.parent().map(std::fs::remove_dir_all);
    }
}
