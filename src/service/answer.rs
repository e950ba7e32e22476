//! A reply's place in the order of its connection: taken when the request is read, filled exactly once, by whoever is first.

use super::stats::Stats;
use crate::engine::{HeldBytes, Urgency};
use crate::protocol::attach::Part;
use crate::protocol::{Attachments, ErrorObject, Fault, Id, Method, error_line, result_line};
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

/// A reply, ready to be written. Room for it is held until it is dropped.
pub struct Outgoing {
    /// With its end.
    pub line: Vec<u8>,
    /// Raw bytes that follow the line.
    pub attachments: Vec<Part>,
    /// Whether it is the reply itself, and not what goes ahead of it.
    pub is_last: bool,
    _held: Option<Held>,
}

/// What is given back on drop, once the bytes are written.
type Held = Box<dyn Send>;

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

#[derive(Default)]
struct State {
    /// In the order in which they are to be written.
    ahead: VecDeque<Outgoing>,
    last: Option<Outgoing>,
    /// There is a reply, whether or not it was taken away.
    is_answered: bool,
    /// Nobody waits.
    is_abandoned: bool,
}

/// A reply that is on its way.
pub struct Pending {
    slot: Arc<Slot>,
}

/// A way to end a request early, for as long as anybody waits for it.
pub(super) struct Handle {
    slot: Weak<Slot>,
}

/// A way to send something ahead of a reply.
pub(super) struct Ahead {
    slot: Arc<Slot>,
}

/// The duty to answer one request. Dropped without an answer, it answers `internal`.
pub(super) struct Answer {
    slot: Option<Arc<Slot>>,
}

impl Pending {
    /// Blocks until there is a reply, and passes over what goes ahead of it. Past its deadline it is `deadline_exceeded`.
    pub fn wait(self) -> Outgoing {
        loop {
            let next = self.wait_for(Duration::from_secs(60));
            if let Some(reply) = next.filter(|next| next.is_last) {
                return reply;
            }
        }
    }

    /// As [`Pending::wait`], for so long at most and for whatever comes next; then `None`. What it gave once it does not give again.
    pub fn wait_for(&self, patience: Duration) -> Option<Outgoing> {
        let slot = &self.slot;
        let until = Instant::now() + patience;
        let mut state = slot.lock();
        loop {
            if let Some(ahead) = state.ahead.pop_front() {
                return Some(ahead);
            }
            if let Some(reply) = state.last.take() {
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
        // Not under the lock: what is given back may have things to do.
        let mut state = self.slot.lock();
        state.is_abandoned = true;
        let ahead = std::mem::take(&mut state.ahead);
        drop(state);
        drop(ahead);
    }
}

impl Ahead {
    /// The `id` of the request.
    pub fn request(&self) -> &Id {
        &self.slot.id
    }

    /// `held` is given back once it is written. After the reply nothing is sent.
    pub fn send(&self, line: Vec<u8>, attachments: Attachments, held: Held) {
        let outgoing = Outgoing {
            line,
            attachments: attachments.into_parts(),
            is_last: false,
            _held: Some(held),
        };
        let mut state = self.slot.lock();
        if state.is_answered || state.is_abandoned {
            drop(state);
            return drop(outgoing);
        }
        state.ahead.push_back(outgoing);
        self.slot.filled.notify_all();
    }
}

impl Handle {
    pub fn is_open(&self) -> bool {
        self.slot
            .upgrade()
            .is_some_and(|slot| !slot.lock().is_answered)
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
            state: Mutex::default(),
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

    /// `None` where there is nobody to send to.
    pub fn ahead(&self) -> Option<Ahead> {
        self.slot.as_ref().map(|slot| Ahead {
            slot: Arc::clone(slot),
        })
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
                        is_last: true,
                        _held: held.map(boxed),
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
                    is_last: true,
                    _held: held.map(boxed),
                };
                slot.fill(reply, "ok");
            }
            Err(error) => slot.fail(Fault::Internal {
                message: error.to_string(),
            }),
        }
    }
}

fn boxed(held: HeldBytes) -> Held {
    Box::new(held)
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
                is_last: true,
                _held: None,
            },
            kind.name(),
        ) {
            self.urgency.cancelled.store(true, Ordering::Relaxed);
            // What was to go ahead of a result is of no more use.
            let ahead = std::mem::take(&mut self.lock().ahead);
            drop(ahead);
        }
    }

    /// Whether this was the first.
    fn fill(&self, reply: Outgoing, outcome: &'static str) -> bool {
        let mut state = self.lock();
        let is_first = !state.is_answered;
        if is_first {
            // Counted before anybody can see the reply: whoever has it and asks for the counts finds it among them.
            self.stats.answered(self.method, outcome);
            state.is_answered = true;
            state.last = Some(reply);
            self.filled.notify_all();
        }
        is_first
    }
}
