//! Attributes and indices of primitives.

use super::{accessor, assert_all_refused, assert_no_harm, primitive, remove};
use crate::support::everything::{INDICES, JOINTS, POSITIONS, TEXCOORDS, TIMES, WEIGHTS, good};
use serde_json::json;

#[test]
fn attributes_of_the_wrong_kind_are_refused() {
    assert_all_refused(&[
        (
            "positions of two",
            |it| accessor(it, POSITIONS)["type"] = json!("VEC2"),
            "meshes[0].primitives[0].attributes.POSITION -> accessors[0]: VEC3 of numbers",
        ),
        (
            "positions of a word",
            |it| accessor(it, POSITIONS)["type"] = json!("VEC5"),
            "VEC5",
        ),
        (
            "positions of whole numbers",
            |it| accessor(it, POSITIONS)["componentType"] = json!(5125),
            "meshes[0].primitives[0].attributes.POSITION -> accessors[0]: VEC3 of numbers",
        ),
        (
            "components of nothing",
            |it| accessor(it, POSITIONS)["componentType"] = json!(5127),
            "5127",
        ),
        (
            "joints of floats",
            |it| primitive(it)["attributes"]["JOINTS_0"] = json!(WEIGHTS),
            "meshes[0].primitives[0].attributes.JOINTS_0 -> accessors[4]: VEC4 of U8 or U16",
        ),
        (
            "weights of bare bytes",
            |it| primitive(it)["attributes"]["WEIGHTS_0"] = json!(JOINTS),
            "meshes[0].primitives[0].attributes.WEIGHTS_0 -> accessors[3]: VEC4 of F32, or of normalized U8 or U16",
        ),
        (
            "weights of three",
            |it| primitive(it)["attributes"]["WEIGHTS_0"] = json!(POSITIONS),
            "meshes[0].primitives[0].attributes.WEIGHTS_0 -> accessors[0]: VEC4 of F32, or of normalized U8 or U16",
        ),
        (
            "texture coordinates of three",
            |it| primitive(it)["attributes"]["TEXCOORD_0"] = json!(POSITIONS),
            "meshes[0].primitives[0].attributes.TEXCOORD_0 -> accessors[0]: VEC2 of numbers",
        ),
        (
            "normals of two",
            |it| primitive(it)["attributes"]["NORMAL"] = json!(TEXCOORDS),
            "meshes[0].primitives[0].attributes.NORMAL -> accessors[2]: VEC3 of numbers",
        ),
        (
            "indices of floats",
            |it| primitive(it)["indices"] = json!(TIMES),
            "meshes[0].primitives[0].indices -> accessors[8]: SCALAR of U8, U16 or U32",
        ),
        (
            "indices of signed numbers",
            |it| accessor(it, INDICES)["componentType"] = json!(5122),
            "meshes[0].primitives[0].indices -> accessors[5]: SCALAR of U8, U16 or U32",
        ),
        (
            "indices of vectors",
            |it| primitive(it)["indices"] = json!(JOINTS),
            "meshes[0].primitives[0].indices -> accessors[3]: SCALAR of U8, U16 or U32",
        ),
        (
            "a mode of nobody",
            |it| primitive(it)["mode"] = json!(7),
            "7",
        ),
        (
            "fewer normals than positions",
            |it| accessor(it, 1)["count"] = json!(2),
            "meshes[0].primitives[0].attributes.NORMAL: 3 elements, as many as there are positions",
        ),
        (
            "joints without weights",
            |it| remove(&mut primitive(it)["attributes"], "WEIGHTS_0"),
            "meshes[0].primitives[0].attributes: a WEIGHTS_0 beside JOINTS_0",
        ),
        (
            "weights without joints",
            |it| remove(&mut primitive(it)["attributes"], "JOINTS_0"),
            "meshes[0].primitives[0].attributes: a JOINTS_0 beside WEIGHTS_0",
        ),
        (
            "positions of NaN",
            |it| it.set_float(POSITIONS, 4, f32::NAN),
            "accessors[0], element 1: a finite number",
        ),
        (
            "positions of infinity",
            |it| it.set_float(POSITIONS, 4, f32::INFINITY),
            "accessors[0], element 1: a finite number",
        ),
        (
            "weights of NaN",
            |it| it.set_float(WEIGHTS, 1, f32::NAN),
            "accessors[4], element 0: a finite number",
        ),
        (
            "no such material",
            |it| primitive(it)["material"] = json!(77),
            "77",
        ),
        (
            "one index past the vertices",
            |it| {
                let at = it.start_of(INDICES) + 2;
                it.bytes[at] = 255;
            },
            "255",
        ),
        (
            "all indices past the vertices",
            |it| {
                let at = it.start_of(INDICES);
                it.bytes[at..at + 6].fill(0x55);
            },
            "21845",
        ),
    ]);
}

#[test]
fn colors_out_of_range_do_no_harm() {
    for factor in [
        json!([2, 2, 2, 2]),
        json!([-1, 0, 0, 1]),
        json!([1, 1]),
        json!("red"),
        json!([1e300, 0, 0, 1]),
    ] {
        let mut gltf = good();
        gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = factor.clone();
        assert_no_harm(&format!("a color of {factor}"), gltf.files());
    }
}
