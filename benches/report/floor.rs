//! The least that an answer costs: the same calls of the renderer and of the encoder in a bare loop, with no service around them, no
//! queue, no JSON, and no socket but where bytes are to arrive somewhere. Never lives here: the daemon.

use crate::scenes::{Shots, Subject};
use crate::wire::drain;
use rigd::adapter::AdapterKind;
use rigd::encode::{Compression, png};
use rigd::engine::{Cancellation, Engine, FrameQuery, JobContext};
use rigd::frame::{Outputs, Raster, SkinnedVertices};
use rigd::pose::{Posed, Skinning};
use rigd::render::Plan;
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::scene::{Appearance, Shape, VertexQuery};
use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::Instant;

/// Of the adapter that the daemon draws with.
pub enum Floor<'a> {
    /// Rigd's own renderer, on as many threads as the daemon has.
    Bare { cpu: Cpu, pool: rayon::ThreadPool },
    /// A device is one thread's; what comes nearest to bare calls is the engine.
    Engine(&'a Engine),
}

/// Vertices that are skinned at a time where only skinning is timed: what comes out stays in the cache, so that asking the system for
/// memory is not timed with it.
const PORTION: usize = 16_384;

impl<'a> Floor<'a> {
    pub fn of(engine: &'a Engine) -> Self {
        if engine.adapter().kind != AdapterKind::Cpu {
            return Self::Engine(engine);
        }
        let pool = rayon::ThreadPoolBuilder::new().build();
        Self::Bare {
            cpu: Cpu::default(),
            pool: pool.expect("threads"),
        }
    }

    /// Seconds a picture, as a PNG. A lone one is drawn by all threads, of several each by one.
    pub fn frames(&self, subject: &Subject, shots: Shots, in_flight: usize, count: usize) -> f64 {
        let plan = |index| {
            let size = subject.loaded.extents.bounds().size();
            let scene = shots.scene(subject, index);
            let posed = shots.posed(subject, index);
            Plan::picture(posed, Skinning::Linear, Appearance::default(), scene, size)
        };
        match self {
            Self::Bare { cpu, pool } if in_flight == 1 => timed(count, || {
                for index in 0..count {
                    pool.install(|| encode(&picture(cpu, &plan(index), Cores::All)));
                }
            }),
            Self::Bare { cpu, pool } => timed(count, || {
                on_threads(pool.current_num_threads(), count, |next| {
                    while let Some(index) = next() {
                        encode(&picture(cpu, &plan(index), Cores::One));
                    }
                });
            }),
            Self::Engine(engine) => in_engine(in_flight, count, |index, sender| {
                let done = move |found: Result<(Outputs, _), _>| {
                    encode(&found.expect("a frame").0.images[0]);
                    sender();
                };
                let (posed, scene) = (shots.posed(subject, index), shots.scene(subject, index));
                let (loaded, appearance) = (&subject.loaded, Appearance::default());
                let query = FrameQuery::color(loaded, posed, Skinning::Linear, appearance, scene);
                engine.render(query, context(engine), done);
            }),
        }
    }

    /// Seconds that positions and normals of everything take until they are written to a socket that somebody reads from.
    pub fn vertices(&self, subject: &Subject, in_flight: usize, count: usize) -> f64 {
        match self {
            Self::Bare { cpu, pool } => timed(count, || {
                on_threads(pool.current_num_threads(), count, |next| {
                    let mut socket = drain();
                    while let Some(index) = next() {
                        let skinned = skinned(cpu, subject.posed(index), subject.queries());
                        write(&skinned, &mut socket);
                    }
                });
            }),
            Self::Engine(engine) => {
                let socket = drain();
                in_engine(in_flight, count, |index, sender| {
                    let mut socket = socket.try_clone().expect("a socket");
                    let done = move |found: Result<(Vec<SkinnedVertices>, _), _>| {
                        write(&found.expect("vertices").0, &mut socket);
                        sender();
                    };
                    let (posed, queries) = (subject.posed(index), subject.queries());
                    let context = context(engine);
                    engine.vertices(
                        posed,
                        Skinning::Linear,
                        Shape::Posed,
                        queries,
                        context,
                        done,
                    );
                })
            }
        }
    }

    /// Seconds that skinning alone takes, of one pose out of `count`. `None` where it cannot be told from reading back.
    pub fn skinning(&self, subject: &Subject, count: usize) -> Option<f64> {
        let Self::Bare { cpu, pool } = self else {
            return None;
        };
        let portions = |query: VertexQuery| {
            (0..query.count)
                .step_by(PORTION)
                .map(move |start| VertexQuery {
                    start,
                    count: PORTION.min(query.count - start),
                    ..query
                })
        };
        Some(timed(count, || {
            on_threads(pool.current_num_threads(), count, |next| {
                while let Some(index) = next() {
                    let posed = subject.posed(index);
                    for query in subject.queries().into_iter().flat_map(portions) {
                        skinned(cpu, Arc::clone(&posed), vec![query]);
                    }
                }
            });
        }))
    }
}

fn timed(count: usize, work: impl FnOnce()) -> f64 {
    let started = Instant::now();
    work();
    started.elapsed().as_secs_f64() / count as f64
}

/// `work` on so many threads, which share the numbers below `count`.
fn on_threads(threads: usize, count: usize, work: impl Fn(&dyn Fn() -> Option<usize>) + Sync) {
    let number = AtomicUsize::new(0);
    let next = || Some(number.fetch_add(1, Ordering::Relaxed)).filter(|&index| index < count);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| work(&next));
        }
    });
}

/// `start` begins one and calls what it is given once that is done; so many are kept in flight.
fn in_engine(
    in_flight: usize,
    count: usize,
    start: impl Fn(usize, Box<dyn FnOnce() + Send>),
) -> f64 {
    let (sender, receiver) = sync_channel(in_flight);
    let start = |index| {
        let sender = sender.clone();
        start(
            index,
            Box::new(move || sender.send(()).expect("the loop waits")),
        );
    };
    timed(count, || {
        (0..in_flight.min(count)).for_each(start);
        for done in 0..count {
            receiver.recv().expect("an answer");
            if done + in_flight < count {
                start(done + in_flight);
            }
        }
    })
}

fn context(engine: &Engine) -> JobContext {
    JobContext {
        cancellation: Cancellation::default(),
        ticket: engine.admission().admit().expect("room for a few"),
    }
}

fn picture(cpu: &Cpu, plan: &Plan, cores: Cores) -> Raster {
    match cpu.render(plan, Parallelism::uncancelled(cores)) {
        Some(mut outputs) => outputs.images.remove(0),
        None => unreachable!("it is wanted"),
    }
}

fn skinned(cpu: &Cpu, posed: Arc<Posed>, queries: Vec<VertexQuery>) -> Vec<SkinnedVertices> {
    let plan = Plan::vertices(posed, Skinning::Linear, Shape::Posed, queries);
    match cpu.render(&plan, Parallelism::uncancelled(Cores::One)) {
        Some(outputs) => outputs.vertices,
        None => unreachable!("it is wanted"),
    }
}

fn encode(frame: &Raster) {
    let file = png(frame, Compression::Fast).expect("a PNG");
    std::hint::black_box(file);
}

fn write(vertices: &[SkinnedVertices], socket: &mut TcpStream) {
    for mesh in vertices {
        for numbers in [&mesh.positions, &mesh.normals].into_iter().flatten() {
            let bytes: &[u8] = bytemuck::cast_slice(numbers);
            socket.write_all(bytes).expect("somebody reads");
        }
    }
}
