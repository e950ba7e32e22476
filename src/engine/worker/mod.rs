//! Who works on plans: a thread that owns the device, or the threads of the pool. Never lives here: how it is drawn.

mod cpu;
mod gpu;
mod job;
mod skin_cache;

pub(super) use job::Job;
pub use job::{Cancellation, Timings};

use super::RendererChoice;
use crate::adapter::{AdapterError, AdapterInfo};
use crate::engine::thread_pool::ThreadPool;
use crate::render::{Capabilities, Renderer};
use cpu::CpuWorker;
use gpu::GpuWorker;
use std::sync::Arc;
use std::time::Duration;

/// The owner of a renderer.
pub(super) trait Worker: Send + Sync {
    /// Works on a job some time soon, and answers it.
    fn take(&self, job: Job);

    /// Frees memory that rigs took which were unloaded.
    fn sweep(&self);

    /// Memory of the graphics device in use.
    fn gpu_bytes(&self) -> u64 {
        0
    }

    /// For how long the graphics device was at work, as far as it can tell.
    fn gpu_busy(&self) -> Duration {
        Duration::ZERO
    }

    /// Destroys the graphics device, if there is one.
    fn lose_device(&self) {}
}

/// An owner, and what its renderer says of itself.
pub(super) struct Opened {
    pub worker: Box<dyn Worker>,
    pub adapter: AdapterInfo,
    pub capabilities: Capabilities,
}

pub(super) fn open(
    choice: &RendererChoice,
    pool: &Arc<ThreadPool>,
) -> Result<Opened, AdapterError> {
    let threads = pool.thread_count();
    let (renderer, adapter, capabilities) =
        Renderer::open(&choice.adapter, choice.require_gpu, threads)?;
    let worker: Box<dyn Worker> = match renderer {
        Renderer::Gpu(gpu) => Box::new(GpuWorker::start(*gpu, Arc::clone(pool))?),
        Renderer::Cpu(cpu) => Box::new(CpuWorker::new(cpu, Arc::clone(pool))),
    };
    Ok(Opened {
        worker,
        adapter,
        capabilities,
    })
}
