use std::collections::BTreeMap;
use std::sync::Arc;

use veduta_city::{Level, Overview};

use crate::index::WHAT as INDEX;
use crate::{BlobRef, CityIndex, INDEX_NAME, Packet, Payload, Request, RequestId, StoreError, What};

/// How a [`Client`] asks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClientSettings {
    /// Most requests on their way at a time; at least 1 is taken.
    pub max_in_flight: usize,
    /// Seconds until a failed request is tried again; twice as long after each further failure.
    pub retry_first_s: f64,
    /// Longest time in seconds until a failed request is tried again.
    pub retry_cap_s: f64,
    /// Most bytes of an index as stored.
    pub index_limit: u64,
}

impl Default for ClientSettings {
    fn default() -> Self {
        Self { max_in_flight: 8, retry_first_s: 0.5, retry_cap_s: 8.0, index_limit: 64 << 20 }
    }
}

/// What a delivery meant.
#[derive(Debug, Clone, PartialEq)]
pub enum ClientEvent {
    /// The index is there.
    Opened,
    /// The overview is there.
    OverviewReady,
    /// A packet is there. It may no longer be wanted: then call [`Client::forget`].
    Arrived {
        /// Which cell.
        cell: u32,
        /// Which level.
        level: Level,
        /// Its content.
        packet: Packet,
    },
    /// A request failed.
    Failed {
        /// What it asked for.
        what: What,
        /// Why.
        error: Arc<StoreError>,
        /// Seconds until it is tried again; `None` if that cannot help, and so never.
        again_in_s: Option<f64>,
    },
}

/// What a client has done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ClientStats {
    /// Requests made.
    pub requests: u64,
    /// Answers that were what was asked for.
    pub delivered: u64,
    /// Bytes of those answers as stored.
    pub bytes: u64,
    /// Of those, bytes of packets by [`Level::index`].
    pub bytes_level: [u64; 4],
    /// Requests that failed.
    pub failures: u64,
    /// Deliveries of requests that were not on their way: a mistake of whoever does the I/O.
    pub unexpected: u64,
    /// Requests on their way now.
    pub in_flight: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum State {
    #[default]
    Missing,
    InFlight,
    Here,
    /// Trying again cannot help.
    Dead,
}

/// How it stands with one thing that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Slot {
    state: State,
    /// Failures in a row.
    failures: u32,
    /// Not asked for before this time.
    again_s: f64,
}

impl Slot {
    fn is_due(&self, now_s: f64) -> bool {
        self.state == State::Missing && (self.failures == 0 || now_s >= self.again_s)
    }
}

/// Decides what to ask for and when: index, overview, then packets in the order wanted, each level of a cell after the one
/// before it. It does no I/O, reads no clock (`now_s` is any clock that does not go back), and answers the same for the
/// same calls.
#[derive(Debug)]
pub struct Client {
    settings: ClientSettings,
    index: Option<Arc<CityIndex>>,
    overview: Option<Arc<Overview>>,
    index_slot: Slot,
    overview_slot: Slot,
    /// By cell, then by level.
    slots: Vec<[Slot; 4]>,
    wanted: Vec<(u32, Level)>,
    /// So many of the most urgent are here: the search for the next begins behind them.
    all_here_before: usize,
    in_flight: BTreeMap<RequestId, What>,
    next_id: u64,
    stats: ClientStats,
}

impl Client {
    /// A client that knows nothing yet; its first request is for the index.
    #[must_use]
    pub fn new(settings: ClientSettings) -> Self {
        Self {
            settings,
            index: None,
            overview: None,
            index_slot: Slot::default(),
            overview_slot: Slot::default(),
            slots: Vec::new(),
            wanted: Vec::new(),
            all_here_before: 0,
            in_flight: BTreeMap::new(),
            next_id: 0,
            stats: ClientStats::default(),
        }
    }

    /// The index, once it is there.
    #[must_use]
    pub const fn index(&self) -> Option<&Arc<CityIndex>> {
        self.index.as_ref()
    }

    /// The overview, once it is there.
    #[must_use]
    pub const fn overview(&self) -> Option<&Arc<Overview>> {
        self.overview.as_ref()
    }

    /// Replaces the list of packets wanted, most urgent first. Each level must be listed: one that is not is not asked for,
    /// and neither are those above it. What is there, on its way, or not in the index may be listed too. What is on its way
    /// and no longer listed arrives nevertheless.
    pub fn want(&mut self, wanted: impl IntoIterator<Item = (u32, Level)>) {
        self.wanted.clear();
        self.wanted.extend(wanted);
        self.all_here_before = 0;
    }

    /// The next request to send off; `None` while there is nothing to ask for, enough is on its way, or all that is wanted
    /// waits to be tried again.
    pub fn next_request(&mut self, now_s: f64) -> Option<Request> {
        if self.in_flight.len() >= self.settings.max_in_flight.max(1) {
            return None;
        }
        let Some(index) = &self.index else {
            return self.index_slot.is_due(now_s).then(|| self.request(What::Index, None));
        };
        if self.overview_slot.is_due(now_s) {
            let blob = index.overview;
            return Some(self.request(What::Overview, Some(blob)));
        }
        let is_here = |&(cell, level): &(u32, Level)| {
            self.slots.get(cell as usize).is_some_and(|slots| slots[level.index()].state == State::Here)
        };
        let more = self.wanted[self.all_here_before..].iter().take_while(|packet| is_here(packet)).count();
        self.all_here_before += more;
        let (what, blob) = self.wanted[self.all_here_before..].iter().find_map(|&(cell, level)| {
            let slots = self.slots.get(cell as usize)?;
            let blob = index.cells.get(cell as usize)?.packet(level)?;
            let is_next = level.index().checked_sub(1).is_none_or(|before| slots[before].state == State::Here);
            (is_next && slots[level.index()].is_due(now_s)).then_some((What::Packet { cell, level }, *blob))
        })?;
        Some(self.request(what, Some(blob)))
    }

    /// Takes the answer to a request.
    pub fn deliver(&mut self, request: RequestId, result: Result<Payload, StoreError>, now_s: f64) -> Vec<ClientEvent> {
        let Some(what) = self.in_flight.remove(&request) else {
            self.stats.unexpected += 1;
            return Vec::new();
        };
        match result.and_then(|payload| self.accept(what, payload)) {
            Ok(event) => {
                self.stats.delivered += 1;
                if let Some(slot) = self.slot_mut(what) {
                    *slot = Slot { state: State::Here, ..Slot::default() };
                }
                vec![event]
            }
            Err(error) => vec![self.fail(what, error, now_s)],
        }
    }

    /// Says that a packet that had arrived was released: it may be asked for again. Does nothing for one that is not there.
    pub fn forget(&mut self, cell: u32, level: Level) {
        if let Some(slot) = self.slot_mut(What::Packet { cell, level })
            && slot.state == State::Here
        {
            *slot = Slot::default();
            self.all_here_before = 0;
        }
    }

    /// Whether a packet has arrived and was not forgotten.
    #[must_use]
    pub fn has(&self, cell: u32, level: Level) -> bool {
        self.slots.get(cell as usize).is_some_and(|slots| slots[level.index()].state == State::Here)
    }

    /// Whether a packet cannot be had: asking again cannot help, or did not help twice.
    #[must_use]
    pub fn gave_up(&self, cell: u32, level: Level) -> bool {
        let slot = self.slots.get(cell as usize).map(|slots| slots[level.index()]);
        slot.is_some_and(|slot| slot.state == State::Dead || slot.failures > 2)
    }

    /// What it has done so far.
    #[must_use]
    pub fn stats(&self) -> ClientStats {
        ClientStats { in_flight: self.in_flight.len(), ..self.stats }
    }

    fn slot_mut(&mut self, what: What) -> Option<&mut Slot> {
        match what {
            What::Index => Some(&mut self.index_slot),
            What::Overview => Some(&mut self.overview_slot),
            What::Packet { cell, level } => self.slots.get_mut(cell as usize).map(|slots| &mut slots[level.index()]),
        }
    }

    fn request(&mut self, what: What, blob: Option<BlobRef>) -> Request {
        if let Some(slot) = self.slot_mut(what) {
            slot.state = State::InFlight;
        }
        let id = RequestId(self.next_id);
        self.next_id += 1;
        self.stats.requests += 1;
        self.in_flight.insert(id, what);
        let (path, limit) = match &blob {
            Some(blob) => (blob.path(), u64::from(blob.bytes)),
            None => (INDEX_NAME.to_owned(), self.settings.index_limit),
        };
        Request { id, path, limit, what, blob }
    }

    /// Takes in what was asked for; fails if it is something else.
    fn accept(&mut self, what: What, payload: Payload) -> Result<ClientEvent, StoreError> {
        match (what, payload) {
            (What::Index, Payload::Index { index, bytes }) => {
                self.stats.bytes += bytes;
                self.slots = vec![[Slot::default(); 4]; index.cells.len()];
                self.index = Some(index);
                Ok(ClientEvent::Opened)
            }
            (What::Overview, Payload::Overview(overview)) => {
                self.stats.bytes += self.index.as_ref().map_or(0, |index| u64::from(index.overview.bytes));
                self.overview = Some(overview);
                Ok(ClientEvent::OverviewReady)
            }
            (What::Packet { cell, level }, Payload::Packet(packet)) if packet.level() == level => {
                let entry = self.index.as_ref().and_then(|index| index.cells.get(cell as usize));
                let bytes = entry.and_then(|entry| entry.packet(level)).map_or(0, |blob| u64::from(blob.bytes));
                self.stats.bytes += bytes;
                self.stats.bytes_level[level.index()] += bytes;
                Ok(ClientEvent::Arrived { cell, level, packet: *packet })
            }
            (what, _) => Err(StoreError::Kind {
                expected: match what {
                    What::Index => INDEX,
                    What::Overview => "the overview",
                    What::Packet { .. } => "a packet of the level asked for",
                },
                found: "the answer to another request".to_owned(),
            }),
        }
    }

    /// Notes a failure and when to try again. An index that is wrong stays so: only one that did not arrive is asked for
    /// again. All else is named by its content, so that a copy with other bytes is a damaged one.
    fn fail(&mut self, what: What, error: StoreError, now_s: f64) -> ClientEvent {
        self.stats.failures += 1;
        let is_final = error.is_permanent() || (what == What::Index && !matches!(error, StoreError::Read(_)));
        let settings = self.settings;
        let mut again_in_s = None;
        if let Some(slot) = self.slot_mut(what) {
            slot.failures = slot.failures.saturating_add(1);
            slot.state = if is_final { State::Dead } else { State::Missing };
            if !is_final {
                let wait_s = back_off_s(&settings, slot.failures);
                slot.again_s = now_s + wait_s;
                again_in_s = Some(wait_s);
            }
        }
        ClientEvent::Failed { what, error: Arc::new(error), again_in_s }
    }
}

/// Seconds to wait after so many failures in a row: doubled each time, up to the cap.
fn back_off_s(settings: &ClientSettings, failures: u32) -> f64 {
    // Beyond 2^60 times anything the cap holds.
    let doublings = failures.saturating_sub(1).min(60);
    (settings.retry_first_s * (1_u64 << doublings) as f64).min(settings.retry_cap_s)
}
