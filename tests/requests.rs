//! Does every method answer with what the contract says, and every mistake with the right kind and the right field?

mod support;

use base64::Engine as _;
use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::protocol::Reply;
use rigd::service::Service;
use serde_json::{Map, Value, json};
use sha2::Digest as _;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use support::{ask, ask_kind, ask_ok};

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

/// The path of a field that is meant to be refused.
fn refused_path(method: &str, params: &Value) -> String {
    let (code, kind, data) = ask_error(&SERVICE, method, params.clone());
    assert_eq!(
        (code, kind.as_str()),
        (-32602, "invalid_params"),
        "{params}"
    );
    data["path"].as_str().expect("a path").to_owned()
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

/// Kinematics are f64: a handful of roundings near 1.
const F64: f64 = 1e-14;
/// Vertices are float32, of coordinates up to about 10.
const F32: f64 = 1e-5;

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
fn a_frame_request_is_refused_by_the_field_at_fault() {
    let identity = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    let mirrored = json!([-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    let look = |more: Value| {
        let mut camera = json!({"kind": "look_at", "eye": [0, 1, 5], "target": [0, 1, 0]});
        merge(&mut camera, more);
        json!({ "camera": camera })
    };
    let pinhole = |more: Value| {
        let mut camera = json!({"kind": "pinhole", "fx": 100, "fy": 100, "cx": 32, "cy": 32, "world_from_camera": identity});
        merge(&mut camera, more);
        json!({ "camera": camera })
    };
    let sun = json!({"kind": "directional", "direction": [0, -1, 0]});
    let light = |more: Value| {
        let mut second = sun.clone();
        merge(&mut second, more);
        json!({"lights": [sun, second]})
    };
    for (fields, path) in [
        (json!({"rig": 3}), "rig"),
        (json!({"sise": [64, 64]}), "sise"),
        (json!({"size": [0, 64]}), "size"),
        (json!({"size": [64]}), "size"),
        (json!({"size": [64, 64, 64]}), "size"),
        (json!({"size": [64, -1]}), "size[1]"),
        (json!({"size": [64.5, 64]}), "size[0]"),
        (json!({"size": 64}), "size"),
        (json!({"samples": 2}), "samples"),
        (json!({"outputs": []}), "outputs"),
        (json!({"outputs": ["colour"]}), "outputs[0]"),
        (json!({"outputs": ["color", 1]}), "outputs[1]"),
        (json!({"image": "jpeg"}), "image"),
        (json!({"compression": "most"}), "compression"),
        (json!({"transport": "json"}), "transport"),
        (json!({"skinning": "cubic"}), "skinning"),
        (json!({"cull": true}), "cull"),
        (json!({"background": [0, 0, 0]}), "background"),
        (json!({"background": [0, 0, 0, 1.5]}), "background"),
        (json!({"background": [-0.5, 0, 0, 1]}), "background"),
        (json!({"background": "black"}), "background"),
        (json!({"ambient": [0, 0, 2]}), "ambient"),
        (
            json!({"material": {"diffuse": [2, 0, 0]}}),
            "material.diffuse",
        ),
        (
            json!({"material": {"specular": [0, 0]}}),
            "material.specular",
        ),
        (json!({"material": {"shininess": -1}}), "material.shininess"),
        (json!({"material": {"gloss": 1}}), "material.gloss"),
        (json!({"show": {"skin": "worn"}}), "show.skin"),
        (json!({"show": {"skeleton": "bones"}}), "show.skeleton"),
        (json!({"show": {"skin_opacity": 1.5}}), "show.skin_opacity"),
        (json!({"show": {"normals": 1}}), "show.normals"),
        (json!({"camera": {"fov_y": 0}}), "camera.fov_y"),
        (json!({"camera": {"fov_y": 3.2}}), "camera.fov_y"),
        (json!({"camera": {"fov_y": "wide"}}), "camera.fov_y"),
        (json!({"camera": {"fovy": 1}}), "camera.fovy"),
        (json!({"camera": {"distance": 0}}), "camera.distance"),
        (json!({"camera": {"near": -1}}), "camera.near"),
        (json!({"camera": {"kind": "fisheye"}}), "camera.kind"),
        (json!({"camera": {"eye": [0, 0, 5]}}), "camera.eye"),
        (
            json!({"camera": {"kind": "look_at", "eye": [0, 0, 5]}}),
            "camera.target",
        ),
        (look(json!({"eye": [0, 1, 0]})), "camera.eye"),
        (look(json!({"up": [0, 0, 1]})), "camera.up"),
        (look(json!({"up": [0, 0, 0]})), "camera.up"),
        (look(json!({"up": [0, 1]})), "camera.up"),
        (look(json!({"height": 2, "fov_y": 1})), "camera.height"),
        (look(json!({"height": 0})), "camera.height"),
        (pinhole(json!({"fx": 0})), "camera.fx"),
        (pinhole(json!({"fy": -1})), "camera.fy"),
        (pinhole(json!({"cx": 1e13})), "camera.cx"),
        (pinhole(json!({"axes": "dx"})), "camera.axes"),
        (
            pinhole(json!({"world_from_camera": mirrored})),
            "camera.world_from_camera",
        ),
        (
            pinhole(json!({"world_from_camera": [1, 2]})),
            "camera.world_from_camera",
        ),
        (pinhole(json!({"fov_y": 1})), "camera.fov_y"),
        (light(json!({"color": [1, 1, 1.5]})), "lights[1].color"),
        (light(json!({"color": [1, 1]})), "lights[1].color"),
        (light(json!({"color": [1, 1, "x"]})), "lights[1].color[2]"),
        (
            light(json!({"direction": [0, 0, 0]})),
            "lights[1].direction",
        ),
        (light(json!({"intensity": -1})), "lights[1].intensity"),
        (light(json!({"falloff": "none"})), "lights[1].falloff"),
        (light(json!({"kind": "spot"})), "lights[1].kind"),
        (
            json!({"lights": [{"kind": "point", "position": [1e13, 0, 0]}]}),
            "lights[0].position",
        ),
        (json!({"lights": [{"kind": "point"}]}), "lights[0].position"),
        (json!({"lights": {}}), "lights"),
        (json!({"pose": {"base": "tpose"}}), "pose.base"),
    ] {
        let mut params = json!({"rig": "figure", "size": [64, 64]});
        merge(&mut params, fields);
        assert_eq!(refused_path("frame.render", &params), path, "{params}");
    }
    assert_eq!(refused_path("frame.render", &json!({})), "rig");
}

/// Lays members over an object.
fn merge(object: &mut Value, members: Value) {
    let (Value::Object(object), Value::Object(members)) = (object, members) else {
        panic!("both are objects");
    };
    object.extend(members);
}

#[test]
fn a_pose_is_refused_by_the_field_at_fault() {
    load(&SERVICE, "refusing");
    for (pose, path) in [
        (json!({"dofs": {"nope": 1}}), "pose.dofs.nope"),
        (json!({"dofs": {"tip.rxx": 1}}), "pose.dofs.tip.rxx"),
        // Only the root moves.
        (json!({"dofs": {"tip.tx": 1}}), "pose.dofs.tip.tx"),
        (json!({"dofs": {"tip.rx": "far"}}), "pose.dofs.tip.rx"),
        (json!({"dofs": {"tip.rx": null}}), "pose.dofs.tip.rx"),
        (json!({"dofs": [1]}), "pose.dofs"),
        (
            json!({"clip": {"name": "walk", "time": 0}}),
            "pose.clip.name",
        ),
        (json!({"clip": {"name": "walk"}}), "pose.clip.time"),
        (
            json!({"dofs": {"tip.rx": 2}, "limits": "reject"}),
            "pose.dofs.tip.rx",
        ),
        (
            json!({"dof_values": [0, 0, 0, 0, 0, 0, 2, 0, 0], "limits": "reject"}),
            "pose.dof_values",
        ),
        (
            json!({"rotations": {"tip": [0.7833269, 0, 0, 0.6216100]}, "limits": "reject"}),
            "pose.rotations",
        ),
        (json!({"dofs": {"root.tx": 1e300}}), "pose"),
        (
            json!({"rotations": {"x": [0, 0, 0, 1]}}),
            "pose.rotations.x",
        ),
        (
            json!({"rotations": {"tip": [0, 0, 0, 2]}}),
            "pose.rotations.tip",
        ),
        (
            json!({"rotations": {"tip": [0, 0, 0, 0]}}),
            "pose.rotations.tip",
        ),
        (
            json!({"rotations": {"tip": [1e300, 0, 0, 0]}}),
            "pose.rotations.tip",
        ),
        (
            json!({"rotations": {"tip": [0, 0, 1]}}),
            "pose.rotations.tip",
        ),
        (
            json!({"rotations": {"tip": [0, 0, 0, 0, 1]}}),
            "pose.rotations.tip",
        ),
        (json!({"dof_values": [1, 2, 3]}), "pose.dof_values"),
        (
            json!({"dof_values": [0, 0, 0, 0, 0, 0, 0, 0, "x"]}),
            "pose.dof_values[8]",
        ),
        (
            json!({"dof_values": {"attach": {"offset": 0, "bytes": 36}}}),
            "pose.dof_values.attach",
        ),
        (
            json!({"dof_values": [0, 0, 0, 0, 0, 0, 0, 0, 0], "dofs": {"tip.rx": 1}}),
            "pose.dof_values",
        ),
        (json!({"limits": "bend"}), "pose.limits"),
        (json!({"base": "bind"}), "pose.base"),
        (json!({"dof": {}}), "pose.dof"),
        (json!([]), "pose"),
    ] {
        let params = json!({"rig": "refusing", "pose": pose});
        for method in [
            "pose.set",
            "joint.transforms",
            "mesh.vertices",
            "frame.render",
        ] {
            assert_eq!(refused_path(method, &params), path, "{method} {pose}");
        }
    }
    // JSON has no infinity, and what is too large for a number is not taken for one.
    let line = r#"{"jsonrpc":"2.0","id":1,"method":"pose.set","params":{"rig":"refusing","pose":{"dofs":{"tip.rx":1e999}}}}"#;
    let reply = SERVICE
        .answer(line.as_bytes(), Vec::new())
        .expect("a request is answered");
    let error = Reply::parse(&reply.line)
        .expect("a reply")
        .outcome
        .expect_err("infinite");
    assert_eq!(error.detail("path"), Some(&json!("pose.dofs.tip.rx")));
    // Nothing of all that was stored.
    let stored = ask_ok(&SERVICE, "pose.get", json!({"rig": "refusing"}));
    assert_eq!(stored["dofs"]["tip.rx"], 0.0);
}

#[test]
fn a_clip_is_asked_for_at_a_time_that_a_clip_can_have() {
    for (time, is_right) in [(-1e9, true), (1e9, true), (1.1e9, false), (-1.7e308, false)] {
        let pose = json!({"clip": {"name": "walk", "time": time}});
        let asked = ask(
            &SERVICE,
            "joint.transforms",
            json!({"rig": "figure", "pose": pose}),
        );
        match asked {
            Ok(_) => assert!(is_right, "{time}"),
            Err(error) => {
                assert!(!is_right, "{time}: {error}");
                assert_eq!(error.detail("path"), Some(&json!("pose.clip.time")));
            }
        }
    }
}

#[test]
fn a_mesh_request_is_refused_by_the_field_at_fault() {
    load(&SERVICE, "meshes");
    let two = json!([
        text("arm.skel", ARM),
        text("a.skin", FLAG),
        text("b.skin", FLAG)
    ]);
    ask_ok(
        &SERVICE,
        "rig.load",
        json!({"name": "two meshes", "files": two}),
    );
    for (method, rig, fields, path) in [
        ("mesh.vertices", "meshes", json!({"mesh": "hat"}), "mesh"),
        (
            "mesh.vertices",
            "meshes",
            json!({"range": {"start": 2, "count": 2}}),
            "range",
        ),
        (
            "mesh.vertices",
            "meshes",
            json!({"range": {"start": 4, "count": 0}}),
            "range",
        ),
        (
            "mesh.vertices",
            "meshes",
            json!({"range": {"start": u64::MAX, "count": 2}}),
            "range",
        ),
        (
            "mesh.vertices",
            "meshes",
            json!({"range": {"start": -1, "count": 2}}),
            "range.start",
        ),
        (
            "mesh.vertices",
            "meshes",
            json!({"range": {"start": 0}}),
            "range.count",
        ),
        ("mesh.vertices", "meshes", json!({"range": [0, 1]}), "range"),
        (
            "mesh.vertices",
            "meshes",
            json!({"attributes": ["colors"]}),
            "attributes[0]",
        ),
        (
            "mesh.vertices",
            "meshes",
            json!({"state": "folded"}),
            "state",
        ),
        (
            "mesh.vertices",
            "meshes",
            json!({"transport": "xml"}),
            "transport",
        ),
        (
            "mesh.vertices",
            "two meshes",
            json!({"range": {"start": 0, "count": 1}}),
            "mesh",
        ),
        (
            "mesh.topology",
            "meshes",
            json!({"transport": "xml"}),
            "transport",
        ),
        ("mesh.topology", "meshes", json!({"pose": {}}), "pose"),
    ] {
        let mut params = json!({ "rig": rig });
        merge(&mut params, fields);
        assert_eq!(refused_path(method, &params), path, "{params}");
    }
}

#[test]
fn other_requests_are_refused_by_the_field_at_fault() {
    for (method, params, path) in [
        ("server.ping", json!({"a": 1}), "a"),
        ("rig.list", json!({"rig": "figure"}), "rig"),
        ("rig.describe", json!({}), "rig"),
        ("pose.set", json!({"rig": "figure"}), "pose"),
        ("pose.reset", json!({"rig": "figure", "pose": {}}), "pose"),
        ("request.cancel", json!({"request": 1.5}), "request"),
        ("request.cancel", json!({}), "request"),
        ("rig.load", json!({}), "files"),
        ("rig.load", json!({"files": []}), "files"),
        (
            "rig.load",
            json!({"files": files(), "replace": 1}),
            "replace",
        ),
        ("rig.load", json!({"files": files(), "name": ""}), "name"),
        (
            "rig.load",
            json!({"files": files(), "name": "a\nb"}),
            "name",
        ),
        (
            "rig.load",
            json!({"files": [{"name": "a\u{1b}[31m.skel", "text": "balljoint a { }"}]}),
            "files[0].name",
        ),
        (
            "rig.load",
            json!({"files": files(), "name": "x".repeat(257)}),
            "name",
        ),
        (
            "rig.load",
            json!({"files": files(), "name": "sha256:00"}),
            "name",
        ),
        ("rig.load", json!({"files": [3]}), "files[0]"),
        (
            "rig.load",
            json!({"files": [{"name": "a.skel"}]}),
            "files[0].text",
        ),
        (
            "rig.load",
            json!({"files": [{"text": ARM}]}),
            "files[0].name",
        ),
        (
            "rig.load",
            json!({"files": [{"name": "a.skel", "text": ARM, "base64": ""}]}),
            "files[0].text",
        ),
        (
            "rig.load",
            json!({"files": [{"name": "a.skel", "base64": "!"}]}),
            "files[0].base64",
        ),
        (
            "rig.load",
            json!({"files": [text("a.skel", ARM), text("b.skel", ARM)]}),
            "files",
        ),
        (
            "rig.load",
            json!({"files": [text("x/a.skel", ARM), text("y/a.skel", ARM)]}),
            "files",
        ),
    ] {
        assert_eq!(refused_path(method, &params), path, "{method} {params}");
    }
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

/// The sixteen numbers of one joint under a pose.
fn world_from_joint(rig: &str, joint: usize, pose: Value) -> Vec<f64> {
    let params = json!({"rig": rig, "pose": pose});
    let transforms = ask_ok(&SERVICE, "joint.transforms", params);
    numbers(&transforms["joints"][joint]["world_from_joint"])
}

#[test]
fn joints_are_where_they_are_computed_to_be() {
    load(&SERVICE, "computed");
    let transforms = ask_ok(&SERVICE, "joint.transforms", json!({"rig": "computed"}));
    let names: Vec<_> = [0, 1]
        .map(|joint| {
            let joint = &transforms["joints"][joint];
            (joint["name"].clone(), joint["parent"].clone())
        })
        .to_vec();
    assert_eq!(
        names,
        [(json!("root"), Value::Null), (json!("tip"), json!("root"))]
    );
    let quarter = FRAC_PI_2;
    // Columns of Rz(90°): x goes to y, and y to -x.
    let turned_z = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    // Columns of Rz(90°)·Rx(90°): x to y, y to z, z to x. The other order would take x to z.
    let turned_zx = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    // Columns of Rz(90°)·Ry(90°): x to -z, y to -x, z to y.
    let turned_zy = [0.0, 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let at = |turned: [f64; 12], origin: [f64; 3]| [turned.as_slice(), &origin, &[1.0]].concat();
    let (sin, cos) = 0.25f64.sin_cos();
    let rest_tip = [cos, sin, 0.0, 0.0, -sin, cos, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for (what, joint, dofs, wanted) in [
        (
            "the tip at rest",
            1,
            json!({}),
            at(rest_tip, [1.0, 3.0, 3.0]),
        ),
        (
            "the root moved",
            0,
            json!({"root.tx": 10, "root.rz": quarter}),
            at(turned_z, [11.0, 2.0, 3.0]),
        ),
        (
            "the tip carried along",
            1,
            json!({"root.tx": 10, "root.rz": quarter, "tip.rz": 0}),
            at(turned_z, [10.0, 2.0, 3.0]),
        ),
        (
            "the tip turned after the root",
            1,
            json!({"root.rz": quarter, "tip.rx": quarter, "tip.rz": 0}),
            at(turned_zx, [0.0, 2.0, 3.0]),
        ),
        (
            "x before z",
            0,
            json!({"root.rx": quarter, "root.rz": quarter}),
            at(turned_zx, [1.0, 2.0, 3.0]),
        ),
        (
            "y before z",
            0,
            json!({"root.ry": quarter, "root.rz": quarter}),
            at(turned_zy, [1.0, 2.0, 3.0]),
        ),
    ] {
        let found = world_from_joint("computed", joint, json!({ "dofs": dofs }));
        assert_near(&found, &wanted, F64, what);
    }
}

#[test]
fn a_pose_is_built_up_in_the_promised_steps() {
    load(&SERVICE, "steps");
    let half = FRAC_1_SQRT_2;
    let about_z = json!([0, 0, half, half]);
    let by = |pose: Value| world_from_joint("steps", 0, pose);
    let by_angle = by(json!({"dofs": {"root.rz": FRAC_PI_2}}));
    assert_near(
        &by(json!({"rotations": {"root": about_z}})),
        &by_angle,
        F64,
        "a quaternion is an angle",
    );
    let opposite = json!([0, 0, -half, -half]);
    assert_near(
        &by(json!({"rotations": {"root": opposite}})),
        &by_angle,
        F64,
        "and so is its opposite",
    );
    let nearly = json!([0, 0, half * 1.004, half * 1.004]);
    assert_near(
        &by(json!({"rotations": {"root": nearly}})),
        &by_angle,
        F64,
        "length is evened out",
    );
    // Angles come after quaternions, and leave the other axes as the quaternion had them.
    let mixed = by(json!({"rotations": {"root": about_z}, "dofs": {"root.rx": FRAC_PI_2}}));
    let angles = by(json!({"dofs": {"root.rz": FRAC_PI_2, "root.rx": FRAC_PI_2}}));
    assert_near(&mixed, &angles, 1e-12, "angles are laid over a quaternion");
    // Every value at once, in the order of the description.
    let all = by(json!({"dof_values": [10, 0, 0, 0, 0, FRAC_PI_2, 0, 0, 0]}));
    assert_near(&all[..12], &by_angle[..12], F64, "values in order");
    assert_eq!(all[12], 11.0);

    // The stored pose is what others start from, where they give the name.
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "steps", "pose": {"dofs": {"root.tx": 5}}}),
    );
    assert_eq!(by(json!({}))[12], 6.0);
    assert_eq!(by(json!({"base": "rest"}))[12], 1.0);
    assert_eq!(by(json!({"dofs": {"root.ty": 1}}))[12..15], [6.0, 3.0, 3.0]);
    // And so does the next change of the stored pose itself.
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "steps", "pose": {"dofs": {"root.ty": 1}}}),
    );
    assert_eq!(by(json!({}))[12..15], [6.0, 3.0, 3.0]);
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "steps", "pose": {"base": "rest", "dofs": {"root.tz": 1}}}),
    );
    assert_eq!(by(json!({}))[12..15], [1.0, 2.0, 4.0]);
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

#[test]
fn clamping_is_reported_in_every_reply_to_a_pose() {
    load(&SERVICE, "clamped");
    let limit = FRAC_PI_2;
    let wanted = json!([{"dof": "tip.rx", "asked": 2.0, "used": limit}]);
    let too_far = json!({"dofs": {"tip.rx": 2, "tip.ry": 2}});
    for method in [
        "joint.transforms",
        "mesh.vertices",
        "frame.render",
        "pose.set",
    ] {
        let reply = ask_ok(&SERVICE, method, json!({"rig": "clamped", "pose": too_far}));
        assert_eq!(reply["clamped"], wanted, "{method}");
    }
    let dofs = || ask_ok(&SERVICE, "pose.get", json!({"rig": "clamped"}))["dofs"].take();
    assert_eq!(dofs()["tip.rx"], json!(limit));
    // What is stored is inside, so it is not reported again.
    let reply = ask_ok(&SERVICE, "joint.transforms", json!({"rig": "clamped"}));
    assert_eq!(reply["clamped"], json!([]));

    let mut ignoring = too_far.clone();
    ignoring["limits"] = json!("ignore");
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": ignoring}),
    );
    assert_eq!(reply["clamped"], json!([]));
    assert_eq!(dofs()["tip.rx"], 2.0);
    ask_ok(&SERVICE, "pose.reset", json!({"rig": "clamped"}));
    assert_eq!(dofs()["tip.rx"], 0.0);
    assert_eq!(dofs()["tip.rz"], 0.25, "the file's own value, and not zero");

    // A quaternion that is past a limit in both its triples of angles comes back as the angle that was used.
    let turn = |angle: f64| json!({"rotations": {"tip": [(angle / 2.0).sin(), 0.0, 0.0, (angle / 2.0).cos()]}});
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": turn(1.7)}),
    );
    let clamped = &reply["clamped"][0];
    assert_eq!(
        (&clamped["dof"], &clamped["used"]),
        (&json!("tip.rx"), &json!(limit))
    );
    assert_near(
        &[clamped["asked"].as_f64().expect("a number")],
        &[1.7],
        1e-12,
        "as an angle",
    );
    // Half a turn about y and z and 2.5 - π about x is the same, and inside.
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": turn(2.5)}),
    );
    assert_eq!(reply["clamped"], json!([]));
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": turn(1.0)}),
    );
    assert_eq!(reply["clamped"], json!([]));
    let stored = ask_ok(&SERVICE, "pose.get", json!({"rig": "clamped"}));
    let tip = &stored["joints"]["tip"];
    let rotation = turn(1.0)["rotations"]["tip"].take();
    assert_near(
        &numbers(&tip["rotation"]),
        &numbers(&rotation),
        F64,
        "the quaternion itself",
    );
    assert_eq!(tip["translation"], json!([0.0, 1.0, 0.0]));
    assert_eq!(tip["scale"], json!([1.0, 1.0, 1.0]));
    assert_near(
        &[stored["dofs"]["tip.rx"].as_f64().expect("a number")],
        &[1.0],
        1e-12,
        "and its angle",
    );
}

#[test]
fn an_inline_pose_changes_nothing_that_is_stored() {
    load(&SERVICE, "untouched");
    let stored = || ask_ok(&SERVICE, "pose.get", json!({"rig": "untouched"}));
    let before = stored();
    let pose = json!({"dofs": {"root.tx": 3, "tip.rx": 1}, "rotations": {"root": [0, 1, 0, 0]}});
    for method in ["joint.transforms", "mesh.vertices", "frame.render"] {
        ask_ok(&SERVICE, method, json!({"rig": "untouched", "pose": pose}));
        assert_eq!(stored(), before, "{method}");
    }
}

/// Positions and normals of the arm's mesh, asked for in numbers.
fn vertices(rig: &str, fields: Value) -> (Vec<f64>, Vec<f64>) {
    let mut params = json!({ "rig": rig });
    merge(&mut params, fields);
    let mut found = ask_ok(&SERVICE, "mesh.vertices", params);
    let mesh = found["meshes"][0].take();
    (
        numbers(&mesh["positions"]["data"]),
        numbers(&mesh["normals"]["data"]),
    )
}

#[test]
fn vertices_follow_their_joints_in_the_order_of_the_file() {
    load(&SERVICE, "vertices");
    let file = [1.0, 2.0, 3.0, 1.0, 3.0, 3.0, 2.0, 2.0, 3.0];
    let toward_z = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let (positions, normals) = vertices("vertices", json!({"state": "bind"}));
    assert_near(&positions, &file, 0.0, "as modelled");
    assert_near(&normals, &toward_z, 0.0, "as modelled");
    let straight = json!({"dofs": {"tip.rz": 0}});
    let (positions, _) = vertices("vertices", json!({ "pose": straight }));
    assert_near(&positions, &file, F32, "where it was bound");

    // The tip a quarter turn about x: its own vertex stays on its origin; the third one is halfway between staying and turning about it.
    let bent = json!({"dofs": {"tip.rx": FRAC_PI_2, "tip.rz": 0}});
    let (positions, normals) = vertices("vertices", json!({ "pose": bent }));
    // (2, 2, 3) is (1, -1, 0) from the tip, which goes to (1, 0, -1): (2, 3, 2). Half of both is (2, 2.5, 2.5).
    assert_near(
        &positions,
        &[1.0, 2.0, 3.0, 1.0, 3.0, 3.0, 2.0, 2.5, 2.5],
        F32,
        "bent",
    );
    let half = FRAC_1_SQRT_2;
    // z goes to -y.
    assert_near(
        &normals,
        &[0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, -half, half],
        F32,
        "bent",
    );
    // Bent or not, as modelled is as modelled.
    let (positions, _) = vertices("vertices", json!({"state": "bind", "pose": bent}));
    assert_near(&positions, &file, 0.0, "as modelled");

    let found = ask_ok(
        &SERVICE,
        "mesh.vertices",
        json!({"rig": "vertices", "pose": bent}),
    );
    let (min, max) = (
        numbers(&found["bounds"]["min"]),
        numbers(&found["bounds"]["max"]),
    );
    assert_near(&min, &[1.0, 2.0, 2.5], F32, "bounds");
    assert_near(&max, &[2.0, 3.0, 3.0], F32, "bounds");
}

#[test]
fn a_part_of_the_vertices_is_that_part_of_all_of_them() {
    let describe = ask_ok(&SERVICE, "rig.describe", json!({"rig": "figure"}));
    let mesh = &describe["meshes"][0];
    let count = mesh["vertex_count"].as_u64().expect("a number") as usize;
    let pose = json!({"base": "rest", "dofs": {"upper_arm_l.rz": 0.5, "spine.rx": 0.2}});
    let (positions, normals) = vertices("figure", json!({ "pose": pose }));
    assert_eq!((positions.len(), normals.len()), (3 * count, 3 * count));
    for (start, length) in [
        (0, 1),
        (7, 100),
        (count - 1, 1),
        (0, count),
        (count, 0),
        (64, 64),
    ] {
        let range = json!({"start": start, "count": length});
        let fields = json!({"pose": pose, "range": range, "mesh": mesh["name"]});
        let (some_positions, some_normals) = vertices("figure", fields);
        let part = 3 * start..3 * (start + length);
        assert!(some_positions == positions[part.clone()], "{range}");
        assert!(some_normals == normals[part], "{range}");
    }
    for normal in normals.chunks(3) {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert_near(&[length], &[1.0], F32, "unit length");
    }
    for (attributes, has) in [
        (json!(["positions"]), [true, false]),
        (json!(["normals"]), [false, true]),
        (json!([]), [false, false]),
    ] {
        let params = json!({"rig": "figure", "pose": pose, "attributes": attributes});
        let found = ask_ok(&SERVICE, "mesh.vertices", params);
        let mesh = &found["meshes"][0];
        let found = ["positions", "normals"].map(|name| mesh.get(name).is_some());
        assert_eq!(found, has, "{attributes}");
        assert_eq!(mesh["vertex_count"], count);
    }
}

/// A result with whatever was attached to it.
fn ask_attached(method: &str, params: Value) -> (Value, Vec<u8>) {
    let request = json!({"jsonrpc": "2.0", "id": 1, "method": method, "params": params});
    let reply = SERVICE
        .answer(request.to_string().as_bytes(), Vec::new())
        .expect("a request is answered");
    let attached: Vec<u8> = reply
        .attachments
        .iter()
        .flat_map(|part| part.bytes().to_vec())
        .collect();
    let reply = Reply::parse(&reply.line).expect("a reply");
    assert_eq!(reply.attach_bytes, attached.len() as u64);
    let result = reply.outcome.expect("a result");
    (serde_json::from_str(result.get()).expect("JSON"), attached)
}

/// The bytes of an array, however it travelled.
fn bytes_of(blob: &Value, attached: &[u8]) -> Vec<u8> {
    match blob["encoding"].as_str() {
        Some("json") if blob["dtype"] == "uint32" => numbers(&blob["data"])
            .iter()
            .flat_map(|&number| (number as u32).to_le_bytes())
            .collect(),
        Some("json") => numbers(&blob["data"])
            .iter()
            .flat_map(|&number| (number as f32).to_le_bytes())
            .collect(),
        Some("base64") => base64::engine::general_purpose::STANDARD
            .decode(blob["data"].as_str().expect("a string"))
            .expect("base64"),
        Some("attach") => {
            let number = |name: &str| blob[name].as_u64().expect("a number") as usize;
            attached[number("offset")..][..number("bytes")].to_vec()
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_way_to_travel_carries_the_same_bytes() {
    let pose = json!({"base": "rest", "dofs": {"neck.ry": 0.3}});
    for (method, rig, params, names) in [
        (
            "mesh.vertices",
            "figure",
            json!({ "pose": pose }),
            &["positions", "normals"][..],
        ),
        (
            "mesh.topology",
            "figure",
            json!({}),
            &["triangles", "texcoords"],
        ),
    ] {
        let [json, base64, attach] = ["json", "base64", "attach"].map(|transport| {
            let mut params = params.clone();
            merge(&mut params, json!({"rig": rig, "transport": transport}));
            let (result, attached) = ask_attached(method, params);
            let mesh = &result["meshes"][0];
            let shape = |name: &&str| mesh[name]["shape"].clone();
            let bytes = |name: &&str| bytes_of(&mesh[name], &attached);
            let shapes: Vec<Value> = names.iter().map(shape).collect();
            (
                shapes,
                names.iter().map(bytes).collect::<Vec<_>>(),
                attached.len(),
            )
        });
        assert_eq!(json.0, base64.0, "{method}");
        assert_eq!(json.0, attach.0, "{method}");
        assert!(json.1 == base64.1 && json.1 == attach.1, "{method}");
        assert_eq!((json.2, base64.2), (0, 0));
        assert_eq!(attach.2, json.1.concat().len(), "nothing else is attached");
    }
}

#[test]
fn topology_keeps_the_winding_of_the_file() {
    load(&SERVICE, "wound");
    let found = ask_ok(&SERVICE, "mesh.topology", json!({"rig": "wound"}));
    let mesh = &found["meshes"][0];
    let wanted = json!({"encoding": "json", "dtype": "uint32", "shape": [1, 3], "data": [0, 1, 2]});
    assert_eq!(mesh["triangles"], wanted);
    assert_eq!(
        (&mesh["vertex_count"], &mesh["triangle_count"]),
        (&json!(3), &json!(1))
    );
    assert!(mesh.get("texcoords").is_none());
    let textured = FLAG.replace(
        "skinweights",
        "texcoords 3 {\n\t0 0\n\t1 0\n\t0.5 1\n}\nskinweights",
    );
    let files = json!([
        text("arm.skel", ARM),
        text("arm.skin", &textured.replace("0 1 2", "2 0 1"))
    ]);
    ask_ok(
        &SERVICE,
        "rig.load",
        json!({"name": "textured", "files": files}),
    );
    let found = ask_ok(&SERVICE, "mesh.topology", json!({"rig": "textured"}));
    let mesh = &found["meshes"][0];
    assert_eq!(mesh["triangles"]["data"], json!([2, 0, 1]));
    assert_eq!(mesh["texcoords"]["shape"], json!([3, 2]));
    assert_eq!(
        numbers(&mesh["texcoords"]["data"]),
        [0.0, 0.0, 1.0, 0.0, 0.5, 1.0]
    );
}

#[test]
fn a_frame_says_what_it_was_made_with() {
    let eye = [0.0, 1.0, 4.0];
    let camera = json!({"kind": "look_at", "eye": eye, "target": [0, 1, 0], "fov_y": FRAC_PI_2});
    let params = json!({"rig": "figure", "camera": camera, "size": [40, 20]});
    let frame = ask_ok(&SERVICE, "frame.render", params);
    assert_eq!(
        (&frame["width"], &frame["height"]),
        (&json!(40), &json!(20))
    );
    let camera = &frame["camera"];
    let matrix = numbers(&camera["world_from_camera"]);
    assert_near(&matrix[12..15], &eye, F64, "the eye");
    // Half the height over the tangent of half the angle.
    for (name, wanted) in [("fx", 10.0), ("fy", 10.0), ("cx", 20.0), ("cy", 10.0)] {
        assert_near(
            &[camera[name].as_f64().expect("a number")],
            &[wanted],
            1e-12,
            name,
        );
    }
    assert_eq!(numbers(&camera["clip_from_world"]).len(), 16);
    assert_eq!(frame["renderer"]["name"], "rigd");
    for time in ["queue", "render", "encode"] {
        assert!(
            frame["timings_ms"][time]
                .as_f64()
                .is_some_and(|ms| ms >= 0.0)
        );
    }
    let blob = &frame["images"]["color"];
    assert_eq!(
        (&blob["encoding"], &blob["media"]),
        (&json!("base64"), &json!("image/png"))
    );
}

#[test]
fn what_is_too_large_is_refused_before_anything_is_allocated() {
    let limits = Limits {
        pixels: 10_000,
        side: 500,
        lights: 2,
        joints: 2,
        vertices: 3,
        triangles: 1,
        influences: 4,
        rigs: 2,
        rig_file_bytes: 4000,
        ..Limits::default()
    };
    let service = Service::new(support::engine(limits), Source::inline_only());
    load(&service, "arm");
    // The renderer is warm, so that what it takes is what it goes on taking.
    let draw = |size: Value| json!({"rig": "arm", "size": size});
    ask_ok(&service, "frame.render", draw(json!([100, 100])));
    let memory = || ask_ok(&service, "server.stats", json!({}))["memory"].take();
    let before = memory();
    let skin = |from: &str, to: &str| json!({"name": "new", "files": [text("arm.skel", ARM), text("arm.skin", &FLAG.replace(from, to))]});
    let skel = |content: &str| json!({"name": "new", "files": [text("new.skel", content)]});
    let light = json!({"kind": "directional", "direction": [0, -1, 0]});
    let many_lights = json!({"rig": "arm", "size": [8, 8], "lights": [light, light, light]});
    let long = "#".repeat(4001);
    for (method, params, limit, maximum, asked) in [
        (
            "frame.render",
            draw(json!([500, 21])),
            "pixels",
            10_000,
            10_500,
        ),
        ("frame.render", draw(json!([501, 1])), "side", 500, 501),
        (
            "frame.render",
            draw(json!([u32::MAX, u32::MAX])),
            "side",
            500,
            u64::from(u32::MAX),
        ),
        ("frame.render", many_lights, "lights", 2, 3),
        (
            "rig.load",
            skin("positions 3", "positions 99999999"),
            "vertices",
            3,
            99_999_999,
        ),
        (
            "rig.load",
            skin("skinweights 3", "skinweights 4"),
            "vertices",
            3,
            4,
        ),
        (
            "rig.load",
            skin("triangles 1", "triangles 2"),
            "triangles",
            1,
            2,
        ),
        ("rig.load", skin("bindings 2", "bindings 3"), "joints", 2, 3),
        (
            "rig.load",
            skin("2 0 0.5 1 0.5", "3 0 0.5 1 0.25 0 0.25"),
            "influences",
            4,
            5,
        ),
        (
            "rig.load",
            skel("joint a { joint b { } joint c { } }"),
            "joints",
            2,
            3,
        ),
        ("rig.load", skel(&long), "rig_file_bytes", 4000, 4001),
    ] {
        let (code, kind, data) = ask_error(&service, method, params);
        assert_eq!((code, kind.as_str()), (-32003, "limit_exceeded"), "{limit}");
        let wanted = json!({"limit": limit, "maximum": maximum, "asked": asked});
        assert_eq!(Value::Object(data), wanted);
    }
    let after = memory();
    for held in ["rigs_bytes", "gpu_bytes"] {
        assert_eq!(after[held], before[held], "{held}");
    }
    // One more rig is allowed, a third is not, and in the place of another it is.
    load(&service, "second");
    let third = json!({"name": "third", "files": files()});
    let (_, _, data) = ask_error(&service, "rig.load", third);
    assert_eq!(data["limit"], "rigs");
    let mut replaced = skel("joint a { }");
    merge(&mut replaced, json!({"name": "second", "replace": true}));
    ask_ok(&service, "rig.load", replaced);
    let rigs = ask_ok(&service, "rig.list", json!({}));
    assert_eq!(rigs["rigs"].as_array().map(Vec::len), Some(2));

    // Every limit is there to be read.
    let info = ask_ok(&service, "server.info", json!({}));
    for (name, maximum) in limits.entries() {
        assert_eq!(info["limits"][name], maximum, "{name}");
    }
}

#[test]
fn the_server_tells_what_it_is() {
    let info = ask_ok(&SERVICE, "server.info", json!({}));
    assert_eq!(
        (&info["name"], &info["protocol"]),
        (&json!("rigd"), &json!(1))
    );
    assert_eq!(info["version"], env!("CARGO_PKG_VERSION"));
    for member in ["name", "backend", "type", "driver", "why"] {
        assert!(info["adapter"][member].is_string(), "{member}");
    }
    assert_eq!(info["formats"], json!(rigd::formats::FORMATS));
    assert!(
        info["uptime_s"]
            .as_f64()
            .is_some_and(|seconds| seconds > 0.0)
    );
    assert_eq!(ask_ok(&SERVICE, "server.ping", json!({})), json!({}));
    assert_eq!(
        ask_ok(&SERVICE, "rpc.discover", json!({})),
        rigd::protocol::openrpc()
    );
}

#[test]
fn every_answer_is_counted_once() {
    // Its own, so that nobody else's requests are counted.
    let service = support::service();
    let draw = || {
        ask(
            &service,
            "frame.render",
            json!({"rig": "figure", "size": [16, 16]}),
        )
    };
    for _ in 0..3 {
        draw().expect("a picture");
    }
    ask_ok(
        &service,
        "mesh.vertices",
        json!({"rig": "figure", "range": {"start": 0, "count": 10}}),
    );
    ask_kind(&service, "frame.render", json!({"rig": "nobody"}));
    ask_kind(
        &service,
        "frame.render",
        json!({"rig": "figure", "size": 3}),
    );
    ask_kind(&service, "no.such.method", json!({}));
    service.answer(b"not JSON", Vec::new());
    // A notification that only asks is passed over, which is no failure of anybody's.
    let notification = br#"{"jsonrpc":"2.0","method":"server.info"}"#;
    assert!(service.answer(notification, Vec::new()).is_none());
    let stats = ask_ok(&service, "server.stats", json!({}));
    let wanted = json!({
        "frame.render": {"ok": 3, "errors": {"rig_not_loaded": 1, "invalid_params": 1}},
        "mesh.vertices": {"ok": 1, "errors": {}},
        "(none)": {"ok": 0, "errors": {"method_not_found": 1, "parse_error": 1}},
    });
    assert_eq!(stats["requests"], wanted);
    assert_eq!((&stats["frames"], &stats["rigs"]), (&json!(3), &json!(1)));
    let figure = ask_ok(&service, "rig.describe", json!({"rig": "figure"}));
    let per_frame = figure["vertex_count"].as_u64().expect("a number");
    assert_eq!(stats["vertices"], 3 * per_frame + 10);
    for held in ["cpu_bytes", "rigs_bytes"] {
        assert!(
            stats["memory"][held]
                .as_u64()
                .is_some_and(|bytes| bytes > 0),
            "{held}"
        );
    }
}
