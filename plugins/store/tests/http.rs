//! The HTTP reader against a server on this machine that answers as it is told.

mod sample;

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};

use sample::{TempDir, city, files};
use veduta_city::Level::{One, Two};
use veduta_store::*;

/// How a server answers for a path.
#[derive(Clone)]
enum Answer {
    /// Exactly these bytes of HTTP, then the line is closed.
    Raw(Vec<u8>),
    /// These bytes, then the line is kept until more is asked on it, and closed without an answer.
    Kept(&'static [u8]),
    /// These bytes, then nothing.
    Stall(&'static [u8]),
}

#[derive(Clone)]
struct Server {
    answers: Arc<Mutex<BTreeMap<String, Answer>>>,
    heads: Arc<Mutex<Vec<String>>>,
    base: String,
}

fn ok(body: &[u8]) -> Answer {
    let mut bytes = format!("HTTP/1.1 200 OK\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", body.len()).into_bytes();
    bytes.extend(body);
    Answer::Raw(bytes)
}

impl Server {
    fn start() -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
        let base = format!("http://{}/prague.city", listener.local_addr().expect("an address"));
        let server = Self { answers: Arc::default(), heads: Arc::default(), base };
        let (answers, heads) = (server.answers.clone(), server.heads.clone());
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (answers, heads) = (answers.clone(), heads.clone());
                std::thread::spawn(move || serve(stream, &answers, &heads));
            }
        });
        server
    }

    /// What requests say beyond their first lines.
    fn heads(&self) -> Vec<String> {
        self.heads.lock().expect("no panic").clone()
    }

    fn put(&self, path: &str, answer: Answer) {
        self.answers.lock().expect("no panic").insert(format!("/prague.city/{path}"), answer);
    }

    /// A reader that waits for whatever comes, however busy the machine.
    fn reader(&self) -> HttpReader {
        self.reader_with(60.0)
    }

    /// A reader that waits so long for an answer, and for what it holds.
    fn reader_with(&self, seconds: f64) -> HttpReader {
        let settings = HttpSettings { connect_s: 60.0, stall_s: seconds, patience_s: 0.0, least_bytes_s: 1.0 };
        HttpReader::with_settings(&self.base, settings).expect("an address")
    }
}

fn serve(mut stream: TcpStream, answers: &Mutex<BTreeMap<String, Answer>>, heads: &Mutex<Vec<String>>) {
    let mut lines = BufReader::new(stream.try_clone().expect("a second handle")).lines().map_while(Result::ok);
    let Some(first) = lines.next() else { return };
    let rest: Vec<String> = lines.by_ref().take_while(|line| !line.is_empty()).collect();
    heads.lock().expect("no panic").push(rest.join("\n"));
    let path = first.split(' ').nth(1).unwrap_or_default().to_owned();
    let missing = Answer::Raw(b"HTTP/1.1 404 Not Found\r\nContent-Length: 4\r\nConnection: close\r\n\r\nnone".to_vec());
    let answer = answers.lock().expect("no panic").get(&path).cloned().unwrap_or(missing);
    match answer {
        Answer::Raw(bytes) => _ = stream.write_all(&bytes),
        Answer::Kept(bytes) => {
            let _ = stream.write_all(bytes);
            let _ = lines.next();
        }
        Answer::Stall(bytes) => {
            let _ = stream.write_all(bytes);
            // Until the reader hangs up.
            let _ = stream.read_to_end(&mut Vec::new());
        }
    }
}

#[test]
fn a_file_comes_whole() {
    let server = Server::start();
    server.put("a.bin", ok(b"hello"));
    let reader = server.reader();
    assert_eq!(reader.read("a.bin", 5), Ok(b"hello".to_vec()), "exactly the limit");
    assert!(matches!(reader.read("a.bin", 4), Err(ReadError::TooLarge { limit: 4, .. })));
    let chunked = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n1\r\n!\r\n0\r\n\r\n";
    server.put("chunked.bin", Answer::Raw(chunked.to_vec()));
    assert_eq!(reader.read("chunked.bin", 6), Ok(b"hello!".to_vec()));
    assert!(matches!(reader.read("chunked.bin", 5), Err(ReadError::TooLarge { .. })), "its length is not told beforehand");
}

#[test]
fn what_is_known_is_only_asked_whether_it_changed() {
    let server = Server::start();
    let marked = b"HTTP/1.1 200 OK\r\nETag: \"7\"\r\nContent-Length: 5\r\nConnection: close\r\n\r\nhello";
    server.put("a.bin", Answer::Raw(marked.to_vec()));
    let reader = server.reader();
    let new = Fresh::Changed { bytes: b"hello".to_vec(), tag: Some("\"7\"".to_owned()) };
    assert_eq!(reader.read_if_changed("a.bin", 5, None), Ok(new));
    server.put("a.bin", Answer::Raw(b"HTTP/1.1 304 Not Modified\r\nConnection: close\r\n\r\n".to_vec()));
    assert_eq!(reader.read_if_changed("a.bin", 5, Some("\"7\"")), Ok(Fresh::Same));
    assert!(matches!(reader.read("a.bin", 5), Err(ReadError::Status { status: 304, .. })), "nothing was known");
    assert!(server.heads().iter().any(|head| head.to_ascii_lowercase().contains("if-none-match: \"7\"")), "{:?}", server.heads());
}

/// A server may close a line that it kept just as it is asked again: that is no failure of the file.
#[test]
fn a_line_that_was_closed_meanwhile_is_opened_again() {
    let server = Server::start();
    server.put("a.bin", Answer::Kept(b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhello"));
    let reader = server.reader();
    for round in 0..8 {
        // Several lines are kept at once, and all of them are stale for the next round.
        let answers: Vec<_> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..6).map(|_| scope.spawn(|| reader.read("a.bin", 5))).collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        assert!(answers.iter().all(|answer| answer.as_deref() == Ok(b"hello")), "round {round}: {answers:?}");
    }
}

#[test]
fn failures_are_told_apart() {
    let server = Server::start();
    let reader = server.reader();
    assert!(matches!(reader.read("none.bin", 9), Err(ReadError::NotFound { .. })));
    server.put("gone.bin", Answer::Raw(b"HTTP/1.1 503 Busy\r\nContent-Length: 0\r\n\r\n".to_vec()));
    assert!(matches!(reader.read("gone.bin", 9), Err(ReadError::Status { status: 503, .. })));
    server.put("cut.bin", Answer::Raw(b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\nhello".to_vec()));
    let error = reader.read("cut.bin", 9).expect_err("cut short");
    assert!(matches!(error, ReadError::Failed { .. }), "{error:?}");
    server.put("noise.bin", Answer::Raw(b"\x00\x01\x02 what?\r\n\r\n".to_vec()));
    assert!(matches!(reader.read("noise.bin", 9), Err(ReadError::Failed { .. })));
    let hasty = server.reader_with(0.3);
    for begun in [&b""[..], b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\nhello"] {
        server.put("slow.bin", Answer::Stall(begun));
        let error = hasty.read("slow.bin", 9).expect_err("nothing more comes");
        assert!(matches!(error, ReadError::Timeout { .. }), "{error:?}");
    }
    server.put(
        "circle.bin",
        Answer::Raw(b"HTTP/1.1 302 Found\r\nLocation: /prague.city/circle.bin\r\nContent-Length: 0\r\n\r\n".to_vec()),
    );
    assert!(reader.read("circle.bin", 9).is_err(), "a redirect in a circle ends");
    assert!(matches!(reader.read("../x", 9), Err(ReadError::Forbidden { .. })), "not even asked");
    let closed = TcpListener::bind(("127.0.0.1", 0)).expect("a port").local_addr().expect("an address");
    let error = HttpReader::new(&format!("http://{closed}")).expect("an address").read("x", 9).expect_err("nobody listens");
    assert!(matches!(&error, ReadError::NoAnswer { .. }) && error.is_outage() && error.is_unreachable(), "{error:?}");
}

#[test]
fn a_city_is_walked_over_http_through_damage() {
    let temp = TempDir::new("http");
    city(3, 2).write(&temp.0).expect("written");
    let server = Server::start();
    for (path, bytes) in files(&temp.0) {
        let path = path.strip_prefix(&temp.0).expect("below").to_string_lossy().replace('\\', "/");
        server.put(&path, ok(&bytes));
    }
    let reader = server.reader();
    let mut client = Client::new(ClientSettings::default());
    let wanted: Vec<_> = [One, Two].into_iter().flat_map(|level| (0..3).map(move |cell| (cell, level))).collect();
    client.want(wanted.iter().copied());
    let (mut now_s, mut failures) = (0.0, Vec::new());
    for round in 0..40 {
        while let Some(request) = client.next_request(now_s) {
            if let (What::Packet { cell: 1, level: One }, Some(blob)) = (request.what, request.blob) {
                // First a wrong length, then wrong bytes, then what it should be.
                let good = std::fs::read(temp.join(&blob.path())).expect("a blob");
                let bad = [good[..good.len() - 1].to_vec(), vec![7; good.len()]];
                server.put(&request.path, ok(bad.get(failures.len()).unwrap_or(&good)));
            }
            for event in client.deliver(request.id, request.fetch(&reader), now_s) {
                if let ClientEvent::Failed { error, .. } = event {
                    failures.push((*error).clone());
                }
            }
        }
        now_s = f64::from(round) * 0.25;
    }
    let told: Vec<String> = failures.iter().map(ToString::to_string).collect();
    assert!(told.len() == 2 && told[0].contains("was cut short") && told[1].contains("checksum does not match"), "{told:?}");
    assert!(failures.iter().all(|error| !error.is_permanent()), "{failures:?}");
    assert!(wanted.iter().all(|&(cell, level)| client.has(cell, level)), "all is there in the end");
}
