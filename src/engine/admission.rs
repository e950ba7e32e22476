//! How much work the server takes on at a time: a count of requests being worked on, and the bytes of their results.

use super::EngineError;
use crate::limits::Limits;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The two budgets that all connections share.
#[derive(Debug)]
pub struct Admission {
    requests: Budget,
    bytes: Budget,
}

#[derive(Debug)]
struct Budget {
    used: AtomicU64,
    most: u64,
}

impl Budget {
    fn new(most: u64) -> Self {
        Self {
            used: AtomicU64::new(0),
            most,
        }
    }

    fn take(&self, amount: u64) -> bool {
        let next = |used: u64| used.checked_add(amount).filter(|&next| next <= self.most);
        self.used
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, next)
            .is_ok()
    }

    fn give_back(&self, amount: u64) {
        self.used.fetch_sub(amount, Ordering::Relaxed);
    }

    fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }
}

impl Admission {
    pub(super) fn new(limits: &Limits) -> Self {
        Self {
            requests: Budget::new(limits.in_flight),
            bytes: Budget::new(limits.in_flight_bytes),
        }
    }

    /// Requests that have a ticket now.
    pub fn depth(&self) -> u64 {
        self.requests.used()
    }

    /// A place among those being worked on.
    ///
    /// # Errors
    /// [`EngineError::Busy`] where all are taken.
    pub fn admit(self: &Arc<Self>) -> Result<Ticket, EngineError> {
        if self.requests.take(1) {
            Ok(Ticket(Arc::clone(self)))
        } else {
            Err(self.busy())
        }
    }

    /// Room for a result of that size, to be held until it has been written out.
    ///
    /// # Errors
    /// [`EngineError::Busy`] where there is none now.
    pub fn hold(self: &Arc<Self>, bytes: u64) -> Result<HeldBytes, EngineError> {
        // One result that is larger than the whole budget goes through when nothing else does: limits on pictures and rigs
        // have the last word on what is too large.
        let bytes = bytes.min(self.bytes.most);
        let admission = Arc::clone(self);
        if self.bytes.take(bytes) {
            Ok(HeldBytes { admission, bytes })
        } else {
            Err(self.busy())
        }
    }

    fn busy(&self) -> EngineError {
        EngineError::Busy {
            queue_depth: self.depth(),
        }
    }
}

/// A place among the requests being worked on, given back on drop.
#[derive(Debug)]
pub struct Ticket(Arc<Admission>);

impl Drop for Ticket {
    fn drop(&mut self) {
        self.0.requests.give_back(1);
    }
}

/// Room for a result, given back on drop.
#[derive(Debug)]
pub struct HeldBytes {
    admission: Arc<Admission>,
    bytes: u64,
}

impl Drop for HeldBytes {
    fn drop(&mut self) {
        self.admission.bytes.give_back(self.bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dropped_can_be_taken_again() {
        let limits = Limits {
            in_flight: 2,
            in_flight_bytes: 100,
            ..Limits::default()
        };
        let admission = Arc::new(Admission::new(&limits));
        let first = admission.admit().unwrap();
        let _second = admission.admit().unwrap();
        assert!(matches!(
            admission.admit(),
            Err(EngineError::Busy { queue_depth: 2 })
        ));
        drop(first);
        assert!(admission.admit().is_ok());

        let held = admission.hold(60).unwrap();
        assert!(admission.hold(60).is_err());
        drop(held);
        assert!(
            admission.hold(1_000).is_ok(),
            "a single giant is let through alone"
        );
    }
}
