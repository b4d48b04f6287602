//! Protocol buffers' wire format, read with every bound checked (<https://protobuf.dev/programming-guides/encoding/>).

/// What is wrong with a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WireFault {
    /// It ends inside a value.
    Cut,
    /// A number of more than 64 bits.
    LongNumber,
    /// A type of value that does not exist or does not fit the field.
    Type,
    /// A sum of differences beyond 64 bits.
    Overflow,
    /// An index beyond the table of strings.
    NoString,
    /// A text that is not UTF-8.
    Text,
    /// Lists that belong together but differ in length.
    Uneven,
}

impl WireFault {
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Cut => "a message ends inside a value",
            Self::LongNumber => "a number has more than 64 bits",
            Self::Type => "a field has the wrong type",
            Self::Overflow => "differences add up to more than 64 bits",
            Self::NoString => "a tag points outside the table of strings",
            Self::Text => "a text is not UTF-8",
            Self::Uneven => "lists that belong together differ in length",
        }
    }
}

/// The value of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Value<'a> {
    Number(u64),
    Bytes(&'a [u8]),
    Fixed,
}

impl<'a> Value<'a> {
    pub(crate) fn bytes(self) -> Result<&'a [u8], WireFault> {
        if let Self::Bytes(bytes) = self { Ok(bytes) } else { Err(WireFault::Type) }
    }

    pub(crate) fn number(self) -> Result<u64, WireFault> {
        if let Self::Number(n) = self { Ok(n) } else { Err(WireFault::Type) }
    }

    pub(crate) fn signed(self) -> Result<i64, WireFault> {
        self.number().map(unzigzag)
    }

    /// Numbers of a repeated field, packed or one by one.
    pub(crate) fn numbers(self, out: &mut Vec<u64>) -> Result<(), WireFault> {
        match self {
            Self::Number(n) => out.push(n),
            Self::Bytes(bytes) => {
                let mut wire = Wire(bytes);
                while !wire.0.is_empty() {
                    out.push(wire.number()?);
                }
            }
            Self::Fixed => return Err(WireFault::Type),
        }
        Ok(())
    }
}

/// A message, or what is left of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wire<'a>(pub &'a [u8]);

impl<'a> Wire<'a> {
    fn number(&mut self) -> Result<u64, WireFault> {
        let mut value = 0_u64;
        for (i, &byte) in self.0.iter().take(10).enumerate() {
            if i == 9 && byte > 1 {
                return Err(WireFault::LongNumber);
            }
            value |= u64::from(byte & 0x7F) << (7 * i);
            if byte & 0x80 == 0 {
                self.0 = self.0.get(i + 1..).unwrap_or_default();
                return Ok(value);
            }
        }
        Err(if self.0.len() < 10 { WireFault::Cut } else { WireFault::LongNumber })
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], WireFault> {
        let (head, tail) = self.0.split_at_checked(n).ok_or(WireFault::Cut)?;
        self.0 = tail;
        Ok(head)
    }

    /// The next field's number and value; `None` at the end.
    pub(crate) fn field(&mut self) -> Result<Option<(u64, Value<'a>)>, WireFault> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let key = self.number()?;
        let value = match key & 7 {
            0 => Value::Number(self.number()?),
            1 => self.take(8).map(|_| Value::Fixed)?,
            2 => {
                let n = self.number()?;
                Value::Bytes(self.take(usize::try_from(n).map_err(|_| WireFault::Cut)?)?)
            }
            5 => self.take(4).map(|_| Value::Fixed)?,
            _ => return Err(WireFault::Type),
        };
        Ok(Some((key >> 3, value)))
    }
}

/// Numbers whose sign sits in the lowest bit.
pub(crate) const fn unzigzag(n: u64) -> i64 {
    (n >> 1) as i64 ^ -((n & 1) as i64)
}

/// Running sums of signed differences.
pub(crate) fn sums(differences: &[u64]) -> impl Iterator<Item = Result<i64, WireFault>> + '_ {
    let mut sum = Some(0_i64);
    differences.iter().map(move |&d| {
        sum = sum.and_then(|s| s.checked_add(unzigzag(d)));
        sum.ok_or(WireFault::Overflow)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_one_to_ten_bytes_are_read() {
        assert_eq!(Wire(&[0x96, 0x01]).number(), Ok(150));
        let mut most = [0xFF; 10];
        most[9] = 1;
        assert_eq!(Wire(&most).number(), Ok(u64::MAX));
        most[9] = 2;
        assert_eq!(Wire(&most).number(), Err(WireFault::LongNumber));
        assert_eq!(Wire(&[0x80]).number(), Err(WireFault::Cut));
    }

    #[test]
    fn signs_alternate() {
        assert_eq!([0, 1, 2, 3, u64::MAX].map(unzigzag), [0, -1, 1, -2, i64::MIN]);
    }

    #[test]
    fn sums_that_overflow_are_faults() {
        let huge = [u64::MAX - 1, 2];
        assert_eq!(sums(&huge).collect::<Vec<_>>(), [Ok(i64::MAX), Err(WireFault::Overflow)]);
    }

    #[test]
    fn a_length_beyond_the_end_is_a_cut() {
        assert_eq!(Wire(&[0x0A, 0x05, 1, 2]).field(), Err(WireFault::Cut));
        assert_eq!(Wire(&[0x0B]).field(), Err(WireFault::Type), "groups are gone");
    }
}
