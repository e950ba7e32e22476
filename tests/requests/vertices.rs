//! Meshes: vertices and topology, all or a part of them, in every way to travel.

use crate::support::{self, ask_ok};
use crate::{ARM, FLAG, SERVICE, assert_near, load, merge, numbers, text};
use base64::Engine as _;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// Vertices are float32, of coordinates up to about 10.
const F32: f64 = 1e-5;

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
    support::ask_attached(&SERVICE, method, &params).expect("a result")
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
