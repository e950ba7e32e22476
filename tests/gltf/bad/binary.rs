//! Chunks of a binary file.

use super::{assert_is_clear, outcome, text};
use crate::SERVICE;
use crate::support::everything::good;
use crate::support::gltf::{glb, glb_of};
use crate::support::{ask, ask_ok, with_base64};
use serde_json::json;

#[test]
fn a_binary_file_cut_anywhere_is_a_clear_fault() {
    let whole = good().glb();
    for end in 0..whole.len() {
        let what = format!("cut at {end}");
        // Before the magic number is whole, it is taken for text.
        let fragment = match end {
            0 => "more JSON",
            1..4 => "a value of JSON",
            4..12 => "a header of 12 bytes",
            _ => "bytes that its header tells of",
        };
        let params = json!({"name": what, "files": [with_base64("x.glb", &whole[..end])]});
        match ask(&SERVICE, "rig.load", params) {
            Ok(summary) => panic!("{what}: loaded as {summary}"),
            Err(error) => assert_is_clear(&what, &error, "x.glb", fragment),
        }
    }
    assert_eq!(ask_ok(&SERVICE, "server.ping", json!({})), json!({}));
}

#[test]
fn a_binary_file_that_lies_about_itself_is_refused() {
    let whole = good().glb();
    let with = |at: usize, number: u32| {
        let mut file = whole.clone();
        file[at..at + 4].copy_from_slice(&number.to_le_bytes());
        file
    };
    let length = whole.len() as u32;
    let sound = good();
    let json = sound.document(None).to_string();
    let padded = format!("{json:width$}", width = json.len().next_multiple_of(4));
    let (json, bytes) = (padded.as_bytes(), &sound.bytes[..]);
    let mut garbled = json.to_vec();
    let at = json
        .windows(5)
        .position(|five| five == b"cloth")
        .expect("the mesh's name");
    garbled[at] = 0xFF;
    let json_length = json.len() as u32;
    const MORE: &str = "bytes that its header tells of";
    const NOT_FIRST: &str = "a JSON chunk first";
    let with_type = |kind: &[u8; 4]| with(16, u32::from_le_bytes(*kind));
    for (what, file, fragment) in [
        ("a version of 0", with(4, 0), "found 0"),
        ("a version of 1", with(4, 1), "found 1"),
        ("a version of 3", with(4, 3), "found 3"),
        ("a longer file", with(8, length + 4), MORE),
        ("a file of 4 GiB", with(8, u32::MAX), MORE),
        ("a file of its header", with(8, 12), "a JSON chunk"),
        ("a file of nothing", with(8, 0), MORE),
        (
            "a first chunk of 4 GiB",
            with(12, u32::MAX),
            "a chunk `JSON` of",
        ),
        (
            "a first chunk past the end",
            with(12, length),
            "a chunk `JSON` of",
        ),
        // What follows is read as the next chunk's header.
        ("a first chunk of nothing", with(12, 0), "a chunk `cess` of"),
        (
            "a first chunk cut short",
            with(12, json_length - 8),
            "a chunk `}]} ` of",
        ),
        (
            "a second chunk of 4 GiB",
            with(20 + json.len(), u32::MAX),
            "a chunk `BIN` of",
        ),
        (
            "a second chunk of nothing",
            with(20 + json.len(), 0),
            "a chunk `` of",
        ),
        (
            "a first chunk of another kind",
            with_type(b"JSOM"),
            NOT_FIRST,
        ),
        (
            "bytes first",
            glb_of(&[(*b"BIN\0", bytes), (*b"JSON", json)]),
            NOT_FIRST,
        ),
        ("no bytes", glb_of(&[(*b"JSON", json)]), "or a binary chunk"),
        ("no chunk", glb_of(&[]), "a JSON chunk"),
        ("not UTF-8", glb(&garbled, bytes), "JSON in UTF-8"),
        ("no document", glb(b"{}", bytes), "asset.version"),
    ] {
        match outcome(what, json!([with_base64("x.glb", &file)])) {
            Ok(summary) => panic!("{what}: loaded as {summary}"),
            Err(error) => assert_is_clear(what, &error, "x.glb", fragment),
        }
    }
}

#[test]
fn chunks_of_other_types_are_passed_over() {
    let sound = good();
    let document = sound.document(None).to_string();
    let json = format!(
        "{document:width$}",
        width = document.len().next_multiple_of(4)
    );
    let (json, bytes, other) = (
        (*b"JSON", json.as_bytes()),
        &sound.bytes[..],
        (*b"TEST", &b"abcd"[..]),
    );
    let bytes = (*b"BIN\0", bytes);
    let mut longer = sound.glb();
    longer.extend(b"abcd");
    for (what, file, told) in [
        (
            "after the bytes",
            glb_of(&[json, bytes, other]),
            "unknown type `TEST`",
        ),
        (
            "before the bytes",
            glb_of(&[json, other, bytes]),
            "not the second one",
        ),
        (
            "empty",
            glb_of(&[json, bytes, (*b"TEST", b"")]),
            "unknown type `TEST`",
        ),
        (
            "twice the bytes",
            glb_of(&[json, bytes, bytes]),
            "a further chunk `BIN`",
        ),
        (
            "two documents",
            glb_of(&[json, bytes, json]),
            "a further chunk `JSON`",
        ),
        (
            "more than its header tells of",
            longer,
            "4 bytes after its end",
        ),
        (
            "more bytes than the buffer has",
            glb_of(&[json, (*b"BIN\0", &[bytes.1, b"abcd"].concat())]),
            "bytes, but a byteLength of",
        ),
        (
            "a document padded with NUL bytes",
            glb(&[json.1, b"\0\0\0\0"].concat(), bytes.1),
            "4 NUL bytes after the JSON",
        ),
    ] {
        let summary = outcome(what, json!([with_base64("x.glb", &file)])).expect(what);
        assert!(
            summary["warnings"].to_string().contains(told),
            "{what}: {summary}"
        );
    }
}

#[test]
fn nul_bytes_after_a_document_are_passed_over() {
    let content = good().text() + "\n\0\0";
    let summary = outcome("NUL", text(&content)).expect("it is sound");
    let warnings = summary["warnings"].to_string();
    assert!(
        warnings.contains("2 NUL bytes after the JSON"),
        "{warnings}"
    );
}
