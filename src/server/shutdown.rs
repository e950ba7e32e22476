//! An orderly end: what is told of it to every connection, and how long each step may take. Never lives here: sockets.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long the server waits.
#[derive(Debug, Clone, Copy)]
pub struct Timeouts {
    /// After a stop was asked for, until requests in hand are answered with `shutting_down`.
    pub grace: Duration,
    /// For a client that takes in nothing of its reply, or stops in the middle of a message.
    pub stalled: Duration,
}

impl Default for Timeouts {
    fn default() -> Self {
        Self {
            grace: Duration::from_secs(10),
            stalled: Duration::from_secs(60),
        }
    }
}

/// After the grace time, how long requests are still read and replies still written: each is told that it came too late.
const AFTER_GRACE: Duration = Duration::from_secs(1);

/// Whether the server is to stop, and since when.
#[derive(Debug, Default)]
pub(super) struct Shutdown {
    is_asked: AtomicBool,
    asked_at: Mutex<Option<Instant>>,
    grace: Duration,
}

impl Shutdown {
    pub(super) fn new(timeouts: &Timeouts) -> Self {
        Self {
            grace: timeouts.grace,
            ..Self::default()
        }
    }

    pub(super) fn ask(&self) {
        let mut asked_at = self.asked_at.lock().unwrap_or_else(PoisonError::into_inner);
        asked_at.get_or_insert_with(Instant::now);
        drop(asked_at);
        self.is_asked.store(true, Ordering::SeqCst);
    }

    pub(super) fn is_asked(&self) -> bool {
        self.is_asked.load(Ordering::SeqCst)
    }

    /// Whether requests in hand are no longer waited for.
    pub(super) fn is_grace_over(&self) -> bool {
        self.has_passed(self.grace)
    }

    /// Whether even those are given up who are still being told that the grace time is over.
    pub(super) fn is_over(&self) -> bool {
        self.has_passed(self.grace + AFTER_GRACE)
    }

    fn has_passed(&self, time: Duration) -> bool {
        let asked_at = *self.asked_at.lock().unwrap_or_else(PoisonError::into_inner);
        asked_at.is_some_and(|asked_at| asked_at.elapsed() >= time)
    }
}
