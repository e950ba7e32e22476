//! Raw bytes beside a line: what a request refers to, and what a reply collects.
//! Never lives here: reading and writing them, and the limit on how many there may be.

use super::field::{FieldFault, FieldPath};
use base64_simd::STANDARD;
use bytes::Bytes;
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// A stretch of the raw bytes that follow the request's line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Attach {
    /// Where it starts, counted from the first byte after the line's end.
    pub offset: u64,
    /// How long it is.
    pub bytes: u64,
}

impl Attach {
    /// The stretch itself.
    ///
    /// # Errors
    /// Where the request did not bring that many bytes.
    pub fn of<'a>(&self, attached: &'a [u8]) -> Result<&'a [u8], FieldFault> {
        usize::try_from(self.offset)
            .ok()
            .zip(usize::try_from(self.bytes).ok())
            .and_then(|(start, length)| attached.get(start..start.checked_add(length)?))
            .ok_or_else(|| {
                let Self { offset, bytes } = self;
                let length = attached.len();
                FieldFault::new(
                    FieldPath::default(),
                    format!("expected a part of the {length} attached bytes, but found {bytes} bytes from {offset}"),
                )
            })
    }
}

/// Raw bytes beside a reply, in the order in which its blobs were made. Nothing is copied into one piece.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Attachments {
    parts: Vec<Bytes>,
    total_bytes: u64,
}

impl Attachments {
    /// The offset at which a reader finds these bytes, counted from the first byte of the first part.
    pub fn push(&mut self, part: impl Into<Bytes>) -> u64 {
        let (part, offset) = (part.into(), self.total_bytes);
        self.total_bytes += part.len() as u64;
        self.parts.push(part);
        offset
    }

    /// Length of all parts together: the `attach_bytes` of the reply's line.
    pub fn total_bytes(&self) -> u64 {
        self.total_bytes
    }

    /// In the order in which they were pushed, which is the order in which they follow the reply's line.
    pub fn into_parts(self) -> Vec<Bytes> {
        self.parts
    }

    /// A copy in one piece.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.parts.concat()
    }
}

/// Bytes that travel as base64 (RFC 4648, padded).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Base64(pub Vec<u8>);

impl Serialize for Base64 {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&STANDARD.encode_to_string(&self.0))
    }
}

impl<'de> Deserialize<'de> for Base64 {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_str(Base64Visitor)
    }
}

impl JsonSchema for Base64 {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Base64".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "string", "contentEncoding": "base64" })
    }
}

/// RFC 4648, padded.
pub(super) fn decode_base64(text: &str) -> Result<Vec<u8>, String> {
    STANDARD.decode_to_vec(text).map_err(|_| {
        let foreign = |byte: &u8| !byte.is_ascii_alphanumeric() && !b"+/=".contains(byte);
        let fault = match text.as_bytes().iter().position(foreign) {
            Some(at) => format!("byte {} is none of its characters", at + 1),
            None => "it ends too early, or not as its padding says".to_owned(),
        };
        format!("expected a string in base64, but found one with a fault: {fault}")
    })
}

struct Base64Visitor;

impl Visitor<'_> for Base64Visitor {
    type Value = Base64;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a string in base64")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Base64, E> {
        // The text itself is not repeated in the message: it may be megabytes.
        decode_base64(text).map(Base64).map_err(E::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_is_taken_only_from_within_what_came() {
        let attached = b"abcdef";
        let of = |offset, bytes| Attach { offset, bytes }.of(attached);
        assert_eq!(of(0, 6), Ok(&b"abcdef"[..]));
        assert_eq!(of(2, 3), Ok(&b"cde"[..]));
        assert_eq!(of(6, 0), Ok(&b""[..]));
        for (offset, bytes) in [(0, 7), (6, 1), (7, 0), (u64::MAX, 1), (1, u64::MAX)] {
            let fault = of(offset, bytes).unwrap_err();
            let wanted = format!(
                "params: expected a part of the 6 attached bytes, but found {bytes} bytes from {offset}"
            );
            assert_eq!(fault.to_string(), wanted);
        }
    }

    #[test]
    fn parts_lie_one_after_another() {
        let mut attachments = Attachments::default();
        assert_eq!(attachments.push(vec![1, 2, 3]), 0);
        assert_eq!(attachments.push(vec![]), 3);
        assert_eq!(attachments.push(vec![4]), 3);
        assert_eq!(attachments.total_bytes(), 4);
        assert_eq!(attachments.to_bytes(), [1, 2, 3, 4]);
    }
}
