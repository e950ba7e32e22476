//! The device and what can go wrong with it: its limits, its loss, its refusals.

use super::adapter::{self, AdapterId};
use crate::adapter::{AdapterError, AdapterInfo};
use crate::render::{Capabilities, RenderError};
use pollster::block_on;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A device that never panics the thread: what it complains of is kept until [`Device::check`].
pub(super) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: AdapterInfo,
    pub adapter_id: AdapterId,
    pub capabilities: Capabilities,
    /// Of one buffer at the most.
    pub buffer_bytes: u64,
    /// Whether shaders can read which samples of a pixel a triangle covers.
    pub has_sample_mask_input: bool,
    faults: Arc<Mutex<Faults>>,
}

#[derive(Default)]
struct Faults {
    lost: Option<String>,
    complaint: Option<RenderError>,
}

/// A device that has not finished a submission after this long never will.
const HANG: Duration = Duration::from_secs(60);

impl Device {
    pub(super) fn open(
        adapter: &wgpu::Adapter,
        adapter_id: AdapterId,
    ) -> Result<Self, AdapterError> {
        let info = adapter::info(&adapter.get_info());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("device"),
            required_limits: adapter.limits(),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = block_on(adapter.request_device(&descriptor)).map_err(|error| {
            AdapterError::NoDevice {
                adapter: info.to_string(),
                reason: error.to_string(),
            }
        })?;
        let faults = Arc::new(Mutex::new(Faults::default()));
        let complaints = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let reason = error.to_string();
            let complaint = match error {
                wgpu::Error::OutOfMemory { .. } => RenderError::OutOfMemory { reason },
                wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => {
                    RenderError::Refused { reason }
                }
            };
            lock(&complaints).complaint.get_or_insert(complaint);
        }));
        let losses = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            lock(&losses)
                .lost
                .get_or_insert(format!("{reason:?} {message}"));
        });
        let limits = device.limits();
        let buffer_bytes = limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size);
        let capabilities = Capabilities {
            side: u64::from(limits.max_texture_dimension_2d),
            buffer_bytes: Some(buffer_bytes),
        };
        Ok(Self {
            device,
            queue,
            info,
            adapter_id,
            capabilities,
            buffer_bytes,
            // naga writes GLSL that reads an array of masks as if it were one, which does not compile.
            has_sample_mask_input: adapter.get_info().backend != wgpu::Backend::Gl,
            faults,
        })
    }

    /// What the device complained of since the last call.
    ///
    /// # Errors
    /// Loss first: everything after it is a consequence.
    pub(super) fn check(&self) -> Result<(), RenderError> {
        let mut faults = lock(&self.faults);
        if let Some(reason) = faults.lost.clone() {
            return Err(RenderError::DeviceLost { reason });
        }
        faults.complaint.take().map_or(Ok(()), Err)
    }

    /// Forgets complaints about earlier work, whose own call has failed.
    ///
    /// # Errors
    /// Where the device is lost.
    pub(super) fn discard_stale_errors(&self) -> Result<(), RenderError> {
        match self.check() {
            Err(lost @ RenderError::DeviceLost { .. }) => Err(lost),
            _ => Ok(()),
        }
    }

    /// Blocks until the device has finished `submission` and every callback that it owes has run, or until `slice` is over. Returns whether
    /// it is finished; `since` is when it was first waited for.
    pub(super) fn wait(
        &self,
        submission: &wgpu::SubmissionIndex,
        slice: Duration,
        since: Instant,
    ) -> Result<bool, RenderError> {
        let polled = self.device.poll(wgpu::PollType::Wait {
            submission_index: Some(submission.clone()),
            timeout: Some(slice),
        });
        self.check()?;
        match polled {
            Ok(_) => Ok(true),
            Err(wgpu::PollError::Timeout) if since.elapsed() < HANG => Ok(false),
            Err(error) => Err(RenderError::DeviceLost {
                reason: error.to_string(),
            }),
        }
    }
}

fn lock(faults: &Mutex<Faults>) -> std::sync::MutexGuard<'_, Faults> {
    // Nothing that holds this lock can leave it half-written.
    faults.lock().unwrap_or_else(PoisonError::into_inner)
}
