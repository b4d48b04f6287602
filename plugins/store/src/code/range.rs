//! Binary range coding with chances that learn.

use super::mix::{VIEWS, together};

/// Chances are told in 1/2^15.
pub(crate) const CHANCE_BITS: u32 = 15;
/// Least chance of either: what is certain costs 1/350 of a bit, and a slot that was wrong about it for long learns again.
pub(crate) const LEAST: u32 = 1 << (CHANCE_BITS - 9);
/// A reader is so many bytes ahead of the bits that it has read.
const AHEAD: u32 = 4;
/// Below this, a byte of the range is spent.
const LOW_RANGE: u32 = 1 << 24;

/// How likely the next bit of some kind is a zero, by those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Chance {
    /// Of a zero, in 1/2^16.
    zero: u16,
    /// How many bits it stands for: with each it learns slower.
    seen: u8,
}

impl Chance {
    /// Nothing is known.
    pub(crate) const EVEN: Self = Self { zero: 1 << 15, seen: 0 };

    /// As if so many bits had been seen.
    pub(crate) const fn new(zero: u16, seen: u8) -> Self {
        Self { zero, seen: if seen > SEEN_CAP { SEEN_CAP } else { seen } }
    }

    pub(crate) const fn zero(self) -> u16 {
        self.zero
    }

    pub(crate) const fn seen(self) -> u8 {
        self.seen
    }

    fn of_zero(self) -> u32 {
        (u32::from(self.zero) >> (16 - CHANCE_BITS)).clamp(LEAST, (1 << CHANCE_BITS) - LEAST)
    }

    #[cfg(test)]
    pub(crate) fn cost(self, one: bool) -> f64 {
        let zero = f64::from(self.of_zero()) / 32768.0;
        -(if one { 1.0 - zero } else { zero }).log2()
    }

    pub(crate) fn learn(&mut self, one: bool) {
        let goal = if one { 0 } else { i32::from(u16::MAX) };
        let step = (goal - i32::from(self.zero)) * 2 / (2 * i32::from(self.seen) + 3);
        // Lies between the old chance and the goal.
        self.zero = (i32::from(self.zero) + step) as u16;
        self.seen = (self.seen + 1).min(SEEN_CAP);
    }
}

impl Default for Chance {
    fn default() -> Self {
        Self::EVEN
    }
}

/// No chance learns slower than after so many bits.
pub(crate) const SEEN_CAP: u8 = 90;

/// Something that bits go through: on writing they are taken as they are, on reading they are found.
pub(crate) trait Bits {
    /// What is known of a kind of bit.
    type Slot: Clone + Default + 'static;

    /// A bit of a kind: returns the one given on writing, the one read on reading.
    fn bit(&mut self, slot: &mut Self::Slot, one: bool) -> bool;

    /// The same of a bit of several kinds at once.
    fn mixed(&mut self, slots: [&mut Self::Slot; VIEWS], one: bool) -> bool;

    /// The lowest bits of a number about which nothing can be known.
    fn raw(&mut self, value: u64, bits: u32) -> u64;

    /// Whether more was read than is there.
    fn is_beyond(&self) -> bool {
        false
    }
}

/// Writes bits.
#[derive(Debug)]
pub(crate) struct Encoder {
    low: u64,
    range: u32,
    /// Bytes that a carry may still change: the first, and how many of all ones follow it.
    held: Option<u8>,
    ones: usize,
    out: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self { low: 0, range: u32::MAX, held: None, ones: 0, out: Vec::new() }
    }
}

impl Encoder {
    fn shift(&mut self) {
        let carry = (self.low >> 32) as u8;
        if carry == 1 || self.low < 0xFF00_0000 {
            self.out.extend(self.held.map(|held| held.wrapping_add(carry)));
            self.out.extend(core::iter::repeat_n(0xFF_u8.wrapping_add(carry), self.ones));
            self.ones = 0;
            self.held = Some((self.low >> 24) as u8);
        } else {
            self.ones += 1;
        }
        self.low = self.low << 8 & 0xFFFF_FFFF;
    }

    fn part(&mut self, bound: u32, one: bool) {
        if one {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        while self.range < LOW_RANGE {
            self.range <<= 8;
            self.shift();
        }
    }

    /// All bytes: as few as tell the bits.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        let settled = self.out.len() + usize::from(self.held.is_some()) + self.ones;
        let top = self.low + u64::from(self.range) - 1;
        let round = (0..32).rev().map(|bits| top >> bits << bits).find(|&value| value >= self.low);
        self.low = round.unwrap_or(top);
        for _ in 0..5 {
            self.shift();
        }
        while self.out.len() > settled && self.out.last() == Some(&0) {
            self.out.pop();
        }
        self.out
    }
}

impl Bits for Encoder {
    type Slot = Chance;

    fn bit(&mut self, slot: &mut Chance, one: bool) -> bool {
        self.part((self.range >> CHANCE_BITS) * slot.of_zero(), one);
        slot.learn(one);
        one
    }

    fn mixed(&mut self, slots: [&mut Chance; VIEWS], one: bool) -> bool {
        let zero = together(slots.each_ref().map(|slot| **slot));
        self.part((self.range >> CHANCE_BITS) * zero, one);
        slots.into_iter().for_each(|slot| slot.learn(one));
        one
    }

    fn raw(&mut self, value: u64, bits: u32) -> u64 {
        (0..bits).rev().for_each(|i| self.part(self.range >> 1, value >> i & 1 == 1));
        value
    }
}

/// Reads bits. Beyond the end of the bytes are zeros, as many as a writer leaves out.
#[derive(Debug)]
pub(crate) struct Decoder<'b> {
    code: u32,
    range: u32,
    bytes: &'b [u8],
    /// How many bytes were read beyond the end.
    beyond: u32,
}

impl<'b> Decoder<'b> {
    pub(crate) fn new(bytes: &'b [u8]) -> Self {
        let mut decoder = Self { code: 0, range: u32::MAX, bytes, beyond: 0 };
        (0..AHEAD).for_each(|_| decoder.shift());
        decoder
    }

    fn shift(&mut self) {
        let (&byte, rest) = self.bytes.split_first().unwrap_or_else(|| {
            self.beyond = self.beyond.saturating_add(1);
            (&0, &[])
        });
        self.bytes = rest;
        self.code = self.code << 8 | u32::from(byte);
    }

    fn part(&mut self, bound: u32) -> bool {
        let one = self.code >= bound;
        if one {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        while self.range < LOW_RANGE {
            self.range <<= 8;
            self.shift();
        }
        one
    }

    /// Whether all bytes have been read.
    pub(crate) const fn is_at_end(&self) -> bool {
        self.bytes.is_empty()
    }
}

impl Bits for Decoder<'_> {
    type Slot = Chance;

    fn bit(&mut self, slot: &mut Chance, _: bool) -> bool {
        let one = self.part((self.range >> CHANCE_BITS) * slot.of_zero());
        slot.learn(one);
        one
    }

    fn mixed(&mut self, slots: [&mut Chance; VIEWS], _: bool) -> bool {
        let zero = together(slots.each_ref().map(|slot| **slot));
        let one = self.part((self.range >> CHANCE_BITS) * zero);
        slots.into_iter().for_each(|slot| slot.learn(one));
        one
    }

    fn raw(&mut self, _: u64, bits: u32) -> u64 {
        (0..bits).fold(0, |value, _| value << 1 | u64::from(self.part(self.range >> 1)))
    }

    fn is_beyond(&self) -> bool {
        self.beyond > AHEAD
    }
}
