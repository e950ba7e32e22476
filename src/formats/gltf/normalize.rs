//! Brings JSON that the specification allows to the form that the library reads. Never lives here: what is an error.

use serde_json::{Number, Value};

/// What a channel without a target moves. No index of the file comes to it, see [`numbers`].
pub(super) const NO_NODE: u32 = u32::MAX;

/// Adds what the specification lets a file leave out and the library does not: nodes of a scene and the node of a channel's target.
pub(super) fn members(json: &mut Value) {
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
pub(super) fn numbers(json: &mut Value) {
    settle(json, "");
}

/// `member` is the name of the member that a value is of.
fn settle(value: &mut Value, member: &str) {
    /// Beyond, not every integer is one of f64.
    const MOST_EXACT: f64 = (1_u64 << 53) as f64;
    match value {
        Value::Array(items) => items.iter_mut().for_each(|it| settle(it, member)),
        Value::Object(members) => members.iter_mut().for_each(|(name, it)| settle(it, name)),
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
