//! Counters since the start.

use crate::engine::Timings;
use crate::protocol::Method;
use crate::protocol::frame as wire;
use crate::protocol::server::Outcomes;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// What was asked, and what was moved. Bytes and connections are counted by whoever has the sockets.
#[derive(Debug, Default)]
pub struct Stats {
    requests: Mutex<BTreeMap<&'static str, Outcomes>>,
    frames: AtomicU64,
    vertices: AtomicU64,
    /// Answers of the renderer.
    renders: AtomicU64,
    queue_micros: AtomicU64,
    render_micros: AtomicU64,
    encode_micros: AtomicU64,
    bytes_in: AtomicU64,
    bytes_out: AtomicU64,
    connections: AtomicU64,
}

/// What a request counts under whose method is not known.
const OTHER: &str = "(none)";

impl Stats {
    pub fn read_bytes(&self, count: usize) {
        self.bytes_in.fetch_add(count as u64, Ordering::Relaxed);
    }

    pub fn wrote_bytes(&self, count: usize) {
        self.bytes_out.fetch_add(count as u64, Ordering::Relaxed);
    }

    pub fn opened_connection(&self) {
        self.connections.fetch_add(1, Ordering::Relaxed);
    }

    pub fn closed_connection(&self) {
        self.connections.fetch_sub(1, Ordering::Relaxed);
    }

    pub(super) fn answered(&self, method: Option<Method>, outcome: &'static str) {
        let mut requests = self.requests.lock().unwrap_or_else(PoisonError::into_inner);
        let outcomes = requests
            .entry(method.map_or(OTHER, Method::name))
            .or_default();
        match outcome {
            "ok" => outcomes.ok += 1,
            kind => *outcomes.errors.entry(kind.to_owned()).or_default() += 1,
        }
    }

    /// Counts an answer of the renderer. What its parts took, as the wire has it.
    pub(super) fn rendered(
        &self,
        frames: u64,
        vertices: u64,
        timings: Timings,
        encode: Duration,
    ) -> wire::Timings {
        let Timings { queue, render } = timings;
        let micros = |duration: Duration| duration.as_micros() as u64;
        for (count, more) in [
            (&self.renders, 1),
            (&self.frames, frames),
            (&self.vertices, vertices),
            (&self.queue_micros, micros(queue)),
            (&self.render_micros, micros(render)),
            (&self.encode_micros, micros(encode)),
        ] {
            count.fetch_add(more, Ordering::Relaxed);
        }
        let milliseconds = |duration: Duration| duration.as_secs_f64() * 1e3;
        wire::Timings {
            queue: milliseconds(queue),
            render: milliseconds(render),
            encode: milliseconds(encode),
        }
    }

    /// The mean over every answer of the renderer so far.
    pub(super) fn mean_render(&self) -> Duration {
        let renders = self.renders.load(Ordering::Relaxed);
        Duration::from_micros(self.render_micros.load(Ordering::Relaxed) / renders.max(1))
    }

    /// The counters, with every gauge that is not kept here at 0.
    pub(super) fn counted(&self) -> crate::protocol::server::ServerStats {
        let requests = self.requests.lock().unwrap_or_else(PoisonError::into_inner);
        let requests = requests
            .iter()
            .map(|(method, outcomes)| ((*method).to_owned(), outcomes.clone()));
        crate::protocol::server::ServerStats {
            requests: requests.collect(),
            frames: self.frames.load(Ordering::Relaxed),
            vertices: self.vertices.load(Ordering::Relaxed),
            timings_ms: {
                let milliseconds = |micros: &AtomicU64| micros.load(Ordering::Relaxed) as f64 / 1e3;
                wire::Timings {
                    queue: milliseconds(&self.queue_micros),
                    render: milliseconds(&self.render_micros),
                    encode: milliseconds(&self.encode_micros),
                }
            },
            bytes_in: self.bytes_in.load(Ordering::Relaxed),
            bytes_out: self.bytes_out.load(Ordering::Relaxed),
            connections: self.connections.load(Ordering::Relaxed),
            ..crate::protocol::server::ServerStats::default()
        }
    }
}
