//! Does a glTF file come out as its specification says? Small files made here, of which every number is known.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4};
use std::io::Cursor;
use std::sync::{Arc, LazyLock};
use support::gltf::{Component, Gltf};
use support::pictures::{draw, encoded, over};
use support::{ask, ask_kind, ask_ok, with_base64};

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

/// Indices of the only mesh's triangles, each beginning with its smallest: where a triangle begins says nothing.
fn triangles(rig: &str) -> Vec<[u64; 3]> {
    let found = ask_ok(&SERVICE, "mesh.topology", json!({ "rig": rig }));
    let indices: Vec<u64> =
        serde_json::from_value(found["meshes"][0]["triangles"]["data"].clone()).expect("indices");
    let (triangles, rest) = indices.as_chunks::<3>();
    assert!(rest.is_empty());
    let from_smallest = |&[a, b, c]: &[u64; 3]| match a.min(b).min(c) {
        first if first == a => [a, b, c],
        first if first == b => [b, c, a],
        _ => [c, a, b],
    };
    triangles.iter().map(from_smallest).collect()
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

/// Appendix C of the specification, the shortest way.
fn slerp(from: Quaternion, to: Quaternion, share: f64) -> Quaternion {
    let dot: f64 = (0..4).map(|i| from[i] * to[i]).sum();
    let angle = dot.abs().acos();
    let sign = dot.signum();
    let part = |share: f64| (share * angle).sin() / angle.sin();
    std::array::from_fn(|i| part(1.0 - share) * from[i] + sign * part(share) * to[i])
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

#[test]
fn a_buffer_comes_from_wherever_it_is() {
    let gltf = triangle();
    let beside = |uri: &str, name: &str| {
        let text = gltf.document(Some(uri)).to_string();
        json!([{"name": "x.gltf", "text": text}, with_base64(name, &gltf.bytes)])
    };
    let other_media = gltf.data_uri().replace("octet-stream", "gltf-buffer");
    let other_media = gltf.document(Some(&other_media)).to_string();
    for (what, files) in [
        ("a data URI", gltf.files()),
        (
            "a data URI of glTF's own media type",
            json!([{"name": "x.gltf", "text": other_media}]),
        ),
        ("a file beside", beside("x.bin", "x.bin")),
        (
            "a file whose name has a space",
            beside("my%20data.bin", "my data.bin"),
        ),
        ("a binary chunk", json!([with_base64("x.glb", &gltf.glb())])),
        (
            "a binary file of another name",
            json!([with_base64("x", &gltf.glb())]),
        ),
    ] {
        let summary = load_files(what, files);
        assert_eq!(warnings(&summary), [""; 0], "{what}");
        assert_eq!(
            (&summary["vertex_count"], &summary["triangle_count"]),
            (&json!(3), &json!(1)),
            "{what}"
        );
        assert_near(&positions(what, json!({})), &CORNERS, 0.0, what);
    }
}

/// `count` vertices in a zigzag, drawn in this mode by these indices.
fn drawn_as(mode: u64, count: usize, indices: Option<(Component, &[f64])>) -> Gltf {
    let mut gltf = Gltf::default();
    let zigzag: Vec<f64> = (0..count)
        .flat_map(|i| [i as f64, (i % 2) as f64, 0.0])
        .collect();
    let mut primitive =
        json!({"attributes": {"POSITION": gltf.floats("VEC3", &zigzag)}, "mode": mode});
    if let Some((component, indices)) = indices {
        primitive["indices"] = json!(gltf.accessor(component, "SCALAR", indices));
    }
    let mesh = gltf.push("meshes", json!({"primitives": [primitive]}));
    let node = gltf.node(json!({ "mesh": mesh }));
    gltf.scene(&[node]);
    gltf
}

#[test]
fn triangles_are_wound_as_the_specification_says() {
    let two = &[0.0, 1.0, 2.0, 2.0, 1.0, 3.0][..];
    let five = &[4.0, 3.0, 2.0, 1.0, 0.0][..];
    let (triangle_list, strip, fan) = (4, 5, 6);
    for (what, mode, count, indices, wanted) in [
        (
            "u8",
            triangle_list,
            4,
            Some((Component::U8, two)),
            &[[0_u64, 1, 2], [1, 3, 2]][..],
        ),
        (
            "u16",
            triangle_list,
            4,
            Some((Component::U16, two)),
            &[[0, 1, 2], [1, 3, 2]],
        ),
        (
            "u32",
            triangle_list,
            4,
            Some((Component::U32, two)),
            &[[0, 1, 2], [1, 3, 2]],
        ),
        ("bare", triangle_list, 6, None, &[[0, 1, 2], [3, 4, 5]]),
        ("strip", strip, 5, None, &[[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
        (
            "strip by indices",
            strip,
            5,
            Some((Component::U8, five)),
            &[[2, 4, 3], [1, 2, 3], [0, 2, 1]],
        ),
        ("fan", fan, 5, None, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
        (
            "fan by indices",
            fan,
            5,
            Some((Component::U16, five)),
            &[[2, 4, 3], [1, 4, 2], [0, 4, 1]],
        ),
    ] {
        load(what, &drawn_as(mode, count, indices));
        assert_eq!(triangles(what), wanted, "{what}");
    }
}

#[test]
fn points_and_lines_are_left_out_and_warned_of() {
    for mode in 0..4 {
        let mut gltf = triangle();
        let corners = gltf.floats("VEC3", &CORNERS);
        let other = json!({"attributes": {"POSITION": corners}, "mode": mode});
        let primitives = gltf.json["meshes"][0]["primitives"].as_array_mut();
        primitives.expect("a list").push(other);
        let name = format!("mode {mode}");
        let summary = load(&name, &gltf);
        assert_eq!(summary["triangle_count"], 1, "{name}");
        assert_eq!(warnings(&summary).len(), 1, "{name}: {summary}");
        assert_near(&positions(&name, json!({})), &CORNERS, 0.0, &name);
    }
}

fn case(name: &str) -> Value {
    json!([support::case(&format!("gltf/{name}"))])
}

/// One triangle, whatever else the file has.
#[test]
fn what_is_valid_and_seldom_loads() {
    for (name, told) in [
        ("accessor_of_zeros.gltf", None),
        ("data_uri_percent_encoded.gltf", None),
        ("integers_as_floats.gltf", None),
        ("unused_placeholder_buffer.gltf", Some("buffers[1]")),
        ("glb_json_then_unknown_chunk_no_bin.glb", Some("`TEST`")),
    ] {
        let summary = load_files(name, case(name));
        let warnings = warnings(&summary);
        assert_eq!(
            warnings.len(),
            usize::from(told.is_some()),
            "{name}: {warnings:?}"
        );
        assert!(
            warnings
                .iter()
                .all(|it| it.contains(told.unwrap_or_default())),
            "{warnings:?}"
        );
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(positions(name, json!({})), corners, "{name}");
    }
    let moved = positions(
        "accessor_of_zeros.gltf",
        json!({"dofs": {"morph.morph_0": 1.0}}),
    );
    assert_eq!(moved, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn points_are_left_out_with_what_moves_them() {
    let name = "morphed_points_animated.gltf";
    let summary = load_files(name, case(name));
    let warnings = warnings(&summary);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("meshes[1].primitives[0] is not made of triangles"));
    assert!(warnings[1].contains("animations[0].channels[0] moves morph targets of nodes[1]"));
    assert_eq!(
        (&summary["triangle_count"], &summary["clip_count"]),
        (&json!(1), &json!(1))
    );
    assert_eq!(positions(name, clip_at("clip_0", 0.5)).len(), 9);
}

/// The node turns y to -z and is a hundred times as large; the skin's joint stands where it does.
#[test]
fn a_vertex_without_weights_stands_where_the_node_puts_it() {
    let name = "vertex_without_weights.gltf";
    let summary = load_files(name, case(name));
    assert!(
        warnings(&summary)[0].contains("1 vertices have no weights"),
        "{summary}"
    );
    let wanted = [0.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, -100.0];
    assert_near(&positions(name, json!({})), &wanted, 1e-3, name);
}

#[test]
fn what_has_no_weights_moves_with_its_node_and_not_with_the_skin() {
    let set = |gltf: &mut Gltf, weights: [f32; 4]| {
        // Accessor 0 holds the weights, the first vertex is on the root alone.
        for (index, weight) in weights.into_iter().enumerate() {
            gltf.set_float(0, index, weight);
        }
    };
    for (name, weights) in [("none", [0.0; 4]), ("none in all", [-1.0, 1.0, 0.0, 0.0])] {
        let mut gltf = arm(Component::U8, Component::F32);
        gltf.json["nodes"][2]["translation"] = json!([5, 0, 0]);
        set(&mut gltf, weights);
        load(name, &gltf);
        // The others are bound to the skin, for which the node counts nothing.
        let mut wanted = ARM;
        wanted[0] = 5.0;
        assert_near(&positions(name, json!({})), &wanted, F32, name);
        let moved = json!({"dofs": {"body.ty": 3.0, "root.tx": 1.0}});
        assert_near(
            &positions(name, moved)[..6],
            &[5.0, 3.0, 0.0, 1.0, 2.0, 0.0],
            F32,
            name,
        );
    }
    let mut gltf = arm(Component::U8, Component::F32);
    gltf.json["nodes"][2]["translation"] = json!([5, 0, 0]);
    let attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut();
    let attributes = attributes.expect("an object");
    attributes.retain(|name, _| name == "POSITION");
    let summary = load("jointless", &gltf);
    assert!(
        warnings(&summary)[0].contains("3 vertices have no weights"),
        "{summary}"
    );
    let all = positions("jointless", json!({}));
    assert_near(&all[..6], &[5.0, 0.0, 0.0, 5.0, 2.0, 0.0], F32, "jointless");
}

/// With and without base64, escaped or broken into lines, padded or not.
#[test]
fn a_data_uri_holds_the_same_bytes_however_it_is_written() {
    let gltf = triangle();
    let base64 = gltf.data_uri();
    let (head, text) = base64.split_once(',').expect("a data URI");
    let escaped = |bytes: &[u8]| {
        let escape = |byte: &u8| format!("%{byte:02x}");
        bytes.iter().map(escape).collect::<String>()
    };
    let (first, last) = text.split_at(10);
    for (what, uri) in [
        (
            "escaped base64",
            format!("{head},{}", escaped(text.as_bytes())),
        ),
        (
            "padding that is escaped",
            format!("{head},{}%3D%3D", text.trim_end_matches('=')),
        ),
        (
            "no padding",
            format!("{head},{}", text.trim_end_matches('=')),
        ),
        ("two lines", format!("{head},{first}%0D%0A{last}")),
        (
            "a parameter before",
            format!("data:application/octet-stream;charset=x;BASE64,{text}"),
        ),
        (
            "bytes",
            format!("data:application/octet-stream,{}", escaped(&gltf.bytes)),
        ),
        (
            "bytes of no medium",
            format!("data:,{}", escaped(&gltf.bytes)),
        ),
    ] {
        let content = gltf.document(Some(&uri)).to_string();
        let summary = load_files(what, json!([{"name": "x.gltf", "text": content}]));
        assert_eq!(warnings(&summary), [""; 0], "{what}");
        assert_eq!(positions(what, json!({})), CORNERS, "{what}");
    }
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

/// With the tip turned by a quarter: about (0, 1, 0), x goes to y and y to -x; the last one is half way.
const BENT: [f64; 9] = [0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 2.0, 0.0];

fn bent() -> Value {
    json!({"dofs": {"tip.rz": FRAC_PI_2}})
}

#[test]
fn joints_and_weights_are_read_in_every_type_they_come_in() {
    for joints in [Component::U8, Component::U16] {
        for (weights, tolerance) in [
            (Component::F32, F32),
            // Half of 255 is not whole.
            (Component::U8, 0.01),
            (Component::U16, 1e-4),
        ] {
            let name = format!("{joints:?} and {weights:?}");
            let summary = load(&name, &arm(joints, weights));
            assert_eq!(warnings(&summary), [""; 0], "{name}");
            assert_near(&positions(&name, json!({})), &ARM, F32, &name);
            assert_near(&positions(&name, bent()), &BENT, tolerance, &name);
        }
    }
}

#[test]
fn a_vertex_follows_all_eight_of_its_joints() {
    let mut gltf = triangle();
    let weights = [0.25, 0.125, 0.125, 0.1, 0.1, 0.1, 0.15, 0.05];
    for set in 0..2 {
        let joints: Vec<f64> = (4 * set..4 * set + 4).map(|joint| joint as f64).collect();
        let joints = gltf.accessor(Component::U8, "VEC4", &joints.repeat(3));
        let shares = gltf.floats("VEC4", &weights[4 * set..4 * set + 4].repeat(3));
        let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
        attributes[format!("JOINTS_{set}")] = json!(joints);
        attributes[format!("WEIGHTS_{set}")] = json!(shares);
    }
    let joints: Vec<usize> = (0..8)
        .map(|joint| gltf.node(json!({"name": format!("j{joint}")})))
        .collect();
    gltf.push("skins", json!({ "joints": joints }));
    gltf.json["nodes"][0]["skin"] = json!(0);
    gltf.json["scenes"][0]["nodes"] = json!((0..9).collect::<Vec<_>>());
    load("eight", &gltf);
    let dofs: serde_json::Map<String, Value> = (0..8_i32)
        .map(|joint| (format!("j{joint}.tx"), json!(f64::from(joint * joint))))
        .collect();
    let moved: f64 = weights
        .iter()
        .zip(0..8_i32)
        .map(|(weight, joint)| weight * f64::from(joint * joint))
        .sum();
    let wanted: Vec<f64> = CORNERS
        .chunks(3)
        .flat_map(|at| [at[0] + moved, at[1], at[2]])
        .collect();
    assert_near(
        &positions("eight", json!({ "dofs": dofs })),
        &wanted,
        F32,
        "eight influences",
    );
}

#[test]
fn weights_are_divided_by_their_sum_and_that_is_warned_of() {
    let mut gltf = arm(Component::U8, Component::F32);
    let weights = gltf.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"].as_u64();
    let weights = weights.expect("an index") as usize;
    for (index, weight) in [(0, 0.5), (4, 0.5), (8, 0.25), (9, 0.25)] {
        gltf.set_float(weights, index, weight);
    }
    let summary = load("light", &gltf);
    assert_eq!(warnings(&summary).len(), 1, "{summary}");
    assert_near(&positions("light", bent()), &BENT, F32, "light");
}

#[test]
fn vertices_may_lie_interleaved() {
    let mut gltf = triangle();
    let mut bytes = vec![0xFF; 4];
    for (corner, normal) in CORNERS.chunks(3).zip(TOWARDS_Z.chunks(3)) {
        bytes.extend(
            corner
                .iter()
                .chain(normal)
                .flat_map(|&x| (x as f32).to_le_bytes()),
        );
        bytes.extend([0xFF; 4]);
    }
    let view = gltf.view(&bytes);
    gltf.json["bufferViews"][view]["byteStride"] = json!(28);
    let accessor = |offset: usize| json!({"bufferView": view, "byteOffset": offset, "componentType": 5126, "type": "VEC3", "count": 3});
    gltf.json["accessors"] = json!([accessor(4), accessor(16)]);
    load("interleaved", &gltf);
    let mesh = vertices("interleaved", json!({})).remove(0);
    assert_near(&mesh.positions, &CORNERS, 0.0, "positions");
    assert_near(&mesh.normals, &TOWARDS_Z, F32, "normals");
}

#[test]
fn sparse_accessors_replace_some_of_their_elements() {
    for (what, has_view, wanted) in [
        (
            "over a view",
            true,
            [0.0, 0.0, 0.0, 5.0, 6.0, 7.0, 0.0, 1.0, 0.0],
        ),
        (
            "over zeros",
            false,
            [0.0, 0.0, 0.0, 5.0, 6.0, 7.0, 0.0, 0.0, 0.0],
        ),
    ] {
        for indices in [Component::U8, Component::U16, Component::U32] {
            let mut gltf = triangle();
            let at = gltf.view(&indices.bytes(1.0));
            let values: Vec<u8> = [5.0, 6.0, 7.0]
                .iter()
                .flat_map(|&x| Component::F32.bytes(x))
                .collect();
            let values = gltf.view(&values);
            let accessor = &mut gltf.json["accessors"][0];
            accessor["sparse"] = json!({
                "count": 1, "values": {"bufferView": values},
                "indices": {"bufferView": at, "componentType": indices.code()},
            });
            if !has_view {
                accessor
                    .as_object_mut()
                    .expect("an object")
                    .remove("bufferView");
            }
            let name = format!("sparse {what} by {indices:?}");
            load(&name, &gltf);
            assert_near(&positions(&name, json!({})), &wanted, 0.0, &name);
        }
    }
}

#[test]
fn missing_normals_are_made_up() {
    let mut gltf = triangle();
    let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes
        .as_object_mut()
        .expect("an object")
        .remove("NORMAL");
    let summary = load("without normals", &gltf);
    assert_eq!(warnings(&summary), [""; 0]);
    for normal in vertices("without normals", json!({}))
        .remove(0)
        .normals
        .chunks(3)
    {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert_near(&[length], &[1.0], F32, "unit length");
    }
    let drawn = draw(
        &SERVICE,
        &json!({"rig": "without normals", "size": [16, 16]}),
    );
    assert_eq!(drawn.image.size(), [16, 16]);
}

/// `v` of `mesh.topology` is 0 at the bottom of the picture, glTF's at its top.
fn v_of_file(v: f64) -> f64 {
    1.0 - v
}

#[test]
fn quantized_vertices_are_read_as_what_they_stand_for() {
    for (component, is_normalized, one) in [
        (Component::I8, false, 1.0),
        (Component::I8, true, 127.0),
        (Component::U8, true, 255.0),
        (Component::I16, false, 1.0),
        (Component::I16, true, 32_767.0),
        (Component::U16, false, 1.0),
        (Component::U16, true, 65_535.0),
    ] {
        let name = format!("{component:?}, normalized: {is_normalized}");
        let mut gltf = triangle();
        let corners = CORNERS.map(|x| x * one);
        let corners = if is_normalized {
            gltf.normalized(component, "VEC3", &corners)
        } else {
            gltf.accessor(component, "VEC3", &corners)
        };
        let normals = gltf.normalized(Component::I8, "VEC3", &TOWARDS_Z.map(|x| x * 127.0));
        let texcoords = gltf.accessor(Component::U16, "VEC2", &[0.0, 0.0, 3.0, 0.0, 0.0, 4.0]);
        gltf.json["meshes"][0]["primitives"][0]["attributes"] =
            json!({"POSITION": corners, "NORMAL": normals, "TEXCOORD_0": texcoords});
        gltf.json["nodes"][0]["scale"] = json!([2, 3, 4]);
        for list in ["extensionsUsed", "extensionsRequired"] {
            gltf.json[list] = json!(["KHR_mesh_quantization"]);
        }
        let summary = load(&name, &gltf);
        assert_eq!(warnings(&summary), [""; 0], "{name}");
        let mesh = vertices(&name, json!({})).remove(0);
        assert_near(
            &mesh.positions,
            &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0, 0.0],
            F32,
            &name,
        );
        assert_near(&mesh.normals, &TOWARDS_Z, F32, &name);
        let topology = ask_ok(&SERVICE, "mesh.topology", json!({ "rig": name }));
        let wanted = [
            0.0,
            v_of_file(0.0),
            3.0,
            v_of_file(0.0),
            0.0,
            v_of_file(4.0),
        ];
        assert_near(
            &numbers(&topology["meshes"][0]["texcoords"]["data"]),
            &wanted,
            F32,
            &name,
        );
    }
    // Below -1 by one step is still -1.
    let mut gltf = triangle();
    let lowest = gltf.normalized(
        Component::I16,
        "VEC3",
        &[-32_768.0, 0.0, 0.0, 32_767.0, 0.0, 0.0, 0.0, 32_767.0, 0.0],
    );
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(lowest);
    gltf.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    gltf.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    load("lowest", &gltf);
    assert_near(
        &positions("lowest", json!({}))[..3],
        &[-1.0, 0.0, 0.0],
        F32,
        "lowest",
    );
}

#[test]
fn extensions_are_known_refused_or_warned_of() {
    for known in [
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_materials_unlit",
        "KHR_materials_pbrSpecularGlossiness",
    ] {
        let mut gltf = triangle();
        gltf.json["extensionsUsed"] = json!([known]);
        gltf.json["extensionsRequired"] = json!([known]);
        assert_eq!(warnings(&load(known, &gltf)), [""; 0], "{known}");
    }
    let mut gltf = triangle();
    gltf.json["extensionsUsed"] = json!(["EXT_of_nobody"]);
    let warnings = warnings(&load("used", &gltf));
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("EXT_of_nobody"), "{warnings:?}");

    gltf.json["extensionsRequired"] = json!(["EXT_of_nobody"]);
    let params = json!({"name": "required", "files": gltf.files()});
    let error = ask(&SERVICE, "rig.load", params).expect_err("it is required");
    assert_eq!(error.data.kind, "rig_file_invalid");
    assert!(error.message.contains("EXT_of_nobody"), "{}", error.message);
}

#[test]
fn skins_and_meshes_meet_in_every_way() {
    // Two skins, each with one joint and one mesh.
    let mut gltf = Gltf::default();
    let joints = gltf.accessor(Component::U8, "VEC4", &[0.0; 12]);
    let weights = gltf.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    for name in ["left", "right"] {
        let mesh = triangle_mesh(&mut gltf, &CORNERS);
        let attributes = &mut gltf.json["meshes"][mesh]["primitives"][0]["attributes"];
        attributes["JOINTS_0"] = json!(joints);
        attributes["WEIGHTS_0"] = json!(weights);
        let joint = gltf.node(json!({ "name": name }));
        let skin = gltf.push("skins", json!({"joints": [joint]}));
        // Where a skinned mesh hangs says nothing.
        gltf.node(
            json!({"mesh": mesh, "skin": skin, "translation": [50, 0, 0], "scale": [7, 7, 7]}),
        );
    }
    gltf.scene(&[0, 1, 2, 3]);
    load("two skins", &gltf);
    let pose = json!({"dofs": {"left.tx": 1, "right.tx": 2}});
    let starts = |rig: &str| -> Vec<f64> {
        let meshes = vertices(rig, pose.clone());
        assert!(meshes.iter().all(|mesh| mesh.positions.len() == 9));
        meshes.iter().map(|mesh| mesh.positions[0]).collect()
    };
    assert_near(&starts("two skins"), &[1.0, 2.0], F32, "two skins");

    gltf.json["nodes"][3]["skin"] = json!(0);
    load("one skin", &gltf);
    assert_near(&starts("one skin"), &[1.0, 1.0], F32, "one skin");

    gltf.json["nodes"][3] = json!({"mesh": 0, "skin": 1});
    load("one mesh, two skins", &gltf);
    assert_near(
        &starts("one mesh, two skins"),
        &[1.0, 2.0],
        F32,
        "one mesh, two skins",
    );
}

#[test]
fn a_mesh_under_two_nodes_is_drawn_twice() {
    let mut gltf = triangle();
    gltf.node(json!({"name": "other", "mesh": 0, "translation": [5, 0, 0]}));
    gltf.json["scenes"][0]["nodes"] = json!([0, 1]);
    let summary = load("twice", &gltf);
    assert_eq!(
        (&summary["vertex_count"], &summary["triangle_count"]),
        (&json!(6), &json!(2))
    );
    let meshes = vertices("twice", json!({"dofs": {"other.ty": 1}}));
    assert_eq!(meshes.len(), 2);
    assert_ne!(meshes[0].name, meshes[1].name);
    assert_near(&meshes[0].positions, &CORNERS, F32, "the first");
    assert_near(
        &meshes[1].positions[..3],
        &[5.0, 1.0, 0.0],
        F32,
        "the second",
    );
    let asked = json!({"rig": "twice", "mesh": meshes[1].name});
    let found = ask_ok(&SERVICE, "mesh.vertices", asked);
    assert_eq!(found["meshes"].as_array().map(Vec::len), Some(1));
}

#[test]
fn primitives_of_a_mesh_lie_one_after_another() {
    let mut gltf = triangle();
    let later = gltf.floats("VEC3", &CORNERS.map(|x| x + 10.0));
    let indices = gltf.accessor(Component::U8, "SCALAR", &[0.0, 2.0, 1.0]);
    let primitives = gltf.json["meshes"][0]["primitives"].as_array_mut();
    primitives
        .expect("a list")
        .push(json!({"attributes": {"POSITION": later}, "indices": indices}));
    load("primitives", &gltf);
    let wanted = [CORNERS, CORNERS.map(|x| x + 10.0)].concat();
    assert_near(&positions("primitives", json!({})), &wanted, F32, "both");
    assert_eq!(triangles("primitives"), [[0_u64, 1, 2], [3, 5, 4]]);
}

#[test]
fn a_mesh_without_a_skin_moves_with_its_node() {
    let mut gltf = triangle();
    gltf.node(json!({"name": "base", "children": [0], "translation": [0, 0, 3]}));
    gltf.json["scenes"][0]["nodes"] = json!([1]);
    let (times, values) = (
        gltf.floats("SCALAR", &[0.0, 2.0]),
        gltf.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]),
    );
    gltf.channel(
        "slide",
        json!({"node": 0, "path": "translation"}),
        json!({"input": times, "output": values}),
    );
    load("slid", &gltf);
    let wanted = [1.0, 0.0, 3.0, 2.0, 0.0, 3.0, 1.0, 1.0, 3.0];
    assert_near(
        &positions("slid", clip_at("slide", 0.5)),
        &wanted,
        F32,
        "slid",
    );
    let raised = json!({"dofs": {"base.ty": 2, "stand.sx": 3}});
    let wanted = [0.0, 2.0, 3.0, 3.0, 2.0, 3.0, 0.0, 3.0, 3.0];
    assert_near(
        &positions("slid", raised),
        &wanted,
        F32,
        "raised and stretched",
    );
}

#[test]
fn a_matrix_is_taken_apart() {
    let mut gltf = triangle();
    // A quarter about z after a scale of (2, 3, 4).
    let matrix = [
        0.0, 2.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 1.0, 2.0, 3.0, 1.0,
    ];
    gltf.json["nodes"][0]["matrix"] = json!(matrix);
    let summary = load("matrix", &gltf);
    assert_eq!(warnings(&summary), [""; 0]);
    assert_near(
        &joint("matrix", "stand", json!({})),
        &matrix,
        NEAR,
        "as it was",
    );
    let rest: Vec<f64> = dofs("matrix")
        .iter()
        .map(|dof| dof["rest"].as_f64().expect("a number"))
        .collect();
    assert_near(
        &rest,
        &[0.0, 0.0, 0.0, 0.0, 0.0, FRAC_PI_2, 2.0, 3.0, 4.0],
        NEAR,
        "rest",
    );
    let local = ask_ok(&SERVICE, "pose.get", json!({"rig": "matrix"}))["joints"]["stand"].take();
    assert_near(
        &numbers(&local["translation"]),
        &[1.0, 2.0, 3.0],
        NEAR,
        "translation",
    );
    assert_near(&numbers(&local["scale"]), &[2.0, 3.0, 4.0], NEAR, "scale");
    // Moved from where it rests.
    assert_near(
        &place("matrix", "stand", json!({"dofs": {"stand.tx": 10}})),
        &[11.0, 2.0, 3.0],
        NEAR,
        "moved",
    );
}

fn dofs(rig: &str) -> Vec<Value> {
    describe(rig)["dofs"].as_array().expect("a list").clone()
}

#[test]
fn names_are_made_unique() {
    let mut gltf = Gltf::default();
    gltf.node(json!({"children": [1, 2, 3]}));
    for node in [
        json!({"name": "knee"}),
        json!({"name": "knee"}),
        json!({"name": ""}),
    ] {
        gltf.node(node);
    }
    gltf.scene(&[0]);
    load("named", &gltf);
    let described = describe("named");
    let joints = described["joints"].as_array().expect("a list");
    let names: Vec<_> = joints.iter().map(|joint| joint["name"].as_str()).collect();
    assert_eq!(names, ["joint_0", "knee", "knee#2", "joint_3"].map(Some));
    assert!(dofs("named").iter().any(|dof| dof["name"] == "knee#2.rx"));
}

#[test]
fn every_joint_has_nine_degrees_of_freedom_in_the_promised_order() {
    let mut gltf = triangle();
    gltf.json["nodes"][0]["translation"] = json!([1, 2, 3]);
    gltf.json["nodes"][0]["rotation"] = json!([0, 0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    gltf.json["nodes"][0]["scale"] = json!([1, 2, 0.5]);
    load("nine", &gltf);
    let dofs = dofs("nine");
    let names: Vec<_> = dofs.iter().filter_map(|dof| dof["name"].as_str()).collect();
    let wanted = ["tx", "ty", "tz", "rx", "ry", "rz", "sx", "sy", "sz"];
    assert_eq!(names, wanted.map(|axis| format!("stand.{axis}")));
    let kinds: Vec<_> = dofs.iter().filter_map(|dof| dof["kind"].as_str()).collect();
    let wanted = ["translation", "rotation", "scale"].map(|kind| [kind; 3]);
    assert_eq!(kinds, wanted.as_flattened());
    for dof in &dofs {
        assert_eq!(
            (&dof["min"], &dof["max"]),
            (&Value::Null, &Value::Null),
            "{dof}"
        );
        assert_eq!(
            (&dof["joint"], &dof["rest"]),
            (&json!("stand"), &dof["value"])
        );
    }
    let rest: Vec<f64> = dofs.iter().filter_map(|dof| dof["rest"].as_f64()).collect();
    assert_near(
        &rest,
        &[0.0, 0.0, 0.0, 0.0, 0.0, FRAC_PI_2, 1.0, 2.0, 0.5],
        NEAR,
        "rest",
    );
}

#[test]
fn angles_turn_about_x_first() {
    load("angles", &triangle());
    let (x, y, z) = (0.3_f64, -0.7_f64, 1.1_f64);
    let about = |axis: usize, angle: f64| {
        let mut quaternion = [0.0, 0.0, 0.0, (angle / 2.0).cos()];
        quaternion[axis] = (angle / 2.0).sin();
        quaternion
    };
    // Hamilton's product, `a` after `b`.
    let after = |[ax, ay, az, aw]: Quaternion, [bx, by, bz, bw]: Quaternion| {
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    };
    let wanted = after(about(2, z), after(about(1, y), about(0, x)));
    let pose = json!({"dofs": {"stand.rx": x, "stand.ry": y, "stand.rz": z}});
    let found = linear_part(&joint("angles", "stand", pose));
    assert_near(&found, &rotation_columns(wanted), NEAR, "Rz·Ry·Rx");
}

#[test]
fn scale_reaches_the_children() {
    load("scaled", &arm(Component::U8, Component::F32));
    let pose = json!({"dofs": {"root.sy": 2, "tip.sx": 3}});
    let wanted = [
        3.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0,
    ];
    assert_near(
        &joint("scaled", "tip", pose.clone()),
        &wanted,
        NEAR,
        "the tip",
    );
    // Twice as high; the last one is half on each: (1, 4) and (3, 4).
    let wanted = [0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 2.0, 4.0, 0.0];
    assert_near(&positions("scaled", pose), &wanted, F32, "vertices");
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

#[test]
fn morph_targets_are_named_and_weighted_by_the_file() {
    let of_the_mesh = json!([0.5, 0.25]);
    let of_the_node = json!([0.0, 1.0]);
    for (what, mesh, node, [up, far]) in [
        ("without weights", Value::Null, Value::Null, [0.0, 0.0]),
        (
            "weights of the mesh",
            of_the_mesh.clone(),
            Value::Null,
            [0.5, 0.25],
        ),
        (
            "weights of the node",
            Value::Null,
            of_the_node.clone(),
            [0.0, 1.0],
        ),
        ("weights of both", of_the_mesh, of_the_node, [0.0, 1.0]),
    ] {
        let mut gltf = morphed();
        for (object, weights) in [("meshes", mesh), ("nodes", node)] {
            if !weights.is_null() {
                gltf.json[object][0]["weights"] = weights;
            }
        }
        let summary = load(what, &gltf);
        assert_eq!(summary["morph_count"], 2, "{what}");
        let morphs: Vec<Value> = dofs(what)
            .into_iter()
            .filter(|dof| dof["kind"] == "morph")
            .collect();
        let names: Vec<_> = morphs
            .iter()
            .filter_map(|dof| dof["name"].as_str())
            .collect();
        assert_eq!(names, ["morph.up", "morph.far"], "{what}");
        let rest: Vec<f64> = morphs
            .iter()
            .filter_map(|dof| dof["rest"].as_f64())
            .collect();
        assert_near(&rest, &[up, far], NEAR, what);
        assert_near(
            &first_corner(what, json!({})),
            &[0.0, up, 10.0 * far],
            F32,
            what,
        );
        let pose = json!({"dofs": {"morph.up": 2, "morph.far": -0.5}});
        assert_near(&first_corner(what, pose), &[0.0, 2.0, -5.0], F32, what);
    }
    let mut gltf = morphed();
    let mesh = gltf.json["meshes"][0].as_object_mut();
    mesh.expect("an object").remove("extras");
    load("nameless targets", &gltf);
    let pose = json!({"dofs": {"morph.morph_0": 1, "morph.morph_1": 1}});
    assert_near(
        &first_corner("nameless targets", pose),
        &[0.0, 1.0, 10.0],
        F32,
        "nameless",
    );
}

#[test]
fn each_node_has_morphs_of_its_own() {
    let mut gltf = morphed();
    gltf.node(json!({"name": "other", "mesh": 0, "weights": [0, 0.5]}));
    gltf.json["scenes"][0]["nodes"] = json!([0, 1]);
    load("morphed twice", &gltf);
    let described = describe("morphed twice");
    let morphs = described["morphs"].as_array().expect("a list");
    let names: Vec<_> = morphs
        .iter()
        .filter_map(|morph| morph["name"].as_str())
        .collect();
    assert_eq!(names, ["up", "far", "up#2", "far#2"]);
    let pose = json!({"dofs": {"morph.up": 1, "morph.up#2": 3}});
    let meshes = vertices("morphed twice", pose);
    assert_near(
        &meshes[0].positions[..3],
        &[0.0, 1.0, 0.0],
        F32,
        "the first",
    );
    assert_near(
        &meshes[1].positions[..3],
        &[0.0, 3.0, 5.0],
        F32,
        "the second",
    );
    for (morph, mesh) in morphs.iter().zip([0, 0, 1, 1]) {
        assert_eq!(morph["mesh"], meshes[mesh].name, "{morph}");
    }
}

/// The triangle with one channel on its node, in the clip `c`.
fn animated(path: &str, times: &[f64], shape: &str, values: &[f64], interpolation: &str) -> Gltf {
    let mut gltf = triangle();
    let (input, output) = (gltf.floats("SCALAR", times), gltf.floats(shape, values));
    gltf.channel(
        "c",
        json!({"node": 0, "path": path}),
        json!({"input": input, "output": output, "interpolation": interpolation}),
    );
    gltf
}

#[test]
fn steps_and_lines_go_from_key_to_key_and_hold_the_ends() {
    let times = [1.0, 2.0, 4.0];
    let values = [1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 3.0, 8.0, 0.0];
    for (interpolation, moments) in [
        (
            "STEP",
            &[
                (0.0, [1.0, 0.0]),
                (1.0, [1.0, 0.0]),
                (1.99, [1.0, 0.0]),
                (2.0, [3.0, 0.0]),
                (3.9, [3.0, 0.0]),
                (4.0, [3.0, 8.0]),
                (9.0, [3.0, 8.0]),
            ][..],
        ),
        (
            "LINEAR",
            &[
                (-5.0, [1.0, 0.0]),
                (1.0, [1.0, 0.0]),
                (1.5, [2.0, 0.0]),
                (2.0, [3.0, 0.0]),
                (3.5, [3.0, 6.0]),
                (4.0, [3.0, 8.0]),
                (9.0, [3.0, 8.0]),
            ],
        ),
    ] {
        load(
            interpolation,
            &animated("translation", &times, "VEC3", &values, interpolation),
        );
        for &(time, [x, y]) in moments {
            let found = place(interpolation, "stand", clip_at("c", time));
            assert_near(
                &found,
                &[x, y, 0.0],
                NEAR,
                &format!("{interpolation} at {time}"),
            );
        }
        let clip = &describe(interpolation)["clips"][0];
        assert_eq!(
            (&clip["name"], &clip["range"]),
            (&json!("c"), &json!([1.0, 4.0]))
        );
    }
    // A scale is animated like a translation; without a word about it, linear.
    let mut gltf = animated(
        "scale",
        &[0.0, 1.0],
        "VEC3",
        &[1.0, 1.0, 1.0, 3.0, 5.0, 7.0],
        "LINEAR",
    );
    let sampler = gltf.json["animations"][0]["samplers"][0].as_object_mut();
    sampler.expect("an object").remove("interpolation");
    load("scale", &gltf);
    let found = linear_part(&joint("scale", "stand", clip_at("c", 0.5)));
    assert_near(
        &found,
        &[2.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 4.0],
        NEAR,
        "scale",
    );
}

#[test]
fn rotations_are_slerped_the_shortest_way() {
    let from = unit([0.1, -0.2, 0.3, 0.9]);
    let to = unit([-0.5, 0.4, 0.6, 0.3]);
    for (what, to) in [("near", to), ("on the other side", to.map(|x| -x))] {
        let gltf = animated(
            "rotation",
            &[0.0, 1.0],
            "VEC4",
            &[from, to].concat(),
            "LINEAR",
        );
        load(what, &gltf);
        for share in [0.25, 0.5, 0.9] {
            let wanted = rotation_columns(slerp(from, to, share));
            let found = linear_part(&joint(what, "stand", clip_at("c", share)));
            assert_near(&found, &wanted, NEAR, &format!("{what} at {share}"));
        }
    }
}

/// Appendix C: values, tangents out of the first key and into the second, the seconds between them.
fn hermite(from: f64, out: f64, to: f64, into: f64, seconds: f64, share: f64) -> f64 {
    let (t, t2, t3) = (share, share * share, share * share * share);
    (2.0 * t3 - 3.0 * t2 + 1.0) * from
        + seconds * (t3 - 2.0 * t2 + t) * out
        + (-2.0 * t3 + 3.0 * t2) * to
        + seconds * (t3 - t2) * into
}

#[test]
fn cubic_splines_scale_their_tangents_by_the_time_between_keys() {
    let times = [1.0, 3.0];
    // In-tangent, value, out-tangent of each key.
    let values = [
        [9.0, 9.0, 9.0],
        [0.0, 1.0, 2.0],
        [1.0, -2.0, 0.5],
        [3.0, 0.0, -1.0],
        [4.0, 5.0, 6.0],
        [9.0, 9.0, 9.0],
    ];
    load(
        "spline",
        &animated(
            "translation",
            &times,
            "VEC3",
            values.as_flattened(),
            "CUBICSPLINE",
        ),
    );
    for share in [0.0, 0.25, 0.5, 0.8, 1.0] {
        let wanted: [f64; 3] = std::array::from_fn(|i| {
            hermite(
                values[1][i],
                values[2][i],
                values[4][i],
                values[3][i],
                2.0,
                share,
            )
        });
        let found = place("spline", "stand", clip_at("c", 1.0 + 2.0 * share));
        assert_near(&found, &wanted, NEAR, &format!("at {share}"));
    }
    for (time, key) in [(0.0, 1), (7.0, 4)] {
        let found = place("spline", "stand", clip_at("c", time));
        assert_near(&found, &values[key], NEAR, "held at the ends");
    }

    let (from, to) = (unit([0.1, -0.2, 0.3, 0.9]), unit([0.4, 0.1, 0.2, 0.8]));
    let (out, into) = ([0.3, -0.1, 0.2, 0.0], [-0.2, 0.5, 0.1, 0.1]);
    let turns = [[0.0; 4], from, out, into, to, [0.0; 4]];
    load(
        "turning spline",
        &animated(
            "rotation",
            &times,
            "VEC4",
            turns.as_flattened(),
            "CUBICSPLINE",
        ),
    );
    for share in [0.25, 0.5, 0.8] {
        let wanted = unit(std::array::from_fn(|i| {
            hermite(from[i], out[i], to[i], into[i], 2.0, share)
        }));
        let found = linear_part(&joint(
            "turning spline",
            "stand",
            clip_at("c", 1.0 + 2.0 * share),
        ));
        assert_near(
            &found,
            &rotation_columns(wanted),
            NEAR,
            &format!("turned at {share}"),
        );
    }
}

#[test]
fn weights_are_animated_all_at_once() {
    for (what, interpolation, values, wanted) in [
        (
            "linear weights",
            "LINEAR",
            &[0.0, 1.0, 1.0, 0.5][..],
            [0.25, 0.875],
        ),
        ("stepped weights", "STEP", &[0.0, 1.0, 1.0, 0.5], [0.0, 1.0]),
        (
            // All tangents are 0 but the one out of the first weight.
            "splined weights",
            "CUBICSPLINE",
            &[0.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0],
            [
                hermite(0.0, 4.0, 1.0, 0.0, 2.0, 0.25),
                hermite(1.0, 0.0, 0.5, 0.0, 2.0, 0.25),
            ],
        ),
    ] {
        let mut gltf = morphed();
        let (input, output) = (
            gltf.floats("SCALAR", &[0.0, 2.0]),
            gltf.floats("SCALAR", values),
        );
        let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
        gltf.channel("c", json!({"node": 0, "path": "weights"}), sampler);
        load(what, &gltf);
        let found = first_corner(what, clip_at("c", 0.5));
        assert_near(&found, &[0.0, wanted[0], 10.0 * wanted[1]], F32, what);
    }
}

#[test]
fn keys_may_be_normalized_integers() {
    for (component, one, tolerance) in [
        (Component::I16, 32_767.0, 1e-4),
        (Component::U16, 65_535.0, 1e-4),
        (Component::I8, 127.0, 0.02),
        (Component::U8, 255.0, 0.02),
    ] {
        let name = format!("{component:?} keys");
        let mut gltf = triangle();
        let turns: Vec<f64> = [turn_z(0.0), turn_z(FRAC_PI_2)]
            .concat()
            .iter()
            .map(|x| (x * one).round())
            .collect();
        let (input, output) = (
            gltf.floats("SCALAR", &[0.0, 1.0]),
            gltf.normalized(component, "VEC4", &turns),
        );
        gltf.channel(
            "c",
            json!({"node": 0, "path": "rotation"}),
            json!({"input": input, "output": output}),
        );
        load(&name, &gltf);
        let found = linear_part(&joint(&name, "stand", clip_at("c", 0.5)));
        assert_near(
            &found,
            &rotation_columns(turn_z(FRAC_PI_4)),
            tolerance,
            &name,
        );
    }
}

/// Clips `a` and `b`, each standing still: `a` at x = 2 without rotation, `b` at y = 4 and a quarter about z.
fn two_clips() -> Gltf {
    let mut gltf = triangle();
    for (clip, place, turn) in [
        ("a", [2.0, 0.0, 0.0], turn_z(0.0)),
        ("b", [0.0, 4.0, 0.0], turn_z(FRAC_PI_2)),
    ] {
        let input = gltf.floats("SCALAR", &[0.0]);
        let (places, turns) = (gltf.floats("VEC3", &place), gltf.floats("VEC4", &turn));
        for (path, output) in [("translation", places), ("rotation", turns)] {
            gltf.channel(
                clip,
                json!({"node": 0, "path": path}),
                json!({"input": input, "output": output}),
            );
        }
    }
    gltf
}

#[test]
fn clips_are_blended_by_their_weights() {
    load("blended", &two_clips());
    let part = |name: &str, weight: f64| json!({"name": name, "time": 0, "weight": weight});
    for (clips, wanted, angle) in [
        (json!([part("a", 1.0)]), [2.0, 0.0], 0.0),
        (
            json!([part("a", 0.5), part("b", 0.5)]),
            [1.0, 2.0],
            FRAC_PI_4,
        ),
        // The base pose, at the origin without rotation, makes up the rest.
        (json!([part("b", 0.5)]), [0.0, 2.0], FRAC_PI_4),
        (json!([part("a", 0.25), part("b", 0.0)]), [0.5, 0.0], 0.0),
        (json!([]), [0.0, 0.0], 0.0),
        // More than all is all.
        (json!([part("b", 3.0)]), [0.0, 4.0], FRAC_PI_2),
        (
            json!([part("a", 2.0), part("b", 2.0)]),
            [1.0, 2.0],
            FRAC_PI_4,
        ),
    ] {
        let found = joint("blended", "stand", json!({ "clips": clips }));
        let what = clips.to_string();
        assert_near(&found[12..15], &[wanted[0], wanted[1], 0.0], NEAR, &what);
        assert_near(
            &linear_part(&found),
            &rotation_columns(turn_z(angle)),
            NEAR,
            &what,
        );
    }
    // Of translations this holds for uneven weights as well.
    let uneven = joint(
        "blended",
        "stand",
        json!({"clips": [part("a", 3.0), part("b", 1.0)]}),
    );
    assert_near(&uneven[12..15], &[1.5, 1.0, 0.0], NEAR, "uneven");
}

#[test]
fn blends_that_make_no_sense_are_refused() {
    load("refused", &two_clips());
    let part = |weight: f64| json!({"name": "a", "time": 0, "weight": weight});
    for pose in [
        json!({"clip": {"name": "a", "time": 0}, "clips": [part(1.0)]}),
        json!({"clips": [part(-1.0)]}),
        json!({"clips": [{"name": "nobody", "time": 0, "weight": 1}]}),
        json!({"clips": [{"name": "a", "weight": 1}]}),
        json!({"clips": {}}),
    ] {
        let params = json!({"rig": "refused", "pose": pose});
        assert_eq!(
            ask_kind(&SERVICE, "joint.transforms", params),
            "invalid_params",
            "{pose}"
        );
    }
}

/// Before the second key of two at one time the curve goes to the first of them, from then on it leaves the second.
#[test]
fn a_curve_jumps_where_two_keys_are_at_one_time() {
    let values = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 6.0, 0.0, 0.0, 8.0, 0.0, 0.0];
    let gltf = animated(
        "translation",
        &[0.0, 1.0, 1.0, 2.0],
        "VEC3",
        &values,
        "LINEAR",
    );
    let summary = load("jump", &gltf);
    assert!(warnings(&summary)[0].contains("1 keys at the time of the one before"));
    assert_eq!(describe("jump")["clips"][0]["range"], json!([0.0, 2.0]));
    for (time, x) in [(0.5, 1.0), (0.999, 1.998), (1.0, 6.0), (1.5, 7.0)] {
        let at = place("jump", "stand", clip_at("c", time));
        assert_near(&at, &[x, 0.0, 0.0], NEAR, &time.to_string());
    }
}

#[test]
fn of_two_channels_on_one_target_the_first_counts() {
    let mut gltf = animated("translation", &[0.0], "VEC3", &[1.0, 2.0, 3.0], "STEP");
    let target = gltf.json["animations"][0]["channels"][0]["target"].clone();
    let [input, output] = [&[0.0][..], &[7.0; 3]].map(|it| it.to_vec());
    let input = gltf.floats("SCALAR", &input);
    let output = gltf.floats("VEC3", &output);
    gltf.channel("c", target, json!({"input": input, "output": output}));
    let summary = load("contested", &gltf);
    assert!(warnings(&summary)[0].contains("channels[1] has the target of channels[0]"));
    let at = place("contested", "stand", clip_at("c", 0.0));
    assert_near(&at, &[1.0, 2.0, 3.0], NEAR, "the first channel");
}

#[test]
fn a_key_of_no_rotation_is_none() {
    for interpolation in ["STEP", "LINEAR"] {
        let gltf = animated("rotation", &[0.0, 1.0], "VEC4", &[0.0; 8], interpolation);
        let name = format!("no turn, {interpolation}");
        let summary = load(&name, &gltf);
        assert!(warnings(&summary)[0].contains("2 rotations that are no unit quaternions"));
        let at = joint(&name, "stand", clip_at("c", 0.5));
        assert_near(
            &linear_part(&at),
            &rotation_columns([0.0, 0.0, 0.0, 1.0]),
            NEAR,
            interpolation,
        );
    }
}

#[test]
fn a_channel_that_moves_nothing_is_passed_over() {
    let mut gltf = animated("translation", &[0.0], "VEC3", &[1.0, 2.0, 3.0], "STEP");
    let sampler = gltf.json["animations"][0]["samplers"][0].clone();
    gltf.channel("c", json!({"path": "translation"}), sampler);
    load("aimless", &gltf);
    assert_near(
        &place("aimless", "stand", clip_at("c", 0.0)),
        &[1.0, 2.0, 3.0],
        NEAR,
        "the other channel",
    );
}

#[test]
fn what_is_drawn_is_the_default_scene() {
    let mut gltf = Gltf::default();
    for x in 0..3 {
        let mesh = triangle_mesh(&mut gltf, &CORNERS);
        gltf.node(json!({"name": format!("n{x}"), "mesh": mesh, "translation": [x, 0, 0]}));
    }
    gltf.scene(&[2]);
    gltf.scene(&[0, 1]);
    for (what, scene, wanted) in [
        ("several roots", json!(1), &[0.0, 1.0][..]),
        ("the other scene", json!(0), &[2.0]),
        // Nobody said which: the first.
        ("no default scene", Value::Null, &[2.0]),
    ] {
        let mut gltf = gltf.clone();
        if scene.is_null() {
            gltf.json
                .as_object_mut()
                .expect("an object")
                .remove("scene");
        } else {
            gltf.json["scene"] = scene;
        }
        load(what, &gltf);
        let found: Vec<f64> = vertices(what, json!({}))
            .iter()
            .map(|mesh| mesh.positions[0])
            .collect();
        assert_near(&found, wanted, F32, what);
    }
    let members = gltf.json.as_object_mut().expect("an object");
    members.remove("scene");
    members.remove("scenes");
    load("without scenes", &gltf);
    assert_eq!(vertices("without scenes", json!({})).len(), 3);
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

/// A dull surface of this color and these other members.
fn colored(factor: [f64; 4], members: Value) -> Value {
    let surface = json!({"baseColorFactor": factor, "metallicFactor": 0.0, "roughnessFactor": 1.0});
    over(json!({ "pbrMetallicRoughness": surface }), members)
}

#[test]
fn a_material_is_seen_in_its_color() {
    let dark = json!({"ambient": [0, 0, 0]});
    let behind =
        json!({"camera": {"kind": "look_at", "eye": [0, 0, -5], "target": [0, 0, 0], "height": 2}});
    let unlit = json!({"extensions": {"KHR_materials_unlit": {}}});
    let orange = [1.0, 0.5, 0.25];
    let [clear, solid, half] = [0.25, 1.0, 0.5].map(|alpha| [1.0, 0.5, 0.25, alpha]);
    let (background, black) = ([0.0, 0.0, 1.0], [0.0; 3]);
    for (what, material, changes, wanted) in [
        ("a factor", colored(solid, json!({})), json!({}), orange),
        (
            "in the dark",
            colored(solid, json!({})),
            dark.clone(),
            black,
        ),
        (
            "unlit in the dark",
            colored(solid, unlit.clone()),
            dark.clone(),
            orange,
        ),
        (
            "unlit in light",
            colored(solid, unlit),
            json!({"ambient": [0.5, 0.5, 0.5]}),
            orange,
        ),
        (
            "glowing in the dark",
            colored(solid, json!({"emissiveFactor": [0.25, 0, 0.5]})),
            dark,
            [0.25, 0.0, 0.5],
        ),
        (
            "glowing in light",
            colored(
                [0.5, 0.25, 0.25, 1.0],
                json!({"emissiveFactor": [0.25, 0, 0.5]}),
            ),
            json!({}),
            [0.75, 0.25, 0.75],
        ),
        (
            "opaque whatever its alpha",
            colored(clear, json!({})),
            json!({}),
            orange,
        ),
        (
            "below the cutoff",
            colored(clear, json!({"alphaMode": "MASK", "alphaCutoff": 0.3})),
            json!({}),
            background,
        ),
        (
            "above the cutoff",
            colored(clear, json!({"alphaMode": "MASK", "alphaCutoff": 0.2})),
            json!({}),
            orange,
        ),
        (
            "below the cutoff of a half",
            colored(clear, json!({"alphaMode": "MASK"})),
            json!({}),
            background,
        ),
        (
            "blended over",
            colored(half, json!({"alphaMode": "BLEND"})),
            json!({}),
            [0.5, 0.25, 0.625],
        ),
        (
            "single-sided from behind",
            colored(solid, json!({})),
            behind.clone(),
            background,
        ),
        (
            "double-sided from behind",
            colored(solid, json!({"doubleSided": true})),
            behind,
            orange,
        ),
        (
            "by specular and glossiness",
            json!({"extensions": {"KHR_materials_pbrSpecularGlossiness":
                {"diffuseFactor": solid, "specularFactor": [0, 0, 0], "glossinessFactor": 0}}}),
            json!({}),
            orange,
        ),
    ] {
        let mut gltf = wall(material, [0.5, 0.5]);
        let used = gltf.json["extensionsUsed"].as_array_mut();
        used.expect("a list")
            .push(json!("KHR_materials_pbrSpecularGlossiness"));
        load(what, &gltf);
        assert_seen(what, changes, wanted);
    }
}

#[test]
fn a_color_of_vertices_multiplies_that_of_the_material() {
    for (what, component, shape, color) in [
        ("float", Component::F32, "VEC3", &[0.5, 1.0, 0.25][..]),
        (
            "float with alpha",
            Component::F32,
            "VEC4",
            &[0.5, 1.0, 0.25, 1.0],
        ),
        (
            "8 bits",
            Component::U8,
            "VEC4",
            &[127.5, 255.0, 63.75, 255.0],
        ),
        (
            "8 bits of three",
            Component::U8,
            "VEC3",
            &[127.5, 255.0, 63.75],
        ),
        (
            "16 bits",
            Component::U16,
            "VEC4",
            &[32_767.5, 65_535.0, 16_383.75, 65_535.0],
        ),
    ] {
        let name = format!("vertex color, {what}");
        let mut gltf = wall(colored([0.5, 0.5, 1.0, 1.0], json!({})), [0.5, 0.5]);
        let colors = color.repeat(4);
        let colors = match component {
            Component::F32 => gltf.floats(shape, &colors),
            _ => gltf.normalized(component, shape, &colors),
        };
        gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
        load(&name, &gltf);
        assert_seen(&name, json!({}), [0.25, 0.5, 0.25]);
    }
}

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const GREEN: [f64; 3] = [0.0, 1.0, 0.0];
const BLUE: [f64; 3] = [0.0, 0.0, 1.0];

/// 8x8 texels: along an axis, four red ones, three green ones and a blue one.
fn stripes(is_across: bool) -> Vec<u8> {
    let picture = image::RgbImage::from_fn(8, 8, |x, y| {
        let along = if is_across { x } else { y };
        image::Rgb(
            [RED, RED, RED, RED, GREEN, GREEN, GREEN, BLUE][along as usize]
                .map(|x| (255.0 * x) as u8),
        )
    });
    let mut file = Cursor::new(Vec::new());
    picture
        .write_to(&mut file, image::ImageFormat::Png)
        .expect("a picture");
    file.into_inner()
}

/// The wall with the stripes on it, drawn at one texture coordinate.
fn striped(is_across: bool, texcoord: [f64; 2], sampler: Value, transform: Value) -> Gltf {
    let mut texture = json!({"index": 0});
    if !transform.is_null() {
        texture["extensions"] = json!({ "KHR_texture_transform": transform });
    }
    let material =
        json!({"pbrMetallicRoughness": {"baseColorTexture": texture, "metallicFactor": 0.0}});
    let mut gltf = wall(material, texcoord);
    let view = gltf.view(&stripes(is_across));
    gltf.push(
        "images",
        json!({"bufferView": view, "mimeType": "image/png"}),
    );
    gltf.push("samplers", sampler);
    gltf.push("textures", json!({"source": 0, "sampler": 0}));
    gltf
}

#[test]
fn a_texture_lies_as_the_file_says() {
    let (clamp, mirror, repeat) = (33_071, 33_648, 10_497);
    let wrap = |s: u64, t: u64| json!({"wrapS": s, "wrapT": t});
    let plain = || wrap(repeat, repeat);
    let none = Value::Null;
    for (what, is_across, texcoord, sampler, transform, wanted) in [
        // The first row is the top one, and v is 0 there.
        ("at the top", false, [0.5, 0.25], plain(), none.clone(), RED),
        (
            "at the bottom",
            false,
            [0.5, 0.75],
            plain(),
            none.clone(),
            GREEN,
        ),
        ("at the left", true, [0.25, 0.5], plain(), none.clone(), RED),
        (
            "at the right",
            true,
            [0.75, 0.5],
            plain(),
            none.clone(),
            GREEN,
        ),
        ("repeated", true, [1.25, 0.5], plain(), none.clone(), RED),
        (
            "repeated without a word",
            true,
            [1.25, 0.5],
            json!({}),
            none.clone(),
            RED,
        ),
        (
            "mirrored",
            true,
            [1.25, 0.5],
            wrap(mirror, repeat),
            none.clone(),
            GREEN,
        ),
        (
            "clamped",
            true,
            [1.25, 0.5],
            wrap(clamp, repeat),
            none.clone(),
            BLUE,
        ),
        (
            "repeated down",
            false,
            [0.5, 1.25],
            wrap(clamp, repeat),
            none.clone(),
            RED,
        ),
        (
            "mirrored down",
            false,
            [0.5, 1.25],
            wrap(clamp, mirror),
            none.clone(),
            GREEN,
        ),
        (
            "clamped down",
            false,
            [0.5, 1.25],
            wrap(repeat, clamp),
            none.clone(),
            BLUE,
        ),
        (
            "shifted",
            true,
            [0.125, 0.5],
            plain(),
            json!({"offset": [0.5, 0]}),
            GREEN,
        ),
        (
            "shifted down",
            false,
            [0.5, 0.125],
            plain(),
            json!({"offset": [0, 0.5]}),
            GREEN,
        ),
        (
            "stretched",
            true,
            [0.25, 0.5],
            plain(),
            json!({"scale": [3, 1]}),
            GREEN,
        ),
        // A quarter against the clock, in which v points down: u becomes v.
        (
            "turned",
            true,
            [0.0, 0.75],
            plain(),
            json!({"rotation": FRAC_PI_2}),
            GREEN,
        ),
        (
            // Scaled to (0.25, 0.375), turned to u = 0.375, shifted to 0.625.
            "all three",
            true,
            [0.25, 0.75],
            plain(),
            json!({"scale": [1, 0.5], "rotation": FRAC_PI_2, "offset": [0.25, 0]}),
            GREEN,
        ),
    ] {
        let name = format!("stripes {what}");
        let summary = load(&name, &striped(is_across, texcoord, sampler, transform));
        assert_eq!(warnings(&summary), [""; 0], "{name}");
        assert_seen(&name, json!({"background": [0, 0, 0, 1]}), wanted);
    }
}

#[test]
fn a_picture_comes_from_wherever_it_is() {
    use base64::Engine as _;
    let picture = stripes(true);
    let uri = base64::engine::general_purpose::STANDARD.encode(&picture);
    for (what, uri, beside) in [
        ("in the text", format!("data:image/png;base64,{uri}"), None),
        ("beside", "stripes.png".to_owned(), Some("stripes.png")),
        (
            "beside with a space",
            "my%20stripes.png".to_owned(),
            Some("my stripes.png"),
        ),
    ] {
        let name = format!("picture {what}");
        let mut gltf = striped(true, [0.75, 0.5], json!({}), Value::Null);
        gltf.json["images"] = json!([{ "uri": uri }]);
        // A factor multiplies the texture.
        gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
            json!([1, 0.5, 1, 1]);
        let mut files = gltf.files();
        if let Some(beside) = beside {
            files
                .as_array_mut()
                .expect("a list")
                .push(with_base64(beside, &picture));
        }
        let summary = load_files(&name, files);
        assert_eq!(warnings(&summary), [""; 0], "{name}");
        assert_seen(&name, json!({}), [0.0, 0.5, 0.0]);
    }
    // In a binary file it lies in the chunk.
    let gltf = striped(true, [0.75, 0.5], json!({}), Value::Null);
    load_files(
        "picture in a chunk",
        json!([with_base64("x.glb", &gltf.glb())]),
    );
    assert_seen("picture in a chunk", json!({}), GREEN);
}
