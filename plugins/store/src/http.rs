use std::io::ErrorKind;
use std::time::Duration;

use ureq::config::Config;
use ureq::http::{Response, Uri};
use ureq::unversioned::resolver::{DefaultResolver, ResolvedSocketAddrs, Resolver};
use ureq::unversioned::transport::{ConnectProxyConnector, Connector, NextTimeout, RustlsConnector, TcpConnector};
use ureq::{Agent, Body, Error, Timeout};

use crate::pace::{Pace, Paced};
use crate::{Fresh, INDEX_NAME, ReadError, Reader, reader::check_path};

/// How long to wait for a server, in seconds. All of a file may take any time, as long as it goes on coming. A connection that closes
/// without an answer is followed by one more, which may take as long again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HttpSettings {
    /// For the connection to stand.
    pub connect_s: f64,
    /// For the answer to begin, and for it to go on.
    pub stall_s: f64,
    /// So much longer than that, as long as other files come from there: on a slow line an answer waits behind those before it.
    pub patience_s: f64,
    /// Slowest line that is waited for, bytes a second: what comes slower counts as if it did not come.
    pub least_bytes_s: f64,
}

impl Default for HttpSettings {
    fn default() -> Self {
        Self { connect_s: 3.0, stall_s: 2.5, patience_s: 7.5, least_bytes_s: 512.0 }
    }
}

/// Reads a city from any plain web server: `GET base/path`.
#[derive(Debug, Clone)]
pub struct HttpReader {
    agent: Agent,
    /// Without a slash at its end.
    base: String,
}

/// Nobody waits longer.
const A_DAY: Duration = Duration::from_secs(86_400);

/// Redirects that are followed: enough for http to https and a moved folder.
const REDIRECTS: u32 = 3;

impl HttpReader {
    /// A reader of the city at an address, such as `https://example.org/prague.city`. Nothing is asked of the server yet.
    ///
    /// # Errors
    /// [`ReadError::Place`] if that is no http(s) address, or it has a query.
    pub fn new(base: &str) -> Result<Self, ReadError> {
        Self::with_settings(base, HttpSettings::default())
    }

    /// A reader with other waiting times.
    ///
    /// # Errors
    /// As [`HttpReader::new`].
    pub fn with_settings(base: &str, settings: HttpSettings) -> Result<Self, ReadError> {
        let bad = |reason: String| ReadError::Place { place: base.to_owned(), reason };
        let uri: Uri = base.parse().map_err(|error| bad(format!("{error}")))?;
        if !matches!(uri.scheme_str(), Some("http" | "https")) || uri.host().is_none_or(str::is_empty) {
            return Err(bad("it is no http or https address".to_owned()));
        }
        if base.contains(['?', '#']) {
            return Err(bad("a city's address has no query or fragment".to_owned()));
        }
        let limit = |seconds: f64| Duration::try_from_secs_f64(seconds).ok();
        let mut config = Agent::config_builder()
            .timeout_resolve(limit(settings.connect_s))
            .timeout_connect(limit(settings.connect_s))
            .max_redirects(REDIRECTS)
            .http_status_as_error(false)
            .user_agent("veduta");
        if uri.host().is_some_and(is_loopback) {
            config = config.proxy(None);
        }
        let base = base.strip_suffix(INDEX_NAME).unwrap_or(base).trim_end_matches('/').to_owned();
        let seconds = |seconds: f64| limit(seconds).unwrap_or(A_DAY).min(A_DAY);
        let paced = Paced::new(Pace {
            stall: seconds(settings.stall_s),
            patience: seconds(settings.patience_s),
            least_bytes_s: settings.least_bytes_s,
        });
        let connector =
            ().chain(ConnectProxyConnector::default())
                .chain(TcpConnector::default())
                .chain(paced)
                .chain(RustlsConnector::default());
        Ok(Self { agent: Agent::with_parts(config.build(), connector, Hosts(DefaultResolver::default())), base })
    }

    /// The answer to `GET url`. A connection that closes without one says nothing of the file (mostly it was kept, and the
    /// server closed it meanwhile): it is asked once more over a new one.
    fn get(&self, url: &str, tag: Option<&str>) -> Result<Response<Body>, Error> {
        let request = || match tag {
            Some(tag) => self.agent.get(url).header("If-None-Match", tag),
            None => self.agent.get(url),
        };
        match request().call() {
            Err(Error::Io(error)) if is_hang_up(error.kind()) => request().config().max_idle_age(Duration::ZERO).build().call(),
            answer => answer,
        }
    }

    fn error(&self, path: &str, limit: u64, error: Error) -> ReadError {
        let (place, path) = (self.describe(), path.to_owned());
        match error {
            error if is_nobody(&error) => ReadError::NoAnswer { place, path, message: error.to_string() },
            Error::Timeout(Timeout::PerRead) => ReadError::Timeout { place, path, phase: "nothing came any more".to_owned() },
            Error::Timeout(phase) => ReadError::Timeout { place, path, phase: phase.to_string() },
            Error::BodyExceedsLimit(_) => ReadError::TooLarge { place, path, limit },
            Error::StatusCode(status) => ReadError::Status { place, path, status },
            error => ReadError::Failed { place, path, message: error.to_string() },
        }
    }
}

/// Whether an error is what a closed connection gives.
fn is_hang_up(kind: ErrorKind) -> bool {
    use ErrorKind::*;
    matches!(kind, UnexpectedEof | ConnectionReset | ConnectionAborted | BrokenPipe | NotConnected)
}

/// Finds hosts by their names. Where there is no network the system fails to, in ways that it does not name.
#[derive(Debug)]
struct Hosts<R>(R);

impl<R: Resolver> Resolver for Hosts<R> {
    fn resolve(&self, uri: &Uri, config: &Config, timeout: NextTimeout) -> Result<ResolvedSocketAddrs, Error> {
        self.0
            .resolve(uri, config, timeout)
            .map_err(|error| if matches!(error, Error::Io(_)) { Error::HostNotFound } else { error })
    }
}

/// Whether an error says that nobody is there: who hangs up in the middle is.
fn is_nobody(error: &Error) -> bool {
    use ErrorKind::{AddrNotAvailable, ConnectionRefused, HostUnreachable, NetworkDown, NetworkUnreachable};
    match error {
        Error::HostNotFound | Error::ConnectionFailed | Error::Timeout(Timeout::Resolve | Timeout::Connect) => true,
        Error::Io(error) => {
            matches!(error.kind(), ConnectionRefused | HostUnreachable | NetworkUnreachable | NetworkDown | AddrNotAvailable)
        }
        _ => false,
    }
}

/// Whether a host is this machine, for which no proxy is asked.
fn is_loopback(host: &str) -> bool {
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    bare.eq_ignore_ascii_case("localhost") || bare.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

impl Reader for HttpReader {
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        match self.read_if_changed(path, limit, None)? {
            Fresh::Changed { bytes, .. } => Ok(bytes),
            // Nothing was said to be known: there is no file in this answer.
            Fresh::Same => Err(ReadError::Status { place: self.describe(), path: path.to_owned(), status: 304 }),
        }
    }

    fn read_if_changed(&self, path: &str, limit: u64, tag: Option<&str>) -> Result<Fresh, ReadError> {
        check_path(path)?;
        let url = format!("{}/{path}", self.base);
        let mut response = self.get(&url, tag).map_err(|error| self.error(path, limit, error))?;
        match response.status().as_u16() {
            200 => {}
            304 => return Ok(Fresh::Same),
            404 | 410 => return Err(ReadError::NotFound { place: self.describe(), path: path.to_owned() }),
            status => return Err(ReadError::Status { place: self.describe(), path: path.to_owned(), status }),
        }
        if response.body().content_length().is_some_and(|length| length > limit) {
            return Err(ReadError::TooLarge { place: self.describe(), path: path.to_owned(), limit });
        }
        // One more than allowed, so that a body of exactly the limit is told from a longer one.
        let body = response.body_mut().with_config().limit(limit.saturating_add(1));
        let bytes = body.read_to_vec().map_err(|error| self.error(path, limit, error))?;
        if bytes.len() as u64 > limit {
            return Err(ReadError::TooLarge { place: self.describe(), path: path.to_owned(), limit });
        }
        let tag = response.headers().get("etag").and_then(|tag| tag.to_str().ok()).map(str::to_owned);
        Ok(Fresh::Changed { bytes, tag })
    }

    fn describe(&self) -> String {
        self.base.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the system does without a network.
    #[derive(Debug)]
    struct NoNetwork;

    impl Resolver for NoNetwork {
        fn resolve(&self, _: &Uri, _: &Config, _: NextTimeout) -> Result<ResolvedSocketAddrs, Error> {
            Err(Error::Io(std::io::Error::other("failed to lookup address information: Temporary failure in name resolution")))
        }
    }

    #[test]
    fn without_a_network_nobody_answers() {
        let agent = Agent::with_parts(Config::builder().proxy(None).build(), TcpConnector::default(), Hosts(NoNetwork));
        let error = agent.get("http://example.org/x.city").call().expect_err("no such host is found");
        let reader = HttpReader::new("http://example.org/x.city").expect("an address");
        assert!(reader.error("city.veduta", 9, error).is_outage());
    }

    #[test]
    fn addresses_lose_what_does_not_belong_to_the_folder() {
        for place in ["http://h/x.city", "http://h/x.city/", "http://h/x.city/city.veduta"] {
            assert_eq!(HttpReader::new(place).expect("an address").describe(), "http://h/x.city");
        }
        for place in ["http://", "ftp://h/x", "http://h/x?y", "http://h/x#y", "http:// h/", "h/x", ""] {
            assert!(matches!(HttpReader::new(place), Err(ReadError::Place { .. })), "{place}");
        }
    }
}
