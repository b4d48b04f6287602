use core::fmt;

use serde::ser::{
    self, Serialize, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple, SerializeTupleStruct,
    SerializeTupleVariant,
};

use super::HANDMADE;
use super::models::{Models, Node};
use super::range::Bits;

/// Puts values into bits.
pub(crate) struct Writer<'w, B: Bits> {
    bits: &'w mut B,
    models: &'w mut Models<B::Slot>,
    /// The column of the next value.
    node: Node,
    /// How many values there are.
    pub(crate) values: u64,
}

impl<'w, B: Bits> Writer<'w, B> {
    pub(crate) const fn new(bits: &'w mut B, models: &'w mut Models<B::Slot>) -> Self {
        Self { bits, models, node: 0, values: 0 }
    }

    fn unsigned(&mut self, value: u64) -> Result<(), Unfit> {
        self.values += 1;
        self.models.unsigned(self.bits, self.node, value);
        Ok(())
    }

    fn signed(&mut self, value: i64) -> Result<(), Unfit> {
        self.values += 1;
        self.models.signed(self.bits, self.node, value);
        Ok(())
    }

    fn raw(&mut self, value: u64, bits: u32) -> Result<(), Unfit> {
        self.values += 1;
        self.bits.raw(value, bits);
        Ok(())
    }

    fn part<T: Serialize + ?Sized>(&mut self, n: usize, value: &T) -> Result<(), Unfit> {
        let node = self.node;
        self.node = self.models.child(node, n);
        value.serialize(&mut *self)?;
        self.node = node;
        Ok(())
    }

    fn variant(&mut self, n: u32) -> Result<(), Unfit> {
        self.unsigned(u64::from(n))
    }
}

/// What no structure of ours has: maps, sequences of unknown length.
#[derive(Debug)]
pub(crate) struct Unfit(String);

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for Unfit {}

impl ser::Error for Unfit {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

impl<'w, 's, B: Bits> ser::Serializer for &'s mut Writer<'w, B> {
    type Ok = ();
    type Error = Unfit;
    type SerializeSeq = Parts<'w, 's, B>;
    type SerializeTuple = Parts<'w, 's, B>;
    type SerializeTupleStruct = Parts<'w, 's, B>;
    type SerializeTupleVariant = Parts<'w, 's, B>;
    type SerializeMap = ser::Impossible<(), Unfit>;
    type SerializeStruct = Parts<'w, 's, B>;
    type SerializeStructVariant = Parts<'w, 's, B>;

    fn is_human_readable(&self) -> bool {
        false
    }

    fn serialize_bool(self, value: bool) -> Result<(), Unfit> {
        self.values += 1;
        self.models.flag(self.bits, self.node, value);
        Ok(())
    }

    fn serialize_i8(self, value: i8) -> Result<(), Unfit> {
        self.signed(value.into())
    }

    fn serialize_i16(self, value: i16) -> Result<(), Unfit> {
        self.signed(value.into())
    }

    fn serialize_i32(self, value: i32) -> Result<(), Unfit> {
        self.signed(value.into())
    }

    fn serialize_i64(self, value: i64) -> Result<(), Unfit> {
        self.signed(value)
    }

    fn serialize_u8(self, value: u8) -> Result<(), Unfit> {
        self.unsigned(value.into())
    }

    fn serialize_u16(self, value: u16) -> Result<(), Unfit> {
        self.unsigned(value.into())
    }

    fn serialize_u32(self, value: u32) -> Result<(), Unfit> {
        self.unsigned(value.into())
    }

    fn serialize_u64(self, value: u64) -> Result<(), Unfit> {
        self.unsigned(value)
    }

    /// Noise: a hash, of which 96 bits are told.
    fn serialize_u128(self, value: u128) -> Result<(), Unfit> {
        self.raw((value >> 64) as u64, 32)?;
        self.raw(value as u64, 64)
    }

    fn serialize_f32(self, value: f32) -> Result<(), Unfit> {
        self.raw(value.to_bits().into(), 32)
    }

    fn serialize_f64(self, value: f64) -> Result<(), Unfit> {
        self.raw(value.to_bits(), 64)
    }

    fn serialize_char(self, value: char) -> Result<(), Unfit> {
        self.unsigned(value.into())
    }

    fn serialize_str(self, value: &str) -> Result<(), Unfit> {
        self.unsigned(value.len() as u64)?;
        let mut before = 0;
        for &letter in value.as_bytes() {
            self.values += 1;
            self.models.letter(self.bits, self.node, before, letter);
            before = letter;
        }
        Ok(())
    }

    fn serialize_bytes(self, value: &[u8]) -> Result<(), Unfit> {
        self.unsigned(value.len() as u64)?;
        value.iter().try_for_each(|&byte| self.raw(byte.into(), 8))
    }

    fn serialize_none(self) -> Result<(), Unfit> {
        self.serialize_bool(false)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Unfit> {
        self.serialize_bool(true)?;
        self.part(0, value)
    }

    fn serialize_unit(self) -> Result<(), Unfit> {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Result<(), Unfit> {
        Ok(())
    }

    fn serialize_unit_variant(self, _: &'static str, n: u32, _: &'static str) -> Result<(), Unfit> {
        self.variant(n)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, name: &'static str, value: &T) -> Result<(), Unfit> {
        if name != HANDMADE {
            return value.serialize(self);
        }
        self.models.handmade(true);
        value.serialize(&mut *self)?;
        self.models.handmade(false);
        Ok(())
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        n: u32,
        _: &'static str,
        value: &T,
    ) -> Result<(), Unfit> {
        self.variant(n)?;
        self.part(n as usize, value)
    }

    fn serialize_seq(self, len: Option<usize>) -> Result<Parts<'w, 's, B>, Unfit> {
        let len = len.ok_or_else(|| ser::Error::custom("a sequence of unknown length"))?;
        self.unsigned(len as u64)?;
        let above = self.node;
        self.node = self.models.child(above, 0);
        Ok(Parts { writer: self, above, next: 0 })
    }

    fn serialize_tuple(self, _: usize) -> Result<Parts<'w, 's, B>, Unfit> {
        Ok(Parts { above: self.node, writer: self, next: 0 })
    }

    fn serialize_tuple_struct(self, _: &'static str, len: usize) -> Result<Parts<'w, 's, B>, Unfit> {
        self.serialize_tuple(len)
    }

    fn serialize_tuple_variant(self, _: &'static str, n: u32, _: &'static str, len: usize) -> Result<Parts<'w, 's, B>, Unfit> {
        self.variant(n)?;
        let above = self.node;
        self.node = self.models.child(above, n as usize);
        let mut parts = self.serialize_tuple(len)?;
        parts.above = above;
        Ok(parts)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unfit> {
        Err(ser::Error::custom("a map"))
    }

    fn serialize_struct(self, _: &'static str, len: usize) -> Result<Parts<'w, 's, B>, Unfit> {
        self.serialize_tuple(len)
    }

    fn serialize_struct_variant(
        self,
        name: &'static str,
        n: u32,
        variant: &'static str,
        len: usize,
    ) -> Result<Parts<'w, 's, B>, Unfit> {
        self.serialize_tuple_variant(name, n, variant, len)
    }
}

/// Values that belong together.
pub(crate) struct Parts<'w, 's, B: Bits> {
    writer: &'s mut Writer<'w, B>,
    /// The column of the whole.
    above: Node,
    next: usize,
}

impl<B: Bits> Parts<'_, '_, B> {
    fn next<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unfit> {
        self.next += 1;
        self.writer.part(self.next - 1, value)
    }

    const fn close(self) {
        self.writer.node = self.above;
    }
}

impl<B: Bits> SerializeSeq for Parts<'_, '_, B> {
    type Ok = ();
    type Error = Unfit;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unfit> {
        self.writer.models.new_row();
        value.serialize(&mut *self.writer)
    }

    fn end(self) -> Result<(), Unfit> {
        self.close();
        Ok(())
    }
}

macro_rules! parts {
    ($($kind:ident $($way:ident)?),*) => {$(
        impl<B: Bits> $kind for Parts<'_, '_, B> {
            type Ok = ();
            type Error = Unfit;

            parts!(@ $kind $($way)?);

            fn end(self) -> Result<(), Unfit> {
                self.close();
                Ok(())
            }
        }
    )*};
    (@ SerializeTuple) => {
        fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unfit> {
            self.next(value)
        }
    };
    (@ $kind:ident named) => {
        fn serialize_field<T: Serialize + ?Sized>(&mut self, _: &'static str, value: &T) -> Result<(), Unfit> {
            self.next(value)
        }
    };
    (@ $kind:ident) => {
        fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unfit> {
            self.next(value)
        }
    };
}

parts!(SerializeTuple, SerializeTupleStruct, SerializeTupleVariant, SerializeStruct named, SerializeStructVariant named);
