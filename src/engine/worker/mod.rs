//! Who draws: a thread that owns the device, or the threads of the pool. Never lives here: how it is drawn.

mod cpu;
mod gpu;
mod job;
mod skins;

pub(super) use job::Job;
pub use job::{Timings, Urgency};

use super::RendererChoice;
use crate::engine::pool::Pool;
use crate::render::{AdapterError, AdapterInfo, Capabilities, Renderer};
use cpu::CpuWorker;
use gpu::{GpuWorker, Message};
use std::sync::Arc;
use std::time::Duration;

pub(super) struct Worker {
    of: Kind,
    pool: Arc<Pool>,
    adapter: AdapterInfo,
    capabilities: Capabilities,
}

enum Kind {
    Gpu(GpuWorker),
    Cpu(CpuWorker),
}

impl Worker {
    pub fn open(choice: RendererChoice, pool: Pool) -> Result<Self, AdapterError> {
        let pool = Arc::new(pool);
        let threads = pool.thread_count();
        let (renderer, adapter, capabilities) =
            Renderer::open(&choice.adapter, choice.require_gpu, threads)?;
        let of = match renderer {
            Renderer::Gpu(gpu) => Kind::Gpu(GpuWorker::start(*gpu, choice, Arc::clone(&pool))?),
            Renderer::Cpu(cpu) => Kind::Cpu(CpuWorker::new(cpu, Arc::clone(&pool))),
        };
        Ok(Self {
            of,
            pool,
            adapter,
            capabilities,
        })
    }

    pub fn pool(&self) -> &Pool {
        &self.pool
    }

    pub fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }

    pub fn capabilities(&self) -> Capabilities {
        self.capabilities
    }

    /// Memory of the graphics device in use.
    pub fn gpu_bytes(&self) -> u64 {
        match &self.of {
            Kind::Gpu(worker) => worker.gpu_bytes(),
            Kind::Cpu(_) => 0,
        }
    }

    /// For how long the graphics device was at work, as far as it can tell.
    pub fn gpu_busy(&self) -> Duration {
        match &self.of {
            Kind::Gpu(worker) => worker.gpu_busy(),
            Kind::Cpu(_) => Duration::ZERO,
        }
    }

    pub fn take(&self, job: Job) {
        match &self.of {
            Kind::Gpu(worker) => worker.send(Message::Job(Box::new(job))),
            Kind::Cpu(worker) => worker.take(job),
        }
    }

    /// Frees memory that rigs took which were unloaded.
    pub fn sweep(&self) {
        match &self.of {
            Kind::Gpu(worker) => worker.send(Message::Sweep),
            Kind::Cpu(worker) => worker.sweep(),
        }
    }

    /// On the CPU there is none to lose.
    pub fn lose_device(&self) {
        if let Kind::Gpu(worker) = &self.of {
            worker.send(Message::LoseDevice);
        }
    }
}
