//! Is a glTF file that breaks its own rules answered with a clear error, and never with a panic, a hang or a huge allocation?

mod support;

use allocation_counter::measure;
use rigd::formats::{File, FileRef, LoadError, Source, load};
use rigd::limits::Limits;
use rigd::pose::{ClipAt, Pose, PoseEdit, Posed, Skinning};
use rigd::protocol::ErrorObject;
use rigd::render::cpu::skin_mesh;
use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use std::time::Duration;
use support::everything::{
    BOUND, INDICES, JOINTS, POSITIONS, TARGET, TEXCOORDS, TIMES, TURNS, WEIGHTS, good, picture,
};
use support::gltf::{Gltf, glb, glb_of};
use support::random::Random;
use support::rules::{RULES, Rule};
use support::{ask, ask_ok, time_at_work, with_base64};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

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

#[test]
fn nodes_that_are_no_tree_are_refused() {
    assert_all_refused(&[
        (
            "a child of itself",
            |it| it.json["nodes"][1]["children"] = json!([1]),
            "nodes",
        ),
        (
            "a ring of two",
            |it| it.json["nodes"][1]["children"] = json!([0]),
            "nodes",
        ),
        (
            "a ring beside the scene",
            |it| {
                it.node(json!({"children": [4]}));
                it.node(json!({"children": [3]}));
            },
            "nodes",
        ),
        (
            "two parents",
            |it| it.json["nodes"][2]["children"] = json!([1]),
            "nodes",
        ),
        (
            "a child twice",
            |it| it.json["nodes"][0]["children"] = json!([1, 1]),
            "nodes",
        ),
        (
            "no such child",
            |it| it.json["nodes"][1]["children"] = json!([77]),
            "77",
        ),
        (
            "a child before the first",
            |it| it.json["nodes"][1]["children"] = json!([-1]),
            "-1",
        ),
        (
            "half a child",
            |it| it.json["nodes"][1]["children"] = json!([1.5]),
            "1.5",
        ),
        (
            "no such node in the scene",
            |it| it.json["scenes"][0]["nodes"] = json!([0, 77]),
            "77",
        ),
        ("no such scene", |it| it.json["scene"] = json!(77), "77"),
        (
            "no such mesh",
            |it| it.json["nodes"][2]["mesh"] = json!(77),
            "77",
        ),
        (
            "no such skin",
            |it| it.json["nodes"][2]["skin"] = json!(77),
            "77",
        ),
        (
            "a translation of two",
            |it| it.json["nodes"][1]["translation"] = json!([1, 2]),
            "nodes",
        ),
        (
            "a rotation of three",
            |it| it.json["nodes"][1]["rotation"] = json!([0, 0, 1]),
            "nodes",
        ),
        (
            "a matrix of fifteen",
            |it| it.json["nodes"][1]["matrix"] = json!(vec![1.0; 15]),
            "nodes",
        ),
        (
            "a scale of words",
            |it| it.json["nodes"][1]["scale"] = json!(["a", "b", "c"]),
            "nodes",
        ),
    ]);
}

#[test]
fn numbers_of_nodes_that_cannot_be_worked_with_do_no_harm() {
    let rows: [(&str, Break); 5] = [
        ("no rotation", |it| {
            it.json["nodes"][1]["rotation"] = json!([0, 0, 0, 0])
        }),
        ("a long rotation", |it| {
            it.json["nodes"][1]["rotation"] = json!([0, 0, 1e200, 1e200])
        }),
        ("a flat scale", |it| {
            it.json["nodes"][1]["scale"] = json!([0, 0, 0])
        }),
        ("a matrix of zeros", |it| {
            it.json["nodes"][1]["matrix"] = json!(vec![0; 16])
        }),
        ("a matrix that shears", |it| {
            it.json["nodes"][1]["matrix"] = json!([1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
        }),
    ];
    for (what, by) in rows {
        assert_no_harm(what, broken(by).files());
    }
    for member in ["translation", "rotation", "scale", "matrix"] {
        for number in ["1e999", "-1e999", "1e300", "NaN", "null"] {
            let mut gltf = good();
            let tip = &mut gltf.json["nodes"][1];
            remove(tip, "translation");
            let mut numbers = vec![
                json!(0);
                match member {
                    "matrix" => 16,
                    "rotation" => 4,
                    _ => 3,
                }
            ];
            numbers[0] = json!(987_654_321);
            tip[member] = json!(numbers);
            let text = gltf.text().replace("987654321", number);
            let what = format!("{member} of {number}");
            let files = json!([{"name": "x.gltf", "text": text}]);
            if (member, number) == ("rotation", "1e300") {
                // Of a quaternion only the direction counts.
                assert_no_harm(&what, files);
            } else {
                assert_refused(&what, files, "");
            }
        }
    }
}

#[test]
fn what_lies_outside_of_its_buffer_is_refused() {
    assert_all_refused(&[
        (
            "no such view",
            |it| accessor(it, POSITIONS)["bufferView"] = json!(77),
            "77",
        ),
        (
            "no such buffer",
            |it| it.json["bufferViews"][0]["buffer"] = json!(77),
            "77",
        ),
        (
            "no such accessor",
            |it| primitive(it)["attributes"]["POSITION"] = json!(77),
            "77",
        ),
        (
            "more than the view holds",
            |it| accessor(it, TARGET)["count"] = json!(4),
            "",
        ),
        (
            "an offset past the view",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(4),
            "accessors[0]",
        ),
        (
            "a view past the buffer",
            |it| it.json["bufferViews"][0]["byteLength"] = json!(1_000_000),
            "ufferView",
        ),
        (
            "a view from past the buffer",
            |it| it.json["bufferViews"][0]["byteOffset"] = json!(1_000_000),
            "ufferView",
        ),
        (
            "an offset of the view of 2^64-1",
            |it| it.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
            "",
        ),
        (
            "a length of the view of 2^64-1",
            |it| it.json["bufferViews"][0]["byteLength"] = json!(u64::MAX),
            "",
        ),
        (
            "an offset of the view of 2^63",
            |it| it.json["bufferViews"][0]["byteOffset"] = json!(1_u64 << 63),
            "",
        ),
        (
            "an offset of 2^64-1",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(u64::MAX),
            "",
        ),
        (
            "an offset of 2^64-4",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(u64::MAX - 3),
            "",
        ),
        (
            "an offset of 2^63",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(1_u64 << 63),
            "",
        ),
        (
            "an offset below zero",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(-4),
            "",
        ),
        (
            "a stride below its element",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(8),
            "",
        ),
        (
            "a stride of 256",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(256),
            "",
        ),
        (
            "a stride of 2^64-1",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(u64::MAX),
            "",
        ),
        (
            "a stride past the view",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(16),
            "",
        ),
        (
            "a buffer longer than its bytes",
            |it| {
                it.json["buffers"] =
                    json!([{"byteLength": it.bytes.len() + 1, "uri": it.data_uri()}])
            },
            "buffers[0]",
        ),
        (
            "a buffer of 2^64-1 bytes",
            |it| it.json["buffers"] = json!([{"byteLength": u64::MAX, "uri": it.data_uri()}]),
            "",
        ),
        (
            "a buffer that is nowhere",
            |it| it.json["buffers"] = json!([{"byteLength": it.bytes.len()}]),
            "buffers[0]",
        ),
        (
            "sparse indices out of range",
            |it| {
                let (at, values) = (it.view(&[200]), it.view(&[0; 12]));
                accessor(it, POSITIONS)["sparse"] = json!({"count": 1, "values": {"bufferView": values},
                    "indices": {"bufferView": at, "componentType": 5121}});
            },
            "accessors[0]",
        ),
        (
            "sparse indices that do not ascend",
            |it| {
                let (at, values) = (it.view(&[1, 1]), it.view(&[0; 24]));
                accessor(it, POSITIONS)["sparse"] = json!({"count": 2, "values": {"bufferView": values},
                    "indices": {"bufferView": at, "componentType": 5121}});
            },
            "accessors[0]",
        ),
        (
            "more sparse values than there are",
            |it| {
                let (at, values) = (it.view(&[0, 1]), it.view(&[0; 12]));
                accessor(it, POSITIONS)["sparse"] = json!({"count": 2, "values": {"bufferView": values},
                    "indices": {"bufferView": at, "componentType": 5121}});
            },
            "accessors[0]",
        ),
    ]);
}

#[test]
fn counts_that_nothing_stands_behind_take_no_memory() {
    for count in [1_u64 << 31, 1 << 53, u64::MAX] {
        for index in [POSITIONS, JOINTS, INDICES, TARGET, TIMES, TURNS] {
            for is_sparse in [false, true] {
                let mut gltf = good();
                let (at, values) = (gltf.view(&[0]), gltf.view(&[0; 64]));
                let accessor = accessor(&mut gltf, index);
                remove(accessor, "bufferView");
                accessor["count"] = json!(count);
                if is_sparse {
                    accessor["sparse"] = json!({"count": 1, "values": {"bufferView": values},
                        "indices": {"bufferView": at, "componentType": 5121}});
                }
                let what = format!("accessors[{index}] of {count} zeros, sparse: {is_sparse}");
                let error = outcome(&what, gltf.files()).expect_err("far too many");
                let kind = error.data.kind.as_str();
                assert!(
                    ["rig_file_invalid", "limit_exceeded"].contains(&kind),
                    "{what}: {kind}"
                );
            }
        }
        // There may be more matrices than joints, and nobody needs to read them.
        let mut gltf = good();
        let bound = accessor(&mut gltf, BOUND);
        remove(bound, "bufferView");
        bound["count"] = json!(count);
        assert_no_harm(&format!("{count} matrices"), gltf.files());
        // All attributes agree on it.
        let mut gltf = good();
        for index in 0..7 {
            let accessor = accessor(&mut gltf, index);
            remove(accessor, "bufferView");
            accessor["count"] = json!(count);
        }
        let error = outcome(&format!("{count} of all"), gltf.files()).expect_err("far too many");
        assert!(["rig_file_invalid", "limit_exceeded"].contains(&error.data.kind.as_str()));
        let mut gltf = good();
        let (at, values) = (gltf.view(&[0]), gltf.view(&[0; 12]));
        accessor(&mut gltf, POSITIONS)["sparse"] = json!({"count": count, "values": {"bufferView": values},
            "indices": {"bufferView": at, "componentType": 5121}});
        assert_refused(&format!("{count} sparse"), gltf.files(), "");
    }
}

#[test]
fn attributes_of_the_wrong_kind_are_refused() {
    assert_all_refused(&[
        (
            "positions of two",
            |it| accessor(it, POSITIONS)["type"] = json!("VEC2"),
            "",
        ),
        (
            "positions of a word",
            |it| accessor(it, POSITIONS)["type"] = json!("VEC5"),
            "VEC5",
        ),
        (
            "positions of whole numbers",
            |it| accessor(it, POSITIONS)["componentType"] = json!(5125),
            "",
        ),
        (
            "components of nothing",
            |it| accessor(it, POSITIONS)["componentType"] = json!(5127),
            "5127",
        ),
        (
            "joints of floats",
            |it| primitive(it)["attributes"]["JOINTS_0"] = json!(WEIGHTS),
            "",
        ),
        (
            "weights of bare bytes",
            |it| primitive(it)["attributes"]["WEIGHTS_0"] = json!(JOINTS),
            "",
        ),
        (
            "weights of three",
            |it| primitive(it)["attributes"]["WEIGHTS_0"] = json!(POSITIONS),
            "",
        ),
        (
            "texture coordinates of three",
            |it| primitive(it)["attributes"]["TEXCOORD_0"] = json!(POSITIONS),
            "",
        ),
        (
            "normals of two",
            |it| primitive(it)["attributes"]["NORMAL"] = json!(TEXCOORDS),
            "",
        ),
        (
            "indices of floats",
            |it| primitive(it)["indices"] = json!(TIMES),
            "",
        ),
        (
            "indices of signed numbers",
            |it| accessor(it, INDICES)["componentType"] = json!(5122),
            "",
        ),
        (
            "indices of vectors",
            |it| primitive(it)["indices"] = json!(JOINTS),
            "",
        ),
        (
            "a mode of nobody",
            |it| primitive(it)["mode"] = json!(7),
            "7",
        ),
        (
            "fewer normals than positions",
            |it| accessor(it, 1)["count"] = json!(2),
            "",
        ),
        (
            "joints without weights",
            |it| remove(&mut primitive(it)["attributes"], "WEIGHTS_0"),
            "",
        ),
        (
            "weights without joints",
            |it| remove(&mut primitive(it)["attributes"], "JOINTS_0"),
            "",
        ),
        (
            "positions of NaN",
            |it| it.set_float(POSITIONS, 4, f32::NAN),
            "",
        ),
        (
            "positions of infinity",
            |it| it.set_float(POSITIONS, 4, f32::INFINITY),
            "",
        ),
        (
            "weights of NaN",
            |it| it.set_float(WEIGHTS, 1, f32::NAN),
            "",
        ),
        (
            "no such material",
            |it| primitive(it)["material"] = json!(77),
            "77",
        ),
        (
            "one index past the vertices",
            |it| {
                let at = it.start_of(INDICES) + 2;
                it.bytes[at] = 255;
            },
            "255",
        ),
        (
            "all indices past the vertices",
            |it| {
                let at = it.start_of(INDICES);
                it.bytes[at..at + 6].fill(0x55);
            },
            "21845",
        ),
    ]);
}

#[test]
fn skins_that_do_not_fit_are_refused() {
    assert_all_refused(&[
        (
            "a joint past the skin's",
            |it| {
                let at = it.start_of(JOINTS);
                it.bytes[at] = 99;
            },
            "99",
        ),
        (
            "no such joint",
            |it| it.json["skins"][0]["joints"] = json!([0, 77]),
            "77",
        ),
        (
            "no joints",
            |it| it.json["skins"][0]["joints"] = json!([]),
            "skins",
        ),
        (
            "a joint twice",
            |it| it.json["skins"][0]["joints"] = json!([1, 1]),
            "skins",
        ),
        (
            "too few matrices",
            |it| accessor(it, BOUND)["count"] = json!(1),
            "",
        ),
        (
            "no such matrices",
            |it| it.json["skins"][0]["inverseBindMatrices"] = json!(77),
            "77",
        ),
        (
            "matrices of four",
            |it| it.json["skins"][0]["inverseBindMatrices"] = json!(WEIGHTS),
            "",
        ),
        ("a matrix of NaN", |it| it.set_float(BOUND, 5, f32::NAN), ""),
        (
            "a matrix of infinity",
            |it| it.set_float(BOUND, 28, f32::NEG_INFINITY),
            "",
        ),
    ]);
}

fn channel(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["animations"][0]["channels"][0]
}

fn sampler(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["animations"][0]["samplers"][0]
}

#[test]
fn animations_that_do_not_add_up_are_refused() {
    assert_all_refused(&[
        (
            "fewer values than keys",
            |it| accessor(it, TURNS)["count"] = json!(1),
            "",
        ),
        (
            "fewer keys than values",
            |it| accessor(it, TIMES)["count"] = json!(1),
            "",
        ),
        (
            "a third of a spline",
            |it| sampler(it)["interpolation"] = json!("CUBICSPLINE"),
            "",
        ),
        ("keys out of order", |it| it.set_float(TIMES, 1, -1.0), ""),
        ("a time of NaN", |it| it.set_float(TIMES, 1, f32::NAN), ""),
        (
            "a time of infinity",
            |it| it.set_float(TIMES, 1, f32::INFINITY),
            "",
        ),
        ("a value of NaN", |it| it.set_float(TURNS, 1, f32::NAN), ""),
        (
            "a value of infinity",
            |it| it.set_float(TURNS, 1, f32::INFINITY),
            "",
        ),
        (
            "times of vectors",
            |it| sampler(it)["input"] = json!(POSITIONS),
            "",
        ),
        (
            "times of whole numbers",
            |it| sampler(it)["input"] = json!(INDICES),
            "",
        ),
        (
            "rotations of three",
            |it| sampler(it)["output"] = json!(POSITIONS),
            "",
        ),
        ("no such times", |it| sampler(it)["input"] = json!(77), "77"),
        (
            "no such values",
            |it| sampler(it)["output"] = json!(77),
            "77",
        ),
        (
            "no such sampler",
            |it| channel(it)["sampler"] = json!(77),
            "77",
        ),
        (
            "no such target",
            |it| channel(it)["target"]["node"] = json!(77),
            "77",
        ),
    ]);
}

#[test]
fn morph_targets_that_do_not_fit_are_refused() {
    assert_all_refused(&[
        (
            "fewer displacements than vertices",
            |it| accessor(it, TARGET)["count"] = json!(2),
            "",
        ),
        (
            "displacements of two",
            |it| primitive(it)["targets"][0]["POSITION"] = json!(TEXCOORDS),
            "",
        ),
        (
            "no such displacements",
            |it| primitive(it)["targets"][0]["POSITION"] = json!(77),
            "77",
        ),
        (
            "a displacement of NaN",
            |it| it.set_float(TARGET, 0, f32::NAN),
            "",
        ),
        (
            "more weights than targets",
            |it| it.json["meshes"][0]["weights"] = json!([0, 0]),
            "weights",
        ),
        (
            "more weights of the node",
            |it| it.json["nodes"][2]["weights"] = json!([0, 0]),
            "weights",
        ),
        (
            "primitives that differ in their targets",
            |it| {
                let mut other = primitive(it).clone();
                other["targets"] = json!([]);
                let primitives = it.json["meshes"][0]["primitives"].as_array_mut();
                primitives.expect("a list").push(other);
            },
            "meshes[0]",
        ),
    ]);
}

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

fn text(content: &str) -> Value {
    json!([{"name": "x.gltf", "text": content}])
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
        ("no text", "", ""),
        ("half a document", &whole[..whole.len() / 2], ""),
        (
            "something after the document",
            format!("{whole}{{}}").as_str(),
            "",
        ),
        ("a list", "[]", ""),
        ("a number", "2.0", ""),
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
        ("a deep document", nested.as_str(), ""),
        ("a deep document without an end", unclosed.as_str(), ""),
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

#[test]
fn a_binary_file_cut_anywhere_is_a_clear_fault() {
    let whole = good().glb();
    for end in 0..whole.len() {
        let what = format!("cut at {end}");
        let params = json!({"name": what, "files": [with_base64("x.glb", &whole[..end])]});
        match ask(&SERVICE, "rig.load", params) {
            Ok(summary) => panic!("{what}: loaded as {summary}"),
            Err(error) => assert_is_clear(&what, &error, "x.glb", ""),
        }
    }
    assert_eq!(ask_ok(&SERVICE, "server.ping", json!({})), json!({}));
}

#[test]
fn a_binary_file_that_lies_about_itself_is_refused() {
    let whole = good().glb();
    let with = |at: usize, number: u32| {
        let mut file = whole.clone();
        file[at..at + 4].copy_from_slice(&number.to_le_bytes());
        file
    };
    let length = whole.len() as u32;
    let sound = good();
    let json = sound.document(None).to_string();
    let padded = format!("{json:width$}", width = json.len().next_multiple_of(4));
    let (json, bytes) = (padded.as_bytes(), &sound.bytes[..]);
    let mut garbled = json.to_vec();
    let at = json
        .windows(5)
        .position(|five| five == b"cloth")
        .expect("the mesh's name");
    garbled[at] = 0xFF;
    let json_length = json.len() as u32;
    for (what, file) in [
        ("a version of 0", with(4, 0)),
        ("a version of 1", with(4, 1)),
        ("a version of 3", with(4, 3)),
        ("a longer file", with(8, length + 4)),
        ("a file of 4 GiB", with(8, u32::MAX)),
        ("a file of its header", with(8, 12)),
        ("a file of nothing", with(8, 0)),
        ("a first chunk of 4 GiB", with(12, u32::MAX)),
        ("a first chunk past the end", with(12, length)),
        ("a first chunk of nothing", with(12, 0)),
        ("a first chunk cut short", with(12, json_length - 8)),
        ("a second chunk of 4 GiB", with(20 + json.len(), u32::MAX)),
        ("a second chunk of nothing", with(20 + json.len(), 0)),
        (
            "a first chunk of another kind",
            with(16, u32::from_le_bytes(*b"JSOM")),
        ),
        (
            "bytes first",
            glb_of(&[(*b"BIN\0", bytes), (*b"JSON", json)]),
        ),
        ("no bytes", glb_of(&[(*b"JSON", json)])),
        ("no chunk", glb_of(&[])),
        ("not UTF-8", glb(&garbled, bytes)),
        ("no document", glb(b"{}", bytes)),
    ] {
        match outcome(what, json!([with_base64("x.glb", &file)])) {
            Ok(summary) => panic!("{what}: loaded as {summary}"),
            Err(error) => assert_is_clear(what, &error, "x.glb", ""),
        }
    }
}

#[test]
fn chunks_of_other_types_are_passed_over() {
    let sound = good();
    let document = sound.document(None).to_string();
    let json = format!(
        "{document:width$}",
        width = document.len().next_multiple_of(4)
    );
    let (json, bytes, other) = (
        (*b"JSON", json.as_bytes()),
        &sound.bytes[..],
        (*b"TEST", &b"abcd"[..]),
    );
    let bytes = (*b"BIN\0", bytes);
    let mut longer = sound.glb();
    longer.extend(b"abcd");
    for (what, file, told) in [
        (
            "after the bytes",
            glb_of(&[json, bytes, other]),
            "unknown type `TEST`",
        ),
        (
            "before the bytes",
            glb_of(&[json, other, bytes]),
            "not the second one",
        ),
        (
            "empty",
            glb_of(&[json, bytes, (*b"TEST", b"")]),
            "unknown type `TEST`",
        ),
        (
            "twice the bytes",
            glb_of(&[json, bytes, bytes]),
            "a further chunk `BIN`",
        ),
        (
            "two documents",
            glb_of(&[json, bytes, json]),
            "a further chunk `JSON`",
        ),
        (
            "more than its header tells of",
            longer,
            "4 bytes after its end",
        ),
        (
            "more bytes than the buffer has",
            glb_of(&[json, (*b"BIN\0", &[bytes.1, b"abcd"].concat())]),
            "bytes, but a byteLength of",
        ),
        (
            "a document padded with NUL bytes",
            glb(&[json.1, b"\0\0\0\0"].concat(), bytes.1),
            "4 NUL bytes after the JSON",
        ),
    ] {
        let summary = outcome(what, json!([with_base64("x.glb", &file)])).expect(what);
        assert!(
            summary["warnings"].to_string().contains(told),
            "{what}: {summary}"
        );
    }
}

#[test]
fn nul_bytes_after_a_document_are_passed_over() {
    let content = good().text() + "\n\0\0";
    let summary = outcome("NUL", text(&content)).expect("it is sound");
    let warnings = summary["warnings"].to_string();
    assert!(
        warnings.contains("2 NUL bytes after the JSON"),
        "{warnings}"
    );
}

#[test]
fn a_data_uri_is_base64_however_it_says_so() {
    let gltf = good();
    let uri = gltf.data_uri();
    for marker in ["; base64,", ";BASE64 ,", ";base64;charset=x,", "%3Bbase64,"] {
        let uri = uri.replace(";base64,", marker);
        let content = gltf.document(Some(&uri)).to_string();
        outcome(marker, text(&content)).expect("it is sound");
    }
}

#[test]
fn a_buffer_is_found_beside_its_file_or_nowhere() {
    let gltf = good();
    for uri in [
        "missing.bin",
        "../x.bin",
        "a/../../x.bin",
        "%2e%2e/x.bin",
        "..%2Fx.bin",
        "..\\x.bin",
        "/etc/passwd",
        "//host/x.bin",
        "file:///etc/passwd",
        "file:x.bin",
        "http://localhost/x.bin",
        "https://localhost/x.bin",
        "C:\\x",
        "C:/x",
        "x.bin%00",
        "x%zz.bin",
        "",
        "x.gltf",
        "data:",
        "data:,",
        "data:application/octet-stream;base64,",
        "data:application/octet-stream;base64,!!!!",
        "data:application/octet-stream;base64,AAA",
        "data:application/octet-stream;base64,AAAA",
        "data:application/octet-stream,AAAA",
    ] {
        let content = gltf.document(Some(uri)).to_string();
        assert_refused(&format!("a buffer at `{uri}`"), text(&content), "");
    }
}

#[test]
fn a_buffer_outside_of_the_root_is_not_opened() {
    let base = support::places::output("bad_gltf");
    let root = base.join("root");
    std::fs::create_dir_all(&root).expect("a folder of the tests' own");
    let gltf = good();
    for secret in [base.join("secret.bin"), root.join("beside.bin")] {
        std::fs::write(secret, &gltf.bytes).expect("it can be written");
    }
    let outside = base.join("secret.bin");
    let outside = outside.to_str().expect("UTF-8");
    let source = Source::rooted(&root).expect("the folder is there");
    let service = support::service_with(Limits::default(), source);
    let load = |uri: &str| {
        let content = gltf.document(Some(uri)).to_string();
        std::fs::write(root.join("x.gltf"), content).expect("it can be written");
        let params = json!({"name": "rooted", "files": ["x.gltf"], "replace": true});
        ask(&service, "rig.load", params)
    };
    load("beside.bin").expect("it lies beside");
    for uri in [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "..%2fsecret.bin",
        "../root/../secret.bin",
        outside,
        format!("file://{outside}").as_str(),
    ] {
        let error = load(uri).expect_err("it lies outside");
        assert_is_clear(uri, &error, "x.gltf", "");
        // Neither may the server's own paths be told.
        let folder = base.to_str().expect("UTF-8");
        assert!(
            uri.contains(folder) || !error.message.contains(folder),
            "{}",
            error.message
        );
    }
}

/// CRC-32 as PNG has it, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _: u32| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
    !bytes
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

/// The picture with another size in its header, and its checksum right.
fn sized(width: u32, height: u32) -> Vec<u8> {
    let mut file = picture();
    // 8 bytes of signature, length and name of the first chunk; then width and height; 13 bytes of content in all.
    file[16..20].copy_from_slice(&width.to_be_bytes());
    file[20..24].copy_from_slice(&height.to_be_bytes());
    let checksum = crc(&file[12..29]);
    file[29..33].copy_from_slice(&checksum.to_be_bytes());
    file
}

#[test]
fn pictures_that_are_broken_or_missing_do_no_harm() {
    // Or the checksum alone would be the fault.
    assert_eq!(sized(2, 2), picture());
    let whole = picture();
    let embedded = |bytes: &[u8], media: &str| {
        let mut gltf = good();
        let view = gltf.view(bytes);
        gltf.json["images"][0] = json!({"bufferView": view, "mimeType": media});
        gltf
    };
    let image = |image: Value| {
        let mut gltf = good();
        gltf.json["images"][0] = image;
        gltf
    };
    for (what, gltf) in [
        (
            "a picture of 60000x60000",
            embedded(&sized(60_000, 60_000), "image/png"),
        ),
        (
            "a picture of 2^31-1",
            embedded(&sized(i32::MAX as u32, i32::MAX as u32), "image/png"),
        ),
        ("a picture of nothing", embedded(&sized(0, 0), "image/png")),
        (
            "half a picture",
            embedded(&whole[..whole.len() / 2], "image/png"),
        ),
        ("a header of a picture", embedded(&whole[..8], "image/png")),
        ("an empty picture", embedded(&[], "image/png")),
        ("a picture of another kind", embedded(&whole, "image/jpeg")),
        ("a picture of no kind", embedded(&whole, "image/x-nobody")),
        ("no picture", embedded(b"hello there", "image/png")),
        (
            "a picture that is missing",
            image(json!({"uri": "missing.png"})),
        ),
        ("a picture outside", image(json!({"uri": "../x.png"}))),
        (
            "a picture of the system",
            image(json!({"uri": "file:///etc/passwd"})),
        ),
        (
            "a picture elsewhere",
            image(json!({"uri": "http://localhost/x.png"})),
        ),
        (
            "a picture of broken base64",
            image(json!({"uri": "data:image/png;base64,!!!!"})),
        ),
        (
            "a picture in no such view",
            image(json!({"bufferView": 77, "mimeType": "image/png"})),
        ),
        ("a picture that is nowhere", image(json!({}))),
        (
            "no such image",
            broken(|it| it.json["textures"][0]["source"] = json!(77)),
        ),
        (
            "no such sampler of a texture",
            broken(|it| it.json["textures"][0]["sampler"] = json!(77)),
        ),
        (
            "a texture of nothing",
            broken(|it| it.json["textures"][0] = json!({})),
        ),
        (
            "a wrap of nobody",
            broken(|it| it.json["samplers"][0]["wrapS"] = json!(7)),
        ),
        (
            "no such texture",
            broken(|it| {
                it.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
                    json!(77)
            }),
        ),
        (
            "texture coordinates that are not there",
            broken(|it| {
                it.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] =
                    json!(7)
            }),
        ),
    ] {
        match outcome(what, gltf.files()) {
            // A wrap of nobody and a picture whose kind is told wrongly may be taken for what they are.
            Ok(summary) => assert!(summary["warnings"].is_array(), "{what}"),
            Err(error) => {
                let kind = error.data.kind.as_str();
                assert!(
                    ["rig_file_invalid", "limit_exceeded"].contains(&kind),
                    "{what}: {kind}"
                );
            }
        }
    }
}

#[test]
fn colors_out_of_range_do_no_harm() {
    for factor in [
        json!([2, 2, 2, 2]),
        json!([-1, 0, 0, 1]),
        json!([1, 1]),
        json!("red"),
        json!([1e300, 0, 0, 1]),
    ] {
        let mut gltf = good();
        gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = factor.clone();
        assert_no_harm(&format!("a color of {factor}"), gltf.files());
    }
}

/// Puts something else in the place of a member somewhere in a document, or takes it away.
fn mutate(random: &mut Random, value: &mut Value) {
    let inside = match value {
        Value::Array(items) if !items.is_empty() && random.below(8) > 0 => {
            let at = random.below(items.len());
            if random.below(12) == 0 {
                items.remove(at);
                return;
            }
            &mut items[at]
        }
        Value::Object(members) if !members.is_empty() && random.below(8) > 0 => {
            let keys: Vec<String> = members.keys().cloned().collect();
            let key = &keys[random.below(keys.len())];
            if random.below(12) == 0 {
                members.remove(key);
                return;
            }
            members.get_mut(key).expect("it is there")
        }
        leaf => {
            let others = [
                json!(null),
                json!(true),
                json!(-1),
                json!(0),
                json!(1),
                json!(2),
                json!(7),
                json!(255),
                json!(5126),
                json!(4294967295u32),
                json!(9007199254740993u64),
                json!(u64::MAX),
                json!(0.5),
                json!(-1e9),
                json!(1e300),
                json!("MAT4"),
                json!("translation"),
                json!("CUBICSPLINE"),
                json!([]),
                json!([0]),
                json!([0, 0, 0]),
                json!({}),
            ];
            *leaf = others[random.below(others.len())].clone();
            return;
        }
    };
    mutate(random, inside);
}

#[test]
fn mutated_documents_give_a_rig_that_works_or_a_clear_fault() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let (mut rigs, mut faults) = (0, 0);
    for _ in 0..6000 {
        let mut gltf = good();
        for _ in 0..=random.below(2) {
            let members = gltf.json.as_object_mut().expect("an object");
            let lists: Vec<String> = members.keys().cloned().collect();
            let list = &lists[random.below(lists.len())];
            mutate(&mut random, &mut members[list]);
        }
        for _ in 0..random.below(3) {
            let at = random.below(gltf.bytes.len());
            gltf.bytes[at] = random.below(256) as u8;
        }
        let file = File {
            name: "x.glb".to_owned(),
            bytes: gltf.glb().into(),
        };
        let loaded = load(
            &[FileRef::Inline(file)],
            &Source::inline_only(),
            &Limits::default(),
        );
        match loaded {
            Ok(loaded) => {
                rigs += 1;
                let rig = Arc::new(loaded.rig);
                let clips = (0..rig.clips().len()).map(|clip| ClipAt {
                    clip,
                    time: 0.4,
                    weight: 0.7,
                });
                let edit = PoseEdit {
                    clips: clips.collect(),
                    ..PoseEdit::default()
                };
                let (pose, _) = Pose::rest(&rig).edited(&edit).expect("it has no limits");
                // One that is flung too far says so.
                let Ok(posed) = Posed::new(&pose) else {
                    continue;
                };
                for mesh in rig.meshes() {
                    let palette = posed.palette(Skinning::Linear);
                    let (positions, normals) = skin_mesh(mesh, palette, posed.morph_weights());
                    let numbers = positions.iter().chain(&normals).flatten();
                    assert!(
                        numbers.into_iter().all(|number| number.is_finite()),
                        "{}",
                        gltf.json
                    );
                }
            }
            Err(LoadError::Invalid(fault)) => {
                faults += 1;
                let message = fault.to_string();
                assert!(message.len() < 600 && !message.contains('\n'), "{message}");
            }
            Err(LoadError::Limit(_)) => faults += 1,
            Err(other) => panic!("{other}: {}", gltf.json),
        }
    }
    // Both must have been tried.
    assert!(rigs > 300 && faults > 300, "{rigs} rigs, {faults} faults");
}
