//! Errors of the JSON parser and of the deserializer, in words of JSON and with the place in the file. Never lives here: what glTF expects.

use super::fault::Faults;
use crate::formats::error::{FileFault, quoted};

/// Where a text stops being JSON, and what stands there.
pub(super) fn not_json(faults: Faults<'_>, text: &str, error: &serde_json::Error) -> FileFault {
    let line = text.split('\n').nth(error.line().saturating_sub(1));
    let line = line.unwrap_or_default();
    // The parser counts columns in bytes.
    let before = error.column().saturating_sub(1);
    let column = line.char_indices().take_while(|(at, _)| *at < before);
    let column = column.count();
    let there = line.chars().nth(column).map(|it| quoted(&it.to_string()));
    let there = there.unwrap_or_else(|| "the end of the line".to_owned());
    let message = error.to_string();
    // The fault has the place as numbers.
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

/// A fault of a member, from an error of the deserializer.
pub(super) fn in_root(
    faults: Faults<'_>,
    error: &serde_path_to_error::Error<serde_json::Error>,
) -> FileFault {
    let path = error.path().to_string();
    let path = if path == "." { "it" } else { path.as_str() };
    let (expected, found) = expected_and_found(&plain(&error.inner().to_string()));
    faults.at(path, expected, found)
}

/// What is wrong with a part of the JSON, from an error of the deserializer.
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
