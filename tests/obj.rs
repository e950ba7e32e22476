//! An OBJ with its materials, seams, hard edges and colors: is it drawn as its files say, while queries keep the file's own vertices?

mod support;

use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::service::Service;
use serde_json::{Value, json};
use std::io::Cursor;
use std::sync::{Arc, LazyLock};
use support::alike::{self, share_of_all};
use support::pictures::{draw, over};
use support::{ask_ok, with_base64};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// From -1 to 1, eight vertices, its faces in the order left, right, bottom, top, back, front.
const CUBE: [&str; 14] = [
    "v -1 -1 -1",
    "v 1 -1 -1",
    "v 1 1 -1",
    "v -1 1 -1",
    "v -1 -1 1",
    "v 1 -1 1",
    "v 1 1 1",
    "v -1 1 1",
    "f 1 5 8 4",
    "f 2 3 7 6",
    "f 1 2 6 5",
    "f 4 8 7 3",
    "f 1 4 3 2",
    "f 5 6 7 8",
];

/// The cube with `before` each of its faces, and the faces' corners as `corner` makes them of a face and a vertex.
fn cube(before: [&str; 6], corner: impl Fn(usize, &str) -> String) -> String {
    let mut lines: Vec<String> = CUBE[..8].iter().map(|&line| line.to_owned()).collect();
    for (face, line) in CUBE[8..].iter().enumerate() {
        lines.push(before[face].to_owned());
        let corners = line.split(' ').skip(1).map(|vertex| corner(face, vertex));
        lines.push(format!("f {}", corners.collect::<Vec<_>>().join(" ")));
    }
    lines.join("\n")
}

fn plain(_: usize, vertex: &str) -> String {
    vertex.to_owned()
}

const COLORS: &str = "newmtl red\nKd 1 0 0\nKs 0 0 0\nnewmtl blue\nKd 0 0 1\nKs 0 0 0\n";

/// Each file a name and its text.
fn load(service: &Arc<Service>, name: &str, files: &[(&str, &str)]) -> Value {
    let file = |&(name, text): &(&str, &str)| json!({"name": name, "text": text});
    let files: Vec<_> = files.iter().map(file).collect();
    ask_ok(service, "rig.load", json!({"name": name, "files": files}))
}

fn two_colored(service: &Arc<Service>) -> Value {
    let before = ["usemtl red", "", "usemtl blue", "", "usemtl red", ""];
    let text = format!("mtllib cube.mtl\n{}", cube(before, plain));
    load(service, "two", &[("cube.obj", &text), ("cube.mtl", COLORS)])
}

fn hard(service: &Arc<Service>) -> Value {
    let normals = "vn -1 0 0\nvn 1 0 0\nvn 0 -1 0\nvn 0 1 0\nvn 0 0 -1\nvn 0 0 1\n";
    let faces = cube([""; 6], |face, vertex| format!("{vertex}//{}", face + 1));
    let text = format!("{normals}{faces}");
    load(service, "hard", &[("cube.obj", &text)])
}

/// Two quads side by side that share an edge, each with the whole of a picture on it: red, green, blue and white from its upper left.
fn seamed(service: &Arc<Service>) -> Value {
    let text = "mtllib wall.mtl\nv -1 -1 0\nv 0 -1 0\nv 1 -1 0\nv -1 1 0\nv 0 1 0\nv 1 1 0\n\
        vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl wall\nf 1/1 2/2 5/3 4/4\nf 2/1 3/2 6/3 5/4\n";
    let library = "newmtl wall\nKs 0 0 0\nmap_Kd my wall.png\n";
    let picture = image::RgbImage::from_fn(4, 4, |x, y| {
        image::Rgb(match (x < 2, y < 2) {
            (true, true) => [255, 0, 0],
            (false, true) => [0, 255, 0],
            (true, false) => [0, 0, 255],
            (false, false) => [255, 255, 255],
        })
    });
    let mut file = Cursor::new(Vec::new());
    let png = image::ImageFormat::Png;
    picture.write_to(&mut file, png).expect("a picture");
    let files = json!([
        {"name": "wall.obj", "text": text}, {"name": "wall.mtl", "text": library},
        with_base64("my wall.png", &file.into_inner()),
    ]);
    ask_ok(
        service,
        "rig.load",
        json!({"name": "seamed", "files": files}),
    )
}

fn concave(service: &Arc<Service>) -> Value {
    let text = case("concave_fan_from_first_is_wrong.obj");
    load(service, "concave", &[("concave.obj", &text)])
}

fn colored(service: &Arc<Service>) -> Value {
    let mut text = cube([""; 6], plain);
    for (index, line) in CUBE[..8].iter().enumerate() {
        let channel = |bit: usize| if index >> bit & 1 == 1 { "1" } else { "0.2" };
        let colored = format!("{line} {} {} {}", channel(0), channel(1), channel(2));
        text = text.replacen(line, &colored, 1);
    }
    load(service, "colored", &[("cube.obj", &text)])
}

fn see_through(service: &Arc<Service>) -> Value {
    let library = COLORS.replace("Ks 0 0 0\n", "Ks 0.5 0.5 0.5\nNs 60\nd 0.5\n");
    let before = ["usemtl red", "", "usemtl blue", "", "usemtl red", ""];
    let text = format!("mtllib cube.mtl\ns off\n{}", cube(before, plain));
    load(
        service,
        "glass",
        &[("cube.obj", &text), ("cube.mtl", &library)],
    )
}

/// The text of a file of `tests/cases/course`.
fn case(name: &str) -> String {
    String::from_utf8(support::case_bytes(&format!("course/{name}"))).expect("it is text")
}

/// Even white light from everywhere, so that a pixel is its color.
fn evenly(rig: &str) -> Value {
    json!({
        "rig": rig, "size": [64, 64], "samples": 1, "lights": [], "ambient": [1, 1, 1], "background": [0, 0, 0, 1],
        "camera": {"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "height": 2},
    })
}

fn from_a_corner(rig: &str) -> Value {
    json!({"rig": rig, "size": [240, 240], "camera": {"kind": "look_at", "eye": [4, 3, 5], "target": [0, 0, 0], "fov_y": 0.6}})
}

fn topology(rig: &str) -> Value {
    let asked = json!({"rig": rig, "transport": "json"});
    ask_ok(&SERVICE, "mesh.topology", asked)["meshes"][0].take()
}

fn numbers(blob: &Value) -> Vec<f64> {
    serde_json::from_value(blob["data"].clone()).expect("an array of numbers")
}

fn no_warnings(summary: &Value) {
    assert_eq!(summary["warnings"], json!([]), "{summary}");
}

#[test]
fn materials_of_a_library_color_the_faces_that_name_them() {
    let summary = two_colored(&SERVICE);
    no_warnings(&summary);
    let eyes = [
        ([0, 0, 5], "red"),
        ([5, 0, 0], "red"),
        ([0, 5, 0], "blue"),
        ([0, -5, 0], "blue"),
        ([-5, 0, 0], "red"),
    ];
    for (eye, color) in eyes {
        let camera = json!({"kind": "look_at", "eye": eye, "target": [0, 0, 0], "up": [0.1, 0.2, 0.9], "height": 1});
        let image = draw(&SERVICE, &over(evenly("two"), json!({"camera": camera}))).image;
        let wanted = if color == "red" {
            [255, 0, 0, 255]
        } else {
            [0, 0, 255, 255]
        };
        assert_eq!(image.center(), wanted, "{eye:?}");
    }
    let parts = topology("two")["parts"].take();
    let part = |material: &str| json!({"triangle_count": 4, "material": material});
    assert_eq!(parts, json!([part("red"), part("blue"), part("red")]));
}

#[test]
fn seams_are_drawn_and_queries_keep_the_vertices_of_the_file() {
    let summary = seamed(&SERVICE);
    no_warnings(&summary);
    assert_eq!(
        (&summary["vertex_count"], &summary["triangle_count"]),
        (&json!(6), &json!(4))
    );
    let image = draw(&SERVICE, &evenly("seamed")).image;
    let (red, green) = ([255, 0, 0, 255], [0, 255, 0, 255]);
    let (blue, white) = ([0, 0, 255, 255], [255, 255, 255, 255]);
    for left in [0, 32] {
        for (x, y, wanted) in [
            (6, 10, red),
            (26, 10, green),
            (6, 53, blue),
            (26, 53, white),
        ] {
            assert_eq!(image.at(left + x, y), wanted, "{left} + {x}, {y}");
        }
    }
    let topology = topology("seamed");
    let corners = [0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4];
    assert_eq!(
        numbers(&topology["triangles"]),
        corners.map(f64::from).to_vec()
    );
    assert!(topology["texcoords"].is_null());
    let of_corners = &topology["corner_texcoords"];
    assert_eq!(of_corners["shape"], json!([4, 3, 2]));
    let quad = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0];
    assert_eq!(numbers(of_corners), [quad, quad].concat());
    let asked = json!({"rig": "seamed", "transport": "json"});
    let vertices = ask_ok(&SERVICE, "mesh.vertices", asked)["meshes"][0].take();
    assert_eq!(vertices["positions"]["shape"], json!([6, 3]));
    let above = json!({"rig": "seamed", "mesh": "mesh_0", "range": {"start": 0, "count": 7}});
    assert_eq!(
        support::ask_kind(&SERVICE, "mesh.vertices", above),
        "invalid_params"
    );
}

#[test]
fn hard_edges_are_drawn_hard_and_picked_so_while_vertices_are_smooth() {
    let summary = hard(&SERVICE);
    no_warnings(&summary);
    assert_eq!(summary["vertex_count"], 8);
    // Lit along the view, a face has one color from edge to edge.
    let light = json!([{"kind": "directional", "direction": [0, 0, -1], "intensity": 1}]);
    let changes = json!({"lights": light, "ambient": [0, 0, 0], "material": {"diffuse": [1, 1, 1], "specular": [0, 0, 0]}});
    let image = draw(&SERVICE, &over(evenly("hard"), changes)).image;
    assert!(image.iter().all(|(_, _, pixel)| pixel == [255; 4]));
    let asked = json!({"rig": "hard", "transport": "json"});
    let vertices = ask_ok(&SERVICE, "mesh.vertices", asked);
    let normals = numbers(&vertices["meshes"][0]["normals"]);
    assert_eq!(normals.len(), 24);
    // Each leans to all three of its faces.
    assert!(normals.iter().all(|along| along.abs() > 0.3), "{normals:?}");
    // Near a corner, where the smooth normal would lean far away.
    let pick = json!({"pixel": [60, 4], "targets": ["skin"]});
    let picked = ask_ok(&SERVICE, "scene.pick", over(evenly("hard"), pick));
    assert_eq!(picked["hit"]["normal"], json!([0.0, 0.0, 1.0]), "{picked}");
}

#[test]
fn the_notch_of_a_concave_face_stays_open() {
    no_warnings(&concave(&SERVICE));
    let changes =
        json!({"camera": {"kind": "look_at", "eye": [1, 1, 5], "target": [1, 1, 0], "height": 2}});
    let image = draw(&SERVICE, &over(evenly("concave"), changes)).image;
    let share = image
        .iter()
        .filter(|(_, _, pixel)| pixel[..3] != [0; 3])
        .count();
    // 2.5 of 4, but for a pixel along each edge.
    assert!(share.abs_diff(64 * 64 * 5 / 8) < 100, "{share}");
    assert_eq!(image.at(32, 20), [0, 0, 0, 255]);
}

#[test]
fn vertices_have_colors_of_their_own() {
    no_warnings(&colored(&SERVICE));
    let image = draw(&SERVICE, &evenly("colored")).image;
    // The front's lower left corner is all dark but for blue, its upper right one dark but for it and green.
    let near = |pixel: [u8; 4], wanted: [u8; 3]| {
        let off = pixel.iter().zip(wanted).map(|(a, b)| a.abs_diff(b));
        assert!(off.max() <= Some(16), "{pixel:?} {wanted:?}");
    };
    near(image.at(0, 63), [51, 51, 255]);
    near(image.at(63, 63), [255, 51, 255]);
    near(image.at(63, 0), [51, 255, 255]);
}

#[test]
fn what_is_beside_an_obj_is_found_and_told_in_its_digest() {
    let source = Source::rooted(&support::case_path("course")).expect("a folder");
    let service = support::service_with(Limits::default(), source);
    let by_path = |file: &str| {
        let files = json!({"name": "of", "replace": true, "files": [file]});
        ask_ok(&service, "rig.load", files)
    };
    let summary = by_path("mtllib.obj");
    no_warnings(&summary);
    let described = ask_ok(&service, "rig.describe", json!({"rig": "of"}));
    assert_eq!(
        described["materials"][0]["color"],
        json!([1.0, 0.0, 0.0, 1.0])
    );

    let (obj, mtl) = (case("mtllib.obj"), case("x.mtl"));
    let sent = load(&SERVICE, "sent", &[("mtllib.obj", &obj), ("x.mtl", &mtl)]);
    no_warnings(&sent);
    assert_eq!(sent["digest"], summary["digest"]);
    let other = mtl.replace("1 0 0", "0 1 0");
    let other = load(
        &SERVICE,
        "other",
        &[("mtllib.obj", &obj), ("x.mtl", &other)],
    );
    assert_ne!(other["digest"], summary["digest"]);
    let without = load(&SERVICE, "without", &[("mtllib.obj", &obj)]);
    assert_eq!(
        without["warnings"],
        json!([
            "mtllib.obj:1:8: the material library `x.mtl` is left out: it was not found",
            "mtllib.obj:5:8: no material library has `a`: drawn without a material",
        ])
    );
}

#[test]
fn cases_load_with_one_warning_for_each_oddity() {
    let source = Source::rooted(&support::case_path("course")).expect("a folder");
    let service = support::service_with(Limits::default(), source);
    for (file, wanted) in [
        ("nul_at_end.obj", 1),
        ("no_vt.obj", 1),
        // And the material, which no library has.
        ("latin1_material.obj", 2),
        ("mtllib.obj", 0),
        ("mit_comment_first.obj", 0),
        ("concave_fan_from_first_is_wrong.obj", 0),
    ] {
        let files = json!({"name": "case", "replace": true, "files": [file]});
        let summary = ask_ok(&service, "rig.load", files);
        let warnings = summary["warnings"].as_array().expect("a list");
        assert_eq!(warnings.len(), wanted, "{file}: {warnings:?}");
        if !file.starts_with("concave") {
            let counts = [&summary["vertex_count"], &summary["triangle_count"]];
            assert_eq!(counts, [&json!(3), &json!(1)], "{file}");
        }
    }
}

#[test]
fn both_renderers_draw_an_obj_alike() {
    let Some(wgpu) = support::service_on(&support::adapters::wgpu_adapter()) else {
        return;
    };
    let (mut off, mut all) = (0, 0);
    for load in [two_colored, hard, seamed, concave, colored, see_through] {
        let summary = load(&SERVICE);
        load(&wgpu);
        let name = summary["name"].as_str().expect("a name");
        let request = from_a_corner(name);
        let images = [&SERVICE, &wgpu].map(|service| draw(service, &request).image);
        let (of_picture, channels) = alike::compare(&format!("obj_{name}"), &images, false);
        (off, all) = (off + of_picture, all + channels);
    }
    assert!(off as f64 <= share_of_all() * all as f64, "{off} of {all}");
}

#[test]
fn textures_that_are_not_shown_are_no_files_that_nobody_refers_to() {
    let library = "newmtl a\nmap_Ka ambient.png\nmap_Bump -bm 0.5 \"bumps.png\"\n";
    let obj = "mtllib \"my colors.mtl\"\nv 0 0 0\nv 1 0 0\nv 0 1 0 2.0\nusemtl a\nf 1 2 3\n";
    let files = [
        ("a.obj", obj),
        ("my colors.mtl", library),
        ("ambient.png", "x"),
        ("bumps.png", "x"),
    ];
    let summary = load(&SERVICE, "passed over", &files);
    let wanted = "my colors.mtl:3:1: `map_Bump` is not shown, nor are others like it";
    assert_eq!(summary["warnings"], json!([wanted]));
}

#[test]
fn what_is_lit_flat_is_picked_flat() {
    let off = cube(["s off", "", "", "", "", ""], plain);
    load(&SERVICE, "off", &[("off.obj", &off)]);
    let camera = json!({"kind": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "height": 4});
    let request = json!({"rig": "off", "size": [64, 64], "camera": camera, "pixel": [40, 20]});
    let found = ask_ok(&SERVICE, "scene.pick", request);
    assert_eq!(found["hit"]["normal"], json!([0.0, 0.0, 1.0]));
}
