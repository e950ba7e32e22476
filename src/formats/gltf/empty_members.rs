//! Members of a document that say nothing. Never lives here: what has to be there.

use super::fault::Faults;
use crate::rig::Warnings;
use serde_json::Value;

/// Lists without items and members that are `null`, both of which have to be left out: one warning for all of a kind, since exporters that
/// write one write many.
pub(super) fn warn(faults: Faults<'_>, json: &Value, warnings: &mut Warnings) {
    /// The path of the first, and how many there are.
    #[derive(Default)]
    struct Found(String, usize);
    impl Found {
        fn add(&mut self, path: impl FnOnce() -> String) {
            if self.1 == 0 {
                self.0 = path();
            }
            self.1 += 1;
        }
        fn warn(self, what: &str, is: &str, faults: Faults<'_>, warnings: &mut Warnings) {
            let Self(first, count) = self;
            let more = match count {
                0 => return,
                1 => String::new(),
                _ => format!(", as are {} more", count - 1),
            };
            warnings.push(|| faults.warning(&format!("{what} {first} is {is}{more}")));
        }
    }
    fn walk(value: &Value, path: &str, empty: &mut Found, null: &mut Found) {
        match value {
            Value::Array(items) if items.is_empty() => empty.add(|| path.to_owned()),
            Value::Array(items) => {
                let is_nested = |item: &Value| item.is_array() || item.is_object();
                for (index, item) in items.iter().enumerate().filter(|(_, it)| is_nested(it)) {
                    walk(item, &format!("{path}[{index}]"), empty, null);
                }
            }
            Value::Object(members) => {
                let dot = if path.is_empty() { "" } else { "." };
                for (name, member) in members {
                    let path = || format!("{path}{dot}{name}");
                    match member {
                        _ if matches!(name.as_str(), "extras" | "extensions") => {}
                        Value::Null => null.add(path),
                        Value::Array(_) | Value::Object(_) => walk(member, &path(), empty, null),
                        Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
                    }
                }
            }
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }
    let (mut empty, mut null) = (Found::default(), Found::default());
    walk(json, "", &mut empty, &mut null);
    empty.warn("the list", "empty", faults, warnings);
    null.warn("the member", "null and passed over", faults, warnings);
}
