//! Holds JSON to what the schemas say where serde alone would let more through, and says in which field it does not hold.
//! Never lives here: the types.
//!
//! serde's derives take a list for a struct, an object for a unit variant, a repeated key in a map, and forget the path of a list that
//! is too long. All four are refused here, and an unknown name gets its nearest known one. One thing is let through that serde refuses:
//! JSON has one kind of number, so an integer may be written `256.0` or `1e2`.

mod members;
mod mismatch;

pub(super) use mismatch::{expected_but_found, field_error, of_syntax, unknown_field};

use super::field::{FieldFault, FieldPath};
use members::Members;
use mismatch::{Detour, Mismatch, OneOf};
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error, Expected, IgnoredAny, MapAccess,
    SeqAccess, Unexpected, Visitor,
};
use std::fmt;

/// From JSON to a type.
///
/// # Errors
/// With the path of the field at fault, as seen from the value.
pub(super) fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, FieldFault> {
    let detour = Detour::default();
    let strict = Strict {
        inner: &mut serde_json::Deserializer::from_str(text),
        detour: &detour,
    };
    T::deserialize(strict).map_err(Mismatch::into_fault)
}

/// A deserializer that is stricter than the one inside. That one is only ever asked for whatever there is, so that all but faults of the
/// text itself are found here.
struct Strict<'s, D> {
    inner: D,
    detour: &'s Detour,
}

impl<'de, 's, D: Deserializer<'de>> Strict<'s, D> {
    fn read<V: Visitor<'de>>(self, rule: Rule, visitor: V) -> Result<V::Value, Mismatch> {
        let detour = self.detour;
        let ruled = Ruled {
            visitor,
            rule,
            detour,
        };
        let read = self.inner.deserialize_any(ruled);
        read.map_err(|error| detour.leave(&error))
    }
}

macro_rules! integers {
    ($($method:ident: $type:ty,)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
            let (least, most) = (<$type>::MIN.into(), <$type>::MAX.into());
            self.read(Rule::Integer { least, most }, visitor)
        })*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<'_, D> {
    type Error = Mismatch;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        self.read(Rule::Anything, visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let detour = self.detour;
        let ruled = Ruled {
            visitor,
            rule: Rule::Anything,
            detour,
        };
        let read = self.inner.deserialize_option(ruled);
        read.map_err(|error| detour.leave(&error))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        let fields = Some(fields);
        self.read(Rule::Object { fields }, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let fields = None;
        self.read(Rule::Object { fields }, visitor)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let length = None;
        self.read(Rule::List { length }, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        let length = Some(length);
        self.read(Rule::List { length }, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mismatch> {
        self.read(Rule::Word { variants }, visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        self.read(Rule::Number, visitor)
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

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mismatch> {
        let detour = self.detour;
        let read = self.inner.deserialize_ignored_any(visitor);
        read.map_err(|error| detour.leave(&error))
    }

    serde::forward_to_deserialize_any! {
        bool i128 u128 f32 char str string bytes byte_buf
        unit unit_struct newtype_struct tuple_struct identifier
    }
}

/// What a value has to be before a type's own visitor sees it.
#[derive(Clone, Copy)]
enum Rule {
    Anything,
    /// With these fields and no others, where they are known.
    Object {
        fields: Option<&'static [&'static str]>,
    },
    List {
        length: Option<usize>,
    },
    Word {
        variants: &'static [&'static str],
    },
    Number,
    Integer {
        least: i128,
        most: i128,
    },
}

impl Expected for Rule {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Anything => f.write_str("a value"),
            Self::Object { .. } => f.write_str("an object"),
            Self::List { length: None } => f.write_str("a list"),
            Self::List {
                length: Some(length),
            } => write!(f, "a list of {length}"),
            Self::Word { variants } => write!(f, "{}", OneOf(variants)),
            Self::Number => f.write_str("a number"),
            Self::Integer { least, most } => write!(f, "an integer from {least} to {most}"),
        }
    }
}

/// Shows a visitor what the rule lets through. Everything inside is held to its own rule.
struct Ruled<'s, V> {
    visitor: V,
    rule: Rule,
    detour: &'s Detour,
}

impl<'de, V: Visitor<'de>> Ruled<'_, V> {
    fn boolean(self, value: bool) -> Result<V::Value, Mismatch> {
        match self.rule {
            Rule::Anything => self.visitor.visit_bool(value),
            rule => Err(Error::invalid_type(Unexpected::Bool(value), &rule)),
        }
    }

    fn signed(self, integer: i64) -> Result<V::Value, Mismatch> {
        match self.rule {
            Rule::Anything | Rule::Number => {}
            Rule::Integer { least, most } if (least..=most).contains(&integer.into()) => {}
            rule => return Err(Error::invalid_type(Unexpected::Signed(integer), &rule)),
        }
        self.visitor.visit_i64(integer)
    }

    fn unsigned(self, integer: u64) -> Result<V::Value, Mismatch> {
        match self.rule {
            Rule::Anything | Rule::Number => {}
            Rule::Integer { least, most } if (least..=most).contains(&integer.into()) => {}
            rule => return Err(Error::invalid_type(Unexpected::Unsigned(integer), &rule)),
        }
        self.visitor.visit_u64(integer)
    }

    fn float(self, number: f64) -> Result<V::Value, Mismatch> {
        let found = Unexpected::Float(number);
        let (least, most) = match self.rule {
            Rule::Anything | Rule::Number => return self.visitor.visit_f64(number),
            Rule::Integer { least, most } => (least, most),
            rule => return Err(Error::invalid_type(found, &rule)),
        };
        let is_inside = |integer: i128| (least..=most).contains(&integer);
        match exact_integer(number) {
            Some(integer) if is_inside(integer.into()) => self.visitor.visit_i64(integer),
            None if number.fract() == 0.0 && is_inside(number as i128) => {
                let plainly =
                    "an integer of 2^53 or more to be written without fraction or exponent";
                Err(Error::invalid_value(found, &plainly))
            }
            _ => Err(Error::invalid_value(found, &self.rule)),
        }
    }

    fn string(self, text: &str) -> Result<V::Value, Mismatch> {
        match self.rule {
            Rule::Anything => self.visitor.visit_str(text),
            Rule::Word { variants } if variants.contains(&text) => {
                self.visitor.visit_enum(StrDeserializer::new(text))
            }
            rule => Err(Error::invalid_type(Unexpected::Str(text), &rule)),
        }
    }

    fn nothing(self) -> Result<V::Value, Mismatch> {
        match self.rule {
            Rule::Anything => self.visitor.visit_unit(),
            rule => Err(Error::invalid_type(Unexpected::Unit, &rule)),
        }
    }

    fn list<A: SeqAccess<'de>>(self, elements: A) -> Result<V::Value, Mismatch> {
        let length = match self.rule {
            Rule::Anything => None,
            Rule::List { length } => length,
            rule => return Err(Error::invalid_type(Unexpected::Seq, &rule)),
        };
        let mut elements = Elements {
            elements,
            taken: 0,
            is_at_end: false,
            detour: self.detour,
        };
        let read = self.visitor.visit_seq(&mut elements);
        let Some(length) = length else { return read };
        let (taken, is_at_end) = (elements.taken, elements.is_at_end);
        if is_at_end && taken < length {
            let message = format!("expected a list of {length}, but found only {taken}");
            return Err(Mismatch::new(message));
        }
        let read = read?;
        if elements.next_element::<IgnoredAny>()?.is_some() {
            let message = format!("expected a list of {length}, but found more");
            return Err(Mismatch::new(message));
        }
        Ok(read)
    }

    fn object<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, Mismatch> {
        let fields = match self.rule {
            Rule::Anything => None,
            Rule::Object { fields } => fields,
            rule => return Err(Error::invalid_type(Unexpected::Map, &rule)),
        };
        self.visitor
            .visit_map(Members::new(members, fields, self.detour))
    }
}

macro_rules! visit {
    ($($visit:ident: $type:ty => $method:ident,)*) => {
        $(fn $visit<E: Error>(self, value: $type) -> Result<V::Value, E> {
            let detour = self.detour;
            self.$method(value).map_err(|mismatch| detour.enter(mismatch))
        })*
    };
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Ruled<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.visitor.expecting(f)
    }

    visit! {
        visit_bool: bool => boolean,
        visit_i64: i64 => signed,
        visit_u64: u64 => unsigned,
        visit_f64: f64 => float,
        visit_str: &str => string,
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        let detour = self.detour;
        self.nothing().map_err(|mismatch| detour.enter(mismatch))
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        let detour = self.detour;
        let visited = self.visitor.visit_none();
        visited.map_err(|mismatch| detour.enter(mismatch))
    }

    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        let detour = self.detour;
        let visited = self.visitor.visit_some(Strict { inner, detour });
        visited.map_err(|mismatch| detour.enter(mismatch))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, elements: A) -> Result<V::Value, A::Error> {
        let detour = self.detour;
        let visited = self.list(elements);
        visited.map_err(|mismatch| detour.enter(mismatch))
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        let detour = self.detour;
        let visited = self.object(members);
        visited.map_err(|mismatch| detour.enter(mismatch))
    }
}

/// The integer that a number with a fraction or an exponent stands for. From 2^53 on float64 has no longer one for each, so that the number
/// may have been another one in the text.
pub(super) fn exact_integer(number: f64) -> Option<i64> {
    const FIRST_INEXACT: f64 = (1_u64 << 53) as f64;
    (number.fract() == 0.0 && number.abs() < FIRST_INEXACT).then_some(number as i64)
}

/// What is inside is held to its own rule.
struct Inside<'s, S> {
    seed: S,
    detour: &'s Detour,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Inside<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        let detour = self.detour;
        let read = self.seed.deserialize(Strict { inner, detour });
        read.map_err(|mismatch| detour.enter(mismatch))
    }
}

struct Elements<'s, A> {
    elements: A,
    taken: usize,
    is_at_end: bool,
    detour: &'s Detour,
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Elements<'_, A> {
    type Error = Mismatch;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Mismatch> {
        let detour = self.detour;
        let next = self.elements.next_element_seed(Inside { seed, detour });
        let here = || FieldPath::default().index(self.taken);
        let next = next.map_err(|error| detour.leave(&error).within(here()))?;
        match &next {
            Some(_) => self.taken += 1,
            None => self.is_at_end = true,
        }
        Ok(next)
    }

    fn size_hint(&self) -> Option<usize> {
        self.elements.size_hint()
    }
}
