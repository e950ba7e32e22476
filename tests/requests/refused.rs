//! Requests refused by the field at fault.

use crate::support::{self, ask, ask_ok};
use crate::{ARM, FLAG, SERVICE, ask_error, files, load, merge, text};
use rigd::protocol::ErrorObject;
use serde_json::{Value, json};

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
    let response = support::answer(&SERVICE, line).expect("a request is answered");
    let error = ErrorObject::from(response.outcome.expect_err("infinite"));
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
