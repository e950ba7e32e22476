//! `mesh.vertices` and `mesh.topology`.

use super::answer::Answer;
use super::names::unknown;
use super::scene::of_skinning;
use super::{Call, describe};
use crate::engine::{Terms, Timings};
use crate::frame::{Pooled, SkinnedVertices};
use crate::pose::{Posed, Skinning};
use crate::protocol::batch::MeshItem;
use crate::protocol::blob::{ArrayTransport, Blob, Numbers};
use crate::protocol::frame::Timings as TimingsMs;
use crate::protocol::mesh as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Attachments, Fault};
use crate::rig::Rig;
use crate::scene::{Bounds, Shape, VertexQuery};
use glam::{DMat4, Vec3};
use std::sync::Arc;
use std::time::Instant;

/// How many times its own bytes an array takes at the most on its way out: bare, and again as text.
const BYTES_PER_BYTE: u64 = 5;

impl Call {
    pub(super) fn vertices(
        &self,
        params: wire::VerticesParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let found = self.engine().rig(&params.rig)?;
        let attributes = &params.attributes;
        let normals = attributes.contains(&wire::Attribute::Normals);
        let wanted = Wanted {
            queries: queries(
                params.mesh.as_deref(),
                params.range,
                normals,
                &found.loaded.rig,
            )?,
            positions: attributes.contains(&wire::Attribute::Positions),
            joints: false,
            skinning: of_skinning(params.skinning),
            shape: of_state(params.state),
            transport: params.transport,
        };
        let (posed, clamped) = self.posed(&params.pose, &found)?;
        let clamped = describe::clamped(posed.rig(), &clamped);
        let (held, terms) = self.take_on(wanted.bytes(posed.rig()))?;
        let Some(answer) = answer.take() else {
            return Ok(());
        };
        self.skin(
            &Arc::new(wanted),
            posed,
            clamped,
            terms,
            move |done| match done {
                Ok(done) => {
                    let mut attachments = Attachments::default();
                    let item = done.sent(&mut attachments);
                    let result = wire::Vertices {
                        meshes: item.meshes,
                        bounds: item
                            .bounds
                            .unwrap_or_else(|| describe::bounds(&Bounds::ORIGIN)),
                        clamped: item.clamped,
                        timings_ms: item.timings_ms,
                    };
                    answer.send(&result, attachments, Some(held));
                }
                Err(fault) => answer.fail(fault),
            },
        );
        Ok(())
    }

    /// Works out and packs what is wanted of a pose. `done` runs once.
    pub(super) fn skin(
        &self,
        wanted: &Arc<Wanted>,
        posed: Arc<Posed>,
        clamped: Vec<Clamped>,
        terms: Terms,
        done: impl FnOnce(Result<Done, Fault>) + Send + 'static,
    ) {
        let wanted = Arc::clone(wanted);
        let stats = Arc::clone(&self.service.stats);
        let (skinning, shape, queries) = (wanted.skinning, wanted.shape, wanted.queries.clone());
        let vertex_count: usize = queries.iter().map(|query| query.count).sum();
        let looked_at = Arc::clone(&posed);
        let pack = move |(skinned, timings): (Vec<SkinnedVertices>, Timings)| {
            let started = Instant::now();
            let joints = wanted.joints.then(|| transforms(&looked_at));
            let bounds = (!wanted.queries.is_empty()).then(|| bounds_of(&skinned));
            let encode = started.elapsed();
            Done {
                rig: Arc::clone(looked_at.rig()),
                skinned,
                bounds,
                joints,
                clamped,
                timings: stats.rendered(0, vertex_count as u64, timings, encode),
                wanted,
            }
        };
        if queries.is_empty() {
            // Only joints, which are there already.
            return self.engine().spawn(move || {
                let checked = terms.urgency.check().map_err(Fault::from);
                let nothing = (Vec::new(), Timings::default());
                done(checked.map(|()| pack(nothing)));
            });
        }
        self.engine()
            .vertices(posed, skinning, shape, queries, terms, move |result| {
                done(result.map_err(Fault::from).map(pack));
            });
    }

    pub(super) fn topology(
        &self,
        params: wire::TopologyParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let rig = self.engine().rig(&params.rig)?.loaded.rig.clone();
        // Three vertices and at most three texture coordinates for each triangle.
        let bytes = 36 * rig.triangle_count() + 8 * rig.vertex_count();
        let held = self.hold(BYTES_PER_BYTE * bytes as u64)?;
        let mut attachments = Attachments::default();
        let mut meshes = Vec::with_capacity(rig.meshes().len());
        for mesh in rig.meshes() {
            let (vertex_count, triangle_count) = (mesh.vertex_count(), mesh.triangles().len());
            let corners = Numbers::Uint32(mesh.file_triangles().flatten().collect());
            let triangles = Blob::array(
                corners,
                &[triangle_count, 3],
                params.transport,
                &mut attachments,
            );
            let mut blob = |texcoords: Vec<[f32; 2]>, shape: &[usize]| {
                let numbers = Numbers::Float32(texcoords.into_flattened());
                Blob::array(numbers, shape, params.transport, &mut attachments)
            };
            let (mut texcoords, mut corner_texcoords) = (None, None);
            if let Some(shared) = mesh.shared_texcoords() {
                let of_vertices = shared.iter().map(|texcoord| texcoord.to_array()).collect();
                texcoords = Some(blob(of_vertices, &[vertex_count, 2]));
            } else if let Some(all) = mesh.texcoords() {
                let corners = mesh.triangles().as_flattened().iter();
                let of_corners = corners.map(|&corner| all[corner as usize].to_array());
                corner_texcoords = Some(blob(of_corners.collect(), &[triangle_count, 3, 2]));
            }
            meshes.push(wire::MeshTopology {
                name: mesh.name().to_owned(),
                vertex_count: vertex_count as u64,
                triangle_count: triangle_count as u64,
                material: describe::material_name(&rig, mesh.parts()[0].material),
                parts: describe::parts(&rig, mesh),
                triangles,
                texcoords,
                corner_texcoords,
            });
        }
        if let Some(answer) = answer.take() {
            answer.send(&wire::Topology { meshes }, attachments, Some(held));
        }
        Ok(())
    }
}

/// What of a pose is asked for.
pub(super) struct Wanted {
    /// Positions in any case: the bounds are made of them.
    pub queries: Vec<VertexQuery>,
    /// To be sent.
    pub positions: bool,
    pub joints: bool,
    pub skinning: Skinning,
    pub shape: Shape,
    pub transport: ArrayTransport,
}

impl Wanted {
    /// Until it is written.
    pub fn bytes(&self, rig: &Rig) -> u64 {
        BYTES_PER_BYTE * self.bare_bytes(rig, 24)
    }

    /// As it is written.
    pub fn written_bytes(&self, rig: &Rig) -> u64 {
        let normals = self.queries.iter().any(|query| query.normals);
        let bare = self.bare_bytes(
            rig,
            12 * (usize::from(self.positions) + usize::from(normals)),
        );
        match self.transport {
            ArrayTransport::Attach => bare,
            ArrayTransport::Json | ArrayTransport::Base64 => BYTES_PER_BYTE * bare,
        }
    }

    fn bare_bytes(&self, rig: &Rig, bytes_per_vertex: usize) -> u64 {
        let vertices: usize = self.queries.iter().map(|query| query.count).sum();
        let joints = if self.joints {
            rig.skeleton().joints().len()
        } else {
            0
        };
        (bytes_per_vertex * vertices + 64 * joints) as u64
    }
}

pub(super) fn of_state(state: wire::VertexState) -> Shape {
    match state {
        wire::VertexState::Posed => Shape::Posed,
        wire::VertexState::Bind => Shape::Bind,
    }
}

/// A pose worked out.
pub(super) struct Done {
    pub rig: Arc<Rig>,
    pub wanted: Arc<Wanted>,
    /// One for each query.
    skinned: Vec<SkinnedVertices>,
    bounds: Option<Bounds>,
    joints: Option<Vec<f32>>,
    clamped: Vec<Clamped>,
    timings: TimingsMs,
}

impl Done {
    /// Its bytes go into `attachments` where they are to be attached.
    pub fn sent(self, attachments: &mut Attachments) -> MeshItem {
        let Self {
            rig,
            wanted,
            skinned,
            bounds,
            joints,
            clamped,
            timings,
        } = self;
        let mut blob = |numbers: Pooled<f32>, shape: [usize; 2]| match wanted.transport {
            ArrayTransport::Attach => Blob::attached(numbers, &shape, attachments),
            transport @ (ArrayTransport::Json | ArrayTransport::Base64) => {
                let numbers = Numbers::Float32(numbers.into_vec());
                Blob::array(numbers, &shape, transport, attachments)
            }
        };
        let meshes = wanted.queries.iter().zip(skinned).map(|(query, skinned)| {
            let count = skinned.vertex_count;
            let positions = skinned.positions.filter(|_| wanted.positions);
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
            bounds: bounds.map(|bounds| describe::bounds(&bounds)),
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

/// What to ask the renderer for.
pub(super) fn queries(
    mesh: Option<&str>,
    range: Option<wire::Range>,
    normals: bool,
    rig: &Rig,
) -> Result<Vec<VertexQuery>, Fault> {
    let meshes = rig.meshes();
    let chosen: Vec<usize> = match mesh {
        None => (0..meshes.len()).collect(),
        Some(name) => {
            let index = meshes.iter().position(|mesh| mesh.name() == name);
            let known = meshes.iter().map(|mesh| mesh.name());
            let unknown = || Fault::invalid_params("mesh", unknown("mesh", name, known));
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
    let positions = skinned.iter().filter_map(|it| it.positions.as_deref());
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for positions in positions {
        // Four at a time, which the compiler makes vectors of.
        let (fours, rest) = positions.as_chunks::<12>();
        let (mut least, mut most) = ([f32::INFINITY; 12], [f32::NEG_INFINITY; 12]);
        for four in fours {
            for lane in 0..12 {
                least[lane] = least[lane].min(four[lane]);
                most[lane] = most[lane].max(four[lane]);
            }
        }
        for point in least.as_chunks::<3>().0.iter().chain(rest.as_chunks().0) {
            min = min.min(Vec3::from_array(*point));
        }
        for point in most.as_chunks::<3>().0.iter().chain(rest.as_chunks().0) {
            max = max.max(Vec3::from_array(*point));
        }
    }
    if min.x > max.x {
        return Bounds::ORIGIN;
    }
    Bounds {
        min: min.as_dvec3(),
        max: max.as_dvec3(),
    }
}
