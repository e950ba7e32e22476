//! Are vertices where an implementation of glTF that is not ours has them? three.js poses and blends the same files at the same times.
//! Where Node or npm, what they fetch, or the models are absent, these tests say so and pass. A peer that fails is a failure.

mod support;

use rigd::service::Service;
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Arc, LazyLock, OnceLock};
use support::ask_ok;
use support::everything::good;
use support::pictures::{ask_attached, attached_bytes};
use support::rules::RULES;

/// Each test loads rigs under names of its own.
static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// How far a vertex may be off, as a part of the diagonal of the model at rest. Both sides keep positions as float32, and three lerps
/// between rotations that are near each other, where we slerp.
const TOLERANCE: f64 = 1e-4;

/// A glTF file and what lies beside it.
struct Model {
    name: String,
    file: PathBuf,
    beside: Vec<PathBuf>,
}

impl Model {
    /// The model that is the project's own.
    fn reed() -> Self {
        Self {
            name: "reed".to_owned(),
            file: support::places::repository("assets/gltf/reed.glb"),
            beside: Vec::new(),
        }
    }

    /// A folder with one glTF file and its buffers.
    fn of_folder(folder: &Path) -> Self {
        let (mut main, beside): (Vec<_>, Vec<_>) = listed(folder).into_iter().partition(|path| {
            path.extension()
                .is_some_and(|it| it == "gltf" || it == "glb")
        });
        assert_eq!(main.len(), 1, "glTF files in {}", folder.display());
        Self {
            name: base_name(folder),
            file: main.remove(0),
            beside,
        }
    }

    /// Loads it; the names of its clips, in the file's order.
    fn load(&self, service: &Arc<Service>, rig: &str) -> Vec<String> {
        let paths = std::iter::once(&self.file).chain(&self.beside);
        let files: Vec<Value> = paths
            .map(|path| {
                let content = std::fs::read(path).expect("a file that was listed can be read");
                support::with_base64(&base_name(path), &content)
            })
            .collect();
        ask_ok(service, "rig.load", json!({"name": rig, "files": files}));
        let described = ask_ok(service, "rig.describe", json!({"rig": rig}));
        let clips = described["clips"].as_array().expect("a list of clips");
        let names = clips.iter().map(|clip| clip["name"].as_str());
        names
            .map(|name| name.expect("a clip has a name").to_owned())
            .collect()
    }
}

/// Ours, and those in `../shared/rigs/gltf`, where they are.
fn models() -> Vec<Model> {
    let mut models = vec![Model::reed()];
    if let Some(rigs) = support::real_rigs() {
        models.extend(
            listed(&rigs.join("gltf"))
                .iter()
                .map(|it| Model::of_folder(it)),
        );
    }
    models
}

fn listed(folder: &Path) -> Vec<PathBuf> {
    let entries =
        std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry of the folder").path())
        .collect();
    paths.sort();
    paths
}

fn base_name(path: &Path) -> String {
    let name = path.file_name().expect("it ends in a name");
    name.to_string_lossy().into_owned()
}

/// What `positions.mjs` says lies in the file that it wrote.
#[derive(Deserialize)]
struct Contents {
    samples: Vec<Sample>,
    /// The diagonal of the box around all vertices at rest.
    size: f64,
}

#[derive(Deserialize)]
struct Sample {
    /// None: at rest.
    clips: Vec<ClipAt>,
    meshes: Vec<NodeMesh>,
}

#[derive(Debug, Deserialize)]
struct ClipAt {
    index: usize,
    time: f64,
    weight: f64,
}

#[derive(Deserialize)]
struct NodeMesh {
    node: usize,
    vertex_count: usize,
}

/// A model as the peer has it.
struct Wanted {
    contents: Contents,
    /// Of every sample, those of all meshes one after another.
    positions: Vec<Vec<[f32; 3]>>,
}

impl Wanted {
    fn of(model: &Model, peers: &Path) -> Self {
        let out = support::places::output("peers");
        std::fs::create_dir_all(&out).expect("a folder of the tests' own");
        // Tests run beside each other, some with the same model.
        let thread = std::thread::current();
        let test = thread
            .name()
            .unwrap_or("test")
            .replace(|it: char| !it.is_alphanumeric(), "_");
        let out = out.join(format!("{test}.{}.bin", model.name));
        let output = node(peers, "positions.mjs", &[&model.file, &out]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success(),
            "{}: the peer failed: {said}",
            model.name
        );
        let contents: Contents = serde_json::from_slice(&output.stdout).expect("the peer's JSON");
        let bytes = std::fs::read(&out).expect("the peer's file");
        let mut rest = points(&bytes);
        let mut positions = Vec::with_capacity(contents.samples.len());
        for sample in &contents.samples {
            let count = sample.meshes.iter().map(|mesh| mesh.vertex_count).sum();
            let behind = rest.split_off(count);
            positions.push(std::mem::replace(&mut rest, behind));
        }
        assert!(rest.is_empty(), "{}: there is more", model.name);
        Self {
            contents,
            positions,
        }
    }
}

fn points(little_endian: &[u8]) -> Vec<[f32; 3]> {
    let (points, rest) = little_endian.as_chunks::<12>();
    assert!(rest.is_empty(), "{} bytes", little_endian.len());
    let coordinate = |point: &[u8; 12], axis: usize| {
        let start = 4 * axis;
        f32::from_le_bytes([
            point[start],
            point[start + 1],
            point[start + 2],
            point[start + 3],
        ])
    };
    points
        .iter()
        .map(|point| [0, 1, 2].map(|axis| coordinate(point, axis)))
        .collect()
}

/// Where we have the vertices, of all meshes one after another. The meshes are held against those of the peer.
fn found(service: &Arc<Service>, rig: &str, clips: &[String], sample: &Sample) -> Vec<[f32; 3]> {
    let at: Vec<Value> = sample
        .clips
        .iter()
        .map(|at| json!({"name": clips[at.index], "time": at.time, "weight": at.weight}))
        .collect();
    let mut pose = json!({"base": "rest"});
    if !at.is_empty() {
        pose["clips"] = json!(at);
    }
    let request =
        json!({"rig": rig, "pose": pose, "attributes": ["positions"], "transport": "attach"});
    let (result, attached) = ask_attached(service, "mesh.vertices", &request);
    let meshes = result["meshes"].as_array().expect("a list of meshes");
    let counts: Vec<_> = meshes
        .iter()
        .map(|mesh| mesh["vertex_count"].as_u64())
        .collect();
    let wanted: Vec<_> = sample
        .meshes
        .iter()
        .map(|it| Some(it.vertex_count as u64))
        .collect();
    let nodes: Vec<_> = sample.meshes.iter().map(|it| it.node).collect();
    assert_eq!(counts, wanted, "vertices of {rig}, of the nodes {nodes:?}");
    meshes
        .iter()
        .flat_map(|mesh| points(attached_bytes(&mesh["positions"], &attached)))
        .collect()
}

/// The largest distance between a vertex and where it should be.
fn worst(found: &[[f32; 3]], wanted: &[[f32; 3]]) -> f64 {
    assert_eq!(found.len(), wanted.len(), "vertices");
    let distance = |(a, b): (&[f32; 3], &[f32; 3])| {
        let squares = a
            .iter()
            .zip(b)
            .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let distances = found.iter().zip(wanted).map(distance);
    // `f64::max` would pass over what is not a number.
    distances.fold(0.0, |worst: f64, it| {
        if it <= worst || worst.is_nan() {
            worst
        } else {
            it
        }
    })
}

fn is_close(found: &[[f32; 3]], wanted: &[[f32; 3]], size: f64) -> bool {
    worst(found, wanted) <= TOLERANCE * size
}

/// The folder of the peers, installed once in a run; `None`, and lines in the log, where that cannot be.
fn peers() -> Option<&'static Path> {
    static PEERS: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    match PEERS.get_or_init(installed) {
        Ok(folder) => Some(folder),
        Err(why) => {
            support::note(&format!(
                "SKIPPED: glTF is not compared with other implementations: {why}"
            ));
            None
        }
    }
}

fn installed() -> Result<PathBuf, String> {
    let folder = support::places::repository("tests/peers/three");
    for (program, arguments) in [
        ("node", &["--version"][..]),
        (
            "npm",
            &["ci", "--ignore-scripts", "--no-audit", "--no-fund"],
        ),
    ] {
        let output = Command::new(program)
            .args(arguments)
            .current_dir(&folder)
            .output()
            .map_err(|error| format!("`{program}` does not start: {error}"))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let command = arguments.join(" ");
            return Err(format!(
                "`{program} {command}` ended with {}: {said}",
                output.status
            ));
        }
    }
    Ok(folder)
}

fn node(peers: &Path, script: &str, arguments: &[&Path]) -> Output {
    Command::new("node")
        .arg(peers.join(script))
        .args(arguments)
        .output()
        .expect("node starts: it told its version")
}

#[test]
fn vertices_are_where_three_has_them() {
    let Some(peers) = peers() else { return };
    let mut faults = Vec::new();
    for model in models() {
        let wanted = Wanted::of(&model, peers);
        let Contents { samples, size } = &wanted.contents;
        let clips = model.load(&SERVICE, &model.name);
        // Of those that differ most, the first.
        let mut most = (0, 0.0);
        for (index, (sample, positions)) in samples.iter().zip(&wanted.positions).enumerate() {
            let difference = worst(&found(&SERVICE, &model.name, &clips, sample), positions) / size;
            if difference.is_nan() || difference > most.1 {
                most = (index, difference);
            }
        }
        let (index, difference) = most;
        let line = format!(
            "{}: {} samples, {difference:.1e} of its size at most, with {:?}",
            model.name,
            samples.len(),
            samples[index].clips
        );
        support::note(&line);
        let is_near = difference <= TOLERANCE;
        if !is_near {
            faults.push(line);
        }
        ask_ok(&SERVICE, "rig.unload", json!({"rig": model.name}));
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// A comparison that nothing fails would say nothing.
#[test]
fn what_is_moved_a_little_or_taken_at_another_time_is_told_apart() {
    let Some(peers) = peers() else { return };
    let model = Model::reed();
    let wanted = Wanted::of(&model, peers);
    let Contents { samples, size } = &wanted.contents;
    let clips = model.load(&SERVICE, "apart");
    // The first two moments of the first clip; sample 0 is the rest.
    let [found, other] = [1, 2].map(|index| found(&SERVICE, "apart", &clips, &samples[index]));
    assert!(is_close(&found, &wanted.positions[1], *size));
    assert!(!is_close(&other, &wanted.positions[1], *size));

    let step = (2.0 * TOLERANCE * size) as f32;
    let all: Vec<_> = found.iter().map(|[x, y, z]| [*x, y + step, *z]).collect();
    assert!(!is_close(&all, &wanted.positions[1], *size));
    let mut one = found.clone();
    let last = one.last_mut().expect("there are vertices");
    last[0] -= step;
    assert!(!is_close(&one, &wanted.positions[1], *size));
    let mut none = found;
    none[0][2] = f32::NAN;
    assert!(!is_close(&none, &wanted.positions[1], *size));
}

#[test]
fn the_validator_finds_nothing_wrong_with_our_model() {
    let Some(peers) = peers() else { return };
    let output = node(peers, "validate.mjs", &[&Model::reed().file]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "the validator failed: {said}");
    let issues: Value = serde_json::from_slice(&output.stdout).expect("the validator's JSON");
    let counts = ["numErrors", "numWarnings"].map(|kind| issues[kind].as_u64());
    assert_eq!(counts, [Some(0), Some(0)], "{issues}");
}

/// What we say of the same documents is held against the same table elsewhere.
#[test]
fn the_rules_that_we_know_are_those_of_the_validator() {
    let Some(peers) = peers() else { return };
    let folder = support::places::output("rules");
    std::fs::create_dir_all(&folder).expect("a folder of the tests' own");
    let written = RULES.iter().enumerate().map(|(index, rule)| {
        let mut gltf = good();
        (rule.by)(&mut gltf);
        let file = folder.join(format!("{index}.gltf"));
        std::fs::write(&file, gltf.text()).expect("it can be written");
        file
    });
    let files: Vec<_> = written.collect();
    let files: Vec<_> = files.iter().map(PathBuf::as_path).collect();
    let output = node(peers, "validate.mjs", &files);
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(said.lines().count(), RULES.len(), "{output:?}");
    for (rule, line) in RULES.iter().zip(said.lines()) {
        let issues: Value = serde_json::from_str(line).expect("the validator's JSON");
        let messages = issues["messages"].as_array().expect("a list");
        // Severity 0 is an error.
        let errors = messages.iter().filter(|it| it["severity"] == 0);
        let codes: Vec<_> = errors.filter_map(|it| it["code"].as_str()).collect();
        let is_agreed = match rule.code {
            Some(code) => codes.contains(&code),
            None => codes.is_empty(),
        };
        assert!(is_agreed, "{}: {codes:?}", rule.what);
    }
}
