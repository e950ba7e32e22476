//! Nodes: transforms, degrees of freedom, names, scenes.

use crate::support::ask_ok;
use crate::support::gltf::{Component, Gltf};
use crate::{
    CORNERS, F32, NEAR, Quaternion, SERVICE, arm, assert_near, clip_at, describe, dofs, joint,
    linear_part, load, numbers, place, positions, rotation_columns, triangle, triangle_mesh,
    vertices, warnings,
};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

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
