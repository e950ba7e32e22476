//! Morph targets: names, weights, and which mesh they are of.

use crate::{F32, NEAR, assert_near, describe, dofs, first_corner, load, morphed, vertices};
use serde_json::{Value, json};

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
