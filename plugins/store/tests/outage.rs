//! A server that is gone, for however long: what it has is waited for, and what it does not have is not.

mod sample;

use sample::{TempDir, city};
use veduta_city::Level::One;
use veduta_store::*;

/// A client by hand: all that is due is asked for, and answered at once.
struct Visit {
    client: Client,
    reader: DirReader,
    now_s: f64,
}

impl Visit {
    fn step(&mut self, fail: impl Fn(What) -> Option<ReadError>) {
        while let Some(request) = self.client.next_request(self.now_s) {
            let answer = fail(request.what).map_or_else(|| request.fetch(&self.reader), |error| Err(error.into()));
            self.client.deliver(request.id, answer, self.now_s);
        }
        self.now_s += 0.1;
    }

    fn steps(&mut self, seconds: f64, fail: impl Fn(What) -> Option<ReadError>) {
        (0..(seconds * 10.0) as u32).for_each(|_| self.step(&fail));
    }

    fn gave_up(&self, cell: u32) -> bool {
        self.client.gave_up(cell, One, self.now_s)
    }
}

fn told() -> (String, String) {
    ("a server".to_owned(), "x".to_owned())
}

fn no_answer(_: What) -> Option<ReadError> {
    let (place, path) = told();
    Some(ReadError::NoAnswer { place, path, message: "connection refused".to_owned() })
}

/// What a server says that has everything but level 1 of cell 1.
fn not_found(what: What) -> Option<ReadError> {
    let (place, path) = told();
    (what == What::Packet { cell: 1, level: One }).then_some(ReadError::NotFound { place, path })
}

#[test]
fn what_nobody_could_tell_of_is_waited_for() {
    let temp = TempDir::new("outage");
    city(3, 1).write(&temp.0).expect("written");
    let reader = DirReader::new(&temp.0).expect("a city");
    let mut visit = Visit { client: Client::new(ClientSettings::default()), reader, now_s: 0.0 };
    visit.client.want([(0, One)]);
    visit.steps(3.0, |_| None);
    assert!(visit.client.has(0, One));
    visit.client.want([(0, One), (1, One), (2, One)]);
    // Half of the patience with a server that is there, and ten minutes without one.
    let patience_s = ClientSettings::default().patience_s;
    let busy = |_| Some(ReadError::Status { place: told().0, path: told().1, status: 503 });
    for (seconds, fail) in
        [(patience_s / 2.0, &not_found as &dyn Fn(What) -> Option<ReadError>), (300.0, &no_answer), (300.0, &busy)]
    {
        visit.steps(seconds, fail);
        assert_eq!([0, 1, 2].map(|cell| visit.gave_up(cell)), [false; 3], "at {} s", visit.now_s);
    }
    // What comes meanwhile, as from a cache, makes nothing else count.
    for _ in 0..100 {
        visit.client.forget(0, One);
        visit.steps(1.0, |what| if what == (What::Packet { cell: 0, level: One }) { None } else { no_answer(what) });
        assert!(visit.client.has(0, One) && !visit.gave_up(1) && !visit.gave_up(2));
    }
    // It is there again, and says as before that it does not have it: the time before counts, that in between does not.
    visit.steps(patience_s / 2.0 - 5.0, not_found);
    assert!(!visit.gave_up(1) && visit.client.has(2, One));
    visit.steps(10.0, not_found);
    assert!(visit.gave_up(1), "nobody waits for what is not there");
    // Nor does it come because nobody is there once more.
    visit.steps(10.0, no_answer);
    assert!(visit.gave_up(1));
    visit.steps(5.0, |_| None);
    assert!(visit.client.has(1, One) && !visit.gave_up(1));
}
