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
    /// Nobody answers: every request fails at once.
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
    /// By when they are due.
    due: VecDeque<(f64, Fetched)>,
    busy_until_s: f64,
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
            true => Some(ReadError::Failed { place, path, message: "nobody answers".to_owned() }),
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
        let (due_s, result) = match self.asked.remove(&id) {
            None => (now_s, result),
            Some((_, asked_s, Some(fault))) => {
                let wait_s = if matches!(fault, ReadError::Timeout { .. }) { Link::LOST_S } else { link.latency_s };
                (asked_s + wait_s, Err(StoreError::from(fault)))
            }
            Some((bytes, asked_s, None)) => {
                let begins_s = (asked_s + link.latency_s).max(self.busy_until_s);
                self.busy_until_s = begins_s + bytes as f64 / link.bytes_s;
                (self.busy_until_s, result)
            }
        };
        let at = self.due.partition_point(|(other_s, _)| *other_s <= due_s);
        self.due.insert(at, (due_s, (id, result)));
    }

    /// The next answer that has arrived.
    pub fn next(&mut self, now_s: f64) -> Option<Fetched> {
        let is_here = self.due.front().is_some_and(|(due_s, _)| *due_s <= now_s);
        if is_here { self.due.pop_front().map(|(_, fetched)| fetched) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use veduta_store::{Client, ClientSettings};

    use super::*;

    fn request() -> Request {
        Client::new(ClientSettings::default()).next_request(0.0).expect("the index")
    }

    /// When an answer to a request made at 10 s and read at once arrives, in tenths of a second.
    fn arrives(line: &mut Line, link: &Link) -> (u32, bool) {
        let request = request();
        line.ask(&request, link, 10.0);
        line.take((request.id, Err(StoreError::NotACity)), link, 10.0);
        let tenth = (100..1000).find_map(|tenth| Some((tenth, line.next(f64::from(tenth) / 10.0 + 1e-9)?)));
        let (tenth, (_, result)) = tenth.expect("it arrives");
        (tenth, result == Err(StoreError::NotACity))
    }

    #[test]
    fn a_line_is_as_late_as_it_is_told_to_be() {
        let plain = Link::default();
        assert_eq!(arrives(&mut Line::default(), &plain), (100, true));
        assert_eq!(arrives(&mut Line::default(), &Link { latency_s: 2.0, ..plain }), (120, true));
        assert_eq!(arrives(&mut Line::default(), &Link { loss: 1.0, latency_s: 2.0, ..plain }), (140, false));
        assert_eq!(arrives(&mut Line::default(), &Link { is_down: true, latency_s: 0.5, ..plain }), (105, false));
        // What is on the line before is waited for.
        let mut line = Line { busy_until_s: 13.0, ..Line::default() };
        assert_eq!(arrives(&mut line, &Link { latency_s: 2.0, bytes_s: 1000.0, ..plain }), (130, true));
    }
}
