//! [`Blob`] as JSON, both ways, and its schema.
//! Never lives here: what a blob is for.

use super::attach::decode_base64;
use super::blob::{Blob, Body, Content, Dtype};
use base64_simd::{AsOut, STANDARD};
use bytes::Bytes;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

impl Serialize for Blob {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut members = serializer.serialize_map(None)?;
        let encoding = match &self.body {
            Body::Base64(_) => Encoding::Base64,
            Body::Json(_) => Encoding::Json,
            Body::Attach { .. } => Encoding::Attach,
        };
        members.serialize_entry("encoding", &encoding)?;
        match &self.content {
            Content::Media(media) => members.serialize_entry("media", media)?,
            Content::Array { dtype, shape } => {
                members.serialize_entry("dtype", dtype)?;
                members.serialize_entry("shape", shape)?;
            }
        }
        match &self.body {
            Body::Base64(bytes) => {
                members.serialize_entry("bytes", &bytes.len())?;
                members.serialize_entry("data", &InBase64(bytes))?;
            }
            Body::Json(bytes) => members.serialize_entry("data", &AsList(bytes, &self.content))?,
            Body::Attach { offset, bytes } => {
                members.serialize_entry("bytes", bytes)?;
                members.serialize_entry("offset", offset)?;
            }
        }
        members.end()
    }
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Encoding {
    Base64,
    Json,
    Attach,
}

/// The numbers of an array, decoded while they are written.
struct AsList<'a>(&'a [u8], &'a Content);

impl Serialize for AsList<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let words = self.0.as_chunks().0.iter().copied();
        match self.1 {
            Content::Array {
                dtype: Dtype::Float32,
                ..
            } => serializer.collect_seq(words.map(f32::from_le_bytes)),
            Content::Array {
                dtype: Dtype::Uint32,
                ..
            } => serializer.collect_seq(words.map(u32::from_le_bytes)),
            Content::Array {
                dtype: Dtype::Uint8,
                ..
            }
            | Content::Media(_) => serializer.collect_seq(self.0),
        }
    }
}

/// Encoded while it is written, so that there is no string of it beside the bytes and the line.
struct InBase64<'a>(&'a [u8]);

impl Serialize for InBase64<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl fmt::Display for InBase64<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Bytes at a time; whole threes, so that only the last text is padded.
        const PIECE: usize = 3 << 10;
        let mut text = [0u8; PIECE / 3 * 4];
        let mut pieces = self.0.chunks(PIECE);
        pieces.try_for_each(|piece| f.write_str(STANDARD.encode_as_str(piece, text[..].as_out())))
    }
}

impl<'de> Deserialize<'de> for Blob {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Members::deserialize(deserializer)?
            .into_blob()
            .map_err(D::Error::custom)
    }
}

#[derive(Deserialize)]
struct Members {
    encoding: Encoding,
    media: Option<String>,
    dtype: Option<Dtype>,
    shape: Option<Vec<u64>>,
    bytes: Option<u64>,
    offset: Option<u64>,
    data: Option<Data>,
}

impl Members {
    fn into_blob(self) -> Result<Blob, &'static str> {
        let content = match (self.media, self.dtype, self.shape) {
            (Some(media), None, None) => Content::Media(media.into()),
            (None, Some(dtype), Some(shape)) => Content::Array { dtype, shape },
            _ => return Err("a blob has either a `media` or a `dtype` with a `shape`"),
        };
        let body = match (self.encoding, self.data) {
            (Encoding::Base64, Some(Data::Text(bytes))) => Body::Base64(bytes.into()),
            (Encoding::Json, Some(Data::List(list))) => Body::Json(little_endian(list, &content)?),
            (Encoding::Attach, None) => Body::Attach {
                offset: self.offset.ok_or("an attached blob has an `offset`")?,
                bytes: self.bytes.ok_or("an attached blob has `bytes`")?,
            },
            _ => return Err("`data` is not what the blob's `encoding` says"),
        };
        Ok(Blob { content, body })
    }
}

fn little_endian(list: Vec<f64>, content: &Content) -> Result<Bytes, &'static str> {
    let list = list.into_iter();
    let words: Option<Vec<[u8; 4]>> = match content {
        Content::Array {
            dtype: Dtype::Float32,
            ..
        } => list
            .map(|number| Some((number as f32).to_le_bytes()))
            .collect(),
        Content::Array {
            dtype: Dtype::Uint32,
            ..
        } => list
            .map(|number| {
                let integer = number as u32;
                (f64::from(integer) == number).then_some(integer.to_le_bytes())
            })
            .collect(),
        _ => return Err("only arrays of float32 and uint32 come as a list"),
    };
    let words = words.ok_or("a number of the list is not a uint32")?;
    Ok(words.into_flattened().into())
}

enum Data {
    Text(Vec<u8>),
    /// Every float32 and uint32 is exact in a float64.
    List(Vec<f64>),
}

impl<'de> Deserialize<'de> for Data {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DataVisitor)
    }
}

struct DataVisitor;

impl<'de> Visitor<'de> for DataVisitor {
    type Value = Data;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a string in base64 or a list of numbers")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Data, E> {
        decode_base64(text).map(Data::Text).map_err(E::custom)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Data, A::Error> {
        let mut list = Vec::new();
        while let Some(number) = seq.next_element()? {
            list.push(number);
        }
        Ok(Data::List(list))
    }
}

impl JsonSchema for Blob {
    fn schema_name() -> Cow<'static, str> {
        "Blob".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let count = |description: &str| json_schema!({ "type": "integer", "minimum": 0, "description": description });
        let media = json_schema!({ "type": "string", "description": "The kind of file, e.g. `image/png`." });
        let dtype = |names: &[&str]| json_schema!({ "enum": names, "description": "What one number is; little-endian where it is bytes." });
        let any_dtype = dtype(&["uint8", "uint32", "float32"]);
        let shape = json_schema!({
            "type": "array",
            "items": { "type": "integer", "minimum": 0 },
            "description": "The lengths of the array, the slowest index first (C order).",
        });
        let bytes = count("Length of the content in bytes, before base64.");
        let offset =
            count("Where the content starts in the raw bytes that follow the reply's line.");
        let text = json_schema!({ "type": "string", "contentEncoding": "base64" });
        let list = json_schema!({ "type": "array", "items": { "type": "number" }, "description": "The numbers in a flat list." });
        let form = |encoding: &str, members: &[(&str, &Schema)]| {
            let mut properties = serde_json::Map::new();
            properties.insert("encoding".into(), serde_json::json!({ "const": encoding }));
            for (name, schema) in members {
                properties.insert((*name).into(), (*schema).clone().to_value());
            }
            let required: Vec<&str> = ["encoding"]
                .into_iter()
                .chain(members.iter().map(|member| member.0))
                .collect();
            json_schema!({
                "type": "object",
                "properties": properties,
                "required": required,
                "additionalProperties": false,
            })
        };
        json_schema!({
            "description": "A picture or an array, encoded as the request's `transport` asks.",
            "oneOf": [
                form("base64", &[("media", &media), ("bytes", &bytes), ("data", &text)]),
                form("base64", &[("dtype", &any_dtype), ("shape", &shape), ("bytes", &bytes), ("data", &text)]),
                form("json", &[("dtype", &dtype(&["uint32", "float32"])), ("shape", &shape), ("data", &list)]),
                form("attach", &[("media", &media), ("bytes", &bytes), ("offset", &offset)]),
                form("attach", &[("dtype", &any_dtype), ("shape", &shape), ("bytes", &bytes), ("offset", &offset)]),
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::blob::{ArrayTransport, Picture, PictureTransport};
    use crate::protocol::{Attachments, BlobError};
    use serde_json::json;

    fn floats(transport: ArrayTransport, attachments: &mut Attachments) -> Blob {
        let numbers = [0.1_f32, -1.0, 1e-7, 16_777_216.0].map(f32::to_le_bytes);
        let bytes = numbers.as_flattened().to_vec().into();
        Blob::array(Dtype::Float32, bytes, &[2, 2], transport, attachments)
    }

    #[test]
    fn blobs_look_as_the_contract_says() {
        let mut attachments = Attachments::default();
        let picture = Blob::picture(
            Picture::Png {
                width: 1,
                height: 1,
                file: vec![1, 2, 3].into(),
            },
            PictureTransport::Base64,
            &mut attachments,
        );
        assert_eq!(
            json!(picture),
            json!({"encoding": "base64", "media": "image/png", "bytes": 3, "data": "AQID"})
        );
        let pixels = Picture::Rgba8 {
            width: 2,
            height: 1,
            pixels: vec![0; 8].into(),
        };
        let bare = Blob::picture(pixels, PictureTransport::Attach, &mut attachments);
        assert_eq!(
            json!(bare),
            json!({"encoding": "attach", "dtype": "uint8", "shape": [1, 2, 4], "bytes": 8, "offset": 0})
        );
        // As text, since the digits matter.
        assert_eq!(
            serde_json::to_string(&floats(ArrayTransport::Json, &mut attachments)).unwrap(),
            r#"{"encoding":"json","dtype":"float32","shape":[2,2],"data":[0.1,-1.0,1e-7,16777216.0]}"#
        );
        assert_eq!(
            json!(floats(ArrayTransport::Attach, &mut attachments)),
            json!({"encoding": "attach", "dtype": "float32", "shape": [2, 2], "bytes": 16, "offset": 8})
        );
        assert_eq!(
            json!(floats(ArrayTransport::Base64, &mut attachments)),
            json!({"encoding": "base64", "dtype": "float32", "shape": [2, 2], "bytes": 16, "data": "zczMPQAAgL+Vv9YzAACASw=="})
        );
        assert_eq!(attachments.total_bytes(), 24);
    }

    #[test]
    fn the_content_is_the_same_however_it_travels() {
        use ArrayTransport::{Attach, Base64, Json};
        for transport in [Json, Base64, Attach] {
            let mut attachments = Attachments::default();
            attachments.push(vec![9; 5]);
            let sent = floats(transport, &mut attachments);
            let text = serde_json::to_string(&sent).unwrap();
            let blob: Blob = serde_json::from_str(&text).unwrap();
            let attached = attachments.to_bytes();
            assert_eq!(
                blob.floats(&attached).unwrap(),
                [0.1, -1.0, 1e-7, 16_777_216.0]
            );
            assert_eq!(blob.bytes(&attached).unwrap()[..4], 0.1_f32.to_le_bytes());
            assert_eq!(blob.shape(), Some(&[2, 2][..]));
            assert!(matches!(
                blob.integers(&attached),
                Err(BlobError::Other { .. })
            ));

            let numbers = [0, u32::MAX].map(u32::to_le_bytes).as_flattened().to_vec();
            let sent = Blob::array(
                Dtype::Uint32,
                numbers.into(),
                &[2],
                transport,
                &mut attachments,
            );
            let text = serde_json::to_string(&sent).unwrap();
            let blob: Blob = serde_json::from_str(&text).unwrap();
            let attached = attachments.to_bytes();
            assert_eq!(blob.integers(&attached).unwrap(), [0, u32::MAX]);
        }
    }

    #[test]
    fn a_blob_outside_of_what_came_is_an_error() {
        let mut attachments = Attachments::default();
        let blob = floats(ArrayTransport::Attach, &mut attachments);
        let expected = BlobError::OutOfReach {
            offset: 0,
            bytes: 16,
            attached: 15,
        };
        assert_eq!(blob.floats(&[0; 15]), Err(expected));
    }

    #[test]
    fn what_is_no_blob_is_refused() {
        for blob in [
            json!({"encoding": "base64", "bytes": 3, "data": "AQID"}),
            json!({"encoding": "base64", "media": "image/png", "dtype": "uint8", "shape": [3], "bytes": 3, "data": "AQID"}),
            json!({"encoding": "base64", "media": "image/png", "bytes": 3, "data": "A"}),
            json!({"encoding": "base64", "media": "image/png", "bytes": 3, "data": [1, 2, 3]}),
            json!({"encoding": "json", "dtype": "float32", "shape": [1], "data": "AQID"}),
            json!({"encoding": "json", "dtype": "uint32", "shape": [1], "data": [-1]}),
            json!({"encoding": "json", "dtype": "uint8", "shape": [1], "data": [1]}),
            json!({"encoding": "attach", "media": "image/png", "bytes": 3}),
            json!({"encoding": "gzip", "media": "image/png", "bytes": 3, "data": "AQID"}),
        ] {
            assert!(
                serde_json::from_value::<Blob>(blob.clone()).is_err(),
                "{blob}"
            );
        }
    }
}
