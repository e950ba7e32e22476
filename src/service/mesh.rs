//! `mesh.*`.

use super::answer::Answer;
use super::batch::{Course, Items};
use super::scene::of_skinning;
use super::{Call, describe};
use crate::engine::{RigRef, Terms, Timings};
use crate::frame::{Pooled, SkinnedVertices};
use crate::pose::{Posed, Skinning};
use crate::protocol::batch::{BatchAttribute, MeshBatch, MeshBatchParams, MeshItem, MeshReady};
use crate::protocol::blob::{ArrayTransport, Blob, Numbers};
use crate::protocol::frame::Timings as TimingsMs;
use crate::protocol::mesh as wire;
use crate::protocol::pose::{Clamped, DofValues, Pose};
use crate::protocol::{Attachments, Fault, Id};
use crate::rig::Rig;
use crate::scene::{Bounds, Shape, VertexQuery};
use glam::{DMat4, Vec3};
use serde::Serialize;
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

    pub(super) fn vertices_batch(
        &self,
        mut params: MeshBatchParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let found = self.engine().rig(&params.rig)?;
        let rig = Arc::clone(&found.loaded.rig);
        let poses = self.poses(&mut params, &rig)?;
        let wants = |attribute| params.attributes.contains(&attribute);
        let (positions, normals) = (
            wants(BatchAttribute::Positions),
            wants(BatchAttribute::Normals),
        );
        let of_skin = queries(params.mesh.as_deref(), params.range, normals, &rig)?;
        let wanted = Wanted {
            queries: if positions || normals {
                of_skin
            } else {
                Vec::new()
            },
            positions,
            joints: wants(BatchAttribute::Joints),
            skinning: of_skinning(params.skinning),
            shape: of_state(params.state),
            transport: params.transport,
        };
        let course = Course {
            streams: params.stream,
            item_bytes: wanted.bytes(&rig),
            request_bytes: poses.bytes() + self.attached.len() as u64,
        };
        let items = MeshItems {
            call: self.clone(),
            found,
            poses,
            wanted: Arc::new(wanted),
        };
        for index in 0..items.count() {
            self.urgency.check()?;
            let checked = self.check_pose(&items.poses.at(index), &items.found);
            checked.map_err(|fault| items.poses.located(index, fault))?;
        }
        self.run_batch(items, &course, answer)
    }

    /// Those of the items of a batch.
    fn poses(&self, params: &mut MeshBatchParams, rig: &Rig) -> Result<Poses, Fault> {
        let limits = self.engine().limits();
        let dof_count = rig.dofs().all().len();
        match (params.poses.take(), params.dof_values.take()) {
            (Some(_), None) if params.pose.is_some() => {
                let problem = "expected no `pose` beside `poses`: each of them is a whole pose";
                Err(Fault::invalid_params("pose", problem))
            }
            (Some(poses), None) => {
                limits.batch_items(poses.len())?;
                Ok(Poses::Each(poses))
            }
            (None, Some(values)) => {
                let values = match values {
                    DofValues::List(values) => values,
                    DofValues::Attached { .. } => self.numbers(&values, "dof_values")?,
                };
                if dof_count == 0 || values.len() % dof_count != 0 {
                    let found = values.len();
                    let problem = format!(
                        "expected rows of {dof_count} values, one for each DOF, but found {found} values"
                    );
                    return Err(Fault::invalid_params("dof_values", problem));
                }
                limits.batch_items(values.len() / dof_count)?;
                Ok(Poses::Rows {
                    common: params.pose.take().unwrap_or_default(),
                    values,
                    dof_count,
                })
            }
            (None, None) | (Some(_), Some(_)) => {
                let problem = "expected either `poses` or `dof_values`";
                Err(Fault::invalid_params("poses", problem))
            }
        }
    }

    /// Works out and packs what is wanted of a pose. `done` runs once.
    fn skin(
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

/// What of a pose is asked for.
struct Wanted {
    /// Positions in any case: the bounds are made of them.
    queries: Vec<VertexQuery>,
    /// To be sent.
    positions: bool,
    joints: bool,
    skinning: Skinning,
    shape: Shape,
    transport: ArrayTransport,
}

impl Wanted {
    /// Until it is written.
    fn bytes(&self, rig: &Rig) -> u64 {
        let vertices: usize = self.queries.iter().map(|query| query.count).sum();
        let joints = if self.joints {
            rig.skeleton().joints().len()
        } else {
            0
        };
        BYTES_PER_BYTE * (24 * vertices + 64 * joints) as u64
    }
}

fn of_state(state: wire::VertexState) -> Shape {
    match state {
        wire::VertexState::Posed => Shape::Posed,
        wire::VertexState::Bind => Shape::Bind,
    }
}

/// A pose worked out.
struct Done {
    rig: Arc<Rig>,
    wanted: Arc<Wanted>,
    /// One for each query.
    skinned: Vec<SkinnedVertices>,
    bounds: Option<Bounds>,
    joints: Option<Vec<f32>>,
    clamped: Vec<Clamped>,
    timings: TimingsMs,
}

impl Done {
    /// Its bytes go into `attachments` where they are to be attached.
    fn sent(self, attachments: &mut Attachments) -> MeshItem {
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

/// The poses of a batch.
enum Poses {
    Each(Vec<Pose>),
    /// Rows of values laid over one pose.
    Rows {
        common: Pose,
        values: Vec<f64>,
        dof_count: usize,
    },
}

impl Poses {
    fn count(&self) -> usize {
        match self {
            Self::Each(poses) => poses.len(),
            Self::Rows {
                values, dof_count, ..
            } => values.len() / dof_count,
        }
    }

    fn at(&self, index: usize) -> Pose {
        match self {
            Self::Each(poses) => poses[index].clone(),
            Self::Rows {
                common,
                values,
                dof_count,
            } => Pose {
                dof_values: Some(DofValues::List(
                    values[index * dof_count..][..*dof_count].to_vec(),
                )),
                ..common.clone()
            },
        }
    }

    fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Each(poses) => size_of_val(poses.as_slice()),
            Self::Rows { values, .. } => size_of_val(values.as_slice()),
        };
        bytes as u64
    }

    /// A fault of a pose is told by its place in the request.
    fn located(&self, index: usize, fault: Fault) -> Fault {
        let Fault::InvalidParams { path, message } = fault else {
            return fault;
        };
        match (self, path.strip_prefix("pose")) {
            (Self::Each(_), Some(rest)) => {
                Fault::invalid_params(format!("poses[{index}]{rest}"), message)
            }
            (Self::Rows { .. }, Some(rest))
                if rest.is_empty() || rest.starts_with(".dof_values") =>
            {
                Fault::invalid_params("dof_values", format!("row {index}: {message}"))
            }
            _ => Fault::InvalidParams { path, message },
        }
    }
}

/// The poses of a batch, to be worked out.
struct MeshItems {
    call: Call,
    found: RigRef,
    poses: Poses,
    wanted: Arc<Wanted>,
}

impl Items for MeshItems {
    type Done = Done;
    type Sent = MeshItem;
    const READY: &'static str = "mesh.ready";

    fn count(&self) -> usize {
        self.poses.count()
    }

    fn begin(
        &self,
        index: usize,
        terms: Terms,
        done: impl FnOnce(Result<Done, Fault>) + Send + 'static,
    ) {
        match self.call.posed(&self.poses.at(index), &self.found) {
            Ok((posed, clamped)) => {
                let clamped = describe::clamped(posed.rig(), &clamped);
                self.call.skin(&self.wanted, posed, clamped, terms, done);
            }
            Err(fault) => done(Err(self.poses.located(index, fault))),
        }
    }

    fn bytes(done: &Done) -> u64 {
        let of_skin = done.skinned.iter().flat_map(|skinned| {
            let positions = skinned.positions.iter().filter(|_| done.wanted.positions);
            positions.chain(&skinned.normals)
        });
        let of_joints = done.joints.iter().map(Vec::len);
        let numbers: usize = of_skin.map(|it| it.len()).chain(of_joints).sum();
        let bytes = 4 * numbers as u64;
        match done.wanted.transport {
            ArrayTransport::Attach => bytes,
            ArrayTransport::Json | ArrayTransport::Base64 => BYTES_PER_BYTE * bytes,
        }
    }

    fn sent(done: Done, attachments: &mut Attachments) -> MeshItem {
        done.sent(attachments)
    }

    fn ready(request: &Id, index: usize, item: MeshItem) -> impl Serialize {
        MeshReady {
            request: request.clone(),
            index: index as u64,
            item,
        }
    }

    fn result(&self, items: Option<Vec<MeshItem>>) -> impl Serialize {
        MeshBatch {
            item_count: self.count() as u64,
            items,
        }
    }
}

/// What to ask the renderer for.
fn queries(
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
            let unknown = || Fault::invalid_params("mesh", format!("the rig has no mesh `{name}`"));
            vec![index.ok_or_else(unknown)?]
        }
    };
    let query = |mesh, start, count| VertexQuery {
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
