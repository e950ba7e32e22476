//! What all connections share. Never lives here: any one request.

use super::stats::Stats;
use crate::engine::Engine;
use crate::formats::Source;
use crate::limits::Limits;
use std::sync::Arc;
use std::time::Instant;

/// Everything that the daemon can be asked.
pub struct Service {
    pub(super) engine: Engine,
    pub(super) source: Source,
    pub(super) stats: Arc<Stats>,
    pub(super) started: Instant,
}

impl Service {
    /// Paths in requests are opened by way of `source`.
    pub fn new(engine: Engine, source: Source) -> Arc<Self> {
        Arc::new(Self {
            engine,
            source,
            stats: Arc::default(),
            started: Instant::now(),
        })
    }

    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    pub fn limits(&self) -> &Limits {
        self.engine.limits()
    }

    pub fn stats(&self) -> &Stats {
        &self.stats
    }
}
