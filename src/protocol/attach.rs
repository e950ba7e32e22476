//! Raw bytes beside a line: what a request refers to, and what a reply collects.
//! Never lives here: reading and writing them, and the limit on how many there may be.

use super::blob::Numbers;
use super::field::{FieldFault, FieldPath};
use base64_simd::STANDARD;
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::Deref;

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

/// Bytes, in the memory in which they were made.
pub enum Part {
    Bytes(Vec<u8>),
    /// Of a machine whose numbers are little-endian.
    Numbers(Numbers),
    /// The same, in memory that is somebody else's.
    Lent(Box<dyn Floats>),
}

/// Numbers of float32, wherever they lie.
pub trait Floats: Send + Sync {
    fn floats(&self) -> &[f32];
}

impl<T: Deref<Target = [f32]> + Send + Sync> Floats for T {
    fn floats(&self) -> &[f32] {
        self
    }
}

impl Part {
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Numbers(Numbers::Float32(numbers)) => bytemuck::cast_slice(numbers),
            Self::Numbers(Numbers::Uint32(numbers)) => bytemuck::cast_slice(numbers),
            Self::Lent(numbers) => bytemuck::cast_slice(numbers.floats()),
        }
    }

    pub fn into_bytes(self) -> Vec<u8> {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Numbers(_) | Self::Lent(_) => self.bytes().to_vec(),
        }
    }
}

impl fmt::Debug for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes", self.bytes().len())
    }
}

impl Clone for Part {
    fn clone(&self) -> Self {
        Self::Bytes(self.bytes().to_vec())
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.bytes() == other.bytes()
    }
}

impl Default for Part {
    fn default() -> Self {
        Self::Bytes(Vec::new())
    }
}

impl From<Vec<u8>> for Part {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Bytes(bytes)
    }
}

impl From<Numbers> for Part {
    fn from(numbers: Numbers) -> Self {
        if cfg!(target_endian = "little") {
            Self::Numbers(numbers)
        } else {
            Self::Bytes(numbers.little_endian())
        }
    }
}

/// Raw bytes that will follow a reply's line, in the order in which its blobs were made. Nothing is copied into one piece.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attachments {
    parts: Vec<Part>,
    total: u64,
}

impl Attachments {
    /// The offset at which a reader will find these bytes.
    pub fn push(&mut self, part: impl Into<Part>) -> u64 {
        let (part, offset) = (part.into(), self.total);
        self.total += part.bytes().len() as u64;
        self.parts.push(part);
        offset
    }

    /// The `attach_bytes` of the line.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// To be written one after another, right after the line.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    pub fn into_parts(self) -> Vec<Part> {
        self.parts
    }

    /// A copy in one piece.
    pub fn to_bytes(&self) -> Vec<u8> {
        let parts: Vec<&[u8]> = self.parts.iter().map(Part::bytes).collect();
        parts.concat()
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
        assert_eq!(attachments.total(), 4);
        assert_eq!(attachments.to_bytes(), [1, 2, 3, 4]);
    }
}
