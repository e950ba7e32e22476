//! Does a glTF file come out as its specification says? Small files made here, one module for each part of the format; files that break
//! its rules are in `bad`.

mod accessors;
mod animations;
mod bad;
mod blends;
mod files;
mod materials;
mod morphs;
mod nodes;
mod primitives;
mod skins;
#[path = "../support/mod.rs"]
mod support;
mod textures;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use support::ask_ok;
use support::gltf::{Component, Gltf};
use support::pictures::{draw, encoded, over};

/// One renderer for all tests; each uses rigs under names of its own.
static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// Kinematics are f64, of numbers that were float32 in the file.
const NEAR: f64 = 3e-6;

/// Vertices are float32, of coordinates up to about 10.
const F32: f64 = 1e-5;

/// Eight bits of a channel, and one rounding either way.
const CHANNEL: f64 = 2.0;

fn load_files(name: &str, files: Value) -> Value {
    ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}))
}

fn load(name: &str, gltf: &Gltf) -> Value {
    load_files(name, gltf.files())
}

fn warnings(summary: &Value) -> Vec<String> {
    serde_json::from_value(summary["warnings"].clone()).expect("a list of sentences")
}

fn describe(rig: &str) -> Value {
    ask_ok(&SERVICE, "rig.describe", json!({ "rig": rig }))
}

fn numbers(value: &Value) -> Vec<f64> {
    serde_json::from_value(value.clone())
        .unwrap_or_else(|_| panic!("a list of numbers, not {value}"))
}

fn assert_near(found: &[f64], wanted: &[f64], tolerance: f64, what: &str) {
    assert_eq!(
        found.len(),
        wanted.len(),
        "{what}: {found:?} in place of {wanted:?}"
    );
    for (one, wanted_one) in found.iter().zip(wanted) {
        let is_near = (one - wanted_one).abs() <= tolerance;
        assert!(is_near, "{what}: {found:?} in place of {wanted:?}");
    }
}

struct Vertices {
    name: String,
    positions: Vec<f64>,
    normals: Vec<f64>,
}

/// Every mesh in this pose.
fn vertices(rig: &str, pose: Value) -> Vec<Vertices> {
    let found = ask_ok(
        &SERVICE,
        "mesh.vertices",
        json!({"rig": rig, "pose": over(json!({"base": "rest"}), pose)}),
    );
    let meshes = found["meshes"].as_array().expect("a list");
    let of = |mesh: &Value| Vertices {
        name: mesh["name"].as_str().expect("a name").to_owned(),
        positions: numbers(&mesh["positions"]["data"]),
        normals: numbers(&mesh["normals"]["data"]),
    };
    meshes.iter().map(of).collect()
}

/// Of the only mesh.
fn positions(rig: &str, pose: Value) -> Vec<f64> {
    let mut meshes = vertices(rig, pose);
    assert_eq!(meshes.len(), 1, "{rig}");
    meshes.remove(0).positions
}

/// `world_from_joint`, column-major.
fn joint(rig: &str, name: &str, pose: Value) -> Vec<f64> {
    let pose = over(json!({"base": "rest"}), pose);
    let found = ask_ok(
        &SERVICE,
        "joint.transforms",
        json!({"rig": rig, "pose": pose}),
    );
    let joints = found["joints"].as_array().expect("a list");
    let joint = joints.iter().find(|joint| joint["name"] == name);
    numbers(&joint.unwrap_or_else(|| panic!("no joint `{name}` in {joints:?}"))["world_from_joint"])
}

fn place(rig: &str, name: &str, pose: Value) -> Vec<f64> {
    joint(rig, name, pose)[12..15].to_vec()
}

fn clip_at(name: &str, time: f64) -> Value {
    json!({"clip": {"name": name, "time": time}})
}

type Quaternion = [f64; 4];

fn unit(quaternion: Quaternion) -> Quaternion {
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    quaternion.map(|x| x / length)
}

/// About z.
fn turn_z(angle: f64) -> Quaternion {
    [0.0, 0.0, (angle / 2.0).sin(), (angle / 2.0).cos()]
}

/// The columns of a unit quaternion's matrix.
fn rotation_columns([x, y, z, w]: Quaternion) -> Vec<f64> {
    vec![
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y + z * w),
        2.0 * (x * z - y * w),
        2.0 * (x * y - z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z + x * w),
        2.0 * (x * z + y * w),
        2.0 * (y * z - x * w),
        1.0 - 2.0 * (x * x + y * y),
    ]
}

/// The 3x3 part of a matrix of 16, column by column.
fn linear_part(matrix: &[f64]) -> Vec<f64> {
    [&matrix[0..3], &matrix[4..7], &matrix[8..11]].concat()
}

const CORNERS: [f64; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

const TOWARDS_Z: [f64; 9] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];

/// A triangle with normals, on no node yet; its mesh.
fn triangle_mesh(gltf: &mut Gltf, corners: &[f64]) -> usize {
    let attributes = json!({
        "POSITION": gltf.floats("VEC3", corners), "NORMAL": gltf.floats("VEC3", &TOWARDS_Z),
    });
    gltf.push(
        "meshes",
        json!({"name": "triangle", "primitives": [{"attributes": attributes}]}),
    )
}

/// A triangle on the node `stand`, the only one of the scene.
fn triangle() -> Gltf {
    let mut gltf = Gltf::default();
    let mesh = triangle_mesh(&mut gltf, &CORNERS);
    let node = gltf.node(json!({"name": "stand", "mesh": mesh}));
    gltf.scene(&[node]);
    gltf
}

fn case(name: &str) -> Value {
    json!([support::case(&format!("gltf/{name}"))])
}

/// Two joints, the second at (0, 1, 0). One vertex on the first, one on the second, one on both by halves. Bound at rest.
///
/// ```text
///        (0,2,0) tip    (1,2,0) both
///   tip  (0,1,0)
///   root (0,0,0) root
/// ```
fn arm(joints: Component, weights: Component) -> Gltf {
    let mut gltf = Gltf::default();
    let (one, half, rest) = match weights {
        Component::U8 => (255.0, 128.0, 127.0),
        Component::U16 => (65_535.0, 32_768.0, 32_767.0),
        _ => (1.0, 0.5, 0.5),
    };
    let shares = [one, 0.0, 0.0, 0.0, one, 0.0, 0.0, 0.0, half, rest, 0.0, 0.0];
    let weights = match weights {
        Component::F32 => gltf.floats("VEC4", &shares),
        component => gltf.normalized(component, "VEC4", &shares),
    };
    let indices = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let attributes = json!({
        "POSITION": gltf.floats("VEC3", &ARM),
        "JOINTS_0": gltf.accessor(joints, "VEC4", &indices), "WEIGHTS_0": weights,
    });
    let mesh = gltf.push(
        "meshes",
        json!({"primitives": [{"attributes": attributes}]}),
    );
    let mut bound = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]
    .repeat(2);
    bound[29] = -1.0;
    let bound = gltf.floats("MAT4", &bound);
    let root = gltf.node(json!({"name": "root", "children": [1]}));
    gltf.node(json!({"name": "tip", "translation": [0, 1, 0]}));
    let skin = gltf.push(
        "skins",
        json!({"joints": [0, 1], "inverseBindMatrices": bound}),
    );
    let body = gltf.node(json!({"name": "body", "mesh": mesh, "skin": skin}));
    gltf.scene(&[root, body]);
    gltf
}

const ARM: [f64; 9] = [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 1.0, 2.0, 0.0];

fn dofs(rig: &str) -> Vec<Value> {
    describe(rig)["dofs"].as_array().expect("a list").clone()
}

/// The triangle with targets `up` and `far`: y by 1, z by 10.
fn morphed() -> Gltf {
    let mut gltf = triangle();
    let (up, far) = ([0.0, 1.0, 0.0].repeat(3), [0.0, 0.0, 10.0].repeat(3));
    let (up, far) = (gltf.floats("VEC3", &up), gltf.floats("VEC3", &far));
    let mesh = &mut gltf.json["meshes"][0];
    mesh["primitives"][0]["targets"] = json!([{"POSITION": up}, {"POSITION": far}]);
    mesh["extras"] = json!({"targetNames": ["up", "far"]});
    gltf
}

fn first_corner(rig: &str, pose: Value) -> Vec<f64> {
    positions(rig, pose)[..3].to_vec()
}

/// A wall from -1 to 1 that faces +z, with this material. Attributes beside positions and normals are given; all its texture coordinates
/// are `texcoord`, so that a whole picture of it is one color.
fn wall(material: Value, texcoord: [f64; 2]) -> Gltf {
    let mut gltf = Gltf::default();
    let corners = [
        -1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0,
    ];
    let attributes = json!({
        "POSITION": gltf.floats("VEC3", &corners), "NORMAL": gltf.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4)),
        "TEXCOORD_0": gltf.floats("VEC2", &texcoord.repeat(4)),
    });
    let indices = gltf.accessor(Component::U8, "SCALAR", &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
    let material = gltf.push("materials", material);
    let primitive = json!({"attributes": attributes, "indices": indices, "material": material});
    let mesh = gltf.push("meshes", json!({ "primitives": [primitive] }));
    let node = gltf.node(json!({"name": "stand", "mesh": mesh}));
    gltf.scene(&[node]);
    gltf.json["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_texture_transform"]);
    gltf
}

/// Straight on, the wall fills the picture; the light is even and white, so that a pixel is the color of its material.
fn request(rig: &str, changes: Value) -> Value {
    let request = json!({
        "rig": rig, "size": [9, 9], "samples": 1, "lights": [], "ambient": [1, 1, 1],
        "material": {"specular": [0, 0, 0]}, "background": [0, 0, 1, 1],
        "camera": {"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "height": 2},
    });
    over(request, changes)
}

fn assert_seen(rig: &str, changes: Value, linear: [f64; 3]) {
    let found = draw(&SERVICE, &request(rig, changes)).image.center();
    let found: Vec<f64> = found[..3].iter().map(|&byte| f64::from(byte)).collect();
    assert_near(&found, &linear.map(encoded), CHANNEL, rig);
}
