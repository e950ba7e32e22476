//! JSON that is none, or none of glTF.

use super::{
    Break, accessor, assert_is_clear, assert_no_harm, assert_refused, broken, outcome, primitive,
    remove, text,
};
use crate::support::everything::{INDICES, TIMES, good};
use crate::support::gltf::Gltf;
use crate::support::rules::{RULES, Rule};
use crate::support::with_base64;
use serde_json::{Value, json};

#[test]
fn empty_things_do_no_harm() {
    let rows: [(&str, Break); 9] = [
        ("a mesh without primitives", |it| {
            it.json["meshes"][0]["primitives"] = json!([])
        }),
        ("no positions", |it| {
            remove(&mut primitive(it)["attributes"], "POSITION")
        }),
        ("no attributes", |it| {
            primitive(it)["attributes"] = json!({})
        }),
        ("no vertices", |it| {
            (0..7).for_each(|index| accessor(it, index)["count"] = json!(0))
        }),
        ("no indices", |it| accessor(it, INDICES)["count"] = json!(0)),
        ("no keys", |it| {
            (TIMES..TIMES + 3).for_each(|index| accessor(it, index)["count"] = json!(0))
        }),
        ("a scene without nodes", |it| {
            it.json["scenes"][0]["nodes"] = json!([])
        }),
        ("an animation without channels", |it| {
            it.json["animations"][0]["channels"] = json!([])
        }),
        ("an empty view", |it| {
            it.json["bufferViews"][0]["byteLength"] = json!(0)
        }),
    ];
    for (what, by) in rows {
        assert_no_harm(what, broken(by).files());
    }
}

#[test]
fn what_breaks_a_rule_is_told_by_name() {
    for Rule { what, by, told, .. } in RULES {
        let mut gltf = good();
        by(&mut gltf);
        match outcome(what, gltf.files()) {
            Ok(summary) if told.is_empty() => {
                assert_eq!(summary["warnings"], json!([]), "{what}");
            }
            Ok(summary) => {
                let warnings = summary["warnings"].as_array().expect("a list");
                let mut sentences = warnings.iter().filter_map(Value::as_str);
                let is_told = sentences.any(|it| it.contains(told));
                assert!(is_told, "{what}: no `{told}` in {warnings:?}");
            }
            Err(error) => {
                assert!(!told.is_empty(), "{what}: {error}");
                assert_is_clear(what, &error, "x.gltf", told);
            }
        }
    }
}

#[test]
fn an_index_past_32_bits_is_not_cut_to_one_that_is_there() {
    for index in [1_u64 << 32, (1 << 32) - 1, (1 << 40) + 1] {
        for (what, by) in [
            (
                "mesh",
                (|it, index| it.json["nodes"][2]["mesh"] = index) as fn(&mut Gltf, Value),
            ),
            ("node", |it, index| {
                it.json["animations"][0]["channels"][0]["target"]["node"] = index
            }),
            ("mode", |it, index| primitive(it)["mode"] = index),
        ] {
            let mut gltf = good();
            by(&mut gltf, json!(index));
            assert_refused(&format!("{what} {index}"), gltf.files(), &index.to_string());
        }
    }
}

#[test]
fn broken_json_is_told_where_it_breaks_and_in_plain_words() {
    for (content, told) in [
        (
            "{\"a\": }",
            "x.gltf:1:7: expected a value of JSON, but found `}`",
        ),
        (
            "{\n\"ä\": tru}",
            "x.gltf:2:9: expected a value of JSON, but found `}`",
        ),
        (
            "{\"a\" 1}",
            "x.gltf:1:6: expected `:` in the JSON, but found `1`",
        ),
        (
            "{\"a\": [1 2]}",
            "x.gltf:1:10: expected `,` or `]` in the JSON, but found `2`",
        ),
        (
            "{a: 1}",
            "x.gltf:1:2: expected a name in double quotes, but found `a`",
        ),
        (
            "{\n  \"a\": [1,",
            "x.gltf:2:10: expected more JSON, but found the end of the file",
        ),
        (
            "{} x",
            "x.gltf:1:4: expected nothing after the JSON, but found `x`",
        ),
        (
            "{\"a\": [1,]}",
            "x.gltf:1:10: expected JSON, but found trailing comma",
        ),
    ] {
        let error = outcome("json", text(content)).expect_err("it is no JSON");
        assert_eq!(error.message, told, "{content}");
    }
}

#[test]
fn a_member_of_the_wrong_kind_is_told_by_its_path() {
    for (member, told) in [
        (
            r#""nodes": [{"mesh": "a"}]"#,
            "expected nodes[0].mesh: an index, but found string \"a\"",
        ),
        (
            r#""accessors": [{"type": "SCALAR", "componentType": 5126}]"#,
            "expected accessors[0]: a member `count`, but found none",
        ),
        (
            r#""nodes": [3]"#,
            "expected nodes[0]: an object, but found integer `3`",
        ),
        (
            r#""nodes": [[]]"#,
            "expected nodes[0]: an object, but found a list of 0",
        ),
        (
            r#""accessors": [{"type": "SCALAR", "componentType": 5126, "count": "a"}]"#,
            "expected accessors[0].count: a whole number from 0, but found string \"a\"",
        ),
        (
            r#""nodes": [{"scale": 1}]"#,
            "expected nodes[0].scale: a list of 3, but found integer `1`",
        ),
        (
            r#""nodes": [{"scale": [1]}]"#,
            "expected nodes[0].scale: a list of 3, but found a list of 1",
        ),
        (
            r#""nodes": [{"mesh": 0}]"#,
            "expected nodes[0].mesh: no index, for the file has no meshes, but found 0",
        ),
    ] {
        let content = format!(r#"{{"asset": {{"version": "2.0"}}, {member}}}"#);
        assert_refused(member, text(&content), told);
    }
}

#[test]
fn text_that_is_no_gltf_is_refused() {
    let deep = 100_000;
    let nested = format!(
        r#"{{"asset": {{"version": "2.0"}}, "extras": {}{}}}"#,
        "[".repeat(deep),
        "]".repeat(deep)
    );
    let unclosed = r#"{"a":"#.repeat(deep);
    let whole = good().text();
    for (what, content, fragment) in [
        ("no text", "", "more JSON"),
        ("half a document", &whole[..whole.len() / 2], "more JSON"),
        (
            "something after the document",
            format!("{whole}{{}}").as_str(),
            "nothing after the JSON",
        ),
        ("a list", "[]", "asset.version"),
        ("a number", "2.0", "asset.version: glTF version 2.0"),
        ("an empty object", "{}", "asset"),
        ("no version", r#"{"asset": {}}"#, "version"),
        ("an old version", r#"{"asset": {"version": "1.0"}}"#, "1.0"),
        (
            "a version to come",
            r#"{"asset": {"version": "3.0"}}"#,
            "3.0",
        ),
        (
            "an old version that wants a new reader",
            r#"{"asset": {"version": "1.0", "minVersion": "2.0"}}"#,
            "1.0",
        ),
        (
            "a version that is none",
            r#"{"asset": {"version": "x", "minVersion": "2.0"}}"#,
            "version",
        ),
        (
            "a version of a number",
            r#"{"asset": {"version": 2.0}}"#,
            "version",
        ),
        (
            "nodes of a number",
            r#"{"asset": {"version": "2.0"}, "nodes": 3}"#,
            "nodes",
        ),
        (
            "nodes of numbers",
            r#"{"asset": {"version": "2.0"}, "nodes": [3]}"#,
            "nodes",
        ),
        (
            "a deep document",
            nested.as_str(),
            "JSON that is not nested deeper than 127 levels",
        ),
        (
            "a deep document without an end",
            unclosed.as_str(),
            "JSON that is not nested deeper than 127 levels",
        ),
    ] {
        assert_refused(what, text(content), fragment);
    }
    let mut bytes = whole.into_bytes();
    let at = bytes
        .windows(5)
        .position(|five| five == b"cloth")
        .expect("the mesh's name");
    bytes[at] = 0xFF;
    assert_refused("not UTF-8", json!([with_base64("x.gltf", &bytes)]), "UTF-8");
}
