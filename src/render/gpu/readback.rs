//! From the device to memory: one mapped buffer a submission, holding just what was asked for, tightly packed, plan after plan.

use super::buffers::Readbacks;
use super::clock::Clock;
use super::device::Device;
use super::skin::SkinnedRig;
use crate::frame::{ImageKind, Outputs, Raster, SkinnedVertices};
use crate::render::{Plan, RenderError};
use crate::scene::{Size, VertexQuery};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// What a submission came to.
#[derive(Debug)]
pub struct Finished {
    /// One for each plan, in their order.
    pub outputs: Vec<Outputs>,
    /// How long the device worked on it; `None` where it cannot tell.
    pub device_time: Option<Duration>,
}

/// How to read what was copied for a plan: its rasters, then its vertices.
pub(super) struct ReadbackLayout {
    rasters: Vec<(ImageKind, Size)>,
    vertices: Vec<VertexQuery>,
}

/// Work that the device has and that nobody has waited for yet.
pub struct InFlight {
    submission: wgpu::SubmissionIndex,
    buffer: wgpu::Buffer,
    bytes: u64,
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
    layouts: Vec<ReadbackLayout>,
    /// Since when somebody does.
    waited_for_since: Option<Instant>,
}

/// A buffer to be mapped that copies are recorded into, one behind the other.
pub(super) struct Copies {
    buffer: wgpu::Buffer,
    end: u64,
}

impl Copies {
    /// With room for so many bytes.
    pub(super) fn new(device: &Device, readbacks: &mut Readbacks, bytes: u64) -> Self {
        Self {
            buffer: readbacks.lend(device, bytes),
            end: 0,
        }
    }

    pub(super) fn copy(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        source: &wgpu::Buffer,
        start: u64,
        bytes: u64,
    ) {
        encoder.copy_buffer_to_buffer(source, start, &self.buffer, self.end, bytes);
        self.end += bytes;
    }

    /// Copies for `query`: positions, then normals, as far as asked for.
    pub(super) fn copy_vertices(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        query: &VertexQuery,
        skinned: Option<&SkinnedRig<'_>>,
        vertices: &wgpu::Buffer,
    ) {
        let found = skinned.and_then(|place| Some((place, place.offset(query.mesh)?)));
        // A mesh that was not skinned was asked for nothing.
        let Some((place, offset)) = found else {
            return;
        };
        let first = offset + 12 * query.start as u64;
        let bytes = 12 * query.count as u64;
        let starts = [
            (query.positions, place.positions_start),
            (query.normals, place.normals_start),
        ];
        for (is_wanted, start) in starts {
            if is_wanted && bytes > 0 {
                self.copy(encoder, vertices, start + first, bytes);
            }
        }
    }

    /// Submits, and asks for the result to be mapped.
    pub(super) fn submit(
        self,
        device: &Device,
        encoder: wgpu::CommandEncoder,
        layouts: Vec<ReadbackLayout>,
    ) -> InFlight {
        let Self { buffer, end: bytes } = self;
        let submission = device.queue.submit([encoder.finish()]);
        let (sender, mapped) = mpsc::channel();
        buffer
            .slice(..bytes.max(wgpu::COPY_BUFFER_ALIGNMENT))
            .map_async(wgpu::MapMode::Read, move |result| {
                // Nobody may be waiting any more: then the result is of no interest.
                let _ = sender.send(result);
            });
        InFlight {
            submission,
            buffer,
            bytes,
            mapped,
            layouts,
            waited_for_since: None,
        }
    }
}

impl InFlight {
    /// Whether it is done, after so long at the most.
    pub(super) fn wait(&mut self, device: &Device, slice: Duration) -> Result<bool, RenderError> {
        let since = *self.waited_for_since.get_or_insert_with(Instant::now);
        device.wait(&self.submission, slice, since)
    }

    pub(super) fn finish(
        mut self,
        device: &Device,
        clock: Option<&Clock>,
    ) -> Result<(Finished, wgpu::Buffer), RenderError> {
        // In slices, because a lost device may never report the submission.
        while !self.wait(device, Duration::from_millis(500))? {}
        let refused = |reason: &dyn std::fmt::Display| RenderError::Refused {
            reason: reason.to_string(),
        };
        match self.mapped.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(refused(&error)),
            Err(error) => return Err(refused(&error)),
        }
        let finished = if self.bytes == 0 {
            read(&self.layouts, clock, &[])
        } else {
            let view = self
                .buffer
                .slice(..self.bytes)
                .get_mapped_range()
                .map_err(|error| refused(&error))?;
            read(&self.layouts, clock, &view)
        };
        self.buffer.unmap();
        Ok((finished, self.buffer))
    }
}

/// What plans came to, and behind it the times of the clock.
fn read(layouts: &[ReadbackLayout], clock: Option<&Clock>, bytes: &[u8]) -> Finished {
    let mut rest = bytes;
    let outputs = layouts.iter().map(|layout| {
        let (taken, left) = rest.split_at(layout.bytes() as usize);
        rest = left;
        layout.read(taken)
    });
    let outputs = outputs.collect();
    Finished {
        outputs,
        device_time: clock.map(|clock| clock.read(rest)),
    }
}

impl ReadbackLayout {
    pub(super) fn of(plan: &Plan) -> Self {
        let images = plan.image.iter();
        let rasters = images.flat_map(|image| {
            let size = image.scene.size;
            image.outputs.iter().map(move |kind| (*kind, size))
        });
        Self {
            rasters: rasters.collect(),
            vertices: plan.vertices.clone(),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let rasters = self.rasters.iter();
        let rasters = rasters.map(|(kind, size)| kind.bytes(*size) as u64);
        rasters.sum::<u64>() + self.vertices.iter().map(query_bytes).sum::<u64>()
    }

    fn read(&self, bytes: &[u8]) -> Outputs {
        let mut rest = bytes;
        let mut take = |count| {
            let (taken, left) = rest.split_at(count);
            rest = left;
            taken
        };
        let images = self.rasters.iter().map(|&(kind, size)| Raster {
            kind,
            size,
            bytes: take(kind.bytes(size)).to_vec().into(),
        });
        let images = images.collect();
        let mut vectors = |is_wanted: bool, count: usize| {
            // The mapped memory need not be aligned for floats.
            is_wanted.then(|| bytemuck::pod_collect_to_vec::<u8, f32>(take(12 * count)).into())
        };
        let vertices = self.vertices.iter().map(|query| SkinnedVertices {
            vertex_count: query.count,
            positions: vectors(query.positions, query.count),
            normals: vectors(query.normals, query.count),
        });
        Outputs {
            images,
            vertices: vertices.collect(),
        }
    }
}

/// Of what a query asks for.
pub(super) fn query_bytes(query: &VertexQuery) -> u64 {
    let attributes = u64::from(query.positions) + u64::from(query.normals);
    12 * query.count as u64 * attributes
}
