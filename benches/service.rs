//! What the service costs: frames a second of a bare engine loop, and of the whole service over loopback, in one run.
//!
//! The figure at 512x512 with 4 samples, as PNG, eight requests in flight, on the adapter that `RIGD_BENCH_ADAPTER` names.

use criterion::{Criterion, Throughput};
use rigd::client::Client;
use rigd::encode::{Compression, png};
use rigd::engine::{Engine, LoadedRig, RendererChoice, Terms, Urgency};
use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::protocol::frame::FrameParams;
use rigd::scene::{Background, Camera, Cull, Light, Orbit, Samples, Scene, Show, Size, Surface};
use rigd::server::{Patience, Server};
use rigd::service::Service;
use serde_json::json;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

const IN_FLIGHT: u64 = 8;
/// Rounds of each side, taken in turn so that whatever else the machine does meets both.
const ROUNDS: usize = 5;
const FRAMES_A_ROUND: u64 = 100;

fn open() -> (Engine, Arc<LoadedRig>) {
    let wanted = std::env::var("RIGD_BENCH_ADAPTER").unwrap_or_else(|_| "auto".to_owned());
    let Ok(adapter) = wanted.parse();
    let choice = RendererChoice {
        adapter,
        require_gpu: false,
        threads: None,
    };
    let engine = Engine::open(choice, Limits::default()).expect("a graphics adapter");
    let rig = engine
        .load(None, &rigd::cli::figure(), &Source::inline_only(), false)
        .expect("the figure loads");
    (engine, rig)
}

fn scene(rig: &LoadedRig) -> Scene {
    let size = Size::new(512, 512, &Limits::default()).expect("a size within limits");
    Scene {
        size,
        samples: Samples::Four,
        camera: Camera::orbit(Orbit::default(), &rig.rest_bounds, size)
            .expect("the default camera"),
        lights: Light::default_pair(),
        ambient: Scene::DEFAULT_AMBIENT,
        surface: Surface::default(),
        background: Background::default(),
        show: Show::default(),
        cull: Cull::default(),
    }
}

/// Poses, draws and encodes without JSON and sockets.
fn bare(engine: &Engine, rig: &Arc<LoadedRig>, frames: u64) -> Duration {
    let scene = scene(rig);
    let (sender, receiver) = sync_channel(IN_FLIGHT as usize);
    let start = |_| {
        let posed = Arc::new(Posed::new(&Pose::rest(&rig.rig)).expect("the rest pose"));
        let ticket = engine.admission().admit().expect("room for eight");
        let sender = sender.clone();
        let terms = Terms {
            urgency: Urgency::default(),
            ticket,
        };
        engine.render(
            rig,
            posed,
            Skinning::Linear,
            scene.clone(),
            terms,
            move |result| {
                let (frame, _) = result.expect("a frame");
                let file = png(&frame, Compression::Fast).expect("a PNG");
                sender.send(file.len()).expect("the loop waits");
            },
        );
    };
    let started = Instant::now();
    (0..IN_FLIGHT.min(frames)).for_each(start);
    for done in 0..frames {
        receiver.recv().expect("a frame");
        if done + IN_FLIGHT < frames {
            start(done);
        }
    }
    started.elapsed()
}

/// The same frames asked for over TCP, pictures attached.
fn served(address: SocketAddr, frames: u64) -> Duration {
    let mut client = Client::connect(address).expect("the server listens");
    let params = json!({"rig": "figure", "pose": {"base": "rest"}, "transport": "attach"});
    let _: FrameParams = serde_json::from_value(params.clone()).expect("valid parameters");
    let started = Instant::now();
    let mut send = || {
        client
            .send("frame.render", &params)
            .expect("the request is sent")
    };
    (0..IN_FLIGHT.min(frames)).for_each(|_| drop(send()));
    for done in 0..frames {
        client.receive().expect("a reply").outcome.expect("a frame");
        if done + IN_FLIGHT < frames {
            client
                .send("frame.render", &params)
                .expect("the request is sent");
        }
    }
    started.elapsed()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let (engine, rig) = open();
    let adapter = engine.adapter().to_string();
    let service = Service::new(engine, Source::inline_only());
    let server = Server::bind("127.0.0.1:0", Arc::clone(&service), Patience::default())
        .expect("a free port");
    let address = server.address().expect("an address");
    let stopper = server.stopper().expect("an address");
    let serving = std::thread::spawn(move || server.run());

    let mut criterion = Criterion::default().configure_from_args().sample_size(10);
    let mut group = criterion.benchmark_group("figure 512x512 4x png");
    group.throughput(Throughput::Elements(1));
    group.bench_function("engine", |b| {
        b.iter_custom(|frames| bare(service.engine(), &rig, frames))
    });
    group.bench_function("service", |b| {
        b.iter_custom(|frames| served(address, frames))
    });
    group.finish();
    criterion.final_summary();

    let rates = |time: Duration| FRAMES_A_ROUND as f64 / time.as_secs_f64();
    let rounds: Vec<(f64, f64)> = (0..ROUNDS)
        .map(|_| {
            (
                rates(bare(service.engine(), &rig, FRAMES_A_ROUND)),
                rates(served(address, FRAMES_A_ROUND)),
            )
        })
        .collect();
    let engine = median(rounds.iter().map(|round| round.0).collect());
    let service = median(rounds.iter().map(|round| round.1).collect());
    let ratio = median(
        rounds
            .iter()
            .map(|(engine, service)| service / engine)
            .collect(),
    );
    println!("\ndrawing with {adapter}");
    println!(
        "engine  {engine:7.1} frames/s\nservice {service:7.1} frames/s\nratio   {ratio:7.3} (median of {ROUNDS} rounds)"
    );
    stopper.stop();
    serving
        .join()
        .expect("the server's thread")
        .expect("the server stops in order");
}
