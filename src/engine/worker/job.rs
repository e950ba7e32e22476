//! A plan and who waits for its outputs. Never lives here: who works on it.

use crate::engine::{EngineError, JobContext, Ticket};
use crate::frame::Outputs;
use crate::render::Plan;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How a job's outputs, or what kept it from having any, reach whoever asked.
pub(in crate::engine) type Answered =
    Box<dyn FnOnce(Result<(Outputs, Timings), EngineError>) + Send>;

/// What a job's time went into.
#[derive(Debug, Clone, Copy, Default)]
pub struct Timings {
    /// From being taken on to being given to the renderer.
    pub queue: Duration,
    /// From there to its outputs in memory.
    pub render: Duration,
}

impl Timings {
    /// Of a job that is done now.
    pub(super) fn of(taken: Instant, started: Instant) -> Self {
        Self {
            queue: started - taken,
            render: started.elapsed(),
        }
    }
}

/// Whether an answer is still of interest. Cancellation is sticky, and a clone is the same one.
#[derive(Debug, Clone, Default)]
pub struct Cancellation {
    /// When the answer is of no more use; `None` is never.
    pub deadline: Option<Instant>,
    /// Set to true where the answer is not wanted any more.
    pub cancelled: Arc<AtomicBool>,
}

impl Cancellation {
    /// # Errors
    /// [`EngineError::Cancelled`] or [`EngineError::DeadlineExceeded`], once that is so.
    pub fn check(&self) -> Result<(), EngineError> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(EngineError::Cancelled);
        }
        match self.deadline {
            Some(deadline) if Instant::now() >= deadline => Err(EngineError::DeadlineExceeded),
            _ => Ok(()),
        }
    }
}

/// A plan and who waits for it. Answered exactly once: on drop at the latest.
pub(in crate::engine) struct Job {
    pub plan: Plan,
    pub cancellation: Cancellation,
    pub taken: Instant,
    pub reply: Reply,
}

pub(in crate::engine) struct Reply {
    done: Option<Answered>,
    /// Held until the answer is about to be given, so that whoever gets it finds the place free.
    ticket: Option<Ticket>,
}

impl Reply {
    pub(crate) fn send(mut self, result: Result<(Outputs, Timings), EngineError>) {
        self.answer(result);
    }

    fn answer(&mut self, result: Result<(Outputs, Timings), EngineError>) {
        self.ticket = None;
        if let Some(done) = self.done.take() {
            done(result);
        }
    }
}

impl Drop for Reply {
    fn drop(&mut self) {
        self.answer(Err(EngineError::ShuttingDown));
    }
}

impl Job {
    pub(crate) fn new(plan: Plan, context: JobContext, done: Answered) -> Self {
        let JobContext {
            cancellation,
            ticket,
        } = context;
        let reply = Reply {
            done: Some(done),
            ticket: Some(ticket),
        };
        Self {
            plan,
            cancellation,
            taken: Instant::now(),
            reply,
        }
    }
}
