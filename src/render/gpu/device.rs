//! The device and what can go wrong with it: its limits, its loss, its refusals.

use super::adapter::{self, AdapterChoice, AdapterError, AdapterInfo};
use crate::limits::LimitExceeded;
use crate::pose::SkinDualQuaternion;
use crate::render::RenderError;
use crate::rig::Rig;
use crate::scene::Size;
use pollster::block_on;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What an adapter can do at most, known without the device.
#[derive(Debug, Clone, Copy)]
pub struct Capabilities {
    side: u64,
    pub(super) buffer_bytes: u64,
}

impl Capabilities {
    fn of(limits: &wgpu::Limits) -> Self {
        Self {
            side: u64::from(limits.max_texture_dimension_2d),
            buffer_bytes: limits
                .max_buffer_size
                .min(limits.max_storage_buffer_binding_size),
        }
    }

    /// Name and value of each, as errors name them.
    pub fn entries(&self) -> [(&'static str, u64); 2] {
        [(SIDE, self.side), (BUFFER_BYTES, self.buffer_bytes)]
    }

    /// # Errors
    /// Where a picture of this size is larger than the adapter draws.
    pub fn accept_size(&self, size: Size) -> Result<(), LimitExceeded> {
        hold(SIDE, self.side, size.width.max(size.height).into())?;
        hold(BUFFER_BYTES, self.buffer_bytes, 4 * size.pixels() as u64)
    }

    /// # Errors
    /// Where a buffer or a texture of this rig is larger than the adapter takes.
    pub fn accept_rig(&self, rig: &Rig) -> Result<(), LimitExceeded> {
        let of_meshes = rig.meshes().iter().flat_map(|mesh| {
            [
                size_of_val(mesh.influences()),
                size_of_val(mesh.morph_displacements()),
                size_of_val(mesh.draw_triangles()),
            ]
        });
        // The skinned vertices of all meshes stand in one buffer, six floats each.
        let skinned = rig.vertex_count() * 24;
        let palette = rig.bindings().len() * size_of::<SkinDualQuaternion>();
        let largest = of_meshes.chain([skinned, palette]).max().unwrap_or(0);
        hold(BUFFER_BYTES, self.buffer_bytes, largest as u64)?;
        let textures = rig.materials().iter().flat_map(|m| &m.texture);
        let sides =
            textures.map(|texture| texture.levels()[0].width.max(texture.levels()[0].height));
        hold(SIDE, self.side, sides.max().unwrap_or(0).into())
    }
}

const SIDE: &str = "adapter_side";
const BUFFER_BYTES: &str = "adapter_buffer_bytes";

fn hold(limit: &'static str, maximum: u64, asked: u64) -> Result<(), LimitExceeded> {
    if asked > maximum {
        Err(LimitExceeded {
            limit,
            maximum,
            asked,
        })
    } else {
        Ok(())
    }
}

/// A device that never panics the thread: what it complains of is kept until [`Device::check`].
pub(super) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: AdapterInfo,
    pub capabilities: Capabilities,
    faults: Arc<Mutex<Faults>>,
}

#[derive(Default)]
struct Faults {
    lost: Option<String>,
    complaint: Option<RenderError>,
}

/// A device that has not finished a picture after this long never will.
const HANG: Duration = Duration::from_secs(60);

impl Device {
    pub fn open(choice: &AdapterChoice, require_gpu: bool) -> Result<Self, AdapterError> {
        let adapter = adapter::choose(choice, require_gpu)?;
        let info = adapter::info(&adapter.get_info());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("device"),
            required_limits: adapter.limits(),
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
        let capabilities = Capabilities::of(&device.limits());
        Ok(Self {
            device,
            queue,
            info,
            capabilities,
            faults,
        })
    }

    /// What the device complained of since the last call.
    ///
    /// # Errors
    /// Loss first: everything after it is a consequence.
    pub fn check(&self) -> Result<(), RenderError> {
        let mut faults = lock(&self.faults);
        if let Some(reason) = faults.lost.clone() {
            return Err(RenderError::DeviceLost { reason });
        }
        faults.complaint.take().map_or(Ok(()), Err)
    }

    /// Blocks until the device has finished `submission` and every callback that it owes has run.
    pub fn wait(&self, submission: &wgpu::SubmissionIndex) -> Result<(), RenderError> {
        let started = Instant::now();
        loop {
            // In slices, because a lost device may never report the submission.
            let slice = wgpu::PollType::Wait {
                submission_index: Some(submission.clone()),
                timeout: Some(Duration::from_millis(500)),
            };
            let polled = self.device.poll(slice);
            self.check()?;
            match polled {
                Ok(_) => return Ok(()),
                Err(wgpu::PollError::Timeout) if started.elapsed() < HANG => {}
                Err(error) => {
                    return Err(RenderError::DeviceLost {
                        reason: error.to_string(),
                    });
                }
            }
        }
    }
}

fn lock(faults: &Mutex<Faults>) -> std::sync::MutexGuard<'_, Faults> {
    // Nothing that holds this lock can leave it half-written.
    faults.lock().unwrap_or_else(PoisonError::into_inner)
}
