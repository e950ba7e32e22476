//! Skins, animations and morph targets that do not fit.

use super::{accessor, assert_all_refused, primitive, sampler};
use crate::support::everything::{
    BOUND, INDICES, JOINTS, POSITIONS, TARGET, TEXCOORDS, TIMES, TURNS, WEIGHTS,
};
use crate::support::gltf::Gltf;
use serde_json::{Value, json};

#[test]
fn skins_that_do_not_fit_are_refused() {
    assert_all_refused(&[
        (
            "a joint past the skin's",
            |it| {
                let at = it.start_of(JOINTS);
                it.bytes[at] = 99;
            },
            "99",
        ),
        (
            "no such joint",
            |it| it.json["skins"][0]["joints"] = json!([0, 77]),
            "77",
        ),
        (
            "no joints",
            |it| it.json["skins"][0]["joints"] = json!([]),
            "skins",
        ),
        (
            "a joint twice",
            |it| it.json["skins"][0]["joints"] = json!([1, 1]),
            "skins",
        ),
        (
            "too few matrices",
            |it| accessor(it, BOUND)["count"] = json!(1),
            "skins[0].inverseBindMatrices: a matrix for each of 2 joints",
        ),
        (
            "no such matrices",
            |it| it.json["skins"][0]["inverseBindMatrices"] = json!(77),
            "77",
        ),
        (
            "matrices of four",
            |it| it.json["skins"][0]["inverseBindMatrices"] = json!(WEIGHTS),
            "skins[0].inverseBindMatrices -> accessors[4]: MAT4 of F32",
        ),
        (
            "a matrix of NaN",
            |it| it.set_float(BOUND, 5, f32::NAN),
            "accessors[7], element 0: a finite number",
        ),
        (
            "a matrix of infinity",
            |it| it.set_float(BOUND, 28, f32::NEG_INFINITY),
            "accessors[7], element 1: a finite number",
        ),
    ]);
}

fn channel(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["animations"][0]["channels"][0]
}

#[test]
fn animations_that_do_not_add_up_are_refused() {
    assert_all_refused(&[
        (
            "fewer values than keys",
            |it| accessor(it, TURNS)["count"] = json!(1),
            "animations[0].samplers[0].output: 2 elements for 2 keys",
        ),
        (
            "fewer keys than values",
            |it| accessor(it, TIMES)["count"] = json!(1),
            "animations[0].samplers[0].output: 1 elements for 1 keys",
        ),
        (
            "a third of a spline",
            |it| sampler(it)["interpolation"] = json!("CUBICSPLINE"),
            "animations[0].samplers[0].output: 6 elements for 2 keys",
        ),
        (
            "keys out of order",
            |it| it.set_float(TIMES, 1, -1.0),
            "animations[0].samplers[0].input, key 1: a time after 0",
        ),
        (
            "a time of NaN",
            |it| it.set_float(TIMES, 1, f32::NAN),
            "accessors[8], element 1: a finite number",
        ),
        (
            "a time of infinity",
            |it| it.set_float(TIMES, 1, f32::INFINITY),
            "accessors[8], element 1: a finite number",
        ),
        (
            "a value of NaN",
            |it| it.set_float(TURNS, 1, f32::NAN),
            "accessors[9], element 0: a finite number",
        ),
        (
            "a value of infinity",
            |it| it.set_float(TURNS, 1, f32::INFINITY),
            "accessors[9], element 0: a finite number",
        ),
        (
            "times of vectors",
            |it| sampler(it)["input"] = json!(POSITIONS),
            "animations[0].samplers[0].input -> accessors[0]: SCALAR of F32",
        ),
        (
            "times of whole numbers",
            |it| sampler(it)["input"] = json!(INDICES),
            "animations[0].samplers[0].input -> accessors[5]: SCALAR of F32",
        ),
        (
            "rotations of three",
            |it| sampler(it)["output"] = json!(POSITIONS),
            "animations[0].samplers[0].output -> accessors[0]: VEC4 of F32, or of normalized integers",
        ),
        ("no such times", |it| sampler(it)["input"] = json!(77), "77"),
        (
            "no such values",
            |it| sampler(it)["output"] = json!(77),
            "77",
        ),
        (
            "no such sampler",
            |it| channel(it)["sampler"] = json!(77),
            "77",
        ),
        (
            "no such target",
            |it| channel(it)["target"]["node"] = json!(77),
            "77",
        ),
    ]);
}

#[test]
fn morph_targets_that_do_not_fit_are_refused() {
    assert_all_refused(&[
        (
            "fewer displacements than vertices",
            |it| accessor(it, TARGET)["count"] = json!(2),
            "meshes[0].primitives[0].targets[0].POSITION: 3 elements, as many as there are positions",
        ),
        (
            "displacements of two",
            |it| primitive(it)["targets"][0]["POSITION"] = json!(TEXCOORDS),
            "meshes[0].primitives[0].targets[0].POSITION -> accessors[2]: VEC3 of numbers",
        ),
        (
            "no such displacements",
            |it| primitive(it)["targets"][0]["POSITION"] = json!(77),
            "77",
        ),
        (
            "a displacement of NaN",
            |it| it.set_float(TARGET, 0, f32::NAN),
            "accessors[6], element 0: a finite number",
        ),
        (
            "more weights than targets",
            |it| it.json["meshes"][0]["weights"] = json!([0, 0]),
            "weights",
        ),
        (
            "more weights of the node",
            |it| it.json["nodes"][2]["weights"] = json!([0, 0]),
            "weights",
        ),
        (
            "primitives that differ in their targets",
            |it| {
                let mut other = primitive(it).clone();
                other["targets"] = json!([]);
                let primitives = it.json["meshes"][0]["primitives"].as_array_mut();
                primitives.expect("a list").push(other);
            },
            "meshes[0]",
        ),
    ]);
}
