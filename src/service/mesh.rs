//! `mesh.vertices` and `mesh.topology`. Never lives here: skinning.

use super::appearance::skinning;
use super::arrays::little_endian;
use super::call::Call;
use super::describe;
use super::message::{Payload, Permit};
use super::pose::of_pose;
use super::response::Responder;
use super::vertices::{BYTES_PER_BYTE, PreparedVertices, queries, shape};
use crate::protocol::blob::{ArrayTransport, Blob, Dtype};
use crate::protocol::mesh as wire;
use crate::protocol::{Attachments, Fault};
use crate::rig::{Mesh, Rig};
use std::sync::Arc;

impl Call {
    pub(super) fn vertices(
        &self,
        params: wire::VerticesParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let rig = Arc::new(self.engine().rig(&params.rig)?);
        let wants = |attribute| params.attributes.contains(&attribute);
        let asked = PreparedVertices {
            queries: queries(
                params.mesh.as_deref(),
                params.range,
                wants(wire::Attribute::Normals),
                &rig.loaded.rig,
            )?,
            positions: wants(wire::Attribute::Positions),
            joints: false,
            skinning: skinning(params.skinning),
            shape: shape(params.state),
            transport: params.transport,
            rig,
        };
        let pose = self.prepare_pose(params.pose, &asked.rig)?;
        let (memory, context) = self.admit(asked.bytes())?;
        let pose = pose.evaluate(&asked.rig).map_err(of_pose)?;
        let call = self.clone();
        Ok(move |responder: Responder| {
            call.skin(Arc::new(asked), pose, context, move |packed| {
                responder.respond(packed.and_then(|packed| {
                    let mut attachments = Attachments::default();
                    let bounds = describe::bounds(&packed.bounds);
                    let item = packed.sent(&mut attachments);
                    let result = wire::Vertices {
                        meshes: item.meshes,
                        bounds,
                        clamped: item.clamped,
                        timings_ms: item.timings_ms,
                    };
                    Payload::new(&result, attachments, Some(Permit::new(memory)))
                }));
            });
        })
    }

    pub(super) fn topology(
        &self,
        params: &wire::TopologyParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let rig = Arc::clone(&self.engine().rig(&params.rig)?.loaded.rig);
        // Three vertices and at most three texture coordinates for each triangle.
        let bytes = 36 * rig.triangle_count() + 8 * rig.vertex_count();
        let memory = self.reserve(BYTES_PER_BYTE * bytes as u64)?;
        let transport = params.transport;
        Ok(move |responder: Responder| {
            let mut attachments = Attachments::default();
            let meshes = rig.meshes().iter();
            let meshes = meshes.map(|mesh| topology(mesh, &rig, transport, &mut attachments));
            let result = wire::Topology {
                meshes: meshes.collect(),
            };
            responder.respond(Payload::new(
                &result,
                attachments,
                Some(Permit::new(memory)),
            ));
        })
    }
}

fn topology(
    mesh: &Mesh,
    rig: &Rig,
    transport: ArrayTransport,
    attachments: &mut Attachments,
) -> wire::MeshTopology {
    let (vertex_count, triangle_count) = (mesh.vertex_count(), mesh.triangles().len());
    let mut blob =
        |dtype, bytes, shape: &[usize]| Blob::array(dtype, bytes, shape, transport, attachments);
    let corners: Vec<u32> = mesh.file_triangles().flatten().collect();
    let triangles = blob(Dtype::Uint32, little_endian(corners), &[triangle_count, 3]);
    let mut texcoord_blob = |texcoords: Vec<[f32; 2]>, shape: &[usize]| {
        blob(
            Dtype::Float32,
            little_endian(texcoords.into_flattened()),
            shape,
        )
    };
    let (mut texcoords, mut corner_texcoords) = (None, None);
    if let Some(shared) = mesh.shared_texcoords() {
        let of_vertices = shared.iter().map(|texcoord| texcoord.to_array());
        texcoords = Some(texcoord_blob(of_vertices.collect(), &[vertex_count, 2]));
    } else if let Some(all) = mesh.texcoords() {
        let corners = mesh.triangles().as_flattened().iter();
        let of_corners = corners.map(|&corner| all[corner as usize].to_array());
        corner_texcoords = Some(texcoord_blob(of_corners.collect(), &[triangle_count, 3, 2]));
    }
    wire::MeshTopology {
        name: mesh.name().to_owned(),
        vertex_count: vertex_count as u64,
        triangle_count: triangle_count as u64,
        material: describe::material_name(rig, mesh.parts()[0].material),
        parts: describe::parts(rig, mesh),
        triangles,
        texcoords,
        corner_texcoords,
    }
}
