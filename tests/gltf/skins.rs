//! Skins: joints, weights, and what has none.

use crate::support::gltf::{Component, Gltf};
use crate::{
    ARM, CORNERS, F32, arm, assert_near, case, load, load_files, positions, triangle,
    triangle_mesh, vertices, warnings,
};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

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
