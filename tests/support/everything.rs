//! A glTF file with a bit of everything that is read. Never lives here: what breaks it.

use super::gltf::{Component, Gltf};
use serde_json::json;
use std::io::Cursor;

/// Accessors of [`good`].
pub const POSITIONS: usize = 0;
pub const TEXCOORDS: usize = 2;
pub const JOINTS: usize = 3;
pub const WEIGHTS: usize = 4;
pub const INDICES: usize = 5;
pub const TARGET: usize = 6;
pub const BOUND: usize = 7;
pub const TIMES: usize = 8;
pub const TURNS: usize = 9;

pub fn picture() -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    picture
        .write_to(&mut file, image::ImageFormat::Png)
        .expect("a picture");
    file.into_inner()
}

/// A bit of everything: a textured triangle with a morph target on two joints, and an animation of both.
pub fn good() -> Gltf {
    let mut gltf = Gltf::default();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let attributes = json!({
        "POSITION": gltf.floats("VEC3", &corners),
        "NORMAL": gltf.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3)),
        "TEXCOORD_0": gltf.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        "JOINTS_0": gltf.accessor(Component::U8, "VEC4", &[0.0, 1.0, 0.0, 0.0].repeat(3)),
        "WEIGHTS_0": gltf.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(3)),
    });
    let indices = gltf.accessor(Component::U16, "SCALAR", &[0.0, 1.0, 2.0]);
    let target = gltf.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    gltf.push("meshes", json!({"name": "cloth", "weights": [0.25], "primitives": [
        {"attributes": attributes, "indices": indices, "material": 0, "targets": [{"POSITION": target}]},
    ]}));
    let mut bound = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]
    .repeat(2);
    bound[29] = -1.0;
    let bound = gltf.floats("MAT4", &bound);
    gltf.node(json!({"name": "root", "children": [1]}));
    gltf.node(json!({"name": "tip", "translation": [0, 1, 0]}));
    gltf.node(json!({"name": "body", "mesh": 0, "skin": 0}));
    gltf.push(
        "skins",
        json!({"joints": [0, 1], "inverseBindMatrices": bound}),
    );
    let times = gltf.floats("SCALAR", &[0.0, 1.0]);
    let turns = gltf.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.6, 0.8]);
    let shares = gltf.floats("SCALAR", &[0.0, 1.0]);
    for (node, path, output) in [(1, "rotation", turns), (2, "weights", shares)] {
        let sampler = json!({"input": times, "output": output, "interpolation": "LINEAR"});
        gltf.channel("wave", json!({"node": node, "path": path}), sampler);
    }
    let view = gltf.view(&picture());
    gltf.push(
        "images",
        json!({"bufferView": view, "mimeType": "image/png"}),
    );
    gltf.push("samplers", json!({}));
    gltf.push("textures", json!({"source": 0, "sampler": 0}));
    let texture = json!({"baseColorTexture": {"index": 0}});
    gltf.push(
        "materials",
        json!({"name": "red", "pbrMetallicRoughness": texture}),
    );
    gltf.scene(&[0, 2]);
    gltf
}
