//! From the raw parameters of a request to a type.
//! Never lives here: rules about one type, and rules that need more than the request to judge.

use super::error::Fault;
use super::strict;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;

/// The parameters as `T`. Absent ones are taken for `{}`.
///
/// # Errors
/// [`Fault::InvalidParams`], with a path such as `lights[1].color` and what was expected there.
pub fn params<T: DeserializeOwned>(raw: Option<&RawValue>) -> Result<T, Fault> {
    Ok(strict::from_str(raw.map_or("{}", RawValue::get))?)
}

#[cfg(test)]
mod tests;
