//! How much work the server takes on at a time: a count of requests in the works, the bytes of their results, and the bytes that they
//! bring along. Of results each connection has a quota, so that none can take everything.
//! Never lives here: what a request costs.

use super::EngineError;
use crate::limits::Limits;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The budgets that all connections share.
#[derive(Debug)]
pub struct Admission {
    requests: Budget,
    bytes: Budget,
    attached: Budget,
    bytes_per_connection: u64,
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
            attached: Budget::new(limits.attached_bytes),
            bytes_per_connection: limits.in_flight_bytes_per_connection,
        }
    }

    /// Requests that have a ticket now.
    pub fn depth(&self) -> u64 {
        self.requests.used()
    }

    /// Admits one more request.
    ///
    /// # Errors
    /// [`EngineError::Busy`] where as many are in the works as may be.
    pub fn admit(self: &Arc<Self>) -> Result<Ticket, EngineError> {
        if self.requests.take(1) {
            Ok(Ticket(Arc::new(Admitted(Arc::clone(self)))))
        } else {
            Err(self.busy())
        }
    }

    /// The quota of a new connection.
    pub fn connection_quota(self: &Arc<Self>) -> Arc<ConnectionQuota> {
        let most = self.bytes_per_connection.min(self.bytes.most);
        Arc::new(ConnectionQuota {
            admission: Arc::clone(self),
            used: Mutex::new(0),
            freed: Condvar::new(),
            most,
        })
    }

    /// Memory for bytes that a request brings along; `None` where there is none now.
    pub fn reserve_attachment(self: &Arc<Self>, bytes: u64) -> Option<AttachmentPermit> {
        let bytes = bytes.min(self.attached.most);
        self.attached.take(bytes).then(|| AttachmentPermit {
            admission: Arc::clone(self),
            bytes,
        })
    }

    fn busy(&self) -> EngineError {
        EngineError::Busy {
            queue_depth: self.depth(),
        }
    }
}

/// An admitted request, until the last clone is dropped: one for all parts of a request.
#[derive(Debug, Clone)]
pub struct Ticket(#[expect(dead_code, reason = "held to be dropped")] Arc<Admitted>);

#[derive(Debug)]
struct Admitted(Arc<Admission>);

impl Drop for Admitted {
    fn drop(&mut self) {
        self.0.requests.give_back(1);
    }
}

/// Memory for what a request brings along, given back on drop.
#[derive(Debug)]
pub struct AttachmentPermit {
    admission: Arc<Admission>,
    bytes: u64,
}

impl Drop for AttachmentPermit {
    fn drop(&mut self) {
        self.admission.attached.give_back(self.bytes);
    }
}

/// How much of the memory for results one connection may take.
#[derive(Debug)]
pub struct ConnectionQuota {
    admission: Arc<Admission>,
    used: Mutex<u64>,
    freed: Condvar,
    most: u64,
}

impl ConnectionQuota {
    /// Memory for a result of that size, to be held until it has been written out. Blocks while this connection's own results take up
    /// its quota.
    ///
    /// # Errors
    /// [`EngineError::Busy`] where the results of all connections take up everything.
    pub fn reserve(self: &Arc<Self>, bytes: u64) -> Result<MemoryPermit, EngineError> {
        // A result that is larger than the whole quota is let through alone: what is too large, limits on pictures and rigs say.
        let bytes = bytes.min(self.most);
        let used = self.used();
        let is_full = |used: &mut u64| *used + bytes > self.most;
        let mut used = self
            .freed
            .wait_while(used, is_full)
            .unwrap_or_else(PoisonError::into_inner);
        if !self.admission.bytes.take(bytes) {
            return Err(self.admission.busy());
        }
        *used += bytes;
        Ok(MemoryPermit {
            quota: Arc::clone(self),
            bytes,
        })
    }

    fn used(&self) -> MutexGuard<'_, u64> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Memory for a result, given back on drop.
#[derive(Debug)]
pub struct MemoryPermit {
    quota: Arc<ConnectionQuota>,
    bytes: u64,
}

impl MemoryPermit {
    /// Memory for so much more. It never blocks: threads of the pool call this.
    ///
    /// # Errors
    /// [`EngineError::Busy`] where the results of all connections take up everything.
    pub fn grow(&mut self, bytes: u64) -> Result<(), EngineError> {
        if !self.quota.admission.bytes.take(bytes) {
            return Err(self.quota.admission.busy());
        }
        self.bytes += bytes;
        *self.quota.used() += bytes;
        Ok(())
    }
}

impl Drop for MemoryPermit {
    fn drop(&mut self) {
        self.quota.admission.bytes.give_back(self.bytes);
        *self.quota.used() -= self.bytes;
        self.quota.freed.notify_all();
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

        let (one, other) = (admission.connection_quota(), admission.connection_quota());
        let held = one.reserve(60).unwrap();
        assert!(other.reserve(60).is_err());
        drop(held);
        assert!(
            other.reserve(1_000).is_ok(),
            "a single giant is let through alone"
        );
    }

    #[test]
    fn a_connection_waits_for_its_own_quota_and_leaves_the_rest_to_others() {
        let limits = Limits {
            in_flight_bytes: 100,
            in_flight_bytes_per_connection: 50,
            ..Limits::default()
        };
        let admission = Arc::new(Admission::new(&limits));
        let (greedy, modest) = (admission.connection_quota(), admission.connection_quota());
        let held = greedy.reserve(40).unwrap();
        let waiting = {
            let greedy = Arc::clone(&greedy);
            std::thread::spawn(move || greedy.reserve(40).is_ok())
        };
        assert!(modest.reserve(50).is_ok());
        drop(held);
        assert!(waiting.join().unwrap());
    }
}
