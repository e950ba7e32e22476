//! Holds JSON to what the schemas say where serde alone would let more through.
//! Never lives here: the types, and the path of a fault (`parse` adds it around this).
//!
//! serde's derives take a list for a struct, an object for a unit variant, a repeated key in a map, and forget the path of a list that
//! is too long. All four are refused here, and an unknown name gets its nearest known one. One thing is let through that serde refuses:
//! JSON has one kind of number, so an integer may be written `256.0` or `1e2`.

use super::field::shortened;
use crate::spelling::nearest;
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor,
};
use std::collections::BTreeSet;
use std::fmt;

/// A deserializer that is stricter than the one inside.
pub(super) struct Strict<D>(pub D);

macro_rules! integers {
    ($($method:ident: $type:ty,)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            let (least, most) = (<$type>::MIN.into(), <$type>::MAX.into());
            self.0.$method(Integer { visitor, least, most })
        })*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_any(Nested(visitor))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_option(Nested(visitor))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let known = Some(fields);
        self.0.deserialize_map(Object { visitor, known })
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let known = None;
        self.0.deserialize_map(Object { visitor, known })
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let length = None;
        self.0.deserialize_seq(List { visitor, length })
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let length = Some(length);
        self.0.deserialize_seq(List { visitor, length })
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_str(Word { visitor, variants })
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_f64(Number(visitor))
    }

    integers! {
        deserialize_i8: i8,
        deserialize_i16: i16,
        deserialize_i32: i32,
        deserialize_i64: i64,
        deserialize_u8: u8,
        deserialize_u16: u16,
        deserialize_u32: u32,
        deserialize_u64: u64,
    }

    serde::forward_to_deserialize_any! {
        bool i128 u128 f32 char str string bytes byte_buf
        unit unit_struct newtype_struct tuple_struct identifier ignored_any
    }
}

/// The members of an object that a visitor found where it allows others too, held to the names of `T`.
pub(super) fn object<'de, T, A>(members: A) -> Result<T, A::Error>
where
    T: serde::Deserialize<'de>,
    A: MapAccess<'de>,
{
    T::deserialize(Members(members))
}

struct Members<A>(A);

impl<'de, A: MapAccess<'de>> Deserializer<'de> for Members<A> {
    type Error = A::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, A::Error> {
        visitor.visit_map(Keys::new(self.0, None))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        visitor.visit_map(Keys::new(self.0, Some(fields)))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

/// Passes on what it sees, with everything inside held to the same rules.
struct Nested<V>(V);

macro_rules! pass_on {
    ($($method:ident: $type:ty,)*) => {
        $(fn $method<E: Error>(self, value: $type) -> Result<V::Value, E> {
            self.0.$method(value)
        })*
    };
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Nested<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.expecting(f)
    }

    pass_on! {
        visit_bool: bool,
        visit_i64: i64,
        visit_u64: u64,
        visit_f64: f64,
        visit_str: &str,
        visit_borrowed_str: &'de str,
        visit_string: String,
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_none()
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        self.0.visit_some(Strict(inner))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<V::Value, A::Error> {
        self.0.visit_seq(Elements(seq))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(Keys::new(map, None))
    }
}

struct Object<V> {
    visitor: V,
    known: Option<&'static [&'static str]>,
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Object<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.visitor.visit_map(Keys::new(map, self.known))
    }
}

struct List<V> {
    visitor: V,
    length: Option<usize>,
}

impl<'de, V: Visitor<'de>> Visitor<'de> for List<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.length {
            Some(length) => write!(f, "a list of {length}"),
            None => f.write_str("a list"),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<V::Value, A::Error> {
        let value = self.visitor.visit_seq(Elements(&mut seq))?;
        if let Some(length) = self.length
            && seq.next_element::<IgnoredAny>()?.is_some()
        {
            return Err(Error::custom(format_args!(
                "expected a list of {length}, but found more"
            )));
        }
        Ok(value)
    }
}

struct Word<V> {
    visitor: V,
    variants: &'static [&'static str],
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Word<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&one_of(self.variants))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<V::Value, E> {
        if !self.variants.contains(&word) {
            return Err(E::invalid_value(Unexpected::Str(word), &self));
        }
        self.visitor.visit_enum(StrDeserializer::new(word))
    }
}

struct Number<V>(V);

impl<'de, V: Visitor<'de>> Visitor<'de> for Number<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    pass_on! {
        visit_i64: i64,
        visit_u64: u64,
        visit_f64: f64,
    }
}

struct Integer<V> {
    visitor: V,
    least: i128,
    most: i128,
}

impl<V> Integer<V> {
    fn has(&self, integer: impl Into<i128>) -> bool {
        (self.least..=self.most).contains(&integer.into())
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Integer<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "an integer from {} to {}", self.least, self.most)
    }

    fn visit_u64<E: Error>(self, integer: u64) -> Result<V::Value, E> {
        if !self.has(integer) {
            return Err(E::invalid_value(Unexpected::Unsigned(integer), &self));
        }
        self.visitor.visit_u64(integer)
    }

    fn visit_i64<E: Error>(self, integer: i64) -> Result<V::Value, E> {
        if !self.has(integer) {
            return Err(E::invalid_value(Unexpected::Signed(integer), &self));
        }
        self.visitor.visit_i64(integer)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<V::Value, E> {
        let found = Unexpected::Float(number);
        match exact_integer(number) {
            Some(integer) if self.has(integer) => self.visitor.visit_i64(integer),
            None if number.fract() == 0.0 && self.has(number as i128) => {
                let plainly =
                    "an integer of 2^53 or more to be written without fraction or exponent";
                Err(E::invalid_value(found, &plainly))
            }
            _ => Err(E::invalid_value(found, &self)),
        }
    }
}

/// The integer that a number with a fraction or an exponent stands for. From 2^53 on float64 has no longer one for each, so that the number
/// may have been another one in the text.
pub(super) fn exact_integer(number: f64) -> Option<i64> {
    const FIRST_INEXACT: f64 = (1_u64 << 53) as f64;
    (number.fract() == 0.0 && number.abs() < FIRST_INEXACT).then_some(number as i64)
}

/// What is inside is held to the same rules.
struct Inside<S>(S);

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Inside<S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        self.0.deserialize(Strict(inner))
    }
}

struct Elements<A>(A);

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Elements<A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.0.next_element_seed(Inside(seed))
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

/// Members whose keys are each seen once and, where the names are known, are among them.
struct Keys<A> {
    members: A,
    known: Option<&'static [&'static str]>,
    seen: BTreeSet<String>,
}

impl<A> Keys<A> {
    fn new(members: A, known: Option<&'static [&'static str]>) -> Self {
        let seen = BTreeSet::new();
        Self {
            members,
            known,
            seen,
        }
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Keys<A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.members.next_key_seed(Key {
            seed,
            known: self.known,
            seen: &mut self.seen,
        })
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.members.next_value_seed(Inside(seed))
    }
}

struct Key<'a, S> {
    seed: S,
    known: Option<&'static [&'static str]>,
    seen: &'a mut BTreeSet<String>,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Key<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        inner.deserialize_str(self)
    }
}

impl<'de, S: DeserializeSeed<'de>> Visitor<'de> for Key<'_, S> {
    type Value = S::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<S::Value, E> {
        // The seed goes first even where the key is refused: what tracks the path learns the key from it.
        let value = self.seed.deserialize(StrDeserializer::new(key));
        if let Some(known) = self.known
            && !known.contains(&key)
        {
            return Err(E::custom(unknown_field(key, known)));
        }
        if !self.seen.insert(key.to_owned()) {
            return Err(E::custom("the key is given twice"));
        }
        value
    }
}

/// The sentence about a name that is none of the known ones.
pub(super) fn unknown_field(name: &str, known: &[&str]) -> String {
    let hint = match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => "there are no fields here".to_owned(),
        None => format!("expected {}", one_of(known)),
    };
    format!("unknown field `{}`; {hint}", shortened(name).escape_debug())
}

fn one_of(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.as_slice() {
        [] => "nothing".to_owned(),
        [only] => only.clone(),
        all => format!("one of {}", all.join(", ")),
    }
}
