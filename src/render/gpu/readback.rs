//! From the device to memory: one mapped buffer a submission, holding just what was asked for, tightly packed.

use super::buffers::Readbacks;
use super::device::Device;
use super::skin::SkinnedMesh;
use crate::frame::{Frame, SkinnedVertices};
use crate::render::{Outputs, RenderError};
use crate::scene::{Size, VertexQuery};
use std::sync::mpsc;

/// Bytes to copy out.
pub(super) struct Region<'a> {
    pub source: &'a wgpu::Buffer,
    pub start: u64,
    pub bytes: u64,
}

/// How to read what was copied.
pub(super) enum Form {
    Picture(Size),
    Vertices(Vec<VertexQuery>),
}

/// Work that the device has and that nobody has waited for yet.
pub struct InFlight {
    submission: wgpu::SubmissionIndex,
    buffer: wgpu::Buffer,
    bytes: u64,
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
    form: Form,
}

/// What to copy for `queries`: positions, then normals of each, as far as asked for.
pub(super) fn regions<'a>(
    queries: &[VertexQuery],
    skinned: &[SkinnedMesh],
    vertices: &'a wgpu::Buffer,
) -> Vec<Region<'a>> {
    let mut regions = Vec::new();
    for query in queries {
        // A mesh without vertices was not skinned; its query can only be of none.
        let Some(place) = skinned.iter().find(|place| place.mesh == query.mesh) else {
            continue;
        };
        let (first, bytes) = (12 * query.start as u64, 12 * query.count as u64);
        let starts = [
            (query.positions, place.positions_start),
            (query.normals, place.normals_start),
        ];
        let wanted = starts
            .into_iter()
            .filter(|(is_wanted, _)| *is_wanted && bytes > 0);
        regions.extend(wanted.map(|(_, start)| Region {
            source: vertices,
            start: start + first,
            bytes,
        }));
    }
    regions
}

/// Records the copies, submits, and asks for the result to be mapped.
pub(super) fn start(
    device: &Device,
    readbacks: &mut Readbacks,
    mut encoder: wgpu::CommandEncoder,
    regions: &[Region<'_>],
    form: Form,
) -> InFlight {
    let bytes: u64 = regions.iter().map(|region| region.bytes).sum();
    let buffer = readbacks.lend(device, bytes.max(wgpu::COPY_BUFFER_ALIGNMENT));
    let mut end = 0;
    for &Region {
        source,
        start,
        bytes,
    } in regions
    {
        encoder.copy_buffer_to_buffer(source, start, &buffer, end, bytes);
        end += bytes;
    }
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
        form,
    }
}

impl InFlight {
    pub(super) fn finish(self, device: &Device) -> Result<(Outputs, wgpu::Buffer), RenderError> {
        device.wait(&self.submission)?;
        let refused = |reason: &dyn std::fmt::Display| RenderError::Refused {
            reason: reason.to_string(),
        };
        match self.mapped.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(refused(&error)),
            Err(error) => return Err(refused(&error)),
        }
        let outputs = if self.bytes == 0 {
            self.form.read(&[])
        } else {
            let view = self
                .buffer
                .slice(..self.bytes)
                .get_mapped_range()
                .map_err(|error| refused(&error))?;
            self.form.read(&view)
        };
        self.buffer.unmap();
        Ok((outputs, self.buffer))
    }
}

impl Form {
    fn read(&self, bytes: &[u8]) -> Outputs {
        match self {
            Self::Picture(size) => Outputs::Picture(Frame {
                size: *size,
                pixels: bytes.to_vec().into(),
            }),
            Self::Vertices(queries) => {
                let mut rest = bytes;
                let mut take = |is_wanted: bool, count: usize| {
                    is_wanted.then(|| {
                        let (taken, left) = rest.split_at(12 * count);
                        rest = left;
                        // The mapped memory need not be aligned for floats.
                        bytemuck::pod_collect_to_vec::<u8, f32>(taken).into()
                    })
                };
                let vertices = queries.iter().map(|query| SkinnedVertices {
                    vertex_count: query.count,
                    positions: take(query.positions, query.count),
                    normals: take(query.normals, query.count),
                });
                Outputs::Vertices(vertices.collect())
            }
        }
    }
}
