use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use veduta_ecs::{Cell, CellReleased, City, CityFailed, OpenCity, StandingCells};
use veduta_store::{Client, ClientSettings, Payload, Reader, Request, RequestId, StoreError, open_reader};

use crate::{CurrentCell, Wanted};

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
    fetcher: Fetcher,
}

enum Fetcher {
    Threads { ask: Sender<Request>, answers: Mutex<Receiver<Fetched>> },
    Inline { reader: Arc<dyn Reader>, answers: VecDeque<Fetched> },
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
        Self { client, told: None, fetcher }
    }

    /// Sends a request on its way.
    pub fn ask(&mut self, request: Request) {
        match &mut self.fetcher {
            Fetcher::Inline { reader, answers } => {
                let answer = request.fetch(reader.as_ref());
                answers.push_back((request.id, answer));
            }
            // The threads end only with the store, so that sending cannot fail while it stands.
            Fetcher::Threads { ask, .. } => drop(ask.send(request)),
        }
    }

    /// The next answer, if one is there.
    pub fn answer(&mut self) -> Option<Fetched> {
        match &mut self.fetcher {
            Fetcher::Inline { answers, .. } => answers.pop_front(),
            Fetcher::Threads { answers, .. } => answers.get_mut().unwrap_or_else(PoisonError::into_inner).try_recv().ok(),
        }
    }
}

fn spawn_threads(reader: &Arc<dyn Reader>, threads: usize) -> Fetcher {
    let (ask, asked) = channel::<Request>();
    let (answer, answers) = channel::<Fetched>();
    let asked = Arc::new(Mutex::new(asked));
    for _ in 0..threads {
        let (reader, asked, answer) = (Arc::clone(reader), Arc::clone(&asked), answer.clone());
        std::thread::spawn(move || {
            loop {
                // The lock is held only while waiting for work; the end of the store ends the channel and the thread.
                let next = asked.lock().unwrap_or_else(PoisonError::into_inner).recv();
                let Ok(request) = next else { return };
                let fetched = request.fetch(reader.as_ref());
                if answer.send((request.id, fetched)).is_err() {
                    return;
                }
            }
        });
    }
    Fetcher::Threads { ask, answers: Mutex::new(answers) }
}

/// Opens the city that is asked for; closes the one before.
pub(crate) fn open_city(
    mut commands: Commands,
    asked: Option<Res<OpenCity>>,
    fetching: Res<Fetching>,
    cells: Query<(Entity, &Cell)>,
    mut standing: ResMut<StandingCells>,
    mut wanted: ResMut<Wanted>,
    viewers: Query<Entity, With<CurrentCell>>,
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
    commands.remove_resource::<City>();
    match open_reader(&asked.0) {
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
