//! The one thread that owns the device. It takes what waits, keeps a few plans in flight, and hands results to the pool.

use super::job::{Job, Reply, Timings, Urgency};
use crate::engine::pool::Pool;
use crate::engine::{EngineError, RendererChoice};
use crate::render::gpu::{Gpu, InFlight};
use crate::render::{AdapterError, Outputs, RenderError};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

pub(super) enum Message {
    Job(Box<Job>),
    /// Rigs were unloaded.
    Sweep,
    LoseDevice,
}

/// A handle to the thread; dropping it lets the thread finish what it has and waits for that.
pub(super) struct GpuWorker {
    messages: Option<Sender<Message>>,
    thread: Option<JoinHandle<()>>,
    gpu_bytes: Arc<AtomicU64>,
}

impl GpuWorker {
    pub fn start(gpu: Gpu, choice: RendererChoice, pool: Arc<Pool>) -> Result<Self, AdapterError> {
        let adapter = gpu.adapter().to_string();
        let (messages, inbox) = channel();
        let gpu_bytes = Arc::new(AtomicU64::new(gpu.memory_bytes()));
        let thread = Thread {
            gpu: Some(gpu),
            choice,
            pool,
            inbox,
            in_flight: VecDeque::new(),
            gpu_bytes: Arc::clone(&gpu_bytes),
        };
        let spawned = std::thread::Builder::new()
            .name("renderer".to_owned())
            .spawn(move || thread.run());
        let thread = spawned.map_err(|error| AdapterError::NoDevice {
            adapter,
            reason: format!("no thread for it: {error}"),
        })?;
        Ok(Self {
            messages: Some(messages),
            thread: Some(thread),
            gpu_bytes,
        })
    }

    pub fn gpu_bytes(&self) -> u64 {
        self.gpu_bytes.load(Ordering::Relaxed)
    }

    pub fn send(&self, message: Message) {
        if let Some(messages) = &self.messages {
            // A thread that is gone drops the message, and with it answers the job.
            let _ = messages.send(message);
        }
    }
}

impl Drop for GpuWorker {
    fn drop(&mut self) {
        self.messages = None;
        if let Some(thread) = self.thread.take() {
            // It catches panics itself; should one escape, there is nobody left to tell.
            let _ = thread.join();
        }
    }
}

/// Work that the device has.
struct Started {
    in_flight: InFlight,
    urgency: Urgency,
    taken: Instant,
    started: Instant,
    reply: Reply,
}

struct Thread {
    /// `None` after a loss, until the next job opens it anew.
    gpu: Option<Gpu>,
    choice: RendererChoice,
    pool: Arc<Pool>,
    inbox: Receiver<Message>,
    in_flight: VecDeque<Started>,
    gpu_bytes: Arc<AtomicU64>,
}

/// Plans on the device at a time: one is drawn while one is read back.
const DEPTH: usize = 2;

impl Thread {
    fn run(mut self) {
        loop {
            let message = if self.in_flight.is_empty() {
                // Nothing to do but wait.
                match self.inbox.recv() {
                    Ok(message) => Some(message),
                    Err(_) => return,
                }
            } else if self.in_flight.len() < DEPTH {
                self.inbox.try_recv().ok()
            } else {
                None
            };
            match message {
                Some(Message::Job(job)) => self.start(*job),
                Some(Message::Sweep) => self.gpu.iter_mut().for_each(Gpu::sweep),
                Some(Message::LoseDevice) => self.gpu.iter().for_each(Gpu::lose_device),
                None => self.finish_oldest(),
            }
            let bytes = self.gpu.as_ref().map_or(0, Gpu::memory_bytes);
            self.gpu_bytes.store(bytes, Ordering::Relaxed);
        }
    }

    fn start(&mut self, job: Job) {
        let Job {
            plan,
            urgency,
            taken,
            reply,
        } = job;
        if let Err(error) = urgency.check() {
            return self.answer(reply, Err(error));
        }
        let started = Instant::now();
        match self.guarded(|gpu| gpu.submit(&plan)) {
            Ok(in_flight) => self.in_flight.push_back(Started {
                in_flight,
                urgency,
                taken,
                started,
                reply,
            }),
            Err(error) => self.fail(reply, error),
        }
    }

    fn finish_oldest(&mut self) {
        let Some(oldest) = self.in_flight.pop_front() else {
            return;
        };
        let Started {
            in_flight,
            urgency,
            taken,
            started,
            reply,
        } = oldest;
        match self.guarded(|gpu| gpu.finish(in_flight)) {
            Ok(outputs) => {
                let timings = Timings::of(taken, started);
                self.answer(reply, urgency.check().map(|()| (outputs, timings)));
            }
            Err(error) => self.fail(reply, error),
        }
    }

    /// Answers a job that failed. A lost device takes everything in flight with it, and is opened anew for the next.
    fn fail(&mut self, reply: Reply, error: RenderError) {
        if let RenderError::DeviceLost { .. } = error {
            eprintln!(
                "rigd: {error}; {} more requests were on it",
                self.in_flight.len()
            );
            self.gpu = None;
            for Started { reply, .. } in std::mem::take(&mut self.in_flight) {
                self.answer(reply, Err(error.clone().into()));
            }
        }
        self.answer(reply, Err(error.into()));
    }

    fn answer(&self, reply: Reply, result: Result<(Outputs, Timings), EngineError>) {
        self.pool.spawn(move || reply.send(result));
    }

    /// Runs `work` on the device, opened anew if it was lost; a driver's panic counts as a loss.
    fn guarded<T>(
        &mut self,
        work: impl FnOnce(&mut Gpu) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let lost = |reason: String| RenderError::DeviceLost { reason };
        if self.gpu.is_none() {
            let opened = Gpu::open(&self.choice.adapter, self.choice.require_gpu);
            self.gpu = Some(opened.map_err(|error| lost(error.to_string()))?);
        }
        let Some(gpu) = self.gpu.as_mut() else {
            return Err(lost("it is not open".to_owned()));
        };
        // On a panic the renderer is dropped as a whole, so nothing half-changed is seen again.
        let caught = catch_unwind(AssertUnwindSafe(|| work(gpu)));
        caught.unwrap_or_else(|_| Err(lost("the driver panicked".to_owned())))
    }
}
