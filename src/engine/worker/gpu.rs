//! The one thread that owns the device. It takes what waits, from every connection, as one submission, keeps a few of them in flight, and
//! hands results to the pool.

use super::Worker;
use super::job::{Job, Reply, Timings};
use crate::adapter::AdapterError;
use crate::engine::EngineError;
use crate::engine::thread_pool::ThreadPool;
use crate::frame::Outputs;
use crate::render::gpu::{AdapterId, Finished, Gpu, InFlight};
use crate::render::{Plan, RenderError};
use std::collections::VecDeque;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

enum Message {
    Job(Box<Job>),
    /// Rigs were unloaded.
    Sweep,
    LoseDevice,
}

/// A handle to the thread; dropping it lets the thread finish what it has and waits for that.
pub(super) struct GpuWorker {
    messages: Option<Sender<Message>>,
    thread: Option<JoinHandle<()>>,
    gauges: Arc<Gauges>,
}

/// What the thread tells of itself.
#[derive(Default)]
struct Gauges {
    bytes: AtomicU64,
    busy_nanos: AtomicU64,
}

impl GpuWorker {
    pub(super) fn start(gpu: Gpu, pool: Arc<ThreadPool>) -> Result<Self, AdapterError> {
        let adapter = gpu.adapter().to_string();
        let (messages, inbox) = channel();
        let gauges = Arc::new(Gauges::default());
        gauges.bytes.store(gpu.memory_bytes(), Ordering::Relaxed);
        let thread = Thread {
            adapter: gpu.adapter_id().clone(),
            gpu: Some(gpu),
            pool,
            inbox,
            waiting: VecDeque::new(),
            retried_alone: VecDeque::new(),
            in_flight: VecDeque::new(),
            gauges: Arc::clone(&gauges),
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
            gauges,
        })
    }

    fn send(&self, message: Message) {
        if let Some(messages) = &self.messages {
            // A thread that is gone drops the message, and with it answers the job.
            let _ = messages.send(message);
        }
    }
}

impl Worker for GpuWorker {
    fn take(&self, job: Job) {
        self.send(Message::Job(Box::new(job)));
    }

    fn sweep(&self) {
        self.send(Message::Sweep);
    }

    fn gpu_bytes(&self) -> u64 {
        self.gauges.bytes.load(Ordering::Relaxed)
    }

    fn gpu_busy(&self) -> Duration {
        Duration::from_nanos(self.gauges.busy_nanos.load(Ordering::Relaxed))
    }

    fn lose_device(&self) {
        self.send(Message::LoseDevice);
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

/// Work that the device has: one submission.
struct Started {
    in_flight: InFlight,
    jobs: Vec<Job>,
    started: Instant,
}

struct Thread {
    /// `None` after a loss, until the next job opens it anew.
    gpu: Option<Gpu>,
    /// The one that is opened anew.
    adapter: AdapterId,
    pool: Arc<ThreadPool>,
    inbox: Receiver<Message>,
    /// Jobs that nobody has looked at.
    waiting: VecDeque<Job>,
    /// Jobs of a submission that failed, by the fault of one of them: each is tried once more, by itself.
    retried_alone: VecDeque<Job>,
    in_flight: VecDeque<Started>,
    gauges: Arc<Gauges>,
}

/// Submissions on the device at a time: one is drawn while one is read back. Mesa's software driver does not care: of eight requests for
/// 64x64 at a time, depths of 1, 2 and 3 answer 178, 179 and 174 a second, and the driver is at work 95% of the time at each of them. A
/// third would only hold memory.
const DEPTH: usize = 2;

/// How long a job that comes while the device is at work waits at the most until it is submitted as well.
const SLICE: Duration = Duration::from_millis(1);

impl Thread {
    fn run(mut self) {
        while self.receive() {
            if self.in_flight.len() < DEPTH && self.has_jobs() {
                self.start();
            } else {
                self.finish_oldest();
            }
            let bytes = self.gpu.as_ref().map_or(0, Gpu::memory_bytes);
            self.gauges.bytes.store(bytes, Ordering::Relaxed);
        }
    }

    fn has_jobs(&self) -> bool {
        !self.waiting.is_empty() || !self.retried_alone.is_empty()
    }

    /// Takes in what has come; where there is nothing to do, waits for it. Returns whether there is anything left to do, ever.
    fn receive(&mut self) -> bool {
        if self.in_flight.is_empty() && !self.has_jobs() {
            match self.inbox.recv() {
                Ok(message) => self.take(message),
                Err(_) => return false,
            }
        }
        while let Ok(message) = self.inbox.try_recv() {
            self.take(message);
        }
        true
    }

    fn take(&mut self, message: Message) {
        match message {
            Message::Job(job) => self.waiting.push_back(*job),
            Message::Sweep => self.gpu.iter_mut().for_each(Gpu::sweep),
            Message::LoseDevice => self.gpu.iter().for_each(Gpu::lose_device),
        }
    }

    /// Submits as much of what waits as may go together.
    fn start(&mut self) {
        let is_alone = !self.retried_alone.is_empty();
        let queue = if is_alone {
            std::mem::take(&mut self.retried_alone)
        } else {
            std::mem::take(&mut self.waiting)
        };
        let mut queue = self.still_wanted(queue);
        let plans: Vec<&Plan> = queue.iter().map(|job| &job.plan).collect();
        if plans.is_empty() {
            return;
        }
        let started = Instant::now();
        let mut count = 1;
        let submitted = self.guarded(|gpu| {
            if !is_alone {
                count = gpu.fitting(&plans);
            }
            gpu.submit(&plans[..count])
        });
        let jobs: Vec<Job> = queue.drain(..count).collect();
        if is_alone {
            self.retried_alone = queue;
        } else {
            self.waiting = queue;
        }
        match submitted {
            Ok(in_flight) => self.in_flight.push_back(Started {
                in_flight,
                jobs,
                started,
            }),
            Err(error) => self.fail(jobs, error),
        }
    }

    /// Answers those that are not.
    fn still_wanted(&self, jobs: VecDeque<Job>) -> VecDeque<Job> {
        let wanted = |job: Job| match job.cancellation.check() {
            Ok(()) => Some(job),
            Err(error) => {
                self.answer(job.reply, Err(error));
                None
            }
        };
        jobs.into_iter().filter_map(wanted).collect()
    }

    /// Answers the jobs of the oldest submission if it is done within a slice.
    fn finish_oldest(&mut self) {
        let Some(mut oldest) = self.in_flight.pop_front() else {
            return;
        };
        match self.guarded(|gpu| gpu.wait(&mut oldest.in_flight, SLICE)) {
            Ok(true) => {}
            Ok(false) => return self.in_flight.push_front(oldest),
            Err(error) => return self.fail(oldest.jobs, error),
        }
        let Started {
            in_flight,
            jobs,
            started,
        } = oldest;
        let Finished {
            outputs,
            device_time,
        } = match self.guarded(|gpu| gpu.finish(in_flight)) {
            Ok(finished) => finished,
            Err(error) => return self.fail(jobs, error),
        };
        let busy_nanos = device_time.unwrap_or_default().as_nanos() as u64;
        self.gauges
            .busy_nanos
            .fetch_add(busy_nanos, Ordering::Relaxed);
        for (job, outputs) in jobs.into_iter().zip(outputs) {
            let timings = Timings::of(job.taken, started);
            let result = job.cancellation.check().map(|()| (outputs, timings));
            self.answer(job.reply, result);
        }
    }

    /// A lost device takes everything in flight with it, and is opened anew for the next job. Any other error is that of one job: where
    /// several shared the submission, each is tried again by itself.
    fn fail(&mut self, jobs: Vec<Job>, error: RenderError) {
        let is_lost = matches!(error, RenderError::DeviceLost { .. });
        if jobs.len() > 1 && !is_lost {
            return self.retried_alone.extend(jobs);
        }
        let mut failed = jobs;
        if is_lost {
            self.gpu = None;
            let in_flight = std::mem::take(&mut self.in_flight);
            failed.extend(in_flight.into_iter().flat_map(|started| started.jobs));
            // Where standard error cannot be written there is nobody left to tell.
            let _ = writeln!(
                std::io::stderr(),
                "rigd: {error}; {} requests were on it",
                failed.len()
            );
        }
        for job in failed {
            self.answer(job.reply, Err(error.clone().into()));
        }
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
            let opened = Gpu::reopen(&self.adapter);
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
