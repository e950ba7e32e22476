//! Loading: faults in files, paths, names and digests, and what is said of a rig that is loaded.

use crate::support::{ask_kind, ask_ok};
use crate::{ARM, FLAG, SERVICE, ask_error, load, root, text, world_from_joint};
use serde_json::{Value, json};
use sha2::Digest as _;
use std::f64::consts::FRAC_PI_2;

#[test]
fn a_fault_in_a_file_is_told_with_its_place_and_leaves_nothing_behind() {
    let wrong_skel = ARM.replace("-1 1", "abc 1");
    let wrong_skin = FLAG.replace("1 1 1\n", "1 2 1\n");
    let before = ask_ok(&SERVICE, "server.stats", json!({}));
    for (files, wanted) in [
        (
            json!([text("arm.skel", &wrong_skel), text("arm.skin", FLAG)]),
            json!({"file": "arm.skel", "line": 5, "column": 13, "found": "`abc`"}),
        ),
        (
            json!([text("arm.skel", ARM), text("d/arm.skin", &wrong_skin)]),
            json!({"file": "d/arm.skin", "line": 13, "column": 4, "found": "`2`"}),
        ),
        (
            json!([text("arm.skel", "")]),
            json!({"file": "arm.skel", "line": 1, "column": 1}),
        ),
        (
            json!([text("notes.txt", "hello there")]),
            json!({"file": "notes.txt", "line": 1, "column": 1}),
        ),
    ] {
        let params = json!({"name": "half loaded", "files": files});
        let (code, kind, data) = ask_error(&SERVICE, "rig.load", params);
        assert_eq!((code, kind.as_str()), (-32001, "rig_file_invalid"));
        for (name, value) in wanted.as_object().expect("an object") {
            assert_eq!(&data[name], value, "{data:?}");
        }
        for sentence in ["expected", "found"] {
            assert!(data[sentence].as_str().is_some_and(|text| !text.is_empty()));
        }
        let named = json!({"rig": "half loaded"});
        assert_eq!(ask_kind(&SERVICE, "rig.describe", named), "rig_not_loaded");
    }
    // Nor does a failed replacement take the place of what was there.
    let summary = load(&SERVICE, "kept");
    let params = json!({"name": "kept", "files": [text("arm.skel", &wrong_skel)], "replace": true});
    assert_eq!(ask_kind(&SERVICE, "rig.load", params), "rig_file_invalid");
    let kept = ask_ok(&SERVICE, "rig.describe", json!({"rig": "kept"}));
    assert_eq!(kept["digest"], summary["digest"]);
    assert!(before["memory"]["rigs_bytes"].is_u64());
}

#[test]
fn paths_are_opened_below_the_root_and_nowhere_else() {
    let from_paths = ask_ok(
        &SERVICE,
        "rig.load",
        json!({"name": "from paths", "files": ["arm/arm.skel", "arm/arm.skin"]}),
    );
    let inline = load(&SERVICE, "inline");
    assert_eq!(from_paths["digest"], inline["digest"]);
    let by_stem = ask_ok(
        &SERVICE,
        "rig.load",
        json!({"files": ["arm/../arm/arm.skel"]}),
    );
    assert_eq!(by_stem["name"], "arm");

    let outside = root().join("../secret.skel");
    let outside = outside.to_str().expect("UTF-8");
    for (path, kind) in [
        ("arm/nobody.skel", "file_not_found"),
        ("nowhere/arm.skel", "file_not_found"),
        ("arm/arm.skel/x", "file_not_found"),
        ("../secret.skel", "path_not_allowed"),
        ("arm/../../secret.skel", "path_not_allowed"),
        (outside, "path_not_allowed"),
        ("/etc/passwd", "path_not_allowed"),
        ("arm", "path_not_allowed"),
        ("arm/", "path_not_allowed"),
        ("", "path_not_allowed"),
        ("arm/\0.skel", "path_not_allowed"),
        #[cfg(unix)]
        ("link.skel", "path_not_allowed"),
    ] {
        let params = json!({"name": "from nowhere", "files": [path]});
        let (code, found, data) = ask_error(&SERVICE, "rig.load", params);
        assert_eq!((code, found.as_str()), (-32009, kind), "{path}");
        assert_eq!(data["file"], json!(path));
    }
}

#[test]
fn a_name_that_is_taken_is_given_up_only_when_asked() {
    let first = load(&SERVICE, "taken");
    let set = json!({"rig": "taken", "pose": {"dofs": {"tip.rx": 0.5}}});
    ask_ok(&SERVICE, "pose.set", set);
    let value = || {
        let pose = ask_ok(&SERVICE, "pose.get", json!({"rig": "taken"}));
        pose["dofs"]["tip.rx"].as_f64().expect("a number")
    };
    // The same files again, in whatever order, change nothing.
    let reversed = json!([text("arm.skin", FLAG), text("arm.skel", ARM)]);
    for replace in [false, true] {
        let again = json!({"name": "taken", "files": reversed, "replace": replace});
        assert_eq!(ask_ok(&SERVICE, "rig.load", again), first);
        assert_eq!(value(), 0.5, "the stored pose is kept");
    }
    // Other files need to be told.
    let other = json!([text("arm.skel", ARM)]);
    let mut params = json!({"name": "taken", "files": other});
    let (code, kind, data) = ask_error(&SERVICE, "rig.load", params.clone());
    assert_eq!((code, kind.as_str()), (-32002, "rig_name_taken"));
    assert_eq!(data["rig"], "taken");
    assert_eq!(value(), 0.5);
    params["replace"] = json!(true);
    let second = ask_ok(&SERVICE, "rig.load", params);
    assert_ne!(second["digest"], first["digest"]);
    assert_eq!(second["vertex_count"], 0);
    assert_eq!(value(), 0.0, "the stored pose is that of the new rig");

    ask_ok(&SERVICE, "rig.unload", json!({"rig": "taken"}));
    let gone = json!({"rig": "taken"});
    assert_eq!(ask_kind(&SERVICE, "pose.get", gone), "rig_not_loaded");
    // Loaded anew, it is at rest.
    load(&SERVICE, "taken");
    assert_eq!(value(), 0.0);
}

#[test]
fn a_summary_counts_what_is_in_the_files() {
    let summary = load(&SERVICE, "counted");
    let digest = summary["digest"].as_str().expect("a digest");
    let hex = digest.strip_prefix("sha256:").expect("its kind");
    assert!(hex.len() == 64 && hex.bytes().all(|byte| byte.is_ascii_hexdigit()));
    let wanted = json!({
        "name": "counted", "digest": digest, "dialects": ["cse169 skel", "cse169 skin"],
        "joint_count": 2, "dof_count": 9, "vertex_count": 3, "triangle_count": 1, "morph_count": 0, "clip_count": 0,
        "warnings": [],
    });
    assert_eq!(summary, wanted);
    let list = ask_ok(&SERVICE, "rig.list", json!({}));
    let rigs = list["rigs"].as_array().expect("a list");
    assert!(rigs.contains(&summary));
    let names: Vec<_> = rigs.iter().map(|rig| rig["name"].as_str()).collect();
    assert!(names.is_sorted(), "{names:?}");
}

#[test]
fn a_description_gives_degrees_of_freedom_in_the_promised_order() {
    load(&SERVICE, "described");
    let described = ask_ok(&SERVICE, "rig.describe", json!({"rig": "described"}));
    let dof = |name: &str, kind: &str, [min, max]: [Option<f64>; 2], rest: f64| {
        let (joint, _) = name.split_once('.').expect("a joint's");
        json!({"name": name, "kind": kind, "joint": joint, "min": min, "max": max, "rest": rest, "value": rest})
    };
    let free = [None, None];
    let limited = [Some(-1.0), Some(FRAC_PI_2)];
    let wanted = json!([
        dof("root.tx", "translation", free, 0.0),
        dof("root.ty", "translation", free, 0.0),
        dof("root.tz", "translation", free, 0.0),
        dof("root.rx", "rotation", free, 0.0),
        dof("root.ry", "rotation", free, 0.0),
        dof("root.rz", "rotation", free, 0.0),
        dof("tip.rx", "rotation", limited, 0.0),
        dof("tip.ry", "rotation", free, 0.0),
        dof("tip.rz", "rotation", free, 0.25),
    ]);
    assert_eq!(described["dofs"], wanted);
    assert_eq!(described["joints"][0]["parent"], Value::Null);
    assert_eq!(described["joints"][1]["parent"], "root");
    assert_eq!(described["joints"][1]["offset"], json!([0.0, 1.0, 0.0]));
    assert_eq!(described["meshes"][0]["vertex_count"], 3);
    assert_eq!(described["meshes"][0]["has_texcoords"], false);

    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "described", "pose": {"dofs": {"root.ty": 7}}}),
    );
    let described = ask_ok(&SERVICE, "rig.describe", json!({"rig": "described"}));
    let moved = &described["dofs"][1];
    assert_eq!(
        (&moved["rest"], &moved["value"]),
        (&json!(0.0), &json!(7.0))
    );
}

#[test]
fn a_digest_names_a_rig_and_starts_from_rest() {
    let files = json!([text("only.skel", &ARM.replace("tip", "end"))]);
    let summary = ask_ok(&SERVICE, "rig.load", json!({ "files": files }));
    assert_eq!(summary["name"], "only");
    let digest = summary["digest"].as_str().expect("a digest");
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "only", "pose": {"dofs": {"root.tx": 5}}}),
    );
    for (rig, pose, x) in [
        ("only", json!({}), 6.0),
        (digest, json!({}), 1.0),
        (digest, json!({"base": "stored"}), 6.0),
        (digest, json!({"base": "rest"}), 1.0),
    ] {
        assert_eq!(world_from_joint(rig, 0, pose)[12], x, "{rig}");
    }
    let by_digest = ask_ok(&SERVICE, "rig.describe", json!({ "rig": digest }));
    assert_eq!(
        by_digest,
        ask_ok(&SERVICE, "rig.describe", json!({"rig": "only"}))
    );
    let frame = ask_ok(
        &SERVICE,
        "frame.render",
        json!({"rig": digest, "size": [8, 8]}),
    );
    assert_eq!(frame["rig"], digest);
    ask_ok(&SERVICE, "rig.unload", json!({ "rig": digest }));
    assert_eq!(
        ask_kind(&SERVICE, "pose.get", json!({"rig": "only"})),
        "rig_not_loaded"
    );
}

#[test]
fn the_same_file_under_two_names_is_one_rig() {
    let skel = ARM.replace("tip", "finger");
    let load = |file: &str, text_of: &str| {
        let params = json!({"files": [text(file, text_of)]});
        ask_ok(&SERVICE, "rig.load", params)
    };
    let (left, right) = (load("left.skel", &skel), load("right.txt", &skel));
    let hash = sha2::Sha256::digest(skel.as_bytes());
    let hex: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    let digest = format!("sha256:{hex}");
    assert_eq!(left["digest"], digest);
    assert_eq!(right["digest"], digest);
    assert_eq!(
        (&left["name"], &right["name"]),
        (&json!("left"), &json!("right"))
    );
    // Under one name, the second load is the same rig again.
    let named = json!({"name": "left", "files": [text("right.txt", &skel)]});
    assert_eq!(ask_ok(&SERVICE, "rig.load", named), left);

    // Each name has its own pose. The digest stands for the first by name, from rest where nothing else is said.
    let set = |rig: &str, x: f64| {
        let pose = json!({"base": "rest", "dofs": {"root.tx": x}});
        ask_ok(&SERVICE, "pose.set", json!({"rig": rig, "pose": pose}));
    };
    let root = |rig: &str, pose: Value| world_from_joint(rig, 0, pose)[12] - 1.0;
    let stored = || json!({"base": "stored"});
    set("left", 5.0);
    set("right", 7.0);
    assert_eq!(root(&digest, json!({})), 0.0);
    assert_eq!(root(&digest, json!({"dofs": {"root.tx": 3}})), 3.0);
    assert_eq!(root(&digest, stored()), 5.0);
    set(&digest, 6.0);
    assert_eq!(
        (root("left", stored()), root("right", stored())),
        (6.0, 7.0)
    );
    ask_ok(&SERVICE, "rig.unload", json!({ "rig": digest }));
    assert_eq!(root(&digest, stored()), 7.0, "the other name is left");

    // Where the extension has a say, the name counts.
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_ne!(
        load("one.obj", obj)["digest"],
        load("two.obj", obj)["digest"]
    );
    // As it does among several files.
    let files =
        |skel: &str| json!({"name": skel, "files": [text(skel, ARM), text("a.skin", FLAG)]});
    let [one, two] = ["1.skel", "2.skel"].map(|skel| ask_ok(&SERVICE, "rig.load", files(skel)));
    assert_ne!(one["digest"], two["digest"]);
}
