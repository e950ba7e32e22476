//! Materials without textures, and colors of vertices.

use crate::support::gltf::Component;
use crate::support::pictures::over;
use crate::{assert_seen, load, wall};
use serde_json::{Value, json};

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
