//! What pairs a reply with its request.
//! Never lives here: the order of replies, which is the connection's business.

use super::strict::exact_integer;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// The `id` of a request. A request with `null` is still a request; one without any is a notification.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Id {
    /// Of a request that says so, and of the reply to a line whose id could not be read.
    Null,
    /// Wide enough for every `i64` and every `u64`, and never outside both.
    Integer(i128),
    /// At most [`Id::LONGEST`] bytes.
    Text(String),
}

impl Id {
    /// Bytes of a textual id: room for a UUID and a prefix, little enough to keep one per request in flight.
    pub const LONGEST: usize = 64;

    const EXPECTED: &str = "an integer of 64 bits, a string of at most 64 bytes, or null";
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Integer(integer) => write!(f, "{integer}"),
            Self::Text(text) => write!(f, "{text:?}"),
        }
    }
}

impl From<u64> for Id {
    fn from(integer: u64) -> Self {
        Self::Integer(integer.into())
    }
}

impl Serialize for Id {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Null => serializer.serialize_unit(),
            Self::Integer(integer) => serializer.serialize_i128(*integer),
            Self::Text(text) => serializer.serialize_str(text),
        }
    }
}

impl<'de> Deserialize<'de> for Id {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(IdVisitor)
    }
}

impl JsonSchema for Id {
    fn schema_name() -> Cow<'static, str> {
        "Id".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "An integer of 64 bits, a string of at most 64 bytes, or null.",
            "type": ["integer", "string", "null"],
            "maxLength": Self::LONGEST,
        })
    }
}

struct IdVisitor;

impl Visitor<'_> for IdVisitor {
    type Value = Id;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(Id::EXPECTED)
    }

    fn visit_unit<E>(self) -> Result<Id, E> {
        Ok(Id::Null)
    }

    fn visit_i64<E>(self, integer: i64) -> Result<Id, E> {
        Ok(Id::Integer(integer.into()))
    }

    fn visit_u64<E>(self, integer: u64) -> Result<Id, E> {
        Ok(Id::Integer(integer.into()))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Id, E> {
        exact_integer(number)
            .map(|integer| Id::Integer(integer.into()))
            .ok_or_else(|| E::invalid_type(Unexpected::Float(number), &self))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Id, E> {
        if text.len() > Id::LONGEST {
            let found = format!("a string of {} bytes", text.len());
            return Err(E::invalid_value(Unexpected::Other(&found), &self));
        }
        Ok(Id::Text(text.to_owned()))
    }
}
