//! Plans drawn on the CPU, by the threads of the pool: each that waits by a thread of its own, a lone one by all of them. Each thread
//! goes on to encode what it has drawn.

use super::job::{Job, Reply, Timings};
use crate::engine::EngineError;
use crate::engine::pool::Pool;
use crate::render::Outputs;
use crate::render::cpu::{Cores, Cpu, Spread};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

pub(super) struct CpuWorker {
    cpu: Arc<Cpu>,
    pool: Arc<Pool>,
    /// Jobs that wait or are being drawn.
    in_hand: Arc<AtomicUsize>,
}

impl CpuWorker {
    pub fn new(cpu: Cpu, pool: Arc<Pool>) -> Self {
        Self {
            cpu: Arc::new(cpu),
            pool,
            in_hand: Arc::default(),
        }
    }

    /// Lets go of memory that large rigs made necessary.
    pub fn sweep(&self) {
        self.cpu.sweep();
    }

    pub fn take(&self, job: Job) {
        let (cpu, in_hand) = (Arc::clone(&self.cpu), Arc::clone(&self.in_hand));
        in_hand.fetch_add(1, Ordering::Relaxed);
        self.pool.spawn(move || {
            let cores = match in_hand.load(Ordering::Relaxed) {
                1 => Cores::All,
                _ => Cores::One,
            };
            let (reply, result) = draw(&cpu, job, cores);
            in_hand.fetch_sub(1, Ordering::Relaxed);
            reply.send(result);
        });
    }
}

type Drawn = (Reply, Result<(Outputs, Timings), EngineError>);

fn draw(cpu: &Cpu, job: Job, cores: Cores) -> Drawn {
    let Job {
        plan,
        urgency,
        taken,
        reply,
    } = job;
    if let Err(error) = urgency.check() {
        return (reply, Err(error));
    }
    let started = Instant::now();
    // What a panic leaves half-done is room to work in, which is filled anew for each plan.
    let is_wanted = || urgency.check().is_ok();
    let caught = catch_unwind(AssertUnwindSafe(|| {
        cpu.render(&plan, Spread::over(cores, &is_wanted))
    }));
    let result = match caught {
        Ok(Some(outputs)) => Ok((outputs, Timings::of(taken, started))),
        // Whatever made it unwanted still does.
        Ok(None) => Err(urgency.check().err().unwrap_or(EngineError::Cancelled)),
        Err(_) => Err(EngineError::Internal {
            reason: "the renderer panicked".to_owned(),
        }),
    };
    (reply, result)
}
