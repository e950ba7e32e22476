//! `mesh.batch`. Never lives here: how one pose is skinned, and the order of many.

use super::appearance::skinning;
use super::batch::{Batch, Items};
use super::call::Call;
use super::dof_row::DofRow;
use super::prepared_pose::PreparedPose;
use super::response::Responder;
use super::vertices::{PackedVertices, PreparedVertices, queries, shape};
use crate::engine::{JobContext, RigRef};
use crate::protocol::batch::{BatchAttribute, MeshBatch, MeshBatchParams, MeshItem, MeshReady};
use crate::protocol::pose::{DofValues, Pose};
use crate::protocol::{Attachments, Fault, FieldFault, Id};
use serde::Serialize;
use std::sync::Arc;

impl Call {
    pub(super) fn vertices_batch(
        &self,
        mut params: MeshBatchParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let found = Arc::new(self.engine().rig(&params.rig)?);
        let Poses {
            given,
            list,
            shared_bytes,
        } = self.poses(&mut params, &found)?;
        let asked = Arc::new(asked(&params, found)?);
        let batch = Batch {
            given,
            streams: params.stream,
            item_bytes: asked.bytes(),
            request_bytes: self.attached.len() as u64 + shared_bytes,
            items: MeshItems {
                call: self.clone(),
                asked,
                list,
            },
        };
        batch.prepare(self)
    }

    fn poses(&self, params: &mut MeshBatchParams, found: &RigRef) -> Result<Poses, Fault> {
        let limits = self.engine().limits();
        match (params.poses.take(), params.dof_values.take()) {
            (Some(_), None) if params.pose.is_some() => {
                let problem = "expected no `pose` beside `poses`: each of them is a whole pose";
                Err(Fault::invalid_params("pose", problem))
            }
            (Some(poses), None) => {
                limits.batch_items(poses.len())?;
                Ok(Poses {
                    given: poses.into_iter().map(GivenPose::Whole).collect(),
                    list: PoseList::Poses,
                    shared_bytes: 0,
                })
            }
            (None, Some(values)) => {
                let common = params.pose.take().unwrap_or_default();
                self.rows(common, values, found)
            }
            (None, None) | (Some(_), Some(_)) => {
                let problem = "expected either `poses` or `dof_values`";
                Err(Fault::invalid_params("poses", problem))
            }
        }
    }

    /// Rows of values, laid over one pose.
    fn rows(&self, common: Pose, values: DofValues, found: &RigRef) -> Result<Poses, Fault> {
        let of_values = |fault: FieldFault| fault.within("dof_values");
        let values = DofRow::new(values, &self.attached).map_err(of_values)?;
        let width = found.loaded.rig.dofs().all().len();
        if width == 0 || !values.len().is_multiple_of(width) {
            let found = values.len();
            let problem = format!(
                "expected rows of {width} values, one for each DOF, but found {found} values"
            );
            return Err(Fault::invalid_params("dof_values", problem));
        }
        let count = values.len() / width;
        self.engine().limits().batch_items(count)?;
        if !common.dofs.is_empty() {
            let problem = "expected either `dofs` or `dof_values`, but found both";
            return Err(Fault::invalid_params("dof_values", problem));
        }
        let common = Pose {
            dof_values: None,
            ..common
        };
        let common = self.prepare_pose(common, found)?;
        let row = |index| GivenPose::Row(common.clone(), values.part(index, width));
        Ok(Poses {
            given: (0..count).map(row).collect(),
            list: PoseList::DofValues,
            shared_bytes: values.bytes() as u64,
        })
    }
}

/// The poses of a batch as the request has them.
struct Poses {
    given: Vec<GivenPose>,
    list: PoseList,
    /// Memory that several of them refer to.
    shared_bytes: u64,
}

enum GivenPose {
    Whole(Pose),
    /// Laid over the common pose.
    Row(PreparedPose, DofRow),
}

/// The field that poses come from.
#[derive(Clone, Copy)]
enum PoseList {
    Poses,
    DofValues,
}

impl PoseList {
    /// The fault of a pose, as seen from the request.
    fn located(self, index: usize, fault: FieldFault) -> FieldFault {
        match self {
            Self::Poses => fault.within(("poses", index)),
            // What is wrong with the common pose by itself has been found.
            Self::DofValues => {
                FieldFault::new("dof_values", format!("row {index}: {}", fault.message))
            }
        }
    }
}

/// What is asked for of each pose.
fn asked(params: &MeshBatchParams, rig: Arc<RigRef>) -> Result<PreparedVertices, FieldFault> {
    let wants = |attribute| params.attributes.contains(&attribute);
    let (positions, normals) = (
        wants(BatchAttribute::Positions),
        wants(BatchAttribute::Normals),
    );
    let mut queries = queries(
        params.mesh.as_deref(),
        params.range,
        normals,
        &rig.loaded.rig,
    )?;
    if !positions && !normals {
        queries.clear();
    }
    Ok(PreparedVertices {
        queries,
        positions,
        joints: wants(BatchAttribute::Joints),
        skinning: skinning(params.skinning),
        shape: shape(params.state),
        transport: params.transport,
        rig,
    })
}

/// The poses of a batch, to be worked out.
struct MeshItems {
    call: Call,
    asked: Arc<PreparedVertices>,
    list: PoseList,
}

impl MeshItems {
    /// A fault is as seen from the pose.
    fn prepared(&self, given: GivenPose) -> Result<PreparedPose, FieldFault> {
        let found = &self.asked.rig;
        let pose = match given {
            GivenPose::Whole(pose) => PreparedPose::new(pose, &self.call.attached, found)?,
            GivenPose::Row(common, row) => common.with_row(row, &found.loaded.rig)?,
        };
        pose.check(found)?;
        Ok(pose)
    }
}

impl Items for MeshItems {
    type Given = GivenPose;
    type Prepared = PreparedPose;
    type Done = PackedVertices;
    type Sent = MeshItem;
    const READY: &'static str = "mesh.ready";

    fn prepare(&self, index: usize, given: GivenPose) -> Result<PreparedPose, Fault> {
        let prepared = self.prepared(given);
        Ok(prepared.map_err(|fault| self.list.located(index, fault))?)
    }

    fn least_bytes(&self, _: &PreparedPose) -> u64 {
        self.asked.written_bytes()
    }

    fn start(
        &self,
        index: usize,
        prepared: PreparedPose,
        context: JobContext,
        done: impl FnOnce(Result<PackedVertices, Fault>) + Send + 'static,
    ) {
        match prepared.evaluate(&self.asked.rig) {
            Ok(pose) => self.call.skin(Arc::clone(&self.asked), pose, context, done),
            Err(fault) => done(Err(self.list.located(index, fault).into())),
        }
    }

    fn written_bytes(done: &PackedVertices) -> u64 {
        done.asked.written_bytes()
    }

    fn sent(done: PackedVertices, attachments: &mut Attachments) -> MeshItem {
        done.sent(attachments)
    }

    fn ready(request: &Id, index: u64, item: MeshItem) -> impl Serialize {
        MeshReady {
            request: request.clone(),
            index,
            item,
        }
    }

    fn result(item_count: u64, items: Option<Vec<MeshItem>>) -> impl Serialize {
        MeshBatch { item_count, items }
    }
}
