//! Does every method answer with what the contract says, and every mistake with the right kind and the right field? One module for each
//! family of methods; names that are unknown are asked for here.

mod loading;
mod poses;
mod refused;
mod server;
#[path = "../support/mod.rs"]
mod support;
mod vertices;

use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::service::Service;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use support::{ask, ask_ok};

/// One renderer for most tests; each uses rigs under names of its own. Paths are looked up in [`root`].
static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(|| {
    let source = Source::rooted(&root()).expect("the folder is there");
    support::service_with(Limits::default(), source)
});

/// Root and tip, one above the other; the tip has limits about x.
const ARM: &str = "\
balljoint root {
\toffset 1 2 3
\tballjoint tip {
\t\toffset 0 1 0
\t\trotxlimit -1 1.5707963267948966
\t\tpose 0 0 0.25
\t}
}
";

/// A triangle with one vertex on the root, one on the tip, and one on both by halves. Bound where the joints are at rest without rotation.
/// Wound against its normals.
const FLAG: &str = "\
positions 3 {
\t1 2 3
\t1 3 3
\t2 2 3
}
normals 3 {
\t0 0 1
\t0 0 1
\t0 0 1
}
skinweights 3 {
\t1 0 1
\t1 1 1
\t2 0 0.5 1 0.5
}
triangles 1 {
\t0 1 2
}
bindings 2 {
\tmatrix {
\t\t1 0 0
\t\t0 1 0
\t\t0 0 1
\t\t1 2 3
\t}
\tmatrix {
\t\t1 0 0
\t\t0 1 0
\t\t0 0 1
\t\t1 3 3
\t}
}
";

fn text(name: &str, text: &str) -> Value {
    json!({"name": name, "text": text})
}

fn files() -> Value {
    json!([text("arm.skel", ARM), text("arm.skin", FLAG)])
}

/// The arm under a name of the test's own; its summary.
fn load(service: &Arc<Service>, name: &str) -> Value {
    ask_ok(service, "rig.load", json!({"name": name, "files": files()}))
}

/// A folder with a rig in it, and beside it a file that nobody may have.
fn root() -> PathBuf {
    let base = support::places::output("requests");
    let root = base.join("root");
    std::fs::create_dir_all(root.join("arm")).expect("a folder of the tests' own");
    std::fs::write(root.join("arm/arm.skel"), ARM).expect("it can be written");
    std::fs::write(root.join("arm/arm.skin"), FLAG).expect("it can be written");
    std::fs::write(base.join("secret.skel"), ARM).expect("it can be written");
    #[cfg(unix)]
    {
        let link = root.join("link.skel");
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink("../secret.skel", link).expect("it can be written");
    }
    root
}

/// The error of what is meant to fail: code, and `data` without `kind`.
fn ask_error(
    service: &Arc<Service>,
    method: &str,
    params: Value,
) -> (i64, String, Map<String, Value>) {
    match ask(service, method, params) {
        Ok(result) => panic!("{method} succeeded with {result}"),
        Err(error) => (error.code, error.data.kind, error.data.details),
    }
}

/// Lays members over an object.
fn merge(object: &mut Value, members: Value) {
    let (Value::Object(object), Value::Object(members)) = (object, members) else {
        panic!("both are objects");
    };
    object.extend(members);
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value
        .as_array()
        .unwrap_or_else(|| panic!("a list, not {value}"));
    list.iter()
        .map(|number| number.as_f64().expect("a number"))
        .collect()
}

fn assert_near(found: &[f64], wanted: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    for (found_one, wanted_one) in found.iter().zip(wanted) {
        let is_near = (found_one - wanted_one).abs() <= tolerance;
        assert!(is_near, "{what}: {found:?} in place of {wanted:?}");
    }
}

/// The sixteen numbers of one joint under a pose.
fn world_from_joint(rig: &str, joint: usize, pose: Value) -> Vec<f64> {
    let params = json!({"rig": rig, "pose": pose});
    let transforms = ask_ok(&SERVICE, "joint.transforms", params);
    numbers(&transforms["joints"][joint]["world_from_joint"])
}

/// Kinematics are f64: a handful of roundings near 1.
const F64: f64 = 1e-14;

#[test]
fn methods_are_found_by_name_and_near_ones_are_offered() {
    for (method, nearest) in [
        ("frame.rendr", Some("frame.render")),
        ("pose.rest", Some("pose.reset")),
        ("Server.Ping", None),
        ("", None),
    ] {
        let (code, kind, data) = ask_error(&SERVICE, method, json!({}));
        assert_eq!(
            (code, kind.as_str()),
            (-32601, "method_not_found"),
            "{method}"
        );
        if nearest.is_some() {
            assert_eq!(data.get("nearest").and_then(Value::as_str), nearest);
        }
    }
}

#[test]
fn a_name_that_is_not_there_gets_the_one_that_was_meant() {
    load(&SERVICE, "Naming");
    let dofs = |dof: &str| json!({"rig": "Naming", "pose": {"dofs": {dof: 0.5}}});
    let figure = |pose: Value| json!({"rig": "figure", "pose": pose});
    let long = "x".repeat(100_000);
    for (method, params, wanted) in [
        (
            "pose.set",
            dofs("tip"),
            "pose.dofs.tip: `tip` is a joint; its DOFs are `tip.rx`, `tip.ry`, `tip.rz`",
        ),
        (
            "pose.set",
            dofs("root"),
            "pose.dofs.root: `root` is a joint; its DOFs are `root.tx`, `root.ty`, `root.tz`, `root.rx`, `root.ry`, `root.rz`",
        ),
        (
            "pose.set",
            dofs("rooot"),
            "pose.dofs.rooot: the rig has no such DOF; joint `root` has `root.tx`, `root.ty`, `root.tz`, `root.rx`, `root.ry`, `root.rz`",
        ),
        (
            "pose.set",
            dofs("TIP"),
            "pose.dofs.TIP: the rig has no such DOF; joint `tip` has `tip.rx`, `tip.ry`, `tip.rz`",
        ),
        (
            "pose.set",
            dofs("tip.tx"),
            "pose.dofs.tip.tx: the rig has no such DOF; joint `tip` has `tip.rx`, `tip.ry`, `tip.rz`",
        ),
        (
            "pose.set",
            dofs("tip.rX"),
            "pose.dofs.tip.rX: the rig has no such DOF; did you mean `tip.rx`?",
        ),
        (
            "pose.set",
            dofs("wing"),
            "pose.dofs.wing: the rig has no such DOF; it has `root.tx`, `root.ty`, `root.tz`, `root.rx`, `root.ry`, `root.rz`, `tip.rx`, `tip.ry` and 1 more",
        ),
        (
            "pose.set",
            dofs("morph.smile"),
            "pose.dofs.morph.smile: the rig has no such morph target; it has none",
        ),
        (
            "joint.transforms",
            figure(json!({"dofs": {"smile": 1}})),
            "pose.dofs.smile: the rig has no such DOF; did you mean `morph.smile`?",
        ),
        (
            "joint.transforms",
            figure(json!({"dofs": {"morph.frown": 1}})),
            "pose.dofs.morph.frown: the rig has no such morph target; it has `smile`, `blink`",
        ),
        (
            "joint.transforms",
            figure(json!({"dofs": {"morph.smiel": 1}})),
            "pose.dofs.morph.smiel: the rig has no such morph target; did you mean `smile`?",
        ),
        (
            "joint.transforms",
            figure(json!({"clip": {"name": "Walk", "time": 0}})),
            "pose.clip.name: the rig has no such clip; did you mean `walk`?",
        ),
        (
            "pose.roll",
            json!({"rig": "Naming", "joint": "tip.rx", "angle": 1}),
            "joint: `tip.rx` is a DOF; its joint is `tip`",
        ),
        (
            "pose.roll",
            json!({"rig": "Naming", "joint": "Root", "angle": 1}),
            "joint: the rig has no such joint; did you mean `root`?",
        ),
        (
            "mesh.vertices",
            json!({"rig": "Naming", "mesh": "mesh_1"}),
            "mesh: the rig has no such mesh; did you mean `mesh_0`?",
        ),
        (
            "rig.describe",
            json!({"rig": "figur"}),
            "rig `figur` is not loaded; did you mean `figure`?",
        ),
        (
            "pose.get",
            json!({"rig": "naming"}),
            "rig `naming` is not loaded; did you mean `Naming`?",
        ),
    ] {
        let error = ask(&SERVICE, method, params).expect_err(wanted);
        assert_eq!(error.message, wanted);
    }
    for params in [
        json!({"rig": "Naming", "pose": {"dofs": {&long: 1}}}),
        json!({"rig": "Naming", "pose": {"rotations": {&long: [0, 0, 0, 1]}}}),
        json!({"rig": "Naming", "pose": {"clip": {"name": &long, "time": 0}}}),
        json!({"rig": "Naming", "mesh": &long}),
        json!({"rig": &long}),
    ] {
        let error = ask(&SERVICE, "mesh.vertices", params).expect_err("no such name");
        assert!(error.message.len() < 1000, "{} bytes", error.message.len());
    }
}

#[test]
fn a_rig_that_is_not_loaded_gets_a_few_of_those_that_are() {
    let service = support::service();
    let missing = |service: &Arc<Service>| {
        let error = ask(service, "pose.get", json!({"rig": "rig_13"}));
        error.expect_err("it is not loaded").data.details
    };
    for index in 10..30 {
        load(&service, &format!("rig-{index}"));
    }
    let data = missing(&service);
    assert_eq!(data["nearest"], "rig-13");
    let loaded: Vec<String> = (10..17).map(|index| format!("rig-{index}")).collect();
    assert_eq!(data["loaded"][0], "figure");
    assert_eq!(data["loaded"].as_array().map(Vec::len), Some(8));
    assert_eq!(
        json!(data["loaded"].as_array().map(|all| &all[1..])),
        json!(loaded)
    );
}

#[test]
fn a_rig_that_is_not_loaded_is_named() {
    let digest = format!("sha256:{}", "0".repeat(64));
    for rig in ["nobody", "", &digest] {
        for (method, params) in [
            ("rig.unload", json!({ "rig": rig })),
            ("rig.describe", json!({ "rig": rig })),
            ("pose.get", json!({ "rig": rig })),
            ("pose.set", json!({"rig": rig, "pose": {}})),
            ("pose.reset", json!({ "rig": rig })),
            ("frame.render", json!({ "rig": rig })),
            ("mesh.vertices", json!({ "rig": rig })),
            ("mesh.topology", json!({ "rig": rig })),
            ("joint.transforms", json!({ "rig": rig })),
        ] {
            let error = ask(&SERVICE, method, params).expect_err("there is no such rig");
            let found = (error.code, error.data.kind.as_str(), error.data.retryable);
            assert_eq!(found, (-32000, "rig_not_loaded", true), "{method}");
            assert_eq!(error.detail("rig"), Some(&json!(rig)));
        }
    }
}
