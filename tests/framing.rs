//! Does the default camera frame what is shown of a rig, and nothing else?

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use support::pictures::{Drawn, draw};
use support::{ask_ok, case};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// A triangle bound to a joint that stands 3 to the right of where it was modelled; a socket far above moves nothing.
const SKEL: &str = "balljoint root { offset 3 0 0 boxmin -9 0 0 boxmax 0 0 0
    balljoint socket { offset 0 40 0 boxmin 0 0 0 boxmax 0 0 0 } }";
const SKIN: &str =
    "positions 3 { 0 0 0 1 0 0 0 1 0 } skinweights 3 { 1 0 1 1 0 1 1 0 1 } triangles 1 { 0 1 2 }
    bindings 2 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } matrix { 1 0 0 0 1 0 0 0 1 0 40 0 } }";

fn load(name: &str, files: &Value) {
    ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}));
}

fn socketed(name: &str, with_skin: bool) {
    let mut files = vec![json!({"name": "a.skel", "text": SKEL})];
    if with_skin {
        files.push(json!({"name": "a.skin", "text": SKIN}));
    }
    load(name, &json!(files));
}

fn seen(rig: &str, show: Value) -> Drawn {
    let request = json!({
        "rig": rig, "size": [100, 100], "background": [0, 0, 0, 0], "show": show,
        "camera": {"kind": "orbit", "azimuth": 0, "inclination": 0},
    });
    draw(&SERVICE, &request)
}

/// Width and height in the rig's units of what a camera at the default distance sees at its target.
fn height_seen(drawn: &Drawn) -> f64 {
    let camera = &drawn.frame["camera"];
    let at = |i: usize| camera["world_from_camera"][i].as_f64().expect("a number");
    let fy = camera["fy"].as_f64().expect("a number");
    // It looks along -z at the middle of what it frames, which lies flat in the plane of z = 0.
    100.0 * at(14) / fy
}

/// Where it looks at.
fn target(drawn: &Drawn) -> [f64; 2] {
    [12, 13].map(|i| {
        drawn.frame["camera"]["world_from_camera"][i]
            .as_f64()
            .expect("a number")
    })
}

#[test]
fn joints_that_move_nothing_do_not_shrink_the_skin() {
    let name = "camera_node";
    load(
        name,
        &json!([case("gltf/camera_node_shrinks_the_model.gltf")]),
    );
    let Drawn { image, .. } = seen(name, json!({}));
    let covered = image.iter().filter(|(_, _, pixel)| pixel[3] > 0).count();
    // Half of the square that it frames, which fills most of the picture.
    assert!(covered > 2000, "{covered} of 10000 pixels");
    socketed("socket", true);
    let drawn = seen("socket", json!({}));
    assert!(height_seen(&drawn) < 2.0, "{}", height_seen(&drawn));
    assert_eq!(target(&drawn), [3.5, 0.5]);
}

#[test]
fn what_is_shown_is_framed() {
    socketed("shown", true);
    socketed("bare", false);
    for (rig, show, center) in [
        ("shown", json!({}), [3.5, 0.5]),
        ("shown", json!({"skin": "bind"}), [0.5, 0.5]),
        // Half a unit of the triangle is right of both joints.
        ("shown", json!({"skeleton": "wireframe"}), [3.5, 20.0]),
        (
            "shown",
            json!({"skeleton": "sticks", "skin": "none"}),
            [3.0, 20.0],
        ),
        ("shown", json!({"skeleton": "boxes"}), [-1.0, 20.0]),
        (
            "shown",
            json!({"skin": "bind", "skeleton": "sticks"}),
            [1.5, 20.0],
        ),
        // A fade must not move the camera.
        ("shown", json!({"skin_opacity": 0}), [3.5, 0.5]),
        // Nothing is.
        ("shown", json!({"skin": "none"}), [3.5, 0.5]),
        ("bare", json!({}), [-1.5, 20.0]),
        ("bare", json!({"skeleton": "sticks"}), [-1.5, 20.0]),
    ] {
        let drawn = seen(rig, show.clone());
        assert_eq!(target(&drawn), center, "{rig} {show}");
    }
}

#[test]
fn a_description_says_what_its_bounds_are_of() {
    socketed("described", true);
    socketed("joints", false);
    let found = ask_ok(&SERVICE, "rig.describe", json!({"rig": "described"}));
    assert_eq!(
        found["bounds"],
        json!({"of": "vertices", "min": [3.0, 0.0, 0.0], "max": [4.0, 1.0, 0.0]})
    );
    let joints = json!({"min": [3.0, 0.0, 0.0], "max": [3.0, 40.0, 0.0]});
    assert_eq!(found["joint_bounds"], joints);
    let found = ask_ok(&SERVICE, "rig.describe", json!({"rig": "joints"}));
    let bounds = json!({"of": "joints", "min": [3.0, 0.0, 0.0], "max": [3.0, 40.0, 0.0]});
    assert_eq!(found["bounds"], bounds);
    let mesh = json!([{"name": "a.obj", "text": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3"}]);
    load("mesh", &mesh);
    let found = ask_ok(&SERVICE, "rig.describe", json!({"rig": "mesh"}));
    assert_eq!(
        (&found["bounds"]["of"], &found["joint_bounds"]),
        (&json!("vertices"), &Value::Null)
    );
}

#[test]
fn vertices_without_triangles_are_not_framed() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 90 90 0\nf 1 2 3";
    load("stray vertex", &json!([{"name": "a.obj", "text": text}]));
    assert_eq!(target(&seen("stray vertex", json!({}))), [0.5, 0.5]);
    assert_eq!(
        target(&seen("stray vertex", json!({"skin": "bind"}))),
        [0.5, 0.5]
    );
    let found = ask_ok(&SERVICE, "rig.describe", json!({"rig": "stray vertex"}));
    assert_eq!(found["bounds"]["max"], json!([90.0, 90.0, 0.0]));
}
