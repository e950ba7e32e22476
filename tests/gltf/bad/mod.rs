//! Is a glTF file that breaks its own rules answered with a clear error, and never with a panic, a hang or a huge allocation?

mod accessors;
mod binary;
mod files;
mod json;
mod motion;
mod mutated;
mod nodes;
mod pictures;
mod primitives;

use crate::SERVICE;
use crate::support::everything::good;
use crate::support::gltf::Gltf;
use crate::support::{ask, ask_ok, time_at_work, with_base64};
use allocation_counter::measure;
use rigd::protocol::ErrorObject;
use serde_json::{Value, json};
use std::time::Duration;

/// What a small file may take: the largest of them is some hundred kilobytes of text, of which there are a few copies.
const MOST_BYTES: u64 = 64 << 20;

/// Far more than any of them takes, and far less than it takes to count to 2³¹.
const MOST_TIME: Duration = Duration::from_secs(10);

fn rigs() -> Value {
    ask_ok(&SERVICE, "rig.list", json!({}))
}

/// What loading comes to, within bounds of time and memory whatever that is. Nothing is left loaded.
fn outcome(what: &str, files: Value) -> Result<Value, ErrorObject> {
    let params = json!({"name": format!("bad {what}"), "files": files});
    let start = time_at_work();
    let mut found = None;
    let taken = measure(|| found = Some(ask(&SERVICE, "rig.load", params)));
    let time = time_at_work() - start;
    assert!(time < MOST_TIME, "{what}: {time:?}");
    assert!(taken.bytes_max < MOST_BYTES, "{what}: {taken:?}");
    assert_eq!(ask_ok(&SERVICE, "server.ping", json!({})), json!({}));
    let found = found.expect("it was asked");
    if let Ok(summary) = &found {
        // What is let in has to work.
        let rig = json!({"rig": summary["name"]});
        ask_ok(&SERVICE, "mesh.vertices", rig.clone());
        ask_ok(&SERVICE, "joint.transforms", rig.clone());
        let frame = json!({"rig": summary["name"], "size": [8, 8]});
        ask_ok(&SERVICE, "frame.render", frame);
        ask_ok(&SERVICE, "rig.unload", rig);
    }
    let listed = rigs();
    let listed = listed["rigs"].as_array().expect("a list");
    let name = json!(format!("bad {what}"));
    assert!(listed.iter().all(|rig| rig["name"] != name), "{what}");
    found
}

/// A clear fault of this file, in whose message the fragment stands.
fn assert_is_clear(what: &str, error: &ErrorObject, file: &str, fragment: &str) {
    let message = &error.message;
    assert_eq!(error.data.kind, "rig_file_invalid", "{what}: {message}");
    assert_eq!(error.code, -32001, "{what}");
    assert_eq!(
        error.detail("file"),
        Some(&json!(file)),
        "{what}: {message}"
    );
    assert!(
        message.len() < 600 && !message.contains('\n'),
        "{what}: {message}"
    );
    assert!(
        message.contains(fragment),
        "{what}: no `{fragment}` in `{message}`"
    );
}

fn assert_refused(what: &str, files: Value, fragment: &str) {
    match outcome(what, files) {
        Ok(summary) => panic!("{what}: loaded as {summary}"),
        Err(error) => assert_is_clear(what, &error, "x.gltf", fragment),
    }
}

/// As [`assert_refused`]; a limit may speak first, or the rig may be loaded after all: both sound ends.
fn assert_no_harm(what: &str, files: Value) {
    match outcome(what, files) {
        Ok(_) => {}
        Err(error) if error.data.kind == "limit_exceeded" => {}
        Err(error) => assert_is_clear(what, &error, "x.gltf", ""),
    }
}

type Break = fn(&mut Gltf);

fn broken(by: Break) -> Gltf {
    let mut gltf = good();
    by(&mut gltf);
    gltf
}

/// What, how, and what the message has to speak of.
fn assert_all_refused(rows: &[(&str, Break, &str)]) {
    for &(what, by, fragment) in rows {
        assert_refused(what, broken(by).files(), fragment);
    }
}

fn remove(object: &mut Value, member: &str) {
    let members = object.as_object_mut().expect("an object");
    members.remove(member).expect("it was there");
}

fn primitive(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["meshes"][0]["primitives"][0]
}

fn accessor(gltf: &mut Gltf, index: usize) -> &mut Value {
    &mut gltf.json["accessors"][index]
}

#[test]
fn the_file_used_here_is_sound() {
    for files in [good().files(), json!([with_base64("x.glb", &good().glb())])] {
        let summary = outcome("nothing", files).expect("it is sound");
        assert_eq!(summary["warnings"], json!([]));
        for (count, wanted) in [
            ("joint_count", 3),
            ("vertex_count", 3),
            ("morph_count", 1),
            ("clip_count", 1),
        ] {
            assert_eq!(summary[count], wanted, "{count}");
        }
    }
}

fn sampler(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["animations"][0]["samplers"][0]
}

fn text(content: &str) -> Value {
    json!([{"name": "x.gltf", "text": content}])
}
