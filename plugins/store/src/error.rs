use std::path::PathBuf;

use veduta_city::Level;

use crate::{FORMAT_VERSION, INDEX_NAME};

/// Why something could not be read from where a city lies. Every message names the place and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Nothing is there.
    #[error("`{path}` is missing in {place}; if the city was baked again while it was walked, open it anew")]
    NotFound {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
    },
    /// The path leads, or might lead, out of the city.
    #[error("`{path}` is no path within a city: {reason}")]
    Forbidden {
        /// The path as given.
        path: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// There is more than was allowed for.
    #[error("`{path}` in {place} is longer than the {limit} bytes expected of it")]
    TooLarge {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
        /// Bytes allowed.
        limit: u64,
    },
    /// The server answered with something other than the file.
    #[error("{place} answered {status} for `{path}`")]
    Status {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
        /// HTTP status.
        status: u16,
    },
    /// The server took too long.
    #[error("{place} took too long to answer for `{path}` ({phase})")]
    Timeout {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
        /// What was waited for.
        phase: String,
    },
    /// Nobody is there to answer: no network, no such host, no server.
    #[error("{place} does not answer ({message}); `{path}` was asked for")]
    NoAnswer {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
        /// What the system said.
        message: String,
    },
    /// The disk or the line failed.
    #[error("`{path}` in {place} cannot be read: {message}")]
    Failed {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
        /// What the system said.
        message: String,
    },
    /// The directory exists, but no city is in it.
    #[error("`{}` holds no city (no {INDEX_NAME} in it): name the directory that `veduta-bake bake MAP -o DIR` wrote", .0.display())]
    NoIndex(PathBuf),
    /// There is no such directory.
    #[error("`{}` does not exist: name the directory that `veduta-bake bake MAP -o DIR` wrote, or an http(s) address", .0.display())]
    NoDirectory(PathBuf),
    /// The place is written in a way that no reader understands.
    #[error("`{place}` is no place to read a city from ({reason}): write a directory, http://… or https://…")]
    Place {
        /// The place as given.
        place: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl ReadError {
    /// Whether nobody answered, or said only that it cannot answer now: what was read earlier may still be what lies there.
    #[must_use]
    pub const fn is_unreachable(&self) -> bool {
        let is_line = matches!(self, Self::Timeout { .. } | Self::NoAnswer { .. } | Self::Failed { .. });
        is_line || matches!(self, Self::Status { status: 500..=599 | 429, .. })
    }

    /// Whether nobody is there who could tell of the file, or they say that they cannot just now, whatever is asked for: it says nothing
    /// of this file.
    #[must_use]
    pub const fn is_outage(&self) -> bool {
        matches!(self, Self::NoAnswer { .. } | Self::Status { status: 502..=504 | 429, .. })
    }
}

/// Why a city could not be written, read or understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The bytes did not arrive.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file does not begin as a city's index does.
    #[error("this is no city: it does not begin with Veduta's mark (is the address that of a web page?)")]
    NotACity,
    /// The city was baked by a newer program.
    #[error("the city has format {found}, this program reads format {FORMAT_VERSION}: update the program")]
    Newer {
        /// The city's format.
        found: u32,
    },
    /// The city was baked by a program too old to be understood.
    #[error("the city has format {found}, this program reads format {FORMAT_VERSION}: bake the city again")]
    Older {
        /// The city's format.
        found: u32,
    },
    /// There are fewer or more bytes than there should be.
    #[error("{what} has {found} bytes instead of {expected}: it was cut short or replaced")]
    Length {
        /// What was read.
        what: &'static str,
        /// Bytes that it should have.
        expected: u64,
        /// Bytes that it has.
        found: u64,
    },
    /// The bytes are not those that were written.
    #[error("{what} is damaged: its checksum does not match")]
    Checksum {
        /// What was read.
        what: &'static str,
    },
    /// It is something else.
    #[error("expected {expected}, found {found}")]
    Kind {
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// No packets of this level are defined in this format.
    #[error("{0} has no packets in format {FORMAT_VERSION}")]
    NoSuchLevel(Level),
    /// It would take more memory than anything of its kind may.
    #[error("{what} claims {claimed} bytes, more than the {cap} that anything of its kind may have")]
    TooLarge {
        /// What was read.
        what: &'static str,
        /// Bytes claimed.
        claimed: u64,
        /// Bytes allowed.
        cap: u64,
    },
    /// The bytes are sound but say nothing that this program understands.
    #[error("{what} cannot be decoded: {reason}")]
    Malformed {
        /// What was read.
        what: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// It can be decoded but contradicts itself.
    #[error("{what} is not valid: {reason}")]
    Invalid {
        /// What was read or is to be written.
        what: &'static str,
        /// What is wrong, and where.
        reason: String,
    },
    /// A file of a city was read and is not what it should be.
    #[error("`{path}` in {place}: {error}{}", mend(error))]
    File {
        /// The city.
        place: String,
        /// Path within it.
        path: String,
        /// What is wrong with it.
        error: Box<Self>,
    },
    /// The directory to write to holds something else.
    #[error("`{}` exists and is not a city: name an empty or new directory, or remove what is in it", .0.display())]
    Occupied(PathBuf),
    /// The disk failed while writing.
    #[error("cannot {doing} `{}`: {message}", path.display())]
    Write {
        /// What was being done.
        doing: &'static str,
        /// To what.
        path: PathBuf,
        /// What the system said.
        message: String,
    },
}

impl StoreError {
    /// Whether trying again cannot help, as long as the same city lies there: the bytes are those that were written, and
    /// they are wrong. What did not arrive, or arrived damaged, may arrive next time.
    #[must_use]
    pub const fn is_permanent(&self) -> bool {
        match self {
            Self::Read(_) | Self::Length { .. } | Self::Checksum { .. } => false,
            Self::File { error, .. } => error.is_permanent(),
            _ => true,
        }
    }

    /// The error with the file in which it was found, and with what to do; one that names its place already stays as it is.
    #[must_use]
    pub fn in_file(self, place: String, path: &str) -> Self {
        match self {
            Self::Read(_) | Self::File { .. } | Self::Occupied(_) | Self::Write { .. } => self,
            error => Self::File { place, path: path.to_owned(), error: Box::new(error) },
        }
    }
}

/// What to do about what was found in a file, where the error does not say so itself.
const fn mend(error: &StoreError) -> &'static str {
    match error {
        StoreError::Length { .. }
        | StoreError::Checksum { .. }
        | StoreError::Kind { .. }
        | StoreError::NoSuchLevel(_)
        | StoreError::TooLarge { .. }
        | StoreError::Malformed { .. }
        | StoreError::Invalid { .. } => "; bake the city again, or copy it whole",
        _ => "",
    }
}
