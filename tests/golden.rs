//! Are pictures and vertices those that somebody looked at, to the last bit? rigd's own renderer gives the same bytes on every machine:
//! small pictures are compared with `tests/golden/*.png`, larger ones and vertices with the hashes beside them.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use support::pictures::{Image, ask_attached, difference, draw, over};
use support::suite::{base, load_corners, load_reed, load_samples, suite};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(|| {
    let service = support::service_on("cpu").expect("it needs nothing");
    load_corners(&service);
    load_reed(&service);
    load_samples(&service);
    service
});

/// Environment variable that has what is compared written in place of compared.
fn accepts() -> bool {
    std::env::var_os("RIGD_ACCEPT_GOLDEN").is_some_and(|value| value == "1")
}

fn golden(file: &str) -> PathBuf {
    support::places::repository("tests/golden").join(file)
}

/// Compares with `tests/golden/<name>.png`. Where they differ, what was drawn and the difference are written below `target`.
fn check(name: &str, found: &Image) -> Result<(), String> {
    let path = golden(&format!("{name}.png"));
    if accepts() {
        found.write(&path);
        println!("accepted {}", path.display());
        return Ok(());
    }
    let accepted = std::fs::read(&path).ok().map(|file| Image::from_png(&file));
    if accepted.as_ref() == Some(found) {
        return Ok(());
    }
    let written = support::places::output("golden");
    found.write(&written.join(format!("{name}.actual.png")));
    if let Some(accepted) = accepted.filter(|it| it.size() == found.size()) {
        difference(&accepted, found).write(&written.join(format!("{name}.difference.png")));
    }
    Err(format!(
        "{name} is not as accepted; see {}; RIGD_ACCEPT_GOLDEN=1 accepts what was drawn",
        written.display()
    ))
}

#[test]
fn pictures_are_those_that_were_accepted() {
    let faults: Vec<String> = suite()
        .iter()
        .filter_map(|(name, request)| check(name, &draw(&SERVICE, request).image).err())
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_accepted_picture_is_drawn_by_a_test() {
    let files = std::fs::read_dir(golden(""))
        .expect("the folder")
        .map(|file| file.expect("a file").path());
    for file in files.filter(|file| file.extension().is_some_and(|it| it == "png")) {
        let is_drawn = suite()
            .iter()
            .any(|(name, _)| file.file_stem().is_some_and(|it| it == *name));
        assert!(is_drawn, "{}", file.display());
    }
}

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .fold(String::new(), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// What is too large to be kept, by what it shows.
fn hashes() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let pose = json!({"base": "rest", "clip": {"name": "walk", "time": 0.3}, "dofs": {"morph.smile": 0.7, "spine.ry": 0.4}});
    for (name, changes) in [
        ("figure 512x512", json!({"size": [512, 512]})),
        (
            "figure 1024x1024, 1 sample",
            json!({"size": [1024, 1024], "samples": 1}),
        ),
        (
            "figure 500x333 with sticks",
            json!({"size": [500, 333], "show": {"skeleton": "sticks", "skin_opacity": 0.5}}),
        ),
        (
            "figure from its inside",
            json!({"size": [256, 256], "camera": {"kind": "look_at", "eye": [0, 1.2, 0], "target": [0.3, 1.3, 1]}}),
        ),
    ] {
        let request = over(over(base(json!({})), json!({"pose": pose})), changes);
        let image = draw(&SERVICE, &request).image;
        found.insert(name.to_owned(), hash(image.pixels.as_flattened()));
    }
    for skinning in ["linear", "dual_quaternion"] {
        let request =
            json!({"rig": "figure", "pose": pose, "skinning": skinning, "transport": "attach"});
        let (_, attached) = ask_attached(&SERVICE, "mesh.vertices", &request);
        found.insert(format!("vertices, {skinning}"), hash(&attached));
    }
    found
}

#[test]
fn large_pictures_and_vertices_are_those_that_were_accepted() {
    let (path, found) = (golden("hashes.json"), hashes());
    if accepts() {
        let text = serde_json::to_string_pretty(&found).expect("JSON") + "\n";
        return std::fs::write(path, text).expect("a file");
    }
    let accepted = std::fs::read(path).expect("tests/golden/hashes.json");
    let accepted: BTreeMap<String, String> = serde_json::from_slice(&accepted).expect("hashes");
    assert_eq!(found, accepted);
}

#[test]
fn a_picture_that_changed_ever_so_little_is_refused() {
    if accepts() {
        return;
    }
    for change in [
        json!({"pose": {"base": "rest", "dofs": {"pelvis.tx": 1e-3}}}),
        json!({"lights": []}),
        json!({"samples": 1}),
        json!({"background": [0.031, 0.036, 0.048, 1]}),
        json!({"size": [96, 121]}),
    ] {
        let found = draw(&SERVICE, &over(base(json!({})), change.clone())).image;
        let accepted =
            Image::from_png(&std::fs::read(golden("camera_look_at.png")).expect("a picture"));
        assert_ne!(found, accepted, "{change}");
    }
}

/// A request names no more than that; what it was asked beside must not show.
#[test]
fn neither_order_nor_company_changes_a_picture() {
    let requests: Vec<(&str, Value)> = suite();
    let alone: Vec<Image> = requests
        .iter()
        .map(|it| draw(&SERVICE, &it.1).image)
        .collect();
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (requests, alone) = (&requests, &alone);
            scope.spawn(move || {
                for turn in 0..2 * requests.len() {
                    let at = (turn * (2 * thread + 1) + thread) % requests.len();
                    let found = draw(&SERVICE, &requests[at].1).image;
                    assert_eq!(found, alone[at], "{}", requests[at].0);
                }
            });
        }
    });
}
