mod event;
mod slot;

use std::collections::BTreeMap;
use std::sync::Arc;

use veduta_city::Level;

pub use event::{ClientEvent, ClientStats};
use slot::{Failure, RegionSlot, Slot, State};

use crate::index::WHAT as INDEX;
use crate::{BlobRef, CityIndex, INDEX_NAME, Payload, Request, RequestId, StoreError, What};

/// How a [`Client`] asks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClientSettings {
    /// Most requests on their way at a time; at least 1 is taken.
    pub max_in_flight: usize,
    /// Most bytes on their way at a time, as far as they are known beforehand; what is larger by itself travels alone.
    pub max_bytes_in_flight: u64,
    /// Seconds from one try to the next; twice as long after each further failure. After a failure, and after somebody answers who did
    /// not, at least so much time passes.
    pub retry_first_s: f64,
    /// Longest time in seconds from one try to the next, unless the first of them takes longer.
    pub retry_cap_s: f64,
    /// Seconds after which something that has only failed counts as not to be had, though it is tried on; those in which nobody was there
    /// to answer do not count.
    pub patience_s: f64,
    /// Most bytes of an index as stored, its regions apart.
    pub index_limit: u64,
}

impl Default for ClientSettings {
    fn default() -> Self {
        Self {
            max_in_flight: 8,
            max_bytes_in_flight: 4 << 20,
            retry_first_s: 0.5,
            retry_cap_s: 3.0,
            patience_s: 65.0,
            index_limit: 4 << 20,
        }
    }
}

/// Decides what to ask for and when: the index, then regions, each after its leaf of the index, then packets in the order wanted, each after
/// its region, that region's houses and the level before it, and when nothing of these is due, overviews of regions. It does no I/O, reads
/// no clock (`now_s` is any clock that does not go back), and answers the same for the same calls.
#[derive(Debug)]
pub struct Client {
    settings: ClientSettings,
    index: Option<CityIndex>,
    index_slot: Slot,
    leaves: Vec<Slot>,
    /// By region, and not forgotten with it if they fail: else they would be asked for without a pause.
    houses: Vec<Slot>,
    /// By region.
    overviews: Vec<Slot>,
    regions: Vec<RegionSlot>,
    files: Vec<Slot>,
    wanted_regions: Vec<u32>,
    later_regions: Vec<u32>,
    wanted_overviews: Vec<u32>,
    wanted_files: Vec<u32>,
    wanted: Vec<(u32, Level)>,
    /// So many of the most urgent are here: the search for the next begins behind them.
    all_here_before: usize,
    in_flight: BTreeMap<RequestId, Asked>,
    next_id: u64,
    /// Something failed because nobody answered, and nothing has come since.
    is_unreachable: bool,
    stats: ClientStats,
}

/// A request that is on its way.
#[derive(Debug, Clone, Copy)]
struct Asked {
    what: What,
    /// As far as it is known beforehand.
    bytes: u64,
    since_s: f64,
}

impl Client {
    /// A client that knows nothing yet; its first request is for the index.
    #[must_use]
    pub fn new(settings: ClientSettings) -> Self {
        Self {
            settings,
            index: None,
            index_slot: Slot::default(),
            leaves: Vec::new(),
            houses: Vec::new(),
            overviews: Vec::new(),
            regions: Vec::new(),
            files: Vec::new(),
            wanted_regions: Vec::new(),
            later_regions: Vec::new(),
            wanted_overviews: Vec::new(),
            wanted_files: Vec::new(),
            wanted: Vec::new(),
            all_here_before: 0,
            in_flight: BTreeMap::new(),
            next_id: 0,
            is_unreachable: false,
            stats: ClientStats::default(),
        }
    }

    /// The index, once it is there, with those of its regions that are.
    #[must_use]
    pub const fn index(&self) -> Option<&CityIndex> {
        self.index.as_ref()
    }

    /// Replaces the list of packets wanted, most urgent first. Each level that is not here must be listed: one that is not is not asked for,
    /// and neither are those above it. The regions that tell of them come by themselves. What is there, on its way, or not in the
    /// city may be listed too. What is on its way and no longer listed arrives nevertheless.
    pub fn want(&mut self, wanted: impl IntoIterator<Item = (u32, Level)>) {
        self.wanted.clear();
        self.wanted.extend(wanted);
        self.all_here_before = 0;
    }

    /// Replaces the lists of regions wanted for their own sake, most urgent first: those that come before any packet, and those that
    /// come when no packet is due.
    pub fn want_regions(&mut self, first: impl IntoIterator<Item = u32>, later: impl IntoIterator<Item = u32>) {
        self.wanted_regions.clear();
        self.wanted_regions.extend(first);
        self.later_regions.clear();
        self.later_regions.extend(later);
    }

    /// Replaces the list of regions whose overviews are wanted when nothing else is due, most urgent first. What the index tells of these
    /// regions comes by itself.
    pub fn want_overviews(&mut self, regions: impl IntoIterator<Item = u32>) {
        self.wanted_overviews.clear();
        self.wanted_overviews.extend(regions);
    }

    /// Replaces the list of files wanted, most urgent first, by their numbers in the index. They come after packets, and before what is only
    /// wanted when nothing else is due. A file that came is not asked for again unless [`Client::forget_file`] says so.
    pub fn want_files(&mut self, files: impl IntoIterator<Item = u32>) {
        self.wanted_files.clear();
        self.wanted_files.extend(files);
    }

    /// The next request to send off; `None` while there is nothing to ask for, enough is on its way, or all that is wanted
    /// waits to be tried again.
    pub fn next_request(&mut self, now_s: f64) -> Option<Request> {
        if self.in_flight.len() >= self.settings.max_in_flight.max(1) {
            return None;
        }
        if self.index.is_none() {
            return self.index_slot.is_due(now_s).then(|| self.request(What::Index, None, now_s));
        }
        let more = self.wanted[self.all_here_before..].iter().take_while(|&&(cell, level)| self.has(cell, level)).count();
        self.all_here_before += more;
        let region = self.wanted_regions.iter().find_map(|&number| self.region_due(number, now_s));
        let later = || self.later_regions.iter().find_map(|&number| self.region_due(number, now_s));
        let packet = || self.wanted[self.all_here_before..].iter().find_map(|&(cell, level)| self.packet_due(cell, level, now_s));
        let overview = || self.wanted_overviews.iter().find_map(|&number| self.overview_due(number, now_s));
        let file = || self.wanted_files.iter().find_map(|&number| self.file_due(number, now_s));
        let (what, blob) = region.or_else(packet).or_else(file).or_else(later).or_else(overview)?;
        // Overviews are in nobody's way.
        let is_overview = |what: &What| matches!(what, What::Overview(_));
        let counts = |asked: &What| !is_overview(asked) || is_overview(&what);
        let on_the_way: u64 = self.in_flight.values().filter(|asked| counts(&asked.what)).map(|asked| asked.bytes).sum();
        let has_room = on_the_way == 0 || on_the_way + u64::from(blob.bytes) <= self.settings.max_bytes_in_flight;
        has_room.then(|| self.request(what, Some(blob), now_s))
    }

    /// What is on its way.
    pub fn pending(&self) -> impl Iterator<Item = What> {
        self.in_flight.values().map(|asked| asked.what)
    }

    /// Requests for packets that are on their way and not wanted any more: those that were not sent yet may be taken back with
    /// [`Client::cancel`].
    #[must_use]
    pub fn unwanted(&self) -> Vec<RequestId> {
        let packets = self.in_flight.iter().filter_map(|(id, asked)| match asked.what {
            What::Packet { cell, level } => Some((*id, (cell, level))),
            _ => None,
        });
        // Few are on their way.
        packets.filter(|(_, packet)| !self.wanted.contains(packet)).map(|(id, _)| id).collect()
    }

    /// Takes back a request that was never sent: it counts as if it had not been made. Returns what it asked for; `None` if it is not on its
    /// way.
    pub fn cancel(&mut self, request: RequestId) -> Option<What> {
        let Asked { what, .. } = self.in_flight.remove(&request)?;
        self.stats.requests -= 1;
        self.stats.cancelled += 1;
        if let Some(slot) = self.slot_mut(what) {
            slot.state = State::Missing;
        }
        self.all_here_before = 0;
        Some(what)
    }

    /// Lets everything that failed and waits be tried again at once, as after a lost connection that stands again.
    pub fn retry_now(&mut self) {
        for slot in self.all_slots().filter(|slot| slot.state == State::Missing) {
            *slot = Slot::default();
        }
    }

    fn all_slots(&mut self) -> impl Iterator<Item = &mut Slot> {
        let others = self.leaves.iter_mut().chain(&mut self.houses).chain(&mut self.overviews).chain(&mut self.files);
        self.regions.iter_mut().flat_map(RegionSlot::slots_mut).chain([&mut self.index_slot]).chain(others)
    }

    /// A region, or the leaf that is to tell of it, if it is to be asked for now.
    fn region_due(&self, number: u32, now_s: f64) -> Option<(What, BlobRef)> {
        let index = self.index.as_ref()?;
        let (slot, asked) = match index.missing_leaf(number) {
            Some(leaf) => (self.leaves.get(leaf as usize)?, (What::Leaf(leaf), *index.leaves.get(leaf as usize)?)),
            None => (&self.regions.get(number as usize)?.slot, (What::Region(number), index.regions.get(number as usize)?.blob?)),
        };
        slot.is_due(now_s).then_some(asked)
    }

    /// A file, if it is to be asked for now.
    fn file_due(&self, number: u32, now_s: f64) -> Option<(What, BlobRef)> {
        let file = self.index.as_ref()?.files.get(number as usize)?;
        self.files.get(number as usize)?.is_due(now_s).then_some((What::File(number), file.blob))
    }

    /// The houses of a region, if it has some that are not here.
    fn missing_houses(&self, number: u32) -> Option<(&Slot, BlobRef)> {
        let blob = self.index.as_ref()?.region(number)?.houses?;
        let slot = self.houses.get(number as usize)?;
        (slot.state != State::Here).then_some((slot, blob))
    }

    /// Something that is read with the houses of a region, or they, if they are not here and are to be asked for now.
    fn houses_or(&self, asked: (What, BlobRef), number: u32, now_s: f64) -> Option<(What, BlobRef)> {
        match self.missing_houses(number) {
            Some((slot, blob)) => slot.is_due(now_s).then_some((What::Houses(number), blob)),
            None => Some(asked),
        }
    }

    /// The overview of a region, or what it is read with, if it is to be asked for now.
    fn overview_due(&self, number: u32, now_s: f64) -> Option<(What, BlobRef)> {
        if !self.overviews.get(number as usize)?.is_due(now_s) {
            return None;
        }
        let Some(region) = self.index.as_ref()?.region(number) else { return self.region_due(number, now_s) };
        self.houses_or((What::Overview(number), region.overview), number, now_s)
    }

    /// A packet, or what it is read with, if it is to be asked for now.
    fn packet_due(&self, cell: u32, level: Level, now_s: f64) -> Option<(What, BlobRef)> {
        let index = self.index.as_ref()?;
        let number = index.region_of(cell)?;
        let Some(slots) = self.slots(cell) else { return self.region_due(number, now_s) };
        let blob = index.cell(cell)?.packet(level)?;
        let is_next = level.index().checked_sub(1).is_none_or(|before| slots[before].state == State::Here);
        if !is_next || !slots[level.index()].is_due(now_s) {
            return None;
        }
        self.houses_or((What::Packet { cell, level }, *blob), number, now_s)
    }

    /// How it stands with a cell's levels, if its region is here.
    fn slots(&self, cell: u32) -> Option<&[Slot; 4]> {
        let index = self.index.as_ref()?;
        let number = index.region_of(cell)? as usize;
        self.regions.get(number)?.cells.get((cell - index.regions[number].first) as usize)
    }

    /// Takes the answer to a request.
    pub fn deliver(&mut self, request: RequestId, result: Result<Payload, StoreError>, now_s: f64) -> Vec<ClientEvent> {
        let Some(Asked { what, since_s, .. }) = self.in_flight.remove(&request) else {
            self.stats.unexpected += 1;
            return Vec::new();
        };
        match result.and_then(|payload| self.accept(what, payload)) {
            Ok(event) => {
                self.stats.delivered += 1;
                if let Some(slot) = self.slot_mut(what) {
                    *slot = Slot { state: State::Here, ..Slot::default() };
                }
                if std::mem::take(&mut self.is_unreachable) {
                    let until_s = now_s + self.settings.retry_first_s;
                    self.all_slots().for_each(|slot| slot.hope(until_s));
                }
                vec![event]
            }
            Err(error) => vec![self.fail(what, error, since_s, now_s)],
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

    /// Says that a packet that had arrived is of no use, and another will not be either.
    pub fn reject(&mut self, cell: u32, level: Level) {
        if let Some(slot) = self.slot_mut(What::Packet { cell, level }) {
            *slot = Slot { state: State::Dead, ..Slot::default() };
            self.all_here_before = 0;
        }
    }

    /// Says that a region that had arrived was released, with its houses: it may be asked for again. Does nothing as long as they, or packets
    /// of its cells, are on their way, or packets are there.
    pub fn forget_region(&mut self, number: u32) {
        let at = number as usize;
        let (Some(region), Some(houses)) = (self.regions.get_mut(at), self.houses.get_mut(at)) else { return };
        let Some(index) = &mut self.index else { return };
        let is_idle = |slot: &Slot| matches!(slot.state, State::Missing | State::Dead);
        let is_free = houses.state != State::InFlight && region.cells.iter().flatten().all(is_idle);
        if region.slot.state == State::Here && is_free {
            *region = RegionSlot::default();
            if houses.state == State::Here {
                *houses = Slot::default();
            }
            index.forget(number);
            self.all_here_before = 0;
        }
    }

    /// Says that an overview that had arrived was released: it may be asked for again. Does nothing for one that is not there.
    pub fn forget_overview(&mut self, region: u32) {
        if let Some(slot) = self.overviews.get_mut(region as usize)
            && slot.state == State::Here
        {
            *slot = Slot::default();
        }
    }

    /// Says that a file that had arrived was released: it may be asked for again. Does nothing for one that is not there.
    pub fn forget_file(&mut self, number: u32) {
        if let Some(slot) = self.files.get_mut(number as usize)
            && slot.state == State::Here
        {
            *slot = Slot::default();
        }
    }

    /// Whether a file cannot be had, as with [`Client::gave_up`].
    #[must_use]
    pub fn gave_up_file(&self, number: u32, now_s: f64) -> bool {
        self.files.get(number as usize).is_some_and(|slot| slot.gave_up(now_s, self.settings.patience_s))
    }

    /// Whether the overview of a region, or what tells of it, cannot be had, as with [`Client::gave_up`].
    #[must_use]
    pub fn gave_up_overview(&self, region: u32, now_s: f64) -> bool {
        let Some(slot) = self.overviews.get(region as usize).filter(|slot| slot.state != State::Here) else { return false };
        let is_told_of = self.index.as_ref().is_some_and(|index| index.region(region).is_some());
        let lacks_what_tells = if is_told_of { self.gave_up_houses(region, now_s) } else { self.gave_up_region(region, now_s) };
        lacks_what_tells || slot.gave_up(now_s, self.settings.patience_s)
    }

    /// Whether a packet has arrived and was not forgotten.
    #[must_use]
    pub fn has(&self, cell: u32, level: Level) -> bool {
        self.slots(cell).is_some_and(|slots| slots[level.index()].state == State::Here)
    }

    /// Whether a packet, or what it is read with, cannot be had: asking again cannot help, or has not helped for
    /// [`ClientSettings::patience_s`].
    #[must_use]
    pub fn gave_up(&self, cell: u32, level: Level, now_s: f64) -> bool {
        let Some(number) = self.index.as_ref().and_then(|index| index.region_of(cell)) else { return false };
        match self.slots(cell).map(|slots| &slots[level.index()]) {
            Some(slot) => {
                let is_here = slot.state == State::Here;
                slot.gave_up(now_s, self.settings.patience_s) || (!is_here && self.gave_up_houses(number, now_s))
            }
            None => self.gave_up_region(number, now_s),
        }
    }

    /// Whether the houses of a region cannot be had, as with [`Client::gave_up`].
    fn gave_up_houses(&self, number: u32, now_s: f64) -> bool {
        self.missing_houses(number).is_some_and(|(slot, _)| slot.gave_up(now_s, self.settings.patience_s))
    }

    /// Whether a region cannot be had, as with [`Client::gave_up`].
    #[must_use]
    pub fn gave_up_region(&self, number: u32, now_s: f64) -> bool {
        let leaf = self.index.as_ref().and_then(|index| index.missing_leaf(number));
        let leaf = leaf.and_then(|leaf| self.leaves.get(leaf as usize));
        let region = self.regions.get(number as usize).map(|region| &region.slot);
        leaf.into_iter().chain(region).any(|slot| slot.gave_up(now_s, self.settings.patience_s))
    }

    /// What it has done so far.
    #[must_use]
    pub fn stats(&self) -> ClientStats {
        ClientStats { in_flight: self.in_flight.len(), ..self.stats }
    }

    fn slot_mut(&mut self, what: What) -> Option<&mut Slot> {
        match what {
            What::Index => Some(&mut self.index_slot),
            What::Leaf(leaf) => self.leaves.get_mut(leaf as usize),
            What::Overview(number) => self.overviews.get_mut(number as usize),
            What::Houses(number) => self.houses.get_mut(number as usize),
            What::File(number) => self.files.get_mut(number as usize),
            What::Region(number) => self.regions.get_mut(number as usize).map(|region| &mut region.slot),
            What::Packet { cell, level } => {
                let index = self.index.as_ref()?;
                let number = index.region_of(cell)? as usize;
                let slots = self.regions.get_mut(number)?.cells.get_mut((cell - index.regions[number].first) as usize)?;
                Some(&mut slots[level.index()])
            }
        }
    }

    fn request(&mut self, what: What, blob: Option<BlobRef>, now_s: f64) -> Request {
        if let Some(slot) = self.slot_mut(what) {
            slot.state = State::InFlight;
        }
        let id = RequestId(self.next_id);
        self.next_id += 1;
        self.stats.requests += 1;
        let bytes = blob.as_ref().map_or(0, |blob| u64::from(blob.bytes));
        self.in_flight.insert(id, Asked { what, bytes, since_s: now_s });
        let (path, limit) = match &blob {
            Some(blob) => (blob.path(), u64::from(blob.bytes)),
            None => (INDEX_NAME.to_owned(), self.settings.index_limit),
        };
        let index = self.index.as_ref();
        let home = |cell: u32| {
            let (index, number) = (index?, index?.region_of(cell)?);
            Some((Arc::clone(index.region(number)?), (cell - index.regions[number as usize].first) as usize))
        };
        Request {
            id,
            path,
            limit,
            what,
            blob,
            regions: index.map_or_else(|| [].into(), |index| Arc::clone(&index.regions)),
            home: match what {
                What::Packet { cell, .. } => home(cell),
                What::Overview(number) | What::Houses(number) => {
                    index.and_then(|index| Some((Arc::clone(index.region(number)?), 0)))
                }
                What::Index | What::Leaf(_) | What::Region(_) | What::File(_) => None,
            },
            houses: match what {
                What::Packet { cell, .. } => index.and_then(|index| index.houses(index.region_of(cell)?).cloned()),
                What::Overview(number) => index.and_then(|index| index.houses(number).cloned()),
                What::Index | What::Leaf(_) | What::Region(_) | What::Houses(_) | What::File(_) => None,
            },
            palettes: index.map_or_else(|| [].into(), |index| Arc::clone(&index.palettes)),
        }
    }

    fn blob_bytes(&self, blob: impl FnOnce(&CityIndex) -> Option<BlobRef>) -> u64 {
        self.index.as_ref().and_then(blob).map_or(0, |blob| u64::from(blob.bytes))
    }

    /// Takes in what was asked for; fails if it is something else.
    fn accept(&mut self, what: What, payload: Payload) -> Result<ClientEvent, StoreError> {
        match (what, payload) {
            (What::Index, Payload::Index { index, bytes }) => {
                self.stats.bytes += bytes;
                self.regions = vec![RegionSlot::default(); index.regions.len()];
                self.overviews = vec![Slot::default(); index.regions.len()];
                self.leaves = vec![Slot::default(); index.leaves.len()];
                self.houses = vec![Slot::default(); index.regions.len()];
                self.files = vec![Slot::default(); index.files.len()];
                self.index = Some(*index);
                Ok(ClientEvent::Opened)
            }
            (What::Region(number), Payload::Region(region)) => {
                self.stats.bytes += self.blob_bytes(|index| index.regions.get(number as usize)?.blob);
                if let (Some(slots), Some(index)) = (self.regions.get_mut(number as usize), &mut self.index) {
                    slots.cells = vec![[Slot::default(); 4]; region.cells.len()];
                    index.put(number, region);
                }
                Ok(ClientEvent::RegionReady(number))
            }
            (What::Overview(region), Payload::Overview(overview)) => {
                self.stats.bytes += self.blob_bytes(|index| Some(index.region(region)?.overview));
                Ok(ClientEvent::OverviewReady { region, overview })
            }
            (What::Houses(number), Payload::Houses(houses)) => {
                self.stats.bytes += self.blob_bytes(|index| index.region(number)?.houses);
                if let Some(index) = &mut self.index {
                    index.put_houses(number, houses);
                }
                Ok(ClientEvent::Ready(what))
            }
            (What::Leaf(leaf), Payload::Leaf(regions)) => {
                self.stats.bytes += self.blob_bytes(|index| index.leaves.get(leaf as usize).copied());
                if let Some(index) = &mut self.index {
                    index.put_leaf(leaf, &regions);
                }
                Ok(ClientEvent::Ready(what))
            }
            (What::File(number), Payload::File(content)) => {
                self.stats.bytes += self.blob_bytes(|index| index.files.get(number as usize).map(|file| file.blob));
                Ok(ClientEvent::FileReady { number, content })
            }
            (What::Packet { cell, level }, Payload::Packet(packet)) if packet.level() == level => {
                let bytes = self.blob_bytes(|index| index.cell(cell)?.packet(level).copied());
                self.stats.bytes += bytes;
                self.stats.bytes_level[level.index()] += bytes;
                Ok(ClientEvent::Arrived { cell, level, packet: *packet })
            }
            (what, _) => Err(StoreError::Kind {
                expected: match what {
                    What::Index => INDEX,
                    What::Leaf(_) => "a leaf of the index",
                    What::Region(_) => "a region of the index",
                    What::Overview(_) => "an overview",
                    What::Houses(_) => "the houses of a region",
                    What::File(_) => "a file of the city",
                    What::Packet { .. } => "a packet of the level asked for",
                },
                found: "the answer to another request".to_owned(),
            }),
        }
    }

    /// Notes a failure and when to try again. An index that is wrong stays so: only one that did not arrive is asked for
    /// again. All else is named by its content, so that a copy with other bytes is a damaged one.
    fn fail(&mut self, what: What, error: StoreError, since_s: f64, now_s: f64) -> ClientEvent {
        self.stats.failures += 1;
        let is_final = error.is_permanent() || (what == What::Index && !matches!(error, StoreError::Read(_)));
        let failure = match &error {
            StoreError::Read(error) => Failure { is_unreachable: error.is_unreachable(), is_outage: error.is_outage() },
            _ => Failure { is_unreachable: false, is_outage: false },
        };
        self.is_unreachable |= failure.is_unreachable;
        let settings = self.settings;
        let mut again_in_s = None;
        if let Some(slot) = self.slot_mut(what) {
            let wait_s = slot.fail(&settings, failure, now_s - since_s, now_s);
            if is_final {
                slot.state = State::Dead;
            } else {
                again_in_s = Some(wait_s);
            }
        }
        ClientEvent::Failed { what, error: Arc::new(error), again_in_s }
    }
}
