//! Pictures and arrays in a result, and the three ways in which they travel.
//! Never lives here: compressing pictures, and writing what is attached.

use super::attach::Attachments;
use bytes::Bytes;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// How a picture travels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PictureTransport {
    /// As a string inside the reply.
    #[default]
    Base64,
    /// As raw bytes after the reply's line.
    Attach,
}

/// How an array travels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArrayTransport {
    /// As a flat list of numbers inside the reply.
    #[default]
    Json,
    /// As a string inside the reply: the bytes of the array, little-endian.
    Base64,
    /// As raw bytes after the reply's line, little-endian.
    Attach,
}

/// A picture, ready to travel.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// A whole PNG file.
    Png {
        /// Pixels to a row, as the file says as well.
        width: u32,
        /// Number of rows, as the file says as well.
        height: u32,
        /// All bytes of the file, its signature included.
        file: Bytes,
    },
    /// `4 * width * height` bytes, rows from the top: sRGB, straight alpha.
    Rgba8 {
        /// Pixels to a row.
        width: u32,
        /// Number of rows.
        height: u32,
        /// Red, green, blue and alpha of each pixel, a byte each; rows follow one another without padding.
        pixels: Bytes,
    },
}

impl Picture {
    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Png { width, height, .. } | Self::Rgba8 { width, height, .. } => {
                [*width, *height]
            }
        }
    }

    /// Length of its content.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Png { file: bytes, .. } | Self::Rgba8 { pixels: bytes, .. } => bytes.len(),
        }
    }
}

/// A picture or an array of a result. It keeps what it was given and is written out piece by piece, so that nothing large is held twice.
#[derive(Debug, Clone, PartialEq)]
pub struct Blob {
    pub(super) content: Content,
    pub(super) body: Body,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    Media(Cow<'static, str>),
    Array { dtype: Dtype, shape: Vec<u64> },
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Body {
    Base64(Bytes),
    /// Bytes of an array, little-endian, that travel as a list of its numbers.
    Json(Bytes),
    Attach {
        offset: u64,
        bytes: u64,
    },
}

/// What one number of an array is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dtype {
    /// One byte, from 0 to 255: what the pixels of an `rgba8` picture consist of.
    Uint8,
    /// Four bytes, unsigned: indices of vertices.
    Uint32,
    /// Four bytes, IEEE 754: positions, normals, texture coordinates and matrices.
    Float32,
}

/// Why the content of a [`Blob`] cannot be had.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BlobError {
    /// The blob is attached, and the bytes given as those that followed the reply do not reach to its end.
    #[error(
        "the blob lies at {offset}..{offset}+{bytes}, but {attached} bytes came with the reply"
    )]
    OutOfReach {
        /// Where the blob starts, counted from the first byte after the reply's line.
        offset: u64,
        /// Length of the blob.
        bytes: u64,
        /// Length of the bytes that were given.
        attached: u64,
    },
    /// The blob is a file, an array of other numbers, or of a length that does not come out at whole numbers.
    #[error("expected {expected}, but the blob holds {found}")]
    Other {
        /// The array that was asked for, e.g. `an array of float32`.
        expected: &'static str,
        /// Media type of the file, or length in bytes and type of the array.
        found: String,
    },
}

impl Blob {
    /// What is to be attached goes into `attachments`.
    pub fn picture(
        picture: Picture,
        transport: PictureTransport,
        attachments: &mut Attachments,
    ) -> Self {
        let (content, bytes) = match picture {
            Picture::Png { file, .. } => (Content::Media("image/png".into()), file),
            Picture::Rgba8 {
                width,
                height,
                pixels,
            } => {
                let shape = vec![height.into(), width.into(), 4];
                let dtype = Dtype::Uint8;
                (Content::Array { dtype, shape }, pixels)
            }
        };
        let body = match transport {
            PictureTransport::Base64 => Body::Base64(bytes),
            PictureTransport::Attach => Body::attached(bytes, attachments),
        };
        Self { content, body }
    }

    /// `bytes` are the numbers in C order, little-endian; `shape` is that of the array, the slowest index first. What is to be attached
    /// goes into `attachments`.
    pub fn array(
        dtype: Dtype,
        bytes: Bytes,
        shape: &[usize],
        transport: ArrayTransport,
        attachments: &mut Attachments,
    ) -> Self {
        let shape = shape.iter().map(|length| *length as u64).collect();
        let body = match transport {
            ArrayTransport::Json => Body::Json(bytes),
            ArrayTransport::Base64 => Body::Base64(bytes),
            ArrayTransport::Attach => Body::attached(bytes, attachments),
        };
        let content = Content::Array { dtype, shape };
        Self { content, body }
    }

    /// `None` for a file such as a PNG.
    pub fn shape(&self) -> Option<&[u64]> {
        match &self.content {
            Content::Media(_) => None,
            Content::Array { shape, .. } => Some(shape),
        }
    }

    /// `None` for a file such as a PNG.
    pub fn dtype(&self) -> Option<Dtype> {
        match &self.content {
            Content::Media(_) => None,
            Content::Array { dtype, .. } => Some(*dtype),
        }
    }

    /// `None` for an array.
    pub fn media(&self) -> Option<&str> {
        match &self.content {
            Content::Media(media) => Some(media),
            Content::Array { .. } => None,
        }
    }

    /// The content as bytes (of an array: little-endian), however it came. `attached` is what followed the reply's line.
    ///
    /// # Errors
    /// [`BlobError::OutOfReach`] where the reply brought less than the blob says.
    pub fn bytes<'a>(&'a self, attached: &'a [u8]) -> Result<Cow<'a, [u8]>, BlobError> {
        match &self.body {
            Body::Base64(bytes) | Body::Json(bytes) => Ok(bytes.as_ref().into()),
            Body::Attach { offset, bytes } => usize::try_from(*offset)
                .ok()
                .zip(usize::try_from(*bytes).ok())
                .and_then(|(start, length)| attached.get(start..start.checked_add(length)?))
                .map(Cow::from)
                .ok_or(BlobError::OutOfReach {
                    offset: *offset,
                    bytes: *bytes,
                    attached: attached.len() as u64,
                }),
        }
    }

    /// The numbers of a float32 array, in C order, however they came.
    ///
    /// # Errors
    /// As [`Blob::bytes`], and [`BlobError::Other`] where the blob is something else.
    pub fn floats(&self, attached: &[u8]) -> Result<Vec<f32>, BlobError> {
        self.words(Dtype::Float32, attached, f32::from_le_bytes)
    }

    /// The numbers of a uint32 array, in C order, however they came.
    ///
    /// # Errors
    /// As [`Blob::floats`].
    pub fn integers(&self, attached: &[u8]) -> Result<Vec<u32>, BlobError> {
        self.words(Dtype::Uint32, attached, u32::from_le_bytes)
    }

    fn words<T>(
        &self,
        dtype: Dtype,
        attached: &[u8],
        from_bytes: fn([u8; 4]) -> T,
    ) -> Result<Vec<T>, BlobError> {
        let bytes = self.bytes(attached)?;
        let (words, rest) = bytes.as_chunks();
        if self.dtype() != Some(dtype) || !rest.is_empty() {
            let found = match &self.content {
                Content::Media(media) => media.clone().into_owned(),
                Content::Array { dtype, .. } => format!("{} bytes of {dtype:?}", bytes.len()),
            };
            let expected = match dtype {
                Dtype::Uint8 => "an array of uint8",
                Dtype::Uint32 => "an array of uint32",
                Dtype::Float32 => "an array of float32",
            };
            return Err(BlobError::Other { expected, found });
        }
        Ok(words.iter().copied().map(from_bytes).collect())
    }
}

impl Body {
    fn attached(bytes: Bytes, attachments: &mut Attachments) -> Self {
        let length = bytes.len() as u64;
        Self::Attach {
            offset: attachments.push(bytes),
            bytes: length,
        }
    }
}
