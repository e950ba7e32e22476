//! How long the device worked on a submission, by its own clock. Adapters without such a clock are not asked.

use super::buffers::create;
use super::device::Device;
use std::time::Duration;
use wgpu::{BufferUsages, ComputePassTimestampWrites, QuerySet};

/// One for all submissions: each is over, and its times copied out, before the next one begins.
pub(super) struct Clock {
    times: QuerySet,
    resolved: wgpu::Buffer,
    tick_nanos: f64,
}

impl Clock {
    /// Of a start and an end, eight bytes each.
    pub(super) const BYTES: u64 = 16;

    /// `None` where the adapter has none.
    pub(super) fn new(device: &Device) -> Option<Self> {
        if !device
            .device
            .features()
            .contains(wgpu::Features::TIMESTAMP_QUERY)
        {
            return None;
        }
        let times = device.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("clock.times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        Some(Self {
            times,
            resolved: create(device, "clock.resolved", usage, Self::BYTES),
            tick_nanos: device.queue.get_timestamp_period().into(),
        })
    }

    /// Before anything else of a submission.
    pub(super) fn start(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record(encoder, 0);
    }

    /// After everything else; what is returned is then to be copied out.
    pub(super) fn stop(&self, encoder: &mut wgpu::CommandEncoder) -> &wgpu::Buffer {
        self.record(encoder, 1);
        encoder.resolve_query_set(&self.times, 0..2, &self.resolved, 0);
        &self.resolved
    }

    /// A pass that does nothing: which of the real ones comes first differs from submission to submission.
    fn record(&self, encoder: &mut wgpu::CommandEncoder, index: u32) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("clock.pass"),
            timestamp_writes: Some(ComputePassTimestampWrites {
                query_set: &self.times,
                beginning_of_pass_write_index: Some(index),
                end_of_pass_write_index: None,
            }),
        });
    }

    /// Between the two times that were copied out.
    pub(super) fn read(&self, times: &[u8]) -> Duration {
        let times = bytemuck::pod_collect_to_vec::<u8, u64>(times);
        let ticks = match times[..] {
            [start, end] => end.saturating_sub(start),
            _ => 0,
        };
        Duration::from_nanos((ticks as f64 * self.tick_nanos) as u64)
    }
}
