/// Why a picture could not be read. Every message names the file and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Not a picture at all, as far as its first bytes tell.
    #[error("{name} is neither PNG, JPEG, TIFF nor WebP: save the map as PNG")]
    NotPicture {
        /// The file.
        name: String,
    },
    /// The file ends before its format does.
    #[error("{name} is cut off: the {format} ends {place}; download or copy it again")]
    Cut {
        /// The file.
        name: String,
        /// Format as people call it.
        format: &'static str,
        /// Where it ends.
        place: String,
    },
    /// The file breaks the rules of its format.
    #[error("{name} is broken {format}: {detail}; download it again, or open and save it in a paint program")]
    Broken {
        /// The file.
        name: String,
        /// Format as people call it.
        format: &'static str,
        /// What is wrong.
        detail: String,
    },
    /// Well-formed, but of a kind that is not read here.
    #[error("{name} uses {feature}, which is not read here: {fix}")]
    Unsupported {
        /// The file.
        name: String,
        /// What it uses.
        feature: String,
        /// What to do.
        fix: &'static str,
    },
    /// More pixels a side than allowed.
    #[error("{name} is {width} × {height} pixels, and no side may exceed {limit}: scale it down or cut it into sheets")]
    TooLarge {
        /// The file.
        name: String,
        /// Columns, as its header says.
        width: u64,
        /// Rows, as its header says.
        height: u64,
        /// Most of either.
        limit: u32,
    },
    /// Decoding it would take more memory than allowed.
    #[error(
        "{name}, {width} × {height} pixels, takes {} MiB to decode and {} are allowed: allow more, scale it down, or save it as \
         PNG of 8 bits without transparency",
        needed.div_ceil(1 << 20),
        limit >> 20
    )]
    TooMuchMemory {
        /// The file.
        name: String,
        /// Columns, as its header says.
        width: u64,
        /// Rows, as its header says.
        height: u64,
        /// Bytes that decoding takes.
        needed: u64,
        /// Bytes that are allowed.
        limit: u64,
    },
    /// Its header promises more pixels than its data can hold, however well packed.
    #[error("{name} lies about its size: {width} × {height} pixels cannot come out of {bytes} bytes of {format}; get it again")]
    HeaderLies {
        /// The file.
        name: String,
        /// Format as people call it.
        format: &'static str,
        /// Columns, as its header says.
        width: u64,
        /// Rows, as its header says.
        height: u64,
        /// Bytes of picture data that are there.
        bytes: u64,
    },
}

/// A [`PictureError`] before the file's name is known.
#[derive(Debug)]
pub(super) enum Reason {
    NotPicture,
    Cut { format: &'static str, place: String },
    Broken { format: &'static str, detail: String },
    Unsupported { feature: String, fix: &'static str },
    TooLarge { width: u64, height: u64, limit: u32 },
    TooMuchMemory { width: u64, height: u64, needed: u64, limit: u64 },
    HeaderLies { format: &'static str, width: u64, height: u64, bytes: u64 },
}

impl Reason {
    pub(super) fn named(self, name: &str) -> PictureError {
        let name = name.to_owned();
        match self {
            Self::NotPicture => PictureError::NotPicture { name },
            Self::Cut { format, place } => PictureError::Cut { name, format, place },
            Self::Broken { format, detail } => PictureError::Broken { name, format, detail },
            Self::Unsupported { feature, fix } => PictureError::Unsupported { name, feature, fix },
            Self::TooLarge { width, height, limit } => PictureError::TooLarge { name, width, height, limit },
            Self::TooMuchMemory { width, height, needed, limit } => {
                PictureError::TooMuchMemory { name, width, height, needed, limit }
            }
            Self::HeaderLies { format, width, height, bytes } => PictureError::HeaderLies { name, format, width, height, bytes },
        }
    }
}
