//! One request on its way through its handler: what it may use. Never lives here: any one method.

use super::state::Service;
use crate::engine::{Cancellation, ConnectionQuota, Engine, EngineError, JobContext, MemoryPermit};
use crate::formats::Source;
use crate::protocol::Fault;
use bytes::Bytes;
use std::sync::Arc;

/// Sooner than this nobody need ask again, whatever it was that the server had too much of.
const LEAST_RETRY_MS: u64 = 50;

#[derive(Clone)]
pub(super) struct Call {
    pub service: Arc<Service>,
    /// Raw bytes that came along.
    pub attached: Bytes,
    pub cancellation: Cancellation,
    pub quota: Arc<ConnectionQuota>,
}

impl Call {
    pub(super) fn engine(&self) -> &Engine {
        &self.service.engine
    }

    pub(super) fn source(&self) -> &Source {
        &self.service.source
    }

    /// Admits the request: memory for its result, and what accompanies its job in the engine. Blocks as [`Call::reserve`].
    ///
    /// # Errors
    /// [`Fault::Busy`].
    pub(super) fn admit(&self, bytes: u64) -> Result<(MemoryPermit, JobContext), Fault> {
        let memory = self.reserve(bytes)?;
        let ticket = self.engine().admission().admit();
        let ticket = ticket.map_err(|error| self.busy(error))?;
        Ok((
            memory,
            JobContext {
                cancellation: self.cancellation.clone(),
                ticket,
            },
        ))
    }

    /// Memory for a result of that size. Blocks while this connection's own results take up its quota.
    ///
    /// # Errors
    /// [`Fault::Busy`].
    pub(super) fn reserve(&self, bytes: u64) -> Result<MemoryPermit, Fault> {
        self.quota.reserve(bytes).map_err(|error| self.busy(error))
    }

    /// With a guess at when the renderer will have room again.
    pub(super) fn busy(&self, error: EngineError) -> Fault {
        match error {
            EngineError::Busy { queue_depth } => {
                let drained = self.service.stats.mean_render()
                    * u32::try_from(queue_depth).unwrap_or(u32::MAX)
                    / 2;
                let retry_after_ms = (drained.as_millis() as u64).clamp(LEAST_RETRY_MS, 5_000);
                Fault::Busy {
                    retry_after_ms,
                    queue_depth,
                }
            }
            other => other.into(),
        }
    }
}
