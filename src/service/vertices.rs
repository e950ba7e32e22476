//! Vertices and joints of a pose: what is asked for, working it out, and packing it. Never lives here: which poses.

use super::arrays::little_endian;
use super::call::Call;
use super::describe;
use super::names::unknown;
use super::prepared_pose::EvaluatedPose;
use crate::engine::{JobContext, RigRef, Timings};
use crate::frame::{Pooled, SkinnedVertices};
use crate::pose::{Posed, Skinning};
use crate::protocol::batch::MeshItem;
use crate::protocol::blob::{ArrayTransport, Blob, Dtype};
use crate::protocol::frame::Timings as TimingsMs;
use crate::protocol::mesh as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Attachments, Fault, FieldFault};
use crate::rig::Rig;
use crate::scene::{Bounds, Shape, VertexQuery};
use glam::DMat4;
use std::sync::Arc;
use std::time::Instant;

/// How many times its own bytes an array takes at the most on its way out: bare, and again as text.
pub(super) const BYTES_PER_BYTE: u64 = 5;

/// What is asked for of each pose.
pub(super) struct PreparedVertices {
    pub rig: Arc<RigRef>,
    /// Positions in any case: the bounds are made of them.
    pub queries: Vec<VertexQuery>,
    /// Whether positions are sent.
    pub positions: bool,
    pub joints: bool,
    pub skinning: Skinning,
    pub shape: Shape,
    pub transport: ArrayTransport,
}

impl PreparedVertices {
    /// Bytes until it is written.
    pub(super) fn bytes(&self) -> u64 {
        BYTES_PER_BYTE * self.bare_bytes(24)
    }

    /// Bytes as it is written.
    pub(super) fn written_bytes(&self) -> u64 {
        let normals = self.queries.iter().any(|query| query.normals);
        let bare = self.bare_bytes(12 * (usize::from(self.positions) + usize::from(normals)));
        match self.transport {
            ArrayTransport::Attach => bare,
            ArrayTransport::Json | ArrayTransport::Base64 => BYTES_PER_BYTE * bare,
        }
    }

    fn bare_bytes(&self, bytes_per_vertex: usize) -> u64 {
        let joints = if self.joints {
            self.rig.loaded.rig.skeleton().joints().len()
        } else {
            0
        };
        (bytes_per_vertex * self.vertex_count() + 64 * joints) as u64
    }

    fn vertex_count(&self) -> usize {
        self.queries.iter().map(|query| query.count).sum()
    }
}

impl Call {
    /// Skins what is asked for in a pose, and packs it. `done` runs once.
    pub(super) fn skin(
        &self,
        asked: Arc<PreparedVertices>,
        pose: EvaluatedPose,
        context: JobContext,
        done: impl FnOnce(Result<PackedVertices, Fault>) + Send + 'static,
    ) {
        let EvaluatedPose { posed, clamped } = pose;
        let stats = Arc::clone(&self.service.stats);
        let (skinning, shape, queries) = (asked.skinning, asked.shape, asked.queries.clone());
        let looked_at = Arc::clone(&posed);
        let pack = move |(skinned, timings): (Vec<SkinnedVertices>, Timings)| {
            let started = Instant::now();
            let joints = asked.joints.then(|| transforms(&looked_at));
            let bounds = skinned.iter().filter_map(SkinnedVertices::bounds);
            let bounds = bounds.reduce(|all, one| all.and(&one));
            let encode = started.elapsed();
            PackedVertices {
                skinned,
                bounds: bounds.unwrap_or(Bounds::ORIGIN),
                joints,
                clamped,
                timings: stats.rendered(0, asked.vertex_count() as u64, timings, encode),
                asked,
            }
        };
        if queries.is_empty() {
            // Only joints, which are there already.
            self.engine().spawn(move || {
                let checked = context.cancellation.check().map_err(Fault::from);
                done(checked.map(|()| pack((Vec::new(), Timings::default()))));
            });
        } else {
            let engine = self.engine();
            engine.vertices(posed, skinning, shape, queries, context, move |result| {
                done(result.map_err(Fault::from).map(pack));
            });
        }
    }
}

/// A pose worked out, ready to be sent.
pub(super) struct PackedVertices {
    pub asked: Arc<PreparedVertices>,
    /// One for each query.
    skinned: Vec<SkinnedVertices>,
    /// Of all of them.
    pub bounds: Bounds,
    joints: Option<Vec<f32>>,
    clamped: Vec<Clamped>,
    timings: TimingsMs,
}

impl PackedVertices {
    /// Its bytes go into `attachments` where they are to be attached.
    pub(super) fn sent(self, attachments: &mut Attachments) -> MeshItem {
        let Self {
            asked,
            skinned,
            bounds,
            joints,
            clamped,
            timings,
        } = self;
        let rig = &asked.rig.loaded.rig;
        let mut blob = |numbers: Pooled<Vec<f32>>, shape: [usize; 2]| {
            let bytes = little_endian(numbers);
            Blob::array(Dtype::Float32, bytes, &shape, asked.transport, attachments)
        };
        let meshes = asked.queries.iter().zip(skinned).map(|(query, skinned)| {
            let count = skinned.vertex_count;
            let positions = skinned.positions.filter(|_| asked.positions);
            wire::MeshVertices {
                name: rig.meshes()[query.mesh].name().to_owned(),
                vertex_count: count as u64,
                positions: positions.map(|numbers| blob(numbers, [count, 3])),
                normals: skinned.normals.map(|numbers| blob(numbers, [count, 3])),
            }
        });
        let meshes = meshes.collect();
        MeshItem {
            meshes,
            bounds: (!asked.queries.is_empty()).then(|| describe::bounds(&bounds)),
            joints: joints.map(|numbers| blob(numbers.into(), [rig.skeleton().joints().len(), 16])),
            clamped,
            timings_ms: timings,
        }
    }
}

fn transforms(posed: &Posed) -> Vec<f32> {
    let joints = posed.world_from_joint().iter();
    let matrices = joints.map(|&world_from_joint| DMat4::from(world_from_joint).as_mat4());
    matrices.flat_map(|matrix| matrix.to_cols_array()).collect()
}

pub(super) fn shape(state: wire::VertexState) -> Shape {
    match state {
        wire::VertexState::Posed => Shape::Posed,
        wire::VertexState::Bind => Shape::Bind,
    }
}

/// What to ask the renderer for.
pub(super) fn queries(
    mesh: Option<&str>,
    range: Option<wire::Range>,
    normals: bool,
    rig: &Rig,
) -> Result<Vec<VertexQuery>, FieldFault> {
    let meshes = rig.meshes();
    let chosen: Vec<usize> = match mesh {
        None => (0..meshes.len()).collect(),
        Some(name) => {
            let index = meshes.iter().position(|mesh| mesh.name() == name);
            let known = meshes.iter().map(|mesh| mesh.name());
            let unknown = || FieldFault::new("mesh", unknown("mesh", name, known));
            vec![index.ok_or_else(unknown)?]
        }
    };
    let query = |mesh, start, count| VertexQuery {
        instance: 0,
        mesh,
        start,
        count,
        positions: true,
        normals,
    };
    match (range, chosen.as_slice()) {
        (None, _) => Ok(chosen
            .iter()
            .map(|&mesh| query(mesh, 0, meshes[mesh].vertex_count()))
            .collect()),
        (Some(wire::Range { start, count }), &[mesh]) => {
            let has = meshes[mesh].vertex_count();
            let part = usize::try_from(start).ok().zip(usize::try_from(count).ok());
            let inside = part
                .filter(|(start, count)| start.checked_add(*count).is_some_and(|end| end <= has));
            let beyond = || {
                let problem =
                    format!("expected a part of {has} vertices, but found {count} from {start}");
                FieldFault::new("range", problem)
            };
            let (start, count) = inside.ok_or_else(beyond)?;
            Ok(vec![query(mesh, start, count)])
        }
        (Some(_), several) => {
            let problem = format!(
                "a range needs the name of one mesh; the rig has {}",
                several.len()
            );
            Err(FieldFault::new("mesh", problem))
        }
    }
}
