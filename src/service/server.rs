//! `server.*`.

use super::call::Call;
use crate::adapter::AdapterKind;
use crate::formats::FORMATS;
use crate::protocol::PROTOCOL_VERSION;
use crate::protocol::server as wire;

impl Call {
    pub(super) fn info(&self) -> wire::ServerInfo {
        let engine = self.engine();
        let adapter = engine.adapter();
        let limits = engine
            .limits()
            .entries()
            .chain(engine.capabilities().entries());
        wire::ServerInfo {
            name: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            protocol: PROTOCOL_VERSION,
            adapter: wire::Adapter {
                name: adapter.name.clone(),
                backend: adapter.backend.to_owned(),
                kind: match adapter.kind {
                    AdapterKind::Discrete => wire::AdapterKind::Discrete,
                    AdapterKind::Integrated => wire::AdapterKind::Integrated,
                    AdapterKind::Software => wire::AdapterKind::Software,
                    AdapterKind::Cpu => wire::AdapterKind::Cpu,
                },
                driver: adapter.driver.clone(),
                why: adapter.why.clone().unwrap_or_default(),
            },
            limits: limits
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
            formats: FORMATS.iter().map(|&format| format.to_owned()).collect(),
            uptime_s: self.service.started.elapsed().as_secs_f64(),
        }
    }

    pub(super) fn stats(&self) -> wire::ServerStats {
        let engine = self.engine();
        wire::ServerStats {
            queue_depth: engine.admission().depth(),
            rigs: engine.rigs().len() as u64,
            gpu_busy_ms: engine.gpu_busy().as_secs_f64() * 1e3,
            memory: wire::Memory {
                // 0 where the system does not tell.
                cpu_bytes: memory_stats::memory_stats()
                    .map_or(0, |memory| memory.physical_mem as u64),
                rigs_bytes: engine.rig_bytes(),
                gpu_bytes: engine.gpu_bytes(),
            },
            ..self.service.stats.counted()
        }
    }
}
