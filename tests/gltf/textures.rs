//! Textures: how they lie, and where pictures come from.

use crate::support::gltf::Gltf;
use crate::support::with_base64;
use crate::{assert_seen, load, load_files, wall, warnings};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;
use std::io::Cursor;

const RED: [f64; 3] = [1.0, 0.0, 0.0];

const GREEN: [f64; 3] = [0.0, 1.0, 0.0];

const BLUE: [f64; 3] = [0.0, 0.0, 1.0];

/// 8x8 texels: along an axis, four red ones, three green ones and a blue one.
fn stripes(is_across: bool) -> Vec<u8> {
    let picture = image::RgbImage::from_fn(8, 8, |x, y| {
        let along = if is_across { x } else { y };
        image::Rgb(
            [RED, RED, RED, RED, GREEN, GREEN, GREEN, BLUE][along as usize]
                .map(|x| (255.0 * x) as u8),
        )
    });
    let mut file = Cursor::new(Vec::new());
    picture
        .write_to(&mut file, image::ImageFormat::Png)
        .expect("a picture");
    file.into_inner()
}

/// The wall with the stripes on it, drawn at one texture coordinate.
fn striped(is_across: bool, texcoord: [f64; 2], sampler: Value, transform: Value) -> Gltf {
    let mut texture = json!({"index": 0});
    if !transform.is_null() {
        texture["extensions"] = json!({ "KHR_texture_transform": transform });
    }
    let material =
        json!({"pbrMetallicRoughness": {"baseColorTexture": texture, "metallicFactor": 0.0}});
    let mut gltf = wall(material, texcoord);
    let view = gltf.view(&stripes(is_across));
    gltf.push(
        "images",
        json!({"bufferView": view, "mimeType": "image/png"}),
    );
    gltf.push("samplers", sampler);
    gltf.push("textures", json!({"source": 0, "sampler": 0}));
    gltf
}

#[test]
fn a_texture_lies_as_the_file_says() {
    let (clamp, mirror, repeat) = (33_071, 33_648, 10_497);
    let wrap = |s: u64, t: u64| json!({"wrapS": s, "wrapT": t});
    let plain = || wrap(repeat, repeat);
    let none = Value::Null;
    for (what, is_across, texcoord, sampler, transform, wanted) in [
        // The first row is the top one, and v is 0 there.
        ("at the top", false, [0.5, 0.25], plain(), none.clone(), RED),
        (
            "at the bottom",
            false,
            [0.5, 0.75],
            plain(),
            none.clone(),
            GREEN,
        ),
        ("at the left", true, [0.25, 0.5], plain(), none.clone(), RED),
        (
            "at the right",
            true,
            [0.75, 0.5],
            plain(),
            none.clone(),
            GREEN,
        ),
        ("repeated", true, [1.25, 0.5], plain(), none.clone(), RED),
        (
            "repeated without a word",
            true,
            [1.25, 0.5],
            json!({}),
            none.clone(),
            RED,
        ),
        (
            "mirrored",
            true,
            [1.25, 0.5],
            wrap(mirror, repeat),
            none.clone(),
            GREEN,
        ),
        (
            "clamped",
            true,
            [1.25, 0.5],
            wrap(clamp, repeat),
            none.clone(),
            BLUE,
        ),
        (
            "repeated down",
            false,
            [0.5, 1.25],
            wrap(clamp, repeat),
            none.clone(),
            RED,
        ),
        (
            "mirrored down",
            false,
            [0.5, 1.25],
            wrap(clamp, mirror),
            none.clone(),
            GREEN,
        ),
        (
            "clamped down",
            false,
            [0.5, 1.25],
            wrap(repeat, clamp),
            none.clone(),
            BLUE,
        ),
        (
            "shifted",
            true,
            [0.125, 0.5],
            plain(),
            json!({"offset": [0.5, 0]}),
            GREEN,
        ),
        (
            "shifted down",
            false,
            [0.5, 0.125],
            plain(),
            json!({"offset": [0, 0.5]}),
            GREEN,
        ),
        (
            "stretched",
            true,
            [0.25, 0.5],
            plain(),
            json!({"scale": [3, 1]}),
            GREEN,
        ),
        // A quarter against the clock, in which v points down: u becomes v.
        (
            "turned",
            true,
            [0.0, 0.75],
            plain(),
            json!({"rotation": FRAC_PI_2}),
            GREEN,
        ),
        (
            // Scaled to (0.25, 0.375), turned to u = 0.375, shifted to 0.625.
            "all three",
            true,
            [0.25, 0.75],
            plain(),
            json!({"scale": [1, 0.5], "rotation": FRAC_PI_2, "offset": [0.25, 0]}),
            GREEN,
        ),
    ] {
        let name = format!("stripes {what}");
        let summary = load(&name, &striped(is_across, texcoord, sampler, transform));
        assert_eq!(warnings(&summary), [""; 0], "{name}");
        assert_seen(&name, json!({"background": [0, 0, 0, 1]}), wanted);
    }
}

#[test]
fn a_picture_comes_from_wherever_it_is() {
    use base64::Engine as _;
    let picture = stripes(true);
    let uri = base64::engine::general_purpose::STANDARD.encode(&picture);
    for (what, uri, beside) in [
        ("in the text", format!("data:image/png;base64,{uri}"), None),
        ("beside", "stripes.png".to_owned(), Some("stripes.png")),
        (
            "beside with a space",
            "my%20stripes.png".to_owned(),
            Some("my stripes.png"),
        ),
    ] {
        let name = format!("picture {what}");
        let mut gltf = striped(true, [0.75, 0.5], json!({}), Value::Null);
        gltf.json["images"] = json!([{ "uri": uri }]);
        // A factor multiplies the texture.
        gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
            json!([1, 0.5, 1, 1]);
        let mut files = gltf.files();
        if let Some(beside) = beside {
            files
                .as_array_mut()
                .expect("a list")
                .push(with_base64(beside, &picture));
        }
        let summary = load_files(&name, files);
        assert_eq!(warnings(&summary), [""; 0], "{name}");
        assert_seen(&name, json!({}), [0.0, 0.5, 0.0]);
    }
    // In a binary file it lies in the chunk.
    let gltf = striped(true, [0.75, 0.5], json!({}), Value::Null);
    load_files(
        "picture in a chunk",
        json!([with_base64("x.glb", &gltf.glb())]),
    );
    assert_seen("picture in a chunk", json!({}), GREEN);
}
