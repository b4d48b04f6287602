use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use bevy::prelude::*;
use veduta_city::Level;
use veduta_ecs::{Cell, CellReleased, City, CityFailed, OpenCity, StandingCells};
use veduta_store::{Client, ClientSettings, Payload, ReadError, Reader, Request, RequestId, StoreError, What, open_reader};

use crate::files::CityFiles;
use crate::journal::Event;
use crate::link::{Line, Link};
use crate::{CurrentCell, Journal, Wanted};

/// Where reading and decoding happen.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fetching {
    /// On so many threads of their own.
    Threads(usize),
    /// At once, in the system that asks: for tests and films, which must repeat exactly.
    Inline,
}

impl Default for Fetching {
    fn default() -> Self {
        Self::Threads(4)
    }
}

/// What came of a request.
pub(crate) type Fetched = (RequestId, Result<Payload, StoreError>);

/// The open store: its client and whoever reads for it. Present while a city is open or opening.
#[derive(Resource)]
pub(crate) struct Store {
    pub client: Client,
    /// The plan of what is wanted that the client has been told of.
    pub told: Option<u64>,
    /// The time of requests, seconds.
    pub now_s: f64,
    pub link: Link,
    line: Line,
    /// What has come over the line and was not taken yet.
    arrived: VecDeque<Fetched>,
    fetcher: Fetcher,
}

enum Fetcher {
    Threads { queue: Arc<Queue>, answers: Mutex<Receiver<Fetched>> },
    Inline { reader: Arc<dyn Reader>, answers: VecDeque<Fetched> },
}

/// Requests that no thread has taken yet.
#[derive(Default)]
struct Queue {
    /// `None` when the store is gone.
    waiting: Mutex<Option<VecDeque<Request>>>,
    news: Condvar,
}

impl Queue {
    fn with<T>(&self, what: impl FnOnce(&mut Option<VecDeque<Request>>) -> T) -> T {
        what(&mut self.waiting.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The next request, when there is one; `None` at the end.
    fn next(&self) -> Option<Request> {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let is_empty = |waiting: &mut Option<VecDeque<Request>>| waiting.as_ref().is_some_and(VecDeque::is_empty);
        let mut waiting = self.news.wait_while(waiting, is_empty).unwrap_or_else(PoisonError::into_inner);
        waiting.as_mut()?.pop_front()
    }
}

impl Drop for Fetcher {
    fn drop(&mut self) {
        if let Self::Threads { queue, .. } = self {
            queue.with(|waiting| *waiting = None);
            queue.news.notify_all();
        }
    }
}

impl Store {
    fn new(reader: Arc<dyn Reader>, fetching: Fetching) -> Self {
        let threads = match fetching {
            Fetching::Threads(n) => n.max(1),
            Fetching::Inline => 1,
        };
        let client = Client::new(ClientSettings { max_in_flight: threads * 2, ..ClientSettings::default() });
        let fetcher = match fetching {
            Fetching::Inline => Fetcher::Inline { reader, answers: VecDeque::new() },
            Fetching::Threads(_) => spawn_threads(&reader, threads),
        };
        Self { client, told: None, now_s: 0.0, link: Link::default(), line: Line::default(), arrived: VecDeque::new(), fetcher }
    }

    /// Whether level 1 of a cell cannot be had.
    pub fn gave_up(&self, cell: u32) -> bool {
        self.gave_up_level(cell, Level::One)
    }

    /// Whether a level of a cell cannot be had.
    pub fn gave_up_level(&self, cell: u32, level: Level) -> bool {
        self.client.gave_up(cell, level, self.now_s)
    }

    /// Whether a region cannot be had.
    pub fn gave_up_region(&self, region: u32) -> bool {
        self.client.gave_up_region(region, self.now_s)
    }

    /// Sends a request on its way.
    pub fn ask(&mut self, request: Request) {
        self.line.ask(&request, &self.link, self.now_s);
        match &mut self.fetcher {
            Fetcher::Inline { reader, answers } => {
                let answer = request.fetch(reader.as_ref());
                answers.push_back((request.id, answer));
            }
            Fetcher::Threads { queue, .. } => {
                queue.with(|waiting| waiting.as_mut().map(|waiting| waiting.push_back(request)));
                queue.news.notify_one();
            }
        }
    }

    /// Takes back those requests that are not wanted any more and that no thread has taken. Returns what they asked for.
    pub fn cancel_unwanted(&mut self) -> Vec<What> {
        let Fetcher::Threads { queue, .. } = &self.fetcher else { return Vec::new() };
        let mut unwanted = self.client.unwanted();
        if unwanted.is_empty() {
            return Vec::new();
        }
        queue.with(|waiting| {
            let Some(waiting) = waiting else { return };
            unwanted.retain(|id| waiting.iter().any(|request| request.id == *id));
            waiting.retain(|request| !unwanted.contains(&request.id));
        });
        unwanted.iter().for_each(|id| self.line.cancel(*id));
        unwanted.into_iter().filter_map(|id| self.client.cancel(id)).collect()
    }

    /// The next answer, if one is there.
    pub fn answer(&mut self) -> Option<Fetched> {
        loop {
            let read = match &mut self.fetcher {
                Fetcher::Inline { answers, .. } => answers.pop_front(),
                Fetcher::Threads { answers, .. } => answers.get_mut().unwrap_or_else(PoisonError::into_inner).try_recv().ok(),
            };
            let Some(fetched) = read else { break };
            self.line.take(fetched, &self.link, self.now_s);
        }
        self.arrived.extend(self.line.arrived(&self.link, self.now_s));
        self.arrived.pop_front()
    }
}

fn spawn_threads(reader: &Arc<dyn Reader>, threads: usize) -> Fetcher {
    let queue = Arc::new(Queue { waiting: Mutex::new(Some(VecDeque::new())), news: Condvar::new() });
    let (answer, answers) = channel::<Fetched>();
    for _ in 0..threads {
        let (reader, queue, answer) = (Arc::clone(reader), Arc::clone(&queue), answer.clone());
        std::thread::spawn(move || {
            while let Some(request) = queue.next() {
                let fetched = request.fetch(reader.as_ref());
                if answer.send((request.id, fetched)).is_err() {
                    return;
                }
            }
        });
    }
    Fetcher::Threads { queue, answers: Mutex::new(answers) }
}

/// Reads a city again from the beginning of its waits: everything that failed is asked for at once, as after a lost connection that
/// stands again.
#[derive(Message, Debug, Clone, Copy, Default)]
pub struct Reconnect;

pub(crate) fn reconnect(mut asked: MessageReader<Reconnect>, store: Option<ResMut<Store>>) {
    if asked.read().count() > 0
        && let Some(mut store) = store
    {
        store.client.retry_now();
    }
}

/// Where cities from web servers are kept, so that a return costs nothing. Without a directory nothing is kept. Not in browsers, which
/// keep files themselves.
#[derive(Resource, Debug, Clone, PartialEq, Eq)]
pub struct StreamingCache {
    /// The directory, which several programs may share.
    pub dir: Option<PathBuf>,
    /// Most bytes that are kept; what was not used for longest goes.
    pub cap_bytes: u64,
}

impl Default for StreamingCache {
    fn default() -> Self {
        Self { dir: None, cap_bytes: 256 << 20 }
    }
}

/// Reads every city in place of what its place asks for: a transport of one's own.
#[derive(Resource, Clone)]
pub struct CityReader(
    /// Called on threads of streaming's own, or at once with [`Fetching::Inline`].
    pub Arc<dyn Reader>,
);

/// A reader for a place; what comes from a web server is kept.
fn reader_of(place: &str, cache: &StreamingCache) -> Result<Arc<dyn Reader>, ReadError> {
    let reader = open_reader(place)?;
    #[cfg(not(target_arch = "wasm32"))]
    if let Some(dir) = &cache.dir
        && place.contains("://")
    {
        return Ok(Arc::new(veduta_store::CacheReader::new(reader, dir, cache.cap_bytes)));
    }
    #[cfg(target_arch = "wasm32")]
    let _ = cache;
    Ok(reader)
}

/// Opens the city that is asked for; closes the one before.
pub(crate) fn open_city(
    mut commands: Commands,
    asked: Option<Res<OpenCity>>,
    fetching: Res<Fetching>,
    cache: Res<StreamingCache>,
    own: Option<Res<CityReader>>,
    time: Res<Time>,
    mut journal: ResMut<Journal>,
    cells: Query<(Entity, &Cell)>,
    mut standing: ResMut<StandingCells>,
    mut wanted: ResMut<Wanted>,
    viewers: Query<Entity, With<CurrentCell>>,
    files: Option<ResMut<CityFiles>>,
    mut released: MessageWriter<CellReleased>,
    mut failed: MessageWriter<CityFailed>,
) {
    let Some(asked) = asked else { return };
    if !asked.is_changed() {
        return;
    }
    for (entity, cell) in &cells {
        released.write(CellReleased { cell: cell.0 });
        commands.entity(entity).despawn();
    }
    for viewer in &viewers {
        commands.entity(viewer).remove::<CurrentCell>();
    }
    standing.clear();
    *wanted = Wanted::default();
    files.into_iter().for_each(|mut files| files.close());
    commands.remove_resource::<City>();
    journal.note(time.elapsed_secs_f64(), Event::Opened { place: asked.0.clone() });
    let reader = match own {
        Some(own) => Ok(Arc::clone(&own.0)),
        None => reader_of(&asked.0, &cache),
    };
    match reader {
        Ok(reader) => {
            info!("opening {}", reader.describe());
            commands.insert_resource(Store::new(reader, *fetching));
        }
        Err(error) => {
            commands.remove_resource::<Store>();
            let message = error.to_string();
            error!("{message}");
            failed.write(CityFailed { message, will_retry: false });
        }
    }
}
