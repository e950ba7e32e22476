//! Does a texture lie on a skin as its file says? Pictures made here, of which every texel is known.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::io::Cursor;
use std::sync::{Arc, LazyLock};
use support::pictures::{Image, draw, encoded, over};
use support::{ask_ok, with_base64};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

type Texels = Box<dyn Fn(u32, u32) -> [u8; 3]>;

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const WHITE: [u8; 3] = [255, 255, 255];

fn encoded_picture(side: u32, format: image::ImageFormat, texel: &Texels) -> Vec<u8> {
    let picture = image::RgbImage::from_fn(side, side, |x, y| image::Rgb(texel(x, y)));
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, format).expect("a picture");
    file.into_inner()
}

/// A wall from -1 to 1, texture coordinates from `from` at its lower left to `to` at its upper right.
fn wall(from: [f64; 2], to: [f64; 2]) -> String {
    let ([u, v], [s, t]) = (from, to);
    format!(
        "positions 4 {{ -1 -1 0 1 -1 0 1 1 0 -1 1 0 }} normals 4 {{ 0 0 1 0 0 1 0 0 1 0 0 1 }}
         texcoords 4 {{ {u} {v} {s} {v} {s} {t} {u} {t} }}
         material paint {{ texture wall.png }} triangles 2 {{ 0 1 2 0 2 3 }}"
    )
}

fn load(name: &str, skin: &str, picture: &[u8]) -> Value {
    let skin = json!({"name": format!("{name}.skin"), "text": skin});
    let files = json!([skin, with_base64("wall.png", picture)]);
    ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}))
}

/// Seen straight on, the wall fills the picture; the light is even and white, so that a pixel is its texel.
fn seen(name: &str, pixels: u32, changes: Value) -> Image {
    let request = json!({
        "rig": name, "size": [pixels, pixels], "samples": 1, "lights": [], "ambient": [1, 1, 1],
        "material": {"specular": [0, 0, 0]}, "background": [0, 0, 0, 1],
        "camera": {"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "height": 2},
    });
    draw(&SERVICE, &over(request, changes)).image
}

fn four_corners() -> Texels {
    Box::new(|x, y| match (x < 2, y < 2) {
        (true, true) => RED,
        (false, true) => GREEN,
        (true, false) => BLUE,
        (false, false) => WHITE,
    })
}

#[test]
fn a_texture_is_the_right_way_up_in_either_format() {
    for (name, format) in [
        ("png", image::ImageFormat::Png),
        ("bmp", image::ImageFormat::Bmp),
    ] {
        load(
            name,
            &wall([0.0, 0.0], [1.0, 1.0]),
            &encoded_picture(4, format, &four_corners()),
        );
        let image = seen(name, 64, json!({}));
        // Within the outer half of a texel its neighbour from the other side shines in.
        for (x, y, wanted) in [
            (10, 10, RED),
            (53, 10, GREEN),
            (10, 53, BLUE),
            (53, 53, WHITE),
        ] {
            assert_eq!(image.at(x, y)[..3], wanted, "{name} at {x}, {y}");
        }
    }
}

#[test]
fn beyond_its_edges_a_texture_comes_again() {
    let picture = encoded_picture(4, image::ImageFormat::Png, &four_corners());
    load("tiles", &wall([-1.0, -1.0], [2.0, 2.0]), &picture);
    let image = seen("tiles", 96, json!({}));
    for tile_y in 0..3 {
        for tile_x in 0..3 {
            for (x, y, wanted) in [(8, 8, RED), (24, 8, GREEN), (8, 24, BLUE), (24, 24, WHITE)] {
                let found = image.at(32 * tile_x + x, 32 * tile_y + y);
                assert_eq!(found[..3], wanted, "tile {tile_x}, {tile_y}");
            }
        }
    }
}

#[test]
fn between_texels_light_is_mixed_and_not_its_code() {
    let halves: Texels = Box::new(|x, _| if x < 1 { [0; 3] } else { [255; 3] });
    load(
        "halves",
        &wall([0.0, 0.0], [1.0, 1.0]),
        &encoded_picture(2, image::ImageFormat::Png, &halves),
    );
    // Texels' middles lie at a quarter and three quarters; half way between them is the middle of the wall.
    let image = seen("halves", 65, json!({}));
    let middle = f64::from(image.center()[0]);
    assert!(
        (middle - encoded(0.5)).abs() <= 2.0,
        "{middle}, not {}",
        encoded(0.5)
    );
}

#[test]
fn from_afar_a_fine_pattern_is_its_mean() {
    let checkered: Texels = Box::new(|x, y| if (x + y) % 2 == 0 { [255; 3] } else { [0; 3] });
    load(
        "checkered",
        &wall([0.0, 0.0], [1.0, 1.0]),
        &encoded_picture(256, image::ImageFormat::Png, &checkered),
    );
    let image = seen("checkered", 16, json!({}));
    for (x, y, pixel) in image.iter() {
        let off = f64::from(pixel[1]) - encoded(0.5);
        assert!(off.abs() <= 3.0, "{pixel:?} at {x}, {y}");
    }
}

#[test]
fn a_texture_multiplies_what_is_scattered_and_nothing_else() {
    let grey: Texels = Box::new(|_, _| [188; 3]);
    load(
        "grey",
        &wall([0.0, 0.0], [1.0, 1.0]),
        &encoded_picture(4, image::ImageFormat::Png, &grey),
    );
    let center = |changes: Value| seen("grey", 9, changes).center();
    let near = |found: u8, wanted: f64| (f64::from(found) - wanted).abs() <= 2.0;
    // 188 is half the light.
    let half = 0.5;
    let tinted = center(json!({"material": {"diffuse": [1, 0.5, 0.1], "specular": [0, 0, 0]}}));
    for (channel, share) in [1.0, 0.5, 0.1].into_iter().enumerate() {
        assert!(near(tinted[channel], encoded(half * share)), "{tinted:?}");
    }
    // Head on, the highlight is the light's own color.
    let gleam = json!({
        "ambient": [0, 0, 0], "lights": [{"kind": "directional", "direction": [0, 0, -1]}],
        "material": {"specular": [0.2, 0.2, 0.2], "shininess": 10},
    });
    let gleaming = center(gleam);
    assert!(near(gleaming[0], encoded(half + 0.2)), "{gleaming:?}");
}

#[test]
fn without_its_picture_a_rig_is_drawn_plain_and_says_so() {
    for (name, picture) in [
        ("garbled", &b"BM no picture"[..]),
        ("other", b"\x89PNG but cut"),
    ] {
        let summary = load(name, &wall([0.0, 0.0], [1.0, 1.0]), picture);
        let warnings = summary["warnings"].as_array().expect("a list");
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        let warning = warnings[0].as_str().expect("a sentence");
        assert!(
            warning.contains("wall.png") && warning.starts_with(&format!("{name}.skin:3:")),
            "{warning}"
        );
        let [r, g, b, _] = seen(name, 9, json!({})).center();
        assert!(
            r > g && g > b && b > 100,
            "a warm grey, not {:?}",
            [r, g, b]
        );
    }
}

#[test]
fn only_the_skin_wears_the_texture() {
    let red: Texels = Box::new(|_, _| RED);
    let skin = wall([0.0, 0.0], [1.0, 1.0]).replace(
        "triangles",
        "skinweights 4 { 1 0 1 1 0 1 1 0 1 1 0 1 }
         bindings 1 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } } triangles",
    );
    let picture = encoded_picture(4, image::ImageFormat::Png, &red);
    let files = json!([
        {"name": "box.skel", "text": "balljoint only { boxmin -0.5 -0.5 0.5 boxmax 0.5 0.5 1 }"},
        {"name": "box.skin", "text": skin}, with_base64("wall.png", &picture),
    ]);
    ask_ok(
        &SERVICE,
        "rig.load",
        json!({"name": "boxed", "files": files}),
    );
    let image = seen("boxed", 65, json!({"show": {"skeleton": "boxes"}}));
    assert_eq!(image.at(2, 2)[..3], RED);
    assert!(
        image.center()[2] > image.center()[0],
        "the box before it is blue: {:?}",
        image.center()
    );
}
