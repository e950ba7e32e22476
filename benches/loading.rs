//! How fast files become rigs: megabytes a second of the readers, and the time from a file's bytes to a rig that the device has skinned.
//!
//! The built-in figure, and, where they lie beside the checkout, characters of the two courses and of glTF.

use rigd::engine::{Engine, RendererChoice, Terms, Urgency};
use rigd::formats::{File, FileRef, Source, load};
use rigd::limits::Limits;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::scene::{Shape, VertexQuery};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

/// Each figure is the median of as many.
const ROUNDS: usize = 21;

struct Character {
    name: &'static str,
    files: Vec<FileRef>,
}

impl Character {
    /// Of files that lie below `../shared/rigs`, if they do.
    fn real(name: &'static str, files: &[&str]) -> Option<Self> {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/rigs"));
        let file = |path: &&str| {
            let bytes = std::fs::read(folder.join(path)).ok()?;
            Some(FileRef::Inline(File {
                name: (*path).to_owned(),
                bytes: bytes.into(),
            }))
        };
        let files = files.iter().map(file).collect::<Option<_>>()?;
        Some(Self { name, files })
    }

    fn bytes(&self) -> usize {
        let length = |file: &FileRef| match file {
            FileRef::Inline(file) => file.bytes.len(),
            FileRef::Path(_) => 0,
        };
        self.files.iter().map(length).sum()
    }
}

fn characters() -> Vec<Character> {
    let figure = Character {
        name: "figure (built in)",
        files: rigd::cli::figure(),
    };
    let head = [
        "cse169/head/head.skel",
        "cse169/head/head_tex.skin",
        "cse169/head/head.bmp",
    ];
    let wasp = ["wasp.rig", "wasp.skel", "wasp.skin", "wasp_walk.anim"];
    let wasp = wasp.map(|file| format!("cse169/wasp_walk/{file}"));
    let wasp: Vec<&str> = wasp.iter().map(String::as_str).collect();
    let model = [
        "mit6837/Model1.skel",
        "mit6837/Model1.obj",
        "mit6837/Model1.attach",
    ];
    let real = [
        Character::real("head with texture", &head),
        Character::real("head, its skin alone", &head[..2]),
        Character::real("wasp with walk", &wasp),
        Character::real("Model1", &model),
        Character::real("Fox", &["gltf/Fox/Fox.glb"]),
        Character::real("CesiumMan", &["gltf/CesiumMan/cesium_man.gltf"]),
        Character::real("BrainStem", &["gltf/BrainStem/BrainStem.glb"]),
    ];
    if real.iter().any(Option::is_none) {
        println!("left out: characters that do not lie in ../shared/rigs");
    }
    std::iter::once(figure)
        .chain(real.into_iter().flatten())
        .collect()
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

/// From bytes to a [`rigd::rig::Rig`]: reading, digest, checks.
fn reading(character: &Character) -> Duration {
    let once = || {
        let started = Instant::now();
        let loaded = load(&character.files, &Source::inline_only(), &Limits::default());
        let taken = started.elapsed();
        drop(loaded.expect("it loads"));
        taken
    };
    median((0..ROUNDS).map(|_| once()).collect())
}

/// From bytes to skinned vertices back from the device, which has everything of the rig by then.
fn to_device(engine: &Engine, character: &Character) -> Duration {
    let once = |round: usize| {
        let name = format!("{}-{round}", character.name);
        let started = Instant::now();
        let loaded = engine.load(Some(&name), &character.files, &Source::inline_only(), false);
        let rig = Arc::clone(&loaded.expect("it loads").rig);
        let posed = Arc::new(Posed::new(&Pose::rest(&rig)).expect("the rest pose"));
        let query = VertexQuery {
            instance: 0,
            mesh: 0,
            start: 0,
            count: 1,
            positions: true,
            normals: false,
        };
        let terms = Terms {
            urgency: Urgency::default(),
            ticket: engine.admission().admit().expect("room"),
        };
        let (sender, receiver) = sync_channel(1);
        let done =
            move |result: Result<_, _>| sender.send(result.is_ok()).expect("it is waited for");
        engine.vertices(
            posed,
            Skinning::Linear,
            Shape::Posed,
            vec![query],
            terms,
            done,
        );
        assert!(receiver.recv().expect("an answer"));
        let taken = started.elapsed();
        engine.unload(&name).expect("it is loaded");
        taken
    };
    median((0..ROUNDS).map(once).collect())
}

fn main() {
    let wanted = std::env::var("RIGD_BENCH_ADAPTER").unwrap_or_else(|_| "auto".to_owned());
    let Ok(adapter) = wanted.parse();
    let choice = RendererChoice {
        adapter,
        require_gpu: false,
        threads: None,
    };
    let engine = Engine::open(choice, Limits::default()).expect("a graphics adapter");
    println!("with {}; medians of {ROUNDS}", engine.adapter());
    println!(
        "{:22} {:>8} {:>9} {:>8} {:>14}",
        "", "KB", "read ms", "MB/s", "to vertices ms"
    );
    for character in characters() {
        let (read, uploaded) = (reading(&character), to_device(&engine, &character));
        let bytes = character.bytes() as f64;
        println!(
            "{:22} {:8.0} {:9.2} {:8.0} {:14.2}",
            character.name,
            bytes / 1e3,
            read.as_secs_f64() * 1e3,
            bytes / 1e6 / read.as_secs_f64(),
            uploaded.as_secs_f64() * 1e3,
        );
    }
}
