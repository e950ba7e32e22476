//! A reply's place in the order of its connection: taken when the request is read, filled exactly once, by whoever is first.

use super::stats::Stats;
use crate::engine::{HeldBytes, Urgency};
use crate::protocol::{Attachments, ErrorObject, Fault, Id, Method, error_line, result_line};
use serde::Serialize;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

/// A reply, ready to be written. Room for it is held until it is dropped.
pub struct Outgoing {
    /// With its end.
    pub line: Vec<u8>,
    /// Raw bytes that follow the line.
    pub attachments: Vec<Vec<u8>>,
    _held: Option<HeldBytes>,
}

/// A reply that nobody counts: as many as a connection may have in flight come to a megabyte or two.
const SMALL_REPLY_BYTES: usize = 64 << 10;

struct Slot {
    id: Id,
    method: Option<Method>,
    urgency: Urgency,
    stats: Arc<Stats>,
    state: Mutex<State>,
    filled: Condvar,
}

enum State {
    Open,
    Filled(Outgoing),
    /// Filled, and what filled it was taken away.
    Taken,
}

/// A reply that is on its way.
pub struct Pending {
    slot: Arc<Slot>,
}

/// A way to end a request early, for as long as anybody waits for it.
pub(super) struct Handle {
    slot: Weak<Slot>,
}

/// The duty to answer one request. Dropped without an answer, it answers `internal`.
pub(super) struct Answer {
    slot: Option<Arc<Slot>>,
}

impl Pending {
    /// Blocks until there is a reply; past its deadline it is `deadline_exceeded`.
    pub fn wait(self) -> Outgoing {
        loop {
            if let Some(reply) = self.wait_for(Duration::from_secs(60)) {
                return reply;
            }
        }
    }

    /// As [`Pending::wait`], for so long at most; then `None`. What it gave once it does not give again.
    pub fn wait_for(&self, patience: Duration) -> Option<Outgoing> {
        let slot = &self.slot;
        let until = Instant::now() + patience;
        let mut state = slot.lock();
        loop {
            if let State::Filled(_) = *state {
                let State::Filled(reply) = std::mem::replace(&mut *state, State::Taken) else {
                    return None;
                };
                return Some(reply);
            }
            let now = Instant::now();
            if slot
                .urgency
                .deadline
                .is_some_and(|deadline| now >= deadline)
            {
                drop(state);
                slot.fail(Fault::DeadlineExceeded);
                state = slot.lock();
                continue;
            }
            if now >= until {
                return None;
            }
            let wake = slot
                .urgency
                .deadline
                .map_or(until, |deadline| deadline.min(until));
            let waited = slot.filled.wait_timeout(state, wake - now);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Answers `shutting_down` where there is no reply yet.
    pub fn shut_down(&self) {
        self.slot.fail(Fault::ShuttingDown);
    }

    pub(super) fn handle(&self) -> Handle {
        Handle {
            slot: Arc::downgrade(&self.slot),
        }
    }
}

impl Drop for Pending {
    /// Nobody waits any more, so the work need not be done.
    fn drop(&mut self) {
        self.slot.urgency.cancelled.store(true, Ordering::Relaxed);
    }
}

impl Handle {
    pub fn is_open(&self) -> bool {
        self.slot
            .upgrade()
            .is_some_and(|slot| matches!(*slot.lock(), State::Open))
    }

    pub fn end(&self, fault: Fault) {
        if let Some(slot) = self.slot.upgrade() {
            slot.fail(fault);
        }
    }
}

impl Answer {
    pub fn new(
        id: Id,
        method: Option<Method>,
        urgency: Urgency,
        stats: &Arc<Stats>,
    ) -> (Self, Pending) {
        let (stats, filled) = (Arc::clone(stats), Condvar::new());
        let slot = Arc::new(Slot {
            id,
            method,
            urgency,
            stats,
            state: Mutex::new(State::Open),
            filled,
        });
        (
            Self {
                slot: Some(Arc::clone(&slot)),
            },
            Pending { slot },
        )
    }

    /// To a notification: it is counted and goes nowhere.
    pub fn unheard(method: Option<Method>, stats: &Arc<Stats>) -> Self {
        Self::new(Id::Null, method, Urgency::default(), stats).0
    }

    /// A result whose size is known once it is written. `hold` makes room for it.
    pub fn give<R: Serialize>(
        mut self,
        result: &R,
        hold: impl FnOnce(u64) -> Result<HeldBytes, Fault>,
    ) {
        let Some(slot) = self.slot.take() else { return };
        let line = match result_line(&slot.id, result, &Attachments::default()) {
            Ok(line) => line,
            Err(error) => {
                return slot.fail(Fault::Internal {
                    message: error.to_string(),
                });
            }
        };
        let is_small = line.len() <= SMALL_REPLY_BYTES;
        let held = if is_small {
            Ok(None)
        } else {
            hold(line.len() as u64).map(Some)
        };
        match held {
            Ok(held) => {
                slot.fill(
                    Outgoing {
                        line,
                        attachments: Vec::new(),
                        _held: held,
                    },
                    "ok",
                );
            }
            Err(fault) => slot.fail(fault),
        }
    }

    pub fn fail(mut self, fault: Fault) {
        if let Some(slot) = self.slot.take() {
            slot.fail(fault);
        }
    }

    pub fn send<R: Serialize>(
        mut self,
        result: &R,
        attachments: Attachments,
        held: Option<HeldBytes>,
    ) {
        let Some(slot) = self.slot.take() else { return };
        match result_line(&slot.id, result, &attachments) {
            Ok(line) => {
                let reply = Outgoing {
                    line,
                    attachments: attachments.into_parts(),
                    _held: held,
                };
                slot.fill(reply, "ok");
            }
            Err(error) => slot.fail(Fault::Internal {
                message: error.to_string(),
            }),
        }
    }
}

impl Drop for Answer {
    fn drop(&mut self) {
        if let Some(slot) = self.slot.take() {
            let message = "the server failed at this request; its log may say more".to_owned();
            slot.fail(Fault::Internal { message });
        }
    }
}

impl Slot {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing that holds this lock can leave the state half-written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn fail(&self, fault: Fault) {
        let kind = fault.kind();
        let line = error_line(&self.id, &ErrorObject::from(fault));
        if self.fill(
            Outgoing {
                line,
                attachments: Vec::new(),
                _held: None,
            },
            kind.name(),
        ) {
            self.urgency.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Whether this was the first.
    fn fill(&self, reply: Outgoing, outcome: &'static str) -> bool {
        let mut state = self.lock();
        let is_first = matches!(*state, State::Open);
        if is_first {
            // Counted before anybody can see the reply: whoever has it and asks for the counts finds it among them.
            self.stats.answered(self.method, outcome);
            *state = State::Filled(reply);
            self.filled.notify_all();
        }
        is_first
    }
}
