//! Picture files made by program, whole and broken.

pub mod corpus;

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Bytes packed as PNG and TIFF do.
pub fn zlib(raw: &[u8]) -> Vec<u8> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::best());
    packed.write_all(raw).expect("to memory");
    packed.finish().expect("to memory")
}

/// So many zeros, packed, without ever holding them.
pub fn zlib_zeros(count: usize) -> Vec<u8> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::best());
    let block = vec![0; 1 << 16];
    for _ in 0..count / block.len() {
        packed.write_all(&block).expect("to memory");
    }
    packed.write_all(&block[..count % block.len()]).expect("to memory");
    packed.finish().expect("to memory")
}

/// A chunk of a PNG, with its checksum.
pub fn chunk(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let mut sum = flate2::Crc::new();
    sum.update(kind);
    sum.update(body);
    let length = u32::try_from(body.len()).expect("small");
    [&length.to_be_bytes(), &kind[..], body, &sum.sum().to_be_bytes()].concat()
}

/// A PNG's header chunk: columns, rows, bits, colour type, interlacing.
pub fn ihdr(width: u32, height: u32, bits: u8, colours: u8, interlace: u8) -> Vec<u8> {
    chunk(b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes(), &[bits, colours, 0, 0, interlace]].concat())
}

/// A PNG of these chunks, and an end mark.
pub fn png(chunks: &[Vec<u8>]) -> Vec<u8> {
    [&b"\x89PNG\r\n\x1a\n"[..], &chunks.concat(), &chunk(b"IEND", &[])].concat()
}

/// Rows of a PNG without filters.
pub fn unfiltered(rows: &[u8], row_bytes: usize) -> Vec<u8> {
    rows.chunks(row_bytes).flat_map(|row| [&[0], row].concat()).collect()
}

/// Rows of grey of 8 bits as PNG.
pub fn grey_png(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    png(&[ihdr(width, height, 8, 0, 0), chunk(b"IDAT", &zlib(&unfiltered(pixels, width as usize)))])
}

/// A grey baseline JPEG of even blocks of 8 × 8: `shade` says each block's, from -100 to 100 about the middle grey.
pub fn grey_jpeg(width: u16, height: u16, shade: &dyn Fn(u16, u16) -> i32) -> Vec<u8> {
    let mut bits = Bits::default();
    let mut last = 0;
    for row in 0..height.div_ceil(8) {
        for column in 0..width.div_ceil(8) {
            let value = shade(column, row);
            let step = value - last;
            last = value;
            let size = 32 - step.unsigned_abs().leading_zeros();
            // Sizes 0 to 11 have codes of four bits, in order; the end of a block has one bit.
            bits.push(size, 4);
            bits.push(if step < 0 { (step + (1 << size) - 1) as u32 } else { step as u32 }, size);
            bits.push(0, 1);
        }
    }
    jpeg(&jpeg_head(0xc0, 8, width, height, &[0x11]), &bits.finish())
}

/// What stands before a scan: tables, and a frame header of the given kind with the sampling of each component.
pub fn jpeg_head(kind: u8, bits: u8, width: u16, height: u16, sampling: &[u8]) -> Vec<u8> {
    // Steps of eight make a block's mean one of 1: its value is the shade itself.
    let quantisers = [&[0u8][..], &[8; 64]].concat();
    let dc = [&[0u8, 0, 0, 0, 12][..], &[0; 12], &(0..12).collect::<Vec<u8>>()].concat();
    let ac = [&[0x10u8, 1][..], &[0; 15], &[0]].concat();
    let mut frame = [&[bits][..], &height.to_be_bytes(), &width.to_be_bytes(), &[sampling.len() as u8]].concat();
    sampling.iter().enumerate().for_each(|(i, &s)| frame.extend([i as u8 + 1, s, 0]));
    [segment(0xdb, &quantisers), segment(kind, &frame), segment(0xc4, &dc), segment(0xc4, &ac)].concat()
}

/// A whole JPEG of one component from what stands before its scan and the scan's bits.
pub fn jpeg(head: &[u8], data: &[u8]) -> Vec<u8> {
    [&[0xff, 0xd8], head, &segment(0xda, &[1, 1, 0, 0, 63, 0]), data, &[0xff, 0xd9]].concat()
}

pub fn segment(marker: u8, body: &[u8]) -> Vec<u8> {
    let length = u16::try_from(body.len() + 2).expect("small");
    [&[0xff, marker][..], &length.to_be_bytes(), body].concat()
}

#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    held: u32,
    count: u32,
}

impl Bits {
    fn push(&mut self, value: u32, bits: u32) {
        for bit in (0..bits).rev() {
            self.held = self.held << 1 | (value >> bit & 1);
            self.count += 1;
            if self.count == 8 {
                self.bytes.push(self.held as u8);
                if self.held as u8 == 0xff {
                    self.bytes.push(0);
                }
                (self.held, self.count) = (0, 0);
            }
        }
    }

    fn finish(mut self) -> Vec<u8> {
        while self.count != 0 {
            self.push(1, 1);
        }
        self.bytes
    }
}

/// A value of a TIFF tag.
#[derive(Clone)]
pub enum Value {
    /// 16 bits each.
    Short(Vec<u16>),
    /// 32 bits each.
    Long(Vec<u32>),
    /// As is.
    Bytes(Vec<u8>),
    /// Says there are so many values of 32 bits, at this place.
    Claimed(u32, u32),
}

/// A TIFF of one directory, at the end; `data` begins at byte 8.
pub fn tiff(data: &[u8], tags: &[(u16, Value)]) -> Vec<u8> {
    let mut file = [&b"II*\0"[..], &[0; 4], data].concat();
    let mut entries = Vec::new();
    let mut tags = tags.to_vec();
    tags.sort_by_key(|(tag, _)| *tag);
    for (tag, value) in tags {
        let (kind, count, body) = match value {
            Value::Short(v) => (3u16, v.len() as u32, v.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>()),
            Value::Long(v) => (4, v.len() as u32, v.iter().flat_map(|n| n.to_le_bytes()).collect()),
            Value::Bytes(v) => (7, v.len() as u32, v),
            Value::Claimed(count, at) => (4, count, at.to_le_bytes().to_vec()),
        };
        entries.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
        entries.extend(count.to_le_bytes());
        if body.len() <= 4 {
            entries.extend([body.as_slice(), &[0; 4]].concat()[..4].iter());
        } else {
            entries.extend((file.len() as u32).to_le_bytes());
            file.extend(body);
        }
    }
    let at = file.len() as u32;
    file[4..8].copy_from_slice(&at.to_le_bytes());
    let count = (entries.len() / 12) as u16;
    [file.as_slice(), &count.to_le_bytes(), &entries, &[0; 4]].concat()
}

/// The tags of a TIFF of one strip of grey of 8 bits.
pub fn grey_tags(width: u32, height: u32) -> Vec<(u16, Value)> {
    vec![
        (256, Value::Long(vec![width])),
        (257, Value::Long(vec![height])),
        (258, Value::Short(vec![8])),
        (259, Value::Short(vec![1])),
        (262, Value::Short(vec![1])),
        (273, Value::Long(vec![8])),
        (277, Value::Short(vec![1])),
        (278, Value::Long(vec![height])),
        (279, Value::Long(vec![width * height])),
    ]
}

/// The tags with some replaced, added, or (`None`) taken out.
pub fn with(mut tags: Vec<(u16, Value)>, changes: &[(u16, Option<Value>)]) -> Vec<(u16, Value)> {
    for (tag, value) in changes {
        tags.retain(|(old, _)| old != tag);
        tags.extend(value.clone().map(|v| (*tag, v)));
    }
    tags
}

/// A RIFF file of WebP chunks.
pub fn webp(chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut body = b"WEBP".to_vec();
    for (kind, data) in chunks {
        body.extend([&kind[..], &(data.len() as u32).to_le_bytes(), data, &[0][..data.len() % 2]].concat());
    }
    [&b"RIFF"[..], &(body.len() as u32).to_le_bytes(), &body].concat()
}

/// Head of a lossless WebP picture.
pub fn vp8l(width: u32, height: u32, rest: &[u8]) -> Vec<u8> {
    let bits = (width - 1) | (height - 1) << 14;
    [&[0x2f][..], &bits.to_le_bytes(), rest].concat()
}

/// Head of a lossy WebP picture; `first` is the length of its first part.
pub fn vp8(width: u16, height: u16, first: u32, rest: &[u8]) -> Vec<u8> {
    let tag = first << 5 | 1 << 4;
    [&tag.to_le_bytes()[..3], &[0x9d, 0x01, 0x2a], &width.to_le_bytes(), &height.to_le_bytes(), rest].concat()
}

/// Head of an extended WebP file.
pub fn vp8x(flags: u8, width: u32, height: u32) -> Vec<u8> {
    let side = |n: u32| (n - 1).to_le_bytes()[..3].to_vec();
    [&[flags, 0, 0, 0][..], &side(width), &side(height)].concat()
}
