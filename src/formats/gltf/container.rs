//! From the bytes of a `.gltf` or `.glb` to its JSON, and to what follows that. Never lives here: what the JSON means.

use super::extensions;
use super::fault::Faults;
use crate::formats::error::{FileFault, LoadError, quoted};
use crate::formats::text::without_bom;
use crate::limits::Limits;
use crate::rig::Warnings;
use gltf_json::Root;
use serde_json::Value;

/// A document as it stands in its file: any index in it may lead nowhere.
#[derive(Debug)]
pub(super) struct Container<'a> {
    pub root: Root,
    /// The same, for telling what it says where it says something else than it should.
    pub json: Value,
    /// The second chunk of a `.glb`.
    pub binary: Option<&'a [u8]>,
}

/// # Errors
/// Where the chunks do not add up, the JSON is none or none of glTF 2, or an extension is required that is not supported.
pub(super) fn read<'a>(
    faults: Faults<'_>,
    bytes: &'a [u8],
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Container<'a>, LoadError> {
    let (json, binary) = if bytes.starts_with(b"glTF") {
        chunks(faults, bytes)?
    } else {
        (without_bom(bytes), None)
    };
    limits.document_bytes(json.len())?;
    let not_json = |error: serde_json::Error| {
        let (line, column) = (error.line(), error.column());
        let found = error.to_string();
        // The place is told beside it.
        let found = found.split(" at line ").next().unwrap_or_default();
        FileFault {
            line: line.max(1),
            column: column.max(1),
            ..faults.whole("glTF JSON", plain(found))
        }
    };
    let mut json: Value = match std::str::from_utf8(json) {
        Ok(text) => serde_json::from_str(text).map_err(not_json)?,
        Err(error) => {
            let found = format!("other bytes at offset {}", error.valid_up_to());
            return Err(faults.whole("JSON in UTF-8", found).into());
        }
    };
    check_version(faults, &json)?;
    extensions::check(faults, &json, warnings)?;
    check_lists(faults, &json, limits)?;
    forgive(&mut json);
    let root: Root = serde_path_to_error::deserialize(&json).map_err(|error| {
        let path = error.path().to_string();
        let path = if path == "." { "it" } else { path.as_str() };
        faults.at(
            path,
            "what glTF 2.0 has there",
            plain(&error.inner().to_string()),
        )
    })?;
    Ok(Container { root, json, binary })
}

/// A sentence of the parser's, on one line and not endless: it may quote the file.
pub(super) fn plain(sentence: &str) -> String {
    const MOST: usize = 200;
    sentence
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(MOST)
        .collect()
}

/// The JSON chunk and the binary one. What comes after is of extensions, and passed over.
fn chunks<'a>(
    faults: Faults<'_>,
    bytes: &'a [u8],
) -> Result<(&'a [u8], Option<&'a [u8]>), FileFault> {
    let word = |at: usize| {
        let word = bytes.get(at..)?.first_chunk::<4>()?;
        Some(u32::from_le_bytes(*word))
    };
    let [Some(version), Some(length)] = [word(4), word(8)] else {
        let found = format!("{} bytes", bytes.len());
        return Err(faults.whole("a header of 12 bytes", found));
    };
    if version != 2 {
        return Err(faults.whole("version 2 of the container", version.to_string()));
    }
    let length = length as usize;
    if length < 12 || length > bytes.len() {
        let expected = format!("the {length} bytes that its header tells of");
        return Err(faults.whole(expected, bytes.len().to_string()));
    }
    let mut rest = &bytes[12..length];
    let mut chunk = |name: &str, kind: &[u8; 4]| -> Result<Option<&'a [u8]>, FileFault> {
        if rest.is_empty() {
            return Ok(None);
        }
        let header = rest.split_at_checked(8);
        let (header, after) =
            header.ok_or_else(|| faults.whole("a chunk's header", "the end of the file"))?;
        let (size, found_kind) = header.split_at(4);
        let size = size
            .first_chunk::<4>()
            .map_or(0, |it| u32::from_le_bytes(*it)) as usize;
        let (content, after) = after.split_at_checked(size).ok_or_else(|| {
            let expected = format!("a {name} chunk of {size} bytes");
            faults.whole(expected, format!("{} more", after.len()))
        })?;
        if found_kind != kind {
            let found = quoted(&String::from_utf8_lossy(found_kind));
            return Err(faults.whole(format!("a {name} chunk"), format!("one of type {found}")));
        }
        rest = after;
        Ok(Some(content))
    };
    let json = chunk("JSON", b"JSON")?;
    let json = json.ok_or_else(|| faults.whole("a JSON chunk", "the end of the file"))?;
    Ok((json, chunk("BIN", b"BIN\0")?))
}

fn check_version(faults: Faults<'_>, json: &Value) -> Result<(), FileFault> {
    let asset = &json["asset"];
    // `minVersion` is what a reader must know; without it the version is.
    let version = match &asset["minVersion"] {
        Value::Null => &asset["version"],
        least => least,
    };
    match version {
        Value::String(version) if version.split('.').next() == Some("2") => Ok(()),
        other => {
            let found = match other {
                Value::Null => "none".to_owned(),
                other => quoted(&other.to_string()),
            };
            Err(faults.at("asset.version", "glTF version 2", found))
        }
    }
}

/// What the specification allows and the library does not: scenes of nothing, and channels that move nothing.
fn forgive(json: &mut Value) {
    fn list<'v>(value: &'v mut Value, name: &str) -> impl Iterator<Item = &'v mut Value> {
        let list = value.get_mut(name).and_then(Value::as_array_mut);
        list.into_iter().flatten()
    }
    for scene in list(json, "scenes") {
        if let Some(members) = scene.as_object_mut() {
            let nothing = || Value::Array(Vec::new());
            members.entry("nodes").or_insert_with(nothing);
        }
    }
    for animation in list(json, "animations") {
        let channels = animation.get_mut("channels").and_then(Value::as_array_mut);
        if let Some(channels) = channels {
            channels.retain(|channel| !channel["target"]["node"].is_null());
        }
    }
}

/// Items of any list at the top but that of the nodes: far more than any character needs.
const MOST_ITEMS: usize = 1 << 17;

/// An item of a list takes a hundred times the memory that its text does.
fn check_lists(faults: Faults<'_>, json: &Value, limits: &Limits) -> Result<(), LoadError> {
    for (name, value) in json.as_object().into_iter().flatten() {
        let items = value.as_array().map_or(0, Vec::len);
        if name == "nodes" {
            limits.joints(items)?;
        } else if items > MOST_ITEMS {
            let expected = format!("at most {MOST_ITEMS} items");
            return Err(faults.load(name, expected, items.to_string()));
        }
    }
    Ok(())
}
