//! Plans drawn on the CPU, by the threads of the pool: each that waits by a thread of its own, a lone one by all of them. Each thread
//! goes on to encode what it has drawn.

use super::Worker;
use super::job::{Cancellation, Job, Timings};
use super::skin_cache::{Computation, Lookup, SkinCache};
use crate::engine::EngineError;
use crate::engine::thread_pool::ThreadPool;
use crate::frame::Outputs;
use crate::render::Plan;
use crate::render::cpu::{Cores, Cpu, Parallelism, Skinned};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// A handle; what it stands for lives as long as there is work.
pub(super) struct CpuWorker(Arc<Shared>);

struct Shared {
    cpu: Cpu,
    pool: Arc<ThreadPool>,
    skins: SkinCache,
    /// Jobs that wait or are being worked on.
    in_hand: AtomicUsize,
}

/// Influences and displacements of morph targets that are worth sharing out among the cores while other jobs wait: a millisecond's.
const HEAVY: usize = 1 << 18;

impl CpuWorker {
    pub(super) fn new(cpu: Cpu, pool: Arc<ThreadPool>) -> Self {
        Self(Arc::new(Shared {
            cpu,
            pool,
            skins: SkinCache::default(),
            in_hand: AtomicUsize::new(0),
        }))
    }
}

impl Worker for CpuWorker {
    fn take(&self, job: Job) {
        self.0.in_hand.fetch_add(1, Ordering::Relaxed);
        self.0.spawn(job);
    }

    fn sweep(&self) {
        self.0.skins.sweep();
        self.0.cpu.sweep();
    }
}

impl Shared {
    fn spawn(self: &Arc<Self>, job: Job) {
        let shared = Arc::clone(self);
        self.pool.spawn(move || shared.work(job));
    }

    fn work(self: &Arc<Self>, job: Job) {
        let started = Instant::now();
        if let Err(error) = job.cancellation.check() {
            return self.answer(job, started, Err(error));
        }
        if job.plan.image.is_none() {
            // Whoever asks for vertices alone needs no more of the skin than those: they are computed here, unless they are there.
            let first = job.plan.vertices.first();
            let skin = first.map(|query| job.plan.instances[query.instance].skin());
            let skinned = skin.and_then(|skin| self.skins.ready(skin));
            return self.finish(job, started, skinned.as_deref());
        }
        match self.skins.look_up(job) {
            Lookup::Hit(job, skinned) => self.finish(job, started, Some(&skinned)),
            Lookup::Miss(job, computation) => self.skin(job, started, &computation),
            Lookup::Waiting => {}
        }
    }

    /// Computes the skins of a job for all who wait for them, then the job.
    fn skin(self: &Arc<Self>, job: Job, started: Instant, computation: &Computation) {
        let alone = self.cores();
        let cores = match alone {
            Cores::One if skinning_work(&job.plan) < HEAVY => Cores::One,
            _ => Cores::All,
        };
        let is_cancelled = || {
            // Not what is heavy beside others: each of them would give way to the next one, deeper and deeper.
            self.give_way(alone);
            job.cancellation.check().is_err() && !self.skins.is_awaited(computation)
        };
        let parallelism = Parallelism::cancellable(cores, &is_cancelled);
        let skinned = caught(|| self.cpu.skin(&job.plan, parallelism)).map(|it| it.map(Arc::new));
        let ready = skinned.as_ref().ok().and_then(Option::as_ref);
        for waiting in self.skins.complete(computation, ready) {
            self.spawn(waiting);
        }
        match skinned {
            Ok(Some(skinned)) => self.finish(job, started, Some(&skinned)),
            Ok(None) => {
                let unwanted = unwanted(&job.cancellation);
                self.answer(job, started, Err(unwanted));
            }
            Err(error) => self.answer(job, started, Err(error)),
        }
    }

    /// Draws and copies from skinned vertices.
    fn finish(&self, job: Job, started: Instant, skinned: Option<&Skinned>) {
        let outputs = self.guarded(&job.cancellation, |parallelism| {
            self.cpu.outputs(&job.plan, skinned, parallelism)
        });
        self.answer(job, started, outputs);
    }

    fn guarded(
        &self,
        cancellation: &Cancellation,
        work: impl FnOnce(Parallelism<'_>) -> Option<Outputs>,
    ) -> Result<Outputs, EngineError> {
        let cores = self.cores();
        let is_cancelled = || {
            self.give_way(cores);
            cancellation.check().is_err()
        };
        let outputs = caught(|| work(Parallelism::cancellable(cores, &is_cancelled)))?;
        outputs.ok_or_else(|| unwanted(cancellation))
    }

    /// A job that had all cores to itself lets those that came since go first, a portion of its own at a time. None of them has, so this
    /// goes no deeper.
    fn give_way(&self, cores: Cores) {
        if cores == Cores::All && self.in_hand.load(Ordering::Relaxed) > 1 {
            self.pool.give_way();
        }
    }

    fn cores(&self) -> Cores {
        match self.in_hand.load(Ordering::Relaxed) {
            1 => Cores::All,
            _ => Cores::One,
        }
    }

    fn answer(&self, job: Job, started: Instant, outputs: Result<Outputs, EngineError>) {
        self.in_hand.fetch_sub(1, Ordering::Relaxed);
        let timings = Timings::of(job.taken, started);
        job.reply.send(outputs.map(|outputs| (outputs, timings)));
    }
}

/// What a panic leaves half-done is scratch memory, which is filled anew for each plan.
fn caught<T>(work: impl FnOnce() -> T) -> Result<T, EngineError> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| EngineError::Internal {
        reason: "the renderer panicked".to_owned(),
    })
}

/// Why work was left. Whatever made it unwanted still does.
fn unwanted(cancellation: &Cancellation) -> EngineError {
    cancellation.check().err().unwrap_or(EngineError::Cancelled)
}

/// Influences and displacements that the picture of a plan is skinned by.
fn skinning_work(plan: &Plan) -> usize {
    let drawn = plan.drawn();
    let meshes = drawn.flat_map(|(_, instance)| instance.rig().meshes());
    meshes
        .map(|mesh| mesh.influences().len() + mesh.morph_displacements().len())
        .sum()
}
