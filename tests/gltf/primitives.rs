//! Primitives: triangles, what is none, and normals that are missing.

use crate::support::ask_ok;
use crate::support::gltf::{Component, Gltf};
use crate::support::pictures::draw;
use crate::{
    CORNERS, F32, SERVICE, assert_near, case, clip_at, load, load_files, positions, triangle,
    vertices, warnings,
};
use serde_json::json;

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
