//! From the bytes of a `.gltf` or `.glb` to its JSON, and to what follows that. Never lives here: what the JSON means.

use super::extensions;
use super::fault::Faults;
use super::json_fault::{in_root, not_json};
use super::{empty_members, normalize};
use crate::formats::error::{FileFault, LoadError, quoted};
use crate::formats::text::{UTF8_BOM, without_bom, without_nuls_at_end};
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
    /// The binary chunk of a `.glb`.
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
        chunks(faults, bytes, warnings)?
    } else {
        (bytes, None)
    };
    if json.starts_with(UTF8_BOM) {
        warnings.push(|| faults.warning("the JSON opens with a byte order mark"));
    }
    let json = without_bom(json);
    let (json, nul_count) = without_nuls_at_end(json);
    if nul_count > 0 {
        let sentence = format!("{nul_count} NUL bytes after the JSON are passed over");
        warnings.push(|| faults.warning(&sentence));
    }
    limits.document_bytes(json.len())?;
    let mut json: Value = match std::str::from_utf8(json) {
        Ok(text) => serde_json::from_str(text).map_err(|error| not_json(faults, text, &error))?,
        Err(error) => {
            let found = format!("other bytes at offset {}", error.valid_up_to());
            return Err(faults.whole("JSON in UTF-8", found).into());
        }
    };
    check_version(faults, &json, warnings)?;
    extensions::check(faults, &json, warnings)?;
    check_lists(faults, &json, limits)?;
    normalize::numbers(&mut json);
    empty_members::warn(faults, &json, warnings);
    normalize::members(&mut json);
    let root = serde_path_to_error::deserialize(&json);
    let root: Root = root.map_err(|error| in_root(faults, &error))?;
    Ok(Container { root, json, binary })
}

/// The JSON chunk, which comes first, and the binary one. Chunks of other types are of extensions, and passed over.
fn chunks<'a>(
    faults: Faults<'_>,
    bytes: &'a [u8],
    warnings: &mut Warnings,
) -> Result<(&'a [u8], Option<&'a [u8]>), FileFault> {
    let mut rest = behind_header(faults, bytes, warnings)?;
    let mut warn = |sentence: String| warnings.push(|| faults.warning(&sentence));
    let (mut json, mut binary) = (None, None);
    for place in 0.. {
        if rest.is_empty() {
            break;
        }
        if json.is_some() && rest.len() < CHUNK_HEADER {
            let more = rest.len();
            warn(format!("{more} bytes after its last chunk are passed over"));
            break;
        }
        let chunk = Chunk::read(faults, rest, json.is_none())?;
        rest = chunk.after;
        let (size, name) = (chunk.content.len(), chunk.name());
        if size % 4 != 0 {
            warn(format!(
                "the chunk {name} of {size} bytes is not padded to a multiple of 4"
            ));
        }
        let slot = match &chunk.kind {
            b"JSON" => &mut json,
            b"BIN\0" => &mut binary,
            _ => {
                warn(format!("a chunk of the unknown type {name} is passed over"));
                continue;
            }
        };
        if slot.is_some() {
            warn(format!("a further chunk {name} is passed over"));
            continue;
        }
        if chunk.kind == *b"BIN\0" && place != 1 {
            warn(format!("the chunk {name} is not the second one"));
        }
        *slot = Some(chunk.content);
    }
    let json = json.ok_or_else(|| faults.whole("a JSON chunk", "the end of the file"))?;
    Ok((json, binary))
}

/// What follows the header of a binary file, up to the end that it tells of.
fn behind_header<'a>(
    faults: Faults<'_>,
    bytes: &'a [u8],
    warnings: &mut Warnings,
) -> Result<&'a [u8], FileFault> {
    let [Some(version), Some(length)] = [word(bytes, 4), word(bytes, 8)] else {
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
    if length < bytes.len() {
        let more = bytes.len() - length;
        let sentence = format!("{more} bytes after its end are passed over");
        warnings.push(|| faults.warning(&sentence));
    }
    Ok(&bytes[12..length])
}

/// In bytes: size and type.
const CHUNK_HEADER: usize = 8;

struct Chunk<'a> {
    kind: [u8; 4],
    content: &'a [u8],
    /// What follows it.
    after: &'a [u8],
}

impl<'a> Chunk<'a> {
    fn read(faults: Faults<'_>, bytes: &'a [u8], is_first: bool) -> Result<Self, FileFault> {
        let (Some(size), Some(kind)) = (word(bytes, 0), word(bytes, 4)) else {
            return Err(faults.whole("a chunk's header", "the end of the file"));
        };
        let (kind, size) = (kind.to_le_bytes(), size as usize);
        let name = chunk_name(kind);
        if is_first && kind != *b"JSON" {
            let found = format!("one of type {name}");
            return Err(faults.whole("a JSON chunk first", found));
        }
        let after = &bytes[CHUNK_HEADER..];
        let Some((content, after)) = after.split_at_checked(size) else {
            let expected = format!("a chunk {name} of {size} bytes");
            return Err(faults.whole(expected, format!("{} more", after.len())));
        };
        Ok(Self {
            kind,
            content,
            after,
        })
    }

    fn name(&self) -> String {
        chunk_name(self.kind)
    }
}

fn chunk_name(kind: [u8; 4]) -> String {
    quoted(String::from_utf8_lossy(&kind).trim_end_matches('\0'))
}

/// Four bytes as a number.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*word))
}

fn check_version(
    faults: Faults<'_>,
    json: &Value,
    warnings: &mut Warnings,
) -> Result<(), FileFault> {
    let asset = &json["asset"];
    let mut check = |member: &str, is_allowed: fn(u32) -> bool| {
        let path = format!("asset.{member}");
        let major = |version: &str| version.split('.').next()?.parse::<u32>().ok();
        let found = match &asset[member] {
            Value::String(version) if major(version).is_some_and(is_allowed) => {
                if version != "2.0" {
                    let version = quoted(version);
                    let sentence =
                        format!("{path} is {version}; what differs from 2.0 is not read");
                    warnings.push(|| faults.warning(&sentence));
                }
                return Ok(());
            }
            Value::Null => "none".to_owned(),
            other => quoted(&other.to_string()),
        };
        Err(faults.at(&path, "glTF version 2.0", found))
    };
    // `minVersion` is what a reader must know; without it the version is.
    if asset["minVersion"].is_null() {
        return check("version", |major| major == 2);
    }
    check("version", |major| major >= 2)?;
    check("minVersion", |major| major == 2)
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
