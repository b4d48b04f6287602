//! What is answered: by rule, and over sockets.

#[path = "../../../../store/tests/escapes/mod.rs"]
mod escapes;
#[path = "../../../../store/tests/line/mod.rs"]
mod line;
#[path = "../../../../store/tests/sample/mod.rs"]
mod sample;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;

use sample::{TempDir, city, files};
use veduta_city::Level::{One, Two};
use veduta_store::{CacheReader, Client, ClientSettings, HttpReader};

use super::*;

fn reply(known: Option<&str>, range: Option<&str>, if_range: Option<&str>) -> Reply {
    Reply::to(b"0123456789".to_vec(), true, known, range, if_range)
}

fn told<'a>(reply: &'a Reply, name: &str) -> Option<&'a str> {
    reply.headers.iter().find(|header| header.0 == name).map(|header| header.1.as_str())
}

#[test]
fn what_is_held_already_is_not_sent_again() {
    let first = reply(None, None, None);
    assert_eq!((first.code, first.body.as_slice()), (200, &b"0123456789"[..]));
    let tag = told(&first, "ETag").expect("a tag").to_owned();
    assert_eq!((tag.len(), &tag[..1], &tag[25..]), (26, "\"", "\""), "{tag}");
    for known in [tag.clone(), format!("W/{tag}"), format!("\"other\", {tag}"), "*".to_owned()] {
        let again = reply(Some(&known), Some("bytes=0-3"), None);
        assert_eq!((again.code, again.body.len(), told(&again, "ETag")), (304, 0, Some(tag.as_str())), "{known}");
    }
    assert_eq!(reply(Some("\"other\""), None, None).code, 200);
    let index = Reply::to(vec![1], false, None, None, None);
    assert_eq!(told(&index, "Cache-Control"), Some("no-cache"));
    assert_eq!(told(&first, "Cache-Control"), Some("public, max-age=31536000, immutable"));
}

#[test]
fn ranges_are_cut_out() {
    let cases = [
        ("bytes=0-3", Some("0123")),
        ("bytes=7-", Some("789")),
        ("bytes=8-99", Some("89")),
        ("bytes=-4", Some("6789")),
        ("bytes=-40", Some("0123456789")),
        ("bytes=9-9", Some("9")),
        ("bytes=10-", None),
        ("bytes=-0", None),
        ("bytes=99999999999999999999-", None),
    ];
    for (range, part) in cases {
        let reply = reply(None, Some(range), None);
        let expected = part.map_or((416, ""), |part| (206, part));
        assert_eq!((reply.code, core::str::from_utf8(&reply.body).expect("digits")), expected, "{range}");
    }
    assert_eq!(told(&reply(None, Some("bytes=2-5"), None), "Content-Range"), Some("bytes 2-5/10"));
    assert_eq!(told(&reply(None, Some("bytes=20-"), None), "Content-Range"), Some("bytes */10"));
    for odd in ["bytes=5-2", "bytes=0-1,4-5", "lines=1-2", "bytes=", "bytes=-", "bytes=a-b", "bytes=+1-2", "1-2"] {
        assert_eq!(reply(None, Some(odd), None).code, 200, "{odd}");
    }
}

#[test]
fn a_range_of_what_has_changed_is_the_whole() {
    let tag = told(&reply(None, None, None), "ETag").expect("a tag").to_owned();
    assert_eq!(reply(None, Some("bytes=0-3"), Some(&tag)).code, 206);
    assert_eq!(reply(None, Some("bytes=0-3"), Some("\"other\"")).code, 200);
    assert_eq!(reply(None, Some("bytes=0-3"), Some(&format!("W/{tag}"))).code, 200, "weak tags do not tell bytes");
}

#[test]
fn an_empty_file_has_no_range() {
    assert_eq!(Reply::to(Vec::new(), true, None, Some("bytes=0-"), None).code, 416);
    assert_eq!(Reply::to(Vec::new(), true, None, None, None).code, 200);
}

/// Serves a city while something is done with its address.
fn while_served(dir: &Path, what: impl FnOnce(SocketAddr)) {
    let (reader, server) = open(dir, 0).expect("a city");
    let address = server.server_addr().to_ip().expect("a port");
    std::thread::scope(|scope| {
        scope.spawn(|| answer_all(&reader, &server));
        // Whatever is found wrong, the server ends.
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| what(address)));
        (0..THREADS).for_each(|_| server.unblock());
        if let Err(panic) = done {
            std::panic::resume_unwind(panic);
        }
    });
}

/// A connection on which nothing is made of a path before it is sent.
struct Raw {
    server: SocketAddr,
    line: Option<BufReader<TcpStream>>,
}

impl Raw {
    /// Status and body of the answer; `None` if the server hangs up without one.
    fn get(&mut self, target: &str) -> Option<(u16, Vec<u8>)> {
        // A connection that stands already may have been closed after the last answer.
        let is_old = self.line.is_some();
        let answer = self.try_get(target).or_else(|| if is_old { self.try_get(target) } else { None });
        answer.inspect(|(status, _)| assert!([200, 400, 404, 505].contains(status), "{target:?}: {status}"))
    }

    fn try_get(&mut self, target: &str) -> Option<(u16, Vec<u8>)> {
        let mut line = self.line.take().unwrap_or_else(|| {
            let stream = TcpStream::connect(self.server).expect("it listens");
            stream.set_nodelay(true).expect("a socket");
            BufReader::new(stream)
        });
        line.get_mut().write_all(format!("GET {target} HTTP/1.1\r\nHost: h\r\n\r\n").as_bytes()).ok()?;
        let (mut status, mut length) = (None, 0);
        loop {
            let mut head = String::new();
            if line.read_line(&mut head).ok()? == 0 {
                return None;
            }
            let head = head.trim_end().to_ascii_lowercase();
            match (status, head.strip_prefix("content-length: ")) {
                (None, _) => status = head.split(' ').nth(1).and_then(|status| status.parse().ok()),
                (Some(_), Some(bytes)) => length = bytes.parse().expect("a length"),
                (Some(_), None) if head.is_empty() => break,
                (Some(_), None) => assert!(!head.starts_with("transfer-encoding"), "its length is told"),
            }
        }
        let mut body = vec![0; length];
        line.read_exact(&mut body).ok()?;
        self.line = Some(line);
        Some((status?, body))
    }
}

#[test]
fn a_hundred_thousand_requests_lead_out_of_no_served_city() {
    const SECRET: &str = "nobody is to read this";
    let temp = TempDir::new("serve-escape");
    let dir = temp.join("x.city");
    city(1, 1).write(&dir).expect("written");
    let inside: Vec<Vec<u8>> = files(&dir).into_values().collect();
    for name in ["secret.txt", "city.veduta", "etc/passwd", "windows/win.ini", "proc/self/environ"] {
        let place = temp.join(name);
        std::fs::create_dir_all(place.parent().expect("within")).expect("room");
        std::fs::write(place, SECRET).expect("room");
    }
    #[cfg(unix)]
    for (name, to) in [("etc", "../etc"), ("notes", ".."), ("secret.txt", "../secret.txt"), ("blobs/ab", "../..")] {
        let _ = std::fs::remove_dir_all(dir.join(name));
        std::os::unix::fs::symlink(to, dir.join(name)).expect("a link");
    }
    let encoded = |path: &str, is_left: fn(u8) -> bool| -> String {
        path.bytes().map(|b| if is_left(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
    };
    let corpus = escapes::corpus();
    while_served(&dir, |server| {
        let (asked, found) = std::thread::scope(|scope| {
            let ask = |paths: &[String]| {
                let mut raw = Raw { server, line: None };
                let (mut asked, mut found) = (0, 0);
                for path in paths {
                    let targets = [
                        path.clone(),
                        format!("/{path}"),
                        format!("http://h/{path}"),
                        format!("/{}", encoded(path, |b| b.is_ascii_alphanumeric() || b"._-/~".contains(&b))),
                        format!("/{}", encoded(path, |_| false)),
                    ];
                    for target in targets {
                        asked += 1;
                        let Some((status, body)) = raw.get(&target) else { continue };
                        assert!(!String::from_utf8_lossy(&body).contains(SECRET), "{target:?}");
                        assert!(status != 200 || inside.contains(&body), "{target:?}");
                        found += usize::from(status == 200);
                    }
                }
                (asked, found)
            };
            let parts: Vec<_> = corpus.chunks(corpus.len().div_ceil(4)).map(|part| scope.spawn(move || ask(part))).collect();
            let told = parts.into_iter().map(|part| part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            told.fold((0, 0), |(asked, found), part| (asked + part.0, found + part.1))
        });
        assert!(asked > 100_000 && found > 0, "{asked} were asked, {found} of them found what is within");
    });
}

#[test]
fn a_second_visit_to_a_served_city_costs_no_byte_of_content() {
    let temp = TempDir::new("serve-again");
    let dir = temp.join("x.city");
    let sample = city(6, 3);
    let mut writer = veduta_store::CityWriter::new(&dir, &sample.plan).expect("begun");
    writer.cells(&sample.plan, &sample.cells, &|cell| sample.parts(cell)).expect("written");
    writer.file("t.guide.ron", "It is said that ".repeat(90).as_bytes()).expect("written");
    writer.finish(sample.cells.clone()).expect("written");
    let stored: u64 = files(&dir).values().map(|bytes| bytes.len() as u64).sum();
    while_served(&dir, |server| {
        let line = line::Line::to(server);
        let visit = || {
            let http = HttpReader::new(&line.place("")).expect("an address");
            let reader = CacheReader::new(Arc::new(http), temp.join("cache"), 1 << 30);
            let mut client = Client::new(ClientSettings::default());
            client.want([One, Two].into_iter().flat_map(|level| (0..6).map(move |cell| (cell, level))));
            client.want_overviews([0]);
            client.want_files([0]);
            let mut arrived = 0;
            while let Some(request) = client.next_request(0.0) {
                let answer = request.fetch(&reader);
                assert!(answer.is_ok(), "{}: {answer:?}", request.what);
                client.deliver(request.id, answer, 0.0);
                arrived += 1;
            }
            (arrived, line.counted())
        };
        let (arrived, counted) = visit();
        assert_eq!((arrived, counted), (4 + 2 * 6 + 1, (stored, [(200, 17)].into())), "each once");
        assert_eq!(visit(), (17, (0, [(304, 1)].into())), "only whether the index has changed is asked");
    });
}
