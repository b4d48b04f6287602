//! Structures as bytes: what [`serde`] tells of a value goes through a binary range coder (as in LZMA and video codecs), number
//! by number, each bit by what is known of its column.
//!
//! A column is a place in the structure: a field of a struct, the elements of a sequence. What is known of it are chances that learn
//! from every bit. They begin as they were on average in cities that the project makes itself ([`priors`]), so that a packet of a few
//! hundred bytes need not learn them anew. A number is told as how many digits it has, by what three views make of it together ([`mix`]: the
//! number before it in the column, the one before it in the row, both coarsely), then by its highest digits, then by the others. Vertices
//! follow the structure, told by how lines go on ([`lines`]).
//!
//! Hostile bytes: a count of all values stands before them. Every number, letter and element is one, and no memory is taken for more
//! than are left; no bit is so certain that it costs nothing, so that few bytes cannot tell many values.

mod de;
mod lines;
mod mix;
mod models;
mod priors;
mod range;
mod ser;
#[cfg(test)]
mod train;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::StoreError;
pub(crate) use de::{Source, Unread};
pub(crate) use lines::Outlines;
use range::Encoder;
use ser::Writer;

pub(crate) use priors::Prior;

/// Things that people made by hand: the same sequences of numbers come again and again, and most lengths are whole centimetres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Handmade<T>(pub(crate) T);

/// What the type is called.
const HANDMADE: &str = "Handmade";

/// Content of more values a byte is refused, unless they are few. Numbers that are all the same come to 710 of them, for each takes some four bits that are as
/// certain as any may be, [`range::LEAST`]: so does even ground, of which the terrain of a cell by a river came to 282. All else in cities
/// stays below 20. Flags alone could be more, where there are some 60,000 of them and nothing else.
const VALUES_A_BYTE: u64 = 1_024;
/// So many values may be told by as few bytes as there are.
const FEW_VALUES: u64 = 32_768;

/// Appends a structure, and the lines of one that has some.
pub(crate) fn press<T: Serialize + ?Sized>(value: &T, outlines: Option<&Outlines>, prior: Prior, out: &mut Vec<u8>) {
    let mut bits = Encoder::default();
    let mut models = prior.models();
    let mut writer = Writer::new(&mut bits, &mut models);
    // Ours have known lengths and no maps, which is all that could be refused.
    if let Err(error) = value.serialize(&mut writer) {
        unreachable!("{error}");
    }
    let mut values = writer.values;
    values += outlines.map_or(0, |outlines| outlines.tell(&mut bits, &mut models));
    while values >= 0x80 {
        out.push(values as u8 | 0x80);
        values >>= 7;
    }
    out.push(values as u8);
    out.append(&mut bits.finish());
}

/// A structure of all the bytes, of no more values than a cap.
pub(crate) fn unpress<T: DeserializeOwned>(what: &'static str, bytes: &[u8], prior: Prior, cap: u64) -> Result<T, StoreError> {
    read(what, bytes, prior, cap, |value, _| Ok(value))
}

/// What is made of a structure and of the lines that follow it, which are all the bytes, of no more values than a cap.
pub(crate) fn unpress_with<T: DeserializeOwned, O>(
    what: &'static str,
    bytes: &[u8],
    prior: Prior,
    cap: u64,
    make: impl FnOnce(T, &mut Source<'_, '_>) -> Result<O, Unread>,
) -> Result<O, StoreError> {
    read(what, bytes, prior, cap, |value, source| {
        source.begin_lines()?;
        make(value, source)
    })
}

fn read<T: DeserializeOwned, O>(
    what: &'static str,
    bytes: &[u8],
    prior: Prior,
    cap: u64,
    make: impl FnOnce(T, &mut Source<'_, '_>) -> Result<O, Unread>,
) -> Result<O, StoreError> {
    let malformed = |reason: &str| StoreError::Malformed { what, reason: reason.to_owned() };
    let (values, coded) = varint(bytes).ok_or_else(|| malformed("its size is not a number"))?;
    // A count that the bytes could not tell is refused before any memory is taken for it.
    let cap = cap.min(FEW_VALUES + coded.len() as u64 * VALUES_A_BYTE);
    if values > cap {
        return Err(StoreError::TooLarge { what, claimed: values, cap });
    }
    let mut models = prior.models();
    let mut source = Source::new(coded, &mut models, values);
    let value = T::deserialize(&mut source).and_then(|value| make(value, &mut source));
    let value = value.map_err(|Unread(reason)| malformed(&reason))?;
    match (source.left(), source.is_at_end()) {
        (0, true) if source.is_beyond() => Err(malformed("it is cut off")),
        (0, true) => Ok(value),
        (0, false) => Err(malformed("bytes are left over")),
        _ => Err(malformed("it has fewer values than it says")),
    }
}

/// A LEB128 number of at most five bytes at the head of some bytes, and what follows.
fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut value = 0;
    for (i, &byte) in bytes.iter().enumerate().take(5) {
        value |= u64::from(byte & 0x7F) << (7 * i);
        if byte & 0x80 == 0 {
            return Some((value, bytes.get(i + 1..)?));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    enum Kind {
        Plain,
        One(i64),
        Two(u8, bool),
        Named { text: String, of: Option<Vec<u32>> },
    }

    /// Something of everything that structures are made of.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Thing {
        signed: (i8, i16, i32, i64),
        unsigned: (u8, u16, u32, u64),
        noise: u128,
        real: f64,
        kinds: Vec<Kind>,
        made: Handmade<Vec<i32>>,
        nothing: (),
    }

    fn any_kind() -> impl Strategy<Value = Kind> {
        prop_oneof![
            Just(Kind::Plain),
            any::<i64>().prop_map(Kind::One),
            any::<(u8, bool)>().prop_map(|(n, yes)| Kind::Two(n, yes)),
            (any::<String>(), any::<Option<Vec<u32>>>()).prop_map(|(text, of)| Kind::Named { text, of }),
        ]
    }

    fn any_thing() -> impl Strategy<Value = Thing> {
        let few = prop_oneof![Just(0), Just(1024), Just(-9), any::<i32>()];
        (any::<(i8, i16, i32, i64)>(), any::<(u8, u16, u32, u64)>(), any::<(u128, u64)>(), vec(any_kind(), 0..9), vec(few, 0..60))
            .prop_map(|(signed, unsigned, (noise, real), kinds, made)| Thing {
                signed,
                unsigned,
                noise: noise >> 32,
                // Finite, so that it equals itself.
                real: real as f64 / 3.0,
                kinds,
                made: Handmade(made),
                nothing: (),
            })
    }

    fn pressed<T: Serialize>(value: &T) -> Vec<u8> {
        let mut out = Vec::new();
        press(value, None, Prior::None, &mut out);
        out
    }

    fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, StoreError> {
        unpress("a thing", bytes, Prior::None, 1 << 20)
    }

    proptest! {
        #[test]
        fn anything_survives(things in vec(any_thing(), 0..5)) {
            prop_assert_eq!(read::<Vec<Thing>>(&pressed(&things)), Ok(things));
        }

        #[test]
        fn what_is_cut_or_longer_is_refused(things in vec(any_thing(), 1..3), cut in any::<prop::sample::Index>()) {
            let mut bytes = pressed(&things);
            // The last four bytes may be such as a reader fills in by itself.
            let keep = cut.index(bytes.len().saturating_sub(4).max(1));
            prop_assert_ne!(read::<Vec<Thing>>(&bytes[..keep]), Ok(things.clone()));
            bytes.extend([7; 5]);
            prop_assert_ne!(read::<Vec<Thing>>(&bytes), Ok(things));
        }

        #[test]
        fn no_bytes_do_harm(bytes in vec(any::<u8>(), 0..300)) {
            let _either = read::<Vec<Thing>>(&bytes);
        }
    }

    #[test]
    fn what_repeats_costs_little_and_noise_no_more_than_itself() {
        let even: Vec<(u32, i32)> = (0..10_000).map(|i| (7, i % 2)).collect();
        assert!(pressed(&even).len() < 200, "{} B", pressed(&even).len());
        let mut noise = blake3::Hasher::new().finalize_xof();
        let noise: Vec<u16> = (0..10_000)
            .map(|_| {
                let mut two = [0; 2];
                noise.fill(&mut two);
                u16::from_le_bytes(two)
            })
            .collect();
        assert!(pressed(&noise).len() < 20_600, "{} B", pressed(&noise).len());
        let profile: Vec<i32> = (0..300).map(|i| GRID * [0, 12, 37, 5, 400, 31, 8][i % 7] / 100).collect();
        let (plain, made) = (pressed(&profile).len(), pressed(&Handmade(profile)).len());
        assert!(5 * made < plain, "{made} B of {plain}");
    }

    const GRID: i32 = 1024;

    #[test]
    fn even_ground_is_not_refused_however_much_of_it_there_is() {
        for posts in [1 << 10, 1 << 14, 1 << 18, 1 << 22] {
            let even = vec![0_i32; posts];
            let bytes = pressed(&even);
            assert!(posts as u64 * 4 < bytes.len() as u64 * VALUES_A_BYTE * 3, "{posts} posts take {} B", bytes.len());
            assert!(unpress("a thing", &bytes, Prior::None, 1 << 23) == Ok(even), "{posts} posts");
        }
    }

    #[test]
    fn few_bytes_cannot_tell_many_values() {
        let flags = |count: usize| {
            let flags = vec![false; count];
            (read(&pressed(&flags)), flags)
        };
        let (few, told) = flags(50_000);
        assert!(few == Ok(told), "more than any city has of nothing else");
        assert!(matches!(flags(200_000).0, Err(StoreError::TooLarge { .. })));
        let claim = [0xFF, 0xFF, 0x3F, 1, 2, 3];
        assert!(matches!(read::<Vec<bool>>(&claim), Err(StoreError::TooLarge { .. })));
    }
}
