//! What the client asks for, when, and what it makes of failures. Time is a number that the test moves.

mod sample;

use sample::{TempDir, city, large};
use veduta_city::Level::{self, Four, One, Three, Two};
use veduta_store::*;

/// A client and the city that it walks, with a server that can be made to fail.
struct Walk {
    _temp: TempDir,
    reader: DirReader,
    client: Client,
    now_s: f64,
}

impl Walk {
    fn new(cells: usize, settings: ClientSettings) -> Self {
        let temp = TempDir::new("client");
        city(cells, 1).write(&temp.0).expect("written");
        let reader = DirReader::new(&temp.0).expect("a city");
        Self { _temp: temp, reader, client: Client::new(settings), now_s: 0.0 }
    }

    /// A walk whose index is there, with its only region, the houses and the overview.
    fn open(cells: usize, settings: ClientSettings) -> Self {
        let mut walk = Self::new(cells, settings);
        walk.client.want_regions([0], []);
        walk.client.want_overviews([0]);
        for expected in [What::Index, What::Region(0), What::Houses(0), What::Overview(0)] {
            let request = walk.next().expect("a request");
            assert_eq!(request.what, expected);
            assert_eq!(walk.answer(&request).len(), 1);
        }
        walk
    }

    fn next(&mut self) -> Option<Request> {
        self.client.next_request(self.now_s)
    }

    fn answer(&mut self, request: &Request) -> Vec<ClientEvent> {
        self.client.deliver(request.id, request.fetch(&self.reader), self.now_s)
    }

    fn refuse(&mut self, request: &Request, error: StoreError) -> Vec<ClientEvent> {
        self.client.deliver(request.id, Err(error), self.now_s)
    }

    /// All requests that can be sent off now.
    fn burst(&mut self) -> Vec<Request> {
        std::iter::from_fn(|| self.next()).collect()
    }
}

fn packets(requests: &[Request]) -> Vec<(u32, Level)> {
    let packet = |request: &Request| match request.what {
        What::Packet { cell, level } => (cell, level),
        what => panic!("expected packets, found {what:?}"),
    };
    requests.iter().map(packet).collect()
}

/// What the only event says of a failure: when it is tried again.
fn again(events: &[ClientEvent]) -> Option<f64> {
    match events {
        [ClientEvent::Failed { again_in_s, .. }] => *again_in_s,
        events => panic!("expected one failure, found {events:?}"),
    }
}

fn dead() -> StoreError {
    StoreError::Read(ReadError::Failed {
        place: "nowhere".to_owned(),
        path: "x".to_owned(),
        message: "connection refused".to_owned(),
    })
}

#[test]
fn the_index_comes_first_then_regions_then_houses_then_packets_then_overviews() {
    let mut walk = Walk::new(3, ClientSettings::default());
    walk.client.want([(0, One), (1, One)]);
    walk.client.want_overviews([0]);
    let index = walk.next().expect("a request");
    assert_eq!((index.what, index.path.as_str()), (What::Index, INDEX_NAME));
    assert_eq!(walk.next(), None, "nothing else is known yet");
    assert_eq!(walk.answer(&index), [ClientEvent::Opened]);
    assert_eq!(walk.client.index().map(|index| (index.name.as_str(), index.cells().count())), Some(("Testov", 0)));
    let region = walk.burst();
    assert_eq!(region.iter().map(|request| request.what).collect::<Vec<_>>(), [What::Region(0)]);
    assert!(!walk.client.has(0, One) && !walk.client.gave_up(0, One, 1e9));
    assert_eq!(walk.answer(&region[0]), [ClientEvent::RegionReady(0)]);
    assert_eq!(walk.client.index().map(|index| index.cells().count()), Some(3));
    let houses = walk.burst();
    assert_eq!(houses.iter().map(|request| request.what).collect::<Vec<_>>(), [What::Houses(0)], "all else is read with them");
    assert_eq!(walk.answer(&houses[0]), [ClientEvent::Ready(What::Houses(0))]);
    let packet = walk.burst();
    let asked: Vec<What> = packet.iter().map(|request| request.what).collect();
    assert_eq!(asked, [What::Packet { cell: 0, level: One }, What::Packet { cell: 1, level: One }, What::Overview(0)]);
    let arrived = walk.answer(&packet[2]);
    assert!(
        matches!(&arrived[..], [ClientEvent::OverviewReady { region: 0, overview }] if overview.houses.len() == 6),
        "{arrived:?}"
    );
    assert_eq!(walk.next(), None, "it is there");
    walk.client.forget_overview(0);
    assert_eq!(walk.next().map(|request| request.what), Some(What::Overview(0)), "and is asked for again when it was let go");
    assert!(matches!(walk.answer(&packet[0])[..], [ClientEvent::Arrived { cell: 0, level: One, packet: Packet::Shell(_) }]));
    assert!(walk.client.has(0, One) && !walk.client.has(0, Two));
}

#[test]
fn a_region_that_does_not_come_is_tried_again_and_its_cells_wait() {
    let mut walk = Walk::new(2, ClientSettings::default());
    walk.client.want([(1, One)]);
    let index = walk.next().expect("a request");
    walk.answer(&index);
    for expected_s in [0.5, 1.0, 2.0] {
        let request = walk.next().expect("due");
        assert_eq!(request.what, What::Region(0));
        assert_eq!(again(&walk.refuse(&request, dead())), Some(expected_s));
        assert_eq!(walk.next(), None, "not yet");
        walk.now_s += expected_s;
    }
    let waits = |walk: &Walk, s: f64| !walk.client.gave_up(1, One, s);
    assert!(waits(&walk, 64.9) && !waits(&walk, 65.1), "after a minute nobody waits for it before a closed door");
    let request = walk.next().expect("due");
    walk.answer(&request);
    assert!(!walk.client.gave_up(1, One, 1e9));
    for expected_s in [0.5, 1.0, 2.0, 3.0] {
        let request = walk.next().expect("due");
        assert_eq!(request.what, What::Houses(0));
        assert_eq!(again(&walk.refuse(&request, dead())), Some(expected_s));
        assert_eq!(walk.next(), None, "not yet");
        walk.now_s += expected_s;
    }
    let gave_up = |walk: &Walk, s: f64| walk.client.gave_up(1, One, s) && walk.client.gave_up_overview(0, s);
    assert!(!gave_up(&walk, 65.0) && gave_up(&walk, 69.0), "nor for its houses");
    // A region that goes and comes again does not make them due.
    let request = walk.next().expect("due");
    walk.refuse(&request, dead());
    walk.client.forget_region(0);
    let region = walk.next().expect("it is wanted");
    assert_eq!(walk.answer(&region), [ClientEvent::RegionReady(0)]);
    assert_eq!(walk.next(), None, "not yet");
    walk.client.retry_now();
    let request = walk.next().expect("at once");
    walk.client.forget_region(0);
    assert_eq!(walk.answer(&request), [ClientEvent::Ready(What::Houses(0))], "a region whose houses are on their way stays");
    assert!(!gave_up(&walk, 1e9));
    assert_eq!(packets(&walk.burst()), [(1, One)]);
}

#[test]
fn a_region_is_forgotten_when_nothing_of_it_is_here() {
    let mut walk = Walk::open(2, ClientSettings::default());
    walk.client.want([(1, One)]);
    let request = walk.next().expect("a request");
    walk.client.forget_region(0);
    assert!(walk.client.index().expect("open").region(0).is_some(), "a packet is on its way");
    walk.answer(&request);
    walk.client.forget_region(0);
    assert!(walk.client.has(1, One), "a packet is here");
    walk.client.forget(1, One);
    walk.client.want_regions([], []);
    walk.client.want([]);
    walk.client.forget_region(0);
    walk.client.forget_region(7);
    assert_eq!((walk.client.index().expect("open").cells().count(), walk.next()), (0, None));
    walk.client.want([(0, One)]);
    assert_eq!(walk.next().expect("a request").what, What::Region(0));
}

#[test]
fn packets_come_in_the_order_wanted_and_levels_after_each_other() {
    let mut walk = Walk::open(3, ClientSettings::default());
    walk.client.want([(2, One), (2, Two), (0, One), (1, Two), (2, Three), (2, Four), (99, One)]);
    let first = walk.burst();
    assert_eq!(packets(&first), [(2, One), (0, One)], "level 2 waits for level 1, and nobody wants level 1 of cell 1");
    walk.answer(&first[1]);
    assert_eq!(walk.next(), None);
    walk.answer(&first[0]);
    assert_eq!(packets(&walk.burst()), [(2, Two)]);
    walk.client.want([(1, One)]);
    assert_eq!(packets(&walk.burst()), [(1, One)], "the new list replaces the old one");
}

#[test]
fn no_more_than_the_cap_are_on_their_way() {
    let mut walk = Walk::open(6, ClientSettings { max_in_flight: 3, ..ClientSettings::default() });
    walk.client.want((0..6).map(|cell| (cell, One)));
    let first = walk.burst();
    assert_eq!(packets(&first), [(0, One), (1, One), (2, One)]);
    assert_eq!(walk.client.stats().in_flight, 3);
    walk.refuse(&first[1], dead());
    assert_eq!(packets(&walk.burst()), [(3, One)], "a failure frees its place for the next");
    let mut none = Walk::new(1, ClientSettings { max_in_flight: 0, ..ClientSettings::default() });
    assert!(none.next().is_some(), "a cap of none is taken for one");
}

#[test]
fn no_more_bytes_than_the_cap_are_on_their_way() {
    let mut walk = Walk::open(6, ClientSettings { max_bytes_in_flight: 1, ..ClientSettings::default() });
    walk.client.want((0..6).map(|cell| (cell, One)));
    for cell in 0..6 {
        let one = walk.burst();
        assert_eq!(packets(&one), [(cell, One)], "what is larger than the cap travels alone");
        walk.answer(&one[0]);
    }
    let sizes = |walk: &Walk| -> Vec<u64> {
        let index = walk.client.index().expect("open");
        index.cells().map(|(_, cell)| u64::from(cell.packets[0].expect("a packet").bytes)).collect()
    };
    let mut walk = Walk::open(6, ClientSettings::default());
    let cap = sizes(&walk)[..3].iter().sum();
    walk = Walk::open(6, ClientSettings { max_bytes_in_flight: cap, ..ClientSettings::default() });
    walk.client.want((0..6).map(|cell| (cell, One)));
    assert_eq!(packets(&walk.burst()), [(0, One), (1, One), (2, One)]);
}

#[test]
fn an_overview_on_its_way_is_in_nobodys_way_and_later_regions_come_after_packets() {
    let mut walk = Walk::new(3, ClientSettings { max_bytes_in_flight: 1, ..ClientSettings::default() });
    walk.client.want_regions([], [0]);
    walk.client.want_overviews([0]);
    let index = walk.next().expect("the index");
    walk.answer(&index);
    let region = walk.next().expect("nothing else is due");
    assert_eq!(region.what, What::Region(0));
    walk.answer(&region);
    let houses = walk.next().expect("nothing else is due");
    assert_eq!(houses.what, What::Houses(0));
    walk.answer(&houses);
    let overview = walk.next().expect("nothing else is due");
    assert_eq!(overview.what, What::Overview(0));
    walk.client.want([(0, One)]);
    assert_eq!(packets(&walk.burst()), [(0, One)], "it is asked for although the overview fills the line");
}

#[test]
fn what_is_of_no_use_is_not_asked_for_again() {
    let mut walk = Walk::open(1, ClientSettings::default());
    walk.client.want([(0, One)]);
    let request = walk.next().expect("a request");
    walk.answer(&request);
    walk.client.reject(0, One);
    assert_eq!((walk.next(), walk.client.has(0, One), walk.client.gave_up(0, One, 0.0)), (None, false, true));
    walk.client.want([]);
    walk.client.want_regions([], []);
    walk.client.forget_region(0);
    assert_eq!(walk.client.index().expect("open").cells().count(), 0, "it holds nothing");
}

#[test]
fn a_level_is_asked_for_where_the_one_before_it_is_here_though_nobody_lists_that() {
    let mut walk = Walk::open(2, ClientSettings::default());
    walk.client.want([(0, One)]);
    let request = walk.next().expect("level 1");
    walk.answer(&request);
    walk.client.want([(0, Two), (1, Two)]);
    assert_eq!(packets(&walk.burst()), [(0, Two)], "of the other level 1 is not here");
}

#[test]
fn what_is_not_wanted_any_more_is_taken_back_before_it_is_sent() {
    let mut walk = Walk::open(4, ClientSettings::default());
    walk.client.want((0..4).map(|cell| (cell, One)));
    let requests = walk.burst();
    assert_eq!(walk.client.unwanted(), []);
    walk.client.want([(3, One), (1, One)]);
    let unwanted = walk.client.unwanted();
    assert_eq!(unwanted, [requests[0].id, requests[2].id]);
    assert_eq!(walk.client.cancel(unwanted[0]), Some(What::Packet { cell: 0, level: One }));
    assert_eq!(walk.client.cancel(unwanted[0]), None, "once");
    assert!(walk.answer(&requests[0]).is_empty(), "it is not expected any more");
    assert_eq!((walk.client.stats().in_flight, walk.client.stats().cancelled, walk.client.stats().failures), (3, 1, 0));
    walk.client.want([(0, One)]);
    assert_eq!(packets(&walk.burst()), [(0, One)], "it can be asked for again, at once");
}

#[test]
fn a_line_that_stands_again_is_used_at_once() {
    let mut walk = Walk::open(3, ClientSettings::default());
    walk.client.want((0..3).map(|cell| (cell, One)));
    for _ in 0..4 {
        for request in walk.burst() {
            walk.refuse(&request, dead());
        }
        walk.now_s += 4.0;
    }
    for request in walk.burst() {
        walk.refuse(&request, dead());
    }
    assert!(walk.next().is_none() && walk.client.gave_up(0, One, 80.0));
    walk.client.retry_now();
    assert!(!walk.client.gave_up(0, One, 80.0));
    assert_eq!(packets(&walk.burst()), [(0, One), (1, One), (2, One)]);
}

#[test]
fn a_packet_that_fails_is_tried_again_later_and_later() {
    let mut walk = Walk::open(1, ClientSettings::default());
    walk.client.want([(0, One), (0, Two)]);
    for expected_s in [0.5, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0] {
        let request = walk.next().expect("due");
        let damaged = request.decode(vec![0; request.limit as usize]);
        assert!(matches!(damaged, Err(StoreError::Checksum { .. })));
        let events = walk.client.deliver(request.id, damaged, walk.now_s);
        assert_eq!(again(&events), Some(expected_s));
        walk.now_s += expected_s * 0.99;
        assert_eq!(walk.next(), None, "not yet");
        walk.now_s += expected_s * 0.02;
    }
    let request = walk.next().expect("due");
    assert!(matches!(walk.answer(&request)[..], [ClientEvent::Arrived { level: One, .. }]));
    assert_eq!(walk.client.stats().failures, 7);
    let request = walk.next().expect("level 2");
    assert_eq!(again(&walk.refuse(&request, dead())), Some(0.5), "failures are counted for each packet");
}

#[test]
fn a_missing_packet_does_not_hold_up_the_others() {
    let mut walk = Walk::open(3, ClientSettings::default());
    let blob = walk.client.index().and_then(|index| index.cell(1)?.packets[0]).expect("a packet");
    std::fs::remove_file(walk._temp.join(&blob.path())).expect("removed");
    walk.client.want((0..3).flat_map(|cell| [(cell, One), (cell, Two)]));
    let mut arrived = Vec::new();
    for _ in 0..3 {
        for request in walk.burst() {
            for event in walk.answer(&request) {
                match event {
                    ClientEvent::Arrived { cell, level, .. } => arrived.push((cell, level)),
                    ClientEvent::Failed { what, error, again_in_s } => {
                        assert_eq!(what, What::Packet { cell: 1, level: One });
                        assert!(matches!(*error, StoreError::Read(ReadError::NotFound { .. })), "{error:?}");
                        assert!(again_in_s.is_some());
                    }
                    event => panic!("{event:?}"),
                }
            }
        }
    }
    assert_eq!(arrived, [(0, One), (2, One), (0, Two), (2, Two)]);
}

#[test]
fn the_walk_goes_on_when_a_dead_server_returns() {
    let mut walk = Walk::open(12, ClientSettings::default());
    walk.client.want((0..12).map(|cell| (cell, One)));
    // Dead for a minute, polled every tenth of a second.
    let mut tries = 0;
    while walk.now_s < 60.0 {
        for request in walk.burst() {
            assert!(again(&walk.refuse(&request, dead())).is_some());
            tries += 1;
        }
        walk.now_s += 0.1;
    }
    assert!((12 * 18..12 * 25).contains(&tries), "a dead server is not hammered: {tries} tries");
    let back_s = walk.now_s;
    while !(0..12).all(|cell| walk.client.has(cell, One)) {
        for request in walk.burst() {
            walk.answer(&request);
        }
        walk.now_s += 0.1;
        assert!(walk.now_s - back_s < 3.5, "all is there soon after");
    }
}

#[test]
fn a_failure_that_took_long_has_waited_already() {
    let mut walk = Walk::open(1, ClientSettings::default());
    walk.client.want([(0, One)]);
    // Each takes 2.5 s to fail: what is left of 0.5, 1, 2, 3 and 3 s, but never none.
    for expected_s in [0.5, 0.5, 0.5, 0.5, 0.5] {
        let request = walk.next().expect("due");
        walk.now_s += 2.5;
        assert_eq!(again(&walk.refuse(&request, dead())), Some(expected_s));
        assert_eq!(walk.next(), None, "not yet");
        walk.now_s += expected_s;
    }
    let request = walk.next().expect("due");
    walk.now_s += 1.0;
    assert_eq!(again(&walk.refuse(&request, dead())), Some(2.0), "3 s after it was asked for");
}

#[test]
fn a_line_that_comes_back_to_life_is_not_waited_for_any_longer() {
    let mut walk = Walk::open(6, ClientSettings::default());
    walk.client.want((0..6).map(|cell| (cell, One)));
    let missing = || StoreError::Read(ReadError::NotFound { place: "nowhere".to_owned(), path: "x".to_owned() });
    for round in 0..6 {
        let requests = walk.burst();
        assert_eq!(requests.len(), 6, "all are due");
        for request in requests {
            match request.what {
                // What the server says that it does not have is no matter of the line.
                What::Packet { cell: 0, .. } => assert!(again(&walk.refuse(&request, missing())).is_some()),
                What::Packet { cell: 5, .. } if round == 5 => assert_eq!(walk.answer(&request).len(), 1),
                _ => assert!(again(&walk.refuse(&request, dead())).is_some()),
            }
        }
        assert_eq!(walk.next(), None, "all wait");
        walk.now_s += if round < 5 { 3.0 } else { 0.5 };
    }
    assert_eq!(packets(&walk.burst()), [(1, One), (2, One), (3, One), (4, One)]);
}

#[test]
fn a_server_that_starts_late_is_waited_for() {
    let mut walk = Walk::new(1, ClientSettings::default());
    for expected_s in [0.5, 1.0] {
        let request = walk.next().expect("the index");
        assert_eq!(again(&walk.refuse(&request, dead())), Some(expected_s));
        walk.now_s += expected_s;
    }
    let request = walk.next().expect("the index");
    assert_eq!(walk.answer(&request), [ClientEvent::Opened]);
}

#[test]
fn a_newer_or_damaged_index_is_told_once() {
    let newer = StoreError::Newer { found: 9 };
    for error in [newer, StoreError::NotACity, StoreError::Checksum { what: "the index" }] {
        let mut walk = Walk::new(1, ClientSettings::default());
        walk.client.want([(0, One)]);
        let request = walk.next().expect("the index");
        assert_eq!(again(&walk.refuse(&request, error)), None);
        walk.now_s = 1e9;
        assert_eq!(walk.next(), None, "never again");
    }
}

#[test]
fn a_packet_that_is_wrong_for_good_is_told_once_and_the_others_come() {
    let mut walk = Walk::open(2, ClientSettings::default());
    walk.client.want([(0, One), (0, Two), (1, One)]);
    let requests = walk.burst();
    let wrong = StoreError::Malformed { what: "a packet", reason: "bytes are left over".to_owned() };
    assert_eq!(again(&walk.refuse(&requests[0], wrong)), None);
    walk.now_s = 1e9;
    walk.client.forget(0, One);
    assert_eq!(walk.next(), None, "neither it nor the level above it");
    assert_eq!(walk.answer(&requests[1]).len(), 1);
}

#[test]
fn what_was_forgotten_may_be_asked_for_again() {
    let mut walk = Walk::open(1, ClientSettings::default());
    walk.client.want([(0, One)]);
    let first = walk.next().expect("a request");
    walk.client.forget(0, One);
    assert_eq!(walk.next(), None, "it is still on its way");
    walk.answer(&first);
    assert_eq!(walk.next(), None, "it is there");
    walk.client.forget(0, One);
    walk.client.forget(7, One);
    let second = walk.next().expect("a request");
    assert_eq!((second.what, second.id > first.id), (first.what, true));
}

#[test]
fn answers_nobody_asked_for_change_nothing() {
    let mut walk = Walk::open(1, ClientSettings::default());
    walk.client.want([(0, One)]);
    let request = walk.next().expect("a request");
    let shell = request.fetch(&walk.reader);
    assert!(walk.client.deliver(RequestId(77), shell.clone(), 0.0).is_empty());
    let overview = Payload::Overview(Default::default());
    let events = walk.client.deliver(request.id, Ok(overview), 0.0);
    assert!(matches!(&events[..], [ClientEvent::Failed { error, .. }] if matches!(**error, StoreError::Kind { .. })), "{events:?}");
    assert!(walk.client.deliver(request.id, shell, 0.0).is_empty(), "answered already");
    assert_eq!(walk.client.stats().unexpected, 2);
    assert!(!walk.client.has(0, One));
}

#[test]
fn bytes_are_counted_as_stored() {
    let mut walk = Walk::open(2, ClientSettings::default());
    let index = walk.client.index().expect("open").clone();
    let index_bytes = std::fs::metadata(walk._temp.join(INDEX_NAME)).expect("a file").len();
    let opened = index_bytes
        + u64::from(index.regions[0].blob.expect("told").bytes)
        + u64::from(index.region(0).expect("here").houses.expect("some").bytes)
        + u64::from(index.region(0).expect("here").overview.bytes);
    assert_eq!(walk.client.stats().bytes, opened);
    walk.client.want([(0, One), (1, One)]);
    for request in walk.burst() {
        walk.answer(&request);
    }
    let level_1: u64 = index.cells().map(|(_, cell)| u64::from(cell.packets[0].expect("a packet").bytes)).sum();
    let stats = walk.client.stats();
    assert_eq!((stats.bytes, stats.bytes_level), (opened + level_1, [level_1, 0, 0, 0]));
    assert_eq!((stats.requests, stats.delivered, stats.failures, stats.in_flight), (6, 6, 0, 0));
}

#[test]
fn files_that_travel_with_a_city_come_when_they_are_asked_for_and_go_with_the_next_city() {
    let temp = TempDir::new("files");
    let sample = city(3, 1);
    let guide = "It is said that ".repeat(40).into_bytes();
    let write = |files: &[(&str, &[u8])]| {
        let mut writer = CityWriter::new(&temp.0, &sample.plan)?;
        writer.cells(&sample.plan, &sample.cells, &|cell| sample.parts(cell))?;
        files.iter().try_for_each(|(path, content)| writer.file(path, content))?;
        writer.finish(sample.cells.clone())
    };
    let stats = write(&[("t.tour.ron", b"()"), ("t.guide.ron", &guide)]).expect("written");
    assert!((20..200).contains(&stats.bytes_files), "{}", stats.bytes_files);
    let reader = DirReader::new(&temp.0).expect("a city");
    let mut client = Client::new(ClientSettings::default());
    client.want_files([0, 7]);
    let index = client.next_request(0.0).expect("a request");
    client.deliver(index.id, index.fetch(&reader), 0.0);
    let paths: Vec<_> = client.index().into_iter().flat_map(|index| &index.files).map(|file| file.path.as_str()).collect();
    assert_eq!(paths, ["t.guide.ron", "t.tour.ron"], "in order");
    let request = client.next_request(0.0).expect("a request");
    assert_eq!(request.what, What::File(0));
    let came = client.deliver(request.id, request.fetch(&reader), 0.0);
    assert_eq!(came, [ClientEvent::FileReady { number: 0, content: guide.clone().into() }]);
    assert_eq!(client.next_request(0.0), None, "it is here, and of number 7 there is nothing");
    client.forget_file(0);
    let again = client.next_request(0.0).expect("it was let go");
    // Damaged on the way: it is asked for again.
    let mut stored = reader.read(&again.path, again.limit).expect("there");
    *stored.last_mut().expect("bytes") ^= 1;
    let failed = client.deliver(again.id, again.decode(stored), 0.0);
    assert!(matches!(failed[..], [ClientEvent::Failed { what: What::File(0), again_in_s: Some(_), .. }]), "{failed:?}");
    assert_eq!(client.next_request(9.0).map(|request| request.what), Some(What::File(0)));
    // Paths that lead elsewhere, or are given twice, are refused, and the city stays as it was.
    for files in [&[("../t.ron", b"x".as_slice())][..], &[("a", b"x"), ("a", b"y")]] {
        assert!(matches!(write(files), Err(StoreError::Invalid { .. })), "{files:?}");
    }
    let before = stats.blobs;
    let stats = write(&[]).expect("written");
    assert_eq!((stats.blobs, stats.blobs_removed), (before - 2, 2));
}

#[test]
fn a_region_of_a_large_city_comes_after_the_leaf_that_tells_where_it_is() {
    let (index, leaf, page) = large();
    let mut client = Client::new(ClientSettings::default());
    client.want_regions([64], []);
    let ask = |client: &mut Client, what: What, bytes: &[u8]| {
        let request = client.next_request(0.0).expect("a request");
        assert_eq!((request.what, client.next_request(0.0)), (what, None), "nothing else can be asked for");
        client.deliver(request.id, request.decode(bytes.to_vec()), 0.0)
    };
    assert_eq!(ask(&mut client, What::Index, &encode_index(&index)), [ClientEvent::Opened]);
    assert!(again(&ask(&mut client, What::Leaf(1), b"another leaf")).is_some());
    assert!(client.gave_up_region(64, 70.0) && !client.gave_up_region(63, 70.0));
    client.retry_now();
    assert_eq!(ask(&mut client, What::Leaf(1), &leaf), [ClientEvent::Ready(What::Leaf(1))]);
    assert_eq!(ask(&mut client, What::Region(64), &page), [ClientEvent::RegionReady(64)]);
    let told = client.index().expect("open");
    assert_eq!(encode_index(told), encode_index(&index), "what leaves told is not told again");
    assert_eq!(client.stats().bytes, (encode_index(&index).len() + leaf.len() + page.len()) as u64);
}
