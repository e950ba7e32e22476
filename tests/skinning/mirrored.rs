//! Which way do normals point where a joint turns left into right? Never lives here: lengths and directions, which the oracle sees to.

use crate::support::gltf::{Component, Gltf};
use crate::support::{ask_ok, case, service};
use serde_json::{Value, json};

fn vectors(array: &Value) -> Vec<[f64; 3]> {
    let numbers: Vec<f64> = serde_json::from_value(array["data"].clone()).expect("numbers");
    let (vectors, rest) = numbers.as_chunks();
    assert!(rest.is_empty());
    vectors.to_vec()
}

/// An octahedron about the origin, all of it bound to joint 0 above y = 0, to joint 1 below it, and to both around its waist.
fn octahedron(scales: [[f64; 3]; 2]) -> Gltf {
    let mut gltf = Gltf::default();
    let corners: [[f64; 3]; 6] = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let corners = corners.as_flattened();
    let triangles = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ]
    .map(|corners: [u32; 3]| corners.map(f64::from));
    let both = [0.5, 0.5, 0.0, 0.0];
    let (upper, lower) = ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]);
    let weights = [both, both, upper, lower, both, both];
    let position = gltf.floats("VEC3", corners);
    let normal = gltf.floats("VEC3", corners);
    let joints = gltf.accessor(Component::U8, "VEC4", &[0.0, 1.0, 0.0, 0.0].repeat(6));
    let weights = gltf.floats("VEC4", weights.as_flattened());
    let indices = gltf.accessor(Component::U16, "SCALAR", triangles.as_flattened());
    let attributes =
        json!({"POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights});
    gltf.push(
        "meshes",
        json!({"primitives": [{"attributes": attributes, "indices": indices}]}),
    );
    gltf.push("skins", json!({"joints": [0, 1]}));
    for scale in scales {
        gltf.push("nodes", json!({"scale": scale}));
    }
    gltf.push("nodes", json!({"mesh": 0, "skin": 0}));
    gltf
}

#[test]
fn normals_of_mirrored_vertices_point_outward() {
    let service = service();
    let mirrors = [-1.0, 1.0, 1.0];
    let (inside_out, upright) = ([-2.0, -0.5, -1.0], [1.0, 1.0, 1.0]);
    for (name, scales) in [
        ("not mirrored", [upright, upright]),
        ("all mirrored", [mirrors, mirrors]),
        // The waist comes to scale 0.25 along y: where joints mirror along the same axes, their mean does as well.
        (
            "both mirrored, differently far",
            [mirrors, [-3.0, 1.0, 2.0]],
        ),
        ("inside out", [inside_out, inside_out]),
        // The waist is flattened, its normals stay as modelled or are turned: they have no outside.
        ("one half mirrored", [mirrors, upright]),
    ] {
        let files = octahedron(scales).files();
        ask_ok(&service, "rig.load", json!({"name": name, "files": files}));
        for skinning in ["linear", "dual_quaternion"] {
            let params = json!({"rig": name, "skinning": skinning});
            let found = ask_ok(&service, "mesh.vertices", params);
            let mesh = &found["meshes"][0];
            let pairs = vectors(&mesh["positions"])
                .into_iter()
                .zip(vectors(&mesh["normals"]));
            for (vertex, (position, normal)) in pairs.enumerate() {
                if name == "one half mirrored" && ![2, 3].contains(&vertex) {
                    continue;
                }
                let outward: f64 = position.iter().zip(normal).map(|(p, n)| p * n).sum();
                assert!(
                    outward > 0.1,
                    "{name} {skinning} {vertex}: {position:?} {normal:?}"
                );
            }
        }
    }
    // A part of a mesh is the part of the whole, and as modelled nothing is mirrored.
    let normals = |params: Value| {
        let mut request = json!({"rig": "all mirrored", "mesh": "mesh_0"});
        request
            .as_object_mut()
            .expect("an object")
            .extend(params.as_object().expect("fields").clone());
        vectors(&ask_ok(&service, "mesh.vertices", request)["meshes"][0]["normals"])
    };
    let whole = normals(json!({}));
    assert_eq!(
        normals(json!({"range": {"start": 1, "count": 3}})),
        whole[1..4]
    );
    assert_eq!(normals(json!({"state": "bind"}))[0], [1.0, 0.0, 0.0]);
    assert_eq!(whole[0], [-1.0, 0.0, 0.0]);
}

#[test]
fn a_mirrored_triangle_faces_the_same_way() {
    let service = service();
    let files = json!([case("gltf/mirrored_node_normals.gltf")]);
    ask_ok(
        &service,
        "rig.load",
        json!({"name": "mirrored", "files": files}),
    );
    let found = ask_ok(&service, "mesh.vertices", json!({"rig": "mirrored"}));
    assert_eq!(
        vectors(&found["meshes"][0]["normals"]),
        [[0.0, 0.0, 1.0]; 3]
    );
    let batch = json!({"rig": "mirrored", "poses": [{}, {"dofs": {"joint_0.sx": 1.0}}], "attributes": ["normals"]});
    let found = ask_ok(&service, "mesh.batch", batch);
    for item in found["items"].as_array().expect("items") {
        assert_eq!(vectors(&item["meshes"][0]["normals"]), [[0.0, 0.0, 1.0]; 3]);
    }
}
