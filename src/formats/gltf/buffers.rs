//! Bytes that a document refers to: buffers and their views, inside it, in other files, in data URIs.
//! Never lives here: what the bytes mean.

use super::container::Container;
use super::fault::Faults;
use crate::formats::error::{LoadError, quoted};
use crate::formats::files::{Files, Gathered};
use crate::formats::source::Denied;
use gltf_json::validation::USize64;
use gltf_json::{Index, Root, buffer};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Bytes wherever they came from.
#[derive(Debug, Clone)]
pub(super) enum Bytes<'a> {
    Here(&'a [u8]),
    Decoded(Arc<[u8]>),
}

impl std::ops::Deref for Bytes<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Here(bytes) => bytes,
            Self::Decoded(bytes) => bytes,
        }
    }
}

/// Every buffer of a document, as long as it says at least.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    faults: Faults<'a>,
    buffers: Vec<Bytes<'a>>,
    size: u64,
}

impl<'a> Buffers<'a> {
    /// # Errors
    /// Where one is not to be had, or is shorter than it says.
    pub fn gather(
        faults: Faults<'a>,
        container: &Container<'a>,
        from: &Gathered,
        files: &mut Files<'_>,
    ) -> Result<Self, LoadError> {
        let mut buffers = Vec::with_capacity(container.root.buffers.len());
        for (index, buffer) in container.root.buffers.iter().enumerate() {
            let path = format!("buffers[{index}]");
            let bytes = match &buffer.uri {
                Some(uri) => {
                    Bytes::Decoded(open(faults, &format!("{path}.uri"), uri, from, files)?)
                }
                None => {
                    let binary = container.binary.filter(|_| index == 0);
                    let missing = || faults.load(&path, "a `uri`, or a binary chunk", "neither");
                    Bytes::Here(binary.ok_or_else(missing)?)
                }
            };
            let USize64(length) = buffer.byte_length;
            if length > bytes.len() as u64 {
                let expected = format!("{length} bytes");
                return Err(faults.load(&path, expected, bytes.len().to_string()));
            }
            buffers.push(bytes);
        }
        let places = buffers.iter().map(|bytes| (bytes.as_ptr(), bytes.len()));
        let places: BTreeSet<_> = places.collect();
        let size = places.into_iter().map(|(_, length)| length as u64).sum();
        Ok(Self {
            faults,
            buffers,
            size,
        })
    }

    /// Of all of them; a file that several name counts once.
    pub fn bytes(&self) -> u64 {
        self.size
    }

    /// The bytes of a view, and how far its elements are apart where it says so.
    pub fn view<'s>(
        &'s self,
        root: &Root,
        index: Index<buffer::View>,
        path: &str,
    ) -> Result<(&'s [u8], Option<usize>), LoadError> {
        let faults = self.faults;
        let view = faults.get(&root.buffer_views, "buffer views", index, path)?;
        let path = format!("bufferViews[{}]", index.value());
        let buffer = faults.get(
            &root.buffers,
            "buffers",
            view.buffer,
            &format!("{path}.buffer"),
        )?;
        let USize64(most) = buffer.byte_length;
        let (start, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let end = start.checked_add(length).filter(|&end| end <= most);
        // Not past what the buffer says it has, and that is there.
        let bytes = end.and_then(|end| {
            let range = usize::try_from(start).ok()?..usize::try_from(end).ok()?;
            self.buffers[view.buffer.value()].get(range)
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
        Ok((bytes.ok_or_else(beyond)?, stride))
    }
}

/// What a URI in a document leads to: a data URI, or a file beside the document. Never anything else.
pub(super) fn open(
    faults: Faults<'_>,
    path: &str,
    uri: &str,
    from: &Gathered,
    files: &mut Files<'_>,
) -> Result<Arc<[u8]>, LoadError> {
    let scheme = uri.split_at_checked(5);
    if let Some((_, data)) = scheme.filter(|(scheme, _)| scheme.eq_ignore_ascii_case("data:")) {
        let found = |reason: &str| faults.load(path, "a data URI in base64", reason);
        let (head, text) = data
            .split_once(',')
            .ok_or_else(|| found("no comma in it"))?;
        if !head.ends_with(";base64") {
            return Err(found("another encoding"));
        }
        let text = text.trim_end_matches('=').as_bytes();
        let decoded = base64_simd::STANDARD_NO_PAD.decode_to_vec(text);
        return Ok(decoded.map_err(|_| found("other text"))?.into());
    }
    let refused = |reason: String| {
        let path = format!("{path}, {}", quoted(uri));
        faults.load(&path, "a file beside this one or in the request", reason)
    };
    if uri.contains(':') {
        // `C:`, `http:`, `file:`
        return Err(refused("a URI with a scheme".to_owned()));
    }
    let name =
        percent_decoded(uri).ok_or_else(|| refused("escapes that make no text".to_owned()))?;
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

/// `None` where what follows a `%` is no number, or the outcome is no UTF-8.
fn percent_decoded(uri: &str) -> Option<Cow<'_, str>> {
    if !uri.contains('%') {
        return Some(Cow::Borrowed(uri));
    }
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
            let (high, low) = (digit(rest.next())?, digit(rest.next())?);
            bytes.push((high * 16 + low) as u8);
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).ok().map(Cow::Owned)
}
