use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;

use super::error::Reason;
use super::{Picture, SAVE_AS_PNG, blank, check_size};
use crate::raster::PictureLimits;

const FORMAT: &str = "JPEG";
/// Most scans of a progressive picture; encoders write about ten.
const MOST_SCANS: usize = 64;

pub(super) fn decode(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, Reason> {
    decode_as(bytes, ColorSpace::RGB, limits)
}

/// Decodes a strip or tile of a TIFF file, no larger than `most` (width, height). Plain RGB is not turned from luminance and
/// chrominance.
pub(super) fn decode_part(bytes: &[u8], most: [usize; 2], is_plain_rgb: bool, limits: &PictureLimits) -> Result<Picture, Reason> {
    let header = Header::read(bytes)?;
    if usize::from(header.width) > most[0] || usize::from(header.height) > most[1] {
        return Err(broken("it stands for a strip or tile of a TIFF, and is larger than that"));
    }
    decode_as(bytes, if is_plain_rgb { ColorSpace::YCbCr } else { ColorSpace::RGB }, limits)
}

/// `out` is RGB, or YCbCr for three channels as they are.
fn decode_as(bytes: &[u8], out: ColorSpace, limits: &PictureLimits) -> Result<Picture, Reason> {
    let header = Header::read(bytes)?;
    let (width, height) = (u64::from(header.width), u64::from(header.height));
    check_size(FORMAT, width, height, header.working_bytes(), limits)?;
    let data = &bytes[header.scan_at..];
    if header.least_bits() > 8 * data.len() as u64 {
        return Err(Reason::HeaderLies { format: FORMAT, width, height, bytes: data.len() as u64 });
    }
    // Within the data every FF is followed by 00 or a restart mark, so this is the end mark.
    if !data.windows(2).any(|pair| pair == [0xff, 0xd9]) {
        return Err(Reason::Cut { format: FORMAT, place: "without its end mark".to_owned() });
    }
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(limits.side_px as usize)
        .set_max_height(limits.side_px as usize)
        .jpeg_set_max_scans(MOST_SCANS)
        .jpeg_set_out_colorspace(out);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(reason)?;
    if decoder.input_colorspace() == Some(ColorSpace::RGB) {
        // It says itself that there is nothing to turn.
        decoder.set_options(options.jpeg_set_out_colorspace(ColorSpace::RGB));
    }
    let (width, height) = (usize::from(header.width), usize::from(header.height));
    let mut pixels = blank(width, height);
    // The decoder reads the same header; if it disagrees, the sizes of the buffers do.
    if decoder.dimensions() != Some((width, height)) || decoder.output_buffer_size() != Some(pixels.len()) {
        return Err(broken("it has two headers that differ"));
    }
    decoder.decode_into(&mut pixels).map_err(reason)?;
    Ok(Picture { width, height, pixels })
}

/// What stands before the first scan.
#[derive(Debug, Default)]
struct Header {
    width: u16,
    height: u16,
    /// Horizontal and vertical sampling of each component.
    sampling: Vec<[u64; 2]>,
    is_progressive: bool,
    /// Components of the first scan.
    in_first_scan: usize,
    /// Shortest codes met in the tables: of DC values, and of what ends a block; bits.
    shortest: [Option<u64>; 2],
    /// Where the first scan's own header begins.
    scan_at: usize,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Reason> {
        let mut header = Self::default();
        let cut = |at: usize| Reason::Cut { format: FORMAT, place: format!("at byte {at}, in its header") };
        let mut at = 2;
        loop {
            // Markers may be preceded by any number of FF.
            while bytes.get(at) == Some(&0xff) && bytes.get(at + 1) == Some(&0xff) {
                at += 1;
            }
            let &[0xff, marker] = bytes.get(at..at + 2).ok_or_else(|| cut(bytes.len()))? else {
                return Err(Reason::Broken { format: FORMAT, detail: format!("there is no segment at byte {at}") });
            };
            if marker == 0xd9 {
                return Err(broken("it ends before its picture begins"));
            }
            if matches!(marker, 0x01 | 0xd0..=0xd8) {
                at += 2;
                continue;
            }
            let length = bytes.get(at + 2..at + 4).map(|l| usize::from(l[0]) << 8 | usize::from(l[1]));
            let length = length.ok_or_else(|| cut(bytes.len()))?;
            let body = bytes.get(at + 4..at + 2 + length.max(2)).ok_or_else(|| cut(bytes.len()))?;
            match marker {
                0xc0..=0xc2 => header.frame(body, marker == 0xc2)?,
                0xc4 => header.tables(body),
                0xc3 | 0xc5..=0xc7 | 0xc9..=0xcf => {
                    let feature = "lossless, arithmetic or hierarchical JPEG".to_owned();
                    return Err(Reason::Unsupported { feature, fix: SAVE_AS_PNG });
                }
                0xda => {
                    header.in_first_scan = body.first().copied().map_or(0, usize::from);
                    header.scan_at = at;
                    break;
                }
                _ => {}
            }
            at += 2 + length.max(2);
        }
        if header.sampling.is_empty() {
            return Err(broken("its data come before its size"));
        }
        // Where tables stand between its scans, the decoder loses all but the first of them and says nothing.
        if !header.is_progressive && header.in_first_scan < header.sampling.len() {
            let feature = "a baseline JPEG that tells its colours one after another".to_owned();
            return Err(Reason::Unsupported { feature, fix: SAVE_AS_PNG });
        }
        Ok(header)
    }

    fn frame(&mut self, body: &[u8], is_progressive: bool) -> Result<(), Reason> {
        if !self.sampling.is_empty() {
            return Err(broken("it has two headers"));
        }
        let &[bits, h1, h0, w1, w0, components] = body.get(..6).ok_or_else(|| broken("its header is too short"))? else {
            return Err(broken("its header is too short"));
        };
        if bits != 8 {
            return Err(Reason::Unsupported { feature: format!("JPEG of {bits} bits a sample"), fix: SAVE_AS_PNG });
        }
        (self.width, self.height) = (u16::from_be_bytes([w1, w0]), u16::from_be_bytes([h1, h0]));
        self.is_progressive = is_progressive;
        if self.height == 0 {
            let feature = "a JPEG that tells its height only at its end".to_owned();
            return Err(Reason::Unsupported { feature, fix: SAVE_AS_PNG });
        }
        if !matches!(components, 1 | 3 | 4) {
            return Err(Reason::Unsupported { feature: format!("a JPEG of {components} components"), fix: SAVE_AS_PNG });
        }
        let parts = body.get(6..6 + 3 * usize::from(components)).ok_or_else(|| broken("its header is too short"))?;
        for part in parts.chunks_exact(3) {
            let sampling = [part[1] >> 4, part[1] & 15];
            if sampling.iter().any(|s| !(1..=4).contains(s)) {
                return Err(broken("a component is sampled in no lawful way"));
            }
            self.sampling.push(sampling.map(u64::from));
        }
        Ok(())
    }

    /// Notes the shortest codes of Huffman tables.
    fn tables(&mut self, mut body: &[u8]) {
        while let Some((head, rest)) = body.split_at_checked(17) {
            let count = head[1..].iter().map(|&n| usize::from(n)).sum::<usize>();
            let Some((symbols, after)) = rest.split_at_checked(count) else { return };
            let lengths = (1u64..).zip(&head[1..]).flat_map(|(bits, &n)| (0..n).map(move |_| bits));
            let is_ac = head[0] >> 4 != 0;
            // A block ends by the symbol 0, or is full after four runs at the least.
            let ends = |(bits, symbol): (u64, &u8)| if is_ac && *symbol != 0 { 4 * bits } else { bits };
            if let Some(least) = lengths.zip(symbols).map(ends).min() {
                let shortest = &mut self.shortest[usize::from(is_ac)];
                *shortest = Some(shortest.map_or(least, |s| s.min(least)));
            }
            body = after;
        }
    }

    /// Blocks of 8 × 8 samples, in all components.
    fn blocks(&self) -> u64 {
        let most = |axis: usize| self.sampling.iter().map(|s| s[axis]).max().unwrap_or(1);
        let along = |size: u16, s: u64, most: u64| (u64::from(size) * s).div_ceil(8 * most);
        let (h, v) = (most(0), most(1));
        self.sampling.iter().map(|s| along(self.width, s[0], h) * along(self.height, s[1], v)).sum()
    }

    /// Fewest bits that its blocks can be written in.
    fn least_bits(&self) -> u64 {
        // Later scans may bring tables of their own.
        let all_tables_known = !self.is_progressive && self.in_first_scan == self.sampling.len();
        let bits = match self.shortest {
            [Some(dc), Some(ac)] if all_tables_known => dc + ac,
            _ => 1,
        };
        self.blocks() * bits
    }

    /// What decoding takes beside the picture; bytes. Coefficients have two bytes and are kept where scans refine them.
    fn working_bytes(&self) -> u64 {
        let most: u64 = self.sampling.iter().map(|s| s[0] * s[1]).max().unwrap_or(1);
        let rows = u64::from(self.width).next_multiple_of(32) * 4 * 8 * 2 * 4 * 4;
        let is_kept = self.is_progressive || self.in_first_scan != self.sampling.len();
        // A column and a row of blocks more, where the sides are no multiples.
        let blocks = self.blocks() + most * 4 * (u64::from(self.width) + u64::from(self.height)) / 8 + 64;
        rows + (1 << 18) + if is_kept { blocks * 128 } else { 0 }
    }
}

fn broken(detail: &str) -> Reason {
    Reason::Broken { format: FORMAT, detail: detail.to_owned() }
}

fn reason(error: DecodeErrors) -> Reason {
    match error {
        DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_) => {
            Reason::Cut { format: FORMAT, place: "before all its pixels have come".to_owned() }
        }
        DecodeErrors::FormatStatic("Premature end of buffer") => {
            Reason::Cut { format: FORMAT, place: "before all its pixels have come".to_owned() }
        }
        DecodeErrors::Unsupported(what) => Reason::Unsupported { feature: format!("{what:?}"), fix: SAVE_AS_PNG },
        other => Reason::Broken { format: FORMAT, detail: other.to_string() },
    }
}
