//! Bytes that a document refers to: buffers and their views, inside it, in other files, in data URIs.
//! Never lives here: what the bytes mean.

use super::bytes::Bytes;
use super::container::Container;
use super::extensions;
use super::fault::Faults;
use crate::formats::error::{FileFault, LoadError, quoted};
use crate::formats::files::{Files, Gathered};
use crate::formats::source::Denied;
use crate::rig::Warnings;
use gltf_json::validation::USize64;
use gltf_json::{Buffer, Index, Root, buffer};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A view of a buffer.
#[derive(Debug, Clone)]
pub(super) struct View<'a> {
    /// A compressed view is decoded into bytes of its own before anyone sees it.
    pub bytes: Bytes<'a>,
    /// How far its elements are apart, where it says so.
    pub stride: Option<usize>,
}

/// Every buffer of a document: as long as it says at least, or why it cannot be had. Only one that is read has to be there.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    faults: Faults<'a>,
    buffers: Vec<Result<Bytes<'a>, FileFault>>,
    size: u64,
}

impl<'a> Buffers<'a> {
    /// # Errors
    /// Where files are too large together, or one cannot be read.
    pub(super) fn gather(
        faults: Faults<'a>,
        container: &Container<'a>,
        from: &Gathered,
        files: &mut Files<'_>,
        warnings: &mut Warnings,
    ) -> Result<Self, LoadError> {
        let mut buffers = Vec::with_capacity(container.root.buffers.len());
        for (index, buffer) in container.root.buffers.iter().enumerate() {
            let path = format!("buffers[{index}]");
            let binary = container.binary.filter(|_| index == 0);
            let bytes = match bytes_of(faults, &path, buffer, binary, from, files, warnings) {
                Ok(bytes) => Ok(bytes),
                Err(LoadError::Invalid(fault)) => {
                    let FileFault {
                        expected, found, ..
                    } = &fault;
                    let sentence =
                        format!("a buffer is left out: expected {expected}, but found {found}");
                    warnings.push(|| faults.warning(&sentence));
                    Err(fault)
                }
                Err(other) => return Err(other),
            };
            buffers.push(bytes);
        }
        let places = buffers.iter().flatten();
        let places: BTreeSet<_> = places.map(|bytes| (bytes.as_ptr(), bytes.len())).collect();
        let size = places.into_iter().map(|(_, length)| length as u64).sum();
        Ok(Self {
            faults,
            buffers,
            size,
        })
    }

    /// Of all of them; a file that several name counts once.
    pub(super) fn bytes(&self) -> u64 {
        self.size
    }

    pub(super) fn view<'s>(
        &'s self,
        root: &Root,
        index: Index<buffer::View>,
        path: &str,
    ) -> Result<View<'s>, LoadError> {
        let faults = self.faults;
        let view = faults.get(&root.buffer_views, "buffer views", index, path)?;
        let path = format!("bufferViews[{}]", index.value());
        let buffer = faults.get(
            &root.buffers,
            "buffers",
            view.buffer,
            &format!("{path}.buffer"),
        )?;
        let there = &self.buffers[view.buffer.value()];
        let extensions = view.extensions.as_ref();
        let brought = extensions.and_then(|it| extensions::bringing(&it.others));
        let there = there.as_ref().map_err(|fault| match brought {
            Some(name) => faults.at(&path, "a buffer that is there", extensions::instead(name)),
            None => fault.clone(),
        })?;
        let USize64(most) = buffer.byte_length;
        let (start, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let end = start.checked_add(length).filter(|&end| end <= most);
        // Not past what the buffer says it has, and that is there.
        let bytes = end.and_then(|end| {
            let range = usize::try_from(start).ok()?..usize::try_from(end).ok()?;
            there.get(range)
        });
        let beyond = || {
            let expected = format!("a part of the {most} bytes of its buffer");
            faults.load(&path, expected, format!("{length} bytes from {start}"))
        };
        let stride = view.byte_stride.map(|stride| stride.0);
        if let Some(stride) = stride.filter(|stride| !(4..=252).contains(stride)) {
            let path = format!("{path}.byteStride");
            return Err(faults.load(&path, "a number from 4 to 252", stride.to_string()));
        }
        Ok(View {
            bytes: Bytes::InFile(bytes.ok_or_else(beyond)?),
            stride,
        })
    }
}

/// As long as the buffer says at least.
fn bytes_of<'a>(
    faults: Faults<'_>,
    path: &str,
    buffer: &Buffer,
    binary: Option<&'a [u8]>,
    from: &Gathered,
    files: &mut Files<'_>,
    warnings: &mut Warnings,
) -> Result<Bytes<'a>, LoadError> {
    let bytes = match &buffer.uri {
        Some(uri) => {
            let path = format!("{path}.uri");
            let media = media_type(uri).filter(|it| !BUFFER_MEDIA.contains(it));
            if let Some(media) = media {
                let wanted = BUFFER_MEDIA.join(" or ");
                let sentence = format!(
                    "{path} has the media type {} and not {wanted}",
                    quoted(media)
                );
                warnings.push(|| faults.warning(&sentence));
            }
            Bytes::Shared(open(faults, &path, uri, from, files)?)
        }
        None => {
            let missing = || {
                let extensions = buffer.extensions.as_ref();
                let found = match extensions.and_then(|it| extensions::bringing(&it.others)) {
                    Some(name) => extensions::instead(name),
                    None => "neither, so there is nothing to draw from it".to_owned(),
                };
                faults.load(path, "a `uri`, or a binary chunk", found)
            };
            Bytes::InFile(binary.ok_or_else(missing)?)
        }
    };
    let USize64(length) = buffer.byte_length;
    if length > bytes.len() as u64 {
        let expected = format!("{length} bytes");
        return Err(faults.load(path, expected, bytes.len().to_string()));
    }
    // The binary chunk is padded; a file may hold more than one buffer.
    let most = match &buffer.uri {
        None => Some(length.saturating_add(3)),
        Some(uri) => data_of(uri).map(|_| length),
    };
    if most.is_some_and(|most| bytes.len() as u64 > most) {
        let there = bytes.len();
        warnings.push(|| {
            let sentence = format!("{path} has {there} bytes, but a byteLength of {length}");
            faults.warning(&sentence)
        });
    }
    Ok(bytes)
}

const BUFFER_MEDIA: &[&str] = &["application/octet-stream", "application/gltf-buffer"];

/// What a data URI says it holds, where it says so.
pub(super) fn media_type(uri: &str) -> Option<&str> {
    let (media, _) = data_of(uri)?.split_once([';', ','])?;
    Some(media).filter(|media| !media.is_empty())
}

/// What follows `data:`.
fn data_of(uri: &str) -> Option<&str> {
    let (scheme, data) = uri.split_at_checked(5)?;
    scheme.eq_ignore_ascii_case("data:").then_some(data)
}

/// What a URI in a document leads to: a data URI, or a file beside the document. Never anything else.
pub(super) fn open(
    faults: Faults<'_>,
    path: &str,
    uri: &str,
    from: &Gathered,
    files: &mut Files<'_>,
) -> Result<Arc<[u8]>, LoadError> {
    if let Some(data) = data_of(uri) {
        let found = |reason: &str| faults.load(path, "a data URI", reason);
        let (head, text) = data
            .split_once(',')
            .ok_or_else(|| found("no comma in it"))?;
        let bytes = percent_decoded(text).ok_or_else(|| found("a `%` without two digits"))?;
        let head = percent_decoded(head).ok_or_else(|| found("a `%` without two digits"))?;
        // Not every file has it last and without blanks.
        let mut words = head.split(|&byte| byte == b';');
        let is_base64 = words.any(|it| it.trim_ascii().eq_ignore_ascii_case(b"base64"));
        if !is_base64 {
            return Ok(bytes.into_owned().into());
        }
        // Some encoders leave out the padding or break lines.
        let end = bytes
            .iter()
            .rposition(|byte| *byte != b'=' && !byte.is_ascii_whitespace());
        let unpadded = &bytes[..end.map_or(0, |end| end + 1)];
        let decoded = base64_simd::forgiving_decode_to_vec(unpadded);
        return Ok(decoded
            .map_err(|_| found("text that is not base64"))?
            .into());
    }
    let refused = |reason: String| {
        let path = format!("{path}, {}", quoted(uri));
        faults.load(&path, "a file beside this one or in the request", reason)
    };
    if uri.contains(':') {
        // `C:`, `http:`, `file:`
        return Err(refused("a URI with a scheme".to_owned()));
    }
    let name = percent_decoded(uri).and_then(|bytes| String::from_utf8(bytes.into_owned()).ok());
    let name = name.ok_or_else(|| refused("escapes that make no text".to_owned()))?;
    match files.look_up(from, &name) {
        Ok(file) => Ok(file.bytes.clone()),
        Err(Denied::Limit(exceeded)) => Err(exceeded.into()),
        Err(Denied::NotFound) => Err(refused("no such file".to_owned())),
        Err(Denied::NotAllowed(reason)) => {
            Err(refused(format!("that it may not be opened: {reason}")))
        }
        Err(Denied::Io(error)) => Err(refused(format!("that it cannot be read: {error}"))),
    }
}

/// `None` where what follows a `%` is no number.
fn percent_decoded(text: &str) -> Option<Cow<'_, [u8]>> {
    if !text.contains('%') {
        return Some(Cow::Borrowed(text.as_bytes()));
    }
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
            let (high, low) = (digit(rest.next())?, digit(rest.next())?);
            bytes.push((high * 16 + low) as u8);
        } else {
            bytes.push(byte);
        }
    }
    Some(Cow::Owned(bytes))
}
