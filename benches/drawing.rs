//! What a picture costs where there is no GPU: rigd's own renderer against wgpu on Vulkan's software driver, in one run, and one core
//! against all.
//!
//! Both through the engine, encoding included, without a socket: several requests in flight for frames a second, one for latency. Rounds
//! are taken in turn, so that whatever else the machine does meets both; what is reported are medians and the median of the ratios.

#[path = "support/capsule.rs"]
mod capsule;

use capsule::{Capsule, USUAL};
use rigd::encode::{Compression, png};
use rigd::engine::{Cancellation, Engine, FrameQuery, JobContext, LoadedRig, RendererChoice};
use rigd::formats::{File, FileRef, Source, load};
use rigd::limits::Limits;
use rigd::pose::{Pose, PoseEdit, Posed, Skinning};
use rigd::render::cpu::skin_mesh;
use rigd::scene::{
    Appearance, Background, Camera, Light, Orbit, Samples, Scene, Shape, Size, VertexQuery,
};
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

const ROUNDS: usize = 5;
const IN_FLIGHT: usize = 8;
/// How long a round of either side takes, about.
const ROUND: Duration = Duration::from_millis(400);

/// What to ask for, again and again.
#[derive(Clone)]
enum Ask {
    Png(Scene),
    Pixels(Scene),
    Vertices,
}

/// An engine with one rig, in poses that change from request to request.
struct Side {
    engine: Engine,
    rig: Arc<LoadedRig>,
    in_flight: usize,
}

impl Side {
    fn open(
        adapter: &str,
        threads: Option<usize>,
        files: &[FileRef],
        in_flight: usize,
    ) -> Option<Self> {
        let Ok(adapter) = adapter.parse();
        let choice = RendererChoice {
            adapter,
            threads: threads.and_then(NonZeroUsize::new),
            ..RendererChoice::default()
        };
        let engine = Engine::open(choice, Limits::default()).ok()?;
        let rig = engine
            .load(None, files, &Source::inline_only(), false)
            .expect("the rig loads");
        Some(Self {
            engine,
            rig,
            in_flight,
        })
    }

    fn posed(&self, index: usize) -> Arc<Posed> {
        let bend = 0.01 * (index as f64 * 0.1).sin();
        let dofs = self.rig.rig.dofs().all().iter().enumerate();
        let edit = PoseEdit {
            dofs: dofs
                .filter(|(_, dof)| dof.name.ends_with(".rz"))
                .map(|(dof, _)| (dof, bend))
                .collect(),
            ..PoseEdit::default()
        };
        let (pose, _) = Pose::rest(&self.rig.rig).edited(&edit).expect("clamped");
        Arc::new(Posed::new(&pose).expect("a small pose"))
    }

    /// Seconds a request takes, over so many.
    fn color(&self, posed: Arc<Posed>, scene: Scene) -> FrameQuery {
        let appearance = Appearance::default();
        FrameQuery::color(&self.rig, posed, Skinning::Linear, appearance, scene)
    }

    fn run(&self, ask: &Ask, requests: usize) -> f64 {
        let (sender, receiver) = sync_channel(self.in_flight);
        let start = |index: usize| {
            let posed = self.posed(index);
            let ticket = self.engine.admission().admit().expect("room");
            let context = JobContext {
                cancellation: Cancellation::default(),
                ticket,
            };
            let sender = sender.clone();
            match ask.clone() {
                Ask::Vertices => {
                    let meshes = self.rig.rig.meshes().iter().enumerate();
                    let queries = meshes.map(|(mesh, of_mesh)| VertexQuery {
                        instance: 0,
                        mesh,
                        start: 0,
                        count: of_mesh.vertex_count(),
                        positions: true,
                        normals: true,
                    });
                    let queries = queries.collect();
                    self.engine.vertices(
                        posed,
                        Skinning::Linear,
                        Shape::Posed,
                        queries,
                        context,
                        move |found| {
                            sender
                                .send(found.expect("vertices").0.len())
                                .expect("the loop waits");
                        },
                    );
                }
                Ask::Png(scene) => {
                    self.engine
                        .render(self.color(posed, scene), context, move |found| {
                            let image = &found.expect("a frame").0.images[0];
                            let file = png(image, Compression::Fast).expect("a PNG");
                            sender.send(file.len()).expect("the loop waits");
                        });
                }
                Ask::Pixels(scene) => {
                    self.engine
                        .render(self.color(posed, scene), context, move |found| {
                            let image = &found.expect("a frame").0.images[0];
                            sender.send(image.bytes.len()).expect("the loop waits");
                        });
                }
            }
        };
        let started = Instant::now();
        (0..self.in_flight.min(requests)).for_each(start);
        for done in 0..requests {
            receiver.recv().expect("an answer");
            if done + self.in_flight < requests {
                start(done + self.in_flight);
            }
        }
        started.elapsed().as_secs_f64() / requests as f64
    }
}

fn scene(rig: &LoadedRig, side: u32, closeness: f64) -> Scene {
    let size = Size::new(side, side, &Limits::default()).expect("a size within limits");
    let distance = Camera::distance_to_fit(&rig.extents.bounds(), None, size) / closeness;
    let orbit = Orbit {
        distance: Some(distance),
        ..Orbit::default()
    };
    Scene {
        size,
        samples: Samples::Four,
        camera: Camera::orbit(orbit, &rig.extents.bounds(), size).expect("a camera"),
        lights: Light::default_pair(),
        ambient: Scene::DEFAULT_AMBIENT,
        background: Background::default(),
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Milliseconds of either side, and how many times as fast the first one is.
fn compare(sides: [&Side; 2], ask: &Ask) -> [f64; 3] {
    let requests = sides.map(|side| {
        let once = side.run(ask, 2 * side.in_flight);
        ((ROUND.as_secs_f64() / once) as usize).max(2 * side.in_flight)
    });
    let rounds: Vec<[f64; 2]> = (0..ROUNDS)
        .map(|_| [0, 1].map(|side| 1e3 * sides[side].run(ask, requests[side])))
        .collect();
    let of = |side: usize| median(rounds.iter().map(|round| round[side]).collect());
    [
        of(0),
        of(1),
        median(rounds.iter().map(|round| round[1] / round[0]).collect()),
    ]
}

/// A character of many meshes that lies beside the checkout, if it does, and the same triangles at rest as a single mesh.
fn many_and_one() -> Option<[Vec<FileRef>; 2]> {
    let shared = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/rigs/gltf/BrainStem");
    let inline = |name: &str, bytes: Vec<u8>| {
        vec![FileRef::Inline(File {
            name: name.to_owned(),
            bytes: bytes.into(),
        })]
    };
    let many = inline(
        "many.glb",
        std::fs::read(format!("{shared}/BrainStem.glb")).ok()?,
    );
    let loaded = load(&many, &Source::inline_only(), &Limits::default()).expect("it loads");
    let posed = Posed::new(&Pose::rest(&Arc::new(loaded.rig))).expect("the rest pose");
    let mut text = String::new();
    let mut first = 1;
    for mesh in posed.rig().meshes() {
        let palette = posed.palette(Skinning::Linear);
        let (positions, _) = skin_mesh(mesh, palette, posed.morph_weights());
        for [x, y, z] in &positions {
            writeln!(text, "v {x} {y} {z}").expect("text takes everything");
        }
        for [a, b, c] in mesh
            .triangles()
            .iter()
            .map(|it| it.map(|corner| first + corner))
        {
            writeln!(text, "f {a} {b} {c}").expect("text takes everything");
        }
        first += positions.len() as u32;
    }
    Some([many, inline("one.obj", text.into_bytes())])
}

fn main() {
    let million = Capsule {
        rings: 1000,
        segments: 500,
        ..USUAL
    };
    let (usual, million, figure) = (USUAL.files(), million.files(), rigd::cli::figure());
    let scenes: [(&str, &[FileRef], u32, f64); 5] = [
        ("capsule 512x512", &usual, 512, 1.0),
        ("capsule 256x256", &usual, 256, 1.0),
        ("figure, textured, 512x512", &figure, 512, 1.0),
        ("close-up, 512x512", &usual, 512, 4.0),
        ("1M triangles, 1024x1024", &million, 1024, 1.0),
    ];
    let software = Side::open("llvmpipe", None, &usual, IN_FLIGHT);
    match &software {
        Some(software) => println!("against {}", software.engine.adapter()),
        None => println!("there is no software Vulkan driver to compare with"),
    }
    println!("\n| ms a request | own | software driver | times as fast |\n|---|---|---|---|");
    if software.is_some() {
        for (name, files, side, closeness) in scenes {
            let [own, other] = ["cpu", "llvmpipe"]
                .map(|adapter| Side::open(adapter, None, files, IN_FLIGHT).expect("it is there"));
            let ask = Ask::Png(scene(&own.rig, side, closeness));
            let [own, other, ratio] = compare([&own, &other], &ask);
            println!("| {name} | {own:.2} | {other:.2} | {ratio:.1} |");
        }
        let [own, other] = ["cpu", "llvmpipe"]
            .map(|adapter| Side::open(adapter, None, &usual, IN_FLIGHT).expect("it is there"));
        let [own, other, ratio] = compare([&own, &other], &Ask::Vertices);
        println!("| 10,100 positions and normals | {own:.3} | {other:.3} | {ratio:.1} |");
    }
    println!(
        "\n| ms a request, one at a time | all cores | one | times as fast |\n|---|---|---|---|"
    );
    for (name, files, side, closeness) in [
        ("capsule 1024x1024, `rgba8`", &usual, 1024, 1.0),
        ("capsule 256x256, `rgba8`", &usual, 256, 1.0),
        ("figure 1024x1024, `rgba8`", &figure, 1024, 1.0),
    ] {
        let [all, one] = [None, Some(1)]
            .map(|threads| Side::open("cpu", threads, files, 1).expect("it needs nothing"));
        let ask = Ask::Pixels(scene(&all.rig, side, closeness));
        let [all, one, ratio] = compare([&all, &one], &ask);
        println!("| {name} | {all:.2} | {one:.2} | {ratio:.2} |");
    }
    let Some(files) = many_and_one() else {
        return println!(
            "\nleft out: a character of many meshes, which does not lie in ../shared/rigs"
        );
    };
    println!("\n| ms a request, 512x512 | 59 meshes | one | times as long |\n|---|---|---|---|");
    for (name, adapter) in [("own", "cpu"), ("software driver", "llvmpipe")] {
        let sides = files
            .each_ref()
            .map(|files| Side::open(adapter, None, files, IN_FLIGHT));
        let [Some(many), Some(one)] = sides else {
            continue;
        };
        let ask = Ask::Png(scene(&many.rig, 512, 1.0));
        let [many, one, ratio] = compare([&many, &one], &ask);
        println!("| {name} | {many:.2} | {one:.2} | {:.2} |", 1.0 / ratio);
    }
}
