//! `server.*` and `request.cancel`: what the daemon is, how it fares, and giving up on a request.
//! Never lives here: the limits themselves.

use super::frame::Timings;
use super::id::Id;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What answers, and what it allows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ServerInfo {
    /// `rigd`.
    pub name: String,
    /// Version of the program.
    pub version: String,
    /// Version of this contract.
    pub protocol: u32,
    /// The graphics adapter in use, or the daemon's own renderer.
    pub adapter: Adapter,
    /// Every ceiling by its name. An error of the kind `limit_exceeded` names one of them.
    pub limits: BTreeMap<String, u64>,
    /// The readers there are for files of rigs, by the names that `dialects` uses.
    pub formats: Vec<String>,
    /// Seconds since the server began to listen.
    pub uptime_s: f64,
}

/// What draws and skins.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Adapter {
    /// As its driver gives it, or `rigd's own renderer`.
    pub name: String,
    /// How it is reached, e.g. `vulkan`, `gl`, `metal`, `dx12`, or `cpu`.
    pub backend: String,
    /// A GPU, or the CPU with or without a graphics driver.
    #[serde(rename = "type")]
    pub kind: AdapterKind,
    /// Name and version of its driver, as far as that is known.
    pub driver: String,
    /// Why it was chosen.
    #[serde(default)]
    pub why: String,
}

/// What sort of machine draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AdapterKind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the memory of the CPU.
    Integrated,
    /// A graphics driver that runs on the CPU.
    Software,
    /// The daemon's own renderer, which needs no graphics driver.
    Cpu,
}

/// Counters since the start and gauges of this moment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ServerStats {
    /// How requests went, by method.
    pub requests: BTreeMap<String, Outcomes>,
    /// Pictures drawn.
    pub frames: u64,
    /// Vertices skinned, for pictures and for queries.
    pub vertices: u64,
    /// Time that all of that took, in milliseconds; several requests at a time count several times.
    #[serde(default)]
    pub timings_ms: Timings,
    /// Time that the graphics device was at work, by its own clock, in milliseconds; 0 where there is none or it has no clock.
    #[serde(default)]
    pub gpu_busy_ms: f64,
    /// Bytes read from all connections.
    pub bytes_in: u64,
    /// Bytes written to all connections.
    pub bytes_out: u64,
    /// Requests of all connections that are admitted and not answered yet.
    pub queue_depth: u64,
    /// Connections open now.
    pub connections: u64,
    /// Rigs loaded now.
    pub rigs: u64,
    /// Of the process, of the rigs and of the graphics device, in bytes.
    pub memory: Memory,
}

/// How the requests of one method went.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Outcomes {
    /// Answered with a result.
    pub ok: u64,
    /// Answered with an error, by the error's kind.
    pub errors: BTreeMap<String, u64>,
}

/// What is held now, in bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Memory {
    /// Resident memory of the whole process; 0 where the system does not give it.
    pub cpu_bytes: u64,
    /// Estimate of what the loaded rigs take of it.
    pub rigs_bytes: u64,
    /// Memory of the graphics device; 0 where there is none.
    pub gpu_bytes: u64,
}

/// Which request to give up on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cancel {
    /// The `id` of an earlier request of the same connection. One that is answered already, or was never sent, is passed over.
    pub request: Id,
}
