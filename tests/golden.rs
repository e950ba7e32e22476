//! Are pictures those that somebody looked at? Small ones, compared with `tests/golden` within a tolerance that is kept beside them.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use support::pictures::{Image, Mismatch, Tolerance, check_golden, draw, matches, over, tolerance};
use support::{ask_ok, with_base64};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(|| {
    let service = support::service();
    load_corners(&service);
    service
});

/// A square wall that wears a picture of four different corners and a diagonal.
fn load_corners(service: &Arc<Service>) {
    let skin = "positions 4 { -1 -1 0 1 -1 0 1 1 0 -1 1 0 } normals 4 { 0 0 1 0 0 1 0 0 1 0 0 1 }
        texcoords 4 { 0 0 1 0 1 1 0 1 } material paint { texture corners.png } triangles 2 { 0 1 2 0 2 3 }";
    let texel = |x: u32, y: u32| match (x < 32, y < 32) {
        _ if x.abs_diff(y) < 3 => [0, 0, 0],
        (true, true) => [230, 40, 30],
        (false, true) => [40, 200, 60],
        (true, false) => [40, 70, 230],
        (false, false) => [250, 250, 240],
    };
    let picture = image::RgbImage::from_fn(64, 64, |x, y| image::Rgb(texel(x, y)));
    let mut file = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut file, image::ImageFormat::Png)
        .expect("a picture");
    let files = json!([{"name": "corners.skin", "text": skin}, with_base64("corners.png", &file.into_inner())]);
    ask_ok(
        service,
        "rig.load",
        json!({"name": "corners", "files": files}),
    );
}

/// The figure from the front left, its texture as it is, in a warm and a cool light; what could change with a default is spelled out.
fn base(changes: Value) -> Value {
    let before =
        json!({"kind": "look_at", "eye": [0.6, 1.3, 4], "target": [0, 0.9, 0], "fov_y": 0.55});
    let request = json!({
        "rig": "figure", "size": [96, 120], "samples": 4, "camera": before, "lights": [key(), fill()],
        "ambient": [0.05, 0.05, 0.07], "pose": {"base": "rest"}, "background": [0.03, 0.036, 0.048, 1],
        "material": {"specular": [0.22, 0.22, 0.22], "shininess": 40},
        "show": {"skin": "posed", "skeleton": "none", "skin_opacity": 1, "normals": "smooth"},
    });
    over(request, changes)
}

fn key() -> Value {
    json!({"kind": "directional", "direction": [0.4, -0.6, -0.8], "color": [1, 0.92, 0.8], "intensity": 0.9})
}

fn fill() -> Value {
    json!({"kind": "directional", "direction": [-0.9, -0.1, 0.2], "color": [0.4, 0.6, 1], "intensity": 0.6})
}

/// Name and request of each picture in `tests/golden`.
fn golden() -> Vec<(&'static str, Value)> {
    let show = |skin: &str, skeleton: &str, opacity: f64| json!({"show": {"skin": skin, "skeleton": skeleton, "skin_opacity": opacity, "normals": "smooth"}});
    let point = |falloff: &str| json!({"lights": [{"kind": "point", "position": [0.7, 1.7, 0.8], "color": [1, 0.8, 0.5], "intensity": 0.9, "falloff": falloff}]});
    let orbit = json!({"kind": "orbit", "target": [0, 0.9, 0], "distance": 4.2, "azimuth": 0.8, "inclination": 0.4, "fov_y": 0.55});
    let orthographic =
        json!({"kind": "look_at", "eye": [-3, 3, 3], "target": [0, 0.9, 0], "height": 2.2});
    let from_side = json!([0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 4, 0.9, 0, 1]);
    let gl = json!({"kind": "pinhole", "fx": 200, "fy": 200, "cx": 48, "cy": 60, "world_from_camera": from_side});
    let from_behind = json!([-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0.9, -4, 1]);
    let cv = json!({"kind": "pinhole", "fx": 200, "fy": 200, "cx": 30, "cy": 66, "axes": "cv", "world_from_camera": from_behind});
    let face = json!({"kind": "look_at", "eye": [-0.08, 1.62, 0.85], "target": [0.02, 1.58, 0.03], "fov_y": 0.42});
    let smile = |weight: f64| {
        let dofs = json!({"morph.smile": weight, "morph.blink": weight / 2.0});
        base(json!({"camera": face, "size": [120, 120], "pose": {"base": "rest", "dofs": dofs}}))
    };
    let stride =
        json!({"base": "rest", "clip": {"name": "walk", "time": 0.02}, "dofs": {"pelvis.tz": 0}});
    let posed = |shown: Value| over(base(json!({"pose": stride})), shown);
    let twisted =
        json!({"base": "rest", "dofs": {"spine.ry": 1.4, "chest.ry": 1.4}, "limits": "ignore"});
    let wall = json!({"kind": "look_at", "eye": [0.5, 0.6, 3], "target": [0, 0, 0], "fov_y": 0.9});
    let flat = json!({"show": {"skin": "posed", "skeleton": "none", "skin_opacity": 1, "normals": "flat"}});
    let clear = json!({"size": [60, 120], "background": [0, 0, 0, 0]});
    vec![
        ("camera_orbit", base(json!({"camera": orbit}))),
        ("camera_look_at", base(json!({}))),
        ("camera_orthographic", base(json!({"camera": orthographic}))),
        ("camera_pinhole_gl", base(json!({"camera": gl}))),
        ("camera_pinhole_cv", base(json!({"camera": cv}))),
        (
            "light_ambient",
            base(json!({"lights": [], "ambient": [0.4, 0.45, 0.5]})),
        ),
        ("light_directional", base(json!({"lights": [key()]}))),
        ("light_point", base(point("none"))),
        ("light_inverse_square", base(point("inverse_square"))),
        (
            "plain",
            base(json!({"material": {"diffuse": [0.9, 0.3, 0.2], "specular": [0, 0, 0]}})),
        ),
        ("skeleton_wireframe", posed(show("none", "wireframe", 1.0))),
        ("skeleton_boxes", posed(show("none", "boxes", 1.0))),
        ("skeleton_sticks", posed(show("none", "sticks", 1.0))),
        ("skeleton_cylinders", posed(show("none", "cylinders", 1.0))),
        ("skin_over_wireframe", base(show("posed", "wireframe", 0.5))),
        ("skin_over_sticks", posed(show("posed", "sticks", 0.4))),
        ("skin_posed", posed(json!({}))),
        ("skin_bound", posed(show("bind", "cylinders", 0.5))),
        ("morph_0", smile(0.0)),
        ("morph_half", smile(0.5)),
        ("morph_1", smile(1.0)),
        (
            "texture_corners",
            base(
                json!({"rig": "corners", "camera": wall, "lights": [], "ambient": [1, 1, 1], "pose": {}}),
            ),
        ),
        (
            "twist_linear",
            base(json!({"pose": twisted, "skinning": "linear"})),
        ),
        (
            "twist_dual_quaternion",
            base(json!({"pose": twisted, "skinning": "dual_quaternion"})),
        ),
        ("flat", base(flat)),
        ("wide", base(json!({"size": [160, 80]}))),
        ("tall", base(clear)),
    ]
}

#[test]
fn pictures_are_those_that_were_accepted() {
    let faults: Vec<String> = golden()
        .iter()
        .filter_map(|(name, request)| check_golden(name, &draw(&SERVICE, request).image).err())
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_accepted_picture_is_drawn_by_a_test() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden");
    let files = std::fs::read_dir(folder)
        .expect("the folder")
        .map(|file| file.expect("a file").path());
    for file in files.filter(|file| file.extension().is_some_and(|it| it == "png")) {
        let is_drawn = golden()
            .iter()
            .any(|(name, _)| file.file_stem().is_some_and(|it| it == *name));
        assert!(is_drawn, "{}", file.display());
    }
}

#[test]
fn a_disturbed_missing_or_resized_picture_is_refused() {
    let accepted = Image::from_bytes([20, 10], &[100; 800]);
    let with = |count: usize, value: u8| {
        let mut image = accepted.clone();
        image
            .pixels
            .iter_mut()
            .take(count)
            .for_each(|pixel| pixel[1] = value);
        image
    };
    let tolerance = Tolerance {
        channel: 2,
        share: 0.02,
        most: 60,
    };
    let check = |found: &Image| matches(Some(&accepted), found, tolerance);
    assert_eq!(check(&accepted), Ok(()));
    assert_eq!(check(&with(200, 102)), Ok(()), "rounding everywhere");
    assert_eq!(check(&with(4, 160)), Ok(()), "an edge or two");
    let worst = |color: u8| (0, 0, [100; 4], [100, color, 100, 100]);
    let pixels = |differing, color| {
        Err(Mismatch::Pixels {
            differing,
            allowed: 4,
            worst: worst(color),
        })
    };
    assert_eq!(
        check(&with(1, 161)),
        pixels(1, 161),
        "one pixel too far off"
    );
    assert_eq!(check(&with(5, 103)), pixels(5, 103), "too many pixels");
    let sideways = Image {
        width: 10,
        height: 20,
        ..accepted.clone()
    };
    assert_eq!(
        check(&sideways),
        Err(Mismatch::Size {
            wanted: [20, 10],
            found: [10, 20]
        })
    );
    assert_eq!(matches(None, &accepted, tolerance), Err(Mismatch::Missing));
}

#[test]
fn an_accepted_picture_refuses_a_figure_that_moved_a_little() {
    if std::env::var_os("RIGD_ACCEPT_GOLDEN").is_some() {
        return;
    }
    let requests = golden();
    let (_, request) = requests
        .iter()
        .find(|it| it.0 == "camera_look_at")
        .expect("a picture");
    let file = std::fs::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/golden/camera_look_at.png"
    ));
    let accepted = Image::from_png(&file.expect("the picture"));
    for change in [
        json!({"pose": {"base": "rest", "dofs": {"pelvis.tx": 0.02}}}),
        json!({"lights": []}),
        json!({"samples": 1}),
        json!({"background": [0.05, 0.036, 0.048, 1]}),
    ] {
        let request = over(request.clone(), change.clone());
        let found = draw(&SERVICE, &request).image;
        assert!(
            matches(Some(&accepted), &found, tolerance()).is_err(),
            "{change}"
        );
    }
}
