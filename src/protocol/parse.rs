//! From the raw parameters of a request to a type, each fault with the path of its field and what was expected there.
//! Never lives here: rules about one type, and rules that need more than the request to judge.

use super::error::Fault;
use super::field::{FieldFault, FieldPath, shortened};
use super::strict::Strict;
use serde::de::{DeserializeOwned, Error};
use serde_json::value::RawValue;
use serde_path_to_error::{Path, Segment};
use std::fmt::Display;

/// The parameters as `T`. Absent ones are taken for `{}`.
///
/// # Errors
/// [`Fault::InvalidParams`].
pub fn params<T: DeserializeOwned>(raw: Option<&RawValue>) -> Result<T, Fault> {
    let text = raw.map_or("{}", RawValue::get);
    // Keeping track of the path costs a string for each key; hardly any request needs it.
    if let Ok(typed) = T::deserialize(Strict(&mut serde_json::Deserializer::from_str(text))) {
        return Ok(typed);
    }
    let mut inner = serde_json::Deserializer::from_str(text);
    serde_path_to_error::deserialize(Strict(&mut inner)).map_err(|error| {
        let (field, message) = reworded(error.inner());
        Fault::InvalidParams(FieldFault::new(path_of(error.path(), field), message))
    })
}

/// Something wrong with one field, found by rules about several fields of the same object once all of them were read.
pub(super) fn field_error<E: Error>(field: &str, message: impl Display) -> E {
    E::custom(format_args!("{field}{FIELD_MARK}{message}"))
}

/// Parts the field from the message of [`field_error`], as an error of serde's is one string. Text from outside is escaped before it gets
/// into a message, so that it cannot hold one.
const FIELD_MARK: char = '\u{1f}';

/// The field it is about, where the error names one below the path, and the sentence, in the words of this protocol and not of serde.
pub(super) fn reworded(error: &serde_json::Error) -> (Option<String>, String) {
    let text = error.to_string();
    let position = format!(" at line {} column {}", error.line(), error.column());
    let text = text.strip_suffix(&position).unwrap_or(&text);
    if let Some((field, message)) = text.split_once(FIELD_MARK) {
        return (Some(field.to_owned()), shortened(message).into_owned());
    }
    if let Some(field) = text.strip_prefix("missing field `") {
        let field = field.trim_end_matches('`').to_owned();
        return (Some(field), "the field is missing".to_owned());
    }
    if text == "number out of range" {
        return (None, "expected a finite number of 64 bits".to_owned());
    }
    let mistaken = text
        .strip_prefix("invalid type: ")
        .or_else(|| text.strip_prefix("invalid value: "));
    let miscounted = text.strip_prefix("invalid length ");
    let message = match (mistaken, miscounted) {
        (Some(rest), _) => expected_but_found(rest, ""),
        (_, Some(rest)) => expected_but_found(rest, "only "),
        _ => None,
    };
    (
        None,
        message.unwrap_or_else(|| shortened(text).into_owned()),
    )
}

/// From `F, expected E`.
fn expected_but_found(rest: &str, only: &str) -> Option<String> {
    let (found, expected) = rest.rsplit_once(", expected ")?;
    let expected = expected.replace("an array of length ", "a list of ");
    let found = match found {
        "sequence" => "a list",
        "map" => "an object",
        other => other,
    };
    let found = shortened(found);
    Some(format!("expected {expected}, but found {only}{found}"))
}

fn path_of(tracked: &Path, field: Option<String>) -> FieldPath {
    let mut path = FieldPath::default();
    for segment in tracked.iter() {
        path = match segment {
            Segment::Map { key } => path.field(key.clone()),
            Segment::Seq { index } => path.index(*index),
            Segment::Enum { .. } | Segment::Unknown => path,
        };
    }
    match field {
        Some(field) => path.field(field),
        None => path,
    }
}

#[cfg(test)]
mod tests;
