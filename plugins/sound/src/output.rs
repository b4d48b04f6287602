use core::num::{NonZeroU16, NonZeroU32};
use core::time::Duration;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::audio::{AudioPlayer, AudioSink, AudioSinkPlayback, Decodable, PlaybackSettings, Source};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use veduta_synth::{BLOCK, Desk, Order};

use crate::SoundSettings;

/// Frames a second of the stream; the engine brings it to the device's own rate.
const RATE_HZ: u32 = 48_000;
/// Orders that may wait for the audio device. One that does not listen must not fill the memory.
const MOST_ORDERS: usize = 1_024;
/// Seconds after which an audio device that has not begun to play is not awaited any more.
const PATIENCE_S: f32 = 3.0;

/// Takes what is heard as samples instead of playing it, in the app's time: for films and tests. Insert it before the app runs.
#[derive(Resource)]
pub struct SoundTrack {
    desk: Desk,
    samples: Vec<f32>,
    /// Frames that are owed: time does not come in whole ones.
    owed: f64,
}

impl SoundTrack {
    /// An empty one of so many frames a second, 8,000 to 192,000.
    #[must_use]
    pub fn new(rate_hz: u32) -> Self {
        Self { desk: Desk::new(rate_hz), samples: Vec::new(), owed: 0.0 }
    }

    /// Frames a second.
    #[must_use]
    pub fn rate_hz(&self) -> u32 {
        self.desk.rate_hz()
    }

    /// What has been heard since it was last asked: interleaved stereo, left first.
    pub fn take(&mut self) -> Vec<f32> {
        core::mem::take(&mut self.samples)
    }
}

/// Where orders go.
#[derive(Resource, Default)]
pub(crate) struct Output {
    orders: Vec<Order>,
    live: Option<Live>,
    master: Option<f32>,
    /// Whether it was told that nothing is heard.
    has_told: bool,
    waited_s: f32,
}

/// The way to the audio device.
struct Live {
    sender: SyncSender<Order>,
    listens: Arc<AtomicBool>,
    stream: Entity,
}

impl Output {
    /// An order for the desk.
    pub fn order(&mut self, order: Order) {
        self.orders.push(order);
    }

    /// Frames a second of what listens.
    pub fn rate_hz(&self, track: Option<&SoundTrack>) -> f64 {
        track.map_or(RATE_HZ, SoundTrack::rate_hz).into()
    }

    /// Whether the audio device plays.
    pub fn listens(&self) -> bool {
        self.live.as_ref().is_some_and(|live| live.listens.load(Ordering::Relaxed))
    }
}

/// Whether anybody listens: else nothing need be found out.
pub(crate) fn is_heard(output: Res<Output>, track: Option<Res<SoundTrack>>) -> bool {
    track.is_some() || output.listens()
}

/// The stream of a city's sound, for the engine to play.
#[derive(Asset, TypePath)]
pub(crate) struct CityStream {
    orders: Mutex<Option<Receiver<Order>>>,
    listens: Arc<AtomicBool>,
}

/// The desk as the engine plays it.
pub(crate) struct CityDecoder {
    desk: Desk,
    orders: Option<Receiver<Order>>,
    listens: Arc<AtomicBool>,
    samples: [f32; 2 * BLOCK],
    at: usize,
}

impl Decodable for CityStream {
    type Decoder = CityDecoder;

    fn decoder(&self) -> CityDecoder {
        // Whoever asks a second time hears nothing: there is one desk.
        let orders = self.orders.lock().unwrap_or_else(PoisonError::into_inner).take();
        CityDecoder {
            desk: Desk::new(RATE_HZ),
            orders,
            listens: Arc::clone(&self.listens),
            samples: [0.0; 2 * BLOCK],
            at: 2 * BLOCK,
        }
    }
}

impl Iterator for CityDecoder {
    type Item = f32;

    fn next(&mut self) -> Option<f32> {
        if self.at == self.samples.len() {
            if let Some(orders) = &self.orders {
                self.listens.store(true, Ordering::Relaxed);
                orders.try_iter().for_each(|order| self.desk.obey(order));
            }
            self.desk.fill(&mut self.samples);
            self.at = 0;
        }
        let sample = self.samples[self.at];
        self.at += 1;
        Some(sample)
    }
}

/// Left and right.
const CHANNELS: NonZeroU16 = NonZeroU16::new(2).expect("two is not zero");
const RATE: NonZeroU32 = NonZeroU32::new(RATE_HZ).expect("the rate is not zero");

impl Source for CityDecoder {
    fn current_span_len(&self) -> Option<usize> {
        None
    }

    fn channels(&self) -> NonZeroU16 {
        CHANNELS
    }

    fn sample_rate(&self) -> NonZeroU32 {
        RATE
    }

    fn total_duration(&self) -> Option<Duration> {
        None
    }
}

/// Gives the engine the stream to play.
pub(crate) fn connect(mut commands: Commands, mut streams: ResMut<Assets<CityStream>>, mut output: ResMut<Output>) {
    let (sender, orders) = sync_channel(MOST_ORDERS);
    let listens = Arc::new(AtomicBool::new(false));
    let stream = CityStream { orders: Mutex::new(Some(orders)), listens: Arc::clone(&listens) };
    let stream = commands.spawn((AudioPlayer(streams.add(stream)), PlaybackSettings::ONCE)).id();
    output.live = Some(Live { sender, listens, stream });
}

/// Tells once that there is no device to play on.
pub(crate) fn look_for_device(time: Res<Time<Real>>, sinks: Query<&AudioSink>, mut output: ResMut<Output>) {
    let Some(live) = &output.live else { return };
    if output.has_told || live.listens.load(Ordering::Relaxed) {
        return;
    }
    if sinks.get(live.stream).is_ok_and(|sink| !sink.is_paused()) {
        // Browsers begin to play with the visitor's first touch.
        return;
    }
    output.waited_s += time.delta_secs();
    if output.waited_s > PATIENCE_S {
        output.has_told = true;
        info!("there is no audio device: the city is silent, all else goes on");
    }
}

/// How loud the whole is.
pub(crate) fn turn_up(
    settings: Res<SoundSettings>,
    track: Option<Res<SoundTrack>>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut output: ResMut<Output>,
) {
    // A film's sound track is made whatever window is in front.
    let has_focus = track.is_some() || windows.iter().next().is_none_or(|window| window.focused);
    let master = settings.whole(has_focus);
    if output.master != Some(master) && (track.is_some() || output.listens()) {
        output.master = Some(master);
        output.order(Order::Master(master));
    }
}

/// Sends what was ordered in this frame. What finds no room waits.
pub(crate) fn send(time: Res<Time>, track: Option<ResMut<SoundTrack>>, mut output: ResMut<Output>) {
    let output = &mut *output;
    if let Some(mut track) = track {
        let track = &mut *track;
        output.orders.drain(..).for_each(|order| track.desk.obey(order));
        track.owed += time.delta_secs_f64() * f64::from(track.desk.rate_hz());
        // Times are sums of fractions: what lacks a trifle of a frame is one.
        let frames = (track.owed + 1e-6).floor();
        track.owed -= frames;
        let from = track.samples.len();
        track.samples.resize(from + 2 * frames as usize, 0.0);
        track.desk.fill(&mut track.samples[from..]);
        return;
    }
    let Some(live) = output.live.as_ref().filter(|live| live.listens.load(Ordering::Relaxed)) else {
        output.orders.clear();
        return;
    };
    let mut waiting = Vec::new();
    for order in output.orders.drain(..) {
        if waiting.is_empty() {
            match live.sender.try_send(order) {
                Err(TrySendError::Full(order)) => waiting.push(order),
                Ok(()) | Err(TrySendError::Disconnected(_)) => {}
            }
        } else if waiting.len() < MOST_ORDERS && !matches!(order, Order::Set(..)) {
            // Levels are told anew soon.
            waiting.push(order);
        }
    }
    output.orders = waiting;
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_synth::{ChannelId, Levels, voice};

    fn fountain() -> Order {
        let voice = voice(&veduta_city::Sound::FOUNTAIN, 1, 48_000.0).expect("it is made");
        let levels = Levels { gain: 1.0, pan: 0.0, cutoff_hz: 20_000.0 };
        Order::Start { id: ChannelId(1), voice, levels, delay_s: 0.0, is_once: false }
    }

    #[test]
    fn the_stream_plays_what_was_ordered_and_never_ends() {
        let (sender, orders) = sync_channel(8);
        let listens = Arc::new(AtomicBool::new(false));
        let stream = CityStream { orders: Mutex::new(Some(orders)), listens: Arc::clone(&listens) };
        let mut decoder = stream.decoder();
        assert!((0..2_000).all(|_| decoder.next() == Some(0.0)) && listens.load(Ordering::Relaxed));
        sender.send(fountain()).expect("room");
        let loudest = (0..96_000).filter_map(|_| decoder.next()).fold(0.0, |most: f32, x| most.max(x.abs()));
        assert!((0.1..=1.0).contains(&loudest), "{loudest}");
        assert_eq!((decoder.channels().get(), decoder.sample_rate().get()), (2, RATE_HZ));
        drop(sender);
        assert!(decoder.next().is_some(), "it goes on when the game is gone");
        let mut second = stream.decoder();
        assert!((0..2_000).all(|_| second.next() == Some(0.0)), "there is one desk");
    }

    #[test]
    fn orders_never_pile_up_where_nobody_takes_them() {
        let mut app = App::new();
        let (sender, _orders) = sync_channel(4);
        let listens = Arc::new(AtomicBool::new(true));
        app.add_plugins(MinimalPlugins).init_resource::<Output>().add_systems(Update, send);
        app.world_mut().resource_mut::<Output>().live = Some(Live { sender, listens, stream: Entity::PLACEHOLDER });
        for _ in 0..2_000 {
            let mut output = app.world_mut().resource_mut::<Output>();
            (0..4).for_each(|_| output.order(Order::Set(ChannelId(1), Levels::SILENT)));
            output.order(fountain());
            app.update();
        }
        assert!(app.world().resource::<Output>().orders.len() <= MOST_ORDERS + 1);
    }
}
