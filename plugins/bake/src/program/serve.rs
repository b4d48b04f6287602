use std::path::Path;

use anstream::{eprintln, println};
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};
use veduta_store::{BlobRef, DirReader, INDEX_NAME, ReadError, Reader};

use super::Failure;

/// Largest file that is served, bytes.
const LARGEST: u64 = 256 << 20;

/// Threads that answer.
const THREADS: usize = 4;

/// Serves a city on the loopback address until it is stopped.
pub(crate) fn serve(city: &Path, port: u16) -> Result<(), Failure> {
    let (reader, server) = open(city, port)?;
    println!("http://{} serves {}", server.server_addr(), city.display());
    answer_all(&reader, &server);
    Ok(())
}

/// A city that can be read, and a port of the loopback address; 0 for any.
fn open(city: &Path, port: u16) -> Result<(DirReader, Server), Failure> {
    let reader = DirReader::new(city)?;
    reader.read(INDEX_NAME, LARGEST)?;
    let server = Server::http(("127.0.0.1", port)).map_err(|e| format!("port {port}: {e}"))?;
    Ok((reader, server))
}

/// Answers until every thread is unblocked.
fn answer_all(reader: &DirReader, server: &Server) {
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                while let Ok(request) = server.recv() {
                    answer(reader, request);
                }
            });
        }
    });
}

fn answer(reader: &DirReader, request: Request) {
    let path = request.url().split('?').next().unwrap_or("").trim_start_matches('/').to_owned();
    if !matches!(request.method(), Method::Get | Method::Head) {
        return finish(request.respond(Response::empty(405).with_header(header("Allow", "GET, HEAD"))));
    }
    let asked = |name: &'static str| request.headers().iter().find(|h| h.field.equiv(name)).map(|h| h.value.as_str().to_owned());
    let (known, range, if_range) = (asked("If-None-Match"), asked("Range"), asked("If-Range"));
    let reply = match reader.read(&path, LARGEST) {
        Ok(bytes) => Reply::to(bytes, path.starts_with("blobs/"), known.as_deref(), range.as_deref(), if_range.as_deref()),
        Err(error) => {
            let code = if matches!(error, ReadError::NotFound { .. }) { 404 } else { 400 };
            return finish(request.respond(Response::from_string(error.to_string()).with_status_code(code)));
        }
    };
    let mut response = Response::from_data(reply.body).with_status_code(StatusCode(reply.code));
    for (name, value) in reply.headers {
        response.add_header(header(name, &value));
    }
    finish(request.respond(response));
}

/// A header of names and values of our own.
fn header(name: &'static str, value: &str) -> Header {
    // They are ASCII without line breaks, and so always allowed.
    Header::from_bytes(name, value).unwrap_or_else(|()| unreachable!("{name}: {value}"))
}

/// What is answered to who asks for a file that is there.
#[derive(Debug, PartialEq, Eq)]
struct Reply {
    code: u16,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Reply {
    /// The whole of it, the range asked for, or that what is known of it still holds (RFC 9110, sections 13 and 14). Ranges that are not
    /// understood, or several at once, are answered with the whole.
    fn to(bytes: Vec<u8>, is_blob: bool, known: Option<&str>, range: Option<&str>, if_range: Option<&str>) -> Self {
        let tag = format!("\"{}\"", BlobRef::of(&bytes).name());
        // Blobs are named by their content and never change; the index must be asked for anew.
        let cache = if is_blob { "public, max-age=31536000, immutable" } else { "no-cache" };
        let mut headers = vec![
            ("Cache-Control", cache.to_owned()),
            ("ETag", tag.clone()),
            ("Accept-Ranges", "bytes".to_owned()),
            ("Access-Control-Allow-Origin", "*".to_owned()),
            ("Access-Control-Expose-Headers", "Content-Range, ETag".to_owned()),
        ];
        if known.is_some_and(|known| known.trim() == "*" || known.split(',').any(|one| one.trim().trim_start_matches("W/") == tag))
        {
            return Self { code: 304, headers, body: Vec::new() };
        }
        headers.push(("Content-Type", "application/octet-stream".to_owned()));
        let size = bytes.len() as u64;
        match range.filter(|_| if_range.is_none_or(|held| held.trim() == tag)).and_then(|range| asked_range(range, size)) {
            None => Self { code: 200, headers, body: bytes },
            Some(None) => {
                headers.push(("Content-Range", format!("bytes */{size}")));
                Self { code: 416, headers, body: Vec::new() }
            }
            Some(Some((first, last))) => {
                headers.push(("Content-Range", format!("bytes {first}-{last}/{size}")));
                Self { code: 206, headers, body: bytes[first as usize..=last as usize].to_vec() }
            }
        }
    }
}

/// First and last byte of the one range that is asked for; `Some(None)` if none of its bytes is there, `None` if it is not understood.
fn asked_range(range: &str, size: u64) -> Option<Option<(u64, u64)>> {
    let (first, last) = range.trim().strip_prefix("bytes=")?.split_once('-')?;
    let number = |digits: &str| match digits.bytes().all(|b| b.is_ascii_digit()) {
        true => Some(digits.parse().unwrap_or(u64::MAX)),
        false => None,
    };
    let (first, last) = match (first, last) {
        ("", "") => return None,
        ("", most) => match number(most)? {
            0 => return Some(None),
            most => (size.saturating_sub(most), u64::MAX),
        },
        (first, "") => (number(first)?, u64::MAX),
        (first, last) => (number(first)?, number(last)?),
    };
    if first > last {
        return None;
    }
    Some((first < size).then(|| (first, last.min(size - 1))))
}

/// A visitor who hangs up early is no reason to stop.
fn finish(sent: std::io::Result<()>) {
    if let Err(error) = sent {
        eprintln!("{error}");
    }
}

#[cfg(test)]
mod tests;
