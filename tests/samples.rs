//! Are the rigs of the README what their scripts write, and have they what they are to show of the courses' formats?
//! What they look like is a matter of `tests/golden.rs`.

mod support;

use rigd::formats::{FileRef, Loaded, Source, load};
use rigd::limits::Limits;
use rigd::rig::Channel;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Command;
use support::suite::{BEAR, DRAKE, load_samples};

/// Name of the script, folder below `assets`, and files.
const SAMPLES: [(&str, &str, &[&str]); 2] = [
    ("drake.py", "cse169/drake", &DRAKE),
    ("bear.py", "mit6837/bear", &BEAR),
];

fn root() -> PathBuf {
    support::places::repository("")
}

fn loaded(folder: &str, files: &[&str]) -> Loaded {
    let folder = root().join("assets").join(folder);
    let file = |name: &&str| FileRef::Path(folder.join(name).to_string_lossy().into_owned());
    let files: Vec<FileRef> = files.iter().map(file).collect();
    load(&files, &Source::local(), &Limits::default()).expect("a rig")
}

fn drake() -> Loaded {
    loaded("cse169/drake", &DRAKE)
}

fn bear() -> Loaded {
    loaded("mit6837/bear", &BEAR)
}

/// What a file says: of a picture its texels, for one encoder packs them unlike another.
fn meaning(path: &Path) -> Vec<u8> {
    if path.extension().is_some_and(|it| it == "png") {
        return image::open(path).expect("a picture").into_rgb8().into_raw();
    }
    std::fs::read(path).unwrap_or_default()
}

#[test]
fn the_files_are_what_the_scripts_write() {
    for (script, folder, files) in SAMPLES {
        let written = support::places::output(script);
        let _ = std::fs::remove_dir_all(&written);
        let status = Command::new("python3")
            .arg("-B")
            .arg(root().join("scripts").join(script))
            .arg(&written)
            .status();
        let status = status.expect("python3 is needed (`make setup` installs it)");
        assert!(status.success(), "{script}");
        let count = std::fs::read_dir(&written).expect("a folder").count();
        assert_eq!(count, files.len(), "{script}");
        for file in files {
            let committed = root().join("assets").join(folder).join(file);
            assert!(
                meaning(&written.join(file)) == meaning(&committed),
                "{file} is stale: run `python3 scripts/{script}`"
            );
        }
    }
}

#[test]
fn they_load_without_a_warning_and_enclose_a_volume() {
    for loaded in [drake(), bear()] {
        let name = &loaded.name;
        assert_eq!(loaded.rig.warnings(), [""; 0], "{name}");
        let mesh = &loaded.rig.meshes()[0];
        let outward = mesh.parts()[0].sides.outward_count();
        let all = mesh.triangles().len();
        // Normals turn those of sharp edges and of ends that lie inside another piece.
        assert!(
            outward.is_some_and(|outward| outward > all - all / 200),
            "{name}: {outward:?} of {all}"
        );
        let most = (0..mesh.vertex_count()).map(|vertex| mesh.influences_of(vertex).len());
        assert!(most.max() > Some(2), "{name}");
    }
}

#[test]
fn the_drake_has_what_the_formats_of_cse_169_offer() {
    let drake = drake();
    let dialects = [
        "cse169 skel",
        "cse169 skin",
        "cse169 morph",
        "cse169 anim",
        "cse169 rig",
    ];
    assert_eq!(drake.dialects, dialects);
    let rig = drake.rig;
    assert!(rig.materials()[0].texture.is_some());
    let morphs: Vec<&str> = rig.morphs().iter().map(|it| &*it.name).collect();
    assert_eq!(morphs, ["smile", "blink", "puff"]);
    let clips: Vec<&str> = rig.clips().iter().map(|it| &*it.name).collect();
    assert_eq!(clips, ["walk", "flap"]);
    let limited = rig.skeleton().joints().iter().filter(|it| it.is_limited());
    assert_eq!(limited.count(), rig.skeleton().joints().len() - 1);
}

#[test]
fn the_drake_goes_on_walking_and_flies_on_the_spot() {
    let rig = drake().rig;
    for clip in rig.clips() {
        for channel in &clip.channels {
            let Channel::Dof { dof, curve } = channel else {
                panic!("every channel sets a DOF");
            };
            let dof = &rig.dofs().all()[*dof];
            let walks_on = clip.name == "walk" && dof.name == "hips.tz";
            let [start, end] = clip.range;
            let went = curve.at(end + 0.1) - curve.at(start + 0.1);
            let wanted = if walks_on { 0.5 } else { 0.0 };
            assert!((went - wanted).abs() < 1e-3, "{}: {}", clip.name, dof.name);
        }
    }
}

#[test]
fn the_drakes_clips_keep_within_its_limits() {
    let service = support::service();
    load_samples(&service);
    for clip in ["walk", "flap"] {
        for step in 0..20 {
            let pose = json!({"clip": {"name": clip, "time": f64::from(step) * 0.05}});
            let reply =
                support::ask_ok(&service, "pose.set", json!({"rig": "drake", "pose": pose}));
            assert_eq!(reply["clamped"], json!([]), "{clip}");
        }
    }
}

#[test]
fn the_bear_has_a_joint_on_its_parent() {
    let bear = bear();
    assert_eq!(bear.dialects, ["mit6837 skel", "obj", "mit6837 attach"]);
    let joints = bear.rig.skeleton().joints();
    assert_eq!(joints[1].parent, Some(0));
    assert_eq!(joints[1].offset.to_array(), [0.0; 3]);
}
