//! Do the description of the protocol, the examples and the server agree?

mod support;

use rigd::protocol::openrpc;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const API: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/api");
/// Stands in an example for what differs from run to run.
const ANY: &str = "…";
/// Relative to the number, or to 1: adapters round differently.
const TOLERANCE: f64 = 1e-4;

fn accepting() -> bool {
    std::env::var_os("RIGD_ACCEPT_EXAMPLES").is_some()
}

#[test]
fn the_description_is_what_the_types_generate() {
    let path = Path::new(API).join("openrpc.json");
    let generated = openrpc();
    if accepting() {
        fs::write(&path, format!("{generated:#}\n")).expect("the description can be written");
    }
    let kept: Value =
        serde_json::from_str(&fs::read_to_string(&path).expect("api/openrpc.json")).expect("JSON");
    assert!(
        kept == generated,
        "api/openrpc.json is stale: run `rigd openrpc > api/openrpc.json`"
    );
}

#[test]
fn every_example_is_answered_as_it_says_and_as_the_description_says() {
    let schemas = Schemas::new();
    for path in example_files() {
        let text = fs::read_to_string(&path).expect("an example");
        // A conversation of its own each: examples load what they need.
        let service = support::service();
        let mut replayed = String::new();
        for (number, line) in text.lines().enumerate() {
            let place = format!("{}:{}", path.display(), number + 1);
            let example: Value =
                serde_json::from_str(line).unwrap_or_else(|error| panic!("{place}: {error}"));
            let request = &example["request"];
            let response = support::answer(&service, &request.to_string());
            let (reply, _) = support::reply(response.expect("every example has an id"));
            schemas
                .check(request["method"].as_str().unwrap_or_default(), &reply)
                .unwrap_or_else(|error| panic!("{place}: {error}"));
            if accepting() {
                // The request first, as it is read.
                replayed += &format!(
                    "{{\"request\":{request},\"reply\":{}}}\n",
                    elided("", &reply)
                );
            } else if let Err(difference) = compare("reply", &example["reply"], &reply) {
                panic!("{place}: {difference}");
            }
        }
        if accepting() {
            fs::write(&path, replayed).expect("the example can be written");
        }
    }
}

/// In the documentation a reply may leave out members, and the rest of a list after `"…"`.
fn compare_shown(path: &str, wanted: &Value, found: &Value) -> Result<(), String> {
    match (wanted, found) {
        (Value::Object(shown), Value::Object(members)) => {
            shown.iter().try_for_each(|(key, value)| {
                let member = members
                    .get(key)
                    .ok_or_else(|| format!("{path}.{key} is not there"))?;
                compare_shown(&format!("{path}.{key}"), value, member)
            })
        }
        (Value::Array(shown), Value::Array(items)) => {
            let is_cut = shown.last().is_some_and(|last| last == ANY);
            let count = if is_cut { shown.len() - 1 } else { items.len() };
            if count != shown.len() - usize::from(is_cut) {
                return Err(format!("{path}: expected {wanted}, but found {found}"));
            }
            shown
                .iter()
                .zip(items)
                .take(count)
                .enumerate()
                .try_for_each(|(i, (a, b))| compare_shown(&format!("{path}[{i}]"), a, b))
        }
        (Value::String(shown), Value::String(text))
            if shown.ends_with(ANY) && text.starts_with(shown.trim_end_matches(ANY)) =>
        {
            Ok(())
        }
        _ => compare(path, wanted, found),
    }
}

#[test]
fn the_conversations_in_the_documentation_go_as_written() {
    let text = include_str!("../docs/protocol.md");
    let service = support::service();
    let mut count = 0;
    for block in text
        .split("```jsonl\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
    {
        let mut lines = block.lines();
        while let (Some(request), Some(shown)) = (lines.next(), lines.next()) {
            let response = support::answer(&service, request);
            let response = response.unwrap_or_else(|| panic!("not answered: {request}"));
            let (reply, _) = support::reply(response);
            let shown: Value =
                serde_json::from_str(shown).unwrap_or_else(|error| panic!("{error}: {shown}"));
            compare_shown("reply", &shown, &reply)
                .unwrap_or_else(|difference| panic!("{request}\n{difference}"));
            count += 1;
        }
    }
    assert!(count > 10, "only {count} exchanges were found");
}

#[test]
fn every_method_but_the_notification_has_an_example() {
    let mut seen = std::collections::BTreeSet::new();
    for path in example_files() {
        for line in fs::read_to_string(path).expect("an example").lines() {
            let example: Value = serde_json::from_str(line).expect("JSON");
            seen.extend(example["request"]["method"].as_str().map(str::to_owned));
        }
    }
    let known = openrpc();
    let methods = known["methods"]
        .as_array()
        .expect("methods")
        .iter()
        .filter_map(|method| method["name"].as_str());
    // The document itself is too long to stand among the examples.
    let missing: Vec<_> = methods
        .filter(|name| !seen.contains(*name) && !["rpc.discover", "request.cancel"].contains(name))
        .collect();
    assert!(missing.is_empty(), "no example of {missing:?}");
}

/// The defaults of an object's fields, as its schema has them.
fn defaults(properties: &Value) -> Value {
    let members = properties.as_object().expect("properties").iter();
    members
        .filter_map(|(name, schema)| Some((name.clone(), schema.get("default")?.clone())))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

#[test]
fn a_default_that_is_given_changes_nothing() {
    let service = support::service();
    let document = openrpc();
    let schemas = &document["components"]["schemas"];
    let method = |name: &str| {
        let methods = document["methods"].as_array().expect("methods");
        let method = methods.iter().find(|method| method["name"] == name);
        let params = method.expect("it is there")["params"]
            .as_array()
            .expect("params");
        let schemas = params.iter().map(|param| {
            let name = param["name"].as_str().expect("a name").to_owned();
            (name, param["schema"].clone())
        });
        Value::Object(schemas.collect())
    };
    let camera = |kind: usize| defaults(&schemas["Camera"]["oneOf"][kind]["properties"]);
    let light = |kind: usize| defaults(&schemas["Light"]["oneOf"][kind]["properties"]);
    let eye = json!({"kind": "look_at", "eye": [1, 2, 5], "target": [0, 1, 0]});
    let lamps = json!([
        {"kind": "directional", "direction": [0, -1, -1]},
        {"kind": "point", "position": [1, 2, 2]},
    ]);
    let both = json!([over(&lamps[0], light(0)), over(&lamps[1], light(1))]);
    let whole = defaults(&method("frame.render"));
    for field in ["lights", "ambient", "background", "size", "samples", "show"] {
        assert!(whole.get(field).is_some(), "{field} has no default");
    }
    let framed = over(&json!({"kind": "orbit"}), camera(0));
    assert!(framed.get("azimuth").is_some() && light(1).get("color").is_some());
    for (name, plain, given) in [
        ("frame.render", json!({}), whole),
        ("frame.render", json!({}), json!({ "camera": framed })),
        (
            "frame.render",
            json!({ "camera": eye }),
            json!({"camera": over(&eye, over(&camera(1), json!({"fov_y": 0.6981317007977318})))}),
        ),
        (
            "frame.render",
            json!({ "lights": lamps }),
            json!({ "lights": both }),
        ),
        (
            "frame.render",
            json!({}),
            json!({"show": defaults(&schemas["Show"]["properties"])}),
        ),
        (
            "scene.pick",
            json!({"pixel": [256, 200]}),
            defaults(&method("scene.pick")),
        ),
        (
            "mesh.vertices",
            json!({}),
            defaults(&method("mesh.vertices")),
        ),
    ] {
        let plain = over(&json!({"rig": "figure"}), plain);
        let answer = |params: &Value| {
            let mut result = support::ask_ok(&service, name, params.clone());
            if let Some(members) = result.as_object_mut() {
                members.remove("timings_ms");
            }
            result
        };
        let wanted = answer(&plain);
        let found = answer(&over(&plain, given.clone()));
        assert!(wanted == found, "{name} with {given} differs");
    }
}

fn over(object: &Value, members: Value) -> Value {
    let mut all = object.clone();
    if let (Value::Object(all), Value::Object(members)) = (&mut all, members) {
        all.extend(members);
    }
    all
}

#[test]
fn a_wrong_reply_is_seen() {
    let schemas = Schemas::new();
    let ping = json!({"jsonrpc": "2.0", "id": 1, "result": {}});
    assert!(schemas.check("server.ping", &ping).is_ok());
    assert!(
        schemas.check("rig.list", &ping).is_err(),
        "a member is missing"
    );
    assert!(
        schemas
            .check(
                "server.ping",
                &json!({"error": {"code": 1, "message": "x"}})
            )
            .is_err(),
        "an error has data"
    );
    assert!(
        compare(
            "x",
            &json!({"a": ANY, "b": 1.0}),
            &json!({"a": [1], "b": 1.00001})
        )
        .is_ok()
    );
    for (wanted, found) in [
        (json!(1.0), json!(1.01)),
        (json!({"a": 1}), json!({"a": 1, "b": 2})),
        (json!({"a": 1, "b": 2}), json!({"a": 1})),
        (json!([1, 2]), json!([1])),
        (json!("a"), json!("b")),
    ] {
        assert!(
            compare("x", &wanted, &found).is_err(),
            "{wanted} against {found}"
        );
    }
}

fn example_files() -> Vec<PathBuf> {
    let entries = fs::read_dir(Path::new(API).join("examples")).expect("api/examples");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

/// The result schemas of all methods, and that of errors.
struct Schemas {
    results: BTreeMap<String, jsonschema::Validator>,
    error: jsonschema::Validator,
}

impl Schemas {
    fn new() -> Self {
        let document = openrpc();
        let validator = |schema: &Value| {
            // References lead to the document's root, so its schemas come along.
            let mut schema = schema.clone();
            schema["components"] = document["components"].clone();
            jsonschema::draft7::new(&schema).expect("a schema")
        };
        let methods = document["methods"].as_array().expect("methods");
        let results = methods.iter().map(|method| {
            let name = method["name"].as_str().expect("a name").to_owned();
            (name, validator(&method["result"]["schema"]))
        });
        let error = json!({"$ref": "#/components/schemas/ErrorObject"});
        Self {
            results: results.collect(),
            error: validator(&error),
        }
    }

    fn check(&self, method: &str, reply: &Value) -> Result<(), String> {
        let (validator, found) = match (reply.get("error"), self.results.get(method)) {
            (Some(error), _) => (&self.error, error),
            (None, Some(validator)) => (validator, &reply["result"]),
            (None, None) => return Err(format!("a result of `{method}`, which is not described")),
        };
        validator
            .validate(found)
            .map_err(|error| format!("{method}: {} at {}", error, error.instance_path()))
    }
}

fn compare(path: &str, wanted: &Value, found: &Value) -> Result<(), String> {
    let differ = || Err(format!("{path}: expected {wanted}, but found {found}"));
    match (wanted, found) {
        (Value::String(any), _) if any == ANY => Ok(()),
        (Value::Object(wanted_members), Value::Object(found_members)) => {
            if !wanted_members.keys().eq(found_members.keys()) {
                return differ();
            }
            wanted_members.iter().try_for_each(|(key, value)| {
                compare(&format!("{path}.{key}"), value, &found_members[key])
            })
        }
        (Value::Array(wanted_items), Value::Array(found_items))
            if wanted_items.len() == found_items.len() =>
        {
            let items = wanted_items.iter().zip(found_items).enumerate();
            items
                .into_iter()
                .try_for_each(|(index, (a, b))| compare(&format!("{path}[{index}]"), a, b))
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (
                a.as_f64().unwrap_or(f64::NAN),
                b.as_f64().unwrap_or(f64::NAN),
            );
            if (a - b).abs() <= TOLERANCE * a.abs().max(1.0) {
                Ok(())
            } else {
                differ()
            }
        }
        _ if wanted == found => Ok(()),
        _ => differ(),
    }
}

/// A reply with what differs from run to run, or is too long to read, replaced.
fn elided(key: &str, value: &Value) -> Value {
    let varies = [
        "version",
        "uptime_s",
        "adapter",
        "timings_ms",
        "bytes_in",
        "bytes_out",
        "memory",
        "requests",
        "limits",
    ];
    match value {
        _ if varies.contains(&key) => json!(ANY),
        Value::Object(members) => {
            let is_picture = members.get("media").is_some();
            let shown = members.iter().map(|(key, value)| {
                let is_coded = key == "data" && value.is_string();
                let is_packed = is_picture && key == "bytes";
                (
                    key.clone(),
                    if is_coded || is_packed {
                        json!(ANY)
                    } else {
                        elided(key, value)
                    },
                )
            });
            let mut shown: serde_json::Map<_, _> = shown.collect();
            if shown.get("attach_bytes").is_some()
                && value["result"]["images"]["color"]["media"].is_string()
            {
                shown["attach_bytes"] = json!(ANY);
            }
            Value::Object(shown)
        }
        Value::Array(items) => items.iter().map(|item| elided("", item)).collect(),
        Value::Number(number) => {
            // Eight digits are what a reader wants to see.
            match number.as_f64().filter(|_| number.is_f64()) {
                Some(float) => json!((float * 1e6).round() / 1e6),
                None => value.clone(),
            }
        }
        _ => value.clone(),
    }
}
