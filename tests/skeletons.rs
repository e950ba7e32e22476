//! Does each view of a skeleton show what its rig is made of? By where pixels are covered, and by how they are lit.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use support::ask_ok;
use support::pictures::{Image, draw, over};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

const VIEWS: [&str; 4] = ["wireframe", "boxes", "sticks", "cylinders"];

/// A bone of 4 to the right, then one of 2 up; `twin` stands where the elbow does.
const ARM: &str = "balljoint shoulder { boxmin 0 -0.25 -0.25 boxmax 4 0.25 0.25
    balljoint elbow { offset 4 0 0 boxmin -0.5 0.5 -0.125 boxmax 0.5 -0.5 0.125
        balljoint wrist { offset 0 2 0 boxmin 0 0 0 boxmax 0 0 0 }
        balljoint twin { boxmin 0 0 0 boxmax 0 0 0 } } }";

fn load(name: &str, text: &str) {
    let files = json!([{"name": format!("{name}.skel"), "text": text}]);
    ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}));
}

/// Sixteen pixels a unit, (2, 1, 0) in the middle, no perspective, one sample, against nothing.
fn seen(rig: &str, view: &str, changes: Value) -> Image {
    let request = json!({
        "rig": rig, "size": [128, 128], "samples": 1, "background": [0, 0, 0, 0], "show": {"skeleton": view},
        "camera": {"kind": "look_at", "eye": [2, 1, 50], "target": [2, 1, 0], "height": 8},
    });
    draw(&SERVICE, &over(request, changes)).image
}

/// First and last column and row that show something: `[left, right, top, bottom]`.
fn covered(image: &Image) -> [usize; 4] {
    let mut edges = [usize::MAX, 0, usize::MAX, 0];
    for (x, y, _) in image.iter().filter(|(_, _, pixel)| pixel[3] > 0) {
        edges = [
            edges[0].min(x),
            edges[1].max(x),
            edges[2].min(y),
            edges[3].max(y),
        ];
    }
    edges
}

/// Rows of one column that show something.
fn rows(image: &Image, x: usize) -> usize {
    (0..image.height).filter(|&y| image.at(x, y)[3] > 0).count()
}

#[test]
fn every_view_is_its_own_and_covers_the_bones() {
    load("arm", ARM);
    let images = VIEWS.map(|view| seen("arm", view, json!({})));
    for (view, image) in VIEWS.iter().zip(&images) {
        // A quarter and half along each bone: (1, 0), (2, 0), (4, 0.5), (4, 1), where the pixels of a thin line may be one off.
        for (x, y) in [(48, 80), (64, 80), (96, 72), (96, 64)] {
            let near = (y - 1..=y).any(|y| (x - 1..=x).any(|x| image.at(x, y)[3] == 255));
            // A box is as long as its file says, which need not be as long as the bone.
            assert!(near || (*view == "boxes" && y < 72), "{view} at {x}, {y}");
        }
    }
    for (i, image) in images.iter().enumerate() {
        assert!(
            images[..i].iter().all(|other| other != image),
            "{}",
            VIEWS[i]
        );
    }
}

#[test]
fn boxes_have_the_corners_of_their_file() {
    load("boxed", ARM);
    // From (0, -0.25) to (4, 0.25), and from (3.5, -0.5) to (4.5, 0.5); corners given the wrong way around are sorted.
    assert_eq!(
        covered(&seen("boxed", "boxes", json!({}))),
        [32, 103, 72, 87]
    );
    let turned = json!({"pose": {"dofs": {"shoulder.rz": std::f64::consts::FRAC_PI_2}}, "camera":
        {"kind": "look_at", "eye": [0, 2, 50], "target": [0, 2, 0], "height": 8}});
    assert_eq!(covered(&seen("boxed", "boxes", turned)), [56, 71, 24, 95]);
}

#[test]
fn the_default_camera_sees_all_boxes_of_a_rig_without_skin() {
    // Far larger than the distance between the joints.
    load(
        "bulky",
        "balljoint a { boxmin -3 -1 -1 boxmax 1 5 1 balljoint b { offset 0.1 0 0 } }",
    );
    for (view, azimuth) in VIEWS.iter().flat_map(|view| [(view, 0.5), (view, 3.0)]) {
        let camera = json!({"camera": {"kind": "orbit", "azimuth": azimuth}});
        let [left, right, top, bottom] = covered(&seen("bulky", view, camera));
        assert!(
            left > 0 && right < 127 && top > 0 && bottom < 127,
            "{view} from {azimuth}"
        );
        assert!(
            *view != "boxes" || bottom - top > 60,
            "it fills the picture"
        );
    }
}

#[test]
fn bones_are_as_thick_as_they_are_long_or_as_the_rig_has_them() {
    load("thick", ARM);
    // A tenth of the median length, which is 4: 0.4 in radius, 12.8 pixels across; on edge a hexagon is narrower.
    let cylinders = seen("thick", "cylinders", json!({}));
    let across = rows(&cylinders, 48);
    assert!((11..=13).contains(&across), "{across}");
    // The same all along.
    assert!((36..90).all(|x| rows(&cylinders, x) == across));
    // A stick grows thinner, and has a ball at its start.
    let sticks = seen("thick", "sticks", json!({}));
    let along: Vec<usize> = (46..86).map(|x| rows(&sticks, x)).collect();
    assert!(
        along.is_sorted_by(|a, b| a >= b) && 2 * along[0] > 3 * along[39],
        "{along:?}"
    );
    assert!(rows(&sticks, 32) > along[0]);
    // Lines stay as wide in pixels, however near.
    for height in [8.0, 3.0] {
        let camera = json!({"camera": {"kind": "look_at", "eye": [2, 0, 50], "target": [2, 0, 0], "height": height}});
        assert_eq!(rows(&seen("thick", "wireframe", camera), 64), 2, "{height}");
    }
}

#[test]
fn solids_are_lit_and_lines_are_not() {
    load("lit", ARM);
    let from = |direction: [f64; 3]| json!({"ambient": [0, 0, 0], "lights": [{"kind": "directional", "direction": direction}]});
    for view in VIEWS {
        let [front, behind] =
            [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]].map(|direction| seen("lit", view, from(direction)));
        let brightest = |image: &Image| image.iter().map(|(_, _, pixel)| pixel[0]).max();
        if view == "wireframe" {
            assert_eq!(front, behind);
        } else {
            assert!(
                brightest(&front) > Some(90) && brightest(&behind) == Some(0),
                "{view}"
            );
        }
    }
}

#[test]
fn bones_of_no_length_draw_nothing_and_break_nothing() {
    load(
        "heap",
        "balljoint a { boxmin 0 0 0 boxmax 0 0 0 balljoint b { boxmin 0 0 0 boxmax 0 0 0 balljoint c { boxmin 0 0 0 boxmax 0 0 0 } } }",
    );
    for (view, shows) in [
        ("wireframe", true),
        ("sticks", true),
        ("boxes", false),
        ("cylinders", false),
    ] {
        let image = seen("heap", view, json!({}));
        assert_eq!(
            image.iter().any(|(_, _, pixel)| pixel[3] > 0),
            shows,
            "{view}"
        );
    }
    // The twin of the arm's elbow adds nothing to any bone.
    load("with", ARM);
    load(
        "without",
        &ARM.replace("balljoint twin { boxmin 0 0 0 boxmax 0 0 0 }", ""),
    );
    for view in VIEWS {
        assert_eq!(
            seen("with", view, json!({})),
            seen("without", view, json!({})),
            "{view}"
        );
    }
}

#[test]
fn a_skin_hides_the_bones_in_it_as_far_as_it_is_opaque() {
    let figure = |show: Value| {
        let request =
            json!({"rig": "figure", "size": [128, 128], "show": show, "background": [0, 0, 0, 0]});
        draw(&SERVICE, &request).image
    };
    for view in ["sticks", "cylinders"] {
        let skin = figure(json!({}));
        let both = |opacity: f64| figure(json!({"skeleton": view, "skin_opacity": opacity}));
        let differing = |image: &Image| {
            let pairs = image.pixels.iter().zip(&skin.pixels);
            pairs
                .filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 12))
                .count()
        };
        // Fingers and toes are thinner than the balls in them.
        assert!(
            differing(&both(1.0)) < 60,
            "{view}: {}",
            differing(&both(1.0))
        );
        let shining = differing(&both(0.4));
        assert!(shining > 500, "{view}: {shining}");
        // Framed as with the skin, which fades out without moving the camera.
        let camera = json!({"kind": "orbit", "target": [0, 0.9, 0], "distance": 4});
        let figure = |show: Value| {
            let request = json!({"rig": "figure", "size": [128, 128], "background": [0, 0, 0, 0], "show": show});
            draw(&SERVICE, &over(request, json!({ "camera": camera }))).image
        };
        let both = |opacity: f64| figure(json!({"skeleton": view, "skin_opacity": opacity}));
        let alone = figure(json!({"skin": "none", "skeleton": view}));
        assert_eq!(
            both(0.0),
            alone,
            "{view}: a skin that cannot be seen hides nothing"
        );
    }
}

#[test]
fn a_skeleton_follows_the_pose_where_the_skin_is_shown_as_bound() {
    let figure = |changes: Value| {
        let request = json!({"rig": "figure", "size": [96, 96], "pose": {"dofs": {"upper_arm_l.rz": 1.2}},
            "show": {"skin": "bind", "skeleton": "sticks", "skin_opacity": 0.5}});
        draw(&SERVICE, &over(request, changes)).image
    };
    let posed = figure(json!({}));
    assert_ne!(posed, figure(json!({"pose": {}})), "the bones move");
    let skin_alone = json!({"skin": "bind"});
    assert_eq!(
        figure(json!({"show": skin_alone})),
        figure(json!({"show": skin_alone, "pose": {}}))
    );
}
