use std::collections::{BTreeMap, VecDeque};

use bevy::prelude::*;
use veduta_city::{Id, draw::Draw};
use veduta_store::{ReadError, Request, RequestId, StoreError};

use crate::fetch::Fetched;

/// A line that is worse than the one there is, to see how a city streams over it: what has been read arrives later, at a limited pace, or
/// not at all. By the app's time, and the same for the same requests. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct Link {
    /// Seconds from a request to the beginning of its answer.
    pub latency_s: f64,
    /// Bytes a second, of all answers together; infinite if there is no limit.
    pub bytes_s: f64,
    /// Share of requests that are never answered: they fail after [`Link::LOST_S`].
    pub loss: f64,
    /// Nobody answers: every request fails as soon as that is known.
    pub is_down: bool,
}

impl Default for Link {
    fn default() -> Self {
        Self { latency_s: 0.0, bytes_s: f64::INFINITY, loss: 0.0, is_down: false }
    }
}

impl Link {
    /// Seconds after which an answer that does not come is given up, as over HTTP.
    pub const LOST_S: f64 = 4.0;

    /// Whether it changes nothing.
    fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

/// Answers that are on the line.
#[derive(Debug, Default)]
pub(crate) struct Line {
    /// What was asked for: bytes, when, and whether it is lost.
    asked: BTreeMap<RequestId, (u64, f64, Option<ReadError>)>,
    /// What has been read, one after another: when its first byte may arrive, and bytes that are still to come.
    coming: VecDeque<(f64, f64, Fetched)>,
    /// What will not arrive, by when that is told.
    lost: Vec<(f64, Fetched)>,
    last_s: f64,
}

impl Line {
    /// A request goes out.
    pub fn ask(&mut self, request: &Request, link: &Link, now_s: f64) {
        if link.is_plain() {
            return;
        }
        let (place, path) = ("a simulated line".to_owned(), request.path.clone());
        let is_lost = Draw::new(0, Id(request.id.0), "link").unit("loss") < link.loss;
        let fault = match link.is_down {
            true => Some(ReadError::NoAnswer { place, path, message: "the line is down".to_owned() }),
            false => is_lost.then(|| ReadError::Timeout { place, path, phase: "lost".to_owned() }),
        };
        self.asked.insert(request.id, (request.blob.map_or(0, |blob| blob.bytes.into()), now_s, fault));
    }

    /// A request was taken back.
    pub fn cancel(&mut self, request: RequestId) {
        self.asked.remove(&request);
    }

    /// What was read begins its way over the line.
    pub fn take(&mut self, (id, result): Fetched, link: &Link, now_s: f64) {
        match self.asked.remove(&id) {
            None => self.coming.push_back((now_s, 0.0, (id, result))),
            Some((_, asked_s, Some(fault))) => {
                let wait_s = if matches!(fault, ReadError::Timeout { .. }) { Link::LOST_S } else { link.latency_s };
                self.lost.push((asked_s + wait_s, (id, Err(StoreError::from(fault)))));
            }
            Some((bytes, asked_s, None)) => self.coming.push_back((asked_s + link.latency_s, bytes as f64, (id, result))),
        }
    }

    /// The answers that have arrived by now.
    pub fn arrived(&mut self, link: &Link, now_s: f64) -> Vec<Fetched> {
        let passed_s = (now_s - self.last_s).max(0.0);
        self.last_s = now_s;
        let mut bytes = if link.bytes_s.is_finite() { link.bytes_s.max(0.0) * passed_s } else { f64::INFINITY };
        let mut arrived: Vec<Fetched> = Vec::new();
        while let Some((from_s, left, _)) = self.coming.front_mut()
            && *from_s <= now_s
        {
            if *left > bytes {
                *left -= bytes;
                break;
            }
            bytes -= *left;
            arrived.extend(self.coming.pop_front().map(|(.., fetched)| fetched));
        }
        arrived.extend(self.lost.extract_if(.., |(due_s, _)| *due_s <= now_s).map(|(_, fetched)| fetched));
        arrived
    }
}

#[cfg(test)]
mod tests {
    use veduta_store::{Client, ClientSettings};

    use super::*;

    fn request() -> Request {
        Client::new(ClientSettings::default()).next_request(0.0).expect("the index")
    }

    fn fetched(request: &Request) -> Fetched {
        (request.id, Err(StoreError::NotACity))
    }

    /// When an answer to a request made at 10 s and read at once arrives, in tenths of a second, and whether it is the one.
    fn arrives(link: &Link) -> (u32, bool) {
        let (mut line, request) = (Line { last_s: 10.0, ..Line::default() }, request());
        line.ask(&request, link, 10.0);
        line.take(fetched(&request), link, 10.0);
        let come = (100..1000).find_map(|tenth| Some((tenth, line.arrived(link, f64::from(tenth) / 10.0 + 1e-9).pop()?)));
        let (tenth, (_, result)) = come.expect("it arrives");
        (tenth, result == Err(StoreError::NotACity))
    }

    #[test]
    fn a_line_is_as_late_as_it_is_told_to_be() {
        let plain = Link::default();
        assert_eq!(arrives(&plain), (100, true));
        assert_eq!(arrives(&Link { latency_s: 2.0, ..plain }), (120, true));
        assert_eq!(arrives(&Link { loss: 1.0, latency_s: 2.0, ..plain }), (140, false));
        assert_eq!(arrives(&Link { is_down: true, latency_s: 0.5, ..plain }), (105, false));
    }

    #[test]
    fn a_slow_line_is_slow_only_as_long_as_it_is() {
        let slow = Link { bytes_s: 100.0, ..Link::default() };
        let request = request();
        let mut line = Line::default();
        for _ in 0..3 {
            line.coming.push_back((0.0, 1_000.0, fetched(&request)));
        }
        let mut count = |link: &Link, now_s: f64| line.arrived(link, now_s).len();
        assert_eq!([5.0, 9.9, 10.1, 19.0].map(|s| count(&slow, s)), [0, 0, 1, 0], "a thousand bytes take ten seconds");
        let stopped = Link { bytes_s: 0.0, ..slow };
        assert_eq!(count(&stopped, 100.0), 0);
        assert_eq!(count(&slow, 101.1), 1, "it goes on where it stopped");
        assert_eq!(count(&Link::default(), 101.2), 1);
    }
}
