//! Columns of plain values: numbers told as differences, ids, tables.

use std::collections::HashMap;
use std::hash::Hash;

use serde::{Deserialize, Serialize};
use veduta_city::Id;

use super::{Malformed, expecting};

/// Takes values off a column, one after another.
pub(crate) struct Pull<T> {
    values: std::vec::IntoIter<T>,
    name: &'static str,
}

impl<T> Pull<T> {
    pub(crate) fn new(name: &'static str, values: Vec<T>) -> Self {
        Self { values: values.into_iter(), name }
    }

    pub(crate) fn take(&mut self) -> Result<T, Malformed> {
        self.values.next().ok_or(Malformed::Column(self.name))
    }

    pub(crate) fn left(&self) -> usize {
        self.values.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.left() == 0
    }

    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        if self.is_empty() { Ok(()) } else { Err(Malformed::Column(self.name)) }
    }
}

/// Numbers as differences from the one before; wraps, so that any numbers survive.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Deltas(Vec<i32>);

impl Deltas {
    pub(crate) fn of(numbers: impl IntoIterator<Item = i32>) -> Self {
        let mut last = 0_i32;
        Self(numbers.into_iter().map(|n| n.wrapping_sub(core::mem::replace(&mut last, n))).collect())
    }

    pub(crate) fn numbers(self) -> Vec<i32> {
        let mut last = 0_i32;
        self.0
            .into_iter()
            .map(|d| {
                last = last.wrapping_add(d);
                last
            })
            .collect()
    }
}

/// Lists of (mostly ascending) indices: how many each has, and the gaps between them.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Lists {
    counts: Vec<u32>,
    gaps: Vec<i32>,
}

impl Lists {
    pub(crate) fn push(&mut self, list: impl ExactSizeIterator<Item = u32>) {
        self.counts.push(list.len() as u32);
        let mut next = 0_u32;
        for n in list {
            self.gaps.push(n.wrapping_sub(next) as i32);
            next = n.wrapping_add(1);
        }
    }

    pub(crate) fn pull(self) -> PullLists {
        PullLists { counts: Pull::new("lists", self.counts), gaps: Pull::new("entries of lists", self.gaps) }
    }
}

pub(crate) struct PullLists {
    counts: Pull<u32>,
    gaps: Pull<i32>,
}

impl PullLists {
    pub(crate) fn take(&mut self) -> Result<Vec<u32>, Malformed> {
        let count = self.counts.take()? as usize;
        if count > self.gaps.left() {
            return Err(Malformed::Reason("a list is longer than what is left"));
        }
        let mut next = 0_u32;
        (0..count)
            .map(|_| {
                let n = next.wrapping_add(self.gaps.take()? as u32);
                next = n.wrapping_add(1);
                Ok(n)
            })
            .collect()
    }

    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        self.counts.finish()?;
        self.gaps.finish()
    }
}

/// Ids without their zero bytes: a source's id keeps its kind in the top bits, which are turned to the bottom first.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Ids {
    lengths: Vec<u8>,
    bytes: Vec<u8>,
}

/// Bits of an id that tell its kind.
const KIND_BITS: u32 = 6;

impl Ids {
    pub(crate) fn push(&mut self, id: Id) {
        let turned = id.0.rotate_left(KIND_BITS);
        let length = 8 - turned.leading_zeros() as usize / 8;
        self.lengths.push(length as u8);
        self.bytes.extend(turned.to_le_bytes().iter().take(length));
    }

    pub(crate) fn pull(self) -> PullIds {
        PullIds { lengths: Pull::new("ids", self.lengths), bytes: Pull::new("bytes of ids", self.bytes) }
    }
}

pub(crate) struct PullIds {
    lengths: Pull<u8>,
    bytes: Pull<u8>,
}

impl PullIds {
    pub(crate) fn take(&mut self) -> Result<Id, Malformed> {
        let length = self.lengths.take()?;
        let mut bytes = [0; 8];
        let Some(given) = bytes.get_mut(..usize::from(length)) else { return Err(Malformed::Reason("an id is too long")) };
        for byte in given {
            *byte = self.bytes.take()?;
        }
        Ok(Id(u64::from_le_bytes(bytes).rotate_right(KIND_BITS)))
    }

    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        self.lengths.finish()?;
        self.bytes.finish()
    }
}

/// Which of different values stands where: 0 for one that was not there before, else how many have come since it was new, and one.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Uses(Vec<u32>);

impl Uses {
    /// Of values that are numbered as they first appear.
    pub(crate) fn of(numbers: impl IntoIterator<Item = u32>) -> Self {
        let mut next = 0_u32;
        let told = |n: u32| {
            let told = next.wrapping_sub(n);
            next += u32::from(told == 0);
            told
        };
        Self(numbers.into_iter().map(told).collect())
    }

    fn pull(self) -> PullUses {
        PullUses { told: Pull::new("uses of a table", self.0), next: 0 }
    }
}

/// Takes numbers of values off [`Uses`].
struct PullUses {
    told: Pull<u32>,
    next: u32,
}

impl PullUses {
    fn take(&mut self) -> Result<usize, Malformed> {
        let told = self.told.take()?;
        let n = self.next.checked_sub(told).ok_or(Malformed::Reason("a table has no such entry"))?;
        self.next += u32::from(told == 0);
        Ok(n as usize)
    }
}

/// Different values in the order in which they first appear, and which of them stands where.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Table<T> {
    values: Vec<T>,
    uses: Uses,
}

/// Fills a [`Table`].
pub(crate) struct TableWriter<T> {
    values: Vec<T>,
    uses: Vec<u32>,
    known: HashMap<T, u32>,
}

impl<T> Default for TableWriter<T> {
    fn default() -> Self {
        Self { values: Vec::new(), uses: Vec::new(), known: HashMap::new() }
    }
}

impl<T: Hash + Eq + Clone> TableWriter<T> {
    pub(crate) fn push(&mut self, value: &T) {
        let n = match self.known.get(value) {
            Some(&n) => n,
            None => {
                let n = self.values.len() as u32;
                self.values.push(value.clone());
                self.known.insert(value.clone(), n);
                n
            }
        };
        self.uses.push(n);
    }

    pub(crate) fn finish(self) -> Table<T> {
        Table { values: self.values, uses: Uses::of(self.uses) }
    }
}

impl<T> Table<T> {
    /// The different values, and which of them stands where.
    pub(crate) fn parts(self) -> (Vec<T>, Uses) {
        (self.values, self.uses)
    }

    pub(crate) fn of_parts(values: Vec<T>, uses: Uses) -> Self {
        Self { values, uses }
    }

    pub(crate) fn pull(self) -> PullTable<T> {
        PullTable { values: self.values, uses: self.uses.pull() }
    }
}

pub(crate) struct PullTable<T> {
    values: Vec<T>,
    uses: PullUses,
}

impl<T> PullTable<T> {
    pub(crate) fn take_ref(&mut self) -> Result<&T, Malformed> {
        let n = self.uses.take()?;
        self.values.get(n).ok_or(Malformed::Reason("a table has no such entry"))
    }

    pub(crate) fn left(&self) -> usize {
        self.uses.told.left()
    }

    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        self.uses.told.finish()
    }
}

/// Texts, each told once, in one piece.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Texts {
    all: String,
    lengths: Vec<u32>,
    uses: Uses,
}

/// Longest text in bytes: keeps a text that is used often from filling the memory.
const TEXT_CAP: usize = 1 << 14;
/// Most bytes of all texts together, counted as often as they are used.
const TEXTS_CAP: usize = 1 << 26;

impl Texts {
    pub(crate) fn of<'a>(texts: impl IntoIterator<Item = &'a str>) -> Self {
        let mut known = HashMap::new();
        let (mut out, mut uses) = (Self::default(), Vec::new());
        for text in texts {
            let next = out.lengths.len() as u32;
            let n = *known.entry(text).or_insert(next);
            if n == next {
                out.all.push_str(text);
                out.lengths.push(text.len() as u32);
            }
            uses.push(n);
        }
        out.uses = Uses::of(uses);
        out
    }

    pub(crate) fn pull(self) -> Result<PullTexts, Malformed> {
        let mut rest = self.all.as_str();
        let mut values = expecting(self.lengths.len());
        for length in self.lengths {
            let (text, after) = rest.split_at_checked(length as usize).ok_or(Malformed::Reason("texts are cut wrongly"))?;
            values.push(text.to_owned());
            rest = after;
        }
        if !rest.is_empty() {
            return Err(Malformed::Reason("texts are left over"));
        }
        Ok(PullTexts { table: Table { values, uses: self.uses }.pull(), budget: TEXTS_CAP })
    }
}

pub(crate) struct PullTexts {
    table: PullTable<String>,
    budget: usize,
}

impl PullTexts {
    pub(crate) fn take(&mut self) -> Result<String, Malformed> {
        let text = self.table.take_ref()?;
        if text.len() > TEXT_CAP {
            return Err(Malformed::Reason("a text is longer than 16 KiB"));
        }
        self.budget = self.budget.checked_sub(text.len()).ok_or(Malformed::Reason("texts are longer than 64 MiB together"))?;
        Ok(text.clone())
    }

    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        self.table.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_numbers_survive_being_told_as_differences() {
        let numbers = [0, i32::MAX, i32::MIN, -1, 7, 7];
        assert_eq!(Deltas::of(numbers).numbers(), numbers);
        let mut lists = Lists::default();
        let odd = vec![u32::MAX, 0, 5, 3];
        lists.push(odd.iter().copied());
        lists.push([].into_iter());
        let mut pull = lists.pull();
        assert_eq!((pull.take(), pull.take(), pull.finish()), (Ok(odd), Ok(vec![]), Ok(())));
    }

    #[test]
    fn ids_of_a_map_take_fewer_bytes_than_hashes() {
        let all = [Id(0), Id(1), Id::from_source(2, 123_456_789), Id(u64::MAX), Id(1 << 63)];
        let mut ids = Ids::default();
        all.iter().for_each(|&id| ids.push(id));
        assert_eq!(ids.lengths, [0, 1, 5, 8, 1]);
        let mut pull = ids.pull();
        assert_eq!(all.map(|_| pull.take()), all.map(Ok));
        assert_eq!(pull.finish(), Ok(()));
    }

    #[test]
    fn a_text_told_twice_is_kept_once() {
        let texts = Texts::of(["Celetná", "", "Celetná", "Husova"]);
        assert_eq!(texts.all, "CeletnáHusova");
        let mut pull = texts.pull().expect("well cut");
        assert_eq!([(); 4].map(|()| pull.take().expect("four of them")), ["Celetná", "", "Celetná", "Husova"]);
        let cut = Texts { all: "á".to_owned(), lengths: vec![1, 1], uses: Uses::default() };
        assert!(cut.pull().is_err(), "cut within a letter");
    }

    #[test]
    fn a_long_text_told_often_is_refused() {
        let bomb = Texts { all: "x".repeat(TEXT_CAP), lengths: vec![TEXT_CAP as u32], uses: Uses::of(vec![0; 10_000]) };
        let mut pull = bomb.pull().expect("well cut");
        let taken = (0..10_000).take_while(|_| pull.take().is_ok()).count();
        assert_eq!(taken, TEXTS_CAP / TEXT_CAP);
    }
}
