//! Accessors: strides, sparse elements, quantization.

use crate::support::ask_ok;
use crate::support::gltf::Component;
use crate::{
    CORNERS, F32, SERVICE, TOWARDS_Z, assert_near, load, numbers, positions, triangle, vertices,
    warnings,
};
use serde_json::json;

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
