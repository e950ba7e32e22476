//! `mesh.*`.

use super::answer::Answer;
use super::scene::of_skinning;
use super::{Call, describe};
use crate::frame::SkinnedVertices;
use crate::protocol::blob::{ArrayTransport, Blob, Numbers};
use crate::protocol::mesh as wire;
use crate::protocol::{Attachments, Fault};
use crate::rig::Rig;
use crate::scene::{Bounds, Shape, VertexQuery};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// How many times its own bytes an array takes at the most on its way out: bare, and again as text.
const BYTES_PER_BYTE: u64 = 5;

impl Call<'_> {
    pub(super) fn vertices(
        &self,
        params: wire::VerticesParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let found = self.engine().rig(&params.rig)?;
        let rig = Arc::clone(&found.loaded.rig);
        let queries = queries(&params, &rig)?;
        let (posed, clamped) = self.posed(&params.pose, &found)?;
        let clamped = describe::clamped(&rig, &clamped);
        let vertex_count: usize = queries.iter().map(|query| query.count).sum();
        let (held, terms) = self.take_on(BYTES_PER_BYTE * 24 * vertex_count as u64)?;

        let shape = match params.state {
            wire::VertexState::Posed => Shape::Posed,
            wire::VertexState::Bind => Shape::Bind,
        };
        let Some(answer) = answer.take() else {
            return Ok(());
        };
        let stats = Arc::clone(&self.service.stats);
        self.engine().vertices(
            posed,
            of_skinning(params.skinning),
            shape,
            queries.clone(),
            terms,
            move |result| match result {
                Ok((skinned, timings)) => {
                    stats.rendered(0, vertex_count as u64, timings.render);
                    let mut attachments = Attachments::default();
                    let bounds = bounds_of(&skinned);
                    let meshes = queries.iter().zip(skinned).map(|(query, skinned)| {
                        let name = rig.meshes()[query.mesh].name().to_owned();
                        described(name, skinned, &params, &mut attachments)
                    });
                    let meshes = meshes.collect();
                    let result = wire::Vertices {
                        meshes,
                        bounds: describe::bounds(&bounds),
                        clamped,
                    };
                    answer.send(&result, attachments, Some(held));
                }
                Err(error) => answer.fail(error.into()),
            },
        );
        Ok(())
    }

    pub(super) fn topology(
        &self,
        params: wire::TopologyParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let rig = self.engine().rig(&params.rig)?.loaded.rig.clone();
        let bytes = 12 * rig.triangle_count() + 8 * rig.vertex_count();
        let held = self.hold(BYTES_PER_BYTE * bytes as u64)?;
        let mut attachments = Attachments::default();
        let mut meshes = Vec::with_capacity(rig.meshes().len());
        for mesh in rig.meshes() {
            let (vertex_count, triangle_count) = (mesh.vertex_count(), mesh.triangles().len());
            let corners = Numbers::Uint32(mesh.triangles().as_flattened().to_vec());
            let triangles = Blob::array(
                corners,
                &[triangle_count, 3],
                params.transport,
                &mut attachments,
            );
            let texcoords = mesh.texcoords().map(|texcoords| {
                let numbers =
                    Numbers::Float32(texcoords.iter().flat_map(|uv| uv.to_array()).collect());
                Blob::array(
                    numbers,
                    &[vertex_count, 2],
                    params.transport,
                    &mut attachments,
                )
            });
            meshes.push(wire::MeshTopology {
                name: mesh.name().to_owned(),
                vertex_count: vertex_count as u64,
                triangle_count: triangle_count as u64,
                material: describe::material_name(&rig, mesh.material()),
                triangles,
                texcoords,
            });
        }
        if let Some(answer) = answer.take() {
            answer.send(&wire::Topology { meshes }, attachments, Some(held));
        }
        Ok(())
    }
}

/// What to ask the renderer for. Positions in any case: the bounds are made of them.
fn queries(params: &wire::VerticesParams, rig: &Rig) -> Result<Vec<VertexQuery>, Fault> {
    let meshes = rig.meshes();
    let chosen: Vec<usize> = match &params.mesh {
        None => (0..meshes.len()).collect(),
        Some(name) => {
            let index = meshes.iter().position(|mesh| mesh.name() == name);
            let unknown = || Fault::invalid_params("mesh", format!("the rig has no mesh `{name}`"));
            vec![index.ok_or_else(unknown)?]
        }
    };
    let normals = params.attributes.contains(&wire::Attribute::Normals);
    let query = |mesh, start, count| VertexQuery {
        mesh,
        start,
        count,
        positions: true,
        normals,
    };
    match (params.range, chosen.as_slice()) {
        (None, _) => Ok(chosen
            .iter()
            .map(|&mesh| query(mesh, 0, meshes[mesh].vertex_count()))
            .collect()),
        (Some(wire::Range { start, count }), &[mesh]) => {
            let has = meshes[mesh].vertex_count();
            let place = usize::try_from(start).ok().zip(usize::try_from(count).ok());
            let inside = place
                .filter(|(start, count)| start.checked_add(*count).is_some_and(|end| end <= has));
            let beyond = || {
                Fault::invalid_params(
                    "range",
                    format!("expected a part of {has} vertices, but found {count} from {start}"),
                )
            };
            let (start, count) = inside.ok_or_else(beyond)?;
            Ok(vec![query(mesh, start, count)])
        }
        (Some(_), several) => {
            let problem = format!(
                "a range needs the name of one mesh; the rig has {}",
                several.len()
            );
            Err(Fault::invalid_params("mesh", problem))
        }
    }
}

fn bounds_of(skinned: &[SkinnedVertices]) -> Bounds {
    let positions = skinned
        .iter()
        .filter_map(|vertices| vertices.positions.as_deref());
    let points = positions.flat_map(|positions| positions.as_chunks::<3>().0);
    Bounds::of(points.map(|&point| DVec3::from(Vec3::from_array(point)))).unwrap_or(Bounds::ORIGIN)
}

fn described(
    name: String,
    skinned: SkinnedVertices,
    params: &wire::VerticesParams,
    attachments: &mut Attachments,
) -> wire::MeshVertices {
    let SkinnedVertices {
        vertex_count,
        positions,
        normals,
    } = skinned;
    let transport: ArrayTransport = params.transport;
    let mut blob = |numbers: Vec<f32>| {
        Blob::array(
            Numbers::Float32(numbers),
            &[vertex_count, 3],
            transport,
            attachments,
        )
    };
    let positions = positions.filter(|_| params.attributes.contains(&wire::Attribute::Positions));
    wire::MeshVertices {
        name,
        vertex_count: vertex_count as u64,
        positions: positions.map(&mut blob),
        normals: normals.map(&mut blob),
    }
}
