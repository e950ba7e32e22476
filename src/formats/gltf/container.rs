//! From the bytes of a `.gltf` or `.glb` to its JSON, and to what follows that. Never lives here: what the JSON means.

use super::extensions;
use super::fault::Faults;
use super::rules;
use crate::formats::error::{FileFault, LoadError, quoted};
use crate::formats::text::{UTF8_BOM, without_bom, without_nuls_at_end};
use crate::limits::Limits;
use crate::rig::Warnings;
use gltf_json::Root;
use serde_json::{Number, Value};

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
    settle_numbers(&mut json, "");
    rules::warn_of_nothing(faults, &json, warnings);
    forgive(&mut json);
    let root: Root = serde_path_to_error::deserialize(&json).map_err(|error| {
        let path = error.path().to_string();
        let path = if path == "." { "it" } else { path.as_str() };
        let (expected, found) = expected_and_found(&plain(&error.inner().to_string()));
        faults.at(path, expected, found)
    })?;
    Ok(Container { root, json, binary })
}

/// Where a text stops being JSON, and what stands there.
fn not_json(faults: Faults<'_>, text: &str, error: &serde_json::Error) -> FileFault {
    let line = text.split('\n').nth(error.line().saturating_sub(1));
    let line = line.unwrap_or_default();
    // The parser counts columns in bytes.
    let before = error.column().saturating_sub(1);
    let column = line.char_indices().take_while(|(at, _)| *at < before);
    let column = column.count();
    let there = line.chars().nth(column).map(|it| quoted(&it.to_string()));
    let there = there.unwrap_or_else(|| "the end of the line".to_owned());
    let message = error.to_string();
    // The place is told beside it.
    let message = message.split(" at line ").next().unwrap_or_default();
    let (expected, found) = match message {
        _ if error.is_eof() => ("more JSON".to_owned(), "the end of the file".to_owned()),
        "expected value" | "expected ident" => ("a value of JSON".to_owned(), there),
        "key must be a string" => ("a name in double quotes".to_owned(), there),
        "trailing characters" => ("nothing after the JSON".to_owned(), there),
        "recursion limit exceeded" => (
            "JSON that is not nested deeper than 127 levels".to_owned(),
            there,
        ),
        _ => match message.strip_prefix("expected ") {
            Some(expected) => (format!("{expected} in the JSON"), there),
            None => ("JSON".to_owned(), plain(message)),
        },
    };
    FileFault {
        line: error.line().max(1),
        column: column + 1,
        ..faults.whole(expected, found)
    }
}

/// What is wrong with a part of the JSON, from a sentence of the deserializer's.
pub(super) fn problem(error: &serde_json::Error) -> String {
    let (expected, found) = expected_and_found(&plain(&error.to_string()));
    format!("expected {expected}, but found {found}")
}

/// Of a sentence such as `invalid type: string "a", expected u32` or ``missing field `count` ``.
fn expected_and_found(sentence: &str) -> (String, String) {
    if let Some(field) = sentence.strip_prefix("missing field ") {
        return (format!("a member {field}"), "none".to_owned());
    }
    let Some((found, expected)) = sentence.rsplit_once(", expected ") else {
        return ("what glTF 2.0 has there".to_owned(), sentence.to_owned());
    };
    let found = found.trim_start_matches("invalid type: ");
    let found = found.trim_start_matches("invalid value: ");
    let found = match found.strip_prefix("invalid length ") {
        Some(count) => format!("a list of {count}"),
        None => match found {
            "map" => "an object".to_owned(),
            "sequence" => "a list".to_owned(),
            _ => found.to_owned(),
        },
    };
    (in_words(expected), found)
}

/// What the deserializer expects, in the words of JSON and not of its types.
fn in_words(expected: &str) -> String {
    let words = match expected {
        "a map" => "an object",
        "a sequence" => "a list",
        "index into child of root" => "an index",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0",
        "f32" | "f64" => "a number",
        _ if expected.starts_with("struct ") => "an object",
        _ => expected,
    };
    words.replace("an array of length", "a list of")
}

/// A sentence of a parser's, on one line and not endless: it may quote the file.
fn plain(sentence: &str) -> String {
    const MOST: usize = 200;
    sentence
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(MOST)
        .collect()
}

/// The JSON chunk, which comes first, and the binary one. Chunks of other types are of extensions, and passed over.
fn chunks<'a>(
    faults: Faults<'_>,
    bytes: &'a [u8],
    warnings: &mut Warnings,
) -> Result<(&'a [u8], Option<&'a [u8]>), FileFault> {
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
    let mut warn = |sentence: String| warnings.push(|| faults.warning(&sentence));
    if length < bytes.len() {
        let more = bytes.len() - length;
        warn(format!("{more} bytes after its end are passed over"));
    }
    let mut rest = &bytes[12..length];
    let (mut json, mut binary) = (None, None);
    for place in 0.. {
        if rest.is_empty() {
            break;
        }
        let (kind, size, after) = match (word(rest, 4), word(rest, 0)) {
            (Some(kind), Some(size)) => (kind.to_le_bytes(), size as usize, &rest[8..]),
            _ if json.is_none() => {
                return Err(faults.whole("a chunk's header", "the end of the file"));
            }
            _ => {
                let more = rest.len();
                warn(format!("{more} bytes after its last chunk are passed over"));
                break;
            }
        };
        let name = quoted(String::from_utf8_lossy(&kind).trim_end_matches('\0'));
        if json.is_none() && kind != *b"JSON" {
            let found = format!("one of type {name}");
            return Err(faults.whole("a JSON chunk first", found));
        }
        let Some((content, after)) = after.split_at_checked(size) else {
            let expected = format!("a chunk {name} of {size} bytes");
            return Err(faults.whole(expected, format!("{} more", after.len())));
        };
        if size % 4 != 0 {
            warn(format!(
                "the chunk {name} of {size} bytes is not padded to a multiple of 4"
            ));
        }
        rest = after;
        let slot = match &kind {
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
        if kind == *b"BIN\0" && place != 1 {
            warn(format!("the chunk {name} is not the second one"));
        }
        *slot = Some(content);
    }
    let json = json.ok_or_else(|| faults.whole("a JSON chunk", "the end of the file"))?;
    Ok((json, binary))
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

/// What a channel without a target moves. No index of the file comes to it, see [`settle_numbers`].
pub(super) const NO_NODE: u32 = u32::MAX;

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
    let channels = list(json, "animations").flat_map(|animation| list(animation, "channels"));
    for channel in channels {
        let target = channel.get_mut("target").and_then(Value::as_object_mut);
        if let Some(target) = target.filter(|target| target.get("node").is_none_or(Value::is_null))
        {
            target.insert("node".to_owned(), Value::from(NO_NODE));
        }
    }
}

/// Numbers as the library takes them. For JSON `3.0` and `3e0` are integers, for the library they are not; and of an index it cuts off
/// what does not fit 32 bits, so that one becomes a float, which is refused.
fn settle_numbers(value: &mut Value, member: &str) {
    /// Beyond, not every integer is one of f64.
    const MOST_EXACT: f64 = (1_u64 << 53) as f64;
    match value {
        Value::Array(items) => items.iter_mut().for_each(|it| settle_numbers(it, member)),
        Value::Object(members) => members
            .iter_mut()
            .for_each(|(name, it)| settle_numbers(it, name)),
        Value::Number(number) => {
            let as_float = number.as_f64().unwrap_or_default();
            if number.is_f64() && as_float.fract() == 0.0 && as_float.abs() <= MOST_EXACT {
                *number = Number::from(as_float as i64);
            }
            let is_wide = matches!(member, "byteLength" | "byteOffset" | "byteStride" | "count");
            if number.as_u64().is_some_and(|it| it >= u64::from(NO_NODE)) && !is_wide {
                *number = Number::from_f64(as_float).unwrap_or(Number::from(0));
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
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
