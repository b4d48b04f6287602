use std::path::Path;

use anstream::{eprintln, println};
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};
use veduta_store::{BlobRef, DirReader, INDEX_NAME, ReadError, Reader};

use super::Failure;

/// Largest file that is served, bytes.
const LARGEST: u64 = 256 << 20;

/// Serves a city on the loopback address until it is stopped.
pub(crate) fn serve(city: &Path, port: u16) -> Result<(), Failure> {
    let reader = DirReader::new(city)?;
    reader.read(INDEX_NAME, LARGEST)?;
    let server = Server::http(("127.0.0.1", port)).map_err(|e| format!("port {port}: {e}"))?;
    println!("http://{} serves {}", server.server_addr(), city.display());
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                while let Ok(request) = server.recv() {
                    answer(&reader, request);
                }
            });
        }
    });
    Ok(())
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
mod tests {
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
}
