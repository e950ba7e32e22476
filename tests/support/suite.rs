//! The pictures that renderers are compared by: every camera, light, view and material, small. What could change with a default is
//! spelled out. Never lives here: what they are compared with.

use super::pictures::over;
use super::{ask_ok, places, with_base64};
use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::Arc;

/// A square wall that wears a picture of four different corners and a diagonal.
pub fn load_corners(service: &Arc<Service>) {
    let skin = "positions 4 { -1 -1 0 1 -1 0 1 1 0 -1 1 0 } normals 4 { 0 0 1 0 0 1 0 0 1 0 0 1 }
        texcoords 4 { 0 0 1 0 1 1 0 1 } material paint { texture corners.png } triangles 2 { 0 1 2 0 2 3 }";
    let texel = |x: u32, y: u32| match (x < 32, y < 32) {
        _ if x.abs_diff(y) < 3 => [0, 0, 0],
        (true, true) => [230, 40, 30],
        (false, true) => [40, 200, 60],
        (true, false) => [40, 70, 230],
        (false, false) => [250, 250, 240],
    };
    let picture = image::RgbImage::from_fn(64, 64, |x, y| image::Rgb(texel(x, y)));
    let mut file = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut file, image::ImageFormat::Png)
        .expect("a picture");
    let files = json!([{"name": "corners.skin", "text": skin}, with_base64("corners.png", &file.into_inner())]);
    ask_ok(
        service,
        "rig.load",
        json!({"name": "corners", "files": files}),
    );
}

/// A character with materials of its own.
pub fn load_reed(service: &Arc<Service>) {
    let file = include_bytes!("../../assets/gltf/reed.glb");
    let files = json!([with_base64("reed.glb", file)]);
    ask_ok(service, "rig.load", json!({"files": files}));
}

/// The rigs of the courses' formats.
pub fn load_samples(service: &Arc<Service>) {
    let load = |folder: &str, files: &[&str]| {
        let folder = places::repository("assets").join(folder);
        let inline =
            |name: &&str| with_base64(name, &std::fs::read(folder.join(name)).expect("a file"));
        let files: Vec<Value> = files.iter().map(inline).collect();
        ask_ok(service, "rig.load", json!({"files": files}));
    };
    load("cse169/drake", &DRAKE);
    load("mit6837/bear", &BEAR);
}

/// The list of files comes first, for the rig has its name.
pub const DRAKE: [&str; 9] = [
    "drake.rig",
    "drake.skel",
    "drake.skin",
    "drake.png",
    "smile.morph",
    "blink.morph",
    "puff.morph",
    "walk.anim",
    "flap.anim",
];
pub const BEAR: [&str; 3] = ["bear.skel", "bear.obj", "bear.attach"];

/// The drake from the front left, its picture as it is.
fn drake(changes: Value) -> Value {
    let before = json!({"kind": "look_at", "eye": [1.9, 1.2, 2.4], "target": [0, 0.55, -0.1], "fov_y": 0.55});
    over(base(json!({"rig": "drake", "camera": before})), changes)
}

/// The reed as its file has it.
fn reed(changes: Value) -> Value {
    let before =
        json!({"kind": "look_at", "eye": [1.2, 1.2, 3], "target": [0, 0.72, 0], "fov_y": 0.55});
    let own = json!({"rig": "reed", "camera": before, "material": {}});
    over(base(own), changes)
}

/// The figure from the front left, its texture as it is, in a warm and a cool light; what could change with a default is spelled out.
pub fn base(changes: Value) -> Value {
    let before =
        json!({"kind": "look_at", "eye": [0.6, 1.3, 4], "target": [0, 0.9, 0], "fov_y": 0.55});
    let request = json!({
        "rig": "figure", "size": [96, 120], "samples": 4, "camera": before, "lights": [key(), fill()],
        "ambient": [0.05, 0.05, 0.07], "pose": {"base": "rest"}, "background": [0.03, 0.036, 0.048, 1],
        "material": {"specular": [0.22, 0.22, 0.22], "shininess": 40},
        "show": {"skin": "posed", "skeleton": "none", "skin_opacity": 1, "normals": "smooth"},
    });
    over(request, changes)
}

fn key() -> Value {
    json!({"kind": "directional", "direction": [0.4, -0.6, -0.8], "color": [1, 0.92, 0.8], "intensity": 0.9})
}

fn fill() -> Value {
    json!({"kind": "directional", "direction": [-0.9, -0.1, 0.2], "color": [0.4, 0.6, 1], "intensity": 0.6})
}

/// Name and request of each; [corners](load_corners), [reed](load_reed) and [samples](load_samples) are loaded beside the figure.
pub fn suite() -> Vec<(&'static str, Value)> {
    let show = |skin: &str, skeleton: &str, opacity: f64| json!({"show": {"skin": skin, "skeleton": skeleton, "skin_opacity": opacity, "normals": "smooth"}});
    let point = |falloff: &str| json!({"lights": [{"kind": "point", "position": [0.7, 1.7, 0.8], "color": [1, 0.8, 0.5], "intensity": 0.9, "falloff": falloff}]});
    let orbit = json!({"kind": "orbit", "target": [0, 0.9, 0], "distance": 4.2, "azimuth": 0.8, "inclination": 0.4, "fov_y": 0.55});
    let orthographic =
        json!({"kind": "look_at", "eye": [-3, 3, 3], "target": [0, 0.9, 0], "height": 2.2});
    let from_side = json!([0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 4, 0.9, 0, 1]);
    let gl = json!({"kind": "pinhole", "fx": 200, "fy": 200, "cx": 48, "cy": 60, "world_from_camera": from_side});
    let from_behind = json!([-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0.9, -4, 1]);
    let cv = json!({"kind": "pinhole", "fx": 200, "fy": 200, "cx": 30, "cy": 66, "axes": "cv", "world_from_camera": from_behind});
    let face = json!({"kind": "look_at", "eye": [-0.08, 1.62, 0.85], "target": [0.02, 1.58, 0.03], "fov_y": 0.42});
    let smile = |weight: f64| {
        let dofs = json!({"morph.smile": weight, "morph.blink": weight / 2.0});
        base(json!({"camera": face, "size": [120, 120], "pose": {"base": "rest", "dofs": dofs}}))
    };
    let stride =
        json!({"base": "rest", "clip": {"name": "walk", "time": 0.02}, "dofs": {"pelvis.tz": 0}});
    let posed = |shown: Value| over(base(json!({"pose": stride})), shown);
    let twisted =
        json!({"base": "rest", "dofs": {"spine.ry": 1.4, "chest.ry": 1.4}, "limits": "ignore"});
    let wall = json!({"kind": "look_at", "eye": [0.5, 0.6, 3], "target": [0, 0, 0], "fov_y": 0.9});
    let flat = json!({"show": {"skin": "posed", "skeleton": "none", "skin_opacity": 1, "normals": "flat"}});
    let clear = json!({"size": [60, 120], "background": [0, 0, 0, 0]});
    vec![
        ("reed_rest", reed(json!({}))),
        (
            "reed_hop",
            reed(
                json!({"pose": {"base": "rest", "clip": {"name": "hop", "time": 0.8}}, "samples": 1}),
            ),
        ),
        (
            "reed_blend",
            reed(json!({"pose": {"base": "rest", "clips": [
                {"name": "hop", "time": 0.3, "weight": 0.5}, {"name": "sway", "time": 1.4, "weight": 1},
            ]}, "material": {"diffuse": [0.7, 0.7, 0.7], "shininess": 9}})),
        ),
        (
            "reed_translucent",
            reed(
                json!({"show": {"skin": "posed", "skeleton": "sticks", "skin_opacity": 0.5, "normals": "flat"}}),
            ),
        ),
        ("drake_rest", drake(json!({}))),
        (
            "drake_flap",
            drake(
                json!({"pose": {"base": "rest", "clip": {"name": "flap", "time": 0.1}, "dofs": {"hips.ty": 0, "morph.smile": 1, "morph.blink": 1}}}),
            ),
        ),
        (
            "bear_waves",
            base(
                json!({"rig": "bear", "pose": {"base": "rest", "dofs": {"arm_l.rz": 0.9, "forearm_l.rz": 0.6, "head.rz": 0.2}},
                "camera": {"kind": "look_at", "eye": [0.8, 0.8, 2], "target": [0, 0.52, 0], "fov_y": 0.6},
                "show": {"skin": "posed", "skeleton": "sticks", "skin_opacity": 0.6, "normals": "smooth"}}),
            ),
        ),
        ("camera_orbit", base(json!({"camera": orbit}))),
        ("camera_look_at", base(json!({}))),
        ("camera_orthographic", base(json!({"camera": orthographic}))),
        ("camera_pinhole_gl", base(json!({"camera": gl}))),
        ("camera_pinhole_cv", base(json!({"camera": cv}))),
        (
            "light_ambient",
            base(json!({"lights": [], "ambient": [0.4, 0.45, 0.5]})),
        ),
        ("light_directional", base(json!({"lights": [key()]}))),
        ("light_point", base(point("none"))),
        ("light_inverse_square", base(point("inverse_square"))),
        (
            "plain",
            base(json!({"material": {"diffuse": [0.9, 0.3, 0.2], "specular": [0, 0, 0]}})),
        ),
        ("skeleton_wireframe", posed(show("none", "wireframe", 1.0))),
        ("skeleton_boxes", posed(show("none", "boxes", 1.0))),
        ("skeleton_sticks", posed(show("none", "sticks", 1.0))),
        ("skeleton_cylinders", posed(show("none", "cylinders", 1.0))),
        ("skin_over_wireframe", base(show("posed", "wireframe", 0.5))),
        ("skin_over_sticks", posed(show("posed", "sticks", 0.4))),
        ("skin_posed", posed(json!({}))),
        ("skin_bound", posed(show("bind", "cylinders", 0.5))),
        ("morph_0", smile(0.0)),
        ("morph_half", smile(0.5)),
        ("morph_1", smile(1.0)),
        (
            "texture_corners",
            base(
                json!({"rig": "corners", "camera": wall, "lights": [], "ambient": [1, 1, 1], "pose": {}}),
            ),
        ),
        (
            "twist_linear",
            base(json!({"pose": twisted, "skinning": "linear"})),
        ),
        (
            "twist_dual_quaternion",
            base(json!({"pose": twisted, "skinning": "dual_quaternion"})),
        ),
        ("flat", base(flat)),
        ("wide", base(json!({"size": [160, 80]}))),
        ("tall", base(clear)),
    ]
}
