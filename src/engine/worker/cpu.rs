//! Plans drawn on the CPU, by the threads of the pool: each that waits by a thread of its own, a lone one by all of them. Each thread
//! goes on to encode what it has drawn.

use super::job::{Job, Reply, Timings};
use crate::encode::Pool;
use crate::engine::EngineError;
use crate::render::cpu::{Cpu, Spread};
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
            let spread = match in_hand.load(Ordering::Relaxed) {
                1 => Spread::AllCores,
                _ => Spread::OneCore,
            };
            let (reply, result) = draw(&cpu, job, spread);
            in_hand.fetch_sub(1, Ordering::Relaxed);
            reply.send(result);
        });
    }
}

type Drawn = (
    Reply,
    Result<(crate::render::Outputs, Timings), EngineError>,
);

fn draw(cpu: &Cpu, job: Job, spread: Spread) -> Drawn {
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
    let caught = catch_unwind(AssertUnwindSafe(|| cpu.render(&plan, spread)));
    let result = match caught {
        Ok(outputs) => urgency.check().map(|()| {
            let timings = Timings {
                queue: started - taken,
                render: started.elapsed(),
            };
            (outputs, timings)
        }),
        Err(_) => Err(EngineError::Internal {
            reason: "the renderer panicked".to_owned(),
        }),
    };
    (reply, result)
}
