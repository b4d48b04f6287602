//! A line to a web server that can be made worse: it passes on what is asked and answered, in HTTP/1.1 over sockets of its own, with a
//! fault that may change at any time; and a plain server of files to put behind it.
#![allow(dead_code, reason = "each test uses its own part")]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What is wrong with a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    None,
    /// So many of ten questions are never answered.
    Lost(u64),
    /// Every answer comes so much later.
    Late(Duration),
    /// Every answer ends in the middle, and the connection with it.
    Cut,
    /// Every answer is half of what was asked for, and says so.
    Short,
    /// A byte of every answer is another.
    WrongBytes,
    /// Every answer is this one.
    Status(u16),
    /// So many bytes come in a second. Answers that begin so end so.
    Drip(u64),
    /// Every connection is closed at once.
    Gone,
    /// Connections stand, and nothing that was asked while it lasts is ever answered.
    Hole,
    /// As on the road: a first byte after so long, and so many bytes a second for all connections together.
    Slow(Duration, u64),
}

/// A line.
#[derive(Clone)]
pub struct Line(Arc<State>);

struct State {
    own: SocketAddr,
    server: SocketAddr,
    fault: Mutex<Fault>,
    asked: AtomicU64,
    /// Bytes of bodies that were passed on.
    bytes: AtomicU64,
    /// How many answers had which status.
    answers: Mutex<BTreeMap<u16, u64>>,
    /// When a slow line has passed on all that was given to it.
    free: Mutex<Instant>,
}

struct Answer {
    status: u16,
    /// Lines of its head, without the first and without those that tell how it is sent.
    head: Vec<String>,
    body: Vec<u8>,
}

impl Line {
    /// A good line to a server.
    pub fn to(server: SocketAddr) -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
        let line = Self(Arc::new(State {
            own: listener.local_addr().expect("an address"),
            server,
            fault: Mutex::new(Fault::None),
            asked: AtomicU64::new(0),
            bytes: AtomicU64::new(0),
            answers: Mutex::default(),
            free: Mutex::new(Instant::now()),
        }));
        let state = Arc::clone(&line.0);
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let state = Arc::clone(&state);
                // Whoever hangs up ends it.
                std::thread::spawn(move || state.pass_on(stream).unwrap_or_default());
            }
        });
        line
    }

    /// Where the line begins.
    pub fn place(&self, path: &str) -> String {
        format!("http://{}{path}", self.0.own)
    }

    pub fn set(&self, fault: Fault) {
        *self.0.fault.lock().expect("no panic") = fault;
    }

    /// Bytes of bodies that were passed on, and answers by their status, since last asked.
    pub fn counted(&self) -> (u64, BTreeMap<u16, u64>) {
        (self.0.bytes.swap(0, Ordering::SeqCst), std::mem::take(&mut *self.0.answers.lock().expect("no panic")))
    }
}

impl State {
    fn fault(&self) -> Fault {
        *self.fault.lock().expect("no panic")
    }

    fn pass_on(&self, mut stream: TcpStream) -> std::io::Result<()> {
        stream.set_nodelay(true)?;
        match self.fault() {
            Fault::Gone => return Ok(()),
            Fault::Hole => return swallow(&stream),
            Fault::Slow(late, _) => std::thread::sleep(late),
            _ => {}
        }
        let mut lines = BufReader::new(stream.try_clone()?);
        loop {
            let head = head_of(&mut lines)?;
            let fault = self.fault();
            let n = self.asked.fetch_add(1, Ordering::SeqCst);
            match fault {
                Fault::Gone => return Ok(()),
                Fault::Hole => return swallow(&stream),
                Fault::Lost(of_ten) if n * 7 % 10 < of_ten => return swallow(&stream),
                Fault::Late(late) | Fault::Slow(late, _) => std::thread::sleep(late),
                _ => {}
            }
            let mut answer = self.ask(&head)?;
            let half = answer.body.len() / 2;
            match fault {
                Fault::Short => answer.body.truncate(half),
                Fault::WrongBytes if !answer.body.is_empty() => {
                    let at = n as usize * 131 % answer.body.len();
                    answer.body[at] ^= 1 << (n % 8);
                }
                Fault::Status(status) => (answer.status, answer.body) = (status, b"no".to_vec()),
                _ => {}
            }
            *self.answers.lock().expect("no panic").entry(answer.status).or_default() += 1;
            let length = if answer.status == 304 { String::new() } else { format!("Content-Length: {}\r\n", answer.body.len()) };
            let told: String = answer.head.iter().map(|line| format!("{line}\r\n")).collect();
            stream.write_all(format!("HTTP/1.1 {} x\r\n{told}{length}\r\n", answer.status).as_bytes())?;
            match fault {
                Fault::Cut => {
                    self.send(&mut stream, &answer.body[..half])?;
                    return Ok(());
                }
                Fault::Drip(bytes_s) => {
                    for byte in answer.body.chunks(1) {
                        std::thread::sleep(Duration::from_secs_f64(1.0 / bytes_s as f64));
                        self.send(&mut stream, byte)?;
                    }
                }
                Fault::Slow(_, bytes_s) => {
                    for part in answer.body.chunks(500) {
                        let until = {
                            let mut free = self.free.lock().expect("no panic");
                            *free = free.max(Instant::now()) + Duration::from_secs_f64(part.len() as f64 / bytes_s as f64);
                            *free
                        };
                        std::thread::sleep(until.saturating_duration_since(Instant::now()));
                        self.send(&mut stream, part)?;
                    }
                }
                _ => self.send(&mut stream, &answer.body)?,
            }
        }
    }

    fn send(&self, stream: &mut TcpStream, part: &[u8]) -> std::io::Result<()> {
        self.bytes.fetch_add(part.len() as u64, Ordering::SeqCst);
        stream.write_all(part)
    }

    /// What the server answers.
    fn ask(&self, head: &[String]) -> std::io::Result<Answer> {
        let first = head[0].replace("HTTP/1.1", "HTTP/1.0");
        let mut server = TcpStream::connect(self.server)?;
        let rest: String = head[1..].iter().filter(|line| !is_of_the_way(line)).map(|line| format!("{line}\r\n")).collect();
        server.write_all(format!("{first}\r\n{rest}\r\n").as_bytes())?;
        let mut answer = BufReader::new(server);
        let mut head = head_of(&mut answer)?;
        let status = head.remove(0).split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        head.retain(|line| !is_of_the_way(line));
        let mut body = Vec::new();
        answer.read_to_end(&mut body)?;
        Ok(Answer { status, head, body })
    }
}

/// Whether a line of a head tells how something is sent, not what.
fn is_of_the_way(line: &str) -> bool {
    let line = line.to_ascii_lowercase();
    ["connection:", "content-length:", "transfer-encoding:"].iter().any(|name| line.starts_with(name))
}

/// The lines of a head.
fn head_of(lines: &mut impl BufRead) -> std::io::Result<Vec<String>> {
    let mut head = Vec::new();
    loop {
        let mut line = String::new();
        if lines.read_line(&mut line)? == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        match line.trim_end() {
            "" if head.is_empty() => {}
            "" => return Ok(head),
            line => head.push(line.to_owned()),
        }
    }
}

/// Takes whatever comes and says nothing, until the other side hangs up.
fn swallow(mut stream: &TcpStream) -> std::io::Result<()> {
    std::io::copy(&mut stream, &mut std::io::sink()).map(|_| ())
}

/// Serves the files of a folder under their paths, with marks, until the test ends.
pub fn serve_files(files: BTreeMap<PathBuf, Vec<u8>>, folder: &std::path::Path) -> SocketAddr {
    let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let own = listener.local_addr().expect("an address");
    let by_path = |(path, bytes): (PathBuf, Vec<u8>)| {
        (format!("/{}", path.strip_prefix(folder).expect("below").to_string_lossy().replace('\\', "/")), bytes)
    };
    let files: Arc<BTreeMap<String, Vec<u8>>> = Arc::new(files.into_iter().map(by_path).collect());
    std::thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let files = Arc::clone(&files);
            std::thread::spawn(move || {
                let Ok(head) = head_of(&mut BufReader::new(&stream)) else { return };
                let path = head[0].split(' ').nth(1).unwrap_or_default();
                let tag = |bytes: &[u8]| format!("\"{}\"", veduta_store::BlobRef::of(bytes).name());
                let known =
                    head.iter().find_map(|line| line.to_ascii_lowercase().strip_prefix("if-none-match: ").map(str::to_owned));
                let (status, body, mark) = match files.get(path) {
                    Some(bytes) if known == Some(tag(bytes)) => (304, &b""[..], tag(bytes)),
                    Some(bytes) => (200, &bytes[..], tag(bytes)),
                    None => (404, &b"none"[..], String::new()),
                };
                let told = format!("HTTP/1.0 {status} x\r\nETag: {mark}\r\nContent-Length: {}\r\n\r\n", body.len());
                // Whoever hangs up early has what it wanted.
                let _ = stream.write_all(told.as_bytes()).and_then(|()| stream.write_all(body));
            });
        }
    });
    own
}
