//! What the connections of one listener share. Never lives here: sockets.

use crate::server::shutdown::{Shutdown, Timeouts};
use crate::service::Service;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

pub(super) struct Shared {
    pub service: Arc<Service>,
    pub timeouts: Timeouts,
    pub shutdown: Shutdown,
    connections: AtomicU64,
}

impl Shared {
    pub(super) fn new(service: Arc<Service>, timeouts: Timeouts) -> Self {
        Self {
            service,
            timeouts,
            shutdown: Shutdown::new(&timeouts),
            connections: AtomicU64::new(0),
        }
    }
}

/// One of the open connections, until it is dropped.
pub(super) struct OpenConnection {
    shared: Arc<Shared>,
    /// How many were open with this one.
    pub number: u64,
}

impl OpenConnection {
    pub(super) fn count(shared: &Arc<Shared>) -> Self {
        let number = shared.connections.fetch_add(1, Ordering::SeqCst) + 1;
        shared.service.stats().opened_connection();
        Self {
            shared: Arc::clone(shared),
            number,
        }
    }
}

impl Drop for OpenConnection {
    fn drop(&mut self) {
        self.shared.connections.fetch_sub(1, Ordering::SeqCst);
        self.shared.service.stats().closed_connection();
    }
}
