use core::fmt;

use serde::de::{self, DeserializeSeed, EnumAccess, SeqAccess, VariantAccess, Visitor};

use veduta_city::{GridPolygon, GridPos, GridRing};

use super::HANDMADE;
use super::lines::{Vertices, section_of};
use super::models::{Models, Node};
use super::range::{Bits, Chance, Decoder};

/// For so many letters of a text memory is taken before they are read.
const TEXT_AT_ONCE: usize = 4_096;

/// Finds values in bits.
pub(crate) struct Source<'b, 'm> {
    bits: Decoder<'b>,
    models: &'m mut Models<Chance>,
    node: Node,
    /// How many values may still be read.
    left: u64,
    vertices: Vertices,
}

/// Why values cannot be read.
#[derive(Debug)]
pub(crate) struct Unread(pub(crate) String);

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for Unread {}

impl de::Error for Unread {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

fn bad<T>(message: &str) -> Result<T, Unread> {
    Err(Unread(message.to_owned()))
}

impl<'b, 'm> Source<'b, 'm> {
    pub(crate) fn new(bytes: &'b [u8], models: &'m mut Models<Chance>, values: u64) -> Self {
        Self { bits: Decoder::new(bytes), models, node: 0, left: values, vertices: Vertices::default() }
    }

    /// How many values have not been read.
    pub(crate) const fn left(&self) -> u64 {
        self.left
    }

    /// Whether more was read than is there.
    pub(crate) fn is_beyond(&self) -> bool {
        self.bits.is_beyond()
    }

    /// Whether all bytes have been read.
    pub(crate) const fn is_at_end(&self) -> bool {
        self.bits.is_at_end()
    }

    fn spend(&mut self, values: u64) -> Result<(), Unread> {
        match self.left.checked_sub(values) {
            Some(_) if self.bits.is_beyond() => bad("it is cut off"),
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => bad("it has more values than it says"),
        }
    }

    fn unsigned<T: TryFrom<u64>>(&mut self) -> Result<T, Unread> {
        self.spend(1)?;
        let value = self.models.unsigned(&mut self.bits, self.node, 0);
        T::try_from(value).or_else(|_| bad("a number is too large"))
    }

    fn signed<T: TryFrom<i64>>(&mut self) -> Result<T, Unread> {
        self.spend(1)?;
        let value = self.models.signed(&mut self.bits, self.node, 0);
        T::try_from(value).or_else(|_| bad("a number is too large"))
    }

    fn raw(&mut self, bits: u32) -> Result<u64, Unread> {
        self.spend(1)?;
        Ok(self.bits.raw(0, bits))
    }

    fn flag(&mut self) -> Result<bool, Unread> {
        self.spend(1)?;
        Ok(self.models.flag(&mut self.bits, self.node, false))
    }

    /// A count of things, each of which is at least one value.
    fn count(&mut self) -> Result<usize, Unread> {
        let count: u32 = self.unsigned()?;
        if u64::from(count) > self.left { bad("it has more values than it says") } else { Ok(count as usize) }
    }

    fn at<T>(&mut self, n: usize, read: impl FnOnce(&mut Self) -> Result<T, Unread>) -> Result<T, Unread> {
        let node = self.node;
        self.node = self.models.child(node, n);
        let value = read(self)?;
        self.node = node;
        Ok(value)
    }
}

/// Lines that follow the structure.
impl Source<'_, '_> {
    /// What stands before all lines.
    pub(super) fn begin_lines(&mut self) -> Result<(), Unread> {
        self.spend(1)?;
        self.vertices = Vertices::new(&mut self.bits, self.models, 0);
        Ok(())
    }

    /// A polygon that is known already.
    pub(crate) fn know(&mut self, polygon: &GridPolygon) {
        self.vertices.know(polygon);
    }

    pub(crate) fn point(&mut self, section: u8) -> Result<GridPos, Unread> {
        match self.vertex_line(section, true)?.as_slice() {
            &[pos] => Ok(pos),
            _ => bad("a point is none"),
        }
    }

    pub(crate) fn line(&mut self, section: u8) -> Result<GridRing, Unread> {
        self.vertex_line(section, false)
    }

    pub(crate) fn polygon(&mut self, section: u8) -> Result<GridPolygon, Unread> {
        self.spend(1)?;
        let node = section_of(self.models, section);
        let holes = Vertices::holes(&mut self.bits, self.models, node, 0);
        if holes > self.left {
            return bad("a polygon has more holes than rings are left");
        }
        let outer = self.line(section)?;
        Ok(GridPolygon { outer, holes: (0..holes).map(|_| self.line(section)).collect::<Result<_, _>>()? })
    }

    fn vertex_line(&mut self, section: u8, is_point: bool) -> Result<GridRing, Unread> {
        self.spend(1)?;
        let node = section_of(self.models, section);
        let line = self.vertices.line(&mut self.bits, self.models, node, None, is_point, self.left);
        let Some(line) = line else { return bad("a line names a vertex that was never told, or has more than are left") };
        self.spend(line.len() as u64)?;
        Ok(line)
    }
}

macro_rules! plain {
    ($($deserialize:ident $visit:ident $read:ident),*) => {$(
        fn $deserialize<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
            visitor.$visit(self.$read()?)
        }
    )*};
}

impl<'de> de::Deserializer<'de> for &mut Source<'_, '_> {
    type Error = Unread;

    fn is_human_readable(&self) -> bool {
        false
    }

    plain!(
        deserialize_bool visit_bool flag,
        deserialize_i8 visit_i8 signed,
        deserialize_i16 visit_i16 signed,
        deserialize_i32 visit_i32 signed,
        deserialize_i64 visit_i64 signed,
        deserialize_u8 visit_u8 unsigned,
        deserialize_u16 visit_u16 unsigned,
        deserialize_u32 visit_u32 unsigned,
        deserialize_u64 visit_u64 unsigned
    );

    fn deserialize_u128<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_u128(u128::from(self.raw(32)?) << 64 | u128::from(self.raw(64)?))
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_f32(f32::from_bits(self.raw(32)? as u32))
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_f64(f64::from_bits(self.raw(64)?))
    }

    fn deserialize_char<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        let value: u32 = self.unsigned()?;
        char::from_u32(value).map_or_else(|| bad("a letter is none"), |value| visitor.visit_char(value))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        self.deserialize_string(visitor)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        let count = self.count()?;
        // No memory for letters that may not come.
        let mut text = Vec::with_capacity(count.min(TEXT_AT_ONCE));
        let mut before = 0;
        for _ in 0..count {
            self.spend(1)?;
            before = self.models.letter(&mut self.bits, self.node, before, 0);
            text.push(before);
        }
        String::from_utf8(text).map_or_else(|_| bad("a text is none"), |text| visitor.visit_string(text))
    }

    fn deserialize_bytes<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        self.deserialize_byte_buf(visitor)
    }

    fn deserialize_byte_buf<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        let count = self.count()?;
        let bytes = (0..count).map(|_| Ok(self.raw(8)? as u8)).collect::<Result<_, Unread>>()?;
        visitor.visit_byte_buf(bytes)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        if self.flag()? { self.at(0, |source| visitor.visit_some(source)) } else { visitor.visit_none() }
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_unit()
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, name: &'static str, visitor: V) -> Result<V::Value, Unread> {
        if name != HANDMADE {
            return visitor.visit_newtype_struct(self);
        }
        self.models.handmade(true);
        let value = visitor.visit_newtype_struct(&mut *self)?;
        self.models.handmade(false);
        Ok(value)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        let left = self.count()?;
        self.at(0, |source| visitor.visit_seq(Elements { source, left }))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, count: usize, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_seq(Fields { source: self, next: 0, count })
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(self, _: &'static str, count: usize, visitor: V) -> Result<V::Value, Unread> {
        self.deserialize_tuple(count, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Unread> {
        bad("maps are not told")
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unread> {
        self.deserialize_tuple(fields.len(), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unread> {
        visitor.visit_enum(self)
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Unread> {
        bad("names are not told")
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Unread> {
        bad("nothing is told to be ignored")
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Unread> {
        bad("kinds of values are not told")
    }
}

struct Elements<'s, 'b, 'm> {
    source: &'s mut Source<'b, 'm>,
    left: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_, '_, '_> {
    type Error = Unread;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Unread> {
        let Some(left) = self.left.checked_sub(1) else { return Ok(None) };
        self.left = left;
        self.source.models.new_row();
        seed.deserialize(&mut *self.source).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left)
    }
}

struct Fields<'s, 'b, 'm> {
    source: &'s mut Source<'b, 'm>,
    next: usize,
    count: usize,
}

impl<'de> SeqAccess<'de> for Fields<'_, '_, '_> {
    type Error = Unread;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Unread> {
        if self.next == self.count {
            return Ok(None);
        }
        self.next += 1;
        self.source.at(self.next - 1, |source| seed.deserialize(source)).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.count - self.next)
    }
}

impl<'s, 'de, 'b, 'm> EnumAccess<'de> for &'s mut Source<'b, 'm> {
    type Error = Unread;
    type Variant = Of<'s, 'b, 'm>;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self::Variant), Unread> {
        let n: u32 = self.unsigned()?;
        let value = seed.deserialize(de::value::U32Deserializer::<Unread>::new(n))?;
        Ok((value, Of { source: self, n: n as usize }))
    }
}

/// A variant whose content follows.
pub(crate) struct Of<'s, 'b, 'm> {
    source: &'s mut Source<'b, 'm>,
    n: usize,
}

impl<'de> VariantAccess<'de> for Of<'_, '_, '_> {
    type Error = Unread;

    fn unit_variant(self) -> Result<(), Unread> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Unread> {
        self.source.at(self.n, |source| seed.deserialize(source))
    }

    fn tuple_variant<V: Visitor<'de>>(self, count: usize, visitor: V) -> Result<V::Value, Unread> {
        self.source.at(self.n, |source| visitor.visit_seq(Fields { source, next: 0, count }))
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: &'static [&'static str], visitor: V) -> Result<V::Value, Unread> {
        self.tuple_variant(fields.len(), visitor)
    }
}
